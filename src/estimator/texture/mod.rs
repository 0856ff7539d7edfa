//! Estimates over a texture of small cells, whose window is chosen at each cell by the local error. [Myszkowski 1997]
//!
//! ```text
//! points ─count─> texture ─prefix sums─> ê² of each window at each cell ─upward search─> radius ─median─> radius map ─> estimate
//! ```
//!
//! | step | file |
//! |---|---|
//! | the texture, and which window is best at each cell | `radius.rs` |
//! | a median filter of the map of radii | `median.rs` |
//! | each point as a kernel of the radius at its place | `splat.rs` |
//!
//! The radius is chosen from the total over all channels, and serves every channel.

mod median;
mod radius;
mod splat;
#[cfg(test)]
mod tests;

use super::{Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws};
use crate::neighbour::{Neighbours, Scratch, Searchable, at_each};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Evaluation, Field, Grid, Point, Raster, Targets};
use radius::Search;
use std::sync::Arc;

/// The variable kernel method: a map of radii from the local error, then one of three estimates with it.
///
/// The data are counted on a texture. For windows of growing size the local error ê² (see [`LocalError`](crate::accuracy::LocalError)) is computed at every cell from summed-area
/// tables, and the window with the least is taken: searched upward from the smallest, ending where ê is more than `stop` times the least so far. The radius R of the disc of the
/// same area makes a map, which a median filter cleans of outliers.
///
/// | `estimate` | what is done with the map | mass |
/// |---|---|---|
/// | `splat` | each point becomes an Epanechnikov kernel of the radius at its place, rescaled to unit volume on the texture | kept |
/// | `window` | the mass in the window of that size about the cell, over its area | not kept |
/// | `nearest-neighbours` | at each place as many nearest neighbours as the window there holds points | not kept |
///
/// `search = "least"` takes the least ê² of all sizes and is here to show a trap: a window that holds a whole spot, wherever it is shifted to, looks free of error.
/// Between the small window that is right and the huge one ê rises by a factor of 1.6 to 2 on a spot of some five cells' deviation, so that `stop` = 2 may climb over that wall, to ten times the
/// error, where 1.5 does not.
///
/// **Limits.** At a few points a cell ê² is noisy, hence the averaging over `region` and the median filter; ê² also counts a slope as error, though a symmetric window has none
/// there. Values are those of the texture's cells, linear in between; nothing is seen outside the texture, which covers the domain or, where that is infinite, the data. An axis that wraps round is taken
/// as one between walls. The texture is a rectangle: on a polygon windows and kernels would lose mass beyond the edges, so `splat` and `window` refuse one, and the number of nearest neighbours
/// is judged as if there were no light beyond, which makes it small along edges; the balls of neighbours are not cut there.
///
/// Where no window sees any difference, as far from all points, nothing is known about the error, and the largest window is taken.
///
/// **Memory.** At most 31 numbers a cell for the search, then 9 a cell for each set of weights (the total and each channel) for `splat`: with 4096² cells some 4 GiB, and 5 GiB for three channels.
pub struct VariableKernel {
    cells: usize,
    search: Search,
    median: usize,
    output: Output,
}

/// What is done with the map of radii.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Output {
    Splat,
    Window,
    Neighbours,
}

