//! The table of the solver's parameters: flag, label, unit, range, hint and what a change costs.
//!
//! The command line, the window's solver panel and the statistics all read [`PARAMETERS`].

use std::ops::RangeInclusive;

use super::change::ChangeCost;

/// Names the parameters; the order is that of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ParameterId {
    /// Target error.
    Error,
    /// ε relative to Φ.
    Epsilon,
    /// ε in W.
    EpsilonWatts,
    /// How light is shown.
    Reconstruct,
    /// ε_partial / ε.
    PartialFactor,
    /// f_vis.
    VisibilityFactor,
    /// Lower ray bound.
    RaysMin,
    /// Upper ray bound.
    RaysMax,
    /// Clustering mode.
    Clustering,
    /// Octree depth.
    OctreeDepth,
    /// Cluster model.
    ClusterModel,
    /// Push mode.
    Push,
    /// Reflecting sides.
    Sides,
    /// Worker threads.
    Threads,
    /// Random seed.
    Seed,
    /// Memory budget.
    Memory,
}

/// The kind of value and where it may lie.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueKind {
    /// A real number; `logarithmic` asks for a log slider.
    Real {
        /// Values a slider offers; the command line accepts what
        /// [`SolverParams::validate`](super::SolverParams::validate) does.
        range: RangeInclusive<f64>,
        /// Whether a slider should be logarithmic.
        logarithmic: bool,
    },
    /// A whole number.
    Whole {
        /// Values a slider offers.
        range: RangeInclusive<u64>,
    },
    /// One of a few names.
    Choice {
        /// Each name as files spell it, and as the command line does and the window, where hyphens
        /// are spaces; all take both.
        names: &'static [(&'static str, &'static str)],
    },
}

/// Description of one parameter for the command line and the panels.
pub struct Parameter {
    /// Which one.
    pub id: ParameterId,
    /// Long option without its dashes.
    pub flag: &'static str,
    /// Label in the panel.
    pub label: &'static str,
    /// Unit or empty.
    pub unit: &'static str,
    /// One sentence for help and tooltips, with the paper's section where there is one.
    pub hint: &'static str,
    /// Kind and range.
    pub kind: ValueKind,
    /// The most that a change asks for: to a lower value, and to a higher one.
    pub costs: [ChangeCost; 2],
}

impl Parameter {
    /// The names of a choice, in files and for people.
    fn names(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let ValueKind::Choice { names } = self.kind else { return [].iter().copied() };
        names.iter().copied()
    }

    /// The name for people of a choice, from its name in files.
    pub fn shown(&self, name: &str) -> Option<&'static str> {
        self.names().find(|(in_files, _)| *in_files == name).map(|(_, shown)| shown)
    }

    /// The name in files of a choice, from either name.
    pub fn in_files(&self, name: &str) -> Option<&'static str> {
        self.names().find(|(in_files, shown)| *in_files == name || *shown == name).map(|(in_files, _)| in_files)
    }
}

