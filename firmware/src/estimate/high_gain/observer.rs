//! The two-branch observer, tick by tick. `planar` sections 7.4 to 7.8.

use super::{
    BranchIndex, Branches, Canonical, CorrectorGain, Discrimination, Drive, ForceReading,
    HighGainInput, HighGainSettings, Naive, NaiveStep, Predictor, Selector, Update,
};
use crate::fault::{Fault, Invalid, all_finite};
use crate::math::filter::decay;
use crate::math::{gains_from_poles, wrap_pi};
use crate::model::{PlanarImu, PlanarState};
use crate::scalar::Scalar;

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighGain<S> {
    settings: HighGainSettings<S>,
    predictor: Predictor<S>,
    naive: Naive<S>,
    gain: CorrectorGain<S>,
    /// Gain and ticks of the fast start.
    fast: Option<(CorrectorGain<S>, Naive<S>, u32)>,
    selector: Selector<S>,
    follow: S,
    force_min: S,
    /// Residual and ticks.
    switch_off: Option<(S, u32)>,
    restart: Option<(S, u32)>,
}

/// One branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<S> {
    /// `[φ+θ, φ', φ'']`, rad, s.
    pub z: [S; 3],
    /// fL/m as this branch sees it, m/s².
    pub force: S,
    /// Low-passed residual, m/s².
    pub error: S,
    /// Elevation, pitch, rates.
    pub state: PlanarState<S>,
    is_running: bool,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighGainState<S> {
    branches: [Branch<S>; 2],
    selected: BranchIndex,
    sign: S,
    /// The last tick's reading; `None` before the first.
    last: Option<Held<S>>,
    ticks: u32,
    apart: u32,
    astray: u32,
}

/// What a naive update holds over the interval.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held<S> {
    rate: S,
    reading: ForceReading<S>,
    /// Sign of each branch's force.
    signs: [S; 2],
}

/// The selected branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighGainEstimate<S> {
    /// Elevation, pitch, rates.
    pub state: PlanarState<S>,
    /// Link force over mass, m/s², positive in tension.
    pub specific_link_force: S,
    /// Low-passed residual, m/s².
    pub error: S,
    /// Which.
    pub branch: BranchIndex,
}

impl<S: Scalar> HighGain<S> {
    /// # Errors
    /// [`Invalid`] naming the setting.
    pub fn try_new(settings: HighGainSettings<S>) -> Result<Self, Invalid> {
        settings.check()?;
        let gain = |epsilon| CorrectorGain::try_new(&settings.roots, epsilon, settings.period);
        let canonical = Canonical {
            model: settings.model,
            rate_max: S::lit(settings.rate_max),
            accel_max: S::lit(settings.accel_max),
        };
        let [a3, a2, a1] = gains_from_poles("roots", &settings.roots)?;
        let alpha = [a1, a2, a3].map(S::lit);
        let naive = |epsilon: f64| Naive::new(canonical, &alpha, S::lit(epsilon));
        let ticks = |time: f64| (time / settings.period + 0.5) as u32;
        let fast = match settings.fast_start {
            Some((epsilon, time)) => Some((gain(epsilon)?, naive(epsilon), ticks(time))),
            None => None,
        };
        Ok(Self {
            predictor: Predictor { canonical, period: S::lit(settings.period) },
            naive: naive(settings.epsilon),
            gain: gain(settings.epsilon)?,
            fast,
            selector: Selector {
                hysteresis: S::lit(settings.hysteresis),
                is_above_ground: settings.is_above_ground,
            },
            follow: S::one() - decay::<S>(1.0 / settings.forgetting, settings.period),
            force_min: S::lit(settings.force_min),
            switch_off: settings.switch_off.map(|o| (S::lit(o.confident), ticks(o.time))),
            restart: settings.restart.map(|(residual, time)| (S::lit(residual), ticks(time))),
            settings,
        })
    }

    /// As constructed.
    #[must_use]
    pub fn settings(&self) -> &HighGainSettings<S> {
        &self.settings
    }

    /// s.
    #[must_use]
    pub fn period(&self) -> S {
        self.predictor.period
    }

