//! What is written is what was flown.

use crate::folder::{Folder, SPREAD, flown};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::Value;
use std::fs::{self, File};
use tautline_sitl::campaign::{Cell, write_tables};

/// As the table's reader has it.
fn field(cell: &Option<Cell>) -> Field {
    match cell {
        None => Field::Null,
        Some(Cell::Flag(x)) => Field::Bool(*x),
        Some(Cell::Number(x)) => Field::Double(*x),
        Some(Cell::Text(x)) => Field::Str(x.clone()),
    }
}

#[test]
fn the_table_reads_back_as_the_rows() {
    let folder = Folder::new("table");
    let text = format!("{SPREAD}\"tether.model\" = {{ grid = [\"straight\", \"chain\"] }}");
    let campaign = folder.campaign(&text);
    let (out, header) = (folder.path("out"), campaign.header());
    let mut rows = flown(&campaign, &folder.settings("out", "1/1"));
    rows.truncate(5);
    rows[2].reason = "lost: tilted over 70°".into();
    // Whoever calls need not sort.
    rows.reverse();
    write_tables(&out, header, &rows).unwrap();
    rows.reverse();
    let file = SerializedFileReader::new(File::open(out.join("flights.parquet")).unwrap()).unwrap();
    let read: Vec<_> = file.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(read.len(), rows.len());
    for (read, row) in read.iter().zip(&rows) {
        let mut want = vec![
            ("index".to_owned(), Field::Long(row.index as i64)),
            ("seed".to_owned(), Field::Long(row.seed as i64)),
        ];
        let named = |columns: &[tautline_sitl::campaign::Column], cells: &[Option<Cell>]| {
            assert_eq!(columns.len(), cells.len());
            columns.iter().map(|c| c.name.clone()).zip(cells.iter().map(field)).collect::<Vec<_>>()
        };
        want.extend(named(&header.varied, &row.varied));
        want.extend([
            ("complete".to_owned(), Field::Bool(row.complete)),
            ("pass".to_owned(), Field::Bool(row.pass)),
            ("reason".to_owned(), Field::Str(row.reason.clone())),
        ]);
        want.extend(named(&header.figures, &row.figures));
        let got: Vec<_> = read.get_column_iter().map(|(n, f)| (n.clone(), f.clone())).collect();
        assert_eq!(got, want);
    }
    // What varies is in the table, and a figure that no flight of this kind has is a column without values.
    let names: Vec<_> = read[0].get_column_iter().map(|(name, _)| name.as_str()).collect();
    for name in ["wind.speed", "tether.model", "hold_horizontal_rms_m", "pendulum_time_s"] {
        assert!(names.contains(&name), "{name}");
    }
}

#[test]
fn the_summary_counts_and_spreads_what_the_rows_say() {
    let folder = Folder::new("summary");
    let campaign = folder.campaign(SPREAD);
    let mut rows = flown(&campaign, &folder.settings("out", "1/1"));
    (rows[0].pass, rows[0].complete, rows[0].reason) = (false, false, "lost".into());
    let summary = write_tables(&folder.path("out"), campaign.header(), &rows).unwrap();
    let text = fs::read_to_string(folder.path("out/summary.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    for (key, want) in
        [("flights", 6), ("flown", 6), ("passed", 5), ("failed", 1), ("incomplete", 1), ("seed", 1)]
    {
        assert_eq!(json[key], want, "{key}");
    }
    assert_eq!(json["reasons"]["lost"], 1);
    assert_eq!(json["campaign"], "campaign.toml");
    assert_eq!(json["content_sha256"], summary.content_sha256.as_str());
    assert_eq!(summary.content_sha256.len(), 64);
    // 5 of 6, after Wilson: 0.436 to 0.970.
    let bound = |key: &str| json["pass_share"][key].as_f64().unwrap();
    assert!(
        (bound("wilson_95_low") - 0.436).abs() < 1e-3
            && (bound("wilson_95_high") - 0.970).abs() < 1e-3
    );
    let highest = &json["figures"]["highest_m"];
    assert_eq!(highest["count"], 6);
    let of = |key: &str| highest[key].as_f64().unwrap();
    assert!(of("p5") <= of("p50") && of("p50") <= of("p95") && of("p95") <= of("max"));
    assert!(json["figures"].get("pendulum_time_s").is_none());
}
