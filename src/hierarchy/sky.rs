//! The outside in the hierarchy: parts of the sky and the sun, elements beside the scene's own.
//!
//! Light from outside has a direction and no place, so a part is a spherical triangle of
//! directions, split 1→4 like a patch, or the sun's disc. It sends as a surface of radiosity πL
//! would whose form factor is the projected solid angle over π; nothing is sent to it.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec3;

use super::{Element, ElementId, Hierarchy, NO_PARENT, Shape};
use crate::base::random::hash64;
use crate::scene::Scene;
use crate::scene::outside::{Outside, Sun};

/// Parts are split no further than to this level: 1.4° wide.
pub const DEEPEST_SKY: u8 = 6;
/// A part's radiance is the mean over triangles of this level: the same for a part and its
/// quarters.
const SAMPLED_LEVEL: u8 = 7;
/// So many times half the scene's diagonal away, a part's centre stands for its direction: lines to
/// it are parallel up to 1e-4.
const FAR: f32 = 1e4;
/// Marks the keys of what lies outside.
const KEY: u64 = 0x0073_6b79;

/// A part of what lies outside.
#[derive(Clone, Copy, Debug)]
pub struct SkyPart {
    /// Unit vectors to the corners, clockwise as seen from inside; all alike for the sun.
    pub corners: [Vec3; 3],
    /// Unit vector to the middle.
    pub direction: Vec3,
    /// Solid angle, sr.
    pub solid_angle: f32,
    /// π times the mean radiance, W/m².
    pub radiosity: Vec3,
    /// ∫L·ω dω over the mean radiance, sr: its dot product with the normal of a face that sees all
    /// of the part is the projected solid angle by which the mean radiance counts, however uneven
    /// the radiance is.
    pub weighted: Vec3,
    /// Subdivision level.
    pub level: u8,
    /// Whether it is the sun's disc.
    pub is_sun: bool,
}

/// The outside of a hierarchy: what parts are made of.
#[derive(Clone)]
pub(super) struct Surroundings {
    outside: Arc<Outside>,
    /// Middle of the scene.
    centre: Vec3,
    /// Half the scene's diagonal.
    radius: f32,
    /// The elements that are no parts of others.
    roots: std::ops::Range<u32>,
    /// All parts, those of the roots first.
    parts: Vec<SkyPart>,
}

impl SkyPart {
    fn triangle(corners: [Vec3; 3], level: u8, outside: &Outside) -> Self {
        let (mut sum, mut light, mut weighted) = (0.0, Vec3::ZERO, Vec3::ZERO);
        add_up(corners, SAMPLED_LEVEL.saturating_sub(level), &mut |corners| {
            let solid_angle = solid_angle(corners);
            sum += solid_angle;
            let (direction, radiance) = (middle(corners), outside.radiance(middle(corners)));
            light += solid_angle * radiance;
            weighted += solid_angle * radiance.element_sum() * direction;
        });
        let radiosity = if sum > 0.0 { PI / sum * light } else { Vec3::ZERO };
        let mean = light.element_sum() / sum;
        let weighted = if mean > 0.0 { weighted / mean } else { Vec3::ZERO };
        Self { corners, direction: middle(corners), solid_angle: sum, radiosity, weighted, level, is_sun: false }
    }

    fn sun(sun: &Sun) -> Self {
        let direction = sun.direction;
        let (solid_angle, radiosity) = (Sun::solid_angle(), PI * sun.radiance());
        let (corners, weighted) = ([direction; 3], solid_angle * direction);
        Self { corners, direction, solid_angle, radiosity, weighted, level: DEEPEST_SKY, is_sun: true }
    }

    /// Whether all of the part, or the sun's middle, is above the horizon of a face with this
    /// normal.
    pub fn is_above(&self, normal: Vec3) -> bool {
        self.is_sun || self.corners.iter().all(|corner| normal.dot(*corner) >= 0.0)
    }

    /// A direction of the part at `(u, v)` of the unit square, and the solid angle that it stands
    /// for among directions spread so, sr.
    pub fn direction_at(&self, u: f32, v: f32) -> (Vec3, f32) {
        if self.is_sun {
            return (self.direction, self.solid_angle);
        }
        let [a, b, c] = self.corners;
        let root = u.sqrt();
        let point = a + root * ((1.0 - v) * (b - a) + v * (c - a));
        let across = 0.5 * (b - a).cross(c - a);
        let distance = point.length();
        (point / distance, across.dot(point).abs() / (distance * distance * distance))
    }
}

