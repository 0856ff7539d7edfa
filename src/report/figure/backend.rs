//! A plotters backend that writes precise SVG.
//!
//! The one that comes with plotters rounds to whole pixels, which makes curves jagged, and knows neither dashes, nor line
//! joins, nor a title. Here a pixel has [`UNITS`] integer steps, so that plotters' integer coordinates are fine enough for print,
//! and what its styles cannot say (the dash) is set on the backend between two elements.

use super::{Svg, style};
use crate::report::text::{escape, lowered};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontStyle, FontTransform,
};
use std::convert::Infallible;
use std::fmt::Write as _;

/// Integer steps per pixel.
pub(super) const UNITS: f64 = 20.0;

/// The drawing so far.
pub(super) struct Backend {
    width: u32,
    height: u32,
    body: String,
    /// The dash of the lines to come, in pixels, as `stroke-dasharray` takes it.
    pub dash: Option<&'static str>,
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// A coordinate or length of the backend in pixels, without trailing zeros.
fn pixels(units: i32) -> String {
    let hundredths = i64::from(units) * (100.0 / UNITS) as i64;
    let mut printed = format!(
        "{}{}.{:02}",
        if hundredths < 0 { "-" } else { "" },
        hundredths.abs() / 100,
        hundredths.abs() % 100
    );
    while printed.ends_with('0') {
        printed.pop();
    }
    if printed.ends_with('.') {
        printed.pop();
    }
    printed
}

fn hex(colour: BackendColor) -> String {
    let (red, green, blue) = colour.rgb;
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn opacity(kind: &str, colour: BackendColor) -> String {
    if colour.alpha < 1.0 {
        format!(" {kind}-opacity=\"{:.2}\"", colour.alpha)
    } else {
        String::new()
    }
}

fn path(points: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut path = String::new();
    for (index, (x, y)) in points.into_iter().enumerate() {
        path.push(if index == 0 { 'M' } else { 'L' });
        let _ = write!(path, "{} {}", pixels(x), pixels(y));
    }
    path
}

impl Backend {
    /// An empty drawing of `width` × `height` pixels.
    pub fn new(width: f64, height: f64) -> Self {
        let units = |length: f64| (length * UNITS).round() as u32;
        Self {
            width: units(width),
            height: units(height),
            body: String::new(),
            dash: None,
        }
    }

    /// The document: `title` names it and `description` says what it shows, for those who do not see it.
    pub fn document(&self, title: &str, description: &str) -> Svg {
        let (width, height) = (pixels(self.width as i32), pixels(self.height as i32));
        Svg(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n\
             <title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
             <g font-family=\"{}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n{}</g>\n</svg>\n",
            escape(title),
            escape(description),
            style::FONTS,
            self.body,
        ))
    }

    /// A PNG file in base 64, stretched over a rectangle without smoothing.
    pub fn image(&mut self, corner: BackendCoord, size: BackendCoord, data: &str) {
        let _ = writeln!(
            self.body,
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>",
            pixels(corner.0),
            pixels(corner.1),
            pixels(size.0),
            pixels(size.1),
        );
    }

    fn stroke<S: BackendStyle>(&self, style: &S) -> String {
        let colour = style.color();
        let mut attributes = format!(
            " fill=\"none\" stroke=\"{}\"{}",
            hex(colour),
            opacity("stroke", colour)
        );
        let _ = write!(
            attributes,
            " stroke-width=\"{}\"",
            pixels(style.stroke_width() as i32)
        );
        if let Some(dash) = self.dash {
            let _ = write!(attributes, " stroke-dasharray=\"{dash}\"");
        }
        attributes
    }

    fn paint<S: BackendStyle>(&self, style: &S, fill: bool) -> String {
        if fill {
            let colour = style.color();
            format!(" fill=\"{}\"{}", hex(colour), opacity("fill", colour))
        } else {
            self.stroke(style)
        }
    }
}

impl DrawingBackend for Backend {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        self.draw_rect((x, y), (x + 1, y + 1), &colour, true)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let (x, y) = (from.0.min(to.0), from.1.min(to.1));
        let (width, height) = ((to.0 - from.0).abs(), (to.1 - from.1).abs());
        let paint = self.paint(style, fill);
        let _ = writeln!(
            self.body,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{paint}/>",
            pixels(x),
            pixels(y),
            pixels(width),
            pixels(height)
        );
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        points: I,
        style: &S,
    ) -> Drawn {
        let stroke = self.stroke(style);
        let _ = writeln!(self.body, "<path d=\"{}\"{stroke}/>", path(points));
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let paint = self.paint(style, fill);
        let _ = writeln!(
            self.body,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{paint}/>",
            pixels(x),
            pixels(y),
            pixels(radius as i32)
        );
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        points: I,
        style: &S,
    ) -> Drawn {
        let paint = self.paint(style, true);
        let _ = writeln!(self.body, "<path d=\"{}Z\"{paint}/>", path(points));
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &T,
        (x, y): BackendCoord,
    ) -> Drawn {
        let size = style.size();
        // Few renderers agree on `dominant-baseline`, so the baseline is computed: capitals are about 0.72 of the size high.
        let drop = match style.anchor().v_pos {
            VPos::Top => 0.72 * size,
            VPos::Center => 0.36 * size,
            VPos::Bottom => 0.0,
        }
        .round() as i32;
        let ((x, y), turn) = match style.transform() {
            FontTransform::None => ((x, y + drop), ""),
            FontTransform::Rotate90 => ((x - drop, y), "90"),
            FontTransform::Rotate180 => ((x, y - drop), "180"),
            FontTransform::Rotate270 => ((x + drop, y), "-90"),
        };
        let place = if turn.is_empty() {
            format!("x=\"{}\" y=\"{}\"", pixels(x), pixels(y))
        } else {
            format!(
                "transform=\"translate({} {}) rotate({turn})\"",
                pixels(x),
                pixels(y)
            )
        };
        let anchor = match style.anchor().h_pos {
            HPos::Left => "",
            HPos::Center => " text-anchor=\"middle\"",
            HPos::Right => " text-anchor=\"end\"",
        };
        let weight = match style.style() {
            FontStyle::Bold => " font-weight=\"600\"",
            FontStyle::Italic | FontStyle::Oblique => " font-style=\"italic\"",
            FontStyle::Normal => "",
        };
        let colour = style.color();
        let markup = raised(text, size / UNITS);
        // Some renderers drop spaces at the edges of spans unless told.
        let spaces = if markup.contains("<tspan") {
            " xml:space=\"preserve\""
        } else {
            ""
        };
        let _ = writeln!(
            self.body,
            "<text {place}{anchor}{weight}{spaces} font-size=\"{}\" fill=\"{}\"{}>{}</text>",
            pixels(size.round() as i32),
            hex(colour),
            opacity("fill", colour),
            markup,
        );
        Ok(())
    }
}

