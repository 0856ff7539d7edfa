//! Selectors of the plane. Here the rules of thumb: the AMISE-optimal widths if the density were a normal with independent axes; least-squares cross-validation is in `least_squares.rs`.
//!
//! | selector | widths |
//! |---|---|
//! | silverman | one for both axes, from the mean of the variances |
//! | normal-reference, scott | one an axis, in proportion to its deviation, or to the lesser of deviation and quartile range |
//! | lscv | one an axis, both free |
//! | lscv-common | one for both axes |
//!
//! For the Gaussian kernel and d axes the best width of axis a is (4 / (d + 2))^(1/(d+4)) σₐ n^(-1/(d+4)); in the plane the factor is 1, so that h = σ n^(-1/6). Other kernels,
//! product and radial, get equally smooth widths by the ratio of canonical scales (see [`Symmetry::canonical_scale`]).
//!
//! # References
//! Silverman 1986, section 4.3.2, eqs 4.14-4.15; Scott 1992, Multivariate Density Estimation, eq. 6.42; Wand & Jones 1995, Kernel Smoothing, section 4.7 (normal scale).

mod least_squares;
mod rounding;

pub use least_squares::PlaneLeastSquares;

use super::rules::spread;
use super::{NormalReference, PlaneEntry, Scott, SelectError, Selection, Selector, Silverman};
use crate::kernel::{Bandwidth, Shape, Symmetry};
use crate::sample::{Sample, SampleError};
use crate::space::{Domain, Warning};

/// The name of the one selector that the line has not.
pub(super) const COMMON: &str = "lscv-common";

const RULES: &str =
    "Silverman 1986, section 4.3.2; Scott 1992, eq. 6.42; Wand & Jones 1995, section 4.7";
const CROSS: &str = "Rudemo 1982; Bowman 1984; Sain, Baggerly & Scott 1994, JASA 89, eq. 8";

/// See [`super::PLANE`].
pub(super) const ENTRIES: &[PlaneEntry] = &[
    PlaneEntry {
        name: "silverman",
        summary: "one width for both axes: n^(-1/6) times the root of the mean variance, best for a round normal",
        cost: "O(n)",
        reference: RULES,
        build: |symmetry| Box::new(NormalScale::common(symmetry)),
    },
    PlaneEntry {
        name: "normal-reference",
        summary: "a width for each axis: n^(-1/6) times its deviation, best for a normal with independent axes",
        cost: "O(n)",
        reference: RULES,
        build: |symmetry| Box::new(NormalScale::deviations(symmetry)),
    },
    PlaneEntry {
        name: "scott",
        summary: "a width for each axis: n^(-1/6) times the lesser of its deviation and its quartile range / 1.34",
        cost: "O(n)",
        reference: RULES,
        build: |symmetry| Box::new(NormalScale::robust(symmetry)),
    },
    PlaneEntry {
        name: "lscv",
        summary: "least-squares cross-validation with the kernel itself over both widths: the least unbiased estimate of MISE",
        cost: "O(n² · share of pairs in reach) a pair of widths up to 1000 points, beyond O(n + 1024²) once and O(lags in reach) a pair",
        reference: CROSS,
        build: |symmetry| Box::new(PlaneLeastSquares::each_axis(symmetry)),
    },
    PlaneEntry {
        name: COMMON,
        summary: "the same with one width for both axes, which follows rotations; of the plane only",
        cost: "as lscv",
        reference: CROSS,
        build: |symmetry| Box::new(PlaneLeastSquares::common(symmetry)),
    },
];

/// A rule of thumb for a kernel of the plane that is radial or a product.
#[derive(Clone, Copy, Debug)]
pub struct NormalScale {
    rule: Rule,
    symmetry: Symmetry,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rule {
    /// One width for both axes, from the mean of the variances. [Silverman 1986, p. 87]
    Common,
    /// Each axis its own deviation. [Wand & Jones 1995, section 4.7]
    Deviations,
    /// Each axis its own min(s, IQR/1.34), as on the line. [Scott 1992, eq. 6.42]
    Robust,
}

impl NormalScale {
    /// One width for both axes.
    pub const fn common(symmetry: Symmetry) -> Self {
        Self {
            rule: Rule::Common,
            symmetry,
        }
    }

