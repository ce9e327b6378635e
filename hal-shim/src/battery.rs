//! Battery monitor: two analogue pins. embedded-hal 1.0 has no ADC trait; this is the smallest one.

/// A pin that an ADC reads.
pub trait AdcPin {
    /// What may go wrong.
    type Error: core::fmt::Debug;
    /// Voltage at the pin, mV.
    ///
    /// # Errors
    /// The converter's.
    fn read_millivolts(&mut self) -> Result<u16, Self::Error>;
}

/// One reading, mV at the pins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// Behind the voltage divider.
    pub voltage_mv: u16,
    /// At the current sensor.
    pub current_mv: u16,
}

/// Voltage and current pin.
#[derive(Debug)]
pub struct BatteryMonitor<V, I> {
    voltage: V,
    current: I,
}

impl<V: AdcPin, I: AdcPin<Error = V::Error>> BatteryMonitor<V, I> {
    /// Scales belong to the parameters.
    pub fn new(voltage: V, current: I) -> Self {
        Self { voltage, current }
    }

    /// Reads both pins.
    ///
    /// # Errors
    /// The converter's.
    pub fn read(&mut self) -> Result<Reading, V::Error> {
        Ok(Reading {
            voltage_mv: self.voltage.read_millivolts()?,
            current_mv: self.current.read_millivolts()?,
        })
    }

    /// The pins, for their owner.
    pub fn pins_mut(&mut self) -> (&mut V, &mut I) {
        (&mut self.voltage, &mut self.current)
    }
}
