//! The golden vectors' harness: what a folder must hold so that its check may pass.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]
#![allow(dead_code, reason = "golden.rs calls the checks themselves")]

mod vectors;

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::{env, fs, process};
use vectors::inventory::{FILES, Inventory, folder_holds_vectors, inventory};

/// A folder of the test's own that is removed with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = env::temp_dir().join(format!("tautline-golden-{name}-{}", process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }
    fn with(name: &str, file: &str, content: &Value) -> Self {
        let folder = Self::new(name);
        fs::write(folder.0.join(file), content.to_string()).unwrap();
        folder
    }
    fn inventory(&self, file: &str) -> Result<Option<Inventory>, String> {
        inventory(&self.0, file)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn own(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(file);
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn an_empty_folder_fails_for_every_file() {
    let folder = Folder::new("empty");
    fs::write(folder.0.join("sysid.csv"), "t,pwm\n").unwrap();
    for file in FILES {
        let why = folder.inventory(file).unwrap_err();
        assert!(why.contains("none of planar.json"), "{why}");
    }
    assert!(folder_holds_vectors(&folder.0.join("absent")).is_err());
}

#[test]
fn an_absent_file_beside_another_is_skipped() {
    let folder = Folder::with("absent", "fullstate.json", &json!({ "mixer": [{}] }));
    assert!(folder.inventory("planar.json").unwrap().is_none());
    assert_eq!(folder.inventory("fullstate.json").unwrap().unwrap().checked.len(), 1);
}

#[test]
fn a_group_without_cases_fails() {
    for (file, content) in [
        ("fullstate.json", json!({ "mixer": [], "outer": [{}] })),
        ("planar.json", json!({ "groups": { "dyn": [{}], "imu": [] } })),
        ("inertial.json", json!({ "model": [{}], "ukf_run": {} })),
        ("localization.json", json!({ "static_solve": [{}], "table2": null })),
        ("localization.json", json!({ "static_solve": [{}], "sweeps": { "altitude": [] } })),
        ("pendulum.json", json!({ "kf_step": [{}], "reference": 3 })),
    ] {
        let folder = Folder::with("without-cases", file, &content);
        let why = folder.inventory(file).unwrap_err();
        assert!(why.contains("no cases") || why.contains("empty"), "{why}");
    }
}

#[test]
fn a_group_of_an_unknown_name_fails() {
    for (file, content) in [
        ("fullstate.json", json!({ "mixer": [{}], "allocator": [{}] })),
        ("fullstate2.json", json!({ "predict3": [{}] })),
        ("planar.json", json!({ "groups": { "dyn": [{}], "dyn3": [{}] } })),
        ("planar.json", json!({ "groups": { "dyn": [{}] }, "open_loop": [{}] })),
        ("inertial.json", json!({ "model": [{}], "models": [{}] })),
        ("localization.json", json!({ "sweeps": { "temperature": [{}] } })),
        ("localization.json", json!({ "sweeps": { "robustness": [{ "value": "rain .2 fc=2" }] } })),
        ("localization.json", json!({ "sysid": { "results": { "lstm": {} } } })),
        ("pendulum.json", json!({ "kf_step": [{}], "mpc": [{}] })),
    ] {
        let folder = Folder::with("unknown-group", file, &content);
        let why = folder.inventory(file).unwrap_err();
        assert!(why.contains("unknown"), "{why}");
    }
}

#[test]
fn a_file_of_which_nothing_is_checked_fails() {
    for (file, content) in [
        ("planar.json", json!({ "meta": {}, "groups": {} })),
        ("pendulum.json", json!({ "note": "", "seed": 1 })),
    ] {
        let folder = Folder::with("nothing", file, &content);
        let why = folder.inventory(file).unwrap_err();
        assert!(why.contains("nothing is checked"), "{why}");
    }
}

/// A copy of the first case of a group with one setting more or another value.
fn changed(file: &str, group: &str, path: &[&str], value: Value) -> Value {
    let mut content = own(file);
    let case = content[group][0].take();
    let mut altered = case.clone();
    let mut place = &mut altered;
    for key in path {
        place = &mut place[key];
    }
    *place = value;
    json!({ group: [case, altered] })
}

#[test]
fn a_case_with_an_unknown_setting_is_counted_as_skipped() {
    for (file, group, path, value) in [
        ("planar.json", "closed_loop", &["scenario", "wind"][..], json!(2.0)),
        ("planar.json", "closed_loop", &["scenario", "method"], json!("rk45")),
        ("planar.json", "closed_loop", &["scenario", "init"], json!("flying")),
        ("planar.json", "closed_loop", &["scenario", "mode"], json!(3)),
        ("planar.json", "observer_streams", &["params", "delay"], json!(0.01)),
        ("planar.json", "observer_streams", &["params", "init"], json!("at rest")),
        ("inertial.json", "closed_loop", &["options", "wind"], json!(2.0)),
        ("inertial.json", "closed_loop_3d", &["options", "wind"], json!(2.0)),
        ("inertial.json", "monte_carlo", &["case"], json!("fig6 l=1")),
        ("inertial.json", "monte_carlo", &["case"], json!("fig3 noise=2")),
        ("pendulum.json", "closed_loop", &["options", "wind"], json!(2.0)),
        ("pendulum.json", "closed_loop", &["options", "controller"], json!(2)),
    ] {
        let content = changed(file, group, path, value);
        let folder = Folder::with(&format!("setting-{group}"), file, &content);
        let found = folder.inventory(file).unwrap().unwrap();
        assert_eq!(found.checked, [(group.to_owned(), 1)], "{path:?}");
        assert!(found.skipped[0].starts_with(&format!("{group}[1]: unknown")), "{path:?}");
    }
}

#[test]
fn in_our_own_folder_nothing_is_skipped() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    for file in FILES {
        let found = inventory(&folder, file).unwrap().unwrap();
        assert!(found.skipped.is_empty(), "{file}: {:?}", found.skipped);
    }
}
