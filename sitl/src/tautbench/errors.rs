//! How far off was an estimator in one flight?

use super::columns::{TIME, Table};
use super::estimates::{Estimate, Estimates, direction};
use crate::metrics::{Mean, Spread};
use crate::plant::V3;
use nalgebra::Quaternion;
use serde::{Deserialize, Serialize};

/// Off by more, for so long, an estimator is lost: m, or a share of the distance from the anchor; rad where it gives no
/// place; moments of the truth.
const LOST_DISTANCE: f64 = 2.0;
const LOST_SHARE: f64 = 0.25;
const LOST_ANGLE: f64 = 0.52;
const LOST_MOMENTS: usize = 20;
/// It has to answer at this share of the moments.
const ANSWERED: f64 = 0.5;
/// Nearer to the anchor's vertical, m, an azimuth says nothing.
const LEVEL_MIN: f64 = 1.0;

/// Root mean squares over the scored moments at which it answered; `None`: it never said.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Three coordinates together.
    pub position_rms_m: Option<f64>,
    /// Of the vehicle from the anchor.
    pub elevation_rms_rad: Option<f64>,
    /// The same.
    pub azimuth_rms_rad: Option<f64>,
    /// At the vehicle.
    pub tension_rms_n: Option<f64>,
    /// The whole angle, heading included.
    pub attitude_rms_rad: Option<f64>,
    /// Mean of error²/σ² of a coordinate: 1 where it knows how sure it is.
    pub position_consistency: Option<f64>,
    /// The same.
    pub tension_consistency: Option<f64>,
    /// Share of the scored moments at which it said anything.
    pub answered: f64,
    /// Off for two seconds by over 2 m and a quarter of the distance (without a place: 30 degrees of elevation), or silent
    /// at half of the moments.
    pub lost: bool,
}

struct Moment {
    time: f64,
    position: V3,
    attitude: Quaternion<f64>,
    tension: f64,
}

/// The scored moments of a table of the truth.
fn moments(truth: &Table) -> Option<Vec<Moment>> {
    let at = |name: &str| truth.at(name);
    let [time, scored, tension] = [at(TIME)?, at("scored")?, at("tension_n")?];
    let place = [at("north_m")?, at("east_m")?, at("down_m")?];
    let turn = [at("q_w")?, at("q_x")?, at("q_y")?, at("q_z")?];
    let mut moments = Vec::new();
    for row in &truth.rows {
        let cell = |at: usize| row.get(at).copied().flatten();
        if cell(scored)? < 0.5 {
            continue;
        }
        let [x, y, z] = place.map(cell);
        let [w, i, j, k] = turn.map(cell);
        moments.push(Moment {
            time: cell(time)?,
            position: V3::new(x?, y?, z?),
            attitude: Quaternion::new(w?, i?, j?, k?),
            tension: cell(tension)?,
        });
    }
    Some(moments)
}

/// Between two attitudes, by the chord: an arc cosine loses small angles.
fn angle(a: &Quaternion<f64>, b: &Quaternion<f64>) -> f64 {
    let (a, b) = (a.normalize(), b.normalize());
    4.0 * (0.5 * (a - b).norm().min((a + b).norm())).min(1.0).asin()
}

fn wrapped(angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    sin.atan2(cos)
}

#[derive(Default)]
struct Sums {
    position: Spread,
    elevation: Spread,
    azimuth: Spread,
    tension: Spread,
    attitude: Spread,
    position_share: Mean,
    tension_share: Mean,
    answered: usize,
    off: usize,
    lost: bool,
}

impl Sums {
    fn add(&mut self, truth: &Moment, said: &Estimate) {
        self.answered += usize::from(said.says_anything());
        let (elevation, azimuth) = direction(&truth.position);
        let mut is_off = false;
        if let Some(said_elevation) = said.elevation {
            let off = said_elevation - elevation;
            self.elevation.add(off);
            is_off = off.abs() > LOST_ANGLE;
        }
        if let Some(said) = said.azimuth
            && truth.position.x.hypot(truth.position.y) >= LEVEL_MIN
        {
            self.azimuth.add(wrapped(said - azimuth));
        }
        if let Some(position) = said.position {
            let error = position - truth.position;
            self.position.add(error.norm());
            is_off = error.norm() > LOST_DISTANCE.max(LOST_SHARE * truth.position.norm());
            if let Some(sigma) = said.position_sigma {
                self.position_share.add(error.component_div(&sigma).norm_squared() / 3.0);
            }
        }
        if let Some(tension) = said.tension {
            let error = tension - truth.tension;
            self.tension.add(error);
            if let Some(sigma) = said.tension_sigma {
                self.tension_share.add((error / sigma).powi(2));
            }
        }
        if let Some(attitude) = said.attitude {
            self.attitude.add(angle(&attitude, &truth.attitude));
        }
        self.off = if is_off { self.off + 1 } else { 0 };
        self.lost |= self.off >= LOST_MOMENTS;
    }
}

/// Compares estimates with the truth of their flight.
///
/// # Errors
/// One line: no truth, or a flight without a scored moment.
pub fn compare(truth: &Table, estimates: &Estimates) -> Result<Errors, String> {
    let moments = moments(truth).ok_or("is no table of the truth")?;
    if moments.is_empty() {
        return Err("no moment of this flight is scored".into());
    }
    let mut sums = Sums::default();
    for moment in &moments {
        if let Some(said) = estimates.at(moment.time) {
            sums.add(moment, said);
        }
    }
    let answered = sums.answered as f64 / moments.len() as f64;
    Ok(Errors {
        position_rms_m: sums.position.rms(),
        elevation_rms_rad: sums.elevation.rms(),
        azimuth_rms_rad: sums.azimuth.rms(),
        tension_rms_n: sums.tension.rms(),
        attitude_rms_rad: sums.attitude.rms(),
        position_consistency: sums.position_share.get(),
        tension_consistency: sums.tension_share.get(),
        answered,
        lost: sums.lost || answered < ANSWERED,
    })
}
