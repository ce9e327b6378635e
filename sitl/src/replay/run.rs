//! Flies the tape, and compares.

use crate::flight::Autopilot;
use crate::flight::tape::{Begin, Item, fingerprint};
use crate::metrics::Spread;
use crate::scenario::{params_file, set_param};
use serde::Serialize;
use tautline_firmware::param::Params;
use tautline_firmware::vehicle::StepOutput;

/// What is to be another than in the recorded flight.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// A parameter file: its name and what it holds.
    pub file: Option<(String, Vec<u8>)>,
    /// Parameters by name, after those of the file.
    pub params: Vec<(String, f32)>,
}

impl Settings {
    /// Whether anything is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.file.is_none() && self.params.is_empty()
    }

    fn on(&self, mut params: Params) -> Result<Params, String> {
        if let Some((name, bytes)) = &self.file {
            params_file::load_bytes(&mut params, bytes, name)?;
        }
        for (name, value) in &self.params {
            set_param(&mut params, name, *value)?;
        }
        Ok(params)
    }
}

/// How far two runs over the same inputs are apart, RMS over all steps.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// Of the estimated position, where both have one.
    pub position_rms_m: Option<f64>,
    /// Largest.
    pub position_max_m: f64,
    /// Of the estimated attitude.
    pub attitude_rms_rad: Option<f64>,
    /// Of the estimated tension, where both have one.
    pub tension_rms_n: Option<f64>,
    /// Of the throttles, together.
    pub throttle_rms: Option<f64>,
    /// Steps in different modes.
    pub other_mode_steps: u64,
}

/// What came of a replay.
#[derive(Clone, Debug, Serialize)]
pub struct Replayed {
    /// Every step said the same as in the recorded flight, to the bit.
    pub identical: bool,
    /// Steps that were run.
    pub steps: u64,
    /// When they first said something else, s since power-up.
    pub first_difference_s: Option<f64>,
    /// Against the recorded flight, run again by this build.
    pub difference: Difference,
    /// Commit that the flight was recorded with; empty where it is unknown.
    pub recorded_by: String,
    /// Time, s, and distance of the two estimated positions, m, in steps of 20 ms; for pictures.
    #[serde(skip)]
    pub position: Vec<(f64, f64)>,
    /// Time, s, and angle between the two estimated attitudes, rad.
    #[serde(skip)]
    pub attitude: Vec<(f64, f64)>,
    /// Time, s, and the two mean throttles.
    #[serde(skip)]
    pub throttle: Vec<(f64, [f64; 2])>,
}

/// Points of a picture are so many steps apart.
const POINT: u64 = 20;

#[derive(Default)]
struct Apart {
    position: Spread,
    attitude: Spread,
    tension: Spread,
    throttle: Spread,
    other_mode: u64,
}

impl Apart {
    /// Position, m, and attitude, rad.
    fn step(&mut self, a: &StepOutput, b: &StepOutput) -> (Option<f64>, f64) {
        let position = a.estimate.position.zip(b.estimate.position).map(|(a, b)| {
            let off = f64::from((a.0 - b.0).norm());
            self.position.add(off);
            off
        });
        let [p, q] = [a, b].map(|out| out.estimate.attitude.quaternion().map(f64::from));
        // By the chord: an arc cosine makes an angle of rounding.
        let chord = |sign: f64| p.iter().zip(q).map(|(p, q)| (p - sign * q).powi(2)).sum::<f64>();
        let angle = 4.0 * (0.5 * chord(1.0).min(chord(-1.0)).sqrt()).min(1.0).asin();
        self.attitude.add(angle);
        if let Some((a, b)) = a.estimate.tether.zip(b.estimate.tether) {
            self.tension.add(f64::from(a.tension - b.tension));
        }
        for (a, b) in a.actuation.throttle.iter().zip(b.actuation.throttle.iter()) {
            self.throttle.add(f64::from(a - b));
        }
        self.other_mode += u64::from(a.mode != b.mode);
        (position, angle)
    }
}

fn mean_throttle(out: &StepOutput) -> f64 {
    let throttle = &out.actuation.throttle;
    throttle.iter().copied().map(f64::from).sum::<f64>() / throttle.len().max(1) as f64
}

/// The recorded firmware and the other one.
struct Pair {
    own: Autopilot,
    other: Option<Autopilot>,
}

impl Pair {
    fn start(begin: &Begin, settings: &Settings) -> Result<Self, String> {
        let params = begin.params()?;
        let start = |params| Autopilot::new(begin.scalar, params, begin.scale);
        let other = (!settings.is_empty()).then(|| settings.on(params)).transpose()?;
        Ok(Self { own: start(params), other: other.map(start) })
    }
}

/// Runs the items through this build's step, once as recorded and, if there are settings, once with them.
///
/// # Errors
/// One line: a stream without a start, or a parameter that this build does not know.
pub fn replay(items: &[Item], settings: &Settings) -> Result<Replayed, String> {
    let mut pair: Option<Pair> = None;
    let mut apart = Apart::default();
    let mut replayed = Replayed {
        identical: true,
        steps: 0,
        first_difference_s: None,
        difference: Difference {
            position_rms_m: None,
            position_max_m: 0.0,
            attitude_rms_rad: None,
            tension_rms_n: None,
            throttle_rms: None,
            other_mode_steps: 0,
        },
        recorded_by: String::new(),
        position: Vec::new(),
        attitude: Vec::new(),
        throttle: Vec::new(),
    };
    for item in items {
        let (input, recorded) = match item {
            Item::Begin(begin) => {
                replayed.recorded_by.clone_from(&begin.revision);
                pair = Some(Pair::start(begin, settings)?);
                continue;
            }
            Item::Step(input, recorded) => (input, *recorded),
        };
        let Pair { own, other } = pair.as_mut().ok_or("the inputs do not say how it started")?;
        let time = input.now.0 as f64 * 1e-6;
        own.step(input);
        own.maintain();
        if let Some(other) = other.as_mut() {
            other.step(input);
            other.maintain();
        }
        let (a, b) = (own.output(), other.as_ref().unwrap_or(own).output());
        if fingerprint(b) != recorded {
            replayed.first_difference_s.get_or_insert(time);
        }
        let (position, angle) = apart.step(a, b);
        if replayed.steps.is_multiple_of(POINT) {
            replayed.position.extend(position.map(|off| (time, off)));
            replayed.attitude.push((time, angle));
            replayed.throttle.push((time, [mean_throttle(a), mean_throttle(b)]));
        }
        replayed.steps += 1;
        // The thrust that acted is the recorded flight's, whatever the other one asked for.
        if let Some(other) = other.as_mut() {
            other.follow(own);
        }
    }
    replayed.identical = replayed.steps > 0 && replayed.first_difference_s.is_none();
    replayed.difference = Difference {
        position_rms_m: apart.position.rms(),
        position_max_m: apart.position.max,
        attitude_rms_rad: apart.attitude.rms(),
        tension_rms_n: apart.tension.rms(),
        throttle_rms: apart.throttle.rms(),
        other_mode_steps: apart.other_mode,
    };
    Ok(replayed)
}
