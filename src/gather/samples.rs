//! Gather samples: what looks from each leaf found, kept so that light can be moved over them as
//! often as it takes to converge, without another ray.

use std::ops::{AddAssign, Mul};

use glam::Vec3;
use rayon::prelude::*;

use super::field::{End, Field, grey};
use super::glance::{GatherPoint, GlanceRays, Lit};
use crate::base::cancel::CancelToken;
use crate::base::random::{cosine_direction, hash64};
use crate::hierarchy::ElementId;

/// Rays that tell whether a point is hidden, where a part of a leaf is.
const HIDDEN_RAYS: u32 = 16;
/// Points of a leaf's sequence before it begins anew; `sobol_burley` has so many.
const SEQUENCE: u32 = 0xffff;
/// Stands for a ray that brings nothing: it left the scene, met a back, or met what is aimed at.
const NOTHING: ElementId = ElementId(u32::MAX);

/// Leaves to look from, and how many looks from each.
pub type Queue = Vec<(ElementId, u32)>;

/// A look from a point of a leaf.
#[derive(Clone, Copy)]
struct Look {
    /// Where on the leaf.
    position: Vec3,
    /// Irradiance that emission and the sun bring, W/m².
    emitted: Vec3,
    /// Irradiance that the sky brings, W/m²; nothing without cosine-distributed rays.
    sky: Vec3,
    /// Mean addition of the look's noise to the square of the irradiance by emission (mean of the
    /// colours).
    noise: f32,
    /// Share of the rays that end on a bright side from where the leaf is read as a whole, not
    /// followed: those who read it look along these. What ends on a back has no reader.
    far: f32,
}

/// Samples of the looks from one leaf.
#[derive(Default)]
struct Drawn {
    looks: Vec<Look>,
    /// Leaves that the cosine-distributed rays of each look met.
    met: Vec<ElementId>,
    /// Secondary emitters that are seen: twice the look, with 1 more in the second half of its
    /// rays, the emitter, and the share of what it reflects that arrives.
    aimed: Vec<(u32, ElementId, f32)>,
    hidden: u32,
    rays: u32,
}

/// The looks of one pass over some leaves; those of a leaf lie side by side.
#[derive(Default)]
struct Pass {
    cosine: usize,
    leaves: Vec<ElementId>,
    /// Where the looks of each leaf start; one longer than `leaves`.
    starts: Vec<u32>,
    looks: Vec<Look>,
    met: Vec<ElementId>,
    /// Where the aimed rays of each leaf start.
    aimed_starts: Vec<u32>,
    aimed: Vec<(u32, ElementId, f32)>,
}

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

/// Sums over the looks with cosine-distributed rays from a leaf.
#[derive(Clone, Copy, Debug, Default)]
pub struct LightSums {
    /// Σ of irradiance that others reflect, W/m².
    pub indirect: Vec3,
    /// Σ of irradiance by emission and by what others reflect, times the share of far rays, and of
    /// these shares.
    pub far_emitted: Vec3,
    pub far_indirect: Vec3,
    pub far_share: f32,
    /// Σ of all irradiance (mean of the colours), of its squares, and of the noise in these.
    pub all: f32,
    pub squares: f32,
    pub noise: f32,
}

impl AddAssign for LightSums {
    fn add_assign(&mut self, other: Self) {
        self.indirect += other.indirect;
        self.far_emitted += other.far_emitted;
        self.far_indirect += other.far_indirect;
        self.far_share += other.far_share;
        self.all += other.all;
        self.squares += other.squares;
        self.noise += other.noise;
    }
}

impl LightSums {
    /// Variance of all light over a leaf of so many looks, two at least, without the looks' own
    /// noise (mean of the colours): by chance it may come out below 0.
    fn variance(&self, looks: f32) -> f32 {
        (self.squares - self.all * self.all / looks) / (looks - 1.0) - self.noise / looks
    }
}

impl Mul<f32> for LightSums {
    type Output = Self;

    fn mul(self, factor: f32) -> Self {
        Self {
            indirect: factor * self.indirect,
            far_emitted: factor * self.far_emitted,
            far_indirect: factor * self.far_indirect,
            far_share: factor * self.far_share,
            all: factor * self.all,
            squares: factor * self.squares,
            noise: factor * self.noise,
        }
    }
}

