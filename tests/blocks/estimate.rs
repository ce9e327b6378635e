//! Estimators. Inputs hover 45° up on a 7 m tether under 5 N, or upright.

use super::{Feed, Row, Rule, dense, filter, row, three};
use nalgebra::DMatrix;
use tautline_firmware::estimate::capture::{CaptureFilter, CaptureState};
use tautline_firmware::estimate::high_gain::{
    Branches, HighGain, HighGainInput, HighGainSettings, Update,
};
use tautline_firmware::estimate::localization::{
    ErrorState, ErrorStateFilter, ErrorStateMeasurement, ErrorStateNoise, LowPassLocator,
    LowPassState, NoiseReading, article_ekf, article_start,
};
use tautline_firmware::estimate::pendulum::{
    PendulumFilter, PendulumNoise, PendulumObserver, PendulumReading, VerticalDisturbance,
    VerticalDisturbanceState,
};
use tautline_firmware::estimate::taut::{
    OutOfPlaneFilter, OutOfPlaneInput, TautEstimator, TautEstimatorState, TautInput,
};
use tautline_firmware::estimate::tether_angle::{
    TetherAngleEstimator, TetherAngleState, TetherAngleUkf, TetherAngles, TetherAnglesState,
};
use tautline_firmware::estimate::{
    Ekf4, Ekf4Measurement, Ekf4State, LevelState, Leveller, Mahony, MahonyState, ThrustCalibration,
    ThrustCalibrationState, ThrustModel, ThrustModelState, VelocityFilter, VelocityState,
    VerticalFilter, VerticalState,
};
use tautline_firmware::frames::{Attitude, Body, V3, World};
use tautline_firmware::math::filter::Biquad;
use tautline_firmware::model::Line;
use tautline_firmware::model::{
    PendulumModel, PlanarImu, PlanarModel, PlanarState, TetherAngle, TetherAngleModel, TiltImu,
};
use tautline_firmware::param::Params;
use tautline_firmware::signal::{Capture, Imu, TautPurpose};
use tautline_firmware::time::{Micros, Sample};

const GYRO: [(f32, f32); 3] = [(0.0, 0.05); 3];
const LEVEL: [(f32, f32); 3] = [(0.0, 0.02), (0.1, 0.02), (0.3, 0.02)];
const SENSE: &str = "sense makes its input of the sensors' integer counts: always finite";

fn accel() -> [(f32, f32); 3] {
    three([0.0, 0.0, -9.81], 0.5)
}

fn join(parts: &[&[(f32, f32)]]) -> Vec<(f32, f32)> {
    parts.concat()
}

/// Attitude, specific force, thrust, altitude, length.
fn cable() -> Vec<(f32, f32)> {
    join(&[&LEVEL, &accel(), &[(18.5, 0.3), (5.0, 0.1), (7.07, 0.05)]])
}

fn cable_reading(z: &mut Feed) -> Ekf4Measurement<f32> {
    Ekf4Measurement {
        attitude: z.attitude(),
        accel: z.body(),
        thrust: z.f(),
        altitude: Some(z.f()),
        length: Some(z.f()),
    }
}

fn place() -> V3<f32> {
    V3::new(5.0, 0.0, -5.0)
}

pub fn rows() -> Vec<Row> {
    let mut all = attitude();
    all.extend(position());
    all.extend(taut());
    all.extend(angle());
    all.extend(localization());
    all.extend(pendulum());
    all
}

fn attitude() -> Vec<Row> {
    let imu = join(&[&GYRO, &accel()]);
    vec![
        row(
            "Mahony",
            Rule::Refuses,
            &imu,
            || MahonyState::new(Attitude::level(0.3), Body(V3::zeros())),
            |x, z| Mahony { kp: 0.2, ki: 0.01 }.step(x, &z.body(), &z.body(), 0.004),
        ),
        row(
            "start-up level",
            Rule::Trusts(SENSE),
            &join(&[&[(0.0, 0.001); 3], &accel()]),
            LevelState::default,
            |x, z| {
                let imu = Imu { gyro: z.body(), accel: z.body() };
                Ok(Leveller { samples: 1_000_000, heading: 0.3 }.step(x, &imu))
            },
        ),
    ]
}

