//! The window's view of clusters: what is asked for, and the snapshot in view as it shows them,
//! made anew only when something changed.

use std::sync::Arc;

use glam::Vec3;

use crate::app::view::highlight::Highlight;
use crate::app::view::paint::fresh_serial;
use crate::hierarchy::ElementId;
use crate::render::{ApartMesh, ClusterParts, ClusterView, Line, Marks};
use crate::solve::{Mesh, Snapshot};
use crate::transport::SolutionView;

/// Settings of the view of clusters, and the snapshot made by them.
#[derive(Default)]
pub struct ClusterScene {
    /// Whether surfaces show the colours of their clusters.
    pub coloured: bool,
    /// How far clusters are pulled apart, 0..=1.
    pub explode: f32,
    cut: Option<Cut>,
    painted: Option<Painted>,
}

/// A hierarchy cut at a level, and the mesh cut alike.
struct Cut {
    generation: u64,
    level: u16,
    parts: ClusterParts,
    of_mesh: Arc<Mesh>,
    apart: ApartMesh,
}

/// A snapshot as it was painted.
struct Painted {
    of: Arc<Snapshot>,
    view: ClusterView,
    snapshot: Arc<Snapshot>,
}

impl ClusterScene {
    /// Whether anything but the plain picture is asked for; it takes a solution view.
    pub fn is_active(&self) -> bool {
        self.coloured || self.explode > 0.0
    }

    /// How a level is to be shown; `None` for the plain picture.
    pub fn view(&self, level: u16) -> Option<ClusterView> {
        let explode = if level > 0 { self.explode } else { 0.0 };
        (self.coloured || explode > 0.0).then_some(ClusterView { level, explode, coloured: self.coloured })
    }

    /// The snapshot as the view shows a level; `None` for the plain picture, while the solution
    /// view has not come, and where no level is to be shown.
    pub fn painted(&mut self, snapshot: &Arc<Snapshot>, level: Option<u16>) -> Option<Arc<Snapshot>> {
        let wanted = level.and_then(|level| Some((level, self.view(level)?)));
        let (Some((level, view)), Some(solution_view)) = (wanted, &snapshot.solution_view) else {
            (self.cut, self.painted) = (None, None);
            return None;
        };
        let is_painted = |painted: &&Painted| painted.view == view && Arc::ptr_eq(&painted.of, snapshot);
        if let Some(painted) = self.painted.as_ref().filter(is_painted) {
            return Some(painted.snapshot.clone());
        }
        let is_cut = |cut: &Cut| {
            (cut.generation, cut.level) == (snapshot.generation, level) && Arc::ptr_eq(&cut.of_mesh, &snapshot.mesh)
        };
        let cut = match self.cut.take().filter(is_cut) {
            Some(cut) => cut,
            None => {
                let parts = ClusterParts::new(solution_view.hierarchy(), level);
                let apart = ApartMesh::new(&snapshot.mesh, &parts);
                Cut { generation: snapshot.generation, level, parts, of_mesh: snapshot.mesh.clone(), apart }
            }
        };
        let mut painted = cut.apart.snapshot(snapshot, &cut.parts, view);
        painted.serial = fresh_serial();
        self.cut = Some(cut);
        let painted = Painted { of: snapshot.clone(), view, snapshot: Arc::new(painted) };
        Some(self.painted.insert(painted).snapshot.clone())
    }

    /// How far an element lies from its own place in the picture that was painted last.
    fn offset(&self, solution_view: &SolutionView, id: ElementId) -> Vec3 {
        match (&self.cut, &self.painted) {
            (Some(cut), Some(painted)) => cut.parts.offset_of(solution_view.hierarchy(), id, painted.view.explode),
            _ => Vec3::ZERO,
        }
    }

    /// Whether surfaces lie elsewhere than in the scene.
    pub fn is_exploded(&self) -> bool {
        self.painted.as_ref().is_some_and(|painted| painted.view.explode > 0.0)
    }

