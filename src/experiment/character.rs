//! What an estimator is like, apart from its error: whether it keeps mass, what it does at walls, whether it jumps. The classical comparison of methods, measured.
//!
//! These are single numbers without chance, from probes: as many points as the samples have, spread evenly between walls at the ends of the experiment's grid; the same
//! crowded beside a wall, the worst case for mass; and for jumps the first sample.

use crate::estimator::Estimator;
use crate::numeric::Sum;
use crate::sample::Sample;
use crate::space::{Domain, Field, Grid, Targets};

/// The numbers of one estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Character {
    /// ∫f̂ over three times the range of the grid, relative to the mass of the probe: of the even probe and of the crowded one what is farther from 1. 1 for whoever
    /// keeps mass; k-nearest-neighbour estimates have tails like 1/|x|, whose integral grows with the range.
    pub mass: f64,
    /// The estimate of the even probe next to a wall, on average over [`STRIP`] of the range, relative to the density there; of the two walls the one that is farther from 1.
    pub wall: f64,
    /// The largest jump of the estimate of the first sample, relative to its range of values; rounding where it is continuous.
    pub jump: f64,
}

/// The part of the range that is next to a wall.
pub const STRIP: f64 = 1.0 / 500.0;

/// The part of the range next to a wall in which points are crowded.
pub const CROWD: f64 = 1.0 / 200.0;

/// Measures `estimator` on probes of `draws` points and on `first`. `None` where it refuses the probe, and in the plane. O(10⁵) evaluations.
pub fn character<const D: usize>(
    estimator: &dyn Estimator<D>,
    grid: &Grid<D>,
    draws: usize,
    first: &Sample<D>,
) -> Option<Character> {
    if D != 1 {
        return None;
    }
    let (low, high) = (grid.low()[0], grid.high()[0]);
    let range = high - low;
    let count = draws.max(2);
    let probe = |length: f64| {
        let points = (0..count)
            .map(|i| [low + length * (i as f64 + 0.5) / count as f64; D])
            .collect();
        let domain = Domain::walled([low; D], [high; D]).ok()?;
        estimator.fit(&Sample::equal(points, domain).ok()?).ok()
    };
    let (even, crowded) = (probe(range)?, probe(CROWD * range)?);
    Some(Character {
        mass: farther(mass(&even, low, range)?, mass(&crowded, low, range)?),
        wall: wall(&even, low, range),
        jump: jump(&estimator.fit(first).ok()?, low, range)?,
    })
}

/// A midpoint sum over each of three parts, so that cells end with the walls.
fn mass<const D: usize>(estimate: &dyn Field<D>, low: f64, range: f64) -> Option<f64> {
    const CELLS: usize = 80_000;
    let parts = [low - range, low, low + range].map(|from| {
        let part = Grid::new([from; D], [from + range; D], [CELLS; D]).ok()?;
        Some(estimate.on(&part).integral())
    });
    parts.into_iter().sum()
}

fn wall<const D: usize>(estimate: &dyn Field<D>, low: f64, range: f64) -> f64 {
    const PLACES: usize = 64;
    let ends = [low, low + range * (1.0 - STRIP)].map(|from| {
        let places: Vec<[f64; D]> = (0..PLACES)
            .map(|i| [from + range * STRIP * (i as f64 + 0.5) / PLACES as f64; D])
            .collect();
        let values = estimate.evaluate(Targets::Points(&places)).values;
        values.into_iter().collect::<Sum>().value() / PLACES as f64 * range
    });
    farther(ends[0], ends[1])
}

/// What is farther from 1.
fn farther(a: f64, b: f64) -> f64 {
    if (a - 1.0).abs() > (b - 1.0).abs() {
        a
    } else {
        b
    }
}

