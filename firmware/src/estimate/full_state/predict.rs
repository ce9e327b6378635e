//! One step ahead: the state by the force model, the covariance by blocks (`fullstate` sections 3 and 18).

use super::FullStateFilter;
use super::covariance::{
    ACCEL_BIAS, BLOCKS, Covariance, GUST, GYRO_BIAS, OFFSET, POSITION, SCALARS, TILT, VELOCITY,
    WIND, add_mul, add_scaled, mul,
};
use super::model::{Geometry, Load, gravity};
use super::noise::StepGust;
use super::state::FullState;
use crate::fault::Fault;
use crate::frames::{M3, V3};
use crate::math::so3;
use crate::scalar::Scalar;

/// The rows of the transition that are not the identity.
struct Transition<S: Scalar> {
    dt: S,
    /// Of velocity by itself.
    damping: S,
    /// Of velocity by position.
    stiffness: M3<S>,
    /// Of velocity by tilt.
    leaning: M3<S>,
    /// Of velocity by tension.
    pull: V3<S>,
    /// Of velocity by the thrust's scale.
    thrust: V3<S>,
    /// Of tilt by itself.
    turning: M3<S>,
}

/// `R [e3]×`.
pub(super) fn attitude_e3<S: Scalar>(r: &M3<S>) -> M3<S> {
    let o = S::zero();
    M3::new(r.m12, -r.m11, o, r.m22, -r.m21, o, r.m32, -r.m31, o)
}

impl<S: Scalar> Transition<S> {
    /// The position's row times a column of blocks.
    #[inline(always)]
    fn position(&self, column: impl Fn(usize) -> M3<S>) -> M3<S> {
        let mut row = column(POSITION);
        add_scaled(&mut row, self.dt, &column(VELOCITY));
        row
    }

    #[inline(always)]
    fn velocity(&self, has_gust: bool, column: impl Fn(usize) -> M3<S>) -> M3<S> {
        let mut row = column(WIND);
        if has_gust {
            add_scaled(&mut row, S::one(), &column(GUST));
        }
        row *= self.dt;
        add_scaled(&mut row, self.damping, &column(VELOCITY));
        add_mul(&mut row, &self.stiffness, &column(POSITION));
        add_mul(&mut row, &self.leaning, &column(TILT));
        add_mul(
            &mut row,
            &M3::from_columns(&[self.pull, self.thrust, V3::zeros()]),
            &column(SCALARS),
        );
        row
    }

    #[inline(always)]
    fn tilt(&self, column: impl Fn(usize) -> M3<S>) -> M3<S> {
        let mut row = mul(&self.turning, &column(TILT));
        add_scaled(&mut row, -self.dt, &column(GYRO_BIAS));
        row
    }
}

impl<S: Scalar> FullStateFilter<S> {
    /// One step with the mean of the gyro's samples, rad/s, body axes.
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; the state is spoilt then.
    pub fn predict(
        &self,
        state: &mut FullState<S>,
        gyro: &V3<S>,
        load: &Load<S>,
    ) -> Result<(), Fault> {
        let is_known = gyro.iter().all(|w| w.is_finite());
        let rate = if is_known { gyro - state.gyro_bias } else { V3::zeros() };
        let g = self.model.geometry(state);
        let (transition, turn) = self.transition(state, &g, &rate, load);
        let gust = self.noise.gust.as_ref();
        let before = state.air_force();
        let level_squared = before.x * before.x + before.y * before.y;
        self.advance(state, &g, &turn, load)?;
        self.spread(&mut state.covariance, &transition);
        let fresh =
            gust.map(|gust| gust.refreshed * gust_variance(gust, level_squared, &state.covariance));
        self.add_noise(&mut state.covariance, fresh);
        Ok(())
    }

    /// Standard deviation of the gusts that the estimate suggests, m/s²; zero without gust states.
    #[must_use]
    pub fn gust_deviation(&self, state: &FullState<S>) -> S {
        let air = state.air_force();
        let level_squared = air.x * air.x + air.y * air.y;
        self.noise
            .gust
            .as_ref()
            .map_or(S::zero(), |gust| gust_variance(gust, level_squared, &state.covariance).sqrt())
    }

    fn transition(
        &self,
        state: &FullState<S>,
        g: &Geometry<S>,
        rate: &V3<S>,
        load: &Load<S>,
    ) -> (Transition<S>, V3<S>) {
        let dt = self.noise.dt;
        let r = &state.attitude.0;
        let stiffness = self.model.stiffness_across(state, g, load) * dt;
        let e3 = attitude_e3(r);
        let mut leaning = e3 * (self.model.lift(state, load) * dt);
        add_mul(&mut leaning, &(stiffness * -self.model.attachment), &e3);
        let turn = rate * dt;
        let transition = Transition {
            dt,
            damping: S::one() - self.model.drag * dt,
            stiffness,
            leaning,
            pull: g.u * (-dt / self.model.mass),
            thrust: so3::col_z(r) * (-dt * load.thrust / self.model.mass),
            turning: so3::exp(&-turn),
        };
        (transition, turn)
    }

