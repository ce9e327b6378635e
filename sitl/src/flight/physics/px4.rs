//! PX4's simulator interface: MAVLink over TCP, and this is PX4's side of it.

use super::{Command, Frame, SILENCE, START, WINCH_CHANNEL, Winch};
use crate::flight::MavlinkSender;
use crate::plant::{GRAVITY, Truth, V3};
use mavlink::dialects::common::{
    BATTERY_STATUS_DATA, COMMAND_LONG_DATA, DISTANCE_SENSOR_DATA, HEARTBEAT_DATA,
    HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, HIL_STATE_QUATERNION_DATA,
    HilActuatorControlsFlags, HilSensorUpdatedFlags, MavAutopilot, MavCmd, MavModeFlag,
    MavSensorOrientation, MavType, WINCH_STATUS_DATA,
};
use mavlink::{MavlinkVersion, MessageData};
use nalgebra::{Quaternion, UnitQuaternion};
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};
use tautline_firmware::mavlink::{Frame as MavlinkFrame, Parser};

/// N that a full channel of the winch means.
const FULL_TENSION: f64 = 100.0;
/// A distance older than that is none, µs.
const RANGE_AGE_US: u64 = 500_000;
/// Of the earth that PX4's projection knows, m.
const EARTH: f64 = 6_371_000.0;
/// Asked interval of the truth, µs.
const TRUTH_INTERVAL: f32 = 5_000.0;

#[derive(Debug)]
enum Message {
    Sensor(HIL_SENSOR_DATA),
    State(HIL_STATE_QUATERNION_DATA),
    Distance(DISTANCE_SENSOR_DATA),
    Winch(WINCH_STATUS_DATA),
    Battery(BATTERY_STATUS_DATA),
    Unreadable(u32),
}

fn decode(frame: &MavlinkFrame) -> Option<Message> {
    fn read<D: MessageData>(frame: &MavlinkFrame, make: impl Fn(D) -> Message) -> Message {
        D::deser(MavlinkVersion::V2, frame.payload).map_or(Message::Unreadable(frame.id), make)
    }
    Some(match frame.id {
        HIL_SENSOR_DATA::ID => read(frame, Message::Sensor),
        HIL_STATE_QUATERNION_DATA::ID => read(frame, Message::State),
        DISTANCE_SENSOR_DATA::ID => read(frame, Message::Distance),
        WINCH_STATUS_DATA::ID => read(frame, Message::Winch),
        BATTERY_STATUS_DATA::ID => read(frame, Message::Battery),
        // Heartbeats, HIL_GPS and the like: nothing flies on them.
        _ => return None,
    })
}

/// The connection.
#[derive(Debug)]
pub(super) struct Px4 {
    stream: TcpStream,
    sender: MavlinkSender,
    parser: Parser,
    queue: VecDeque<Message>,
    state: State,
    /// The frame that waits for its answer came at this time of theirs, µs.
    unanswered: Option<u64>,
}

/// What the messages have reported so far.
#[derive(Debug, Default)]
struct State {
    frame: Frame,
    /// Where the flight starts, NED from the anchor, m.
    start: V3,
    /// Latitude and longitude, rad, and altitude, m, there.
    origin: Option<V3>,
    range_at_us: u64,
}

impl Px4 {
    pub(super) fn connect(at: &str, sender: MavlinkSender, start: V3) -> Result<Self, String> {
        let addresses: Vec<_> = at.to_socket_addrs().map_err(|e| e.to_string())?.collect();
        let began = Instant::now();
        let connect = || {
            let attempt = |to| TcpStream::connect_timeout(to, SILENCE);
            addresses.iter().map(attempt).reduce(Result::or)
        };
        let stream = loop {
            match connect() {
                Some(Ok(stream)) => break stream,
                Some(Err(_)) if began.elapsed() < START => {
                    std::thread::sleep(Duration::from_millis(100));
                }
                Some(Err(e)) => {
                    return Err(format!("no simulator after {} s: {e}", START.as_secs()));
                }
                None => return Err("no such host".into()),
            }
        };
        stream
            .set_nodelay(true)
            .and_then(|()| stream.set_read_timeout(Some(SILENCE)))
            .and_then(|()| stream.set_write_timeout(Some(SILENCE)))
            .map_err(|e| e.to_string())?;
        let mut px4 = Self {
            stream,
            sender,
            parser: Parser::new(),
            queue: VecDeque::new(),
            state: State { start, ..State::default() },
            unanswered: None,
        };
        px4.introduce()?;
        Ok(px4)
    }

