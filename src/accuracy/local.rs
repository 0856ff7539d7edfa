//! The error at a place, judged from how much the estimate changes nearby.
//!
//! # References
//! Myszkowski 1997, Lighting reconstruction using fast and adaptive density estimation techniques (the estimate); Crow 1984, Summed-area tables for texture mapping.

use crate::space::{Raster, SummedArea};
use serde::{Deserialize, Serialize};

/// e²(x) ≈ M · (1 / J H) Σᵢ Σⱼ (f̂(xᵢ) - f̂(xᵢⱼ))², the sum over the H cells xᵢ of a square region about x and over J places xᵢⱼ that lie a shift away from xᵢ and are
/// estimated from a window of the same size, so that their random error is the same. \[Myszkowski 1997\]
///
/// **What it sees.** The difference of two estimates whose windows do not overlap has twice the variance of one; that is the random error. The expectation of an estimate changes
/// over the shift by about as much as f does; that stands in for the bias. So the estimate responds to variance and first differences: on a slope it says too much (a symmetric
/// window has no bias there), at the top of a symmetric peak and on a small spot within a huge window too little (the window holds the whole spot at all shifts). The factor M is
/// therefore a matter of calibration, not of theory: 1/2 for pure noise and shifts of a whole window, see [`Calibration`](super::Calibration).
///
/// Cost: J + 1 reads a cell for each size of window, whatever the sizes of window and region.
///
/// ```
/// use density_lab::accuracy::LocalError;
/// use density_lab::space::{Grid, Raster};
/// let flat = Raster::new(Grid::new([0.0; 2], [1.0; 2], [8, 8])?, vec![3.0; 64]);
/// assert!(LocalError::default().squared(&flat, 2).values().iter().all(|e| *e == 0.0));
/// # Ok::<(), density_lab::space::GridError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocalError {
    /// J: how many places each cell is compared with, 4 (along the axes) or 8 (and the diagonals).
    pub directions: Directions,
    /// Half the side of the region over which squared differences are averaged, in cells: 1 for 3 × 3, 6 for 13 × 13.
    pub region: usize,
}

/// Where the places lie that a cell is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Directions {
    /// Along the axes.
    Four,
    /// And along the diagonals, the same number of cells on each axis.
    #[default]
    Eight,
}

impl Directions {
    const ALL: [[isize; 2]; 8] = [
        [0, 1],
        [1, 0],
        [0, -1],
        [-1, 0],
        [1, 1],
        [1, -1],
        [-1, -1],
        [-1, 1],
    ];

    fn steps(self) -> &'static [[isize; 2]] {
        match self {
            Self::Four => &Self::ALL[..4],
            Self::Eight => &Self::ALL,
        }
    }
}

impl Default for LocalError {
    /// Eight places, 13 × 13 cells: what few photons a cell need.
    fn default() -> Self {
        Self {
            directions: Directions::Eight,
            region: 6,
        }
    }
}

impl LocalError {
    /// ê² / M at each cell of `estimate`, all of whose values are from windows of one size, with places `shift` cells away: half to once the half-width of the window.
    ///
    /// Places beyond the grid do not count; a region is cut off at its end. A grid that is smaller than the shift on both axes has nothing to compare with: zero, which is no
    /// statement about the error.
    pub fn squared(&self, estimate: &Raster<2>, shift: usize) -> Raster<2> {
        let [rows, columns] = estimate.grid().cells();
        let values = estimate.values();
        let mut differences = vec![0.0; values.len()];
        let mut compared = vec![0.0; values.len()];
        for row in 0..rows {
            for column in 0..columns {
                let here = row * columns + column;
                for [up, right] in self.directions.steps() {
                    let place = |at: usize, step: isize, cells: usize| {
                        let moved = isize::try_from(shift)
                            .ok()
                            .and_then(|shift| at.checked_add_signed(step * shift))?;
                        (moved < cells).then_some(moved)
                    };
                    if let (Some(i), Some(j)) =
                        (place(row, *up, rows), place(column, *right, columns))
                    {
                        differences[here] += (values[here] - values[i * columns + j]).powi(2);
                        compared[here] += 1.0;
                    }
                }
            }
        }
        let differences = SummedArea::new(*estimate.grid(), &differences);
        let compared = SummedArea::new(*estimate.grid(), &compared);
        let mut squared = Vec::with_capacity(values.len());
        for row in 0..rows {
            for column in 0..columns {
                let pairs = compared.window([row, column], self.region).sum;
                let sum = differences.window([row, column], self.region).sum;
                // the table's rounding may leave a little less than nothing
                squared.push(if pairs > 0.0 {
                    (sum / pairs).max(0.0)
                } else {
                    0.0
                });
            }
        }
        Raster::new(*estimate.grid(), squared)
    }

