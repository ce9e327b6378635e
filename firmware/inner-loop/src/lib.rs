//! One inertial sample, at the highest priority: read, step, motors.
//!
//! A crate of its own because generic code is built as the crate that names its types: here, for speed, while an
//! image is built for size.

#![no_std]
#![forbid(unsafe_code)]

use embedded_hal::delay::DelayNs;
use embedded_hal::pwm::SetDutyCycle;
use embedded_hal::spi::SpiDevice;
use tautline_firmware::param::Params;
use tautline_firmware::sense::ImuScale;
use tautline_firmware::signal::RawImu;
use tautline_firmware::time::{INNER_HZ, Micros, Sample};
use tautline_firmware::vehicle::{StepInput, StepOutput, Vehicle};
use tautline_hal_shim::imu::icm42688::{self, Icm42688};
use tautline_hal_shim::motors::{MotorOutputs, Protocol};

/// Inertial sensor, core and motors.
#[derive(Debug)]
pub struct InnerLoop<SPI, PWM> {
    /// On its bus.
    pub imu: Icm42688<SPI>,
    /// On their timers.
    pub motors: MotorOutputs<PWM>,
    /// The autopilot.
    pub vehicle: Vehicle,
}

/// What the ESCs are told in, by `MOT_PROTO`.
#[must_use]
pub fn protocol(params: &Params) -> Protocol {
    if params.output_protocol > 0.5 { Protocol::OneShot125 } else { Protocol::Pwm400 }
}

/// What one count of the sensor means.
#[must_use]
pub fn scale<SPI: SpiDevice>(imu: &Icm42688<SPI>) -> ImuScale {
    ImuScale { gyro: imu.gyro_scale(), accel: imu.accel_scale(), rate_hz: INNER_HZ }
}

/// As the core takes it.
#[must_use]
pub fn raw_imu(reading: &icm42688::Reading) -> RawImu {
    RawImu { accel: reading.accel, gyro: reading.gyro, temperature: reading.temperature }
}

/// [`Vehicle::step`] as boards fly it.
#[inline(never)]
pub fn step(vehicle: &mut Vehicle<f32>, input: &StepInput) {
    vehicle.step(input);
}

/// [`Vehicle::new`] as boards fly it.
#[inline(never)]
#[must_use]
pub fn vehicle(params: Params, scale: ImuScale) -> Vehicle<f32> {
    Vehicle::new(params, scale)
}

impl<SPI: SpiDevice, PWM: SetDutyCycle> InnerLoop<SPI, PWM> {
    /// On the ground, disarmed; `spi` is the inertial sensor's.
    pub fn new(spi: SPI, motors: MotorOutputs<PWM>, params: Params) -> Self {
        let imu = Icm42688::new(spi, icm42688::Config::default());
        let vehicle = vehicle(params, scale(&imu));
        Self { imu, motors, vehicle }
    }

    /// Sets the inertial sensor up, and tells the vehicle how many motors the board can drive.
    ///
    /// # Errors
    /// The driver's. Without the sensor the vehicle does not arm.
    pub fn set_up(&mut self, delay: &mut impl DelayNs) -> Result<(), icm42688::Error<SPI::Error>> {
        // Not in `new`: a vehicle that is changed before it is in its place would be built twice on the stack.
        self.vehicle.set_outputs(self.motors.outputs());
        self.imu.init(delay)
    }

    /// Reads the sensor if it `is_ready`.
    pub fn read(&mut self, at: Micros, is_ready: bool) -> Option<Sample<RawImu>> {
        let reading = if is_ready { self.imu.read_all().ok() } else { None };
        reading.map(|reading| Sample { at, value: raw_imu(&reading) })
    }

    /// One step of the autopilot.
    pub fn step(&mut self, input: &StepInput) {
        step(&mut self.vehicle, input);
    }

    /// What the last step said.
    #[must_use]
    pub fn output(&self) -> &StepOutput {
        self.vehicle.output()
    }

    /// The motors' pulses of the last step; then there is time for what waited.
    pub fn drive(&mut self) {
        // A timer's registers do not fail.
        let _ = self.motors.write(&self.vehicle.output().actuation.throttle);
        self.vehicle.maintain();
    }
}
