//! The length unit by how high flat tops lie above their floor: those of seats, tables and
//! worktops, whatever they are called.
//!
//! A room's size alone does not tell feet from metres: a room of 9 feet may be a hall of 9 m.
//! Things do, since people are equally tall everywhere: a hall has chairs of 0.45 m, a room in feet
//! has some of 1.5.

use std::collections::HashMap;

use glam::{DVec2, DVec3};
use petgraph::unionfind::UnionFind;

use super::draft::Draft;
use super::triangulate::newell;
use super::unit::Unit;
use super::up::UpAxis;

/// A kind of thing, in metres.
struct Kind {
    /// Lowest and highest top above the floor.
    level: [f64; 2],
    /// Shortest and longest of a top's shorter sides.
    depth: [f64; 2],
    /// Longest of its longer sides.
    length: f64,
}

/// Seats with beds and sofas, tables with desks, worktops. Their levels are so close that no top
/// has one in two units.
const KINDS: [Kind; 3] = [
    Kind { level: [0.38, 0.53], depth: [0.28, 2.1], length: 3.2 },
    Kind { level: [0.68, 0.8], depth: [0.4, 1.6], length: 4.5 },
    Kind { level: [0.84, 0.96], depth: [0.4, 1.3], length: 5.0 },
];

/// So many things of so many kinds tell a unit; fewer may be plinths or shelves.
const ENOUGH: usize = 3;
const ENOUGH_KINDS: usize = 2;

/// Share of the things that have a usual height, in whatever unit, that must agree.
const AGREED: f64 = 2.0 / 3.0;

/// Height of a usual room, m. Metres are believed in higher ones too.
const ROOM: [f64; 2] = [2.1, 4.5];

/// A face is flat if its normal's cosine with the axis is no smaller.
const FLAT: f64 = 0.999;

/// Levels that differ by less than this share of the scene's height are one.
const ONE_LEVEL: f64 = 0.003;

/// Levels with this share of the largest one's area are floors and ceilings.
const LARGE: f64 = 1.0 / 3.0;

/// The thickness of boards and slabs is below this share of the scene's height.
const SLAB: f64 = 0.025;

/// Least share of the box around it that a top fills; a round one turned by any angle fills more.
const FILLED: f64 = 0.4;

/// The unit in which most flat tops of a scene of this height lie as high as those of furniture;
/// none where there are too few of them.
pub(super) fn unit(draft: &Draft, up: UpAxis, height: f64) -> Option<Unit> {
    // Lower rooms are none in any other unit.
    if height * Unit::Foot.metres() < ROOM[0] {
        return None;
    }
    let tops = tops(draft, up, height);
    let mut votes = [[0_usize; KINDS.len()]; Unit::ALL.len()];
    for top in &tops {
        for (unit, votes) in Unit::ALL.into_iter().zip(&mut votes) {
            if let Some(kind) = top.kind(unit) {
                votes[kind] += 1;
            }
        }
    }
    let count = |votes: &[usize; KINDS.len()]| votes.iter().sum::<usize>();
    let all: usize = votes.iter().map(count).sum();
    let tells = |votes: &[usize; KINDS.len()]| {
        let kinds = votes.iter().filter(|votes| **votes > 0).count();
        kinds >= ENOUGH_KINDS && count(votes) >= ENOUGH && count(votes) as f64 >= AGREED * all as f64
    };
    Unit::ALL.into_iter().zip(&votes).find(|(_, votes)| tells(votes)).map(|(unit, _)| unit)
}

/// A flat face, or several that meet, in the file's unit.
#[derive(Clone, Copy)]
struct Top {
    /// Level above the floor.
    level: f64,
    /// Height of the room that it is in.
    room: f64,
    lower: DVec2,
    upper: DVec2,
    area: f64,
}

impl Top {
    /// Kind of thing that has such a top in this unit.
    fn kind(&self, unit: Unit) -> Option<usize> {
        let metres = |length: f64| length * unit.metres();
        let sides = self.upper - self.lower;
        let [depth, length] = [sides.min_element(), sides.max_element()].map(metres);
        let is_within = |value: f64, [least, most]: [f64; 2]| value >= least && value <= most;
        let has_room = unit == Unit::Metre || is_within(metres(self.room), ROOM);
        if !has_room || self.area < FILLED * sides.element_product() {
            return None;
        }
        let fits = |kind: &Kind| {
            is_within(metres(self.level), kind.level) && is_within(depth, kind.depth) && length <= kind.length
        };
        KINDS.iter().position(fits)
    }
}

