//! A law of the plane, flown in three dimensions: thrust, pitch rate with its acceleration, and the
//! out-of-plane and heading loops beside. `flight` sections 2 and 3.

use super::{ElevationAttitude, ElevationForce, Inversion, Law, ThrustLimits, ThrustState};
use crate::control::AttitudeCommand;
use crate::estimate::taut::TautEstimate;
use crate::fault::{Fault, Invalid, all_finite};
use crate::frames::{Body, V3};
use crate::model::{PlanarModel, thrust_max};
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{PlanarReference, TautPurpose};
use crate::time::OUTER_DT;

/// Largest pitch acceleration, rad/s², and pitch rate, rad/s, asked.
const PITCH_ACCEL_MAX: f64 = 60.0;
const PITCH_RATE_MAX: f64 = 3.0;
/// Largest thrust rate, N/s, and acceleration, N/s², in units of the highest thrust.
const THRUST_RATE_MAX: f64 = 4.0;
const THRUST_ACCEL_MAX: f64 = 40.0;
/// The observer settles before the loop closes, s.
const HOLD_OFF: f64 = 0.4;
/// Roll error to roll rate, 1/s; largest roll, rad; damping of the out-of-plane loop; heading gain, 1/s.
const ROLL_GAIN: f64 = 1.0 / 0.14;
const ROLL_MAX: f64 = 0.35;
const OUT_OF_PLANE_DAMPING: f64 = 0.9;
const HEADING_GAIN: f64 = 1.5;
/// Windows of the damped inversions: N, and 1/(kg m).
const FORCE_INVERSION: (f64, f64) = (0.5, 0.2);
const ATTITUDE_INVERSION: (f64, f64) = (0.05, 0.05);

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TautController<S> {
    law: Law<S>,
    limits: ThrustLimits<S>,
    model: PlanarModel<S>,
    /// Rotor lag that the thrust is sent ahead of, s.
    lead: S,
    out_of_plane: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TautControllerState<S> {
    thrust: ThrustState<S>,
    /// θ' wanted, rad/s.
    pitch_rate: S,
    /// Heading since the start, rad.
    heading: S,
    time: S,
}

impl<S: Scalar> TautController<S> {
    /// From the parameters.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting; the parameters' ranges exclude it.
    pub fn try_new(
        p: &Params,
        model: PlanarModel<S>,
        purpose: TautPurpose,
    ) -> Result<Self, Invalid> {
        let window = |(threshold, damping): (f64, f64)| Inversion::Window {
            threshold: S::lit(threshold),
            damping: S::lit(damping),
        };
        let scaled = |bandwidth: f32, pole: f64| S::lit(-f64::from(bandwidth) * pole);
        let law = match purpose {
            TautPurpose::Force => {
                let pole = |x| scaled(p.taut_force_bandwidth, x);
                let poles = [1.0, 1.5, 2.0, 2.5].map(pole);
                let force = [1.0, 1.5].map(pole);
                let window = window(FORCE_INVERSION);
                Law::Force(ElevationForce::try_new(model, &poles, &force, window)?)
            }
            TautPurpose::Attitude => {
                let pole = |x| scaled(p.taut_attitude_bandwidth, x);
                let poles = [0.75, 1.1, 1.5].map(pole);
                let pitch = [1.0, 1.5].map(pole);
                let window = window(ATTITUDE_INVERSION);
                Law::Attitude(ElevationAttitude::try_new(model, &poles, &pitch, window)?)
            }
        };
        let max = S::from_f32(thrust_max(p) * p.taut_thrust_share);
        let limits = ThrustLimits {
            min: S::from_f32(p.taut_thrust_min),
            max,
            rate: max * S::lit(THRUST_RATE_MAX),
            accel: max * S::lit(THRUST_ACCEL_MAX),
            torque: model.inertia() * S::lit(PITCH_ACCEL_MAX),
        };
        limits.check()?;
        Ok(Self {
            law,
            limits,
            model,
            lead: S::from_f32(p.motor_tau),
            out_of_plane: S::from_f32(p.taut_out_of_plane_bandwidth),
        })
    }

    /// Lowest and highest thrust, N.
    #[must_use]
    pub fn thrust_range(&self) -> (S, S) {
        (self.limits.min, self.limits.max)
    }

    /// Starts with the thrust that acts now.
    #[must_use]
    pub fn start(&self, now: &TautEstimate<S>) -> TautControllerState<S> {
        TautControllerState {
            thrust: ThrustState {
                thrust: now.thrust.limit(self.limits.min, self.limits.max),
                rate: S::zero(),
            },
            pitch_rate: S::zero(),
            heading: S::zero(),
            time: S::zero(),
        }
    }

    /// One 250 Hz step. `rate`: body rate now, rad/s.
    ///
    /// # Errors
    /// [`Fault::NotFinite`], [`Fault::Degenerate`]; the state is untouched.
    pub fn step(
        &self,
        state: &mut TautControllerState<S>,
        now: &TautEstimate<S>,
        rate: &Body<V3<S>>,
        reference: &PlanarReference<S>,
    ) -> Result<AttitudeCommand<S>, Fault> {
        let dt = S::lit(OUTER_DT);
        let mut next = *state;
        next.time += dt;
        let is_held = state.time < S::lit(HOLD_OFF);
        let (thrust, accel) = if is_held {
            (next.thrust.thrust, S::zero())
        } else {
            let (applied, torque) = self.law.advance(
                &mut next.thrust,
                &now.planar,
                reference,
                dt,
                Some(&self.limits),
            )?;
            (applied.thrust, torque / self.model.inertia)
        };
        next.pitch_rate = (next.pitch_rate + accel * dt).limit_abs(S::lit(PITCH_RATE_MAX));
        let ahead = if is_held { S::zero() } else { next.thrust.rate * self.lead };

        let (sin, cos) = now.planar.pitch.sin_cos();
        let turn = rate.0.z / cos.max(S::lit(0.2));
        next.heading += turn * dt;
        let (roll_rate, cos_roll) = self.out_of_plane(now, turn * sin);
        all_finite(&[next.pitch_rate, next.heading, roll_rate, cos_roll])?;
        *state = next;
        // The pitch of the plane is positive nose down.
        let zero = S::zero();
        Ok(AttitudeCommand {
            rate: Body(V3::new(roll_rate, -next.pitch_rate, -next.heading * S::lit(HEADING_GAIN))),
            accel: Body(V3::new(zero, -accel, zero)),
            thrust: (thrust + ahead).limit(self.limits.min, self.limits.max) / cos_roll,
        })
    }

    /// Roll rate that brings the vehicle back over its heading, rad/s, and the cosine of the roll.
    fn out_of_plane(&self, now: &TautEstimate<S>, turn: S) -> (S, S) {
        let Some(out_of_plane) = &now.out_of_plane else {
            return (S::zero(), S::one());
        };
        let (a, b, w) = (out_of_plane.azimuth(), out_of_plane.azimuth_rate(), self.out_of_plane);
        let reach = self.model.length * now.planar.elevation.sin_cos().1;
        let lever = reach * self.model.mass / now.thrust.max(self.limits.min);
        let pull = -w * w * a - S::lit(2.0 * OUT_OF_PLANE_DAMPING) * w * b;
        let wanted = now.planar.pitch.sin_cos().0 * a + lever * pull;
        let roll = out_of_plane.roll();
        let error = wanted.limit_abs(S::lit(ROLL_MAX)) - roll;
        let rate = error * S::lit(ROLL_GAIN) + turn + out_of_plane.roll_bias();
        (rate, roll.sin_cos().1.max(S::lit(0.5)))
    }
}
