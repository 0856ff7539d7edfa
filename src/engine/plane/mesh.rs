//! Product kernels on a grid, exact at the price of a histogram and two sweeps, however wide the kernel.
//!
//! On each axis the windows of the grid's lines begin and end at breakpoints, which cut the axis into intervals within which all data are alike (`interval/`). Together the two axes cut the plane into a mesh of
//! rectangles. A product kernel that is one polynomial on each side of 0 (or a cosine) separates on both axes, so that Σ w bₐ(d) b_b(e) of each rectangle is all there is to
//! know of its data. One pass over the data, put in the order of the rectangles, adds these moments; a sweep along the rows of the mesh turns moments in the second direction into values at the columns of the
//! grid, a sweep along the columns does the same for the first direction: O(n + rectangles), with nothing subtracted ([`Ladder`]).
//!
//! **Data at a breakpoint**, where rounding could decide, are set aside and scattered, cell by cell as the definition says.

use super::super::basis::{Basis, Powers, Side, Waves};
use super::super::bound::flatness;
use super::super::interval::{Lattice, Partition};
use super::super::ladder::{Item, Ladder};
use super::super::{Engine, Quote, Unsupported};
use super::by_definition;
use super::pieces::{Bands, Data, NOWHERE, RUSH, Slices, cells, pieces};
use super::splat::Splat;
use crate::kernel::{Form, Kernel, KernelSum, Shape, Symmetry};
use crate::numeric::Sum;
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Evaluation, Field, Grid, Point, Targets};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Data summed without compensation.
const RUN: usize = 256;

/// The most that the tables of moments may take, in numbers.
const MOST_MOMENTS: usize = 1 << 26;

/// Interval moments in the plane: exact sums of compact product kernels of one width on a grid. O(n + m) time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mesh;

/// The widths, if the sum is one that separates.
fn supported(sum: &KernelSum<2>) -> Result<[f64; 2], Unsupported> {
    let refuse = |why: &str| Err(Unsupported(why.to_owned()));
    if sum.shape().form() == Form::Gaussian {
        return refuse("the Gaussian is not compact: it has no intervals");
    }
    if sum.symmetry() == Symmetry::Radial {
        return refuse("the kernel is radial: only a product separates");
    }
    sum.fixed()
        .ok_or_else(|| Unsupported("the bandwidth varies: moments need one for all".to_owned()))
}

/// Moments on one axis.
fn moments(shape: Shape) -> usize {
    match shape.form() {
        Form::Polynomial(c) => c.len(),
        _ => 2,
    }
}

/// One axis of the grid, as a grid of its own.
fn axis_of(grid: &Grid<2>, axis: usize) -> Result<Grid<1>, Unsupported> {
    Grid::new(
        [grid.low()[axis]],
        [grid.high()[axis]],
        [grid.cells()[axis]],
    )
    .map_err(|error| Unsupported(error.to_string()))
}

/// Relative to the ceiling: the additions of one rectangle, and what some forty roundings of shifts and values on each axis are multiplied by where the terms of an expansion
/// exceed the kernel (by up to 3ˢ on an axis, see `bound.rs`).
fn error(sum: &KernelSum<2>, lattices: &[Lattice<'_>; 2]) -> f64 {
    let order = flatness(sum.shape());
    let n = sum.sample().len();
    let chain = (n.min(RUN) + n / RUSH + 4) as f64;
    let terms: f64 = lattices
        .iter()
        .map(|lattice| (1.0 + 2.0 * lattice.half_interval().powi(2)).powi(order))
        .product();
    let ladders = 80.0 * 9.0_f64.powi(order);
    0.5 * f64::EPSILON * (terms * chain + ladders + RUN as f64) + 2e-14
}

impl Engine<2> for Mesh {
    fn name(&self) -> &'static str {
        "mesh"
    }

    fn quote(
        &self,
        sum: &KernelSum<2>,
        targets: Targets<'_, 2>,
        _tolerance: f64,
    ) -> Result<Quote, Unsupported> {
        let h = supported(sum)?;
        let Targets::Grid(grid) = targets else {
            return Err(Unsupported(
                "the targets are scattered: intervals need a grid".to_owned(),
            ));
        };
        let grids = [axis_of(grid, 0)?, axis_of(grid, 1)?];
        let shape = sum.shape();
        let lattices = [
            Lattice::new(&grids[0], h[0], shape)?,
            Lattice::new(&grids[1], h[1], shape)?,
        ];
        // data in doubt are scattered
        Splat.quote(sum, targets, super::super::EXACT)?;
        let rectangles = lattices[0].intervals() * lattices[1].intervals();
        let moments = moments(shape);
        if rectangles * moments * moments > MOST_MOMENTS {
            return Err(Unsupported(format!(
                "{rectangles} rectangles with {} moments each are more than its tables may hold ({MOST_MOMENTS})",
                moments * moments
            )));
        }
        // measured on one thread of a busy machine: 55 ns to order a datum, 1 ns a moment of it, 35 ns a rectangle and moment of the first sweep
        let square = (moments * moments) as f64;
        Ok(Quote {
            error: error(sum, &lattices),
            nanoseconds: 50_000.0
                + (55.0 + square) * sum.sample().len() as f64
                + (5.0 * square + 35.0 * moments as f64) * rectangles as f64,
        })
    }

    fn prepare(&self, sum: KernelSum<2>, tolerance: f64) -> Result<Box<dyn Field<2>>, Unsupported> {
        supported(&sum)?;
        Ok(Box::new(Prepared { sum, tolerance }))
    }
}

