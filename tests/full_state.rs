//! The full-state filter in flight: where it hangs, in wind, and what it does when something breaks.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use tautline_firmware::signal::PositionSource;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;
use tautline_sitl::flight::Flight;
use tautline_sitl::metrics::PlaceSummary;
use tautline_sitl::scenario::{Axis, FaultKind, FaultSection};
use tautline_tests::{flight, run, until};

/// Takes off to 45 degrees and holds.
fn scenario(kind: &str, wind: f64, params: &str) -> String {
    format!(
        r#"
        [tether]
        kind = "{kind}"
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
        seconds = 40.0
        [[mission]]
        do = "land"
        "#
    )
}

fn holding(kind: &str, wind: f64, params: &str, seed: u64) -> Flight<Vec<u8>> {
    let mut flight = flight(&scenario(kind, wind, params), seed);
    until(&mut flight, 90.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    run(&mut flight, 5.0);
    flight
}

fn flown(kind: &str, wind: f64, params: &str) -> PlaceSummary {
    let mut flight = holding(kind, wind, params, 2);
    until(&mut flight, 120.0, |out| !out.is_armed);
    assert!(flight.metrics.summary().lost.is_none());
    flight.metrics.summary().place.unwrap()
}

fn breaks(flight: &mut Flight<Vec<u8>>, kind: FaultKind, value: f64, duration: Option<f64>) {
    let at = flight.world.now().0 as f64 * 1e-6;
    flight
        .world
        .environment
        .faults
        .add(FaultSection { duration, ..FaultSection::new(kind, value, at) });
}

fn told(flight: &Flight<Vec<u8>>, text: &str) -> usize {
    flight.events.iter().filter(|(_, e)| e.text == text).count()
}

#[test]
fn in_wind_it_knows_its_place_three_times_as_well_as_the_simple_filter() {
    for kind in ["fixed", "winch"] {
        let full = flown(kind, 5.0, "");
        let simple = flown(kind, 5.0, "EST_KIND = 0");
        let (ours, theirs) = (full.estimate_rms_m, simple.estimate_rms_m);
        assert!(ours < 0.3 && ours < theirs / 3.0, "{kind}: {ours} {theirs}");
        assert_eq!(full.restarts, 0);
    }
}

#[test]
fn a_pilot_who_holds_the_tension_still_sees_what_becomes_of_the_accuracy() {
    let (moved, still) = (flown("winch", 5.0, ""), flown("winch", 5.0, "TET_DITHER = 0"));
    assert!(still.estimate_rms_m > 1.5 * moved.estimate_rms_m, "{still:?} {moved:?}");
}

#[test]
fn the_tension_moves_in_the_hold_and_rests_near_the_ground() {
    let mut flight = flight(&scenario("winch", 0.0, ""), 1);
    let span = |flight: &mut Flight<Vec<u8>>, seconds: f64| {
        let end = flight.world.time() + seconds;
        let mut range = (f32::MAX, f32::MIN);
        while flight.world.time() < end {
            let tension = run(flight, 0.02).actuation.winch.tension;
            range = (range.0.min(tension), range.1.max(tension));
        }
        range
    };
    until(&mut flight, 10.0, |out| out.estimate.source == PositionSource::FullState);
    let (low, high) = span(&mut flight, 0.3);
    assert!(high - low < 0.1, "{low} {high}");
    until(&mut flight, 90.0, |out| out.mode == Mode::TetherHold && out.is_armed);
    run(&mut flight, 5.0);
    let (low, high) = span(&mut flight, 3.0);
    assert!((low - 4.0).abs() < 0.1 && (high - 9.0).abs() < 0.1, "{low} {high}");
}

#[test]
fn a_heavy_line_is_not_shaken() {
    let heavy = scenario("winch", 0.0, "TET_LIN_DENS = 0.03\nTET_TENSION = 8");
    let mut flight = flight(&heavy, 1);
    until(&mut flight, 90.0, |out| out.mode == Mode::TetherHold && out.is_armed);
    run(&mut flight, 8.0);
    for _ in 0..100 {
        let out = run(&mut flight, 0.02);
        assert!((out.actuation.winch.tension - 8.0).abs() < 0.01, "{:?}", out.actuation);
    }
}

/// From a cut in the hold to the end of the descent: when it was told, s, and the largest way, m.
fn cut(kind: &str, wind: f64, seed: u64) -> (f64, f64) {
    let mut flight = holding(kind, wind, "", seed);
    let place = |flight: &Flight<Vec<u8>>| flight.world.environment.plant.body.position;
    let (began, from) = (flight.world.time(), place(&flight));
    breaks(&mut flight, FaultKind::TetherBroken, 0.0, None);
    let mut far = 0.0_f64;
    until(&mut flight, 3.0, |out: &StepOutput| out.mode == Mode::Descent);
    let after = flight.world.time() - began;
    while flight.output().is_armed {
        run(&mut flight, 0.1);
        let way = place(&flight) - from;
        far = far.max(way.x.hypot(way.y));
    }
    let gone = told(&flight, "Tether gone: descending");
    assert_eq!((gone, told(&flight, "Tether slack: descending")), (1, 0));
    (after, far)
}

#[test]
fn a_cut_cable_is_missed_within_two_seconds_and_the_vehicle_stops() {
    for kind in ["fixed", "winch"] {
        for (wind, most) in [(0.0, 15.0), (3.0, 30.0)] {
            let (after, far) = cut(kind, wind, 2);
            assert!(after < 2.0 && far < most, "{kind} {wind}: {after} s, {far} m");
        }
    }
}

#[test]
fn a_gyro_that_lies_for_a_second_costs_a_restart_and_not_the_vehicle() {
    let mut flight = holding("winch", 3.0, "", 2);
    breaks(&mut flight, FaultKind::GyroBias, 0.17, Some(1.0));
    until(&mut flight, 120.0, |out| !out.is_armed);
    assert!(told(&flight, "Position filter began anew") <= 2);
    let plant = &flight.world.environment.plant;
    assert!(plant.body.tilt() < 0.2 && told(&flight, "Landed, disarmed") == 1);
}

#[test]
fn a_gyro_whose_bias_changes_is_learnt_anew_and_told() {
    for (axis, value) in [(Axis::X, 0.02), (Axis::X, -0.02)] {
        let mut flight = holding("winch", 3.0, "", 2);
        let from = flight.world.environment.plant.body.position;
        let at = flight.world.time();
        let fault =
            FaultSection { axis: Some(axis), ..FaultSection::new(FaultKind::GyroBias, value, at) };
        flight.world.environment.faults.add(fault);
        let mut far = 0.0_f64;
        for _ in 0..250 {
            run(&mut flight, 0.1);
            let way = flight.world.environment.plant.body.position - from;
            far = far.max(way.x.hypot(way.y));
        }
        let told = told(&flight, "Gyro bias changed: learnt anew");
        assert!(far < 5.0 && told == 1, "{axis:?} {value}: {far} m, told {told}");
        until(&mut flight, 120.0, |out| !out.is_armed);
        assert!(flight.metrics.summary().lost.is_none(), "{axis:?} {value}");
    }
}

#[test]
fn it_takes_off_and_lands_where_the_wind_takes_a_third_of_the_tension() {
    for (kind, wind) in [("winch", 10.0), ("fixed", 8.0)] {
        let mut flight = holding(kind, wind, "", 5);
        until(&mut flight, 120.0, |out| !out.is_armed);
        let summary = flight.metrics.summary();
        assert!(summary.lost.is_none(), "{kind}: {:?}", summary.lost);
        assert!(summary.touch_down_drift_mps.unwrap() < 1.0, "{summary:?}");
    }
}
