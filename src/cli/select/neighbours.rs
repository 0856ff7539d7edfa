//! `lab select --neighbours`

use super::super::notes::Notes;
use super::super::output::Output;
use super::super::stop::Stop;
use super::Select;
use super::profile::{Panel, Profile};
use super::row::{noted, told};
use crate::experiment::significant;
use crate::neighbour::Searchable;
use crate::sample::Sample;
use crate::selector::{NeighbourRule, Neighbours};
use serde::Serialize;
use std::time::Instant;

/// What one rule says. Without a number the note says why.
#[derive(Serialize)]
struct Row {
    selector: &'static str,
    k: Option<usize>,
    milliseconds: f64,
    note: String,
}

pub(super) fn run<const D: usize>(select: &Select, notes: Notes) -> Result<(), Stop>
where
    Sample<D>: Searchable<D>,
{
    let chosen = select.chosen(&NeighbourRule::NAMES, |name| {
        let rule = NeighbourRule::named(name)?;
        let place = NeighbourRule::ALL.iter().position(|other| *other == rule)?;
        Some((NeighbourRule::NAMES[place], rule))
    })?;
    let picture = select.picture()?;
    let mut output = Output::open(None)?;
    let sample = select.read::<D>()?;
    let chooser = Neighbours::new(&sample);
    let rows: Vec<Row> = chosen
        .iter()
        .map(|(name, rule)| {
            let start = Instant::now();
            let found = chooser.choose(*rule);
            Row {
                selector: name,
                k: found.as_ref().ok().map(|chosen| chosen.k),
                milliseconds: start.elapsed().as_secs_f64() * 1e3,
                note: match found {
                    Ok(chosen) => told(&chosen.warnings),
                    Err(error) => error.to_string(),
                },
            }
        })
        .collect();
    if rows.iter().all(|row| row.k.is_none()) {
        return Err(Stop::Input(rows[0].note.clone()));
    }
    if select.json {
        output.json(&rows)?;
    } else {
        output.write_all(b"selector,k,milliseconds,note\n")?;
        for row in &rows {
            let k = row.k.map_or_else(String::new, |k| k.to_string());
            let time = significant(row.milliseconds, 3);
            write!(output, "{},{k},{time}", row.selector)?;
            noted(&mut output, &row.note)?;
        }
    }
    output.finish()?;
    let Some(mut picture) = picture else {
        return Ok(());
    };
    let most = sample.len().saturating_sub(2) as f64;
    let panel = |((name, rule), row): (&(&'static str, NeighbourRule), &Row)| {
        let k = row.k?;
        let (rule, chooser) = (*rule, &chooser);
        Some(Panel {
            title: (*name).to_owned(),
            // whole numbers that there are
            criterion: Box::new(move |k: f64| {
                if k.round() < 2.0 || k.round() > most {
                    return f64::NAN;
                }
                chooser.criterion(rule, k.round() as usize)
            }),
            own: Some(k as f64),
        })
    };
    let panels: Vec<Panel<'_>> = chosen.iter().zip(&rows).filter_map(panel).collect();
    if panels.is_empty() {
        notes.say("there is no criterion to draw");
    }
    let drawing = Profile {
        title: format!("Criteria for k, nearest neighbours of {} points", sample.len()),
        description: "What each rule makes least, over the number of neighbours; upright lines mark the numbers chosen.".to_owned(),
        axis: "k, number of neighbours",
        places: 60,
        widths: rows.iter().filter_map(|row| row.k).map(|k| k as f64).collect(),
        others: Vec::new(),
        panels,
    }
    .draw();
    picture.write_all(drawing.as_bytes())?;
    picture.finish()
}
