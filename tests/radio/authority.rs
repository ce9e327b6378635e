//! Ground station and radio disagree: who wins.

use super::pilot::{
    ALTITUDE, POSITION, breaks, hands, held_by_a_station, in_position, joystick, mode, told,
};
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_sitl::flight::Flight;
use tautline_sitl::scenario::{FaultKind, RadioSection};
use tautline_tests::{ask, run, until};

/// Roll after the joystick was held to the right and the radio to the left.
fn roll_of_both(params: &str) -> f32 {
    let mut flight = held_by_a_station(params);
    joystick(&mut flight, 0, 500);
    hands(&mut flight, mode(POSITION));
    run(&mut flight, 0.2);
    ask(&mut flight, Mode::Altitude);
    hands(&mut flight, RadioSection { roll: Some(-0.6), ..RadioSection::default() });
    held(&mut flight, 600, 0.6);
    assert_eq!(flight.output().mode, Mode::Altitude);
    flight.output().estimate.attitude.euler().0
}

/// A joystick held for so long.
fn held(flight: &mut Flight<Vec<u8>>, roll: i16, seconds: f64) {
    let end = flight.world.time() + seconds;
    while flight.world.time() < end {
        joystick(flight, roll, 500);
        run(flight, 0.05);
    }
}

#[test]
fn a_pilot_who_is_heard_has_the_sticks_unless_the_parameter_gives_them_to_the_joystick() {
    assert!(roll_of_both("COM_RC_IN_MODE = 2") < -0.1);
    assert!(roll_of_both("COM_RC_IN_MODE = 0") < -0.1);
    assert!(roll_of_both("COM_RC_IN_MODE = 1") > 0.1);
}

#[test]
fn a_joystick_takes_over_while_the_radio_is_lost_and_gives_the_sticks_back() {
    let mut flight = held_by_a_station("");
    hands(&mut flight, mode(ALTITUDE));
    hands(&mut flight, mode(POSITION));
    run(&mut flight, 0.2);
    ask(&mut flight, Mode::Altitude);
    let before = flight.events.len();
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 4.0);
    held(&mut flight, 500, 3.5);
    let out = flight.output();
    assert_eq!((out.mode, out.failures), (Mode::Altitude, 0), "it flies on");
    assert!(out.estimate.attitude.euler().0 > 0.1, "by the joystick");
    assert_eq!(told(&flight, before, "Radio lost"), 1);
    held(&mut flight, 500, 1.5);
    assert!(flight.output().estimate.attitude.euler().0 < 0.1, "the pilot's are in their middle");
    assert_eq!(told(&flight, before, "Radio is back"), 1);
}

#[test]
fn without_the_fallback_a_joystick_does_not_count() {
    let mut flight = held_by_a_station("COM_RC_IN_MODE = 0");
    ask(&mut flight, Mode::Altitude);
    until(&mut flight, 0.5, |out| out.mode == Mode::Altitude);
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 100.0);
    held(&mut flight, 0, 2.0);
    assert_eq!(flight.output().mode, Mode::Descent);
}

#[test]
fn of_two_who_ask_for_a_mode_the_last_one_has_it() {
    let mut flight = held_by_a_station("");
    // The commander's hold, and the pilot takes it away; a switch acts when it moves.
    hands(&mut flight, mode(POSITION));
    assert_eq!(run(&mut flight, 0.2).mode, Mode::Position);
    ask(&mut flight, Mode::TetherHold);
    assert_eq!(run(&mut flight, 5.0).mode, Mode::TetherHold, "the switch has not moved since");
    hands(&mut flight, mode(ALTITUDE));
    assert_eq!(run(&mut flight, 0.2).mode, Mode::Altitude);
    ask(&mut flight, Mode::Land);
    let out = run(&mut flight, 2.0);
    assert_eq!((out.mode, out.ground), (Mode::Land, GroundState::Landing));
}

#[test]
fn who_flies_by_joystick_alone_has_a_radio_that_switches_nothing_but_off() {
    let mut flight = held_by_a_station("COM_RC_IN_MODE = 1");
    hands(&mut flight, mode(POSITION));
    hands(&mut flight, RadioSection { arm: Some(true), ..RadioSection::default() });
    assert_eq!(run(&mut flight, 1.0).mode, Mode::TetherHold);
}

#[test]
fn a_flight_that_a_pilot_armed_has_no_commander_until_a_station_asks() {
    let mut flight = in_position("crsf", "");
    assert_eq!(flight.output().commander, None);
    ask(&mut flight, Mode::TetherHold);
    let out = run(&mut flight, 0.2);
    assert_eq!((out.mode, out.commander), (Mode::TetherHold, Some(255)));
}

#[test]
fn a_ground_station_that_falls_silent_does_not_end_a_pilots_stick_flight() {
    let mut flight = held_by_a_station("");
    hands(&mut flight, mode(POSITION));
    run(&mut flight, 0.2);
    breaks(&mut flight, FaultKind::LinkLost, 0.0, 100.0);
    let out = run(&mut flight, 12.0);
    assert_eq!((out.mode, out.failures), (Mode::Position, 0));
    // With the pilot gone too nobody is left.
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 100.0);
    until(&mut flight, 3.0, |out| out.mode == Mode::Land);
    assert_eq!(told(&flight, 0, "Ground station lost"), 1);
}
