//! Sums of derivatives of the Gaussian over all pairs of data.

use super::lattice::{Cells, Lattice, TERMS};
use crate::numeric::Sum;
use crate::numeric::special::normal_density;
use crate::sample::{Sample, Weights};
use crate::space::binning::range;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Beyond this many g the Gaussian and its derivatives count for nothing: φ(9) is 1e-18.
const REACH: f64 = 9.0;

/// δ/g is at most this where the answer is to be exact.
const FINEST: f64 = 0.0625;

/// δ/g where a glance will do: the remainder is then below 1e-7 for r = 0.
const COARSEST: f64 = 0.25;

/// Cells that are collected straight from the data; more are reached by way of a sort.
const DENSE: f64 = (1 << 17) as f64;

/// Cells for which the data are looked at in the first place, if coarser ones would do, and data for each of them: the table of their moments still stays in the second-level cache,
/// and all coarser lattices are made from them.
const FIRST: f64 = (1 << 13) as f64;
const DATA_PER_CELL: f64 = 16.0;

/// Cells at most.
const MOST: f64 = (1 << 21) as f64;

/// Pairs within reach that are added one by one where cells would be too many.
const FEW_PAIRS: f64 = 3e7;

/// Σᵢⱼ wᵢwⱼ φ⁽ʳ⁾((Xᵢ - Xⱼ)/g) for any g and even r, with Σw = 1 and i = j included.
///
/// One pass over the data makes the lags of a lattice fine enough for the g asked for, and of coarser ones without another pass; from then on a sum costs as much as
/// there are lags within nine g, whatever n. A smaller g makes a finer lattice. Where the data lie too far apart for a lattice, gaps that no kernel
/// reaches across are closed first (one sort), or the few pairs within reach are added one by one.
///
/// # Error
/// The displacement within a lag is expanded to the seventh power. With ρ = δ/g ≤ 1/16 the remainder is below 1.1 ρ⁸ √((r+8)!)/8! of
/// Σ wᵢwⱼ φ widened a little (Cramér's bound for Hermite functions): 1e-12 for r = 0, 1e-10 for r = 4, 2e-9 for r = 6 of the
/// *peak* of the sum, and a thousand times less for ordinary data, whose remainders differ in sign. Judged by direct sums in the tests.
pub struct GaussianPairs {
    sample: Sample<1>,
    low: f64,
    high: f64,
    lattices: Mutex<Vec<Arc<Lattice>>>,
    /// The finest cells into which the data were collected.
    finest: Mutex<Option<Cells>>,
    sorted: OnceLock<Sorted>,
}

/// Data in order, with their weights.
struct Sorted {
    points: Vec<f64>,
    weights: Vec<f64>,
}

impl GaussianPairs {
    /// The pairs of `sample`. One pass for the range; all else when it is asked for.
    pub fn new(sample: &Sample<1>) -> Self {
        Self::within(sample, range(sample.coordinates()))
    }

    /// The same if the least and the largest datum are known.
    pub fn within(sample: &Sample<1>, (low, high): (f64, f64)) -> Self {
        Self {
            sample: sample.clone(),
            low,
            high,
            lattices: Mutex::new(Vec::new()),
            finest: Mutex::new(None),
            sorted: OnceLock::new(),
        }
    }

    /// The distance between the least and the largest datum.
    pub fn range(&self) -> f64 {
        self.high - self.low
    }

    /// Σᵢⱼ wᵢwⱼ φ⁽ʳ⁾((Xᵢ - Xⱼ)/g) for even r = `order`.
    ///
    /// # Panics
    /// If `order` is odd (the sum is 0 by symmetry) or `g` is not positive and finite.
    pub fn sum(&self, order: usize, g: f64) -> f64 {
        self.sum_at(order, g, FINEST)
    }

    /// The same for a glance over many g: with a lattice four times as coarse, 1e-7 of the peak for r = 0.
    ///
    /// # Panics
    /// As [`GaussianPairs::sum`].
    pub fn glance(&self, order: usize, g: f64) -> f64 {
        self.sum_at(order, g, COARSEST)
    }

