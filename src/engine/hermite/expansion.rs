//! Hermite expansions on a row of cells, and their evaluation at targets.

use super::setting::{ORDER, Setting};
use crate::numeric::special::normal_density;
use crate::space::binning::{Lattice, moments};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Neighbouring cells treated together in vector registers.
const WIDTH: usize = 8;

/// The terms a₀ .. a₁₅ of one cell: it contributes Σ aₙ Heₙ(u) φ(u) at u = (target - centre) / h.
pub(super) type Terms = [f64; ORDER];

/// The coarse cell that a place is in, by number, and the place relative to its centre in units of h.
#[inline(always)]
pub(super) fn locate(setting: &Setting, x: f64) -> (f64, f64) {
    let ratio = setting.ratio as f64;
    // powers of two: all exact
    let cell = ((x / setting.fine + 0.5) / ratio).floor();
    let centre = (cell * ratio + 0.5 * (ratio - 1.0)) * setting.fine;
    (cell, (x - centre) / setting.bandwidth)
}

/// The expansions of consecutive coarse cells around all targets.
pub(super) struct Row {
    setting: Setting,
    /// The number of the first cell.
    first: f64,
    cells: Vec<Terms>,
}

impl Row {
    /// How many fine cells serve targets between `low` and `high`; not finite where numbers are too coarse for cells.
    pub fn fine_cells(setting: &Setting, low: f64, high: f64) -> f64 {
        let (first, last) = (locate(setting, low).0, locate(setting, high).0);
        let most = first.abs().max(last.abs()) * setting.ratio as f64;
        if most < (1u64 << 49) as f64 {
            (last - first + 1.0 + 2.0 * setting.neighbours() as f64) * setting.ratio as f64
        } else {
            f64::INFINITY
        }
    }

    /// Collects the points within reach of targets between `low` and `high`.
    pub fn collect(
        setting: &Setting,
        points: &[f64],
        weights: Option<&[f64]>,
        low: f64,
        high: f64,
    ) -> Self {
        let margin = setting.neighbours() as f64;
        let first = locate(setting, low).0 - margin;
        let last = locate(setting, high).0 + margin;
        let lattice = Lattice {
            width: setting.fine,
            first: first * setting.ratio as f64,
            count: (last - first + 1.0) as usize * setting.ratio,
        };
        let cells = match setting.moments {
            4 => merge(setting, &moments::<4>(points, weights, lattice)),
            _ => merge(setting, &moments::<8>(points, weights, lattice)),
        };
        Self {
            setting: *setting,
            first,
            cells,
        }
    }

    /// Σ over all cells within reach, at each of `targets` (all inside the range given to `collect`).
    pub fn evaluate(&self, targets: &[f64]) -> Vec<f64> {
        let inner = self.cells.len() - 2 * self.setting.neighbours();
        // estimated, to be measured: 0.15 µs a target from the cells around it, 1 µs to expand all cells around one cell, 5 ns a target from that
        if targets.len() > 7 * inner {
            self.evaluate_local(targets)
        } else {
            self.evaluate_each(targets)
        }
    }

    fn evaluate_each(&self, targets: &[f64]) -> Vec<f64> {
        let setting = &self.setting;
        let neighbours = setting.neighbours();
        let window = 2 * neighbours + 1;
        let step = setting.coarse() / setting.bandwidth;
        // one plane per order, so that neighbouring cells lie side by side
        let stride = self.cells.len() + WIDTH;
        let mut planes = vec![0.0; ORDER * stride];
        for (i, terms) in self.cells.iter().enumerate() {
            for (k, term) in terms.iter().enumerate() {
                planes[k * stride + i] = *term;
            }
        }
        let damping: Vec<f64> = (0..window)
            .map(|j| {
                let distance = (j as f64 - neighbours as f64) * step;
                normal_density(distance)
            })
            .collect();
        let kit = Kit {
            row: self,
            planes: &planes,
            stride,
            damping: &damping,
            step,
        };
        let mut values = vec![0.0; targets.len()];
        values
            .par_chunks_mut(256)
            .zip(targets.par_chunks(256))
            .for_each(|(values, targets)| {
                Arch::new().dispatch(Each {
                    kit,
                    targets,
                    values,
                });
            });
        values
    }

