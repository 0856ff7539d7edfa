//! How much a density differs from itself a little further on: all that the integrated errors of kernel estimates know of it.
//!
//! With A(t) = ∫ f(x) f(x + t) dx, both ∫ (K_h * f)² and ∫ (K_h * f) f are integrals of a function of the kernel against A, whatever the
//! bandwidth. What is kept is the deficit A(0) - A(t) = ½ ∫ (f(x + t) - f(x))² dx, a sum of squares, so that small errors are not lost in differences.

use crate::density::{NormalComponent, Univariate};
use crate::numeric::special::normal_density;
use crate::numeric::{GaussLegendre, Piecewise, panels};

/// The part of the autocorrelation of a normal mixture that a pair of components makes: weight · ½ \[φ(t - distance) + φ(t + distance)\], of that variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub weight: f64,
    pub distance: f64,
    pub variance: f64,
}

/// All pairs of `components`, equal ones merged.
pub(super) fn pairs(components: &[NormalComponent]) -> Vec<Pair> {
    let mut all = Vec::new();
    for (i, a) in components.iter().enumerate() {
        for (j, b) in components[..=i].iter().enumerate() {
            all.push(Pair {
                weight: a.weight * b.weight * if i == j { 1.0 } else { 2.0 },
                distance: (a.mean - b.mean).abs(),
                variance: a.deviation.powi(2) + b.deviation.powi(2),
            });
        }
    }
    all.sort_by(|a, b| (a.variance.total_cmp(&b.variance)).then(a.distance.total_cmp(&b.distance)));
    let mut merged: Vec<Pair> = Vec::with_capacity(all.len());
    for pair in all {
        match merged.last_mut() {
            Some(last)
                if (last.distance - pair.distance).abs() <= 1e-14 * pair.variance.sqrt()
                    && (last.variance - pair.variance).abs() <= 1e-14 * pair.variance =>
            {
                last.weight += pair.weight;
            }
            _ => merged.push(pair),
        }
    }
    merged
}

impl Pair {
    /// Its part of A(0) - A(t), to full relative precision for small t.
    fn deficit(&self, t: f64) -> f64 {
        let s = self.variance.sqrt();
        let (t, d) = (t / s, self.distance / s);
        let density = if t < 1.0 && t * d < 1.0 {
            // φ(d) [1 - exp(-t²/2) cosh(td)] without its cancellation
            let rise = 2.0 * (0.5 * t * d).sinh().powi(2);
            -normal_density(d) * (-0.5 * t * t).exp_m1().mul_add((t * d).cosh(), rise)
        } else {
            normal_density(d) - 0.5 * (normal_density(t - d) + normal_density(t + d))
        };
        self.weight * density / s
    }
}

/// A(0) - A(t) of a density, as a table.
pub(super) struct Deficit {
    table: Piecewise,
    end: f64,
    total: f64,
}

impl Deficit {
    /// Tabulates. Some milliseconds for mixtures, up to some tenths of a second where each value is itself an integral.
    pub(super) fn of(truth: &dyn Univariate) -> Self {
        let ([low], [high]) = truth.bulk(1e-18);
        let (width, total) = (high - low, truth.roughness(0));
        // the table is relatively good near 0 too: pieces that shrink towards it
        let ladder = (0..=14).map(|k| width * 0.25_f64.powi(k));
        let table = if let Some(components) = truth.normal_components() {
            let pairs = pairs(components);
            let cuts = pairs.iter().flat_map(|pair| {
                let s = pair.variance.sqrt();
                [-9.0, -6.0, -3.5, -1.5, 0.0, 1.5, 3.5, 6.0, 9.0]
                    .map(|k: f64| k.mul_add(s, pair.distance))
            });
            let cuts = panels(0.0, width, ladder.chain(cuts), f64::INFINITY);
            let deficit = |t| pairs.iter().map(|pair| pair.deficit(t)).sum();
            Piecewise::fit(deficit, &cuts, 1e-17 * total)
        } else {
            let breaks = truth.breaks(0);
            // where a break meets another one the deficit may have a kink; ladders of breaks are left to the halving of pieces
            let ends: Vec<f64> = if breaks.len() <= 8 {
                breaks.clone()
            } else {
                vec![low, high]
            };
            let kinks = ends
                .iter()
                .flat_map(|a| ends.iter().map(move |b| (a - b).abs()));
            let cuts = panels(0.0, width, ladder.chain(kinks), truth.finest_scale(0));
            let rule = GaussLegendre::new(20);
            let deficit = |t: f64| {
                let moved = breaks.iter().map(|cut| cut - t);
                let both = breaks.iter().copied().chain(moved);
                let cuts = panels(low - t, high, both, truth.finest_scale(0));
                let square = |x: f64| (truth.at([x + t]) - truth.at([x])).powi(2);
                0.5 * rule.integrate_panels(square, &cuts)
            };
            Piecewise::fit(deficit, &cuts, 1e-16 * total)
        };
        Self {
            table,
            end: width,
            total,
        }
    }

    /// A(0) - A(t) for t ≥ 0.
    pub(super) fn at(&self, t: f64) -> f64 {
        if t < self.end {
            self.table.at(t)
        } else {
            self.total
        }
    }

    /// A(0) = R(f).
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// Where pieces of the table meet.
    pub(super) fn cuts(&self) -> impl Iterator<Item = f64> + '_ {
        self.table.cuts()
    }
}
