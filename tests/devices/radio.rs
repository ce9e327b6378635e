//! Receivers of a pilot's radio: their two protocols against the fake of both.

use embedded_io::Write;
use tautline_hal_shim::fake::{BusFault, FakeClock, FakeReceiver, Protocol};
use tautline_hal_shim::radio::crsf::{Crsf, FRAME_MAX, Telemetry, telemetry};
use tautline_hal_shim::radio::sbus::Sbus;
use tautline_hal_shim::radio::{CHANNELS, Reading};
use tautline_sitl::plant::{Generator, generator, uniform};
use uf_crsf::packets::{Attitude, Battery};
use uf_crsf::{CrsfParser, Packet};

const PROTOCOLS: [Protocol; 2] = [Protocol::Crsf, Protocol::Sbus];
/// Sticks in the middle, the throttle down, a switch up.
const PILOT: [f64; CHANNELS] = {
    let mut channels = [1500.0; CHANNELS];
    channels[2] = 988.0;
    channels[4] = 2012.0;
    channels
};
/// What the wire can carry, µs.
const RANGE: std::ops::RangeInclusive<u16> = 880..=2159;

enum Driver {
    Crsf(Crsf<FakeReceiver>),
    Sbus(Sbus<FakeReceiver>),
}

impl Driver {
    fn new(protocol: Protocol, part: FakeReceiver) -> Self {
        match protocol {
            Protocol::Crsf => Self::Crsf(Crsf::new(part)),
            Protocol::Sbus => Self::Sbus(Sbus::new(part)),
        }
    }
    fn part(&mut self) -> &mut FakeReceiver {
        match self {
            Self::Crsf(driver) => driver.bus_mut(),
            Self::Sbus(driver) => driver.bus_mut(),
        }
    }
    fn poll(&mut self) -> Result<Option<Reading>, BusFault> {
        match self {
            Self::Crsf(driver) => driver.poll(),
            Self::Sbus(driver) => driver.poll(),
        }
    }
    fn bad_bytes(&self) -> u32 {
        match self {
            Self::Crsf(driver) => driver.bad_bytes,
            Self::Sbus(driver) => driver.bad_bytes,
        }
    }
}

struct Bench {
    clock: FakeClock,
    driver: Driver,
}

impl Bench {
    /// A driver for one protocol at a part that speaks another, perhaps.
    fn of(driver: Protocol, part: Protocol) -> Self {
        let clock = FakeClock::default();
        let part = FakeReceiver::new(clock.clone(), part);
        Self { clock, driver: Driver::new(driver, part) }
    }

    fn new(protocol: Protocol) -> Self {
        Self::of(protocol, protocol)
    }

    /// Readings of so many milliseconds.
    fn run(&mut self, milliseconds: u64, pilot: &[f64; CHANNELS]) -> Vec<Reading> {
        (0..milliseconds)
            .filter_map(|_| {
                self.clock.advance_to(self.clock.now_us() + 1000);
                self.driver.part().set_pilot(pilot);
                self.driver.poll().unwrap()
            })
            .collect()
    }
}

fn random_bytes(rng: &mut Generator, count: usize) -> Vec<u8> {
    (0..count).map(|_| (128.0 * (1.0 + uniform(rng))) as u8).collect()
}

#[test]
fn every_channel_arrives_within_a_microsecond_at_the_protocols_pace() {
    for protocol in PROTOCOLS {
        let mut bench = Bench::new(protocol);
        let pilot: [f64; CHANNELS] = std::array::from_fn(|i| 990.0 + 68.0 * i as f64);
        let readings = bench.run(1000, &pilot);
        let expected = if protocol == Protocol::Crsf { 140..=150 } else { 68..=72 };
        assert!(expected.contains(&readings.len()), "{protocol:?}: {}", readings.len());
        for reading in &readings {
            for (got, sent) in reading.channels.iter().zip(pilot) {
                assert!((f64::from(*got) - sent).abs() <= 1.0, "{got} for {sent}");
            }
            assert!(!reading.is_failsafe);
        }
        assert_eq!(bench.driver.bad_bytes(), 0);
    }
}

