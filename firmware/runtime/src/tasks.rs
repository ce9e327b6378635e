//! What the tasks of an image do. The image gives each a vector, a priority and its board's types:
//!
//! ```text
//! data-ready edge ─▶ flight: burst, Vehicle::step, pulses ─▶ queue ─▶ comms: MAVLink, log ─▶ idle: card
//!                       ▲                                                │
//!                       └──────────────── inbox ◀── devices ◀────────────┘
//! ```

use crate::comms::Comms;
use crate::inbox::Inbox;
use crate::inner_loop::InnerLoop;
use crate::keys::KeyBox;
use crate::port::Port;
use crate::radio::{Downlink, Receiver};
use crate::recorder::Recorder;
use crate::settings::Settings;
use crate::slow::SlowDevices;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;
use embedded_hal::pwm::SetDutyCycle;
use embedded_hal::spi::SpiDevice;
use embedded_io::{Read, ReadReady};
use embedded_storage::nor_flash::NorFlash;
use heapless::spsc::Producer;
use rtic_core::Mutex;
use tautline_firmware::param::Params;
use tautline_firmware::sense::RawSensors;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::battery::AdcPin;

/// Steps that may wait for the communications task.
pub const OUTPUTS: usize = 5;
/// MAVLink's ports: USB, and the telemetry UART.
pub const PORTS: usize = 2;
/// Bytes read from a port at a time.
const PIECE: usize = 64;

/// What the flight task asks of a board besides its buses.
pub trait Pace {
    /// Time since power-up.
    fn now(&mut self) -> Micros;
    /// Whether the inertial sensor has a sample since the last call.
    fn take_ready(&mut self) -> bool;
    /// Around `Vehicle::step`: where its cost is counted.
    fn begin(&mut self) {}
    /// See [`Self::begin`].
    fn end(&mut self) {}
    /// The pulses are out: whoever steps is alive.
    fn stepped(&mut self, out: &StepOutput);
    /// The communications task did not keep up: a step goes untold.
    fn lost(&mut self);
}

/// One inertial sample, at the highest priority of those that compute.
pub fn flight<SPI: SpiDevice, PWM: SetDutyCycle>(
    flight: &mut InnerLoop<SPI, PWM>,
    pace: &mut impl Pace,
    outputs: &mut Producer<'static, StepOutput>,
    inbox: &mut impl Mutex<T = Inbox>,
    params: &mut impl Mutex<T = Params>,
) {
    let now = pace.now();
    let imu = flight.read(now, pace.take_ready());
    let mut input = inbox.lock(|inbox| inbox.take(now));
    input.sensors.imu = imu;
    pace.begin();
    flight.step(&input);
    pace.end();
    flight.drive();
    let out = flight.output();
    pace.stepped(out);
    if out.reply.is_some() {
        params.lock(|params| *params = *flight.vehicle.params());
    }
    if outputs.enqueue(*out).is_err() {
        pace.lost();
    }
}

/// MAVLink, the log and the pilot's screen, after each step.
pub fn comms(
    comms: &mut Comms<PORTS>,
    out: &StepOutput,
    ports: [&mut dyn Port; PORTS],
    log: &mut impl Recorder,
    radio: &mut Option<Downlink>,
    inbox: &mut impl Mutex<T = Inbox>,
    (params, keys): (&mut impl Mutex<T = Params>, &mut impl Mutex<T = KeyBox>),
) {
    if out.reply.is_some() {
        let params = params.lock(|params| *params);
        comms.set_params(&params);
    }
    for (index, port) in ports.into_iter().enumerate() {
        let mut buffer = [0; PIECE];
        loop {
            let bytes = port.take(&mut buffer);
            if bytes.is_empty() {
                break;
            }
            comms.receive(index, out.now, bytes, &mut |frame| port.put(frame));
        }
        comms.transmit(index, out, &mut |frame| port.put(frame));
        port.flush();
    }
    if let Some(radio) = radio {
        radio.transmit(out);
    }
    inbox.lock(|inbox| comms.collect(inbox));
    keys.lock(|keys| comms.keep(keys, out.is_armed));
    log.write(comms, out);
}

/// The parameters, or the signing key, could not be kept: the flash is worn or full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotStored;

/// Barometer, rangefinder, battery, radio, each millisecond at the lowest priority; on the ground also the parameters
/// and the signing key, one write at a time.
///
/// # Errors
/// [`NotStored`], once: nothing is stored from then on, or it would be told every millisecond.
pub fn devices<I2C, UART, V, C, F>(
    devices: &mut SlowDevices<I2C, UART, V, C>,
    radio: &mut Option<Receiver<impl Read + ReadReady>>,
    settings: &mut Option<Settings<F>>,
    (now, is_armed): (Micros, bool),
    delay: &mut impl DelayNs,
    inbox: &mut impl Mutex<T = Inbox>,
    (params, keys): (&mut impl Mutex<T = Params>, &mut impl Mutex<T = KeyBox>),
) -> Result<(), NotStored>
where
    I2C: I2c,
    UART: Read + ReadReady,
    V: AdcPin,
    C: AdcPin<Error = V::Error>,
    F: NorFlash,
{
    let mut sensors = RawSensors::default();
    devices.poll(now, &mut sensors);
    if let Some(radio) = radio {
        radio.poll(now, &mut sensors);
    }
    inbox.lock(|inbox| inbox.put(sensors));
    if is_armed {
        return Ok(());
    }
    devices.revive(delay);
    let key = keys.lock(|keys| keys.wanted());
    let is_stored = match (&mut *settings, key) {
        (None, Some(key)) => {
            keys.lock(|keys| keys.answer(key, false));
            true
        }
        (None, None) => true,
        (Some(stored), Some(key)) => {
            let is_stored = stored.keep(&key).is_ok();
            keys.lock(|keys| keys.answer(key, is_stored));
            is_stored
        }
        (Some(stored), None) => {
            let params = params.lock(|params| *params);
            stored.store_next(&params).is_ok()
        }
    };
    if is_stored {
        return Ok(());
    }
    *settings = None;
    Err(NotStored)
}
