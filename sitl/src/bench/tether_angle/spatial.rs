//! Two planar filters and controllers hold a direction in space. `inertial` section 8: a point mass on
//! a sphere with slack, body rates through (20) on each axis.

use super::plant::RATE_LOOP;
use super::run::{CONTROL_EVERY, FILTER_EVERY, RATE};
use super::scenario::AngleScenario;
use crate::metrics::Spread;
use crate::plant::{GRAVITY, V3, generator, normal, runge_kutta};
use nalgebra::{Matrix3, Rotation3};
use tautline_firmware::estimate::tether_angle::{
    TetherAngleState, TetherAngles, TetherAnglesState,
};
use tautline_firmware::model::TetherAngle;

/// Figures count from here on, s.
const SETTLED: f64 = 5.0;
/// Pull of the heading, 1/s.
const YAW_GAIN: f64 = 1.0;

/// One filter sample, both planes, rad.
#[derive(Clone, Copy, Debug)]
pub struct SpatialRow {
    /// s.
    pub time: f64,
    /// True tether angles.
    pub truth: [f64; 2],
    /// Estimated.
    pub estimate: [f64; 2],
}

/// A run.
#[derive(Clone, Debug)]
pub struct SpatialTrace {
    /// At the filter's rate.
    pub rows: Vec<SpatialRow>,
    /// Estimated minus true tether angle, RMS, rad.
    pub estimate: [f64; 2],
    /// Its mean, rad.
    pub bias: [f64; 2],
    /// True angle minus reference, RMS, rad.
    pub tracking: [f64; 2],
    /// s flown.
    pub survived: f64,
    /// The vehicle ended on the ground, or the estimate was lost for good.
    pub is_lost: bool,
}

impl SpatialTrace {
    /// The worse plane's figure.
    #[must_use]
    pub fn worse(figure: [f64; 2]) -> f64 {
        figure[0].max(figure[1])
    }
}

struct Body {
    position: V3,
    velocity: V3,
    /// Body to world; x forward, y left, z up.
    attitude: Rotation3<f64>,
    /// Body rate and the loop's angular acceleration.
    rate: [[f64; 2]; 3],
    force: V3,
    is_taut: bool,
}

fn direction(angles: [f64; 2]) -> V3 {
    V3::new(angles[0].tan(), angles[1].tan(), 1.0).normalize()
}

impl Body {
    /// At rest: thrust balances weight and a pull along the tether.
    fn at_rest(s: &AngleScenario, angles: [f64; 2]) -> Self {
        let e = direction(angles);
        let (thrust, cos) = (s.thrust_true, e.z);
        let root = (GRAVITY * cos).powi(2) + thrust * thrust - GRAVITY * GRAVITY;
        let tension = root.max(0.0).sqrt() - GRAVITY * cos;
        let axis = (V3::new(0.0, 0.0, GRAVITY) + e * tension).normalize();
        // Heading zero: body x in the plane of world x and the thrust axis.
        let attitude = {
            let y = axis.cross(&V3::x()).normalize();
            let x = y.cross(&axis);
            Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, axis]))
        };
        Self {
            position: e * s.length,
            velocity: V3::zeros(),
            force: attitude.inverse() * V3::new(0.0, 0.0, GRAVITY),
            attitude,
            rate: [[0.0; 2]; 3],
            is_taut: true,
        }
    }

    fn step(&mut self, s: &AngleScenario, thrust: f64, rate_command: &V3, anchor: &V3, dt: f64) {
        let [wn, zeta] = RATE_LOOP;
        for (axis, &u) in self.rate.iter_mut().zip(rate_command.iter()) {
            *axis = runge_kutta(*axis, dt, |[r, a]| [*a, wn * wn * (u - r) - 2.0 * zeta * wn * a]);
        }
        let omega = V3::new(self.rate[0][0], self.rate[1][0], self.rate[2][0]);
        self.attitude *= Rotation3::from_scaled_axis(omega * dt);
        let lift = self.attitude * V3::new(0.0, 0.0, thrust);
        let free = lift - V3::new(0.0, 0.0, GRAVITY) - anchor;
        let e = self.position.normalize();
        let tension =
            if self.is_taut { free.dot(&e) + self.velocity.norm_squared() / s.length } else { 0.0 };
        self.is_taut = self.is_taut && tension > 0.0;
        let pull = if self.is_taut { -e * tension } else { V3::zeros() };
        self.force = self.attitude.inverse() * (lift + pull);
        self.velocity += (free + pull) * dt;
        self.position += self.velocity * dt;
        let is_outward = self.velocity.dot(&self.position) > 0.0;
        if self.is_taut || (self.position.norm() >= s.length && is_outward) {
            self.is_taut = true;
            let e = self.position.normalize();
            self.position = e * s.length;
            self.velocity -= e * self.velocity.dot(&e);
        }
    }

    fn angles(&self) -> [f64; 2] {
        let p = &self.position;
        [p.x.atan2(p.z), p.y.atan2(p.z)]
    }
}

