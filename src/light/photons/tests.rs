//! Photons against the reference, against closed forms, and one scheme against the other.
//!
//! Everything is compared by the means of independent walks: paths hit a surface more than once, so that hits are not independent, but walks are.

use super::{Photons, WALK};
use crate::accuracy::sidak;
use crate::light::reference::{Measured, PathTracer, Reference};
use crate::light::scene::{Scene, read};
use crate::light::walk::{Power, Walk};
use crate::parameter::{Value, Values};
use crate::random;
use crate::sample::Source;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::path::Path;
use std::sync::Arc;

fn scene(name: &str) -> Arc<Scene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data/scenes")
        .join(name);
    Arc::new(read::scene(&path).expect("a scene of ours"))
}

/// A mean with the error that the spread of independent walks gives it.
#[derive(Clone, Copy, Debug)]
struct Mean {
    value: f64,
    error: f64,
}

impl Mean {
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let square: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        Self {
            value,
            error: (square / (n - 1.0) / n).sqrt(),
        }
    }
}

const WALKS: usize = 16;

/// Irradiance in each channel of each of `across`² squares of each surface (of the whole surface for 1), the mean of [`WALKS`] walks.
fn irradiance(scene: &Scene, power: Power, paths: u64, across: usize) -> Vec<Mean> {
    let cells = across * across;
    let all: Vec<Vec<f64>> = (0..WALKS as u64)
        .map(|seed| {
            let walk = Walk::new(scene, power, paths, seed).expect("legal");
            let (hits, _) = walk.run().expect("no leaks");
            let mut sums = Vec::new();
            for (surface, described) in scene.surfaces().iter().enumerate() {
                let domain = described.domain().expect("flat");
                let mut of_surface = vec![[0.0; 3]; cells];
                for record in hits.on(surface) {
                    let place = [f64::from(record.u), f64::from(record.v)];
                    let [i, j] = [0, 1].map(|k: usize| {
                        let share = place[k] / domain.high()[k];
                        ((share * across as f64) as usize).min(across - 1)
                    });
                    for c in 0..3 {
                        of_surface[i * across + j][c] += f64::from(record.flux[c]);
                    }
                }
                let area = described.area() / cells as f64;
                sums.extend(of_surface.as_flattened().iter().map(|sum| sum / area));
            }
            sums
        })
        .collect();
    (0..all[0].len())
        .map(|k| Mean::of(&all.iter().map(|walk| walk[k]).collect::<Vec<f64>>()))
        .collect()
}

/// The worst of many comparisons in standard errors, and how large it may be at the level 0.001 for all together.
fn worst(pairs: impl Iterator<Item = (Mean, Mean)>) -> (f64, f64) {
    let mut farthest: f64 = 0.0;
    let mut count = 0;
    for (a, b) in pairs {
        count += 1;
        let error = a.error.hypot(b.error);
        if error > 0.0 {
            farthest = farthest.max((a.value - b.value).abs() / error);
        } else {
            assert!((a.value - b.value).abs() < 1e-12, "{a:?} {b:?}");
        }
    }
    let freedom = WALKS as f64 - 1.0;
    let each = sidak(0.999, count);
    let student = StudentsT::new(0.0, 1.0, freedom).expect("legal");
    (farthest, student.inverse_cdf(0.5 + 0.5 * each))
}

/// Every surface and channel of the Cornell box; a seventh too much light is noticed.
#[test]
fn surfaces_receive_what_paths_from_them_find() {
    let scene = scene("cornell-box-rgb.toml");
    let photons = irradiance(&scene, Power::Same, 4_000, 1);
    let tracer = PathTracer::new(&scene).expect("three channels");
    let mut traced = Vec::new();
    for (surface, described) in scene.surfaces().iter().enumerate() {
        let mut random = random::stream(4, "test", surface as u64);
        let draw = || {
            let [choice, s, t] = [0; 3].map(|_| random::open_unit(&mut random));
            let (part, place) = described.shape.draw(choice, s, t);
            let normal = described.shape.normal(part, place);
            let own = scene.primitive(surface, part);
            tracer.irradiance(place, normal, own, &mut random)
        };
        let Measured { mean, error, .. } = Measured::of(4_000, draw);
        traced.extend((0..3).map(|c| Mean {
            value: mean[c],
            error: error[c],
        }));
    }
    let pairs = || photons.iter().copied().zip(traced.iter().copied());
    let (farthest, limit) = worst(pairs());
    assert!(
        farthest < limit,
        "{farthest} standard errors, {limit} allowed"
    );
    let brighter = |(mut a, b): (Mean, Mean)| {
        a.value *= 1.15;
        (a, b)
    };
    let (farthest, _) = worst(pairs().map(brighter));
    assert!(
        farthest > limit,
        "a seventh too much is not noticed: {farthest} {limit}"
    );
}

/// B = M/(1 - ρ) on every cell of every face of the furnace; a tenth too much is noticed.
#[test]
fn a_furnace_is_lit_evenly() {
    let furnace = scene("furnace.toml");
    let exact = Mean {
        value: std::f64::consts::TAU,
        error: 0.0,
    };
    let photons = irradiance(&furnace, Power::Same, 6_000, 3);
    let (farthest, limit) = worst(photons.iter().map(|&found| (found, exact)));
    assert!(
        farthest < limit,
        "{farthest} standard errors, {limit} allowed"
    );
    let more = Mean {
        value: 1.1 * exact.value,
        ..exact
    };
    let (farthest, _) = worst(photons.iter().map(|&found| (found, more)));
    assert!(
        farthest > limit,
        "a tenth is not noticed: {farthest} {limit}"
    );
}

