//! Pictures of a scene beside the one that they are judged by, with what is wrong in each.

use super::figure::{Axis, Colours, HeatMaps, Map, Photograph, Photographs, Piece, Svg};
use super::text::significant;
use crate::light::image::{Image, Tone, luminance};

/// A picture with what made it.
pub struct Shown {
    /// The estimator, or how it was made.
    pub name: String,
    /// The picture.
    pub image: Image,
    /// Seconds that its light took, fit included.
    pub seconds: f64,
}

/// How wrong a picture is: its luminance less that of the picture it is judged by, in per cent of the average, over all pixels but lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrong {
    /// The root of the mean square.
    pub root_mean_square: f64,
    /// The mean.
    pub mean: f64,
}

/// Pictures and what is wrong with them.
pub struct Compared {
    /// The one that they are judged by and the others, through the same tone curve.
    pub pictures: Svg,
    /// A map of the errors of each.
    pub errors: Svg,
    /// Errors beyond it, in per cent of the average, have the last colour: a round number as text.
    pub limit: String,
    /// How wrong each is.
    pub wrong: Vec<Wrong>,
}

/// Lamps seen directly are the same in every picture and would drown all else: above this many times the average, a pixel does not count.
const LAMP: f64 = 8.0;
/// The share of pixels whose errors lie within the colours of the maps.
const WITHIN: f64 = 0.99;

/// `pictures`, all of the size of `truth`, judged by it.
pub fn compare(truth: &Shown, pictures: &[Shown]) -> Compared {
    let judged = Judged::new(&truth.image);
    let tone = Tone::of(&truth.image);
    let size = [truth.image.width(), truth.image.height()];
    let columns = columns(pictures.len() + 1);
    let photographs = Photographs {
        description:
            "Pictures of the scene by each estimator beside the one that they are judged by."
                .to_owned(),
        size,
        columns,
        pictures: std::iter::once(truth)
            .chain(pictures)
            .map(|shown| Photograph {
                title: shown.name.clone(),
                pixels: shown
                    .image
                    .pixels()
                    .iter()
                    .map(|&p| tone.display(p))
                    .collect(),
            })
            .collect(),
    };
    let errors: Vec<Vec<f64>> = pictures.iter().map(|p| judged.errors(&p.image)).collect();
    let wrong: Vec<Wrong> = errors.iter().map(|errors| Wrong::of(errors)).collect();
    let limit = limit(&errors);
    let [width, height] = size.map(|pixels| pixels as f64);
    let maps = HeatMaps {
        description: "What each picture shows too much or too little.".to_owned(),
        x: Axis::new("", ""),
        y: Axis::new("", ""),
        low: [0.0; 2],
        high: [width, height],
        cells: size,
        label: "too dark – too bright (% of the average)".to_owned(),
        colours: Colours::Signed,
        pieces: vec![Piece {
            name: String::new(),
            corners: vec![[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]],
        }],
        columns,
        maps: pictures
            .iter()
            .zip(errors.iter().zip(&wrong))
            .map(|(shown, (errors, wrong))| Map {
                title: shown.name.clone(),
                value: wrong.in_words(),
                values: upright(errors, size, limit),
            })
            .collect(),
        ..HeatMaps::default()
    };
    Compared {
        pictures: photographs.draw(),
        errors: maps.draw(),
        limit: significant(limit, 3),
        wrong,
    }
}

/// Pictures in a row: few and large, or many.
fn columns(pictures: usize) -> usize {
    match pictures {
        0..=4 => 2,
        _ => 3,
    }
}

impl Wrong {
    fn in_words(self) -> String {
        if self.root_mean_square.is_finite() {
            format!("{:.2} %", self.root_mean_square)
        } else {
            "infinite".to_owned()
        }
    }

    fn of(errors: &[f64]) -> Self {
        // an infinite pixel makes all infinite
        let all: Vec<f64> = errors.iter().copied().filter(|e| !e.is_nan()).collect();
        let n = all.len().max(1) as f64;
        let square = all.iter().map(|e| e * e).sum::<f64>() / n;
        Self {
            root_mean_square: square.sqrt(),
            mean: all.iter().sum::<f64>() / n,
        }
    }
}

/// A picture to judge others by.
struct Judged {
    luminance: Vec<f64>,
    average: f64,
    ceiling: f64,
}

