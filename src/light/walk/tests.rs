//! Walks against what is known of them on paper.

use super::carried::{Carried, Channels};
use super::lamps::{Given, Lamps};
use super::*;
use crate::light::chance;
use crate::light::scene::{Scene, read};
use crate::light::spectrum::Spectrum;
use rand::Rng;
use std::f64::consts::PI;
use std::path::Path;

fn shipped(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    read::scene(&folder.join(name)).expect("a shipped scene")
}

fn changed(name: &str, from: &str, to: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data/scenes")
        .join(name);
    let text = std::fs::read_to_string(&path).expect("readable");
    assert!(text.contains(from), "{from}");
    read::scene_text(&text.replace(from, to), &path).expect("a scene")
}

fn run(scene: &Scene, power: Power, paths: u64, seed: u64) -> (Hits, Ledger) {
    Walk::new(scene, power, paths, seed)
        .and_then(|walk| walk.run())
        .expect("a walk")
}

const ROULETTE: Power = Power::Attenuated {
    threshold: 0.1,
    kill: 0.5,
};

/// Mean irradiance on each surface and channel, block by block: rows of equal size for `chance::worst`.
fn by_block(scene: &Scene, walk: impl Fn(u64) -> Trace, blocks: u64) -> Vec<Vec<f64>> {
    let count = scene.surfaces().len();
    (0..blocks)
        .map(|block| {
            let mut sums = vec![0.0; 3 * count];
            for record in walk(block).records {
                for channel in 0..3 {
                    sums[3 * record.surface as usize + channel] +=
                        f64::from(record.flux[channel]) * blocks as f64;
                }
            }
            for (index, sum) in sums.iter_mut().enumerate() {
                *sum /= scene.surfaces()[index / 3].area();
            }
            sums
        })
        .collect()
}

fn means(blocks: &[Vec<f64>]) -> Vec<f64> {
    (0..blocks[0].len())
        .map(|cell| blocks.iter().map(|b| b[cell]).sum::<f64>() / blocks.len() as f64)
        .collect()
}

/// The difference of two walks of as many blocks, expected to be 0.
fn differences(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
        .collect()
}

/// Quantities without light, such as what lands on a lamp from behind, have no error and are left out.
fn lit(blocks: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let bright: Vec<bool> = (0..blocks[0].len())
        .map(|cell| blocks.iter().any(|b| b[cell].abs() > 0.0))
        .collect();
    blocks
        .iter()
        .map(|b| {
            b.iter()
                .zip(&bright)
                .filter(|(_, bright)| **bright)
                .map(|(x, _)| *x)
                .collect()
        })
        .collect()
}

#[test]
fn first_hits_follow_the_form_factors() {
    let scene = shipped("floor-cube.toml");
    let paths = 200_000;
    let (hits, ledger) = run(&scene, Power::Same, paths, 1);
    assert_eq!(ledger.hits, paths);
    let factor = |name: &str| match name {
        "floor" => 0.0,
        "ceiling" => 0.199_824_9,
        _ => 0.200_043_8,
    };
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let expected = factor(&surface.name);
        let share = hits.on(index).len() as f64 / paths as f64;
        let error = (expected * (1.0 - expected) / paths as f64).sqrt();
        assert!(
            (share - expected).abs() <= 4.0 * error,
            "{} {share}",
            surface.name
        );
    }
}

#[test]
fn a_furnace_is_white_everywhere() {
    let scene = shipped("furnace.toml");
    let walk = Walk::new(&scene, Power::Same, 24 * BLOCK, 2).expect("a walk");
    // irradiance on 4 × 4 cells of each wall: (B − E)/ρ = 2π
    let blocks: Vec<Vec<f64>> = (0..walk.blocks())
        .map(|block| {
            let mut cells = vec![0.0; 6 * 16];
            for record in walk.trace(block).records {
                let cell = |x: f32| ((x * 4.0) as usize).min(3);
                cells[record.surface as usize * 16 + cell(record.u) * 4 + cell(record.v)] +=
                    f64::from(record.flux[1]) * 16.0 * walk.blocks() as f64;
            }
            cells
        })
        .collect();
    chance::worst(&blocks, &[2.0 * PI; 96]).expect("white");
    let whole: Vec<Vec<f64>> = blocks
        .iter()
        .map(|cells| vec![cells.iter().sum::<f64>() / 96.0])
        .collect();
    chance::worst(&whole, &[2.0 * PI]).expect("white on the average");
    // one per cent more or less is seen
    assert!(chance::worst(&whole, &[2.02 * PI]).is_err());
}

