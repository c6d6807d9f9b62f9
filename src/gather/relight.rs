//! Light is moved over a gather's samples until nothing changes: each sweep is one more reflection,
//! from a [mixture](Mixing) of the ones before.

use glam::Vec3;
use rayon::prelude::*;

use super::Gather;
use super::field::{CHUNK, Field, grey};
use super::groups::{Groups, Mean};
use super::looks::LightSums;
use super::samples::GatherSamples;
use crate::base::cancel::CancelToken;
use crate::base::mixing::Mixing;
use crate::hierarchy::ElementId;
use crate::transport::{Change, LARGEST_RETURN};

/// Sweeps end when less than this share of the light is still to come.
const SWEEP_TOLERANCE: f64 = 1e-4;
const MOST_SWEEPS: u32 = 200;
/// The most that what the closure takes is made up for, so that light still dies out.
const MOST_REFUND: f64 = 1.0 / LARGEST_RETURN as f64;

/// Samples, and what of them is the same in all sweeps; tables are parallel to the arena.
struct Relighting<'a> {
    field: &'a Field,
    samples: &'a GatherSamples,
    groups: &'a Groups,
    /// Indirect irradiance by the links, W/m², of what was not looked at by cosine-distributed
    /// rays.
    of_links: &'a [Vec3],
    known: Vec<Known>,
    /// Irradiance that emission and the sun bring, W/m²; 0 of what is no leaf.
    direct: Vec<Vec3>,
    /// Scale of reflected light by which it dies out.
    closure: Vec<f32>,
    /// Reflectance ρ; 0 of what is no leaf.
    reflectance: Vec<Vec3>,
}

/// Where an element's indirect light is known from.
#[derive(Clone, Copy)]
enum Known {
    /// It is no leaf.
    Nothing,
    ByLinks,
    /// By looks, each of which counts so much.
    ByLooks(f32),
}

/// Irradiances of each leaf, W/m², parallel to the arena.
struct Gathered {
    /// Mean over the leaf.
    mean: Vec<Vec3>,
    /// Mean over what far points see of it.
    far: Vec<Vec3>,
    /// Σ over its looks (mean of the colours).
    sums: Vec<f32>,
}

impl<'a> Relighting<'a> {
    fn new(field: &'a Field, samples: &'a GatherSamples, groups: &'a Groups, of_links: &'a [Vec3]) -> Self {
        let elements = field.hierarchy.elements().len();
        let (mut direct, mut closure) = (vec![Vec3::ZERO; elements], vec![1.0; elements]);
        let mut reflectance = vec![Vec3::ZERO; elements];
        let mut known = vec![Known::Nothing; elements];
        let emitted = groups.shared(|leaf| {
            let sums = samples.of(leaf);
            Mean { sum: sums.emitted, looks: sums.seen as f32 }
        });
        let rows = groups.shared(|leaf| {
            let sums = samples.of(leaf);
            Mean { sum: sums.row, looks: sums.whole as f32 }
        });
        for leaf in field.leaves() {
            let (index, sums) = (leaf.index(), samples.of(leaf));
            known[index] = if sums.whole > 0 { Known::ByLooks(1.0 / sums.whole as f32) } else { Known::ByLinks };
            direct[index] = emitted.of(leaf).map_or_else(|| samples.direct(leaf).0, |(mean, shape)| shape * mean);
            let row = rows.of(leaf).map_or_else(|| sums.row / sums.whole.max(1) as f32, |(mean, shape)| shape * mean);
            reflectance[index] = field.reflectance(leaf);
            closure[index] = closure_of(row, reflectance[index].max_element());
        }
        Self { field, samples, groups, of_links, known, direct, closure, reflectance }
    }

