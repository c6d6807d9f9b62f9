//! Our own scenes, drawn by code: the Cornell box, the paper's seminar room, the paper's office,
//! and a tower of such offices.
//!
//! Lengths are in metres, y points up, and every face shows its bright side to the inside of the
//! room. A group holds a piece of furniture or a handful of like things (a board of books), in the
//! spirit of the paper's USER clustering. Things stand open on what carries them: hidden faces are
//! left out, see `shapes`.

mod cornell;
mod furniture;
mod office;
mod seminar;
mod shapes;
mod tower;

use super::Scene;

/// One of our own scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BuiltinScene {
    /// The measured Cornell box: two blocks under a ceiling light.
    Cornell,
    /// A lecture room: tables and chairs before a board.
    Seminar {
        /// Polygons of the scene, exactly; more rows and more on the tables as it grows. Clamped to
        /// [`BuiltinScene::SEMINAR_RANGE`].
        polygons: usize,
    },
    /// An office for two.
    #[default]
    Office,
    /// Storeys of offices, to see how cost grows.
    Tower {
        /// Polygons of the scene, about: whole offices. Clamped to [`BuiltinScene::TOWER_RANGE`].
        polygons: usize,
    },
}

impl BuiltinScene {
    /// Polygons of the seminar room in the paper.
    pub const SEMINAR_POLYGONS: usize = 2_008;

    /// The seminar room can be drawn with any number of polygons in this range.
    pub const SEMINAR_RANGE: std::ops::RangeInclusive<usize> = 1_000..=262_144;

    /// The tower can be drawn with about so many polygons.
    pub const TOWER_RANGE: std::ops::RangeInclusive<usize> = 10_000..=10_000_000;

    /// The rooms, at their usual size: what the window offers.
    pub const ALL: [Self; 3] = [Self::Cornell, Self::Seminar { polygons: Self::SEMINAR_POLYGONS }, Self::Office];

    /// The tower at its usual size: two storeys.
    pub const TOWER: Self = Self::Tower { polygons: 64_000 };

    /// The scenes that have a name on the command line: the rooms and the tower.
    pub fn named() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain([Self::TOWER])
    }

    /// The scene with this name, at its usual size.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::named().find(|scene| scene.name() == name)
    }

    /// The name on the command line, of the scene and of its files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cornell => "cornell",
            Self::Seminar { .. } => "seminar",
            Self::Office => "office",
            Self::Tower { .. } => "tower",
        }
    }

    /// Draws the scene: the same one, bit for bit, every time.
    pub fn build(&self) -> Scene {
        match *self {
            Self::Cornell => cornell::build(),
            Self::Seminar { polygons } => {
                seminar::build(polygons.clamp(*Self::SEMINAR_RANGE.start(), *Self::SEMINAR_RANGE.end()))
            }
            Self::Office => office::build(),
            Self::Tower { polygons } => {
                tower::build(polygons.clamp(*Self::TOWER_RANGE.start(), *Self::TOWER_RANGE.end()))
            }
        }
    }
}
