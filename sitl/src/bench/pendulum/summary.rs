//! Figures of a run.

use super::run::PendulumRow;
use nalgebra::Vector3;

/// Figures; "settled" counts from the scenario's settling time on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PendulumSummary {
    /// Fell over, flew away or was not finite; the time, s.
    pub lost_at: Option<f64>,
    /// Settled |z_p|: mean, m.
    pub error_mean: f64,
    /// Its largest, m.
    pub error_max: f64,
    /// At the end, m.
    pub error_end: f64,
    /// Settled thrust, N.
    pub thrust: [f64; 2],
    /// Largest thrust of the run, N.
    pub thrust_peak: f64,
    /// Settled body-rate command: mean, rad/s.
    pub rate_mean: f64,
    /// Its largest, rad/s.
    pub rate_max: f64,
    /// Largest of the run, rad/s.
    pub rate_peak: f64,
    /// Largest tilt of the rod of the whole run, rad.
    pub tilt_peak: f64,
    /// Settled error of the rod's rate, RMS, rad/s.
    pub rod_rate_rms: f64,
    /// Settled error of the horizontal disturbance, RMS, N.
    pub across_rms: f64,
    /// Settled error of the vertical disturbance, RMS, N.
    pub vertical_rms: f64,
    /// |z_p| stays below 10 cm from here on, s.
    pub within_10_cm_from: f64,
}

impl PendulumSummary {
    /// Of all rows.
    #[must_use]
    pub fn of(rows: &[PendulumRow], settled: f64, lost_at: Option<f64>) -> Self {
        let late: Vec<&PendulumRow> = rows.iter().filter(|row| row.time >= settled).collect();
        let count = late.len().max(1) as f64;
        let mean = |pick: &dyn Fn(&PendulumRow) -> f64| {
            late.iter().map(|row| pick(row)).sum::<f64>() / count
        };
        let most = |rows: &mut dyn Iterator<Item = f64>| rows.fold(0.0, f64::max);
        let error = |row: &PendulumRow| row.error().norm();
        let off = |row: &PendulumRow| row.estimated_disturbance - row.disturbance;
        let rate_error = |row: &PendulumRow| row.estimated_rod_rate - row.truth.rod_rate;
        let square_sum = |v: Vector3<f64>, axes: &[usize]| -> f64 {
            axes.iter().map(|axis| v[*axis] * v[*axis]).sum()
        };
        let thrusts = late.iter().map(|row| row.thrust);
        let far = rows.iter().rposition(|row| error(row) > 0.1).map_or(0, |last| last + 1);
        Self {
            lost_at,
            error_mean: mean(&error),
            error_max: most(&mut late.iter().map(|row| error(row))),
            error_end: rows.last().map_or(f64::INFINITY, error),
            thrust: [
                thrusts.clone().fold(f64::INFINITY, f64::min),
                thrusts.fold(f64::NEG_INFINITY, f64::max),
            ],
            thrust_peak: most(&mut rows.iter().map(|row| row.thrust)),
            rate_mean: mean(&|row| row.rate.norm()),
            rate_max: most(&mut late.iter().map(|row| row.rate.norm())),
            rate_peak: most(&mut rows.iter().map(|row| row.rate.norm())),
            tilt_peak: most(&mut rows.iter().map(|row| row.truth.rod_tilt())),
            rod_rate_rms: mean(&|row| square_sum(rate_error(row), &[0, 1, 2])).sqrt(),
            across_rms: mean(&|row| square_sum(off(row), &[0, 1])).sqrt(),
            vertical_rms: mean(&|row| square_sum(off(row), &[2])).sqrt(),
            within_10_cm_from: rows.get(far).map_or(f64::INFINITY, |row| row.time),
        }
    }

    /// Whether it did not survive.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost_at.is_some()
    }
}
