//! The flying inverted pendulum's filter and law, step by step, without a vehicle around them.
//!
//! `cargo run --release -p tautline-firmware --example pendulum_step -- BLOCK STEPS`, with BLOCK one of
//! `none`, `predict`, `filter` (prediction and four scalar updates), `observer` (filter, vertical
//! disturbance, load velocity), `law`, `reference`, `both` (observer, reference and law). Under `valgrind
//! --tool=callgrind`, the difference between two counts is the cost of a step; `none` is the loop around it.

use core::hint::black_box;
use tautline_firmware::control::pendulum::{
    PendulumControl, PendulumGains, PendulumLimits, PendulumMemory,
};
use tautline_firmware::estimate::pendulum::{
    PendulumFilter, PendulumNoise, PendulumObserver, PendulumReading, VerticalDisturbance,
};
use tautline_firmware::frames::{Attitude, V3, World};
use tautline_firmware::model::PendulumModel;
use tautline_firmware::trajectory::load::TiltedCircle;

const DT: f32 = 0.01;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let mut words = std::env::args().skip(1);
    let block = words.next().unwrap_or_else(|| "both".into());
    let steps: u32 = words.next().map_or(Ok(1000), |text| text.parse())?;
    let model = PendulumModel::try_new(0.26_f32, 0.03, 0.7)?;
    let filter = PendulumFilter { model, noise: PendulumNoise::recommended() };
    let vertical = Some(VerticalDisturbance { bandwidth: 3.0 });
    let observer = PendulumObserver { filter, vertical };
    let limits = PendulumLimits::standard(&model);
    let control = PendulumControl::try_new(PendulumGains::robust(), model, limits)?;
    let circle = TiltedCircle::article(0.5_f32);
    let attitude = Attitude::from_euler(0.02, -0.03, 0.3);
    let rod = V3::new(0.03, -0.02, -1.0);
    let z = PendulumReading {
        rod: Some(World(rod)),
        rod_period: DT,
        position: World(V3::new(0.8, 0.0, -0.9)),
        velocity: World(V3::new(0.0, 0.5, 0.2)),
        down: World(attitude.0.column(2).into_owned()),
        thrust: 2.8,
    };
    let force = V3::new(0.1, 0.0, -2.8);
    let (mut state, first) = observer.start(&z).ok_or("no direction")?;
    let mut memory = PendulumMemory::default();
    let mut angle = 0.0;
    let fault = |fault| format!("{fault:?}");
    match block.as_str() {
        "none" => {
            for _ in 0..steps {
                black_box(&z);
            }
        }
        "predict" => {
            for _ in 0..steps {
                filter.predict(&mut state.posterior, black_box(&rod), black_box(&force), DT);
            }
        }
        "filter" => {
            for _ in 0..steps {
                filter.predict(&mut state.posterior, black_box(&rod), black_box(&force), DT);
                filter.update(&mut state.posterior, black_box(&rod), DT);
            }
        }
        "observer" => {
            for _ in 0..steps {
                observer.step(&mut state, black_box(&z), DT).map_err(fault)?;
            }
        }
        "law" => {
            let reference = circle.at(0.3);
            for _ in 0..steps {
                let (x, reference) = (black_box(&first), black_box(&reference));
                let command = control.step(&mut memory, x, &attitude, reference);
                black_box(command.map_err(fault)?);
            }
        }
        "reference" => {
            for _ in 0..steps {
                angle = circle.advance(black_box(angle), DT);
                black_box(circle.at(angle));
            }
        }
        "both" => {
            for _ in 0..steps {
                let x = observer.step(&mut state, black_box(&z), DT).map_err(fault)?;
                angle = circle.advance(angle, DT);
                let command = control.step(&mut memory, &x, &attitude, &circle.at(angle));
                black_box(command.map_err(fault)?);
            }
        }
        other => {
            let known = "none, predict, filter, observer, law, reference or both";
            return Err(format!("{other}: {known}").into());
        }
    }
    println!("rod rate {:?} rad/s", state.posterior.rate);
    Ok(())
}
