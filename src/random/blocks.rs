//! Many blocks of a stream at once, and the numbers that are made of them.
//!
//! ChaCha gives 16 words of 32 bits a block, and a block depends on nothing but key, stream and its own number. So neighbouring blocks can be computed side by side, the same
//! word of each in one vector register, which nearly halves the price of a random number; and what is done with the words goes on side by side. The generator of the crate, whose
//! words these are to the bit, is the judge of the tests, and says and is told where in its stream it is.
//!
//! # References
//! Bernstein 2008, ChaCha, a variant of Salsa20 (with 8 rounds; a 64-bit block number and a 64-bit stream).

use super::{Stream, open_unit_of};
use pulp::{Arch, Simd, WithSimd};

/// Words of 32 bits in a block.
const WORDS: usize = 16;

/// Blocks treated together.
const BLOCKS: usize = 64;

/// Numbers of 64 bits in them.
const NUMBERS: usize = BLOCKS * WORDS / 2;

/// Word by word, what each block has there.
type Table = [[u32; BLOCKS]; WORDS];

/// Below so many numbers the generator itself is quicker.
const FEW: usize = NUMBERS / 4;

/// What becomes of the numbers of one table.
pub(super) trait Use {
    /// The first `many` numbers of `table`, in order, are the next ones.
    fn take(&mut self, table: &Table, many: usize);

    /// The next numbers come one at a time.
    fn take_one(&mut self, number: u64);
}

/// Gives `to` the next `many` numbers of 64 bits of `stream`.
pub(super) fn numbers(stream: &mut Stream, mut many: usize, to: &mut impl Use) {
    use rand::RngExt;
    let mut one_by_one = |stream: &mut Stream, count: usize| {
        for _ in 0..count {
            to.take_one(stream.random());
        }
    };
    let place = stream.get_word_pos();
    // up to the next whole block; a stream that has been asked for an odd number of words never gets there
    let ahead = (WORDS - (place % WORDS as u128) as usize) % WORDS;
    if many < FEW || !ahead.is_multiple_of(2) {
        return one_by_one(stream, many);
    }
    let first = many.min(ahead / 2);
    one_by_one(stream, first);
    many -= first;
    let mut place = stream.get_word_pos();
    let seed = stream.get_seed();
    let (words, _) = seed.as_chunks::<4>();
    let mut key = [0; 8];
    for (key, word) in key.iter_mut().zip(words) {
        *key = u32::from_le_bytes(*word);
    }
    let mut table = [[0; BLOCKS]; WORDS];
    while many >= FEW {
        Arch::new().dispatch(Blocks {
            key,
            stream: stream.get_stream(),
            first: (place / WORDS as u128) as u64,
            table: &mut table,
        });
        let taken = many.min(NUMBERS);
        to.take(&table, taken);
        place += 2 * taken as u128;
        many -= taken;
    }
    stream.set_word_pos(place);
    for _ in 0..many {
        to.take_one(stream.random());
    }
}

/// Consecutive blocks of one stream.
struct Blocks<'a> {
    key: [u32; 8],
    stream: u64,
    /// The number of the first.
    first: u64,
    table: &'a mut Table,
}

impl WithSimd for Blocks<'_> {
    type Output = ();

    /// One block a turn, in words without a loop inside, which compilers turn into as many blocks a turn as registers hold.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let k = self.key;
        for block in 0..BLOCKS {
            let number = self.first.wrapping_add(block as u64);
            let start = [
                0x6170_7865,
                0x3320_646e,
                0x7962_2d32,
                0x6b20_6574,
                k[0],
                k[1],
                k[2],
                k[3],
                k[4],
                k[5],
                k[6],
                k[7],
                number as u32,
                (number >> 32) as u32,
                self.stream as u32,
                (self.stream >> 32) as u32,
            ];
            let mut state = start;
            double_round(&mut state);
            double_round(&mut state);
            double_round(&mut state);
            double_round(&mut state);
            for word in 0..WORDS {
                self.table[word][block] = state[word].wrapping_add(start[word]);
            }
        }
    }
}

/// Columns, then diagonals.
#[inline(always)]
fn double_round(state: &mut [u32; WORDS]) {
    quarter_round(state, [0, 4, 8, 12]);
    quarter_round(state, [1, 5, 9, 13]);
    quarter_round(state, [2, 6, 10, 14]);
    quarter_round(state, [3, 7, 11, 15]);
    quarter_round(state, [0, 5, 10, 15]);
    quarter_round(state, [1, 6, 11, 12]);
    quarter_round(state, [2, 7, 8, 13]);
    quarter_round(state, [3, 4, 9, 14]);
}

