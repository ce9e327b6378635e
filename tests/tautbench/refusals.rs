//! What is missing or wrong ends in one line that names the file.

use crate::{PLACE, columns, estimates, sample};
use std::fs;
use std::path::Path;
use tautline_sitl::tautbench::{DataSet, score_folder};

/// The line, with one file of estimates replaced by what `spoil` makes of its text.
fn refusal(name: &str, spoil: impl Fn(&Path, String)) -> String {
    let folder = estimates(name, |truth| columns(truth, &PLACE));
    let path = folder.join("sample-winch-5mps-1.csv");
    let text = fs::read_to_string(&path).unwrap();
    spoil(&path, text);
    let e = score_folder(&sample(), "x", &folder).unwrap_err();
    fs::remove_dir_all(folder).unwrap();
    assert!(!e.contains('\n') && e.contains("sample-winch-5mps-1.csv"), "{e}");
    e
}

#[test]
fn a_flight_without_estimates_is_refused() {
    let e = refusal("missing", |path, _| fs::remove_file(path).unwrap());
    assert!(e.contains("no such file"), "{e}");
}

#[test]
fn numbers_that_are_none_are_refused_with_their_row() {
    for (cell, want) in [
        ("NaN", "row 1: north_m = NaN is not finite"),
        ("inf", "row 1: north_m = inf"),
        ("far", "line 2: north_m: far is not a number"),
    ] {
        let e = refusal(&format!("cell-{cell}"), |path, text| {
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            let mut cells: Vec<_> = lines[1].split(',').map(str::to_owned).collect();
            cells[1] = cell.into();
            lines[1] = cells.join(",");
            fs::write(path, lines.join("\n")).unwrap();
        });
        assert!(e.contains(want), "{e}");
    }
}

#[test]
fn columns_that_are_unknown_or_missing_are_named() {
    let head = |name: &str, from: &'static str, to: &'static str| {
        refusal(name, move |path, text| fs::write(path, text.replacen(from, to, 1)).unwrap())
    };
    assert!(head("unknown", "north_m", "x_m").contains("x_m: no such column; there may be time_s"));
    assert!(head("no-time", "time_s", "length_m").contains("no column time_s"));
    assert!(head("two-of-three", "down_m", "tension_n").contains("no column down_m"));
    assert!(
        head("sigma", "down_m", "tension_sigma_n").contains("no column down_m"),
        "and before what goes with it"
    );
}

#[test]
fn times_beyond_the_flight_or_out_of_order_are_refused() {
    let e = refusal("late", |path, text| fs::write(path, format!("{text}900,0,0,-1\n")).unwrap());
    assert!(e.contains("time_s = 900 is outside the flight"), "{e}");
    let e = refusal("again", |path, text| {
        let last = text.lines().last().unwrap();
        fs::write(path, format!("{text}{last}\n")).unwrap();
    });
    assert!(e.contains("does not come after"), "{e}");
    let e = refusal("ragged", |path, text| fs::write(path, format!("{text}1,2\n")).unwrap());
    assert!(e.contains("2 fields"), "{e}");
}

#[test]
fn a_truth_that_was_touched_is_not_scored_against() {
    let folder = crate::folder("touched");
    fs::create_dir_all(&folder).unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sitl/tautbench/sample");
    for entry in fs::read_dir(sample).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), folder.join(entry.file_name())).unwrap();
    }
    let (data, truth) = (DataSet::open(&folder).unwrap(), "sample-fixed-calm-1.truth.parquet");
    let mut bytes = fs::read(folder.join(truth)).unwrap();
    bytes[100] ^= 1;
    fs::write(folder.join(truth), bytes).unwrap();
    let said = estimates("touched-estimates", |truth| columns(truth, &PLACE));
    let e = score_folder(&data, "x", &said).unwrap_err();
    fs::remove_dir_all(folder).unwrap();
    fs::remove_dir_all(said).unwrap();
    assert!(e.contains(truth) && e.contains("is not the file that manifest.json names"), "{e}");
    let e = DataSet::open(Path::new("no-such-folder")).unwrap_err();
    assert!(e.starts_with("no-such-folder/manifest.json: "), "{e}");
}
