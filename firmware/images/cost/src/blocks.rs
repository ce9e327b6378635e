//! The blocks, each with an input at which it does its usual work.

use crate::meter::Meter;
use core::hint::black_box;
use tautline_firmware::control::taut::{
    ElevationForce, Inversion, Law, PlanarInput, PlanarLoop, PlanarLoopSettings,
};
use tautline_firmware::control::{
    AttitudeLoop, Mixer, RateLoop, RateSetpoint, RateState, TetherAngleLoop, ThrustMap,
};
use tautline_firmware::estimate::high_gain::{Branches, HighGain, HighGainSettings};
use tautline_firmware::estimate::{
    Ekf4, Ekf4Measurement, Ekf4State, Mahony, MahonyState, cable_reading,
};
use tautline_firmware::frames::{Attitude, Body, V3, World};
use tautline_firmware::math::GRAVITY;
use tautline_firmware::model::{Line, PlanarModel, TetherAngle, TetherAngleModel};
use tautline_firmware::param::Params;
use tautline_firmware::scalar::Scalar;
use tautline_firmware::sense::{ImuScale, Motion, RawSensors, Sense, SenseState};
use tautline_firmware::signal::{MixerReport, PlanarReference, RawImu, Wrench};
use tautline_firmware::time::{Micros, Sample};
use tautline_firmware::trajectory::ThrustBranch;

fn v<S: Scalar>(x: f64, y: f64, z: f64) -> V3<S> {
    V3::new(S::lit(x), S::lit(y), S::lit(z))
}

/// Those that also fly in fixed point.
pub fn common<S: Scalar>(meter: &mut Meter, scalar: &str) {
    let params = Params::default();
    let l = S::lit;
    sense::<S>(meter, scalar, &params);

    let mahony = Mahony { kp: l(0.2), ki: l(0.01) };
    let mut state = MahonyState::new(Attitude::level(l(0.4)), Body(V3::zeros()));
    let (gyro, accel) = (Body(v(0.3, -0.2, 0.1)), Body(v(0.5, -0.3, -9.7)));
    meter.measure("attitude filter", scalar, || {
        let _ = black_box(mahony.step(&mut state, black_box(&gyro), &accel, l(0.004)));
    });

    let attitude = Attitude::from_euler(l(0.05), l(-0.2), l(0.3));
    let (mass, tension, thrust) = (l(1.5), l(6.0), l(19.0));
    let accel = cable_reading(&attitude, v(3.0, 1.0, -3.5), tension, thrust, mass * l(GRAVITY))
        * l(GRAVITY);
    let z = Ekf4Measurement {
        attitude,
        accel: Body(accel),
        thrust,
        altitude: Some(l(3.5)),
        length: Some(l(4.72)),
    };
    let ekf = Ekf4 {
        mass,
        line: Line::new(&params),
        q_position: l(1e-4),
        q_tension: l(1e-3),
        r_accel: l(1e-3),
        r_altitude: l(1e-2),
        r_length: l(1e-2),
    };
    let mut state = Ekf4State::at(v(3.0, 1.0, -3.5), tension);
    meter.measure("4-state filter, 5 rows", scalar, || {
        let _ = black_box(ekf.step(&mut state, black_box(&z)));
    });

    taut_loop::<S>(meter, scalar);

    if let Ok(model) = TetherAngleModel::try_new(l(14.0), l(5.0)) {
        let tilt = model.equilibrium_tilt(l(0.6)).unwrap_or_default();
        let x = TetherAngle { angle: l(0.6), rate: l(0.1), tilt };
        let law = TetherAngleLoop::spatial();
        meter.measure("tether-angle law, one plane", scalar, || {
            black_box(law.step(&model, l(0.5), black_box(&x)));
        });
    }

    let law = AttitudeLoop::<S>::new(&params);
    let force = World(v(1.0, -0.5, -16.0));
    meter.measure("attitude law", scalar, || {
        black_box(law.step(black_box(&force), &attitude, l(0.3)));
    });

    let rates = RateLoop::<S>::new(&params);
    let mut state = RateState::default();
    let command = law.step(&force, &attitude, l(0.3));
    let wanted = RateSetpoint::of(&command);
    let pull = Body(v(0.5, 0.2, 0.0));
    meter.measure("rate law", scalar, || {
        let report = MixerReport::default();
        black_box(rates.step(&mut state, &wanted, black_box(&gyro), &pull, report, l(0.001)));
    });

    let mixer = Mixer::<S>::new(&params);
    let map = ThrustMap::<S>::new(&params);
    let wrench = Wrench { thrust: l(15.0), torque: Body(v(0.1, -0.2, 0.05)) };
    let mut thrusts = mixer.each(S::zero());
    let mut throttles = thrusts;
    meter.measure("mixer and thrust map", scalar, || {
        black_box(mixer.step(black_box(&wrench), &mut thrusts));
        map.throttles(black_box(&thrusts), Some(l(14.8)), black_box(&mut throttles));
    });
}

fn sense<S: Scalar>(meter: &mut Meter, scalar: &str, params: &Params) {
    let scale = ImuScale { gyro: 1.065e-3, accel: 4.788e-3, rate_hz: 1000.0 };
    let sense = Sense::<S>::new(params, scale);
    let mut state = SenseState::default();
    let mut now = 0;
    let motion = Motion { cos_tilt: S::one(), accel_up: S::zero(), rests: false };
    meter.measure("sense", scalar, || {
        now += 1000;
        let flicker = (now / 1000 % 3) as i16;
        let value =
            RawImu { accel: [flicker, 100, 2046], gyro: [flicker, 2, 5], temperature: 30.0 };
        let at = Micros(now);
        let raw = RawSensors { imu: Some(Sample { at, value }), ..RawSensors::default() };
        black_box(sense.step(&mut state, at, black_box(&raw), &motion));
    });
}