    /// Identifies itself and asks for the truth, as PX4 does.
    fn introduce(&mut self) -> Result<(), String> {
        self.send(&HEARTBEAT_DATA {
            mavtype: MavType::MAV_TYPE_QUADROTOR,
            autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
            ..HEARTBEAT_DATA::default()
        })?;
        self.send(&COMMAND_LONG_DATA {
            param1: HIL_STATE_QUATERNION_DATA::ID as f32,
            param2: TRUTH_INTERVAL,
            command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
            ..COMMAND_LONG_DATA::default()
        })
    }

    fn send<D: MessageData>(&mut self, message: &D) -> Result<(), String> {
        let frame = self.sender.frame(message);
        self.stream.write_all(&frame).map_err(|e| explain(&e))
    }

    pub(super) fn exchange(&mut self, command: &Command) -> Result<Frame, String> {
        if let Some(time_us) = self.unanswered.take() {
            self.send(&answer(time_us, command))?;
        }
        let began = Instant::now();
        loop {
            while let Some(message) = self.queue.pop_front() {
                if self.state.take(&message)? {
                    let frame = self.state.frame;
                    self.state.frame.winch = None;
                    self.unanswered = Some(frame.time_us);
                    return Ok(frame);
                }
            }
            if began.elapsed() > SILENCE {
                return Err(format!("no HIL_SENSOR for {} s", SILENCE.as_secs()));
            }
            let mut buffer = [0; 4096];
            let length = match self.stream.read(&mut buffer) {
                // Ctrl-C: the flight ends after this frame.
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                read => read.map_err(|e| explain(&e))?,
            };
            if length == 0 {
                return Err("the simulator closed the connection".into());
            }
            let queue = &mut self.queue;
            self.parser.push(buffer.get(..length).unwrap_or(&[]), |frame| {
                queue.extend(decode(frame));
            });
        }
    }
}

fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => {
            format!("no HIL_SENSOR for {} s", SILENCE.as_secs())
        }
        ErrorKind::ConnectionReset | ErrorKind::BrokenPipe | ErrorKind::ConnectionAborted => {
            "the simulator closed the connection".into()
        }
        _ => error.to_string(),
    }
}

fn answer(time_usec: u64, command: &Command) -> HIL_ACTUATOR_CONTROLS_DATA {
    let mut controls = [0.0_f32; 16];
    for (control, throttle) in controls.iter_mut().zip(command.throttle) {
        *control = throttle as f32;
    }
    if let Some(channel) = controls.get_mut(WINCH_CHANNEL) {
        *channel = (command.winch / FULL_TENSION) as f32;
    }
    let is_armed = command.throttle.iter().any(|throttle| *throttle > 0.0);
    let armed =
        if is_armed { MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED } else { MavModeFlag::empty() };
    HIL_ACTUATOR_CONTROLS_DATA {
        time_usec,
        flags: HilActuatorControlsFlags::HIL_ACTUATOR_CONTROLS_FLAGS_LOCKSTEP,
        controls,
        mode: MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | armed,
    }
}

impl State {
    /// Whether a frame is whole.
    fn take(&mut self, message: &Message) -> Result<bool, String> {
        match message {
            Message::Sensor(sensor) => {
                self.sense(sensor);
                return Ok(true);
            }
            Message::State(state) => self.locate(state)?,
            Message::Distance(distance) => {
                if distance.orientation == MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270 {
                    self.frame.range = Some(f64::from(distance.current_distance) * 0.01);
                    self.range_at_us = self.frame.time_us;
                }
            }
            Message::Winch(winch) => {
                self.frame.winch = Some(Winch {
                    length: f64::from(winch.line_length),
                    tension: f64::from(winch.tension) * GRAVITY,
                });
            }
            Message::Battery(battery) => {
                let cells = battery.voltages.iter().filter(|cell| **cell != u16::MAX);
                let voltage = cells.map(|cell| f64::from(*cell) * 1e-3).sum();
                let current = f64::from(battery.current_battery.max(0)) * 0.01;
                self.frame.battery = Some((voltage, current));
            }
            Message::Unreadable(id) => return Err(format!("message {id} cannot be read")),
        }
        Ok(false)
    }

