//! What the full-state filter estimates.

use super::covariance::{
    ACCEL_BIAS, BLOCKS, Blocks, Covariance, GUST, GYRO_BIAS, OFFSET, POSITION, SCALARS, TILT,
    VELOCITY, WIND,
};
use crate::fault::Fault;
use crate::frames::{Attitude, M3, V3};
use crate::math::so3;
use crate::scalar::Scalar;

/// Estimate and covariance (`fullstate` sections 1 and 18).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullState<S: Scalar> {
    /// Of the centre of mass from the anchor, world axes, m.
    pub position: V3<S>,
    /// World axes, m/s; over a moving anchor, against it.
    pub velocity: V3<S>,
    /// Body to world.
    pub attitude: Attitude<S>,
    /// Chord component of the line's pull on the vehicle, N.
    pub tension: S,
    /// True over commanded thrust.
    pub thrust_scale: S,
    /// Of the altimeter, m.
    pub altimeter_bias: S,
    /// Body axes, m/s².
    pub accel_bias: V3<S>,
    /// Body axes, rad/s.
    pub gyro_bias: V3<S>,
    /// Mean wind force over mass, world axes, m/s².
    pub wind: V3<S>,
    /// Gust force over mass, world axes, m/s².
    pub gust: V3<S>,
    /// Of a direction sensor, rad, or a position sensor, m.
    pub offset: [S; 2],
    /// Of the error, in the order of the covariance's file.
    pub covariance: Covariance<S>,
}

/// Standard deviations of a new estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartDeviation<S> {
    /// m.
    pub position: S,
    /// m/s.
    pub velocity: S,
    /// Roll and pitch, rad.
    pub tilt: S,
    /// rad.
    pub yaw: S,
    /// N.
    pub tension: S,
    /// True over commanded thrust.
    pub thrust_scale: S,
    /// m.
    pub altimeter_bias: S,
    /// m/s².
    pub accel_bias: S,
    /// rad/s, body axes.
    pub gyro_bias: V3<S>,
    /// Mean wind force over mass, level, m/s².
    pub wind_level: S,
    /// Mean wind force over mass, down, m/s².
    pub wind_down: S,
    /// Gust force over mass, m/s².
    pub gust: S,
    /// A sensor's offset, rad or m.
    pub offset: S,
}

impl<S: Scalar> StartDeviation<S> {
    /// `fullstate` sections 5 and 18.
    #[must_use]
    pub fn standard() -> Self {
        Self {
            position: S::lit(0.5),
            velocity: S::lit(0.2),
            tilt: S::lit(1.5 * DEGREE),
            yaw: S::lit(0.3 * DEGREE),
            tension: S::lit(1.5),
            thrust_scale: S::lit(0.04),
            altimeter_bias: S::lit(0.02),
            accel_bias: S::lit(0.05),
            gyro_bias: V3::repeat(S::lit(0.03 * DEGREE)),
            wind_level: S::lit(1.5),
            wind_down: S::lit(0.1),
            gust: S::lit(0.02),
            offset: S::zero(),
        }
    }

    fn blocks(&self) -> Blocks<S> {
        let all = |sd| V3::new(sd, sd, sd);
        let mut blocks = [V3::zeros(); BLOCKS];
        let each = [
            (POSITION, all(self.position)),
            (VELOCITY, all(self.velocity)),
            (TILT, V3::new(self.tilt, self.tilt, self.yaw)),
            (SCALARS, V3::new(self.tension, self.thrust_scale, self.altimeter_bias)),
            (ACCEL_BIAS, all(self.accel_bias)),
            (GYRO_BIAS, self.gyro_bias),
            (WIND, V3::new(self.wind_level, self.wind_level, self.wind_down)),
            (GUST, all(self.gust)),
            (OFFSET, V3::new(self.offset, self.offset, S::zero())),
        ];
        for (block, deviation) in each {
            if let Some(own) = blocks.get_mut(block) {
                *own = deviation;
            }
        }
        blocks
    }
}

