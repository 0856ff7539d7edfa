//! Streams that are not streams of their own, and samples that are not drawn afresh.

use super::Fault;
use crate::density::Density;
use crate::random::{Stream, stream};
use crate::sample::{Sample, SampleError, Source};
use std::sync::Arc;

/// One seed for all.
pub const SEED_IGNORED: Fault = Fault {
    name: "seed-ignored",
    summary: "streams do not depend on the seed",
    caught_by: "streams",
    plant: |subjects| {
        subjects.streams = Arc::new(|_, purpose, number| stream(0, purpose, number));
    },
};

/// The swapped seed: samples and bootstrap from the same numbers.
pub const PURPOSE_IGNORED: Fault = Fault {
    name: "purpose-ignored",
    summary: "streams for different purposes are the same",
    caught_by: "streams",
    plant: |subjects| {
        subjects.streams = Arc::new(|seed, _, number| stream(seed, "all", number));
    },
};

/// Two replicates share a stream.
pub const STREAM_REUSED: Fault = Fault {
    name: "stream-reused",
    summary: "each stream serves two replicates",
    caught_by: "replicates",
    plant: |subjects| {
        subjects.streams = Arc::new(|seed, purpose, number| stream(seed, purpose, number / 2));
    },
};

/// Yields the points of one stream of its own.
struct Same(Arc<dyn Source<1>>);

impl Source<1> for Same {
    fn truth(&self) -> Option<&dyn Density<1>> {
        self.0.truth()
    }

    fn sample(&self, draws: usize, _random: &mut Stream) -> Result<Sample<1>, SampleError> {
        self.0.sample(draws, &mut stream(7, "same", 0))
    }
}

/// A fixed seed in the sampler.
pub const SAMPLE_REUSED: Fault = Fault {
    name: "sample-reused",
    summary: "every replicate is the same sample",
    caught_by: "replicates",
    plant: |subjects| subjects.source = Arc::new(Same(subjects.source.clone())),
};

/// Points in pairs x and -x.
struct Antithetic(Arc<dyn Source<1>>);

impl Source<1> for Antithetic {
    fn truth(&self) -> Option<&dyn Density<1>> {
        self.0.truth()
    }

    fn sample(&self, draws: usize, random: &mut Stream) -> Result<Sample<1>, SampleError> {
        let half = self.0.sample(draws.div_ceil(2), random)?;
        let both = half.points().iter().flat_map(|&[x]| [[x], [-x]]);
        Sample::equal(both.take(draws).collect(), half.domain().clone())
    }
}

/// Every point is right, but they are not independent.
pub const ANTITHETIC: Fault = Fault {
    name: "antithetic",
    summary: "the points of a sample come in pairs x and -x: each right, not independent",
    caught_by: "replicates",
    plant: |subjects| subjects.source = Arc::new(Antithetic(subjects.source.clone())),
};
