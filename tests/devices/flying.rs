//! What every vehicle carries: inertial sensor, barometer, rangefinder, motors, battery.

use tautline_hal_shim::barometer::dps310::{self, ADDRESS, Dps310};
use tautline_hal_shim::battery::BatteryMonitor;
use tautline_hal_shim::fake::{FakeClock, FakeDps310, FakeEsc, FakeIcm42688, FakePin, FakeTfMini};
use tautline_hal_shim::imu::icm42688::{self, AccelRange, Config, GyroRange, INVALID, Icm42688};
use tautline_hal_shim::motors::{MotorOutputs, Protocol};
use tautline_hal_shim::rangefinder::tfmini::TfMini;

fn imu(clock: &FakeClock, config: Config) -> Icm42688<FakeIcm42688> {
    Icm42688::new(FakeIcm42688::new(clock.clone()), config)
}

#[test]
fn the_inertial_sensor_reads_what_it_feels_in_every_range() {
    for (gyro, accel) in [
        (GyroRange::Dps2000, AccelRange::G16),
        (GyroRange::Dps1000, AccelRange::G8),
        (GyroRange::Dps500, AccelRange::G4),
        (GyroRange::Dps250, AccelRange::G2),
    ] {
        let clock = FakeClock::default();
        let mut driver = imu(&clock, Config { gyro, accel, ..Config::default() });
        driver.init(&mut clock.clone()).unwrap();
        let (a, w) = ([1.5, -2.5, -9.81], [0.5, -0.25, 3.0]);
        driver.bus_mut().set_motion(a, w, 40.0);
        let got = driver.read_all().unwrap();
        for i in 0..3 {
            assert!(
                (f64::from(got.accel[i]) * f64::from(driver.accel_scale()) - a[i]).abs() < 0.003
            );
            assert!((f64::from(got.gyro[i]) * f64::from(driver.gyro_scale()) - w[i]).abs() < 0.002);
        }
        assert!((got.temperature - 40.0).abs() < 0.01);
        // Beyond the range it saturates and does not wrap.
        driver.bus_mut().set_motion([1e4, -1e4, 0.0], [1e3, 0.0, 0.0], 25.0);
        let got = driver.read_all().unwrap();
        assert_eq!((got.accel[0], got.accel[1], got.gyro[0]), (32_767, -32_767, 32_767));
    }
}

#[test]
fn the_inertial_sensor_says_nothing_before_it_has_started() {
    let clock = FakeClock::default();
    let mut driver = imu(&clock, Config::default());
    driver.bus_mut().set_motion([0.0, 0.0, -9.8], [0.0; 3], 25.0);
    assert_eq!(driver.read_all().unwrap().accel, [INVALID; 3]);
}

#[test]
fn an_absent_inertial_sensor_is_told_from_a_wrong_one() {
    let clock = FakeClock::default();
    let mut driver = imu(&clock, Config::default());
    driver.bus_mut().is_dead = true;
    let error = driver.init(&mut clock.clone()).unwrap_err();
    assert_eq!(error, icm42688::Error::Identity { found: 0xFF });
}

#[test]
fn the_gyro_does_not_freeze_near_100_degrees_per_second() {
    let clock = FakeClock::default();
    let mut driver = imu(&clock, Config::default());
    driver.init(&mut clock.clone()).unwrap();
    let mut last = 0;
    for i in 0..100_u32 {
        clock.advance_to(clock.now_us() + 1_000);
        // A slow sweep through the trap.
        driver.bus_mut().set_motion([0.0; 3], [1.60 + f64::from(i) * 0.003, 0.0, 0.0], 25.0);
        let now = driver.read_all().unwrap().gyro[0];
        assert_ne!(now, last, "frozen at step {i}");
        last = now;
    }
    // The fake has the trap: with the adaptive full scale left on, the same sweep freezes.
    let mut bare = FakeIcm42688::new(clock.clone());
    use embedded_hal::spi::SpiDevice;
    bare.write(&[0x4E, 0x0F]).unwrap();
    clock.advance_to(clock.now_us() + 50_000);
    let read = |part: &mut FakeIcm42688| {
        let mut bytes = [0x25 | 0x80, 0, 0];
        part.transfer_in_place(&mut bytes).unwrap();
        i16::from_be_bytes([bytes[1], bytes[2]])
    };
    let mut frozen = 0;
    last = 0;
    for i in 0..100_u32 {
        clock.advance_to(clock.now_us() + 1_000);
        bare.set_motion([0.0; 3], [1.60 + f64::from(i) * 0.003, 0.0, 0.0], 25.0);
        let now = read(&mut bare);
        frozen += u32::from(now == last);
        last = now;
    }
    assert!(frozen >= 2, "the fake lost its trap");
}

