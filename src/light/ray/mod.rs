//! What rays meet: facets and spheres, by number.
//!
//! | file | what |
//! |---|---|
//! | `facets` | flat pieces, all tried at once: the definition |
//! | `tree` | flat pieces by a hierarchy of boxes: the same answer, for many |
//! | `spheres` | spheres, one after the other |

mod facets;
mod spheres;
mod tree;

use super::scene::{Facet, Sphere};
use super::vector::Ray;
use facets::Facets;
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
const FEW: usize = 32;

/// Finds the nearest thing on a ray.
#[derive(Debug)]
pub struct Caster {
    count: usize,
    flat: Flat,
    spheres: Vec<Sphere>,
}

#[derive(Debug)]
enum Flat {
    All(Facets),
    Tree(Tree),
}

impl Caster {
    /// For these facets and spheres. O(facets log facets).
    pub fn new(facets: &[Facet], spheres: Vec<Sphere>) -> Self {
        Self {
            count: facets.len(),
            flat: if facets.len() <= FEW {
                Flat::All(Facets::new(facets))
            } else {
                Flat::Tree(Tree::new(facets))
            },
            spheres,
        }
    }

    /// The same, trying every facet: what the hierarchy is judged by.
    pub fn exhaustive(facets: &[Facet], spheres: Vec<Sphere>) -> Self {
        Self {
            count: facets.len(),
            flat: Flat::All(Facets::new(facets)),
            spheres,
        }
    }

    /// How many facets; spheres are numbered after them.
    pub fn facets(&self) -> usize {
        self.count
    }

    /// The nearest thing that the ray meets before `limit`, but for the one it leaves.
    #[inline]
    pub fn nearest(&self, ray: &Ray, limit: f64) -> Option<Found> {
        let flat = match &self.flat {
            Flat::All(facets) => facets.nearest(ray, limit),
            Flat::Tree(tree) => tree.nearest(ray, limit),
        };
        if self.spheres.is_empty() {
            return flat;
        }
        let limit = flat.map_or(limit, |found| found.distance);
        spheres::nearest(&self.spheres, self.count as u32, ray, limit).or(flat)
    }
}
