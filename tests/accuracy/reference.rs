//! Properties of the reference beside its values.

use glam::{DVec3, Vec3};
use selflink::base::cancel::CancelToken;
use selflink::geometry::orient;
use selflink::measure::accuracy::cases;
use selflink::measure::reference::{Cache, ReferenceRun, SurfacePoint, Target, compute, random_points};
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Scene, Sides};

fn run_of(scene: Scene, sides: Sides, points: usize, seed: u64) -> ReferenceRun {
    let (scene, _) = orient::apply(scene, sides);
    let points = random_points(&scene, points, seed);
    ReferenceRun::new(&scene, points.into(), seed)
}

fn run(points: usize, seed: u64) -> ReferenceRun {
    run_of(BuiltinScene::Cornell.build(), Sides::Front, points, seed)
}

fn passes(mut run: ReferenceRun, count: u32) -> ReferenceRun {
    for _ in 0..count {
        assert!(run.pass(&CancelToken::new()), "nobody cancels");
    }
    run
}

/// Every value and error, bit for bit.
fn bits(run: &ReferenceRun) -> Vec<u64> {
    let reference = run.reference();
    let values = reference.irradiance.iter().chain(&reference.standard_error);
    values.flat_map(|value| value.to_array().map(f64::to_bits)).collect()
}

/// Beyond the pilot, so that points get different numbers of paths.
const PASSES: u32 = 70;

#[test]
fn the_same_for_any_number_of_threads() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are left");
        pool.install(|| bits(&passes(run(20, 1), PASSES)))
    };
    assert_eq!(with(1), with(3));
    assert_ne!(bits(&passes(run(20, 2), PASSES)), with(1), "another seed is another reference");
}

/// Truth: standard errors tell how far two independent references are apart; 100 points of three
/// colours lie within two to four of them in all but few cases, and their squares sum to about one
/// each.
#[test]
fn standard_errors_tell_the_error() {
    let (scene, _) = orient::apply(BuiltinScene::Cornell.build(), Sides::Front);
    let points = random_points(&scene, 100, 1);
    let of = |seed| passes(ReferenceRun::new(&scene, points.clone().into(), seed), 32).reference();
    let (one, other) = (of(1), of(2));
    let mut squares = Vec::new();
    for index in 0..points.len() {
        let error = (one.standard_error[index].powf(2.0) + other.standard_error[index].powf(2.0)).map(f64::sqrt);
        let off = (one.irradiance[index] - other.irradiance[index]) / error;
        squares.extend(off.to_array().into_iter().filter(|off| off.is_finite()).map(|off| off * off));
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    assert!(squares.len() > 200 && (0.6..1.7).contains(&mean), "{} values, mean square {mean}", squares.len());
}

/// Truth: a closed room is lit inside alike, whether its faces are bright there as they are wound
/// or because both of their sides are; wound outwards and bright on that side only, its inside is
/// dark.
#[test]
fn backs_absorb_and_doubled_faces_do_not() {
    let room = cases::all().into_iter().find(|case| case.name == "cube, ρ = 0.8").expect("one of the cases").scene;
    let mut inside_out = room.clone();
    for polygon in &mut inside_out.polygons {
        *polygon = polygon.flipped();
    }
    let mean_inside = |scene: &Scene, sides| {
        let reference = passes(run_of(scene.clone(), sides, 400, 1), 16).reference();
        let points = reference.points.iter().zip(&reference.irradiance);
        let seen = points.filter(|(point, _)| (Vec3::splat(0.5) - point.position).dot(point.normal) > 0.0);
        let add = |(count, weight, sum): (u32, f64, f64), (point, value): (&SurfacePoint, &DVec3)| {
            (count + 1, weight + f64::from(point.weight), sum + f64::from(point.weight) * value.x)
        };
        let (count, weight, sum) = seen.fold((0, 0.0, 0.0), add);
        (count, if count > 0 { sum / weight } else { 0.0 })
    };
    let (_, front) = mean_inside(&room, Sides::Front);
    assert_eq!(mean_inside(&inside_out, Sides::Front).0, 0, "every bright side looks outwards");
    let outside = passes(run_of(inside_out.clone(), Sides::Front, 400, 1), 8).reference();
    assert!(outside.irradiance.iter().all(|value| value.length() == 0.0), "nothing is outside to send light back");
    for scene in [&room, &inside_out] {
        let (count, doubled) = mean_inside(scene, Sides::Both);
        assert!(count > 150 && (doubled / front - 1.0).abs() < 0.03, "{doubled} instead of {front}");
    }
}

/// A look is due at every point, which takes far less than 50 ms; after the look that says so no
/// thread begins another point.
#[test]
fn cancelling_stops_a_pass_at_the_next_point_and_leaves_the_run_as_it_was() {
    const POINTS: u64 = 2000;
    let run = || passes(run_of(BuiltinScene::Office.build(), Sides::Front, POINTS as usize, 1), 0);
    let whole = CancelToken::at_look(u64::MAX);
    assert!(run().pass(&whole) && whole.looks() >= POINTS, "{} looks", whole.looks());
    let cancel = CancelToken::at_look(POINTS / 2);
    let mut run = run();
    assert!(!run.pass(&cancel), "half of a pass is none");
    assert!(cancel.looks() < POINTS, "{} looks", cancel.looks());
    assert_eq!(run.passes(), 0);
    assert!(run.reference().irradiance.iter().all(|value| value.length() == 0.0));
}

#[test]
fn more_passes_go_on_from_the_cache() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::new(&folder.path().join("made/when/needed"));
    let first = passes(run(20, 1), 40);
    cache.store(&first).expect("a writable folder");
    let mut second = run(20, 1);
    assert!(cache.load(&mut second) && second.passes() == 40);
    assert_eq!(bits(&second), bits(&first));
    let second = passes(second, PASSES - 40);
    assert_eq!(bits(&second), bits(&passes(run(20, 1), PASSES)), "as if it had never stopped");
    cache.store(&second).expect("a writable folder");
    cache.store(&first).expect("a writable folder");
    let mut third = run(20, 1);
    assert!(cache.load(&mut third) && third.passes() == PASSES, "the better one stays");
}

