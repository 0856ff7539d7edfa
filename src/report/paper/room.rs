//! All sources of an experiment that are flat pieces of surfaces in space, unfolded into one map for each estimator.

use super::Material;
use super::pictures::chosen;
use super::unfold::{Face, Placed, unfold};
use crate::experiment::Figure;
use crate::experiment::results::Group;
use crate::experiment::run::RunError;
use crate::report::figure::{Axis, Colours, HeatMaps, Map, Piece, Svg};
use crate::space::{Grid, Point};

/// Pixels of the longer side of a map, and of one of dots.
const PIXELS: usize = 420;
const FINE: usize = 1020;
/// A dot is as large as this share of the paper over the number of dots allows, and has up to so many pixels across.
const COVERED: f64 = 0.06;
const LARGEST: i64 = 4;

/// Faces on paper, and which of them each pixel shows where.
struct Sheet {
    low: [f64; 2],
    high: [f64; 2],
    cells: [usize; 2],
    /// The face and the place in its chart at each pixel, the second axis fastest.
    shown: Vec<Option<(usize, Point<2>)>>,
    placed: Vec<Placed>,
}

impl Sheet {
    fn of(faces: &[Face], pixels: usize) -> Self {
        let placed = unfold(faces);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (face, placed) in faces.iter().zip(&placed) {
            let [least, most] = placed.bounds(face);
            for k in 0..2 {
                low[k] = low[k].min(least[k]);
                high[k] = high[k].max(most[k]);
            }
        }
        let pixel = (high[0] - low[0]).max(high[1] - low[1]) / pixels as f64;
        let cells = [0, 1].map(|k: usize| ((high[k] - low[k]) / pixel).ceil().max(1.0) as usize);
        let mut sheet = Self {
            high: [0, 1].map(|k: usize| low[k] + cells[k] as f64 * pixel),
            low,
            cells,
            shown: Vec::new(),
            placed,
        };
        let middle = |k: usize, i: usize| (i as f64 + 0.5).mul_add(pixel, low[k]);
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                let place = [middle(0, i), middle(1, j)];
                let found = faces.iter().zip(&sheet.placed).enumerate().find_map(
                    |(number, (face, placed))| {
                        let chart = placed.chart(place);
                        let inside =
                            (0..2).all(|k| face.low[k] <= chart[k] && chart[k] <= face.high[k]);
                        inside.then_some((number, chart))
                    },
                );
                sheet.shown.push(found);
            }
        }
        sheet
    }

    /// A value at each pixel from the values on each face's grid.
    fn map(&self, title: &str, faces: &[(&Grid<2>, &[f64])]) -> Map {
        let value = |shown: &Option<(usize, Point<2>)>| {
            let (face, chart) = (*shown)?;
            let (grid, values) = faces[face];
            let number = (0..2).fold(0, |number, axis| {
                let cells = grid.cells()[axis];
                let t = (chart[axis] - grid.low()[axis]) / grid.width(axis);
                number * cells + (t.max(0.0) as usize).min(cells - 1)
            });
            values.get(number).copied()
        };
        Map {
            title: title.to_owned(),
            values: self
                .shown
                .iter()
                .map(|shown| value(shown).unwrap_or(f64::NAN))
                .collect(),
            ..Map::default()
        }
    }

    /// 1 at each pixel of a dot, 0 at the other pixels of a face. Few dots are larger, so that they are seen.
    fn dots(&self, title: &str, points: &[Vec<Point<2>>]) -> Map {
        let mut values: Vec<f64> = self
            .shown
            .iter()
            .map(|shown| if shown.is_some() { 0.0 } else { f64::NAN })
            .collect();
        let count: usize = points.iter().map(Vec::len).sum();
        let room = self.shown.iter().flatten().count() as f64 / count.max(1) as f64;
        let across = ((COVERED * room).sqrt() as i64).clamp(1, LARGEST);
        for (placed, points) in self.placed.iter().zip(points) {
            for &point in points {
                let place = placed.place(point);
                let [i, j] = [0, 1].map(|k: usize| {
                    let share = (place[k] - self.low[k]) / (self.high[k] - self.low[k]);
                    ((share * self.cells[k] as f64).max(0.0) as usize).min(self.cells[k] - 1) as i64
                });
                let from = -(across - 1) / 2;
                for (a, b) in (from..from + across)
                    .flat_map(|a| (from..from + across).map(move |b| (i + a, j + b)))
                {
                    if (0..self.cells[0] as i64).contains(&a)
                        && (0..self.cells[1] as i64).contains(&b)
                    {
                        let value = &mut values[a as usize * self.cells[1] + b as usize];
                        // not on the paper beside a face
                        if value.is_finite() {
                            *value = 1.0;
                        }
                    }
                }
            }
        }
        Map {
            title: title.to_owned(),
            values,
            ..Map::default()
        }
    }

    /// The outline of each face with its name.
    fn pieces(&self, faces: &[Face], names: &[String]) -> Vec<Piece> {
        let placed = self.placed.iter().zip(faces).zip(names);
        placed
            .map(|((placed, face), name)| {
                let [[a, b], [c, d]] = [face.low, face.high];
                Piece {
                    name: name.clone(),
                    corners: [[a, b], [c, b], [c, d], [a, d]]
                        .map(|corner| placed.place(corner))
                        .to_vec(),
                }
            })
            .collect()
    }
}

