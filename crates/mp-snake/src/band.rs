//! The linear system of one semi-implicit step: symmetric, positive definite, five bands.

/// The matrix `I + a·T + b·T²` of `n` rows, factorised as `L·D·Lᵀ`; `T` is the tridiagonal matrix of second
/// differences (2 on the diagonal, −1 beside it) of a curve whose ends are fixed.
///
/// `T` is the second variation of the membrane energy `½·Σ|vᵢ₊₁ − vᵢ|²`, and `T²` that of the thin plate
/// `½·Σ|vᵢ₋₁ − 2vᵢ + vᵢ₊₁|²` whose ends are free to turn. The factorisation takes O(n) operations, as does
/// solving for one column.
///
/// ```
/// use mp_snake::Band;
/// // No stiffness: the identity.
/// let mut x = [1.0, 2.0, 3.0];
/// Band::new(3, 0.0, 0.0).solve(&mut x, 1);
/// assert_eq!(x, [1.0, 2.0, 3.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// 1 / D.
    inverse: Vec<f64>,
    /// First and second band of L below the diagonal.
    below: Vec<[f64; 2]>,
}

impl Band {
    /// The matrix of `n` rows for `a` ≥ 0 and `b` ≥ 0, which must be finite.
    #[must_use]
    pub fn new(n: usize, a: f64, b: f64) -> Self {
        let mut band = Self { inverse: Vec::with_capacity(n), below: Vec::with_capacity(n) };
        let mut diagonal: Vec<f64> = Vec::with_capacity(n);
        for i in 0..n {
            // The diagonal of T² is 5 in the corners and 6 elsewhere, but 4 for a single row.
            let beside = f64::from(u8::from(i > 0) + u8::from(i + 1 < n));
            let mut d = 1.0 + 2.0 * a + (4.0 + beside) * b;
            let mut first = -a - 4.0 * b;
            // Subtracts the contributions of the columns before.
            if let Some(j) = i.checked_sub(2) {
                d -= diagonal[j] * band.below[j][1] * band.below[j][1];
            }
            if let Some(j) = i.checked_sub(1) {
                d -= diagonal[j] * band.below[j][0] * band.below[j][0];
                first -= diagonal[j] * band.below[j][0] * band.below[j][1];
            }
            diagonal.push(d);
            band.inverse.push(1.0 / d);
            band.below.push([first / d, b / d]);
        }
        band
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inverse.len()
    }

    /// Whether there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inverse.is_empty()
    }

    /// Replaces each of `width` columns by the solution for it. `columns` holds row after row.
    ///
    /// # Panics
    /// When there are not `len · width` numbers.
    pub fn solve(&self, columns: &mut [f64], width: usize) {
        let n = self.len();
        assert_eq!(columns.len(), n * width, "a right-hand side of {n} rows and {width} columns");
        match width {
            1 => self.solve_columns::<1>(columns),
            2 => self.solve_columns::<2>(columns),
            3 => self.solve_columns::<3>(columns),
            6 => self.solve_columns::<6>(columns),
            _ => (0..width).for_each(|k| self.solve_column(columns, width, k)),
        }
    }

    /// Solves for all columns at once: the compiler unrolls the loops over them.
    fn solve_columns<const W: usize>(&self, columns: &mut [f64]) {
        let (rows, _) = columns.as_chunks_mut::<W>();
        let ([mut last, mut before], mut below) = ([[0.0; W]; 2], [[0.0; 2]; 2]);
        for (row, &next) in rows.iter_mut().zip(&self.below) {
            for k in 0..W {
                row[k] -= below[0][0] * last[k] + below[1][1] * before[k];
            }
            (before, last) = (last, *row);
            below = [next, below[0]];
        }
        let [mut next, mut after] = [[0.0; W]; 2];
        for ((row, &inverse), below) in rows.iter_mut().zip(&self.inverse).zip(&self.below).rev() {
            for k in 0..W {
                row[k] = row[k] * inverse - below[0] * next[k] - below[1] * after[k];
            }
            (after, next) = (next, *row);
        }
    }

    fn solve_column(&self, columns: &mut [f64], width: usize, k: usize) {
        let ([mut last, mut before], mut below) = ([0.0; 2], [[0.0; 2]; 2]);
        for (row, &next) in columns.chunks_exact_mut(width).zip(&self.below) {
            row[k] -= below[0][0] * last + below[1][1] * before;
            (before, last) = (last, row[k]);
            below = [next, below[0]];
        }
        let [mut next, mut after] = [0.0; 2];
        for ((row, &inverse), below) in
            columns.chunks_exact_mut(width).zip(&self.inverse).zip(&self.below).rev()
        {
            row[k] = row[k] * inverse - below[0] * next - below[1] * after;
            (after, next) = (next, row[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    fn dense(n: usize, a: f64, b: f64) -> DMatrix<f64> {
        let t = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        DMatrix::identity(n, n) + &t * a + &t * &t * b
    }

    proptest! {
        #[test]
        fn agrees_with_a_dense_solve(
            n in 1..40_usize,
            a in 0.0..100.0_f64,
            b in 0.0..1000.0_f64,
            values in prop::collection::vec(-10.0..10.0_f64, 120),
        ) {
            let matrix = dense(n, a, b);
            let band = Band::new(n, a, b);
            let lu = matrix.clone().lu();
            let mut columns = values[..3 * n].to_vec();
            band.solve(&mut columns, 3);
            for k in 0..3 {
                let right = DVector::from_fn(n, |i, _| values[3 * i + k]);
                let expected = lu.solve(&right).unwrap();
                for i in 0..n {
                    let found = columns[3 * i + k];
                    prop_assert!((found - expected[i]).abs() <= 1e-9 * (1.0 + expected.amax()), "{} {}", found, expected[i]);
                }
            }
        }
    }
}
