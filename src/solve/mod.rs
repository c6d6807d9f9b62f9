//! The solve: from parameters to a picture, one bounded piece of work at a time.
//!
//! [`Solver::step`] does what its `Job` says, so that whoever drives it can look at pictures,
//! change parameters or stop in between. Links are refined, light is moved over them, stored links
//! are judged again, until none fails ([`crate::transport`]); where an error is asked for, light is
//! then gathered anew over them until a certificate keeps the target error ([`crate::gather`]).
//! The work that a changed setting, lamp or material needs is found by `change` and done by `live`.

mod balance;
mod change;
mod final_gather;
mod job;
mod live;
mod memory;
mod mesh_error;
mod parameter_table;
pub mod params;
mod picture;
mod progress;
mod reconstruction_mesh;
pub mod snapshot;
mod state;
pub mod stats;
mod timeline;

use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;

pub use balance::{PowerBalance, power_balance};
pub use change::ChangeCost;
pub use job::Step;
pub use memory::MemoryStop;
pub use mesh_error::MeshError;
pub use parameter_table::{PARAMETERS, Parameter, ParameterId, ValueKind};
pub use params::{ClusteringMode, Epsilon, ParamsError, Reconstruct, SolverParams, USUAL_ERROR, name_of};
pub use reconstruction_mesh::{barycentric, place_among};
pub use snapshot::{ClusterBox, Leaf, Mesh, Snapshot};
pub use stats::{Bytes, ErrorFound, Phase, Seconds, Stats};
pub use timeline::{TimelineStep, TimelineStepKind};

use crate::gather::Gather;
use crate::geometry::{Occluders, Reachability};
use crate::hierarchy::Hierarchy;
use crate::scene::Scene;
use crate::transport::{ENTERING_RAYS, LinkSolution, entering_power, new_hierarchy};
use job::{Job, Pending};
use memory::check_pairs_fit;
use picture::View;
use timeline::Timeline;

/// Why a solve cannot start.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// A parameter cannot be used.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// Plain HR would need more memory than there is.
    #[error(
        "clustering none would judge {pairs} pairs and needs up to {needed_mib} MiB for their links, more than half of the memory budget of {budget_mib} MiB: choose adaptive, groups or octree, or give more with --memory"
    )]
    TooManyPairs {
        /// Pairs of initial patches.
        pairs: u64,
        /// Memory their links may take, MiB.
        needed_mib: u64,
        /// The memory budget, MiB.
        budget_mib: u64,
    },
}

/// Drives a solve, step by step.
pub struct Solver {
    params: SolverParams,
    /// The Φ by which ε became watts, W.
    anchor_watts: f64,
    links: LinkSolution,
    /// The final gather over the links, once it has begun.
    gather: Option<Gather>,
    /// Errors that the gather's certificate found, once it ended.
    error_found: Option<ErrorFound>,
    job: Job,
    pending: Pending,
    /// The part that was not refined as far as was asked for, for want of memory.
    memory_stop: Option<MemoryStop>,
    /// Time spent working; whoever drives the solver may let it rest in between.
    seconds: Seconds,
    view: View,
    timeline: Option<Timeline>,
}

impl Solver {
    /// Builds the hierarchy and the root's self-link.
    ///
    /// # Errors
    /// Parameters out of range, or a `none` solve that cannot fit into memory.
    pub fn new(
        scene: Arc<Scene>,
        occluders: Arc<Occluders>,
        params: SolverParams,
        generation: u64,
    ) -> Result<Self, SolverError> {
        check(&scene, &params)?;
        let entering = entering_power(&scene, &occluders, ENTERING_RAYS, params.seed);
        let reachability = || Arc::new(Reachability::new(&scene, &occluders));
        let (hierarchy, seconds) = timed(|| clusters(&scene, reachability(), &params, entering));
        let power = f64::from((scene.emitted_power() + entering).max_element());
        let rules = params.link_rules(watts(&params, power));
        let links = LinkSolution::new(scene, occluders, hierarchy, entering, rules);
        let clusters = links.hierarchy().cluster_count();
        tracing::info!(clusters, epsilon_watts = watts(&params, power), power_watts = power, seconds, "clusters built");
        Ok(Self::over(links, params, power, (generation, seconds)))
    }

    /// A solution of a scene whose snapshots hold its elements and links.
    #[cfg(test)]
    pub(crate) fn solved(scene: impl Into<Arc<Scene>>, params: SolverParams) -> Self {
        let scene = scene.into();
        let occluders = Arc::new(Occluders::new(&scene));
        let mut solver = Self::new(scene, occluders, params, 1).expect("the parameters are valid");
        assert!(solver.run(&crate::base::cancel::CancelToken::new()));
        solver.show_solution_view(true);
        solver
    }

    /// The elements and links of a scene's solution.
    #[cfg(test)]
    pub(crate) fn solved_view(
        scene: impl Into<Arc<Scene>>,
        params: SolverParams,
    ) -> Arc<crate::transport::SolutionView> {
        Self::solved(scene, params).snapshot().solution_view.expect("it was asked for")
    }

    fn over(links: LinkSolution, params: SolverParams, anchor_watts: f64, (generation, seconds): (u64, f64)) -> Self {
        Self {
            params,
            anchor_watts,
            links,
            gather: None,
            error_found: None,
            job: Job::Refine { is_last: false },
            pending: Pending::default(),
            memory_stop: None,
            seconds: Seconds { hierarchy: seconds, total: seconds, ..Seconds::default() },
            view: View::new(generation),
            timeline: None,
        }
    }
}

fn check(scene: &Scene, params: &SolverParams) -> Result<(), SolverError> {
    params.validate()?;
    if params.clustering == ClusteringMode::None {
        check_pairs_fit(scene.polygons.len() as u64, params.memory.bytes())?;
    }
    Ok(())
}

/// Clusters as they are asked for.
fn clusters(scene: &Scene, reachability: Arc<Reachability>, params: &SolverParams, entering: Vec3) -> Hierarchy {
    new_hierarchy(scene, reachability, (params.clustering, params.octree_depth), entering)
}

/// Does some work; also tells how many seconds it took.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let result = work();
    (result, begun.elapsed().as_secs_f64())
}

/// ε in W, where Φ is `power`.
fn watts(params: &SolverParams, power: f64) -> f64 {
    match params.threshold() {
        Epsilon::Watts(watts) => watts,
        Epsilon::Relative(share) => share * power,
    }
}
