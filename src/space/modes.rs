//! Modes: the tops of a sampled function.

use super::Raster;

/// How far a top must rise above its surroundings to count, relative to the highest: far above what an exact engine's rounding ripples, far below what
/// anyone would call a bump. With an approximate engine, at least twice its error.
pub const RIPPLE: f64 = 1e-9;

/// A local maximum of sampled values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// The middle of the cells that share the greatest value.
    pub at: f64,
    /// That value.
    pub value: f64,
}

/// The modes of `raster` from left to right.
///
/// A mode is a place that one cannot leave, to either side, for a higher one without first going down by more than `tolerance` times the highest value
/// (its prominence); so neighbouring tops with a shallower dip between them are one mode, at the higher one. A plateau is one mode, at its middle.
/// Beyond the ends of the grid the function counts as having no height: a function that is highest at a wall has a mode there. The place is that of a
/// cell centre or halfway between two, so it is no better than half a cell, and tops closer than two cells are one.
///
/// No modes if no value is positive. O(cells).
pub fn modes(raster: &Raster<1>, tolerance: f64) -> Vec<Mode> {
    let place = |i: usize| raster.grid().coordinate(0, i);
    let mut found = Vec::new();
    for_each_top(raster.values(), tolerance, |value, first, last| {
        found.push(Mode {
            at: 0.5 * (place(first) + place(last)),
            value,
        });
    });
    found
}

/// The largest of `values`; 0 if none is positive. Several at a time, which a running maximum of one is not.
fn peak(values: &[f64]) -> f64 {
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let (chunks, rest) = values.as_chunks::<8>();
    let mut peaks = [0.0; 8];
    for chunk in chunks {
        for (peak, &value) in peaks.iter_mut().zip(chunk) {
            *peak = larger(*peak, value);
        }
    }
    peaks.iter().chain(rest).copied().fold(0.0, larger)
}

/// Steps of a curve that are looked at together.
const STEPS: usize = 8;

/// Whether something holds of each value and the next, without a branch for each.
fn all(values: &[f64; STEPS + 1], holds: impl Fn(f64, f64) -> bool) -> bool {
    let mut all = true;
    for step in 0..STEPS {
        all &= holds(values[step], values[step + 1]);
    }
    all
}

