//! Gather samples: what looks from each leaf found, kept so that light can be moved over them as
//! often as it takes to converge, without another ray.

use glam::Vec3;
use rayon::prelude::*;

use super::field::{Field, grey};
use super::glance::GlanceRays;
use super::looks::{Drawn, LightSums, NOTHING, PassSamples, draw};
use crate::base::cancel::CancelToken;
use crate::hierarchy::ElementId;

/// Leaves to look from, and how many looks from each.
pub type Queue = Vec<(ElementId, u32)>;

/// Sums over the looks from a leaf.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    /// Looks drawn, and of these those from points that are not hidden.
    drawn: u32,
    pub seen: u32,
    /// Σ of the irradiance that emission and the sun bring, W/m², and of its squares less their
    /// noise (mean of the colours).
    pub emitted: Vec3,
    squares: f32,
    /// Looks with cosine-distributed rays, from points that are not hidden.
    pub whole: u32,
    /// Σ over these of the shares of what others reflect that arrives.
    pub row: f32,
}

/// All that was found.
#[derive(Default)]
pub struct GatherSamples {
    /// Parallel to the arena.
    sums: Vec<Sums>,
    passes: Vec<PassSamples>,
    /// Rays cast.
    pub rays: u64,
}

impl GatherSamples {
    /// None yet, after so many rays that looked for other things.
    pub fn after(rays: u64) -> Self {
        Self { rays, ..Self::default() }
    }

    /// Looks so many times from each of these leaves, which must be different ones; false if
    /// cancelled, which leaves all as it was. Without cosine-distributed rays, emission alone is
    /// looked for.
    pub fn draw(
        &mut self,
        field: &Field,
        queue: &[(ElementId, u32)],
        rays: GlanceRays,
        seed: u64,
        cancel: &CancelToken,
    ) -> bool {
        self.sums.resize(field.hierarchy.elements().len(), Sums::default());
        let draw = |(leaf, looks): &(ElementId, u32)| {
            let done = self.sums[leaf.index()].drawn;
            (!cancel.is_cancelled()).then(|| draw(field, *leaf, rays, done..done + looks, seed))
        };
        let drawn: Option<Vec<Drawn>> = queue.par_iter().with_min_len(8).map(draw).collect();
        let Some(drawn) = drawn else { return false };
        let mut pass = PassSamples { cosine: rays.cosine as usize, ..PassSamples::new() };
        for ((leaf, _), drawn) in queue.iter().zip(drawn) {
            let sums = &mut self.sums[leaf.index()];
            sums.drawn += drawn.hidden;
            sums.add(&drawn, rays.cosine as usize);
            self.rays += u64::from(drawn.rays);
            if rays.cosine > 0 {
                pass.push(*leaf, &drawn);
            }
        }
        if rays.cosine > 0 {
            self.passes.push(pass);
        }
        true
    }

    /// Parts of leaves that were split take over the whole looks from where they lie, so that none
    /// is lost: what few looks met by chance, others missed. Those of leaves that are hidden in
    /// part begin anew.
    pub fn split(&mut self, field: &Field, leaves: &[ElementId]) {
        let hierarchy = field.hierarchy();
        self.sums.resize(hierarchy.elements().len(), Sums::default());
        let mut is_split = vec![false; self.sums.len()];
        leaves.iter().for_each(|leaf| is_split[leaf.index()] = !field.patch(*leaf).is_hidden_in_part());
        for pass in &mut self.passes {
            let mut parted = PassSamples { cosine: pass.cosine, ..PassSamples::new() };
            for (place, &leaf) in pass.leaves.iter().enumerate() {
                if !is_split[leaf.index()] {
                    parted.push_from(pass, place);
                    continue;
                }
                for child in hierarchy.element(leaf).children() {
                    let drawn = pass.drawn(place, |look| hierarchy.leaf_at(leaf, look.position) == child);
                    if !drawn.looks.is_empty() {
                        self.sums[child.index()].add(&drawn, pass.cosine);
                        parted.push(child, &drawn);
                    }
                }
            }
            *pass = parted;
        }
    }

    /// Sums over the looks from a leaf.
    pub fn of(&self, leaf: ElementId) -> Sums {
        self.sums.get(leaf.index()).copied().unwrap_or_default()
    }

