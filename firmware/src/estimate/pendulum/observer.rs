//! Filter, vertical disturbance and load velocity, one call per motion-capture sample.

use super::filter::{PendulumFilter, PendulumPosterior};
use super::vertical::{VerticalDisturbance, VerticalDisturbanceState};
use crate::fault::{Fault, all_finite};
use crate::frames::{V3, World};
use crate::math::so3;
use crate::scalar::Scalar;

/// A measured direction shorter than this says nothing.
const DIRECTION_FLOOR: f64 = 0.1;

/// One sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumReading<S: Scalar> {
    /// Vehicle → load, any length; `None`: nothing new.
    pub rod: Option<World<V3<S>>>,
    /// Since the direction before, s: its noise is an intensity.
    pub rod_period: S,
    /// Of the vehicle, m.
    pub position: World<V3<S>>,
    /// Of the vehicle, m/s.
    pub velocity: World<V3<S>>,
    /// The body's down axis now.
    pub down: World<V3<S>>,
    /// Thrust really applied since the last sample, N.
    pub thrust: S,
}

/// Filter and, where asked for, the vertical observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumObserver<S: Scalar> {
    /// The nine-state filter.
    pub filter: PendulumFilter<S>,
    /// E1; `None`: the filter's own vertical disturbance.
    pub vertical: Option<VerticalDisturbance<S>>,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumObserverState<S: Scalar> {
    /// The filter's.
    pub posterior: PendulumPosterior<S>,
    /// E1's.
    pub vertical: VerticalDisturbanceState<S>,
    /// Last direction: measured, or else believed.
    rod: V3<S>,
    down: V3<S>,
}

/// What the controller flies on. World axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumEstimate<S: Scalar = f32> {
    /// Of the load, m.
    pub position: World<V3<S>>,
    /// Of the load, m/s (28).
    pub velocity: World<V3<S>>,
    /// Unit vector vehicle → load, as measured.
    pub rod: World<V3<S>>,
    /// rad/s, across the rod.
    pub rod_rate: World<V3<S>>,
    /// On the vehicle, N.
    pub disturbance: World<V3<S>>,
}

impl<S: Scalar> PendulumObserver<S> {
    /// From the first sample; `None` without a direction in it.
    #[must_use]
    pub fn start(
        &self,
        z: &PendulumReading<S>,
    ) -> Option<(PendulumObserverState<S>, PendulumEstimate<S>)> {
        let rod = unit(z.rod.as_ref()?)?;
        let posterior = self.filter.start(&rod);
        self.start_from(posterior, z)
    }

    /// From a given posterior, corrected by the first sample.
    #[must_use]
    pub fn start_from(
        &self,
        mut posterior: PendulumPosterior<S>,
        z: &PendulumReading<S>,
    ) -> Option<(PendulumObserverState<S>, PendulumEstimate<S>)> {
        let rod = unit(z.rod.as_ref()?)?;
        self.filter.update(&mut posterior, &rod, z.rod_period);
        let vertical = VerticalDisturbanceState::default();
        let mut state = PendulumObserverState { posterior, vertical, rod, down: z.down.0 };
        let estimate = self.estimate(&state, z);
        state.vertical.velocity = estimate.velocity.0.z;
        Some((state, estimate))
    }

    /// `dt` s after the last sample.
    ///
    /// # Errors
    /// [`Fault::NotFinite`] for a reading or result that is not; the state is untouched.
    pub fn step(
        &self,
        state: &mut PendulumObserverState<S>,
        z: &PendulumReading<S>,
        dt: S,
    ) -> Result<PendulumEstimate<S>, Fault> {
        let (v, p) = (&z.velocity.0, &z.position.0);
        all_finite(&[v.x, v.y, v.z, p.x, p.y, p.z, z.thrust])?;
        let mut next = *state;
        let reading = z.rod.as_ref().and_then(unit);
        let half = S::lit(0.5);
        let rod = reading.map_or(state.posterior.rod, |now| (now + state.rod) * half);
        let timed = reading.as_ref().map(|rod| (rod, z.rod_period));
        let force = (z.down.0 + state.down) * (-z.thrust * half);
        self.filter.step(&mut next.posterior, (&rod, &force), timed, dt)?;
        let believed = so3::direction(&next.posterior.rod, S::lit(DIRECTION_FLOOR));
        next.rod = reading.or(believed.map(|(rod, _)| rod)).ok_or(Fault::Degenerate)?;
        next.down = z.down.0;
        if let Some(vertical) = &self.vertical {
            let now = self.estimate(&next, z);
            vertical.step(
                &self.filter.model,
                &mut next.vertical,
                now.velocity.0.z,
                (&now.rod.0, &now.rod_rate.0),
                (&force, &now.disturbance.0),
                dt,
            );
        }
        let estimate = self.estimate(&next, z);
        *state = next;
        Ok(estimate)
    }

    fn estimate(
        &self,
        state: &PendulumObserverState<S>,
        z: &PendulumReading<S>,
    ) -> PendulumEstimate<S> {
        let model = &self.filter.model;
        let rod_rate = so3::reject(&state.posterior.rate, &state.rod);
        let mut disturbance = state.posterior.disturbance * model.lever();
        if self.vertical.is_some() {
            disturbance.z = state.vertical.force;
        }
        PendulumEstimate {
            position: World(z.position.0 + state.rod * model.length),
            velocity: World(z.velocity.0 + so3::cross(&rod_rate, &state.rod) * model.length),
            rod: World(state.rod),
            rod_rate: World(rod_rate),
            disturbance: World(disturbance),
        }
    }
}

fn unit<S: Scalar>(v: &World<V3<S>>) -> Option<V3<S>> {
    let (unit, length) = so3::direction(&v.0, S::lit(DIRECTION_FLOOR))?;
    length.is_finite().then_some(unit)
}
