//! Channels of a radio → sticks and switches, as the parameters map them.

use crate::param::Params;
use crate::signal::{RADIO_CHANNELS, RawRadio, Sticks};

/// A switch counts as on in the last quarter of its channel, PX4's threshold.
const ON: f32 = 0.75;
/// Positions of the mode switch.
pub const MODE_SLOTS: usize = 6;
/// A channel below or above these is no pulse of a servo, µs.
const PULSES: core::ops::RangeInclusive<u16> = 800..=2200;

/// Where the switches are; what is mapped to no channel is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switches {
    /// From 0.
    pub mode: Option<u8>,
    /// Whether the motors shall run.
    pub arm: Option<bool>,
    /// Whether they shall stop, whatever happens.
    pub kill: bool,
}

/// What the pilot holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pilot {
    /// `None` unless all four are mapped.
    pub sticks: Option<Sticks>,
    /// The rest.
    pub switches: Switches,
}

impl Pilot {
    /// Of one frame.
    #[must_use]
    pub fn new(p: &Params, radio: &RawRadio) -> Self {
        let pulse = |map: f32| {
            let us = *radio.channels.get(channel(map)?)?;
            PULSES.contains(&us).then(|| f32::from(us))
        };
        let stick = |map| pulse(map).map(|us| deflection(p, us) * sign(p, map));
        // Of the whole way, 0 to 1; turned round where the channel is.
        let share = |map| {
            pulse(map).map(|us| {
                let share = ((us - p.radio_min) / (p.radio_max - p.radio_min)).clamp(0.0, 1.0);
                if sign(p, map) < 0.0 { 1.0 - share } else { share }
            })
        };
        let is_on = |map| share(map).map(|share| share > ON);
        let sticks = || {
            Some(Sticks {
                roll: stick(p.radio_roll)?,
                pitch: stick(p.radio_pitch)?,
                throttle: share(p.radio_throttle)?,
                yaw: stick(p.radio_yaw)?,
            })
        };
        let slot = |share: f32| ((share * MODE_SLOTS as f32) as u8).min(MODE_SLOTS as u8 - 1);
        Self {
            sticks: sticks(),
            switches: Switches {
                mode: share(p.radio_mode_switch).map(slot),
                arm: is_on(p.radio_arm_switch),
                kill: is_on(p.radio_kill_switch) == Some(true),
            },
        }
    }
}

/// From 0; `None` for what is mapped to none.
fn channel(map: f32) -> Option<usize> {
    (map as usize).checked_sub(1).filter(|&channel| channel < RADIO_CHANNELS)
}

/// -1 to 1, nothing within the dead band.
fn deflection(p: &Params, us: f32) -> f32 {
    let off = us - p.radio_trim;
    let way = if off < 0.0 { p.radio_trim - p.radio_min } else { p.radio_max - p.radio_trim };
    let size = (off.abs() - p.radio_dead_band) / (way - p.radio_dead_band);
    libm::copysignf(size.clamp(0.0, 1.0), off)
}

