//! Battery monitor: pin voltages to volts, amperes and what is left.

use crate::param::Params;
use crate::scalar::Scalar;
use crate::signal::{Battery, RawBattery};
use crate::time::{Micros, Sample};

/// Configuration.
#[derive(Clone, Copy, Debug)]
pub struct BatteryMonitor<S> {
    divider: S,
    amps_per_volt: S,
    per_cell: S,
    cell_empty: S,
    per_cell_span: S,
}

/// What moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct BatteryState<S> {
    last: Option<(Micros, Battery<S>)>,
}

impl<S: Scalar> BatteryMonitor<S> {
    pub fn new(p: &Params) -> Self {
        Self {
            divider: S::from_f32(p.battery_divider),
            amps_per_volt: S::from_f32(p.battery_amps_per_volt),
            per_cell: S::from_f32(1.0 / p.battery_cells.max(1.0)),
            cell_empty: S::from_f32(p.cell_empty),
            per_cell_span: S::from_f32(1.0 / (p.cell_full - p.cell_empty).max(0.05)),
        }
    }

    /// The battery, with this tick's reading if there is one.
    pub fn step(
        &self,
        state: &mut BatteryState<S>,
        raw: Option<Sample<RawBattery>>,
    ) -> Option<Battery<S>> {
        let Some(sample) = raw else {
            return state.last.map(|(_, battery)| battery);
        };
        let volts = |mv: u16| S::from_f32(f32::from(mv) * 1e-3);
        let voltage = volts(sample.value.voltage_mv) * self.divider;
        let current = volts(sample.value.current_mv) * self.amps_per_volt;
        let cell = voltage * self.per_cell;
        let (dt, previous) = match state.last {
            Some((at, battery)) => (S::from_f32(sample.at.seconds_since(at)), battery),
            None => (S::zero(), Battery { cell, ..Battery::default() }),
        };
        let cell = previous.cell + (cell - previous.cell) * S::lit(0.02);
        let battery = Battery {
            voltage,
            current,
            drawn: previous.drawn + current * dt,
            cell,
            remaining: ((cell - self.cell_empty) * self.per_cell_span).limit(S::zero(), S::one()),
        };
        state.last = Some((sample.at, battery));
        Some(battery)
    }
}
