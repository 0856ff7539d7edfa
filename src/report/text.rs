//! Numbers and names as printed: escaping, minus signs, powers of ten, significant digits, widths.
//!
//! Names come from users, through experiment files and CSV headers, so everything that reaches an SVG or a page goes
//! through [`escape`], whatever it is believed to contain.

use std::fmt::Write as _;

/// `text` with the five characters escaped that mean something in HTML and XML, in content and in quoted attributes alike.
///
/// What XML 1.0 cannot hold at all (control characters, the two non-characters of the basic plane) becomes U+FFFD, and so do
/// the controls that reorder text, which could make a name read as another one.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' | '\u{85}' | '\u{2028}' | '\u{2029}' => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
                escaped.push('\u{fffd}');
            }
            other if other.is_control() => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// `json` made safe inside a `<script>` element: `<`, `>`, `&` and the two line separators that scripts once broke at are
/// written as `\uXXXX`. Valid JSON holds these only inside strings, so the meaning stays.
pub fn escape_json(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for character in json.chars() {
        match character {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(escaped, "\\u{:04x}", character as u32);
            }
            other => escaped.push(other),
        }
    }
    escaped
}

/// `value` with `decimals` digits after the point, a true minus sign (U+2212), and narrow spaces between thousands from
/// five digits on.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return not_finite(value);
    }
    let plain = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = plain.split_once('.').unwrap_or((&plain, ""));
    let mut printed = String::new();
    if value < 0.0 && plain.bytes().any(|byte| (b'1'..=b'9').contains(&byte)) {
        printed.push('\u{2212}');
    }
    for (place, digit) in whole.chars().enumerate() {
        if whole.len() > 4 && place > 0 && (whole.len() - place).is_multiple_of(3) {
            printed.push('\u{202f}');
        }
        printed.push(digit);
    }
    if !fraction.is_empty() {
        printed.push('.');
        printed.push_str(fraction);
    }
    printed
}

/// `text` with true minus signs: each hyphen that a number follows and no letter, digit or hyphen precedes.
pub fn minus(text: &str) -> String {
    let mut printed = String::with_capacity(text.len());
    let mut before = ' ';
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        let apart = !(before.is_alphanumeric() || before == '-' || before == '\u{2212}');
        let number = characters.peek().is_some_and(char::is_ascii_digit);
        let sign = character == '-' && apart && number;
        printed.push(if sign { '\u{2212}' } else { character });
        before = character;
    }
    printed
}

/// `value` to `digits` significant digits: plain between 0.001 and 99 999, else as `4.57 × 10⁻⁵`.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return not_finite(value);
    }
    if value == 0.0 {
        return "0".into();
    }
    let exponent = exponent(value, digits);
    if (-3..5).contains(&exponent) {
        fixed(value, decimals(exponent, digits))
    } else {
        scientific(value, digits)
    }
}

/// `value` as a number below ten times a power of ten.
fn scientific(value: f64, digits: usize) -> String {
    let exponent = exponent(value, digits);
    let mantissa = value / 10f64.powi(exponent);
    format!(
        "{}\u{202f}×\u{202f}{}",
        fixed(mantissa, digits.saturating_sub(1)),
        power(exponent)
    )
}

/// `value` with its standard error, to the error's second digit: `0.00457 ± 0.00031`, or `(4.57 ± 0.31) × 10⁻⁵`.
pub fn uncertain(value: f64, error: f64) -> String {
    if !(value.is_finite() && error.is_finite() && error > 0.0) {
        return significant(value, 4);
    }
    let last = exponent(error, 2) - 1;
    let size = exponent(value.abs().max(error), 4).max(last);
    let plain = (-3..5).contains(&size);
    let power_of_ten = if plain { 0 } else { size };
    let digits = decimals(last - power_of_ten, 1);
    let print = |number: f64| fixed(number / 10f64.powi(power_of_ten), digits);
    let pair = format!("{} ± {}", print(value), print(error));
    if plain {
        pair
    } else {
        format!("({pair})\u{202f}×\u{202f}{}", power(power_of_ten))
    }
}

/// Digits after the point so that a number of this power of ten shows `digits` significant ones.
pub(super) fn decimals(exponent: i32, digits: usize) -> usize {
    (digits as i32 - 1 - exponent).clamp(0, 17) as usize
}

/// The power of ten of `value` after rounding it to `digits` significant digits; 0 for 0.
pub(super) fn exponent(value: f64, digits: usize) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    let rounded = format!("{:.*e}", digits.max(1) - 1, value);
    rounded
        .rsplit_once('e')
        .and_then(|(_, power)| power.parse().ok())
        .unwrap_or(0)
}

fn not_finite(value: f64) -> String {
    match (value.is_nan(), value > 0.0) {
        (true, _) => "–".into(),
        (false, true) => "∞".into(),
        (false, false) => "\u{2212}∞".into(),
    }
}

/// How the numbers of a column are printed: all in one power of ten and to the same digit, so that they line up, unless they lie too
/// far apart for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    power: i32,
    decimals: Option<usize>,
    digits: usize,
}

