//! The averaged shifted histogram of the plane.

use super::cells::{Cells, Lattice};
use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, Laws, Moments,
    ShiftedHistogram,
};
use crate::density::Density;
use crate::kernel::{Bandwidth, Shape, Symmetry};
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::selector::{NormalScale, Selector};
use crate::space::{Domain, Evaluation, Field, Point, Targets};
use std::sync::Arc;

/// The mean of m² histograms whose origins are a narrow bin, width/m, apart on either axis.
///
/// f̂(x) = Σ_{|i|, |j| < m} (1 - |i|/m) (1 - |j|/m) νₖ₊ᵢ,ₗ₊ⱼ / (width-x · width-y). For m = 1 the histogram; for m → ∞ the estimate with the product of triangular kernels, whose
/// bandwidths are the widths. \[Scott 1992, section 5.2\]
///
/// O(n log n + m · (columns and bins within a width) ), however many bins the range holds.
pub struct ShiftedHistogramPlane {
    width: Width,
    origin: Point<2>,
    shifts: f64,
}

#[derive(Clone, Copy)]
enum Width {
    Numbers([f64; 2]),
    /// The normal scale of the kernel that the mean tends to.
    NormalReference,
}

struct Fitted {
    narrow: Lattice,
    cells: Cells,
    shifts: f64,
    area: f64,
    domain: Domain<2>,
}

/// How far the narrow bins go that count, and with what share.
fn shares(shifts: f64) -> impl Iterator<Item = (f64, f64)> {
    let count = shifts as i64;
    (1 - count..count).map(move |i| (i as f64, 1.0 - (i.abs() as f64) / shifts))
}

impl Field<2> for Fitted {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let [k, l] = self.narrow.number(x);
        let most = self.shifts - 1.0;
        self.value(&self.profile(k, l - most, l + most), l)
    }

    /// Targets of one column of narrow bins share its profile: O(2m columns) once, O(2m) a narrow bin.
    #[expect(clippy::float_cmp, reason = "bin numbers are whole")]
    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let numbers: Vec<[f64; 2]> = targets.places().map(|x| self.narrow.number(x)).collect();
        let mut order: Vec<usize> = (0..numbers.len()).collect();
        order.sort_unstable_by(|&a, &b| {
            let axis = |k: usize| numbers[a][k].total_cmp(&numbers[b][k]);
            axis(0).then(axis(1))
        });
        let mut values = vec![0.0; numbers.len()];
        let most = self.shifts - 1.0;
        for column in order.chunk_by(|&a, &b| numbers[a][0] == numbers[b][0]) {
            let row = |at: usize| numbers[column[at]][1];
            let (low, high) = (row(0) - most, row(column.len() - 1) + most);
            let profile = self.profile(numbers[column[0]][0], low, high);
            for bin in column.chunk_by(|&a, &b| numbers[a][1] == numbers[b][1]) {
                let value = self.value(&profile, numbers[bin[0]][1]);
                for &target in bin {
                    values[target] = value;
                }
            }
        }
        Evaluation {
            values,
            ..Evaluation::default()
        }
    }
}

impl Fitted {
    /// Σᵢ (1 - |i|/m) ν over the columns about column `k`, for each row from `low` to `high` that holds data in any of them, in order.
    #[expect(clippy::float_cmp, reason = "bin numbers are whole")]
    fn profile(&self, k: f64, low: f64, high: f64) -> Vec<(f64, f64)> {
        let mut rows: Vec<(f64, f64)> = shares(self.shifts)
            .flat_map(|(i, share)| {
                let column = self.cells.column(k + i, low, high);
                column.map(move |(j, mass)| (j, share * mass))
            })
            .collect();
        // stable, so that each row is summed in the order of the columns
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        rows.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        rows
    }

    /// The estimate in the narrow bin of that row, from the profile of its column.
    fn value(&self, profile: &[(f64, f64)], l: f64) -> f64 {
        let first = profile.partition_point(|(j, _)| *j <= l - self.shifts);
        let sum: f64 = profile[first..]
            .iter()
            .take_while(|(j, _)| *j < l + self.shifts)
            .map(|(j, mass)| (1.0 - (j - l).abs() / self.shifts) * mass)
            .sum();
        sum / self.area
    }
}

