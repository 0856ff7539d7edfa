//! Putting the data of the plane in order, so that what is near in the plane is near in memory and threads need not share.
//!
//! The plane is cut into bands of cells. A first counting sort, over pieces of [`PIECE`] data that fit into the second-level cache, puts each piece in the order of
//! its bands; a second one, where it is wanted, puts a band in the order of its cells. Both are stable, so the order of the data within a cell is that of the sample, for any
//! number of threads. Two moves of each datum, about 10 ns.

use crate::sample::{Sample, Weights};
use crate::space::Point;
use rayon::prelude::*;
use std::ops::Range;

/// Data in one piece.
const PIECE: usize = 1 << 16;

/// Data ordered at one go, which bounds the memory beside the data to about 40 MiB.
pub(super) const RUSH: usize = 1 << 20;

/// The key of data that nobody needs.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Bands of cells: keys below `bands × cells` are `band × cells + cell`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bands {
    /// How many.
    pub bands: usize,
    /// Cells in each.
    pub cells: usize,
}

/// Columns of data in some order.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// Empty if all weights are equal.
    pub weight: Vec<f64>,
    /// Empty if there is one width for all.
    pub width: Vec<f64>,
    cell: Vec<u32>,
}

/// Some of them.
#[derive(Clone, Copy)]
pub(super) struct Slices<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    pub weight: Option<&'a [f64]>,
    pub width: Option<&'a [f64]>,
}

impl Slices<'_> {
    /// The first `count`, or all if they are fewer, and the others.
    pub(super) fn split_at(self, count: usize) -> (Self, Self) {
        let count = count.min(self.x.len());
        let (x, later_x) = self.x.split_at(count);
        let (y, later_y) = self.y.split_at(count);
        let weight = self.weight.map(|w| w.split_at(count));
        let width = self.width.map(|h| h.split_at(count));
        let now = Self {
            x,
            y,
            weight: weight.map(|w| w.0),
            width: width.map(|h| h.0),
        };
        let later = Self {
            x: later_x,
            y: later_y,
            weight: weight.map(|w| w.1),
            width: width.map(|h| h.1),
        };
        (now, later)
    }
}

impl Columns {
    pub(super) fn range(&self, range: Range<usize>) -> Slices<'_> {
        let some = |column: &'_ Vec<f64>| (!column.is_empty()).then_some(());
        Slices {
            x: &self.x[range.clone()],
            y: &self.y[range.clone()],
            weight: some(&self.weight).map(|()| &self.weight[range.clone()]),
            width: some(&self.width).map(|()| &self.width[range]),
        }
    }

    fn with_length(length: usize, weights: bool, widths: bool) -> Self {
        Self {
            x: vec![0.0; length],
            y: vec![0.0; length],
            weight: vec![0.0; if weights { length } else { 0 }],
            width: vec![0.0; if widths { length } else { 0 }],
            cell: vec![0; length],
        }
    }
}

/// One piece in the order of its bands.
pub(super) struct Piece {
    columns: Columns,
    /// Where each band starts, and the end.
    start: Vec<u32>,
}

impl Piece {
    /// The data of the bands in `range`.
    pub(super) fn bands(&self, range: Range<usize>) -> Slices<'_> {
        let ends = self.start[range.start] as usize..self.start[range.end] as usize;
        self.columns.range(ends)
    }
}

/// What is to be put in order: points, weights if they differ, widths if they differ.
#[derive(Clone, Copy)]
pub(super) struct Data<'a> {
    pub points: &'a [Point<2>],
    pub weights: Option<&'a [f64]>,
    pub widths: Option<&'a [f64]>,
}

impl<'a> Data<'a> {
    /// All of `sample`, with a width for each point or none.
    pub(super) fn of(sample: &'a Sample<2>, widths: Option<&'a [f64]>) -> Self {
        Self {
            points: sample.points(),
            weights: match sample.weights() {
                Weights::Equal(_) => None,
                Weights::Each(weights) => Some(weights),
            },
            widths,
        }
    }

    /// The data in ranges of at most `length`, in order.
    pub(super) fn chunks(self, length: usize) -> impl Iterator<Item = Self> {
        (0..self.points.len()).step_by(length).map(move |start| {
            let range = start..(start + length).min(self.points.len());
            Self {
                points: &self.points[range.clone()],
                weights: self.weights.map(|w| &w[range.clone()]),
                widths: self.widths.map(|h| &h[range]),
            }
        })
    }
}

/// The data in pieces, each in the order of its bands. `key` tells where a datum belongs from its place and its width (0 where there is one for all);
/// data with the key [`NOWHERE`] are left out.
pub(super) fn pieces(
    data: Data<'_>,
    bands: Bands,
    key: impl Fn(Point<2>, f64) -> u32 + Sync,
) -> Vec<Piece> {
    let parts: Vec<Data<'_>> = data.chunks(PIECE).collect();
    parts
        .into_par_iter()
        .map(|part| piece(part, bands, &key))
        .collect()
}

