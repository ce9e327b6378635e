//! What is simulated: a TOML file, checked whole before the first step.
//!
//! Every key has a default (a 1.5 kg, 500 mm quadrotor on 4S and a constant-tension winch); unknown
//! keys are errors. Errors name file, key and allowed range.

use crate::plant::{
    BatteryModel, BodyModel, GroundModel, Gusts, PlantModel, RotorModel, TetherModel, V3,
    WinchModel, WindModel,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use tautline_firmware::param::{META, ParamError, Params};

/// The whole file.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// One line for the start-up text.
    pub title: String,
    /// The vehicle.
    pub vehicle: VehicleSection,
    /// The tether and its ground end.
    pub tether: TetherSection,
    /// Wind.
    pub wind: WindSection,
    /// Sensors.
    pub sensors: SensorSection,
    /// Battery.
    pub battery: BatterySection,
    /// Parameters of the firmware.
    pub params: BTreeMap<String, f32>,
    /// Faults, at their times.
    pub fault: Vec<FaultSection>,
    /// What the built-in pilot flies; empty: nobody flies.
    pub mission: Vec<Step>,
}

/// `[vehicle]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct VehicleSection {
    /// kg.
    pub mass: f64,
    /// kg m².
    pub inertia: [f64; 3],
    /// Hub distance along each axis, m.
    pub arm: f64,
    /// N/(rad/s)².
    pub thrust_coefficient: f64,
    /// m.
    pub torque_ratio: f64,
    /// rad/s at nominal voltage.
    pub rotor_speed_max: f64,
    /// V.
    pub nominal_voltage: f64,
    /// Exponent from throttle to speed.
    pub throttle_curve: f64,
    /// s.
    pub rotor_time_constant: f64,
    /// ± of all rotors together.
    pub common_thrust_error: f64,
    /// ± of each rotor.
    pub rotor_thrust_error: f64,
    /// N s/m.
    pub drag_linear: [f64; 3],
    /// N s²/m².
    pub drag_quadratic: f64,
    /// N m s/rad.
    pub rate_damping: f64,
    /// Centre of mass over the feet, m.
    pub leg_height: f64,
    /// Heading of the nose at start, rad.
    pub heading: f64,
}

impl Default for VehicleSection {
    fn default() -> Self {
        Self {
            mass: 1.5,
            inertia: [0.016, 0.016, 0.029],
            arm: 0.177,
            thrust_coefficient: 1.55e-5,
            torque_ratio: 0.0167,
            rotor_speed_max: 723.0,
            nominal_voltage: 15.2,
            throttle_curve: 0.75,
            rotor_time_constant: 0.03,
            common_thrust_error: 0.02,
            rotor_thrust_error: 0.01,
            drag_linear: [0.18, 0.18, 0.06],
            drag_quadratic: 0.012,
            rate_damping: 0.004,
            leg_height: 0.15,
            heading: 0.0,
        }
    }
}

/// Ground end of the tether.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum TetherKind {
    /// Constant tension.
    #[default]
    Winch,
    /// Fixed length.
    Fixed,
}

/// `[tether]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct TetherSection {
    /// winch or fixed.
    pub kind: TetherKind,
    /// Length when fixed, m.
    pub length: f64,
    /// EA, N.
    pub stiffness: f64,
    /// Of the vehicle on the line.
    pub damping_ratio: f64,
    /// kg/m.
    pub line_density: f64,
    /// m.
    pub diameter: f64,
    /// Below the centre of mass, m.
    pub attachment: f64,
    /// Start of the vehicle from the anchor (winch), m.
    pub start_distance: f64,
    /// s.
    pub winch_lag: f64,
    /// ±.
    pub winch_error: f64,
    /// N.
    pub winch_friction: f64,
    /// N.
    pub winch_ripple: f64,
    /// Longest line, m.
    pub winch_length_max: f64,
}

