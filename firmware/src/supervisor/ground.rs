//! Is the vehicle on the ground?
//!
//! Several weak signs vote, and none alone can veto. *Contact*: it should sink and does not, by the altimeter, by a pull
//! that the thrust does not explain, or because nothing has moved for long. The thrust then ramps down, which is a
//! question to the ground: if nothing carries the vehicle meanwhile, the thrust comes back. *Landed*: little thrust,
//! yet the accelerometer shows what the thrust does not give, or everything else lies still.

use crate::math::GRAVITY;
use crate::scalar::Scalar;

/// For MAVLink and the estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroundState {
    /// Standing.
    #[default]
    OnGround,
    /// Thrust rises or the first climb is on.
    TakingOff,
    /// Flying.
    InAir,
    /// Coming down.
    Landing,
}

/// What the last step says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GroundContact {
    /// Let the thrust ramp down.
    pub touches: bool,
    /// The thrust came down and nothing carries the vehicle: it was no ground.
    pub falls: bool,
    /// The ground carries the vehicle.
    pub has_landed: bool,
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchDown<S> {
    /// kg.
    pub mass: S,
    /// Height of the centre of mass when landed, m.
    pub ground_height: S,
}

/// Timers, s, and what was felt.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TouchDownState<S> {
    /// Specific force beyond the thrust's, of the last half second, m/s².
    usual: Option<S>,
    /// Specific force and the thrust's share of it when the ramp began, m/s².
    asked_at: Option<(S, S)>,
    /// The thrust over the mass, as late as the accelerometer's low-pass, m/s².
    lift: Option<S>,
    /// Until it may ask again, s.
    refused: S,
    low: S,
    held: S,
    idle: S,
    stays: S,
    tumbles: S,
    tipped: S,
    carried: S,
    lying: S,
    falling: S,
}

/// What the detector looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchDownInput<S> {
    /// The vehicle is asked to sink.
    pub wants_down: bool,
    /// Height by the altimeter; `None` without.
    pub height: Option<S>,
    /// Climb rate, m/s.
    pub climb: S,
    /// The same by the altimeter alone; `None` without.
    pub altitude_rate: Option<S>,
    /// Total thrust by the model, N.
    pub thrust: S,
    /// Size of the specific force, its vector low-passed, m/s²; `None` while the accelerometer is not believed.
    pub felt: Option<S>,
    /// Size of the body rate, low-passed, rad/s.
    pub turning: S,
    /// Of the tilt.
    pub cos_tilt: S,
    /// Of the thrust, that the contact ramp has left.
    pub left: S,
}

/// Signs of contact last so long: altimeter, accelerometer, nothing but patience, s.
const LOW_TIME: f64 = 0.2;
const HELD_TIME: f64 = 0.2;
const IDLE_TIME: f64 = 20.0;
/// The same of one that turns or slides, and does not sink, s.
const STAYS_TIME: f64 = 10.0;
/// Cosine of 37 degrees, and so long, s.
const TIPPED: f64 = 0.8;
const TIPPED_TIME: f64 = 1.0;
/// One that tumbles on the ground does not come level again, s.
const TUMBLES_TIME: f64 = 3.0;
/// Landed: while the altimeter agrees, while it does not, and without an accelerometer, s.
const CARRIED_TIME: f64 = 0.4;
const CARRIED_ALONE_TIME: f64 = 1.0;
const LYING_TIME: f64 = 2.0;
/// Without a ground the thrust comes back after this time, s.
const FALLING_TIME: f64 = 0.08;
/// What the thrust does not explain, in g: more than usual, to ask; at all, to be sure.
const HELD: f64 = 0.15;
const CARRIED: f64 = 0.3;
/// In which the usual follows, s: a winch changes its pull within a second or two.
const USUAL_TIME: f64 = 0.5;
/// So much less thrust, in g, is felt by this share of it in a fall, and not at all on the ground.
const ASKED: f64 = 0.25;
const FALLING: f64 = 0.5;
/// Until it asks again, s.
const AGAIN: f64 = 2.0;
/// Share of a step at 250 Hz that the thrust's low-pass moves: 2 Hz, as the specific force's.
const FELT_SHARE: f64 = 0.05;
/// Of the weight, below which the thrust carries little.
const LITTLE: f64 = 0.6;

