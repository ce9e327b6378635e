//! An estimator of one's own beside a flight: where the vehicle is, by the direction of the tether's pull.
//!
//! `cargo run -p tautline-sitl --example own_estimator -- sitl/scenarios/calm.toml`; `docs/own-estimator.md` walks
//! through it.

use tautline_firmware::estimate::Fault;
use tautline_firmware::frames::{Attitude, Body, V3, World};
use tautline_firmware::scalar::Scalar;
use tautline_firmware::supervisor::GroundState;
use tautline_sitl::flight::Flight;
use tautline_sitl::scenario::Scenario;

/// What it is set to; nothing here moves.
#[derive(Clone, Copy, Debug)]
pub struct PullLocator<S> {
    /// Mass, kg.
    pub mass: S,
    /// Time constant of the pull's low-pass, s.
    pub smoothing: S,
}

/// All that moves: the pull on the vehicle, low-passed, world axes, N. `None` before the first reading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PullState<S: Scalar> {
    pull: Option<V3<S>>,
}

/// One set of readings.
#[derive(Clone, Copy, Debug)]
pub struct PullMeasurement<S: Scalar> {
    /// Body to world.
    pub attitude: Attitude<S>,
    /// Specific force, m/s².
    pub accel: Body<V3<S>>,
    /// Total thrust along the body's up axis, N.
    pub thrust: S,
    /// Distance from the anchor, m.
    pub length: S,
}

impl<S: Scalar> PullLocator<S> {
    /// One step of `dt` s: the place from the anchor, m.
    ///
    /// # Errors
    /// An input that is not finite, or a slack tether; the state is left alone.
    pub fn step(
        &self,
        state: &mut PullState<S>,
        z: &PullMeasurement<S>,
        dt: S,
    ) -> Result<World<V3<S>>, Fault> {
        // The accelerometer feels all forces but gravity. Without thrust what is left is the pull, and the wind.
        let thrust = Body(V3::new(S::zero(), S::zero(), -z.thrust));
        let felt = z.attitude.to_world(Body(z.accel.0 * self.mass - thrust.0)).0;
        let last = state.pull.unwrap_or(felt);
        let pull = last + (felt - last) * (dt / (self.smoothing + dt));
        if !pull.iter().chain([&z.length]).all(|x| x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        let size = pull.dot(&pull).sqrt();
        if size < S::lit(0.1) {
            return Err(Fault::Degenerate);
        }
        state.pull = Some(pull);
        // The tether pulls towards the anchor.
        Ok(World(pull * (-z.length / size)))
    }
}

/// Root of the mean square, m.
#[derive(Debug, Default)]
struct Errors {
    sum: f64,
    count: u32,
}

impl Errors {
    fn add(&mut self, error: f64) {
        self.sum += error * error;
        self.count += 1;
    }
    fn rms(&self) -> f64 {
        (self.sum / f64::from(self.count.max(1))).sqrt()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: own_estimator FILE.toml")?;
    let scenario = Scenario::load(file.as_ref())?;
    let params = scenario.params()?;
    let mut flight = Flight::unrecorded(&scenario, params, 1)?;

    let locator = PullLocator { mass: params.mass, smoothing: 2.0 };
    let mut state = PullState::default();
    let (mut length, mut ours, mut firmware) = (None, Errors::default(), Errors::default());
    while !flight.is_over() {
        let out = *flight.step(&mut |_| {});
        length = out.sensors.tether_length.map(|sample| sample.value).or(length);
        let (Some(imu), Some(length), GroundState::InAir) = (out.sensors.imu, length, out.ground)
        else {
            state = PullState::default();
            continue;
        };
        let z = PullMeasurement {
            attitude: out.estimate.attitude,
            accel: imu.value.accel,
            thrust: out.estimate.thrust,
            length,
        };
        let truth = flight.world.environment.plant.from_anchor();
        if let (Ok(place), Some(known)) =
            (locator.step(&mut state, &z, 1e-3), out.estimate.position)
        {
            ours.add((place.0.map(f64::from) - truth).norm());
            firmware.add((known.0.map(f64::from) - truth).norm());
        }
    }
    println!(
        "place in the air, rms: by the pull {:.2} m, the firmware {:.2} m",
        ours.rms(),
        firmware.rms()
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(accel: V3<f32>, length: f32) -> PullMeasurement<f32> {
        PullMeasurement { attitude: Attitude::level(0.0), accel: Body(accel), thrust: 18.0, length }
    }

    #[test]
    fn at_rest_it_looks_along_the_pull_of_the_tether() {
        let locator = PullLocator { mass: 1.5, smoothing: 2.0 };
        // 4 N to the South and 3 N down, under 18 N of thrust.
        let z = reading(V3::new(-4.0, 0.0, 3.0 - 18.0) / 1.5, 10.0);
        let place = locator.step(&mut PullState::default(), &z, 1e-3);
        assert!((place.unwrap().0 - V3::new(8.0, 0.0, -6.0)).norm() < 1e-4, "{place:?}");
    }

    #[test]
    fn what_is_not_finite_is_refused_and_leaves_the_state_alone() {
        let locator = PullLocator { mass: 1.5, smoothing: 2.0 };
        let mut state = PullState { pull: Some(V3::new(-4.0, 0.0, 3.0)) };
        let before = state;
        for z in [reading(V3::new(f32::NAN, 0.0, -9.8), 10.0), reading(V3::zeros(), f32::NAN)] {
            assert_eq!(locator.step(&mut state, &z, 1e-3), Err(Fault::NotFinite));
            assert_eq!(state, before);
        }
    }
}
