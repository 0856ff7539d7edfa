//! `[[uncertainty]]`: estimates of the error that are held against the true one, and claims about them.

use super::node::{Entry, Reader, Table};
use super::problem::{Problem, printable};
use super::setting::Setting;
use super::value;
use crate::experiment::Statement;
use crate::experiment::uncertainty::{Quantity, UncertaintyKind, UncertaintySpec};
use crate::parameter::{Absent, Kind, Parameter, listed, nearest};
use crate::uncertainty::Split;

/// Keys beside the kind.
pub(crate) const COMMON: &[Parameter] = &[Parameter::optional(
    "name",
    Kind::Text,
    Absent::Unset,
    "what it is called in tables and claims; its kind by default",
)];

/// `halves`.
const HALVES: &[Parameter] = &[
    Parameter::optional(
        "batches",
        Kind::Count {
            least: 2,
            most: 10_000,
        },
        Absent::Number(2.0),
        "how many parts the sample is cut into",
    ),
    Parameter::optional(
        "by",
        Kind::Choice(&Split::NAMES),
        Absent::Word("path"),
        "what stays together: all points of a path (each point its own path unless the source says otherwise), or nothing, which is wrong where paths leave several points",
    ),
];

/// `differences`.
const DIFFERENCES: &[Parameter] = &[
    Parameter::optional(
        "directions",
        Kind::Count { least: 4, most: 8 },
        Absent::Number(8.0),
        "with how many shifted windows each is compared: 4 along the axes, 8 along the diagonals too",
    ),
    Parameter::optional(
        "region",
        Kind::Count {
            least: 0,
            most: 1000,
        },
        Absent::Number(6.0),
        "half the side of the square of cells over which squared differences are averaged: 6 is 13 × 13",
    ),
];

/// Every kind, with what it takes and what it is.
pub(crate) const FORMS: &[(&str, &[Parameter], &str)] = &[
    (
        "halves",
        HALVES,
        "the random error from halves or batches of the sample",
    ),
    (
        "differences",
        DIFFERENCES,
        "the local error from differences to shifted windows; in the plane, for an estimate of one width",
    ),
];

/// The claim `uncertainty`.
pub(crate) const CLAIM: &[Parameter] = &[
    Parameter::required("of", Kind::Text, "the estimator"),
    Parameter::required("by", Kind::Text, "the [[uncertainty]]"),
    Parameter::required(
        "quantity",
        Kind::Choice(&Quantity::NAMES),
        "ratio: mean ∫ê² over ∫var; spread: relative deviation of ∫ê² over replicates; unseen: MISE over mean ∫ê²; rank: Spearman's correlation over the targets of mean ê² with the true mean squared error; factor: M, the latter over the former",
    ),
    Parameter::optional(
        "equals",
        Kind::Positive,
        Absent::Unset,
        "the expected value; the whole interval must lie within the margin",
    ),
    Parameter::optional(
        "margin",
        Kind::Positive,
        Absent::Unset,
        "how far off is still equal: less than half of what is expected",
    ),
    Parameter::optional(
        "above",
        Kind::Positive,
        Absent::Unset,
        "a bound below the whole interval",
    ),
    Parameter::optional(
        "confidence",
        Kind::Range(0.9, 0.9999),
        Absent::Number(0.99),
        "the confidence of the interval",
    ),
];

