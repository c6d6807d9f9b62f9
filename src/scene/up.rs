//! Which axis of a file points up: given by its format, by its sidecar or by a person, else guessed
//! by the geometry.

use glam::{DVec2, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::Scene;
use super::draft::Draft;
use super::triangulate::newell;

/// An axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// y, as in glTF and most OBJ files.
    #[default]
    Y = 1,
    /// z, as in building plans.
    Z = 2,
}

impl UpAxis {
    /// The unit vector.
    pub fn vector(self) -> Vec3 {
        Vec3::AXES[self as usize]
    }

    /// A point's level.
    pub(super) fn along(self, at: DVec3) -> f64 {
        at[self as usize]
    }

    /// A point seen along the axis.
    pub(super) fn across(self, at: DVec3) -> DVec2 {
        match self {
            Self::Y => DVec2::new(at.x, at.z),
            Self::Z => DVec2::new(at.x, at.y),
        }
    }

    /// Letter of the axis.
    pub fn letter(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
        }
    }

    /// The axis with this letter.
    pub fn from_letter(letter: &str) -> Option<Self> {
        [Self::Y, Self::Z].into_iter().find(|axis| axis.letter() == letter)
    }
}

impl Scene {
    /// The axis that the scene's file or a person names; else the one nearest to the camera's up, y
    /// without a camera.
    pub fn up_axis(&self) -> Vec3 {
        if let Some(up) = self.frame.up {
            return up.vector();
        }
        let up = self.camera.map_or(Vec3::Y, |camera| camera.up);
        let axis = up.abs().max_position();
        let mut nearest = Vec3::ZERO;
        nearest[axis] = if up[axis] < 0.0 { -1.0 } else { 1.0 };
        nearest
    }
}

/// A face lies across an axis if its normal's cosine with it is at least this.
const ACROSS: f64 = 0.95;

/// Levels this share of the scene's extent from its ends are those of its outer walls.
const RIM: f64 = 0.04;

/// Score in favour of y before anything is looked at, in the measure of the other evidence.
const FOR_Y: f64 = 0.7;

/// More of it where the format prescribes y. Some exporters can be set not to heed that, and few
/// people do.
const PRESCRIBED: f64 = 1.5;

/// A face stands upright, or lies flat, if its normal's cosine with the axis is no larger, or no
/// smaller, than this.
const UPRIGHT: f64 = 0.02;
const FLAT_LYING: f64 = 0.999;

/// Share of the area that may do neither by chance.
const ASKEW: f64 = 0.01;

/// Most evidence that turned things give.
const MOST_ASKEW: f64 = 1.5;

/// Words for what lies flat.
const FLAT: [&str; 12] = [
    "floor",
    "ceiling",
    "carpet",
    "parquet",
    "boden",
    "decke",
    "plafond",
    "pavimento",
    "soffitto",
    "suelo",
    "techo",
    "tabletop",
];

/// Evidence for one axis.
#[derive(Clone, Copy, Default)]
struct Axis {
    /// Area of faces across it, away from the outer walls.
    inner: f64,
    /// Area of faces that neither lie across it nor along it.
    askew: f64,
    /// Area of faces across it whose names say that they lie flat.
    named: f64,
    /// Sum over corners of where they lie between the lower (0) and the upper end (1), but for
    /// lamps.
    level: f64,
    /// Sum over emitters of their power times where they hang between the two ends.
    shining: f64,
    extent: f64,
}

