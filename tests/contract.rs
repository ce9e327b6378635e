//! The same checks over every estimator and controller of the core, one row each, in `f32`.
//!
//! A block either refuses a number that is not finite and leaves its state bit for bit, or leaves the
//! number out and stays finite, as its row says. Those that check nothing stand in the table by name, with
//! what protects them. The same input gives the same bits; a covariance is symmetric and positive definite
//! after thousands of noisy steps.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

mod blocks;

use blocks::{Block, Row, Rule, rows};
use tautline_sitl::plant::{generator, uniform};

const STEPS: usize = 5000;

/// Nominal input with noise, the same for the same step.
fn inputs(row: &Row, steps: usize) -> Vec<Vec<f32>> {
    let mut rng = generator(11, 3);
    let noisy = |rng: &mut _, &(nominal, noise): &(f32, f32)| nominal + noise * uniform(rng) as f32;
    (0..steps).map(|_| row.input.iter().map(|x| noisy(&mut rng, x)).collect()).collect()
}

/// A block after some steps of its nominal, noisy input.
fn warm(row: &Row, inputs: &[Vec<f32>]) -> Box<dyn Block> {
    let mut block = (row.make)();
    for z in inputs {
        block.step(z).unwrap_or_else(|fault| panic!("{}: {fault:?} for {z:?}", row.name));
    }
    block
}

/// A number in a debug text that is not finite.
fn is_finite(text: &str) -> bool {
    let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
    !words.any(|word| word == "NaN" || word == "inf")
}

#[test]
fn a_number_that_is_not_finite_is_refused_or_left_out_as_the_row_says() {
    let mut failures = Vec::new();
    for row in rows() {
        let start = inputs(&row, 200);
        let good = start.last().unwrap();
        for at in 0..row.input.len() {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut block = warm(&row, &start);
                let before = block.state();
                let mut z = good.clone();
                z[at] = bad;
                let result = block.step(&z);
                let case = format!("{}: {bad} as input {at}", row.name);
                match row.rule {
                    Rule::Refuses => {
                        if result.is_ok() {
                            failures.push(format!("{case}: not refused"));
                        } else if block.state() != before {
                            failures.push(format!("{case}: refused, but the state moved"));
                        }
                    }
                    Rule::LeavesOut => {
                        let output = result.unwrap_or_default();
                        if !is_finite(&block.state()) || !is_finite(&output) {
                            failures.push(format!("{case}: {} {output}", block.state()));
                        } else if block.step(good).is_err() {
                            failures.push(format!("{case}: refuses what comes after"));
                        }
                    }
                    Rule::Trusts(_) => {}
                }
            }
        }
    }
    failures.dedup_by_key(|text| text.split(':').next().map(str::to_owned));
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn blocks_that_check_nothing_are_named_with_what_protects_them() {
    for row in rows() {
        if let Rule::Trusts(why) = row.rule {
            println!("{}: {why}", row.name);
            assert!(why.len() > 10, "{}", row.name);
            // An exemption that nobody needs any more shall go.
            let start = inputs(&row, 200);
            let needs_it = (0..row.input.len()).any(|at| {
                let mut block = warm(&row, &start);
                let mut z = start.last().unwrap().clone();
                z[at] = f32::NAN;
                let output = block.step(&z).unwrap_or_default();
                !is_finite(&block.state()) || !is_finite(&output)
            });
            assert!(needs_it, "{}: withstands every NaN", row.name);
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bits() {
    for row in rows() {
        let inputs = inputs(&row, 500);
        let run = || -> Vec<String> {
            let mut block = (row.make)();
            let step = |z: &Vec<f32>| block.step(z).unwrap() + &block.state();
            inputs.iter().map(step).collect()
        };
        let (first, second) = (run(), run());
        assert_eq!(first, second, "{}", row.name);
        assert!(first.iter().all(|text| is_finite(text)), "{}", row.name);
        assert!(first[0] != first[1] || first[1] != first[2], "{}: a constant", row.name);
    }
}

#[test]
fn covariances_stay_symmetric_and_positive_definite() {
    let mut seen = 0;
    for row in rows() {
        let mut block = (row.make)();
        if block.covariance().is_none() {
            continue;
        }
        seen += 1;
        for (k, z) in inputs(&row, STEPS).iter().enumerate() {
            block.step(z).unwrap();
            if k % 100 != 99 {
                continue;
            }
            let p = block.covariance().unwrap();
            let name = format!("{} after {} steps", row.name, k + 1);
            assert!(p.diagonal().iter().all(|v| *v > 0.0), "{name}: {}", p.diagonal());
            // Each state in its own deviations, or its unit would decide.
            let scale = nalgebra::DMatrix::from_diagonal(&p.diagonal().map(|v| v.sqrt().recip()));
            let p = &scale * p * &scale;
            // The unscented filter multiplies in another order above the diagonal than below; its roots read
            // the lower half alone, so that the last bit never adds up. All others are symmetric to the bit.
            let asymmetry = (&p - p.transpose()).abs().max();
            assert!(
                asymmetry < 4.0 * f64::from(f32::EPSILON),
                "{name}: asymmetric by {asymmetry:e}"
            );
            let least = p.symmetric_eigenvalues().min();
            assert!(least > 0.0, "{name}: smallest eigenvalue {least:e}");
        }
    }
    assert!(seen >= 6, "{seen} blocks with a covariance");
}
