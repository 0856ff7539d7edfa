//! Exact mean and variance of a corrected estimate.

use super::moments::walls;
use super::{Boundary, Bump};
use crate::density::{Bivariate, Density};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::space::Point;
use crate::theory::{
    Moments, Support, equivalent_moments, plane_equivalent_moments, plane_kernel_moments,
};

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
    let longest = if narrow {
        longest
    } else {
        0.125 * h.min(high - low)
    };
    let n = draws as f64;
    let inside = equivalent_moments(truth, |y| kernel([y]), range, cuts.clone(), longest, n);
    let Some((whole, factor)) = truth.beyond().filter(|_| boundary.sees_beyond()) else {
        return Some(inside);
    };
    let all = equivalent_moments(
        whole,
        |y| kernel([y]),
        [x - reach, x + reach],
        cuts,
        longest,
        n,
    );
    Some(with_beyond(inside, all, factor, n))
}

/// The moments of a sum over `n` points inside and those that fell beyond meanwhile, from those of the sum inside and of one over points of the whole density, which is that inside over `factor`.
///
/// Until n points have fallen inside, the number beyond has the negative binomial distribution, so that n var f̂ is ∫κ² over all of f, less (∫κ inside)², plus (∫κ beyond)².
fn with_beyond(inside: Moments, whole: Moments, factor: f64, n: f64) -> Moments {
    let square = factor * (n * whole.variance + whole.mean * whole.mean);
    let mean = factor * whole.mean;
    let beyond = mean - inside.mean;
    Moments {
        mean,
        variance: ((square - inside.mean * inside.mean + beyond * beyond) / n).max(0.0),
    }
}

/// The same in the plane, on boxes and polygons, by quadrature over what the walls leave of the support of the kernel.
///
/// Good to some 1e-9 of the peak for a smooth density; to some 1e-4 where the kernel is not smooth inside that: round kernels that are mirrored, and each point's
/// own share of a kernel near a wall (normalise-points). Away from the walls at the price of a plain estimate, else of some thousand kernels.
pub fn corrected_moments_in_plane(
    boundary: &dyn Boundary<2>,
    bump: &Bump<2>,
    truth: &dyn Bivariate,
    draws: f64,
    x: Point<2>,
) -> Option<Moments> {
    let domain = truth.domain();
    let kernel = boundary.equivalent(bump, domain, x)?;
    if !domain.contains(x) && boundary.name() != "ignore" {
        return Some(Moments {
            mean: 0.0,
            variance: 0.0,
        });
    }
    // nothing is corrected where neither the target nor any point that it feels is near a wall
    let twice = Bump {
        width: bump.width.map(|h| (1.0 + boundary.reaches(domain)) * h),
        ..*bump
    };
    if twice.is_clear(domain, x) {
        let Bump {
            shape,
            symmetry,
            width,
        } = *bump;
        return Some(plane_kernel_moments(
            truth, shape, symmetry, width, draws, x,
        ));
    }
    let gaussian = bump.shape == Shape::Gaussian;
    let reaches = boundary.reaches(domain);
    let support = Support {
        centre: x,
        reach: bump.reach().map(|reach| reaches * reach),
        round: gaussian || bump.symmetry == Symmetry::Radial,
    };
    let [h, k] = bump.width;
    let longest = if gaussian { h.min(k) } else { 0.5 * h.min(k) };
    // on the rim rounding must not decide between all and nothing
    let inward =
        |y: Point<2>| [0, 1].map(|i: usize| x[i] + (y[i] - x[i]) * (1.0 - 4.0 * f64::EPSILON));
    let value = |y: Point<2>| kernel(inward(y));
    let inside = plane_equivalent_moments(truth, value, support, longest, draws);
    let Some((whole, factor)) = truth.beyond().filter(|_| boundary.sees_beyond()) else {
        return Some(inside);
    };
    let whole = whole.bivariate()?;
    let all = plane_kernel_moments(whole, bump.shape, bump.symmetry, bump.width, draws, x);
    Some(with_beyond(inside, all, factor, draws))
}
