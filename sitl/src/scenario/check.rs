//! Every number of a scenario within its range, before the first step.

use super::{LineModel, RadioKind, Scenario, Step, TetherKind, preset, set_param};
use std::f64::consts::{FRAC_PI_2, PI};
use tautline_firmware::param::Params;

impl Scenario {
    /// Every number within its range.
    pub(super) fn check(&self) -> Result<(), String> {
        preset::check("vehicle", &self.vehicle.preset)?;
        preset::check("tether", &self.tether.preset)?;
        self.vehicle.check()?;
        self.tether.check()?;
        if self.tether.model == LineModel::Chain
            && !matches!(self.tether.kind, TetherKind::Winch | TetherKind::Fixed)
        {
            return Err("tether.model = \"chain\" wants kind = \"winch\" or \"fixed\"".into());
        }
        if self.tether.kind == TetherKind::Fixed && self.tether.start_slack >= self.tether.length {
            return Err(format!(
                "tether.start_slack = {} is no less than tether.length = {}",
                self.tether.start_slack, self.tether.length
            ));
        }
        self.station.check()?;
        self.base.check()?;
        self.capture.check()?;
        self.rod.check()?;
        self.push.check()?;
        self.wind.check()?;
        self.sensors.check()?;
        self.battery.check()?;
        let mut last = 0.0;
        for (i, row) in self.radio.iter().enumerate() {
            row.check(&format!("radio[{i}]"), last)?;
            last = row.at;
        }
        if !self.radio.is_empty() && self.sensors.radio == RadioKind::None {
            return Err("radio wants sensors.radio = \"crsf\" or \"sbus\"".into());
        }
        for (i, fault) in self.fault.iter().enumerate() {
            fault.check(&format!("fault[{i}]"), &self.mission)?;
        }
        for (i, step) in self.mission.iter().enumerate() {
            if let Step::WalkAnchor { way: [north, east], ramp, .. } = step {
                within(&format!("mission[{i}].way[0]"), *north, -1e3, 1e3)?;
                within(&format!("mission[{i}].way[1]"), *east, -1e3, 1e3)?;
                within(&format!("mission[{i}].ramp"), *ramp, 0.0, 100.0)?;
            }
            if let Step::Excite { altitude, .. } = step {
                within(&format!("mission[{i}].altitude"), *altitude, 1.0, 100.0)?;
            }
            let path = format!("mission[{i}]");
            if let Step::Move { elevation, azimuth, length, tension } = step {
                let some = |key: &str, value: &Option<f64>, min, max| {
                    value.map_or(Ok(()), |value| within(&format!("{path}.{key}"), value, min, max))
                };
                some("elevation", elevation, 0.0, FRAC_PI_2)?;
                some("azimuth", azimuth, -6.3, 6.3)?;
                some("length", length, 0.5, 500.0)?;
                some("tension", tension, 0.0, 1e4)?;
            }
            if let Step::TautMove { elevation, second, .. } = step {
                for (key, pair, min, max) in
                    [("elevation", elevation, 0.0, PI), ("second", second, -1e4, 1e4)]
                {
                    for (i, value) in pair.iter().enumerate() {
                        within(&format!("{path}.{key}[{i}]"), *value, min, max)?;
                    }
                }
            }
            let (key, value, min, max) = match step {
                Step::Takeoff { altitude } => ("altitude", *altitude, 0.5, 200.0),
                Step::Hold { seconds } => ("seconds", *seconds, 0.0, 1e6),
                Step::AwaitDisarmed { timeout } | Step::Radio { timeout } => {
                    ("timeout", *timeout, 0.0, 1e6)
                }
                Step::TautMove { duration, .. } => ("duration", *duration, 0.0, 1e6),
                Step::WalkAnchor { speed, .. } => ("speed", *speed, 0.0, 10.0),
                Step::Excite { seconds, .. } => ("seconds", *seconds, 0.0, 1e6),
                Step::Arm
                | Step::Altitude
                | Step::TetherAngle
                | Step::Pendulum
                | Step::CatchRod
                | Step::Land
                | Step::TetherHold
                | Step::Taut { .. }
                | Step::Move { .. } => continue,
            };
            within(&format!("mission[{i}].{key}"), value, min, max)?;
        }
        let mut params = Params::default();
        for (name, &value) in &self.params {
            set_param(&mut params, name, value).map_err(|e| format!("params.{name}: {e}"))?;
        }
        Ok(())
    }
}

pub(crate) fn within(key: &str, value: f64, min: f64, max: f64) -> Result<(), String> {
    if value >= min && value <= max {
        Ok(())
    } else {
        Err(format!("{key} = {value} is outside {min} to {max}"))
    }
}