#[test]
fn the_number_of_hits_is_geometric() {
    let scene = shipped("furnace.toml");
    let paths = 100_000;
    let (hits, ledger) = run(&scene, Power::Same, paths, 3);
    let mut lengths = vec![0u16; paths as usize];
    for surface in 0..6 {
        for record in hits.on(surface) {
            let length = &mut lengths[record.path as usize];
            *length = (*length).max(record.bounce);
        }
    }
    // P(k) = (1 − ρ) ρ^(k − 1), the tail in the last cell
    let mut found = vec![0.0; 12];
    for length in lengths {
        found[(length as usize - 1).min(11)] += 1.0;
    }
    let expected: Vec<f64> = (0..12)
        .map(|k| paths as f64 * 0.5_f64.powi(if k == 11 { 11 } else { k + 1 }))
        .collect();
    assert!(chance::counts(&found, &expected) > 1e-3, "{found:?}");
    // every photon is absorbed, once
    assert_eq!((ledger.ended, ledger.left), (paths, 0));
    assert_eq!(ledger.hits, hits.len() as u64);
    assert!(ledger.imbalance().abs() < 1e-12);
}

#[test]
fn a_sphere_is_uniform_after_the_first_bounce() {
    let scene = shipped("sphere.toml");
    let paths = 60_000;
    let (hits, _) = run(&scene, Power::Same, paths, 4);
    let high = scene.surfaces()[0].domain().expect("a chart").high();
    let mut cells = vec![0.0; 64];
    let mut later = 0.0;
    for record in hits.on(0).iter().filter(|record| record.bounce > 1) {
        let cell = |x: f32, high: f64| ((f64::from(x) / high * 8.0) as usize).min(7);
        cells[cell(record.u, high[0]) * 8 + cell(record.v, high[1])] += 1.0;
        later += 1.0;
    }
    assert!(chance::counts(&cells, &[later / 64.0; 64]) > 1e-3);
    // reflected irradiance Φ ρ / (4 π R² (1 − ρ)): ρ/(1 − ρ) = 4 later hits a path, of variance ρ/(1 − ρ)² less what a certain first takes
    let mean = later / paths as f64;
    let error = (20.0 / paths as f64).sqrt();
    assert!((mean - 4.0).abs() < 3.3 * error, "{mean}");
}

const WHITE: &str = "[0.885809, 0.698859, 0.666422]";

/// The box in three colours, and its three colours as boxes of their own.
fn monochrome(channel: usize) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes/cornell-box-rgb.toml");
    let mut text = std::fs::read_to_string(&path).expect("readable");
    for three in [
        WHITE,
        "[0.105421, 0.37798, 0.076425]",
        "[0.570068, 0.0430135, 0.0443706]",
        "[18.387, 13.9873, 6.75357]",
    ] {
        assert!(text.contains(three), "{three}");
        let one = three.trim_matches(['[', ']']).split(", ").nth(channel);
        text = text.replace(three, one.expect("three numbers"));
    }
    read::scene_text(&text, &path).expect("a scene")
}

/// A photon that survives with the mean albedo and keeps its colour: the fault that the tests must see.
#[derive(Clone, Copy)]
struct MeanAlbedo(Channels);

impl Carried for MeanAlbedo {
    fn power(&self) -> f64 {
        self.0.power()
    }
    fn reflected(self, reflectance: &Spectrum, factor: f64) -> Self {
        let mean = reflectance.rgb().iter().sum::<f64>() / 3.0;
        self.scaled(mean * factor)
    }
    fn scaled(self, factor: f64) -> Self {
        Self(self.0.scaled(factor))
    }
    fn flux(&self) -> [f32; 3] {
        self.0.flux()
    }
}

impl Given for MeanAlbedo {
    fn given(lamps: &Lamps, lamp: usize, power: f64, random: &mut impl Rng) -> Self {
        Self(Channels::given(lamps, lamp, power, random))
    }
}

