//! Rooms: surfaces with shapes, materials and emission, and what rays meet in them.
//!
//! | file | what |
//! |---|---|
//! | `shape/` | quads, triangles, spheres, meshes, and the charts that number their points |
//! | `read` | TOML → scene, or every problem of the file |
//!
//! Surfaces have a front, on which they reflect and emit; their back absorbs everything, unless they are clear.

mod object;
pub mod read;
pub mod shape;

pub use shape::{Chart, Facet, Mesh, Planar, Shape, Sphere};

use super::emission::Emission;
use super::material::Material;
use super::ray::{Caster, Found};
use super::spectrum::Colour;
use super::vector::{Ray, Vector};
use crate::space::Domain;
use std::sync::Arc;

/// One named piece of a scene.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its name, unique in the scene.
    pub name: String,
    /// What it looks like.
    pub shape: Shape,
    /// What its front does to light.
    pub material: Arc<Material>,
    /// How its front shines.
    pub emission: Option<Emission>,
}

impl Surface {
    /// The area of the front.
    pub fn area(&self) -> f64 {
        self.shape.area()
    }

    /// Where (u, v) live; `None` for a mesh.
    pub fn domain(&self) -> Option<&Domain<2>> {
        self.shape.domain()
    }
}

/// From where a scene is looked at, as it says itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands.
    pub position: Vector,
    /// Where it looks, of length 1.
    pub direction: Vector,
    /// Up, of length 1 and perpendicular to the direction.
    pub up: Vector,
    /// The angle between the left and the right edge of a square picture, in degrees.
    pub field_of_view: f64,
}

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The position of the surface in the scene.
    pub surface: usize,
    /// The number of the facet or sphere in the scene, for [`Ray::leaving`].
    pub primitive: u32,
    /// How far along the ray.
    pub distance: f64,
    /// The place.
    pub place: Vector,
    /// The first coordinate on the surface, see [`shape`].
    pub u: f64,
    /// The second coordinate on the surface.
    pub v: f64,
    /// The direction in which the front of the surface looks, of length 1.
    pub normal: Vector,
    /// Whether the ray arrives at the front.
    pub front: bool,
}

/// Why surfaces make no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// Nothing there.
    #[error("a scene needs at least one surface")]
    Empty,
    /// Two surfaces of one name.
    #[error("two surfaces are named \"{0}\"")]
    Name(String),
    /// More than hits can tell apart.
    #[error("{0} surfaces; a scene has at most 65535, and meshes for more")]
    Many(usize),
    /// Nothing shines.
    #[error("no surface emits light")]
    Dark,
}

/// Surfaces in space. Always true: at least one surface, all names different, at least one emits.
#[derive(Debug)]
pub struct Scene {
    /// What it is, in words; may be empty.
    pub title: String,
    /// The name of the unit of length.
    pub unit: String,
    /// How it knows colour.
    pub colour: Colour,
    /// Whether light may leave it; if not, escaping light is a leak.
    pub open: bool,
    /// From where it is looked at.
    pub camera: Option<Camera>,
    surfaces: Vec<Surface>,
    /// Surface and part of each primitive.
    primitives: Vec<(u32, u32)>,
    caster: Caster,
}

impl Scene {
    /// A scene of these surfaces; O(facets log facets).
    ///
    /// # Errors
    /// If there are none, two have the same name, or none emits.
    pub fn new(surfaces: Vec<Surface>, colour: Colour, open: bool) -> Result<Self, SceneError> {
        if surfaces.is_empty() {
            return Err(SceneError::Empty);
        }
        if surfaces.len() > usize::from(u16::MAX) {
            return Err(SceneError::Many(surfaces.len()));
        }
        for (index, surface) in surfaces.iter().enumerate() {
            if surfaces[..index].iter().any(|s| s.name == surface.name) {
                return Err(SceneError::Name(surface.name.clone()));
            }
        }
        let shines = |surface: &Surface| {
            surface
                .emission
                .as_ref()
                .is_some_and(|emission| !emission.radiance.is_black())
        };
        if !surfaces.iter().any(shines) {
            return Err(SceneError::Dark);
        }
        let mut primitives = Vec::new();
        let mut facets = Vec::new();
        let mut spheres = Vec::new();
        for (index, surface) in surfaces.iter().enumerate() {
            for (part, facet) in surface.shape.facets().iter().enumerate() {
                primitives.push((index as u32, part as u32));
                facets.push(*facet);
            }
        }
        for (index, surface) in surfaces.iter().enumerate() {
            if let Shape::Sphere(sphere) = &surface.shape {
                primitives.push((index as u32, 0));
                spheres.push(sphere.clone());
            }
        }
        Ok(Self {
            title: String::new(),
            unit: "scene units".to_owned(),
            colour,
            open,
            camera: None,
            surfaces,
            primitives,
            caster: Caster::new(&facets, spheres),
        })
    }

