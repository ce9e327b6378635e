//! What does each flight mode do? A mode is a value: it is entered, takes commands, makes set-points, and ends
//! by an `Exit` or because somebody asks for another.
//!
//! ```text
//! request ──▶ arbiter ──▶ ActiveMode::enter ──▶ step, 250 times a second ──▶ Setpoints ──▶ attitude, rates,
//!                ▲                                    │                                    mixer, winch
//!                └──── failsafe table ◀── Exit ───────┘
//! ```
//!
//! A mode reads the vehicle through its `Context` and writes nothing but its own state and the
//! `Handover` to the next one. What it needs, its name and its numbers stand in
//! [`crate::supervisor::MODES`]; who may change the mode, in `vehicle/arbiter.rs` alone.

mod boxed;
mod context;
mod descent;
mod feasible;
mod handover;
mod hold;
mod land;
mod offboard;
pub(crate) mod pendulum;
mod plan;
mod position;
pub(crate) mod refusal;
mod setpoints;
mod sticks;
mod takeoff;
mod taut;
mod tether_angle;

pub(crate) use context::{Context, Situation, Smoothed};
pub(crate) use handover::Handover;
pub use pendulum::PendulumReport;
pub(crate) use refusal::{Refusal, denied, rejected};
pub(crate) use setpoints::{Exit, Notice, Setpoints};
pub(crate) use taut::OutOfPlane;

use crate::estimate::tether_angle::TetherAngleEstimate;
use crate::feature;
use crate::model::TetherKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Action, LoadReference, PlanarReference, TautPurpose};
use crate::supervisor::Mode;

/// Configuration of the modes that have one; `None` where the parameters rule a mode out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeConfig<S: Scalar> {
    pub slack_hover: Option<feature::TautLink<takeoff::SlackHoverPlan<S>>>,
    pub taut: Option<feature::TautLink<taut::TautConfig<S>>>,
    pub angle: Option<feature::TetherAngle<tether_angle::AngleConfig<S>>>,
    pub pendulum: Option<feature::Pendulum<pendulum::PendulumConfig<S>>>,
}

impl<S: Scalar> ModeConfig<S> {
    pub fn new(p: &Params) -> Self {
        Self {
            slack_hover: Self::slack_hover(p),
            taut: Self::taut(p),
            angle: Self::angle(p),
            pendulum: Self::pendulum(p),
        }
    }

    #[inline(never)]
    pub fn slack_hover(p: &Params) -> Option<feature::TautLink<takeoff::SlackHoverPlan<S>>> {
        let kind = TetherKind::from_parameter(p.tether_kind);
        feature::TautLink::build(|| takeoff::SlackHoverPlan::new(p, kind == TetherKind::Cable))
    }

    #[inline(never)]
    pub fn taut(p: &Params) -> Option<feature::TautLink<taut::TautConfig<S>>> {
        // A winch lets the length go: neither mode nor observer.
        let kind = TetherKind::from_parameter(p.tether_kind);
        let flies = Mode::TautForce.rule().on.contains(kind);
        feature::TautLink::build(|| taut::TautConfig::new(p).filter(|_| flies))
    }

    #[inline(never)]
    pub fn angle(p: &Params) -> Option<feature::TetherAngle<tether_angle::AngleConfig<S>>> {
        feature::TetherAngle::build(|| tether_angle::AngleConfig::new(p))
    }

    #[inline(never)]
    pub fn pendulum(p: &Params) -> Option<feature::Pendulum<pendulum::PendulumConfig<S>>> {
        feature::Pendulum::build(|| pendulum::PendulumConfig::new(p))
    }
}

/// How a mode is asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub mode: Mode,
    /// Of a take-off, m over the anchor.
    pub altitude: Option<f32>,
}

impl Entry {
    pub fn of(mode: Mode) -> Self {
        Self { mode, altitude: None }
    }
}

/// What a mode says of itself in log and telemetry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeReport<S: Scalar> {
    pub taut: Option<PlanarReference<S>>,
    pub angle: Option<TetherAngleEstimate<S>>,
    pub load: Option<LoadReference<S>>,
}

impl<S: Scalar> Default for ModeReport<S> {
    fn default() -> Self {
        Self { taut: None, angle: None, load: None }
    }
}

