//! What must not change a solution: threads, onlookers, interruptions, units, the order of colours;
//! and scenes with nothing to solve.

use glam::Vec3;
use selflink::base::cancel::CancelToken;
use selflink::hierarchy::ClusteringMode;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::outside::Daylight;
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
    /// Irradiance of the final gather's leaves, where there is one.
    gathered: Vec<[u32; 3]>,
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
            gathered: solver.field().map_or_else(Vec::new, |field| {
                field.irradiance().iter().map(|light| light.to_array().map(f32::to_bits)).collect()
            }),
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
    assert!(found == expected, "{what}: radiosities, links or gathered light differ in their bits");
}

/// Truth: the guarantee that a fresh solve is the same, bit for bit, for any number of threads:
/// with clusters of each kind, in a scene of many chunks of work, and gathered, by lamps and by
/// daylight.
#[test]
fn threads_do_not_matter() {
    let gathered = SolverParams { error: Some(0.1), ..SolverParams::default() };
    let modes = MODES.map(|mode| [Push::Immediate, Push::Deferred].map(|push| (mode, push)));
    let by_links = modes.concat().into_iter().map(|(mode, push)| SolverParams { push, ..params(mode, 1e-3) });
    let mut cases: Vec<(Scene, SolverParams)> = by_links.map(|params| (lamp_room(), params)).collect();
    cases.push((BuiltinScene::Office.build(), params(ClusteringMode::Adaptive, 3e-3)));
    cases.push((lamp_room(), gathered));
    cases.push((daylit_room(), gathered));
    for (scene, params) in cases {
        let solution = |threads| with_threads(threads, || Solution::of(&solve(&scene, params)));
        assert_same(&solution(8), &solution(1), &format!("{}, {params:?}, 8 threads", scene.name));
    }
}

/// The room without its ceiling, under a clear sky.
fn daylit_room() -> Scene {
    let mut scene = lamp_room();
    let ceiling = scene.polygons.iter().position(|polygon| scene.normal(polygon).y < -0.5).expect("a ceiling");
    scene.polygons.remove(ceiling);
    let (sky, sun) = ("clear:100W".parse().expect("a sky"), "az:180,el:35,300W".parse().expect("a sun"));
    scene.add_daylight(&Daylight { sky: Some(sky), sun: Some(sun) }).expect("daylight");
    scene
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

/// Rays and tested pairs between two looks at the token: some milliseconds of one core.
const MOST_WORK: u64 = 4_000;

/// Truth: counts. Whoever cancels waits for what is done between two looks at the token, which all
/// steps take often, in the mean of each: judging a thousand polygons' links, gathering over them,
/// and gathering at leaves.
#[test]
fn steps_look_at_their_token_often() {
    let asked = SolverParams { error: Some(0.1), ..SolverParams::default() };
    with_threads(1, || {
        let mut solving = solver(&BuiltinScene::Office.build(), asked);
        let (mut counted, mut looks) = (0, 0);
        loop {
            let token = CancelToken::at_look(u64::MAX);
            let step = solving.step(&token);
            let stats = solving.stats();
            let work = stats.rays + stats.pairs_judged - counted;
            looks += token.looks();
            assert!(work <= MOST_WORK * looks, "{step:?}: {work} rays and pairs in {looks} looks");
            let ends = match step {
                Step::Finished => break,
                Step::Gathered => {
                    assert!(stats.links as u64 <= MOST_WORK * looks, "{} links in {looks} looks", stats.links);
                    true
                }
                Step::Interrupted => panic!("nobody cancels"),
                Step::Refined { .. } => true,
                // Some steps on, the rays of a certificate are counted all at once.
                Step::Reconstructed { pass_ended } => pass_ended,
            };
            counted += work;
            if work > 0 || ends {
                looks = 0;
            }
        }
    });
}

fn scaled(scene: &Scene, length: f32, emission: f32) -> Scene {
    let mut scaled = scene.clone();
    scaled.vertices.iter_mut().for_each(|vertex| *vertex *= length);
    scaled.materials.iter_mut().for_each(|material| material.emission *= emission);
    scaled
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
