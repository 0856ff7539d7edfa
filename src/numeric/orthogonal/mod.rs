//! Orthonormal systems of functions, many places at a time.
//!
//! | system | functions | where | file |
//! |---|---|---|---|
//! | cosine | 1, √2 cos πku | \[0, 1\] | `cosine.rs` |
//! | Fourier | 1, √2 cos 2πku, √2 sin 2πku | \[0, 1\], wrapped round | `fourier.rs` |
//! | Legendre | √(2k + 1) Pₖ(2u - 1) | \[0, 1\] | `legendre.rs` |
//! | Hermite | (2ᵏ k! √π)^(-1/2) Hₖ(u) exp(-u²/2) | the line | `hermite.rs` |
//!
//! All are orthonormal with the weight 1: ∫ φᵢ φⱼ = δᵢⱼ. They are ordered by *degree* k; a degree has one function, but two in Fourier's system from k = 1 on.
//! What is called a number of terms is a number of degrees.
//!
//! # How they are computed
//! By recurrences that neither grow rounding errors nor overflow, on [`LANES`] places at once, so that one step of a recurrence is one short loop over
//! vector registers. The value at a place does not depend on its neighbours, so one place alone gives the same bits.
//!
//! # References
//! Szegő 1975, Orthogonal Polynomials; Kronmal & Tarter 1968, Journal of the American Statistical Association 63.
// inlined wherever they are called from code compiled for wide registers
#![allow(clippy::inline_always)]

mod cosine;
mod fourier;
mod hermite;
mod legendre;
mod sums;

pub use cosine::Cosine;
pub use fourier::Fourier;
pub use hermite::Hermite;
pub use legendre::Legendre;
pub use sums::{Placed, Projection};

/// Places handled at one go: their rows stay in the first-level cache.
pub const LANES: usize = 32;

/// One number for each of the places handled at one go.
pub type Row = [f64; LANES];

/// [0, 1] cut into `panels`, shorter towards the ends, as the distances between the zeros of polynomials are.
fn graded(panels: usize) -> Vec<f64> {
    (0..=panels)
        .map(|i| 0.5 - 0.5 * (std::f64::consts::PI * i as f64 / panels as f64).cos())
        .collect()
}

/// An orthonormal system with the weight 1.
pub trait Basis: Copy + Default + Send + Sync + 'static {
    /// Whether it lives on \[0, 1\]; if not, on the whole line.
    const COMPACT: bool;

    /// How many functions have a degree below `terms`.
    fn functions(terms: usize) -> usize {
        terms
    }

    /// The degree of function `index`.
    fn degree(index: usize) -> usize {
        index
    }

    /// Shows all functions of degree below `terms` at the places `u` to `visit`, with their indices, in order. A compact system expects 0 ≤ u ≤ 1, the
    /// others take any finite number.
    fn walk(u: &Row, terms: usize, visit: impl FnMut(usize, &Row));

    /// Places between which functions of degree below `terms` swing so few times that a rule with 24 nodes integrates a product of two of them exactly or
    /// to rounding: ascending, from one end of the system to the other (for the line, to where the functions have faded).
    fn cuts(terms: usize) -> Vec<f64> {
        graded(terms / 3 + 4)
    }

    /// The functions at one place.
    fn at(u: f64, terms: usize) -> Vec<f64> {
        let mut values = Vec::with_capacity(Self::functions(terms));
        Self::walk(&[u; LANES], terms, |_, row| values.push(row[0]));
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::{GaussLegendre, panels};

    /// The greatest |∫ φᵢφⱼ - δᵢⱼ| among degrees below `terms`.
    fn furthest<B: Basis>(terms: usize, [low, high]: [f64; 2], panel: f64) -> f64 {
        let rule = GaussLegendre::new(24);
        let count = B::functions(terms);
        let mut gram = vec![0.0; count * count];
        for piece in panels(low, high, [], panel).windows(2) {
            for (u, weight) in rule.on(piece[0], piece[1]) {
                let values = B::at(u, terms);
                assert_eq!(values.len(), count);
                for i in 0..count {
                    for j in 0..count {
                        gram[i * count + j] += weight * values[i] * values[j];
                    }
                }
            }
        }
        (0..count * count)
            .map(|k| (gram[k] - f64::from(u8::from(k / count == k % count))).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn the_systems_are_orthonormal() {
        for (name, found) in [
            ("cosine", furthest::<Cosine>(60, [0.0, 1.0], 0.02)),
            ("fourier", furthest::<Fourier>(30, [0.0, 1.0], 0.02)),
            ("legendre", furthest::<Legendre>(60, [0.0, 1.0], 0.02)),
            ("hermite", furthest::<Hermite>(60, [-20.0, 20.0], 0.5)),
            // more than fit into the range of exp(-u²/2) alone
            ("hermite", furthest::<Hermite>(130, [-26.0, 26.0], 0.5)),
        ] {
            assert!(found < 3e-13, "{name}: {found:e}");
        }
    }

    /// The cuts are good for what they promise.
    #[test]
    fn products_are_integrated_between_the_cuts() {
        fn check<B: Basis>(terms: usize) {
            let rule = GaussLegendre::new(24);
            let count = B::functions(terms);
            let mut sums = vec![0.0; count];
            for piece in B::cuts(terms).windows(2) {
                for (u, weight) in rule.on(piece[0], piece[1]) {
                    let values = B::at(u, terms);
                    for (sum, value) in sums.iter_mut().zip(&values) {
                        *sum += weight * value * values[count - 1];
                    }
                }
            }
            for (k, sum) in sums.iter().enumerate() {
                let exact = f64::from(u8::from(k + 1 == count));
                assert!((sum - exact).abs() < 1e-11, "{terms}, {k}: {sum}");
            }
        }
        for terms in [1, 2, 5, 30, 200, 700] {
            check::<Cosine>(terms);
            check::<Fourier>(terms / 2 + 1);
            check::<Legendre>(terms);
            check::<Hermite>(terms);
        }
    }

    #[test]
    fn degrees_are_in_order_and_counted() {
        fn check<B: Basis>() {
            for terms in 0..20 {
                let below = (0..100).filter(|&i| B::degree(i) < terms).count();
                assert_eq!(B::functions(terms), below);
                let mut expected = 0;
                B::walk(&[0.3; LANES], terms, |index, _| {
                    assert_eq!(index, expected);
                    expected += 1;
                });
                assert_eq!(expected, below);
            }
        }
        check::<Cosine>();
        check::<Fourier>();
        check::<Legendre>();
        check::<Hermite>();
    }

    /// Bits must not depend on which places are looked at together.
    #[test]
    fn a_place_alone_has_the_value_it_has_among_others() {
        fn check<B: Basis>(places: impl Fn(usize) -> f64) {
            let row: Row = std::array::from_fn(places);
            let mut together = Vec::new();
            B::walk(&row, 50, |_, values| together.push(*values));
            for (lane, &u) in row.iter().enumerate() {
                for (index, value) in B::at(u, 50).into_iter().enumerate() {
                    assert_eq!(value.to_bits(), together[index][lane].to_bits(), "{u}");
                }
            }
        }
        let unit = |i: usize| i as f64 / (LANES - 1) as f64;
        check::<Cosine>(unit);
        check::<Fourier>(unit);
        check::<Legendre>(unit);
        check::<Hermite>(|i| (i as f64 - 16.0).powi(3) * 0.01);
    }
}
