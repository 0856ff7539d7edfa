//! Functions replaced by polynomials on pieces: computed dearly once, evaluated cheaply ever after.
//!
//! # References
//! Trefethen 2013, Approximation Theory and Approximation Practice, chapters 3 and 8.

use std::f64::consts::PI;

/// Coefficients of one piece. With 16 a piece is good to rounding as soon as it is short against the scale of the function.
const TERMS: usize = 16;

/// A polynomial of degree 15 on an interval, through 16 Chebyshev points.
#[derive(Clone, Debug)]
struct Piece {
    low: f64,
    high: f64,
    coefficients: [f64; TERMS],
}

impl Piece {
    fn fit(f: &impl Fn(f64) -> f64, low: f64, high: f64) -> Self {
        let angle = |k: usize| PI * (k as f64 + 0.5) / TERMS as f64;
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let values: [f64; TERMS] = std::array::from_fn(|k| f(half.mul_add(angle(k).cos(), middle)));
        let coefficients = std::array::from_fn(|j| {
            let sum: f64 = values
                .iter()
                .enumerate()
                .map(|(k, value)| value * (j as f64 * angle(k)).cos())
                .sum();
            sum * if j == 0 { 1.0 } else { 2.0 } / TERMS as f64
        });
        Self {
            low,
            high,
            coefficients,
        }
    }

    /// Clenshaw's recurrence.
    fn at(&self, x: f64) -> f64 {
        let t = (2.0 * x - self.low - self.high) / (self.high - self.low);
        let (mut now, mut before) = (0.0, 0.0);
        for &c in self.coefficients[1..].iter().rev() {
            (now, before) = (2.0 * t * now - before + c, now);
        }
        t * now - before + self.coefficients[0]
    }

    /// The size of the last coefficients, which estimates the error, and of the largest.
    fn sizes(&self) -> (f64, f64) {
        let largest = |c: &[f64]| c.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        (
            largest(&self.coefficients[TERMS - 3..]),
            largest(&self.coefficients),
        )
    }
}

/// A function on an interval as polynomials of degree 15 on pieces.
#[derive(Clone, Debug)]
pub struct Piecewise {
    pieces: Vec<Piece>,
}

impl Piecewise {
    /// Approximates `f` between the first and the last of the `cuts` (ascending, at least two), halving pieces until the error is some
    /// 1e-14 of the largest value on the piece or below `negligible`.
    ///
    /// Features of `f` much narrower than the distance between cuts may be missed; put cuts where they are.
    ///
    /// # Panics
    /// If there are fewer than two cuts.
    pub fn fit(f: impl Fn(f64) -> f64, cuts: &[f64], negligible: f64) -> Self {
        assert!(cuts.len() >= 2, "an interval has two ends");
        let mut pieces = Vec::with_capacity(cuts.len());
        for ends in cuts.windows(2) {
            halve(&f, ends[0], ends[1], negligible, 40, &mut pieces);
        }
        Self { pieces }
    }

    /// The value at `x`; beyond the ends, that at the nearer end.
    pub fn at(&self, x: f64) -> f64 {
        let last = self.pieces.len() - 1;
        let place = self
            .pieces
            .partition_point(|piece| piece.high < x)
            .min(last);
        let piece = &self.pieces[place];
        piece.at(x.clamp(piece.low, piece.high))
    }

    /// The ends of the pieces, ascending: between two of them the function is a polynomial of degree 15.
    pub fn cuts(&self) -> impl Iterator<Item = f64> + '_ {
        let first = self.pieces.first().map(|piece| piece.low);
        first
            .into_iter()
            .chain(self.pieces.iter().map(|piece| piece.high))
    }
}

fn halve(
    f: &impl Fn(f64) -> f64,
    low: f64,
    high: f64,
    negligible: f64,
    depth: u32,
    pieces: &mut Vec<Piece>,
) {
    let piece = Piece::fit(f, low, high);
    let (error, size) = piece.sizes();
    let middle = 0.5 * (low + high);
    if error <= 1e-14 * size + negligible || depth == 0 || middle <= low || middle >= high {
        pieces.push(piece);
    } else {
        halve(f, low, middle, negligible, depth - 1, pieces);
        halve(f, middle, high, negligible, depth - 1, pieces);
    }
}

#[cfg(test)]
mod tests {
    use super::Piecewise;

    #[test]
    fn smooth_functions_and_kinks_are_met_to_rounding() {
        let kinked = |x: f64| (3.0 * x).sin() + (x - 0.3).abs().powf(1.5);
        let fitted = Piecewise::fit(kinked, &[0.0, 0.3, 2.0], 1e-15);
        for i in 0..=1000 {
            let x = f64::from(i) * 0.002;
            assert!((fitted.at(x) - kinked(x)).abs() < 1e-13, "at {x}");
        }
        assert!((fitted.at(5.0) - kinked(2.0)).abs() < 1e-13);
        let cuts: Vec<f64> = fitted.cuts().collect();
        assert!(cuts.is_sorted() && cuts.contains(&0.3) && cuts.len() > 10);
    }

    #[test]
    fn polynomials_need_one_piece() {
        let fitted = Piecewise::fit(|x| x.powi(12) - x, &[-1.0, 1.0], 0.0);
        assert_eq!(fitted.cuts().count(), 2);
        assert!((fitted.at(0.9) - (0.9f64.powi(12) - 0.9)).abs() < 1e-15);
    }
}