    /// Each axis its own, from its deviation.
    pub const fn deviations(symmetry: Symmetry) -> Self {
        Self {
            rule: Rule::Deviations,
            symmetry,
        }
    }

    /// Each axis its own, from the lesser of deviation and quartile range.
    pub const fn robust(symmetry: Symmetry) -> Self {
        Self {
            rule: Rule::Robust,
            symmetry,
        }
    }
}

/// The coordinates on one axis, with the weights, as a sample of their own.
fn marginal(sample: &Sample<2>, axis: usize) -> Result<Sample<1>, SampleError> {
    let coordinates = sample.points().iter().map(|x| [x[axis]]).collect();
    Sample::new(coordinates, sample.weights().clone(), Domain::whole())
}

/// The spread of each axis, or of both together, as `rule` measures it.
fn spreads(sample: &Sample<2>, rule: Rule) -> Result<([f64; 2], Vec<Warning>), SelectError> {
    let mut warnings: Vec<Warning> = Vec::new();
    let mut spreads = [0.0; 2];
    for axis in 0..2 {
        let marginal = marginal(sample, axis).expect("a sample has legal coordinates and weights");
        match spread(&marginal, rule == Rule::Robust) {
            Ok((found, more)) => {
                spreads[axis] = found;
                warnings.extend(more);
            }
            // one axis without spread is no obstacle where the width is common
            Err(_) if rule == Rule::Common => {}
            Err(error) => return Err(error),
        }
    }
    if rule == Rule::Common {
        // scaled by the larger so that nothing overflows
        let most = spreads[0].max(spreads[1]);
        if most <= 0.0 {
            return Err(SelectError::NoSpread {
                points: sample.len(),
                place: sample.points()[0][0],
            });
        }
        let mean = spreads.map(|s| (s / most).powi(2)).iter().sum::<f64>() / 2.0;
        spreads = [most * mean.sqrt(); 2];
    }
    warnings.dedup();
    Ok((spreads, warnings))
}

impl Selector<2> for NormalScale {
    fn name(&self) -> &'static str {
        match self.rule {
            Rule::Common => "silverman",
            Rule::Deviations => "normal-reference",
            Rule::Robust => "scott",
        }
    }

    fn select(&self, sample: &Sample<2>, shape: Shape) -> Result<Selection<2>, SelectError> {
        let (spreads, warnings) = spreads(sample, self.rule)?;
        let scale = self.symmetry.canonical_scale::<2>(shape)
            / Symmetry::Product.canonical_scale::<2>(Shape::Gaussian);
        let factor = sample.effective_size().powf(-1.0 / 6.0) * scale;
        Ok(Selection {
            bandwidth: Bandwidth::Fixed(spreads.map(|s| factor * s)),
            warnings,
        })
    }
}

macro_rules! for_products {
    ($type:ident, $name:literal, $rule:ident) => {
        /// The rule for product kernels; see [`NormalScale`] for radial ones.
        impl Selector<2> for $type {
            fn name(&self) -> &'static str {
                $name
            }

            fn select(
                &self,
                sample: &Sample<2>,
                shape: Shape,
            ) -> Result<Selection<2>, SelectError> {
                NormalScale::$rule(Symmetry::Product).select(sample, shape)
            }
        }
    };
}

