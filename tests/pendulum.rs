//! The flying inverted pendulum: every explicit derivative against automatic differentiation of the same
//! code, invariants of the filter, and what the guards are for.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

mod dual;

use dual::{Dual, along, dual, slope};
use nalgebra::SMatrix;

use tautline_firmware::control::pendulum::{
    PendulumControl, PendulumGains, PendulumLimits, PendulumMemory,
    body_rate::rate_wanted_by_velocity, force_rate::ForceRate, guidance::Guidance,
};
use tautline_firmware::estimate::pendulum::{
    PendulumCovariance, PendulumEstimate, PendulumFilter, PendulumNoise, PendulumObserver,
    PendulumReading,
};
use tautline_firmware::fault::Fault;
use tautline_firmware::frames::{Attitude, V3, World};
use tautline_firmware::math::so3;
use tautline_firmware::model::PendulumModel;
use tautline_firmware::scalar::Scalar;
use tautline_firmware::signal::LoadReference;
use tautline_firmware::trajectory::load::{FadeIn, LoadMove, SoftStart, TiltedCircle};
use tautline_sitl::bench::pendulum::{PendulumScenario, Precision};
use tautline_sitl::plant::{Generator, generator, uniform};

struct Case {
    model: PendulumModel<f64>,
    gains: PendulumGains<f64>,
    x: PendulumEstimate<f64>,
    reference: LoadReference<f64>,
    /// Force of the thrust, N.
    applied: V3<f64>,
}

fn vector(rng: &mut Generator, size: f64) -> V3<f64> {
    V3::from_fn(|_, _| size * uniform(rng))
}

/// States over the whole of a wild start, all three gain sets.
fn random_cases() -> impl Iterator<Item = Case> {
    let mut rng = generator(7, 50);
    (0..100).map(move |k| {
        let rng = &mut rng;
        let gains = match k % 3 {
            0 => PendulumGains::printed(),
            1 => PendulumGains::printed_experiment(),
            _ => PendulumGains::robust(),
        };
        let rod = (V3::new(0.0, 0.0, -1.0) + vector(rng, 0.6)).normalize();
        let rate = vector(rng, 2.0);
        Case {
            model: PendulumModel::try_new(0.26, 0.03, 0.7).unwrap(),
            gains,
            x: PendulumEstimate {
                position: World(vector(rng, 0.5)),
                velocity: World(vector(rng, 1.0)),
                rod: World(rod),
                rod_rate: World(rate - rod * rod.dot(&rate)),
                disturbance: World(vector(rng, 0.8)),
            },
            reference: LoadReference([0; 6].map(|_| vector(rng, 1.0))),
            applied: V3::new(0.0, 0.0, -3.0) + vector(rng, 1.5),
        }
    })
}

/// The same settings, able to carry a derivative.
fn lifted(case: &Case) -> (PendulumGains<Dual>, PendulumModel<Dual>) {
    let g = &case.gains;
    let l = Dual::lit;
    let gains = PendulumGains {
        position: g.position.map(l),
        velocity: g.velocity.map(l),
        coupling: l(g.coupling),
        rod: l(g.rod),
        rate: l(g.rate),
        attitude: l(g.attitude),
        rod_weight: l(g.rod_weight),
        rate_weight: l(g.rate_weight),
        attitude_weight: l(g.attitude_weight),
    };
    (gains, PendulumModel::try_new(l(0.26), l(0.03), l(0.7)).unwrap())
}

/// How the state moves.
struct Flow {
    accel: V3<f64>,
    rod_accel: V3<f64>,
}

/// Guidance with its derivative along a flow.
fn differentiated(case: &Case, flow: &Flow) -> Guidance<Dual> {
    let (gains, model) = lifted(case);
    let x = &case.x;
    let (q, om) = (x.rod.0, x.rod_rate.0);
    let state = PendulumEstimate {
        position: World(along(&x.position.0, &x.velocity.0)),
        velocity: World(along(&x.velocity.0, &flow.accel)),
        rod: World(along(&q, &om.cross(&q))),
        rod_rate: World(along(&om, &flow.rod_accel)),
        disturbance: World(along(&x.disturbance.0, &V3::zeros())),
    };
    let d = &case.reference.0;
    // Nothing here reads the derivative of the fifth.
    let next = |i: usize| d.get(i + 1).copied().unwrap_or_else(V3::zeros);
    let reference = LoadReference(std::array::from_fn(|i| along(&d[i], &next(i))));
    Guidance::at(&gains, &model, &state, &reference)
}

