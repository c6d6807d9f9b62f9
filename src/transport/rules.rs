//! The rules of transport: thresholds and rays of links, and what clusters are to light.

use serde::{Deserialize, Serialize};

use super::visibility::Thresholds;

/// When irradiance that a cluster received reaches the patches below it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Push {
    /// Link by link, weighted with each patch's cosine towards the source (α-links, section 3.3).
    #[default]
    Immediate,
    /// Summed on the cluster and handed down evenly afterwards (β-links).
    Deferred,
}

/// Model of how a cluster sends and receives light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ClusterModel {
    /// A volume that scatters alike into all directions (section 1.2, [Sillion 95]): its mean
    /// cosine is ¼, whichever way its polygons are turned, and what it emits leaves it as what it
    /// reflects does.
    Isotropic,
    /// The polygons that it holds: pairs of points on the ends of a link tell by which cosines they
    /// see each other, and what a cluster emits is looked at apart from what it reflects.
    #[default]
    Oriented,
}

/// Rules of a [`super::LinkSolution`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkRules {
    /// Model of how clusters exchange light.
    pub cluster_model: ClusterModel,
    /// When clusters hand irradiance down.
    pub push: Push,
    /// Threshold ε on B_s·F·A_r, W.
    pub epsilon_watts: f64,
    /// ε_partial / ε.
    pub partial_factor: f64,
    /// f_vis: visibility rays per BFA/ε.
    pub visibility_factor: f64,
    /// Fewest visibility rays of a link that is tested at all.
    pub rays_min: u32,
    /// Most visibility rays of a link.
    pub rays_max: u32,
    /// Whether pairs that seem occluded get many rays, to be believed sooner.
    pub is_patient: bool,
    /// Seed of the visibility rays.
    pub seed: u64,
}

impl LinkRules {
    /// The thresholds of a stage, at this multiple of ε.
    pub(super) fn thresholds(&self, multiple: f64) -> Thresholds {
        let epsilon = self.epsilon_watts * multiple;
        Thresholds {
            epsilon: epsilon as f32,
            epsilon_partial: (self.partial_factor * epsilon) as f32,
            visibility_factor: self.visibility_factor as f32,
            rays_min: self.rays_min,
            rays_max: self.rays_max,
            is_patient: self.is_patient,
        }
    }
}
