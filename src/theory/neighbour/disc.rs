//! The probability of discs about one place of the plane.

use super::Convention;
use crate::density::Density;
use crate::numeric::{GaussLegendre, Piecewise, Sum, panels};
use crate::space::Point;
use crate::theory::Moments;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));

/// Radii numbered so that functions with roots at the ends of panels are smooth: panel i from i to i + 1, r = middle - half cos(π t) in it.
///
/// Where a circle begins to leave the domain through a wall at distance d, what is lost grows like √(r - d): no polynomial in r follows that, however short its piece, but in t it is
/// as smooth as a sine.
struct Radii {
    /// The ends of the panels, ascending.
    ends: Vec<f64>,
}

impl Radii {
    /// Middle and half of the panel of `u`, and π t.
    fn panel(&self, u: f64) -> (f64, f64, f64) {
        let i = (u.max(0.0) as usize).min(self.ends.len() - 2);
        let (a, b) = (self.ends[i], self.ends[i + 1]);
        (0.5 * (a + b), 0.5 * (b - a), PI * (u - i as f64))
    }

    fn radius(&self, u: f64) -> f64 {
        let (middle, half, angle) = self.panel(u);
        half.mul_add(-angle.cos(), middle)
    }

    /// dr/du.
    fn slope(&self, u: f64) -> f64 {
        let (_, half, angle) = self.panel(u);
        PI * half * angle.sin().abs()
    }
}

/// How the probability of a disc about a place grows with its radius: a table, made once for any k and n. Radii go by their numbers.
pub(super) struct Disc {
    radii: Radii,
    /// ρ ∫ f(x + ρe) dθ dρ/du, what a ring adds, from the first to the last of `cuts`.
    ring: Piecewise,
    cuts: Vec<f64>,
    /// The probability out to each cut.
    below: Vec<f64>,
    /// Whether the density at the place is positive.
    positive: bool,
}

/// The mass that no disc needs to hold.
const TAIL: f64 = 1e-15;

/// The precision of rings for moments at a place.
pub(super) const EXACT: f64 = 1e-11;

/// The precision of rings for moments that are summed up to an error of which four digits are wanted, for k/n of 1e-4 at least: it is one of the largest ring.
pub(super) const ROUGH: f64 = 1e-7;

impl Disc {
    /// The discs about `x`, what a ring adds to `precision` of the largest: some ten thousand evaluations of the density at 1e-11, ten times as many where walls cut the discs.
    pub(super) fn about(truth: &dyn Density<2>, x: Point<2>, precision: f64) -> Self {
        let (low, high) = truth.bulk(TAIL);
        let scale = truth.finest_scale(0).min(truth.finest_scale(1));
        let outside = [0, 1].map(|k: usize| (low[k] - x[k]).max(x[k] - high[k]).max(0.0));
        let across = [0, 1].map(|k: usize| (x[k] - low[k]).abs().max((high[k] - x[k]).abs()));
        let (nearest, farthest) = (outside[0].hypot(outside[1]), across[0].hypot(across[1]));
        let walls = walls(truth);
        let kinks = walls.iter().flat_map(|&[a, b]| {
            let foot = foot(a, b, x);
            [Some(a), foot]
                .into_iter()
                .flatten()
                .map(|y| (y[0] - x[0]).hypot(y[1] - x[1]))
        });
        let ends = panels(nearest, farthest, kinks, 2.0 * scale);
        let length = ends[1..].iter().zip(&ends).map(|(b, a)| b - a);
        let longest = length.fold(0.0, f64::max);
        let radii = Radii { ends };
        let on_circle = |r: f64| r * circle(truth, &walls, x, r, scale);
        let largest = radii.ends.iter().map(|r| on_circle(*r)).fold(0.0, f64::max);
        let ring = |u: f64| on_circle(radii.radius(u)) * radii.slope(u);
        let panels: Vec<f64> = (0..radii.ends.len()).map(|i| i as f64).collect();
        let negligible = precision * largest.max(1e-3 / farthest) * longest;
        let ring = Piecewise::fit(ring, &panels, negligible);
        let cuts: Vec<f64> = ring.cuts().collect();
        let mut total = Sum::default();
        let mut below = vec![0.0];
        for piece in cuts.windows(2) {
            total.add(RULE.integrate(|u| ring.at(u), piece[0], piece[1]).max(0.0));
            below.push(total.value());
        }
        // all of the mass is somewhere
        let total = total.value();
        for mass in &mut below {
            *mass /= total;
        }
        Self {
            radii,
            ring,
            cuts,
            below,
            positive: truth.at(x) > 0.0,
        }
    }

    /// The probability of the disc with radius number `u`.
    fn mass(&self, u: f64) -> f64 {
        let last = self.cuts.len() - 2;
        let piece = self.cuts.partition_point(|cut| *cut <= u).saturating_sub(1);
        if piece > last {
            return 1.0;
        }
        let from = self.cuts[piece];
        if u <= from {
            return self.below[piece];
        }
        let more = RULE.integrate(|u| self.ring.at(u), from, u);
        (self.below[piece] + more).clamp(0.0, 1.0)
    }

