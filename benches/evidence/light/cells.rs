//! The irradiance in cells of all surfaces, batch by batch: by photons, or by paths traced from the cells.

use crate::judge::{Mean, together};
use density_lab::light::reference::PathTracer;
use density_lab::light::scene::{Scene, Surface};
use density_lab::light::walk::{Power, Walk};
use density_lab::random::{self, open_unit};
use rayon::prelude::*;

pub const BATCHES: usize = 40;
/// Cells with fewer hits are joined with those beside them.
const HITS: f64 = 400.0;

/// `across`² cells of each surface, three channels each.
pub struct Cells {
    pub across: usize,
    /// The irradiance in each batch.
    batches: Vec<Vec<f32>>,
    /// Hits of each cell, over all batches.
    hits: Vec<f64>,
}

impl Cells {
    /// By so many photons.
    pub fn photons(scene: &Scene, power: Power, paths: u64, across: usize, seed: u64) -> Self {
        let each = paths.div_ceil(BATCHES as u64);
        let highs: Vec<[f64; 2]> = scene.surfaces().iter().map(high).collect();
        let cells = across * across;
        let total = scene.surfaces().len() * cells;
        let areas: Vec<f64> = scene.surfaces().iter().map(Surface::area).collect();
        let batch = |number: usize| {
            let walk = Walk::new(scene, power, each, seed * 1000 + number as u64).expect("legal");
            let mut sums = vec![0.0f64; 3 * total];
            let mut hits = vec![0u32; total];
            for block in 0..walk.blocks() {
                for record in walk.trace(block).records {
                    let surface = record.surface as usize;
                    let cell = |x: f32, high: f64| {
                        ((f64::from(x) / high * across as f64) as usize).min(across - 1)
                    };
                    let [u, v] = highs[surface];
                    let at = surface * cells + cell(record.u, u) * across + cell(record.v, v);
                    hits[at] += 1;
                    for c in 0..3 {
                        sums[3 * at + c] += f64::from(record.flux[c]);
                    }
                }
            }
            let mean =
                |(at, sum): (usize, f64)| (sum / (areas[at / (3 * cells)] / cells as f64)) as f32;
            (sums.into_iter().enumerate().map(mean).collect(), hits)
        };
        let mut hits = vec![0.0; total];
        let mut batches = Vec::new();
        // a few at a time: each holds many numbers
        for numbers in (0..BATCHES).collect::<Vec<usize>>().chunks(4) {
            let done: Vec<(Vec<f32>, Vec<u32>)> =
                numbers.par_iter().map(|&number| batch(number)).collect();
            for (means, counts) in done {
                for (all, count) in hits.iter_mut().zip(counts) {
                    *all += f64::from(count);
                }
                batches.push(means);
            }
        }
        Self {
            across,
            batches,
            hits,
        }
    }

    /// By paths from random places of each cell, `draws` a cell: the mean over the cell, not the value at its middle.
    pub fn paths(scene: &Scene, across: usize, draws: usize) -> Self {
        let tracer = PathTracer::new(scene).expect("three channels");
        let cells = across * across;
        let total = scene.surfaces().len() * cells;
        let each = draws.div_ceil(BATCHES);
        let cell = |number: usize| {
            let (surface, cell) = (number / cells, number % cells);
            let described = &scene.surfaces()[surface];
            let high = high(described);
            let own = scene.primitive(surface, 0);
            let mut random = random::stream(1, "evidence", number as u64);
            let at = [cell / across, cell % across];
            let batch = |_| {
                let mut sum = [0.0; 3];
                for _ in 0..each {
                    let [u, v] = [0, 1].map(|k: usize| {
                        (at[k] as f64 + open_unit(&mut random)) / across as f64 * high[k]
                    });
                    let place = described.shape.place(0, u, v);
                    let normal = described.shape.normal(0, place);
                    let found = tracer.irradiance(place, normal, own, &mut random);
                    for (sum, e) in sum.iter_mut().zip(found) {
                        *sum += e / each as f64;
                    }
                }
                sum
            };
            (0..BATCHES).map(batch).collect::<Vec<[f64; 3]>>()
        };
        let by_cell: Vec<Vec<[f64; 3]>> = (0..total).into_par_iter().map(cell).collect();
        let batch = |b: usize| {
            let single = |cell: &Vec<[f64; 3]>| cell[b].map(|x| x as f32);
            by_cell.iter().flat_map(single).collect()
        };
        Self {
            across,
            batches: (0..BATCHES).map(batch).collect(),
            hits: Vec::new(),
        }
    }

