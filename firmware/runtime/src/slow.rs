//! Barometer, rangefinder and battery: read at their own pace, below the flight task.

use crate::silence::Silence;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;
use embedded_io::{Read, ReadReady};
use tautline_firmware::sense::RawSensors;
use tautline_firmware::signal::{RawBarometer, RawBattery, RawRange};
use tautline_firmware::time::{Micros, Sample};
use tautline_hal_shim::barometer::dps310::{self, Dps310};
use tautline_hal_shim::battery::{AdcPin, BatteryMonitor};
use tautline_hal_shim::rangefinder::tfmini::TfMini;

/// The barometer is asked every so many milliseconds.
pub const BAROMETER_MS: u64 = 10;
/// The battery too.
pub const BATTERY_MS: u64 = 20;

/// The devices; a dead one is silent, and the sense stage notices.
#[derive(Debug)]
pub struct SlowDevices<I2C, UART, V, C> {
    /// On I2C.
    pub barometer: Dps310<I2C>,
    /// On its UART.
    pub range: TfMini<UART>,
    /// On two analogue pins.
    pub battery: BatteryMonitor<V, C>,
    silence: Silence,
}

impl<I2C, UART, V, C> SlowDevices<I2C, UART, V, C>
where
    I2C: I2c,
    UART: Read + ReadReady,
    V: AdcPin,
    C: AdcPin<Error = V::Error>,
{
    /// On their buses; touches nothing yet.
    pub fn new(i2c: I2C, uart: UART, battery: BatteryMonitor<V, C>) -> Self {
        Self {
            barometer: Dps310::new(i2c, dps310::ADDRESS),
            range: TfMini::new(uart),
            battery,
            silence: Silence::default(),
        }
    }

    /// Sets the barometer up.
    ///
    /// # Errors
    /// The driver's. The vehicle may fly by its rangefinder, and [`Self::poll`] tries again.
    pub fn set_up(&mut self, delay: &mut impl DelayNs) -> Result<(), dps310::Error<I2C::Error>> {
        self.barometer.init(delay)
    }

    /// Whether the barometer has been silent for so long that it wants setting up.
    #[must_use]
    pub fn wants_set_up(&self) -> bool {
        self.silence.is_long()
    }

    /// One millisecond: whatever is due goes into `sensors`; what has nothing new leaves its place as it is.
    pub fn poll(&mut self, at: Micros, sensors: &mut RawSensors) {
        let ms = at.0 / 1000;
        if ms.is_multiple_of(BAROMETER_MS) {
            match self.barometer.poll() {
                Ok(reading) => {
                    self.silence.note(BAROMETER_MS, true);
                    if let Some(reading) = reading {
                        sensors.barometer = Some(Sample { at, value: raw_barometer(&reading) });
                    }
                }
                Err(_) => self.silence.note(BAROMETER_MS, false),
            }
        }
        if let Ok(Some(reading)) = self.range.poll() {
            let value = RawRange { distance_cm: reading.distance_cm };
            sensors.range = Some(Sample { at, value });
        }
        if ms.is_multiple_of(BATTERY_MS)
            && let Ok(reading) = self.battery.read()
        {
            let value =
                RawBattery { voltage_mv: reading.voltage_mv, current_mv: reading.current_mv };
            sensors.battery = Some(Sample { at, value });
        }
    }

    /// Sets the barometer up anew after a long silence; at most one try per silence.
    pub fn revive(&mut self, delay: &mut impl DelayNs) {
        if self.wants_set_up() {
            self.silence.begin_anew();
            let _ = self.barometer.init(delay);
        }
    }
}

/// As the core takes it.
fn raw_barometer(reading: &dps310::Reading) -> RawBarometer {
    // 1/100 Pa of 100 kPa are more digits than an f32 has.
    let pressure_centipascal = (f64::from(reading.pressure) * 100.0 + 0.5) as i32;
    RawBarometer { pressure_centipascal, temperature: reading.temperature }
}
