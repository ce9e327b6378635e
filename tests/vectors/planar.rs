//! `planar.json`: all groups; here algebra and controllers, the observer beside.

use super::planar_observer::{
    corrector_gain, meas_along, meas_icra, meas_journal, observer_rate, prediction_error,
    predictor_step, select, sigma, step_euler, step_exact, step_open, step_rk4, to_state, wrap,
};
use super::{Check, list, num};
use serde_json::Value;
use tautline_firmware::control::taut::{
    ElevationAttitude, ElevationAttitudeStatic, ElevationForce, Inversion, ThrustState,
};
use tautline_firmware::math::{gains_from_poles, wrap_pi};
use tautline_firmware::model::{PlanarModel, PlanarState};
use tautline_firmware::scalar::Scalar;
use tautline_firmware::trajectory::{Smoothness, ThrustBranch};
use tautline_sitl::bench::planar::{PlanarPlant, PlanarPlantModel};

/// How a group is checked.
type Checker = fn(&mut Check, &str, &Value, &Value);

/// Name, check, and the bounds for f64 and f32.
///
/// f64: the specification's 1e-9; its 1e-8 for observer steps, and its 1e-7 where the reference's closed
/// form of the gain cancels. f32: about eight times the largest error seen; the wide ones are Γb (a small
/// torque as the difference of large demands: 8e-4 over its whole ranges, `tests/taut.rs`) and the fourth derivative of the C4 step near its
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
    pub(super) fn angle<S: Scalar + Into<f64>>(&mut self, name: &str, got: S, want: f64) {
        self.near(name, wrap_pi(got.into() - want), 0.0);
    }
}

pub(super) fn s<S: Scalar>(v: &Value, key: &str) -> S {
    S::lit(num(v, key))
}
pub(super) fn array<S: Scalar, const N: usize>(v: &Value, key: &str) -> [S; N] {
    values::<N>(v, key).map(S::lit)
}
pub(super) fn values<const N: usize>(v: &Value, key: &str) -> [f64; N] {
    list(v, key).try_into().unwrap()
}
pub(super) fn outs(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}
pub(super) fn model<S: Scalar>(v: &Value) -> PlanarModel<S> {
    let inertia = v.get("J").and_then(Value::as_f64).unwrap_or(1.0);
    PlanarModel::try_new(s(v, "m"), S::lit(inertia), s(v, "l"), s(v, "g")).unwrap()
}
pub(super) fn state<S: Scalar>(v: &Value, key: &str) -> PlanarState<S> {
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
pub(super) fn poles<const N: usize>(gains: &[f64; N]) -> [f64; N] {
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
    check.all(name, order.at::<S, 5>(s(i, "tau")), outs(o));
}
