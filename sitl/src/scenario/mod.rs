//! What is simulated: a TOML file, checked whole before the first step.
//!
//! Every key has a default (a 1.5 kg, 500 mm quadrotor on 4S and a constant-tension winch); unknown
//! keys are errors. Errors name file, key and allowed range. A key is one line of `sections.rs`.

mod arithmetic;
mod check;
mod companions;
mod fault;
mod key;
mod mission;
mod operator;
pub mod params_file;
mod preset;
mod radio;
mod sections;
pub mod settings;
mod template;
mod wind_row;

pub use arithmetic::Arithmetic;
#[cfg(feature = "cli")]
pub(crate) use check::within;
pub use companions::Gnss;
pub use fault::{
    Axis, FAULTS, FaultFacts, FaultKind, FaultRule, FaultSection, Faults, Source, When,
};
pub use key::Key;
pub use mission::{Step, TautControl, standard_mission};
pub use radio::{RadioKind, RadioSection};
pub use sections::{
    BaseSection, BatterySection, CaptureSection, DisturbanceKind, LineModel, PushSection,
    RodSection, SensorSection, StationSection, TetherKind, TetherSection, VehicleSection,
    WindSection, keys,
};
pub use template::{reference, template};
pub use wind_row::WindRow;

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use tautline_firmware::param::{META, ParamError, Params};
use toml::Table;

/// The whole file.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// One line for the start-up text.
    pub title: String,
    /// What the firmware computes with.
    pub scalar: Arithmetic,
    /// The vehicle.
    pub vehicle: VehicleSection,
    /// The tether and its ground end.
    pub tether: TetherSection,
    /// What the ground end measures and feeds in.
    pub station: StationSection,
    /// What it stands on.
    pub base: BaseSection,
    /// Wind.
    pub wind: WindSection,
    /// Motion capture.
    pub capture: CaptureSection,
    /// A load on top.
    pub rod: RodSection,
    /// A force on the vehicle.
    pub push: PushSection,
    /// Sensors.
    pub sensors: SensorSection,
    /// Battery.
    pub battery: BatterySection,
    /// Parameters of the firmware.
    pub params: BTreeMap<String, f32>,
    /// What a pilot does with a radio, at these times.
    pub radio: Vec<RadioSection>,
    /// Faults, at their times.
    pub fault: Vec<FaultSection>,
    /// What the built-in mission runner flies; empty: nobody flies.
    pub mission: Vec<Step>,
}

/// What is wrong with a scenario; one line, naming file and key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError(pub String);

impl std::fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}
impl std::error::Error for ScenarioError {}

impl Scenario {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`ScenarioError`].
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let name = path.display();
        let text =
            std::fs::read_to_string(path).map_err(|e| ScenarioError(format!("{name}: {e}")))?;
        Self::parse(&text, &name.to_string())
    }

    /// Checks a text; `name` stands in the errors.
    ///
    /// # Errors
    /// [`ScenarioError`].
    pub fn parse(text: &str, name: &str) -> Result<Self, ScenarioError> {
        let scenario: Self =
            toml::from_str(text).map_err(|e| ScenarioError(toml_error(name, text, &e)))?;
        // A second reading: the first one's errors name the lines of the file.
        let mut table = text.parse().unwrap_or_default();
        let scenario = if preset::write_out(&mut table) {
            table.try_into().map_err(|e| ScenarioError(format!("{name}: preset: {e}")))?
        } else {
            scenario
        };
        scenario.check().map_err(|e| ScenarioError(format!("{name}: {e}")))?;
        Ok(scenario)
    }

    /// Checks what stands in a file, after something was put in.
    ///
    /// # Errors
    /// One line naming the key.
    pub fn from_table(mut table: Table) -> Result<Self, String> {
        preset::write_out(&mut table);
        let scenario: Self =
            table.try_into().map_err(|e: toml::de::Error| e.message().replace('\n', " "))?;
        scenario.check()?;
        Ok(scenario)
    }
}

/// One line that names file and line.
pub(crate) fn toml_error(name: &str, text: &str, e: &toml::de::Error) -> String {
    let before = e.span().and_then(|span| text.get(..span.start)).unwrap_or("");
    let line = before.matches('\n').count() + 1;
    format!("{name}:{line}: {}", e.message().replace('\n', " "))
}

