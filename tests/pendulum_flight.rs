//! The pendulum on the whole simulated quadrotor, under motion capture that comes by MAVLink: who may
//! begin, what ends it, and in which safe state.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use mavlink::dialects::common as mav;
use mavlink::types::CharArray;
use tautline_firmware::signal::Severity;
use tautline_firmware::supervisor::Mode;
use tautline_sitl::flight::{Flight, MavlinkSender};
use tautline_sitl::plant::RodPhase;
use tautline_sitl::scenario::{FaultKind, FaultSection, Scenario, Step};
use tautline_tests::{HOLD, heard, run, until};

const SCENARIO: &str = include_str!("../sitl/scenarios/pendulum.toml");

/// The scenario, changed, with its mission up to the hold and what follows.
fn flown(change: impl FnOnce(&mut Scenario), then: &[Step]) -> Flight<Vec<u8>> {
    let mut s = Scenario::parse(SCENARIO, "pendulum.toml").unwrap();
    s.mission = vec![Step::Arm, Step::Takeoff { altitude: 1.5 }, Step::Hold { seconds: 4.0 }];
    s.mission.extend_from_slice(then);
    change(&mut s);
    Flight::new(&s, s.params().unwrap(), 4, Vec::new()).unwrap()
}

/// Balancing for some seconds.
fn balancing(change: impl FnOnce(&mut Scenario)) -> Flight<Vec<u8>> {
    let mut flight = flown(change, &[Step::Pendulum, Step::Hold { seconds: 1000.0 }]);
    until(&mut flight, 40.0, |out| out.mode == Mode::Pendulum);
    run(&mut flight, 8.0);
    flight
}

fn break_now(flight: &mut Flight<Vec<u8>>, kind: FaultKind, duration: Option<f64>) {
    let at = flight.world.now().0 as f64 * 1e-6;
    flight
        .world
        .environment
        .faults
        .add(FaultSection { duration, ..FaultSection::new(kind, 0.0, at) });
}

fn told(flight: &Flight<Vec<u8>>, text: &str) -> bool {
    flight.events.iter().any(|(_, e)| e.text.contains(text))
}

/// Asks for the mode again and again; the first refusal.
fn refusal(change: impl FnOnce(&mut Scenario)) -> String {
    let mut flight = flown(change, &[Step::Pendulum]);
    until(&mut flight, 40.0, |out| out.events.iter().any(|e| e.severity == Severity::Warning));
    flight.events.last().unwrap().1.text.to_owned()
}

#[test]
fn a_load_is_balanced_along_the_circle_under_a_push_that_lifts() {
    use tautline_sitl::scenario::DisturbanceKind;
    let mut flight = balancing(|s| s.push.kind = DisturbanceKind::Constant);
    run(&mut flight, 20.0);
    let figures = flight.metrics.summary();
    assert_eq!(figures.lost, None);
    let pendulum = figures.pendulum.unwrap();
    assert!(pendulum.load_error_mean_m < 0.03, "{pendulum:?}");
    assert!(pendulum.disturbance_down_rms_n < 0.1, "{pendulum:?}");
}

#[test]
fn a_load_at_rest_goes_where_a_reposition_sends_it() {
    let mut flight = balancing(|s| {
        s.params.insert("PND_SPEED".into(), 0.0);
    });
    let metres = |x: f32| (x * 1e4) as i32;
    let target = mav::COMMAND_INT_DATA {
        param1: -1.0,
        param4: f32::NAN,
        x: metres(0.6),
        y: metres(-0.4),
        frame: mav::MavFrame::MAV_FRAME_LOCAL_NED,
        command: mav::MavCmd::MAV_CMD_DO_REPOSITION,
        target_system: 1,
        target_component: 1,
        ..mav::COMMAND_INT_DATA::default()
    };
    let mut sender = MavlinkSender::new(255, 190);
    let mut say = |flight: &mut Flight<Vec<u8>>, z: f32| {
        let bytes = sender.frame(&mav::COMMAND_INT_DATA { z, ..target.clone() });
        flight.world.receive(&bytes, &mut |_| {});
        run(flight, 0.05);
    };
    say(&mut flight, -0.8);
    assert!(told(&flight, "vehicle too near the ground"));
    // Programs repeat what they want.
    for _ in 0..20 {
        say(&mut flight, -2.5);
    }
    assert!(!told(&flight, "on its way"));
    run(&mut flight, 12.0);
    let plant = &flight.world.environment.plant;
    let load = plant.rod.as_ref().unwrap().load(&plant.body.position);
    let off = (load - tautline_sitl::plant::V3::new(0.6, -0.4, -2.5)).norm();
    assert!(off < 0.05, "{off} m, {:?}", flight.events.last());
}

