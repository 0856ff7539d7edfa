//! Data in ascending blocks, without sorting them.
//!
//! Two counting passes: into groups on evenly spaced bins, then each group, within a cache, into bins of its own, as many as its data deserve.
//! So a density that is uneven over the range of the data costs nothing; only bins that are crowded all the same (ties, spikes far narrower
//! than a group), and the few that the end of a run cuts, are sorted.
//!
//! Each lane of the data is grouped by itself; each group takes its runs from all lanes, orders them, and puts them back where they were, so that
//! the data are copied once. No order depends on the number of threads, and within a bin the data keep the order in which they came.

use super::super::ladder::Item;
use super::super::pieces::pieces;
use rayon::prelude::*;
use std::ops::Range;

/// Data per block: as many as can be evaluated in the time that finding them takes.
const BLOCK: usize = 32;

/// Bins with more data than this are sorted and cut.
pub(super) const CROWDED: usize = 3 * BLOCK;

/// The most groups: so few that the end of each stays in a cache while all are filled.
const MOST_GROUPS: usize = 1 << 11;

/// Data per group, where there are fewer than fill the most groups.
const GROUP: usize = 1 << 9;

/// The least data of a lane; there are at most sixteen.
const LANE: usize = 1 << 16;

/// Points in blocks, with the way to a block.
pub(super) struct Blocks {
    points: Vec<f64>,
    /// The weight of each point; empty if all are equal.
    weights: Vec<f64>,
    /// Of each block, in ascending order: where it begins in `points`, and where it ends.
    places: Vec<[u32; 2]>,
    groups: Bins,
    /// Of each group: its bins, and the place of the first of them in `directory`.
    bins: Vec<(Bins, u32)>,
    /// The first block of each bin, and one more.
    directory: Vec<u32>,
}

/// Evenly spaced bins between two places.
#[derive(Clone, Copy, Debug)]
struct Bins {
    low: f64,
    inverse: f64,
    /// The number of the last bin.
    last: f64,
}

impl Bins {
    fn new((low, high): (f64, f64), count: usize) -> Self {
        // halves, so that the range of the data may be wider than a number can say
        let inverse = 0.5 * count as f64 / (0.5 * high - 0.5 * low);
        Self {
            low,
            inverse: if inverse.is_finite() { inverse } else { 0.0 },
            last: (count - 1) as f64,
        }
    }

    fn len(&self) -> usize {
        self.last as usize + 1
    }

    /// The bin of `x`: ascending in x, the first or the last beyond the data.
    #[inline(always)]
    fn of(&self, x: f64) -> u32 {
        /// Adding 2⁵² rounds a small number to an integer and leaves it in the lowest bits.
        const ROUND: f64 = 4_503_599_627_370_496.0;
        let t = (x - self.low) * self.inverse - 0.5;
        // comparisons written so that each is one instruction and takes NaN to 0
        let t = if t > 0.0 { t } else { 0.0 };
        let t = if t < self.last { t } else { self.last };
        (t + ROUND).to_bits() as u32
    }
}

/// The range of no points.
const NOWHERE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

