//! What estimators are tried on: data of several kinds, with and without walls.

use density_lab::experiment::settings::WINDOW;
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Point, Polygon};
use proptest::collection::vec;
use proptest::prelude::*;

/// A data set with places to look at.
#[derive(Clone, Debug)]
pub struct Data<const D: usize> {
    pub points: Vec<Point<D>>,
    /// Whole numbers from 1.
    pub weights: Vec<u32>,
    pub targets: Vec<Point<D>>,
    /// Something to choose by.
    pub choice: usize,
    pub domain: Domain<D>,
}

/// What data a law is tried on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// At least three points in general position.
    General,
    /// From one point on, also tied, on lattices that share places with the edges of bins, and in clusters.
    Any,
    /// One point, or several at one place.
    OnePlace,
}

/// Where the domain may end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walls {
    /// Nowhere.
    None,
    /// At the sides of a box, or nowhere.
    Boxes,
    /// Also at the edges of polygons.
    Polygons,
}

/// A number with 20 binary digits after the point, so that adding 10⁹ or multiplying by a power of two is exact.
fn place(low: f64, high: f64) -> impl Strategy<Value = f64> {
    let unit = f64::from(1 << 20);
    ((low * unit) as i64..(high * unit) as i64).prop_map(move |k| k as f64 / unit)
}

/// As many of two numbers as there are axes.
fn point<const D: usize>((x, y): (f64, f64)) -> Point<D> {
    std::array::from_fn(|axis| if axis == 0 { x } else { y })
}

/// An L and a triangle, with few binary digits.
fn polygon<const D: usize>(choice: usize) -> Option<Domain<D>> {
    let vertices = if choice.is_multiple_of(2) {
        vec![
            [-2.5, -2.5],
            [2.5, -2.5],
            [2.5, 0.25],
            [0.25, 0.25],
            [0.25, 2.5],
            [-2.5, 2.5],
        ]
    } else {
        vec![[-2.5, -2.5], [2.75, -2.5], [-2.5, 2.25]]
    };
    Domain::bounded(Polygon::new(vertices).unwrap())
}

fn domain<const D: usize>(walls: Walls, choice: usize) -> Domain<D> {
    let boxed = || Domain::walled([WINDOW[0]; D], [WINDOW[1]; D]).unwrap();
    match (walls, choice % 5) {
        (Walls::None, _) | (_, 0 | 1) => Domain::whole(),
        (Walls::Polygons, 4) if D == 2 => polygon(choice / 5).unwrap(),
        _ => boxed(),
    }
}

/// Puts what lies outside the domain inside, exactly: mirrored at the sides of a box; what is outside a polygon is left out.
fn inside<const D: usize>(domain: &Domain<D>, mut points: Vec<Point<D>>) -> Vec<Point<D>> {
    let (low, high) = (domain.low(), domain.high());
    for axis in 0..D {
        for x in &mut points {
            for _ in 0..4 {
                if x[axis] < low[axis] {
                    x[axis] = 2.0 * low[axis] - x[axis];
                }
                if x[axis] > high[axis] {
                    x[axis] = 2.0 * high[axis] - x[axis];
                }
            }
            x[axis] = x[axis].clamp(low[axis], high[axis]);
        }
    }
    if let Some(outline) = domain.outline() {
        // not so near an edge that another unit may put it on the other side
        points.retain(|x| domain.contains(*x) && outline.distance([x[0], x[D - 1]]) > 1e-3);
    }
    points
}

