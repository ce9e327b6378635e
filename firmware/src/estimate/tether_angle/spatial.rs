//! Two planar filters make a tether direction in space. `inertial` section 8.
//!
//! Axes here: x and y horizontal, z up (x North, y West, z up in flight; body x forward, y left, z up).
//! The planes are (x, z) and (y, z); angles from straight up, positive towards +x and +y. The heading
//! comes from outside.

use super::ukf::{TetherAngleState, TetherAngleUkf};
use crate::frames::{M3, V3};
use crate::math::so3;
use crate::model::{TetherAngleModel, TiltImu};
use crate::scalar::Scalar;

/// Smallest share of thrust or length that a plane is given.
const PROJECTION_FLOOR: f64 = 0.05;

/// How the body stands, from the tilts in both planes and the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltFrame<S: Scalar> {
    /// Body to world.
    pub rotation: M3<S>,
}

fn direction_of<S: Scalar>(angle_x: S, angle_y: S) -> V3<S> {
    // (tan x, tan y, 1), normalised, without dividing by a cosine.
    let ((sx, cx), (sy, cy)) = (angle_x.sin_cos(), angle_y.sin_cos());
    let v = V3::new(sx * cy, sy * cx, cx * cy);
    v / so3::norm(&v).max(S::lit(1e-6))
}

impl<S: Scalar> TiltFrame<S> {
    /// From the tilts in the planes (x, z) and (y, z) and the heading about z, rad.
    #[must_use]
    pub fn new(tilt_x: S, tilt_y: S, heading: S) -> Self {
        let z = direction_of(tilt_x, tilt_y);
        let (sin, cos) = heading.sin_cos();
        let across = so3::cross(&z, &V3::new(cos, sin, S::zero()));
        let y = across / so3::norm(&across).max(S::lit(1e-6));
        let x = so3::cross(&y, &z);
        Self { rotation: M3::from_columns(&[x, y, z]) }
    }

    /// Thrust axis.
    #[must_use]
    pub fn thrust_axis(&self) -> V3<S> {
        so3::col_z(&self.rotation)
    }

    /// Rates of both tilts for a body rate, rad/s.
    #[must_use]
    pub fn tilt_rates(&self, body_rate: &V3<S>) -> [S; 2] {
        let z = self.thrust_axis();
        let turn = so3::cross(&(self.rotation * body_rate), &z);
        let rate = |h: S, h_dot: S| {
            let square = (h * h + z.z * z.z).max(S::lit(1e-6));
            (h_dot * z.z - h * turn.z) / square
        };
        [rate(z.x, turn.x), rate(z.y, turn.y)]
    }

    /// The specific force of the body in both planes, m/s²; each gets the axes of its own tilt.
    #[must_use]
    pub fn planar_forces(&self, body_force: &V3<S>, tilts: [S; 2]) -> [[S; 2]; 2] {
        let a = self.rotation * body_force;
        let [tilt_x, tilt_y] = tilts;
        let project = |horizontal: S, tilt: S| {
            let (sin, cos) = tilt.sin_cos();
            [horizontal * cos - a.z * sin, horizontal * sin + a.z * cos]
        };
        [project(a.x, tilt_x), project(a.y, tilt_y)]
    }

    /// Body rate that turns both tilts at these rates, rad/s, without yaw.
    #[must_use]
    pub fn body_rate(&self, tilt_rates: [S; 2]) -> V3<S> {
        let [rate_x, rate_y] = tilt_rates;
        let z = self.thrust_axis();
        let up = z.z.max(S::lit(PROJECTION_FLOOR));
        let t = V3::new(z.x / up, z.y / up, S::one());
        // d tan/dt = rate / cos².
        let t_dot =
            V3::new(rate_x * (S::one() + t.x * t.x), rate_y * (S::one() + t.y * t.y), S::zero());
        let world = so3::cross(&t, &t_dot) / so3::dot(&t, &t);
        so3::transpose_mul(&self.rotation, &world)
    }
}

/// Both planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAngles<S> {
    /// Of each plane.
    pub ukf: TetherAngleUkf<S>,
    /// Thrust and length of the vehicle in space.
    pub model: TetherAngleModel<S>,
    /// Whether each plane gets only its part of thrust and length.
    pub projects: bool,
}

