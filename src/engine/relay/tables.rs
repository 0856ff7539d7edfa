//! What is handed on with what weight, and the handing on.

use super::setting::{GROUP, Setting};
use crate::engine::Unsupported;
use crate::numeric::special::normal_density;
use crate::space::Grid;
use crate::space::binning::{Lattice, moments};
use pulp::{Arch, Simd, WithSimd};
use std::cell::RefCell;
use std::rc::Rc;

/// The most recent tables of each thread: an experiment goes over the same few settings again and again.
const KEPT: usize = 8;

/// Nodes treated together: few enough that their sums stay in registers, many enough that those do not wait for each other.
const NODES: usize = 16;

/// Numbers in tables that are worth keeping: 1 MiB.
const WORTH: usize = 1 << 17;

thread_local! {
    static RECENT: RefCell<Vec<Rc<Tables>>> = const { RefCell::new(Vec::new()) };
}

/// All that tables depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Question {
    /// h.
    pub bandwidth: f64,
    /// The targets.
    pub grid: Grid<1>,
    /// How many points.
    pub points: usize,
    /// Whether they have weights of their own.
    pub weighted: bool,
    /// The error that is allowed.
    pub tolerance: f64,
}

impl Question {
    /// How it is answered.
    ///
    /// # Errors
    /// If it cannot be.
    pub fn setting(&self) -> Result<Setting, Unsupported> {
        let of = (self.points, self.weighted);
        Setting::choose(self.bandwidth, &self.grid, of, self.tolerance)
    }
}

/// Does `work` with the tables for a question: those of the last time, if they are still there. What they hold depends on nothing else, so that it does
/// not matter which thread made them when.
///
/// # Errors
/// If there can be no tables.
pub(super) fn with_tables<T>(
    question: &Question,
    work: impl FnOnce(&Tables) -> T,
) -> Result<T, Unsupported> {
    let known = RECENT.with_borrow_mut(|recent| {
        let position = recent.iter().position(|t| t.question == *question)?;
        recent[..=position].rotate_right(1);
        Some(recent[0].clone())
    });
    let tables = match known {
        Some(tables) => tables,
        None => Rc::new(Tables::new(question)?),
    };
    let worth_keeping = tables.to_nodes.len() + tables.to_targets.len() * GROUP <= WORTH;
    RECENT.with_borrow_mut(|recent| {
        let kept = recent
            .first()
            .is_some_and(|first| Rc::ptr_eq(first, &tables));
        if worth_keeping && !kept {
            recent.truncate(KEPT - 1);
            recent.insert(0, tables.clone());
        }
    });
    Ok(work(&tables))
}

/// Weights for one setting and grid.
pub(super) struct Tables {
    question: Question,
    /// The setting that answers it.
    pub setting: Setting,
    /// The cells that matter.
    lattice: Lattice,
    /// How many nodes.
    nodes: usize,
    /// Cells that lie differently to the nodes: 1 unless cells are narrower than the gaps of nodes.
    phases: usize,
    /// The first node that each cell reaches.
    cells: Vec<u32>,
    /// How many nodes each cell reaches.
    of_cell: usize,
    /// For each phase and each moment the weight at each node that the cell reaches, with [`NODES`] zeros before and behind.
    to_nodes: Vec<f64>,
    /// The first node that each group of targets hears of.
    starts: Vec<u32>,
    /// How many nodes a group of targets hears of.
    of_group: usize,
    /// For each group of targets and each node the weight at each target of the group; for the first group alone where all lie alike to their nodes, as they do on
    /// many a grid whose cells are as wide as a power of two. The weights of all take longer to fetch than to use.
    to_targets: Vec<[f64; GROUP]>,
}

