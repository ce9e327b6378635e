//! What goes in and what comes out. Log and telemetry only read [`StepOutput`].

use super::{State, Vehicle};
use crate::estimate::taut::TautEstimate;
use crate::estimate::tether_angle::TetherAngleEstimate;
use crate::frames::{Body, V3};
use crate::mode::{ActiveMode, PendulumReport, Situation};
use crate::scalar::Scalar;
use crate::sense::RawSensors;
use crate::signal::{
    Actuation, Estimate, EventQueue, FlightReference, MixerReport, PlanarReference, RawRadio,
    Reply, Request, Sensors, Sticks, Wrench,
};
use crate::single::in_single;
use crate::supervisor::{GroundState, Mode};
use crate::time::{Micros, Sample};

/// A frame older than this shows no pilot, µs.
const RADIO_FRESH_US: u64 = 500_000;

/// Everything that one step may read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StepInput {
    /// Now.
    pub now: Micros,
    /// From the drivers.
    pub sensors: RawSensors,
    /// When a ground station last spoke.
    pub heartbeat_at: Option<Micros>,
    /// Joystick, if one spoke.
    pub sticks: Option<Sample<Sticks>>,
    /// One request.
    pub request: Option<Request>,
}

/// Everything that one step has to say, in single precision whatever the vehicle computes with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOutput {
    /// Now.
    pub now: Micros,
    /// After the sense stage.
    pub sensors: Sensors,
    /// After the estimate stage.
    pub estimate: Estimate,
    /// In the modes that have one.
    pub reference: Option<FlightReference>,
    /// What the taut-link observer knows, in the air.
    pub taut: Option<TautEstimate<f32>>,
    /// In the taut-link modes.
    pub taut_reference: Option<PlanarReference<f32>>,
    /// In Tether Angle.
    pub angle: Option<TetherAngleEstimate<f32>>,
    /// While a rod on top is seen.
    pub pendulum: Option<PendulumReport>,
    /// Body rates wanted, rad/s.
    pub rate_setpoint: Body<V3<f32>>,
    /// Asked of the mixer.
    pub wrench: Wrench,
    /// What the mixer could not give.
    pub mixer: MixerReport,
    /// To motors and winch.
    pub actuation: Actuation,
    /// Flight mode.
    pub mode: Mode,
    /// Ground station that may ask in flight.
    pub commander: Option<u8>,
    /// Motors may turn.
    pub is_armed: bool,
    /// On the ground or not.
    pub ground: GroundState,
    /// All arming checks pass.
    pub is_armable: bool,
    /// Bit n: row n of the failsafe table is active.
    pub failures: u32,
    /// The last frame of a pilot's radio.
    pub radio: Option<Sample<RawRadio>>,
    /// Answer to this step's request.
    pub reply: Option<Reply>,
    /// For the operator.
    pub events: EventQueue,
}

/// What of the output has changed in this step beside what each step changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct News {
    pub estimate: bool,
    pub observers: bool,
    pub guidance: bool,
}

impl StepOutput {
    /// Before the first step.
    pub(super) fn before<S: Scalar>(
        situation: &Situation<S>,
        state: &State<S>,
        mode: &ActiveMode<S>,
    ) -> Self {
        let mut output = Self {
            now: Micros(0),
            sensors: Sensors::default(),
            estimate: in_single(&situation.estimate),
            reference: None,
            taut: None,
            taut_reference: None,
            angle: None,
            pendulum: None,
            rate_setpoint: Body(V3::zeros()),
            wrench: in_single(&state.wrench),
            mixer: situation.mixer,
            actuation: in_single(&state.actuation),
            mode: mode.mode(),
            commander: None,
            is_armed: false,
            ground: situation.setpoints.ground,
            is_armable: false,
            failures: 0,
            radio: None,
            reply: None,
            events: EventQueue::default(),
        };
        output.guide(situation, mode);
        output
    }

    /// A pilot is behind the last frame of the radio, which is fresh.
    #[must_use]
    pub fn radio_is_heard(&self) -> bool {
        self.radio.is_some_and(|r| r.value.is_heard() && self.now.since(r.at) < RADIO_FRESH_US)
    }

    fn observe<S: Scalar>(&mut self, situation: &Situation<S>, mode: &ActiveMode<S>) {
        self.taut = situation.taut.estimate().map(in_single);
        self.pendulum = situation.rod.as_ref().map(|rod| PendulumReport {
            estimate: in_single(&rod.estimate),
            reference: in_single(&mode.report().load),
        });
    }

    fn guide<S: Scalar>(&mut self, situation: &Situation<S>, mode: &ActiveMode<S>) {
        let report = mode.report();
        self.reference = in_single(&situation.setpoints.reference);
        self.taut_reference = in_single(&report.taut);
        self.angle = in_single(&report.angle);
        if let Some(pendulum) = &mut self.pendulum {
            pendulum.reference = in_single(&report.load);
        }
        self.rate_setpoint = in_single(&situation.setpoints.attitude.rate);
    }
}

impl<S: Scalar> Vehicle<S> {
    /// Brings the output up to date: most of its bytes stay as they are in most steps.
    pub(super) fn report(
        &mut self,
        now: Micros,
        sensors: &Sensors<S>,
        reply: Option<Reply>,
        events: EventQueue,
        news: News,
    ) -> &StepOutput {
        let Self { mode, situation, state, output, .. } = self;
        output.now = now;
        output.sensors = in_single(sensors);
        if news.estimate {
            output.estimate = in_single(&situation.estimate);
        } else {
            output.estimate.rate = in_single(&situation.estimate.rate);
        }
        if news.observers {
            output.observe(situation, mode);
        }
        if news.guidance {
            output.guide(situation, mode);
        }
        output.wrench = in_single(&state.wrench);
        output.mixer = situation.mixer;
        output.actuation = in_single(&state.actuation);
        output.mode = mode.mode();
        output.commander = state.commander;
        output.is_armed = situation.armed_at.is_some();
        output.ground = situation.setpoints.ground;
        output.is_armable = state.is_armable;
        output.failures = state.failsafe.active();
        if reply.is_some() || output.reply.is_some() {
            output.reply = reply;
        }
        if !(events.is_empty() && output.events.is_empty()) {
            output.events = events;
        }
        #[cfg(debug_assertions)]
        {
            let before = *output;
            output.estimate = in_single(&situation.estimate);
            output.observe(situation, mode);
            output.guide(situation, mode);
            debug_assert!(*output == before, "a group changed that was not told");
        }
        output
    }
}
