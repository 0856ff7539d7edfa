//! Counting what a query does: wall time on a shared machine is noise, operations are not.

/// Told of every operation of a query. The unit type counts nothing, and what it is told is compiled away.
pub trait Counter {
    /// So many distances were computed.
    fn distances(&mut self, many: usize);
    /// So many nodes were visited: steps of a binary search, rectangles of a table of sums, columns of cells.
    fn nodes(&mut self, many: usize);
}

impl Counter for () {
    #[inline(always)]
    fn distances(&mut self, _many: usize) {}

    #[inline(always)]
    fn nodes(&mut self, _many: usize) {}
}

/// The operations of some queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Distances computed.
    pub distances: u64,
    /// Nodes visited.
    pub nodes: u64,
}

impl Work {
    /// Distances and nodes together.
    pub fn total(&self) -> u64 {
        self.distances + self.nodes
    }
}

impl Counter for Work {
    fn distances(&mut self, many: usize) {
        self.distances += many as u64;
    }

    fn nodes(&mut self, many: usize) {
        self.nodes += many as u64;
    }
}
