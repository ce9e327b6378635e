//! Each peer has its own rates, lists and answers.

use super::station::Station;
use mavlink::MessageData;
use mavlink::dialects::common as mav;
use tautline_firmware::param::{ALIASES, META};
use tautline_sitl::flight::Flight;
use tautline_tests::{flight, run};

/// All of them speak, and listen for a while.
fn listen(flight: &mut Flight<Vec<u8>>, stations: &mut [Station], ms: u32) {
    for station in stations.iter_mut() {
        station.beat(flight);
        station.listen(flight);
        station.heard.clear();
    }
    for _ in 0..ms {
        flight.step(&mut |_| {});
        stations.iter_mut().for_each(|station| station.listen(flight));
    }
}

fn count<D: MessageData>(station: &Station) -> usize {
    station.heard.iter().filter(|(id, _)| *id == D::ID).count()
}

#[test]
fn eleven_stations_each_get_the_rate_that_they_asked_for() {
    let mut flight = flight("", 1);
    let mut stations: Vec<_> = (0..11).map(|i| Station::new(240 + i, 100 + u16::from(i))).collect();
    listen(&mut flight, &mut stations, 100);
    for (station, hz) in
        stations.iter_mut().zip([1.0_f32, 2.0, 4.0, 5.0, 8.0, 10.0, 20.0, 25.0, 40.0, 50.0, 100.0])
    {
        let p = [30.0, 1e6 / hz, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(station.command(&mut flight, 511, p), Some(0));
    }
    listen(&mut flight, &mut stations, 2000);
    for (station, hz) in stations.iter().zip([1, 2, 4, 5, 8, 10, 20, 25, 40, 50, 100]) {
        let got = count::<mav::ATTITUDE_DATA>(station);
        assert!(got.abs_diff(2 * hz) <= 1, "{got} of {hz} Hz");
    }
}

#[test]
fn a_list_goes_to_who_asked_and_a_change_to_all() {
    let mut flight = flight("", 1);
    let mut stations = [Station::new(255, 1), Station::new(254, 2)];
    listen(&mut flight, &mut stations, 10);
    let ask = mav::PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 };
    stations[0].say(&mut flight, &ask);
    listen(&mut flight, &mut stations, 8 * (META.len() + ALIASES.len()) as u32 + 1500);
    assert_eq!(count::<mav::PARAM_VALUE_DATA>(&stations[0]), META.len() + ALIASES.len());
    assert_eq!(count::<mav::PARAM_VALUE_DATA>(&stations[1]), 0);
    let set = mav::PARAM_SET_DATA {
        param_value: 1.3,
        target_system: 1,
        target_component: 1,
        param_id: "TPC_P".into(),
        param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
    };
    stations[0].say(&mut flight, &set);
    listen(&mut flight, &mut stations, 50);
    assert_eq!(stations.each_ref().map(count::<mav::PARAM_VALUE_DATA>), [1, 1]);
}

#[test]
fn nothing_asked_in_a_burst_is_lost() {
    let mut flight = flight("", 1);
    let mut station = Station::new(255, 1);
    station.beat(&mut flight);
    run(&mut flight, 3.5);
    station.listen(&mut flight);
    station.heard.clear();
    for index in 0..60 {
        let read = mav::PARAM_REQUEST_READ_DATA {
            param_index: index,
            target_system: 1,
            target_component: 1,
            param_id: "".into(),
        };
        station.say(&mut flight, &read);
        let version = station.command_frame((512, 1), [148.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        station.say_bytes(&mut flight, &version);
        let set = mav::PARAM_SET_DATA {
            param_value: 1.2 + 0.001 * f32::from(index),
            target_system: 1,
            target_component: 1,
            param_id: "TPC_P".into(),
            param_type: mav::MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        station.say(&mut flight, &set);
    }
    station.run(&mut flight, 600);
    assert_eq!(count::<mav::COMMAND_ACK_DATA>(&station), 60);
    assert_eq!(count::<mav::AUTOPILOT_VERSION_DATA>(&station), 60);
    assert_eq!(count::<mav::PARAM_VALUE_DATA>(&station), 120);
    assert!((flight.world.vehicle.params().position_p - 1.259).abs() < 1e-6);
}

#[test]
fn a_line_of_57600_baud_carries_what_is_sent_by_itself_and_a_whole_list() {
    let mut flight = flight("", 1);
    let mut stations = [Station::new(255, 1)];
    listen(&mut flight, &mut stations, 4000);
    stations[0].bytes = 0;
    listen(&mut flight, &mut stations, 2000);
    let rate = stations[0].bytes / 2;
    assert!(rate < 5_000, "{rate} B/s");
    let ask = mav::PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 };
    stations[0].say(&mut flight, &ask);
    stations[0].bytes = 0;
    let mut got = 0;
    for _ in 0..6 {
        listen(&mut flight, &mut stations, 1000);
        assert!(count::<mav::HEARTBEAT_DATA>(&stations[0]) >= 1);
        got += count::<mav::PARAM_VALUE_DATA>(&stations[0]);
    }
    assert_eq!(got, META.len() + ALIASES.len());
    assert!(stations[0].bytes < 6 * 5_760, "{} B in 6 s", stations[0].bytes);
}

#[test]
fn who_is_only_called_hears_heartbeats_and_no_more() {
    let mut flight = flight("", 1);
    let mut silent = Station::new(255, 14_550);
    flight.world.links.call(0, silent.address);
    silent.run(&mut flight, 3000);
    assert!((3..=4).contains(&count::<mav::HEARTBEAT_DATA>(&silent)));
    assert!(silent.heard.iter().all(|(id, _)| *id == 0));
}
