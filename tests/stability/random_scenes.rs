//! Random scenes against what must hold for any scene and any settings.
//!
//! Truth: invariants. The iteration ends; B is finite, not negative and at most max B_e/(1−ρ_max);
//! all power is at most Φ/(1−ρ_max); each ordered pair of initial patches is covered once; a fresh
//! solve is the same bit for bit for any number of threads; and with small ε the solver finds what
//! a brute-force matrix of all pairs does.
//!
//! `cargo test` tries a few hundred scenes of a fixed seed, more by `SELFLINK_RANDOM_SCENES=10000`.

use std::sync::Arc;

use glam::Vec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};
use selflink::base::cancel::CancelToken;
use selflink::geometry::Occluders;
use selflink::geometry::cuts;
use selflink::hierarchy::ClusteringMode;
use selflink::measure::stability::matrix::{self, Fineness};
use selflink::measure::stability::measure::{is_sound, of_polygons};
use selflink::measure::stability::scenes::add_box;
use selflink::scene::{GroupId, MaterialId, Scene};
use selflink::solve::{Epsilon, Solver, SolverParams, Step, power_balance};
use selflink::transport::{ClusterModel, Push};

use super::coverage::check_coverage;

/// Scenes tried where nobody asks for more.
const USUAL_SCENES: u32 = 200;
/// Of these one in so many is also solved by the matrix, which takes longer.
const SCENES_PER_MATRIX: u32 = 25;
/// Share of the reflected light that the solver and the matrix may place otherwise.
const MATRIX_SHARE: f64 = 0.03;
/// Steps that no scene of this size needs.
const MOST_STEPS: u32 = 100_000;
/// Scenes of up to so many polygons are looked at pair by pair.
const MOST_COVERED: usize = 70;

fn scenes() -> u32 {
    std::env::var("SELFLINK_RANDOM_SCENES").ok().and_then(|text| text.parse().ok()).unwrap_or(USUAL_SCENES)
}

/// Tries a property on so many scenes of a fixed seed; names the first that fails, made as small as
/// it gets.
pub fn try_on<S: Strategy>(
    seed: &[u8; 32],
    cases: u32,
    scenes: &S,
    holds: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 500, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, seed));
    if let Err(error) = runner.run(scenes, holds) {
        panic!("{error}");
    }
}

/// What a scene is made of.
#[derive(Clone, Debug)]
struct Recipe {
    /// Lower corner, size, whether it is a room, which material.
    boxes: Vec<(Vec3, Vec3, bool, u8)>,
    /// Corner, two sides, which material.
    triangles: Vec<(Vec3, Vec3, Vec3, u8)>,
    /// Small square lamps in a grid.
    small_lamps: u16,
    /// Some triangles lose their area: 0 none, 1 two corners alike, 2 all corners in line, 3 a
    /// needle.
    degenerate: u8,
    /// Reflectances of the three materials.
    reflectances: [f32; 3],
    /// Emissions of the three materials; the third is the lamp's.
    emissions: [f32; 3],
    /// Lengths are multiplied by ten to this power.
    exponent: i32,
    /// Everything is moved by this many times its size.
    shift: f32,
}

