//! `planar.json`: algebra, controllers and observer steps, and observer streams.

use super::{Check, list, num};
use serde_json::Value;
use tautline_firmware::control::taut::{
    ElevationAttitude, ElevationAttitudeStatic, ElevationForce, Inversion, ThrustState,
};
use tautline_firmware::estimate::high_gain::{
    BranchIndex, Branches, Canonical, CorrectorGain, Discrimination, Drive, ForceReading, HighGain,
    HighGainInput, HighGainSettings, Naive, NaiveStep, Predictor, Selector,
};
use tautline_firmware::math::{gains_from_poles, wrap_pi};
use tautline_firmware::model::{PlanarImu, PlanarModel, PlanarState};
use tautline_firmware::scalar::Scalar;
use tautline_firmware::trajectory::{Smoothness, ThrustBranch};
use tautline_sitl::planar::{PlanarPlant, PlanarPlantModel};

/// How a group is checked.
type Checker = fn(&mut Check, &str, &Value, &Value);

/// Name, check, and the bounds for f64 and f32.
///
/// f64: the specification's 1e-9; its 1e-8 for observer steps, and its 1e-7 where the reference's closed
/// form of the gain cancels. f32: about eight times the largest error seen; the wide ones are the damped
/// inverse (a determinant of nearly equal products) and the fourth derivative of the C4 step near its
/// end (coefficients of hundreds that cancel).
pub fn groups<S: Scalar + Into<f64>>() -> Vec<(&'static str, Checker, [f64; 2])> {
    vec![
        ("dyn", dynamics::<S>, [1e-9, 5e-5]),
        ("link_force", link_force::<S>, [1e-9, 5e-5]),
        ("imu", imu::<S>, [1e-9, 5e-5]),
        ("general_plant", general_plant, [1e-9, 5e-5]),
        ("b_a", drift_static::<S>, [1e-9, 5e-5]),
        ("E_a", decoupling_attitude::<S>, [1e-9, 5e-5]),
        ("b_ap", drift_attitude::<S>, [1e-9, 5e-5]),
        ("b_b", drift_force::<S>, [1e-9, 5e-5]),
        ("E_b", decoupling_force::<S>, [1e-9, 5e-5]),
        ("outputs_b", outputs_force::<S>, [1e-9, 5e-5]),
        ("flat_a", flat_attitude::<S>, [1e-9, 5e-5]),
        ("flat_b", flat_force::<S>, [1e-9, 5e-5]),
        ("gains", gains::<S>, [1e-9, 5e-5]),
        ("ctrl_a", control_static::<S>, [1e-9, 5e-5]),
        ("ctrl_ap", control_attitude::<S>, [1e-9, 5e-5]),
        ("ctrl_b", control_force::<S>, [1e-9, 2e-3]),
        ("smooth", smooth::<S>, [1e-9, 4e-3]),
        ("meas_journal", meas_journal::<S>, [1e-9, 5e-5]),
        ("meas_icra", meas_icra::<S>, [1e-9, 5e-5]),
        ("meas_proj", meas_along::<S>, [1e-9, 5e-5]),
        ("sigma", sigma::<S>, [1e-9, 5e-5]),
        ("hgo_rhs", observer_rate::<S>, [1e-9, 5e-5]),
        ("x_from_z", to_state::<S>, [1e-9, 5e-5]),
        ("pred_err", prediction_error::<S>, [1e-9, 5e-5]),
        ("wrap", wrap::<S>, [1e-9, 5e-5]),
        ("select", select::<S>, [1e-9, 5e-5]),
        ("hgo_step_euler", step_euler::<S>, [1e-8, 5e-5]),
        ("hgo_step_rk4_held", step_rk4::<S>, [1e-8, 5e-5]),
        ("hgo_step_exact_held", step_exact::<S>, [1e-8, 5e-5]),
        ("hgo_step_open", step_open::<S>, [1e-8, 5e-5]),
        ("pc_gain", corrector_gain::<S>, [1e-7, 5e-5]),
        ("pct_step", predictor_step::<S>, [1e-7, 5e-5]),
    ]
}

