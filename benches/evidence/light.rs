//! What must hold of the light, with as many photons as it takes: too dear for the tests, so run by hand.
//!
//! ```sh
//! cargo run --release --example evidence-light            # all of it: some minutes on two cores
//! cargo run --release --example evidence-light -- 0.1     # a tenth of the photons
//! ```
//!
//! Every line names what is measured, the value, what it must be, and the verdict; a line that fails makes the exit code 1. Everything is compared by
//! independent batches of paths, since hits of one path are not independent; batches have Student's distribution, and families of comparisons are judged by
//! Holm's procedure at the level 0.01.

use density_lab::light::reference::{PathTracer, Reference};
use density_lab::light::scene::{Scene, Surface, read};
use density_lab::light::walk::{Power, Walk};
use density_lab::random::{self, open_unit};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

const BATCHES: usize = 40;
const LEVEL: f64 = 0.01;

struct Report {
    failed: bool,
    scale: f64,
}

impl Report {
    fn say(&mut self, what: &str, value: &str, holds: bool) {
        self.failed |= !holds;
        println!(
            "{} {what}: {value}",
            if holds { "ok    " } else { "FAILED" }
        );
    }

    fn paths(&self, count: f64) -> u64 {
        (count * self.scale).max(4000.0) as u64
    }
}

fn scene(name: &str) -> Arc<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    match read::scene(&folder.join(name)) {
        Ok(scene) => Arc::new(scene),
        Err(problems) => panic!("{problems}"),
    }
}

/// A mean with its standard error, and how many values it is of; 0: a number without error.
#[derive(Clone, Copy, Debug)]
struct Mean {
    value: f64,
    error: f64,
    count: usize,
}

impl Mean {
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count();
        let n = count as f64;
        let value = values.clone().sum::<f64>() / n;
        let square: f64 = values.map(|v| (v - value).powi(2)).sum();
        Self {
            value,
            error: (square / (n - 1.0) / n).sqrt(),
            count,
        }
    }

    fn exactly(value: f64) -> Self {
        Self {
            value,
            error: 0.0,
            count: 0,
        }
    }

    /// The difference in standard errors, as a standard normal number: Student's where there are few values. [Welch 1947]
    fn off(self, other: Self) -> f64 {
        let [a, b] = [self, other].map(|m| (m.error.powi(2), m.count as f64 - 1.0));
        let square = a.0 + b.0;
        if square <= 0.0 {
            return if (self.value - other.value).abs() <= 1e-12 {
                0.0
            } else {
                f64::INFINITY
            };
        }
        let share = |(s, freedom): (f64, f64)| if s > 0.0 { s * s / freedom } else { 0.0 };
        let freedom = square * square / (share(a) + share(b));
        let t = (self.value - other.value) / square.sqrt();
        let student = StudentsT::new(0.0, 1.0, freedom).expect("freedom");
        // by the lower tail, which keeps its digits
        let z = Normal::standard().inverse_cdf(student.cdf(-t.abs()).max(1e-300));
        z.abs().copysign(t)
    }
}

/// The p-values of a family after Holm; whether all stand.
fn holm(family: &[f64]) -> (f64, bool) {
    let mut sorted = family.to_vec();
    sorted.sort_by(f64::total_cmp);
    let m = sorted.len() as f64;
    let adjusted = sorted.iter().enumerate().map(|(i, p)| p * (m - i as f64));
    let least = adjusted.fold(f64::INFINITY, f64::min).min(1.0);
    (least, least >= LEVEL)
}

fn two_sided(z: f64) -> f64 {
    2.0 * Normal::standard().cdf(-z.abs())
}

fn chi_squared(z: &[f64]) -> f64 {
    let sum: f64 = z.iter().map(|z| z * z).sum();
    ChiSquared::new(z.len() as f64).expect("cells").sf(sum)
}

/// For each batch the irradiance in each channel of `across`² cells of each surface.
struct Cells {
    across: usize,
    batches: Vec<Vec<f32>>,
    /// Over all batches: flux of each cell and channel, and the sum of the squares of its hits' fluxes.
    all: Vec<[f64; 2]>,
    /// Hits of each cell.
    counts: Vec<f64>,
    areas: Vec<f64>,
}

