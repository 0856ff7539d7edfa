//! The histogram: the oldest estimator, and the one whose picture depends on where its bins begin.

use super::cells::{ORIGIN_Y, WIDTH_Y};
use super::width::{Binned, Rule, Width};
use super::{
    Build, BuildError, Context, Described, Estimate, Estimator, Family, FitError, Laws, Moments,
};
use crate::density::Density;
use crate::parameter::{Absent, Kind, Parameter, Values};
use crate::sample::Sample;
use crate::selector;
use crate::space::{Domain, Field, Point};
use crate::theory::histogram_moments;

/// f̂(x) = (mass in the bin of x) / width, on the bins [origin + k·width, origin + (k + 1)·width). [Silverman 1986, section 2.2]
///
/// A datum on an edge belongs to the bin on its right. Bins reach past walls like all else that ignores them: a wall inside a bin leaves part of its
/// mass outside.
///
/// O(n + m) as long as the range holds at most a few bins a point, else O((n + m) log n); O(n) memory in any case.
pub struct Histogram {
    width: Width,
    origin: f64,
}

struct Fitted(Binned);

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.0.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        let Binned { bins, width, .. } = &self.0;
        bins.mass(bins.number(x)) / width
    }
}

impl Estimator<1> for Histogram {
    fn laws(&self) -> Laws {
        Laws {
            continuous: false,
            ..self.width.laws()
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        self.width.fit(sample, 1.0, self.origin, Fitted)
    }

    fn expectation(
        &self,
        truth: &dyn Density<1>,
        draws: usize,
        places: &[Point<1>],
    ) -> Option<Vec<Moments>> {
        let width = self.width.number()?;
        let at = |&[x]: &Point<1>| histogram_moments(truth, width, self.origin, draws as f64, x);
        Some(places.iter().map(at).collect())
    }

    fn family(&self) -> Option<Family> {
        Some(family(self.origin))
    }
}

fn family(origin: f64) -> Family {
    Family::ShiftedHistogram { shifts: 1, origin }
}

impl Described for Histogram {
    const NAME: &'static str = "histogram";
    const SUMMARY: &'static str = "the share of the data in each of a row of bins";
    const COST: &'static str = "O(n + m)";
    const REFERENCE: &'static str = "Silverman 1986, section 2.2; Scott 1979";
    const SMOOTHING: Option<&'static str> = Some("width");
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "width",
            Kind::PositiveOr(&[
                "scott",
                "freedman-diaconis",
                "sturges",
                "knuth",
                "stone",
                "oracle",
                "amise",
            ]),
            "the width of a bin, in the unit of the data",
        )
        .length()
        .swept(),
        Parameter::optional(
            "origin",
            Kind::Real,
            Absent::Number(0.0),
            "an edge of a bin, in the unit of the data",
        )
        .place(),
        WIDTH_Y,
        ORIGIN_Y,
        Parameter::optional(
            "angle",
            Kind::Real,
            Absent::Unset,
            "how far the bins are turned counter-clockwise about the origin, in degrees; 0 by default",
        )
        .only_in(2),
    ];
}

impl Build<1> for Histogram {
    fn build(values: &Values, context: &Context<1>) -> Result<Self, BuildError> {
        let origin = values.number("origin").unwrap_or(0.0);
        let rules: &[(_, Rule)] = &[
            ("scott", selector::scott),
            ("freedman-diaconis", selector::freedman_diaconis),
            ("sturges", selector::sturges),
            ("knuth", selector::knuth),
            ("stone", selector::stone),
        ];
        let width = Width::given(values, context, rules, family(origin))?;
        Ok(Self { width, origin })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Build, Estimate, built};
    use super::super::{FrequencyPolygon, Histogram, Kde, Naive, ShiftedHistogram};
    use crate::parameter::Value;
    use crate::sample::Sample;
    use crate::space::{Domain, Field};

    fn sample() -> Sample<1> {
        let x = [-1.3, -0.2, 0.1, 0.15, 0.4, 0.9, 1.7, 2.05];
        Sample::equal(x.map(|x| [x]).to_vec(), Domain::whole()).expect("legal")
    }

