//! Sample → bandwidth.
//!
//! | selector | what it makes least | file |
//! |---|---|---|
//! | silverman, normal-reference, scott | AMISE if the density were normal | `rules.rs` |
//! | sheather-jones, sheather-jones-dpi | AMISE with an estimate of R(f″) | `sheather_jones.rs` |
//! | improved-sheather-jones | the same, without a normal reference anywhere | `improved.rs` |
//! | lscv, ucv | an unbiased estimate of MISE | `least_squares.rs` |
//! | bcv | an estimate of AMISE | `biased.rs` |
//! | walter | nothing: it expects so many points in the support of a kernel | `fixed_count.rs` |
//! | oracle-ise | the error itself, where the truth is known | `least_ise.rs` |
//! | likelihood-cross-validation, k-fold-likelihood | the surprise at a datum, given the others | `likelihood.rs` |
//! | in the plane: silverman, normal-reference, scott | AMISE if the density were normal | `plane/mod.rs` |
//! | in the plane: lscv, lscv-common | an unbiased estimate of MISE | `plane/least_squares.rs` |
//!
//! Widths of bins: `bin_width.rs` (rules) and `bin_search.rs` (Knuth, Stone). The number of neighbours: `neighbours.rs`. The number of terms of a series: with the series, which knows its functions.
//! In the plane: `plane/`.
//!
//! # What all have in common
//! - **Exact.** Criteria are sums over all pairs of data, computed to 1e-10 or better by [`GaussianPairs`](crate::engine::GaussianPairs) and
//!   [`CompactPairs`](crate::engine::CompactPairs); nothing is read off a fixed number of bins. Measured against plain sums over all pairs, n = 20 000 as drawn and rounded (`cargo run --release --example evidence-selector`):
//!   h is off by at most 1.5e-9 of itself for sheather-jones, its dpi and the improved one, by 8e-8 for ucv and lscv, where a criterion is as flat as its digits.
//! - **Kernels.** `lscv` and the likelihoods use the kernel itself. The others choose for the Gaussian, and their h is multiplied by the ratio
//!   of canonical scales, which makes estimates with different kernels equally smooth. \[Marron & Nolan 1988\]
//! - **Weights.** Where a formula has n it takes the effective size (Σw)²/Σw²; where it has a mean over pairs, the weighted mean.
//! - **Units.** Everything is computed in units of a spread of the data, so that a bandwidth follows the scale of the data over all magnitudes.
//! - **No silent number.** Ties, ends of intervals, several minima and fallbacks are told as warnings.

mod biased;
mod bin_search;
mod bin_width;
mod fixed_count;
mod functionals;
mod improved;
mod least_ise;
mod least_squares;
mod likelihood;
mod neighbours;
mod others;
mod plane;
mod rules;
mod search;
mod sheather_jones;
mod spread;
#[cfg(test)]
mod tests;

pub use biased::Biased;
pub use bin_search::{knuth, stone};
pub use bin_width::{
    BinWidth, freedman_diaconis, frequency_polygon, scott, shifted_histogram, sturges,
};
pub use fixed_count::FixedCount;
pub use improved::ImprovedSheatherJones;
pub use least_ise::LeastIse;
pub use least_squares::{LeastSquares, Unbiased};
pub use likelihood::{FoldedLikelihood, Likelihood};
pub use neighbours::{NeighbourRule, Neighbours, NeighboursChosen};
pub use others::{OTHERS, Other};
pub use plane::{NormalScale, PlaneLeastSquares};
pub use rules::{NormalReference, Scott, Silverman};
pub use sheather_jones::{DirectPlugIn, SheatherJones};

use crate::kernel::{Bandwidth, Shape, Symmetry};
use crate::sample::Sample;
use crate::space::Warning;

/// Why no bandwidth could be chosen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SelectError {
    /// The data have no spread to measure.
    #[error(
        "all {points} points are at {place}: the data have no spread from which a width could be chosen; give a number"
    )]
    NoSpread {
        /// Points in the sample.
        points: usize,
        /// Where they all are.
        place: f64,
    },
    /// The data are spread over more than numbers can hold.
    #[error(
        "the data reach from {least} to {most}: their spread is beyond what numbers can hold; write them in another unit"
    )]
    Beyond {
        /// The least datum.
        least: f64,
        /// The largest.
        most: f64,
    },
    /// Each datum is judged by the others, and there are not enough of them.
    #[error(
        "the sample has {points} points of positive weight, and the choice needs {least}; give a number"
    )]
    TooFew {
        /// Points of positive weight.
        points: usize,
        /// How many would do.
        least: usize,
    },
    /// The rule does not exist for such data.
    #[error("{0}")]
    Unable(String),
}

