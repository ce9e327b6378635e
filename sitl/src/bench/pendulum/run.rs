//! Closed loop: plant, late and noisy motion capture, the core's observer and controller.

use super::plant::{PendulumAction, PendulumPlant, PendulumTruth};
use super::summary::PendulumSummary;
use crate::plant::{Disturbance, Generator, generator, normal};
use nalgebra::{Matrix3, Vector3};
use std::collections::VecDeque;
use tautline_firmware::control::pendulum::{LinearPendulum, PendulumControl, PendulumMemory};
use tautline_firmware::estimate::pendulum::{
    PendulumEstimate, PendulumObserver, PendulumObserverState, PendulumPosterior, PendulumReading,
};
use tautline_firmware::frames::{Attitude, V3, World};
use tautline_firmware::scalar::Scalar;
use tautline_firmware::signal::LoadReference;
use tautline_firmware::trajectory::load::{SoftStart, TiltedCircle};

/// Farther from the reference than this the load is lost, m.
const LOST: f64 = 10.0;

/// Errors of the motion capture.
#[derive(Clone, Copy, Debug)]
pub struct Sensing {
    /// Direction, rad.
    pub rod: f64,
    /// m/s.
    pub velocity: f64,
    /// m.
    pub position: f64,
    /// Of the samples, s.
    pub period: f64,
    /// Age, in plant steps.
    pub delay: usize,
    /// Random numbers.
    pub seed: u64,
}

/// The controller that flies.
#[derive(Clone, Copy, Debug)]
pub enum Flown<S: Scalar> {
    /// The article's.
    Backstepping(PendulumControl<S>),
    /// The baseline.
    Linear(LinearPendulum<S>),
}

/// Everything that a run is made of.
#[derive(Clone, Debug)]
pub struct PendulumRun<S: Scalar> {
    /// The truth.
    pub plant: PendulumPlant,
    /// True over commanded thrust.
    pub thrust_factor: f64,
    /// Where it starts.
    pub start: PendulumTruth,
    /// What pushes.
    pub disturbance: Disturbance,
    /// The core's estimator.
    pub observer: PendulumObserver<S>,
    /// Its initial estimate; `None`: from the first measured direction.
    pub initial: Option<PendulumPosterior<S>>,
    /// The core's controller.
    pub law: Flown<S>,
    /// The reference.
    pub circle: TiltedCircle<S>,
    /// Hover where the reference starts.
    pub is_hovering: bool,
    /// Of E2, s; zero: none.
    pub soft_start: f64,
    /// Errors of the motion capture.
    pub sensing: Sensing,
    /// The controller gets the true state and disturbance.
    pub knows_state: bool,
    /// The controller gets the filtered direction instead of the measured one.
    pub uses_filtered_rod: bool,
    /// The controller gets no disturbance.
    pub ignores_disturbance: bool,
    /// Control period, s.
    pub dt: f64,
    /// Plant steps in it.
    pub substeps: u32,
    /// s.
    pub duration: f64,
    /// Figures count from here on, s.
    pub settled: f64,
}

/// One control step.
#[derive(Clone, Copy, Debug)]
pub struct PendulumRow {
    /// s.
    pub time: f64,
    /// Where the load shall be, m.
    pub reference: Vector3<f64>,
    /// The truth.
    pub truth: PendulumTruth,
    /// On the vehicle, N.
    pub disturbance: Vector3<f64>,
    /// Of the load, m/s.
    pub estimated_velocity: Vector3<f64>,
    /// rad/s.
    pub estimated_rod_rate: Vector3<f64>,
    /// N.
    pub estimated_disturbance: Vector3<f64>,
    /// Commanded, N.
    pub thrust: f64,
    /// Commanded, rad/s.
    pub rate: Vector3<f64>,
}

impl PendulumRow {
    /// Load from its reference, m.
    #[must_use]
    pub fn error(&self) -> Vector3<f64> {
        self.truth.position - self.reference
    }
}

/// A run.
#[derive(Clone, Debug)]
pub struct PendulumTrace {
    /// At the control rate.
    pub rows: Vec<PendulumRow>,
    /// Figures.
    pub summary: PendulumSummary,
}

fn down<S: Scalar>(v: &Vector3<f64>) -> V3<S> {
    v.map(S::lit)
}

fn up<S: Scalar + Into<f64>>(v: &V3<S>) -> Vector3<f64> {
    v.map(Into::into)
}

/// The cameras' measurement of a truth.
fn reading<S: Scalar>(
    s: &Sensing,
    length: f64,
    truth: &PendulumTruth,
    thrust: S,
    rng: &mut Generator,
) -> PendulumReading<S> {
    let mut noise = |size: f64| Vector3::from_fn(|_, _| size * normal(rng));
    let vehicle = truth.position - truth.rod * length;
    PendulumReading {
        rod: Some(World(down(&(truth.rod + noise(s.rod))))),
        position: World(down(&(vehicle + noise(s.position)))),
        velocity: World(down(&(truth.vehicle_velocity(length) + noise(s.velocity)))),
        down: World(down(&truth.attitude.column(2).into_owned())),
        thrust,
        rod_period: S::lit(s.period),
    }
}

