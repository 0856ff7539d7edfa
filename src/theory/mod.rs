//! Exact expectations, errors and optima without simulation: what Monte Carlo results are judged by.
//!
//! | question | answer |
//! |---|---|
//! | mean and variance of an estimate at a place | [`kernel_moments`], [`histogram_moments`], [`shifted_histogram_moments`], [`polygon_moments`], [`generalised_histogram_moments`], [`series_moments`], [`adaptive_moments`], [`plane_adaptive_moments`], [`neighbour_moments`] |
//! | the same of any estimate that is Σ κ(x, Xᵢ) / n | [`equivalent_moments`] |
//! | integrated bias², variance, MISE over the whole line | [`KernelError::at`], [`HistogramError::at`], [`SeriesError::at`], [`AdaptiveError::at`] |
//! | the same over an interval, and relative to f² (MIRE) | [`integrate_over`] |
//! | asymptotic error and its optimum | [`KernelError::asymptotic`], [`HistogramError::asymptotic`] |
//! | the best bandwidth, width or number of terms | [`KernelError::optimum`], [`HistogramError::optimum`], [`SeriesError::optimum`] |
//! | the same of all that an estimator is but for its width | [`Family`] |
//! | the same in the plane | [`PlaneKernelError`], [`PlaneHistogramError`], [`PlaneAdaptiveError`], [`plane_kernel_moments`], [`plane_equivalent_moments`], [`plane_histogram_moments`]; between walls [`WalledKernel`] |
//! | the best k and its error | [`NeighbourError`] |
//! | the best smoothing at one place | [`Family::best_at`] |
//! | asymptotics and optimum together | [`KernelError::oracle`], [`HistogramError::oracle`] |
//!
//! # What is exact
//! Nothing here is an expansion but what is called asymptotic. Integrals are sums over Gauss-Legendre panels cut at every place where the integrand
//! is not smooth, good to 1e-12 of the largest value; for a normal mixture and the Gaussian kernel they are closed forms.
//!
//! # Weighted samples
//! `draws` is a number of equally weighted points. Of a sample with unequal weights it is the effective size (Σw)²/Σw²: the mean of a kernel or binned
//! estimate does not depend on the weights, and its variance is that of a sample of this size.
//!
//! # References
//! Marron & Wand 1992, Exact Mean Integrated Squared Error, Annals of Statistics 20; Scott 1992, Multivariate Density Estimation, chapters 3 to 6;
//! Silverman 1986, section 3.3.

mod adaptive;
mod adaptive_error;
mod asymptotic;
mod autocorrelation;
mod binned;
mod family;
mod histogram;
mod integrated;
mod kernel;
mod local;
mod neighbour;
mod optimum;
mod patch;
mod plane;
mod pointwise;
mod series;

pub use adaptive::{adaptive_moments, geometric_mean};
pub use adaptive_error::{AdaptiveError, FixedPilot, WidthLaw};
pub use asymptotic::{Asymptotic, NoAsymptotics};
pub use binned::{
    generalised_histogram_moments, histogram_moments, polygon_moments, shifted_histogram_moments,
};
pub use family::{Family, FamilyError, MOST_TERMS, System};
pub use histogram::HistogramError;
pub use integrated::{Integrated, Over, integrate_over, panels_of};
pub use kernel::KernelError;
pub use local::Local;
pub use neighbour::{Convention, NeighbourError, best_neighbours, neighbour_moments};
pub use optimum::{Optimum, Oracle};
pub use patch::Support;
pub use plane::{
    PlaneAdaptiveError, PlaneHistogramError, PlaneKernelError, PlaneWidths, WalledKernel,
    kernel_oracle, plane_adaptive_moments, plane_equivalent_moments, plane_histogram_moments,
    plane_kernel_moments,
};
pub use pointwise::{equivalent_moments, kernel_cuts, kernel_moments};
pub use series::{SeriesError, Taper, series_moments, series_moments_in_plane};

/// Mean and variance of an estimate at one place, over samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// E f̂(x).
    pub mean: f64,
    /// var f̂(x).
    pub variance: f64,
}

impl Moments {
    /// Of the product with something independent, as of a kernel of one point on another axis.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        let square = |m: Self| m.mean.mul_add(m.mean, m.variance);
        let mean = self.mean * other.mean;
        Self {
            mean,
            // rounding must not make a variance negative where it vanishes
            variance: (square(self) * square(other) - mean * mean).max(0.0),
        }
    }
}

#[cfg(test)]
mod tests;
