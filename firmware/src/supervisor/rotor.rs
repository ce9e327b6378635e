//! Does every rotor pull? One that stops leaves a torque behind that nothing else makes: its thrust at its lever.

use crate::frames::{Body, V3};
use crate::math::filter::first_order;
use crate::math::so3;
use crate::model::Rotors;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{MAX_ROTORS, PerRotor};
use crate::time::OUTER_DT;

/// Low-pass of the body's acceleration, of torque and thrusts beside the motors' own lag, s.
const SMOOTH: f32 = 0.015;
/// What lasts longer is no rotor: wind, a line that pulls aside, s.
const USUAL: f64 = 1.0;
/// Missing torque over that of the whole thrust: at least, and at most.
const SHARE: (f64, f64) = (0.55, 1.6);
/// What no lost rotor explains, as a share of what it does.
const REST: f64 = 0.45;
/// A rotor that hardly pulls cannot be missed, N m.
const LEAST: f64 = 0.12;
/// It lasts so long, steps: 50 ms.
const STEPS: u8 = 12;

/// Configuration; `None` where no rotor can be spared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorWatch<S: Scalar> {
    /// Torque per thrust, m.
    levers: PerRotor<[S; 3]>,
    inertia: V3<S>,
    /// Per step.
    share: S,
    lag: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorWatchState<S: Scalar> {
    rate: Option<V3<S>>,
    slope: V3<S>,
    /// Asked, as late as the slope.
    torque: (V3<S>, V3<S>),
    thrusts: [(S, S); MAX_ROTORS],
    usual: V3<S>,
    suspect: usize,
    steps: u8,
}

impl<S: Scalar> Default for RotorWatchState<S> {
    fn default() -> Self {
        let (o, zero) = (S::zero(), V3::zeros());
        Self {
            rate: None,
            slope: zero,
            torque: (zero, zero),
            thrusts: [(o, o); MAX_ROTORS],
            usual: zero,
            suspect: 0,
            steps: 0,
        }
    }
}

impl<S: Scalar> RotorWatch<S> {
    /// From the parameters; `None` for four rotors, which need each other.
    #[must_use]
    #[inline(never)]
    pub fn new(p: &Params) -> Option<Self> {
        let rotors = Rotors::of(p);
        if rotors.len() <= 4 {
            return None;
        }
        let f = S::from_f32;
        let dt = OUTER_DT as f32;
        let mut levers = PerRotor::all(rotors.len(), [S::zero(); 3]);
        for (lever, r) in levers.iter_mut().zip(rotors.iter()) {
            *lever = [f(-r.y * p.arm), f(r.x * p.arm), f(r.spin * p.torque_ratio)];
        }
        Some(Self {
            levers,
            inertia: V3::new(f(p.inertia_x), f(p.inertia_y), f(p.inertia_z)),
            share: first_order(SMOOTH, dt),
            lag: first_order(p.motor_tau, dt),
        })
    }

    /// One outer step in the air: `rate` rad/s, `torque` asked N m, `thrusts` asked N. The rotor that is dead.
    pub fn step(
        &self,
        state: &mut RotorWatchState<S>,
        rate: &Body<V3<S>>,
        torque: &Body<V3<S>>,
        thrusts: &[S],
    ) -> Option<usize> {
        let slope = (rate.0 - state.rate.unwrap_or(rate.0)) * S::lit(1.0 / OUTER_DT);
        state.rate = Some(rate.0);
        state.slope += (slope - state.slope) * self.share;
        let (lagged, smooth) = &mut state.torque;
        *lagged += (torque.0 - *lagged) * self.lag;
        *smooth += (*lagged - *smooth) * self.share;
        for ((lagged, smooth), thrust) in state.thrusts.iter_mut().zip(thrusts) {
            *lagged += (*thrust - *lagged) * self.lag;
            *smooth += (*lagged - *smooth) * self.share;
        }
        let (j, a) = (&self.inertia, &state.slope);
        let missing = V3::new(j.x * a.x, j.y * a.y, j.z * a.z) - *smooth;
        let fresh = missing - state.usual;
        let found = self.explain(&fresh, &state.thrusts);
        if found.is_none() {
            state.usual += fresh * S::lit(OUTER_DT / USUAL);
        }
        match found {
            Some(rotor) if rotor == state.suspect => state.steps = state.steps.saturating_add(1),
            Some(rotor) => (state.suspect, state.steps) = (rotor, 1),
            None => state.steps = 0,
        }
        found.filter(|_| state.steps >= STEPS)
    }

    /// The rotor without whose thrust there would be this torque.
    fn explain(&self, torque: &V3<S>, thrusts: &[(S, S)]) -> Option<usize> {
        let each = self.levers.iter().zip(thrusts).enumerate();
        let mut best: Option<(usize, S)> = None;
        for (rotor, ([x, y, z], (_, thrust))) in each {
            let lost = V3::new(*x, *y, *z) * -*thrust;
            let power = so3::dot(&lost, &lost);
            if power < S::lit(LEAST * LEAST) {
                continue;
            }
            let share = so3::dot(torque, &lost) / power;
            let rest = torque - lost * share;
            let is_explained = so3::dot(&rest, &rest) < power * S::lit(REST * REST);
            let fits = share > S::lit(SHARE.0) && share < S::lit(SHARE.1) && is_explained;
            let unlike = so3::dot(&rest, &rest);
            if fits && best.is_none_or(|(_, least)| unlike < least) {
                best = Some((rotor, unlike));
            }
        }
        best.map(|(rotor, _)| rotor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Mixer;
    use crate::signal::Wrench;

    /// Half a second of hover, then without a rotor for as long: which is found, and after how many steps.
    fn found(frame: u8, dead: Option<usize>) -> Option<(usize, u32)> {
        let p = Params { frame: f32::from(frame), ..Params::default() };
        let watch = RotorWatch::<f64>::new(&p).unwrap();
        let mut state = RotorWatchState::default();
        let mixer = Mixer::<f64>::new(&p);
        let mut thrusts = mixer.each(0.0);
        let asked = Body(V3::new(0.02, -0.03, 0.004));
        mixer.step(&Wrench { thrust: 17.0, torque: asked }, &mut thrusts);
        let mut rate = V3::zeros();
        for step in 0..250_u32 {
            let mut torque = asked.0 + V3::new(0.05, 0.0, 0.0);
            if let Some(dead) = dead.filter(|_| step >= 125) {
                let [x, y, z] = watch.levers[dead];
                torque -= V3::new(x, y, z) * thrusts[dead];
            }
            rate += torque.component_div(&watch.inertia) * OUTER_DT;
            if let Some(rotor) = watch.step(&mut state, &Body(rate), &asked, &thrusts) {
                return Some((rotor, step.saturating_sub(125)));
            }
        }
        None
    }

    #[test]
    fn a_rotor_that_stops_is_found_by_the_torque_that_is_missing_within_a_tenth_of_a_second() {
        for frame in 2..=5 {
            assert_eq!(found(frame, None), None, "a line that pulls aside is none");
            for dead in 0..if frame < 4 { 6 } else { 8 } {
                let (rotor, steps) = found(frame, Some(dead)).unwrap();
                assert_eq!(rotor, dead, "frame {frame}");
                assert!(steps < 25, "{steps} steps");
            }
        }
    }

    #[test]
    fn a_quad_is_not_watched() {
        assert!(RotorWatch::<f32>::new(&Params::default()).is_none());
    }
}
