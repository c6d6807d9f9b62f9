//! Placeholder solver: shows each polygon with its reflectance as radiosity.
pub mod params;
pub mod snapshot;
pub mod stats;

use std::sync::Arc;

pub use params::{
    ClusteringMode, Epsilon, Invalidates, PARAMETERS, Parameter, ParameterId, ParamsError, Push, SolverParams,
    ValueKind,
};
pub use snapshot::{ClusterBox, InspectedElement, Leaf, LinkView, Mesh, Snapshot};
pub use stats::{Bytes, Phase, Seconds, Stats};

use crate::cancel::CancelToken;
use crate::hierarchy::ElementId;
use crate::scene::{MaterialId, Scene};
use crate::visibility::Occluders;

/// Why a solve cannot start.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// A parameter cannot be used.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// Plain HR would need more memory than there is.
    #[error(
        "clustering none would judge {pairs} pairs and needs up to {needed_mib} MiB for links, but only {available_mib} MiB are free: choose adaptive, groups or octree"
    )]
    TooManyPairs {
        /// Pairs of initial patches.
        pairs: u64,
        /// Memory their links may take.
        needed_mib: u64,
        /// Memory that is free.
        available_mib: u64,
    },
}

/// What one call of [`Solver::step`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Judged and applied a part of a wave; true when the wave ended with it.
    Refined {
        /// Whether the wave ended.
        wave_ended: bool,
    },
    /// Gathered to convergence and judged the stored links again.
    Gathered,
    /// Nothing is left to do.
    Finished,
    /// The token was cancelled; the same step can be taken again, with the same result.
    Interrupted,
}

/// Refines the root's self-link and gathers, step by step.
pub struct Solver {
    scene: Arc<Scene>,
    params: SolverParams,
    generation: u64,
    serial: u64,
    steps: u32,
    inspected: Option<ElementId>,
}

impl Solver {
    /// Builds the hierarchy and the root's self-link.
    ///
    /// # Errors
    /// Parameters out of range, or a `none` solve that cannot fit into memory.
    pub fn new(
        scene: Arc<Scene>,
        _occluders: Arc<Occluders>,
        params: SolverParams,
        generation: u64,
    ) -> Result<Self, SolverError> {
        params.validate()?;
        Ok(Self { scene, params, generation, serial: 0, steps: 0, inspected: None })
    }

    /// Does one bounded piece of work.
    pub fn step(&mut self, cancel: &CancelToken) -> Step {
        if cancel.is_cancelled() {
            return Step::Interrupted;
        }
        self.steps += 1;
        match self.steps {
            0..50 => Step::Refined { wave_ended: true },
            50 => Step::Gathered,
            _ => Step::Finished,
        }
    }

    /// The present parameters.
    pub fn params(&self) -> &SolverParams {
        &self.params
    }

    /// Takes over new parameters with the least work that suffices; false when hierarchy or scene must be rebuilt by a new solver.
    ///
    /// # Errors
    /// Parameters out of range; the present ones stay.
    pub fn set_params(&mut self, params: SolverParams) -> Result<bool, SolverError> {
        params.validate()?;
        let change = self.params.change_to(&params);
        self.params = params;
        self.steps = 0;
        Ok(change < Invalidates::Hierarchy)
    }

    /// Changes a material's emission B_e (W/m²); ε in watts stays.
    pub fn set_emission(&mut self, material: MaterialId, emission: glam::Vec3) {
        let mut scene = (*self.scene).clone();
        scene.materials[material.0 as usize].emission = emission;
        self.scene = Arc::new(scene);
        self.steps = 0;
    }

    /// Asks that snapshots carry the links of an element.
    pub fn inspect(&mut self, element: Option<ElementId>) {
        self.inspected = element;
    }

    /// Counts and times so far.
    pub fn stats(&self) -> Stats {
        Stats {
            initial_patches: self.scene.polygons.len(),
            patches: self.scene.polygons.len(),
            iterations: self.steps,
            ..Stats::default()
        }
    }

    /// A picture of what is there, candidates counted at their present level.
    pub fn snapshot(&mut self) -> Snapshot {
        self.serial += 1;
        let mut mesh = Mesh::default();
        let mut vertex_radiosity = Vec::new();
        let mut leaf_radiosity = Vec::new();
        for (index, polygon) in self.scene.polygons.iter().enumerate() {
            let first = mesh.positions.len() as u32;
            let (corners, count) = self.scene.corner_positions(polygon);
            let material = &self.scene.materials[polygon.material.0 as usize];
            let shade = 0.6 + 0.4 * self.scene.normal(polygon).dot(glam::Vec3::new(0.3, 0.8, 0.5));
            let radiosity = (material.emission + shade * material.reflectance).to_array();
            mesh.positions.extend(corners[..count].iter().map(|corner| corner.to_array()));
            vertex_radiosity.extend(std::iter::repeat_n(radiosity, count));
            for corner in 2..count as u32 {
                mesh.triangles.push([first, first + corner - 1, first + corner]);
                mesh.triangle_leaf.push(index as u32);
            }
            for corner in 0..count as u32 {
                mesh.outlines.push([first + corner, first + (corner + 1) % count as u32]);
            }
            mesh.leaves.push(Leaf {
                element: ElementId(index as u32 + 1),
                polygon: index as u32,
                material: polygon.material,
                area: self.scene.area(polygon),
                level: 0,
            });
            leaf_radiosity.push(radiosity);
        }
        let (lower, upper) = self.scene.bounds();
        let clusters = vec![ClusterBox { lower, upper, level: 0, polygons: self.scene.polygons.len() as u32 }];
        Snapshot {
            generation: self.generation,
            serial: self.serial,
            mesh: Arc::new(mesh),
            vertex_radiosity,
            leaf_irradiance: leaf_radiosity.clone(),
            leaf_radiosity,
            clusters: Arc::new(clusters),
            inspected: self.inspected.map(|element| InspectedElement {
                element,
                centre: (lower + upper) / 2.0,
                links: Vec::new(),
            }),
            stats: self.stats(),
        }
    }
}
