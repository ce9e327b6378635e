//! Which messages go out by themselves, and how often.

use super::command::Answer;
use super::telemetry::{MESSAGES, Message};
use crate::time::Micros;
use mavlink::MessageData;
use mavlink::dialects::common::HEARTBEAT_DATA;

/// Shortest interval, µs: the outer loop's period.
const FASTEST_US: u32 = 4_000;

/// One stream, as it is now.
#[derive(Clone, Copy, Debug)]
struct Stream {
    interval_us: u32,
    due: Micros,
}

/// The schedule of one connection: a slot for each row of [`MESSAGES`].
#[derive(Clone, Copy, Debug)]
pub struct Streams {
    rows: [Stream; MESSAGES.len()],
    /// Nothing is due earlier.
    wake: Micros,
}

impl Default for Streams {
    fn default() -> Self {
        let start = |message: &Message| Stream {
            interval_us: message.interval_us.unwrap_or(0),
            due: Micros(0),
        };
        Self { rows: MESSAGES.each_ref().map(start), wake: Micros(0) }
    }
}

impl Streams {
    /// A message that is due; call until `None`.
    pub fn next_due(&mut self, now: Micros) -> Option<u32> {
        if now < self.wake {
            return None;
        }
        let rows = self.rows.iter_mut().zip(&MESSAGES);
        // The heartbeat first; then who has waited longest, lest a fast one starve the rest on a narrow link.
        let due = rows
            .filter(|(s, _)| s.interval_us > 0 && now >= s.due)
            .min_by_key(|(s, m)| if m.id == HEARTBEAT_DATA::ID { Micros(0) } else { s.due });
        let Some((due, message)) = due else {
            let due = self.rows.iter().filter(|s| s.interval_us > 0).map(|s| s.due);
            self.wake = due.min().unwrap_or(now);
            return None;
        };
        let interval = u64::from(due.interval_us);
        due.due = Micros((due.due.0 + interval).max(now.0 + interval / 2));
        Some(message.id)
    }

    /// MAVLink's convention: -1 turns off, 0 is the default, else µs. A message that is not streamed is not supported;
    /// the heartbeat stays as it is.
    pub fn set_interval(&mut self, id: u32, interval_us: f32) -> Answer {
        let row = self.rows.iter_mut().zip(&MESSAGES).find(|(_, message)| message.id == id);
        let Some((stream, &Message { interval_us: Some(default), .. })) = row else {
            return Answer::Unsupported;
        };
        if id == HEARTBEAT_DATA::ID || !interval_us.is_finite() {
            return Answer::Denied;
        }
        stream.interval_us = if interval_us < 0.0 {
            0
        } else if interval_us < 1.0 {
            default
        } else {
            (interval_us as u32).max(FASTEST_US)
        };
        self.wake = Micros(0);
        Answer::Accepted
    }

    /// Present interval, µs; -1 when off, `None` for a message that is not streamed.
    pub fn interval(&self, id: u32) -> Option<i32> {
        let (stream, message) = self.rows.iter().zip(&MESSAGES).find(|(_, row)| row.id == id)?;
        message.interval_us?;
        Some(if stream.interval_us == 0 { -1 } else { stream.interval_us as i32 })
    }
}
