//! `pendulum.json`: filter, references, law and single steps of the plant.

use super::{Check, cases, list, num, s, vec3};
use nalgebra::SMatrix;
use serde_json::Value;
use tautline_firmware::control::pendulum::{
    PendulumControl, PendulumGains, PendulumLimits, PendulumMemory,
    body_rate::{cross_term, rate_wanted_by_velocity},
    force_rate::ForceRate,
    guidance::Guidance,
};
use tautline_firmware::estimate::pendulum::{
    PendulumCovariance, PendulumEstimate, PendulumFilter, PendulumNoise, PendulumPosterior,
    VerticalDisturbance, VerticalDisturbanceState,
};
use tautline_firmware::frames::{V3, World};
use tautline_firmware::math::so3::{self, dot};
use tautline_firmware::model::PendulumModel;
use tautline_firmware::scalar::Scalar;
use tautline_firmware::signal::LoadReference;
use tautline_firmware::trajectory::load::{SoftStart, TiltedCircle};

/// Bounds for f64 or f32 of the specification: values, thrust, body rates, filter, covariance.
#[derive(Clone, Copy)]
pub struct Bounds {
    pub values: f64,
    pub thrust: f64,
    pub rate: f64,
    pub filter: f64,
    pub covariance: f64,
}

pub const DOUBLE: Bounds =
    Bounds { values: 1e-9, thrust: 1e-9, rate: 1e-9, filter: 1e-9, covariance: 1e-9 };
/// The specification bounds f32 for thrust, rates and filter only. A derivative of fifth order on the way
/// to them carries the rounding of the reference's; 1e-3 of its size is ten times the largest seen.
pub const SINGLE: Bounds =
    Bounds { values: 1e-3, thrust: 1e-4, rate: 1e-3, filter: 1e-4, covariance: 1e-3 };

pub const GROUPS: [&str; 9] = [
    "controller",
    "controller_saturated",
    "kf_step",
    "kf_sequence",
    "reference",
    "soft_start",
    "plant_step",
    "e1_step",
    "closed_loop",
];

pub fn model<S: Scalar>(par: &Value) -> PendulumModel<S> {
    PendulumModel::try_new(s(par, "mQ"), s(par, "mL"), s(par, "l"))
        .and_then(|model| model.with_gravity(s(par, "g")))
        .unwrap()
}

pub fn gains<S: Scalar>(par: &Value) -> PendulumGains<S> {
    let three = |key: &str| V3::from_fn(|i, _| s(par, &format!("{key}{i}")));
    PendulumGains {
        position: three("kp"),
        velocity: three("kv"),
        coupling: s(par, "beta"),
        rod: s(par, "kq"),
        rate: s(par, "kw"),
        attitude: s(par, "kr"),
        rod_weight: s(par, "hq"),
        rate_weight: s(par, "hw"),
        attitude_weight: s(par, "hr"),
    }
}

fn three<S: Scalar>(list: &[f64]) -> V3<S> {
    V3::new(S::lit(list[0]), S::lit(list[1]), S::lit(list[2]))
}

fn reference<S: Scalar>(rows: &Value) -> LoadReference<S> {
    let mut out = LoadReference::at_rest(World(V3::zeros()));
    for (d, row) in out.0.iter_mut().zip(rows.as_array().unwrap()) {
        let row: Vec<f64> = row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        *d = three(&row);
    }
    out
}

fn rows(v: &Value) -> Vec<f64> {
    v.as_array()
        .unwrap()
        .iter()
        .flat_map(|row| row.as_array().unwrap())
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn nested<S: Scalar>(v: &Value) -> SMatrix<S, 9, 9> {
    SMatrix::from_row_iterator(rows(v).into_iter().map(S::lit))
}

fn norm2<S: Scalar>(v: &V3<S>) -> S {
    dot(v, v)
}

/// Largest element of a list, at least 1: a derivative is judged by its own size.
fn size(list: &[f64]) -> f64 {
    list.iter().fold(1.0, |most: f64, x| most.max(x.abs()))
}

struct Terms<'a> {
    out: &'a Value,
    name: &'a str,
    check: Check,
}

