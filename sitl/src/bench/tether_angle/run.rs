//! Closed loop in a plane: plant, noisy inertial sensors, the core's filter and controller. `inertial`
//! section 7.

use super::plant::{Acting, Plane, PlaneModel};
use super::scenario::{AngleFeedback, AngleScenario};
use crate::metrics::Spread;
use crate::plant::{generator, normal};
use std::collections::BTreeMap;
use tautline_firmware::control::attachment_compensation;
use tautline_firmware::estimate::tether_angle::{TetherAngleState, UkfStage};
use tautline_firmware::model::{TetherAngle, TiltImu};

/// Plant rate, Hz; ticks per filter step and per control step.
pub const RATE: f64 = 800.0;
/// 80 Hz.
pub const FILTER_EVERY: u64 = 10;
/// 50 Hz.
pub const CONTROL_EVERY: u64 = 16;
/// Figures count from here on, s.
const SETTLED: f64 = 2.0;
/// A tether this far from straight up lies on the ground, rad.
const LOST: f64 = 1.9;

/// One filter sample.
#[derive(Clone, Copy, Debug)]
pub struct AngleRow {
    /// s.
    pub time: f64,
    /// Asked tether angle, rad.
    pub reference: f64,
    /// Truth.
    pub truth: TetherAngle<f64>,
    /// Estimate.
    pub estimate: TetherAngle<f64>,
    /// Its deviations.
    pub deviation: [f64; 3],
    /// What the filter did.
    pub mode: UkfStage,
    /// True tension over mass, m/s².
    pub tension: f64,
}

/// Figures, rad.
#[derive(Clone, Copy, Debug, Default)]
pub struct AngleSummary {
    /// Estimated minus true tether angle, RMS.
    pub angle: f64,
    /// Its mean.
    pub bias: f64,
    /// Estimated minus true tilt, RMS.
    pub tilt: f64,
    /// True angle minus reference, RMS.
    pub tracking: f64,
    /// Share of samples within three of the filter's own deviations.
    pub within_3_sigma: f64,
    /// s flown.
    pub survived: f64,
    /// The vehicle ended on the ground.
    pub is_lost: bool,
}

/// A run.
#[derive(Clone, Debug)]
pub struct AngleTrace {
    /// At the filter's rate.
    pub rows: Vec<AngleRow>,
    /// Figures.
    pub summary: AngleSummary,
    /// Samples per mode.
    pub modes: BTreeMap<String, u64>,
}

/// Flies it.
///
/// # Errors
/// One line naming the setting.
pub fn fly(s: &AngleScenario, seed: u64) -> Result<AngleTrace, String> {
    s.check(1)?;
    let nominal = s.nominal_model()?;
    let ukf = s.ukf(FILTER_EVERY as f64 / RATE)?;
    let control = s.control()?;
    let model = |time: f64| PlaneModel {
        length: s.length,
        thrust: s.thrust_at(time),
        attachment: s.attachment,
        mass_over_inertia: s.mass_over_inertia,
    };
    let start = s.start.first().copied().unwrap_or(0.0).to_radians();
    let mut plane = Plane::at_rest(&model(0.0), start);
    let prior = plane.attitude[0] + s.prior_error.to_radians();
    let mut filter = TetherAngleState::with_prior(prior);
    let mut rng = generator(seed, 30);
    let mut filtered = plane.accel(&model(0.0));
    let gain = 1.0 - (-1.0 / (RATE * s.accel_tau)).exp();
    let (mut gyro_sum, mut acting) = (0.0, Acting::default());
    let ticks = (s.reference.len() as f64 * s.step * RATE) as u64;
    let mut rows = Vec::with_capacity((ticks / FILTER_EVERY) as usize + 1);
    let mut trace = Collect::default();
    for tick in 0..ticks {
        let time = tick as f64 / RATE;
        let now = model(time);
        for (y, a) in filtered.iter_mut().zip(plane.accel(&now)) {
            *y += gain * (a + s.accel_noise * normal(&mut rng) - *y);
        }
        gyro_sum += plane.attitude[1];
        let [angle, rate] = plane.angle();
        let truth = TetherAngle { angle, rate, tilt: plane.attitude[0] };
        let reference = reference(s, time);
        if tick.is_multiple_of(FILTER_EVERY) {
            let count = if tick == 0 { 1.0 } else { FILTER_EVERY as f64 };
            let gyro = gyro_sum / count + s.gyro_bias + s.gyro_noise * normal(&mut rng);
            gyro_sum = 0.0;
            let [x, z] = filtered;
            ukf.step(&nominal, &mut filter, &TiltImu { x, z, rate: gyro });
            let c = &filter.posterior.covariance;
            let row = AngleRow {
                time,
                reference,
                truth,
                estimate: filter.posterior.x,
                deviation: [c.m11, c.m22, c.m33].map(f64::sqrt),
                mode: filter.mode,
                tension: plane.tension,
            };
            trace.add(&row);
            rows.push(row);
        }
        if tick.is_multiple_of(CONTROL_EVERY) {
            let x = match s.feedback {
                AngleFeedback::Estimate => filter.posterior.x,
                AngleFeedback::State => truth,
            };
            acting.rate = control.step(&nominal, reference, &x).rate;
        }
        if s.compensates {
            let [force_x, _] = filtered;
            acting.feed_forward =
                attachment_compensation(s.attachment, s.mass_over_inertia, force_x);
        }
        acting.anchor = [s.anchor.accel(time), 0.0];
        plane.step(&now, &acting, 1.0 / RATE);
        if plane.angle()[0].abs() > LOST || !plane.attitude[0].is_finite() {
            trace.is_lost = true;
            break;
        }
    }
    Ok(AngleTrace { summary: trace.summary(&rows), modes: trace.modes, rows })
}

fn reference(s: &AngleScenario, time: f64) -> f64 {
    let at = ((time / s.step) as usize).min(s.reference.len() - 1);
    s.reference.get(at).copied().unwrap_or(0.0).to_radians()
}

#[derive(Default)]
struct Collect {
    angle: Spread,
    tilt: Spread,
    tracking: Spread,
    sum: f64,
    inside: u64,
    count: u64,
    modes: BTreeMap<String, u64>,
    is_lost: bool,
}

impl Collect {
    fn add(&mut self, row: &AngleRow) {
        *self.modes.entry(format!("{:?}", row.mode)).or_default() += 1;
        if row.time < SETTLED {
            return;
        }
        let off = row.estimate.angle - row.truth.angle;
        self.angle.add(off);
        self.tilt.add(row.estimate.tilt - row.truth.tilt);
        self.tracking.add(row.truth.angle - row.reference);
        self.sum += off;
        self.count += 1;
        self.inside += u64::from(off.abs() <= 3.0 * row.deviation[0]);
    }

    fn summary(&self, rows: &[AngleRow]) -> AngleSummary {
        let rms = |s: &Spread| s.rms().unwrap_or(f64::NAN);
        AngleSummary {
            angle: rms(&self.angle),
            bias: self.sum / self.count as f64,
            tilt: rms(&self.tilt),
            tracking: rms(&self.tracking),
            within_3_sigma: self.inside as f64 / self.count as f64,
            survived: rows.last().map_or(0.0, |row| row.time),
            is_lost: self.is_lost,
        }
    }
}
