//! What the slower tasks have for the next step.

use heapless::Deque;
use tautline_firmware::mavlink::Connection;
use tautline_firmware::sense::RawSensors;
use tautline_firmware::signal::{Request, Sticks};
use tautline_firmware::time::{Micros, Sample};
use tautline_firmware::vehicle::StepInput;

/// Filled below the flight task, emptied by it.
#[derive(Debug, Default)]
pub struct Inbox {
    sensors: RawSensors,
    heartbeat_at: Option<Micros>,
    sticks: Option<Sample<Sticks>>,
    requests: Deque<Request, 8>,
}

impl Inbox {
    /// What the slow devices have; what is `None` leaves what is there.
    pub fn put(&mut self, new: RawSensors) {
        self.sensors.merge(new);
    }

    /// What a connection received. A request that finds no room waits in the connection's own queue.
    pub fn receive(&mut self, connection: &mut Connection) {
        self.heartbeat_at = self.heartbeat_at.max(connection.heartbeat_at());
        let newest = |sticks: &Sample<Sticks>| self.sticks.is_none_or(|s| s.at < sticks.at);
        if let Some(sticks) = connection.sticks().filter(newest) {
            self.sticks = Some(sticks);
        }
        self.sensors.merge(connection.take_sensors());
        while !self.requests.is_full() {
            let Some(request) = connection.next_request() else { break };
            let _ = self.requests.push_back(request);
        }
    }

    /// Everything for one step, once, but for the inertial sample.
    pub fn take(&mut self, now: Micros) -> StepInput {
        StepInput {
            now,
            sensors: core::mem::take(&mut self.sensors),
            heartbeat_at: self.heartbeat_at,
            sticks: self.sticks,
            request: self.requests.pop_front(),
        }
    }
}
