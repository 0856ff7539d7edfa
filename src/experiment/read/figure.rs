//! `[[figure]]`.

mod forms;

pub(crate) use forms::FORMS;

use super::camera::camera;
use super::node::{Entry, Reader, Table};
use super::problem::{Problem, Span};
use super::section::section;
use super::setting::Setting;
use super::value::{self, Located};
use crate::experiment::{Figure, FigureKind};
use crate::parameter::{Absent, Kind, Parameter, Values, listed};

/// A kind of figure as files name it.
pub(crate) struct Form {
    pub(crate) name: &'static str,
    pub(crate) summary: &'static str,
    pub(crate) parameters: &'static [Parameter],
    /// Whether it shows something that only a known truth gives.
    truth: bool,
    /// Whether it shows something over replicates.
    replicates: bool,
    /// The number of dimensions that it is for, if not for all.
    only: Option<usize>,
    title: &'static str,
}

/// Keys beside the kind.
pub(crate) const COMMON: &[Parameter] = &[
    Parameter::optional(
        "title",
        Kind::Text,
        Absent::Unset,
        "the title; made from the kind by default",
    ),
    Parameter::optional(
        "caption",
        Kind::Text,
        Absent::Unset,
        "what the reader should see in it",
    ),
    Parameter::optional(
        "estimators",
        Kind::Texts,
        Absent::Unset,
        "the estimators shown, a sweep standing for all of its members; all by default",
    ),
    Parameter::optional(
        "draws",
        Kind::Count {
            least: 1,
            most: super::DRAWS,
        },
        Absent::Unset,
        "the sample size shown, one of the experiment's; its first by default",
    ),
    Parameter::optional(
        "region",
        Kind::Text,
        Absent::Unset,
        "the region that errors are of; the whole grid by default",
    ),
];

/// Reads one `[[figure]]`.
pub(super) fn figure(
    reader: &mut Reader,
    mut table: Table<'_>,
    setting: &Setting<'_>,
) -> Option<Figure> {
    let span = table.span.clone();
    let title = table.take("title");
    let title = title.map(|entry| reader.name(entry.item, "the title of a figure"));
    let caption = table.take("caption");
    let caption = caption.map(|entry| reader.text(entry.item, "`caption`").map(str::to_owned));
    let shown = table.take("estimators");
    let estimators = shown.and_then(|entry| {
        let texts = value::texts(reader, entry.item, "`estimators`")?;
        let mut all = Vec::new();
        for (name, span) in texts {
            for member in setting.names.many(reader, &name, &span) {
                if !all.contains(&member) {
                    all.push(member);
                }
            }
        }
        Some(all)
    });
    let draws = table.take("draws");
    let draws = draws.and_then(|entry| setting.draws(reader, entry.item));
    let region = table.take("region");
    let region = region.map(|entry| setting.region(reader, entry.item));
    let (form, entry) = kind(reader, table, &span)?;
    setting.demand(
        reader,
        &entry.key_span(),
        &format!("the figure `{}`", form.name),
        form.truth,
        form.replicates,
    );
    if let (Some(only), Some(dimensions)) = (form.only, setting.dimensions)
        && only != dimensions
    {
        let place = if only == 1 {
            "on a line"
        } else {
            "in the plane"
        };
        reader.report(
            Problem::at(
                entry.key_span(),
                format!("the figure `{}` is for densities {place}", form.name),
            )
            .allowed(listed(&kinds_in(dimensions))),
        );
        return None;
    }
    let mut settings = reader.table(entry.item, &format!("`{}`", form.name))?;
    settings.span = entry.key_span();
    let located = value::values(
        reader,
        form.parameters,
        settings,
        &format!("`{}`", form.name),
    );
    if !located.complete {
        return None;
    }
    let kind = resolve(reader, form.name, &located, setting)?;
    Some(Figure {
        title: match title {
            Some(title) => title?,
            None => made_title(form, &located.values),
        },
        caption: match caption {
            Some(caption) => caption?,
            None => String::new(),
        },
        estimators: estimators.unwrap_or_default(),
        draws,
        region: match region {
            Some(region) => Some(region?),
            None => None,
        },
        kind,
    })
}

/// The kinds of figure in so many dimensions.
fn kinds_in(dimensions: usize) -> Vec<&'static str> {
    let fits = |form: &&Form| form.only.is_none_or(|only| only == dimensions);
    FORMS.iter().filter(fits).map(|form| form.name).collect()
}

/// The one key that says what the figure is.
fn kind<'d>(
    reader: &mut Reader,
    mut table: Table<'d>,
    span: &Span,
) -> Option<(&'static Form, Entry<'d>)> {
    let mut given: Vec<(&'static Form, Entry<'d>)> = FORMS
        .iter()
        .filter_map(|form| Some((form, table.take(form.name)?)))
        .collect();
    given.sort_by_key(|(_, entry)| entry.key_span().start);
    let kinds: Vec<&str> = FORMS.iter().map(|form| form.name).collect();
    let allowed: Vec<&str> = COMMON
        .iter()
        .map(|parameter| parameter.name)
        .chain(kinds.iter().copied())
        .collect();
    let unknown = table.finish_with(reader, &allowed, |key| {
        let owner = FORMS
            .iter()
            .find(|form| form.parameters.iter().any(|p| p.name == key))?;
        Some(format!(
            "it belongs to the kind of figure: {} = {{ {key} = .. }}",
            owner.name
        ))
    });
    match given[..] {
        [one] => Some(one),
        [] => {
            if !unknown {
                reader.report(
                    Problem::at(span.clone(), "this figure has no kind")
                        .allowed(listed(&kinds))
                        .help("for instance: curves = { show = [\"truth\", \"sample\"] }")
                        .doubtful(),
                );
            }
            None
        }
        [(first, _), (_, second), ..] => {
            reader.report(
                Problem::at(
                    second.key_span(),
                    format!("this figure shows `{}` already", first.name),
                )
                .help(format!("give `{}` a [[figure]] of its own", second.key())),
            );
            None
        }
    }
}

