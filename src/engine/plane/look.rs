//! A look at a few of the data, for guesses of cost and for the size of cells: never for a result.

use crate::sample::Sample;
use crate::space::{Grid, Point};

/// How many of the data are looked at.
const LOOKED_AT: usize = 512;

fn few(sample: &Sample<2>) -> impl Iterator<Item = &Point<2>> {
    let every = sample.len().div_ceil(LOOKED_AT);
    sample.points().iter().step_by(every)
}

/// The share of the data that reach `grid` over `reach` cells.
pub(super) fn share(sample: &Sample<2>, grid: &Grid<2>, reach: [f64; 2]) -> f64 {
    let (mut seen, mut near) = (0.0, 0.0);
    for point in few(sample) {
        seen += 1.0;
        let inside = (0..2).all(|axis| {
            let margin = reach[axis] * grid.width(axis);
            point[axis] >= grid.low()[axis] - margin && point[axis] <= grid.high()[axis] + margin
        });
        near += f64::from(u8::from(inside));
    }
    near / seen
}

/// A box that holds about 98 % of the data on each axis; a point or a line if these are one.
pub(super) fn core(sample: &Sample<2>) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| {
        let mut places: Vec<f64> = few(sample).map(|point| point[axis]).collect();
        places.sort_unstable_by(f64::total_cmp);
        let beyond = places.len() / 100;
        [places[beyond], places[places.len() - 1 - beyond]]
    })
}

/// About how many of the data a box of `half` widths about a datum holds.
pub(super) fn neighbours(sample: &Sample<2>, half: [f64; 2]) -> f64 {
    let share: f64 = core(sample)
        .into_iter()
        .zip(half)
        .map(|([low, high], half)| {
            // 1.5: data are denser where data are
            (1.5 * 2.0 * half / (high - low)).min(1.0)
        })
        // 0 / 0 where all are at one place within no reach
        .map(|share| if share.is_nan() { 1.0 } else { share })
        .product();
    share * sample.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Domain;

    #[test]
    fn outliers_do_not_stretch_the_core() {
        let mut points: Vec<Point<2>> = (0..5000)
            .map(|i| {
                let t = f64::from(i);
                [(t * 0.618_034).fract(), 3.0 * (t * 0.414_214).fract()]
            })
            .collect();
        points[0] = [1e300, -1e300];
        let sample = Sample::equal(points, Domain::whole()).expect("legal");
        let [x, y] = core(&sample);
        assert!(
            x[0] < 0.05 && x[0] >= 0.0 && x[1] > 0.95 && x[1] <= 1.0,
            "{x:?}"
        );
        assert!(
            y[0] < 0.15 && y[0] >= 0.0 && y[1] > 2.85 && y[1] <= 3.0,
            "{y:?}"
        );
        let grid = Grid::new([0.0, 0.0], [0.5, 3.0], [10, 10]).expect("legal");
        assert!((share(&sample, &grid, [0.0; 2]) - 0.5).abs() < 0.1);
        let near = neighbours(&sample, [0.05, 0.15]);
        assert!(near > 50.0 && near < 200.0, "{near}");
    }
}