#[test]
fn both_schemes_of_power_give_the_same_cells() {
    let scene = scene("cornell-box-rgb.toml");
    let attenuated = Power::Attenuated {
        threshold: 0.1,
        kill: 0.5,
    };
    let same = irradiance(&scene, Power::Same, 2_000, 3);
    let other = irradiance(&scene, attenuated, 2_000, 3);
    let (farthest, limit) = worst(same.into_iter().zip(other));
    assert!(
        farthest < limit,
        "{farthest} standard errors, {limit} allowed"
    );
}

fn photons(scene: &Arc<Scene>, values: &[(&'static str, Value)]) -> Result<Photons, String> {
    photons_on(scene, 0, values)
}

fn photons_on(
    scene: &Arc<Scene>,
    surface: usize,
    values: &[(&'static str, Value)],
) -> Result<Photons, String> {
    let mut told = Values::defaults(WALK);
    for (name, value) in values {
        told.set(name, value.clone());
    }
    let reference = Arc::new(Reference::new(scene.clone()));
    Photons::new(reference, surface, &told).map_err(|error| error.to_string())
}

/// Direct and indirect light are all light, hit by hit, and scores that wait for the end of paths have the same mean.
#[test]
fn parts_of_the_light_sum_to_the_whole() {
    let scene = scene("closed-box.toml");
    let word = |word: &str| Value::Word(word.to_owned());
    let mass = |values: &[(&'static str, Value)], number: u64| {
        let source = photons(&scene, values).expect("legal");
        let sample = source.sample(3_000, &mut random::stream(6, "test", number));
        sample.expect("hits").mass()
    };
    let [all, direct, indirect] =
        ["all", "direct", "indirect"].map(|light| mass(&[("light", word(light))], 0));
    assert!(
        (all - direct - indirect).abs() < 1e-9 * all,
        "{all} {direct} {indirect}"
    );
    for score in ["survival", "absorption"] {
        let values: Vec<f64> = (0..WALKS as u64)
            .map(|walk| mass(&[("score", word(score))], walk) - mass(&[], walk))
            .collect();
        let off = Mean::of(&values);
        assert!(off.value.abs() < 4.5 * off.error, "{score}: {off:?}");
    }
}

/// A photon that survives a wall and dies on the black back of a lamp was not absorbed by the wall: a large lamp in the middle of the room makes that common.
#[test]
fn what_ends_on_a_back_has_survived_the_wall_before() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes/closed-box.toml");
    let text = std::fs::read_to_string(&path).expect("readable");
    let small = "origin = [0.4, 0.99, 0.4], u = [0.2, 0.0, 0.0], v = [0.0, 0.0, 0.2]";
    let large = "origin = [0.1, 0.5, 0.1], u = [0.8, 0.0, 0.0], v = [0.0, 0.0, 0.8]";
    assert!(text.contains(small));
    let scene = read::scene_text(&text.replace(small, large), &path).expect("a scene");
    let scene = Arc::new(scene);
    let (ceiling, _) = scene.surface("ceiling").expect("there");
    let mass = |score: &str, walk: u64| {
        let values = [("score", Value::Word(score.to_owned()))];
        let source = photons_on(&scene, ceiling, &values).expect("legal");
        let sample = source.sample(40_000, &mut random::stream(8, "test", walk));
        sample.expect("hits").mass()
    };
    for score in ["survival", "absorption"] {
        let all: Vec<f64> = (0..WALKS as u64)
            .map(|walk| mass("collision", walk))
            .collect();
        let off: Vec<f64> = (0..WALKS as u64)
            .map(|walk| mass(score, walk) - all[walk as usize])
            .collect();
        let (off, all) = (Mean::of(&off), Mean::of(&all));
        assert!(off.value.abs() < 4.5 * off.error, "{score}: {off:?}");
        // a twentieth of the arrivals, taken for absorbed, would be seen
        assert!(0.05 * all.value > 4.5 * off.error, "{score}: {off:?}");
    }
}

#[test]
fn settings_that_do_not_go_together_are_told() {
    let closed = scene("closed-box.toml");
    let number = Value::Number(0.2);
    let word = |word: &str| Value::Word(word.to_owned());
    let told = photons(&closed, &[("threshold", number)])
        .err()
        .expect("no roulette");
    assert!(told.contains("attenuated"), "{told}");
    let both = [("score", word("survival")), ("power", word("attenuated"))];
    let told = photons(&closed, &both).err().expect("attenuated");
    assert!(told.contains("keep their power"), "{told}");
}

/// The same stream gives the same sample, whatever the threads.
#[test]
fn hits_do_not_depend_on_threads() {
    let scene = scene("cornell-box-rgb.toml");
    let source = photons(&scene, &[]).expect("legal");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        let sample = pool.install(|| source.sample(9_000, &mut random::stream(7, "test", 0)));
        let sample = sample.expect("hits");
        (sample.points().to_vec(), sample.mass().to_bits())
    };
    assert_eq!(on(1), on(3));
}
