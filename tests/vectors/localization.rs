//! `localization.json`: measurement model, static solution, filters and recorded runs.

use super::{Check, cases, list, num, s, vec3};
use serde_json::Value;
use tautline_firmware::estimate::localization::{
    ErrorState, ErrorStateFilter, ErrorStateMeasurement, ErrorStateNoise, LowPassLocator,
    LowPassState, NoiseReading, NotSolved, STATES, article_ekf, article_start, cable_pull,
    solve_static,
};
use tautline_firmware::estimate::{Ekf4Measurement, Ekf4State, cable_jacobian, cable_reading};
use tautline_firmware::frames::{Attitude, Body, V3, World};
use tautline_firmware::math::GRAVITY;
use tautline_firmware::scalar::Scalar;

/// Groups checked here in both scalars.
pub const SINGLE: [&str; 6] = [
    "rotation_Rvb",
    "specific_force_g",
    "h_and_jacobian",
    "static_solve",
    "ekf_single",
    "short_run",
];

pub fn number<S: Scalar>(v: &Value) -> S {
    S::lit(v.as_f64().unwrap_or(f64::NAN))
}

pub fn vector<S: Scalar>(v: &Value) -> V3<S> {
    V3::from_fn(|i, _| number(&v[i]))
}

pub fn attitude<S: Scalar>(v: &Value) -> Attitude<S> {
    Attitude::from_euler(number(&v[0]), number(&v[1]), number(&v[2]))
}

/// Specific force given over g.
pub fn reading<S: Scalar>(acc_g: &Value, euler: &Value, thrust: &Value) -> Ekf4Measurement<S> {
    Ekf4Measurement {
        attitude: attitude(euler),
        accel: Body(vector::<S>(acc_g) * S::lit(GRAVITY)),
        thrust: number(thrust),
        altitude: None,
        length: None,
    }
}

pub fn singles<S: Scalar + Into<f64>>(file: &Value, bound: f64, run_bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "rotation_Rvb") {
        let i = &c["in"];
        let r = Attitude::<S>::from_euler(s(i, "phi"), s(i, "theta"), s(i, "psi"));
        // World to body, row by row: the columns of body to world.
        let want = c["out"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
        check.all(&name, r.0.iter().copied(), want.map(|x| x.as_f64().unwrap()).collect());
    }
    for group in ["specific_force_g", "h_and_jacobian"] {
        for (name, c) in cases(file, group) {
            measurement_model::<S>(&mut check, &name, c, group == "h_and_jacobian");
        }
    }
    for (name, c) in cases(file, "static_solve") {
        let i = &c["in"];
        let z = reading::<S>(&i["acc_g"], &i["euler"], &i["thrust"]);
        let altitude = i["alt"].as_f64().map(S::lit);
        let status = match solve_static(&cable_pull(s(i, "m"), &z), altitude) {
            Ok(at) => {
                check.all(&name, at.position.0.iter().copied(), list(c, "p"));
                check.near(&name, at.tension, num(c, "fc"));
                "ok"
            }
            Err(NotSolved::NotFinite) => "nan",
            Err(NotSolved::Slack) => "slack",
            Err(NotSolved::Low) => "low",
            Err(NotSolved::OutOfRange) => "range",
        };
        assert_eq!(c["status"], status, "{name}");
    }
    for (name, c) in cases(file, "ekf_single") {
        let i = &c["in"];
        let mut ekf = article_ekf::<S>(s(i, "m"), NoiseReading::PerStep, false);
        (ekf.q_position, ekf.q_tension) = (s(i, "Q"), s(i, "Q"));
        let r = list(i, "Rdiag");
        let one = r[..3].iter().all(|x| (x - r[0]).abs() < 1e-12);
        assert!(one, "one variance for the accelerometer");
        (ekf.r_accel, ekf.r_altitude) = (S::lit(r[0]), S::lit(r[3]));
        let z = Ekf4Measurement {
            altitude: i["z"][3].as_f64().map(S::lit),
            ..reading(&i["z"], &i["euler"], &i["thrust"])
        };
        let x = list(i, "x");
        let p = i["P"].as_array().unwrap();
        let mut state = Ekf4State {
            x: nalgebra::Vector4::from_fn(|r, _| S::lit(x[r])),
            covariance: nalgebra::Matrix4::from_fn(|r, k| number(&p[r][k])),
        };
        ekf.step(&mut state, &z).unwrap();
        check.all(&name, state.x.iter().copied(), list(c, "x_upd"));
        check.all(&name, state.covariance.diagonal().iter().copied(), list(c, "Pdiag_upd"));
    }
    if let Some(run) = file.get("short_run") {
        short_run::<S>(run, run_bound);
    }
}