impl<S: Scalar> TouchDown<S> {
    /// One step over `dt` s.
    pub fn step(
        &self,
        state: &mut TouchDownState<S>,
        z: &TouchDownInput<S>,
        dt: S,
    ) -> GroundContact {
        let lasts = |timer: &mut S, holds: bool, seconds: f64| {
            *timer = if holds { (*timer + dt).min(S::lit(30.0)) } else { S::zero() };
            *timer >= S::lit(seconds)
        };
        let below = |margin: f64| z.height.map(|h| h < self.ground_height + S::lit(margin));
        let g = S::lit(GRAVITY);
        let raw_lift = z.thrust / self.mass;
        let before = state.lift.unwrap_or(raw_lift);
        let lift = before + (raw_lift - before) * S::lit(FELT_SHARE);
        state.lift = Some(lift);
        let spare = z.felt.map(|felt| felt - lift);
        let is_held =
            spare.zip(state.usual).is_some_and(|(spare, usual)| spare - usual > g * S::lit(HELD));
        state.usual = spare.map(|spare| {
            let usual = state.usual.unwrap_or(spare);
            usual + (spare - usual) * dt * S::lit(1.0 / USUAL_TIME)
        });
        let asks = z.left < S::one();
        if !asks || state.asked_at.is_none() {
            state.asked_at = z.felt.map(|felt| (felt, lift));
        }
        let is_falling = asks
            && z.felt.zip(state.asked_at).is_some_and(|(felt, (felt_then, lift_then))| {
                let less = lift_then - lift;
                less > g * S::lit(ASKED) && felt_then - felt > less * S::lit(FALLING)
            });
        let is_steady = z.altitude_rate.is_some_and(|rate| rate.abs() < S::lit(0.1));
        let is_still = z.climb.abs() < S::lit(0.15) || is_steady;
        let is_quiet = z.turning < S::lit(0.1);

        let low = z.wants_down && is_still && below(0.15) == Some(true);
        let held = z.wants_down && is_held;
        let idle = z.wants_down && is_still && is_quiet;
        // Nothing hangs still in the air so far from level.
        let tipped = idle && z.cos_tilt < S::lit(TIPPED);
        let touches = lasts(&mut state.low, low, LOW_TIME)
            | lasts(&mut state.held, held, HELD_TIME)
            | lasts(&mut state.idle, idle, IDLE_TIME)
            | lasts(&mut state.tipped, tipped, TIPPED_TIME)
            | lasts(&mut state.tumbles, z.wants_down && z.cos_tilt < S::lit(TIPPED), TUMBLES_TIME)
            | lasts(&mut state.stays, z.wants_down && is_still, STAYS_TIME);

        let falls = lasts(&mut state.falling, is_falling, FALLING_TIME);
        if falls {
            *state = TouchDownState { refused: S::lit(AGAIN), ..TouchDownState::default() };
        }
        state.refused = (state.refused - dt).max(S::zero());

        let is_little = raw_lift < g * S::lit(LITTLE);
        let agrees = below(0.5) != Some(false);
        let carried = is_little && spare.is_some_and(|spare| spare > g * S::lit(CARRIED));
        // Motors that strain to right it keep their thrust when it is let go.
        let is_let_go = is_little || z.left <= S::zero();
        let lying = is_let_go && is_still && is_quiet && agrees && !is_falling;
        let enough = if agrees { CARRIED_TIME } else { CARRIED_ALONE_TIME };
        let has_landed =
            lasts(&mut state.carried, carried, enough) | lasts(&mut state.lying, lying, LYING_TIME);
        GroundContact { touches: touches && state.refused <= S::zero(), falls, has_landed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: f32 = 9.81;

    /// A vehicle that sinks, meets the ground after a second or never, and lets its thrust go as the detector says.
    struct Scene {
        ground: bool,
        height: Option<f32>,
        climb: f32,
        accel: Option<f32>,
        turning: f32,
        /// Real over modelled thrust.
        strength: f32,
    }

    const CLEAN: Scene = Scene {
        ground: true,
        height: Some(0.15),
        climb: 0.0,
        accel: Some(0.0),
        turning: 0.0,
        strength: 1.0,
    };

    /// Seconds from contact until landed, and how often the thrust went below three quarters for nothing.
    fn play(scene: &Scene) -> (Option<f32>, usize) {
        let detector = TouchDown { mass: 1.5_f32, ground_height: 0.15 };
        let mut state = TouchDownState::default();
        let (mut left, mut command, mut felt, mut questions) = (1.0_f32, 1.0_f32, G, 0);
        for i in 0..10_000_u16 {
            let time = f32::from(i) * 0.004 - 1.0;
            let is_down = scene.ground && time > 0.0;
            // On the ground the climb loop winds down.
            command = if is_down { (command - 0.004 * 0.3).max(0.1) } else { 1.0 };
            let lift = command * left / scene.strength;
            let force = if is_down { 1.0 } else { lift * scene.strength };
            felt += (force * G - felt) * 0.05;
            let is_sinking = !is_down && scene.climb == 0.0;
            let z = TouchDownInput {
                wants_down: true,
                height: if is_down { scene.height } else { scene.height.map(|h| h + 0.3) },
                climb: if is_sinking { -0.4 } else { scene.climb },
                altitude_rate: scene.height.map(|_| if is_sinking { -0.4 } else { scene.climb }),
                thrust: lift * 1.5 * G,
                felt: scene.accel.map(|bias| felt + bias),
                turning: scene.turning,
                cos_tilt: 1.0,
                left,
            };
            let contact = detector.step(&mut state, &z, 0.004);
            let was = left;
            left = match contact {
                GroundContact { falls: true, .. } => 1.0,
                GroundContact { touches: true, .. } => (left - 0.01).max(0.0),
                _ if left < 1.0 => (left - 0.01).max(0.0),
                _ => 1.0,
            };
            questions += usize::from(was < 0.75 && left > was);
            if contact.has_landed {
                return (Some(time), questions);
            }
        }
        (None, questions)
    }

    #[test]
    fn no_sign_alone_hides_the_ground() {
        for (what, scene) in [
            ("all signs", CLEAN),
            ("the altimeter says 3 m", Scene { height: Some(3.0), ..CLEAN }),
            ("the estimate sinks on", Scene { climb: -0.5, ..CLEAN }),
            ("no altimeter", Scene { height: None, ..CLEAN }),
            ("no accelerometer", Scene { accel: None, ..CLEAN }),
            ("1 m/s2 too little", Scene { accel: Some(-1.0), ..CLEAN }),
            ("1 m/s2 too much", Scene { accel: Some(1.0), ..CLEAN }),
            ("it shakes", Scene { turning: 1.0, ..CLEAN }),
            ("thrust 80 %", Scene { strength: 0.8, ..CLEAN }),
            ("thrust 120 %", Scene { strength: 1.2, ..CLEAN }),
            ("no altimeter, 1 m/s2 too little", Scene { height: None, accel: Some(-1.0), ..CLEAN }),
        ] {
            let (landed, _) = play(&scene);
            assert!(landed.is_some_and(|t| t < 4.0), "{what}: {landed:?}");
        }
    }

    #[test]
    fn no_sign_alone_makes_a_ground_of_the_air() {
        let air = Scene { ground: false, height: Some(5.0), ..CLEAN };
        for (what, scene, most) in [
            ("sinking", Scene { ..air }, 0),
            ("no altimeter", Scene { height: None, ..air }, 0),
            ("1 m/s2 too much", Scene { accel: Some(1.0), ..air }, 0),
            ("it does not seem to sink", Scene { climb: -0.1, ..air }, 3),
            // It asks again and again; each time the fall answers.
            (
                "the altimeter stuck at the ground",
                Scene { height: Some(-0.3), climb: -0.1, ..air },
                100,
            ),
        ] {
            let (landed, questions) = play(&scene);
            assert_eq!(landed, None, "{what}");
            assert!(questions <= most, "{what}: {questions}");
        }
    }
}
