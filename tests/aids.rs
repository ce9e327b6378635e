//! Sensors beside the line's length and the altimeter, and a heading that nothing measures.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use mavlink::dialects::common::{COMMAND_LONG_DATA, MavCmd, WINCH_STATUS_DATA};
use tautline_firmware::mavlink::Connection;
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::time::Micros;
use tautline_sitl::flight::{Flight, MavlinkSender};
use tautline_sitl::metrics::PlaceSummary;
use tautline_sitl::scenario::{FaultKind, FaultSection};
use tautline_tests::{flight, run, until};

const COMPASS: &str =
    "[sensors]\nmagnetometer = true\nmagnetic_offset = 6e-7\nmagnetic_scale = 0.01";
const FAIRLEAD: &str = "[sensors]\nground_angles = true";
const ANGLES: &str = "[sensors]\nvehicle_angles = true";
const POSITION: &str = "[capture]\nrate = 10\nposition_noise = 0.02\ndelay = 0.05";
const FLOW: &str = "[capture]\nrate = 50\nposition = false\nvelocity_noise = 0.1";

/// Up to 45 degrees on a chain that the wind bends, hold and land.
fn scenario(sensors: &str, params: &str, wind: f64, hold: f64) -> String {
    format!(
        r#"
        {sensors}
        [station]
        supply_voltage = 400
        [tether]
        kind = "fixed"
        model = "chain"
        [wind]
        speed = {wind}
        gusts = true
        [params]
        {params}
        [[mission]]
        do = "arm"
        [[mission]]
        do = "takeoff"
        altitude = 7.07
        [[mission]]
        do = "hold"
        seconds = {hold}
        [[mission]]
        do = "land"
        "#
    )
}

