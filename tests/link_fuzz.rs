//! Frames with a good checksum and anything in them, sent to a vehicle on the ground and in every mode.
//!
//! Nothing panics, whatever leaves the step is finite, throttles stay in 0 to 1, and the mode changes only
//! by a request that was accepted or with an event that says why.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]
#![allow(deprecated, reason = "MAVLink deprecates messages that today's clients still send")]

use mavlink::dialects::common as mav;
use mavlink::{Message, MessageData};
use tautline_firmware::param::{Kind, META};
use tautline_firmware::signal::Outcome;
use tautline_firmware::supervisor::{GroundState, MODES, Mode};
use tautline_firmware::vehicle::StepOutput;
use tautline_sitl::flight::Flight;
use tautline_sitl::plant::{Generator, generator, uniform};
use tautline_tests::{HOLD, flight, run, until};

/// Every message that the link reads, and where its target stands.
const READ: [(u32, Option<usize>); 39] = [
    (mav::HEARTBEAT_DATA::ID, None),
    (mav::COMMAND_LONG_DATA::ID, Some(30)),
    (mav::COMMAND_INT_DATA::ID, Some(30)),
    (mav::SET_MODE_DATA::ID, Some(4)),
    (mav::PARAM_REQUEST_LIST_DATA::ID, Some(0)),
    (mav::PARAM_REQUEST_READ_DATA::ID, Some(2)),
    (mav::PARAM_SET_DATA::ID, Some(4)),
    (mav::MISSION_REQUEST_LIST_DATA::ID, Some(0)),
    (mav::MISSION_COUNT_DATA::ID, Some(2)),
    (mav::MISSION_CLEAR_ALL_DATA::ID, Some(0)),
    (mav::MANUAL_CONTROL_DATA::ID, Some(10)),
    (mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID, Some(50)),
    (mav::ODOMETRY_DATA::ID, None),
    (mav::VISION_POSITION_ESTIMATE_DATA::ID, None),
    (mav::ATT_POS_MOCAP_DATA::ID, None),
    (mav::DEBUG_VECT_DATA::ID, None),
    (mav::WINCH_STATUS_DATA::ID, None),
    (mav::PING_DATA::ID, None),
    (mav::TIMESYNC_DATA::ID, None),
    (mav::FILE_TRANSFER_PROTOCOL_DATA::ID, Some(1)),
    (mav::SET_POSITION_TARGET_GLOBAL_INT_DATA::ID, Some(50)),
    (mav::SET_ATTITUDE_TARGET_DATA::ID, Some(36)),
    (mav::RC_CHANNELS_OVERRIDE_DATA::ID, Some(16)),
    (mav::MISSION_REQUEST_DATA::ID, Some(2)),
    (mav::MISSION_REQUEST_INT_DATA::ID, Some(2)),
    (mav::MISSION_SET_CURRENT_DATA::ID, Some(2)),
    (mav::MISSION_ITEM_INT_DATA::ID, Some(32)),
    (mav::PARAM_EXT_REQUEST_LIST_DATA::ID, Some(0)),
    (mav::PARAM_EXT_REQUEST_READ_DATA::ID, Some(2)),
    (mav::PARAM_EXT_SET_DATA::ID, Some(0)),
    (mav::LOG_REQUEST_LIST_DATA::ID, Some(4)),
    (mav::LOG_REQUEST_DATA_DATA::ID, Some(10)),
    (mav::LOG_REQUEST_END_DATA::ID, Some(0)),
    (mav::SERIAL_CONTROL_DATA::ID, Some(79)),
    (mav::SET_HOME_POSITION_DATA::ID, Some(52)),
    (mav::SET_GPS_GLOBAL_ORIGIN_DATA::ID, Some(12)),
    (mav::REQUEST_EVENT_DATA::ID, Some(4)),
    (mav::CHANGE_OPERATOR_CONTROL_DATA::ID, None),
    (mav::SETUP_SIGNING_DATA::ID, Some(8)),
];

/// Every command that means something to the link.
const COMMANDS: [u16; 27] = [
    400, 22, 20, 21, 176, 192, 31010, 31011, 31012, 241, 245, 401, 410, 510, 511, 512, 519, 520,
    420, 42600, 185, 209, 246, 262, 310, 32100, 42006,
];

/// Commands that may change the mode; 0 is a message without an acknowledgement.
const MODE_COMMANDS: [u16; 10] = [0, 20, 21, 22, 176, 192, 400, 185, 246, 262];

struct Fuzz {
    rng: Generator,
    sequence: u8,
    /// One sender; else mostly the operator.
    from: Option<u8>,
}