/// The axis that looks most like up. Things stand on floors, so corners lie low; there are more
/// flat faces inside of a room, of tables and shelves, than walls one way; lamps hang high;
/// whatever is turned is turned about it, so that walls stay upright and floors flat; rooms are
/// wider than high; and names may tell. What lies outside of `within` tells nothing: a sky.
pub(super) fn guessed(draft: &Draft, within: Option<[DVec3; 2]>) -> UpAxis {
    let used = || draft.corners.iter().map(|&corner| draft.vertices[corner as usize]);
    let counts = |corner: &DVec3| {
        corner.is_finite() && within.is_none_or(|[lower, upper]| corner.cmpge(lower).all() && corner.cmple(upper).all())
    };
    let sound = || used().filter(counts);
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (lower, upper) = sound().fold(none, |(lower, upper), corner| (lower.min(corner), upper.max(corner)));
    if lower.x > upper.x {
        return UpAxis::Y;
    }
    let extent = (upper - lower).max(DVec3::splat(1e-9));
    let mut axes: [Axis; 3] = std::array::from_fn(|axis| Axis { extent: extent[axis], ..Axis::default() });
    let lies_flat = |name: &str| {
        let name = name.to_lowercase();
        FLAT.iter().any(|word| name.contains(word))
    };
    let materials: Vec<bool> = draft.materials.iter().map(|material| lies_flat(&material.name)).collect();
    let groups: Vec<bool> = draft.groups.iter().map(|group| lies_flat(&group.name)).collect();
    let emission = |material: u32| draft.materials.get(material as usize).map_or(0.0, |it| it.emission.element_sum());
    let (mut whole, mut power_of_lamps, mut corners) = (0.0, 0.0, 0.0);
    let mut positions = Vec::new();
    for face in &draft.faces {
        let of_face = &draft.corners[face.corners()];
        if within.is_some() && !of_face.iter().all(|&corner| counts(&draft.vertices[corner as usize])) {
            continue;
        }
        positions.clear();
        positions.extend(of_face.iter().map(|&corner| (draft.vertices[corner as usize] - lower).as_vec3()));
        let normal = newell(&positions);
        let area = normal.length();
        let levels = positions.iter().map(|position| position.as_dvec3() / extent).filter(|level| level.is_finite());
        let (level, count) = levels.fold((DVec3::ZERO, 0.0), |(sum, count), level| (sum + level, count + 1.0));
        let power = area * f64::from(emission(face.material));
        // Lamps stand on no floor.
        if power > 0.0 && power.is_finite() && count > 0.0 {
            power_of_lamps += power;
            axes.iter_mut().enumerate().for_each(|(axis, seen)| seen.shining += power * level[axis] / count);
        } else {
            corners += count;
            axes.iter_mut().enumerate().for_each(|(axis, seen)| seen.level += level[axis]);
        }
        for (axis, seen) in axes.iter_mut().enumerate() {
            let cosine = normal[axis].abs() / area;
            // Not so where there is no area either.
            if cosine > UPRIGHT && cosine < FLAT_LYING {
                seen.askew += area;
            }
        }
        whole += area;
        let Some(axis) = (0..3).find(|&axis| normal[axis].abs() >= ACROSS * area && area > 0.0) else { continue };
        let level = f64::from(positions[0][axis]) / extent[axis];
        if (RIM..=1.0 - RIM).contains(&level) {
            axes[axis].inner += area;
        }
        let is_named = materials.get(face.material as usize).is_some_and(|flat| *flat);
        if is_named || groups.get(face.group.0 as usize).is_some_and(|flat| *flat) {
            axes[axis].named += area;
        }
    }
    let [_, y, z] = axes;
    let inner: f64 = axes.iter().map(|axis| axis.inner).sum();
    let named = y.named + z.named;
    let share = |difference: f64, of: f64| if of > 0.0 { difference / of } else { 0.0 };
    let askew = |axis: Axis| axis.askew + ASKEW * whole;
    let for_z = if draft.prescribed_up == Some(UpAxis::Y) { -PRESCRIBED } else { 0.0 }
        + 1.5 * share(z.inner - y.inner, inner)
        + 6.0 * share(y.level - z.level, corners)
        + 3.0 * share(z.shining - y.shining, power_of_lamps)
        // By itself not enough: a flat thing stands or lies.
        + (y.extent / z.extent).ln().clamp(-0.9 * FOR_Y, 0.9 * FOR_Y)
        + 3.0 * share(z.named - y.named, named)
        + if whole > 0.0 { (askew(y) / askew(z)).ln().clamp(-MOST_ASKEW, MOST_ASKEW) } else { 0.0 }
        - FOR_Y;
    if for_z > 0.0 { UpAxis::Z } else { UpAxis::Y }
}