impl Terms<'_> {
    fn vector<S: Scalar + Into<f64>>(&mut self, key: &str, got: &V3<S>) {
        let want = list(self.out, key);
        let size = size(&want);
        for (got, want) in got.iter().zip(&want) {
            let got: f64 = (*got).into();
            self.check.near(&format!("{} {key}", self.name), got / size, want / size);
        }
    }
    fn number<S: Scalar + Into<f64>>(&mut self, key: &str, got: S) {
        self.check.near(&format!("{} {key}", self.name), got, num(self.out, key));
    }
}

pub fn law<S: Scalar + Into<f64>>(file: &Value, bounds: Bounds) {
    for group in ["controller", "controller_saturated"] {
        for (name, c) in cases(file, group) {
            one_law::<S>(&name, c, bounds);
        }
    }
}

fn one_law<S: Scalar + Into<f64>>(name: &str, c: &Value, bounds: Bounds) {
    let (gains, model) = (gains::<S>(&c["par"]), model::<S>(&c["par"]));
    let limits = PendulumLimits {
        thrust_min: s(&c["limits"], "Tmin"),
        thrust_max: s(&c["limits"], "Tmax"),
        rate_max: s(&c["limits"], "Omax"),
        pull_share: None,
    };
    let x = PendulumEstimate {
        position: World(vec3::<S>(c, "p")),
        velocity: World(vec3(c, "v")),
        rod: World(vec3(c, "q")),
        rod_rate: World(vec3(c, "omega")),
        disturbance: World(vec3(c, "b")),
    };
    let rotation_rows = rows(&c["R"]);
    let attitude = tautline_firmware::frames::Attitude(
        tautline_firmware::frames::M3::from_row_iterator(rotation_rows.iter().map(|x| S::lit(*x))),
    );
    let reference = reference::<S>(&c["D"]);
    let out = &c["out"];
    let mut t = Terms { out, name, check: Check::new(bounds.values) };

    let at = Guidance::at(&gains, &model, &x, &reference);
    t.vector("z_p", &at.position_error);
    t.vector("z_v", &at.velocity_error);
    t.vector("u", &at.pull);
    t.vector("xi", &(at.pull * model.total_mass()));
    t.number("n", at.magnitude);
    t.vector("q_d", &at.rod_wanted);
    t.vector("z_q", &(x.rod.0 - at.rod_wanted));
    t.vector("a_star", &at.accel);
    t.vector("w", &at.pull_rate);
    t.vector("omega_d", &at.rate_wanted);
    t.number("nu", at.growth);
    t.vector("w_dot_star", &at.pull_accel);
    t.vector("omega_d_dot_star", &at.rate_wanted_dot);
    t.vector("z_omega", &at.rate_error);
    t.vector("z_omega_dot_star", &at.rate_error_dot);
    t.vector("E", &at.turn);
    t.vector("f_par", &(x.rod.0 * at.force_along));
    t.vector("f_perp", &at.force_across);
    t.vector("f_d", &at.force);
    let wanted = so3::norm(&at.force);
    t.number("T_d", wanted);

    let control = PendulumControl::try_new(gains, model, limits).unwrap();
    let mut memory = PendulumMemory::default();
    let command = control.step(&mut memory, &x, &attitude, &reference).unwrap();
    Check::new(bounds.thrust).near(&format!("{name} T"), command.thrust, num(out, "T"));
    let rate_bound = bounds.rate * size(&list(out, "Omega"));
    Check::new(rate_bound).all(
        &format!("{name} Omega"),
        command.rate.0.iter().copied(),
        list(out, "Omega"),
    );
    t.vector("r3d", &command.down);

    let actual = so3::col_z(&attitude.0);
    let applied = actual * -command.thrust;
    let change = ForceRate::at(&gains, &model, &x, &reference, &at, &applied);
    t.vector("vL_dot", &change.load_accel);
    t.vector("omega_dot", &change.rod_accel);
    t.vector("f_d_dot", &change.force);
    t.vector("r3d_dot", &change.down_wanted(&command.down, wanted));
    t.vector("delta", &cross_term(&gains, &x.rod.0, &at));
    let by_velocity = rate_wanted_by_velocity(&gains, &x.rod.0, &at);
    t.check.all(name, by_velocity.transpose().iter().copied(), rows(&out["domega_d_dv"]));

    let (v4, v4_dot) = lyapunov(&gains, &x, &at, &actual, &command.down);
    t.number("V4", v4);
    if out["V4_dot_if_unsaturated"].is_number() {
        let want = num(out, "V4_dot_if_unsaturated");
        t.check.near(
            &format!("{name} V4_dot"),
            v4_dot.into() / size(&[want]),
            want / size(&[want]),
        );
    }
}

