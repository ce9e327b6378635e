//! The board's buses: each question goes to the fake that the simulator's own drivers would use.

use crate::flight::Environment;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{I2c, Operation as I2cOperation};
use embedded_hal::pwm::SetDutyCycle;
use embedded_hal::spi::SpiDevice;
use embedded_io::{Read, ReadReady};
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use std::io;
use tautline_firmware::mavlink::NewKey;
use tautline_firmware::param::Params;
use tautline_hal_shim::battery::AdcPin;
use tautline_hal_shim::fake::{FakeEsc, FakeFlash};
use tautline_hal_shim::motors::Protocol;
use tautline_hal_shim::parameters::ParameterStore;
use tautline_runtime::settings::Settings;
use tautline_runtime::wire::{OUTPUTS, Reply, Request};

use super::pipe::Pipe;

/// Sectors and words of the STM32F405 where the parameters are.
const SECTOR: usize = 0x4000;
const WORD: usize = 4;
/// Sectors 1 to 3.
const RANGE: std::ops::Range<u32> = 0x4000..0x1_0000;

/// What hangs on the board.
#[derive(Debug)]
pub struct Devices {
    /// World and sensors.
    pub environment: Environment,
    /// On the motor outputs.
    pub escs: [FakeEsc; OUTPUTS],
    /// Pulses as last written, shares of the period.
    pub pulses: [u16; OUTPUTS],
    flash: Option<FakeFlash<SECTOR, WORD>>,
}

impl Devices {
    /// Powers up; the flash holds the parameters that differ from their defaults, and the key.
    ///
    /// # Errors
    /// When they do not fit.
    pub fn new(
        environment: Environment,
        params: &Params,
        key: Option<&NewKey>,
        protocol: Protocol,
    ) -> io::Result<Self> {
        let flash = FakeFlash::<SECTOR, WORD>::new(4, 1);
        let wrong = |e| io::Error::other(format!("parameter flash: {e:?}"));
        let store = ParameterStore::try_new(flash, RANGE).map_err(wrong)?;
        let (mut settings, _) = Settings::load(store, Params::default()).map_err(wrong)?;
        while settings.store_next(params).map_err(wrong)? {}
        if let Some(key) = key {
            settings.keep(&key.kept()).map_err(wrong)?;
        }
        let escs = std::array::from_fn(|_| FakeEsc::new(environment.clock().clone(), protocol));
        Ok(Self { environment, escs, pulses: [0; OUTPUTS], flash: Some(settings.into_flash()) })
    }

    /// The parameters in the flash, as a board would load them.
    ///
    /// # Errors
    /// When the flash is unreadable.
    pub fn stored(&mut self) -> io::Result<Params> {
        let wrong = |e| io::Error::other(format!("parameter flash: {e:?}"));
        let flash = self.flash.take().unwrap_or_else(|| FakeFlash::new(4, 1));
        let store = ParameterStore::try_new(flash, RANGE).map_err(wrong)?;
        let (settings, _) = Settings::load(store, Params::default()).map_err(wrong)?;
        let params = *settings.params();
        self.flash = Some(settings.into_flash());
        Ok(params)
    }

    /// Answers a question about a bus; false for one that is none.
    ///
    /// # Errors
    /// When the board has gone.
    pub fn serve(&mut self, request: &Request, pipe: &mut Pipe) -> io::Result<bool> {
        let mut buffer = [0_u8; 512];
        let (imu, barometer, range, pins) = self.environment.sensors.buses();
        match *request {
            Request::Spi(out) => {
                let Some(bytes) = buffer.get_mut(..out.len()) else { return Ok(false) };
                bytes.copy_from_slice(out);
                match imu.transfer_in_place(bytes) {
                    Ok(()) => pipe.reply(&Reply::Bytes(bytes))?,
                    Err(never) => match never {},
                }
            }
            Request::I2c { address, write, read } => {
                let Some(bytes) = buffer.get_mut(..usize::from(read)) else { return Ok(false) };
                let mut both = [I2cOperation::Write(write), I2cOperation::Read(bytes)];
                let wanted = if read == 0 { both.get_mut(..1) } else { Some(&mut both[..]) };
                let done = wanted.map(|operations| barometer.transaction(address, operations));
                match done {
                    Some(Ok(())) => pipe.reply(&Reply::Bytes(bytes))?,
                    _ => pipe.reply(&Reply::Failed)?,
                }
            }
            Request::Range => {
                let mut filled = 0;
                while filled < 64 && range.read_ready().unwrap_or(false) {
                    let room = buffer.get_mut(filled..filled + 1).unwrap_or(&mut []);
                    filled += range.read(room).unwrap_or(0);
                }
                pipe.reply(&Reply::Bytes(buffer.get(..filled).unwrap_or(&[])))?;
            }
            Request::Pins => {
                let (Ok(voltage), Ok(current)) =
                    (pins.0.read_millivolts(), pins.1.read_millivolts());
                pipe.reply(&Reply::Pins(voltage, current))?;
            }
            Request::Delay(ns) => self.environment.clock().clone().delay_ns(ns),
            Request::Motors(pulses) => self.drive(pulses),
            Request::FlashRead { at, length } => {
                let bytes = buffer.get_mut(..usize::from(length));
                let read = self
                    .flash
                    .as_mut()
                    .zip(bytes)
                    .map(|(flash, bytes)| flash.read(at, bytes).map(|()| &*bytes));
                match read {
                    Some(Ok(bytes)) => pipe.reply(&Reply::Bytes(bytes))?,
                    _ => pipe.reply(&Reply::Failed)?,
                }
            }
            Request::FlashWrite { at, bytes } => {
                let done = self.flash.as_mut().is_some_and(|flash| flash.write(at, bytes).is_ok());
                pipe.reply(if done { &Reply::Done } else { &Reply::Failed })?;
            }
            Request::FlashErase { from, to } => {
                let done = self.flash.as_mut().is_some_and(|flash| flash.erase(from, to).is_ok());
                pipe.reply(if done { &Reply::Done } else { &Reply::Failed })?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn drive(&mut self, pulses: [u16; OUTPUTS]) {
        self.pulses = pulses;
        for (esc, pulse) in self.escs.iter_mut().zip(pulses) {
            let full = u32::from(esc.max_duty_cycle());
            let duty = (u32::from(pulse) * full + u32::from(u16::MAX / 2)) / u32::from(u16::MAX);
            match esc.set_duty_cycle(duty as u16) {
                Ok(()) => {}
                Err(never) => match never {},
            }
        }
    }
}