impl Fuzz {
    fn new(seed: u64) -> Self {
        Self { rng: generator(seed, 77), sequence: 0, from: None }
    }

    /// 0 to `n`, without `n`.
    fn below(&mut self, n: usize) -> usize {
        let share = f64::midpoint(uniform(&mut self.rng), 1.0);
        ((share * n as f64) as usize).min(n - 1)
    }
    fn chance(&mut self, share: f64) -> bool {
        uniform(&mut self.rng) < 2.0 * share - 1.0
    }
    fn byte(&mut self) -> u8 {
        self.below(256) as u8
    }

    /// A number as clients send it, as no client should, or any bits.
    fn float(&mut self) -> f32 {
        const ODD: [f32; 12] = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            0.0,
            -0.0,
            1.0,
            2.0,
            21196.0,
            f32::MAX,
            f32::MIN_POSITIVE,
            -1.0,
            1e9,
        ];
        match self.below(4) {
            0 => ODD[self.below(ODD.len())],
            1 => f32::from_le_bytes([self.byte(), self.byte(), self.byte(), self.byte()]),
            2 => (uniform(&mut self.rng) * 10.0) as f32,
            _ => (uniform(&mut self.rng) * 180.0) as f32,
        }
    }

    fn payload(&mut self, id: u32, at: Option<usize>) -> Vec<u8> {
        let mut payload: Vec<u8> = (0..64).flat_map(|_| self.float().to_le_bytes()).collect();
        if let (Some(at), true) = (at, self.chance(0.9)) {
            payload[at..at + 2].copy_from_slice(&[1, 1]);
        }
        let good = self.chance(0.8);
        match id {
            mav::COMMAND_LONG_DATA::ID | mav::COMMAND_INT_DATA::ID if good => {
                let number = COMMANDS[self.below(COMMANDS.len())];
                payload[28..30].copy_from_slice(&number.to_le_bytes());
                if number == 176 {
                    let custom = MODES[self.below(MODES.len())].custom_mode;
                    payload[4..8].copy_from_slice(&(custom as f32).to_le_bytes());
                }
            }
            mav::SET_MODE_DATA::ID if good => {
                let custom = MODES[self.below(MODES.len())].custom_mode;
                payload[..4].copy_from_slice(&custom.to_le_bytes());
            }
            mav::PARAM_SET_DATA::ID | mav::PARAM_REQUEST_READ_DATA::ID if good => {
                let meta = &META[self.below(META.len())];
                let at = if id == mav::PARAM_SET_DATA::ID { 6 } else { 4 };
                payload[at..at + 16].fill(0);
                payload[at..at + meta.name.len()].copy_from_slice(meta.name.as_bytes());
                if at == 6 {
                    // MAV_PARAM_TYPE_REAL32 or _INT32.
                    payload[22] = if meta.kind == Kind::Real { 9 } else { 6 };
                }
            }
            mav::DEBUG_VECT_DATA::ID if good => payload[20..24].copy_from_slice(b"rod\0"),
            mav::ODOMETRY_DATA::ID if good => payload[228] = 1,
            mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID if good => payload[52] = 1,
            mav::MANUAL_CONTROL_DATA::ID if good => {
                for at in [0, 2, 4, 6] {
                    let stick = (uniform(&mut self.rng) * 1000.0) as i16;
                    payload[at..at + 2].copy_from_slice(&stick.to_le_bytes());
                }
            }
            _ => {}
        }
        // Zeros at the end may be left out, and some senders send more.
        let length = if self.chance(0.2) { self.below(256) } else { 255 };
        payload.truncate(length);
        payload
    }

    fn frame(&mut self, may: &impl Fn(u32) -> bool) -> Vec<u8> {
        let (id, at) = loop {
            let (id, at) = READ[self.below(READ.len())];
            if may(id) {
                break (id, at);
            }
        };
        let known = mav::MavMessage::extra_crc(id);
        let payload = self.payload(id, at);
        self.sequence = self.sequence.wrapping_add(1);
        let [a, b, c, _] = id.to_le_bytes();
        let from = self.from;
        let (system, component) = match from {
            Some(system) => (system, self.byte()),
            None if self.chance(0.9) => (255, 190),
            None => (self.byte(), 1),
        };
        let length = payload.len() as u8;
        let mut frame = vec![0xFD, length, 0, 0, self.sequence, system, component, a, b, c];
        frame.extend(payload);
        let crc = mavlink::calculate_crc(&frame[1..], known);
        frame.extend(crc.to_le_bytes());
        frame
    }
}

