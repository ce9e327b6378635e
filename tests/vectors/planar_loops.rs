//! `planar.json`: closed loops, flown by the simulator's planar plant and the core's blocks.

use super::inventory::unread_key;
use super::{list, num};
use serde_json::Value;
use tautline_sitl::bench::planar::{
    BranchChoice, Feedback, InversionKind, LawKind, PlanarScenario, Residual, SmoothKind,
    UpdateKind, fly,
};

fn pair(v: &Value, key: &str) -> [f64; 2] {
    list(v, key).try_into().unwrap()
}

/// What `scenario` reads, and what does not change a run: the seed of numbers that are our own, and how
/// many rows the trace leaves out.
const KEYS: [&str; 55] = [
    "J", "T", "Tconf", "Ts", "Z2", "Z3", "cont", "dJ", "dec", "disc", "dl", "dm", "dx0", "dz0",
    "econf", "eps", "eps2", "eta_min", "g", "hold", "hyst", "init", "inv", "ipar", "l", "lam", "m",
    "mL", "method", "mode", "n1", "n2", "nsub", "obs", "obs_tau", "p1", "p2", "prior", "roots",
    "rx", "rz", "seed", "sel0", "sgu", "single", "t0", "tauM", "ton", "tsw", "ulim", "umid",
    "var_a", "var_w", "y1", "y2",
];

/// A setting of a case that `scenario` does not know.
pub fn unknown_setting(case: &Value) -> Option<String> {
    let q = &case["scenario"];
    let is_one_of =
        |key: &str, values: &[f64]| q[key].as_f64().is_some_and(|x| values.contains(&x));
    if let Some(key) = unread_key(q, &KEYS) {
        return Some(format!("setting {key}"));
    }
    for (key, values) in
        [("mode", 0..=2), ("inv", 0..=2), ("n1", 1..=4), ("n2", 1..=4), ("umid", 0..=1)]
    {
        if !is_one_of(key, &values.map(f64::from).collect::<Vec<_>>()) {
            return Some(format!("{key} {}", q[key]));
        }
    }
    let method = (q["method"].as_str().unwrap_or_default(), num(q, "umid") as u8);
    if !matches!(method, ("pct" | "pc", 1) | ("euler" | "rk4" | "exact", _)) {
        return Some(format!("method {method:?}"));
    }
    // Any other start than the quasi-static one.
    (q["init"] != "quasi").then(|| format!("init {}", q["init"]))
}

