//! What goes in and what comes out. Log and telemetry only read [`StepOutput`].

use super::Vehicle;
use crate::estimate::taut::TautEstimate;
use crate::estimate::tether_angle::TetherAngleEstimate;
use crate::frames::{Body, V3};
use crate::mode::PendulumReport;
use crate::scalar::Scalar;
use crate::sense::RawSensors;
use crate::signal::{
    Actuation, Estimate, EventQueue, FlightReference, MixerReport, PlanarReference, Reply, Request,
    Sensors, Sticks, Wrench,
};
use crate::single::in_single;
use crate::supervisor::{GroundState, Mode};
use crate::time::{Micros, Sample};

/// Everything that one step may read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
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
    /// Motors may turn.
    pub is_armed: bool,
    /// On the ground or not.
    pub ground: GroundState,
    /// All arming checks pass.
    pub is_armable: bool,
    /// Bit n: row n of the failsafe table is active.
    pub failures: u16,
    /// Answer to this step's request.
    pub reply: Option<Reply>,
    /// For the operator.
    pub events: EventQueue,
}

impl<S: Scalar> Vehicle<S> {
    // Not inlined, it builds the output where the caller wants it; inlined, it is built twice.
    #[inline(never)]
    pub(super) fn report(
        &self,
        now: Micros,
        sensors: &Sensors<S>,
        reply: Option<Reply>,
        events: EventQueue,
    ) -> StepOutput {
        let (state, situation) = (&self.state, &self.situation);
        let report = self.mode.report();
        StepOutput {
            now,
            sensors: in_single(sensors),
            estimate: in_single(&situation.estimate),
            reference: in_single(&situation.setpoints.reference),
            taut: situation.taut.estimate().map(in_single),
            taut_reference: in_single(&report.taut),
            angle: in_single(&report.angle),
            pendulum: situation.rod.as_ref().map(|rod| PendulumReport {
                estimate: in_single(&rod.estimate),
                reference: in_single(&report.load),
            }),
            rate_setpoint: in_single(&situation.setpoints.attitude.rate),
            wrench: in_single(&state.wrench),
            mixer: situation.mixer,
            actuation: in_single(&state.actuation),
            mode: self.mode.mode(),
            is_armed: situation.armed_at.is_some(),
            ground: situation.setpoints.ground,
            is_armable: state.is_armable,
            failures: state.failsafe.active(),
            reply,
            events,
        }
    }
}