pub fn data<const D: usize>(sort: Sort, walls: Walls) -> BoxedStrategy<Data<D>> {
    let pair = |low: f64, high: f64| (place(low, high), place(low, high)).prop_map(point::<D>);
    let general = move || vec(pair(-3.0, 3.0), 3..20).boxed();
    let lattice = |unit: f64, count: i32| {
        let step = move || (-count..count).prop_map(move |k| f64::from(k) * unit);
        vec((step(), step()).prop_map(point::<D>), 2..20)
    };
    let points = match sort {
        Sort::General => general(),
        Sort::Any => prop_oneof![
            4 => general(),
            1 => vec(pair(-3.0, 3.0), 1..3),
            2 => lattice(1.0, 8),
            2 => lattice(0.1, 30),
            // edges of bins of the width that is tried
            2 => lattice(0.371_73, 8),
            1 => (vec(pair(-0.01, 0.01), 2..12), vec(pair(900.0, 901.0), 1..3)).prop_map(|(near, far)| [near, far].concat()),
        ]
        .boxed(),
        Sort::OnePlace => (pair(-3.0, 3.0), 1usize..9, prop_oneof![Just(0.0), Just(1e9), Just(1e-9)])
            .prop_map(|(x, n, offset)| vec![x.map(|x| x + offset); n])
            .boxed(),
    };
    (points, 0usize..1000)
        .prop_flat_map(move |(points, choice)| {
            let domain = domain::<D>(walls, choice);
            let mut points = inside(&domain, points);
            // one on a wall, in a corner or on a vertex
            if sort != Sort::OnePlace && domain.has_walls() && choice % 2 == 0 && !points.is_empty()
            {
                points[0] = domain.low();
            }
            while points.len() < 3 && domain.outline().is_some() {
                let step = points.len() as f64 / 8.0;
                points.push([-1.5 + step * step; D]);
            }
            let n = points.len();
            let (low, high) = span(&points);
            (
                Just((points, choice, domain)),
                vec(1u32..5, n),
                vec(
                    (place(low - 3.0, high + 3.0), place(low - 3.0, high + 3.0))
                        .prop_map(point::<D>),
                    16,
                ),
            )
        })
        .prop_map(|((points, choice, domain), weights, targets)| {
            let mut targets = inside(&domain, targets);
            targets.extend(&points);
            Data {
                points,
                weights,
                targets,
                choice,
                domain,
            }
        })
        .boxed()
}

/// The least and the greatest coordinate on any axis.
pub fn span<const D: usize>(points: &[Point<D>]) -> (f64, f64) {
    points
        .as_flattened()
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
            (low.min(x), high.max(x))
        })
}

/// x ↦ scale · x + shift on each axis.
pub fn moved<const D: usize>(points: &[Point<D>], scale: f64, shift: f64) -> Vec<Point<D>> {
    points
        .iter()
        .map(|x| x.map(|x| scale * x + shift))
        .collect()
}

/// The domain of data that are moved.
pub fn moved_domain<const D: usize>(domain: &Domain<D>, scale: f64, shift: f64) -> Domain<D> {
    match domain.outline() {
        Some(outline) => {
            Domain::bounded(Polygon::new(moved(outline.vertices(), scale, shift)).unwrap()).unwrap()
        }
        None => Domain::new(
            domain.low().map(|x| scale * x + shift),
            domain.high().map(|x| scale * x + shift),
            domain.sides(),
        )
        .unwrap(),
    }
}

/// A sample of `points` with `weights` as they are.
pub fn weighted<const D: usize>(
    points: &[Point<D>],
    weights: Vec<f64>,
    domain: &Domain<D>,
) -> Sample<D> {
    Sample::new(
        points.to_vec(),
        Weights::Each(weights.into()),
        domain.clone(),
    )
    .unwrap()
}

/// A sample of `points`, 1/n each.
pub fn equal<const D: usize>(points: &[Point<D>], domain: &Domain<D>) -> Sample<D> {
    Sample::equal(points.to_vec(), domain.clone()).unwrap()
}

impl<const D: usize> Data<D> {
    /// The weights of the data, of sum 1.
    pub fn shares(&self) -> Vec<f64> {
        let total: u32 = self.weights.iter().sum();
        self.weights
            .iter()
            .map(|&w| f64::from(w) / f64::from(total))
            .collect()
    }

    /// With the weights of the data, of mass 1.
    pub fn sample(&self) -> Sample<D> {
        weighted(&self.points, self.shares(), &self.domain)
    }
}
