//! Colours and type of every figure.

use plotters::style::RGBColor;

/// Type families; a name with a digit in it must be quoted.
pub(super) const FONTS: &str =
    "'Source Sans 3', 'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', sans-serif";

/// Size of a figure's title.
pub(super) const TITLE: f64 = 13.5;
/// Size of axis titles and legends.
pub(super) const LABEL: f64 = 11.0;
/// Size of tick labels.
pub(super) const TICK: f64 = 10.0;

/// Text, axes and the truth.
pub(super) const INK: RGBColor = RGBColor(0x26, 0x26, 0x26);
/// Tick labels, notes.
pub(super) const MUTED: RGBColor = RGBColor(0x6e, 0x6e, 0x6e);
/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);

/// Width of a curve.
pub(super) const LINE: f64 = 1.7;
/// Width of the truth.
pub(super) const TRUTH: f64 = 2.4;
/// Opacity of a band.
pub(super) const BAND: f64 = 0.15;

/// The colours of Okabe and Ito (2008) that are dark enough for a line on white, told apart by readers who see red and green alike.
const SERIES: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
];

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub colour: RGBColor,
    pub width: f64,
    pub dash: Option<&'static str>,
}

impl Stroke {
    pub const fn new(colour: RGBColor, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: None,
        }
    }

    pub const fn dashed(self, dash: &'static str) -> Self {
        Self {
            dash: Some(dash),
            ..self
        }
    }
}

/// Colour of series number `index`.
pub(super) fn colour(index: usize) -> RGBColor {
    SERIES[index % SERIES.len()]
}

/// Line of series number `index`: when the colours are used up they come again dashed, then dotted.
pub(super) fn series(index: usize) -> Stroke {
    let stroke = Stroke::new(colour(index), LINE);
    match (index / SERIES.len()) % 3 {
        0 => stroke,
        1 => stroke.dashed("6 4"),
        _ => stroke.dashed("1.5 4"),
    }
}
