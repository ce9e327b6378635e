//! Sensors at register level: truth + errors → fakes → the real drivers → [`RawSensors`].

mod errors;
mod faulty;
mod line;
mod pilot;
mod station;

pub use line::NEWTON_PER_COUNT;
pub use pilot::PilotRadio;

use crate::plant::{GRAVITY, Plant, V3, generator, normal};
use crate::scenario::{FaultKind, Faults, Scenario, SensorSection};
use errors::{Altitude, Inertial};
use faulty::{Arrival, EncoderFault, InertialFault};
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
pub(crate) const RANGE_OFFSET: f64 = 0.03;
/// Divider and shunt amplifier of the reference board.
const VOLTS_PER_VOLT: f64 = 11.0;
const AMPS_PER_VOLT: f64 = 25.0;
/// Height up to which the rotors' wind presses on the barometer, m.
const GROUND_EFFECT: f64 = 1.5;
/// The winch transmits every so many milliseconds.
const WINCH_MS: u64 = 20;

/// What another simulator measures, where the plant's truth is not what a device would see.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// By air pressure, m; `None`: the plant's.
    pub height: Option<f64>,
    /// To the ground, m; `None`: the rangefinder is silent.
    pub range: Option<f64>,
    /// The winch reports this millisecond.
    pub winch_reports: bool,
}

/// All devices of the vehicle, and the winch's encoder.
#[derive(Debug)]
pub struct SensorSuite {
    clock: FakeClock,
    /// Body axes to the chip's.
    to_chip: Matrix3<f64>,
    rng: Pcg64Mcg,
    /// For what only faults draw.
    fault_rng: Pcg64Mcg,
    /// What the rangefinder showed last, m.
    last_range: f64,
    inertial: Inertial,
    altitude: Altitude,
    noise: SensorSection,
    imu: Icm42688<FakeIcm42688>,
    slow: SlowDevices<FakeDps310, FakeTfMini, FakePin, FakePin>,
    /// At the vehicle's end of the line.
    at_vehicle: LineSensors,
    station: StationSensors,
    /// A pilot's radio, where the scenario has one.
    pub pilot: Option<PilotRadio>,
    encoder: EncoderFault,
    /// Of this millisecond's inertial sample.
    arrival: Arrival,
    inertial_fault: InertialFault,
    winch: Option<RawTether>,
    /// What else the line's sensors say this millisecond.
    line: RawLineSensors,
    /// By another simulator, this millisecond.
    pub measured: Option<Measured>,
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
            fault_rng: generator(seed, 6),
            last_range: 0.0,
            inertial: Inertial::new(noise, &mut rng),
            altitude: Altitude::default(),
            to_chip: to_chip(mounting),
            noise: noise.clone(),
            slow: SlowDevices::new(FakeDps310::new(clock.clone()), range, pins),
            station: StationSensors::new(&scenario.station, &mut generator(seed, 4)),
            at_vehicle: LineSensors::new(scenario, &clock, seed),
            pilot: PilotRadio::new(scenario, &clock),
            winch: None,
            encoder: EncoderFault::default(),
            arrival: Arrival::Never,
            inertial_fault: InertialFault::new(seed),
            line: RawLineSensors::default(),
            measured: None,
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
        self.arrival = self.inertial_fault.arrival(faults, time);
        if self.arrival != Arrival::Never {
            self.expose_imu(plant, faults, time);
        }
        if ms.is_multiple_of(BAROMETER_MS) {
            self.expose_barometer(plant, faults, time);
        }
        self.expose_range(plant, faults, time);
        if let Some(pilot) = &mut self.pilot {
            pilot.expose(faults, time);
        }
        let (voltage, current) = self.slow.battery.pins_mut();
        let shown = plant.battery.voltage() + faults.added(FaultKind::VoltageOffset, time);
        voltage.set_volts(shown.max(0.0) / VOLTS_PER_VOLT);
        current.set_volts(plant.battery.current / AMPS_PER_VOLT);
        let has_winch = plant.model().tether.winch.is_some();
        let transmits = has_winch && !faults.is_active(FaultKind::WinchSilent, time);
        self.winch = None;
        self.line = RawLineSensors::default();
        let reports =
            self.measured.map_or(ms.is_multiple_of(WINCH_MS), |measured| measured.winch_reports);
        if transmits && reports {
            let extra = self.encoder.error(plant.tether.length(), faults, time);
            let shown = self.station.length(plant, extra, &self.noise, &mut self.rng);
            self.winch = Some(self.encoder.hold(shown, faults, time));
            if self.noise.tension_cell {
                self.line.station_tension = Some(self.station.tension(plant, &mut self.rng));
            }
        }
        let field = faults.added(FaultKind::CompassDisturbed, time) * 1e-6;
        self.at_vehicle.expose(plant, &self.noise, &self.to_chip, field);
        if self.noise.ground_angles && ms.is_multiple_of(WINCH_MS) {
            let extra = faults.added(FaultKind::FairleadOffset, time) as f32;
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
        let imu = match self.arrival {
            Arrival::Never => None,
            Arrival::Comes { .. } => self.imu.read_all().ok(),
        };
        let at_imu = match self.arrival {
            Arrival::Comes { early_us, .. } => Micros(at.0.saturating_sub(early_us)),
            Arrival::Never => at,
        };
        // Motion capture comes by the link.
        let mut sensors = RawSensors {
            imu: imu.map(|reading| Sample { at: at_imu, value: raw_imu(&reading) }),
            tether: self.winch.map(|value| Sample { at, value }),
            line: self.line,
            ..RawSensors::default()
        };
        self.slow.poll(at, &mut sensors);
        if let Some(pilot) = &mut self.pilot {
            pilot.read(at, &mut sensors);
        }
        self.at_vehicle.read(at, &mut sensors.line);
        sensors
    }

