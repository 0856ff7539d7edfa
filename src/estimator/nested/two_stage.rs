//! The number of neighbours from a pilot estimate of density and curvature.

use super::ladder::Ladder;
use super::{Choice, LAWS, MAX, MIN, Rule, convention, fit, told};
use crate::estimator::{
    Build, BuildError, Context, Described, Estimate, Estimator, FitError, Kde, Laws,
};
use crate::kernel::Bandwidth;
use crate::neighbour::Searchable;
use crate::parameter::{Absent, Kind, Parameter, Value, Values};
use crate::sample::Sample;
use crate::space::{Field, Grid, Point, Raster};
use crate::theory::{Convention, best_neighbours};
use std::sync::Arc;

/// At each place the k that has the least asymptotic mean squared error for the density and the curvature there, both from kernel estimates: k⁵ = 144 n⁴ f⁶/f''² on the line,
/// k³ = 32 π² n² f⁴/(∆f)² in the plane, kept between `min` and `max`. [Mack & Rosenblatt 1979]
///
/// Curvature is harder to estimate than density and wants a wider kernel (its best bandwidth falls as n^(-1/(d+8)), not n^(-1/(d+4))); by default 1.5 times that of the density.
/// Both are made on a grid of 512 cells, or 256 × 256, and walls are treated by reflection. Where the estimated curvature is next to zero, k is `max`.
///
/// **Limits.** The pilot has one width, and what is narrower than that is not seen by either stage.
#[derive(Clone)]
pub struct TwoStage {
    range: (usize, usize),
    convention: Convention,
    pilot: Value,
    curvature: Option<f64>,
}

/// k at each cell.
#[derive(Clone)]
struct Planned<const D: usize> {
    range: (usize, usize),
    neighbours: Arc<Raster<D>>,
}

impl<const D: usize> Planned<D> {
    fn planned(&self, target: Point<D>) -> usize {
        let grid = self.neighbours.grid();
        // beyond the grid as at its end
        let mut near = target;
        for axis in 0..D {
            near[axis] = near[axis].clamp(grid.low()[axis], grid.high()[axis]);
        }
        self.neighbours.at(near) as usize
    }
}

impl<const D: usize> Rule<D> for Planned<D> {
    fn range(&self) -> (usize, usize) {
        self.range
    }

    fn first(&self, target: Point<D>, least: usize, most: usize) -> usize {
        self.planned(target).clamp(least, most)
    }

    fn choose(&self, target: Point<D>, ladder: &mut Ladder<'_, D>) -> Choice {
        Choice {
            neighbours: self.planned(target).clamp(ladder.least(), ladder.most()),
            steps: 1,
            ended: true,
        }
    }
}

/// Cells of an axis.
const fn cells(dimensions: usize) -> usize {
    if dimensions == 1 { 512 } else { 256 }
}

/// Over the domain, or over the data where that is infinite.
fn grid<const D: usize>(sample: &Sample<D>) -> Result<Grid<D>, FitError> {
    let (mut low, mut high) = (sample.domain().low(), sample.domain().high());
    for axis in 0..D {
        let counts = |i: &usize| sample.weight(*i) > 0.0;
        let at = || {
            (0..sample.len())
                .filter(counts)
                .map(|i| sample.points()[i][axis])
        };
        if low[axis].is_infinite() {
            low[axis] = at().fold(f64::INFINITY, f64::min);
        }
        if high[axis].is_infinite() {
            high[axis] = at().fold(f64::NEG_INFINITY, f64::max);
        }
    }
    Grid::new(low, high, [cells(D); D]).map_err(|error| {
        FitError::Degenerate(format!("there is no room for a pilot estimate: {error}"))
    })
}

/// ∆f at the centres, from second differences; at the ends as next to them.
fn laplacian<const D: usize>(raster: &Raster<D>) -> Vec<f64> {
    let grid = raster.grid();
    let values = raster.values();
    let side = cells(D);
    let mut strides = [1; D];
    for axis in (0..D.saturating_sub(1)).rev() {
        strides[axis] = strides[axis + 1] * side;
    }
    (0..values.len())
        .map(|number| {
            let along = |axis: usize| {
                let stride = strides[axis];
                let index = number / stride % side;
                let inner = index.clamp(1, side - 2);
                let here = number + inner * stride - index * stride;
                let width = grid.width(axis);
                (values[here - stride] - 2.0 * values[here] + values[here + stride])
                    / (width * width)
            };
            (0..D).map(along).sum()
        })
        .collect()
}

