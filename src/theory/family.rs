//! Families of estimates that differ in how much they smooth, and the member that is best.

use super::local::{Local, best_kernel_at, best_kernel_in_plane_at, best_neighbour_at};
use super::plane::{PlaneAdaptiveError, PlaneHistogramError};
use super::{
    AdaptiveError, Asymptotic, Convention, FixedPilot, HistogramError, Integrated, KernelError,
    NeighbourError, NoAsymptotics, Optimum, PlaneKernelError, SeriesError, Taper, WidthLaw,
};
use crate::density::{Bivariate, Density, Univariate};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::numeric::orthogonal::{Cosine, Fourier, Hermite, Legendre, Placed};
use crate::space::Point;

/// All that an estimator is but for its bandwidth, width, k or number of terms, where the exact error of each member is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// Kernel estimates, by bandwidth; in the plane with a product of kernels.
    Kernel(Shape),
    /// The same in the plane with a kernel of the distance; on a line there is no difference.
    RadialKernel(Shape),
    /// Means of so many histograms (of one, the histogram), by the width of a bin.
    ShiftedHistogram {
        /// How many.
        shifts: u32,
        /// An edge of a bin of the first.
        origin: f64,
    },
    /// Histograms of the plane with square bins, by the width of a bin.
    SquareHistogram {
        /// A corner of a bin.
        origin: Point<2>,
        /// By what angle the bins are turned, in degrees.
        degrees: f64,
    },
    /// Straight lines between the middles of a histogram's bars, by the width of a bin.
    FrequencyPolygon {
        /// An edge of a bin.
        origin: f64,
    },
    /// Kernel estimates whose widths follow a fixed pilot, by h.
    Adaptive {
        /// The kernel.
        shape: Shape,
        /// What becomes of it in the plane.
        symmetry: Symmetry,
        /// How widths follow.
        law: WidthLaw,
        /// What they follow.
        pilot: FixedPilot,
    },
    /// Nearest-neighbour estimates, by k.
    Neighbour(Convention),
    /// Orthogonal series on a line, by the number of terms.
    Series {
        /// The functions.
        system: System,
        /// The ends of their interval, or the location and scale of Hermite's functions; what is not given is that of the density.
        place: [Option<f64>; 2],
        /// How the terms fade.
        taper: Taper,
    },
}

/// A system of orthonormal functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// √2 cos πku on an interval.
    Cosine,
    /// Legendre polynomials on an interval.
    Legendre,
    /// Sines and cosines of whole periods on an interval.
    Fourier,
    /// Hermite functions on the line.
    Hermite,
}

/// The most terms among which the best number is looked for: finding their errors costs their square.
pub const MOST_TERMS: usize = 300;

/// The errors of all members of a family for one density.
pub struct FamilyError<'a>(Errors<'a>);

