//! Flights on a chain, judged against the simulator's truth.

use tautline_firmware::frames::V3;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_firmware::vehicle::StepOutput;
use tautline_sitl::flight::Flight;
use tautline_sitl::scenario::{FaultKind, FaultSection};
use tautline_tests::{HOLD, flight, run, until};

const LINE: &str = r#"
[tether]
preset = "light"
model = "chain"
segments = 5
winch_length_max = 20.0
"#;

fn hovering(flight: &mut Flight<Vec<u8>>) {
    let is_up = |out: &StepOutput| out.mode == Mode::TetherHold && out.ground == GroundState::InAir;
    until(flight, 60.0, is_up);
}

fn holding(more: &str) -> Flight<Vec<u8>> {
    let mut flight = flight(&format!("{LINE}{more}{HOLD}"), 3);
    hovering(&mut flight);
    run(&mut flight, 5.0);
    flight
}

fn break_now(flight: &mut Flight<Vec<u8>>, kind: FaultKind, value: f64) {
    let at = flight.world.now().0 as f64 * 1e-6;
    flight.world.environment.faults.add(FaultSection::new(kind, value, at));
}

fn landed(flight: &mut Flight<Vec<u8>>, limit: f64) -> StepOutput {
    until(flight, limit, |out| out.ground == GroundState::OnGround && !out.is_armed)
}

/// rad between two directions.
fn between(a: &nalgebra::Vector3<f64>, b: &V3<f32>) -> f64 {
    a.angle(&b.map(f64::from))
}

#[test]
fn every_sensor_of_the_line_agrees_with_the_truth_within_its_errors() {
    let mut flight = holding(
        "[sensors]\nvehicle_angles = true\nground_angles = true\ntension_cell = true\nmagnetometer = true\nmagnetic_offset = 0.0\nsecond_imu = true\n\
         [station]\nlength_slip = 0.01\nsupply_voltage = 400.0\nsupply_resistance = 0.2\n",
    );
    let mut worst = [0.0_f64; 5];
    for _ in 0..2_000 {
        flight.step(&mut |_| {});
        let line = flight.output().sensors.line;
        let imu = flight.output().sensors.imu;
        let plant = &flight.world.environment.plant;
        let to_body = plant.body.attitude.inverse();
        let mut note = |i: usize, error: f64| worst[i] = worst[i].max(error);
        note(0, between(&(to_body * plant.tether.pull()), &line.direction.unwrap().0));
        note(1, (plant.tether.tension() - f64::from(line.tension.unwrap())).abs());
        note(2, (plant.tether.station_tension() - f64::from(line.station_tension.unwrap())).abs());
        note(3, between(&plant.tether.leaves(), &line.station_direction.unwrap().0));
        let earth = to_body * nalgebra::Vector3::new(21.0, 1.5, 43.0);
        note(4, between(&earth, &line.magnetic.unwrap().0));
        let second = line.second_imu.unwrap();
        let first = imu.unwrap().value;
        assert!((second.gyro.0 - first.gyro.0).norm() < 0.2, "two gyros disagree");
    }
    let [angles, cell, station_cell, station_angles, field] = worst;
    // The tension that moves to and fro swings the line more than the 10 ms' worth of 0.01 in still air.
    assert!(angles < 0.012, "a line that swings for 10 ms and an offset: {angles}");
    // The same: it changes by 20 N/s, and the station's cell is read every 10 ms and filtered.
    assert!(cell < 0.35 && station_cell < 0.6, "{cell} {station_cell}");
    assert!(station_angles < 0.02, "{station_angles}");
    assert!(field < 0.05, "soft iron of 3 %: {field}");
    // All of the power came up the line, and more length was shown than is out.
    let plant = &flight.world.environment.plant;
    assert!(plant.supply.current > 0.3, "{:?}", plant.supply);
    assert!(plant.battery.current.abs() < 1e-6);
}

#[test]
fn a_line_that_is_cut_ends_on_the_ground_and_is_told_once() {
    let mut flight = holding("");
    let before = flight.events.len();
    break_now(&mut flight, FaultKind::TetherBroken, 0.3);
    landed(&mut flight, 60.0);
    let told: Vec<_> = flight.events.iter().skip(before).map(|(_, e)| e.text).collect();
    let lost = told.iter().filter(|text| text.to_lowercase().contains("tether")).count();
    assert_eq!(lost, 1, "{told:?}");
}

#[test]
fn a_line_that_is_caught_does_not_throw_the_vehicle_about() {
    let mut flight = holding("");
    break_now(&mut flight, FaultKind::Snag, 0.5);
    run(&mut flight, 10.0);
    let plant = &flight.world.environment.plant;
    assert!(plant.height_over_ground() > 2.0 && plant.body.tilt() < 0.5, "{:?}", plant.body);
}

#[test]
fn a_station_on_a_swaying_deck_is_flown_over_and_landed_on() {
    let toml = format!(
        "{LINE}[base]\nheave = 0.2\nheave_period = 8.0\nsurge = 0.3\nsurge_period = 11.0\n\
         [[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 6.0\n\
         [[mission]]\ndo = \"hold\"\nseconds = 10.0\n[[mission]]\ndo = \"land\"\n"
    );
    let mut flight = flight(&toml, 1);
    hovering(&mut flight);
    let mut moved = 0.0_f64;
    for _ in 0..8_000 {
        flight.step(&mut |_| {});
        moved = moved.max(flight.world.environment.plant.anchor.position.norm());
    }
    assert!(moved > 0.2, "the deck moves: {moved}");
    landed(&mut flight, 90.0);
    let plant = &flight.world.environment.plant;
    assert!(plant.height_over_ground() < 0.3 && plant.body.tilt() < 0.3);
}