fn position() -> Vec<Row> {
    let p = Params::default();
    let ekf = Ekf4 {
        mass: p.mass,
        line: Line::new(&p),
        q_position: p.ekf_q_position,
        q_tension: p.ekf_q_tension,
        r_accel: p.ekf_r_accel,
        r_altitude: p.ekf_r_altitude,
        r_length: p.ekf_r_length,
    };
    let capture = CaptureFilter::<f32>::new(&p);
    vec![
        filter(
            "4-state filter",
            Rule::LeavesOut,
            &cable(),
            |x: &Ekf4State<f32>| dense(&x.covariance),
            || Ekf4State::at(place(), 5.0),
            move |x, z| ekf.step(x, &cable_reading(z)),
        ),
        row(
            "velocity",
            Rule::Trusts("the 4-state filter and Mahony before it stay finite"),
            &join(&[&accel(), &three([5.0, 0.0, -5.0], 0.1)]),
            || VelocityState::at(World(place())),
            |x: &mut VelocityState<f32>, z| {
                VelocityFilter { gain: 1.5 }.step(x, &z.world(), &z.world(), 0.004);
                Ok(())
            },
        ),
        row(
            "vertical",
            Rule::Trusts(SENSE),
            &[(0.0, 0.5), (5.0, 0.1)],
            VerticalState::default,
            |x, z| {
                let filter = VerticalFilter { bandwidth: 2.0, fade: 3.0 };
                filter.predict(x, z.f(), 0.004, true);
                filter.correct(x, z.f(), 0.004);
                Ok(())
            },
        ),
        row(
            "motion capture",
            Rule::Trusts("the IMU gives integer counts, and link and sense drop a bad sample"),
            &join(&[&accel(), &three([0.0, 0.0, -1.0], 0.01)]),
            move || {
                let value = Capture { position: World(V3::new(0.0, 0.0, -1.0)), heading: None };
                (0_u64, capture.start(&Sample { at: Micros(0), value }))
            },
            move |(k, x): &mut (u64, CaptureState<f32>), z| {
                capture.predict(x, &z.world());
                *k += 1;
                let value = Capture { position: z.world(), heading: None };
                capture.correct(x, &Sample { at: Micros(*k * 4000), value });
                Ok(())
            },
        ),
        row(
            "thrust calibration",
            Rule::Trusts(SENSE),
            &[(9.81, 0.3), (14.7, 0.3)],
            ThrustCalibrationState::default,
            |x, z| Ok(ThrustCalibration { mass: 1.5, samples: 60_000 }.step(x, z.f(), z.f())),
        ),
        row(
            "thrust model",
            Rule::Trusts("the mixer's thrusts are finite"),
            &[(4.6, 0.3); 4],
            ThrustModelState::default,
            |x, z| {
                let filter = Biquad::low_pass(80.0, 1000.0);
                Ok(ThrustModel { lag: 0.03, scale: 1.0, filter }.step(x, &z.array::<4>()))
            },
        ),
    ]
}

fn planar() -> PlanarModel<f32> {
    PlanarModel::try_new(1.2, 0.012, 5.0, 9.81).unwrap()
}

/// IMU in the plane, thrust then and now, its rate: pulled outwards at 45° by 6 N.
fn planar_input() -> Vec<(f32, f32)> {
    vec![(-2.2, 0.2), (-9.5, 0.2), (0.0, 0.02), (16.0, 0.1), (16.0, 0.1), (0.0, 1.0)]
}

fn high_gain(name: &'static str, update: Update, branches: Branches) -> Row {
    let settings = HighGainSettings {
        update,
        branches,
        epsilon: 0.3,
        ..HighGainSettings::new(planar(), 0.004)
    };
    let observer = HighGain::try_new(settings).unwrap();
    row(
        name,
        Rule::Refuses,
        &planar_input(),
        move || observer.quasi_static(&PlanarImu { x: -2.2, z: -9.5, rate: 0.0 }, 16.0),
        move |x, z| {
            let input = HighGainInput {
                imu: PlanarImu { x: z.f(), z: z.f(), rate: z.f() },
                thrust_measured: z.f(),
                thrust_now: z.f(),
                thrust_rate: z.f(),
            };
            observer.step(x, &input)
        },
    )
}

