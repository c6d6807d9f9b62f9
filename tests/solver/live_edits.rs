//! Parameters and lamps changed while a solution is there: what is still valid stays, and the
//! result is a fresh solve's.
//!
//! Truth: a fresh solve, within the error that ε allows either of them.

use glam::Vec3;
use selflink::base::cancel::CancelToken;
use selflink::hierarchy::ClusteringMode;
use selflink::scene::{GroupId, MaterialId};
use selflink::solve::{Epsilon, Solver, SolverParams};
use selflink::transport::{ClusterModel, Push};

use super::support::{add_box, difference, empty_room, is_sound, lamp_room, links, params, received, solve};

const COARSE: f64 = 1e-2;
const FINE: f64 = 1e-3;
/// Two solutions of one threshold whose links were judged by other radiosities on the way: each is
/// within a few per cent of the truth at ε = 1e-3.
const SAME: f64 = 0.03;

fn change(solver: &mut Solver, params: SolverParams) {
    assert!(!solver.set_params(params).expect("usable parameters").is_rebuilt(), "the hierarchy stays");
    assert!(solver.run(&CancelToken::new()));
    assert!(is_sound(solver));
}

#[test]
fn a_finer_threshold_goes_on_from_what_is_there() {
    for mode in [ClusteringMode::None, ClusteringMode::Groups, ClusteringMode::Adaptive] {
        let fresh = solve(&lamp_room(), params(mode, FINE));
        let mut solver = solve(&lamp_room(), params(mode, COARSE));
        let before = solver.stats();
        change(&mut solver, params(mode, FINE));
        let after = solver.stats();
        assert!(after.links > before.links && after.patches > before.patches);
        let judged = after.pairs_judged - before.pairs_judged;
        assert!(judged < fresh.stats().pairs_judged, "{mode:?}: {judged} of {}", fresh.stats().pairs_judged);
        let off = difference(&solver, &fresh);
        println!("{mode:?}: {judged} pairs judged instead of {}, B differs by {off:.4}", fresh.stats().pairs_judged);
        assert!(off < SAME, "{mode:?}: B differs by {off}");
    }
}

#[test]
fn a_coarser_threshold_gives_the_coarse_solution() {
    for mode in [ClusteringMode::None, ClusteringMode::Groups, ClusteringMode::Adaptive] {
        let fresh = solve(&lamp_room(), params(mode, COARSE));
        let mut solver = solve(&lamp_room(), params(mode, FINE));
        let before = solver.stats();
        change(&mut solver, params(mode, COARSE));
        let after = solver.stats();
        assert!(after.links < before.links && after.patches < before.patches);
        let off = difference(&solver, &fresh);
        println!("{mode:?}: {} links instead of {}, B differs by {off:.4}", after.links, fresh.stats().links);
        // Ten times the threshold, ten times the error per link; half as many digits on the whole.
        assert!(off < 3.0 * SAME, "{mode:?}: B differs by {off}");
    }
}

/// Truth: rest is not work, and a solve that begins again counts what a fresh one counts; judging
/// by the radiosities that are known it judges some pairs more or less, but not twice as many.
/// Another seed is what makes it begin again.
#[test]
fn time_and_counts_are_those_of_the_present_solve() {
    let mut solver = Solver::new(
        lamp_room().into(),
        selflink::geometry::Occluders::new(&lamp_room()).into(),
        params(ClusteringMode::Adaptive, FINE),
        1,
    )
    .expect("usable parameters");
    solver.step(&CancelToken::new());
    let worked = solver.stats().seconds.total;
    assert_eq!(solver.stats().seconds.total, worked, "time passes while nothing is done");
    assert!(solver.run(&CancelToken::new()));
    let seconds = solver.stats().seconds;
    assert!(seconds.total > 0.0, "{seconds:?}");
    let parts = seconds.hierarchy + seconds.refine + seconds.gather;
    assert!((seconds.total - parts).abs() < 1e-9, "no snapshot was taken: {seconds:?}");

    let fine = solver.stats();
    let other = SolverParams { seed: 2, ..params(ClusteringMode::Adaptive, COARSE) };
    change(&mut solver, other);
    let (after, fresh) = (solver.stats(), solve(&lamp_room(), other).stats());
    assert!(after.rays < 2 * fresh.rays && after.rays < fine.rays, "{} rays, {} afresh", after.rays, fresh.rays);
    assert!(after.pairs_judged < 2 * fresh.pairs_judged, "{} of {}", after.pairs_judged, fresh.pairs_judged);
    assert!(after.iterations <= fresh.iterations + 2);
    let parts = after.seconds.hierarchy + after.seconds.refine + after.seconds.gather;
    assert!((after.seconds.total - parts).abs() < 1e-9, "{:?}", after.seconds);
}