/// The map of each estimator over all faces of one sample size; nothing where a source is no flat piece of space.
pub(super) fn unfolded(
    material: &Material<'_, 2>,
    figure: &Figure,
    groups: &[(&Group<2>, &[Vec<f64>])],
    show: &[String],
) -> Result<Option<Svg>, RunError> {
    let wants = |what: &str| show.iter().any(|word| word == what);
    let mut faces = Vec::new();
    let mut names = Vec::new();
    for (group, _) in groups {
        let Some(frame) = material.bench.frame(group.source) else {
            return Ok(None);
        };
        let source = &material.bench.experiment().sources[group.source];
        names.push(source.name().replace('_', " "));
        faces.push(Face {
            frame,
            low: group.grid.low(),
            high: group.grid.high(),
        });
    }
    let Some((first, _)) = groups.first() else {
        return Ok(None);
    };
    let dots = wants("points");
    let sheet = Sheet::of(&faces, if dots { FINE } else { PIXELS });
    let mut maps = Vec::new();
    if dots {
        let points: Vec<Vec<Point<2>>> = groups
            .iter()
            .map(|(group, _)| {
                Ok(material
                    .bench
                    .sample(group.source, group.size, 0)?
                    .points()
                    .to_vec())
            })
            .collect::<Result<_, RunError>>()?;
        maps.push(sheet.dots("", &points));
    }
    if wants("truth") {
        let truth: Option<Vec<(&Grid<2>, &[f64])>> = groups
            .iter()
            .map(|(group, _)| Some((&group.grid, &group.truth.as_ref()?[..])))
            .collect();
        maps.extend(truth.map(|faces| sheet.map("truth", &faces)));
    }
    if wants("sample") {
        for (number, outcome) in chosen(figure, first) {
            let values: Vec<(&Grid<2>, &[f64])> = groups
                .iter()
                .map(|(group, first)| (&group.grid, &first[number][..]))
                .collect();
            maps.push(sheet.map(&outcome.name, &values));
        }
    }
    let drawing = HeatMaps {
        title: String::new(),
        description: figure.caption.clone(),
        x: Axis::new("", ""),
        y: Axis::new("", ""),
        low: sheet.low,
        high: sheet.high,
        cells: sheet.cells,
        label: "power per area".to_owned(),
        colours: if dots { Colours::Ink } else { Colours::Amount },
        pieces: sheet.pieces(&faces, &names),
        columns: maps.len().clamp(1, 3),
        maps,
        ..HeatMaps::default()
    };
    Ok(Some(drawing.draw()))
}
