//! Inner elements: the light of their parts, and where they stand in the hierarchy.

use super::{BySource, ElementId, LinkView, SolutionView, Vec3};

impl SolutionView {
    /// Levels below the root, which has 0: clusters and patches count alike.
    pub fn depth(&self, id: ElementId) -> u16 {
        self.depths().get(id.index()).copied().unwrap_or(0)
    }

    /// The greatest depth of all elements.
    pub fn deepest(&self) -> u16 {
        self.depths().iter().copied().max().unwrap_or(0)
    }

    /// The element or what holds it at a depth; the element itself where it lies above.
    pub fn ancestor_at(&self, id: ElementId, depth: u16) -> ElementId {
        let levels = self.depth(id).saturating_sub(depth);
        self.upwards(id).nth(levels.into()).unwrap_or(id)
    }

    fn depths(&self) -> &[u16] {
        self.depths.get_or_init(|| {
            let mut depths: Vec<u16> = Vec::with_capacity(self.hierarchy.elements().len());
            for element in self.hierarchy.elements() {
                depths.push(element.parent().map_or(0, |parent| depths[parent.index()] + 1));
            }
            depths
        })
    }

    /// Factor on an element's irradiance, in the mean over the area of its leaves.
    pub(super) fn scale(&self, id: ElementId) -> f32 {
        let scales = self.scales.get_or_init(|| {
            let elements = self.hierarchy.elements();
            let own = |index: usize| self.light.row_scale.get(index).copied().unwrap_or(1.0);
            let mut scales: Vec<f32> = (0..elements.len()).map(own).collect();
            // Children come after their parent.
            for (index, element) in elements.iter().enumerate().rev() {
                let scaled = |child: ElementId| self.hierarchy.element(child).area * scales[child.index()];
                if element.area <= 0.0 {
                    // Hidden wholly: what the elements above hand down does not reach it.
                    scales[index] = 0.0;
                } else if !element.is_leaf() {
                    scales[index] = element.children().map(scaled).sum::<f32>() / element.area;
                }
            }
            scales
        });
        scales.get(id.index()).copied().unwrap_or(1.0)
    }

    /// Links that bring light to the parts of an element; empty for a leaf. What each brings is
    /// counted over the whole element, so that together with [`SolutionView::incoming`] it adds up
    /// to the element's irradiance E. In no order.
    pub fn incoming_of_parts(&self, id: ElementId) -> Vec<LinkView> {
        let whole = self.hierarchy.element(id).area;
        let mut views = Vec::new();
        self.visit_parts(id, &mut |part, levels_up| {
            let area = self.hierarchy.element(part).area;
            let share = if whole > 0.0 { self.scale(part) * area / whole } else { 0.0 };
            for link in self.links.of(part).iter().filter(|link| self.carries(link)) {
                let view = self.view(part, link, levels_up);
                views.push(LinkView { irradiance: share * view.irradiance, ..view });
            }
        });
        views
    }

    /// Links that take light of the parts of an element elsewhere; empty for a leaf. In no order.
    pub fn outgoing_of_parts(&self, id: ElementId) -> Vec<LinkView> {
        let by_source = self.by_source.get_or_init(|| BySource::new(&self.links, self.hierarchy.elements().len()));
        let mut views = Vec::new();
        self.visit_parts(id, &mut |part, levels_up| {
            for &place in by_source.of(part) {
                let link = &self.links.all()[place as usize];
                if self.carries(link) {
                    views.push(self.view(by_source.receivers[place as usize], link, levels_up));
                }
            }
        });
        views
    }

    /// Everything that brings light to an element: its own links, those of all that holds it and of
    /// its parts. In no order.
    pub fn all_incoming(&self, id: ElementId) -> Vec<LinkView> {
        let mut links = self.incoming(id);
        links.append(&mut self.incoming_of_parts(id));
        links
    }

    /// Everything that takes light of an element elsewhere, likewise.
    pub fn all_outgoing(&self, id: ElementId) -> Vec<LinkView> {
        let mut links = self.outgoing(id);
        links.append(&mut self.outgoing_of_parts(id));
        links
    }

