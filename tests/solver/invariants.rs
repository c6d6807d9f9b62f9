//! What must not change a solution: threads, onlookers, interruptions, units, the order of colours;
//! and scenes with nothing to solve.

use glam::Vec3;
use selflink::base::cancel::CancelToken;
use selflink::hierarchy::ClusteringMode;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{GroupId, Scene};
use selflink::solve::{Solver, SolverParams, Step};
use selflink::transport::{Link, Push};

use super::support::{
    LinkBits, MODES, difference, furnished_room, is_sound, lamp_room, links, params, radiosity_bits, solve, solver,
    with_threads,
};

/// All that a solution says, bit for bit.
#[derive(PartialEq)]
struct Solution {
    radiosity: Vec<[u32; 3]>,
    links: Vec<LinkBits>,
    patches: usize,
    rays: u64,
    pairs_judged: u64,
}

impl Solution {
    fn of(solver: &Solver) -> Self {
        let stats = solver.stats();
        Self {
            radiosity: radiosity_bits(solver),
            links: links(solver),
            patches: stats.patches,
            rays: stats.rays,
            pairs_judged: stats.pairs_judged,
        }
    }
}

fn assert_same(found: &Solution, expected: &Solution, what: &str) {
    assert_eq!(found.patches, expected.patches, "{what}: patches");
    assert_eq!(found.links.len(), expected.links.len(), "{what}: links");
    assert_eq!((found.pairs_judged, found.rays), (expected.pairs_judged, expected.rays), "{what}: pairs and rays");
    assert!(found == expected, "{what}: radiosities or links differ in their bits");
}

/// Truth: the promise that a fresh solve is the same, bit for bit, for any number of threads.
#[test]
fn threads_do_not_matter() {
    let scene = lamp_room();
    for push in [Push::Immediate, Push::Deferred] {
        for mode in MODES {
            let params = SolverParams { push, ..params(mode, 1e-3) };
            let one = with_threads(1, || Solution::of(&solve(&scene, params)));
            for threads in [2, 8] {
                let many = with_threads(threads, || Solution::of(&solve(&scene, params)));
                assert_same(&many, &one, &format!("{mode:?}, {push:?}, {threads} threads"));
            }
        }
    }
}

/// The same for a scene of many chunks of work.
#[test]
fn threads_do_not_matter_in_the_office() {
    let scene = BuiltinScene::Office.build();
    let solution =
        |threads| with_threads(threads, || Solution::of(&solve(&scene, params(ClusteringMode::Adaptive, 3e-3))));
    let one = solution(1);
    assert_same(&solution(8), &one, "8 threads");
}

