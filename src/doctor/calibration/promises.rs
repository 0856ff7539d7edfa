//! What the laboratory states with a probability.

use super::{LEVELS, Meaning, Promise};
use crate::accuracy::chance::{equally_likely, kolmogorov_smirnov};
use crate::accuracy::{lower_bound, median_interval, share_interval};
use crate::doctor::subjects::H;
use crate::doctor::{Evidence, Subjects};
use crate::kernel::Shape;
use crate::numeric::special::normal_quantile;
use crate::random::Stream;
use crate::space::{Field, Targets};
use crate::theory::{KernelError, kernel_moments};
use crate::uncertainty::{ErrorEstimate, Halves, Split};
use rand::RngExt;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Every promise; to add one, add a line.
pub const PROMISES: &[Promise] = &[
    Promise {
        name: "mean of 20 values: interval",
        meaning: Meaning::AsStated,
        kept: normal_mean,
    },
    Promise {
        name: "MISE, 200 samples: interval",
        meaning: Meaning::AsStated,
        kept: simulated_mise,
    },
    Promise {
        name: "bootstrap-t bound, 60 values",
        meaning: Meaning::AsStated,
        kept: bootstrap,
    },
    Promise {
        name: "median of 101: at least",
        meaning: Meaning::AtLeast,
        kept: median,
    },
    Promise {
        name: "share of 60: at least",
        meaning: Meaning::AtLeast,
        kept: share,
    },
    Promise {
        name: "E f̂, 20 batches: interval",
        meaning: Meaning::AsStated,
        kept: |subjects, seed| batches(subjects, seed, false),
    },
    Promise {
        name: "f, 20 batches: not claimed",
        meaning: Meaning::NotClaimed,
        kept: |subjects, seed| batches(subjects, seed, true),
    },
    Promise {
        name: "Kolmogorov-Smirnov, n = 400",
        meaning: Meaning::AsStated,
        kept: kolmogorov,
    },
    Promise {
        name: "χ² test, 10 cells of 100",
        meaning: Meaning::AsStated,
        kept: pearson,
    },
    Promise {
        name: "z test of a mean, n = 400",
        meaning: Meaning::AsStated,
        kept: z_test,
    },
    Promise {
        name: "z test of variance, n = 2000",
        meaning: Meaning::AsStated,
        kept: variance_test,
    },
];

fn normal(random: &mut Stream) -> f64 {
    normal_quantile(crate::random::open_unit(random))
}

fn at_each(kept: impl Fn(f64) -> bool) -> [bool; LEVELS.len()] {
    LEVELS.map(kept)
}

fn normal_mean(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let mut random = subjects.stream(seed, "calibration/mean", 0);
    let values: Vec<f64> = (0..20).map(|_| normal(&mut random)).collect();
    at_each(|confidence| {
        let interval = (subjects.interval)(&values, confidence);
        interval.low <= 0.0 && 0.0 <= interval.high
    })
}

fn simulated_mise(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    const DRAWS: usize = 40;
    // where a kernel estimate of these is evaluated: the midpoint sum of something so smooth is its integral
    let grid = crate::space::Grid::new([-5.0], [5.0], [50]).expect("a legal grid");
    let truth = subjects.density.on(&grid);
    let errors: Vec<f64> = (0..200)
        .map(|number| {
            let sample = subjects.sample(seed, "calibration/mise", number, DRAWS);
            let estimate = subjects.kde.fit(&sample).map(|e| e.on(&grid));
            estimate.map_or(f64::NAN, |estimate| {
                let pairs = estimate.values().iter().zip(truth.values());
                pairs.map(|(e, f)| (e - f).powi(2)).sum::<f64>() * grid.cell_measure()
            })
        })
        .collect();
    let exact = KernelError::new(&*subjects.density, Shape::Gaussian).at(H, DRAWS as f64);
    at_each(|confidence| {
        let interval = (subjects.interval)(&errors, confidence);
        interval.low <= exact.mise() && exact.mise() <= interval.high
    })
}