    /// The picked element and what is pointed at, where surfaces lie elsewhere than in the scene;
    /// links are left out, for their ways would be none of light's.
    pub fn marks(&self, solution_view: &SolutionView, picked: Option<ElementId>, highlight: Highlight) -> Marks {
        let mut lines: Vec<Line> = Vec::new();
        let ends = match highlight {
            Highlight::None => [None; 2],
            Highlight::Element(id) => [Some(id), None],
            Highlight::Link { receiver, source } => [Some(receiver), Some(source)],
        };
        for id in picked.into_iter().chain(ends.into_iter().flatten()) {
            let offset = if solution_view.holds(id) { self.offset(solution_view, id) } else { Vec3::ZERO };
            let moved = |point: [f32; 3]| (Vec3::from(point) + offset).to_array();
            let of_element = Highlight::Element(id).lines(solution_view).into_iter();
            lines.extend(of_element.map(|line| Line { from: moved(line.from), to: moved(line.to), ..line }));
        }
        lines.into()
    }

    /// A ray into the picture as one into the scene, which meets the same surface at once: beside
    /// it, how far that surface was moved.
    pub fn ray_in_scene(&self, origin: Vec3, direction: Vec3) -> Option<(Vec3, Vec3)> {
        let (cut, painted) = (self.cut.as_ref()?, self.painted.as_ref()?);
        let mesh = &painted.snapshot.mesh;
        let met = crate::render::pick(mesh, origin, direction)?;
        let polygon = mesh.leaves.get(met.leaf as usize)?.polygon;
        let offset = cut.parts.offset_of_polygon(polygon, painted.view.explode);
        Some((met.point - JUST_BEFORE * direction.normalize_or_zero() - offset, offset))
    }
}

/// A ray that stands for another starts so far from the surface that the other met, in the scene's
/// unit: nothing lies between.
const JUST_BEFORE: f32 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};

    fn snapshot() -> Arc<Snapshot> {
        Solver::solved(BuiltinScene::Cornell.build(), SolverParams::with_epsilon(1e-2)).snapshot().into()
    }

    /// Truth: the surface that a ray meets in the picture is the one that its stand-in meets in the
    /// scene.
    #[test]
    fn clicks_into_the_pulled_apart_picture_meet_the_same_surfaces() {
        let snapshot = snapshot();
        let mut view = ClusterScene { explode: 0.7, ..ClusterScene::default() };
        let painted = view.painted(&snapshot, Some(2)).expect("it carries its solution view");
        let eye = Vec3::new(0.278, 0.273, -0.8);
        let mut met = 0;
        for step in 0..400 {
            let (x, y) = ((step % 20) as f32 / 20.0 - 0.475, (step / 20) as f32 / 20.0 - 0.475);
            let direction = Vec3::new(x, y, 1.0);
            let Some(there) = crate::render::pick(&painted.mesh, eye, direction) else { continue };
            let (origin, _) = view.ray_in_scene(eye, direction).expect("it meets a surface");
            let here = crate::render::pick(&snapshot.mesh, origin, direction).expect("so does its stand-in");
            assert_eq!(here.leaf, there.leaf, "at {x} {y}");
            met += 1;
        }
        assert!(met > 100, "{met} rays met something");
    }

    #[test]
    fn nothing_is_painted_for_the_plain_picture_and_once_for_any_other() {
        let snapshot = snapshot();
        let mut view = ClusterScene::default();
        assert!(view.painted(&snapshot, Some(2)).is_none() && !view.is_active());
        view.coloured = true;
        let first = view.painted(&snapshot, Some(2)).expect("it carries its solution view");
        assert!(Arc::ptr_eq(&first, &view.painted(&snapshot, Some(2)).expect("it is there")));
        view.explode = 0.5;
        let second = view.painted(&snapshot, Some(2)).expect("it carries its solution view");
        assert!(first.serial != second.serial && second.serial != snapshot.serial);
        view.coloured = false;
        assert!(view.painted(&snapshot, Some(0)).is_none(), "the root alone cannot be pulled apart");
    }
}
