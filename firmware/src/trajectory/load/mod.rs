//! Where the load on a rod shall be: references with the five derivatives that the backstepping law
//! needs. `pendulum` section 5.

mod circle;
mod fade_in;
mod line;
mod soft_start;

pub use circle::TiltedCircle;
pub use fade_in::FadeIn;
pub use line::LoadMove;
pub use soft_start::SoftStart;