#[test]
fn crsf_tells_how_well_the_pilot_is_heard_and_sbus_cannot() {
    let crsf = Bench::new(Protocol::Crsf).run(100, &PILOT).pop().unwrap();
    assert_eq!((crsf.link_quality, crsf.rssi_dbm), (Some(100), Some(-60)));
    let sbus = Bench::new(Protocol::Sbus).run(100, &PILOT).pop().unwrap();
    assert_eq!((sbus.link_quality, sbus.rssi_dbm), (None, None));
}

#[test]
fn a_receiver_that_lost_its_pilot_goes_on_with_stuck_channels_and_says_so() {
    for protocol in PROTOCOLS {
        let mut bench = Bench::new(protocol);
        bench.run(100, &PILOT);
        bench.driver.part().is_failsafe = true;
        let moved = [1700.0; CHANNELS];
        let stuck = bench.run(200, &moved).pop().unwrap();
        assert!((1499..=1501).contains(&stuck.channels[0]), "the last that was heard");
        assert!(stuck.is_failsafe || stuck.link_quality == Some(0), "{protocol:?}");
        bench.driver.part().is_failsafe = false;
        let again = bench.run(200, &moved).pop().unwrap();
        assert!(!again.is_failsafe && again.link_quality != Some(0));
        assert!((1699..=1701).contains(&again.channels[0]));
    }
}

#[test]
fn a_receiver_pulled_off_is_silence_and_one_plugged_in_again_is_read() {
    for protocol in PROTOCOLS {
        let mut bench = Bench::new(protocol);
        assert!(!bench.run(100, &PILOT).is_empty());
        bench.driver.part().is_removed = true;
        bench.run(1, &PILOT);
        assert!(bench.run(500, &PILOT).is_empty());
        bench.driver.part().is_removed = false;
        assert!(!bench.run(100, &PILOT).is_empty());
    }
}

#[test]
fn an_error_of_the_bus_is_told_and_the_next_frames_are_read() {
    for protocol in PROTOCOLS {
        let mut bench = Bench::new(protocol);
        bench.run(100, &PILOT);
        bench.driver.part().inject(&[0x55; 8]);
        bench.driver.part().faults = 1;
        assert_eq!(bench.driver.poll(), Err(BusFault));
        assert!(!bench.run(100, &PILOT).is_empty());
    }
}

#[test]
fn the_wrong_part_is_never_taken_for_the_right_one() {
    for (driver, part) in [(Protocol::Crsf, Protocol::Sbus), (Protocol::Sbus, Protocol::Crsf)] {
        let mut bench = Bench::of(driver, part);
        for step in 0..40 {
            let pilot = std::array::from_fn(|i| 988.0 + f64::from(step) * 25.0 + i as f64);
            assert!(bench.run(100, &pilot).is_empty(), "{driver:?} reads {part:?}");
        }
        assert!(bench.driver.bad_bytes() > 1000, "and it shows");
    }
}

#[test]
fn cut_frames_cost_themselves_and_one_neighbour_at_most() {
    for protocol in PROTOCOLS {
        let mut bench = Bench::new(protocol);
        bench.driver.part().cut_every = 5;
        let whole = Bench::new(protocol).run(5000, &PILOT).len();
        let readings = bench.run(5000, &PILOT);
        assert!(readings.len() * 5 >= whole * 3, "{protocol:?}: {} of {whole}", readings.len());
        assert!(readings.iter().all(|r| r.channels.iter().all(|us| RANGE.contains(us))));
    }
}

