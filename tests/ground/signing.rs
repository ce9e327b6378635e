//! Who does not hold the key may look, and no more.

use super::station::Station;
use mavlink::dialects::common as mav;
use sha2::{Digest, Sha256};
use tautline_firmware::mavlink::{Sender, Signing};
use tautline_sitl::flight::Flight;
use tautline_tests::{flight, run, signed};

const KEY: [u8; 32] = [7; 32];
const WRONG: [u8; 32] = [8; 32];
/// Tens of µs since 2015.
const NOW: u64 = 37_000_000_000_000;

fn guarded(signing: Signing) -> (Flight<Vec<u8>>, Station) {
    let mut flight = flight("", 1);
    flight.world.links.signing = Some(signing);
    let mut station = Station::new(255, 1);
    run(&mut flight, 3.5);
    // A ground station has spoken.
    let beat = station
        .frame(&mav::HEARTBEAT_DATA { mavtype: mav::MavType::MAV_TYPE_GCS, ..Default::default() });
    station.say_bytes(&mut flight, &signed(&beat, &KEY, NOW));
    station.run(&mut flight, 10);
    (flight, station)
}

const ARM: [f32; 7] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

fn ask(station: &mut Station, flight: &mut Flight<Vec<u8>>, frame: &[u8]) -> Option<u8> {
    station.heard.clear();
    station.say_bytes(flight, frame);
    station.run(flight, 50);
    station.acknowledged(400)
}

#[test]
fn unsigned_wrongly_signed_and_replayed_commands_are_refused() {
    let (mut flight, mut station) = guarded(Signing::new(KEY, NOW));
    let arm = station.command_frame((400, 1), ARM);
    assert_eq!(ask(&mut station, &mut flight, &arm), Some(2), "unsigned");
    let wrong = signed(&arm, &WRONG, NOW + 1);
    assert_eq!(ask(&mut station, &mut flight, &wrong), Some(2), "wrongly signed");
    assert!(!flight.output().is_armed);
    let mut forged = signed(&arm, &KEY, NOW + 1);
    forged[13] ^= 1;
    assert_eq!(ask(&mut station, &mut flight, &forged), None, "not even a frame");
    let good = signed(&arm, &KEY, NOW + 2);
    assert_eq!(ask(&mut station, &mut flight, &good), Some(0));
    assert!(flight.output().is_armed);
    let disarm = station.command_frame((400, 1), [0.0; 7]);
    assert_eq!(ask(&mut station, &mut flight, &signed(&disarm, &KEY, NOW + 3)), Some(0));
    assert_eq!(ask(&mut station, &mut flight, &good), Some(2), "a recording");
    // From elsewhere it is no newer.
    let mut other = Station::new(255, 2);
    assert_eq!(
        ask(&mut other, &mut flight, &good),
        Some(2),
        "a recording, replayed from elsewhere"
    );
    assert!(!flight.output().is_armed);
}

#[test]
fn who_does_not_hold_the_key_may_look_and_not_touch_the_simulator_either() {
    let (mut flight, mut station) = guarded(Signing::new(KEY, NOW));
    let version = [148.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(station.command(&mut flight, 512, version), Some(0));
    let read = mav::PARAM_REQUEST_READ_DATA {
        param_index: 0,
        target_system: 1,
        target_component: 1,
        param_id: "".into(),
    };
    station.heard.clear();
    station.say(&mut flight, &read);
    station.run(&mut flight, 20);
    assert_eq!(station.all::<mav::PARAM_VALUE_DATA>().len(), 1);
    station.command(&mut flight, 420, [7.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(flight.world.environment.active_faults().is_empty());
    let lock = [0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(station.command_to(&mut flight, (42600, 169), lock), None);
}

#[test]
fn a_recording_stays_one_over_a_restart() {
    let mut signing = Signing::new(KEY, NOW);
    signing.remember(Sender { id: [255, 190, 3], timestamp: NOW + 5 });
    let (mut flight, mut station) = guarded(signing);
    let arm = station.command_frame((400, 1), ARM);
    assert_eq!(ask(&mut station, &mut flight, &signed(&arm, &KEY, NOW + 5)), Some(2));
    assert_eq!(
        ask(&mut station, &mut flight, &signed(&arm, &KEY, NOW + 6)),
        Some(1),
        "no link yet"
    );
    assert!(station.texts().iter().any(|t| t.contains("no ground station")));
}

#[test]
fn what_the_vehicle_says_is_signed_and_its_time_grows() {
    let (mut flight, station) = guarded(Signing::new(KEY, NOW));
    let mut last = 0;
    for _ in 0..200 {
        flight.step(&mut |_| {});
        let peers = flight.world.links.iter_mut().filter(|p| p.address == station.address);
        for frame in peers.flat_map(|peer| peer.take_outbox()) {
            // The winch is another component, with no key of its own.
            if frame[6] != 1 {
                continue;
            }
            let (covered, mac) = frame.split_at(frame.len() - 6);
            let hash = Sha256::new().chain_update(KEY).chain_update(covered).finalize();
            assert_eq!(mac, &hash[..6]);
            let mut time = [0; 8];
            time[..6].copy_from_slice(&covered[covered.len() - 6..]);
            let time = u64::from_le_bytes(time);
            assert!(time > last);
            last = time;
        }
    }
    assert!(last > NOW);
}

#[test]
fn over_a_network_nobody_sets_a_key_and_who_tries_is_told() {
    let set = mav::SETUP_SIGNING_DATA {
        initial_timestamp: NOW,
        target_system: 1,
        target_component: 1,
        secret_key: WRONG,
    };
    let mut flight = flight("", 1);
    let mut station = Station::new(255, 1);
    station.beat(&mut flight);
    station.say(&mut flight, &set);
    station.run(&mut flight, 50);
    assert_eq!(station.texts(), ["Signing key refused: by the USB cable only"]);
    assert!(flight.world.links.signing.is_none());

    let (mut flight, mut station) = guarded(Signing::new(KEY, NOW));
    let frame = station.frame(&set);
    station.say_bytes(&mut flight, &signed(&frame, &KEY, NOW + 1));
    station.run(&mut flight, 50);
    assert!(station.texts().contains(&"Signing key refused: by the USB cable only".to_owned()));
    let arm = station.command_frame((400, 1), ARM);
    assert_eq!(ask(&mut station, &mut flight, &signed(&arm, &WRONG, NOW + 2)), Some(2));
    assert_eq!(ask(&mut station, &mut flight, &signed(&arm, &KEY, NOW + 3)), Some(0));
}

#[test]
fn who_is_not_believed_is_told_why_where_they_are() {
    let (mut flight, mut station) = guarded(Signing::new(KEY, NOW));
    let mut other = Station::new(200, 2);
    let set = mav::PARAM_SET_DATA {
        param_value: 2.0,
        target_system: 1,
        target_component: 1,
        param_id: "VEH_MASS".into(),
        param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
    };
    for _ in 0..3 {
        other.say(&mut flight, &set);
        for _ in 0..3000 {
            station.run(&mut flight, 1);
            other.listen(&mut flight);
        }
    }
    let count = |station: &Station| {
        station.texts().iter().filter(|t| t.contains("not signed with this vehicle's key")).count()
    };
    assert_eq!((count(&other), count(&station)), (1, 0));
    assert_eq!(flight.world.vehicle.params().mass.to_bits(), 1.5_f32.to_bits());
}