#[inline(always)]
fn quarter_round(s: &mut [u32; WORDS], [a, b, c, d]: [usize; 4]) {
    s[a] = s[a].wrapping_add(s[b]);
    s[d] = (s[d] ^ s[a]).rotate_left(16);
    s[c] = s[c].wrapping_add(s[d]);
    s[b] = (s[b] ^ s[c]).rotate_left(12);
    s[a] = s[a].wrapping_add(s[b]);
    s[d] = (s[d] ^ s[a]).rotate_left(8);
    s[c] = s[c].wrapping_add(s[d]);
    s[b] = (s[b] ^ s[c]).rotate_left(7);
}

/// Number `index` of a block of a table.
#[inline(always)]
fn number(table: &Table, block: usize, index: usize) -> u64 {
    u64::from(table[2 * index][block]) | u64::from(table[2 * index + 1][block]) << 32
}

/// Numbers between 0 and 1, in order.
pub(super) struct Units<'a> {
    pub(super) numbers: &'a mut [f64],
    pub(super) done: usize,
}

impl Use for Units<'_> {
    fn take(&mut self, table: &Table, many: usize) {
        let mut all = [0.0; NUMBERS];
        Arch::new().dispatch(InOrder {
            table,
            numbers: &mut all,
        });
        self.numbers[self.done..self.done + many].copy_from_slice(&all[..many]);
        self.done += many;
    }

    fn take_one(&mut self, number: u64) {
        self.numbers[self.done] = open_unit_of(number);
        self.done += 1;
    }
}

struct InOrder<'a> {
    table: &'a Table,
    numbers: &'a mut [f64; NUMBERS],
}

impl WithSimd for InOrder<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (blocks, _) = self.numbers.as_chunks_mut::<{ WORDS / 2 }>();
        for (block, numbers) in blocks.iter_mut().enumerate() {
            for (index, place) in numbers.iter_mut().enumerate() {
                *place = open_unit_of(number(self.table, block, index));
            }
        }
    }
}

/// Numbers between 0 and 1 two by two: the first ones of all pairs, and the second ones.
pub(super) struct Pairs<'a> {
    pub(super) first: &'a mut [f64],
    pub(super) second: &'a mut [f64],
    /// Numbers so far.
    pub(super) done: usize,
}

impl Use for Pairs<'_> {
    fn take(&mut self, table: &Table, many: usize) {
        let start = self.done / 2;
        if many == NUMBERS && self.done.is_multiple_of(2) {
            let range = start..start + NUMBERS / 2;
            Arch::new().dispatch(Apart {
                table,
                first: self.first[range.clone()].as_chunks_mut().0,
                second: self.second[range].as_chunks_mut().0,
            });
            self.done += many;
            return;
        }
        let (mut first, mut second) = ([0.0; NUMBERS / 2], [0.0; NUMBERS / 2]);
        Arch::new().dispatch(Apart {
            table,
            first: first.as_chunks_mut().0,
            second: second.as_chunks_mut().0,
        });
        if self.done.is_multiple_of(2) && many.is_multiple_of(2) {
            let range = start..start + many / 2;
            self.first[range.clone()].copy_from_slice(&first[..many / 2]);
            self.second[range].copy_from_slice(&second[..many / 2]);
            self.done += many;
        } else {
            for i in 0..many {
                self.take_one(number(table, i / (WORDS / 2), i % (WORDS / 2)));
            }
        }
    }

    fn take_one(&mut self, number: u64) {
        let of = if self.done.is_multiple_of(2) {
            &mut *self.first
        } else {
            &mut *self.second
        };
        of[self.done / 2] = open_unit_of(number);
        self.done += 1;
    }
}

/// Pairs in a block.
const PAIRS: usize = WORDS / 4;

struct Apart<'a> {
    table: &'a Table,
    first: &'a mut [[f64; PAIRS]],
    second: &'a mut [[f64; PAIRS]],
}

impl WithSimd for Apart<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let places = self.first.iter_mut().zip(self.second);
        for (block, (first, second)) in places.enumerate().take(BLOCKS) {
            for pair in 0..PAIRS {
                first[pair] = open_unit_of(number(self.table, block, 2 * pair));
                second[pair] = open_unit_of(number(self.table, block, 2 * pair + 1));
            }
        }
    }
}
