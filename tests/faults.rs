//! Every injected fault ends in its named safe state.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use tautline_firmware::signal::ImuHealth;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;
use tautline_sitl::flight::Flight;
use tautline_sitl::scenario::{FaultKind, FaultSection};
use tautline_tests::{HOLD, flight, run, until};

/// In the hold for a few seconds, then broken.
fn broken_in_hold(kind: FaultKind, value: f64) -> Flight<Vec<u8>> {
    let mut flight = flight(HOLD, 3);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    run(&mut flight, 5.0);
    let at = flight.world.now().0 as f64 * 1e-6;
    flight.world.environment.faults.add(FaultSection::new(kind, value, at));
    flight
}

fn told(flight: &Flight<Vec<u8>>, text: &str) -> bool {
    flight.events.iter().any(|(_, e)| e.text.contains(text))
}

/// Goes on until disarmed; the last step before it, and the sink rate at the ground.
fn down(flight: &mut Flight<Vec<u8>>, limit: f64) -> StepOutput {
    let out = until(flight, limit, |out| !out.is_armed);
    run(flight, 3.0);
    assert!(flight.world.environment.plant.ground.is_touching(), "not on the ground");
    assert!(flight.world.environment.plant.thrust() < 1.0, "motors still turn");
    out
}

fn upright(flight: &Flight<Vec<u8>>) -> bool {
    flight.world.environment.plant.body.tilt() < 0.3
}

#[test]
fn an_imu_that_stays_away_ends_in_a_blind_descent_and_motors_off_last() {
    for (kind, health) in [
        (FaultKind::ImuFrozen, ImuHealth::Frozen),
        (FaultKind::ImuSilent, ImuHealth::Stale),
        (FaultKind::ImuDead, ImuHealth::Frozen),
    ] {
        let mut flight = broken_in_hold(kind, 0.0);
        let began = flight.world.time();
        let out = until(&mut flight, 1.0, |out| out.mode == Mode::Descent);
        assert_eq!(out.sensors.imu_health, health);
        assert!(told(&flight, "IMU lost: descending blind"));
        let out = until(&mut flight, 2.0, |out| !out.is_armed);
        assert!((1.4..1.7).contains(&(flight.world.time() - began)), "{kind:?}");
        assert!(told(&flight, "IMU lost: motors off"));
        assert!(out.actuation.throttle.iter().all(|&u| u == 0.0));
    }
}

#[test]
fn an_inertial_gap_is_flown_through_whatever_its_kind() {
    for kind in [FaultKind::ImuFrozen, FaultKind::ImuSilent, FaultKind::ImuDead] {
        let mut flight = broken_in_hold(kind, 0.0);
        run(&mut flight, 0.2);
        flight.world.environment.faults.clear(kind);
        let out = run(&mut flight, 20.0);
        assert_eq!((out.mode, out.is_armed), (Mode::TetherHold, true), "{kind:?}");
        assert_eq!(flight.metrics.verdict.lost, None);
    }
}

#[test]
fn every_other_inertial_sample_lands_and_a_clipped_axis_descends_softly() {
    for (kind, value, mode, text) in [
        (FaultKind::ImuRate, 500.0, Mode::Land, "IMU sample rate wrong"),
        (FaultKind::AccelClip, 0.0, Mode::Descent, "IMU out of range"),
    ] {
        let mut flight = broken_in_hold(kind, value);
        until(&mut flight, 5.0, |out| out.mode == mode);
        assert!(told(&flight, text));
        down(&mut flight, 90.0);
        assert_eq!(flight.metrics.verdict.lost, None, "{kind:?}");
        assert!(flight.metrics.verdict.touch_down.unwrap() < 0.8);
    }
}

#[test]
fn a_lost_rangefinder_changes_to_the_barometer_and_nothing_else() {
    let mut flight = broken_in_hold(FaultKind::RangefinderLost, 0.0);
    let out = run(&mut flight, 20.0);
    assert!(!out.sensors.altitude_is_ranged && out.sensors.altitude_is_fresh);
    assert_eq!((out.mode, out.failures), (Mode::TetherHold, 0));
    assert!((flight.world.environment.plant.body.height() - 5.0).abs() < 1.0);
}

#[test]
fn without_any_altimeter_it_descends_level_and_stops() {
    let mut flight = broken_in_hold(FaultKind::AltimeterLost, 0.0);
    until(&mut flight, 3.0, |out| out.mode == Mode::Descent);
    assert!(told(&flight, "Altimeter lost: descending"));
    down(&mut flight, 60.0);
    assert!(upright(&flight));
    assert!(
        flight.metrics.verdict.touch_down.unwrap() < 2.5,
        "{:?}",
        flight.metrics.verdict.touch_down
    );
}

