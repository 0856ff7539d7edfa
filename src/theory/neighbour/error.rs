//! Integrated errors of nearest-neighbour estimates, and the best k.

use super::disc::{Disc, ROUGH};
use super::{Convention, on_line};
use crate::density::{Bivariate, Density, Univariate};
use crate::numeric::{GaussLegendre, Sum, panels};
use crate::space::Point;
use crate::theory::{Integrated, Moments};
use rayon::prelude::*;
use std::f64::consts::PI;

/// The integrated errors over the whole line or plane of nearest-neighbour estimates of one density, for any k ≥ 3 and sample size.
///
/// Far away the estimate falls off like 1/|x| on the line and 1/|x|² in the plane, slowly, but its square can be integrated: the panels reach out to some
/// hundred deviations, and beyond them all data are at one place. Good to about 1e-4 of the error; in the plane, where tables are made first, a second.
pub struct NeighbourError<'a> {
    truth: Truth<'a>,
    /// Weight, density and place of each node.
    nodes: Vec<(f64, f64, Point<2>)>,
    discs: Vec<Disc>,
    /// How far the nodes reach, and the deviation.
    scales: (f64, f64),
}

enum Truth<'a> {
    Line(&'a dyn Univariate),
    Plane,
}

/// Panels of one axis: where the density changes, and outwards to `far` deviations.
fn axis(low: f64, high: f64, breaks: Vec<f64>, scale: f64, deviation: f64) -> Vec<f64> {
    let middle = 0.5 * (low + high);
    let mut cuts = panels(low, high, breaks, scale);
    for out in [0.15, 0.5, 1.3, 3.0, 7.0, 18.0, 45.0, 100.0] {
        cuts.extend([low - out * deviation, high + out * deviation]);
    }
    let far = 100.0 * deviation + (high - middle);
    cuts.retain(|cut| (cut - middle).abs() <= far * (1.0 + 1e-12));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

impl<'a> NeighbourError<'a> {
    /// The errors on a line.
    pub fn on_line(truth: &'a dyn Univariate) -> Self {
        let density: &dyn Density<1> = truth;
        let ([low], [high]) = density.bulk(1e-6);
        let deviation = truth.mean_and_deviation().1;
        let scale = 2.0 * density.finest_scale(0);
        let cuts = axis(low, high, density.breaks(0), scale, deviation);
        let rule = GaussLegendre::new(8);
        let nodes = cuts
            .windows(2)
            .flat_map(|panel| rule.on(panel[0], panel[1]))
            .map(|(x, weight)| (weight, density.at([x]), [x, 0.0]))
            .collect();
        Self {
            truth: Truth::Line(truth),
            nodes,
            discs: Vec::new(),
            scales: (0.5 * (cuts[cuts.len() - 1] - cuts[0]), deviation),
        }
    }

    /// The errors in the plane; `None` where the domain wraps round.
    pub fn in_plane(truth: &dyn Bivariate) -> Option<Self> {
        if truth.domain().wraps() {
            return None;
        }
        let (low, high) = truth.bulk(1e-5);
        let (_, covariance) = truth.mean_and_covariance();
        let deviation = covariance[0][0].max(covariance[1][1]).sqrt();
        let rule = GaussLegendre::new(4);
        let along = |k: usize| -> Vec<(f64, f64)> {
            let scale = 2.0 * truth.finest_scale(k);
            // no more panels than can be paid for
            let scale = scale.max((high[k] - low[k]) / 24.0);
            axis(low[k], high[k], truth.breaks(k), scale, deviation)
                .windows(2)
                .flat_map(|panel| rule.on(panel[0], panel[1]))
                .collect()
        };
        let (first, second) = (along(0), along(1));
        let mut nodes = Vec::new();
        for &(x, a) in &first {
            for &(y, b) in &second {
                nodes.push((a * b, truth.at([x, y]), [x, y]));
            }
        }
        let discs = nodes
            .par_iter()
            .map(|(_, _, place)| Disc::about(truth, *place, ROUGH))
            .collect();
        Some(Self {
            truth: Truth::Plane,
            nodes,
            discs,
            scales: (100.0 * deviation, deviation),
        })
    }

    /// The errors with the `k`-th neighbour of `draws` points; infinite for k = 2.
    ///
    /// # Panics
    /// For k below 2, more than `draws`, or the mean radius, whose errors are not known.
    pub fn at(&self, k: usize, convention: Convention, draws: usize) -> Integrated {
        assert!(
            2 <= k && k <= draws,
            "the {k}-th neighbour of {draws} points"
        );
        assert!(convention != Convention::MeanRadius, "not known");
        let share = match convention {
            Convention::Raw => k as f64,
            _ => k as f64 - 1.0,
        } / draws as f64;
        let moments: Vec<Moments> = match self.truth {
            Truth::Line(line) => (self.nodes.par_iter())
                .map(|(_, _, x)| on_line(line, x[0], k, convention, draws))
                .collect(),
            Truth::Plane => (self.discs.par_iter())
                .map(|disc| disc.moments(k, convention, draws))
                .collect(),
        };
        let (mut squared_bias, mut variance) = (Sum::default(), Sum::default());
        for ((weight, f, _), m) in self.nodes.iter().zip(moments) {
            squared_bias.add(weight * (m.mean - f).powi(2));
            variance.add(weight * m.variance);
        }
        // beyond the nodes: ∫ (share/2x)² on both sides, or ∫ (share/πr²)² around
        let far = self.scales.0;
        squared_bias.add(match self.truth {
            Truth::Line(_) => 0.5 * share * share / far,
            // 1/r⁴ outside a square of half side L: (1 + π/2)/L²
            Truth::Plane => (1.0 + 0.5 * PI) * (share / PI / far).powi(2),
        });
        Integrated {
            squared_bias: squared_bias.value(),
            variance: variance.value(),
        }
    }

    /// The k of least MISE, with its errors, if it has one minimum: see `best_count`.
    pub fn optimum(&self, convention: Convention, draws: usize) -> (usize, Integrated) {
        best_count(
            3,
            draws,
            |k| self.at(k, convention, draws),
            Integrated::mise,
        )
    }
}

/// The whole number between `least` and `most` where a `size` is least, if it has one minimum: upwards on a ladder of steps of 60 % until it has risen
/// three times in a row, then between the neighbours of the least.
pub(in crate::theory) fn best_count<T>(
    least: usize,
    most: usize,
    value: impl Fn(usize) -> T,
    size: impl Fn(T) -> f64,
) -> (usize, T)
where
    T: Copy,
{
    let mut known: std::collections::BTreeMap<usize, T> = std::collections::BTreeMap::new();
    let mut look = |k: usize| {
        let found = *known.entry(k).or_insert_with(|| value(k));
        size(found)
    };
    let mut ladder = vec![least.min(most)];
    let (mut best, mut rises) = (0, 0);
    while let Some(&last) = ladder.last()
        && last < most
        && rises < 3
    {
        ladder.push((last + 1).max((1.6 * last as f64) as usize).min(most));
        let at = ladder.len() - 1;
        if look(ladder[at]) < look(ladder[best]) {
            (best, rises) = (at, 0);
        } else {
            rises += 1;
        }
    }
    let (mut low, mut high) = (
        ladder[best.saturating_sub(1)],
        ladder[(best + 1).min(ladder.len() - 1)],
    );
    while high - low > 2 {
        let (a, b) = (low + (high - low) / 3, high - (high - low) / 3);
        if look(a) <= look(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let mut at = ladder[best];
    for k in low..=high {
        if look(k) < look(at) {
            at = k;
        }
    }
    (at, value(at))
}
