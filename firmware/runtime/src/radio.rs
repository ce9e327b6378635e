//! A pilot's radio: frames of channels in, and what the pilot's transmitter shows of the vehicle out.

use crate::port::{Inward, Outward, Queued};
use core::fmt::Write;
use embedded_io::{Read, ReadReady};
use heapless::String;
use tautline_firmware::sense::RawSensors;
use tautline_firmware::signal::RawRadio;
use tautline_firmware::time::{Micros, Sample};
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::radio::Reading;
use tautline_hal_shim::radio::crsf::{Crsf, FRAME_MAX, Telemetry, telemetry};
use tautline_hal_shim::radio::sbus::Sbus;

/// From one frame of telemetry to the next, µs: a slow link carries some ten a second.
const PERIOD_US: u64 = 100_000;
/// From ampere seconds to milliampere hours.
const MILLIAMPERE_HOURS: f32 = 1.0 / 3.6;

/// A receiver on its UART.
#[derive(Debug)]
pub enum Receiver<UART> {
    /// Both ways.
    Crsf(Crsf<UART>),
    /// One way; the wire is inverted.
    Sbus(Sbus<UART>),
}

impl<UART: Read + ReadReady> Receiver<UART> {
    /// One millisecond: a frame that has come goes into `sensors`. A receiver that is gone is silent.
    pub fn poll(&mut self, at: Micros, sensors: &mut RawSensors) {
        let reading = match self {
            Self::Crsf(driver) => driver.poll(),
            Self::Sbus(driver) => driver.poll(),
        };
        if let Ok(Some(reading)) = reading {
            sensors.radio = Some(Sample { at, value: raw_radio(&reading) });
        }
    }

    /// The UART, for its owner.
    pub fn bus_mut(&mut self) -> &mut UART {
        match self {
            Self::Crsf(driver) => driver.bus_mut(),
            Self::Sbus(driver) => driver.bus_mut(),
        }
    }
}

/// The way back to a receiver: queue, interrupt, and what is due.
pub struct Downlink {
    out: Outward,
    pend: fn(),
    telemeter: Telemeter,
}

impl Downlink {
    /// After a step. What finds no room is left out: the next is newer.
    pub fn transmit(&mut self, out: &StepOutput) {
        let Self { out: queue, pend, telemeter } = self;
        telemeter.transmit(out, &mut |frame| {
            queue.put(frame);
            pend();
        });
    }
}

/// A CRSF receiver on a UART: for the task that reads it, and for the one that tells it.
pub fn split(port: Queued) -> (Receiver<Inward>, Downlink) {
    let Queued { out, inward, pend } = port;
    let telemeter = Telemeter::default();
    (Receiver::Crsf(Crsf::new(inward)), Downlink { out, pend, telemeter })
}

/// As the core takes it.
fn raw_radio(reading: &Reading) -> RawRadio {
    RawRadio {
        channels: reading.channels,
        link_quality: reading.link_quality,
        rssi_dbm: reading.rssi_dbm,
        is_failsafe: reading.is_failsafe,
    }
}

/// Battery, attitude and mode back to the pilot, one after the other. Only CRSF's wire has a way back.
#[derive(Debug, Default)]
pub struct Telemeter {
    due: Micros,
    turn: u8,
}

impl Telemeter {
    /// After a step; nothing before a receiver was heard.
    pub fn transmit(&mut self, out: &StepOutput, put: &mut dyn FnMut(&[u8])) {
        if out.radio.is_none() || out.now < self.due {
            return;
        }
        self.due = Micros(out.now.0 + PERIOD_US);
        self.turn = (self.turn + 1) % 4;
        let mut buffer = [0; FRAME_MAX];
        let mut text = String::<24>::new();
        let kind = match self.turn {
            0 => {
                let battery = out.sensors.battery.unwrap_or_default();
                Telemetry::Battery {
                    voltage: battery.voltage,
                    current: battery.current,
                    drawn: battery.drawn * MILLIAMPERE_HOURS,
                    remaining: battery.remaining,
                }
            }
            2 => {
                // A star while the motors stand, as pilots know it.
                let mark = if out.is_armed { "" } else { "*" };
                let _ = write!(text, "{}{mark}", out.mode.rule().name);
                Telemetry::Mode(&text)
            }
            _ => Telemetry::Attitude(out.estimate.attitude.euler().into()),
        };
        put(telemetry(&kind, &mut buffer));
    }
}
