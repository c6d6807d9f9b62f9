//! Whether a room stands within a larger space, as a house does under a sky: that space goes all
//! the way round it.
//!
//! From within the room, lines are drawn through its walls and whatever stands behind them. Middles
//! of the gaps that they cross are nodes; nodes of neighbouring lines that see each other lie in
//! one space. Those that a place outside sees, directly or from node to node, tell in which
//! directions its space lies behind the room's own walls. Rooms beside each other do not go round
//! each other: most lines leave both for the open, which goes round every room.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::geometry::Occluders;
use crate::scene::Scene;

/// Lines around a room, in each of the slopes.
pub(super) const AROUND: usize = 48;
const SLOPES: [f32; 3] = [0.0, 0.6, 2.0];
/// A shorter gap is none, and of a longer one its beginning counts, m.
const LEAST_GAP: f32 = 1.0;
const LONGEST_GAP: f32 = 40.0;
/// Faces that one line may cross.
const MOST_CROSSINGS: usize = 64;
/// A line ends here, in its lengths to the first face: just before it.
const END: f32 = 0.98;
/// Least share of lines behind whose first face the outer space lies; others leave through windows
/// and doors.
const AROUND_IT: f32 = 0.6;

/// A level direction, by its step of so many around.
pub(super) fn heading(up: Vec3, step: usize, steps: usize) -> Vec3 {
    let (right, forward) = up.any_orthonormal_pair();
    let angle = TAU * step as f32 / steps as f32;
    angle.cos() * right + angle.sin() * forward
}

/// In which level directions walls part a room from the space that a place outside lies in; `None`
/// where that does not go round it.
pub(super) fn walls(scene: &Scene, occluders: &Occluders, outside: Vec3, room: Vec3) -> Option<[bool; AROUND]> {
    let up = scene.up_axis();
    let direction = |line: usize| (heading(up, line % AROUND, AROUND) + SLOPES[line / AROUND] * up).normalize();
    let lines = 0..SLOPES.len() * AROUND;
    let mut unseen: Vec<Vec<Vec3>> =
        lines.clone().map(|line| gaps_behind(scene, occluders, room, direction(line))).collect();
    let mut seen: Vec<Vec<Vec3>> = vec![Vec::new(); unseen.len()];
    let beside = |line: usize| {
        let (slope, step) = (line / AROUND, line % AROUND);
        [1, AROUND - 1].map(|by| slope * AROUND + (step + by) % AROUND)
    };
    let neighbours = |line: usize| {
        let steeper = (line + AROUND < SLOPES.len() * AROUND).then_some(line + AROUND);
        beside(line).into_iter().chain(steeper).chain(line.checked_sub(AROUND))
    };
    let mut waiting = Vec::new();
    let mut see = |from: Vec3, line: usize, waiting: &mut Vec<(usize, Vec3)>| {
        let nodes: Vec<Vec3> = unseen[line].extract_if(.., |node| !occluders.occluded(from, *node)).collect();
        waiting.extend(nodes.iter().map(|node| (line, *node)));
        seen[line].extend(nodes);
    };
    lines.clone().for_each(|line| see(outside, line, &mut waiting));
    while let Some((line, node)) = waiting.pop() {
        neighbours(line).for_each(|neighbour| see(node, neighbour, &mut waiting));
    }
    let around = lines.clone().filter(|line| !seen[*line].is_empty()).count();
    if (around as f32) < AROUND_IT * lines.len() as f32 {
        return None;
    }
    // Trees and fences are no walls of a room that looks out on them: a line ends outdoors where a
    // node beside it sees its end, or the end of the line beside it that does.
    let end = |line: usize| {
        let hit = occluders.first_hit(room, direction(line))?;
        Some(room + END * hit.distance * direction(line))
    };
    let ends: [Option<Vec3>; AROUND] = std::array::from_fn(end);
    let sees = |from: Vec3, line: usize| ends[line].is_some_and(|end| !occluders.occluded(from, end));
    let mut is_out: [bool; AROUND] =
        std::array::from_fn(|line| beside(line).iter().any(|other| seen[*other].iter().any(|node| sees(*node, line))));
    let mut waiting: Vec<usize> = (0..AROUND).filter(|line| is_out[*line]).collect();
    while let Some(line) = waiting.pop() {
        for other in beside(line) {
            if !is_out[other] && ends[line].is_some_and(|end| sees(end, other)) {
                is_out[other] = true;
                waiting.push(other);
            }
        }
    }
    Some(std::array::from_fn(|line| !seen[line].is_empty() && !is_out[line]))
}

/// Middles of the gaps along a line behind the first face that it meets.
fn gaps_behind(scene: &Scene, occluders: &Occluders, from: Vec3, direction: Vec3) -> Vec<Vec3> {
    let mut middles = Vec::new();
    let mut met = occluders.first_hit(from, direction);
    for _ in 0..MOST_CROSSINGS {
        let Some(hit) = met else { break };
        let normal = scene.normal(&scene.polygons[hit.polygon as usize]);
        let away = if normal.dot(direction) < 0.0 { -normal } else { normal };
        met = occluders.ray_from(hit.point, away, direction);
        let gap = met.map_or(LONGEST_GAP, |next| next.distance.min(LONGEST_GAP));
        if gap >= LEAST_GAP {
            middles.push(hit.point + 0.5 * gap * direction);
        }
    }
    middles
}
