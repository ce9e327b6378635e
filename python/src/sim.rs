//! One flight, advanced from Python.

use crate::input::{self, wrong};
use crate::observe::observation;
use crate::sensors::sensors;
use crate::truth::truth;
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use pythonize::pythonize;
use tautline_firmware::param::{META, Params};
use tautline_firmware::signal::PerRotor;
use tautline_sitl::flight::{Flight, Gathered, Hand, Progress};
use tautline_sitl::scenario::{FaultKind, Step, set_param, standard_mission};

/// Simulated ms between two looks for Ctrl-C: a fraction of a real one.
const PATIENCE: u64 = 500;

/// The firmware's own flight of a scenario.
#[pyclass(module = "tautline._native")]
pub struct Sim {
    flight: Flight<Vec<u8>>,
    gathered: Option<Gathered>,
    /// Texts of the vehicle that were told.
    told: usize,
}

/// The object that a flight's `--json` prints.
fn verdict<'py>(py: Python<'py>, flight: &Flight<Vec<u8>>) -> PyResult<Bound<'py, PyAny>> {
    // By way of JSON's own types: a list is a list.
    let object = serde_json::to_value(flight.verdict()).map_err(wrong)?;
    Ok(pythonize(py, &object)?)
}

impl Sim {
    /// Steps until `ends` says so or Python has a signal.
    fn advance(
        &mut self,
        py: Python,
        mut ends: impl FnMut(&mut Flight<Vec<u8>>) -> bool + Send,
    ) -> PyResult<()> {
        loop {
            let Self { flight, gathered, .. } = self;
            let is_over = py.detach(|| {
                for _ in 0..PATIENCE {
                    if ends(flight) {
                        return true;
                    }
                    let out = flight.step(&mut |_| {});
                    if let Some(gathered) = gathered {
                        gathered.take(out);
                    }
                }
                false
            });
            if is_over {
                return Ok(());
            }
            py.check_signals()?;
        }
    }

    fn hand(&mut self, hand: &Hand) {
        self.flight.by_hand(hand);
    }

    /// By the file's name of it, or a former one.
    fn kind(name: &str) -> PyResult<FaultKind> {
        toml::Value::from(name).try_into().map_err(wrong)
    }
}

#[pymethods]
impl Sim {
    /// `standard`: a scenario without a mission has the standard one. `returns`: after each hold the vehicle is asked
    /// back to Tether Hold, for whoever flies the holds by hand.
    #[new]
    #[pyo3(signature = (scenario, seed = 1, params = None, *, log = false, standard = false, returns = false))]
    fn new(
        scenario: &Bound<PyAny>,
        seed: u64,
        params: Option<&Bound<PyAny>>,
        log: bool,
        standard: bool,
        returns: bool,
    ) -> PyResult<Self> {
        let mut scenario = input::scenario(scenario)?;
        if standard && scenario.mission.is_empty() {
            scenario.mission = standard_mission();
        }
        if returns {
            let back = |step: Step| match step {
                Step::Hold { .. } => vec![step, Step::TetherHold],
                _ => vec![step],
            };
            scenario.mission = scenario.mission.into_iter().flat_map(back).collect();
        }
        let params = input::params(&scenario, params)?;
        let flight = match log {
            true => Flight::new(&scenario, params, seed, Vec::new()),
            false => Flight::start(&scenario, params, seed).map(|mut flight| {
                flight.world.is_heard = false;
                flight
            }),
        };
        let mut flight = flight.map_err(wrong)?;
        flight.mission.stay();
        Ok(Self { flight, gathered: None, told: 0 })
    }

    /// `n` ms.
    fn step(&mut self, py: Python, n: u64) -> PyResult<()> {
        let mut left = n;
        self.advance(py, |_| {
            let is_over = left == 0;
            left = left.saturating_sub(1);
            is_over
        })
    }

    /// Until the mission and its epilogue are over, or for `limit` s.
    fn fly(&mut self, py: Python, limit: f64) -> PyResult<()> {
        self.advance(py, |flight| flight.world.time() >= limit || flight.is_over())
    }

    /// Until the mission has nothing left, or for `limit` s.
    fn finish(&mut self, py: Python, limit: f64) -> PyResult<()> {
        self.advance(py, |flight| {
            flight.world.time() >= limit || *flight.mission.progress() != Progress::Flying
        })
    }

    fn is_over(&mut self) -> bool {
        self.flight.is_over()
    }

    #[getter]
    fn time(&self) -> f64 {
        self.flight.world.time()
    }

    /// `flying`, `done` or `failed`, and why.
    #[getter]
    fn mission(&self) -> (&'static str, Option<String>) {
        match self.flight.mission.progress() {
            Progress::Flying => ("flying", None),
            Progress::Done => ("done", None),
            Progress::Failed(why) => {
                ("failed", self.flight.shortcoming().or_else(|| Some(why.clone())))
            }
        }
    }

