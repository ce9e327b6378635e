//! Counts of a line's own sensors to directions, newtons and microteslas, within what is possible. A sensor that falls
//! silent is forgotten; one that was never heard costs a comparison.

use super::calibrate::Calibration;
use super::check::{ImuCheck, ImuCheckState};
use super::mount::Mounting;
use crate::frames::{Body, V3, World};
use crate::math::so3;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Imu, LineSensors, RawAngles, RawFairlead, RawImu, RawLineSensors};
use crate::time::{Micros, Sample};

/// Older than this it is not what the sensor says, µs.
const TIMEOUT_US: u64 = 500_000;
/// rad per count of an encoder of 12 bits.
const RAD_PER_COUNT: f32 = core::f32::consts::TAU / 4096.0;
/// A line does not leave further to the side than this, rad: the encoder's arm has a stop there.
const ANGLE_MOST: f32 = 1.6;
/// No load cell here reads more, N; nor less, but for its offset.
const TENSION_MOST: f32 = 2_000.0;
const TENSION_LEAST: f32 = -20.0;
/// µT per count; a field in T would be nothing in fixed point.
const MICROTESLA_PER_COUNT: f32 = 0.3;
/// Earth's field lies between, µT.
const FIELD: (f32, f32) = (10.0, 120.0);
/// Sensors that may fall silent.
const SENSORS: usize = 6;

/// Calibration.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineSense<S: Scalar> {
    angle_zero: [f32; 2],
    angle_sign: [f32; 2],
    newton_per_count: f32,
    tension_zero: f32,
    field_zero: [f32; 3],
    field_scale: [f32; 3],
    /// µT per A of the current.
    field_per_ampere: [f32; 3],
    fairlead_zero: [f32; 2],
    calibration: Calibration<S>,
    check: ImuCheck,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineState<S: Scalar> {
    known: LineSensors<S>,
    /// In the order of [`LineSensors`].
    heard: [Micros; SENSORS],
    second: ImuCheckState,
    /// Something was ever heard.
    is_used: bool,
}

/// PX4's units of a magnetometer's calibration, µT and µT/A.
const GAUSS: f32 = 100.0;
const GAUSS_PER_KILOAMPERE: f32 = 0.1;

impl<S: Scalar> LineSense<S> {
    pub fn new(p: &Params, calibration: Calibration<S>, check: ImuCheck) -> Self {
        Self {
            angle_zero: [p.line_angle_zero_x, p.line_angle_zero_y],
            angle_sign: [p.line_angle_sign_x, p.line_angle_sign_y],
            newton_per_count: p.line_cell_scale,
            tension_zero: p.line_cell_zero,
            field_zero: [p.mag_bias_x, p.mag_bias_y, p.mag_bias_z].map(|x| x * GAUSS),
            field_scale: [p.mag_scale_x, p.mag_scale_y, p.mag_scale_z],
            field_per_ampere: [p.mag_current_x, p.mag_current_y, p.mag_current_z]
                .map(|x| x * GAUSS_PER_KILOAMPERE),
            fairlead_zero: [p.station_azimuth_zero, p.station_elevation_zero],
            calibration,
            check,
        }
    }

