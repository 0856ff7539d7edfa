//! Photons that go together: each takes its next step before any takes the one after it.
//!
//! So the rays of all are cast at once, a ray a lane of a register, and the directions of all are drawn at once. What a step is, photon by photon in
//! the order of paths, is the definition: the place where the ray arrives, the record, one random word for the fate, one more for the direction where the
//! photon goes on from a diffuse surface; other materials take the words for their direction before the one for the fate. `plain`, a test, is that
//! and nothing else, and gives the same bits.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::lamps::Given;
use super::words::Words;
use super::{Trace, Walk};
use crate::light::hits::{Record, folded};
use crate::light::ledger::Ledger;
use crate::light::material::{Material, cosine_direction_of};
use crate::light::ray::{Rays, Row, TOGETHER};
use crate::light::scene::{Chart, Scene, Shape};
use crate::light::spectrum::Spectrum;
use crate::light::vector::Vector;
use pulp::Simd;
use rand::Rng;
use std::ops::Range;

/// What a photon must know of a primitive, in one place.
#[derive(Debug)]
pub(super) struct Face<'s> {
    surface: usize,
    part: usize,
    shape: &'s Shape,
    material: &'s Material,
    reflectance: &'s Spectrum,
    clear: bool,
    diffuse: bool,
    /// The normal and the coordinates, where these do not take the shape's own way to find them.
    flat: Option<(Vector, Chart)>,
}

impl<'s> Face<'s> {
    /// Of all primitives of a scene.
    pub(super) fn all(scene: &'s Scene) -> Vec<Self> {
        let face = |(surface, part): (usize, usize)| {
            let about = &scene.surfaces()[surface];
            let material = &*about.material;
            Self {
                surface,
                part,
                shape: &about.shape,
                material,
                reflectance: material.reflectance(),
                clear: material.is_clear(),
                diffuse: material.is_diffuse(),
                flat: match &about.shape {
                    Shape::Planar(planar) => Some((planar.normal(), planar.chart())),
                    Shape::Sphere(_) | Shape::Mesh(_) => None,
                },
            }
        };
        scene.parts().map(face).collect()
    }
}

/// The vector at an index of three rows.
#[inline(always)]
fn of_rows([x, y, z]: &[Row; 3], at: usize) -> Vector {
    Vector::new(x[at], y[at], z[at])
}

/// Photons on their way, each at an index of all rows.
pub(super) struct Group<L> {
    rays: Rays,
    /// The normals of the surfaces that they leave.
    normal: [Row; 3],
    /// The words that tell directions about the normals.
    word: [u64; TOGETHER],
    /// Directions that are known without a word.
    known: Vec<(usize, Vector)>,
    light: Vec<L>,
    path: [u32; TOGETHER],
    /// The directions of arrival.
    arrival: [[i16; 2]; TOGETHER],
    /// Records in the order of steps, and how many each path has.
    records: Vec<Record>,
    lengths: [u32; TOGETHER],
}