/// Truth: E itself. What the links of a leaf and of all that hold it bring to it adds up to its
/// irradiance, for a picture of what is not finished too; a picture's gather leaves 5e-3 of the
/// power undone, the last one 1e-5.
#[test]
fn the_shares_of_an_elements_links_add_up_to_its_irradiance() {
    for push in [Push::Immediate, Push::Deferred] {
        let params = SolverParams { push, ..params(ClusteringMode::Adaptive, FINE) };
        let occluders = selflink::geometry::Occluders::new(&lamp_room());
        let mut solver = Solver::new(lamp_room().into(), occluders.into(), params, 1).expect("usable parameters");
        for (finish, tolerance) in [(false, 0.05), (true, 1e-3)] {
            if finish {
                assert!(solver.run(&CancelToken::new()));
            }
            let leaves = solver.snapshot().mesh.leaves.len();
            for leaf in (0..leaves).step_by((leaves / 7).max(1)) {
                let element = solver.snapshot().mesh.leaves[leaf].element;
                solver.show_solution_view(true);
                let snapshot = solver.snapshot();
                let links = snapshot.solution_view.as_ref().expect("its links").incoming(element);
                let sum: Vec3 = links.iter().map(|link| link.irradiance).sum();
                let whole = Vec3::from(snapshot.leaf_irradiance[leaf]);
                let off = (sum - whole).abs().max_element() / whole.max_element();
                assert!(off < tolerance, "{push:?}, finished {finish}: {sum} of {whole} W/m²");
                assert!(links.iter().any(|link| link.levels_up > 0 && link.receiver != element));
            }
        }
    }
}

/// Truth: pushing moves light over the links that are there; no pair is judged but those that wake
/// for the change of B.
#[test]
fn another_push_mode_only_gathers_again() {
    let deferred = |push| SolverParams { push, ..params(ClusteringMode::Groups, FINE) };
    let mut solver = solve(&lamp_room(), deferred(Push::Deferred));
    let before = solver.stats();
    change(&mut solver, deferred(Push::Immediate));
    let after = solver.stats();
    let judged = after.pairs_judged - before.pairs_judged;
    assert!(judged < before.pairs_judged / 10, "{judged} pairs of {} judged again", before.pairs_judged);
    let off = difference(&solver, &solve(&lamp_room(), deferred(Push::Immediate)));
    assert!(off < SAME, "B differs by {off}");
}

/// What cannot matter does nothing, to the bit.
#[test]
fn a_change_of_threads_changes_nothing() {
    let mut solver = solve(&lamp_room(), params(ClusteringMode::Adaptive, FINE));
    let (before, stored) = (solver.radiosity().to_vec(), links(&solver));
    change(&mut solver, SolverParams { threads: 3, ..params(ClusteringMode::Adaptive, FINE) });
    assert!(before == solver.radiosity() && stored == links(&solver));
}

/// Other clusters ask for another solver, and what is wrong is refused with the present solution
/// kept.
#[test]
fn other_clusters_and_wrong_values_leave_the_solution_alone() {
    let mut solver = solve(&lamp_room(), params(ClusteringMode::Adaptive, COARSE));
    let before = solver.radiosity().to_vec();
    assert!(solver.set_params(params(ClusteringMode::Groups, COARSE)).expect("usable parameters").is_rebuilt());
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = SolverParams { epsilon: Epsilon::Relative(wrong), ..*solver.params() };
        assert!(solver.set_params(refused).is_err(), "ε = {wrong}");
    }
    assert!(before == solver.radiosity());
}

