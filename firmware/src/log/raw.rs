//! PX4's topics of what goes into a step and comes out of the outputs, for whoever logs beside and sees both: the
//! vehicle's own log reads [`StepOutput`](crate::vehicle::StepOutput) alone.

use super::ulog::record;

record! {
    /// `distance_sensor`: a rangefinder's valid readings.
    DistanceSensor {
        /// m.
        max_distance: f32,
        /// Along the body's down axis, m.
        current_distance: f32,
        /// m²; 0: unknown.
        variance: f32,
        /// -1: unknown.
        signal_quality: i8,
        /// 25: down.
        orientation: u8,
    }
}
record! {
    /// `sensor_baro`.
    SensorBaro {
        /// Pa.
        pressure: f32,
        /// °C.
        temperature: f32,
    }
}
record! {
    /// `vehicle_air_data`.
    VehicleAirData {
        /// In the standard atmosphere, m.
        baro_alt_meter: f32,
        /// Pa.
        baro_pressure_pa: f32,
    }
}
record! {
    /// `manual_control_setpoint`: a joystick's words.
    ManualControlSetpoint {
        /// They are as new as this record.
        valid: bool,
        /// 2: by MAVLink.
        data_source: u8,
        /// -1..1, right positive.
        roll: f32,
        /// -1..1, forward positive.
        pitch: f32,
        /// -1..1, clockwise positive.
        yaw: f32,
        /// -1 (bottom) to 1 (top).
        throttle: f32,
        /// There is none.
        aux1: f32,
        /// There is none.
        aux2: f32,
    }
}
record! {
    /// `actuator_outputs`.
    ActuatorOutputs {
        /// Rotors.
        noutputs: u32,
        /// Pulses to the ESCs, µs.
        output: [f32; 8],
    }
}
record! {
    /// `vehicle_angular_acceleration`.
    VehicleAngularAcceleration {
        /// Body FRD, rad/s².
        xyz: [f32; 3],
    }
}
record! {
    /// `step_inputs`: a piece of the stream of what went into the steps, for a replay.
    StepInputs {
        /// Of the piece, from 0.
        sequence: u32,
        /// Bytes of it that count.
        length: u8,
        /// The stream's.
        bytes: [u8; 240],
    }
}
