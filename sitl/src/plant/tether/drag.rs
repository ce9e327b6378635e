//! Air on a round line: a share across it and a small one along it.

use super::super::V3;

/// 0.5 ρ Cd of a cylinder across the flow, kg/m³.
const ACROSS: f64 = 0.5 * 1.2 * 1.2;
/// Skin friction along the line, as a share of that.
const ALONG: f64 = 0.02;

/// Force on `length` m of a line along the unit vector `u` that moves at `air` m/s against the air, N.
#[inline(always)]
pub fn drag(diameter: f64, length: f64, u: &V3, air: &V3) -> V3 {
    let along = air.dot(u);
    let across = air - u * along;
    let whole = -diameter * length * ACROSS;
    across * (whole * across.norm()) + u * (whole * ALONG * along * along.abs())
}
