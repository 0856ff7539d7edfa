//! How many modes a sampled function has, in any number of dimensions.

use super::Raster;
use super::modes::for_each_top;

/// The number of modes of `raster`: on a line those of [`modes`](super::modes()), in the plane the summits with a prominence of more than `tolerance` times the
/// highest value. Cells are neighbours if they share an edge or a corner.
///
/// The prominence of a summit is how far one must go down from it to reach higher ground; that of the highest is its height. A plateau is one summit,
/// and so are summits with a shallower pass between them. No summits if no value is positive. O(cells log cells).
pub fn mode_count<const D: usize>(raster: &Raster<D>, tolerance: f64) -> usize {
    match raster.grid().cells()[..] {
        [_] => {
            let mut many = 0;
            for_each_top(raster.values(), tolerance, |_, _, _| many += 1);
            many
        }
        [rows, columns] => summits(raster.values(), [rows, columns], tolerance),
        _ => 0,
    }
}

/// Floods from above: cells in falling order of value join the parts that they touch; where two parts meet the lower summit ends, and counts if it rose
/// high enough above the pass.
fn summits(values: &[f64], [rows, columns]: [usize; 2], tolerance: f64) -> usize {
    const DRY: usize = usize::MAX;
    let peak = values.iter().copied().fold(0.0, f64::max);
    if peak <= 0.0 {
        return 0;
    }
    let rise = tolerance * peak;
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]).then(a.cmp(&b)));
    // each flooded cell leads to its part's summit
    let mut leader = vec![DRY; values.len()];
    let mut count = 1;
    for cell in order {
        leader[cell] = cell;
        let (row, column) = (cell / columns, cell % columns);
        for r in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
            for c in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let other = r * columns + c;
                if leader[other] == DRY {
                    continue;
                }
                let (a, b) = (find(&mut leader, cell), find(&mut leader, other));
                if a == b {
                    continue;
                }
                let (higher, lower) = if values[a] >= values[b] {
                    (a, b)
                } else {
                    (b, a)
                };
                count += usize::from(values[lower] - values[cell] > rise);
                leader[lower] = higher;
            }
        }
    }
    count
}

fn find(leader: &mut [usize], cell: usize) -> usize {
    let mut top = cell;
    while leader[top] != top {
        // halving the path keeps paths short
        leader[top] = leader[leader[top]];
        top = leader[top];
    }
    top
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::special::normal_density;
    use crate::space::Grid;
    use crate::space::RIPPLE;

    fn count(f: impl Fn(f64, f64) -> f64) -> usize {
        let grid = Grid::new([-3.0, -3.0], [3.0, 3.0], [60, 80]).expect("legal");
        let values = grid.centres().map(|[x, y]| f(x, y)).collect();
        mode_count(&Raster::new(grid, values), RIPPLE)
    }

    #[test]
    fn summits_are_counted_and_passes_are_not() {
        let hump = |x: f64, y: f64| normal_density(x) * normal_density(y);
        assert_eq!(count(hump), 1);
        assert_eq!(
            count(|x, y| hump(3.0 * x - 3.0, y) + hump(3.0 * x + 3.0, 2.0 * y)),
            2
        );
        assert_eq!(
            count(|x, y| {
                let four = |a: f64, b: f64| hump(4.0 * (x - a), 4.0 * (y - b));
                four(1.5, 1.5) + four(-1.5, 1.5) + four(1.5, -1.5) + four(-1.5, -1.5)
            }),
            4
        );
        // a ring is one summit, a plateau too, and so is a slope up to a wall
        assert_eq!(
            count(|x, y| (2.0 * normal_density(8.0 * (x.hypot(y) - 2.0))).round()),
            1
        );
        assert_eq!(count(|_, _| 1.0), 1);
        assert_eq!(count(|x, y| 9.0 + x + 2.0 * y), 1);
        assert_eq!(count(|_, _| 0.0), 0);
        // ripples of rounding
        assert_eq!(
            count(|x, y| hump(x, y) + 1e-14 * (37.0 * x).sin() * (41.0 * y).sin()),
            1
        );
    }

    #[test]
    fn on_a_line_they_are_the_modes() {
        let grid = Grid::new([0.0], [7.0], [7]).expect("legal");
        let raster = Raster::new(grid, vec![0.0, 1.0, 0.5, 2.0, 2.0, 0.0, 1.0]);
        assert_eq!(mode_count(&raster, RIPPLE), 3);
    }
}
