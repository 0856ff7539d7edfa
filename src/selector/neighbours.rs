//! How many neighbours: k for the k-nearest-neighbour estimator, by leaving each datum out.
//!
//! Both rules judge f̂₋ᵢ(Xᵢ) = (k - 1)/k · M / V, with M the share of the other data within the k-th of them and V the size of the ball out to it: the **unbiased** convention, whatever the
//! estimate uses.
//!
//! # Pitfalls
//! - With k/(nV) instead of (k - 1)/(nV) the likelihood has no meaning: in an even density log f̂ is log f + log k - ψ(k) ≈ log f + 1/(2k) on average, so that the smallest k always seems best. With k - 1 it is
//!   log f - 1/(2k), the price of noise that it should be.
//! - ∫f̂ diverges (f̂ falls like 1/|x|), so that f̂ is no density and its likelihood no likelihood. What is compared is the same unnormalised estimate at the data only, where the tails have no part.
//! - ∫f̂² is finite on the line (f̂² falls like 1/x²) and is known in closed form there: between the places where the k nearest change, f̂ is a constant over a piecewise linear function. On a domain with walls the
//!   integral is over the domain. In the plane it would need a grid as fine as the closest data; so least squares is of the line only.
//! - 1/V has a finite variance from k = 3 on; least squares looks at k ≥ 4 only.
//! - Where k data or more coincide, f̂ is infinite; such k are left out, with a warning.
//!
//! # References
//! Silverman 1986, sections 3.4.3, 3.4.4 and 5.2; Kozachenko & Leonenko 1987 (the expectation of log V); Li 1984, Ann. Statist. 12 (cross-validation of k).

use super::SelectError;
use crate::neighbour::{Scratch, Searchable, at_each};
use crate::numeric::Sum;
use crate::sample::{Sample, Weights};
use crate::space::Warning;

/// How k is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeighbourRule {
    /// The largest Σᵢ wᵢ log f̂₋ᵢ(Xᵢ).
    Likelihood,
    /// The least ∫f̂² - 2 Σᵢ wᵢ f̂₋ᵢ(Xᵢ), on the line.
    LeastSquares,
}

impl NeighbourRule {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Likelihood, Self::LeastSquares];

    /// The names in the order of [`NeighbourRule::ALL`].
    pub const NAMES: [&'static str; 2] = ["likelihood-cross-validation", "lscv"];

    /// The rule of that name.
    pub fn named(name: &str) -> Option<Self> {
        let place = Self::NAMES.iter().position(|known| *known == name)?;
        Some(Self::ALL[place])
    }

    fn least(self) -> usize {
        match self {
            Self::Likelihood => 2,
            Self::LeastSquares => 4,
        }
    }

    fn what(self) -> &'static str {
        match self {
            Self::Likelihood => "likelihood cross-validation of k",
            Self::LeastSquares => "least-squares cross-validation of k",
        }
    }
}

/// A number of neighbours, with what the reader should know about how it came about.
#[derive(Clone, Debug)]
pub struct NeighboursChosen {
    /// k.
    pub k: usize,
    /// Ties, and minima at an end.
    pub warnings: Vec<Warning>,
}

/// A sample whose k is to be chosen.
pub struct Neighbours<'a, const D: usize> {
    sample: &'a Sample<D>,
    finder: std::sync::Arc<dyn crate::neighbour::Neighbours<D>>,
    /// Data of positive weight.
    count: usize,
}

