//! Known truths: densities with everything about them in closed form.
//!
//! | density | names | file |
//! |---|---|---|
//! | weighted normals, given component by component | `normal-mixture` | `mixture.rs` |
//! | the fifteen of Marron and Wand | `mw-1` ... `mw-15`, and a word for each (`normal`, `bimodal`, `claw`, ...) | `marron_wand.rs` |
//! | flat, with a wall at each end | `uniform` | `uniform.rs` |
//! | 2x and 2(1 - x) on \[0, 1\] | `ramp-up`, `ramp-down` | `ramp.rs` |
//! | exponential decay from a wall, endless or cut off at 1 | `exponential`, `truncated-exponential` | `exponential.rs`, `truncated_exponential.rs` |
//! | the right half of a normal | `half-normal` | `half_normal.rs` |
//! | xᵃ⁻¹ (1 - x)ᵇ⁻¹ on \[0, 1\] | `beta` | `beta.rs` |
//! | a window on another density, which goes on beyond it | `window`; in the plane `window-2d` | `window.rs`, `plane/window.rs` |
//! | in the plane: normals, products, the unit square lit in several ways, rooms with polygons for walls | see `plane/` | `plane/` |
//!
//! To add a density: one file with its type and its [`Entry`], one line in [`CATALOGUE`]. The law tests find it there.
//!
//! # Drawing
//! Each density says how many random words a draw takes. All but the beta density (and products with it) invert their distribution function, so that the number is fixed and
//! equal streams give similar samples from similar densities.

mod beta;
mod exponential;
mod half_normal;
mod marron_wand;
mod mixture;
mod plane;
mod ramp;
mod truncated_exponential;
mod uniform;
mod window;

pub use beta::Beta;
pub use exponential::Exponential;
pub use half_normal::HalfNormal;
pub use marron_wand::marron_wand;
pub use mixture::{MixtureError, NormalComponent, NormalMixture};
pub use plane::{
    NormalAt, PlaneComponent, PlaneMixture, PlaneMixtureError, Product, Room, Smooth, Square,
    SquarePart, WindowPlane, normal_at,
};
pub use ramp::{Direction, Ramp};
pub use truncated_exponential::TruncatedExponential;
pub use uniform::Uniform;
pub use window::Window;

use crate::parameter::{Absent, BuildError, Parameter, Values};
use crate::random::Stream;
use crate::space::{Field, Point};
use std::sync::Arc;

/// A probability density that can be drawn from. Its [`Field::domain`] is its support: open at infinity, walls where the support ends.
pub trait Density<const D: usize>: Field<D> {
    /// One point.
    fn draw(&self, random: &mut Stream) -> Point<D>;

    /// `many` points, to the bit those that [`Density::draw`] gives one after the other; for less, where the density can.
    fn draws(&self, many: usize, random: &mut Stream) -> Vec<Point<D>> {
        (0..many).map(|_| self.draw(random)).collect()
    }

    /// The probability of the box from `low` to `high`.
    fn probability(&self, low: Point<D>, high: Point<D>) -> f64;

    /// Where, along `axis`, the density or one of its first two derivatives jumps; quadratures cut their panels there. Where it behaves
    /// like a broken power of the distance from a place, a ladder of places that close in on it geometrically. Ascending.
    fn breaks(&self, axis: usize) -> Vec<f64>;

    /// The shortest length over which the density changes much along `axis`: no quadrature panel should be much longer.
    fn finest_scale(&self, axis: usize) -> f64;

    /// A box outside which at most `tail` of the mass lies on each side of each axis; finite.
    fn bulk(&self, tail: f64) -> (Point<D>, Point<D>);

    /// What goes on beyond the domain, for a domain that is only a window: a density and the factor by which this one is that, so that f = factor · g on the domain. Points drawn from g that fall beyond are
    /// what a virtual margin registers.
    fn beyond(&self) -> Option<(&dyn Density<D>, f64)> {
        None
    }

    /// The value, where it is the same on all of the domain.
    fn level(&self) -> Option<f64> {
        None
    }

    /// The same density with what only exists on a line, in one dimension.
    fn univariate(&self) -> Option<&dyn Univariate> {
        None
    }

    /// The same density with what only exists in the plane, in two dimensions.
    fn bivariate(&self) -> Option<&dyn Bivariate> {
        None
    }
}

/// A density in the plane, with what theory needs of it there.
pub trait Bivariate: Density<2> {
    /// ∇f(x), one-sided from inside at a break; 0 outside the support.
    fn gradient(&self, x: Point<2>) -> [f64; 2];

    /// Δf(x) = ∂²f/∂x² + ∂²f/∂y², one-sided from inside at a break; 0 outside the support.
    fn laplacian(&self, x: Point<2>) -> f64;

    /// ∫|∇f|² over the whole plane; infinite where the density jumps. What the bias of a histogram needs.
    fn gradient_roughness(&self) -> f64;

    /// ∫(Δf)² over the whole plane; infinite where the density or its gradient jumps, so that asymptotic theory that needs it says so. What the
    /// bias of a kernel estimate needs.
    fn laplacian_roughness(&self) -> f64;

