//! In flight one ground station has the command.

use super::station::{Station, holding};
use mavlink::dialects::common as mav;
use tautline_firmware::supervisor::{Failure, GroundState, Mode};
use tautline_sitl::flight::Flight;
use tautline_tests::flight;

const FORCED: [f32; 7] = [0.0, 21196.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const LAND: [f32; 7] = [1.0, 4.0, 6.0, 0.0, 0.0, 0.0, 0.0];

#[test]
fn a_stranger_moves_reconfigures_and_stops_nothing() {
    let mut operator = Station::new(255, 1);
    let mut flight = holding(&mut operator);
    let mut stranger = Station::new(77, 2);
    let mut told = 0;
    for (number, p) in [
        (400, FORCED),
        (185, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (176, LAND),
        (192, [-1.0, 1.0, 0.0, f32::NAN, f32::NAN, f32::NAN, 8.0]),
        (32100, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ] {
        assert_eq!(stranger.command(&mut flight, number, p), Some(1), "{number}");
        told += stranger.texts().iter().filter(|t| t.contains("another ground station")).count();
    }
    assert_eq!(told, 1, "not once for each");
    let set = mav::PARAM_SET_DATA {
        param_value: 2.0,
        target_system: 1,
        target_component: 1,
        param_id: "TPC_P".into(),
        param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
    };
    let before = *flight.world.vehicle.params();
    stranger.say(&mut flight, &set);
    let stick = mav::MANUAL_CONTROL_DATA { z: 500, target: 1, ..Default::default() };
    stranger.say(&mut flight, &stick);
    for _ in 0..20 {
        let winch = mav::WINCH_STATUS_DATA { line_length: 6.0, ..Default::default() };
        stranger.say(&mut flight, &winch);
        stranger.run(&mut flight, 50);
    }
    let out = *flight.output();
    assert!(out.is_armed && out.mode == Mode::TetherHold);
    assert_eq!(*flight.world.vehicle.params(), before);
    let length = out.estimate.tether.unwrap().length;
    assert!((length - 10.0).abs() < 0.5, "{length}");
}

#[test]
fn a_strangers_heartbeat_does_not_hide_that_the_commander_is_gone() {
    let mut operator = Station::new(200, 1);
    let mut flight = flight("", 3);
    let beat = |station: &mut Station, flight: &mut Flight<Vec<u8>>, seconds: u32| {
        for _ in 0..2 * seconds {
            station.beat(flight);
            station.run(flight, 500);
        }
    };
    beat(&mut operator, &mut flight, 4);
    let mut p = [0.0; 7];
    p[6] = 3.0;
    assert_eq!(operator.command(&mut flight, 22, p), Some(0));
    p[0] = 1.0;
    assert_eq!(operator.command(&mut flight, 400, p), Some(0));
    beat(&mut operator, &mut flight, 30);
    assert_eq!(flight.output().ground, GroundState::InAir);
    let mut stranger = Station::new(77, 2);
    beat(&mut stranger, &mut flight, 7);
    let lost = flight.output().failures & Failure::LinkLost.mask();
    assert!(lost != 0, "{:?}", flight.events);
    // Whoever comes then may take over, but not begin by stopping the motors.
    let mut second = Station::new(78, 3);
    assert_eq!(second.command(&mut flight, 400, FORCED), Some(1));
    assert_eq!(second.command(&mut flight, 176, LAND), Some(0));
    assert_eq!(flight.output().commander, Some(78));
}

#[test]
fn who_gives_the_command_back_lets_another_take_it() {
    let mut operator = Station::new(255, 1);
    let mut flight = holding(&mut operator);
    let mut second = Station::new(254, 2);
    assert_eq!(second.command(&mut flight, 176, LAND), Some(1));
    let release = |take: f32| [take, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(operator.command(&mut flight, 32100, release(0.0)), Some(0));
    assert_eq!(second.command(&mut flight, 32100, release(1.0)), Some(0));
    assert_eq!(operator.command(&mut flight, 176, LAND), Some(1), "not any more");
    assert_eq!(second.command(&mut flight, 176, LAND), Some(0));
}
