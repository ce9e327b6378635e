//! What the ground, the pilot's screen and the log learn of the radio.

use super::pilot::{breaks, in_position, run_and_hear};
use mavlink::dialects::common::{MavSysStatusSensor, RC_CHANNELS_DATA, SYS_STATUS_DATA};
use tautline_sitl::scenario::FaultKind;
use tautline_sitl::ulog::{Log, Message};
use tautline_tests::run;
use uf_crsf::{CrsfParser, Packet};

#[test]
fn the_ground_sees_every_channel_how_well_it_is_heard_and_that_it_is_lost() {
    let mut flight = in_position("crsf", "");
    let receiver = MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_RC_RECEIVER;
    let (channels, status) = run_and_hear::<RC_CHANNELS_DATA, SYS_STATUS_DATA>(&mut flight, 2.0);
    let last = channels.last().unwrap();
    assert_eq!((last.chancount, last.rssi), (16, 100));
    assert_eq!([last.chan1_raw, last.chan3_raw, last.chan6_raw], [1500, 1500, 2000]);
    assert_eq!([last.chan16_raw, last.chan17_raw], [1500, u16::MAX]);
    let status = status.last().unwrap();
    assert!(status.onboard_control_sensors_present.contains(receiver));
    assert!(status.onboard_control_sensors_health.contains(receiver));
    breaks(&mut flight, FaultKind::RadioLost, 0.0, 100.0);
    run(&mut flight, 2.0);
    let (channels, status) = run_and_hear::<RC_CHANNELS_DATA, SYS_STATUS_DATA>(&mut flight, 2.0);
    assert!(channels.is_empty(), "what is old is not shown as new");
    let status = status.last().unwrap();
    assert!(status.onboard_control_sensors_present.contains(receiver));
    assert!(!status.onboard_control_sensors_health.contains(receiver));
}

#[test]
fn the_pilots_screen_shows_battery_attitude_and_mode() {
    let mut flight = in_position("crsf", "");
    run(&mut flight, 3.0);
    let height = flight.output().sensors.battery.unwrap().voltage;
    let pilot = flight.world.environment.sensors.pilot.as_mut().unwrap();
    let heard = pilot.part().heard.clone();
    let (mut modes, mut volts, mut attitudes) = (Vec::new(), Vec::new(), 0);
    let mut bytes = heard.as_slice();
    let mut parser = CrsfParser::new();
    while let Some(packet) = parser.next_packet(&mut bytes) {
        match packet.unwrap() {
            Packet::FlightMode(mode) => modes.push(mode.flight_mode().to_owned()),
            Packet::Battery(battery) => volts.push(f32::from(battery.voltage) / 10.0),
            Packet::Attitude(_) => attitudes += 1,
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(modes.first().unwrap(), "Tether Hold*", "disarmed");
    assert_eq!(modes.last().unwrap(), "Position");
    assert!((volts.last().unwrap() - height).abs() < 0.2, "{volts:?}");
    assert!(attitudes > 2 * modes.len() - 3);
}

#[test]
fn sbus_has_no_way_back() {
    let mut flight = in_position("sbus", "");
    let pilot = flight.world.environment.sensors.pilot.as_mut().unwrap();
    assert!(pilot.part().heard.is_empty());
}

#[test]
fn the_log_has_px4s_topic_of_the_radio() {
    let mut flight = in_position("crsf", "");
    breaks(&mut flight, FaultKind::RadioFailsafe, 0.0, 100.0);
    run(&mut flight, 1.0);
    let log = flight.finish_log().unwrap().unwrap();
    let mut seen = Vec::new();
    for message in Log::new(&log).unwrap() {
        if let Message::Data(data) = message
            && data.topic == "input_rc"
        {
            let number = |field| data.number(field).unwrap();
            seen.push([
                number("values[0]"),
                number("link_quality"),
                number("rc_lost"),
                number("input_source"),
                number("rssi_dbm"),
            ]);
        }
    }
    assert!(seen.contains(&[1500.0, 100.0, 0.0, 14.0, -60.0]), "{:?}", seen.first());
    assert_eq!(seen.last().unwrap()[1..3], [0.0, 1.0]);
}
