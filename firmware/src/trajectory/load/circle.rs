//! A tilted circle at constant speed: the article's reference (68), (69).

use crate::fault::{Invalid, not_negative, positive};
use crate::frames::{V3, World};
use crate::scalar::Scalar;
use crate::signal::LoadReference;

/// `centre + (radius cos θ, radius sin θ, rise sin θ)`, world axes (down positive).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedCircle<S: Scalar> {
    centre: World<V3<S>>,
    radius: S,
    rise: S,
    speed: S,
}

impl<S: Scalar> TiltedCircle<S> {
    /// `centre`, `radius` and `rise` in m, `speed` along the path in m/s.
    ///
    /// # Errors
    /// [`Invalid`] naming the setting.
    pub fn try_new(centre: World<V3<S>>, radius: S, rise: S, speed: S) -> Result<Self, Invalid> {
        if centre.0.iter().any(|x| !x.is_finite()) {
            return Err(Invalid { field: "centre", must: "finite" });
        }
        Ok(Self {
            centre,
            radius: positive("radius", radius)?,
            rise: not_negative("rise", rise)?,
            speed: not_negative("speed", speed)?,
        })
    }

    /// The article's: 0.8 m wide, 0.5 m up and down, 1.6 m above the origin.
    #[must_use]
    pub fn article(speed: S) -> Self {
        Self {
            centre: World(V3::new(S::zero(), S::zero(), S::lit(-1.6))),
            radius: S::lit(0.8),
            rise: S::lit(0.5),
            speed,
        }
    }

    /// The same circle elsewhere.
    #[must_use]
    pub fn around(&self, centre: World<V3<S>>) -> Self {
        Self { centre, ..*self }
    }

    /// Square of the path's length per angle, m², and its first four derivatives by the angle.
    fn stretch(&self, sin2: S, cos2: S) -> [S; 5] {
        let a = self.rise * self.rise;
        let two_a = a + a;
        [
            self.radius * self.radius + a * S::lit(0.5) * (S::one() + cos2),
            -a * sin2,
            -two_a * cos2,
            two_a * S::lit(2.0) * sin2,
            two_a * S::lit(4.0) * cos2,
        ]
    }

    /// Angular speed at an angle, rad/s (69).
    #[must_use]
    pub fn angular_speed(&self, angle: S) -> S {
        let (sin2, cos2) = (angle + angle).sin_cos();
        let [s, ..] = self.stretch(sin2, cos2);
        self.speed / s.sqrt()
    }

    /// The angle `dt` s later, in [0, 2π): one Runge–Kutta step of fourth order.
    #[must_use]
    pub fn advance(&self, angle: S, dt: S) -> S {
        let half = dt * S::lit(0.5);
        let k1 = self.angular_speed(angle);
        let k2 = self.angular_speed(angle + k1 * half);
        let k3 = self.angular_speed(angle + k2 * half);
        let k4 = self.angular_speed(angle + k3 * dt);
        let next = angle + (k1 + (k2 + k3) * S::lit(2.0) + k4) * (dt * S::lit(1.0 / 6.0));
        let turn = S::lit(core::f64::consts::TAU);
        if next >= turn { next - turn } else { next }
    }

    /// Position and five time derivatives at an angle.
    #[must_use]
    pub fn at(&self, angle: S) -> LoadReference<S> {
        let k = S::lit;
        let (sin, cos) = angle.sin_cos();
        let (sin2, cos2) = (angle + angle).sin_cos();
        let [s, s1, s2, s3, s4] = self.stretch(sin2, cos2);
        let i = S::one() / s;
        let (r1, r2, r3, r4) = (s1 * i, s2 * i, s3 * i, s4 * i);
        // F = θ̈ as a function of θ, and its derivatives by θ.
        let h = -self.speed * self.speed * k(0.5) * i;
        let f = h * r1;
        let f1 = h * (r2 - k(2.0) * r1 * r1);
        let f2 = h * (r3 - k(6.0) * r1 * r2 + k(6.0) * r1 * r1 * r1);
        let f3 = h
            * (r4 - (k(8.0) * r1 * r3 + k(6.0) * r2 * r2) + k(36.0) * r1 * r1 * r2
                - k(24.0) * r1 * r1 * r1 * r1);
        let t1 = self.speed / s.sqrt();
        let t2 = f;
        let t3 = f1 * t1;
        let t4 = f2 * t1 * t1 + f1 * t2;
        let t5 = f3 * t1 * t1 * t1 + k(3.0) * f2 * t1 * t2 + f1 * t3;

        let around = V3::new(self.radius * cos, self.radius * sin, self.rise * sin);
        let p1 = V3::new(-self.radius * sin, self.radius * cos, self.rise * cos);
        let (p2, p3, p4, p5) = (-around, -p1, around, p1);
        let t1_2 = t1 * t1;
        let t1_3 = t1_2 * t1;
        LoadReference([
            self.centre.0 + around,
            p1 * t1,
            p2 * t1_2 + p1 * t2,
            p3 * t1_3 + p2 * (k(3.0) * t1 * t2) + p1 * t3,
            p4 * (t1_3 * t1)
                + p3 * (k(6.0) * t1_2 * t2)
                + p2 * (k(3.0) * t2 * t2 + k(4.0) * t1 * t3)
                + p1 * t4,
            p5 * (t1_3 * t1_2)
                + p4 * (k(10.0) * t1_3 * t2)
                + p3 * (k(15.0) * t1 * t2 * t2 + k(10.0) * t1_2 * t3)
                + p2 * (k(10.0) * t2 * t3 + k(5.0) * t1 * t4)
                + p1 * t5,
        ])
    }
}