    /// One step; `current`: what the vehicle draws, A.
    pub fn step(
        &self,
        state: &mut LineState<S>,
        now: Micros,
        raw: &RawLineSensors,
        mounting: &Mounting,
        current: f32,
    ) -> LineSensors<S> {
        if !state.is_used && raw.is_empty() {
            return LineSensors::default();
        }
        state.is_used = true;
        let heard = &mut state.heard;
        let known = &mut state.known;
        let [direction, tension, station_tension, station_direction, magnetic, second] = heard;
        keep(&mut known.direction, direction, now, raw.angles.and_then(|raw| self.direction(raw)));
        let newtons = |raw: crate::signal::RawTension| {
            plausible((raw.counts as f32 - self.tension_zero) * self.newton_per_count)
        };
        let is_calibrated = self.newton_per_count != 0.0;
        let cell = raw.tension.filter(|_| is_calibrated).and_then(newtons);
        keep(&mut known.tension, tension, now, cell);
        let at_station = raw.station_tension.and_then(plausible);
        keep(&mut known.station_tension, station_tension, now, at_station);
        let leaves = raw.fairlead.and_then(|raw| self.station_direction(raw));
        keep(&mut known.station_direction, station_direction, now, leaves);
        let field = raw.magnetometer.and_then(|raw| self.field(raw.counts, mounting, current));
        keep(&mut known.magnetic, magnetic, now, field);
        let imu = raw.second_imu.and_then(|value| {
            let sample = Sample { at: now, value };
            let fresh = self.check.step(&mut state.second, now, Some(&sample))?;
            Some(self.imu(&fresh.value, mounting))
        });
        keep(&mut known.second_imu, second, now, imu);
        *known
    }

    /// From the two angles: the line hangs straight down where both are at their zero.
    fn direction(&self, raw: RawAngles) -> Option<Body<V3<S>>> {
        let ([outer, inner], [zero_x, zero_y]) = (raw.counts, self.angle_zero);
        let [sign_x, sign_y] = self.angle_sign;
        let angle = |counts: u16, zero: f32, sign: f32| {
            let turned = crate::math::wrap_pi(f32::from(counts) * RAD_PER_COUNT - zero);
            (turned.abs() <= ANGLE_MOST).then(|| S::from_f32(turned * sign).sin_cos())
        };
        let (sx, cx) = angle(outer?, zero_x, sign_x)?;
        let (sy, cy) = angle(inner?, zero_y, sign_y)?;
        Some(Body(V3::new(sy, -sx * cy, cx * cy)))
    }

    fn station_direction(&self, raw: RawFairlead) -> Option<World<V3<S>>> {
        let [azimuth_zero, elevation_zero] = self.fairlead_zero;
        let (azimuth, elevation) = (raw.azimuth - azimuth_zero, raw.elevation - elevation_zero);
        let is_possible = azimuth.abs() < 100.0 && elevation.abs() <= ANGLE_MOST;
        is_possible.then(|| {
            let (sa, ca) = S::from_f32(azimuth).sin_cos();
            let (se, ce) = S::from_f32(elevation).sin_cos();
            World(V3::new(ca * ce, sa * ce, -se))
        })
    }

    fn field(&self, counts: [i16; 3], mounting: &Mounting, current: f32) -> Option<Body<V3<S>>> {
        let mut field = mounting.to_body(counts).map(|n| n as f32 * MICROTESLA_PER_COUNT);
        let calibration = self.field_zero.iter().zip(&self.field_scale).zip(&self.field_per_ampere);
        for (x, ((zero, scale), per_ampere)) in field.iter_mut().zip(calibration) {
            *x = (*x - zero - per_ampere * current) * scale;
        }
        let size = so3::norm(&V3::from(field));
        (FIELD.0..=FIELD.1).contains(&size).then(|| Body(V3::from(field.map(S::from_f32))))
    }

    fn imu(&self, raw: &RawImu, mounting: &Mounting) -> Imu<S> {
        Imu {
            gyro: Body(self.calibration.gyro(mounting.to_body(raw.gyro))),
            accel: Body(self.calibration.accel(mounting.to_body(raw.accel))),
        }
    }
}

fn plausible<S: Scalar>(newtons: f32) -> Option<S> {
    (TENSION_LEAST..=TENSION_MOST).contains(&newtons).then(|| S::from_f32(newtons))
}

/// Takes what is new; forgets what is too old.
fn keep<T>(known: &mut Option<T>, heard: &mut Micros, now: Micros, new: Option<T>) {
    if new.is_some() {
        (*known, *heard) = (new, now);
    } else if now.since(*heard) > TIMEOUT_US {
        *known = None;
    }
}
