//! The fifteen normal mixtures on which density estimators have been compared since 1992.
//!
//! The numbers are those of table 1 of the paper (checked against the tables of the R packages HRW and nor1mix).
//!
//! # References
//! Marron & Wand 1992, Exact Mean Integrated Squared Error, Annals of Statistics 20, table 1.

use super::{Builder, Entry, NormalComponent, NormalMixture};
use std::sync::Arc;

/// The density with that number in table 1, from 1 to 15.
pub fn marron_wand(number: usize) -> Option<NormalMixture> {
    let parts = components(number)?;
    let components = parts
        .into_iter()
        .map(|(weight, mean, deviation)| NormalComponent {
            weight,
            mean,
            deviation,
        })
        .collect();
    NormalMixture::new(components).ok()
}

/// (weight, mean, deviation) of each component, written as in the paper.
fn components(number: usize) -> Option<Vec<(f64, f64, f64)>> {
    const ONE: (f64, f64, f64) = (1.0, 0.0, 1.0);
    let two_humps = |share: f64| [(share, -1.0, 2.0 / 3.0), (share, 1.0, 2.0 / 3.0)];
    Some(match number {
        1 => vec![ONE],
        2 => vec![
            (0.2, 0.0, 1.0),
            (0.2, 0.5, 2.0 / 3.0),
            (0.6, 13.0 / 12.0, 5.0 / 9.0),
        ],
        3 => (0..8)
            .map(|l| {
                let shrunk = (2.0_f64 / 3.0).powi(l);
                (0.125, 3.0 * (shrunk - 1.0), shrunk)
            })
            .collect(),
        4 => vec![(2.0 / 3.0, 0.0, 1.0), (1.0 / 3.0, 0.0, 0.1)],
        5 => vec![(0.1, 0.0, 1.0), (0.9, 0.0, 0.1)],
        6 => two_humps(0.5).to_vec(),
        7 => vec![(0.5, -1.5, 0.5), (0.5, 1.5, 0.5)],
        8 => vec![(0.75, 0.0, 1.0), (0.25, 1.5, 1.0 / 3.0)],
        9 => vec![(0.45, -1.2, 0.6), (0.45, 1.2, 0.6), (0.1, 0.0, 0.25)],
        10 => std::iter::once((0.5, 0.0, 1.0))
            .chain((0..5).map(|l| (0.1, 0.5 * f64::from(l) - 1.0, 0.1)))
            .collect(),
        11 => two_humps(0.49)
            .into_iter()
            .chain((0..7).map(|l| (1.0 / 350.0, 0.5 * f64::from(l - 3), 0.01)))
            .collect(),
        12 => std::iter::once((0.5, 0.0, 1.0))
            .chain((-2..=2).map(|l| {
                let halved = 2.0_f64.powi(-l);
                (2.0 * halved / 31.0, f64::from(l) + 0.5, 0.1 * halved)
            }))
            .collect(),
        13 => two_humps(0.46)
            .into_iter()
            .chain((1..=3).map(|l| (1.0 / 300.0, -0.5 * f64::from(l), 0.01)))
            .chain((1..=3).map(|l| (7.0 / 300.0, 0.5 * f64::from(l), 0.07)))
            .collect(),
        14 => (0..6)
            .map(|l| {
                let halved = 0.5_f64.powi(l);
                (
                    32.0 * halved / 63.0,
                    (65.0 - 96.0 * halved) / 21.0,
                    32.0 * halved / 63.0,
                )
            })
            .collect(),
        15 => (0..3)
            .map(|l| (2.0 / 7.0, f64::from(12 * l - 15) / 7.0, 2.0 / 7.0))
            .chain((8..=10).map(|l| (1.0 / 21.0, f64::from(2 * l) / 7.0, 1.0 / 21.0)))
            .collect(),
        _ => return None,
    })
}

const fn entry<const NUMBER: usize>(
    names: &'static [&'static str],
    summary: &'static str,
) -> Entry {
    Entry {
        names,
        summary,
        reference: "Marron & Wand 1992, table 1",
        parameters: &[],
        build: Builder::Line(|_| {
            Ok(Arc::new(
                marron_wand(NUMBER).expect("the entries below carry numbers of the table"),
            ))
        }),
    }
}

#[rustfmt::skip]
pub(super) const ENTRIES: &[Entry] = &[
    entry::<1>(&["mw-1", "normal", "gaussian"], "the standard normal density"),
    entry::<2>(&["mw-2", "skewed-unimodal"], "one hump with a longer left flank"),
    entry::<3>(&["mw-3", "strongly-skewed"], "a steep left edge and a long right tail"),
    entry::<4>(&["mw-4", "kurtotic-unimodal"], "a thin spike on a broad hump"),
    entry::<5>(&["mw-5", "outlier"], "nine tenths in a spike, one tenth far around it"),
    entry::<6>(&["mw-6", "bimodal"], "two equal humps that overlap"),
    entry::<7>(&["mw-7", "separated-bimodal"], "two equal humps well apart"),
    entry::<8>(&["mw-8", "skewed-bimodal", "asymmetric-bimodal"], "a broad hump with a narrow one on its flank"),
    entry::<9>(&["mw-9", "trimodal"], "two humps with a small one between"),
    entry::<10>(&["mw-10", "claw"], "a hump with five sharp fingers"),
    entry::<11>(&["mw-11", "double-claw"], "two humps with seven fingers that nobody finds"),
    entry::<12>(&["mw-12", "asymmetric-claw"], "a hump with fingers ever narrower to the right"),
    entry::<13>(&["mw-13", "asymmetric-double-claw"], "two humps with fingers of two kinds"),
    entry::<14>(&["mw-14", "smooth-comb"], "six humps, each half as wide as the one before"),
    entry::<15>(&["mw-15", "discrete-comb"], "three broad humps and three narrow ones"),
];
