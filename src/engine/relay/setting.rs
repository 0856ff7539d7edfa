//! How far apart nodes and how wide cells may be for a tolerance: the error bound and its proof.
//!
//! All bounds are relative to the peak P of the estimate, as in `hermite/setting.rs`, which they use; weights are not negative.
//!
//! # The nodes
//! Σₖ over all nodes y_k = kΔ of φ((y_k - X)/ah) φ((x - y_k)/bh) is the trapezoidal sum of a Gaussian of deviation abh; by Poisson's formula it is off from its integral by at most
//! 2 Σₚ exp(-2π²p²(abh/Δ)²) **of itself**. So f̂h = Σ wᵢ φ((x - Xᵢ)/h) is, up to that relative error,
//!
//! ```text
//! Σₖ c_k(x) G(y_k)     c_k(x) = Δ/(abh) φ((x - y_k)/bh)     G(y) = Σ wᵢ φ((y - Xᵢ)/ah)
//! ```
//!
//! # What is left out
//! Since a < 1, G is nowhere above P, and it is a Gaussian sum itself: moments to order M in cells of width w leave E(M, w/2ah) of P, points beyond R·ah of a node 2.3 exp(-R²/2), as
//! proved for hermite. The c_k(x) of one target sum to 1/a, so that these reach it 1/a fold. Nodes beyond R·bh of a target would add at most
//! P · Σ c_k over them ≤ (2/a) φ(R) (Δ/bh + 1/R) P.

use crate::engine::Unsupported;
use crate::engine::hermite::{ROUNDING, power_of_two_below, remainder, rounding_of_sums};
use crate::numeric::special::normal_density;
use crate::space::Grid;
use std::f64::consts::PI;

/// Numbers in a table at most: 16 MiB.
const MOST: f64 = (1 << 21) as f64;

/// Targets treated together.
pub(super) const GROUP: usize = 8;

/// Cells, nodes and reaches for one bandwidth, grid and tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    /// h.
    pub bandwidth: f64,
    /// ah, the width of the Gaussians on the points.
    pub wide: f64,
    /// bh, the width of the Gaussians on the nodes.
    pub narrow: f64,
    /// Moments of a cell: 4, 8 or 16.
    pub moments: usize,
    /// The width of a cell, w: a power of two.
    pub cell: f64,
    /// The distance of nodes, Δ: a power of two.
    pub gap: f64,
    /// R: beyond so many widths of a Gaussian nothing is counted.
    pub reach: f64,
    /// The bound on the whole error, relative to the peak.
    pub error: f64,
    /// What it costs on one thread with the tables at hand.
    pub work: f64,
    /// What the tables cost.
    pub making: f64,
}

impl Setting {
    /// The cheapest setting whose bound is within the tolerance for `points` points with or without weights, or the most exact one if none is.
    ///
    /// # Errors
    /// If the tables would be too large, or numbers are too coarse for cells.
    pub fn choose(
        bandwidth: f64,
        grid: &Grid<1>,
        (points, weighted): (usize, bool),
        tolerance: f64,
    ) -> Result<Self, Unsupported> {
        if !(1e-290..1e290).contains(&bandwidth) {
            return Err(Unsupported(format!(
                "relay needs a bandwidth between 1e-290 and 1e290, not {bandwidth}"
            )));
        }
        let asked = tolerance.clamp(1e-13, 1e-2);
        let reach = (2.0 * (16.0 * 2.3 / asked).ln()).sqrt();
        // abh/Δ at which the sum over nodes is off by an eighth of the tolerance
        let needed = ((16.0 / asked).ln() / (2.0 * PI * PI)).sqrt();
        // ab is at most one half
        let widest = power_of_two_below(0.5 * bandwidth / needed);
        let mut best: Option<Self> = None;
        for gap in [widest, 0.5 * widest] {
            let product = needed * gap / bandwidth;
            let narrow = (0.5 * (1.0 - (1.0 - 4.0 * product * product).max(0.0).sqrt())).sqrt();
            let wide = (1.0 - narrow * narrow).sqrt();
            for moments in [4, 8, 16] {
                let mut cell = 4.0 * gap;
                for _ in 0..9 {
                    let mut setting = Self {
                        bandwidth,
                        wide: wide * bandwidth,
                        narrow: narrow * bandwidth,
                        moments,
                        cell,
                        gap,
                        reach,
                        error: 0.0,
                        work: 0.0,
                        making: 0.0,
                    };
                    cell *= 0.5;
                    // beyond, the bound of moments does not hold
                    if setting.cell > 1.4 * setting.wide {
                        continue;
                    }
                    setting.error = setting.bound(points);
                    (setting.work, setting.making) = setting.cost(grid, points as f64, weighted);
                    let better = best.is_none_or(|best| {
                        match (setting.error <= tolerance, best.error <= tolerance) {
                            (true, true) => setting.work < best.work,
                            (true, false) => true,
                            (false, true) => false,
                            (false, false) => setting.error < best.error,
                        }
                    });
                    if better {
                        best = Some(setting);
                    }
                    if setting.error <= tolerance {
                        // narrower cells are only dearer
                        break;
                    }
                }
            }
        }
        let too_much = || {
            Unsupported(format!(
                "relay would need tables of more than 2²¹ numbers, or numbers are too coarse for cells, at {} targets and the bandwidth {bandwidth}",
                grid.cells()[0]
            ))
        };
        best.filter(|best| best.work.is_finite())
            .ok_or_else(too_much)
    }

