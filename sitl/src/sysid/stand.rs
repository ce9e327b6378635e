//! The static curve from a thrust stand's table: one rotor, points or a slow ramp, units in the headers.
//!
//! A stand's table tells what a rotor gives at rest, and nothing of its lag.

use super::thrust_map::{Curve, PwmRange, ThrustFit, UNEXCITED, sag};
use std::path::Path;
use tautline_firmware::param::Params;

/// Fewer different throttles than this are no curve.
const LEVELS: usize = 4;
/// Throttles closer than this are one.
const LEVEL: f64 = 0.02;

/// Thrust units as stands write them, and one of them in N.
const UNITS: [(&str, f64); 8] = [
    ("n", 1.0),
    ("gf", 9.806_65e-3),
    ("g", 9.806_65e-3),
    ("kgf", 9.806_65),
    ("kg", 9.806_65),
    ("lbf", 4.448_222),
    ("lb", 4.448_222),
    ("ozf", 0.278_013_9),
];

/// A table of one rotor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stand {
    /// What the ESC was sent, in the table's unit.
    pub signal: Vec<f64>,
    /// That unit is per cent.
    pub is_percent: bool,
    /// N.
    pub thrust: Vec<f64>,
    /// V, where the table has it.
    pub voltage: Option<Vec<f64>>,
}

/// A header as stands write it: name and unit.
fn parts(header: &str) -> (String, String) {
    let header = header.trim_start_matches('\u{feff}').trim().to_lowercase();
    match header.split_once('(') {
        Some((name, unit)) => (name.trim().into(), unit.trim_end_matches(')').trim().into()),
        None => (header, String::new()),
    }
}

struct Columns {
    signal: usize,
    is_percent: bool,
    thrust: usize,
    newton: f64,
    voltage: Option<usize>,
}

fn columns(headers: &csv::StringRecord) -> Result<Columns, String> {
    let all: Vec<_> = headers.iter().map(parts).collect();
    let at = |names: &[&str]| {
        names.iter().find_map(|name| all.iter().position(|(known, _)| known.starts_with(name)))
    };
    let unit = |at: usize| all.get(at).map_or("", |(_, unit)| unit.as_str());
    let thrust = at(&["thrust"]).ok_or("line 1: no column of thrust")?;
    let newton = UNITS.iter().find(|(known, _)| *known == unit(thrust)).map(|(_, size)| *size);
    let signal = at(&["esc signal", "esc", "pwm", "throttle", "signal"]);
    let signal = signal.ok_or("line 1: no column of the ESC's signal, PWM or throttle")?;
    Ok(Columns {
        signal,
        is_percent: unit(signal) == "%",
        thrust,
        newton: newton.ok_or_else(|| {
            format!("line 1: thrust in {:?}: N, gf, kgf, lbf and ozf are known", unit(thrust))
        })?,
        voltage: at(&["voltage"]),
    })
}

/// Whether a table is a stand's: its thrust stands with a unit in parentheses.
///
/// # Errors
/// A file that cannot be read.
pub fn is_stand(path: &Path) -> Result<bool, String> {
    let text = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let head = String::from_utf8_lossy(text.split(|byte| *byte == b'\n').next().unwrap_or(&[]));
    Ok(head
        .split([',', ';', '\t'])
        .map(parts)
        .any(|(name, unit)| name.trim_matches('"').starts_with("thrust") && !unit.is_empty()))
}

/// Reads a stand's table: a column of thrust with its unit, one of the ESC's signal (µs) or throttle (%), perhaps one of
/// the voltage; others are passed over.
///
/// # Errors
/// One line naming file, line and column.
pub fn read_stand(path: &Path) -> Result<Stand, String> {
    let file = path.display().to_string();
    let text = std::fs::read(path).map_err(|e| format!("{file}: {e}"))?;
    parse_stand(&String::from_utf8_lossy(&text), &file)
}