impl Output {
    const ALL: [Self; 3] = [Self::Splat, Self::Window, Self::Neighbours];
    const NAMES: [&'static str; 3] = ["splat", "window", "nearest-neighbours"];
}

/// Values at the centres of a texture's cells and linear in between. Outside the outermost centres they are level up to a wall; where there is none they fall to zero over one cell, so that the
/// integral is the sum over the cells either way.
struct Linear {
    raster: Raster<2>,
    map: Arc<Map>,
    domain: Domain<2>,
}

/// What was chosen at each cell.
pub(super) struct Map {
    /// The radius.
    pub radii: Raster<2>,
    /// ê, the local error of the window that was chosen before the map was cleaned.
    pub errors: Raster<2>,
}

/// Between the four centres around `x`.
pub(super) fn bilinear(raster: &Raster<2>, x: Point<2>) -> f64 {
    let grid = raster.grid();
    let cells = grid.cells();
    let mut from = [0; 2];
    let mut share = [0.0; 2];
    for axis in 0..2 {
        let place = (x[axis] - grid.low()[axis]) / grid.width(axis) - 0.5;
        let place = place.clamp(0.0, (cells[axis] - 1) as f64);
        from[axis] = (place as usize).min(cells[axis].saturating_sub(2));
        share[axis] = place - from[axis] as f64;
    }
    let value = |i: usize, j: usize| {
        let (i, j) = (
            (from[0] + i).min(cells[0] - 1),
            (from[1] + j).min(cells[1] - 1),
        );
        raster.values()[i * cells[1] + j]
    };
    let [s, t] = share;
    let near = value(0, 0).mul_add(1.0 - t, value(0, 1) * t);
    let far = value(1, 0).mul_add(1.0 - t, value(1, 1) * t);
    near.mul_add(1.0 - s, far * s)
}

impl Linear {
    /// The share of the outermost value that is left at a place outside the outermost centres of an axis; 1 between them.
    fn inside(&self, x: Point<2>, axis: usize) -> f64 {
        let grid = self.raster.grid();
        let (low, high) = (grid.low()[axis], grid.high()[axis]);
        let beyond = |outside: f64, open: bool| {
            let cells = outside / grid.width(axis);
            match (cells > -0.5, open) {
                (false, _) => 1.0,
                (true, true) => (0.5 - cells).max(0.0),
                (true, false) => f64::from(u8::from(cells <= 0.0)),
            }
        };
        beyond(low - x[axis], self.domain.low()[axis].is_infinite())
            * beyond(x[axis] - high, self.domain.high()[axis].is_infinite())
    }
}

impl Field<2> for Linear {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let share = self.inside(x, 0) * self.inside(x, 1);
        if share > 0.0 {
            share * bilinear(&self.raster, x)
        } else {
            0.0
        }
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let seen = |raster: &Raster<2>| targets.places().map(|x| bilinear(raster, x)).collect();
        Evaluation {
            values: targets.places().map(|x| self.at(x)).collect(),
            sizes: Some(seen(&self.map.radii)),
            expected_errors: Some(seen(&self.map.errors)),
            ..Evaluation::default()
        }
    }
}

/// As many nearest neighbours at each place as the map says.
struct Counted {
    finder: Arc<dyn Neighbours<2>>,
    weights: Sample<2>,
    /// How many points the window at each cell holds.
    counts: Arc<Raster<2>>,
}

impl Counted {
    fn value(&self, x: Point<2>, scratch: &mut Scratch) -> (f64, f64) {
        let most = self.finder.count();
        let k = (bilinear(&self.counts, x).round() as usize).clamp(2.min(most), most);
        let squared = self.finder.distance(x, k, scratch);
        let radius = squared.sqrt();
        let (mut mass, mut points) = (0.0, 0.0);
        self.finder.within(x, squared, &mut |i, _| {
            mass += self.weights.weight(i);
            points += 1.0;
        });
        if !radius.is_finite() {
            return (0.0, radius);
        }
        // one point fewer, as in the unbiased convention
        let density = mass * ((points - 1.0) / points) / self.finder.metric().ball(radius);
        (if radius > 0.0 { density } else { f64::MAX }, radius)
    }
}

impl Field<2> for Counted {
    fn domain(&self) -> &Domain<2> {
        self.weights.domain()
    }

    fn at(&self, x: Point<2>) -> f64 {
        self.value(x, &mut Scratch::default()).0
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let places: Vec<Point<2>> = targets.places().collect();
        let (values, sizes) = at_each(&places, |x, scratch| self.value(x, scratch))
            .into_iter()
            .unzip();
        Evaluation {
            values,
            sizes: Some(sizes),
            engine: Some(self.finder.name()),
            ..Evaluation::default()
        }
    }
}