/// A flight mode. Everything that moves is in `self` and in the handover.
pub(crate) trait FlightMode<S: Scalar>: Sized {
    /// Into the mode, on the ground or in the air. A refusal changes nothing.
    fn enter(
        entry: &Entry,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Self, Refusal>;

    /// One step of 4 ms while armed.
    fn step(
        &mut self,
        handover: &mut Handover<S>,
        cx: &Context<'_, S>,
    ) -> Result<Setpoints<S>, Exit>;

    /// A move, or a pause. What a mode does not know, it refuses.
    fn command(
        &mut self,
        _handover: &mut Handover<S>,
        action: &Action,
        _cx: &Context<'_, S>,
    ) -> Result<(), Refusal> {
        Err(refusal::not_here(action))
    }

    /// A command was taken up, and its answer takes more than one step.
    fn is_considering(&self) -> bool {
        false
    }

    /// Goes on considering, a step's worth; the answer when there is one.
    fn consider(&mut self, _cx: &Context<'_, S>) -> Option<Result<(), Refusal>> {
        None
    }

    /// The heading for whatever flies next, rad.
    fn heading(&self, handover: &Handover<S>, _cx: &Context<'_, S>) -> S {
        handover.heading
    }

    /// Whether the link pulls, where the mode itself watches that.
    fn sees_pull(&self, _cx: &Context<'_, S>) -> Option<bool> {
        None
    }

    /// How fast the taut-link observer shall be.
    fn purpose(&self) -> Option<TautPurpose> {
        None
    }

    /// Where the out-of-plane filter of the taut-link observer starts, if the mode flies on it.
    fn out_of_plane(&self) -> Option<OutOfPlane<S>> {
        None
    }

    /// The position filter has nothing to hold on to: the link is not taut yet.
    fn climbs_slack(&self) -> bool {
        false
    }

    fn report(&self) -> ModeReport<S> {
        ModeReport::default()
    }
}

/// The modes' states in one enum, and the one match that each question takes.
macro_rules! active_modes {
    ($($mode:ident: $state:ty;)+) => {
        #[derive(Clone, Copy, Debug)]
        enum Flying<S: Scalar> {
            $($mode($state),)+
        }

        impl<S: Scalar> Flying<S> {
            fn enter(
                entry: &Entry,
                handover: &mut Handover<S>,
                cx: &Context<'_, S>,
            ) -> Result<Self, Refusal> {
                Ok(match entry.mode {
                    $(Mode::$mode => Self::$mode(<$state>::enter(entry, handover, cx)?),)+
                })
            }

            fn mode(&self) -> Mode {
                match self { $(Self::$mode(_) => Mode::$mode,)+ }
            }
        }

        /// Calls a method of whichever mode flies.
        macro_rules! flying {
            ($flying:expr, $state_of:ident => $call:expr) => {
                match $flying { $(Flying::$mode($state_of) => $call,)+ }
            };
        }
    };
}

active_modes! {
    Stabilize: sticks::Sticks;
    Altitude: sticks::Sticks;
    TetherHold: hold::Hold;
    Takeoff: takeoff::Takeoff<S>;
    Land: land::Land<S>;
    Descent: descent::Descent<S>;
    TautForce: feature::TautLink<taut::TautLink<S>>;
    TautAttitude: feature::TautLink<taut::TautLink<S>>;
    TetherAngle: feature::TetherAngle<tether_angle::TetherAngle<S>>;
    Pendulum: feature::Pendulum<pendulum::Pendulum<S>>;
    Return: land::Land<S>;
    Position: position::Position;
    Offboard: offboard::Offboard<S>;
}

/// The mode that flies, with its state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActiveMode<S: Scalar> {
    handover: Handover<S>,
    flying: Flying<S>,
}

impl<S: Scalar> ActiveMode<S> {
    /// Tether Hold, on the ground.
    pub fn at_rest(handover: Handover<S>) -> Self {
        Self { handover, flying: Flying::TetherHold(hold::Hold::default()) }
    }

    pub fn mode(&self) -> Mode {
        self.flying.mode()
    }

    pub fn handover(&self) -> &Handover<S> {
        &self.handover
    }

    pub fn handover_mut(&mut self) -> &mut Handover<S> {
        &mut self.handover
    }

    /// Into another mode; a refusal leaves the present one as it is.
    pub fn enter(&mut self, entry: &Entry, cx: &Context<'_, S>) -> Result<(), Refusal> {
        let mut handover = self.handover;
        handover.heading = flying!(&self.flying, state => state.heading(&self.handover, cx));
        if cx.is_in_air() {
            // The thrust of the moment carries weight and tether: the climb loop starts from there.
            let estimate = &cx.situation.estimate;
            let lift = estimate.thrust * estimate.attitude.cos_tilt();
            handover.climb = cx.config.climb.holding(lift);
        }
        let flying = Flying::enter(entry, &mut handover, cx)?;
        *self = Self { handover, flying };
        Ok(())
    }

    /// The motors stopped, or the next flight begins.
    pub fn rest(&mut self, cx: &Context<'_, S>) {
        self.handover.heading = flying!(&self.flying, state => state.heading(&self.handover, cx));
        self.flying = Flying::TetherHold(hold::Hold::default());
    }

    /// What was asked is done: Tether Hold takes over as things are. What to tell; `None` from a mode that goes on.
    pub fn complete(&mut self) -> Option<&'static str> {
        let text = self.mode().rule().completes?;
        self.flying = Flying::TetherHold(hold::Hold::default());
        Some(text)
    }

    pub fn step(&mut self, cx: &Context<'_, S>) -> Result<Setpoints<S>, Exit> {
        flying!(&mut self.flying, state => state.step(&mut self.handover, cx))
    }

    pub fn command(&mut self, action: &Action, cx: &Context<'_, S>) -> Result<(), Refusal> {
        flying!(&mut self.flying, state => state.command(&mut self.handover, action, cx))
    }

    pub fn is_considering(&self) -> bool {
        flying!(&self.flying, state => FlightMode::<S>::is_considering(state))
    }

    pub fn consider(&mut self, cx: &Context<'_, S>) -> Option<Result<(), Refusal>> {
        flying!(&mut self.flying, state => state.consider(cx))
    }

    pub fn sees_pull(&self, cx: &Context<'_, S>) -> Option<bool> {
        flying!(&self.flying, state => FlightMode::<S>::sees_pull(state, cx))
    }

    pub fn purpose(&self) -> Option<TautPurpose> {
        flying!(&self.flying, state => FlightMode::<S>::purpose(state))
    }

    pub fn out_of_plane(&self) -> Option<OutOfPlane<S>> {
        flying!(&self.flying, state => FlightMode::<S>::out_of_plane(state))
    }

    pub fn climbs_slack(&self) -> bool {
        flying!(&self.flying, state => FlightMode::<S>::climbs_slack(state))
    }

    pub fn report(&self) -> ModeReport<S> {
        flying!(&self.flying, state => FlightMode::<S>::report(state))
    }
}
