//! The winch is a component of its own.

use super::station::{Station, holding};
use mavlink::dialects::common as mav;

const WINCH: u8 = 169;

fn ask(action: f32, length: f32, rate: f32) -> [f32; 7] {
    [0.0, action, length, rate, 0.0, 0.0, 0.0]
}

#[test]
fn it_pays_out_what_it_is_asked_and_holds_the_tension_again() {
    let mut station = Station::new(255, 1);
    let mut flight = holding(&mut station);
    let before = flight.world.environment.plant.tether.length();
    assert_eq!(station.command_to(&mut flight, (42600, WINCH), ask(1.0, 1.0, 0.4)), Some(0));
    station.run(&mut flight, 4000);
    let after = flight.world.environment.plant.tether.length();
    let status = station.all::<mav::WINCH_STATUS_DATA>();
    let longest = status.iter().map(|s| s.line_length).fold(0.0, f32::max);
    assert!(f64::from(longest) > before + 0.6, "{before} {longest} {after}");
    let last = status.last().unwrap();
    assert!(f64::from(last.tension) * 9.80665 > 2.0, "kg: {}", last.tension);
    assert!(flight.output().is_armed);
}

#[test]
fn it_refuses_what_it_cannot_do_and_is_not_the_autopilot() {
    let mut station = Station::new(255, 1);
    let mut flight = holding(&mut station);
    for (action, length, rate, result) in [
        (9.0, 0.0, 0.0, 3),
        (1.0, 500.0, 0.4, 2),
        (2.0, 0.0, 99.0, 2),
        (0.5, 0.0, 0.0, 2),
        (3.0, 0.0, 0.0, 0),
        (2.0, 0.0, 0.0, 0),
    ] {
        let got = station.command_to(&mut flight, (42600, WINCH), ask(action, length, rate));
        assert_eq!(got, Some(result), "{action}");
    }
    assert_eq!(station.command(&mut flight, 42600, ask(3.0, 0.0, 0.0)), Some(3));
    assert_eq!(station.command_to(&mut flight, (400, WINCH), ask(0.0, 0.0, 0.0)), Some(3));
    assert!(flight.output().is_armed);
}
