//! What is examined: one healthy implementation of each public trait that the checks look at.

use crate::accuracy::{Interval, mean_interval};
use crate::boundary::{Boundary, Ignore, LocalLinear, Reflect};
use crate::density::{self, Univariate};
use crate::engine::{Engine, Gather, Hermite};
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::{self, Builds, Entry};
use crate::kernel::{Gaussian, Kernel};
use crate::neighbour::{Neighbours, Searchable};
use crate::parameter::{Value, Values};
use crate::random::{self, Stream};
use crate::sample::{Drawn, Sample, Source};
use crate::selector::{LeastSquares, NormalReference, Selector};
use crate::uncertainty::{ErrorEstimate, Halves, Split};
use std::sync::Arc;

/// What a kernel says of itself; every [`Kernel`] does.
pub trait Constants: Send + Sync {
    /// K(u).
    fn value(&self, u: f64) -> f64;
    /// ∫ K².
    fn roughness(&self) -> f64;
    /// ∫ u² K.
    fn variance(&self) -> f64;
    /// ∫₋∞ᵗ uʳ K.
    fn partial_moment(&self, order: u32, below: f64) -> f64;
}

impl<K: Kernel> Constants for K {
    fn value(&self, u: f64) -> f64 {
        Kernel::value(*self, u)
    }
    fn roughness(&self) -> f64 {
        Kernel::roughness(*self)
    }
    fn variance(&self) -> f64 {
        Kernel::variance(*self)
    }
    fn partial_moment(&self, order: u32, below: f64) -> f64 {
        Kernel::partial_moment(*self, order, below)
    }
}

/// Names random streams: seed, purpose, number.
pub type Streams = Arc<dyn Fn(u64, &str, u64) -> Stream + Send + Sync>;
/// Makes a finder of neighbours.
pub type Finder = Arc<dyn Fn(&Sample<2>) -> Arc<dyn Neighbours<2>> + Send + Sync>;
/// Gives a mean its interval.
pub type MeanInterval = Arc<dyn Fn(&[f64], f64) -> Interval + Send + Sync>;

/// The implementations under examination. Cloning is cheap.
#[derive(Clone)]
pub struct Subjects {
    /// Names random streams.
    pub streams: Streams,
    /// A density on a line: Marron and Wand's number 6.
    pub density: Arc<dyn Univariate>,
    /// Draws from it.
    pub source: Arc<dyn Source<1>>,
    /// A kernel's own constants.
    pub kernel: Arc<dyn Constants>,
    /// Computes Gaussian kernel sums on a line.
    pub engine: Arc<dyn Engine<1>>,
    /// Computes radial kernel sums in the plane.
    pub plane_engine: Arc<dyn Engine<2>>,
    /// Does nothing about walls.
    pub ignore: Arc<dyn Boundary<1>>,
    /// Mirrors points in walls.
    pub reflect: Arc<dyn Boundary<1>>,
    /// The same in corners.
    pub corner: Arc<dyn Boundary<2>>,
    /// Local linear correction.
    pub linear: Arc<dyn Boundary<1>>,
    /// A kernel estimator with the Gaussian and h = `H`.
    pub kde: Arc<dyn Estimator<1>>,
    /// The same in the plane.
    pub plane_kde: Arc<dyn Estimator<2>>,
    /// A histogram with bins of `WIDTH` from -4.
    pub histogram: Arc<dyn Estimator<1>>,
    /// (k - 1)/(n V) with `K` neighbours.
    pub nearest: Arc<dyn Estimator<1>>,
    /// The same in the plane.
    pub plane_nearest: Arc<dyn Estimator<2>>,
    /// Finds neighbours in the plane.
    pub neighbours: Finder,
    /// 1.06 s n^(-1/5).
    pub reference: Arc<dyn Selector<1>>,
    /// Least-squares cross-validation.
    pub cross_validation: Arc<dyn Selector<1>>,
    /// The random error from `BATCHES` batches.
    pub halves: Arc<dyn ErrorEstimate<1>>,
    /// The interval of a mean.
    pub interval: MeanInterval,
}

/// The bandwidth of [`Subjects::kde`].
pub const H: f64 = 0.4;
/// The width of the bins of [`Subjects::histogram`].
pub const WIDTH: f64 = 0.5;
/// The neighbours of [`Subjects::nearest`].
pub const K: usize = 12;
/// The batches of [`Subjects::halves`].
pub const BATCHES: usize = 5;

/// The estimator of the catalogue with these settings.
pub fn built<const D: usize>(
    name: &str,
    settings: &[(&'static str, Value)],
) -> Arc<dyn Estimator<D>>
where
    Entry: Builds<D>,
{
    let entry = catalogue::estimator(name).expect("it is in the catalogue");
    let mut values = Values::defaults(entry.parameters);
    for (parameter, value) in settings {
        values.set(parameter, value.clone());
    }
    let context = Context {
        truth: None,
        draws: 1,
    };
    let built = entry.build(&values, &context);
    built.expect("the settings are legal").into()
}

impl Subjects {
    /// All well.
    ///
    /// # Panics
    /// If the catalogue lacks what it has.
    pub fn healthy() -> Self {
        let density = density::named("mw-6").expect("it is in the catalogue");
        Self {
            streams: Arc::new(random::stream),
            source: Arc::new(Drawn(density.clone())),
            density,
            kernel: Arc::new(Gaussian),
            engine: Arc::new(Hermite),
            plane_engine: Arc::new(Gather),
            ignore: Arc::new(Ignore),
            reflect: Arc::new(Reflect),
            corner: Arc::new(Reflect),
            linear: Arc::new(LocalLinear { positive: false }),
            kde: built("kernel", &[("bandwidth", Value::Number(H))]),
            plane_kde: built("kernel", &[("bandwidth", Value::Number(H))]),
            histogram: built(
                "histogram",
                &[
                    ("width", Value::Number(WIDTH)),
                    ("origin", Value::Number(-4.0)),
                ],
            ),
            nearest: built("nearest-neighbour", &[("k", Value::Count(K as u64))]),
            plane_nearest: built("nearest-neighbour", &[("k", Value::Count(K as u64))]),
            neighbours: Arc::new(|sample| sample.neighbours()),
            reference: Arc::new(NormalReference),
            cross_validation: Arc::new(LeastSquares),
            halves: Arc::new(Halves {
                batches: BATCHES,
                split: Split::Path,
            }),
            interval: Arc::new(mean_interval),
        }
    }

    /// The stream of a check, `number` of `purpose`.
    pub fn stream(&self, seed: u64, purpose: &str, number: usize) -> Stream {
        (self.streams)(seed, purpose, number as u64)
    }

    /// Replicate `number` of `draws` points from the source.
    ///
    /// # Panics
    /// If the source yields no sample.
    pub fn sample(&self, seed: u64, purpose: &str, number: usize, draws: usize) -> Sample<1> {
        let mut random = self.stream(seed, purpose, number);
        let sample = self.source.sample(draws, &mut random);
        sample.expect("a density draws finite points of its domain")
    }
}
