//! Pictures beside the one that they are judged by, with what is wrong in each, as a page.

use crate::report::compared::{Compared, Shown, Wrong, compare};
use crate::report::page::{Cell, Figure, Page, Table};

/// What the page says of how it came about.
pub struct Origin {
    /// The scene's title, or its file.
    pub scene: String,
    /// Numbers that matter, as (name, value).
    pub facts: Vec<(String, String)>,
    /// The command.
    pub command: String,
}

/// The page of `pictures`, judged by `truth`.
pub fn page(truth: &Shown, pictures: &[Shown], origin: Origin) -> String {
    let Compared {
        pictures: photographs,
        errors,
        limit,
        wrong,
    } = compare(truth, pictures);
    let rows = pictures.iter().zip(&wrong);
    let rows = rows.map(|(shown, wrong)| row(shown, wrong));
    let table = Table {
        title: "Errors of pictures".to_owned(),
        caption: format!(
            "Luminance less that of the picture by {}, in per cent of its average, over all pixels but lamps; seconds for photons, estimate and light, where that picture took {:.1}.",
            truth.name, truth.seconds
        ),
        columns: ["light from", "root mean square", "mean", "seconds"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    };
    let mut facts = origin.facts;
    facts.insert(
        0,
        (
            "pixels".to_owned(),
            format!("{} × {}", truth.image.width(), truth.image.height()),
        ),
    );
    Page {
        question: format!("How does {} look by each estimator, and what is wrong with it?", origin.scene),
        notes: "All pictures are taken by the same camera and shown through the same tone curve. Photons are traced once, and each estimator makes its picture of the same hits. What all maps show alike is the doing of the picture that they are judged by.".to_owned(),
        facts,
        figures: vec![
            Figure {
                title: "The pictures".to_owned(),
                caption: format!("First the one that all others are judged by, {}, which knows nothing of the photons.", truth.name),
                svg: photographs,
            },
            Figure {
                title: "What is wrong".to_owned(),
                caption: format!(
                    "Luminance less that of the first picture, in per cent of its average: blue is too dark, red too bright, what is beyond ±{limit} % has the last colour; lamps are left out. Beside each name stands the root of the mean square."
                ),
                svg: errors,
            },
        ],
        tables: vec![table],
        command: origin.command,
        versions: vec![("lab".to_owned(), env!("CARGO_PKG_VERSION").to_owned())],
        ..Page::default()
    }
    .render()
}

/// One line of the table of errors.
fn row(shown: &Shown, wrong: &Wrong) -> Vec<Cell> {
    let number = |x: f64| {
        if x.is_finite() {
            Cell::exact(x)
        } else {
            Cell::text("infinite")
        }
    };
    vec![
        Cell::text(shown.name.clone()),
        number(wrong.root_mean_square),
        number(wrong.mean),
        Cell::exact(shown.seconds),
    ]
}
