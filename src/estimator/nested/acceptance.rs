//! How a probability becomes a yes or a no.

use crate::random::{Stream, Streams, open_unit};
use crate::space::Point;

/// When a step of probability p is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acceptance {
    /// Where a number thrown anew for each sample and place is below p.
    Random,
    /// Where a number that belongs to the place is below p: the same for all samples, so that differences between samples are those of the data.
    Seeded,
    /// Where p is above 1/2.
    Deterministic,
}

impl Acceptance {
    /// All.
    pub const ALL: [Self; 3] = [Self::Seeded, Self::Random, Self::Deterministic];

    /// The names in the order of [`Acceptance::ALL`].
    pub const NAMES: [&'static str; 3] = ["seeded", "random", "deterministic"];

    /// The way of that name.
    pub fn named(name: &str) -> Option<Self> {
        let at = Self::NAMES.iter().position(|known| *known == name)?;
        Some(Self::ALL[at])
    }
}

/// Dice for every place: a stream of numbers that depends on a seed and the place alone, or on the sample too.
#[derive(Clone, Copy, Debug)]
pub struct Dice {
    acceptance: Acceptance,
    streams: Streams,
}

/// The dice at one place.
pub enum Throws {
    /// Numbers from 0 to 1.
    Numbers(Box<Stream>),
    /// Always 1/2.
    Half,
}

impl Dice {
    /// Dice under a seed.
    pub fn new(acceptance: Acceptance, seed: u64) -> Self {
        Self {
            acceptance,
            streams: Streams::new(seed, "acceptance"),
        }
    }

    /// Whether the answer depends on the digits of the place.
    pub fn depends_on_place(&self) -> bool {
        self.acceptance != Acceptance::Deterministic
    }

    /// The dice at `target`; `sample`, asked only if it matters, gives any number that is another one for another sample.
    pub fn at<const D: usize>(&self, target: Point<D>, sample: impl FnOnce() -> f64) -> Throws {
        let fresh = match self.acceptance {
            Acceptance::Deterministic => return Throws::Half,
            Acceptance::Seeded => 0,
            Acceptance::Random => sample().to_bits(),
        };
        // one zero, so that a place has one name
        let name = target
            .iter()
            .fold(mix(fresh), |name, x| mix(name ^ (x + 0.0).to_bits()));
        Throws::Numbers(Box::new(self.streams.number(name)))
    }
}

impl Throws {
    /// Whether a step of probability `p` is taken.
    pub fn accept(&mut self, p: f64) -> bool {
        match self {
            Self::Numbers(stream) => open_unit(stream) < p,
            Self::Half => p > 0.5,
        }
    }
}

/// Spreads all bits over all bits, reversibly. [Steele, Lea & Flood 2014, SplitMix64]
fn mix(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
