//! Lupashin and D'Andrea's figures: sensitivity of one reading, poles, the loop in a plane and in space.

mod planar;
mod poles;
mod reading;
mod space;

pub use planar::{add_loop, planar_loop};
pub use poles::{add_poles, poles};
pub use reading::{monte_carlo, sensitivities};
pub use space::{add_space, space};
