//! What the vectors of the full-state filter look like: their order of the errors, their parameters.

use super::full_state::Bounds;
use super::{Check, list, num, rotation};
use serde_json::Value;
use tautline_firmware::estimate::full_state::{
    ACCEL_BIAS, BLOCKS, Blocks, Covariance, Densities, FullState, FullStateFilter, FullStateModel,
    GUST, GYRO_BIAS, GustNoise, OFFSET, POSITION, SCALARS, Sag, StartDeviation, TILT, VELOCITY,
    WIND,
};
use tautline_firmware::frames::{Attitude, M3, V3};
use tautline_firmware::math::GRAVITY;
use tautline_firmware::model::Line;
use tautline_firmware::scalar::Scalar;

/// The two files' error states.
#[derive(Clone, Copy, PartialEq)]
pub enum Errors {
    TwentyOne,
    TwentySix,
}

/// Where the n-th error stands: its block and its component.
const ORDER: [(usize, usize); 26] = {
    let mut order = [(0, 0); 26];
    let blocks = [
        (POSITION, 0),
        (VELOCITY, 3),
        (TILT, 6),
        (ACCEL_BIAS, 11),
        (GYRO_BIAS, 14),
        (WIND, 17),
        (GUST, 21),
    ];
    let mut b = 0;
    while b < blocks.len() {
        let (block, at) = blocks[b];
        let mut i = 0;
        while i < 3 {
            order[at + i] = (block, i);
            i += 1;
        }
        b += 1;
    }
    order[9] = (SCALARS, 0);
    order[10] = (SCALARS, 1);
    order[20] = (SCALARS, 2);
    order[24] = (OFFSET, 0);
    order[25] = (OFFSET, 1);
    order
};

impl Errors {
    fn count(self) -> usize {
        match self {
            Self::TwentyOne => 21,
            Self::TwentySix => 26,
        }
    }

    fn order(self) -> &'static [(usize, usize)] {
        &ORDER[..self.count()]
    }

    pub fn of_blocks<S: Scalar>(self, blocks: &Blocks<S>) -> Vec<S> {
        self.order().iter().map(|&(block, i)| blocks[block][i]).collect()
    }

    /// `x` and `R`.
    pub fn nominal<S: Scalar>(self, v: &Value) -> FullState<S> {
        let mut state = start();
        if v.get("R").is_some() {
            state.attitude = rotation(v, "R");
        }
        self.place(&mut state, &list(v, "x"));
        state
    }

    fn place<S: Scalar>(self, state: &mut FullState<S>, x: &[f64]) {
        let v = |at: usize| V3::new(S::lit(x[at]), S::lit(x[at + 1]), S::lit(x[at + 2]));
        (state.position, state.velocity) = (v(0), v(3));
        (state.tension, state.thrust_scale) = (S::lit(x[6]), S::lit(x[7]));
        (state.accel_bias, state.gyro_bias, state.wind) = (v(8), v(11), v(14));
        state.altimeter_bias = S::lit(x[17]);
        if self == Self::TwentySix {
            state.gust = v(18);
            state.offset = [S::lit(x[21]), S::lit(x[22])];
        }
    }

    fn numbers<S: Scalar>(self, state: &FullState<S>) -> Vec<S> {
        let mut all: Vec<S> = state.position.iter().chain(&state.velocity).copied().collect();
        all.extend([state.tension, state.thrust_scale]);
        all.extend(state.accel_bias.iter().chain(&state.gyro_bias).chain(&state.wind));
        all.push(state.altimeter_bias);
        if self == Self::TwentySix {
            all.extend(state.gust.iter());
            all.extend(state.offset);
        }
        all
    }

    /// `x`, `R` and `P`.
    pub fn state<S: Scalar>(self, v: &Value) -> FullState<S> {
        let mut state = self.nominal(v);
        let lower = list(v, "P");
        let at = |i: usize, j: usize| lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        let mut blocks = [[M3::<S>::zeros(); BLOCKS]; BLOCKS];
        for (i, &(row, r)) in self.order().iter().enumerate() {
            for (j, &(column, c)) in self.order().iter().enumerate() {
                blocks[row][column][(r, c)] = S::lit(at(i, j));
            }
        }
        for (row, blocks) in blocks.iter().enumerate() {
            for (column, block) in blocks.iter().enumerate().skip(row) {
                state.covariance.set(row, column, *block);
            }
        }
        state
    }

    /// Of a standard deviation's square, in this order.
    pub fn diagonal<S: Scalar>(self, variances: &[f64]) -> Covariance<S> {
        let mut blocks = [V3::zeros(); BLOCKS];
        for (&(block, i), variance) in self.order().iter().zip(variances) {
            blocks[block][i] = S::lit(variance.sqrt());
        }
        Covariance::from_deviations(&blocks)
    }
}

/// Anything; the caller fills it.
pub fn start<S: Scalar>() -> FullState<S> {
    let level = Attitude(M3::identity());
    FullState::at_rest(V3::zeros(), level, S::zero(), V3::zeros(), &StartDeviation::standard())
}

