//! The box on which a sample and a density live, with the meaning of each of its sides.

use super::Point;

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

/// An axis-parallel box with two [`Side`]s per axis.
///
/// Always true: `low[a] < high[a]`, neither is NaN, infinite bounds are open, periodic sides come in pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain<const D: usize> {
    low: Point<D>,
    high: Point<D>,
    sides: [[Side; 2]; D],
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
        Ok(Self { low, high, sides })
    }

    /// All of space: open at infinity on every axis.
    pub fn whole() -> Self {
        Self {
            low: [f64::NEG_INFINITY; D],
            high: [f64::INFINITY; D],
            sides: [[Side::Open; 2]; D],
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
        }
    }

    /// All places with no negative coordinate: walls at 0, open at infinity.
    pub fn non_negative() -> Self {
        Self {
            low: [0.0; D],
            high: [f64::INFINITY; D],
            sides: [[Side::Wall, Side::Open]; D],
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

    /// Whether `x` is inside or on a side. A NaN coordinate is never inside.
    pub fn contains(&self, x: Point<D>) -> bool {
        (0..D).all(|axis| self.low[axis] <= x[axis] && x[axis] <= self.high[axis])
    }

    /// Whether any side stops the density.
    pub fn has_walls(&self) -> bool {
        self.sides.as_flattened().contains(&Side::Wall)
    }
}