#[test]
fn a_broken_tether_ends_in_a_level_descent() {
    let mut flight = broken_in_hold(FaultKind::TetherBroken, 0.0);
    until(&mut flight, 10.0, |out| out.mode == Mode::Descent);
    down(&mut flight, 60.0);
    assert!(upright(&flight));
    assert!(
        flight.metrics.verdict.touch_down.unwrap() < 1.0,
        "{:?}",
        flight.metrics.verdict.touch_down
    );
}

#[test]
fn a_silent_winch_ends_in_a_landing() {
    let mut flight = broken_in_hold(FaultKind::WinchSilent, 0.0);
    until(&mut flight, 3.0, |out| out.mode == Mode::Land);
    assert!(told(&flight, "Tether length lost: landing"));
    down(&mut flight, 90.0);
    assert!(upright(&flight));
}

#[test]
fn a_low_battery_ends_in_a_landing_and_a_critical_one_in_a_descent() {
    let mut flight = broken_in_hold(FaultKind::BatteryAt, 0.06);
    until(&mut flight, 20.0, |out| out.mode == Mode::Land);
    down(&mut flight, 90.0);
    let mut flight = broken_in_hold(FaultKind::BatteryAt, 0.0);
    until(&mut flight, 20.0, |out| out.mode == Mode::Descent);
    down(&mut flight, 60.0);
    assert!(upright(&flight));
}

#[test]
fn a_lost_link_ends_in_a_landing() {
    let mut flight = broken_in_hold(FaultKind::LinkLost, 0.0);
    until(&mut flight, 6.5, |out| out.mode == Mode::Land);
    assert!(told(&flight, "Ground station lost"));
    down(&mut flight, 90.0);
    assert!(told(&flight, "Landed, disarmed"));
    let p = flight.world.environment.plant.body.position;
    assert!(p.x.hypot(p.y) < 2.0, "far from where it started: {p}");
}

#[test]
fn a_sudden_gyro_bias_costs_a_few_degrees_and_the_hold_goes_on() {
    let mut flight = broken_in_hold(FaultKind::GyroBias, 0.02);
    let out = run(&mut flight, 30.0);
    assert_eq!((out.mode, out.is_armed, out.failures), (Mode::TetherHold, true, 0));
    // 1.1 °/s on every axis: without the accelerometer's pull the tilt would be 34° off by now.
    assert!(flight.metrics.tilt.max < 0.15, "{:?}", flight.metrics.tilt);
}

#[test]
fn a_fault_on_the_ground_refuses_arming_and_a_fault_while_armed_there_disarms() {
    let mut flight = flight(
        "[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"await_disarmed\"\ntimeout = 60.0",
        1,
    );
    until(&mut flight, 10.0, |out| out.is_armed);
    let at = flight.world.now().0 as f64 * 1e-6;
    let silent = FaultSection::new(FaultKind::WinchSilent, 0.0, at);
    flight.world.environment.faults.add(silent);
    until(&mut flight, 3.0, |out| !out.is_armed);
    assert!(told(&flight, "Disarmed: failsafe on the ground"));
    let out = run(&mut flight, 1.0);
    assert!(!out.is_armable);
}

#[test]
fn armed_on_the_ground_without_takeoff_the_motors_stop_by_themselves() {
    let mut flight = flight(
        "[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"await_disarmed\"\ntimeout = 60.0",
        1,
    );
    until(&mut flight, 10.0, |out| out.is_armed);
    until(&mut flight, 20.0, |out| !out.is_armed);
    assert!(told(&flight, "Disarmed: no take-off"));
}

#[test]
fn a_ground_station_breaks_and_mends_a_running_simulation() {
    use tautline_sitl::flight::MavlinkSender;
    let mut flight = flight(HOLD, 3);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    let mut station = MavlinkSender::new(255, 190);
    let mut inject = |flight: &mut Flight<Vec<u8>>, failure: f32| {
        let message = mavlink::dialects::common::COMMAND_LONG_DATA {
            command: mavlink::dialects::common::MavCmd::MAV_CMD_INJECT_FAILURE,
            // The rangefinder.
            param1: 7.0,
            param2: failure,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        };
        let mut answers = 0;
        flight.world.receive(&station.frame(&message), &mut |_| answers += 1);
        assert_eq!(answers, 1);
        run(flight, 1.0).sensors.altitude_is_ranged
    };
    assert!(!inject(&mut flight, 1.0), "off");
    assert!(!inject(&mut flight, 0.5), "no type of MAVLink's: nothing mended");
    assert!(inject(&mut flight, 0.0), "on again");
}