/// Any number in the output, however deep.
fn is_finite(out: &StepOutput) -> bool {
    let text = format!("{out:?}");
    let words = text.split(|c: char| !c.is_ascii_alphanumeric());
    !words.into_iter().any(|word| word == "NaN" || word == "inf")
}

fn check(out: &StepOutput, before: Mode, name: &str) {
    for throttle in out.actuation.throttle.iter().copied() {
        assert!((0.0..=1.0).contains(&throttle), "{name}: throttle {throttle}");
        assert!(out.is_armed || throttle == 0.0, "{name}: throttle {throttle} while disarmed");
    }
    if out.mode != before {
        let is_asked = out.reply.is_some_and(|reply| {
            reply.outcome == Outcome::Accepted && MODE_COMMANDS.contains(&reply.ticket.command)
        });
        let is_told = out.events.iter().next().is_some();
        assert!(is_asked || is_told, "{name}: {before:?} to {:?} unasked", out.mode);
    }
}

/// What a bombardment did.
struct Tally {
    /// Frames that the link took for its own.
    frames: u32,
    /// Requests that were accepted.
    accepted: u32,
    mode_changes: u32,
}

/// Bursts of frames for so many ms.
fn bombard(
    flight: &mut Flight<Vec<u8>>,
    fuzz: &mut Fuzz,
    ms: u32,
    name: &str,
    may: impl Fn(u32) -> bool,
) -> Tally {
    let mut received = flight.world.connection.counters().received;
    let mut tally = Tally { frames: 0, accepted: 0, mode_changes: 0 };
    flight.step(&mut |_| {});
    for k in 0..ms {
        if k % 5 == 0 {
            for _ in 0..=fuzz.below(4) {
                let frame = fuzz.frame(&may);
                flight.world.receive(&frame, &mut |_| {});
            }
        }
        let before = flight.output().mode;
        flight.step(&mut |_| {});
        let out = flight.output();
        // A restart that was asked for begins in the first mode, and forgets who asked.
        check(out, if flight.world.has_restarted() { out.mode } else { before }, name);
        tally.mode_changes += u32::from(out.mode != before);
        let now = flight.world.connection.counters().received;
        tally.frames += now.checked_sub(received).unwrap_or(now);
        received = now;
        tally.accepted += u32::from(out.reply.is_some_and(|r| r.outcome == Outcome::Accepted));
        if k % 10 == 0 {
            assert!(is_finite(out), "{name}: {out:#?}");
        }
    }
    println!(
        "{name}: {} frames, {} accepted, {} changes of mode",
        tally.frames, tally.accepted, tally.mode_changes
    );
    tally
}

/// Everything but what may move, stop or reconfigure the vehicle.
fn is_harmless(id: u32) -> bool {
    ![
        mav::COMMAND_LONG_DATA::ID,
        mav::COMMAND_INT_DATA::ID,
        mav::SET_MODE_DATA::ID,
        mav::PARAM_SET_DATA::ID,
        mav::SET_POSITION_TARGET_LOCAL_NED_DATA::ID,
    ]
    .contains(&id)
}

fn command(number: u16, p: [f32; 3]) -> Vec<u8> {
    let mut payload = [0_u8; 33];
    for (at, p) in p.iter().enumerate() {
        payload[4 * at..4 * at + 4].copy_from_slice(&p.to_le_bytes());
    }
    payload[28..32].copy_from_slice(&[number.to_le_bytes()[0], number.to_le_bytes()[1], 1, 1]);
    let mut frame = vec![0xFD, 33, 0, 0, 0, 255, 190, 76, 0, 0];
    frame.extend(payload);
    let crc = mavlink::calculate_crc(&frame[1..], 152);
    frame.extend(crc.to_le_bytes());
    frame
}

#[test]
fn a_vehicle_on_the_ground_survives_any_frame() {
    for seed in 1..=4 {
        let mut flight = flight("", seed);
        run(&mut flight, 5.0);
        let name = format!("ground, seed {seed}");
        let done = bombard(&mut flight, &mut Fuzz::new(seed), 6000, &name, |_| true);
        // A bombardment that the link ignored would show nothing.
        assert!(done.frames > 1500 && done.accepted > 40 && done.mode_changes > 3, "{name}");
    }
}

#[test]
fn frames_that_ask_for_nothing_leave_the_hold_alone() {
    let mut flight = flight(HOLD, 1);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    // The winch's length comes from the vehicle's own encoder here; capture has no use on a tether.
    bombard(&mut flight, &mut Fuzz::new(5), 4000, "hold", is_harmless);
    let out = run(&mut flight, 2.0);
    assert_eq!((out.mode, out.is_armed, out.ground), (Mode::TetherHold, true, GroundState::InAir));
    assert!(flight.metrics.summary().lost.is_none());
}

