//! Parameters → configuration of every block; no state in it. Where a parameter changes, what depends on its group is
//! made anew, a [`Part`] at a time. Constructors are not inlined: they stand in the image once, for both ways.

use crate::control::{
    AttitudeLoop, ClimbLoop, Dither, Mixer, PositionLoop, RadialControl, RateLoop, Shape, ThrustMap,
};
use crate::math::GRAVITY;
use crate::mode::ModeConfig;
use crate::model::{Line, TetherKind};
use crate::navigation::Navigation;
use crate::param::{Group, Params};
use crate::scalar::Scalar;
use crate::sense::{ImuScale, Sense};
use crate::supervisor::{Failsafes, RotorWatch, TouchDown};
use crate::trajectory::Planner;

/// Everything but what moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Config<S: Scalar> {
    pub sense: Sense<S>,
    pub navigation: Navigation<S>,
    pub planner: Planner<S>,
    pub position: PositionLoop<S>,
    pub dither: Dither<S>,
    pub attitude: AttitudeLoop<S>,
    pub climb: ClimbLoop<S>,
    pub rate: RateLoop<S>,
    pub mixer: Mixer<S>,
    pub rotor_watch: Option<RotorWatch<S>>,
    pub thrust_map: ThrustMap<S>,
    pub failsafes: Failsafes,
    pub touch_down: TouchDown<S>,
    pub modes: ModeConfig<S>,
    pub constants: Constants<S>,
}

/// Single numbers that many ask for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants<S: Scalar> {
    pub radial_control: RadialControl,
    pub kind: TetherKind,
    pub mass: S,
    pub weight: S,
    pub line: Line<S>,
    pub thrust_scale: S,
    pub tether_length: S,
    pub tension_low: S,
    pub tension_floor: S,
}

/// What is made anew at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Sense,
    Navigation,
    Planner,
    Position,
    /// Attitude, climb and rate loop, mixer, thrust map.
    Inner,
    Supervisor,
    SlackHover,
    TautLink,
    TetherAngle,
    Pendulum,
    /// Single numbers.
    Constants,
}

const PARTS: [Part; 11] = [
    Part::Sense,
    Part::Navigation,
    Part::Planner,
    Part::Position,
    Part::Inner,
    Part::Supervisor,
    Part::SlackHover,
    Part::TautLink,
    Part::TetherAngle,
    Part::Pendulum,
    Part::Constants,
];

/// Parts that no longer follow the parameters: bit n is `PARTS[n]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stale(u16);

impl Stale {
    pub const ALL: Self = Self((1 << PARTS.len()) - 1);

    const fn of(parts: &[Part]) -> Self {
        let mut bits = 0;
        let mut rest = parts;
        while let [part, more @ ..] = rest {
            bits |= 1 << *part as u16;
            rest = more;
        }
        Self(bits)
    }

    /// What depends on a group of parameters.
    pub const fn after(group: Group) -> Self {
        use Part as P;
        match group {
            Group::Vehicle | Group::Motors | Group::Sensors | Group::Tether => Self::ALL,
            Group::Estimator => Self::of(&[P::Navigation]),
            Group::PositionControl => {
                Self::of(&[P::Planner, P::Position, P::Inner, P::TautLink, P::Constants])
            }
            Group::AttitudeRateControl => Self::of(&[P::Inner, P::TetherAngle]),
            Group::TautLink => Self::of(&[P::TautLink, P::TetherAngle, P::Pendulum]),
            Group::TetherAngle => Self::of(&[P::TetherAngle]),
            Group::MotionCapture => Self::of(&[P::Navigation, P::Pendulum]),
            Group::Pendulum => Self::of(&[P::Pendulum]),
            Group::TakeoffLanding => Self::of(&[P::Planner]),
            Group::Failsafes => Self::of(&[P::Sense, P::Navigation, P::Supervisor]),
            Group::Radio | Group::GroundStation => Self(0),
        }
    }

