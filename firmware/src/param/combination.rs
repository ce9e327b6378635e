//! Which parameters do not go together? Each within its range, and yet nothing flies on them.

use super::Params;
use crate::math::GRAVITY;
use crate::model::{TetherKind, thrust_max};

/// One rule.
#[derive(Clone, Copy, Debug)]
pub struct Combination {
    /// What the operator reads when it is broken; at most 50 bytes.
    pub text: &'static str,
    /// Whether it holds.
    pub holds: fn(&Params) -> bool,
}

fn weight(p: &Params) -> f32 {
    p.mass * GRAVITY as f32
}

fn kind(p: &Params) -> TetherKind {
    TetherKind::from_parameter(p.tether_kind)
}

/// The vehicle itself pulls the line taut, within its limits.
fn pulls(p: &Params) -> bool {
    !kind(p).is_free() && !kind(p).has_winch()
}

/// Within this factor of the default.
fn is_near(value: f32, default: f32, factor: f32) -> bool {
    value >= default / factor && value <= default * factor
}

/// Off, or at least so much.
fn off_or(value: f32, least: f32) -> bool {
    value <= 0.0 || value >= least
}

const fn rule(text: &'static str, holds: fn(&Params) -> bool) -> Combination {
    Combination { text, holds }
}

/// All rules. A loop must be slower than the one inside it and damped; thrust and tilt must carry weight and tension.
pub const COMBINATIONS: &[Combination] = &[
    rule("TPC_THR_MIN above 40 % of the weight", |p| p.thrust_min < 0.4 * weight(p)),
    rule("TPC_THR_MAX below weight and tension", |p| {
        let tension = if kind(p).is_free() { 0.0 } else { p.tension_low };
        p.thrust_max > 1.1 * (weight(p) + tension)
    }),
    rule("TPC_THR_MAX above what the motors give", |p| p.thrust_max < 1.05 * thrust_max(p)),
    rule("TPC_TEN_MIN not below TET_TENSION", |p| !pulls(p) || p.tension_min < p.tension),
    rule("TPC_TEN_MAX not above TET_TENSION", |p| !pulls(p) || p.tension_max > p.tension),
    rule("TPC_TILT_MAX too small for TET_TENSION", |p| {
        let tension = if kind(p).is_free() { 0.0 } else { p.tension };
        crate::math::trig::tan(p.tilt_max) > 0.5 * tension / weight(p) && p.tilt_max > 0.25
    }),
    rule("TPC_ACC_MAX too small", |p| p.accel_max >= 1.0),
    rule("TPC_P too large for TPC_D", |p| p.position_p <= p.position_d * p.position_d),
    rule("TPC_P too small", |p| p.position_p >= 0.3),
    rule("TPC_I too large for TPC_P and TPC_D", |p| {
        p.position_i <= 0.3 * p.position_p * p.position_d
    }),
    rule("TPC_RAD_P too large for TPC_RAD_D", |p| p.radial_p <= p.radial_d * p.radial_d),
    rule("TPC_RAD_P or TPC_RAD_D too small", |p| p.radial_p >= 0.3 && p.radial_d >= 0.8),
    rule("TPC_D or TPC_RAD_D too fast for ATC_TILT_P", |p| {
        p.position_d.max(p.radial_d) <= 0.6 * p.attitude_p
    }),
    rule("ATC_TILT_P too fast for RATE_P", |p| p.attitude_p <= 0.6 * p.rate_p),
    rule("ATC_TILT_P too small", |p| p.attitude_p >= 3.0),
    rule("ATC_RATE_MAX too small", |p| p.tilt_rate_max >= 1.0),
    rule("RATE_P too fast for MOT_TAU", |p| p.rate_p * p.motor_tau <= 2.5),
    rule("RATE_I too large for RATE_P", |p| p.rate_i <= 0.3 * p.rate_p * p.rate_p),
    rule("RATE_I or RATE_I_MAX too small", |p| p.rate_i >= 3.0 && p.rate_i_max >= 3.0),
    rule("RATE_D too large", |p| p.rate_d <= 1.0),
    rule("ATT_W_ACC out of what flies", |p| is_near(p.mahony_kp, 0.2, 5.0)),
    rule("ATT_W_GYRO_BIAS too large for ATT_W_ACC", |p| {
        p.mahony_ki <= 0.5 * p.mahony_kp * p.mahony_kp
    }),
    rule("EKF4 parameters too far from what flies", |p| {
        is_near(p.ekf_q_position, 0.004, 30.0)
            && is_near(p.ekf_q_tension, 0.004, 30.0)
            && is_near(p.ekf_r_accel, 0.01, 30.0)
            && is_near(p.ekf_r_altitude, 0.1, 30.0)
            && is_near(p.ekf_r_length, 0.01, 30.0)
    }),
    rule("VEL_K_POS too small", |p| p.velocity_gain >= 0.5),
    rule("EST_ACC_SD or EST_ALT_SD out of what flies", |p| {
        is_near(p.full_accel_sd, 0.5, 4.0) && is_near(p.full_altimeter_sd, 0.08, 6.0)
    }),
    rule("EST_VEL_NOISE out of what flies", |p| is_near(p.full_velocity_noise, 0.02, 10.0)),
    rule("EST_CUTOFF too low", |p| off_or(p.full_cutoff, 8.0)),
    rule("IMU_GYRO_CUTOFF too low for RATE_P", |p| off_or(p.gyro_cutoff, 2.0 * p.rate_p)),
    rule("IMU_ACCEL_CUTOFF too low", |p| off_or(p.accel_cutoff, 15.0)),
];

/// The first rule that is broken.
#[must_use]
pub fn broken(p: &Params) -> Option<&'static Combination> {
    COMBINATIONS.iter().find(|rule| !(rule.holds)(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_keep_every_rule_and_every_rule_can_be_broken() {
        assert!(broken(&Params::default()).is_none());
        for rule in COMBINATIONS {
            assert!(rule.text.len() <= 50, "{}", rule.text);
            let breaks = |index: usize, value: f32| {
                [0.0, 1.0].into_iter().any(|kind| {
                    let mut p = Params { tether_kind: kind, ..Params::default() };
                    p.set(index, value).is_ok() && !(rule.holds)(&p)
                })
            };
            let extremes = crate::param::META.iter().enumerate();
            let mut tries = extremes.flat_map(|(i, meta)| [(i, meta.min), (i, meta.max), (i, 5.0)]);
            assert!(tries.any(|(i, value)| breaks(i, value)), "{}", rule.text);
        }
    }
}
