//! Modes and failures as bars over time.

use super::chart::{Area, CAPTION, ESTIMATE, FONT, MARGIN, SETPOINT, X_LABELS};
use super::read::{FlightData, State};
use plotters::prelude::*;
use std::error::Error;
use tautline_firmware::supervisor::{FAILSAFES, MODES};

/// Room for the names, pixels.
const NAMES: u32 = 150;
/// Half of a bar, of a row's height.
const BAR: f64 = 0.3;

/// One bar.
#[derive(Clone, Debug, PartialEq)]
struct Bar {
    name: String,
    is_failure: bool,
    from: f64,
    to: f64,
}

fn mode_name(number: u8) -> String {
    let known = MODES.iter().find(|rule| rule.nav_state() == number);
    known.map_or_else(|| format!("nav_state {number}"), |rule| rule.name.to_owned())
}

/// What holds in a state: names, and whether they are failures.
fn holding(state: &State) -> Vec<(String, bool)> {
    let failures = FAILSAFES.iter().enumerate().filter(|(i, _)| state.failures >> i & 1 == 1);
    let failures = failures.map(|(_, row)| (row.name.replace('_', " "), true));
    state.mode.map(|mode| (mode_name(mode), false)).into_iter().chain(failures).collect()
}

/// One bar for as long as something holds.
fn bars(states: &[State], end: f64) -> Vec<Bar> {
    let mut bars: Vec<Bar> = Vec::new();
    let ends = states.iter().skip(1).map(|next| next.since).chain([end]);
    for (state, to) in states.iter().zip(ends) {
        for (name, is_failure) in holding(state) {
            let goes_on = |bar: &&mut Bar| bar.name == name && bar.to >= state.since;
            match bars.iter_mut().rev().find(goes_on) {
                Some(bar) => bar.to = to,
                None => bars.push(Bar { name, is_failure, from: state.since, to }),
            }
        }
    }
    bars
}

/// Draws them, a row for each mode and each failure that came, in their order.
pub fn draw_timeline(area: &Area, data: &FlightData) -> Result<(), Box<dyn Error>> {
    let bars = bars(&data.states, data.end());
    let mut names: Vec<&str> = Vec::new();
    for bar in &bars {
        if !names.contains(&bar.name.as_str()) {
            names.push(&bar.name);
        }
    }
    let last = names.len() as f64 - 0.5;
    let mut chart = ChartBuilder::on(area)
        .caption("Modes, and failures in red", ("sans-serif", CAPTION))
        .margin(MARGIN)
        .x_label_area_size(X_LABELS)
        .y_label_area_size(NAMES)
        .build_cartesian_2d(0.0..data.end(), last..-0.5)?;
    chart
        .configure_mesh()
        .x_desc("time, s")
        .disable_y_mesh()
        .light_line_style(RGBColor(240, 240, 240))
        .y_labels(names.len() * 2 + 1)
        .y_label_formatter(&|y| {
            let is_row = (y - y.round()).abs() < 1e-6 && *y >= 0.0;
            let name = names.get(y.round() as usize).filter(|_| is_row);
            name.map_or_else(String::new, |name| (*name).to_owned())
        })
        .label_style(("sans-serif", FONT))
        .axis_desc_style(("sans-serif", FONT + 1))
        .draw()?;
    chart.draw_series(bars.iter().map(|bar| {
        let row = names.iter().position(|name| *name == bar.name).unwrap_or(0) as f64;
        let colour = if bar.is_failure { ESTIMATE } else { SETPOINT };
        Rectangle::new([(bar.from, row - BAR), (bar.to, row + BAR)], colour.filled())
    }))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_lasts_while_its_mode_or_failure_does() {
        let state = |since, mode, failures| State { since, mode, failures };
        let states = [
            state(0.0, None, 0),
            state(2.0, Some(17), 0),
            state(5.0, Some(4), 0),
            state(7.0, Some(4), 1),
            state(8.0, Some(12), 1),
            state(9.0, None, 0),
        ];
        let found: Vec<_> =
            bars(&states, 10.0).into_iter().map(|b| (b.name, b.from, b.to)).collect();
        let expected = [
            ("Takeoff", 2.0, 5.0),
            ("Tether Hold", 5.0, 8.0),
            ("imu lost", 7.0, 9.0),
            ("Descent", 8.0, 9.0),
        ];
        assert_eq!(found, expected.map(|(name, from, to)| (name.to_owned(), from, to)));
        assert_eq!(mode_name(200), "nav_state 200");
    }
}
