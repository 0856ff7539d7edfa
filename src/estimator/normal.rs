//! The parametric baseline: what an assumption is worth, right or wrong.

use super::{BuildError, Context, Described, Estimate, Estimator, FitError, Laws};
use crate::numeric::{Sum, special::normal_density};
use crate::parameter::{Parameter, Values};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};
use std::sync::Arc;

/// f̂(x) = φ((x - μ)/σ)/σ with μ and σ by maximum likelihood, σ² = Σ wᵢ (Xᵢ - μ)² / Σ wᵢ.
///
/// The error falls like 1/n if the data are normal and not at all below the distance of the nearest normal if they are not. The normal is that
/// of the total; a channel is the same normal with the mass of the channel.
///
/// O(n + m).
pub struct Normal;

struct Fitted {
    mass: f64,
    /// The mean in two parts, so that far from zero it has more digits than one number could hold.
    centre: f64,
    offset: f64,
    deviation: f64,
    domain: Domain<1>,
}

impl Field<1> for Fitted {
    fn domain(&self) -> &Domain<1> {
        &self.domain
    }

    fn at(&self, [x]: Point<1>) -> f64 {
        self.mass * normal_density((x - self.centre - self.offset) / self.deviation)
            / self.deviation
    }
}

impl Estimator<1> for Normal {
    fn laws(&self) -> Laws {
        Laws {
            mass_conserving: true,
            non_negative: true,
            linear: false,
            continuous: true,
            deterministic: true,
            scale_equivariant: true,
            translation_equivariant: true,
            repeatable: true,
        }
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let (centre, offset, deviation) = likeliest(sample);
        let largest = sample
            .coordinates()
            .iter()
            .enumerate()
            .filter(|&(i, _)| sample.weight(i) > 0.0)
            .fold(0.0, |largest: f64, (_, x)| largest.max(x.abs()));
        // a spread below the resolution of the numbers themselves is no spread
        if deviation <= 4.0 * f64::EPSILON * largest || !deviation.recip().is_finite() {
            return Err(FitError::Degenerate(format!(
                "all {} points are at {}: no normal density is likeliest for data without spread; choose another estimator",
                sample.len(),
                centre + offset
            )));
        }
        let field = |mass| -> Arc<dyn Field<1>> {
            Arc::new(Fitted {
                mass,
                centre,
                offset,
                deviation,
                domain: *sample.domain(),
            })
        };
        Ok(Estimate::new(field(sample.mass())).with_channels(
            (0..sample.channels())
                .map(|c| field(sample.channel(c).mass()))
                .collect(),
        ))
    }
}

/// A point of the sample, the distance of the mean from it, and the deviation. O(n).
fn likeliest(sample: &Sample<1>) -> (f64, f64, f64) {
    let x = sample.coordinates();
    // a point of weight zero may be anywhere, and a far centre costs digits
    let centre = (0..x.len())
        .find(|&i| sample.weight(i) > 0.0)
        .map_or(0.0, |i| x[i]);
    let about = |offset: f64, power: i32| {
        let sum: Sum = x
            .iter()
            .enumerate()
            .map(|(i, x)| sample.weight(i) * (x - centre - offset).powi(power))
            .collect();
        sum.value() / sample.mass()
    };
    let offset = about(0.0, 1);
    (centre, offset, about(offset, 2).sqrt())
}

impl Described for Normal {
    const NAME: &'static str = "normal";
    const SUMMARY: &'static str =
        "the likeliest normal density: right if the data are normal, else never";
    const COST: &'static str = "O(n + m)";
    const REFERENCE: &'static str = "Silverman 1986, section 1.1";
    const SMOOTHING: Option<&'static str> = None;
    const PARAMETERS: &'static [Parameter] = &[];

    fn build(_values: &Values, _context: &Context) -> Result<Self, BuildError> {
        Ok(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    #[test]
    fn the_likeliest_normal_divides_by_the_mass() {
        let points = vec![[1.0], [2.0], [4.0], [7.0], [1e18]];
        let weights = vec![3.0, 1.0, 1.0, 1.0, 0.0];
        let sample = Sample::normalised(points, weights, Domain::whole()).expect("legal");
        let (centre, offset, deviation) = likeliest(&sample);
        let mean = centre + offset;
        let expected: f64 = (3.0 * (1.0 - 8.0 / 3.0_f64).powi(2)
            + (2.0 - 8.0 / 3.0_f64).powi(2)
            + (4.0 - 8.0 / 3.0_f64).powi(2)
            + (7.0 - 8.0 / 3.0_f64).powi(2))
            / 6.0;
        assert!((mean - 8.0 / 3.0).abs() < 1e-15);
        assert!((deviation - expected.sqrt()).abs() < 1e-14);
        let fitted = Normal.fit(&sample).expect("spread");
        let peak = 1.0 / (std::f64::consts::TAU.sqrt() * deviation);
        assert!((fitted.at([mean]) - peak).abs() < 1e-15);
    }

    #[test]
    fn data_without_spread_are_refused() {
        for x in [vec![[2.0]], vec![[1e9 / 3.0]; 7], vec![[0.0]; 3]] {
            let sample = Sample::equal(x, Domain::whole()).expect("legal");
            assert!(matches!(Normal.fit(&sample), Err(FitError::Degenerate(_))));
        }
    }
}
