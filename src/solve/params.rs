//! The solver's parameters: their values, defaults, and what cannot be used.

use serde::{Deserialize, Serialize};

use super::parameter_table::ParameterId;
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

/// All that a person can turn; [`PARAMETERS`](super::PARAMETERS) describes each field.
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

/// A parameter that cannot be used: a sentence with what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct ParamsError(String);

impl SolverParams {
    /// Parameters where nobody says anything: a target error is asked for.
    pub fn usual() -> Self {
        Self { error: Some(USUAL_ERROR), ..Self::default() }
    }

    /// The usual parameters with a share of Φ as ε.
    pub fn with_epsilon(share: f64) -> Self {
        Self { epsilon: Epsilon::Relative(share), ..Self::default() }
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

    /// A parameter that is a real number; `None` of an error that is not asked for and of ε in the
    /// measure that it is not set in, and where the parameter is none.
    pub fn real(&self, id: ParameterId) -> Option<f64> {
        match (id, self.epsilon) {
            (ParameterId::Error, _) => self.error,
            (ParameterId::Epsilon, Epsilon::Relative(epsilon)) => Some(epsilon),
            (ParameterId::EpsilonWatts, Epsilon::Watts(epsilon)) => Some(epsilon),
            (ParameterId::PartialFactor, _) => Some(self.partial_factor),
            (ParameterId::VisibilityFactor, _) => Some(self.visibility_factor),
            (ParameterId::Memory, _) => Some(self.memory.share()),
            _ => None,
        }
    }

    /// Sets a parameter that is a real number.
    pub fn set_real(&mut self, id: ParameterId, value: f64) {
        match id {
            ParameterId::Error => self.error = Some(value),
            ParameterId::Epsilon => self.epsilon = Epsilon::Relative(value),
            ParameterId::EpsilonWatts => self.epsilon = Epsilon::Watts(value),
            ParameterId::PartialFactor => self.partial_factor = value,
            ParameterId::VisibilityFactor => self.visibility_factor = value,
            ParameterId::Memory => self.memory = MemoryBudget::Share(value),
            _ => {}
        }
    }

    /// A parameter that is a whole number; `None` where it is none.
    pub fn whole(&self, id: ParameterId) -> Option<u64> {
        match id {
            ParameterId::RaysMin => Some(self.rays_min.into()),
            ParameterId::RaysMax => Some(self.rays_max.into()),
            ParameterId::OctreeDepth => Some(self.octree_depth.into()),
            ParameterId::Threads => Some(self.threads.into()),
            ParameterId::Seed => Some(self.seed),
            _ => None,
        }
    }

    /// Sets a parameter that is a whole number.
    pub fn set_whole(&mut self, id: ParameterId, value: u64) {
        let small = u32::try_from(value).unwrap_or(u32::MAX);
        match id {
            ParameterId::RaysMin => self.rays_min = small,
            ParameterId::RaysMax => self.rays_max = small,
            ParameterId::OctreeDepth => self.octree_depth = small,
            ParameterId::Threads => self.threads = small,
            ParameterId::Seed => self.seed = value,
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
        let Self { rays_min, rays_max, octree_depth, memory, .. } = *self;
        if let Some(error) = self.error.filter(|error| !(*error > 0.0 && *error < 1.0)) {
            return unusable(format!(
                "--error must be greater than 0 and less than 1 (it is {error}); try 0.05 for 5 %"
            ));
        }
        let (Epsilon::Relative(epsilon) | Epsilon::Watts(epsilon)) = self.epsilon;
        if !(epsilon > 0.0 && epsilon.is_finite()) {
            return unusable(format!(
                "--epsilon must be greater than 0 (it is {epsilon}); try 1e-3 for a coarse and 1e-5 for a fine solution"
            ));
        }
        let factors =
            [("partial-factor", self.partial_factor, 1.0), ("visibility-factor", self.visibility_factor, 1e4)];
        for (flag, value, most) in factors {
            if !(value > 0.0 && value <= most) {
                return unusable(format!("--{flag} must be greater than 0 and at most {most} (it is {value})"));
            }
        }
        if rays_min < 1 || rays_min > rays_max || rays_max > 4096 {
            return unusable(format!(
                "--rays-min ({rays_min}) must be at least 1 and at most --rays-max ({rays_max}), which must be at most 4096"
            ));
        }
        if !(1..=16).contains(&octree_depth) {
            return unusable(format!("--octree-depth must lie between 1 and 16 (it is {octree_depth})"));
        }
        if !memory.is_usable() {
            return unusable(format!(
                "--memory must be at least 1MiB, or more than 0% and at most 100% of the machine's memory (it is {memory})"
            ));
        }
        Ok(())
    }
}

fn unusable(sentence: String) -> Result<(), ParamsError> {
    Err(ParamsError(sentence))
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
