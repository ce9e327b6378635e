//! Scores of estimates whose errors are known.

use crate::{PLACE, columns, estimates, sample};
use std::fs;
use tautline_sitl::tautbench::methods::Method;
use tautline_sitl::tautbench::{
    Grid, Score, Table, methods, page, score_flight, score_folder, table,
};

const ALL: [&str; 9] =
    ["time_s", "north_m", "east_m", "down_m", "tension_n", "q_w", "q_x", "q_y", "q_z"];

fn scored(name: &str, of: impl Fn(&Table) -> Table) -> Score {
    let folder = estimates(name, of);
    let score = score_folder(&sample(), name, &folder).unwrap();
    fs::remove_dir_all(folder).unwrap();
    score
}

#[test]
fn the_truth_as_estimate_is_not_off_at_all() {
    let score = scored("truth", |truth| columns(truth, &ALL));
    assert_eq!(score.flights.len(), 3);
    for flight in &score.flights {
        let errors = &flight.errors;
        for rms in [
            errors.position_rms_m,
            errors.elevation_rms_rad,
            errors.azimuth_rms_rad,
            errors.tension_rms_n,
            errors.attitude_rms_rad,
        ] {
            assert_eq!(rms, Some(0.0), "{flight:?}");
        }
        assert!(errors.answered == 1.0 && !errors.lost);
    }
    assert_eq!(score.lost.share, 0.0);
}

#[test]
fn a_bias_is_scored_as_what_it_is_and_deviations_by_how_true_they_are() {
    let names = [&PLACE[..], &["tension_n"]].concat();
    let score = scored("biased", |truth| {
        let mut table = columns(truth, &names);
        for sigma in ["north_sigma_m", "east_sigma_m", "down_sigma_m", "tension_sigma_n"] {
            table.names.push(sigma.into());
        }
        for row in &mut table.rows {
            for (cell, bias) in row.iter_mut().skip(1).zip([0.3, -0.4, 1.2, -0.7]) {
                *cell = Some(cell.unwrap() + bias);
            }
            // Right in the place; twice too sure of the tension.
            row.extend([0.3, 0.4, 1.2, 0.35].map(Some));
        }
        table
    });
    for flight in &score.flights {
        let errors = &flight.errors;
        let near = |x: Option<f64>, want: f64| (x.unwrap() - want).abs() < 1e-9;
        assert!(near(errors.position_rms_m, 1.3), "{errors:?}");
        assert!(near(errors.tension_rms_n, 0.7));
        assert!(near(errors.position_consistency, 1.0) && near(errors.tension_consistency, 4.0));
        assert_eq!(errors.attitude_rms_rad, None, "it never said");
        assert!(!errors.lost);
    }
    let position = score.cells[0].position_m.unwrap();
    assert!((position.rms - 1.3).abs() < 1e-9 && position.low_95.is_none(), "one flight a cell");
}

#[test]
fn elevation_azimuth_and_length_make_a_place() {
    let score = scored("angles", |truth| {
        let place = columns(truth, &PLACE);
        let mut table = Table::new(["time_s", "elevation_rad", "azimuth_rad", "length_m"]);
        for row in &place.rows {
            let [time, x, y, z] = [0, 1, 2, 3].map(|at| row[at].unwrap());
            let length = (x * x + y * y + z * z).sqrt();
            // A whole turn is no error, and 0.02 rad of elevation is.
            let azimuth = y.atan2(x) + std::f64::consts::TAU;
            table
                .rows
                .push([time, (-z).atan2(x.hypot(y)) + 0.02, azimuth, length].map(Some).into());
        }
        table
    });
    for flight in &score.flights {
        assert!((flight.errors.elevation_rms_rad.unwrap() - 0.02).abs() < 1e-9);
        assert!(flight.errors.azimuth_rms_rad.unwrap() < 1e-9);
        // 0.02 rad on three metres of the fixed line, on eight of the winch's.
        let want = if flight.cell.contains("fixed") { 0.06 } else { 0.16 };
        let off = flight.errors.position_rms_m.unwrap();
        assert!((off - want).abs() < 0.01, "{off}");
    }
}