enum Errors<'a> {
    Kernel(KernelError),
    PlaneKernel(PlaneKernelError),
    Histogram(HistogramError<'a>),
    PlaneHistogram(PlaneHistogramError<'a>),
    Adaptive(AdaptiveError<'a>),
    PlaneAdaptive(PlaneAdaptiveError<'a>),
    Neighbour(NeighbourError<'a>, Convention),
    Series(SeriesErrors, Taper),
}

enum SeriesErrors {
    Cosine(SeriesError<Cosine>),
    Legendre(SeriesError<Legendre>),
    Fourier(SeriesError<Fourier>),
    Hermite(SeriesError<Hermite>),
}

/// The ends of the interval of a series, given or those of the density; `None` if there are none.
fn ends(truth: &dyn Univariate, [first, second]: [Option<f64>; 2]) -> Option<[f64; 2]> {
    let domain = truth.domain();
    let low = first.unwrap_or(domain.low()[0]);
    let high = second.unwrap_or(domain.high()[0]);
    ((high - low).is_finite() && low < high).then_some([low, high])
}

impl SeriesErrors {
    /// `None` where the density gives an interval no ends.
    fn new(truth: &dyn Univariate, system: System, place: [Option<f64>; 2]) -> Option<Self> {
        let most = MOST_TERMS;
        if system == System::Hermite {
            let (mean, deviation) = truth.mean_and_deviation();
            let [first, second] = place;
            let placed = Placed::about(first.unwrap_or(mean), 0.0, second.unwrap_or(deviation));
            return Some(Self::Hermite(SeriesError::new(truth, placed, most)));
        }
        let [low, high] = ends(truth, place)?;
        Some(match system {
            System::Cosine => {
                Self::Cosine(SeriesError::new(truth, Placed::between(low, high), most))
            }
            System::Legendre => {
                Self::Legendre(SeriesError::new(truth, Placed::between(low, high), most))
            }
            _ => Self::Fourier(SeriesError::new(truth, Placed::between(low, high), most)),
        })
    }

    fn at(&self, terms: usize, taper: Taper, draws: f64) -> Integrated {
        match self {
            Self::Cosine(errors) => errors.at(terms, taper, draws),
            Self::Legendre(errors) => errors.at(terms, taper, draws),
            Self::Fourier(errors) => errors.at(terms, taper, draws),
            Self::Hermite(errors) => errors.at(terms, taper, draws),
        }
    }

    fn optimum(&self, taper: Taper, draws: f64) -> (usize, Integrated) {
        match self {
            Self::Cosine(errors) => errors.optimum(taper, draws),
            Self::Legendre(errors) => errors.optimum(taper, draws),
            Self::Fourier(errors) => errors.optimum(taper, draws),
            Self::Hermite(errors) => errors.optimum(taper, draws),
        }
    }
}

impl FamilyError<'_> {
    /// The errors of the member that smooths by `amount` (a bandwidth, a width, k or a number of terms), over samples of `draws` points; `None` for
    /// an amount that the family does not have.
    pub fn at(&self, amount: f64, draws: f64) -> Option<Integrated> {
        let whole = |least: usize, most: usize| {
            let count = amount as usize;
            let fits = amount.fract() == 0.0 && (least..=most).contains(&count);
            fits.then_some(count)
        };
        Some(match &self.0 {
            Errors::Kernel(errors) => errors.at(amount, draws),
            Errors::PlaneKernel(errors) => errors.at([amount; 2], draws),
            Errors::Histogram(errors) => errors.at(amount, draws),
            Errors::PlaneHistogram(errors) => errors.at(amount, draws),
            Errors::Adaptive(errors) => errors.at(amount, draws),
            Errors::PlaneAdaptive(errors) => errors.at(amount, draws),
            Errors::Neighbour(errors, convention) => {
                errors.at(whole(3, draws as usize)?, *convention, draws as usize)
            }
            Errors::Series(errors, taper) => errors.at(whole(1, MOST_TERMS)?, *taper, draws),
        })
    }

    /// The member of least error, and the other local minima where they are known.
    pub fn optimum(&self, draws: f64) -> Optimum {
        let count = |(at, error): (usize, Integrated)| Optimum {
            at: at as f64,
            error,
            others: Vec::new(),
        };
        match &self.0 {
            Errors::Kernel(errors) => errors.optimum(draws),
            Errors::PlaneKernel(errors) => errors.optimum(draws),
            Errors::Histogram(errors) => errors.optimum(draws),
            Errors::PlaneHistogram(errors) => errors.optimum(draws),
            Errors::Adaptive(errors) => errors.optimum(draws),
            Errors::PlaneAdaptive(errors) => errors.optimum(draws),
            Errors::Neighbour(errors, convention) => {
                count(errors.optimum(*convention, draws as usize))
            }
            Errors::Series(errors, taper) => count(errors.optimum(*taper, draws)),
        }
    }
}

impl Family {
    /// Whether its errors are those of estimates from data. They are not of a pilot that is smoothed without noise: an estimate of the pilot from the same data has some, and errors of its own (of 1000 points of the bimodal density with h = 0.25 and a pilot of 0.3 a third more, by simulation).
    pub fn is_of_estimates(self) -> bool {
        !matches!(
            self,
            Self::Adaptive {
                pilot: FixedPilot::Smoothed(_) | FixedPilot::Tied,
                ..
            }
        )
    }

    /// What its members differ in.
    pub fn parameter(self) -> &'static str {
        match self {
            Self::Kernel(_) | Self::RadialKernel(_) | Self::Adaptive { .. } => "bandwidth",
            Self::ShiftedHistogram { .. }
            | Self::SquareHistogram { .. }
            | Self::FrequencyPolygon { .. } => "width",
            Self::Neighbour(_) => "k",
            Self::Series { .. } => "terms",
        }
    }

    /// The errors of its members on a line; `None` where they are not known, or a series has no ends.
    pub fn errors(self, truth: &dyn Univariate) -> Option<FamilyError<'_>> {
        Some(FamilyError(match self {
            Self::Kernel(shape) | Self::RadialKernel(shape) => {
                Errors::Kernel(KernelError::new(truth, shape))
            }
            Self::ShiftedHistogram { shifts, origin } => {
                Errors::Histogram(HistogramError::shifted(truth, origin, shifts))
            }
            Self::FrequencyPolygon { origin } => {
                Errors::Histogram(HistogramError::polygon(truth, origin))
            }
            Self::Adaptive {
                shape, law, pilot, ..
            } if law.is_held() => Errors::Adaptive(AdaptiveError::new(truth, shape, law, pilot)),
            Self::Adaptive { .. }
            | Self::SquareHistogram { .. }
            | Self::Neighbour(Convention::MeanRadius) => return None,
            Self::Neighbour(convention) => {
                Errors::Neighbour(NeighbourError::on_line(truth), convention)
            }
            Self::Series {
                system,
                place,
                taper,
            } => Errors::Series(SeriesErrors::new(truth, system, place)?, taper),
        }))
    }

    /// The same in the plane.
    pub fn errors_in_plane(self, truth: &dyn Bivariate) -> Option<FamilyError<'_>> {
        Some(FamilyError(match self {
            Self::Kernel(shape) => {
                Errors::PlaneKernel(PlaneKernelError::new(truth, shape, Symmetry::Product)?)
            }
            Self::RadialKernel(shape) => {
                Errors::PlaneKernel(PlaneKernelError::new(truth, shape, Symmetry::Radial)?)
            }
            Self::SquareHistogram { origin, degrees } => {
                Errors::PlaneHistogram(PlaneHistogramError::new(truth, origin, degrees)?)
            }
            Self::Adaptive {
                shape,
                symmetry,
                law,
                pilot,
            } => Errors::PlaneAdaptive(PlaneAdaptiveError::new(
                truth,
                (shape, symmetry),
                law,
                pilot,
            )?),
            Self::Neighbour(convention) if convention != Convention::MeanRadius => {
                Errors::Neighbour(NeighbourError::in_plane(truth)?, convention)
            }
            _ => return None,
        }))
    }

    /// Whether [`Family::optimum_of`] knows the errors of its members for a density, at little cost.
    pub fn has_errors<const D: usize>(self, truth: &dyn Density<D>) -> bool {
        match (truth.univariate(), self) {
            (Some(line), Self::Series { system, place, .. }) => {
                system == System::Hermite || ends(line, place).is_some()
            }
            (Some(_), Self::Adaptive { law, .. }) => law.is_held(),
            (Some(_), Self::SquareHistogram { .. } | Self::Neighbour(Convention::MeanRadius)) => {
                false
            }
            (Some(_), _) => true,
            (None, Self::Neighbour(convention)) => {
                convention != Convention::MeanRadius && !truth.domain().wraps()
            }
            (None, _) => {
                let plane = truth.bivariate();
                plane.is_some_and(|plane| self.errors_in_plane(plane).is_some())
            }
        }
    }

    /// The member of least MISE over the whole line for samples of `draws` points from `truth`, and all other local minima; `None` as for
    /// [`Family::errors`]. Cost: some hundred evaluations of the error, which are microseconds to milliseconds each.
    pub fn optimum(self, truth: &dyn Univariate, draws: f64) -> Option<Optimum> {
        Some(self.errors(truth)?.optimum(draws))
    }

    /// The same for a density on a line or in the plane.
    pub fn optimum_of<const D: usize>(self, truth: &dyn Density<D>, draws: f64) -> Option<Optimum> {
        match truth.univariate() {
            Some(line) => self.optimum(line, draws),
            None => Some(self.errors_in_plane(truth.bivariate()?)?.optimum(draws)),
        }
    }

    /// The leading terms for large samples.
    ///
    /// # Errors
    /// If the density is not smooth enough to have them, or none are known.
    pub fn asymptotic(
        self,
        truth: &dyn Univariate,
        draws: f64,
    ) -> Result<Asymptotic, NoAsymptotics> {
        match self {
            Self::Kernel(shape) | Self::RadialKernel(shape) => Asymptotic::of_kernel(
                shape.variance(),
                shape.roughness(),
                truth.roughness(2),
                draws,
            ),
            Self::ShiftedHistogram { shifts, origin } => {
                HistogramError::shifted(truth, origin, shifts).asymptotic(draws)
            }
            Self::FrequencyPolygon { origin } => {
                HistogramError::polygon(truth, origin).asymptotic(draws)
            }
            Self::Adaptive { .. } => Err(NoAsymptotics::Adaptive),
            Self::SquareHistogram { .. } | Self::Neighbour(_) | Self::Series { .. } => {
                Err(NoAsymptotics::Unknown)
            }
        }
    }

    /// The same in the plane.
    ///
    /// # Errors
    /// As on a line.
    pub fn asymptotic_in_plane(
        self,
        truth: &dyn Bivariate,
        draws: f64,
    ) -> Result<Asymptotic, NoAsymptotics> {
        let kernel = |shape, symmetry: Symmetry| {
            Asymptotic::of_plane_kernel(
                symmetry.variance::<2>(shape),
                symmetry.roughness::<2>(shape),
                truth.laplacian_roughness(),
                draws,
            )
        };
        match self {
            Self::Kernel(shape) => kernel(shape, Symmetry::Product),
            Self::RadialKernel(shape) => kernel(shape, Symmetry::Radial),
            Self::SquareHistogram { .. } => {
                Asymptotic::of_plane_histogram(truth.gradient_roughness(), draws)
            }
            Self::Adaptive { .. } => Err(NoAsymptotics::Adaptive),
            _ => Err(NoAsymptotics::Unknown),
        }
    }

    /// The member of least mean squared error at one place, for kernels and neighbours; `None` for the others, whose errors at a place depend on where
    /// bins or waves happen to lie.
    pub fn best_at<const D: usize>(
        self,
        truth: &dyn Density<D>,
        draws: f64,
        place: Point<D>,
    ) -> Option<Local> {
        let (shape, symmetry) = match self {
            Self::Kernel(shape) => (shape, Symmetry::Product),
            Self::RadialKernel(shape) => (shape, Symmetry::Radial),
            Self::Neighbour(convention) => {
                return best_neighbour_at(truth, convention, draws as usize, place);
            }
            _ => return None,
        };
        match (truth.univariate(), &place[..]) {
            (Some(line), &[x]) => Some(best_kernel_at(line, shape, draws, x)),
            (_, &[x, y]) => {
                let plane = truth.bivariate()?;
                Some(best_kernel_in_plane_at(
                    plane,
                    (shape, symmetry),
                    draws,
                    [x, y],
                ))
            }
            _ => None,
        }
    }
}
