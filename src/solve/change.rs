//! Cost of a changed parameter: the least work that takes a solution from one set of parameters to
//! another.

use super::params::{ClusteringMode, Reconstruct, SolverParams};
use crate::transport::RecheckReasons;

/// The most that a changed parameter asks for, from little to much.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ChangeCost {
    /// The solution stays valid.
    Nothing,
    /// Picture: the same radiosities are drawn in another way.
    Picture,
    /// Radiosities: gather again over the links that are there.
    Radiosities,
    /// Verdicts: judge the stored links again and refine further where they fail.
    Verdicts,
    /// Refinement: merge links and patches back as far as they are not needed, and judge the rest
    /// again.
    Refinement,
    /// Links: refine again from the root's self-link, starting with the present radiosities.
    Links,
    /// Hierarchy: rebuild clusters and everything above them, starting with the present
    /// radiosities.
    Hierarchy,
    /// Scene: turn or double faces, then everything else.
    Scene,
}

impl ChangeCost {
    /// Every kind of work, from little to much.
    pub const ALL: [Self; 8] = [
        Self::Nothing,
        Self::Picture,
        Self::Radiosities,
        Self::Verdicts,
        Self::Refinement,
        Self::Links,
        Self::Hierarchy,
        Self::Scene,
    ];

    /// Whether the hierarchy or more is built anew, by another solver.
    pub fn is_rebuilt(self) -> bool {
        self >= Self::Hierarchy
    }

    /// Work that is done, for a person.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Nothing => "keeps everything",
            Self::Picture => "draws again",
            Self::Radiosities => "keeps links, gathers again",
            Self::Verdicts => "tests links again",
            Self::Refinement => "merges links back",
            Self::Links => "links again, keeps clusters",
            Self::Hierarchy => "rebuilds clusters",
            Self::Scene => "prepares the scene again",
        }
    }
}

/// Work that a change of parameters asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change {
    /// The most that is to be done.
    pub cost: ChangeCost,
    /// Whether links may be finer than they need be.
    pub merges_back: bool,
    /// Reasons for which links must be judged again.
    pub reasons: RecheckReasons,
}

