//! The link without a network: what goes in, what comes out.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "tests")]

use mavlink::dialects::common as mav;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};
use tautline_firmware::mavlink::{Frame, Parser};
use tautline_firmware::param::{ALIASES, META, Params};
use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_sitl::flight::Flight;
use tautline_sitl::plant::{generator, uniform};
use tautline_tests::{HOLD, flight, run, until};

fn bytes<D: MessageData>(message: &D) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message_data(
        MavHeader { system_id: 255, component_id: 190, sequence: 0 },
        message,
    );
    raw.raw_bytes().to_vec()
}

fn command(command: mav::MavCmd, p: [f32; 7]) -> Vec<u8> {
    let [param1, param2, param3, param4, param5, param6, param7] = p;
    bytes(&mav::COMMAND_LONG_DATA {
        param1,
        param2,
        param3,
        param4,
        param5,
        param6,
        param7,
        command,
        target_system: 1,
        target_component: 1,
        confirmation: 0,
    })
}

/// Says something to the vehicle and collects what it says within `ms`.
fn say(flight: &mut Flight<Vec<u8>>, datagram: &[u8], ms: u32) -> Vec<Frame<'static>> {
    let mut parser = Parser::new();
    let mut heard = Vec::new();
    let mut listen = |bytes: &[u8]| {
        // Leaked: a test is short, and a frame borrows.
        parser.push(bytes, |frame| {
            let payload = frame.payload.to_vec().leak();
            heard.push(Frame {
                payload,
                id: frame.id,
                system: frame.system,
                component: frame.component,
                signature: None,
            });
        });
    };
    flight.world.receive(datagram, &mut listen);
    for _ in 0..ms {
        flight.step(&mut listen);
    }
    heard
}

fn acknowledged(heard: &[Frame], number: u16) -> Option<u8> {
    heard
        .iter()
        .find(|f| f.id == mav::COMMAND_ACK_DATA::ID && f.word(0) == number)
        .map(|f| f.byte(2))
}

fn texts(heard: &[Frame]) -> Vec<String> {
    heard
        .iter()
        .filter(|f| f.id == mav::STATUSTEXT_DATA::ID)
        .map(|f| {
            mav::STATUSTEXT_DATA::deser(MavlinkVersion::V2, f.payload)
                .unwrap()
                .text
                .to_str()
                .unwrap()
                .to_owned()
        })
        .collect()
}

const ARM: [f32; 7] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

#[test]
fn arming_without_a_ground_station_is_refused_with_a_reason_and_can_be_forced() {
    let mut flight = flight("", 1);
    run(&mut flight, 5.0);
    let arm = mav::MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;
    let heard = say(&mut flight, &command(arm, ARM), 20);
    assert_eq!(acknowledged(&heard, 400), Some(1));
    assert!(texts(&heard).iter().any(|t| t == "Arming denied: no ground station"));
    let forced = [1.0, 21196.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(acknowledged(&say(&mut flight, &command(arm, forced), 20), 400), Some(0));
}

#[test]
fn every_command_number_is_acknowledged_once() {
    let mut flight = flight("", 1);
    run(&mut flight, 4.0);
    for number in (0..3000_u16)
        .step_by(7)
        .chain([400, 22, 21, 20, 176, 192, 262, 401, 410, 511, 512, 245, 246, 241, 420, 42600])
    {
        let mut payload = vec![0_u8; 33];
        payload[28..30].copy_from_slice(&number.to_le_bytes());
        let known = bytes(&mav::COMMAND_LONG_DATA::default());
        // The crate's enum has no unknown numbers: patch the bytes and close the frame again.
        let mut frame = known[..10].to_vec();
        frame[1] = 33;
        frame.extend(&payload);
        let crc = mavlink::calculate_crc(&frame[1..], 152);
        frame.extend(crc.to_le_bytes());
        let heard = say(&mut flight, &frame, 3);
        let acks = heard
            .iter()
            .filter(|f| f.id == mav::COMMAND_ACK_DATA::ID && f.word(0) == number)
            .count();
        assert_eq!(acks, 1, "command {number}");
    }
}

#[test]
fn the_parameter_list_is_whole_and_a_bad_value_is_answered_with_the_old_one() {
    let mut flight = flight("", 1);
    let request = bytes(&mav::PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 });
    let heard = say(&mut flight, &request, 8 * (META.len() + ALIASES.len()) as u32 + 50);
    let values: Vec<_> = heard
        .iter()
        .filter(|f| f.id == mav::PARAM_VALUE_DATA::ID)
        .map(|f| mav::PARAM_VALUE_DATA::deser(MavlinkVersion::V2, f.payload).unwrap())
        .collect();
    let names: Vec<_> =
        META.iter().map(|meta| meta.name).chain(ALIASES.iter().map(|alias| alias.name)).collect();
    assert_eq!(values.len(), names.len());
    for (name, value) in names.iter().zip(&values) {
        assert_eq!(value.param_id.to_str().unwrap(), *name);
        assert_eq!(usize::from(value.param_count), names.len());
    }
    let set = |value: f32| {
        bytes(&mav::PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: "RATE_P".into(),
            param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
        })
    };
    let echo = |heard: &[Frame]| {
        heard.iter().find(|f| f.id == mav::PARAM_VALUE_DATA::ID).map(|f| f.float(0))
    };
    assert_eq!(echo(&say(&mut flight, &set(25.0), 5)), Some(25.0));
    for bad in [f32::NAN, f32::INFINITY, -1.0, 1e9] {
        assert_eq!(echo(&say(&mut flight, &set(bad), 5)), Some(25.0), "{bad}");
    }
    assert_eq!(
        flight.world.vehicle.params(),
        &Params { rate_p: 25.0, ..*flight.world.vehicle.params() }
    );
}

