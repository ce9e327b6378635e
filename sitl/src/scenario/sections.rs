//! The sections of a scenario file and their defaults.

use serde::{Deserialize, Serialize};

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
    /// Rigid, pushes.
    Strut,
    /// Rigid, pulls and pushes.
    Bar,
    /// Flies free.
    None,
}

impl TetherKind {
    /// As the firmware's parameter.
    #[must_use]
    pub fn parameter(self) -> f64 {
        match self {
            Self::Fixed => 0.0,
            Self::Winch => 1.0,
            Self::Strut => 2.0,
            Self::Bar => 3.0,
            Self::None => 4.0,
        }
    }
}

/// `[tether]`.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct TetherSection {
    /// winch, fixed, strut, bar or none.
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
    /// Fixed: how much closer than taut the vehicle starts, m.
    pub start_slack: f64,
    /// Start of the vehicle from the anchor (winch) or the origin (none), m.
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
            start_slack: 0.0,
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
    /// Peak of a gust of 1-cos shape, 3 s long, every 5 s, each from another side, m/s; a fifth of it as
    /// turbulence on top.
    pub pulse: f64,
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

/// What a taut-link mode controls beside the elevation.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum TautControl {
    /// Link force.
    Force,
    /// Pitch.
    Attitude,
}

/// `[[mission]]`: one step of the built-in mission runner.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Step {
    /// Wait until the vehicle reports that it can be armed, then arm.
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
    /// Change to a taut-link mode and wait until it flies.
    Taut {
        /// What it controls.
        control: TautControl,
    },
    /// A smooth step in a taut-link mode; wait until it is flown.
    TautMove {
        /// From, to, rad.
        elevation: [f64; 2],
        /// Link force, N, or pitch, rad: from, to.
        second: [f64; 2],
        /// Which of the two.
        control: TautControl,
        /// s.
        duration: f64,
    },
    /// Change to Tether Angle and wait until it flies.
    TetherAngle,
    /// Change to Pendulum and wait until it flies; whoever holds the rod lets go.
    Pendulum,
    /// A hand takes the rod; the next step follows at once.
    CatchRod,
    /// Whoever holds the tether begins to walk; the next step follows at once.
    WalkAnchor {
        /// North and East, m.
        way: [f64; 2],
        /// m/s.
        speed: f64,
        /// Up to that speed and down again, s.
        ramp: f64,
    },
    /// Take the sticks: throttle down, mode Altitude. The mission keeps them from here on.
    Altitude,
    /// In Altitude: climb to a height and shake thrust, roll and pitch there.
    Excite {
        /// m over the ground.
        altitude: f64,
        /// s, the climb included.
        seconds: f64,
    },
    /// Back to Tether Hold.
    TetherHold,
    /// Land and wait until disarmed.
    Land,
    /// Wait until disarmed, whatever the reason.
    AwaitDisarmed {
        /// s.
        timeout: f64,
    },
}