/// The last Lyapunov function (57) and, where the thrust is not cut, its derivative -W4 + Λ1 (58).
fn lyapunov<S: Scalar>(
    gains: &PendulumGains<S>,
    x: &PendulumEstimate<S>,
    at: &Guidance<S>,
    down: &V3<S>,
    down_wanted: &V3<S>,
) -> (S, S) {
    let (zp, zv, zw) = (&at.position_error, &at.velocity_error, &at.rate_error);
    let (kp, kv, beta) = (&gains.position, &gains.velocity, gains.coupling);
    let zq = x.rod.0 - at.rod_wanted;
    let zr = down - down_wanted;
    let half = S::lit(0.5);
    let v4 = half * (dot(zp, &kp.component_mul(zp)) + norm2(zv))
        + beta * dot(zp, zv)
        + half * gains.rod_weight * norm2(&zq)
        + half * gains.rate_weight * norm2(zw)
        + half * gains.attitude_weight * norm2(&zr);
    let across = so3::reject(&zq, &x.rod.0);
    let w1 = beta * dot(zp, &kp.component_mul(zp))
        + beta * dot(zp, &kv.component_mul(zv))
        + dot(zv, &kv.component_mul(zv))
        - beta * norm2(zv);
    let w4 = w1
        + gains.rod * norm2(&across)
        + gains.rate * norm2(zw)
        + gains.attitude * norm2(&so3::reject(&zr, down));
    let lambda = at.magnitude * dot(&(zp * beta + zv), &across);
    (v4, lambda - w4)
}

fn filter<S: Scalar>(c: &Value) -> PendulumFilter<S> {
    let process = list(c, "Qc");
    let reading = list(c, "Rc");
    let start = c.get("P0_diag").map_or(vec![1.0; 9], |_| list(c, "P0_diag"));
    let blocks = |x: &[f64]| [three(&x[..3]), three(&x[3..6]), three(&x[6..])];
    PendulumFilter {
        // Only their product counts here.
        model: PendulumModel::try_new(s(c, "mQl"), S::one(), S::one()).unwrap(),
        noise: PendulumNoise {
            process: blocks(&process),
            rod: three(&reading),
            spin: S::lit(reading[3]),
            start: blocks(&start),
        },
    }
}

fn state<S: Scalar + Into<f64>>(
    check: &mut Check,
    name: &str,
    x: &PendulumPosterior<S>,
    want: Vec<f64>,
) {
    check.all(name, [x.rod, x.rate, x.disturbance].iter().flatten().copied(), want);
}

pub fn filter_steps<S: Scalar + Into<f64>>(file: &Value, bounds: Bounds) {
    let mut states = Check::new(bounds.filter);
    let mut covariances = Check::new(bounds.covariance);
    for (name, c) in cases(file, "kf_step") {
        let filter = filter::<S>(c);
        let x = list(c, "x");
        let mut posterior = PendulumPosterior {
            rod: three(&x[..3]),
            rate: three(&x[3..6]),
            disturbance: three(&x[6..]),
            covariance: PendulumCovariance::from_dense(&nested(&c["P"])),
        };
        let dense = |x: &PendulumPosterior<S>| x.covariance.dense().transpose();
        let dt = s(c, "dt");
        filter.predict(&mut posterior, &vec3(c, "q_interval"), &vec3(c, "f_interval"), dt);
        state(&mut states, &name, &posterior, list(&c["out"], "x_pred"));
        covariances.all(&name, dense(&posterior).iter().copied(), rows(&c["out"]["P_pred"]));
        filter.update(&mut posterior, &vec3(c, "q_meas"), dt);
        state(&mut states, &name, &posterior, list(&c["out"], "x"));
        covariances.all(&name, dense(&posterior).iter().copied(), rows(&c["out"]["P"]));
    }
}

