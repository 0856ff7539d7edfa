//! The balance of light between patches, B = M + ρ F B, and its solution.
//!
//! # References
//! Goral, Torrance, Greenberg & Battaile 1984; Cohen & Greenberg 1985 (Gauss-Seidel).

use super::cover::Cover;
use nalgebra::{DMatrix, DVector};

/// The shares F: row i holds what part of the light that leaves patch i arrives at each patch. Rows sum to 1 where nothing is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFactors {
    count: usize,
    shares: Vec<f64>,
}

/// Why the light between patches has no balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the light between the surfaces never settles: a closed room whose surfaces absorb nothing"
)]
pub struct Unbalanced;

/// Patches up to which the system is solved by elimination: n³/3 operations, a fifth of a second. Above, sweeps of n² operations each win.
const ELIMINATED: usize = 600;

impl FormFactors {
    /// From rows one after another.
    ///
    /// # Panics
    /// If they are not square.
    pub fn new(count: usize, shares: Vec<f64>) -> Self {
        assert_eq!(shares.len(), count * count, "one share for each pair");
        Self { count, shares }
    }

    /// How many patches.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The shares of what leaves patch `from`.
    pub fn row(&self, from: usize) -> &[f64] {
        &self.shares[from * self.count..(from + 1) * self.count]
    }

    /// Makes the shares of each patch those of the part of it that is not covered, which is what other patches see: what stands on a patch hides the
    /// rest of it. Where that part sees fronts only they sum to 1, which takes away what quadrature misses; where it sees backs, which are black, or the
    /// open, what goes there stays lost, and they sum to 1 at most. A patch that is covered altogether is left as it is.
    ///
    /// # Panics
    /// If there is not one [`Cover`] for each patch.
    pub fn uncover(&mut self, covers: &[Cover]) {
        assert_eq!(covers.len(), self.count, "one cover for each patch");
        for (i, cover) in covers.iter().enumerate() {
            if cover.free <= 0.0 {
                continue;
            }
            let row = &mut self.shares[i * self.count..(i + 1) * self.count];
            let sum: f64 = row.iter().sum();
            let whole = if cover.enclosed {
                sum
            } else {
                sum.max(cover.free)
            };
            if whole > 0.0 {
                for share in row {
                    *share /= whole;
                }
            }
        }
    }

    /// The irradiance of each patch if patch j has the radiosity bⱼ: by reciprocity Σⱼ Fᵢⱼ bⱼ.
    pub fn gather(&self, radiosity: &[f64]) -> Vec<f64> {
        (0..self.count)
            .map(|i| self.row(i).iter().zip(radiosity).map(|(f, b)| f * b).sum())
            .collect()
    }

    /// The radiosity of each patch from its reflectance and its exitance M (what it emits), both per unit of area.
    ///
    /// # Errors
    /// If there is no balance.
    pub fn solve(&self, reflectance: &[f64], exitance: &[f64]) -> Result<Vec<f64>, Unbalanced> {
        if self.count <= ELIMINATED {
            self.eliminate(reflectance, exitance)
        } else {
            self.sweep(reflectance, exitance)
        }
    }

    /// By elimination with pivots: the definition that the sweeps are tested against.
    ///
    /// # Errors
    /// If the system is singular.
    pub fn eliminate(&self, reflectance: &[f64], exitance: &[f64]) -> Result<Vec<f64>, Unbalanced> {
        let matrix = DMatrix::from_fn(self.count, self.count, |i, j| {
            f64::from(u8::from(i == j)) - reflectance[i] * self.row(i)[j]
        });
        let solved = matrix.lu().solve(&DVector::from_column_slice(exitance));
        let solved = solved.ok_or(Unbalanced)?;
        if solved.iter().all(|b| b.is_finite()) {
            Ok(solved.as_slice().to_vec())
        } else {
            Err(Unbalanced)
        }
    }

    /// By Gauss-Seidel sweeps, until none changes any patch by more than 10⁻¹² of the brightest; each contracts the error by the largest
    /// reflectance or better.
    ///
    /// # Errors
    /// If ten thousand sweeps are not enough.
    pub fn sweep(&self, reflectance: &[f64], exitance: &[f64]) -> Result<Vec<f64>, Unbalanced> {
        let mut radiosity = exitance.to_vec();
        for _ in 0..10_000 {
            let (mut change, mut brightest): (f64, f64) = (0.0, f64::MIN_POSITIVE);
            for i in 0..self.count {
                let row = self.row(i);
                let irradiance: f64 = row.iter().zip(&radiosity).map(|(f, b)| f * b).sum();
                let others =
                    reflectance[i].mul_add(-row[i] * radiosity[i], reflectance[i] * irradiance);
                let next = (exitance[i] + others) / reflectance[i].mul_add(-row[i], 1.0);
                change = change.max((next - radiosity[i]).abs());
                brightest = brightest.max(next.abs());
                radiosity[i] = next;
            }
            if !brightest.is_finite() {
                return Err(Unbalanced);
            }
            if change <= 1e-12 * brightest {
                return Ok(radiosity);
            }
        }
        Err(Unbalanced)
    }
}

#[cfg(test)]
mod tests {
    use super::super::form_factor::{parallel, perpendicular};
    use super::FormFactors;

    /// A cube's six faces as patches: 0 is the floor, 5 the ceiling.
    fn cube() -> FormFactors {
        let (opposite, beside) = (parallel(1.0, 1.0, 1.0), perpendicular(1.0, 1.0, 1.0));
        let share = |i: usize, j: usize| match (i, j) {
            (i, j) if i == j => 0.0,
            (i, j) if i + j == 5 => opposite,
            _ => beside,
        };
        FormFactors::new(6, (0..36).map(|k| share(k / 6, k % 6)).collect())
    }

    #[test]
    fn a_furnace_is_evenly_bright() {
        for rho in [0.0, 0.5, 0.99] {
            let solved = cube().solve(&[rho; 6], &[2.0; 6]).expect("absorbs");
            assert!(
                solved
                    .iter()
                    .all(|b| (b - 2.0 / (1.0 - rho)).abs() < 1e-9 / (1.0 - rho))
            );
        }
        assert!(cube().sweep(&[1.0; 6], &[1.0; 6]).is_err());
    }

    #[test]
    fn elimination_and_sweeps_agree() {
        let (rho, light) = (
            [0.1, 0.3, 0.5, 0.7, 0.9, 0.2],
            [1.0, 0.0, 0.0, 0.0, 0.0, 4.0],
        );
        let (a, b) = (cube().eliminate(&rho, &light), cube().sweep(&rho, &light));
        for (a, b) in a.expect("solved").iter().zip(b.expect("solved")) {
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
    }
}
