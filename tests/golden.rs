//! Golden vectors from an independent derivation.
//!
//! Checks every known file in `tests/golden/`, or in the folder that `GOLDEN_DIR` names. A folder without
//! any fails, and so does a group that is unknown or without cases. Cases with a setting that their check does not know are counted as skipped and printed, and a file
//! that holds nothing else fails, so that nobody takes a skipped file for a checked one. What is compared
//! stands in `tests/vectors/`, one file per science; the harness has its own test, `golden_harness.rs`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod vectors;

use tautline_firmware::fixed::Q16;
use tautline_firmware::scalar::Scalar;
use vectors::inventory::inventory;
use vectors::{
    catenary, file, folder, full_state, full_state_streams, fullstate, inertial, inertial_worlds,
    localization, localization_worlds, pendulum, pendulum_loops, planar, planar_loops,
    planar_observer, sysid,
};

macro_rules! every_group_is_known {
    ($($name:ident, $file:literal;)+) => {$(
        #[test]
        fn $name() {
            let found = inventory(&folder(), $file).unwrap_or_else(|why| panic!("{why}"));
            let Some(found) = found else { return println!("absent: {}", $file) };
            for (group, cases) in &found.checked {
                println!("{group}: {cases} cases");
            }
            for skipped in &found.skipped {
                println!("skipped: {skipped}");
            }
            println!("{}: {} skipped", $file, found.skipped.len());
        }
    )+};
}

every_group_is_known! {
    planar_every_group_is_known_and_has_cases, "planar.json";
    inertial_every_group_is_known_and_has_cases, "inertial.json";
    localization_every_group_is_known_and_has_cases, "localization.json";
    pendulum_every_group_is_known_and_has_cases, "pendulum.json";
    fullstate_every_group_is_known_and_has_cases, "fullstate.json";
    fullstate2_every_group_is_known_and_has_cases, "fullstate2.json";
}

/// 1e-9 is the specification's tolerance for f64. For f32 the specification allows 2e-4 on states and
/// 2e-3 on covariances; the largest error seen is 9e-7, and 2e-5 leaves room for other vectors.
macro_rules! golden {
    ($($name:ident, $name32:ident, $name16:ident, $check:ident, $f32:literal, $q16:literal;)+) => {$(
        #[test]
        fn $name() {
            if let Some(file) = file("fullstate.json") {
                fullstate::$check::<f64>(&file, 1e-9);
            }
        }
        #[test]
        fn $name32() {
            if let Some(file) = file("fullstate.json") {
                fullstate::$check::<f32>(&file, $f32);
            }
        }
        #[test]
        fn $name16() {
            if let Some(file) = file("fullstate.json") {
                fullstate::$check::<Q16>(&file, $q16);
            }
        }
    )+};
}

golden! {
    fullstate_mahony_f64, fullstate_mahony_f32, fullstate_mahony_q16, check_mahony, 2e-5, 1e-3;
    fullstate_ekf4_f64, fullstate_ekf4_f32, fullstate_ekf4_q16, check_ekf4, 2e-5, 1e-3;
    fullstate_outer_f64, fullstate_outer_f32, fullstate_outer_q16, check_outer, 2e-5, 1e-3;
    fullstate_attitude_cmd_f64, fullstate_attitude_cmd_f32, fullstate_attitude_cmd_q16, check_attitude, 2e-5, 1e-3;
    fullstate_rate_loop_f64, fullstate_rate_loop_f32, fullstate_rate_loop_q16, check_rate, 2e-5, 1e-3;
    fullstate_mixer_f64, fullstate_mixer_f32, fullstate_mixer_q16, check_mixer, 2e-5, 1e-3;
}

/// Algebra and single steps in one scalar, all groups of the file.
fn planar_groups<S: Scalar + Into<f64>>(bound: impl Fn(&str, &[f64; 2]) -> Option<f64>) {
    let Some(file) = file("planar.json") else { return };
    let known = planar::groups::<S>();
    for (group, cases) in file["groups"].as_object().into_iter().flatten() {
        let (_, check, bounds) = known
            .iter()
            .find(|(name, ..)| name == group)
            .unwrap_or_else(|| panic!("unknown group {group} in planar.json"));
        print!("{group}: ");
        let Some(bound) = bound(group, bounds) else {
            println!("not checked in this scalar");
            continue;
        };
        let mut worst = vectors::Check::new(bound);
        for (i, case) in cases.as_array().unwrap().iter().enumerate() {
            check(&mut worst, &format!("{group}[{i}]"), &case["in"], &case["out"]);
        }
    }
}

#[test]
fn planar_groups_f64() {
    planar_groups::<f64>(|_, [double, _]| Some(*double));
}

#[test]
fn planar_groups_f32() {
    planar_groups::<f32>(|_, [_, single]| Some(*single));
}

/// Their random inputs leave what fixed point flies: derivatives of tens, singular inversions, ε down to 0.09. The
/// flights of `cargo sitl experiment fixed-point` cover these blocks inside the envelope.
const BEYOND_Q16: [&str; 6] =
    ["ctrl_b", "flat_b", "hgo_rhs", "hgo_step_euler", "hgo_step_exact_held", "hgo_step_rk4_held"];

#[test]
fn planar_groups_q16() {
    planar_groups::<Q16>(|group, _| (!BEYOND_Q16.contains(&group)).then_some(4e-3));
}