    /// Irradiance that emission and the sun bring to a leaf, W/m², and its variance over the leaf
    /// (mean of the colours); zero where it was not looked for.
    pub fn direct(&self, leaf: ElementId) -> (Vec3, f32) {
        let sums = self.of(leaf);
        let looks = sums.seen.max(1) as f32;
        let mean = sums.emitted / looks;
        (mean, (sums.squares / looks - grey(mean) * grey(mean)).max(0.0))
    }

    /// Looks from a leaf so far.
    pub fn looks(&self, leaf: ElementId) -> u32 {
        self.of(leaf).drawn
    }

    /// Share of a leaf's random points that are not hidden, where it was looked at.
    pub fn seen_share(&self, leaf: ElementId) -> Option<f32> {
        let sums = self.of(leaf);
        (sums.drawn > 0).then(|| sums.seen as f32 / sums.drawn as f32)
    }

    /// Whether any cosine-distributed rays were cast.
    pub fn has_cosine(&self) -> bool {
        !self.passes.is_empty()
    }

    /// Looks from a leaf with cosine-distributed rays.
    pub fn whole_looks(&self, leaf: ElementId) -> u32 {
        self.of(leaf).whole
    }

    /// Of each leaf Σ over its looks of the irradiance that others reflect, where they reflect this
    /// much, and that the sky brings, W/m², parallel to an arena of so many elements; `None` if
    /// cancelled.
    pub fn indirect(&self, elements: usize, reflected: &[Vec3], cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let mut sums = vec![Vec3::ZERO; elements];
        for pass in &self.passes {
            let of_leaf = |place: usize| (!cancel.is_cancelled()).then(|| pass.indirect(place, reflected));
            let found: Option<Vec<_>> = (0..pass.leaves.len()).into_par_iter().with_min_len(256).map(of_leaf).collect();
            for (leaf, found) in pass.leaves.iter().zip(found?) {
                sums[leaf.index()] += found;
            }
        }
        Some(sums)
    }

    /// Of each leaf the sums of all light over its looks, likewise.
    pub fn light(&self, elements: usize, reflected: &[Vec3], cancel: &CancelToken) -> Option<Vec<LightSums>> {
        let mut sums = vec![LightSums::default(); elements];
        for pass in &self.passes {
            let of_leaf = |place: usize| (!cancel.is_cancelled()).then(|| pass.sum(place, reflected));
            let found: Option<Vec<_>> = (0..pass.leaves.len()).into_par_iter().with_min_len(256).map(of_leaf).collect();
            for (leaf, found) in pass.leaves.iter().zip(found?) {
                sums[leaf.index()] += found;
            }
        }
        Some(sums)
    }

    /// Variance of light over each leaf, W²/m⁴ (mean of the colours), parallel to the arena: of all
    /// light, where others reflect this much, if two whole looks tell it, else of what emission and
    /// the sun bring. `None` if cancelled.
    pub fn variances(&self, reflected: &[Vec3], cancel: &CancelToken) -> Option<Vec<f32>> {
        let sums = if self.has_cosine() { self.light(reflected.len(), reflected, cancel)? } else { Vec::new() };
        let variance = |index: usize| {
            let leaf = ElementId(index as u32);
            match self.whole_looks(leaf) {
                0 | 1 => self.direct(leaf).1,
                looks => sums[index].variance(looks as f32),
            }
        };
        Some((0..reflected.len()).map(variance).collect())
    }

    /// How often each patch was met, where each look from a leaf counts so much: an importance,
    /// parallel to an arena of so many elements.
    pub fn read(&self, elements: usize, of_look: impl Fn(ElementId) -> f64) -> Vec<f32> {
        let mut read = vec![0.0; elements];
        for pass in &self.passes {
            for (place, leaf) in pass.leaves.iter().enumerate() {
                let weight = of_look(*leaf);
                let looks = pass.looks_of(place);
                let met = &pass.met[looks.start * pass.cosine..looks.end * pass.cosine];
                for met in met.iter().filter(|met| **met != NOTHING) {
                    read[met.index()] += (weight / pass.cosine as f64) as f32;
                }
                for (_, met, share) in pass.aimed_of(place) {
                    read[met.index()] += weight as f32 * share;
                }
            }
        }
        read
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.passes.iter().map(PassSamples::bytes).sum::<usize>() + size_of_val(&self.sums[..])
    }
}

