//! Random words, made many at a time.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use crate::random::Stream;
use rand::{Rng, TryRng};
use std::convert::Infallible;

/// Words made at a time.
const MANY: usize = 1024;

/// The words of a stream in their order. Making many at a time is several times cheaper than one after the other.
pub(super) struct Words {
    stream: Stream,
    made: [[u8; 8]; MANY],
    /// The first that was not taken.
    at: usize,
}

impl Words {
    pub(super) fn of(stream: Stream) -> Self {
        Self {
            stream,
            made: [[0; 8]; MANY],
            at: MANY,
        }
    }

    #[inline(never)]
    fn make(&mut self) {
        let taken = self.at;
        self.made.copy_within(taken.., 0);
        let new = self.made[MANY - taken..].as_flattened_mut();
        self.stream.fill_bytes(new);
        self.at = 0;
    }

    /// The next two, of which none is taken.
    #[inline(always)]
    pub(super) fn next_two(&mut self) -> [u64; 2] {
        if self.at > MANY - 2 {
            self.make();
        }
        let [first, second] = [self.made[self.at], self.made[self.at + 1]];
        [u64::from_le_bytes(first), u64::from_le_bytes(second)]
    }

    /// Takes some of the next two.
    #[inline(always)]
    pub(super) fn take(&mut self, count: usize) {
        self.at += count;
    }

    /// A word as a number from 0 to below 1, in steps of 2⁻⁵³.
    #[inline(always)]
    pub(super) fn unit(word: u64) -> f64 {
        const STEP: f64 = 1.0 / 9_007_199_254_740_992.0;
        // 53 bits have no sign
        (word >> 11) as i64 as f64 * STEP
    }
}

impl TryRng for Words {
    type Error = Infallible;

    #[inline(always)]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next_u64() as u32)
    }

    #[inline(always)]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let [word, _] = self.next_two();
        self.take(1);
        Ok(word)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for bytes in bytes.chunks_mut(8) {
            let word = self.next_u64().to_le_bytes();
            bytes.copy_from_slice(&word[..bytes.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{MANY, Words};
    use crate::random::stream;
    use rand::{Rng, RngExt};

    #[test]
    fn they_are_those_of_the_stream_in_their_order() {
        let mut words = Words::of(stream(3, "words", 1));
        let mut plain = stream(3, "words", 1);
        for k in 0..5 * MANY {
            if k % 3 == 0 {
                let [first, second] = words.next_two();
                words.take(2);
                assert_eq!([first, second], [plain.next_u64(), plain.next_u64()], "{k}");
            } else {
                let [next, _] = words.next_two();
                assert_eq!(Words::unit(next).to_bits(), plain.random::<f64>().to_bits());
                words.take(1);
            }
            assert_eq!(words.next_u64(), plain.next_u64(), "{k}");
        }
    }
}