/// The same from a text; `file` stands in the errors.
///
/// # Errors
/// One line naming file, line and column.
pub fn parse_stand(text: &str, file: &str) -> Result<Stand, String> {
    let first = text.lines().next().unwrap_or("");
    let often = |mark: &char| first.matches(*mark).count();
    let delimiter = [',', ';', '\t'].into_iter().max_by_key(often).unwrap_or(',');
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .delimiter(delimiter as u8)
        .flexible(true)
        .from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|e| format!("{file}: {e}"))?.clone();
    let columns = columns(&headers).map_err(|e| format!("{file}: {e}"))?;
    let mut stand = Stand {
        is_percent: columns.is_percent,
        voltage: columns.voltage.map(|_| Vec::new()),
        ..Stand::default()
    };
    for row in reader.records() {
        let row = row.map_err(|e| format!("{file}: {}", e.to_string().replace('\n', " ")))?;
        if row.iter().all(str::is_empty) {
            continue;
        }
        let line = row.position().map_or(0, csv::Position::line);
        let value = |column: usize| {
            let (name, text) = (headers.get(column).unwrap_or(""), row.get(column).unwrap_or(""));
            let text = if delimiter == ';' { text.replace(',', ".") } else { text.to_owned() };
            let value = text.parse::<f64>().ok().filter(|x| x.is_finite());
            value
                .ok_or_else(|| format!("{file}: line {line}, column {name}: {text:?} is no number"))
        };
        stand.signal.push(value(columns.signal)?);
        // Some stands show a pull as negative.
        stand.thrust.push(value(columns.thrust)?.abs() * columns.newton);
        if let (Some(voltage), Some(column)) = (&mut stand.voltage, columns.voltage) {
            voltage.push(value(column)?);
        }
    }
    Ok(stand)
}

impl Stand {
    /// Throttle 0 and 1, if nobody says.
    #[must_use]
    pub fn range(&self) -> PwmRange {
        if self.is_percent {
            return PwmRange { low: 0.0, high: 100.0 };
        }
        PwmRange::holding(self.signal.iter().copied().fold(0.0, f64::max))
    }
}

/// Fits the static curve of one rotor.
///
/// # Errors
/// A PWM range that the table leaves, or too few different throttles.
pub fn fit_stand(stand: &Stand, range: PwmRange, before: &Params) -> Result<ThrustFit, String> {
    let throttle = range.throttle(&stand.signal)?;
    let mut levels: Vec<f64> = throttle.iter().copied().filter(|u| *u > LEVEL).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| *a - *b < LEVEL);
    if levels.len() < LEVELS {
        return Err(format!("only {} different throttles; {LEVELS} wanted", levels.len()));
    }
    let rows = throttle.len();
    let (sag, nominal_voltage) = sag(stand.voltage.as_deref(), rows, before);
    let power = |n: i32| -> Vec<f64> {
        throttle.iter().zip(&sag).map(|(u, sag)| sag * u.max(0.0).powi(n)).collect()
    };
    let (square, linear) = (power(2), power(1));
    let points = [&square[..], &linear[..], &stand.thrust[..]];
    let free = Curve::through(points, None, 1.0).ok_or(UNEXCITED)?;
    let old = f64::from(before.thrust_factor);
    let used = if free.is_known() {
        free
    } else {
        Curve::through(points, Some(old), 1.0).ok_or(UNEXCITED)?
    };
    let mean = stand.thrust.iter().sum::<f64>() / rows as f64;
    let shape = square.iter().zip(&linear).map(|(q, l)| old * q + (1.0 - old) * l).sum::<f64>();
    let expected = f64::from(before.rotor_thrust_max) * shape / rows as f64;
    Ok(ThrustFit {
        thrust_max: used.thrust_max,
        factor: used.factor,
        factor_is_known: free.is_known(),
        factor_sd: free.factor_sd,
        lag: None,
        nominal_voltage,
        resets_scale: false,
        residual: used.residual,
        mean,
        error_before: mean / expected - 1.0,
        has_voltage: stand.voltage.is_some(),
    })
}
