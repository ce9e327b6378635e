//! How high is the centre of mass over the anchor's ground?
//!
//! The rangefinder where it sees the ground, the barometer where not, and neither alone: each is compared with inertia,
//! and both with one another. The one whose movement inertia contradicts is not used, until the two agree again; when
//! inertia cannot tell, it is the barometer, since the rangefinder sees the ground on which one lands. The barometer's
//! zero follows the rangefinder slowly and only while they agree, off the ground's cushion of air.

use super::RawSensors;
use crate::estimate::Witness;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{AltimeterReport, RawBarometer, RawRange};
use crate::time::{DECIMATION, Micros, Sample};

/// The rangefinder must have been silent this long before the barometer takes over.
const RANGE_HOLD_US: u64 = 300_000;
/// Air column: R T / (g M) at 288 K, m.
const SCALE_HEIGHT: f64 = 8_434.7;
/// The barometer's zero follows in this time, s: on the ground, and in flight.
const ZERO_TIME_RESTING: f64 = 0.5;
const ZERO_TIME: f64 = 30.0;
/// Below this height over the ground the rotors press on the barometer, m.
const CUSHION: f64 = 1.5;
/// One reading so far from what inertia expects is not taken, m, for so long, s.
const JUMP: f64 = 0.7;
const JUMP_TIME: f64 = 0.3;
/// The two contradict one another, m, for so long, s.
const APART: f64 = 0.8;
const APART_TIME: f64 = 0.3;
/// They agree again, m, for so long, s.
const TOGETHER: f64 = 0.4;
const TOGETHER_TIME: f64 = 3.0;
/// Inertia accuses the rangefinder: at least this error, m, and so many times the barometer's.
const ACCUSED: f64 = 0.2;
const WORSE: f64 = 1.5;
/// An altimeter that is off by so much on the mean is noise, m.
const ROUGH: f64 = 0.6;
/// A rangefinder in flight that shows the same to the centimetre for so long is stuck, s.
const STUCK_TIME: f64 = 1.5;
/// A barometer that is not used starts again from the rangefinder after so long, s.
const FORGIVEN: f64 = 20.0;

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct Altimeter<S> {
    offset: S,
    range_max: S,
    ground_height: S,
    timeout_us: u64,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct AltimeterState<S: Scalar> {
    /// Since the observers went on.
    steps: u8,
    pressure_zero: Option<i32>,
    baro_offset: S,
    ranged: Option<Sample<S>>,
    barometric: Option<Sample<S>>,
    any_at: Option<Micros>,
    is_ranged: bool,
    range: Witness<S>,
    baro: Witness<S>,
    /// The last distance, cm, and since when it is the same, s.
    shown: u16,
    same: S,
    jumping: S,
    apart: S,
    together: S,
    report: AltimeterReport,
    /// How far inertia is from what the altimeters show, m.
    error: S,
}

/// What is known beside the altimeters.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S> {
    /// Of the last attitude.
    pub cos_tilt: S,
    /// By the accelerometer, m/s².
    pub accel_up: S,
    /// Nothing moves it: it stands.
    pub rests: bool,
}

impl<S: Scalar> Altimeter<S> {
    pub fn new(params: &Params) -> Self {
        Self {
            offset: S::from_f32(params.range_offset),
            range_max: S::from_f32(params.range_max),
            ground_height: S::from_f32(params.ground_height),
            timeout_us: (params.altimeter_timeout * 1e6) as u64,
        }
    }

    /// The altitude, if one arrived in this step of `dt` s.
    pub fn step(
        &self,
        state: &mut AltimeterState<S>,
        raw: &RawSensors,
        motion: &Motion<S>,
        dt: S,
    ) -> Option<Sample<S>> {
        // The acceleration is new at every fourth step.
        state.steps = (state.steps + 1) % DECIMATION;
        if !motion.rests && state.steps == 0 {
            let dt = dt * S::lit(f64::from(DECIMATION));
            state.range.predict(motion.accel_up, dt);
            state.baro.predict(motion.accel_up, dt);
            state.error = state.error_now();
        }
        let ranged = raw.range.and_then(|sample| self.ranged(state, &sample, motion));
        let baro = raw.barometer.and_then(|sample| self.barometric(state, &sample, motion));
        let best = ranged.or(baro);
        if let Some(sample) = best {
            state.any_at = Some(sample.at);
            state.is_ranged = ranged.is_some();
        }
        best
    }