    /// Start at rest: exact if the vehicle is. `thrust`: N, acting now.
    #[must_use]
    pub fn quasi_static(&self, imu: &PlanarImu<S>, thrust: S) -> HighGainState<S> {
        let reading = ForceReading::new(&self.settings.model, imu, thrust);
        let o = S::zero();
        let at = |sign: S| [reading.signed(sign).1, o, o];
        self.start([at(S::one()), at(-S::one())])
    }

    /// Start from given coordinates of branch A and B.
    #[must_use]
    pub fn start(&self, [a, b]: [[S; 3]; 2]) -> HighGainState<S> {
        let branch = |z, is_running| Branch {
            z,
            force: S::zero(),
            error: S::zero(),
            state: PlanarState::default(),
            is_running,
        };
        let (selected, has_two) = match self.settings.branches {
            Branches::Both(selected) => (selected, true),
            Branches::One => (BranchIndex::A, false),
        };
        HighGainState {
            branches: [branch(a, true), branch(b, has_two)],
            selected,
            sign: if selected == BranchIndex::A { S::one() } else { -S::one() },
            last: None,
            ticks: 0,
            apart: 0,
            astray: 0,
        }
    }

    /// One tick: predict to now, correct with this sample, choose a branch.
    ///
    /// # Errors
    /// [`Fault::NotFinite`], [`Fault::Degenerate`]; the state is untouched.
    pub fn step(
        &self,
        state: &mut HighGainState<S>,
        input: &HighGainInput<S>,
    ) -> Result<(), Fault> {
        let imu = &input.imu;
        let (thrust, now) = (input.thrust_measured, input.thrust_now);
        all_finite(&[imu.x, imu.z, imu.rate, thrust, now, input.thrust_rate])?;
        let mut next = *state;
        let reading = ForceReading::new(&self.settings.model, imu, thrust);
        let (gain, naive) = match &self.fast {
            Some((gain, naive, ticks)) if state.ticks < *ticks => (gain, naive),
            _ => (&self.gain, &self.naive),
        };
        if let Some(last) = &state.last {
            for (index, branch) in
                [BranchIndex::A, BranchIndex::B].into_iter().zip(&mut next.branches)
            {
                if branch.is_running {
                    branch.z =
                        self.advance(branch, &reading, last, index.of(&last.signs), input, naive);
                }
            }
        }

        if self.settings.sign_is_continuous {
            let [z1, ..] = next.selected().z;
            next.sign = if reading.along(z1) >= S::zero() { S::one() } else { -S::one() };
        }
        let signs = match next.selected {
            BranchIndex::A => [next.sign, -next.sign],
            BranchIndex::B => [-next.sign, next.sign],
        };
        for (branch, sign) in next.branches.iter_mut().zip(signs) {
            if branch.is_running {
                self.correct(branch, &reading, sign, input, gain);
            }
        }
        self.choose(&mut next);
        let [a, b] = &next.branches;
        all_finite(&a.z).and(all_finite(&b.z)).map_err(|_| Fault::Degenerate)?;
        next.last = Some(Held { rate: imu.rate, reading, signs });
        next.ticks = next.ticks.saturating_add(1);
        if self.has_gone_astray(&mut next) {
            next = self.quasi_static(imu, thrust);
        }
        *state = next;
        Ok(())
    }

    /// From the last tick to this one.
    fn advance(
        &self,
        branch: &Branch<S>,
        reading: &ForceReading<S>,
        last: &Held<S>,
        sign: S,
        input: &HighGainInput<S>,
        naive: &Naive<S>,
    ) -> [S; 3] {
        let h = self.predictor.period;
        let half = S::lit(0.5);
        let [z1, z2, _] = branch.z;
        let how = match self.settings.update {
            Update::PredictorCorrector | Update::PredictorCorrectorHeld => {
                let pitch_rate = if self.settings.update == Update::PredictorCorrector {
                    half * (last.rate + input.imu.rate)
                } else {
                    last.rate
                };
                let ahead = reading.along(z1 + h * (z2 + pitch_rate));
                let drive = Drive {
                    thrust: input.thrust_now - half * h * input.thrust_rate,
                    thrust_rate: input.thrust_rate,
                    pitch_rate,
                    force: half * (branch.force + ahead),
                };
                return self.predictor.predict(&branch.z, &drive);
            }
            Update::Euler => NaiveStep::Euler,
            Update::Rk4Held => NaiveStep::Rk4,
            Update::ExactHeld => NaiveStep::Exact,
        };
        let drive = Drive {
            thrust: input.thrust_now - h * input.thrust_rate,
            thrust_rate: input.thrust_rate,
            pitch_rate: last.rate,
            force: branch.force,
        };
        let (angle, how) = if last.reading.size >= self.force_min {
            (last.reading.signed(sign).1, how)
        } else {
            (z1, NaiveStep::Open)
        };
        self.predictor.canonical.bounded(naive.step(&branch.z, angle, &drive, h, how))
    }

