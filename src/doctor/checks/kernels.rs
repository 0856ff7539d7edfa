//! Kernels and sums of them.

use super::{Check, Evidence, Finding, Subjects, sample, uniform};
use crate::kernel::{Bandwidth, KernelSum, Shape};
use crate::numeric::{GaussLegendre, panels};
use crate::space::{Domain, Field, Grid, Targets};

/// A kernel's constants.
pub const CONSTANTS: Check = Check {
    name: "kernel-constants",
    states: "mass, k₂, R(K) and partial moments are the integrals they claim to be",
    run: constants,
};

fn constants(subjects: &Subjects, _seed: u64) -> Finding {
    let kernel = &subjects.kernel;
    let rule = GaussLegendre::new(24);
    let integral = |f: &dyn Fn(f64) -> f64, high: f64| {
        rule.integrate_panels(f, &panels(-12.0, high, [-1.0, 0.0, 1.0], 0.5))
    };
    let mass = integral(&|u| kernel.value(u), 12.0);
    let variance = integral(&|u| u * u * kernel.value(u), 12.0);
    let roughness = integral(&|u| kernel.value(u).powi(2), 12.0);
    let mut evidence = Evidence::default();
    evidence.exact("mass", [(mass, 1.0)], 1.0, 1e-10);
    evidence.exact("k₂", [(kernel.variance(), variance)], variance, 1e-10);
    evidence.exact("R(K)", [(kernel.roughness(), roughness)], roughness, 1e-10);
    let partial = (0..3).flat_map(|order| [-0.7, 0.0, 0.4, 2.0].map(|below| (order, below)));
    let pairs = partial.map(|(order, below)| {
        let moment = integral(&|u| u.powi(order) * kernel.value(u), below);
        (kernel.partial_moment(order as u32, below), moment)
    });
    evidence.exact("partial moments", pairs, 1.0, 1e-10);
    evidence.finding()
}

/// An engine against the definition on a line.
pub const SUM: Check = Check {
    name: "kernel-sum",
    states: "an engine gives the sum that the definition gives",
    run: sum,
};

fn sum(subjects: &Subjects, seed: u64) -> Finding {
    let points = subjects.sample(seed, "doctor/kernel-sum", 0, 200);
    let sum =
        KernelSum::new(points, Shape::Gaussian, Bandwidth::Fixed([0.25])).expect("a legal width");
    let grid = Grid::new([-4.0], [4.0], [60]).expect("a legal grid");
    let ceiling = sum.ceiling().unwrap_or(1.0);
    let prepared = subjects.engine.prepare(sum.clone(), 1e-12);
    let found = prepared
        .expect("the engine can")
        .evaluate(Targets::Grid(&grid));
    let mut evidence = Evidence::default();
    let pairs = found.values.iter().zip(grid.centres());
    let pairs = pairs.map(|(found, x)| (*found, sum.at(x)));
    evidence.exact("f̂", pairs, ceiling, 1e-11);
    evidence.finding()
}

/// The same in the plane for a radial kernel, which must have unit mass there.
pub const PLANE_SUM: Check = Check {
    name: "plane-kernel-sum",
    states: "in the plane too, for radial kernels of unit mass",
    run: plane_sum,
};

fn plane_sum(subjects: &Subjects, seed: u64) -> Finding {
    let points = sample(
        uniform::<2>(subjects, seed, "doctor/plane-kernel-sum", 0, 100),
        Domain::whole(),
    );
    let sum = KernelSum::new(points, Shape::Epanechnikov, Bandwidth::Fixed([0.2, 0.2]))
        .expect("a legal width")
        .radial();
    let grid = Grid::new([-0.25; 2], [1.25; 2], [75, 75]).expect("a legal grid");
    let prepared = subjects.plane_engine.prepare(sum.clone(), 1e-12);
    let found = prepared
        .expect("the engine can")
        .evaluate(Targets::Grid(&grid));
    let mut evidence = Evidence::default();
    // every eleventh cell: the definition is slow
    let some = found.values.iter().zip(grid.centres()).step_by(11);
    let ceiling = sum.ceiling().unwrap_or(1.0);
    evidence.exact("f̂", some.map(|(f, x)| (*f, sum.at(x))), ceiling, 1e-11);
    let mass = found.values.iter().sum::<f64>() * grid.cell_measure();
    evidence.exact("mass", [(mass, 1.0)], 1.0, 2e-3);
    evidence.finding()
}