/// -1 for a channel that is turned round.
fn sign(p: &Params, map: f32) -> f32 {
    let signs = [
        p.radio_1_sign,
        p.radio_2_sign,
        p.radio_3_sign,
        p.radio_4_sign,
        p.radio_5_sign,
        p.radio_6_sign,
        p.radio_7_sign,
        p.radio_8_sign,
    ];
    let sign = channel(map).and_then(|channel| signs.get(channel)).copied();
    if sign.unwrap_or(1.0) < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(p: &Params, set: &[(usize, u16)]) -> Pilot {
        let mut radio = RawRadio { channels: [1500; RADIO_CHANNELS], ..RawRadio::default() };
        for &(channel, us) in set {
            radio.channels[channel - 1] = us;
        }
        Pilot::new(p, &radio)
    }

    fn sticks(p: &Params, set: &[(usize, u16)]) -> [f32; 4] {
        let s = read(p, set).sticks.unwrap();
        [s.roll, s.pitch, s.yaw, s.throttle]
    }

    #[test]
    fn aileron_elevator_throttle_and_rudder_come_in_this_order_unless_a_map_says_otherwise() {
        let p = Params::default();
        let all = [(1, 2000), (2, 2000), (3, 1000), (4, 1000)];
        assert_eq!(sticks(&p, &all), [1.0, 1.0, -1.0, 0.0]);
        let p = Params { radio_roll: 4.0, radio_yaw: 1.0, ..p };
        assert_eq!(sticks(&p, &all), [-1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn the_dead_band_is_still_and_the_way_from_its_edge_to_the_end_is_whole() {
        let p = Params { radio_dead_band: 20.0, ..Params::default() };
        assert_eq!(sticks(&p, &[(1, 1519), (2, 1481), (4, 1520), (3, 1000)]), [0.0; 4]);
        let [roll, ..] = sticks(&p, &[(1, 1760)]);
        assert!((roll - 0.5).abs() < 1e-6, "{roll}");
        assert_eq!(sticks(&p, &[(1, 2012)])[0], 1.0, "beyond the end is the end");
    }

    #[test]
    fn a_channel_that_is_turned_round_turns_its_stick_and_its_throttle() {
        let p = Params { radio_1_sign: -1.0, radio_3_sign: -1.0, ..Params::default() };
        assert_eq!(sticks(&p, &[(1, 2000), (3, 1000)]), [-1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn the_mode_switch_has_six_slots_of_which_three_positions_hit_first_fourth_and_last() {
        let p = Params { radio_mode_switch: 5.0, ..Params::default() };
        let slot = |us| read(&p, &[(5, us)]).switches.mode;
        let six = [1000, 1200, 1400, 1600, 1800, 2000].map(slot);
        assert_eq!(six, [0, 1, 2, 3, 4, 5].map(Some));
        assert_eq!([988, 1500, 2012].map(slot), [0, 3, 5].map(Some));
        assert_eq!(read(&Params::default(), &[(5, 2000)]).switches, Switches::default());
    }

    #[test]
    fn what_is_no_pulse_moves_nothing() {
        let p = Params { radio_kill_switch: 7.0, radio_arm_switch: 8.0, ..Params::default() };
        for us in [0, 799, 2201, u16::MAX] {
            let pilot = read(&p, &[(1, us), (7, us), (8, us)]);
            assert_eq!(pilot.sticks, None);
            assert_eq!(pilot.switches, Switches::default());
        }
        let on = read(&p, &[(7, 1800), (8, 1800)]).switches;
        assert_eq!((on.kill, on.arm), (true, Some(true)));
        let off = read(&p, &[(7, 1700), (8, 1700)]).switches;
        assert_eq!((off.kill, off.arm), (false, Some(false)));
    }

    #[test]
    fn any_channels_and_any_parameters_give_sticks_within_their_range() {
        for step in 0..5000_u32 {
            let at =
                |k: u32| (step.wrapping_mul(2_654_435_761).wrapping_add(k * 40_503) >> 8) as u16;
            let radio = RawRadio {
                channels: core::array::from_fn(|i| at(i as u32)),
                ..RawRadio::default()
            };
            let mut p = Params::default();
            for (index, meta) in crate::param::META.iter().enumerate() {
                if meta.group == crate::param::Group::Radio {
                    let share = f32::from(at(index as u32)) / 65_535.0;
                    let value = meta.min + share * (meta.max - meta.min);
                    p.set(index, libm::roundf(value).clamp(meta.min, meta.max)).unwrap();
                }
            }
            if let Some(s) = Pilot::new(&p, &radio).sticks {
                assert!([s.roll, s.pitch, s.yaw].iter().all(|x| (-1.0..=1.0).contains(x)));
                assert!((0.0..=1.0).contains(&s.throttle));
            }
        }
    }
}
