//! Light is moved over a gather's samples until nothing changes: each sweep is one more reflection (Jacobi's method).

use glam::Vec3;

use super::Gather;
use crate::base::cancel::CancelToken;
use crate::hierarchy::ElementId;

/// Sweeps end when they move less than this share of the light.
const SWEEP_TOLERANCE: f64 = 2e-4;
const MOST_SWEEPS: u32 = 200;
/// The sweep from emission alone after which the rest of a geometric series is taken in one step: by then each sweep adds much the
/// same share of the one before everywhere. Later ones turn back and forth between leaves that light each other.
const SWEEP_OF_STEP: u32 = 4;

impl Gather {
    /// Moves light over the samples until nothing changes; `None` if cancelled, which leaves all as it was.
    pub(super) fn relight(&mut self, cancel: &CancelToken) -> Option<()> {
        let mut field = self.field.clone();
        let samples = &self.samples;
        field.set_areas(|leaf| samples.seen_share(leaf));
        let direct: Vec<Vec3> = field.hierarchy.ids().map(|leaf| samples.direct(leaf).0).collect();
        let leaves: Vec<ElementId> = field.leaves().collect();
        // From emission alone the first time: what links let through a wall would take long to die out.
        let is_afresh = samples.has_cosine() && !self.is_lit_by_samples;
        let mut reflected = if is_afresh { field.reflect(&direct) } else { field.reflected.to_vec() };
        let mut moved_before = f64::INFINITY;
        for sweep in 1..=MOST_SWEEPS {
            let mut irradiance = samples.indirect(&field, &reflected, &self.of_links, cancel)?;
            irradiance.iter_mut().zip(&direct).for_each(|(all, direct)| *all += *direct);
            let mut next = field.reflect(&irradiance);
            let (mut moved, mut all) = (0.0, 0.0);
            for leaf in leaves.iter().map(|leaf| leaf.index()) {
                let area = field.areas[leaf];
                moved += f64::from(area * (next[leaf] - reflected[leaf]).abs().max_element());
                all += f64::from(area * next[leaf].max_element());
            }
            let is_done = moved <= SWEEP_TOLERANCE * all;
            let ratio = moved / moved_before;
            if is_afresh && sweep == SWEEP_OF_STEP && ratio < 1.0 {
                // What all further sweeps would add, if each adds so many times what the one before does [Aitken].
                let rest = (ratio / (1.0 - ratio)) as f32;
                next.iter_mut().zip(&reflected).for_each(|(next, before)| *next += rest * (*next - *before));
            }
            (reflected, moved_before) = (next, moved);
            if is_done {
                break;
            }
        }
        let gathered = samples.irradiance(&field, &reflected, &self.of_links, cancel)?;
        field.set_irradiance(gathered.mean);
        field.set_far(&gathered.far, gathered.variance);
        self.is_lit_by_samples = samples.has_cosine();
        self.field = field;
        Some(())
    }
}
