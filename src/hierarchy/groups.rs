//! The scene's own hierarchy as clusters, or what a person made of it: the paper's hand-made ones
//! (section 2.2, USER in Table 2).

use super::adaptive;
use super::grouping::{Grouping, PolygonBounds};
use crate::scene::Scene;

/// A group with more polygons than this directly inside gets clusters of its own for them, built as
/// in [`super::ClusteringMode::Adaptive`]: scanned meshes come as one object of many thousand
/// faces, and its self-link would ask about every pair of them.
const MOST_DIRECT_POLYGONS: usize = 64;

/// Groups nested deeper than this belong to their ancestor of this depth: files may nest without
/// end, clusters need not.
const DEEPEST: u32 = 64;

/// Groups polygons as the scene's tree of groups does.
pub(super) fn group(scene: &Scene, bounds: &PolygonBounds) -> Grouping {
    let tree = scene.group_tree();
    let groups = tree.groups();
    let mut groupings: Vec<Grouping> = groups.iter().map(|_| Grouping::default()).collect();
    let mut depths: Vec<u32> = Vec::with_capacity(groups.len());
    let mut standing_for: Vec<usize> = Vec::with_capacity(groups.len());
    for (index, group) in groups.iter().enumerate() {
        let parent = group.parent.map(|parent| parent.0 as usize);
        let depth = parent.map_or(0, |parent| depths[parent] + 1);
        let too_deep = parent.filter(|_| depth > DEEPEST);
        depths.push(depth.min(DEEPEST));
        standing_for.push(too_deep.map_or(index, |parent| standing_for[parent]));
    }
    for (index, polygon) in scene.polygons.iter().enumerate() {
        groupings[standing_for[tree.home(polygon.group).0 as usize]].polygons.push(index as u32);
    }
    for (index, group) in groups.iter().enumerate().rev() {
        let mut grouping = std::mem::take(&mut groupings[index]);
        if grouping.polygons.len() > MOST_DIRECT_POLYGONS {
            let own = adaptive::group(bounds, std::mem::take(&mut grouping.polygons));
            grouping.groupings.push(own);
        }
        match group.parent {
            Some(parent) => groupings[parent.0 as usize].groupings.push(grouping),
            None => return grouping,
        }
    }
    Grouping::default()
}