impl Tables {
    fn new(question: &Question) -> Result<Self, Unsupported> {
        let setting = question.setting()?;
        let grid = &question.grid;
        let Setting {
            wide,
            narrow,
            cell,
            gap,
            reach,
            ..
        } = setting;
        let targets = grid.cells()[0];
        let place = |i: usize| grid.coordinate(0, i.min(targets - 1));
        // nodes from the first that the first target hears of; whole multiples of the gap are exact
        let first_node = ((place(0) - reach * narrow) / gap).ceil();
        let of_targets = setting.nodes_of_targets(grid.width(0));
        let groups = targets.div_ceil(GROUP);
        let mut starts = Vec::with_capacity(groups);
        let mut to_targets = Vec::with_capacity(groups * of_targets);
        // in this order nothing overflows, whatever the unit
        let factor = (gap / wide) * (setting.bandwidth / narrow);
        let decay: Vec<f64> = (0..of_targets)
            .map(|k| (-0.5 * (k as f64 * gap / narrow).powi(2)).exp())
            .collect();
        let mut last_node = first_node;
        for group in 0..groups {
            let places: [f64; GROUP] = std::array::from_fn(|i| place(group * GROUP + i));
            let start = ((places[0] - reach * narrow) / gap).ceil();
            starts.push((start - first_node) as u32);
            let columns = places.map(|x| bumps((x - start * gap) / narrow, &decay, of_targets));
            for node in 0..of_targets {
                to_targets.push(std::array::from_fn(|i| factor * columns[i][node]));
            }
            last_node = start + (of_targets - 1) as f64;
        }
        let (one, others) = to_targets.split_at(of_targets);
        if others.chunks_exact(of_targets).all(|group| group == one) {
            to_targets.truncate(of_targets);
        }
        // cells from the first that the first node hears of to the last of the last
        let from = ((first_node * gap - reach * wide) / cell).round();
        let upto = ((last_node * gap + reach * wide) / cell).round();
        let lattice = Lattice {
            width: cell,
            first: from,
            count: (upto - from) as usize + 1,
        };
        let phases = (gap / cell).max(1.0) as usize;
        let of_cell = setting.nodes_of_cell();
        // the same for all cells of a phase but for whole nodes, whatever rounding does
        let reached: Vec<f64> = (0..phases)
            .map(|phase| from + phase as f64)
            .map(|number| ((number * cell - reach * wide - 0.5 * cell) / gap).ceil())
            .collect();
        let stride = (cell / gap).max(1.0);
        // a margin of nodes below, for cells that reach further down than any target hears
        let lowest = reached[0].min(first_node);
        for start in &mut starts {
            *start += (first_node - lowest) as u32;
        }
        let cells: Vec<u32> = (0..lattice.count)
            .map(|i| reached[i % phases] + (i / phases) as f64 * stride - lowest)
            .map(|node| node as u32)
            .collect();
        let highest = (last_node - lowest) as usize + 1;
        let nodes = cells
            .last()
            .map_or(highest, |&last| highest.max(last as usize + of_cell))
            .next_multiple_of(NODES);
        let row = of_cell + 2 * NODES;
        let mut to_nodes = vec![0.0; phases * setting.moments * row];
        let of_phases = to_nodes.chunks_exact_mut(setting.moments * row);
        for (phase, weights) in of_phases.enumerate() {
            let number = from + phase as f64;
            for node in 0..of_cell {
                let y = (reached[phase] + node as f64) * gap;
                let v = (y - number * cell) / wide;
                let of_moments = expansion(v, cell / wide, setting.moments);
                for (moment, weight) in of_moments.into_iter().enumerate() {
                    weights[moment * row + NODES + node] = weight;
                }
            }
        }
        Ok(Self {
            question: *question,
            setting,
            lattice,
            nodes,
            phases,
            cells,
            of_cell,
            to_nodes,
            starts,
            of_group: of_targets,
            to_targets,
        })
    }

    /// Σ w φ((x - X)/h) at the targets, times `scale`; each point counts 1 without `weights`.
    pub fn values(&self, points: &[f64], weights: Option<&[f64]>, scale: f64) -> Vec<f64> {
        match self.setting.moments {
            4 => self.hand_on(&moments::<4>(points, weights, self.lattice), scale),
            8 => self.hand_on(&moments::<8>(points, weights, self.lattice), scale),
            _ => self.hand_on(&moments::<16>(points, weights, self.lattice), scale),
        }
    }

    fn hand_on<const M: usize>(&self, cells: &[[f64; M]], scale: f64) -> Vec<f64> {
        let mut nodes = vec![0.0; self.nodes];
        let mut values = vec![0.0; self.starts.len() * GROUP];
        let mut occupied = Vec::with_capacity(cells.len());
        for (cell, (moments, &start)) in cells.iter().zip(&self.cells).enumerate() {
            if moments[0] > 0.0 {
                let cell = cell as u32;
                occupied.push(Occupied { cell, start });
            }
        }
        Arch::new().dispatch(ToNodes {
            tables: self,
            cells,
            occupied: &occupied,
            nodes: nodes.as_chunks_mut::<NODES>().0,
        });
        Arch::new().dispatch(ToTargets {
            tables: self,
            nodes: &nodes,
            values: values.as_chunks_mut::<GROUP>().0,
            scale,
        });
        values.truncate(self.question.grid.cells()[0]);
        values
    }
}

/// A cell that holds something.
#[derive(Clone, Copy)]
struct Occupied {
    /// Its number.
    cell: u32,
    /// The first node that it reaches.
    start: u32,
}

/// Heₘ(v) φ(v) ρᵐ/m!: what the m-th moment, in widths of a cell of ρ = w/ah, adds to a node v = (y - c)/ah away from the cell's centre.
fn expansion(v: f64, ratio: f64, moments: usize) -> Vec<f64> {
    let mut weights = Vec::with_capacity(moments);
    let (mut before, mut now, mut factor) = (0.0, normal_density(v), 1.0);
    for m in 0..moments {
        weights.push(now * factor);
        (before, now) = (now, v * now - m as f64 * before);
        factor *= ratio / (m + 1) as f64;
    }
    weights
}

