//! What a page needs to know once: what may be asked for, and what the vehicle looks like.

use super::TRIALS;
use crate::flight::World;
use crate::scenario::{FAULTS, Scenario};
use serde::Serialize;
use tautline_firmware::model::TetherKind;
use tautline_firmware::supervisor::{FAILSAFES, FailsafeAction, Failsafes, MODES};

/// Description of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Panel {
    /// The scenario's line.
    pub title: String,
    /// MAVLink system under which this page asks.
    pub system: u8,
    /// Altitude of a take-off that nobody names, m.
    pub takeoff_altitude_m: f32,
    /// Of each rotor, in the order of the motor outputs.
    pub rotors: Vec<RotorPlace>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Of the line at the vehicle, body axes, m.
    pub attachment_m: [f64; 3],
    /// The line comes from a winch.
    pub has_winch: bool,
    /// Modes that this vehicle may fly.
    pub modes: Vec<ModeButton>,
    /// What can be broken.
    pub faults: Vec<FaultButton>,
    /// What the firmware does about it.
    pub failsafes: Vec<FailsafeRow>,
}

/// Where a rotor sits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RotorPlace {
    /// Forward, m.
    pub x_m: f64,
    /// To the right, m.
    pub y_m: f64,
    /// +1 where its drag turns the nose to the right: it turns to the left.
    pub spin: f64,
}

/// A mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeButton {
    /// As the operator reads it.
    pub name: &'static str,
    /// It flies by sticks.
    pub by_sticks: bool,
}

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FaultButton {
    /// As the scenario file spells it.
    pub kind: &'static str,
    /// Unit of its value; `None`: it has none.
    pub unit: Option<&'static str>,
    /// Smallest.
    pub least: f64,
    /// Largest.
    pub most: f64,
    /// What it does.
    pub doc: &'static str,
}

/// A row of the failsafe table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FailsafeRow {
    /// What the operator reads.
    pub text: &'static str,
    /// What the firmware then does, by this vehicle's parameters.
    pub action: &'static str,
    /// So long it must last, s.
    pub delay_s: f64,
    /// The fault that shows it in a hold; `None`: none does alone.
    pub trial: Option<TrialButton>,
}

/// What a click on a row breaks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrialButton {
    /// Kind of fault.
    pub kind: &'static str,
    /// Its value.
    pub value: f64,
    /// One motor, from 1.
    pub motor: Option<usize>,
}

impl Panel {
    /// For the page that asks as `system`.
    #[must_use]
    pub fn of(scenario: &Scenario, world: &World, system: u8) -> Self {
        let (params, plant) = (world.vehicle.params(), &world.environment.plant);
        let kind = TetherKind::from_parameter(params.tether_kind);
        let may = MODES.iter().filter(|rule| rule.is_built && rule.on.contains(kind));
        let model = plant.model();
        let place = |hub: &crate::plant::Hub| RotorPlace {
            x_m: hub.x * model.rotor.arm,
            y_m: hub.y * model.rotor.arm,
            spin: hub.spin,
        };
        Self {
            title: scenario.title.clone(),
            system,
            takeoff_altitude_m: params.takeoff_altitude,
            rotors: model.rotor.hubs.iter().map(place).collect(),
            mass_kg: model.body.mass,
            attachment_m: model.tether.attachment.into(),
            has_winch: model.tether.winch.is_some(),
            modes: may
                .map(|rule| ModeButton { name: rule.name, by_sticks: rule.needs.sticks })
                .collect(),
            faults: FAULTS
                .iter()
                .map(|rule| FaultButton {
                    kind: rule.name,
                    unit: rule.unit,
                    least: rule.range.0,
                    most: rule.range.1,
                    doc: rule.doc.trim(),
                })
                .collect(),
            failsafes: rows(&Failsafes::new(params)),
        }
    }
}

fn rows(failsafes: &Failsafes) -> Vec<FailsafeRow> {
    let row = |row: &tautline_firmware::supervisor::Failsafe| {
        let trial = TRIALS.iter().find(|trial| trial.failure == row.failure);
        FailsafeRow {
            text: row.text,
            action: match (row.action)(failsafes) {
                FailsafeAction::Hold => "holds",
                FailsafeAction::Land => "returns and lands",
                FailsafeAction::Descend => "descends where it is",
                FailsafeAction::Terminate => "motors off",
            },
            delay_s: (row.delay)(failsafes) as f64 * 1e-6,
            trial: trial.map(|trial| TrialButton {
                kind: trial.kind.rule().name,
                value: trial.value,
                motor: trial.motor,
            }),
        }
    };
    FAILSAFES.iter().map(row).collect()
}