impl<'a, const D: usize> Neighbours<'a, D>
where
    Sample<D>: Searchable<D>,
{
    /// Builds the finder. O(n log n).
    pub fn new(sample: &'a Sample<D>) -> Self {
        let finder = sample.neighbours();
        let count = finder.count();
        Self {
            sample,
            finder,
            count,
        }
    }

    /// The k of least criterion: on a ladder that grows by a fifth up to eight times the best so far, then between the rungs about the best. About 40 times the cost of an estimate at the data.
    ///
    /// # Errors
    /// If there are too few data or all coincide; for least squares also in the plane and where an axis wraps round.
    pub fn choose(&self, rule: NeighbourRule) -> Result<NeighboursChosen, SelectError> {
        let least = rule.least();
        let most = self.count.saturating_sub(2);
        if most < least {
            return Err(SelectError::TooFew {
                points: self.count,
                least: least + 2,
            });
        }
        if rule == NeighbourRule::LeastSquares {
            self.line()?;
        }
        let mut seen: Vec<(usize, f64)> = Vec::new();
        let mut best = (least, f64::INFINITY);
        let mut k = least;
        loop {
            let value = self.criterion(rule, k);
            seen.push((k, value));
            if value < best.1 {
                best = (k, value);
            }
            if k == most || (best.1.is_finite() && k > 64.max(8 * best.0)) {
                break;
            }
            k = most.min(k + (k / 5).max(1));
        }
        if best.1.is_infinite() {
            let place = self.sample.points()[0][0];
            let points = self.count;
            return Err(SelectError::NoSpread { points, place });
        }
        let last = seen[seen.len() - 1].0;
        // between the rungs, eight at a time
        loop {
            let below = seen.iter().map(|it| it.0).filter(|&k| k < best.0).max();
            let above = seen.iter().map(|it| it.0).filter(|&k| k > best.0).min();
            let (low, high) = (below.unwrap_or(best.0), above.unwrap_or(best.0));
            let step = ((high - low) / 8).max(1);
            let fresh: Vec<usize> = (low + 1..high)
                .step_by(step)
                .filter(|k| seen.iter().all(|it| it.0 != *k))
                .collect();
            if fresh.is_empty() {
                break;
            }
            for k in fresh {
                let value = self.criterion(rule, k);
                seen.push((k, value));
                if value < best.1 {
                    best = (k, value);
                }
            }
        }
        Ok(NeighboursChosen {
            k: best.0,
            warnings: warnings(rule, best.0, last == most, &mut seen),
        })
    }

    /// What `rule` makes least; infinite where k data or more coincide.
    pub fn criterion(&self, rule: NeighbourRule, k: usize) -> f64 {
        let densities = self.without_itself(k);
        if densities.iter().any(|(w, f)| *w > 0.0 && !f.is_finite()) {
            return f64::INFINITY;
        }
        let mass = self.sample.mass();
        let over = |of: fn(f64) -> f64| -> f64 {
            let terms = densities.iter().filter(|(w, _)| *w > 0.0);
            terms
                .map(|(w, f)| w / mass * of(*f))
                .collect::<Sum>()
                .value()
        };
        match rule {
            NeighbourRule::Likelihood => -over(f64::ln),
            NeighbourRule::LeastSquares => self.square(k) - 2.0 * over(|f| f),
        }
    }

    /// The weight of each datum and f̂₋ᵢ(Xᵢ).
    fn without_itself(&self, k: usize) -> Vec<(f64, f64)> {
        let mass = self.sample.mass();
        let rank = k as f64;
        let equal = matches!(self.sample.weights(), Weights::Equal(_));
        let look = |i: usize, scratch: &mut Scratch| {
            let own = self.sample.weight(i);
            if own <= 0.0 {
                return (0.0, 0.0);
            }
            let x = self.sample.points()[i];
            // itself is the nearest of all
            let squared = self.finder.distance(x, k + 1, scratch);
            let share = if equal {
                rank / (self.count as f64 - 1.0)
            } else {
                self.mass_within(x, squared, k + 1, own) / (mass - own)
            };
            let volume = self.finder.metric().ball(squared.sqrt());
            (own, share * (rank - 1.0) / rank / volume)
        };
        // by number, so that a datum can be left out of its own estimate
        let numbers: Vec<[f64; 1]> = (0..self.sample.len()).map(|i| [i as f64]).collect();
        at_each(&numbers, |i, scratch| look(i[0] as usize, scratch))
    }

    /// The weight of the nearest `rank` data but the one at the place itself, which weighs `own`; data equally far share.
    fn mass_within(&self, x: [f64; D], squared: f64, rank: usize, own: f64) -> f64 {
        let (mut inside, mut nearer, mut edge, mut tied) = (0.0, 0usize, 0.0, 0usize);
        self.finder.within(x, squared, &mut |j, distance| {
            let weight = self.sample.weight(j);
            if distance < squared {
                inside += weight;
                nearer += 1;
            } else {
                edge += weight;
                tied += 1;
            }
        });
        let share = (rank - nearer) as f64 / tied.max(1) as f64;
        share.mul_add(edge, inside) - own
    }

    fn line(&self) -> Result<(), SelectError> {
        if D == 1 && !self.sample.domain().wraps() {
            return Ok(());
        }
        Err(SelectError::Unable(
            "least-squares cross-validation of k needs a line that does not wrap round; give `likelihood-cross-validation` or a number".to_owned(),
        ))
    }

    /// ∫f̂² over the domain, on the line: window by window of k consecutive data.
    fn square(&self, k: usize) -> f64 {
        let sample = self.sample;
        let mass = sample.mass();
        let mut data: Vec<(f64, f64)> = (0..sample.len())
            .map(|i| (sample.points()[i][0], sample.weight(i) / mass))
            .filter(|&(_, w)| w > 0.0)
            .collect();
        data.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut below = Vec::with_capacity(data.len() + 1);
        let mut sum = Sum::default();
        below.push(0.0);
        for (_, w) in &data {
            sum.add(*w);
            below.push(sum.value());
        }
        let (low, high) = (sample.domain().low()[0], sample.domain().high()[0]);
        let factor = (k as f64 - 1.0) / k as f64;
        let mut total = Sum::default();
        for first in 0..=data.len() - k {
            let (a, b) = (data[first].0, data[first + k - 1].0);
            let start = if first > 0 {
                0.5 * (data[first - 1].0 + b)
            } else {
                f64::NEG_INFINITY
            };
            let end = data
                .get(first + k)
                .map_or(f64::INFINITY, |next| 0.5 * (a + next.0));
            let (start, end) = (start.max(low), end.min(high));
            let centre = 0.5 * (a + b);
            // ∫ 1/d² with d = b - x left of the centre and x - a right of it
            let (mut integral, left, right) = (0.0, end.min(centre), start.max(centre));
            if start < left {
                integral += 1.0 / (b - left) - 1.0 / (b - start);
            }
            if right < end {
                integral += 1.0 / (right - a) - 1.0 / (end - a);
            }
            let height = 0.5 * factor * (below[first + k] - below[first]);
            if integral > 0.0 {
                total.add(height * height * integral);
            }
        }
        total.value()
    }
}

