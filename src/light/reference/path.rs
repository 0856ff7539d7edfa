//! Irradiance by tracing paths from the surface that receives it, against the light: for any scene, with standard errors.
//!
//! From a place a path collects the light of lamps in two ways, by a ray towards a point of a lamp and by the ray with which it goes on, and
//! weighs them by the balance of their densities. Unbiased in each channel; nothing is shared with the walk of the photons but rays and materials.
//!
//! # References
//! Kajiya 1986; Veach & Guibas 1995, eq. 9 (the balance heuristic); Arvo & Kirk 1990 (roulette).

use crate::light::material::cosine_direction;
use crate::light::scene::{Hit, Scene};
use crate::light::spectrum::Colour;
use crate::light::vector::{Ray, Vector};
use crate::numeric::Sum;
use crate::random::{Stream, open_unit};
use std::f64::consts::PI;

/// Something that shines.
struct Lamp {
    surface: usize,
    /// Radiance in each channel.
    radiance: [f64; 3],
    /// The probability per area of drawing one of its points.
    density: f64,
}

/// Traces paths in a scene.
pub struct PathTracer<'s> {
    scene: &'s Scene,
    lamps: Vec<Lamp>,
    /// The probability of drawing each lamp or one before it.
    until: Vec<f64>,
    /// The lamp that each surface is.
    lamp: Vec<Option<usize>>,
}

/// A mean of independent draws in three channels with its standard errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The mean.
    pub mean: [f64; 3],
    /// Its standard error; infinite for a single draw.
    pub error: [f64; 3],
    /// How many draws.
    pub draws: usize,
}

impl Measured {
    /// From `draws` draws.
    pub fn of(draws: usize, mut draw: impl FnMut() -> [f64; 3]) -> Self {
        let mut sums = [[Sum::default(); 2]; 3];
        for _ in 0..draws {
            for (sum, value) in sums.iter_mut().zip(draw()) {
                sum[0].add(value);
                sum[1].add(value * value);
            }
        }
        let n = draws as f64;
        let mean = sums.map(|[sum, _]| sum.value() / n);
        let error = [0, 1, 2].map(|c: usize| {
            let variance = (sums[c][1].value() / n - mean[c] * mean[c]).max(0.0);
            (variance / (n - 1.0)).sqrt()
        });
        Self { mean, error, draws }
    }
}

/// Where a path stands: a small diffuse surface that waits for light.
#[derive(Clone, Copy)]
struct Stand {
    place: Vector,
    normal: Vector,
    primitive: Option<u32>,
}

/// Bounces after which roulette begins.
const SAFE: u32 = 3;
/// Bounces after which a path ends in any case: only clear or mirrored cages get there.
const LAST: u32 = 10_000;

impl<'s> PathTracer<'s> {
    /// For a scene in three channels; `None` for one that knows colour by wavelength.
    pub fn new(scene: &'s Scene) -> Option<Self> {
        if scene.colour != Colour::Rgb {
            return None;
        }
        let mut lamps = Vec::new();
        let mut lamp = vec![None; scene.surfaces().len()];
        let mut powers = Vec::new();
        for (surface, described) in scene.surfaces().iter().enumerate() {
            let Some(emission) = &described.emission else {
                continue;
            };
            let power = emission.exitance().iter().sum::<f64>() * described.area();
            if power > 0.0 {
                lamp[surface] = Some(lamps.len());
                powers.push(power);
                lamps.push(Lamp {
                    surface,
                    radiance: emission.radiance.rgb(),
                    density: power / described.area(),
                });
            }
        }
        let total: f64 = powers.iter().sum();
        let mut sum = 0.0;
        let until = powers.iter().map(|power| {
            sum += power / total;
            sum
        });
        let until = until.collect();
        for lamp in &mut lamps {
            lamp.density /= total;
        }
        Some(Self {
            scene,
            lamps,
            until,
            lamp,
        })
    }

    /// One unbiased draw of the irradiance on the front of a small surface; `primitive` is the one that the place is on.
    pub fn irradiance(
        &self,
        place: Vector,
        normal: Vector,
        primitive: Option<u32>,
        random: &mut Stream,
    ) -> [f64; 3] {
        let mut stand = Stand {
            place,
            normal,
            primitive,
        };
        let mut carried = [1.0; 3];
        let mut sum = [0.0; 3];
        for bounce in 0..LAST {
            let direct = self.towards_a_lamp(&stand, random);
            add(&mut sum, carried, direct);
            let direction = cosine_direction(stand.normal, open_unit(random), open_unit(random));
            let ray = Ray {
                origin: stand.place,
                direction,
                leaving: stand.primitive,
            };
            let density = stand.normal.dot(&direction) / PI;
            let Some(next) = self.follow(ray, Some(density), &mut carried, &mut sum, random) else {
                return sum;
            };
            stand = next;
            if bounce >= SAFE && !roulette(&mut carried, random) {
                return sum;
            }
        }
        sum
    }

