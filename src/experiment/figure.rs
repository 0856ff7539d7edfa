//! What a run draws.

use serde::Serialize;

/// One figure of the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Its title; made from the kind if the file gives none.
    pub title: String,
    /// What the reader should see in it.
    pub caption: String,
    /// The estimators shown; all if empty.
    pub estimators: Vec<String>,
    /// The sample size shown; the first if `None`.
    pub draws: Option<usize>,
    /// The region that errors are of; the whole grid if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// What it is.
    pub kind: FigureKind,
}

/// The kinds of figure. In files: `[[figure]]` with exactly one of these keys, for instance `curves = { show = ["truth", "sample"] }`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FigureKind {
    /// Estimates of the first sample over the truth.
    Curves {
        /// Any of `truth`, `sample` (the estimates of the first sample), `mean` and `band` (mean and ± one standard deviation over
        /// replicates), `rug` (the data).
        show: Vec<String>,
        /// One small panel an estimator instead of all in one.
        panels: bool,
    },
    /// A measure of each estimator with its interval, beside the exact value; of each source where there is one estimator and several sources.
    Errors {
        /// `mise`, `miae` or `mire`.
        measure: String,
    },
    /// How many modes the estimates have over the replicates.
    Modes {},
    /// MISE, bias² and variance against the swept parameter, simulated and exact.
    Sweep {
        /// The swept estimator.
        of: String,
        /// Vertical markers: any of `h_mise`, `h_amise`, `silverman`, `normal-reference`, `scott`.
        mark: Vec<String>,
    },
    /// The estimate at one place against the swept parameter: its mean and one standard deviation on each side, simulated and exact, and the truth.
    Spread {
        /// The swept estimator.
        of: String,
        /// The place: the target nearest to it is shown.
        at: Vec<f64>,
    },
    /// One small panel a source: truth and estimates of the first sample.
    Densities {},
    /// Maps of the plane.
    Maps {
        /// Any of `truth`, `sample` (the estimates of the first sample), `mean` (over replicates), `error` (the mean less the truth) and `size` (how far around each
        /// place the first sample was averaged).
        show: Vec<String>,
        /// Level lines at round values.
        levels: bool,
    },
    /// All sources that are flat pieces of surfaces in space, unfolded into one map for each estimator.
    Unfolded {
        /// Any of `points` (the first sample), `truth` and `sample` (the estimates from it).
        show: Vec<String>,
    },
    /// Pictures of the scenes that photons walk through, lit by each estimator from the hits of the first sample on all surfaces, beside one that needs no photons;
    /// and maps of what is wrong in each.
    Camera {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Rays for each pixel: so many by so many.
        rays: usize,
        /// The picture that judges is traced with so many paths from each place; if `None` it is lit by the reference.
        paths: Option<usize>,
    },
    /// The best bandwidth at each place beside the best for all, exactly and by leading terms.
    LocalBandwidth {
        /// The kernel.
        kernel: String,
    },
    /// Estimates and truth along a straight line through the plane.
    Section {
        /// Where the line begins.
        from: [f64; 2],
        /// Where it ends.
        to: [f64; 2],
        /// Any of `truth`, `sample` (the estimates of the first sample), `mean` and `band` (mean and ± one standard deviation over replicates, from the cells that
        /// the line passes through); or of `error` (root mean squared, over replicates) and `expected-error` (what the estimator expects on the first sample); or `size`.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        show: Vec<String>,
        /// One small panel an estimator instead of all in one.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        panels: bool,
    },
    /// True and estimated errors along a line, one panel an estimator.
    Uncertainty {
        /// In the plane, where on the second axis; its middle if not given.
        at: Option<f64>,
        /// Whether local differences are multiplied by their fitted factor.
        calibrated: bool,
    },
    /// A measure against the sample size, both logarithmic, simulated and exact, with the slope of each estimator.
    Convergence {
        /// `mise`, `miae` or `mire`.
        measure: String,
    },
    /// How often the interval about the estimate at each place holds the mean of the estimate and the truth.
    Coverage {},
    /// Measured and theoretical efficiency of each kernel.
    Efficiency {},
    /// A table: does an estimator keep mass, what does it do at walls, does it jump, does it adapt, what does it cost.
    ComparisonTable {},
}