/// All that was found.
#[derive(Default)]
pub struct GatherSamples {
    /// Parallel to the arena.
    sums: Vec<Sums>,
    passes: Vec<Pass>,
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
        let mut pass = Pass { cosine: rays.cosine as usize, ..Pass::new() };
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
    /// is lost: what few looks met by chance, others missed. Those of leaves that are hidden in part
    /// begin anew.
    pub fn split(&mut self, field: &Field, leaves: &[ElementId]) {
        let hierarchy = field.hierarchy();
        self.sums.resize(hierarchy.elements().len(), Sums::default());
        let mut is_split = vec![false; self.sums.len()];
        leaves.iter().for_each(|leaf| is_split[leaf.index()] = !field.patch(*leaf).is_hidden_in_part());
        for pass in &mut self.passes {
            let mut parted = Pass { cosine: pass.cosine, ..Pass::new() };
            for (place, &leaf) in pass.leaves.iter().enumerate() {
                if !is_split[leaf.index()] {
                    parted.push(leaf, &pass.drawn(place, |_| true));
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
        let sums = self.light(reflected.len(), reflected, cancel)?;
        let variance = |(index, sums): (usize, &LightSums)| {
            let leaf = ElementId(index as u32);
            match self.whole_looks(leaf) {
                0 | 1 => self.direct(leaf).1,
                looks => sums.variance(looks as f32),
            }
        };
        Some(sums.iter().enumerate().map(variance).collect())
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
        self.passes.iter().map(Pass::bytes).sum::<usize>() + size_of_val(&self.sums[..])
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

impl Pass {
    /// No looks.
    fn new() -> Self {
        Self { starts: vec![0], aimed_starts: vec![0], ..Self::default() }
    }

    /// Some of the looks from the leaf at a place.
    fn drawn(&self, place: usize, is_wanted: impl Fn(&Look) -> bool) -> Drawn {
        let mut drawn = Drawn::default();
        let mut aimed = self.aimed_of(place).iter().peekable();
        for (number, index) in self.looks_of(place).enumerate() {
            let is_wanted = is_wanted(&self.looks[index]);
            while let Some((half, leaf, share)) = aimed.next_if(|(half, ..)| *half as usize / 2 == number) {
                if is_wanted {
                    drawn.aimed.push((2 * drawn.looks.len() as u32 + half % 2, *leaf, *share));
                }
            }
            if is_wanted {
                drawn.looks.push(self.looks[index]);
                drawn.met.extend_from_slice(&self.met[index * self.cosine..(index + 1) * self.cosine]);
            }
        }
        drawn
    }

    /// The looks from the leaf at a place.
    fn looks_of(&self, place: usize) -> std::ops::Range<usize> {
        self.starts[place] as usize..self.starts[place + 1] as usize
    }

    /// The secondary emitters that they saw.
    fn aimed_of(&self, place: usize) -> &[(u32, ElementId, f32)] {
        &self.aimed[self.aimed_starts[place] as usize..self.aimed_starts[place + 1] as usize]
    }

    fn push(&mut self, leaf: ElementId, drawn: &Drawn) {
        self.leaves.push(leaf);
        self.looks.extend_from_slice(&drawn.looks);
        self.met.extend_from_slice(&drawn.met);
        self.aimed.extend_from_slice(&drawn.aimed);
        self.starts.push(self.looks.len() as u32);
        self.aimed_starts.push(self.aimed.len() as u32);
    }

    /// Σ of irradiance that others reflect and the sky brings, over the looks from a leaf.
    fn indirect(&self, place: usize, reflected: &[Vec3]) -> Vec3 {
        let range = self.looks_of(place);
        let met = &self.met[range.start * self.cosine..range.end * self.cosine];
        let met = met.iter().filter(|leaf| **leaf != NOTHING);
        let scattered = met.map(|leaf| reflected[leaf.index()]).sum::<Vec3>() / self.cosine as f32;
        let aimed = self.aimed_of(place);
        let aimed = aimed.iter().map(|(_, leaf, share)| *share * reflected[leaf.index()]).sum::<Vec3>();
        scattered + aimed + self.looks[range].iter().map(|look| look.sky).sum::<Vec3>()
    }

    /// Sums over the looks from a leaf.
    fn sum(&self, place: usize, reflected: &[Vec3]) -> LightSums {
        let range = self.looks_of(place);
        let aimed = self.aimed_of(place);
        let mut aimed = aimed.iter().peekable();
        let mut sums = LightSums::default();
        for (number, look) in range.clone().zip(&self.looks[range.clone()]) {
            let met = &self.met[number * self.cosine..(number + 1) * self.cosine];
            let mut halves = [0, 1].map(|half| {
                let met = &met[half * self.cosine / 2..(half + 1) * self.cosine / 2];
                let met = met.iter().filter(|leaf| **leaf != NOTHING);
                met.map(|leaf| reflected[leaf.index()]).sum::<Vec3>() / self.cosine as f32
            });
            let of_look = (number - range.start) as u32;
            while let Some((look, leaf, share)) = aimed.next_if(|(look, ..)| *look / 2 == of_look) {
                halves[(look % 2) as usize] += *share * reflected[leaf.index()];
            }
            let light = halves[0] + halves[1] + look.sky;
            let all = grey(light + look.emitted);
            sums += LightSums {
                indirect: light,
                far_emitted: look.far * look.emitted,
                far_indirect: look.far * light,
                far_share: look.far,
                all,
                squares: all * all,
                noise: look.noise + noise_of_halves(halves.map(grey)),
            };
        }
        sums
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.leaves[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.looks[..])
            + size_of_val(&self.met[..])
            + size_of_val(&self.aimed_starts[..])
            + size_of_val(&self.aimed[..])
    }
}

/// Mean addition of noise to the square of a sum of two parts, where the parts are independent
/// estimates of one half each.
fn noise_of_halves([a, b]: [f32; 2]) -> f32 {
    (a - b) * (a - b)
}

fn draw(field: &Field, leaf: ElementId, rays: GlanceRays, looks: std::ops::Range<u32>, seed: u64) -> Drawn {
    let hierarchy = &field.hierarchy;
    let element = hierarchy.element(leaf);
    let seed = hash64(seed, element.key);
    let scramble = (seed ^ (seed >> 32)) as u32;
    // Points that hide under something see nothing; a leaf's light is the mean over the others.
    let is_hidden_in_part = field.patch(leaf).is_hidden_in_part();
    let mut drawn = Drawn::default();
    for look in looks {
        let [u, v, ..] = sobol_burley::sample_4d(look & SEQUENCE, 1, scramble);
        let point = hierarchy.point_on(leaf, u, v);
        let place = (point.position, point.normal);
        if is_hidden_in_part && field.hides(place.0, place.1, hash64(seed, look.into()), HIDDEN_RAYS) {
            drawn.hidden += 1;
            continue;
        }
        // Each half of the rays has a sequence of its own, so that what they find differs by noise
        // alone and independently.
        let mut emitted = [Vec3::ZERO; 2];
        let halves = |count: u32| {
            (0..count).map(move |ray| ((ray / (count / 2)) as usize, look * (count / 2) + ray % (count / 2)))
        };
        for (half, ray) in halves(rays.aimed) {
            let [choice, u, v, _] = sobol_burley::sample_4d(ray & SEQUENCE, 2, scramble ^ half as u32);
            match field.aim_by_chance(place, [choice, u, v]) {
                Some((Lit::Emitter(emission), weight)) => emitted[half] += weight / rays.aimed as f32 * emission,
                Some((Lit::Secondary(met), weight)) => {
                    drawn.aimed.push((
                        2 * drawn.looks.len() as u32 + half as u32,
                        met.leaf,
                        weight / rays.aimed as f32,
                    ));
                }
                None => {}
            }
        }
        let (mut far, mut sky) = (0, Vec3::ZERO);
        let sky_rays = field.sky_rays(rays.cosine, rays.aimed);
        for (half, index) in halves(rays.cosine) {
            let [u, v, ..] = sobol_burley::sample_4d(index & SEQUENCE, 0, scramble ^ half as u32);
            let direction = cosine_direction(place.1, u, v);
            let end = field.meet(place.0, place.1, direction);
            if let End::Outside = end {
                sky += field.sky_along(place.0, direction, place.1.dot(direction), sky_rays);
            }
            let met = end.face();
            far += u32::from(met.is_some_and(|met| !field.is_near(leaf, met.position, place.0)));
            let met = met.filter(|met| !field.is_aimed_at(met.leaf, place.0, place.1));
            drawn.met.push(met.map_or(NOTHING, |met| met.leaf));
        }
        let here = GatherPoint::on_face(place);
        for (half, ray) in halves(sky_rays.drawn) {
            let [u, v, ..] = sobol_burley::sample_4d(ray & SEQUENCE, 3, scramble ^ half as u32);
            sky += field.sky_drawn(&here, [u, v], sky_rays);
        }
        let sun = if field.sun_rays() > 0 {
            let [u, v, ..] = sobol_burley::sample_4d(look & SEQUENCE, 4, scramble);
            field.sun_light(&here, [u, v])
        } else {
            Vec3::ZERO
        };
        let noise = noise_of_halves(emitted.map(grey));
        // One ray tells all of the sun that there is at a point, but for its penumbra.
        let emitted = emitted[0] + emitted[1] + sun;
        drawn.looks.push(Look { position: place.0, emitted, sky, noise, far: far as f32 / rays.cosine.max(1) as f32 });
        drawn.rays += rays.aimed + rays.cosine + sky_rays.drawn + field.sun_rays();
    }
    drawn
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