for_products!(Silverman, "silverman", common);
for_products!(NormalReference, "normal-reference", deviations);
for_products!(Scott, "scott", robust);

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::sample::Summary;

    fn points() -> Vec<[f64; 2]> {
        (0..64)
            .map(|i| {
                let t = f64::from(i);
                [
                    (t * 0.618_034).fract(),
                    5.0 * (t * 0.414_214).fract().powi(2),
                ]
            })
            .collect()
    }

    fn named(name: &str, symmetry: Symmetry) -> Box<dyn Selector<2>> {
        (crate::selector::plane_entry_of(name).unwrap().build)(symmetry)
    }

    fn chosen(name: &str, symmetry: Symmetry, shape: Shape, sample: &Sample<2>) -> [f64; 2] {
        let rule = named(name, symmetry);
        assert_eq!(rule.name(), name);
        match rule.select(sample, shape).unwrap().bandwidth {
            Bandwidth::Fixed(h) => h,
            _ => unreachable!("a rule of thumb gives numbers"),
        }
    }

    #[test]
    fn the_rules_have_their_textbook_factors() {
        let sample = Sample::equal(points(), Domain::whole()).unwrap();
        let marginals = [0, 1].map(|axis| Summary::of(&marginal(&sample, axis).unwrap()));
        // 64^(1/6) = 2
        let own = chosen(
            "normal-reference",
            Symmetry::Product,
            Shape::Gaussian,
            &sample,
        );
        let robust = chosen("scott", Symmetry::Product, Shape::Gaussian, &sample);
        let common = chosen("silverman", Symmetry::Product, Shape::Gaussian, &sample);
        let mean = marginals.iter().map(|s| s.deviation.powi(2)).sum::<f64>() / 2.0;
        for axis in 0..2 {
            let s = &marginals[axis];
            assert!((own[axis] - s.deviation / 2.0).abs() < 1e-12);
            let least = s.deviation.min(s.interquartile_range / 1.34);
            assert!((robust[axis] - least / 2.0).abs() < 1e-12);
            assert!((common[axis] - mean.sqrt() / 2.0).abs() < 1e-12);
        }
        // δ₀ of the radial Epanechnikov kernel (4/(3π) · 36)^(1/6) over that of the Gaussian (1/(4π))^(1/6)
        let radial = chosen("scott", Symmetry::Radial, Shape::Epanechnikov, &sample);
        let ratio = (16.0 * 36.0 / 3.0_f64).powf(1.0 / 6.0);
        assert!((radial[0] / robust[0] - ratio).abs() < 1e-12);
    }

    #[test]
    fn weights_count_by_their_effective_size_and_no_spread_is_refused() {
        let sample = Sample::equal(points(), Domain::whole()).unwrap();
        // half of the points weigh nothing: as if they were not there
        let half: Vec<[f64; 2]> = points().into_iter().step_by(2).collect();
        let weights: Vec<f64> = (0..64).map(|i| f64::from((i + 1) % 2)).collect();
        let weighted = Sample::normalised(points(), weights, Domain::whole()).unwrap();
        let half = Sample::equal(half, Domain::whole()).unwrap();
        for name in ["silverman", "normal-reference"] {
            let with = |sample| chosen(name, Symmetry::Product, Shape::Biweight, sample);
            for axis in 0..2 {
                let (a, b) = (with(&weighted)[axis], with(&half)[axis]);
                // the deviation of a weighted sample may divide by n_eff - 1 or n_eff
                assert!((a / b - 1.0).abs() < 0.02, "{name}: {a} {b}");
                assert!((with(&sample)[axis] / b - 1.0).abs() > 0.02);
            }
        }
        let flat: Vec<[f64; 2]> = points().iter().map(|x| [x[0], 2.0]).collect();
        let flat = Sample::equal(flat, Domain::whole()).unwrap();
        let rule = |name: &str| named(name, Symmetry::Radial);
        for name in ["normal-reference", "scott"] {
            let refused = rule(name).select(&flat, Shape::Gaussian);
            assert!(matches!(refused, Err(SelectError::NoSpread { .. })));
        }
        // the other axis decides alone
        assert!(rule("silverman").select(&flat, Shape::Gaussian).is_ok());
        let one = Sample::equal(vec![[1.0, 2.0]; 9], Domain::whole()).unwrap();
        assert!(rule("silverman").select(&one, Shape::Gaussian).is_err());
    }
}