/// Every parameter, in the order of the panel.
pub const PARAMETERS: [Parameter; 16] = [
    Parameter {
        id: ParameterId::Error,
        flag: "error",
        label: "Target error",
        unit: "",
        hint: "Target error: 9 of 10 surfaces are read within this share of their light. The solver chooses ε and ends when a certificate says so.",
        kind: ValueKind::Real { range: 0.01..=0.3, logarithmic: true },
        costs: [ChangeCost::Verdicts, ChangeCost::Refinement],
    },
    Parameter {
        id: ParameterId::Epsilon,
        flag: "epsilon",
        label: "Link threshold ε",
        unit: "Φ",
        hint: "A link is refined while its unoccluded power B·F·A exceeds this share of the scene's emitted power (section 2.3).",
        kind: ValueKind::Real { range: 1e-7..=1e-1, logarithmic: true },
        costs: [ChangeCost::Verdicts, ChangeCost::Refinement],
    },
    Parameter {
        id: ParameterId::EpsilonWatts,
        flag: "epsilon-watts",
        label: "Link threshold ε in watts",
        unit: "W",
        hint: "The same threshold in watts, as the solver uses it; it does not follow a dimmed lamp (section 2.3).",
        kind: ValueKind::Real { range: 1e-9..=1e6, logarithmic: true },
        costs: [ChangeCost::Verdicts, ChangeCost::Refinement],
    },
    Parameter {
        id: ParameterId::Reconstruct,
        flag: "reconstruct",
        label: "Shading",
        unit: "",
        hint: "How light is shown: flat, one value for each leaf; smooth, interpolated between vertices; or by a final gather.",
        kind: ValueKind::Choice { names: &[("constant", "flat"), ("vertex", "smooth"), ("gather", "final-gather")] },
        costs: [ChangeCost::Radiosities; 2],
    },
    Parameter {
        id: ParameterId::PartialFactor,
        flag: "partial-factor",
        label: "Threshold factor for partly occluded links",
        unit: "",
        hint: "Partly visible links are refined down to ε times this factor; the paper found 1/10 good (section 2.3).",
        kind: ValueKind::Real { range: 0.01..=1.0, logarithmic: true },
        costs: [ChangeCost::Verdicts, ChangeCost::Refinement],
    },
    Parameter {
        id: ParameterId::VisibilityFactor,
        flag: "visibility-factor",
        label: "Rays per power f_vis",
        unit: "rays",
        hint: "Visibility rays of a link per B·F·A/ε, so that every ray decides about the same power (section 2.4).",
        kind: ValueKind::Real { range: 0.1..=64.0, logarithmic: true },
        costs: [ChangeCost::Nothing, ChangeCost::Verdicts],
    },
    Parameter {
        id: ParameterId::RaysMin,
        flag: "rays-min",
        label: "Min rays per link",
        unit: "",
        hint: "Fewest visibility rays of a tested link; most links need no more, so this bound costs the most time (section 2.4).",
        kind: ValueKind::Whole { range: 1..=64 },
        costs: [ChangeCost::Nothing, ChangeCost::Verdicts],
    },
    Parameter {
        id: ParameterId::RaysMax,
        flag: "rays-max",
        label: "Max rays per link",
        unit: "",
        hint: "Most visibility rays of a link (section 2.4).",
        kind: ValueKind::Whole { range: 1..=1024 },
        costs: [ChangeCost::Nothing, ChangeCost::Verdicts],
    },
    Parameter {
        id: ParameterId::Clustering,
        flag: "clustering",
        label: "Clustering",
        unit: "",
        hint: "How polygons are grouped: not at all (plain hierarchical radiosity), octree, the scene's own groups, or adaptive (section 2.2).",
        kind: ValueKind::Choice {
            names: &[("none", "none"), ("octree", "octree"), ("groups", "groups"), ("adaptive", "adaptive")],
        },
        costs: [ChangeCost::Hierarchy; 2],
    },
    Parameter {
        id: ParameterId::OctreeDepth,
        flag: "octree-depth",
        label: "Octree depth",
        unit: "levels",
        hint: "Deepest level of the octree, the root being level 1 (Table 2).",
        kind: ValueKind::Whole { range: 1..=10 },
        costs: [ChangeCost::Hierarchy; 2],
    },
    Parameter {
        id: ParameterId::ClusterModel,
        flag: "cluster-model",
        label: "Cluster model",
        unit: "",
        hint: "Light of a cluster: alike into all directions (isotropic, the paper's, section 1.2) or as its polygons are turned (oriented, by samples).",
        kind: ValueKind::Choice { names: &[("isotropic", "isotropic"), ("oriented", "oriented")] },
        costs: [ChangeCost::Verdicts; 2],
    },
    Parameter {
        id: ParameterId::Push,
        flag: "push",
        label: "Irradiance push-down",
        unit: "",
        hint: "Hand irradiance that a cluster receives to its patches link by link with their cosine (immediate) or evenly afterwards (deferred, section 3.3).",
        kind: ValueKind::Choice { names: &[("immediate", "immediate"), ("deferred", "deferred")] },
        costs: [ChangeCost::Radiosities; 2],
    },
    Parameter {
        id: ParameterId::Sides,
        flag: "sides",
        label: "Reflecting sides",
        unit: "",
        hint: "Which sides of a face reflect: the one its winding shows, both, or the one that the room sees (auto); as the scene says if not given.",
        kind: ValueKind::Choice { names: &[("front", "front"), ("both", "both"), ("auto", "auto")] },
        costs: [ChangeCost::Scene; 2],
    },
    Parameter {
        id: ParameterId::Threads,
        flag: "threads",
        label: "Threads",
        unit: "",
        hint: "Worker threads, 0 for every core; the result is the same for any number.",
        kind: ValueKind::Whole { range: 0..=64 },
        costs: [ChangeCost::Nothing; 2],
    },
    Parameter {
        id: ParameterId::Seed,
        flag: "seed",
        label: "Seed",
        unit: "",
        hint: "Seed of the visibility rays; the same seed gives the same solution, bit for bit.",
        kind: ValueKind::Whole { range: 0..=1_000_000 },
        costs: [ChangeCost::Links; 2],
    },
    Parameter {
        id: ParameterId::Memory,
        flag: "memory",
        label: "Memory limit",
        unit: "",
        hint: "Memory that scene and solution may take, as a share of the machine's or a size such as 4GiB; refinement stops before it takes more.",
        kind: ValueKind::Real { range: 0.02..=0.9, logarithmic: false },
        costs: [ChangeCost::Nothing, ChangeCost::Verdicts],
    },
];
