//! The k-nearest-neighbour estimator in its three conventions.

use super::balloon::{Ball, Rule, fit};
use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::density::Density;
use crate::neighbour::{Scratch, Searchable};
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::selector::{NeighbourRule, Neighbours};
use crate::space::Point;
use crate::theory::{Convention, neighbour_moments};

/// f̂(x) = m / V, the mass m of the k nearest points over the volume V of the ball about x that holds them.
///
/// | convention | f̂ with equal weights | mean where the density is even |
/// |---|---|---|
/// | `unbiased` | (k - 1) / (n V(d_k)) | f |
/// | `raw` | k / (n V(d_k)) | f k/(k - 1) |
/// | `mean-radius` | k / (n V((d_k + d_(k+1)) / 2)) | about f (1 + 1/(2k)) |
///
/// with d_k the distance to the k-th and V(r) = 2r on the line, πr² in the plane (less where a periodic axis makes the ball meet itself). Where the density is
/// even, n f V(d_k) has the Γ(k) distribution, so the coefficient of variation is 1/√(k - 2) whatever n is: infinite variance at k = 2,
/// and at k = 1, which is refused, not even a mean.
///
/// **Limits.** The integral is not 1: far from the data f̂ falls off like 1/|x| on the line and 1/|x|² in the plane. Walls are not seen: at an edge half
/// the ball is empty, and the estimate is near half of the density. Weights do not change which points are neighbours, only the mass they bring; among points
/// equally far, which is the k-th is not known, and each brings the same share. At a place where k points or more coincide, d_k would be 0 and
/// f̂ infinite; the first neighbour farther away is taken instead, with k the number of points out to it, and a warning.
///
/// k is a number, or chosen by leaving each datum out: see [`Neighbours`], which also says what may go wrong.
#[derive(Clone, Copy, Debug)]
pub struct NearestNeighbour {
    rank: Rank,
    convention: Convention,
}

/// Where k comes from.
#[derive(Clone, Copy, Debug)]
enum Rank {
    Number(usize),
    Chosen(NeighbourRule),
}

impl NearestNeighbour {
    /// With the `k`-th neighbour, k ≥ 2.
    pub fn new(k: usize, convention: Convention) -> Self {
        Self {
            rank: Rank::Number(k.max(2)),
            convention,
        }
    }
}

impl<const D: usize> Rule<D> for Convention {
    fn density(self, ball: &Ball<'_, D>, scratch: &mut Scratch) -> f64 {
        let k = ball.rank as f64;
        let radius = match self {
            Self::MeanRadius => ball
                .next(scratch)
                .map_or(ball.radius(), |next| 0.5 * (ball.radius() + next)),
            Self::Raw | Self::Unbiased => ball.radius(),
        };
        let mass = match self {
            Self::Unbiased => ball.mass() * ((k - 1.0) / k),
            Self::Raw | Self::MeanRadius => ball.mass(),
        };
        mass / ball.metric().ball(radius)
    }
}

impl<const D: usize> Estimator<D> for NearestNeighbour
where
    Sample<D>: Searchable<D>,
{
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: false,
            non_negative: true,
            linear: false,
            // with unequal weights the mass jumps where one point takes the place of another
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: false,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: false,
        }
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        let (k, warnings) = match self.rank {
            Rank::Number(k) => (k, Vec::new()),
            Rank::Chosen(rule) => {
                let chosen = Neighbours::new(sample).choose(rule)?;
                (chosen.k, chosen.warnings)
            }
        };
        let least = match self.convention {
            Convention::MeanRadius => k + 1,
            Convention::Raw | Convention::Unbiased => k,
        };
        let mut estimate = fit(sample, k, least, self.convention)?;
        estimate.smoothing = Some(k as f64);
        estimate.warnings.extend(warnings);
        Ok(estimate)
    }

    fn expectation(
        &self,
        truth: &dyn Density<D>,
        draws: usize,
        places: &[Point<D>],
    ) -> Option<Vec<Moments>> {
        let Rank::Number(k) = self.rank else {
            return None;
        };
        neighbour_moments(truth, k, self.convention, draws, places)
    }

    fn family(&self) -> Option<Family> {
        (self.convention != Convention::MeanRadius).then_some(Family::Neighbour(self.convention))
    }
}

/// How many neighbours.
pub(super) const K: Parameter = Parameter::required(
    "k",
    Kind::Count {
        least: 2,
        most: 1_000_000_000,
    },
    "which neighbour gives the radius, at most the number of points",
)
.swept();

/// The same, or a rule.
const CHOSEN_K: Parameter = Parameter {
    kind: Kind::CountOr {
        least: 2,
        most: 1_000_000_000,
        words: &NeighbourRule::NAMES,
    },
    ..K
};

impl Described for NearestNeighbour {
    const NAME: &'static str = "nearest-neighbour";
    const SUMMARY: &'static str =
        "the mass of the k nearest points over the size of the ball that holds them";
    const COST: &'static str = "O(n log n + m log n) on a line; O(n + m √k) in the plane where the data are spread evenly, O((n + m k) log n) else";
    const REFERENCE: &'static str =
        "Loftsgaarden & Quesenberry 1965; Silverman 1986, eq. 5.1; Schregle 2003 (mean radius)";
    const SMOOTHING: Option<&'static str> = Some("k");
    const PARAMETERS: &'static [Parameter] = &[
        CHOSEN_K,
        Parameter::optional(
            "convention",
            Kind::Choice(&Convention::NAMES),
            Absent::Word("unbiased"),
            "(k - 1)/(n V), k/(n V), or k over the ball of the mean radius of neighbours k and k + 1",
        ),
    ];
}

impl<const D: usize> Build<D> for NearestNeighbour
where
    Sample<D>: Searchable<D>,
{
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let convention = values
            .word("convention")
            .and_then(Convention::named)
            .unwrap_or(Convention::Unbiased);
        let Some(rule) = values.word("k").and_then(NeighbourRule::named) else {
            return Ok(Self::new(k(values), convention));
        };
        if rule == NeighbourRule::LeastSquares && D > 1 {
            return Err(BuildError {
                parameter: "k",
                what: "\"lscv\" chooses k on the line only; in the plane give a number or \"likelihood-cross-validation\"".to_owned(),
            });
        }
        Ok(Self {
            rank: Rank::Chosen(rule),
            convention,
        })
    }
}

/// The value of [`K`].
pub(super) fn k(values: &Values) -> usize {
    let k = values.count("k").expect("required");
    usize::try_from(k).unwrap_or(usize::MAX)
}
