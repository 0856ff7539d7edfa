//! Moments of a kernel over a polygon, as integrals along its outline.
//!
//! The kernel is centred at the origin and of unit width; results are ∫∫ K · (1, t, s, t², ts, s²). The ring is counter-clockwise; what it leaves out
//! of the plane is what a wall cuts off.

use crate::kernel::{Form, Kernel, Shape, Symmetry};
use crate::numeric::GaussLegendre;
use crate::space::Point;
use std::sync::LazyLock;

/// Exact for polynomials of degree 31; panels of the other kernels are short enough for full precision.
static RULE: LazyLock<GaussLegendre> = LazyLock::new(|| GaussLegendre::new(16));

/// Beyond so many deviations the Gaussian kernel is below 1e-16 of its peak.
pub(in crate::boundary) const GAUSSIAN_REACH: f64 = 8.6;

fn reach(shape: Shape) -> f64 {
    shape.reach().min(GAUSSIAN_REACH)
}

fn edges(ring: &[Point<2>]) -> impl Iterator<Item = (Point<2>, Point<2>)> + '_ {
    (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]))
}

/// For a radial kernel k. The field y Φ(|y|) yᵖ with Φ(r) = r^(-m-2) ∫₀ʳ k ρ^(m+1) dρ, m = |p|, has the divergence k yᵖ; so the integral over the
/// polygon is that of Φ yᵖ along each edge, times the distance of the edge from the origin. Beyond the reach of k the integrand is a pure
/// function of the direction.
pub(super) fn radial(shape: Shape, ring: &[Point<2>]) -> [f64; 6] {
    let mut sums = [0.0; 6];
    let (reach, primitive) = (reach(shape), Primitive::new(shape));
    let whole = [0, 1, 2].map(|m| primitive.at(m, reach * reach) * reach.powi(m as i32 + 2));
    for (p, q) in edges(ring) {
        let length = (q[0] - p[0]).hypot(q[1] - p[1]);
        if length == 0.0 {
            continue;
        }
        let along = [(q[0] - p[0]) / length, (q[1] - p[1]) / length];
        let outward = [along[1], -along[0]];
        let distance = p[0] * outward[0] + p[1] * outward[1];
        if distance == 0.0 {
            continue;
        }
        let place = |l: f64| [0, 1].map(|k| distance.mul_add(outward[k], l * along[k]));
        let start = p[0] * along[0] + p[1] * along[1];
        let end = q[0] * along[0] + q[1] * along[1];
        let inner = (reach * reach - distance * distance).max(0.0).sqrt();
        let (from, to) = (start.clamp(-inner, inner), end.clamp(-inner, inner));
        for (a, b) in [(start, end.min(-inner)), (start.max(inner), end)] {
            if a < b {
                let turned = turn(place(a), place(b));
                for (sum, (angular, m)) in sums.iter_mut().zip(turned.into_iter().zip(ORDERS)) {
                    *sum += whole[m] * angular;
                }
            }
        }
        if from < to {
            for panel in panels(shape, distance.abs(), from, to).windows(2) {
                for (l, weight) in RULE.on(panel[0], panel[1]) {
                    let y = place(l);
                    let square = distance.mul_add(distance, l * l);
                    for (sum, (power, m)) in sums.iter_mut().zip(powers(y).into_iter().zip(ORDERS))
                    {
                        *sum += weight * distance * primitive.at(m, square) * power;
                    }
                }
            }
        }
    }
    sums
}

/// For the product kernel K(t) K(s): with A(t) = ∫₋∞ᵗ uᵖ K, Green's formula gives ∫∫ tᵖ sᵠ K K = ∮ A(t) sᵠ K(s) ds.
pub(super) fn product(shape: Shape, ring: &[Point<2>]) -> [f64; 6] {
    let mut sums = [0.0; 6];
    let reach = reach(shape);
    for (p, q) in edges(ring) {
        let (rise, length) = (q[1] - p[1], (q[0] - p[0]).hypot(q[1] - p[1]));
        if rise == 0.0 {
            continue;
        }
        // where the edge is within reach, and where either factor changes its formula
        let mut cuts = vec![0.0, 1.0];
        for axis in 0..2 {
            let change = q[axis] - p[axis];
            let places = [-reach, -1.0, 0.0, 1.0, reach];
            cuts.extend(places.iter().map(|place| (place - p[axis]) / change));
        }
        cuts.retain(|cut| (0.0..=1.0).contains(cut));
        cuts.sort_by(f64::total_cmp);
        for piece in cuts.windows(2) {
            let middle = (0.5 * (piece[0] + piece[1])).mul_add(rise, p[1]);
            if middle.abs() >= reach || piece[1] <= piece[0] {
                continue;
            }
            let parts = match shape {
                Shape::Gaussian => ((piece[1] - piece[0]) * length).ceil().clamp(1.0, 64.0),
                _ => 1.0,
            };
            let step = (piece[1] - piece[0]) / parts;
            for part in 0..parts as usize {
                let low = step.mul_add(part as f64, piece[0]);
                for (l, weight) in RULE.on(low, low + step) {
                    let (t, s) = (l.mul_add(q[0] - p[0], p[0]), l.mul_add(rise, p[1]));
                    let height = weight * rise * shape.value(s);
                    let below = [0, 1, 2].map(|order| shape.partial_moment(order, t) * height);
                    let terms = [
                        below[0],
                        below[1],
                        below[0] * s,
                        below[2],
                        below[1] * s,
                        below[0] * s * s,
                    ];
                    for (sum, term) in sums.iter_mut().zip(terms) {
                        *sum += term;
                    }
                }
            }
        }
    }
    sums
}