/// The texture's cells: of the domain, or of the box around the data where that is infinite.
fn texels(sample: &Sample<2>, cells: usize) -> Result<Grid<2>, FitError> {
    let (mut low, mut high) = (sample.domain().low(), sample.domain().high());
    for axis in 0..2 {
        if !(low[axis].is_finite() && high[axis].is_finite()) {
            let counts = |i: &usize| sample.weight(*i) > 0.0;
            let at = (0..sample.len())
                .filter(counts)
                .map(|i| sample.points()[i][axis]);
            let (least, most) = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            });
            if low[axis].is_infinite() {
                low[axis] = least;
            }
            if high[axis].is_infinite() {
                high[axis] = most;
            }
        }
    }
    Grid::new(low, high, [cells; 2]).map_err(|error| {
        FitError::Degenerate(format!("the texture of the data cannot be made: {error}"))
    })
}

impl VariableKernel {
    /// The bytes that fitting so many points with so many sets of weights needs at most.
    fn bytes(&self, points: usize, sets: usize) -> u64 {
        let cells = (self.cells * self.cells) as u64;
        let each = size_of::<f64>() as u64;
        // beside the map of radii and of errors
        let output = match self.output {
            Output::Splat => splat::bytes(points, sets),
            // one texture and its table at a time, and a layer for each
            Output::Window => each * (2 + sets as u64),
            Output::Neighbours => 3 * each,
        };
        // the map is filtered before anything else is made
        let largest = self.search.bytes().max(2 * each + output).max(5 * each);
        let finder = if self.output == Output::Neighbours {
            80
        } else {
            0
        };
        cells * largest + points as u64 * (finder + each * sets as u64)
    }
}

impl Estimator<2> for VariableKernel {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: self.output == Output::Splat,
            non_negative: true,
            linear: false,
            // windows are cut at walls, and their mass divided by what is left of them
            reproduces_constants: self.output == Output::Window,
            reproduces_linear: false,
            continuous: self.output != Output::Neighbours,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: self.output != Output::Neighbours && self.search.cap.is_none(),
        }
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        if sample.domain().outline().is_some() && self.output != Output::Neighbours {
            return Err(FitError::Degenerate(
                "a texture covers a rectangle, and the domain of the data is a polygon, beyond whose edges mass would be lost; choose `estimate` = \"nearest-neighbours\" or another estimator".to_owned(),
            ));
        }
        let sets = 1 + sample.channels();
        let needed = self.bytes(sample.len(), sets);
        crate::memory::check(needed).map_err(|error| {
            let weights = if sets > 1 {
                format!(" for the total and {} channels", sets - 1)
            } else {
                String::new()
            };
            FitError::TooLarge(format!(
                "a texture of {0} × {0} cells{weights} is too large: {error}; choose fewer `cells`",
                self.cells
            ))
        })?;
        let grid = texels(sample, self.cells)?;
        let (radii, errors) = self.search.best(sample, grid);
        let map = Arc::new(Map {
            radii: median::filter(&radii, self.median),
            errors,
        });
        let samples: Vec<Sample<2>> = [sample.clone()]
            .into_iter()
            .chain((0..sample.channels()).map(|channel| sample.channel(channel)))
            .collect();
        let field = |raster: Raster<2>| -> Arc<dyn Field<2>> {
            Arc::new(Linear {
                raster,
                map: map.clone(),
                domain: sample.domain().clone(),
            })
        };
        let mut fields: Vec<Arc<dyn Field<2>>> = match self.output {
            Output::Splat => splat::splat(&samples, &map.radii)
                .layers
                .into_iter()
                .map(field)
                .collect(),
            Output::Window => samples
                .iter()
                .map(|sample| field(radius::windows(sample, &map.radii)))
                .collect(),
            Output::Neighbours => {
                let counts = Arc::new(radius::counts(sample, &map.radii));
                let finder = sample.neighbours();
                let counted = samples.into_iter().map(|weights| -> Arc<dyn Field<2>> {
                    Arc::new(Counted {
                        finder: finder.clone(),
                        weights,
                        counts: counts.clone(),
                    })
                });
                counted.collect()
            }
        };
        let channels = fields.split_off(1);
        let total = fields.pop().expect("the total comes first");
        Ok(Estimate::new(total).with_channels(channels))
    }
}

