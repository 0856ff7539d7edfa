//! Known truths: densities with everything about them in closed form.

mod uniform;

pub use uniform::Uniform;

use crate::random::Stream;
use crate::space::{Field, Point};

/// A probability density that can be drawn from. Its [`Field::domain`] is its support: open sides where it goes on (or fades out smoothly), walls
/// where it stops with a jump.
pub trait Density<const D: usize>: Field<D> {
    /// One point.
    fn draw(&self, random: &mut Stream) -> Point<D>;

    /// The probability of the box from `low` to `high`.
    fn probability(&self, low: Point<D>, high: Point<D>) -> f64;

    /// Where, along `axis`, the density or one of its first two derivatives jumps; quadratures cut their panels there. Ascending.
    fn breaks(&self, axis: usize) -> Vec<f64>;

    /// The shortest length over which the density changes much along `axis`: no quadrature panel should be much longer.
    fn finest_scale(&self, axis: usize) -> f64;

    /// A box outside which less than `tail` of the mass lies on each side of each axis; finite.
    fn bulk(&self, tail: f64) -> (Point<D>, Point<D>);
}

/// A density on a line, with what only exists there.
pub trait Univariate: Density<1> {
    /// F(x), the distribution function.
    fn distribution(&self, x: f64) -> f64;

    /// F⁻¹(p) for 0 ≤ p ≤ 1; the ends of the support (perhaps infinite) at 0 and 1.
    fn quantile(&self, p: f64) -> f64;

    /// f'(x) or f''(x) for `order` 1 or 2, one-sided from inside at a break; 0 outside the support.
    fn derivative(&self, order: u32, x: f64) -> f64;

    /// R(f⁽ʳ⁾) = ∫ (f⁽ʳ⁾)² over the whole line for `order` r = 0, 1, 2; infinite where a jump in a lower derivative makes the
    /// derivative a delta, so that asymptotic theory that needs it says so instead of giving a wrong number.
    fn roughness(&self, order: u32) -> f64;

    /// The mean and the standard deviation.
    fn mean_and_deviation(&self) -> (f64, f64);

    /// The density as weighted normals, where it is one: exact errors have closed forms then.
    fn normal_components(&self) -> Option<&[NormalComponent]> {
        None
    }
}

/// One part of a normal mixture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalComponent {
    /// Its share of the mass.
    pub weight: f64,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}