struct Prepared {
    sum: KernelSum<2>,
    tolerance: f64,
}

impl Prepared {
    fn on(&self, grid: &Grid<2>) -> Result<Evaluation, Unsupported> {
        let quote = Mesh.quote(&self.sum, Targets::Grid(grid), self.tolerance)?;
        let values = match self.sum.shape().form() {
            Form::Polynomial(c) => match c.len() {
                1 => compute(&self.sum, grid, Powers::<1>::new(c)),
                2 => compute(&self.sum, grid, Powers::<2>::new(c)),
                3 => compute(&self.sum, grid, Powers::<3>::new(c)),
                5 => compute(&self.sum, grid, Powers::<5>::new(c)),
                _ => compute(&self.sum, grid, Powers::<7>::new(c)),
            },
            _ => compute(&self.sum, grid, Waves),
        }?;
        Ok(Evaluation {
            values,
            error: quote.error,
            engine: Some("mesh"),
            ..Evaluation::default()
        })
    }
}

impl Field<2> for Prepared {
    fn domain(&self) -> &Domain<2> {
        self.sum.domain()
    }

    fn at(&self, x: Point<2>) -> f64 {
        self.sum.at(x)
    }

    fn evaluate(&self, targets: Targets<'_, 2>) -> Evaluation {
        let answer = match targets {
            Targets::Grid(grid) => self.on(grid),
            Targets::Points(_) => Err(Unsupported(String::new())),
        };
        answer.unwrap_or_else(|_| by_definition(&self.sum, targets, "mesh"))
    }
}

/// Where a datum is on one axis.
enum Spot {
    /// In this interval.
    Interval(u32),
    /// Beyond all windows.
    Beyond,
    /// Where rounding could decide.
    Doubtful,
}

/// The interval of `x`: how many breakpoints of each progression it has passed, added up.
fn spot(lattice: &Lattice<'_>, x: f64) -> Spot {
    /// Adding 2⁵² rounds a small number to an integer.
    const ROUND: f64 = 4_503_599_627_370_496.0;
    let most = lattice.grid.len() as f64;
    let t = (x - lattice.first) * lattice.inverse;
    let shifts = [0.5 + lattice.reach, 0.5 - lattice.reach, 0.5];
    let (mut interval, mut worst) = (0.0, 0.0_f64);
    for shift in &shifts[..if lattice.kink { 3 } else { 2 }] {
        let passed = (t + shift).clamp(0.0, most);
        let rounded = (passed + ROUND) - ROUND;
        worst = worst.max((passed - rounded).abs());
        interval += rounded;
    }
    if worst > 0.5 - lattice.doubt && lattice.doubt > 0.0 {
        return Spot::Doubtful;
    }
    let interval = interval as u32;
    if interval == 0 || interval as usize == lattice.intervals() - 1 {
        Spot::Beyond
    } else {
        Spot::Interval(interval)
    }
}