/// What moves, planes (x, z) and (y, z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherAnglesState<S: Scalar> {
    /// Each plane's filter.
    pub planes: [TetherAngleState<S>; 2],
}

impl<S: Scalar> TetherAnglesState<S> {
    /// Not started; the tilts pick the sides, rad.
    #[must_use]
    pub fn with_prior(tilts: [S; 2]) -> Self {
        Self { planes: tilts.map(TetherAngleState::with_prior) }
    }

    /// Tilt estimates, rad.
    #[must_use]
    pub fn tilts(&self) -> [S; 2] {
        let [x, y] = &self.planes;
        [x.posterior.x.tilt, y.posterior.x.tilt]
    }

    /// Tether angle estimates, rad.
    #[must_use]
    pub fn angles(&self) -> [S; 2] {
        let [x, y] = &self.planes;
        [x.posterior.x.angle, y.posterior.x.angle]
    }

    /// Both planes may be flown on.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.planes.iter().all(TetherAngleState::is_running)
    }

    /// How the body stands at this heading, rad.
    #[must_use]
    pub fn frame(&self, heading: S) -> TiltFrame<S> {
        let [x, y] = self.tilts();
        TiltFrame::new(x, y, heading)
    }

    /// From the anchor to the vehicle.
    #[must_use]
    pub fn direction(&self) -> V3<S> {
        let [x, y] = self.angles();
        direction_of(x, y)
    }
}

impl<S: Scalar> TetherAngles<S> {
    /// What each plane sees of thrust and length, by the present estimates.
    #[must_use]
    pub fn planar_models(
        &self,
        state: &TetherAnglesState<S>,
        frame: &TiltFrame<S>,
    ) -> [TetherAngleModel<S>; 2] {
        if !self.projects {
            return [self.model; 2];
        }
        let (z, e) = (frame.thrust_axis(), state.direction());
        let share = |h: S, up: S| (h * h + up * up).sqrt().max(S::lit(PROJECTION_FLOOR));
        let model = |z_h: S, e_h: S| TetherAngleModel {
            thrust: self.model.thrust * share(z_h, z.z),
            length: self.model.length * share(e_h, e.z),
        };
        [model(z.x, e.x), model(z.y, e.y)]
    }

    /// What each plane's filter is told of one sample: specific force, m/s², if there is one, and mean rate, rad/s, in
    /// body axes, at this heading.
    #[must_use]
    pub fn readings(
        &self,
        state: &TetherAnglesState<S>,
        body_force: Option<&V3<S>>,
        body_rate: &V3<S>,
        heading: S,
    ) -> [PlaneReading<S>; 2] {
        let frame = state.frame(heading);
        let [model_x, model_y] = self.planar_models(state, &frame);
        let forces = body_force.map(|force| frame.planar_forces(force, state.tilts()));
        let [rate_x, rate_y] = frame.tilt_rates(body_rate);
        let [force_x, force_y] = forces.map_or([None; 2], |forces| forces.map(Some));
        [
            PlaneReading { model: model_x, force: force_x, rate: rate_x },
            PlaneReading { model: model_y, force: force_y, rate: rate_y },
        ]
    }

    /// One plane's filter takes its reading.
    pub fn take(&self, plane: &mut TetherAngleState<S>, reading: &PlaneReading<S>) {
        let PlaneReading { model, force, rate } = *reading;
        match force {
            Some([x, z]) => self.ukf.step(&model, plane, &TiltImu { x, z, rate }),
            None => self.ukf.dead_reckon(&model, plane, rate),
        }
    }

    /// Takes one sample in both planes; arguments as of [`Self::readings`].
    pub fn step(
        &self,
        state: &mut TetherAnglesState<S>,
        body_force: Option<&V3<S>>,
        body_rate: &V3<S>,
        heading: S,
    ) {
        let readings = self.readings(state, body_force, body_rate, heading);
        for (plane, reading) in state.planes.iter_mut().zip(&readings) {
            self.take(plane, reading);
        }
    }
}

/// What one plane's filter is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneReading<S> {
    /// Thrust and length as the plane sees them.
    pub model: TetherAngleModel<S>,
    /// m/s²; `None`: dead-reckoned.
    pub force: Option<[S; 2]>,
    /// Of the tilt, rad/s.
    pub rate: S,
}