/// Halves the intervals in which the estimate changes least smoothly until they are as short as numbers allow: a slope fades, a jump stays.
fn jump<const D: usize>(estimate: &dyn Field<D>, low: f64, range: f64) -> Option<f64> {
    const STEPS: usize = 4000;
    const SUSPECTS: usize = 24;
    let place = |i: usize| low + range * i as f64 / STEPS as f64;
    let places: Vec<[f64; D]> = (0..=STEPS).map(|i| [place(i); D]).collect();
    let values = estimate.evaluate(Targets::Points(&places)).values;
    let (least, most) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &v| {
            (least.min(v), most.max(v))
        });
    let step = |i: usize| values[i + 1] - values[i];
    let rough = |i: usize| (step(i) - 0.5 * (step(i - 1) + step(i + 1))).abs();
    let mut suspects: Vec<usize> = (1..STEPS - 1).collect();
    suspects.sort_by(|&i, &j| rough(j).total_cmp(&rough(i)).then(i.cmp(&j)));
    let largest = suspects
        .into_iter()
        .take(SUSPECTS)
        .map(|i| {
            let (mut a, mut b) = (place(i), place(i + 1));
            let (mut fa, mut fb) = (estimate.at([a; D]), estimate.at([b; D]));
            while b - a > 1e-13 * range {
                let m = 0.5 * (a + b);
                let fm = estimate.at([m; D]);
                if (fm - fa).abs() >= (fb - fm).abs() {
                    (b, fb) = (m, fm);
                } else {
                    (a, fa) = (m, fm);
                }
            }
            (fb - fa).abs()
        })
        .fold(0.0, f64::max);
    (most > least).then(|| largest / (most - least))
}

#[cfg(test)]
mod tests {
    use super::character;
    use crate::density::named;
    use crate::estimator::{Context, Estimator};
    use crate::experiment::catalogue::{Builds, estimator};
    use crate::parameter::{Value, Values};
    use crate::random::stream;
    use crate::sample::Sample;
    use crate::space::{Domain, Grid};

    fn built(name: &str, set: &[(&'static str, Value)]) -> Box<dyn Estimator<1>> {
        let entry = estimator(name).expect("known");
        let mut values = Values::defaults(entry.parameters);
        for (name, value) in set {
            values.set(name, value.clone());
        }
        let context = Context {
            truth: None,
            draws: 200,
        };
        Builds::<1>::build(entry, &values, &context).expect("legal")
    }

    #[test]
    fn the_numbers_are_those_known_on_paper() {
        let grid = Grid::new([-3.0], [5.0], [64]).expect("a grid");
        let truth = named("bimodal").expect("known");
        let mut random = stream(1, "character", 0);
        let points = (0..200).map(|_| truth.draw(&mut random)).collect();
        let first = Sample::equal(points, Domain::whole()).expect("a sample");
        let of = |name: &str, set: &[(&'static str, Value)]| {
            character(&*built(name, set), &grid, 400, &first).expect("measured")
        };
        let h = ("bandwidth", Value::Number(0.5));
        let word = |word: &str| Value::Word(word.to_owned());
        let plain = of("kernel", std::slice::from_ref(&h));
        assert!((plain.mass - 1.0).abs() < 1e-6, "{plain:?}");
        // a half on the wall itself, and rising by φ(0)/h times the distance: 0.4/0.5 · 0.008
        assert!((plain.wall - 0.5064).abs() < 1e-3, "{plain:?}");
        assert!(plain.jump < 1e-9, "{plain:?}");
        let reflected = of("kernel", &[h, ("boundary", word("reflect"))]);
        assert!((reflected.wall - 1.0).abs() < 1e-3, "{reflected:?}");
        assert!((reflected.mass - 1.0).abs() < 1e-6, "{reflected:?}");
        // 400 points on [-3, 5] in bins of 1 from 0: even; the highest bar of the first sample against its neighbour
        let bars = of("histogram", &[("width", Value::Number(1.0))]);
        assert!(
            (bars.mass - 1.0).abs() < 1e-3 && bars.jump > 0.2,
            "{bars:?}"
        );
        // k/(2 n d) has tails like 1/|x|
        let near = of("nearest-neighbour", &[("k", Value::Count(20))]);
        assert!(near.mass > 1.05, "{near:?}");
    }
}
