//! A log → time series.

use crate::ulog::{Data, Log, Message};
use nalgebra::{Quaternion, UnitQuaternion};
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
    /// Estimated roll, pitch, yaw, rad.
    pub attitude: [Series; 3],
    /// The same.
    pub true_attitude: [Series; 3],
    /// Throttles of the rotors that there are, 0..1.
    pub motors: Vec<Series>,
    /// At the battery's terminals, V.
    pub voltage: Series,
    /// Wind at the vehicle towards North, East, Down, m/s.
    pub wind: [Series; 3],
    /// Mode and failures, as they change.
    pub states: Vec<State>,
    /// What was wrong with the log, one line each.
    pub notes: Vec<String>,
}

/// What the vehicle is at, from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// s.
    pub since: f64,
    /// PX4's number of the mode; `None` while disarmed.
    pub mode: Option<u8>,
    /// Bit n: row n of the failsafe table.
    pub failures: u32,
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

/// Roll, pitch, yaw of a sample's quaternion.
fn push_attitude(into: &mut [Series; 3], data: &Data) {
    let Some([w, x, y, z]) = data.numbers("q").and_then(|q| <[f64; 4]>::try_from(q).ok()) else {
        return;
    };
    let (Some(time), Some(q)) =
        (data.time(), UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.1))
    else {
        return;
    };
    let (roll, pitch, yaw) = q.euler_angles();
    for (series, angle) in into.iter_mut().zip([roll, pitch, yaw]) {
        series.push((time, angle));
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
        const WIND: [&str; 3] = ["windspeed_north", "windspeed_east", "windspeed_down"];
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
            "actuator_motors" => {
                push_one(&mut self.winch, data, "winch_tension");
                self.add_motors(data);
            }
            "vehicle_attitude" => push_attitude(&mut self.attitude, data),
            "vehicle_attitude_groundtruth" => push_attitude(&mut self.true_attitude, data),
            "battery_status" => push_one(&mut self.voltage, data, "voltage_v"),
            "wind_groundtruth" => push(&mut self.wind, data, WIND),
            "vehicle_status" => self.add_state(data),
            _ => {}
        }
    }

    fn add_motors(&mut self, data: &Data) {
        let (Some(time), Some(throttles)) = (data.time(), data.numbers("control")) else { return };
        self.motors.resize(throttles.len(), Series::new());
        for (series, throttle) in self.motors.iter_mut().zip(throttles) {
            series.push((time, throttle));
        }
    }

    fn add_state(&mut self, data: &Data) {
        let (Some(since), Some(mode)) = (data.time(), data.number("nav_state")) else { return };
        let is_armed = data.number("arming_state") == Some(2.0);
        let failures = data.number("failures").unwrap_or(0.0) as u32;
        let state = State { since, mode: is_armed.then_some(mode as u8), failures };
        let is_same = |last: &State| last.mode == state.mode && last.failures == state.failures;
        if !self.states.last().is_some_and(is_same) {
            self.states.push(state);
        }
    }

    /// The last instant, s.
    #[must_use]
    pub fn end(&self) -> f64 {
        let ends = [&self.estimate, &self.truth, &self.tether, &self.attitude];
        let last = |series: &Series| series.last().map_or(0.0, |point| point.0);
        ends.into_iter().flatten().map(last).fold(0.0, f64::max)
    }

    /// What was asked for alone is no picture of a flight.
    fn is_empty(&self) -> bool {
        let flown = [&self.estimate, &self.truth, &self.tether, &self.true_tether, &self.taut];
        flown.into_iter().flatten().all(Vec::is_empty)
    }
}
