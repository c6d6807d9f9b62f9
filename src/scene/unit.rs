//! The length unit of a file: given by it, by its sidecar or by a person, else guessed by the size
//! of a room.

use serde::{Deserialize, Serialize};

/// A length unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Unit {
    /// Metres, as glTF has it.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetre,
    /// Inches of 2.54 cm.
    #[serde(rename = "in")]
    Inch,
    /// Feet of 30.48 cm.
    #[serde(rename = "ft")]
    Foot,
}

/// A scene that is higher than this, in metres, is none in metres.
const HIGHEST: f64 = 60.0;

/// The height and the width of a usual room, m.
const USUAL: [f64; 2] = [2.8, 7.0];

/// Nobody stands upright below this height, m.
const LOWEST: f64 = 2.2;

/// Most things take up more than this share of a room's extents.
pub(super) const BELOW_A_SKY: f64 = 0.2;

impl Unit {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Metre, Self::Centimetre, Self::Millimetre, Self::Inch, Self::Foot];

    /// Symbol of the unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Inch => "in",
            Self::Foot => "ft",
        }
    }

    /// Name of the unit in the plural.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "metres",
            Self::Centimetre => "centimetres",
            Self::Millimetre => "millimetres",
            Self::Inch => "inches",
            Self::Foot => "feet",
        }
    }

    /// The unit with this symbol.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.symbol() == symbol)
    }

    /// Length of the unit, m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }

    /// The unit that a comment of an OBJ file tells: `File units = inches`, `units: mm`.
    pub(super) fn of_comment(comment: &str) -> Option<Self> {
        let comment = comment.to_lowercase();
        let (before, behind) = comment.split_once(['=', ':'])?;
        if !matches!(before.split_whitespace().next_back(), Some("unit" | "units")) {
            return None;
        }
        match behind.split_whitespace().next()?.trim_matches(|letter: char| !letter.is_alphabetic()) {
            "m" | "meter" | "meters" | "metre" | "metres" => Some(Self::Metre),
            "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Some(Self::Centimetre),
            "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Some(Self::Millimetre),
            "in" | "inch" | "inches" => Some(Self::Inch),
            "ft" | "foot" | "feet" => Some(Self::Foot),
            _ => None,
        }
    }

    /// The unit in which a scene of this height and width is most like a room, or the part where
    /// most things are if that is far smaller, as below a sky; metres wherever that may be.
    pub(super) fn guessed(all: [f64; 2], most: [f64; 2]) -> Self {
        if all[0] <= HIGHEST {
            return Self::Metre;
        }
        let unlikeness = |unit: &Self, size: [f64; 2]| {
            let [height, width] = size.map(|length| length * unit.metres());
            // A house is higher than a room, but no room is lower than a person.
            let too_low = 20.0 * (LOWEST / height).ln().max(0.0);
            too_low + (height / USUAL[0]).ln().max(0.0) + (width / USUAL[1]).ln().abs()
        };
        let is_below_a_sky = most.iter().zip(all).all(|(most, all)| *most < BELOW_A_SKY * all);
        let sizes = if is_below_a_sky { [all, most] } else { [all, all] };
        let least = |unit: &Self| unlikeness(unit, sizes[0]).min(unlikeness(unit, sizes[1]));
        // Feet and metres cannot be distinguished by a room's size (but see `known_sizes`).
        let candidates = [Self::Centimetre, Self::Millimetre, Self::Inch, Self::Metre];
        candidates.into_iter().min_by(|a, b| least(a).total_cmp(&least(b))).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: sizes of rooms and houses that there are, height and width in the unit named.
    #[test]
    fn sizes_of_rooms_tell_their_unit() {
        let known = [
            (Unit::Metre, 3.0, 5.0),
            (Unit::Metre, 0.8, 1.0),
            (Unit::Metre, 15.0, 40.0),
            (Unit::Metre, 45.0, 120.0),
            (Unit::Metre, 67.0, 78.0),
            (Unit::Centimetre, 300.0, 500.0),
            (Unit::Centimetre, 1500.0, 3700.0),
            (Unit::Centimetre, 550.0, 560.0),
            (Unit::Millimetre, 2700.0, 4000.0),
            (Unit::Millimetre, 6000.0, 12_000.0),
            (Unit::Inch, 96.0, 180.0),
            (Unit::Inch, 120.0, 240.0),
        ];
        for (unit, height, width) in known {
            assert_eq!(Unit::guessed([height, width], [0.4 * height, 0.5 * width]), unit, "{height} × {width}");
        }
    }

    /// Truth: rooms below a sky of 100 m and on a ground of 300 m, in the unit named.
    #[test]
    fn a_sky_around_a_room_tells_no_unit() {
        for unit in [Unit::Metre, Unit::Centimetre, Unit::Millimetre] {
            for (all, most) in [([100.0, 100.0], [2.7, 5.0]), ([80.0, 300.0], [3.0, 12.0])] {
                let [all, most] = [all, most].map(|size: [f64; 2]| size.map(|length| length / unit.metres()));
                assert_eq!(Unit::guessed(all, most), unit);
            }
        }
    }

    #[test]
    fn comments_tell_the_unit() {
        assert_eq!(Unit::of_comment(" File units = inches"), Some(Unit::Inch));
        assert_eq!(Unit::of_comment("Units: mm."), Some(Unit::Millimetre));
        assert_eq!(Unit::of_comment(" units of work = many"), None);
        assert_eq!(Unit::of_comment(" 12 units"), None);
    }
}
