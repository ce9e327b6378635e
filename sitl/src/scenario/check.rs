//! Every number of a scenario within its range, before the first step.

use super::{LineModel, Scenario, Step, TetherKind, preset, set_param};
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
        self.station.check()?;
        self.base.check()?;
        self.capture.check()?;
        self.rod.check()?;
        self.push.check()?;
        self.wind.check()?;
        self.sensors.check()?;
        self.battery.check()?;
        for (i, fault) in self.fault.iter().enumerate() {
            fault.check(&format!("fault[{i}]"))?;
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
            let (key, value, min, max) = match step {
                Step::Takeoff { altitude } => ("altitude", *altitude, 0.5, 200.0),
                Step::Hold { seconds } => ("seconds", *seconds, 0.0, 1e6),
                Step::AwaitDisarmed { timeout } => ("timeout", *timeout, 0.0, 1e6),
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
