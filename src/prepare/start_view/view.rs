//! The view from a place in a room: along one of its long free diagonals, that which shows most.

use glam::Vec3;
use rayon::prelude::*;

use super::{AROUND, CLEAR, CLEAR_SHARE, EYE, FARTHEST, HIGHEST_EYE, Look, Rooms, Stand, Thing, heading};
use crate::scene::CameraPose;

/// Directions in which a room is free for at least this share of its longest are looked into as
/// well.
const NEARLY_LONGEST: f32 = 0.5;
/// Rays by which views are compared, across and up.
const VIEWED: [usize; 2] = [15, 9];
/// Things nearer than this hide others, m.
const NEAR: f32 = 1.0;
/// A view of which a smaller share is neither near nor dark shows nothing.
const LEAST_CLEAR: f32 = 0.3;
/// Faces whose normals differ by more than about 1/`TURN`, or that lie more than this apart, m, are
/// different surfaces.
const TURN: f32 = 2.0;
const LAYER: f32 = 0.5;
/// How far before its middle the whole of a scene is seen, in its box's diagonals.
const FRAMED: f32 = 0.75;
/// Height of a view, as a share of its width.
const VIEW_HEIGHT: f32 = 0.7;
/// Horizontal field of view, degrees.
pub(super) const HFOV: f32 = 75.0;

/// A thing's faces of nearly one plane.
type Surface = (Thing, [i32; 3], i32);

/// A view from a place, and how much it is worth beside others.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub(super) pose: CameraPose,
    pub(super) content: ViewContent,
    /// Whether next to nothing is to be seen.
    pub(super) is_poor: bool,
    worth: f32,
}

impl View {
    pub(super) fn better(best: Self, other: Self) -> Self {
        if other.worth > best.worth { other } else { best }
    }
}

/// Content of a view.
#[derive(Clone, Copy, Default)]
pub(super) struct ViewContent {
    /// How many surfaces, each as far as it is in the middle.
    surfaces: f32,
    things: usize,
    /// Mean distance, m; what is dark counts as none.
    distance: f32,
    /// Share of the picture that is neither near nor dark.
    clear: f32,
}

impl ViewContent {
    /// How much there is to see: a blank wall shows little, however far it is, and so do things at
    /// the picture's rim or before one's eyes.
    fn worth(&self) -> f32 {
        (self.surfaces * self.distance).sqrt() * self.clear.powi(2)
    }

    /// How many things are clearly seen.
    pub(super) fn content(&self) -> f32 {
        self.things as f32 * self.clear
    }
}

