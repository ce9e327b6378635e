//! Fake analogue pin: 12 bits over 3.3 V.

use crate::battery::AdcPin;
use std::convert::Infallible;

const FULL_SCALE_MV: f64 = 3_300.0;
const COUNTS: f64 = 4_095.0;

/// One pin.
#[derive(Clone, Copy, Debug, Default)]
pub struct FakePin {
    volts: f64,
}

impl FakePin {
    /// The truth at the pin, V.
    pub fn set_volts(&mut self, volts: f64) {
        self.volts = volts;
    }
}

impl AdcPin for FakePin {
    type Error = Infallible;
    fn read_millivolts(&mut self) -> Result<u16, Infallible> {
        let counts = (self.volts * 1000.0 / FULL_SCALE_MV * COUNTS).round().clamp(0.0, COUNTS);
        Ok((counts / COUNTS * FULL_SCALE_MV).round() as u16)
    }
}
