//! Moments of Gaussian kernel estimates between walls of the plane, at all places of a lattice at once.
//!
//! Write P_h f for a density that a Gaussian kernel has smoothed and the walls of a rectangle have reflected, however often: of each product of cosines it leaves the
//! share exp(-π² (j² h₁² + k² h₂²)/2), with h in units of the sides. \[Botev, Grotowski & Kroese 2010, section 3\] That is the mean of an estimate. The product of the bumps about
//! a place and its image gx is a bump about the middle of the two, K_h(x - y) K_h(gx - y) = K_{√2 h}(x - gx) K_{h/√2}((x + gx)/2 - y), so that the mean square of
//! the reflected kernel is Σ_g K_{√2 h}(x - gx) (P_{h/√2} f)((x + gx)/2) over all images, and the middles are the place, the place seen from the other wall, or on a wall.
//!
//! (Derived here: the images of a place form a group, and the sum over pairs of images is one over middles.)
//!
//! In a polygon there are no such images. There the kernel is cut and normalised, and the rectangle is one so much wider that its walls are out of reach.

use crate::density::Bivariate;
use crate::numeric::forward_transform;
use crate::space::{Domain, Point, Polygon, polygon_moments};
use crate::theory::Moments;
use nalgebra::DMatrix;
use rayon::prelude::*;
use realfft::num_complex::Complex;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

/// Means and variances of the Gaussian kernel estimate of a density between walls: reflected at those of a rectangle, cut and normalised in a polygon.
///
/// The coefficients are those of the means over 1024² cells of the rectangle, or of one that leaves a polygon room. Good to some 1e-5 of the peak on rectangles and 1e-4 in polygons; with the narrowest of kernels
/// beside jumps and at edges to some thousandths. Some tenths of a second at first.
pub struct WalledKernel {
    domain: Domain<2>,
    frame: Frame,
    /// Coefficients of products of cosines: of the density, and of 1 in a polygon.
    density: DMatrix<f64>,
    inside: Option<DMatrix<f64>>,
}

/// The rectangle in which there are waves, and for which bandwidths.
struct Frame {
    corner: Point<2>,
    sides: [f64; 2],
    range: [f64; 2],
}

/// Cells along each side.
const CELLS: usize = 1024;
/// Frequencies along each side, of which the cells resolve more.
const MOST: usize = 768;
/// In units of the side: a kernel like that leaves one part in a thousand of the next frequency, and its square one in thirty, of waves that are hardly there.
const NARROWEST: f64 = 1.2 / MOST as f64;
/// The widest bandwidth in units of the shorter extent of a polygon.
const WIDEST: f64 = 0.75;
/// How far beyond a polygon the rectangle goes in units of the widest bandwidth: images are twice as far away.
const ROOM: f64 = 2.0;
/// Between the narrowest and the widest there must be some.
const SPAN: f64 = 4.0;
/// Cells across the finest detail of a density, at least.
const DETAIL: f64 = 2.0;

impl Frame {
    fn of(truth: &dyn Bivariate) -> Option<Self> {
        let domain = truth.domain();
        let (low, high) = match domain.outline() {
            Some(outline) => outline.bounds(),
            None => (domain.low(), domain.high()),
        };
        let extent = [0, 1].map(|k: usize| high[k] - low[k]);
        if domain.wraps() || !extent.iter().all(|extent| extent.is_finite()) {
            return None;
        }
        let least = extent[0].min(extent[1]);
        let (widest, room) = match domain.outline() {
            Some(_) => (WIDEST * least, ROOM * WIDEST * least),
            None => (least, 0.0),
        };
        let sides = extent.map(|extent| extent + 2.0 * room);
        let narrowest = NARROWEST * sides[0].max(sides[1]);
        let shown = (0..2).all(|k| truth.finest_scale(k) >= DETAIL * sides[k] / CELLS as f64);
        (shown && widest > SPAN * narrowest).then(|| Self {
            corner: low.map(|low| low - room),
            sides,
            range: [narrowest, widest],
        })
    }

    fn cells(&self) -> Cells {
        Cells {
            corner: self.corner,
            widths: self.sides.map(|side| side / CELLS as f64),
        }
    }
}

impl WalledKernel {
    /// For a density on a rectangle or a polygon whose details the cells show; `None` for any other, and for one on a strip some hundred times as long as it is wide.
    pub fn new(truth: &dyn Bivariate) -> Option<Self> {
        let frame = Frame::of(truth)?;
        Some(match truth.domain().outline() {
            Some(outline) => Self::in_polygon(truth, outline, frame),
            None => Self::on_rectangle(truth, frame),
        })
    }

