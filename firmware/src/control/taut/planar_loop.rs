//! One observer and one controller on a taut link, stepped together. `planar` sections 6 and 7.

use super::{Law, ThrustLimits, ThrustState};
use crate::estimate::high_gain::{HighGain, HighGainInput, HighGainState};
use crate::fault::{Fault, Invalid, not_negative};
use crate::math::filter::decay;
use crate::model::{PlanarImu, PlanarState};
use crate::scalar::Scalar;
use crate::signal::PlanarReference;

/// Settings apart from observer and law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarLoopSettings<S> {
    /// Rotor lag that the assumed thrust follows, s; zero: the command acts at once.
    pub motor_lag: f64,
    /// Time after the start in which thrust and attitude are held while the observer settles, s.
    pub hold_off: f64,
    /// `None`: unlimited.
    pub limits: Option<ThrustLimits<S>>,
}

/// Thrust that acted when the accelerometer sampled, where the caller knows it better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acting<S> {
    /// N.
    pub thrust: S,
    /// Mean rate since the last tick, N/s.
    pub rate: S,
}

/// What one tick reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarInput<S> {
    /// Inertial reading, in the plane.
    pub imu: PlanarImu<S>,
    /// `None`: what was commanded, behind [`PlanarLoopSettings::motor_lag`].
    pub acting: Option<Acting<S>>,
    /// `Some`: the controller uses this state instead of the observer's (for comparison).
    pub state: Option<PlanarState<S>>,
}

/// What one tick asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarCommand<S> {
    /// To hold until the next tick, N.
    pub thrust: S,
    /// Its rate, N/s.
    pub thrust_rate: S,
    /// N m.
    pub torque: S,
    /// Torque over the model's inertia, rad/s²: what a rate loop takes as feed-forward.
    pub pitch_accel: S,
    /// The state that the controller used.
    pub state: PlanarState<S>,
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarLoop<S> {
    observer: HighGain<S>,
    law: Law<S>,
    limits: Option<ThrustLimits<S>>,
    /// Time constant and decay per tick; `None`: the command acts at once.
    lag: Option<(S, S)>,
    hold_off: S,
    inertia: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarLoopState<S> {
    observer: HighGainState<S>,
    thrust: ThrustState<S>,
    /// Held during the interval that just ended, and its mean rate.
    applied: S,
    mean_rate: S,
    lagged: S,
    time: S,
}

impl<S: Scalar> PlanarLoop<S> {
    /// Joins observer and law.
    ///
    /// # Errors
    /// [`Invalid`] naming `motor_lag`, `hold_off` or a limit.
    pub fn try_new(
        observer: HighGain<S>,
        law: Law<S>,
        settings: PlanarLoopSettings<S>,
    ) -> Result<Self, Invalid> {
        let lag = not_negative("motor_lag", settings.motor_lag)?;
        not_negative("hold_off", settings.hold_off)?;
        if let Some(limits) = &settings.limits {
            limits.check()?;
        }
        Ok(Self {
            lag: (lag > 0.0).then(|| (S::lit(lag), decay(lag, observer.settings().period))),
            inertia: observer.settings().model.inertia,
            hold_off: S::lit(settings.hold_off),
            limits: settings.limits,
            observer,
            law,
        })
    }

    /// The observer's configuration.
    #[must_use]
    pub fn observer(&self) -> &HighGain<S> {
        &self.observer
    }

    /// Starts at this thrust, N, with a quasi-static guess from the first reading.
    #[must_use]
    pub fn start(&self, imu: &PlanarImu<S>, thrust: S) -> PlanarLoopState<S> {
        self.start_from(self.observer.quasi_static(imu, thrust), thrust)
    }

    /// Starts at this thrust, N, from a given observer state.
    #[must_use]
    pub fn start_from(&self, observer: HighGainState<S>, thrust: S) -> PlanarLoopState<S> {
        PlanarLoopState {
            observer,
            thrust: ThrustState { thrust, rate: S::zero() },
            applied: thrust,
            mean_rate: S::zero(),
            lagged: thrust,
            time: S::zero(),
        }
    }

    /// One tick.
    ///
    /// # Errors
    /// [`Fault::NotFinite`], [`Fault::Degenerate`]; the state is untouched.
    pub fn step(
        &self,
        state: &mut PlanarLoopState<S>,
        input: &PlanarInput<S>,
        reference: &PlanarReference<S>,
    ) -> Result<PlanarCommand<S>, Fault> {
        let mut next = *state;
        let dt = self.observer.period();
        let (measured, now, rate) = match (input.acting, self.lag) {
            (Some(acting), _) => (acting.thrust, acting.thrust, acting.rate),
            (None, Some((tau, decay))) => {
                let short = state.applied - state.lagged;
                next.lagged = state.applied - short * decay;
                (next.lagged, next.lagged, short / tau)
            }
            (None, None) => (state.applied, state.thrust.thrust, state.mean_rate),
        };
        let input_now = HighGainInput {
            imu: input.imu,
            thrust_measured: measured,
            thrust_now: now,
            thrust_rate: rate,
        };
        self.observer.step(&mut next.observer, &input_now)?;
        let x = input.state.unwrap_or_else(|| next.observer.estimate().state);

        let is_held = next.time < self.hold_off;
        let limits = self.limits.as_ref();
        let (applied, torque) = if is_held {
            next.thrust.rate = S::zero();
            (next.thrust.advance_rate(S::zero(), dt, limits), S::zero())
        } else {
            self.law.advance(&mut next.thrust, &x, reference, dt, limits)?
        };
        next.applied = applied.thrust;
        next.mean_rate = applied.mean_rate;
        next.time += dt;
        *state = next;
        Ok(PlanarCommand {
            thrust: applied.thrust,
            thrust_rate: state.thrust.rate,
            torque,
            pitch_accel: torque / self.inertia,
            state: x,
        })
    }
}

impl<S: Scalar> PlanarLoopState<S> {
    /// The observer's state.
    #[must_use]
    pub fn observer(&self) -> &HighGainState<S> {
        &self.observer
    }
}