/// `text` escaped, superscript digits set as small raised ordinary ones: fonts draw the Unicode ones at uneven heights, or not at all.
fn raised(text: &str, size: f64) -> String {
    let mut markup = String::new();
    let mut run = String::new();
    let mut up = false;
    let mut was_up = false;
    let flush = |run: &mut String, up: bool, was_up: &mut bool, markup: &mut String| {
        if run.is_empty() {
            return;
        }
        // `dy` moves all that follows, so the first run after a raised one comes down again.
        let shift = 0.36 * size;
        if up {
            let _ = write!(
                markup,
                "<tspan dy=\"{:.2}\" font-size=\"{:.2}\">{}</tspan>",
                -shift,
                0.72 * size,
                escape(run)
            );
        } else if *was_up {
            let _ = write!(markup, "<tspan dy=\"{shift:.2}\">{}</tspan>", escape(run));
        } else {
            markup.push_str(&escape(run));
        }
        *was_up = up;
        run.clear();
    };
    for character in text.chars() {
        let plain = lowered(character);
        if plain.is_some() != up {
            flush(&mut run, up, &mut was_up, &mut markup);
            up = plain.is_some();
        }
        run.push(plain.unwrap_or(character));
    }
    flush(&mut run, up, &mut was_up, &mut markup);
    markup
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_pixels_without_trailing_zeros() {
        assert_eq!(pixels(0), "0");
        assert_eq!(pixels(21), "1.05");
        assert_eq!(pixels(-10), "-0.5");
        assert_eq!(pixels(4000), "200");
    }

    #[test]
    fn superscripts_become_raised_spans_and_the_line_comes_back_down() {
        assert_eq!(raised("plain", 10.0), "plain");
        assert_eq!(
            raised("10⁻³ < m²", 10.0),
            "10<tspan dy=\"-3.60\" font-size=\"7.20\">\u{2212}3</tspan><tspan dy=\"3.60\"> &lt; m</tspan>\
             <tspan dy=\"-3.60\" font-size=\"7.20\">2</tspan>"
        );
    }

    #[test]
    fn titles_cannot_break_out() {
        let document =
            Backend::new(10.0, 10.0).document("</title><script>alert(1)</script>", "\"'&");
        assert!(
            document
                .as_str()
                .contains("<title>&lt;/title&gt;&lt;script&gt;")
        );
        assert!(document.as_str().contains("<desc>&quot;&#39;&amp;</desc>"));
    }
}