fn holding(sensors: &str, params: &str, wind: f64) -> Flight<Vec<u8>> {
    let mut flight = flight(&scenario(sensors, params, wind, 1e5), 4);
    until(&mut flight, 90.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    run(&mut flight, 10.0);
    flight
}

fn flown(sensors: &str, wind: f64) -> PlaceSummary {
    let mut flight = flight(&scenario(sensors, "", wind, 40.0), 4);
    until(&mut flight, 200.0, |out| out.mode == Mode::Land);
    until(&mut flight, 120.0, |out| !out.is_armed);
    assert_eq!(flight.metrics.summary().lost, None);
    flight.metrics.summary().place.unwrap()
}

fn told(flight: &Flight<Vec<u8>>, text: &str) -> usize {
    flight.events.iter().filter(|(_, e)| e.text == text).count()
}

/// Azimuth from the anchor and heading: estimated less true, rad.
fn turned(flight: &Flight<Vec<u8>>) -> (f64, f64) {
    let (out, plant) = (flight.output(), &flight.world.environment.plant);
    let truth = plant.from_anchor();
    let azimuth = f64::from(out.estimate.tether.unwrap().azimuth) - truth.y.atan2(truth.x);
    let yaw = f64::from(out.estimate.attitude.euler().2) - plant.body.attitude.euler_angles().2;
    let wrap = |angle: f64| angle.sin().atan2(angle.cos());
    (wrap(azimuth), wrap(yaw))
}

fn breaks(flight: &mut Flight<Vec<u8>>, kind: FaultKind, value: f64, duration: f64) {
    let at = flight.world.now().0 as f64 * 1e-6;
    let duration = Some(duration);
    flight
        .world
        .environment
        .faults
        .add(FaultSection { duration, ..FaultSection::new(kind, value, at) });
}

#[test]
fn each_sensor_of_the_place_says_more_than_the_moving_tension_alone() {
    let none = flown("", 5.0).estimate_rms_m;
    for (sensors, most) in [(FLOW, 0.15), (ANGLES, 0.15), (FAIRLEAD, 0.12), (POSITION, 0.03)] {
        let error = flown(sensors, 5.0).estimate_rms_m;
        assert!(error < most && error < none, "{sensors}: {error} m, without {none} m");
    }
}

#[test]
fn a_compass_finds_the_nose_and_keeps_it() {
    // The operator is wrong by 17 degrees of where the nose points, and the vehicle stands where he says.
    let mut flight = flight(&scenario(COMPASS, "TET_HDG0 = 0.3", 3.0, 1e5), 4);
    until(&mut flight, 10.0, |out| out.is_armed);
    let yaw = flight.output().estimate.attitude.euler().2;
    assert!(yaw.abs() < 0.06, "{yaw}");
    until(&mut flight, 90.0, |out| out.mode == Mode::TetherHold && out.is_armed);
    run(&mut flight, 600.0);
    let (_, yaw) = turned(&flight);
    assert!(yaw.abs() < 0.052, "{yaw}");
    assert_eq!(told(&flight, "Heading unsure: nothing measures it"), 0);
}

#[test]
fn a_heading_that_nothing_measures_is_told_before_it_is_fifteen_degrees_wrong() {
    let mut flight = holding("", "", 3.0);
    let text = "Heading unsure: nothing measures it";
    let mut worst = 0.0_f64;
    while told(&flight, text) == 0 {
        run(&mut flight, 1.0);
        worst = worst.max(turned(&flight).0.abs());
        assert!(flight.world.time() < 600.0);
    }
    assert!(worst < 0.26, "{worst}");
    run(&mut flight, 300.0);
    let estimate = &flight.output().estimate;
    let sd = f64::from(estimate.heading_sd);
    assert!(turned(&flight).0.abs() < 3.0 * sd, "{:?} {sd}", turned(&flight));
    // What turns about the anchor is unsure across, not along.
    let [[along, across, _]] = estimate.position_sd.data.0;
    assert!(f64::from(across) > 6.0 * sd && f64::from(along) < 4.0 * sd, "{along} {across}");
    assert_eq!(told(&flight, text), 1);
}

#[test]
fn an_operator_who_says_where_the_nose_points_turns_place_and_heading() {
    let mut flight = holding("", "TET_HDG0 = 0.3", 0.0);
    let (azimuth, yaw) = turned(&flight);
    assert!((azimuth - 0.3).abs() < 0.06 && (yaw - 0.3).abs() < 0.03, "{azimuth} {yaw}");
    let heading = flight.world.environment.plant.body.attitude.euler_angles().2 as f32;
    let command = COMMAND_LONG_DATA {
        param1: heading.to_degrees(),
        command: MavCmd::MAV_CMD_FIXED_MAG_CAL_YAW,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    };
    flight.world.receive(&MavlinkSender::new(255, 190).frame(&command), &mut |_| {});
    run(&mut flight, 0.5);
    let (azimuth, yaw) = turned(&flight);
    assert!(azimuth.abs() < 0.06 && yaw.abs() < 0.03, "{azimuth} {yaw}");
    // It flies back to where it was asked to be.
    run(&mut flight, 30.0);
    assert!(flight.world.environment.plant.from_anchor().y > 1.5);
    assert!(turned(&flight).0.abs() < 0.06);
}

#[test]
fn a_station_that_lies_about_the_azimuth_is_told_and_flown_without() {
    let mut flight = holding(FAIRLEAD, "", 3.0);
    breaks(&mut flight, FaultKind::FairleadOffset, 0.35, 60.0);
    run(&mut flight, 20.0);
    let text = "Station's line direction contradicts: not used";
    assert_eq!(told(&flight, text), 1);
    assert!(turned(&flight).0.abs() < 0.06, "{:?}", turned(&flight));
}

#[test]
fn a_disturbed_compass_is_told_and_flown_without() {
    let mut flight = holding(COMPASS, "", 3.0);
    breaks(&mut flight, FaultKind::CompassDisturbed, 40.0, 60.0);
    run(&mut flight, 20.0);
    assert_eq!(told(&flight, "Compass contradicts: not used"), 1);
    assert!(turned(&flight).1.abs() < 0.1, "{:?}", turned(&flight));
}

#[test]
fn a_sensor_that_is_wanted_and_not_there_is_told_and_flown_without() {
    let mut flight = holding("", "EST_AIDS = 10", 3.0);
    assert_eq!(told(&flight, "Compass silent: flying without"), 1);
    assert_eq!(told(&flight, "Station's line direction silent: flying without"), 1);
    assert!(turned(&flight).0.abs() < 0.06);
    run(&mut flight, 10.0);
    assert_eq!(told(&flight, "Compass silent: flying without"), 1, "once");
}

#[test]
fn an_encoder_that_slips_a_metre_moves_nothing() {
    let text = scenario("", "", 3.0, 1e5).replace("\"fixed\"", "\"winch\"");
    let mut flight = flight(&text, 4);
    until(&mut flight, 90.0, |out| out.mode == Mode::TetherHold && out.is_armed);
    run(&mut flight, 5.0);
    breaks(&mut flight, FaultKind::EncoderOffset, 1.0, 3.0);
    for _ in 0..100 {
        run(&mut flight, 0.1);
        let plant = &flight.world.environment.plant;
        let reference = flight.output().reference.unwrap().position.0.map(f64::from);
        assert!((plant.from_anchor() - reference).norm() < 1.0);
    }
    assert_eq!(told(&flight, "Line length jumped: taken out"), 1, "there and back, once");
}

#[test]
fn a_flow_sensor_and_a_receiver_are_fitted_by_one_word_each() {
    let plain = flown("", 5.0).estimate_rms_m;
    let flow = flown("[sensors]\nflow = true", 5.0).estimate_rms_m;
    let rtk = flown("[sensors]\ngnss = \"rtk\"", 5.0).estimate_rms_m;
    assert!(flow < 0.8 * plain && rtk < 0.05, "{plain} {flow} {rtk}");
}

#[test]
fn a_plain_receiver_that_wanders_by_metres_does_not_carry_the_vehicle_along() {
    // It may be as wrong as the line lets it, and no more: 1.2 m of wandering are not followed.
    let off = flown("[sensors]\ngnss = \"plain\"", 5.0).estimate_rms_m;
    assert!(off < 1.0, "{off}");
}

#[test]
fn measurements_are_taken_from_the_system_and_the_component_that_are_named() {
    let winch = WINCH_STATUS_DATA { line_length: 7.0, ..WINCH_STATUS_DATA::default() };
    let is_taken = |from: (u32, u8), aid_system: f32, aid_component: f32| {
        let params = Params { aid_system, aid_component, ..Params::default() };
        let bytes = MavlinkSender::new(from.0, from.1).frame(&winch);
        let mut link = Connection::new();
        link.receive_datagram(Micros(1000), &bytes, &params, &mut |_| {});
        let is_taken = link.take_sensors().tether.is_some();
        assert_eq!(link.counters().refused, u32::from(!is_taken));
        is_taken
    };
    for from in [(1, 169), (1, 7)] {
        assert!(is_taken(from, 0.0, 0.0) && !is_taken(from, 42.0, 0.0), "{from:?}");
    }
    assert!(is_taken((1, 169), 0.0, 169.0) && !is_taken((1, 7), 0.0, 169.0));
    assert!(is_taken((42, 169), 42.0, 169.0) && !is_taken((42, 7), 42.0, 169.0));
    assert!(!is_taken((1, 169), 42.0, 169.0) && !is_taken((42, 169), 0.0, 169.0));
}
