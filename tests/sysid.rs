//! Thrust identification: what a messy table is told, and whether a flight's own log gives the truth back.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use std::fmt::Write;
use tautline_firmware::param::Params;
use tautline_sitl::scenario::Scenario;
use tautline_sitl::sysid::{
    Form, Model, PwmRange, Record, Signals, arx, fit, fit_stand, fit_thrust_map, identify,
    parse_csv, parse_stand, prepare, read_log, recommend,
};
use tautline_tests::{flight, until};

/// Square waves of different periods, so that every channel says something of its own.
fn pwm(channel: usize, time: f64) -> f64 {
    let period = [0.7, 0.9, 1.3, 1.7][channel];
    let wave = if (time / period).rem_euclid(1.0) < 0.5 { 1.0 } else { -1.0 };
    1500.0 + 60.0 * wave + 25.0 * (0.9 * time + channel as f64).sin()
}

/// A table of a known vehicle: 8 N a rotor, half square law, lag 40 ms; `edit` may spoil a line.
fn table(seconds: f64, edit: impl Fn(usize, String) -> String) -> String {
    let dt = 0.01;
    let mut text = String::from("t_s,pwm_1,pwm_2,pwm_3,pwm_4,thrust_N\n");
    let mut lagged = [None; 4];
    for row in 0..(seconds / dt) as usize {
        let time = row as f64 * dt;
        let mut line = format!("{time:.3}");
        for (channel, thrust) in lagged.iter_mut().enumerate() {
            let value = pwm(channel, time);
            let u = (value - 1000.0) / 1000.0;
            let wanted = 8.0 * (0.5 * u * u + 0.5 * u);
            let thrust = thrust.get_or_insert(wanted);
            *thrust += (wanted - *thrust) * (1.0 - (-dt / 0.04_f64).exp());
            write!(line, ",{value:.2}").unwrap();
        }
        write!(line, ",{:.5}", lagged.iter().flatten().sum::<f64>()).unwrap();
        // Line 1 is the header.
        text.push_str(&edit(row + 2, line));
        text.push('\n');
    }
    text
}

fn read(text: &str) -> Result<Record, String> {
    parse_csv(text.as_bytes(), "flight.csv")
}

#[test]
fn a_messy_table_is_refused_by_line_and_column() {
    let good = table(20.0, |_, line| line);
    assert!(read(&good).is_ok());
    assert!(read(&format!("\u{feff}{good}")).is_ok(), "a byte-order mark is no column");
    let spoilt = |at: usize, with: &str| {
        let with = with.to_owned();
        read(&table(20.0, move |n, line| if n == at { with.clone() } else { line })).unwrap_err()
    };
    let constant = good.lines().map(|line| {
        let mut cells: Vec<_> = line.split(',').collect();
        if cells[0] != "t_s" {
            cells[3] = "1500";
        }
        cells.join(",")
    });
    let constant = constant.collect::<Vec<_>>().join("\n");
    let cases = [
        (read(&good.replacen("thrust_N", "thrust", 1)).unwrap_err(), "line 1: no column thrust_N"),
        (read(&good.replacen("pwm_3", "p3", 1)).unwrap_err(), "line 1: 3 columns pwm_"),
        (read(&good.replacen("t_s", "time", 1)).unwrap_err(), "line 1: no column t_s"),
        (spoilt(50, "0.48,1500,nan,1500,1500,12"), "line 50, column pwm_2: \"nan\""),
        (spoilt(50, "0.48,1500,1500,1500,1500,"), "line 50, column thrust_N: \"\""),
        (spoilt(50, "0.48,1500,1500,x,1500,12"), "line 50, column pwm_3: \"x\""),
        (spoilt(50, "0.2,1500,1500,1500,1500,12"), "line 50, column t_s: 0.2 after 0.47"),
        (spoilt(50, "0.48,1500,1500"), "line: 50"),
        (spoilt(50, "0.48,1e999,1500,1500,1500,12"), "line 50, column pwm_1"),
        (read(&table(2.0, |_, line| line)).unwrap_err(), "only 200 rows over 2.0 s"),
        (read("t_s,pwm_1,pwm_2,pwm_3,pwm_4,thrust_N\n").unwrap_err(), "only 0 rows"),
        (read("").unwrap_err(), "line 1"),
        (read(&constant).unwrap_err(), "column pwm_3: constant"),
    ];
    for (error, part) in cases {
        assert!(error.starts_with("flight.csv: ") && error.contains(part), "{error:?}: {part:?}");
        assert!(!error.contains('\n'), "{error:?}");
    }
    let gap = good.lines().enumerate().filter(|(n, _)| !(500..600).contains(n));
    let gap = gap.map(|(_, line)| line).collect::<Vec<_>>().join("\n");
    assert!(read(&gap).unwrap_err().contains("a gap of 1.01 s"));
}

