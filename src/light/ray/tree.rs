//! Flat pieces by a hierarchy of boxes: O(log facets) a ray for surfaces that do not fill space.
//!
//! A binary tree, built from the top: each node is cut where the expected cost of a random ray is least, of 16 equally spaced cuts along each
//! axis through the centres of the facets [Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"]. Leaves are groups of
//! at most eight facets. A ray visits the nearer child first and leaves out boxes that begin behind what it has met.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::Found;
use super::facets::{Best, Group, LANES, Spread};
use crate::light::scene::Facet;
use crate::light::vector::Ray;
use pulp::Simd;

/// Cuts tried along an axis, and one.
const BINS: usize = 16;
/// Below this depth nodes are cut in halves by number, so that the depth is bounded.
const DEEP: usize = 32;
/// No path is longer: `DEEP` and one for each doubling of the number of facets.
const DEEPEST: usize = DEEP + 33;
/// The mark of a leaf.
const LEAF: u32 = 1 << 31;

/// An axis-parallel box.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    const NOTHING: Self = Self {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    fn with(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            self.low[axis] = self.low[axis].min(other.low[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis]);
        }
        self
    }

    fn of(facet: &Facet) -> Self {
        facet
            .corners()
            .iter()
            .fold(Self::NOTHING, |bounds, corner| {
                let point = [corner.x, corner.y, corner.z];
                bounds.with(&Self {
                    low: point,
                    high: point,
                })
            })
    }

    /// Half the surface; 0 for nothing.
    fn area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        x * y + y * z + z * x
    }

    /// A little larger than what rounding can do to a ray.
    fn grown(mut self) -> Self {
        let size = (0..3).fold(0.0, |most: f64, axis| {
            most.max(self.low[axis].abs()).max(self.high[axis].abs())
        });
        for axis in 0..3 {
            self.low[axis] -= 1e-11 * size;
            self.high[axis] += 1e-11 * size;
        }
        self
    }

    /// Where the ray enters the box; infinite if it passes it by, or does not enter before `limit`.
    #[inline(always)]
    fn entry(&self, origin: &[f64; 3], inverse: &[f64; 3], limit: f64) -> f64 {
        let (mut enter, mut leave) = (0.0, limit);
        for axis in 0..3 {
            let a = (self.low[axis] - origin[axis]) * inverse[axis];
            let b = (self.high[axis] - origin[axis]) * inverse[axis];
            let (near, far) = if a < b { (a, b) } else { (b, a) };
            enter = if near > enter { near } else { enter };
            leave = if far < leave { far } else { leave };
        }
        if enter <= leave { enter } else { f64::INFINITY }
    }
}

/// Two boxes and what is in them: a node, or a leaf's group.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: [Bounds; 2],
    child: [u32; 2],
}

/// Finds the nearest of many facets.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    groups: Vec<Group>,
    root: u32,
    bounds: Bounds,
}

struct Builder<'f> {
    facets: &'f [Facet],
    bounds: Vec<Bounds>,
    nodes: Vec<Node>,
    groups: Vec<Group>,
}

