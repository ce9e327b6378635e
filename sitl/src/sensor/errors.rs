//! What a sensor feels beyond the truth: noise, bias and its drift, vibration, temperature.

use crate::plant::{Plant, V3, normal, uniform};
use crate::scenario::SensorSection;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// Bandwidth of the part's anti-alias filter, Hz; the noise of a sample follows from it.
const BANDWIDTH: f64 = 258.0;
const DT: f64 = 1e-3;
/// Rotor speed at which the vibration of the scenario holds, rad/s.
const HOVER_SPEED: f64 = 500.0;
/// Shares of the vibration: once per turn, twice per turn, broad band.
const ONCE: f64 = 0.5;
const TWICE: f64 = 0.35;
const BROAD: f64 = 0.79;
/// Lag of the third axis, rad: 1 once, 2 twice per turn.
const SIN_1: f64 = 0.841_470_984_807_896_5;
const COS_1: f64 = 0.540_302_305_868_139_8;
const SIN_2: f64 = 2.0 * SIN_1 * COS_1;
const COS_2: f64 = 1.0 - 2.0 * SIN_1 * SIN_1;
/// Bias over temperature.
const GYRO_PER_KELVIN: f64 = 8.7e-5;
const ACCEL_PER_KELVIN: f64 = 1.5e-3;
/// Die temperature at the start, °C, and the time constant of its warming up, s.
const START_TEMPERATURE: f64 = 25.0;
const WARM_UP_TIME: f64 = 120.0;

/// Biases wander in steps of so many samples.
const DRIFT_SAMPLES: u32 = 20;

/// Inertial errors.
#[derive(Clone, Debug)]
pub struct Inertial {
    gyro_bias: V3,
    accel_bias: V3,
    gyro_drift: V3,
    accel_drift: V3,
    phase: [f64; 4],
    temperature: f64,
    samples: u32,
}

/// Three draws.
#[inline]
pub fn vector(rng: &mut Pcg64Mcg, mut draw: impl FnMut(&mut Pcg64Mcg) -> f64) -> V3 {
    let x = draw(rng);
    let y = draw(rng);
    V3::new(x, y, draw(rng))
}

impl Inertial {
    pub fn new(model: &SensorSection, rng: &mut Pcg64Mcg) -> Self {
        Self {
            gyro_bias: vector(rng, uniform) * model.gyro_bias,
            accel_bias: vector(rng, uniform) * model.accel_bias,
            gyro_drift: V3::zeros(),
            accel_drift: V3::zeros(),
            phase: std::array::from_fn(|_| uniform(rng) * TAU),
            temperature: START_TEMPERATURE,
            samples: 0,
        }
    }

    /// Specific force, rate (body axes) and die temperature, as the part feels them.
    pub fn sample(
        &mut self,
        model: &SensorSection,
        plant: &Plant,
        rng: &mut Pcg64Mcg,
    ) -> (V3, V3, f64) {
        self.samples = self.samples.wrapping_add(1);
        if self.samples.is_multiple_of(DRIFT_SAMPLES) {
            let dt = f64::from(DRIFT_SAMPLES) * DT;
            let (walk, left) = (dt.sqrt(), 1.0 - dt / model.drift_time);
            let gyro = vector(rng, normal) * (model.gyro_drift * walk);
            self.gyro_drift = self.gyro_drift * left + gyro;
            let accel = vector(rng, normal) * (model.accel_drift * walk);
            self.accel_drift = self.accel_drift * left + accel;
        }
        self.temperature +=
            (START_TEMPERATURE + model.warm_up - self.temperature) * DT / WARM_UP_TIME;
        let warm = self.temperature - START_TEMPERATURE;

        let vibration = self.vibration(plant, rng) * model.vibration;
        let width = BANDWIDTH.sqrt();
        let accel = plant.specific_force
            + self.accel_bias
            + self.accel_drift
            + V3::repeat(ACCEL_PER_KELVIN * warm)
            + vibration
            + vector(rng, normal) * (model.accel_noise_density * width);
        let gyro = plant.body.rate
            + self.gyro_bias
            + self.gyro_drift
            + V3::repeat(GYRO_PER_KELVIN * warm)
            + V3::new(vibration.y, -vibration.x, vibration.z) * model.gyro_vibration_ratio
            + vector(rng, normal) * (model.gyro_noise_density * width);
        (accel, gyro, self.temperature)
    }

    /// Unit rms per axis at hover.
    fn vibration(&mut self, plant: &Plant, rng: &mut Pcg64Mcg) -> V3 {
        let mut vibration = V3::zeros();
        let mut strength = 0.0;
        for (phase, rotor) in self.phase.iter_mut().zip(&plant.rotors) {
            *phase += rotor.speed * DT;
            if *phase >= TAU {
                *phase %= TAU;
            }
            let size = (rotor.speed / HOVER_SPEED).powi(2);
            strength += 0.25 * size;
            // Single precision is a thousand times finer than the sensor's counts, and half as dear.
            let (sin, cos) = (*phase as f32).sin_cos();
            let (sin, cos) = (f64::from(sin), f64::from(cos));
            // Once and twice per turn at 0, 1 and 0, 2 rad of lag, by the sums of angles.
            let (sin_2, cos_2) = (2.0 * sin * cos, cos * cos - sin * sin);
            let once = V3::new(sin, cos, sin * COS_1 + cos * SIN_1);
            let twice = V3::new(cos_2, sin_2, cos_2 * COS_2 - sin_2 * SIN_2);
            // Four sines of equal size: each carries half of the rms in every axis.
            let amplitude = size * std::f64::consts::SQRT_2 * 0.5;
            vibration += once * (ONCE * amplitude) + twice * (TWICE * amplitude);
        }
        vibration + vector(rng, normal) * (BROAD * strength)
    }
}

/// Altimeter errors.
#[derive(Clone, Debug, Default)]
pub struct Altitude {
    pressure_drift: f64,
}

impl Altitude {
    /// Pa at this height over the ground.
    pub fn pressure(
        &mut self,
        model: &SensorSection,
        height: f64,
        dt: f64,
        rng: &mut Pcg64Mcg,
    ) -> f64 {
        self.pressure_drift += model.pressure_drift * dt.sqrt() * normal(rng);
        let truth = 101_325.0 * (1.0 - 2.255_77e-5 * height).powf(5.255_88);
        truth + self.pressure_drift + model.pressure_noise * normal(rng)
    }

    /// m along the body's down axis to the flat ground; beyond every range when looking up.
    pub fn range(
        &mut self,
        model: &SensorSection,
        plant: &Plant,
        offset: f64,
        rng: &mut Pcg64Mcg,
    ) -> f64 {
        let down = plant.body.attitude * V3::z();
        if down.z < 0.05 {
            return f64::INFINITY;
        }
        let sensor = plant.height_over_ground() - offset * down.z;
        self.measured_range(model, sensor / down.z, rng)
    }

    /// m, of a true distance.
    pub fn measured_range(&mut self, model: &SensorSection, slant: f64, rng: &mut Pcg64Mcg) -> f64 {
        let relative = if slant > 6.0 { 0.003 * slant } else { 0.0 };
        slant + (model.range_noise + relative) * normal(rng)
    }
}