impl Cells {
    fn measure(scene: &Scene, power: Power, paths: u64, across: usize, seed: u64) -> Self {
        let each = paths.div_ceil(BATCHES as u64);
        let highs: Vec<[f64; 2]> = scene
            .surfaces()
            .iter()
            .map(|s| s.domain().expect("flat").high())
            .collect();
        let total = scene.surfaces().len() * across * across;
        let batch = |number: usize| {
            let walk = Walk::new(scene, power, each, seed * 1000 + number as u64).expect("legal");
            let mut sums = vec![0.0f64; 3 * total];
            let mut squares = vec![0.0f64; 3 * total];
            let mut counts = vec![0u32; total];
            for block in 0..walk.blocks() {
                for record in walk.trace(block).records {
                    let high = highs[record.surface as usize];
                    let cell = |x: f32, high: f64| {
                        ((f64::from(x) / high * across as f64) as usize).min(across - 1)
                    };
                    let at = cell(record.u, high[0]) * across + cell(record.v, high[1]);
                    let at = record.surface as usize * across * across + at;
                    counts[at] += 1;
                    for c in 0..3 {
                        let flux = f64::from(record.flux[c]);
                        sums[3 * at + c] += flux;
                        squares[3 * at + c] += flux * flux;
                    }
                }
            }
            let single =
                |values: Vec<f64>| values.into_iter().map(|x| x as f32).collect::<Vec<f32>>();
            (single(sums), squares, counts)
        };
        let n = BATCHES as f64;
        let (mut all, mut counts) = (vec![[0.0; 2]; 3 * total], vec![0.0; total]);
        let mut batches = Vec::new();
        // a few at a time: each holds three numbers a cell
        for numbers in (0..BATCHES).collect::<Vec<usize>>().chunks(4) {
            let done: Vec<_> = numbers.par_iter().map(|&number| batch(number)).collect();
            for (sums, squares, hits) in done {
                for (all, (sum, square)) in all.iter_mut().zip(sums.iter().zip(squares)) {
                    all[0] += f64::from(*sum) / n;
                    all[1] += square / (n * n);
                }
                for (count, hits) in counts.iter_mut().zip(hits) {
                    *count += f64::from(hits);
                }
                batches.push(sums);
            }
        }
        Self {
            across,
            batches,
            all,
            counts,
            areas: scene.surfaces().iter().map(Surface::area).collect(),
        }
    }

    fn cell(&self, surface: usize, cell: usize, channel: usize) -> Mean {
        let cells = self.across * self.across;
        let at = 3 * (surface * cells + cell) + channel;
        let area = self.areas[surface] / cells as f64;
        Mean::of(self.batches.iter().map(move |b| f64::from(b[at]) / area))
    }

    /// χ² of the cells of a surface against what paths found. Hits arrive in cells as a compound Poisson process, so that the variance of a cell is its
    /// mean times Σw²/Σw of its hits' fluxes w, which is pooled over 4 × 4 cells as it varies slowly. The statistic of so many cells is taken for normal,
    /// with the fourth moment that few hits a cell give it.
    fn goodness(&self, surface: usize, channel: usize, expected: &[[Mean; 3]]) -> f64 {
        let cells = self.across * self.across;
        let area = self.areas[surface] / cells as f64;
        let pooled = self.across.div_ceil(4);
        let block = |k: usize| (k / self.across / 4) * pooled + (k % self.across) / 4;
        let mut sums = vec![[0.0; 3]; pooled * pooled];
        for k in 0..cells {
            let sum = &mut sums[block(k)];
            sum[0] += self.all[3 * (surface * cells + k) + channel][0];
            sum[1] += self.all[3 * (surface * cells + k) + channel][1];
            sum[2] += self.counts[surface * cells + k];
        }
        let (mut statistic, mut variance, mut used) = (0.0, 0.0, 0.0);
        for k in 0..cells {
            let [flux, squares, hits] = sums[block(k)];
            let mean = expected[k][channel];
            if flux <= 0.0 || mean.value <= 0.0 {
                continue;
            }
            let expected = mean.value * area;
            let spread = expected * squares / flux + (mean.error * area).powi(2);
            let found = self.all[3 * (surface * cells + k) + channel][0];
            statistic += (found - expected).powi(2) / spread;
            // as many of the block's hits as are expected in this cell
            let hits = hits * expected / flux;
            variance += 2.0 + 1.0 / hits.max(1e-3);
            used += 1.0;
        }
        if used < 1.0 {
            return 1.0;
        }
        Normal::standard().sf((statistic - used) / f64::sqrt(variance))
    }

    fn surface(&self, surface: usize, channel: usize) -> Mean {
        let cells = self.across * self.across;
        let area = self.areas[surface];
        Mean::of(self.batches.iter().map(move |b| {
            let all = 3 * surface * cells..3 * (surface + 1) * cells;
            b[all]
                .iter()
                .skip(channel)
                .step_by(3)
                .map(|&x| f64::from(x))
                .sum::<f64>()
                / area
        }))
    }
}