impl Column {
    /// For numbers with or without a standard error. An error shows two digits; a number without one shows `digits`.
    pub fn of(numbers: impl IntoIterator<Item = (f64, Option<f64>)>, digits: usize) -> Self {
        let mut largest: Option<i32> = None;
        let mut finest: Option<i32> = None;
        for (value, error) in numbers {
            if !value.is_finite() {
                continue;
            }
            let error = error.filter(|error| error.is_finite() && *error > 0.0);
            if value != 0.0 || error.is_some() {
                let size = exponent(value.abs().max(error.unwrap_or(0.0)), digits);
                largest = Some(largest.map_or(size, |most| most.max(size)));
                let last = error.map_or(size + 1 - digits as i32, |error| exponent(error, 2) - 1);
                finest = Some(finest.map_or(last, |least| least.min(last)));
            }
        }
        let (largest, finest) = (largest.unwrap_or(0), finest.unwrap_or(0));
        if largest - finest > 5 {
            return Self {
                power: 0,
                decimals: None,
                digits,
            };
        }
        let power = if (-1..5).contains(&largest) {
            0
        } else {
            largest
        };
        Self {
            power,
            decimals: Some(decimals(finest - power, 1)),
            digits,
        }
    }

    /// A number of the column.
    pub fn print(&self, value: f64) -> String {
        match self.decimals {
            Some(decimals) => fixed(value / 10f64.powi(self.power), decimals),
            // All in the same notation, so that the powers can be compared.
            None if value != 0.0 && value.is_finite() => scientific(value, self.digits),
            None => significant(value, self.digits),
        }
    }

    /// Whether the numbers line up.
    pub fn is_aligned(&self) -> bool {
        self.decimals.is_some()
    }

    /// What the heading must add: ` / 10⁻³`, or nothing.
    pub fn scale(&self) -> String {
        if self.power == 0 {
            String::new()
        } else {
            format!(" / {}", power(self.power))
        }
    }
}

/// Ten to a power, with superscript digits: `10⁻³`.
pub fn power(exponent: i32) -> String {
    let mut printed = String::from("10");
    for character in exponent.to_string().chars() {
        printed.push(match character {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
        });
    }
    printed
}

/// The plain character of a superscript, if it is one.
pub(super) fn lowered(character: char) -> Option<char> {
    Some(match character {
        '⁻' => '\u{2212}',
        '⁰' => '0',
        '¹' => '1',
        '²' => '2',
        '³' => '3',
        '⁴'..='⁹' => char::from_digit(character as u32 - 0x2070, 10)?,
        _ => return None,
    })
}

/// Advance widths of printable ASCII in thousandths of the size: of each character that of Helvetica or that of DejaVu Sans, whichever is wider. Arial and Liberation
/// Sans share Helvetica's and Source Sans is narrower; DejaVu Sans, which stands in where none of them is installed, is the widest in common use.
#[rustfmt::skip]
const ADVANCE: [u16; 95] = [
    318, 401, 460, 838, 637, 951, 780, 275, 391, 391, 500, 838, 318, 361, 318, 337,
    637, 637, 637, 637, 637, 637, 637, 637, 637, 637, 337, 337, 838, 838, 838, 556,
    1015, 685, 687, 722, 771, 667, 611, 778, 752, 295, 500, 667, 558, 863, 749, 788,
    667, 788, 722, 667, 611, 732, 685, 989, 686, 667, 686, 391, 337, 391, 838, 556,
    500, 613, 635, 550, 635, 616, 353, 635, 634, 278, 278, 580, 278, 975, 634, 612,
    635, 635, 412, 521, 393, 634, 592, 818, 592, 592, 525, 637, 337, 637, 838,
];

/// How much wider the semibold of titles is than the weight that is measured.
pub(super) const BOLDER: f64 = 1.13;

/// How wide `text` will be at `size`, for placing labels; wide scripts count a full em.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|character| match character {
            ' '..='~' => f64::from(ADVANCE[character as usize - 32]) / 1000.0,
            '\u{202f}' | '\u{2009}' => 0.2,
            '\u{2212}' | '×' | '±' => 0.84,
            '\u{300}'..='\u{36f}' | '\u{200b}'..='\u{200f}' => 0.0,
            '\u{1100}'..='\u{11ff}' | '\u{2e80}'..='\u{ffdc}' | '\u{1f000}'.. => 1.05,
            '…' => 1.0,
            '⁻' => 0.61,
            other if lowered(other).is_some() => 0.46,
            other if other.is_uppercase() => 0.75,
            _ => 0.65,
        })
        .sum();
    em * size
}

/// `text`, shortened with an ellipsis where it would be wider than `limit`.
pub(super) fn fit(text: &str, size: f64, limit: f64) -> String {
    if width(text, size) <= limit {
        return text.to_owned();
    }
    let mut kept = String::new();
    for character in text.chars() {
        kept.push(character);
        if width(&kept, size) + size > limit {
            kept.pop();
            break;
        }
    }
    format!("{}…", kept.trim_end())
}

