//! Set-points streamed by a companion: places with velocities, or velocities alone.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use tautline_firmware::supervisor::{GroundState, Mode};
use tautline_sitl::flight::Flight;
use tautline_sitl::plant::V3;
use tautline_tests::{HOLD, ask, flight, run, stream, until};

fn holding(kind: &str) -> Flight<Vec<u8>> {
    let text = format!("[tether]\nkind = \"{kind}\"\n{HOLD}");
    let mut flight = flight(&text, 3);
    until(&mut flight, 90.0, |out| {
        out.mode == Mode::TetherHold && out.ground == GroundState::InAir
    });
    run(&mut flight, 5.0);
    flight
}

/// In Offboard, standing still.
fn offboard(kind: &str) -> Flight<Vec<u8>> {
    let mut flight = holding(kind);
    stream(&mut flight, None, [0.0; 3]);
    ask(&mut flight, Mode::Offboard);
    until(&mut flight, 0.1, |out| out.mode == Mode::Offboard);
    flight
}

fn send(flight: &mut Flight<Vec<u8>>, place: Option<V3>, velocity: V3) {
    stream(flight, place.map(Into::into), velocity.into());
}

fn truth(flight: &Flight<Vec<u8>>) -> V3 {
    flight.world.environment.plant.from_anchor()
}

fn reference(flight: &Flight<Vec<u8>>) -> V3 {
    flight.output().reference.unwrap().position.0.map(f64::from)
}

#[test]
fn a_streamed_circle_on_the_sphere_is_followed_and_ends_where_the_stream_does() {
    for kind in ["fixed", "winch"] {
        let mut flight = offboard(kind);
        let start = reference(&flight);
        let (length, level) = (start.norm(), start.x.hypot(start.y));
        let elevation = (-start.z).atan2(level);
        let at = |time: f64| {
            let (a, e) = (0.15 * (0.5 * time).sin(), elevation + 0.1 * (1.0 - (0.5 * time).cos()));
            V3::new(e.cos() * a.cos(), e.cos() * a.sin(), -e.sin()) * length
        };
        let mut worst = 0.0_f64;
        for step in 0..500 {
            let time = f64::from(step) * 0.05;
            let velocity = (at(time + 1e-4) - at(time - 1e-4)) / 2e-4;
            send(&mut flight, Some(at(time)), velocity);
            run(&mut flight, 0.05);
            worst = worst.max((truth(&flight) - at(time)).norm());
        }
        assert!(worst < 0.6, "{kind}: {worst}");
        // The companion falls silent: half a second on, and then it stays.
        run(&mut flight, 0.6);
        let end = reference(&flight);
        run(&mut flight, 5.0);
        assert!((reference(&flight) - end).norm() < 1e-3);
        assert!((truth(&flight) - end).norm() < 0.5, "{kind}");
    }
}

#[test]
fn a_velocity_alone_moves_it_as_long_as_it_is_sent() {
    let mut flight = offboard("fixed");
    let from = reference(&flight);
    for _ in 0..80 {
        send(&mut flight, None, V3::new(0.0, 0.5, 0.0));
        run(&mut flight, 0.05);
    }
    run(&mut flight, 5.0);
    // Four seconds and the last one's half.
    let way = reference(&flight) - from;
    assert!((way.y - 2.22).abs() < 0.1, "{way}");
    assert!((truth(&flight) - reference(&flight)).norm() < 0.6, "{}", truth(&flight));
}

#[test]
fn what_is_too_fast_or_leads_out_is_refused_and_what_is_far_is_flown_to_smoothly() {
    let mut flight = offboard("winch");
    let before = reference(&flight);
    send(&mut flight, None, V3::new(0.0, 9.0, 0.0));
    run(&mut flight, 0.2);
    assert_eq!(reference(&flight), before);
    let told = |flight: &Flight<Vec<u8>>, text: &str| {
        flight.events.iter().any(|(_, event)| event.text == text)
    };
    assert!(told(&flight, "Set-point refused: too fast"));
    let mut last = before;
    for _ in 0..100 {
        send(&mut flight, Some(before + V3::new(0.0, 3.0, 0.0)), V3::new(0.0, 0.1, 0.0));
        run(&mut flight, 0.05);
        let now = reference(&flight);
        assert!((now - last).norm() < 0.06, "no jump");
        last = now;
    }
    // Towards the ground, until the elevation's limit.
    for _ in 0..400 {
        send(&mut flight, None, V3::new(0.0, 0.0, 0.8));
        run(&mut flight, 0.05);
    }
    assert!(told(&flight, "Move refused: elevation out of range"));
    assert!(truth(&flight).z < -0.8, "{}", truth(&flight));
}
