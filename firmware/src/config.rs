//! Parameters → configuration of every block. Made anew when a parameter changes; no state in it.

use crate::control::{AttitudeLoop, ClimbLoop, Link, Mixer, PositionLoop, RateLoop, ThrustMap};
use crate::estimate::TetherEstimator;
use crate::math::GRAVITY;
use crate::mode::ModeConfig;
use crate::model::LinkKind;
use crate::param::Params;
use crate::scalar::Scalar;
use crate::sense::{ImuScale, Sense};
use crate::supervisor::{Failsafes, TouchDown};
use crate::trajectory::Planner;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Config<S: Scalar> {
    pub sense: Sense<S>,
    pub estimator: TetherEstimator<S>,
    pub planner: Planner<S>,
    pub position: PositionLoop<S>,
    pub attitude: AttitudeLoop<S>,
    pub climb: ClimbLoop<S>,
    pub rate: RateLoop<S>,
    pub mixer: Mixer<S>,
    pub thrust_map: ThrustMap<S>,
    pub failsafes: Failsafes,
    pub touch_down: TouchDown<S>,
    pub link: Link,
    pub kind: LinkKind,
    pub modes: ModeConfig<S>,
    pub mass: S,
    pub weight: S,
    pub thrust_scale: S,
    pub tether_length: S,
    pub tension_low: S,
    pub tension_floor: S,
}

/// A divisor.
fn believable<S: Scalar>(thrust_scale: f32) -> S {
    S::from_f32(thrust_scale.max(0.5))
}

impl<S: Scalar> Config<S> {
    /// What was learnt in flight: making everything anew takes as long as ten steps.
    pub fn set_thrust_scale(&mut self, scale: f32) {
        self.thrust_scale = believable(scale);
        self.estimator.set_thrust_scale(self.thrust_scale);
    }

    pub fn new(p: &Params, scale: ImuScale) -> Self {
        let f = S::from_f32;
        let kind = LinkKind::from_parameter(p.tether_kind);
        let sense = Sense::new(p, scale);
        let weight = f(p.mass) * S::lit(GRAVITY);
        Self {
            estimator: TetherEstimator::new(p, *sense.accel_filter(), scale.rate_hz),
            sense,
            planner: Planner::new(p),
            position: PositionLoop::new(p),
            attitude: AttitudeLoop::new(p),
            climb: ClimbLoop {
                mass: f(p.mass),
                kp: S::lit(3.0),
                ki: S::lit(2.0),
                integral_max: S::lit(6.0),
                thrust_min: f(p.thrust_min),
                thrust_max: f(p.thrust_max),
            },
            rate: RateLoop::new(p),
            mixer: Mixer::new(p),
            thrust_map: ThrustMap::new(p),
            failsafes: Failsafes::new(p),
            touch_down: TouchDown { weight, ground_height: f(p.ground_height) },
            link: match kind {
                LinkKind::Winch => Link::Winch,
                LinkKind::Free => Link::Free,
                _ => Link::FixedLength,
            },
            kind,
            modes: ModeConfig::new(p),
            mass: f(p.mass),
            weight,
            thrust_scale: believable(p.thrust_scale),
            tether_length: f(p.tether_length),
            tension_low: f(p.tension_low),
            tension_floor: f(p.tension_min + 1.0),
        }
    }
}