impl Recipe {
    fn scene(&self) -> Scene {
        let mut scene = Scene::new("random");
        let colours = [Vec3::new(1.0, 0.8, 0.3), Vec3::new(0.5, 1.0, 0.9), Vec3::ONE];
        for index in 0..3 {
            let (reflectance, emission) = (self.reflectances[index], self.emissions[index]);
            scene.add_material(&format!("m{index}"), reflectance * colours[index], emission * colours[2 - index]);
        }
        let material = |number: u8| MaterialId(u32::from(number % 3));
        for &(lower, size, is_room, number) in &self.boxes {
            let group = scene.add_group("box", GroupId(0));
            add_box(&mut scene, (lower, lower + size), is_room, (material(number), group));
        }
        for (index, &(corner, mut one, mut other, number)) in self.triangles.iter().enumerate() {
            if index % 3 == 0 {
                match self.degenerate {
                    1 => other = Vec3::ZERO,
                    2 => other = 0.5 * one,
                    3 => other = one + 1e-5 * other,
                    _ => {}
                }
            }
            if index % 4 == 1 {
                one.z = 0.0;
                other.z = 0.0;
            }
            scene.add_triangle([corner, corner + one, corner + other], material(number), GroupId(0));
        }
        let lamps = scene.add_group("lamps", GroupId(0));
        for index in 0..self.small_lamps {
            let corner = Vec3::new(f32::from(index % 50), f32::from(index / 50), 60.0) / 20.0;
            let corners = [Vec3::ZERO, Vec3::Y, Vec3::X + Vec3::Y, Vec3::X].map(|offset| corner + 0.01 * offset);
            scene.add_quad(corners, MaterialId(2), lamps);
        }
        let scale = 10.0_f32.powi(self.exponent);
        scene.vertices.iter_mut().for_each(|vertex| *vertex = scale * (*vertex + self.shift));
        scene
    }
}

fn recipes() -> impl Strategy<Value = Recipe> {
    let point = || prop::array::uniform3(-2.0_f32..2.0).prop_map(Vec3::from);
    let size = prop::array::uniform3(0.01_f32..1.5).prop_map(Vec3::from);
    let side = || prop::array::uniform3(-0.8_f32..0.8).prop_map(Vec3::from);
    let boxes = prop::collection::vec((point(), size, any::<bool>(), 0_u8..3), 0..4);
    // Often none and one: scenes of no polygon and of one.
    let triangles = prop_oneof![
        1 => prop::collection::vec((point(), side(), side(), 0_u8..3), 0..2),
        4 => prop::collection::vec((point(), side(), side(), 0_u8..3), 2..24),
    ];
    let boxes = prop_oneof![1 => Just(Vec::new()), 3 => boxes];
    let small_lamps = prop_oneof![40 => Just(0_u16), 6 => 1_u16..20, 1 => 1000_u16..2500];
    let reflectance = || prop_oneof![1 => Just(0.0_f32), 6 => 0.0_f32..0.9, 2 => 0.9_f32..0.99];
    let emission = || prop_oneof![3 => Just(0.0_f32), 2 => 0.0_f32..10.0, 1 => 1e3_f32..1e6];
    let lengths = (prop_oneof![3 => Just(0), 1 => -5_i32..7], prop_oneof![3 => Just(0.0_f32), 1 => -50.0_f32..50.0]);
    let light = (prop::array::uniform3(reflectance()), prop::array::uniform3(emission()));
    (boxes, triangles, small_lamps, 0_u8..5, light, lengths).prop_map(
        |(boxes, triangles, small_lamps, degenerate, (reflectances, emissions), (exponent, shift))| Recipe {
            boxes,
            triangles,
            small_lamps,
            degenerate,
            reflectances,
            emissions,
            exponent,
            shift,
        },
    )
}

fn settings() -> impl Strategy<Value = SolverParams> {
    let mode = prop_oneof![
        Just(ClusteringMode::None),
        Just(ClusteringMode::Octree),
        Just(ClusteringMode::Groups),
        Just(ClusteringMode::Adaptive)
    ];
    let epsilon = prop_oneof![Just(1.0), Just(0.1), Just(1e-2), Just(3e-3)];
    (mode, epsilon, any::<bool>(), any::<bool>(), any::<u32>(), 1_u32..8).prop_map(
        |(clustering, epsilon, deferred, isotropic, seed, octree_depth)| SolverParams {
            clustering,
            epsilon: Epsilon::Relative(epsilon),
            push: if deferred { Push::Deferred } else { Push::Immediate },
            cluster_model: if isotropic { ClusterModel::Isotropic } else { ClusterModel::Oriented },
            seed: u64::from(seed),
            octree_depth,
            ..SolverParams::default()
        },
    )
}