/// Hits are sorted while others are traced, batch after batch: none is lost, doubled or out of order, and no light either.
#[test]
fn a_walk_is_its_blocks_one_after_the_other() {
    let scene = shipped("cornell-box-rgb.toml");
    for paths in [
        BLOCK,
        BATCH * BLOCK,
        2 * BATCH * BLOCK + 1,
        3 * BATCH * BLOCK + 5,
    ] {
        let walk = Walk::new(&scene, Power::Same, paths, 11).expect("a walk");
        let (found, ledger) = walk.run().expect("hits");
        let mut hits = Hits::new(scene.surfaces().len(), paths);
        let mut expected = Ledger::default();
        for block in 0..walk.blocks() {
            let trace = walk.trace(block);
            hits.extend(&trace.records);
            hits.lose(&trace.astray);
            expected.add(&trace.ledger);
        }
        assert_eq!(ledger, expected);
        assert_eq!(found.astray(), hits.astray());
        for surface in 0..scene.surfaces().len() {
            assert!(found.on(surface) == hits.on(surface), "{paths} {surface}");
        }
    }
}

#[test]
fn colours_are_those_of_three_walks_of_one_colour() {
    let blocks = 12;
    let scene = shipped("cornell-box-rgb.toml");
    let alone: Vec<Vec<Vec<f64>>> = (0..3)
        .map(|channel| {
            let scene = monochrome(channel);
            let walk = Walk::new(&scene, Power::Same, blocks * BLOCK, 5).expect("a walk");
            by_block(&scene, |block| walk.trace(block), blocks)
        })
        .collect();
    // channel c of the walk of colour c
    let expected: Vec<Vec<f64>> = (0..blocks as usize)
        .map(|block| {
            (0..3 * scene.surfaces().len())
                .map(|cell| alone[cell % 3][block][cell])
                .collect()
        })
        .collect();
    for power in [Power::Same, ROULETTE] {
        let walk = Walk::new(&scene, power, blocks * BLOCK, 6).expect("a walk");
        let found = by_block(&scene, |block| walk.trace(block), blocks);
        let apart = lit(&differences(&found, &expected));
        let nothing = vec![0.0; apart[0].len()];
        chance::worst(&apart, &nothing).expect("unbiased");
    }
    let walk = Walk::new(&scene, Power::Same, blocks * BLOCK, 6).expect("a walk");
    let biased = by_block(
        &scene,
        |block| walk.arch.dispatch(Task::<MeanAlbedo>::new(&walk, block)),
        blocks,
    );
    let apart = lit(&differences(&biased, &expected));
    let nothing = vec![0.0; apart[0].len()];
    assert!(
        chance::worst(&apart, &nothing).is_err(),
        "the fault was not seen"
    );
}

#[test]
fn wavelengths_add_up_to_the_colours_of_a_grey_room() {
    // where reflectance does not depend on the wavelength, every spectrum reflects the same share
    let scene = shipped("cornell-box-empty.toml");
    let (hits, ledger) = run(&scene, Power::Same, 20_000, 8);
    assert!(ledger.escaped > 0.0 && ledger.imbalance().abs() < 1e-12);
    let (floor, _) = scene.surface("floor").expect("a floor");
    let sample = hits.sample(&scene, floor).expect("a chart").expect("hits");
    assert_eq!(sample.channels(), 3);
    // the light is reddish: X > Z by far
    assert!(sample.channel(0).mass() > 3.0 * sample.channel(2).mass());
}

#[test]
fn any_number_of_threads_gives_the_same_hits() {
    let scene = shipped("cornell-box-rgb.toml");
    let with = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads")
            .install(|| run(&scene, ROULETTE, 20_000, 9))
    };
    let (one, ledger) = with(1);
    for threads in [2, 7] {
        let (hits, other) = with(threads);
        assert_eq!(other, ledger);
        for surface in 0..scene.surfaces().len() {
            assert_eq!(hits.on(surface), one.on(surface));
        }
    }
}

#[test]
fn light_that_leaks_fails_the_walk() {
    let open = changed(
        "closed-box.toml",
        "u = [1.0, 0.0, 0.0]",
        "u = [0.99, 0.0, 0.0]",
    );
    let error = Walk::new(&open, Power::Same, 20_000, 1)
        .and_then(|walk| walk.run())
        .expect_err("a gap");
    assert!(error.to_string().contains("light leaks"), "{error}");
    let endless = changed("furnace.toml", "reflectance = 0.5", "reflectance = 1.0");
    let error = Walk::new(&endless, Power::Same, 2, 1)
        .and_then(|walk| walk.run())
        .expect_err("no end");
    assert!(error.to_string().contains("still on its way"), "{error}");
    assert!(Walk::new(&open, Power::Same, 0, 1).is_err());
    let never = Power::Attenuated {
        threshold: 0.1,
        kill: 0.0,
    };
    assert!(Walk::new(&open, never, 1, 1).is_err());
}