    /// Collects the data for glances down to `g` in one pass, where that is not yet done. Without it a search that goes on to smaller g looks at the data again and again.
    pub fn expect(&self, g: f64) {
        let step = power_of_two_below(COARSEST * g);
        if Lattice::cells(self.low, self.high, step) <= DENSE {
            let mut finest = self.finest.lock().unwrap_or_else(PoisonError::into_inner);
            if finest.as_ref().is_none_or(|cells| cells.step > step) {
                *finest = Some(self.collect(step));
            }
        }
    }

    /// Cells of that step, or of a finer one that costs no more.
    fn collect(&self, step: f64) -> Cells {
        let each = match self.sample.weights() {
            Weights::Equal(_) => None,
            Weights::Each(weights) => Some(&weights[..]),
        };
        let most = FIRST.min(self.sample.len() as f64 / DATA_PER_CELL);
        let mut fine = step;
        // not without end where the data have no range
        for _ in 0..16 {
            if Lattice::cells(self.low, self.high, 0.5 * fine) > most {
                break;
            }
            fine *= 0.5;
        }
        let span = (self.low, self.high);
        Cells::collect(self.sample.coordinates(), each, span, fine)
    }

    fn sum_at(&self, order: usize, g: f64, ratio: f64) -> f64 {
        assert!(order.is_multiple_of(2), "odd derivatives cancel");
        assert!(g > 0.0 && g.is_finite(), "a width is positive and finite");
        match self.lattice(g, ratio) {
            Some(lattice) => over_lags(&lattice, order, g),
            None => self.sorted().one_by_one(order, g),
        }
    }

    /// The coarsest lattice at hand that is fine enough for `g`, or a new one; `None` if pairs are better added one by one.
    fn lattice(&self, g: f64, ratio: f64) -> Option<Arc<Lattice>> {
        // one caller builds, the others wait: the same work is not done twice
        let mut lattices = self.lattices.lock().unwrap_or_else(PoisonError::into_inner);
        let fine = |lattice: &&Arc<Lattice>| {
            lattice.step <= ratio * g && reaches(lattice, g, self.range())
        };
        if let Some(lattice) = lattices.iter().find(fine) {
            return Some(lattice.clone());
        }
        let step = power_of_two_below(ratio * g);
        let made = if Lattice::cells(self.low, self.high, step) <= DENSE {
            self.dense(step)
        } else {
            let sorted = self.sorted();
            if sorted.pairs_within(REACH * g, FEW_PAIRS) {
                return None;
            }
            // closed for this g and the next few above it
            let (points, length) = sorted.closed(2.5 * REACH * g);
            // a little coarser than asked for rather than beyond the memory
            let step = step.max(power_of_two_below(2.0 * length / MOST));
            let cells = Cells::collect(&points, Some(&sorted.weights), (0.0, length), step);
            let mut lattice = Lattice::new(&cells, 1.0);
            lattice.whole_below = 2.5 * REACH * g;
            lattice
        };
        let made = Arc::new(made);
        lattices.push(made.clone());
        lattices.sort_by(|a, b| b.step.total_cmp(&a.step));
        Some(made)
    }

    /// A lattice of that step over all data, from cells at hand if they are fine enough, else from the data.
    fn dense(&self, step: f64) -> Lattice {
        let mass = match self.sample.weights() {
            Weights::Equal(_) => self.sample.len() as f64,
            Weights::Each(_) => self.sample.mass(),
        };
        let mut finest = self.finest.lock().unwrap_or_else(PoisonError::into_inner);
        let cells = match finest.take() {
            Some(cells) if cells.step <= step => cells,
            _ => self.collect(step),
        };
        let mut coarse = None;
        while coarse.as_ref().unwrap_or(&cells).step < step {
            coarse = Some(coarse.as_ref().unwrap_or(&cells).doubled());
        }
        let lattice = Lattice::new(coarse.as_ref().unwrap_or(&cells), mass);
        *finest = Some(cells);
        lattice
    }

