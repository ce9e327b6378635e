//! What sensors of the line and of the place add (`fullstate` sections 21 and 22): its direction at either end, the
//! tension at the ground, a position, an optical flow.

use super::FullStateFilter;
use super::covariance::{GUST, OFFSET, POSITION, SCALARS, TILT, VELOCITY, WIND};
use super::model::Sag;
use super::rows::level_rows;
use super::state::FullState;
use super::update::{Outlier, Sparse};
use crate::fault::Fault;
use crate::frames::{M3, V3};
use crate::math::{so3, wrap_pi};
use crate::scalar::Scalar;

/// Where a direction is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionEnd {
    /// In body axes, from the vehicle along the line.
    Vehicle,
    /// In world axes, at the anchor, along what pulls there.
    Ground,
}

/// An innovation beyond this is no direction of a taut line: a slack one hangs straight down, rad.
const DIRECTION_REJECT: f64 = 0.35;

/// How a direction is read, rad.
#[derive(Clone, Copy)]
enum Reading {
    /// From the down axis towards another one.
    FromDown(usize),
    /// Of the opposite direction, from North.
    Azimuth,
    /// Of the opposite direction, over the horizon.
    Elevation,
}

impl Reading {
    /// What is read of a unit vector, its derivative, and the weight that both and the offset have.
    fn of<S: Scalar>(self, b: &V3<S>) -> (S, V3<S>, S) {
        let o = S::zero();
        let level = (b.x * b.x + b.y * b.y).sqrt().max(S::lit(1e-3));
        match self {
            Self::FromDown(axis) => {
                let mut unit = V3::zeros();
                if let Some(own) = unit.get_mut(axis) {
                    *own = S::one();
                }
                let along = so3::dot(&unit, b);
                let squared = (along * along + b.z * b.z).max(S::lit(1e-9));
                let gradient = (unit * b.z - V3::new(o, o, along)) / squared;
                (along.atan2(b.z), gradient, S::one())
            }
            // Less is known of the azimuth of a steep line.
            Self::Azimuth => ((-b.y).atan2(-b.x), V3::new(-b.y, b.x, o) / level, level),
            Self::Elevation => {
                let steep = -b.z / level;
                (b.z.atan2(level), V3::new(b.x * steep, b.y * steep, level), S::one())
            }
        }
    }
}

impl<S: Scalar> FullStateFilter<S> {
    /// The line's direction: its two angles from the down axis, towards the first and the second one, rad, by
    /// `atan2`. An angle too far off is left out, and counts as one on the gate in what is returned.
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; the state is spoilt then. So for every row below.
    pub fn line_direction(
        &self,
        state: &mut FullState<S>,
        end: DirectionEnd,
        angles: [S; 2],
        length_out: S,
        sd: S,
    ) -> Result<S, Fault> {
        let readings = [Reading::FromDown(0), Reading::FromDown(1)];
        self.direction(state, end, (readings, angles), length_out, sd)
    }

    /// The same at the ground by encoders of azimuth and elevation, rad, in which the line leaves the station.
    ///
    /// # Errors
    /// As [`Self::line_direction`].
    pub fn station_direction(
        &self,
        state: &mut FullState<S>,
        angles: [S; 2],
        length_out: S,
        sd: S,
    ) -> Result<S, Fault> {
        let readings = [Reading::Azimuth, Reading::Elevation];
        self.direction(state, DirectionEnd::Ground, (readings, angles), length_out, sd)
    }

