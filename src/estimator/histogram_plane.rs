//! The histogram of the plane: rectangular bins on a lattice that may be turned.

use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Histogram, Laws,
    Moments,
};
use crate::density::Density;
use crate::numeric::Sum;
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Lattice, Point};
use crate::theory::plane_histogram_moments;
use std::sync::Arc;

/// f̂(x) = (mass in the bin of x) / (width-x · width-y). The lattice of bins has a corner at the origin; its first axis makes the angle with that of
/// the data. [Scott 1992, section 3.4]
///
/// A datum on an edge belongs to the bin beyond it. O(n + m) time where the range holds at most some bins for each point, else O((n + m) log n), and O(n)
/// memory, however many bins the range holds.
pub struct HistogramPlane {
    lattice: Lattice,
    origin: Point<2>,
    degrees: f64,
}

struct Fitted {
    lattice: Lattice,
    bins: Bins,
    domain: Domain<2>,
}

/// The height of each bin.
enum Bins {
    /// All bins of a range of numbers, the second axis fastest.
    Dense {
        least: [f64; 2],
        counts: [usize; 2],
        heights: Vec<f64>,
    },
    /// The bins with data, in order.
    Sparse {
        numbers: Vec<[f64; 2]>,
        heights: Vec<f64>,
    },
}

/// A table of all bins has at most so many for each point, and as many for few points.
const FOR_EACH_POINT: f64 = 4.0;
const FOR_FEW: f64 = 4096.0;

impl Field<2> for Fitted {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn at(&self, x: Point<2>) -> f64 {
        let number = self.lattice.number(x);
        match &self.bins {
            Bins::Dense {
                least,
                counts,
                heights,
            } => {
                let [i, j] = [0, 1].map(|k: usize| number[k] - least[k]);
                let inside = i >= 0.0 && j >= 0.0 && i < counts[0] as f64 && j < counts[1] as f64;
                if inside {
                    heights[i as usize * counts[1] + j as usize]
                } else {
                    0.0
                }
            }
            Bins::Sparse { numbers, heights } => numbers
                .binary_search_by(|known| order(known, &number))
                .map_or(0.0, |place| heights[place]),
        }
    }
}

fn order(a: &[f64; 2], b: &[f64; 2]) -> std::cmp::Ordering {
    // adding 0 makes -0 and 0 the same bin
    (a[0] + 0.0)
        .total_cmp(&(b[0] + 0.0))
        .then((a[1] + 0.0).total_cmp(&(b[1] + 0.0)))
}

/// A bin without mass has no height, even where its area is too small for a number.
fn height(mass: Sum, area: f64) -> f64 {
    let mass = mass.value();
    if mass > 0.0 { mass / area } else { 0.0 }
}

impl Bins {
    /// The mass at each number over `area`, added in the order of the points either way.
    fn new(numbered: &[([f64; 2], f64)], area: f64) -> Self {
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (number, _) in numbered {
            for k in 0..2 {
                least[k] = least[k].min(number[k]);
                most[k] = most[k].max(number[k]);
            }
        }
        let [across, along] = [0, 1].map(|k: usize| most[k] - least[k] + 1.0);
        if across * along <= (FOR_EACH_POINT * numbered.len() as f64).max(FOR_FEW) {
            let counts = [across, along].map(|count| count.max(0.0) as usize);
            let mut masses = vec![Sum::default(); counts[0] * counts[1]];
            for ([i, j], mass) in numbered {
                let place = (i - least[0]) as usize * counts[1] + (j - least[1]) as usize;
                masses[place].add(*mass);
            }
            return Self::Dense {
                least,
                counts,
                heights: masses.iter().map(|&mass| height(mass, area)).collect(),
            };
        }
        let mut sorted: Vec<usize> = (0..numbered.len()).collect();
        sorted.sort_unstable_by(|&a, &b| order(&numbered[a].0, &numbered[b].0).then(a.cmp(&b)));
        let (mut numbers, mut heights) = (Vec::new(), Vec::new());
        for bin in sorted.chunk_by(|&a, &b| order(&numbered[a].0, &numbered[b].0).is_eq()) {
            let mass: Sum = bin.iter().map(|&i| numbered[i].1).collect();
            numbers.push(numbered[bin[0]].0);
            heights.push(height(mass, area));
        }
        Self::Sparse { numbers, heights }
    }
}

