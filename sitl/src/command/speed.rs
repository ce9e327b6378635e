//! `cargo sitl speed`: what simulated time costs, for `cargo xtask speed` and for whoever plans a campaign.

use super::Failure;
use crate::flight::Flight;
use crate::plant::{Plant, PlantModel, TICK, V3};
use crate::scenario::{Scenario, standard_mission};
use clap::Args;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

/// Options of a measurement.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  cargo sitl speed --flights 20 --scenario sitl/scenarios/gusts-3.toml"
)]
pub struct Options {
    /// The simulated world alone, hovering: no sensors, no firmware
    #[arg(long)]
    plant: bool,
    /// Simulated time of the world alone, and the longest of a flight
    #[arg(long, value_name = "S", default_value_t = 120.0)]
    seconds: f64,
    /// How many flights, as a campaign flies them
    #[arg(long, value_name = "N", default_value_t = 10)]
    flights: u64,
    /// What is simulated; without a mission, take-off, hold, move, landing
    #[arg(long, value_name = "FILE.toml")]
    scenario: Option<PathBuf>,
    /// One JSON object
    #[arg(long)]
    json: bool,
}

/// Ticks of free hover before it begins anew: without firmware the world would tip over.
const RESTART: u32 = 500;

/// Processor time of this process, s; where the system does not tell, time since `began`.
fn cpu_seconds(began: Instant) -> f64 {
    #[cfg(target_os = "linux")]
    {
        use nix::sys::resource::{UsageWho, getrusage};
        use nix::sys::time::TimeValLike;
        if let Ok(usage) = getrusage(UsageWho::RUSAGE_SELF) {
            let used = usage.user_time() + usage.system_time();
            return used.num_microseconds() as f64 * 1e-6;
        }
    }
    began.elapsed().as_secs_f64()
}

/// Simulated seconds of the world alone.
fn hover(scenario: &Scenario, seconds: f64) -> f64 {
    let model = PlantModel::new(scenario, 0.0);
    let (v, tension) = (&scenario.vehicle, 6.0);
    let most = v.thrust_coefficient * v.rotor_speed_max * v.rotor_speed_max;
    let lift = (v.mass * crate::plant::GRAVITY + tension) / model.rotor.hubs.len() as f64;
    let throttle = vec![(lift / most).powf(0.5 / v.throttle_curve); model.rotor.hubs.len()];
    let mut start = Plant::new(model, 1.0, 0.0, 1);
    start.hang(V3::new(1.0, 0.0, -5.0));
    let mut plant = start.clone();
    let ticks = (seconds / TICK).round() as u32;
    for tick in 0..ticks {
        if tick.is_multiple_of(RESTART) {
            plant.clone_from(&start);
        }
        plant.step(&throttle, tension);
    }
    black_box(&plant);
    f64::from(ticks) * TICK
}

/// Simulated seconds of so many flights.
fn fly(scenario: &Scenario, flights: u64, longest: f64) -> Result<f64, Failure> {
    let params = scenario.params().map_err(|e| Failure::Usage(e.0))?;
    let mut simulated = 0.0;
    for seed in 1..=flights {
        let mut flight =
            Flight::unrecorded(scenario, params, seed).map_err(|e| Failure::Run(e.0))?;
        flight.fly(longest);
        simulated += flight.world.time();
    }
    Ok(simulated)
}

/// Measures.
pub fn run(options: &Options) -> Result<(), Failure> {
    let mut scenario = match &options.scenario {
        Some(path) => Scenario::load(path).map_err(|e| Failure::Usage(e.0))?,
        None => Scenario::default(),
    };
    if scenario.mission.is_empty() {
        scenario.mission = standard_mission();
    }
    if !(options.seconds > 0.0 && options.seconds <= 1e6) {
        return Err(Failure::Usage(format!("--seconds {} is outside 0 to 1e6", options.seconds)));
    }
    let began = Instant::now();
    let before = cpu_seconds(began);
    let simulated = if options.plant {
        hover(&scenario, options.seconds)
    } else {
        fly(&scenario, options.flights, options.seconds)?
    };
    let used = cpu_seconds(began) - before;
    let ratio = simulated / used.max(1e-6);
    if options.json {
        say!(
            "{{\"simulated_s\":{simulated:.3},\"cpu_s\":{used:.4},\"simulated_per_cpu\":{ratio:.1}}}"
        );
    } else {
        say!("{simulated:.1} s simulated in {used:.2} s of processor time: {ratio:.0} x");
    }
    Ok(())
}
