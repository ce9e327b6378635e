//! Modes as clients know them.

use super::station::{Station, holding};
use mavlink::dialects::common as mav;
use tautline_firmware::supervisor::{Failure, GroundState, Mode};
use tautline_tests::{HOLD, ask, flight, run, stream, until};

fn attitude(mask: u8, q: [f32; 4], rates: [f32; 3], thrust: f32) -> mav::SET_ATTITUDE_TARGET_DATA {
    let [body_roll_rate, body_pitch_rate, body_yaw_rate] = rates;
    mav::SET_ATTITUDE_TARGET_DATA {
        q,
        body_roll_rate,
        body_pitch_rate,
        body_yaw_rate,
        thrust,
        target_system: 1,
        target_component: 1,
        type_mask: mav::AttitudeTargetTypemask::from_bits_retain(mask),
        ..Default::default()
    }
}

#[test]
fn return_is_a_mode_of_its_own_and_lands() {
    let mut station = Station::new(255, 1);
    let mut flight = holding(&mut station);
    ask(&mut flight, Mode::Return);
    assert_eq!(run(&mut flight, 0.1).mode, Mode::Return);
    until(&mut flight, 120.0, |out| !out.is_armed);
    assert!(flight.metrics.verdict.touch_down.unwrap() < 0.8);
}

#[test]
fn offboard_follows_attitudes_and_rates_and_refuses_what_it_cannot_fly() {
    let mut station = Station::new(255, 1);
    let mut flight = holding(&mut station);
    // As the hold flies: upright would let the line pull it in.
    let q = flight.output().estimate.attitude.quaternion();
    let weight = 1.5 * 9.81 + 4.5;
    let share = weight / flight.world.vehicle.params().thrust_max;
    station.say(&mut flight, &attitude(0b111, q, [0.0; 3], share));
    run(&mut flight, 0.01);
    ask(&mut flight, Mode::Offboard);
    for _ in 0..10 {
        station.say(&mut flight, &attitude(0b111, q, [0.0; 3], share));
        assert_eq!(run(&mut flight, 0.1).mode, Mode::Offboard);
    }
    let (roll, pitch, _) = flight.output().estimate.attitude.euler();
    assert!(roll.abs() < 0.25 && pitch.abs() < 0.5, "{roll} {pitch}");
    station.heard.clear();
    let over = [0.70, 0.71, 0.0, 0.0];
    station.say(&mut flight, &attitude(0b111, over, [0.0; 3], share));
    station.run(&mut flight, 20);
    assert!(station.texts().contains(&"Set-point refused: tilt above MAN_TILT_MAX".into()));
    // A slow turn by rates alone.
    let yaw = |flight: &tautline_sitl::flight::Flight<Vec<u8>>| {
        flight.output().estimate.attitude.euler().2
    };
    let before = yaw(&flight);
    for _ in 0..10 {
        station.say(&mut flight, &attitude(1 << 7, [f32::NAN; 4], [0.0, 0.0, 0.4], share));
        run(&mut flight, 0.1);
    }
    assert!((yaw(&flight) - before - 0.4).abs() < 0.15, "{}", yaw(&flight) - before);
    // The stream ends: it holds, whatever it did.
    let out = run(&mut flight, 1.0);
    assert_eq!((out.mode, out.ground), (Mode::TetherHold, GroundState::InAir));
    let at = flight.world.environment.plant.body.position;
    run(&mut flight, 4.0);
    assert!((flight.world.environment.plant.body.position - at).norm() < 1.5);
}

#[test]
fn pause_hold_and_land_leave_offboard_at_once() {
    let mut station = Station::new(255, 1);
    for leave in [Mode::TetherHold, Mode::Land] {
        let mut flight = holding(&mut station);
        let east = |flight: &mut tautline_sitl::flight::Flight<Vec<u8>>| {
            stream(flight, None, [0.0, 0.5, 0.0]);
            run(flight, 0.1);
        };
        east(&mut flight);
        ask(&mut flight, Mode::Offboard);
        (0..10).for_each(|_| east(&mut flight));
        assert_eq!(flight.output().mode, Mode::Offboard);
        ask(&mut flight, leave);
        // The stream goes on, and moves nothing.
        let y = flight.output().reference.unwrap().position.0.y;
        (0..20).for_each(|_| east(&mut flight));
        assert_eq!(flight.output().mode, leave);
        if leave == Mode::TetherHold {
            let now = flight.output().reference.unwrap().position.0.y;
            assert!((now - y).abs() < 0.2, "{y} {now}");
        }
    }
}