/// Truth: linearity. Twice the emission is twice the light on the links that stay; 1e-4 is ten
/// times what the last gather leaves undone. ε in watts is doubled with it, so that no link has to
/// wake.
#[test]
fn a_lamp_twice_as_bright_doubles_the_light() {
    let with = |watts: f64| SolverParams { epsilon: Epsilon::Watts(watts), ..params(ClusteringMode::Adaptive, FINE) };
    let mut solver = solve(&lamp_room(), with(1e-3));
    let before = solver.radiosity().to_vec();
    let stored = links(&solver);
    let lamp = solver.scene().material_named("lamp").expect("a lamp");
    let emission = solver.scene().materials[lamp.0 as usize].emission;
    // A dimmed lamp wakes nothing, where a raised threshold would merge links back.
    solver.set_emission(lamp, 0.5 * emission);
    assert!(solver.run(&CancelToken::new()));
    assert!(links(&solver) == stored, "a dimmed lamp asks for no new link");
    for (now, before) in solver.radiosity().iter().zip(&before) {
        assert!(
            (2.0 * *now - *before).abs().max_element() <= 1e-4 * before.max_element().max(1e-3),
            "{now} of {before}"
        );
    }
    solver.set_emission(lamp, 2.0 * emission);
    assert!(solver.run(&CancelToken::new()));
    assert!(solver.links().len() >= stored.len());
    let fresh = {
        let mut scene = lamp_room();
        scene.materials[lamp.0 as usize].emission = 2.0 * emission;
        solve(&scene, with(1e-3))
    };
    let off = difference(&solver, &fresh);
    assert!(off < SAME, "B differs by {off}");
}

/// A lamp switched off leaves no light behind, and one switched on in the dark is as good as a
/// fresh solve.
#[test]
fn lamps_go_out_and_on() {
    let lamp = MaterialId(2);
    let mut solver = solve(&lamp_room(), params(ClusteringMode::Adaptive, FINE));
    let emission = solver.scene().materials[2].emission;
    solver.set_emission(lamp, Vec3::ZERO);
    assert!(solver.run(&CancelToken::new()));
    let most = solver.radiosity().iter().fold(0.0_f32, |most, radiosity| most.max(radiosity.max_element()));
    // The last gather leaves 1e-5 of the power, at worst of that of the lit room (20 W/m² on the
    // lamp).
    assert!(most < 1e-3, "{most} W/m² are left");

    let mut dark = lamp_room();
    dark.materials[2].emission = Vec3::ZERO;
    let mut solver = solve(&dark, params(ClusteringMode::Adaptive, FINE));
    solver.set_emission(lamp, emission);
    assert!(solver.run(&CancelToken::new()));
    let off = difference(&solver, &solve(&lamp_room(), params(ClusteringMode::Adaptive, FINE)));
    assert!(off < SAME, "B differs by {off}");
}

/// One housing with a lamp below and one above: where its cluster sends its light is measured anew
/// when the other goes on.
#[test]
fn a_second_lamp_in_a_housing_shines_its_own_way() {
    let of = |lamps: [f32; 2]| {
        let mut scene = empty_room(0.0, 0.0);
        let housing = scene.add_material("housing", Vec3::ZERO, Vec3::ZERO);
        let [below, above] = ["below", "above"]
            .map(|name| scene.add_material(name, Vec3::ZERO, Vec3::splat(lamps[usize::from(name == "above")])));
        let group = scene.add_group("lamp", GroupId(0));
        add_box(&mut scene, (Vec3::new(0.35, 0.4, 0.35), Vec3::new(0.65, 0.6, 0.65)), false, (housing, group));
        let first = scene.polygons.len() - 6;
        scene.polygons[first + 1].material = below;
        scene.polygons[first + 4].material = above;
        (scene, above)
    };
    let with = |watts: f64| SolverParams { epsilon: Epsilon::Watts(watts), ..params(ClusteringMode::Groups, FINE) };
    let (scene, above) = of([1.0, 0.0]);
    let mut solver = solve(&scene, with(0.03));
    assert!(received(&solver, 4) < 0.1 * received(&solver, 1), "the ceiling is dark");
    solver.set_emission(above, Vec3::ONE);
    assert!(solver.run(&CancelToken::new()));
    let fresh = solve(&of([1.0, 1.0]).0, with(0.03));
    println!(
        "{} and {} instead of {} and {} W",
        received(&solver, 1),
        received(&solver, 4),
        received(&fresh, 1),
        received(&fresh, 4)
    );
    for polygon in [1, 4] {
        let (now, truth) = (received(&solver, polygon), received(&fresh, polygon));
        assert!((now / truth - 1.0).abs() < 0.05, "{polygon}: {now} W instead of {truth}");
    }
}