fn piece(data: Data<'_>, bands: Bands, key: &(impl Fn(Point<2>, f64) -> u32 + Sync)) -> Piece {
    let cells = bands.cells as u32;
    let keys: Vec<u32> = data
        .points
        .iter()
        .enumerate()
        .map(|(i, point)| key(*point, data.widths.map_or(0.0, |h| h[i])))
        .collect();
    // data that nobody needs go to a last band, which is cut off
    let band = |key: u32| ((key / cells) as usize).min(bands.bands);
    let mut start = vec![0_u32; bands.bands + 2];
    for &key in &keys {
        start[band(key) + 1] += 1;
    }
    for b in 0..=bands.bands {
        start[b + 1] += start[b];
    }
    let kept = start[bands.bands] as usize;
    let mut columns = Columns::with_length(kept, data.weights.is_some(), data.widths.is_some());
    let mut next = start.clone();
    for (i, &key) in keys.iter().enumerate() {
        let band = band(key);
        if band == bands.bands {
            continue;
        }
        let place = next[band] as usize;
        next[band] += 1;
        let [x, y] = data.points[i];
        columns.x[place] = x;
        columns.y[place] = y;
        columns.cell[place] = key - band as u32 * cells;
        if let Some(weights) = data.weights {
            columns.weight[place] = weights[i];
        }
        if let Some(widths) = data.widths {
            columns.width[place] = widths[i];
        }
    }
    start.truncate(bands.bands + 1);
    Piece { columns, start }
}

/// Data in the order of their cells.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    pub columns: Columns,
    /// Where each cell starts, and the end.
    pub start: Vec<u32>,
}

impl Cells {
    /// The data of the cells in `range`.
    pub(super) fn range(&self, range: Range<usize>) -> Slices<'_> {
        let ends = self.start[range.start] as usize..self.start[range.end] as usize;
        self.columns.range(ends)
    }
}

/// One band of all pieces, in the order of its cells.
pub(super) fn cells(pieces: &[Piece], bands: Bands, band: usize) -> Cells {
    let ranges = |piece: &Piece| piece.start[band] as usize..piece.start[band + 1] as usize;
    let mut start = vec![0_u32; bands.cells + 1];
    for piece in pieces {
        for &cell in &piece.columns.cell[ranges(piece)] {
            start[cell as usize + 1] += 1;
        }
    }
    for c in 0..bands.cells {
        start[c + 1] += start[c];
    }
    let some = |column: fn(&Columns) -> &Vec<f64>| {
        pieces
            .iter()
            .any(|piece| !column(&piece.columns).is_empty())
    };
    let mut columns = Columns::with_length(
        start[bands.cells] as usize,
        some(|c| &c.weight),
        some(|c| &c.width),
    );
    columns.cell = Vec::new();
    let mut next = start.clone();
    for piece in pieces {
        let from = &piece.columns;
        for i in ranges(piece) {
            let cell = from.cell[i] as usize;
            let place = next[cell] as usize;
            next[cell] += 1;
            columns.x[place] = from.x[i];
            columns.y[place] = from.y[i];
            if let Some(&weight) = from.weight.get(i) {
                columns.weight[place] = weight;
            }
            if let Some(&width) = from.width.get(i) {
                columns.width[place] = width;
            }
        }
    }
    Cells { columns, start }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    #[test]
    fn every_datum_is_in_its_cell_once_and_in_order() {
        let points: Vec<Point<2>> = (0..200_000)
            .map(|i| {
                let t = f64::from(i);
                [
                    (t * 0.618_034).fract() * 10.0 - 1.0,
                    (t * 0.414_214).fract(),
                ]
            })
            .collect();
        let weights: Vec<f64> = (0..points.len()).map(|i| i as f64).collect();
        let bands = Bands { bands: 8, cells: 5 };
        let key = |[x, y]: Point<2>, _: f64| {
            if (0.0..8.0).contains(&x) {
                x as u32 * 5 + (y * 5.0) as u32
            } else {
                NOWHERE
            }
        };
        let data = Data {
            points: &points,
            weights: Some(&weights),
            widths: None,
        };
        let pieces = pieces(data, bands, key);
        let mut seen = 0;
        for band in 0..8 {
            let cells = cells(&pieces, bands, band);
            for cell in 0..5 {
                let all = cells.range(cell..cell + 1);
                seen += all.x.len();
                let order = all.weight.expect("weights");
                assert!(order.windows(2).all(|pair| pair[0] < pair[1]));
                for ((x, y), i) in all.x.iter().zip(all.y).zip(order) {
                    assert_eq!(points[*i as usize], [*x, *y]);
                    assert_eq!(key([*x, *y], 0.0), (band * 5 + cell) as u32);
                }
            }
        }
        let expected = points.iter().filter(|p| key(**p, 0.0) != NOWHERE).count();
        assert_eq!(seen, expected);
    }
}