fn alike(what: &str, explicit: &V3<f64>, automatic: &V3<f64>) {
    let error = (explicit - automatic).norm() / explicit.norm().max(1.0);
    assert!(error < 1e-11, "{what}: {explicit} against {automatic}");
}

#[test]
fn the_derivatives_under_the_wanted_force_along_the_rod_match_dual_numbers() {
    for case in random_cases() {
        let at = Guidance::at(&case.gains, &case.model, &case.x, &case.reference);
        let flow = Flow { accel: at.accel, rod_accel: V3::zeros() };
        let auto = differentiated(&case, &flow);
        alike("pull", &at.pull_rate, &slope(&auto.pull));
        alike("pull rate", &at.pull_accel, &slope(&auto.pull_rate));
        alike("rate wanted", &at.rate_wanted_dot, &slope(&auto.rate_wanted));
        alike("rate error", &at.rate_error_dot, &slope(&auto.rate_error));
        let growth = auto.magnitude.slope / at.magnitude;
        assert!((at.growth - growth).abs() < 1e-11 * growth.abs().max(1.0));
    }
}

#[test]
fn the_derivative_of_the_wanted_force_matches_dual_numbers_under_any_thrust() {
    for case in random_cases() {
        let at = Guidance::at(&case.gains, &case.model, &case.x, &case.reference);
        let (gains, model, x) = (&case.gains, &case.model, &case.x);
        let explicit = ForceRate::at(gains, model, x, &case.reference, &at, &case.applied);
        let push = case.applied + x.disturbance.0;
        let flow = Flow {
            accel: model.load_accel(&x.rod.0, &x.rod_rate.0, &push),
            rod_accel: model.rod_accel(&x.rod.0, &push),
        };
        let auto = differentiated(&case, &flow);
        alike("force", &explicit.force, &slope(&auto.force));
        let thrust = so3::norm(&auto.force);
        let down = auto.force * (dual(-1.0, 0.0) / thrust);
        let wanted = explicit.down_wanted(&down.map(|x| x.value), thrust.value);
        alike("down", &wanted, &slope(&down));
    }
}

#[test]
fn the_derivative_of_the_wanted_rod_rate_by_the_velocity_matches_dual_numbers() {
    for case in random_cases() {
        let at = Guidance::at(&case.gains, &case.model, &case.x, &case.reference);
        let explicit = rate_wanted_by_velocity(&case.gains, &case.x.rod.0, &at);
        let (gains, model) = lifted(&case);
        let still = V3::zeros();
        for (column, axis) in [V3::x(), V3::y(), V3::z()].into_iter().enumerate() {
            let x = &case.x;
            let state = PendulumEstimate {
                position: World(along(&x.position.0, &still)),
                velocity: World(along(&x.velocity.0, &axis)),
                rod: World(along(&x.rod.0, &still)),
                rod_rate: World(along(&x.rod_rate.0, &still)),
                disturbance: World(along(&x.disturbance.0, &still)),
            };
            let reference = LoadReference(case.reference.0.map(|d| along(&d, &still)));
            let auto = Guidance::at(&gains, &model, &state, &reference);
            let explicit = explicit.column(column).into_owned();
            alike("rate wanted by velocity", &explicit, &slope(&auto.rate_wanted));
        }
    }
}