impl ShiftedHistogramPlane {
    fn narrow(&self, widths: [f64; 2]) -> Lattice {
        Lattice {
            widths: widths.map(|width| width / self.shifts),
            origin: self.origin,
        }
    }
}

impl Estimator<2> for ShiftedHistogramPlane {
    fn laws(&self) -> Laws {
        let fixed = matches!(self.width, Width::Numbers(_));
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: fixed,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: false,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: fixed,
        }
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let (widths, warnings) = match self.width {
            Width::Numbers(widths) => (widths, Vec::new()),
            Width::NormalReference => {
                let rule = NormalScale::deviations(Symmetry::Product);
                let selection = rule.select(sample, Shape::Triangular)?;
                match selection.bandwidth {
                    Bandwidth::Fixed(widths) => (widths, selection.warnings),
                    _ => unreachable!("a rule of thumb gives numbers"),
                }
            }
        };
        let narrow = self.narrow(widths);
        let field = |sample: &Sample<2>| -> Result<Arc<dyn Field<2>>, FitError> {
            Ok(Arc::new(Fitted {
                narrow,
                cells: Cells::masses(sample, &narrow)?,
                shifts: self.shifts,
                area: widths[0] * widths[1],
                domain: sample.domain().clone(),
            }))
        };
        let channels = (0..sample.channels())
            .map(|c| field(&sample.channel(c)))
            .collect::<Result<_, _>>()?;
        let mut estimate = Estimate::new(field(sample)?).with_channels(channels);
        estimate.smoothing = Some((widths[0] * widths[1]).sqrt());
        estimate.warnings = warnings;
        Ok(estimate)
    }

    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        let Width::Numbers(widths) = self.width else {
            return None;
        };
        let (narrow, area) = (self.narrow(widths), widths[0] * widths[1]);
        let at = |&x: &Point<2>| {
            let [k, l] = narrow.number(x);
            let cells = shares(self.shifts).flat_map(|(i, a)| {
                shares(self.shifts).map(move |(j, b)| ([k + i, l + j], a * b / area))
            });
            narrow.moments(truth, draws, cells)
        };
        Some(places.iter().map(at).collect())
    }
}

impl Described for ShiftedHistogramPlane {
    const NAME: &'static str = ShiftedHistogram::NAME;
    const SUMMARY: &'static str = ShiftedHistogram::SUMMARY;
    const COST: &'static str = ShiftedHistogram::COST;
    const REFERENCE: &'static str = ShiftedHistogram::REFERENCE;
    const SMOOTHING: Option<&'static str> = ShiftedHistogram::SMOOTHING;
    const PARAMETERS: &'static [Parameter] = ShiftedHistogram::PARAMETERS;
}