/// Airborne in a mode that the winch allows, then anything at all.
#[test]
fn a_vehicle_in_the_air_on_the_winch_survives_any_frame() {
    for (seed, mode) in [
        (1, Mode::TetherHold),
        (2, Mode::Altitude),
        (3, Mode::Stabilize),
        (4, Mode::Land),
        (5, Mode::Descent),
        (6, Mode::Takeoff),
    ] {
        let mut flight = flight(HOLD, seed);
        until(&mut flight, 80.0, |out| {
            let is_there = mode == Mode::Takeoff || out.mode == Mode::TetherHold;
            is_there && out.ground == GroundState::InAir
        });
        let sticks = mav::MANUAL_CONTROL_DATA { x: 0, y: 0, z: 500, r: 0, buttons: 0, target: 1 };
        let mut raw = mavlink::MAVLinkV2MessageRaw::new();
        let from = mavlink::MavHeader { system_id: 255, component_id: 190, sequence: 0 };
        raw.serialize_message_data(from, &sticks);
        flight.world.receive(raw.raw_bytes(), &mut |_| {});
        run(&mut flight, 0.01);
        if mode != Mode::Takeoff {
            let custom = mode.rule().custom_mode;
            flight.world.receive(&command(176, [1.0, custom as f32, 0.0]), &mut |_| {});
        }
        let name = format!("{mode:?}, seed {seed}");
        assert_eq!(run(&mut flight, 0.01).mode, mode, "{name}");
        bombard(&mut flight, &mut Fuzz::new(seed), 1000, &name, is_harmless);
        let done = bombard(&mut flight, &mut Fuzz::new(seed), 5000, &name, |_| true);
        assert!(done.frames > 1500 && done.accepted > 40 && done.mode_changes > 0, "{name}");
    }
}

/// Airborne in a mode of the cable by inertia or of free flight, as its scenario flies it.
#[test]
fn a_vehicle_in_the_other_modes_survives_any_frame() {
    for (seed, mode, scenario) in [
        (1, Mode::TautForce, include_str!("../sitl/scenarios/taut.toml")),
        (2, Mode::TetherAngle, include_str!("../sitl/scenarios/angle.toml")),
        (3, Mode::Pendulum, include_str!("../sitl/scenarios/pendulum.toml")),
    ] {
        let mut flight = flight(scenario, seed);
        until(&mut flight, 120.0, |out| out.mode == mode);
        run(&mut flight, 2.0);
        let name = format!("{mode:?}, seed {seed}");
        bombard(&mut flight, &mut Fuzz::new(seed), 1000, &name, is_harmless);
        let done = bombard(&mut flight, &mut Fuzz::new(seed), 5000, &name, |_| true);
        assert!(done.frames > 1500 && done.accepted > 40 && done.mode_changes > 0, "{name}");
    }
}

/// `FUZZ_FRAMES=10000000 cargo test --release -p tautline-tests --test link_fuzz stranger` sends that many.
#[test]
fn a_strangers_frames_in_flight_change_nothing() {
    let wanted = std::env::var("FUZZ_FRAMES").map_or(40_000, |text| text.parse().unwrap());
    let mut flight = flight(HOLD, 1);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    let before = *flight.output();
    let params = *flight.world.vehicle.params();
    let mut fuzz = Fuzz::new(11);
    let (mut sent, mut heard) = (0_u64, 0);
    while heard < wanted {
        for peer in 0..12_u16 {
            fuzz.from = Some(2 + (fuzz.below(250) as u8));
            let mut datagram = Vec::new();
            while datagram.len() < 1200 {
                datagram.extend(fuzz.frame(&|_| true));
                sent += 1;
            }
            let address = std::net::SocketAddr::from(([127, 0, 0, 1], 40_000 + peer));
            flight.world.links.arrive(0, address, &datagram);
        }
        flight.step(&mut |_| {});
        flight.world.links.iter_mut().for_each(|peer| drop(peer.take_outbox()));
        let out = flight.output();
        check(out, before.mode, "stranger");
        assert_eq!((out.mode, out.is_armed, out.commander), (before.mode, true, before.commander));
        assert_eq!(out.failures, 0);
        heard = u64::from(flight.world.links.counters().received);
    }
    assert!(is_finite(flight.output()));
    assert_eq!(*flight.world.vehicle.params(), params);
    assert!(flight.world.environment.active_faults().is_empty());
    assert!(flight.world.links.signing.is_none());
    println!("{sent} frames, {heard} for the vehicle");
}
