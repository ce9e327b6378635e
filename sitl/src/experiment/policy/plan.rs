//! A random flight: what the world does to the vehicle, and what strangers ask of it.

use crate::flight::MavlinkSender;
use crate::plant::{Generator, generator, uniform};
use crate::scenario::{Axis, FAULTS, FaultKind, FaultRule, FaultSection, Scenario};
use mavlink::dialects::common::{MANUAL_CONTROL_DATA, MavCmd, MavParamType, PARAM_SET_DATA};
use mavlink::types::CharArray;
use tautline_firmware::param::{Kind, META, Meta, Params};
use tautline_firmware::supervisor::MODES;

/// How long something may still begin, s.
pub const BUSY: f64 = 60.0;
/// Stream of random numbers apart from the world's.
const STREAM: u64 = 77;
const FAULTS_MOST: usize = 3;
const SETTINGS_MOST: usize = 3;
const ASKS_MOST: usize = 12;

/// The vehicles and links that fly: the shipped scenarios, of which the first two get a mission of their own.
const BASES: [&str; 6] = [
    "",
    "[tether]\nkind = \"fixed\"\n",
    include_str!("../../../scenarios/board.toml"),
    include_str!("../../../scenarios/taut.toml"),
    include_str!("../../../scenarios/angle.toml"),
    include_str!("../../../scenarios/pendulum.toml"),
];
const OWN_MISSION: usize = 2;

const MOTORS: [FaultKind; 2] = [FaultKind::MotorStop, FaultKind::MotorStuck];
/// What a vehicle is a match for: no file forbids 1,000 N, and no vehicle of 1.5 kg has a rule for them.
const MOST: [(&str, f64); 7] = [
    ("N", 10.0),
    ("m/s^2", 12.0),
    ("rad/s", 3.0),
    ("m/s", 8.0),
    ("m", 6.0),
    ("V", 8.0),
    ("kg", 0.5),
];

const COMMANDS: [MavCmd; 11] = [
    MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
    MavCmd::MAV_CMD_NAV_TAKEOFF,
    MavCmd::MAV_CMD_NAV_LAND,
    MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH,
    MavCmd::MAV_CMD_USER_1,
    MavCmd::MAV_CMD_USER_2,
    MavCmd::MAV_CMD_USER_3,
    MavCmd::MAV_CMD_DO_PAUSE_CONTINUE,
    MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION,
    MavCmd::MAV_CMD_PREFLIGHT_STORAGE,
    MavCmd::MAV_CMD_FIXED_MAG_CAL_YAW,
];

