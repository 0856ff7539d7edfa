//! What engines are judged on: clusters, ties, walls, offsets, weights and widths that break sums.

use density_lab::random::stream;
use density_lab::space::{Grid, Point};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

#[derive(Clone)]
pub struct Case {
    pub name: &'static str,
    pub points: Vec<Point<2>>,
    pub weights: Option<Vec<f64>>,
    pub h: [f64; 2],
    pub grid: Grid<2>,
    pub scattered: Vec<Point<2>>,
}

pub fn normal(n: usize, number: u64) -> Vec<Point<2>> {
    let mut random = stream(1, "plane laws", number);
    (0..n)
        .map(|_| [0; 2].map(|_| StandardNormal.sample(&mut random)))
        .collect()
}

fn moved(points: &[Point<2>], scale: [f64; 2], by: [f64; 2]) -> Vec<Point<2>> {
    points
        .iter()
        .map(|x| [0, 1].map(|axis| x[axis] * scale[axis] + by[axis]))
        .collect()
}

#[allow(clippy::too_many_lines)] // a table
pub fn cases() -> Vec<Case> {
    let case =
        |name, points: Vec<Point<2>>, h, (low, high, cells): ([f64; 2], [f64; 2], [usize; 2])| {
            Case {
                name,
                points,
                weights: None,
                h,
                grid: Grid::new(low, high, cells).unwrap(),
                scattered: Vec::new(),
            }
        };
    let usual = ([-4.0, -4.0], [4.0, 4.0], [32, 27]);
    let n = 800;
    let far = 1e9;
    let lattice = |step: f64| -> Vec<Point<2>> {
        (0..1600)
            .map(|i| [f64::from(i % 40), f64::from(i / 40)].map(|k| k * step))
            .collect()
    };
    let mut all = vec![
        case("normal", normal(n, 0), [0.5, 0.5], usual),
        case("stretched", normal(n, 1), [0.9, 0.3], usual),
        case(
            "cells that are not square",
            normal(n, 2),
            [0.4, 0.4],
            ([-4.0, -1.0], [4.0, 2.0], [9, 70]),
        ),
        case("narrower than a cell", normal(n, 3), [0.02, 0.03], usual),
        case("about a cell", normal(n, 4), [0.2, 0.25], usual),
        case(
            "wider than the grid",
            normal(n, 5),
            [30.0, 20.0],
            ([-1.0, -1.0], [1.5, 1.0], [21, 20]),
        ),
        case(
            "half the grid",
            normal(n, 6),
            [1.25, 1.0],
            ([-1.0, -1.0], [1.5, 1.0], [21, 20]),
        ),
        case(
            "one cell",
            normal(n, 7),
            [0.5, 0.5],
            ([0.0, 0.0], [1.0, 1.0], [1, 1]),
        ),
        case(
            "one row",
            normal(n, 8),
            [0.5, 0.2],
            ([-3.0, -0.1], [3.0, 0.1], [1, 60]),
        ),
        case(
            "one column",
            normal(n, 9),
            [0.5, 0.2],
            ([-3.0, -0.1], [3.0, 0.1], [60, 1]),
        ),
        case(
            "one point",
            vec![[0.3, -0.1]],
            [0.4, 0.7],
            ([-1.0, -1.0], [1.0, 1.0], [23, 19]),
        ),
        case(
            "identical",
            vec![[0.123_456_789, -0.3]; 9000],
            [0.4, 0.5],
            ([-1.0, -1.0], [1.0, 1.0], [23, 19]),
        ),
        case(
            "on a line",
            moved(&normal(n, 10), [1.0, 0.0], [0.0, 0.5]),
            [0.3, 0.3],
            usual,
        ),
        case(
            "identical, far",
            vec![[far + 0.1, -far]; 9000],
            [0.4, 0.5],
            ([far - 1.0, -far - 1.0], [far + 1.0, -far + 1.0], [23, 19]),
        ),
        case(
            "far from zero",
            moved(&normal(n, 11), [1.0; 2], [far, -far]),
            [0.5, 0.4],
            ([far - 4.0, -far - 4.0], [far + 4.0, -far + 4.0], [40, 33]),
        ),
        case(
            "far from zero, coarse numbers",
            moved(&normal(n, 12), [1.0; 2], [1e14, 0.0]),
            [0.9, 0.9],
            ([1e14 - 4.0, -4.0], [1e14 + 4.0, 4.0], [17, 23]),
        ),
        case(
            "all beyond the grid",
            normal(n, 13),
            [0.5, 0.5],
            ([50.0, 50.0], [60.0, 60.0], [20, 20]),
        ),
        case(
            "mostly beyond the grid",
            normal(n, 14),
            [0.5, 0.5],
            ([2.0, 0.0], [60.0, 1.0], [50, 20]),
        ),
        case(
            "wild outliers",
            {
                let mut points = normal(n, 15);
                points.extend([[1e12, 0.0], [0.0, -1e15], [1e300, -1e300], [-1e300, 1e300]]);
                points
            },
            [0.5, 0.5],
            usual,
        ),
        // h, cells and data in steps of 1/64: every third datum sits exactly on an edge
        case(
            "ties on edges",
            moved(&lattice(0.0625), [1.0; 2], [-1.0, -1.0]),
            [0.25, 0.125],
            ([-1.03125, -1.03125], [1.46875, 1.46875], [40, 40]),
        ),
        // the same in decimals, where rounding decides
        case(
            "decimal ties on edges",
            lattice(0.1),
            [0.3, 0.5],
            ([-0.05, -0.05], [3.95, 3.95], [40, 40]),
        ),
        // with h = 5 units the circle passes through the lattice points (3, 4), (5, 0) ...
        case(
            "decimal ties on circles",
            lattice(0.1),
            [0.5, 0.5],
            ([-0.05, -0.05], [3.95, 3.95], [40, 40]),
        ),
        case(
            "tiny scale",
            moved(&normal(n, 16), [1e-120; 2], [0.0; 2]),
            [0.5e-120, 0.4e-120],
            ([-4e-120, -4e-120], [4e-120, 4e-120], [30, 20]),
        ),
        case(
            "huge scale",
            moved(&normal(n, 17), [1e120; 2], [0.0; 2]),
            [0.5e120, 0.4e120],
            ([-4e120, -4e120], [4e120, 4e120], [30, 20]),
        ),
        case(
            "axes of different units",
            moved(&normal(n, 18), [1e-9, 1e9], [0.0; 2]),
            [0.5e-9, 0.4e9],
            ([-4e-9, -4e9], [4e-9, 4e9], [30, 20]),
        ),
        case(
            "heavy tails",
            normal(n, 19)
                .iter()
                .map(|x| x.map(|x| x / (1e-9 + x.sin().powi(2))))
                .collect(),
            [0.3, 0.3],
            usual,
        ),
    ];
    let weighted: Vec<Case> = all
        .iter()
        .enumerate()
        .map(|(number, case)| {
            let mut random = stream(2, "plane laws", number as u64);
            let weight = |_: &Point<2>| {
                if random.random_bool(0.1) {
                    0.0
                } else {
                    random.random::<f64>().powi(4) + 1e-6
                }
            };
            Case {
                weights: Some(case.points.iter().map(weight).collect()),
                ..case.clone()
            }
        })
        .collect();
    all.extend(weighted);
    for (number, case) in all.iter_mut().enumerate() {
        let mut random = stream(3, "plane laws", number as u64);
        let (low, high) = (case.grid.low(), case.grid.high());
        let mut targets: Vec<Point<2>> = (0..60)
            .map(|_| [0, 1].map(|a| low[a] + (high[a] - low[a]) * random.random::<f64>()))
            .collect();
        // at data, and at the very ends of their bumps
        let [h0, h1] = case.h;
        for &[x, y] in case.points.iter().take(20) {
            targets.extend([
                [x, y],
                [x - h0, y],
                [x + h0, y],
                [x, y + h1],
                [x + h0, y - h1],
            ]);
            targets.push([x + 0.6 * h0, y + 0.8 * h1]);
        }
        targets.extend([
            [low[0] - 1e3 * h0, low[1]],
            [f64::MAX, 0.0],
            [f64::MIN, f64::MAX],
        ]);
        case.scattered = targets;
    }
    all
}