/// Sets a parameter by name.
///
/// # Errors
/// One line naming the parameter and what it may be.
pub fn set_param(params: &mut Params, name: &str, value: f32) -> Result<(), String> {
    let index = Params::index_of(name.as_bytes()).ok_or_else(|| {
        let start = name.split('_').next().unwrap_or(name);
        let near: Vec<_> =
            META.iter().map(|m| m.name).filter(|n| n.starts_with(start)).take(5).collect();
        let hint = if near.is_empty() {
            String::new()
        } else {
            format!("; there are {}", near.join(", "))
        };
        format!("no parameter {name}{hint}")
    })?;
    params.set(index, value).map_err(|e| match e {
        ParamError::OutOfRange { min, max } => {
            format!("{name} = {value} is outside {min} to {max}")
        }
        ParamError::NotANumber => format!("{name} = {value} is not a whole or finite number"),
        ParamError::Unknown => format!("no parameter {name}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_file_key_and_range() {
        let cases = [
            ("[vehicle]\nmass = -1.0", "s.toml: vehicle.mass = -1 is outside 0.1 to 50"),
            ("[wind]\nspeed = nan", "s.toml: wind.speed = NaN is outside 0 to 25"),
            ("[vehicle]\nmas = 1.0", "s.toml:2: unknown field `mas`"),
            (
                "[params]\nRATE_Q = 1.0",
                "s.toml: params.RATE_Q: no parameter RATE_Q; there are RATE_P",
            ),
            (
                "[params]\nVEH_MASS = 99.0",
                "s.toml: params.VEH_MASS: VEH_MASS = 99 is outside 0.1 to 50",
            ),
            ("[[fault]]\nkind = \"imu_frozen\"\nat = -2.0", "s.toml: fault[0].at = -2 is outside"),
            ("[[mission]]\ndo = \"loop\"", "unknown variant `loop`"),
            ("title = 3", "s.toml:1: invalid type"),
        ];
        for (text, want) in cases {
            let got = Scenario::parse(text, "s.toml").unwrap_err().0;
            assert!(got.contains(want), "{got:?} should contain {want:?}");
            assert!(!got.contains('\n'));
        }
    }

    #[test]
    fn every_key_is_listed_once_with_its_default_and_refused_beyond_its_range() {
        let all = toml::Value::try_from(Scenario::default()).unwrap();
        for key in keys() {
            let is_same = |other: &&Key| (other.section, other.name) == (key.section, key.name);
            assert_eq!(keys().filter(is_same).count(), 1, "{} twice", key.name);
            let default = (key.default)();
            let written = all.get(key.section).and_then(|section| section.get(key.name));
            assert_eq!(written, default.as_ref(), "{}", key.name);
            let Some((min, max)) = key.range else { continue };
            for beyond in [min - 1.0, 2.0 * max + 1.0] {
                let value = match default {
                    Some(toml::Value::Array(_)) => format!("[{max:?}, {beyond:?}, {max:?}]"),
                    // Below zero its type refuses it.
                    Some(toml::Value::Integer(_)) => format!("{}", beyond.abs() + max),
                    _ => format!("{beyond:?}"),
                };
                let text = format!("[{}]\n{} = {value}", key.section, key.name);
                let got = Scenario::parse(&text, "s.toml").unwrap_err().0;
                let (name, range) = (
                    format!("s.toml: {}.{}", key.section, key.name),
                    format!("is outside {min} to {max}"),
                );
                assert!(got.starts_with(&name) && got.ends_with(&range), "{got}");
            }
        }
    }

    #[test]
    fn a_preset_gives_what_the_file_leaves_out_and_every_one_makes_a_vehicle_that_lifts_its_line() {
        let text = |vehicle: &str, tether: &str| {
            format!(
                "[vehicle]\npreset = {vehicle:?}\nmass = 3.0\n[tether]\npreset = {tether:?}\nmodel = \"chain\""
            )
        };
        let scenario = Scenario::parse(&text("quad-3.5", "power-30"), "s.toml").unwrap();
        assert!((scenario.vehicle.mass - 3.0).abs() < 1e-12);
        assert!((scenario.vehicle.arm - 0.23).abs() < 1e-12);
        assert!((scenario.tether.line_density - 0.03).abs() < 1e-12);
        for (vehicle, length, density) in [
            ("quad-1.5", 10.0, 0.002),
            ("quad-3.5", 45.0, 0.03),
            ("quad-8", 80.0, 0.03),
            ("hexa-6", 60.0, 0.03),
            ("octo-9", 100.0, 0.03),
        ] {
            let text = format!("[vehicle]\npreset = {vehicle:?}");
            let v = Scenario::parse(&text, "s.toml").unwrap().vehicle;
            let most = crate::plant::hubs(&v).len() as f64
                * v.thrust_coefficient
                * v.rotor_speed_max
                * v.rotor_speed_max;
            let carried = (v.mass + length * density) * 9.81 + 10.0;
            assert!(most > 1.25 * carried, "{vehicle}: {most} N for {carried} N");
        }
        let unknown = Scenario::parse(&text("quad-4", "power-30"), "s.toml").unwrap_err().0;
        assert_eq!(
            unknown,
            "s.toml: vehicle.preset = \"quad-4\" is none of hexa-6, octo-9, quad-1.5, quad-3.5, quad-8"
        );
    }

    #[test]
    fn an_empty_file_is_the_default_vehicle() {
        assert_eq!(Scenario::parse("", "s.toml").unwrap(), Scenario::default());
        assert!(Scenario::default().params().is_ok());
    }
}
