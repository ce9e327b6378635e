//! What pulls, pushes and weighs: the force model of `fullstate` sections 2, 18 and 22.

use super::state::FullState;
use crate::frames::{M3, V3};
use crate::math::{GRAVITY, so3};
use crate::model::Line;
use crate::scalar::Scalar;

/// Of what length the chord is, given how much line is out (`fullstate` section 22).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sag<S> {
    /// Light and short: the line is straight.
    None,
    /// Of the estimated tension. Only where a tension is measured or set by a winch: with neither the estimate runs
    /// away.
    OfEstimate,
    /// Of a mean set-point, N: a heavy line of fixed length without a cell.
    OfSetpoint(S),
}

/// What holds the ground end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroundEnd {
    /// The line stretches under its tension.
    Fixed,
    /// The payout is measured at the drum, under tension.
    Winch,
}

/// The vehicle and its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullStateModel<S> {
    /// kg.
    pub mass: S,
    /// Of the line's fastening below the centre of mass, m.
    pub attachment: S,
    /// Drag over mass and speed, 1/s.
    pub drag: S,
    /// Weight per length.
    pub line: Line<S>,
    /// Tension over strain, N.
    pub stiffness: S,
    /// Shortest chord that has a direction, m.
    pub length_floor: S,
    /// What the weight does to the chord.
    pub sag: Sag<S>,
    /// Share of the wind's force on the vehicle that comes through the line.
    pub bow: S,
}

/// What acts on the vehicle beside its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<S> {
    /// Modelled thrust along the body's up axis, N, filtered as the accelerometer is.
    pub thrust: S,
    /// The line is not slack.
    pub is_taut: bool,
    /// Unstretched length out, m.
    pub length_out: S,
}

/// Where the line is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry<S: Scalar> {
    /// From anchor to fastening, unit.
    pub u: V3<S>,
    /// m, not below the floor.
    pub length: S,
}

/// The chord's expected length and what the tension does to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord<S> {
    /// m.
    pub length: S,
    /// By the tension, m/N; zero where it is used as if measured.
    pub by_tension: S,
    /// By the tension, of the sag alone, m/N: how soft a spring the curve is.
    pub softness: S,
}

impl<S: Scalar> FullStateModel<S> {
    pub(super) fn geometry(&self, state: &FullState<S>) -> Geometry<S> {
        let d = state.position + so3::col_z(&state.attitude.0) * self.attachment;
        let length = so3::norm(&d).max(self.length_floor);
        Geometry { u: d / length, length }
    }

    /// Distance from anchor to fastening, m.
    #[must_use]
    pub fn distance(&self, state: &FullState<S>) -> S {
        self.geometry(state).length
    }

    /// Unit vector from anchor to fastening, world axes.
    #[must_use]
    pub fn direction(&self, state: &FullState<S>) -> V3<S> {
        self.geometry(state).u
    }

    /// Weight of the line for the curve, N: none where the line counts as straight.
    pub(super) fn curve_weight(&self, length_out: S) -> S {
        match self.sag {
            Sag::None => S::zero(),
            Sag::OfEstimate | Sag::OfSetpoint(_) => self.line.half_weight(length_out) * S::lit(2.0),
        }
    }

    /// Everything but thrust and gravity, over mass, world axes, m/s².
    pub(super) fn outer_force(
        &self,
        state: &FullState<S>,
        g: &Geometry<S>,
        load: &Load<S>,
    ) -> V3<S> {
        let hangs = match self.sag {
            Sag::None => g.length,
            Sag::OfEstimate | Sag::OfSetpoint(_) => load.length_out,
        };
        let mut force =
            state.air_force() - state.velocity * self.drag - g.u * (state.tension / self.mass);
        force.z += self.line.half_weight(hangs) / self.mass;
        force
    }

    /// Thrust over mass, m/s², upwards in body axes.
    pub(super) fn lift(&self, state: &FullState<S>, load: &Load<S>) -> S {
        state.thrust_scale * load.thrust / self.mass
    }

    /// What an accelerometer without bias reads, body axes, m/s².
    #[must_use]
    pub fn specific_force(&self, state: &FullState<S>, load: &Load<S>) -> V3<S> {
        let mut s = so3::transpose_mul(
            &state.attitude.0,
            &self.outer_force(state, &self.geometry(state), load),
        );
        s.z -= self.lift(state, load);
        s
    }

    /// `B = -(fe/(m l))(I - u uᵀ)`: the pull's change with the place, 1/s²; none in slack.
    pub(super) fn stiffness_across(
        &self,
        state: &FullState<S>,
        g: &Geometry<S>,
        load: &Load<S>,
    ) -> M3<S> {
        if !load.is_taut {
            return M3::zeros();
        }
        let b = -state.tension / (self.mass * g.length);
        let [[x, y, z]] = g.u.data.0;
        let (xy, xz, yz) = (-b * x * y, -b * x * z, -b * y * z);
        let (xx, yy, zz) = (b - b * x * x, b - b * y * y, b - b * z * z);
        M3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Expected chord of `length_out` m of line: stretched where the ground end is fixed, and sagging
    /// (`fullstate` sections 4 and 22).
    #[must_use]
    pub fn chord(&self, state: &FullState<S>, length_out: S, end: GroundEnd) -> Chord<S> {
        let strain = match end {
            GroundEnd::Fixed => length_out / self.stiffness,
            GroundEnd::Winch => S::zero(),
        };
        let stretched = length_out + strain * state.tension.max(S::zero());
        let pull = match self.sag {
            Sag::None => {
                let o = S::zero();
                return Chord { length: stretched, by_tension: o, softness: o };
            }
            Sag::OfEstimate => state.tension,
            Sag::OfSetpoint(mean) => mean,
        }
        .max(S::lit(0.8));
        let u = self.geometry(state).u;
        let level = (u.x * u.x + u.y * u.y).sqrt();
        let k = (self.curve_weight(length_out) * level / pull).min(S::lit(1.5));
        let softness = length_out * k * k / (S::lit(12.0) * pull);
        let by_tension = match self.sag {
            Sag::OfEstimate => -(strain + softness),
            Sag::None | Sag::OfSetpoint(_) => S::zero(),
        };
        let length = stretched - length_out * k * k / S::lit(24.0);
        Chord { length, by_tension, softness }
    }
}

/// Gravity, world axes, m/s².
pub(super) fn gravity<S: Scalar>() -> V3<S> {
    V3::new(S::zero(), S::zero(), S::lit(GRAVITY))
}