impl<S: Scalar + Into<f64>> PendulumRun<S> {
    fn known(&self, truth: &PendulumTruth, disturbance: &Vector3<f64>) -> PendulumEstimate<S> {
        PendulumEstimate {
            position: World(down(&truth.position)),
            velocity: World(down(&truth.velocity)),
            rod: World(down(&truth.rod)),
            rod_rate: World(down(&truth.rod_rate)),
            disturbance: World(down(disturbance)),
        }
    }

    /// Flies it.
    #[must_use]
    pub fn fly(mut self) -> PendulumTrace {
        let mut rng = generator(self.sensing.seed, 41);
        let dt = S::lit(self.dt);
        let plant_dt = self.dt / f64::from(self.substeps);
        let mut truth = self.start;
        let mut history = VecDeque::from([truth]);
        let mut observer = None;
        let mut memory = PendulumMemory::default();
        let (mut angle, mut soft) = (S::zero(), None);
        let mut thrust = S::zero();
        let mut rows = Vec::new();
        let mut lost_at = None;
        let steps = (self.duration / self.dt).round() as u64;
        for step in 0..=steps {
            let time = step as f64 * self.dt;
            let late = *history.front().unwrap_or(&truth);
            let z = reading(&self.sensing, self.plant.length, &late, thrust, &mut rng);
            let Some(mut x) = self.observe(&mut observer, &z, dt) else {
                lost_at = Some(time);
                break;
            };
            let estimate = x;
            if let Some(state) = observer.as_ref().filter(|_| self.uses_filtered_rod) {
                x.rod = World(state.posterior.rod / S::lit(up(&state.posterior.rod).norm()));
            }
            if self.ignores_disturbance {
                x.disturbance = World(V3::zeros());
            }
            let force = self.disturbance.force();
            if self.knows_state {
                x = self.known(&truth, &force);
            }
            let mut reference = self.circle.at(angle);
            if self.is_hovering {
                reference = LoadReference::at_rest(reference.position());
            }
            if self.soft_start > 0.0 {
                let soft = soft.get_or_insert_with(|| {
                    SoftStart::new(&x.position, &x.velocity, &reference, S::lit(self.soft_start))
                });
                reference = soft.apply(&reference, S::lit(time));
            }
            if !self.is_hovering {
                angle = self.circle.advance(angle, dt);
            }
            let attitude = Attitude(Matrix3::from_fn(|r, c| {
                S::lit(if self.knows_state { &truth } else { &late }.attitude[(r, c)])
            }));
            let command = match &self.law {
                Flown::Backstepping(law) => law.step(&mut memory, &x, &attitude, &reference).ok(),
                Flown::Linear(law) => Some(law.step(&x, &attitude, &reference)),
            };
            let Some(command) = command else {
                lost_at = Some(time);
                break;
            };
            thrust = command.thrust;
            let rate = up(&command.rate.0);
            let row = PendulumRow {
                time,
                reference: up(&reference.position().0),
                truth,
                disturbance: force,
                estimated_velocity: up(&estimate.velocity.0),
                estimated_rod_rate: up(&estimate.rod_rate.0),
                estimated_disturbance: up(&estimate.disturbance.0),
                thrust: thrust.into(),
                rate,
            };
            rows.push(row);
            let distance = row.error().norm();
            if distance.is_nan() || distance > LOST {
                lost_at = Some(time);
                break;
            }
            for _ in 0..self.substeps {
                let action = PendulumAction {
                    thrust: row.thrust * self.thrust_factor,
                    rate,
                    disturbance: self.disturbance.force(),
                };
                truth = self.plant.step(&truth, &action, plant_dt);
                self.disturbance.step(plant_dt);
                history.push_back(truth);
                while history.len() > self.sensing.delay + 1 {
                    history.pop_front();
                }
            }
        }
        PendulumTrace { summary: PendulumSummary::of(&rows, self.settled, lost_at), rows }
    }

    fn observe(
        &self,
        observer: &mut Option<PendulumObserverState<S>>,
        z: &PendulumReading<S>,
        dt: S,
    ) -> Option<PendulumEstimate<S>> {
        match observer {
            None => {
                let (state, estimate) = match self.initial {
                    Some(initial) => self.observer.start_from(initial, z),
                    None => self.observer.start(z),
                }?;
                *observer = Some(state);
                Some(estimate)
            }
            Some(state) => self.observer.step(state, z, dt).ok(),
        }
    }
}
