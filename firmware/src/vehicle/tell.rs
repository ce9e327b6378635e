//! What the operator should know of the estimate, each once.

use super::Vehicle;
use crate::scalar::Scalar;
use crate::signal::{AidReport, AltimeterReport, Event, EventQueue};

/// Standard deviations of the heading, rad, that are told, and how: 5 degrees, so that 15 are hardly ever passed unknown.
const UNSURE: [(f64, &str); 2] = [
    (0.087, "Heading unsure: nothing measures it"),
    (0.26, "Heading lost: land, or say where the nose points"),
];

const RANGE_REJECTED: &str = "Rangefinder contradicts: flying by barometer";
const BARO_REJECTED: &str = "Barometer contradicts: not used";

/// What was told.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    restarts: u16,
    length_jumps: u16,
    aids: AidReport,
    altimeters: AltimeterReport,
    /// Of [`UNSURE`].
    heading: usize,
}

impl<S: Scalar> Vehicle<S> {
    pub(super) fn tell(&mut self, events: &mut EventQueue) {
        let (estimate, told) = (&self.situation.estimate, &mut self.state.told);
        if estimate.restarts > told.restarts {
            events.push(Event::warning("Position filter began anew"));
        }
        told.restarts = estimate.restarts;
        if estimate.length_jumps > told.length_jumps {
            events.push(Event::warning("Line length jumped: taken out"));
        }
        told.length_jumps = estimate.length_jumps;
        let altimeters = self.state.altimeters;
        let news = [
            (altimeters.range_is_rejected, told.altimeters.range_is_rejected, RANGE_REJECTED),
            (altimeters.baro_is_rejected, told.altimeters.baro_is_rejected, BARO_REJECTED),
        ];
        for (_, _, text) in news.into_iter().filter(|(now, before, _)| *now && !before) {
            events.push(Event::warning(text));
        }
        told.altimeters = altimeters;
        let aids = estimate.aids;
        for aid in aids.rejected.without(told.aids.rejected).iter() {
            events.push(Event::warning(aid.contradiction()));
        }
        for aid in aids.silent.without(told.aids.silent).iter() {
            events.push(Event::warning(aid.silence()));
        }
        told.aids = aids;
        let is_armed = self.situation.armed_at.is_some();
        let passed = UNSURE.iter().filter(|(sd, _)| estimate.heading_sd > S::lit(*sd)).count();
        let passed = if is_armed { passed } else { 0 };
        if passed > told.heading
            && let Some((_, text)) = UNSURE.get(passed - 1)
        {
            events.push(Event::warning(text));
        }
        told.heading = passed;
    }
}
