//! The CIE general sky [CIE S 011:2003; Darula, Kittler 2002]: its luminance by the angles to the zenith and to the sun.

/// Coefficients a to e of the 15 standard skies: gradation towards the horizon (a, b) and scattering about the sun (c, d, e).
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

/// How the luminance of a sky is spread, up to a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Alike from everywhere above the horizon.
    Uniform,
    /// The traditional overcast sky (type 16 of CIE S 011): three times as bright in the zenith as at the horizon [Moon, Spencer 1942].
    Overcast,
    /// One of the 15 standard skies, by its number.
    Standard(u8),
}

impl Spread {
    /// Whether the sky's luminance depends on where the sun is.
    pub fn needs_sun(self) -> bool {
        matches!(self, Self::Standard(number) if STANDARD[usize::from(number) - 1][2] != 0.0)
    }

    /// Luminance at a sine of the elevation and a cosine of the angle to the sun, up to a factor; 0 below the horizon.
    pub fn at(self, elevation_sine: f64, sun_cosine: f64) -> f64 {
        if elevation_sine < 0.0 {
            return 0.0;
        }
        match self {
            Self::Uniform => 1.0,
            Self::Overcast => (1.0 + 2.0 * elevation_sine) / 3.0,
            Self::Standard(number) => {
                let [a, b, c, d, e] = STANDARD[usize::from(number) - 1];
                let gradation = 1.0 + a * (b / elevation_sine.max(1e-6)).exp();
                let angle = sun_cosine.clamp(-1.0, 1.0).acos();
                let scattered = (d * angle).exp() - (d * std::f64::consts::FRAC_PI_2).exp();
                (gradation * (1.0 + c * scattered + e * sun_cosine * sun_cosine)).max(0.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definitions: a zenith three times as bright as the horizon; for type 1, (1 + 4e^−0.7) / 1 = 2.986; for type 5
    /// a uniform sky; a clear sky is brightest at the sun and darkest about 90° from it.
    #[test]
    fn skies_are_spread_as_their_definitions_say() {
        let ratio = |spread: Spread| spread.at(1.0, 0.0) / spread.at(0.0, 0.0);
        assert!((ratio(Spread::Overcast) - 3.0).abs() < 1e-12);
        assert!((ratio(Spread::Standard(1)) - (1.0 + 4.0 * (-0.7_f64).exp())).abs() < 1e-9);
        assert!((ratio(Spread::Standard(5)) - 1.0).abs() < 1e-12);
        let clear = |angle: f64| Spread::Standard(CLEAR).at(0.7, angle.cos());
        assert!(clear(0.0) > 5.0 * clear(0.8) && clear(0.8) > clear(1.6) && clear(2.9) > clear(1.6));
        assert_eq!(Spread::Uniform.at(-0.01, 0.0), 0.0);
        assert!(Spread::Standard(CLEAR).needs_sun() && !Spread::Standard(1).needs_sun());
    }
}
