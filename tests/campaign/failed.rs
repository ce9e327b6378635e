//! A failed flight can be flown again from what is kept of it.

use crate::folder::{Folder, SPREAD, flown};
use std::fs;
use tautline_sitl::campaign::{Cell, fly};
use tautline_sitl::scenario::Scenario;

#[test]
fn a_kept_flight_flies_again_to_the_same_figures() {
    let folder = Folder::new("kept");
    // Nobody flies with so little tilt.
    let campaign = folder.campaign(&format!("{SPREAD}[limits]\ntilt_max_rad = 0.001"));
    let mut settings = folder.settings("out", "1/1");
    settings.keep_logs = 2;
    let rows = flown(&campaign, &settings);
    assert!(rows.iter().all(|row| !row.pass && row.reason == "tilt_max_rad over 0.001"));
    let (summary, kept) = campaign.finish(&settings, &rows).unwrap();
    assert_eq!((summary.failed, summary.incomplete, kept.len()), (6, 0, 2));
    for (kept, row) in kept.iter().zip(&rows) {
        let file = format!("out/failed/flight-00000{}.toml", row.index);
        assert_eq!(kept.scenario, folder.path(&file));
        assert!(kept.command().ends_with(&format!("--seed {} --duration 600", row.seed)));
        let scenario = Scenario::load(&kept.scenario).unwrap();
        let again = fly(&scenario, kept.seed, campaign.limits()).summary;
        let figure = |name: &str| {
            let at = campaign.header().figures.iter().position(|c| c.name == name).unwrap();
            let Some(Cell::Number(x)) = &row.figures[at] else { panic!("no {name}") };
            x.to_bits()
        };
        assert_eq!(figure("tilt_max_rad"), again.tilt_max_rad.to_bits());
        assert_eq!(figure("attitude_rms_rad"), again.attitude_rms_rad.unwrap().to_bits());
        assert_eq!(figure("highest_m"), again.highest_m.to_bits());
        let place = again.place.unwrap();
        assert_eq!(figure("place_kept_vertical"), place.kept[1].to_bits());
        assert!(fs::read(&kept.log).unwrap().starts_with(b"ULog"));
    }
    // The next campaign's results are its own.
    drop(tautline_sitl::campaign::Session::open(&folder.campaign(SPREAD), &settings).unwrap());
    assert!(!kept[0].log.exists() && !settings.out.join("summary.json").exists());
}