/// What a stranger sends.
#[derive(Clone, Debug)]
pub enum Ask {
    /// A command and its parameters.
    Command(MavCmd, [f32; 7]),
    /// A parameter and its value.
    Set(&'static Meta, f32),
    /// Roll, pitch, yaw, throttle, each -1..1.
    Sticks([f64; 4]),
    /// No message at all.
    Noise(Vec<u8>),
}

/// One flight.
#[derive(Clone, Debug)]
pub struct Plan {
    /// World and mission.
    pub scenario: Scenario,
    /// As the vehicle starts.
    pub params: Params,
    /// What is sent when, s; in the order of time.
    pub asks: Vec<(f64, Ask)>,
}

struct Dice(Generator);

impl Dice {
    /// From 0 to 1.
    fn share(&mut self) -> f64 {
        0.5 * (1.0 + uniform(&mut self.0))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.share() * count as f64) as usize).min(count.saturating_sub(1))
    }

    fn one_of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        let at = self.below(all.len());
        all.get(at).or(all.first()).unwrap_or_else(|| unreachable!("nothing to choose from"))
    }

    fn chance(&mut self, share: f64) -> bool {
        self.share() < share
    }

    /// Anything in a declared range: mostly near the default, now and then at an end.
    fn setting(&mut self, meta: &Meta) -> f32 {
        let (min, max, usual) = (f64::from(meta.min), f64::from(meta.max), f64::from(meta.default));
        let value = match self.below(5) {
            0 => min,
            1 => max,
            2 => self.between(min, max),
            _ => usual * 2.0_f64.powf(self.between(-2.0, 2.0)),
        };
        let value = if meta.kind == Kind::Int { value.round() } else { value };
        value.clamp(min, max) as f32
    }

    fn fault(&mut self, rule: &FaultRule) -> FaultSection {
        // Small values more often than large ones: what is out of all proportion is found out at once.
        let (min, max) = rule.range;
        let end = if self.chance(0.5) { max } else { min };
        let most = MOST.iter().find(|(unit, _)| rule.unit == Some(unit)).map_or(f64::MAX, |x| x.1);
        let reach = (end - rule.neutral).clamp(-most, most);
        let value = rule.neutral + reach * self.share().powi(3);
        let mut fault = FaultSection::new(rule.kind, value, self.between(0.0, BUSY));
        fault.duration = self.chance(0.5).then(|| self.between(0.05, 20.0));
        fault.ramp = if self.chance(0.3) { self.between(0.0, 20.0) } else { 0.0 };
        fault.axis = self.chance(0.5).then(|| *self.one_of(&[Axis::X, Axis::Y, Axis::Z]));
        fault.rotor = self.chance(0.5).then(|| 1 + self.below(4));
        fault
    }

    fn ask(&mut self) -> Ask {
        match self.below(10) {
            0 | 1 => {
                let mode = self.one_of(&MODES).custom_mode.to_le_bytes();
                Ask::Command(
                    MavCmd::MAV_CMD_DO_SET_MODE,
                    [1.0, f32::from(mode[2]), f32::from(mode[3]), 0.0, 0.0, 0.0, 0.0],
                )
            }
            2..=5 => {
                let meta = self.one_of(META);
                let value = self.setting(meta);
                Ask::Set(meta, value)
            }
            6 => Ask::Sticks(std::array::from_fn(|_| uniform(&mut self.0))),
            7 => Ask::Noise((0..self.below(300)).map(|_| self.below(256) as u8).collect()),
            _ => self.command(),
        }
    }

    fn command(&mut self) -> Ask {
        const NUMBERS: [f32; 8] = [f32::NAN, 0.0, 1.0, -1.0, 1e9, f32::INFINITY, 45.0, 5.0];
        let command = *self.one_of(&COMMANDS);
        let mut p: [f32; 7] = std::array::from_fn(|_| match self.below(3) {
            0 => *self.one_of(&NUMBERS),
            1 => f32::NAN,
            _ => self.between(-20.0, 90.0) as f32,
        });
        if command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM && self.chance(0.1) {
            [p[0], p[1]] = [0.0, 21196.0];
        }
        Ask::Command(command, p)
    }

    fn mission(&mut self) -> String {
        let (up, stay) = (self.between(1.5, 8.0), self.between(1.0, 8.0));
        let (azimuth, elevation) = (uniform(&mut self.0), self.between(0.5, 1.3));
        format!(
            "[[mission]]\ndo = \"arm\"\n[[mission]]\ndo = \"takeoff\"\naltitude = {up:.2}\n[[mission]]\ndo = \"hold\"\n\
             seconds = {stay:.1}\n[[mission]]\ndo = \"move\"\nazimuth = {azimuth:.2}\nelevation = {elevation:.2}\n\
             [[mission]]\ndo = \"hold\"\nseconds = 3.0\n[[mission]]\ndo = \"land\"\n"
        )
    }
}

impl Plan {
    /// The flight of a seed, always the same.
    ///
    /// # Errors
    /// A base that is no scenario.
    pub fn of_seed(seed: u64) -> Result<Self, String> {
        let mut dice = Dice(generator(seed, STREAM));
        // Most flights are those that most people fly.
        let base = if dice.chance(0.7) { dice.below(OWN_MISSION) } else { dice.below(BASES.len()) };
        let mut text = BASES.get(base).copied().unwrap_or_default().to_owned();
        if base < OWN_MISSION {
            let (speed, from) = (6.0 * dice.share().powi(2), uniform(&mut dice.0));
            text += &format!("[wind]\nspeed = {speed:.2}\nfrom = {from:.2}\ngusts = true\n");
            text += &dice.mission();
        }
        let mut scenario = Scenario::parse(&text, "policy").map_err(|e| e.0)?;
        for _ in 0..dice.below(FAULTS_MOST + 1) {
            let rule = dice.one_of(FAULTS);
            scenario.fault.push(dice.fault(rule));
        }
        let mut params = scenario.params().map_err(|e| e.0)?;
        if dice.chance(0.3) {
            for _ in 0..dice.below(SETTINGS_MOST + 1) {
                let at = dice.below(META.len());
                let value = META.get(at).map_or(0.0, |meta| dice.setting(meta));
                // Every value of a declared range is taken.
                params.set(at, value).map_err(|e| format!("{at} = {value}: {e:?}"))?;
            }
        }
        let count = if dice.chance(0.5) { dice.below(ASKS_MOST + 1) } else { 0 };
        let mut asks: Vec<_> = (0..count).map(|_| (dice.between(0.5, BUSY), dice.ask())).collect();
        asks.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok(Self { scenario, params, asks })
    }

