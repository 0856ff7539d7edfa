//! Places on a lattice over which errors are integrated.

use crate::density::Density;
use crate::numeric::Sum;
use crate::space::Grid;
use crate::theory::{Integrated, Moments};

/// At most so many places on a line, more where moments are closed forms; on each axis of the plane; and in all for what is best at each.
const LINE: usize = 1024;
const CLOSED: usize = 4096;
const ALONG: usize = 256;
const FEW: usize = 4096;

/// Centres of a grid's cells, all or every second, third ... on each axis.
pub(super) struct Lattice {
    /// The coordinates on each axis.
    pub axes: Vec<Vec<f64>>,
    /// Those on the domain: their numbers, the last axis faster, and the density there.
    pub all: Vec<(usize, f64)>,
    /// Which of these serve for what is best at each place.
    pub few: Vec<usize>,
    /// The measure of what each of all stands for.
    pub cell: f64,
}

impl Lattice {
    /// That of a grid on which the density is `known`; `None` where it is nowhere.
    pub fn of<const D: usize>(
        truth: &dyn Density<D>,
        grid: &Grid<D>,
        known: &[f64],
        closed: bool,
    ) -> Option<Self> {
        let every = |cells: usize, most: usize| -> Vec<usize> {
            let step = cells.div_ceil(most).max(1);
            (0..cells).filter(|i| i % step == step / 2).collect()
        };
        let along = match D {
            1 if closed => CLOSED,
            1 => LINE,
            _ => ALONG,
        };
        let side = if D == 1 { FEW } else { FEW.isqrt() };
        let chosen = grid.cells().map(|cells| every(cells, along));
        let sparse: Vec<Vec<usize>> = chosen.iter().map(|all| every(all.len(), side)).collect();
        let (mut all, mut few) = (Vec::new(), Vec::new());
        let places: usize = chosen.iter().map(Vec::len).product();
        for number in 0..places {
            let (mut rest, mut at, mut stride, mut is_few) = (number, 0, 1, true);
            for axis in (0..D).rev() {
                let i = rest % chosen[axis].len();
                rest /= chosen[axis].len();
                at += stride * chosen[axis][i];
                stride *= grid.cells()[axis];
                is_few &= sparse[axis].binary_search(&i).is_ok();
            }
            if truth.domain().contains(grid.centre(at)) {
                if is_few {
                    few.push(all.len());
                }
                all.push((number, known[at]));
            }
        }
        // a domain may be so narrow that it slips through
        if few.is_empty() {
            few = (0..all.len()).collect();
        }
        let axes = chosen.iter().enumerate();
        let axes = axes.map(|(axis, chosen)| {
            let coordinates = chosen.iter().map(|&i| grid.coordinate(axis, i));
            coordinates.collect()
        });
        (!all.is_empty()).then(|| Self {
            axes: axes.collect(),
            cell: grid.cell_measure() * grid.len() as f64 / places as f64,
            all,
            few,
        })
    }

    /// The errors over all places of an estimate with these moments on the whole lattice.
    pub fn integrated(&self, moments: &[Moments]) -> Integrated {
        let bias: Sum = (self.all.iter())
            .map(|&(i, truth)| (moments[i].mean - truth).powi(2))
            .collect();
        let variance: Sum = self.all.iter().map(|&(i, _)| moments[i].variance).collect();
        Integrated {
            squared_bias: bias.value() * self.cell,
            variance: variance.value() * self.cell,
        }
    }
}