    /// The probability of a convex polygon with these corners, counter-clockwise; 0 of fewer than three. Exact to rounding where it is known in closed form, else by quadrature to some 1e-12 where the density is smooth between its breaks, and less near places where it rises like a root.
    fn probability_within(&self, corners: &[Point<2>]) -> f64;

    /// The mean and the covariance matrix.
    fn mean_and_covariance(&self) -> (Point<2>, [[f64; 2]; 2]);

    /// The density as weighted normals, where it is one: exact errors have closed forms then.
    fn normal_components(&self) -> Option<&[PlaneComponent]> {
        None
    }

    /// The density as the product of one on each axis, where it is one.
    fn factors(&self) -> Option<[&dyn Univariate; 2]> {
        None
    }
}

/// A density on a line, with what only exists there.
pub trait Univariate: Density<1> {
    /// F(x), the distribution function.
    fn distribution(&self, x: f64) -> f64;

    /// F⁻¹(p) for 0 ≤ p ≤ 1; the ends of the support (perhaps infinite) at 0 and 1. NaN for any other p.
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

/// What the catalogue says about a density, kept in the density's own file.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its names in files and tables; the first one is printed.
    pub names: &'static [&'static str],
    /// One sentence.
    pub summary: &'static str,
    /// Author, year, equation.
    pub reference: &'static str,
    /// What it may be told.
    pub parameters: &'static [Parameter],
    /// How it is built from checked values.
    pub build: Builder,
}

/// How a density is built from checked values.
#[derive(Clone, Copy, Debug)]
pub enum Builder {
    /// On a line.
    Line(fn(&Values) -> Result<Arc<dyn Univariate>, BuildError>),
    /// In the plane.
    Plane(fn(&Values) -> Result<Arc<dyn Bivariate>, BuildError>),
}

/// A density with all that is known about it, in the number of dimensions that it has.
#[derive(Clone)]
pub enum Truth {
    /// On a line.
    Line(Arc<dyn Univariate>),
    /// In the plane.
    Plane(Arc<dyn Bivariate>),
}

impl Truth {
    /// The density, if it is one on a line.
    pub fn line(self) -> Option<Arc<dyn Univariate>> {
        match self {
            Self::Line(density) => Some(density),
            Self::Plane(_) => None,
        }
    }

    /// The density, if it is one in the plane.
    pub fn plane(self) -> Option<Arc<dyn Bivariate>> {
        match self {
            Self::Plane(density) => Some(density),
            Self::Line(_) => None,
        }
    }
}

impl Entry {
    /// Builds it from checked values.
    ///
    /// # Errors
    /// If the values do not make a density.
    pub fn build(&self, values: &Values) -> Result<Truth, BuildError> {
        match self.build {
            Builder::Line(build) => build(values).map(Truth::Line),
            Builder::Plane(build) => build(values).map(Truth::Plane),
        }
    }

    /// 1 on a line, 2 in the plane.
    pub fn dimensions(&self) -> usize {
        match self.build {
            Builder::Line(_) => 1,
            Builder::Plane(_) => 2,
        }
    }

    /// Whether the name alone makes a density.
    pub fn stands_alone(&self) -> bool {
        self.parameters
            .iter()
            .all(|parameter| parameter.absent != Absent::Required)
    }
}

/// Every density; to add one, add a line.
pub const CATALOGUE: &[&[Entry]] = &[
    marron_wand::ENTRIES,
    mixture::ENTRIES,
    uniform::ENTRIES,
    ramp::ENTRIES,
    exponential::ENTRIES,
    truncated_exponential::ENTRIES,
    half_normal::ENTRIES,
    beta::ENTRIES,
    window::ENTRIES,
    plane::mixture::ENTRIES,
    plane::product::ENTRIES,
    plane::square::ENTRIES,
    plane::smooth::ENTRIES,
    plane::room::ENTRIES,
    plane::window::ENTRIES,
];

/// All densities in the order of the catalogue.
pub fn entries() -> impl Iterator<Item = &'static Entry> {
    CATALOGUE.iter().copied().flatten()
}

/// All names, other names of the same density included.
pub fn names() -> impl Iterator<Item = &'static str> {
    entries().flat_map(|entry| entry.names.iter().copied())
}

/// What the catalogue says about the density of that name.
pub fn entry(name: &str) -> Option<&'static Entry> {
    entries().find(|entry| entry.names.contains(&name))
}

/// The density of that name on a line with its default parameters; `None` if there is none of that name, or it needs to be told something.
pub fn named(name: &str) -> Option<Arc<dyn Univariate>> {
    truth(name)?.line()
}

/// The density of that name in the plane with its default parameters; `None` as for [`named`].
pub fn named_in_plane(name: &str) -> Option<Arc<dyn Bivariate>> {
    truth(name)?.plane()
}

/// The density of that name in either, with its default parameters.
pub fn truth(name: &str) -> Option<Truth> {
    let entry = entry(name).filter(|entry| entry.stands_alone())?;
    entry.build(&Values::defaults(entry.parameters)).ok()
}
