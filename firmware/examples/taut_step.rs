//! Observer and force controller on a taut link, step by step, without any vehicle around them.
//!
//! `cargo run --release -p tautline-firmware --example taut_step -- 10000` runs so many steps. Under
//! `valgrind --tool=callgrind`, the difference between two counts is the cost of a step.

use tautline_firmware::control::taut::{
    ElevationForce, Inversion, Law, PlanarInput, PlanarLoop, PlanarLoopSettings,
};
use tautline_firmware::estimate::high_gain::{Branches, HighGain, HighGainSettings};
use tautline_firmware::model::{PlanarModel, PlanarState};
use tautline_firmware::signal::PlanarReference;
use tautline_firmware::trajectory::ThrustBranch;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let steps: u32 = std::env::args().nth(1).map_or(Ok(1000), |text| text.parse())?;
    let period = 0.004;
    let model = PlanarModel::try_new(1.2_f32, 0.012, 5.0, 9.81)?;
    let observer = HighGain::try_new(HighGainSettings {
        epsilon: 2.0,
        branches: Branches::One,
        sign_is_continuous: false,
        ..HighGainSettings::new(model, period)
    })?;
    let window = Inversion::Window { threshold: 0.5, damping: 0.2 };
    let law = ElevationForce::try_new(model, &[-1.5, -2.25, -3.0, -3.75], &[-1.5, -2.25], window)?;
    let settings = PlanarLoopSettings { motor_lag: 0.0, hold_off: 0.0, limits: None };
    let pilot = PlanarLoop::try_new(observer, Law::Force(law), settings)?;

    // Hold 45 degrees and 6 N, starting 3 degrees lower.
    let reference = PlanarReference {
        elevation: [core::f32::consts::FRAC_PI_4, 0.0, 0.0, 0.0, 0.0],
        second: [6.0, 0.0, 0.0],
    };
    let start = model.flat_force(&reference.elevation, &reference.second, ThrustBranch::Positive);
    let (start, _) = start.map_err(|fault| format!("{fault:?}"))?;
    let mut x = PlanarState { elevation: start.state.elevation - 0.05, ..start.state };
    let mut state = pilot.start(&model.imu(&x, start.thrust), start.thrust);
    let mut thrust = start.thrust;
    for _ in 0..steps {
        let input = PlanarInput { imu: model.imu(&x, thrust), acting: None, state: None };
        let command =
            pilot.step(&mut state, &input, &reference).map_err(|fault| format!("{fault:?}"))?;
        thrust = command.thrust;
        // A stand-in for a vehicle: one Euler step of the same model.
        let d = model.derivative(&x, thrust, command.torque);
        let h = period as f32;
        x.elevation += h * x.elevation_rate;
        x.elevation_rate += h * d.elevation_rate;
        x.pitch += h * x.pitch_rate;
        x.pitch_rate += h * d.pitch_rate;
    }
    println!(
        "after {:.1} s: elevation {:.2} deg, link force {:.2} N",
        f64::from(steps) * period,
        x.elevation.to_degrees(),
        model.link_force(&x, thrust)
    );
    Ok(())
}
