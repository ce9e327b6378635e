//! A log → time series.

use logged::Logged;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

mod logged {
    //! Topics as the derive wants them: public, one struct each.
    #![allow(missing_docs)]
    use yule_log::{ULogData, ULogMessages};

    #[derive(ULogMessages)]
    pub enum Logged {
        Position(VehicleLocalPosition),
        TruePosition(VehicleLocalPositionGroundtruth),
        Setpoint(VehicleLocalPositionSetpoint),
        Tether(TetherState),
        TrueTether(TetherStateGroundtruth),
        Motors(ActuatorMotors),
        Taut(EstimatorTaut),
    }

    #[derive(ULogData)]
    pub struct VehicleLocalPosition {
        pub timestamp: u64,
        pub x: f32,
        pub y: f32,
        pub z: f32,
        pub xy_valid: bool,
    }
    #[derive(ULogData)]
    pub struct VehicleLocalPositionGroundtruth {
        pub timestamp: u64,
        pub x: f32,
        pub y: f32,
        pub z: f32,
    }
    #[derive(ULogData)]
    pub struct VehicleLocalPositionSetpoint {
        pub timestamp: u64,
        pub x: f32,
        pub y: f32,
        pub z: f32,
    }
    #[derive(ULogData)]
    pub struct TetherState {
        pub timestamp: u64,
        pub elevation: f32,
        pub azimuth: f32,
        pub tension: f32,
    }
    #[derive(ULogData)]
    pub struct TetherStateGroundtruth {
        pub timestamp: u64,
        pub elevation: f32,
        pub azimuth: f32,
        pub tension: f32,
    }
    #[derive(ULogData)]
    pub struct EstimatorTaut {
        pub timestamp: u64,
        pub elevation: f32,
        pub link_force: f32,
        pub elevation_setpoint: f32,
        pub active: bool,
    }
    #[derive(ULogData)]
    pub struct ActuatorMotors {
        pub timestamp: u64,
        pub winch_tension: f32,
    }
}

/// Samples over time, s.
pub type Series = Vec<(f64, f64)>;

/// What the pictures need: estimate, truth and set-point of each quantity.
#[derive(Clone, Debug, Default)]
pub struct FlightData {
    /// North, East, Down, m.
    pub estimate: [Series; 3],
    /// The same.
    pub truth: [Series; 3],
    /// The same.
    pub setpoint: [Series; 3],
    /// Elevation rad, azimuth rad, tension N.
    pub tether: [Series; 3],
    /// The same.
    pub true_tether: [Series; 3],
    /// Tension set-point of the winch, N.
    pub winch: Series,
    /// In the taut-link modes: elevation rad and link force N by inertia, elevation set-point, rad.
    pub taut: [Series; 3],
}

fn push(into: &mut [Series; 3], timestamp: u64, values: [f32; 3]) {
    for (series, value) in into.iter_mut().zip(values) {
        series.push((timestamp as f64 * 1e-6, f64::from(value)));
    }
}

impl FlightData {
    /// Reads a log.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn read(path: &Path) -> Result<Self, String> {
        let name = path.display();
        let file = File::open(path).map_err(|e| format!("{name}: {e}"))?;
        let mut data = Self::default();
        let stream = Logged::stream(BufReader::new(file)).map_err(|e| format!("{name}: {e}"))?;
        for message in stream {
            match message.map_err(|e| format!("{name}: {e}"))? {
                Logged::Position(m) if !m.xy_valid => {}
                Logged::Position(m) => push(&mut data.estimate, m.timestamp, [m.x, m.y, m.z]),
                Logged::TruePosition(m) => push(&mut data.truth, m.timestamp, [m.x, m.y, m.z]),
                Logged::Setpoint(m) => push(&mut data.setpoint, m.timestamp, [m.x, m.y, m.z]),
                Logged::Tether(m) => {
                    push(&mut data.tether, m.timestamp, [m.elevation, m.azimuth, m.tension])
                }
                Logged::TrueTether(m) => {
                    push(&mut data.true_tether, m.timestamp, [m.elevation, m.azimuth, m.tension]);
                }
                Logged::Taut(m) if !m.active => {}
                Logged::Taut(m) => {
                    let values = [m.elevation, m.link_force, m.elevation_setpoint];
                    push(&mut data.taut, m.timestamp, values);
                }
                Logged::Motors(m) => {
                    data.winch.push((m.timestamp as f64 * 1e-6, f64::from(m.winch_tension)));
                }
            }
        }
        Ok(data)
    }
}
