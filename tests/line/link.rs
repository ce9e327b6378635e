//! What a station says of its line.

use mavlink::dialects::common as mav;
use mavlink::types::CharArray;
use tautline_tests::heard;

fn fairlead(azimuth: f32, elevation: f32) -> mav::DEBUG_VECT_DATA {
    let name = CharArray::from("fairlead");
    mav::DEBUG_VECT_DATA { time_usec: 5, x: azimuth, y: elevation, z: 0.0, name }
}

#[test]
fn the_direction_of_the_line_comes_as_a_vector_named_fairlead() {
    let got = heard(&fairlead(-1.5, 0.7)).take_sensors().line.fairlead.unwrap();
    assert_eq!((got.azimuth, got.elevation), (-1.5, 0.7));
    let other = mav::DEBUG_VECT_DATA { name: CharArray::from("fairleads"), ..fairlead(0.0, 0.0) };
    assert!(heard(&other).take_sensors().line.fairlead.is_none());
    let mut bad = heard(&fairlead(0.0, f32::NAN));
    assert!(bad.take_sensors().line.fairlead.is_none() && bad.counters().refused == 1);
}

#[test]
fn a_winch_says_its_tension_in_kilograms_if_it_has_a_load_cell() {
    let winch =
        |tension| mav::WINCH_STATUS_DATA { line_length: 12.5, tension, ..Default::default() };
    let sensors = heard(&winch(2.0)).take_sensors();
    assert_eq!(sensors.tether.unwrap().value.length_mm, 12_500);
    assert!((sensors.line.station_tension.unwrap() - 19.6133).abs() < 1e-3);
    let without = heard(&winch(f32::NAN)).take_sensors();
    assert!(without.tether.is_some() && without.line.station_tension.is_none());
}