    fn index(&self, surface: usize, cell: usize, channel: usize) -> usize {
        3 * (surface * self.across * self.across + cell) + channel
    }

    pub fn cell(&self, surface: usize, cell: usize, channel: usize) -> Mean {
        let at = self.index(surface, cell, channel);
        Mean::of(self.batches.iter().map(move |b| f64::from(b[at])))
    }

    /// The mean over a surface.
    pub fn surface(&self, surface: usize, channel: usize) -> Mean {
        let cells = self.across * self.across;
        let range = self.index(surface, 0, channel)..self.index(surface, cells, 0);
        Mean::of(self.batches.iter().map(move |b| {
            let all = b[range.clone()].iter().step_by(3);
            all.map(|&x| f64::from(x)).sum::<f64>() / cells as f64
        }))
    }

    /// The mean over everything, where all surfaces are as large.
    pub fn everything(&self, channel: usize) -> Mean {
        Mean::of(self.batches.iter().map(move |b| {
            let all = b.iter().skip(channel).step_by(3);
            all.map(|&x| f64::from(x)).sum::<f64>() * 3.0 / b.len() as f64
        }))
    }

    /// The same with every cell of a surface multiplied by a factor of its place in it: a planted fault.
    pub fn spoilt(&self, factor: impl Fn(usize, usize) -> f64) -> Self {
        let spoil = |batch: &Vec<f32>| {
            let number = |(at, x): (usize, &f32)| {
                let cell = at / 3 % (self.across * self.across);
                (f64::from(*x) * factor(cell / self.across, cell % self.across)) as f32
            };
            batch.iter().enumerate().map(number).collect()
        };
        Self {
            across: self.across,
            batches: self.batches.iter().map(spoil).collect(),
            hits: self.hits.clone(),
        }
    }

    /// The probability that the cells of a surface are as far from others, if both estimate the same; see [`together`]. Cells with few hits, which
    /// would have skew differences, are joined with the next ones.
    pub fn agree(
        &self,
        surface: usize,
        channel: usize,
        expected: impl Fn(usize, usize) -> f64,
    ) -> f64 {
        let cells = self.across * self.across;
        let mut differences: Vec<Vec<f64>> = Vec::new();
        let (mut open, mut hits) = (vec![0.0; BATCHES], 0.0);
        for cell in 0..cells {
            let at = self.index(surface, cell, channel);
            for (b, sum) in open.iter_mut().enumerate() {
                *sum += f64::from(self.batches[b][at]) - expected(b, at);
            }
            hits += self.hits[surface * cells + cell];
            if hits >= HITS {
                differences.push(std::mem::replace(&mut open, vec![0.0; BATCHES]));
                hits = 0.0;
            }
        }
        match differences.last_mut() {
            Some(last) if hits > 0.0 => {
                for (last, open) in last.iter_mut().zip(open) {
                    *last += open;
                }
            }
            Some(_) => {}
            None => differences.push(open),
        }
        together(&differences)
    }

    /// That against another estimate.
    pub fn agree_with(&self, other: &Self, surface: usize, channel: usize) -> f64 {
        self.agree(surface, channel, |b, at| f64::from(other.batches[b][at]))
    }
}

fn high(surface: &Surface) -> [f64; 2] {
    surface.domain().expect("flat").high()
}