/// High-gain observer and the law for elevation and force, as on a taut link.
fn taut_loop<S: Scalar>(meter: &mut Meter, scalar: &str) {
    let l = S::lit;
    let Ok(model) = PlanarModel::try_new(l(1.2), l(0.012), l(5.0), l(9.81)) else { return };
    let settings = HighGainSettings {
        epsilon: 2.0,
        branches: Branches::One,
        sign_is_continuous: false,
        ..HighGainSettings::new(model, 0.004)
    };
    let window = Inversion::Window { threshold: l(0.5), damping: l(0.2) };
    let poles = ([-1.5, -2.25, -3.0, -3.75].map(S::lit), [-1.5, -2.25].map(S::lit));
    let (Ok(observer), Ok(law)) =
        (HighGain::try_new(settings), ElevationForce::try_new(model, &poles.0, &poles.1, window))
    else {
        return;
    };
    let settings = PlanarLoopSettings { motor_lag: 0.0, hold_off: 0.0, limits: None };
    let Ok(pilot) = PlanarLoop::try_new(observer, Law::Force(law), settings) else { return };
    let o = S::zero();
    let reference = PlanarReference { elevation: [l(0.785), o, o, o, o], second: [l(6.0), o, o] };
    let Ok((start, _)) =
        model.flat_force(&reference.elevation, &reference.second, ThrustBranch::Positive)
    else {
        return;
    };
    let imu = model.imu(&start.state, start.thrust);
    let mut state = pilot.start(&imu, start.thrust);
    let input = PlanarInput { imu, acting: None, state: None };
    meter.measure("high-gain observer and force law", scalar, || {
        let _ = black_box(pilot.step(&mut state, black_box(&input), &reference));
    });
}

/// Those that need single precision.
#[cfg(target_abi = "eabihf")]
pub fn single(meter: &mut Meter) {
    use tautline_firmware::control::pendulum::{
        PendulumControl, PendulumGains, PendulumLimits, PendulumMemory,
    };
    use tautline_firmware::estimate::pendulum::{
        PendulumFilter, PendulumNoise, PendulumObserver, PendulumReading, VerticalDisturbance,
    };
    use tautline_firmware::estimate::tether_angle::{TetherAngleState, TetherAngleUkf};
    use tautline_firmware::model::{PendulumModel, TiltImu};
    use tautline_firmware::trajectory::load::TiltedCircle;
    const DT: f32 = 0.01;
    let scalar = "f32";

    if let (Ok(ukf), Ok(model)) =
        (TetherAngleUkf::try_new(0.0125_f32), TetherAngleModel::try_new(16.0, 5.0))
    {
        let x = TetherAngle {
            angle: 0.6,
            rate: 0.0,
            tilt: model.equilibrium_tilt(0.6).unwrap_or_default(),
        };
        let [ax, az] = model.specific_force(&x, model.tension(&x, [0.0; 2]));
        let mut state = TetherAngleState::at(x);
        meter.measure("unscented tether-angle filter", scalar, || {
            ukf.step(&model, &mut state, black_box(&TiltImu { x: ax, z: az, rate: 0.0 }));
            black_box(&state);
        });
    }

    let Ok(model) = PendulumModel::try_new(0.26_f32, 0.03, 0.7) else { return };
    let filter = PendulumFilter { model, noise: PendulumNoise::recommended() };
    let observer =
        PendulumObserver { filter, vertical: Some(VerticalDisturbance { bandwidth: 3.0 }) };
    let Ok(control) =
        PendulumControl::try_new(PendulumGains::robust(), model, PendulumLimits::standard(&model))
    else {
        return;
    };
    let circle = TiltedCircle::article(0.5_f32);
    let attitude = Attitude::from_euler(0.02, -0.03, 0.3);
    let rod = V3::new(0.03, -0.02, -1.0);
    let z = PendulumReading {
        rod: Some(World(rod)),
        rod_period: DT,
        position: World(V3::new(0.8, 0.0, -0.9)),
        velocity: World(V3::new(0.0, 0.5, 0.2)),
        down: World(attitude.0.column(2).into_owned()),
        thrust: 2.8,
    };
    let force = V3::new(0.1, 0.0, -2.8);
    let Some((mut state, first)) = observer.start(&z) else { return };
    meter.measure("pendulum filter, predict 9 states", scalar, || {
        filter.predict(&mut state.posterior, black_box(&rod), black_box(&force), DT);
    });
    meter.measure("pendulum filter, 4 scalar updates", scalar, || {
        filter.update(&mut state.posterior, black_box(&rod), DT);
    });
    meter.measure("pendulum observer", scalar, || {
        let _ = black_box(observer.step(&mut state, black_box(&z), DT));
    });
    let mut memory = PendulumMemory::default();
    let reference = circle.at(0.3);
    meter.measure("pendulum law", scalar, || {
        let (x, reference) = (black_box(&first), black_box(&reference));
        let _ = black_box(control.step(&mut memory, x, &attitude, reference));
    });
    let mut angle = 0.0;
    meter.measure("pendulum reference", scalar, || {
        angle = circle.advance(black_box(angle), DT);
        black_box(circle.at(angle));
    });
}
