//! The vehicle's topics in the log.

use super::topics as t;
use super::ulog::{Record, Sink, Topic, Ulog};
use crate::param::{META, Params};
use crate::time::Micros;
use crate::vehicle::StepOutput;

/// Periods in steps of 1 ms.
pub(super) const FAST: u32 = 4;
pub(super) const MEDIUM: u32 = 10;
pub(super) const SLOW: u32 = 20;
pub(super) const RARE: u32 = 200;

/// A topic that the vehicle's own output fills.
pub trait FlightTopic: Record + Sized {
    /// PX4's name where PX4 has the topic.
    const NAME: &'static str;
    /// Period, steps.
    const EVERY: u32;
    /// Also when mode, arming, ground or failures change.
    const ON_CHANGE: bool = false;
    /// What this step has to say on it, if anything.
    fn of(out: &StepOutput) -> Option<Self>;
}

/// All topics, in the order in which they stand in the log. A new one is a `record!` and a line here.
macro_rules! flight_topics {
    ($($topic:ident)+) => {
        const NAMES: [&str; [$(stringify!($topic)),+].len()] = [$(t::$topic::NAME),+];

        fn define(ulog: &mut Ulog, sink: Sink) {
            $(ulog.define_fields(t::$topic::NAME, t::$topic::FIELDS, sink);)+
        }

        impl FlightLog {
            fn write_due(&mut self, out: &StepOutput, has_changed: bool, sink: Sink) {
                let mut topics = self.topics.into_iter();
                $(if let Some(topic) = topics.next()
                    && (self.step.is_multiple_of(t::$topic::EVERY)
                        || (t::$topic::ON_CHANGE && has_changed))
                    && let Some(record) = t::$topic::of(out)
                {
                    self.ulog.write(topic, &record, sink);
                })+
            }
        }
    };
}

flight_topics! {
    SensorCombined
    VehicleAttitude
    VehicleAngularVelocity
    VehicleRatesSetpoint
    ActuatorMotors
    VehicleLocalPosition
    EstimatorEkf4
    EstimatorTaut
    EstimatorTetherAngle
    EstimatorPendulum
    TetherState
    VehicleLocalPositionSetpoint
    BatteryStatus
    VehicleStatus
}

/// What a change of is worth a record of its own.
type Stage = (bool, crate::supervisor::Mode, crate::supervisor::GroundState, u16);

/// Writes what each step says. Whoever logs beside it (the simulator's truth) uses [`Self::ulog`].
#[derive(Clone, Copy, Debug)]
pub struct FlightLog {
    /// The writer.
    pub ulog: Ulog,
    topics: [Topic; NAMES.len()],
    step: u32,
    stage: Option<Stage>,
}

impl FlightLog {
    /// Header, definitions and parameters. `define_more` may define further topics.
    pub fn start(
        now: Micros,
        params: &Params,
        define_more: impl FnOnce(&mut Ulog, Sink),
        sink: Sink,
    ) -> Self {
        let mut ulog = Ulog::default();
        ulog.start(now, "Tautline", env!("CARGO_PKG_VERSION"), sink);
        define(&mut ulog, sink);
        define_more(&mut ulog, sink);
        for (index, meta) in META.iter().enumerate() {
            ulog.parameter(meta.name, params.get(index).unwrap_or(meta.default), sink);
        }
        let topics = NAMES.map(|name| ulog.subscribe(name, sink));
        Self { ulog, topics, step: 0, stage: None }
    }

    /// What this step has to say.
    pub fn write(&mut self, out: &StepOutput, sink: Sink) {
        let stage = Some((out.is_armed, out.mode, out.ground, out.failures));
        self.write_due(out, stage != self.stage, sink);
        self.stage = stage;
        self.step = self.step.wrapping_add(1);
        for event in out.events.iter() {
            self.ulog.text(out.now, event.severity as u8, event.text, sink);
        }
    }
}
