//! One step ahead: the state by the force model, the covariance by blocks (`fullstate` sections 3 and 18).

use super::FullStateFilter;
use super::blocks::{add_mul, add_outer, add_scaled, mul};
use super::covariance::{
    ACCEL_BIAS, BLOCKS, Covariance, GUST, GYRO_BIAS, OFFSET, POSITION, SCALARS, TILT, VELOCITY,
    WIND,
};
use super::model::{Geometry, Load, gravity};
use super::noise::StepGust;
use super::state::FullState;
use super::update::{Column, Of};
use crate::fault::Fault;
use crate::frames::{M3, V3};
use crate::math::so3;
use crate::scalar::Scalar;

/// The rows of the transition that are not the identity.
struct Transition<S: Scalar> {
    dt: S,
    has_gust: bool,
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
    fn position(&self, column: &impl Column<S>) -> M3<S> {
        let mut row = column.at::<POSITION>();
        add_scaled(&mut row, self.dt, &column.at::<VELOCITY>());
        row
    }

    #[inline(always)]
    fn velocity(&self, column: &impl Column<S>) -> M3<S> {
        let mut row = column.at::<WIND>();
        if self.has_gust {
            row += column.at::<GUST>();
        }
        row *= self.dt;
        add_scaled(&mut row, self.damping, &column.at::<VELOCITY>());
        add_mul(&mut row, &self.stiffness, &column.at::<POSITION>());
        // Nothing leans by yaw, and nothing pulls by the altimeter's bias.
        let (roll, pitch) = (so3::col_x(&self.leaning), so3::col_y(&self.leaning));
        let (tilt, scalars) = (column.at::<TILT>(), column.at::<SCALARS>());
        add_outer(&mut row, &roll, &first_row(&tilt));
        add_outer(&mut row, &pitch, &second_row(&tilt));
        add_outer(&mut row, &self.pull, &first_row(&scalars));
        add_outer(&mut row, &self.thrust, &second_row(&scalars));
        row
    }

    #[inline(always)]
    fn tilt(&self, column: &impl Column<S>) -> M3<S> {
        let mut row = mul(&self.turning, &column.at::<TILT>());
        add_scaled(&mut row, -self.dt, &column.at::<GYRO_BIAS>());
        row
    }
}

/// A row of blocks, read as the column that it is transposed.
struct Across<'a, S: Scalar>(&'a Row<S>);

type Row<S> = [M3<S>; BLOCKS];

impl<S: Scalar> Column<S> for Across<'_, S> {
    #[inline(always)]
    fn at<const BLOCK: usize>(&self) -> M3<S> {
        self.get(BLOCK)
    }
    #[inline(always)]
    fn get(&self, block: usize) -> M3<S> {
        self.0.get(block).map_or_else(M3::zeros, M3::transpose)
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
            has_gust: self.noise.gust.is_some(),
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
    #[inline]
    fn spread(&self, p: &mut Covariance<S>, f: &Transition<S>) {
        let mut position = [M3::zeros(); BLOCKS];
        let (mut velocity, mut tilt) = (position, position);
        macro_rules! column {
            ($j:expr) => {
                position[$j] = f.position(&Of::<_, { $j }>(p));
                velocity[$j] = f.velocity(&Of::<_, { $j }>(p));
                if $j >= TILT {
                    tilt[$j] = f.tilt(&Of::<_, { $j }>(p));
                }
            };
        }
        column!(POSITION);
        column!(VELOCITY);
        column!(TILT);
        column!(SCALARS);
        column!(ACCEL_BIAS);
        column!(GYRO_BIAS);
        column!(WIND);
        if self.used > GUST {
            column!(GUST);
        }
        if self.used > OFFSET {
            column!(OFFSET);
        }
        *p.at_mut::<POSITION, POSITION>() = f.position(&Across(&position));
        *p.at_mut::<POSITION, VELOCITY>() = f.velocity(&Across(&position)).transpose();
        *p.at_mut::<VELOCITY, VELOCITY>() = f.velocity(&Across(&velocity));
        *p.at_mut::<POSITION, TILT>() = f.tilt(&Across(&position)).transpose();
        *p.at_mut::<VELOCITY, TILT>() = f.tilt(&Across(&velocity)).transpose();
        *p.at_mut::<TILT, TILT>() = f.tilt(&Across(&tilt));
        for j in SCALARS..self.used {
            for (i, row) in [&position, &velocity, &tilt].into_iter().enumerate() {
                if let Some(block) = row.get(j) {
                    p.set(i, j, *block);
                }
            }
        }
        self.fade(p);
    }

    /// What decays in the wind, the gusts and the offset.
    fn fade(&self, p: &mut Covariance<S>) {
        let n = &self.noise;
        let same = |left: S| V3::new(left, left, left);
        p.scale(WIND, self.used, &same(n.wind_left));
        if let Some(gust) = &n.gust {
            p.scale(GUST, self.used, &gust.left);
        }
        if self.used > OFFSET && n.offset_left < S::one() {
            p.scale(OFFSET, self.used, &same(n.offset_left));
        }
    }

    fn add_noise(&self, p: &mut Covariance<S>, gust: Option<V3<S>>) {
        let n = &self.noise;
        let same = |variance: S| V3::new(variance, variance, variance);
        p.inflate(VELOCITY, &same(n.velocity));
        p.inflate(TILT, &n.tilt);
        p.inflate(SCALARS, &n.scalars);
        p.inflate(ACCEL_BIAS, &same(n.accel_bias));
        p.inflate(GYRO_BIAS, &n.gyro_bias);
        p.inflate(WIND, &n.wind);
        if let Some(gust) = gust {
            p.inflate(GUST, &gust);
        }
        if self.used > OFFSET && n.offset > S::zero() {
            p.inflate(OFFSET, &V3::new(n.offset, n.offset, S::zero()));
        }
    }
}

#[inline(always)]
fn first_row<S: Scalar>(m: &M3<S>) -> V3<S> {
    V3::new(m.m11, m.m12, m.m13)
}

#[inline(always)]
fn second_row<S: Scalar>(m: &M3<S>) -> V3<S> {
    V3::new(m.m21, m.m22, m.m23)
}

/// Squared scale of the gusts, (m/s²)²: a share of the significant part of the wind.
fn gust_variance<S: Scalar>(gust: &StepGust<S>, level_squared: S, p: &Covariance<S>) -> S {
    let (wind, own, both) = (p.block(WIND, WIND), p.block(GUST, GUST), p.block(WIND, GUST));
    let two = S::lit(2.0);
    let variance = wind.m11 + own.m11 + two * both.m11 + wind.m22 + own.m22 + two * both.m22;
    let significant = (level_squared - gust.significance * variance).max(S::zero());
    gust.floor_squared + gust.share_squared * significant
}
