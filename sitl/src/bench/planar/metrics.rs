//! How well was it tracked? The article's metric with its pathologies guarded, and plain RMS and maxima.

use super::run::Row;
use super::scenario::PlanarScenario;
use crate::metrics::Spread;
use tautline_firmware::math::wrap_pi;

/// The article's error divides by the reference: at least this much, rad or N.
const REFERENCE_FLOOR: f64 = 0.05;
/// An estimate counts as converged below this, rad.
const CONVERGED: f64 = 0.01;

/// Mean and standard deviation of the article's error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Phase {
    sum: f64,
    square: f64,
    count: u64,
}

impl Phase {
    fn add(&mut self, e: f64) {
        self.sum += e;
        self.square += e * e;
        self.count += 1;
    }
    /// Mean.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
    /// Standard deviation.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        let mean = self.mean();
        (self.square / self.count.max(1) as f64 - mean * mean).max(0.0).sqrt()
    }
}

/// Figures of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanarSummary {
    /// Not finite or beyond any flight.
    pub has_diverged: bool,
    /// Root mean square of elevation and second error, rad, and rad or N.
    pub rms: [f64; 2],
    /// Largest after the first second.
    pub max_after_1s: [f64; 2],
    /// Largest in the last half second.
    pub max_last: [f64; 2],
    /// At the last sample.
    pub final_elevation: f64,
    /// Largest error of the estimated elevation after the first second, rad.
    pub estimate_max_after_1s: f64,
    /// When it stayed below 0.01 rad for good, s.
    pub converged_at: f64,
    /// Thrust, N.
    pub thrust: [f64; 2],
    /// Largest torque, N m.
    pub torque_max: f64,
    /// Link force, N.
    pub link_force: [f64; 2],
    /// The article's error: whole run, then its three phases.
    pub article: [Phase; 4],
}

impl PlanarSummary {
    /// Not finite, or off as `planar` section 10 counts it.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.has_diverged
            || !(self.rms[0] <= 0.6 && self.max_after_1s[0] <= 1.2 && self.final_elevation <= 0.8)
    }
}

/// Collects.
#[derive(Clone, Debug)]
pub struct Errors {
    first: Spread,
    second: Spread,
    summary: PlanarSummary,
    last_from: f64,
    step: [f64; 2],
}

impl Errors {
    /// For a scenario.
    #[must_use]
    pub fn new(s: &PlanarScenario) -> Self {
        let r = &s.reference;
        let extremes = [f64::INFINITY, f64::NEG_INFINITY];
        Self {
            first: Spread::default(),
            second: Spread::default(),
            summary: PlanarSummary {
                thrust: extremes,
                link_force: extremes,
                ..PlanarSummary::default()
            },
            last_from: s.end() - 0.5,
            step: [r.start, r.start + r.duration],
        }
    }

    /// One sample.
    pub fn add(&mut self, row: &Row, is_force: bool) {
        let e1 = row.elevation_error().abs();
        let e2 = if is_force {
            (row.second_reference - row.link_force).abs()
        } else {
            wrap_pi(row.second_reference - row.state[2]).abs()
        };
        self.first.add(e1);
        self.second.add(e2);
        let s = &mut self.summary;
        let off = wrap_pi(row.estimate[0] - row.state[0]).abs();
        // NaN must not hide in a maximum.
        let worse = |a: f64, b: f64| if b <= a { a } else { b };
        if row.time >= 1.0 {
            s.max_after_1s = [worse(s.max_after_1s[0], e1), worse(s.max_after_1s[1], e2)];
            s.estimate_max_after_1s = worse(s.estimate_max_after_1s, off);
        }
        if row.time >= self.last_from {
            s.max_last = [worse(s.max_last[0], e1), worse(s.max_last[1], e2)];
        }
        // The estimate reads false at a NaN: then it has not converged.
        let is_converged = off < CONVERGED;
        if !is_converged {
            s.converged_at = row.time;
        }
        s.final_elevation = e1;
        s.thrust = [s.thrust[0].min(row.thrust), s.thrust[1].max(row.thrust)];
        s.torque_max = s.torque_max.max(row.torque.abs());
        s.link_force = [s.link_force[0].min(row.link_force), s.link_force[1].max(row.link_force)];
        let relative = e1 / row.elevation_reference.abs().max(REFERENCE_FLOOR)
            + e2 / row.second_reference.abs().max(REFERENCE_FLOOR);
        let phase = usize::from(row.time >= self.step[0]) + usize::from(row.time >= self.step[1]);
        let [whole, phases @ ..] = &mut s.article;
        whole.add(relative);
        if let Some(phase) = phases.get_mut(phase) {
            phase.add(relative);
        }
    }

    /// The figures.
    #[must_use]
    pub fn summary(&self, has_diverged: bool) -> PlanarSummary {
        let rms = [&self.first, &self.second].map(|s| s.rms().unwrap_or(0.0));
        PlanarSummary { has_diverged, rms, ..self.summary }
    }
}