impl Check {
    /// Angles agree modulo a turn.
    fn angle<S: Scalar + Into<f64>>(&mut self, name: &str, got: S, want: f64) {
        self.near(name, wrap_pi(got.into() - want), 0.0);
    }
}

fn s<S: Scalar>(v: &Value, key: &str) -> S {
    S::lit(num(v, key))
}
fn array<S: Scalar, const N: usize>(v: &Value, key: &str) -> [S; N] {
    values::<N>(v, key).map(S::lit)
}
fn values<const N: usize>(v: &Value, key: &str) -> [f64; N] {
    list(v, key).try_into().unwrap()
}
fn outs(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}
fn model<S: Scalar>(v: &Value) -> PlanarModel<S> {
    let inertia = v.get("J").and_then(Value::as_f64).unwrap_or(1.0);
    PlanarModel::try_new(s(v, "m"), S::lit(inertia), s(v, "l"), s(v, "g")).unwrap()
}
fn state<S: Scalar>(v: &Value, key: &str) -> PlanarState<S> {
    PlanarState::from_array(array(v, key))
}
fn stable<S: Scalar, const N: usize>() -> [S; N] {
    [-S::one(); N]
}

fn dynamics<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let got = model::<S>(i).derivative(&state(i, "x"), s(i, "u1"), s(i, "u2"));
    check.all(name, got.to_array(), outs(o));
}

fn link_force<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.near(name, model::<S>(i).link_force(&state(i, "x"), s(i, "u1")), o.as_f64().unwrap());
}

fn imu<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let got = model::<S>(i).imu(&state(i, "x"), s(i, "u1"));
    check.all(name, [got.x, got.z, got.rate], outs(o));
}

/// The simulator's own plant, always in f64.
fn general_plant(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let model = PlanarPlantModel {
        mass: num(i, "m"),
        inertia: num(i, "J"),
        length: num(i, "l"),
        link_mass: num(i, "mL"),
        attachment: [num(i, "rx"), num(i, "rz")],
        motor_lag: 0.0,
        gravity: num(i, "g"),
    };
    let mut plant = PlanarPlant::new(model, values(i, "x"), num(i, "u1"));
    plant.acting[1] = num(i, "u2");
    let got = plant.readings();
    let [phidd, thdd] = got.angular_accel;
    let [ax, az] = got.accel;
    let all = [
        ("phidd", phidd),
        ("thdd", thdd),
        ("fL", got.link_force),
        ("fT", got.transverse_force),
        ("ax", ax),
        ("az", az),
    ];
    for (key, got) in all {
        check.near(&format!("{name}.{key}"), got, num(o, key));
    }
}

/// Γa's drift is what φ'' and θ'' are without input.
fn drift_static<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let got = model::<S>(i).derivative(&state(i, "x"), S::zero(), S::zero());
    check.all(name, [got.elevation_rate, got.pitch_rate], outs(o));
}

fn rows(o: &Value) -> Vec<f64> {
    o.as_array().unwrap().iter().flat_map(outs).collect()
}

/// Columns of the decoupling matrix are differences under unit inputs.
fn decoupling_attitude<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (m, x) = (model::<S>(i), state(i, "x"));
    let at = |u1, u2| {
        let d = m.derivative(&x, u1, u2);
        [d.elevation_rate, d.pitch_rate]
    };
    let (zero, one) = (S::zero(), S::one());
    let (base, first, second) = (at(zero, zero), at(one, zero), at(zero, one));
    let column = |c: [S; 2]| [c[0] - base[0], c[1] - base[1]];
    let (a, b) = (column(first), column(second));
    check.all(name, [a[0], b[0], a[1], b[1]], rows(o));
}