/// Mean irradiance over each cell of each surface by paths traced from random places of it.
fn traced(scene: &Scene, across: usize, draws: usize) -> Vec<Vec<[Mean; 3]>> {
    let tracer = PathTracer::new(scene).expect("three channels");
    let cells = across * across;
    let surface = |surface: usize| {
        let described = &scene.surfaces()[surface];
        let high = described.domain().expect("flat").high();
        let own = scene.primitive(surface, 0);
        let cell = |cell: usize| {
            let mut random = random::stream(1, "evidence", (surface * cells + cell) as u64);
            let values: Vec<[f64; 3]> = (0..draws)
                .map(|_| {
                    let at = [cell / across, cell % across];
                    let [u, v] = [0, 1].map(|k: usize| {
                        (at[k] as f64 + open_unit(&mut random)) / across as f64 * high[k]
                    });
                    let place = described.shape.place(0, u, v);
                    let normal = described.shape.normal(0, place);
                    tracer.irradiance(place, normal, own, &mut random)
                })
                .collect();
            [0, 1, 2].map(|c: usize| Mean::of(values.iter().map(move |v| v[c])))
        };
        (0..cells).into_par_iter().map(cell).collect()
    };
    (0..scene.surfaces().len()).map(surface).collect()
}

fn cube(report: &mut Report) {
    let scene = scene("floor-cube.toml");
    let paths = report.paths(1e6);
    let walk = Walk::new(&scene, Power::Same, paths, 1).expect("legal");
    let (hits, ledger) = walk.run().expect("closed");
    let imbalance = ledger.imbalance().abs();
    report.say(
        "ledger of the cube",
        &format!("{imbalance:.1e} (at most 1e-9)"),
        imbalance < 1e-9,
    );
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let factor = match surface.name.as_str() {
            "floor" => 0.0,
            "ceiling" => 0.199_825,
            _ => 0.200_044,
        };
        let first = hits.on(index).iter().filter(|r| r.bounce == 1).count();
        let share = first as f64 / paths as f64;
        let error = (factor * (1.0 - factor) / paths as f64).sqrt();
        report.say(
            &format!("first hits on {}, N = {paths}", surface.name),
            &format!("{share:.6} (must be {factor:.6} within 4 x {error:.6})"),
            (share - factor).abs() <= 4.0 * error,
        );
    }
}

fn furnace(report: &mut Report) {
    let scene = scene("furnace.toml");
    let paths = report.paths(4e6);
    let cells = Cells::measure(&scene, Power::Same, paths, 8, 2);
    let exact = Mean::exactly(std::f64::consts::TAU);
    let mut families = Vec::new();
    for surface in 0..scene.surfaces().len() {
        let z: Vec<f64> = (0..64)
            .map(|k| cells.cell(surface, k, 1).off(exact))
            .collect();
        families.push(chi_squared(&z));
    }
    let (least, holds) = holm(&families);
    report.say(
        &format!("furnace, 6 x 64 cells, N = {paths}: chi-squared"),
        &format!("least p after Holm {least:.3}"),
        holds,
    );
    let all = Mean::of((0..BATCHES).map(|b| {
        cells.batches[b]
            .iter()
            .skip(1)
            .step_by(3)
            .map(|&x| f64::from(x))
            .sum::<f64>()
            / 6.0
    }));
    let off = (all.value - exact.value) / all.error;
    report.say(
        "furnace, mean B - E over rho",
        &format!(
            "{:.6} (must be {:.6}; {off:+.2} standard errors of {:.6})",
            all.value, exact.value, all.error
        ),
        off.abs() <= 3.0,
    );
}

fn sphere(report: &mut Report) {
    let scene = scene("sphere.toml");
    let paths = report.paths(1e6);
    let walk = Walk::new(&scene, Power::Same, paths, 3).expect("legal");
    let (hits, _) = walk.run().expect("closed");
    let high = scene.surfaces()[0].domain().expect("a chart").high();
    let mut counts = vec![0.0; 1024];
    let (mut second, mut later) = (0.0, 0.0);
    for record in hits.on(0).iter().filter(|r| r.bounce > 1) {
        later += 1.0;
        if record.bounce == 2 {
            let cell = |x: f32, high: f64| ((f64::from(x) / high * 32.0) as usize).min(31);
            counts[cell(record.u, high[0]) * 32 + cell(record.v, high[1])] += 1.0;
            second += 1.0;
        }
    }
    let expected = second / 1024.0;
    let statistic: f64 = counts
        .iter()
        .map(|c: &f64| (c - expected).powi(2) / expected)
        .sum();
    let p = ChiSquared::new(1023.0).expect("cells").sf(statistic);
    report.say(
        &format!("sphere, second hits uniform on 32 x 32 cells of equal area, N = {paths}"),
        &format!("chi-squared {statistic:.0} of 1023, p = {p:.3}"),
        p > 0.001,
    );
    // rho = 0.8: later hits have mean rho/(1 - rho) = 4 and variance rho/(1 - rho)^2 = 20 a path
    let mean = later / paths as f64;
    let off = (mean - 4.0) / (20.0 / paths as f64).sqrt();
    report.say(
        "sphere, reflected irradiance over that of Phi rho/(4 pi R^2 (1 - rho))",
        &format!("{:.5} ({off:+.2} standard errors)", mean / 4.0),
        off.abs() <= 3.0,
    );
}

