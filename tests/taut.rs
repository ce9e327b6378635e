//! The taut-link modes: flown, refused with reasons, and left safely.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use tautline_firmware::control::taut::{
    ElevationAttitude, ElevationForce, Inversion, Law, PlanarInput, PlanarLoop, PlanarLoopSettings,
    ThrustLimits,
};
use tautline_firmware::estimate::high_gain::{HighGain, HighGainSettings};
use tautline_firmware::fault::{Fault, Invalid};
use tautline_firmware::model::{PlanarImu, PlanarModel};
use tautline_firmware::param::Params;
use tautline_firmware::signal::PlanarReference;
use tautline_firmware::signal::{Action, Outcome, Request, Ticket};
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepInput;
use tautline_sitl::experiment::{Overrides, find};
use tautline_sitl::flight::{Flight, Progress};
use tautline_tests::{flight, run, until};

/// Vehicle, link and parameters of the taut-link scenario, without its mission.
fn vehicle() -> String {
    let text = include_str!("../sitl/scenarios/taut.toml");
    text.split("[[mission]]").next().unwrap().to_owned()
}

const ENTER: &str = r#"
[[mission]]
do = "arm"
[[mission]]
do = "takeoff"
altitude = 3.5
[[mission]]
do = "hold"
seconds = 4.0
[[mission]]
do = "taut"
control = "CONTROL"
"#;
const HOLD: &str = "[[mission]]\ndo = \"hold\"\nseconds = 1000.0\n";

fn fly(head: &str, control: &str, more: &str) -> Flight<Vec<u8>> {
    flight(&format!("{head}{}{more}", ENTER.replace("CONTROL", control)), 1)
}

fn heard(flight: &Flight<Vec<u8>>, text: &str) -> bool {
    flight.events.iter().any(|(_, event)| event.text.contains(text))
}

#[test]
fn one_seed_of_every_flight_row_keeps_its_limits() {
    let settings = Overrides { sets: vec![("seeds".into(), "1".into())], seed: 3 };
    let report = (find("taut-flight").unwrap().run)(&settings).unwrap();
    for line in &report.lines {
        assert!(line.passes(), "{}", line.text());
    }
    assert!(report.lines.len() >= 40);
}

/// From a slack start, with rotors that are off by up to 5 % and a thrust map that does not quite fit.
#[test]
fn a_slack_hover_calibrates_the_thrust_and_the_vehicle_goes_out_until_the_link_pulls() {
    let mut flight = flight(include_str!("../sitl/scenarios/taut-slack.toml"), 2);
    let (mut real, mut commanded) = (0.0, 0.0);
    let mut told = None;
    while !heard(&flight, "Thrust calibrated") {
        flight.step(&mut |_| {});
        let out = flight.output();
        told = out.reply.and_then(|reply| reply.parameter);
        if flight.world.time() > 10.0 {
            real += flight.world.environment.plant.thrust();
            commanded += f64::from(out.estimate.thrust);
        }
        assert!(flight.world.time() < 30.0, "{:?}", flight.events);
    }
    let scale = f64::from(flight.world.vehicle.params().thrust_scale);
    assert!((scale - real / commanded).abs() < 0.01, "{scale}, truth {}", real / commanded);
    assert_eq!(told, Params::index_of(b"THR_SCALE"), "the ground station hears the new value");
    assert!((scale - 1.0).abs() > 0.02, "nothing to calibrate in this seed");
    flight.fly(120.0);
    let summary = flight.metrics.summary();
    assert_eq!(summary.lost, None);
    assert!(summary.taut.unwrap().elevation_rms_rad < 0.05, "{summary:?}");
    assert_eq!(*flight.mission.progress(), Progress::Done);
}

/// There is no position yet, so neither a hold nor a landing by position may begin.
#[test]
fn a_slack_hover_is_left_downwards_only() {
    let text = include_str!("../sitl/scenarios/taut-slack.toml");
    let head = text.split("[[mission]]").next().unwrap();
    let begin = "FS_LINK_T = 0.5\n[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 3.5\n";
    let fault = "[[fault]]\nkind = \"link_lost\"\nat = 10.5\n";
    let mut flight = flight(&format!("{head}{begin}{fault}"), 2);
    until(&mut flight, 12.0, |out| out.mode == Mode::Takeoff && out.estimate.height > 0.8);
    let request = Request { ticket: Ticket::default(), action: Action::SetMode(Mode::TetherHold) };
    let mut vehicle = flight.world.vehicle.clone();
    let now = flight.world.now();
    let out = vehicle.step(&StepInput { now, request: Some(request), ..StepInput::default() });
    assert_eq!((out.mode, out.reply.unwrap().outcome), (Mode::Takeoff, Outcome::Rejected));

    let seen = until(&mut flight, 5.0, |out| out.mode != Mode::Takeoff);
    assert_eq!(seen.mode, Mode::Descent, "{:?}", flight.events);
    until(&mut flight, 30.0, |out| !out.is_armed);
    assert!(flight.metrics.verdict.touch_down.unwrap() < 0.8);
}

