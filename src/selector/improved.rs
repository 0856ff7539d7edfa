//! The improved Sheather-Jones bandwidth: a fixed point of plug-in stages, with no normal reference anywhere.

use super::functionals::{Functionals, Sum, canonical, fall_back};
use super::{Described, SelectError, Selection, Selector};
use crate::kernel::Shape;
use crate::numeric::root;
use crate::sample::Sample;
use crate::space::Warning;
use std::f64::consts::PI;

/// h = √t with t = ξ γ⁽⁵⁾(t): a seven-stage plug-in whose first stage is the bandwidth itself. [Botev, Grotowski & Kroese 2010, section 5, algorithm 1]
///
/// The squared norms of the derivatives of the pilot estimates are the paper's sums over all pairs (its eq. 29), on the whole line and unbinned; common programs
/// use the cosine transform of a histogram on an interval around the data instead, of which this is the limit. N is the effective
/// size. All is in units of the deviation, so that h follows the scale of the data. The smallest root from a quarter of Silverman's h on is taken (programs that look for it in
/// a fixed interval of t miss it, or find another, when the data are wide); below that only if the equation has changed sign already.
#[derive(Clone, Copy, Debug, Default)]
pub struct ImprovedSheatherJones;

/// Stages of the plug-in.
const STAGES: usize = 7;

/// t - ξ γ⁽ˡ⁾(t) over t, with t = h².
fn excess(functionals: &Functionals, h: f64, sum: Sum) -> f64 {
    let n = functionals.n;
    let mut norm = functionals.norm(STAGES, h, sum);
    let mut odd = (1..STAGES).map(|s| (2 * s - 1) as f64).product::<f64>();
    for s in (2..STAGES).rev() {
        // 1 · 3 · ... · (2s - 1)
        let constant = (1.0 + 0.5_f64.powf(s as f64 + 0.5)) / 3.0;
        let time = (2.0 * constant * odd / (2.0 * PI).sqrt() / n / norm)
            .powf(2.0 / (3.0 + 2.0 * s as f64));
        norm = functionals.norm(s, time.sqrt(), sum);
        odd /= (2 * s - 1) as f64;
    }
    1.0 - (2.0 * n * PI.sqrt() * norm).powf(-0.4) / (h * h)
}

impl Selector<1> for ImprovedSheatherJones {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        const RATIO: f64 = 1.15;
        let functionals = Functionals::new(sample)?;
        let glance = |h: f64| excess(&functionals, h, Functionals::glance);
        let exact = |h: f64| excess(&functionals, h, Functionals::sum);
        let quartiles = functionals.quartile_range / 1.34;
        let robust = if quartiles > 0.0 {
            quartiles.min(1.0)
        } else {
            1.0
        };
        let reference = 0.9 * robust * functionals.n.powf(-0.2);
        let (least, most) = (1e-4 * reference, 32.0 * functionals.oversmoothed());
        let unit = functionals.unit * canonical(shape);
        let mut h = reference / 4.0;
        let mut below = glance(h);
        // the fixed point is narrower still
        while below > 0.0 && h > least {
            h /= RATIO;
            below = glance(h);
        }
        let mut found = Vec::new();
        while h < most {
            let next = h * RATIO;
            let above = glance(next);
            if below <= 0.0 && above > 0.0 {
                // a glance may be wrong by a little, so the exact root may lie a little beside
                found.extend(root(exact, h / 1.02, next * 1.02));
            }
            // others would be near; far above, all is positive
            if found.first().is_some_and(|first| next > 4.0 * first) {
                break;
            }
            (h, below) = (next, above);
        }
        let Some(&h) = found.first() else {
            return fall_back(
                sample,
                shape,
                "the fixed-point equation of Botev, Grotowski and Kroese has no root",
            );
        };
        let mut warnings = Vec::new();
        if found.len() > 1 {
            let others: Vec<String> = found[1..]
                .iter()
                .map(|h| format!("{:.4e}", h * unit))
                .collect();
            warnings.push(Warning {
                what: format!(
                    "the fixed-point equation has other roots, at {}; the smallest is taken",
                    others.join(", ")
                ),
                hint: "structure at more than one scale: compare the estimates at both".to_owned(),
            });
        }
        Ok(Selection::new(h * unit, warnings))
    }
}

impl Described for ImprovedSheatherJones {
    const NAME: &'static str = "improved-sheather-jones";
    const SUMMARY: &'static str =
        "a fixed point of seven plug-in stages, without a normal reference; for several modes";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Botev, Grotowski & Kroese 2010, section 5, algorithm 1";
}
