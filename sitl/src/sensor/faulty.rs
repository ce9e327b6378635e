//! What a fault makes of inertial samples and of the winch's encoder.

use crate::plant::{Generator, Plant, V3, generator, uniform};
use crate::scenario::{FaultKind, Faults};
use std::f64::consts::TAU;
use tautline_firmware::signal::RawTether;

/// Far beyond the range of any part.
const BEYOND: f64 = 1e6;
const DT: f64 = 1e-3;
/// Rotor speed for which a vibration is given, rad/s.
const HOVER_SPEED: f64 = 500.0;

/// Whether an inertial sample comes this millisecond, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// No data-ready.
    Never,
    /// Read.
    Comes {
        /// The part has not refreshed its registers.
        repeats: bool,
        /// Its time is so much too early, µs.
        early_us: u64,
    },
}

/// What only faults draw for the inertial sensor.
#[derive(Clone, Debug)]
pub struct InertialFault {
    rng: Generator,
    /// Of a sample, that is due at a wrong rate.
    due: f64,
    phase: [f64; 8],
}

impl InertialFault {
    pub fn new(seed: u64) -> Self {
        Self { rng: generator(seed, 7), due: 0.0, phase: [0.0; 8] }
    }

    /// Of this millisecond's sample.
    pub fn arrival(&mut self, faults: &Faults, time: f64) -> Arrival {
        if faults.is_active(FaultKind::ImuSilent, time) {
            return Arrival::Never;
        }
        if let Some(rate) = faults.value(FaultKind::ImuRate, time) {
            self.due += rate * DT;
            if self.due < 1.0 {
                return Arrival::Never;
            }
            self.due -= 1.0;
        }
        let dropped = faults.added(FaultKind::ImuDrop, time);
        if dropped > 0.0 && self.share() < dropped {
            return Arrival::Never;
        }
        let repeated = faults.value(FaultKind::ImuRepeat, time);
        let repeated = repeated.map_or(0.0, |share| if share > 0.0 { share } else { 1.0 });
        let jitter = faults.added(FaultKind::ImuJitter, time);
        Arrival::Comes {
            repeats: repeated > 0.0 && self.share() < repeated,
            early_us: if jitter > 0.0 { (self.share() * jitter * 1e6) as u64 } else { 0 },
        }
    }

    fn share(&mut self) -> f64 {
        0.5 * (1.0 + uniform(&mut self.rng))
    }

    /// Specific force and rate as the part feels them, body axes.
    pub fn disturb(
        &mut self,
        faults: &Faults,
        time: f64,
        plant: &Plant,
        accel: &mut V3,
        gyro: &mut V3,
    ) {
        if faults.is_empty() {
            return;
        }
        let scaled = |kind| faults.on_axes(kind, time).add_scalar(1.0);
        *accel = accel.component_mul(&scaled(FaultKind::AccelScale));
        *gyro = gyro.component_mul(&scaled(FaultKind::GyroScale));
        *accel += faults.on_axes(FaultKind::AccelBias, time);
        *gyro += faults.on_axes(FaultKind::GyroBias, time);
        let strength = faults.added(FaultKind::Vibration, time);
        for (i, (rotor, phase)) in plant.rotors.iter().zip(&mut self.phase).enumerate() {
            let imbalance = faults.on_motor(FaultKind::RotorImbalance, time, i).unwrap_or(0.0);
            *phase = (*phase + rotor.speed * DT) % TAU;
            let size = (rotor.speed / HOVER_SPEED).powi(2);
            let (sin, cos) = phase.sin_cos();
            // Four rotors of equal size, each axis with half the square of the amplitude.
            let each = strength * std::f64::consts::SQRT_2 * 0.5;
            *accel += V3::new(sin, cos, sin) * (each * size);
            *accel += V3::new(sin, cos, 0.0) * (imbalance * size);
        }
        let clip = |kind, v: &mut V3| {
            let limit = faults.value(kind, time).unwrap_or(0.0);
            for (x, clips) in v.iter_mut().zip(faults.axes(kind, time)) {
                if clips {
                    *x = if limit > 0.0 { x.clamp(-limit, limit) } else { BEYOND };
                }
            }
        };
        clip(FaultKind::AccelClip, accel);
        clip(FaultKind::GyroClipped, gyro);
    }
}

/// How far the encoder of the winch is off by faults.
#[derive(Clone, Copy, Debug, Default)]
pub struct EncoderFault {
    /// Of what has slipped, m.
    slipped: f64,
    last: f64,
    stuck_at: Option<RawTether>,
}

impl EncoderFault {
    /// What it shows over the `length` m that are out, m.
    pub fn error(&mut self, length: f64, faults: &Faults, time: f64) -> f64 {
        self.slipped -= faults.added(FaultKind::EncoderSlip, time) * (length - self.last);
        self.last = length;
        self.slipped + faults.added(FaultKind::EncoderOffset, time)
    }

    /// What a wheel shows that may not turn any more: the same to the last bit.
    pub fn hold(&mut self, shown: RawTether, faults: &Faults, time: f64) -> RawTether {
        let is_stuck = faults.is_active(FaultKind::EncoderStuck, time);
        self.stuck_at = is_stuck.then(|| self.stuck_at.unwrap_or(shown));
        self.stuck_at.unwrap_or(shown)
    }
}