fn model<S: Scalar>(par: &Value, mu: f64, sag: Sag<S>, bow: f64) -> FullStateModel<S> {
    let of = |key: &str| S::lit(num(par, key));
    FullStateModel {
        mass: of("m"),
        attachment: of("ra"),
        drag: of("cd"),
        line: Line(S::lit(mu * GRAVITY)),
        stiffness: of("EA"),
        length_floor: of("lmin"),
        sag,
        bow: S::lit(bow),
    }
}

fn densities(par: &Value) -> Densities {
    let of = |key: &str| num(par, key);
    Densities {
        gyro: [of("sg"); 3],
        velocity: of("qv"),
        tension: of("qfc"),
        thrust_scale: of("qkT"),
        accel_bias: of("qba"),
        gyro_bias: [of("qbg"); 3],
        altimeter_bias: of("qhb"),
        wind: [0.0; 3],
        wind_time: of("tauw"),
        gust: None,
        offset: 0.0,
        offset_time: 0.0,
    }
}

const DT: f64 = 4e-3;

fn step_time(case: &Value) -> f64 {
    case["dt"].as_f64().unwrap_or(DT)
}

/// Of the first file: without gusts, with a wind of constant variance.
pub fn filter<S: Scalar>(est: &Value, case: &Value) -> FullStateFilter<S> {
    let (dt, time) = (step_time(case), num(est, "tauw"));
    // The walk that holds the variance where it is: section 3's Q, as a density.
    let held = |sd: f64| sd * ((1.0 - (-2.0 * dt / time).exp()) / dt).sqrt();
    let (level, down) = (held(num(est, "swh")), held(num(est, "swd")));
    let densities = Densities { wind: [level, level, down], ..densities(est) };
    let model = model(est, num(est, "mu"), Sag::None, 0.0);
    let mut filter = FullStateFilter::new(model, &densities, num(est, "sa"), false, dt);
    filter.gate = S::lit(num(est, "gate"));
    filter
}

/// Of the second; the case's own settings win.
pub fn filter_2<S: Scalar>(par: &Value, case: &Value) -> FullStateFilter<S> {
    let of = |key: &str| num(par, key);
    let own = |key: &str| case.get(key).and_then(Value::as_f64).unwrap_or_else(|| of(key));
    let sag = match own("cat") as u32 {
        0 => Sag::None,
        1 => Sag::OfEstimate,
        2 => Sag::OfSetpoint(S::lit(of("fset"))),
        other => panic!("unknown kind of line {other}"),
    };
    assert!(of("dq") == 0.0 && of("da") == 0.0, "the drag is the same in all axes");
    let gust = GustNoise {
        time_level: of("taug"),
        time_down: of("taugd"),
        floor: of("sg0"),
        share: of("kg"),
        down: of("kgd"),
        significance: of("ksig"),
    };
    let densities = Densities {
        wind: [of("qwh"), of("qwh"), of("qwd")],
        gust: Some(gust),
        offset: of("qo"),
        offset_time: of("tauo"),
        ..densities(par)
    };
    let model = model(par, own("mu"), sag, own("bow"));
    let mut filter = FullStateFilter::new(model, &densities, of("sa"), true, step_time(case));
    filter.gate = S::lit(of("gate"));
    filter.push_strength = S::lit(of("kb"));
    filter
}

/// Compares states and covariances.
pub struct Case {
    errors: Errors,
    state: Check,
    covariance: Check,
}

impl Case {
    pub fn new(errors: Errors, bounds: Bounds) -> Self {
        Self { errors, state: Check::new(bounds.state), covariance: Check::new(bounds.covariance) }
    }

    pub fn value<S: Scalar + Into<f64>>(&mut self, name: &str, got: S, want: f64) {
        self.state.near(name, got, want);
    }

    pub fn state<S: Scalar + Into<f64>>(&mut self, name: &str, got: &FullState<S>, want: &Value) {
        self.state.all(name, self.errors.numbers(got), list(want, "x"));
        self.state.all(name, got.attitude.0.transpose().iter().copied(), list(want, "R"));
    }

    pub fn covariance<S: Scalar + Into<f64>>(
        &mut self,
        name: &str,
        got: &Covariance<S>,
        want: &Value,
    ) {
        let lower = list(want, "P");
        let order = self.errors.order();
        let mut wanted = lower.iter();
        let deviation = |i: usize| lower[i * (i + 1) / 2 + i].sqrt().max(1e-12);
        for (i, &(row, r)) in order.iter().enumerate() {
            for (j, &(column, c)) in order.iter().enumerate().take(i + 1) {
                let scale = deviation(i) * deviation(j);
                let got: f64 = got.block(row, column)[(r, c)].into();
                let want = wanted.next().unwrap() / scale;
                self.covariance.near(&format!("{name} P[{i},{j}]"), got / scale, want);
            }
        }
    }

    /// A stream's variances.
    pub fn variances<S: Scalar + Into<f64>>(
        &mut self,
        name: &str,
        got: &Covariance<S>,
        want: &[f64],
    ) {
        for (&(block, i), want) in self.errors.order().iter().zip(want) {
            let got: f64 = got.variances(block)[i].into();
            self.covariance.near(name, got / want.max(1e-24), if *want > 0.0 { 1.0 } else { 0.0 });
        }
    }
}
