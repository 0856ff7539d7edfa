//! Estimates against their exact means, variances and errors.

use super::{Check, Evidence, Finding, Subjects, sample};
use crate::density::named_in_plane;
use crate::doctor::subjects::{H, WIDTH};
use crate::estimator::Estimator;
use crate::kernel::Shape;
use crate::numeric::Sum;
use crate::sample::{Sample, Weights};
use crate::space::{Domain, Field, Grid, Point, Targets};
use crate::theory::{HistogramError, KernelError};

const PLACES: [Point<1>; 4] = [[-1.0], [0.0], [0.7], [2.0]];

/// f̂ at places, for one sample.
fn at<const D: usize>(
    estimator: &dyn Estimator<D>,
    sample: &Sample<D>,
    places: &[Point<D>],
) -> Vec<f64> {
    match estimator.fit(sample) {
        Ok(estimate) => estimate.evaluate(Targets::Points(places)).values,
        Err(_) => vec![f64::NAN; places.len()],
    }
}

/// E f̂ by simulation and by theory.
pub const MEAN: Check = Check {
    name: "estimate-mean",
    states: "the mean of a kernel estimate is the smoothed density",
    run: mean,
};

fn mean(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 1_000_000;
    let sample = subjects.sample(seed, "doctor/estimate-mean", 0, DRAWS);
    let found = at(&*subjects.kde, &sample, &PLACES);
    let theory = subjects.kde.expectation(&*subjects.density, DRAWS, &PLACES);
    let mut evidence = Evidence::default();
    for ((x, found), theory) in PLACES.iter().zip(found).zip(theory.unwrap_or_default()) {
        let name = format!("E f̂({})", x[0]);
        evidence.value(&name, found, theory.variance.sqrt(), theory.mean);
    }
    evidence.finding()
}

/// The same in the plane.
pub const PLANE_MEAN: Check = Check {
    name: "plane-estimate-mean",
    states: "the same in the plane",
    run: plane_mean,
};

fn plane_mean(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 100_000;
    const PLACES: [Point<2>; 3] = [[0.0, 0.0], [1.0, -0.5], [0.5, 1.2]];
    let density = named_in_plane("normal-2d").expect("it is in the catalogue");
    let mut random = subjects.stream(seed, "doctor/plane-estimate-mean", 0);
    let points = (0..DRAWS).map(|_| density.draw(&mut random)).collect();
    let found = at(
        &*subjects.plane_kde,
        &sample(points, Domain::whole()),
        &PLACES,
    );
    let theory = subjects.plane_kde.expectation(&*density, DRAWS, &PLACES);
    let mut evidence = Evidence::default();
    for ((x, found), theory) in PLACES.iter().zip(found).zip(theory.unwrap_or_default()) {
        let name = format!("E f̂({}, {})", x[0], x[1]);
        evidence.value(&name, found, theory.variance.sqrt(), theory.mean);
    }
    evidence.finding()
}

/// var f̂ by simulation and by theory.
pub const VARIANCE: Check = Check {
    name: "estimate-variance",
    states: "its variance is ((K_h)² ∗ f - (K_h ∗ f)²)/n",
    run: variance,
};

fn variance(subjects: &Subjects, seed: u64) -> Finding {
    const SAMPLES: usize = 4000;
    const DRAWS: usize = 50;
    let mut found: [Vec<f64>; PLACES.len()] = Default::default();
    for number in 0..SAMPLES {
        let sample = subjects.sample(seed, "doctor/estimate-variance", number, DRAWS);
        let values = at(&*subjects.kde, &sample, &PLACES);
        found
            .iter_mut()
            .zip(values)
            .for_each(|(all, v)| all.push(v));
    }
    let theory = subjects.kde.expectation(&*subjects.density, DRAWS, &PLACES);
    let mut evidence = Evidence::default();
    for ((x, found), theory) in PLACES.iter().zip(found).zip(theory.unwrap_or_default()) {
        evidence.variance(&format!("var f̂({})", x[0]), &found, theory.variance);
    }
    evidence.finding()
}

/// ISE on a grid of each of several samples.
fn squared_errors(
    subjects: &Subjects,
    estimator: &dyn Estimator<1>,
    (seed, purpose): (u64, &str),
    (samples, draws): (usize, usize),
    grid: &Grid<1>,
) -> Vec<f64> {
    let truth = subjects.density.on(grid);
    (0..samples)
        .map(|number| {
            let sample = subjects.sample(seed, purpose, number, draws);
            let Ok(estimate) = estimator.fit(&sample) else {
                return f64::NAN;
            };
            let values = estimate.evaluate(Targets::Grid(grid)).values;
            let squares = values
                .iter()
                .zip(truth.values())
                .map(|(e, f)| (e - f).powi(2));
            squares.collect::<Sum>().value() * grid.cell_measure()
        })
        .collect()
}

