//! A pilot with a radio: what the hands do, its receiver, and the vehicle's own reader of it.

use crate::scenario::{FaultKind, Faults, RadioSection, Scenario};
use embedded_io::Write;
use tautline_firmware::sense::RawSensors;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_hal_shim::fake::{FakeClock, FakeReceiver, Protocol};
use tautline_hal_shim::radio::crsf::Crsf;
use tautline_hal_shim::radio::sbus::Sbus;
use tautline_runtime::radio::{Receiver, Telemeter};

/// All of it.
#[derive(Debug)]
pub struct PilotRadio {
    receiver: Receiver<FakeReceiver>,
    telemeter: Telemeter,
    /// What the hands do, at their times.
    pub hands: Vec<RadioSection>,
}

impl PilotRadio {
    /// `None` where the scenario has no receiver.
    pub fn new(scenario: &Scenario, clock: &FakeClock) -> Option<Self> {
        let protocol = scenario.sensors.radio.protocol()?;
        let part = FakeReceiver::new(clock.clone(), protocol);
        let receiver = match protocol {
            Protocol::Crsf => Receiver::Crsf(Crsf::new(part)),
            Protocol::Sbus => Receiver::Sbus(Sbus::new(part)),
        };
        let hands = scenario.radio.clone();
        Some(Self { receiver, telemeter: Telemeter::default(), hands })
    }

    /// One millisecond of the receiver.
    pub fn expose(&mut self, faults: &Faults, time: f64) {
        let part = self.receiver.bus_mut();
        part.is_removed = faults.is_active(FaultKind::RadioLost, time);
        part.is_failsafe = faults.is_active(FaultKind::RadioFailsafe, time);
        part.bit_errors = faults.added(FaultKind::RadioNoise, time);
        part.set_pilot(&RadioSection::channels(&self.hands, time));
    }

    /// The vehicle reads it.
    pub fn read(&mut self, at: Micros, sensors: &mut RawSensors) {
        self.receiver.poll(at, sensors);
    }

    /// The vehicle tells the pilot how it is.
    pub fn tell(&mut self, out: &StepOutput) {
        if let Receiver::Crsf(driver) = &mut self.receiver {
            let part = driver.bus_mut();
            self.telemeter.transmit(out, &mut |frame| {
                let _ = part.write_all(frame);
            });
        }
    }

    /// The receiver, as it is wired.
    pub fn part(&mut self) -> &mut FakeReceiver {
        self.receiver.bus_mut()
    }
}
