//! Names under which ground stations look for what we call otherwise, or do not have.
//!
//! QGroundControl's set-up pages read PX4's parameters and complain of each that is missing. Where ours mean the same
//! in another unit the alias is a view of it, both ways; else it is a constant that nobody can write.

use super::{Kind, META, Params};

/// One of them.
#[derive(Clone, Copy, Debug)]
pub struct Alias {
    /// PX4's name.
    pub name: &'static str,
    /// How it is sent.
    pub kind: Kind,
    view: View,
}

#[derive(Clone, Copy, Debug)]
enum View {
    Constant(f32),
    Of {
        /// Ours.
        name: &'static str,
        /// From ours to theirs, and back.
        read: fn(&Params, f32) -> f32,
        write: fn(&Params, f32) -> f32,
    },
}

const fn whole(name: &'static str, value: f32) -> Alias {
    Alias { name, kind: Kind::Int, view: View::Constant(value) }
}

const fn real(name: &'static str, value: f32) -> Alias {
    Alias { name, kind: Kind::Real, view: View::Constant(value) }
}

/// A cell's voltage as a share of its charge, as PX4 counts it.
fn charge(p: &Params, cell: f32) -> f32 {
    (cell - p.cell_empty) / (p.cell_full - p.cell_empty).max(0.1)
}

fn cell(p: &Params, charge: f32) -> f32 {
    p.cell_empty + charge * (p.cell_full - p.cell_empty)
}

const fn battery(name: &'static str, ours: &'static str) -> Alias {
    Alias { name, kind: Kind::Real, view: View::Of { name: ours, read: charge, write: cell } }
}

/// A whole number with PX4, which is what it may be set to here.
const fn as_whole(name: &'static str, ours: &'static str) -> Alias {
    let view = View::Of { name: ours, read: |_, x| libm::roundf(x), write: |_, x| x };
    Alias { name, kind: Kind::Int, view }
}

/// All of them; their MAVLink indices follow those of [`META`].
pub const ALIASES: &[Alias] = &[
    whole("SYS_AUTOCONFIG", 0.0),
    whole("CAL_MAG0_ID", 0.0),
    whole("CAL_MAG1_ID", 0.0),
    whole("CAL_MAG2_ID", 0.0),
    whole("CAL_MAG0_ROT", -1.0),
    whole("CAL_MAG1_ROT", -1.0),
    whole("CAL_MAG2_ROT", -1.0),
    whole("CAL_MAG_SIDES", 63.0),
    whole("RC_MAP_FLAPS", 0.0),
    whole("RC_MAP_AUX1", 0.0),
    whole("RC_MAP_AUX2", 0.0),
    whole("BAT1_SOURCE", 0.0),
    // It returns along the tether and waits nowhere.
    real("RTL_RETURN_ALT", 0.0),
    real("RTL_DESCEND_ALT", 0.0),
    real("RTL_LAND_DELAY", 0.0),
    // Hold, return and land, land in place: the same numbers.
    as_whole("NAV_DLL_ACT", "FS_LINK_ACT"),
    as_whole("COM_DL_LOSS_T", "FS_LINK_T"),
    // Return at low, land in place at critical.
    whole("COM_LOW_BAT_ACT", 3.0),
    battery("BAT_LOW_THR", "BAT_LOW_V"),
    battery("BAT_CRIT_THR", "BAT_CRIT_V"),
    real("BAT_EMERGEN_THR", 0.0),
    real("CP_DIST", -1.0),
    real("SENS_BOARD_X_OFF", 0.0),
    real("SENS_BOARD_Y_OFF", 0.0),
    real("SENS_BOARD_Z_OFF", 0.0),
    real("SENS_DPRES_OFF", 0.0),
];

impl Alias {
    /// The position in [`ALIASES`] of a name.
    #[must_use]
    pub fn index_of(name: &[u8]) -> Option<usize> {
        ALIASES.iter().position(|alias| alias.name.as_bytes() == name)
    }

    /// The parameter that it is a view of.
    #[must_use]
    pub fn of(&self) -> Option<usize> {
        match self.view {
            View::Constant(_) => None,
            View::Of { name, .. } => META.iter().position(|meta| meta.name == name),
        }
    }

    /// As a ground station reads it.
    #[must_use]
    pub fn value(&self, params: &Params) -> f32 {
        match (self.view, self.of().and_then(|index| params.get(index))) {
            (View::Constant(value), _) => value,
            (View::Of { read, .. }, Some(ours)) => read(params, ours),
            (View::Of { .. }, None) => 0.0,
        }
    }

    /// What of ours to set, and to what, when a ground station writes it; `None` for what nobody can write.
    #[must_use]
    pub fn write(&self, params: &Params, value: f32) -> Option<(usize, f32)> {
        match self.view {
            View::Constant(_) => None,
            View::Of { write, .. } => Some((self.of()?, write(params, value))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_alias_has_a_name_of_its_own_and_reads_back_what_is_written() {
        let params = Params::default();
        for (index, alias) in ALIASES.iter().enumerate() {
            assert!(alias.name.len() <= 16, "{}", alias.name);
            assert_eq!(Alias::index_of(alias.name.as_bytes()), Some(index));
            assert_eq!(Params::index_of(alias.name.as_bytes()), None, "{}", alias.name);
            let value = alias.value(&params);
            assert!(value.is_finite());
            if let View::Of { name, .. } = alias.view {
                let (index, ours) = alias.write(&params, value).expect(name);
                let mut changed = params;
                changed.set(index, ours).expect(name);
                assert!((alias.value(&changed) - value).abs() < 1e-4, "{name}");
            }
        }
    }
}
