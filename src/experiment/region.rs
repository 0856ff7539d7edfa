//! Parts of the grid that errors are told apart by: the peak, the edge, the flat.

use crate::space::{Grid, Point};
use serde::Serialize;

/// A named part of the domain: the places that satisfy all that is said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegionSpec {
    /// What it is called in tables and claims.
    pub name: String,
    /// `[low, high]` for each axis, infinite where nothing is said.
    pub limits: Vec<[f64; 2]>,
    /// A centre, and how far from it, at least and at most.
    pub ring: Option<Ring>,
}

/// All places so far from a centre.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ring {
    /// A coordinate for each axis.
    pub centre: Vec<f64>,
    /// At least so far.
    pub from: f64,
    /// At most so far.
    pub to: f64,
}

impl RegionSpec {
    /// Whether `x` is in it, ends included.
    pub fn contains<const D: usize>(&self, x: Point<D>) -> bool {
        let inside = x
            .iter()
            .zip(&self.limits)
            .all(|(x, [low, high])| (*low..=*high).contains(x));
        let away = |ring: &Ring| {
            let squares = x.iter().zip(&ring.centre).map(|(x, c)| (x - c).powi(2));
            let distance = squares.sum::<f64>().sqrt();
            // centres of cells that are meant to be on a bound are, whatever rounding does
            let slack = 1e-9 * distance;
            (ring.from - slack..=ring.to + slack).contains(&distance)
        };
        inside && self.ring.as_ref().is_none_or(away)
    }

    /// The numbers of the cells whose centres are in it, of those that count at all.
    pub fn cells<const D: usize>(&self, grid: &Grid<D>, mask: Option<&[bool]>) -> Vec<u32> {
        grid.centres()
            .zip(0..)
            .filter(|(x, i)| self.contains(*x) && mask.is_none_or(|mask| mask[*i as usize]))
            .map(|(_, i)| i)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_and_boxes_hold_the_cells_that_they_say() {
        let grid = Grid::new([0.0; 2], [1.0; 2], [10; 2]).expect("legal");
        let ring = |from, to| RegionSpec {
            name: "ring".to_owned(),
            limits: vec![[f64::NEG_INFINITY, f64::INFINITY]; 2],
            ring: Some(Ring {
                centre: vec![0.45, 0.45],
                from,
                to,
            }),
        };
        // the cell itself, and the four beside it at exactly one width
        assert_eq!(ring(0.0, 0.01).cells(&grid, None), [44]);
        assert_eq!(ring(0.1, 0.1).cells(&grid, None), [34, 43, 45, 54]);
        let mut only = vec![false; 100];
        only[43] = true;
        assert_eq!(ring(0.0, 0.1).cells(&grid, Some(&only)), [43]);
        let mut corner = ring(0.0, 9.0);
        corner.limits = vec![[0.0, 0.1], [0.9, f64::INFINITY]];
        assert_eq!(corner.cells(&grid, None), [9]);
        let line = Grid::new([0.0], [1.0], [4]).expect("legal");
        assert_eq!(ring(0.3, 0.5).cells(&line, None), [0, 3]);
    }
}
