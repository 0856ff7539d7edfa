//! Sheather and Jones: the bandwidth of least AMISE with an estimate of R(f″) put in its place.

use super::functionals::{Functionals, canonical, fall_back};
use super::{Described, SelectError, Selection, Selector};
use crate::kernel::Shape;
use crate::numeric::root;
use crate::sample::Sample;
use crate::space::Warning;

/// h that solves h = (R(K) / (n Ŝ(α₂ h^(5/7))))^(1/5). [Sheather & Jones 1991, section 3]; R's `bw.SJ(method = "ste")` without its bins.
///
/// Ŝ is the V-statistic over n(n - 1) pairs whose diagonal is kept, as in R; pilots from min(s, IQR/1.349), or from s alone where the quartiles coincide.
#[derive(Clone, Copy, Debug, Default)]
pub struct SheatherJones;

/// The same with the normal reference two stages up instead of an equation. [Sheather & Jones 1991, section 2; Wand & Jones 1995, section 3.6.1];
/// R's `bw.SJ(method = "dpi")` without its bins.
#[derive(Clone, Copy, Debug, Default)]
pub struct DirectPlugIn;

/// What both begin with, in units of the deviation.
struct Pilot {
    functionals: Functionals,
    scale: f64,
    /// -Ŝ₆, which estimates R(f‴).
    third: f64,
    warnings: Vec<Warning>,
}

impl Pilot {
    /// `finest` of scale and n is the narrowest pilot to come.
    fn new(sample: &Sample<1>, finest: fn(f64, f64) -> f64) -> Result<Self, SelectError> {
        let functionals = Functionals::new(sample)?;
        let quartiles = functionals.quartile_range / 1.349;
        let mut warnings = Vec::new();
        let scale = if quartiles > 0.0 {
            quartiles.min(1.0)
        } else {
            warnings.push(Warning {
                what: "more than half of the data are tied, so the quartiles coincide; the pilots come from the standard deviation alone".to_owned(),
                hint: "look at the data for rounding, or give the bandwidth as a number".to_owned(),
            });
            1.0
        };
        functionals.prepare(finest(scale, functionals.n));
        let mut pilot = Self {
            functionals,
            scale,
            third: 0.0,
            warnings,
        };
        let b = 1.23 * scale * pilot.functionals.n.powf(-1.0 / 9.0);
        pilot.third = -pilot.estimate(6, b);
        Ok(pilot)
    }

    /// Ŝᵣ(g) = Σᵢⱼ φ⁽ʳ⁾((Xᵢ - Xⱼ)/g) / (n (n - 1) g^(r+1)).
    fn estimate(&self, order: usize, g: f64) -> f64 {
        let n = self.functionals.n;
        self.functionals.sum(order, g) / (1.0 - 1.0 / n) / g.powi(order as i32 + 1)
    }

    /// The bandwidth of least AMISE if R(f″) is estimated at g.
    fn best(&self, g: f64) -> f64 {
        (self.functionals.roughness() / self.estimate(4, g)).powf(0.2)
    }
}

impl Selector<1> for SheatherJones {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        // α₂ of the normal density is 1.19
        let mut pilot = Pilot::new(sample, |scale, n| {
            1.1 * scale * (0.1144 * n.powf(-0.2)).powf(5.0 / 7.0)
        })?;
        let n = pilot.functionals.n;
        let a = 1.24 * pilot.scale * n.powf(-1.0 / 7.0);
        let alpha = 1.357 * (pilot.estimate(4, a) / pilot.third).powf(1.0 / 7.0);
        let excess = |h: f64| pilot.best(alpha * h.powf(5.0 / 7.0)) - h;
        let widest = 1.144 * pilot.scale * n.powf(-0.2);
        let roots = roots(excess, 0.1 * widest, widest);
        let Some(&h) = roots.first() else {
            return fall_back(
                sample,
                shape,
                "the equation of Sheather and Jones has no solution",
            );
        };
        if roots.len() > 1 {
            let others: Vec<String> = roots[1..]
                .iter()
                .map(|h| format!("{:.4e}", h * pilot.functionals.unit * canonical(shape)))
                .collect();
            pilot.warnings.push(Warning {
                what: format!(
                    "the equation of Sheather and Jones has other solutions, at {}; the largest is taken",
                    others.join(", ")
                ),
                hint: "compare with sheather-jones-dpi".to_owned(),
            });
        }
        let h = h * pilot.functionals.unit * canonical(shape);
        Ok(Selection::new(h, pilot.warnings))
    }
}

/// Where `excess` changes sign between `low` and `high`, the largest first; where it does not, in an interval widened by a fifth at either end in turn,
/// as R does, up to 99 times.
fn roots(excess: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> Vec<f64> {
    const RUNGS: i32 = 12;
    for round in 0..99 {
        let ratio = (low / high).powf(1.0 / f64::from(RUNGS));
        let ladder: Vec<(f64, f64)> = (0..=RUNGS)
            .map(|i| high * ratio.powi(i))
            .map(|h| (h, excess(h)))
            .collect();
        let found: Vec<f64> = ladder
            .windows(2)
            .filter(|ends| (ends[0].1 > 0.0) != (ends[1].1 > 0.0))
            .filter_map(|ends| root(&excess, ends[1].0, ends[0].0))
            .collect();
        if !found.is_empty() {
            return found;
        }
        if round % 2 == 0 {
            high *= 1.2;
        } else {
            low /= 1.2;
        }
    }
    Vec::new()
}

impl Selector<1> for DirectPlugIn {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn select(&self, sample: &Sample<1>, shape: Shape) -> Result<Selection<1>, SelectError> {
        let pilot = Pilot::new(sample, |scale, n| scale * n.powf(-1.0 / 7.0))?;
        let g = (2.394 / (pilot.functionals.n * pilot.third)).powf(1.0 / 7.0);
        let h = pilot.best(g) * pilot.functionals.unit * canonical(shape);
        Ok(Selection::new(h, pilot.warnings))
    }
}

impl Described for SheatherJones {
    const NAME: &'static str = "sheather-jones";
    const SUMMARY: &'static str =
        "the least AMISE with R(f'') estimated at a pilot tied to h itself (solve-the-equation)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str = "Sheather & Jones 1991, section 3; R's bw.SJ, unbinned";
}

impl Described for DirectPlugIn {
    const NAME: &'static str = "sheather-jones-dpi";
    const SUMMARY: &'static str =
        "the least AMISE with R(f'') estimated at a pilot of two stages (direct plug-in)";
    const COST: &'static str = "O(n)";
    const REFERENCE: &'static str =
        "Sheather & Jones 1991, section 2; Wand & Jones 1995, section 3.6.1; R's bw.SJ, unbinned";
}