fn cornell(report: &mut Report) {
    let scene = scene("cornell-box-rgb.toml");
    let (paths, across) = (report.paths(1e7), 32);
    let photons = Cells::measure(&scene, Power::Same, paths, across, 4);
    let draws = (1000.0 * report.scale).max(100.0) as usize;
    let traced = traced(&scene, across, draws);
    let reference = Reference::new(scene.clone());
    reference.solved();
    let count = scene.surfaces().len();
    let cells = across * across;
    let mut chi = Vec::new();
    let mut farthest: f64 = 0.0;
    let mut all_within = true;
    println!(
        "       surface      channel  photons             paths               off/se   chi2 p  balance/paths"
    );
    for surface in 0..count {
        let described = &scene.surfaces()[surface];
        let grid = density_lab::space::Grid::new(
            [0.0; 2],
            described.domain().expect("flat").high(),
            [across; 2],
        );
        let solved = reference.cell_means(surface, &grid.expect("cells"), 1);
        for c in 0..3 {
            let found = photons.surface(surface, c);
            let parts = traced[surface].iter().map(|cell| cell[c]);
            let error = parts.clone().map(|m| m.error.powi(2)).sum::<f64>().sqrt() / cells as f64;
            let by_paths = Mean {
                value: parts.map(|m| m.value).sum::<f64>() / cells as f64,
                error,
                count: cells * draws,
            };
            let off = found.off(by_paths);
            let p = photons.goodness(surface, c, &traced[surface]);
            chi.push(p);
            farthest = farthest.max(off.abs());
            all_within &= off.abs() <= 3.0;
            let balance = solved.iter().map(|s| s[c]).sum::<f64>() / cells as f64;
            println!(
                "       {:<12} {}        {:.5} ± {:.5}   {:.5} ± {:.5}   {off:+.2}   {p:.3}   {:.5}",
                described.name,
                ["r", "g", "b"][c],
                found.value,
                found.error,
                by_paths.value,
                error,
                balance / by_paths.value,
            );
        }
    }
    report.say(
        &format!("box with blocks, N = {paths}: mean of each surface and channel by photons and by paths, worst of {}", 3 * count),
        &format!("{farthest:.2} standard errors (at most 3)"),
        all_within,
    );
    let (least, holds) = holm(&chi);
    report.say(
        "box with blocks: 32 x 32 cells of each surface and channel, chi-squared",
        &format!("least p after Holm {least:.3}"),
        holds,
    );
}

fn schemes(report: &mut Report) {
    let scene = scene("cornell-box-rgb.toml");
    let paths = report.paths(2e6);
    let attenuated = Power::Attenuated {
        threshold: 0.1,
        kill: 0.5,
    };
    let same = Cells::measure(&scene, Power::Same, paths, 8, 5);
    let other = Cells::measure(&scene, attenuated, paths, 8, 6);
    let mut p = Vec::new();
    for surface in 0..scene.surfaces().len() {
        for cell in 0..64 {
            for c in 0..3 {
                p.push(two_sided(
                    same.cell(surface, cell, c)
                        .off(other.cell(surface, cell, c)),
                ));
            }
        }
    }
    let (least, holds) = holm(&p);
    report.say(
        &format!(
            "both schemes of power, N = {paths} each: {} cells and channels",
            p.len()
        ),
        &format!("least p after Holm {least:.3}"),
        holds,
    );
}

fn main() -> ExitCode {
    let scale = std::env::args()
        .nth(1)
        .map_or(1.0, |text| text.parse().expect("a share of the photons"));
    let mut report = Report {
        failed: false,
        scale,
    };
    cube(&mut report);
    furnace(&mut report);
    sphere(&mut report);
    schemes(&mut report);
    cornell(&mut report);
    if report.failed {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
