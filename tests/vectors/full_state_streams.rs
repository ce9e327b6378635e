//! The recorded sensors of both files, tick by tick.

use super::full_state::Bounds;
use super::full_state_case::{Case, Errors, filter, filter_2};
use super::{list, num};
use serde_json::{Value, json};
use tautline_firmware::estimate::full_state::{FullState, FullStateFilter, GroundEnd, Load};
use tautline_firmware::frames::V3;
use tautline_firmware::scalar::Scalar;

/// What one row of a stream holds, and where.
struct Columns {
    gyro: usize,
    accel: usize,
}

struct Stream<'a> {
    content: &'a Value,
    errors: Errors,
    columns: Columns,
    first: u64,
    length_sd: f64,
    bounds: Bounds,
}

impl Stream<'_> {
    fn run<S: Scalar + Into<f64>>(&self, filter: &FullStateFilter<S>) {
        let v = self.content;
        let mut state: FullState<S> = self.errors.nominal(&json!({ "x": v["x0"], "R": v["R0"] }));
        state.covariance = self.errors.diagonal(&list(v, "P0diag"));
        let length = S::lit(num(v, "L"));
        let checkpoints = v["checkpoints"].as_array().unwrap();
        let bounds = Bounds { state: self.bounds.stream, ..self.bounds };
        let mut check = Case::new(self.errors, bounds);
        let mut seen = 0;
        for (k, row) in (self.first..).zip(v["rows"].as_array().unwrap()) {
            let at = |i: usize| row[i].as_f64().map(S::lit);
            let vector = |i: usize| V3::new(at(i).unwrap(), at(i + 1).unwrap(), at(i + 2).unwrap());
            let load = Load { thrust: at(6).unwrap(), is_taut: true, length_out: length };
            filter.predict(&mut state, &vector(self.columns.gyro), &load).unwrap();
            let nis = filter.accelerometer(&mut state, &vector(self.columns.accel), &load).unwrap();
            if let Some(height) = at(7) {
                filter.altimeter(&mut state, height, S::lit(0.08)).unwrap();
            }
            if k % 2 == 0 {
                let sd = S::lit(self.length_sd);
                filter.line_out(&mut state, length, GroundEnd::Fixed, sd).unwrap();
                filter.radial_rate(&mut state, S::zero(), S::lit(0.3)).unwrap();
            }
            let Some(want) = checkpoints.iter().find(|c| c["k"].as_u64() == Some(k)) else {
                continue;
            };
            seen += 1;
            let name = format!("tick {k}");
            check.state(&name, &state, want);
            check.variances(&name, &state.covariance, &list(want, "Pdiag"));
            let wanted = want["nis"].as_f64().unwrap_or_else(|| list(want, "nis")[0]);
            check.value(&name, nis, wanted);
            if let Some(deviation) = want.get("gust_sd").and_then(Value::as_f64) {
                check.value(&name, filter.gust_deviation(&state), deviation);
            }
        }
        assert_eq!(seen, checkpoints.len(), "every checkpoint");
    }
}

/// Parameters of the specification's section 5, not the file's.
fn section_5() -> Value {
    let degree = 1_f64.to_radians();
    json!({
        "m": 1.2, "ra": 0.05, "cd": 0.15, "mu": 0.002, "EA": 3000.0, "lmin": 0.3, "gate": 5.0,
        "sg": 0.03 * degree, "qv": 0.02, "qfc": 4.0, "qkT": 5e-4, "qba": 2e-4, "qbg": 0.002 * degree,
        "tauw": 300.0, "swh": 0.6, "swd": 0.1, "qhb": 1e-3, "sa": 0.55,
    })
}

pub fn first<S: Scalar + Into<f64>>(file: &Value, bounds: Bounds) {
    let content = &file["stream"];
    if content.is_null() {
        return;
    }
    assert_eq!(content["columns"], "acc3 gyro3 T alt(null=none)");
    let stream = Stream {
        content,
        errors: Errors::TwentyOne,
        columns: Columns { accel: 0, gyro: 3 },
        first: 1,
        length_sd: 0.06,
        bounds,
    };
    stream.run::<S>(&filter(&section_5(), content));
}

pub fn second<S: Scalar + Into<f64>>(file: &Value, bounds: Bounds) {
    let content = &file["stream2"];
    if content.is_null() {
        return;
    }
    assert_eq!(content["columns"], "gyro3 acc3 T alt(null: none)");
    let stream = Stream {
        content,
        errors: Errors::TwentySix,
        columns: Columns { gyro: 0, accel: 3 },
        first: 0,
        length_sd: 0.12,
        bounds,
    };
    stream.run::<S>(&filter_2(&file["meta"]["par"], content));
}