impl<L: Given> Group<L> {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            rays: Rays::default(),
            normal: [[0.0; TOGETHER]; 3],
            word: [0; TOGETHER],
            known: Vec::new(),
            light: Vec::with_capacity(TOGETHER),
            path: [0; TOGETHER],
            arrival: [[0; 2]; TOGETHER],
            records: Vec::with_capacity(4 * TOGETHER),
            lengths: [0; TOGETHER],
        })
    }

    /// Follows photons from their lamps to their ends.
    #[inline(always)]
    pub(super) fn follow<S: Simd>(
        &mut self,
        simd: S,
        walk: &Walk<'_>,
        paths: Range<u64>,
        words: &mut Words,
        trace: &mut Trace,
    ) {
        let all = (paths.end - paths.start) as usize;
        let first = paths.start as u32;
        self.start(walk, first, all, words, &mut trace.ledger);
        let left = trace.ledger.left;
        let mut count = all;
        let mut bounce = 0;
        while count > 0 {
            if bounce == u16::MAX {
                trace.ledger.endless += self.light[..count].iter().map(L::power).sum::<f64>();
                break;
            }
            bounce += 1;
            trace.ledger.segments += count as u64;
            self.aim(count);
            walk.scene.caster().nearest_of(simd, &mut self.rays, count);
            self.move_on(count);
            count = self.step(walk, first, bounce, count, words, trace);
        }
        trace.ledger.ended += all as u64 - (trace.ledger.left - left);
        self.sort_out(first, all, &mut trace.records);
    }

    #[inline(always)]
    fn start(
        &mut self,
        walk: &Walk<'_>,
        first: u32,
        count: usize,
        words: &mut Words,
        ledger: &mut Ledger,
    ) {
        self.light.clear();
        self.known.clear();
        self.records.clear();
        self.lengths = [0; TOGETHER];
        for at in 0..count {
            let start = walk.lamps.start::<L>(walk.scene, walk.paths, words);
            for axis in 0..3 {
                self.rays.origin[axis][at] = start.origin[axis];
                self.normal[axis][at] = start.normal[axis];
            }
            self.rays.leaving[at] = f64::from(start.leaving);
            self.word[at] = words.next_u64();
            self.path[at] = first + at as u32;
            self.light.push(start.light);
            ledger.emitted += start.light.power();
        }
    }

    /// Directions.
    #[inline(always)]
    fn aim(&mut self, count: usize) {
        let count = count.min(TOGETHER);
        let [nx, ny, nz] = &self.normal;
        let [dx, dy, dz] = &mut self.rays.direction;
        for at in 0..count {
            let normal = Vector::new(nx[at], ny[at], nz[at]);
            let direction = cosine_direction_of(normal, self.word[at]);
            dx[at] = direction.x;
            dy[at] = direction.y;
            dz[at] = direction.z;
        }
        for (at, direction) in self.known.drain(..) {
            for axis in 0..3 {
                self.rays.direction[axis][at] = direction[axis];
            }
        }
    }

    /// To the places that the rays meet; those that meet nothing are nowhere.
    #[inline(always)]
    fn move_on(&mut self, count: usize) {
        let count = count.min(TOGETHER);
        let Rays {
            origin: [ox, oy, oz],
            direction: [dx, dy, dz],
            distance,
            ..
        } = &mut self.rays;
        for at in 0..count {
            ox[at] = dx[at].mul_add(distance[at], ox[at]);
            oy[at] = dy[at].mul_add(distance[at], oy[at]);
            oz[at] = dz[at].mul_add(distance[at], oz[at]);
            self.arrival[at] = folded(Vector::new(dx[at], dy[at], dz[at]));
        }
    }

    /// What happens to each where it arrives. Those that go on move up; how many they are.
    #[inline(always)]
    fn step(
        &mut self,
        walk: &Walk<'_>,
        first: u32,
        bounce: u16,
        count: usize,
        words: &mut Words,
        trace: &mut Trace,
    ) -> usize {
        let Trace { astray, ledger, .. } = trace;
        let (mut absorbed, mut roulette) = (0.0, 0.0);
        let mut kept = 0;
        self.records.reserve(count);
        for at in 0..count.min(TOGETHER) {
            let (light, path) = (self.light[at], self.path[at]);
            let number = self.rays.number[at];
            if number < 0.0 {
                ledger.escaped += light.power();
                ledger.left += 1;
                astray.push(path);
                continue;
            }
            let face = &walk.faces[number as u32 as usize];
            let place = of_rows(&self.rays.origin, at);
            let direction = of_rows(&self.rays.direction, at);
            let (normal, [u, v]) = match &face.flat {
                Some((normal, chart)) => (*normal, chart.coordinates(place)),
                None => (
                    face.shape.normal(face.part, place),
                    face.shape.raw_coordinates(face.part, place),
                ),
            };
            let front = direction.dot(&normal) < 0.0;
            if !(front || face.clear) {
                ledger.behind += light.power();
                astray.push(path);
                continue;
            }
            if front {
                let flux = if walk.returned {
                    light.reflected(face.reflectance, 1.0).flux()
                } else {
                    light.flux()
                };
                self.lengths[(path - first) as usize] += 1;
                self.records.push(Record::new(
                    [u, v],
                    flux,
                    (path, bounce),
                    (face.surface, face.part),
                    self.arrival[at],
                ));
            }
            let mut factor = 1.0;
            if !face.diffuse {
                let scattered = face.material.scatter(direction, normal, front, words);
                factor = scattered.factor;
                self.known.push((kept, scattered.direction));
            }
            let [chance, word] = words.next_two();
            let reflected = light.reflected(face.reflectance, factor);
            let fate = walk
                .power
                .decide(light, reflected, walk.first, Words::unit(chance));
            absorbed += fate.absorbed;
            roulette += fate.roulette;
            self.light[kept] = fate.light;
            self.path[kept] = path;
            self.word[kept] = word;
            self.rays.leaving[kept] = number;
            for axis in 0..3 {
                self.rays.origin[axis][kept] = place[axis];
                self.normal[axis][kept] = normal[axis];
            }
            words.take(1 + usize::from(fate.goes_on && face.diffuse));
            if !(face.diffuse || fate.goes_on) {
                self.known.pop();
            }
            kept += usize::from(fate.goes_on);
        }
        ledger.absorbed += absorbed;
        ledger.roulette += roulette;
        kept
    }

    /// Records in the order of paths.
    #[inline(always)]
    fn sort_out(&self, first: u32, count: usize, sorted: &mut Vec<Record>) {
        let Some(&any) = self.records.first() else {
            return;
        };
        let mut next = [0; TOGETHER];
        let mut end = sorted.len();
        for (next, &length) in next.iter_mut().zip(&self.lengths[..count]) {
            *next = end;
            end += length as usize;
        }
        sorted.resize(end, any);
        for record in &self.records {
            let next = &mut next[(record.path - first) as usize];
            sorted[*next] = *record;
            *next += 1;
        }
    }
}
