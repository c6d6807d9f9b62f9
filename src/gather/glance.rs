//! A look of very few rays, for pictures: millions of them, each at another point.
//!
//! A look at a reading shares rays out to everything that could shine at the point. Here so much is
//! never found out: each aimed ray goes down the tree of sources by chance, and so costs no more
//! than the tree is deep. The random numbers are one low-discrepancy sequence for a block of
//! neighbouring points, so that these share out the sources and directions among themselves.

use std::f32::consts::PI;

use glam::Vec3;

use super::facet::Facet;
use super::field::{End, Field, Met};
use super::source_tree::FAR;
use crate::base::random::{cosine_direction, fraction, hash64};
use crate::geometry::LastStop;
use crate::hierarchy::{Element, Shape, point_on_polygon};

/// Sequences are this long before another one begins.
const SEQUENCE: u32 = 1 << 16;
/// Rays that follow one another at most.
const LONGEST: u32 = 64;

/// Rays of a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlanceRays {
    /// Aimed at emitters and secondary emitters.
    pub aimed: u32,
    /// Cosine-distributed.
    pub cosine: u32,
}

/// Light that a glance finds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Glance {
    /// Irradiance by what is aimed at for its own light, W/m².
    pub direct: Vec3,
    /// Irradiance by the sun, W/m²: without noise but in penumbras.
    pub sun: Vec3,
    /// Irradiance by what others reflect, and by the sky that cosine-distributed rays find, W/m².
    pub indirect: Vec3,
    /// Mean of 1 / distance over where the cosine-distributed rays end; 0 for those that meet
    /// nothing.
    pub nearness: f32,
}

impl Glance {
    /// Irradiance, W/m².
    pub fn irradiance(&self) -> Vec3 {
        self.direct + self.indirect + self.sun
    }
}

/// Where light is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherPoint {
    /// A point of a face.
    pub position: Vec3,
    /// Unit normal that cosines are taken to: the face's own, or an interpolated one.
    pub normal: Vec3,
    /// Unit normal of the face, behind which nothing is seen.
    pub face: Vec3,
}

impl GatherPoint {
    /// A point of a flat face.
    pub fn on_face((position, normal): (Vec3, Vec3)) -> Self {
        Self { position, normal, face: normal }
    }

    /// A direction, mirrored at the face where it would lead behind it: what is curved would be
    /// seen there.
    fn in_front(&self, direction: Vec3) -> Vec3 {
        direction - 2.0 * self.face.dot(direction).min(0.0) * self.face
    }
}

/// Result of an aimed ray.
pub(super) enum Lit {
    /// Emission, W/m².
    Emitter(Vec3),
    /// A place that reflects.
    Secondary(Met),
}

/// How light came to where it is followed further.
pub(super) struct Path {
    /// Of its random numbers.
    pub seed: u64,
    /// Reflections after that where the first ray ended.
    pub length: u32,
    /// Share of what is sent there that arrives where the first ray ended.
    pub throughput: Vec3,
    /// Whether it left what is near.
    pub is_beyond: bool,
}

impl Path {
    /// The path where the first ray ended, of which so much arrives.
    pub fn start(seed: u64, throughput: Vec3) -> Self {
        Self { seed, length: 0, throughput, is_beyond: false }
    }
}

/// A report on light that is followed.
pub(super) enum Followed<'a> {
    /// So many rays were cast.
    Cast(u32),
    /// The field was read at a place, with the path to it.
    Read(&'a Met, &'a Path),
}

