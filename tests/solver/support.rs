//! Small scenes made in code, and short ways to solve them.

use std::sync::Arc;

use selflink::base::cancel::CancelToken;
use selflink::geometry::Occluders;
use selflink::hierarchy::ElementId;
use selflink::scene::Scene;
use selflink::solve::{Solver, SolverParams};
use selflink::transport::Link;

pub use selflink::measure::stability::measure::{MODES, deviation, difference, is_sound, leaves, params, received};
pub use selflink::measure::stability::scenes::{add_box, empty_room, furnished_room, lamp_room};

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

/// Does some work on this many threads.
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are left").install(work)
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