#[test]
fn without_motion_capture_the_vehicle_hovers_level_then_descends() {
    let mut flight = balancing(|s| {
        s.params.insert("PND_SPEED".into(), 0.0);
    });
    let height = flight.world.environment.plant.body.height();
    break_now(&mut flight, FaultKind::CaptureLost, None);
    let out = until(&mut flight, 1.0, |out| out.mode == Mode::TetherHold);
    assert!(told(&flight, "Motion capture stale: hovering"));
    assert!(out.estimate.tether.is_none());
    // Three seconds of level hover.
    run(&mut flight, 2.5);
    let body = &flight.world.environment.plant.body;
    assert!(body.tilt() < 0.1 && (body.height() - height).abs() < 0.6, "{}", body.height());
    until(&mut flight, 2.0, |out| out.mode == Mode::Descent);
    assert!(told(&flight, "Motion capture lost: descending"));
    until(&mut flight, 30.0, |out| !out.is_armed);
    assert!(flight.world.environment.plant.ground.is_touching());
}

#[test]
fn when_motion_capture_is_back_the_vehicle_stays_where_that_finds_it() {
    // On the circle, 1.6 m across, far from where the hold before it was; the place is lost before the rod.
    let mut flight = balancing(|s| {
        s.params.insert("CAP_TIMEOUT".into(), 0.05);
    });
    let held = flight.step(&mut |_| {}).estimate.position.unwrap().0;
    until(&mut flight, 60.0, |out| {
        out.estimate.position.is_some_and(|at| (at.0 - held).norm() > 1.2)
    });
    break_now(&mut flight, FaultKind::CaptureLost, Some(1.0));
    until(&mut flight, 1.0, |out| out.mode == Mode::TetherHold && out.reference.is_none());
    let out = until(&mut flight, 2.0, |out| out.reference.is_some());
    let (reference, here) = (out.reference.unwrap().position.0, out.estimate.position.unwrap().0);
    assert!((reference - here).norm() < 0.2, "flies from {here} to {reference}");
}

#[test]
fn a_rod_that_is_no_longer_seen_ends_in_a_hover_that_holds_its_place() {
    let mut flight = balancing(|_| {});
    break_now(&mut flight, FaultKind::RodUnseen, None);
    until(&mut flight, 1.0, |out| out.mode == Mode::TetherHold);
    assert!(told(&flight, "Motion capture stale: hovering"));
    let out = run(&mut flight, 6.0);
    let off = flight.world.environment.plant.body.position
        - out.reference.unwrap().position.0.map(f64::from);
    assert!(off.norm() < 0.1, "{off}");
    assert_eq!(out.mode, Mode::TetherHold);
}

#[test]
fn a_gap_shorter_than_the_timeout_is_flown_through() {
    let mut flight = balancing(|_| {});
    break_now(&mut flight, FaultKind::CaptureLost, Some(0.08));
    let out = run(&mut flight, 10.0);
    assert_eq!(out.mode, Mode::Pendulum);
    assert_eq!(flight.metrics.summary().lost, None);
}

#[test]
fn a_rod_that_falls_ends_in_a_hover() {
    // Somebody pulls it over: further than thrust and rates can bring back.
    let mut flight = balancing(|_| {});
    flight.world.environment.plant.rod.as_mut().unwrap().rate =
        tautline_sitl::plant::V3::new(25.0, 0.0, 0.0);
    let out = until(&mut flight, 2.0, |out| out.mode == Mode::TetherHold);
    let why = ["Pendulum fell: hovering", "Pendulum too far off: hovering"];
    assert!(why.iter().any(|text| told(&flight, text)), "{:?} {:?}", out.mode, flight.events);
    run(&mut flight, 8.0);
    let plant = &flight.world.environment.plant;
    assert_eq!(plant.rod.as_ref().unwrap().phase, RodPhase::Fallen);
    assert!(plant.body.tilt() < 0.2 && plant.body.height() > 0.5, "{:?}", plant.body);
}