/// The file's scenario in our words.
pub fn scenario(q: &Value) -> PlanarScenario {
    let flag = |key: &str| q[key].as_bool().unwrap_or_else(|| num(q, key) > 0.5);
    let smooth = |key: &str| match num(q, key) as u8 {
        1 => SmoothKind::C1,
        2 => SmoothKind::C2,
        3 => SmoothKind::C3,
        _ => SmoothKind::C4,
    };
    let mut s = PlanarScenario {
        law: match num(q, "mode") as u8 {
            0 => LawKind::Static,
            1 => LawKind::Attitude,
            _ => LawKind::Force,
        },
        feedback: if flag("obs") { Feedback::Observer } else { Feedback::State },
        rate_hz: 1.0 / num(q, "Ts"),
        // Plant steps of half a millisecond or less, as the tolerance asks.
        substeps: (num(q, "nsub") as u32).max((num(q, "Ts") / 5e-4).ceil() as u32),
        ..PlanarScenario::default()
    };
    let p = &mut s.plant;
    (p.mass, p.inertia, p.length, p.gravity) = (num(q, "m"), num(q, "J"), num(q, "l"), num(q, "g"));
    (p.link_mass, p.attachment, p.motor_lag) =
        (num(q, "mL"), [num(q, "rx"), num(q, "rz")], num(q, "tauM"));
    let e = &mut s.model_error;
    (e.mass, e.inertia, e.length) = (num(q, "dm"), num(q, "dJ"), num(q, "dl"));
    let r = &mut s.reference;
    (r.elevation, r.second) = (pair(q, "y1"), pair(q, "y2"));
    (r.elevation_smoothness, r.second_smoothness) = (smooth("n1"), smooth("n2"));
    (r.start, r.duration, r.hold) = (num(q, "t0"), num(q, "T"), num(q, "hold"));
    let c = &mut s.controller;
    (c.elevation_poles, c.second_poles) = (list(q, "p1"), pair(q, "p2"));
    c.inversion = match num(q, "inv") as u8 {
        0 => InversionKind::Exact,
        1 => InversionKind::Damped,
        _ => InversionKind::Window,
    };
    [c.threshold, c.damping] = pair(q, "ipar");
    // Limits of thrust and torque; all zero: none.
    let [low, high, torque, _] = list(q, "ulim").try_into().unwrap();
    (c.thrust, c.torque_max) = ([low, high], torque);
    let o = &mut s.observer;
    o.roots = list(q, "roots").try_into().unwrap();
    (o.epsilon, o.motor_lag) = (num(q, "eps"), num(q, "obs_tau"));
    // The file's ε holds until tsw, then eps2.
    if num(q, "tsw") > 0.0 {
        (o.fast_epsilon, o.fast_time, o.epsilon) = (num(q, "eps"), num(q, "tsw"), num(q, "eps2"));
    }
    o.update = match (q["method"].as_str().unwrap(), num(q, "umid") as u8) {
        ("pct", 1) => UpdateKind::PredictorCorrector,
        ("pc", 1) => UpdateKind::PredictorCorrectorHeld,
        ("euler", _) => UpdateKind::Euler,
        ("rk4", _) => UpdateKind::Rk4Held,
        ("exact", _) => UpdateKind::ExactHeld,
        other => panic!("observer {other:?} is not known"),
    };
    o.branches = match (flag("single"), num(q, "sel0") > 0.5) {
        (true, _) => BranchChoice::One,
        (false, false) => BranchChoice::BothFromFirst,
        (false, true) => BranchChoice::BothFromSecond,
    };
    o.residual = if num(q, "disc") > 0.5 { Residual::UnitVector } else { Residual::Acceleration };
    o.sign_is_continuous = flag("cont");
    o.is_above_ground = flag("prior");
    (o.hysteresis, o.forgetting, o.force_min) = (num(q, "hyst"), num(q, "lam"), num(q, "eta_min"));
    (o.rate_max, o.accel_max) = (num(q, "Z2"), num(q, "Z3"));
    (o.confident, o.confident_time) = (num(q, "econf"), num(q, "Tconf"));
    s.start.state_offset = list(q, "dx0").try_into().unwrap();
    s.start.observer_offset = list(q, "dz0").try_into().unwrap();
    s.start.hold_off = num(q, "ton");
    s.start.is_upside_down = num(q, "sgu") < 0.0;
    s.noise.accel_variance = num(q, "var_a");
    s.noise.gyro_variance = num(q, "var_w");
    s
}

/// Trace within 2e-3, figures within twice the listed ones plus 1e-4, as the file says.
pub fn check(q: &Value) {
    let name = q["name"].as_str().unwrap();
    if let Some(setting) = unknown_setting(q) {
        println!("{name}: not checked, unknown {setting}");
        return;
    }
    let s = scenario(&q["scenario"]);
    let run = fly(&s, 1).unwrap_or_else(|e| panic!("{name}: {e}"));
    let want = &q["result"];
    assert_eq!(run.summary.has_diverged, want["diverged"].as_bool().unwrap(), "{name}: diverged");
    // Other random numbers give another trace, and after a divergence every rounding counts.
    if s.noise.accel_variance + s.noise.gyro_variance > 0.0 || run.summary.has_diverged {
        return;
    }
    let columns: Vec<&str> =
        q["trace_columns"].as_array().unwrap().iter().map(|c| c.as_str().unwrap()).collect();
    let column = |key| columns.iter().position(|c| *c == key).unwrap();
    let (t, phi, theta) = (column("t"), column("phi"), column("theta"));
    let mut worst = 0.0_f64;
    for row in q["trace"].as_array().unwrap() {
        let at = |k: usize| row[k].as_f64().unwrap();
        let ours = &run.rows[(at(t) * s.rate_hz).round() as usize];
        for (got, want) in [(ours.state[0], at(phi)), (ours.state[2], at(theta))] {
            let error = (got - want).abs();
            worst = worst.max(error);
            assert!(error <= 2e-3, "{name} at {} s: {got}, want {want}", at(t));
        }
    }
    let got = &run.summary;
    for (key, got) in [
        ("e1_rms", got.rms[0]),
        ("e2_rms", got.rms[1]),
        ("e1_max_after1s", got.max_after_1s[0]),
        ("e2_max_after1s", got.max_after_1s[1]),
        ("e1_last", got.max_last[0]),
        ("e2_last", got.max_last[1]),
        ("obs_phi_max_after1s", got.estimate_max_after_1s),
    ] {
        let want = num(want, key);
        assert!(got <= 2.0 * want + 1e-4, "{name} {key}: {got}, want {want}");
        assert!(want <= 2.0 * got + 1e-4, "{name} {key}: {got}, want {want}");
    }
    println!("{name}: largest difference of the trace {worst:.1e} rad");
}