fn wider(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The least and the greatest.
pub(super) fn range(points: &[f64]) -> (f64, f64) {
    // four at a time, and comparisons written so that each is one instruction
    let mut ranges = [NOWHERE; 4];
    let (fours, rest) = points.as_chunks::<4>();
    for four in fours {
        for (range, &x) in ranges.iter_mut().zip(four) {
            range.0 = if x < range.0 { x } else { range.0 };
            range.1 = if x > range.1 { x } else { range.1 };
        }
    }
    let rest = rest.iter().map(|&x| (x, x));
    ranges.into_iter().chain(rest).fold(NOWHERE, wider)
}

/// A piece of the data with its weights, none if all are equal.
type Run<'a> = (&'a [f64], &'a [f64]);

/// The same, to be overwritten.
type Place<'a> = (&'a mut [f64], &'a mut [f64]);

/// What becomes of one group.
struct Group<const N: usize> {
    bins: Bins,
    /// The first block of each bin, counted from the first of the group.
    directory: Vec<u32>,
    /// Of each block: its lane, and where it begins and ends in the run of the group there.
    places: Vec<(u32, [u32; 2])>,
    items: Vec<Item<N>>,
}

impl Blocks {
    /// `data` (fewer than 2³²) with the weights `each`, and what `item` makes of the points and weights of each block.
    pub(super) fn new<const N: usize>(
        data: &[f64],
        each: Option<&[f64]>,
        item: &(impl Fn(&[f64], &[f64]) -> Item<N> + Sync),
    ) -> (Self, Vec<Item<N>>) {
        let n = data.len();
        let length = n.div_ceil(16).max(LANE);
        let range = data.par_chunks(length).map(range).reduce(|| NOWHERE, wider);
        let groups = Bins::new(range, (n / GROUP).clamp(1, MOST_GROUPS));
        let mut points = vec![0.0; n];
        let mut weights = vec![0.0; each.map_or(0, <[f64]>::len)];
        // where each group begins in each lane, and one more
        let lanes: Vec<Vec<u32>> = points
            .par_chunks_mut(length)
            .zip(pieces(&mut weights, data.chunks(length).map(<[f64]>::len)))
            .enumerate()
            .map(|(number, place)| {
                let range = number * length..number * length + place.0.len();
                let weights = each.map_or(&[][..], |each| &each[range.clone()]);
                group((&data[range], weights), &groups, place)
            })
            .collect();
        let runs = || {
            lanes
                .iter()
                .flat_map(|lane| lane.windows(2).map(|run| (run[1] - run[0]) as usize))
        };
        let mut runs_of_group: Vec<Vec<Place<'_>>> = (0..groups.len())
            .map(|_| Vec::with_capacity(lanes.len()))
            .collect();
        let places = pieces(&mut points, runs()).zip(pieces(&mut weights, runs()));
        for (number, place) in places.collect::<Vec<Place<'_>>>().into_iter().enumerate() {
            runs_of_group[number % groups.len()].push(place);
        }
        let filled: Vec<Group<N>> = runs_of_group
            .into_par_iter()
            .map(|runs| Group::new(runs, item))
            .collect();
        let count = filled.iter().map(|group| group.items.len()).sum();
        let mut blocks = Self {
            points,
            weights,
            places: Vec::with_capacity(count),
            groups,
            bins: Vec::with_capacity(filled.len()),
            directory: Vec::new(),
        };
        let mut items = Vec::with_capacity(count);
        for (g, group) in filled.into_iter().enumerate() {
            let first = items.len() as u32;
            blocks
                .bins
                .push((group.bins, blocks.directory.len() as u32));
            blocks
                .directory
                .extend(group.directory.iter().map(|block| first + block));
            blocks
                .places
                .extend(group.places.iter().map(|(lane, place)| {
                    let start = *lane * length as u32 + lanes[*lane as usize][g];
                    place.map(|place| start + place)
                }));
            items.extend(group.items);
        }
        blocks.directory.push(items.len() as u32);
        (blocks, items)
    }

    /// The blocks of the bin of `x`.
    #[inline]
    pub(super) fn near(&self, x: f64) -> Range<usize> {
        let (bins, first) = &self.bins[self.groups.of(x) as usize];
        let bin = *first as usize + bins.of(x) as usize;
        self.directory[bin] as usize..self.directory[bin + 1] as usize
    }

    /// The points of a block and their weights, none if all are equal.
    #[inline]
    pub(super) fn block(&self, number: usize) -> Run<'_> {
        let [start, end] = self.places[number].map(|place| place as usize);
        (
            &self.points[start..end],
            self.weights.get(start..end).unwrap_or_default(),
        )
    }
}

