//! What an estimator says of one flight: a table, checked whole before anything of it is scored.

use super::columns::{TIME, Table};
use crate::plant::V3;
use nalgebra::Quaternion;

const PLACE: [&str; 3] = ["north_m", "east_m", "down_m"];
const PLACE_SIGMA: [&str; 3] = ["north_sigma_m", "east_sigma_m", "down_sigma_m"];
const ATTITUDE: [&str; 4] = ["q_w", "q_x", "q_y", "q_z"];
const ELEVATION: &str = "elevation_rad";
const AZIMUTH: &str = "azimuth_rad";
const LENGTH: &str = "length_m";
const TENSION: &str = "tension_n";
const TENSION_SIGMA: &str = "tension_sigma_n";
/// An estimate counts for so long, s.
const VALID: f64 = 0.1;
/// Of times and of a quaternion's length.
const TOLERANCE: f64 = 1e-3;

/// Every column that an estimator may give.
#[must_use]
pub fn columns() -> Vec<&'static str> {
    let place = [&[TIME][..], &PLACE, &PLACE_SIGMA, &[ELEVATION, AZIMUTH, LENGTH]].concat();
    [place, vec![TENSION, TENSION_SIGMA], ATTITUDE.to_vec()].concat()
}

/// At one moment; `None`: it does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// From the anchor, NED, m.
    pub position: Option<V3>,
    /// One standard deviation of each coordinate, m.
    pub position_sigma: Option<V3>,
    /// Of the vehicle from the anchor, rad.
    pub elevation: Option<f64>,
    /// From North, rad.
    pub azimuth: Option<f64>,
    /// At the vehicle, N.
    pub tension: Option<f64>,
    /// N.
    pub tension_sigma: Option<f64>,
    /// Body to world.
    pub attitude: Option<Quaternion<f64>>,
}

/// Elevation and azimuth of a place, rad.
#[must_use]
pub fn direction(place: &V3) -> (f64, f64) {
    ((-place.z).atan2(place.x.hypot(place.y)), place.y.atan2(place.x))
}

impl Estimate {
    /// As a row of [`columns`].
    #[must_use]
    pub fn row(&self, time: f64) -> Vec<Option<f64>> {
        let three = |v: Option<V3>| -> [Option<f64>; 3] {
            v.map_or([None; 3], |v| <[f64; 3]>::from(v).map(Some))
        };
        let attitude = self.attitude.map_or([None; 4], |q| [q.w, q.i, q.j, q.k].map(Some));
        let cells = [
            &[Some(time)][..],
            &three(self.position),
            &three(self.position_sigma),
            &[self.elevation, self.azimuth, None],
            &[self.tension, self.tension_sigma],
            &attitude,
        ];
        cells.concat()
    }

    /// What follows from what was given.
    fn completed(mut self, length: Option<f64>) -> Self {
        if let (None, Some(elevation), Some(azimuth), Some(length)) =
            (self.position, self.elevation, self.azimuth, length)
        {
            let level = length * elevation.cos();
            let (east, north) = azimuth.sin_cos();
            self.position = Some(V3::new(level * north, level * east, -length * elevation.sin()));
        }
        if let Some(position) = &self.position {
            let (elevation, azimuth) = direction(position);
            self.elevation.get_or_insert(elevation);
            self.azimuth.get_or_insert(azimuth);
        }
        self
    }

    /// Whether it says anything that is scored.
    #[must_use]
    pub fn says_anything(&self) -> bool {
        self.elevation.is_some() || self.tension.is_some() || self.attitude.is_some()
    }
}

/// Of a whole flight, in the order of their times.
#[derive(Clone, Debug)]
pub struct Estimates(Vec<(f64, Estimate)>);