#[test]
fn a_known_thrust_map_is_found_again() {
    let record = read(&table(40.0, |_, line| line)).unwrap();
    let range = PwmRange::guess(&record);
    assert_eq!((range.low, range.high), (1000.0, 2000.0));
    let found = fit_thrust_map(&record, range, &Params::default()).unwrap();
    assert!(found.factor_is_known, "{found:?}");
    assert!((found.thrust_max / 8.0 - 1.0).abs() < 0.01, "{found:?}");
    assert!((found.factor - 0.5).abs() < 0.05, "{found:?}");
    assert!((found.lag.unwrap() - 0.04).abs() < 0.006, "{found:?}");
    // A range that the record leaves is an error, not a clamp.
    let wrong = PwmRange { low: 1000.0, high: 1400.0 };
    assert!(fit_thrust_map(&record, wrong, &Params::default()).unwrap_err().contains("outside"));
    let empty = PwmRange { low: 5.0, high: 5.0 };
    assert!(fit_thrust_map(&record, empty, &Params::default()).unwrap_err().contains("empty"));
}

/// A stand's table: one rotor of 8.1 N with 0.55 of the square law, in kgf, by so many steps.
fn stand(steps: usize, volts: f64, thrust: impl Fn(f64) -> f64) -> String {
    let mut text = String::from("\u{feff}Time (s),ESC signal (\u{b5}s),Thrust (kgf),Voltage (V)\n");
    for row in 0..=steps {
        let u = row as f64 / steps as f64;
        let kgf = thrust(u) / 9.806_65;
        writeln!(text, "{:.2},{:.1},{kgf:.6},{volts}", row, 1000.0 + 1000.0 * u).unwrap();
    }
    text
}

fn curve(u: f64) -> f64 {
    8.1 * (0.55 * u * u + 0.45 * u)
}

#[test]
fn a_stands_table_of_few_points_gives_the_curve_and_leaves_the_lag() {
    for (text, percent) in [
        (stand(10, 15.2, curve), false),
        (stand(400, 15.2, curve).replace("ESC signal (\u{b5}s)", "Throttle (%)"), true),
    ] {
        let mut table = parse_stand(&text, "stand.csv").unwrap();
        assert_eq!(table.is_percent, percent);
        if percent {
            table.signal.iter_mut().for_each(|x| *x = (*x - 1000.0) / 10.0);
        }
        let found = fit_stand(&table, table.range(), &Params::default()).unwrap();
        let named: Vec<_> = found.parameters();
        let names: Vec<_> = named.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["MOT_THR_MAX", "THR_MDL_FAC"]);
        assert!((named[0].1 - 8.1).abs() < 0.01 && (named[1].1 - 0.55).abs() < 0.01, "{named:?}");
        assert!(found.warnings().is_empty(), "{:?}", found.warnings());
    }
}

#[test]
fn another_batterys_table_says_so_and_a_stalling_rotor_too() {
    let stalls = |u: f64| if u > 0.7 { 0.23 - 0.3 * (u - 0.7) } else { 0.33 * u };
    let table = parse_stand(&stand(40, 3.7, stalls), "stand.csv").unwrap();
    let found = fit_stand(&table, table.range(), &Params::default()).unwrap();
    assert!(found.thrust_max < 0.35, "{found:?}");
    assert!((found.nominal_voltage.unwrap() - 3.7).abs() < 1e-9);
    let warnings = found.warnings();
    assert!(warnings.iter().any(|w| w.contains("MOT_V_NOM")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("mean thrust")), "{warnings:?}");
}

#[test]
fn a_stands_table_is_refused_by_line_and_column() {
    let error = |text: &str| parse_stand(text, "s.csv").map(drop).unwrap_err();
    assert!(error("PWM,Thrust (stone)\n1,2\n").contains("thrust in \"stone\""));
    assert!(error("Thrust (N)\n1\n").contains("no column of the ESC's signal"));
    let text = error("PWM (us);Thrust (gf)\n1000;0\n1100;x\n");
    assert_eq!(text, "s.csv: line 3, column Thrust (gf): \"x\" is no number");
    // A comma is a decimal point where a semicolon parts the cells.
    let table = parse_stand("PWM (us);Thrust (gf)\n1100;1,5\n", "s.csv").unwrap();
    assert!((table.thrust[0] - 1.5 * 9.806_65e-3).abs() < 1e-12);
    let few = parse_stand("PWM (us),Thrust (N)\n1000,0\n1500,2\n2000,5\n", "s.csv").unwrap();
    let refused = fit_stand(&few, few.range(), &Params::default()).unwrap_err();
    assert!(refused.contains("different throttles"), "{refused}");
}