impl Builder<'_> {
    fn all(&self, numbers: &[u32]) -> Bounds {
        numbers.iter().fold(Bounds::NOTHING, |all, &number| {
            all.with(&self.bounds[number as usize])
        })
    }

    fn centre(&self, number: u32, axis: usize) -> f64 {
        let bounds = &self.bounds[number as usize];
        0.5 * (bounds.low[axis] + bounds.high[axis])
    }

    /// The axis, the first centre, the width of a bin and the cut of least cost; `None` if all centres are at one place.
    fn cut(&self, numbers: &[u32]) -> Option<(usize, f64, f64, usize)> {
        let mut best = None;
        let mut least = f64::INFINITY;
        for axis in 0..3 {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for &number in numbers {
                let centre = self.centre(number, axis);
                low = low.min(centre);
                high = high.max(centre);
            }
            let width = (high - low) / BINS as f64;
            if width.is_nan() || width <= 0.0 {
                continue;
            }
            let mut bins = [(0usize, Bounds::NOTHING); BINS];
            for &number in numbers {
                let bin = &mut bins[bin(self.centre(number, axis), low, width)];
                bin.0 += 1;
                bin.1 = bin.1.with(&self.bounds[number as usize]);
            }
            let mut behind = [0.0; BINS];
            let (mut count, mut bounds) = (0, Bounds::NOTHING);
            for cut in (1..BINS).rev() {
                count += bins[cut].0;
                bounds = bounds.with(&bins[cut].1);
                behind[cut] = count as f64 * bounds.area();
            }
            let (mut count, mut bounds) = (0, Bounds::NOTHING);
            for cut in 1..BINS {
                count += bins[cut - 1].0;
                bounds = bounds.with(&bins[cut - 1].1);
                let cost = count as f64 * bounds.area() + behind[cut];
                if count > 0 && count < numbers.len() && cost < least {
                    least = cost;
                    best = Some((axis, low, width, cut));
                }
            }
        }
        best
    }

    fn build(&mut self, numbers: &mut [u32], depth: usize) -> u32 {
        if numbers.len() <= LANES {
            self.groups.push(Group::new(self.facets, numbers));
            return LEAF | (self.groups.len() - 1) as u32;
        }
        let cut = if depth < DEEP {
            self.cut(numbers)
        } else {
            None
        };
        let middle = match cut {
            Some((axis, low, width, cut)) => {
                numbers.sort_by_key(|&number| bin(self.centre(number, axis), low, width) >= cut);
                numbers.partition_point(|&number| bin(self.centre(number, axis), low, width) < cut)
            }
            None => numbers.len() / 2,
        };
        let at = self.nodes.len();
        let (left, right) = numbers.split_at_mut(middle);
        let bounds = [self.all(left).grown(), self.all(right).grown()];
        self.nodes.push(Node {
            bounds,
            child: [0; 2],
        });
        let left = self.build(left, depth + 1);
        let right = self.build(right, depth + 1);
        self.nodes[at].child = [left, right];
        at as u32
    }
}

fn bin(centre: f64, low: f64, width: f64) -> usize {
    (((centre - low) / width) as usize).min(BINS - 1)
}

impl Tree {
    pub(super) fn new(facets: &[Facet]) -> Self {
        let mut numbers: Vec<u32> = (0..facets.len() as u32).collect();
        let mut builder = Builder {
            facets,
            bounds: facets.iter().map(Bounds::of).collect(),
            nodes: Vec::new(),
            groups: Vec::new(),
        };
        let bounds = builder.all(&numbers).grown();
        let root = builder.build(&mut numbers, 0);
        Self {
            nodes: builder.nodes,
            groups: builder.groups,
            root,
            bounds,
        }
    }

    #[inline(always)]
    pub(super) fn nearest<S: Simd>(&self, simd: S, ray: &Ray, limit: f64) -> Option<Found> {
        let origin = [ray.origin.x, ray.origin.y, ray.origin.z];
        // finite, as 0 × ∞ on the side of a box would be no number
        let inverse = [ray.direction.x, ray.direction.y, ray.direction.z]
            .map(|x| x.recip().clamp(-f64::MAX, f64::MAX));
        let beam = Spread::new(simd, ray);
        let mut found: Option<Found> = None;
        let mut limit = limit;
        let mut waiting = [(0u32, 0.0f64); DEEPEST];
        let mut count = 0;
        if self.bounds.entry(&origin, &inverse, limit) == f64::INFINITY {
            return None;
        }
        let mut at = self.root;
        loop {
            if at & LEAF != 0 {
                // what is as near as what was found counts if its number is lower
                let reach = if found.is_some() {
                    limit.next_up()
                } else {
                    limit
                };
                let mut best = Best::new(simd, reach);
                best.try_group(simd, &beam, &self.groups[(at ^ LEAF) as usize]);
                let before = |new: &Found| {
                    found.is_none_or(|old| {
                        new.distance < old.distance
                            || (new.distance <= old.distance && new.primitive < old.primitive)
                    })
                };
                if let Some(nearer) = best.found(simd).filter(before) {
                    limit = nearer.distance;
                    found = Some(nearer);
                }
            } else {
                let node = &self.nodes[at as usize];
                let [a, b] = [0, 1].map(|k| node.bounds[k].entry(&origin, &inverse, limit));
                let (near, far) = if a <= b { (0, 1) } else { (1, 0) };
                let (first, second) = if a <= b { (a, b) } else { (b, a) };
                if second < f64::INFINITY {
                    waiting[count] = (node.child[far], second);
                    count += 1;
                }
                if first < f64::INFINITY {
                    at = node.child[near];
                    continue;
                }
            }
            loop {
                if count == 0 {
                    return found;
                }
                count -= 1;
                let (next, entry) = waiting[count];
                if entry < limit {
                    at = next;
                    break;
                }
            }
        }
    }
}