    /// Irradiance of each leaf, W/m², where all reflect this much, and the factor that makes up for
    /// the closure; `None` if cancelled.
    fn irradiance(&self, reflected: &[Vec3], cancel: &CancelToken) -> Option<(Vec<Vec3>, f32)> {
        let sums = self.samples.indirect(self.direct.len(), reflected, cancel)?;
        let of_groups = self.groups.shared(self.by_leaf(&sums));
        let indirect = |(index, known): (usize, &Known)| match (known, of_groups.of(ElementId(index as u32))) {
            (Known::Nothing, _) => Vec3::ZERO,
            (_, Some((mean, shape))) => shape * mean,
            (Known::ByLinks, None) => self.of_links[index],
            (Known::ByLooks(weight), None) => *weight * sums[index],
        };
        let mut indirect: Vec<Vec3> = self.known.par_iter().enumerate().with_min_len(CHUNK).map(indirect).collect();
        let refund = self.refund(&indirect);
        indirect.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(index, light)| {
            *light = self.direct[index] + refund * self.closure[index] * *light;
        });
        Some((indirect, refund))
    }

    /// Factor on all reflected light that makes up for what the closure takes: rows that have too
    /// much by chance have what others lack.
    fn refund(&self, indirect: &[Vec3]) -> f32 {
        let of_chunk = |((light, areas), closure): ((&[Vec3], &[f32]), &[f32])| {
            let (mut all, mut kept) = (0.0_f64, 0.0);
            for ((light, area), closure) in light.iter().zip(areas).zip(closure) {
                let power = f64::from(area * grey(*light));
                all += power;
                kept += f64::from(*closure) * power;
            }
            [all, kept]
        };
        let lights = indirect.par_chunks(CHUNK).zip(self.field.areas.par_chunks(CHUNK));
        let chunks: Vec<[f64; 2]> = lights.zip(self.closure.par_chunks(CHUNK)).map(of_chunk).collect();
        let [all, kept] = [0, 1].map(|which| chunks.iter().map(|chunk| chunk[which]).sum::<f64>());
        if kept > 0.0 { (all / kept).min(MOST_REFUND) as f32 } else { 1.0 }
    }

    /// Light that each patch reflects of these irradiances of leaves in the mean, ρE, W/m².
    fn reflect(&self, irradiance: &[Vec3]) -> Vec<Vec3> {
        let of_leaf = |(light, reflectance): (&Vec3, &Vec3)| *reflectance * light.max(Vec3::ZERO);
        let reflected = irradiance.par_iter().zip(&self.reflectance).with_min_len(CHUNK).map(of_leaf);
        self.field.with_means(reflected.collect())
    }

    /// Change of the leaves' light from what all reflected to what they reflect now.
    fn change(&self, before: &[Vec3], now: &[Vec3]) -> Change {
        let of_chunk = |leaves: &[ElementId]| {
            let mut change = Change::default();
            for &leaf in leaves {
                let [before, now] = [before, now].map(|light| light[leaf.index()]);
                change.note(self.field.area(leaf), [before, now], (now, self.reflectance[leaf.index()]));
            }
            change
        };
        let chunks: Vec<Change> = self.field.all_leaves().par_chunks(CHUNK).map(of_chunk).collect();
        chunks.into_iter().fold(Change::default(), Change::and)
    }

    /// Irradiances of each leaf where all reflect this much; `None` if cancelled.
    fn gathered(&self, reflected: &[Vec3], cancel: &CancelToken) -> Option<Gathered> {
        let sums = self.samples.light(self.direct.len(), reflected, cancel)?;
        let (mean, refund) = self.irradiance(reflected, cancel)?;
        let mut far = mean.clone();
        let far_of = |leaf: ElementId, sums: &LightSums| {
            let indirect = refund * self.closure[leaf.index()] * sums.far_indirect;
            (sums.far_share > 0.0).then(|| (sums.far_emitted + indirect) / sums.far_share)
        };
        let of_groups = self.groups.shared(self.by_leaf(&sums));
        for leaf in self.field.leaves() {
            let light = match of_groups.of(leaf) {
                Some((of_group, shape)) => far_of(leaf, &of_group).map(|light| shape * light),
                None => far_of(leaf, &sums[leaf.index()]),
            };
            if let Some(light) = light {
                far[leaf.index()] = light;
            }
        }
        let sums = sums.iter().map(|sums| sums.all).collect();
        Some(Gathered { mean, far, sums })
    }

    /// Sums over the looks of each leaf with cosine-distributed rays, by leaf.
    fn by_leaf<T: Copy>(&self, sums: &[T]) -> impl Fn(ElementId) -> Mean<T> {
        |leaf| Mean { sum: sums[leaf.index()], looks: self.samples.of(leaf).whole as f32 }
    }
}

/// Scale of reflected light by which it dies out: of few aimed rays some bring more than is sent,
/// by chance, and leaves that light each other so would glow without end. What the leaf's
/// reflectance makes up for stays: rows that are too small by chance stay as well.
fn closure_of(row: f32, reflectance: f32) -> f32 {
    let most = (LARGEST_RETURN / reflectance).max(1.0);
    (most / row).min(1.0)
}

impl Gather {
    /// Moves light over the samples until nothing changes; `None` if cancelled, which leaves all as
    /// it was.
    pub(super) fn relight(&mut self, cancel: &CancelToken) -> Option<()> {
        let mut field = self.field.clone();
        let samples = &self.samples;
        field.set_areas(|leaf| samples.seen_share(leaf));
        let relighting = Relighting::new(&field, samples, &self.groups, &self.of_links);
        // From emission alone the first time: what links let through a wall would take long to die
        // out.
        let is_afresh = samples.has_cosine() && !self.is_lit_by_samples;
        let mut reflected = if is_afresh { relighting.reflect(&relighting.direct) } else { field.reflected.to_vec() };
        let mut mixing = Mixing::default();
        for sweep in 1..=MOST_SWEEPS {
            let next = relighting.reflect(&relighting.irradiance(&reflected, cancel)?.0);
            let change = relighting.change(&reflected, &next);
            // Without cosine-distributed rays nothing depends on what others reflect.
            if change.to_come() <= SWEEP_TOLERANCE * change.power || !samples.has_cosine() || sweep == MOST_SWEEPS {
                tracing::debug!(sweep, "light of the field converged");
                reflected = next;
                break;
            }
            reflected = mixing.next(&field.areas, &reflected, next);
        }
        let gathered = relighting.gathered(&reflected, cancel)?;
        field.set_irradiance(gathered.mean);
        field.set_far(&gathered.far);
        self.groups.learn(|leaf| match samples.of(leaf) {
            known if samples.has_cosine() => Mean { sum: gathered.sums[leaf.index()], looks: known.whole as f32 },
            known => Mean { sum: grey(known.emitted), looks: known.seen as f32 },
        });
        self.is_lit_by_samples = samples.has_cosine();
        self.field = field;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: ρ times the row is no more than 0.98, where the row is more than 1; what is less
    /// stays as it is.
    #[test]
    fn light_dies_out_in_every_row() {
        assert_eq!((closure_of(2.0, 0.98), closure_of(1.0, 0.98), closure_of(0.25, 0.98)), (0.5, 1.0, 1.0));
        assert_eq!((closure_of(1.75, 0.5), closure_of(2.0, 0.0), closure_of(4.0, 0.49)), (1.0, 1.0, 0.5));
        assert_eq!(closure_of(0.0, 0.5), 1.0);
    }
}
