//! `fullstate.json`: the blocks of the flight core.

use super::{Check, cases, list, num, rotation, s, vec3};
use serde_json::Value;
use tautline_firmware::control::{
    AttitudeLoop, Mixer, PositionInput, PositionLoop, PositionState, Priority, RadialControl,
    RateLoop, RateSetpoint, RateState,
};
use tautline_firmware::estimate::{Ekf4, Ekf4Measurement, Ekf4State, Mahony, MahonyState};
use tautline_firmware::frames::{Body, M3, V3, World};
use tautline_firmware::model::Line;
use tautline_firmware::param::Params;
use tautline_firmware::scalar::Scalar;
use tautline_firmware::signal::{MixerReport, Wrench};

/// Groups of the blocks around the filter.
pub const GROUPS: [&str; 6] = ["mahony", "ekf4", "outer", "attitude_cmd", "rate_loop", "mixer"];

fn row_major<S: Scalar>(m: &M3<S>) -> Vec<S> {
    m.transpose().iter().copied().collect()
}

pub fn check_mahony<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "mahony") {
        let filter = Mahony::<S> { kp: s(c, "kp"), ki: s(c, "ki") };
        let mut state = MahonyState::new(rotation(c, "R"), Body(vec3(c, "b")));
        filter.step(&mut state, &Body(vec3(c, "gyro")), &Body(vec3(c, "acc")), s(c, "dt")).unwrap();
        check.all(&name, row_major(&state.attitude.0), list(c, "Rout"));
        check.all(&name, state.gyro_bias.0.iter().copied(), list(c, "bout"));
    }
}

pub fn check_ekf4<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "ekf4") {
        let filter = Ekf4::<S> {
            mass: s(c, "m"),
            // The vectors are of a line without weight.
            line: Line(S::zero()),
            q_position: s(c, "q"),
            q_tension: s(c, "qf"),
            r_accel: s(c, "ra2"),
            r_altitude: s(c, "rh"),
            r_length: s(c, "rl"),
        };
        let x = list(c, "x");
        let rows = |key: &str| -> Vec<f64> {
            c[key]
                .as_array()
                .unwrap()
                .iter()
                .flat_map(|row| row.as_array().unwrap())
                .map(|v| v.as_f64().unwrap())
                .collect()
        };
        let p = rows("P");
        let mut state = Ekf4State::<S> {
            x: nalgebra::Vector4::from_fn(|i, _| S::lit(x[i])),
            covariance: nalgebra::Matrix4::from_fn(|r, k| S::lit(p[4 * r + k])),
        };
        let flag = |key: &str| c[key].as_bool().unwrap();
        let z = Ekf4Measurement {
            attitude: rotation(c, "R"),
            accel: Body(vec3(c, "acc")),
            thrust: s(c, "T"),
            altitude: flag("has_alt").then(|| s(c, "alt")),
            length: flag("has_len").then(|| s(c, "length")),
        };
        filter.step(&mut state, &z).unwrap();
        check.all(&name, state.x.iter().copied(), list(c, "xo"));
        check.all(&name, state.covariance.transpose().iter().copied(), rows("Po"));
    }
}

