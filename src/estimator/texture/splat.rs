//! Each point as a kernel on the texture.

use super::bilinear;
use crate::numeric::Sum;
use crate::sample::Sample;
use crate::space::Raster;
use rayon::prelude::*;

/// Points in one piece of work: a fixed number, so that sums do not depend on threads.
const BLOCK: usize = 1 << 16;

/// The densities on the texture of several weights of the same points: each point becomes w (1 - (r/R)²) on the cells whose centres lie within the radius R at its place, rescaled so
/// that the cells hold exactly w. A point whose disc holds no centre, or that lies outside of the texture, goes to the nearest cell.
pub(super) fn splat(samples: &[Sample<2>], radii: &Raster<2>) -> Vec<Raster<2>> {
    let grid = *radii.grid();
    let points = samples[0].points();
    let blocks: Vec<Vec<f64>> = (0..points.len().div_ceil(BLOCK))
        .into_par_iter()
        .map(|block| {
            let mut sums = vec![0.0; samples.len() * grid.len()];
            let mut under = Vec::new();
            for i in block * BLOCK..((block + 1) * BLOCK).min(points.len()) {
                footprint(radii, points[i], &mut under);
                let volume = under
                    .iter()
                    .map(|(_, height)| height)
                    .copied()
                    .collect::<Sum>();
                let volume = volume.value();
                for (number, sample) in samples.iter().enumerate() {
                    let weight = sample.weight(i);
                    if weight > 0.0 {
                        let layer = &mut sums[number * grid.len()..(number + 1) * grid.len()];
                        for &(cell, height) in &under {
                            layer[cell] += weight * (height / volume);
                        }
                    }
                }
            }
            sums
        })
        .collect();
    let area = grid.cell_measure();
    (0..samples.len())
        .map(|number| {
            let values = (0..grid.len()).map(|cell| {
                let parts = blocks.iter().map(|sums| sums[number * grid.len() + cell]);
                parts.collect::<Sum>().value() / area
            });
            Raster::new(grid, values.collect())
        })
        .collect()
}

/// The cells under the kernel of a point and its height at their centres.
fn footprint(radii: &Raster<2>, x: [f64; 2], under: &mut Vec<(usize, f64)>) {
    under.clear();
    let grid = radii.grid();
    let cells = grid.cells();
    let radius = bilinear(radii, x);
    let place = |k: usize, x: f64| (x - grid.low()[k]) / grid.width(k) - 0.5;
    let range = |k: usize| {
        let reach = radius / grid.width(k);
        let (low, high) = (place(k, x[k]) - reach, place(k, x[k]) + reach);
        (
            low.ceil().max(0.0) as usize,
            (high.floor() + 1.0).clamp(0.0, cells[k] as f64) as usize,
        )
    };
    let (rows, columns) = (range(0), range(1));
    for row in rows.0..rows.1 {
        // in cells from the low end: far from zero coordinates have lost their digits
        let dx = (row as f64 - place(0, x[0])) * grid.width(0) / radius;
        for column in columns.0..columns.1 {
            let dy = (column as f64 - place(1, x[1])) * grid.width(1) / radius;
            let height = 1.0 - dx.mul_add(dx, dy * dy);
            if height > 0.0 {
                under.push((row * cells[1] + column, height));
            }
        }
    }
    if under.is_empty() {
        let [row, column] = [0, 1].map(|k: usize| {
            let nearest = place(k, x[k]).round().clamp(0.0, (cells[k] - 1) as f64);
            nearest as usize
        });
        under.push((row * cells[1] + column, 1.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{open_unit, stream};
    use crate::space::Grid;

    /// Cells touched grow as the points do: slope 1 in logarithms, on counts of what the loop above goes through.
    #[test]
    fn a_splat_costs_its_points_times_their_footprints() {
        let grid = Grid::new([0.0; 2], [1.0; 2], [64; 2]).expect("legal");
        let radii = Raster::new(
            grid,
            (0..grid.len()).map(|i| 0.02 + 1e-5 * i as f64).collect(),
        );
        let touched = |n: usize| {
            let mut random = stream(56, "splat", n as u64);
            let mut under = Vec::new();
            let cells: usize = (0..n)
                .map(|_| {
                    footprint(&radii, [(); 2].map(|()| open_unit(&mut random)), &mut under);
                    under.len()
                })
                .sum();
            cells as f64
        };
        let (few, many) = (touched(3_000), touched(300_000));
        let slope = (many / few).ln() / 100.0_f64.ln();
        assert!((slope - 1.0).abs() < 0.02, "{slope}");
    }
}
