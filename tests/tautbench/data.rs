//! The data set: flown again to the byte, and only what can be flown.

use crate::{folder, sample};
use std::fs;
use tautline_firmware::param::Params;
use tautline_sitl::experiment::why_lost;
use tautline_sitl::flight::Flight;
use tautline_sitl::tautbench::{Grid, Settings, generate, reading, sha256};

#[test]
fn a_flight_of_the_sample_is_flown_again_to_the_byte() {
    let (data, grid) = (sample(), Grid::shipped().unwrap());
    let flight = data.flight("sample-fixed-calm-1").unwrap();
    let again = data.fly_again(&grid, flight).unwrap();
    // The readings are compared by `fly_again`.
    assert_eq!(sha256(&again.truth.to_parquet(false).unwrap()), flight.truth_sha256);
    assert_eq!(again.why, None);
    // As it is on disk: what was read fills most cells of the row, and time goes on.
    let read = data.readings(flight).unwrap();
    assert_eq!(read.names, again.readings.names);
    let rows: Vec<_> = read.rows.iter().map(|row| reading(row).unwrap()).collect();
    assert!(rows.windows(2).all(|pair| pair[0].0 < pair[1].0));
    assert!(rows.iter().all(|(_, read)| read.gyro.is_some() && read.velocity.is_none()));
    let pull = rows.iter().map(|(_, read)| read.accel.unwrap()[2]).sum::<f64>() / rows.len() as f64;
    assert!((-12.0..-9.0).contains(&pull), "weight, on the ground and by thrust: {pull}");
}

#[test]
fn the_same_cells_give_the_same_manifest_twice() {
    let grid = Grid::shipped().unwrap();
    let mut cells = grid.chosen(&["sample-fixed-3mps".into()]).unwrap();
    // A short one of the grid's own.
    let mut short = cells[0].clone();
    short.scenario.mission.truncate(2);
    cells = vec![&short];
    let settings = |name: &str, logs| Settings { out: folder(name), seeds: 2, logs, jobs: 2 };
    let (one, two) = (settings("one", false), settings("two", true));
    let first = generate(&cells, &one, |_| {}).unwrap();
    assert_eq!(first, generate(&cells, &two, |_| {}).unwrap());
    assert_ne!(first.flights[0].readings_sha256, first.flights[1].readings_sha256, "seeds differ");
    let log = fs::read(two.out.join("sample-fixed-3mps-1.ulg")).unwrap();
    assert!(tautline_sitl::replay::read(&log).unwrap().1.is_none(), "replayable");
    let e = generate(&cells, &one, |_| {}).unwrap_err();
    assert!(e.ends_with("holds a data set already"), "{e}");
    for settings in [one, two] {
        fs::remove_dir_all(settings.out).unwrap();
    }
}

#[test]
fn what_the_grid_leaves_out_is_refused_by_the_firmware() {
    for left_out in Grid::shipped().unwrap().left_out {
        let scenario = &left_out.scenario;
        let params: Params = scenario.params().unwrap();
        let mut flight = Flight::unrecorded(scenario, params, 1).unwrap();
        flight.fly(60.0);
        let told = why_lost(&flight).unwrap_or_default();
        let texts: Vec<_> = flight.events.iter().map(|(_, event)| event.to_string()).collect();
        assert!(
            texts.iter().any(|text| text.contains(&left_out.refused)),
            "{}: {told}; {texts:?}",
            left_out.name
        );
        assert!(told.contains("not flown") || told.contains("never"), "{}: {told}", left_out.name);
    }
}