#[test]
fn each_derivative_of_a_reference_is_the_slope_of_the_one_before() {
    let circle = TiltedCircle::<f64>::article(1.3);
    let lifted = TiltedCircle::article(Dual::lit(1.3));
    let rest = LoadReference::at_rest(World(V3::new(0.3, -0.2, -1.0)));
    let soft = SoftStart::new(
        &rest.position(),
        &World(V3::new(0.2, 0.1, -0.4)),
        &LoadReference::at_rest(World(V3::zeros())),
        3.0,
    );
    let l = |v: V3<f64>| v.map(Dual::lit);
    let (from, to) = (V3::new(0.0, 1.0, -1.0), V3::new(1.0, -1.0, -2.0));
    let moved = LoadMove::try_new(World(from), World(to), 2.5).unwrap();
    let lifted_move = LoadMove::try_new(World(l(from)), World(l(to)), Dual::lit(2.5)).unwrap();
    let none = LoadReference::at_rest(World(V3::zeros()));
    let (place, speed) = (V3::new(0.4, -0.3, -1.2), V3::new(0.2, 0.1, -0.4));
    let fade = FadeIn::new(&World(place), &World(speed), 3.0);
    let lifted_fade = FadeIn::new(&World(l(place)), &World(l(speed)), Dual::lit(3.0));
    let begun = fade.apply(&circle.at(0.3), 0.0);
    alike("begin", &begun.position().0, &place);
    alike("begin", &begun.velocity().0, &speed);
    assert!(begun.0[2..].iter().all(|d| d.norm() < 1e-12), "{begun:?}");
    for k in 1..40 {
        let time = 0.06 * f64::from(k);
        let auto = lifted.at(dual(time, circle.angular_speed(time)));
        let explicit = circle.at(time);
        let auto_move = lifted_move.at(dual(time, 1.0));
        let explicit_move = moved.at(time);
        let fading = soft.apply(&none, time);
        let faded = fade.apply(&explicit_move, time);
        let auto_faded = lifted_fade.apply(&auto_move, dual(time, 1.0));
        let step = 1e-6;
        for i in 0..5 {
            alike("circle", &explicit.0[i + 1], &slope(&auto.0[i]));
            alike("move", &explicit_move.0[i + 1], &slope(&auto_move.0[i]));
            alike("fade in", &faded.0[i + 1], &slope(&auto_faded.0[i]));
            let after = soft.apply(&none, time + step).0[i];
            let before = soft.apply(&none, time - step).0[i];
            let numeric = (after - before) / (2.0 * step);
            let error = (fading.0[i + 1] - numeric).norm() / numeric.norm().max(1.0);
            assert!(error < 1e-6, "soft start, derivative {i}: {error}");
        }
    }
}

fn filter() -> PendulumFilter<f64> {
    PendulumFilter {
        model: PendulumModel::try_new(0.26, 0.03, 0.7).unwrap(),
        noise: PendulumNoise::recommended(),
    }
}

#[test]
fn blocks_predict_and_correct_as_a_dense_filter_does() {
    let filter = filter();
    let mut rng = generator(3, 51);
    for _ in 0..50 {
        let root = SMatrix::<f64, 9, 9>::from_fn(|_, _| uniform(&mut rng));
        let dense = root * root.transpose();
        let rod = (V3::new(0.0, 0.0, -1.0) + vector(&mut rng, 0.5)).normalize();
        let mut x = filter.start(&rod);
        x.covariance = PendulumCovariance::from_dense(&dense);
        let dt = 0.02;
        filter.predict(&mut x, &rod, &V3::new(0.1, 0.2, -2.8), dt);

        let s = rod.cross_matrix() * dt;
        let mut phi = SMatrix::<f64, 9, 9>::identity();
        phi.fixed_view_mut::<3, 3>(0, 3).copy_from(&-s);
        phi.fixed_view_mut::<3, 3>(3, 6).copy_from(&-s);
        phi.fixed_view_mut::<3, 3>(0, 6).copy_from(&(s * s * 0.5));
        let [a, b, c] = filter.noise.process;
        let noise = SMatrix::<f64, 9, 1>::from_iterator([a, b, c].iter().flatten().copied());
        let mut p = phi * dense * phi.transpose() + SMatrix::from_diagonal(&(noise * dt));
        assert!((x.covariance.dense() - p).abs().max() < 1e-12);

        let mut h = SMatrix::<f64, 4, 9>::zeros();
        h.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
        h.fixed_view_mut::<1, 3>(3, 3).copy_from(&rod.transpose());
        let r = SMatrix::<f64, 4, 4>::identity() * (1e-6 / dt);
        let k = p * h.transpose() * (h * p * h.transpose() + r).try_inverse().unwrap();
        p -= k * h * p;
        filter.update(&mut x, &rod, dt);
        let error = (x.covariance.dense() - p).abs().max();
        assert!(error < 1e-9, "{error}");
    }
}

#[test]
fn the_covariance_stays_positive_and_the_unseen_vertical_variance_bounded() {
    let filter = filter();
    let rod = V3::new(0.0, 0.0, -1.0);
    let mut x = filter.start(&rod);
    let force = V3::new(0.0, 0.0, -2.84);
    for k in 0..60_000 {
        // Every third sample is lost.
        let reading = (k % 3 != 0).then_some((&rod, 0.005));
        filter.step(&mut x, (&rod, &force), reading, 0.005).unwrap();
    }
    let [.., disturbance] = x.covariance.diagonal();
    assert!(disturbance.z <= 10.0 && disturbance.z > 5.0, "{disturbance}");
    let least = x.covariance.dense().symmetric_eigenvalues().min();
    assert!(least > 0.0, "{least}");
}

