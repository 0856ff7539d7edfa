//! Least-squares cross-validation in the plane.

use super::rounding::Rounding;
use super::{NormalScale, Rule, spreads};
use crate::engine::PlanePairs;
use crate::kernel::{Bandwidth, Shape, Symmetry};
use crate::numeric::minimise;
use crate::sample::Sample;
use crate::selector::search::search;
use crate::selector::{Criterion, SelectError, Selection, Selector};
use crate::space::Warning;

/// Up to so many data the minimum is found with exact sums over pairs; beyond, from the lattice alone.
const EXACT_UP_TO: usize = 1000;

/// The logarithms a of the ratios of widths along which minima are looked for, the deviations of the axes first.
const TILTS: [f64; 5] = [0.0, -0.35, 0.35, -0.7, 0.7];

/// A valley whose ratio of widths leaves that of the deviations by more than the exponential of twice this is a fall towards width 0 on one axis alone, as values rounded
/// on that axis give, and no minimum.
const FARTHEST: f64 = 1.5;

/// A bandwidth of fewer distances between nodes than this is told to be coarse.
const COARSE: f64 = 3.0;

/// The widths of least ∫f̂² - 2 Σᵢ wᵢ f̂₋ᵢ(Xᵢ), an unbiased estimate of ISE - ∫f², for the kernel itself, product or radial. [Rudemo 1982; Bowman 1984; Sain, Baggerly &
/// Scott 1994]
///
/// **A width for each axis** (`lscv`): the local minima are looked for along h = t · (s₁eᵃ, s₂e⁻ᵃ), the deviations of the axes and four other ratios, from about twice the normal scale down to a tenth of the best; the lowest
/// of each is then improved over both widths, and the lowest of these is chosen: the criterion has several valleys, and the one along the deviations need not be the deepest. That is a search, not a proof: on rounded data the criterion is rough, and a minimum a few thousandths of its value lower may be missed. The choice follows the unit of each axis. **One common width** (`lscv-common`): the same along h₁ = h₂ and nothing more; it follows rotations, and is meant for
/// places in one unit.
///
/// Up to 1000 points the minimum is that of the exact sum over all pairs; beyond, that of a lattice of up to 1024² nodes whose criterion is good to 1e-5 of itself for the Gaussian, to some 1e-3 for kernels with a kink at their edge and to 1e-2 for those with a jump (see
/// [`PlanePairs::glance`]): O(n + nodes²), whatever the bandwidth.
///
/// On tied or rounded data the criterion falls without bound as h → 0; then the widest local minimum is taken, or the normal scale where there is none, each with a warning.
/// Where only one axis is rounded it need not fall: data on lines have a minimum of their own at widths that resolve the lines. Minima below half the distance of the
/// values on an axis are therefore left out, with a warning.
#[derive(Clone, Copy, Debug)]
pub struct PlaneLeastSquares {
    symmetry: Symmetry,
    common: bool,
}

impl PlaneLeastSquares {
    /// With a width for each axis.
    pub fn each_axis(symmetry: Symmetry) -> Self {
        Self {
            symmetry,
            common: false,
        }
    }

    /// With one width for both.
    pub fn common(symmetry: Symmetry) -> Self {
        Self {
            symmetry,
            common: true,
        }
    }

    fn directions(self, sample: &Sample<2>) -> Result<[f64; 2], SelectError> {
        let rule = if self.common {
            Rule::Common
        } else {
            Rule::Deviations
        };
        Ok(spreads(sample, rule)?.0)
    }
}

/// The criterion of one sample: ready for any pair of widths.
struct Risk {
    pairs: PlanePairs,
    /// -2 over the share of pairs i ≠ j.
    factor: f64,
    /// The values are those of data in this unit, so that nothing overflows.
    unit: [f64; 2],
}

impl Risk {
    fn new(sample: &Sample<2>, shape: Shape, symmetry: Symmetry, unit: [f64; 2]) -> Self {
        Self {
            pairs: PlanePairs::new(sample, shape, symmetry),
            factor: -2.0 / (1.0 - 1.0 / sample.effective_size()),
            unit,
        }
    }

    /// What the sums over pairs make of the criterion: i = j has no part in the second one.
    fn of(&self, sum: f64, h: [f64; 2]) -> f64 {
        (sum - self.factor * self.pairs.peak() * self.pairs.squares())
            / (h[0] / self.unit[0])
            / (h[1] / self.unit[1])
    }

    fn exact(&self, h: [f64; 2]) -> f64 {
        self.of(self.pairs.sum(h, self.factor), h)
    }