impl Described for VariableKernel {
    const NAME: &'static str = "variable-kernel";
    const SUMMARY: &'static str =
        "in the plane: kernels whose radius follows an estimate of the local error on a texture";
    const COST: &'static str = "O(t L + n F + m) for t cells, L sizes, F cells under a kernel";
    const REFERENCE: &'static str = "Myszkowski 1997, Lighting reconstruction using fast and adaptive density estimation techniques; Crow 1984";
    const SMOOTHING: Option<&'static str> = Some("half-width");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::optional(
            "cells",
            Kind::Count {
                least: 4,
                most: 4096,
            },
            Absent::Number(128.0),
            "cells of the texture on each axis",
        ),
        Parameter::optional(
            "estimate",
            Kind::Choice(&Output::NAMES),
            Absent::Word("splat"),
            "what is done with the map of radii",
        ),
        Parameter::optional(
            "half-width",
            Kind::Count {
                least: 1,
                most: 1000,
            },
            Absent::Number(15.0),
            "half the side of the largest window, in cells",
        )
        .swept(),
        Parameter::optional(
            "sizes",
            Kind::Count {
                least: 1,
                most: 100,
            },
            Absent::Number(12.0),
            "how many sizes are tried, from 3 × 3 cells to the largest in equal ratios; 1: the largest alone, everywhere",
        ),
        Parameter::optional(
            "search",
            Kind::Choice(&["upward", "least"]),
            Absent::Word("upward"),
            "from the smallest window until the error has risen, or the least of all sizes",
        ),
        Parameter::optional(
            "stop",
            Kind::Between(1.0, 1e6),
            Absent::Number(1.5),
            "the upward search ends where the error is so many times the least so far",
        ),
        Parameter::optional(
            "k-max",
            Kind::Count {
                least: 1,
                most: 1_000_000_000,
            },
            Absent::Unset,
            "no window that holds more points, unless it is the smallest",
        ),
        Parameter::optional(
            "region",
            Kind::Count {
                least: 1,
                most: 1001,
            },
            Absent::Number(13.0),
            "the side of the square over which the error is averaged, in cells; odd",
        ),
        Parameter::optional(
            "median",
            Kind::Count {
                least: 1,
                most: 101,
            },
            Absent::Number(9.0),
            "the side of the median filter's window, in cells; odd, 1 for none",
        ),
    ];
}

impl Build<2> for VariableKernel {
    fn build(values: &Values, _context: &Context<2>) -> Result<Self, BuildError> {
        let count = |name: &str| {
            let count = values.count(name).unwrap_or(1);
            usize::try_from(count).unwrap_or(usize::MAX)
        };
        let odd = |name: &'static str| match count(name) {
            side if side % 2 == 1 => Ok(side / 2),
            side => Err(BuildError {
                parameter: name,
                what: format!("`{name}` = {side} has no middle cell; take an odd number"),
            }),
        };
        let output = values.word("estimate").unwrap_or_default();
        let output = Output::NAMES.iter().position(|name| *name == output);
        Ok(Self {
            cells: count("cells"),
            search: Search {
                halves: radius::ladder(count("half-width"), count("sizes")),
                region: odd("region")?,
                stop: (values.word("search") != Some("least"))
                    .then(|| values.number("stop").unwrap_or(1.5)),
                cap: values.count("k-max").map(|k| k as f64),
            },
            median: odd("median")?,
            output: output.map_or(Output::Splat, |at| Output::ALL[at]),
        })
    }
}
