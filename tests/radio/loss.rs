//! The radio is lost, or says that it has lost its pilot, or is noisy.

use super::pilot::{
    LAND, POSITION, SHIPPED, breaks, hands, held_by_a_station, in_altitude, in_position, mode, told,
};
use tautline_firmware::signal::Severity;
use tautline_firmware::supervisor::{Failure, Mode};
use tautline_sitl::scenario::FaultKind;
use tautline_tests::{flight, run, until};

#[test]
fn a_lost_radio_in_position_holds_is_told_once_each_way_and_flies_on() {
    for kind in [FaultKind::RadioLost, FaultKind::RadioFailsafe] {
        for protocol in ["crsf", "sbus"] {
            let mut flight = in_position(protocol, "");
            let before = flight.events.len();
            breaks(&mut flight, kind, 0.0, 6.0);
            until(&mut flight, 1.5, |out| out.mode == Mode::TetherHold);
            run(&mut flight, 3.0);
            assert_eq!(told(&flight, before, "Radio lost"), 1);
            assert_eq!(told(&flight, before, "Radio is back"), 0);
            let out = run(&mut flight, 4.0);
            assert_eq!(told(&flight, before, "Radio is back"), 1);
            // It stays until the pilot asks: a switch that has not moved asks for nothing.
            assert_eq!((out.mode, out.failures), (Mode::TetherHold, 0), "{kind:?} {protocol}");
            hands(&mut flight, mode(LAND));
            assert_eq!(run(&mut flight, 0.3).mode, Mode::Land);
        }
    }
}

#[test]
fn a_lost_radio_in_altitude_ends_on_the_ground_at_a_descents_pace() {
    for kind in [FaultKind::RadioLost, FaultKind::RadioFailsafe] {
        let mut flight = in_altitude("crsf", "");
        breaks(&mut flight, kind, 0.0, 100.0);
        let out = until(&mut flight, 2.0, |out| out.mode == Mode::Descent);
        assert_ne!(out.failures & Failure::SticksLost.mask(), 0);
        until(&mut flight, 60.0, |out| !out.is_armed);
        let summary = flight.metrics.summary();
        assert!(summary.touch_down_mps.unwrap() < 1.0, "{summary:?}");
    }
}

#[test]
fn a_mode_that_flies_by_itself_goes_on_unless_a_parameter_says_otherwise() {
    let cases = [
        (0, Some(Mode::TetherHold)),
        (1, Some(Mode::TetherHold)),
        (2, Some(Mode::Land)),
        (3, Some(Mode::Descent)),
        (5, None),
        (6, None),
    ];
    for (action, expected) in cases {
        let mut flight = held_by_a_station(&format!("NAV_RCL_ACT = {action}"));
        let before = flight.events.len();
        breaks(&mut flight, FaultKind::RadioLost, 0.0, 100.0);
        let out = run(&mut flight, 2.0);
        assert_eq!(out.is_armed.then_some(out.mode), expected, "NAV_RCL_ACT {action}");
        let is_failure = out.failures & Failure::RadioLost.mask() != 0;
        assert_eq!(is_failure, action != 0 && out.is_armed);
        assert_eq!(told(&flight, before, "Radio lost"), 1);
        let critical = flight.events[before..].iter().filter(|(_, event)| {
            event.severity == Severity::Critical && event.text.contains("radio")
        });
        assert_eq!(critical.count(), usize::from(action != 0));
    }
}

#[test]
fn the_loss_waits_for_its_time() {
    let mut flight = held_by_a_station("NAV_RCL_ACT = 2\nCOM_RC_LOSS_T = 4.0");
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 3.5);
    let out = run(&mut flight, 6.0);
    assert_eq!((out.mode, out.failures), (Mode::TetherHold, 0));
    assert_eq!(told(&flight, 0, "Radio lost"), 0);
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 100.0);
    assert_eq!(run(&mut flight, 3.8).mode, Mode::TetherHold);
    until(&mut flight, 0.6, |out| out.mode == Mode::Land);
}

#[test]
fn a_flight_that_begins_without_a_radio_does_not_miss_it() {
    let text = "NAV_RCL_ACT = 5\n[[fault]]\nkind = \"radio_lost\"\nat = 2.0\n";
    let mut flight = held_by_a_station(text);
    assert!(run(&mut flight, 5.0).is_armed);
    assert_eq!(flight.output().failures, 0);
}

#[test]
fn a_noisy_line_costs_frames_and_not_the_flight() {
    // Of a thousand bits one turns: every fifth frame is lost.
    let noisy = SHIPPED.replace(
        "[[mission]]",
        "[[fault]]\nkind = \"radio_noise\"\nvalue = 0.001\nat = 0.0\n[[mission]]",
    );
    let mut flight = flight(&noisy, 2);
    until(&mut flight, 50.0, |out| out.mode == Mode::Land);
    until(&mut flight, 50.0, |out| !out.is_armed);
    assert_eq!(told(&flight, 0, "Radio lost"), 0);
    assert_eq!(flight.metrics.summary().lost, None);
    // So many turn that nothing whole arrives: the radio is lost, and not believed.
    let mut flight = in_position("crsf", "");
    breaks(&mut flight, FaultKind::RadioNoise, 0.2, 100.0);
    until(&mut flight, 2.0, |out| out.mode == Mode::TetherHold);
    assert!(run(&mut flight, 30.0).is_armed);
    assert_eq!(flight.output().mode, Mode::TetherHold);
}

#[test]
fn a_switch_that_was_moved_while_nobody_was_heard_acts_when_the_radio_is_back() {
    let mut flight = in_altitude("crsf", "");
    hands(&mut flight, mode(POSITION));
    run(&mut flight, 0.5);
    breaks(&mut flight, FaultKind::RadioFailsafe, 0.0, 3.0);
    run(&mut flight, 1.5);
    hands(&mut flight, mode(LAND));
    assert_eq!(run(&mut flight, 1.0).mode, Mode::TetherHold, "what is stuck moves nothing");
    until(&mut flight, 1.0, |out| out.mode == Mode::Land);
}
