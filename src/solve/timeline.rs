//! The timeline of a solve: each wave as a light-weight step that can be looked at again.
//!
//! A step keeps the links as they were, those that waited among them, and how many elements there
//! were: the arena only grows, so that a former hierarchy is a beginning of the present one. Its
//! light is gathered anew when somebody asks for the picture. Passes of a final gather keep their
//! pictures, for what they found cannot be had from links.

use std::sync::Arc;

use super::picture::{self, FIRST_SWEEPS, PICTURE_TOLERANCE};
use super::reconstruction_mesh::ReconstructionMesh;
use super::snapshot::Snapshot;
use super::{Solver, Stats};
use crate::base::cancel::CancelToken;
use crate::hierarchy::ElementId;
use crate::transport::{Gatherer, Link, LinkRules, LinkTable, SolutionView};

/// Memory that steps may take, bytes. Beyond it every other one is forgotten, but the first and the
/// last.
const MOST_BYTES: usize = 192 << 20;
/// And no more than this part of the memory budget.
const PART_OF_BUDGET: usize = 8;

/// Kind of work that ended with a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimelineStepKind {
    /// Nothing: the root's self-link waits.
    Start,
    /// A wave of refinement.
    Wave,
    /// A round: light was gathered to convergence.
    Round,
    /// A pass of the final gather.
    Pass,
}

/// A step in words and numbers.
#[derive(Clone, Debug)]
pub struct TimelineStep {
    /// Kind of work that ended with the step.
    pub kind: TimelineStepKind,
    /// Counts and times as they were.
    pub stats: Stats,
}

struct KeptStep {
    info: TimelineStep,
    state: State,
}

enum State {
    Links { elements: usize, vertices: usize, links: Vec<(ElementId, Link)>, is_final: bool },
    Picture(Box<Snapshot>),
}

impl State {
    fn bytes(&self) -> usize {
        match self {
            Self::Links { links, .. } => size_of_val(&links[..]),
            Self::Picture(snapshot) => {
                let mesh = &snapshot.mesh;
                size_of_val(&snapshot.vertex_radiosity[..])
                    + size_of_val(&snapshot.leaf_radiosity[..]) * 2
                    + size_of_val(&mesh.positions[..])
                    + size_of_val(&mesh.triangles[..])
                    + size_of_val(&mesh.outlines[..])
                    + size_of_val(&mesh.leaves[..])
            }
        }
    }
}

/// The steps of a solve, oldest first.
#[derive(Default)]
pub struct Timeline {
    steps: Vec<KeptStep>,
    bytes: usize,
    /// Grows with each change.
    changes: u64,
}

impl Timeline {
    /// Memory of the steps, bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    fn push(&mut self, step: KeptStep, most_bytes: usize) {
        self.changes += 1;
        self.bytes += step.state.bytes();
        self.steps.push(step);
        while self.bytes > most_bytes && self.steps.len() > 3 {
            let last = self.steps.len() - 1;
            let mut place = 0;
            self.steps.retain(|_| {
                place += 1;
                (place - 1) % 2 == 0 || place - 1 == last
            });
            self.bytes = self.steps.iter().map(|step| step.state.bytes()).sum();
        }
    }
}

impl Solver {
    /// Keeps each wave from now on, as a step that [`Self::snapshot_of`] shows again.
    pub fn keep_timeline(&mut self) {
        if self.timeline.is_none() {
            self.begin_timeline();
        }
    }

    /// Forgets what was, and starts with the present state, where timeline is kept.
    pub(super) fn restart_timeline(&mut self) {
        if self.timeline.is_some() {
            self.begin_timeline();
        }
    }

    fn begin_timeline(&mut self) {
        let changes = self.timeline.as_ref().map_or(0, |timeline| timeline.changes);
        self.timeline = Some(Timeline { changes: changes + 1, ..Timeline::default() });
        self.remember(TimelineStepKind::Start);
    }

    /// The steps of the solve, oldest first.
    pub fn kept_steps(&self) -> impl ExactSizeIterator<Item = &TimelineStep> {
        self.timeline.as_ref().map_or(&[][..], |timeline| &timeline.steps).iter().map(|step| &step.info)
    }

    /// Tells states of [`Self::kept_steps`] apart: the generation, and a number that grows with
    /// each change.
    pub fn kept_steps_state(&self) -> (u64, u64) {
        (self.view.generation, self.timeline.as_ref().map_or(0, |timeline| timeline.changes))
    }

    /// Keeps the present state as a step, where timeline is kept.
    pub(super) fn remember(&mut self, kind: TimelineStepKind) {
        if self.timeline.is_none() {
            return;
        }
        let state = if kind == TimelineStepKind::Pass {
            State::Picture(Box::new(Snapshot { solution_view: None, ..picture::snapshot(self) }))
        } else {
            State::Links {
                elements: self.hierarchy().elements().len(),
                vertices: self.hierarchy().vertices().len(),
                links: self.links_and_waiting(),
                is_final: self.job.is_past_links(),
            }
        };
        let info = TimelineStep { kind, stats: self.stats() };
        let most_bytes = MOST_BYTES.min(self.budget_bytes() / PART_OF_BUDGET);
        if let Some(timeline) = &mut self.timeline {
            timeline.push(KeptStep { info, state }, most_bytes);
        }
    }

