//! A flight with a pilot whose hands a test moves.

use mavlink::dialects::common::MANUAL_CONTROL_DATA;
use mavlink::{MavlinkVersion, MessageData};
use tautline_firmware::mavlink::Parser;
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_sitl::flight::{Flight, MavlinkSender};
use tautline_sitl::scenario::{FaultKind, FaultSection, RadioSection};
use tautline_tests::{HOLD, flight, run, until};

/// Positions of the mode switch, as [`flown_by`] sets them up.
pub const ALTITUDE: u64 = 1;
pub const POSITION: u64 = 4;
pub const LAND: u64 = 6;

/// The shipped scenario's flight, from the ground to the ground.
pub const SHIPPED: &str = include_str!("../../sitl/scenarios/radio.toml");

/// A world with a receiver, its switches mapped, and these parameters and this mission beside.
pub fn flown_by(protocol: &str, params: &str, mission: &str) -> Flight<Vec<u8>> {
    let text = format!(
        "[sensors]\nradio = {protocol:?}\n[params]\nRC_MAP_FLTMODE = 5\nRC_MAP_ARM_SW = 6\nRC_MAP_KILL_SW = 7\n\
         COM_FLTMODE1 = 1\nCOM_FLTMODE4 = 2\nCOM_FLTMODE6 = 11\n{params}\n{mission}"
    );
    flight(&text, 1)
}

/// Seconds since power-up.
pub fn now(flight: &Flight<Vec<u8>>) -> f64 {
    flight.world.now().0 as f64 * 1e-6
}

/// The hands move, now.
pub fn hands(flight: &mut Flight<Vec<u8>>, row: RadioSection) {
    let at = now(flight);
    let pilot = flight.world.environment.sensors.pilot.as_mut().unwrap();
    pilot.hands.push(RadioSection { at, ..row });
}

/// Breaks it, now, for so long.
pub fn breaks(flight: &mut Flight<Vec<u8>>, kind: FaultKind, value: f64, seconds: f64) {
    let duration = Some(seconds);
    let fault = FaultSection { duration, ..FaultSection::new(kind, value, now(flight)) };
    flight.world.environment.faults.add(fault);
}

pub fn throttle(share: f64) -> RadioSection {
    RadioSection { throttle: Some(share), ..RadioSection::default() }
}

pub fn mode(slot: u64) -> RadioSection {
    RadioSection { mode: Some(slot), ..RadioSection::default() }
}

pub fn arm(is_on: bool) -> RadioSection {
    RadioSection { arm: Some(is_on), ..RadioSection::default() }
}

pub fn kill(is_on: bool) -> RadioSection {
    RadioSection { kill: Some(is_on), ..RadioSection::default() }
}

/// A joystick over MAVLink, by the ground station that has the command.
pub fn joystick(flight: &mut Flight<Vec<u8>>, roll: i16, throttle: i16) {
    let stick = MANUAL_CONTROL_DATA { y: roll, z: throttle, target: 1, ..Default::default() };
    let frame = MavlinkSender::new(255, 190).frame(&stick);
    flight.world.receive(&frame, &mut |_| {});
}

/// How often a text was told since event number `from`.
pub fn told(flight: &Flight<Vec<u8>>, from: usize, text: &str) -> usize {
    flight.events[from..].iter().filter(|(_, event)| event.text.contains(text)).count()
}

/// Up in Altitude by radio alone, 3 m over the ground, the throttle in its middle.
pub fn in_altitude(protocol: &str, params: &str) -> Flight<Vec<u8>> {
    let mut flight = flown_by(protocol, params, "");
    until(&mut flight, 20.0, |out| out.is_armable);
    hands(&mut flight, arm(true));
    until(&mut flight, 1.0, |out| out.is_armed && out.mode == Mode::Altitude);
    hands(&mut flight, throttle(0.9));
    until(&mut flight, 20.0, |out| out.estimate.height > 3.0);
    hands(&mut flight, throttle(0.5));
    run(&mut flight, 1.0);
    flight
}

/// The same in Position.
pub fn in_position(protocol: &str, params: &str) -> Flight<Vec<u8>> {
    let mut flight = in_altitude(protocol, params);
    hands(&mut flight, mode(POSITION));
    until(&mut flight, 1.0, |out| out.mode == Mode::Position);
    run(&mut flight, 2.0);
    flight
}

/// A ground station has armed and holds at 5 m; a pilot stands by, the throttle in its middle.
pub fn held_by_a_station(params: &str) -> Flight<Vec<u8>> {
    let mut flight = flown_by("crsf", params, HOLD);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    hands(&mut flight, throttle(0.5));
    run(&mut flight, 1.0);
    assert_eq!(flight.output().commander, Some(255));
    flight
}

/// So many seconds, and what the ground heard of two messages.
pub fn run_and_hear<A: MessageData, B: MessageData>(
    flight: &mut Flight<Vec<u8>>,
    seconds: f64,
) -> (Vec<A>, Vec<B>) {
    let (mut parser, mut first, mut second) = (Parser::new(), Vec::new(), Vec::new());
    let end = flight.world.time() + seconds;
    while flight.world.time() < end {
        flight.step(&mut |bytes| {
            parser.push(bytes, |frame| {
                if frame.id == A::ID {
                    first.push(A::deser(MavlinkVersion::V2, frame.payload).unwrap());
                } else if frame.id == B::ID {
                    second.push(B::deser(MavlinkVersion::V2, frame.payload).unwrap());
                }
            });
        });
    }
    (first, second)
}
