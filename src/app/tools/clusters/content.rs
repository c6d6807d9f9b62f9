//! Content of the tree of clusters: the rows that are unfolded, and the numbers of each element.

use rustc_hash::FxHashSet;

use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::transport::SolutionView;

/// A row of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    pub element: ElementId,
    /// Rows above it that hold it.
    pub depth: u16,
}

/// Whether an element has rows below its own: a polygon's quarters have none.
pub fn has_rows_below(hierarchy: &Hierarchy, id: ElementId) -> bool {
    hierarchy.element(id).is_cluster() && !hierarchy.element(id).is_leaf()
}

/// The rows that are to be seen, from the root down.
pub fn visible_rows(hierarchy: &Hierarchy, unfolded: &FxHashSet<ElementId>) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut waiting = vec![Row { element: Hierarchy::ROOT, depth: 0 }];
    while let Some(row) = waiting.pop() {
        rows.push(row);
        if unfolded.contains(&row.element) && has_rows_below(hierarchy, row.element) {
            let first = waiting.len();
            let children = hierarchy.element(row.element).children();
            waiting.extend(children.map(|element| Row { element, depth: row.depth + 1 }));
            waiting[first..].reverse();
        }
    }
    rows
}

/// The element that has a row: itself, or the polygon whose part it is.
pub fn with_row(hierarchy: &Hierarchy, id: ElementId) -> ElementId {
    let is_part = |id: ElementId| matches!(&hierarchy.element(id).shape, Shape::Patch(patch) if patch.level > 0);
    let mut at = id;
    while let Some(parent) = hierarchy.element(at).parent().filter(|_| is_part(at)) {
        at = parent;
    }
    at
}

/// Powers of every element in one state of the solution, sums over the three colours.
pub struct Powers {
    /// Light that arrives, E·A, W.
    received: Vec<f32>,
    /// Light that leaves, B·A, W.
    sent: Vec<f32>,
}

impl Powers {
    /// Adds up what leaves receive and send.
    pub fn new(solution_view: &SolutionView) -> Self {
        let hierarchy = solution_view.hierarchy();
        let count = hierarchy.elements().len();
        let (mut received, mut sent) = (vec![0.0; count], vec![0.0; count]);
        // Parents precede their children.
        for (index, element) in hierarchy.elements().iter().enumerate().rev() {
            let id = ElementId(index as u32);
            if element.is_leaf() {
                received[index] = f64::from(element.area) * f64::from(solution_view.irradiance(id).element_sum());
                sent[index] = f64::from(element.area) * f64::from(solution_view.radiosity(id).element_sum());
            }
            if let Some(parent) = element.parent() {
                received[parent.index()] += received[index];
                sent[parent.index()] += sent[index];
            }
        }
        let small = |table: Vec<f64>| table.into_iter().map(|power| power as f32).collect();
        Self { received: small(received), sent: small(sent) }
    }

    /// Light that arrives at an element, W.
    pub fn received(&self, id: ElementId) -> f32 {
        self.received.get(id.index()).copied().unwrap_or(0.0)
    }

    /// Light that leaves an element, W.
    pub fn sent(&self, id: ElementId) -> f32 {
        self.sent.get(id.index()).copied().unwrap_or(0.0)
    }
}

/// Polygons in an element.
pub fn polygons(hierarchy: &Hierarchy, id: ElementId) -> usize {
    match &hierarchy.element(id).shape {
        Shape::Cluster(cluster) => hierarchy.patches_below(cluster).len(),
        Shape::Patch(_) => 1,
        Shape::Sky(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};

    fn solution_view() -> Arc<SolutionView> {
        let seminar = BuiltinScene::from_name("seminar").expect("ours").build();
        Solver::solved_view(seminar, SolverParams::with_epsilon(3e-2))
    }

    /// Truth: what is in a cluster is what is in its children; the whole has each polygon once.
    #[test]
    fn numbers_of_children_add_up_to_their_cluster_s() {
        let solution_view = solution_view();
        let hierarchy = solution_view.hierarchy();
        let powers = Powers::new(&solution_view);
        assert_eq!(polygons(hierarchy, Hierarchy::ROOT), hierarchy.initial_patches().len());
        let area = |id: ElementId| f64::from(hierarchy.element(id).area);
        let mut clusters = 0;
        for id in hierarchy.ids().filter(|id| has_rows_below(hierarchy, *id)) {
            let children = || hierarchy.element(id).children();
            assert_eq!(children().map(|child| polygons(hierarchy, child)).sum::<usize>(), polygons(hierarchy, id));
            let near = |sum: f64, whole: f64| (sum - whole).abs() <= 1e-5 * whole.abs().max(1e-9);
            assert!(near(children().map(area).sum(), area(id)));
            let received = |id| f64::from(powers.received(id));
            let sent = |id| f64::from(powers.sent(id));
            assert!(near(children().map(received).sum(), received(id)));
            assert!(near(children().map(sent).sum(), sent(id)));
            clusters += 1;
        }
        assert!(clusters > 100);
        let root = f64::from(solution_view.irradiance(Hierarchy::ROOT).element_sum()) * area(Hierarchy::ROOT);
        assert!((f64::from(powers.received(Hierarchy::ROOT)) / root - 1.0).abs() < 1e-3);
    }

    /// Truth: children stand below their parent in the arena's order; folded ones are not there.
    #[test]
    fn rows_are_those_of_unfolded_elements() {
        let solution_view = solution_view();
        let hierarchy = solution_view.hierarchy();
        let mut unfolded = FxHashSet::default();
        assert_eq!(visible_rows(hierarchy, &unfolded), [Row { element: Hierarchy::ROOT, depth: 0 }]);
        unfolded.extend(hierarchy.ids());
        let all = visible_rows(hierarchy, &unfolded);
        assert_eq!(all.len(), hierarchy.cluster_count() + hierarchy.initial_patches().len());
        let children: Vec<ElementId> = hierarchy.element(Hierarchy::ROOT).children().collect();
        let shown: Vec<ElementId> = all.iter().filter(|row| row.depth == 1).map(|row| row.element).collect();
        assert_eq!(shown, children);
        let quarter = hierarchy.ids().find(|id| with_row(hierarchy, *id) != *id).expect("something was split");
        assert!(all.iter().any(|row| row.element == with_row(hierarchy, quarter)));
    }
}
