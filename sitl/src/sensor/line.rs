//! What the vehicle measures of its line, and what the line's current disturbs: encoders, load cell, magnetometer, and a
//! second inertial sensor.

use super::errors::{Inertial, vector};
use crate::plant::{Generator, Plant, V3, generator, normal, uniform};
use crate::scenario::{Scenario, SensorSection};
use nalgebra::Matrix3;
use tautline_firmware::signal::RawLineSensors;
use tautline_firmware::time::Micros;
use tautline_hal_shim::encoder::as5600::{ADDRESS, ADDRESS_L};
use tautline_hal_shim::fake::{FakeAs5600, FakeClock, FakeIcm42688, FakeIst8310, FakeNau7802};
use tautline_hal_shim::imu::icm42688::{self, Icm42688};
use tautline_runtime::inner_loop::raw_imu;
use tautline_runtime::line::{LineDevices, LineParts};

/// Of the load cell and its amplifier, N per count.
pub const NEWTON_PER_COUNT: f64 = 1e-4;
/// How the field of the line's current lies in the body, of unit length: the line runs down the mast behind the part.
const CURRENT_FIELD: [f64; 3] = [0.6, -0.8, 0.0];

/// The parts that are fitted, with this vehicle's errors.
#[derive(Debug)]
pub struct LineSensors {
    rng: Generator,
    devices: LineDevices<FakeAs5600, FakeNau7802, FakeIst8310>,
    second: Option<(Icm42688<FakeIcm42688>, Inertial)>,
    /// Of the encoders, rad: outer, inner.
    angle_offset: [f64; 2],
    hard_iron: V3,
    soft_iron: V3,
}

impl LineSensors {
    pub fn new(scenario: &Scenario, clock: &FakeClock, seed: u64) -> Self {
        let noise = &scenario.sensors;
        let mut rng = generator(seed, 5);
        let imu = || Icm42688::new(FakeIcm42688::new(clock.clone()), icm42688::Config::default());
        let parts = LineParts {
            angles: noise
                .vehicle_angles
                .then(|| [FakeAs5600::new(ADDRESS), FakeAs5600::new(ADDRESS_L)]),
            cell: noise.tension_cell.then(|| FakeNau7802::new(clock.clone())),
            magnetometer: noise.magnetometer.then(|| FakeIst8310::new(clock.clone())),
        };
        Self {
            devices: LineDevices::new(parts),
            angle_offset: std::array::from_fn(|_| uniform(&mut rng) * noise.angle_offset),
            hard_iron: vector(&mut rng, uniform) * noise.magnetic_offset,
            soft_iron: V3::repeat(1.0) + vector(&mut rng, uniform) * noise.magnetic_scale,
            second: noise.second_imu.then(|| (imu(), Inertial::new(noise, &mut rng))),
            rng,
        }
    }

    /// # Errors
    /// What the second inertial sensor's driver reports; of the others the vehicle is told in the air.
    pub fn set_up(&mut self, clock: &FakeClock) -> Result<(), String> {
        let mut delay = clock.clone();
        self.devices.set_up(&mut delay);
        let second = self.second.as_mut().map_or(Ok(()), |(imu, _)| imu.init(&mut delay));
        second.map_err(|e| format!("second ICM-42688-P: {e:?}"))
    }

    /// One millisecond: exposes the parts to the world, with a field along the right arm, T, that is not the earth's.
    pub fn expose(
        &mut self,
        plant: &Plant,
        noise: &SensorSection,
        to_chip: &Matrix3<f64>,
        disturbance: f64,
    ) {
        let rng = &mut self.rng;
        if let Some(parts) = self.devices.angles() {
            let angles = angles(&line_in_body(plant));
            for ((part, angle), offset) in parts.into_iter().zip(angles).zip(self.angle_offset) {
                part.set_angle(angle + offset);
            }
        }
        if let Some(part) = self.devices.cell() {
            let shown = plant.tether.tension() + noise.cell_noise * normal(rng);
            part.set_counts(shown / NEWTON_PER_COUNT);
        }
        if let Some(part) = self.devices.magnetometer() {
            let earth = plant.body.attitude.inverse() * V3::from(noise.magnetic_field);
            let current = noise.magnetic_per_ampere * plant.supply.current;
            let field = earth.component_mul(&self.soft_iron)
                + self.hard_iron
                + V3::from(CURRENT_FIELD) * current
                + V3::y() * disturbance
                + vector(rng, normal) * noise.magnetic_noise;
            part.set_field((to_chip * field).into());
        }
        if let Some((imu, errors)) = &mut self.second {
            let (accel, gyro, temperature) = errors.sample(noise, plant, rng);
            let turned = |v: V3| -> [f64; 3] { (to_chip * v).into() };
            imu.bus_mut().set_motion(turned(accel), turned(gyro), temperature);
        }
    }

    /// The drivers read what is due.
    pub fn read(&mut self, at: Micros, sensors: &mut RawLineSensors) {
        self.devices.poll(at, sensors);
        if let Some(Ok(reading)) = self.second.as_mut().map(|(imu, _)| imu.read_all()) {
            sensors.second_imu = Some(raw_imu(&reading));
        }
    }
}

/// Down the line from the vehicle, body axes; a line that does not pull hangs.
fn line_in_body(plant: &Plant) -> V3 {
    let pull = plant.tether.pull();
    let down = if pull.norm() < 0.5 { V3::z() } else { pull };
    plant.body.attitude.inverse() * down
}

/// Of a gimbal whose outer axis is the nose's and whose inner one the right-hand's, rad.
fn angles(line: &V3) -> [f64; 2] {
    [(-line.y).atan2(line.z), line.x.clamp(-1.0, 1.0).asin()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn the_two_angles_are_those_of_the_gimbal_that_turns_down_into_the_line() {
        for (outer, inner) in [(0.0, 0.0), (0.4, -0.3), (-1.2, 0.9)] {
            let turned = Rotation3::from_axis_angle(&V3::x_axis(), outer)
                * Rotation3::from_axis_angle(&V3::y_axis(), inner);
            let [a, b] = angles(&(turned * V3::z()));
            assert!((a - outer).abs() < 1e-12 && (b - inner).abs() < 1e-12);
        }
    }
}
