//! How many neighbours are gathered at first changes nothing but the cost.

use super::*;
use crate::neighbour::Scratch;
use std::sync::Mutex;

/// A rule that has all gathered that it may ask for, before it looks at any.
#[derive(Clone)]
struct All<R>(R);

impl<const D: usize, R: Rule<D>> Rule<D> for All<R> {
    fn range(&self) -> (usize, usize) {
        self.0.range()
    }

    fn choose(&self, target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        self.0.choose(target, ladder)
    }
}

/// A rule that has as few gathered as it can.
#[derive(Clone)]
struct Few<R>(R);

impl<const D: usize, R: Rule<D>> Rule<D> for Few<R> {
    fn range(&self) -> (usize, usize) {
        self.0.range()
    }

    fn first(&self, _target: Point<D>, least: usize, _most: usize) -> usize {
        least
    }

    fn choose(&self, target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        self.0.choose(target, ladder)
    }
}

/// Even points, points in a spot, rounded points of which many coincide, and some of them with weights of three colours.
fn samples() -> Vec<Sample<2>> {
    let round = |x: Point<2>| x.map(|x| (12.0 * x).round() / 12.0);
    let rounded: Vec<Point<2>> = uniform(700, 3).into_iter().map(round).collect();
    let domain = Domain::unit();
    let channels = (0..3).map(|c| {
        let weight = |i: usize| f64::from((i * (7 + c) % 11) as u32) / 3.0;
        (0..700).map(weight).collect()
    });
    let coloured = Sample::with_channels(rounded.clone(), channels.collect(), domain.clone());
    vec![
        Sample::equal(uniform(700, 1), domain.clone()).unwrap(),
        Sample::equal(spot(700, 2), domain.clone()).unwrap(),
        Sample::equal(rounded, domain).unwrap(),
        coloured.unwrap(),
    ]
}

fn bits<R: Rule<2>>(sample: &Sample<2>, convention: Convention, rule: &R) -> Vec<u64> {
    let grid = crate::space::Grid::new([0.0; 2], [1.0; 2], [13; 2]).unwrap();
    let places: Vec<Point<2>> = grid.centres().collect();
    let estimate = fit(sample, convention, rule).unwrap();
    let seen = estimate.evaluate(Targets::Points(&places));
    let sizes = seen.sizes.unwrap();
    seen.values
        .iter()
        .chain(&sizes)
        .map(|x| x.to_bits())
        .collect()
}

fn same<R: Rule<2>>(rule: &R) {
    for (number, sample) in samples().iter().enumerate() {
        for convention in Convention::ALL {
            let told = bits(sample, convention, rule);
            assert_eq!(
                told,
                bits(sample, convention, &All(rule.clone())),
                "{number}"
            );
            assert_eq!(
                told,
                bits(sample, convention, &Few(rule.clone())),
                "{number}"
            );
        }
    }
}

#[test]
fn values_do_not_depend_on_how_many_neighbours_are_gathered_at_first() {
    let mut settings = range(5, 300);
    same(&built::<2, BiasCompensated>(&settings));
    same(&built::<2, Lepski>(&settings));
    same(&built::<2, NestedTest>(&settings));
    settings.push(("direction", word("halves")));
    same(&built::<2, NestedTest>(&settings));
    let mut settings = range(5, 900);
    settings.push(("acceptance", word("random")));
    same(&built::<2, BiasCompensated>(&settings));
}

/// Counts what is gathered.
struct Counted<'a> {
    finder: Brute<2>,
    asked: &'a Mutex<Vec<usize>>,
}

impl Neighbours<2> for Counted<'_> {
    fn name(&self) -> &'static str {
        self.finder.name()
    }

    fn count(&self) -> usize {
        self.finder.count()
    }

    fn metric(&self) -> &crate::neighbour::Metric<2> {
        self.finder.metric()
    }

    fn distance(&self, target: Point<2>, k: usize, scratch: &mut Scratch) -> f64 {
        self.asked.lock().unwrap().push(k);
        self.finder.distance(target, k, scratch)
    }

    fn within(&self, target: Point<2>, squared: f64, show: &mut dyn FnMut(usize, f64)) {
        self.finder.within(target, squared, show);
    }
}

/// A search that turns down at once gathers as many as half of the range; no search gathers more than twice.
#[test]
fn a_search_gathers_what_it_looks_at() {
    let sample = Sample::equal(spot(3000, 4), Domain::unit()).unwrap();
    let rule: BiasCompensated = built::<2, _>(&range(20, 2000));
    let (mut turned, mut further) = (0, 0);
    for x in uniform::<2>(60, 5) {
        let asked = Mutex::new(Vec::new());
        let finder = Counted {
            finder: Brute::new(&sample),
            asked: &asked,
        };
        let mut nearest = Nearest::default();
        nearest.gather(&finder, x, Rule::<2>::first(&rule, x, 20, 2000) + 1);
        let channels = [sample.clone()];
        let (convention, range) = (Convention::MeanRadius, (20, 2000));
        let mut ladder = Ladder::new(&mut nearest, (&finder, x), &channels, convention, range, 0);
        let choice = rule.choose(x, &mut ladder);
        let asked = asked.lock().unwrap().clone();
        if choice.neighbours < 1010 {
            assert_eq!(asked, [1011]);
            turned += 1;
        } else {
            assert_eq!(asked, [1011, 2001]);
            further += 1;
        }
    }
    assert!(turned > 5 && further > 5, "{turned} {further}");
}