    pub fn add(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// Whether all follow.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The next one.
    fn take(&mut self) -> Option<Part> {
        let bit = self.0.trailing_zeros();
        self.0 &= self.0.wrapping_sub(1);
        PARTS.get(bit as usize).copied()
    }
}

/// A divisor.
fn usable<S: Scalar>(thrust_scale: f32) -> S {
    S::from_f32(thrust_scale.max(0.5))
}

fn navigation<S: Scalar>(p: &Params, sense: &Sense<S>, scale: ImuScale) -> Navigation<S> {
    Navigation::new(p, *sense.accel_filter(), scale.rate_hz)
}

fn climb<S: Scalar>(p: &Params) -> ClimbLoop<S> {
    ClimbLoop {
        mass: S::from_f32(p.mass),
        kp: S::lit(3.0),
        ki: S::lit(2.0),
        integral_max: S::lit(6.0),
        thrust_min: S::from_f32(p.thrust_min),
        thrust_max: S::from_f32(p.thrust_max),
    }
}

impl<S: Scalar> Constants<S> {
    #[inline(never)]
    fn new(p: &Params) -> Self {
        let f = S::from_f32;
        let kind = TetherKind::from_parameter(p.tether_kind);
        Self {
            radial_control: match kind {
                TetherKind::Winch => RadialControl::Winch,
                TetherKind::Free => RadialControl::Free,
                _ => RadialControl::FixedLength,
            },
            kind,
            mass: f(p.mass),
            weight: f(p.mass) * S::lit(GRAVITY),
            line: Line::new(p),
            thrust_scale: usable(p.thrust_scale),
            tether_length: f(p.tether_length),
            tension_low: f(p.tension_low),
            tension_floor: f(p.tension_min + 1.0),
        }
    }
}

fn dither<S: Scalar>(p: &Params) -> Dither<S> {
    Dither {
        amplitude: S::from_f32(Line::dither(p, TetherKind::from_parameter(p.tether_kind))),
        period: S::from_f32(p.dither_period),
        shape: Shape::Soft,
    }
}

fn touch_down<S: Scalar>(p: &Params) -> TouchDown<S> {
    let f = S::from_f32;
    TouchDown { mass: f(p.mass), ground_height: f(p.ground_height) }
}

impl<S: Scalar> Config<S> {
    /// All of it.
    pub fn new(p: &Params, scale: ImuScale) -> Self {
        let sense = Sense::new(p, scale);
        Self {
            navigation: navigation(p, &sense, scale),
            sense,
            planner: Planner::new(p),
            position: PositionLoop::new(p),
            dither: dither(p),
            attitude: AttitudeLoop::new(p),
            climb: climb(p),
            rate: RateLoop::new(p),
            mixer: Mixer::new(p),
            rotor_watch: RotorWatch::new(p),
            thrust_map: ThrustMap::new(p),
            failsafes: Failsafes::new(p),
            touch_down: touch_down(p),
            modes: ModeConfig::new(p),
            constants: Constants::new(p),
        }
    }

    /// Makes one stale part anew; whether there was one.
    pub fn renew(&mut self, stale: &mut Stale, p: &Params, scale: ImuScale) -> bool {
        let Some(part) = stale.take() else {
            return false;
        };
        match part {
            Part::Sense => self.sense = Sense::new(p, scale),
            Part::Navigation => self.navigation = navigation(p, &self.sense, scale),
            Part::Planner => self.planner = Planner::new(p),
            Part::Position => self.position = PositionLoop::new(p),
            Part::Inner => {
                self.attitude = AttitudeLoop::new(p);
                self.climb = climb(p);
                self.rate = RateLoop::new(p);
                self.mixer = Mixer::new(p);
                self.rotor_watch = RotorWatch::new(p);
                self.thrust_map = ThrustMap::new(p);
            }
            Part::Supervisor => {
                self.failsafes = Failsafes::new(p);
                self.touch_down = touch_down(p);
            }
            Part::SlackHover => self.modes.slack_hover = ModeConfig::slack_hover(p),
            Part::TautLink => self.modes.taut = ModeConfig::taut(p),
            Part::TetherAngle => self.modes.angle = ModeConfig::angle(p),
            Part::Pendulum => self.modes.pendulum = ModeConfig::pendulum(p),
            Part::Constants => {
                self.constants = Constants::new(p);
                self.dither = dither(p);
            }
        }
        true
    }

    /// What was learnt in flight.
    pub fn set_thrust_scale(&mut self, scale: f32) {
        self.constants.thrust_scale = usable(scale);
        self.navigation.set_thrust_scale(self.constants.thrust_scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::param::META;
    use std::format;

    /// What prints alike is alike: no block compares.
    fn print(config: &Config<f32>) -> std::string::String {
        format!("{config:?}")
    }

    #[test]
    fn a_changed_parameter_makes_anew_all_that_depends_on_it() {
        let scale = ImuScale { gyro: 1e-3, accel: 5e-3, rate_hz: 1000.0 };
        // Every kind of link rules other modes in.
        for kind in [0.0, 1.0, 3.0, 4.0] {
            let start = Params { tether_kind: kind, start_slack: 1.0, ..Params::default() };
            for (index, meta) in META.iter().enumerate() {
                let now = start.get(index).unwrap();
                let other =
                    if now < meta.max { (now * 1.01 + 0.01).min(meta.max) } else { meta.min };
                let mut params = start;
                if params.set(index, other).is_err() && params.set(index, meta.min).is_err() {
                    continue;
                }
                let mut config = Config::<f32>::new(&start, scale);
                let mut stale = Stale::after(meta.group);
                while config.renew(&mut stale, &params, scale) {}
                assert_eq!(print(&config), print(&Config::new(&params, scale)), "{}", meta.name);
            }
        }
    }

    #[test]
    fn a_gain_of_the_pendulum_concerns_the_pendulum_alone() {
        let mut stale = Stale::after(Group::Pendulum);
        assert_eq!((stale.take(), stale.take()), (Some(Part::Pendulum), None));
    }
}
