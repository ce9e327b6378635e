//! f64, f32 and fixed point agree within stated bounds.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use tautline_firmware::control::{Mixer, TetherAngleLoop, ThrustMap};
use tautline_firmware::estimate::tether_angle::{
    TENSION_FLOOR, TetherAngleState, TetherAngleUkf, locate,
};
use tautline_firmware::estimate::{Mahony, MahonyState};
use tautline_firmware::fixed::Q16;
use tautline_firmware::frames::{Attitude, Body, V3};
use tautline_firmware::math::so3;
use tautline_firmware::model::{TetherAngle, TetherAngleModel, TiltImu};
use tautline_firmware::param::Params;
use tautline_firmware::scalar::Scalar;
use tautline_firmware::sense::ImuScale;
use tautline_firmware::signal::{PerRotor, RawImu, RawRange, Wrench};
use tautline_firmware::time::{Micros, Sample};
use tautline_firmware::trajectory::smooth_step;
use tautline_firmware::vehicle::{StepInput, Vehicle};

fn v<S: Scalar>(x: f64, y: f64, z: f64) -> V3<S> {
    V3::new(S::lit(x), S::lit(y), S::lit(z))
}

/// Ten seconds of a swinging attitude.
fn attitude<S: Scalar>() -> [f32; 4] {
    let filter = Mahony { kp: S::lit(0.2), ki: S::lit(0.01) };
    let mut state = MahonyState::new(Attitude::level(S::lit(0.4)), Body(V3::zeros()));
    for i in 0..2500 {
        let t = f64::from(i) * 0.004;
        let gyro = v(0.3 * t.sin(), 0.2 * (1.3 * t).cos(), 0.1);
        let accel = v(0.5 * t.sin(), -0.3, -9.81);
        filter.step(&mut state, &Body(gyro), &Body(accel), S::lit(0.004)).unwrap();
    }
    state.attitude.quaternion().map(Scalar::to_f32)
}

#[test]
fn the_attitude_filter_agrees_in_all_scalars() {
    let (double, single, fixed) = (attitude::<f64>(), attitude::<f32>(), attitude::<Q16>());
    for i in 0..4 {
        assert!((single[i] - double[i]).abs() < 1e-4, "f32 {single:?} {double:?}");
        // 2500 rotations of at most 2^-17 rounding each, drawn back by the accelerometer: 0.004 seen.
        assert!((fixed[i] - double[i]).abs() < 0.02, "Q16 {fixed:?} {double:?}");
    }
}

fn thrusts<S: Scalar>(roll: f64, yaw: f64) -> PerRotor<f32> {
    let mixer = Mixer::<S>::new(&Params::default());
    let map = ThrustMap::<S>::new(&Params::default());
    let wrench = Wrench { thrust: S::lit(15.0), torque: Body(v(roll, -0.2, yaw)) };
    let mut f = mixer.each(S::zero());
    mixer.step(&wrench, &mut f);
    f.map(|thrust| map.throttle(thrust, Some(S::lit(14.8))).to_f32())
}

#[test]
fn mixer_and_thrust_map_agree_in_all_scalars() {
    for i in 0..200 {
        let x = f64::from(i) * 0.02 - 2.0;
        let (double, single, fixed) =
            (thrusts::<f64>(x, 0.1 * x), thrusts::<f32>(x, 0.1 * x), thrusts::<Q16>(x, 0.1 * x));
        for k in 0..4 {
            assert!((single[k] - double[k]).abs() < 1e-5);
            assert!((fixed[k] - double[k]).abs() < 2e-3, "{x}: {fixed:?} {double:?}");
        }
    }
}

#[test]
fn rotations_and_smooth_steps_agree_in_fixed_point() {
    for i in 1..300 {
        let a = f64::from(i) * 0.01;
        let exact = so3::exp(&v::<f64>(a, -0.5 * a, 0.2));
        let fixed = so3::exp(&v::<Q16>(a, -0.5 * a, 0.2));
        for (f, e) in fixed.iter().zip(exact.iter()) {
            assert!((f64::from(f.to_f32()) - e).abs() < 2e-4, "{a}");
        }
        let (e, f) = (smooth_step(a / 3.0), smooth_step(Q16::lit(a / 3.0)));
        assert!((f64::from(f.0.to_f32()) - e.0).abs() < 2e-4);
    }
}

