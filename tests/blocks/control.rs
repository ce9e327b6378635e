//! Controllers.

use super::{Row, Rule, row, three};
use tautline_firmware::control::pendulum::{
    LinearGains, LinearPendulum, PendulumControl, PendulumGains, PendulumLimits, PendulumMemory,
};
use tautline_firmware::control::taut::{
    ElevationAttitude, ElevationAttitudeStatic, ElevationForce, Inversion, Law, PlanarInput,
    PlanarLoop, PlanarLoopSettings, TautController, ThrustState,
};
use tautline_firmware::control::{
    AttitudeLoop, ClimbLoop, ClimbState, Mixer, PositionInput, PositionLoop, PositionState,
    RadialControl, RateLoop, RateSetpoint, RateState, TetherAngleLoop, ThrustMap,
};
use tautline_firmware::estimate::high_gain::{HighGain, HighGainSettings};
use tautline_firmware::estimate::pendulum::PendulumEstimate;
use tautline_firmware::estimate::taut::TautEstimate;
use tautline_firmware::frames::{Body, V3};
use tautline_firmware::model::{
    PendulumModel, PlanarImu, PlanarModel, PlanarState, TetherAngle, TetherAngleModel,
};
use tautline_firmware::param::Params;
use tautline_firmware::signal::{LoadReference, MixerReport, PlanarReference, TautPurpose, Wrench};

/// What reaches the loops: estimates that their estimators checked.
const ESTIMATE: &str =
    "the estimate is finite: its estimators refuse or leave out, and has_diverged ends the mode";

pub fn rows() -> Vec<Row> {
    let mut all = cascade();
    all.extend(taut());
    all.extend(pendulum());
    all
}

fn position(name: &'static str, radial_control: RadialControl) -> Row {
    let controller = PositionLoop::<f32>::new(&Params::default());
    let vectors = [[4.5, 0.3, -5.0], [0.0; 3], [0.0; 3], [0.707, 0.0, -0.707], [0.0; 3]];
    let mut input: Vec<_> = vectors.into_iter().flat_map(|v| three(v, 0.2)).collect();
    input.extend([(7.0, 0.1), (0.0, 0.1), (5.0, 0.5)]);
    row(name, Rule::Trusts(ESTIMATE), &input, PositionState::default, move |x, z| {
        let input = PositionInput {
            position: z.world(),
            velocity: z.world(),
            wind: z.world(),
            direction: z.world(),
            reference_velocity: z.world(),
            length: z.f(),
            length_rate: z.f(),
            tension: z.f(),
            radial_control,
            hold_integral: false,
        };
        Ok(controller.step(x, &input, 0.004))
    })
}

fn cascade() -> Vec<Row> {
    let p = Params::default();
    let attitude = AttitudeLoop::<f32>::new(&p);
    let rate = RateLoop::<f32>::new(&p);
    let mixer = Mixer::<f32>::new(&p);
    let map = ThrustMap::<f32>::new(&p);
    let climb = ClimbLoop::<f32> {
        mass: 1.5,
        kp: 3.0,
        ki: 1.0,
        integral_max: 6.0,
        thrust_min: 2.0,
        thrust_max: 30.0,
    };
    let model = TetherAngleModel::<f32>::try_new(14.0, 5.0).unwrap();
    let mut turn = three([3.0, 0.0, -18.0], 0.5).to_vec();
    turn.extend([(0.05, 0.02), (0.1, 0.02), (0.3, 0.02), (0.2, 0.1)]);
    vec![
        position("position loop, winch", RadialControl::Winch),
        position("position loop, fixed length", RadialControl::FixedLength),
        position("position loop, free", RadialControl::Free),
        row(
            "attitude loop",
            Rule::Trusts(ESTIMATE),
            &turn,
            || (),
            move |(), z| Ok(attitude.step(&z.world(), &z.attitude(), z.f())),
        ),
        row(
            "rate loop",
            Rule::Trusts(ESTIMATE),
            &[(0.1, 0.3); 12],
            RateState::default,
            move |x, z| {
                let wanted = RateSetpoint { rate: z.body(), accel: z.body() };
                Ok(rate.step(x, &wanted, &z.body(), &z.body(), MixerReport::default(), 0.001))
            },
        ),
        row(
            "climb loop",
            Rule::Trusts(ESTIMATE),
            &[(0.3, 0.1), (0.1, 0.3)],
            ClimbState::default,
            move |x, z| Ok(climb.step(x, z.f(), z.f(), 0.004)),
        ),
        row(
            "mixer",
            Rule::LeavesOut,
            &[(18.0, 1.0), (0.1, 0.2), (0.1, 0.2), (0.0, 0.1)],
            || (),
            move |(), z| {
                let wrench = Wrench { thrust: z.f(), torque: z.body() };
                let mut thrusts = mixer.each(0.0);
                let report = mixer.step(&wrench, &mut thrusts);
                let is_within = thrusts.iter().all(|t| (mixer.min..=mixer.max).contains(t));
                Ok((thrusts, report, is_within.then_some(()).ok_or(f32::NAN)))
            },
        ),
        row(
            "thrust map",
            Rule::LeavesOut,
            &[(4.6, 0.3), (15.2, 0.2)],
            || (),
            move |(), z| {
                let throttle = map.throttle(z.f(), Some(z.f()));
                Ok((throttle, (0.0..=1.0).contains(&throttle).then_some(()).ok_or(f32::NAN)))
            },
        ),
        row(
            "tether-angle loop",
            Rule::Trusts(ESTIMATE),
            &[(0.5, 0.05), (0.45, 0.05), (0.0, 0.1), (0.2, 0.05)],
            || (),
            move |(), z| {
                let reference = z.f();
                let x = TetherAngle { angle: z.f(), rate: z.f(), tilt: z.f() };
                Ok(TetherAngleLoop::planar().step(&model, reference, &x))
            },
        ),
    ]
}

