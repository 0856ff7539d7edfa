//! A finished run on paper: its tables, figures, report page and manifest, written into the run's folder.
//!
//! Figures and page are drawn from results, and no replicate is simulated here. The estimates computed are those of the first sample, which is
//! drawn again from its own random stream; where a scene is seen through its camera, from all of that sample's walk, beside a picture by paths.

mod camera;
mod comparison;
mod convergence;
mod coverage;
mod efficiency;
mod errors;
mod fine;
mod local;
mod page;
mod pictures;
mod plane;
mod regions;
mod room;
mod section;
mod spread;
mod sweep;
mod tables;
mod uncertain;
mod unfold;
mod verdict;

pub use fine::Fine;

use crate::experiment::judge::Verdict;
use crate::experiment::manifest::{self, Circumstances};
use crate::experiment::results::{Group, Results};
use crate::experiment::run::{Bench, RunError, RunFolder};
use crate::experiment::table;
use crate::kernel::{Bandwidth, Shape};
use crate::report::page::Slider;
use crate::selector::{NormalReference, Scott, Selector, Silverman};
use crate::storage::write_atomically;
use comparison::Comparison;

/// Everything that the paper is written from.
pub struct Material<'a, const D: usize = 1> {
    /// The experiment, set up.
    pub bench: &'a Bench<D>,
    /// What it found.
    pub results: &'a Results<D>,
    /// How its claims came out.
    pub verdicts: &'a [Verdict],
    /// How it was carried out.
    pub circumstances: &'a Circumstances,
}

/// What is drawn differently on a line and in the plane.
pub struct Paper;

/// The drawings of experiments in `D` dimensions.
pub trait Draws<const D: usize> {
    /// Everything that shows estimates themselves.
    ///
    /// # Errors
    /// If the first sample cannot be drawn again.
    fn illustrate(material: &Material<'_, D>) -> Result<Illustrations, RunError>;

    /// The median bandwidth that a rule of this name chooses over the first samples, where there is such a rule.
    fn typical(
        material: &Material<'_, D>,
        group: &Group<D>,
        rule: &str,
        shape: Shape,
    ) -> Option<f64>;
}

/// What shows estimates themselves.
pub struct Illustrations {
    /// The estimates of the first sample on the grid, by group and estimator.
    first: Vec<Vec<Vec<f64>>>,
    /// The figures.
    pictures: Vec<pictures::Picture>,
    /// The slider of a swept bandwidth.
    slider: Option<Slider>,
    /// Seconds of each estimate on the grid, by group and estimator, where they were taken.
    costs: Vec<Vec<f64>>,
}

impl Draws<1> for Paper {
    fn illustrate(material: &Material<'_, 1>) -> Result<Illustrations, RunError> {
        let fine = Fine::of(material.bench, material.results)?;
        Ok(Illustrations {
            pictures: pictures::draw(material, &fine),
            slider: page::slider(material, &fine),
            costs: Vec::new(),
            first: fine.groups.into_iter().map(|first| first.coarse).collect(),
        })
    }

    fn typical(
        material: &Material<'_, 1>,
        group: &Group<1>,
        rule: &str,
        shape: Shape,
    ) -> Option<f64> {
        const SAMPLES: usize = 25;
        let selector: &dyn Selector<1> = match rule {
            "silverman" => &Silverman,
            "normal-reference" => &NormalReference,
            "scott" => &Scott,
            _ => return None,
        };
        let replicates = material.bench.experiment().replicates.min(SAMPLES);
        let mut chosen: Vec<f64> = (0..replicates)
            .filter_map(|replicate| {
                let sample = material
                    .bench
                    .sample(group.source, group.size, replicate)
                    .ok()?;
                match selector.select(&sample, shape).ok()?.bandwidth {
                    Bandwidth::Fixed([h]) => Some(h),
                    _ => None,
                }
            })
            .collect();
        chosen.sort_by(f64::total_cmp);
        chosen.get(chosen.len() / 2).copied()
    }
}

/// Writes `tables/*.csv`, `figures/*.svg`, `report.html` and, last, `manifest.json` into `folder`.
///
/// # Errors
/// If a file cannot be written, or the first sample cannot be drawn again.
pub fn write<const D: usize>(material: &Material<'_, D>, folder: &RunFolder) -> Result<(), RunError>
where
    Paper: Draws<D>,
{
    let Material {
        bench,
        results,
        verdicts,
        circumstances,
    } = material;
    let Illustrations {
        first,
        pictures: drawn,
        slider,
        costs,
    } = Paper::illustrate(material)?;
    let first: Vec<&[Vec<f64>]> = first.iter().map(Vec::as_slice).collect();
    let comparison = Comparison::of(material)?;
    let tables = folder.fresh("tables")?;
    for table in [
        table::summary(results),
        table::regions(results),
        table::pairs(results),
        table::curves(results, &first),
        table::coverage(bench.experiment(), results),
        table::claims(bench.experiment(), verdicts),
        table::uncertainties(bench.experiment(), results),
        comparison.timings(),
    ] {
        if !table.rows.is_empty() {
            table.write(&tables)?;
        }
    }
    let replicates = table::replicates(results);
    write_atomically(&tables.join(table::REPLICATES), replicates.as_bytes())?;
    let figures = folder.fresh("figures")?;
    for (number, picture) in drawn.iter().enumerate() {
        let path = figures.join(format!("{:02}-{}.svg", number + 1, picture.slug));
        write_atomically(&path, picture.svg.as_str().as_bytes())?;
    }
    let page = page::compose(material, slider, drawn, &costs, comparison.tables);
    write_atomically(&folder.path().join("report.html"), page.as_bytes())?;
    manifest::write(
        folder.path(),
        bench.asked(),
        results,
        verdicts,
        circumstances,
    )?;
    Ok(())
}
