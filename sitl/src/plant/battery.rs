//! Lithium battery: open-circuit voltage by charge, sag by resistance.

use crate::scenario::BatterySection;

/// Pack.
#[derive(Clone, Debug)]
pub struct BatteryModel {
    /// Cells in series.
    pub cells: f64,
    /// A h.
    pub capacity: f64,
    /// Pack and wiring, Ω.
    pub resistance: f64,
    /// At start, 0..1.
    pub charge: f64,
    /// Electronics, W.
    pub base_power: f64,
}

impl BatteryModel {
    /// As the scenario describes it.
    #[must_use]
    pub fn new(battery: &BatterySection) -> Self {
        Self {
            cells: battery.cells,
            capacity: battery.capacity,
            resistance: battery.resistance,
            charge: battery.charge,
            base_power: 4.0,
        }
    }
}

/// State.
#[derive(Clone, Debug)]
pub struct Battery {
    /// 0..1.
    pub charge: f64,
    /// A.
    pub current: f64,
    /// On top of the model's: a fault, Ω.
    pub extra_resistance: f64,
    voltage: f64,
}

impl Battery {
    /// At rest.
    #[must_use]
    pub fn new(model: &BatteryModel) -> Self {
        Self {
            charge: model.charge,
            current: 0.0,
            extra_resistance: 0.0,
            voltage: model.cells * open_circuit(model.charge),
        }
    }

    /// At the terminals, V.
    #[must_use]
    pub fn voltage(&self) -> f64 {
        self.voltage
    }

    /// Takes over voltage, V, and current, A, of another simulator's battery.
    pub fn show(&mut self, voltage: f64, current: f64) {
        (self.voltage, self.current) = (voltage, current);
    }

    /// Draws a power, W, for `dt` s.
    pub fn step(&mut self, model: &BatteryModel, power: f64, dt: f64) {
        let open = model.cells * open_circuit(self.charge);
        self.current = power / self.voltage.max(1.0);
        self.voltage =
            (open - self.current * (model.resistance + self.extra_resistance)).max(0.5 * open);
        self.charge = (self.charge - self.current * dt / (3600.0 * model.capacity)).max(0.0);
    }
}

/// Volts per cell of a lithium polymer cell at rest.
fn open_circuit(charge: f64) -> f64 {
    const CURVE: [(f64, f64); 6] =
        [(0.0, 3.2), (0.05, 3.5), (0.2, 3.7), (0.5, 3.82), (0.8, 4.0), (1.0, 4.2)];
    let mut last = (0.0, 3.2);
    for (c, v) in CURVE {
        if charge <= c {
            let span = (c - last.0).max(1e-9);
            return last.1 + (v - last.1) * ((charge - last.0) / span).clamp(0.0, 1.0);
        }
        last = (c, v);
    }
    last.1
}
