//! A finished run on paper: its tables, figures, report page and manifest, written into the run's folder.
//!
//! Figures and page are drawn from results alone; nothing is simulated here. The only estimates computed are those of the first
//! sample, which is drawn again from its own random stream.

mod efficiency;
mod errors;
mod fine;
mod page;
mod pictures;
mod sweep;
mod tables;

pub use fine::Fine;

use crate::experiment::judge::Verdict;
use crate::experiment::manifest::{self, Circumstances};
use crate::experiment::results::Results;
use crate::experiment::run::{Bench, RunError, RunFolder};
use crate::experiment::table;
use crate::storage::write_atomically;

/// Everything that the paper is written from.
pub struct Material<'a> {
    /// The experiment, set up.
    pub bench: &'a Bench,
    /// What it found.
    pub results: &'a Results,
    /// How its claims came out.
    pub verdicts: &'a [Verdict],
    /// How it was carried out.
    pub circumstances: &'a Circumstances,
}

/// Writes `tables/*.csv`, `figures/*.svg`, `report.html` and, last, `manifest.json` into `folder`.
///
/// # Errors
/// If a file cannot be written, or the first sample cannot be drawn again.
pub fn write(material: &Material<'_>, folder: &RunFolder) -> Result<(), RunError> {
    let Material {
        bench,
        results,
        verdicts,
        circumstances,
    } = material;
    let fine = Fine::of(bench, results)?;
    let first: Vec<&[Vec<f64>]> = fine
        .groups
        .iter()
        .map(|first| first.coarse.as_slice())
        .collect();
    let tables = folder.fresh("tables")?;
    for table in [
        table::summary(results),
        table::replicates(results),
        table::pairs(results),
        table::curves(results, &first),
        table::claims(bench.experiment(), verdicts),
    ] {
        if !table.rows.is_empty() {
            table.write(&tables)?;
        }
    }
    let figures = folder.fresh("figures")?;
    let drawn = pictures::draw(material, &fine);
    for (number, picture) in drawn.iter().enumerate() {
        let path = figures.join(format!("{:02}-{}.svg", number + 1, picture.slug));
        write_atomically(&path, picture.svg.as_str().as_bytes())?;
    }
    let page = page::compose(material, &fine, drawn);
    write_atomically(&folder.path().join("report.html"), page.as_bytes())?;
    manifest::write(
        folder.path(),
        bench.experiment(),
        results,
        verdicts,
        circumstances,
    )?;
    Ok(())
}
