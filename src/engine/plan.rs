//! Choosing an engine: all are asked for a quote, the cheapest within the tolerance is taken, and the choice can be read.

use super::recent::plan_again;
use super::{Binned, Direct, Engine, Hermite, Interval, Quote, Relay, Scatter, Sorted};
use crate::kernel::KernelSum;
use crate::space::{Domain, Evaluation, Field, Point, Targets, Warning};
use std::fmt;
use std::sync::OnceLock;

/// The engines of the line. To add one is to add it here; the laws find it.
pub const LINE: &[&dyn Engine<1>] = &[
    &Direct,
    &Interval,
    &Sorted,
    &Hermite,
    &Binned::AUTOMATIC,
    &Relay,
    &Scatter,
];

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// No engine has that name.
    #[error("there is no engine {name:?}; the engines are {known}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The engine asked for cannot compute this sum on these targets.
    #[error("engine {name} cannot compute this: {reason}; {able} can")]
    Unable {
        /// The engine.
        name: &'static str,
        /// Why not.
        reason: String,
        /// Those that could.
        able: String,
    },
}

/// What became of one engine's quote.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Taken.
    Chosen(Quote),
    /// Exact enough, but expected to take longer.
    Slower(Quote),
    /// Its bound is beyond the tolerance.
    TooCoarse(Quote),
    /// It cannot compute this; why.
    Unable(String),
}

/// Which engine, and why: prints as a table.
#[derive(Clone)]
pub struct Plan<const D: usize> {
    engine: &'static dyn Engine<D>,
    quote: Quote,
    tolerance: f64,
    forced: bool,
    verdicts: Vec<(&'static str, Verdict)>,
}

/// Asks every engine of `engines` what `sum` on `targets` would cost, and takes the cheapest whose error bound is within `tolerance`
/// (if there is none, the most exact); `forced` takes the engine of that name whatever its cost and bound. O(engines), no work on the data.
///
/// # Errors
/// If the forced engine does not exist or cannot compute this.
///
/// # Panics
/// If none of `engines` can: [`Direct`] always can.
pub fn plan<const D: usize>(
    engines: &[&'static dyn Engine<D>],
    sum: &KernelSum<D>,
    targets: Targets<'_, D>,
    tolerance: f64,
    forced: Option<&str>,
) -> Result<Plan<D>, PlanError> {
    let names = |of: &mut dyn Iterator<Item = &'static str>| of.collect::<Vec<_>>().join(", ");
    let quotes: Vec<_> = engines
        .iter()
        .map(|engine| engine.quote(sum, targets, tolerance))
        .collect();
    let able = || {
        engines
            .iter()
            .zip(&quotes)
            .filter(|(_, quote)| quote.is_ok())
    };
    let chosen = if let Some(name) = forced {
        let position = engines
            .iter()
            .position(|engine| engine.name() == name)
            .ok_or_else(|| PlanError::Unknown {
                name: name.to_owned(),
                known: names(&mut engines.iter().map(|engine| engine.name())),
            })?;
        if let Err(reason) = &quotes[position] {
            return Err(PlanError::Unable {
                name: engines[position].name(),
                reason: reason.0.clone(),
                able: names(&mut able().map(|(engine, _)| engine.name())),
            });
        }
        position
    } else {
        let best = |cost: fn(&Quote) -> f64, within: f64| {
            quotes
                .iter()
                .enumerate()
                .filter_map(|(i, quote)| quote.as_ref().ok().map(|quote| (i, quote)))
                .filter(|(_, quote)| quote.error <= within)
                .min_by(|a, b| cost(a.1).total_cmp(&cost(b.1)))
                .map(|(i, _)| i)
        };
        best(|quote| quote.nanoseconds, tolerance)
            .or_else(|| best(|quote| quote.error, f64::INFINITY))
            .expect("the definition computes every sum")
    };
    let verdicts = quotes
        .iter()
        .enumerate()
        .map(|(i, quote)| {
            let verdict = match quote {
                Ok(quote) if i == chosen => Verdict::Chosen(*quote),
                Ok(quote) if quote.error > tolerance => Verdict::TooCoarse(*quote),
                Ok(quote) => Verdict::Slower(*quote),
                Err(reason) => Verdict::Unable(reason.0.clone()),
            };
            (engines[i].name(), verdict)
        })
        .collect();
    Ok(Plan {
        engine: engines[chosen],
        quote: quotes[chosen].clone().expect("chosen among the able"),
        tolerance,
        forced: forced.is_some(),
        verdicts,
    })
}

impl<const D: usize> Plan<D> {
    /// The engine to use.
    pub fn engine(&self) -> &'static dyn Engine<D> {
        self.engine
    }

    /// What it promises.
    pub fn quote(&self) -> Quote {
        self.quote
    }

    /// All engines with what became of their quotes.
    pub fn verdicts(&self) -> &[(&'static str, Verdict)] {
        &self.verdicts
    }

    /// The table, line by line.
    pub fn lines(&self) -> Vec<String> {
        let row = |name: &str, cost: &str, error: &str, why: &str| {
            format!("{name:<10} {cost:>10} {error:>11}  {why}")
                .trim_end()
                .to_owned()
        };
        let quoted = |name, quote: &Quote, why: &str| {
            row(
                name,
                &time(quote.nanoseconds),
                &format!("{:.1e}", quote.error),
                why,
            )
        };
        let mut lines = vec![row("engine", "expected", "error bound", "")];
        for (name, verdict) in &self.verdicts {
            lines.push(match verdict {
                Verdict::Chosen(quote) if self.forced && quote.error > self.tolerance => quoted(
                    name,
                    quote,
                    "chosen: asked for, though beyond the tolerance",
                ),
                Verdict::Chosen(quote) if self.forced => quoted(name, quote, "chosen: asked for"),
                Verdict::Chosen(quote) if quote.error > self.tolerance => quoted(
                    name,
                    quote,
                    "chosen: the most exact; none is within the tolerance",
                ),
                Verdict::Chosen(quote) => {
                    quoted(name, quote, "chosen: the fastest within the tolerance")
                }
                Verdict::Slower(quote) => quoted(name, quote, "not chosen"),
                Verdict::TooCoarse(quote) => quoted(name, quote, "beyond the tolerance"),
                Verdict::Unable(reason) => row(name, "-", "-", reason),
            });
        }
        lines.push(format!(
            "tolerance  {:.1e} of mass × K(0) / h",
            self.tolerance
        ));
        lines
    }
}

/// A time in the unit that suits it.
fn time(nanoseconds: f64) -> String {
    match nanoseconds {
        t if t < 1e3 => format!("{t:.0} ns"),
        t if t < 1e6 => format!("{:.3} µs", t / 1e3),
        t if t < 1e9 => format!("{:.3} ms", t / 1e6),
        t => format!("{:.3} s", t / 1e9),
    }
}

impl<const D: usize> fmt::Display for Plan<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.lines().join("\n"))
    }
}

