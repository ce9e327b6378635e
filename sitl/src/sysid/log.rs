//! A flight's own log as a record: throttles, voltage, and minus mass times the specific force along the
//! body's down axis for the thrust.

use super::record::{CHANNELS, Record};
use crate::scenario::set_param;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use tautline_firmware::log::topics::mode_number;
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::Mode;
use yule_log::model::inst::ParameterValue;
use yule_log::model::msg::UlogMessage;
use yule_log::{ULogData, ULogMessages};

/// After the change into a mode that counts, s: take-off still shakes it.
const SETTLE: f64 = 2.0;
/// Closer to the ground than this its cushion and the feet push too, m.
const CLEAR: f32 = 1.5;
/// `vehicle_status.ground_state` in the air.
const IN_AIR: u8 = 2;

mod logged {
    //! Topics as the derive wants them.
    #![allow(missing_docs)]
    use super::{ULogData, ULogMessages, UlogMessage};

    // With `forward_other` the derive knows this name only.
    #[derive(ULogMessages)]
    pub enum LoggedMessages {
        Sensors(SensorCombined),
        Motors(ActuatorMotors),
        Status(VehicleStatus),
        Battery(BatteryStatus),
        Position(VehicleLocalPosition),
        #[yule_log(forward_other)]
        Other(UlogMessage),
    }
    #[derive(ULogData)]
    pub struct SensorCombined {
        pub accelerometer_m_s2: Vec<f32>,
    }
    #[derive(ULogData)]
    pub struct ActuatorMotors {
        pub timestamp: u64,
        pub control: Vec<f32>,
    }
    #[derive(ULogData)]
    pub struct VehicleStatus {
        pub nav_state: u8,
        pub ground_state: u8,
        pub timestamp: u64,
    }
    #[derive(ULogData)]
    pub struct VehicleLocalPosition {
        pub dist_bottom: f32,
    }
    #[derive(ULogData)]
    pub struct BatteryStatus {
        pub voltage_v: f32,
    }
}
use logged::LoggedMessages as Logged;

/// Reads the part flown in Altitude or Stabilize; the log's parameters are set into `params`.
///
/// # Errors
/// One line naming the file.
pub fn from_log(path: &Path, params: &mut Params) -> Result<Record, String> {
    let name = path.display().to_string();
    let file = File::open(path).map_err(|e| format!("{name}: {e}"))?;
    read_log(BufReader::new(file), &name, params)
}

/// The same from anywhere; `name` stands in the errors.
///
/// # Errors
/// One line naming the log.
pub fn read_log(input: impl Read, name: &str, params: &mut Params) -> Result<Record, String> {
    let stream = Logged::stream(input).map_err(|e| format!("{name}: {e}"))?;
    let by_stick = [Mode::Altitude, Mode::Stabilize].map(mode_number);
    let mut record = Record { voltage: Some(Vec::new()), ..Record::default() };
    let mut since: Option<f64> = None;
    let mut voltage = None;
    let mut is_clear = false;
    let mut throttle: Option<Vec<f32>> = None;
    let mut force = Mean::default();
    for message in stream {
        match message.map_err(|e| format!("{name}: {e}"))? {
            Logged::Other(UlogMessage::Parameter(p)) => {
                // Parameters of another version are not ours to check.
                let _ = set_param(params, &p.key, number(&p.value));
            }
            Logged::Other(_) => {}
            Logged::Position(p) => is_clear = p.dist_bottom > CLEAR,
            Logged::Battery(b) => voltage = Some(f64::from(b.voltage_v)),
            Logged::Status(s) => {
                let counts = s.ground_state == IN_AIR && by_stick.contains(&s.nav_state);
                since = counts.then(|| since.unwrap_or(s.timestamp as f64 * 1e-6));
            }
            Logged::Sensors(s) => {
                if let Some(down) = s.accelerometer_m_s2.get(2) {
                    force.add(f64::from(*down));
                }
            }
            Logged::Motors(m) => {
                let time = m.timestamp as f64 * 1e-6;
                let counts = is_clear && since.is_some_and(|since| time >= since + SETTLE);
                // What acted until now is what was sent at the end of the last period.
                let acted = throttle.replace(m.control);
                let (Some(down), Some(acted), Some(volts)) = (force.take(), acted, voltage) else {
                    continue;
                };
                if !counts || acted.len() < CHANNELS {
                    continue;
                }
                record.time.push(time);
                for (channel, u) in record.pwm.iter_mut().zip(&acted) {
                    channel.push(f64::from(*u));
                }
                record.thrust.push(-down * f64::from(params.mass));
                if let Some(list) = &mut record.voltage {
                    list.push(volts);
                }
            }
        }
    }
    if record.time.is_empty() {
        return Err(format!("{name}: nothing flown in Altitude or Stabilize"));
    }
    let names = std::array::from_fn(|i| format!("actuator_motors.control[{i}]"));
    record.check(&names).map_err(|e| format!("{name}: {e}"))?;
    Ok(record)
}

fn number(value: &ParameterValue) -> f32 {
    match value {
        ParameterValue::INT32(i) => *i as f32,
        ParameterValue::FLOAT(x) => *x,
    }
}

/// Between two motor samples.
#[derive(Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, x: f64) {
        self.sum += x;
        self.count += 1.0;
    }
    fn take(&mut self) -> Option<f64> {
        let mean = (self.count > 0.0).then(|| self.sum / self.count);
        *self = Self::default();
        mean
    }
}