fn planar() -> PlanarModel<f32> {
    PlanarModel::try_new(1.2, 0.012, 5.0, 9.81).unwrap()
}

const WINDOW: Inversion<f32> = Inversion::Window { threshold: 0.5, damping: 0.2 };
/// Elevation, pitch and their rates.
const STATE: [(f32, f32); 4] = [(0.8, 0.05), (0.0, 0.1), (0.2, 0.05), (0.0, 0.1)];
const ELEVATION: [(f32, f32); 5] =
    [(0.785, 0.01), (0.0, 0.02), (0.0, 0.02), (0.0, 0.02), (0.0, 0.02)];
const FORCE: [(f32, f32); 3] = [(6.0, 0.1), (0.0, 0.1), (0.0, 0.1)];
const PITCH: [(f32, f32); 3] = [(0.2, 0.01), (0.0, 0.1), (0.0, 0.1)];

fn taut() -> Vec<Row> {
    let fixed =
        ElevationAttitudeStatic::try_new(planar(), &[-1.0, -1.5], &[-3.0, -4.0], WINDOW).unwrap();
    let attitude =
        ElevationAttitude::try_new(planar(), &[-1.0, -1.5, -2.0], &[-3.0, -4.0], WINDOW).unwrap();
    let force = ElevationForce::try_new(planar(), &[-1.0, -1.5, -2.0, -2.5], &[-1.0, -1.5], WINDOW)
        .unwrap();
    let thrust = [(16.0, 0.5), (0.0, 1.0)];
    let observer = HighGain::try_new(HighGainSettings {
        epsilon: 0.3,
        ..HighGainSettings::new(planar(), 0.004)
    })
    .unwrap();
    let settings = PlanarLoopSettings { motor_lag: 0.03, hold_off: 0.1, limits: None };
    let joined = PlanarLoop::try_new(observer, Law::Force(force), settings).unwrap();
    let imu = [(-2.2, 0.2), (-9.5, 0.2), (0.0, 0.02)];
    let mut rows = vec![
        row(
            "Γa",
            Rule::Refuses,
            &[&STATE[..], &ELEVATION[..3], &PITCH].concat(),
            || (),
            move |(), z| fixed.step(&PlanarState::from_array(z.array()), &z.array(), &z.array()),
        ),
        row(
            "Γa'",
            Rule::Refuses,
            &[&STATE[..], &thrust[..1], &ELEVATION[..4], &PITCH].concat(),
            || (),
            move |(), z| {
                attitude.step(&PlanarState::from_array(z.array()), z.f(), &z.array(), &z.array())
            },
        ),
        row(
            "Γb",
            Rule::Refuses,
            &[&STATE[..], &thrust, &ELEVATION, &FORCE].concat(),
            || (),
            move |(), z| {
                let x = PlanarState::from_array(z.array());
                let thrust = ThrustState { thrust: z.f(), rate: z.f() };
                force.step(&x, &thrust, &z.array(), &z.array())
            },
        ),
        row(
            "planar loop",
            Rule::Refuses,
            &[&imu[..], &ELEVATION, &FORCE].concat(),
            move || {
                // Past the hold-off, in which the reference is not looked at.
                let still = PlanarImu { x: -2.2, z: -9.5, rate: 0.0 };
                joined.start(&still, 16.0)
            },
            move |x, z| {
                let imu = PlanarImu { x: z.f(), z: z.f(), rate: z.f() };
                let input = PlanarInput { imu, acting: None, state: None };
                let reference = PlanarReference { elevation: z.array(), second: z.array() };
                joined.step(x, &input, &reference)
            },
        ),
    ];
    for (name, purpose, second) in [
        ("taut pilot, force", TautPurpose::Force, FORCE),
        ("taut pilot, attitude", TautPurpose::Attitude, PITCH),
    ] {
        rows.push(pilot(name, purpose, second));
    }
    rows
}

