//! How sure is a figure of so many flights? Intervals that hold the true one in 95 of 100 campaigns.

/// Quantile of the normal distribution.
const Z: f64 = 1.96;

/// A figure between its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub least: f64,
    /// The figure itself.
    pub middle: f64,
    /// Upper bound.
    pub most: f64,
}

impl Interval {
    /// Root mean square of values, by the scatter of their squares; `None` for fewer than two.
    #[must_use]
    pub fn of_rms(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        if count < 2.0 {
            return None;
        }
        let squares = || values.iter().map(|x| x * x);
        let mean = squares().sum::<f64>() / count;
        let scatter = squares().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let half = quantile(count - 1.0) * (scatter / count).sqrt();
        let root = |x: f64| x.max(0.0).sqrt();
        Some(Self { least: root(mean - half), middle: root(mean), most: root(mean + half) })
    }

    /// Share of `count` trials in which it happened, after Wilson.
    #[must_use]
    pub fn of_share(happened: usize, count: usize) -> Self {
        let (k, n) = (happened as f64, count.max(1) as f64);
        let (share, square) = (k / n, Z * Z);
        let middle = (share + square / (2.0 * n)) / (1.0 + square / n);
        let half =
            Z / (1.0 + square / n) * (share * (1.0 - share) / n + square / (4.0 * n * n)).sqrt();
        Self { least: (middle - half).max(0.0), middle: share, most: (middle + half).min(1.0) }
    }
}

/// Of Student's distribution, by its expansion about the normal one.
fn quantile(freedom: f64) -> f64 {
    Z + (Z.powi(3) + Z) / (4.0 * freedom)
        + (5.0 * Z.powi(5) + 16.0 * Z.powi(3) + 3.0 * Z) / (96.0 * freedom * freedom)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_is_wider_than_the_normal_distribution_for_few_flights() {
        // Tables: 2.228 for 10, 2.042 for 30.
        assert!((quantile(10.0) - 2.228).abs() < 0.01);
        assert!((quantile(30.0) - 2.042).abs() < 0.002);
    }

    #[test]
    fn equal_flights_leave_no_doubt_and_one_flight_leaves_all() {
        let sure = Interval::of_rms(&[0.2; 5]).unwrap();
        assert!((sure.least - 0.2).abs() < 1e-9 && (sure.most - 0.2).abs() < 1e-9);
        assert_eq!(Interval::of_rms(&[0.2]), None);
    }

    #[test]
    fn no_loss_in_a_hundred_flights_still_leaves_four_per_cent() {
        let none = Interval::of_share(0, 100);
        assert!(none.least == 0.0 && none.middle == 0.0);
        assert!((none.most - 0.037).abs() < 0.001, "{}", none.most);
        let half = Interval::of_share(50, 100);
        assert!((half.least - 0.404).abs() < 0.001 && (half.most - 0.596).abs() < 0.001);
    }
}