/// Visits the triangles that a spherical triangle becomes by so many splits.
fn add_up(corners: [Vec3; 3], splits: u8, visit: &mut impl FnMut([Vec3; 3])) {
    if splits == 0 {
        visit(corners);
    } else {
        quarters(corners).into_iter().for_each(|quarter| add_up(quarter, splits - 1, visit));
    }
}

fn middle([a, b, c]: [Vec3; 3]) -> Vec3 {
    (a + b + c).normalize()
}

fn quarters([a, b, c]: [Vec3; 3]) -> [[Vec3; 3]; 4] {
    let (ab, bc, ca) = ((a + b).normalize(), (b + c).normalize(), (c + a).normalize());
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]]
}

/// Solid angle of a spherical triangle [Van Oosterom, Strackee 1983], sr.
fn solid_angle([a, b, c]: [Vec3; 3]) -> f32 {
    let volume = a.dot(b.cross(c)).abs();
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

impl Hierarchy {
    /// Adds what shines in from outside of a scene: the lit octants of the sky, and the sun.
    pub(super) fn add_outside(&mut self, scene: &Scene) {
        let Some(outside) = scene.outside() else { return };
        let (lower, upper) = scene.bounds();
        let first = self.elements.len() as u32;
        let centre = 0.5 * (lower + upper);
        let radius = (0.5 * lower.distance(upper)).max(f32::MIN_POSITIVE);
        let mut parts: Vec<SkyPart> = Vec::new();
        if outside.has_sky() {
            let up = outside.up();
            let (east, north) = up.any_orthonormal_pair();
            for octant in 0..8 {
                let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
                let (a, b, c) = (sign(0) * east, sign(1) * north, sign(2) * up);
                let corners = if a.cross(b).dot(c) < 0.0 { [a, b, c] } else { [a, c, b] };
                parts.push(SkyPart::triangle(corners, 0, outside));
            }
        }
        parts.extend(outside.sun().map(SkyPart::sun));
        parts.retain(|part| part.radiosity.max_element() > 0.0);
        let roots = first..first + parts.len() as u32;
        let mut around = Surroundings { outside: outside.clone(), centre, radius, roots, parts: Vec::new() };
        for (number, part) in parts.into_iter().enumerate() {
            let element = around.add(part, NO_PARENT, hash64(KEY, number as u64));
            self.elements.push(element);
        }
        self.around = Some(around);
    }

    /// The elements of the outside that are no parts of others: octants of the sky, and the sun.
    pub fn outside(&self) -> impl ExactSizeIterator<Item = ElementId> + Clone + use<> {
        self.around.as_ref().map_or(0..0, |around| around.roots.clone()).map(ElementId)
    }

    /// Forgets what lies outside, before anything was split.
    pub fn close(&mut self) {
        if let Some(around) = self.around.take() {
            self.elements.truncate(around.roots.start as usize);
        }
    }

    /// A part of what lies outside, by its number.
    pub fn sky_part(&self, number: u32) -> &SkyPart {
        &self.around.as_ref().expect("there are parts where there is an outside").parts[number as usize]
    }

    /// Splits a part of the sky into four; the sun stays whole.
    pub(super) fn subdivide_sky(&mut self, id: ElementId) {
        let parent = *self.element(id);
        let (Shape::Sky(number), Some(around)) = (parent.shape, &mut self.around) else { return };
        let part = around.parts[number as usize];
        if part.is_sun || !parent.is_leaf() {
            return;
        }
        let first_child = self.elements.len() as u32;
        for (index, corners) in quarters(part.corners).into_iter().enumerate() {
            let quarter = SkyPart::triangle(corners, part.level + 1, &around.outside);
            self.elements.push(around.add(quarter, id.0, hash64(parent.key, index as u64 + 1)));
        }
        let element = &mut self.elements[id.index()];
        (element.first_child, element.child_count) = (first_child, 4);
    }
}

impl Surroundings {
    /// The surroundings before any part was split.
    pub fn whole(&self) -> Self {
        let parts = self.parts[..self.roots.len()].to_vec();
        Self { outside: self.outside.clone(), roots: self.roots.clone(), parts, ..*self }
    }

    /// Memory of the parts, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.parts[..])
    }

    fn add(&mut self, part: SkyPart, parent: u32, key: u64) -> Element {
        let number = self.parts.len() as u32;
        self.parts.push(part);
        // As large as on the sphere around the scene: what decides which end of a pair is split.
        let area = part.solid_angle * self.radius * self.radius;
        Element {
            parent,
            first_child: 0,
            child_count: 0,
            area,
            sampled_area: area,
            centre: self.centre + FAR * self.radius * part.direction,
            key,
            shape: Shape::Sky(number),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Reachability;
    use crate::hierarchy::ClusteringMode;
    use crate::scene::builtin::BuiltinScene;
    use crate::scene::outside::Daylight;

    fn hierarchy(sky: &str, sun: Option<&str>) -> Hierarchy {
        let mut scene = BuiltinScene::Cornell.build();
        let sun = sun.map(|sun| sun.parse().expect("a sun"));
        scene.add_daylight(&Daylight { sky: Some(sky.parse().expect("a sky")), sun }).expect("daylight");
        Hierarchy::new(&scene, Arc::<Reachability>::default(), ClusteringMode::Adaptive, 1)
    }

    fn part(hierarchy: &Hierarchy, id: ElementId) -> SkyPart {
        match hierarchy.element(id).shape {
            Shape::Sky(number) => *hierarchy.sky_part(number),
            _ => panic!("the outside consists of its parts"),
        }
    }

    /// Truth: an octant has π/2 sr; of a sky that shines above the horizon alone there are four,
    /// and they bring what was asked for: E_h = ∫L cosθ dω. Quarters have their parent's solid
    /// angle and power together.
    #[test]
    fn parts_hold_what_the_sky_sends() {
        for (sky, sun, roots) in [("overcast:100W", None, 4), ("clear:100W", Some("az:120,el:35,300W"), 5)] {
            let mut hierarchy = hierarchy(sky, sun);
            let known = hierarchy.elements().len();
            let octants: Vec<ElementId> = hierarchy.outside().collect();
            assert_eq!(octants.len(), roots);
            let mut all: Vec<ElementId> = octants.iter().copied().take(4).collect();
            for &octant in &all {
                assert!((part(&hierarchy, octant).solid_angle - 0.5 * PI).abs() < 1e-4);
            }
            for _ in 0..4 {
                let mut next = Vec::new();
                for id in all {
                    hierarchy.subdivide(id);
                    let own = part(&hierarchy, id);
                    let children: Vec<SkyPart> =
                        hierarchy.element(id).children().map(|child| part(&hierarchy, child)).collect();
                    let angles: f32 = children.iter().map(|part| part.solid_angle).sum();
                    let power: f32 = children.iter().map(|part| part.solid_angle * part.radiosity.x).sum();
                    assert!((angles - own.solid_angle).abs() < 1e-4 * own.solid_angle);
                    assert!(
                        (power - own.solid_angle * own.radiosity.x).abs() < 1e-3 * own.solid_angle * own.radiosity.x
                    );
                    next.extend(hierarchy.element(id).children());
                }
                all = next;
            }
            let up = Vec3::Y;
            let brought = |id: &ElementId| {
                let part = part(&hierarchy, *id);
                part.solid_angle / PI * part.radiosity.x * part.direction.dot(up).max(0.0)
            };
            let level: f32 = all.iter().map(brought).sum();
            assert!((level - 100.0).abs() < 0.3, "{sky}: {level}");
            // What was split is merged back, and nothing else changes.
            let (merged, _) = hierarchy.merged_back(|_| false);
            assert_eq!(merged.elements().len(), known);
            assert_eq!(merged.outside().collect::<Vec<_>>(), octants);
        }
    }

    /// Truth: directions weighed by the solid angle that they stand for add up to the part's, and
    /// lie in it.
    #[test]
    fn directions_stand_for_the_solid_angle() {
        let hierarchy = hierarchy("uniform", None);
        let octant = hierarchy.outside().next().map(|id| part(&hierarchy, id)).expect("an octant");
        let count = 20_000;
        let mut sum = 0.0;
        for index in 0..count {
            let [u, v] = crate::base::random::r2_sequence(3, index);
            let (direction, stands_for) = octant.direction_at(u, v);
            assert!(direction.is_normalized() && octant.direction.dot(direction) > 0.5);
            sum += stands_for / count as f32;
        }
        assert!((sum - octant.solid_angle).abs() < 0.01 * octant.solid_angle, "{sum}");
    }
}
