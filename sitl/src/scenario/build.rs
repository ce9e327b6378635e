//! Scenario → physical world and parameters.

use super::{Scenario, ScenarioError, TetherKind, set_param};
use crate::plant::{
    BatteryModel, BodyModel, GroundModel, Gusts, PlantModel, RodModel, RotorModel, TetherModel, V3,
    WinchModel, WindModel,
};
use tautline_firmware::param::Params;

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

    /// The physical world; `from` draws the wind direction when the file leaves it open.
    #[must_use]
    pub fn plant_with_wind(&self, from: f64) -> PlantModel {
        let (v, t) = (&self.vehicle, &self.tether);
        let body = BodyModel {
            mass: v.mass,
            inertia: V3::from(v.inertia),
            drag_linear: V3::from(v.drag_linear),
            drag_quadratic: v.drag_quadratic,
            rate_damping: v.rate_damping,
        };
        let is_free = t.kind == TetherKind::None;
        // Feet that carry a kilogram would throw a hundred grams about.
        let light = v.mass.min(1.0);
        let winch = (t.kind == TetherKind::Winch).then_some(WinchModel {
            lag: t.winch_lag,
            error: t.winch_error,
            friction: t.winch_friction,
            ripple: t.winch_ripple,
            length_max: t.winch_length_max,
        });
        PlantModel {
            rotor: RotorModel {
                arm: v.arm,
                thrust_coefficient: v.thrust_coefficient,
                torque_ratio: v.torque_ratio,
                speed_max: v.rotor_speed_max,
                nominal_voltage: v.nominal_voltage,
                curve: v.throttle_curve,
                time_constant: v.rotor_time_constant,
                common_gain_error: v.common_thrust_error,
                gain_error: v.rotor_thrust_error,
                efficiency: 0.65,
            },
            tether: TetherModel {
                winch,
                length: t.length,
                stiffness: t.stiffness,
                damping_ratio: t.damping_ratio,
                reference_mass: v.mass,
                // No line hangs on a vehicle without one.
                line_density: if is_free { 0.0 } else { t.line_density },
                diameter: if is_free { 0.0 } else { t.diameter },
                attachment: t.attachment,
                pulls: !matches!(t.kind, TetherKind::Strut | TetherKind::None),
                pushes: matches!(t.kind, TetherKind::Strut | TetherKind::Bar),
                is_broken: false,
            },
            wind: WindModel {
                speed: self.wind.speed,
                from: self.wind.from.unwrap_or(from),
                gusts: if self.wind.gusts { Gusts::Dryden } else { Gusts::None },
                pulse: self.wind.pulse,
            },
            ground: GroundModel {
                leg_height: v.leg_height,
                leg_spread: (0.85 * v.arm).min(0.15),
                stiffness: 2_000.0 * light,
                damping: 60.0 * light,
                friction: 0.8,
            },
            battery: BatteryModel {
                cells: self.battery.cells,
                capacity: self.battery.capacity,
                resistance: self.battery.resistance,
                charge: self.battery.charge,
                base_power: 4.0,
            },
            rod: (self.rod.load_mass > 0.0).then(|| {
                let r = &self.rod;
                let ((sin, cos), (east, north)) = (r.tilt.sin_cos(), r.azimuth.sin_cos());
                let held = V3::new(sin * north, sin * east, -cos);
                RodModel { load_mass: r.load_mass, length: r.length, held }
            }),
            body,
        }
    }

    /// The physical world with wind from the North unless the file says otherwise.
    #[must_use]
    pub fn plant(&self) -> PlantModel {
        self.plant_with_wind(0.0)
    }

    /// The firmware's parameters: what an operator would have set for this vehicle, then the file's own.
    ///
    /// # Errors
    /// A line naming the parameter.
    pub fn params(&self) -> Result<Params, ScenarioError> {
        let (v, t) = (&self.vehicle, &self.tether);
        let mut params = Params::default();
        let [ix, iy, iz] = v.inertia;
        let rotor_max = v.thrust_coefficient * v.rotor_speed_max * v.rotor_speed_max;
        let known = [
            ("VEH_MASS", v.mass),
            ("VEH_IXX", ix),
            ("VEH_IYY", iy),
            ("VEH_IZZ", iz),
            ("VEH_ARM", v.arm),
            ("VEH_CQ", v.torque_ratio),
            ("VEH_ATT_Z", t.attachment),
            ("VEH_H_GND", v.leg_height),
            ("MOT_THR_MAX", rotor_max),
            ("MOT_V_NOM", v.nominal_voltage),
            ("MOT_TAU", v.rotor_time_constant),
            ("TPC_THR_MAX", 3.5 * rotor_max),
            ("BAT1_N_CELLS", self.battery.cells),
            ("TET_KIND", t.kind.parameter()),
            ("TET_LENGTH", t.length),
            ("TET_LIN_DENS", t.line_density),
            ("TET_START_DIST", t.start_distance),
            ("TET_START_SLK", t.start_slack),
            ("TET_HDG0", v.heading),
            ("PND_LENGTH", self.rod.length),
            ("CAP_DELAY", self.capture.delay),
        ];
        let load = [("PND_LOAD", self.rod.load_mass)];
        let known = known.into_iter().chain(load.into_iter().filter(|(_, mass)| *mass > 0.0));
        for (name, value) in known {
            set_param(&mut params, name, value as f32).map_err(ScenarioError)?;
        }
        for (name, &value) in &self.params {
            set_param(&mut params, name, value).map_err(ScenarioError)?;
        }
        Ok(params)
    }
}
