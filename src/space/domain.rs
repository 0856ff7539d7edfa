//! The box on which a sample and a density live, with the meaning of each of its sides.

use super::{Point, Polygon, PolygonError};
use std::sync::Arc;

/// What happens at one side of a domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The density goes on beyond this side; the side is only the end of what is looked at. It may be at infinity.
    Open,
    /// The density stops here: no mass beyond, and an estimator that ignores this is biased near it.
    Wall,
    /// The axis wraps round: leaving here is entering at the opposite side.
    Periodic,
}

/// Why a domain cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// A bound is NaN, or low is not below high.
    #[error("a domain needs low < high on each axis; axis {axis} has {low} and {high}")]
    Empty {
        /// The axis at fault, from 0.
        axis: usize,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
    /// A wall or a periodic side at infinity.
    #[error("axis {axis}: only an open side can be at infinity")]
    InfiniteWall {
        /// The axis at fault, from 0.
        axis: usize,
    },
    /// A periodic side whose opposite is not periodic.
    #[error("axis {axis}: if one side is periodic, so is the opposite one")]
    HalfPeriodic {
        /// The axis at fault, from 0.
        axis: usize,
    },
}

/// An axis-parallel box with two [`Side`]s per axis or, in the plane, a simple polygon whose edges are walls. Cloning is cheap.
///
/// Always true: `low[a] < high[a]`, neither is NaN, infinite bounds are open, periodic sides come in pairs. With an outline the box is the
/// least one around it, and its sides are walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain<const D: usize> {
    low: Point<D>,
    high: Point<D>,
    sides: [[Side; 2]; D],
    /// Only in the plane.
    outline: Option<Arc<Polygon>>,
}

impl<const D: usize> Domain<D> {
    /// A box from `low` to `high`, `sides[axis] = [lower, upper]`.
    ///
    /// # Errors
    /// If an axis is empty, a wall is at infinity, or a periodic side has no partner.
    pub fn new(low: Point<D>, high: Point<D>, sides: [[Side; 2]; D]) -> Result<Self, DomainError> {
        for axis in 0..D {
            let (l, h) = (low[axis], high[axis]);
            if l.is_nan() || h.is_nan() || l >= h {
                return Err(DomainError::Empty {
                    axis,
                    low: l,
                    high: h,
                });
            }
            let [lower, upper] = sides[axis];
            if (l.is_infinite() && lower != Side::Open) || (h.is_infinite() && upper != Side::Open)
            {
                return Err(DomainError::InfiniteWall { axis });
            }
            if (lower == Side::Periodic) != (upper == Side::Periodic) {
                return Err(DomainError::HalfPeriodic { axis });
            }
        }
        Ok(Self {
            low,
            high,
            sides,
            outline: None,
        })
    }

    /// All of space: open at infinity on every axis.
    pub fn whole() -> Self {
        Self {
            low: [f64::NEG_INFINITY; D],
            high: [f64::INFINITY; D],
            sides: [[Side::Open; 2]; D],
            outline: None,
        }
    }

    /// A finite box with walls all round.
    ///
    /// # Errors
    /// If an axis is empty or infinite.
    pub fn walled(low: Point<D>, high: Point<D>) -> Result<Self, DomainError> {
        Self::new(low, high, [[Side::Wall; 2]; D])
    }

    /// The unit interval, square, ... with walls all round.
    pub fn unit() -> Self {
        Self {
            low: [0.0; D],
            high: [1.0; D],
            sides: [[Side::Wall; 2]; D],
            outline: None,
        }
    }

    /// All places with no negative coordinate: walls at 0, open at infinity.
    pub fn non_negative() -> Self {
        Self {
            low: [0.0; D],
            high: [f64::INFINITY; D],
            sides: [[Side::Wall, Side::Open]; D],
            outline: None,
        }
    }

    /// The lower corner.
    pub fn low(&self) -> Point<D> {
        self.low
    }

    /// The upper corner.
    pub fn high(&self) -> Point<D> {
        self.high
    }

    /// The two sides of each axis, lower first.
    pub fn sides(&self) -> [[Side; 2]; D] {
        self.sides
    }

    /// Whether `x` is inside or on a side, exactly. A NaN coordinate is never inside. O(1); O(vertices) with an outline.
    #[inline]
    pub fn contains(&self, x: Point<D>) -> bool {
        // asked of every datum: a loop without branches over the axes
        let mut inside = true;
        for axis in 0..D {
            inside &= self.low[axis] <= x[axis];
            inside &= x[axis] <= self.high[axis];
        }
        inside
            && match (&self.outline, &x[..]) {
                (Some(outline), &[x, y]) => outline.contains([x, y]),
                _ => true,
            }
    }

    /// The inside of `outline` with walls all round; `None` but in the plane.
    pub fn bounded(outline: Polygon) -> Option<Self> {
        let (low, high) = outline.bounds();
        Some(Self {
            low: low[..].try_into().ok()?,
            high: high[..].try_into().ok()?,
            sides: [[Side::Wall; 2]; D],
            outline: Some(Arc::new(outline)),
        })
    }

    /// The polygon that bounds the domain, where it is not a box.
    pub fn outline(&self) -> Option<&Polygon> {
        self.outline.as_deref()
    }

    /// Length, area, ...; infinite if a side is.
    pub fn measure(&self) -> f64 {
        match &self.outline {
            Some(outline) => outline.area(),
            None => (0..D)
                .map(|axis| self.high[axis] - self.low[axis])
                .product(),
        }
    }

    /// The cells of `grid` whose centres lie in the polygon, where there is one: integrals and pictures of something on this domain leave
    /// the others out. A sum over them is off from the integral over the polygon by at most perimeter × half the diagonal of a cell ×
    /// the largest integrand, beside the error of the midpoint rule. O(cells × vertices).
    pub fn mask(&self, grid: &super::Grid<D>) -> Option<Vec<bool>> {
        self.outline
            .is_some()
            .then(|| grid.centres().map(|x| self.contains(x)).collect())
    }

    /// Whether any axis wraps round.
    pub fn wraps(&self) -> bool {
        self.sides.as_flattened().contains(&Side::Periodic)
    }

    /// Whether any side stops the density.
    pub fn has_walls(&self) -> bool {
        self.sides.as_flattened().contains(&Side::Wall)
    }
}

impl Domain<2> {
    /// The inside of a simple polygon with walls all round; the vertices in either sense.
    ///
    /// # Errors
    /// If the vertices are not those of a simple polygon.
    pub fn polygon(vertices: Vec<Point<2>>) -> Result<Self, PolygonError> {
        Polygon::new(vertices).map(Self::inside)
    }

    /// The inside of `outline` with walls all round.
    pub fn inside(outline: Polygon) -> Self {
        Self::bounded(outline).unwrap_or_else(|| unreachable!("a plane has two axes"))
    }
}