pub fn filter_sequence<S: Scalar + Into<f64>>(file: &Value, bound: f64, covariance: f64) {
    let mut states = Check::new(bound);
    let mut covariances = Check::new(covariance);
    for (name, c) in cases(file, "kf_sequence") {
        let filter = filter::<S>(c);
        let (phase, dt) = (num(c, "ph"), num(c, "dt"));
        let rod = |k: u64| {
            let t = k as f64 * dt;
            three::<S>(&[0.1 * (t + phase).sin(), 0.08 * (1.3 * t).cos(), -1.0])
        };
        let unit = |k: u64| so3::direction(&rod(k), S::zero()).unwrap().0;
        let force = |k: u64| {
            let t = k as f64 * dt;
            three::<S>(&[
                0.2 * (2.0 * t).sin(),
                0.15 * (1.7 * t + phase).cos(),
                -2.84 + 0.1 * (3.0 * t).sin(),
            ])
        };
        let mut posterior = filter.start(&unit(0));
        let step = S::lit(dt);
        filter.update(&mut posterior, &unit(0), step);
        for k in 1..=c["n"].as_u64().unwrap() {
            let between = (unit(k) + unit(k - 1)) * S::lit(0.5);
            filter.predict(&mut posterior, &between, &force(k - 1), step);
            filter.update(&mut posterior, &unit(k), step);
        }
        state(&mut states, &name, &posterior, list(c, "x"));
        let p = posterior.covariance.dense();
        covariances.all(&name, p.diagonal().iter().copied(), list(c, "P_diag"));
        for (key, at) in [("P_0_5", (0, 5)), ("P_3_7", (3, 7))] {
            if c.get(key).is_some() {
                covariances.near(&name, p[at], num(c, key));
            }
        }
    }
}

pub fn references<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "reference") {
        let circle = TiltedCircle::<S>::article(s(c, "V"));
        let angle = s(c, "theta");
        check.near(&name, circle.angular_speed(angle), num(c, "theta_dot"));
        let want = rows(&c["D"]);
        let got = circle.at(angle).0;
        for (got, want) in got.iter().zip(want.chunks(3)) {
            let size = size(want);
            let scaled = got.iter().map(|x| (*x).into() / size).collect::<Vec<f64>>();
            check.all(&name, scaled, want.iter().map(|x| x / size).collect());
        }
    }
    for (name, c) in cases(file, "soft_start") {
        let o = LoadReference::<S>::at_rest(World(V3::zeros()));
        let soft = SoftStart::new(&o.position(), &o.velocity(), &o, s(c, "Tb"));
        let want = list(c, "e");
        let size = size(&want);
        let scaled = soft.share(s(c, "t")).map(|x| x.into() / size);
        check.all(&name, scaled, want.iter().map(|x| x / size).collect());
    }
}

pub fn vertical<S: Scalar + Into<f64>>(file: &Value, bound: f64) {
    let mut check = Check::new(bound);
    for (name, c) in cases(file, "e1_step") {
        let model = match c["par"].as_str() {
            // The parameter set of the controller vectors that bears the article's simulation masses.
            Some("PAR_SIM") => {
                PendulumModel::try_new(S::lit(0.26), S::lit(0.03), S::lit(0.7)).unwrap()
            }
            Some(other) => panic!("{name}: unknown parameter set {other}"),
            None => model(&c["par"]),
        };
        let mut state = VerticalDisturbanceState { velocity: s(c, "v_hat"), force: s(c, "bz_hat") };
        VerticalDisturbance { bandwidth: s(c, "wn") }.step(
            &model,
            &mut state,
            s(c, "vz_meas"),
            (&vec3(c, "q"), &vec3(c, "omega")),
            (&vec3(c, "f"), &vec3(c, "b_hat")),
            s(c, "dt"),
        );
        check.near(&name, state.velocity, num(&c["out"], "v_hat"));
        check.near(&name, state.force, num(&c["out"], "bz_hat"));
    }
}