    fn sorted(&self) -> &Sorted {
        self.sorted.get_or_init(|| {
            let mass = self.sample.mass();
            let mut pairs: Vec<(f64, f64)> = self
                .sample
                .coordinates()
                .iter()
                .enumerate()
                .map(|(i, &x)| (x, self.sample.weight(i) / mass))
                .collect();
            pairs.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let (points, weights) = pairs.into_iter().unzip();
            Sorted { points, weights }
        })
    }
}

/// Whether the lags of `lattice` are those of the data up to the reach of g: where gaps were closed, only below the length that they keep.
fn reaches(lattice: &Lattice, g: f64, range: f64) -> bool {
    let length = lattice.lags.len() as f64 * lattice.step;
    length >= range || REACH * g <= lattice.whole_below
}

impl Sorted {
    /// Whether at most `most` pairs are within `reach`.
    fn pairs_within(&self, reach: f64, most: f64) -> bool {
        let (mut first, mut pairs) = (0, 0.0);
        for (i, x) in self.points.iter().enumerate() {
            while x - self.points[first] > reach {
                first += 1;
            }
            pairs += (i - first) as f64;
            if pairs > most {
                return false;
            }
        }
        true
    }

    /// The points seen from the first, with every gap beyond `most` made as short as that, and the length that they then span.
    fn closed(&self, most: f64) -> (Vec<f64>, f64) {
        let mut place = Sum::default();
        let mut before = self.points[0];
        let points: Vec<f64> = self
            .points
            .iter()
            .map(|&x| {
                place.add((x - before).min(most));
                before = x;
                place.value()
            })
            .collect();
        let length = points[points.len() - 1];
        (points, length)
    }

    /// The definition, over the pairs within reach.
    fn one_by_one(&self, order: usize, g: f64) -> f64 {
        const BLOCK: usize = 1 << 12;
        let blocks: Vec<f64> = (0..self.points.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let from = block * BLOCK;
                let to = (from + BLOCK).min(self.points.len());
                let mut sum = Sum::default();
                for i in from..to {
                    let (x, w) = (self.points[i], self.weights[i]);
                    let mut near = 0.5 * w * derivative(order, 0.0);
                    for j in (0..i).rev() {
                        let u = (x - self.points[j]) / g;
                        if u > REACH {
                            break;
                        }
                        near += self.weights[j] * derivative(order, u);
                    }
                    sum.add(2.0 * w * near);
                }
                sum.value()
            })
            .collect();
        blocks.into_iter().collect::<Sum>().value()
    }
}

/// φ⁽ʳ⁾(u) for even r.
fn derivative(order: usize, u: f64) -> f64 {
    let (mut before, mut now) = (0.0, 1.0);
    for k in 0..order {
        (before, now) = (now, u * now - k as f64 * before);
    }
    now * normal_density(u)
}

/// Σⱼ Σₚ Mⱼ[p] ρᵖ φ⁽ʳ⁺ᵖ⁾(jρ), lags below 0 as those above.
fn over_lags(lattice: &Lattice, order: usize, g: f64) -> f64 {
    let ratio = lattice.step / g;
    let mut powers = [1.0; TERMS];
    for p in 1..TERMS {
        // φ⁽ᵖ⁾ = (-1)ᵖ Heₚ φ
        powers[p] = -ratio * powers[p - 1];
    }
    let within = (REACH / ratio).ceil().min(lattice.lags.len() as f64) as usize;
    let mut total = Sum::default();
    for (j, lag) in lattice.lags[..within].iter().enumerate() {
        let u = j as f64 * ratio;
        let (mut before, mut now) = (0.0, 1.0);
        for k in 0..order {
            (before, now) = (now, u * now - k as f64 * before);
        }
        let mut term = 0.0;
        for p in 0..TERMS {
            term += lag[p] * powers[p] * now;
            (before, now) = (now, u * now - (order + p) as f64 * before);
        }
        total.add(if j == 0 { 1.0 } else { 2.0 } * term * normal_density(u));
    }
    total.value()
}

