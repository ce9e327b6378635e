//! A mass on a line that weighs, pushed about by given forces: its path, for others to fly after.
//!
//! `--plot DIR` writes the forces and the path; `tests/clients/mujoco_line.py` flies the same in MuJoCo.

use super::{Compare, Overrides, Picture, Report};
use crate::plant::{Chain, End, GRAVITY, Material, V3};
use std::f64::consts::TAU;
use std::fs;

/// Of the line: m, kg/m; straight up at the start.
const LENGTH: f64 = 25.0;
const DENSITY: f64 = 0.03;
const SEGMENTS: usize = 10;
/// kg.
const MASS: f64 = 3.5;
/// s.
const DURATION: f64 = 60.0;
const STEP: f64 = 5e-4;
/// Steps per row of the file: 100 Hz.
const EVERY: usize = 20;
/// Of the middle of the line when it stands straight, N.
const TENSION: f64 = 15.0;

/// Thrust on the mass, N: it lifts mass and line with some tension and leans about; from rest, gently.
fn thrust(time: f64) -> V3 {
    let begin = (time / 5.0).min(1.0);
    let lean = |amplitude: f64, period: f64| begin * amplitude * (TAU * time / period).sin();
    let lift = (MASS + 0.5 * DENSITY * LENGTH) * GRAVITY + TENSION;
    V3::new(lean(4.0, 9.0), lean(3.0, 6.5), -lift - lean(3.0, 11.0))
}

/// Time, thrust and place.
type Row = [f64; 7];

fn fly() -> Vec<Row> {
    let material = Material { density: DENSITY, stiffness: 1e5, relaxation: 5e-3, diameter: 0.0 };
    let base = V3::new(0.0, 0.0, -2.0);
    let (mut position, mut velocity) = (base - V3::z() * LENGTH, V3::zeros());
    let start = position;
    let mut chain = Chain::new(SEGMENTS, LENGTH, |share| base + (start - base) * share);
    let steps = (DURATION / STEP).round() as usize;
    let mut rows = Vec::with_capacity(steps / EVERY);
    for step in 0..steps {
        let force = thrust(step as f64 * STEP);
        if step.is_multiple_of(EVERY) {
            let [f, p]: [[f64; 3]; 2] = [force.into(), position.into()];
            rows.push([step as f64 * STEP, f[0], f[1], f[2], p[0], p[1], p[2]]);
        }
        let end = End { position, velocity, force, mass: MASS, turns: 0.0, down: V3::z() };
        chain.step(&material, None, (base, V3::zeros()), &end, &|_| V3::zeros(), STEP);
        let mass = MASS + chain.end_mass(DENSITY);
        velocity += ((force + chain.end_force()) / mass + V3::z() * GRAVITY) * STEP;
        position += velocity * STEP;
    }
    rows
}

/// Flies it and says how far it goes.
pub fn run(settings: &Overrides) -> Result<Report, String> {
    settings.no_settings()?;
    let rows = fly();
    let mut report = Report::default();
    let farthest = rows.iter().map(|row| row[4].hypot(row[5])).fold(0.0, f64::max);
    report.add("farthest from above the anchor, m", farthest, Compare::Alone);
    let stretched = rows.iter().map(|row| row[4].hypot(row[5]).hypot(row[6] + 2.0) / LENGTH);
    report.add(
        "longest chord over the length",
        stretched.fold(0.0, f64::max),
        Compare::AtMost(1.01),
    );
    let write = move |path: &std::path::Path| -> Result<(), Box<dyn std::error::Error>> {
        let mut text = format!("# length_m={LENGTH} density_kgpm={DENSITY} mass_kg={MASS}\n");
        text += "time_s,thrust_n,thrust_e,thrust_d,north,east,down\n";
        for row in &rows {
            text += &row.map(|x| format!("{x:.6}")).join(",");
            text.push('\n');
        }
        Ok(fs::write(path, text)?)
    };
    report.pictures.push(Picture { name: "line-path.csv", draw: Box::new(write) });
    Ok(report)
}
