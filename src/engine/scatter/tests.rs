#![allow(clippy::unwrap_used)]

use super::*;
use crate::sample::Sample;
use crate::space::Grid;

/// Data with widths from a thousandth to a hundred times the usual, weights, ties and coarse numbers far from zero.
fn sums(shape: Shape, offset: f64) -> KernelSum<1> {
    let n = 3000;
    let points = (0..n)
        .map(|i| {
            let x = (f64::from(i) * 0.618).fract() * 4.0 - 2.0;
            [if i % 5 == 0 {
                (x * 8.0).round() / 8.0
            } else {
                x
            } + offset]
        })
        .collect();
    let weights = (0..n).map(|i| f64::from(i % 4)).collect();
    let widths: Vec<f64> = (0..n)
        .map(|i| match i % 50 {
            0 => 30.0,
            1 => 3e-4,
            k => 0.02 * f64::from(k),
        })
        .collect();
    let sample = Sample::normalised(points, weights, Domain::whole()).unwrap();
    KernelSum::new(sample, shape, Bandwidth::PerPoint(widths.into())).unwrap()
}

#[test]
fn bumps_of_all_widths_sum_to_the_definition() {
    for shape in Shape::ALL {
        for offset in [0.0, 1e9] {
            let sum = sums(shape, offset);
            let Bandwidth::PerPoint(widths) = sum.bandwidth() else {
                unreachable!("made so")
            };
            // all points at one place
            let ceiling: f64 = (0..widths.len())
                .map(|i| sum.sample().weight(i) * shape.peak() / widths[i])
                .sum();
            let field = Scatter.prepare(sum.clone(), 0.0).unwrap();
            for cells in [1, 15, 16, 17, 100, 513, 2000] {
                let grid = Grid::new([offset - 3.0], [offset + 2.5], [cells]).unwrap();
                let mut scattered: Vec<Point<1>> = grid.centres().collect();
                scattered.reverse();
                scattered.push([offset + 0.125]);
                scattered.push([offset + 1e6]);
                for targets in [Targets::Grid(&grid), Targets::Points(&scattered)] {
                    let found = field.evaluate(targets);
                    assert!(found.error <= crate::engine::EXACT);
                    for (x, value) in targets.places().zip(&found.values) {
                        let exact = sum.at(x);
                        assert!(
                            (value - exact).abs() <= found.error * ceiling,
                            "{shape}, {cells} cells, at {x:?}: {value} {exact}"
                        );
                        if exact == 0.0 {
                            assert!(value.abs() <= 3e-18 * ceiling, "{shape} at {x:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let grid = Grid::new([-3.0], [3.0], [777]).unwrap();
    for shape in [Shape::Biweight, Shape::Gaussian] {
        let bits = |threads: usize| -> Vec<u64> {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let field = Scatter.prepare(sums(shape, 0.0), 0.0).unwrap();
                let found = field.evaluate(Targets::Grid(&grid));
                found.values.iter().map(|v| v.to_bits()).collect()
            })
        };
        assert_eq!(bits(1), bits(3));
    }
}
