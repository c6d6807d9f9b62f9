//! Names of the elements in view: one for each, wherever it is named.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::hierarchy::ElementId;
use crate::read::names::Names;
use crate::scene::Scene;
use crate::transport::SolutionView;

/// Names in the light of the snapshot in view.
#[derive(Default)]
pub struct NamesInView {
    made_of: Option<(Names, Arc<SolutionView>)>,
    known: FxHashMap<ElementId, String>,
}

impl NamesInView {
    /// Follows the state in view and the groups of its scene.
    pub fn follow(&mut self, generation: u64, solution_view: &Arc<SolutionView>, scene: &Arc<Scene>) {
        let of = self.made_of.take();
        let are_known = |(names, _): &&(Names, _)| names.are_of(generation, scene);
        let is_same = of.as_ref().filter(are_known).is_some_and(|(_, of)| Arc::ptr_eq(of, solution_view));
        if !is_same {
            self.known.clear();
        }
        let names = of.map(|(names, _)| names).filter(|names| names.are_of(generation, scene));
        let names = names.unwrap_or_else(|| Names::new(generation, solution_view.hierarchy(), scene));
        self.made_of = Some((names, solution_view.clone()));
    }

    /// The names; `None` before elements were there.
    pub fn names(&self) -> Option<&Names> {
        self.made_of.as_ref().map(|(names, _)| names)
    }

    /// The full name of an element; empty where it is not known.
    pub fn full(&mut self, id: ElementId) -> &str {
        let Some((names, solution_view)) = self.made_of.as_ref().filter(|(_, of)| of.holds(id)) else { return "" };
        self.known.entry(id).or_insert_with(|| names.full(solution_view, id))
    }

    /// Short name of an element, among those that hold it.
    pub fn short(&self, id: ElementId) -> String {
        let made_of = self.made_of.as_ref().filter(|(_, of)| of.holds(id));
        made_of.map(|(names, of)| names.short(of.hierarchy(), id)).unwrap_or_default()
    }
}
