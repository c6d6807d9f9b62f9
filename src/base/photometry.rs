//! Photometry: what the three colours of light count to the eye.
//!
//! One convention, that of Radiance: 1 W/m² of white light (R = G = B = 1) counts 179 lm/m², and
//! the colours weigh as Rec. 709 says. It is stated wherever lux are shown ([`CONVENTION`]).

use serde::{Deserialize, Serialize};

/// Luminous efficacy of white light, lm/W (the convention of Radiance).
pub const LUMENS_PER_WATT: f32 = 179.0;
/// Weights of red, green and blue (Rec. 709); they add up to 1.
pub const WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];
/// Illuminance of an irradiance as a formula, for people.
pub const FORMULA: &str = "179 lm/W × (0.2126 R + 0.7152 G + 0.0722 B)";
/// The convention, for people.
pub const CONVENTION: &str =
    "1 lx = 1 lm/m²; lumens = 179 lm/W × (0.2126 R + 0.7152 G + 0.0722 B), the convention of Radiance";

/// The mean of the three colours as the eye weighs them, in the unit of the colours.
pub fn weighted([r, g, b]: [f32; 3]) -> f32 {
    WEIGHTS[0] * r + WEIGHTS[1] * g + WEIGHTS[2] * b
}

/// Illuminance, lx, of an irradiance E, W/m²; luminous exitance, lm/m², of a radiosity B.
pub fn lux(light: [f32; 3]) -> f32 {
    LUMENS_PER_WATT * weighted(light)
}

/// Quantity that is read off a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Quantity {
    /// Irradiance E: what arrives.
    #[default]
    Irradiance,
    /// Radiosity B: what leaves.
    Radiosity,
}

impl Quantity {
    /// Name and symbol of the quantity.
    pub fn name(self) -> &'static str {
        match self {
            Self::Irradiance => "irradiance E",
            Self::Radiosity => "radiosity B",
        }
    }

    /// Name and symbol of the quantity in a unit: photometric or radiometric.
    pub fn name_in(self, unit: Unit) -> &'static str {
        match (self, unit) {
            (_, Unit::Watts) => self.name(),
            (Self::Irradiance, Unit::Lumens) => "illuminance E",
            (Self::Radiosity, Unit::Lumens) => "luminous exitance B",
        }
    }
}

/// Unit of readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Unit {
    /// lx of what arrives, lm/m² of what leaves.
    #[default]
    Lumens,
    /// W/m², the three colours weighed as the eye does.
    Watts,
}

impl Unit {
    /// Value of 1 W/m² in this unit.
    pub fn per_watt(self) -> f32 {
        match self {
            Self::Lumens => LUMENS_PER_WATT,
            Self::Watts => 1.0,
        }
    }

    /// Sign of the unit for a quantity.
    pub fn sign(self, quantity: Quantity) -> &'static str {
        match (self, quantity) {
            (Self::Watts, _) => "W/m²",
            (Self::Lumens, Quantity::Irradiance) => "lx",
            (Self::Lumens, Quantity::Radiosity) => "lm/m²",
        }
    }
}

/// Unit or scale that the values of a reading are shown in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShownIn {
    /// Light, in a unit.
    Unit(Unit),
    /// The daylight factor: light as a share of what reaches open ground under the same sky, %.
    DaylightFactor {
        /// Irradiance of open horizontal ground, W/m², weighted as the eye does.
        open_ground: f32,
    },
}

impl ShownIn {
    /// Value that 1 W/m² has in this unit.
    pub fn per_watt(self) -> f32 {
        match self {
            Self::Unit(unit) => unit.per_watt(),
            Self::DaylightFactor { open_ground } => 100.0 / open_ground,
        }
    }

    /// The sign behind a value of a quantity.
    pub fn sign(self, quantity: Quantity) -> &'static str {
        match self {
            Self::Unit(unit) => unit.sign(quantity),
            Self::DaylightFactor { .. } => "%",
        }
    }

    /// The name and symbol of a quantity.
    pub fn name(self, quantity: Quantity) -> &'static str {
        match self {
            Self::Unit(unit) => quantity.name_in(unit),
            Self::DaylightFactor { .. } => "daylight factor D",
        }
    }

    /// How its values come about, for people.
    pub fn remark(self) -> &'static str {
        match self {
            Self::Unit(Unit::Lumens) => FORMULA,
            Self::Unit(Unit::Watts) => "weighted by the eye",
            Self::DaylightFactor { .. } => "illuminance over that of open ground under the same sky",
        }
    }
}