    /// Whether there are moments for a density, at no cost.
    pub fn is_for(truth: &dyn Bivariate) -> bool {
        Frame::of(truth).is_some()
    }

    fn on_rectangle(truth: &dyn Bivariate, frame: Frame) -> Self {
        let cells = frame.cells();
        let area = cells.widths[0] * cells.widths[1];
        let density = coefficients(&cells.all(|low, high| truth.probability(low, high) / area));
        Self {
            domain: truth.domain().clone(),
            frame,
            density,
            inside: None,
        }
    }

    fn in_polygon(truth: &dyn Bivariate, outline: &Polygon, frame: Frame) -> Self {
        let (low, high) = outline.bounds();
        let cells = frame.cells();
        let whole = cells.widths[0] * cells.widths[1];
        // the share of each cell that is inside, and the mean over all of it
        let both = cells.all(|from, to| {
            if (0..2).any(|k| to[k] < low[k] || from[k] > high[k]) {
                return [0.0; 2];
            }
            let [area, x, y] = polygon_moments(&outline.within(from, to));
            if area <= 0.0 {
                return [0.0; 2];
            }
            let (share, middle) = (area / whole, [x / area, y / area]);
            // the middle of what an inward corner leaves may lie beyond it
            let mean = if outline.contains(middle) {
                share * truth.at(middle)
            } else {
                truth.probability(from, to) / whole
            };
            [share, mean]
        });
        let [inside, density] = [0, 1]
            .map(|i: usize| coefficients(&both.iter().map(|both| both[i]).collect::<Vec<_>>()));
        Self {
            domain: truth.domain().clone(),
            frame,
            density,
            inside: Some(inside),
        }
    }

    /// The narrowest and the widest bandwidth for which there are moments.
    pub fn range(&self) -> [f64; 2] {
        self.frame.range
    }

    /// The moments of estimates of one point, whose variance is n times that of an estimate of n, at all places with a coordinate of `first` and one of `second`, the
    /// second faster; zero beyond the walls. `h` is the bandwidth on both axes, within [`WalledKernel::range`]. For 256² places from one to some tens of milliseconds, the
    /// longer the narrower the kernel.
    pub fn moments(&self, h: f64, first: &[f64], second: &[f64]) -> Vec<Moments> {
        let along = |h: f64| (self.waves(0, h, first), self.waves(1, h, second));
        let mean = sums(&self.density, along(h));
        let (square, mass) = match &self.inside {
            None => {
                let images = (self.images(0, h, first), self.images(1, h, second));
                (sums(&self.density, images), None)
            }
            Some(inside) => {
                let square = sums(&self.density, along(h * FRAC_1_SQRT_2)) / (4.0 * PI * h * h);
                (square, Some(sums(inside, along(h))))
            }
        };
        let places = first.iter().enumerate();
        let places = places.flat_map(|(i, &x)| (0..second.len()).map(move |j| (i, j, x)));
        places
            .map(|(i, j, x)| {
                if !self.domain.contains([x, second[j]]) {
                    return Moments {
                        mean: 0.0,
                        variance: 0.0,
                    };
                }
                // in the sharpest of corners there is little inside
                let mass = mass.as_ref().map_or(1.0, |mass| mass[(i, j)].max(1e-6));
                let mean = mean[(i, j)] / mass;
                let square = square[(i, j)] / (mass * mass);
                Moments {
                    mean,
                    variance: (square - mean * mean).max(0.0),
                }
            })
            .collect()
    }

    /// Each wave at each place (a row each), as much of it as is left.
    fn waves(&self, axis: usize, h: f64, places: &[f64]) -> DMatrix<f64> {
        let left = self.left(axis, h);
        DMatrix::from_fn(places.len(), left.len(), |i, j| {
            left[j] * wave(j, self.unit(axis, places[i]))
        })
    }

