//! From radiosity in W/m² to a colour on the screen: exposure, filmic tone curve, gamma.

use crate::solver::snapshot::Snapshot;

/// How bright the picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// [`auto_exposure`], corrected by a number of stops (powers of two).
    Auto {
        /// Correction, stops; positive is brighter.
        stops: f32,
    },
    /// By hand: 0 stops shows 1 W/m² as 1, before the tone curve.
    Manual {
        /// Base-2 logarithm of the factor on radiosities, stops.
        stops: f32,
    },
}

impl Default for Exposure {
    fn default() -> Self {
        Self::Auto { stops: 0.0 }
    }
}

impl Exposure {
    /// The factor on radiosities, m²/W, for a snapshot whose [`auto_exposure`] is `auto`.
    pub fn factor(self, auto: f32) -> f32 {
        match self {
            Self::Auto { stops } => auto * stops.exp2(),
            Self::Manual { stops } => stops.exp2(),
        }
    }
}

/// How radiosities become colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// How bright the picture is made.
    pub exposure: Exposure,
}

/// The factor on radiosities, m²/W, that exposes a snapshot well.
pub fn auto_exposure(_snapshot: &Snapshot) -> f32 {
    1.0
}

/// Filmic tone curve of one linear, exposed channel: 0..∞ to 0..1.
pub fn tone_curve(x: f32) -> f32 {
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
}

/// sRGB gamma encoding of one linear channel, 0..1 (IEC 61966-2-1).
pub fn encode_gamma(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
