//! The `[cal]` texts that set-up pages wait for. What is calibrated here is the gyro, together with level.

use crate::mavlink::{Session, Sink};
use crate::signal::Severity;
use crate::time::Micros;
use crate::vehicle::StepOutput;

/// A vehicle that is not at rest by then is not calibrated, µs.
const PATIENCE_US: u64 = 20_000_000;

/// Which of them was asked for, and since when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::mavlink) enum Calibration {
    #[default]
    Idle,
    /// Asked for, and not accepted yet.
    Asked { is_level: bool },
    /// The estimator takes its bias.
    Running { is_level: bool, since: Option<Micros> },
}

impl Calibration {
    pub fn cancel(&mut self) {
        *self = Self::Idle;
    }
}

const fn texts(is_level: bool) -> [&'static str; 3] {
    if is_level {
        [
            "[cal] calibration started: 2 level",
            "[cal] calibration done: level",
            "[cal] calibration failed: vehicle not at rest",
        ]
    } else {
        [
            "[cal] calibration started: 2 gyro",
            "[cal] calibration done: gyro",
            "[cal] calibration failed: vehicle not at rest",
        ]
    }
}

impl Session {
    pub(super) fn begin_calibration(&mut self, sink: Sink) {
        if let Calibration::Asked { is_level } = self.calibration {
            let [started, ..] = texts(is_level);
            self.calibration = Calibration::Running { is_level, since: None };
            self.say(Severity::Info, started, sink);
        }
    }

    pub(in crate::mavlink) fn report_calibration(&mut self, out: &StepOutput, sink: Sink) {
        let Calibration::Running { is_level, since } = self.calibration else { return };
        let began = since.unwrap_or(out.now);
        let [_, done, failed] = texts(is_level);
        let text = if out.estimate.is_levelled && since.is_some() {
            self.say(Severity::Info, "[cal] progress <100>", sink);
            done
        } else if out.now.since(began) > PATIENCE_US {
            failed
        } else {
            self.calibration = Calibration::Running { is_level, since: Some(began) };
            return;
        };
        self.calibration = Calibration::Idle;
        self.say(Severity::Info, text, sink);
    }
}