#[test]
fn position_follows_the_sticks_and_holds_without_them() {
    let mut station = Station::new(255, 1);
    let mut flight = holding(&mut station);
    let stick =
        |x: i16, y: i16| mav::MANUAL_CONTROL_DATA { x, y, z: 500, target: 1, ..Default::default() };
    station.say(&mut flight, &stick(0, 0));
    run(&mut flight, 0.05);
    ask(&mut flight, Mode::Position);
    assert_eq!(run(&mut flight, 0.05).mode, Mode::Position);
    let from = flight.output().reference.unwrap().position.0;
    for _ in 0..40 {
        station.say(&mut flight, &stick(0, 1000));
        run(&mut flight, 0.1);
    }
    let to = flight.output().reference.unwrap().position.0;
    assert!((to - from).norm() > 1.5, "{from} {to}");
    // The stick goes back, then the joystick is gone.
    for _ in 0..20 {
        station.say(&mut flight, &stick(0, 0));
        run(&mut flight, 0.1);
    }
    let rest = flight.output().reference.unwrap().position.0;
    assert!((rest - to).norm() < 0.6);
    assert_eq!(run(&mut flight, 2.0).mode, Mode::TetherHold);
}

#[test]
fn modes_that_the_link_forbids_cannot_be_chosen() {
    let mut station = Station::new(255, 1);
    let mut flight = holding(&mut station);
    station.command(&mut flight, 512, [435.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let modes = station.all::<mav::AVAILABLE_MODES_DATA>();
    assert_eq!(modes.len(), usize::from(modes[0].number_modes));
    let hidden = mav::MavModeProperty::MAV_MODE_PROPERTY_NOT_USER_SELECTABLE;
    for mode in &modes {
        let name = mode.mode_name.to_str().unwrap();
        let is_hidden = mode.properties.contains(hidden);
        let forbidden = ["Taut Force", "Taut Attitude", "Tether Angle", "Pendulum"];
        assert_eq!(is_hidden, forbidden.contains(&name), "{name}");
    }
}

#[test]
fn a_fence_refuses_moves_beyond_it_and_does_what_it_is_set_to() {
    let fenced = |action: f32| {
        let text = format!("[params]\nGF_ACTION = {action:.1}\nGF_MAX_VER_DIST = 6.0\n{HOLD}");
        let mut flight = flight(&text, 3);
        until(&mut flight, 80.0, |out| {
            out.mode == Mode::TetherHold && out.ground == GroundState::InAir
        });
        flight
    };
    let mut station = Station::new(255, 1);
    let mut inside = fenced(2.0);
    station.beat(&mut inside);
    let up = [-1.0, 1.0, 0.0, f32::NAN, f32::NAN, f32::NAN, 8.0];
    assert_eq!(station.command(&mut inside, 192, up), Some(2));
    assert!(station.texts().contains(&"Move refused: beyond the fence".into()));
    let bit = mav::MavSysStatusSensor::MAV_SYS_STATUS_GEOFENCE;
    let healthy = |station: &mut Station, flight: &mut tautline_sitl::flight::Flight<Vec<u8>>| {
        station.heard.clear();
        station.beat(flight);
        station.run(flight, 1100);
        let status = station.all::<mav::SYS_STATUS_DATA>();
        let last = status.last().unwrap();
        assert!(last.onboard_control_sensors_present.contains(bit));
        last.onboard_control_sensors_health.contains(bit)
    };
    assert!(healthy(&mut station, &mut inside));
    // The fence comes down on it.
    for (action, mode) in
        [(1.0, Mode::TetherHold), (2.0, Mode::TetherHold), (3.0, Mode::Land), (5.0, Mode::Descent)]
    {
        let mut flight = fenced(action);
        let lower = mav::PARAM_SET_DATA {
            param_value: 3.0,
            target_system: 1,
            target_component: 1,
            param_id: "GF_MAX_VER_DIST".into(),
            param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        station.say(&mut flight, &lower);
        until(&mut flight, 1.0, |out| out.events.iter().any(|event| event.text.contains("ence")));
        let out = run(&mut flight, 0.1);
        assert_eq!(out.mode, mode, "{action}");
        assert_eq!(out.failures & Failure::FenceBreached.mask() != 0, action > 1.5);
    }
}
