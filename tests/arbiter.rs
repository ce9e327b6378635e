//! Every fault in every mode: nothing changes the mode or stops the motors but a request or a row of the failsafe
//! table, and the operator is told why, once.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use mavlink::dialects::common::{
    COMMAND_LONG_DATA, MANUAL_CONTROL_DATA, MavCmd, MavParamType, PARAM_SET_DATA,
};
use mavlink::types::CharArray;
use tautline_firmware::signal::Severity;
use tautline_firmware::supervisor::{FailsafeAction, Failure, GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;
use tautline_sitl::flight::{Flight, MavlinkSender};
use tautline_sitl::scenario::{FaultKind, FaultSection, Scenario, Step};
use tautline_tests::{HOLD, ask, flight, run, stream, until};

const FAULTS: [(FaultKind, f64); 13] = [
    (FaultKind::ImuFrozen, 0.0),
    (FaultKind::ImuSilent, 0.0),
    (FaultKind::ImuDead, 0.0),
    (FaultKind::RangefinderLost, 0.0),
    (FaultKind::BarometerLost, 0.0),
    (FaultKind::AltimeterLost, 0.0),
    (FaultKind::TetherBroken, 0.0),
    (FaultKind::WinchSilent, 0.0),
    (FaultKind::BatteryAt, 0.0),
    (FaultKind::LinkLost, 0.0),
    (FaultKind::GyroBias, 0.05),
    (FaultKind::CaptureLost, 0.0),
    (FaultKind::RodUnseen, 0.0),
];

/// A joystick in its middle.
fn hold_sticks(flight: &mut Flight<Vec<u8>>) {
    let stick = MANUAL_CONTROL_DATA { z: 500, target: 1, ..MANUAL_CONTROL_DATA::default() };
    let frame = MavlinkSender::new(255, 190).frame(&stick);
    flight.world.receive(&frame, &mut |_| {});
}

fn scenario(name: &str) -> Scenario {
    let path = format!("{}/../sitl/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scenario::load(path.as_ref()).unwrap()
}

fn fly(scenario: &Scenario) -> Flight<Vec<u8>> {
    fly_seed(scenario, 3)
}

fn fly_seed(scenario: &Scenario, seed: u64) -> Flight<Vec<u8>> {
    Flight::new(scenario, scenario.params().unwrap(), seed, Vec::new()).unwrap()
}

/// A scenario's mission as far as the step that enters the mode, then a long hold.
fn as_far_as(name: &str, is_entry: fn(&Step) -> bool, seed: u64) -> Flight<Vec<u8>> {
    let mut scenario = scenario(name);
    let entry = scenario.mission.iter().position(is_entry).unwrap();
    scenario.mission.truncate(entry + 1);
    scenario.mission.push(Step::Hold { seconds: 1000.0 });
    fly_seed(&scenario, seed)
}

/// A flight in the mode, in the air, some seconds old.
fn in_mode(mode: Mode) -> Flight<Vec<u8>> {
    in_mode_of(mode, 3)
}

fn in_mode_of(mode: Mode, seed: u64) -> Flight<Vec<u8>> {
    let is_there = |out: &StepOutput| out.mode == mode && out.ground != GroundState::OnGround;
    let mut flight = match mode {
        Mode::TautForce | Mode::TautAttitude => {
            as_far_as("taut", |step| matches!(step, Step::Taut { .. }), seed)
        }
        Mode::TetherAngle => as_far_as("angle", |step| matches!(step, Step::TetherAngle), seed),
        Mode::Pendulum => as_far_as("pendulum", |step| matches!(step, Step::Pendulum), seed),
        Mode::Stabilize | Mode::Altitude => {
            as_far_as("excite", |s| matches!(s, Step::Excite { .. }), seed)
        }
        _ => flight(HOLD, seed),
    };
    match mode {
        Mode::Takeoff => {
            until(&mut flight, 60.0, |out| is_there(out) && out.estimate.height > 1.0);
            return flight;
        }
        Mode::Stabilize => {
            until(&mut flight, 60.0, |out| out.mode == Mode::Altitude && out.estimate.height > 2.0);
            ask(&mut flight, mode);
        }
        Mode::Offboard | Mode::Position => {
            until(&mut flight, 80.0, |out| {
                out.mode == Mode::TetherHold && out.ground == GroundState::InAir
            });
            stream(&mut flight, None, [0.0; 3]);
            hold_sticks(&mut flight);
            ask(&mut flight, mode);
        }
        Mode::TautAttitude => {
            until(&mut flight, 80.0, |out| out.mode == Mode::TautForce);
            run(&mut flight, 2.0);
            ask(&mut flight, mode);
        }
        Mode::Land | Mode::Return | Mode::Descent => {
            until(&mut flight, 80.0, |out| {
                out.mode == Mode::TetherHold && out.ground == GroundState::InAir
            });
            ask(&mut flight, mode);
        }
        _ => {}
    }
    until(&mut flight, 80.0, is_there);
    run(
        &mut flight,
        if matches!(mode, Mode::Stabilize | Mode::Offboard | Mode::Position) { 0.2 } else { 2.0 },
    );
    flight
}

/// Breaks it and watches for so long, or until the motors stand.
fn watch(flight: &mut Flight<Vec<u8>>, (kind, value): (FaultKind, f64), seconds: f64) {
    let start = *flight.step(&mut |_| {});
    let at = flight.world.now().0 as f64 * 1e-6;
    flight.world.environment.faults.add(FaultSection::new(kind, value, at));
    let told = flight.events.len();
    let end = flight.world.time() + seconds;
    let mut last = start;
    let what = format!("{:?} with {kind:?}", start.mode);
    while flight.world.time() < end && last.is_armed {
        flight.step(&mut |_| {});
        let out = flight.output();
        let comes_down = matches!(out.mode, Mode::Land | Mode::Descent) && out.mode != start.mode;
        if comes_down && out.is_armed {
            assert_ne!(out.failures, 0, "{what}: {:?} for no reason", out.mode);
        }
        let has_landed = last.ground == GroundState::OnGround;
        if !out.is_armed && !has_landed {
            assert_ne!(out.failures, 0, "{what}: motors stopped for no reason");
        }
        if out.mode != last.mode && out.is_armed {
            let has_taken_off =
                last.mode.rule().completes.is_some() && out.mode == Mode::TetherHold;
            assert!(has_taken_off || out.failures != 0, "{what}: {:?} unasked", out.mode);
        }
        last = *out;
    }
    let critical: Vec<_> = flight.events[told..]
        .iter()
        .filter(|(_, event)| event.severity == Severity::Critical)
        .map(|(_, event)| event.text)
        .collect();
    for text in &critical {
        assert_eq!(critical.iter().filter(|t| t == &text).count(), 1, "{what}: {critical:?}");
    }
    if last.failures != 0 {
        assert!(!critical.is_empty(), "{what}: failures {:b} and nobody told", last.failures);
    }
}

fn every_fault_in(mode: Mode) {
    for fault in FAULTS {
        watch(&mut in_mode(mode), fault, 25.0);
    }
}

/// A test a mode, so that they run beside each other.
macro_rules! every_fault {
    ($($name:ident: $mode:ident;)+) => {
        $(#[test]
        fn $name() {
            every_fault_in(Mode::$mode);
        })+

        #[test]
        fn every_mode_of_the_table_is_tried() {
            let tried = [$(Mode::$mode),+];
            for rule in &tautline_firmware::supervisor::MODES {
                assert!(tried.contains(&rule.mode), "{}", rule.name);
            }
        }
    };
}

every_fault! {
    every_fault_in_stabilize_is_told_and_carries_its_bit: Stabilize;
    every_fault_in_altitude_is_told_and_carries_its_bit: Altitude;
    every_fault_in_tether_hold_is_told_and_carries_its_bit: TetherHold;
    every_fault_in_takeoff_is_told_and_carries_its_bit: Takeoff;
    every_fault_in_land_is_told_and_carries_its_bit: Land;
    every_fault_in_descent_is_told_and_carries_its_bit: Descent;
    every_fault_in_taut_force_is_told_and_carries_its_bit: TautForce;
    every_fault_in_taut_attitude_is_told_and_carries_its_bit: TautAttitude;
    every_fault_in_tether_angle_is_told_and_carries_its_bit: TetherAngle;
    every_fault_in_pendulum_is_told_and_carries_its_bit: Pendulum;
    every_fault_in_return_is_told_and_carries_its_bit: Return;
    every_fault_in_position_is_told_and_carries_its_bit: Position;
    every_fault_in_offboard_is_told_and_carries_its_bit: Offboard;
}

/// The cable is cut; the first step of the descent.
fn cut_in(mode: Mode, seed: u64) -> (Flight<Vec<u8>>, StepOutput) {
    let mut flight = in_mode_of(mode, seed);
    let at = flight.world.now().0 as f64 * 1e-6;
    let kind = FaultKind::TetherBroken;
    flight.world.environment.faults.add(FaultSection::new(kind, 0.0, at));
    let out = until(&mut flight, 3.0, |out| out.mode == Mode::Descent);
    (flight, out)
}

#[test]
fn a_cut_cable_is_a_failure_from_the_first_step_of_the_descent() {
    for mode in [Mode::TautForce, Mode::TautAttitude, Mode::TetherAngle] {
        for seed in 1..=6 {
            let (_, out) = cut_in(mode, seed);
            assert_ne!(out.failures & 1 << Failure::TetherSlack as u32, 0, "{mode:?}, {seed}");
        }
    }
}

#[test]
fn no_mode_on_the_link_may_be_asked_back_while_the_link_is_gone() {
    let (mut flight, _) = cut_in(Mode::TetherAngle, 3);
    for mode in [Mode::TetherHold, Mode::Land, Mode::TetherAngle, Mode::TautForce] {
        let told = flight.events.len();
        ask(&mut flight, mode);
        let out = run(&mut flight, 0.1);
        assert_eq!(out.mode, Mode::Descent, "{mode:?} was entered");
        let texts = &flight.events[told..];
        assert!(texts.iter().any(|(_, e)| e.text.contains("failsafe is descending")), "{texts:?}");
    }
}

#[test]
fn a_failure_that_ended_a_flight_is_told_until_the_motors_stand() {
    let (mut flight, _) = cut_in(Mode::TautForce, 3);
    let slack = 1 << Failure::TetherSlack as u32;
    until(&mut flight, 60.0, |out| {
        assert!(!out.is_armed || out.failures & slack != 0, "forgotten at {:?}", out.now);
        !out.is_armed
    });
}

#[test]
fn a_take_off_that_does_not_lift_is_a_failure_that_stops_the_motors() {
    // A slack start waits for the height; and this weighs more than twice what the vehicle knows of.
    let mut scenario = scenario("taut-slack");
    scenario.vehicle.mass = 3.0;
    scenario.params.insert("VEH_MASS".into(), 1.2);
    let mut flight = fly(&scenario);
    until(&mut flight, 20.0, |out| out.is_armed);
    let out = until(&mut flight, 20.0, |out| !out.is_armed);
    assert_ne!(out.failures & 1 << Failure::NoLiftOff as u32, 0);
    let told = |text: &str| flight.events.iter().filter(|(_, e)| e.text.contains(text)).count();
    assert_eq!(told("Take-off failed: no lift-off"), 1);
}

#[test]
fn after_a_failsafe_landing_no_take_off_begins_until_the_motors_stood() {
    let (mut flight, _) = cut_in(Mode::TautForce, 3);
    until(&mut flight, 60.0, |out| out.ground == GroundState::OnGround);
    for mode in [Mode::Takeoff, Mode::TetherHold, Mode::Takeoff] {
        ask(&mut flight, mode);
        let out = run(&mut flight, 0.1);
        assert_eq!((out.mode, out.is_armed), (Mode::Descent, true));
    }
    assert!(flight.events.iter().any(|(_, e)| e.text == "Mode refused: failsafe is descending"));
}

/// Sets a parameter as a ground station does.
fn set(flight: &mut Flight<Vec<u8>>, name: &str, value: f32) {
    let message = PARAM_SET_DATA {
        param_value: value,
        target_system: 1,
        target_component: 1,
        param_id: CharArray::from(name),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
    };
    let frame = MavlinkSender::new(255, 190).frame(&message);
    flight.world.receive(&frame, &mut |_| {});
}

#[test]
fn a_pilots_escape_does_not_lift_the_ban_that_a_cut_cable_set() {
    let (mut flight, _) = cut_in(Mode::TetherAngle, 3);
    hold_sticks(&mut flight);
    run(&mut flight, 0.02);
    ask(&mut flight, Mode::Altitude);
    until(&mut flight, 0.2, |out| out.mode == Mode::Altitude);
    for mode in [Mode::TetherAngle, Mode::TetherHold] {
        ask(&mut flight, mode);
        let out = run(&mut flight, 0.05);
        assert_eq!(out.mode, Mode::Altitude);
        assert_ne!(out.failures & 1 << Failure::TetherSlack as u32, 0);
    }
}

/// Arms, whatever the checks say that may be forced.
fn arm(flight: &mut Flight<Vec<u8>>) {
    let message = COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        param1: 1.0,
        param2: 21196.0,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    };
    let frame = MavlinkSender::new(255, 190).frame(&message);
    flight.world.receive(&frame, &mut |_| {});
}

#[test]
fn a_parameter_set_just_before_arming_is_in_force_when_the_motors_start() {
    let mut flight = flight("", 1);
    until(&mut flight, 10.0, |out| out.estimate.is_levelled);
    // In the same millisecond: the vehicle takes one request a step.
    set(&mut flight, "TET_START_DIST", 3.0);
    arm(&mut flight);
    until(&mut flight, 0.1, |out| out.is_armed);
    // Until the filter's next step.
    let out = run(&mut flight, 0.02);
    assert!((out.estimate.position.unwrap().0.x - 3.0).abs() < 0.01, "{:?}", out.estimate.position);
}

#[test]
fn a_take_off_takes_the_altitude_that_the_parameters_say_when_it_begins() {
    let mission = "[[mission]]\ndo = \"await_disarmed\"\ntimeout = 100.0";
    let mut flight = flight(mission, 1);
    until(&mut flight, 10.0, |out| out.estimate.is_levelled);
    ask(&mut flight, Mode::Takeoff);
    run(&mut flight, 0.05);
    set(&mut flight, "TET_LENGTH", 4.5);
    let out = run(&mut flight, 0.05);
    assert_eq!(out.mode, Mode::Takeoff);
    // Five metres on 4.5 m of line: told on the ground, before any thrust.
    arm(&mut flight);
    until(&mut flight, 0.5, |out| out.is_armed);
    until(&mut flight, 0.5, |out| !out.is_armed);
    assert!(flight.events.iter().any(|(_, e)| e.text.contains("altitude beyond the tether")));
    assert!(flight.world.environment.plant.ground.is_touching());
}

#[test]
fn what_a_failsafe_flies_is_never_refused() {
    // The arbiter enters these whatever the vehicle knows.
    for action in [FailsafeAction::Hold, FailsafeAction::Land, FailsafeAction::Descend] {
        let mode = action.mode().unwrap();
        let mut flight = flight(HOLD, 1);
        until(&mut flight, 80.0, |out| {
            out.mode == Mode::Takeoff && out.ground == GroundState::InAir
        });
        ask(&mut flight, mode);
        until(&mut flight, 0.5, |out| out.mode == mode);
    }
}