    fn glance(&self, h: [f64; 2]) -> f64 {
        self.of(self.pairs.glance(h, self.factor), h)
    }

    /// The minimum of the criterion near `h`, which is looked at through `value`: over both widths, or along their ratio. Both are followed in logarithms, along t and
    /// across it, until neither moves.
    fn improve(&self, value: &impl Fn([f64; 2]) -> f64, h: [f64; 2], common: bool) -> [f64; 2] {
        let at = |t: f64, a: f64| [h[0] * (t + a).exp(), h[1] * (t - a).exp()];
        let (mut t, mut a) = (0.0_f64, 0.0_f64);
        let mut half = 0.25;
        for _ in 0..if common { 1 } else { 12 } {
            let before = (t, a);
            if !common {
                a += minimise(|x| value(at(t, a + x)), -half, half, 1e-7).at;
            }
            t += minimise(|x| value(at(t + x, a)), -half, half, 1e-7).at;
            let moved = (t - before.0).abs().max((a - before.1).abs());
            if moved < 1e-6 {
                break;
            }
            half = (4.0 * moved).clamp(1e-4, 0.25);
        }
        if self.pairs.count() > EXACT_UP_TO {
            return at(t, a);
        }
        // downhill on the exact criterion, which for kernels with edges is rough on a small scale
        let mut least = self.exact(at(t, a));
        for step in [0.04, 0.02, 0.01, 0.005] {
            for _ in 0..8 {
                let across = if common { 0.0 } else { step };
                let moves = [(step, 0.0), (-step, 0.0), (0.0, across), (0.0, -across)];
                let there = moves
                    .into_iter()
                    .take(if common { 2 } else { 4 })
                    .map(|(i, j)| (self.exact(at(t + i, a + j)), t + i, a + j))
                    .min_by(|x, y| x.0.total_cmp(&y.0));
                match there {
                    Some(better) if better.0 < least => (least, t, a) = better,
                    _ => break,
                }
            }
        }
        // and Newton's steps, from differences, for the last digits
        for step in [0.005, 0.002, 0.002, 0.002] {
            let value = |i: f64, j: f64| self.exact(at(t + i * step, a + j * step));
            let middle = value(0.0, 0.0);
            let slope = |up: f64, down: f64| (0.5 * (up - down), up + down - 2.0 * middle);
            let (t1, t2) = slope(value(1.0, 0.0), value(-1.0, 0.0));
            let (a1, a2, cross) = if common {
                (0.0, 1.0, 0.0)
            } else {
                let (a1, a2) = slope(value(0.0, 1.0), value(0.0, -1.0));
                let corners =
                    value(1.0, 1.0) + value(-1.0, -1.0) - value(1.0, -1.0) - value(-1.0, 1.0);
                (a1, a2, 0.25 * corners)
            };
            let determinant = t2 * a2 - cross * cross;
            if !(t2 > 0.0 && determinant > 0.0) {
                break;
            }
            let limited = |move_: f64| move_.clamp(-2.0, 2.0) * step;
            let to = (
                t + limited((cross * a1 - a2 * t1) / determinant),
                a + limited((cross * t1 - t2 * a1) / determinant),
            );
            let value = self.exact(at(to.0, to.1));
            if value > least + 1e-12 * least.abs() {
                break;
            }
            (least, t, a) = (value, to.0, to.1);
        }
        at(t, a)
    }
}

