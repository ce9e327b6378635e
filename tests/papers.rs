//! The papers' results that run in a moment; `cargo xtask ci` runs every experiment.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use tautline_sitl::bench::planar::{Feedback, LawKind, PlanarScenario, fly};
use tautline_sitl::experiment::{Overrides, Report, find};
use tautline_sitl::scenario::settings::set;

fn report(key: &str, sets: &[(&str, &str)]) -> Report {
    let sets = sets.iter().map(|(path, value)| ((*path).into(), (*value).into())).collect();
    (find(key).unwrap().run)(&Overrides { sets, seed: 1 }).unwrap()
}

fn assert_passes(key: &str) {
    let report = report(key, &[]);
    assert!(report.lines.len() > 5);
    for line in &report.lines {
        assert!(line.passes(), "{}", line.text());
    }
}

#[test]
fn every_acceptance_row_of_the_planar_specification_is_met() {
    assert_passes("planar-acceptance");
}

#[test]
fn tension_turns_into_compression_as_in_the_conference_article() {
    assert_passes("planar-compression");
}

#[test]
fn a_wrong_initial_estimate_converges_as_in_the_journal_article() {
    assert_passes("planar-initial-errors");
}

#[test]
fn poles_and_planar_loop_of_the_tether_angle_are_as_published_and_specified() {
    assert_passes("tether-poles");
    assert_passes("tether-loop");
}

#[test]
fn bad_tether_angle_and_localization_settings_are_refused_by_their_name() {
    let refused = |key: &str, path: &str, value: &str| {
        let settings = Overrides { sets: vec![(path.into(), value.into())], seed: 1 };
        let error = (find(key).unwrap().run)(&settings).err().unwrap();
        let named = path.split('.').next().unwrap();
        assert!(error.contains(named) && !error.contains('\n'), "{path} = {value}: {error}");
    };
    for (path, value) in [
        ("length", "0.0"),
        ("thrust", "-1.0"),
        ("tether_time", "0.0"),
        ("accel_noise", "nan"),
        ("reference", "[]"),
        ("start", "[120.0]"),
        ("anchor.period", "-1.0"),
        ("weight", "3"),
        ("seeds", "0"),
        ("seeds", "many"),
    ] {
        refused("tether-loop", path, value);
    }
    // A setting that an experiment does not have is refused, not passed over.
    for key in [
        "planar-nominal",
        "tether-sensitivity",
        "tether-poles",
        "localization-tension",
        "thrust-structures",
    ] {
        refused(key, "seeds", "3");
    }
    refused("thrust-structures", "tension", "3");
    for (path, value) in [("tension", "0.0"), ("speed", "nan"), ("duration", "1.0"), ("fc", "2")] {
        refused("localization-tension", path, value);
    }
}

#[test]
fn a_setting_changes_the_figures_and_may_fail_them() {
    // With a tenth of the observer's speed nothing converges in time.
    let slow = report("planar-initial-errors", &[("observer.epsilon", "1.0")]);
    assert!(!slow.passes());
}

#[test]
fn the_static_controller_tracks_on_the_true_state_and_refuses_the_observer() {
    let mut s = PlanarScenario::journal_attitude();
    s.law = LawKind::Static;
    s.controller.elevation_poles = vec![-1.0, -1.5];
    assert!(fly(&s, 1).unwrap_err().contains("feedback"));
    s.feedback = Feedback::State;
    let flown = fly(&s, 1).unwrap().summary;
    // A plain hold at 1 kHz: the reference moves 7e-4 rad in half a sample's time constant.
    assert!(flown.max_after_1s[0] < 1e-3 && flown.max_after_1s[1] < 1e-3, "{flown:?}");
}

#[test]
fn bad_planar_scenarios_are_refused_by_the_name_of_the_setting() {
    let bad: [(&str, &str, &str); 9] = [
        ("plant.mass", "0.0", "mass"),
        ("plant.length", "-1.0", "length"),
        ("model_error.inertia", "-1.0", "inertia"),
        ("observer.epsilon", "0.0", "epsilon"),
        ("observer.roots", "[-1.0, 2.0, -3.0]", "roots"),
        ("controller.elevation_poles", "[-1.0, 0.0, -1.0, -2.0]", "elevation_poles"),
        ("controller.elevation_poles", "[-1.0]", "elevation_poles"),
        ("reference.duration", "0.0", "reference.duration"),
        ("rate_hz", "nan", "rate_hz"),
    ];
    for (path, value, named) in bad {
        let s = set(&PlanarScenario::default(), path, value).unwrap();
        let error = fly(&s, 1).unwrap_err();
        assert!(error.contains(named), "{path} = {value}: {error}");
    }
}
