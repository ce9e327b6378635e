use super::*;
use crate::plant::PlantModel;
use crate::scenario::Scenario;
use std::io::{Read, Write};
use std::net::{TcpListener, UdpSocket};
use std::thread::{JoinHandle, spawn};

fn plant() -> Plant {
    let scenario = Scenario::default();
    Plant::new(PlantModel::new(&scenario, 0.0), scenario.start().0, 0.0, 1)
}

/// What ends a flight whose physics answers with these lines, one per packet.
fn end_of(lines: Vec<String>) -> (String, u64) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let address = Address::Json(socket.local_addr().unwrap().to_string());
    let server = spawn(move || {
        for line in lines {
            let (_, from) = socket.recv_from(&mut [0; 64]).unwrap();
            socket.send_to(line.as_bytes(), from).unwrap();
        }
    });
    let mut plant = plant();
    let mut physics = Physics::connect(&address, 1, &plant).unwrap();
    let command = Command { throttle: [0.0; MAX_ROTORS], winch: 0.0 };
    let mut steps = 0;
    while physics.failure().is_none() {
        steps += 1;
        physics.step(steps * 1000, &command, &mut plant);
    }
    server.join().unwrap();
    (physics.failure().unwrap().to_owned(), steps)
}

fn at(time: f64) -> String {
    format!(
        r#"{{"timestamp":{time},"imu":{{"gyro":[0,0,0],"accel_body":[0,0,-9.8]}},"position":[0,0,-1],"attitude":[0,0,0],"velocity":[0,0,0]}}"#
    )
}

#[test]
fn steps_run_until_a_frame_is_reached_and_a_reset_is_an_error() {
    // At 400 Hz a frame holds for two or three milliseconds.
    let (why, steps) = end_of(vec![at(3.0), at(3.0025), at(3.005), at(1.0)]);
    assert!(why.contains("time went back from 3.005 s to 1.000 s"), "{why}");
    assert_eq!(steps, 7);
    let (why, _) = end_of(vec![at(3.0), at(13.0)]);
    assert!(why.contains("time jumped by 10.000 s"), "{why}");
    let (why, _) = end_of(vec![at(3.0), "{".into()]);
    assert!(why.contains("bad JSON"), "{why}");
}

#[test]
fn a_simulator_that_hangs_up_ends_the_flight() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = Address::Px4(listener.local_addr().unwrap().to_string());
    let server: JoinHandle<()> = spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        // The greeting first: an unread one would reset the connection.
        let _ = stream.read(&mut [0; 512]).unwrap();
        stream.write_all(b"garbage").unwrap();
    });
    let mut plant = plant();
    let mut physics = Physics::connect(&address, 1, &plant).unwrap();
    let command = Command { throttle: [0.0; MAX_ROTORS], winch: 0.0 };
    physics.step(1000, &command, &mut plant);
    server.join().unwrap();
    assert!(physics.failure().unwrap().ends_with("closed the connection"));
}
