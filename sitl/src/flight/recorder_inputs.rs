//! What goes into the firmware's steps and what comes of its outputs, in the log: readings as the drivers gave them, the
//! joystick, pulses, and the angular acceleration, under PX4's names. The firmware's own log knows only what a step says.

use tautline_firmware::log::topics::{
    ActuatorOutputs, DistanceSensor, ManualControlSetpoint, SensorBaro, VehicleAirData,
    VehicleAngularAcceleration,
};
use tautline_firmware::log::{FlightLog, MEDIUM, SLOW, Sink, Topic, TopicMeta, Ulog};
use tautline_firmware::param::Params;
use tautline_firmware::time::{Micros, Sample};
use tautline_firmware::vehicle::{StepInput, StepOutput};
use tautline_hal_shim::motors::Protocol;
use tautline_runtime::inner_loop::protocol;

/// A sensor that speaks more often than this is not recorded more often, µs.
const LEAST_GAP: u64 = 40_000;
/// Of the angular acceleration: steps of 1 ms at 30 Hz.
const SMOOTHING: f32 = 0.16;
/// Towards the ground, by MAVLink.
const DOWN: u8 = 25;
/// The joystick comes by MAVLink.
const MAVLINK: u8 = 2;

/// The topics, and what was last written to them.
#[derive(Debug)]
pub struct InputTopics {
    distance: Topic,
    baro: Topic,
    air: Topic,
    sticks: Topic,
    outputs: Topic,
    acceleration: Topic,
    range_max: f32,
    protocol: Protocol,
    ranged_at: Option<Micros>,
    pressed_at: Option<Micros>,
    moved_at: Option<Micros>,
    rate: Option<[f32; 3]>,
    smooth: [f32; 3],
}

/// A topic's name, by its type.
trait Named: tautline_firmware::log::Record {
    const NAME: &'static str;
}

macro_rules! names {
    ($($topic:ident $name:literal)+) => {$(
        impl Named for $topic {
            const NAME: &'static str = $name;
        }
    )+
        /// All of them.
        pub const TOPICS: &[TopicMeta] = &[$(TopicMeta::new::<$topic>($name)),+];
    };
}
names! {
    DistanceSensor "distance_sensor"
    SensorBaro "sensor_baro"
    VehicleAirData "vehicle_air_data"
    ManualControlSetpoint "manual_control_setpoint"
    ActuatorOutputs "actuator_outputs"
    VehicleAngularAcceleration "vehicle_angular_acceleration"
}

impl InputTopics {
    /// Into the log's definitions.
    pub fn define(ulog: &mut Ulog, sink: Sink) {
        for topic in TOPICS {
            ulog.define_fields(topic.name, topic.fields, sink);
        }
    }

    /// After the definitions.
    pub fn subscribe(ulog: &mut Ulog, params: &Params, sink: Sink) -> Self {
        Self {
            distance: ulog.subscribe(DistanceSensor::NAME, sink),
            baro: ulog.subscribe(SensorBaro::NAME, sink),
            air: ulog.subscribe(VehicleAirData::NAME, sink),
            sticks: ulog.subscribe(ManualControlSetpoint::NAME, sink),
            outputs: ulog.subscribe(ActuatorOutputs::NAME, sink),
            acceleration: ulog.subscribe(VehicleAngularAcceleration::NAME, sink),
            range_max: params.range_max,
            protocol: protocol(params),
            ranged_at: None,
            pressed_at: None,
            moved_at: None,
            rate: None,
            smooth: [0.0; 3],
        }
    }

    /// One step; before the log itself goes on to the next.
    pub fn write(&mut self, log: &mut FlightLog, input: &StepInput, out: &StepOutput, sink: Sink) {
        self.write_sensors(&mut log.ulog, input, sink);
        self.accelerate(out);
        let timestamp = out.now.0;
        if log.is_due(MEDIUM) {
            let xyz = self.smooth;
            let record = VehicleAngularAcceleration { timestamp, xyz };
            log.ulog.write(self.acceleration, &record, sink);
        }
        if log.is_due(SLOW) {
            let throttle = &out.actuation.throttle;
            let mut output = [0.0; 8];
            for (pulse, throttle) in output.iter_mut().zip(throttle.iter()) {
                *pulse = self.protocol.pulse_us(*throttle);
            }
            let record = ActuatorOutputs { timestamp, noutputs: throttle.len() as u32, output };
            log.ulog.write(self.outputs, &record, sink);
        }
    }

    fn write_sensors(&mut self, ulog: &mut Ulog, input: &StepInput, sink: Sink) {
        if let Some((timestamp, range)) = newer(&mut self.ranged_at, input.sensors.range)
            && let Some(centimetres) = range.distance_cm
        {
            let record = DistanceSensor {
                timestamp,
                max_distance: self.range_max,
                current_distance: f32::from(centimetres) / 100.0,
                variance: 0.0,
                signal_quality: -1,
                orientation: DOWN,
            };
            ulog.write(self.distance, &record, sink);
        }
        if let Some((timestamp, baro)) = newer(&mut self.pressed_at, input.sensors.barometer) {
            let pressure = baro.pressure_centipascal as f32 / 100.0;
            let record = SensorBaro { timestamp, pressure, temperature: baro.temperature };
            ulog.write(self.baro, &record, sink);
            let baro_alt_meter = standard_altitude(pressure);
            let record = VehicleAirData { timestamp, baro_alt_meter, baro_pressure_pa: pressure };
            ulog.write(self.air, &record, sink);
        }
        if let Some((timestamp, sticks)) = newer(&mut self.moved_at, input.sticks) {
            let record = ManualControlSetpoint {
                timestamp,
                valid: true,
                data_source: MAVLINK,
                roll: sticks.roll,
                pitch: sticks.pitch,
                yaw: sticks.yaw,
                throttle: sticks.throttle * 2.0 - 1.0,
                aux1: 0.0,
                aux2: 0.0,
            };
            ulog.write(self.sticks, &record, sink);
        }
    }

    /// By the rate's difference, as smooth as PX4's.
    fn accelerate(&mut self, out: &StepOutput) {
        const STEP: f32 = 1e-3;
        let rate: [f32; 3] = out.estimate.rate.0.into();
        let last = self.rate.replace(rate).unwrap_or(rate);
        for ((smooth, rate), last) in self.smooth.iter_mut().zip(rate).zip(last) {
            *smooth += SMOOTHING * ((rate - last) / STEP - *smooth);
        }
    }
}

/// A sample that is new, and not too soon after the last one that was.
fn newer<T>(last: &mut Option<Micros>, sample: Option<Sample<T>>) -> Option<(u64, T)> {
    let sample = sample?;
    let is_due = last.is_none_or(|last| sample.at.0.saturating_sub(last.0) >= LEAST_GAP);
    is_due.then(|| {
        *last = Some(sample.at);
        (sample.at.0, sample.value)
    })
}

/// Of a pressure in Pa, m.
fn standard_altitude(pressure: f32) -> f32 {
    const SEA_LEVEL: f32 = 101_325.0;
    44_330.77 * (1.0 - (pressure / SEA_LEVEL).powf(0.190_263))
}
