//! A flight's log as PX4's tools read it: their numbers, types, topics and fields; and as MCAP.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod log {
    mod mcap;
}

use std::collections::{BTreeMap, BTreeSet};
use tautline_firmware::log::{FlightLog, STEP_BYTES};
use tautline_firmware::param::{ALIASES, Kind, META, Params};
use tautline_firmware::time::Micros;
use tautline_sitl::flight::{Flight, topics_page};
use tautline_sitl::scenario::Scenario;
use tautline_sitl::ulog::{Log, Message, Value};
use tautline_tests::UP_AND_DOWN;

fn flown(scenario: &str, limit: f64) -> Vec<u8> {
    let scenario = Scenario::parse(scenario, "case").unwrap();
    let mut flight = Flight::new(&scenario, scenario.params().unwrap(), 1, Vec::new()).unwrap();
    flight.fly(limit);
    flight.finish_log().unwrap().unwrap()
}

/// PX4's topics of a flight, and fields by which its tools draw them.
const DRAWN: &[(&str, &[&str])] = &[
    ("actuator_motors", &["control[0]"]),
    ("actuator_outputs", &["noutputs", "output[0]"]),
    ("battery_status", &["voltage_v", "current_a", "discharged_mah", "remaining"]),
    ("distance_sensor", &["current_distance", "variance", "max_distance", "orientation"]),
    ("estimator_status", &["health_flags", "timeout_flags", "innovation_check_flags"]),
    ("failsafe_flags", &["gcs_connection_lost", "battery_warning", "fd_motor_failure"]),
    ("sensor_baro", &["pressure", "temperature"]),
    ("sensor_combined", &["accelerometer_m_s2[2]", "gyro_rad[2]"]),
    ("vehicle_air_data", &["baro_alt_meter", "baro_pressure_pa"]),
    ("vehicle_angular_acceleration", &["xyz[2]"]),
    ("vehicle_angular_velocity", &["xyz[2]"]),
    ("vehicle_angular_velocity_groundtruth", &["xyz[2]"]),
    ("vehicle_attitude", &["q[3]"]),
    ("vehicle_attitude_groundtruth", &["q[3]"]),
    ("vehicle_imu_status", &["accel_vibration_metric", "temperature_accel"]),
    ("vehicle_land_detected", &["landed", "maybe_landed", "ground_contact"]),
    ("vehicle_local_position", &["x", "vz", "v_xy_valid", "v_z_valid", "dist_bottom_valid"]),
    ("vehicle_local_position_groundtruth", &["x", "y", "z"]),
    ("vehicle_local_position_setpoint", &["x", "vz", "yaw"]),
    ("vehicle_rates_setpoint", &["roll", "pitch", "yaw", "thrust_body[2]"]),
    ("vehicle_status", &["failsafe", "failsafe_and_user_took_over", "is_vtol", "system_type"]),
    ("vehicle_thrust_setpoint", &["xyz[2]"]),
    ("vehicle_torque_setpoint", &["xyz[0]"]),
];

#[test]
fn a_flights_modes_topics_and_fields_are_px4s() {
    let bytes = flown(UP_AND_DOWN, 200.0);
    let (mut modes, mut missing) = (Vec::new(), BTreeSet::new());
    let mut range: BTreeMap<(&str, &str), (f64, f64)> = BTreeMap::new();
    let mut log = Log::new(&bytes).unwrap();
    for message in log.by_ref() {
        let Message::Data(data) = message else { continue };
        if let Some(mode) = data.number("nav_state").filter(|mode| modes.last() != Some(mode)) {
            modes.push(mode);
        }
        let Some((topic, fields)) = DRAWN.iter().find(|(topic, _)| *topic == data.topic) else {
            continue;
        };
        for field in *fields {
            match data.number(field) {
                Some(x) => {
                    let (least, most) = range.entry((topic, field)).or_insert((x, x));
                    (*least, *most) = (least.min(x), most.max(x));
                }
                None => drop(missing.insert(format!("{topic}.{field}"))),
            }
        }
    }
    assert!(log.notes().lines().is_empty(), "{:?}", log.notes());
    assert_eq!(modes, [4.0, 17.0, 4.0, 18.0, 4.0]);
    for (topic, fields) in DRAWN {
        let unseen = fields.iter().filter(|field| !range.contains_key(&(*topic, *field)));
        missing.extend(unseen.map(|field| format!("{topic}.{field}")));
    }
    assert_eq!(missing, BTreeSet::new());

    // Shares, metres and pulses are what they say.
    let within = |topic, field, (least, most): (f64, f64), reaches: f64| {
        let &(low, high) = range.get(&(topic, field)).unwrap();
        assert!(least <= low && high <= most, "{topic}.{field}: {low} to {high}");
        assert!(low.abs().max(high.abs()) >= reaches, "{topic}.{field}: {low} to {high}");
    };
    within("vehicle_thrust_setpoint", "xyz[2]", (-1.0, 0.0), 0.4);
    within("vehicle_torque_setpoint", "xyz[0]", (-1.0, 1.0), 0.005);
    within("actuator_outputs", "output[0]", (1000.0, 2000.0), 1300.0);
    within("distance_sensor", "current_distance", (0.0, 7.0), 4.5);
    within("vehicle_air_data", "baro_alt_meter", (-20.0, 1000.0), 0.0);
    within("vehicle_land_detected", "landed", (0.0, 1.0), 1.0);
    within("vehicle_imu_status", "accel_vibration_metric", (0.0, 9.8), 0.001);
}

