//! Which window is best at each cell of a texture.

use crate::accuracy::{Directions, LocalError};
use crate::sample::Sample;
use crate::space::{Grid, Raster, SummedArea};
use rayon::prelude::*;
use std::f64::consts::PI;

/// How many sizes are tried at a time: a fixed number, so that what is held of each does not grow with the sizes.
const TOGETHER: usize = 4;

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

/// What the search has come to at one cell.
#[derive(Clone, Copy, Default)]
struct Progress {
    /// The size of least ê² so far; as long as nothing is known, the last.
    best: usize,
    /// Its ê²; 0 as long as nothing is known.
    least: f64,
    ended: bool,
}

impl Search {
    /// The bytes that [`best`](Self::best) needs at most for each cell.
    pub fn bytes(&self) -> u64 {
        let at_once = TOGETHER
            .min(self.halves.len())
            .min(rayon::current_num_threads());
        // the means, the estimate, its differences and their numbers, the tables of both, ê²
        let size = 7 * size_of::<f64>();
        let held = TOGETHER.min(self.halves.len()) * size_of::<f64>();
        let kept = 2 * size_of::<f64>() + size_of::<Progress>();
        (at_once * size + held + kept) as u64
    }

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
        let columns = grid.cells()[1];
        let mut progress = vec![Progress::default(); grid.len()];
        let sizes: Vec<usize> = (0..self.halves.len()).collect();
        for sizes in sizes.chunks(TOGETHER) {
            let errors: Vec<Raster<2>> = sizes
                .par_iter()
                .map(|&size| local.of_texture(&texture, self.halves[size]).1)
                .collect();
            for (cell, progress) in progress.iter_mut().enumerate() {
                let held = |half: usize| counts.window([cell / columns, cell % columns], half).sum;
                for (&size, errors) in sizes.iter().zip(&errors) {
                    self.offer(progress, size, errors.values()[cell], held);
                }
            }
        }
        let texel = grid.cell_measure();
        let radii = progress.iter().map(|p| radius(self.halves[p.best], texel));
        let least = progress.iter().map(|p| p.least.sqrt());
        (
            Raster::new(grid, radii.collect()),
            Raster::new(grid, least.collect()),
        )
    }

    /// Looks at the next size at a cell, whose ê² is `squared`, where a window of some half-width holds so many points.
    ///
    /// No error is seen where there are no points as far as windows are shifted, nor where there is nothing to compare with. That says nothing about the
    /// error, so such sizes are passed over; where all are, the last remains.
    fn offer(
        &self,
        progress: &mut Progress,
        size: usize,
        squared: f64,
        held: impl Fn(usize) -> f64,
    ) {
        if progress.ended {
            return;
        }
        let half = self.halves[size];
        if size > 0 && self.cap.is_some_and(|cap| held(half) > cap) {
            progress.ended = true;
            return;
        }
        // rounding leaves traces of what lies elsewhere; counts are exact
        let seen = half + LocalError::shift(half) + self.region;
        let known = squared > 0.0 && held(seen) > 0.0;
        let least = progress.least;
        if !known {
            if least == 0.0 {
                progress.best = size;
            }
        } else if least == 0.0 || squared < least {
            (progress.best, progress.least) = (size, squared);
        } else if self.stop.is_some_and(|stop| squared > stop * stop * least) {
            progress.ended = true;
        }
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

    /// The size chosen at a cell where windows of each size have these ê².
    fn chosen(errors: &[f64], stop: Option<f64>, cap: Option<f64>) -> usize {
        let search = Search {
            halves: (1..=errors.len()).collect(),
            region: 0,
            stop,
            cap,
        };
        let mut progress = Progress::default();
        for (size, squared) in errors.iter().enumerate() {
            search.offer(&mut progress, size, *squared, |half| (half * half) as f64);
        }
        progress.best
    }

    #[test]
    fn the_upward_search_ends_at_the_wall_and_the_least_of_all_goes_over_it() {
        let chosen = |stop, cap| chosen(&[4.0, 2.0, 1.0, 3.0, 9.0, 0.1], stop, cap);
        // 3 is within 2² times 1 and 9 is not
        assert_eq!(chosen(Some(2.0), None), 2);
        assert_eq!(chosen(None, None), 5);
        assert_eq!(chosen(None, Some(5.0)), 1);
        assert_eq!(chosen(None, Some(0.5)), 0);
        assert_eq!(chosen(Some(10.0), None), 5);
    }

    #[test]
    fn no_error_seen_is_no_small_error() {
        // nothing near, then something, then nothing to compare with
        let errors = [0.0, 0.0, 4.0, 1.0, 9.0, 0.0];
        assert_eq!(chosen(&errors, Some(1.5), None), 3);
        assert_eq!(chosen(&errors, None, None), 3);
        assert_eq!(chosen(&[0.0; 4], Some(1.5), None), 3);
        assert_eq!(chosen(&[0.0; 4], Some(1.5), Some(4.0)), 1);
    }

    /// Far from all points the window is not the smallest, also where weights leave a rounding error in the sums there.
    #[test]
    fn where_there_are_no_points_windows_are_wide() {
        let spot =
            |i: usize| [0, 1].map(|k| 0.04 * ((0.618 + 0.137 * f64::from(k)) * i as f64).fract());
        let points: Vec<[f64; 2]> = (0..900).map(spot).collect();
        let weights: Vec<f64> = (0..900).map(|i| 0.1 + f64::from(i % 7) / 3.0).collect();
        let domain = crate::space::Domain::unit();
        let weights = crate::sample::Weights::Each(weights.into());
        let sample = Sample::new(points, weights, domain).expect("legal");
        let grid = Grid::new([0.0; 2], [1.0; 2], [64; 2]).expect("legal");
        let search = Search {
            halves: ladder(15, 12),
            region: 6,
            stop: Some(1.5),
            cap: None,
        };
        let (radii, errors) = search.best(&sample, grid);
        let far = radii.values()[grid.len() - 1];
        assert_eq!(half_of(far, grid.cell_measure()), 15);
        assert!(errors.values()[grid.len() - 1] <= 0.0);
        assert!(errors.values()[0] > 0.0);
    }
}
