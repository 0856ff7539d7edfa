//! Exact mean and variance of a corrected estimate on a line.

use super::moments::walls;
use super::{Boundary, Bump};
use crate::density::Density;
use crate::kernel::{Kernel, Shape};
use crate::theory::{Moments, equivalent_moments};

/// E f̂(x) and var f̂(x) of the kernel estimate with the kernel `bump`, corrected by `boundary` on the domain of `truth`, from `draws` points.
/// `None` for a treatment that is not linear. Some thousand evaluations of the density.
pub fn corrected_moments(
    boundary: &dyn Boundary<1>,
    bump: &Bump<1>,
    truth: &dyn Density<1>,
    draws: usize,
    x: f64,
) -> Option<Moments> {
    let domain = truth.domain();
    let kernel = boundary.equivalent(bump, domain, [x])?;
    if !domain.contains([x]) && boundary.name() != "ignore" {
        return Some(Moments {
            mean: 0.0,
            variance: 0.0,
        });
    }
    let ([reach], [h]) = (bump.reach(), bump.width);
    let walls = walls(domain, 0).into_iter().filter(|wall| wall.is_finite());
    // the kernel bends at its centre and ends, in all mirrors, and where a point comes clear of a wall
    let mut cuts = vec![x - h, x, x + h];
    for wall in walls {
        cuts.extend([wall + h, wall - h]);
        cuts.extend([-h, 0.0, h].map(|off| 2.0 * wall - x + off));
    }
    let longest = if bump.shape == Shape::Gaussian {
        h
    } else {
        2.0 * bump.shape.reach() * h
    };
    // images of images may be felt from anywhere: only then is the whole domain in reach
    let ([low], [high]) = (domain.low(), domain.high());
    let narrow = 2.0 * reach < high - low;
    let range = if narrow {
        [x - reach, x + reach]
    } else {
        [low, high]
    };
    Some(equivalent_moments(
        truth,
        |y| kernel([y]),
        range,
        cuts,
        if narrow {
            longest
        } else {
            0.125 * h.min(high - low)
        },
        draws as f64,
    ))
}