impl Default for TetherSection {
    fn default() -> Self {
        Self {
            kind: TetherKind::Winch,
            length: 10.0,
            stiffness: 3_000.0,
            damping_ratio: 0.15,
            line_density: 0.002,
            diameter: 0.0015,
            attachment: 0.05,
            start_distance: 0.8,
            winch_lag: 0.05,
            winch_error: 0.03,
            winch_friction: 0.3,
            winch_ripple: 0.15,
            winch_length_max: 60.0,
        }
    }
}

/// `[wind]`.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct WindSection {
    /// Mean, m/s.
    pub speed: f64,
    /// Direction from which it blows, rad from North; drawn by the seed when absent.
    pub from: Option<f64>,
    /// Dryden turbulence on top.
    pub gusts: bool,
}

/// `[sensors]`: standard deviations and densities; zero everything for ideal sensors.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct SensorSection {
    /// rad/s/√Hz.
    pub gyro_noise_density: f64,
    /// m/s²/√Hz.
    pub accel_noise_density: f64,
    /// ±, rad/s.
    pub gyro_bias: f64,
    /// ±, m/s².
    pub accel_bias: f64,
    /// Random walk, rad/s/√s.
    pub gyro_drift: f64,
    /// Random walk, m/s²/√s.
    pub accel_drift: f64,
    /// How much the inertial sensor still warms up after the start, K. A board that was just switched
    /// on has about 12 to go; the default is one that stood for some minutes.
    pub warm_up: f64,
    /// Accelerometer vibration at hover, m/s² rms.
    pub vibration: f64,
    /// Gyro vibration per accelerometer vibration, rad/s per m/s².
    pub gyro_vibration_ratio: f64,
    /// m.
    pub range_noise: f64,
    /// Pa.
    pub pressure_noise: f64,
    /// Pa/√s.
    pub pressure_drift: f64,
    /// Winch encoder, m.
    pub length_noise: f64,
    /// Every n-th rangefinder frame loses a byte; 0 = none.
    pub range_lost_bytes: u64,
}

impl Default for SensorSection {
    fn default() -> Self {
        Self {
            gyro_noise_density: 4.9e-5,
            accel_noise_density: 6.9e-4,
            gyro_bias: 0.0087,
            accel_bias: 0.05,
            gyro_drift: 3e-5,
            accel_drift: 1e-4,
            warm_up: 2.0,
            vibration: 1.0,
            gyro_vibration_ratio: 0.005,
            range_noise: 0.02,
            pressure_noise: 0.5,
            pressure_drift: 0.2,
            length_noise: 0.02,
            range_lost_bytes: 200,
        }
    }
}

/// `[battery]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct BatterySection {
    /// In series.
    pub cells: f64,
    /// A h.
    pub capacity: f64,
    /// Ω.
    pub resistance: f64,
    /// 0..1.
    pub charge: f64,
}

impl Default for BatterySection {
    fn default() -> Self {
        Self { cells: 4.0, capacity: 5.2, resistance: 0.02, charge: 0.95 }
    }
}

/// What can be broken.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// Inertial registers keep their last values.
    ImuFrozen,
    /// No inertial data-ready.
    ImuSilent,
    /// The inertial sensor no longer drives its bus.
    ImuDead,
    /// Rangefinder silent.
    RangefinderLost,
    /// Barometer silent.
    BarometerLost,
    /// Both altimeters silent.
    AltimeterLost,
    /// The line is cut.
    TetherBroken,
    /// The winch no longer reports its length.
    WinchSilent,
    /// The battery is at `value` (0..1) of its charge.
    BatteryAt,
    /// Nothing from the ground station arrives.
    LinkLost,
    /// The gyro reads `value` rad/s too much on every axis.
    GyroBias,
}

/// `[[fault]]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FaultSection {
    /// What.
    pub kind: FaultKind,
    /// s from the start.
    pub at: f64,
    /// s; to the end when absent.
    #[serde(default)]
    pub duration: Option<f64>,
    /// For the kinds that have one.
    #[serde(default)]
    pub value: f64,
}