#[test]
fn modes_are_refused_where_they_cannot_fly() {
    // On a winch.
    let mut winch = fly("", "force", HOLD);
    until(&mut winch, 60.0, |out| out.mode == Mode::TetherHold && out.ground == GroundState::InAir);
    run(&mut winch, 10.0);
    assert!(heard(&winch, "Mode refused: needs a link of fixed length"));

    // On the ground.
    let mut early = flight(
        &format!(
            "{}[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"taut\"\ncontrol = \"force\"\n",
            vehicle()
        ),
        1,
    );
    run(&mut early, 12.0);
    assert!(heard(&early, "Mode refused: not in the air"));

    // The cable has just broken.
    let fault = "[[fault]]\nkind = \"tether_broken\"\nat = 19.5\n";
    let mut slack = fly(&vehicle(), "force", &format!("{HOLD}{fault}"));
    run(&mut slack, 22.0);
    assert!(heard(&slack, "Mode refused: link is slack"), "{:?}", slack.events);

    // High up under much tension the thrust points along the link.
    let steep = ENTER.replace("altitude = 3.5", "altitude = 4.95").replace("CONTROL", "attitude");
    let head = vehicle().replace("TET_TENSION = 6.0", "TET_TENSION = 8.5");
    let mut steep = flight(&format!("{head}{steep}"), 1);
    run(&mut steep, 40.0);
    assert!(heard(&steep, "Mode refused: thrust along the link"), "{:?}", steep.events);

    // With the nose beside the link: the hold moves the vehicle 30 degrees round, the nose stays.
    let round = "[[mission]]\ndo = \"move\"\nazimuth = 0.6\n[[mission]]\ndo = \"taut\"\ncontrol = \"force\"\n";
    let before = ENTER.split("[[mission]]\ndo = \"taut\"").next().unwrap();
    let mut turned = flight(&format!("{}{before}{round}", vehicle()), 1);
    run(&mut turned, 60.0);
    assert!(heard(&turned, "Mode refused: nose not along the link"), "{:?}", turned.events);
}

#[test]
fn one_taut_link_mode_hands_over_to_the_other_in_flight() {
    let other = "[[mission]]\ndo = \"hold\"\nseconds = 3.0\n[[mission]]\ndo = \"taut\"\ncontrol = \"attitude\"\n";
    let mut flight = fly(&vehicle(), "force", &format!("{other}{HOLD}"));
    until(&mut flight, 60.0, |out| out.mode == Mode::TautAttitude);
    let out = run(&mut flight, 20.0);
    assert_eq!(out.mode, Mode::TautAttitude);
    assert!(out.taut.unwrap().out_of_plane.is_some(), "nobody watches the motion out of the plane");
    let summary = flight.metrics.summary();
    assert_eq!(summary.lost, None);
    assert!(summary.taut.unwrap().azimuth_max_rad < 0.35, "{summary:?}");
}

#[test]
fn a_tether_set_point_becomes_a_smooth_move_of_elevation_and_force() {
    let step = "[[mission]]\ndo = \"move\"\nelevation = 0.95\ntension = 8.0\n";
    let mut flight = fly(&vehicle(), "force", step);
    until(&mut flight, 60.0, |out| out.mode == Mode::TautForce);
    until(&mut flight, 30.0, |out| {
        out.taut_reference.is_some_and(|r| {
            (r.elevation[0] - 0.95).abs() < 1e-3 && (r.second[0] - 8.0).abs() < 1e-3
        })
    });
    run(&mut flight, 4.0);
    assert!((flight.world.environment.plant.tether.tension() - 8.0).abs() < 1.0);
    assert!(!heard(&flight, "refused"), "{:?}", flight.events);
}

/// A move from 45° and 6 N, or 13° of pitch, and what the operator must read.
fn refused(control: &str, elevation: &str, second: &str, duration: f64, reason: &str) {
    let step = format!(
        "[[mission]]\ndo = \"taut_move\"\ncontrol = \"{control}\"\nelevation = {elevation}\nsecond = {second}\nduration = {duration}\n"
    );
    let mut flight = fly(&vehicle(), control, &step);
    let mode = if control == "force" { Mode::TautForce } else { Mode::TautAttitude };
    until(&mut flight, 60.0, |out| out.mode == mode);
    let out = run(&mut flight, 3.0);
    assert!(heard(&flight, reason), "{reason}: {:?}", flight.events);
    assert_eq!(out.mode, mode, "{reason}: the mode goes on");
}

