//! Where does the tether point, from accelerometer, gyro and thrust alone? `inertial`, after Lupashin
//! and D'Andrea.
//!
//! [`locate`] solves one reading; [`TetherAngleUkf`] filters a vertical plane; [`TetherAngles`] joins two
//! planes. None of them needs a position, a magnetometer or a force sensor; all of them need the thrust:
//! 4 % of error there is 4 to 7° of tether angle.

mod flight;
mod minimal;
mod spatial;
mod ukf;

pub use flight::{
    TetherAngleEstimate, TetherAngleEstimator, TetherAngleEstimatorState, plane_angles,
};
pub use minimal::{Located, NotLocated, TENSION_FLOOR, locate};
pub use spatial::{PlaneReading, TetherAngles, TetherAnglesState, TiltFrame};
pub use ukf::{Corrected, Posterior, TetherAngleState, TetherAngleUkf, UkfStage};
