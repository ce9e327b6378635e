//! Stick flight, and what the switches do.

use super::pilot::{
    ALTITUDE, LAND, POSITION, SHIPPED, arm, breaks, flown_by, hands, held_by_a_station,
    in_altitude, in_position, kill, mode, throttle, told,
};
use mavlink::dialects::common::{COMMAND_LONG_DATA, MavCmd};
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_sitl::flight::MavlinkSender;
use tautline_sitl::scenario::{FaultKind, RadioSection};
use tautline_tests::{flight, run, until};

#[test]
fn the_shipped_flight_goes_up_out_and_down_by_either_protocol_without_a_ground_station() {
    for protocol in ["crsf", "sbus"] {
        let mut flight = flight(&SHIPPED.replace("crsf", protocol), 4);
        let mut flown = vec![flight.output().mode];
        until(&mut flight, 90.0, |out| {
            if flown.last() != Some(&out.mode) {
                flown.push(out.mode);
            }
            assert_eq!(out.failures, 0);
            flown.contains(&Mode::Land) && !out.is_armed
        });
        let modes =
            [Mode::TetherHold, Mode::Altitude, Mode::Position, Mode::Land, Mode::TetherHold];
        assert_eq!(flown, modes, "{protocol}");
        assert_eq!(flight.world.connection.heartbeat_at(), None, "nobody else spoke");
        let summary = flight.metrics.summary();
        assert_eq!(summary.lost, None, "{summary:?}");
        assert!(summary.highest_m > 3.0);
    }
}

#[test]
fn the_pitch_stick_moves_the_vehicle_forward_and_the_roll_stick_to_the_right() {
    for (forward, right) in [(0.6, 0.0), (0.0, 0.6)] {
        let mut flight = in_position("crsf", "");
        let before = flight.world.environment.plant.body.position;
        let row =
            RadioSection { pitch: Some(forward), roll: Some(right), ..RadioSection::default() };
        hands(&mut flight, row);
        run(&mut flight, 2.5);
        let way = flight.world.environment.plant.body.position - before;
        let (along, across) = if forward > 0.0 { (way.x, way.y) } else { (way.y, way.x) };
        assert!(along > 0.6 && across.abs() < along / 2.0, "{way:?}");
    }
}

#[test]
fn arming_with_the_throttle_up_is_refused_and_only_another_flick_of_the_switch_asks_again() {
    let mut flight = flown_by("crsf", "", "");
    until(&mut flight, 20.0, |out| out.is_armable);
    hands(&mut flight, throttle(0.3));
    run(&mut flight, 0.2);
    let before = flight.events.len();
    hands(&mut flight, arm(true));
    run(&mut flight, 0.5);
    assert!(!flight.output().is_armed);
    assert_eq!(told(&flight, before, "Arming denied: throttle open"), 1);
    // A throttle that comes down with the switch on starts nothing.
    hands(&mut flight, throttle(0.0));
    assert!(!run(&mut flight, 2.0).is_armed);
    hands(&mut flight, arm(false));
    run(&mut flight, 0.2);
    hands(&mut flight, arm(true));
    assert!(run(&mut flight, 0.2).is_armed);
    hands(&mut flight, arm(false));
    assert!(!run(&mut flight, 0.2).is_armed, "on the ground the switch also stops them");
}

#[test]
fn a_switch_that_is_on_when_the_radio_is_first_heard_starts_nothing() {
    let mut flight = flown_by("crsf", "", "");
    hands(&mut flight, arm(true));
    hands(&mut flight, mode(POSITION));
    until(&mut flight, 20.0, |out| out.is_armable);
    let out = run(&mut flight, 2.0);
    assert_eq!((out.is_armed, out.mode), (false, Mode::TetherHold));
}

#[test]
fn the_arm_switch_does_not_stop_the_motors_in_the_air() {
    let mut flight = in_altitude("crsf", "");
    let before = flight.events.len();
    hands(&mut flight, arm(false));
    let out = run(&mut flight, 1.0);
    assert!(out.is_armed && out.ground == GroundState::InAir);
    assert_eq!(told(&flight, before, "Disarm refused: in the air"), 1);
}

#[test]
fn the_kill_switch_stops_the_motors_in_the_air_whoever_has_the_command_and_whatever_has_the_sticks()
{
    for params in ["COM_RC_IN_MODE = 0", "COM_RC_IN_MODE = 1", "COM_RC_IN_MODE = 2"] {
        let mut flight = held_by_a_station(params);
        let before = flight.events.len();
        hands(&mut flight, kill(true));
        let out = run(&mut flight, 0.1);
        assert!(!out.is_armed, "{params}");
        assert!(out.actuation.throttle.iter().all(|&throttle| throttle <= 0.0));
        assert_eq!(told(&flight, before, "Flight terminated: motors stopped"), 1);
    }
}

#[test]
fn with_the_kill_switch_on_nobody_arms_not_even_by_force() {
    let mut flight = flown_by("crsf", "", "");
    until(&mut flight, 20.0, |out| out.is_armable);
    hands(&mut flight, kill(true));
    assert!(!run(&mut flight, 0.2).is_armable);
    let forced = COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        param1: 1.0,
        param2: 21196.0,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    };
    let frame = MavlinkSender::new(255, 190).frame(&forced);
    flight.world.receive(&frame, &mut |_| {});
    assert!(!run(&mut flight, 0.2).is_armed);
    assert_eq!(told(&flight, 0, "Arming denied: kill switch is on"), 1);
    // Switched off with it on, the radio leaves it on.
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 100.0);
    run(&mut flight, 3.0);
    flight.world.receive(&frame, &mut |_| {});
    assert!(!run(&mut flight, 0.2).is_armed);
}

#[test]
fn a_mode_switch_that_trembles_holds_up_no_kill() {
    let mut flight = in_altitude("sbus", "");
    for step in 0..40 {
        hands(&mut flight, mode(if step % 2 == 0 { POSITION } else { ALTITUDE }));
        if step == 20 {
            hands(&mut flight, kill(true));
        }
        // A frame each.
        run(&mut flight, 0.013);
    }
    assert!(!flight.output().is_armed);
}

#[test]
fn a_slot_that_names_no_mode_of_ours_is_told_and_changes_nothing() {
    // PX4's mission mode.
    let mut flight = in_altitude("crsf", "COM_FLTMODE3 = 3");
    let before = flight.events.len();
    hands(&mut flight, mode(3));
    assert_eq!(run(&mut flight, 0.5).mode, Mode::Altitude);
    assert_eq!(told(&flight, before, "COM_FLTMODE names no mode of ours"), 1);
    hands(&mut flight, mode(2));
    assert_eq!(run(&mut flight, 0.5).mode, Mode::Altitude, "nothing is assigned to that one");
    hands(&mut flight, mode(LAND));
    assert_eq!(run(&mut flight, 0.5).mode, Mode::Land);
}
