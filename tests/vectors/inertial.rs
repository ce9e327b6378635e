//! `inertial.json`: algebra, single steps and the recorded run; the random experiments beside.

use super::{Check, cases, list, num, s, vec3};
use serde_json::Value;
use tautline_firmware::control::{TetherAngleLoop, attachment_compensation};
use tautline_firmware::estimate::tether_angle::{
    NotLocated, Posterior, TetherAngleState, TetherAngleUkf, TiltFrame, UkfStage, locate,
};
use tautline_firmware::frames::M3;
use tautline_firmware::math::wrap_pi;
use tautline_firmware::model::{TetherAngle, TetherAngleModel, TiltImu};
use tautline_firmware::scalar::Scalar;

/// Groups checked here in both scalars.
pub const SINGLE: [&str; 8] = [
    "model",
    "equilibrium_thv",
    "minimal_localise",
    "controller",
    "torque_comp",
    "ukf_single",
    "ukf_run",
    "projection_3d",
];

fn optional<S: Scalar>(v: &Value, key: &str) -> S {
    v[key].as_f64().map_or(S::lit(f64::NAN), S::lit)
}

fn model<S: Scalar>(v: &Value) -> TetherAngleModel<S> {
    let length = v.get("l").and_then(Value::as_f64).unwrap_or(1.0);
    let thrust = v.get("Fp").or(v.get("Fp_cmd")).unwrap().as_f64().unwrap();
    TetherAngleModel::try_new(S::lit(thrust), S::lit(length)).unwrap()
}

fn posterior<S: Scalar>(v: &Value) -> Posterior<S> {
    Posterior { x: triple(v, "x"), covariance: matrix(v, "P") }
}

fn triple<S: Scalar>(v: &Value, key: &str) -> TetherAngle<S> {
    let x = vec3::<S>(v, key);
    TetherAngle { angle: x.x, rate: x.y, tilt: x.z }
}

fn array<S>(x: TetherAngle<S>) -> [S; 3] {
    [x.angle, x.rate, x.tilt]
}

fn flat(v: &Value, key: &str) -> Vec<f64> {
    let rows = v[key].as_array().unwrap();
    rows.iter().flat_map(|row| row.as_array().unwrap()).map(|x| x.as_f64().unwrap()).collect()
}

fn matrix<S: Scalar>(v: &Value, key: &str) -> M3<S> {
    M3::from_row_slice(&flat(v, key).into_iter().map(S::lit).collect::<Vec<_>>())
}

fn row_major<S: Scalar>(m: &M3<S>) -> Vec<S> {
    m.transpose().iter().copied().collect()
}

pub fn singles<S: Scalar + Into<f64>>(file: &Value, bound: f64, run_bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "model") {
        let i = &c["in"];
        let m = model::<S>(i);
        let x = TetherAngle { angle: s(i, "ths"), rate: s(i, "dths"), tilt: s(i, "thv") };
        let anchor = [S::lit(list(i, "A")[0]), S::lit(list(i, "A")[1])];
        let rest = [S::zero(); 2];
        let tension = m.tension(&x, rest);
        check.near(&name, tension, num(c, "tension_fixed_anchor"));
        check.near(&name, m.angular_accel(&x, rest), num(c, "ddths_fixed_anchor"));
        check.all(&name, m.specific_force(&x, tension), list(c, "accel_fixed_anchor"));
        check.near(&name, m.tension(&x, anchor), num(c, "tension_moving"));
        check.near(&name, m.angular_accel(&x, anchor), num(c, "ddths_moving"));
    }
    for (name, c) in cases(file, "equilibrium_thv") {
        let tilt = model::<S>(&c["in"]).equilibrium_tilt(s(&c["in"], "ths"));
        assert_eq!(tilt.is_some(), c["out"].is_number(), "{name}");
        if let Some(tilt) = tilt {
            check.near(&name, tilt, num(c, "out"));
        }
    }
    for (name, c) in cases(file, "minimal_localise") {
        minimal::<S>(&mut check, &name, c);
    }
    for (name, c) in cases(file, "controller") {
        let (i, out) = (&c["in"], &c["out"]);
        let law = TetherAngleLoop::<S> {
            tether_time: s(i, "tau_s"),
            tether_damping: s(i, "zeta_s"),
            tilt_time: s(i, "tau_v"),
            tension_min: i["F_min"].as_f64().map(S::lit),
            // The reference leaves the saturation to its caller.
            rate_max: S::lit(1e3),
        };
        let x = TetherAngle { angle: s(i, "ths"), rate: s(i, "dths"), tilt: s(i, "thv") };
        let command = law.step(&model(i), s(i, "ths_ref"), &x);
        check.near(&name, command.accel, num(out, "ddths_des"));
        check.near(&name, command.tilt, num(out, "thv_des"));
        check.near(&name, command.rate, num(out, "rate_cmd"));
    }
    for (name, c) in cases(file, "torque_comp") {
        let i = &c["in"];
        let m = TetherAngleModel::try_new(S::one(), S::one()).unwrap();
        let x = TetherAngle { angle: s(i, "ths"), rate: S::zero(), tilt: s(i, "thv") };
        let [force_x, _] = m.specific_force(&x, s(i, "Fs"));
        check.near(&name, attachment_compensation(s(i, "d"), s(i, "gam"), force_x), num(c, "out"));
    }
    for (name, c) in cases(file, "projection_3d") {
        projection::<S>(&mut check, &name, c);
    }
    for (name, c) in cases(file, "ukf_single") {
        let i = &c["in"];
        let ukf = TetherAngleUkf { sigma: s(i, "sigma_p"), ..at_80_hz::<S>() };
        let (m, before) = (model(i), posterior(i));
        check.all(&name, array(m.advance(&before.x, s(i, "gyro"), ukf.dt)), list(c, "rk4_of_x"));
        check.all(&name, ukf.noise_gain(&m, &before.x).iter().copied(), list(c, "Gamma"));
        let ahead = ukf.predict(&m, &before, s(i, "gyro"));
        check.all(&name, array(ahead.x), list(c, "x_pred"));
        check.all(&name, row_major(&ahead.covariance), flat(c, "P_pred"));
        let z = list(c, "z");
        let after = ukf.correct(&m, &ahead, [S::lit(z[0]), S::lit(z[1])]);
        check.all(&name, after.innovation.iter().copied(), list(c, "innov"));
        check.all(&name, after.innovation_covariance.iter().copied(), flat(c, "S"));
        check.all(&name, array(after.posterior.x), list(c, "x_upd"));
        check.all(&name, row_major(&after.posterior.covariance), flat(c, "P_upd"));
    }
    if let Some(run) = file.get("ukf_run") {
        recorded::<S>(run, run_bound);
    }
}