#[test]
fn moves_that_vehicle_or_link_cannot_follow_are_refused_with_a_reason() {
    let cases = [
        ("[0.785, 0.785]", "[6.0, -6.0]", 1.5, "Move refused: a cable cannot push"),
        ("[0.785, 0.785]", "[6.0, 1.0]", 3.0, "Move refused: link force too small to be seen"),
        ("[0.785, 0.785]", "[6.0, 20.0]", 3.0, "Move refused: more thrust than rotors give"),
        ("[0.785, 1.7]", "[6.0, 6.0]", 5.0, "Move refused: elevation out of range"),
        ("[0.2, 0.9]", "[6.0, 6.0]", 5.0, "Move refused: start is not where the vehicle is"),
        ("[0.785, 0.9]", "[6.0, 6.0]", 0.1, "Move refused: duration out of range"),
    ];
    for (elevation, second, duration, reason) in cases {
        refused("force", elevation, second, duration, reason);
    }
    refused("attitude", "[0.785, 1.4]", "[0.24, 0.24]", 5.0, "Move refused:");
}

#[test]
fn a_bar_that_would_linger_at_zero_force_or_need_too_little_thrust_is_refused() {
    let head = vehicle().replace("kind = \"fixed\"", "kind = \"bar\"");
    // Straight above, a bar in compression carries nearly the whole weight.
    for (altitude, elevation, second, duration, reason) in [
        (3.5, "[0.785, 0.785]", "[6.0, -4.0]", 5.0, "Move refused: cross zero force within 2 s"),
        (4.9, "[1.37, 1.5]", "[6.0, -11.0]", 1.5, "Move refused: thrust below its minimum"),
    ] {
        let step = format!(
            "[[mission]]\ndo = \"taut_move\"\ncontrol = \"force\"\nelevation = {elevation}\nsecond = {second}\nduration = {duration}\n"
        );
        let enter = ENTER
            .replace("CONTROL", "force")
            .replace("altitude = 3.5", &format!("altitude = {altitude}"));
        let mut flight = flight(&format!("{head}{enter}{step}"), 1);
        until(&mut flight, 60.0, |out| out.mode == Mode::TautForce);
        run(&mut flight, 3.0);
        assert!(heard(&flight, reason), "{reason}: {:?}", flight.events);
    }
}

#[test]
fn a_broken_cable_in_a_taut_link_mode_ends_in_a_descent_to_the_ground() {
    let fault = "[[fault]]\nkind = \"tether_broken\"\nat = 30.0\n";
    let mut flight = fly(&vehicle(), "force", &format!("{HOLD}{fault}"));
    until(&mut flight, 60.0, |out| out.mode == Mode::TautForce);
    until(&mut flight, 60.0, |out| out.mode == Mode::Descent);
    until(&mut flight, 60.0, |out| !out.is_armed);
    assert!(heard(&flight, "Tether slack: descending"));
    assert!(flight.world.environment.plant.ground.is_touching());
}

#[test]
fn a_lost_ground_station_ends_a_taut_link_mode_in_a_landing() {
    let fault = "[[fault]]\nkind = \"link_lost\"\nat = 30.0\n";
    let mut flight = fly(&vehicle(), "attitude", &format!("{HOLD}{fault}"));
    until(&mut flight, 60.0, |out| out.mode == Mode::TautAttitude);
    until(&mut flight, 60.0, |out| out.mode == Mode::Land);
    until(&mut flight, 60.0, |out| !out.is_armed);
    assert!(flight.metrics.verdict.touch_down.unwrap() < 0.8);
}

#[test]
fn without_altimeter_the_mode_flies_on_by_inertia() {
    let fault = "[[fault]]\nkind = \"altimeter_lost\"\nat = 26.0\n";
    let head = vehicle().replace("TLK_ALT_TAU = 0.0", "TLK_ALT_TAU = 1.5");
    let mut flight = fly(&head, "force", &format!("{HOLD}{fault}"));
    until(&mut flight, 60.0, |out| out.mode == Mode::TautForce);
    let out = run(&mut flight, 20.0);
    assert_eq!(out.mode, Mode::TautForce);
    assert_eq!(flight.metrics.summary().lost, None);
}

