//! Helpers that several test files share: a flight in a few lines.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "test support")]

use mavlink::dialects::common::{
    COMMAND_LONG_DATA, MavCmd, MavFrame, MavMessage, PositionTargetTypemask,
    SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use mavlink::{Message, MessageData};
use sha2::{Digest, Sha256};
use std::io::{Sink, Write};
use tautline_firmware::mavlink::Connection;
use tautline_firmware::param::Params;
use tautline_firmware::supervisor::Mode;
use tautline_firmware::time::Micros;
use tautline_firmware::vehicle::StepOutput;
use tautline_sitl::flight::{Flight, MavlinkSender};
use tautline_sitl::scenario::Scenario;

/// A flight of a scenario given as TOML, logged to memory.
///
/// # Panics
/// If the scenario is not valid.
#[must_use]
pub fn flight(toml: &str, seed: u64) -> Flight<Vec<u8>> {
    let scenario = Scenario::parse(toml, "test.toml").unwrap();
    Flight::new(&scenario, scenario.params().unwrap(), seed, Vec::new()).unwrap()
}

/// Steps until `ends`, or fails after `limit` s.
///
/// # Panics
/// After `limit` s.
pub fn until(
    flight: &mut Flight<Vec<u8>>,
    limit: f64,
    mut ends: impl FnMut(&StepOutput) -> bool,
) -> StepOutput {
    let began = flight.world.time();
    loop {
        flight.step(&mut |_| {});
        let out = flight.output();
        if ends(out) {
            return *out;
        }
        let told: Vec<_> =
            flight.events.iter().map(|(t, e)| format!("{t:.1} {}", e.text)).collect();
        assert!(
            flight.world.time() < began + limit,
            "not within {limit} s; mode {:?}, events {told:?}",
            out.mode
        );
    }
}

/// Steps for so long.
///
/// # Panics
/// Never.
pub fn run(flight: &mut Flight<Vec<u8>>, seconds: f64) -> StepOutput {
    let end = flight.world.time() + seconds;
    flight.step(&mut |_| {});
    while flight.world.time() < end {
        flight.step(&mut |_| {});
    }
    *flight.output()
}

/// A mission that takes off to 5 m and then holds for a long time.
pub const HOLD: &str = r#"
[[mission]]
do = "arm"
[[mission]]
do = "takeoff"
altitude = 5.0
[[mission]]
do = "hold"
seconds = 1000.0
"#;

/// Takes off to 5 m, holds for 40 s and lands.
pub const UP_AND_DOWN: &str = r#"
[[mission]]
do = "arm"
[[mission]]
do = "takeoff"
altitude = 5.0
[[mission]]
do = "hold"
seconds = 40.0
[[mission]]
do = "land"
"#;

/// Up, a hold and down in a world that is described, to its end or for `limit` s.
///
/// # Panics
/// If the scenario is not valid.
#[must_use]
pub fn flown(world: &str, seed: u64, limit: f64) -> Flight<Sink> {
    let scenario = Scenario::parse(&format!("{world}\n{UP_AND_DOWN}"), "case").unwrap();
    let mut flight = Flight::unrecorded(&scenario, scenario.params().unwrap(), seed).unwrap();
    flight.fly(limit);
    flight
}

/// How often a text was told.
#[must_use]
pub fn told(flight: &Flight<Sink>, text: &str) -> usize {
    flight.events.iter().filter(|(_, event)| event.text.contains(text)).count()
}

/// Down, off and in one piece.
///
/// # Panics
/// If it is not.
pub fn is_safe(flight: &Flight<Sink>) {
    let summary = flight.metrics.summary();
    assert_eq!(summary.lost, None, "{summary:?}");
    assert!(!flight.output().is_armed, "motors run");
}

/// Asks for a mode, as the operator's ground station does.
pub fn ask<W: Write>(flight: &mut Flight<W>, mode: Mode) {
    let [_, _, main, sub] = mode.rule().custom_mode.to_le_bytes();
    let message = COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_DO_SET_MODE,
        param1: 1.0,
        param2: f32::from(main),
        param3: f32::from(sub),
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    };
    let frame = MavlinkSender::new(255, 190).frame(&message);
    flight.world.receive(&frame, &mut |_| {});
}

/// One set-point of a program's stream: a place, or none, and a velocity, world axes.
pub fn stream<W: Write>(flight: &mut Flight<W>, place: Option<[f64; 3]>, velocity: [f64; 3]) {
    // Accelerations and yaw are never given; these bits leave out the place.
    const NO_ACCELERATION_NO_YAW: u16 = 0b1101_1100_0000;
    const NO_PLACE: u16 = 0b111;
    let left_out = if place.is_some() { 0 } else { NO_PLACE };
    let [x, y, z] = place.unwrap_or_default().map(|x| x as f32);
    let [vx, vy, vz] = velocity.map(|x| x as f32);
    let message = SET_POSITION_TARGET_LOCAL_NED_DATA {
        x,
        y,
        z,
        vx,
        vy,
        vz,
        type_mask: PositionTargetTypemask::from_bits_truncate(NO_ACCELERATION_NO_YAW | left_out),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::default()
    };
    let frame = MavlinkSender::new(255, 190).frame(&message);
    flight.world.receive(&frame, &mut |_| {});
}

/// A link that has heard one message of a device of the vehicle's own.
#[must_use]
pub fn heard<D: MessageData>(message: &D) -> Connection {
    let mut link = Connection::new();
    let bytes = MavlinkSender::new(1, 197).frame(message);
    link.receive_datagram(Micros(1000), &bytes, &Params::default(), &mut |_| {});
    link
}

/// A MAVLink 2 frame as who holds `key` sends it over link 3, at a time in tens of µs since 2015.
///
/// # Panics
/// If it is no frame.
#[must_use]
pub fn signed(frame: &[u8], key: &[u8; 32], timestamp: u64) -> Vec<u8> {
    let (head, _) = frame.split_last_chunk::<2>().expect("no frame");
    let mut frame = head.to_vec();
    let [_, _, flags, _, _, _, _, a, b, c, ..] = frame.as_mut_slice() else { panic!("no frame") };
    *flags = 1;
    let id = u32::from_le_bytes([*a, *b, *c, 0]);
    let covered = frame.get(1..).expect("no frame");
    let crc = mavlink::calculate_crc(covered, MavMessage::extra_crc(id));
    frame.extend(crc.to_le_bytes());
    frame.push(3);
    frame.extend(timestamp.to_le_bytes().into_iter().take(6));
    let hash = Sha256::new().chain_update(key).chain_update(&frame).finalize();
    frame.extend(hash.iter().take(6));
    frame
}
