//! Did it come down as a vehicle should that hangs over people? Against the truth, from lift-off on.

use super::PERIOD;
use crate::plant::{Plant, TICK};
use tautline_firmware::supervisor::FAILSAFES;
use tautline_firmware::vehicle::StepOutput;

/// Fastest first contact that leaves a vehicle whole, downwards and sideways, m/s.
const SINK_MAX: f64 = 1.5;
const ASIDE_MAX: f64 = 1.0;
/// Beyond this tilt the vehicle counts as lost (70°), rad.
const TILT_MAX: f64 = 1.22;
/// Motors may turn so long on the ground after a flight, s.
const SPIN_DOWN: f64 = 10.0;
/// Height over the ground from which it has flown, m.
const FLOWN: f64 = 0.5;
/// It may touch down this much further from the anchor than the longest line that was out, m.
const BEYOND_LINE: f64 = 5.0;

/// How a flight touched the ground.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Sink rate at the last first contact after flight, m/s.
    pub touch_down: Option<f64>,
    /// Horizontal speed over the ground there, m/s.
    pub touch_down_drift: Option<f64>,
    /// Farthest from the anchor, level, m.
    pub farthest: f64,
    /// From where it stood to where it came down, m.
    pub from_pad: Option<f64>,
    /// From where it stood to where it is, level, m.
    pub off_pad: f64,
    /// Greatest height over the ground, m.
    pub highest: f64,
    /// Largest tilt, rad.
    pub tilt_max: f64,
    /// Longest time with motors turning on the ground after a flight, s.
    pub motors_on_ground: f64,
    /// Motors were allowed to turn at some time.
    pub has_armed: bool,
    /// The last time that they were allowed to turn no more, s.
    pub disarmed_at: Option<f64>,
    /// Rows of the failsafe table that were active while armed, each once, in the order they came.
    pub failures: Vec<&'static str>,
    /// Why the vehicle counts as lost.
    pub lost: Option<&'static str>,
    pad: Option<(f64, f64)>,
    longest_line: f64,
    was_touching: bool,
    has_flown: bool,
    has_landed: bool,
    was_armed: bool,
    seen: u32,
    steps: u32,
}

impl Verdict {
    fn lose(&mut self, why: &'static str) {
        self.lost.get_or_insert(why);
    }

    /// One millisecond.
    pub fn step(&mut self, out: &StepOutput, plant: &Plant) {
        self.steps = self.steps.wrapping_add(1);
        self.follow(out);
        let touches = plant.ground.is_touching();
        if touches && !self.was_touching && self.has_flown {
            self.touch(plant);
        }
        self.was_touching = touches;
        if touches && self.has_landed && out.is_armed {
            self.motors_on_ground += TICK;
            if self.motors_on_ground > SPIN_DOWN {
                self.lose("motors still turn on the ground");
            }
        } else {
            self.motors_on_ground = 0.0;
        }
        if self.steps.is_multiple_of(PERIOD) {
            self.look(plant, touches);
        }
    }

    /// Arming, and what fails while armed.
    fn follow(&mut self, out: &StepOutput) {
        self.has_armed |= out.is_armed;
        if self.was_armed && !out.is_armed {
            self.disarmed_at = Some(f64::from(self.steps) * TICK);
        }
        // What stops the motors comes with the step that disarms.
        let flew = std::mem::replace(&mut self.was_armed, out.is_armed) || out.is_armed;
        let fresh = out.failures & !self.seen;
        if fresh == 0 || !flew {
            return;
        }
        self.seen |= fresh;
        let rows = FAILSAFES.iter().filter(|row| row.failure.mask() & fresh != 0);
        self.failures.extend(rows.map(|row| row.name));
    }

    fn look(&mut self, plant: &Plant, touches: bool) {
        let place = plant.body.position - plant.anchor.deck().place;
        let (x, y) = *self.pad.get_or_insert((place.x, place.y));
        self.off_pad = (place.x - x).hypot(place.y - y);
        let height = plant.height_over_ground();
        if height > FLOWN && !touches {
            self.has_flown = true;
            self.has_landed = false;
        }
        let from_anchor = plant.from_anchor();
        self.farthest = self.farthest.max(from_anchor.x.hypot(from_anchor.y));
        self.highest = self.highest.max(height);
        self.longest_line = self.longest_line.max(plant.tether.length());
        self.tilt_max = self.tilt_max.max(plant.body.tilt());
        if self.tilt_max > TILT_MAX {
            self.lose("tilted over 70 deg");
        }
        if height < -FLOWN {
            self.lose("below the ground");
        }
    }

    fn touch(&mut self, plant: &Plant) {
        let Some((sink, aside)) = plant.ground.touch_down else { return };
        (self.touch_down, self.touch_down_drift) = (Some(sink.abs()), Some(aside));
        (self.has_flown, self.has_landed) = (false, true);
        let place = plant.body.position - plant.anchor.deck().place;
        let from_anchor = plant.from_anchor();
        self.from_pad = self.pad.map(|(x, y)| (place.x - x).hypot(place.y - y));
        if sink > SINK_MAX {
            self.lose("touched down hard");
        }
        if aside > ASIDE_MAX {
            self.lose("touched down sideways");
        }
        let is_tethered = plant.model().tether.pulls;
        if is_tethered && from_anchor.x.hypot(from_anchor.y) > self.longest_line + BEYOND_LINE {
            self.lose("came down beyond its line");
        }
    }
}