#[test]
fn a_noisy_line_loses_frames_of_crsf_and_never_bends_one() {
    let mut bench = Bench::new(Protocol::Crsf);
    bench.driver.part().bit_errors = 0.002;
    let readings = bench.run(20_000, &PILOT);
    assert!((800..2600).contains(&readings.len()), "{} of 3000", readings.len());
    let clean = Bench::new(Protocol::Crsf).run(20, &PILOT)[0].channels;
    // Eight bits of checksum let one broken frame in 256 pass.
    let bent = readings.iter().filter(|reading| reading.channels != clean).count();
    assert!(bent * 50 < readings.len(), "{bent} of {}", readings.len());
}

#[test]
fn no_stream_of_bytes_panics_or_leaves_the_range_and_a_frame_after_it_is_taken() {
    let mut rng = generator(17, 0);
    for protocol in PROTOCOLS {
        for round in 0..400 {
            let mut bench = Bench::new(protocol);
            let garbage = match round % 4 {
                // As much as headers can promise.
                0 => [0xC8, 0x3E, 0x16].repeat(1 + round / 4),
                1 => [0x0F].repeat(round),
                2 => random_bytes(&mut rng, 3 * round),
                _ => {
                    let mut bytes = random_bytes(&mut rng, round);
                    bytes.extend([0xC8, 24, 0x16]);
                    bytes
                }
            };
            bench.driver.part().inject(&garbage);
            while let Some(reading) = bench.driver.poll().unwrap() {
                assert!(reading.channels.iter().all(|us| RANGE.contains(us)));
            }
            // The line falls silent; what a header promised never comes. CRSF waits for a whole frame's bytes.
            bench.driver.poll().unwrap();
            let readings = bench.run(60, &PILOT);
            let last = readings.last().unwrap_or_else(|| panic!("{protocol:?} {garbage:02x?}"));
            assert!((1499..=1501).contains(&last.channels[0]), "{protocol:?} {garbage:02x?}");
            assert_eq!(last.channels[2], 988);
        }
    }
}

fn sent(kind: &Telemetry<'_>) -> Packet {
    let mut part = FakeReceiver::new(FakeClock::default(), Protocol::Crsf);
    let mut buffer = [0; FRAME_MAX];
    part.write_all(telemetry(kind, &mut buffer)).unwrap();
    let mut bytes = part.heard.as_slice();
    let packet = CrsfParser::new().next_packet(&mut bytes).unwrap().unwrap();
    assert!(bytes.is_empty(), "one frame and no more");
    packet
}

#[test]
fn battery_attitude_and_mode_reach_the_pilots_screen_in_the_protocols_units() {
    let battery =
        Telemetry::Battery { voltage: 15.27, current: 12.3, drawn: 840.0, remaining: 0.5 };
    let expected = Battery { voltage: 152, current: 123, capacity_used: 840, remaining: 50, id: 0 };
    assert_eq!(sent(&battery), Packet::Battery(expected));
    let attitude = Telemetry::Attitude([0.5, -0.25, 3.1]);
    assert_eq!(
        sent(&attitude),
        Packet::Attitude(Attitude { roll: 5000, pitch: -2500, yaw: 31000 })
    );
    let Packet::FlightMode(mode) = sent(&Telemetry::Mode("Tether Hold")) else { panic!() };
    assert_eq!(mode.flight_mode(), "Tether Hold");
    // More than a frame holds.
    let long = "x".repeat(200);
    let Packet::FlightMode(mode) = sent(&Telemetry::Mode(&long)) else { panic!() };
    assert_eq!(mode.flight_mode().len(), 59);
}

#[test]
fn telemetry_of_a_broken_estimate_is_still_a_frame() {
    for bad in [f32::NAN, f32::INFINITY, -1e30, 1e30] {
        let battery = Telemetry::Battery { voltage: bad, current: bad, drawn: bad, remaining: bad };
        assert!(matches!(sent(&battery), Packet::Battery(_)));
        assert!(matches!(sent(&Telemetry::Attitude([bad; 3])), Packet::Attitude(_)));
    }
}