impl Field {
    /// A glance from a point: number `index` of the sequence that the seed tells.
    pub fn glance(&self, place: &GatherPoint, rays: GlanceRays, (seed, index): (u64, u32)) -> Glance {
        let GatherPoint { position: point, normal, face } = *place;
        let mut glance = Glance::default();
        let scramble = |what: u32, number: u32| hash64(hash64(seed, what.into()), (number / SEQUENCE).into());
        for ray in 0..rays.aimed {
            let number = index.wrapping_mul(rays.aimed).wrapping_add(ray);
            let hash = scramble(1, number);
            let [choice, u, v, _] = sobol_burley::sample_4d(number % SEQUENCE, 0, hash as u32);
            let beyond = hash64(hash, number.into());
            match self.aim_from(place, [choice, u, v]) {
                Some((Lit::Emitter(emission), weight)) => glance.direct += weight / rays.aimed as f32 * emission,
                Some((Lit::Secondary(met), weight)) => {
                    glance.indirect += weight / rays.aimed as f32 * self.sent_back(&met, point, beyond);
                }
                None => {}
            }
        }
        let sky = self.sky_rays(rays.cosine, rays.aimed);
        for ray in 0..rays.cosine {
            let number = index.wrapping_mul(rays.cosine).wrapping_add(ray);
            let hash = scramble(2, number);
            let [u, v, ..] = sobol_burley::sample_4d(number % SEQUENCE, 0, hash as u32);
            let beyond = hash64(hash, number.into());
            let share = 1.0 / rays.cosine as f32;
            let drawn = cosine_direction(normal, u, v);
            let direction = place.in_front(drawn);
            match self.meet(point, face, direction) {
                End::Face(met) => {
                    glance.nearness += share / met.position.distance(point).max(f32::MIN_POSITIVE);
                    if !self.is_aimed_at(met.leaf, point, normal) {
                        glance.indirect += share * self.sent_back(&met, point, beyond);
                    }
                }
                End::Outside => glance.indirect += self.sky_along(point, direction, normal.dot(drawn), sky),
                End::Back => {}
            }
        }
        if self.outside().is_some() {
            for ray in 0..sky.drawn.max(1) {
                let number = index.wrapping_mul(sky.drawn.max(1)).wrapping_add(ray);
                let [u, v, w, x] = sobol_burley::sample_4d(number % SEQUENCE, 0, scramble(3, number) as u32);
                if ray < sky.drawn {
                    glance.direct += self.sky_drawn(place, [u, v], sky);
                }
                if ray == 0 {
                    glance.sun += self.sun_light(place, [w, x]);
                }
            }
        }
        glance
    }

    /// Irradiance by rays that are aimed at the sky, if it is uneven, and at the sun, W/m².
    fn light_from_outside(&self, point: (Vec3, Vec3), seed: u64) -> Vec3 {
        let place = GatherPoint::on_face(point);
        let [u, v, w, x] = [7, 8, 9, 10].map(|what| fraction(hash64(seed, what) as u32));
        let sky = self.sky_rays(1, 1);
        let drawn = if sky.drawn > 0 { self.sky_drawn(&place, [u, v], sky) } else { Vec3::ZERO };
        drawn + self.sun_light(&place, [w, x])
    }

    /// A source that a point sees, chosen by chance, and the share of its radiosity that it stands
    /// for.
    pub(super) fn aim_by_chance(&self, place: (Vec3, Vec3), numbers: [f32; 3]) -> Option<(Lit, f32)> {
        self.aim_from(&GatherPoint::on_face(place), numbers)
    }

    fn aim_from(&self, place: &GatherPoint, [choice, u, v]: [f32; 3]) -> Option<(Lit, f32)> {
        let GatherPoint { position: point, normal, face } = *place;
        let choice = self.sources.tree.choose(point, normal, choice)?;
        let element = self.hierarchy.element(choice.id);
        let Shape::Patch(patch) = &element.shape else { return None };
        if !choice.emits && !self.is_aimed_at(choice.id, point, normal) {
            return None;
        }
        let (corners, count) = self.hierarchy.corner_positions(patch);
        let (span, weight) = sample_polygon((point, normal), &corners[..count], (element, patch.normal), [u, v])?;
        let position = self.on_plane(choice.id, point + span);
        if face.dot(span) <= 0.0 || !self.sees(&mut LastStop::default(), (point, face), (position, patch.normal)) {
            return None;
        }
        let lit = if choice.emits {
            Lit::Emitter(self.surface(patch.polygon).emission)
        } else {
            Lit::Secondary(Met { leaf: choice.id, position })
        };
        Some((lit, weight / choice.probability))
    }

    /// Radiosity that a place reflects towards a point, W/m².
    fn sent_back(&self, met: &Met, from: Vec3, seed: u64) -> Vec3 {
        self.follow(met, from, Path::start(seed, Vec3::ONE), &mut |_| {})
    }

