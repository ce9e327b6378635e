use super::super::GRAVITY;
use super::*;
use crate::scenario::Scenario;

const STEP: f64 = 5e-4;
const CALM: fn(f64) -> V3 = |_| V3::zeros();

/// An end that does not give way.
fn held(position: V3, velocity: V3) -> End {
    End { position, velocity, force: V3::zeros(), mass: f64::INFINITY, turns: 0.0, down: V3::z() }
}

fn winch(edit: impl FnOnce(&mut WinchModel)) -> WinchModel {
    let mut winch = WinchModel::new(&Scenario::default().tether);
    (winch.friction, winch.force_max, winch.length_max) = (0.0, 1e4, 500.0);
    edit(&mut winch);
    winch
}

fn line(density: f64, diameter: f64) -> Material {
    Material { density, stiffness: 5e4, relaxation: 5e-3, diameter }
}

/// As many segments as the scenario's default gives a line of this length.
fn default_segments(length: f64) -> usize {
    let mut section = Scenario::default().tether;
    (section.model, section.winch_length_max) = (LineModel::Chain, length);
    TetherModel::new(&section, &VehicleSection::default()).segments.unwrap()
}

/// An unstretchable line from the origin to a point, in the vertical plane to the North.
struct Catenary {
    /// Horizontal force over weight per length, m.
    a: f64,
    /// Where its ends are from its lowest point, in units of `a`.
    ends: [f64; 2],
    weight: f64,
}

impl Catenary {
    /// To `distance` m away at `elevation` rad, held with `tension` N at the origin. `None`: it has no such rest.
    fn new(distance: f64, elevation: f64, weight: f64, tension: f64) -> Option<Self> {
        let (across, up) = (distance * elevation.cos(), distance * elevation.sin());
        let of = |horizontal: f64| {
            let a = horizontal / weight;
            let half = across / (2.0 * a);
            let middle = (up / (2.0 * a * half.sinh())).asinh();
            Self { a, ends: [middle - half, middle + half], weight }
        };
        let excess = |horizontal: f64| of(horizontal).tension(0) - tension;
        // The taut one of two: from the largest horizontal force down to where the tension is met.
        let mut high = tension;
        while high > 1e-3 * tension && excess(0.99 * high) >= 0.0 {
            high *= 0.99;
        }
        let mut low = 0.99 * high;
        if !(excess(tension) >= 0.0 && excess(low) < 0.0) {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 { low = middle } else { high = middle }
        }
        Some(of(high))
    }

    fn tension(&self, end: usize) -> f64 {
        self.a * self.weight * self.ends[end].cosh()
    }

    fn length(&self) -> f64 {
        self.a * (self.ends[1].sinh() - self.ends[0].sinh())
    }

    fn point(&self, share: f64) -> V3 {
        let here = (share * self.length() / self.a + self.ends[0].sinh()).asinh();
        V3::new(here - self.ends[0], 0.0, self.ends[0].cosh() - here.cosh()) * self.a
    }

    /// On what holds its upper end.
    fn force(&self) -> V3 {
        V3::new(-1.0, 0.0, self.ends[1].sinh()) * (self.a * self.weight)
    }
}

