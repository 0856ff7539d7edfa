//! Irradiance from the reference.

use super::{Returned, Spot};
use crate::light::reference::Reference;
use rayon::prelude::*;

impl Returned for Reference {
    fn at(&self, spots: &[Spot]) -> Vec<[f64; 3]> {
        // solved once before all threads want it
        self.solved();
        spots
            .par_iter()
            .map(|spot| {
                spot.returned(self.irradiance_in_space(
                    (spot.place, spot.normal),
                    Some(spot.primitive),
                    (spot.surface, spot.chart),
                ))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Reference, Returned, Spot};
    use crate::light::emission::Emission;
    use crate::light::material::{Lambertian, Material};
    use crate::light::scene::{Mesh, Planar, Scene, Shape, Surface};
    use crate::light::spectrum::{Colour, Spectrum};
    use crate::light::vector::Vector;
    use std::sync::Arc;

    /// A small lamp over a corner of a square: as a mesh the square has the same light as in one piece, on each of its triangles.
    #[test]
    fn facets_of_a_mesh_have_light_of_their_own() {
        const PLACES: [[f64; 2]; 4] = [[0.7, 0.1], [0.1, 0.7], [0.9, 0.8], [0.8, 0.9]];
        let square = |low: f64, high: f64, z: f64| {
            [[low, low], [high, low], [high, high], [low, high]].map(|[x, y]| Vector::new(x, y, z))
        };
        let surface = |name: &str, shape, shines: bool| Surface {
            name: name.to_owned(),
            shape,
            material: Arc::new(Material::Lambertian(Lambertian {
                reflectance: Spectrum::Flat(0.5),
            })),
            emission: shines.then_some(Emission {
                radiance: Spectrum::Flat(1.0),
            }),
        };
        let light = |floor: Shape| {
            let mut down = square(0.0, 0.2, 0.5);
            down.reverse();
            let lamp = Shape::Planar(Planar::new(&down, None).expect("a quad"));
            let surfaces = vec![surface("lamp", lamp, true), surface("floor", floor, false)];
            let scene = Scene::new(surfaces, Colour::Rgb, true).expect("a scene");
            let spots = PLACES.map(|[x, y]| {
                let part = usize::from(y > x);
                Spot {
                    surface: 1,
                    primitive: scene
                        .primitive(1, part)
                        .or(scene.primitive(1, 0))
                        .expect("one"),
                    place: Vector::new(x, y, 0.0),
                    normal: Vector::new(0.0, 0.0, 1.0),
                    chart: [0.3, 0.3],
                    reflectance: [1.0; 3],
                }
            });
            let reference = Reference::new(Arc::new(scene));
            let found = reference.at(&spots);
            // in one piece a place is known by its coordinates alone
            let known = PLACES.map(|place| reference.irradiance(1, place)[0]);
            (
                known,
                found.iter().map(|light| light[0]).collect::<Vec<f64>>(),
            )
        };
        let [a, b, c, d] = square(0.0, 1.0, 0.0);
        let mesh = Mesh::new(&[[a, b, c], [a, c, d]]).expect("a mesh");
        let (whole, _) = light(Shape::Planar(
            Planar::new(&[a, b, c, d], None).expect("a quad"),
        ));
        let (_, parts) = light(Shape::Mesh(mesh));
        for (whole, part) in whole.iter().zip(&parts) {
            assert!((part / whole - 1.0).abs() < 2e-3, "{whole} {part}");
        }
        // the lamp is symmetric about the diagonal, and nearer to some places
        assert!((parts[0] / parts[1] - 1.0).abs() < 2e-3 && parts[0] > 1.5 * parts[2]);
    }
}
