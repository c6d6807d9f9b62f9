//! Files that are solved, not only read.

use std::sync::Arc;

use selflink::base::cancel::CancelToken;
use selflink::prepare::added_light::{AddedLight, CeilingLight};
use selflink::prepare::prepare;
use selflink::scene::{Reading, Source};
use selflink::solve::{Solver, SolverParams};

use crate::support::Folder;

fn solved(source: &Source, light: &AddedLight) -> Solver {
    let ready = prepare(source, &Reading::default(), light, None).expect("a sound scene");
    let (scene, occluders) = (Arc::new(ready.scene), Arc::new(ready.occluders));
    let mut solver = Solver::new(scene, occluders, SolverParams::default(), 0).expect("usable parameters");
    assert!(solver.run(&CancelToken::new()), "nobody cancels");
    solver
}

/// Truth: counted once, and doubled: three faces that enclose little are little work, whatever
/// clocks say.
#[test]
fn three_faces_and_a_ceiling_light_are_little_work() {
    let folder = Folder::new();
    let path = folder.write(
        "a.obj",
        "v 0 2 2\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\nf 2 5 6 3\nf 7 6 5 8\n",
    );
    let ceiling = Some(CeilingLight { size: Some(0.5), exitance: 100.0 });
    let solver = solved(&Source::File(path), &AddedLight { ceiling, ..AddedLight::default() });
    let stats = solver.stats();
    let (rays, pairs) = (stats.rays, stats.pairs_judged);
    assert!(rays > 0 && rays < 160_000 && pairs < 44_000, "{rays} rays, {pairs} pairs");
}
