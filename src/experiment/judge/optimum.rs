//! Claims about optima: of a swept curve, and by theory alone.

use super::short;
use crate::experiment::results::Group;
use crate::experiment::run::Bench;
use crate::experiment::{Experiment, Measure};
use crate::kernel::{Shape, Symmetry};

pub(super) fn best_is_near<const D: usize>(
    bench: &Bench<D>,
    group: &Group<D>,
    (of, same_sweep): (&str, bool),
    within: f64,
) -> Option<(bool, String)> {
    let experiment = bench.experiment();
    let curve = swept(experiment, group, of, Measure::Mise);
    let (simulated, _) = lowest(&curve)?;
    let exact = if same_sweep {
        lowest(&swept(experiment, group, of, Measure::ExactMise))?.0
    } else {
        let first = experiment
            .estimators
            .iter()
            .position(|spec| spec.sweep.as_ref().is_some_and(|sweep| sweep.group == of))?;
        bench.best_of_family(group.source, group.size, first)?.at
    };
    let apart = (simulated / exact - 1.0).abs();
    let detail = format!(
        "simulated optimum {}, exact {}: {} % apart",
        short(simulated),
        short(exact),
        short(100.0 * apart)
    );
    Some((apart <= within, detail))
}

/// (parameter, value) of a measure along a sweep, ascending.
pub fn swept<const D: usize>(
    experiment: &Experiment,
    group: &Group<D>,
    of: &str,
    measure: Measure,
) -> Vec<(f64, f64)> {
    let mut curve: Vec<(f64, f64)> = experiment
        .estimators
        .iter()
        .zip(&group.outcomes)
        .filter_map(|(spec, outcome)| {
            let sweep = spec.sweep.as_ref().filter(|sweep| sweep.group == of)?;
            Some((sweep.value, outcome.measures.get(&measure)?.value))
        })
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    curve
}

/// The minimum of a sampled curve: of the parabola through its lowest point and the two beside it, in the logarithm of the parameter.
fn lowest(curve: &[(f64, f64)]) -> Option<(f64, f64)> {
    let best = (0..curve.len()).min_by(|&a, &b| curve[a].1.total_cmp(&curve[b].1))?;
    if best == 0 || best + 1 == curve.len() {
        return None;
    }
    let [(a, fa), (b, fb), (c, fc)] =
        [curve[best - 1], curve[best], curve[best + 1]].map(|(h, m)| (h.ln(), m));
    let (left, right) = ((b - a) * (fb - fc), (b - c) * (fb - fa));
    let vertex = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right);
    Some((
        if vertex.is_finite() {
            vertex.exp()
        } else {
            b.exp()
        },
        fb,
    ))
}

pub(super) fn oracle<const D: usize>(
    bench: &Bench<D>,
    group: &Group<D>,
    quantity: &str,
    (kernel, symmetry): (&str, &str),
    equals: f64,
    digits: u32,
) -> Option<(bool, String)> {
    let oracle = bench.oracle(
        group.source,
        (Shape::named(kernel)?, Symmetry::named(symmetry)?),
        group.draws,
    )?;
    let best = &oracle.optimum;
    let asymptotic = oracle.asymptotic.ok();
    let found = match quantity {
        "h_mise" => best.at,
        "mise" => best.error.mise(),
        "bias2" => best.error.squared_bias,
        "variance" => best.error.variance,
        "h_amise" => asymptotic?.best(),
        "amise" => {
            let asymptotic = asymptotic?;
            asymptotic.at(asymptotic.best()).mise()
        }
        "amise_over_mise" => {
            let asymptotic = asymptotic?;
            asymptotic.at(asymptotic.best()).mise() / best.error.mise()
        }
        _ => return None,
    };
    // half a unit in the last digit that is claimed; all these quantities are positive, so a claim of 0 has no digits
    let unit = if equals == 0.0 {
        0.0
    } else {
        10.0_f64.powf(equals.abs().log10().floor() - f64::from(digits) + 1.0)
    };
    Some((
        (found - equals).abs() <= 0.5 * unit * (1.0 + 1e-9),
        format!("{quantity} is {found:.8}, expected {equals}"),
    ))
}

#[cfg(test)]
mod tests {
    use super::lowest;
    #[test]
    fn the_parabola_finds_the_place_between_samples() {
        let curve: Vec<(f64, f64)> = [0.1, 0.2, 0.3, 0.5, 0.9]
            .iter()
            .map(|&h: &f64| (h, (h.ln() - 0.25_f64.ln()).powi(2)))
            .collect();
        let (place, _) = lowest(&curve).expect("inside");
        assert!((place - 0.25).abs() < 1e-12, "{place}");
        assert!(lowest(&curve[2..]).is_none());
    }
}
