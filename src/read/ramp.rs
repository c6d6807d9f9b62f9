//! Ramps of colour for quantities, legible to the colour-blind; gamma-encoded.

use serde::{Deserialize, Serialize};

/// The viridis ramp of matplotlib at ten even places (S. van der Walt, N. Smith 2015; public
/// domain).
pub const VIRIDIS: [[u8; 3]; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 74, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [109, 205, 89],
    [180, 222, 44],
    [253, 231, 37],
];

/// The cividis ramp at ten even places (J. R. Nuñez, C. R. Anderton, R. S. Renslow, "Optimizing
/// colormaps with consideration for color vision deficiency", PLoS ONE 13(7), 2018): looks all but
/// the same to people who do not tell red from green.
pub const CIVIDIS: [[u8; 3]; 10] = [
    [0, 34, 78],
    [18, 53, 112],
    [59, 73, 108],
    [87, 93, 109],
    [112, 113, 115],
    [138, 134, 120],
    [165, 156, 116],
    [195, 179, 105],
    [225, 204, 85],
    [254, 232, 56],
];

/// From blue over white to red: one side of zero and the other.
pub const BLUE_WHITE_RED: [[u8; 3]; 7] =
    [[24, 78, 160], [84, 146, 206], [170, 206, 232], [245, 245, 245], [248, 190, 160], [226, 110, 84], [168, 24, 40]];

/// Colour of surfaces about which nothing is known.
const UNKNOWN: [u8; 3] = [96, 96, 100];

/// A ramp from little to much that people may choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Ramp {
    /// [`VIRIDIS`].
    #[default]
    Viridis,
    /// [`CIVIDIS`].
    Cividis,
}

impl Ramp {
    /// Every ramp, with its name.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Viridis, "viridis"), (Self::Cividis, "cividis")];

    /// Colours of the ramp at even places.
    pub fn stops(self) -> &'static [[u8; 3]; 10] {
        match self {
            Self::Viridis => &VIRIDIS,
            Self::Cividis => &CIVIDIS,
        }
    }

    /// The colour at a place along it, as [`along_ramp`] says.
    pub fn at(self, along: f32) -> [u8; 3] {
        along_ramp(self.stops(), along)
    }
}

/// The colour at a place along a ramp, 0..=1; beyond its ends that of the end, grey where the place
/// is not a number.
pub fn along_ramp<const N: usize>(ramp: &[[u8; 3]; N], along: f32) -> [u8; 3] {
    if along.is_nan() {
        return UNKNOWN;
    }
    let place = along.clamp(0.0, 1.0) * (N - 1) as f32;
    let lower = (place as usize).min(N - 2);
    let mix = place - lower as f32;
    std::array::from_fn(|channel| {
        let (from, to) = (f32::from(ramp[lower][channel]), f32::from(ramp[lower + 1][channel]));
        (from + mix * (to - from)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_end_where_they_end() {
        assert_eq!(along_ramp(&VIRIDIS, -1.0), VIRIDIS[0]);
        assert_eq!(along_ramp(&VIRIDIS, 7.0), VIRIDIS[9]);
        assert_eq!(along_ramp(&BLUE_WHITE_RED, 0.5), [245, 245, 245]);
        assert_eq!(along_ramp(&VIRIDIS, f32::NAN), UNKNOWN);
    }

    /// Truth: more looks brighter, which those who see no colours at all rely on.
    #[test]
    fn ramps_get_brighter_all_along() {
        for (ramp, name) in Ramp::ALL {
            let brightness = |[r, g, b]: &[u8; 3]| 2 * u32::from(*r) + 7 * u32::from(*g) + u32::from(*b);
            assert!(ramp.stops().iter().map(brightness).is_sorted_by(|a, b| a < b), "{name}");
        }
    }
}