/// All flat tops between a floor and what is above it.
fn tops(draft: &Draft, up: UpAxis, height: f64) -> Vec<Top> {
    let near = ONE_LEVEL * height;
    let mut faces = flat_faces(draft, up, near);
    faces.sort_by(|a, b| a.level.total_cmp(&b.level));
    let mut floors = large_levels(&faces, near);
    // Where there is no ceiling, rooms end with their walls.
    let levels = draft.corners.iter().map(|corner| up.along(draft.vertices[*corner as usize]));
    floors.push(levels.filter(|level| level.is_finite()).fold(f64::NEG_INFINITY, f64::max) + 2.0 * near);
    // The floor below a face and the ceiling above it; floors and ceilings themselves are no tops.
    let storey = |level: f64| {
        let above = floors.partition_point(|floor| *floor < level - near);
        let [floor, ceiling] = [floors.get(above.checked_sub(1)?)?, floors.get(above)?];
        (*ceiling > level + near).then_some([*floor, *ceiling])
    };
    faces.retain(|face| storey(face.level).is_some());
    let mut tops: HashMap<usize, Top> = HashMap::new();
    for (face, part) in faces.iter().zip(parts(&faces, near, SLAB * height)) {
        let Some([floor, ceiling]) = storey(face.level) else { continue };
        let top = tops.entry(part).or_insert(Top {
            level: 0.0,
            room: ceiling - floor,
            lower: DVec2::INFINITY,
            upper: DVec2::NEG_INFINITY,
            area: 0.0,
        });
        // The highest face comes last.
        top.level = face.level - floor;
        top.area += face.area;
        for corner in face.corners() {
            (top.lower, top.upper) = (top.lower.min(*corner), top.upper.max(*corner));
        }
    }
    tops.into_values().collect()
}

/// Levels of floors and ceilings, of faces from the lowest up.
fn large_levels(faces: &[FlatFace], near: f64) -> Vec<f64> {
    let mut levels: Vec<(f64, f64)> = Vec::new();
    for face in faces {
        match levels.last_mut() {
            Some((level, area)) if face.level - *level < near => *area += face.area,
            _ => levels.push((face.level, face.area)),
        }
    }
    let largest = levels.iter().map(|(_, area)| *area).fold(0.0, f64::max);
    levels.into_iter().filter(|(_, area)| *area >= LARGE * largest).map(|(level, _)| level).collect()
}

/// A number for each face, one for those that meet in a corner; the under and the upper side of a
/// slab count as one.
fn parts(faces: &[FlatFace], near: f64, slab: f64) -> Vec<usize> {
    let mut parts = UnionFind::new(faces.len());
    let mut known: HashMap<[i64; 2], usize> = HashMap::new();
    for (index, face) in faces.iter().enumerate() {
        for corner in face.corners() {
            let place = (*corner / near).round().to_array().map(|at| at as i64);
            if let Some(below) = known.insert(place, index)
                && face.level - faces[below].level < slab
            {
                parts.union(below, index);
            }
        }
    }
    parts.into_labeling()
}

/// A flat face seen from above, by its corners; one of many corners by those of the box around it.
struct FlatFace {
    level: f64,
    area: f64,
    corners: [DVec2; 4],
    count: usize,
}

impl FlatFace {
    fn corners(&self) -> &[DVec2] {
        &self.corners[..self.count]
    }
}