    fn sense(&mut self, s: &HIL_SENSOR_DATA) {
        let new = |flag| s.fields_updated.contains(flag);
        let vector = |x, y, z| V3::new(f64::from(x), f64::from(y), f64::from(z));
        self.frame.time_us = s.time_usec;
        if new(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_XACC) {
            self.frame.accel = vector(s.xacc, s.yacc, s.zacc);
        }
        if new(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_XGYRO) {
            self.frame.gyro = vector(s.xgyro, s.ygyro, s.zgyro);
        }
        if new(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_ABS_PRESSURE) {
            // Of the standard atmosphere, in hPa.
            let share = f64::from(s.abs_pressure) / 1013.25;
            self.frame.height = Some((1.0 - share.powf(1.0 / 5.255_88)) / 2.255_77e-5);
        } else if new(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_PRESSURE_ALT) {
            self.frame.height = Some(f64::from(s.pressure_alt));
        }
        if self.frame.time_us.saturating_sub(self.range_at_us) > RANGE_AGE_US {
            self.frame.range = None;
        }
    }

    fn locate(&mut self, s: &HIL_STATE_QUATERNION_DATA) -> Result<(), String> {
        let degrees = |x: i32| (f64::from(x) * 1e-7).to_radians();
        let here = V3::new(degrees(s.lat), degrees(s.lon), f64::from(s.alt) * 1e-3);
        let origin = *self.origin.get_or_insert(here);
        let gone = here - origin;
        let [w, x, y, z] = s.attitude_quaternion.map(f64::from);
        self.frame.truth = Some(Truth {
            position: self.start
                + V3::new(EARTH * gone.x, EARTH * origin.x.cos() * gone.y, -gone.z),
            velocity: V3::new(f64::from(s.vx), f64::from(s.vy), f64::from(s.vz)) * 0.01,
            attitude: unit(Quaternion::new(w, x, y, z)).ok_or("the attitude is no rotation")?,
        });
        Ok(())
    }
}

/// `None` for one that is far from unit length.
pub(super) fn unit(q: Quaternion<f64>) -> Option<UnitQuaternion<f64>> {
    ((q.norm() - 1.0).abs() < 0.05).then(|| UnitQuaternion::from_quaternion(q))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_become_si_units_and_axes_from_the_start() {
        let start = V3::new(0.8, 0.0, -0.15);
        let mut state = State { start, ..State::default() };
        let truth = |lat, alt| HIL_STATE_QUATERNION_DATA {
            attitude_quaternion: [1.0, 0.0, 0.0, 0.0],
            lat,
            lon: 85_455_940,
            alt,
            vz: -120,
            ..HIL_STATE_QUATERNION_DATA::default()
        };
        state.take(&Message::State(truth(473_977_420, 488_000))).unwrap();
        state.take(&Message::State(truth(473_977_520, 490_500))).unwrap();
        let winch =
            WINCH_STATUS_DATA { line_length: 4.0, tension: 0.5, ..WINCH_STATUS_DATA::default() };
        state.take(&Message::Winch(winch)).unwrap();
        let sensor = HIL_SENSOR_DATA {
            time_usec: 7000,
            zacc: -9.81,
            abs_pressure: 954.6,
            fields_updated: HilSensorUpdatedFlags::all(),
            ..HIL_SENSOR_DATA::default()
        };
        assert!(state.take(&Message::Sensor(sensor)).unwrap());
        let frame = state.frame;
        assert!(frame.check().is_ok() && frame.time_us == 7000);
        let found = frame.truth.unwrap();
        assert!((found.position - start - V3::new(1.112, 0.0, -2.5)).norm() < 1e-3);
        assert!((found.velocity.z + 1.2).abs() < 1e-9);
        assert!((frame.height.unwrap() - 500.0).abs() < 5.0);
        assert!((frame.winch.unwrap().tension - 4.905).abs() < 1e-9);
    }

    #[test]
    fn an_answer_carries_throttles_and_the_tension_of_the_winch() {
        let throttle = std::array::from_fn(|i| 0.1 * i as f64);
        let sent = answer(5, &Command { throttle, winch: 6.5 });
        assert!((sent.controls[3] - 0.3).abs() < 1e-6 && (sent.controls[15] - 0.065).abs() < 1e-6);
        assert!(sent.mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED));
    }

    #[test]
    fn a_number_that_is_none_is_found_out() {
        let mut state = State::default();
        let sensor = HIL_SENSOR_DATA {
            xgyro: f32::NAN,
            fields_updated: HilSensorUpdatedFlags::all(),
            ..HIL_SENSOR_DATA::default()
        };
        state.take(&Message::Sensor(sensor)).unwrap();
        assert_eq!(state.frame.check().unwrap_err(), "angular rate is NaN");
        let lost = HIL_STATE_QUATERNION_DATA::default();
        assert!(state.take(&Message::State(lost)).is_err());
    }
}
