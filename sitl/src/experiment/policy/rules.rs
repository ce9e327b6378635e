//! What holds in every flight, whatever breaks and whoever asks for what. One rule each.

use crate::plant::Plant;
use tautline_firmware::param::{META, Params, broken};
use tautline_firmware::signal::{ImuHealth, Outcome, Severity, TEXT_MAX};
use tautline_firmware::supervisor::{FailsafeAction, Failsafes, GroundState};
use tautline_firmware::vehicle::StepOutput;

/// One step and the one before it.
pub struct View<'a> {
    /// What the vehicle says.
    pub now: &'a StepOutput,
    /// What it said a millisecond ago.
    pub before: &'a StepOutput,
    /// The truth.
    pub plant: &'a Plant,
    /// After the step.
    pub params: &'a Params,
    /// Before it.
    pub params_before: &'a Params,
    /// What the flight remembers.
    pub memory: Memory,
}

/// What a rule must know of the time before.
#[derive(Clone, Copy, Debug, Default)]
pub struct Memory {
    /// Lowest since the vehicle comes down, m.
    pub lowest: Option<f64>,
    /// It was in the air.
    pub has_flown: bool,
    /// So often came one text within a second without being asked for.
    pub repeated: u32,
}

/// How a rule is looked at.
pub enum Claim {
    /// In every step.
    Always(fn(&View<'_>) -> bool),
    /// Once the first has held for so long, s, the second holds.
    Within(f64, fn(&View<'_>) -> bool, fn(&View<'_>) -> bool),
}

/// One rule.
pub struct Rule {
    /// What it says.
    pub text: &'static str,
    /// How.
    pub claim: Claim,
    /// It is about the truth, which a vehicle knows by its sensors and reaches by its motors: it is asked of flights
    /// with no more than one thing broken.
    pub is_physical: bool,
}

const fn always(text: &'static str, holds: fn(&View<'_>) -> bool) -> Rule {
    Rule { text, claim: Claim::Always(holds), is_physical: false }
}

const fn within(
    text: &'static str,
    seconds: f64,
    when: fn(&View<'_>) -> bool,
    then: fn(&View<'_>) -> bool,
) -> Rule {
    Rule { text, claim: Claim::Within(seconds, when, then), is_physical: false }
}

const fn physical(rule: Rule) -> Rule {
    Rule { is_physical: true, ..rule }
}

/// The first 250 Hz step that can know of it, and one more.
const SOON: f64 = 0.02;
/// Out of all proportion for anything that the vehicle may believe, in whatever unit.
const FAR: f32 = 1e4;

fn flies(v: &View<'_>) -> bool {
    v.now.is_armed && v.now.ground != GroundState::OnGround
}

/// The severest action of what is in force, of a vehicle that flies by itself.
fn is_due(v: &View<'_>, action: FailsafeAction) -> bool {
    v.now.failures != 0
        && flies(v)
        && !v.now.mode.rule().needs.sticks
        && Failsafes::new(v.params).severest(v.now.failures) == Some(action)
}

fn answered(v: &View<'_>, outcome: Outcome) -> bool {
    v.now.reply.is_some_and(|reply| reply.outcome == outcome)
}

fn says(v: &View<'_>, text: &str) -> bool {
    v.now.events.iter().any(|event| event.text.contains(text))
}

fn has_told(v: &View<'_>) -> bool {
    v.now.events.iter().next().is_some()
}

fn arms(v: &View<'_>) -> bool {
    v.now.is_armed && !v.before.is_armed
}

fn disarms(v: &View<'_>) -> bool {
    v.before.is_armed && !v.now.is_armed
}

fn changes_mode(v: &View<'_>) -> bool {
    v.now.mode != v.before.mode
}

fn estimate_is_finite(v: &View<'_>) -> bool {
    let estimate = &v.now.estimate;
    let (roll, pitch, yaw) = estimate.attitude.euler();
    let known = [roll, pitch, yaw, estimate.height, estimate.thrust];
    let place = estimate.position.map_or([0.0; 3], |p| p.0.into());
    known.iter().chain(&place).chain(estimate.rate.0.iter()).all(|x| x.abs() < FAR)
}

fn is_in_range(v: &View<'_>) -> bool {
    v.now.reply.is_none()
        || (0..)
            .zip(META)
            .all(|(at, meta)| v.params.get(at).is_some_and(|x| (meta.min..=meta.max).contains(&x)))
}

/// Over where the ground was at the start, m: ground that moves makes no climb.
pub fn height(plant: &Plant) -> f64 {
    -plant.body.position.z
}

/// So far it may go up while it comes down: a gust, a line that pulls aside, m.
const BOUNCE: f64 = 3.0;
/// Nothing here is asked to fly higher, m.
const CEILING: f64 = 25.0;

/// All rules.
pub const RULES: &[Rule] = &[
    always("disarmed: motors off", |v| {
        v.now.is_armed || v.now.actuation.throttle.iter().all(|x| x.abs() <= 0.0)
    }),
    always("what the motors get is armed as the vehicle is", |v| {
        v.now.actuation.is_armed == v.now.is_armed
    }),
    always("throttles are within 0 and 1", |v| {
        v.now.actuation.throttle.iter().all(|x| (0.0..=1.0).contains(x))
    }),
    always("thrusts are finite and not negative", |v| {
        v.now.actuation.thrusts.iter().all(|x| (0.0..FAR).contains(x))
    }),
    always("the winch is asked what it can give", |v| {
        (0.0..=1000.0).contains(&v.now.actuation.winch.tension)
    }),
    always("what is believed is finite", estimate_is_finite),
    always("a set-point is finite", |v| {
        v.now.reference.is_none_or(|r| r.position.0.iter().all(|x| x.abs() < FAR))
            && v.now.rate_setpoint.0.iter().all(|x| x.abs() < FAR)
    }),
    always("time does not go back", |v| v.now.now.0 > v.before.now.0),
    always("it arms when asked", |v| !arms(v) || answered(v, Outcome::Accepted)),
    always("it does not arm on a sensor that is not well", |v| {
        !arms(v) || v.now.sensors.imu_health == ImuHealth::Good
    }),
    always("it does not arm on parameters that do not go together", |v| {
        !arms(v) || broken(v.params).is_none()
    }),
    always("armed: the parameters go together", |v| {
        !v.now.is_armed || v.now.reply.is_none() || broken(v.params).is_none()
    }),
    always("a parameter stays within its range", is_in_range),
    always("a refused request changes no parameter", |v| {
        !(answered(v, Outcome::Denied) || answered(v, Outcome::Rejected))
            || v.params == v.params_before
    }),
    always("a parameter changes on request", |v| {
        v.now.reply.is_some() || v.params == v.params_before
    }),
    always("motors stop with a word", |v| !disarms(v) || has_told(v)),
    always("in the air they stop for a failure or by force", |v| {
        let was_up = v.before.ground != GroundState::OnGround;
        !(disarms(v) && was_up)
            || says(v, "Motors stopped")
            || says(v, "Landed")
            || answered(v, Outcome::Accepted)
    }),
    always("a mode changes on request or with a word", |v| {
        !changes_mode(v) || v.now.reply.is_some() || has_told(v)
    }),
    always("it flies only modes that are built", |v| v.now.mode.rule().is_built),
    always("what comes down goes up again on request alone", |v| {
        let rank = FailsafeAction::rank;
        !(changes_mode(v) && flies(v) && rank(v.now.mode) < rank(v.before.mode))
            || answered(v, Outcome::Accepted)
    }),
    always("a failure is told when it begins", |v| {
        let fresh = v.now.failures & !v.before.failures;
        fresh == 0 || v.now.events.iter().any(|event| event.severity == Severity::Critical)
    }),
    always("no text floods the link", |v| v.memory.repeated < 4),
    always("a text fits its message", |v| {
        v.now.events.iter().all(|event| (1..=TEXT_MAX).contains(&event.message().len()))
    }),
    always("no event is dropped", |v| v.now.events.dropped == 0),
    within(
        "a failure that ends in Descent: it descends",
        SOON,
        |v| is_due(v, FailsafeAction::Descend),
        |v| v.now.mode == FailsafeAction::LEVEL,
    ),
    within(
        "a failure that ends in Land: it lands or descends",
        SOON,
        |v| is_due(v, FailsafeAction::Land),
        |v| v.now.mode.lands(),
    ),
    within(
        "a failure that ends the flight: motors off",
        SOON,
        |v| is_due(v, FailsafeAction::Terminate),
        |v| !v.now.is_armed,
    ),
    within("no landing lasts for ever", 240.0, |v| flies(v) && v.now.mode.lands(), |_| false),
    within(
        "armed on the ground: it takes off or disarms",
        60.0,
        |v| v.now.is_armed && v.now.ground == GroundState::OnGround,
        |_| false,
    ),
    physical(within(
        "down on the ground: motors off",
        15.0,
        |v| v.memory.has_flown && v.now.mode.lands() && v.plant.ground.is_touching(),
        |v| !v.now.is_armed,
    )),
    physical(always("it does not think it has landed in the air", |v| {
        !(disarms(v) && says(v, "Landed")) || v.plant.height_over_ground() < 0.7
    })),
    physical(always("what comes down does not climb", |v| {
        v.memory.lowest.is_none_or(|low| height(v.plant) < low + BOUNCE)
    })),
    physical(always("it stays under the ceiling", |v| height(v.plant) < CEILING)),
];
