//! The physical world without the firmware: one, and many at once.

use crate::input::{self, wrong};
use crate::truth::truth;
use nalgebra::{Quaternion, UnitQuaternion};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::f64::consts::PI;
use tautline_sitl::flight::quaternion;
use tautline_sitl::plant::{self, PlantBatch, PlantModel, TICK, V3, generator, uniform};
use tautline_sitl::scenario::Scenario;

/// Numbers of a row of state before the rotors' speeds: see `STATE` in the stubs.
const FIXED: usize = 19;

/// At the start, as a flight of that seed has it.
fn at_start(scenario: &Scenario, seed: u64) -> plant::Plant {
    let wind_from = uniform(&mut generator(seed, 3)) * PI;
    let (distance, heading) = scenario.start();
    plant::Plant::new(PlantModel::new(scenario, wind_from), distance, heading, seed)
}

/// Position, velocity, attitude, rate, tension, length, height, touches, wind, rotors' speeds.
fn write_state(plant: &plant::Plant, row: &mut [f64]) {
    let body = &plant.body;
    let [px, py, pz] = plant.from_anchor().into();
    let [vx, vy, vz] = body.velocity.into();
    let [w, x, y, z] = quaternion(&body.attitude);
    let [p, q, r] = body.rate.into();
    let [north, east, down] = plant.wind.velocity.into();
    let touches = f64::from(u8::from(plant.ground.is_touching()));
    let (tension, length) = (plant.tether.tension(), plant.tether.length());
    let fixed: [f64; FIXED] =
        [px, py, pz, vx, vy, vz, w, x, y, z, p, q, r, tension, length, touches, north, east, down];
    let values = fixed.into_iter().chain(plant.rotors.iter().map(|rotor| rotor.speed));
    row.iter_mut().zip(values).for_each(|(slot, value)| *slot = value);
}

fn width(plant: &plant::Plant) -> usize {
    FIXED + plant.rotors.len()
}

/// Puts a vehicle at rest in the air; its line is straight.
fn hang(plant: &mut plant::Plant, position: [f64; 3]) -> PyResult<()> {
    if position.iter().all(|x| x.is_finite()) {
        plant.hang(V3::from(position));
        Ok(())
    } else {
        Err(wrong("a position is not finite"))
    }
}

/// One world.
#[pyclass(module = "tautline._native")]
pub struct Plant {
    plant: plant::Plant,
    ticks: u64,
}

#[pymethods]
impl Plant {
    #[new]
    fn new(scenario: &Bound<PyAny>, seed: u64) -> PyResult<Self> {
        Ok(Self { plant: at_start(&input::scenario(scenario)?, seed), ticks: 0 })
    }

    #[getter]
    fn time(&self) -> f64 {
        self.ticks as f64 * TICK
    }

    #[getter]
    fn rotors(&self) -> usize {
        self.plant.rotors.len()
    }

    /// At full throttle and nominal voltage, rad/s.
    #[getter]
    fn rotor_speed_max(&self) -> f64 {
        self.plant.model().rotor.speed_max
    }

    /// `n` ms of the same throttles and tension, N.
    fn step(&mut self, py: Python, throttle: Vec<f64>, tension: f64, n: u64) -> PyResult<()> {
        if throttle.len() != self.plant.rotors.len() {
            return Err(wrong(format!("{} throttles are expected", self.plant.rotors.len())));
        }
        if !throttle.iter().chain([&tension]).all(|x| x.is_finite()) {
            return Err(wrong("a throttle or the tension is not finite"));
        }
        self.ticks += n;
        py.detach(|| (0..n).for_each(|_| self.plant.step(&throttle, tension)));
        Ok(())
    }

    fn hang(&mut self, position: [f64; 3]) -> PyResult<()> {
        hang(&mut self.plant, position)
    }