impl HistogramPlane {
    fn bin(&self, sample: &Sample<2>) -> Result<Fitted, FitError> {
        let mut numbered = Vec::with_capacity(sample.len());
        for (i, &x) in sample.points().iter().enumerate() {
            let weight = sample.weight(i);
            if weight <= 0.0 {
                continue;
            }
            let number = self.lattice.number(x);
            if !number.iter().all(|k| k.is_finite()) {
                return Err(FitError::TooLarge(format!(
                    "the point ({}, {}) cannot be numbered in bins of {} by {}; choose larger widths",
                    x[0],
                    x[1],
                    self.lattice.widths()[0],
                    self.lattice.widths()[1]
                )));
            }
            numbered.push((number, weight));
        }
        Ok(Fitted {
            lattice: self.lattice,
            bins: Bins::new(&numbered, self.lattice.area()),
            domain: sample.domain().clone(),
        })
    }
}

impl Estimator<2> for HistogramPlane {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: true,
            reproduces_constants: false,
            reproduces_linear: false,
            continuous: false,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: true,
        }
    }

    fn fit(&self, sample: &Sample<2>) -> Result<Estimate<2>, FitError> {
        let channels = (0..sample.channels())
            .map(|c| Ok(Arc::new(self.bin(&sample.channel(c))?) as Arc<dyn Field<2>>))
            .collect::<Result<_, FitError>>()?;
        let mut estimate = Estimate::new(Arc::new(self.bin(sample)?)).with_channels(channels);
        let [x, y] = self.lattice.widths();
        estimate.smoothing = Some((x * y).sqrt());
        Ok(estimate)
    }

    /// Square bins.
    fn family(&self) -> Option<Family> {
        let [x, y] = self.lattice.widths();
        x.total_cmp(&y).is_eq().then_some(Family::SquareHistogram {
            origin: self.origin,
            degrees: self.degrees,
        })
    }

    /// Counts are binomial.
    fn expectation(
        &self,
        truth: &dyn Density<2>,
        draws: usize,
        places: &[Point<2>],
    ) -> Option<Vec<Moments>> {
        plane_histogram_moments(truth, &self.lattice, draws as f64, places)
    }
}

impl Described for HistogramPlane {
    const NAME: &'static str = Histogram::NAME;
    const SUMMARY: &'static str = Histogram::SUMMARY;
    const COST: &'static str = "O(n + m); O((n + m) log n) where bins are far more than points";
    const REFERENCE: &'static str = Histogram::REFERENCE;
    const SMOOTHING: Option<&'static str> = Histogram::SMOOTHING;
    const PARAMETERS: &'static [Parameter] = Histogram::PARAMETERS;
}

impl Build<2> for HistogramPlane {
    fn build(values: &Values, context: &Context<2>) -> Result<Self, BuildError> {
        let x = match (values.number("width"), values.word("width")) {
            (Some(width), _) => width,
            (None, word) => asymptotic(word.unwrap_or_default(), context)?,
        };
        let degrees = values.number("angle").unwrap_or(0.0);
        let origin = values.number("origin").unwrap_or(0.0);
        let origin = [origin, values.number("origin-y").unwrap_or(origin)];
        let widths = [x, values.number("width-y").unwrap_or(x)];
        Ok(Self {
            lattice: Lattice::new(widths, origin, degrees),
            origin,
            degrees,
        })
    }
}

