//! The observer in the delayed past, and its posterior carried to the present.

use super::PendulumConfig;
use crate::estimate::capture::MEMORY;
use crate::estimate::pendulum::{PendulumEstimate, PendulumObserverState, PendulumReading};
use crate::frames::{V3, World};
use crate::math::history::History;
use crate::math::so3;
use crate::scalar::Scalar;
use crate::signal::Estimate;
use crate::time::{Micros, OUTER_DT, Sample};

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
pub(crate) struct RodWatch<S: Scalar> {
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

/// What the observer needs of the rest of the estimate.
fn reading<S: Scalar>(estimate: &Estimate<S>, past: &Past<S>) -> Option<PendulumReading<S>> {
    Some(PendulumReading {
        rod: None,
        rod_period: S::lit(PERIOD),
        position: estimate.position?,
        velocity: estimate.velocity?,
        down: World(past.down),
        thrust: past.thrust,
    })
}

impl<S: Scalar> Past<S> {
    fn of(estimate: &Estimate<S>) -> Self {
        Self { down: so3::col_z(&estimate.attitude.0), thrust: estimate.thrust }
    }
}

impl<S: Scalar> PendulumConfig<S> {
    /// Notes a direction that arrived.
    pub fn receive(
        &self,
        watch: &mut Option<RodWatch<S>>,
        sample: &Sample<World<V3<S>>>,
        estimate: &Estimate<S>,
    ) {
        if let Some(watch) = watch {
            let period = S::from_f32(sample.at.seconds_since(watch.at));
            watch.period = period.limit(S::lit(1e-3), S::lit(PERIOD_MAX));
            watch.waiting = Some(sample.value);
            watch.at = sample.at;
        } else {
            *watch = self.start(&sample.value, sample.at, estimate);
        }
    }

    fn start(&self, rod: &World<V3<S>>, at: Micros, estimate: &Estimate<S>) -> Option<RodWatch<S>> {
        let now = Past::of(estimate);
        let z = PendulumReading { rod: Some(*rod), ..reading(estimate, &now)? };
        let (observer, estimate) = self.observer.start(&z)?;
        let past = History::constant(now);
        let (age, period) = (S::zero(), S::lit(PERIOD));
        Some(RodWatch { observer, past, estimate, age, at, waiting: None, period })
    }

    /// One outer step of the observer; it ends where directions or positions do.
    pub fn observe(&self, slot: &mut Option<RodWatch<S>>, estimate: &Estimate<S>, now: Micros) {
        let Some(watch) = slot else { return };
        if self.observe_one(watch, estimate, now).is_none() {
            *slot = None;
        }
    }

    fn observe_one(
        &self,
        watch: &mut RodWatch<S>,
        estimate: &Estimate<S>,
        now: Micros,
    ) -> Option<()> {
        if !watch.is_fresh(self.timeout_us, now) {
            return None;
        }
        let present = Past::of(estimate);
        watch.past.push(present);
        let then = watch.past.ago(self.delay).copied().unwrap_or(present);
        let z = reading(estimate, &then)?;
        let z = PendulumReading { rod: watch.waiting.take(), rod_period: watch.period, ..z };
        let seen = self.observer.step(&mut watch.observer, &z, S::lit(OUTER_DT)).ok()?;
        watch.age += S::lit(OUTER_DT);
        watch.estimate = self.present(seen, &z, &watch.past);
        Some(())
    }

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