#[test]
fn a_chain_at_rest_pulls_like_the_catenary() {
    let mut rows = 0;
    for (tension, distance) in [5.0, 15.0].iter().flat_map(|t| [10.0, 45.0, 100.0].map(|d| (*t, d)))
    {
        for (elevation, density) in [45.0_f64, 60.0, 75.0]
            .iter()
            .flat_map(|e| [0.002, 0.01, 0.02, 0.03, 0.04, 0.067].map(|mu| (*e, mu)))
        {
            let angle = elevation.to_radians();
            let exact = Catenary::new(distance, angle, density * GRAVITY, tension);
            let Some(exact) = exact else { continue };
            // So high that nothing lies on the ground.
            let base = V3::new(0.0, 0.0, -50.0);
            let end = base + exact.point(1.0);
            let model = winch(|_| {});
            let drum = Some(Drum { model: &model, wanted: tension });
            let n = default_segments(distance);
            let mut chain = Chain::new(n, exact.length(), |share| base + exact.point(share));
            let material = line(density, 0.004);
            // Stopped again and again, it comes to rest where its own forces balance.
            for _ in 0..12 {
                let points: Vec<V3> = chain.points().collect();
                let place = |share: f64| points[(share * n as f64).round() as usize];
                chain = Chain::new(n, chain.length(), place);
                for _ in 0..1500 {
                    let still = (base, V3::zeros());
                    chain.step(&material, drum, still, &held(end, V3::zeros()), &CALM, STEP);
                }
            }
            let mut force = chain.end_force();
            force.z += GRAVITY * chain.end_mass(density);
            let wanted = exact.force();
            let (off, turned) = ((force - wanted).norm(), force.angle(&wanted).to_degrees());
            let name = format!("{tension} N, {distance} m, {elevation} deg, {density} kg/m, {n}");
            assert!(off <= (0.01 * wanted.norm()).max(0.1), "{name}: {off} N of {wanted}");
            assert!(turned <= 0.2, "{name}: {turned} deg");
            rows += 1;
        }
    }
    assert!(rows > 60, "{rows}");
}

#[test]
fn a_fixed_tether_pulls_only_when_stretched_and_then_towards_the_anchor() {
    let mut section = Scenario::default().tether;
    section.kind = TetherKind::Fixed;
    let model = TetherModel::new(&section, &VehicleSection::default());
    let (length, base) = (model.length, (V3::zeros(), V3::zeros()));
    let at = |x: f64| V3::new(0.6, 0.0, -0.8) * x;
    let mut tether = Tether::new(&model, &V3::zeros(), &at(1.0), &mut Pcg64Mcg::new(1));
    let slack = tether.step(&model, base, &held(at(length - 0.01), V3::zeros()), &CALM).force;
    assert!(slack.x.abs() < 1e-12 && tether.tension().abs() < 1e-12);
    let taut = tether.step(&model, base, &held(at(length + 0.02), V3::zeros()), &CALM).force;
    let expected = model.stiffness / length * 0.02;
    assert!((taut.x + 0.6 * expected).abs() < 1e-9);
    // Weight times height between its ends, half of it to each side of the middle.
    let weight = model.line_density * GRAVITY * 0.8 * (length + 0.02);
    assert!((tether.tension() - expected - 0.5 * weight).abs() < 1e-9);
    assert!((tether.tension() - tether.station_tension() - weight).abs() < 1e-9);
    // Rushing inwards, the damper may not push.
    tether.step(&model, base, &held(at(length + 1e-4), -at(30.0)), &CALM);
    assert!(tether.tension() >= 0.0);
}

/// Hz of a value that swings about zero, from the times at which it rises through it.
fn frequency(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let rises: Vec<f64> = (1..values.len())
        .filter(|&i| values[i - 1] < 0.0 && values[i] >= 0.0)
        .map(|i| i as f64 - values[i] / (values[i] - values[i - 1]))
        .collect();
    (rises.len() - 1) as f64 / ((rises[rises.len() - 1] - rises[0]) * STEP)
}

/// A line between two points at the same height, pulled to `stretch` of its length, its middle at `shape` of a share.
fn string(n: usize, length: f64, stretch: f64, shape: impl Fn(f64) -> V3) -> (Chain, End, [V3; 2]) {
    let base = V3::new(0.0, 0.0, -20.0);
    let end = base + V3::new(length * (1.0 + stretch), 0.0, 0.0);
    let place = |share: f64| base + (end - base) * share + shape(share);
    (Chain::new(n, length, place), held(end, V3::zeros()), [base, end])
}