/// `[[mission]]`: one step of the built-in pilot.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Step {
    /// Wait until the vehicle says that it can be armed, then arm.
    Arm,
    /// Take off to this altitude, m, and wait for the hold.
    Takeoff {
        /// m over the anchor.
        altitude: f64,
    },
    /// Stay, and measure.
    Hold {
        /// s.
        seconds: f64,
    },
    /// Go to another place and wait until there; absent coordinates stay.
    Move {
        /// rad.
        #[serde(default)]
        elevation: Option<f64>,
        /// rad.
        #[serde(default)]
        azimuth: Option<f64>,
        /// m.
        #[serde(default)]
        length: Option<f64>,
        /// N.
        #[serde(default)]
        tension: Option<f64>,
    },
    /// Land and wait until disarmed.
    Land,
    /// Wait until disarmed, whatever the reason.
    AwaitDisarmed {
        /// s.
        timeout: f64,
    },
}

/// What is wrong with a scenario; one line, naming file and key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError(pub String);

impl std::fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}
impl std::error::Error for ScenarioError {}

impl Scenario {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`ScenarioError`].
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let name = path.display();
        let text =
            std::fs::read_to_string(path).map_err(|e| ScenarioError(format!("{name}: {e}")))?;
        Self::parse(&text, &name.to_string())
    }

    /// Checks a text; `name` stands in the errors.
    ///
    /// # Errors
    /// [`ScenarioError`].
    pub fn parse(text: &str, name: &str) -> Result<Self, ScenarioError> {
        let scenario: Self = toml::from_str(text).map_err(|e| {
            let line = e
                .span()
                .map_or(0, |span| text.get(..span.start).unwrap_or("").lines().count().max(1));
            let message = e.message().replace('\n', " ");
            ScenarioError(format!("{name}:{line}: {message}"))
        })?;
        scenario.check().map_err(|e| ScenarioError(format!("{name}: {e}")))?;
        Ok(scenario)
    }

    /// Every number within its range.
    fn check(&self) -> Result<(), String> {
        let (v, t, w, s, b) =
            (&self.vehicle, &self.tether, &self.wind, &self.sensors, &self.battery);
        let [ix, iy, iz] = v.inertia;
        let [dx, dy, dz] = v.drag_linear;
        let ranges = [
            ("vehicle.mass", v.mass, 0.1, 50.0),
            ("vehicle.inertia[0]", ix, 1e-4, 10.0),
            ("vehicle.inertia[1]", iy, 1e-4, 10.0),
            ("vehicle.inertia[2]", iz, 1e-4, 10.0),
            ("vehicle.arm", v.arm, 0.03, 2.0),
            ("vehicle.thrust_coefficient", v.thrust_coefficient, 1e-8, 1e-2),
            ("vehicle.torque_ratio", v.torque_ratio, 1e-4, 0.5),
            ("vehicle.rotor_speed_max", v.rotor_speed_max, 50.0, 10_000.0),
            ("vehicle.nominal_voltage", v.nominal_voltage, 3.0, 60.0),
            ("vehicle.throttle_curve", v.throttle_curve, 0.3, 2.0),
            ("vehicle.rotor_time_constant", v.rotor_time_constant, 1e-3, 1.0),
            ("vehicle.common_thrust_error", v.common_thrust_error, 0.0, 0.5),
            ("vehicle.rotor_thrust_error", v.rotor_thrust_error, 0.0, 0.5),
            ("vehicle.drag_linear[0]", dx, 0.0, 10.0),
            ("vehicle.drag_linear[1]", dy, 0.0, 10.0),
            ("vehicle.drag_linear[2]", dz, 0.0, 10.0),
            ("vehicle.drag_quadratic", v.drag_quadratic, 0.0, 10.0),
            ("vehicle.rate_damping", v.rate_damping, 0.0, 1.0),
            ("vehicle.leg_height", v.leg_height, 0.02, 2.0),
            ("vehicle.heading", v.heading, -6.3, 6.3),
            ("tether.length", t.length, 1.0, 200.0),
            ("tether.stiffness", t.stiffness, 10.0, 1e7),
            ("tether.damping_ratio", t.damping_ratio, 0.0, 2.0),
            ("tether.line_density", t.line_density, 0.0, 1.0),
            ("tether.diameter", t.diameter, 0.0, 0.05),
            ("tether.attachment", t.attachment, -0.5, 0.5),
            ("tether.start_distance", t.start_distance, 0.2, 5.0),
            ("tether.winch_lag", t.winch_lag, 1e-3, 5.0),
            ("tether.winch_error", t.winch_error, 0.0, 0.5),
            ("tether.winch_friction", t.winch_friction, 0.0, 20.0),
            ("tether.winch_ripple", t.winch_ripple, 0.0, 20.0),
            ("tether.winch_length_max", t.winch_length_max, 1.0, 500.0),
            ("wind.speed", w.speed, 0.0, 25.0),
            ("wind.from", w.from.unwrap_or(0.0), -6.3, 6.3),
            ("sensors.gyro_noise_density", s.gyro_noise_density, 0.0, 0.1),
            ("sensors.accel_noise_density", s.accel_noise_density, 0.0, 1.0),
            ("sensors.gyro_bias", s.gyro_bias, 0.0, 1.0),
            ("sensors.accel_bias", s.accel_bias, 0.0, 5.0),
            ("sensors.gyro_drift", s.gyro_drift, 0.0, 0.1),
            ("sensors.accel_drift", s.accel_drift, 0.0, 1.0),
            ("sensors.warm_up", s.warm_up, -50.0, 50.0),
            ("sensors.vibration", s.vibration, 0.0, 50.0),
            ("sensors.gyro_vibration_ratio", s.gyro_vibration_ratio, 0.0, 1.0),
            ("sensors.range_noise", s.range_noise, 0.0, 5.0),
            ("sensors.pressure_noise", s.pressure_noise, 0.0, 1000.0),
            ("sensors.pressure_drift", s.pressure_drift, 0.0, 100.0),
            ("sensors.length_noise", s.length_noise, 0.0, 5.0),
            ("battery.cells", b.cells, 1.0, 14.0),
            ("battery.capacity", b.capacity, 0.1, 1000.0),
            ("battery.resistance", b.resistance, 0.0, 1.0),
            ("battery.charge", b.charge, 0.0, 1.0),
        ];
        for (key, value, min, max) in ranges {
            within(key, value, min, max)?;
        }
        for (i, fault) in self.fault.iter().enumerate() {
            within(&format!("fault[{i}].at"), fault.at, 0.0, 1e6)?;
            within(&format!("fault[{i}].duration"), fault.duration.unwrap_or(0.0), 0.0, 1e6)?;
            within(&format!("fault[{i}].value"), fault.value, -10.0, 10.0)?;
        }
        for (i, step) in self.mission.iter().enumerate() {
            let (key, value, min, max) = match step {
                Step::Takeoff { altitude } => ("altitude", *altitude, 0.5, 200.0),
                Step::Hold { seconds } => ("seconds", *seconds, 0.0, 1e6),
                Step::AwaitDisarmed { timeout } => ("timeout", *timeout, 0.0, 1e6),
                Step::Arm | Step::Land | Step::Move { .. } => continue,
            };
            within(&format!("mission[{i}].{key}"), value, min, max)?;
        }
        let mut params = Params::default();
        for (name, &value) in &self.params {
            set_param(&mut params, name, value).map_err(|e| format!("params.{name}: {e}"))?;
        }
        Ok(())
    }

    /// Where the vehicle stands: distance from the anchor, m, and heading, rad.
    #[must_use]
    pub fn start(&self) -> (f64, f64) {
        let height = self.vehicle.leg_height;
        let distance = match self.tether.kind {
            TetherKind::Winch => self.tether.start_distance,
            // Just short of taut, as an operator lays it out.
            TetherKind::Fixed => (self.tether.length.powi(2) - height.powi(2)).sqrt() - 0.02,
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
                line_density: t.line_density,
                diameter: t.diameter,
                attachment: t.attachment,
                is_broken: false,
            },
            wind: WindModel {
                speed: self.wind.speed,
                from: self.wind.from.unwrap_or(from),
                gusts: if self.wind.gusts { Gusts::Dryden } else { Gusts::None },
            },
            ground: GroundModel {
                leg_height: v.leg_height,
                leg_spread: 0.15,
                stiffness: 2_000.0,
                damping: 60.0,
                friction: 0.8,
            },
            battery: BatteryModel {
                cells: self.battery.cells,
                capacity: self.battery.capacity,
                resistance: self.battery.resistance,
                charge: self.battery.charge,
                base_power: 4.0,
            },
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
            ("TET_KIND", if t.kind == TetherKind::Winch { 1.0 } else { 0.0 }),
            ("TET_LENGTH", t.length),
            ("TET_LIN_DENS", t.line_density),
            ("TET_START_DIST", t.start_distance),
            ("TET_HDG0", v.heading),
        ];
        for (name, value) in known {
            set_param(&mut params, name, value as f32).map_err(ScenarioError)?;
        }
        for (name, &value) in &self.params {
            set_param(&mut params, name, value).map_err(ScenarioError)?;
        }
        Ok(params)
    }
}

