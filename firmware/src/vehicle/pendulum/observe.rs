//! The observer in the delayed past, and its belief carried to the present.

use super::PendulumMode;
use crate::estimate::capture::MEMORY;
use crate::estimate::pendulum::{PendulumEstimate, PendulumObserverState, PendulumReading};
use crate::frames::{V3, World};
use crate::math::history::History;
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::Sensors;
use crate::time::{Micros, OUTER_DT};
use crate::vehicle::Vehicle;

/// First and longest period of the samples that counts, s.
const PERIOD: f64 = 0.01;
const PERIOD_MAX: f64 = 0.1;

/// What the vehicle did a while ago.
#[derive(Clone, Copy, Debug)]
struct Past<S: Scalar> {
    down: V3<S>,
    /// N.
    thrust: S,
}

/// Observer of a rod that is seen.
#[derive(Clone, Copy, Debug)]
pub(in crate::vehicle) struct RodWatch<S: Scalar> {
    observer: PendulumObserverState<S>,
    past: History<Past<S>, MEMORY>,
    /// Now.
    pub estimate: PendulumEstimate<S>,
    /// How long it has run, s.
    pub age: S,
    at: Micros,
    /// Of a sample that waits for the next outer step.
    waiting: Option<World<V3<S>>>,
    period: S,
}

impl<S: Scalar> RodWatch<S> {
    /// Whether a direction arrived lately.
    pub fn is_fresh(&self, timeout_us: u64, now: Micros) -> bool {
        now.since(self.at) < timeout_us
    }
}

impl<S: Scalar> Vehicle<S> {
    /// Notes a direction that arrived.
    pub(in crate::vehicle) fn see_rod(&mut self, sensors: &Sensors<S>) {
        let Some(sample) = sensors.rod else { return };
        if let Some(watch) = &mut self.state.rod {
            let period = S::from_f32(sample.at.seconds_since(watch.at));
            watch.period = period.limit(S::lit(1e-3), S::lit(PERIOD_MAX));
            watch.waiting = Some(sample.value);
            watch.at = sample.at;
        } else {
            self.state.rod = self.start_watch(&sample.value, sample.at);
        }
    }

    fn as_of_now(&self) -> Past<S> {
        Past {
            down: so3::col_z(&self.state.estimate.attitude.0),
            thrust: self.state.estimate.thrust,
        }
    }

    fn reading(&self, past: &Past<S>) -> Option<PendulumReading<S>> {
        let estimate = &self.state.estimate;
        Some(PendulumReading {
            rod: None,
            rod_period: S::lit(PERIOD),
            position: estimate.position?,
            velocity: estimate.velocity?,
            down: World(past.down),
            thrust: past.thrust,
        })
    }

    fn start_watch(&self, rod: &World<V3<S>>, at: Micros) -> Option<RodWatch<S>> {
        let mode = self.config.pendulum.as_ref()?;
        let now = self.as_of_now();
        let z = PendulumReading { rod: Some(*rod), ..self.reading(&now)? };
        let (observer, estimate) = mode.observer.start(&z)?;
        let past = History::constant(now);
        let (age, period) = (S::zero(), S::lit(PERIOD));
        Some(RodWatch { observer, past, estimate, age, at, waiting: None, period })
    }

    /// One outer step of the observer; it ends where directions or positions do.
    pub(in crate::vehicle) fn observe_rod(&mut self, now: Micros) {
        let Some(mut watch) = self.state.rod else { return };
        self.state.rod = None;
        let present = self.as_of_now();
        let Some(mode) = &self.config.pendulum else { return };
        if !watch.is_fresh(mode.timeout_us, now) {
            return;
        }
        watch.past.push(present);
        let then = watch.past.ago(mode.delay).copied().unwrap_or(present);
        let Some(z) = self.reading(&then) else { return };
        let z = PendulumReading { rod: watch.waiting.take(), rod_period: watch.period, ..z };
        let Ok(estimate) = mode.observer.step(&mut watch.observer, &z, S::lit(OUTER_DT)) else {
            return;
        };
        watch.age += S::lit(OUTER_DT);
        watch.estimate = mode.present(estimate, &z, &watch.past);
        self.state.rod = Some(watch);
    }
}

impl<S: Scalar> PendulumMode<S> {
    /// The estimate of the delayed past, carried on with the thrust since.
    fn present(
        &self,
        x: PendulumEstimate<S>,
        z: &PendulumReading<S>,
        past: &History<Past<S>, MEMORY>,
    ) -> PendulumEstimate<S> {
        let model = &self.observer.filter.model;
        let dt = S::lit(OUTER_DT);
        let (mut rod, mut rate) = (x.rod.0, x.rod_rate.0);
        for back in (0..self.delay).rev() {
            let Some(then) = past.ago(back) else { break };
            let push = then.down * -then.thrust + x.disturbance.0;
            rate += model.rod_accel(&rod, &push) * dt;
            rod += so3::cross(&rate, &rod) * dt;
        }
        rod /= so3::norm(&rod).max(S::lit(0.1));
        rate = so3::reject(&rate, &rod);
        PendulumEstimate {
            position: World(z.position.0 + rod * model.length),
            velocity: World(z.velocity.0 + so3::cross(&rate, &rod) * model.length),
            rod: World(rod),
            rod_rate: World(rate),
            disturbance: x.disturbance,
        }
    }
}
