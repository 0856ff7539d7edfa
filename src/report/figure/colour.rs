//! Colours for numbers: one ramp for amounts, one with a middle for signed errors.

use plotters::style::RGBColor;

/// How values become colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// From dark to light: densities and other amounts, from zero or the least up to the greatest.
    #[default]
    Amount,
    /// Blue below zero, white at zero, red above; as far to one side as to the other.
    Signed,
    /// From paper to ink: dots.
    Ink,
}

/// Ten of the colours of viridis, equally spaced. [Smith & van der Walt 2015, matplotlib]
const VIRIDIS: [u32; 10] = [
    0x44_01_54, 0x48_28_78, 0x3e_49_89, 0x31_68_8e, 0x26_82_8e, 0x1f_9e_89, 0x35_b7_79, 0x6e_ce_58,
    0xb5_de_2b, 0xfd_e7_25,
];

/// The eleven colours of `RdBu`, from blue to red. [Brewer 2002, ColorBrewer]
const DIVERGING: [u32; 11] = [
    0x05_30_61, 0x21_66_ac, 0x43_93_c3, 0x92_c5_de, 0xd1_e5_f0, 0xf7_f7_f7, 0xfd_db_c7, 0xf4_a5_82,
    0xd6_60_4d, 0xb2_18_2b, 0x67_00_1f,
];

/// Paper and the ink of lines.
const INK: [u32; 2] = [0xff_ff_ff, 0x26_26_26];

impl Colours {
    /// The colour at `place`, 0 to 1 along the ramp.
    pub(super) fn at(self, place: f64) -> RGBColor {
        let ramp: &[u32] = match self {
            Self::Amount => &VIRIDIS,
            Self::Signed => &DIVERGING,
            Self::Ink => &INK,
        };
        let t = place.clamp(0.0, 1.0) * (ramp.len() - 1) as f64;
        let below = (t as usize).min(ramp.len() - 2);
        let share = t - below as f64;
        let channel = |shift: u32| {
            let of = |colour: u32| f64::from((colour >> shift) & 0xff);
            let (from, to) = (of(ramp[below]), of(ramp[below + 1]));
            share.mul_add(to - from, from).round() as u8
        };
        RGBColor(channel(16), channel(8), channel(0))
    }

    /// Whether dark lines show on the colour at `place` better than light ones.
    pub(super) fn is_light(self, place: f64) -> bool {
        let RGBColor(red, green, blue) = self.at(place);
        // relative luminance, roughly [ITU-R BT.709]
        0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue) > 125.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_end_where_they_should_and_grow_lighter() {
        assert_eq!(Colours::Amount.at(0.0), RGBColor(0x44, 0x01, 0x54));
        assert_eq!(Colours::Amount.at(1.0), RGBColor(0xfd, 0xe7, 0x25));
        assert_eq!(Colours::Signed.at(0.5), RGBColor(0xf7, 0xf7, 0xf7));
        assert_eq!(
            Colours::Amount.at(f64::NAN.max(0.0)),
            RGBColor(0x44, 0x01, 0x54)
        );
        let light = |t: f64| {
            let RGBColor(r, g, b) = Colours::Amount.at(t);
            0.21 * f64::from(r) + 0.72 * f64::from(g) + 0.07 * f64::from(b)
        };
        assert!((0..100).all(|i| light(f64::from(i) / 100.0) < light(f64::from(i + 1) / 100.0)));
    }
}