/// Faces that look up or down: which of them are bright is not known yet.
fn flat_faces(draft: &Draft, up: UpAxis, near: f64) -> Vec<FlatFace> {
    let (mut positions, mut offsets, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for face in &draft.faces {
        positions.clear();
        positions.extend(draft.corners[face.corners()].iter().map(|corner| draft.vertices[*corner as usize]));
        let Some(first) = positions.first().copied().filter(|first| first.is_finite()) else { continue };
        // Most faces end here.
        if !positions.iter().all(|position| (up.along(*position) - up.along(first)).abs() < near) {
            continue;
        }
        offsets.clear();
        offsets.extend(positions.iter().map(|position: &DVec3| (*position - first).as_vec3()));
        let normal = newell(&offsets);
        let area = 0.5 * normal.length();
        if !(area > 0.0 && area.is_finite() && up.along(normal).abs() >= 2.0 * FLAT * area) {
            continue;
        }
        let lower = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let upper = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let mut flat = FlatFace { level: up.along(first), area, corners: [DVec2::ZERO; 4], count: 4 };
        let [from_above, low, high] = [up.across(first), up.across(lower), up.across(upper)];
        flat.corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        if positions.len() <= 4 {
            flat.count = positions.len();
            flat.corners = [from_above; 4];
            flat.corners.iter_mut().zip(&positions).for_each(|(to, position)| *to = up.across(*position));
        }
        faces.push(flat);
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::super::GroupId;
    use super::super::draft::DraftMaterial;
    use super::*;

    /// Boards by their lower and upper corners, m, with y up, in a room of this size: their upper
    /// and under sides.
    fn room(size: DVec3, boards: &[[DVec3; 2]], unit: Unit, up: UpAxis) -> Draft {
        let mut draft = Draft::new("room");
        draft.materials.push(DraftMaterial::new("white"));
        let slab = 0.2 * DVec3::Y;
        let ground = [[-slab, size.with_y(0.0)], [size.with_y(size.y).with_x(0.0).with_z(0.0), size + slab]];
        for [lower, upper] in ground.iter().chain(boards) {
            for level in [lower.y, upper.y] {
                let first = draft.vertices.len() as u32;
                for [x, z] in [[lower.x, lower.z], [upper.x, lower.z], [upper.x, upper.z], [lower.x, upper.z]] {
                    let at = DVec3::new(x, level, z) / unit.metres();
                    draft.vertices.push(if up == UpAxis::Y { at } else { DVec3::new(at.x, -at.z, at.y) });
                }
                // Triangles, as most files have them.
                draft.add_face(&[first, first + 1, first + 2], 0, GroupId(0));
                draft.add_face(&[first, first + 2, first + 3], 0, GroupId(0));
            }
        }
        draft
    }

    /// A board of this size with its upper side at a level.
    fn board(x: f64, z: f64, [width, depth]: [f64; 2], level: f64) -> [DVec3; 2] {
        [DVec3::new(x, level - 0.03, z), DVec3::new(x + width, level, z + depth)]
    }

    fn unit_of(draft: &Draft, up: UpAxis, height: f64) -> Option<Unit> {
        super::unit(draft, up, height)
    }

    /// Truth: heights of chairs (0.45 m), tables (0.74 m) and worktops (0.9 m) as shops sell them,
    /// beside shelves and a carpet, in rooms and in a hall.
    #[test]
    fn furniture_tells_the_unit_of_rooms() {
        let furniture = [
            board(1.0, 1.0, [1.6, 0.8], 0.74),
            board(1.1, 0.5, [0.42, 0.4], 0.45),
            board(2.0, 0.5, [0.42, 0.4], 0.45),
            board(4.0, 3.3, [0.6, 0.6], 0.9),
            board(0.0, 3.7, [0.9, 0.3], 0.4),
            board(0.0, 3.7, [0.9, 0.3], 1.2),
            board(0.0, 3.7, [0.9, 0.3], 1.8),
            board(2.0, 2.0, [2.0, 1.4], 0.02),
        ];
        for unit in Unit::ALL {
            for up in [UpAxis::Y, UpAxis::Z] {
                for (size, is_known) in [
                    (DVec3::new(5.0, 2.4, 4.0), true),
                    (DVec3::new(6.0, 3.6, 9.0), true),
                    (DVec3::new(20.0, 9.0, 30.0), unit == Unit::Metre),
                ] {
                    let draft = room(size, &furniture, unit, up);
                    let found = unit_of(&draft, up, size.y / unit.metres());
                    // In metres a low room needs no other unit.
                    assert!(
                        found.unwrap_or_default() == unit || !is_known && found.is_none(),
                        "{size} {unit:?}: {found:?}"
                    );
                }
            }
        }
    }

    /// Truth: two storeys of a house; the things of the upper one stand on its own floor.
    #[test]
    fn things_stand_on_the_floor_below_them() {
        let size = DVec3::new(8.0, 5.4, 6.0);
        let storey = [DVec3::new(0.0, 2.5, 0.0), DVec3::new(8.0, 2.7, 6.0)];
        let boards = [
            storey,
            board(1.0, 1.0, [1.6, 0.8], 2.7 + 0.74),
            board(1.1, 0.5, [0.42, 0.4], 2.7 + 0.45),
            board(2.0, 3.5, [0.42, 0.4], 0.45),
        ];
        for unit in [Unit::Foot, Unit::Inch] {
            let draft = room(size, &boards, unit, UpAxis::Y);
            assert_eq!(unit_of(&draft, UpAxis::Y, 5.8 / unit.metres()), Some(unit));
        }
    }

    /// Truth: nothing in an empty room tells metres from feet, nor do plinths, partition walls and
    /// booths of a hall, and two things are too few.
    #[test]
    fn bare_rooms_and_halls_tell_nothing() {
        let hall = DVec3::new(12.0, 9.0, 15.0);
        let plinths = [1.0, 3.0, 5.0, 7.0].map(|x| board(x, 2.0, [1.2, 1.2], 1.4));
        let partitions = [2.0, 6.0].map(|z| board(1.0, z, [6.0, 0.12], 2.4));
        let booths = [2.0, 6.0, 10.0].map(|z| board(1.0, z, [3.0, 3.0], 2.4));
        let walls_and_plinths = [&plinths[..], &partitions].concat();
        let two = [board(1.0, 1.0, [5.0, 2.5], 2.4), board(7.0, 1.0, [1.4, 1.4], 1.45)];
        for boards in [&[][..], &plinths, &partitions, &booths, &walls_and_plinths, &two] {
            let draft = room(hall, boards, Unit::Metre, UpAxis::Y);
            assert_eq!(unit_of(&draft, UpAxis::Y, hall.y), None, "{boards:?}");
        }
    }

    /// Truth: without a ceiling a room ends with its walls.
    #[test]
    fn a_room_may_lack_its_ceiling() {
        let boards = [
            board(1.0, 1.0, [1.6, 0.8], 0.74),
            board(1.1, 0.5, [0.42, 0.4], 0.45),
            board(2.0, 0.5, [0.42, 0.4], 0.45),
            board(0.0, 0.0, [0.1, 0.1], 2.5),
        ];
        let mut draft = room(DVec3::new(5.0, 2.5, 4.0), &boards, Unit::Foot, UpAxis::Y);
        draft.faces.drain(4..8);
        assert_eq!(unit_of(&draft, UpAxis::Y, 2.5 / 0.3048), Some(Unit::Foot));
    }
}