/// Says of each mode of values side by side how high it is and which are the first and the last of the cells that share the height.
pub(super) fn for_each_top(
    values: &[f64],
    tolerance: f64,
    mut found: impl FnMut(f64, usize, usize),
) {
    let peak = peak(values);
    if peak <= 0.0 {
        return;
    }
    let rise = tolerance * peak;
    // climbing: the best top so far and the cells that share it; otherwise the deepest value since the last top
    let mut top: Option<(f64, usize, usize)> = Some((values[0], 0, 0));
    let mut deepest = values[0];
    let (mut i, mut look) = (1, 1);
    while i < values.len() {
        // most of a curve goes up for long, or down: some steps at once, with the outcome of one after the other
        if i >= look {
            look = i + STEPS;
            if let Some((ahead, _)) = values[i - 1..].split_first_chunk::<{ STEPS + 1 }>() {
                match &mut top {
                    Some(top) if top.2 + 1 == i && all(ahead, |now, next| next > now) => {
                        // what was before is lower, or the top would be elsewhere
                        *top = (ahead[STEPS], i + STEPS - 1, i + STEPS - 1);
                        i += STEPS;
                        continue;
                    }
                    None if deepest >= ahead[0] && all(ahead, |now, next| next < now) => {
                        deepest = ahead[STEPS];
                        i += STEPS;
                        continue;
                    }
                    _ => {}
                }
            }
        }
        let value = values[i];
        if let Some((best, first, last)) = &mut top {
            if value > *best {
                (*best, *first, *last) = (value, i, i);
            } else if value >= *best && *last + 1 == i {
                *last = i;
            } else if *best - value > rise {
                found(*best, *first, *last);
                top = None;
                deepest = value;
            }
        } else {
            deepest = if value < deepest { value } else { deepest };
            if value - deepest > rise {
                top = Some((value, i, i));
            }
        }
        i += 1;
    }
    if let Some((value, first, last)) = top {
        found(value, first, last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::special::normal_density;
    use crate::space::Grid;

    fn of(values: &[f64], tolerance: f64) -> Vec<f64> {
        let grid = Grid::new([0.0], [values.len() as f64], [values.len()]).expect("legal");
        let found = modes(&Raster::new(grid, values.to_vec()), tolerance);
        // in cells, the first being 0
        found.iter().map(|mode| mode.at - 0.5).collect()
    }

    #[test]
    fn tops_plateaus_and_ends() {
        assert_eq!(of(&[0.0, 1.0, 0.0], RIPPLE), [1.0]);
        assert_eq!(of(&[0.0, 1.0, 0.0, 2.0, 0.0], RIPPLE), [1.0, 3.0]);
        assert_eq!(
            of(&[0.0, 1.0, 1.0, 1.0, 0.0, 2.0, 2.0, 0.0], RIPPLE),
            [2.0, 5.5]
        );
        // a step on the way up is no mode
        assert_eq!(of(&[0.0, 1.0, 1.0, 2.0, 1.5, 1.5, 0.0], RIPPLE), [3.0]);
        assert_eq!(of(&[3.0, 2.0, 1.0, 2.0], RIPPLE), [0.0, 3.0]);
        assert_eq!(of(&[1.0; 5], RIPPLE), [2.0]);
        assert_eq!(of(&[1.0], RIPPLE), [0.0]);
        assert!(of(&[0.0; 4], RIPPLE).is_empty());
    }

    #[test]
    fn ripples_are_no_modes() {
        // rounding on a flat top
        assert_eq!(
            of(&[0.0, 1.0, 1.0 - 1e-12, 1.0 + 1e-12, 1.0, 0.0], RIPPLE),
            [3.0]
        );
        assert_eq!(
            of(&[0.0, 1.0, 1.0 - 1e-12, 1.0 + 1e-12, 1.0, 0.0], 0.0).len(),
            2
        );
        // rounding in the far tail
        assert_eq!(
            of(&[1e-13, 0.0, 2e-13, 0.0, 1.0, 0.0, 1e-14], RIPPLE),
            [4.0]
        );
        // a dip of three percent counts with two percent asked, not with four
        let dip = [0.0, 1.0, 0.97, 0.98, 1.0 - 1e-3, 0.0];
        assert_eq!(of(&dip, 0.02), [1.0, 4.0]);
        assert_eq!(of(&dip, 0.04), [1.0]);
    }

    /// ½N(-1, s²) + ½N(1, s²) has two modes if and only if s < 1. [Behboodian 1970]
    #[test]
    fn normals_merge_where_they_should() {
        let grid = Grid::new([-5.0], [5.0], [4001]).expect("legal");
        let count = |s: f64| {
            let f = |x: f64| normal_density((x - 1.0) / s) + normal_density((x + 1.0) / s);
            let values = grid.centres().map(|[x]| f(x)).collect();
            modes(&Raster::new(grid, values), RIPPLE)
        };
        assert_eq!(count(0.98).len(), 2);
        assert_eq!(count(1.02).len(), 1);
        let two = count(2.0 / 3.0);
        assert!((two[0].at + two[1].at).abs() < 1e-12);
        // the root of x = tanh(x / s²) for s = 2/3
        assert!((two[1].at - 0.9755).abs() < 0.0015, "{two:?}");
    }

    /// Prominence by its definition, on many small sequences.
    #[test]
    fn the_pass_counts_what_the_definition_says() {
        let mut state = 7u64;
        for round in 0..5000 {
            let (mut level, mut up) = (20.0, true);
            let values: Vec<f64> = (0..40)
                .map(|_| {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1_442_695_040_888_963_407);
                    let noise = (state >> 61) as f64;
                    if round % 2 == 0 {
                        return noise;
                    }
                    // up or down for more steps than are looked at together, now and then level
                    up ^= (state >> 40).is_multiple_of(9);
                    let step = if (state >> 50).is_multiple_of(16) {
                        0.0
                    } else {
                        noise + 1.0
                    };
                    level += if up { step } else { -step };
                    level
                })
                .collect();
            let peak = values.iter().copied().fold(0.0, f64::max);
            let rise = 0.3 * peak;
            // flood from above: a top is a mode if, walking to either side, nothing higher comes before a drop by more than `rise`; of equals the leftmost counts
            let count = (0..values.len())
                .filter(|_| peak > 0.0)
                .filter(|&i| {
                    let escapes = |walk: &mut dyn Iterator<Item = usize>, ties: bool| {
                        for j in walk {
                            if values[i] - values[j] > rise {
                                return false;
                            }
                            if values[j] > values[i] || ties && values[j] >= values[i] {
                                return true;
                            }
                        }
                        false
                    };
                    !escapes(&mut (0..i).rev(), true) && !escapes(&mut (i + 1..values.len()), false)
                })
                .count();
            assert_eq!(of(&values, 0.3).len(), count, "{values:?}");
        }
    }
}
