//! Where the emitted power goes.
//!
//! Truth: conservation. What is absorbed by bright sides (from the solution), stopped by backs and
//! lost to the outside (both by rays that know nothing of its links) is what the lamps emit.

use selflink::hierarchy::ClusteringMode;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{SolverParams, power_balance};

use super::support::{MODES, lamp_room, params, solve};

/// 2 %, as the issue asks; 65,536 rays are good to 0.4 % of the power that is lost.
fn closes(scene: BuiltinScene) {
    let solved = solve(&scene.build(), params(ClusteringMode::Adaptive, 1e-4));
    let balance = power_balance(&solved, 1 << 16, 7);
    let gap = balance.relative_gap();
    println!("{}: {:+.2} % of the power is missing", scene.name(), 100.0 * gap);
    assert!(gap.abs() < 0.02, "{}: {:+.2} % of the power is missing: {balance:?}", scene.name(), 100.0 * gap);
}

/// Truth: conservation, after a gather to 5 %: 1 %, beside what 65,536 rays leave open of what is
/// lost, 0.4 % at most.
#[test]
fn the_gathered_power_balance_closes() {
    let seminar = BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS };
    for (name, scene) in [
        ("cornell", BuiltinScene::Cornell.build()),
        ("seminar", seminar.build()),
        ("office", BuiltinScene::Office.build()),
        ("the lamp room", lamp_room()),
    ] {
        let params = SolverParams { error: Some(0.05), ..SolverParams::default() };
        let gap = power_balance(&solve(&scene, params), 1 << 16, 7).relative_gap();
        println!("{name}: {:+.2} % of the power is missing after a gather", 100.0 * gap);
        assert!(gap.abs() < 0.014, "{name}: {:+.2} % of the power is missing", 100.0 * gap);
    }
}

#[test]
fn power_balance_closes_in_the_cornell_box() {
    closes(BuiltinScene::Cornell);
}

#[test]
fn power_balance_closes_in_the_seminar_room() {
    closes(BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS });
}

#[test]
fn power_balance_closes_in_the_office() {
    closes(BuiltinScene::Office);
}

/// 4 % at a threshold that leaves single links a thousandth of the power: what few rays see or miss
/// by chance must not add up.
#[test]
fn power_balance_closes_at_a_coarse_threshold() {
    for mode in [ClusteringMode::Adaptive, ClusteringMode::Groups, ClusteringMode::Octree] {
        let scene = BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS }.build();
        let gap = power_balance(&solve(&scene, params(mode, 1e-3)), 1 << 16, 7).relative_gap();
        println!("{mode:?}: {:+.2} % of the power is missing", 100.0 * gap);
        assert!(gap.abs() < 0.04, "{mode:?}: {:+.2} %", 100.0 * gap);
    }
}

/// A closed room loses nothing: what is emitted is absorbed or meets the lamp's back, in every
/// mode.
#[test]
fn a_closed_room_loses_nothing() {
    for mode in MODES {
        let balance = power_balance(&solve(&lamp_room(), params(mode, 1e-4)), 1 << 14, 7);
        println!("{mode:?}: {:+.2} % of the power is missing", 100.0 * balance.relative_gap());
        // One ray in a thousand may slip through the edge between two faces.
        assert!(balance.escaped.element_sum() < 1e-3 * balance.emitted.element_sum(), "{mode:?}");
        assert!(balance.relative_gap().abs() < 0.02, "{mode:?}: {:+.2} %", 100.0 * balance.relative_gap());
    }
}