fn attitude_law<S: Scalar>(i: &Value) -> ElevationAttitude<S> {
    ElevationAttitude::try_new(model(i), &stable(), &stable(), Inversion::Exact).unwrap()
}
fn force_law<S: Scalar>(
    i: &Value,
    poles: (&[S; 4], &[S; 2]),
    inv: Inversion<S>,
) -> ElevationForce<S> {
    ElevationForce::try_new(model(i), poles.0, poles.1, inv).unwrap()
}

fn drift_attitude<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let drift = attitude_law::<S>(i).drift(&state(i, "x"), s(i, "u1"));
    check.all(name, [drift, S::zero()], outs(o));
}

fn outputs<S: Scalar>(i: &Value) -> tautline_firmware::control::taut::ForceOutputs<S> {
    let law = force_law::<S>(i, (&stable(), &stable()), Inversion::Exact);
    let thrust = ThrustState {
        thrust: s(i, "u1"),
        rate: i.get("u1d").map_or(S::zero(), |v| S::lit(v.as_f64().unwrap())),
    };
    law.outputs(&state(i, "x"), &thrust)
}

fn drift_force<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.all(name, outputs::<S>(i).drift, outs(o));
}

fn outputs_force<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let got = outputs::<S>(i);
    check.all(name, got.elevation.into_iter().chain(got.force), outs(o));
}

/// The law does not show its matrix; but it must undo it: `E⁻¹` applied to a column gives a unit input.
fn decoupling_force<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let poles = stable();
    let law = force_law::<S>(i, (&poles, &stable()), Inversion::Exact);
    let (x, thrust) = (state(i, "x"), ThrustState { thrust: s(i, "u1"), rate: S::zero() });
    let now = law.outputs(&x, &thrust);
    let [e11, e12, e21, e22] = rows(o).try_into().unwrap();
    for (column, want) in [([e11, e21], [1.0, 0.0]), ([e12, e22], [0.0, 1.0])] {
        // References on the present outputs leave only drift + column as the highest derivative.
        let ([p0, p1, p2, p3], [f0, f1], [b1, b2]) = (now.elevation, now.force, now.drift);
        let y1 = [p0, p1, p2, p3, b1 + S::lit(column[0])];
        let y2 = [f0, f1, b2 + S::lit(column[1])];
        let (accel, torque) = law.step(&x, &thrust, &y1, &y2).unwrap();
        // The drift is subtracted again: its rounding is part of the figure.
        let scale = b1.abs().into().max(b2.abs().into()).max(1.0);
        for (got, want) in [accel, torque].into_iter().zip(want) {
            check.near(name, (got.into() - want) / scale, 0.0);
        }
    }
}

fn flat_attitude<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let got = model::<S>(i).flat_attitude(&array(i, "y1"), &array(i, "y2")).unwrap();
    let x = got.state.to_array();
    let [a, b, c, d, u1, u2, du1] = outs(o).try_into().unwrap();
    check.angle(name, x[2], c);
    check.all(
        name,
        [x[0], x[1], x[3], got.thrust, got.torque, got.thrust_rate],
        vec![a, b, d, u1, u2, du1],
    );
}

fn flat_force<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let branch = if num(i, "sign") > 0.0 { ThrustBranch::Positive } else { ThrustBranch::Negative };
    let m = model::<S>(i);
    let (y1, y2) = (array(i, "y1"), array(i, "y2"));
    let (got, accel) = m.flat_force(&y1, &y2, branch).unwrap();
    let x = got.state.to_array();
    let [a, b, c, d, u1, u2, du1, ddu1] = outs(o).try_into().unwrap();
    check.angle(name, x[2], c);
    let got = [x[0], x[1], x[3], got.thrust, got.torque, got.thrust_rate, accel];
    check.all(name, got, vec![a, b, d, u1, u2, du1, ddu1]);
    assert_eq!(m.nearest_branch(&y1, &y2, S::lit(c)).unwrap(), branch, "{name}");
}

