//! The CIE general sky [CIE S 011:2003; Darula, Kittler 2002]: its luminance by the angles to the
//! zenith and to the sun.

use super::perez;

/// Coefficients a to e of the 15 standard skies: gradation towards the horizon (a, b) and
/// scattering about the sun (c, d, e).
const STANDARD: [[f64; 5]; 15] = [
    [4.0, -0.70, 0.0, -1.0, 0.00],
    [4.0, -0.70, 2.0, -1.5, 0.15],
    [1.1, -0.80, 0.0, -1.0, 0.00],
    [1.1, -0.80, 2.0, -1.5, 0.15],
    [0.0, -1.00, 0.0, -1.0, 0.00],
    [0.0, -1.00, 2.0, -1.5, 0.15],
    [0.0, -1.00, 5.0, -2.5, 0.30],
    [0.0, -1.00, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.30],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

/// The number of the standard clear sky with little turbidity.
pub const CLEAR: u8 = 12;

/// Distribution of the luminance over a sky, up to a factor [CIE S 011].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LuminanceDistribution {
    /// Alike from everywhere above the horizon.
    Uniform,
    /// The traditional overcast sky (type 16 of CIE S 011): three times as bright in the zenith as
    /// at the horizon [Moon, Spencer 1942].
    Overcast,
    /// One of the 15 standard skies, by its number.
    Standard(u8),
    /// The general sky by its coefficients a to e.
    General([f64; 5]),
    /// By the weather: the sun's irradiance of a face turned to it and the sky's of open ground,
    /// W/m² of all radiation.
    Weather {
        /// By the sun.
        direct: f32,
        /// By the sky.
        diffuse: f32,
    },
}

impl LuminanceDistribution {
    /// Whether the sky's luminance depends on where the sun is.
    pub fn needs_sun(self) -> bool {
        match self {
            Self::Uniform | Self::Overcast => false,
            Self::Standard(number) => Self::General(standard(number)).needs_sun(),
            Self::General([_, _, c, _, e]) => c != 0.0 || e != 0.0,
            Self::Weather { .. } => true,
        }
    }

    /// Formula of the sky under a sun of this elevation (radians).
    pub(super) fn under_sun(self, elevation: f64) -> Formula {
        match self {
            Self::Uniform => Formula::Uniform,
            Self::Overcast => Formula::Overcast,
            Self::Standard(number) => Formula::General(standard(number)),
            Self::General(coefficients) => Formula::General(coefficients),
            Self::Weather { direct, diffuse } => {
                Formula::General(perez::coefficients(direct.into(), diffuse.into(), elevation))
            }
        }
    }
}

/// Luminance over the sky, up to a factor.
#[derive(Clone, Copy, Debug)]
pub(super) enum Formula {
    Uniform,
    Overcast,
    General([f64; 5]),
}

impl Formula {
    /// Luminance at a sine of the elevation and a cosine of the angle to the sun; 0 below the
    /// horizon.
    pub fn at(self, elevation_sine: f64, sun_cosine: f64) -> f64 {
        if elevation_sine < 0.0 {
            return 0.0;
        }
        match self {
            Self::Uniform => 1.0,
            Self::Overcast => (1.0 + 2.0 * elevation_sine) / 3.0,
            Self::General(coefficients) => general(coefficients, elevation_sine, sun_cosine),
        }
    }
}

fn standard(number: u8) -> [f64; 5] {
    STANDARD[usize::from(number) - 1]
}

fn general([a, b, c, d, e]: [f64; 5], elevation_sine: f64, sun_cosine: f64) -> f64 {
    let gradation = 1.0 + a * (b / elevation_sine.max(1e-6)).exp();
    let angle = sun_cosine.clamp(-1.0, 1.0).acos();
    let scattered = (d * angle).exp() - (d * std::f64::consts::FRAC_PI_2).exp();
    (gradation * (1.0 + c * scattered + e * sun_cosine * sun_cosine)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definitions: a zenith three times as bright as the horizon; for type 1, (1 +
    /// 4e^−0.7) / 1 = 2.986; for type 5 a uniform sky; a clear sky is brightest at the sun and
    /// darkest about 90° from it.
    #[test]
    fn skies_are_spread_as_their_definitions_say() {
        let ratio = |distribution: LuminanceDistribution| {
            let formula = distribution.under_sun(0.8);
            formula.at(1.0, 0.0) / formula.at(0.0, 0.0)
        };
        assert!((ratio(LuminanceDistribution::Overcast) - 3.0).abs() < 1e-12);
        assert!((ratio(LuminanceDistribution::Standard(1)) - (1.0 + 4.0 * (-0.7_f64).exp())).abs() < 1e-9);
        assert!((ratio(LuminanceDistribution::Standard(5)) - 1.0).abs() < 1e-12);
        let clear = |angle: f64| LuminanceDistribution::Standard(CLEAR).under_sun(0.8).at(0.7, angle.cos());
        assert!(clear(0.0) > 5.0 * clear(0.8) && clear(0.8) > clear(1.6) && clear(2.9) > clear(1.6));
        assert_eq!(LuminanceDistribution::Uniform.under_sun(0.8).at(-0.01, 0.0), 0.0);
        let [by_number, by_coefficients] =
            [LuminanceDistribution::Standard(CLEAR), LuminanceDistribution::General([-1.0, -0.32, 10.0, -3.0, 0.45])]
                .map(|distribution| distribution.under_sun(0.8));
        assert_eq!(by_number.at(0.3, 0.2), by_coefficients.at(0.3, 0.2));
        assert!(LuminanceDistribution::Standard(CLEAR).needs_sun() && !LuminanceDistribution::Standard(1).needs_sun());
    }
}
