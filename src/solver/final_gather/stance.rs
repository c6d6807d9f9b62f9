//! Stances: where the light of a vertex is looked for.
//!
//! A vertex may lie in the corner of a room, where half of all directions lead into the wall, or on an edge between faces that are
//! turned differently. It is looked at from a little inside of the leaves around it, once for each plane that they lie in; and
//! where something stands on it, from as far inside as light can reach.

use glam::Vec3;

use super::super::display::Display;
use crate::geometry::EnclosureTest;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::random::mix;

/// A stance lies this share of the way from the vertex to the middle of its leaves, the first that light can reach.
const INSIDE: [f32; 5] = [0.15, 0.3, 0.5, 0.7, 1.0];
/// From the middle of a leaf stances are looked for towards its corners, at these shares of the way.
const OUTWARD: [f32; 3] = [0.3, 0.6, 0.9];
/// Rays that must all meet backs before a place is believed to be hidden.
const RAYS: u32 = 16;
/// Leaves whose normals have at least this cosine lie in one plane.
const SAME_PLANE: f32 = 0.9999;
/// What weighs less than this share of a vertex is not looked at.
const LEAST_WEIGHT: f32 = 0.02;

/// A place to look from.
#[derive(Clone, Copy, Debug)]
pub struct Stance {
    /// Position.
    pub position: Vec3,
    /// Unit normal of the bright side.
    pub normal: Vec3,
    /// Its share of the vertex; they sum to 1.
    pub weight: f32,
}

/// Finds the stances of vertices.
pub struct Finder<'a> {
    pub display: &'a Display,
    pub hierarchy: &'a Hierarchy,
    /// Tells what is hidden inside of things.
    pub darkness: Option<&'a EnclosureTest<'a>>,
    pub seed: u64,
}

/// The leaves of one plane around a vertex.
struct Plane {
    normal: Vec3,
    weight: f32,
    /// Mean middle of the leaves, times their weight.
    middle: Vec3,
    /// The heaviest leaf.
    leaf: (ElementId, f32),
}

impl Finder<'_> {
    /// Those of a vertex, none where it is hidden, and its direct irradiance by what `direct` says of each.
    pub fn find(&self, vertex: usize, direct: &mut impl FnMut(&Stance) -> Vec3) -> (Box<[Stance]>, Vec3) {
        let position = Vec3::from(self.display.mesh.positions[vertex]);
        let mut planes: Vec<Plane> = Vec::with_capacity(1);
        for &(leaf, weight) in self.display.around(vertex) {
            let id = self.display.mesh.leaves[leaf as usize].element;
            let element = self.hierarchy.element(id);
            let Shape::Patch(patch) = element.shape else { continue };
            if weight < LEAST_WEIGHT {
                continue;
            }
            let middle = weight * element.centre;
            match planes.iter_mut().find(|plane| plane.normal.dot(patch.normal) >= SAME_PLANE) {
                Some(plane) => {
                    plane.middle += middle;
                    plane.weight += weight;
                    if weight > plane.leaf.1 {
                        plane.leaf = (id, weight);
                    }
                }
                None => planes.push(Plane { normal: patch.normal, weight, middle, leaf: (id, weight) }),
            }
        }
        let mut lit: Vec<(Stance, Vec3)> =
            planes.iter().filter_map(|plane| self.stance(vertex, position, plane, direct)).collect();
        let total: f32 = lit.iter().map(|(stance, _)| stance.weight).sum();
        lit.iter_mut().for_each(|(stance, _)| stance.weight /= total);
        let irradiance = lit.iter().map(|(stance, irradiance)| stance.weight * *irradiance).sum();
        (lit.into_iter().map(|(stance, _)| stance).collect(), irradiance)
    }

    /// The first place on the way from a vertex into its leaves that light can reach, with the direct light there.
    fn stance(
        &self,
        vertex: usize,
        position: Vec3,
        plane: &Plane,
        direct: &mut impl FnMut(&Stance) -> Vec3,
    ) -> Option<(Stance, Vec3)> {
        let mut at = |position: Vec3| {
            let stance = Stance { position, normal: plane.normal, weight: plane.weight };
            let irradiance = direct(&stance);
            // Where lamps shine nothing is hidden, and nobody needs to ask.
            let is_reached = irradiance != Vec3::ZERO || !self.hides(vertex, position, plane.normal);
            is_reached.then_some((stance, irradiance))
        };
        let element = self.hierarchy.element(plane.leaf.0);
        let Shape::Patch(patch) = &element.shape else { return None };
        let (corners, count) = self.hierarchy.corner_positions(patch);
        let first = position.lerp(plane.middle / plane.weight, INSIDE[0]);
        let inward = INSIDE[1..].iter().map(|share| position.lerp(element.centre, *share));
        let outward =
            OUTWARD.iter().flat_map(|share| corners[..count].iter().map(|corner| element.centre.lerp(*corner, *share)));
        std::iter::once(first).chain(inward).chain(outward).find_map(&mut at)
    }

    fn hides(&self, vertex: usize, place: Vec3, normal: Vec3) -> bool {
        self.darkness.is_some_and(|darkness| darkness.encloses(place, normal, mix(self.seed, vertex as u64), RAYS))
    }
}