    fn evaluate_local(&self, targets: &[f64]) -> Vec<f64> {
        let setting = &self.setting;
        let neighbours = setting.neighbours();
        let step = setting.coarse() / setting.bandwidth;
        // Heₙ(U) φ(U) between the centres of cells j apart, n < 2·ORDER
        let table: Vec<[f64; 2 * ORDER]> = (0..=2 * neighbours)
            .map(|j| hermite_functions((neighbours as f64 - j as f64) * step))
            .collect();
        let inner = self.cells.len() - 2 * neighbours;
        let base = self.first + neighbours as f64;
        let mut wanted = vec![false; inner];
        for &x in targets {
            wanted[(locate(setting, x).0 - base) as usize] = true;
        }
        let local: Vec<Terms> = wanted
            .par_iter()
            .enumerate()
            .with_min_len(16)
            .map(|(cell, &wanted)| {
                if wanted {
                    Arch::new().dispatch(Local {
                        sources: &self.cells[cell..=cell + 2 * neighbours],
                        table: &table,
                    })
                } else {
                    [0.0; ORDER]
                }
            })
            .collect();
        let mut values = vec![0.0; targets.len()];
        values
            .par_chunks_mut(4096)
            .zip(targets.par_chunks(4096))
            .for_each(|(values, targets)| {
                Arch::new().dispatch(Polynomials {
                    setting,
                    base,
                    local: &local,
                    targets,
                    values,
                });
            });
        values
    }
}

/// Heₙ(u) φ(u) for n = 0 .. 31.
fn hermite_functions(u: f64) -> [f64; 2 * ORDER] {
    let mut h = [0.0; 2 * ORDER];
    h[0] = normal_density(u);
    h[1] = u * h[0];
    for n in 1..2 * ORDER - 1 {
        h[n + 1] = u * h[n] - n as f64 * h[n - 1];
    }
    h
}

/// Translates the moments of fine cells to the terms of coarse ones: aₙ = Σₘ μₘ ρᵐ/m! · sⁿ⁻ᵐ/(n-m)!, with ρ = fine width / h and s the
/// distance from the coarse to the fine centre over h.
fn merge<const M: usize>(setting: &Setting, fine: &[[f64; M]]) -> Vec<Terms> {
    let scale = setting.fine / setting.bandwidth;
    let ratio = setting.ratio;
    let mut shift = vec![[[0.0; ORDER]; M]; ratio];
    for (o, matrix) in shift.iter_mut().enumerate() {
        let s = (o as f64 - 0.5 * (ratio as f64 - 1.0)) * scale;
        let mut of_moment = 1.0;
        for (m, row) in matrix.iter_mut().enumerate() {
            let mut power = of_moment;
            for n in m..ORDER {
                row[n] = power;
                power *= s / (n - m + 1) as f64;
            }
            of_moment *= scale / (m + 1) as f64;
        }
    }
    fine.par_chunks(ratio)
        .with_min_len(64)
        .map(|group| {
            Arch::new().dispatch(Merge {
                group,
                shift: &shift,
            })
        })
        .collect()
}

struct Merge<'a, const M: usize> {
    group: &'a [[f64; M]],
    shift: &'a [[Terms; M]],
}

impl<const M: usize> WithSimd for Merge<'_, M> {
    type Output = Terms;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Terms {
        let mut terms = [0.0; ORDER];
        for (moments, matrix) in self.group.iter().zip(self.shift) {
            if moments[0] > 0.0 {
                for m in 0..M {
                    for n in 0..ORDER {
                        terms[n] += moments[m] * matrix[m][n];
                    }
                }
            }
        }
        terms
    }
}

/// What the evaluation of single targets shares.
#[derive(Clone, Copy)]
struct Kit<'a> {
    row: &'a Row,
    planes: &'a [f64],
    stride: usize,
    /// φ(j·step) for the neighbours j.
    damping: &'a [f64],
    step: f64,
}