#[test]
fn a_position_target_moves_the_vehicle_in_offboard_alone_and_a_nan_one_never() {
    let mut flight = flight(HOLD, 1);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    let target = |x: f32, y: f32, z: f32| {
        bytes(&mav::SET_POSITION_TARGET_LOCAL_NED_DATA {
            x,
            y,
            z,
            coordinate_frame: mav::MavFrame::MAV_FRAME_LOCAL_NED,
            type_mask: mav::PositionTargetTypemask::from_bits_retain(0x0DF8),
            target_system: 1,
            target_component: 1,
            ..Default::default()
        })
    };
    let here = |flight: &Flight<Vec<u8>>| flight.world.environment.plant.body.position;
    let heard = say(&mut flight, &target(f32::NAN, 0.0, -5.0), 10);
    assert!(texts(&heard).contains(&"Set-point refused: not a number".to_owned()));
    let offboard = command(mav::MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    run(&mut flight, 1.0);
    assert_eq!(acknowledged(&say(&mut flight, &offboard, 20), 176), Some(1), "nothing streams");
    let before = here(&flight);
    for _ in 0..10 {
        say(&mut flight, &target(6.0, 3.0, -6.0), 100);
    }
    assert!((here(&flight) - before).norm() < 0.5, "set-points move nothing in Hold");
    assert_eq!(acknowledged(&say(&mut flight, &offboard, 20), 176), Some(0));
    let heard = say(&mut flight, &target(0.5, 0.0, -60.0), 50);
    assert!(texts(&heard).iter().any(|t| t.starts_with("Move refused")), "{:?}", texts(&heard));
    for _ in 0..250 {
        say(&mut flight, &target(6.0, 3.0, -6.0), 100);
    }
    let p = here(&flight);
    assert!((p.x - 6.0).hypot(p.y - 3.0) < 0.8 && (p.z + 6.0).abs() < 0.4, "{p}");
    let out = run(&mut flight, 1.0);
    assert_eq!(out.mode, Mode::TetherHold, "the stream has ended");
}

#[test]
fn in_the_air_disarming_and_the_vehicles_own_parameters_are_refused() {
    let mut flight = flight(HOLD, 1);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    let arm = mav::MavCmd::MAV_CMD_COMPONENT_ARM_DISARM;
    assert_eq!(acknowledged(&say(&mut flight, &command(arm, [0.0; 7]), 20), 400), Some(2));
    let set = |name: &str, value: f32| {
        bytes(&mav::PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
            param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
        })
    };
    for locked in ["VEH_MASS", "RATE_P", "HOME_ALT", "THR_MDL_FAC"] {
        let heard = say(&mut flight, &set(locked, 1.0), 50);
        assert!(texts(&heard).iter().any(|t| t == "Parameter refused: armed"), "{locked}");
    }
    let heard = say(&mut flight, &set("TET_LENGTH", 12.0), 50);
    assert!(texts(&heard).iter().any(|t| t.contains("not in the air")));
    assert!((flight.world.vehicle.params().mass - 1.5).abs() < 1e-6);
    assert!(run(&mut flight, 1.0).is_armed);
}

#[test]
fn random_bytes_and_random_frames_change_nothing_in_flight() {
    let mut flight = flight(HOLD, 1);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    let mut rng = generator(9, 0);
    let mut byte = || (uniform(&mut rng) * 127.9 + 128.0) as u8;
    for _ in 0..300 {
        let noise: Vec<u8> = (0..1400).map(|_| byte()).collect();
        flight.world.receive(&noise, &mut |_| {});
        flight.step(&mut |_| {});
    }
    let out = run(&mut flight, 2.0);
    assert_eq!((out.mode, out.is_armed), (Mode::TetherHold, true));
    assert!(flight.world.connection.counters().garbage_bytes > 300_000);
}

#[test]
fn sticks_fly_altitude_mode_and_their_loss_ends_on_the_ground() {
    let mut flight = flight(HOLD, 1);
    until(&mut flight, 80.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    let altitude = command(mav::MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(acknowledged(&say(&mut flight, &altitude, 10), 176), Some(1), "no joystick yet");
    let sticks =
        bytes(&mav::MANUAL_CONTROL_DATA { x: 0, y: 0, z: 500, r: 0, buttons: 0, target: 1 });
    say(&mut flight, &sticks, 10);
    assert_eq!(acknowledged(&say(&mut flight, &altitude, 10), 176), Some(0));
    let before = flight.world.environment.plant.body.height();
    for _ in 0..20 {
        say(&mut flight, &sticks, 100);
    }
    assert!((flight.world.environment.plant.body.height() - before).abs() < 0.7);
    until(&mut flight, 5.0, |out| out.mode == Mode::Descent);
    until(&mut flight, 60.0, |out| !out.is_armed);
    assert!(flight.world.environment.plant.body.tilt() < 0.3);
}