fn model() -> PlanarModel<f64> {
    PlanarModel::try_new(1.0, 0.25, 2.0, 9.81).unwrap()
}
fn settings() -> HighGainSettings<f64> {
    HighGainSettings::new(model(), 0.004)
}

#[test]
fn construction_refuses_what_no_block_can_work_with_by_its_name() {
    let field = |result: Result<(), Invalid>| result.unwrap_err().field;
    let nan = f64::NAN;
    let planar = |m, j, l, g| field(PlanarModel::try_new(m, j, l, g).map(drop));
    assert_eq!(planar(0.0, 0.25, 2.0, 9.81), "mass");
    assert_eq!(planar(nan, 0.25, 2.0, 9.81), "mass");
    assert_eq!(planar(1.0, f64::INFINITY, 2.0, 9.81), "inertia");
    assert_eq!(planar(1.0, 0.25, -2.0, 9.81), "length");
    assert_eq!(planar(1.0, 0.25, 2.0, 0.0), "gravity");

    let observer = |s| field(HighGain::try_new(s).map(drop));
    for epsilon in [0.0, -0.1, nan] {
        assert_eq!(observer(HighGainSettings { epsilon, ..settings() }), "epsilon");
    }
    assert_eq!(observer(HighGainSettings { period: 0.0, ..settings() }), "period");
    assert_eq!(observer(HighGainSettings { roots: [-1.0, 0.0, -2.0], ..settings() }), "roots");
    assert_eq!(observer(HighGainSettings { force_min: -1.0, ..settings() }), "force_min");
    assert_eq!(observer(HighGainSettings { rate_max: 0.0, ..settings() }), "rate_max");

    let force = |p: &[f64; 4], q: &[f64; 2], inversion| {
        field(ElevationForce::try_new(model(), p, q, inversion).map(drop))
    };
    let good = [-1.0, -1.5, -2.0, -2.5];
    assert_eq!(force(&[-1.0, 1.0, -2.0, -2.0], &[-1.0, -1.0], Inversion::Exact), "elevation_poles");
    assert_eq!(force(&good, &[-1.0, nan], Inversion::Exact), "force_poles");
    assert_eq!(force(&good, &[-1.0, -1.0], Inversion::Damped { damping: -0.1 }), "damping");
    let attitude = |p: &[f64; 3], q: &[f64; 2]| {
        field(ElevationAttitude::try_new(model(), p, q, Inversion::Exact).map(drop))
    };
    assert_eq!(attitude(&[0.0, -1.0, -1.0], &[-1.0, -1.0]), "elevation_poles");
    assert_eq!(attitude(&[-1.0, -1.0, -1.0], &[1.0, -1.0]), "pitch_poles");

    let law = || {
        Law::Force(
            ElevationForce::try_new(model(), &good, &[-1.0, -1.5], Inversion::Exact).unwrap(),
        )
    };
    let joined = |settings| {
        let observer = HighGain::try_new(self::settings()).unwrap();
        field(PlanarLoop::try_new(observer, law(), settings).map(drop))
    };
    let plain = PlanarLoopSettings { motor_lag: 0.0, hold_off: 0.0, limits: None };
    assert_eq!(joined(PlanarLoopSettings { motor_lag: -1.0, ..plain }), "motor_lag");
    assert_eq!(joined(PlanarLoopSettings { hold_off: nan, ..plain }), "hold_off");
    let limits = ThrustLimits { min: 5.0, max: 3.0, rate: 1.0, accel: 1.0, torque: 1.0 };
    assert_eq!(joined(PlanarLoopSettings { limits: Some(limits), ..plain }), "thrust_max");
}

#[test]
fn a_reading_that_is_no_number_is_a_fault_and_leaves_the_state_untouched() {
    let law = ElevationForce::try_new(
        model(),
        &[-1.0, -1.5, -2.0, -2.5],
        &[-1.0, -1.5],
        Inversion::Exact,
    )
    .unwrap();
    let observer = HighGain::try_new(settings()).unwrap();
    let plain = PlanarLoopSettings { motor_lag: 0.0, hold_off: 0.0, limits: None };
    let planar = PlanarLoop::try_new(observer, Law::Force(law), plain).unwrap();
    let good = PlanarImu { x: 1.8, z: -10.0, rate: 0.1 };
    let at = |imu| PlanarInput { imu, acting: None, state: None };
    let reference =
        PlanarReference { elevation: [0.8, 0.0, 0.0, 0.0, 0.0], second: [3.0, 0.0, 0.0] };
    let mut state = planar.start(&good, 12.0);
    planar.step(&mut state, &at(good), &reference).unwrap();
    let before = state;
    for bad in [
        PlanarImu { x: f64::NAN, ..good },
        PlanarImu { z: f64::INFINITY, ..good },
        PlanarImu { rate: f64::NEG_INFINITY, ..good },
    ] {
        assert_eq!(planar.step(&mut state, &at(bad), &reference), Err(Fault::NotFinite));
        assert_eq!(state, before);
    }
    let nowhere = PlanarReference { second: [f64::NAN, 0.0, 0.0], ..reference };
    assert_eq!(planar.step(&mut state, &at(good), &nowhere), Err(Fault::NotFinite));
    assert_eq!(state, before);
    // An exact inversion at zero thrust has no answer.
    let mut idle = planar.start(&good, 0.0);
    let still = idle;
    assert_eq!(planar.step(&mut idle, &at(good), &reference), Err(Fault::Degenerate));
    assert_eq!(idle, still);
}

