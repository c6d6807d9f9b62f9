//! How a scene file is to be read where it does not say so itself, and what came of that.

use glam::{DMat4, DVec3};
use serde::{Deserialize, Serialize};

use super::draft::Draft;
use super::sidecar::Sidecar;
use super::unit::{BELOW_A_SKY, Unit};
use super::up::{self, UpAxis};
use super::{flat_tops, known_sizes};

/// Wishes of a person on how a file is to be read; a sidecar's word counts where nothing is said
/// here.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Reading {
    /// The axis that points up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<UpAxis>,
    /// The length unit of its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
    /// Materials whose faces are opaque whatever the file says.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub opaque: Vec<String>,
    /// Materials whose faces are left out, such as panes that daylight is to pass.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ignored: Vec<String>,
}

impl Reading {
    /// Whether nothing is said.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// How a scene was read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame {
    /// The axis that points up; `None` where the camera tells.
    pub up: Option<UpAxis>,
    /// The unit of the file's numbers; the scene's own are metres.
    pub unit: Unit,
    /// Whether the sidecar says which sides of faces are bright.
    pub sides_are_told: bool,
}

/// Shares of corners below and above which lie what stretches a scene without belonging to its
/// rooms: skies, grounds.
const OUTLIERS: f64 = 0.02;

/// So few corners are all that matter.
const FEW: usize = 400;

/// Decides up axis and unit, and brings the draft to metres.
pub(super) fn settle(draft: &mut Draft, reading: &Reading, sidecar: &Sidecar) -> Frame {
    // What was saved beside a scene fits the axis that its format prescribes.
    let prescribed = draft.prescribed_up.filter(|_| sidecar.camera.is_some());
    let given = reading.up.or(sidecar.up).or(prescribed);
    // An older sidecar's view tells by its own up direction.
    let up = if given.is_none() && sidecar.camera.is_some() {
        None
    } else {
        Some(given.unwrap_or_else(|| up::guessed(draft, Extents::new(draft).below_a_sky())))
    };
    if given.is_none() && up == Some(UpAxis::Z) {
        let although = if draft.prescribed_up.is_some() { ", though its format has y" } else { "" };
        draft.skipped.note(format!(
            "z is taken for up, as the scene looks{although}; --up y or the scene panel says otherwise."
        ));
    }
    let given = reading.unit.or(sidecar.unit).or(draft.unit);
    let has_lengths = sidecar.camera.is_some()
        || !sidecar.luminaires.is_empty()
        || !sidecar.bookmarks.is_empty()
        || sidecar.task_area.is_some();
    let unit = match given {
        Some(unit) => unit,
        // What was saved beside the scene without a unit is in the scene's own.
        None if has_lengths => Unit::Metre,
        None => {
            let [all, most] = Extents::new(draft).sizes(up.unwrap_or_default());
            let [height, width] = all;
            let axis = up.unwrap_or_default();
            let by_things = known_sizes::unit(draft, axis).or_else(|| flat_tops::unit(draft, axis, height));
            let unit = by_things.unwrap_or_else(|| Unit::guessed(all, most));
            if unit != Unit::Metre {
                let [height, width] = [height, width].map(|length| (10.0 * length * unit.metres()).round() / 10.0);
                draft.skipped.note(format!(
                    "Lengths are taken for {}, so that the scene is {width} m wide and {height} m high; --unit or the scene panel says otherwise.",
                    unit.name()
                ));
            }
            unit
        }
    };
    if unit != Unit::Metre {
        scale(draft, unit.metres());
    }
    Frame { up, unit, sides_are_told: sidecar.sides.is_some() }
}

/// Where corners lie.
struct Extents {
    /// The box that nearly all lie in.
    all: [DVec3; 2],
    /// The box that the middle half lies in, along each axis.
    most: [DVec3; 2],
}

impl Extents {
    fn new(draft: &Draft) -> Self {
        let along = |axis: usize| {
            let level = |&corner: &u32| draft.vertices[corner as usize][axis];
            let mut levels: Vec<f64> = draft.corners.iter().map(level).filter(|level| level.is_finite()).collect();
            let rim = if levels.len() <= FEW { 0 } else { (OUTLIERS * levels.len() as f64) as usize };
            [rim, levels.len() / 4].map(|rim| {
                let Some(last) = levels.len().checked_sub(1 + rim) else { return [0.0; 2] };
                let low = *levels.select_nth_unstable_by(rim, f64::total_cmp).1;
                [low, *levels.select_nth_unstable_by(last, f64::total_cmp).1]
            })
        };
        let (x, (y, z)) = rayon::join(|| along(0), || rayon::join(|| along(1), || along(2)));
        let axes = [x, y, z];
        let part = |part: usize| [0, 1].map(|end| DVec3::from_array([0, 1, 2].map(|axis| axes[axis][part][end])));
        Self { all: part(0), most: part(1) }
    }

    /// Height and largest width of both boxes.
    fn sizes(&self, up: UpAxis) -> [[f64; 2]; 2] {
        [self.all, self.most].map(|[lower, upper]| {
            let size = upper - lower;
            match up {
                UpAxis::Y => [size.y, size.x.max(size.z)],
                UpAxis::Z => [size.z, size.x.max(size.y)],
            }
        })
    }

    /// A box around most things if a far larger one is around them, as a sky is.
    fn below_a_sky(&self) -> Option<[DVec3; 2]> {
        let [lower, upper] = self.most;
        let is_far_smaller = (upper - lower).cmplt(BELOW_A_SKY * (self.all[1] - self.all[0])).all();
        is_far_smaller.then(|| [2.0 * lower - upper, 2.0 * upper - lower])
    }
}

fn scale(draft: &mut Draft, factor: f64) {
    draft.vertices.iter_mut().for_each(|vertex| *vertex *= factor);
    for (_, camera) in &mut draft.cameras {
        let ahead = camera.target - camera.eye;
        camera.eye *= factor;
        camera.target = camera.eye + ahead;
    }
    let by_factor = DMat4::from_scale(DVec3::splat(factor));
    for light in &mut draft.lights {
        light.world = by_factor * light.world;
        light.range = light.range.map(|range| range * factor as f32);
    }
}
