//! All keys of a scenario's sections. One line each: key, type, unit, default, range.

use super::key::sections;
use super::{Gnss, RadioKind, WindRow};
use crate::plant::Hub;
use serde::{Deserialize, Serialize};

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

/// How the line is simulated.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum LineModel {
    /// A straight link.
    #[default]
    Straight,
    /// Segments that weigh, sag, swing and lie on the ground.
    Chain,
}

/// What pushes on the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DisturbanceKind {
    /// Nothing pushes.
    #[default]
    None,
    /// (-0.5, 0.5, -0.8) N.
    Constant,
    /// Filtered white noise, a new sample every 0.1 s.
    Stochastic,
}

sections! {
    /// `[vehicle]`: the airframe as it really is.
    "vehicle" VehicleSection {
        /// quad-1.5, quad-3.5, quad-8, hexa-6 or octo-9: the keys of this section at once. The file's own keys come first.
        preset: String [""] = String::new();
        /// Take-off mass, battery included, tether and load not.
        mass: f64 ["kg"] = 1.5, in 0.1 ..= 50.0;
        /// Moments of inertia about nose, right-hand and down axis.
        inertia: [f64; 3] ["kg m^2"] = [0.016, 0.016, 0.029], in 1e-5 ..= 10.0;
        /// Unit of `rotors`.
        arm: f64 ["m"] = 0.177, in 0.03 ..= 2.0;
        /// Where the rotors sit, forward and to the right in units of `arm`, and 1 if its drag yaws the nose to the right, else
        /// -1: `[{ x = 1, y = 1, spin = 1 }, ...]`, in the order of the motor outputs; none: a quad on an X.
        rotors: Vec<Hub> [""] = Vec::new();
        /// Thrust of a rotor per speed squared.
        thrust_coefficient: f64 ["N/(rad/s)^2"] = 1.55e-5, in 1e-8 ..= 1e-2;
        /// Drag torque of a rotor per thrust.
        torque_ratio: f64 ["m"] = 0.0167, in 1e-4 ..= 0.5;
        /// Speed of a rotor at full throttle and nominal voltage.
        rotor_speed_max: f64 ["rad/s"] = 723.0, in 50.0 ..= 10_000.0;
        /// Battery voltage at which `rotor_speed_max` holds.
        nominal_voltage: f64 ["V"] = 15.2, in 3.0 ..= 60.0;
        /// Exponent from throttle to rotor speed.
        throttle_curve: f64 [""] = 0.75, in 0.3 ..= 2.0;
        /// Time constant of a rotor's speed.
        rotor_time_constant: f64 ["s"] = 0.03, in 1e-3 ..= 1.0;
        /// Error of the thrust of all rotors together, drawn within plus or minus this share.
        common_thrust_error: f64 [""] = 0.02, in 0.0 ..= 0.5;
        /// Error of the thrust of each rotor, drawn within plus or minus this share.
        rotor_thrust_error: f64 [""] = 0.01, in 0.0 ..= 0.5;
        /// Linear drag along nose, right-hand and down axis.
        drag_linear: [f64; 3] ["N s/m"] = [0.18, 0.18, 0.06], in 0.0 ..= 10.0;
        /// Quadratic drag.
        drag_quadratic: f64 ["N s^2/m^2"] = 0.012, in 0.0 ..= 10.0;
        /// Damping of the body rates by the air.
        rate_damping: f64 ["N m s/rad"] = 0.004, in 0.0 ..= 1.0;
        /// Centre of mass over the feet.
        leg_height: f64 ["m"] = 0.15, in 0.02 ..= 2.0;
        /// Heading of the nose at the start, from North.
        heading: f64 ["rad"] = 0.0, in -6.3 ..= 6.3;
        /// Centre of mass from the middle of the rotors and the feet, forward and to the right. The inertial sensor sits in
        /// the centre of mass.
        centre: [f64; 2] ["m"] = [0.0, 0.0], in -0.5 ..= 0.5;
    }

    /// `[tether]`: the line and its ground end.
    "tether" TetherSection {
        /// light, power-10, power-30 or power-67: what the line is made of, in g/m. The file's own keys come first.
        preset: String [""] = String::new();
        /// winch, fixed, strut, bar or none.
        kind: TetherKind [""] = TetherKind::Winch;
        /// straight or chain; only a winch's or a fixed line can be a chain.
        model: LineModel [""] = LineModel::Straight;
        /// Segments of a chain; 0 = one for each 6 m of the longest line, from 5 to 20.
        segments: u64 [""] = 0, in 0.0 ..= 50.0;
        /// Length when fixed or rigid.
        length: f64 ["m"] = 10.0, in 1.0 ..= 200.0;
        /// Stiffness EA.
        stiffness: f64 ["N"] = 3_000.0, in 10.0 ..= 1e7;
        /// Damping ratio of the vehicle on the line.
        damping_ratio: f64 [""] = 0.15, in 0.0 ..= 2.0;
        /// Mass per length.
        line_density: f64 ["kg/m"] = 0.002, in 0.0 ..= 1.0;
        /// Diameter, for the wind's drag.
        diameter: f64 ["m"] = 0.0015, in 0.0 ..= 0.05;
        /// Attachment below the centre of mass.
        attachment: f64 ["m"] = 0.05, in -0.5 ..= 0.5;
        /// Attachment from the middle of the rotors, forward and to the right.
        attachment_aside: [f64; 2] ["m"] = [0.0, 0.0], in -0.5 ..= 0.5;
        /// Fixed: how much closer than taut the vehicle starts.
        start_slack: f64 ["m"] = 0.0, in 0.0 ..= 50.0;
        /// Start of the vehicle from the anchor (winch) or the origin (none).
        start_distance: f64 ["m"] = 0.8, in 0.2 ..= 5.0;
        /// Time constant of the winch's tension.
        winch_lag: f64 ["s"] = 0.05, in 1e-3 ..= 5.0;
        /// Error of the winch's tension, drawn within plus or minus this share.
        winch_error: f64 [""] = 0.03, in 0.0 ..= 0.5;
        /// Friction of the winch.
        winch_friction: f64 ["N"] = 0.3, in 0.0 ..= 20.0;
        /// Ripple of the winch's tension.
        winch_ripple: f64 ["N"] = 0.15, in 0.0 ..= 20.0;
        /// What moves with the line at the winch: drum, line on it, gear and motor. Only a chain feels it.
        winch_inertia: f64 ["kg"] = 0.5, in 0.01 ..= 1000.0;
        /// Gain of the winch's integral loop over its load cell. Only for a chain.
        winch_gain: f64 ["1/s"] = 0.5, in 0.0 ..= 20.0;
        /// Most that the winch's motor pulls. Only for a chain.
        winch_force_max: f64 ["N"] = 60.0, in 0.1 ..= 10_000.0;
        /// Fastest line of the winch. Only for a chain.
        winch_speed_max: f64 ["m/s"] = 4.0, in 0.01 ..= 50.0;
        /// Longest line on the winch.
        winch_length_max: f64 ["m"] = 60.0, in 1.0 ..= 500.0;
    }

    /// `[station]`: what the ground end measures and feeds in.
    "station" StationSection {
        /// Error of the length that its encoder shows, drawn within plus or minus this share: slip, and line that
        /// lies in layers on the drum.
        length_slip: f64 [""] = 0.0, in 0.0 ..= 0.2;
        /// Step of the encoder.
        length_resolution: f64 ["m"] = 0.001, in 0.0 ..= 1.0;
        /// Noise of its load cell.
        tension_noise: f64 ["N"] = 0.1, in 0.0 ..= 50.0;
        /// Offset of each of its direction encoders, drawn within plus or minus this.
        angle_offset: f64 ["rad"] = 0.005, in 0.0 ..= 0.5;
        /// Friction of their arm: how far the line turns before it follows.
        angle_hysteresis: f64 ["rad"] = 0.01, in 0.0 ..= 0.5;
        /// Voltage that it feeds into the line; 0 = the vehicle flies on its battery.
        supply_voltage: f64 ["V"] = 0.0, in 0.0 ..= 1500.0;
        /// Resistance of the line, there and back, per metre.
        supply_resistance: f64 ["Ohm/m"] = 0.1, in 0.0 ..= 10.0;
        /// Most that arrives.
        supply_power: f64 ["W"] = 3000.0, in 0.0 ..= 100_000.0;
    }

    /// `[base]`: what the station stands on, and the ground under the vehicle with it.
    "base" BaseSection {
        /// Times, s, and places, North, East, down, m, in the order of the times.
        table: Vec<[f64; 4]> ["s, m, m, m"] = Vec::new();
        /// Up and down, amplitude.
        heave: f64 ["m"] = 0.0, in 0.0 ..= 5.0;
        /// Its period.
        heave_period: f64 ["s"] = 8.0, in 1.0 ..= 60.0;
        /// To and fro, amplitude; half of it across.
        surge: f64 ["m"] = 0.0, in 0.0 ..= 10.0;
        /// Its period.
        surge_period: f64 ["s"] = 11.0, in 1.0 ..= 60.0;
        /// Roll about North, amplitude.
        roll: f64 ["rad"] = 0.0, in 0.0 ..= 0.5;
        /// Its period.
        roll_period: f64 ["s"] = 7.0, in 1.0 ..= 60.0;
        /// Pitch about East, amplitude.
        pitch: f64 ["rad"] = 0.0, in 0.0 ..= 0.5;
        /// Its period.
        pitch_period: f64 ["s"] = 6.0, in 1.0 ..= 60.0;
        /// Sea state, Douglas: heave, roll and pitch of a small vessel at once, as sines. The file's own come first.
        sea_state: u64 [""] = 0, in 0.0 ..= 6.0;
    }

    /// `[capture]`: motion capture.
    "capture" CaptureSection {
        /// Samples per second; zero: no motion capture.
        rate: f64 ["Hz"] = 0.0, in 0.0 ..= 1000.0;
        /// Time until a sample arrives.
        delay: f64 ["s"] = 0.02, in 0.0 ..= 1.0;
        /// Further delay, drawn up to this much.
        jitter: f64 ["s"] = 0.002, in 0.0 ..= 1.0;
        /// Share of samples that never arrive.
        dropped: f64 [""] = 0.01, in 0.0 ..= 1.0;
        /// Standard deviation of the position, each axis.
        position_noise: f64 ["m"] = 1e-3, in 0.0 ..= 1.0;
        /// Standard deviation of the velocity, each axis; zero: none is sent.
        velocity_noise: f64 ["m/s"] = 0.0, in 0.0 ..= 10.0;
        /// By which share more the velocity is shown than it is.
        velocity_scale: f64 [""] = 0.0, in -0.5 ..= 0.5;
        /// Whether the position is sent.
        position: bool [""] = true;
        /// Standard deviation of the attitude, each axis.
        attitude_noise: f64 ["rad"] = 2e-3, in 0.0 ..= 1.0;
        /// Standard deviation of the rod's direction, each axis.
        rod_noise: f64 ["rad"] = 2e-3, in 0.0 ..= 1.0;
    }

    /// `[rod]`: a load balanced on top. Somebody holds it until the mission's step `pendulum`.
    "rod" RodSection {
        /// Mass of the load; zero: no rod.
        load_mass: f64 ["kg"] = 0.0, in 0.0 ..= 10.0;
        /// Length of the rod.
        length: f64 ["m"] = 0.7, in 0.1 ..= 5.0;
        /// How far the hand leans it.
        tilt: f64 ["rad"] = 0.05, in 0.0 ..= 1.0;
        /// Towards where, from North.
        azimuth: f64 ["rad"] = 0.8, in -6.3 ..= 6.3;
        /// From the change of mode until the hand releases it.
        reaction: f64 ["s"] = 0.2, in 0.0 ..= 5.0;
    }

    /// `[push]`: a force on the vehicle.
    "push" PushSection {
        /// none, constant or stochastic.
        kind: DisturbanceKind [""] = DisturbanceKind::None;
    }

    /// `[wind]`.
    "wind" WindSection {
        /// Mean speed.
        speed: f64 ["m/s"] = 0.0, in 0.0 ..= 25.0;
        /// Direction from which it blows, from North; drawn by the seed when absent.
        from: Option<f64> ["rad"] = None, in -6.3 ..= 6.3;
        /// Exponent of the wind over height, with the speed at the vehicle: 0 = the same all along the line.
        shear: f64 [""] = 0.0, in 0.0 ..= 1.0;
        /// Dryden turbulence on top.
        gusts: bool [""] = false;
        /// Peak of a gust of 1-cos shape, 3 s long, every 5 s, each from another side; a fifth of it as
        /// turbulence on top.
        pulse: f64 ["m/s"] = 0.0, in 0.0 ..= 25.0;
        /// Times, s, speeds, m/s, directions, rad from North, and perhaps down, m/s, in the order of the times, instead of
        /// `speed` and `from`.
        table: Vec<WindRow> ["s, m/s, rad, m/s"] = Vec::new();
    }

    /// `[sensors]`: standard deviations and densities; zero everything for ideal sensors.
    "sensors" SensorSection {
        /// White noise of the gyro.
        gyro_noise_density: f64 ["rad/s/sqrt(Hz)"] = 4.9e-5, in 0.0 ..= 0.1;
        /// White noise of the accelerometer.
        accel_noise_density: f64 ["m/s^2/sqrt(Hz)"] = 6.9e-4, in 0.0 ..= 1.0;
        /// Offset of the gyro, each axis drawn within plus or minus this.
        gyro_bias: f64 ["rad/s"] = 0.0087, in 0.0 ..= 1.0;
        /// Offset of the accelerometer, each axis drawn within plus or minus this.
        accel_bias: f64 ["m/s^2"] = 0.05, in 0.0 ..= 5.0;
        /// Random walk of the gyro's offset.
        gyro_drift: f64 ["rad/s/sqrt(s)"] = 3e-5, in 0.0 ..= 0.1;
        /// Random walk of the accelerometer's offset.
        accel_drift: f64 ["m/s^2/sqrt(s)"] = 1e-4, in 0.0 ..= 1.0;
        /// In which both offsets come back to where they started: no part wanders for days.
        drift_time: f64 ["s"] = 1000.0, in 1.0 ..= 1e7;
        /// How much the inertial sensor still warms up after the start. A board that was just switched on
        /// has about 12 to go; the default is one that stood for some minutes.
        warm_up: f64 ["K"] = 2.0, in -50.0 ..= 50.0;
        /// Vibration of the accelerometer at hover, rms.
        vibration: f64 ["m/s^2"] = 1.0, in 0.0 ..= 50.0;
        /// Vibration of the gyro per vibration of the accelerometer.
        gyro_vibration_ratio: f64 ["rad s/m"] = 0.005, in 0.0 ..= 1.0;
        /// Noise of the rangefinder.
        range_noise: f64 ["m"] = 0.02, in 0.0 ..= 5.0;
        /// Noise of the barometer.
        pressure_noise: f64 ["Pa"] = 0.5, in 0.0 ..= 1000.0;
        /// Random walk of the barometer.
        pressure_drift: f64 ["Pa/sqrt(s)"] = 0.2, in 0.0 ..= 100.0;
        /// Noise of the winch's encoder.
        length_noise: f64 ["m"] = 0.02, in 0.0 ..= 5.0;
        /// Encoders of the line's two angles at the vehicle.
        vehicle_angles: bool [""] = false;
        /// Offset of each, drawn within plus or minus this.
        angle_offset: f64 ["rad"] = 0.005, in 0.0 ..= 0.5;
        /// Encoders of the line's direction at the station.
        ground_angles: bool [""] = false;
        /// Load cells at the vehicle and at the station.
        tension_cell: bool [""] = false;
        /// Noise of the one at the vehicle.
        cell_noise: f64 ["N"] = 0.05, in 0.0 ..= 50.0;
        /// A magnetometer.
        magnetometer: bool [""] = false;
        /// Earth's field: North, East, down.
        magnetic_field: [f64; 3] ["T"] = [2.1e-5, 1.5e-6, 4.3e-5], in -1e-4 ..= 1e-4;
        /// Noise of the magnetometer.
        magnetic_noise: f64 ["T"] = 3e-7, in 0.0 ..= 1e-4;
        /// Soft iron: error of each axis, drawn within plus or minus this share.
        magnetic_scale: f64 [""] = 0.03, in 0.0 ..= 0.5;
        /// Hard iron, each axis drawn within plus or minus this.
        magnetic_offset: f64 ["T"] = 1e-5, in 0.0 ..= 1e-3;
        /// Field of the current that comes up the line, per ampere.
        magnetic_per_ampere: f64 ["T/A"] = 2e-7, in 0.0 ..= 1e-4;
        /// An optical flow sensor with its computer: speed over the ground, 0.1 m/s of noise and 3 % of scale.
        flow: bool [""] = false;
        /// A satellite receiver: none, plain (metres off, and wandering) or rtk (2 cm).
        gnss: Gnss [""] = Gnss::None;
        /// A second inertial sensor, with errors of its own.
        second_imu: bool [""] = false;
        /// A receiver of a pilot's radio: none, crsf or sbus. `[[radio]]` says what the pilot does.
        radio: RadioKind [""] = RadioKind::None;
        /// Every n-th rangefinder frame loses a byte; 0 = none.
        range_lost_bytes: u64 [""] = 200;
    }

    /// `[battery]`.
    "battery" BatterySection {
        /// Cells in series.
        cells: f64 [""] = 4.0, in 1.0 ..= 14.0;
        /// Capacity.
        capacity: f64 ["A h"] = 5.2, in 0.1 ..= 1000.0;
        /// Internal resistance.
        resistance: f64 ["Ohm"] = 0.02, in 0.0 ..= 1.0;
        /// Share of the capacity at the start.
        charge: f64 [""] = 0.95, in 0.0 ..= 1.0;
    }
}