    fn direction(
        &self,
        state: &mut FullState<S>,
        end: DirectionEnd,
        (readings, angles): ([Reading; 2], [S; 2]),
        length_out: S,
        sd: S,
    ) -> Result<S, Fault> {
        let (m, r) = (&self.model, &state.attitude.0);
        let g = m.geometry(state);
        let u = &g.u;
        let sign = match end {
            DirectionEnd::Vehicle => S::one(),
            DirectionEnd::Ground => -S::one(),
        };
        let tension = state.tension.max(S::lit(0.5));
        let bow = sign * m.bow * m.mass;
        let mut n = u * -tension + state.air_force() * bow;
        n.z += sign * m.curve_weight(length_out) * S::lit(0.5);
        let size = so3::norm(&n).max(S::lit(1e-3));
        let t = n / size;
        // J = I - t tᵀ times what stands beside it, over the size.
        let across = |v: &V3<S>| so3::reject(v, &t) / size;
        let by_tension = match m.sag {
            Sag::None => V3::zeros(),
            Sag::OfEstimate | Sag::OfSetpoint(_) => -across(u),
        };
        let place = -tension / g.length;
        let to_own = |v: V3<S>| match end {
            DirectionEnd::Vehicle => so3::transpose_mul(r, &v),
            DirectionEnd::Ground => v,
        };
        let to_world = |v: V3<S>| match end {
            DirectionEnd::Vehicle => r * v,
            DirectionEnd::Ground => v,
        };
        let b = to_own(t);
        let pull = to_own(by_tension);
        let o = S::zero();
        let row = |reading: Reading, axis: usize| {
            let (expected, by_b, weight) = reading.of(&b);
            let world = to_world(by_b);
            let across_line = across(&world);
            let tilt = match end {
                DirectionEnd::Vehicle => so3::cross(&by_b, &b),
                DirectionEnd::Ground => V3::zeros(),
            };
            let mut offset = V3::zeros();
            if let Some(own) = offset.get_mut(axis) {
                *own = weight;
            }
            Angle {
                expected,
                weight,
                position: so3::reject(&across_line, u) * place,
                tilt,
                tension: V3::new(so3::dot(&by_b, &pull), o, o),
                air: across_line * bow,
                offset,
            }
        };
        let [one, other] = readings;
        let (first, second) = (row(one, 0), row(other, 1));
        let [first_offset, second_offset] = state.offset;
        let innovation = |read: S, row: &Angle<S>, offset: S| {
            let nu = wrap_pi(read - row.expected - offset) * row.weight;
            (nu.abs() <= S::lit(DIRECTION_REJECT)).then_some(nu)
        };
        let [one, other] = angles;
        let nu = [innovation(one, &first, first_offset), innovation(other, &second, second_offset)];
        let air = [first.air, second.air];
        let gust = if self.noise.gust.is_some() { air } else { [V3::zeros(); 2] };
        let rows = Sparse([
            (POSITION, [first.position, second.position]),
            (TILT, [first.tilt, second.tilt]),
            (SCALARS, [first.tension, second.tension]),
            (WIND, air),
            (GUST, gust),
            (OFFSET, [first.offset, second.offset]),
        ]);
        let left_out = nu.iter().filter(|nu| nu.is_none()).count();
        let nis = self.update(state, &rows, nu, sd * sd, Outlier::LeftOut)?;
        Ok(nis + S::lit(left_out as f64) * self.gate * self.gate)
    }

    /// The tension at one end of the line, N: a cell's, or at the ground a winch's set-point on a heavy line.
    ///
    /// # Errors
    /// As [`Self::line_direction`].
    pub fn end_tension(
        &self,
        state: &mut FullState<S>,
        end: DirectionEnd,
        tension: S,
        length_out: S,
        sd: S,
    ) -> Result<S, Fault> {
        let u = self.model.direction(state);
        let mut n = u * state.tension;
        let half = self.model.curve_weight(length_out) * S::lit(0.5);
        n.z += match end {
            DirectionEnd::Ground => half,
            DirectionEnd::Vehicle => -half,
        };
        let size = so3::norm(&n).max(S::lit(1e-3));
        let (o, along) = (S::zero(), so3::dot(&u, &n) / size);
        let rows = Sparse([(SCALARS, [V3::new(along, o, o)])]);
        self.update(state, &rows, [Some(tension - size)], sd * sd, Outlier::Clamped)
    }

    /// Level place, North and East of the anchor, m, with the sensor's offset if there is one.
    ///
    /// # Errors
    /// As [`Self::line_direction`].
    pub fn level_position(
        &self,
        state: &mut FullState<S>,
        [north, east]: [S; 2],
        sd: S,
    ) -> Result<S, Fault> {
        let [first, second] = state.offset;
        let rows = Sparse([(POSITION, level_rows()), (OFFSET, level_rows())]);
        let nu = [Some(north - state.position.x - first), Some(east - state.position.y - second)];
        self.update(state, &rows, nu, sd * sd, Outlier::LeftOut)
    }

    /// Velocity along the body's nose and right axes, m/s: an optical flow's.
    ///
    /// # Errors
    /// As [`Self::line_direction`].
    pub fn body_velocity(
        &self,
        state: &mut FullState<S>,
        [ahead, right]: [S; 2],
        sd: S,
    ) -> Result<S, Fault> {
        let r = &state.attitude.0;
        let own = so3::transpose_mul(r, &state.velocity);
        let turned: M3<S> = so3::skew(&own).transpose();
        let rows = Sparse([
            (VELOCITY, [so3::col_x(r), so3::col_y(r)]),
            (TILT, [so3::col_x(&turned), so3::col_y(&turned)]),
        ]);
        self.update(
            state,
            &rows,
            [Some(ahead - own.x), Some(right - own.y)],
            sd * sd,
            Outlier::LeftOut,
        )
    }
}

/// One angle and its derivatives.
struct Angle<S: Scalar> {
    expected: S,
    weight: S,
    position: V3<S>,
    tilt: V3<S>,
    tension: V3<S>,
    air: V3<S>,
    offset: V3<S>,
}