fn at_80_hz<S: Scalar>() -> TetherAngleUkf<S> {
    TetherAngleUkf::try_new(S::lit(1.0 / 80.0)).unwrap()
}

fn minimal<S: Scalar + Into<f64>>(check: &mut Check, name: &str, c: &Value) {
    let (i, out) = (&c["in"], &c["out"]);
    let rate = if i["l"].is_null() { S::zero() } else { s(i, "dths") };
    let force = [optional(i, "ax"), optional(i, "az")];
    let found = locate(&model::<S>(i), force, rate, optional(i, "thv_prior"), s(i, "eps"));
    let mut is = |status: &str, tension: Option<S>| {
        assert_eq!(out["status"], status, "{name}: {found:?}");
        if let Some(tension) = tension {
            check.near(name, tension, num(out, "Fs"));
        }
    };
    match found {
        Ok(at) => {
            is("ok", Some(at.tension));
            check.near(name, at.angle, num(out, "ths"));
            check.near(name, wrap_pi(at.tilt.into() - num(out, "thv")), 0.0);
        }
        Err(NotLocated::NotFinite) => is("nan", None),
        Err(NotLocated::Slack(tension)) => is("slack", Some(tension)),
        Err(NotLocated::OutOfRange(tension)) => is("range", Some(tension)),
    }
}

fn projection<S: Scalar + Into<f64>>(check: &mut Check, name: &str, c: &Value) {
    let i = &c["in"];
    let tilts = [s(i, "thv_x"), s(i, "thv_y")];
    let frame = TiltFrame::<S>::new(tilts[0], tilts[1], s(i, "yaw"));
    check.all(name, frame.thrust_axis().iter().copied(), list(c, "zb"));
    check.all(name, row_major(&frame.rotation), flat(c, "R_body_to_world"));
    check.all(name, frame.tilt_rates(&vec3(i, "gyro_body")), list(c, "planar_rates"));
    let [xz, yz] = frame.planar_forces(&vec3(i, "accel_body"), tilts);
    check.all(name, xz, list(c, "planar_accel_xz"));
    check.all(name, yz, list(c, "planar_accel_yz"));
    let rates = list(i, "cmd_rates");
    let asked = frame.body_rate([S::lit(rates[0]), S::lit(rates[1])]);
    check.all(name, asked.iter().copied(), list(c, "body_rate_cmd"));
}

fn recorded<S: Scalar + Into<f64>>(run: &Value, bound: f64) {
    let mut check = Check::new(bound);
    let noise = flat(run, "R");
    let ukf = TetherAngleUkf {
        sigma: s(run, "sigma_p"),
        accel_noise: [S::lit(noise[0]), S::lit(noise[1]), S::lit(noise[3])],
        tension_floor: s(run, "eps"),
        slack_max: s(run, "max_slack_s"),
        ..at_80_hz::<S>()
    };
    let m = model(run);
    let mut state = TetherAngleState::with_prior(s(run, "thv_prior_for_init"));
    for (name, step) in cases(run, "steps") {
        let imu = TiltImu {
            x: optional(step, "ax"),
            z: optional(step, "az"),
            rate: optional(step, "gyro"),
        };
        ukf.step(&m, &mut state, &imu);
        let mode = match state.mode {
            UkfStage::Uninitialised => "uninit",
            UkfStage::Started => "init",
            UkfStage::Updated => "update",
            UkfStage::DeadReckoning => "dead",
            UkfStage::Lost => "lost",
        };
        assert_eq!(step["mode"], mode, "{name}");
        // Before the first start the reference has no estimate.
        if step["x"].is_array() {
            check.all(&name, array(state.posterior.x), list(step, "x"));
            let diagonal = state.posterior.covariance.diagonal();
            check.all(&name, diagonal.iter().copied(), list(step, "Pdiag"));
        }
    }
}