impl<const N: usize> Group<N> {
    fn new(runs: Vec<Place<'_>>, item: &impl Fn(&[f64], &[f64]) -> Item<N>) -> Self {
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for run in &runs {
            points.extend_from_slice(run.0);
            weights.extend_from_slice(run.1);
        }
        let bins = Bins::new(range(&points), (points.len() / BLOCK).max(1));
        let mut ordered = (vec![0.0; points.len()], vec![0.0; weights.len()]);
        let starts = group((&points, &weights), &bins, (&mut ordered.0, &mut ordered.1));
        let (mut points, mut weights) = ordered;
        let mut made = Self {
            bins,
            directory: Vec::with_capacity(bins.len()),
            places: Vec::with_capacity(bins.len() + runs.len()),
            items: Vec::with_capacity(bins.len() + runs.len()),
        };
        let (mut lane, mut lane_start) = (0, 0);
        for bin in starts.windows(2) {
            made.directory.push(made.items.len() as u32);
            let range = bin[0] as usize..bin[1] as usize;
            let mut start = range.start;
            while start < range.end {
                // a block lies in one run
                while start >= lane_start + runs[lane].0.len() {
                    lane_start += runs[lane].0.len();
                    lane += 1;
                }
                // blocks ascend: a bin that is cut, by its size or by the end of a run, is in order
                let cut = range.len() > CROWDED || range.end > lane_start + runs[lane].0.len();
                if cut && start == range.start {
                    sort(
                        &mut points[range.clone()],
                        weights.get_mut(range.clone()).unwrap_or_default(),
                    );
                }
                let step = if range.len() > CROWDED {
                    BLOCK
                } else {
                    CROWDED
                };
                let end = (start + step)
                    .min(range.end)
                    .min(lane_start + runs[lane].0.len());
                let place = [start - lane_start, end - lane_start].map(|place| place as u32);
                made.places.push((lane as u32, place));
                made.items.push(item(
                    &points[start..end],
                    weights.get(start..end).unwrap_or_default(),
                ));
                start = end;
            }
        }
        let (mut points, mut weights) = (&points[..], &weights[..]);
        for run in runs {
            run.0
                .copy_from_slice(points.split_off(..run.0.len()).unwrap_or_default());
            run.1
                .copy_from_slice(weights.split_off(..run.1.len()).unwrap_or_default());
        }
        made
    }
}

/// Brings the data of `run` together by bins at `place`, in their order within a bin. Where each bin begins, and one more.
fn group(run: Run<'_>, bins: &Bins, (points, weights): Place<'_>) -> Vec<u32> {
    let mut starts = vec![0_u32; bins.len() + 1];
    let numbers: Vec<u32> = run.0.iter().map(|&x| bins.of(x)).collect();
    for &bin in &numbers {
        starts[bin as usize] += 1;
    }
    let mut start = 0;
    for count in &mut starts {
        (*count, start) = (start, start + *count);
    }
    if run.1.is_empty() {
        for (&bin, &x) in numbers.iter().zip(run.0) {
            let next = &mut starts[bin as usize];
            points[*next as usize] = x;
            *next += 1;
        }
    } else {
        for (&bin, (&x, &w)) in numbers.iter().zip(run.0.iter().zip(run.1)) {
            let next = &mut starts[bin as usize];
            (points[*next as usize], weights[*next as usize]) = (x, w);
            *next += 1;
        }
    }
    // each has moved on to where the next bin began
    starts.rotate_right(1);
    starts[0] = 0;
    starts
}

/// Sorts points, and weights with them if there are any.
fn sort(points: &mut [f64], weights: &mut [f64]) {
    if weights.is_empty() {
        points.par_sort_unstable_by(f64::total_cmp);
        return;
    }
    let mut pairs: Vec<(f64, f64)> = points
        .iter()
        .copied()
        .zip(weights.iter().copied())
        .collect();
    // stable: equal points keep the order of the data, for any number of threads
    pairs.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    for (i, (x, w)) in pairs.into_iter().enumerate() {
        points[i] = x;
        weights[i] = w;
    }
}