#[test]
fn a_slow_ramp_does_not_tell_the_lag() {
    let mut text = String::from("t_s,pwm_1,pwm_2,pwm_3,pwm_4,thrust_N\n");
    for row in 0..=400 {
        let u = f64::from(row) / 400.0;
        let pwm = 1000.0 + 1000.0 * u;
        writeln!(text, "{:.2},{pwm},{pwm},{pwm},{pwm},{:.5}", u * 48.0, 4.0 * curve(u)).unwrap();
    }
    let record = read(&text).unwrap();
    let found = fit_thrust_map(&record, PwmRange::guess(&record), &Params::default()).unwrap();
    assert_eq!(found.lag, None);
    assert!((found.thrust_max - 8.1).abs() < 0.05, "{found:?}");
    assert!(found.parameters().iter().all(|(name, _)| *name != "MOT_TAU"));
}

#[test]
fn arx_and_output_error_find_a_known_system_again() {
    let inputs: Vec<Vec<f64>> =
        (0..4).map(|c| (0..2000).map(|t| pwm(c, t as f64 * 0.01) - 1500.0).collect()).collect();
    let mut output: Vec<f64> = vec![0.0; 2000];
    for t in 1..2000 {
        output[t] = 0.8 * output[t - 1]
            + (0..4).map(|c| 0.01 * (c + 1) as f64 * inputs[c][t - 1]).sum::<f64>();
    }
    let data = Signals { inputs, output };
    let model = arx(&data, 1, 1).unwrap();
    assert!((model.a[1] + 0.8).abs() < 1e-9);
    for (c, gain) in model.static_gains().iter().enumerate() {
        assert!((gain - 0.05 * (c + 1) as f64).abs() < 1e-9);
    }
    let model = fit(Form::Process, &data).unwrap();
    for ([_, f], gain) in model.inputs.iter().zip(model.static_gains()) {
        assert!((f[1] + 0.8).abs() < 1e-3 && gain > 0.0, "{model:?}");
    }
}

#[test]
fn all_structures_are_scored_and_the_recommended_one_is_stable() {
    let record = read(&table(30.0, |_, line| line)).unwrap();
    let found = identify(&prepare(&record).unwrap());
    assert_eq!(found.len(), 6);
    let best = recommend(&found).unwrap();
    assert!(best.is_stable && best.fit > 90.0, "{} {}", best.name, best.fit);
    for model in found.iter().flatten() {
        assert!(model.fpe >= model.mse && model.mse >= 0.0, "{}", model.name);
        if let Model::Polynomial(p) = &model.model {
            assert_eq!(p.inputs.len(), 4);
        }
    }
}

#[test]
fn a_flights_own_log_gives_the_thrust_map_of_the_simulated_rotors() {
    let text =
        include_str!("../sitl/scenarios/excite.toml").replace("seconds = 60.0", "seconds = 25.0");
    let mut shaken = flight(&text, 4);
    until(&mut shaken, 120.0, |out| out.is_armed);
    until(&mut shaken, 120.0, |out| !out.is_armed);
    let log = shaken.finish_log().unwrap().unwrap();
    let mut params = Params::default();
    let record = read_log(log.as_slice(), "log", &mut params).unwrap();
    assert!(record.duration() > 15.0 && record.voltage.is_some());
    let found = fit_thrust_map(&record, PwmRange::guess(&record), &params).unwrap();
    let vehicle = Scenario::default().vehicle;
    let thrust = |u: f64| {
        let max = vehicle.thrust_coefficient * vehicle.rotor_speed_max.powi(2);
        max * u.powf(2.0 * vehicle.throttle_curve)
    };
    // Rotor gains are drawn within 2 % together and 1 % each; the accelerometer is off by 0.05 m/s².
    for u in [0.4, 0.5, 0.6] {
        let ours = found.thrust_max * (found.factor * u * u + (1.0 - found.factor) * u);
        assert!((ours / thrust(u) - 1.0).abs() < 0.035, "{u}: {ours} {}", thrust(u));
    }
}

#[test]
fn a_log_without_stick_flight_says_so() {
    let mut held = flight("[[mission]]\ndo = \"hold\"\nseconds = 2.0\n", 1);
    held.fly(5.0);
    let log = held.finish_log().unwrap().unwrap();
    let error = read_log(log.as_slice(), "a.ulg", &mut Params::default()).unwrap_err();
    assert_eq!(error, "a.ulg: nothing flown in Altitude or Stabilize");
    assert!(read_log(&b"not a log"[..], "b.ulg", &mut Params::default()).is_err());
}
