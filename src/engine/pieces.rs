//! A slice cut up, so that several threads can fill it.

use rayon::iter::IntoParallelIterator;

/// `whole` cut into consecutive pieces of these `sizes`; empty pieces once nothing is left.
pub(super) fn pieces<T: Send>(
    whole: &mut [T],
    sizes: impl Iterator<Item = usize>,
) -> rayon::vec::IntoIter<&mut [T]> {
    let mut rest = whole;
    let pieces: Vec<&mut [T]> = sizes
        .map(|size| {
            let size = size.min(rest.len());
            rest.split_off_mut(..size).unwrap_or_default()
        })
        .collect();
    pieces.into_par_iter()
}
