//! All finders against the definition, bit for bit.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Side};
use proptest::collection::vec;
use proptest::prelude::*;

/// Asks every finder for the same things and compares with the definition.
fn compare<const D: usize>(
    brute: &Brute<D>,
    finder: &dyn Neighbours<D>,
    targets: &[Point<D>],
    ranks: &[usize],
) -> Result<(), TestCaseError> {
    prop_assert_eq!(brute.count(), finder.count());
    let (mut here, mut there) = (Scratch::default(), Scratch::default());
    for &rank in ranks {
        let k = 1 + rank % brute.count();
        for &target in targets {
            let right = brute.distance(target, k, &mut here);
            let found = finder.distance(target, k, &mut there);
            prop_assert_eq!(
                right.to_bits(),
                found.to_bits(),
                "{}: {} not {} at {:?} for k = {}",
                finder.name(),
                found,
                right,
                target,
                k
            );
            for squared in [right, right * 0.999, 0.0] {
                let list = |finder: &dyn Neighbours<D>| {
                    let mut all = Vec::new();
                    finder.within(target, squared, &mut |i, d| all.push((i, d.to_bits())));
                    all.sort_unstable();
                    all
                };
                prop_assert_eq!(
                    list(brute),
                    list(finder),
                    "{} within {}",
                    finder.name(),
                    squared
                );
            }
        }
    }
    Ok(())
}

fn line(points: Vec<[f64; 1]>, weights: Vec<f64>, domain: Domain<1>) -> Sample<1> {
    Sample::new(points, Weights::Each(weights.into()), domain).unwrap()
}

/// A coordinate from 0 to 1 of one of several sorts: anywhere, on a lattice, in a cluster, at one place.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..1.0f64,
        2 => (0u8..=8).prop_map(|i| f64::from(i) / 8.0),
        2 => (0u8..=10).prop_map(|i| f64::from(i) / 10.0),
        2 => (0.0..1e-6f64).prop_map(|x| 0.3 + x),
        1 => Just(0.7),
    ]
}

fn weight() -> impl Strategy<Value = f64> {
    prop_oneof![3 => Just(1.0), 1 => Just(0.0), 1 => Just(2.5)]
}

/// Units and origins.
fn frame() -> impl Strategy<Value = (f64, f64)> {
    prop_oneof![
        4 => Just((1.0, 0.0)),
        1 => Just((1.0, 1e9)),
        1 => Just((1e-6, -3.0)),
        1 => Just((1e6, 17.0)),
        1 => Just((1e-200, 0.0)),
        1 => Just((1e160, 0.0)),
    ]
}

fn positive(weights: &mut [f64]) {
    if weights.iter().all(|w| *w == 0.0) {
        weights[0] = 1.0;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn on_the_line(
        data in vec((coordinate(), weight()), 1..80),
        targets in vec(prop_oneof![3 => coordinate(), 1 => -3.0..4.0f64, 1 => Just(1e300)], 1..8),
        ranks in vec(0usize..1000, 3),
        (scale, shift) in frame(),
    ) {
        let moved = |x: f64| if x >= 1e300 { x } else { x * scale + shift };
        let (points, mut weights): (Vec<_>, Vec<_>) = data.into_iter().map(|(x, w)| ([moved(x)], w)).unzip();
        positive(&mut weights);
        let mut places: Vec<_> = targets.into_iter().map(|x| [moved(x)]).collect();
        places.extend(points.iter().take(5));
        let mut ends = vec![Domain::whole()];
        if moved(1.0) > moved(0.0) {
            ends.push(Domain::new([moved(0.0)], [moved(1.0)], [[Side::Periodic; 2]]).unwrap());
        }
        for domain in ends {
            if !points.iter().all(|x| domain.contains(*x)) {
                continue;
            }
            let sample = line(points.clone(), weights.clone(), domain.clone());
            compare(&Brute::new(&sample), &Sorted::new(&sample), &places, &ranks)?;
        }
    }

    #[test]
    fn in_the_plane(
        data in vec((coordinate(), coordinate(), weight()), 1..160),
        targets in vec((prop_oneof![3 => coordinate(), 1 => -3.0..4.0f64, 1 => Just(1e300)], coordinate()), 1..8),
        ranks in vec(0usize..1000, 3),
        (scale, shift) in frame(),
        flat in prop_oneof![6 => Just(1.0), 1 => Just(0.0), 1 => Just(1e-9)],
        round in 0usize..4,
    ) {
        let moved = |[x, y]: [f64; 2]| [if x >= 1e300 { x } else { x * scale + shift }, y * flat * scale + shift];
        let (points, mut weights): (Vec<_>, Vec<_>) =
            data.into_iter().map(|(x, y, w)| (moved([x, y]), w)).unzip();
        positive(&mut weights);
        let mut places: Vec<_> = targets.into_iter().map(|(x, y)| moved([x, y])).collect();
        places.extend(points.iter().take(5));
        let (low, high) = (moved([0.0; 2]), moved([1.0; 2]));
        let open = [Side::Open; 2];
        let around = [Side::Periodic; 2];
        let sides = [[open, open], [around, open], [open, around], [around, around]][round];
        let mut box_low = [f64::NEG_INFINITY; 2];
        let mut box_high = [f64::INFINITY; 2];
        for axis in 0..2 {
            if sides[axis] == around {
                box_low[axis] = low[axis];
                box_high[axis] = high[axis];
            }
        }
        let Ok(domain) = Domain::new(box_low, box_high, sides) else { return Ok(()) };
        if !points.iter().all(|x| domain.contains(*x)) {
            return Ok(());
        }
        let sample = Sample::new(points, Weights::Each(weights.into()), domain).unwrap();
        let brute = Brute::new(&sample);
        compare(&brute, &*sample.neighbours(), &places, &ranks)?;
        if (1e-100..1e100).contains(&scale) {
            compare(&brute, &Tree::new(&sample), &places, &ranks)?;
        }
        if let Some(cells) = Cells::new(&sample) {
            compare(&brute, &cells, &places, &ranks)?;
        }
    }
}