    #[getter]
    fn is_holding(&self) -> bool {
        self.flight.mission.is_holding()
    }

    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        observation(py, self.time(), self.flight.output(), self.flight.reference())
    }

    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        truth(py, self.time(), &self.flight.world.environment.plant)
    }

    /// Since the last call; the first only begins.
    fn sensors<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let read = self.gathered.get_or_insert_default().read(self.flight.output());
        sensors(py, self.time(), &read)
    }

    /// Texts of the vehicle since the last call, with their times, s.
    fn texts(&mut self) -> Vec<(f64, String)> {
        let new = self.flight.events.iter().skip(self.told);
        let texts = new.map(|(time, event)| (*time, event.to_string())).collect();
        self.told = self.flight.events.len();
        texts
    }

    /// From now on: a fault as the scenario file spells it, without a time.
    fn inject(&mut self, fault: &Bound<PyDict>) -> PyResult<()> {
        let file = PyDict::new(fault.py());
        file.set_item("fault", [fault])?;
        let world = &mut self.flight.world;
        for mut fault in input::scenario(&file)?.fault {
            // Times of faults count from power-up.
            fault.at = world.now().0 as f64 * 1e-6;
            world.environment.faults.add(fault);
        }
        Ok(())
    }

    /// Ends every fault of a kind.
    fn heal(&mut self, kind: &str) -> PyResult<()> {
        self.flight.world.environment.faults.clear(Self::kind(kind)?);
        Ok(())
    }

    #[getter]
    fn faults(&self) -> Vec<&'static str> {
        self.flight.world.environment.active_faults()
    }

    /// One more step of the mission, as the scenario file spells it; `alone`: instead of what is still to be flown.
    fn ask(&mut self, step: &Bound<PyAny>, alone: bool) -> PyResult<()> {
        let step = input::step(step)?;
        if alone {
            self.flight.mission.drop_rest();
        }
        self.flight.mission.ask(step, self.flight.world.time());
        Ok(())
    }

    fn param(&self, name: &str) -> PyResult<f64> {
        let params = self.flight.world.vehicle.params();
        let value = Params::index_of(name.as_bytes()).and_then(|index| params.get(index));
        value.map(f64::from).ok_or_else(|| wrong(format!("no parameter {name}")))
    }

    /// By MAVLink; it holds from the next step on.
    fn set_param(&mut self, name: &str, value: f64) -> PyResult<()> {
        let world = &mut self.flight.world;
        let mut trial = *world.vehicle.params();
        set_param(&mut trial, name, value as f32).map_err(wrong)?;
        if let Some(meta) = META.iter().find(|meta| meta.name == name) {
            self.flight.mission.set_parameter(meta, value as f32, &mut |frame| {
                world.receive(frame, &mut |_| {});
            });
        }
        Ok(())
    }

    /// Set-point: from the anchor, NED, m, and heading, rad.
    fn set_place(&mut self, position: [f32; 3], yaw: f32) {
        self.hand(&Hand::Place(position, yaw));
    }

    /// Set-point: body to world, `[w, x, y, z]`, and thrust, N.
    fn set_attitude(&mut self, attitude: [f32; 4], thrust: f32) {
        self.hand(&Hand::Attitude(attitude, thrust));
    }

    /// Set-point: body rates, rad/s, and thrust, N.
    fn set_rates(&mut self, rate: [f32; 3], thrust: f32) {
        self.hand(&Hand::Rates(rate, thrust));
    }

    /// Each rotor, 0..1, past the firmware.
    fn set_throttle(&mut self, throttle: Vec<f32>) -> PyResult<()> {
        let count = self.flight.world.environment.plant.rotors.len();
        if throttle.len() != count {
            return Err(PyTypeError::new_err(format!("{count} throttles are expected")));
        }
        if !throttle.iter().all(|x| x.is_finite()) {
            return Err(wrong("a throttle is not finite"));
        }
        let mut all = PerRotor::all(count, 0.0);
        all.iter_mut().zip(throttle).for_each(|(to, from)| *to = from.clamp(0.0, 1.0));
        self.hand(&Hand::Throttle(all));
        Ok(())
    }

    /// The firmware flies by itself again.
    fn let_go(&mut self) {
        self.flight.let_go();
    }

    fn verdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        verdict(py, &self.flight)
    }

    /// Ends the log; its bytes.
    fn finish_log<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        match self.flight.finish_log()? {
            Some(log) => Ok(PyBytes::new(py, &log)),
            None => Err(PyRuntimeError::new_err("no log is kept, or it has ended")),
        }
    }
}
