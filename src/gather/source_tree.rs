//! The tree of what sends light, laid out for those who choose one source of it by chance.
//!
//! Each aimed ray of a glance goes down from the root, at each node to a child by what it could
//! send at most \[stochastic lightcuts, Yuksel 2020\]. Millions of rays do, so the tree holds the
//! powered elements alone, siblings side by side, with all that a choice reads; a cluster of which
//! one child alone sends light is not in it.

use std::f32::consts::PI;

use glam::Vec3;

use super::facet::Facet;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::scene::Surface;

/// A polygon is far where so many times its area is below the square of its distance.
pub(super) const FAR: f32 = 6.0;
/// A patch that sends this share of its power by itself sends all of it.
const WHOLE: f32 = 0.999;

/// A source that was chosen.
pub(super) struct Choice {
    /// The patch.
    pub id: ElementId,
    /// Whether its emission is meant; otherwise what it reflects.
    pub emits: bool,
    /// Probability of this choice.
    pub probability: f32,
}

/// Place of a node.
#[derive(Clone, Copy)]
enum Extent {
    /// Half the extent of a cluster's box, m, and the square of its length.
    Box(Vec3, f32),
    /// The normal of a patch, its area, m², and its corners with their number.
    Patch(Vec3, f32, [Vec3; 4], usize),
}

#[derive(Clone, Copy)]
struct Node {
    id: ElementId,
    /// Power, W (largest colour).
    power: f32,
    centre: Vec3,
    extent: Extent,
    /// Share of the power that a patch emits itself.
    emitted: f32,
    first_child: u32,
    children: u32,
}

/// The tree; the root comes first.
pub(super) struct SourceTree {
    nodes: Vec<Node>,
}

impl SourceTree {
    /// Of the elements that send light; powers in W (largest colour) are parallel to the arena.
    pub fn new(hierarchy: &Hierarchy, surfaces: &[Surface], power: &[f32]) -> Self {
        let powered = |id: ElementId| hierarchy.element(id).children().filter(|child| power[child.index()] > 0.0);
        let node = |mut id: ElementId| {
            loop {
                let mut children = powered(id);
                match (hierarchy.element(id).is_cluster(), children.next(), children.next()) {
                    (true, Some(only), None) => id = only,
                    _ => break,
                }
            }
            let element = hierarchy.element(id);
            let power = power[id.index()];
            let (extent, emitted) = match &element.shape {
                Shape::Patch(patch) => {
                    let (corners, count) = hierarchy.corner_positions(patch);
                    let emission = surfaces[patch.polygon as usize].emission.max_element();
                    let emitted = if patch.level == 0 { element.sampled_area * emission } else { 0.0 };
                    (Extent::Patch(patch.normal, element.area, corners, count), (emitted / power).min(1.0))
                }
                Shape::Cluster(cluster) => {
                    (Extent::Box(cluster.half_extent, cluster.half_extent.length_squared()), 0.0)
                }
                Shape::Sky(_) => unreachable!("what lies outside is no part of the scene"),
            };
            Node { id, power, centre: element.centre, extent, emitted, first_child: 0, children: 0 }
        };
        let is_lit = power.get(Hierarchy::ROOT.index()).is_some_and(|power| *power > 0.0);
        let mut nodes: Vec<Node> = is_lit.then(|| node(Hierarchy::ROOT)).into_iter().collect();
        let mut next = 0;
        while next < nodes.len() {
            let first = nodes.len();
            nodes.extend(powered(nodes[next].id).map(node));
            (nodes[next].first_child, nodes[next].children) = (first as u32, (nodes.len() - first) as u32);
            next += 1;
        }
        Self { nodes }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }

    /// Goes down to a source: at each node to a child by what it could send at most.
    pub fn choose(&self, point: Vec3, normal: Vec3, mut u: f32) -> Option<Choice> {
        let mut node = self.nodes.first()?;
        let mut probability = 1.0;
        loop {
            if node.emitted > 0.0 {
                let is_whole = node.emitted > WHOLE;
                if u < node.emitted || is_whole {
                    let share = if is_whole { 1.0 } else { node.emitted };
                    return Some(Choice { id: node.id, emits: true, probability: probability * share });
                }
                u = (u - node.emitted) / (1.0 - node.emitted);
                probability *= 1.0 - node.emitted;
            }
            if node.children == 0 {
                return Some(Choice { id: node.id, emits: false, probability });
            }
            // A child takes over from those before it with its share of their sum; the random
            // number is used on.
            let (mut total, mut chosen) = (0.0, None);
            let first = node.first_child as usize;
            for child in &self.nodes[first..first + node.children as usize] {
                let most = child.power * child.most_per_power(point, normal);
                if most <= 0.0 {
                    continue;
                }
                total += most;
                let share = most / total;
                if u < share {
                    chosen = Some((child, most));
                    u /= share;
                } else {
                    u = (u - share) / (1.0 - share);
                }
            }
            let (child, most) = chosen?;
            probability *= most / total;
            node = child;
        }
    }
}

impl Node {
    /// A bound, up to a factor common to all, on the irradiance that an element of this place and
    /// size brings for each watt that it sends.
    fn most_per_power(&self, point: Vec3, normal: Vec3) -> f32 {
        let span = self.centre - point;
        let square = span.length_squared();
        match &self.extent {
            Extent::Box(half, radius) => {
                let height = normal.dot(span) + normal.abs().dot(*half);
                let reach = square + radius;
                if height <= 0.0 { 0.0 } else { (height / reach.sqrt()).min(1.0) / square.max(*radius) }
            }
            Extent::Patch(face, area, corners, count) => {
                let descent = -face.dot(span);
                if descent <= 0.0 {
                    return 0.0;
                }
                let corners = &corners[..*count];
                if FAR * area >= square {
                    // Where one corner is near and the centre is not, an estimate would be wrong
                    // many times over.
                    let facet = Facet::new(point, normal, corners);
                    return facet.map_or(0.0, |facet| PI * facet.form_factor / area.max(f32::MIN_POSITIVE));
                }
                let top = corners.iter().map(|corner| normal.dot(*corner - point)).fold(f32::MIN, f32::max);
                if top <= 0.0 {
                    return 0.0;
                }
                let radius = area.sqrt();
                let height = top.min(normal.dot(span) + radius).max(0.1 * top);
                let reach = square + area;
                height * (descent + 0.1 * radius) / (reach * reach)
            }
        }
    }
}