/// The first runs at ε = 0.1, five times as fast as what fixed point is meant to fly.
#[test]
fn planar_observer_streams_q16() {
    let Some(file) = file("planar.json") else { return };
    for (i, stream) in file["observer_streams"].as_array().into_iter().flatten().enumerate() {
        planar_observer::stream::<Q16>(&format!("stream {i}"), stream, 0.1);
    }
}

#[test]
fn planar_observer_streams_f64() {
    let Some(file) = file("planar.json") else { return };
    for (i, stream) in file["observer_streams"].as_array().into_iter().flatten().enumerate() {
        planar_observer::stream::<f64>(&format!("stream {i}"), stream, 1e-7);
    }
}

/// A second-order divided difference at 250 Hz: single precision leaves 1e-3 on the acceleration.
#[test]
fn planar_observer_streams_f32() {
    let Some(file) = file("planar.json") else { return };
    for (i, stream) in file["observer_streams"].as_array().into_iter().flatten().enumerate() {
        planar_observer::stream::<f32>(&format!("stream {i}"), stream, 1e-2);
    }
}

#[test]
fn planar_closed_loops_f64() {
    let Some(file) = file("planar.json") else { return };
    for scenario in file["closed_loop"].as_array().into_iter().flatten() {
        planar_loops::check(scenario);
    }
}

/// Calls a check if the file is there.
macro_rules! checks {
    ($($name:ident, $file:literal, $check:expr;)+) => {$(
        #[test]
        fn $name() {
            if let Some(file) = file($file) {
                $check(&file);
            }
        }
    )+};
}

// f64: the specification's tolerances. f32: about eight times the largest error seen; the recorded run
// passes through re-initialisations where a square root amplifies rounding.
checks! {
    inertial_singles_f64, "inertial.json", |file| inertial::singles::<f64>(file, 1e-9, 1e-7);
    inertial_singles_f32, "inertial.json", |file| inertial::singles::<f32>(file, 2e-4, 1e-2);
    inertial_poles, "inertial.json", inertial_worlds::poles;
    inertial_plant_steps, "inertial.json", inertial_worlds::plant_steps;
    inertial_monte_carlo, "inertial.json", inertial_worlds::monte_carlo;
    inertial_closed_loops, "inertial.json", inertial_worlds::closed_loops;
    inertial_closed_loops_in_space, "inertial.json", inertial_worlds::closed_loops_in_space;
}

// f32: ten times the largest error seen. The low-pass holds its last solution where a check fails, and a
// check on the edge may fail a sample earlier or later.
checks! {
    localization_singles_f64, "localization.json", |file| localization::singles::<f64>(file, 1e-9, 1e-6);
    localization_singles_f32, "localization.json", |file| localization::singles::<f32>(file, 2e-4, 1e-2);
    localization_derivatives, "localization.json", localization_worlds::derivatives;
    localization_recorded_flight, "localization.json", localization_worlds::recorded;
    localization_tables, "localization.json", localization_worlds::tables;
    localization_sysid, "localization.json", sysid::check;
}

// The specification's tolerances; it bounds a sequence of 400 filter steps in f64 by 1e-8.
checks! {
    pendulum_law_f64, "pendulum.json", |file| pendulum::law::<f64>(file, pendulum::DOUBLE);
    pendulum_law_f32, "pendulum.json", |file| pendulum::law::<f32>(file, pendulum::SINGLE);
    pendulum_filter_f64, "pendulum.json", |file| pendulum::filter_steps::<f64>(file, pendulum::DOUBLE);
    pendulum_filter_f32, "pendulum.json", |file| pendulum::filter_steps::<f32>(file, pendulum::SINGLE);
    pendulum_filter_sequence_f64, "pendulum.json", |file| pendulum::filter_sequence::<f64>(file, 1e-8, 1e-8);
    pendulum_filter_sequence_f32, "pendulum.json", |file| pendulum::filter_sequence::<f32>(file, 1e-4, 1e-3);
    pendulum_references_f64, "pendulum.json", |file| pendulum::references::<f64>(file, 1e-9);
    pendulum_references_f32, "pendulum.json", |file| pendulum::references::<f32>(file, 1e-5);
    pendulum_vertical_disturbance_f64, "pendulum.json", |file| pendulum::vertical::<f64>(file, 1e-9);
    pendulum_vertical_disturbance_f32, "pendulum.json", |file| pendulum::vertical::<f32>(file, 1e-5);
    pendulum_plant_steps, "pendulum.json", pendulum_loops::plant_steps;
    pendulum_closed_loops, "pendulum.json", pendulum_loops::closed_loops;
}

// The specification's tolerances, `fullstate` section 16.
checks! {
    full_state_singles_f64, "fullstate.json", |file| full_state::singles::<f64>(file, full_state::DOUBLE);
    full_state_singles_f32, "fullstate.json", |file| full_state::singles::<f32>(file, full_state::SINGLE);
    full_state_stream_f64, "fullstate.json", |file| full_state_streams::first::<f64>(file, full_state::DOUBLE);
    full_state_stream_f32, "fullstate.json", |file| full_state_streams::first::<f32>(file, full_state::SINGLE);
    full_state_sensors_f64, "fullstate2.json", |file| full_state::singles_2::<f64>(file, full_state::DOUBLE);
    full_state_sensors_f32, "fullstate2.json", |file| full_state::singles_2::<f32>(file, full_state::SINGLE);
    full_state_dithered_stream_f64, "fullstate2.json", |file| full_state_streams::second::<f64>(file, full_state::DOUBLE);
    full_state_dithered_stream_f32, "fullstate2.json", |file| full_state_streams::second::<f32>(file, full_state::SINGLE);
    elastic_catenary, "fullstate2.json", catenary::check;
}
