//! Which columns are meant.

use super::{Column, Request};
use crate::parameter::nearest;

/// Where the wanted columns are, from 0.
pub(super) struct Layout<const D: usize> {
    pub(super) axes: [usize; D],
    pub(super) weight: Option<usize>,
}

/// What is known of the columns of a file.
pub(super) struct Columns<'a> {
    /// Their names, in their order; empty where they have none.
    pub(super) names: &'a [String],
    pub(super) count: usize,
}

impl Columns<'_> {
    pub(super) fn label(&self, index: usize) -> String {
        match self.names.get(index) {
            Some(name) => format!("column {}", quoted(name)),
            None => format!("column {}", index + 1),
        }
    }

    /// A list for people, short even for wide files.
    fn listed(&self) -> String {
        const SHOWN: usize = 20;
        if self.names.is_empty() {
            return if self.count == 1 {
                "the only column is 1".to_owned()
            } else {
                format!("the columns are 1 to {}", self.count)
            };
        }
        let shown: Vec<String> = self.names.iter().take(SHOWN).map(|n| quoted(n)).collect();
        let more = match self.count.saturating_sub(SHOWN) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("the columns are {}{more}", shown.join(", "))
    }

    fn find(&self, wanted: &str) -> Result<usize, String> {
        let mut hits = (0..self.names.len()).filter(|&i| self.names[i] == wanted);
        match (hits.next(), hits.next()) {
            (Some(first), Some(second)) => Err(format!(
                "the name {} stands over columns {} and {}; give the number of the column instead",
                quoted(wanted),
                first + 1,
                second + 1
            )),
            (Some(only), None) => Ok(only),
            (None, _) => match wanted.parse::<usize>() {
                Ok(number) if (1..=self.count).contains(&number) => Ok(number - 1),
                _ => {
                    let guess = nearest(wanted, self.names.iter().map(String::as_str))
                        .map(|name| format!(" did you mean {}?", quoted(name)))
                        .unwrap_or_default();
                    Err(format!(
                        "no column {};{guess} {}",
                        quoted(wanted),
                        self.listed()
                    ))
                }
            },
        }
    }

    pub(super) fn resolve<const D: usize>(
        &self,
        request: &Request<'_, D>,
    ) -> Result<Layout<D>, String> {
        let weight = request.weight.map(|name| self.find(name)).transpose()?;
        let mut axes = [0; D];
        for (axis, wanted) in request.columns.iter().enumerate() {
            axes[axis] = match wanted {
                Column::Named(name) => self.find(name)?,
                Column::Preferred(names) => {
                    let found = names.iter().find_map(|name| self.find(name).ok());
                    let others = D + usize::from(weight.is_some());
                    match found {
                        Some(index) => index,
                        // with as many columns as are wanted there is no choice
                        None if self.count == others && D == 1 => usize::from(weight == Some(0)),
                        None => {
                            return Err(format!("name the column to read; {}", self.listed()));
                        }
                    }
                }
            };
        }
        if let Some(weight) = weight.filter(|w| axes.contains(w)) {
            return Err(format!(
                "{} is asked for both as data and as weight",
                self.label(weight)
            ));
        }
        Ok(Layout { axes, weight })
    }
}

/// Text of a file in a message: quoted, control characters made visible, not too long.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    format!("{short:?}")
}