#[test]
fn whole_parameters_are_whole_and_ground_stations_find_theirs() {
    let bytes = flown("[vehicle]\npreset = \"hexa-6\"", 0.1);
    let messages = Log::new(&bytes).unwrap();
    let params: BTreeMap<&str, Value> = messages
        .filter_map(|message| match message {
            Message::Parameter(name, value) => Some((name, value)),
            _ => None,
        })
        .collect();
    let kinds = META.iter().map(|meta| (meta.name, meta.kind));
    for (name, kind) in kinds.chain(ALIASES.iter().map(|alias| (alias.name, alias.kind))) {
        let is_whole = matches!(params.get(name), Some(Value::Int(_)));
        assert_eq!(is_whole, kind == Kind::Int, "{name}: {:?}", params.get(name));
    }
    assert_eq!(params.get("VEH_FRAME"), Some(&Value::Int(2)));
    assert_eq!(params.get("MAV_TYPE"), Some(&Value::Int(13)));
}

#[test]
fn a_joystick_and_a_magnetometer_are_logged_where_there_are_any() {
    let topics = |bytes: &[u8]| {
        let mut topics = BTreeSet::new();
        for message in Log::new(bytes).unwrap() {
            if let Message::Data(data) = message {
                topics.insert(data.topic.to_owned());
            }
        }
        topics
    };
    let bare = topics(&flown("", 2.0));
    assert!(!bare.contains("manual_control_setpoint") && !bare.contains("vehicle_magnetometer"));
    let with_sticks = topics(&flown(include_str!("../sitl/scenarios/excite.toml"), 60.0));
    assert!(with_sticks.contains("manual_control_setpoint"), "{with_sticks:?}");
    let with_compass =
        topics(&flown("[sensors]\nmagnetometer = true\n[params]\nEST_AIDS = 8.0", 2.0));
    assert!(with_compass.contains("vehicle_magnetometer"), "{with_compass:?}");
}

#[test]
fn the_page_of_topics_is_what_a_log_holds() {
    let (page, path) = (topics_page(), concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/topics.md"));
    let found = std::fs::read_to_string(path).unwrap();
    assert!(found == page, "docs/topics.md is stale: cargo xtask topics");
    for message in Log::new(&flown("", 2.0)).unwrap() {
        if let Message::Data(data) = message {
            assert!(page.contains(&format!("\n### `{}`\n", data.topic)), "{}", data.topic);
        }
    }
}

#[test]
fn a_logs_beginning_fits_the_smallest_boards_queue_beside_a_step() {
    const QUEUE: usize = 16_384;
    let mut header = 0;
    FlightLog::start(Micros(0), &Params::default(), |_, _| {}, &mut |bytes| header += bytes.len());
    assert!(header + 2 * STEP_BYTES < QUEUE, "{header} and {STEP_BYTES}");
}

/// A disk with room for so many bytes.
struct Disk(usize);

impl std::io::Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if bytes.len() > self.0 {
            return Err(std::io::ErrorKind::StorageFull.into());
        }
        self.0 -= bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_told_once_and_when_it_fills_and_the_flight_goes_on() {
    let scenario = Scenario::default();
    let params = scenario.params().unwrap();
    let mut flight = Flight::new(&scenario, params, 1, Disk(100_000)).unwrap();
    let mut told = Vec::new();
    for _ in 0..10_000 {
        flight.step(&mut |_| {});
        told.extend(flight.log_trouble().map(|why| (flight.world.time(), why)));
    }
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0 < 9.0, "{told:?}");
    assert!(flight.finish_log().is_err());
}