    /// The surfaces in the order of the file.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The surface of that name, and its position.
    pub fn surface(&self, name: &str) -> Option<(usize, &Surface)> {
        self.surfaces
            .iter()
            .enumerate()
            .find(|(_, surface)| surface.name == name)
    }

    /// The number of the primitive that is a part of a surface: facet `part`, or the sphere. O(log primitives) but for spheres.
    pub fn primitive(&self, surface: usize, part: usize) -> Option<u32> {
        let wanted = (surface as u32, part as u32);
        let facets = &self.primitives[..self.caster.facets()];
        if let Ok(at) = facets.binary_search(&wanted) {
            return Some(at as u32);
        }
        self.primitives
            .iter()
            .position(|&primitive| primitive == wanted)
            .map(|at| at as u32)
    }

    /// The surface and the part of it that each primitive is, in their order.
    pub fn parts(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.primitives.len()).map(|primitive| self.part(primitive as u32))
    }

    /// The surface and the part of it that a primitive is.
    #[inline]
    pub fn part(&self, primitive: u32) -> (usize, usize) {
        let (surface, part) = self.primitives[primitive as usize];
        (surface as usize, part as usize)
    }

    /// What rays meet, without what it means.
    pub fn caster(&self) -> &Caster {
        &self.caster
    }

    /// The first thing that a ray meets, front or back.
    pub fn hit(&self, ray: &Ray) -> Option<Hit> {
        Some(self.describe(ray, self.caster.nearest(ray, f64::INFINITY)?))
    }

    /// The first front that a ray meets: backs are transparent, as for a camera outside a room. Clear surfaces count from both sides.
    pub fn seen(&self, ray: &Ray) -> Option<Hit> {
        let mut ray = *ray;
        let mut passed = 0.0;
        // a ray passes each primitive's back at most once, a sphere's twice
        for _ in 0..=2 * self.primitives.len() {
            let mut hit = self.hit(&ray)?;
            if hit.front || self.surfaces[hit.surface].material.is_clear() {
                hit.distance += passed;
                return Some(hit);
            }
            passed += hit.distance;
            ray = Ray {
                origin: hit.place,
                leaving: Some(hit.primitive),
                ..ray
            };
        }
        None
    }

    /// Whether nothing stands between two places, which may lie on surfaces: what is met within 1e-9 of the distance from either is the surface
    /// that the place is on.
    pub fn visible(&self, from: Vector, to: Vector) -> bool {
        const NEAR: f64 = 1e-9;
        let between = to - from;
        let distance = between.norm();
        if distance <= 0.0 {
            return true;
        }
        let direction = between / distance;
        let ray = Ray::new(from + direction * (NEAR * distance), direction);
        self.caster
            .nearest(&ray, distance * (1.0 - 2.0 * NEAR))
            .is_none()
    }

    /// What was found, with its place on the surface.
    #[inline]
    pub fn describe(&self, ray: &Ray, found: Found) -> Hit {
        let (surface, part) = self.part(found.primitive);
        let shape = &self.surfaces[surface].shape;
        let place = ray.at(found.distance);
        let normal = shape.normal(part, place);
        let [u, v] = shape.coordinates(part, place);
        Hit {
            surface,
            primitive: found.primitive,
            distance: found.distance,
            place,
            u,
            v,
            normal,
            front: ray.direction.dot(&normal) < 0.0,
        }
    }
}
