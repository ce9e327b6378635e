//! Closed loop: plant, sensors with noise, the core's observer and controller.

use super::PlanarPlant;
use super::controller::{Controller, Plan, flat_start, models};
use super::metrics::{Errors, PlanarSummary};
use super::scenario::{Feedback, LawKind, PlanarScenario};
use crate::plant::{generator, normal};
use tautline_firmware::control::taut::{PlanarInput, PlanarLoop, PlanarLoopState};
use tautline_firmware::math::wrap_pi;
use tautline_firmware::model::{PlanarImu, PlanarState};

/// One sample of a run.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// s.
    pub time: f64,
    /// True `[φ, φ', θ, θ']`.
    pub state: [f64; 4],
    /// Estimated `[φ, φ', θ, θ']`.
    pub estimate: [f64; 4],
    /// Thrust sent for the next interval, N.
    pub thrust: f64,
    /// Torque sent, N m.
    pub torque: f64,
    /// True link force, under the thrust that acted until now, N.
    pub link_force: f64,
    /// Estimated, N.
    pub link_force_estimate: f64,
    /// Elevation of the reference, rad.
    pub elevation_reference: f64,
    /// Of the reference: pitch, rad, or link force, N.
    pub second_reference: f64,
    /// Residuals of both branches, m/s².
    pub residuals: [f64; 2],
    /// Selected branch, 0 or 1.
    pub selected: u8,
}

/// A run.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Sample by sample, up to a divergence.
    pub rows: Vec<Row>,
    /// Figures.
    pub summary: PlanarSummary,
}

/// Flies a scenario to its end or its divergence.
///
/// # Errors
/// One line naming the setting.
pub fn fly(s: &PlanarScenario, seed: u64) -> Result<Trace, String> {
    check(s)?;
    let [real, nominal] = models(s).map_err(|e| format!("plant or model_error: {e}"))?;
    let plan = Plan::new(s).map_err(|e| format!("reference.{e}"))?;
    let controller = Controller::new(s, nominal)?;
    let begin = plan.at(0.0);
    let mut start = flat_start(s, &real, &begin)?.state.to_array();
    for (x, offset) in start.iter_mut().zip(s.start.state_offset) {
        *x += offset;
    }
    let first_thrust = flat_start(s, &nominal, &begin)?.thrust;
    let mut plant = PlanarPlant::new(s.plant.clone(), start, first_thrust);
    let mut rng = generator(seed, 20);
    let (accel_sd, gyro_sd) = (s.noise.accel_variance.sqrt(), s.noise.gyro_variance.sqrt());
    let dt = 1.0 / s.rate_hz;
    let steps = (s.end() * s.rate_hz).round() as u64;
    let mut state: Option<PlanarLoopState<f64>> = None;
    let mut rows = Vec::with_capacity(steps as usize + 1);
    let mut errors = Errors::new(s);
    let mut has_diverged = false;
    for k in 0..=steps {
        let time = k as f64 * dt;
        let mut noise = |sd: f64| if sd > 0.0 { normal(&mut rng) * sd } else { 0.0 };
        let readings = plant.readings();
        let [ax, az] = readings.accel;
        let imu = PlanarImu {
            x: ax + noise(accel_sd),
            z: az + noise(accel_sd),
            rate: readings.rate + noise(gyro_sd),
        };
        let reference = plan.at(time);
        let [second, ..] = reference.second;
        let [elevation, ..] = reference.elevation;
        let mut row = Row {
            time,
            state: plant.state,
            estimate: plant.state,
            thrust: 0.0,
            torque: 0.0,
            link_force: readings.link_force,
            link_force_estimate: readings.link_force,
            elevation_reference: elevation,
            second_reference: second,
            residuals: [0.0; 2],
            selected: 0,
        };
        match &controller {
            Controller::Loop(planar) => {
                // A start is the mean of many samples at rest, so the noise of one is not in it.
                let rest = PlanarImu { x: ax, z: az, rate: readings.rate };
                let mut now = state.unwrap_or_else(|| begin_loop(planar, s, &rest, first_thrust));
                let truth =
                    (s.feedback == Feedback::State).then(|| PlanarState::from_array(plant.state));
                let input = PlanarInput { imu, acting: None, state: truth };
                let Ok(command) = planar.step(&mut now, &input, &reference) else {
                    has_diverged = true;
                    break;
                };
                let estimate = now.observer().estimate();
                let [a, b] = now.observer().branches();
                row.estimate = estimate.state.to_array();
                row.link_force_estimate = estimate.specific_link_force * nominal.mass();
                row.residuals = [a.error, b.error];
                row.selected = estimate.branch as u8;
                (row.thrust, row.torque) = (command.thrust, command.torque);
                state = Some(now);
            }
            Controller::Static(law) => {
                let [phi, phi1, phi2, ..] = reference.elevation;
                let x = PlanarState::from_array(plant.state);
                let Ok((thrust, torque)) = law.step(&x, &[phi, phi1, phi2], &reference.second)
                else {
                    has_diverged = true;
                    break;
                };
                (row.thrust, row.torque) = (thrust, torque);
            }
        }
        errors.add(&row, s.law == LawKind::Force);
        rows.push(row);
        plant.step(row.thrust, row.torque, dt, s.substeps);
        if plant.has_diverged() {
            has_diverged = true;
            break;
        }
    }
    Ok(Trace { summary: errors.summary(has_diverged), rows })
}

fn begin_loop(
    planar: &PlanarLoop<f64>,
    s: &PlanarScenario,
    imu: &PlanarImu<f64>,
    thrust: f64,
) -> PlanarLoopState<f64> {
    let observer = planar.observer().quasi_static(imu, thrust).displaced(s.start.observer_offset);
    planar.start_from(observer, thrust)
}

/// What the core's own checks leave open.
fn check(s: &PlanarScenario) -> Result<(), String> {
    let r = &s.reference;
    let ranges = [
        ("rate_hz", s.rate_hz, 5.0, 1e5),
        ("substeps", f64::from(s.substeps), 1.0, 1000.0),
        ("reference.start", r.start, 0.0, 1e3),
        ("reference.duration", r.duration, 0.01, 1e3),
        ("reference.hold", r.hold, 0.0, 1e3),
        ("plant.link_mass", s.plant.link_mass, 0.0, 1e3),
        ("plant.attachment[0]", s.plant.attachment[0], -10.0, 10.0),
        ("plant.attachment[1]", s.plant.attachment[1], -10.0, 10.0),
        ("plant.motor_lag", s.plant.motor_lag, 0.0, 10.0),
        ("noise.accel_variance", s.noise.accel_variance, 0.0, 1e4),
        ("noise.gyro_variance", s.noise.gyro_variance, 0.0, 1e4),
    ];
    for (key, value, min, max) in ranges {
        crate::scenario::within(key, value, min, max)?;
    }
    if !s.start.state_offset.iter().chain(&s.start.observer_offset).all(|x| x.is_finite()) {
        return Err("start: offsets must be finite".into());
    }
    if s.end() * s.rate_hz > 1e7 {
        return Err("reference: over ten million samples".into());
    }
    Ok(())
}

impl Row {
    /// Elevation error, rad, wrapped.
    #[must_use]
    pub fn elevation_error(&self) -> f64 {
        wrap_pi(self.elevation_reference - self.state[0])
    }
}
