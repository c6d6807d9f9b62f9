//! Selection: by a click in the view, by a panel, or nothing.

use glam::Vec3;

use crate::app::state::inspection;
use crate::app::state::picked::PickedElement;
use crate::app::tools;
use crate::app::view::viewport;
use crate::app::{App, LATER};
use crate::hierarchy::ElementId;
use crate::solve::Snapshot;

impl App {
    /// Finds the picked element in a newer snapshot.
    pub(in crate::app) fn follow_picked(&mut self, latest: &Snapshot) {
        if self.shown.picked.as_mut().is_some_and(|picked| !picked.follow(latest)) {
            self.shown.picked = None;
        }
    }

    /// Nothing is selected any longer.
    pub(in crate::app) fn deselect(&mut self) {
        (self.shown.picked, self.layout.is_card_open) = (None, false);
        self.edits.light.selected = None;
        self.tools.measuring.select(None, &self.wake);
    }

    /// Picks any element, patch or cluster, by its id; nothing where the snapshot in view does not
    /// know it.
    pub(in crate::app) fn pick_element(&mut self, id: ElementId) {
        let picked = self.shown.snapshot.as_ref().and_then(|snapshot| PickedElement::by_id(snapshot, id));
        if picked.is_some() {
            self.shown.picked = picked;
            self.tools.measuring.select(None, &self.wake);
        }
    }

    /// Brings names, and what panels show of the picked element, up to date.
    pub(in crate::app) fn inspect_picked(&mut self, ctx: &egui::Context) {
        if let (Some(snapshot), Some(info)) = (&self.shown.snapshot, &self.shown.info)
            && let Some(solution_view) = &snapshot.solution_view
        {
            self.tools.inspection.names.follow(snapshot.generation, solution_view, &info.scene);
        }
        let (Some(picked), Some(snapshot), Some(info)) = (&self.shown.picked, &self.shown.snapshot, &self.shown.info)
        else {
            return;
        };
        // The card tells what lights an element; only the inspector can be turned round.
        let direction = match self.tools.open {
            Some(tools::Tool::Inspector) => self.tools.inspector.direction(),
            _ => inspection::Direction::In,
        };
        if self.tools.inspection.look(snapshot, &info.scene, picked.element, direction) {
            ctx.request_repaint_after(LATER);
        }
    }

    /// Picks what a click in the view meets, or puts a probe there.
    pub(in crate::app) fn pick(&mut self, clicked: viewport::Clicked) {
        let (Some(snapshot), Some(info)) = (&self.shown.snapshot, &self.shown.info) else { return };
        let (origin, moved_by) =
            self.view.clusters.ray_in_scene(clicked.origin, clicked.direction).unwrap_or((clicked.origin, Vec3::ZERO));
        if self.tools.open == Some(tools::Tool::Measure) && self.tools.measuring.places_probes {
            if let Some(found) = PickedElement::at(snapshot, origin, clicked.direction) {
                let leaf = snapshot.mesh.leaves.iter().find(|leaf| leaf.element == found.element);
                if let Some(polygon) = leaf.and_then(|leaf| info.scene.polygons.get(leaf.polygon as usize)) {
                    self.tools.measuring.place(found.point, info.scene.normal(polygon), &self.wake);
                }
            }
            return;
        }
        self.shown.picked = PickedElement::at(snapshot, origin, clicked.direction);
        let mut place = None;
        self.edits.light.selected = None;
        if let Some(picked) = &self.shown.picked {
            if let Some(leaf) = snapshot.mesh.leaves.iter().find(|leaf| leaf.element == picked.element) {
                self.edits.light.choose(&info.scene, leaf.material);
                let polygon = info.scene.polygons.get(leaf.polygon as usize);
                place = polygon.map(|polygon| (picked.point, info.scene.normal(polygon)));
            }
            if clicked.is_double {
                self.view.viewport.look_at(picked.point + moved_by);
            }
        }
        self.layout.is_card_open &= self.shown.picked.is_some();
        self.tools.measuring.select(place, &self.wake);
    }
}