#[test]
fn the_barometer_starts_in_spite_of_its_traps_and_measures_a_metre() {
    let clock = FakeClock::default();
    let mut driver = Dps310::new(FakeDps310::new(clock.clone()), ADDRESS);
    driver.init(&mut clock.clone()).unwrap();
    assert_eq!(driver.poll().unwrap(), None, "nothing converted yet");
    for (pressure, temperature) in
        [(101_325.0, 25.0), (101_313.0, 25.0), (95_000.0, -5.0), (30_500.0, 60.0)]
    {
        clock.advance_to(clock.now_us() + 40_000);
        driver.bus_mut().set_air(pressure, temperature);
        let got = driver.poll().unwrap().unwrap();
        assert!((f64::from(got.pressure) - pressure).abs() < 0.5, "{got:?}");
        assert!((f64::from(got.temperature) - temperature).abs() < 0.05, "{got:?}");
        assert_eq!(driver.poll().unwrap(), None, "the same conversion twice");
    }
    driver.bus_mut().is_dead = true;
    assert!(matches!(driver.poll(), Err(dps310::Error::Bus(_))));
}

#[test]
fn the_rangefinder_survives_lost_bytes_and_headers_in_the_payload() {
    let clock = FakeClock::default();
    let mut driver = TfMini::new(FakeTfMini::new(clock.clone()));
    driver.bus_mut().lose_byte_every = 7;
    let mut good = 0;
    for i in 0..700_u64 {
        clock.advance_to((i + 2) * 10_000);
        // 89 cm is 0x59, and 22 873 raw would be two of them.
        let metres = if i % 2 == 0 { 0.89 } else { 3.0 };
        driver.bus_mut().set_distance(metres);
        if let Some(reading) = driver.poll().unwrap() {
            let cm = reading.distance_cm.unwrap();
            assert!(cm == 89 || cm == 300, "{cm}");
            good += 1;
        }
    }
    assert!(good > 480, "only {good} of 600 whole frames");
    assert!(driver.bad_frames > 0);
}

#[test]
fn the_rangefinder_knows_its_invalid_codes_and_the_manuals_example() {
    let clock = FakeClock::default();
    let mut driver = TfMini::new(FakeTfMini::new(clock));
    driver.bus_mut().inject(&[0x59, 0x59, 0x2C, 0x01, 0xE8, 0x03, 0x00, 0x09, 0xD3]);
    let reading = driver.poll().unwrap().unwrap();
    assert_eq!((reading.distance_cm, reading.strength), (Some(300), 1000));
    for raw in [0xFFFF_u16, 0xFFFE, 0xFFFC, 0] {
        let [low, high] = raw.to_le_bytes();
        let mut frame = vec![0x59, 0x59, low, high, 0xE8, 0x03, 0, 9];
        frame.push(frame.iter().fold(0_u8, |s, &b| s.wrapping_add(b)));
        driver.bus_mut().inject(&frame);
        assert_eq!(driver.poll().unwrap().unwrap().distance_cm, None, "{raw:#x}");
    }
}

#[test]
fn throttle_reaches_the_motor_by_either_protocol_once_the_esc_is_armed() {
    for protocol in [Protocol::Pwm400, Protocol::OneShot125] {
        let clock = FakeClock::default();
        let escs: [_; 4] = std::array::from_fn(|_| FakeEsc::new(clock.clone(), protocol));
        let mut motors = MotorOutputs::try_new(escs, protocol).unwrap();
        motors.write(&[0.5; 4]).unwrap();
        assert!(motors.channels_mut().iter().all(|esc| esc.throttle() == 0.0), "not armed yet");
        for ms in 0..1_200 {
            clock.advance_to(ms * 1_000);
            motors.stop().unwrap();
        }
        motors.write(&[0.0, 0.25, 0.5, 1.0]).unwrap();
        for (esc, want) in motors.channels_mut().iter().zip([0.0, 0.25, 0.5, 1.0]) {
            assert!((esc.throttle() - want).abs() < 1e-3, "{protocol:?} {want}");
        }
        motors.write(&[f32::NAN, -1.0, 2.0, f32::INFINITY]).unwrap();
        let got: Vec<_> = motors.channels_mut().iter().map(FakeEsc::throttle).collect();
        assert!(got[0] == 0.0 && got[1] == 0.0 && got[2] > 0.999 && got[3] > 0.999);
        clock.advance_to(clock.now_us() + 3_000_000);
        assert_eq!(motors.channels_mut()[2].throttle(), 0.0, "the signal was lost");
    }
}

#[test]
fn the_battery_pins_read_to_a_count() {
    let mut monitor = BatteryMonitor::new(FakePin::default(), FakePin::default());
    let (voltage, current) = monitor.pins_mut();
    voltage.set_volts(1.4);
    current.set_volts(99.0);
    let reading = monitor.read().unwrap();
    assert!(reading.voltage_mv.abs_diff(1_400) <= 1);
    assert_eq!(reading.current_mv, 3_300);
}