fn taut() -> Vec<Row> {
    let p = Params { tether_length: 5.0, mass: 1.2, ..Params::default() };
    let both = Branches::Both(tautline_firmware::estimate::high_gain::BranchIndex::A);
    let estimator = TautEstimator::<f32>::try_new(&p).unwrap();
    let out_of_plane = OutOfPlaneFilter::<f32>::new(&p);
    vec![
        high_gain("high-gain observer, two branches", Update::PredictorCorrector, both),
        high_gain("high-gain observer, one branch", Update::PredictorCorrector, Branches::One),
        high_gain("high-gain observer, held", Update::PredictorCorrectorHeld, both),
        high_gain("high-gain observer, Euler", Update::Euler, both),
        high_gain("high-gain observer, Runge-Kutta", Update::Rk4Held, both),
        high_gain("high-gain observer, exponential", Update::ExactHeld, both),
        row(
            "taut estimator",
            Rule::Trusts(SENSE),
            &join(&[&GYRO, &three([2.2, 0.0, -9.5], 0.3), &[(16.0, 0.1), (0.0, 0.02)]]),
            TautEstimatorState::default,
            move |x, z| {
                let imu = Imu { gyro: z.body(), accel: z.body() };
                let (thrust, roll) = (z.f(), z.f());
                let input = TautInput { imu, thrust, roll, purpose: TautPurpose::Force };
                estimator.step(x, &input);
                Ok(x.estimate().copied())
            },
        ),
        filter(
            "out-of-plane filter",
            Rule::LeavesOut,
            &join(&[
                &GYRO,
                &[(0.0, 0.3), (13.0, 0.1), (5.0, 0.1)],
                &[(0.785, 0.01), (0.0, 0.02), (0.2, 0.01), (0.0, 0.02)],
            ]),
            |x: &tautline_firmware::estimate::taut::OutOfPlaneState<f32>| dense(x.covariance()),
            move || out_of_plane.start(0.0, 0.0),
            move |x, z| {
                let input = OutOfPlaneInput {
                    gyro: z.body(),
                    across: z.f(),
                    thrust: z.f(),
                    force: z.f(),
                    planar: PlanarState::from_array(z.array()),
                    length: 5.0,
                };
                out_of_plane.step(x, &input);
                Ok(())
            },
        ),
    ]
}

fn angle_model() -> TetherAngleModel<f32> {
    TetherAngleModel::try_new(14.0, 5.0).unwrap()
}

/// At rest 30° from straight up.
fn at_rest() -> TetherAngle<f32> {
    let tilt = angle_model().equilibrium_tilt(0.52).unwrap();
    TetherAngle { angle: 0.52, rate: 0.0, tilt }
}

fn rest_force() -> [f32; 2] {
    let m = angle_model();
    m.specific_force(&at_rest(), m.tension(&at_rest(), [0.0; 2]))
}

fn angle() -> Vec<Row> {
    let ukf = TetherAngleUkf::try_new(0.0125).unwrap();
    let angles = TetherAngles { ukf, model: angle_model(), projects: true };
    let [x, z] = rest_force();
    let p = Params { angle_thrust: 14.0, tether_length: 5.0, mass: 1.2, ..Params::default() };
    let estimator = TetherAngleEstimator::<f32>::try_new(&p).unwrap();
    let level = || Attitude::<f32>::level(0.0);
    let of_plane = |x: &TetherAngleState<f32>| dense(&x.posterior.covariance);
    vec![
        filter(
            "tether-angle filter",
            Rule::LeavesOut,
            &[(x, 0.3), (z, 0.3), (0.0, 0.02)],
            of_plane,
            || TetherAngleState::at(at_rest()),
            move |state, z| {
                let imu = TiltImu { x: z.f(), z: z.f(), rate: z.f() };
                ukf.step(&angle_model(), state, &imu);
                Ok(state.mode)
            },
        ),
        filter(
            "tether-angle filter in space",
            Rule::LeavesOut,
            &join(&[&three([x, 0.0, z], 0.3), &[(0.0, 0.02); 3], &[(0.0, 0.01)]]),
            |x: &TetherAnglesState<f32>| {
                let [a, b] = &x.planes;
                block_diagonal(&[&a.posterior.covariance, &b.posterior.covariance])
            },
            || {
                let upright = TetherAngle { angle: 0.0, rate: 0.0, tilt: 0.0 };
                TetherAnglesState {
                    planes: [TetherAngleState::at(at_rest()), TetherAngleState::at(upright)],
                }
            },
            move |state, z| {
                angles.step(state, Some(&z.v()), &z.v(), z.f());
                Ok(())
            },
        ),
        row(
            "tether-angle flight estimator",
            Rule::LeavesOut,
            &join(&[&[(0.0, 0.02); 3], &three([0.0, 0.0, -14.5], 0.3), &[(17.0, 0.1)]]),
            move || {
                let imu = Imu { gyro: Body(V3::zeros()), accel: Body(V3::new(0.0, 0.0, -14.5)) };
                let up = World(V3::new(0.0, 0.0, -5.0));
                (estimator.start(&up, &level(), &imu, 17.0), level())
            },
            move |(x, attitude), z| {
                let imu = Imu { gyro: z.body(), accel: z.body() };
                let thrust = z.f();
                estimator.step(x, &imu, thrust, attitude);
                Ok(estimator.estimate(x, attitude))
            },
        ),
    ]
}

