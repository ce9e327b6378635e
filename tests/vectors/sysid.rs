//! `localization.json`, group `sysid`: preparation and every model structure on the public record.

use super::inventory::unread_key;
use super::{Check, folder, list, num};
use serde_json::Value;
use tautline_sitl::sysid::{Model, identify, low_pass_channel, prepare, read_csv};

/// Key of each structure in the file, in the table's order, and how far its fit may be off, %.
const RESULTS: [(&str, f64); 6] =
    [("tf", 0.3), ("process", 0.3), ("arx", 0.3), ("armax", 1.0), ("bj", 1.0), ("ss", 2.0)];

/// A model structure of the table that nothing here identifies.
pub fn unknown_part(sysid: &Value) -> Option<String> {
    unread_key(&sysid["results"], &RESULTS.map(|(key, _)| key)).map(|key| format!("model {key}"))
}

/// The filter's response to an impulse, behind the reference's denominator, is the reference's numerator.
fn check_filter(check: &mut Check, c: &Value) {
    let (b, a) = (list(c, "butter_b"), list(c, "butter_a"));
    // From rest: the first sample is zero.
    let mut impulse = vec![0.0; 40];
    impulse[1] = 1.0;
    let response = low_pass_channel(&impulse).unwrap();
    for t in 0..response.len() - 1 {
        let got: f64 = a.iter().enumerate().take(t + 1).map(|(k, a)| a * response[1 + t - k]).sum();
        check.near("butterworth", got, b.get(t).copied().unwrap_or(0.0));
    }
}

pub fn check(file: &Value) {
    let Some(c) = file.get("sysid") else { return };
    let record = read_csv(&folder().join(c["csv"].as_str().unwrap())).unwrap();
    let data = prepare(&record).unwrap();
    assert_eq!(data.filtered.len() as u64, c["n_resampled"].as_u64().unwrap());
    let mut check = Check::new(1e-6);
    check_filter(&mut check, c);
    for (row, want) in c["filtered_rows"].as_object().unwrap() {
        let row: usize = row.parse().unwrap();
        let got: Vec<f64> = data.filtered.channels().map(|x| x[row]).collect();
        let want = want.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        check.all(&format!("row {row}"), got, want);
    }
    check.all("means", data.means.iter().copied(), list(c, "est_means"));

    let found = identify(&data);
    for (model, (key, tolerance)) in found.iter().zip(RESULTS) {
        let Some(want) = c["results"].get(key) else { continue };
        let model = model.as_ref().unwrap_or_else(|e| panic!("{key}: {e}"));
        assert_eq!(model.dimension as u64, want["d"].as_u64().unwrap(), "{key}");
        let (fit, wanted) = (model.fit, num(want, "fit"));
        println!("{key}: fit {fit:.2}, reference {wanted:.2}");
        assert!((fit - wanted).abs() <= tolerance, "{key}: fit {fit}, reference {wanted}");
        assert!(model.is_stable, "{key}");
        if key == "arx"
            && let Model::Polynomial(p) = &model.model
        {
            let lags = p.inputs.iter().flat_map(|[b, _]| b[1..].to_vec());
            let theta: Vec<f64> = p.a[1..].iter().copied().chain(lags).collect();
            check.all("arx", theta, list(want, "theta"));
        }
    }
}
