//! Groups made by hand: in the sidecar, as clusters, and through the worker.
//!
//! Truth: the same tree gives the same hierarchy and the same solution bit for bit; boxes and
//! counts of what was grouped.

#[path = "support/waiting.rs"]
mod waiting;

use std::sync::Arc;

use selflink::base::cancel::CancelToken;
use selflink::geometry::Occluders;
use selflink::geometry::Reachability;
use selflink::hierarchy::{ClusteringMode, Hierarchy, Shape};
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{
    GroupMember, GroupTree, Scene, Sidecar, SidecarError, SidecarFault, Source, load_file, write_obj,
};
use selflink::solve::{Epsilon, Snapshot, Solver, SolverParams};
use selflink::worker::{Command, Event, RunState, SolverThread};
use waiting::wait_for;

fn params() -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(1e-2), clustering: ClusteringMode::Groups, ..SolverParams::default() }
}

fn solution(scene: &Scene) -> Snapshot {
    let (scene, occluders) = (Arc::new(scene.clone()), Arc::new(Occluders::new(scene)));
    let mut solver = Solver::new(scene, occluders, params(), 1).expect("the parameters are valid");
    assert!(solver.run(&CancelToken::new()));
    solver.snapshot()
}

fn hierarchy(scene: &Scene) -> Hierarchy {
    let reachability = Arc::new(Reachability::new(scene, &Occluders::new(scene)));
    Hierarchy::new(scene, reachability, ClusteringMode::Groups, 5)
}

fn members(json: &str) -> Vec<GroupMember> {
    serde_json::from_str(json).expect("a list of members")
}

/// All that tells hierarchies apart.
fn described(hierarchy: &Hierarchy) -> String {
    format!("{:?}", hierarchy.elements())
}

