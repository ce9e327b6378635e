//! `pendulum.json`: steps of the plant and closed loops with the simulator's own plant.

use super::pendulum::{gains, model};
use super::{Check, cases, list, num};
use nalgebra::{SVector, Vector3};
use serde_json::Value;
use tautline_firmware::control::pendulum::{LinearPendulum, PendulumControl, PendulumLimits};
use tautline_firmware::estimate::pendulum::{
    PendulumFilter, PendulumNoise, PendulumObserver, VerticalDisturbance,
};
use tautline_firmware::frames::V3;
use tautline_firmware::trajectory::load::TiltedCircle;
use tautline_sitl::bench::pendulum::{
    Flown, PendulumAction, PendulumPlant, PendulumRun, PendulumTrace, PendulumTruth, STATES,
    Sensing, linear_gains,
};
use tautline_sitl::plant::Disturbance;
use tautline_sitl::scenario::DisturbanceKind;

fn array(v: &Value, key: &str) -> [f64; STATES] {
    list(v, key).try_into().unwrap()
}

fn three(list: &[f64]) -> Vector3<f64> {
    Vector3::from_column_slice(list)
}

fn plant(par: &Value, lag: f64, drag: f64) -> PendulumPlant {
    PendulumPlant {
        vehicle_mass: num(par, "mQ"),
        load_mass: num(par, "mL"),
        length: num(par, "l"),
        gravity: num(par, "g"),
        lag,
        drag,
    }
}

pub fn plant_steps(file: &Value) {
    let mut check = Check::new(1e-9);
    for (name, c) in cases(file, "plant_step") {
        let truth = PendulumTruth::from_array(&array(c, "y"));
        let action = PendulumAction {
            thrust: num(c, "T"),
            rate: three(&list(c, "Omega_cmd")),
            disturbance: three(&list(c, "b")),
        };
        let next = plant(c, num(c, "tau"), 0.0).step(&truth, &action, num(c, "h"));
        check.all(&name, next.to_array(), array(c, "y_next").to_vec());
    }
}

/// What this test understands; a case that uses anything else is named and not compared.
const OPTIONS: [&str; 26] = [
    "t_end",
    "dt",
    "nsub",
    "tau",
    "delay_sub",
    "sig_q",
    "true_state",
    "use_qhat",
    "Tmin",
    "Tmax",
    "Omax",
    "speed",
    "kf_mid",
    "controller",
    "lqr_ff",
    "hover",
    "sig_v",
    "sig_p",
    "xi_floor",
    "comp_b",
    "e1_wn",
    "dT",
    "drag",
    "soft_T",
    "case",
    "seed",
];

fn not_understood(options: &Value) -> Option<String> {
    let zero = |v: &Value| v.as_f64() == Some(0.0);
    for (key, value) in options.as_object().unwrap() {
        if !OPTIONS.contains(&key.as_str()) && !zero(value) {
            return Some(format!("{key} = {value}"));
        }
    }
    let is_one_of = |key: &str, values: &[f64]| values.contains(&num(options, key));
    if !is_one_of("controller", &[0.0, 1.0]) {
        return Some("controller".to_owned());
    }
    (options["kf_mid"] != 1).then(|| "kf_mid".to_owned())
}

pub fn unknown_setting(case: &Value) -> Option<String> {
    not_understood(&case["options"])
}

fn run(c: &Value) -> PendulumRun<f64> {
    let (par, o) = (&c["par"], &c["options"]);
    let model = model::<f64>(par);
    let limits = PendulumLimits {
        thrust_min: num(o, "Tmin"),
        thrust_max: num(o, "Tmax"),
        rate_max: num(o, "Omax"),
        pull_share: (num(o, "xi_floor") > 0.0).then(|| num(o, "xi_floor")),
    };
    let blocks = |x: &[f64]| [0, 3, 6].map(|i| V3::new(x[i], x[i + 1], x[i + 2]));
    let (process, reading) = (list(c, "Qc"), list(c, "Rc"));
    let noise = PendulumNoise {
        process: blocks(&process),
        rod: V3::new(reading[0], reading[1], reading[2]),
        spin: reading[3],
        start: blocks(&list(c, "P0")),
    };
    let filter = PendulumFilter { model, noise };
    let mut posterior = filter.start(&V3::zeros());
    [posterior.rod, posterior.rate, posterior.disturbance] = blocks(&list(c, "x0"));
    let law = if num(o, "controller") == 0.0 {
        Flown::Backstepping(PendulumControl::try_new(gains(par), model, limits).unwrap())
    } else {
        let weights = ([40.0, 10.0, 20.0, 4.0, 4.0], 0.5);
        let stiffness = model.weight() / model.lever();
        let gains = linear_gains(num(par, "g"), stiffness, weights, num(o, "lqr_ff") != 0.0);
        Flown::Linear(LinearPendulum { gains, model, limits })
    };
    let seed = o["seed"].as_u64().unwrap_or(1);
    let disturbance = match (c["b_const"].as_array(), o["case"].as_str().unwrap()) {
        (Some(_), _) => Disturbance::constant(three(&list(c, "b_const"))),
        (None, "none") => Disturbance::new(DisturbanceKind::None, seed),
        (None, "const") => Disturbance::new(DisturbanceKind::Constant, seed),
        (None, "stoch") => Disturbance::new(DisturbanceKind::Stochastic, seed),
        (None, other) => panic!("unknown disturbance {other}"),
    };
    PendulumRun {
        plant: plant(par, num(o, "tau"), num(o, "drag")),
        thrust_factor: 1.0 + num(o, "dT"),
        start: PendulumTruth::from_array(&array(c, "y0")),
        disturbance,
        observer: PendulumObserver {
            filter,
            vertical: (num(o, "e1_wn") > 0.0)
                .then(|| VerticalDisturbance { bandwidth: num(o, "e1_wn") }),
        },
        initial: Some(posterior),
        law,
        circle: TiltedCircle::article(num(o, "speed")),
        is_hovering: num(o, "hover") != 0.0,
        soft_start: num(o, "soft_T"),
        sensing: Sensing {
            rod: num(o, "sig_q"),
            velocity: num(o, "sig_v"),
            position: num(o, "sig_p"),
            period: num(o, "dt"),
            delay: num(o, "delay_sub") as usize,
            seed,
        },
        knows_state: num(o, "true_state") != 0.0,
        uses_filtered_rod: num(o, "use_qhat") != 0.0,
        ignores_disturbance: num(o, "comp_b") == 0.0,
        dt: num(o, "dt"),
        substeps: num(o, "nsub") as u32,
        duration: num(o, "t_end"),
        settled: 20.0,
    }
}