/// Truth: a solve is the same whether or not a window watches.
#[test]
fn onlookers_do_not_matter() {
    let scene = lamp_room();
    for mode in MODES {
        let unseen = Solution::of(&solve(&scene, params(mode, 1e-3)));
        let mut watched = solver(&scene, params(mode, 1e-3));
        let never = CancelToken::new();
        let mut pictures = 0;
        let mut step = 0;
        watched.keep_timeline();
        loop {
            let snapshot = watched.snapshot();
            pictures += 1;
            assert!(snapshot.vertex_radiosity.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
            watched.show_solution_view(pictures % 3 == 0);
            step = (step + 7) % watched.kept_steps().len();
            let former = watched.snapshot_of(step).expect("a step that is kept");
            assert_eq!(former.former_step, Some(step));
            if watched.step(&never) == Step::Finished {
                break;
            }
        }
        assert!(pictures > 3);
        assert_same(&Solution::of(&watched), &unseen, &format!("{mode:?}, watched"));
    }
}

/// Truth: an interrupted step can be taken again, with the same result, wherever in it the
/// interruption struck.
#[test]
fn interruptions_do_not_matter() {
    let scene = lamp_room();
    for mode in MODES {
        let whole = Solution::of(&solve(&scene, params(mode, 1e-3)));
        let mut interrupted = solver(&scene, params(mode, 1e-3));
        let (mut struck, mut steps, mut look) = (0, 0_u64, 1);
        loop {
            steps += 1;
            // Later in the same step each time, until it gets done.
            match interrupted.step(&CancelToken::at_look(look)) {
                Step::Finished => break,
                Step::Interrupted => {
                    struck += 1;
                    look *= 2;
                }
                Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => look = 1,
            }
        }
        println!("{mode:?}: {struck} of {steps} steps interrupted");
        assert!(struck > 0, "no step was interrupted");
        assert_same(&Solution::of(&interrupted), &whole, &format!("{mode:?}, interrupted"));
    }
}

fn scaled(scene: &Scene, length: f32, emission: f32) -> Scene {
    let mut scaled = scene.clone();
    scaled.vertices.iter_mut().for_each(|vertex| *vertex *= length);
    scaled.materials.iter_mut().for_each(|material| material.emission *= emission);
    scaled
}

/// Truth: a relative ε knows no units. Powers of two only change exponents: the same links, and B
/// in proportion to the bit.
#[test]
fn powers_of_two_in_lengths_and_emission_change_nothing() {
    for scene in [lamp_room(), BuiltinScene::Cornell.build()] {
        for mode in MODES {
            let plain = solve(&scene, params(mode, 1e-3));
            for (length, emission) in [(2.0, 1.0), (1024.0, 1.0), (0.5, 1.0), (1.0, 4.0), (2.0, 0.25)] {
                let other = solve(&scaled(&scene, length, emission), params(mode, 1e-3));
                let what = format!("{} in {mode:?}, lengths × {length}, emission × {emission}", scene.name);
                assert_eq!(links(&plain).len(), links(&other).len(), "{what}: links");
                assert!(links(&plain) == links(&other), "{what}: links differ in their bits");
                let in_proportion: Vec<Vec3> =
                    plain.radiosity().iter().map(|radiosity| emission * *radiosity).collect();
                assert!(in_proportion == other.radiosity(), "{what}: radiosities differ in their bits");
            }
        }
    }
}

/// Other factors round: 0.1 % of the links, and a B that is the same within the error that such
/// links may carry, 1 %.
#[test]
#[ignore = "misses its mark: up to 1.4 % of the links, and B by 2.6 %, in the furnished rooms; see README, Where it fails"]
fn other_units_change_next_to_nothing() {
    let mut wrong = Vec::new();
    for scene in [BuiltinScene::Office.build(), BuiltinScene::Seminar { polygons: 2008 }.build(), lamp_room()] {
        let plain = solve(&scene, params(ClusteringMode::Adaptive, 1e-3));
        for factor in [0.1, 10.0] {
            let other = solve(&scaled(&scene, factor, 1.0), params(ClusteringMode::Adaptive, 1e-3));
            let (count, expected) = (other.links().len() as f64, plain.links().len() as f64);
            let off = difference(&other, &plain);
            let what =
                format!("{} × {factor}: {count} links instead of {expected}, B differs by {off:.1e}", scene.name);
            println!("{what}");
            if (count / expected - 1.0).abs() > 1e-3 || off > 0.01 {
                wrong.push(what);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Scenes in millimetres and in thousands of kilometres end and have no NaN; they have the light of
/// the same scene in metres.
#[test]
fn extreme_units_end() {
    let plain = solve(&lamp_room(), params(ClusteringMode::Adaptive, 1e-3));
    for factor in [1e-3, 1e6] {
        for mode in MODES {
            let solved = solve(&scaled(&lamp_room(), factor, 1.0), params(mode, 1e-3));
            assert!(is_sound(&solved), "{mode:?} × {factor}");
            assert_eq!(solved.stats().depth_guard_struck, 0, "{mode:?} × {factor}");
            if mode == ClusteringMode::Adaptive {
                let off = difference(&solved, &plain);
                assert!(off < 0.01, "× {factor}: B differs by {off}");
            }
        }
    }
}

/// Truth: no colour is special. The oracle looks at the largest, so a permutation of colours
/// permutes the answer, to the bit.
#[test]
fn permuted_colours_permute_the_answer() {
    let permute = |colour: Vec3| Vec3::new(colour.z, colour.x, colour.y);
    let mut permuted = lamp_room();
    for material in &mut permuted.materials {
        material.reflectance = permute(material.reflectance);
        material.emission = permute(material.emission);
    }
    for mode in MODES {
        let (plain, other) = (solve(&lamp_room(), params(mode, 1e-3)), solve(&permuted, params(mode, 1e-3)));
        assert!(links(&plain) == links(&other), "{mode:?}: links");
        let expected: Vec<Vec3> = plain.radiosity().iter().map(|radiosity| permute(*radiosity)).collect();
        assert!(expected == other.radiosity(), "{mode:?}: radiosities");
    }
}

/// Truth: darkness. The root's self-link is good enough for no light, and nobody looks.
#[test]
fn without_light_there_is_one_link_and_no_ray() {
    for mode in MODES {
        let solved = solve(&furnished_room(0.5, 0.0), params(mode, 1e-4));
        let stats = solved.stats();
        assert_eq!((stats.links, stats.rays), (1, 0), "{mode:?}");
        assert!(solved.radiosity().iter().all(|radiosity| *radiosity == Vec3::ZERO));
    }
}

/// An empty scene, one polygon, two that turn their backs: there is nothing to exchange.
#[test]
fn scenes_with_nothing_to_exchange_end_at_once() {
    let square = |scene: &mut Scene, z: f32, up: bool| {
        let mut corners = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y].map(|corner| corner + z * Vec3::Z);
        if !up {
            corners.reverse();
        }
        if scene.materials.is_empty() {
            scene.add_material("lamp", Vec3::splat(0.5), Vec3::ONE);
        }
        scene.add_quad(corners, selflink::scene::MaterialId(0), GroupId(0));
    };
    let mut one = Scene::new("one square");
    square(&mut one, 0.0, true);
    let mut backs = Scene::new("back to back");
    square(&mut backs, 0.0, false);
    square(&mut backs, 1.0, true);
    for (scene, squares) in [(Scene::new("empty"), 0), (one, 1), (backs, 2)] {
        for mode in MODES {
            let mut solved = solve(&scene, params(mode, 1e-4));
            assert!(
                solved.irradiance().iter().all(|irradiance| *irradiance == Vec3::ZERO),
                "{} in {mode:?}",
                scene.name
            );
            assert!(solved.radiosity()[1..].iter().all(|radiosity| *radiosity == Vec3::ONE));
            let snapshot = solved.snapshot();
            assert_eq!((snapshot.mesh.leaves.len(), snapshot.mesh.triangles.len()), (squares, 2 * squares));
            assert!(snapshot.vertex_radiosity.iter().flatten().all(|&value| value == 1.0));
        }
    }
}

/// Truth: the paper's 16 bytes per link.
#[test]
fn a_link_takes_16_bytes_or_fewer() {
    assert!(size_of::<Link>() <= 16);
    let solved = solve(&lamp_room(), params(ClusteringMode::Adaptive, 1e-2));
    let stats = solved.stats();
    assert!(stats.bytes.links <= 16 * stats.links);
}