impl TwoStage {
    fn pilot<const D: usize>(
        sample: &Sample<D>,
        bandwidths: impl IntoIterator<Item = Value>,
        grid: &Grid<D>,
    ) -> Result<(Raster<D>, Option<Bandwidth<D>>), FitError>
    where
        Kde<D>: Build<D>,
    {
        let mut values = Values::defaults(<Kde<D> as Described>::PARAMETERS);
        // one for all axes, or one for each
        for (name, bandwidth) in ["bandwidth", "bandwidth-y"].into_iter().zip(bandwidths) {
            values.set(name, bandwidth);
        }
        if sample.domain().has_walls() {
            values.set("boundary", Value::Word("reflect".to_owned()));
        }
        let context = Context {
            truth: None,
            draws: sample.len(),
        };
        let estimator = <Kde<D> as Build<D>>::build(&values, &context)
            .map_err(|error| FitError::Degenerate(format!("the pilot estimate: {error}")))?;
        let estimate = estimator.fit(sample)?;
        Ok((estimate.on(grid), estimate.bandwidth))
    }
}

impl<const D: usize> Estimator<D> for TwoStage
where
    Sample<D>: Searchable<D>,
    Kde<D>: Build<D>,
{
    fn laws(&self) -> Laws {
        LAWS
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        const WIDER: f64 = 1.5;
        let grid = grid(sample)?;
        let (density, used) = Self::pilot(sample, [self.pilot.clone()], &grid)?;
        let wider: Vec<Value> = match (self.curvature, used) {
            (Some(h), _) => vec![Value::Number(h)],
            (None, Some(Bandwidth::Fixed(h))) => h.map(|h| Value::Number(WIDER * h)).to_vec(),
            (None, _) => {
                return Err(FitError::Degenerate(
                    "the pilot's rule gives a bandwidth for each datum; give `curvature`"
                        .to_owned(),
                ));
            }
        };
        let (smooth, _) = Self::pilot(sample, wider, &grid)?;
        let (n, mass) = (sample.effective_size(), sample.mass());
        let (min, max) = self.range;
        let neighbours = density
            .values()
            .iter()
            .zip(laplacian(&smooth))
            .map(|(f, curvature)| {
                let k = best_neighbours::<D>(n, (f / mass).max(0.0), curvature / mass);
                // without curvature infinite, without density nothing
                if k.is_nan() {
                    min as f64
                } else {
                    k.clamp(min as f64, max as f64)
                }
            })
            .collect();
        let rule = Planned {
            range: self.range,
            neighbours: Arc::new(Raster::new(grid, neighbours)),
        };
        fit(sample, self.convention, &rule)
    }
}

impl Described for TwoStage {
    const NAME: &'static str = "two-stage";
    const SUMMARY: &'static str = "nearest neighbours, as many at each place as pilot estimates of density and curvature advise";
    const COST: &'static str =
        "a kernel estimate twice, and O(m max) where the data are spread evenly";
    const REFERENCE: &'static str = "Mack & Rosenblatt 1979 (the k of least error); plug-in as for kernel widths, Wand & Jones 1995, section 3.6";
    const SMOOTHING: Option<&'static str> = Some("max");
    const PARAMETERS: &'static [Parameter] = &[
        MIN,
        MAX,
        convention("unbiased"),
        Parameter::optional(
            "pilot",
            Kind::PositiveOr(&["normal-reference", "silverman", "scott"]),
            Absent::Word("normal-reference"),
            "the bandwidth of the pilot estimate of the density, or the rule that chooses it",
        )
        .length(),
        Parameter::optional(
            "curvature",
            Kind::Positive,
            Absent::Unset,
            "the bandwidth of the pilot estimate of the curvature; 1.5 times the other one by default",
        )
        .length(),
    ];
}

impl<const D: usize> Build<D> for TwoStage
where
    Sample<D>: Searchable<D>,
    Kde<D>: Build<D>,
{
    fn build(values: &Values, _context: &Context<D>) -> Result<Self, BuildError> {
        let (range, convention) = told(values)?;
        let pilot = values.get("pilot").cloned();
        Ok(Self {
            range,
            convention,
            pilot: pilot.unwrap_or_else(|| Value::Word("normal-reference".to_owned())),
            curvature: values.number("curvature"),
        })
    }
}
