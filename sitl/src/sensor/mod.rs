//! Sensors at register level: truth + errors → fakes → the real drivers → [`RawSensors`].

mod errors;
mod line;
mod station;

pub use line::NEWTON_PER_COUNT;

use crate::plant::{Plant, V3, generator};
use crate::scenario::{FaultKind, Faults, Scenario, SensorSection};
use errors::{Altitude, Inertial};
use line::LineSensors;
use nalgebra::{Matrix3, RowVector3};
use rand_pcg::Pcg64Mcg;
use station::StationSensors;
use tautline_firmware::sense::{ImuScale, Mounting, RawSensors};
use tautline_firmware::signal::{RawFairlead, RawLineSensors, RawTether};
use tautline_firmware::time::{Micros, Sample};
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::fake::{FakeClock, FakeDps310, FakeIcm42688, FakePin, FakeTfMini};
use tautline_hal_shim::imu::icm42688::{self, Icm42688};
use tautline_runtime::inner_loop::{raw_imu, scale};
use tautline_runtime::slow::{BAROMETER_MS, SlowDevices};

/// Rangefinder below the centre of mass, as the parameter's default says, m.
const RANGE_OFFSET: f64 = 0.03;
/// Divider and shunt amplifier of the reference board.
const VOLTS_PER_VOLT: f64 = 11.0;
const AMPS_PER_VOLT: f64 = 25.0;
/// The winch transmits every so many milliseconds.
const WINCH_MS: u64 = 20;

/// All devices of the vehicle, and the winch's encoder.
#[derive(Debug)]
pub struct SensorSuite {
    clock: FakeClock,
    /// Body axes to the chip's.
    to_chip: Matrix3<f64>,
    rng: Pcg64Mcg,
    inertial: Inertial,
    altitude: Altitude,
    noise: SensorSection,
    imu: Icm42688<FakeIcm42688>,
    slow: SlowDevices<FakeDps310, FakeTfMini, FakePin, FakePin>,
    /// At the vehicle's end of the line.
    at_vehicle: LineSensors,
    station: StationSensors,
    winch: Option<RawTether>,
    /// What else the line's sensors say this millisecond.
    line: RawLineSensors,
}

impl SensorSuite {
    /// Devices under power that nobody has set up yet.
    #[must_use]
    pub fn new(scenario: &Scenario, clock: FakeClock, mounting: Mounting, seed: u64) -> Self {
        let noise = &scenario.sensors;
        let mut rng = generator(seed, 2);
        let imu = Icm42688::new(FakeIcm42688::new(clock.clone()), icm42688::Config::default());
        let mut range = FakeTfMini::new(clock.clone());
        range.lose_byte_every = noise.range_lost_bytes;
        let pins = BatteryMonitor::new(FakePin::default(), FakePin::default());
        Self {
            inertial: Inertial::new(noise, &mut rng),
            altitude: Altitude::default(),
            to_chip: to_chip(mounting),
            noise: noise.clone(),
            slow: SlowDevices::new(FakeDps310::new(clock.clone()), range, pins),
            station: StationSensors::new(&scenario.station, &mut generator(seed, 4)),
            at_vehicle: LineSensors::new(scenario, &clock, seed),
            winch: None,
            line: RawLineSensors::default(),
            clock,
            rng,
            imu,
        }
    }

    /// Runs the drivers' set-up.
    ///
    /// # Errors
    /// What a driver reports.
    pub fn set_up(&mut self) -> Result<(), String> {
        let mut delay = self.clock.clone();
        self.imu.init(&mut delay).map_err(|e| format!("ICM-42688-P: {e:?}"))?;
        self.slow.set_up(&mut delay).map_err(|e| format!("DPS310: {e:?}"))?;
        self.at_vehicle.set_up(&self.clock)
    }

    /// The devices on their buses, for a reader outside: inertial sensor, barometer, rangefinder, pins.
    pub fn buses(
        &mut self,
    ) -> (&mut FakeIcm42688, &mut FakeDps310, &mut FakeTfMini, (&mut FakePin, &mut FakePin)) {
        let SlowDevices { barometer, range, battery, .. } = &mut self.slow;
        (self.imu.bus_mut(), barometer.bus_mut(), range.bus_mut(), battery.pins_mut())
    }

    /// The winch's report of this millisecond.
    #[must_use]
    pub fn winch(&self) -> Option<RawTether> {
        self.winch
    }

    /// What one count of the inertial sensor means.
    #[must_use]
    pub fn scale(&self) -> ImuScale {
        scale(&self.imu)
    }