impl<const D: usize> fmt::Debug for Plan<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Plan")
            .field("engine", &self.engine.name())
            .field("quote", &self.quote)
            .field("verdicts", &self.verdicts)
            .finish_non_exhaustive()
    }
}

/// A kernel sum that plans anew for each set of targets. What an engine prepares is kept for the next set.
pub struct Planned<const D: usize> {
    engines: &'static [&'static dyn Engine<D>],
    sum: KernelSum<D>,
    tolerance: f64,
    forced: Option<&'static str>,
    prepared: Vec<OnceLock<Box<dyn Field<D>>>>,
}

impl<const D: usize> Planned<D> {
    /// `sum`, to be computed within `tolerance` by one of `engines`, or always by the one named `forced` where it can.
    ///
    /// # Errors
    /// If no engine has the forced name.
    pub fn new(
        engines: &'static [&'static dyn Engine<D>],
        sum: KernelSum<D>,
        tolerance: f64,
        forced: Option<&str>,
    ) -> Result<Self, PlanError> {
        let forced = forced
            .map(|name| {
                let known = || engines.iter().map(|engine| engine.name());
                known()
                    .find(|known| *known == name)
                    .ok_or_else(|| PlanError::Unknown {
                        name: name.to_owned(),
                        known: known().collect::<Vec<_>>().join(", "),
                    })
            })
            .transpose()?;
        Ok(Self {
            engines,
            sum,
            tolerance,
            forced,
            prepared: engines.iter().map(|_| OnceLock::new()).collect(),
        })
    }
}

impl<const D: usize> Field<D> for Planned<D> {
    fn domain(&self) -> &Domain<D> {
        self.sum.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        self.sum.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        let plan = |forced| plan_again(self.engines, &self.sum, targets, self.tolerance, forced);
        let mut warnings = Vec::new();
        let plan = plan(self.forced).or_else(|error| {
            warnings.push(Warning {
                what: error.to_string(),
                hint:
                    "the fastest engine that can was taken; leave the choice open to silence this"
                        .to_owned(),
            });
            plan(None)
        });
        let plan = plan.expect("an open choice always ends with the definition");
        let position = self
            .engines
            .iter()
            .position(|engine| engine.name() == plan.engine.name())
            .expect("chosen among the engines");
        let engine = plan.engine;
        let prepare = || engine.prepare(self.sum.clone(), self.tolerance);
        let field = self.prepared[position].get_or_init(|| {
            // an engine that quotes and then cannot is replaced by the definition
            prepare().unwrap_or_else(|_| Box::new(self.sum.clone()))
        });
        let mut answer = field.evaluate(targets);
        answer.engine = answer.engine.or(Some("direct"));
        answer.explanation.begin_with(plan);
        answer.warnings.splice(0..0, warnings);
        answer
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp)]
mod tests {
    use super::*;
    use crate::engine::EXACT;
    use crate::kernel::{Bandwidth, Shape};
    use crate::sample::Sample;
    use crate::space::Grid;
    use std::sync::Arc;