    /// The number of the radius where the probability is `p`, within 1e-6 of a piece: what is cut there need not be cut exactly.
    fn about_number(&self, p: f64) -> f64 {
        let last = self.cuts.len() - 2;
        let piece = (self
            .below
            .partition_point(|mass| *mass < p)
            .saturating_sub(1))
        .min(last);
        let (mut low, mut high) = (self.cuts[piece], self.cuts[piece + 1]);
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if self.mass(middle) < p {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Mean and variance of the estimate: over the radius r of the disc, whose probability p has the Beta(k, n - k + 1) distribution, so that r has the
    /// density p^(k-1) (1 - p)^(n-k) dp/dr up to a factor, and its number u that with dp/du.
    pub(super) fn moments(&self, k: usize, convention: Convention, draws: usize) -> Moments {
        let (n, k) = (draws as f64, k as f64);
        let share = if convention == Convention::Raw {
            k
        } else {
            k - 1.0
        } / n;
        let mode = ((k - 1.0) / (n - 1.0).max(1.0)).clamp(1e-300, 1.0 - 1e-16);
        let log = |p: f64| (k - 1.0) * p.ln() + (n - k) * (-p).ln_1p();
        let top = log(mode);
        let mean = k / (n + 1.0);
        let deviation = (mean * (1.0 - mean) / (n + 2.0)).sqrt();
        let ladder = [
            -10.0, -6.5, -4.5, -3.0, -1.5, 0.0, 1.5, 3.0, 4.5, 6.5, 10.0, 15.0, 24.0, 40.0,
        ];
        let places = ladder
            .iter()
            .map(|z: &f64| z.mul_add(deviation, mean))
            .chain([0.02 * mean, 0.15 * mean, 0.4 * mean])
            .chain((1..8).map(|i| 1.0 - 0.25f64.powi(i)))
            .filter(|p| 0.0 < *p && *p < 1.0)
            .map(|p| self.about_number(p))
            .chain(self.cuts.iter().copied());
        let (first, last) = (self.cuts[0], self.cuts[self.cuts.len() - 1]);
        let (mut norm, mut one, mut two) = (Sum::default(), Sum::default(), Sum::default());
        for piece in panels(first, last, places, f64::INFINITY).windows(2) {
            // nothing there, by far: the ends tell, as the weight has one mode
            let ends = [piece[0], piece[1]].map(|u| self.mass(u));
            let nearest = mode.clamp(ends[0], ends[1]);
            if log(nearest.clamp(1e-300, 1.0 - 1e-16)) - top < -60.0 {
                continue;
            }
            for (u, step) in RULE.on(piece[0], piece[1]) {
                let p = self.mass(u);
                if p <= 0.0 || p >= 1.0 {
                    continue;
                }
                let weight = step * (log(p) - top).exp() * self.ring.at(u).max(0.0);
                let r = self.radii.radius(u);
                let value = share / (PI * r * r);
                norm.add(weight);
                one.add(weight * value);
                two.add(weight * value * value);
            }
        }
        let mean = one.value() / norm.value();
        let variance = if k <= 2.0 && self.positive {
            f64::INFINITY
        } else {
            (two.value() / norm.value() - mean * mean).max(0.0)
        };
        Moments { mean, variance }
    }
}

/// The walls of the domain; ends at infinity are taken for where the mass ends.
fn walls(truth: &dyn Density<2>) -> Vec<[Point<2>; 2]> {
    let domain = truth.domain();
    if let Some(outline) = domain.outline() {
        return outline.edges().collect();
    }
    if !domain.has_walls() {
        return Vec::new();
    }
    let (low, high) = truth.bulk(TAIL);
    let [a, b] = [0, 1].map(|k: usize| domain.low()[k].max(low[k]));
    let [c, d] = [0, 1].map(|k: usize| domain.high()[k].min(high[k]));
    let corners = [[a, b], [c, b], [c, d], [a, d]];
    (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect()
}

/// The foot of the perpendicular from `x`, if it is on the edge.
fn foot(a: Point<2>, b: Point<2>, x: Point<2>) -> Option<Point<2>> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let along = ((x[0] - a[0]) * d[0] + (x[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    (0.0..=1.0)
        .contains(&along)
        .then(|| [along.mul_add(d[0], a[0]), along.mul_add(d[1], a[1])])
}

/// ∫ f(x + r(cos θ, sin θ)) dθ: equal steps where the density is smooth all round, else arcs between walls.
fn circle(truth: &dyn Density<2>, walls: &[[Point<2>; 2]], x: Point<2>, r: f64, scale: f64) -> f64 {
    let at = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        [r.mul_add(cosine, x[0]), r.mul_add(sine, x[1])]
    };
    if walls.is_empty() {
        // a ring through a normal of deviation s needs steps of 0.8 s
        let steps = (24.0 + 9.0 * r / scale).min(4000.0) as usize;
        let step = 2.0 * PI / steps as f64;
        return step
            * (0..steps)
                .map(|i| truth.at(at(step * i as f64)))
                .sum::<f64>();
    }
    let mut cuts = Vec::new();
    for [a, b] in walls {
        // |a + t(b - a) - x| = r
        let (d, e) = ([b[0] - a[0], b[1] - a[1]], [a[0] - x[0], a[1] - x[1]]);
        let square = d[0] * d[0] + d[1] * d[1];
        let middle = -(e[0] * d[0] + e[1] * d[1]) / square;
        let away = (e[0] * d[1] - e[1] * d[0]).powi(2) / square;
        if away < r * r {
            let half = ((r * r - away) / square).sqrt();
            for t in [middle - half, middle + half] {
                if (0.0..=1.0).contains(&t) {
                    cuts.push((t * d[1] + e[1]).atan2(t * d[0] + e[0]));
                }
            }
        }
    }
    let arcs = panels(-PI, PI, cuts, (2.0 * scale / r).min(FRAC_PI_2));
    let domain = truth.domain();
    arcs.windows(2)
        .filter(|arc| domain.contains(at(0.5 * (arc[0] + arc[1]))))
        .map(|arc| RULE.integrate(|angle| truth.at(at(angle)), arc[0], arc[1]))
        .sum()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::density::named_in_plane;

    /// The probability of the disc with this radius.
    fn mass(disc: &Disc, r: f64) -> f64 {
        let ends = &disc.radii.ends;
        let i = (ends.partition_point(|end| *end <= r) - 1).min(ends.len() - 2);
        let (a, b) = (ends[i], ends[i + 1]);
        let cosine = (a + b - 2.0 * r) / (b - a);
        disc.mass(i as f64 + cosine.clamp(-1.0, 1.0).acos() / PI)
    }

    /// Of N(0, I) about its middle a disc has 1 - exp(-r²/2); of the even square what lies in it.
    #[test]
    fn discs_have_the_probability_that_is_known() {
        let normal = named_in_plane("normal-2d").unwrap();
        let disc = Disc::about(&*normal, [0.0, 0.0], EXACT);
        for r in [0.01f64, 0.3, 1.0, 2.5, 6.0] {
            let exact = -(-0.5 * r * r).exp_m1();
            assert!((mass(&disc, r) / exact - 1.0).abs() < 1e-11, "{r}");
        }
        // elsewhere, against boxes of rings in the normal's distribution of |X|², not central: by a fine sum
        let disc = Disc::about(&*normal, [3.0, -1.0], EXACT);
        let far: f64 = (0..2000)
            .map(|i| {
                let r = (f64::from(i) + 0.5) * 5e-4;
                let ring: f64 = (0..64)
                    .map(|j| {
                        let angle = f64::from(j) * PI / 32.0;
                        normal.at([r.mul_add(angle.cos(), 3.0), r.mul_add(angle.sin(), -1.0)])
                    })
                    .sum();
                ring * PI / 32.0 * r * 5e-4
            })
            .sum();
        assert!(
            (mass(&disc, 1.0) / far - 1.0).abs() < 1e-6,
            "{}",
            mass(&disc, 1.0)
        );
        let even = named_in_plane("uniform-2d").unwrap();
        let disc = Disc::about(&*even, [0.25, 0.5], EXACT);
        assert!((mass(&disc, 0.2) - PI * 0.04).abs() < 1e-10);
        let segment = |d: f64, r: f64| r * r * (d / r).acos() - d * (r * r - d * d).sqrt();
        let cut = PI * 0.16 - segment(0.25, 0.4);
        assert!(
            (mass(&disc, 0.4) - cut).abs() < 1e-9,
            "{} {cut}",
            mass(&disc, 0.4)
        );
    }

    /// In an even density, far from the walls, the moments of the Beta distribution.
    #[test]
    fn an_even_density_has_the_moments_of_the_beta_distribution() {
        let even = named_in_plane("uniform-2d").unwrap();
        let disc = Disc::about(&*even, [0.5, 0.5], EXACT);
        let (n, k) = (10_000.0, 40.0);
        for (convention, c) in [(Convention::Unbiased, k - 1.0), (Convention::Raw, k)] {
            let found = disc.moments(40, convention, 10_000);
            let mean = c / (k - 1.0);
            let square = c * c * (n - 1.0) / n / ((k - 1.0) * (k - 2.0));
            assert!((found.mean / mean - 1.0).abs() < 1e-8, "{found:?}");
            assert!(
                (found.variance / (square - mean * mean) - 1.0).abs() < 1e-6,
                "{found:?}"
            );
        }
        assert!(
            disc.moments(2, Convention::Unbiased, 100)
                .variance
                .is_infinite()
        );
    }
}