    /// One millisecond: exposes the devices to the world. Whoever reads them is another matter.
    pub fn expose(&mut self, plant: &Plant, faults: &Faults) {
        let us = self.clock.now_us();
        let (ms, time) = (us / 1000, us as f64 * 1e-6);
        if !faults.is_active(FaultKind::ImuSilent, time) {
            self.expose_imu(plant, faults, time);
        }
        if ms.is_multiple_of(BAROMETER_MS) {
            self.expose_barometer(plant, faults, time);
        }
        self.expose_range(plant, faults, time);
        let (voltage, current) = self.slow.battery.pins_mut();
        voltage.set_volts(plant.battery.voltage() / VOLTS_PER_VOLT);
        current.set_volts(plant.battery.current / AMPS_PER_VOLT);
        let has_winch = plant.model().tether.winch.is_some();
        let transmits = has_winch && !faults.is_active(FaultKind::WinchSilent, time);
        self.winch = None;
        self.line = RawLineSensors::default();
        if transmits && ms.is_multiple_of(WINCH_MS) {
            let mut length = self.station.length(plant, &self.noise, &mut self.rng);
            let extra = faults.value(FaultKind::LengthOffset, time).unwrap_or(0.0);
            length.length_mm = (length.length_mm + (extra * 1000.0) as i32).max(0);
            self.winch = Some(length);
            if self.noise.tension_cell {
                self.line.station_tension = Some(self.station.tension(plant, &mut self.rng));
            }
        }
        let field = faults.value(FaultKind::CompassDisturbed, time).unwrap_or(0.0) * 1e-6;
        self.at_vehicle.expose(plant, &self.noise, &self.to_chip, field);
        if self.noise.ground_angles && ms.is_multiple_of(WINCH_MS) {
            let extra = faults.value(FaultKind::FairleadOffset, time).unwrap_or(0.0) as f32;
            self.line.fairlead = self
                .station
                .direction(plant)
                .map(|shown| RawFairlead { azimuth: shown.azimuth + extra, ..shown });
        }
    }

    /// One millisecond: exposes the devices to the world and reads them.
    pub fn read(&mut self, plant: &Plant, faults: &Faults) -> RawSensors {
        self.expose(plant, faults);
        let at = Micros(self.clock.now_us());
        let is_silent = faults.is_active(FaultKind::ImuSilent, at.0 as f64 * 1e-6);
        let imu = if is_silent { None } else { self.imu.read_all().ok() };
        // Motion capture comes by the link.
        let mut sensors = RawSensors {
            imu: imu.map(|reading| Sample { at, value: raw_imu(&reading) }),
            tether: self.winch.map(|value| Sample { at, value }),
            line: self.line,
            ..RawSensors::default()
        };
        self.slow.poll(at, &mut sensors);
        self.at_vehicle.read(at, &mut sensors.line);
        sensors
    }

    fn expose_imu(&mut self, plant: &Plant, faults: &Faults, time: f64) {
        let extra = faults.value(FaultKind::GyroBias, time).unwrap_or(0.0);
        let (accel, gyro, temperature) =
            self.inertial.sample(&self.noise, plant, extra, &mut self.rng);
        let part = self.imu.bus_mut();
        part.is_hung = faults.is_active(FaultKind::ImuFrozen, time);
        part.is_dead = faults.is_active(FaultKind::ImuDead, time);
        let turned = |v: V3| -> [f64; 3] { (self.to_chip * v).into() };
        part.set_motion(turned(accel), turned(gyro), temperature);
    }

    fn expose_barometer(&mut self, plant: &Plant, faults: &Faults, time: f64) {
        let dt = BAROMETER_MS as f64 * 1e-3;
        let extra = faults.value(FaultKind::BarometerOffset, time).unwrap_or(0.0);
        let height = plant.body.height() + extra;
        let pressure = self.altitude.pressure(&self.noise, height, dt, &mut self.rng);
        let part = self.slow.barometer.bus_mut();
        part.is_dead = faults.is_active(FaultKind::BarometerLost, time)
            || faults.is_active(FaultKind::AltimeterLost, time);
        part.set_air(pressure, 24.0);
    }

    fn expose_range(&mut self, plant: &Plant, faults: &Faults, time: f64) {
        let part = self.slow.range.bus_mut();
        part.is_dead = faults.is_active(FaultKind::RangefinderLost, time)
            || faults.is_active(FaultKind::AltimeterLost, time);
        if part.is_due() {
            let distance = self.altitude.range(&self.noise, plant, RANGE_OFFSET, &mut self.rng);
            part.set_distance(distance + faults.value(FaultKind::RangeOffset, time).unwrap_or(0.0));
        }
    }
}

/// Body axes to the chip's: the inverse of the board's mounting, found from the mounting itself, since
/// a right-angle rotation is its own table of signs.
fn to_chip(mounting: Mounting) -> Matrix3<f64> {
    let axis = |chip: [i16; 3]| RowVector3::from(mounting.to_body(chip).map(f64::from));
    Matrix3::from_rows(&[axis([1, 0, 0]), axis([0, 1, 0]), axis([0, 0, 1])])
}
