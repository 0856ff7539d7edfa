//! Casters against another program: the shapes and ray casts of the parry3d crate, over shipped scenes and a mesh of 14 000 triangles.
#![allow(clippy::unwrap_used)]

#[path = "support/knobbly.rs"]
mod knobbly;

use density_lab::light::scene::{Scene, Shape, read};
use density_lab::light::spectrum::Colour;
use density_lab::light::vector::{Ray, Vector};
use density_lab::random::stream;
use knobbly::ball;
use parry3d_f64::query::{Ray as TheirRay, RayCast};
use parry3d_f64::shape::{Ball, TriMesh};
use rand::RngExt;
use std::path::Path;

type Theirs = parry3d_f64::math::Vector;

fn theirs(v: Vector) -> Theirs {
    Theirs::new(v.x, v.y, v.z)
}

/// A scene in their shapes, moved a little.
struct Other {
    mesh: TriMesh,
    balls: Vec<(Vector, Ball)>,
}

impl Other {
    fn of(scene: &Scene, moved: f64) -> Self {
        let (mut corners, mut triangles, mut balls) = (Vec::new(), Vec::new(), Vec::new());
        for surface in scene.surfaces() {
            if let Shape::Sphere(sphere) = &surface.shape {
                balls.push((sphere.centre(), Ball::new(sphere.radius() + moved)));
            }
            for facet in surface.shape.facets() {
                let first = corners.len() as u32;
                let all = facet.corners();
                corners.extend(all.iter().map(|c| theirs(c.add_scalar(moved))));
                for last in 2..all.len() as u32 {
                    triangles.push([first, first + last - 1, first + last]);
                }
            }
        }
        Self {
            mesh: TriMesh::new(corners, triangles).unwrap(),
            balls,
        }
    }

    /// How far it is to what is nearest, seen from either side.
    fn nearest(&self, ray: &Ray) -> Option<f64> {
        const FAR: f64 = 1e9;
        let cast = TheirRay::new(theirs(ray.origin), theirs(ray.direction));
        let flat = self.mesh.cast_local_ray(&cast, FAR, false);
        let round = self.balls.iter().filter_map(|(centre, ball)| {
            let cast = TheirRay::new(theirs(ray.origin - centre), theirs(ray.direction));
            ball.cast_local_ray(&cast, FAR, false)
        });
        round.chain(flat).reduce(f64::min)
    }
}

/// The share of the rays that meet something for which both find the same.
fn agreement(scene: &Scene, moved: f64) -> f64 {
    const RAYS: usize = 20_000;
    let facets = scene.surfaces().iter().flat_map(|s| s.shape.facets());
    let corners: Vec<Vector> = facets
        .flat_map(density_lab::light::scene::Facet::corners)
        .collect();
    let size = corners.iter().map(Vector::norm).fold(1.0, f64::max);
    let other = Other::of(scene, moved * size);
    let middle = corners.iter().sum::<Vector>() / corners.len().max(1) as f64;
    let mut random = stream(9, "rays", 0);
    let (mut met, mut agree) = (0, 0);
    for _ in 0..RAYS {
        let mut vector = || Vector::from_fn(|_, _| random.random::<f64>() - 0.5);
        let ray = Ray::new(middle + vector() * size, vector().normalize());
        let ours = scene.caster().nearest(&ray, f64::INFINITY);
        let theirs = other.nearest(&ray);
        met += usize::from(ours.is_some() || theirs.is_some());
        let both = ours.zip(theirs);
        let same = both.is_some_and(|(ours, far)| (ours.distance - far).abs() < 1e-9 * size);
        agree += usize::from(same);
    }
    assert!(met > RAYS / 4, "{met} rays met anything");
    f64::from(agree as u32) / f64::from(met as u32)
}

fn shipped(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    read::scene(&folder.join(name)).unwrap()
}

/// The box in three colours with a knobbly ball in it.
fn knobbly() -> Scene {
    let mut surfaces = shipped("cornell-box-rgb-empty.toml").surfaces().to_vec();
    surfaces.push(ball());
    Scene::new(surfaces, Colour::Rgb, false).unwrap()
}

/// But for rays through an edge, which one of the two may lose; a millionth of the size is noticed.
#[test]
fn rays_meet_what_parry_says_they_meet() {
    let shipped = [
        "cornell-box.toml",
        "cornell-box-rgb.toml",
        "sphere.toml",
        "lamp-over-floor.toml",
    ]
    .map(|name| (name, shipped(name)));
    for (name, scene) in shipped.into_iter().chain([("a mesh", knobbly())]) {
        let share = agreement(&scene, 0.0);
        assert!(share >= 0.9995, "{name}: {share}");
        let share = agreement(&scene, 1e-6);
        assert!(share < 0.1, "{name}, moved: {share}");
    }
}
