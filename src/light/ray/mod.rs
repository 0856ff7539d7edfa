//! What rays meet: facets and spheres, by number.
//!
//! | file | what |
//! |---|---|
//! | `facets` | flat pieces, all tried at once: the definition |
//! | `few` | flat pieces, all tried, by many rays at once: the same answer, for few |
//! | `rectangles` | those that stand in right corners |
//! | `tree` | flat pieces by a hierarchy of boxes: the same answer, for many |
//! | `spheres` | spheres, one after the other |
//!
//! Of things that are met at one distance, to the last bit, such as a facet given twice, the one with the lowest number is met, whoever looks.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

mod beam;
mod facets;
mod few;
mod rays;
mod rectangles;
mod spheres;
#[cfg(test)]
mod tests;
mod tree;

pub use rays::{Rays, Row, TOGETHER};

use super::scene::{Facet, Sphere};
use super::vector::Ray;
use facets::Facets;
use few::Few;
use pulp::{Arch, Simd, WithSimd};
use tree::Tree;

/// The nearest thing on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Which facet or, counted after the facets, which sphere.
    pub primitive: u32,
    /// How far along the ray.
    pub distance: f64,
}

/// With no more facets than these, trying all is cheaper than the hierarchy.
const FEW: usize = 48;

/// Finds the nearest thing on a ray.
#[derive(Debug)]
pub struct Caster {
    count: usize,
    flat: Flat,
    spheres: Vec<Sphere>,
    arch: Arch,
}

#[derive(Debug)]
enum Flat {
    All(Facets),
    Few(Few),
    Tree(Tree),
}

impl Caster {
    /// For these facets and spheres. O(facets log facets).
    pub fn new(facets: &[Facet], spheres: Vec<Sphere>) -> Self {
        let flat = if facets.len() <= FEW {
            Flat::Few(Few::new(facets))
        } else {
            Flat::Tree(Tree::new(facets))
        };
        Self::with(flat, facets.len(), spheres)
    }

    /// The same, trying every facet: what the hierarchy is judged by.
    pub fn exhaustive(facets: &[Facet], spheres: Vec<Sphere>) -> Self {
        Self::with(Flat::All(Facets::new(facets)), facets.len(), spheres)
    }

    fn with(flat: Flat, count: usize, spheres: Vec<Sphere>) -> Self {
        Self {
            count,
            flat,
            spheres,
            arch: Arch::new(),
        }
    }

    /// How many facets; spheres are numbered after them.
    pub fn facets(&self) -> usize {
        self.count
    }

    /// The nearest thing that the ray meets before `limit`, but for the one it leaves.
    pub fn nearest(&self, ray: &Ray, limit: f64) -> Option<Found> {
        self.arch.dispatch(Query {
            caster: self,
            ray,
            limit,
        })
    }

    /// The nearest things that the first `count` rays meet, each the same as [alone](Self::nearest), to the last bit. Inside a function that is compiled
    /// for wide registers.
    #[inline(always)]
    pub fn nearest_of<S: Simd>(&self, simd: S, rays: &mut Rays, count: usize) {
        let Flat::Few(few) = &self.flat else {
            for at in 0..count {
                let found = self.nearest_in(simd, &rays.ray(at), f64::INFINITY);
                rays.meet(at, found);
            }
            return;
        };
        few.nearest_of(simd, rays, count);
        if self.spheres.is_empty() {
            return;
        }
        for at in 0..count {
            let limit = rays.distance[at];
            let found = spheres::nearest(&self.spheres, self.count as u32, &rays.ray(at), limit);
            if found.is_some() {
                rays.meet(at, found);
            }
        }
    }

    /// The same as [`nearest`](Self::nearest) inside such a function.
    #[inline(always)]
    pub fn nearest_in<S: Simd>(&self, simd: S, ray: &Ray, limit: f64) -> Option<Found> {
        let flat = match &self.flat {
            Flat::All(facets) => facets.nearest(simd, ray, limit),
            Flat::Few(few) => few.nearest(ray, limit),
            Flat::Tree(tree) => tree.nearest(simd, ray, limit),
        };
        if self.spheres.is_empty() {
            return flat;
        }
        let limit = flat.map_or(limit, |found| found.distance);
        spheres::nearest(&self.spheres, self.count as u32, ray, limit).or(flat)
    }
}

struct Query<'q> {
    caster: &'q Caster,
    ray: &'q Ray,
    limit: f64,
}

impl WithSimd for Query<'_> {
    type Output = Option<Found>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.caster.nearest_in(simd, self.ray, self.limit)
    }
}
