//! `fullstate.json` and `fullstate2.json`: the full-state filter, its dither, and both of its streams.

use super::full_state_case::{Case, Errors, filter, filter_2, start};
use super::{Check, cases, list, num, s, vec3};
use serde_json::Value;
use tautline_firmware::control::{Dither, DitherState, Shape};
use tautline_firmware::estimate::full_state::{
    BLOCKS, Covariance, DirectionEnd, FullState, FullStateFilter, GUST, GroundEnd, Load,
    PushDetector,
};
use tautline_firmware::frames::V3;
use tautline_firmware::scalar::Scalar;

/// Groups of the first file.
pub const GROUPS: [&str; 11] = [
    "predict", "sforce", "acc_H", "upd_acc", "upd_alt", "upd_len", "upd_rad", "upd_fc", "upd_yaw",
    "upd_vh", "stream",
];
/// And of the second.
pub const GROUPS_2: [&str; 13] = [
    "predict2",
    "acc2",
    "len2",
    "cell",
    "dir_vehicle",
    "dir_ground",
    "pos",
    "flow",
    "gust_sd",
    "boost",
    "catenary",
    "dither",
    "stream2",
];

/// Bounds on the state, relative to 1 or its size, and on the covariance, relative to the standard deviations.
#[derive(Clone, Copy)]
pub struct Bounds {
    pub state: f64,
    pub covariance: f64,
    /// Of a stream's state.
    pub stream: f64,
}

/// Of the specification's section 16.
pub const DOUBLE: Bounds = Bounds { state: 1e-9, covariance: 1e-9, stream: 1e-7 };
/// Of the specification's section 16.
pub const SINGLE: Bounds = Bounds { state: 2e-4, covariance: 2e-3, stream: 1e-2 };

fn load<S: Scalar>(c: &Value) -> Load<S> {
    let optional = |key: &str, otherwise: f64| c[key].as_f64().unwrap_or(otherwise);
    Load {
        thrust: S::lit(optional("T", 0.0)),
        is_taut: optional("taut", 1.0) > 0.5,
        length_out: S::lit(optional("S", 0.0)),
    }
}

type Step<S> = fn(&FullStateFilter<S>, &mut FullState<S>, &Value) -> Option<S>;

fn pair<S: Scalar>(c: &Value) -> [S; 2] {
    let z = list(c, "z");
    [S::lit(z[0]), S::lit(z[1])]
}

/// Groups that step a state, of the first file.
fn steps<S: Scalar>() -> Vec<(&'static str, Step<S>)> {
    vec![
        ("predict", |f, x, c| {
            f.predict(x, &vec3(c, "gyro"), &load(c)).unwrap();
            None
        }),
        ("upd_acc", |f, x, c| Some(f.accelerometer(x, &vec3(c, "f"), &load(c)).unwrap())),
        ("upd_alt", |f, x, c| Some(f.altimeter(x, s(c, "z"), s(c, "sd")).unwrap())),
        ("upd_len", |f, x, c| Some(f.distance(x, s(c, "z"), s(c, "sd")).unwrap())),
        ("upd_rad", |f, x, c| Some(f.radial_rate(x, s(c, "z"), s(c, "sd")).unwrap())),
        ("upd_fc", |f, x, c| Some(f.chord_tension(x, s(c, "z"), s(c, "sd")).unwrap())),
        ("upd_yaw", |f, x, c| Some(f.heading(x, s(c, "z"), s(c, "sd")).unwrap())),
        ("upd_vh", |f, x, c| Some(f.level_velocity(x, pair(c), s(c, "sd")).unwrap())),
    ]
}

/// Of the second.
fn steps_2<S: Scalar>() -> Vec<(&'static str, Step<S>)> {
    vec![
        ("predict2", |f, x, c| {
            f.predict(x, &vec3(c, "gyro"), &load(c)).unwrap();
            None
        }),
        ("acc2", |f, x, c| Some(f.accelerometer(x, &vec3(c, "z"), &load(c)).unwrap())),
        ("len2", |f, x, c| {
            let end =
                if c["elastic"].as_bool().unwrap() { GroundEnd::Fixed } else { GroundEnd::Winch };
            Some(f.line_out(x, s(c, "S"), end, s(c, "sd")).unwrap())
        }),
        ("cell", |f, x, c| {
            Some(f.end_tension(x, DirectionEnd::Ground, s(c, "z"), s(c, "S"), s(c, "sd")).unwrap())
        }),
        ("dir_vehicle", |f, x, c| direction(f, x, DirectionEnd::Vehicle, c)),
        ("dir_ground", |f, x, c| direction(f, x, DirectionEnd::Ground, c)),
        ("pos", |f, x, c| Some(f.level_position(x, pair(c), s(c, "sd")).unwrap())),
        ("flow", |f, x, c| Some(f.body_velocity(x, pair(c), s(c, "sd")).unwrap())),
    ]
}

