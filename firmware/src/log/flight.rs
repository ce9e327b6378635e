//! Which topic goes into the log how often.

use super::topics as t;
use super::ulog::{Record, Sink, Topic, Ulog};
use crate::param::{META, Params};
use crate::scalar::Scalar;
use crate::time::Micros;
use crate::vehicle::StepOutput;

/// Periods in steps of 1 ms.
const FAST: u32 = 4;
const MEDIUM: u32 = 10;
const SLOW: u32 = 20;
const RARE: u32 = 200;

/// Topics of the vehicle itself.
#[derive(Clone, Copy, Debug)]
struct Topics {
    sensor_combined: Topic,
    attitude: Topic,
    angular_velocity: Topic,
    position: Topic,
    position_setpoint: Topic,
    rates_setpoint: Topic,
    motors: Topic,
    status: Topic,
    battery: Topic,
    tether: Topic,
    estimator: Topic,
    taut: Topic,
    angle: Topic,
    pendulum: Topic,
}

/// Writes what each step says. Whoever logs beside it (the simulator's truth) uses [`Self::ulog`].
#[derive(Clone, Copy, Debug)]
pub struct FlightLog {
    /// The writer.
    pub ulog: Ulog,
    topics: Topics,
    step: u32,
    last_state: Option<(u8, u8, u8, u16)>,
}

impl FlightLog {
    /// Header, definitions and parameters. `define_more` may define further topics.
    pub fn start(
        now: Micros,
        params: &Params,
        define_more: impl FnOnce(&mut Ulog, Sink),
        sink: Sink,
    ) -> Self {
        let mut ulog = Ulog::default();
        ulog.start(now, "Tautline", env!("CARGO_PKG_VERSION"), sink);
        ulog.define::<t::SensorCombined>("sensor_combined", sink);
        ulog.define::<t::VehicleAttitude>("vehicle_attitude", sink);
        ulog.define::<t::VehicleAngularVelocity>("vehicle_angular_velocity", sink);
        ulog.define::<t::VehicleLocalPosition>("vehicle_local_position", sink);
        ulog.define::<t::VehicleLocalPositionSetpoint>("vehicle_local_position_setpoint", sink);
        ulog.define::<t::VehicleRatesSetpoint>("vehicle_rates_setpoint", sink);
        ulog.define::<t::ActuatorMotors>("actuator_motors", sink);
        ulog.define::<t::VehicleStatus>("vehicle_status", sink);
        ulog.define::<t::BatteryStatus>("battery_status", sink);
        ulog.define::<t::TetherState>("tether_state", sink);
        ulog.define::<t::EstimatorEkf4>("estimator_ekf4", sink);
        ulog.define::<t::EstimatorTaut>("estimator_taut", sink);
        ulog.define::<t::EstimatorTetherAngle>("estimator_tether_angle", sink);
        ulog.define::<t::EstimatorPendulum>("estimator_pendulum", sink);
        define_more(&mut ulog, sink);
        for (index, meta) in META.iter().enumerate() {
            ulog.parameter(meta.name, params.get(index).unwrap_or(meta.default), sink);
        }
        let topics = Topics {
            sensor_combined: ulog.subscribe("sensor_combined", sink),
            attitude: ulog.subscribe("vehicle_attitude", sink),
            angular_velocity: ulog.subscribe("vehicle_angular_velocity", sink),
            position: ulog.subscribe("vehicle_local_position", sink),
            position_setpoint: ulog.subscribe("vehicle_local_position_setpoint", sink),
            rates_setpoint: ulog.subscribe("vehicle_rates_setpoint", sink),
            motors: ulog.subscribe("actuator_motors", sink),
            status: ulog.subscribe("vehicle_status", sink),
            battery: ulog.subscribe("battery_status", sink),
            tether: ulog.subscribe("tether_state", sink),
            estimator: ulog.subscribe("estimator_ekf4", sink),
            taut: ulog.subscribe("estimator_taut", sink),
            angle: ulog.subscribe("estimator_tether_angle", sink),
            pendulum: ulog.subscribe("estimator_pendulum", sink),
        };
        Self { ulog, topics, step: 0, last_state: None }
    }

    /// What this step has to say.
    pub fn write<S: Scalar>(&mut self, out: &StepOutput<S>, sink: Sink) {
        let (n, topics) = (self.step, self.topics);
        self.step = self.step.wrapping_add(1);
        let u = &mut self.ulog;
        if n.is_multiple_of(FAST)
            && let Some(record) = t::SensorCombined::of(out)
        {
            u.write(topics.sensor_combined, &record, sink);
        }
        if n.is_multiple_of(MEDIUM) {
            u.write(topics.attitude, &t::VehicleAttitude::of(out), sink);
            u.write(topics.angular_velocity, &t::VehicleAngularVelocity::of(out), sink);
            u.write(topics.rates_setpoint, &t::VehicleRatesSetpoint::of(out), sink);
            u.write(topics.motors, &t::ActuatorMotors::of(out), sink);
        }
        if n.is_multiple_of(SLOW) {
            u.write(topics.position, &t::VehicleLocalPosition::of(out), sink);
            u.write(topics.estimator, &t::EstimatorEkf4::of(out), sink);
            optional(u, topics.taut, t::EstimatorTaut::of(out).as_ref(), sink);
            optional(u, topics.angle, t::EstimatorTetherAngle::of(out).as_ref(), sink);
            optional(u, topics.pendulum, t::EstimatorPendulum::of(out).as_ref(), sink);
            optional(u, topics.tether, t::TetherState::of(out).as_ref(), sink);
            optional(
                u,
                topics.position_setpoint,
                t::VehicleLocalPositionSetpoint::of(out).as_ref(),
                sink,
            );
        }
        if n.is_multiple_of(RARE) {
            optional(u, topics.battery, t::BatteryStatus::of(out).as_ref(), sink);
        }
        let status = t::VehicleStatus::of(out);
        let state =
            Some((status.arming_state, status.nav_state, status.ground_state, status.failures));
        if n.is_multiple_of(RARE) || state != self.last_state {
            u.write(topics.status, &status, sink);
            self.last_state = state;
        }
        for event in out.events.iter() {
            u.text(out.now, event.severity as u8, event.text, sink);
        }
    }
}

fn optional<R: Record>(ulog: &mut Ulog, topic: Topic, record: Option<&R>, sink: Sink) {
    if let Some(record) = record {
        ulog.write(topic, record, sink);
    }
}
