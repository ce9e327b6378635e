//! The tether: pulls, never pushes; or a strut, which only pushes, or a bar, which does both. At a fixed
//! length a unilateral spring and damper; on a winch a tension with lag, friction, ripple and a slow
//! error. Half its weight and a third of its drag hang on the vehicle.

use super::{GRAVITY, V3, uniform};
use crate::scenario::{TetherKind, TetherSection};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// What the ground end does.
#[derive(Clone, Debug)]
pub struct WinchModel {
    /// Lag of the tension set-point, s.
    pub lag: f64,
    /// Slow relative error, uniform within ±.
    pub error: f64,
    /// Coulomb friction of the drum, N.
    pub friction: f64,
    /// Ripple amplitude, N, at 40 rad/s.
    pub ripple: f64,
    /// Longest line, m.
    pub length_max: f64,
}

/// The line.
#[derive(Clone, Debug)]
pub struct TetherModel {
    /// `None`: fixed length.
    pub winch: Option<WinchModel>,
    /// Unstretched length when fixed, m.
    pub length: f64,
    /// Axial stiffness EA, N.
    pub stiffness: f64,
    /// Damping ratio of the vehicle on the line.
    pub damping_ratio: f64,
    /// kg that the damping ratio refers to.
    pub reference_mass: f64,
    /// kg/m.
    pub line_density: f64,
    /// m.
    pub diameter: f64,
    /// Attachment below the centre of mass, m.
    pub attachment: f64,
    /// A cable pulls.
    pub pulls: bool,
    /// A strut or bar pushes.
    pub pushes: bool,
    /// Cut: nothing pulls.
    pub is_broken: bool,
}

impl TetherModel {
    /// As the scenario describes it, for a vehicle of `mass` kg.
    #[must_use]
    pub fn new(tether: &TetherSection, mass: f64) -> Self {
        let kind = tether.kind;
        let is_free = kind == TetherKind::None;
        Self {
            winch: (kind == TetherKind::Winch).then_some(WinchModel {
                lag: tether.winch_lag,
                error: tether.winch_error,
                friction: tether.winch_friction,
                ripple: tether.winch_ripple,
                length_max: tether.winch_length_max,
            }),
            length: tether.length,
            stiffness: tether.stiffness,
            damping_ratio: tether.damping_ratio,
            reference_mass: mass,
            // No line hangs on a vehicle without one.
            line_density: if is_free { 0.0 } else { tether.line_density },
            diameter: if is_free { 0.0 } else { tether.diameter },
            attachment: tether.attachment,
            pulls: !matches!(kind, TetherKind::Strut | TetherKind::None),
            pushes: matches!(kind, TetherKind::Strut | TetherKind::Bar),
            is_broken: false,
        }
    }
}

/// State.
#[derive(Clone, Debug)]
pub struct Tether {
    /// Pull along the line, N; negative where a bar pushes.
    pub tension: f64,
    /// Distance of the attachment from the anchor, m.
    pub distance: f64,
    set_point: f64,
    /// Of the drum without its friction, N.
    drum: f64,
    error: f64,
    phase: f64,
}

/// Shortest distance at which the line has a direction, m.
const SHORTEST: f64 = 0.05;
/// Speed over which drum friction turns round, m/s.
const FRICTION_SPEED: f64 = 0.05;
const RIPPLE_RATE: f64 = 40.0;
/// 0.5 ρ Cd of a cylinder, kg/m³.
const DRAG: f64 = 0.5 * 1.2 * 1.2;

impl Tether {
    /// Slack.
    #[must_use]
    pub fn new(model: &TetherModel, rng: &mut Pcg64Mcg) -> Self {
        let error = model.winch.as_ref().map_or(0.0, |winch| winch.error);
        Self {
            tension: 0.0,
            distance: 0.0,
            set_point: 0.0,
            drum: 0.0,
            error: uniform(rng) * error,
            phase: uniform(rng) * TAU,
        }
    }

    /// The winch's controller, once per `dt` s: lag, slow error, ripple.
    pub fn drive(&mut self, model: &TetherModel, wanted: f64, time: f64, dt: f64) {
        if let Some(winch) = &model.winch {
            self.set_point += (wanted - self.set_point) * (dt / winch.lag).min(1.0);
            self.drum = self.set_point * (1.0 + self.error)
                + winch.ripple * (RIPPLE_RATE * time + self.phase).sin();
        }
    }

    /// Force on the attachment, world axes, N. `end`: its position from the anchor and its velocity.
    #[inline]
    pub fn pull(&mut self, model: &TetherModel, end: &V3, velocity: &V3, wind: &V3) -> V3 {
        self.distance = end.norm();
        if model.is_broken || self.distance < SHORTEST {
            self.tension = 0.0;
            return V3::zeros();
        }
        let u = end / self.distance;
        let outward = velocity.dot(&u);
        let length = match &model.winch {
            None => {
                self.tension = elastic(model, model.length, self.distance - model.length, outward);
                model.length
            }
            Some(winch) => {
                let turning = outward / FRICTION_SPEED;
                let friction = winch.friction * turning / (1.0 + turning * turning).sqrt();
                let end_stop =
                    elastic(model, winch.length_max, self.distance - winch.length_max, outward);
                self.tension = (self.drum + friction).max(0.0) + end_stop;
                self.distance
            }
        };
        let weight = V3::new(0.0, 0.0, 0.5 * model.line_density * length * GRAVITY);
        let air = velocity - wind;
        let across = air - u * air.dot(&u);
        let drag = -across * across.norm() * (DRAG * model.diameter * length / 3.0);
        -u * self.tension + weight + drag
    }
}

fn elastic(model: &TetherModel, length: f64, stretch: f64, outward: f64) -> f64 {
    if stretch <= 0.0 && !model.pushes || stretch >= 0.0 && !model.pulls {
        return 0.0;
    }
    let k = model.stiffness / length;
    let damping = 2.0 * model.damping_ratio * (k * model.reference_mass).sqrt();
    let force = k * stretch + damping * outward;
    let low = if model.pushes { f64::NEG_INFINITY } else { 0.0 };
    let high = if model.pulls { f64::INFINITY } else { 0.0 };
    force.clamp(low, high)
}