/// A bandwidth, with what the reader should know about how it came about.
#[derive(Clone, Debug)]
pub struct Selection<const D: usize> {
    /// The width.
    pub bandwidth: Bandwidth<D>,
    /// Fallbacks taken, minima at the edge, and the like.
    pub warnings: Vec<Warning>,
}

impl Selection<1> {
    fn new(h: f64, warnings: Vec<Warning>) -> Self {
        Self {
            bandwidth: Bandwidth::Fixed([h]),
            warnings,
        }
    }
}

/// A criterion as a function of h; the selector takes the h where it is least.
pub type Criterion = Box<dyn Fn(f64) -> f64 + Send + Sync>;

/// A rule that chooses a bandwidth from the data alone.
pub trait Selector<const D: usize>: Send + Sync {
    /// The name in files and tables.
    fn name(&self) -> &'static str;

    /// Chooses for `sample` and a kernel of `shape`. Rules use the effective size, never the bare count.
    ///
    /// # Errors
    /// If the data do not determine a width.
    fn select(&self, sample: &Sample<D>, shape: Shape) -> Result<Selection<D>, SelectError>;

    /// The criterion that is made least, where there is one, as a function of the bandwidth of `shape`.
    ///
    /// # Errors
    /// If the data do not determine a width.
    fn criterion(
        &self,
        sample: &Sample<D>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        let _ = (sample, shape);
        Ok(None)
    }
}

/// What the catalogue says about a selector, kept in the selector's own file.
pub trait Described: Selector<1> + Default + 'static {
    /// Its name in files, tables and legends.
    const NAME: &'static str;
    /// One sentence.
    const SUMMARY: &'static str;
    /// Cost in n points.
    const COST: &'static str;
    /// Author, year, equation.
    const REFERENCE: &'static str;
}

/// A selector that can be chosen by name.
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Cost in n points.
    pub cost: &'static str,
    /// Author, year, equation.
    pub reference: &'static str,
    /// Makes it.
    pub build: fn() -> Box<dyn Selector<1>>,
}

const fn entry<S: Described>() -> Entry {
    Entry {
        name: S::NAME,
        summary: S::SUMMARY,
        cost: S::COST,
        reference: S::REFERENCE,
        build: || Box::new(S::default()),
    }
}

const COUNT: usize = 11;

/// The selectors of the line. To add one is to add it here.
const ENTRIES: [Entry; COUNT] = [
    entry::<Silverman>(),
    entry::<NormalReference>(),
    entry::<Scott>(),
    entry::<SheatherJones>(),
    entry::<DirectPlugIn>(),
    entry::<ImprovedSheatherJones>(),
    entry::<LeastSquares>(),
    entry::<Unbiased>(),
    entry::<Biased>(),
    entry::<Likelihood>(),
    entry::<FoldedLikelihood>(),
];

/// The selectors of the line.
pub static CATALOGUE: [Entry; COUNT] = ENTRIES;

/// A selector of the plane that can be chosen by name.
pub struct PlaneEntry {
    /// Its name.
    pub name: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Cost in n points.
    pub cost: &'static str,
    /// Author, year, equation.
    pub reference: &'static str,
    /// Makes it for product or for radial kernels.
    pub build: fn(Symmetry) -> Box<dyn Selector<2>>,
}

/// The selectors of the plane. To add one is to add it here, and its name to [`WORDS`] if the line has none of that name.
pub static PLANE: &[PlaneEntry] = plane::ENTRIES;

/// Words that stand for a bandwidth: the selectors, and the best for a known truth.
pub const WORDS: [&str; COUNT + 5] = {
    let mut words = ["oracle"; COUNT + 5];
    let mut i = 0;
    while i < COUNT {
        words[i] = ENTRIES[i].name;
        i += 1;
    }
    words[COUNT] = plane::COMMON;
    words[COUNT + 2] = "oracle-ise";
    words[COUNT + 3] = "amise";
    words[COUNT + 4] = FixedCount::NAME;
    words
};

/// What the catalogue says about the selector of that name.
pub fn entry_of(name: &str) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.name == name)
}

/// The selector of that name.
pub fn named(name: &str) -> Option<Box<dyn Selector<1>>> {
    entry_of(name).map(|entry| (entry.build)())
}

/// The selector of the plane of that name.
pub fn plane_entry_of(name: &str) -> Option<&'static PlaneEntry> {
    PLANE.iter().find(|entry| entry.name == name)
}
