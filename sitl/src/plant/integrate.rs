//! The one integrator of the small plants.

/// One Runge–Kutta step of fourth order over `dt`.
pub fn runge_kutta<const N: usize>(
    x: [f64; N],
    dt: f64,
    rate: impl Fn(&[f64; N]) -> [f64; N],
) -> [f64; N] {
    let along = |k: &[f64; N], h: f64| {
        let mut y = x;
        y.iter_mut().zip(k).for_each(|(y, k)| *y += h * k);
        y
    };
    let k1 = rate(&x);
    let k2 = rate(&along(&k1, dt / 2.0));
    let k3 = rate(&along(&k2, dt / 2.0));
    let k4 = rate(&along(&k3, dt));
    let mut sum = k1;
    for (sum, ((k2, k3), k4)) in sum.iter_mut().zip(k2.iter().zip(&k3).zip(&k4)) {
        *sum += 2.0 * (k2 + k3) + k4;
    }
    along(&sum, dt / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_oscillator_keeps_its_phase_to_fourth_order() {
        let turn = |steps: u32| {
            let dt = 1.0 / f64::from(steps);
            let end = (0..steps).fold([1.0, 0.0], |x, _| runge_kutta(x, dt, |[p, v]| [*v, -p]));
            (end[0] - 1.0_f64.cos()).abs()
        };
        // Half the step, a sixteenth of the error.
        let order = (turn(20) / turn(40)).log2();
        assert!((order - 4.0).abs() < 0.2, "{order}");
    }
}
