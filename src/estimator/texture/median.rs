//! A median filter.

use crate::space::Raster;
use rayon::prelude::*;

/// The median over the window of 2 `half` + 1 cells a side about each cell, as far as there are cells; of an even number the lower one. Removes what is alone, and keeps edges.
/// O(cells × half²).
pub(super) fn filter(raster: &Raster<2>, half: usize) -> Raster<2> {
    if half == 0 {
        return raster.clone();
    }
    let grid = *raster.grid();
    let [rows, columns] = grid.cells();
    let values = raster.values();
    let row_of = |row: usize| -> Vec<f64> {
        let mut window = Vec::with_capacity((2 * half + 1).pow(2));
        (0..columns)
            .map(|column| {
                window.clear();
                for i in row.saturating_sub(half)..(row + half + 1).min(rows) {
                    let (from, to) = (
                        column.saturating_sub(half),
                        (column + half + 1).min(columns),
                    );
                    window.extend_from_slice(&values[i * columns + from..i * columns + to]);
                }
                let middle = (window.len() - 1) / 2;
                *window.select_nth_unstable_by(middle, f64::total_cmp).1
            })
            .collect()
    };
    let filtered: Vec<Vec<f64>> = (0..rows).into_par_iter().map(row_of).collect();
    Raster::new(grid, filtered.concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Grid;

    #[test]
    fn one_outlier_goes_and_an_edge_stays() {
        let grid = Grid::new([0.0; 2], [1.0; 2], [9, 8]).expect("legal");
        let edge = |i: usize| if i % 8 < 4 { 1.0 } else { 5.0 };
        let clean: Vec<f64> = (0..72).map(edge).collect();
        let mut spoilt = clean.clone();
        spoilt[4 * 8 + 1] = 1e9;
        spoilt[4 * 8 + 6] = -1e9;
        spoilt[0] = 1e9;
        let filtered = filter(&Raster::new(grid, spoilt.clone()), 1);
        assert_eq!(filtered.values(), clean);
        assert_eq!(
            filter(&Raster::new(grid, spoilt.clone()), 0).values(),
            spoilt
        );
    }
}
