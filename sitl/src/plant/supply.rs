//! Power up the line: a voltage at the station, the line's resistance, a converter at the vehicle.

use crate::scenario::StationSection;

/// What the station feeds in.
#[derive(Clone, Debug)]
pub struct SupplyModel {
    /// At the station, V; zero: nothing comes up the line.
    pub voltage: f64,
    /// There and back, Ω per metre of line.
    pub resistance: f64,
    /// Most that the station gives, W.
    pub power_max: f64,
}

impl SupplyModel {
    /// As the scenario describes it.
    #[must_use]
    pub fn new(station: &StationSection) -> Self {
        Self {
            voltage: station.supply_voltage,
            resistance: station.supply_resistance,
            power_max: station.supply_power,
        }
    }
}

/// Now.
#[derive(Clone, Copy, Debug, Default)]
pub struct Supply {
    /// Through the line, A.
    pub current: f64,
    /// At the line's upper end, V.
    pub voltage: f64,
    /// The station feeds nothing: a fault.
    pub is_lost: bool,
}

/// Share of the most that a line of that resistance carries at all, at which the converter gives up.
const REACH: f64 = 0.95;

impl Supply {
    /// Takes a `power`, W, up `length` m of line; what arrives of it, W. The battery gives the rest.
    pub fn step(&mut self, model: &SupplyModel, length: f64, power: f64) -> f64 {
        if model.voltage <= 0.0 || self.is_lost {
            (self.current, self.voltage) = (0.0, 0.0);
            return 0.0;
        }
        let resistance = (model.resistance * length).max(1e-6);
        let most = REACH * model.voltage * model.voltage / (4.0 * resistance);
        // The station's limit is on what it feeds in; what the line loses is a small part of it.
        let given = power.min(most).min(model.power_max);
        // The upper of two voltages at which this power flows.
        let root = (model.voltage * model.voltage - 4.0 * given * resistance).max(0.0).sqrt();
        self.voltage = 0.5 * (model.voltage + root);
        self.current = given / self.voltage;
        given
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_arrives_and_what_the_line_loses_is_what_is_fed_in() {
        let model = SupplyModel { voltage: 400.0, resistance: 0.2, power_max: 3000.0 };
        let mut supply = Supply::default();
        let given = supply.step(&model, 80.0, 1500.0);
        assert!((given - 1500.0).abs() < 1e-9);
        let lost = supply.current * supply.current * 16.0;
        assert!((400.0 * supply.current - given - lost).abs() < 1e-6);
        // More than the line or the station can carry is left to the battery.
        assert!((supply.step(&model, 80.0, 9000.0) - 0.95 * 2500.0).abs() < 1e-6);
        assert!((supply.step(&model, 10.0, 9000.0) - 3000.0).abs() < 1e-6);
        let none = SupplyModel { voltage: 0.0, ..model };
        assert!(supply.step(&none, 10.0, 100.0) == 0.0 && supply.current == 0.0);
    }
}
