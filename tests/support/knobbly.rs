//! A mesh that casters are tested and timed with.

use density_lab::light::material::{Lambertian, Material};
use density_lab::light::scene::{Mesh, Shape, Surface};
use density_lab::light::spectrum::Spectrum;
use density_lab::light::vector::Vector;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A knobbly ball of some 2 × 84 × 84 triangles that fits into the Cornell box in three colours.
pub fn ball() -> Surface {
    const STEPS: u32 = 84;
    let corner = |i: u32, j: u32| {
        let theta = PI * f64::from(i) / f64::from(STEPS);
        let phi = TAU * f64::from(j % STEPS) / f64::from(STEPS);
        let radius = 0.5 + 0.05 * (7.0 * theta).sin() * (9.0 * phi).cos();
        let direction = Vector::new(
            theta.sin() * phi.cos(),
            theta.cos(),
            theta.sin() * phi.sin(),
        );
        direction * radius - Vector::new(0.0, 0.3, 0.0)
    };
    let mut triangles = Vec::new();
    for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
        let [a, b, c, d] =
            [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)].map(|(i, j)| corner(i, j));
        // at the poles one of the two has no area
        if i > 0 {
            triangles.push([a, b, c]);
        }
        if i + 1 < STEPS {
            triangles.push([a, c, d]);
        }
    }
    Surface {
        name: "ball".to_owned(),
        shape: Shape::Mesh(Mesh::new(&triangles).expect("a mesh")),
        material: Arc::new(Material::Lambertian(Lambertian {
            reflectance: Spectrum::Flat(0.7),
        })),
        emission: None,
    }
}