/// Tether angle and tilt of one reading, and the tilt rate that the controller asks.
fn tether<S: Scalar>(angle: f64) -> [f32; 3] {
    let model = TetherAngleModel::try_new(S::lit(14.0), S::lit(5.0)).unwrap();
    let tilt = model.equilibrium_tilt(S::lit(angle)).unwrap();
    let x = TetherAngle { angle: S::lit(angle), rate: S::lit(0.1), tilt };
    let force = model.specific_force(&x, model.tension(&x, [S::zero(); 2]));
    let floor = S::lit(TENSION_FLOOR);
    let found = locate(&model, force, x.rate, tilt, floor).unwrap();
    let asked = TetherAngleLoop::spatial().step(&model, S::lit(0.5), &x);
    [found.angle, found.tilt, asked.rate].map(Scalar::to_f32)
}

#[test]
fn tether_sensing_and_control_agree_in_all_scalars() {
    for i in 20..80 {
        let angle = f64::from(i).to_radians();
        let (double, single, fixed) =
            (tether::<f64>(angle), tether::<f32>(angle), tether::<Q16>(angle));
        for k in 0..3 {
            assert!((single[k] - double[k]).abs() < 1e-5, "{i}: {single:?} {double:?}");
            // The cosine of the angle carries 2^-16 of the forces; 1e-3 seen.
            assert!((fixed[k] - double[k]).abs() < 4e-3, "{i}: {fixed:?} {double:?}");
        }
    }
}

/// A second of the unscented filter on a reading at rest, started 6° off.
fn filtered<S: Scalar>() -> f32 {
    let model = TetherAngleModel::try_new(S::lit(14.0), S::lit(5.0)).unwrap();
    let angle = S::lit(0.6);
    let rest = TetherAngle { angle, rate: S::zero(), tilt: model.equilibrium_tilt(angle).unwrap() };
    let [x, z] = model.specific_force(&rest, model.tension(&rest, [S::zero(); 2]));
    let ukf = TetherAngleUkf::try_new(S::lit(0.0125)).unwrap();
    let mut state = TetherAngleState::at(TetherAngle { angle: S::lit(0.7), ..rest });
    for _ in 0..80 {
        ukf.step(&model, &mut state, &TiltImu { x, z, rate: S::zero() });
    }
    state.posterior.x.angle.to_f32()
}

#[test]
fn the_unscented_filter_agrees_in_all_scalars() {
    let (double, single, fixed) = (filtered::<f64>(), filtered::<f32>(), filtered::<Q16>());
    assert!((single - double).abs() < 1e-4, "{single} {double}");
    // Covariances of 1e-3 rad² have six bits in Q16.16.
    assert!((fixed - double).abs() < 0.02, "{fixed} {double}");
}

/// The same readings through a whole vehicle: at rest on the ground, levelling.
fn rest<S: Scalar>() -> (bool, f32, f32) {
    let scale = ImuScale { gyro: 1.065e-3, accel: 4.788e-3, rate_hz: 1000.0 };
    let mut vehicle = Vehicle::<S>::new(Params::default(), scale);
    let mut out = vehicle.step(&StepInput::default());
    for i in 1..6000_u64 {
        let now = Micros(i * 1000);
        let flicker = (i % 3) as i16 - 1;
        // Chip axes of the reference board: body (y, x, -z).
        let imu = RawImu {
            accel: [flicker, 100 + flicker, 2046],
            gyro: [flicker, 2, -flicker],
            temperature: 30.0,
        };
        let mut input = StepInput { now, ..StepInput::default() };
        input.sensors.imu = Some(Sample { at: now, value: imu });
        if i % 10 == 0 {
            input.sensors.range =
                Some(Sample { at: now, value: RawRange { distance_cm: Some(12) } });
        }
        out = vehicle.step(&input);
    }
    let (roll, pitch, _) = out.estimate.attitude.euler();
    (out.estimate.is_levelled, roll.to_f32(), pitch.to_f32())
}

#[test]
fn the_whole_step_runs_and_levels_in_all_scalars() {
    let (double, single, fixed) = (rest::<f64>(), rest::<f32>(), rest::<Q16>());
    assert!(double.0 && single.0 && fixed.0);
    assert!((double.2 - 0.0489).abs() < 2e-3, "pitch {}", double.2);
    assert!((single.1 - double.1).abs() < 1e-4 && (single.2 - double.2).abs() < 1e-4);
    assert!(
        (fixed.1 - double.1).abs() < 5e-3 && (fixed.2 - double.2).abs() < 5e-3,
        "{fixed:?} {double:?}"
    );
}