#[test]
fn a_reading_that_is_not_finite_leaves_the_observer_untouched() {
    let observer = PendulumObserver { filter: filter(), vertical: None };
    let good = PendulumReading {
        rod: Some(World(V3::new(0.05, 0.0, -1.0))),
        position: World(V3::zeros()),
        velocity: World(V3::zeros()),
        down: World(V3::z()),
        thrust: 2.84,
        rod_period: 0.01,
    };
    let (mut state, _) = observer.start(&good).unwrap();
    let before = state;
    for bad in [
        PendulumReading { thrust: f64::NAN, ..good },
        PendulumReading { velocity: World(V3::new(f64::INFINITY, 0.0, 0.0)), ..good },
        PendulumReading { down: World(V3::new(0.0, f64::NAN, 1.0)), ..good },
    ] {
        assert_eq!(observer.step(&mut state, &bad, 0.01), Err(Fault::NotFinite));
        assert_eq!(state, before);
    }
    // A direction that is none counts as a lost sample.
    let lost = PendulumReading { rod: Some(World(V3::new(f64::NAN, 0.0, -1.0))), ..good };
    assert!(observer.step(&mut state, &lost, 0.01).is_ok());
}

fn control(limits: PendulumLimits<f64>) -> PendulumControl<f64> {
    let model = PendulumModel::try_new(0.26, 0.03, 0.7).unwrap();
    PendulumControl::try_new(PendulumGains::robust(), model, limits).unwrap()
}

fn hovering() -> (PendulumEstimate<f64>, LoadReference<f64>) {
    let still = World(V3::zeros());
    let x = PendulumEstimate {
        position: still,
        velocity: still,
        rod: World(V3::new(0.0, 0.0, -1.0)),
        rod_rate: still,
        disturbance: still,
    };
    (x, LoadReference::at_rest(still))
}

#[test]
fn hover_asks_for_the_weight_and_no_turn() {
    let model = PendulumModel::try_new(0.26, 0.03, 0.7).unwrap();
    let control = control(PendulumLimits::standard(&model));
    let (x, reference) = hovering();
    let level = Attitude::level(0.7);
    let command = control.step(&mut PendulumMemory::default(), &x, &level, &reference).unwrap();
    assert!((command.thrust - 0.29 * 9.81).abs() < 1e-12 && command.rate.0.norm() < 1e-12);
}

#[test]
fn a_command_that_is_not_finite_is_refused_and_the_limits_hold_in_wild_states() {
    let model = PendulumModel::try_new(0.26, 0.03, 0.7).unwrap();
    let limits = PendulumLimits::standard(&model);
    let control = control(limits);
    let mut memory = PendulumMemory::default();
    let mut rng = generator(5, 52);
    for case in random_cases() {
        let turn = vector(&mut rng, 3.0);
        let attitude = Attitude(so3::exp(&turn));
        let command = control.step(&mut memory, &case.x, &attitude, &case.reference).unwrap();
        assert!(command.thrust >= 0.0 && command.thrust <= limits.thrust_max);
        assert!(command.rate.0.norm() <= limits.rate_max + 1e-9);
        let bad = PendulumEstimate { velocity: World(V3::new(f64::NAN, 0.0, 0.0)), ..case.x };
        let before = memory;
        assert!(control.step(&mut memory, &bad, &attitude, &case.reference).is_err());
        assert_eq!(memory, before);
    }
}

#[test]
fn far_above_its_reference_the_guard_keeps_the_rates_of_the_law_small() {
    let guarded = PendulumScenario {
        // The load 0.9 m above the reference (0.8, 0, -1.6): g/kp is 0.82 m.
        start: vec![0.8, 0.0, -2.5],
        speed: 0.0,
        tilt: 1.0,
        pull_share: 0.3,
        rate: 200.0,
        duration: 10.0,
        settled: 8.0,
        ..PendulumScenario::default()
    };
    let free = PendulumScenario { pull_share: 0.0, ..guarded.clone() };
    let guarded = guarded.fly(1).unwrap().summary;
    let free = free.fly(1).unwrap().summary;
    assert!(!guarded.is_lost() && guarded.error_mean < 0.05, "{guarded:?}");
    assert!(free.rate_peak > 20.0 * guarded.rate_peak, "{} {}", free.rate_peak, guarded.rate_peak);
}

#[test]
fn single_precision_flies_as_double_does() {
    let base = PendulumScenario { duration: 20.0, settled: 5.0, ..PendulumScenario::realistic() };
    let single = PendulumScenario { precision: Precision::Single, ..base.clone() };
    let (double, single) = (base.fly(1).unwrap().summary, single.fly(1).unwrap().summary);
    assert!((double.error_mean - single.error_mean).abs() < 1e-5, "{double:?} {single:?}");
}