    fn expose_imu(&mut self, plant: &Plant, faults: &Faults, time: f64) {
        let (mut accel, mut gyro, temperature) =
            self.inertial.sample(&self.noise, plant, &mut self.rng);
        self.inertial_fault.disturb(faults, time, plant, &mut accel, &mut gyro);
        let part = self.imu.bus_mut();
        let repeats = matches!(self.arrival, Arrival::Comes { repeats: true, .. });
        part.is_hung = repeats || faults.is_active(FaultKind::ImuFrozen, time);
        part.is_dead = faults.is_active(FaultKind::ImuDead, time);
        let turned = |v: V3| -> [f64; 3] { (self.to_chip * v).into() };
        part.set_motion(turned(accel), turned(gyro), temperature);
    }

    fn expose_barometer(&mut self, plant: &Plant, faults: &Faults, time: f64) {
        let dt = BAROMETER_MS as f64 * 1e-3;
        let noise = faults.added(FaultKind::BarometerNoise, time);
        // The rotors press the air against the ground.
        let over = plant.height_over_ground();
        let thrust = plant.thrust() / (plant.model().body.mass * GRAVITY);
        let pressed = faults.added(FaultKind::GroundEffect, time)
            * (1.0 - over / GROUND_EFFECT).clamp(0.0, 1.0)
            * thrust.clamp(0.0, 1.0);
        let extra = faults.added(FaultKind::BarometerOffset, time)
            + faults.added(FaultKind::BarometerDrift, time)
            - pressed;
        let random = if noise > 0.0 { noise * normal(&mut self.fault_rng) } else { 0.0 };
        let height = self.measured.and_then(|measured| measured.height);
        let height = height.unwrap_or(plant.body.height()) + extra + random;
        let pressure = self.altitude.pressure(&self.noise, height, dt, &mut self.rng);
        let is_stuck = faults.is_active(FaultKind::BarometerStuck, time);
        let part = self.slow.barometer.bus_mut();
        part.is_dead = faults.is_active(FaultKind::BarometerLost, time)
            || faults.is_active(FaultKind::AltimeterLost, time);
        if !is_stuck {
            part.set_air(pressure, 24.0);
        }
    }

    fn expose_range(&mut self, plant: &Plant, faults: &Faults, time: f64) {
        let part = self.slow.range.bus_mut();
        part.is_dead = faults.is_active(FaultKind::RangefinderLost, time)
            || faults.is_active(FaultKind::AltimeterLost, time)
            || self.measured.is_some_and(|measured| measured.range.is_none());
        if part.is_due() {
            let (noise, rng) = (&self.noise, &mut self.rng);
            let distance = match self.measured.and_then(|measured| measured.range) {
                Some(range) => self.altitude.measured_range(noise, range, rng),
                None => self.altitude.range(noise, plant, RANGE_OFFSET, rng),
            };
            let noise = faults.added(FaultKind::RangeNoise, time);
            let random = if noise > 0.0 { noise * normal(&mut self.fault_rng) } else { 0.0 };
            let shown = distance + faults.added(FaultKind::RangeOffset, time) + random;
            let shown = match faults.value(FaultKind::RangeStuck, time) {
                Some(value) if value > 0.0 => value,
                Some(_) => self.last_range,
                None => shown,
            };
            self.last_range = shown;
            part.set_distance(shown);
        }
    }
}

/// Body axes to the chip's: the inverse of the board's mounting, found from the mounting itself, since
/// a right-angle rotation is its own table of signs.
fn to_chip(mounting: Mounting) -> Matrix3<f64> {
    let axis = |chip: [i16; 3]| RowVector3::from(mounting.to_body(chip).map(f64::from));
    Matrix3::from_rows(&[axis([1, 0, 0]), axis([0, 1, 0]), axis([0, 0, 1])])
}