/// `text` and a `value` behind it, together at most `limit` wide: the value stays whole, and the text is shortened for it.
pub(super) fn fit_with(text: &str, value: &str, size: f64, limit: f64) -> String {
    fit(text, size, limit - width(value, size)) + value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_stays_whole_behind_a_name_that_is_shortened() {
        let long = fit_with("a kernel of a very long name", ", −0.647", 10.0, 120.0);
        assert!(
            long.ends_with("…, −0.647") && long.starts_with("a kernel"),
            "{long}"
        );
        assert!(width(&long, 10.0) <= 120.0 && width(&long, 10.0) > 100.0);
        assert_eq!(fit_with("short", ": 2 %", 10.0, 120.0), "short: 2 %");
    }

    #[test]
    fn escapes_what_markup_would_read() {
        assert_eq!(
            escape("<a href='x' title=\"&\">"),
            "&lt;a href=&#39;x&#39; title=&quot;&amp;&quot;&gt;"
        );
        assert_eq!(
            escape("a\u{0}b\u{1b}c\u{202e}d\u{2028}e"),
            "a\u{fffd}b\u{fffd}c\u{fffd}d e"
        );
        assert_eq!(escape("ĥ = 0.3 µm, 密度"), "ĥ = 0.3 µm, 密度");
    }

    #[test]
    fn json_stays_the_same_value_inside_a_script() {
        let value =
            serde_json::json!({ "name": "</script><!-- & \u{2028}\u{2029}", "x": [1.5, -2e-9] });
        let escaped = escape_json(&value.to_string());
        assert!(!escaped.contains(['<', '>', '&', '\u{2028}', '\u{2029}']));
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&escaped).expect("still JSON"),
            value
        );
    }

    #[test]
    fn hyphens_before_numbers_become_minus_signs() {
        assert_eq!(minus("from -5 to -0.25"), "from \u{2212}5 to \u{2212}0.25");
        assert_eq!(minus("(-1, -2)"), "(\u{2212}1, \u{2212}2)");
        for same in [
            "bias-compensated",
            "1e-5",
            "2020-01-02",
            "a - b",
            "mw-10",
            "--5",
            "-",
        ] {
            assert_eq!(minus(same), same);
        }
    }

    #[test]
    fn numbers_read_as_in_print() {
        assert_eq!(fixed(-1234.5, 1), "\u{2212}1234.5");
        assert_eq!(fixed(-0.001, 1), "0.0");
        assert_eq!(fixed(1_234_567.0, 0), "1\u{202f}234\u{202f}567");
        assert_eq!(significant(0.004_570_3, 3), "0.00457");
        assert_eq!(significant(0.000_999_96, 3), "0.00100");
        assert_eq!(significant(4.57e-5, 3), "4.57\u{202f}×\u{202f}10⁻⁵");
        assert_eq!(significant(-2.0e10, 2), "\u{2212}2.0\u{202f}×\u{202f}10¹⁰");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::NAN, 3), "–");
    }

    #[test]
    fn an_error_decides_how_many_digits_are_shown() {
        assert_eq!(uncertain(0.004_570_3, 0.000_031), "0.004570 ± 0.000031");
        assert_eq!(
            uncertain(4.5703e-5, 3.1e-6),
            "(4.57 ± 0.31)\u{202f}×\u{202f}10⁻⁵"
        );
        assert_eq!(uncertain(123.4, 25.0), "123 ± 25");
        assert_eq!(uncertain(0.5, 0.0), "0.5000");
    }

    #[test]
    fn the_numbers_of_a_column_line_up() {
        let column = Column::of([(4.5703e-3, Some(3.1e-5)), (1.2978e-2, Some(2.0e-4))], 4);
        assert_eq!(
            (
                column.print(4.5703e-3),
                column.print(1.2978e-2),
                column.scale()
            ),
            ("0.4570".into(), "1.2978".into(), " / 10⁻²".to_owned())
        );
        let column = Column::of([(4.5703e-5, None), (1.2978e-4, None)], 3);
        assert_eq!(
            (column.print(4.5703e-5), column.print(1.2978e-4)),
            ("0.457".into(), "1.298".into())
        );
        assert_eq!(column.scale(), " / 10⁻⁴");
        let column = Column::of([(200.0, None), (1000.0, None), (0.0, None)], 3);
        assert_eq!(
            (column.print(200.0), column.print(0.0)),
            ("200".into(), "0".into())
        );
        let column = Column::of([(1.0, None), (1e-12, None)], 3);
        assert_eq!(
            (column.print(1.0), column.print(1e-12)),
            (
                "1.00\u{202f}×\u{202f}10⁰".into(),
                "1.00\u{202f}×\u{202f}10⁻¹²".into()
            )
        );
        assert_eq!(Column::of([], 3).print(f64::NAN), "–");
    }

    #[test]
    fn long_names_are_shortened_to_the_room_there_is() {
        assert_eq!(fit("short", 10.0, 100.0), "short");
        let fitted = fit(&"wide name ".repeat(20), 10.0, 120.0);
        assert!(
            fitted.ends_with('…') && width(&fitted, 10.0) <= 120.0 && fitted.len() > 12,
            "{fitted}"
        );
        assert_eq!(fit("anything", 10.0, 0.0), "…");
    }
}
