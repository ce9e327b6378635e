//! The vehicle's topics in the log.

use super::topics as t;
use super::ulog::{FieldMeta, Record, Sink, Topic, Ulog};
use crate::model::{Rotors, thrust_max};
use crate::param::{ALIASES, Kind, META, Params};
use crate::signal::{EVENTS_MAX, TEXT_MAX};
use crate::time::Micros;
use crate::vehicle::StepOutput;

/// How often a topic is written, in steps of 1 ms: by default, and in a log for identification (`LOG_FULL`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Period {
    usual: u32,
    full: u32,
}

impl Period {
    /// Per second: by default, and with `LOG_FULL`.
    #[must_use]
    pub const fn per_second(self) -> (u32, u32) {
        (1000 / self.usual, 1000 / self.full)
    }

    /// Whether a step is one of those.
    #[must_use]
    pub fn has(self, step: u32, is_full: bool) -> bool {
        step.is_multiple_of(if is_full { self.full } else { self.usual })
    }
}

pub(super) const FAST: Period = Period { usual: 10, full: 4 };
/// Of attitude and motors; also of the simulator's truth.
pub const MEDIUM: Period = Period { usual: 20, full: 10 };
/// Of what moves with the vehicle.
pub const SLOW: Period = Period { usual: 40, full: 20 };
pub(super) const RARE: Period = Period { usual: 200, full: 200 };

/// What is the whole where PX4 logs shares.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Of all rotors, N.
    pub thrust: f32,
    /// What half of the rotors give at full throttle while the others rest, N m.
    pub torque: [f32; 3],
    /// `MAV_TYPE` of a multirotor with so many rotors.
    pub mav_type: u8,
}

impl Scale {
    fn new(p: &Params) -> Self {
        let thrust = thrust_max(p);
        let tilt = thrust * p.arm / 2.0;
        let mav_type = match Rotors::of(p).len() {
            6 => 13,
            8 => 14,
            _ => 2,
        };
        Self { thrust, torque: [tilt, tilt, thrust * p.torque_ratio / 2.0], mav_type }
    }
}

/// A topic that the vehicle's own output fills.
pub trait FlightTopic: Record + Sized {
    /// PX4's name where PX4 has the topic.
    const NAME: &'static str;
    /// How often.
    const EVERY: Period;
    /// Also when mode, arming, ground or failures change.
    const ON_CHANGE: bool = false;
    /// What this step has to say on it, if anything.
    fn of(out: &StepOutput, scale: &Scale) -> Option<Self>;
}

/// A topic in words.
#[derive(Clone, Copy, Debug)]
pub struct TopicMeta {
    /// In the log.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// How often, where the vehicle writes it.
    pub every: Option<Period>,
    /// [`FlightTopic::ON_CHANGE`].
    pub is_on_change: bool,
    /// The time stamp first.
    pub fields: &'static [FieldMeta],
    /// Of each.
    pub field_docs: &'static [&'static str],
}

impl TopicMeta {
    /// Of a topic that somebody else writes.
    #[must_use]
    pub const fn new<T: Record>(name: &'static str) -> Self {
        Self {
            name,
            doc: T::DOC,
            every: None,
            is_on_change: false,
            fields: T::FIELDS,
            field_docs: T::FIELD_DOCS,
        }
    }

    const fn flown<T: FlightTopic>() -> Self {
        Self { every: Some(T::EVERY), is_on_change: T::ON_CHANGE, ..Self::new::<T>(T::NAME) }
    }
}

/// All topics, in the order in which they stand in the log. A new one is a `record!` and a line here.
macro_rules! flight_topics {
    ($($topic:ident)+) => {
        /// What the vehicle logs, for documents.
        pub const TOPICS: &[TopicMeta] = &[$(TopicMeta::flown::<t::$topic>()),+];

        const NAMES: [&str; [$(stringify!($topic)),+].len()] = [$(t::$topic::NAME),+];

        /// More than all that one step may have to say, bytes: every topic, a gap before and the events.
        pub const STEP_BYTES: usize = {
            const EVENT: usize = 12 + TEXT_MAX;
            0 $(+ t::$topic::BYTES)+ + EVENTS_MAX * EVENT + 5
        };

        fn define(ulog: &mut Ulog, sink: Sink) {
            $(ulog.define_fields(t::$topic::NAME, t::$topic::FIELDS, sink);)+
        }

        impl FlightLog {
            fn write_due(&mut self, out: &StepOutput, has_changed: bool, sink: Sink) {
                let mut topics = self.topics.into_iter();
                $(if let Some(topic) = topics.next()
                    && (t::$topic::EVERY.has(self.step, self.is_full)
                        || (t::$topic::ON_CHANGE && has_changed))
                    && let Some(record) = t::$topic::of(out, &self.scale)
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
    VehicleThrustSetpoint
    VehicleTorqueSetpoint
    ActuatorMotors
    VehicleLocalPosition
    EstimatorEkf4
    EstimatorTaut
    EstimatorTetherAngle
    EstimatorPendulum
    TetherState
    TetherSensors
    VehicleLocalPositionSetpoint
    BatteryStatus
    VehicleMagnetometer
    VehicleImuStatus
    EstimatorStatus
    VehicleStatus
    VehicleLandDetected
    FailsafeFlags
    InputRc
}

fn parameter(ulog: &mut Ulog, name: &str, kind: Kind, value: f32, sink: Sink) {
    match kind {
        Kind::Real => ulog.parameter(name, value, sink),
        Kind::Int => ulog.parameter(name, value as i32, sink),
    }
}

/// What a change of is worth a record of its own.
type Stage = (bool, crate::supervisor::Mode, crate::supervisor::GroundState, u32);

/// Writes what each step says. Whoever logs beside it (the simulator's truth) uses [`Self::ulog`].
#[derive(Clone, Copy, Debug)]
pub struct FlightLog {
    /// The writer.
    pub ulog: Ulog,
    topics: [Topic; NAMES.len()],
    scale: Scale,
    is_full: bool,
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
        ulog.start(now, "Tautline", sink);
        define(&mut ulog, sink);
        define_more(&mut ulog, sink);
        for (index, meta) in META.iter().enumerate() {
            let value = params.get(index).unwrap_or(meta.default);
            parameter(&mut ulog, meta.name, meta.kind, value, sink);
        }
        for alias in ALIASES {
            parameter(&mut ulog, alias.name, alias.kind, alias.value(params), sink);
        }
        let scale = Scale::new(params);
        ulog.parameter("MAV_TYPE", i32::from(scale.mav_type), sink);
        let topics = NAMES.map(|name| ulog.subscribe(name, sink));
        Self { ulog, topics, scale, is_full: params.log_full > 0.5, step: 0, stage: None }
    }

    /// Whether a topic of this period is written in the next step, for whoever logs beside it.
    #[must_use]
    pub fn is_due(&self, period: Period) -> bool {
        period.has(self.step, self.is_full)
    }

    /// What this step has to say.
    pub fn write(&mut self, out: &StepOutput, sink: Sink) {
        let stage = Some((out.is_armed, out.mode, out.ground, out.failures));
        self.write_due(out, stage != self.stage, sink);
        self.stage = stage;
        self.step = self.step.wrapping_add(1);
        for event in out.events.iter() {
            self.ulog.text(out.now, event.severity as u8, &event.message(), sink);
        }
    }
}