fn compute<B: Basis<N>, const N: usize>(
    sum: &KernelSum<2>,
    grid: &Grid<2>,
    basis: B,
) -> Result<Vec<f64>, Unsupported> {
    let h = supported(sum)?;
    let shape = sum.shape();
    let grids = [axis_of(grid, 0)?, axis_of(grid, 1)?];
    let lattices = [
        Lattice::new(&grids[0], h[0], shape)?,
        Lattice::new(&grids[1], h[1], shape)?,
    ];
    let axes = [0, 1].map(|axis| Axis {
        basis,
        lattice: &lattices[axis],
        partition: Partition::new(&lattices[axis]),
    });
    let (tables, aside) = collect(sum, &axes);
    let [lines, columns] = grid.cells();
    // along the rows of the mesh: [row][a][column]
    let across: Vec<Vec<f64>> = tables
        .par_iter()
        .map(|table| {
            let Some(table) = table else {
                return Vec::new();
            };
            let mut values = Vec::with_capacity(N * columns);
            for a in 0..N {
                axes[1].sweep(|k| table[k][a], &mut values);
            }
            values
        })
        .collect();
    // along its columns: [column][line]
    let down: Vec<Vec<f64>> = (0..columns)
        .into_par_iter()
        .map(|j| {
            let mut values = Vec::with_capacity(lines);
            let moments = |k: usize| {
                let row: &[f64] = &across[k];
                std::array::from_fn(|a| row.get(a * columns + j).copied().unwrap_or(0.0))
            };
            axes[0].sweep(moments, &mut values);
            values
        })
        .collect();
    let weight = match sum.sample().weights() {
        Weights::Equal(weight) => *weight,
        Weights::Each(_) => 1.0,
    };
    let mut values = vec![0.0; lines * columns];
    values
        .par_chunks_mut(columns)
        .enumerate()
        .for_each(|(i, row)| {
            for (value, down) in row.iter_mut().zip(&down) {
                // kernels and weights are not negative, so less than nothing can only be rounding
                *value = down[i].max(0.0) * weight / h[0] / h[1];
            }
        });
    if let Some(aside) = aside {
        let field = Splat.prepare(aside, super::super::EXACT)?;
        let more = field.evaluate(Targets::Grid(grid)).values;
        for (value, more) in values.iter_mut().zip(more) {
            *value += more;
        }
    }
    Ok(values)
}

/// One axis of the mesh.
struct Axis<'a, B> {
    basis: B,
    lattice: &'a Lattice<'a>,
    partition: Partition,
}

impl<B: Copy> Axis<'_, B> {
    /// The values at the grid's lines, from the moments of the intervals.
    fn sweep<const N: usize>(&self, moments: impl Fn(usize) -> [f64; N], values: &mut Vec<f64>)
    where
        B: Basis<N>,
    {
        let Self {
            basis,
            lattice,
            partition,
        } = self;
        // the first and the last interval lie beyond all windows
        let items = (1..partition.centres.len() - 1)
            .map(|k| Item {
                low: partition.edges[k],
                high: partition.edges[k + 1],
                centre: partition.centres[k],
                moments: moments(k),
            })
            .collect();
        let window = if B::KINKED {
            lattice.h
        } else {
            2.0 * lattice.h
        };
        let ladder = Ladder::new(*basis, lattice.scale, window, items);
        for j in 0..lattice.grid.len() {
            let x = lattice.grid.coordinate(0, j);
            // less one: the ladder begins with the second interval
            let [enter, pass, leave] = partition.windows[j].map(|k| (k as usize).wrapping_sub(1));
            values.push(if B::KINKED {
                ladder.sum(enter, pass, x, Side::Right) + ladder.sum(pass, leave, x, Side::Left)
            } else {
                ladder.sum(enter, leave, x, Side::Right)
            });
        }
    }
}

/// Moments of the rectangles of a row of the mesh.
type Table<const N: usize> = Vec<[[f64; N]; N]>;