/// Reads one `[[uncertainty]]`.
pub(super) fn uncertainty(reader: &mut Reader, mut table: Table<'_>) -> Option<UncertaintySpec> {
    let span = table.span.clone();
    let name = match table.take("name") {
        Some(entry) => Some(reader.name(entry.item, "the name of an uncertainty")?),
        None => None,
    };
    let mut given: Vec<(usize, Entry<'_>)> = (0..FORMS.len())
        .filter_map(|at| Some((at, table.take(FORMS[at].0)?)))
        .collect();
    let allowed: Vec<&str> = std::iter::once("name")
        .chain(FORMS.iter().map(|form| form.0))
        .collect();
    let unknown = table.finish(reader, &allowed);
    let kinds: Vec<&str> = FORMS.iter().map(|form| form.0).collect();
    let (at, entry) = match given.len() {
        0 => {
            if !unknown {
                let what = "this uncertainty names no kind";
                reader.report(Problem::at(span, what).allowed(listed(&kinds)));
            }
            return None;
        }
        1 => given.remove(0),
        _ => {
            let what = format!("this uncertainty is by `{}` already", given[0].1.key());
            reader.report(
                Problem::at(given[1].1.key_span(), what).help("write an [[uncertainty]] for each"),
            );
            return None;
        }
    };
    let (kind, parameters, _) = FORMS[at];
    let what = format!("`{kind}`");
    let mut settings = reader.table(entry.item, &what)?;
    settings.span = entry.key_span();
    let read = value::values(reader, parameters, settings, &what);
    if !read.complete {
        return None;
    }
    let count = |key: &str| read.values.count(key).map(|count| count as usize);
    let kind_read = if kind == "halves" {
        UncertaintyKind::Halves {
            batches: count("batches")?,
            by: read.values.word("by")?.to_owned(),
        }
    } else {
        let directions = count("directions")?;
        if directions != 4 && directions != 8 {
            let place = read.place("directions");
            let what = format!("there are 4 or 8 directions, not {directions}");
            reader.report(Problem::at(place, what).allowed("4, 8"));
            return None;
        }
        UncertaintyKind::Differences {
            directions,
            region: count("region")?,
        }
    };
    Some(UncertaintySpec {
        name: name.unwrap_or_else(|| kind.to_owned()),
        kind: kind_read,
    })
}

/// Reads the claim `uncertainty`.
pub(super) fn claim(
    reader: &mut Reader,
    entry: Entry<'_>,
    setting: &Setting<'_>,
) -> Option<Statement> {
    let demanded = setting.demand(
        reader,
        &entry.key_span(),
        "the claim `uncertainty`",
        true,
        true,
    );
    let what = "`uncertainty`";
    let mut table = reader.table(entry.item, what)?;
    table.span = entry.key_span();
    let read = value::values(reader, CLAIM, table, what);
    if !read.complete {
        return None;
    }
    let values = &read.values;
    let (of, by) = (values.word("of")?, values.word("by")?);
    let mut known = setting.names.one(reader, of, &read.place("of"));
    if !setting.uncertainties.iter().any(|name| name == by) {
        let names = setting.uncertainties.iter().map(String::as_str);
        let what = format!("there is no uncertainty \"{}\"", printable(by));
        let allowed = listed(setting.uncertainties);
        reader.report(
            Problem::at(read.place("by"), what)
                .suggest(nearest(by, names))
                .allowed(allowed),
        );
        known = false;
    }
    let (equals, margin) = (values.number("equals"), values.number("margin"));
    let above = values.number("above");
    let equals = match (equals, margin) {
        (Some(equals), Some(margin)) if margin < 0.5 * equals => Some((equals, margin)),
        (Some(equals), Some(_)) => {
            let what = "a margin of half of what is expected or more could hardly fail";
            let most = 0.5 * equals;
            reader.report(
                Problem::at(read.place("margin"), what)
                    .allowed(format!("a number above 0 and below {most}")),
            );
            return None;
        }
        (None, None) if above.is_some() => None,
        _ => {
            reader.report(
                Problem::at(entry.key_span(), "this claim is compared with nothing")
                    .allowed("`equals` with `margin`, or `above`"),
            );
            return None;
        }
    };
    (known && demanded).then_some(Statement::Uncertainty {
        of: of.to_owned(),
        by: by.to_owned(),
        quantity: Quantity::named(values.word("quantity")?)?,
        equals,
        above,
        confidence: values.number("confidence")?,
    })
}
