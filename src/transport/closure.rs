//! Closure: no patch receives more than all around it send, so its F·V sum to 1 at most.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::nodes::{CHUNK, Kind, Node};
use super::sweep::{Gatherer, LARGEST_RETURN, Light};
use crate::base::cancel::CancelToken;

/// No patch receives more than all around it send: its F·V sum to 1, give or take what few rays are
/// wrong by. Rows that are too small by chance stay as they are, so to cut those that are too large
/// at 1 would lose light: at 1.002 the seminar room gets 4 % darker. A row beyond this is no
/// chance.
const LARGEST_ROW: f32 = 1.25;
/// A leaf takes over from its siblings at most as much as it has itself.
const MOST_SCALE: f32 = 2.0;

impl Gatherer<'_> {
    /// Finds by how much each leaf's irradiance must be scaled for its F·V to sum to no more than
    /// 1; returns how many leaves exceeded that.
    ///
    /// A leaf shares the links of the patches above it, which are right in the mean over all their
    /// leaves but not for each: a leaf in a corner adds its own large form factors to a mean that
    /// holds them already. What a leaf has too much is therefore what its siblings have too little,
    /// and goes to them; a whole initial patch is scaled back where it would get more than there
    /// is, and never up.
    pub fn enforce_closure(&self, light: &mut Light, cancel: &CancelToken) -> Option<usize> {
        let nodes = self.nodes.all();
        let mut rows = self.rows(cancel)?;
        let exceeds = |(node, row): &(&Node, &f32)| node.kind == Kind::Leaf && **row > 1.0;
        let exceeding = nodes.par_iter().zip(&rows).with_min_len(CHUNK).filter(exceeds).count();
        let split = || self.nodes.inner().filter(|inner| nodes[inner.index].kind == Kind::Split);
        for patch in split().rev() {
            rows[patch.index] = mean_by_area(nodes, patch.children.clone(), |child| rows[child]);
        }
        let wanted = |(node, row): (&Node, &f32)| {
            let is_whole = node.parent().is_some_and(|parent| nodes[parent].kind == Kind::Cluster);
            if matches!(node.kind, Kind::Leaf | Kind::Split) && is_whole {
                let reflectance = self.surfaces[node.polygon as usize].reflectance.max_element();
                row.min((LARGEST_RETURN / reflectance).clamp(1.0, LARGEST_ROW))
            } else {
                *row
            }
        };
        let mut wanted: Vec<f32> = nodes.par_iter().zip(&rows).with_min_len(CHUNK).map(wanted).collect();
        for patch in split() {
            share_out(nodes, wanted[patch.index], patch.children.clone(), &rows, &mut wanted);
        }
        let scale = |(&wanted, &row): (&f32, &f32)| if row > 0.0 { (wanted / row).min(MOST_SCALE) } else { 1.0 };
        light.row_scale = wanted.par_iter().zip(&rows).with_min_len(CHUNK).map(scale).collect();
        Some(exceeding)
    }

    /// Each patch's sum of F·V, its ancestors' included, before rows are limited; parallel to the
    /// arena. `None` if cancelled.
    pub fn rows(&self, cancel: &CancelToken) -> Option<Vec<f32>> {
        let elements = self.pusher.stem().elements().len();
        let arrived = self.arrive(&vec![Vec3::ONE; elements], &vec![Vec3::ZERO; elements], cancel)?;
        let row = |(index, node): (usize, &Node)| {
            if node.is_patch() { self.pusher.irradiance(&arrived, index, node.normal).x } else { 0.0 }
        };
        Some(self.nodes.all().par_iter().enumerate().with_min_len(CHUNK).map(row).collect())
    }
}

/// Mean of a value over elements, by area.
fn mean_by_area(nodes: &[Node], elements: Range<usize>, value: impl Fn(usize) -> f32) -> f32 {
    let (sum, area) = elements.fold((0.0, 0.0), |(sum, area), element| {
        let own = nodes[element].area;
        (sum + own * value(element), area + own)
    });
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Shares the mean that a patch should have out to its children: each keeps its own up to the
/// larger of 1 and the mean, and what is then missing goes where there is room.
fn share_out(nodes: &[Node], mean: f32, children: Range<usize>, rows: &[f32], wanted: &mut [f32]) {
    let most = mean.max(1.0);
    let kept = mean_by_area(nodes, children.clone(), |child| rows[child].min(most));
    let room = most - kept;
    for child in children {
        let own = rows[child].min(most);
        wanted[child] = if mean >= kept {
            own + if room > 0.0 { (most - own) * (mean - kept) / room } else { 0.0 }
        } else {
            own * mean / kept
        };
    }
}
