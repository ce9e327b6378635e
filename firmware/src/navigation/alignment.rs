//! How does the vehicle sit? Nobody knows until it has stood still; from then on the attitude filter does.

use crate::estimate::{LevelState, Leveller, Mahony, MahonyState};
use crate::frames::{Attitude, Body, V3};
use crate::math::{so3, wrap_pi};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::Imu;

/// Share of a heading error that a motion-capture sample takes away in the air: 0.5 s at 100 Hz.
const HEADING_SHARE: f64 = 0.02;

/// The same of a compass, on the ground: 0.4 s at 250 Hz.
const COMPASS_SHARE: f64 = 0.01;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alignment<S: Scalar> {
    leveller: Leveller<S>,
    mahony: Mahony<S>,
}

/// What the accelerometer says of the vertical.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stance {
    /// Firmly on the ground.
    Standing,
    /// Still there, but the thrust carries much of the weight.
    Light,
    /// Off the ground.
    Airborne,
}

/// What moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct AlignmentState<S: Scalar> {
    level: LevelState<S>,
    /// `None` until levelled.
    pub attitude: Option<MahonyState<S>>,
}

impl<S: Scalar> Default for AlignmentState<S> {
    fn default() -> Self {
        Self { level: LevelState::default(), attitude: None }
    }
}

impl<S: Scalar> Alignment<S> {
    pub fn new(p: &Params, imu_rate_hz: f32) -> Self {
        Self {
            leveller: Leveller {
                samples: (p.levelling_time * imu_rate_hz) as u32,
                heading: S::from_f32(p.start_heading),
            },
            mahony: Mahony { kp: S::from_f32(p.mahony_kp), ki: S::from_f32(p.mahony_ki) },
        }
    }

    /// Takes an inertial sample at rest, until there are enough.
    pub fn level(&self, state: &mut AlignmentState<S>, imu: &Imu<S>) {
        state.attitude = self.leveller.step(&mut state.level, imu);
    }

    /// One filter step. On the ground the gyro bias stays as it was levelled; what slides there shows no vertical.
    pub fn step(&self, attitude: &mut MahonyState<S>, imu: &Imu<S>, stance: Stance, dt: S) {
        let (kp, ki) = match stance {
            Stance::Standing => (self.mahony.kp, S::zero()),
            Stance::Light => (S::zero(), S::zero()),
            Stance::Airborne => (self.mahony.kp, self.mahony.ki),
        };
        // A refused step keeps the attitude; the IMU's own checks raise the fault.
        let _ = Mahony { kp, ki }.step(attitude, &imu.gyro, &imu.accel, dt);
    }

    /// Turns about the vertical towards a measured heading: at once on the ground, slowly in the air.
    pub fn turn(&self, state: &mut AlignmentState<S>, heading: S, on_ground: bool) {
        let share = if on_ground { S::one() } else { S::lit(HEADING_SHARE) };
        if let Some(attitude) = &mut state.attitude {
            let (.., yaw) = attitude.attitude.euler();
            turn(attitude, wrap_pi(heading - yaw) * share);
        }
    }

    /// Turns a step's share of the way to what the compass says, on the ground; its noise is white.
    pub fn follow(attitude: &mut MahonyState<S>, deviation: S) {
        turn(attitude, deviation * S::lit(COMPASS_SHARE));
    }

    /// The attitude; level along the start heading until one is known.
    pub fn attitude(&self, state: &AlignmentState<S>) -> MahonyState<S> {
        let level = MahonyState::new(Attitude::level(self.leveller.heading), Body(V3::zeros()));
        state.attitude.unwrap_or(level)
    }
}

/// About the vertical, rad.
pub(super) fn turn<S: Scalar>(attitude: &mut MahonyState<S>, by: S) {
    let (sin, cos) = by.sin_cos();
    let down = V3::new(S::zero(), S::zero(), S::one());
    attitude.attitude = Attitude(so3::axis_angle(&down, sin, cos) * attitude.attitude.0);
}