/// Flies it.
///
/// # Errors
/// One line naming the setting.
pub fn fly_spatial(s: &AngleScenario, seed: u64) -> Result<SpatialTrace, String> {
    s.check(2)?;
    let pair = |list: &[f64]| -> [f64; 2] {
        std::array::from_fn(|i| list.get(i).copied().unwrap_or(0.0).to_radians())
    };
    let (reference, start) = (pair(&s.reference), pair(&s.start));
    let angles = TetherAngles {
        ukf: s.ukf(FILTER_EVERY as f64 / RATE)?,
        model: s.nominal_model()?,
        projects: s.projects,
    };
    let control = s.control()?;
    let mut body = Body::at_rest(s, start);
    let tilt = body.attitude * V3::z();
    let prior = [tilt.x.atan2(tilt.z), tilt.y.atan2(tilt.z)];
    let mut state = TetherAnglesState::with_prior(prior);
    if s.start_known > 0.0 {
        let sd = s.start_known.to_radians();
        for ((plane, angle), tilt) in state.planes.iter_mut().zip(start).zip(prior) {
            let x = TetherAngle { angle, rate: 0.0, tilt };
            *plane = TetherAngleState::known(x, [sd, 0.1, sd / 2.0]);
        }
    }
    let mut rng = generator(seed, 31);
    let mut filtered = body.force;
    let gain = 1.0 - (-1.0 / (RATE * s.accel_tau)).exp();
    let (mut gyro_sum, mut gyro_count, mut rate_command) = (V3::zeros(), 0.0, V3::zeros());
    let mut spreads = [[Spread::default(); 2]; 2];
    let (mut bias, mut count) = ([0.0; 2], 0.0);
    let mut rows = Vec::new();
    let mut is_lost = false;
    let ticks = (s.duration * RATE) as u64;
    for tick in 0..ticks {
        let time = tick as f64 / RATE;
        let mut noise = |sd: f64| V3::from_fn(|_, _| sd * normal(&mut rng));
        filtered += (body.force + noise(s.accel_noise) - filtered) * gain;
        gyro_sum += V3::new(body.rate[0][0], body.rate[1][0], body.rate[2][0]);
        gyro_count += 1.0;
        // The heading is known: from the horizontal part of the body's left axis, as the frame has it.
        let left = body.attitude * V3::y();
        let heading = (-left.x).atan2(left.y);
        let truth = body.angles();
        if tick.is_multiple_of(FILTER_EVERY) {
            let gyro = gyro_sum / gyro_count + V3::repeat(s.gyro_bias) + noise(s.gyro_noise);
            (gyro_sum, gyro_count) = (V3::zeros(), 0.0);
            angles.step(&mut state, Some(&filtered), &gyro, heading);
            let estimate = state.angles();
            rows.push(SpatialRow { time, truth, estimate });
            if time >= SETTLED {
                count += 1.0;
                for i in 0..2 {
                    let off = estimate[i] - truth[i];
                    bias[i] += off;
                    spreads[0][i].add(off);
                    spreads[1][i].add(truth[i] - reference[i]);
                }
            }
        }
        if tick.is_multiple_of(CONTROL_EVERY) {
            let frame = state.frame(heading);
            let models = angles.planar_models(&state, &frame);
            let rates = std::array::from_fn(|i| {
                let plane = &state.planes[i];
                if plane.is_running() {
                    control.step(&models[i], reference[i], &plane.posterior.x).rate
                } else {
                    0.0
                }
            });
            rate_command = frame.body_rate(rates) + V3::new(0.0, 0.0, -YAW_GAIN * heading);
        }
        let anchor = V3::new(s.anchor.accel(time), s.anchor_y.accel(time), 0.0);
        body.step(s, s.thrust_at(time), &rate_command, &anchor, 1.0 / RATE);
        if body.position.z < 0.0 || !body.position.z.is_finite() {
            is_lost = true;
            break;
        }
    }
    let rms = |s: &[Spread; 2]| s.map(|s| s.rms().unwrap_or(f64::NAN));
    Ok(SpatialTrace {
        estimate: rms(&spreads[0]),
        tracking: rms(&spreads[1]),
        bias: bias.map(|sum| sum / count),
        survived: rows.last().map_or(0.0, |row| row.time),
        is_lost,
        rows,
    })
}
