//! The figure of kernel efficiencies.

use super::Material;
use super::pictures::chosen;
use crate::experiment::judge::short;
use crate::experiment::results::Group;
use crate::experiment::{Figure, Measure};
use crate::kernel::{Kernel, Shape};
use crate::report::figure::{Axis, Dot, Dots, Svg};

/// For each kernel estimator: the efficiency that its exact MISE implies beside the asymptotic one, and its bandwidth in three conventions.
pub(super) fn draw(material: &Material<'_>, figure: &Figure, group: &Group) -> Svg {
    let shape = |number: usize| {
        let spec = &material.bench.experiment().estimators[number];
        spec.values.word("shape").and_then(Shape::named)
    };
    let exact = |outcome: &crate::experiment::results::Outcome| {
        outcome.measures.get(&Measure::ExactMise).map(|m| m.value)
    };
    let reference = chosen(figure, group)
        .find(|&(number, _)| shape(number) == Some(Shape::Epanechnikov))
        .and_then(|(_, outcome)| exact(outcome));
    let rows = chosen(figure, group).filter_map(|(number, outcome)| {
        let (kernel, mise) = (shape(number)?, exact(outcome)?);
        let h = outcome.replicates.first().and_then(|r| r.smoothing)?;
        let efficiency = reference.map(|reference| (mise / reference).powf(-1.25));
        Some(Dot {
            name: outcome.name.clone(),
            exact: Some(kernel.efficiency()),
            measured: efficiency.map(|e| (e, e, e)),
            cells: vec![
                short(h),
                short(h * kernel.variance().sqrt()),
                short(h / kernel.canonical_scale()),
                format!("{mise:.4e}"),
            ],
        })
    });
    Dots {
        title: String::new(),
        description: figure.caption.clone(),
        axis: Axis::new("efficiency", ""),
        interval: String::new(),
        headings: ["h", "h √k₂", "h / δ₀", "MISE"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
    .draw()
}