fn direction<S: Scalar>(
    f: &FullStateFilter<S>,
    x: &mut FullState<S>,
    end: DirectionEnd,
    c: &Value,
) -> Option<S> {
    Some(f.line_direction(x, end, pair(c), s(c, "S"), s(c, "sd")).unwrap())
}

fn run<S: Scalar + Into<f64>>(
    file: &Value,
    steps: Vec<(&'static str, Step<S>)>,
    errors: Errors,
    filter: impl Fn(&Value) -> FullStateFilter<S>,
    bounds: Bounds,
) {
    for (group, step) in steps {
        let mut check = Case::new(errors, bounds);
        for (name, c) in cases(file, group) {
            let mut state = errors.state(&c["inp"]);
            let nis = step(&filter(c), &mut state, c);
            check.state(&name, &state, &c["out"]);
            check.covariance(&name, &state.covariance, &c["out"]);
            if let Some(nis) = nis {
                check.value(&name, nis, num(&c["out"], "nis"));
            }
        }
    }
}

/// Single steps, the force model and the derivative of the accelerometer's rows.
pub fn singles<S: Scalar + Into<f64>>(file: &Value, bounds: Bounds) {
    let model = |c: &Value| filter::<S>(&file["meta"]["est"], c);
    run(file, steps(), Errors::TwentyOne, model, bounds);
    let mut check = Check::new(bounds.state);
    for (name, c) in cases(file, "sforce") {
        let state = Errors::TwentyOne.nominal::<S>(c);
        let force = model(c).model.specific_force(&state, &load(c));
        check.all(&name, force.iter().copied(), list(c, "s"));
    }
    for (name, c) in cases(file, "acc_H") {
        let state = Errors::TwentyOne.nominal::<S>(c);
        let (rows, expected) = model(c).accelerometer_derivative(&state, &load(c));
        check.all(&name, expected.iter().copied(), list(c, "h"));
        let want = c["H"].as_array().unwrap();
        for (row, want) in rows.iter().zip(want) {
            let want = want.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            check.all(&name, Errors::TwentyOne.of_blocks(row), want);
        }
    }
}

/// The second file's: gusts, heavy lines, sensors of the line, and the dither.
pub fn singles_2<S: Scalar + Into<f64>>(file: &Value, bounds: Bounds) {
    let par = &file["meta"]["par"];
    run(file, steps_2(), Errors::TwentySix, |c| filter_2::<S>(par, c), bounds);
    let mut check = Check::new(bounds.state);
    for (name, c) in cases(file, "gust_sd") {
        let state = Errors::TwentySix.state::<S>(c);
        check.near(&name, filter_2(par, c).gust_deviation(&state), num(c, "sd"));
    }
    for (name, c) in cases(file, "boost") {
        let mut detector = PushDetector { level: s::<S>(c, "nF") };
        let before = Covariance::from_deviations(&[V3::zeros(); BLOCKS]);
        let added = detector.step(s(c, "nis"), s(c, "kb"), s(c, "dt")).unwrap_or_default();
        check.near(&name, detector.level, num(c, "nF_out"));
        check.all(&name, added.iter().copied(), list(c, "dP"));
        let mut state = start::<S>();
        state.covariance = before;
        let filter = filter_2(par, &serde_json::json!({ "dt": c["dt"] }));
        let mut again = PushDetector { level: s::<S>(c, "nF") };
        filter.boost(&mut state, &mut again, s(c, "nis"));
        check.all(&name, state.covariance.variances(GUST).iter().copied(), list(c, "dP"));
    }
    for (name, c) in cases(file, "dither") {
        let shape = match c["shape"].as_str().unwrap() {
            "soft" => Shape::Soft,
            "square" => Shape::Square,
            other => panic!("{name}: unknown shape {other}"),
        };
        let dither = Dither::<S> { amplitude: s(c, "A"), period: s(c, "T"), shape };
        let mut state = DitherState::default();
        // Steps that end at the wanted time.
        let steps = (num(c, "t") / 4e-3).ceil();
        for _ in 0..steps as usize {
            dither.step(&mut state, S::lit(num(c, "t") / steps));
        }
        check.near(&name, dither.offset(&state), num(c, "dF"));
    }
}