impl Estimates {
    /// Checks a table of a flight that lasts from zero to `end` s.
    ///
    /// # Errors
    /// One line naming column and time.
    pub fn check(table: &Table, end: f64) -> Result<Self, String> {
        let known = columns();
        if let Some(name) = table.names.iter().find(|name| !known.contains(&name.as_str())) {
            return Err(format!("{name}: no such column; there may be {}", known.join(", ")));
        }
        let time = table.at(TIME).ok_or(format!("no column {TIME}"))?;
        for group in [&PLACE[..], &PLACE_SIGMA, &ATTITUDE] {
            let missing = group.iter().find(|name| table.at(name).is_none());
            if let (Some(missing), true) =
                (missing, group.iter().any(|name| table.at(name).is_some()))
            {
                return Err(format!("no column {missing}: {} go together", group.join(", ")));
            }
        }
        if ![PLACE[0], ELEVATION, TENSION, ATTITUDE[0]].iter().any(|name| table.at(name).is_some())
        {
            return Err(format!("nothing to score; there may be {}", known.join(", ")));
        }
        for (sigma, of) in [(PLACE_SIGMA[0], PLACE[0]), (TENSION_SIGMA, TENSION)] {
            if table.at(sigma).is_some() && table.at(of).is_none() {
                return Err(format!("{sigma} without {of}"));
            }
        }
        let mut all = Vec::with_capacity(table.rows.len());
        let mut last = f64::NEG_INFINITY;
        for (number, row) in (1..).zip(&table.rows) {
            let now = row.get(time).copied().flatten();
            let now = now.ok_or_else(|| format!("row {number}: {TIME} is empty"))?;
            for (name, cell) in table.names.iter().zip(row) {
                let wrong = cell.and_then(|x| Some((x, complaint(name, x)?)));
                if let Some((x, why)) = wrong {
                    return Err(format!("row {number}: {name} = {x} {why}"));
                }
            }
            if !(-TOLERANCE..=end + TOLERANCE).contains(&now) {
                return Err(format!(
                    "row {number}: {TIME} = {now} is outside the flight, 0 to {end}"
                ));
            }
            if now <= last {
                return Err(format!("row {number}: {TIME} = {now} does not come after {last}"));
            }
            last = now;
            let estimate = read(table, row).map_err(|e| format!("row {number}: {e}"))?;
            all.push((now, estimate));
        }
        Ok(Self(all))
    }

    /// The newest that is not older than a tenth of a second.
    #[must_use]
    pub fn at(&self, time: f64) -> Option<&Estimate> {
        let after = self.0.partition_point(|(at, _)| *at <= time + TOLERANCE);
        let (at, estimate) = self.0.get(after.checked_sub(1)?)?;
        (time - at <= VALID + TOLERANCE).then_some(estimate)
    }
}

/// What is wrong with a number of this column.
fn complaint(name: &str, x: f64) -> Option<&'static str> {
    let beyond = match name {
        _ if !x.is_finite() => "is not finite; leave the cell empty where nothing is known",
        ELEVATION if x.abs() > std::f64::consts::FRAC_PI_2 + TOLERANCE => "is beyond straight up",
        LENGTH if x <= 0.0 => "is not above zero",
        _ if name.contains("sigma") && x <= 0.0 => "is not above zero",
        _ => return None,
    };
    Some(beyond)
}

fn read(table: &Table, row: &[Option<f64>]) -> Result<Estimate, String> {
    let cell = |name: &str| row.get(table.at(name)?).copied().flatten();
    let three = |names: [&str; 3]| match names.map(cell) {
        [Some(x), Some(y), Some(z)] => Ok(Some(V3::new(x, y, z))),
        [None, None, None] => Ok(None),
        _ => Err(format!("of {} some are empty and some are not", names.join(", "))),
    };
    let attitude = match ATTITUDE.map(cell) {
        [Some(w), Some(x), Some(y), Some(z)] => Some(Quaternion::new(w, x, y, z)),
        [None, None, None, None] => None,
        _ => return Err(format!("of {} some are empty and some are not", ATTITUDE.join(", "))),
    };
    if let Some(norm) = attitude.map(|q| q.norm()).filter(|norm| (norm - 1.0).abs() > TOLERANCE) {
        return Err(format!("{} have the length {norm}, not 1", ATTITUDE.join(", ")));
    }
    let estimate = Estimate {
        position: three(PLACE)?,
        position_sigma: three(PLACE_SIGMA)?,
        elevation: cell(ELEVATION),
        azimuth: cell(AZIMUTH),
        tension: cell(TENSION),
        tension_sigma: cell(TENSION_SIGMA),
        attitude,
    };
    Ok(estimate.completed(cell(LENGTH)))
}