fn bootstrap(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let mut random = subjects.stream(seed, "calibration/bootstrap", 0);
    // exponential: mean 1, skewed as squared errors are
    let values: Vec<f64> = (0..60)
        .map(|_| -crate::random::open_unit(&mut random).ln())
        .collect();
    at_each(|confidence| {
        let mut resampling = subjects.stream(seed, "calibration/resampling", 0);
        lower_bound(&values, confidence, &mut resampling).is_some_and(|bound| bound <= 1.0)
    })
}

fn median(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let mut random = subjects.stream(seed, "calibration/median", 0);
    let mut values: Vec<f64> = (0..101).map(|_| random.random::<f64>()).collect();
    values.sort_by(f64::total_cmp);
    at_each(|confidence| {
        let interval = median_interval(&values, confidence);
        interval.is_none_or(|it| it.low <= 0.5 && 0.5 <= it.high)
    })
}

fn share(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let mut random = subjects.stream(seed, "calibration/share", 0);
    let hits = (0..60).filter(|_| random.random::<f64>() < 0.2).count();
    at_each(|confidence| {
        let interval = share_interval(hits, 60, confidence);
        interval.low <= 0.2 && 0.2 <= interval.high
    })
}

/// f̂ ± t ê at a mode, covering E f̂ or f.
fn batches(subjects: &Subjects, seed: u64, of_truth: bool) -> [bool; LEVELS.len()] {
    const DRAWS: usize = 500;
    const PLACE: [f64; 1] = [-1.0];
    let sample = subjects.sample(seed, "calibration/batches", 0, DRAWS);
    let halves = Halves {
        batches: 20,
        split: Split::Path,
    };
    let squared = halves.squared(&*subjects.kde, &sample, Targets::Points(&[PLACE]));
    let error = squared.map_or(f64::NAN, |squared| squared[0].sqrt());
    let estimate = subjects.kde.fit(&sample).map_or(f64::NAN, |e| e.at(PLACE));
    let target = if of_truth {
        subjects.density.at(PLACE)
    } else {
        let moments = |h| kernel_moments(&*subjects.density, Shape::Gaussian, h, 1.0, PLACE[0]);
        moments(H).mean
    };
    let student = StudentsT::new(0.0, 1.0, 19.0).expect("legal");
    at_each(|confidence| {
        let reach = student.inverse_cdf(0.5 + 0.5 * confidence) * error;
        (estimate - target).abs() <= reach
    })
}

fn kolmogorov(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let sample = subjects.sample(seed, "calibration/kolmogorov", 0, 400);
    let probabilities = sample.coordinates().iter();
    let p = kolmogorov_smirnov(
        probabilities
            .map(|x| subjects.density.distribution(*x))
            .collect(),
    );
    at_each(|confidence| p > 1.0 - confidence)
}

fn pearson(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let mut random = subjects.stream(seed, "calibration/pearson", 0);
    let mut counts = [0u64; 10];
    for _ in 0..1000 {
        counts[random.random_range(0..10)] += 1;
    }
    let p = equally_likely(&counts);
    at_each(|confidence| p > 1.0 - confidence)
}

fn z_test(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let sample = subjects.sample(seed, "calibration/z", 0, 400);
    let mut evidence = Evidence::default();
    let (mean, _) = subjects.density.mean_and_deviation();
    evidence.mean("mean", sample.coordinates(), mean);
    let p = evidence.finding().p_value;
    at_each(|confidence| p > 1.0 - confidence)
}

fn variance_test(subjects: &Subjects, seed: u64) -> [bool; LEVELS.len()] {
    let sample = subjects.sample(seed, "calibration/variance", 0, 2000);
    let mut evidence = Evidence::default();
    let (_, deviation) = subjects.density.mean_and_deviation();
    evidence.variance("variance", sample.coordinates(), deviation * deviation);
    let p = evidence.finding().p_value;
    at_each(|confidence| p > 1.0 - confidence)
}