struct Each<'a, 'b> {
    kit: Kit<'a>,
    targets: &'b [f64],
    values: &'b mut [f64],
}

impl WithSimd for Each<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            kit,
            targets,
            values,
        } = self;
        let setting = &kit.row.setting;
        let neighbours = setting.neighbours();
        let window = kit.damping.len();
        let mut factor = vec![0.0; window.next_multiple_of(WIDTH)];
        for (value, &x) in values.iter_mut().zip(targets) {
            let (cell, offset) = locate(setting, x);
            let start = (cell - kit.row.first) as usize - neighbours;
            // φ(offset - j·step) = φ(j·step) · exp(-offset²/2) · exp(offset·step)ʲ
            let near = (-0.5 * offset * offset).exp();
            let (grow, shrink) = ((offset * kit.step).exp(), (-offset * kit.step).exp());
            let (mut up, mut down) = (near, near);
            factor[neighbours] = near * kit.damping[neighbours];
            for j in 1..=neighbours {
                up *= grow;
                down *= shrink;
                factor[neighbours + j] = up * kit.damping[neighbours + j];
                factor[neighbours - j] = down * kit.damping[neighbours - j];
            }
            let mut total = [0.0; WIDTH];
            for (block, factor) in factor.chunks_exact(WIDTH).enumerate() {
                let left = block * WIDTH;
                let mut u = [0.0; WIDTH];
                for (i, u) in u.iter_mut().enumerate() {
                    *u = offset - ((left + i) as f64 - neighbours as f64) * kit.step;
                }
                // Clenshaw's recurrence for Heₙ₊₁ = u Heₙ - n Heₙ₋₁
                let (mut next, mut after) = ([0.0; WIDTH], [0.0; WIDTH]);
                for n in (0..ORDER).rev() {
                    let at = n * kit.stride + start + left;
                    let plane = &kit.planes[at..at + WIDTH];
                    for i in 0..WIDTH {
                        let now = plane[i] + u[i] * next[i] - (n + 1) as f64 * after[i];
                        after[i] = next[i];
                        next[i] = now;
                    }
                }
                for i in 0..WIDTH {
                    total[i] += factor[i] * next[i];
                }
            }
            *value = total.iter().sum();
        }
    }
}

/// The Taylor expansion about the centre of one cell of everything around it: Σₖ Lₖ vᵏ with
/// Lₖ = (-1)ᵏ/k! Σⱼ Σₘ aⱼₘ Heₘ₊ₖ(Uⱼ) φ(Uⱼ).
struct Local<'a> {
    sources: &'a [Terms],
    table: &'a [[f64; 2 * ORDER]],
}

impl WithSimd for Local<'_> {
    type Output = Terms;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Terms {
        let mut local = [0.0; ORDER];
        for (terms, functions) in self.sources.iter().zip(self.table) {
            if terms[0] > 0.0 {
                for m in 0..ORDER {
                    for k in 0..ORDER {
                        local[k] += terms[m] * functions[m + k];
                    }
                }
            }
        }
        let mut factor = 1.0;
        for (k, term) in local.iter_mut().enumerate() {
            *term *= factor;
            factor *= -1.0 / (k + 1) as f64;
        }
        local
    }
}

struct Polynomials<'a, 'b> {
    setting: &'a Setting,
    base: f64,
    local: &'a [Terms],
    targets: &'b [f64],
    values: &'b mut [f64],
}

impl WithSimd for Polynomials<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (value, &x) in self.values.iter_mut().zip(self.targets) {
            let (cell, v) = locate(self.setting, x);
            let terms = &self.local[(cell - self.base) as usize];
            // even and odd powers apart: two short chains instead of a long one
            let square = v * v;
            let (mut even, mut odd) = (0.0, 0.0);
            for k in (0..ORDER / 2).rev() {
                even = even * square + terms[2 * k];
                odd = odd * square + terms[2 * k + 1];
            }
            *value = even + odd * v;
        }
    }
}
