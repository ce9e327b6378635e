//! A flight's own log as a record: throttles, voltage, and minus mass times the specific force along the
//! body's down axis for the thrust.

use super::record::{CHANNELS, Record};
use crate::metrics::Mean;
use crate::scenario::set_param;
use crate::ulog::{Data, Log, Message, Value};
use std::fs;
use std::path::Path;
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::Mode;

/// After the change into a mode that counts, s: take-off still shakes it.
const SETTLE: f64 = 2.0;
/// Closer to the ground than this its cushion and the feet push too, m.
const CLEAR: f64 = 1.5;
/// `vehicle_status.ground_state` in the air.
const IN_AIR: f64 = 2.0;

/// Reads the part flown in Altitude or Stabilize; the log's parameters are set into `params`.
///
/// # Errors
/// One line naming the file.
pub fn from_log(path: &Path, params: &mut Params) -> Result<Record, String> {
    let name = path.display().to_string();
    let bytes = fs::read(path).map_err(|e| format!("{name}: {e}"))?;
    read_log(&bytes, &name, params)
}

/// The same from memory; `name` stands in the errors.
///
/// # Errors
/// One line naming the log.
pub fn read_log(bytes: &[u8], name: &str, params: &mut Params) -> Result<Record, String> {
    let mut log = Log::new(bytes).map_err(|e| format!("{name}: {e}"))?;
    let mut reader = Reader::default();
    for message in log.by_ref() {
        match message {
            Message::Parameter(key, value) => {
                // Parameters of another version are not ours to check.
                let _ = set_param(params, key, number(value));
            }
            Message::Data(data) if data.instance == 0 => {
                reader.add(&data, params).map_err(|e| format!("{name}: {e}"))?;
            }
            _ => {}
        }
    }
    let record = reader.record;
    if record.time.is_empty() {
        let notes: String = log.notes().lines().iter().map(|note| format!("; {note}")).collect();
        return Err(format!("{name}: nothing flown in Altitude or Stabilize{notes}"));
    }
    let names = std::array::from_fn(|i| format!("actuator_motors.control[{i}]"));
    record.check(&names).map_err(|e| format!("{name}: {e}"))?;
    Ok(record)
}

fn number(value: Value) -> f32 {
    match value {
        Value::Int(i) => i as f32,
        Value::Float(x) => x,
    }
}

/// What of a topic's fields is not there.
fn field(data: &Data, name: &str) -> Result<f64, String> {
    let topic = data.topic;
    data.number(name).ok_or_else(|| {
        format!("`{topic}` has no `{name}`: only logs that Tautline wrote tell the thrust")
    })
}

/// What the samples so far say.
struct Reader {
    record: Record,
    /// In a mode that counts, s.
    since: Option<f64>,
    voltage: Option<f64>,
    is_clear: bool,
    throttle: Option<Vec<f64>>,
    /// Between two motor samples.
    force: Mean,
}

impl Default for Reader {
    fn default() -> Self {
        Self {
            record: Record { voltage: Some(Vec::new()), ..Record::default() },
            since: None,
            voltage: None,
            is_clear: false,
            throttle: None,
            force: Mean::default(),
        }
    }
}

impl Reader {
    fn add(&mut self, data: &Data, params: &Params) -> Result<(), String> {
        match data.topic {
            "vehicle_local_position" => {
                self.is_clear = field(data, "dist_bottom")? > CLEAR;
            }
            "battery_status" => self.voltage = Some(field(data, "voltage_v")?),
            "vehicle_status" => {
                let by_stick = [Mode::Altitude, Mode::Stabilize]
                    .map(|mode| f64::from(mode.rule().nav_state()));
                let counts = field(data, "ground_state")? == IN_AIR
                    && by_stick.contains(&field(data, "nav_state")?);
                let time = field(data, "timestamp")? * 1e-6;
                self.since = counts.then(|| self.since.unwrap_or(time));
            }
            "sensor_combined" => self.force.add(field(data, "accelerometer_m_s2[2]")?),
            "actuator_motors" => self.add_motors(data, params)?,
            _ => {}
        }
        Ok(())
    }

    fn add_motors(&mut self, data: &Data, params: &Params) -> Result<(), String> {
        let time = field(data, "timestamp")? * 1e-6;
        let counts = self.is_clear && self.since.is_some_and(|since| time >= since + SETTLE);
        // What acted until now is what was sent at the end of the last period.
        let acted = self.throttle.replace(data.numbers("control").unwrap_or_default());
        let (Some(down), Some(acted), Some(volts)) =
            (std::mem::take(&mut self.force).get(), acted, self.voltage)
        else {
            return Ok(());
        };
        if !counts || acted.len() < CHANNELS {
            return Ok(());
        }
        self.record.time.push(time);
        for (channel, u) in self.record.pwm.iter_mut().zip(&acted) {
            channel.push(*u);
        }
        self.record.thrust.push(-down * f64::from(params.mass));
        if let Some(list) = &mut self.record.voltage {
            list.push(volts);
        }
        Ok(())
    }
}
