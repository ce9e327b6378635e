//! Whole flights in the simulator, judged against its truth.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use tautline_firmware::signal::Event;
use tautline_sitl::campaign::{Limits, fly};
use tautline_sitl::flight::{Flight, Progress};
use tautline_sitl::scenario::Scenario;
use tautline_tests::flight;

fn scenario(name: &str) -> Scenario {
    let path = format!("{}/../sitl/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scenario::load(path.as_ref()).unwrap()
}

#[test]
fn a_calm_flight_on_the_winch_meets_its_bounds() {
    let limits = Limits {
        hold_horizontal_rms_m: Some(0.4),
        hold_vertical_rms_m: Some(0.15),
        touch_down_mps: Some(0.7),
        attitude_rms_rad: Some(0.035),
        ..Limits::default()
    };
    let outcome = fly(&scenario("calm"), 1, &limits);
    assert!(outcome.pass, "{outcome:?}");
}

#[test]
fn a_calm_flight_on_a_fixed_tether_meets_the_same_bounds() {
    let limits = Limits {
        hold_horizontal_rms_m: Some(0.4),
        hold_vertical_rms_m: Some(0.15),
        touch_down_mps: Some(0.7),
        ..Limits::default()
    };
    let outcome = fly(&scenario("fixed"), 1, &limits);
    assert!(outcome.pass, "{outcome:?}");
}

#[test]
fn gusts_of_3_mps_cost_less_than_a_metre_and_a_half() {
    let limits = Limits { hold_horizontal_rms_m: Some(1.5), ..Limits::default() };
    let outcome = fly(&scenario("gusts-3"), 2, &limits);
    assert!(outcome.pass, "{outcome:?}");
}

#[test]
fn the_same_seed_writes_the_same_log_byte_for_byte() {
    let log = |seed| {
        let mut flight = flight(
            "[wind]\nspeed = 3.0\ngusts = true\n[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 5.0\n",
            seed,
        );
        flight.fly(60.0);
        assert_eq!(*flight.mission.progress(), Progress::Done);
        flight.finish_log().unwrap().unwrap()
    };
    let first = log(7);
    assert!(first.len() > 500_000);
    assert!(first == log(7), "the same seed differs");
    assert!(first != log(8), "the seed does nothing");
}

#[test]
fn the_gains_of_a_oneshot_build_fly_too() {
    let mut calm = scenario("calm");
    calm.params.insert("MOT_PROTO".into(), 1.0);
    assert!(fly(&calm, 1, &Limits { hold_horizontal_rms_m: Some(0.4), ..Limits::default() }).pass);
}

#[test]
fn heading_and_azimuth_follow_the_start_heading() {
    let mut flight = flight(
        "[vehicle]\nheading = 1.2\n[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 5.0\n",
        1,
    );
    flight.fly(60.0);
    let p = flight.world.environment.plant.body.position;
    assert!((p.y.atan2(p.x) - 1.2).abs() < 0.1, "{p}");
}

#[test]
fn a_takeoff_beyond_the_tether_is_refused_with_a_reason() {
    let mut flight =
        flight("[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 20.0\n", 1);
    flight.fly(30.0);
    let told = |text: &str| flight.events.iter().any(|(_, e): &(f64, Event)| e.text.contains(text));
    assert!(told("Take-off refused: altitude beyond the tether"));
    assert!(matches!(flight.mission.progress(), Progress::Failed(_)));
    assert!(flight.world.environment.plant.ground.is_touching());
}

#[test]
fn a_flight_is_the_same_to_the_bit_with_and_without_log_and_telemetry() {
    let mut gusty = scenario("gusts-3");
    gusty.mission.truncate(3);
    let params = gusty.params().unwrap();
    let mut told = Flight::new(&gusty, params, 5, Vec::new()).unwrap();
    let mut silent = Flight::unrecorded(&gusty, params, 5).unwrap();
    told.fly(60.0);
    silent.fly(60.0);
    let place = |p: &tautline_sitl::plant::Plant| p.body.position;
    let (a, b) = (&told.world.environment.plant, &silent.world.environment.plant);
    assert_eq!(place(a), place(b));
    assert!(told.finish_log().unwrap().is_some_and(|log| log.len() > 100_000));
    assert!(silent.finish_log().unwrap().is_none());
}
