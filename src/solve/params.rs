//! Every parameter of the solver: default, range, unit, hint and what a change costs, in one place.
//!
//! The command line, the window's solver panel and the statistics all read [`PARAMETERS`].

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::change::ChangeCost;
use crate::base::memory::MemoryBudget;
pub use crate::hierarchy::ClusteringMode;
use crate::scene::Sides;
use crate::transport::{ClusterModel, LinkRules, Push};

/// The threshold ε on the unoccluded power of a link.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Epsilon {
    /// As a share of the scene's emitted power Φ; becomes watts when a solve starts.
    Relative(f64),
    /// In W.
    Watts(f64),
}

/// How what the solver knows of its elements becomes the light that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reconstruct {
    /// One value for each leaf, as the method has it.
    #[serde(alias = "flat")]
    Constant,
    /// Leaves' values averaged at the vertices and interpolated between them.
    #[default]
    #[serde(alias = "smooth")]
    Vertex,
    /// Light gathered anew over the links' solution (a final gather), on leaves of its own.
    #[serde(alias = "final-gather")]
    Gather,
}

pub use crate::gather::USUAL_ERROR;

/// Where an error is asked for, links are refined to this share of it as ε/Φ: a final gather needs
/// no more of them.
const EPSILON_PER_ERROR: f64 = 0.2;

/// All that a person can turn; [`PARAMETERS`] describes each field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SolverParams {
    /// Target error: nine tenths of the area are to be read within this local error, |ΔE|/(E + E₀).
    /// The solver then chooses ε, and ends when a certificate says so. `None` to solve by ε.
    pub error: Option<f64>,
    /// Threshold ε on B_s·F·A_r, where no error is asked for.
    pub epsilon: Epsilon,
    /// How light is shown; where an error is asked for, always by a final gather.
    pub reconstruct: Reconstruct,
    /// ε_partial / ε: how much stricter partly visible links are judged (section 2.3: 1/10).
    pub partial_factor: f64,
    /// f_vis: visibility rays per BFA/ε (section 2.4).
    pub visibility_factor: f64,
    /// Fewest visibility rays of a link that is tested at all.
    pub rays_min: u32,
    /// Most visibility rays of a link.
    pub rays_max: u32,
    /// How clusters are built.
    pub clustering: ClusteringMode,
    /// Deepest octree level, the root being 1; for [`ClusteringMode::Octree`].
    pub octree_depth: u32,
    /// Model of how clusters exchange light.
    pub cluster_model: ClusterModel,
    /// When clusters hand irradiance down.
    pub push: Push,
    /// Which sides of faces reflect; `None` as the scene says.
    pub sides: Option<Sides>,
    /// Worker threads; 0 takes every core.
    pub threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
    /// Memory that the solution may take; what does not fit is not refined.
    pub memory: MemoryBudget,
    /// Criterion that files of older versions name; see [`Self::forget_criterion`].
    #[serde(rename = "oracle", skip_serializing)]
    pub former_criterion: FormerCriterion,
}

/// Criterion that older versions refined links by; all links are refined by power now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FormerCriterion {
    /// The power that a link could carry (section 2.3).
    #[default]
    #[serde(alias = "power")]
    Energy,
    /// The error that a link was likely to make.
    #[serde(alias = "link-error")]
    Error,
}

impl Default for SolverParams {
    fn default() -> Self {
        Self {
            error: None,
            epsilon: Epsilon::Relative(1e-4),
            reconstruct: Reconstruct::Vertex,
            partial_factor: 0.1,
            visibility_factor: 5.0,
            rays_min: 4,
            rays_max: 64,
            clustering: ClusteringMode::Adaptive,
            octree_depth: 5,
            cluster_model: ClusterModel::Oriented,
            push: Push::Immediate,
            sides: None,
            threads: 0,
            seed: 1,
            memory: MemoryBudget::default(),
            former_criterion: FormerCriterion::default(),
        }
    }
}

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
        /// Values a slider offers; the command line accepts what [`SolverParams::validate`] does.
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

/// A parameter that cannot be used, with what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParamsError {
    /// An error is a share.
    #[error("--error must be greater than 0 and less than 1 (it is {0}); try 0.05 for 5 %")]
    Error(f64),
    /// ε must be a positive number.
    #[error("--epsilon must be greater than 0 (it is {0}); try 1e-3 for a coarse and 1e-5 for a fine solution")]
    Epsilon(f64),
    /// Factors must be positive numbers.
    #[error("--{flag} must be greater than 0 and at most {most} (it is {value})")]
    Factor {
        /// The option.
        flag: &'static str,
        /// Value of the option.
        value: f64,
        /// The largest allowed value.
        most: f64,
    },
    /// Bounds the wrong way round or out of range.
    #[error("--rays-min ({min}) must be at least 1 and at most --rays-max ({max}), which must be at most 4096")]
    Rays {
        /// Lower bound.
        min: u32,
        /// Upper bound.
        max: u32,
    },
    /// A budget that nothing fits into, or of more than there is.
    #[error("--memory must be at least 1MiB, or more than 0% and at most 100% of the machine's memory (it is {0})")]
    Memory(MemoryBudget),
    /// Octree depth out of range.
    #[error("--octree-depth must lie between 1 and 16 (it is {0})")]
    OctreeDepth(u32),
}