/// φ(v - kg) for k = 0 .. `many`, from the nearest node on: φ(d - kg) = φ(d) exp(dg)ᵏ exp(-k²g²/2), the last factor being `decay[k]`.
fn bumps(v: f64, decay: &[f64], many: usize) -> Vec<f64> {
    let mut values = vec![0.0; many];
    // g from g²/2 = -ln decay[1]
    let gap = decay.get(1).map_or(1.0, |decay| (-2.0 * decay.ln()).sqrt());
    let nearest = (v / gap).round().clamp(0.0, (many - 1) as f64);
    let d = v - nearest * gap;
    let (middle, nearest) = (normal_density(d), nearest as usize);
    values[nearest] = middle;
    for (ratio, up) in [((d * gap).exp(), true), ((-d * gap).exp(), false)] {
        let mut power = middle;
        for (k, decay) in decay.iter().enumerate().skip(1) {
            let place = if up {
                Some(nearest + k)
            } else {
                nearest.checked_sub(k)
            };
            let Some(value) = place.and_then(|place| values.get_mut(place)) else {
                break;
            };
            power *= ratio;
            // the power may overflow where nothing is left
            if *decay > 0.0 {
                *value = power * decay;
            }
        }
    }
    values
}

/// From cells to nodes, some nodes at a time: what they hear stays in registers, and is not fetched from where it was put a moment ago.
struct ToNodes<'a, const M: usize> {
    tables: &'a Tables,
    cells: &'a [[f64; M]],
    /// In order.
    occupied: &'a [Occupied],
    nodes: &'a mut [[f64; NODES]],
}

impl<const M: usize> WithSimd for ToNodes<'_, M> {
    type Output = ();

    /// Fused multiplications and additions, everywhere in the same order, so that every machine gives the same bits.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let tables = self.tables;
        let (of_cell, phases) = (tables.of_cell, tables.phases);
        let row = of_cell + 2 * NODES;
        let mut left = self.occupied;
        for (group, nodes) in self.nodes.iter_mut().enumerate() {
            let first = group * NODES;
            // cells reach further up one after the other: those that end before these nodes are of no more use
            while let [next, rest @ ..] = left
                && next.start as usize + of_cell <= first
            {
                left = rest;
            }
            // moments of even and of odd order apart, so that sums do not wait for each other
            let (mut even, mut odd) = ([0.0; NODES], [0.0; NODES]);
            for occupied in left {
                let start = occupied.start as usize;
                if start >= first + NODES {
                    break;
                }
                let number = occupied.cell as usize;
                let moments = &self.cells[number];
                let phase = if phases == 1 { 0 } else { number % phases };
                let weights = &tables.to_nodes[phase * M * row..][..M * row];
                let offset = first + NODES - start;
                let (pairs, _) = moments.as_chunks::<2>();
                for (moments, weights) in pairs.iter().zip(weights.chunks_exact(2 * row)) {
                    let of_even = &weights[offset..][..NODES];
                    let of_odd = &weights[row + offset..][..NODES];
                    for i in 0..NODES {
                        even[i] = of_even[i].mul_add(moments[0], even[i]);
                        odd[i] = of_odd[i].mul_add(moments[1], odd[i]);
                    }
                }
            }
            for i in 0..NODES {
                nodes[i] = even[i] + odd[i];
            }
        }
    }
}

/// From nodes to targets.
struct ToTargets<'a> {
    tables: &'a Tables,
    nodes: &'a [f64],
    values: &'a mut [[f64; GROUP]],
    scale: f64,
}

impl WithSimd for ToTargets<'_> {
    type Output = ();

    /// As from cells to nodes.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let tables = self.tables;
        let of_group = tables.of_group;
        let alike = tables.to_targets.len() == of_group;
        let targets = self.values.iter_mut().zip(&tables.starts);
        for (group, (values, &start)) in targets.enumerate() {
            let group = if alike { 0 } else { group };
            let weights = &tables.to_targets[group * of_group..][..of_group];
            let nodes = &self.nodes[start as usize..][..of_group];
            let mut sums = [0.0; GROUP];
            for (weights, node) in weights.iter().zip(nodes) {
                for i in 0..GROUP {
                    sums[i] = weights[i].mul_add(*node, sums[i]);
                }
            }
            for i in 0..GROUP {
                // an expansion of next to nothing may end a rounding error below zero
                let value = if sums[i] < 0.0 { 0.0 } else { sums[i] };
                values[i] = value * self.scale;
            }
        }
    }
}