fn block_diagonal(blocks: &[&nalgebra::Matrix3<f32>]) -> Option<DMatrix<f64>> {
    Some(DMatrix::from_fn(3 * blocks.len(), 3 * blocks.len(), |r, c| {
        if r / 3 == c / 3 { f64::from(blocks[r / 3][(r % 3, c % 3)]) } else { 0.0 }
    }))
}

fn error_state() -> ErrorState<f32> {
    ErrorState {
        position: World(place()),
        velocity: World(V3::zeros()),
        attitude: Attitude::level(0.3),
        tension: 5.0,
        thrust_scale: 1.0,
        accel_bias: Body(V3::zeros()),
        gyro_bias: Body(V3::zeros()),
        covariance: nalgebra::SMatrix::identity() * 0.01,
    }
}

fn localization() -> Vec<Row> {
    let published = article_ekf::<f32>(1.5, NoiseReading::PerStep, false);
    let locator = LowPassLocator::<f32>::new(1.5, 0.005);
    let noise = ErrorStateNoise::<f32>::simulated();
    let wide = ErrorStateFilter { mass: 1.5, dt: 0.005, noise };
    vec![
        filter(
            "published 4-state filter",
            Rule::LeavesOut,
            &cable(),
            |x: &Ekf4State<f32>| dense(&x.covariance),
            || article_start(None),
            move |x, z| published.step(x, &cable_reading(z)),
        ),
        row(
            "low-pass locator",
            Rule::LeavesOut,
            &join(&[
                &LEVEL,
                &three([1.0, 0.0, -9.81], 0.5),
                &[(12.0, 0.3), (5.0, 0.1), (7.0, 0.1)],
            ]),
            LowPassState::default,
            move |x, z| {
                let found = locator.step(x, &cable_reading(z));
                Ok(found.ok())
            },
        ),
        filter(
            "17-state filter",
            Rule::LeavesOut,
            &join(&[&cable(), &GYRO]),
            |x: &ErrorState<f32>| dense(&x.covariance),
            error_state,
            move |x, z| {
                let z = ErrorStateMeasurement { cable: cable_reading(z), gyro: z.body() };
                let step = wide.correct(x, &z)?;
                wide.predict(x, &z, &step);
                Ok(())
            },
        ),
    ]
}

fn pendulum() -> Vec<Row> {
    let model = PendulumModel::<f32>::try_new(0.26, 0.03, 0.7).unwrap();
    let nine = PendulumFilter { model, noise: PendulumNoise::recommended() };
    let up = || V3::new(0.0, 0.0, -1.0);
    let vertical = VerticalDisturbance { bandwidth: 3.0 };
    let observer = PendulumObserver { filter: nine, vertical: Some(vertical) };
    let rod = three([0.0, 0.0, -1.0], 0.003);
    let reading = move |z: &mut Feed| PendulumReading {
        position: z.world(),
        velocity: z.world(),
        down: z.world(),
        thrust: z.f(),
        rod: Some(z.world()),
        rod_period: 0.01,
    };
    vec![
        filter(
            "9-state pendulum filter",
            Rule::Refuses,
            &join(&[&rod, &three([0.0, 0.0, -2.84], 0.1), &rod]),
            |x: &tautline_firmware::estimate::pendulum::PendulumPosterior<f32>| {
                dense(&x.covariance.dense())
            },
            move || nine.start(&up()),
            move |x, z| {
                let (between, force, now) = (z.v(), z.v(), z.v());
                nine.step(x, (&between, &force), Some((&now, 0.01)), 0.01)
            },
        ),
        row(
            "vertical disturbance",
            Rule::Trusts("the pendulum observer below checks its inputs"),
            &join(&[&[(0.0, 0.05)], &rod, &[(0.0, 0.1); 3], &three([0.0, 0.0, -2.84], 0.1)]),
            VerticalDisturbanceState::default,
            move |x, z| {
                let (speed, rod, rate, force) = (z.f(), z.v(), z.v(), z.v());
                let none = V3::zeros();
                vertical.step(&model, x, speed, (&rod, &rate), (&force, &none), 0.01);
                Ok(())
            },
        ),
        row(
            "pendulum observer",
            Rule::LeavesOut,
            &join(&[
                &[(0.0, 0.01); 3],
                &[(0.0, 0.05); 3],
                &three([0.0, 0.0, 1.0], 0.01),
                &[(2.84, 0.05)],
                &rod,
            ]),
            move || {
                let z = PendulumReading {
                    position: World(V3::zeros()),
                    velocity: World(V3::zeros()),
                    down: World(V3::new(0.0, 0.0, 1.0)),
                    thrust: 2.84,
                    rod: Some(World(up())),
                    rod_period: 0.01,
                };
                observer.start(&z).unwrap().0
            },
            move |x, z| observer.step(x, &reading(z), 0.01),
        ),
    ]
}
