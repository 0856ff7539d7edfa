//! What a camera sees.

use super::{Returned, Spot};
use crate::light::camera::Film;
use crate::light::cie;
use crate::light::image::Image;
use crate::light::scene::Scene;
use crate::light::spectrum::Colour;
use crate::light::vector::Ray;
use crate::random;
use rayon::prelude::*;

/// Where one ray of the camera ended, and what it passed on the way.
#[derive(Clone, Copy, Debug)]
struct Sight {
    /// Radiosity of lamps on the way.
    shine: [f64; 3],
    /// The diffuse surface at the end, and the factor from what it returns to what the camera sees.
    end: Option<(Spot, [f64; 3])>,
}

/// All rays of a picture, followed once; whatever knows the light ([`Returned`]) can light them.
pub struct Shot {
    width: usize,
    height: usize,
    /// Rays for each pixel.
    rays: usize,
    colour: Colour,
    sights: Vec<Sight>,
}

/// Bytes of memory for each ray of a picture: a sight takes 150, and its light and place as much again.
pub const SIGHT_BYTES: u64 = 400;
/// Mirrors and clear surfaces that a ray of the camera passes at most.
const BOUNCES: usize = 32;

impl Shot {
    /// Follows `across`² rays for each pixel through mirrors and clear surfaces, where a surface that reflects and refracts draws one of the two.
    pub fn take(scene: &Scene, film: &Film, across: usize, seed: u64) -> Self {
        let across = across.max(1);
        let (width, height) = (film.width(), film.height());
        let sights = (0..width * height)
            .into_par_iter()
            .flat_map_iter(|pixel| {
                let mut random = random::stream(seed, "camera", pixel as u64);
                let (column, row) = (pixel % width, pixel / width);
                let rays = (0..across * across).map(move |i| {
                    let part = |i: usize| (i as f64 + 0.5) / across as f64;
                    let x = column as f64 + part(i % across);
                    let y = row as f64 + part(i / across);
                    follow(scene, film.ray(x, y), &mut random)
                });
                rays.collect::<Vec<_>>()
            })
            .collect();
        Self {
            width,
            height,
            rays: across * across,
            colour: scene.colour,
            sights,
        }
    }

    /// How many places want light.
    pub fn spots(&self) -> usize {
        self.sights
            .iter()
            .filter(|sight| sight.end.is_some())
            .count()
    }

    /// The picture in this light: the radiosity (π times the radiance) that each pixel sees, in linear sRGB where colour is known by wavelength. What mirrors
    /// and glass do to a colour by wavelength is taken by its mean.
    pub fn lit_by(&self, light: &dyn Returned) -> Image {
        let ends = self.sights.iter().filter_map(|sight| sight.end);
        let spots: Vec<Spot> = ends.map(|(spot, _)| spot).collect();
        let mut returned = light.at(&spots).into_iter();
        let pixels = self.sights.chunks_exact(self.rays).map(|rays| {
            let mut sum = [0.0; 3];
            for sight in rays {
                for c in 0..3 {
                    sum[c] += sight.shine[c];
                }
                if let Some((_, factor)) = sight.end
                    && let Some(returned) = returned.next()
                {
                    for c in 0..3 {
                        sum[c] += factor[c] * returned[c];
                    }
                }
            }
            let mean = sum.map(|value| value / self.rays as f64);
            let shown = match self.colour {
                Colour::Rgb => mean,
                Colour::Spectral => cie::linear_srgb(mean),
            };
            shown.map(|value| value as f32)
        });
        Image::new(self.width, self.height, pixels.collect())
    }
}

fn follow(scene: &Scene, mut ray: Ray, random: &mut random::Stream) -> Sight {
    let mut sight = Sight {
        shine: [0.0; 3],
        end: None,
    };
    let mut carried = [1.0; 3];
    for _ in 0..BOUNCES {
        let Some(hit) = scene.seen(&ray) else {
            return sight;
        };
        let surface = &scene.surfaces()[hit.surface];
        if let Some(emission) = surface.emission.as_ref().filter(|_| hit.front) {
            let exitance = match scene.colour {
                Colour::Rgb => emission.exitance(),
                Colour::Spectral => emission.tristimulus(),
            };
            for (c, m) in exitance.into_iter().enumerate() {
                sight.shine[c] += carried[c] * m;
            }
        }
        let reflectance = surface.material.reflectance().rgb();
        if surface.material.is_diffuse() {
            let spot = Spot {
                surface: hit.surface,
                primitive: hit.primitive,
                place: hit.place,
                normal: hit.normal,
                chart: [hit.u, hit.v],
                reflectance,
            };
            sight.end = Some((spot, carried));
            return sight;
        }
        let scattered = surface
            .material
            .scatter(ray.direction, hit.normal, hit.front, random);
        for (carried, reflectance) in carried.iter_mut().zip(reflectance) {
            *carried *= reflectance * scattered.factor;
        }
        if carried.iter().all(|&c| c <= 0.0) {
            return sight;
        }
        ray = Ray {
            origin: hit.place,
            direction: scattered.direction,
            leaving: Some(hit.primitive),
        };
    }
    sight
}
