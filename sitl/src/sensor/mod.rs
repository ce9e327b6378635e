//! Sensors at register level: truth + errors → fakes → the real drivers → [`RawSensors`].

mod capture;
mod errors;

pub use capture::MotionCapture;

use crate::inject::Faults;
use crate::plant::{Plant, generator};
use crate::scenario::{FaultKind, SensorSection};
use errors::{Altitude, Inertial};
use rand_pcg::Pcg64Mcg;
use tautline_firmware::sense::{ImuScale, Mounting, RawSensors};
use tautline_firmware::signal::{RawBarometer, RawBattery, RawImu, RawRange, RawTether};
use tautline_firmware::time::{INNER_HZ, Micros, Sample};
use tautline_hal_shim::barometer::dps310::{self, Dps310};
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::fake::{FakeClock, FakeDps310, FakeIcm42688, FakePin, FakeTfMini};
use tautline_hal_shim::imu::icm42688::{self, Icm42688};
use tautline_hal_shim::rangefinder::tfmini::TfMini;

/// Rangefinder below the centre of mass, as the parameter's default says, m.
const RANGE_OFFSET: f64 = 0.03;
/// Divider and shunt amplifier of the reference board.
const VOLTS_PER_VOLT: f64 = 11.0;
const AMPS_PER_VOLT: f64 = 25.0;
/// Slow devices are read every so many milliseconds.
const BAROMETER_MS: u64 = 10;
const BATTERY_MS: u64 = 20;
const WINCH_MS: u64 = 20;

/// All devices of the vehicle, and the winch's encoder.
#[derive(Debug)]
pub struct SensorSuite {
    clock: FakeClock,
    rng: Pcg64Mcg,
    inertial: Inertial,
    altitude: Altitude,
    noise: SensorSection,
    imu: Icm42688<FakeIcm42688>,
    barometer: Dps310<FakeDps310>,
    range: TfMini<FakeTfMini>,
    battery: BatteryMonitor<FakePin, FakePin>,
}

impl SensorSuite {
    /// Powers the devices up and runs the drivers' set-up.
    ///
    /// # Errors
    /// What a driver says.
    pub fn power_up(noise: &SensorSection, clock: FakeClock, seed: u64) -> Result<Self, String> {
        let mut rng = generator(seed, 2);
        let mut delay = clock.clone();
        let mut imu = Icm42688::new(FakeIcm42688::new(clock.clone()), icm42688::Config::default());
        imu.init(&mut delay).map_err(|e| format!("ICM-42688-P: {e:?}"))?;
        let mut barometer = Dps310::new(FakeDps310::new(clock.clone()), dps310::ADDRESS);
        barometer.init(&mut delay).map_err(|e| format!("DPS310: {e:?}"))?;
        let mut range = TfMini::new(FakeTfMini::new(clock.clone()));
        range.bus_mut().lose_byte_every = noise.range_lost_bytes;
        Ok(Self {
            inertial: Inertial::new(noise, &mut rng),
            altitude: Altitude::default(),
            noise: noise.clone(),
            battery: BatteryMonitor::new(FakePin::default(), FakePin::default()),
            clock,
            rng,
            imu,
            barometer,
            range,
        })
    }

    /// What one count of the inertial sensor means.
    #[must_use]
    pub fn scale(&self) -> ImuScale {
        ImuScale { gyro: self.imu.gyro_scale(), accel: self.imu.accel_scale(), rate_hz: INNER_HZ }
    }

    /// One millisecond: expose the devices to the world and read them.
    pub fn read(&mut self, plant: &Plant, faults: &Faults, mounting: Mounting) -> RawSensors {
        let us = self.clock.now_us();
        let (ms, time) = (us / 1000, us as f64 * 1e-6);
        let at = Micros(us);
        let is_present = |kind| faults.is_present(kind, time);
        RawSensors {
            imu: (!is_present(FaultKind::ImuSilent))
                .then(|| self.read_imu(plant, faults, mounting, time))
                .flatten()
                .map(|value| Sample { at, value }),
            barometer: ms
                .is_multiple_of(BAROMETER_MS)
                .then(|| self.read_barometer(plant, faults, time))
                .flatten()
                .map(|value| Sample { at, value }),
            range: self.read_range(plant, faults, time).map(|value| Sample { at, value }),
            battery: ms
                .is_multiple_of(BATTERY_MS)
                .then(|| self.read_battery(plant))
                .flatten()
                .map(|value| Sample { at, value }),
            tether: (ms.is_multiple_of(WINCH_MS)
                && plant.model().tether.winch.is_some()
                && !is_present(FaultKind::WinchSilent))
            .then(|| self.read_winch(plant))
            .map(|value| Sample { at, value }),
            // Motion capture comes by the link.
            capture: None,
            rod: None,
        }
    }

