//! Thousands of random flights, in each of which every rule of the house is looked at in every step.

mod plan;
mod rules;

use super::{Compare, Overrides, Report};
use crate::campaign::parallel;
use crate::flight::Flight;
use crate::plant::TICK;
use plan::{BUSY, Plan};
use rules::{Claim, Memory, RULES, View};
use std::collections::HashMap;
use std::io::Sink;
use tautline_firmware::signal::Event;

/// Random flights without a wish of the user's.
const SEEDS: u64 = 1000;
/// Until the vehicle stands again, s.
const LONGEST: f64 = 400.0;
/// It rests so long with its motors off before the flight counts as over, s.
const OVER: f64 = 2.0;
/// Height from which it has flown, m.
const FLOWN: f64 = 0.5;
/// Counter-examples that are printed of a rule.
const SHOWN: usize = 5;

/// A rule that was broken.
struct Breach {
    rule: usize,
    seed: u64,
    at: f64,
    about: String,
}

/// A flight.
struct Flown {
    breaches: Vec<Breach>,
    /// What the operator read.
    story: Vec<String>,
}

/// All of it.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    let seeds = settings.seeds(SEEDS)?;
    settings.refuse(|path| path != super::SEEDS)?;
    let flown = parallel::map(&seeds, parallel::cores(), |seed| fly(*seed), |_| {});
    let flown = flown.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut report = Report::default();
    // One that is looked at tells its story.
    if let [Flown { story, .. }] = flown.as_slice() {
        report.notes.clone_from(story);
    }
    let breaches: Vec<Breach> = flown.into_iter().flat_map(|flown| flown.breaches).collect();
    for (at, rule) in RULES.iter().enumerate() {
        let broken = breaches.iter().filter(|breach| breach.rule == at);
        report.add(rule.text, broken.clone().count() as f64, Compare::AtMost(0.0));
        for Breach { seed, at, about, .. } in broken.take(SHOWN) {
            report.notes.push(format!("{}: seed {seed} at {at:.3} s: {about}", rule.text));
        }
    }
    report.notes.push(format!("{} flights.", seeds.len()));
    Ok(report)
}

/// Looks at a flight.
struct Watch {
    memory: Memory,
    /// Since when what must not last is so, for each rule.
    since: [Option<f64>; RULES.len()],
    /// Broken already: told once a flight.
    broken: [bool; RULES.len()],
    /// When each text came last, and how often in a row.
    texts: HashMap<&'static str, (f64, u32)>,
}

impl Watch {
    fn new() -> Self {
        Self {
            memory: Memory::default(),
            since: [None; RULES.len()],
            broken: [false; RULES.len()],
            texts: HashMap::new(),
        }
    }

    fn remember(&mut self, flight: &Flight<Sink>, time: f64) {
        let (out, memory) = (flight.output(), &mut self.memory);
        let plant = &flight.world.environment.plant;
        let (height, over) = (plant.height_over_ground(), rules::height(plant));
        memory.has_flown = out.is_armed && (memory.has_flown || height > FLOWN);
        memory.lowest = (out.is_armed && out.mode.lands())
            .then(|| memory.lowest.map_or(over, |low: f64| low.min(over)));
        memory.repeated = 0;
        if out.reply.is_none() {
            for event in out.events.iter() {
                let (last, count) = self.texts.entry(event.text).or_insert((time, 0));
                *count = if time - *last < 1.0 { *count + 1 } else { 1 };
                *last = time;
                memory.repeated = memory.repeated.max(*count);
            }
        }
    }

    /// Rules that this step breaks.
    fn look(&mut self, view: &View<'_>, time: f64, is_simple: bool) -> Vec<usize> {
        let mut fresh = Vec::new();
        let states = self.since.iter_mut().zip(&mut self.broken);
        for (at, (rule, (since, broken))) in RULES.iter().zip(states).enumerate() {
            if *broken || (rule.is_physical && !is_simple) {
                continue;
            }
            *broken = match rule.claim {
                Claim::Always(holds) => !holds(view),
                Claim::Within(most, when, then) if when(view) && !then(view) => {
                    time - *since.get_or_insert(time) > most
                }
                Claim::Within(..) => {
                    *since = None;
                    false
                }
            };
            if *broken {
                fresh.push(at);
            }
        }
        fresh
    }
}

fn fly(seed: u64) -> Result<Flown, String> {
    let plan = Plan::of_seed(seed)?;
    let mut flight = Flight::unrecorded(&plan.scenario, plan.params, seed).map_err(|e| e.0)?;
    let is_simple = plan.is_simple();
    let mut asks = plan.asks.iter().peekable();
    let (mut watch, mut breaches) = (Watch::new(), Vec::new());
    let (mut before, mut params_before) = (*flight.output(), plan.params);
    let mut stood = 0.0;
    while flight.world.time() < LONGEST && (stood < OVER || flight.world.time() < BUSY) {
        let time = flight.world.time();
        while let Some((_, ask)) = asks.next_if(|(at, _)| *at <= time) {
            let datagram = ask.datagram(plan.params.system_id as u8);
            flight.world.receive(&datagram, &mut |_| {});
        }
        flight.step(&mut |_| {});
        watch.remember(&flight, time);
        let (now, params) = (flight.output(), flight.world.vehicle.params());
        stood = if now.is_armed { 0.0 } else { stood + TICK };
        let view = View {
            now,
            before: &before,
            plant: &flight.world.environment.plant,
            params,
            params_before: &params_before,
            memory: watch.memory,
        };
        for rule in watch.look(&view, time, is_simple) {
            let said = now.events.iter().map(|event| event.text).collect::<Vec<_>>().join(", ");
            let about = format!("{}, \"{said}\": {}", now.mode.rule().name, plan.about(time));
            breaches.push(Breach { rule, seed, at: time, about });
        }
        (before, params_before) = (*now, *params);
    }
    let tell = |(time, event): &(f64, Event)| format!("{time:8.1} s  {event}");
    let mut events = flight.events.clone();
    events.dedup_by_key(|(_, event)| event.text);
    Ok(Flown { breaches, story: events.iter().map(tell).collect() })
}
