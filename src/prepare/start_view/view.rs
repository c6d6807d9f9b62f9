//! The view from a place in a room: along one of its long free diagonals, that which shows most.

use glam::Vec3;
use rayon::prelude::*;

use super::{AROUND, CLEAR, CLEAR_SHARE, EYE, FARTHEST, HIGHEST_EYE, Rooms, Stand, heading};
use crate::scene::CameraPose;

/// Directions in which a room is free for at least this share of its longest are looked into as
/// well.
const NEARLY_LONGEST: f32 = 0.75;
/// Rays by which views are compared, across and up.
const VIEWED: [usize; 2] = [15, 9];
/// What is nearer hides things, m.
const NEAR: f32 = 1.0;
/// Height of a view, as a share of its width.
const VIEW_HEIGHT: f32 = 0.7;
/// Horizontal field of view, degrees.
pub(super) const HFOV: f32 = 75.0;

impl Rooms<'_> {
    /// The view from a room's end that shows most of it, nearly along its longest free diagonal.
    pub(super) fn view(&self, stand: &Stand) -> CameraPose {
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
            let ahead = self.around(*step);
            let eye = self.stepped_back(stand, ahead, free[(step + AROUND / 2) % AROUND]);
            (*step, eye, length(*step) * self.shown(eye, ahead))
        });
        let views: Vec<(usize, Vec3, f32)> = views.collect();
        let better = |best: (usize, Vec3, f32), other: (usize, Vec3, f32)| if other.2 > best.2 { other } else { best };
        let (step, eye, _) = views.into_iter().reduce(better).unwrap_or((longest, stand.eye, 0.0));
        let ahead = self.around(step);
        let down = 0.12 * (EYE.min(HIGHEST_EYE * stand.height));
        let clear = CLEAR.min(CLEAR_SHARE * stand.height);
        let target = eye + (0.5 * length(step)).max(clear) * ahead - down * self.up;
        CameraPose { eye, target, up: self.up, hfov_deg: HFOV }
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

    /// How much a view shows: the mean distance of what is seen, m, times the root of how many
    /// things that are, each as far as it is in the middle, times the squared share of the picture
    /// that is neither near nor dark. A blank wall shows little, and so do things at the picture's
    /// rim or before one's eyes.
    fn shown(&self, eye: Vec3, ahead: Vec3) -> f32 {
        let [columns, rows] = VIEWED;
        let right = ahead.cross(self.up);
        let half_width = (0.5 * HFOV.to_radians()).tan();
        let (mut distances, mut far, mut seen) = (0.0, 0.0, Vec::new());
        for index in 0..columns * rows {
            let place = |at: usize, of: usize| 2.0 * (at as f32 + 0.5) / of as f32 - 1.0;
            let (across, level) = (place(index % columns, columns), place(index / columns, rows));
            let direction = ahead + half_width * (across * right + VIEW_HEIGHT * level * self.up);
            let Some(look) = self.look(eye, direction.normalize()).filter(|look| look.is_bright) else { continue };
            distances += look.distance.min(FARTHEST);
            far += f32::from(look.distance >= NEAR);
            seen.push((look.thing, 1.0 - across * across));
        }
        seen.sort_by_key(|(thing, _)| *thing);
        let things = seen.chunk_by(|(a, _), (b, _)| a == b);
        let things: f32 = things.map(|rays| rays.iter().map(|(_, share)| *share).fold(0.0, f32::max)).sum();
        let rays = (columns * rows) as f32;
        distances / rays * things.sqrt() * (far / rays).powi(2)
    }
}