impl SolverParams {
    /// The least work that takes a solution made with `self`, by the first ε (W), to one made with
    /// `newer`, by the second.
    pub(super) fn change_to(&self, newer: &Self, [epsilon, newer_epsilon]: [f64; 2]) -> Change {
        let is_other_threshold = self.threshold() != newer.threshold();
        let merges_back = is_other_threshold && newer_epsilon > epsilon || newer.partial_factor > self.partial_factor;
        let reasons = RecheckReasons {
            finer_epsilon: is_other_threshold && newer_epsilon <= epsilon || newer.partial_factor < self.partial_factor,
            more_rays: newer.visibility_factor > self.visibility_factor
                || newer.rays_min > self.rays_min
                || newer.rays_max > self.rays_max,
            cluster_model: newer.cluster_model != self.cluster_model,
        };
        let octree = self.clustering == ClusteringMode::Octree && self.octree_depth != newer.octree_depth;
        let (shown, newly_shown) = (self.shown_by(), newer.shown_by());
        let is_gathered = shown == Reconstruct::Gather || newly_shown == Reconstruct::Gather;
        let cost = if self.sides != newer.sides {
            ChangeCost::Scene
        } else if self.clustering != newer.clustering || octree {
            ChangeCost::Hierarchy
        } else if self.seed != newer.seed {
            ChangeCost::Links
        } else if merges_back {
            ChangeCost::Refinement
        } else if reasons != RecheckReasons::default() || newer.memory.bytes() > self.memory.bytes() {
            ChangeCost::Verdicts
        } else if self.push != newer.push || self.error != newer.error || shown != newly_shown && is_gathered {
            ChangeCost::Radiosities
        } else if shown != newly_shown {
            ChangeCost::Picture
        } else {
            ChangeCost::Nothing
        };
        Change { cost, merges_back, reasons }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parameter_table::{PARAMETERS, ParameterId};
    use super::super::params::Epsilon;
    use super::*;
    use crate::base::memory::MemoryBudget;
    use crate::scene::Sides;
    use crate::transport::{ClusterModel, Push};

    /// ε in W where Φ is 100 W.
    fn watts(params: &SolverParams) -> f64 {
        match params.threshold() {
            Epsilon::Relative(share) => 100.0 * share,
            Epsilon::Watts(watts) => watts,
        }
    }

    /// Two values of a parameter, the lower one (or the first of its kind) first.
    fn two_values(id: ParameterId, params: SolverParams) -> [SolverParams; 2] {
        let base = SolverParams { clustering: ClusteringMode::Octree, ..params };
        match id {
            ParameterId::Error => [0.05, 0.1].map(|error| SolverParams { error: Some(error), ..base }),
            ParameterId::Epsilon => {
                [1e-4, 1e-3].map(|share| SolverParams { epsilon: Epsilon::Relative(share), ..base })
            }
            ParameterId::EpsilonWatts => {
                [0.01, 0.1].map(|watts| SolverParams { epsilon: Epsilon::Watts(watts), ..base })
            }
            ParameterId::Reconstruct => {
                [Reconstruct::Vertex, Reconstruct::Gather].map(|reconstruct| SolverParams { reconstruct, ..base })
            }
            ParameterId::PartialFactor => [0.1, 0.2].map(|partial_factor| SolverParams { partial_factor, ..base }),
            ParameterId::VisibilityFactor => {
                [5.0, 6.0].map(|visibility_factor| SolverParams { visibility_factor, ..base })
            }
            ParameterId::RaysMin => [4, 5].map(|rays_min| SolverParams { rays_min, ..base }),
            ParameterId::RaysMax => [64, 65].map(|rays_max| SolverParams { rays_max, ..base }),
            ParameterId::Clustering => {
                [ClusteringMode::Octree, ClusteringMode::Groups].map(|clustering| SolverParams { clustering, ..base })
            }
            ParameterId::OctreeDepth => [4, 5].map(|octree_depth| SolverParams { octree_depth, ..base }),
            ParameterId::ClusterModel => [ClusterModel::Isotropic, ClusterModel::Oriented]
                .map(|cluster_model| SolverParams { cluster_model, ..base }),
            ParameterId::Push => [Push::Immediate, Push::Deferred].map(|push| SolverParams { push, ..base }),
            ParameterId::Sides => [None, Some(Sides::Both)].map(|sides| SolverParams { sides, ..base }),
            ParameterId::Threads => [0, 2].map(|threads| SolverParams { threads, ..base }),
            ParameterId::Seed => [1, 2].map(|seed| SolverParams { seed, ..base }),
            ParameterId::Memory => [0.2, 0.3].map(|share| SolverParams { memory: MemoryBudget::Share(share), ..base }),
        }
    }

    /// Truth: the table that the panel's tooltips are made from says what the solver then does.
    #[test]
    fn every_parameter_costs_what_its_row_says() {
        for parameter in &PARAMETERS {
            let [lower, higher] = two_values(parameter.id, SolverParams::default());
            let cost = |from: &SolverParams, to: &SolverParams| from.change_to(to, [watts(from), watts(to)]).cost;
            let found = [cost(&higher, &lower), cost(&lower, &higher)];
            assert_eq!(found, parameter.costs, "{}", parameter.flag);
            assert_eq!(cost(&lower, &lower), ChangeCost::Nothing, "{}", parameter.flag);
        }
    }

    /// Truth: the words name the work, and no two kinds of work are called alike.
    #[test]
    fn each_kind_of_work_has_its_words() {
        let words: std::collections::BTreeSet<_> = ChangeCost::ALL.map(ChangeCost::in_words).into();
        assert_eq!(words.len(), ChangeCost::ALL.len());
        assert!(ChangeCost::ALL.is_sorted());
    }

    /// Constant and vertex show the same radiosities; ε in watts is compared with ε in shares by
    /// what both come to.
    #[test]
    fn what_is_the_same_costs_nothing() {
        let vertex = SolverParams::default();
        let constant = SolverParams { reconstruct: Reconstruct::Constant, ..vertex };
        assert_eq!(vertex.change_to(&constant, [0.01; 2]).cost, ChangeCost::Picture);
        let in_watts = SolverParams { epsilon: Epsilon::Watts(0.1), ..vertex };
        assert_eq!(vertex.change_to(&in_watts, [0.01, 0.1]).cost, ChangeCost::Refinement);
        assert_eq!(in_watts.change_to(&vertex, [0.1, 0.01]).cost, ChangeCost::Verdicts);
        let both = SolverParams { rays_min: 8, ..in_watts };
        let change = vertex.change_to(&both, [0.01, 0.1]);
        assert!(change.merges_back && change.reasons.more_rays, "one change does not hide the other: {change:?}");
    }
}