impl Sums {
    /// Adds looks, with their share of what cosine-distributed rays met if they have such.
    fn add(&mut self, drawn: &Drawn, cosine: usize) {
        let seen = drawn.looks.len() as u32;
        self.drawn += seen;
        self.seen += seen;
        for look in &drawn.looks {
            self.emitted += look.emitted;
            self.squares += grey(look.emitted) * grey(look.emitted) - look.noise;
        }
        if cosine > 0 {
            self.whole += seen;
            let met = drawn.met.iter().filter(|leaf| **leaf != NOTHING).count() as f32 / cosine as f32;
            self.row += met + drawn.aimed.iter().map(|(.., share)| share).sum::<f32>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gather::Gather;

    fn with_light() -> Gather {
        let mut gather = Gather::of_cornell();
        while gather.certificate().is_none() {
            gather.step(&CancelToken::new()).expect("nobody cancels");
        }
        gather
    }

    /// Truth: nothing is lost and nothing is added, and each look lies on the part that has it.
    #[test]
    fn parts_of_a_leaf_take_over_its_looks() {
        let gather = with_light();
        let (mut field, mut samples) = (gather.field.clone(), gather.samples);
        let never = CancelToken::new();
        let is_plain = |leaf: &ElementId| !field.emits(*leaf) && !field.patch(*leaf).is_hidden_in_part();
        let split: Vec<ElementId> =
            field.leaves().filter(is_plain).filter(|leaf| samples.whole_looks(*leaf) > 8).take(20).collect();
        let before = samples.light(field.hierarchy.elements().len(), &field.reflected, &never).expect("not cancelled");
        field.split(&split);
        samples.split(&field, &split);
        let after = samples.light(field.hierarchy.elements().len(), &field.reflected, &never).expect("not cancelled");
        assert!(split.len() == 20);
        for leaf in &split {
            let parts = || field.hierarchy().element(*leaf).children();
            let looks: u32 = parts().map(|part| samples.whole_looks(part)).sum();
            assert_eq!(looks, samples.whole_looks(*leaf));
            let light: f32 = parts().map(|part| after[part.index()].all).sum();
            let whole = before[leaf.index()].all;
            assert!((light - whole).abs() <= 1e-4 * whole && after[leaf.index()].all == 0.0, "{light}, not {whole}");
        }
        for pass in &samples.passes {
            for (place, leaf) in pass.leaves.iter().enumerate() {
                for look in &pass.looks[pass.looks_of(place)] {
                    let polygon = field.patch(*leaf).polygon;
                    assert_eq!(field.leaf_at(polygon, look.position), *leaf);
                }
            }
        }
    }

    /// Truth: exact readings at points of the same leaves. Looks of few rays are far noisier than
    /// light varies over a leaf, but their halves tell by how much.
    #[test]
    fn variance_of_light_is_that_of_readings() {
        let gather = with_light();
        let (field, samples) = (&gather.field, &gather.samples);
        let variances = samples.variances(&field.reflected, &CancelToken::new()).expect("not cancelled");
        let (mut found, mut wanted, mut raw) = (0.0, 0.0, 0.0);
        let leaves: Vec<ElementId> =
            field.leaves().filter(|leaf| !field.emits(*leaf) && samples.whole_looks(*leaf) >= 16).collect();
        for leaf in leaves.iter().step_by(leaves.len().div_ceil(60)) {
            const READINGS: u32 = 25;
            let readings = (0..READINGS).map(|number| {
                let (u, v) = ((number % 5) as f32, (number / 5) as f32);
                let point = field.hierarchy().point_on(*leaf, (u + 0.5) / 5.0, (v + 0.5) / 5.0);
                grey(field.irradiance_at((point.position, point.normal), 0.02, number.into()).mean)
            });
            let readings: Vec<f32> = readings.collect();
            let mean = readings.iter().sum::<f32>() / READINGS as f32;
            let of_readings = readings.iter().map(|light| (light - mean).powi(2)).sum::<f32>() / READINGS as f32;
            let noise = (0.02 * (mean + field.dim())).powi(2);
            let weight = field.area(*leaf) / (mean + field.dim()).powi(2);
            found += weight * variances[leaf.index()];
            wanted += weight * (of_readings - noise);
            raw += weight;
        }
        // 60 leaves of 16 or more looks each: their variances are known to a few parts in ten.
        assert!((found / wanted - 1.0).abs() < 0.3, "{} of {}", found / raw, wanted / raw);
    }
}