/// What an unfolded figure shows.
fn shown_unfolded(reader: &mut Reader, located: &Located) -> Option<Vec<String>> {
    let mut show = located.values.words("show").to_vec();
    if !located.given("show") {
        show = vec!["truth".to_owned(), "sample".to_owned()];
    }
    let alone = show.len() == 1 || !show.iter().any(|word| word == "points");
    if show.is_empty() || !alone {
        let what = if show.is_empty() {
            "`show` is an empty list"
        } else {
            "dots are ink on paper, the others colours: they do not go on one scale"
        };
        reader.report(Problem::at(located.place("show"), what).allowed(
            "`points` alone, or one or both of `truth` and `sample`; a second figure may show the others",
        ));
        return None;
    }
    Some(show)
}

fn resolve(
    reader: &mut Reader,
    kind: &str,
    located: &Located,
    setting: &Setting<'_>,
) -> Option<FigureKind> {
    let values = &located.values;
    match kind {
        "unfolded" => {
            let show = shown_unfolded(reader, located)?;
            Some(FigureKind::Unfolded { show })
        }
        "curves" => {
            let mut show = values.words("show").to_vec();
            if !located.given("show") {
                if setting.truth != Some(false) {
                    show.push("truth".to_owned());
                }
                show.push("sample".to_owned());
            } else if show.is_empty() {
                reader.report(
                    Problem::at(located.place("show"), "`show` is an empty list")
                        .allowed("at least one of `truth`, `sample`, `mean`, `band`, `rug`"),
                );
                return None;
            }
            if located.given("show") {
                for word in &show {
                    setting.demand(
                        reader,
                        &located.place("show"),
                        &format!("`{word}`"),
                        word == "truth",
                        word == "mean" || word == "band",
                    );
                }
            }
            Some(FigureKind::Curves {
                show,
                panels: values.flag("panels").unwrap_or(false),
            })
        }
        "errors" => Some(FigureKind::Errors {
            measure: values.word("measure")?.to_owned(),
        }),
        "modes" => Some(FigureKind::Modes {}),
        "local-bandwidth" => Some(FigureKind::LocalBandwidth {
            kernel: values.word("kernel")?.to_owned(),
        }),
        "coverage" if !setting.interval => {
            reader.report(
                Problem::at(located.place("coverage"), "the figure `coverage`: the experiment counts no coverage")
                    .help("set `interval` of the experiment to a confidence, for instance interval = 0.95"),
            );
            None
        }
        "coverage" => Some(FigureKind::Coverage {}),
        "convergence" => Some(FigureKind::Convergence {
            measure: values.word("measure")?.to_owned(),
        }),
        "sweep" => {
            let of = values.word("of")?;
            setting
                .names
                .sweep(reader, of, &located.place("of"))
                .then(|| FigureKind::Sweep {
                    of: of.to_owned(),
                    mark: values.words("mark").to_vec(),
                })
        }
        "spread" => {
            let of = values.word("of")?;
            let known = setting.names.sweep(reader, of, &located.place("of"));
            let at = setting.place(reader, located)?;
            known.then(|| FigureKind::Spread {
                of: of.to_owned(),
                at,
            })
        }
        "densities" => Some(FigureKind::Densities {}),
        "efficiency" => Some(FigureKind::Efficiency {}),
        "comparison-table" => Some(FigureKind::ComparisonTable {}),
        "uncertainty" => {
            if setting.uncertainties.is_empty() {
                reader.report(
                    Problem::at(located.span.clone(), "there is no [[uncertainty]] to show").help(
                        "for instance: [[uncertainty]] and below it halves = { batches = 2 }",
                    ),
                );
                return None;
            }
            Some(FigureKind::Uncertainty {
                at: values.number("at"),
                calibrated: values.flag("calibrated").unwrap_or(false),
            })
        }
        "maps" => maps(reader, located, setting),
        "camera" => camera(reader, located, setting),
        "section" => section(reader, located, setting),
        _ => None,
    }
}

fn maps(reader: &mut Reader, located: &Located, setting: &Setting<'_>) -> Option<FigureKind> {
    let mut show = located.values.words("show").to_vec();
    if !located.given("show") {
        if setting.truth != Some(false) {
            show.push("truth".to_owned());
        }
        show.push("sample".to_owned());
    } else if show.is_empty() {
        reader.report(
            Problem::at(located.place("show"), "`show` is an empty list")
                .allowed("at least one of `truth`, `sample`, `mean`, `error`, `size`"),
        );
        return None;
    }
    for word in &show {
        setting.demand(
            reader,
            &located.place("show"),
            &format!("`{word}`"),
            word == "truth" || word == "error",
            word == "mean" || word == "error",
        );
    }
    Some(FigureKind::Maps {
        show,
        levels: located.values.flag("levels").unwrap_or(false),
    })
}

fn made_title(form: &Form, values: &Values) -> String {
    match (form.name, values.word("measure"), values.word("of")) {
        ("errors", Some(measure), _) => format!("Errors: {}", measure.to_uppercase()),
        ("sweep" | "spread", _, Some(of)) => format!("{} of {of}", form.title),
        _ => form.title.to_owned(),
    }
}
