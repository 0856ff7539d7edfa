//! Exponents of cost, on counted operations: wall time on a shared machine is noise.

use density_lab::neighbour::{Cells, Scratch, Sorted, Work};
use density_lab::random::{open_unit, stream};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Grid, Point, SummedArea};
use std::cell::Cell;

const SIZES: [usize; 3] = [10_000, 100_000, 1_000_000];

fn points<const D: usize>(n: usize, number: u64) -> Vec<Point<D>> {
    let mut random = stream(56, "complexity", number);
    (0..n)
        .map(|_| [(); D].map(|()| open_unit(&mut random)))
        .collect()
}

/// The slope of a line through (ln n, ln work).
fn slope(work: &[(usize, f64)]) -> f64 {
    let n = work.len() as f64;
    let logs: Vec<(f64, f64)> = work
        .iter()
        .map(|(n, w)| ((*n as f64).ln(), w.ln()))
        .collect();
    let mean = |pick: fn(&(f64, f64)) -> f64| logs.iter().map(pick).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (mut over, mut under) = (0.0, 0.0);
    for (a, b) in &logs {
        over += (a - x) * (b - y);
        under += (a - x) * (a - x);
    }
    over / under
}

/// On the line the k-th neighbour takes two binary searches: visits over log₂ n stay the same within 15 % from 10⁴ to 10⁶ points.
#[test]
fn a_neighbour_on_the_line_costs_a_logarithm() {
    let targets = points::<1>(200, 1);
    let visits: Vec<(usize, f64)> = SIZES
        .into_iter()
        .map(|n| {
            let sorted = Sorted::new(&Sample::equal(points(n, 2), Domain::unit()).expect("legal"));
            let (mut work, mut scratch) = (Work::default(), Scratch::default());
            for &x in &targets {
                sorted.distance_counted(x, 50, &mut scratch, &mut work);
            }
            (n, work.total() as f64 / targets.len() as f64)
        })
        .collect();
    let ratios: Vec<f64> = visits.iter().map(|(n, v)| v / (*n as f64).log2()).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!(
        ratios.iter().all(|r| (r / mean - 1.0).abs() < 0.15),
        "{visits:?} {ratios:?}"
    );
    // the planted fault: work that grows like a small power of n is seen
    let grown: Vec<f64> = visits
        .iter()
        .map(|(n, v)| v * (*n as f64 / 1e4).powf(0.1) / (*n as f64).log2())
        .collect();
    let mean = grown.iter().sum::<f64>() / grown.len() as f64;
    assert!(
        grown.iter().any(|r| (r / mean - 1.0).abs() > 0.15),
        "{grown:?}"
    );
}

/// In the plane a bucket grid does better than the lecture's tree: what a query takes does not grow with n at all, and grows as √k with k.
#[test]
fn a_neighbour_in_the_plane_costs_the_same_for_any_n() {
    // away from the sides, where discs are cut
    let targets: Vec<Point<2>> = points::<2>(400, 3)
        .into_iter()
        .map(|x| x.map(|x| 0.25 + 0.5 * x))
        .collect();
    let visits = |n: usize, k: usize| {
        let sample = Sample::equal(points(n, 4), Domain::unit()).expect("legal");
        let cells = Cells::new(&sample).expect("evenly spread");
        let (mut work, mut scratch) = (Work::default(), Scratch::default());
        for &x in &targets {
            cells.distance_counted(x, k, &mut scratch, &mut work);
        }
        work.total() as f64 / targets.len() as f64
    };
    let over_n: Vec<(usize, f64)> = SIZES.into_iter().map(|n| (n, visits(n, 50))).collect();
    assert!(slope(&over_n).abs() < 0.02, "{over_n:?}");
    let over_k: Vec<(usize, f64)> = [100, 400, 1600].map(|k| (k, visits(100_000, k))).to_vec();
    assert!((slope(&over_k) - 0.5).abs() < 0.1, "{over_k:?}");
}

/// A histogram touches each datum once.
#[test]
fn a_histogram_costs_its_points() {
    let grid = Grid::new([0.0; 2], [1.0; 2], [64; 2]).expect("legal");
    for n in SIZES {
        let count = Cell::new(0usize);
        let weight = |_: usize| {
            count.set(count.get() + 1);
            1.0
        };
        let table = SummedArea::of_points(grid, &points::<2>(n, 5), weight);
        assert_eq!(count.get(), n);
        assert_eq!(table.total().to_bits(), (n as f64).to_bits());
    }
}