#[test]
fn groups_that_equal_the_scene_s_own_give_the_same_solution_bit_for_bit() {
    let mut scene = BuiltinScene::Cornell.build();
    let plain = solution(&scene);
    // Every group named where it is already, the last first.
    let remarks =
        scene.regroup(members(r#"[{"tall_block": ["tall_block/*"]}, "short_block", {"lamp": ["lamp/*"]}, "walls"]"#));
    assert_eq!(remarks, [""; 0]);
    let by_hand = solution(&scene);
    assert_eq!(by_hand.vertex_radiosity, plain.vertex_radiosity);
    assert_eq!(by_hand.stats.links, plain.stats.links);
    assert_eq!(by_hand.stats.rays, plain.stats.rays);
}

#[test]
fn objects_that_were_grouped_become_a_cluster() {
    let mut scene = BuiltinScene::Cornell.build();
    let before = hierarchy(&scene).cluster_count();
    scene.regroup(members(r#"[{"blocks": ["short_block", "tall_block"]}]"#));
    let after = hierarchy(&scene);
    assert_eq!(after.cluster_count(), before + 1);
    let polygons_of =
        |name: &str| scene.polygons.iter().filter(|polygon| scene.group_path(polygon.group) == name).count();
    let both = polygons_of("short_block") + polygons_of("tall_block");
    let sizes: Vec<usize> = after
        .elements()
        .iter()
        .filter_map(|element| match &element.shape {
            Shape::Cluster(cluster) => Some(after.patches_below(cluster).len()),
            Shape::Patch(_) | Shape::Sky(_) => None,
        })
        .collect();
    assert!(sizes.contains(&both), "{sizes:?}");
}

#[test]
fn groups_come_back_from_the_sidecar_with_the_same_hierarchy() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = write_obj(&BuiltinScene::Cornell.build(), folder.path()).expect("it can be written");
    let mut scene = load_file(&path).expect("our own scene");
    let edited = {
        let tree = scene.group_tree();
        let blocks: Vec<_> = (1..tree.groups().len() as u32)
            .map(selflink::scene::GroupId)
            .filter(|group| tree.groups()[group.0 as usize].name.ends_with("_block"))
            .collect();
        tree.grouped(&blocks, "the two / blocks").expect("they can be grouped").tree
    };
    scene.regroup(edited.members(&scene.groups));
    let sidecar_path = Sidecar::path_for(&path);
    let mut sidecar = Sidecar::read(&sidecar_path).expect("it is there");
    sidecar.update(&scene);
    sidecar.write(&sidecar_path).expect("it can be written");
    let again = load_file(&path).expect("our own scene");
    assert_eq!(again.regrouping, scene.regrouping);
    assert_eq!(again.group_tree(), edited);
    assert_eq!(described(&hierarchy(&again)), described(&hierarchy(&scene)));
    assert_eq!(again.skipped.notes, scene.skipped.notes);
    // Undone by hand, nothing is left of it in the file.
    scene.regroup(Vec::new());
    sidecar.update(&scene);
    assert!(sidecar.groups.is_empty() && !serde_json::to_string(&sidecar).expect("JSON").contains("groups"));
}

#[test]
fn names_that_are_not_there_are_told_and_counted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = write_obj(&BuiltinScene::Cornell.build(), folder.path()).expect("it can be written");
    let sidecar_path = Sidecar::path_for(&path);
    let strangers: Vec<String> = (0..9).map(|number| format!("\"table_{number}\"")).collect();
    let text = format!(r#"{{"groups": [{{"furniture": ["tall_block", {}]}}]}}"#, strangers.join(","));
    std::fs::write(&sidecar_path, text).expect("a writable folder");
    let scene = load_file(&path).expect("strangers do no harm");
    let notes = &scene.skipped.notes;
    assert!(notes.iter().any(|note| note.contains("`table_0`")), "{notes:?}");
    assert!(notes.iter().any(|note| note.starts_with("4 more objects")), "{notes:?}");
    assert!(scene.group_tree().addresses().contains(&"furniture/tall_block".to_owned()));
    for bad in [r#"{"groups": {"a": []}}"#, r#"{"groups": [7]}"#, r#"{"groups": [{"a": [], "b": []}]}"#] {
        std::fs::write(&sidecar_path, bad).expect("a writable folder");
        let error = load_file(&path).expect_err("no list of groups").to_string();
        assert!(error.contains("not a valid settings file") && error.contains("selflink.json"), "{error}");
        assert!(matches!(Sidecar::read(&sidecar_path), Err(SidecarError { fault: SidecarFault::Syntax(_), .. })));
    }
}

#[test]
fn the_worker_builds_clusters_anew_only_where_they_go_by_groups() {
    let worker = SolverThread::spawn(params(), Box::new(|| ())).expect("a thread");
    let until = |what: &str, holds: &dyn Fn() -> bool| wait_for(what, || holds().then_some(()));
    let edited = || {
        wait_for("the edit", || match worker.try_event() {
            Some(Event::SceneEdited(info)) => Some(info),
            Some(Event::SolveFailed(sentence)) => panic!("{sentence}"),
            _ => None,
        })
    };
    let finished = || worker.status().run == RunState::Finished;
    // For a moment the status is still that of the solve before.
    let is_done = |latest: &Snapshot, generation| latest.generation == generation && latest.stats.converged;
    worker.send(Command::load(Source::Builtin(BuiltinScene::Cornell)));
    until("the solution", &|| finished() && worker.latest().is_some());
    let blocks = members(r#"[{"blocks": ["short_block", "tall_block"]}]"#);
    worker.send(Command::SetGroups(blocks.clone()));
    let info = edited();
    assert_eq!((info.scene.regrouping.clone(), info.generation), (blocks.clone(), 2));
    until("another solution", &|| finished() && worker.latest().is_some_and(|latest| is_done(&latest, 2)));
    let mut expected = BuiltinScene::Cornell.build();
    expected.regroup(blocks);
    let expected = solution(&expected);
    assert_eq!(worker.latest().map(|latest| latest.stats.links), Some(expected.stats.links));

    worker.send(Command::SetParams(SolverParams { clustering: ClusteringMode::Adaptive, ..params() }));
    until("adaptive clusters", &|| finished() && worker.latest().is_some_and(|latest| is_done(&latest, 3)));
    worker.send(Command::SetGroups(Vec::new()));
    let info = edited();
    assert_eq!((info.scene.regrouping.len(), info.generation), (0, 3));
    assert_eq!(GroupTree::arranged(&info.scene.groups, &[]).0, info.scene.group_tree());
}
