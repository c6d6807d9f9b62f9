//! Photometry: what the three colours of light count to the eye.
//!
//! One convention, that of Radiance: 1 W/m² of white light (R = G = B = 1) counts 179 lm/m², and the colours weigh as Rec. 709 says. It is
//! stated wherever lux are shown ([`CONVENTION`]). Imports nothing.

use serde::{Deserialize, Serialize};

/// Luminous efficacy of white light, lm/W (the convention of Radiance).
pub const LUMENS_PER_WATT: f32 = 179.0;
/// What red, green and blue weigh (Rec. 709); they add up to 1.
pub const WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];
/// The same as a formula, for people.
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

/// What is read off a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Quantity {
    /// Irradiance E: what arrives.
    #[default]
    Irradiance,
    /// Radiosity B: what leaves.
    Radiosity,
}

impl Quantity {
    /// Its name and symbol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Irradiance => "irradiance E",
            Self::Radiosity => "radiosity B",
        }
    }

    /// Its name and symbol where the eye's light is counted.
    pub fn name_in(self, unit: Unit) -> &'static str {
        match (self, unit) {
            (_, Unit::Watts) => self.name(),
            (Self::Irradiance, Unit::Lumens) => "illuminance E",
            (Self::Radiosity, Unit::Lumens) => "luminous exitance B",
        }
    }
}

/// What readings are counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Unit {
    /// lx of what arrives, lm/m² of what leaves.
    #[default]
    Lumens,
    /// W/m², the three colours weighed as the eye does.
    Watts,
}

impl Unit {
    /// What 1 W/m² counts in this unit.
    pub fn per_watt(self) -> f32 {
        match self {
            Self::Lumens => LUMENS_PER_WATT,
            Self::Watts => 1.0,
        }
    }

    /// Its sign, for a quantity.
    pub fn sign(self, quantity: Quantity) -> &'static str {
        match (self, quantity) {
            (Self::Watts, _) => "W/m²",
            (Self::Lumens, Quantity::Irradiance) => "lx",
            (Self::Lumens, Quantity::Radiosity) => "lm/m²",
        }
    }
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
}