impl Judged {
    fn new(truth: &Image) -> Self {
        let of = |p: &[f32; 3]| f64::from(luminance(*p));
        let all: Vec<f64> = truth.pixels().iter().map(of).collect();
        // much of a picture may show nothing at all; of what is lit, half is no lamp, whatever the scene
        let mut lit: Vec<f64> = all.iter().copied().filter(|&l| l > 0.0).collect();
        lit.sort_by(f64::total_cmp);
        let ceiling = lit.get(lit.len() / 2).map_or(f64::INFINITY, |m| LAMP * m);
        let (mut sum, mut count) = (0.0, 0.0);
        for &luminance in all.iter().filter(|&&l| l <= ceiling) {
            sum += luminance;
            count += 1.0;
        }
        let average: f64 = sum / f64::max(count, 1.0);
        Self {
            luminance: all,
            average: if average > 0.0 { average } else { 1.0 },
            ceiling,
        }
    }

    /// In per cent of the average; lamps are no number.
    fn errors(&self, image: &Image) -> Vec<f64> {
        let pairs = image.pixels().iter().zip(&self.luminance);
        pairs
            .map(|(&pixel, &truth)| {
                if truth > self.ceiling {
                    f64::NAN
                } else {
                    100.0 * (f64::from(luminance(pixel)) - truth) / self.average
                }
            })
            .collect()
    }
}

/// A round number that few errors exceed.
fn limit(errors: &[Vec<f64>]) -> f64 {
    let finite = errors.iter().flatten().filter(|e| e.is_finite());
    let mut all: Vec<f64> = finite.map(|e| e.abs()).collect();
    all.sort_by(f64::total_cmp);
    let most = all.get((WITHIN * all.len() as f64) as usize);
    let most = most.or(all.last()).copied().unwrap_or(1.0).max(1e-3);
    let decade = 10.0_f64.powf(most.log10().floor());
    let round = [1.0, 2.0, 3.0, 4.0, 5.0, 7.5, 10.0];
    let steps = round.into_iter().map(|step| step * decade);
    steps
        .filter(|&step| step >= most)
        .fold(10.0 * decade, f64::min)
}

/// Rows from the top as columns from below, as maps want them, and no further than the limit.
fn upright(errors: &[f64], [width, height]: [usize; 2], limit: f64) -> Vec<f64> {
    let at = |column: usize, row: usize| {
        let error = errors[(height - 1 - row) * width + column];
        // lamps stay no number
        error.clamp(-limit, limit)
    };
    (0..width)
        .flat_map(|column| (0..height).map(move |row| at(column, row)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{Judged, limit, upright};
    use crate::light::image::Image;

    #[test]
    fn errors_are_shares_of_the_average_without_lamps() {
        let truth = Image::new(3, 1, vec![[1.0; 3], [3.0; 3], [1000.0; 3]]);
        let judged = Judged::new(&truth);
        let image = Image::new(3, 1, vec![[1.2; 3], [3.0; 3], [0.0; 3]]);
        let errors = judged.errors(&image);
        assert!((errors[0] - 10.0).abs() < 1e-4 && errors[1].abs() < 1e-4);
        assert!(errors[2].is_nan());
        for (most, round) in [(14.0, 20.0), (0.31, 0.4), (80.0, 100.0), (5.0, 5.0)] {
            let limit = limit(&[vec![0.1, -most], vec![f64::NAN]]);
            assert!((limit - round).abs() < 1e-9, "{most}: {limit}");
        }
        assert!(limit(&[]) > 0.0);
    }

    /// Where most pixels see nothing, what is lit counts all the same, and lamps still do not.
    #[test]
    fn a_dark_picture_is_judged_by_what_is_lit() {
        let mut pixels = vec![[0.0; 3]; 7];
        pixels.extend([[1.0; 3], [1.0; 3], [100.0; 3]]);
        let judged = Judged::new(&Image::new(10, 1, pixels));
        let brighter = vec![[1.02; 3]; 10];
        let errors = judged.errors(&Image::new(10, 1, brighter));
        // the average is over nine pixels, two of which are lit
        assert!((errors[7] - 9.0).abs() < 1e-3, "{errors:?}");
        assert!(errors[9].is_nan() && errors[..9].iter().all(|e| e.is_finite()));
    }

    #[test]
    fn pictures_stand_upright() {
        // 2 × 2: above 1 2, below 3 4
        let maps = upright(&[1.0, 2.0, 3.0, f64::NAN], [2, 2], 2.5);
        assert_eq!(&maps[..2], [2.5, 1.0]);
        assert!(maps[2].is_nan() && (maps[3] - 2.0).abs() < 1e-12);
    }
}
