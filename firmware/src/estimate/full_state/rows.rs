//! What the filter measures on any line (`fullstate` section 4): specific force, height, length and its rate, tension,
//! heading, and the slack velocity.

use super::FullStateFilter;
use super::blocks::{add_mul, add_scaled};
use super::covariance::{
    ACCEL_BIAS, BLOCKS, Blocks, GUST, POSITION, SCALARS, TILT, VELOCITY, WIND,
};
use super::model::{Geometry, GroundEnd, Load};
use super::predict::attitude_e3;
use super::state::FullState;
use super::update::{Column, Outlier, Rows, Sparse};
use crate::fault::Fault;
use crate::frames::{M3, V3};
use crate::math::{so3, wrap_pi};
use crate::scalar::Scalar;

/// Three rows of the accelerometer.
struct AccelRows<S: Scalar> {
    /// Body to world.
    attitude: M3<S>,
    drag: S,
    has_gust: bool,
    /// Transposed.
    by_position: M3<S>,
    /// Transposed.
    by_tilt: M3<S>,
    by_tension: V3<S>,
    /// Of the down axis.
    by_thrust_scale: S,
}

impl<S: Scalar> Rows<S, 3> for AccelRows<S> {
    const IS_DENSE: bool = true;

    #[inline(always)]
    fn project(&self, column: &impl Column<S>) -> [V3<S>; 3] {
        let mut air = column.at::<WIND>();
        if self.has_gust {
            air += column.at::<GUST>();
        }
        add_scaled(&mut air, -self.drag, &column.at::<VELOCITY>());
        let mut sum = column.at::<ACCEL_BIAS>().transpose();
        add_mul(&mut sum, &air.transpose(), &self.attitude);
        add_mul(&mut sum, &column.at::<POSITION>().transpose(), &self.by_position);
        add_mul(&mut sum, &column.at::<TILT>().transpose(), &self.by_tilt);
        let scalars = column.at::<SCALARS>().transpose();
        let (tension, scale) = (so3::col_x(&scalars), so3::col_y(&scalars));
        let [[x, y, z]] = self.by_tension.data.0;
        let [first, second, third] = sum.data.0.map(V3::from);
        [
            first + tension * x,
            second + tension * y,
            third + tension * z + scale * self.by_thrust_scale,
        ]
    }
}

impl<S: Scalar> FullStateFilter<S> {
    fn accel_rows(&self, state: &FullState<S>, load: &Load<S>) -> (AccelRows<S>, V3<S>) {
        let g: Geometry<S> = self.model.geometry(state);
        let r = &state.attitude.0;
        let along = so3::transpose_mul(r, &self.model.outer_force(state, &g, load));
        let mut expected = along + state.accel_bias;
        expected.z -= self.model.lift(state, load);
        let across = self.model.stiffness_across(state, &g, load);
        let mut by_position = M3::zeros();
        add_mul(&mut by_position, &r.transpose(), &across);
        let mut by_tilt = so3::skew(&along);
        add_mul(&mut by_tilt, &(by_position * -self.model.attachment), &attitude_e3(r));
        let mass = self.model.mass;
        let rows = AccelRows {
            attitude: *r,
            drag: self.model.drag,
            has_gust: self.noise.gust.is_some(),
            by_position: by_position.transpose(),
            by_tilt: by_tilt.transpose(),
            by_tension: so3::transpose_mul(r, &g.u) * (-S::one() / mass),
            by_thrust_scale: -load.thrust / mass,
        };
        (rows, expected)
    }

    /// Expected reading of the accelerometer, body axes, m/s², and its derivative, a row of blocks for each axis.
    #[must_use]
    pub fn accelerometer_derivative(
        &self,
        state: &FullState<S>,
        load: &Load<S>,
    ) -> ([Blocks<S>; 3], V3<S>) {
        let (rows, expected) = self.accel_rows(state, load);
        let mut derivative = [[V3::zeros(); BLOCKS]; 3];
        for block in 0..BLOCKS {
            for (row, own) in derivative.iter_mut().zip(rows.project(&Unit(block))) {
                if let Some(entry) = row.get_mut(block) {
                    *entry = own;
                }
            }
        }
        (derivative, expected)
    }

    /// The accelerometer, body axes, m/s².
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; the state is spoilt then. So for every row below.
    pub fn accelerometer(
        &self,
        state: &mut FullState<S>,
        reading: &V3<S>,
        load: &Load<S>,
    ) -> Result<S, Fault> {
        self.shaken_accelerometer(state, reading, load, S::zero())
    }