/// The width of square bins of least asymptotic error: h⁴ = 12 / (n ∫|∇f|²). [Scott 1992, section 3.4]
fn asymptotic(word: &str, context: &Context<2>) -> Result<f64, BuildError> {
    let error = |what: String| BuildError {
        parameter: "width",
        what,
    };
    if word != "amise" {
        return Err(error(format!(
            "\"{word}\" chooses widths on a line; in the plane give a number, or \"amise\" where the truth is known"
        )));
    }
    let truth = context.truth.as_ref().and_then(|truth| truth.bivariate());
    let slope = truth
        .map(crate::density::Bivariate::gradient_roughness)
        .ok_or_else(|| {
            error("\"amise\" needs a known density, and that of measured data is not known; give a number".to_owned())
        })?;
    let width = (12.0 / (context.draws as f64 * slope)).powf(0.25);
    if width > 0.0 && width.is_finite() {
        Ok(width)
    } else {
        Err(error(
            "\"amise\": the asymptotic error does not exist, because the density jumps somewhere (at a wall, say); give a number".to_owned(),
        ))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::parameter::Value;

    fn histogram(settings: &[(&'static str, f64)]) -> HistogramPlane {
        let mut values = Values::defaults(HistogramPlane::PARAMETERS);
        for (name, value) in settings {
            values.set(name, Value::Number(*value));
        }
        let context = Context {
            truth: None,
            draws: 10,
        };
        HistogramPlane::build(&values, &context).unwrap()
    }

    fn points() -> Vec<Point<2>> {
        vec![
            [0.1, 0.1],
            [0.4, 0.3],
            [0.6, 0.1],
            [-0.2, 0.9],
            [0.45, 0.95],
            [0.5, 0.5],
        ]
    }

    #[test]
    fn a_histogram_is_a_count_divided() {
        let sample = Sample::equal(points(), Domain::whole()).unwrap();
        let fitted = histogram(&[("width", 0.5), ("width-y", 0.4)])
            .fit(&sample)
            .unwrap();
        let one = 1.0 / 6.0 / 0.2;
        for (x, count) in [
            ([0.0, 0.0], 2.0),
            ([0.499, 0.399], 2.0),
            ([0.5, 0.0], 1.0),
            ([0.7, 0.4], 1.0),
            ([-0.1, 0.8], 1.0),
            ([3.0, 3.0], 0.0),
        ] {
            assert!((fitted.at(x) - count * one).abs() < 1e-15, "{x:?}");
        }
    }

    /// A table of all bins and a list of those with data hold the same: bit for bit, and nothing beyond.
    #[test]
    fn a_table_is_a_list() {
        let numbered: Vec<([f64; 2], f64)> = (0..3000_u32)
            .map(|i| {
                let number = [i % 37, (i / 37) % 37].map(|k| f64::from(k) - 18.0);
                (number, f64::from(i % 13) * 0.1 + 0.01)
            })
            .collect();
        let field = |bins| Fitted {
            lattice: Lattice::new([0.3, 0.7], [0.1, -0.2], 20.0),
            bins,
            domain: Domain::whole(),
        };
        let table = Bins::new(&numbered, 0.21);
        assert!(matches!(table, Bins::Dense { .. }));
        // a bin far out makes a list of the same data
        let mut far = numbered.clone();
        far.push(([1e9, -1e9], 1.0));
        let list = Bins::new(&far, 0.21);
        assert!(matches!(list, Bins::Sparse { .. }));
        let (table, list) = (field(table), field(list));
        let mut filled = 0;
        for i in -40..40 {
            for j in -60..60 {
                let x = [f64::from(i) * 0.31, f64::from(j) * 0.37];
                assert_eq!(table.at(x).to_bits(), list.at(x).to_bits(), "{x:?}");
                filled += usize::from(table.at(x) > 0.0);
            }
        }
        assert!(filled > 1000, "{filled}");
        assert!(table.at([f64::MAX, 0.0]).abs() < 1e-300);
        let flat = Fitted {
            lattice: Lattice::new([1.0; 2], [0.0; 2], 0.0),
            bins: Bins::new(&[([0.0, 0.0], 1.0), ([2.0, 0.0], 1.0)], 0.0),
            domain: Domain::whole(),
        };
        let heights = [0.5, 1.5, 2.5].map(|x| flat.at([x, 0.5]));
        assert!(heights[0].is_infinite() && heights[1].abs() < 1e-300 && heights[2].is_infinite());
    }

    /// Turning the lattice is turning the data the other way.
    #[test]
    fn a_turned_lattice_sees_turned_data() {
        let degrees: f64 = 30.0;
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let turned = |x: Point<2>| [cosine * x[0] - sine * x[1], sine * x[0] + cosine * x[1]];
        let sample = Sample::equal(points(), Domain::whole()).unwrap();
        let there =
            Sample::equal(points().into_iter().map(turned).collect(), Domain::whole()).unwrap();
        let settings = [("width", 0.37), ("width-y", 0.21)];
        let straight = histogram(&settings).fit(&sample).unwrap();
        let tilted = histogram(&[settings[0], settings[1], ("angle", degrees)])
            .fit(&there)
            .unwrap();
        for i in 0..400 {
            let x = [
                f64::from(i % 20) * 0.0731 - 0.4,
                f64::from(i / 20) * 0.0817 - 0.3,
            ];
            assert!(
                (straight.at(x) - tilted.at(turned(x))).abs() < 1e-12,
                "{x:?}"
            );
        }
    }

    #[test]
    fn weights_are_mass_and_none_is_nothing() {
        let weights = vec![3.0, 1.0, 1.0, 1.0, 1.0, 0.0];
        let sample = Sample::normalised(points(), weights, Domain::whole()).unwrap();
        let fitted = histogram(&[("width", 0.5)]).fit(&sample).unwrap();
        assert!((fitted.at([0.2, 0.2]) - 4.0 / 7.0 / 0.25).abs() < 1e-14);
        assert!(fitted.at([0.7, 0.7]).abs() < 1e-300);
    }

    #[test]
    fn numbers_too_large_for_bins_are_refused() {
        let sample = Sample::equal(vec![[1e300, 0.0]], Domain::whole()).unwrap();
        let fitted = histogram(&[("width", 1e-200)]).fit(&sample);
        assert!(matches!(fitted.map(|_| ()), Err(FitError::TooLarge(_))));
    }
}
