//! How far are the bandwidths that selectors read off a lattice of moments from those of the definitions, summed over all pairs?
//!
//! ```text
//! cargo run --release --example evidence-selector -- [N]
//! ```
//!
//! N data (20 000 unless told) of a bimodal density and of the same rounded to hundredths. Each selector's equation is written down once more here, over plain sums of
//! all pairs within nine widths, and its root is looked for between 1 ± 10⁻⁴ times the h that the selector gave. O(N²) time. Exit code 1 if one is
//! farther away than 10⁻⁶ of h. Roots are met to some 10⁻⁹, places of minima to 10⁻⁷: around them a criterion has the same fifteen digits.

use density_lab::kernel::{Bandwidth, Shape};
use density_lab::sample::Sample;
use density_lab::selector::named;
use density_lab::space::Domain;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::f64::consts::{PI, SQRT_2};
use std::process::ExitCode;

/// Relative distance of the places between which the root is looked for.
const BESIDE: f64 = 1e-4;

/// What is allowed.
const FARTHEST: f64 = 1e-6;

/// A sample in units of its deviation, in order.
struct Pairs {
    points: Vec<f64>,
    unit: f64,
    /// min(1, quartile range / 1.349 deviations), as R has it.
    scale: f64,
}

impl Pairs {
    fn new(data: &[f64]) -> Self {
        let mut points = data.to_vec();
        points.sort_unstable_by(f64::total_cmp);
        let n = points.len() as f64;
        let mean = points.iter().sum::<f64>() / n;
        let unit = (points.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let quartile = |p: f64| {
            let place = p * (n - 1.0);
            let (below, beyond) = (place as usize, place.fract());
            points[below] + beyond * (points[(below + 1).min(points.len() - 1)] - points[below])
        };
        let scale = ((quartile(0.75) - quartile(0.25)) / 1.349 / unit).min(1.0);
        for x in &mut points {
            *x = (*x - mean) / unit;
        }
        Self {
            points,
            unit,
            scale,
        }
    }

    fn n(&self) -> f64 {
        self.points.len() as f64
    }

    /// Σᵢⱼ φ⁽ʳ⁾((Xᵢ - Xⱼ)/g) / n², i = j included, each pair added by itself.
    fn sum(&self, order: usize, g: f64) -> f64 {
        let derivative = |u: f64| {
            let (mut before, mut now) = (0.0, 1.0);
            for k in 0..order {
                (before, now) = (now, u * now - k as f64 * before);
            }
            now * (-0.5 * u * u).exp() / (2.0 * PI).sqrt()
        };
        let of_one: Vec<f64> = (0..self.points.len())
            .into_par_iter()
            .map(|i| {
                let near = self.points[..i].iter().rev();
                near.map(|x| (self.points[i] - x) / g)
                    .take_while(|u| *u < 9.5)
                    .map(derivative)
                    .sum()
            })
            .collect();
        (2.0 * of_one.iter().sum::<f64>() + self.n() * derivative(0.0)) / self.n().powi(2)
    }

    /// d/dg of the sum of order 0: φ″(u) = (u² - 1) φ(u).
    fn slope(&self, g: f64) -> f64 {
        (self.sum(2, g) + self.sum(0, g)) / g
    }

    /// Sheather and Jones' Ŝᵣ(g).
    fn functional(&self, order: usize, g: f64) -> f64 {
        self.sum(order, g) / (1.0 - 1.0 / self.n()) / g.powi(order as i32 + 1)
    }

    /// (R(K) / (n R(f″)))^(1/5): the bandwidth of least AMISE if R(f″) is `roughness`.
    fn best(&self, roughness: f64) -> f64 {
        (0.5 / PI.sqrt() / self.n() / roughness).powf(0.2)
    }

    fn third(&self) -> f64 {
        -self.functional(6, 1.23 * self.scale * self.n().powf(-1.0 / 9.0))
    }

    fn squared_norm(&self, s: usize, h: f64) -> f64 {
        let g = SQRT_2 * h;
        let sign = if s.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * self.sum(2 * s, g) / g.powi(2 * s as i32 + 1)
    }
}

/// A function of the bandwidth.
type Equation = Box<dyn Fn(&Pairs, f64) -> f64>;

/// Something that is 0 at the selector's bandwidth, in units of the deviation.
fn equation(name: &str, pairs: &Pairs) -> Equation {
    let n = pairs.n();
    match name {
        "sheather-jones" => {
            let a = 1.24 * pairs.scale * n.powf(-1.0 / 7.0);
            let ratio = pairs.functional(4, a) / pairs.third();
            let alpha = 1.357 * ratio.powf(1.0 / 7.0);
            Box::new(move |p, h| p.best(p.functional(4, alpha * h.powf(5.0 / 7.0))) - h)
        }
        "sheather-jones-dpi" => {
            let g = (2.394 / (n * pairs.third())).powf(1.0 / 7.0);
            let best = pairs.best(pairs.functional(4, g));
            Box::new(move |_, h| best - h)
        }
        "improved-sheather-jones" => Box::new(move |p, h| {
            let mut norm = p.squared_norm(7, h);
            for s in (2..7).rev() {
                let odd: f64 = (1..=s).map(|k| (2 * k - 1) as f64).product();
                let constant = (1.0 + 0.5_f64.powf(s as f64 + 0.5)) / 3.0;
                let time = (2.0 * constant * odd / (2.0 * PI).sqrt() / n / norm)
                    .powf(2.0 / (3.0 + 2.0 * s as f64));
                norm = p.squared_norm(s, time.sqrt());
            }
            (2.0 * n * PI.sqrt() * norm).powf(-0.2) - h
        }),
        // d/dh of [S(√2 h)/√2 - 2 (S(h) - φ(0)/n) / share] / h
        _ => {
            let share = if name == "lscv" { 1.0 - 1.0 / n } else { 1.0 };
            Box::new(move |p, h| {
                let peak = (2.0 * PI).sqrt().recip() / n;
                let value = p.sum(0, SQRT_2 * h) / SQRT_2 - 2.0 / share * (p.sum(0, h) - peak);
                (p.slope(SQRT_2 * h) - 2.0 / share * p.slope(h)) - value / h
            })
        }
    }
}

fn main() -> ExitCode {
    let n: usize = match std::env::args().nth(1).map(|word| word.parse()) {
        None => 20_000,
        Some(Ok(n)) if n >= 10 => n,
        _ => {
            eprintln!("N is a whole number from 10 on");
            return ExitCode::from(2);
        }
    };
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1986);
    let data: Vec<f64> = (0..n)
        .map(|_| {
            let z: f64 = StandardNormal.sample(&mut random);
            0.5 * z + if random.random::<bool>() { 1.0 } else { -1.0 }
        })
        .collect();
    let rounded: Vec<f64> = data.iter().map(|x| (x * 100.0).round() / 100.0).collect();
    let mut all_near = true;
    println!("| data | selector | h | relative distance from the definition's |");
    println!("| --- | --- | --- | --- |");
    for (kind, data) in [("as drawn", &data), ("rounded to 0.01", &rounded)] {
        let points = data.iter().map(|x| [*x]).collect();
        let sample = Sample::equal(points, Domain::whole()).expect("finite");
        let pairs = Pairs::new(data);
        for name in [
            "sheather-jones",
            "sheather-jones-dpi",
            "improved-sheather-jones",
            "ucv",
            "lscv",
        ] {
            let selection = named(name).expect("known").select(&sample, Shape::Gaussian);
            let selection = selection.expect("the data have a spread");
            let told = selection
                .warnings
                .iter()
                .any(|w| w.what.contains("instead") || w.what.contains("end of"));
            let Bandwidth::Fixed([h]) = selection.bandwidth else {
                unreachable!("these choose one width for all")
            };
            let equation = equation(name, &pairs);
            let [low, high] =
                [1.0 - BESIDE, 1.0 + BESIDE].map(|f| equation(&pairs, f * h / pairs.unit));
            // the root of the line through both
            let distance = BESIDE * (low + high) / (low - high);
            let near = distance.abs() <= FARTHEST;
            all_near &= near || told;
            let remark = if told {
                " (the selector itself says that this is no minimum)"
            } else {
                ""
            };
            println!("| {kind} | {name} | {h:.8} | {distance:.1e}{remark} |");
        }
    }
    if all_near {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
