//! The best bandwidth that there is for one sample, which only those who know the truth can find.

use super::functionals::{Functionals, canonical, fall_back};
use super::search::search;
use super::spread::Spread;
use super::{SelectError, Selection, Selector};
use crate::density::Density;
use crate::engine::CompactPairs;
use crate::kernel::Shape;
use crate::sample::Sample;
use crate::theory::kernel_moments;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// The h of least ∫(f̂ - f)² over the whole line for the very sample at hand: what the regret of a selector is measured from.
///
/// ∫f̂² is a sum over pairs and ∫f̂f one over the data, of the expectation of f̂; nothing is read off a grid. The least of all local minima between six times
/// the oversmoothed bandwidth and a tenth of the best.
pub struct LeastIse {
    /// f.
    pub truth: Arc<dyn Density<1>>,
}

impl Selector<1> for LeastIse {
    fn name(&self) -> &'static str {
        "oracle-ise"
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        let deviation = Spread::of(sample)?.deviation;
        let widest =
            6.0 * 1.144 * sample.effective_size().powf(-0.2) * canonical(shape) * deviation;
        let pairs = match CompactPairs::new(sample, shape) {
            Some(pairs) => Pairs::Compact(pairs),
            None => Pairs::Gaussian(Box::new(Functionals::new(sample)?)),
        };
        let error = |h: f64| {
            let own = match &pairs {
                Pairs::Gaussian(functionals) => {
                    functionals.sum(0, SQRT_2 * h / functionals.unit) / SQRT_2 / h
                }
                Pairs::Compact(pairs) => pairs.sum(h, 0.0) / h,
            };
            let cross: f64 = sample
                .points()
                .iter()
                .enumerate()
                .map(|(i, &[x])| {
                    sample.weight(i) * kernel_moments(&*self.truth, shape, h, 1.0, x).mean
                })
                .sum();
            own - 2.0 * cross / sample.mass()
        };
        let found = search(error, error, 1e-4 * widest, widest);
        let least = found
            .minima
            .iter()
            .min_by(|a, b| a.value.total_cmp(&b.value));
        match least {
            Some(least) => Ok(Selection::new(least.at, Vec::new())),
            None => fall_back(sample, shape, "the integrated squared error has no minimum"),
        }
    }
}

/// Sums over pairs for either kind of kernel.
enum Pairs {
    Gaussian(Box<Functionals>),
    Compact(CompactPairs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::named;
    use crate::kernel::{Bandwidth, KernelSum};
    use crate::numeric::special::normal_quantile;
    use crate::numeric::{GaussLegendre, minimise, panels};
    use crate::random::open_unit;
    use crate::space::{Domain, Field};

    /// Against the definition, by quadrature.
    #[test]
    fn it_is_the_least_of_the_definition() {
        let truth: Arc<dyn Density<1>> = named("mw-6").expect("known");
        let mut random = crate::random::stream(6, "least ISE", 0);
        let points: Vec<[f64; 1]> = (0..60)
            .map(|_| {
                let z = normal_quantile(open_unit(&mut random));
                [2.0 / 3.0 * z
                    + if open_unit(&mut random) < 0.5 {
                        1.0
                    } else {
                        -1.0
                    }]
            })
            .collect();
        let sample = Sample::equal(points, Domain::whole()).expect("legal");
        let rule = GaussLegendre::new(16);
        let selector = LeastIse {
            truth: truth.clone(),
        };
        for shape in [Shape::Gaussian, Shape::Triweight] {
            let ise = |h: f64| {
                let sum = KernelSum::new(sample.clone(), shape, Bandwidth::Fixed([h]));
                let sum = sum.expect("legal");
                rule.integrate_panels(
                    |x| (sum.at([x]) - truth.at([x])).powi(2),
                    &panels(-6.0, 6.0, [], 0.05),
                )
            };
            let selection = selector.select(&sample, shape).expect("a width");
            let Bandwidth::Fixed([h]) = selection.bandwidth else {
                unreachable!("one number")
            };
            let direct = minimise(ise, 0.5 * h, 2.0 * h, 1e-6).at;
            assert!((h / direct - 1.0).abs() < 1e-4, "{shape}: {h} {direct}");
        }
    }
}
