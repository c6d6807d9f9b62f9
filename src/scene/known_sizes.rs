//! The length unit by things whose height everybody knows: doors, chairs, tables, by the names of
//! groups and materials.

use super::draft::Draft;
use super::unit::Unit;
use super::up::UpAxis;

/// Heights of things, m, and the words for them.
const KNOWN: [(f64, &[&str]); 4] = [
    (2.05, &["door", "doors", "tür", "türen", "tuer", "tueren", "porte", "puerta", "porta"]),
    (0.9, &["chair", "chairs", "armchair", "armchairs", "stuhl", "stühle", "stuehle", "chaise", "silla", "sedia"]),
    (0.75, &["table", "tables", "desk", "desks", "tisch", "tische", "schreibtisch", "mesa", "tavolo"]),
    (0.85, &["sofa", "sofas", "couch", "couches"]),
];

/// A thing is as high as usual within this factor, as a logarithm: 1.35. Units are 2.5 times as
/// long as the next one, or more.
const USUAL: f64 = 0.3;

/// So many things of a usual height tell a unit; fewer may be toys.
const ENOUGH: usize = 2;

/// Share of the things of a usual height, in whatever unit, that must agree.
const AGREED: f64 = 2.0 / 3.0;

/// The unit in which most things with a known name have their usual height; none where there are
/// too few of them.
pub(super) fn unit(draft: &Draft, up: UpAxis) -> Option<Unit> {
    let mut votes = [0_usize; Unit::ALL.len()];
    for (usual, height) in things(draft, up) {
        let is_usual = |unit: &Unit| (height * unit.metres() / usual).ln().abs() < USUAL;
        if let Some(unit) = Unit::ALL.iter().position(is_usual) {
            votes[unit] += 1;
        }
    }
    let all: usize = votes.iter().sum();
    let agreed = |count: usize| count >= ENOUGH && count as f64 >= AGREED * all as f64;
    Unit::ALL.into_iter().zip(votes).find(|(_, count)| agreed(*count)).map(|(unit, _)| unit)
}

/// Usual height, m, and height in the file of everything that has a known name.
fn things(draft: &Draft, up: UpAxis) -> Vec<(f64, f64)> {
    // The root has the name of the file.
    let of_groups: Vec<Option<f64>> =
        draft.groups.iter().map(|group| usual_height(&group.name).filter(|_| group.parent.is_some())).collect();
    let of_materials: Vec<Option<f64>> = draft.materials.iter().map(|material| usual_height(&material.name)).collect();
    if of_groups.iter().chain(&of_materials).all(Option::is_none) {
        return Vec::new();
    }
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let (mut groups, mut materials) = (vec![none; of_groups.len()], vec![none; of_materials.len()]);
    let extend = |[low, high]: &mut [f64; 2], [from, to]: [f64; 2]| (*low, *high) = (low.min(from), high.max(to));
    for face in &draft.faces {
        for &corner in &draft.corners[face.corners()] {
            let level = up.along(draft.vertices[corner as usize]);
            extend(&mut groups[face.group.0 as usize], [level; 2]);
            extend(&mut materials[face.material as usize], [level; 2]);
        }
    }
    // What a group holds belongs to it; parents come first.
    for (index, group) in draft.groups.iter().enumerate().rev() {
        if let Some(parent) = group.parent {
            let of_group = groups[index];
            extend(&mut groups[parent.0 as usize], of_group);
        }
    }
    // Of a thing and its parts that are called alike the thing counts.
    let is_part =
        |index: usize| draft.groups[index].parent.is_some_and(|parent| of_groups[parent.0 as usize].is_some());
    let of_groups = of_groups.iter().zip(groups).enumerate().filter(|(index, _)| !is_part(*index)).map(|(_, it)| it);
    let height = |(usual, [low, high]): (&Option<f64>, [f64; 2])| usual.zip((high > low).then_some(high - low));
    of_groups.chain(of_materials.iter().zip(materials)).filter_map(height).collect()
}

/// Usual height of what a name means, m: its last word counts, so that a table lamp is no table.
fn usual_height(name: &str) -> Option<f64> {
    let mut word = String::new();
    for part in name.split(|letter: char| !letter.is_alphabetic()).filter(|part| !part.is_empty()) {
        let begins = part.char_indices().rev().find(|(_, letter)| letter.is_uppercase()).map(|(at, _)| at);
        let is_shouted = part.chars().all(char::is_uppercase);
        word = part[begins.filter(|_| !is_shouted).unwrap_or(0)..].to_lowercase();
    }
    KNOWN.iter().find(|(_, words)| words.contains(&word.as_str())).map(|(height, _)| *height)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn the_last_word_of_a_name_counts() {
        for (name, height) in [
            ("Chair.003", Some(0.9)),
            ("officeChair_2", Some(0.9)),
            ("DOOR", Some(2.05)),
            ("Table Lamp", None),
            ("door frame", None),
            ("portable", None),
            ("Tisch", Some(0.75)),
            ("", None),
            ("12", None),
        ] {
            assert_eq!(usual_height(name), height, "{name}");
        }
    }

    /// Things by name and height, each an upright triangle.
    fn draft(things: &[(&str, f64)]) -> Draft {
        let mut draft = Draft::new("room");
        for (index, (name, height)) in things.iter().enumerate() {
            let group = draft.add_group(name, crate::scene::GroupId(0));
            draft.vertices.extend([DVec3::ZERO, DVec3::X, DVec3::new(0.0, *height, 0.0)]);
            let first = 3 * index as u32;
            draft.add_face(&[first, first + 1, first + 2], 0, group);
        }
        draft.materials.push(crate::scene::draft::DraftMaterial::new("white"));
        draft
    }

    /// Truth: heights of a door, a chair and a table in the unit named; too few, or toys and a tall
    /// cabinet, tell nothing.
    #[test]
    fn doors_and_chairs_tell_the_unit() {
        for unit in Unit::ALL {
            let things = [("door", 2.1), ("Chair.001", 0.85), ("dining table", 0.74), ("wall", 9.8)];
            let things = things.map(|(name, height)| (name, height / unit.metres()));
            assert_eq!(super::unit(&draft(&things), UpAxis::Y), Some(unit));
        }
        for none in [&[("door", 7.0)][..], &[("cabinet", 7.0), ("wall", 8.0)], &[("chair", 3.0), ("table", 0.75)]] {
            assert_eq!(super::unit(&draft(none), UpAxis::Y), None, "{none:?}");
        }
    }
}