    fn read_imu(
        &mut self,
        plant: &Plant,
        faults: &Faults,
        mounting: Mounting,
        time: f64,
    ) -> Option<RawImu> {
        let extra = faults.value(FaultKind::GyroBias, time).unwrap_or(0.0);
        let (accel, gyro, temperature) =
            self.inertial.sample(&self.noise, plant, extra, &mut self.rng);
        let part = self.imu.bus_mut();
        part.is_hung = faults.is_present(FaultKind::ImuFrozen, time);
        part.is_dead = faults.is_present(FaultKind::ImuDead, time);
        part.set_motion(
            to_chip(mounting, accel.into()),
            to_chip(mounting, gyro.into()),
            temperature,
        );
        let reading = self.imu.read_all().ok()?;
        Some(RawImu { accel: reading.accel, gyro: reading.gyro, temperature: reading.temperature })
    }

    fn read_barometer(
        &mut self,
        plant: &Plant,
        faults: &Faults,
        time: f64,
    ) -> Option<RawBarometer> {
        let dt = BAROMETER_MS as f64 * 1e-3;
        let pressure = self.altitude.pressure(&self.noise, plant.body.height(), dt, &mut self.rng);
        let part = self.barometer.bus_mut();
        part.is_dead = faults.is_present(FaultKind::BarometerLost, time)
            || faults.is_present(FaultKind::AltimeterLost, time);
        part.set_air(pressure, 24.0);
        let reading = self.barometer.poll().ok().flatten()?;
        Some(RawBarometer {
            pressure_centipascal: (f64::from(reading.pressure) * 100.0).round() as i32,
            temperature: reading.temperature,
        })
    }

    fn read_range(&mut self, plant: &Plant, faults: &Faults, time: f64) -> Option<RawRange> {
        let part = self.range.bus_mut();
        part.is_dead = faults.is_present(FaultKind::RangefinderLost, time)
            || faults.is_present(FaultKind::AltimeterLost, time);
        if part.is_due() {
            let distance = self.altitude.range(&self.noise, plant, RANGE_OFFSET, &mut self.rng);
            part.set_distance(distance);
        }
        let reading = self.range.poll().ok().flatten()?;
        Some(RawRange { distance_cm: reading.distance_cm })
    }

    fn read_battery(&mut self, plant: &Plant) -> Option<RawBattery> {
        let (voltage, current) = self.battery.pins_mut();
        voltage.set_volts(plant.battery.voltage() / VOLTS_PER_VOLT);
        current.set_volts(plant.battery.current / AMPS_PER_VOLT);
        let reading = self.battery.read().ok()?;
        Some(RawBattery { voltage_mv: reading.voltage_mv, current_mv: reading.current_mv })
    }

    fn read_winch(&mut self, plant: &Plant) -> RawTether {
        let length =
            plant.tether.distance + self.noise.length_noise * crate::plant::normal(&mut self.rng);
        RawTether { length_mm: (length.max(0.0) * 1000.0).round() as i32 }
    }
}

/// Body axes to the chip's: the inverse of the board's mounting, found from the mounting itself, since
/// a right-angle rotation is its own table of signs.
fn to_chip(mounting: Mounting, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let axis = |chip: [i16; 3]| {
        let [bx, by, bz] = mounting.to_body(chip);
        f64::from(bx) * x + f64::from(by) * y + f64::from(bz) * z
    };
    [axis([1, 0, 0]), axis([0, 1, 0]), axis([0, 0, 1])]
}
