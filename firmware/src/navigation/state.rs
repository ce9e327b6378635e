//! What the navigation says of itself, and what it is told beside the sensors.

use super::alignment::AlignmentState;
use super::{HEADING_STEPS, Navigation, NavigationState, TOLD_SD, alignment};
use crate::frames::{Body, V3, World};
use crate::scalar::Scalar;
use crate::signal::{Estimate, Imu, Sensors};
use crate::time::OUTER_DT;

impl<S: Scalar> NavigationState<S> {
    /// The winch is asked for a tension, N. While nothing is felt, what acts beside the thrust follows it.
    pub(super) fn ask(&mut self, tension: S) {
        let before = core::mem::replace(&mut self.asked_tension, tension);
        if self.is_numb && before > S::lit(0.1) {
            self.beside_thrust *= (tension / before).min(S::lit(1.1));
        }
    }

    pub(super) fn count_heading(&mut self, sensors: &Sensors<S>) {
        if let Some(sd) = self.position.seen() {
            self.heading.see(sd);
        }
        self.heading_steps -= 1;
        if self.heading_steps == 0 {
            self.heading_steps = HEADING_STEPS;
            self.heading.step(S::from_f32(sensors.imu_temperature));
        }
    }

    /// Across the line of sight from the anchor, the place turns with the heading.
    pub(super) fn unsure_of_heading(&self, known: Estimate<S>) -> Estimate<S> {
        let variance = self.heading.variance();
        let heading_sd = variance.sqrt();
        let Some(World(place)) = known.position.filter(|_| known.tether.is_some()) else {
            return Estimate { heading_sd, ..known };
        };
        let with = |sd: S, arm: S| (sd * sd + arm * arm * variance).sqrt();
        let sd = known.position_sd;
        let position_sd = V3::new(with(sd.x, place.y), with(sd.y, place.x), sd.z);
        Estimate { heading_sd, position_sd, ..known }
    }

    /// Somebody says where the nose points, rad from North: the vehicle was turned about the anchor, or stands so.
    pub fn face(&mut self, heading: S) {
        let Some(attitude) = &mut self.alignment.attitude else {
            return;
        };
        let (.., yaw) = attitude.attitude.euler();
        let (.., flown) = self.position.attitude().unwrap_or(attitude.attitude).euler();
        alignment::turn(attitude, crate::math::wrap_pi(heading - yaw));
        self.position.turn(crate::math::wrap_pi(heading - flown));
        self.heading.see(S::lit(TOLD_SD));
    }

    /// Upward acceleration by the accelerometer, m/s².
    #[must_use]
    pub fn accel_up(&self) -> S {
        self.accel_up
    }

    /// Whether the position filter has diverged and must prove itself.
    pub fn doubt(&mut self, is_doubted: bool) {
        self.is_doubted = is_doubted;
    }

    /// Level velocity by inertia alone where no position is believed, m/s.
    #[must_use]
    pub fn drift(&self) -> World<V3<S>> {
        self.drift.velocity
    }

    /// Specific force of all that acts beside the thrust, of the last second, body axes, m/s².
    #[must_use]
    pub fn outside(&self) -> Body<V3<S>> {
        Body(self.beside_thrust)
    }

    /// A velocity that is believed, once a step of the outer loop, m/s.
    pub fn follow(&mut self, velocity: &World<V3<S>>) {
        self.drift.follow(velocity, S::lit(OUTER_DT));
    }

    /// Forgets level and bias, so that they are taken again.
    pub fn relevel(&mut self) {
        self.alignment = AlignmentState::default();
    }

    /// Moves the vehicle to the place from which the (new) configuration starts.
    pub fn replace(&mut self, config: &Navigation<S>) {
        self.position.replace(&config.position);
    }

    /// Inertial reading averaged over the last 250 Hz step, gyro bias not removed.
    #[must_use]
    pub fn average(&self) -> &Imu<S> {
        &self.average
    }

    /// How fast it slides on its feet before lift-off, level, world axes, m/s.
    #[must_use]
    pub fn sliding(&self) -> World<V3<S>> {
        World(self.lift_off.velocity)
    }

    /// Whether the full-state filter says how the vehicle sits.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.position.attitude().is_some()
    }

    /// Whether the vehicle has left the ground.
    #[must_use]
    pub fn is_airborne(&self) -> bool {
        self.position.is_airborne()
    }
}
