//! What the slower tasks have for the next step.

use heapless::Deque;
use tautline_firmware::link::Link;
use tautline_firmware::sense::RawSensors;
use tautline_firmware::signal::{Request, Sticks};
use tautline_firmware::time::{Micros, Sample};
use tautline_firmware::vehicle::StepInput;

/// Filled below the flight task, emptied by it.
#[derive(Debug, Default)]
pub struct Inbox {
    /// Of the slow devices, newest first come; taken by one step.
    pub sensors: RawSensors,
    heartbeat_at: Option<Micros>,
    sticks: Option<Sample<Sticks>>,
    requests: Deque<Request, 8>,
}

impl Inbox {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            sensors: RawSensors {
                imu: None,
                barometer: None,
                range: None,
                battery: None,
                tether: None,
                capture: None,
                rod: None,
            },
            heartbeat_at: None,
            sticks: None,
            requests: Deque::new(),
        }
    }

    /// What a connection heard. A request that finds no room waits in the connection's own queue.
    pub fn hear(&mut self, link: &mut Link) {
        self.heartbeat_at = self.heartbeat_at.max(link.heartbeat_at());
        let newest = |sticks: &Sample<Sticks>| self.sticks.is_none_or(|s| s.at < sticks.at);
        if let Some(sticks) = link.sticks().filter(newest) {
            self.sticks = Some(sticks);
        }
        if let Some(capture) = link.take_capture() {
            self.sensors.capture = Some(capture);
        }
        if let Some(rod) = link.take_rod() {
            self.sensors.rod = Some(rod);
        }
        while !self.requests.is_full() {
            let Some(request) = link.next_request() else { break };
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
