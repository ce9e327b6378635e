//! A log → time series.

use crate::ulog::{Data, Log, Message};
use std::fs;
use std::path::Path;

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
    /// What was wrong with the log, one line each.
    pub notes: Vec<String>,
}

/// Numbers that are there; one that a logger of another kind leaves out leaves its line out.
fn push(into: &mut [Series; 3], data: &Data, names: [&str; 3]) {
    for (series, name) in into.iter_mut().zip(names) {
        push_one(series, data, name);
    }
}

fn push_one(into: &mut Series, data: &Data, name: &str) {
    if let (Some(time), Some(value)) = (data.time(), data.number(name)) {
        into.push((time, value));
    }
}

/// A flag that is not there forbids nothing.
fn is_clear(data: &Data, flag: &str) -> bool {
    data.number(flag) == Some(0.0)
}

impl FlightData {
    /// Reads a log.
    ///
    /// # Errors
    /// One line naming the file.
    pub fn read(path: &Path) -> Result<Self, String> {
        let name = path.display();
        let bytes = fs::read(path).map_err(|e| format!("{name}: {e}"))?;
        Self::from_bytes(&bytes).map_err(|e| format!("{name}: {e}"))
    }

    /// The same from memory.
    ///
    /// # Errors
    /// One line: not a log, or nothing in it that the picture shows.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let mut log = Log::new(bytes).map_err(|e| e.to_string())?;
        let mut data = Self::default();
        for message in log.by_ref() {
            if let Message::Data(sample) = message
                && sample.instance == 0
            {
                data.add(&sample);
            }
        }
        data.notes = log.notes().lines();
        if data.is_empty() {
            let topics: Vec<_> = log.topics().into_iter().collect();
            let found = match topics.as_slice() {
                [] => "the log ends before its first topic".into(),
                topics => format!("topics: {}", topics.join(", ")),
            };
            let notes: String = data.notes.iter().map(|note| format!("; {note}")).collect();
            return Err(format!("nothing of this to draw; {found}{notes}"));
        }
        Ok(data)
    }

    fn add(&mut self, data: &Data) {
        const TETHER: [&str; 3] = ["elevation", "azimuth", "tension"];
        match data.topic {
            "vehicle_local_position" if is_clear(data, "xy_valid") => {}
            "vehicle_local_position" => push(&mut self.estimate, data, ["x", "y", "z"]),
            "vehicle_local_position_groundtruth" => push(&mut self.truth, data, ["x", "y", "z"]),
            "vehicle_local_position_setpoint" => push(&mut self.setpoint, data, ["x", "y", "z"]),
            "tether_state" => push(&mut self.tether, data, TETHER),
            "tether_state_groundtruth" => push(&mut self.true_tether, data, TETHER),
            "estimator_taut" if is_clear(data, "active") => {}
            "estimator_taut" => {
                push(&mut self.taut, data, ["elevation", "link_force", "elevation_setpoint"]);
            }
            "actuator_motors" => push_one(&mut self.winch, data, "winch_tension"),
            _ => {}
        }
    }

    /// What was asked for alone is no picture of a flight.
    fn is_empty(&self) -> bool {
        let flown = [&self.estimate, &self.truth, &self.tether, &self.true_tether, &self.taut];
        flown.into_iter().flatten().all(Vec::is_empty)
    }
}