/// Runs with random numbers in them compare as statistics: other numbers, the same process.
fn is_random(o: &Value) -> bool {
    o["case"] == "stoch" || ["sig_q", "sig_v", "sig_p"].iter().any(|key| num(o, key) > 0.0)
}

pub fn closed_loops(file: &Value) {
    for (name, c) in cases(file, "closed_loop") {
        let title = format!("{name} {}", c["name"]);
        if let Some(option) = not_understood(&c["options"]) {
            println!("{title}: not checked, {option}");
            continue;
        }
        let stats = &c["stats_after_20s"];
        if is_random(&c["options"]) {
            let ours: Vec<PendulumTrace> = (1..=6_u64)
                .map(|seed| {
                    let mut c = c.clone();
                    c["options"]["seed"] = seed.into();
                    run(&c).fly()
                })
                .collect();
            random_run(&title, &ours, stats);
        } else {
            repeatable_run(&title, &run(c).fly(), c);
        }
    }
}

/// One recorded run against the mean of six of ours. Over 40 seeds the mean error of a run lies between
/// 0.75 and 1.3 of its own mean; half to twice leaves room for both.
fn random_run(title: &str, ours: &[PendulumTrace], stats: &Value) {
    let mean =
        |pick: fn(&PendulumTrace) -> f64| ours.iter().map(pick).sum::<f64>() / ours.len() as f64;
    let alike = |what: &str, ours: f64, theirs: f64| {
        println!("{title} {what}: {ours:.3}, reference {theirs:.3}");
        assert!((0.5..2.0).contains(&(ours / theirs)), "{title} {what}: {ours} for {theirs}");
    };
    alike("mean error", mean(|t| t.summary.error_mean), num(stats, "zp_mean"));
    alike("rod rate error", mean(|t| t.summary.rod_rate_rms), num(stats, "w_rms"));
    alike("disturbance error", mean(|t| t.summary.across_rms), num(stats, "bxy_rms"));
}

/// The specification: samples from 5 s on to 5 % + 1 mm, not earlier.
fn repeatable_run(title: &str, trace: &PendulumTrace, c: &Value) {
    let stats = &c["stats_after_20s"];
    assert_eq!(!trace.summary.is_lost(), stats["ok"].as_bool().unwrap(), "{title}");
    if trace.summary.is_lost() {
        return;
    }
    for sample in c["samples"].as_array().into_iter().flatten() {
        let time = num(sample, "t");
        if time < 5.0 {
            continue;
        }
        let at = (time / num(&c["options"], "dt")).round() as usize;
        let row = &trace.rows[at];
        let near = |what: &str, ours: &[f64], theirs: Vec<f64>, slack: f64| {
            let size = SVector::<f64, 3>::from_column_slice(&theirs).norm();
            for (ours, theirs) in ours.iter().zip(&theirs) {
                let off = (ours - theirs).abs();
                assert!(off <= 0.05 * size + slack, "{title} {what} at {time} s: off by {off}");
            }
        };
        near("error", row.error().as_slice(), list(sample, "z_p"), 1e-3);
        near("disturbance", row.estimated_disturbance.as_slice(), list(sample, "b_hat"), 1e-3);
        let thrust = num(sample, "T");
        assert!((row.thrust - thrust).abs() <= 0.05 * thrust, "{title} thrust at {time} s");
    }
    let near = |what: &str, ours: f64, theirs: f64, slack: f64| {
        println!("{title} {what}: {ours:.6}, reference {theirs:.6}");
        assert!((ours - theirs).abs() <= 0.05 * theirs.abs() + slack, "{title} {what}");
    };
    near("mean error", trace.summary.error_mean, num(stats, "zp_mean"), 1e-3);
    near("largest tilt", trace.summary.tilt_peak.to_degrees(), num(stats, "tilt_max_all"), 0.5);
    near("largest thrust", trace.summary.thrust_peak, num(stats, "T_max_all"), 0.05);
    near("largest rate", trace.summary.rate_peak, num(stats, "O_max_all"), 0.05);
}