fn gains<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let poles: Vec<S> = list(i, "poles").into_iter().map(S::lit).collect();
    let got: Vec<S> = match *poles.as_slice() {
        [a] => gains_from_poles("p", &[a]).unwrap().to_vec(),
        [a, b] => gains_from_poles("p", &[a, b]).unwrap().to_vec(),
        [a, b, c] => gains_from_poles("p", &[a, b, c]).unwrap().to_vec(),
        [a, b, c, d] => gains_from_poles("p", &[a, b, c, d]).unwrap().to_vec(),
        _ => panic!("{name}: {} poles", poles.len()),
    };
    check.all(name, got, outs(o));
}

fn inversion<S: Scalar>(i: &Value) -> Inversion<S> {
    let [threshold, damping] = array(i, "ipar");
    match num(i, "inv") as u8 {
        0 => Inversion::Exact,
        1 => Inversion::Damped { damping },
        _ => Inversion::Window { threshold, damping },
    }
}

/// Real roots of a monic polynomial with only negative ones, by shrinking brackets: poles from gains.
fn poles<const N: usize>(gains: &[f64; N]) -> [f64; N] {
    let descending: Vec<f64> = std::iter::once(1.0).chain(gains.iter().rev().copied()).collect();
    roots(&descending).try_into().unwrap_or_else(|r| panic!("poles of {gains:?}: {r:?}"))
}

/// Between the extrema of a polynomial whose roots are all real lies exactly one root each.
fn roots(descending: &[f64]) -> Vec<f64> {
    let degree = descending.len() - 1;
    let at = |x: f64| descending.iter().fold(0.0, |v, c| v * x + c);
    if degree == 1 {
        return vec![-descending[1] / descending[0]];
    }
    let slope: Vec<f64> =
        descending[..degree].iter().enumerate().map(|(k, c)| c * (degree - k) as f64).collect();
    let mut edges = roots(&slope);
    let bound = 1.0 + descending.iter().fold(0.0_f64, |a, c| a.max(c.abs()));
    edges.insert(0, -bound);
    edges.push(bound);
    edges
        .windows(2)
        .map(|edge| {
            let (mut low, mut high) = (edge[0], edge[1]);
            for _ in 0..200 {
                let middle = f64::midpoint(low, high);
                if (at(middle) > 0.0) == (at(high) > 0.0) { high = middle } else { low = middle }
            }
            f64::midpoint(low, high)
        })
        .collect()
}

/// Nearly equal poles are ill-conditioned in their coefficients: the gains made of these poles again
/// must be the given ones, which is all that the law sees.
fn poles_of<S: Scalar + Into<f64>, const N: usize>(
    check: &mut Check,
    i: &Value,
    key: &str,
) -> [S; N] {
    let gains: [f64; N] = values(i, key);
    let poles = poles(&gains);
    let again = gains_from_poles("p", &poles).unwrap();
    for (again, gain) in again.iter().zip(gains) {
        check.near(key, *again, gain);
    }
    poles.map(S::lit)
}

fn control_static<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (p1, p2) = (poles_of(check, i, "k1"), poles_of(check, i, "k2"));
    let law = ElevationAttitudeStatic::<S>::try_new(model(i), &p1, &p2, inversion(i)).unwrap();
    let (u1, u2) = law.step(&state(i, "x"), &array(i, "y1d"), &array(i, "y2d")).unwrap();
    check.all(name, [u1, u2], outs(o));
}

fn control_attitude<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (p1, p2) = (poles_of(check, i, "k1"), poles_of(check, i, "k2"));
    let law = ElevationAttitude::<S>::try_new(model(i), &p1, &p2, inversion(i)).unwrap();
    let (y1, y2) = (array(i, "y1d"), array(i, "y2d"));
    let (rate, torque) = law.step(&state(i, "x"), s(i, "u1"), &y1, &y2).unwrap();
    check.all(name, [rate, torque], outs(o));
}

