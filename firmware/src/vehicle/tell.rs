//! What the operator should know of the estimate, each once.

use super::Vehicle;
use crate::scalar::Scalar;
use crate::signal::{AidReport, AltimeterReport, Event, EventQueue};
use crate::supervisor::GroundState;
use crate::time::{Micros, OUTER_DT};

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
    gyro_changes: u16,
    length_jumps: u16,
    aids: AidReport,
    altimeters: AltimeterReport,
    /// Of [`Vehicle::tell`]'s list of what comes and goes.
    quiet: [Quiet; 6],
    /// Of [`UNSURE`].
    heading: usize,
    /// How long it has been so: thrust off its model, thrust nearly gone, shaken, s.
    lasting: [f32; 3],
}

/// What comes and goes is told again only after it did not come for a while.
#[derive(Clone, Copy, Debug, Default)]
struct Quiet {
    /// s.
    left: f32,
}

/// s.
const QUIET: f32 = 20.0;

impl Quiet {
    /// One outer step; whether what came now is to be told.
    fn step(&mut self, has_come: bool) -> bool {
        let is_quiet = self.left > 0.0;
        self.left = if has_come { QUIET } else { (self.left - OUTER_DT as f32).max(0.0) };
        has_come && !is_quiet
    }
}

/// What lasts and is told once: for how long, s, and how.
const LASTING: [(f32, &str); 3] = [
    (5.0, "Thrust or mass is not what its parameter says"),
    (1.0, "Thrust nearly exhausted"),
    (2.0, "High vibration: check propellers and mounting"),
];
/// Thrust off its model, share; of the most that the motors give; vibration behind the filters, m/s².
const SCALE_OFF: f32 = 0.08;
const EXHAUSTED: f32 = 0.93;
const SHAKEN: f32 = 3.0;

impl<S: Scalar> Vehicle<S> {
    pub(super) fn tell(&mut self, now: Micros, events: &mut EventQueue) {
        self.tell_radio(now, events);
        // Every action but a warning is a row of the failsafe table.
        let is_warned = self.params.fence_only_warns() && self.is_outside();
        let (estimate, told) = (&self.situation.estimate, &mut self.state.told);
        let altimeters = self.state.altimeters;
        let comes = [
            (estimate.restarts > told.restarts, "Position filter began anew"),
            (estimate.gyro_changes > told.gyro_changes, "Gyro bias changed: learnt anew"),
            (estimate.length_jumps > told.length_jumps, "Line length jumped: taken out"),
            (altimeters.range_is_rejected && !told.altimeters.range_is_rejected, RANGE_REJECTED),
            (altimeters.baro_is_rejected && !told.altimeters.baro_is_rejected, BARO_REJECTED),
            (is_warned, "Beyond the fence"),
        ];
        for ((has_come, text), quiet) in comes.into_iter().zip(&mut told.quiet) {
            if quiet.step(has_come) {
                events.push(Event::warning(text));
            }
        }
        (told.restarts, told.length_jumps) = (estimate.restarts, estimate.length_jumps);
        told.gyro_changes = estimate.gyro_changes;
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
        let flies = is_armed && self.situation.setpoints.ground == GroundState::InAir;
        let thrust = estimate.thrust.to_f32();
        let holds = [
            (estimate.thrust_scale.to_f32() - 1.0).abs() > SCALE_OFF,
            thrust > crate::model::thrust_max(&self.params) * EXHAUSTED,
            estimate.vibration.to_f32() > SHAKEN,
        ];
        for ((lasting, holds), (time, text)) in told.lasting.iter_mut().zip(holds).zip(LASTING) {
            let was_told = *lasting >= time;
            // What was told is told again after it was well for as long.
            let next = *lasting + if holds && flies { OUTER_DT as f32 } else { -OUTER_DT as f32 };
            *lasting = next.clamp(0.0, 2.0 * time);
            if *lasting >= time && !was_told {
                events.push(Event::warning(text));
            }
        }
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
