//! What somebody meets who types: no silence, no raw text, the right exit code.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Exit code, standard output, standard error.
struct Said {
    code: i32,
    out: String,
    err: String,
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn sitl(folder: &PathBuf, arguments: &[&str]) -> Said {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sitl"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

#[test]
fn a_vehicle_too_heavy_to_fly_says_so_once_and_fails_with_or_without_an_end() {
    let here = folder("heavy");
    fs::write(here.join("heavy.toml"), "[vehicle]\nmass = 3.2\n").unwrap();
    for more in [&[][..], &["--duration", "40"]] {
        let said = sitl(&here, &[&["--headless", "--scenario", "heavy.toml"], more].concat());
        assert_eq!(said.code, 1);
        assert_eq!(said.out.matches("Arming denied: too heavy for the thrust").count(), 1);
        assert_eq!(said.err, "error: never armed: too heavy for the thrust\n");
    }
}

#[test]
fn parameters_that_do_not_go_together_are_the_reason_in_their_own_words() {
    let here = folder("rule");
    let said = sitl(&here, &["--headless", "--param", "RATE_P=5"]);
    assert_eq!(said.code, 1, "{}", said.out);
    assert_eq!(said.err, "error: never armed: ATC_TILT_P too fast for RATE_P\n");
}

#[test]
fn the_verdict_is_the_last_line_and_has_every_key() {
    let here = folder("verdict");
    fs::write(
        here.join("hop.toml"),
        "[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = 2.0\n[[mission]]\ndo = \"hold\"\n\
         seconds = 5.0\n[[mission]]\ndo = \"land\"\n[[fault]]\nkind = \"rangefinder_lost\"\n\
         when = { step = \"hold\" }\n",
    )
    .unwrap();
    let said = sitl(&here, &["--headless", "--scenario", "hop.toml", "--json"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{}", said.out);
    let verdict: serde_json::Value =
        serde_json::from_str(said.out.trim_end().lines().last().unwrap()).unwrap();
    let keys: Vec<_> = verdict.as_object().unwrap().keys().map(String::as_str).collect();
    let mut wanted = [
        "lost",
        "armed",
        "disarmed_at_s",
        "touch_down_mps",
        "touch_down_sideways_mps",
        "max_tilt_rad",
        "max_height_m",
        "distance_from_pad_m",
        "hold_horizontal_rms_m",
        "hold_vertical_rms_m",
        "estimate_error_rms_m",
        "tension_error_rms_n",
        "final_mode",
        "failures",
        "texts",
    ];
    wanted.sort_unstable();
    let mut keys = keys;
    keys.sort_unstable();
    assert_eq!(keys, wanted);
    assert!(verdict["lost"].is_null() && verdict["armed"] == false, "{verdict}");
    assert!(verdict["max_height_m"].as_f64().unwrap() > 1.5, "{verdict}");
    assert!(verdict["texts"].as_array().unwrap().iter().any(|text| text == "Landed, disarmed"));
    // The same flight as a table.
    let told = sitl(&here, &["--headless", "--scenario", "hop.toml"]);
    assert!(told.out.contains("touch-down"), "{}", told.out);
    assert!(told.out.lines().all(|line| line.len() < 120), "{}", told.out);
}

#[test]
fn what_stops_the_motors_is_among_the_failures() {
    let here = folder("stop");
    fs::write(
        here.join("stop.toml"),
        "[[fault]]\nkind = \"motor_stop\"\nrotor = 1\nwhen = { height_above = 2.0 }\n",
    )
    .unwrap();
    let said = sitl(&here, &["--headless", "--scenario", "stop.toml", "--json"]);
    assert_eq!(said.code, 1);
    assert_eq!(said.err, "error: lost: tilted over 70 deg\n");
    assert!(said.out.contains("\"failures\":[\"capsized\"]"), "{}", said.out);
}

#[test]
fn whatever_is_wrong_is_named_in_one_line() {
    let here = folder("wrong");
    fs::write(here.join("move.toml"), "[[mission]]\ndo = \"move\"\nelevation = nan\n").unwrap();
    fs::write(
        here.join("slack.toml"),
        "[tether]\nkind = \"fixed\"\nlength = 5.0\nstart_slack = 7.0\n",
    )
    .unwrap();
    fs::write(here.join("text.txt"), "no image, no log, no table\n").unwrap();
    let cases: [(&[&str], &str); 12] = [
        (&["campaign"], "--out <DIR> <FILE.toml>"),
        (&["plot"], "<LOG.ulg>"),
        (&["plot", "text.txt"], "not a ULog file"),
        (&["plot", "none.ulg"], "none.ulg: No such file"),
        (&["sysid", "text.txt"], "text.txt: line 1: no column t_s"),
        (&["scenario", "move.toml"], "mission[0].elevation = NaN is outside 0 to"),
        (&["scenario", "slack.toml"], "tether.start_slack = 7 is no less than"),
        (&["--gcs", "10.0.0.1:99999"], "--gcs"),
        (&["--speedup", "fast"], "fast is not a number"),
        (&["--headless", "--log-dir", "text.txt"], "text.txt"),
        (&["experiment", "nothing"], "nothing: no such experiment"),
        (&["--scenario", "none.toml"], "none.toml: No such file"),
    ];
    for (arguments, want) in cases {
        let said = sitl(&here, arguments);
        assert_eq!(said.code, 2, "{arguments:?}: {}", said.err);
        assert_eq!(said.err.trim_end().lines().count(), 1, "{arguments:?}: {}", said.err);
        assert!(said.err.starts_with("error: ") && said.err.contains(want), "{}", said.err);
    }
    let emulated = sitl(&here, &["emulate", "--image", "text.txt", "--scenario", "move.toml"]);
    assert_eq!(emulated.code, 2);
}

#[test]
fn a_thrust_stands_table_becomes_a_parameter_file() {
    let here = folder("stand");
    let rows: String = (0..=20)
        .map(|i| {
            let u = f64::from(i) / 20.0;
            let gf = 8.1 * (0.55 * u * u + 0.45 * u) / 9.806_65e-3;
            format!("{:.0},{gf:.2},15.2\n", 1000.0 + 1000.0 * u)
        })
        .collect();
    fs::write(here.join("stand.csv"), format!("PWM (us),Thrust (gf),Voltage (V)\n{rows}")).unwrap();
    let said = sitl(&here, &["sysid", "stand.csv", "--out", "rotor.params"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    let params = fs::read_to_string(here.join("rotor.params")).unwrap();
    assert!(params.contains("MOT_THR_MAX\t8.") && params.contains("THR_MDL_FAC\t0.5"), "{params}");
    assert!(!params.contains("MOT_TAU"), "{params}");
}

#[test]
fn an_export_that_fails_leaves_what_was_there() {
    let here = folder("export");
    fs::write(here.join("short.toml"), "[[mission]]\ndo = \"arm\"\n").unwrap();
    sitl(&here, &["--headless", "--scenario", "short.toml", "--duration", "5", "--log-dir", "."]);
    let log = fs::read(here.join("flight-0001.ulg")).unwrap();
    let own = sitl(&here, &["export", "flight-0001.ulg", "--out", "./flight-0001.ulg"]);
    assert_eq!((own.code, own.err.lines().count()), (2, 1), "{}", own.err);
    assert_eq!(fs::read(here.join("flight-0001.ulg")).unwrap(), log);
    assert_eq!(sitl(&here, &["export", "flight-0001.ulg"]).code, 0);
    let good = fs::read(here.join("flight-0001.mcap")).unwrap();
    fs::write(here.join("flight-0001.ulg"), "no log").unwrap();
    assert_eq!(sitl(&here, &["export", "flight-0001.ulg"]).code, 2);
    assert_eq!(fs::read(here.join("flight-0001.mcap")).unwrap(), good);
    let left = fs::read_dir(&here).unwrap().count();
    assert_eq!(left, 3, "scenario, log, export");
}
