//! From counts to directions, newtons and microteslas.

use tautline_firmware::param::Params;
use tautline_firmware::sense::{ImuScale, Motion, RawSensors, Sense, SenseState};
use tautline_firmware::signal::{
    LineSensors, RawAngles, RawBattery, RawFairlead, RawImu, RawLineSensors, RawMagnetometer,
    RawTension,
};
use tautline_firmware::time::{Micros, Sample};

const SCALE: ImuScale = ImuScale { gyro: 1e-3, accel: 5e-3, rate_hz: 1000.0 };

/// Boards that sit as they are marked.
fn aligned() -> Params {
    Params { board_rotation: 0.0, ..Params::default() }
}

struct Bench {
    sense: Sense<f32>,
    state: SenseState<f32>,
    now: Micros,
}

impl Bench {
    fn new(params: &Params) -> Self {
        let (sense, state) = (Sense::new(params, SCALE), SenseState::default());
        Self { sense, state, now: Micros(1_000_000) }
    }

    fn feel(&mut self, raw: &RawSensors) -> LineSensors {
        self.now = Micros(self.now.0 + 1_000);
        let motion = Motion { cos_tilt: 1.0, accel_up: 0.0, rests: true };
        self.sense.step(&mut self.state, self.now, raw, &motion).line
    }

    fn line(&mut self, line: RawLineSensors) -> LineSensors {
        self.feel(&RawSensors { line, ..RawSensors::default() })
    }
}

fn once(params: &Params, line: RawLineSensors) -> LineSensors {
    Bench::new(params).line(line)
}

fn angles(outer: u16, inner: u16) -> RawLineSensors {
    let angles = Some(RawAngles { counts: [Some(outer), Some(inner)] });
    RawLineSensors { angles, ..RawLineSensors::default() }
}

fn tension(counts: i32) -> RawLineSensors {
    RawLineSensors { tension: Some(RawTension { counts }), ..RawLineSensors::default() }
}

fn field(counts: [i16; 3]) -> RawLineSensors {
    let magnetometer = Some(RawMagnetometer { counts });
    RawLineSensors { magnetometer, ..RawLineSensors::default() }
}

fn fairlead(azimuth: f32, elevation: f32) -> RawLineSensors {
    let fairlead = Some(RawFairlead { azimuth, elevation });
    RawLineSensors { fairlead, ..RawLineSensors::default() }
}

fn is_near(got: [f32; 3], want: [f32; 3]) -> bool {
    got.iter().zip(want).all(|(a, b)| (a - b).abs() < 2e-3)
}

#[test]
fn what_is_not_fitted_is_nothing() {
    let mut bench = Bench::new(&aligned());
    for _ in 0..1000 {
        assert_eq!(bench.line(RawLineSensors::default()), LineSensors::default());
    }
}

#[test]
fn two_angles_are_a_direction_whichever_way_their_encoders_sit() {
    let straight = once(&aligned(), angles(0, 0)).direction.unwrap();
    assert!(is_near(straight.0.into(), [0.0, 0.0, 1.0]));
    // An eighth of a turn about the nose: down turns to the left; about the right-hand axis: to the nose.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let left = once(&aligned(), angles(512, 0)).direction.unwrap();
    assert!(is_near(left.0.into(), [0.0, -half, half]));
    let ahead = once(&aligned(), angles(0, 512)).direction.unwrap();
    assert!(is_near(ahead.0.into(), [half, 0.0, half]));
    // The same line seen by encoders that sit turned, one of them upside down.
    let params = Params {
        line_angle_zero_x: 1.0,
        line_angle_zero_y: 6.0,
        line_angle_sign_x: -1.0,
        ..aligned()
    };
    let counts = |angle: f32| {
        ((angle / std::f32::consts::TAU * 4096.0).round() as i32).rem_euclid(4096) as u16
    };
    let turned = once(&params, angles(counts(1.0 - 0.3), counts(6.0 + 0.2))).direction.unwrap();
    let want = [0.2_f32.sin(), -0.3_f32.sin() * 0.2_f32.cos(), 0.3_f32.cos() * 0.2_f32.cos()];
    assert!(is_near(turned.0.into(), want), "{turned:?}");
}

#[test]
fn an_angle_beyond_its_stop_or_without_a_magnet_is_none() {
    assert!(once(&aligned(), angles(2048, 0)).direction.is_none());
    let angles = Some(RawAngles { counts: [Some(0), None] });
    let half = RawLineSensors { angles, ..RawLineSensors::default() };
    assert!(once(&aligned(), half).direction.is_none());
}

