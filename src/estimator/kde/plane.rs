//! The kernel estimator in the plane.

use super::{Kde, Width, engine};
use crate::boundary::{self, Bump, Ignore, corrected_moments_in_plane};
use crate::density::Density;
use crate::engine::{EXACT, PLANE};
use crate::estimator::{
    Build, BuildError, Context, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::kernel::{Shape, Symmetry};
use crate::parameter::{Value, Values, listed};
use crate::sample::Sample;
use crate::selector::{self, FixedCount};
use crate::space::Point;
use crate::theory::{kernel_oracle, plane_kernel_moments};
use rayon::prelude::*;

impl Estimator<2> for Kde<2> {
    fn laws(&self) -> Laws {
        self.promises()
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        self.estimate(sample, PLANE)
    }

    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        let Width::Numbers(h) = self.width else {
            return None;
        };
        // round a side that wraps the density is another one
        if truth.domain().wraps() {
            return None;
        }
        let truth = truth.bivariate()?;
        let draws = draws as f64;
        if !self.corrected || !truth.domain().has_walls() {
            let (shape, symmetry) = (self.shape, self.symmetry);
            let at = |x: &Point<2>| plane_kernel_moments(truth, shape, symmetry, h, draws, *x);
            return Some(places.par_iter().map(at).collect());
        }
        if !self.boundary.promises().linear {
            return None;
        }
        let bump = Bump {
            shape: self.shape,
            symmetry: self.symmetry,
            width: h,
        };
        let at =
            |x: &Point<2>| corrected_moments_in_plane(&*self.boundary, &bump, truth, draws, *x);
        places.par_iter().map(at).collect()
    }

    fn variance(
        &self,
        estimate: &Estimate<2>,
        sample: &Sample<2>,
        places: &[Point<2>],
    ) -> Option<Vec<f64>> {
        (!sample.domain().wraps()).then(|| self.plug_in(estimate, sample, places))?
    }

    fn family(&self) -> Option<Family> {
        (!self.corrected).then_some(match self.symmetry {
            Symmetry::Product => Family::Kernel(self.shape),
            Symmetry::Radial => Family::RadialKernel(self.shape),
        })
    }
}

/// The bandwidth, the same on both axes, that is best for the known density, exactly or asymptotically.
fn best_in_plane(
    word: &str,
    (shape, symmetry): (Shape, Symmetry),
    context: &Context<2>,
) -> Result<f64, BuildError> {
    let error = |what: String| BuildError {
        parameter: "bandwidth",
        what,
    };
    let Some(truth) = &context.truth else {
        return Err(error(format!(
            "\"{word}\" is the best bandwidth for a known density, and the density of measured data is not known; give a number or a rule that looks at the data alone"
        )));
    };
    let Some(oracle) = kernel_oracle(&**truth, shape, symmetry, context.draws as f64) else {
        return Err(error(format!(
            "\"{word}\": in the plane the best bandwidth is known for normal mixtures and products of densities only; give a number"
        )));
    };
    match (word, oracle.asymptotic) {
        ("oracle", _) => Ok(oracle.optimum.at),
        (_, Ok(asymptotic)) => Ok(asymptotic.best()),
        (_, Err(why)) => Err(error(format!("\"{word}\": {why}; give a number"))),
    }
}

impl Build<2> for Kde<2> {
    fn build(values: &Values, context: &Context<2>) -> Result<Self, BuildError> {
        let shape = values
            .word("shape")
            .and_then(Shape::named)
            .unwrap_or(Shape::Gaussian);
        let word = values.word("bandwidth");
        if let Some(word) = word.filter(|word| ["oracle", "amise"].contains(word)) {
            let mut known = values.clone();
            let symmetry = values.word("symmetry").and_then(Symmetry::named);
            let h = best_in_plane(word, (shape, symmetry.unwrap_or_default()), context)?;
            known.set("bandwidth", Value::Number(h));
            return Self::new(shape, &known);
        }
        Self::new(shape, values)
    }
}

impl Kde<2> {
    /// The estimator with the kernel `shape` and everything else from `values`.
    pub(in crate::estimator) fn new(shape: Shape, values: &Values) -> Result<Self, BuildError> {
        let symmetry = values
            .word("symmetry")
            .and_then(Symmetry::named)
            .unwrap_or_default();
        let second = values.number("bandwidth-y");
        let width = match (values.number("bandwidth"), values.word("bandwidth")) {
            (Some(h), _) => Width::Numbers([h, second.unwrap_or(h)]),
            (None, Some(FixedCount::NAME)) if second.is_none() => {
                let count = values.number("expected").unwrap_or(FixedCount::DEFAULT);
                Width::Selected(Box::new(FixedCount::new(count, symmetry)))
            }
            (None, word) => {
                let word = word.unwrap_or_default();
                if second.is_some() {
                    return Err(BuildError {
                        parameter: "bandwidth-y",
                        what: format!(
                            "\"{word}\" chooses the widths of both axes: give two numbers or only the rule"
                        ),
                    });
                }
                let entry = selector::plane_entry_of(word).ok_or_else(|| BuildError {
                    parameter: "bandwidth",
                    what: format!(
                        "\"{word}\" is a rule of the line; in the plane give a number or one of {}",
                        listed(
                            &selector::PLANE
                                .iter()
                                .map(|entry| entry.name)
                                .collect::<Vec<_>>()
                        )
                    ),
                })?;
                Width::Selected((entry.build)(symmetry))
            }
        };
        let told = values.word("bandwidth") == Some(FixedCount::NAME);
        if values.number("expected").is_some() && !told {
            return Err(BuildError {
                parameter: "expected",
                what: format!(
                    "`expected` is what bandwidth = \"{}\" is told; other widths have no use for it",
                    FixedCount::NAME
                ),
            });
        }
        Ok(Self {
            shape,
            symmetry,
            width,
            corrected: values.word("boundary").is_some_and(|word| word != "ignore"),
            boundary: values
                .word("boundary")
                .and_then(boundary::named)
                .unwrap_or(Box::new(Ignore)),
            engine: engine(values, PLANE)?,
            tolerance: values.number("tolerance").unwrap_or(EXACT),
        })
    }
}
