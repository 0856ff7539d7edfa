//! The walk as it is defined: photon by photon, with single rays and plain random numbers. The walk that is used must give the same bits.

use super::carried::{Channels, Wave};
use super::lamps::Given;
use super::*;
use crate::light::material::{Material, cosine_direction_of};
use crate::light::scene::read;
use crate::light::vector::{Ray, Vector};
use crate::random::Stream;
use pulp::Scalar;
use rand::{Rng, RngExt};
use std::path::Path;

struct Photon<L> {
    path: u32,
    ray: Ray,
    light: L,
}

/// One step of a photon: where it is then, if it goes on.
fn step<L: Given>(
    walk: &Walk<'_>,
    photon: &Photon<L>,
    bounce: u16,
    random: &mut Stream,
    records: &mut Vec<Record>,
) -> Option<Photon<L>> {
    let Photon { path, ray, light } = photon;
    let found = walk.scene.caster().nearest(ray, f64::INFINITY)?;
    let (surface, part) = walk.scene.part(found.primitive);
    let about = &walk.scene.surfaces()[surface];
    let (o, d, t) = (ray.origin, ray.direction, found.distance);
    let place = Vector::new(
        d.x.mul_add(t, o.x),
        d.y.mul_add(t, o.y),
        d.z.mul_add(t, o.z),
    );
    let normal = about.shape.normal(part, place);
    let front = d.dot(&normal) < 0.0;
    if !front && !about.material.is_clear() {
        return None;
    }
    if front {
        records.push(Record::new(
            about.shape.raw_coordinates(part, place),
            light.flux(),
            (*path, bounce),
            (surface, part),
            crate::light::hits::folded(d),
        ));
    }
    let other = match &*about.material {
        Material::Lambertian(_) => None,
        other => Some(other.scatter(d, normal, front, random)),
    };
    let factor = other.map_or(1.0, |scattered| scattered.factor);
    let reflected = light.reflected(about.material.reflectance(), factor);
    let fate = walk
        .power
        .decide(*light, reflected, walk.first, random.random());
    let direction = match other {
        _ if !fate.goes_on => return None,
        Some(scattered) => scattered.direction,
        None => cosine_direction_of(normal, random.next_u64()),
    };
    Some(Photon {
        path: *path,
        ray: Ray {
            origin: place,
            direction,
            leaving: Some(found.primitive),
        },
        light: fate.light,
    })
}

/// What is added to a furnace.
const CAUSTIC: &str = r#"
[material.glass]
dielectric = { index = 1.5 }
[material.silver]
mirror = { reflectance = 0.9 }
[material.gloss]
phong = { reflectance = 0.8, exponent = 20.0 }
[[surface]]
name = "glass"
material = "glass"
sphere = { centre = [0.3, 0.3, 0.4], radius = 0.2 }
[[surface]]
name = "silver"
material = "silver"
sphere = { centre = [0.75, 0.7, 0.6], radius = 0.15 }
[[surface]]
name = "gloss"
material = "gloss"
triangle = { corners = [[0.1, 0.5, 0.9], [0.5, 0.8, 0.9], [0.4, 0.9, 0.2]] }
"#;

fn plain<L: Given>(walk: &Walk<'_>, block: u64) -> Vec<Record> {
    let mut random = stream(walk.seed, "photon", block);
    let mut records = Vec::new();
    let (first, last) = (block * BLOCK, ((block + 1) * BLOCK).min(walk.paths));
    for group in (first..last).step_by(TOGETHER) {
        let mut photons: Vec<Photon<L>> = (group..(group + TOGETHER as u64).min(last))
            .map(|path| {
                let start = walk.lamps.start::<L>(walk.scene, walk.paths, &mut random);
                Photon {
                    path: path as u32,
                    ray: Ray {
                        origin: start.origin,
                        direction: cosine_direction_of(start.normal, random.next_u64()),
                        leaving: Some(start.leaving),
                    },
                    light: start.light,
                }
            })
            .collect();
        let mut bounce = 0;
        while !photons.is_empty() {
            bounce += 1;
            photons = photons
                .iter()
                .filter_map(|photon| step(walk, photon, bounce, &mut random, &mut records))
                .collect();
        }
    }
    records.sort_by_key(|record| (record.path, record.bounce));
    records
}

#[test]
fn photons_that_go_together_do_what_each_does_alone() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    let attenuated = Power::Attenuated {
        threshold: 0.1,
        kill: 0.5,
    };
    // quads in right corners and others, spheres that are mirrors and glass, colours and wavelengths; a last group that is not full
    for (name, power) in [
        ("cornell-box-rgb.toml", Power::Same),
        ("cornell-box-rgb.toml", attenuated),
        ("cornell-box.toml", Power::Same),
        ("caustic", Power::Same),
        ("sphere.toml", attenuated),
    ] {
        let scene = match name {
            "caustic" => {
                let path = folder.join("furnace.toml");
                let room = std::fs::read_to_string(&path).expect("readable");
                read::scene_text(&format!("{room}{CAUSTIC}"), &path)
            }
            shipped => read::scene(&folder.join(shipped)),
        };
        let scene = scene.expect("a scene");
        let walk = Walk::new(&scene, power, BLOCK + 1000, 3).expect("a walk");
        for block in 0..2 {
            let (plain, scalar) = match scene.colour {
                Colour::Rgb => (
                    plain::<Channels>(&walk, block),
                    Task::<Channels>::new(&walk, block).with_simd(Scalar),
                ),
                Colour::Spectral => (
                    plain::<Wave>(&walk, block),
                    Task::<Wave>::new(&walk, block).with_simd(Scalar),
                ),
            };
            let trace = walk.trace(block);
            assert!(plain.len() > 1000);
            assert!(trace.records == plain, "{name} {power:?}");
            // and registers of any width do the same
            assert!(
                scalar.records == plain && scalar.ledger == trace.ledger,
                "{name}"
            );
            assert_eq!(scalar.astray, trace.astray);
        }
    }
}