    fn sum(n: usize, shape: Shape, bandwidth: Bandwidth<1>) -> KernelSum<1> {
        let points = (0..n).map(|i| [(i as f64 * 0.618).fract()]).collect();
        let sample = Sample::equal(points, Domain::whole()).unwrap();
        KernelSum::new(sample, shape, bandwidth).unwrap()
    }

    fn pick(n: usize, shape: Shape, targets: Targets<'_, 1>) -> &'static str {
        let sum = sum(n, shape, Bandwidth::Fixed([0.1]));
        plan(LINE, &sum, targets, EXACT, None)
            .unwrap()
            .engine()
            .name()
    }

    #[test]
    fn clear_cases_are_decided_as_everyone_would() {
        let grid = Grid::new([0.0], [1.0], [1024]).unwrap();
        let places: Vec<Point<1>> = grid.centres().collect();
        let (grid, places) = (Targets::Grid(&grid), Targets::Points(&places));
        assert_eq!(pick(2, Shape::Epanechnikov, grid), "direct");
        assert_eq!(pick(100_000, Shape::Epanechnikov, grid), "interval");
        assert_eq!(pick(100_000, Shape::Epanechnikov, places), "sorted");
        assert_eq!(pick(100_000, Shape::Gaussian, grid), "hermite");
        assert_eq!(pick(100_000, Shape::Gaussian, places), "hermite");
        let one = [[0.5]];
        assert_eq!(pick(1000, Shape::Biweight, Targets::Points(&one)), "direct");
    }

    #[test]
    fn widths_of_the_points_are_scattered_and_widths_of_the_targets_go_to_the_definition() {
        let grid = Grid::new([0.0], [1.0], [1024]).unwrap();
        let sum = sum(
            1000,
            Shape::Epanechnikov,
            Bandwidth::PerPoint(vec![0.1; 1000].into()),
        );
        let of_points = plan(LINE, &sum, Targets::Grid(&grid), EXACT, None).unwrap();
        assert_eq!(of_points.engine().name(), "scatter");
        let widths: Arc<dyn Field<1>> = Arc::new(sum.clone());
        let sample = sum.sample().clone();
        let balloon =
            KernelSum::new(sample, Shape::Epanechnikov, Bandwidth::PerTarget(widths)).unwrap();
        let plan = plan(LINE, &balloon, Targets::Grid(&grid), EXACT, None).unwrap();
        assert_eq!(plan.engine().name(), "direct");
        assert!(plan.to_string().contains("the bandwidth varies"), "{plan}");
    }

    #[test]
    fn a_forced_engine_is_taken_or_says_why_not() {
        let grid = Grid::new([0.0], [1.0], [64]).unwrap();
        let targets = Targets::Grid(&grid);
        let compact = sum(50, Shape::Epanechnikov, Bandwidth::Fixed([0.1]));
        let taken = plan(LINE, &compact, targets, EXACT, Some("sorted")).unwrap();
        assert_eq!(taken.engine().name(), "sorted");
        assert!(taken.to_string().contains("chosen: asked for"), "{taken}");
        let smooth = sum(50, Shape::Gaussian, Bandwidth::Fixed([0.1]));
        let unable = plan(LINE, &smooth, targets, EXACT, Some("interval")).unwrap_err();
        let said = unable.to_string();
        assert!(
            said.contains("not compact") && said.contains("direct"),
            "{said}"
        );
        let unknown = plan(LINE, &smooth, targets, EXACT, Some("magic")).unwrap_err();
        assert!(unknown.to_string().contains("hermite"), "{unknown}");
    }

    #[test]
    fn a_planned_sum_explains_itself_and_keeps_what_it_prepared() {
        let compact = sum(20_000, Shape::Triangular, Bandwidth::Fixed([0.05]));
        let planned = Planned::new(LINE, compact.clone(), EXACT, None).unwrap();
        let grid = Grid::new([0.0], [1.0], [100]).unwrap();
        let places: Vec<Point<1>> = grid.centres().collect();
        let on_grid = planned.evaluate(Targets::Grid(&grid));
        let at_places = planned.evaluate(Targets::Points(&places));
        assert_eq!(
            (on_grid.engine, at_places.engine),
            (Some("interval"), Some("sorted"))
        );
        assert!(
            on_grid
                .explanation
                .lines()
                .iter()
                .any(|line| line.contains("chosen"))
        );
        for (i, x) in places.iter().enumerate() {
            let exact = compact.at(*x);
            for value in [on_grid.values[i], at_places.values[i]] {
                assert!((value - exact).abs() <= 1e-12 * compact.ceiling().unwrap());
            }
        }
        // forced where it cannot: answered all the same, with a warning
        let forced = Planned::new(LINE, compact, EXACT, Some("interval")).unwrap();
        let answer = forced.evaluate(Targets::Points(&places));
        assert_eq!((answer.engine, answer.warnings.len()), (Some("sorted"), 1));
        assert_eq!(answer.values, at_places.values);
    }
}
