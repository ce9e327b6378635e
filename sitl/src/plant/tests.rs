use super::*;
use crate::scenario::Scenario;

fn plant(edit: impl FnOnce(&mut Scenario)) -> Plant {
    let mut scenario = Scenario::default();
    edit(&mut scenario);
    let (distance, heading) = scenario.start();
    Plant::new(PlantModel::new(&scenario, 0.0), distance, heading, 1)
}

#[test]
fn a_vehicle_at_rest_on_the_ground_stays_there_and_feels_one_g() {
    let mut p = plant(|_| {});
    let start = p.body.position;
    for _ in 0..5000 {
        p.step(&[0.0; 4], 3.0);
    }
    assert!((p.body.position - start).norm() < 0.01, "{:?}", p.body.position - start);
    let error = p.specific_force - V3::new(0.0, 0.0, -GRAVITY);
    // The winch pulls sideways with a ripple of 0.15 N, and the feet give way by microns.
    assert!(error.norm() < 0.1, "{error:?}");
}

#[test]
fn a_free_fall_without_air_keeps_its_energy_and_feels_nothing() {
    let mut p = plant(|s| {
        s.vehicle.drag_linear = [0.0; 3];
        s.vehicle.drag_quadratic = 0.0;
    });
    p.model_mut().tether.is_broken = true;
    p.model_mut().body.rate_damping = 0.0;
    p.body.position = V3::new(0.0, 0.0, -100.0);
    p.body.velocity = V3::new(3.0, 0.0, -5.0);
    p.body.rate = V3::new(1.0, 2.0, 3.0);
    let energy = |b: &Body| 0.5 * b.velocity.norm_squared() + GRAVITY * b.height();
    let before = energy(&p.body);
    let spin =
        |p: &Plant| (p.body.attitude * p.model.body.inertia.component_mul(&p.body.rate)).norm();
    let spin_before = spin(&p);
    for _ in 0..2000 {
        p.step(&[0.0; 4], 0.0);
    }
    assert!((energy(&p.body) - before).abs() < 0.01 * before);
    assert!((spin(&p) / spin_before - 1.0).abs() < 0.01);
    assert!(p.specific_force.norm() < 1e-9);
}

#[test]
fn gusts_have_the_strength_that_the_standard_gives() {
    let model = WindModel {
        speed: 5.0,
        from: 0.3,
        gusts: Gusts::Dryden,
        pulse: 0.0,
        shear: 0.0,
        table: Vec::new(),
    };
    let mut rng = Pcg64Mcg::new(7);
    let (mut wind, mut sum, n) = (Wind::default(), V3::zeros(), 2_000_000);
    for _ in 0..n {
        let v = wind.step(&model, (0.0, 10.0), 1e-2, &mut rng);
        let (s, c) = model.from.sin_cos();
        let (along, across) = (-v.x * c - v.y * s - 5.0, v.x * s - v.y * c);
        sum += V3::new(along * along, across * across, v.z * v.z);
    }
    let rms = (sum / f64::from(n)).map(f64::sqrt);
    // h = 32.8 ft: sigma_w = 0.5, sigma_h = 0.5 / 0.204^0.4 = 0.944.
    assert!((rms.x - 0.944).abs() < 0.06, "{rms}");
    assert!((rms.y - 0.944).abs() < 0.06, "{rms}");
    assert!((rms.z - 0.5).abs() < 0.04, "{rms}");
}

#[test]
fn the_same_seed_gives_the_same_world_bit_for_bit() {
    let run = || {
        let mut p = plant(|s| s.wind.speed = 4.0);
        for _ in 0..3000 {
            p.step(&[0.7, 0.69, 0.71, 0.7], 5.0);
        }
        p.body.position
    };
    assert_eq!(run().map(f64::to_bits), run().map(f64::to_bits));
}
