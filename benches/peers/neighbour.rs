//! What `neighbours.py` asks its peers, asked of the k-d tree crate: `peers-neighbour DATA K ANSWER`.
//!
//! DATA holds pairs of doubles in the unit square, ANSWER receives the distance of the K-th neighbour at the centres of 256² cells, first axis first. Prints the CPU seconds of building and asking, on one thread.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::error::Error;
use std::num::NonZeroUsize;

const SIDE: usize = 256;

/// CPU seconds of this process.
fn cpu() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [data, k, answer] = words.as_slice() else {
        return Err("DATA K ANSWER".into());
    };
    let bytes = std::fs::read(data)?;
    let numbers: Vec<f64> = bytes
        .as_chunks::<8>()
        .0
        .iter()
        .map(|eight| f64::from_le_bytes(*eight))
        .collect();
    let points = numbers.as_chunks::<2>().0;
    let k = NonZeroUsize::new(k.parse()?).ok_or("K is 1 or more")?;
    let centre = |i: usize| (i as f64 + 0.5) / SIDE as f64;
    let start = cpu();
    let tree = ImmutableKdTree::<f64, 2>::new_from_slice(points)?;
    let distances: Vec<f64> = (0..SIDE * SIDE)
        .map(|i| {
            let place = [centre(i / SIDE), centre(i % SIDE)];
            let list = tree.query(&place).nearest_n::<SquaredEuclidean<f64>>(k);
            list.execute()
                .last()
                .map_or(f64::NAN, |hit| hit.distance.sqrt())
        })
        .collect();
    let seconds = cpu() - start;
    let bytes: Vec<u8> = distances.iter().flat_map(|d| d.to_le_bytes()).collect();
    std::fs::write(answer, bytes)?;
    println!("{seconds}");
    Ok(())
}
