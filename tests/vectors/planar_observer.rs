//! `planar.json`: what the observer measures and steps, and its streams.

use super::inventory::unread_key;
use super::planar::{array, model, outs, poles, s, state, values};
use super::{Check, num};
use serde_json::Value;
use tautline_firmware::estimate::high_gain::{
    BranchIndex, Branches, Canonical, CorrectorGain, Discrimination, Drive, ForceReading, HighGain,
    HighGainInput, HighGainSettings, Naive, NaiveStep, Predictor, Selector,
};
use tautline_firmware::math::wrap_pi;
use tautline_firmware::model::PlanarImu;
use tautline_firmware::scalar::Scalar;

fn reading<S: Scalar>(i: &Value) -> ForceReading<S> {
    let imu = PlanarImu { x: s(i, "ax"), z: s(i, "az"), rate: S::zero() };
    ForceReading::new(&model(i), &imu, s(i, "u1"))
}

pub(super) fn meas_journal<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    let (force, angle) = reading::<S>(i).signed(s(i, "sign"));
    check.near(name, force, num(o, "eta_signed"));
    check.angle(name, angle, num(o, "w"));
}

pub(super) fn meas_icra<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    let (angle, force) = reading::<S>(i).by_angle(&model(i), num(i, "k") > 0.5);
    check.angle(name, angle, num(o, "wbar1"));
    check.near(name, force, num(o, "wbar2"));
}

pub(super) fn meas_along<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    check.near(name, reading::<S>(i).along(s(i, "z1")), o.as_f64().unwrap());
}

fn canonical<S: Scalar>(i: &Value) -> Canonical<S> {
    let bound = |key: &str, default| i.get(key).map_or(default, |v| v.as_f64().unwrap());
    Canonical {
        model: model(i),
        rate_max: S::lit(bound("Z2", 10.0)),
        accel_max: S::lit(bound("Z3", 100.0)),
    }
}
fn drive<S: Scalar>(i: &Value) -> Drive<S> {
    Drive {
        thrust: s(i, "u1"),
        thrust_rate: s(i, "u1d"),
        pitch_rate: s(i, "u3"),
        force: s(i, "eta_signed"),
    }
}
fn naive<S: Scalar>(i: &Value) -> Naive<S> {
    Naive::new(canonical(i), &array(i, "alpha"), s(i, "eps"))
}

pub(super) fn sigma<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.near(name, canonical::<S>(i).jerk(&array(i, "z"), &drive(i)), o.as_f64().unwrap());
}

pub(super) fn observer_rate<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    check.all(name, naive::<S>(i).rate(&array(i, "z"), s(i, "w"), &drive(i)), outs(o));
}

pub(super) fn to_state<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (force, now, measured) = (s(i, "eta_signed"), s(i, "u1_now"), s(i, "u1_meas"));
    let z = array(i, "z");
    let (x, _) = canonical::<S>(i).to_state(&z, force, now, measured, s(i, "u3"));
    let [phi, dphi, theta, dtheta] = outs(o).try_into().unwrap();
    check.angle(name, x.elevation, phi);
    check.angle(name, x.pitch, theta);
    check.all(name, [x.elevation_rate, x.pitch_rate], vec![dphi, dtheta]);
}

pub(super) fn prediction_error<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    let expected = model::<S>(i).imu(&state(i, "xhat"), s(i, "u1"));
    let (x, z): (S, S) = (s::<S>(i, "ax") - expected.x, s::<S>(i, "az") - expected.z);
    check.near(name, (x * x + z * z).sqrt(), o.as_f64().unwrap());
}

pub(super) fn wrap<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.angle(name, wrap_pi(s::<S>(i, "a")), o.as_f64().unwrap());
}

pub(super) fn select<S: Scalar + Into<f64>>(_: &mut Check, name: &str, i: &Value, o: &Value) {
    let index = |x: f64| if x > 0.5 { BranchIndex::B } else { BranchIndex::A };
    let selector =
        Selector::<S> { hysteresis: s(i, "hyst"), is_above_ground: num(i, "prior") > 0.5 };
    let errors = [s(i, "e0"), s(i, "e1")];
    let got = selector.select(index(num(i, "sel")), &errors, &[s(i, "phi0"), s(i, "phi1")]);
    assert_eq!(got, index(o.as_f64().unwrap()), "{name}");
}

fn naive_step<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
    how: NaiveStep,
) {
    let z = naive::<S>(i).step(&array(i, "z"), s(i, "w"), &drive(i), s(i, "Ts"), how);
    check.angle(name, z[0], outs(o)[0]);
    check.all(name, [z[1], z[2]], outs(o)[1..].to_vec());
}
pub(super) fn step_euler<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    naive_step::<S>(check, name, i, o, NaiveStep::Euler);
}
pub(super) fn step_rk4<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    naive_step::<S>(check, name, i, o, NaiveStep::Rk4);
}
pub(super) fn step_exact<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    naive_step::<S>(check, name, i, o, NaiveStep::Exact);
}
pub(super) fn step_open<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    naive_step::<S>(check, name, i, o, NaiveStep::Open);
}

