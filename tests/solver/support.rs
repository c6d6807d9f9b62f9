//! Small scenes made in code, and short ways to solve them.

use std::sync::Arc;

use selflink::cancel::CancelToken;
use selflink::hierarchy::{ElementId, Hierarchy, Shape};
use selflink::scene::Scene;
use selflink::solver::{Link, Solver, SolverParams};
use selflink::visibility::Occluders;

pub use selflink::stability::measure::{MODES, deviation, difference, is_sound, leaves, params, received};
pub use selflink::stability::scenes::{add_box, empty_room, furnished_room, lamp_room};

/// A solver that has not started; records its rejections.
pub fn solver(scene: &Scene, params: SolverParams) -> Solver {
    let occluders = Arc::new(Occluders::new(scene));
    let mut solver = Solver::new(Arc::new(scene.clone()), occluders, params, 0).expect("usable parameters");
    solver.record_rejected();
    solver
}

/// A finished solve.
pub fn solve(scene: &Scene, params: SolverParams) -> Solver {
    let mut solver = solver(scene, params);
    assert!(solver.run(&CancelToken::new()), "nobody cancels");
    assert!(solver.stats().converged);
    solver
}

/// The same, with this many threads.
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are left").install(work)
}

/// The initial patch that a patch is a part of, and the share of its area.
pub fn initial_patch(hierarchy: &Hierarchy, patch: ElementId) -> (ElementId, f64) {
    let mut id = patch;
    while let Shape::Patch(shape) = hierarchy.element(id).shape
        && shape.level > 0
    {
        id = hierarchy.element(id).parent().expect("a patch below the first level has a parent");
    }
    (id, f64::from(hierarchy.element(patch).area) / f64::from(hierarchy.element(id).area))
}

/// A stored link, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkBits {
    pub receiver: ElementId,
    pub source: ElementId,
    pub form_factor: u32,
    pub visibility: u32,
}

/// Every stored link, bit for bit.
pub fn links(solver: &Solver) -> Vec<LinkBits> {
    let bits = |receiver: ElementId, link: &Link| LinkBits {
        receiver,
        source: link.source(),
        form_factor: link.form_factor.to_bits(),
        visibility: link.visibility().to_bits(),
    };
    let of = |receiver: ElementId| solver.links().of(receiver).iter().map(move |link| bits(receiver, link));
    solver.hierarchy().ids().flat_map(of).collect()
}

/// Every radiosity, bit for bit.
pub fn radiosity_bits(solver: &Solver) -> Vec<[u32; 3]> {
    solver.radiosity().iter().map(|radiosity| radiosity.to_array().map(f32::to_bits)).collect()
}
