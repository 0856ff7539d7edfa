//! `section` of a `[[figure]]`.

use super::node::Reader;
use super::problem::Problem;
use super::setting::Setting;
use super::value::Located;
use crate::experiment::FigureKind;

pub(super) fn section(
    reader: &mut Reader,
    located: &Located,
    setting: &Setting<'_>,
) -> Option<FigureKind> {
    let values = &located.values;
    let end = |x, y| Some([values.number(x)?, values.number(y)?]);
    let (from, to) = (end("from-x", "from-y")?, end("to-x", "to-y")?);
    if (0..2).all(|k| from[k] - to[k] == 0.0) {
        reader.report(Problem::at(
            located.place("to-x"),
            "the line ends where it begins",
        ));
        return None;
    }
    let show = values.words("show").to_vec();
    for word in &show {
        setting.demand(
            reader,
            &located.place("show"),
            &format!("`{word}`"),
            word == "truth" || word == "error",
            matches!(word.as_str(), "mean" | "band" | "error"),
        );
    }
    if located.given("show") && show.is_empty() {
        reader.report(
                    Problem::at(located.place("show"), "`show` is an empty list")
                        .allowed("at least one of `truth`, `sample`, `mean`, `band`, `error`, `expected-error`, `size`"),
                );
        return None;
    }
    let densities = |word: &String| matches!(word.as_str(), "truth" | "sample" | "mean" | "band");
    let errors = |word: &String| matches!(word.as_str(), "error" | "expected-error");
    let sorts = [
        show.iter().any(densities),
        show.iter().any(errors),
        show.iter().any(|word| word == "size"),
    ];
    if sorts.iter().filter(|sort| **sort).count() > 1 {
        reader.report(
            Problem::at(
                located.place("show"),
                "densities, errors and sizes do not share an axis",
            )
            .help("write a [[figure]] for each"),
        );
        return None;
    }
    Some(FigureKind::Section {
        from,
        to,
        show,
        panels: values.flag("panels").unwrap_or(false),
    })
}
