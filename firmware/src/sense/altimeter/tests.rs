use super::*;
use std::vec::Vec;

/// Pa per metre near the ground.
const PASCAL: f64 = 12.01;

/// Time, truth, what the altimeter gives, whom it accuses.
type Told = (f64, f64, Option<f64>, AltimeterReport);

/// What an altimeter makes of time and height.
type Shown = fn(f64, f64) -> Option<f64>;

/// A climb to 5 m, a hold and a descent, and what each altimeter makes of the height at a time.
fn fly(
    range: impl Fn(f64, f64) -> Option<f64>,
    baro: impl Fn(f64, f64) -> Option<f64>,
) -> Vec<Told> {
    let altimeter = Altimeter::<f64>::new(&Params::default());
    let mut state = AltimeterState::default();
    let (mut height, mut climb) = (0.15_f64, 0.0_f64);
    let mut told = Vec::new();
    for ms in 0..60_000_u32 {
        let time = f64::from(ms) * 1e-3;
        let wanted = match time {
            t if t < 5.0 => 0.0,
            _ if time < 30.0 => (0.8 * (5.15 - height)).clamp(-0.8, 0.8),
            _ => (0.8 * (2.0 - height)).clamp(-0.7, 0.7),
        };
        let accel_up = 4.0 * (wanted - climb);
        climb += accel_up * 1e-3;
        height += climb * 1e-3;
        let at = Micros(u64::from(ms) * 1000);
        let noise = |n: u32| f64::from((ms / 10 * n) % 97) / 97.0 - 0.5;
        let seen = range(time, height).filter(|_| ms % 10 == 0).map(|h| {
            let cm = ((h - 0.03 + 0.04 * noise(31)) * 100.0).round().max(0.0) as u16;
            Sample { at, value: RawRange { distance_cm: Some(cm) } }
        });
        let felt = baro(time, height).filter(|_| ms % 20 == 0).map(|h| {
            let pascal = 101_325.0 - PASCAL * (h - 0.15 + 0.1 * noise(17));
            let pressure_centipascal = (pascal * 100.0) as i32;
            Sample { at, value: RawBarometer { pressure_centipascal, temperature: 20.0 } }
        });
        let raw = RawSensors { range: seen, barometer: felt, ..RawSensors::default() };
        let motion = Motion { cos_tilt: 1.0, accel_up, rests: time < 5.0 };
        if let Some(sample) = altimeter.step(&mut state, &raw, &motion, 1e-3) {
            told.push((time, height, Some(sample.value), state.report));
        } else {
            told.push((time, height, None, state.report));
        }
    }
    told
}

fn worst(told: &[Told]) -> f64 {
    told.iter().filter_map(|(_, h, seen, _)| Some((seen.as_ref()? - h).abs())).fold(0.0, f64::max)
}

fn told(told: &[Told], which: impl Fn(&AltimeterReport) -> bool) -> Option<f64> {
    told.iter().find(|(.., report)| which(report)).map(|(time, ..)| *time)
}

#[test]
fn two_that_agree_are_never_accused() {
    let flight = fly(|_, h| Some(h), |_, h| Some(h));
    assert!(worst(&flight) < 0.1, "{}", worst(&flight));
    assert!(told(&flight, |r| *r != AltimeterReport::default()).is_none());
}

#[test]
fn a_rangefinder_that_lies_is_outvoted_and_told_within_five_seconds() {
    let cases: [(&str, Shown); 4] = [
        ("stuck low", |t, h| Some(if t > 20.0 { 0.4 } else { h })),
        ("2 m too high", |t, h| Some(if t > 20.0 { h + 2.0 } else { h })),
        ("a roof", |t, h| Some(if t > 20.0 { h - 1.5 } else { h })),
        ("noise", |t, h| {
            let wild = ((t * 7919.0).sin() * 43758.5).fract() * 2.5;
            Some(if t > 20.0 { (h + wild).max(0.0) } else { h })
        }),
    ];
    for (what, range) in cases {
        let flight = fly(range, |_, h| Some(h));
        let at = told(&flight, |r| r.range_is_rejected);
        assert!(at.is_some_and(|t| (20.0..25.0).contains(&t)), "{what}: {at:?}");
        let most = if what == "noise" { 2.6 } else { 0.7 };
        assert!(worst(&flight) < most, "{what}: {}", worst(&flight));
    }
    // One that wanders a little, but not with the vehicle, is found out once that moves.
    let wander = |t: f64, h: f64| Some(if t > 20.0 { 5.15 + 0.02 * t.sin() } else { h });
    let at = told(&fly(wander, |_, h| Some(h)), |r| r.range_is_rejected);
    assert!(at.is_some_and(|t| (30.0..35.0).contains(&t)), "{at:?}");
}

#[test]
fn a_barometer_that_lies_is_outvoted_and_told() {
    let cases: [(&str, Shown); 3] = [
        ("5 m off", |t, h| Some(if t > 20.0 { h + 5.0 } else { h })),
        ("stuck", |t, h| Some(if t > 20.0 { 5.15 } else { h })),
        ("the cushion", |t, h| Some(if t > 5.0 { h - (1.5 - h).max(0.0) } else { h })),
    ];
    for (what, baro) in cases {
        let flight = fly(|_, h| Some(h), baro);
        assert!(worst(&flight) < 0.1, "{what}: {}", worst(&flight));
        assert!(told(&flight, |r| r.range_is_rejected).is_none(), "{what}");
        let is_told = told(&flight, |r| r.baro_is_rejected).is_some();
        assert_eq!(is_told, what != "the cushion", "{what}");
    }
}

#[test]
fn the_change_to_the_barometer_makes_no_step() {
    let flight = fly(|t, h| (t < 20.0).then_some(h), |_, h| Some(h));
    assert!(worst(&flight) < 0.3, "{}", worst(&flight));
    let flight = fly(|_, h| Some(h), |t, h| (t < 20.0).then_some(h));
    assert!(worst(&flight) < 0.1);
}

#[test]
fn pressure_falls_a_hectopascal_in_eight_metres() {
    let mut zero = Some(10_132_500);
    let h: f64 = relative_height(&mut zero, 10_012_500).unwrap();
    assert!((h - 100.5).abs() < 0.2, "{h}");
    assert!(relative_height::<f64>(&mut zero, 0).is_none());
}