fn measurement_model<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    c: &Value,
    with_jacobian: bool,
) {
    let i = &c["in"];
    let p = vec3::<S>(i, "p");
    let fc = s::<S>(i, "fc");
    let weight = s::<S>(i, "m") * S::lit(GRAVITY);
    let euler = attitude::<S>(&i["euler"]);
    let h = |p: V3<S>, fc: S| cable_reading(&euler, p, fc, s(i, "thrust"), weight);
    let want = if with_jacobian { list(c, "h")[..3].to_vec() } else { list(c, "out") };
    check.all(name, h(p, fc).iter().copied(), want);
    if !with_jacobian {
        return;
    }
    let jacobian = cable_jacobian(&euler, p, fc, weight);
    for (row, got) in c["H4"].as_array().unwrap().iter().zip(&jacobian) {
        let want = row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        check.all(name, got.iter().copied(), want);
    }
}

fn short_run<S: Scalar + Into<f64>>(run: &Value, bound: f64) {
    let mut check = Check::new(bound);
    let (mass, dt) = (s::<S>(run, "m"), num(run, "dt"));
    let inputs = &run["inputs"];
    let sample = |k: usize| ErrorStateMeasurement::<S> {
        cable: Ekf4Measurement {
            altitude: inputs["alt"][k].as_f64().map(S::lit),
            length: inputs["length"][k].as_f64().map(S::lit),
            ..reading(&inputs["acc_g"][k], &inputs["euler"][k], &inputs["thrust"][k])
        },
        gyro: Body(vector(&inputs["gyro"][k])),
    };
    let rows: Vec<usize> =
        run["rows"].as_array().unwrap().iter().map(|r| r.as_u64().unwrap() as usize).collect();
    let tension = s::<S>(run, "fc_true");
    let ekf3 = article_ekf(mass, NoiseReading::PerStep, true);
    let ekf4 = article_ekf(mass, NoiseReading::PerStep, false);
    let mut three = article_start(Some(tension));
    let mut four = article_start(None);
    let low_pass = LowPassLocator::new(mass, dt as f32);
    let mut low = LowPassState::default();
    let noise = ErrorStateNoise::simulated();
    let filter = ErrorStateFilter { mass, dt: S::lit(dt), noise };
    let init = &run["eskf_init"];
    let deviations = list(init, "Pdiag");
    let with_length = init["use_length"].as_bool().unwrap();
    let mut eskf = ErrorState {
        position: World(vec3(init, "p0")),
        velocity: World(vec3(init, "v0")),
        attitude: sample(0).cable.attitude,
        tension: s(init, "fc0"),
        thrust_scale: S::one(),
        accel_bias: Body(V3::zeros()),
        gyro_bias: Body(V3::zeros()),
        covariance: nalgebra::SMatrix::from_fn(|r, k| {
            if r == k { S::lit(deviations[r]) } else { S::zero() }
        }),
    };
    for k in 0..inputs["acc_g"].as_array().unwrap().len() {
        let z = sample(k);
        // The article's filters measure no length.
        let cable = Ekf4Measurement { length: None, ..z.cable };
        ekf3.step(&mut three, &cable).unwrap();
        ekf4.step(&mut four, &cable).unwrap();
        let _ = low_pass.step(&mut low, &cable);
        let z = if with_length { z } else { ErrorStateMeasurement { cable, ..z } };
        let step = filter.correct(&mut eskf, &z).unwrap();
        if let Some(row) = rows.iter().position(|r| *r == k) {
            let name = format!("short_run row {k}");
            let at = |key: &str| -> Vec<f64> {
                run[key][row].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
            };
            check.all(&name, three.x.iter().copied().take(3), at("ekf3_x"));
            check.all(&name, four.x.iter().copied(), at("ekf4_x"));
            check.all(&name, four.covariance.diagonal().iter().copied(), at("ekf4_Pdiag"));
            let solution = low.solution.unwrap();
            let got = solution.position.0.iter().copied().chain([solution.tension]);
            check.all(&name, got, at("lpf_p_fc"));
            let got = eskf.position.0.iter().chain(eskf.velocity.0.iter()).copied();
            let got = got.chain([eskf.tension, eskf.thrust_scale]);
            let got = got.chain(eskf.accel_bias.0.iter().copied());
            check.all(&format!("{name} eskf"), got, at("eskf_p_v_fc_kT_ba"));
            check.all(
                &format!("{name} eskf sd"),
                (0..STATES).map(|i| eskf.deviation(i)),
                at("eskf_sd"),
            );
        }
        filter.predict(&mut eskf, &z, &step);
    }
}
