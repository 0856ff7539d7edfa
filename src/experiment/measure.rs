//! What is measured of an estimator.

use serde::Serialize;

/// A quantity that a claim is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Mean of ∫(f̂ - f)² over replicates.
    Mise,
    /// Mean of ∫|f̂ - f|.
    Miae,
    /// Mean of ∫((f̂ - f)/f)² where f is at least 1 % of its peak.
    Mire,
    /// Mean of f̂ - f over the cells, with its sign.
    Bias,
    /// ∫(E f̂ - f)², from replicates, corrected for the variance of the mean.
    Bias2,
    /// ∫ var f̂, from replicates.
    Variance,
    /// ∫f̂ / ∫f over the grid.
    Energy,
    /// The number of local maxima on the grid.
    Modes,
    /// The bandwidth or width used.
    Smoothing,
    /// MISE over that of the best of its family: with the bandwidth, width, k or number of terms of least exact MISE over the whole line or plane; between walls of a line and where the grid is cut short, over the grid.
    OverBest,
    /// MISE over that of the best Gaussian kernel estimate of one bandwidth, reflected at walls (cut and normalised in a polygon): the same rung for all estimators.
    OverKernel,
    /// MISE over that of the same kernel with the best bandwidth at each place, which no Gaussian kernel of one bandwidth can reach: the next rung for all.
    OverLocalKernel,
    /// ∫f̂ of points spread evenly between walls, over their mass: see [`super::character`].
    Mass,
    /// The estimate of these points beside a wall, over the density there.
    Wall,
    /// The largest jump of the estimate of the first sample, over its range of values.
    Jump,
    /// The exact expectation of [`Measure::Mise`], by theory.
    ExactMise,
    /// The exact ∫ bias².
    ExactBias2,
    /// The exact ∫ variance.
    ExactVariance,
}

impl Measure {
    /// All measures.
    pub const ALL: [Self; 18] = [
        Self::Mise,
        Self::Miae,
        Self::Mire,
        Self::Bias,
        Self::Bias2,
        Self::Variance,
        Self::Energy,
        Self::Modes,
        Self::Smoothing,
        Self::OverBest,
        Self::OverKernel,
        Self::OverLocalKernel,
        Self::Mass,
        Self::Wall,
        Self::Jump,
        Self::ExactMise,
        Self::ExactBias2,
        Self::ExactVariance,
    ];

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mise => "mise",
            Self::Miae => "miae",
            Self::Mire => "mire",
            Self::Bias => "bias",
            Self::Bias2 => "bias2",
            Self::Variance => "variance",
            Self::Energy => "energy",
            Self::Modes => "modes",
            Self::Smoothing => "smoothing",
            Self::OverBest => "over-best",
            Self::OverKernel => "over-kernel",
            Self::OverLocalKernel => "over-local-kernel",
            Self::Mass => "mass",
            Self::Wall => "wall",
            Self::Jump => "jump",
            Self::ExactMise => "exact-mise",
            Self::ExactBias2 => "exact-bias2",
            Self::ExactVariance => "exact-variance",
        }
    }

    /// Whether it is a single number without chance, measured on a probe where a `comparison-table` or a claim asks for it; only on a line.
    pub fn is_probe(self) -> bool {
        matches!(self, Self::Mass | Self::Wall | Self::Jump)
    }

    /// Whether it is an error over one of [`super::Ladder`].
    pub fn is_over_ladder(self) -> bool {
        matches!(
            self,
            Self::OverBest | Self::OverKernel | Self::OverLocalKernel
        )
    }

    /// Whether theory gives it, not the replicates.
    pub fn is_exact(self) -> bool {
        matches!(
            self,
            Self::ExactMise | Self::ExactBias2 | Self::ExactVariance
        )
    }

    /// Whether the measure needs a known truth.
    pub fn needs_truth(self) -> bool {
        !matches!(self, Self::Modes | Self::Smoothing | Self::Energy)
    }
}