impl Build<2> for ShiftedHistogramPlane {
    fn build(values: &Values, _context: &Context<2>) -> Result<Self, BuildError> {
        let origin = values.number("origin").unwrap_or(0.0);
        let second = values.number("width-y");
        let width = match (values.number("width"), values.word("width")) {
            (Some(x), _) => Width::Numbers([x, second.unwrap_or(x)]),
            (None, Some("normal-reference")) if second.is_none() => Width::NormalReference,
            (None, word) => {
                return Err(BuildError {
                    parameter: "width",
                    what: format!(
                        "\"{}\": in the plane give `width` (and perhaps `width-y`) as numbers, or \"normal-reference\" for both",
                        word.unwrap_or_default()
                    ),
                });
            }
        };
        Ok(Self {
            width,
            origin: [origin, values.number("origin-y").unwrap_or(origin)],
            shifts: values.count("shifts").map_or(16.0, |shifts| shifts as f64),
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density;
    use crate::estimator::HistogramPlane;
    use crate::kernel::KernelSum;
    use crate::parameter::Value;
    use crate::space::Grid;

    fn context() -> Context<2> {
        Context {
            truth: None,
            draws: 10,
        }
    }

    fn shifted(shifts: u64, origin: f64) -> ShiftedHistogramPlane {
        let mut values = Values::defaults(ShiftedHistogramPlane::PARAMETERS);
        values.set("width", Value::Number(0.6));
        values.set("width-y", Value::Number(0.9));
        values.set("origin", Value::Number(origin));
        values.set("shifts", Value::Count(shifts));
        ShiftedHistogramPlane::build(&values, &context()).unwrap()
    }

    fn sample() -> Sample<2> {
        let points = (0..200)
            .map(|i| {
                let t = f64::from(i);
                [
                    (t * 0.618).fract() * 2.0 - 1.0,
                    3.0 * (t * 0.755).fract().powi(2),
                ]
            })
            .collect();
        let weights = (0..200).map(|i| f64::from(i % 3)).collect();
        Sample::normalised(points, weights, Domain::whole()).unwrap()
    }

    /// The mean of histograms with all pairs of origins, each fitted by itself.
    #[test]
    fn it_is_the_mean_of_shifted_histograms() {
        let sample = sample();
        let estimate = shifted(3, 0.1).fit(&sample).unwrap();
        let one = shifted(1, 0.1).fit(&sample).unwrap();
        let histograms: Vec<Estimate<2>> = (0..9)
            .map(|at| {
                let mut values = Values::defaults(HistogramPlane::PARAMETERS);
                for (name, value) in [
                    ("width", 0.6),
                    ("width-y", 0.9),
                    ("origin", 0.1 + 0.2 * f64::from(at / 3)),
                    ("origin-y", 0.1 + 0.3 * f64::from(at % 3)),
                ] {
                    values.set(name, Value::Number(value));
                }
                let histogram = HistogramPlane::build(&values, &context()).unwrap();
                histogram.fit(&sample).unwrap()
            })
            .collect();
        for i in 0..300 {
            let x = [
                f64::from(i % 20) * 0.137 - 1.4,
                f64::from(i / 20) * 0.271 - 0.5,
            ];
            let mean = histograms.iter().map(|it| it.at(x)).sum::<f64>() / 9.0;
            assert!((estimate.at(x) - mean).abs() < 1e-13, "{x:?}");
            assert!((one.at(x) - histograms[0].at(x)).abs() < 1e-14, "{x:?}");
        }
    }

    #[test]
    fn many_shifts_are_the_product_of_triangles() {
        let sample = sample();
        let kernel = KernelSum::new(
            sample.clone(),
            Shape::Triangular,
            Bandwidth::Fixed([0.6, 0.9]),
        );
        let kernel = kernel.unwrap();
        let worst = |shifts: u64| {
            let estimate = shifted(shifts, 0.0).fit(&sample).unwrap();
            let grid = Grid::new([-1.5, -0.5], [1.5, 3.5], [30, 30]).unwrap();
            grid.centres()
                .map(|x| (estimate.at(x) - kernel.at(x)).abs())
                .fold(0.0, f64::max)
        };
        let (few, many) = (worst(4), worst(64));
        assert!(many < 0.02 && many < 0.12 * few, "{few} {many}");
    }

    #[test]
    fn moments_are_those_of_counts() {
        let truth = density::named_in_plane("normal-2d").unwrap();
        let estimator = shifted(2, 0.05);
        let moments = estimator.expectation(&*truth, 50, &[[0.3, -0.4]]).unwrap();
        // shifts 1 is a histogram, whose moments are binomial; of two shifts the mean is the mean of four
        let mean: f64 = [[0.05, 0.05], [0.35, 0.05], [0.05, 0.5], [0.35, 0.5]]
            .iter()
            .map(|origin| {
                let low = [0, 1].map(|k: usize| {
                    let (x, width): (f64, f64) = [(0.3, 0.6), (-0.4, 0.9)][k];
                    ((x - origin[k]) / width).floor() * width + origin[k]
                });
                truth.probability(low, [low[0] + 0.6, low[1] + 0.9]) / 0.54 / 4.0
            })
            .sum();
        assert!((moments[0].mean - mean).abs() < 1e-14);
        assert!(moments[0].variance > 0.0 && moments[0].variance < mean / 0.54 / 50.0);
        let chosen = {
            let mut values = Values::defaults(ShiftedHistogramPlane::PARAMETERS);
            values.set("width", Value::Word("normal-reference".to_owned()));
            ShiftedHistogramPlane::build(&values, &context()).unwrap()
        };
        let grid = Grid::new([-4.0, -4.0], [4.0, 7.0], [160, 220]).unwrap();
        let mass = chosen.fit(&sample()).unwrap().on(&grid).integral();
        assert!((mass - 1.0).abs() < 0.01, "{mass}");
    }
}
