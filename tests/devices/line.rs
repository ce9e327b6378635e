//! What a line's own sensors are read by: encoders, load cell, magnetometer, and all of them at their pace.

use embedded_hal::i2c::ErrorKind;
use tautline_firmware::signal::RawLineSensors;
use tautline_firmware::time::Micros;
use tautline_hal_shim::encoder::as5600::{self, ADDRESS_L, As5600};
use tautline_hal_shim::fake::{FakeAs5600, FakeClock, FakeIst8310, FakeNau7802, Magnet};
use tautline_hal_shim::load_cell::nau7802::{self, Nau7802, SILENT_POLLS};
use tautline_hal_shim::magnetometer::ist8310::{self, Ist8310, LATE_POLLS};
use tautline_runtime::line::{LineDevices, LineParts, MAGNETOMETER_MS};

const ADDRESS: u8 = as5600::ADDRESS;

fn wait(clock: &FakeClock, us: u64) {
    clock.advance_to(clock.now_us() + us);
}

#[test]
fn an_encoder_reads_every_angle_of_a_turn_at_either_address() {
    for address in [ADDRESS, ADDRESS_L] {
        let mut driver = As5600::new(FakeAs5600::new(address), address);
        driver.init().unwrap();
        for counts in (0..4096_u16).step_by(7) {
            driver.bus_mut().set_angle(f64::from(counts) / 4096.0 * std::f64::consts::TAU);
            assert_eq!(driver.poll().unwrap(), Some(counts));
        }
        // Less than nothing and more than a turn come round.
        driver.bus_mut().set_angle(-std::f64::consts::FRAC_PI_2);
        assert_eq!(driver.poll().unwrap(), Some(3072));
        driver.bus_mut().set_angle(std::f64::consts::TAU);
        assert_eq!(driver.poll().unwrap(), Some(0));
    }
}

#[test]
fn an_encoder_whose_magnet_is_off_gives_no_angle_and_comes_back() {
    let mut driver = As5600::new(FakeAs5600::default(), ADDRESS);
    driver.init().unwrap();
    for magnet in [Magnet::Gone, Magnet::Weak, Magnet::Strong] {
        driver.bus_mut().magnet = magnet;
        assert_eq!(driver.poll().unwrap(), None, "{magnet:?}");
    }
    driver.bus_mut().magnet = Magnet::Good;
    assert_eq!(driver.poll().unwrap(), Some(0));
}

/// Holds one byte everywhere, whatever is written.
struct Constant(u8);

impl embedded_hal::i2c::ErrorType for Constant {
    type Error = ErrorKind;
}