fn control_force<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (p1, p2) = (poles_of(check, i, "k1"), poles_of(check, i, "k2"));
    let law = force_law::<S>(i, (&p1, &p2), inversion(i));
    let thrust = ThrustState { thrust: s(i, "u1"), rate: s(i, "u1d") };
    let (y1, y2) = (array(i, "y1d"), array(i, "y2d"));
    let (accel, torque) = law.step(&state(i, "x"), &thrust, &y1, &y2).unwrap();
    check.all(name, [accel, torque], outs(o));
}

fn smooth<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let order = match num(i, "n") as u8 {
        1 => Smoothness::C1,
        2 => Smoothness::C2,
        3 => Smoothness::C3,
        _ => Smoothness::C4,
    };
    check.all(name, order.at::<S>(s(i, "tau")), outs(o));
}

fn reading<S: Scalar>(i: &Value) -> ForceReading<S> {
    let imu = PlanarImu { x: s(i, "ax"), z: s(i, "az"), rate: S::zero() };
    ForceReading::new(&model(i), &imu, s(i, "u1"))
}

fn meas_journal<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (force, angle) = reading::<S>(i).signed(s(i, "sign"));
    check.near(name, force, num(o, "eta_signed"));
    check.angle(name, angle, num(o, "w"));
}

fn meas_icra<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (angle, force) = reading::<S>(i).by_angle(&model(i), num(i, "k") > 0.5);
    check.angle(name, angle, num(o, "wbar1"));
    check.near(name, force, num(o, "wbar2"));
}

fn meas_along<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
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

fn sigma<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.near(name, canonical::<S>(i).jerk(&array(i, "z"), &drive(i)), o.as_f64().unwrap());
}

fn observer_rate<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.all(name, naive::<S>(i).rate(&array(i, "z"), s(i, "w"), &drive(i)), outs(o));
}

fn to_state<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let (force, now, measured) = (s(i, "eta_signed"), s(i, "u1_now"), s(i, "u1_meas"));
    let z = array(i, "z");
    let (x, _) = canonical::<S>(i).to_state(&z, force, now, measured, s(i, "u3"));
    let [phi, dphi, theta, dtheta] = outs(o).try_into().unwrap();
    check.angle(name, x.elevation, phi);
    check.angle(name, x.pitch, theta);
    check.all(name, [x.elevation_rate, x.pitch_rate], vec![dphi, dtheta]);
}

fn prediction_error<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    let expected = model::<S>(i).imu(&state(i, "xhat"), s(i, "u1"));
    let (x, z): (S, S) = (s::<S>(i, "ax") - expected.x, s::<S>(i, "az") - expected.z);
    check.near(name, (x * x + z * z).sqrt(), o.as_f64().unwrap());
}

fn wrap<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.angle(name, wrap_pi(s::<S>(i, "a")), o.as_f64().unwrap());
}

fn select<S: Scalar + Into<f64>>(_: &mut Check, name: &str, i: &Value, o: &Value) {
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
fn step_euler<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    naive_step::<S>(check, name, i, o, NaiveStep::Euler);
}
fn step_rk4<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    naive_step::<S>(check, name, i, o, NaiveStep::Rk4);
}
fn step_exact<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    naive_step::<S>(check, name, i, o, NaiveStep::Exact);
}
fn step_open<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    naive_step::<S>(check, name, i, o, NaiveStep::Open);
}

/// `α` comes highest power first; the gain wants the roots.
fn gain<S: Scalar>(i: &Value) -> CorrectorGain<S> {
    let [a1, a2, a3] = values(i, "alpha");
    CorrectorGain::try_new(&poles(&[a3, a2, a1]), num(i, "eps"), num(i, "Ts")).unwrap()
}

fn corrector_gain<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
    check.all(name, gain::<S>(i).0, outs(o));
}

fn predictor_step<S: Scalar + Into<f64>>(check: &mut Check, name: &str, i: &Value, o: &Value) {
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

/// One stream: inputs of every tick, and what the observer must then know.
pub fn stream<S: Scalar + Into<f64>>(name: &str, stream: &Value, bound: f64) {
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
