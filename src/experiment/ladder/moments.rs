//! Moments of Gaussian kernel estimates of one point, whatever the density: reflected at the walls of a line or a rectangle; cut and normalised in a polygon, whose
//! walls have no mirror images.

use super::search::Likes;
use crate::density::{Bivariate, Density, Univariate};
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::{self, Builds};
use crate::kernel::{Shape, Symmetry};
use crate::theory::{Moments, WalledKernel, plane_kernel_moments};

/// Where they come from.
pub(super) enum KernelMoments<'t> {
    /// A density on a line.
    Line(&'t dyn Univariate),
    /// Normals in the plane, in closed form.
    Mixture(&'t dyn Bivariate),
    /// A product of densities on lines: kernels are products, too.
    Factors([&'t dyn Univariate; 2]),
    /// Any on a rectangle or a polygon.
    Walls(Box<WalledKernel>),
}

impl<'t> KernelMoments<'t> {
    pub fn of<const D: usize>(truth: &'t dyn Density<D>) -> Option<Self> {
        if let Some(line) = truth.univariate() {
            return Some(Self::Line(line));
        }
        let plane = truth.bivariate()?;
        Some(match plane.factors() {
            _ if plane.normal_components().is_some() => Self::Mixture(plane),
            Some(factors) => Self::Factors(factors),
            None => Self::Walls(Box::new(WalledKernel::new(plane)?)),
        })
    }

    /// Whether there are any.
    pub fn are_of<const D: usize>(truth: &dyn Density<D>) -> bool {
        let in_plane = |plane: &dyn Bivariate| {
            let apart = plane.normal_components().is_some() || plane.factors().is_some();
            apart || WalledKernel::is_for(plane)
        };
        truth.univariate().is_some() || truth.bivariate().is_some_and(in_plane)
    }

    /// Whether they are sums over normals, and quick.
    pub fn are_closed(&self) -> bool {
        match self {
            Self::Line(line) => line.normal_components().is_some(),
            Self::Mixture(_) => true,
            Self::Factors(_) | Self::Walls(_) => false,
        }
    }

    /// From the narrowest bandwidth to the widest for samples of up to `draws` points: well below what is best for the finest detail, and up to the extent of the density. Much wider ones have the mean f
    /// at places far out of the middle, by chance as it were.
    pub fn range(&self, draws: f64) -> [f64; 2] {
        let of = |bulk: &[[f64; 2]], finest: f64| {
            let extents = bulk.iter().map(|[low, high]| high - low);
            let widest = extents.fold(f64::INFINITY, f64::min);
            let share = draws.powf(-1.0 / (bulk.len() as f64 + 3.0)).min(0.05);
            [(share * finest).min(1e-3 * widest), widest]
        };
        let line = |line: &dyn Univariate| {
            let ([low], [high]) = line.bulk(1e-4);
            ([low, high], line.finest_scale(0))
        };
        match self {
            Self::Line(truth) => {
                let (bulk, finest) = line(*truth);
                of(&[bulk], finest)
            }
            Self::Factors([a, b]) => {
                let [(first, fine), (second, other)] = [line(*a), line(*b)];
                of(&[first, second], fine.min(other))
            }
            Self::Mixture(plane) => {
                let (low, high) = plane.bulk(1e-4);
                let finest = plane.finest_scale(0).min(plane.finest_scale(1));
                of(&[[low[0], high[0]], [low[1], high[1]]], finest)
            }
            Self::Walls(walls) => walls.range(),
        }
    }

    /// At all places with one coordinate of each axis, the last faster.
    pub fn at(&self, h: f64, axes: &[Vec<f64>]) -> Option<Vec<Moments>> {
        match (self, axes) {
            (Self::Line(line), [x]) => reflected(*line, h, x),
            (Self::Factors([a, b]), [x, y]) => {
                let (first, second) = (reflected(*a, h, x)?, reflected(*b, h, y)?);
                let pairs = first
                    .iter()
                    .flat_map(|a| second.iter().map(|b| a.times(*b)));
                Some(pairs.collect())
            }
            (Self::Mixture(plane), [x, y]) => {
                let gaussian = (Shape::Gaussian, Symmetry::Product);
                let of = |place| {
                    plane_kernel_moments(*plane, gaussian.0, gaussian.1, [h; 2], 1.0, place)
                };
                let places = x.iter().flat_map(|&x| y.iter().map(move |&y| [x, y]));
                Some(places.map(of).collect())
            }
            (Self::Walls(walls), [x, y]) => Some(walls.moments(h, x, y)),
            _ => None,
        }
    }
}

/// Of estimates of one point with a reflected Gaussian kernel on a line.
fn reflected(truth: &dyn Univariate, h: f64, places: &[f64]) -> Option<Vec<Moments>> {
    let likes = Likes::reflected()?;
    let context = Context {
        truth: None,
        draws: 1,
    };
    let entry = catalogue::estimator("kernel")?;
    let kernel: Box<dyn Estimator<1>> = entry.build(&likes.member(h), &context).ok()?;
    let truth: &dyn Density<1> = truth;
    let places: Vec<[f64; 1]> = places.iter().map(|&x| [x]).collect();
    kernel.expectation(truth, 1, &places)
}