#[test]
fn who_runs_away_or_falls_silent_is_lost() {
    let away = scored("away", |truth| {
        let mut table = columns(truth, &PLACE);
        table.rows.iter_mut().for_each(|row| row[1] = Some(row[1].unwrap() + 3.0));
        table
    });
    assert_eq!(away.lost.share, 1.0);
    let silent = scored("silent", |truth| {
        let mut table = columns(truth, &PLACE);
        let half = table.rows.len() / 2;
        table.rows.truncate(half);
        table
    });
    for flight in &silent.flights {
        assert!(flight.errors.lost && flight.errors.answered < 0.5, "{flight:?}");
        assert!(flight.errors.position_rms_m.unwrap_or(0.0) < 0.02, "what it said was right");
    }
}

#[test]
fn the_firmwares_methods_score_on_the_sample_what_they_did() {
    let (data, grid) = (sample(), Grid::shipped().unwrap());
    let scores = table(&data, |_| {}).unwrap();
    assert_eq!(scores.len(), Method::ALL.len());
    let cells = |method| &scores.iter().find(|(own, _)| *own == method).unwrap().1.cells;
    let position = |method, cell: &str| {
        let of = cells(method).iter().find(|own| own.cell == cell)?;
        Some(of.position_m?.rms)
    };
    // Metres. What moves one of these moves the table of docs/tautbench.md.
    for (method, cell, want) in KNOWN {
        let got = position(method, cell).unwrap();
        assert!((got - want).abs() < 5e-4, "{method:?}, {cell}: {got:.4}, was {want}");
    }
    // An observer of elevation and link force gives no place, and none of it on a winch.
    let observer = cells(Method::HighGain);
    assert_eq!(observer.len(), 2);
    assert!(observer.iter().all(|c| c.position_m.is_none() && c.elevation_rad.is_some()));
    assert!(cells(Method::Ekf3).iter().all(|cell| cell.tension_n.is_none()), "it is fed in");
    assert!(cells(Method::Pendulum).is_empty());
    let text = page(&data, &grid, &scores);
    for (method, _) in &scores {
        assert!(text.contains(&format!("| {} |", method.name())), "{method:?}");
    }
}

const KNOWN: [(Method, &str, f64); 9] = [
    (Method::FullState, "sample-winch-5mps", 0.1376),
    (Method::FullState, "sample-fixed-3mps", 0.0790),
    (Method::Simple, "sample-winch-5mps", 1.2105),
    (Method::Simple, "sample-fixed-3mps", 0.1387),
    (Method::TetherAngle, "sample-fixed-3mps", 0.1636),
    (Method::Ekf4, "sample-winch-5mps", 1.4372),
    (Method::Ekf3, "sample-fixed-3mps", 0.2359),
    (Method::LowPass, "sample-winch-5mps", 1.1907),
    (Method::ErrorState, "sample-fixed-3mps", 0.5042),
];

#[test]
fn a_methods_estimates_written_as_a_file_score_the_same() {
    let (data, grid) = (sample(), Grid::shipped().unwrap());
    let flight = data.flight("sample-fixed-calm-1").unwrap();
    let recorded = data.fly_again(&grid, flight).unwrap();
    let (items, _) = tautline_sitl::replay::read(&recorded.log).unwrap();
    let said = methods::run(&items, &flight.about).unwrap();
    let (_, simple) = said.iter().find(|(method, _)| *method == Method::Simple).unwrap();
    let direct = score_flight(&data, flight, simple).unwrap();
    let path = crate::folder("written").with_extension("csv");
    fs::write(&path, simple.to_csv()).unwrap();
    let read = Table::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    assert_eq!(score_flight(&data, flight, &read).unwrap(), direct);
    assert!(direct.errors.position_rms_m.unwrap() > 0.01);
}
