//! Situations from public bug reports that once ended badly, flown whole: what should happen does.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use tautline_firmware::supervisor::Mode;
use tautline_sitl::flight::Progress;
use tautline_tests::{flown, is_safe, told};

#[test]
fn an_accelerometer_that_is_off_by_a_tenth_is_refused_with_the_reason_once() {
    for off in ["-1.0", "1.0"] {
        let flight = flown(&format!("[params]\nCAL_ACC_ZOFF = {off}"), 1, 100.0);
        assert_eq!(*flight.mission.progress(), Progress::Failed("never armed".into()));
        assert_eq!(told(&flight, "accelerometer off"), 1);
        assert!(!flight.metrics.verdict.has_armed);
    }
}

#[test]
fn one_that_goes_off_in_flight_is_flown_home_and_switched_off() {
    let fault = "[[fault]]\nkind = \"accel_bias\"\nvalue = 1.0\naxis = \"z\"\nat = 50.0";
    is_safe(&flown(fault, 1, 300.0));
}

#[test]
fn a_barometer_alone_that_wanders_does_not_keep_the_motors_on() {
    let world =
        "[sensors]\npressure_drift = 1.0\n[[fault]]\nkind = \"rangefinder_lost\"\nat = 50.0";
    is_safe(&flown(world, 2, 300.0));
}

#[test]
fn an_old_battery_is_found_out_before_lift_off() {
    let flight = flown("[battery]\nresistance = 0.15\ncharge = 0.5", 1, 60.0);
    assert_eq!(told(&flight, "battery sags under load"), 1);
    assert_eq!(told(&flight, "no lift-off"), 0);
    assert!(flight.metrics.verdict.highest < 0.3);
    is_safe(&flight);
}

#[test]
fn an_empty_battery_comes_down_where_it_is() {
    for seed in [1, 2] {
        let world = "[[fault]]\nkind = \"battery_at\"\nvalue = 0.02\nat = 45.0";
        let flight = flown(world, seed, 120.0);
        assert_eq!(told(&flight, "Battery critical"), 1);
        assert!(flight.metrics.verdict.touch_down_drift.unwrap() < 0.5);
        is_safe(&flight);
    }
}

#[test]
fn a_payload_is_carried_at_the_height_that_was_asked_and_told() {
    let flight = flown("[params]\nVEH_MASS = 1.3", 1, 200.0);
    assert!(flight.metrics.hold_vertical.rms().unwrap() < 0.15);
    assert_eq!(told(&flight, "Thrust or mass"), 1);
    is_safe(&flight);
}

#[test]
fn a_line_that_ends_early_is_told_and_the_take_off_is_not_called_complete() {
    let flight = flown("[tether]\nwinch_length_max = 6.0", 1, 200.0);
    assert_eq!((told(&flight, "Line caught"), told(&flight, "Take-off complete")), (1, 0));
    is_safe(&flight);
}

#[test]
fn vibration_of_a_g_is_flown_and_told() {
    let flight = flown("[sensors]\nvibration = 10.0", 1, 200.0);
    assert_eq!(*flight.mission.progress(), Progress::Done);
    assert_eq!(told(&flight, "High vibration"), 1);
    assert_eq!(told(&flight, "began anew"), 0);
    is_safe(&flight);
}

#[test]
fn a_landing_in_seven_metres_a_second_ends_on_its_pad() {
    let flight = flown("[wind]\nspeed = 7.0\ngusts = true", 1, 200.0);
    assert!(flight.metrics.verdict.from_pad.unwrap() < 1.0);
    is_safe(&flight);
}

#[test]
fn an_altimeter_that_lies_is_told_and_costs_no_height() {
    for (fault, text) in [
        ("kind = \"range_stuck\"\nvalue = 0.4", "Rangefinder contradicts"),
        ("kind = \"range_offset\"\nvalue = 2.0", "Rangefinder contradicts"),
        ("kind = \"range_stuck\"", "Rangefinder contradicts"),
        ("kind = \"barometer_offset\"\nvalue = 5.0", "Barometer contradicts"),
    ] {
        let flight = flown(&format!("[[fault]]\n{fault}\nat = 50.0"), 1, 200.0);
        let (at, _) = *flight.events.iter().find(|(_, e)| e.text.contains(text)).unwrap();
        assert!(at < 55.0, "{fault}: told after {at} s");
        assert!(flight.metrics.hold_vertical.max < 0.6, "{fault}");
        is_safe(&flight);
    }
}

#[test]
fn parameters_that_cannot_fly_are_refused_with_their_rule() {
    for (param, text) in [
        ("TPC_THR_MIN = 100.0", "TPC_THR_MIN"),
        ("TPC_TILT_MAX = 0.1", "TPC_TILT_MAX"),
        ("RATE_P = 200.0", "RATE_P"),
        ("EKF4_R_ACC = 10.0", "EKF4"),
    ] {
        let flight = flown(&format!("[params]\n{param}"), 1, 100.0);
        assert_eq!(told(&flight, text), 1, "{param}");
        assert_eq!(flight.output().mode, Mode::TetherHold);
        assert!(!flight.metrics.verdict.has_armed);
    }
}