    /// The same while it shakes: its noise has at least this variance, m²/s⁴.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn shaken_accelerometer(
        &self,
        state: &mut FullState<S>,
        reading: &V3<S>,
        load: &Load<S>,
        variance: S,
    ) -> Result<S, Fault> {
        let (rows, expected) = self.accel_rows(state, load);
        let [nu] = (reading - expected).data.0;
        let variance = variance.max(self.accel_variance);
        self.update(state, &rows, nu.map(Some), variance, Outlier::Clamped)
    }

    /// Height over the anchor, m.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn altimeter(&self, state: &mut FullState<S>, height: S, sd: S) -> Result<S, Fault> {
        let (o, one) = (S::zero(), S::one());
        let rows = Sparse([(POSITION, [V3::new(o, o, -one)]), (SCALARS, [V3::new(o, o, one)])]);
        let nu = height + state.position.z - state.altimeter_bias;
        self.update(state, &rows, [Some(nu)], sd * sd, Outlier::Clamped)
    }

    /// That an altimeter's bias has no reason to be anything but zero.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn unbiased_altimeter(&self, state: &mut FullState<S>, sd: S) -> Result<S, Fault> {
        let (o, one) = (S::zero(), S::one());
        let rows = Sparse([(SCALARS, [V3::new(o, o, one)])]);
        self.update(state, &rows, [Some(-state.altimeter_bias)], sd * sd, Outlier::Clamped)
    }

    /// Distance from anchor to fastening, m, as measured.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn distance(&self, state: &mut FullState<S>, measured: S, sd: S) -> Result<S, Fault> {
        self.distance_row(state, measured, S::zero(), sd)
    }

    /// The line that is out, m, unstretched: what its chord should be.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn line_out(
        &self,
        state: &mut FullState<S>,
        length: S,
        end: GroundEnd,
        sd: S,
    ) -> Result<S, Fault> {
        let chord = self.model.chord(state, length, end);
        self.distance_row(state, chord.length, chord.by_tension, sd)
    }

    fn distance_row(
        &self,
        state: &mut FullState<S>,
        expected: S,
        by_tension: S,
        sd: S,
    ) -> Result<S, Fault> {
        let g = self.model.geometry(state);
        let (o, lever) = (S::zero(), self.model.attachment);
        let body = so3::transpose_mul(&state.attitude.0, &g.u);
        let rows = Sparse([
            (POSITION, [g.u]),
            (TILT, [V3::new(-lever * body.y, lever * body.x, o)]),
            (SCALARS, [V3::new(by_tension, o, o)]),
        ]);
        self.update(state, &rows, [Some(expected - g.length)], sd * sd, Outlier::Clamped)
    }

    /// How fast the distance from the anchor grows, m/s: the payout's rate, zero for a fixed length.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn radial_rate(&self, state: &mut FullState<S>, rate: S, sd: S) -> Result<S, Fault> {
        let g = self.model.geometry(state);
        let across = so3::reject(&state.velocity, &g.u) / g.length;
        let rows = Sparse([(POSITION, [across]), (VELOCITY, [g.u])]);
        let nu = rate - so3::dot(&g.u, &state.velocity);
        self.update(state, &rows, [Some(nu)], sd * sd, Outlier::Clamped)
    }

    /// The chord's tension, N: what a winch without much line holds, or zero in slack.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn chord_tension(&self, state: &mut FullState<S>, tension: S, sd: S) -> Result<S, Fault> {
        let (o, one) = (S::zero(), S::one());
        let rows = Sparse([(SCALARS, [V3::new(one, o, o)])]);
        self.update(state, &rows, [Some(tension - state.tension)], sd * sd, Outlier::Clamped)
    }

    /// Heading of the nose, rad from North.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn heading(&self, state: &mut FullState<S>, heading: S, sd: S) -> Result<S, Fault> {
        let r = &state.attitude.0;
        let rows = Sparse([(TILT, [so3::row_z(r)])]);
        let nu = wrap_pi(heading - r.m21.atan2(r.m11));
        self.update(state, &rows, [Some(nu)], sd * sd, Outlier::Clamped)
    }

    /// Level velocity, North and East, m/s: of the reference in slack, or of an external source.
    ///
    /// # Errors
    /// As [`Self::accelerometer`].
    pub fn level_velocity(
        &self,
        state: &mut FullState<S>,
        [north, east]: [S; 2],
        sd: S,
    ) -> Result<S, Fault> {
        let rows = Sparse([(VELOCITY, level_rows())]);
        let nu = [Some(north - state.velocity.x), Some(east - state.velocity.y)];
        self.update(state, &rows, nu, sd * sd, Outlier::Clamped)
    }
}

/// The identity in one block.
struct Unit(usize);

impl<S: Scalar> Column<S> for Unit {
    fn at<const BLOCK: usize>(&self) -> M3<S> {
        self.get(BLOCK)
    }
    fn get(&self, block: usize) -> M3<S> {
        if block == self.0 { M3::identity() } else { M3::zeros() }
    }
}

/// The first two axes.
pub(super) fn level_rows<S: Scalar>() -> [V3<S>; 2] {
    [V3::x_axis().into_inner(), V3::y_axis().into_inner()]
}