/// |p| of each of the six moments.
const ORDERS: [usize; 6] = [0, 1, 1, 2, 2, 2];

fn powers([x, y]: Point<2>) -> [f64; 6] {
    [1.0, x, y, x * x, x * y, y * y]
}

/// ∫ (1, cos, sin, cos², cos sin, sin²) dθ over the directions from `a` to `b`.
fn turn(a: Point<2>, b: Point<2>) -> [f64; 6] {
    let angle = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
    let unit = |[x, y]: Point<2>| {
        let r = x.hypot(y);
        [x / r, y / r]
    };
    let ([c, s], [e, f]) = (unit(a), unit(b));
    [
        angle,
        f - s,
        c - e,
        0.5 * (angle + (e * f - c * s)),
        0.5 * (f * f - s * s),
        0.5 * (angle - (e * f - c * s)),
    ]
}

/// Cuts the part of an edge within reach so that the primitive is smooth on each piece.
fn panels(shape: Shape, distance: f64, from: f64, to: f64) -> Vec<f64> {
    let mut cuts = vec![from, to];
    match shape {
        // √(d² + l²) bends at l = 0 within about d
        Shape::Triangular => {
            cuts.push(0.0);
            let mut step = distance.max(1e-12);
            while step < 1.0 {
                cuts.extend([-step, step]);
                step *= 4.0;
            }
        }
        Shape::Gaussian => cuts.extend((-9..=9).map(f64::from)),
        _ => {}
    }
    cuts.retain(|cut| (from..=to).contains(cut));
    cuts.sort_by(f64::total_cmp);
    cuts
}

/// Φₘ(r) = r^(-m-2) ∫₀ʳ k ρ^(m+1) dρ of the radial kernel k, for r within reach.
struct Primitive {
    shape: Shape,
    /// Coefficients of k in powers of r, or of r² for the series.
    terms: Vec<f64>,
    /// Whether the powers are those of r².
    even: bool,
}

impl Primitive {
    fn new(shape: Shape) -> Self {
        let factor = Symmetry::Radial.factor::<2>(shape);
        let (terms, even) = match shape.form() {
            Form::Polynomial(c) => (c.iter().map(|c| c * factor).collect(), false),
            // both series have lost all their terms to rounding at 24 for r ≤ 1.6
            Form::Cosine => (
                series(std::f64::consts::FRAC_PI_4 * factor, |k| {
                    -std::f64::consts::FRAC_PI_2.powi(2) / ((2.0 * k + 1.0) * (2.0 * k + 2.0))
                }),
                true,
            ),
            Form::Gaussian => (
                series(0.5 / std::f64::consts::PI, |k| -0.5 / (k + 1.0)),
                true,
            ),
        };
        Self { shape, terms, even }
    }

    fn at(&self, m: usize, square: f64) -> f64 {
        if self.shape == Shape::Gaussian && square > 2.5 {
            return gaussian(m, square);
        }
        let step = if self.even { square } else { square.sqrt() };
        let mut total = 0.0;
        for (k, term) in self.terms.iter().enumerate().rev() {
            let power = if self.even { 2 * k } else { k };
            total = f64::mul_add(total, step, term / (power + m + 2) as f64);
        }
        total
    }
}

fn series(first: f64, ratio: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut terms = vec![first];
    for k in 0..23 {
        terms.push(terms[k] * ratio(k as f64));
    }
    terms
}

/// The same for φ(|y|), where the closed form does not cancel.
fn gaussian(m: usize, square: f64) -> f64 {
    let (r, tail) = (square.sqrt(), (-0.5 * square).exp());
    let below = match m {
        0 => 1.0 - tail,
        1 => {
            (0.5 * std::f64::consts::PI).sqrt() * libm::erf(r * std::f64::consts::FRAC_1_SQRT_2)
                - r * tail
        }
        _ => 2.0 - (square + 2.0) * tail,
    };
    below / (2.0 * std::f64::consts::PI) / r.powi(m as i32 + 2)
}
