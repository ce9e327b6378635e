//! ARX by least squares: Householder QR of the regressors.

use super::polynomial::Polynomial;
use super::prepare::Signals;
use nalgebra::{DMatrix, DVector};

/// `y = -Σ a y + ΣΣ b u` with `na` and `nb` coefficients and a delay of one sample.
///
/// # Errors
/// Inputs that do not excite all coefficients.
pub fn arx(data: &Signals, na: usize, nb: usize) -> Result<Polynomial, String> {
    let order = na.max(nb);
    let rows = data.len().saturating_sub(order);
    let columns = na + nb * data.inputs.len();
    if rows <= columns {
        return Err(format!("ARX: {rows} rows for {columns} coefficients"));
    }
    let regressors = DMatrix::from_fn(rows, columns, |r, c| {
        let t = r + order;
        if c < na {
            -data.output[t - 1 - c]
        } else {
            let (input, lag) = ((c - na) / nb, (c - na) % nb);
            data.inputs[input][t - 1 - lag]
        }
    });
    let target = DVector::from_iterator(rows, data.output[order..].iter().copied());
    let theta = least_squares(regressors, &target).ok_or("ARX: the inputs do not excite it")?;
    let mut values = theta.iter().copied();
    let mut take = |first: f64, count: usize| -> Vec<f64> {
        std::iter::once(first).chain(values.by_ref().take(count)).collect()
    };
    let a = take(1.0, na);
    let inputs = data.inputs.iter().map(|_| [take(0.0, nb), vec![1.0]]).collect();
    Ok(Polynomial { a, inputs, c: vec![1.0], d: vec![1.0] })
}

/// By QR; `None` where a column depends on the others.
#[must_use]
pub fn least_squares(a: DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let columns = a.ncols();
    let qr = a.qr();
    let r = qr.r();
    let largest = r.diagonal().amax();
    if !r.diagonal().iter().all(|x| x.abs() > 1e-12 * largest) {
        return None;
    }
    let mut rhs = b.clone();
    qr.q_tr_mul(&mut rhs);
    r.solve_upper_triangular(&rhs.rows(0, columns).into_owned())
}
