//! Steady wind with Dryden gusts, MIL-F-8785C, low altitude. Heights in feet and speeds in m/s, as the
//! scale lengths want them.

use super::{V3, normal, uniform};
use crate::scenario::WindSection;
use rand_pcg::Pcg64Mcg;

/// Turbulence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gusts {
    /// Steady.
    None,
    /// Dryden, strength by the mean wind.
    Dryden,
}

/// Description.
#[derive(Clone, Debug)]
pub struct WindModel {
    /// Mean speed, m/s.
    pub speed: f64,
    /// Direction from which it blows, rad from North.
    pub from: f64,
    /// Turbulence.
    pub gusts: Gusts,
    /// Exponent over height along the line.
    pub shear: f64,
    /// Peak of the recurring gust, m/s; zero: none.
    pub pulse: f64,
    /// Time, s, speed, m/s, direction, rad from North, and down, m/s; empty: the same wind all the time.
    pub table: Vec<[f64; 4]>,
}

impl WindModel {
    /// As the scenario describes it; `from` is the direction, rad, when it leaves that open.
    #[must_use]
    pub fn new(wind: &WindSection, from: f64) -> Self {
        Self {
            speed: wind.speed,
            from: wind.from.unwrap_or(from),
            gusts: if wind.gusts { Gusts::Dryden } else { Gusts::None },
            pulse: wind.pulse,
            shear: wind.shear,
            table: wind.table.iter().map(|row| row.0).collect(),
        }
    }

    /// Speed, m/s, direction, rad, and down, m/s, of the mean wind at `time` s.
    fn mean(&self, time: f64) -> [f64; 3] {
        let next = self.table.partition_point(|row| row[0] <= time);
        let row = |i: usize| self.table.get(i).copied();
        match (next.checked_sub(1).and_then(row), row(next)) {
            (Some([before, speed, from, down]), Some([after, speed_b, from_b, down_b])) => {
                let share = (time - before) / (after - before).max(1e-6);
                let mix = |a: f64, b: f64| a + (b - a) * share;
                [mix(speed, speed_b), mix(from, from_b), mix(down, down_b)]
            }
            (Some([_, speed, from, down]), None) | (None, Some([_, speed, from, down])) => {
                [speed, from, down]
            }
            (None, None) => [self.speed, self.from, 0.0],
        }
    }
}

/// Filters of the three components: along, across, down.
#[derive(Clone, Debug, Default)]
pub struct Wind {
    along: f64,
    across: [f64; 2],
    down: [f64; 2],
    pulse: Pulse,
    /// Air velocity at the vehicle, NED, m/s.
    pub velocity: V3,
}

/// A gust of 1-cos shape that comes again and again, each time from another side, with turbulence.
#[derive(Clone, Debug, Default)]
struct Pulse {
    time: f64,
    towards: V3,
    turbulence: V3,
}

/// Duration and period of the recurring gust, s; share and correlation time of its turbulence.
const PULSE_LENGTH: f64 = 3.0;
const PULSE_PERIOD: f64 = 5.0;
const PULSE_TURBULENCE: f64 = 0.2;
const PULSE_CORRELATION: f64 = 1.0;

impl Pulse {
    fn step(&mut self, peak: f64, dt: f64, rng: &mut Pcg64Mcg) -> V3 {
        self.time -= dt;
        if self.time <= 0.0 {
            self.time = PULSE_PERIOD;
            let (sin, cos) = (uniform(rng) * std::f64::consts::PI).sin_cos();
            self.towards = V3::new(cos, sin, 0.0);
        }
        let keep = (-dt / PULSE_CORRELATION).exp();
        let kick = PULSE_TURBULENCE * peak * (1.0 - keep * keep).sqrt();
        let noise = V3::new(normal(rng), normal(rng), normal(rng));
        self.turbulence = self.turbulence * keep + noise * kick;
        let into = PULSE_PERIOD - self.time;
        let shape = if into < PULSE_LENGTH {
            0.5 * (1.0 - (std::f64::consts::TAU * into / PULSE_LENGTH).cos())
        } else {
            0.0
        };
        self.towards * (peak * shape) + self.turbulence
    }
}

const FEET_PER_METRE: f64 = 3.280_84;
/// Below this the filters of a calm would stand still.
const SPEED_FLOOR: f64 = 1.0;

impl Wind {
    /// Air velocity, NED, m/s, at a time, s, and a height, m.
    pub fn step(
        &mut self,
        model: &WindModel,
        (time, height): (f64, f64),
        dt: f64,
        rng: &mut Pcg64Mcg,
    ) -> V3 {
        if model.speed <= 0.0 && model.pulse <= 0.0 && model.table.is_empty() {
            self.velocity = V3::zeros();
            return self.velocity;
        }
        let [speed, from, down] = model.mean(time);
        let (sin, cos) = from.sin_cos();
        let along = V3::new(-cos, -sin, 0.0);
        let across = V3::new(sin, -cos, 0.0);
        self.velocity = along * speed + V3::new(0.0, 0.0, down);
        if model.gusts == Gusts::Dryden && speed > 0.0 {
            let (u, v, w) = self.gust(speed, height, dt, rng);
            self.velocity += along * u + across * v + V3::new(0.0, 0.0, w);
        }
        if model.pulse > 0.0 {
            self.velocity += self.pulse.step(model.pulse, dt, rng);
        }
        self.velocity
    }

    fn gust(&mut self, speed: f64, height: f64, dt: f64, rng: &mut Pcg64Mcg) -> (f64, f64, f64) {
        let h = (height * FEET_PER_METRE).clamp(10.0, 1000.0);
        let shape = 0.177 + 0.000_823 * h;
        let length_h = h / shape.powf(1.2) / FEET_PER_METRE;
        let length_w = h / FEET_PER_METRE;
        let sigma_w = 0.1 * speed;
        let sigma_h = sigma_w / shape.powf(0.4);
        let pass = speed.max(SPEED_FLOOR);

        let keep = (-dt * pass / length_h).exp();
        self.along = keep * self.along + sigma_h * (1.0 - keep * keep).sqrt() * normal(rng);
        let v = second_order(&mut self.across, length_h / pass, sigma_h, dt, normal(rng));
        let w = second_order(&mut self.down, length_w / pass, sigma_w, dt, normal(rng));
        (self.along, v, w)
    }
}

/// σ√τ (1 + √3 τ s)/(1 + τ s)² driven by white noise of unit intensity; its variance is σ².
fn second_order(x: &mut [f64; 2], tau: f64, sigma: f64, dt: f64, noise: f64) -> f64 {
    let [a, b] = *x;
    let drive = sigma * tau.sqrt() * noise / dt.sqrt();
    let a_rate = (drive - a) / tau;
    let next = a + a_rate * dt;
    // (1 + √3 τ s) a = a + √3 τ ȧ, then one more lag.
    let lead = a + 3.0_f64.sqrt() * tau * a_rate;
    let out = b + (lead - b) / tau * dt;
    *x = [next, out];
    out
}