#[test]
fn samples_hold_all_the_light_of_their_hits() {
    for name in ["cornell-box.toml", "cornell-box-rgb.toml", "sphere.toml"] {
        let scene = shipped(name);
        let (hits, _) = run(&scene, Power::Same, 20_000, 10);
        for (index, surface) in scene.surfaces().iter().enumerate() {
            let records = hits.on(index);
            if records.is_empty() {
                continue;
            }
            let flux: f64 = records.iter().flat_map(|r| r.flux).map(f64::from).sum();
            if flux <= 0.0 {
                continue;
            }
            let sample = hits
                .sample(&scene, index)
                .expect("a chart")
                .expect(&surface.name);
            assert!(
                (sample.mass() / flux - 1.0).abs() < 1e-9,
                "{}",
                surface.name
            );
        }
    }
    let scene = shipped("closed-box.toml");
    let (hits, ledger) = run(&scene, Power::Same, 20_000, 11);
    // irradiance × area of all surfaces is what all hits carry: Φ times the mean number of hits
    let all: f64 = (0..scene.surfaces().len())
        .map(|s| {
            hits.sample(&scene, s)
                .expect("a chart")
                .map_or(0.0, |s| s.mass())
        })
        .sum();
    let expected = ledger.emitted * ledger.hits as f64 / ledger.paths as f64;
    assert!((all / expected - 1.0).abs() < 1e-6);
    let direct = hits.sample_of(&scene, 0, 1.0, |record| record.bounce == 1);
    let direct = direct
        .expect("a chart")
        .expect("the lamp shines on the floor");
    assert!(direct.len() < hits.on(0).len());
}

#[test]
fn means_are_those_of_both_schemes() {
    let scene = shipped("closed-box.toml");
    let blocks = 12;
    let of = |power, seed| {
        let walk = Walk::new(&scene, power, blocks * BLOCK, seed).expect("a walk");
        by_block(&scene, |block| walk.trace(block), blocks)
    };
    let (same, attenuated) = (of(Power::Same, 12), of(ROULETTE, 13));
    let apart = lit(&differences(&same, &attenuated));
    let nothing = vec![0.0; apart[0].len()];
    chance::worst(&apart, &nothing).expect("the same light");
    // and 3 % less is seen
    let dimmed: Vec<Vec<f64>> = attenuated
        .iter()
        .map(|block| block.iter().map(|x| 0.97 * x).collect())
        .collect();
    let apart = lit(&differences(&same, &dimmed));
    assert!(
        chance::worst(&apart, &nothing).is_err(),
        "{:?}",
        means(&apart)
    );
}

/// In three channels what is returned is what arrives times the reflectance, hit by hit; over wavelengths red walls return redder light.
#[test]
fn returned_light_is_what_the_surface_reflects() {
    let trace = |scene: &Scene, returned: bool| {
        let walk = Walk::new(scene, Power::Same, 2_000, 14).expect("a walk");
        let walk = if returned { walk.returned() } else { walk };
        walk.trace(0).records
    };
    let scene = shipped("cornell-box-rgb.toml");
    for (arrived, returned) in trace(&scene, false).iter().zip(trace(&scene, true)) {
        let surface = &scene.surfaces()[returned.surface as usize];
        let rho = surface.material.reflectance().rgb();
        for c in 0..3 {
            let expected = f64::from(arrived.flux[c]) * rho[c];
            assert!((f64::from(returned.flux[c]) - expected).abs() <= 1e-6 * expected);
        }
    }
    let scene = shipped("cornell-box-empty.toml");
    let (left, _) = scene.surface("left_wall_back").expect("a red wall");
    let redness = |returned: bool| {
        let mut sum = [0.0; 3];
        let records = trace(&scene, returned);
        for record in records.iter().filter(|r| usize::from(r.surface) == left) {
            for c in 0..3 {
                sum[c] += f64::from(record.flux[c]);
            }
        }
        sum[0] / sum[1]
    };
    assert!(redness(true) > 1.3 * redness(false), "{}", redness(true));
}

/// Rounding must not add up from bounce to bounce: hundreds of them, and nothing leaves a closed sphere.
#[test]
fn long_paths_stay_in_a_sphere() {
    let white = changed("sphere.toml", "reflectance = 0.8", "reflectance = 0.995");
    let (hits, ledger) = run(&white, Power::Same, 400, 15);
    assert!(hits.len() > 400 * 100 && ledger.left == 0);
}