    /// The elements below one, with their levels above it, which are negative.
    fn visit_parts(&self, id: ElementId, visit: &mut impl FnMut(ElementId, i16)) {
        let mut waiting: Vec<(ElementId, i16)> =
            self.hierarchy.element(id).children().map(|child| (child, -1)).collect();
        while let Some((part, levels_up)) = waiting.pop() {
            visit(part, levels_up);
            waiting.extend(self.hierarchy.element(part).children().map(|child| (child, levels_up - 1)));
        }
    }

    /// Links of all receivers at a depth.
    pub fn links_at_depth(&self, depth: u16) -> impl Iterator<Item = LinkView> {
        let receivers = self.hierarchy.ids().filter(move |&id| self.depth(id) == depth);
        receivers.flat_map(move |receiver| self.links.of(receiver).iter().map(move |link| self.view(receiver, link, 0)))
    }

    /// Light of links, summed up by the ends away from the element that was asked for (`far`), each
    /// as the element that holds it at a depth; most first. An end above that depth stands for
    /// itself.
    pub fn folded(
        &self,
        links: &[LinkView],
        depth: u16,
        far: impl Fn(&LinkView) -> ElementId,
        value: impl Fn(&LinkView) -> Vec3,
    ) -> Vec<(ElementId, Vec3)> {
        let mut sums: rustc_hash::FxHashMap<ElementId, Vec3> = rustc_hash::FxHashMap::default();
        for link in links {
            *sums.entry(self.ancestor_at(far(link), depth)).or_default() += value(link);
        }
        let mut folded: Vec<_> = sums.into_iter().collect();
        folded.sort_by(|(a, one), (b, other)| other.max_element().total_cmp(&one.max_element()).then(a.cmp(b)));
        folded
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Hierarchy;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{ClusteringMode, Solver, SolverParams};

    /// Truth: E of an element is the mean over the area of its leaves' E, whatever lights them.
    #[test]
    fn all_links_of_any_element_add_up_to_its_irradiance() {
        let coarse = SolverParams::with_epsilon(1e-2);
        let groups = SolverParams { clustering: ClusteringMode::Groups, ..coarse };
        for params in [coarse, groups] {
            let solution_view = Solver::solved_view(BuiltinScene::Cornell.build(), params);
            for id in solution_view.hierarchy().ids() {
                let whole = solution_view.irradiance(id);
                let sum: Vec3 = solution_view.all_incoming(id).iter().map(|link| link.irradiance).sum();
                let off = (sum - whole).abs().max_element();
                assert!(off <= 2e-3 * whole.max_element(), "{:?}, {id:?}: {sum} of {whole} W/m²", params.clustering);
            }
        }
    }

    /// Truth: the sum of all links, and the path upwards.
    #[test]
    fn folding_keeps_the_sum_and_stays_at_its_level() {
        let solution_view = Solver::solved_view(BuiltinScene::Cornell.build(), SolverParams::with_epsilon(1e-2));
        let leaf = solution_view.hierarchy().ids().last().expect("there are elements");
        let links = solution_view.all_incoming(leaf);
        let sum: Vec3 = links.iter().map(|link| link.irradiance).sum();
        let mut counts = Vec::new();
        for level in 0..=solution_view.deepest() {
            let folded = solution_view.folded(&links, level, |link| link.source, |link| link.irradiance);
            let total: Vec3 = folded.iter().map(|(_, value)| *value).sum();
            assert!((total - sum).abs().max_element() <= 1e-5 * sum.max_element(), "level {level}: {total} of {sum}");
            assert!(folded.iter().all(|(id, _)| solution_view.depth(*id) <= level));
            assert!(folded.is_sorted_by(|a, b| a.1.max_element() >= b.1.max_element()));
            counts.push(folded.len());
        }
        assert_eq!(counts[0], 1, "the root holds all sources");
        assert!(counts.is_sorted() && counts.last() > counts.first(), "{counts:?}");
        assert_eq!(solution_view.ancestor_at(leaf, 0), Hierarchy::ROOT);
        assert_eq!(solution_view.ancestor_at(leaf, u16::MAX), leaf);
    }
}