/// `α` comes highest power first; the gain wants the roots.
fn gain<S: Scalar>(i: &Value) -> CorrectorGain<S> {
    let [a1, a2, a3] = values(i, "alpha");
    CorrectorGain::try_new(&poles(&[a3, a2, a1]), num(i, "eps"), num(i, "Ts")).unwrap()
}

pub(super) fn corrector_gain<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    check.all(name, gain::<S>(i).0, outs(o));
}

pub(super) fn predictor_step<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    i: &Value,
    o: &Value,
) {
    let predictor = Predictor::<S> { canonical: canonical(i), period: s(i, "Ts") };
    let ahead = predictor.predict(&array(i, "z"), &drive(i));
    let want: [f64; 3] = values(o, "z_pred");
    check.angle(name, ahead[0], want[0]);
    check.all(name, [ahead[1], ahead[2]], want[1..].to_vec());
    check.angle(name, wrap_pi(s::<S>(i, "w") - ahead[0]), num(o, "innov"));
    let corrected = predictor.correct(&ahead, s(i, "w"), &gain(i));
    let want: [f64; 3] = values(o, "z_corr");
    check.angle(name, corrected[0], want[0]);
    check.all(name, [corrected[1], corrected[2]], want[1..].to_vec());
}

/// The start is words in the file; ours is the one that it says.
const START: &str = "quasi-static from row 0, then z[:,0]+=0.1 and z[:,1]+=0.2 on both branches";

/// A parameter of a stream that nothing here reads, or another start.
pub fn unknown_setting(stream: &Value) -> Option<String> {
    let read = [
        "J", "Ts", "Z2", "Z3", "alpha", "disc", "eps", "eta_min", "g", "hyst", "init", "l", "lam",
        "m", "prior", "sel0",
    ];
    let p = &stream["params"];
    if let Some(key) = unread_key(p, &read) {
        return Some(format!("parameter {key}"));
    }
    (p["init"] != START).then(|| format!("init {}", p["init"]))
}

/// One stream: inputs of every tick, and what the observer must then know.
pub fn stream<S: Scalar + Into<f64>>(name: &str, stream: &Value, bound: f64) {
    if let Some(setting) = unknown_setting(stream) {
        println!("{name}: not checked, unknown {setting}");
        return;
    }
    let p = &stream["params"];
    let alpha: [f64; 3] = values(p, "alpha");
    let index = |x: f64| if x > 0.5 { BranchIndex::B } else { BranchIndex::A };
    let observer = HighGain::<S>::try_new(HighGainSettings {
        roots: poles(&[alpha[2], alpha[1], alpha[0]]),
        epsilon: num(p, "eps"),
        branches: Branches::Both(index(num(p, "sel0"))),
        discrimination: if num(p, "disc") > 0.5 {
            Discrimination::UnitVector
        } else {
            Discrimination::Acceleration
        },
        hysteresis: num(p, "hyst"),
        is_above_ground: num(p, "prior") > 0.5,
        forgetting: num(p, "lam"),
        force_min: num(p, "eta_min"),
        rate_max: num(p, "Z2"),
        accel_max: num(p, "Z3"),
        restart: None,
        ..HighGainSettings::new(model(p), num(p, "Ts"))
    })
    .unwrap();
    let columns: Vec<&str> =
        stream["columns"].as_array().unwrap().iter().map(|c| c.as_str().unwrap()).collect();
    let rows: Vec<Vec<f64>> = stream["rows"].as_array().unwrap().iter().map(outs).collect();
    let at = |row: &[f64], column: &str| row[columns.iter().position(|c| *c == column).unwrap()];
    let input = |row: &[f64]| {
        let s = |column| S::lit(at(row, column));
        HighGainInput {
            imu: PlanarImu { x: s("ax"), z: s("az"), rate: s("omega") },
            thrust_measured: s("u1_app"),
            thrust_now: s("u1_now"),
            thrust_rate: s("u1d_mean"),
        }
    };
    let first = input(&rows[0]);
    // As the file's `init` says.
    let mut state = observer.quasi_static(&first.imu, first.thrust_measured).displaced([
        S::lit(0.1),
        S::lit(0.2),
        S::zero(),
    ]);
    let mut check = Check::new(bound);
    for (k, row) in rows.iter().enumerate() {
        let name = format!("{name}[{k}]");
        observer.step(&mut state, &input(row)).unwrap();
        let estimate = state.estimate();
        assert_eq!(estimate.branch, index(at(row, "selected")), "{name}: selected");
        let branches = state.branches().iter().zip(["zA", "zB"]).zip(["eA", "eB"]);
        for ((branch, z), e) in branches {
            check.angle(&name, branch.z[0], at(row, &format!("{z}1")));
            check.near(&name, branch.z[1], at(row, &format!("{z}2")));
            check.near(&name, branch.z[2], at(row, &format!("{z}3")));
            check.near(&name, branch.error, at(row, e));
        }
        let x = estimate.state;
        check.angle(&name, x.elevation, at(row, "xh1"));
        check.near(&name, x.elevation_rate, at(row, "xh2"));
        check.angle(&name, x.pitch, at(row, "xh3"));
    }
}
