//! The verdict of an experiment with regions: which estimator to use where, and at what cost, read off the results.

use super::Material;
use super::regions::{area, parts, relative};
use crate::accuracy::compare;
use crate::experiment::Measure;
use crate::experiment::judge::short;
use crate::experiment::results::{Group, Outcome};

/// Two estimators whose mean errors on the same samples differ by no more than chance at this confidence are called alike.
const CONFIDENCE: f64 = 0.99;

/// What a group's results say in plain words, a paragraph each; nothing without regions, a truth or replicates. `costs` are seconds of each estimator for one
/// estimate on the grid, where they were taken.
pub(super) fn paragraphs<const D: usize>(
    material: &Material<'_, D>,
    costs: &[Vec<f64>],
) -> Vec<String> {
    let groups = &material.results.groups;
    let mut all = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        let enough = group.outcomes.len() > 1
            && group
                .outcomes
                .iter()
                .all(|outcome| outcome.replicates.len() > 1);
        if group.regions.is_empty() || group.truth.is_none() || !enough {
            continue;
        }
        let verdict = Verdict::of(group);
        let costs = costs.get(index).map_or(&[][..], Vec::as_slice);
        let mut said = verdict.places();
        said.extend(verdict.safest());
        said.extend(verdict.cost(costs));
        if groups.len() > 1 {
            let name = format!("{}, n = {}: ", group.name, group.draws);
            if let Some(first) = said.first_mut() {
                first.insert_str(0, &name);
            }
        }
        all.extend(said);
    }
    all
}

/// The relative errors of each estimator in each part.
struct Verdict<'a> {
    names: Vec<&'a str>,
    /// Name of the part, error of each estimator, and which are no worse than the best by more than chance.
    parts: Vec<(String, Vec<f64>, Vec<usize>)>,
}

impl<'a> Verdict<'a> {
    fn of<const D: usize>(group: &'a Group<D>) -> Self {
        let parts = parts(group)
            .into_iter()
            .filter_map(|(name, part)| {
                let part = part.as_ref().unwrap_or(group);
                let area = area(group, part);
                let errors: Vec<f64> = part
                    .outcomes
                    .iter()
                    .map(|outcome| relative(outcome, area).map(|(error, _)| error))
                    .collect::<Option<_>>()?;
                let best = least(&errors)?;
                let alike = (0..errors.len())
                    .filter(|&other| alike(&part.outcomes[best], &part.outcomes[other]))
                    .collect();
                Some((name, errors, alike))
            })
            .collect();
        Self {
            names: group
                .outcomes
                .iter()
                .map(|outcome| outcome.name.as_str())
                .collect(),
            parts,
        }
    }

