//! A log's inputs through the step again: the same to the bit, or the difference.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use tautline_sitl::flight::tape::Item;
use tautline_sitl::flight::{Flight, Shadow};
use tautline_sitl::replay::{Settings, read, replay};
use tautline_sitl::scenario::Scenario;
use tautline_sitl::ulog::{Log, Message};
use tautline_tests::UP_AND_DOWN;

fn logged(text: &str, seconds: f64) -> Vec<u8> {
    let scenario = Scenario::parse(text, "t.toml").unwrap();
    let mut flight = Flight::new(&scenario, scenario.params().unwrap(), 3, Vec::new()).unwrap();
    flight.fly(seconds);
    flight.finish_log().unwrap().unwrap()
}

fn with(name: &str, value: f32) -> Settings {
    Settings { params: vec![(name.into(), value)], ..Settings::default() }
}

#[test]
fn every_arithmetic_and_sensor_replays_to_the_bit() {
    for scalar in ["f32", "f64", "q16"] {
        let text = format!(
            "scalar = {scalar:?}\n[sensors]\nmagnetometer = true\nvehicle_angles = true\nground_angles = true\n\
             tension_cell = true\nsecond_imu = true\n[wind]\nspeed = 4.0\ngusts = true\n[[fault]]\n\
             kind = \"rangefinder_lost\"\nat = 9.0\n{UP_AND_DOWN}"
        );
        let (items, gap) = read(&logged(&text, 25.0)).unwrap();
        assert_eq!(gap, None);
        let replayed = replay(&items, &Settings::default()).unwrap();
        assert!(replayed.identical, "{scalar}: {replayed:?}");
        assert!(replayed.steps >= 24_990, "{}", replayed.steps);
    }
}

#[test]
fn a_flight_by_radio_replays_to_the_bit_with_its_loss() {
    let radio = include_str!("../sitl/scenarios/radio.toml");
    let loss = "[[fault]]\nkind = \"radio_failsafe\"\nat = 22.0\nduration = 4.0\n[[mission]]";
    let noise = "[[fault]]\nkind = \"radio_noise\"\nvalue = 0.001\nat = 0.0\n";
    let text = radio.replace("[[mission]]", &format!("{noise}{loss}"));
    let (items, gap) = read(&logged(&text, 60.0)).unwrap();
    assert_eq!(gap, None);
    let frames = items
        .iter()
        .filter(|item| matches!(item, Item::Step(input, _) if input.sensors.radio.is_some()))
        .count();
    assert!(frames > 5_000, "{frames}");
    let replayed = replay(&items, &Settings::default()).unwrap();
    assert!(replayed.identical, "{replayed:?}");
}

#[test]
fn another_parameter_shows_from_when_on_and_how_much() {
    let (items, _) = read(&logged(UP_AND_DOWN, 25.0)).unwrap();
    let same = replay(&items, &with("EST_KIND", 1.0)).unwrap();
    assert!(same.identical, "what it was is no change");
    let other = replay(&items, &with("EST_KIND", 0.0)).unwrap();
    assert!(!other.identical && other.first_difference_s.unwrap() < 25.0);
    let softer = replay(&items, &with("RATE_P", 18.0)).unwrap();
    assert!(softer.difference.throttle_rms.unwrap() > 1e-4, "{:?}", softer.difference);
    let off = softer.difference.position_max_m;
    assert!(off < 1e-9, "the estimate knows the thrust that acted, not the one asked here: {off}");
    assert!(replay(&items, &with("RATE_P", 1e9)).unwrap_err().contains("outside"));
}

#[test]
fn the_simple_filter_beside_says_what_a_replay_with_it_says() {
    let scenario = Scenario::parse(UP_AND_DOWN, "t.toml").unwrap();
    let params = scenario.params().unwrap();
    let mut flight = Flight::beside(&scenario, params, 3, Vec::new(), &[Shadow::Simple]).unwrap();
    flight.fly(30.0);
    let log = flight.finish_log().unwrap().unwrap();
    let mut beside = Vec::new();
    let mut truth = Vec::new();
    for message in Log::new(&log).unwrap() {
        let Message::Data(data) = message else { continue };
        let into = match data.topic {
            "estimator_simple" => &mut beside,
            "vehicle_local_position_groundtruth" => &mut truth,
            _ => continue,
        };
        into.push((data.time().unwrap(), data.number("position[2]").or(data.number("z")).unwrap()));
    }
    let (last, height) = *beside.last().unwrap();
    assert!(last > 29.0, "{last}");
    let at = truth.iter().find(|(time, _)| *time >= last - 0.03).unwrap();
    assert!((height - at.1).abs() < 0.5, "{height} {at:?}");
    let (items, _) = read(&log).unwrap();
    let other = replay(&items, &with("EST_KIND", 0.0)).unwrap();
    // Two filters that differ by decimetres, not a filter without its thrust that is lost.
    assert!(other.difference.position_max_m < 2.0, "{:?}", other.difference);
}

#[test]
fn a_damaged_log_is_replayed_up_to_the_damage() {
    let log = logged(UP_AND_DOWN, 12.0);
    let mut bad = log.clone();
    let middle = bad.len() / 2;
    bad[middle..middle + 2_000].fill(0);
    let (items, gap) = read(&bad).unwrap();
    assert!(gap.unwrap().contains("inputs are missing before"));
    let replayed = replay(&items, &Settings::default()).unwrap();
    assert!(replayed.identical && (4_000..8_000).contains(&replayed.steps), "{}", replayed.steps);

    let (items, gap) = read(&log[..log.len() - 3_333]).unwrap();
    assert_eq!(gap.as_deref(), Some("the log ends within a step's input"));
    assert!(replay(&items, &Settings::default()).unwrap().identical);
    assert!(read(&log[..4_000]).is_err(), "only definitions");
}

#[test]
fn what_was_not_recorded_so_does_not_pass_for_the_same() {
    let (mut items, _) = read(&logged(UP_AND_DOWN, 8.0)).unwrap();
    let at = items.len() / 2;
    let Item::Step(input, _) = &mut items[at] else { panic!("a step") };
    input.sensors.imu.as_mut().unwrap().value.gyro[0] ^= 1;
    let replayed = replay(&items, &Settings::default()).unwrap();
    assert!(!replayed.identical);
    assert!(replay(&items[1..], &Settings::default()).is_err(), "without its start");
}
