//! In what state vehicle, estimator and sensors are: PX4's topics of it, with its names and numbers.

use super::flight::RARE;
use super::ulog::record;
use crate::supervisor::{Failure, GroundState};
use crate::vehicle::StepOutput;

/// PX4's `VEHICLE_TYPE_ROTARY_WING`.
const ROTARY_WING: u8 = 1;

record! {
    /// `vehicle_status`.
    VehicleStatus {
        /// 1 disarmed, 2 armed.
        arming_state: u8,
        /// PX4's number of the mode: `ModeRule::nav_state`.
        nav_state: u8,
        /// 0 on ground, 1 taking off, 2 in air, 3 landing.
        ground_state: u8,
        /// 1: a multirotor.
        vehicle_type: u8,
        /// `MAV_TYPE`.
        system_type: u8,
        /// It is none.
        is_vtol: bool,
        /// A failsafe is active.
        failsafe: bool,
        /// And the operator flies by joystick all the same.
        failsafe_and_user_took_over: bool,
        /// Bit n: row n of the failsafe table.
        failures: u32,
        /// All arming checks pass.
        pre_flight_checks_pass: bool,
    }
    topic "vehicle_status" every RARE, on change true;
    of |out, scale| {
        let (failsafe, rule) = (out.failures != 0, out.mode.rule());
        Some(Self {
            timestamp: out.now.0,
            arming_state: if out.is_armed { 2 } else { 1 },
            nav_state: rule.nav_state(),
            ground_state: match out.ground {
                GroundState::OnGround => 0,
                GroundState::TakingOff => 1,
                GroundState::InAir => 2,
                GroundState::Landing => 3,
            },
            vehicle_type: ROTARY_WING,
            system_type: scale.mav_type,
            is_vtol: false,
            failsafe,
            failsafe_and_user_took_over: failsafe && rule.needs.sticks,
            failures: out.failures,
            pre_flight_checks_pass: out.is_armable,
        })
    }
}
record! {
    /// `vehicle_land_detected`. On the ground is one state here, and its stages are one.
    VehicleLandDetected {
        /// The first stage.
        ground_contact: bool,
        /// The second.
        maybe_landed: bool,
        /// The last.
        landed: bool,
        /// It comes down to land.
        in_descend: bool,
    }
    topic "vehicle_land_detected" every RARE, on change true;
    of |out| {
        let landed = out.ground == GroundState::OnGround;
        Some(Self {
            timestamp: out.now.0,
            ground_contact: landed,
            maybe_landed: landed,
            landed,
            in_descend: out.ground == GroundState::Landing,
        })
    }
}
record! {
    /// `failsafe_flags`: PX4's names for what it has too, the rest by names of ours.
    FailsafeFlags {
        /// Inertial data is missing or wrong.
        angular_velocity_invalid: bool,
        /// It has been missing for too long.
        attitude_invalid: bool,
        /// Neither rangefinder nor barometer.
        local_altitude_invalid: bool,
        /// The estimate contradicts its measurements, or what it stands on is missing.
        local_position_invalid: bool,
        /// Radio and joystick are silent, in a mode that flies by them or where that is a failure.
        manual_control_signal_lost: bool,
        /// The ground station is silent.
        gcs_connection_lost: bool,
        /// 0 none, 1 low, 2 critical.
        battery_warning: u8,
        /// Tilted beyond anything a flight asks for.
        fd_critical_failure: bool,
        /// A rotor gives no thrust.
        fd_motor_failure: bool,
        /// Beyond the fence.
        geofence_breached: bool,
        /// No tension.
        tether_slack: bool,
        /// What held the vehicle does so no more.
        tether_gone: bool,
        /// The line is held fast somewhere.
        line_caught: bool,
        /// The winch pulls far more than it is asked.
        over_tension: bool,
        /// The flight mode itself can't go on.
        mode_failed: bool,
        /// Full thrust, and still on the ground.
        no_lift_off: bool,
        /// Down where the ground should be, and it is not there.
        landing_overdue: bool,
    }
    topic "failsafe_flags" every RARE, on change true;
    of |out| {
        use Failure as F;
        let any = |failures: &[F]| is_any(out, failures);
        let battery = u8::from(any(&[F::BatteryLow]));
        Some(Self {
            timestamp: out.now.0,
            angular_velocity_invalid: any(&[F::ImuLost, F::ImuClipped, F::ImuIrregular, F::ImuGone]),
            attitude_invalid: any(&[F::ImuGone]),
            local_altitude_invalid: any(&[F::AltimeterLost]),
            local_position_invalid: any(&[
                F::EstimatorDiverged,
                F::TetherLengthLost,
                F::CaptureLost,
            ]),
            manual_control_signal_lost: any(&[F::SticksLost, F::RadioLost]),
            gcs_connection_lost: any(&[F::LinkLost]),
            battery_warning: if any(&[F::BatteryCritical]) { 2 } else { battery },
            fd_critical_failure: any(&[F::Capsized]),
            fd_motor_failure: any(&[F::RotorLost]),
            geofence_breached: any(&[F::FenceBreached]),
            tether_slack: any(&[F::TetherSlack]),
            tether_gone: any(&[F::TetherGone]),
            line_caught: any(&[F::LineCaught]),
            over_tension: any(&[F::OverTension]),
            mode_failed: any(&[F::ModeFailed]),
            no_lift_off: any(&[F::NoLiftOff]),
            landing_overdue: any(&[F::LandingOverdue]),
        })
    }
}
record! {
    /// `estimator_status`: what PX4's tools draw of an estimator; ours in full stands in topics of their own.
    EstimatorStatus {
        /// One standard deviation, m.
        pos_horiz_accuracy: f32,
        /// One standard deviation, m.
        pos_vert_accuracy: f32,
        /// Of the altitude's innovation.
        hgt_test_ratio: f32,
        /// Bit 0 attitude, 1 and 2 velocity, 3 position: good to fly by; 6: so is the height above ground.
        solution_status_flags: u16,
        /// Bit 1: position; 2: barometer; 9: rangefinder refused.
        innovation_check_flags: u16,
        /// Bit 0 velocity, 1 position, 2 height: its sensor contradicts the others.
        health_flags: u8,
        /// Bit 1 position, 2 height: its sensor is silent.
        timeout_flags: u8,
        /// How often the position began anew in this flight.
        reset_count_pos_ne: u8,
    }
    topic "estimator_status" every RARE;
    of |out| {
        let (e, altimeters) = (&out.estimate, out.sensors.altimeters);
        let (range, baro) = (altimeters.range_is_rejected, altimeters.baro_is_rejected);
        let bits = |bits: &[(bool, u16)]| {
            bits.iter().fold(0, |sum, &(is_set, bit)| sum | u16::from(is_set) << bit)
        };
        let position = is_any(out, &[Failure::TetherLengthLost, Failure::CaptureLost]);
        let moves = e.velocity.is_some();
        Some(Self {
            timestamp: out.now.0,
            pos_horiz_accuracy: libm::hypotf(e.position_sd.x, e.position_sd.y),
            pos_vert_accuracy: e.position_sd.z,
            hgt_test_ratio: e.health.altitude,
            solution_status_flags: bits(&[
                (e.is_levelled, 0),
                (moves, 1),
                (moves, 2),
                (e.position.is_some(), 3),
                (out.sensors.altitude_is_fresh, 6),
            ]),
            innovation_check_flags: bits(&[(e.has_diverged, 1), (baro, 2), (range, 9)]),
            health_flags: bits(&[(e.has_diverged, 0), (e.has_diverged, 1), (range || baro, 2)]) as u8,
            timeout_flags: bits(&[(position, 1), (!out.sensors.altitude_is_fresh, 2)]) as u8,
            reset_count_pos_ne: e.restarts as u8,
        })
    }
}
record! {
    /// `vehicle_imu_status`.
    VehicleImuStatus {
        /// What shakes the accelerometer behind its filters, m/s².
        accel_vibration_metric: f32,
        /// Of the die, °C.
        temperature_accel: f32,
        /// Of the same die, °C.
        temperature_gyro: f32,
    }
    topic "vehicle_imu_status" every RARE;
    of |out| Some(Self {
        timestamp: out.now.0,
        accel_vibration_metric: out.estimate.vibration,
        temperature_accel: out.sensors.imu_temperature,
        temperature_gyro: out.sensors.imu_temperature,
    })
}

fn is_any(out: &StepOutput, failures: &[Failure]) -> bool {
    failures.iter().any(|&failure| out.failures >> (failure as u8) & 1 == 1)
}
