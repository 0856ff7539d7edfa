//! What of a patch is covered by things that stand on it, and whether the rest loses light to backs.
//!
//! Surfaces are black on their backs. A place that meets nothing but backs, however far they are, is seen by no front: it is inside a block, or under a
//! lamp that all but touches it. A place that meets some backs is seen by the rest of the room, and what it sends to the backs is lost.

use super::patch::Patch;
use crate::light::material::cosine_direction;
use crate::light::scene::Scene;
use crate::light::vector::Ray;

/// What is around a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// The share of the patch that is not covered.
    pub free: f64,
    /// Whether that share sees fronts only: no back, and no way out of the scene.
    pub enclosed: bool,
}

/// Rays from each quarter of a patch.
const RAYS: u32 = 64;

/// A place from which no more rays than this miss all backs is covered: the slit between a lamp and a ceiling near by lets some light in.
const SLIT: u32 = 1;

/// What of `patch` is covered, at the middles of its quarters: these are where the [visibility](super::transfer) between patches is looked up, so that
/// the shares of light that a patch exchanges miss exactly the quarters that are found covered here. 256 rays.
pub fn cover(scene: &Scene, patch: &Patch) -> Cover {
    let (mut free, mut enclosed) = (0.0, true);
    for (quarter, part) in (0_u32..).zip(patch.quarters()) {
        let (mut backs, mut lost) = (0, 0);
        for k in 0..RAYS {
            let (u, v) = direction(quarter, k);
            let ray = Ray {
                origin: part.centre(),
                direction: cosine_direction(patch.normal, u, v),
                leaving: Some(patch.primitive),
            };
            match scene.hit(&ray) {
                Some(hit) if hit.front => {}
                Some(_) => backs += 1,
                None => lost += 1,
            }
        }
        if RAYS - backs > SLIT {
            free += 0.25;
            enclosed &= backs + lost == 0;
        }
    }
    Cover { free, enclosed }
}

/// The k-th of a lattice's points in the unit square, turned from quarter to quarter. \[Fibonacci lattice: Niederreiter & Sloan 1994\]
fn direction(quarter: u32, k: u32) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let turned = f64::from(k).mul_add(GOLDEN, 0.25 * GOLDEN * f64::from(quarter));
    ((f64::from(k) + 0.5) / f64::from(RAYS), turned.fract())
}