    /// The rangefinder's altitude, unless it is not believed.
    fn ranged(
        &self,
        state: &mut AltimeterState<S>,
        sample: &Sample<RawRange>,
        motion: &Motion<S>,
    ) -> Option<Sample<S>> {
        let shown = sample.value.distance_cm?;
        let distance = S::from_f32(f32::from(shown) * 0.01);
        if distance > self.range_max || motion.cos_tilt <= S::lit(0.5) {
            return None;
        }
        let altitude = (distance + self.offset) * motion.cos_tilt;
        let dt = age(state.ranged, sample.at);
        let seen = Sample { at: sample.at, value: altitude };
        state.ranged = Some(seen);
        let is_same = core::mem::replace(&mut state.shown, shown) == shown && !motion.rests;
        state.same = if is_same { (state.same + dt).min(S::lit(60.0)) } else { S::zero() };
        if motion.rests {
            state.range.stand(altitude);
            state.report.range_is_rejected = false;
        }
        let error = state.range.error_of(altitude);
        state.range.take(altitude, dt);
        if error.abs() > S::lit(JUMP) && !motion.rests {
            state.jumping += dt;
        } else {
            state.jumping = S::zero();
        }
        self.compare(state, sample.at, dt, motion);
        let is_pending = state.jumping > S::zero() && state.jumping < S::lit(JUMP_TIME);
        let can_wait = fresh(state.barometric, sample.at).is_some();
        let is_doubted = state.report.range_is_rejected || is_pending;
        (!(is_doubted && can_wait)).then_some(seen)
    }

    /// The barometer's altitude, where the rangefinder has none that is believed.
    fn barometric(
        &self,
        state: &mut AltimeterState<S>,
        sample: &Sample<RawBarometer>,
        motion: &Motion<S>,
    ) -> Option<Sample<S>> {
        let relative =
            relative_height::<S>(&mut state.pressure_zero, sample.value.pressure_centipascal)?;
        let dt = age(state.barometric, sample.at);
        let range = fresh(state.ranged, sample.at);
        let altitude = self.ground_height + relative + state.baro_offset;
        let report = &mut state.report;
        if motion.rests {
            report.baro_is_rejected = false;
        }
        let is_low = range.is_some_and(|r| r.value < self.ground_height + S::lit(CUSHION));
        let agrees = !report.range_is_rejected && !report.baro_is_rejected;
        if let Some(range) = range.filter(|_| motion.rests || (agrees && !is_low)) {
            let time = if motion.rests { ZERO_TIME_RESTING } else { ZERO_TIME };
            let by = (range.value - altitude) * (dt * S::lit(1.0 / time)).min(S::one());
            state.baro_offset += by;
            state.baro.shift_quietly(by);
        }
        let altitude = self.ground_height + relative + state.baro_offset;
        if motion.rests {
            state.baro.stand(altitude);
        }
        state.baro.take(altitude, dt);
        let seen = Sample { at: sample.at, value: altitude };
        state.barometric = Some(seen);
        let is_needed = range.is_none() || report.range_is_rejected || state.jumping > S::zero();
        is_needed.then_some(seen)
    }