const DEGREE: f64 = core::f64::consts::PI / 180.0;

impl<S: Scalar> FullState<S> {
    /// At a known place and attitude, at rest, in still air, with the given pull, N, and gyro bias, rad/s.
    #[must_use]
    pub fn at_rest(
        position: V3<S>,
        attitude: Attitude<S>,
        tension: S,
        gyro_bias: V3<S>,
        deviation: &StartDeviation<S>,
    ) -> Self {
        Self {
            position,
            velocity: V3::zeros(),
            attitude,
            tension,
            thrust_scale: S::one(),
            altimeter_bias: S::zero(),
            accel_bias: V3::zeros(),
            gyro_bias,
            wind: V3::zeros(),
            gust: V3::zeros(),
            offset: [S::zero(); 2],
            covariance: Covariance::from_deviations(&deviation.blocks()),
        }
    }

    /// Wind and gust force over mass, world axes, m/s².
    #[must_use]
    pub fn air_force(&self) -> V3<S> {
        self.wind + self.gust
    }

    /// Adds an error; the attitude's on the right, made a rotation again.
    ///
    /// # Errors
    /// [`Fault::NotFinite`]; the state is spoilt then.
    pub(super) fn inject(&mut self, error: &Blocks<S>) -> Result<(), Fault> {
        let [position, velocity, tilt, scalars, accel_bias, gyro_bias, wind, gust, offset] = error;
        self.position += position;
        self.velocity += velocity;
        self.turn(tilt)?;
        self.tension += scalars.x;
        self.thrust_scale += scalars.y;
        self.altimeter_bias += scalars.z;
        self.accel_bias += accel_bias;
        self.gyro_bias += gyro_bias;
        self.wind += wind;
        self.gust += gust;
        let [first, second] = &mut self.offset;
        *first += offset.x;
        *second += offset.y;
        Ok(())
    }

    /// Turns the attitude by a rotation vector in body axes, rad.
    pub(super) fn turn(&mut self, by: &V3<S>) -> Result<(), Fault> {
        self.attitude.0 =
            so3::orthonormal(&(self.attitude.0 * so3::exp(by))).ok_or(Fault::NotFinite)?;
        Ok(())
    }

    /// Turns all that is in world axes by a rotation about the vertical: no sensor of the line sees the difference.
    pub fn turn_world(&mut self, turn: &M3<S>) {
        self.attitude.0 = turn * self.attitude.0;
        for own in [&mut self.position, &mut self.velocity, &mut self.wind, &mut self.gust] {
            *own = turn * *own;
        }
        self.covariance.turn([POSITION, VELOCITY, WIND, GUST], turn);
    }

    /// Doubts the given blocks: they may be off by so much more.
    pub fn widen(&mut self, blocks: &[usize], by: &StartDeviation<S>) {
        let deviations = by.blocks();
        for &block in blocks {
            if let Some(sd) = deviations.get(block) {
                self.covariance.inflate(block, &sd.component_mul(sd));
            }
        }
    }

    /// Another altimeter, whose bias is not that of the one before: zero, by the given standard deviation, m.
    pub fn renew_altimeter(&mut self, sd: S) {
        let (o, one) = (S::zero(), S::one());
        self.altimeter_bias = o;
        self.covariance.scale(SCALARS, BLOCKS, &V3::new(one, one, o));
        self.covariance.inflate(SCALARS, &V3::new(o, o, sd * sd));
    }

    /// Whether every number of the estimate is finite, and every variance not negative.
    #[must_use]
    pub fn is_sound(&self, used: usize) -> bool {
        let vectors =
            [self.position, self.velocity, self.accel_bias, self.gyro_bias, self.wind, self.gust];
        let [first, second] = self.offset;
        let scalars = [self.tension, self.thrust_scale, self.altimeter_bias, first, second];
        vectors.iter().flat_map(|v| v.iter()).chain(&scalars).all(|x| x.is_finite())
            && self.attitude.0.iter().all(|x| x.is_finite())
            && self.covariance.is_sound(used)
    }
}