/// What Γb asks in one scalar, at a place in the ranges of everything that it depends on.
fn random_force_law<S: tautline_firmware::scalar::Scalar + Into<f64>>(
    x: &[f64; 25],
    inversion: fn([f64; 2]) -> [f64; 3],
) -> [f64; 2] {
    let s = |i: usize| S::lit(x[i]);
    let model = PlanarModel::try_new(s(0), s(1), s(2), S::lit(9.81)).unwrap();
    let [kind, threshold, damping] = inversion([x[3], x[4]]);
    let inversion = match kind as u8 {
        0 => Inversion::Exact,
        1 => Inversion::Damped { damping: S::lit(damping) },
        _ => Inversion::Window { threshold: S::lit(threshold), damping: S::lit(damping) },
    };
    let law = ElevationForce::try_new(model, &[s(5), s(6), s(7), s(8)], &[s(9), s(10)], inversion)
        .unwrap();
    let state = tautline_firmware::model::PlanarState::from_array([s(11), s(12), s(13), s(14)]);
    let thrust = tautline_firmware::control::taut::ThrustState { thrust: s(15), rate: s(16) };
    let (accel, torque) = law
        .step(
            &state,
            &thrust,
            &std::array::from_fn(|i| s(17 + i)),
            &std::array::from_fn(|i| s(22 + i)),
        )
        .unwrap();
    [accel.into(), torque.into()]
}

#[test]
fn gamma_b_in_single_precision_agrees_with_double_over_its_ranges() {
    use tautline_sitl::plant::{generator, uniform};
    for (name, inversion) in [
        ("exact", (|_| [0.0; 3]) as fn([f64; 2]) -> [f64; 3]),
        ("damped", |[_, damping]| [1.0, 0.0, damping]),
        ("window", |[threshold, damping]| [2.0, threshold, damping]),
    ] {
        let mut rng = generator(21, 0);
        let mut errors: Vec<f64> = (0..20_000)
            .map(|_| {
                let mut between = |low: f64, high: f64| {
                    low + (high - low) * f64::midpoint(uniform(&mut rng), 1.0)
                };
                let mut x = [0.0; 25];
                // Mass, inertia, length, threshold, damping.
                for (i, (low, high)) in
                    [(0.3, 5.0), (0.005, 0.5), (0.5, 20.0), (0.05, 3.0), (0.02, 0.5)]
                        .into_iter()
                        .enumerate()
                {
                    x[i] = between(low, high);
                }
                for pole in &mut x[5..11] {
                    *pole = -between(0.5, 8.0);
                }
                for (at, size) in
                    [(11, 3.1), (12, 3.0), (13, 3.1), (14, 4.0), (15, 30.0), (16, 40.0)]
                {
                    x[at] = between(-size, size);
                }
                for (i, size) in [2.7, 1.0, 1.0, 2.0, 4.0, 15.0, 4.5, 10.0].into_iter().enumerate()
                {
                    x[17 + i] = between(-size, size);
                }
                // What both scalars are given is the same number.
                let x = x.map(|x| f64::from(x as f32));
                let single = random_force_law::<f32>(&x, inversion);
                let double = random_force_law::<f64>(&x, inversion);
                let off = |i: usize| (single[i] - double[i]).abs() / double[i].abs().max(1.0);
                off(0).max(off(1))
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let worst = errors[errors.len() - 1];
        let median = errors[errors.len() / 2];
        println!("{name}: median {median:.1e}, worst {worst:.1e}");
        // A torque is a small difference of large demands here and there: worst 8e-4, median 2e-7.
        assert!(worst < 2e-3 && median < 1e-6, "{name}: median {median:e}, worst {worst:e}");
    }
}