/// MISE by simulation and by theory.
pub const MISE: Check = Check {
    name: "mise",
    states: "the mean integrated squared error is the exact one",
    run: mise,
};

fn mise(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 100;
    let grid = Grid::new([-5.0], [5.0], [100]).expect("a legal grid");
    let where_from = (seed, "doctor/mise");
    let errors = squared_errors(subjects, &*subjects.kde, where_from, (1500, DRAWS), &grid);
    let exact = KernelError::new(&*subjects.density, Shape::Gaussian).at(H, DRAWS as f64);
    let mut evidence = Evidence::default();
    evidence.mean("MISE", &errors, exact.mise());
    evidence.finding()
}

/// A weight counts as often as it says.
pub const WEIGHTS: Check = Check {
    name: "weights",
    states: "a point of weight three counts as three points",
    run: weights,
};

fn weights(subjects: &Subjects, seed: u64) -> Finding {
    let drawn = subjects.sample(seed, "doctor/weights", 0, 300);
    let often = |i: usize| 1 + i % 3;
    let weights = (0..300).map(|i| often(i) as f64).collect();
    let weighted = Sample::normalised(drawn.points().to_vec(), weights, Domain::whole());
    let repeated: Vec<Point<1>> = (0..300)
        .flat_map(|i| std::iter::repeat_n(drawn.points()[i], often(i)))
        .collect();
    let of_weights = weighted.map(|sample| at(&*subjects.kde, &sample, &PLACES));
    let of_points = at(&*subjects.kde, &sample(repeated, Domain::whole()), &PLACES);
    let mut evidence = Evidence::default();
    let pairs = of_weights.unwrap_or_default().into_iter().zip(of_points);
    evidence.exact("f̂", pairs, 0.3, 1e-9);
    evidence.finding()
}

/// The mass is that of the sample, whatever it is.
pub const FLUX: Check = Check {
    name: "flux",
    states: "an estimate from hits of weight Φ/N, N paths, has the flux that was hit",
    run: flux,
};

fn flux(subjects: &Subjects, seed: u64) -> Finding {
    // of 1000 paths that carry 60 watts 400 arrive
    const PATHS: f64 = 1000.0;
    const FLUX: f64 = 60.0;
    let drawn = subjects.sample(seed, "doctor/flux", 0, 400);
    let weights = Weights::Equal(FLUX / PATHS);
    let hits = Sample::new(drawn.points().to_vec(), weights, Domain::whole());
    let grid = Grid::new([-9.0], [9.0], [360]).expect("a legal grid");
    let integral = hits.ok().and_then(|hits| {
        let estimate = subjects.kde.fit(&hits).ok()?;
        Some(estimate.on(&grid).integral())
    });
    let mut evidence = Evidence::default();
    let pair = (integral.unwrap_or(f64::NAN), FLUX * 400.0 / PATHS);
    evidence.exact("flux", [pair], 24.0, 1e-9);
    evidence.finding()
}

/// A histogram is counting.
pub const BINS: Check = Check {
    name: "histogram-counts",
    states: "a histogram is the count in each bin over n times the width",
    run: bins,
};

fn bins(subjects: &Subjects, seed: u64) -> Finding {
    let sample = subjects.sample(seed, "doctor/histogram-counts", 0, 2000);
    let estimate = subjects.histogram.fit(&sample).ok();
    let mut evidence = Evidence::default();
    let pairs = (0..16).map(|bin| {
        let (low, centre) = (
            -4.0 + WIDTH * f64::from(bin),
            -4.0 + WIDTH * (f64::from(bin) + 0.5),
        );
        let inside = |x: &&f64| low <= **x && **x < low + WIDTH;
        let count = sample.coordinates().iter().filter(inside).count();
        let found = estimate.as_ref().map_or(f64::NAN, |e| e.at([centre]));
        (found, count as f64 / (2000.0 * WIDTH))
    });
    evidence.exact("f̂", pairs, 0.3, 1e-12);
    evidence.finding()
}

/// Its error is that of multinomial counts.
pub const BINS_MISE: Check = Check {
    name: "histogram-mise",
    states: "its mean integrated squared error is R(f) - Σp²/w + (1 - Σp²)/(n w)",
    run: bins_mise,
};

fn bins_mise(subjects: &Subjects, seed: u64) -> Finding {
    const DRAWS: usize = 200;
    let grid = Grid::new([-6.0], [6.0], [480]).expect("a legal grid");
    let from = (seed, "doctor/histogram-mise");
    let errors = squared_errors(subjects, &*subjects.histogram, from, (1000, DRAWS), &grid);
    let exact = HistogramError::new(&*subjects.density, -4.0).at(WIDTH, DRAWS as f64);
    let mut evidence = Evidence::default();
    evidence.mean("MISE", &errors, exact.mise());
    evidence.finding()
}
