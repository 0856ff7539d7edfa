//! Which window is best at each cell of a texture.

use crate::accuracy::{Directions, LocalError};
use crate::sample::Sample;
use crate::space::{Grid, Raster, SummedArea};
use rayon::prelude::*;
use std::f64::consts::PI;

/// How windows are tried.
pub(super) struct Search {
    /// Half the sides, ascending, in cells.
    pub halves: Vec<usize>,
    /// Half the side of the region that ê² is averaged over.
    pub region: usize,
    /// The upward search ends where ê is so many times the least so far; `None`: the least of all.
    pub stop: Option<f64>,
    /// The most points in a window.
    pub cap: Option<f64>,
}

/// Half the sides of windows from 1 to `most` in about equal ratios, at most `sizes` of them.
pub(super) fn ladder(most: usize, sizes: usize) -> Vec<usize> {
    if sizes == 1 {
        return vec![most];
    }
    let ratio = |i: usize| {
        let share = i as f64 / (sizes - 1) as f64;
        (most as f64).powf(share).round() as usize
    };
    let mut halves: Vec<usize> = (0..sizes).map(ratio).collect();
    halves.dedup();
    halves
}

/// The radius of the disc whose area is that of a window.
fn radius(half: usize, texel: f64) -> f64 {
    let side = (2 * half + 1) as f64;
    (side * side * texel / PI).sqrt()
}

/// The window whose disc has the radius: half its side, in cells.
fn half_of(radius: f64, texel: f64) -> usize {
    let side = (PI * radius * radius / texel).sqrt();
    (0.5 * (side - 1.0)).round().max(0.0) as usize
}

impl Search {
    /// The radius of the best window at each cell, in the unit of the axes, and its ê. O(cells × sizes).
    pub fn best(&self, sample: &Sample<2>, grid: Grid<2>) -> (Raster<2>, Raster<2>) {
        let texture = SummedArea::of_points(grid, sample.points(), |i| sample.weight(i));
        let counts = SummedArea::of_points(grid, sample.points(), |i| {
            f64::from(u8::from(sample.weight(i) > 0.0))
        });
        let local = LocalError {
            directions: Directions::Eight,
            region: self.region,
        };
        let errors: Vec<Raster<2>> = self
            .halves
            .par_iter()
            .map(|&half| local.of_texture(&texture, half).1)
            .collect();
        let texel = grid.cell_measure();
        let [rows, columns] = grid.cells();
        let (mut radii, mut least) = (Vec::new(), Vec::new());
        for row in 0..rows {
            for column in 0..columns {
                let cell = row * columns + column;
                let held = |half: usize| counts.window([row, column], half).sum;
                let size = self.choose(|size| errors[size].values()[cell], held);
                radii.push(radius(self.halves[size], texel));
                least.push(errors[size].values()[cell].sqrt());
            }
        }
        (Raster::new(grid, radii), Raster::new(grid, least))
    }

    /// The size of least ê², as far as the search goes.
    fn choose(&self, squared: impl Fn(usize) -> f64, held: impl Fn(usize) -> f64) -> usize {
        let (mut best, mut least) = (0, squared(0));
        for size in 1..self.halves.len() {
            if self.cap.is_some_and(|cap| held(self.halves[size]) > cap) {
                break;
            }
            let here = squared(size);
            if here < least {
                (best, least) = (size, here);
            } else if self.stop.is_some_and(|stop| here > stop * stop * least) {
                break;
            }
        }
        best
    }
}

/// The mass in the window of each cell over its area, from the map of radii.
pub(super) fn windows(sample: &Sample<2>, radii: &Raster<2>) -> Raster<2> {
    let texture = SummedArea::of_points(*radii.grid(), sample.points(), |i| sample.weight(i));
    let texel = radii.grid().cell_measure();
    each_window(&texture, radii, |sum, cells| sum / (cells as f64 * texel))
}

/// How many points of positive weight the window of each cell holds.
pub(super) fn counts(sample: &Sample<2>, radii: &Raster<2>) -> Raster<2> {
    let texture = SummedArea::of_points(*radii.grid(), sample.points(), |i| {
        f64::from(u8::from(sample.weight(i) > 0.0))
    });
    each_window(&texture, radii, |sum, _| sum)
}

fn each_window(
    texture: &SummedArea,
    radii: &Raster<2>,
    value: impl Fn(f64, usize) -> f64,
) -> Raster<2> {
    let grid = *radii.grid();
    let (texel, columns) = (grid.cell_measure(), grid.cells()[1]);
    let values = radii.values().iter().enumerate().map(|(cell, radius)| {
        let half = half_of(*radius, texel);
        let window = texture.window([cell / columns, cell % columns], half);
        // differences of prefix sums of weights may be a little less than nothing
        value(window.sum.max(0.0), window.cells)
    });
    Raster::new(grid, values.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_go_from_the_least_to_the_largest() {
        assert_eq!(ladder(15, 12).first(), Some(&1));
        assert_eq!(ladder(15, 12).last(), Some(&15));
        assert_eq!(ladder(1, 12), [1]);
        assert_eq!(ladder(9, 1), [9]);
        assert!(ladder(100, 20).windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn windows_and_radii_are_one_size() {
        for half in [0, 1, 2, 7, 15, 100] {
            assert_eq!(half_of(radius(half, 0.01), 0.01), half);
        }
    }

    #[test]
    fn the_upward_search_ends_at_the_wall_and_the_least_of_all_goes_over_it() {
        let errors = [4.0, 2.0, 1.0, 3.0, 9.0, 0.1];
        let search = |stop, cap| Search {
            halves: vec![1, 2, 3, 4, 5, 6],
            region: 0,
            stop,
            cap,
        };
        let held = |half: usize| (half * half) as f64;
        let chosen = |search: Search| search.choose(|size| errors[size], held);
        assert_eq!(chosen(search(Some(2.0), None)), 2);
        assert_eq!(chosen(search(None, None)), 5);
        assert_eq!(chosen(search(None, Some(5.0))), 1);
        assert_eq!(chosen(search(None, Some(0.5))), 0);
        assert_eq!(chosen(search(Some(10.0), None)), 5);
    }
}