    /// By how many cells windows of 2 `half` + 1 cells a side are shifted on a texture: about half of `half`, and at least one.
    pub fn shift(half: usize) -> usize {
        half.div_ceil(2).max(1)
    }

    /// The same for the estimate from windows of 2 `half` + 1 cells a side over a texture of counts or flux, the density (mass per area) in each, with [shifts](Self::shift) of about half of `half`.
    /// Gives the estimate and ê² / M.
    pub fn of_texture(&self, texture: &SummedArea, half: usize) -> (Raster<2>, Raster<2>) {
        let area = texture.grid().cell_measure();
        let mean = texture.smoothed(half);
        let density = mean.values().iter().map(|count| count / area).collect();
        let estimate = Raster::new(*texture.grid(), density);
        let squared = self.squared(&estimate, Self::shift(half));
        (estimate, squared)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::random::stream;
    use crate::space::Grid;
    use rand::RngExt;

    fn raster(cells: [usize; 2], value: impl Fn(usize, usize) -> f64) -> Raster<2> {
        let grid = Grid::new([0.0; 2], [1.0; 2], cells).unwrap();
        let values = (0..cells[0])
            .flat_map(|i| (0..cells[1]).map(move |j| (i, j)))
            .map(|(i, j)| value(i, j))
            .collect();
        Raster::new(grid, values)
    }

    #[test]
    fn it_is_the_double_sum_of_its_definition() {
        let mut random = stream(40, "local error", 0);
        let noise: Vec<f64> = (0..63).map(|_| random.random()).collect();
        let estimate = raster([9, 7], |i, j| noise[i * 7 + j]);
        for directions in [Directions::Four, Directions::Eight] {
            let local = LocalError {
                directions,
                region: 2,
            };
            let squared = local.squared(&estimate, 3);
            for (i, j) in (0..9i32).flat_map(|i| (0..7i32).map(move |j| (i, j))) {
                let (mut sum, mut pairs) = (0.0, 0.0);
                for (a, b) in (i - 2..=i + 2).flat_map(|a| (j - 2..=j + 2).map(move |b| (a, b))) {
                    for (up, right) in (-1..=1).flat_map(|u| (-1..=1).map(move |r| (u, r))) {
                        let straight = (up == 0) != (right == 0);
                        let used =
                            straight || (up != 0 && right != 0 && directions == Directions::Eight);
                        let (c, d) = (a + 3 * up, b + 3 * right);
                        let inside = |i: i32, j: i32| (0..9).contains(&i) && (0..7).contains(&j);
                        if used && inside(a, b) && inside(c, d) {
                            let at = |i: i32, j: i32| noise[(i * 7 + j) as usize];
                            sum += f64::powi(at(a, b) - at(c, d), 2);
                            pairs += 1.0;
                        }
                    }
                }
                let found = squared.values()[(i * 7 + j) as usize];
                assert!((found - sum / pairs).abs() < 1e-14, "{i} {j}");
            }
        }
    }

    #[test]
    fn a_slope_is_seen_and_nothing_is_nothing() {
        let slope = raster([16, 16], |i, _| i as f64);
        let local = LocalError {
            directions: Directions::Four,
            region: 0,
        };
        let squared = local.squared(&slope, 2);
        // up and down 2 each, left and right nothing
        assert!((squared.values()[8 * 16 + 8] - 2.0).abs() < 1e-12);
        let one = raster([1, 1], |_, _| 5.0);
        assert!(LocalError::default().squared(&one, usize::MAX).values()[0].abs() < 1e-300);
    }

    #[test]
    fn pure_noise_is_seen_as_twice_its_variance() {
        // 200 × 200 independent counts of unit variance, windows of 5 × 5 cells shifted by 5: no overlap
        let mut random = stream(41, "local error", 0);
        let noise: Vec<f64> = (0..40_000)
            .map(|_| (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0)
            .collect();
        let cells = SummedArea::new(Grid::new([0.0; 2], [1.0; 2], [200, 200]).unwrap(), &noise);
        let squared = LocalError {
            directions: Directions::Four,
            region: 100,
        }
        .squared(&cells.smoothed(2), 5);
        let middle = squared.values()[100 * 200 + 100];
        // 1600 windows; relative spread of a variance about (2/1600)^½ · 1.2
        assert!((middle * 25.0 / 2.0 - 1.0).abs() < 0.2, "{middle}");
    }
}