    /// No more than one thing is broken, and no stranger set a parameter: whatever the sensors say, most of it is true. A
    /// quadrotor without a rotor is nobody's to command.
    #[must_use]
    pub fn is_simple(&self) -> bool {
        let usual = self.scenario.params().is_ok_and(|usual| usual == self.params);
        usual
            && self.scenario.fault.len() <= 1
            && !self.scenario.fault.iter().any(|f| MOTORS.contains(&f.kind))
            && !self.asks.iter().any(|(_, ask)| matches!(ask, Ask::Set(..)))
    }

    /// What had been done to the vehicle by then.
    #[must_use]
    pub fn about(&self, time: f64) -> String {
        let mut parts = vec![format!("{:?}", self.scenario.title)];
        if let Ok(usual) = self.scenario.params() {
            let changed = (0..).zip(META).filter(|(at, _)| usual.get(*at) != self.params.get(*at));
            let told =
                |(at, meta): (usize, &Meta)| format!("{} {:?}", meta.name, self.params.get(at));
            parts.extend(changed.map(told));
        }
        for fault in self.scenario.fault.iter().filter(|fault| fault.at <= time + 0.2) {
            let FaultSection { kind, value, at, duration, ramp, axis, rotor, .. } = fault;
            parts.push(format!(
                "{kind:?} {value:.3} at {at:.2} {duration:?} {ramp:.1} {axis:?} {rotor:?}"
            ));
        }
        for (at, ask) in self.asks.iter().filter(|(at, _)| *at <= time + 0.01) {
            parts.push(match ask {
                Ask::Set(meta, value) => format!("{} {value} at {at:.2}", meta.name),
                Ask::Command(command, p) => format!("{command:?} {p:?} at {at:.2}"),
                Ask::Sticks(sticks) => format!("sticks {sticks:.2?} at {at:.2}"),
                Ask::Noise(bytes) => format!("{} bytes at {at:.2}", bytes.len()),
            });
        }
        parts.join("; ")
    }
}

impl Ask {
    /// As it is sent to the vehicle `system`.
    #[must_use]
    pub fn datagram(&self, system: u8) -> Vec<u8> {
        let mut sender = MavlinkSender::new(255, 190);
        match self {
            Self::Command(command, p) => sender.command(system, *command, *p),
            Self::Set(meta, value) => {
                let (param_value, param_type) = match meta.kind {
                    Kind::Real => (*value, MavParamType::MAV_PARAM_TYPE_REAL32),
                    Kind::Int => {
                        let bits = f32::from_bits(*value as i32 as u32);
                        (bits, MavParamType::MAV_PARAM_TYPE_INT32)
                    }
                };
                sender.frame(&PARAM_SET_DATA {
                    param_value,
                    target_system: system,
                    target_component: 1,
                    param_id: CharArray::from(meta.name),
                    param_type,
                })
            }
            Self::Sticks([roll, pitch, yaw, throttle]) => {
                let unit = |x: &f64| (x.clamp(-1.0, 1.0) * 1e3) as i16;
                sender.frame(&MANUAL_CONTROL_DATA {
                    x: unit(pitch),
                    y: unit(roll),
                    z: unit(throttle).abs(),
                    r: unit(yaw),
                    target: system,
                    ..MANUAL_CONTROL_DATA::default()
                })
            }
            Self::Noise(bytes) => bytes.clone(),
        }
    }
}