    /// The same, summed over the middles between each place and its images with the weights that these have.
    fn images(&self, axis: usize, h: f64, places: &[f64]) -> DMatrix<f64> {
        /// So many walls away even the widest kernel is not felt.
        const FAR: i32 = 8;
        let (side, left) = (self.frame.sides[axis], self.left(axis, h * FRAC_1_SQRT_2));
        let bump = |d: f64| (-(d * d) / (4.0 * h * h)).exp() / (2.0 * h * PI.sqrt());
        let mut all = DMatrix::zeros(places.len(), left.len());
        for (i, &x) in places.iter().enumerate() {
            let x = x - self.frame.corner[axis];
            // [even, odd]: moved by m sides twice, so that the middle is moved by m; mirrored in wall m
            let (mut moved, mut mirrored) = ([0.0; 2], [0.0; 2]);
            for m in -FAR..=FAR {
                let (far, odd) = (f64::from(m) * side, m.rem_euclid(2) as usize);
                moved[odd] += bump(2.0 * far);
                mirrored[odd] += bump(2.0 * (x - far));
            }
            for (j, left) in left.iter().enumerate() {
                let turn = if j % 2 == 0 { 1.0 } else { -1.0 };
                let sum = |[even, odd]: [f64; 2]| turn * odd + even;
                let value = wave(j, x / side) * sum(moved) + wave(j, 0.0) * sum(mirrored);
                all[(i, j)] = left * value;
            }
        }
        all
    }

    /// What a kernel leaves of each wave, as far as there is any.
    fn left(&self, axis: usize, h: f64) -> Vec<f64> {
        let rate = 0.5 * (PI * h / self.frame.sides[axis]).powi(2);
        let all = (0..MOST).map(|j| (-rate * (j * j) as f64).exp());
        all.take_while(|left| *left > 1e-17).collect()
    }

    fn unit(&self, axis: usize, x: f64) -> f64 {
        (x - self.frame.corner[axis]) / self.frame.sides[axis]
    }
}

/// √2 cos πju, and 1 for none: orthonormal between 0 and 1.
fn wave(j: usize, u: f64) -> f64 {
    match j {
        0 => 1.0,
        _ => SQRT_2 * (PI * j as f64 * u).cos(),
    }
}

/// Σ c_jk along_j across_k for each pair of their rows.
fn sums(
    coefficients: &DMatrix<f64>,
    (along, across): (DMatrix<f64>, DMatrix<f64>),
) -> DMatrix<f64> {
    let left = coefficients.view((0, 0), (along.ncols(), across.ncols()));
    (along * left) * across.transpose()
}

/// The cells of a rectangle.
struct Cells {
    corner: Point<2>,
    widths: [f64; 2],
}

impl Cells {
    /// What `of` says of each, from its lower corner and its upper one, the second axis faster.
    fn all<T: Send>(&self, of: impl Fn(Point<2>, Point<2>) -> T + Sync) -> Vec<T> {
        let edge = |k: usize, i: usize| (i as f64).mul_add(self.widths[k], self.corner[k]);
        (0..CELLS * CELLS)
            .into_par_iter()
            .map(|n| {
                let [i, j] = [n / CELLS, n % CELLS];
                of([edge(0, i), edge(1, j)], [edge(0, i + 1), edge(1, j + 1)])
            })
            .collect()
    }
}

/// The coefficients up to `MOST` on each axis of what has these means over cells: over a cell a wave loses the share 1 - sin(x)/x with x = πj/2N.
fn coefficients(means: &[f64]) -> DMatrix<f64> {
    // along the second axis, then along the first
    let both = cosines(&transposed(&cosines(means)));
    let lost = |j: usize| {
        let x = PI * j as f64 / (2 * CELLS) as f64;
        if j == 0 { 1.0 } else { x.sin() / x }
    };
    DMatrix::from_fn(MOST, MOST, |j, k| both[k * CELLS + j] / (lost(j) * lost(k)))
}

/// The coefficients Σ x_n √2 cos(πj(n + ½)/N) / N of each row, without √2 for the constant: through the spectrum of the row and its mirror image.
fn cosines(rows: &[f64]) -> Vec<f64> {
    let plan = forward_transform(2 * CELLS);
    let turn: Vec<Complex<f64>> = (0..CELLS)
        .map(|j| {
            let scale = if j == 0 { 0.5 } else { FRAC_1_SQRT_2 };
            Complex::from_polar(scale / CELLS as f64, -PI * j as f64 / (2 * CELLS) as f64)
        })
        .collect();
    let rows = rows.par_chunks_exact(CELLS).flat_map_iter(|row| {
        let mut mirrored: Vec<f64> = row.iter().chain(row.iter().rev()).copied().collect();
        let mut spectrum = plan.make_output_vec();
        // lengths are those of the plan
        let done = plan.process(&mut mirrored, &mut spectrum);
        debug_assert!(done.is_ok());
        let found: Vec<f64> = (spectrum.iter().zip(&turn))
            .map(|(y, t)| (y * t).re)
            .collect();
        found
    });
    rows.collect()
}

fn transposed(square: &[f64]) -> Vec<f64> {
    (0..CELLS * CELLS)
        .map(|n| square[(n % CELLS) * CELLS + n / CELLS])
        .collect()
}
