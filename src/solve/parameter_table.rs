//! The table of the solver's parameters: flag, label, unit, range, hint and what a change costs.
//!
//! The command line, the window's solver panel and the statistics all read [`PARAMETERS`].

use std::ops::RangeInclusive;

use super::change::ChangeCost;

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

/// A number of a log slider.
const fn logarithmic(range: RangeInclusive<f64>) -> ValueKind {
    ValueKind::Real { range, logarithmic: true }
}

const fn linear(range: RangeInclusive<f64>) -> ValueKind {
    ValueKind::Real { range, logarithmic: false }
}

const fn whole(range: RangeInclusive<u64>) -> ValueKind {
    ValueKind::Whole { range }
}

const fn choice(names: &'static [(&'static str, &'static str)]) -> ValueKind {
    ValueKind::Choice { names }
}

/// Defines the names of parameters and their table: flag, label, unit if it has one, kind, what a
/// lower and a higher value cost, hint.
macro_rules! parameters {
    ($($(#[$doc:meta])* $name:ident = $flag:literal, $label:literal $(in $unit:literal)?, $kind:expr,
        [$lower:ident, $higher:ident], $hint:literal;)*) => {
        /// Names the parameters; the order is that of the panel.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum ParameterId {
            $($(#[$doc])* $name,)*
        }

        /// Every parameter, in the order of the panel.
        pub const PARAMETERS: [Parameter; [$(ParameterId::$name),*].len()] = [$(Parameter {
            id: ParameterId::$name,
            flag: $flag,
            label: $label,
            unit: concat!($($unit)?),
            hint: $hint,
            kind: $kind,
            costs: [ChangeCost::$lower, ChangeCost::$higher],
        }),*];
    };
}

parameters! {
    /// Target error.
    Error = "error", "Target error", logarithmic(0.01..=0.3), [Verdicts, Refinement],
        "Target error: 9 of 10 surfaces are read within this share of their light. The solver chooses ε and ends when a certificate says so.";
    /// ε relative to Φ.
    Epsilon = "epsilon", "Link threshold ε" in "Φ", logarithmic(1e-7..=1e-1), [Verdicts, Refinement],
        "A link is refined while its unoccluded power B·F·A exceeds this share of the scene's emitted power (section 2.3).";
    /// ε in W.
    EpsilonWatts = "epsilon-watts", "Link threshold ε in watts" in "W", logarithmic(1e-9..=1e6), [Verdicts, Refinement],
        "The same threshold in watts, as the solver uses it; it does not follow a dimmed lamp (section 2.3).";
    /// How light is shown.
    Reconstruct = "reconstruct", "Shading",
        choice(&[("constant", "flat"), ("vertex", "smooth"), ("gather", "final-gather")]), [Radiosities, Radiosities],
        "How light is shown: flat, one value for each leaf; smooth, interpolated between vertices; or by a final gather.";
    /// ε_partial / ε.
    PartialFactor = "partial-factor", "Threshold factor for partly occluded links",
        logarithmic(0.01..=1.0), [Verdicts, Refinement],
        "Partly visible links are refined down to ε times this factor; the paper found 1/10 good (section 2.3).";
    /// f_vis.
    VisibilityFactor = "visibility-factor", "Rays per power f_vis" in "rays",
        logarithmic(0.1..=64.0), [Nothing, Verdicts],
        "Visibility rays of a link per B·F·A/ε, so that every ray decides about the same power (section 2.4).";
    /// Lower ray bound.
    RaysMin = "rays-min", "Min rays per link", whole(1..=64), [Nothing, Verdicts],
        "Fewest visibility rays of a tested link; most links need no more, so this bound costs the most time (section 2.4).";
    /// Upper ray bound.
    RaysMax = "rays-max", "Max rays per link", whole(1..=1024), [Nothing, Verdicts],
        "Most visibility rays of a link (section 2.4).";
    /// Clustering mode.
    Clustering = "clustering", "Clustering",
        choice(&[("none", "none"), ("octree", "octree"), ("groups", "groups"), ("adaptive", "adaptive")]),
        [Hierarchy, Hierarchy],
        "How polygons are grouped: not at all (plain hierarchical radiosity), octree, the scene's own groups, or adaptive (section 2.2).";
    /// Octree depth.
    OctreeDepth = "octree-depth", "Octree depth" in "levels", whole(1..=10), [Hierarchy, Hierarchy],
        "Deepest level of the octree, the root being level 1 (Table 2).";
    /// Cluster model.
    ClusterModel = "cluster-model", "Cluster model",
        choice(&[("isotropic", "isotropic"), ("oriented", "oriented")]), [Verdicts, Verdicts],
        "Light of a cluster: alike into all directions (isotropic, the paper's, section 1.2) or as its polygons are turned (oriented, by samples).";
    /// Push mode.
    Push = "push", "Irradiance push-down",
        choice(&[("immediate", "immediate"), ("deferred", "deferred")]), [Radiosities, Radiosities],
        "Hand irradiance that a cluster receives to its patches link by link with their cosine (immediate) or evenly afterwards (deferred, section 3.3).";
    /// Reflecting sides.
    Sides = "sides", "Reflecting sides",
        choice(&[("front", "front"), ("both", "both"), ("auto", "auto")]), [Scene, Scene],
        "Which sides of a face reflect: the one its winding shows, both, or the one that the room sees (auto); as the scene says if not given.";
    /// Worker threads.
    Threads = "threads", "Threads", whole(0..=64), [Nothing, Nothing],
        "Worker threads, 0 for every core; the result is the same for any number.";
    /// Random seed.
    Seed = "seed", "Seed", whole(0..=1_000_000), [Links, Links],
        "Seed of the visibility rays; the same seed gives the same solution, bit for bit.";
    /// Memory budget.
    Memory = "memory", "Memory limit", linear(0.02..=0.9), [Nothing, Verdicts],
        "Memory that scene and solution may take, as a share of the machine's or a size such as 4GiB; refinement stops before it takes more.";
}