    /// A sentence for each part.
    fn places(&self) -> Vec<String> {
        let sentence = |(name, errors, alike): &(String, Vec<f64>, Vec<usize>)| {
            let best = least(errors)?;
            let others: Vec<usize> = alike.iter().copied().filter(|&i| i != best).collect();
            let as_good = match others.len() {
                0 => String::new(),
                1..=4 => format!("; {} cannot be told from it", self.list(&others)),
                many => format!("; {many} others cannot be told from it"),
            };
            let worst = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b]))?;
            Some(format!(
                "{}: \"{}\" errs least, by {} of the truth{as_good}. \"{}\" errs {} times as much.",
                capital(name),
                self.names[best],
                percent(errors[best]),
                self.names[worst],
                short(errors[worst] / errors[best]),
            ))
        };
        self.parts.iter().filter_map(sentence).collect()
    }

    /// What to use where it is not known which part one is in.
    fn safest(&self) -> Option<String> {
        // the first part is the whole grid
        let parts = &self.parts[1.min(self.parts.len())..];
        let regret = |estimator: usize| {
            parts
                .iter()
                .map(|(name, errors, _)| {
                    let best = errors.iter().copied().fold(f64::INFINITY, f64::min);
                    (errors[estimator] / best, name)
                })
                .max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let regrets: Vec<(f64, &String)> =
            (0..self.names.len()).map(regret).collect::<Option<_>>()?;
        let factors: Vec<f64> = regrets.iter().map(|regret| regret.0).collect();
        let best = least(&factors)?;
        let mut order: Vec<usize> = (0..factors.len()).filter(|&i| i != best).collect();
        order.sort_by(|&a, &b| factors[a].total_cmp(&factors[b]));
        let next: Vec<String> = order
            .iter()
            .take(3)
            .map(|&i| {
                format!(
                    "\"{}\" {} times ({})",
                    self.names[i],
                    short(factors[i]),
                    regrets[i].1
                )
            })
            .collect();
        Some(format!(
            "Where it is not known what lies where, use \"{}\": in its worst region ({}) it errs {} times as much as the best there. The next safest: {}.",
            self.names[best],
            regrets[best].1,
            short(factors[best]),
            next.join(", ")
        ))
    }

    fn cost(&self, costs: &[f64]) -> Option<String> {
        let cheapest = least(costs).filter(|_| costs.len() == self.names.len())?;
        let times = |estimator: usize| costs[estimator] / costs[cheapest];
        let (_, errors, alike) = self.parts.first()?;
        let best = least(errors)?;
        let cheap = alike
            .iter()
            .copied()
            .min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        let also = cheap.filter(|&cheap| cheap != best).map_or_else(String::new, |cheap| {
            format!(
                " The cheapest that cannot be told from it over the whole grid, \"{}\", costs {} times the least.",
                self.names[cheap],
                factor(times(cheap))
            )
        });
        Some(format!(
            "Cost, timed once on this machine: \"{}\" is the cheapest ({} ms for an estimate of the grid, preparation included); \"{}\", which errs least over the whole grid, costs {} times that.{also}",
            self.names[cheapest],
            short((1e4 * costs[cheapest]).round() / 10.0),
            self.names[best],
            factor(times(best)),
        ))
    }

    fn list(&self, which: &[usize]) -> String {
        let names: Vec<String> = which
            .iter()
            .map(|&i| format!("\"{}\"", self.names[i]))
            .collect();
        match &names[..] {
            [one] => one.clone(),
            [first @ .., last] => format!("{} and {last}", first.join(", ")),
            [] => String::new(),
        }
    }
}

fn least(values: &[f64]) -> Option<usize> {
    (0..values.len()).min_by(|&a, &b| values[a].total_cmp(&values[b]))
}

/// Whether chance alone could explain the difference of the mean squared relative errors.
fn alike(best: &Outcome, other: &Outcome) -> bool {
    let (Some(a), Some(b)) = (
        best.per_replicate(Measure::Mire, 1.0),
        other.per_replicate(Measure::Mire, 1.0),
    ) else {
        return false;
    };
    let difference = compare(&b, &a, CONFIDENCE).difference;
    difference.low <= 0.0
}

fn percent(share: f64) -> String {
    format!("{} %", crate::experiment::significant(100.0 * share, 2))
}

fn factor(times: f64) -> String {
    crate::experiment::significant(times, 2)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_follow_from_the_numbers() {
        let verdict = Verdict {
            names: vec!["few", "many", "adaptive"],
            parts: vec![
                ("whole grid".to_owned(), vec![0.14, 0.36, 0.07], vec![2]),
                ("flat".to_owned(), vec![0.14, 0.01, 0.02], vec![1]),
                ("peak".to_owned(), vec![0.14, 0.8, 0.15], vec![0, 2]),
            ],
        };
        let places = verdict.places();
        assert_eq!(
            places[0],
            "Whole grid: \"adaptive\" errs least, by 7 % of the truth. \"many\" errs 5.143 times as much."
        );
        assert!(
            places[2].contains("\"few\" errs least, by 14 % of the truth; \"adaptive\" cannot")
        );
        let safest = verdict.safest().expect("two regions");
        assert!(safest.starts_with("Where it is not known what lies where, use \"adaptive\": in its worst region (flat) it errs 2 times"), "{safest}");
        let cost = verdict.cost(&[0.001, 0.01, 0.02]).expect("costs");
        assert!(
            cost.contains("\"few\" is the cheapest (1 ms") && cost.contains("costs 20 times"),
            "{cost}"
        );
        assert!(verdict.cost(&[0.1]).is_none());
    }
}