impl embedded_hal::i2c::I2c for Constant {
    fn transaction(
        &mut self,
        _: u8,
        operations: &mut [embedded_hal::i2c::Operation<'_>],
    ) -> Result<(), ErrorKind> {
        for operation in operations {
            if let embedded_hal::i2c::Operation::Read(bytes) = operation {
                bytes.fill(self.0);
            }
        }
        Ok(())
    }
}

#[test]
fn another_part_at_the_address_is_told_from_the_right_one() {
    let clock = FakeClock::default();
    for byte in [0x00, 0xFF, 0x5A] {
        let encoder = As5600::new(Constant(byte), ADDRESS).init();
        assert_eq!(encoder, Err(as5600::Error::Identity { found: [byte; 3] }));
        let compass = Ist8310::new(Constant(byte)).init(&mut clock.clone());
        assert_eq!(compass, Err(ist8310::Error::Identity { found: byte }));
    }
    let cell = |byte| Nau7802::new(Constant(byte)).init(&mut clock.clone());
    // It says that its power is up, and is something else.
    assert_eq!(cell(0x58), Err(nau7802::Error::Identity { found: 0x58 }));
    // It never says so.
    assert_eq!(cell(0x00), Err(nau7802::Error::NotReady { found: 0 }));
}

#[test]
fn an_absent_part_is_a_bus_error_and_no_wait_without_end() {
    let clock = FakeClock::default();
    let mut encoder = As5600::new(FakeAs5600::default(), ADDRESS);
    encoder.bus_mut().is_dead = true;
    assert!(matches!(encoder.init(), Err(as5600::Error::Bus(_))));
    let mut cell = Nau7802::new(FakeNau7802::new(clock.clone()));
    cell.bus_mut().is_dead = true;
    assert!(matches!(cell.init(&mut clock.clone()), Err(nau7802::Error::Bus(_))));
    let mut compass = Ist8310::new(FakeIst8310::new(clock.clone()));
    compass.bus_mut().is_dead = true;
    assert!(matches!(compass.init(&mut clock.clone()), Err(ist8310::Error::Bus(_))));
    assert!(clock.now_us() < 50_000);
}

fn cell(clock: &FakeClock) -> Nau7802<FakeNau7802> {
    let mut driver = Nau7802::new(FakeNau7802::new(clock.clone()));
    driver.init(&mut clock.clone()).unwrap();
    driver
}

#[test]
fn a_load_cell_reads_both_signs_and_each_conversion_once() {
    let clock = FakeClock::default();
    let mut driver = cell(&clock);
    assert_eq!(driver.poll(), Ok(None), "nothing converted yet");
    for counts in [0, 1, -1, 250_000, -8_000_000, 8_388_606] {
        wait(&clock, 13_000);
        driver.bus_mut().set_counts(f64::from(counts));
        assert_eq!(driver.poll(), Ok(Some(counts)));
        assert_eq!(driver.poll(), Ok(None), "the same conversion twice");
    }
}

#[test]
fn a_load_cell_with_a_broken_wire_or_too_much_load_says_so() {
    let clock = FakeClock::default();
    let mut driver = cell(&clock);
    for counts in [9e6, -9e6, 1e12] {
        wait(&clock, 13_000);
        driver.bus_mut().set_counts(counts);
        assert_eq!(driver.poll(), Err(nau7802::Error::Saturated), "{counts}");
    }
    driver.bus_mut().is_open = true;
    wait(&clock, 13_000);
    driver.bus_mut().set_counts(5.0);
    assert_eq!(driver.poll(), Err(nau7802::Error::Saturated));
}

#[test]
fn a_load_cell_that_stops_converting_is_noticed_and_starts_again() {
    let clock = FakeClock::default();
    let mut driver = cell(&clock);
    driver.bus_mut().is_hung = true;
    let polls: Vec<_> = (0..2 * SILENT_POLLS).map(|_| driver.poll()).collect();
    let silent = polls.iter().filter(|&&got| got == Err(nau7802::Error::Silent)).count();
    assert_eq!((silent, polls[usize::from(SILENT_POLLS) - 1]), (2, Err(nau7802::Error::Silent)));
    driver.bus_mut().is_hung = false;
    driver.init(&mut clock.clone()).unwrap();
    wait(&clock, 13_000);
    driver.bus_mut().set_counts(77.0);
    assert_eq!(driver.poll(), Ok(Some(77)));
}

#[test]
fn a_load_cell_on_a_bad_supply_does_not_start() {
    let clock = FakeClock::default();
    let mut driver = Nau7802::new(FakeNau7802::new(clock.clone()));
    driver.bus_mut().is_starved = true;
    assert_eq!(driver.init(&mut clock.clone()), Err(nau7802::Error::Calibration));
}

#[test]
fn a_magnetometer_gives_a_right_handed_field_and_says_when_it_cannot() {
    let clock = FakeClock::default();
    let mut driver = Ist8310::new(FakeIst8310::new(clock.clone()));
    driver.init(&mut clock.clone()).unwrap();
    driver.bus_mut().set_field([21e-6, -3e-6, 42e-6]);
    assert_eq!(driver.poll(), Ok(None), "it takes 6 ms");
    wait(&clock, 10_000);
    assert_eq!(driver.poll(), Ok(Some([70, -10, 140])));
    assert_eq!(driver.poll(), Ok(None), "the same measurement twice");
    driver.bus_mut().set_field([2e-3, 0.0, 0.0]);
    wait(&clock, 10_000);
    assert_eq!(driver.poll(), Err(ist8310::Error::Saturated));
    // A measurement that does not come is asked for anew, and told.
    driver.bus_mut().is_hung = true;
    let polls: Vec<_> = (0..LATE_POLLS).map(|_| driver.poll()).collect();
    assert_eq!(polls.last(), Some(&Err(ist8310::Error::Late)));
    driver.bus_mut().is_hung = false;
    driver.bus_mut().set_field([30e-6, 0.0, 0.0]);
    wait(&clock, 10_000);
    assert_eq!(driver.poll(), Ok(Some([100, 0, 0])));
}

type Devices = LineDevices<FakeAs5600, FakeNau7802, FakeIst8310>;

fn devices(clock: &FakeClock) -> Devices {
    LineDevices::new(LineParts {
        angles: Some([FakeAs5600::new(ADDRESS), FakeAs5600::new(ADDRESS_L)]),
        cell: Some(FakeNau7802::new(clock.clone())),
        magnetometer: Some(FakeIst8310::new(clock.clone())),
    })
}

/// What comes in `ms` of polling, each field as last heard.
fn run(devices: &mut Devices, clock: &FakeClock, ms: u64) -> RawLineSensors {
    let mut all = RawLineSensors::default();
    for _ in 0..ms {
        clock.advance_to((clock.now_us() / 1000 + 1) * 1000);
        if let Some(cell) = devices.cell() {
            cell.set_counts(1234.0);
        }
        let mut now = RawLineSensors::default();
        devices.poll(Micros(clock.now_us()), &mut now);
        all.merge(now);
    }
    all
}

#[test]
fn all_of_a_lines_sensors_are_heard_within_a_few_of_their_periods() {
    let clock = FakeClock::default();
    let mut devices = devices(&clock);
    devices.set_up(&mut clock.clone());
    let heard = run(&mut devices, &clock, 3 * MAGNETOMETER_MS);
    assert_eq!(heard.angles.unwrap().counts, [Some(0); 2]);
    assert_eq!(heard.tension.unwrap().counts, 1234);
    assert!(heard.magnetometer.is_some());
    assert_eq!(heard.second_imu, None, "not on these buses");
}

#[test]
fn a_part_that_is_not_fitted_is_never_asked_and_breaks_no_other() {
    let clock = FakeClock::default();
    let mut none = Devices::new(LineParts { angles: None, cell: None, magnetometer: None });
    none.set_up(&mut clock.clone());
    assert_eq!(run(&mut none, &clock, 200), RawLineSensors::default());
    assert!(!none.wants_set_up());
    // One that is fitted and dead: the others are heard.
    let mut devices = devices(&clock);
    devices.cell().unwrap().is_dead = true;
    devices.set_up(&mut clock.clone());
    let heard = run(&mut devices, &clock, 200);
    assert!(heard.tension.is_none() && heard.angles.is_some() && heard.magnetometer.is_some());
}

#[test]
fn a_part_that_was_off_for_a_while_is_set_up_again() {
    let clock = FakeClock::default();
    let mut devices = devices(&clock);
    devices.set_up(&mut clock.clone());
    devices.cell().unwrap().is_dead = true;
    assert!(run(&mut devices, &clock, 300).tension.is_none());
    assert!(!devices.wants_set_up(), "not at once");
    run(&mut devices, &clock, 600);
    assert!(devices.wants_set_up());
    // A try that fails is not made again at once.
    devices.revive(&mut clock.clone());
    assert!(!devices.wants_set_up());
    devices.cell().unwrap().is_dead = false;
    run(&mut devices, &clock, 900);
    devices.revive(&mut clock.clone());
    assert!(run(&mut devices, &clock, 100).tension.is_some());
}
