//! The scene's own hierarchy as clusters: the paper's hand-made ones (USER in Table 2).

use super::adaptive;
use super::build::{Grouping, PolygonBounds};
use crate::scene::Scene;

/// A group with more polygons than this directly inside gets clusters of its own for them, built as in
/// [`super::ClusteringMode::Adaptive`]: scanned meshes come as one object of many thousand faces, and its self-link would
/// ask about every pair of them.
const MOST_DIRECT_POLYGONS: usize = 64;

/// Groups polygons as the scene does.
pub(super) fn group(scene: &Scene, bounds: &PolygonBounds) -> Grouping {
    let mut groupings: Vec<Grouping> = scene.groups.iter().map(|_| Grouping::default()).collect();
    for (index, polygon) in scene.polygons.iter().enumerate() {
        groupings[polygon.group.0 as usize].polygons.push(index as u32);
    }
    for (index, group) in scene.groups.iter().enumerate().rev() {
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
