//! Flights that once broke a rule of the house (`experiment policy`), and faults that the vehicle now lives with.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use tautline_tests::{flown, is_safe, told};

const BREEZE: &str = "[wind]\nspeed = 3.0\ngusts = true";

#[test]
fn ground_that_falls_away_is_looked_for_below_and_found() {
    let world = "[[fault]]\nkind = \"ground_step\"\nvalue = -1.6\nat = 45.0";
    let flight = flown(world, 1, 300.0);
    assert_eq!(told(&flight, "Landing finds no ground"), 1);
    is_safe(&flight);
}

#[test]
fn a_winch_that_creeps_in_is_told_and_not_in_a_stream() {
    let world = "[[fault]]\nkind = \"winch_creeps\"\nvalue = -3.2\nat = 28.4";
    assert!((1..=2).contains(&told(&flown(world, 2, 200.0), "Line caught")));
}

#[test]
fn motors_that_are_dead_are_switched_off_where_the_vehicle_lies() {
    let world = "[tether]\nkind = \"fixed\"\n[[fault]]\nkind = \"motor_stopped\"\nat = 50.0";
    for seed in 1..4 {
        assert!(!flown(world, seed, 90.0).output().is_armed);
    }
}

#[test]
fn an_encoder_that_runs_sticks_or_jumps_does_not_take_the_vehicle_along() {
    for (fault, text) in [
        ("kind = \"length_offset\"\nvalue = 3.2\nramp = 0.8", "Line length jumped"),
        ("kind = \"encoder_stuck\"", "Tether length lost"),
        ("kind = \"length_offset\"\nvalue = 1.0", "Line length jumped"),
    ] {
        let flight = flown(&format!("{BREEZE}\n[[fault]]\n{fault}\nat = 47.4"), 1, 300.0);
        assert_eq!(told(&flight, text), 1, "{fault}");
        assert_eq!(told(&flight, "began anew"), 0, "{fault}");
        let off = flight.metrics.estimate_horizontal.rms().unwrap();
        assert!(off < 0.4, "{fault}: {off} m");
        is_safe(&flight);
    }
}

#[test]
fn a_lost_rotor_of_six_or_eight_lands_on_the_others_and_is_told_once() {
    for (preset, tension) in [("hexa-6", 15), ("octo-9", 20)] {
        let low = tension / 2;
        let world = format!(
            "[vehicle]\npreset = \"{preset}\"\n[battery]\ncells = 6\ncapacity = 30\n[params]\nTET_TENSION = {tension}\n\
             TET_TENSION_LOW = {low}\n{BREEZE}\n"
        );
        let whole = flown(&world, 1, 300.0);
        assert_eq!(told(&whole, "Rotor lost"), 0, "{preset}");
        is_safe(&whole);
        for motor in [1, 4, 6] {
            let fault = format!("[[fault]]\nkind = \"motor_stopped\"\nmotor = {motor}\nat = 50.0");
            let flight = flown(&format!("{world}{fault}"), 1, 300.0);
            assert_eq!(told(&flight, "Rotor lost"), 1, "{preset}, {motor}");
            let found = flight.events.iter().find(|(_, e)| e.text.contains("Rotor lost")).unwrap();
            assert!(found.0 < 50.6, "found at {} s", found.0);
            is_safe(&flight);
        }
    }
}

#[test]
fn a_rotor_that_never_turned_ends_the_take_off_on_the_ground() {
    let world = "[vehicle]\npreset = \"hexa-6\"\n[battery]\ncells = 6\n[params]\nTET_TENSION = 15\nTET_TENSION_LOW = 8\n\
                 [[fault]]\nkind = \"motor_stopped\"\nmotor = 4\nat = 1.0";
    let flight = flown(world, 1, 60.0);
    assert_eq!(told(&flight, "it turns, check the rotors"), 1);
    assert!(!flight.output().is_armed && flight.metrics.verdict.highest < 0.6);
}
