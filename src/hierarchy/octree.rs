//! Uniform octree of the bounding box: a polygon goes into the smallest cell that holds it whole
//! (section 2.2, [7]).

use glam::Vec3;

use super::grouping::{Grouping, PolygonBounds};

/// Groups polygons by octree cells down to `depth`, the root being level 1.
pub(super) fn group(bounds: &PolygonBounds, polygons: Vec<u32>, depth: u32) -> Grouping {
    let (lower, upper) = bounds.around(&polygons);
    if polygons.is_empty() {
        return Grouping::default();
    }
    // Cells are cubes, as in a uniform subdivision of space.
    let half = 0.5 * (upper - lower).max_element();
    cell(bounds, polygons, 0.5 * (lower + upper), half, depth)
}

fn cell(bounds: &PolygonBounds, polygons: Vec<u32>, centre: Vec3, half: f32, levels: u32) -> Grouping {
    if levels <= 1 || polygons.len() <= 1 {
        return Grouping { groupings: Vec::new(), polygons };
    }
    let mut octants: [Vec<u32>; 8] = Default::default();
    let mut straddling = Vec::new();
    for polygon in polygons {
        let (lower, upper) = (bounds.lower[polygon as usize], bounds.upper[polygon as usize]);
        let above = lower.cmpge(centre).bitmask();
        let below = upper.cmple(centre).bitmask();
        if above | below == 0b111 {
            octants[(above & !below) as usize].push(polygon);
        } else {
            straddling.push(polygon);
        }
    }
    let inner = octants.into_iter().enumerate().filter(|(_, inside)| !inside.is_empty()).map(|(octant, inside)| {
        let side = |axis: usize| if octant >> axis & 1 == 1 { 0.5 * half } else { -0.5 * half };
        cell(bounds, inside, centre + Vec3::new(side(0), side(1), side(2)), 0.5 * half, levels - 1)
    });
    Grouping { groupings: inner.collect(), polygons: straddling }
}
