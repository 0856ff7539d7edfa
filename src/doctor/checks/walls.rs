//! Walls, corners, and where there is none because the domain wraps round.

use super::{Check, Evidence, Finding, Subjects, round, sample, uniform};
use crate::boundary::{Boundary, Ignore};
use crate::density::{Density, Direction, Ramp};
use crate::kernel::{Bandwidth, KernelSum, Shape};
use crate::sample::Sample;
use crate::space::{Domain, Field, Point};

/// f̂ at places with a wall treated by `boundary`, an Epanechnikov kernel of width `h`.
fn treated<const D: usize>(
    boundary: &dyn Boundary<D>,
    sample: &Sample<D>,
    h: f64,
    places: &[Point<D>],
) -> Vec<f64> {
    let sum = KernelSum::new(
        sample.clone(),
        Shape::Epanechnikov,
        Bandwidth::Fixed([h; D]),
    );
    let field = boundary.correct(sum.expect("a legal width"), &|sum| Box::new(sum));
    match field {
        Ok(field) => places.iter().map(|x| field.at(*x)).collect(),
        Err(_) => vec![f64::NAN; places.len()],
    }
}

/// Repeats `values` over samples and compares means.
fn compare<const D: usize>(
    name: &[&str],
    expected: &[f64],
    values: impl Fn(usize) -> Vec<f64>,
) -> Evidence {
    const SAMPLES: usize = 60;
    let all: Vec<Vec<f64>> = (0..SAMPLES).map(values).collect();
    let mut evidence = Evidence::default();
    for (place, (name, expected)) in name.iter().zip(expected).enumerate() {
        let of_place: Vec<f64> = all.iter().map(|values| values[place]).collect();
        evidence.mean(name, &of_place, *expected);
    }
    evidence
}

const DRAWS: usize = 3000;

/// Half of the mass is lost at a wall, three quarters in a corner.
pub const UNTREATED: Check = Check {
    name: "wall-factors",
    states: "without treatment a flat density comes out as 1/2 at a wall and 1/4 in a corner",
    run: untreated,
};

fn untreated(subjects: &Subjects, seed: u64) -> Finding {
    // 27/32 at half a bandwidth from the wall
    let name = ["at the wall", "at h/2", "in the corner", "inside"];
    compare::<1>(&name, &[0.5, 27.0 / 32.0, 0.25, 1.0], |number| {
        let points = uniform::<1>(subjects, seed, "doctor/wall-factors", number, DRAWS);
        let on_line = treated(
            &*subjects.ignore,
            &sample(points, Domain::unit()),
            0.2,
            &[[0.0], [0.1], [0.5]],
        );
        let points = uniform::<2>(subjects, seed, "doctor/corner-factor", number, DRAWS);
        let plane = sample(points, Domain::unit());
        let corner = treated(&Ignore, &plane, 0.2, &[[0.0, 0.0]]);
        vec![on_line[0], on_line[1], corner[0], on_line[2]]
    })
    .finding()
}

/// Mirrored points bring it back.
pub const MIRROR: Check = Check {
    name: "wall-mirror",
    states: "with mirrored points a flat density comes out flat up to the wall",
    run: mirror,
};

fn mirror(subjects: &Subjects, seed: u64) -> Finding {
    let name = ["at the wall", "at h/4", "at the other wall"];
    compare::<1>(&name, &[1.0; 3], |number| {
        let points = uniform::<1>(subjects, seed, "doctor/wall-mirror", number, DRAWS);
        let sample = sample(points, Domain::unit());
        treated(&*subjects.reflect, &sample, 0.2, &[[0.0], [0.05], [1.0]])
    })
    .finding()
}

/// Also in corners, where the doubly mirrored copy counts.
pub const CORNER: Check = Check {
    name: "corner-mirror",
    states: "and in a corner, which takes the copy that is mirrored twice",
    run: corner,
};

fn corner(subjects: &Subjects, seed: u64) -> Finding {
    let name = ["in the corner", "near it", "at a wall"];
    compare::<2>(&name, &[1.0; 3], |number| {
        let points = uniform::<2>(subjects, seed, "doctor/corner-mirror", number, DRAWS);
        let sample = sample(points, Domain::unit());
        let places = [[0.0, 0.0], [0.05, 0.1], [0.5, 0.0]];
        treated(&*subjects.corner, &sample, 0.25, &places)
    })
    .finding()
}

/// Local linear correction takes slopes too.
pub const SLOPE: Check = Check {
    name: "wall-slope",
    states: "local linear correction reproduces a slope up to the wall",
    run: slope,
};

fn slope(subjects: &Subjects, seed: u64) -> Finding {
    let ramp = Ramp::new(Direction::Down);
    let name = ["at the wall", "at h/4", "at h/2"];
    compare::<1>(&name, &[2.0, 1.8, 1.6], |number| {
        let mut random = subjects.stream(seed, "doctor/wall-slope", number);
        let points = (0..2 * DRAWS).map(|_| ramp.draw(&mut random)).collect();
        let sample = sample(points, Domain::unit());
        treated(&*subjects.linear, &sample, 0.4, &[[0.0], [0.1], [0.2]])
    })
    .finding()
}

/// On a ring there is no wall.
pub const RING: Check = Check {
    name: "ring",
    states: "on a domain that wraps round there is no edge at its seam",
    run: ring,
};

fn ring(subjects: &Subjects, seed: u64) -> Finding {
    let name = ["at the seam", "before it", "opposite"];
    compare::<1>(&name, &[1.0; 3], |number| {
        let points = uniform::<1>(subjects, seed, "doctor/ring", number, DRAWS);
        let estimate = subjects.kde.fit(&sample(points, round())).ok();
        // the bandwidth of the estimator is wide for this ring, which blurs what is flat already
        [[0.0], [0.95], [0.5]]
            .map(|x| estimate.as_ref().map_or(f64::NAN, |e| e.at(x)))
            .to_vec()
    })
    .finding()
}
