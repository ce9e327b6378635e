//! Invariants over random inputs, and where the plant and the firmware's model must meet.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use tautline_firmware::control::{PositionInput, PositionLoop, PositionState, RadialControl};
use tautline_firmware::estimate::{Ekf4, Ekf4Measurement, Ekf4State, Fault, Mahony, MahonyState};
use tautline_firmware::frames::{Attitude, Body, V3, World};
use tautline_firmware::math::so3;
use tautline_firmware::model::Line;
use tautline_firmware::param::Params;
use tautline_firmware::signal::SphericalPoint;
use tautline_sitl::plant::{Generator, Plant, PlantModel, generator, uniform};
use tautline_sitl::scenario::{Scenario, TetherKind};

fn random_vector(rng: &mut Generator, size: f64) -> V3<f64> {
    V3::new(uniform(rng), uniform(rng), uniform(rng)) * size
}

fn ekf() -> Ekf4<f64> {
    let p = Params::default();
    let f = f64::from;
    Ekf4 {
        mass: f(p.mass),
        line: Line::new(&p),
        q_position: f(p.ekf_q_position),
        q_tension: f(p.ekf_q_tension),
        r_accel: f(p.ekf_r_accel),
        r_altitude: f(p.ekf_r_altitude),
        r_length: f(p.ekf_r_length),
    }
}

#[test]
fn spherical_and_world_coordinates_are_inverse() {
    let mut rng = generator(1, 0);
    for _ in 0..1000 {
        let p = World(random_vector(&mut rng, 20.0));
        let back = SphericalPoint::from_world(&p).to_world();
        assert!((back.0 - p.0).norm() < 1e-9);
    }
}

#[test]
fn quaternion_and_euler_angles_describe_the_same_rotation() {
    let mut rng = generator(2, 0);
    for _ in 0..2000 {
        let r = so3::exp(&random_vector(&mut rng, 3.1));
        let [w, x, y, z] = Attitude(r).quaternion();
        let q = nalgebra::Quaternion::new(w, x, y, z);
        let back = nalgebra::UnitQuaternion::new_normalize(q).to_rotation_matrix();
        assert!((back.matrix() - r).norm() < 1e-9 && (q.norm() - 1.0).abs() < 1e-9);
        let (roll, pitch, yaw) = Attitude(r).euler();
        assert!((Attitude::from_euler(roll, pitch, yaw).0 - r).norm() < 1e-9);
    }
}

#[test]
fn at_rest_on_a_taut_tether_the_accelerometer_shows_down_and_the_filter_its_pull() {
    // The plant, hanging still in its own balance of forces, against the firmware's measurement model.
    let mut scenario = Scenario::default();
    scenario.tether.kind = TetherKind::Fixed;
    scenario.tether.line_density = 0.0;
    scenario.tether.attachment = 0.0;
    scenario.tether.diameter = 0.0;
    let mut plant = Plant::new(PlantModel::new(&scenario, 0.0), 1.0, 0.0, 1);
    let mut rng = generator(3, 0);
    for _ in 0..50 {
        let length = scenario.tether.length;
        let elevation = 0.8 + 0.6 * uniform(&mut rng);
        let azimuth = 3.0 * uniform(&mut rng);
        let tension = 6.0 + 3.0 * uniform(&mut rng);
        let stretched = length + tension * length / scenario.tether.stiffness;
        let place = SphericalPoint { elevation, azimuth, length: stretched }.to_world().0;
        let u = place / stretched;
        let mass = scenario.vehicle.mass;
        // Balance: thrust = weight + pull; the thrust axis is wherever that needs it.
        let thrust = V3::new(0.0, 0.0, -mass * 9.81) + u * tension;
        let axis = -thrust / thrust.norm();
        let tilt = nalgebra::Rotation3::rotation_between(&V3::z(), &axis).unwrap();
        plant.body.position = place;
        plant.body.velocity = V3::zeros();
        plant.body.rate = V3::zeros();
        plant.body.attitude = nalgebra::UnitQuaternion::from_rotation_matrix(&tilt);
        let speed = (thrust.norm() / 4.0 / scenario.vehicle.thrust_coefficient).sqrt();
        for rotor in &mut plant.rotors {
            rotor.speed = speed;
        }
        let throttle = (speed / scenario.vehicle.rotor_speed_max
            * scenario.vehicle.nominal_voltage
            / plant.battery.voltage())
        .powf(1.0 / scenario.vehicle.throttle_curve);
        plant.step(&[throttle; 4], 0.0);
        let force = plant.specific_force;
        let down = tilt.inverse() * V3::z();
        assert!((force + down * 9.81).norm() < 0.4, "{force} is not up");
        assert!((plant.tether.tension() - tension).abs() < 0.3);

        let mut state = Ekf4State::at(place, tension);
        let z = Ekf4Measurement {
            attitude: Attitude(*tilt.matrix()),
            accel: Body(force),
            thrust: plant.thrust(),
            altitude: None,
            length: None,
        };
        let nu = ekf().step(&mut state, &z).unwrap();
        assert!(nu.accel.unwrap() < 0.1, "plant and filter disagree: {nu:?}");
    }
}