    /// Who of the two is wrong, if they contradict one another.
    fn compare(&self, state: &mut AltimeterState<S>, now: Micros, dt: S, motion: &Motion<S>) {
        let Some(baro) = fresh(state.barometric, now) else {
            // Nobody contradicts it.
            state.report.range_is_rejected = false;
            (state.apart, state.together) = (S::zero(), S::zero());
            return;
        };
        let Some(range) = state.ranged else { return };
        let difference = range.value - baro.value;
        let is_low = range.value.min(baro.value) < self.ground_height + S::lit(CUSHION);
        let margin = if is_low { S::lit(2.0 * APART) } else { S::lit(APART) };
        let count = |timer: &mut S, holds: bool| {
            *timer = if holds { (*timer + dt).min(S::lit(60.0)) } else { S::zero() };
        };
        let is_apart = difference.abs() > margin && !motion.rests;
        count(&mut state.apart, is_apart);
        count(&mut state.together, difference.abs() < S::lit(TOGETHER));
        let report = &mut state.report;
        let is_accused = state.range.peak > S::lit(ACCUSED)
            && state.range.peak > state.baro.peak * S::lit(WORSE);
        let is_stuck = state.same > S::lit(STUCK_TIME);
        let is_rough = is_stuck || (!motion.rests && state.range.rough > S::lit(ROUGH));
        let baro_is_rough = !motion.rests && state.baro.rough > S::lit(ROUGH);
        if !report.range_is_rejected && !report.baro_is_rejected {
            let is_due = state.apart >= S::lit(APART_TIME);
            report.range_is_rejected = (is_due && is_accused) || (is_rough && !baro_is_rough);
            report.baro_is_rejected =
                !report.range_is_rejected && (is_due || (baro_is_rough && !is_rough));
        } else if report.baro_is_rejected && state.apart >= S::lit(FORGIVEN) && !baro_is_rough {
            // It is off by something that stays: its zero moves there.
            state.baro_offset += difference;
            state.baro.shift(difference);
            report.baro_is_rejected = false;
        } else if state.together >= S::lit(TOGETHER_TIME) && !is_rough && !baro_is_rough {
            (report.range_is_rejected, report.baro_is_rejected) = (false, false);
        }
    }

    pub fn is_fresh(&self, state: &AltimeterState<S>, now: Micros) -> bool {
        state.any_at.is_some_and(|at| now.since(at) <= self.timeout_us)
    }

    pub fn is_ranged(&self, state: &AltimeterState<S>, now: Micros) -> bool {
        let is_fresh = state.ranged.is_some_and(|sample| now.since(sample.at) < RANGE_HOLD_US);
        is_fresh && state.is_ranged
    }

    /// How far inertia is from what the altimeters show, m.
    pub fn error(&self, state: &AltimeterState<S>) -> S {
        state.error
    }

    /// Which of the two is not believed.
    pub fn report(&self, state: &AltimeterState<S>) -> AltimeterReport {
        state.report
    }
}

impl<S: Scalar> AltimeterState<S> {
    /// From the nearer one, for a single one may lie, m.
    fn error_now(&self) -> S {
        let Some(now) = self.any_at else { return S::zero() };
        let size = |witness: &Witness<S>| witness.error.abs().max(witness.last.abs());
        let range = fresh(self.ranged, now).map(|_| size(&self.range));
        let baro = fresh(self.barometric, now).map(|_| size(&self.baro));
        match (range, baro) {
            (Some(range), Some(baro)) => range.min(baro),
            (one, other) => one.or(other).unwrap_or(S::zero()),
        }
    }
}

/// Since the one before, s.
fn age<S: Scalar>(before: Option<Sample<S>>, at: Micros) -> S {
    before.map_or(S::lit(0.02), |before| {
        S::from_f32(at.seconds_since(before.at)).limit(S::lit(1e-3), S::lit(0.1))
    })
}

fn fresh<S: Scalar>(sample: Option<Sample<S>>, at: Micros) -> Option<Sample<S>> {
    sample.filter(|s| at.since(s.at) < RANGE_HOLD_US)
}

/// Height over where the first pressure was read. The difference of pressures is taken in integers:
/// a pressure in Pa does not fit the fixed-point scalar. `None` for a pressure that no flight meets.
fn relative_height<S: Scalar>(zero: &mut Option<i32>, centipascal: i32) -> Option<S> {
    if !(3_000_000..12_000_000).contains(&centipascal) {
        return None;
    }
    let p0 = *zero.get_or_insert(centipascal);
    let ratio = S::from_f32((p0 - centipascal) as f32 / p0 as f32);
    // -ln(1 - x) to third order: 1 cm at 300 m.
    let (half, third) = (S::lit(0.5), S::lit(1.0 / 3.0));
    Some(S::lit(SCALE_HEIGHT) * (ratio * (S::one() + ratio * (half + ratio * third))))
}

#[cfg(test)]
mod tests;