fn warnings(
    rule: NeighbourRule,
    best: usize,
    to_the_end: bool,
    seen: &mut [(usize, f64)],
) -> Vec<Warning> {
    seen.sort_unstable_by_key(|it| it.0);
    let what = rule.what();
    let mut warnings = Vec::new();
    let tied = seen.iter().take_while(|it| it.1.is_infinite()).last();
    if let Some((k, _)) = tied {
        warnings.push(Warning {
            what: format!("up to {k} data or more coincide, where the estimate is infinite; {what} leaves such k out"),
            hint: "look at the data for ties and rounding, or use a kernel".to_owned(),
        });
    }
    let first = seen.iter().find(|it| it.1.is_finite()).map_or(0, |it| it.0);
    let last = seen[seen.len() - 1].0;
    if best == first || (best == last && to_the_end) {
        warnings.push(Warning {
            what: format!("{what} is least at an end of the range from {first} to {last} in which it is looked for"),
            hint: "the data do not determine k: compare estimates with several".to_owned(),
        });
    }
    warnings
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::numeric::{GaussLegendre, panels};
    use crate::random;
    use crate::space::Domain;
    use rand::RngExt;

    fn drawn(n: usize, purpose: u64) -> Vec<[f64; 1]> {
        let mut stream = random::stream(9, "neighbours", purpose);
        let sum = |stream: &mut random::Stream| -> f64 {
            (0..12).map(|_| stream.random::<f64>() - 0.5).sum()
        };
        (0..n).map(|_| [sum(&mut stream)]).collect()
    }

    /// f̂ at `x` from data with weights, all others sorted by distance.
    fn estimate(data: &[(f64, f64)], k: usize, x: f64) -> f64 {
        let mut near: Vec<(f64, f64)> = data.iter().map(|(y, w)| ((x - y).abs(), *w)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mass: f64 = near[..k].iter().map(|it| it.1).sum();
        let whole: f64 = near.iter().map(|it| it.1).sum();
        mass / whole * (k as f64 - 1.0) / k as f64 / (2.0 * near[k - 1].0)
    }

    #[test]
    fn both_criteria_are_as_written() {
        let points = drawn(30, 0);
        let weights: Vec<f64> = (0..30).map(|i| 1.0 + f64::from(i % 3)).collect();
        for (domain, weights) in [
            (Domain::whole(), vec![1.0; 30]),
            (Domain::whole(), weights.clone()),
            (Domain::walled([-3.0], [2.5]).unwrap(), weights),
        ] {
            let inside: Vec<(f64, f64)> = points
                .iter()
                .zip(&weights)
                .map(|(x, w)| (x[0].clamp(-3.0, 2.5), *w))
                .collect();
            let places = inside.iter().map(|it| [it.0]).collect();
            let each = inside.iter().map(|it| it.1).collect();
            let sample = Sample::normalised(places, each, domain.clone()).unwrap();
            let chooser = Neighbours::new(&sample);
            let mass: f64 = inside.iter().map(|it| it.1).sum();
            for k in [4, 7, 20] {
                let (mut surprise, mut cross) = (0.0, 0.0);
                for i in 0..30 {
                    let mut others = inside.clone();
                    let (x, w) = others.remove(i);
                    let density = estimate(&others, k, x);
                    surprise -= w / mass * density.ln();
                    cross += w / mass * density;
                }
                let got = chooser.criterion(NeighbourRule::Likelihood, k);
                assert!((got - surprise).abs() < 1e-12, "{k}: {got} {surprise}");
                let mut sorted: Vec<f64> = inside.iter().map(|it| it.0).collect();
                sorted.sort_by(f64::total_cmp);
                let kinks = sorted
                    .iter()
                    .enumerate()
                    .flat_map(|(i, a)| sorted[i..].iter().map(move |b| 0.5 * (a + b)));
                let [low, high] = [domain.low()[0].max(-400.0), domain.high()[0].min(400.0)];
                let cuts = panels(
                    low,
                    high,
                    kinks.chain([-30.0, -8.0, 8.0, 30.0]),
                    f64::INFINITY,
                );
                let square = GaussLegendre::new(20)
                    .integrate_panels(|x| estimate(&inside, k, x).powi(2), &cuts);
                // 1/x² from there on
                let beyond = |x: f64| 400.0 * estimate(&inside, k, x).powi(2);
                let tails = if domain.has_walls() {
                    0.0
                } else {
                    beyond(-400.0) + beyond(400.0)
                };
                let got = chooser.criterion(NeighbourRule::LeastSquares, k);
                let expected = square + tails - 2.0 * cross;
                // what is beyond 400 is known to some hundredths of itself
                assert!(
                    (got - expected).abs() < 1e-4 * expected.abs() + 0.05 * tails,
                    "{k}: {got} {expected}"
                );
                assert!((got - expected).abs() < 1e-9 || !domain.has_walls());
            }
        }
    }

    #[test]
    fn more_data_ask_for_more_neighbours_and_rounding_is_told() {
        for rule in NeighbourRule::ALL {
            let k = |n: usize| {
                let sample = Sample::equal(drawn(n, 1), Domain::whole()).unwrap();
                Neighbours::new(&sample).choose(rule).unwrap().k
            };
            let (few, many) = (k(100), k(4000));
            // at the centre of a normal (144 n⁴ f⁶/f″²)^(1/5) = 52 and 990; least squares is noisy
            assert!((8..=80).contains(&few), "{few}");
            assert!((100..=2400).contains(&many), "{many}");
            let rounded = drawn(300, 2)
                .iter()
                .map(|x| [(x[0] * 4.0).round()])
                .collect();
            let sample = Sample::equal(rounded, Domain::whole()).unwrap();
            let chosen = Neighbours::new(&sample).choose(rule).unwrap();
            assert!(!chosen.warnings.is_empty(), "{chosen:?}");
            let same = Sample::equal(vec![[2.0]; 40], Domain::whole()).unwrap();
            assert!(Neighbours::new(&same).choose(rule).is_err());
            let few = Sample::equal(vec![[1.0], [2.0], [4.0]], Domain::whole()).unwrap();
            assert!(Neighbours::new(&few).choose(rule).is_err());
        }
    }

    #[test]
    fn the_plane_has_the_likelihood_only() {
        let [x, y] = [drawn(500, 3), drawn(500, 4)];
        let points = x.iter().zip(&y).map(|(x, y)| [x[0], y[0]]).collect();
        let sample = Sample::equal(points, Domain::whole()).unwrap();
        let chooser = Neighbours::new(&sample);
        let k = chooser.choose(NeighbourRule::Likelihood).unwrap().k;
        assert!((8..=120).contains(&k), "{k}");
        assert!(chooser.choose(NeighbourRule::LeastSquares).is_err());
    }
}
