//! The filters of taut-tether sensing, step by step, without a vehicle around them.
//!
//! `cargo run --release -p tautline-firmware --example sensing_step -- FILTER STEPS`, with FILTER one of
//! `none`, `ukf`, `ekf4`, `error-state`. Under `valgrind --tool=callgrind`, the difference between two
//! counts is the cost of a step; `none` is the loop around it.

use core::hint::black_box;
use tautline_firmware::estimate::localization::{
    ErrorStateFilter, ErrorStateMeasurement, ErrorStateNoise, ErrorStateStart, NoiseReading,
    article_ekf, article_start,
};
use tautline_firmware::estimate::tether_angle::{TetherAngleState, TetherAngleUkf};
use tautline_firmware::estimate::{Ekf4Measurement, cable_reading};
use tautline_firmware::frames::{Attitude, Body, V3};
use tautline_firmware::math::GRAVITY;
use tautline_firmware::model::{TetherAngle, TetherAngleModel, TiltImu};

const MASS: f32 = 1.2;
const TENSION: f32 = 6.0;

/// At rest, level, under a cable of 45°.
fn reading() -> ErrorStateMeasurement<f32> {
    let attitude = Attitude::from_euler(0.05, -0.2, 0.3);
    let weight = MASS * GRAVITY as f32;
    let place = V3::new(3.0, 1.0, -3.5);
    let thrust = 16.0;
    let accel = cable_reading(&attitude, place, TENSION, thrust, weight) * GRAVITY as f32;
    ErrorStateMeasurement {
        cable: Ekf4Measurement {
            attitude,
            accel: Body(accel),
            thrust,
            altitude: Some(3.5),
            length: None,
        },
        gyro: Body(V3::zeros()),
    }
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut words = std::env::args().skip(1);
    let filter = words.next().unwrap_or_else(|| "ukf".into());
    let steps: u32 = words.next().map_or(Ok(1000), |text| text.parse())?;
    let z = reading();
    match filter.as_str() {
        "none" => {
            for _ in 0..steps {
                black_box(&z);
            }
        }
        "ukf" => {
            let ukf = TetherAngleUkf::try_new(0.0125_f32)?;
            let model = TetherAngleModel::try_new(16.0, 5.0)?;
            let tilt = model.equilibrium_tilt(0.6).ok_or("too weak")?;
            let x = TetherAngle { angle: 0.6, rate: 0.0, tilt };
            let [ax, az] = model.specific_force(&x, model.tension(&x, [0.0; 2]));
            let mut state = TetherAngleState::at(x);
            for _ in 0..steps {
                ukf.step(&model, &mut state, black_box(&TiltImu { x: ax, z: az, rate: 0.0 }));
            }
            println!("tether angle {:.2} deg", state.posterior.x.angle.to_degrees());
        }
        "ekf4" => {
            let ekf = article_ekf(MASS, NoiseReading::PerStep, false);
            let mut state = article_start(None);
            for _ in 0..steps {
                ekf.step(&mut state, black_box(&z.cable)).map_err(|fault| format!("{fault:?}"))?;
            }
            println!("position {:?}, tension {:.2} N", state.position(), state.tension());
        }
        "error-state" => {
            let noise = ErrorStateNoise::simulated();
            let filter = ErrorStateFilter { mass: MASS, dt: 0.004, noise };
            let mut start = ErrorStateStart::default();
            let mut state = None;
            while state.is_none() {
                state = start.step(MASS, noise.accel, &z);
            }
            let mut state = state.ok_or("no start")?;
            for _ in 0..steps {
                let step =
                    filter.correct(&mut state, black_box(&z)).map_err(|f| format!("{f:?}"))?;
                filter.predict(&mut state, &z, &step);
            }
            println!("position {:?}, tension {:.2} N", state.position.0, state.tension);
        }
        other => return Err(format!("{other}: none, ukf, ekf4 or error-state").into()),
    }
    Ok(())
}
