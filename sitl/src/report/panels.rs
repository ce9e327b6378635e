//! The charts of a flight, one each for what a log has something of.

use super::chart::{ESTIMATE, Line, Panel, SETPOINT, THIRD, TRUTH, TRUTH_FAINT};
use super::grid::Cell;
use super::read::{FlightData, Series};
use clap::ValueEnum;
use plotters::style::RGBColor;

/// One chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// From above.
    Map,
    /// Over the anchor.
    Height,
    /// The tether's elevation and azimuth.
    Angles,
    /// In the tether.
    Tension,
    /// Roll, pitch and yaw.
    Attitude,
    /// Throttles.
    Motors,
    /// Modes and failures over time.
    Modes,
    /// Its voltage.
    Battery,
    /// As it blew.
    Wind,
}

const ROTORS: [RGBColor; 8] = [
    RGBColor(40, 110, 200),
    RGBColor(200, 60, 40),
    RGBColor(40, 140, 90),
    RGBColor(190, 130, 20),
    RGBColor(130, 70, 170),
    RGBColor(30, 150, 170),
    RGBColor(120, 120, 120),
    RGBColor(170, 80, 110),
];

fn degrees(series: &Series) -> Series {
    series.iter().map(|&(t, a)| (t, a.to_degrees())).collect()
}

fn height(data: &FlightData) -> Cell {
    let up = |[_, _, down]: &[Series; 3]| down.iter().map(|&(t, z)| (t, -z)).collect();
    let lines = vec![
        Line::new("truth", TRUTH, up(&data.truth)),
        Line::new("estimate", ESTIMATE, up(&data.estimate)),
        Line::new("set-point", SETPOINT, up(&data.setpoint)),
    ];
    (Panel::new("Height over the anchor", "time, s", "m"), lines)
}

fn angles(data: &FlightData) -> Cell {
    let [true_elevation, true_azimuth, _] = &data.true_tether;
    let [elevation, azimuth, _] = &data.tether;
    let [by_inertia, _, setpoint] = &data.taut;
    let lines = vec![
        Line::new("truth", TRUTH, degrees(true_elevation)),
        Line::new("estimate", ESTIMATE, degrees(elevation)),
        Line::new("", TRUTH, degrees(true_azimuth)),
        Line::new("", ESTIMATE, degrees(azimuth)),
        Line::new("by inertia alone", THIRD, degrees(by_inertia)),
        Line::new("set-point", SETPOINT, degrees(setpoint)),
    ];
    (Panel::new("Tether elevation (upper) and azimuth (lower)", "time, s", "deg"), lines)
}

fn tension(data: &FlightData) -> Cell {
    let [[_, _, truth], [_, _, estimate]] = [&data.true_tether, &data.tether];
    let [_, by_inertia, _] = &data.taut;
    let lines = vec![
        Line::new("truth", TRUTH_FAINT, truth.clone()),
        Line::new("estimate", ESTIMATE, estimate.clone()),
        Line::new("asked of the winch", SETPOINT, data.winch.clone()),
        Line::new("by inertia alone", THIRD, by_inertia.clone()),
    ];
    (Panel::new("Tether tension", "time, s", "N"), lines)
}

fn attitude(data: &FlightData) -> Cell {
    let colours = [SETPOINT, ESTIMATE, THIRD];
    let truth = data.true_attitude.iter().map(|angle| Line::new("", TRUTH_FAINT, degrees(angle)));
    let names = ["roll", "pitch", "yaw"].into_iter().zip(colours);
    let own =
        names.zip(&data.attitude).map(|((name, c), angle)| Line::new(name, c, degrees(angle)));
    (Panel::new("Attitude (truth in grey)", "time, s", "deg"), truth.chain(own).collect())
}

fn motors(data: &FlightData) -> Cell {
    let turns = |series: &&Series| series.iter().any(|&(_, throttle)| throttle > 0.0);
    let lines = data
        .motors
        .iter()
        .filter(turns)
        .zip(ROTORS)
        .zip(1..)
        .map(|((series, c), i)| Line::new(format!("motor {i}"), c, series.clone()));
    (Panel::new("Throttles", "time, s", "0..1"), lines.collect())
}

fn wind(data: &FlightData) -> Cell {
    let names = ["North", "East", "Down"].into_iter().zip([SETPOINT, ESTIMATE, THIRD]);
    let blows = data.wind.iter().flatten().any(|&(_, speed)| speed != 0.0);
    let lines = names.zip(&data.wind).filter(|_| blows);
    let lines = lines.map(|((name, colour), series)| Line::new(name, colour, series.clone()));
    (Panel::new("Wind at the vehicle, towards", "time, s", "m/s"), lines.collect())
}

fn battery(data: &FlightData) -> Cell {
    let has_one = data.voltage.iter().any(|&(_, voltage)| voltage > 0.0);
    let lines = has_one.then(|| Line::new("", TRUTH, data.voltage.clone()));
    (Panel::new("Battery", "time, s", "V"), lines.into_iter().collect())
}

/// A map's tracks: East to the right, North up.
fn map(data: &FlightData) -> Cell {
    let track = |[north, east, _]: &[Series; 3]| {
        east.iter().zip(north).map(|(&(_, e), &(_, n))| (e, n)).collect::<Series>()
    };
    let lines = vec![
        Line::new("truth", TRUTH, track(&data.truth)),
        Line::new("estimate", ESTIMATE, track(&data.estimate)),
        Line::new("set-point", SETPOINT, track(&data.setpoint)),
    ];
    (Panel::new("Map (the dot is the anchor)", "East, m", "North, m"), lines)
}

impl Kind {
    /// Title and the lines that have points; `None` if none has, and for [`Self::Modes`], which are no lines.
    pub fn cell(self, data: &FlightData) -> Option<Cell> {
        let (panel, mut lines) = match self {
            Self::Map => map(data),
            Self::Height => height(data),
            Self::Angles => angles(data),
            Self::Tension => tension(data),
            Self::Attitude => attitude(data),
            Self::Motors => motors(data),
            Self::Battery => battery(data),
            Self::Wind => wind(data),
            Self::Modes => return None,
        };
        lines.retain(|line| !line.points.is_empty());
        (!lines.is_empty()).then_some((panel, lines))
    }

    /// Whether the log has something of it.
    pub fn is_there(self, data: &FlightData) -> bool {
        match self {
            Self::Modes => data.states.iter().any(|state| state.mode.is_some()),
            _ => self.cell(data).is_some(),
        }
    }
}
