//! The elastic line at rest, `fullstate` section 22: what the simulator's chain comes to.

use super::{Check, cases, list, num};
use serde_json::Value;

/// Horizontal and upward force on the upper end, N, of `length` m of unstretched line from the origin to `across`
/// and `up` m away; `weight` N/m, `stiffness` N over strain.
pub fn solve(across: f64, up: f64, length: f64, weight: f64, stiffness: f64) -> [f64; 2] {
    let ends = |h: f64, v: f64| {
        let (top, low) = (v / h, (v - weight * length) / h);
        [
            h * length / stiffness + h / weight * (top.asinh() - low.asinh()),
            length * (v - weight * length / 2.0) / stiffness
                + h / weight * (top.hypot(1.0) - low.hypot(1.0)),
        ]
    };
    // From the weightless line's force: as if taut, Newton's steps with a halving search.
    let (mut h, mut v) = (1.0, up / across + weight * length / 2.0);
    let miss = |h: f64, v: f64| {
        let [x, z] = ends(h, v);
        [x - across, z - up]
    };
    for _ in 0..200 {
        let [x, z] = miss(h, v);
        let size = x.hypot(z);
        if size < 1e-13 {
            break;
        }
        let step = 1e-6;
        let ([xh, zh], [xv, zv]) = (miss(h * (1.0 + step), v), miss(h, v + h * step));
        let (a, c) = ((xh - x) / (h * step), (zh - z) / (h * step));
        let (b, d) = ((xv - x) / (h * step), (zv - z) / (h * step));
        let determinant = a * d - b * c;
        let (dh, dv) = ((b * z - d * x) / determinant, (c * x - a * z) / determinant);
        let mut share = 1.0;
        while share > 1e-9 {
            let (next_h, next_v) = (h + share * dh, v + share * dv);
            if next_h > 0.0 {
                let [x, z] = miss(next_h, next_v);
                if x.hypot(z) < size {
                    (h, v) = (next_h, next_v);
                    break;
                }
            }
            share *= 0.5;
        }
    }
    [h, v]
}

pub fn check(file: &Value) {
    // Relative to a solution that its own tolerance leaves at 1e-10.
    let mut check = Check::new(1e-8);
    for (name, c) in cases(file, "catenary") {
        let of = |key: &str| num(c, key);
        check.all(&name, solve(of("X"), of("Z"), of("S"), of("w"), of("EA")), list(c, "HV"));
    }
}
