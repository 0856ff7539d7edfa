//! One axis of the bucket grid: which cells an interval meets or contains, rounding included.

/// Equal cells along one axis. Cells are numbered on and on: on an axis that wraps round, number i and i + `cells` are one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub low: f64,
    pub width: f64,
    /// Cells in a unit of length; 0 if all points have one coordinate and there is one cell.
    inverse: f64,
    pub cells: isize,
    /// The length if the axis wraps round, infinity if not.
    period: f64,
}

/// Two bounds of a range of cells, the upper one excluded.
pub(super) type Range = (isize, isize);

impl Axis {
    /// `cells` cells on `low` to `low + span`.
    pub fn new(low: f64, span: f64, cells: usize, period: f64) -> Self {
        let thin = span < 1e-290;
        let cells = if thin { 1 } else { cells };
        Self {
            low,
            width: span / cells as f64,
            inverse: if thin { 0.0 } else { cells as f64 / span },
            cells: cells as isize,
            period,
        }
    }

    /// Where `x` is in units of cells.
    pub fn place(&self, x: f64) -> f64 {
        (x - self.low) * self.inverse
    }

    /// The cell that holds a datum at `x`.
    pub fn cell(&self, x: f64) -> usize {
        (self.place(x) as usize).min(self.cells as usize - 1)
    }

    /// The cell nearest to a place.
    pub fn nearest(&self, place: f64) -> isize {
        (place as isize).clamp(0, self.cells - 1)
    }

    pub fn wraps(&self) -> bool {
        self.period.is_finite()
    }

    /// What rounding may do to a place or an edge, in cells.
    fn slack(place: f64) -> f64 {
        1e-14f64.mul_add(place.abs(), 1e-9)
    }

    /// The cell in the grid that a running number means.
    pub fn home(&self, number: isize) -> usize {
        if self.wraps() {
            number.rem_euclid(self.cells) as usize
        } else {
            number as usize
        }
    }

    fn clipped(&self, place: f64, (from, to): Range) -> Range {
        if !self.wraps() {
            let from = from.clamp(0, self.cells);
            return (from, to.clamp(from, self.cells));
        }
        if to.saturating_sub(from) >= self.cells {
            let from = place.floor() as isize - self.cells / 2;
            return (from, from + self.cells);
        }
        (from, to)
    }

    /// All cells that may hold data within `reach` of `place`.
    pub fn met(&self, place: f64, reach: f64) -> Range {
        let reach = reach.mul_add(self.inverse, Self::slack(place));
        // casts of what is beyond the numbers go to the ends
        self.clipped(
            place,
            (
                (place - reach).floor() as isize,
                ((place + reach).floor() as isize).saturating_add(1),
            ),
        )
    }

    /// Cells all of whose data are within `reach` of `place`; part of `outer`.
    pub fn contained(&self, place: f64, reach: f64, outer: Range) -> Range {
        if self.inverse == 0.0 {
            return (outer.0, outer.0);
        }
        let reach = reach.mul_add(self.inverse, -Self::slack(place));
        let from = ((place - reach).ceil() as isize).clamp(outer.0, outer.1);
        let to = ((place + reach).floor() as isize).clamp(outer.0, outer.1);
        if from < to {
            (from, to)
        } else {
            (outer.0, outer.0)
        }
    }

    /// The cells at most `steps` away from `centre`.
    pub fn around(&self, centre: isize, steps: isize) -> Range {
        self.clipped(centre as f64, (centre - steps, centre + steps + 1))
    }

    /// Bounds on the distance along this axis between a target, at `x` and `place`, and the data of a range of cells: no less, no more.
    pub fn offsets(&self, x: f64, place: f64, (from, to): Range) -> (f64, f64) {
        if self.inverse == 0.0 {
            return (0.0, (x - self.low).abs() + self.width);
        }
        let slack = Self::slack(place) * self.width;
        let (a, b) = (
            (from as f64 - place) * self.width,
            (to as f64 - place) * self.width,
        );
        let mut least = if a <= 0.0 && 0.0 <= b {
            0.0
        } else {
            a.abs().min(b.abs())
        };
        let mut most = a.abs().max(b.abs());
        if self.wraps() {
            least = least.min((self.period - most).max(0.0));
            most = most.min(0.5 * self.period);
        }
        ((least - slack).max(0.0), most + slack)
    }

    /// How far a target may go before it can meet data outside of a range of cells about it.
    pub fn margin(&self, place: f64, (from, to): Range) -> f64 {
        if self.wraps() && to - from >= self.cells || self.inverse == 0.0 {
            return f64::INFINITY;
        }
        let side = |distance: f64| (distance - Self::slack(place)) * self.width;
        let below = if self.wraps() || from > 0 {
            side(place - from as f64)
        } else {
            f64::INFINITY
        };
        let above = if self.wraps() || to < self.cells {
            side(to as f64 - place)
        } else {
            f64::INFINITY
        };
        below.min(above).max(0.0)
    }

    /// A range as one or two ranges of cells of the grid.
    pub fn pieces(&self, (from, to): Range) -> [(usize, usize); 2] {
        if from >= to {
            return [(0, 0); 2];
        }
        if !self.wraps() {
            return [(from as usize, to as usize), (0, 0)];
        }
        let start = from.rem_euclid(self.cells);
        let end = start + (to - from);
        if end <= self.cells {
            [(start as usize, end as usize), (0, 0)]
        } else {
            [
                (start as usize, self.cells as usize),
                (0, (end - self.cells) as usize),
            ]
        }
    }
}