#[test]
fn the_mode_is_refused_unless_the_rod_stands_upright_and_is_seen() {
    assert!(refusal(|s| s.rod.tilt = 0.4).contains("rod not upright"));
    assert!(refusal(|s| s.rod.load_mass = 0.0).contains("no direction of the rod"));
    let weak = |s: &mut Scenario| {
        s.params.insert("PND_BETA".into(), 4.0);
    };
    assert!(refusal(weak).contains("PND_BETA too large"));
    // On a winch, nothing else than asked too much.
    let mut s = Scenario::parse(HOLD, "hold.toml").unwrap();
    s.mission.pop();
    s.mission.push(Step::Pendulum);
    let mut on_tether = Flight::new(&s, s.params().unwrap(), 3, Vec::new()).unwrap();
    until(&mut on_tether, 80.0, |out| out.events.iter().any(|e| e.text.contains("refused")));
    assert!(told(&on_tether, "needs TET_KIND 4"));
}

#[test]
fn gains_that_lose_the_proof_are_told_when_they_are_set() {
    let mut flight = flown(|_| {}, &[]);
    let mut sender = MavlinkSender::new(255, 190);
    let mut set = |flight: &mut Flight<Vec<u8>>, name: &str, value: f32| {
        let message = mav::PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: CharArray::from(name),
            param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        let bytes = sender.frame(&message);
        flight.world.receive(&bytes, &mut |_| {});
        run(flight, 0.05);
    };
    set(&mut flight, "PND_KQ", 8.0);
    assert!(told(&flight, "PND_KQ too small for a proof at hover"));
    set(&mut flight, "PND_KQ", 12.0);
    set(&mut flight, "PND_BETA", 3.0);
    assert!(told(&flight, "Pendulum off: PND_BETA too large"));
}

#[test]
fn three_messages_say_the_same_pose() {
    let (yaw, half) = (0.6_f32, 0.3_f32);
    let q = [half.cos(), 0.0, 0.0, half.sin()];
    let odometry = mav::ODOMETRY_DATA {
        x: 1.0,
        y: 2.0,
        z: -3.0,
        q,
        frame_id: mav::MavFrame::MAV_FRAME_LOCAL_NED,
        ..mav::ODOMETRY_DATA::default()
    };
    let vision =
        mav::VISION_POSITION_ESTIMATE_DATA { x: 1.0, y: 2.0, z: -3.0, yaw, ..Default::default() };
    let mocap = mav::ATT_POS_MOCAP_DATA { x: 1.0, y: 2.0, z: -3.0, q, ..Default::default() };
    for mut link in [heard(&odometry), heard(&vision), heard(&mocap)] {
        let sample = link.take_sensors().capture.unwrap();
        assert_eq!(sample.value.position.map(f32::to_bits), [1.0_f32, 2.0, -3.0].map(f32::to_bits));
        assert!((sample.value.heading.unwrap() - yaw).abs() < 1e-6);
        assert!(link.take_sensors().capture.is_none());
    }
    let body_frame =
        mav::ODOMETRY_DATA { frame_id: mav::MavFrame::MAV_FRAME_BODY_FRD, ..odometry.clone() };
    let nan = mav::ODOMETRY_DATA { x: f32::NAN, ..odometry };
    for mut link in [heard(&body_frame), heard(&nan)] {
        assert!(link.take_sensors().capture.is_none());
        assert_eq!(link.counters().refused, 1);
    }
}

#[test]
fn only_a_vector_named_rod_is_a_rod() {
    let rod = |name: &str, x: f32| {
        heard(&mav::DEBUG_VECT_DATA {
            time_usec: 5,
            x,
            y: 0.0,
            z: -1.0,
            name: CharArray::from(name),
        })
    };
    assert_eq!(
        rod("rod", 0.1).take_sensors().rod.unwrap().value.map(f32::to_bits),
        [0.1_f32, 0.0, -1.0].map(f32::to_bits)
    );
    assert!(rod("rods", 0.1).take_sensors().rod.is_none());
    assert!(rod("", 0.1).take_sensors().rod.is_none());
    let mut bad = rod("rod", f32::NAN);
    assert!(bad.take_sensors().rod.is_none() && bad.counters().refused == 1);
}
