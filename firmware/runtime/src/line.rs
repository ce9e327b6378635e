//! The line's own sensors at the vehicle: encoders, load cell, magnetometer. Each may be absent; read at its own pace,
//! below the flight task.

use crate::silence::Silence;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;
use tautline_firmware::signal::{RawAngles, RawLineSensors, RawMagnetometer, RawTension};
use tautline_firmware::time::Micros;
use tautline_hal_shim::encoder::as5600::{ADDRESS, ADDRESS_L, As5600};
use tautline_hal_shim::load_cell::nau7802::{self, Nau7802};
use tautline_hal_shim::magnetometer::ist8310::{self, Ist8310};

/// The encoders are read every so many milliseconds.
pub const ANGLES_MS: u64 = 10;
/// The load cell is asked.
pub const CELL_MS: u64 = 5;
/// The magnetometer too.
pub const MAGNETOMETER_MS: u64 = 10;

/// What is fitted: each on its bus. Of the encoders the outer is an AS5600, the inner an AS5600L.
#[derive(Debug)]
pub struct LineParts<A, C, M> {
    /// Where the line leaves: outer, inner.
    pub angles: Option<[A; 2]>,
    /// Between line and vehicle.
    pub cell: Option<C>,
    /// Anywhere far from the line's current.
    pub magnetometer: Option<M>,
}

/// The devices; a dead one is silent, and the sense stage forgets it.
#[derive(Debug)]
pub struct LineDevices<A, C, M> {
    angles: Option<Fitted<[As5600<A>; 2]>>,
    cell: Option<Fitted<Nau7802<C>>>,
    magnetometer: Option<Fitted<Ist8310<M>>>,
}

impl<A: I2c, C: I2c, M: I2c> LineDevices<A, C, M> {
    /// On their buses; touches nothing yet.
    pub fn new(parts: LineParts<A, C, M>) -> Self {
        Self {
            angles: parts.angles.map(|[outer, inner]| {
                Fitted::new([As5600::new(outer, ADDRESS), As5600::new(inner, ADDRESS_L)])
            }),
            cell: parts.cell.map(|bus| Fitted::new(Nau7802::new(bus))),
            magnetometer: parts.magnetometer.map(|bus| Fitted::new(Ist8310::new(bus))),
        }
    }

    /// Sets up what is fitted. What fails is silent, and [`Self::revive`] tries again.
    pub fn set_up(&mut self, delay: &mut impl DelayNs) {
        self.set_up_where(delay, |_| true);
    }

    /// Whether a part has been silent for so long that it wants setting up.
    #[must_use]
    pub fn wants_set_up(&self) -> bool {
        let Self { angles, cell, magnetometer } = self;
        angles.as_ref().is_some_and(|part| part.silence.is_long())
            || cell.as_ref().is_some_and(|part| part.silence.is_long())
            || magnetometer.as_ref().is_some_and(|part| part.silence.is_long())
    }

    /// Sets up anew what has been silent for long; at most one try per silence. A load cell takes half a second and more:
    /// on the ground only.
    pub fn revive(&mut self, delay: &mut impl DelayNs) {
        self.set_up_where(delay, Silence::is_long);
    }

    fn set_up_where(&mut self, delay: &mut impl DelayNs, is_due: impl Fn(&Silence) -> bool) {
        // A try that fails is silence anew: there is nobody to tell who could do more.
        if let Some(part) = self.angles.as_mut().filter(|part| is_due(&part.silence)) {
            part.silence.begin_anew();
            part.driver.iter_mut().for_each(|encoder| _ = encoder.init());
        }
        if let Some(part) = self.cell.as_mut().filter(|part| is_due(&part.silence)) {
            part.silence.begin_anew();
            let _ = part.driver.init(delay);
        }
        if let Some(part) = self.magnetometer.as_mut().filter(|part| is_due(&part.silence)) {
            part.silence.begin_anew();
            let _ = part.driver.init(delay);
        }
    }

    /// One millisecond: whatever is due goes into `sensors`; what has nothing new leaves its place as it is.
    pub fn poll(&mut self, at: Micros, sensors: &mut RawLineSensors) {
        let is_due = |every: u64| (at.0 / 1000).is_multiple_of(every);
        if let Some(fitted) = self.angles.as_mut().filter(|_| is_due(ANGLES_MS)) {
            let counts = fitted.driver.each_mut().map(As5600::poll);
            fitted.silence.note(ANGLES_MS, counts.iter().all(Result::is_ok));
            if counts.iter().any(Result::is_ok) {
                let counts = counts.map(|counts| counts.ok().flatten());
                sensors.angles = Some(RawAngles { counts });
            }
        }
        if let Some(fitted) = self.cell.as_mut().filter(|_| is_due(CELL_MS)) {
            match fitted.driver.poll() {
                Ok(Some(counts)) => {
                    fitted.silence.note(CELL_MS, true);
                    sensors.tension = Some(RawTension { counts });
                }
                Ok(None) | Err(nau7802::Error::Saturated) => {}
                Err(nau7802::Error::Silent) => fitted.silence.give_up(),
                Err(_) => fitted.silence.note(CELL_MS, false),
            }
        }
        if let Some(fitted) = self.magnetometer.as_mut().filter(|_| is_due(MAGNETOMETER_MS)) {
            match fitted.driver.poll() {
                Ok(Some(counts)) => {
                    fitted.silence.note(MAGNETOMETER_MS, true);
                    sensors.magnetometer = Some(RawMagnetometer { counts });
                }
                Ok(None) | Err(ist8310::Error::Saturated) => {}
                Err(_) => fitted.silence.note(MAGNETOMETER_MS, false),
            }
        }
    }

    /// The encoders' buses: outer, inner.
    pub fn angles(&mut self) -> Option<[&mut A; 2]> {
        self.angles.as_mut().map(|fitted| fitted.driver.each_mut().map(As5600::bus_mut))
    }

    /// The load cell's bus.
    pub fn cell(&mut self) -> Option<&mut C> {
        self.cell.as_mut().map(|fitted| fitted.driver.bus_mut())
    }

    /// The magnetometer's bus.
    pub fn magnetometer(&mut self) -> Option<&mut M> {
        self.magnetometer.as_mut().map(|fitted| fitted.driver.bus_mut())
    }
}

/// A driver, and for how long its part has failed.
#[derive(Debug)]
struct Fitted<D> {
    driver: D,
    silence: Silence,
}

impl<D> Fitted<D> {
    fn new(driver: D) -> Self {
        Self { driver, silence: Silence::default() }
    }
}
