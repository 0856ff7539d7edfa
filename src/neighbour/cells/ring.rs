//! The points in a ring about a target, and how many are inside of it.

use super::super::{Counter, Found, select};
use super::Cells;
use super::axis::Range;
use crate::space::Point;
use std::f64::consts::PI;

/// What is known of the k-th squared distance before any point was looked at.
struct Bounds {
    least: f64,
    most: f64,
    /// Where it should be, if the points of the square were spread evenly in it, and the relative spread of that.
    expected: f64,
    spread: f64,
}

/// More than what rounding may do to a squared distance.
const SAFE: f64 = 1e-12;

/// How many deviations about the expected distance are looked at; one query in some twenty goes on from there.
const DEVIATIONS: f64 = 2.0;

impl Cells {
    /// The `k`-th squared distance from `home`.
    pub(super) fn kth<const WRAPS: bool, C: Counter>(
        &self,
        home: Point<2>,
        k: usize,
        bits: &mut Vec<u64>,
        counter: &mut C,
    ) -> f64 {
        let bounds = self.bounds(home, k, counter);
        let (low, high) = (
            bounds
                .least
                .max(bounds.expected * (1.0 - DEVIATIONS * bounds.spread)),
            bounds
                .most
                .min(bounds.expected * (1.0 + DEVIATIONS * bounds.spread)),
        );
        let (below, found) = self.ring::<WRAPS, C>(home, (low, high), bits, counter);
        if below >= k {
            let (below, found) = self.ring::<WRAPS, C>(home, (bounds.least, low), bits, counter);
            return select(&mut bits[..found], k - below);
        }
        if below + found < k {
            let (below, found) = self.ring::<WRAPS, C>(home, (high, bounds.most), bits, counter);
            return select(&mut bits[..found], k - below);
        }
        select(&mut bits[..found], k - below)
    }

    /// From the least square of cells about the target that holds `k` points.
    fn bounds<C: Counter>(&self, home: Point<2>, k: usize, counter: &mut C) -> Bounds {
        let [x, y] = self.axes;
        let (u, v) = (x.place(home[0]), y.place(home[1]));
        let (i, j) = (x.nearest(u), y.nearest(v));
        let square = |steps: isize| (x.around(i, steps), y.around(j, steps));
        let mut count = |(columns, rows): (Range, Range)| -> usize {
            counter.nodes(1);
            let mut count = 0;
            for c in x.pieces(columns) {
                for r in y.pieces(rows) {
                    count += self.inside(c, r);
                }
            }
            count
        };
        // `short` steps hold too few; gallop from where an even spread would put it
        let cells = (x.cells * y.cells) as f64 * k as f64 / self.points.len() as f64;
        let mut enough = ((0.5 * (cells.sqrt() - 1.0)).floor() as isize).max(0);
        let mut short = -1;
        let mut stride = 1;
        let mut held = count(square(enough));
        while held < k {
            short = enough;
            enough += stride;
            stride *= 2;
            held = count(square(enough));
        }
        stride = 1;
        while enough - short > 1 {
            // coming down: nearby first, then by halves
            let middle = (enough - stride).max(short + (enough - short) / 2);
            let here = count(square(middle));
            if here < k {
                short = middle;
            } else {
                (enough, held) = (middle, here);
            }
            stride *= 2;
        }
        let (columns, rows) = square(enough);
        let (_, across) = x.offsets(home[0], u, columns);
        let (_, along) = y.offsets(home[1], v, rows);
        let least = if short < 0 {
            0.0
        } else {
            let (columns, rows) = square(short);
            x.margin(u, columns).min(y.margin(v, rows)).powi(2) * (1.0 - SAFE)
        };
        let area = (columns.1 - columns.0) as f64 * x.width * (rows.1 - rows.0) as f64 * y.width;
        let most = (across * across + along * along) * (1.0 + SAFE);
        let expected = area * k as f64 / (held as f64 * PI);
        Bounds {
            least: least.min(most),
            most,
            expected: expected.clamp(least.min(most), most),
            spread: (1.0 / k as f64 + 1.0 / held as f64).sqrt(),
        }
    }

