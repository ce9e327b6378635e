//! A mission flown to its end, and why it counts as lost.

use crate::campaign::parallel;
use crate::flight::{Flight, Progress};
use crate::metrics::Summary;
use crate::scenario::Scenario;
use std::io::Write;
use tautline_firmware::signal::Severity;

/// Name of a flight's figure with its unit, and where it is.
pub type Figure = (&'static str, fn(&Summary) -> Option<f64>);

/// Why lost, or why the mission was not flown; the first critical event explains more than the last step of a
/// mission that went wrong.
pub fn why_lost<W: Write>(flight: &Flight<W>) -> Option<String> {
    if let Some(why) = flight.metrics.summary().lost {
        return Some(why.to_owned());
    }
    if *flight.mission.progress() == Progress::Done {
        return None;
    }
    let events = || flight.events.iter().map(|(_, event)| event);
    let event =
        events().find(|event| event.severity <= Severity::Critical).or(events().next_back());
    Some(format!("not flown: {}", event.map_or_else(|| "nothing".into(), ToString::to_string)))
}

/// How a flight went, and why it counts as lost.
pub type Flown = (Summary, Option<String>);

/// A scenario flown with each seed, for `longest` simulated s at most.
pub fn fly_all(scenario: &Scenario, seeds: &[u64], longest: f64) -> Result<Vec<Flown>, String> {
    let params = scenario.params().map_err(|e| e.0)?;
    let fly = |seed: &u64| -> Result<Flown, String> {
        let mut flight = Flight::unrecorded(scenario, params, *seed).map_err(|e| e.0)?;
        flight.fly(longest);
        Ok((flight.metrics.summary(), why_lost(&flight)))
    };
    parallel::map(seeds, parallel::cores(), fly, |_| {}).into_iter().collect()
}