/// Truth: a fresh solve of the repainted room. A darker wall wakes no link, a brighter one a few.
#[test]
fn a_wall_is_painted_over() {
    let with = || SolverParams { epsilon: Epsilon::Watts(2e-3), ..params(ClusteringMode::Adaptive, FINE) };
    let mut solver = solve(&lamp_room(), with());
    let stored = links(&solver);
    for (reflectance, wakes) in [(Vec3::new(0.4, 0.2, 0.1), false), (Vec3::new(0.7, 0.8, 0.9), true)] {
        let before = solver.stats();
        solver.set_reflectance(MaterialId(0), reflectance);
        assert!(solver.run(&CancelToken::new()));
        assert!(is_sound(&solver));
        assert!(wakes || links(&solver) == stored, "a darker wall asks for no new link");
        let mut painted = lamp_room();
        painted.materials[0].reflectance = reflectance;
        let fresh = solve(&painted, with());
        let judged = solver.stats().pairs_judged - before.pairs_judged;
        assert!(2 * judged < fresh.stats().pairs_judged, "{judged} pairs of {}", fresh.stats().pairs_judged);
        let off = difference(&solver, &fresh);
        println!("{reflectance}: {judged} pairs judged, B differs by {off:.4}");
        assert!(off < SAME, "{reflectance}: B differs by {off}");
    }
}

/// Truth: a fresh solve with more rays. Links are looked at again where they stand; fewer rays are
/// asked of none that has them.
#[test]
fn more_rays_look_again_at_the_links_that_are_there() {
    let with = |rays_min| SolverParams { rays_min, ..params(ClusteringMode::Adaptive, FINE) };
    let mut solver = solve(&lamp_room(), with(4));
    let before = solver.stats();
    change(&mut solver, with(16));
    let (after, fresh) = (solver.stats(), solve(&lamp_room(), with(16)));
    assert!(after.rays - before.rays > before.rays, "{} rays, then {}", before.rays, after.rays);
    assert!(after.iterations > before.iterations, "the solve went on");
    let off = difference(&solver, &fresh);
    println!("{} rays more, afresh {}; B differs by {off:.4}", after.rays - before.rays, fresh.stats().rays);
    assert!(off < 0.5 * SAME, "B differs by {off}");
    let (known, stored) = (solver.radiosity().to_vec(), links(&solver));
    change(&mut solver, with(4));
    assert!(known == solver.radiosity() && stored == links(&solver), "more rays than asked for do no harm");
}

/// Truth: a fresh solve by the other model, whose patches are the same, since the oracle does not
/// ask what clusters are.
#[test]
fn another_cluster_model_measures_the_links_of_clusters_anew() {
    let with = |cluster_model| SolverParams { cluster_model, ..params(ClusteringMode::Groups, FINE) };
    let mut solver = solve(&lamp_room(), with(ClusterModel::Isotropic));
    let before = solver.stats();
    change(&mut solver, with(ClusterModel::Oriented));
    let (after, fresh) = (solver.stats(), solve(&lamp_room(), with(ClusterModel::Oriented)));
    let judged = after.pairs_judged - before.pairs_judged;
    assert!(judged > 0 && 2 * judged < fresh.stats().pairs_judged, "{judged} of {}", fresh.stats().pairs_judged);
    let off = difference(&solver, &fresh);
    println!("{judged} pairs judged instead of {}, B differs by {off:.4}", fresh.stats().pairs_judged);
    assert!(off < SAME, "B differs by {off}");
}

/// Other clusters start with the light that is known of every polygon, and end with that of a fresh
/// solve.
#[test]
fn other_clusters_start_with_the_light_that_is_known() {
    let former = solve(&lamp_room(), params(ClusteringMode::Adaptive, FINE));
    let mut solver = former.rebuilt(params(ClusteringMode::Groups, FINE), 7).expect("usable parameters");
    assert!(difference(&solver, &former) < 1e-6, "the light of each polygon is the same");
    assert_eq!(solver.snapshot().generation, 7);
    assert!(solver.run(&CancelToken::new()));
    let fresh = solve(&lamp_room(), params(ClusteringMode::Groups, FINE));
    let off = difference(&solver, &fresh);
    let (judged, afresh) = (solver.stats().pairs_judged, fresh.stats().pairs_judged);
    println!("{judged} pairs judged, afresh {afresh}; B differs by {off:.4}");
    assert!(off < SAME, "B differs by {off}");
}
