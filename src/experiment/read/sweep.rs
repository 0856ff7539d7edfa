//! Several values for a parameter that takes one: a list, or a range with geometric steps.

use super::node::{Item, Reader};
use super::problem::{Problem, Span};
use super::value;
use crate::parameter::{Kind, Parameter, Value};
use toml::de::DeValue;

/// The most members of one sweep.
const STEPS: u64 = 10_000;

/// Whether `item` gives several values for a parameter that takes one.
pub(super) fn is_sweep(parameter: &Parameter, item: &Item<'_>) -> bool {
    parameter.sweeps && matches!(item.get_ref(), DeValue::Array(_) | DeValue::Table(_))
}

/// The values of a sweep with their places.
pub(super) fn values(
    reader: &mut Reader,
    parameter: &Parameter,
    item: &Item<'_>,
) -> Option<Vec<(Value, Span)>> {
    if let DeValue::Table(_) = item.get_ref() {
        let values = steps(reader, parameter, item)?;
        return Some(
            values
                .into_iter()
                .map(|value| (value, item.span()))
                .collect(),
        );
    }
    let DeValue::Array(list) = item.get_ref() else {
        return None;
    };
    if list.is_empty() {
        reader.report(
            Problem::at(
                item.span(),
                format!(
                    "`{}` is an empty list: nothing to sweep over",
                    parameter.name
                ),
            )
            .allowed(parameter.kind),
        );
        return None;
    }
    if list.len() as u64 > STEPS {
        reader.report(
            Problem::at(
                item.span(),
                format!("a sweep of {} values is too long", list.len()),
            )
            .allowed(format!("at most {STEPS} values")),
        );
        return None;
    }
    // A word chooses one number by itself; a sweep needs numbers to be drawn against.
    let each = Parameter {
        kind: parameter.kind.numeric(),
        ..*parameter
    };
    let mut read: Vec<(Value, Span)> = Vec::new();
    let mut sound = true;
    for item in list {
        let Some(value) = value::value(reader, &each, item) else {
            sound = false;
            continue;
        };
        if read.iter().any(|(other, _)| *other == value) {
            reader.report(Problem::at(
                item.span(),
                format!("`{}` is swept over this value twice", parameter.name),
            ));
            sound = false;
        }
        read.push((value, item.span()));
    }
    sound.then_some(read)
}

/// What `{ low = .., high = .., steps = .. }` takes.
pub(crate) const RANGE: &[Parameter] = &[
    Parameter::required("low", Kind::Positive, "the first value"),
    Parameter::required("high", Kind::Positive, "the last value"),
    Parameter::required(
        "steps",
        Kind::Count {
            least: 2,
            most: STEPS,
        },
        "how many values, both ends among them, each the same multiple of the one before",
    ),
];

fn steps(reader: &mut Reader, parameter: &Parameter, item: &Item<'_>) -> Option<Vec<Value>> {
    let what = format!("the sweep of `{}`", parameter.name);
    let table = reader.table(item, &what)?;
    let read = value::values(reader, RANGE, table, &what);
    if !read.complete {
        return None;
    }
    let (low, high) = (read.values.number("low")?, read.values.number("high")?);
    let steps = read.values.count("steps")?;
    if low >= high {
        reader.report(Problem::at(
            read.place("high"),
            format!("{what} needs low < high; it has {low} and {high}"),
        ));
        return None;
    }
    let numbers = geometric(low, high, steps);
    if numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
        reader.report(Problem::at(
            read.place("steps"),
            format!("between {low} and {high} there are not {steps} different numbers"),
        ));
        return None;
    }
    if let Kind::Count { least, most } = parameter.kind.numeric() {
        if low < least as f64 || high > most as f64 {
            reader.report(
                Problem::at(item.span(), format!("{what} must stay within its range"))
                    .allowed(parameter.kind.numeric()),
            );
            return None;
        }
        let mut counts: Vec<u64> = numbers.iter().map(|x| x.round() as u64).collect();
        counts.dedup();
        return Some(counts.into_iter().map(Value::Count).collect());
    }
    Some(numbers.into_iter().map(Value::Number).collect())
}

/// `steps` numbers from `low` to `high`, the ends exact, each the same multiple of the one before.
fn geometric(low: f64, high: f64, steps: u64) -> Vec<f64> {
    let last = steps - 1;
    // Logarithms rather than the ratio, which may overflow.
    let (from, to) = (low.ln(), high.ln());
    (0..steps)
        .map(|i| {
            if i == 0 {
                low
            } else if i == last {
                high
            } else {
                let t = i as f64 / last as f64;
                (from + (to - from) * t).exp()
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::geometric;

    #[test]
    fn sweeps_are_geometric_with_exact_ends() {
        let h = geometric(0.05, 2.0, 25);
        assert_eq!(
            (h.len(), h[0].to_bits(), h[24].to_bits()),
            (25, 0.05_f64.to_bits(), 2.0_f64.to_bits())
        );
        let ratio = 40.0_f64.powf(1.0 / 24.0);
        assert!(
            h.windows(2)
                .all(|pair| (pair[1] / pair[0] / ratio - 1.0).abs() < 1e-12)
        );
        assert!(geometric(1e-300, 1e300, 7).iter().all(|x| x.is_finite()));
    }
}