    fn advance(
        &self,
        state: &mut FullState<S>,
        g: &Geometry<S>,
        turn: &V3<S>,
        load: &Load<S>,
    ) -> Result<(), Fault> {
        let n = &self.noise;
        let accel = self.model.outer_force(state, g, load)
            - so3::col_z(&state.attitude.0) * self.model.lift(state, load)
            + gravity();
        let half = accel * (n.dt * S::lit(0.5));
        state.position += (state.velocity + half) * n.dt;
        state.velocity += accel * n.dt;
        state.turn(turn)?;
        state.wind *= n.wind_left;
        if let Some(gust) = &n.gust {
            state.gust.component_mul_assign(&gust.left);
        }
        let [first, second] = state.offset;
        state.offset = [first * n.offset_left, second * n.offset_left];
        Ok(())
    }

    /// `F P Fᵀ`: the rows first, then of those the columns, upper triangle only.
    fn spread(&self, p: &mut Covariance<S>, f: &Transition<S>) {
        let has_gust = self.noise.gust.is_some();
        let mut rows = [[M3::zeros(); BLOCKS]; 3];
        {
            let [position, velocity, tilt] = &mut rows;
            let each = position.iter_mut().zip(velocity).zip(tilt).enumerate();
            for (j, ((position, velocity), tilt)) in each.take(self.used) {
                let column = |k| p.block(k, j);
                *position = f.position(column);
                *velocity = f.velocity(has_gust, column);
                *tilt = f.tilt(column);
            }
        }
        let [position, velocity, tilt] = &rows;
        let across =
            |row: &[M3<S>; BLOCKS], k: usize| row.get(k).map_or_else(M3::zeros, M3::transpose);
        p.set(POSITION, POSITION, f.position(|k| across(position, k)));
        p.set(POSITION, VELOCITY, f.velocity(has_gust, |k| across(position, k)).transpose());
        p.set(VELOCITY, VELOCITY, f.velocity(has_gust, |k| across(velocity, k)));
        p.set(POSITION, TILT, f.tilt(|k| across(position, k)).transpose());
        p.set(VELOCITY, TILT, f.tilt(|k| across(velocity, k)).transpose());
        p.set(TILT, TILT, f.tilt(|k| across(tilt, k)));
        for j in SCALARS..self.used {
            for (i, row) in rows.iter().enumerate() {
                if let Some(block) = row.get(j) {
                    p.set(i, j, *block);
                }
            }
            self.fade(p, j);
        }
    }

    /// A decaying state's column.
    fn fade(&self, p: &mut Covariance<S>, column: usize) {
        let n = &self.noise;
        let same = |left: S| V3::new(left, left, left);
        let left = match column {
            WIND => same(n.wind_left),
            GUST => n.gust.as_ref().map_or_else(V3::zeros, |gust| gust.left),
            OFFSET if n.offset_left < S::one() => same(n.offset_left),
            _ => return,
        };
        for row in 0..column {
            p.set(row, column, across_columns(&p.block(row, column), &left));
        }
        let own = across_columns(&p.block(column, column), &left);
        p.set(column, column, across_columns(&own.transpose(), &left));
        // The rows of this block that stand in the columns after it fade as well.
        for later in column + 1..self.used {
            let block = p.block(column, later).transpose();
            p.set(column, later, across_columns(&block, &left).transpose());
        }
    }

    fn add_noise(&self, p: &mut Covariance<S>, gust: Option<V3<S>>) {
        let n = &self.noise;
        let same = |variance: S| V3::new(variance, variance, variance);
        p.inflate(VELOCITY, &same(n.velocity));
        p.inflate(TILT, &same(n.tilt));
        p.inflate(SCALARS, &n.scalars);
        p.inflate(ACCEL_BIAS, &same(n.accel_bias));
        p.inflate(GYRO_BIAS, &same(n.gyro_bias));
        p.inflate(WIND, &n.wind);
        if let Some(gust) = gust {
            p.inflate(GUST, &gust);
        }
        if self.used > OFFSET && n.offset > S::zero() {
            p.inflate(OFFSET, &V3::new(n.offset, n.offset, S::zero()));
        }
    }
}

fn across_columns<S: Scalar>(block: &M3<S>, factor: &V3<S>) -> M3<S> {
    let mut scaled = *block;
    let [factors] = &factor.data.0;
    for (column, factor) in scaled.data.0.iter_mut().zip(factors) {
        for entry in column {
            *entry *= *factor;
        }
    }
    scaled
}

/// Squared scale of the gusts, (m/s²)²: a share of the significant part of the wind.
fn gust_variance<S: Scalar>(gust: &StepGust<S>, level_squared: S, p: &Covariance<S>) -> S {
    let (wind, own, both) = (p.block(WIND, WIND), p.block(GUST, GUST), p.block(WIND, GUST));
    let two = S::lit(2.0);
    let variance = wind.m11 + own.m11 + two * both.m11 + wind.m22 + own.m22 + two * both.m22;
    let significant = (level_squared - gust.significance * variance).max(S::zero());
    gust.floor_squared + gust.share_squared * significant
}