    /// Radiosity that a place reflects towards a point, W/m²: as the field says, unless it is too
    /// coarse for that; then light is followed by one reflection more. What is near often sees but
    /// a strip of what is beyond, so there it is followed once more as well. `tell` learns of it.
    pub(super) fn follow(&self, met: &Met, from: Vec3, path: Path, tell: &mut dyn FnMut(Followed)) -> Vec3 {
        let is_near = self.is_near(met.leaf, met.position, from);
        if path.length >= LONGEST || !is_near && (path.length == 0 || path.is_beyond) {
            tell(Followed::Read(met, &path));
            return self.sent[met.leaf.index()];
        }
        let patch = self.patch(met.leaf);
        let hash = [1, 2, 3].map(|what| hash64(path.seed, what));
        let [choice, u, v, w] =
            [hash[0], hash[0] << 32, hash[1], hash[1] << 32].map(|bits| fraction((bits >> 32) as u32));
        let [x, chance] = [hash[2], hash[2] >> 32].map(|bits| fraction(bits as u32));
        // Russian roulette: in a crevice light is followed as far as it goes, and that is as rare
        // as it is dim.
        let reflectance = self.surface(patch.polygon).reflectance;
        let survival = if path.length == 0 { 1.0 } else { reflectance.max_element() };
        if chance >= survival {
            return Vec3::ZERO;
        }
        let (point, normal) = (met.position, patch.normal);
        tell(Followed::Cast(2));
        let share = reflectance / survival;
        let mut further = |what: u64, met: &Met, weight: f32| {
            let throughput = weight * share * path.throughput;
            let is_beyond = path.is_beyond || !is_near;
            let path = Path { seed: hash64(hash[2], what), length: path.length + 1, throughput, is_beyond };
            weight * share * self.follow(met, point, path, tell)
        };
        let aimed = match self.aim_by_chance((point, normal), [choice, u, v]) {
            Some((Lit::Emitter(emission), weight)) => weight * share * emission,
            Some((Lit::Secondary(met), weight)) => further(1, &met, weight),
            None => Vec3::ZERO,
        };
        let direction = cosine_direction(normal, w, x);
        let scattered = match self.meet(point, normal, direction) {
            End::Face(met) if !self.is_aimed_at(met.leaf, point, normal) => further(2, &met, 1.0),
            End::Outside => share * self.sky_along(point, direction, normal.dot(direction), self.sky_rays(1, 1)),
            End::Face(_) | End::Back => Vec3::ZERO,
        };
        let outside = match self.outside() {
            Some(_) => share * self.light_from_outside((point, normal), hash[2]),
            None => Vec3::ZERO,
        };
        aimed + scattered + outside
    }
}

/// A point of a polygon as a point with a normal sees it: the way there, and what of the polygon's
/// radiosity comes from it to the point.
fn sample_polygon(
    (point, normal): (Vec3, Vec3),
    polygon: &[Vec3],
    (element, polygon_normal): (&Element, Vec3),
    [u, v]: [f32; 2],
) -> Option<(Vec3, f32)> {
    let square = (element.centre - point).length_squared();
    if FAR * element.area < square {
        let span = point_on_polygon(polygon, u, v) - point;
        let square = span.length_squared();
        let cosines = normal.dot(span) * -polygon_normal.dot(span);
        let is_seen = normal.dot(span) > 0.0 && cosines > 0.0;
        return is_seen.then(|| (span, polygon_area(polygon) * cosines / (PI * square * square)));
    }
    let facet = Facet::new(point, normal, polygon)?;
    let sampler = facet.samples(normal, polygon_normal);
    let sample = sampler.at([u, v]);
    (sample.kernel > 0.0).then(|| (sample.span, sample.kernel * sampler.measure() / PI))
}

fn polygon_area(polygon: &[Vec3]) -> f32 {
    match *polygon {
        [a, b, c] => 0.5 * (b - a).cross(c - a).length(),
        [a, b, c, d] => 0.5 * ((b - a).cross(c - a).length() + (c - a).cross(d - a).length()),
        _ => 0.0,
    }
}
