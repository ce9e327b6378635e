//! One flight as the data set has it: what an estimator may read, and the truth, in tables of their own.

use super::columns::{TIME, Table};
use super::grid::Cell;
use crate::experiment::why_lost;
use crate::flight::{Flight, Gathered, Readings, quaternion};
use crate::plant::Plant;

/// Steps of 1 ms from one row of readings, and of truth, to the next.
const READ_EVERY: u64 = 10;
pub const TRUTH_EVERY: u64 = 100;
/// No mission takes longer, s.
const LONGEST: f64 = 900.0;
/// Scored is what is flown at least so high, m, from so long after it was first reached, s.
const CLEAR: f64 = 1.0;
const SETTLING: f64 = 5.0;

/// Columns of the readings after the time, and the step that each is rounded to: below what the parts' noise leaves.
const READINGS: [(&str, f64); 25] = [
    ("accel_x_mps2", 0.002),
    ("accel_y_mps2", 0.002),
    ("accel_z_mps2", 0.002),
    ("gyro_x_radps", 0.0002),
    ("gyro_y_radps", 0.0002),
    ("gyro_z_radps", 0.0002),
    ("altitude_m", 0.001),
    ("line_length_m", 0.001),
    ("thrust_n", 0.01),
    ("velocity_x_mps", 0.001),
    ("velocity_y_mps", 0.001),
    ("velocity_z_mps", 0.001),
    ("line_direction_x", 0.0001),
    ("line_direction_y", 0.0001),
    ("line_direction_z", 0.0001),
    ("line_tension_n", 0.001),
    ("station_tension_n", 0.001),
    ("station_direction_north", 0.0001),
    ("station_direction_east", 0.0001),
    ("station_direction_down", 0.0001),
    ("magnetic_x_ut", 0.01),
    ("magnetic_y_ut", 0.01),
    ("magnetic_z_ut", 0.01),
    ("winch_tension_n", 0.01),
    ("battery_v", 0.001),
];

const TRUTH: [&str; 17] = [
    TIME,
    "north_m",
    "east_m",
    "down_m",
    "north_mps",
    "east_mps",
    "down_mps",
    "q_w",
    "q_x",
    "q_y",
    "q_z",
    "tension_n",
    "station_tension_n",
    "wind_north_mps",
    "wind_east_mps",
    "wind_down_mps",
    "scored",
];

/// A flight that was flown.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What an estimator may read.
    pub readings: Table,
    /// What is so.
    pub truth: Table,
    /// The log, with what went into each step.
    pub log: Vec<u8>,
    /// Why it was lost or its mission not flown, if so.
    pub why: Option<String>,
}

/// Flies a cell with a seed.
///
/// # Errors
/// One line: a driver's set-up.
pub fn record(cell: &Cell, seed: u64) -> Result<Recorded, String> {
    let params = cell.scenario.params().map_err(|e| e.0)?;
    let mut flight = Flight::new(&cell.scenario, params, seed, Vec::new()).map_err(|e| e.0)?;
    let mut readings = Table::new([TIME].into_iter().chain(READINGS.map(|(name, _)| name)));
    let mut truth = Table::new(TRUTH);
    let (mut gathered, mut clear) = (Gathered::default(), None);
    for step in 1_u64.. {
        let out = flight.step(&mut |_| {});
        gathered.take(out);
        if step.is_multiple_of(READ_EVERY) {
            readings.rows.push(row(time_s(step), &gathered.read(out)));
        }
        if step.is_multiple_of(TRUTH_EVERY) {
            let (time, plant) = (time_s(step), &flight.world.environment.plant);
            let is_clear = plant.height_over_ground() >= CLEAR && !plant.ground.is_touching();
            if is_clear {
                clear.get_or_insert(time);
            }
            let is_scored = is_clear && clear.is_some_and(|since| time >= since + SETTLING);
            truth.rows.push(true_row(time, plant, is_scored));
            if flight.is_over() || time >= LONGEST {
                break;
            }
        }
    }
    let why = why_lost(&flight);
    let log = flight.finish_log().map_err(|e| e.to_string())?.unwrap_or_default();
    Ok(Recorded { readings, truth, log, why })
}

/// Whether anything of a table of the truth counts.
pub fn has_scored(truth: &Table) -> bool {
    truth.rows.iter().any(|row| row.last().copied().flatten().is_some_and(|scored| scored > 0.5))
}

/// Of a step, counted from 1, s.
pub fn time_s(step: u64) -> f64 {
    step as f64 / 1000.0
}

fn row(time: f64, read: &Readings) -> Vec<Option<f64>> {
    let three = |v: Option<[f64; 3]>| match v {
        Some(v) => v.map(Some),
        None => [None; 3],
    };
    let cells = [
        &three(read.accel)[..],
        &three(read.gyro),
        &[read.altitude, read.length, Some(read.thrust)],
        &three(read.velocity),
        &three(read.line_direction),
        &[read.line_tension, read.station_tension],
        &three(read.station_direction),
        &three(read.magnetic),
        &[Some(read.winch_tension), read.battery_voltage],
    ];
    let steps = READINGS.iter().map(|(_, step)| step);
    let rounded =
        cells.concat().into_iter().zip(steps).map(|(x, step)| Some((x? / step).round() * step));
    std::iter::once(Some(time)).chain(rounded).collect()
}

/// A row of the readings back: its time, s, and what was read; `None` for a row of another table.
#[must_use]
pub fn reading(row: &[Option<f64>]) -> Option<(f64, Readings)> {
    let mut cells = row.iter().copied();
    let time = cells.next()??;
    let mut next = || cells.next().flatten();
    let three = |next: &mut dyn FnMut() -> Option<f64>| {
        let v = [next(), next(), next()];
        let [Some(x), Some(y), Some(z)] = v else { return None };
        Some([x, y, z])
    };
    let read = Readings {
        accel: three(&mut next),
        gyro: three(&mut next),
        altitude: next(),
        length: next(),
        thrust: next()?,
        velocity: three(&mut next),
        line_direction: three(&mut next),
        line_tension: next(),
        station_tension: next(),
        station_direction: three(&mut next),
        magnetic: three(&mut next),
        winch_tension: next()?,
        battery_voltage: next(),
    };
    Some((time, read))
}

fn true_row(time: f64, plant: &Plant, is_scored: bool) -> Vec<Option<f64>> {
    let (place, body, tether) = (plant.from_anchor(), &plant.body, &plant.tether);
    let cells = [
        &[time][..],
        place.as_slice(),
        body.velocity.as_slice(),
        &quaternion(&body.attitude),
        &[tether.tension(), tether.station_tension()],
        plant.wind.velocity.as_slice(),
        &[f64::from(u8::from(is_scored))],
    ];
    cells.concat().into_iter().map(Some).collect()
}
