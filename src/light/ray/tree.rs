//! Flat pieces by a hierarchy of boxes.

use super::Found;
use super::facets::Facets;
use crate::light::scene::Facet;
use crate::light::vector::Ray;

/// Finds the nearest of many facets.
#[derive(Debug)]
pub(super) struct Tree {
    all: Facets,
}

impl Tree {
    pub(super) fn new(facets: &[Facet]) -> Self {
        Self {
            all: Facets::new(facets),
        }
    }

    #[inline]
    pub(super) fn nearest(&self, ray: &Ray, limit: f64) -> Option<Found> {
        self.all.nearest(ray, limit)
    }
}