fn within(key: &str, value: f64, min: f64, max: f64) -> Result<(), String> {
    if value >= min && value <= max {
        Ok(())
    } else {
        Err(format!("{key} = {value} is outside {min} to {max}"))
    }
}

/// Sets a parameter by name.
///
/// # Errors
/// One line naming the parameter and what it may be.
pub fn set_param(params: &mut Params, name: &str, value: f32) -> Result<(), String> {
    let index = Params::index_of(name.as_bytes()).ok_or_else(|| {
        let start = name.split('_').next().unwrap_or(name);
        let near: Vec<_> =
            META.iter().map(|m| m.name).filter(|n| n.starts_with(start)).take(5).collect();
        let hint = if near.is_empty() {
            String::new()
        } else {
            format!("; there are {}", near.join(", "))
        };
        format!("no parameter {name}{hint}")
    })?;
    params.set(index, value).map_err(|e| match e {
        ParamError::OutOfRange { min, max } => {
            format!("{name} = {value} is outside {min} to {max}")
        }
        ParamError::NotANumber => format!("{name} = {value} is not a whole or finite number"),
        ParamError::Unknown => format!("no parameter {name}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_file_key_and_range() {
        let cases = [
            ("[vehicle]\nmass = -1.0", "s.toml: vehicle.mass = -1 is outside 0.1 to 50"),
            ("[wind]\nspeed = nan", "s.toml: wind.speed = NaN is outside 0 to 25"),
            ("[vehicle]\nmas = 1.0", "s.toml:2: unknown field `mas`"),
            (
                "[params]\nRATE_Q = 1.0",
                "s.toml: params.RATE_Q: no parameter RATE_Q; there are RATE_P",
            ),
            (
                "[params]\nVEH_MASS = 99.0",
                "s.toml: params.VEH_MASS: VEH_MASS = 99 is outside 0.1 to 50",
            ),
            ("[[fault]]\nkind = \"imu_frozen\"\nat = -2.0", "s.toml: fault[0].at = -2 is outside"),
            ("[[mission]]\ndo = \"loop\"", "unknown variant `loop`"),
            ("title = 3", "s.toml:1: invalid type"),
        ];
        for (text, want) in cases {
            let got = Scenario::parse(text, "s.toml").unwrap_err().0;
            assert!(got.contains(want), "{got:?} should contain {want:?}");
            assert!(!got.contains('\n'));
        }
    }

    #[test]
    fn an_empty_file_is_the_default_vehicle() {
        assert_eq!(Scenario::parse("", "s.toml").unwrap(), Scenario::default());
        assert!(Scenario::default().params().is_ok());
    }
}
