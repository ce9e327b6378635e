//! How sensitive is one reading? `inertial` section 3, the paper's Figs. 3 to 5.

use super::plant::{Plane, PlaneModel};
use crate::plant::{generator, normal};
use tautline_firmware::estimate::tether_angle::{TENSION_FLOOR, locate};
use tautline_firmware::math::wrap_pi;
use tautline_firmware::model::TetherAngleModel;

/// One point of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// True tether angle, rad.
    pub angle: f64,
    /// Thrust over mass that acts, and nominal, m/s².
    pub thrust: [f64; 2],
    /// White noise on each axis, m/s².
    pub noise: f64,
    /// m.
    pub length: f64,
    /// True tether rate, rad/s, which the minimal form ignores.
    pub rate: f64,
}

/// Errors of the samples that give an answer, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensitivity {
    /// Share of the samples that give one.
    pub valid: f64,
    /// Mean and deviation of the tether angle's error.
    pub angle: [f64; 2],
    /// Mean and deviation of the tilt's error.
    pub tilt: [f64; 2],
}

/// Draws `samples` readings about the equilibrium at the nominal thrust.
///
/// # Errors
/// A thrust that is not positive.
pub fn sensitivity(s: &Setting, samples: u32, seed: u64) -> Result<Sensitivity, String> {
    let [acting, nominal] = s.thrust;
    let model = TetherAngleModel::try_new(nominal, s.length).map_err(|e| e.to_string())?;
    let plant =
        |thrust| PlaneModel { length: s.length, thrust, attachment: 0.0, mass_over_inertia: 1.0 };
    // It hangs as the acting thrust lets it.
    let mut plane = Plane::at_rest(&plant(acting), s.angle);
    plane.tension += s.length * s.rate * s.rate;
    let [tilt, ..] = plane.attitude;
    let force = plane.accel(&plant(acting));
    let mut rng = generator(seed, 32);
    let (mut count, mut sums, mut squares) = (0_u32, [0.0; 2], [0.0; 2]);
    for _ in 0..samples {
        let reading = force.map(|a| a + s.noise * normal(&mut rng));
        let Ok(found) = locate(&model, reading, 0.0, tilt, TENSION_FLOOR) else { continue };
        count += 1;
        let errors = [wrap_pi(found.angle - s.angle), wrap_pi(found.tilt - tilt)];
        for ((sum, square), e) in sums.iter_mut().zip(&mut squares).zip(errors) {
            *sum += e;
            *square += e * e;
        }
    }
    let n = f64::from(count.max(1));
    let spread = |i: usize| {
        let mean = sums[i] / n;
        [mean, (squares[i] / n - mean * mean).max(0.0).sqrt()]
    };
    Ok(Sensitivity {
        valid: f64::from(count) / f64::from(samples.max(1)),
        angle: spread(0),
        tilt: spread(1),
    })
}