/// Only what the pilot reads of the estimate: the plane, and the body rate about the vertical.
fn pilot(name: &'static str, purpose: TautPurpose, second: [(f32, f32); 3]) -> Row {
    let p = Params { mass: 1.2, tether_length: 5.0, ..Params::default() };
    let pilot = TautController::<f32>::try_new(&p, planar(), purpose).unwrap();
    let estimate = |planar| TautEstimate {
        planar,
        link_force: 6.0,
        residual: 0.0,
        thrust: 16.0,
        thrust_rate: 0.0,
        accel: Body(V3::zeros()),
        rate: Body(V3::zeros()),
        out_of_plane: None,
    };
    let elevation = if purpose == TautPurpose::Force { &ELEVATION[..] } else { &ELEVATION[..4] };
    let input = [&STATE[..], &[(0.0, 0.05)], elevation, &second].concat();
    row(
        name,
        Rule::Refuses,
        &input,
        move || pilot.start(&estimate(PlanarState::default())),
        move |x, z| {
            let planar = PlanarState::from_array(z.array());
            let rate = Body(V3::new(0.0, 0.0, z.f()));
            let mut reference = PlanarReference { elevation: [0.0; 5], second: [0.0; 3] };
            let derivatives = if purpose == TautPurpose::Force { 5 } else { 4 };
            for y in &mut reference.elevation[..derivatives] {
                *y = z.f();
            }
            reference.second = z.array();
            pilot.step(x, &estimate(planar), &rate, &reference)
        },
    )
}

fn pendulum() -> Vec<Row> {
    let model = PendulumModel::<f32>::try_new(0.26, 0.03, 0.7).unwrap();
    let law =
        PendulumControl::try_new(PendulumGains::robust(), model, PendulumLimits::standard(&model))
            .unwrap();
    let linear = LinearPendulum {
        gains: LinearGains {
            across: [-6.0, -6.0, -60.0, -15.0, 9.0],
            vertical: [6.0, 4.0],
            feeds_forward: true,
        },
        model,
        limits: PendulumLimits::standard(&model),
    };
    let mut input: Vec<_> = [[0.0, 0.0, -0.7], [0.0; 3], [0.0, 0.0, -1.0], [0.0; 3], [0.0; 3]]
        .into_iter()
        .flat_map(|v| three(v, 0.02))
        .collect();
    input.extend([(0.0, 0.02); 3]);
    input.extend(three([0.0, 0.0, -0.7], 0.02));
    input.extend([(0.0, 0.02); 15]);
    let estimate = |z: &mut super::Feed| PendulumEstimate {
        position: z.world(),
        velocity: z.world(),
        rod: z.world(),
        rod_rate: z.world(),
        disturbance: z.world(),
    };
    vec![
        row("pendulum law", Rule::Refuses, &input, PendulumMemory::default, move |x, z| {
            let (now, attitude) = (estimate(z), z.attitude());
            law.step(x, &now, &attitude, &LoadReference(std::array::from_fn(|_| z.v())))
        }),
        row(
            "linear pendulum",
            Rule::Trusts("for comparison only, as its comment says; no mode flies it"),
            &input,
            || (),
            move |(), z| {
                let (now, attitude) = (estimate(z), z.attitude());
                Ok(linear.step(&now, &attitude, &LoadReference(std::array::from_fn(|_| z.v()))))
            },
        ),
    ]
}