/// Whatever a value depends on makes another key: geometry, materials, winding, doubling, points
/// and seed; names do not.
#[test]
fn a_changed_scene_is_another_reference() {
    let scene = BuiltinScene::Cornell.build();
    let key = |scene: &Scene, sides, points, seed| run_of(scene.clone(), sides, points, seed).key().clone();
    let original = key(&scene, Sides::Front, 20, 1);
    let changed = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        change(&mut scene);
        key(&scene, Sides::Front, 20, 1)
    };
    assert_ne!(original, key(&scene, Sides::Front, 21, 1));
    assert_ne!(original, key(&scene, Sides::Front, 20, 2));
    assert_ne!(original, key(&scene, Sides::Both, 20, 1));
    assert_ne!(original, changed(&|scene| scene.vertices[3].x += 1e-6));
    assert_ne!(original, changed(&|scene| scene.materials[0].reflectance.y += 1e-6));
    assert_ne!(original, changed(&|scene| scene.materials[3].emission.z *= 1.000_001));
    assert_ne!(original, changed(&|scene| scene.polygons[0] = scene.polygons[0].flipped()));
    assert_ne!(original, changed(&|scene| scene.polygons.truncate(19)));
    assert_eq!(original, changed(&|scene| scene.name = "another name".to_owned()));
}

/// A file that is damaged anywhere, cut off, empty, or of another key counts as none and is written
/// anew.
#[test]
fn a_damaged_cache_is_ignored_and_rewritten() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cache = Cache::new(folder.path());
    let stored = passes(run(5, 1), 3);
    cache.store(&stored).expect("a writable folder");
    let path = cache.path(stored.key());
    let good = std::fs::read(&path).expect("it was stored");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "nothing is left beside it");
    let mut bad: Vec<Vec<u8>> = vec![Vec::new(), good[..good.len() / 2].to_vec(), good[..good.len() - 1].to_vec()];
    for place in [0, 10, 41, 45, 60, good.len() - 3] {
        let mut damaged = good.clone();
        damaged[place] ^= 4;
        bad.push(damaged);
    }
    let other = passes(run(5, 2), 3);
    cache.store(&other).expect("a writable folder");
    bad.push(std::fs::read(cache.path(other.key())).expect("it was stored"));
    for bytes in bad {
        std::fs::write(&path, &bytes).expect("a writable folder");
        let mut fresh = run(5, 1);
        assert!(!cache.load(&mut fresh) && fresh.passes() == 0, "{} bytes were believed", bytes.len());
        let target = Target { noise: 10.0, limit: None };
        let outcome = compute(&mut fresh, Some(&cache), target, &CancelToken::new(), |_, _| {});
        assert!(outcome.reached && outcome.cached_passes == 0 && outcome.cache_error.is_none());
        assert!(cache.load(&mut run(5, 1)), "it was not rewritten");
        std::fs::remove_file(&path).expect("it is there");
    }
}