#[test]
fn a_load_cell_counts_once_it_is_calibrated() {
    assert!(once(&aligned(), tension(50_000)).tension.is_none(), "0 N a count is none");
    let params = Params { line_cell_scale: -1e-4, line_cell_zero: 1_000.0, ..aligned() };
    assert!((once(&params, tension(-49_000)).tension.unwrap() - 5.0).abs() < 1e-4);
    let loose = Params { line_cell_scale: 1.0, ..aligned() };
    for counts in [2_001, -21, i32::MAX, i32::MIN] {
        assert!(once(&loose, tension(counts)).tension.is_none(), "{counts}");
    }
}

#[test]
fn a_field_is_cleared_of_iron_and_of_the_current() {
    let params = Params {
        // 6 µT and 0.5 µT/A, as PX4 counts them.
        mag_bias_x: 0.06,
        mag_scale_y: 1.5,
        mag_current_z: 5.0,
        battery_divider: 11.0,
        battery_amps_per_volt: 10.0,
        ..aligned()
    };
    let battery = RawBattery { voltage_mv: 1_400, current_mv: 2_000 };
    let mut raw = RawSensors { line: field([120, 20, 140]), ..RawSensors::default() };
    let mut bench = Bench::new(&params);
    let still = bench.feel(&raw).magnetic.unwrap();
    assert!(is_near(still.0.into(), [30.0, 9.0, 42.0]), "{still:?}");
    for _ in 0..2_000 {
        raw.battery = Some(Sample { at: bench.now, value: battery });
        bench.feel(&raw);
    }
    let under_current = bench.feel(&raw).magnetic.unwrap();
    assert!((under_current.0.z - 32.0).abs() < 0.05, "20 A: {under_current:?}");
}

#[test]
fn a_field_that_is_not_earths_is_none() {
    for counts in [[5_000, 0, 0], [3, 3, 3], [0; 3]] {
        assert!(once(&aligned(), field(counts)).magnetic.is_none(), "{counts:?}");
    }
}

#[test]
fn the_stations_direction_is_north_east_down_and_within_reason() {
    let up_east = once(&aligned(), fairlead(std::f32::consts::FRAC_PI_2, 1.0));
    let (sin, cos) = 1.0_f32.sin_cos();
    assert!(is_near(up_east.station_direction.unwrap().0.into(), [0.0, cos, -sin]));
    let params = Params { station_azimuth_zero: 0.5, station_elevation_zero: -0.1, ..aligned() };
    let north = once(&params, fairlead(0.5, -0.1)).station_direction.unwrap();
    assert!(is_near(north.0.into(), [1.0, 0.0, 0.0]));
    for (azimuth, elevation) in [(0.0, 1.7), (0.0, -1.7), (1e9, 0.0), (f32::INFINITY, 0.0)] {
        let got = once(&aligned(), fairlead(azimuth, elevation));
        assert!(got.station_direction.is_none(), "{azimuth} {elevation}");
    }
}

#[test]
fn a_second_inertial_sensor_that_has_not_started_or_is_stuck_is_none() {
    let second = |counts: i16| {
        let raw = RawImu { gyro: [counts; 3], accel: [counts; 3], temperature: 25.0 };
        RawLineSensors { second_imu: Some(raw), ..RawLineSensors::default() }
    };
    assert!(once(&aligned(), second(i16::MIN)).second_imu.is_none(), "before it starts");
    // A bus that floats: the same counts for ever.
    let mut bench = Bench::new(&aligned());
    let last = (0..1_000).map(|_| bench.line(second(-1))).last().unwrap();
    assert!(last.second_imu.is_none());
}

#[test]
fn a_sensor_that_falls_silent_is_forgotten_and_takes_no_other_along() {
    let params = Params { line_cell_scale: 1e-4, ..aligned() };
    let mut bench = Bench::new(&params);
    let raw = RawImu { gyro: [10, 0, 0], accel: [0, 0, -1962], temperature: 25.0 };
    let all = RawLineSensors {
        tension: Some(RawTension { counts: 50_000 }),
        magnetometer: Some(RawMagnetometer { counts: [70, 0, 140] }),
        second_imu: Some(raw),
        station_tension: Some(5.0),
        ..angles(0, 0)
    };
    let heard = bench.line(all);
    assert!(heard.direction.is_some() && heard.tension.is_some() && heard.second_imu.is_some());
    assert!((heard.second_imu.unwrap().accel.0.z + 9.81).abs() < 0.01);
    // The load cell goes on; the others stop.
    for _ in 0..499 {
        assert!(bench.line(tension(50_000)).direction.is_some(), "as last heard");
    }
    bench.line(tension(50_000));
    let rest = bench.line(tension(50_000));
    let only = LineSensors { tension: rest.tension, ..LineSensors::default() };
    assert!(rest == only && rest.tension.is_some(), "{rest:?}");
}