    fn bound(&self, points: usize) -> f64 {
        // in this order nothing underflows, whatever the unit
        let ratio = (self.wide / self.bandwidth) * (self.narrow / self.gap);
        let nodes = 2.1 * (-2.0 * (PI * ratio).powi(2)).exp();
        let inside = 0.5 * self.cell / self.wide;
        let amplified = self.bandwidth / self.wide;
        let sums = rounding_of_sums(inside, points);
        let points = remainder(self.moments, inside) + 2.3 * (-0.5 * self.reach * self.reach).exp();
        let far = 2.0 * normal_density(self.reach) * (self.gap / self.narrow + self.reach.recip());
        nodes + amplified * (points + sums + far) + 128.0 * ROUNDING
    }

    /// Nodes that hear of one cell.
    pub fn nodes_of_cell(&self) -> usize {
        let nodes = (2.0 * self.reach * self.wide + self.cell) / self.gap;
        nodes.ceil() as usize + 1
    }

    /// Nodes that [`GROUP`] targets side by side hear of, `step` being the distance of targets.
    pub fn nodes_of_targets(&self, step: f64) -> usize {
        let nodes = (2.0 * self.reach * self.narrow + (GROUP - 1) as f64 * step) / self.gap;
        nodes.ceil() as usize + 1
    }

    /// Expected time; infinite where it cannot be done.
    fn cost(&self, grid: &Grid<1>, points: f64, weighted: bool) -> (f64, f64) {
        let (step, targets) = (grid.width(0), grid.cells()[0] as f64);
        let far = grid.low()[0].abs().max(grid.high()[0].abs()) + 40.0 * self.bandwidth;
        let of_targets = (2.0 * self.reach * self.narrow + 8.0 * step) / self.gap + 1.0;
        let span = targets * step + 2.0 * self.reach * (self.narrow + self.wide);
        let cells = span / self.cell + 3.0;
        let phases = (self.gap / self.cell).max(1.0);
        let of_cell = (2.0 * self.reach * self.wide + self.cell) / self.gap + 8.0;
        let tables = [
            targets * of_targets,
            phases * of_cell * self.moments as f64,
            cells * 16.0,
        ];
        // cells are numbered in 32 bits, and every place is a whole number of cells from zero
        let fits = tables.iter().all(|&size| size <= MOST);
        // targets farther apart would take digits from the places of nodes between them
        let apart = targets > 1.0 && step > 100.0 * self.bandwidth;
        if !fits || apart || far / self.cell > (1u64 << 49) as f64 {
            return (f64::INFINITY, f64::INFINITY);
        }
        // measured on one thread
        let point = match (self.moments, weighted) {
            (4, false) => 1.9,
            (4, true) | (8, false) => 2.8,
            (8, true) | (16, false) => 4.8,
            _ => 7.5,
        };
        let moments = self.moments as f64;
        let making =
            targets * (30.0 + 1.5 * of_targets) + phases * of_cell * (15.0 + 2.0 * moments);
        let work = 500.0
            + point * points
            + cells * moments * (2.0 + 0.05 * of_cell)
            + 0.1 * targets * of_targets;
        (work, making)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Σₖ c_k(x) φ((y_k - X)/ah) against φ((x - X)/h), over all places of X and x between nodes.
    #[test]
    fn nodes_hand_on_what_the_proof_says() {
        let grid = Grid::new([-4.0], [4.0], [512]).expect("legal");
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
            for bandwidth in [0.11, 0.2208, 0.3, 0.43] {
                let s = Setting::choose(bandwidth, &grid, (1000, false), tolerance).expect("able");
                assert!(s.error <= tolerance, "{s:?}");
                let ratio = s.wide * s.narrow / s.bandwidth / s.gap;
                let allowed = 2.1 * (-2.0 * (PI * ratio).powi(2)).exp() + 1e-14;
                for i in 0..40 {
                    let at = f64::from(i) * 0.0371 * s.gap;
                    let x = at + f64::from(i % 7) * 0.3 * bandwidth;
                    let sum: f64 = (-200..=200)
                        .map(|k| f64::from(k) * s.gap)
                        .map(|y| {
                            normal_density((y - at) / s.wide) * normal_density((x - y) / s.narrow)
                        })
                        .sum();
                    let found = sum * s.gap * s.bandwidth / s.wide / s.narrow;
                    let expected = normal_density((x - at) / bandwidth);
                    assert!(
                        (found / expected - 1.0).abs() <= allowed,
                        "{found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_would_not_fit_is_refused() {
        let far = Grid::new([-1e7], [1e7], [1000]).expect("legal");
        assert!(Setting::choose(1e-3, &far, (100, false), 1e-6).is_err());
        let coarse = Grid::new([1e15], [1e15 + 1000.0], [10]).expect("legal");
        assert!(Setting::choose(1e-3, &coarse, (100, false), 1e-6).is_err());
        let fine = Grid::new([0.0], [1.0], [1 << 20]).expect("legal");
        assert!(Setting::choose(0.1, &fine, (100, false), 1e-6).is_err());
    }
}