    fn links_and_waiting(&self) -> Vec<(ElementId, Link)> {
        let table = self.links.links();
        let receivers = (0..table.receivers() as u32).map(ElementId);
        let stored = receivers.flat_map(|receiver| table.of(receiver).iter().map(move |link| (receiver, *link)));
        let mut links: Vec<(ElementId, Link)> = stored.collect();
        links.extend(self.links.links_not_stored());
        links
    }

    /// A former step's picture, gathered over the links that there were; `None` where there is no
    /// such step.
    pub fn snapshot_of(&mut self, step: usize) -> Option<Snapshot> {
        let wants_solution_view = self.view.wants_solution_view;
        let (info, elements, vertices, links, is_final) = match self.timeline.as_ref()?.steps.get(step)? {
            KeptStep { state: State::Picture(snapshot), .. } => {
                let snapshot = Snapshot { former_step: Some(step), ..(**snapshot).clone() };
                self.view.serial += 1;
                let solution_view =
                    wants_solution_view.then(|| self.solution_view(self.links.links(), self.links.light(), true));
                return Some(Snapshot { serial: self.view.serial, solution_view, ..snapshot });
            }
            KeptStep { info, state: State::Links { elements, vertices, links, is_final } } => {
                (info.clone(), *elements, *vertices, links, *is_final)
            }
        };
        let hierarchy = self.hierarchy().as_of(elements, vertices);
        let mut table = LinkTable::default();
        table.append(elements, links);
        let mut light = self.links.emitted_light();
        light.truncate(elements);
        let never = CancelToken::new();
        let surfaces = (self.links.surfaces(), self.links.normal_moments());
        let gatherer = Gatherer::new(&hierarchy, &table, surfaces, self.links.rules(), !is_final);
        gatherer.enforce_closure(&mut light, &never);
        gatherer.converge(&mut light, PICTURE_TOLERANCE, FIRST_SWEEPS, &never);
        drop(gatherer);
        let reconstruction = match &self.view.reconstruction {
            Some(present) => present.rebuilt(self.scene(), &hierarchy, elements, self.mesh_kind()),
            None => ReconstructionMesh::current(None, self.scene(), &hierarchy, elements, self.mesh_kind()),
        };
        self.view.serial += 1;
        let snapshot = Snapshot {
            generation: self.view.generation,
            serial: self.view.serial,
            vertex_radiosity: reconstruction.of_vertices(&light.radiosity),
            vertex_irradiance: reconstruction.of_vertices(&light.irradiance),
            leaf_irradiance: reconstruction.of_leaves(&light.irradiance),
            leaf_radiosity: reconstruction.of_leaves(&light.radiosity),
            mesh: reconstruction.mesh,
            clusters: reconstruction.clusters,
            former_step: Some(step),
            stats: info.stats,
            ..Snapshot::default()
        };
        let solution_view = wants_solution_view.then(|| {
            let rules = LinkRules { epsilon_watts: snapshot.stats.epsilon_watts, ..*self.links.rules() };
            Arc::new(SolutionView::new(Arc::new(hierarchy), table, light, rules, is_final))
        });
        Some(Snapshot { solution_view, ..snapshot })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Occluders;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{SolverParams, Step};

    fn solver(epsilon: f64) -> Solver {
        let scene = Arc::new(BuiltinScene::Cornell.build());
        let occluders = Arc::new(Occluders::new(&scene));
        Solver::new(scene, occluders, SolverParams::with_epsilon(epsilon), 1).expect("the parameters are valid")
    }

    /// Truth: what was to be seen when the wave ended.
    #[test]
    fn a_moment_looks_as_it_did() {
        let mut solver = solver(1e-3);
        solver.keep_timeline();
        let never = CancelToken::new();
        let mut seen = vec![solver.snapshot()];
        loop {
            match solver.step(&never) {
                Step::Refined { wave_ended: true } | Step::Gathered => seen.push(solver.snapshot()),
                Step::Finished => break,
                _ => {}
            }
        }
        assert_eq!(solver.kept_steps().len(), seen.len());
        solver.show_solution_view(true);
        for (step, then) in seen.iter().enumerate() {
            let again = solver.snapshot_of(step).expect("it was kept");
            assert_eq!(again.former_step, Some(step));
            assert_eq!(again.mesh.triangles, then.mesh.triangles, "step {step}");
            let stats = &again.stats;
            assert_eq!((stats.links, stats.patches), (then.stats.links, then.stats.patches));
            // A live picture of what is not finished makes three sweeps from the one before; the
            // last one is the solution.
            let tolerance = if step + 1 == seen.len() { 0.01 } else { 0.06 };
            let power = |snapshot: &Snapshot| -> f64 {
                let leaves = snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity);
                leaves.map(|(leaf, [r, g, b])| f64::from(leaf.area * (r + g + b))).sum()
            };
            let (before, now) = (power(then), power(&again));
            assert!((now - before).abs() <= tolerance * before, "step {step}: {now} W, was {before} W");
            let solution_view = again.solution_view.expect("it was asked for");
            if step == 0 {
                assert_eq!(solution_view.links().len(), 1, "the root's self-link alone");
            }
        }
        assert!(solver.snapshot_of(seen.len()).is_none());
    }
}