/// Solves within a number of steps that is far more than enough.
pub fn solve(scene: &Arc<Scene>, occluders: &Arc<Occluders>, params: SolverParams) -> Result<Solver, TestCaseError> {
    let mut solver = Solver::new(scene.clone(), occluders.clone(), params, 0)
        .map_err(|error| TestCaseError::fail(format!("it does not start: {error}")))?;
    solver.record_rejected();
    let never = CancelToken::new();
    for _ in 0..MOST_STEPS {
        if solver.step(&never) == Step::Finished {
            return Ok(solver);
        }
    }
    Err(TestCaseError::fail(format!("it does not end: {:?}", solver.stats())))
}

fn holds((recipe, params): (Recipe, SolverParams)) -> Result<(), TestCaseError> {
    let mut params = params;
    if recipe.small_lamps > 100 && params.clustering == ClusteringMode::None {
        // Millions of pairs.
        params.clustering = ClusteringMode::Adaptive;
    }
    let mut scene = recipe.scene();
    let area = |scene: &Scene| scene.polygons.iter().map(|polygon| f64::from(scene.area(polygon))).sum::<f64>();
    let whole = area(&scene);
    cuts::cut(&mut scene, false);
    // Corners are rounded to f32, in scenes that may lie fifty times their size away.
    let rounding = 1e-3 * whole;
    prop_assert!((area(&scene) - whole).abs() <= rounding, "{} m² of {whole} m² are left by cuts", area(&scene));
    let scene = Arc::new(scene);
    let occluders = Arc::new(Occluders::new(&scene));
    let mut solved = solve(&scene, &occluders, params)?;
    prop_assert!(is_sound(&solved), "a radiosity is negative or no number");
    // f32 rounds in the last place of a product and a sum; means over clusters sum up thousands.
    let bound = solved.link_solution().radiosity_bound();
    for (element, radiosity) in solved.hierarchy().elements().iter().zip(solved.radiosity()) {
        let rounding = if element.is_cluster() { 1e-4 } else { 1e-6 };
        prop_assert!(radiosity.cmple((1.0 + rounding) * bound).all(), "B = {radiosity} exceeds {bound}");
    }
    let power: f64 = of_polygons(&solved).iter().map(|(area, radiosity)| area * radiosity.max_element()).sum();
    let gain = solved.link_solution().largest_gain().max_element();
    let most = f64::from(scene.emitted_power().max_element() * gain);
    prop_assert!(power <= 3.0 * (1.0 + 1e-4) * most, "{power} W in all where {most} W a colour are the most");
    let snapshot = solved.snapshot();
    let shown = snapshot.vertex_radiosity.iter().flatten().chain(snapshot.leaf_irradiance.iter().flatten());
    prop_assert!(shown.into_iter().all(|value| value.is_finite() && *value >= 0.0), "what is shown is no light");
    let balance = power_balance(&solved, 256, 1);
    prop_assert!(balance.relative_gap().is_finite(), "the balance is no number: {balance:?}");
    if scene.polygons.len() <= MOST_COVERED {
        check_coverage(&solved, "random scene");
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads are left");
    let again = pool.install(|| solve(&scene, &occluders, params))?;
    prop_assert!(solved.radiosity() == again.radiosity(), "three threads find other radiosities");
    prop_assert_eq!(solved.links().len(), again.links().len(), "three threads find other links");
    Ok(())
}

#[test]
fn whatever_the_scene_light_ends_bounded_and_every_pair_is_covered() {
    try_on(b"selflink: any scene, any setting", scenes(), &(recipes(), settings()), holds);
}

/// Convex boxes and single triangles that do not touch, in a room or in the open, up to 60
/// polygons.
fn tidy_scenes() -> impl Strategy<Value = Scene> {
    let places = prop::collection::vec((0_u32..27, 0.2_f32..0.7, any::<bool>(), 0_u32..3), 2..9);
    (places, any::<bool>(), 0.1_f32..0.8).prop_map(|(places, in_room, reflectance)| {
        let mut scene = Scene::new("tidy");
        let grey = scene.add_material("grey", Vec3::splat(reflectance), Vec3::ZERO);
        let lamp = scene.add_material("lamp", Vec3::splat(0.5), Vec3::ONE);
        let mut taken = Vec::new();
        for (place, size, is_box, material) in places {
            if taken.contains(&place) || scene.polygons.len() > 48 {
                continue;
            }
            taken.push(place);
            let lower = Vec3::new((place % 3) as f32, (place / 3 % 3) as f32, (place / 9) as f32);
            let of = if taken.len() == 1 || material == 0 { lamp } else { grey };
            let group = scene.add_group("thing", GroupId(0));
            if is_box {
                add_box(&mut scene, (lower + 0.1, lower + 0.1 + size), false, (of, group));
            } else {
                let corners = [Vec3::ZERO, Vec3::new(size, 0.3, 0.0), Vec3::new(0.1, size, size)];
                scene.add_triangle(corners.map(|corner| lower + 0.1 + corner), of, group);
            }
        }
        if in_room {
            add_box(&mut scene, (Vec3::splat(-0.5), Vec3::splat(3.5)), true, (grey, GroupId(0)));
        }
        scene
    })
}

/// Walls in parts of half a metre; their irradiance by a lamp as near must not hang on where few
/// points lie.
const FINENESS: Fineness = Fineness { largest_part: 0.3, points: 4, looks: 4 };
/// ε of the solver where it is compared with the matrix, as a share of Φ.
const SMALL_EPSILON: f64 = 3e-5;

/// What is used where that one and the solver disagree: four points of a triangle that light grazes
/// may tell a fifth too much.
const FINER: Fineness = Fineness { largest_part: 0.03, points: 8, looks: 4 };

/// The matrix itself is good to some per cent, and is made finer before it is believed against the
/// solver. What is absorbed or reflected beyond that may be wrong by ε for each polygon, which
/// matters where lamps light next to nothing.
#[test]
fn with_a_small_epsilon_the_solver_finds_what_the_matrix_does() {
    let worst = std::cell::Cell::new(0.0_f64);
    let agrees = |(scene, params): (Scene, SolverParams)| {
        let occluders = Arc::new(Occluders::new(&scene));
        let scene = Arc::new(scene);
        let SolverParams { clustering, seed, .. } = params;
        let epsilon = Epsilon::Relative(SMALL_EPSILON);
        let solved = solve(&scene, &occluders, SolverParams { clustering, seed, epsilon, ..SolverParams::default() })?;
        // What polygons emit is the same in both: light that they reflect is compared, polygon by
        // polygon.
        let compare = |fineness: Fineness| {
            let truth = matrix::radiosities(&scene, &occluders, fineness);
            let (mut differing, mut reflected) = (0.0, 0.0);
            for (polygon, ((area, radiosity), truth)) in of_polygons(&solved).into_iter().zip(truth).enumerate() {
                let emission = scene.materials[scene.polygons[polygon].material.0 as usize].emission.x;
                differing += area * (radiosity.x - truth.x).abs();
                reflected += area * (truth.x - f64::from(emission));
            }
            (differing, reflected)
        };
        let allowed = scene.polygons.len() as f64 * SMALL_EPSILON * f64::from(scene.emitted_power().x);
        let agree = |(differing, reflected): (f64, f64)| differing <= MATRIX_SHARE * reflected + allowed;
        let found = compare(FINENESS);
        let (differing, reflected) = if agree(found) { found } else { compare(FINER) };
        if reflected > 100.0 * allowed {
            worst.set(worst.get().max(differing / reflected));
        }
        prop_assert!(
            agree((differing, reflected)),
            "{} polygons: of {reflected} W reflected {differing} W differ ({allowed} W may)",
            scene.polygons.len()
        );
        Ok(())
    };
    let cases = (scenes() / SCENES_PER_MATRIX).max(1);
    try_on(b"selflink: as by a whole matrix!!", cases, &(tidy_scenes(), settings()), agrees);
    println!("{cases} scenes: where there is light to reflect, up to {:.1} % of it differs", 100.0 * worst.get());
}