    fn fitted<E: Build<1>>(settings: &[(&'static str, Value)]) -> Estimate<1> {
        let estimator: E = built(settings);
        estimator.fit(&sample()).expect("estimable")
    }

    fn places() -> impl Iterator<Item = f64> {
        (0..400).map(|i| f64::from(i).mul_add(0.0137, -2.5))
    }

    #[test]
    fn a_histogram_is_a_count_divided() {
        let estimate = fitted::<Histogram>(&[
            ("width", Value::Number(0.5)),
            ("origin", Value::Number(0.1)),
        ]);
        // [0.1, 0.6) holds 0.1, 0.15 and 0.4
        assert!((estimate.at([0.1]) - 3.0 / 8.0 / 0.5).abs() < 1e-15);
        assert!((estimate.at([0.599]) - 3.0 / 8.0 / 0.5).abs() < 1e-15);
        assert!((estimate.at([0.6]) - 1.0 / 8.0 / 0.5).abs() < 1e-15);
        assert!(estimate.at([5.0]).abs() < 1e-300);
    }

    #[test]
    fn a_shifted_histogram_is_the_mean_of_histograms() {
        let shifts = 5;
        let shifted = fitted::<ShiftedHistogram>(&[
            ("width", Value::Number(0.7)),
            ("shifts", Value::Count(shifts)),
            ("origin", Value::Number(0.03)),
        ]);
        let all: Vec<_> = (0..shifts)
            .map(|j| {
                let origin = (j as f64 * 0.7).mul_add(1.0 / shifts as f64, 0.03);
                fitted::<Histogram>(&[
                    ("width", Value::Number(0.7)),
                    ("origin", Value::Number(origin)),
                ])
            })
            .collect();
        for x in places() {
            let mean = all.iter().map(|one| one.at([x])).sum::<f64>() / shifts as f64;
            assert!((shifted.at([x]) - mean).abs() < 1e-14, "at {x}");
        }
    }

    /// The greatest difference falls like 1/m. [Scott 1985]
    #[test]
    fn many_shifts_make_the_triangular_kernel() {
        let kernel = fitted::<Kde>(&[
            ("shape", Value::Word("triangular".to_owned())),
            ("bandwidth", Value::Number(0.7)),
        ]);
        let furthest = |shifts| {
            let shifted = fitted::<ShiftedHistogram>(&[
                ("width", Value::Number(0.7)),
                ("shifts", Value::Count(shifts)),
            ]);
            places()
                .map(|x| (shifted.at([x]) - kernel.at([x])).abs())
                .fold(0.0, f64::max)
        };
        let (few, many) = (furthest(16), furthest(1024));
        assert!(many < few / 32.0, "{few} {many}");
        // each of the 8 bumps is off by at most slope × one narrow bin
        assert!(many <= 1.0 / (0.7 * 1024.0) * 1.0001, "{many}");
    }

    #[test]
    fn a_polygon_meets_its_histogram_at_the_centres_and_is_straight_between() {
        let settings = [
            ("width", Value::Number(0.5)),
            ("origin", Value::Number(0.1)),
        ];
        let (polygon, histogram) = (
            fitted::<FrequencyPolygon>(&settings),
            fitted::<Histogram>(&settings),
        );
        for k in -6..8 {
            let centre = (f64::from(k) + 0.5).mul_add(0.5, 0.1);
            let (here, next) = (histogram.at([centre]), histogram.at([centre + 0.5]));
            assert!((polygon.at([centre]) - here).abs() < 1e-14);
            let third = centre + 0.5 / 3.0;
            assert!((polygon.at([third]) - (2.0 * here + next) / 3.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_naive_estimator_is_the_uniform_kernel_bit_for_bit() {
        let bandwidth = ("bandwidth", Value::Number(0.3));
        let naive = fitted::<Naive>(std::slice::from_ref(&bandwidth));
        let kernel = fitted::<Kde>(&[bandwidth, ("shape", Value::Word("uniform".to_owned()))]);
        for x in places().chain([0.1 + 0.3, 0.4 - 0.3, -0.2 - 0.3]) {
            assert_eq!(naive.at([x]).to_bits(), kernel.at([x]).to_bits());
            // and a histogram bin of width 2h around x
            let near = sample()
                .coordinates()
                .iter()
                .filter(|&&p| ((x - p) / 0.3).abs() <= 1.0)
                .count();
            assert!((naive.at([x]) - near as f64 / 8.0 / 0.6).abs() < 1e-14);
        }
    }
}