impl Rooms<'_> {
    /// The view from a room's end that shows most of it, nearly along its longest free diagonal.
    pub(super) fn view(&self, stand: &Stand) -> Option<View> {
        // The open is no room to look into or to step back into.
        let free: Vec<f32> = (0..AROUND)
            .map(|step| if stand.walls[step] { self.reach(stand.eye, self.around(step)) } else { 0.0 })
            .collect();
        let length = |step: usize| free[step] + free[(step + AROUND / 2) % AROUND];
        let by_length = |a: &usize, b: &usize| {
            let of_equals = || free[*a].total_cmp(&free[*b]).then(b.cmp(a));
            length(*a).total_cmp(&length(*b)).then_with(of_equals)
        };
        let longest = (0..AROUND).max_by(by_length).unwrap_or_default();
        let long_enough = (0..AROUND).filter(|step| length(*step) >= NEARLY_LONGEST * length(longest));
        // The longest first: of equals the first is taken.
        let others = long_enough.filter(|step| *step != longest);
        let steps: Vec<usize> = std::iter::once(longest).chain(others).collect();
        let views = steps.par_iter().map(|step| {
            let (step, ahead) = (*step, self.around(*step));
            let eye = self.stepped_back(stand, ahead, free[(step + AROUND / 2) % AROUND]);
            let down = 0.12 * (EYE.min(HIGHEST_EYE * stand.height));
            let clear = CLEAR.min(CLEAR_SHARE * stand.height);
            let target = eye + (0.5 * length(step)).max(clear) * ahead - down * self.up;
            let content = self.content(eye, ahead, length(longest));
            let is_poor = stand.is_bare || content.clear < LEAST_CLEAR;
            let share = length(step) / length(longest).max(f32::MIN_POSITIVE);
            let worth = (stand.score * share).sqrt() * content.worth();
            View { pose: CameraPose { eye, target, up: self.up, hfov_deg: HFOV }, content, is_poor, worth }
        });
        let views: Vec<View> = views.collect();
        views.into_iter().reduce(View::better)
    }

    /// Content of the view of the scene from outside, from the front, the right and above.
    pub(super) fn content_from_outside(&self) -> ViewContent {
        let (lower, upper) = self.scene.bounds();
        let back = if self.up.z.abs() > 0.5 { -Vec3::Y } else { Vec3::Z };
        let ahead = -(0.45 * Vec3::X + 0.4 * self.up + back).normalize();
        self.content(0.5 * (lower + upper) - FRAMED * lower.distance(upper) * ahead, ahead, FARTHEST)
    }

    /// As far back from a place as there is room to stand, where it is this far to what is behind.
    fn stepped_back(&self, stand: &Stand, ahead: Vec3, back: f32) -> Vec3 {
        let clear = CLEAR.min(CLEAR_SHARE * stand.height);
        let is_clear = |eye: Vec3| {
            let directions = (0..12).map(|step| heading(self.up, step, 12));
            let slopes = directions.flat_map(|flat| [-0.5, 0.0, 0.5].map(|slope| (flat + slope * self.up).normalize()));
            slopes
                .chain([self.up, -self.up])
                .all(|direction| self.look(eye, direction).is_none_or(|it| it.is_bright && it.distance >= clear))
        };
        let mut steps =
            (0..=16).map(|step| stand.eye - (back - 2.0 * clear).max(0.0) * (1.0 - step as f32 / 16.0) * ahead);
        steps.find(|eye| is_clear(*eye)).unwrap_or(stand.eye)
    }

    /// Content of a view; things behind windows count as no farther than a room is long.
    fn content(&self, eye: Vec3, ahead: Vec3, room: f32) -> ViewContent {
        let [columns, rows] = VIEWED;
        let right = ahead.cross(self.up).normalize_or_zero();
        let above = right.cross(ahead);
        let half_width = (0.5 * HFOV.to_radians()).tan();
        let (mut distance, mut clear, mut seen) = (0.0, 0.0, Vec::new());
        for index in 0..columns * rows {
            let place = |at: usize, of: usize| 2.0 * (at as f32 + 0.5) / of as f32 - 1.0;
            let (across, level) = (place(index % columns, columns), place(index / columns, rows));
            let direction = (ahead + half_width * (across * right + VIEW_HEIGHT * level * above)).normalize();
            let Some(look) = self.look(eye, direction).filter(|look| look.is_bright) else { continue };
            distance += look.distance.min(room);
            clear += f32::from(look.distance >= NEAR);
            seen.push((self.surface(&look, eye + look.distance * direction), 1.0 - across * across));
        }
        seen.sort_unstable_by_key(|(surface, _)| *surface);
        let things = seen.chunk_by(|((a, ..), _), ((b, ..), _)| a == b).count();
        let surfaces = seen.chunk_by(|(a, _), (b, _)| a == b);
        let surfaces = surfaces.map(|rays| rays.iter().map(|(_, share)| *share).fold(0.0, f32::max)).sum();
        let rays = (columns * rows) as f32;
        ViewContent { surfaces, things, distance: distance / rays, clear: clear / rays }
    }

    /// The surface that a point met lies on: planes part what is one thing to the file.
    fn surface(&self, look: &Look, point: Vec3) -> Surface {
        let normal = self.scene.normal(&self.scene.polygons[look.polygon]);
        let direction = (TURN * normal).round();
        let layer = (point.dot(direction.normalize_or_zero()) / LAYER).round();
        (look.thing, direction.as_ivec3().to_array(), layer as i32)
    }
}
