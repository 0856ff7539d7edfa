//! Named random streams: (seed, purpose, number) → a stream of its own.
//!
//! A stream depends on nothing but its name, so any block of work can be done on any thread, machine or day and give the same
//! bits. The generator is counter-based ChaCha with 8 rounds, whose output the crates that provide it promise to keep; it is named
//! in every manifest. Never a generator that may change between versions, never one seeded from a thread or the clock.

mod blocks;

use blocks::{Pairs, Units};
use rand::distr::Open01;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A stream of random numbers; use it through `rand::RngExt` and `rand_distr`.
pub type Stream = ChaCha8Rng;

/// The name of the generator, for manifests.
pub const GENERATOR: &str = "ChaCha8, key = BLAKE3(seed, purpose), stream = number";

/// The streams for one purpose under one seed, when many are wanted: naming them costs more than making them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Streams([u8; 32]);

impl Streams {
    /// Those for `purpose` under an experiment's `seed`. Different purposes have unrelated keys.
    pub fn new(seed: u64, purpose: &str) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&seed.to_le_bytes());
        hasher.update(purpose.as_bytes());
        Self(*hasher.finalize().as_bytes())
    }

    /// The one with a `number` (replicate, block of photons, place). Different numbers are disjoint streams of one key.
    pub fn number(&self, number: u64) -> Stream {
        let mut stream = ChaCha8Rng::from_seed(self.0);
        stream.set_stream(number);
        stream
    }
}

/// The stream for `purpose` with a `number` under an experiment's `seed`; see [`Streams`].
pub fn stream(seed: u64, purpose: &str, number: u64) -> Stream {
    Streams::new(seed, purpose).number(number)
}

/// A number strictly between 0 and 1, from one 64-bit word: what inverse distribution functions want.
pub fn open_unit(stream: &mut Stream) -> f64 {
    stream.sample(Open01)
}

/// A number strictly between 0 and 1 of a 64-bit word, as `Open01` does: 52 bits as a number from 1 to 2, and what makes that the middle of its interval.
#[inline(always)]
fn open_unit_of(word: u64) -> f64 {
    let fraction = f64::from_bits(1.0f64.to_bits() | (word >> 12));
    fraction - (1.0 - 0.5 * f64::EPSILON)
}

/// As many numbers strictly between 0 and 1, the same as by [`open_unit`] one after the other; some 2 ns a number.
pub fn open_units(stream: &mut Stream, numbers: &mut [f64]) {
    let many = numbers.len();
    blocks::numbers(stream, many, &mut Units { numbers, done: 0 });
}

/// Pairs of such numbers: `first[0]`, `second[0]`, `first[1]`, ... are what [`open_unit`] gives one after the other; some 1.5 ns a number.
///
/// # Panics
/// If there are not as many second ones as first ones.
pub fn open_pairs(stream: &mut Stream, first: &mut [f64], second: &mut [f64]) {
    assert_eq!(first.len(), second.len(), "pairs");
    let many = 2 * first.len();
    let mut pairs = Pairs {
        first,
        second,
        done: 0,
    };
    blocks::numbers(stream, many, &mut pairs);
}

#[cfg(test)]
mod tests {
    use super::{open_pairs, open_unit, open_units, stream};
    use rand::RngExt;

    /// The generator of the crate is the judge, from any place in a stream on, and of where the stream then is.
    #[test]
    fn many_numbers_are_those_of_one_at_a_time() {
        let start = |words: usize| {
            let mut stream = stream(3, "sample", 1 << 40);
            for _ in 0..words {
                stream.random::<u32>();
            }
            stream
        };
        for words in [0, 1, 2, 6, 15, 16, 17, 62, 64, 2000] {
            for length in [0, 1, 2, 127, 128, 136, 255, 256, 257, 512, 520, 1001, 2000] {
                let (mut one, mut all, mut pairs) = (start(words), start(words), start(words));
                let mut numbers = vec![0.0; length];
                open_units(&mut all, &mut numbers);
                let (mut first, mut second) = (vec![0.0; length / 2], vec![0.0; length / 2]);
                open_pairs(&mut pairs, &mut first, &mut second);
                let apart = first.iter().zip(&second).flat_map(|(a, b)| [*a, *b]);
                assert!(apart.eq(numbers[..length / 2 * 2].iter().copied()));
                for number in numbers {
                    assert_eq!(number.to_bits(), open_unit(&mut one).to_bits());
                }
                assert_eq!(all.random::<u64>(), one.random::<u64>(), "{words} {length}");
                if length % 2 == 1 {
                    pairs.random::<u64>();
                }
                assert_eq!(pairs.random::<u64>(), {
                    let mut again = start(words);
                    (0..length).for_each(|_| {
                        again.random::<u64>();
                    });
                    again.random::<u64>()
                });
            }
        }
    }

    /// Where the number of the block no longer fits into 32 bits.
    #[test]
    fn long_streams_go_on() {
        let start = || {
            let mut stream = stream(3, "sample", 5);
            stream.set_word_pos(((1u128 << 32) - 20) * 16);
            stream
        };
        let (mut one, mut all) = (start(), start());
        let mut numbers = vec![0.0; 700];
        open_units(&mut all, &mut numbers);
        for number in numbers {
            assert_eq!(number.to_bits(), open_unit(&mut one).to_bits());
        }
    }

    #[test]
    fn streams_are_frozen() {
        let mut first = stream(1986, "sample", 0);
        let drawn: [u64; 2] = [first.random(), first.random()];
        assert_eq!(drawn, FROZEN, "every published result would change");
    }

    #[test]
    fn names_tell_streams_apart() {
        let draw = |seed, purpose, number| stream(seed, purpose, number).random::<u64>();
        let all = [
            draw(1, "sample", 0),
            draw(2, "sample", 0),
            draw(1, "bootstrap", 0),
            draw(1, "sample", 1),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b));
        }
    }

    const FROZEN: [u64; 2] = [11_301_799_369_231_876_628, 3_915_649_587_274_852_046];
}
