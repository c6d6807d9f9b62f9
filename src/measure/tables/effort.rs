//! Settings of the runs: thresholds, sizes, repetitions. Pinned here and written into every
//! CSV.

use std::time::Duration;

use crate::scene::builtin::BuiltinScene;

/// ε/Φ of Table 1: adaptive clusters then have 2,929 leaf patches in the seminar room, beside the
/// paper's 2,926.
const SEMINAR_EPSILON: f64 = 2.8e-3;
/// ε/Φ of Table 2: the leaf patches of the office are then about the paper's 6,850.
const OFFICE_EPSILON: f64 = 1.35e-3;

/// How much is run.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Whether small rooms and coarse thresholds stand in, so that a test can wait for it.
    pub quick: bool,
    /// The room of Table 1.
    pub seminar: BuiltinScene,
    /// ε/Φ of the seminar room.
    pub seminar_epsilon: f64,
    /// The room of Table 2.
    pub office: BuiltinScene,
    /// ε/Φ of the office.
    pub office_epsilon: f64,
    /// ε/Φ of a coarse and of a fine solution (Figures 3 and 4).
    pub coarse_and_fine: [f64; 2],
    /// Polygons of the rooms whose growth is looked at.
    pub sizes: Vec<usize>,
    /// Sizes for HR, which does not get as far.
    pub hr_sizes: Vec<usize>,
    /// ε/Φ of all of them.
    pub scale_epsilon: f64,
    /// How long one run may take.
    pub cap: Duration,
    /// Runs of a setting that takes less than [`Effort::SHORT`]; the median counts.
    pub repeats: usize,
    /// Alternating runs of either push.
    pub push_repeats: usize,
    /// Pixels of one picture.
    pub picture: [u32; 2],
}

impl Effort {
    /// Runs that are shorter are repeated, s.
    pub const SHORT: f64 = 10.0;

    /// The rooms of Tables 1 and 2, each with its ε/Φ.
    pub fn rooms(&self) -> [(BuiltinScene, f64); 2] {
        [(self.seminar, self.seminar_epsilon), (self.office, self.office_epsilon)]
    }

    /// The paper's rooms.
    pub fn full() -> Self {
        Self {
            quick: false,
            seminar: BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS },
            seminar_epsilon: SEMINAR_EPSILON,
            office: BuiltinScene::Office,
            office_epsilon: OFFICE_EPSILON,
            coarse_and_fine: [1e-2, 1e-4],
            sizes: vec![1_000, 4_000, 16_000, 64_000, 256_000],
            hr_sizes: vec![1_000, 2_000, 4_000, 8_000, 16_000],
            scale_epsilon: 1e-3,
            cap: Duration::from_secs(30),
            repeats: 3,
            push_repeats: 9,
            picture: [800, 500],
        }
    }

    /// Small rooms and coarse thresholds: the same files, but no answer to the paper.
    pub fn quick() -> Self {
        Self {
            quick: true,
            seminar: BuiltinScene::Cornell,
            seminar_epsilon: 3e-2,
            office: BuiltinScene::Seminar { polygons: 1_000 },
            office_epsilon: 3e-2,
            coarse_and_fine: [1e-1, 1e-2],
            sizes: vec![1_000, 4_000],
            hr_sizes: vec![1_000],
            scale_epsilon: 3e-2,
            cap: Duration::from_secs(60),
            repeats: 1,
            push_repeats: 1,
            picture: [160, 100],
        }
    }
}
