//! Looks: what rays from a point of a leaf find, and the looks of a pass side by side.

use std::ops::{AddAssign, Mul, Range};

use glam::Vec3;

use super::field::{End, Field, grey};
use super::glance::{GatherPoint, GlanceRays, Lit};
use crate::base::random::{cosine_direction, hash64};
use crate::hierarchy::ElementId;

/// Rays that tell whether a point is hidden, where a part of a leaf is.
const HIDDEN_RAYS: u32 = 16;
/// Points of a leaf's sequence before it begins anew; `sobol_burley` has so many.
const SEQUENCE: u32 = 0xffff;
/// Stands for a ray that brings nothing: it left the scene, met a back, or met what is aimed at.
pub const NOTHING: ElementId = ElementId(u32::MAX);

/// A look from a point of a leaf.
#[derive(Clone, Copy)]
pub struct Look {
    /// Where on the leaf.
    pub position: Vec3,
    /// Irradiance that emission and the sun bring, W/m².
    pub emitted: Vec3,
    /// Irradiance that the sky brings, W/m²; nothing without cosine-distributed rays.
    pub sky: Vec3,
    /// Mean addition of the look's noise to the square of the irradiance by emission (mean of the
    /// colours).
    pub noise: f32,
    /// Share of the rays that end on a bright side from where the leaf is read as a whole, not
    /// followed: those who read it look along these. What ends on a back has no reader.
    pub far: f32,
}

/// Samples of the looks from one leaf.
#[derive(Default)]
pub struct Drawn {
    pub looks: Vec<Look>,
    /// Leaves that the cosine-distributed rays of each look met.
    pub met: Vec<ElementId>,
    /// Secondary emitters that are seen: twice the look, with 1 more in the second half of its
    /// rays, the emitter, and the share of what it reflects that arrives.
    pub aimed: Vec<(u32, ElementId, f32)>,
    pub hidden: u32,
    pub rays: u32,
}

/// The looks of one pass over some leaves; those of a leaf lie side by side.
#[derive(Default)]
pub struct PassSamples {
    pub cosine: usize,
    pub leaves: Vec<ElementId>,
    /// Where the looks of each leaf start; one longer than `leaves`.
    pub starts: Vec<u32>,
    pub looks: Vec<Look>,
    pub met: Vec<ElementId>,
    /// Where the aimed rays of each leaf start.
    pub aimed_starts: Vec<u32>,
    pub aimed: Vec<(u32, ElementId, f32)>,
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
    pub fn variance(&self, looks: f32) -> f32 {
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

impl PassSamples {
    /// No looks.
    pub fn new() -> Self {
        Self { starts: vec![0], aimed_starts: vec![0], ..Self::default() }
    }

    /// Some of the looks from the leaf at a place.
    pub fn drawn(&self, place: usize, is_wanted: impl Fn(&Look) -> bool) -> Drawn {
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
    pub fn looks_of(&self, place: usize) -> Range<usize> {
        self.starts[place] as usize..self.starts[place + 1] as usize
    }

    /// The secondary emitters that they saw.
    pub fn aimed_of(&self, place: usize) -> &[(u32, ElementId, f32)] {
        &self.aimed[self.aimed_starts[place] as usize..self.aimed_starts[place + 1] as usize]
    }

    /// Adds looks from a leaf.
    pub fn push(&mut self, leaf: ElementId, drawn: &Drawn) {
        self.extend(leaf, &drawn.looks, &drawn.met, &drawn.aimed);
    }

    /// Adds the looks of another pass from the leaf at a place.
    pub fn push_from(&mut self, other: &Self, place: usize) {
        let looks = other.looks_of(place);
        let met = &other.met[looks.start * other.cosine..looks.end * other.cosine];
        self.extend(other.leaves[place], &other.looks[looks], met, other.aimed_of(place));
    }

    fn extend(&mut self, leaf: ElementId, looks: &[Look], met: &[ElementId], aimed: &[(u32, ElementId, f32)]) {
        self.leaves.push(leaf);
        self.looks.extend_from_slice(looks);
        self.met.extend_from_slice(met);
        self.aimed.extend_from_slice(aimed);
        self.starts.push(self.looks.len() as u32);
        self.aimed_starts.push(self.aimed.len() as u32);
    }

    /// Σ of irradiance that others reflect and the sky brings, over the looks from a leaf.
    pub fn indirect(&self, place: usize, reflected: &[Vec3]) -> Vec3 {
        let range = self.looks_of(place);
        let met = &self.met[range.start * self.cosine..range.end * self.cosine];
        let met = met.iter().filter(|leaf| **leaf != NOTHING);
        let scattered = met.map(|leaf| reflected[leaf.index()]).sum::<Vec3>() / self.cosine as f32;
        let aimed = self.aimed_of(place);
        let aimed = aimed.iter().map(|(_, leaf, share)| *share * reflected[leaf.index()]).sum::<Vec3>();
        scattered + aimed + self.looks[range].iter().map(|look| look.sky).sum::<Vec3>()
    }

    /// Sums over the looks from a leaf.
    pub fn sum(&self, place: usize, reflected: &[Vec3]) -> LightSums {
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

    pub fn bytes(&self) -> usize {
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

/// Looks with these numbers from a leaf; the seed alone tells their random numbers.
pub fn draw(field: &Field, leaf: ElementId, rays: GlanceRays, looks: Range<u32>, seed: u64) -> Drawn {
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
        if is_hidden_in_part && field.is_enclosed(place.0, place.1, hash64(seed, look.into()), HIDDEN_RAYS) {
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
