//! Form factors between patches by quadrature, with what stands between them.
//!
//! # References
//! Baum, Rushmeier & Winget 1989 (a closed form for the far patch, quadrature over the near one); Wallace, Elmquist & Haines 1989 (visibility by rays).

use super::patch::Patch;
use super::system::FormFactors;
use crate::light::scene::Scene;
use rayon::prelude::*;

/// The form factors of all pairs. Each is a mean of closed forms over points of one patch, from both sides, so that reciprocity
/// holds exactly, times the share of four rays between the patches that nothing stops. O(patches²) of both.
pub fn form_factors(scene: &Scene, patches: &[Patch]) -> FormFactors {
    let count = patches.len();
    let upper: Vec<Vec<f64>> = (0..count)
        .into_par_iter()
        .map(|i| {
            (i + 1..count)
                .map(|j| exchange(scene, &patches[i], &patches[j]))
                .collect()
        })
        .collect();
    let mut shares = vec![0.0; count * count];
    for (i, row) in upper.iter().enumerate() {
        for (k, exchange) in row.iter().enumerate() {
            let j = i + 1 + k;
            shares[i * count + j] = exchange / patches[i].area;
            shares[j * count + i] = exchange / patches[j].area;
        }
    }
    FormFactors::new(count, shares)
}

/// Aᵢ Fᵢⱼ = Aⱼ Fⱼᵢ.
fn exchange(scene: &Scene, a: &Patch, b: &Patch) -> f64 {
    let between = b.centre() - a.centre();
    let size = a.size().max(b.size());
    // neither front looks at any part of the other
    let apart = |p: &Patch, way: f64| way * between.dot(&p.normal) <= -size;
    if apart(a, 1.0) || apart(b, -1.0) {
        return 0.0;
    }
    let near = between.norm() / size;
    let depth = match near {
        near if near < 1.6 => 2,
        near if near < 3.0 => 1,
        _ => 0,
    };
    let unblocked = 0.5 * (mean_seen(a, b, depth) * a.area + mean_seen(b, a, depth) * b.area);
    if unblocked <= 0.0 {
        return 0.0;
    }
    unblocked * visible_share(scene, a, b)
}

/// The mean over patch `a` of what is seen of `b`, by rules that are exact for cubics on a parallelogram and quadratics on a triangle.
fn mean_seen(a: &Patch, b: &Patch, depth: u32) -> f64 {
    if depth == 0 {
        let places = a.nodes();
        let sum: f64 = places.iter().map(|&at| b.seen_from(at, a.normal)).sum();
        return sum / places.len() as f64;
    }
    let quarters = a.quarters();
    0.25 * quarters
        .iter()
        .map(|part| mean_seen(part, b, depth - 1))
        .sum::<f64>()
}

/// Which quarters of two patches rays join: opposite corners too, so that a narrow thing between is not missed by parallel rays.
const PAIRS: [[usize; 2]; 4] = [[0, 3], [1, 1], [2, 2], [3, 0]];

fn visible_share(scene: &Scene, a: &Patch, b: &Patch) -> f64 {
    let (a, b) = (a.quarters(), b.quarters());
    let free = PAIRS
        .iter()
        .filter(|[i, j]| scene.visible(a[*i].centre(), b[*j].centre()))
        .count();
    0.25 * free as f64
}