    /// How many points have a squared distance below `low`, and how many from `low` to `high`; those distances are put into `bits`.
    fn ring<const WRAPS: bool, C: Counter>(
        &self,
        home: Point<2>,
        (low, high): (f64, f64),
        bits: &mut Vec<u64>,
        counter: &mut C,
    ) -> (usize, usize) {
        let (mut below, mut found) = (0, 0);
        self.stripes(home, low, high, |outer, sure| {
            below += sure;
            counter.nodes(1);
            counter.distances(outer.1 - outer.0);
            let points = &self.points[outer.0..outer.1];
            if bits.len() < found + points.len() {
                bits.resize(2 * (found + points.len()), 0);
            }
            // every distance is written down, and written over unless it is wanted: no branch to mispredict
            for &x in points {
                let d = if WRAPS {
                    self.metric.squared(home, x)
                } else {
                    // the same bits, without asking about periods
                    let (dx, dy) = (home[0] - x[0], home[1] - x[1]);
                    dx * dx + dy * dy
                };
                bits[found] = d.to_bits();
                below += usize::from(d < low);
                found += usize::from(d >= low && d <= high);
            }
        });
        (below, found)
    }

    /// All points of a disc that holds `k`, with little beyond.
    pub(super) fn disc(&self, home: Point<2>, k: usize, found: &mut Vec<Found>) {
        let bounds = self.bounds(home, k, &mut ());
        let likely = bounds.expected * (1.0 + DEVIATIONS * bounds.spread);
        let before = found.len();
        self.collect(home, bounds.most.min(likely), found);
        if found.len() - before < k {
            found.truncate(before);
            self.collect(home, bounds.most, found);
        }
    }

    fn collect(&self, home: Point<2>, high: f64, found: &mut Vec<Found>) {
        let wraps = self.metric.wraps();
        let mut end = found.len();
        self.stripes(home, 0.0, high, |outer, _| {
            let points = &self.points[outer.0..outer.1];
            if found.len() < end + points.len() {
                found.resize(end + points.len(), (0.0, 0));
            }
            // as in `ring`: written down, and written over unless wanted
            let room = &mut found[end..];
            let mut next = 0;
            for (&x, &number) in points.iter().zip(&self.numbers[outer.0..outer.1]) {
                let d = if wraps {
                    self.metric.squared(home, x)
                } else {
                    let (dx, dy) = (home[0] - x[0], home[1] - x[1]);
                    dx * dx + dy * dy
                };
                room[next] = (d, number);
                next += usize::from(d <= high);
            }
            end += next;
        });
        found.truncate(end);
    }

    /// Shows, as ranges of `points`, all that may be within a squared distance of `high`; points that are surely nearer than
    /// `low` are only counted, in the second number.
    pub(super) fn stripes(
        &self,
        home: Point<2>,
        low: f64,
        high: f64,
        mut show: impl FnMut((usize, usize), usize),
    ) {
        let [x, y] = self.axes;
        let (u, v) = (x.place(home[0]), y.place(home[1]));
        let (low, high) = (low * (1.0 - SAFE), high * (1.0 + SAFE));
        if !(high.is_finite() && u.is_finite() && v.is_finite()) {
            show((0, self.points.len()), 0);
            return;
        }
        let columns = x.met(u, high.sqrt());
        for column in columns.0..columns.1 {
            let (near, far) = x.offsets(home[0], u, (column, column + 1));
            let room = high - near * near;
            if room < 0.0 {
                continue;
            }
            let outer = y.met(v, room.sqrt());
            let sure = low - far * far;
            let inner = if sure > 0.0 {
                y.contained(v, sure.sqrt(), outer)
            } else {
                (outer.0, outer.0)
            };
            let base = x.home(column) * self.rows();
            let points = |(from, to): (usize, usize)| {
                (
                    self.starts[base + from] as usize,
                    self.starts[base + to] as usize,
                )
            };
            let mut counted = 0;
            if inner.0 < inner.1 {
                for piece in y.pieces(inner) {
                    let (from, to) = points(piece);
                    counted += to - from;
                }
            }
            let mut first = true;
            for part in [(outer.0, inner.0), (inner.1, outer.1)] {
                if part.0 >= part.1 {
                    continue;
                }
                for piece in y.pieces(part) {
                    let range = points(piece);
                    if range.0 < range.1 {
                        show(range, if first { counted } else { 0 });
                        first = false;
                    }
                }
            }
            if first && counted > 0 {
                show((0, 0), counted);
            }
        }
    }
}
