//! How an operator sets the scenario's vehicle up: its place at the start and its parameters.

use super::{Gnss, Scenario, ScenarioError, TetherKind, set_param};
use crate::plant::{Hub, hubs};
use crate::sensor::NEWTON_PER_COUNT;
use tautline_firmware::model::Rotors;
use tautline_firmware::param::{META, Params};
use tautline_firmware::signal::Aid;

/// Parameters that describe what the simulator knows better.
const PLANT: [&str; 17] = [
    "VEH_FRAME",
    "VEH_MASS",
    "VEH_IXX",
    "VEH_IYY",
    "VEH_IZZ",
    "VEH_ARM",
    "VEH_CQ",
    "VEH_ATT_Z",
    "VEH_H_GND",
    "MOT_THR_MAX",
    "MOT_V_NOM",
    "MOT_TAU",
    "BAT1_N_CELLS",
    "TET_KIND",
    "TET_LENGTH",
    "TET_LIN_DENS",
    "PND_LENGTH",
];

impl Scenario {
    /// Where the vehicle stands: distance from the anchor, m, and heading, rad.
    #[must_use]
    pub fn start(&self) -> (f64, f64) {
        let height = self.vehicle.leg_height;
        let distance = match self.tether.kind {
            TetherKind::Winch | TetherKind::None => self.tether.start_distance,
            // Just short of taut, as an operator lays it out.
            TetherKind::Fixed => {
                let taut = (self.tether.length.powi(2) - height.powi(2)).sqrt();
                (taut - 0.02 - self.tether.start_slack).max(0.2)
            }
            // A rigid link is as long as it is.
            TetherKind::Strut | TetherKind::Bar => {
                let end = height - self.tether.attachment;
                (self.tether.length.powi(2) - end.powi(2)).sqrt()
            }
        };
        (distance, self.vehicle.heading)
    }

    /// The firmware's parameters: what an operator would have set for this vehicle, then the file's own.
    ///
    /// # Errors
    /// A line naming the parameter.
    pub fn params(&self) -> Result<Params, ScenarioError> {
        let mut params = self.own_params()?;
        for (name, &value) in &self.params {
            set_param(&mut params, name, value).map_err(ScenarioError)?;
        }
        Ok(params)
    }

    /// What the parameters say of the vehicle and the line that is not so, a line each: an experiment may want that,
    /// a typing error does not.
    ///
    /// # Errors
    /// As [`Self::params`].
    pub fn contradictions(&self, params: &Params) -> Result<Vec<String>, ScenarioError> {
        let own = self.own_params()?;
        Ok(META
            .iter()
            .enumerate()
            .filter(|(_, meta)| PLANT.contains(&meta.name))
            .filter(|(_, meta)| match meta.name {
                "TET_LENGTH" => self.tether.kind == TetherKind::Fixed,
                "PND_LENGTH" => self.rod.load_mass > 0.0,
                _ => true,
            })
            .filter_map(|(i, meta)| {
                let (is, told) = (own.get(i)?, params.get(i)?);
                let differs = (told - is).abs() > 0.02 * is.abs().max(0.01);
                differs.then(|| format!("{} = {told}, but the simulated one is {is}", meta.name))
            })
            .collect())
    }

    fn own_params(&self) -> Result<Params, ScenarioError> {
        let (v, t) = (&self.vehicle, &self.tether);
        let has_gnss = self.sensors.gnss != Gnss::None;
        let mut params = Params::default();
        let [ix, iy, iz] = v.inertia;
        let rotor_max = v.thrust_coefficient * v.rotor_speed_max * v.rotor_speed_max;
        let known = [
            ("VEH_MASS", v.mass),
            ("VEH_IXX", ix),
            ("VEH_IYY", iy),
            ("VEH_IZZ", iz),
            ("VEH_FRAME", f64::from(frame(&hubs(v)).map_err(ScenarioError)?)),
            ("VEH_ARM", v.arm),
            ("VEH_CQ", v.torque_ratio),
            ("VEH_ATT_Z", t.attachment),
            ("VEH_H_GND", v.leg_height),
            ("MOT_THR_MAX", rotor_max),
            ("MOT_V_NOM", v.nominal_voltage),
            ("MOT_TAU", v.rotor_time_constant),
            ("TPC_THR_MAX", 0.875 * hubs(v).len() as f64 * rotor_max),
            ("BAT1_N_CELLS", self.battery.cells),
            ("TET_KIND", t.kind.parameter()),
            ("TET_LENGTH", t.length),
            ("TET_LIN_DENS", t.line_density),
            ("TET_START_DIST", t.start_distance),
            ("TET_START_SLK", t.start_slack),
            ("TET_HDG0", v.heading),
            ("PND_LENGTH", self.rod.length),
            ("CAP_DELAY", if has_gnss { Gnss::DELAY } else { self.capture.delay }),
        ];
        // What is not fitted is not set up.
        let cell = if self.sensors.tension_cell { NEWTON_PER_COUNT } else { 0.0 };
        let s = &self.sensors;
        let aids = [
            (Aid::Angles, s.vehicle_angles),
            (Aid::Fairlead, s.ground_angles),
            (Aid::Cell, s.tension_cell),
            (Aid::Compass, s.magnetometer),
            (Aid::Position, has_gnss || self.capture.rate > 0.0 && self.capture.position),
            (Aid::Velocity, s.flow || self.capture.rate > 0.0 && self.capture.velocity_noise > 0.0),
        ];
        let bit = |(aid, is_fitted): (Aid, bool)| f64::from(u8::from(is_fitted) << aid as u8);
        let [north, east, _] = s.magnetic_field;
        let declination = if s.magnetometer { east.atan2(north) } else { 0.0 };
        let fitted = [
            ("PND_LOAD", self.rod.load_mass),
            ("LNK_CELL_SCALE", cell),
            ("EST_AIDS", aids.into_iter().map(bit).sum()),
            ("EST_MAG_DECL", declination),
            ("EST_POS_SD", if has_gnss { s.gnss.deviation() } else { 0.0 }),
        ];
        let known = known.into_iter().chain(fitted.into_iter().filter(|(_, value)| *value != 0.0));
        for (name, value) in known {
            set_param(&mut params, name, value as f32).map_err(ScenarioError)?;
        }
        Ok(params)
    }
}

/// The `VEH_FRAME` that has these rotors.
fn frame(hubs: &[Hub]) -> Result<u8, String> {
    let is_same = |frame: &u8| {
        let rotors = Rotors::of(&Params { frame: f32::from(*frame), ..Params::default() });
        let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-3;
        rotors.len() == hubs.len()
            && rotors.iter().zip(hubs).all(|(rotor, hub)| {
                near(rotor.x, hub.x) && near(rotor.y, hub.y) && near(rotor.spin, hub.spin)
            })
    };
    let most = META.iter().find(|meta| meta.name == "VEH_FRAME").map_or(0.0, |meta| meta.max);
    (0..=most as u8)
        .find(is_same)
        .ok_or_else(|| "vehicle.rotors: no VEH_FRAME has these".to_owned())
}