/// The largest power of two not above `x`, exactly.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7FF << 52))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::special::normal_density_derivative;
    use crate::space::Domain;

    fn judge(points: &[f64], weights: Option<&[f64]>, order: usize, g: f64) -> (f64, f64) {
        let mass = weights.map_or(points.len() as f64, |w| w.iter().sum());
        let weight = |i: usize| weights.map_or(1.0, |w| w[i]) / mass;
        let mut sum = Sum::default();
        let mut size = Sum::default();
        for (i, x) in points.iter().enumerate() {
            for (j, y) in points.iter().enumerate() {
                let term =
                    weight(i) * weight(j) * normal_density_derivative(order as u32, (x - y) / g);
                sum.add(term);
                size.add(term.abs());
            }
        }
        (sum.value(), size.value())
    }

    fn golden(n: usize) -> Vec<f64> {
        (0..n)
            .map(|i| {
                let u = (i as f64 * 0.618_033_988_749_895).fract();
                (6.0 * u).sin() + 3.0 * u * u
            })
            .collect()
    }

    fn sample(points: &[f64], weights: Option<&[f64]>) -> Sample<1> {
        let points = points.iter().map(|&x| [x]).collect();
        match weights {
            None => Sample::equal(points, Domain::whole()),
            Some(w) => Sample::new(points, Weights::Each(w.to_vec().into()), Domain::whole()),
        }
        .expect("legal")
    }

    #[test]
    fn sums_are_those_of_the_definition() {
        let points = golden(400);
        let weights: Vec<f64> = points.iter().map(|x| 7.0 * x * x).collect();
        let far: Vec<f64> = points.iter().map(|x| x + 1e6).collect();
        let mut outliers = points.clone();
        outliers.extend([1e9, -1e14, 1e300]);
        let tied: Vec<f64> = points.iter().map(|x| (x * 10.0).round() / 10.0).collect();
        for (points, weights) in [
            (&points, None),
            (&points, Some(&weights[..])),
            (&far, None),
            (&outliers, None),
            (&tied, None),
        ] {
            let pairs = GaussianPairs::new(&sample(points, weights));
            for order in [0, 4, 6, 14] {
                for g in [0.3, 0.01, 0.05, 2.0, 20.0] {
                    let (exact, size) = judge(points, weights, order, g);
                    let got = pairs.sum(order, g);
                    assert!(
                        (got - exact).abs() < 1e-10 * size,
                        "{order} {g}: {got} {exact} {size}"
                    );
                }
            }
        }
    }

    #[test]
    fn gaps_are_closed_where_points_are_many_and_far_apart() {
        // two crowds with more pairs than are added one by one, 10⁹ apart
        let mut points = golden(9000);
        points.extend(golden(9000).iter().map(|x| x + 1e9));
        let pairs = GaussianPairs::new(&sample(&points, None));
        let near = GaussianPairs::new(&sample(&golden(9000), None));
        for (order, g) in [(0, 0.5), (4, 0.5), (4, 1.0), (0, 8.0)] {
            // positions near 10⁹ have seven decimals
            let (got, half) = (pairs.sum(order, g), near.sum(order, g));
            assert!((got / (0.5 * half) - 1.0).abs() < 1e-6, "{got} {half}");
        }
        assert!(!pairs.lattices.lock().expect("not poisoned").is_empty());
    }

    #[test]
    fn a_weight_is_a_repetition() {
        let points = golden(50);
        let weights: Vec<f64> = (0..50).map(|i| f64::from(i % 3)).collect();
        let repeated: Vec<f64> = points
            .iter()
            .zip(&weights)
            .flat_map(|(x, w)| std::iter::repeat_n(*x, *w as usize))
            .collect();
        let weighted = GaussianPairs::new(&sample(&points, Some(&weights)));
        let counted = GaussianPairs::new(&sample(&repeated, None));
        for g in [0.1, 1.0] {
            assert!((weighted.sum(4, g) / counted.sum(4, g) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let points = golden(300_000);
        let run = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("threads")
                .install(|| {
                    let pairs = GaussianPairs::new(&sample(&points, None));
                    [0.2, 0.01].map(|g| pairs.sum(4, g).to_bits())
                })
        };
        assert_eq!(run(1), run(3));
    }
}
