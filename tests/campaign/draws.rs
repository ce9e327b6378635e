//! What is drawn is what the file says.

use crate::folder::{Folder, SPREAD};
use tautline_sitl::campaign::Campaign;

const COUNT: u64 = 2000;

fn numbers(campaign: &Campaign, key: &str) -> Vec<f64> {
    let of = |index| {
        let drawn = campaign.drawn(index);
        drawn.iter().find(|(name, _)| *name == key).unwrap().1.as_float().unwrap()
    };
    (0..campaign.flights()).map(of).collect()
}

fn mean_and_sd(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// Largest distance between the share of draws below a value and what it should be: Kolmogorov's statistic.
fn distance(mut values: Vec<f64>, below: impl Fn(f64) -> f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let off = |(i, x): (usize, &f64)| {
        let want = below(*x);
        (want - i as f64 / n).abs().max(((i + 1) as f64 / n - want).abs())
    };
    values.iter().enumerate().map(off).fold(0.0, f64::max)
}

#[test]
fn uniform_draws_fill_their_range_evenly() {
    let folder = Folder::new("uniform");
    let text = format!("seeds = {COUNT}\n[vary]\n\"wind.speed\" = {{ uniform = [2.0, 6.0] }}");
    let values = numbers(&folder.campaign(&text), "wind.speed");
    assert!(values.iter().all(|x| (2.0..=6.0).contains(x)));
    // One in ten thousand sets of draws would be farther off.
    assert!(distance(values, |x| (x - 2.0) / 4.0) < 2.2 / (COUNT as f64).sqrt());
}

#[test]
fn normal_draws_have_their_mean_and_deviation_and_stay_within_their_clip() {
    let folder = Folder::new("normal");
    let text = format!(
        "seeds = {COUNT}\n[vary]\n\"vehicle.mass\" = {{ normal = [1.5, 0.1] }}\n\"wind.speed\" = {{ normal = [2.0, 2.0], clip = [0.0, 5.0] }}"
    );
    let campaign = folder.campaign(&text);
    let (mean, sd) = mean_and_sd(&numbers(&campaign, "vehicle.mass"));
    // Four standard errors.
    let error = 0.1 / (COUNT as f64).sqrt();
    assert!((mean - 1.5).abs() < 4.0 * error, "{mean}");
    assert!((sd - 0.1).abs() < 4.0 * error / 2.0_f64.sqrt(), "{sd}");
    let within = |values: &[f64], by: f64| {
        values.iter().filter(|x| (*x - 1.5).abs() < by).count() as f64 / COUNT as f64
    };
    assert!((within(&numbers(&campaign, "vehicle.mass"), 0.1) - 0.683).abs() < 0.04);
    assert!((within(&numbers(&campaign, "vehicle.mass"), 0.2) - 0.954).abs() < 0.02);
    let winds = numbers(&campaign, "wind.speed");
    assert!(winds.iter().all(|x| (0.0..=5.0).contains(x)));
    // A sixth of them lies below one deviation, and is set to the bound.
    let at_bound = winds.iter().filter(|x| **x == 0.0).count() as f64 / COUNT as f64;
    assert!((at_bound - 0.159).abs() < 0.04, "{at_bound}");
}

#[test]
fn a_latin_hypercube_draws_each_equal_part_of_each_range_once() {
    let folder = Folder::new("hypercube");
    let campaign = folder.campaign(
        "seeds = 64\nsampling = \"latin-hypercube\"\n[vary]\n\"wind.speed\" = { uniform = [0.0, 6.4] }\n\"sensors.warm_up\" = { uniform = [0.0, 6.4] }\n\"vehicle.mass\" = { normal = [1.5, 0.1] }",
    );
    let part = |x: &f64| (x * 10.0).floor() as usize;
    let (a, b) = (numbers(&campaign, "wind.speed"), numbers(&campaign, "sensors.warm_up"));
    for values in [&a, &b] {
        let mut parts: Vec<_> = values.iter().map(part).collect();
        assert!(parts.iter().zip(0..).any(|(part, i)| *part != i), "the parts are in order");
        parts.sort_unstable();
        assert!(parts.into_iter().eq(0..64));
    }
    assert!(a.iter().zip(&b).filter(|(x, y)| part(x) == part(y)).count() < 8, "keys move together");
    let (mean, _) = mean_and_sd(&numbers(&campaign, "vehicle.mass"));
    // Each part of the probability once: far closer than 64 draws on their own.
    assert!((mean - 1.5).abs() < 0.002, "{mean}");
}

#[test]
fn several_grids_are_flown_in_every_combination_with_every_seed() {
    let folder = Folder::new("grid");
    let campaign = folder.campaign(
        "first_seed = 7\nseeds = 2\n[vary]\n\"tether.model\" = { grid = [\"straight\", \"chain\"] }\n\"wind.gusts\" = { grid = [false, true] }\n\"params.TET_TENSION\" = { grid = [5, 6.5, 8] }\n\"vehicle.mass\" = { normal = [1.5, 0.1] }",
    );
    assert_eq!(campaign.flights(), 24);
    let mut seen = std::collections::BTreeSet::new();
    for index in 0..24 {
        let drawn = campaign.drawn(index);
        let point: Vec<_> = drawn.iter().filter(|(name, _)| *name != "vehicle.mass").collect();
        assert!(seen.insert(format!("{} {point:?}", campaign.seed(index))), "{point:?} again");
        // One seed has one mass, whatever the grid.
        let first = if campaign.seed(index) == 7 { 0 } else { 12 };
        let mass = |index| campaign.scenario(index).unwrap().vehicle.mass;
        assert_eq!(mass(index).to_bits(), mass(first).to_bits());
        assert!((campaign.seed(index) == 7) == (index < 12));
    }
}

#[test]
fn a_draw_depends_on_seed_key_and_index_and_on_nothing_else() {
    let folder = Folder::new("alone");
    let campaign = folder.campaign(SPREAD);
    let drawn = |campaign: &Campaign, index| format!("{:?}", campaign.drawn(index));
    let forwards: Vec<_> = (0..6).map(|index| drawn(&campaign, index)).collect();
    let backwards: Vec<_> =
        (0..6).rev().map(|index| drawn(&folder.campaign(SPREAD), index)).collect();
    assert!(forwards.iter().eq(backwards.iter().rev()));
    let wind = |text: &str| numbers(&folder.campaign(text), "wind.speed");
    let one = "[vary]\n\"wind.speed\" = { uniform = [0.0, 4.0] }\n";
    let two = format!("{one}\"sensors.warm_up\" = {{ uniform = [0.0, 4.0] }}\n");
    let alone = wind(&format!("seeds = 5\n{one}"));
    assert_eq!(alone, wind(&format!("seeds = 5\n{two}")), "one more key moves the others");
    assert_eq!(alone[..3], wind(&format!("seeds = 3\n{one}")), "fewer seeds move the draws");
    assert_ne!(alone, wind(&format!("first_seed = 2\nseeds = 5\n{one}")));
    assert_ne!(alone, numbers(&folder.campaign(&format!("seeds = 5\n{two}")), "sensors.warm_up"));
}

#[test]
fn any_key_of_a_scenario_can_vary_and_a_preset_yields_to_it() {
    let folder = Folder::new("keys");
    let text = format!(
        "[vehicle]\npreset = \"quad-3.5\"\ninertia = [0.06, 0.06, 0.11]\n[[fault]]\nkind = \"wind_north\"\nvalue = 1.0\n{}",
        super::folder::QUICK.replace("[params]\n", "[params]\nTET_TENSION = 9\n")
    );
    folder.write("quick.toml", &text);
    let campaign = folder.campaign(
        "seeds = 1\n[vary]\n\"vehicle.mass\" = { grid = [3.0] }\n\"vehicle.inertia[1]\" = { grid = [0.07] }\n\"fault[0].value\" = { uniform = [2.0, 3.0] }\n\"mission[1].altitude\" = { grid = [1.2] }\n[vary.params]\nTET_TENSION = { grid = [10] }",
    );
    let Err(e) = folder.try_campaign("seeds = 1\n[vary]\n\"vehicle.inertia[1]\" = { grid = [-1] }")
    else {
        panic!("accepted")
    };
    assert!(e.contains("vehicle.inertia[1]"), "{e}");
    let scenario = campaign.scenario(0).unwrap();
    assert_eq!(scenario.vehicle.mass, 3.0);
    assert_eq!(scenario.vehicle.inertia, [0.06, 0.07, 0.11]);
    assert_eq!(scenario.vehicle.arm, 0.23, "of the preset");
    assert_eq!(scenario.params["TET_TENSION"], 10.0);
    assert!((2.0..=3.0).contains(&scenario.fault[0].value));
    assert!(campaign.scenario_text(0).unwrap().contains("altitude = 1.2"));
}
