//! What the estimators' topics are made of: ours, named `estimator_<name>`.

use super::flight::SLOW;
use super::topics::three;
use super::ulog::record;
use crate::estimate::tether_angle::{TetherAngleState, plane_angles};
use crate::scalar::Scalar;

record! {
    /// `estimator_ekf4`: health of the four-state filter and its attitude source.
    EstimatorEkf4 {
        /// Innovation test ratios: accelerometer, altitude, length.
        test_ratio: [f32; 3],
        /// One standard deviation, m.
        position_sd: [f32; 3],
        /// rad/s.
        gyro_bias: [f32; 3],
        /// Modelled total thrust, N.
        thrust: f32,
        /// Vertical filter: height m, climb m/s.
        vertical: [f32; 2],
        /// The innovation tests failed for too long.
        diverged: bool,
    }
    topic "estimator_ekf4" every SLOW;
    of |out| {
        let e = &out.estimate;
        Some(Self {
            timestamp: out.now.0,
            test_ratio: [e.health.accel, e.health.altitude, e.health.length],
            position_sd: three(&e.position_sd),
            gyro_bias: three(&e.gyro_bias.0),
            thrust: e.thrust,
            vertical: [e.height, e.climb],
            diverged: e.has_diverged,
        })
}
}
record! {
    /// `estimator_taut`: the taut-link observer, and what its modes ask.
    EstimatorTaut {
        /// rad.
        elevation: f32,
        /// rad/s.
        elevation_rate: f32,
        /// In the plane, positive leaning away from the anchor, rad.
        pitch: f32,
        /// N, positive in tension.
        link_force: f32,
        /// m/s².
        residual: f32,
        /// rad; azimuth minus heading, zero outside the taut-link modes.
        azimuth: f32,
        /// rad; zero outside the taut-link modes.
        roll: f32,
        /// rad.
        elevation_setpoint: f32,
        /// Link force, N, or pitch, rad.
        second_setpoint: f32,
        /// A taut-link mode flies; without, the set-points mean nothing.
        active: bool,
    }
    topic "estimator_taut" every SLOW;
    of |out| {
        out.taut.as_ref().map(|taut| {
            let x = &taut.planar;
            let (azimuth, roll) = taut
                .out_of_plane
                .as_ref()
                .map_or((0.0, 0.0), |out_of_plane| (out_of_plane.azimuth(), out_of_plane.roll()));
            let (elevation, second) = out.taut_reference.map_or((0.0, 0.0), |reference| {
                let ([phi, ..], [second, ..]) = (reference.elevation, reference.second);
                (phi, second)
            });
            Self {
                timestamp: out.now.0,
                elevation: x.elevation,
                elevation_rate: x.elevation_rate,
                pitch: x.pitch,
                link_force: taut.link_force,
                residual: taut.residual,
                azimuth,
                roll,
                elevation_setpoint: elevation,
                second_setpoint: second,
                active: out.taut_reference.is_some(),
            }
        })
}
}

record! {
    /// `estimator_tether_angle`: Tether Angle's filters, in the plane of North and up, and of West and up.
    EstimatorTetherAngle {
        /// Of the tether from straight up, rad.
        angle: [f32; 2],
        /// rad/s.
        angle_rate: [f32; 2],
        /// Of the thrust axis from straight up, rad.
        tilt: [f32; 2],
        /// One standard deviation of the angle, rad.
        angle_sd: [f32; 2],
        /// Asked, rad.
        angle_setpoint: [f32; 2],
        /// Of the tether, N.
        tension: f32,
        /// What each filter did: 0 no estimate, 1 started, 2 updated, 3 dead reckoning, 4 lost.
        mode_x: u8,
        /// See `mode_x`.
        mode_y: u8,
    }
    topic "estimator_tether_angle" every SLOW;
    of |out| {
        let angle = out.angle.as_ref()?;
        let pick = |of: fn(&TetherAngleState<f32>) -> f32| {
            let [x, y] = &angle.planes;
            [of(x), of(y)]
        };
        let asked = out.reference.map_or([0.0; 2], |r| plane_angles(&r.position));
        let [mode_x, mode_y] = angle.modes().map(|mode| mode as u8);
        Some(Self {
            timestamp: out.now.0,
            angle: pick(|p| p.posterior.x.angle),
            angle_rate: pick(|p| p.posterior.x.rate),
            tilt: pick(|p| p.posterior.x.tilt),
            angle_sd: pick(|p| Scalar::sqrt(p.posterior.covariance.m11)),
            angle_setpoint: asked,
            tension: angle.tension,
            mode_x,
            mode_y,
        })
}
}
record! {
    /// `estimator_pendulum`: the rod on top and its load, world axes, while the rod is seen.
    EstimatorPendulum {
        /// Unit vector vehicle to load.
        rod: [f32; 3],
        /// rad/s.
        rod_rate: [f32; 3],
        /// Of the load, m.
        load_position: [f32; 3],
        /// Of the load, m/s.
        load_velocity: [f32; 3],
        /// On the vehicle, N.
        disturbance: [f32; 3],
        /// Where the load shall be, m.
        load_setpoint: [f32; 3],
        /// Pendulum flies; without, the set-point means nothing.
        active: bool,
    }
    topic "estimator_pendulum" every SLOW;
    of |out| {
        let report = out.pendulum.as_ref()?;
        let x = &report.estimate;
        let setpoint = report.reference.as_ref().map(|r| three(&r.position().0));
        Some(Self {
            timestamp: out.now.0,
            rod: three(&x.rod.0),
            rod_rate: three(&x.rod_rate.0),
            load_position: three(&x.position.0),
            load_velocity: three(&x.velocity.0),
            disturbance: three(&x.disturbance.0),
            load_setpoint: setpoint.unwrap_or_default(),
            active: setpoint.is_some(),
        })
}
}
record! {
    /// A position estimator that runs beside the one that flies.
    EstimatorPosition {
        /// North, East, Down from the anchor, m.
        position: [f32; 3],
        /// One standard deviation, m; zero where the estimator has none.
        position_sd: [f32; 3],
        /// N.
        tension: f32,
        /// The tension is on its mirror image, below zero.
        tension_is_negative: bool,
    }
}