/// Colour temperatures for which [`tint_of_temperature`] is defined, K.
pub const TEMPERATURES: std::ops::RangeInclusive<f32> = 1667.0..=25_000.0;

/// The linear RGB colour of a black body, its largest channel 1: the cubic approximation of
/// Planck's locus by Kim et al., US patent 7024034 (2002), in sRGB primaries; a channel outside of
/// these is 0.
pub fn tint_of_temperature(kelvin: f32) -> [f32; 3] {
    let t = f64::from(kelvin.clamp(*TEMPERATURES.start(), *TEMPERATURES.end()));
    let cubic = |[a, b, c, d]: [f64; 4], x: f64| ((a * x + b) * x + c) * x + d;
    let x = match t {
        ..4000.0 => cubic([-0.266_123_9e9, -0.234_358_9e6, 0.877_695_6e3, 0.179_910], 1.0 / t),
        _ => cubic([-3.025_846_9e9, 2.107_037_9e6, 0.222_634_7e3, 0.240_390], 1.0 / t),
    };
    let y = match t {
        ..2222.0 => cubic([-1.106_381_4, -1.348_110_2, 2.185_558_32, -0.202_196_83], x),
        ..4000.0 => cubic([-0.954_947_6, -1.374_185_93, 2.091_370_15, -0.167_488_67], x),
        _ => cubic([3.081_758, -5.873_386_7, 3.751_129_97, -0.370_014_83], x),
    };
    let (big_x, big_z) = (x / y, (1.0 - x - y) / y);
    let rgb = [
        3.240_454_2 * big_x - 1.537_138_5 - 0.498_531_4 * big_z,
        -0.969_266 * big_x + 1.876_010_8 + 0.041_556 * big_z,
        0.055_643_4 * big_x - 0.204_025_9 + 1.057_225_2 * big_z,
    ];
    let most = rgb.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    rgb.map(|channel| (channel.max(0.0) / most) as f32)
}

/// The temperature whose colour is nearest to a tint, K, and how far that is off, as the largest
/// difference of a channel.
pub fn temperature_of_tint(tint: [f32; 3]) -> (f32, f32) {
    let off = |kelvin: f32| {
        let of = tint_of_temperature(kelvin);
        of.into_iter().zip(tint).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    // In steps of equal reciprocals, which look alike.
    let (low, high) = (1.0 / TEMPERATURES.end(), 1.0 / TEMPERATURES.start());
    let steps = (0..=800).map(|step| 1.0 / (low + (high - low) * step as f32 / 800.0));
    let nearest = steps.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(6500.0);
    (nearest, off(nearest))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the convention's definition.
    #[test]
    fn white_light_counts_179_lumens_and_green_most_of_them() {
        assert!((lux([1.0; 3]) - 179.0).abs() < 1e-4);
        let [red, green, blue] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(lux);
        assert!(green > red && red > blue && (red + green + blue - 179.0).abs() < 1e-3);
        assert!(CONVENTION.contains(FORMULA));
        assert_eq!(Unit::Lumens.per_watt() * weighted([2.0; 3]), lux([2.0; 3]));
    }

    /// Truth: the chromaticity of CIE illuminant A, 2856 K, and of daylight-like white; a
    /// temperature comes back from its colour.
    #[test]
    fn colour_temperatures() {
        let chromaticity = |[r, g, b]: [f32; 3]| {
            let x = 0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b;
            let y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175 * b;
            let z = 0.019_333_9 * r + 0.119_192 * g + 0.950_304_1 * b;
            [x / (x + y + z), y / (x + y + z)]
        };
        let [x, y] = chromaticity(tint_of_temperature(2856.0));
        assert!((x - 0.447_58).abs() < 1e-3 && (y - 0.407_45).abs() < 1e-3, "{x} {y}");
        assert!(tint_of_temperature(6500.0).into_iter().all(|channel| channel > 0.93));
        for kelvin in [2000.0, 2700.0, 4000.0, 6500.0, 10_000.0] {
            let (found, off) = temperature_of_tint(tint_of_temperature(kelvin));
            assert!((found / kelvin - 1.0).abs() < 0.02 && off < 0.02, "{kelvin} K: {found} K");
        }
        assert!(temperature_of_tint([0.0, 1.0, 0.0]).1 > 0.2, "green is no temperature");
    }
}
