//! Which messages go out by themselves, and how often.

use crate::time::Micros;

/// One stream.
#[derive(Clone, Copy, Debug)]
struct Stream {
    id: u32,
    /// Interval at start, µs; 0 = off.
    default_us: u32,
    interval_us: u32,
    due: Micros,
}

const fn stream(id: u32, default_us: u32) -> Stream {
    Stream { id, default_us, interval_us: default_us, due: Micros(0) }
}

/// All messages that can be streamed.
const STREAMS: [Stream; 18] = [
    stream(0, 1_000_000),   // HEARTBEAT
    stream(1, 500_000),     // SYS_STATUS
    stream(2, 1_000_000),   // SYSTEM_TIME
    stream(30, 50_000),     // ATTITUDE
    stream(31, 20_000),     // ATTITUDE_QUATERNION
    stream(32, 50_000),     // LOCAL_POSITION_NED
    stream(33, 200_000),    // GLOBAL_POSITION_INT
    stream(36, 500_000),    // SERVO_OUTPUT_RAW
    stream(74, 250_000),    // VFR_HUD
    stream(85, 0),          // POSITION_TARGET_LOCAL_NED
    stream(147, 1_000_000), // BATTERY_STATUS
    stream(230, 500_000),   // ESTIMATOR_STATUS
    stream(242, 2_000_000), // HOME_POSITION
    stream(245, 500_000),   // EXTENDED_SYS_STATE
    stream(251, 100_000),   // NAMED_VALUE_FLOAT
    stream(331, 50_000),    // ODOMETRY
    stream(436, 2_000_000), // CURRENT_MODE
    stream(9005, 500_000),  // WINCH_STATUS
];
/// Shortest interval, µs: the outer loop's period.
const FASTEST_US: u32 = 4_000;
const HEARTBEAT: u32 = 0;

/// The schedule of one connection.
#[derive(Clone, Copy, Debug)]
pub struct Streams([Stream; STREAMS.len()]);

impl Default for Streams {
    fn default() -> Self {
        Self(STREAMS)
    }
}

impl Streams {
    /// A message that is due; call until `None`.
    pub fn next_due(&mut self, now: Micros) -> Option<u32> {
        let due = self.0.iter_mut().find(|s| s.interval_us > 0 && now >= s.due)?;
        let interval = u64::from(due.interval_us);
        due.due = Micros((due.due.0 + interval).max(now.0 + interval / 2));
        Some(due.id)
    }

    /// MAVLink's convention: -1 turns off, 0 is the default, else µs. False for a message that is not
    /// streamed, or for turning the heartbeat off.
    pub fn set_interval(&mut self, id: u32, interval_us: f32) -> bool {
        let Some(stream) = self.0.iter_mut().find(|s| s.id == id) else {
            return false;
        };
        if id == HEARTBEAT || !interval_us.is_finite() {
            return false;
        }
        stream.interval_us = if interval_us < 0.0 {
            0
        } else if interval_us < 1.0 {
            stream.default_us
        } else {
            (interval_us as u32).max(FASTEST_US)
        };
        true
    }

    /// Present interval, µs; -1 when off, `None` for a message that is not streamed.
    pub fn interval(&self, id: u32) -> Option<i32> {
        let stream = self.0.iter().find(|s| s.id == id)?;
        Some(if stream.interval_us == 0 { -1 } else { stream.interval_us as i32 })
    }
}
