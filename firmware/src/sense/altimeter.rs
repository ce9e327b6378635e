//! How high is the centre of mass over the anchor's ground?
//!
//! The rangefinder where it sees the ground, the barometer where not. While both answer, the
//! barometer's zero follows the rangefinder, so that the change-over makes no step. Until the
//! rangefinder answers for the first time, the barometer counts from where it woke up, on the ground.

use super::RawSensors;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::time::{Micros, Sample};

/// The rangefinder must have been silent this long before the barometer takes over.
const RANGE_HOLD_US: u64 = 300_000;
/// Air column: R T / (g M) at 288 K, m.
const SCALE_HEIGHT: f64 = 8_434.7;

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
pub struct AltimeterState<S> {
    pressure_zero: Option<i32>,
    baro_offset: S,
    ranged: Option<Sample<S>>,
    any_at: Option<Micros>,
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

    /// The altitude, if one arrived this tick.
    pub fn step(
        &self,
        state: &mut AltimeterState<S>,
        raw: &RawSensors,
        cos_tilt: S,
    ) -> Option<Sample<S>> {
        let ranged = raw.range.and_then(|sample| {
            let distance = S::from_f32(f32::from(sample.value.distance_cm?) * 0.01);
            let usable = distance <= self.range_max && cos_tilt > S::lit(0.5);
            usable.then(|| Sample { at: sample.at, value: (distance + self.offset) * cos_tilt })
        });
        if ranged.is_some() {
            state.ranged = ranged;
        }
        let baro = raw.barometer.and_then(|sample| {
            let relative =
                relative_height(&mut state.pressure_zero, sample.value.pressure_centipascal)?;
            if let Some(range) = state.ranged.filter(|r| sample.at.since(r.at) < RANGE_HOLD_US) {
                let error = range.value - (self.ground_height + relative + state.baro_offset);
                state.baro_offset += error * S::lit(0.05);
                return None;
            }
            let value = self.ground_height + relative + state.baro_offset;
            Some(Sample { at: sample.at, value })
        });
        let best = ranged.or(baro);
        if let Some(sample) = best {
            state.any_at = Some(sample.at);
        }
        best
    }

    pub fn is_fresh(&self, state: &AltimeterState<S>, now: Micros) -> bool {
        state.any_at.is_some_and(|at| now.since(at) <= self.timeout_us)
    }

    pub fn is_ranged(&self, state: &AltimeterState<S>, now: Micros) -> bool {
        state.ranged.is_some_and(|sample| now.since(sample.at) < RANGE_HOLD_US)
    }
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
mod tests {
    use super::*;
    use crate::signal::{RawBarometer, RawRange};

    #[test]
    fn the_change_to_the_barometer_makes_no_step() {
        let altimeter = Altimeter::<f32>::new(&Params::default());
        let mut state = AltimeterState::default();
        let mut last = 0.0;
        for i in 0..400_u32 {
            let at = Micros(u64::from(i) * 20_000);
            let raw = RawSensors {
                barometer: Some(Sample {
                    at,
                    value: RawBarometer {
                        pressure_centipascal: 10_132_500 - 4_200,
                        temperature: 20.0,
                    },
                }),
                range: (i < 200)
                    .then_some(Sample { at, value: RawRange { distance_cm: Some(500) } }),
                ..RawSensors::default()
            };
            if let Some(sample) = altimeter.step(&mut state, &raw, 1.0) {
                last = sample.value;
            }
        }
        assert!((last - 5.03).abs() < 0.01, "{last}");
        assert!(!altimeter.is_ranged(&state, Micros(8_000_000)));
        assert!(altimeter.is_fresh(&state, Micros(8_000_000)));
        assert!(!altimeter.is_fresh(&state, Micros(12_000_000)));
    }

    #[test]
    fn pressure_falls_a_hectopascal_in_eight_metres() {
        let mut zero = Some(10_132_500);
        let h: f64 = relative_height(&mut zero, 10_012_500).unwrap();
        assert!((h - 100.5).abs() < 0.2, "{h}");
        assert!(relative_height::<f64>(&mut zero, 0).is_none());
    }
}
