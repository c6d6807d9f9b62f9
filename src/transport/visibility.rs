//! VisibilityEstimate: how well the ends of a pair see each other, and how much looking a pair
//! deserves.

use super::candidate::Candidate;
use super::link::VisibilitySource;
use super::pair_samples::{PairSamples, RayBudget};

/// Rays of a pair that seems occluded, as a multiple of the most rays of others, where there is
/// patience.
const MOST_BLOCKED: u32 = 16;

/// Thresholds in the units that the oracle uses.
#[derive(Clone, Copy, Debug)]
pub struct Thresholds {
    /// ε, W.
    pub epsilon: f32,
    /// ε_partial, W.
    pub epsilon_partial: f32,
    /// f_vis: rays per BFA/ε.
    pub visibility_factor: f32,
    /// Fewest rays.
    pub rays_min: u32,
    /// Most rays.
    pub rays_max: u32,
    /// Whether pairs that seem occluded get many rays, to be believed sooner.
    pub is_patient: bool,
}

impl Thresholds {
    /// Visibility rays that a link of this unoccluded power deserves (section 2.4).
    pub fn rays_for(&self, power: f32) -> u32 {
        let wanted = self.visibility_factor * power / self.epsilon;
        // The cast saturates: a huge or undefined quotient (ε = 0) asks for the most.
        (wanted.ceil() as u32).clamp(self.rays_min, self.rays_max)
    }

    /// Rays that must all be blocked before a pair of this unoccluded power is believed to be
    /// occluded: eight per ε_partial, so that what they may have missed is an eighth of it. What
    /// few rays miss is lost for good, and what few rays see in full by chance is gained; from four
    /// to eight the power that the office loses at ε = 1e-4 falls from 2.1 % to 1.1 %
    /// (`tests/solver/balance.rs`).
    ///
    /// The patient way, where a final gather follows, bounds what they may have missed by ε/8 and
    /// goes on up to [`MOST_BLOCKED`] times the most rays: many rays on one pair cost less than
    /// those on all its children, and a dark room behind a wall is not split for want of them. Also
    /// returns the most rays that are cast to find out.
    pub fn rays_to_reject(&self, power: f32) -> (u32, u32) {
        if self.is_patient {
            let most = MOST_BLOCKED * self.rays_max;
            (((8.0 * power / self.epsilon).ceil() as u32).min(most), most)
        } else {
            ((8.0 * power / self.epsilon_partial).ceil() as u32, self.rays_max)
        }
    }
}

/// Kind of visibility that rays found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VisibilityKind {
    /// All rays came through.
    Full,
    /// Some did, or too few were cast to say that none does.
    Partial,
    /// None did.
    None,
    /// Nobody looked.
    Unknown,
}

/// How well the ends of a pair see each other.
pub struct VisibilityEstimate {
    /// Kind of the visibility.
    pub kind: VisibilityKind,
    /// Mean visibility V, 0..=1.
    pub visibility: f32,
    /// Rays cast.
    pub rays: u32,
    /// Rays that the pair's power deserved; fewer are cast where few points face each other.
    pub asked: u32,
    /// The points looked at, where any were.
    pub samples: Option<PairSamples>,
    /// How to look at what a lamp in a cluster lights, where somebody looked.
    pub budget: Option<RayBudget>,
}

impl VisibilityEstimate {
    /// Nobody looked: both ends are dark.
    pub fn unseen(candidate: &Candidate) -> Self {
        let kind = if candidate.inherits_visible { VisibilityKind::Full } else { VisibilityKind::Unknown };
        Self { kind, visibility: candidate.visibility(), rays: 0, asked: 0, samples: None, budget: None }
    }

    /// How V is known.
    pub fn visibility_source(&self) -> VisibilitySource {
        let asked = self.asked.min(u32::from(u16::MAX)) as u16;
        match self.kind {
            VisibilityKind::Full if asked == 0 => VisibilitySource::Inherited,
            VisibilityKind::Unknown => VisibilitySource::None,
            VisibilityKind::Full => VisibilitySource::Clear(asked),
            VisibilityKind::Partial | VisibilityKind::None => VisibilitySource::Rays(asked),
        }
    }
}