impl Selector<2> for PlaneLeastSquares {
    fn name(&self) -> &'static str {
        if self.common { "lscv-common" } else { "lscv" }
    }

    #[allow(clippy::too_many_lines)] // what may go wrong with a search, told case by case
    fn select(&self, sample: &Sample<2>, shape: Shape) -> Result<Selection<2>, SelectError> {
        const WHAT: &str = "least-squares cross-validation";
        let direction = self.directions(sample)?;
        let n = sample.effective_size();
        let fallen = |why: &str| {
            let rule = if self.common {
                NormalScale::common(self.symmetry)
            } else {
                NormalScale::deviations(self.symmetry)
            };
            let mut selection = rule.select(sample, shape)?;
            let what = format!("{WHAT} {why}; the normal scale is used instead");
            let hint = "look at the data for ties and outliers, or give the bandwidth as a number";
            let hint = hint.to_owned();
            selection.warnings.insert(0, Warning { what, hint });
            Ok(selection)
        };
        if n <= 1.0 + 1e-9 {
            return fallen("has nothing to check the one heavy point against");
        }
        let risk = Risk::new(sample, shape, self.symmetry, direction);
        let ratio = self.symmetry.canonical_scale::<2>(shape)
            / Symmetry::Product.canonical_scale::<2>(Shape::Gaussian);
        let widest = 2.0 * n.powf(-1.0 / 6.0) * ratio;
        let along = |t: f64| direction.map(|s| t * s);
        // below this the lattice sees nothing
        let blind = 2.0 / risk.pairs.resolution(along(1.0));
        // what few data cost exactly is less than what their lattice costs, and far points make it coarse
        let count = risk.pairs.count();
        let few = count <= 300 || (count <= EXACT_UP_TO && blind > 0.05 * widest);
        let narrowest = if few {
            2e-3 * widest
        } else {
            blind.clamp(2e-3 * widest, 0.5 * widest)
        };
        let tilted = |t: f64, a: f64| {
            let [x, y] = along(t);
            [x * a.exp(), y * (-a).exp()]
        };
        let value = |h: [f64; 2]| {
            if few { risk.exact(h) } else { risk.glance(h) }
        };
        let tilts = if self.common { &TILTS[..1] } else { &TILTS[..] };
        let mut best: Option<([f64; 2], f64, Vec<Warning>)> = None;
        let mut fell = false;
        let rounding = Rounding::of(sample);
        let resolves = |h: [f64; 2]| rounding.resolved_by(h.map(|h| h / ratio));
        let mut resolved = None;
        for &a in tilts {
            let glance = |t: f64| value(tilted(t, a));
            let mut found = search(glance, glance, narrowest, widest);
            found.minima.retain(|minimum| {
                let digits = resolves(tilted(minimum.at, a));
                resolved = resolved.or(digits);
                digits.is_none()
            });
            let found = found.in_units_of(direction[0]);
            let Some((first, warnings)) = found.choose(WHAT) else {
                continue;
            };
            let h = risk.improve(&value, tilted(first / direction[0], a), self.common);
            let slant = 0.5 * (h[0] / direction[0] / (h[1] / direction[1])).ln();
            if !self.common && slant.abs() > FARTHEST {
                fell = true;
                continue;
            }
            if let Some(digits) = resolves(h) {
                resolved = Some(digits);
                continue;
            }
            let least = value(h);
            if best.as_ref().is_none_or(|(_, other, _)| least < *other) {
                best = Some((h, least, warnings));
            }
        }
        let at_digits = resolved.map(|(axis, step)| {
            let axis = ["first", "second"][axis];
            format!("widths that resolve the steps of {step:.3e} to which values on the {axis} axis are rounded")
        });
        let Some((h, _, mut warnings)) = best else {
            return fallen(&at_digits.map_or_else(
                || "has no minimum but towards bandwidth 0 or infinity".to_owned(),
                |digits| format!("is least only at {digits}"),
            ));
        };
        if let Some(digits) = at_digits {
            warnings.push(Warning {
                what: format!("{WHAT} has minima at {digits}; they are left out"),
                hint: "look at the data for rounding".to_owned(),
            });
        }
        if fell {
            warnings.push(Warning {
                what: format!(
                    "{WHAT} also falls towards width 0 on one axis, as it does without bound on values rounded there; a minimum at widths of both is taken"
                ),
                hint: "look at the data for rounding".to_owned(),
            });
        }
        let resolution = risk.pairs.resolution(h);
        if risk.pairs.count() > EXACT_UP_TO && resolution < COARSE {
            warnings.push(Warning {
                what: format!(
                    "the data reach so far that the bandwidth is only {resolution:.1} distances between the nodes of the finest lattice: the choice is coarse"
                ),
                hint: "leave out the far points, or give the bandwidth as a number".to_owned(),
            });
        }
        Ok(Selection {
            bandwidth: Bandwidth::Fixed(h),
            warnings,
        })
    }

    /// Over the width of the first axis, the other following in the ratio of the widths chosen.
    fn criterion(
        &self,
        sample: &Sample<2>,
        shape: Shape,
    ) -> Result<Option<Criterion>, SelectError> {
        let Bandwidth::Fixed(chosen) = self.select(sample, shape)?.bandwidth else {
            return Ok(None);
        };
        let unit = self.directions(sample)?;
        let risk = Risk::new(sample, shape, self.symmetry, unit);
        let exact = risk.pairs.count() <= EXACT_UP_TO;
        Ok(Some(Box::new(move |h| {
            let h = [h, h * (chosen[1] / chosen[0])];
            let value = if exact { risk.exact(h) } else { risk.glance(h) };
            value / unit[0] / unit[1]
        })))
    }
}

#[cfg(test)]
#[path = "least_squares_tests.rs"]
mod tests;