    /// One unbiased draw of π times the radiance that comes back along a ray, as seen by an eye: backs of surfaces are not seen.
    pub fn radiosity(&self, ray: Ray, random: &mut Stream) -> [f64; 3] {
        let (mut carried, mut sum) = ([1.0; 3], [0.0; 3]);
        let Some(hit) = self.scene.seen(&ray) else {
            return sum;
        };
        let Some(stand) = self.arrive(ray, hit, None, &mut carried, &mut sum, random) else {
            return sum;
        };
        let irradiance = self.irradiance(stand.place, stand.normal, stand.primitive, random);
        add(&mut sum, carried, irradiance);
        sum
    }

    /// Irradiance by a ray to a point of a lamp.
    fn towards_a_lamp(&self, stand: &Stand, random: &mut Stream) -> [f64; 3] {
        let (which, choice) = (open_unit(random), open_unit(random));
        let (s, t) = (open_unit(random), open_unit(random));
        let Some(lamp) = self.lamps.get(self.until.partition_point(|&p| p <= which)) else {
            return [0.0; 3];
        };
        let shape = &self.scene.surfaces()[lamp.surface].shape;
        let (part, place) = shape.draw(choice, s, t);
        let between = place - stand.place;
        let square = between.norm_squared();
        let direction = between / square.sqrt();
        let cosine = stand.normal.dot(&direction);
        let there = -shape.normal(part, place).dot(&direction);
        if !(cosine > 0.0 && there > 0.0 && self.scene.visible(stand.place, place)) {
            return [0.0; 3];
        }
        let density = lamp.density * square / there;
        let weight = density / (density + cosine / PI);
        lamp.radiance.map(|l| weight * l * cosine / density)
    }

    /// Follows a ray to the next diffuse surface, taking the light of lamps on the way. `density` is the probability per solid angle with which the
    /// ray was drawn where a lamp could have been drawn instead.
    fn follow(
        &self,
        ray: Ray,
        density: Option<f64>,
        carried: &mut [f64; 3],
        sum: &mut [f64; 3],
        random: &mut Stream,
    ) -> Option<Stand> {
        let hit = self.scene.hit(&ray)?;
        self.arrive(ray, hit, density, carried, sum, random)
    }

    fn arrive(
        &self,
        mut ray: Ray,
        mut hit: Hit,
        mut density: Option<f64>,
        carried: &mut [f64; 3],
        sum: &mut [f64; 3],
        random: &mut Stream,
    ) -> Option<Stand> {
        for _ in 0..LAST {
            let surface = &self.scene.surfaces()[hit.surface];
            if !hit.front && !surface.material.is_clear() {
                return None;
            }
            if let Some(lamp) = self.lamp[hit.surface].filter(|_| hit.front) {
                let lamp = &self.lamps[lamp];
                let there = -hit.normal.dot(&ray.direction);
                let weight = density.map_or(1.0, |density| {
                    let other = lamp.density * hit.distance * hit.distance / there;
                    density / (density + other)
                });
                add(sum, *carried, lamp.radiance.map(|l| PI * weight * l));
            }
            let reflectance = surface.material.reflectance().rgb();
            if surface.material.is_diffuse() {
                scale(carried, reflectance);
                return Some(Stand {
                    place: hit.place,
                    normal: hit.normal,
                    primitive: Some(hit.primitive),
                });
            }
            let scattered = surface
                .material
                .scatter(ray.direction, hit.normal, hit.front, random);
            scale(carried, reflectance.map(|r| r * scattered.factor));
            if carried.iter().all(|&c| c <= 0.0) || !roulette(carried, random) {
                return None;
            }
            ray = Ray {
                origin: hit.place,
                direction: scattered.direction,
                leaving: Some(hit.primitive),
            };
            density = None;
            hit = self.scene.hit(&ray)?;
        }
        None
    }
}

fn add(sum: &mut [f64; 3], carried: [f64; 3], light: [f64; 3]) {
    for c in 0..3 {
        sum[c] += carried[c] * light[c];
    }
}

fn scale(carried: &mut [f64; 3], factor: [f64; 3]) {
    for c in 0..3 {
        carried[c] *= factor[c];
    }
}

/// Ends a path with a probability that its strongest channel decides, and strengthens it otherwise: each channel keeps its mean.
fn roulette(carried: &mut [f64; 3], random: &mut Stream) -> bool {
    let strongest = carried.iter().copied().fold(0.0, f64::max);
    if strongest >= 1.0 {
        return true;
    }
    if open_unit(random) >= strongest {
        return false;
    }
    for c in carried {
        *c /= strongest;
    }
    true
}