impl SolverParams {
    /// Parameters where nobody says anything: a target error is asked for.
    pub fn usual() -> Self {
        Self { error: Some(USUAL_ERROR), ..Self::default() }
    }

    /// Name in files of a choice; `None` where it is left to the scene, and where the parameter is
    /// none.
    pub fn choice(&self, id: ParameterId) -> Option<String> {
        match id {
            ParameterId::Reconstruct => Some(name_of(&self.reconstruct)),
            ParameterId::Clustering => Some(name_of(&self.clustering)),
            ParameterId::ClusterModel => Some(name_of(&self.cluster_model)),
            ParameterId::Push => Some(name_of(&self.push)),
            ParameterId::Sides => self.sides.as_ref().map(name_of),
            _ => None,
        }
    }

    /// Makes a choice by its name in files; `None` leaves it to the scene where it can be.
    pub fn choose(&mut self, id: ParameterId, name: Option<&str>) {
        match id {
            ParameterId::Reconstruct => set(&mut self.reconstruct, name),
            ParameterId::Clustering => set(&mut self.clustering, name),
            ParameterId::ClusterModel => set(&mut self.cluster_model, name),
            ParameterId::Push => set(&mut self.push, name),
            ParameterId::Sides => set(&mut self.sides, name),
            _ => {}
        }
    }

    /// Refines by power whatever the file of an older version says; the sentence for a person
    /// where that makes a difference.
    pub fn forget_criterion(&mut self) -> Option<&'static str> {
        let former = std::mem::take(&mut self.former_criterion);
        (former == FormerCriterion::Error)
            .then_some("refinement by link error is gone, so links are refined by their power")
    }

    /// The threshold ε that the solver goes by.
    pub fn threshold(&self) -> Epsilon {
        self.error.map_or(self.epsilon, |error| Epsilon::Relative(EPSILON_PER_ERROR * error))
    }

    /// Rules that links are refined by, with ε in W.
    pub(super) fn link_rules(&self, epsilon_watts: f64) -> LinkRules {
        LinkRules {
            cluster_model: self.cluster_model,
            push: self.push,
            epsilon_watts,
            partial_factor: self.partial_factor,
            visibility_factor: self.visibility_factor,
            rays_min: self.rays_min,
            rays_max: self.rays_max,
            is_patient: self.error.is_some(),
            seed: self.seed,
        }
    }

    /// How light is shown.
    pub fn shown_by(&self) -> Reconstruct {
        if self.error.is_some() { Reconstruct::Gather } else { self.reconstruct }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// The first field that cannot be used, as one sentence.
    pub fn validate(&self) -> Result<(), ParamsError> {
        if let Some(error) = self.error.filter(|error| !(*error > 0.0 && *error < 1.0)) {
            return Err(ParamsError::Error(error));
        }
        let (Epsilon::Relative(epsilon) | Epsilon::Watts(epsilon)) = self.epsilon;
        if !(epsilon > 0.0 && epsilon.is_finite()) {
            return Err(ParamsError::Epsilon(epsilon));
        }
        let factors =
            [("partial-factor", self.partial_factor, 1.0), ("visibility-factor", self.visibility_factor, 1e4)];
        for (flag, value, most) in factors {
            if !(value > 0.0 && value <= most) {
                return Err(ParamsError::Factor { flag, value, most });
            }
        }
        if self.rays_min < 1 || self.rays_min > self.rays_max || self.rays_max > 4096 {
            return Err(ParamsError::Rays { min: self.rays_min, max: self.rays_max });
        }
        if !(1..=16).contains(&self.octree_depth) {
            return Err(ParamsError::OctreeDepth(self.octree_depth));
        }
        if !self.memory.is_usable() {
            return Err(ParamsError::Memory(self.memory));
        }
        Ok(())
    }
}

/// The name of a choice, as files spell it.
pub fn name_of(choice: &impl Serialize) -> String {
    let name = serde_json::to_value(choice).ok();
    name.as_ref().and_then(serde_json::Value::as_str).unwrap_or_default().to_owned()
}

/// Sets a choice by its name; one that is not known changes nothing.
fn set<T: serde::de::DeserializeOwned>(choice: &mut T, name: Option<&str>) {
    if let Ok(named) = serde_json::from_value(name.into()) {
        *choice = named;
    }
}
