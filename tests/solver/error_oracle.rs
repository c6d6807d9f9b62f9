//! The oracle that bounds the error of a link instead of its power.

use glam::Vec3;
use selflink::scene::{GroupId, Scene};
use selflink::solve::{ClusteringMode, Epsilon, SolverParams};
use selflink::transport::OracleKind;

use super::support::{add_box, lamp_room, links, params, radiosity_bits, solve, with_threads};

fn error_params(clustering: ClusteringMode, epsilon: f64) -> SolverParams {
    SolverParams { oracle: OracleKind::Error, ..params(clustering, epsilon) }
}

/// A quad of side `side` around `centre` in a plane of constant z, bright upwards (towards +z) or
/// downwards.
fn add_square(scene: &mut Scene, centre: Vec3, side: f32, upwards: bool, reflectance: f32, emission: f32) {
    let material = scene.add_material("square", Vec3::splat(reflectance), Vec3::splat(emission));
    let at = |x: f32, y: f32| centre + 0.5 * side * Vec3::new(x, y, 0.0);
    let mut corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    if !upwards {
        corners.reverse();
    }
    scene.add_quad(corners, material, GroupId(0));
}

/// Truth: on a wall of side 1 lit from 20 of its sides away, cosθ·cosθ'/d² varies by 4·½·(½/20)² ≈
/// 0.2 % between middle and corner. An error of a thousandth of the power does not ask for a split;
/// the power oracle, which bounds the power itself by the same ε, splits the wall, for the link
/// carries 100 times more.
#[test]
fn an_evenly_lit_wall_is_not_split() {
    let mut scene = Scene::new("wall");
    add_square(&mut scene, Vec3::ZERO, 1.0, true, 0.5, 0.0);
    add_square(&mut scene, Vec3::new(0.0, 0.0, 20.0), 1.0, false, 0.0, 1.0);
    // The lamp of 1 W lights the wall by 1/(π·400) of its power, 8e-4 W.
    for (oracle, patches) in [(OracleKind::Error, 2..=2), (OracleKind::Energy, 3..=10_000)] {
        let params =
            SolverParams { oracle, rays_min: 64, epsilon: Epsilon::Watts(1e-5), ..params(ClusteringMode::None, 1.0) };
        let found = solve(&scene, params).stats().patches;
        assert!(patches.contains(&found), "{oracle:?}: {found} patches");
    }
}

/// Truth: what a near lamp lights unevenly must be split by either oracle.
#[test]
fn an_unevenly_lit_wall_is_split() {
    let mut scene = Scene::new("near");
    add_square(&mut scene, Vec3::ZERO, 4.0, true, 0.5, 0.0);
    add_square(&mut scene, Vec3::new(0.0, 0.0, 0.5), 0.2, false, 0.0, 1.0);
    let found = solve(&scene, error_params(ClusteringMode::None, 1e-2)).stats().patches;
    assert!(found >= 16, "{found} patches");
}

/// Truth: between two small patches that face each other from afar each direction is one link, F =
/// A/(πd²), the kernel being constant to 1e-4 over ends of a hundredth of their distance.
#[test]
fn two_small_patches_far_apart_get_two_links() {
    let mut scene = Scene::new("two");
    add_square(&mut scene, Vec3::ZERO, 0.1, true, 0.5, 1.0);
    add_square(&mut scene, Vec3::new(0.0, 0.0, 10.0), 0.1, false, 0.5, 1.0);
    let solver = solve(&scene, error_params(ClusteringMode::None, 1e-6));
    assert_eq!(solver.links().len(), 2);
    let expected = 0.01 / (std::f32::consts::PI * 100.0);
    for link in solver.links().all() {
        assert!((link.form_factor / expected - 1.0).abs() < 1e-3, "F {} for {expected}", link.form_factor);
    }
}

/// Truth: no light enters a sealed room, so nothing in it is worth a split, however fine ε is for
/// the lit room beside it.
#[test]
fn a_sealed_dark_room_beside_a_lit_one_is_not_split() {
    let mut scene = Scene::new("rooms");
    let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::ONE);
    add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (wall, GroupId(0)));
    // Its faces look at the lit room's: only the walls between stop light.
    let dark = scene.polygons.len() as u32;
    add_box(&mut scene, (Vec3::new(1.02, 0.0, 0.0), Vec3::new(2.02, 1.0, 1.0)), true, (wall, GroupId(0)));
    let end = scene.polygons.len() as u32;
    let at = |x: f32, z: f32| Vec3::new(x, 0.99, z);
    scene.add_quad([at(0.4, 0.4), at(0.6, 0.4), at(0.6, 0.6), at(0.4, 0.6)], lamp, GroupId(0));
    for mode in [ClusteringMode::None, ClusteringMode::Adaptive] {
        let mut solver = solve(&scene, error_params(mode, 1e-3));
        let leaves = solver.snapshot().mesh.leaves.clone();
        let in_dark = leaves.iter().filter(|leaf| (dark..end).contains(&leaf.polygon)).count();
        assert!(leaves.len() > 100, "{mode:?}: the lit room is split");
        assert_eq!(in_dark, 6, "{mode:?}: leaves in the dark room");
    }
}

/// Truth: a solve is the same, bit for bit, for any number of threads.
#[test]
fn threads_do_not_matter() {
    let scene = lamp_room();
    let of = |threads| {
        with_threads(threads, || {
            let solver = solve(&scene, error_params(ClusteringMode::Adaptive, 1e-3));
            (radiosity_bits(&solver), links(&solver), solver.stats().rays)
        })
    };
    let one = of(1);
    assert!(of(2) == one && of(8) == one);
}