    fn correct(
        &self,
        branch: &mut Branch<S>,
        reading: &ForceReading<S>,
        sign: S,
        input: &HighGainInput<S>,
        gain: &CorrectorGain<S>,
    ) {
        let (force, angle) = reading.signed(sign);
        let is_naive = !matches!(
            self.settings.update,
            Update::PredictorCorrector | Update::PredictorCorrectorHeld
        );
        if reading.size < self.force_min {
            // Without a direction only the part along the predicted one is known.
            let [z1, ..] = branch.z;
            branch.force = reading.along(z1);
        } else {
            branch.force = force;
            if !is_naive {
                branch.z = self.predictor.correct(&branch.z, angle, gain);
            }
        }
        let (state, off_unit) = self.predictor.canonical.to_state(
            &branch.z,
            branch.force,
            input.thrust_now,
            input.thrust_measured,
            input.imu.rate,
        );
        branch.state = state;
        let model = &self.settings.model;
        let residual = match self.settings.discrimination {
            Discrimination::UnitVector => model.gravity * off_unit.abs(),
            Discrimination::Acceleration => {
                let expected = model.imu(&state, input.thrust_measured);
                let (x, z) = (input.imu.x - expected.x, input.imu.z - expected.z);
                (x * x + z * z).sqrt()
            }
        };
        branch.error += (residual - branch.error) * self.follow;
    }

    fn choose(&self, next: &mut HighGainState<S>) {
        let [a, b] = &next.branches;
        if !(a.is_running && b.is_running) {
            return;
        }
        let errors = [a.error, b.error];
        let elevations = [a.state.elevation, b.state.elevation];
        let chosen = self.selector.select(next.selected, &errors, &elevations);
        if chosen != next.selected {
            next.selected = chosen;
            next.sign = -next.sign;
        }
        let Some((confident, ticks)) = self.switch_off else {
            return;
        };
        let (mine, other) = (chosen.of(&errors), chosen.other().of(&errors));
        let is_apart = mine < confident && other > confident * S::lit(3.0);
        next.apart = if is_apart { next.apart + 1 } else { 0 };
        if next.apart >= ticks {
            let [a, b] = &mut next.branches;
            a.is_running = chosen == BranchIndex::A;
            b.is_running = chosen == BranchIndex::B;
        }
    }

    /// Whether no branch has fitted the readings for too long.
    fn has_gone_astray(&self, next: &mut HighGainState<S>) -> bool {
        let Some((residual, ticks)) = self.restart else {
            return false;
        };
        let is_astray = next.branches.iter().all(|b| !b.is_running || b.error > residual);
        next.astray = if is_astray { next.astray + 1 } else { 0 };
        next.astray >= ticks
    }
}

impl<S: Scalar> HighGainState<S> {
    /// Branch A, then B.
    #[must_use]
    pub fn branches(&self) -> &[Branch<S>; 2] {
        &self.branches
    }

    fn selected(&self) -> &Branch<S> {
        let [a, b] = &self.branches;
        match self.selected {
            BranchIndex::A => a,
            BranchIndex::B => b,
        }
    }

    /// The selected branch. Zero before the first tick.
    #[must_use]
    pub fn estimate(&self) -> HighGainEstimate<S> {
        let branch = self.selected();
        HighGainEstimate {
            state: branch.state,
            specific_link_force: branch.force,
            error: branch.error,
            branch: self.selected,
        }
    }

    /// Moves both branches, for tests of convergence.
    #[must_use]
    pub fn displaced(mut self, [d1, d2, d3]: [S; 3]) -> Self {
        for branch in &mut self.branches {
            let [z1, z2, z3] = branch.z;
            branch.z = [wrap_pi(z1 + d1), z2 + d2, z3 + d3];
        }
        self
    }
}