    /// Velocity, m/s, attitude `[w, x, y, z]` and body rates, rad/s.
    fn set_motion(
        &mut self,
        velocity: [f64; 3],
        attitude: [f64; 4],
        rate: [f64; 3],
    ) -> PyResult<()> {
        let all = velocity.iter().chain(&attitude).chain(&rate);
        let [w, x, y, z] = attitude;
        let attitude = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6);
        let (Some(attitude), true) = (attitude, all.copied().all(f64::is_finite)) else {
            return Err(wrong("a motion is not finite, or the attitude is none"));
        };
        let body = &mut self.plant.body;
        (body.velocity, body.attitude, body.rate) = (V3::from(velocity), attitude, V3::from(rate));
        Ok(())
    }

    fn state<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let mut row = vec![0.0; width(&self.plant)];
        write_state(&self.plant, &mut row);
        PyArray1::from_vec(py, row)
    }

    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        truth(py, self.time(), &self.plant)
    }
}

/// Many worlds of one scenario, each with a seed of its own.
#[pyclass(module = "tautline._native")]
pub struct Batch {
    batch: PlantBatch,
    scenario: Scenario,
    pool: rayon::ThreadPool,
}

#[pymethods]
impl Batch {
    /// `threads`: 0 = one a core.
    #[new]
    fn new(scenario: &Bound<PyAny>, seeds: Vec<u64>, threads: usize) -> PyResult<Self> {
        let scenario = input::scenario(scenario)?;
        if seeds.is_empty() {
            return Err(wrong("a batch has at least one world"));
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(wrong)?;
        let worlds = seeds.into_iter().map(|seed| at_start(&scenario, seed)).collect();
        Ok(Self { batch: PlantBatch::new(worlds), scenario, pool })
    }

    /// `n` ms: throttles `(worlds, rotors)` and the winch's tension, N.
    fn step(
        &mut self,
        py: Python,
        throttle: PyReadonlyArray2<f64>,
        tension: f64,
        n: u64,
    ) -> PyResult<()> {
        let worlds = self.batch.worlds().len();
        let rotors = self.batch.worlds().first().map_or(0, |world| world.rotors.len());
        if throttle.shape() != [worlds, rotors] {
            return Err(wrong(format!(
                "throttle has the shape {:?}, not ({worlds}, {rotors})",
                throttle.shape(),
            )));
        }
        let throttle = throttle.as_slice().map_err(wrong)?;
        if !throttle.iter().chain([&tension]).all(|x| x.is_finite()) {
            return Err(wrong("a throttle or the tension is not finite"));
        }
        let Self { batch, pool, .. } = self;
        py.detach(|| {
            let (size, parts) = batch.parts();
            let rows = throttle.par_chunks(size * rotors.max(1));
            pool.install(|| {
                parts
                    .into_par_iter()
                    .zip(rows)
                    .for_each(|(mut part, rows)| part.step(rows, tension, n));
            });
        });
        Ok(())
    }

    /// One world anew, by another seed, in the air at `position` or on the ground.
    #[pyo3(signature = (index, seed, position = None))]
    fn reset(&mut self, index: usize, seed: u64, position: Option<[f64; 3]>) -> PyResult<()> {
        let mut world = at_start(&self.scenario, seed);
        if let Some(position) = position {
            hang(&mut world, position)?;
        }
        match self.batch.replace(index, world) {
            true => Ok(()),
            false => Err(wrong(format!("no world {index}"))),
        }
    }

    /// `(worlds, 19 + rotors)`.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let worlds = self.batch.worlds();
        let width = worlds.first().map_or(0, width);
        let array = PyArray2::zeros(py, [worlds.len(), width], false);
        let mut view = array.try_readwrite()?;
        let rows = view.as_slice_mut().map_err(wrong)?;
        worlds.iter().zip(rows.chunks_mut(width)).for_each(|(world, row)| {
            write_state(world, row);
        });
        drop(view);
        Ok(array)
    }
}