#[test]
fn a_taut_chain_swings_across_and_along_like_a_string() {
    for n in [5, 10] {
        let (length, density) = (10.0, 0.002);
        let material = Material { relaxation: 0.0, ..line(density, 0.0) };
        let half_wave = |share: f64| (PI * share).sin();
        let tension: f64 = 20.0;
        let stretch = tension / material.stiffness;
        let run = |shape: &dyn Fn(f64) -> V3, axis: usize, steps: usize| {
            let (mut chain, end, [base, _]) = string(n, length, stretch, shape);
            let rest = chain.points().nth(n / 2).unwrap() - shape((n / 2) as f64 / n as f64);
            frequency((0..steps).map(|_| {
                chain.step(&material, None, (base, V3::zeros()), &end, &CALM, STEP);
                (chain.points().nth(n / 2).unwrap() - rest)[axis]
            }))
        };
        let across = run(&|share| V3::new(0.0, 0.02 * half_wave(share), 0.0), 1, 8_000);
        let theory = (tension / density).sqrt() / (2.0 * length);
        assert!((across / theory - 1.0).abs() < 0.03, "{n}: {across} Hz, theory {theory}");
        // A longer, softer line, so that the wave takes some steps.
        let soft = Material { stiffness: 2e3, ..material };
        let stretch = tension / soft.stiffness;
        let (mut chain, end, [base, _]) =
            string(n, length, stretch, |share| V3::new(0.005 * half_wave(share), 0.0, 0.0));
        let rest = base.x + length * (1.0 + stretch) * (n / 2) as f64 / n as f64;
        let along = frequency((0..400).map(|_| {
            chain.step(&soft, None, (base, V3::zeros()), &end, &CALM, STEP);
            chain.points().nth(n / 2).unwrap().x - rest
        }));
        let theory = (soft.stiffness / density).sqrt() / (2.0 * length);
        assert!((along / theory - 1.0).abs() < 0.03, "{n}: {along} Hz, theory {theory}");
    }
}

#[test]
fn a_swinging_chain_gains_no_energy_and_loses_little() {
    let material = Material { relaxation: 0.0, ..line(0.03, 0.0) };
    let (mut chain, end, [base, _]) = string(8, 20.0, -0.1, |_| V3::zeros());
    let energy = |chain: &Chain| chain.energy(&material);
    // Until the first jerk at the lowest point is over.
    let step = |chain: &mut Chain| {
        chain.step(&material, None, (base, V3::zeros()), &end, &CALM, STEP);
    };
    let start = energy(&chain);
    for _ in 0..6_000 {
        step(&mut chain);
    }
    let (before, mut most) = (energy(&chain), f64::MIN);
    assert!(before < start);
    for _ in 0..20_000 {
        step(&mut chain);
        most = most.max(energy(&chain));
    }
    // Against the energy of the swing itself: from the lowest rest.
    let swing = start - before;
    assert!(most - before < 0.01 * swing.abs().max(1.0), "{most} after {before}");
    assert!(before - energy(&chain) < 0.5 * (swing.abs() + 1.0));
}

#[test]
fn reeling_at_two_metres_per_second_makes_no_step_in_the_tension() {
    let model = winch(|_| {});
    let drum = Some(Drum { model: &model, wanted: 15.0 });
    for density in [0.002, 0.03] {
        let material = line(density, 0.004);
        let towards = V3::new(0.5, 0.0, -0.75_f64.sqrt());
        let (mut distance, mut speed) = (5.0, 0.0_f64);
        let n = default_segments(45.0);
        let mut chain = Chain::new(n, distance, |share| towards * (distance * share));
        let (mut last, mut worst) = (None::<[f64; 2]>, 0.0_f64);
        // Out for 20 s, in for 20 s, with gentle changes.
        for step in 0..88_000 {
            let time = f64::from(step) * STEP;
            let wanted = if time < 4.0 {
                0.0
            } else if time < 24.0 {
                2.0
            } else {
                -2.0
            };
            speed += (wanted - speed).clamp(-STEP, STEP);
            if distance < 5.0 && speed < 0.0 {
                break;
            }
            distance += speed * STEP;
            let end = held(towards * distance, towards * speed);
            chain.step(&material, drum, (V3::zeros(), V3::zeros()), &end, &CALM, STEP);
            let now = [chain.station_tension(), chain.tension()];
            if let Some(last) = last.filter(|_| time > 3.0) {
                let change = |i: usize| (now[i] / last[i] - 1.0).abs();
                worst = worst.max(change(0)).max(change(1));
            }
            last = Some(now);
        }
        assert!(worst < 0.02, "{density} kg/m: {worst}");
        assert!((chain.station_tension() - 15.0).abs() < 1.0);
    }
}