pub fn check_outer<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let (ctl, est) = (&file["meta"]["ctl"], &file["meta"]["est"]);
    let controller = PositionLoop::<S> {
        mass: s(est, "m"),
        line: Line(s::<S>(est, "mu") * S::lit(tautline_firmware::math::GRAVITY)),
        kp: s(ctl, "kp"),
        kd: s(ctl, "kd"),
        ki: s(ctl, "ki"),
        integral_max: s(ctl, "imax"),
        radial_integral_max: S::zero(),
        accel_max: s(ctl, "amax"),
        radial_p: s(ctl, "kpr"),
        radial_d: s(ctl, "kdr"),
        brake: s(ctl, "kbr"),
        wind_feed_forward: s(ctl, "wff"),
        tension_min: s(ctl, "fmin"),
        tension_max: s(ctl, "fmax"),
        thrust_min: s(ctl, "Tmin"),
        thrust_max: s(ctl, "Tmax"),
        tan_tilt_max: S::lit(num(ctl, "tilt").tan()),
    };
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "outer") {
        let is_winch = num(c, "mode") > 0.5;
        let mut state = PositionState { integral: World(vec3(c, "I")), ..PositionState::default() };
        let input = PositionInput {
            position: World(vec3(c, "p")),
            velocity: World(vec3(c, "v")),
            wind: World(vec3(c, "w")),
            direction: World(vec3(c, "uref")),
            reference_velocity: World(vec3(c, "vref")),
            length: s(c, "lref"),
            length_rate: s(c, "ldref"),
            tension: if is_winch { s(c, "fc") } else { s(c, "fref") },
            radial_control: if is_winch {
                RadialControl::Winch
            } else {
                RadialControl::FixedLength
            },
            hold_integral: false,
        };
        let out = controller.step(&mut state, &input, s(c, "dt"));
        check.all(&name, out.force.0.iter().copied(), list(c, "F"));
        check.all(&name, state.integral.0.iter().copied(), list(c, "Iout"));
        assert_eq!(out.is_guarded, num(c, "guard") != 0.0, "{name}: guard");
    }
}

pub fn check_attitude<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let ctl = &file["meta"]["ctl"];
    let controller = AttitudeLoop::<S> {
        tilt_gain: s(ctl, "kR"),
        yaw_gain: s(ctl, "kyaw"),
        // fullstate section 11.
        tilt_rate_max: S::lit(4.0),
        yaw_rate_max: S::lit(1.0),
        thrust_min: s(ctl, "Tmin"),
    };
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "attitude_cmd") {
        let out = controller.step(&World(vec3(c, "F")), &rotation(c, "R"), s(c, "yaw"));
        check.all(&name, out.rate.0.iter().copied(), list(c, "rate"));
        check.near(&name, out.thrust, num(c, "T"));
    }
}

pub fn check_rate<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let ctl = &file["meta"]["ctl"];
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "rate_loop") {
        let controller = RateLoop::<S> {
            inertia: vec3(c, "J"),
            kp: s(ctl, "kw"),
            ki: s(ctl, "kwi"),
            kd: S::zero(),
            derivative_share: S::one(),
            // fullstate section 11.
            integral_max: S::lit(20.0),
            attachment: s(c, "ra"),
        };
        let mut state = RateState::holding(Body(vec3(c, "Iw")));
        let rate = Body(vec3(c, "gyro"));
        let wanted = RateSetpoint { rate: Body(vec3(c, "rate_cmd")), accel: Body(V3::zeros()) };
        let pull = Body(vec3(c, "f_tether_body"));
        let torque =
            controller.step(&mut state, &wanted, &rate, &pull, MixerReport::default(), s(c, "dt"));
        check.all(&name, torque.0.iter().copied(), list(c, "tau"));
        check.all(&name, state.integral.0.iter().copied(), list(c, "Iw_out"));
    }
}

pub fn check_mixer<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "mixer") {
        let mut mixer = Mixer::<S>::new(&Params::default());
        (mixer.arm, mixer.torque_ratio) = (s(c, "arm"), s(c, "cq"));
        // fullstate section 11.
        (mixer.min, mixer.max) = (S::lit(0.05), s(c, "fmax"));
        mixer.priority = Priority::Clip;
        let wrench = Wrench { thrust: s(c, "T"), torque: Body(vec3(c, "tau")) };
        let mut thrusts = mixer.each(S::zero());
        let report = mixer.step(&wrench, &mut thrusts);
        check.all(&name, thrusts.iter().copied(), list(c, "f"));
        // Where nothing is at its limit, the priority makes no difference.
        if !report.thrust_is_saturated {
            mixer.priority = Priority::TiltFirst;
            mixer.step(&wrench, &mut thrusts);
            check.all(&name, thrusts.iter().copied(), list(c, "f"));
        }
    }
}