/// The moments of all rectangles, row by row (none for rows without data), and the data in doubt.
fn collect<B: Basis<N>, const N: usize>(
    sum: &KernelSum<2>,
    axes: &[Axis<'_, B>; 2],
) -> (Vec<Option<Table<N>>>, Option<KernelSum<2>>) {
    let lattices = [axes[0].lattice, axes[1].lattice];
    let rows = lattices[0].intervals();
    let bands = Bands {
        // one more for data in doubt
        bands: rows + 1,
        cells: lattices[1].intervals(),
    };
    let key = |x: Point<2>, _: f64| match (spot(lattices[0], x[0]), spot(lattices[1], x[1])) {
        (Spot::Beyond, _) | (_, Spot::Beyond) => NOWHERE,
        (Spot::Interval(row), Spot::Interval(cell)) => row * bands.cells as u32 + cell,
        _ => (rows * bands.cells) as u32,
    };
    let mut tables: Vec<Option<Table<N>>> = vec![None; rows];
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for rush in Data::of(sum.sample(), None).chunks(RUSH) {
        let pieces = pieces(rush, bands, key);
        for piece in &pieces {
            let doubtful = piece.bands(rows..rows + 1);
            points.extend(doubtful.x.iter().zip(doubtful.y).map(|(x, y)| [*x, *y]));
            weights.extend_from_slice(doubtful.weight.unwrap_or_default());
        }
        tables.par_iter_mut().enumerate().for_each(|(row, table)| {
            let ordered = cells(&pieces, bands, row);
            if ordered.columns.x.is_empty() {
                return;
            }
            let table = table.get_or_insert_with(|| vec![[[0.0; N]; N]; bands.cells]);
            Arch::new().dispatch(Add {
                axes,
                row,
                ordered: &ordered,
                table,
            });
        });
    }
    let weights = match sum.sample().weights() {
        Weights::Equal(weight) => Weights::Equal(*weight),
        Weights::Each(_) => Weights::Each(weights.into()),
    };
    // no data in doubt, or none that weigh anything, are no sample
    let aside = Sample::new(points, weights, Domain::whole())
        .ok()
        .and_then(|sample| KernelSum::new(sample, sum.shape(), sum.bandwidth().clone()).ok());
    (tables, aside)
}

/// Adds the moments of one row of rectangles.
struct Add<'a, B, const N: usize> {
    axes: &'a [Axis<'a, B>; 2],
    row: usize,
    ordered: &'a super::pieces::Cells,
    table: &'a mut Table<N>,
}

impl<B: Basis<N>, const N: usize> WithSimd for Add<'_, B, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let [first, second] = self.axes;
        let centre = first.partition.centres[self.row];
        for (cell, moments) in self.table.iter_mut().enumerate() {
            let mut data = self.ordered.range(cell..cell + 1);
            if data.x.is_empty() {
                continue;
            }
            let centres = [centre, second.partition.centres[cell]];
            let scales = [first.lattice.scale, second.lattice.scale];
            if data.x.len() <= RUN {
                let sums = sum_run(first.basis, data, centres, scales);
                for (moments, sums) in moments.iter_mut().zip(&sums) {
                    for (moment, sum) in moments.iter_mut().zip(sums) {
                        *moment += sum;
                    }
                }
                continue;
            }
            let mut totals = [[Sum::default(); N]; N];
            while !data.x.is_empty() {
                let (now, later) = data.split_at(RUN);
                let sums = sum_run(first.basis, now, centres, scales);
                for (totals, sums) in totals.iter_mut().zip(&sums) {
                    for (total, sum) in totals.iter_mut().zip(sums) {
                        total.add(*sum);
                    }
                }
                data = later;
            }
            for (moments, totals) in moments.iter_mut().zip(&totals) {
                for (moment, total) in moments.iter_mut().zip(totals) {
                    *moment += total.value();
                }
            }
        }
    }
}

/// Σ w bₐ(d) b_b(e) of a run of data.
#[allow(clippy::inline_always)] // compiled for wide registers by its caller
#[inline(always)]
fn sum_run<B: Basis<N>, const N: usize>(
    basis: B,
    data: Slices<'_>,
    centres: [f64; 2],
    scales: [f64; 2],
) -> [[f64; N]; N] {
    let mut sums = [[0.0; N]; N];
    for i in 0..data.x.len() {
        let mut down = basis.at((data.x[i] - centres[0]) * scales[0]);
        let across = basis.at((data.y[i] - centres[1]) * scales[1]);
        if let Some(weights) = data.weight {
            for value in &mut down {
                *value *= weights[i];
            }
        }
        for a in 0..N {
            for b in 0..N {
                sums[a][b] += down[a] * across[b];
            }
        }
    }
    sums
}