#[test]
fn a_position_filter_leaves_out_what_is_not_finite_and_an_attitude_filter_refuses_it() {
    let mut state = Ekf4State::at(V3::new(5.0, 1.0, -5.0), 5.0);
    let good = Ekf4Measurement {
        attitude: Attitude::level(0.0),
        accel: Body(V3::new(0.0, 0.0, -9.81)),
        thrust: 16.0,
        altitude: Some(5.0),
        length: Some(7.1),
    };
    let nan = f64::NAN;
    let everything = Ekf4Measurement {
        accel: Body(V3::repeat(nan)),
        altitude: Some(nan),
        length: Some(f64::INFINITY),
        ..good
    };
    let before = state;
    let nu = ekf().step(&mut state, &everything).unwrap();
    assert_eq!((nu.accel, nu.altitude, nu.length), (None, None, None));
    assert_eq!(state.x, before.x, "predicted only");
    assert!(state.covariance.m11 > before.covariance.m11);
    let some = Ekf4Measurement { altitude: Some(nan), ..good };
    let nu = ekf().step(&mut state, &some).unwrap();
    assert!(nu.accel.is_some() && nu.length.is_some() && nu.altitude.is_none());
    let lost = Ekf4State { x: state.x * nan, ..state };
    let mut state = lost;
    assert_eq!(ekf().step(&mut state, &good), Err(Fault::NotFinite));
    let mahony = Mahony { kp: 0.2, ki: 0.01 };
    let mut attitude = MahonyState::new(Attitude::level(0.3), Body(V3::zeros()));
    let before = attitude;
    for (gyro, accel) in [(nan, -9.8), (0.0, nan), (f64::INFINITY, -9.8)] {
        let result = mahony.step(
            &mut attitude,
            &Body(V3::new(gyro, 0.0, 0.0)),
            &Body(V3::new(0.0, 0.0, accel)),
            0.004,
        );
        assert_eq!(result, Err(Fault::NotFinite));
        assert_eq!(attitude, before);
    }
}

#[test]
fn the_covariance_stays_symmetric_and_positive_under_random_readings() {
    let mut rng = generator(4, 0);
    let mut state = Ekf4State::at(V3::new(8.0, 0.0, -5.0), 5.0);
    for i in 0..20_000 {
        let z = Ekf4Measurement {
            attitude: Attitude(so3::exp(&random_vector(&mut rng, 0.5))),
            accel: Body(V3::new(0.0, 0.0, -9.81) + random_vector(&mut rng, 3.0)),
            thrust: 17.0 + 3.0 * uniform(&mut rng),
            altitude: (i % 5 == 0).then(|| 5.0 + uniform(&mut rng)),
            length: (i % 2 == 0).then(|| 10.0 + uniform(&mut rng)),
        };
        ekf().step(&mut state, &z).unwrap();
        let p = state.covariance;
        assert!((p - p.transpose()).norm() < 1e-12);
        let least = p.symmetric_eigenvalues().min();
        assert!(least > 0.0, "step {i}: eigenvalue {least}");
    }
}