#[test]
fn a_cut_line_falls_from_the_vehicle_and_nothing_pulls_but_its_weight() {
    let end = V3::new(6.0, 0.0, -30.0);
    let mut chain = Chain::new(10, end.norm(), |share| end * share);
    let material = line(0.03, 0.004);
    let hold = |chain: &mut Chain, steps: usize| {
        for _ in 0..steps {
            let end = held(end, V3::zeros());
            chain.step(&material, None, (V3::zeros(), V3::zeros()), &end, &CALM, STEP);
        }
    };
    hold(&mut chain, 2_000);
    chain.cut(0.5);
    assert!((chain.length() - 0.5 * end.norm()).abs() < 0.1 * end.norm());
    let mut last = 0.0;
    for _ in 0..60 {
        hold(&mut chain, 500);
        last += (chain.tension() + GRAVITY * chain.end_mass(0.03)) / 60.0;
    }
    let weight = 0.03 * GRAVITY * chain.length();
    assert!((last / weight - 1.0).abs() < 0.1, "{last} N, {weight} N");
    assert!(chain.station_tension() == 0.0);
    let lowest = chain.points().next().unwrap();
    assert!((lowest.z - end.z - chain.length()).abs() < 1.0, "{lowest}");
}

#[test]
fn a_slack_line_lies_on_the_ground_and_a_caught_one_holds_from_where_it_is() {
    let end = V3::new(8.0, 0.0, -3.0);
    let mut chain = Chain::new(10, 20.0, |share| end * share);
    let material = line(0.03, 0.004);
    let hold = |chain: &mut Chain, end: V3| {
        for _ in 0..10_000 {
            let end = held(end, V3::zeros());
            chain.step(&material, None, (V3::zeros(), V3::zeros()), &end, &CALM, STEP);
        }
    };
    hold(&mut chain, end);
    assert!(chain.points().all(|point| point.z <= 1e-9));
    let lying = chain.points().filter(|point| point.z > -0.05).count();
    assert!(lying >= 4, "{lying}");
    // What hangs is about as long as the vehicle is high: its weight is all that pulls.
    assert!(chain.tension() < 0.03 * GRAVITY * 6.0, "{}", chain.tension());
    chain.catch(0.5);
    let caught = chain.points().nth(5).unwrap();
    hold(&mut chain, V3::new(8.0, 0.0, -9.0));
    assert!((chain.points().nth(5).unwrap() - caught).norm() < 1e-9);
    chain.release();
    hold(&mut chain, end);
    assert!((chain.points().nth(5).unwrap() - caught).norm() > 1e-3);
}

#[test]
fn a_drum_holds_its_tension_on_a_line_too_short_and_stiff_to_give_way() {
    for (length, stiffness) in [(0.3, 2e5), (0.8, 2e4), (0.8, 3e3), (2.0, 2e4)] {
        let model = winch(|winch| winch.friction = 0.3);
        let drum = Some(Drum { model: &model, wanted: 3.0 });
        let end = V3::new(0.98, 0.0, -0.2).normalize() * length;
        let material = Material { stiffness, ..line(0.002, 0.0015) };
        let mut chain = Chain::new(5, length, |share| end * share);
        for step in 0..4_000 {
            let held = held(end, V3::zeros());
            chain.step(&material, drum, (V3::zeros(), V3::zeros()), &held, &CALM, STEP);
            let off = (chain.station_tension() - 3.0).abs();
            assert!(step < 1_000 || off < 0.1, "{length} m, {stiffness} N: {off} at {step}");
        }
    }
}