#[test]
fn the_force_never_exceeds_thrust_or_tilt() {
    let params = Params::default();
    let controller = PositionLoop::<f64>::new(&params);
    let mut rng = generator(5, 0);
    for i in 0..5_000_u32 {
        let direction = random_vector(&mut rng, 1.0).normalize();
        let input = PositionInput {
            position: World(random_vector(&mut rng, 15.0)),
            velocity: World(random_vector(&mut rng, 5.0)),
            wind: World(random_vector(&mut rng, 3.0)),
            direction: World(direction),
            reference_velocity: World(random_vector(&mut rng, 3.0)),
            length: 10.0,
            length_rate: uniform(&mut rng),
            tension: 10.0 * uniform(&mut rng),
            radial_control: if i % 2 == 0 {
                RadialControl::Winch
            } else {
                RadialControl::FixedLength
            },
            hold_integral: false,
        };
        let force = controller.step(&mut PositionState::default(), &input, 0.004).force.0;
        let up = -force.z;
        let side = force.x.hypot(force.y);
        assert!(force.norm() <= f64::from(params.thrust_max) + 1e-6);
        assert!(up >= f64::from(params.thrust_min) - 1e-9);
        assert!(side.atan2(up) <= f64::from(params.tilt_max) + 1e-6);
    }
}

#[test]
fn hover_gives_weight_and_an_error_gives_a_command_towards_the_reference() {
    let params = Params::default();
    let controller = PositionLoop::<f64>::new(&params);
    let at = |azimuth: f64| SphericalPoint { elevation: 0.8, azimuth, length: 10.0 }.to_world();
    let hold = PositionInput {
        position: at(0.0),
        velocity: World(V3::zeros()),
        wind: World(V3::zeros()),
        direction: World(at(0.0).0 / 10.0),
        reference_velocity: World(V3::zeros()),
        length: 10.0,
        length_rate: 0.0,
        tension: 5.0,
        radial_control: RadialControl::Winch,
        hold_integral: false,
    };
    let force = controller.step(&mut PositionState::default(), &hold, 0.004).force.0;
    let pull = at(0.0).0 / 10.0 * 5.0;
    let line = f64::from(params.line_density) * 10.0 * 9.81 / 2.0;
    let balance = V3::new(0.0, 0.0, -f64::from(params.mass) * 9.81 - line) + pull;
    assert!((force - balance).norm() < 1e-6);
    let east = PositionInput { direction: World(at(0.2).0 / 10.0), ..hold };
    let moved = controller.step(&mut PositionState::default(), &east, 0.004).force.0;
    assert!(moved.y > force.y + 1.0);
}

#[test]
fn on_a_fixed_length_a_tension_beyond_its_limits_counts_as_the_limit() {
    let p = Params { wind_feed_forward: 0.5, ..Params::default() };
    let controller = PositionLoop::<f64>::new(&p);
    let input = PositionInput {
        position: World(V3::new(5.0, 1.0, -5.0)),
        velocity: World(V3::new(0.1, -0.2, 0.1)),
        wind: World(V3::zeros()),
        direction: World(V3::new(0.7, 0.1, -0.7)),
        reference_velocity: World(V3::zeros()),
        length: 7.1,
        length_rate: 0.0,
        tension: 0.0,
        radial_control: RadialControl::FixedLength,
        hold_integral: true,
    };
    let force = |tension: f64, radial_control: RadialControl, outwards: f64| {
        let wind = World(V3::new(outwards, 0.0, -outwards));
        let input = PositionInput { tension, radial_control, wind, ..input };
        controller.step(&mut PositionState::default(), &input, 0.004).force.0
    };
    let (low, high) = (f64::from(p.tension_min), f64::from(p.tension_max));
    // A wind that is fed forward by half only leaves a pull within the limits: the guard does not speak.
    for (asked, counts, outwards) in [
        (low - 1.0, low, 2.0),
        (0.0, low, 2.0),
        (high + 1.0, high, -2.0),
        (1e3, high, -2.0),
        (low - 1.0, low, 0.0),
    ] {
        let fixed = |tension| force(tension, RadialControl::FixedLength, outwards);
        assert_eq!(fixed(asked), fixed(counts), "{asked} N, wind {outwards} m/s²");
    }
    let fixed = |tension| force(tension, RadialControl::FixedLength, 0.0);
    assert!((fixed(low) - fixed(low + 1.0)).norm() > 0.9);
    // On the winch the set-point is the winch's own affair.
    let winch = |tension| force(tension, RadialControl::Winch, 0.0);
    assert!((winch(low - 1.0) - winch(low)).norm() > 0.9);
}
