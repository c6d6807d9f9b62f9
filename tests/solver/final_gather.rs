//! The final gather: exact where closed forms are, no further than what was asked for, and nothing
//! where there is no light.

use std::sync::Arc;

use glam::Vec3;
use selflink::base::cancel::CancelToken;
use selflink::base::random::r2_sequence;
use selflink::gather::grey;
use selflink::geometry::orient;
use selflink::hierarchy::{Hierarchy, Shape};
use selflink::measure::accuracy::{ErrorMeter, Measure};
use selflink::measure::reference::{Reference, ReferenceRun, SurfacePoint, Target, compute, random_points};
use selflink::scene::{GroupId, MaterialId, Scene, Sides, builtin::BuiltinScene};
use selflink::solve::{Epsilon, Reconstruct, Snapshot, SolverParams, Step};

use super::support::{add_box, empty_room, furnished_room, lamp_room, solve, solver};

fn asking(error: f64) -> SolverParams {
    SolverParams { error: Some(error), ..SolverParams::default() }
}

/// The error of what is read anywhere, and that of the bare mesh where light comes to: a mesh shows
/// crevices as bright as what lies beside them.
fn measured(scene: &Scene, snapshot: &Snapshot, points: usize, noise: f64) -> [Measure; 2] {
    let points = random_points(scene, points, 7);
    let mut run = ReferenceRun::new(scene, points.into(), 7);
    let never = CancelToken::new();
    let target = Target { noise, limit: None };
    let reference = compute(&mut run, None, target, &never, |_, _| {}).reference;
    let lit: Vec<usize> =
        (0..reference.points.len()).filter(|at| reference.irradiance[*at].max_element() > 0.0).collect();
    let where_lit = Reference {
        points: lit.iter().map(|at| reference.points[*at]).collect(),
        irradiance: lit.iter().map(|at| reference.irradiance[*at]).collect(),
        standard_error: lit.iter().map(|at| reference.standard_error[*at]).collect(),
        paths: reference.paths,
    };
    let mesh = Snapshot { field: None, ..snapshot.clone() };
    let of =
        |reference: Reference, snapshot: &Snapshot| ErrorMeter::new(Arc::new(reference)).measure(snapshot).displayed;
    [of(reference, snapshot), of(where_lit, &mesh)]
}

/// Truth: B = B_e/(1−ρ) everywhere in a furnace. Nine tenths of E are to be within the target error
/// of 10 %, of which B has the share ρ; in the RMS, so are the vertices of the mesh. Among
/// furniture these are not asked: beside things they mix in leaves that hide under these.
#[test]
fn furnaces_glow_evenly_wherever_they_are_read() {
    let furnished = (furnished_room(0.5, 1.0), 0.5, true);
    for (scene, reflectance, is_furnished) in
        [(empty_room(0.5, 1.0), 0.5, false), furnished, (empty_room(0.9, 1.0), 0.9, false)]
    {
        let mut solved = solve(&scene, asking(0.1));
        let truth = 1.0 / (1.0 - reflectance);
        let snapshot = solved.snapshot();
        let field = snapshot.field.as_ref().expect("a final gather");
        let rms =
            |errors: Vec<f32>| (errors.iter().map(|error| error * error).sum::<f32>() / errors.len() as f32).sqrt();
        let read = |index: u32| {
            let [u, v] = r2_sequence(7, index);
            let point = field.hierarchy().point_on(Hierarchy::ROOT, u, v);
            let surface = field.surface(point.polygon);
            let light = field.read(point.polygon, point.position, 0.01).mean;
            (surface.emission + surface.reflectance * light).x / truth - 1.0
        };
        // Points that hide between things see nothing.
        let mut read: Vec<f32> = (0..200).map(read).filter(|error| *error > -0.4).map(f32::abs).collect();
        assert!(read.len() > 150, "{} points", read.len());
        read.sort_by(f32::total_cmp);
        let shown = snapshot.vertex_radiosity.iter().map(|[red, ..]| red / truth - 1.0);
        let shown = rms(shown.collect());
        let (half, most) = (read[read.len() / 2], read[9 * read.len() / 10]);
        println!("ρ = {reflectance}: readings within {half} (half), {most} (9 of 10), RMS of vertices {shown}");
        assert!(
            half < 0.01 && most < 0.02 && (is_furnished || shown < 0.02),
            "ρ = {reflectance}: {half} {most} {shown}"
        );
    }
}

/// Seeds by which each target error is asked for.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=5;

/// Truth: nine tenths of what is read are within each target error by the independent reference, to
/// twice the standard error of that quantile, and the certificate says so. A run keeps that with a
/// probability of 95 % (`tests/accuracy/coverage.rs` counts it), so of five runs one may miss.
/// Returns the means of the quantiles.
fn target_error_is_kept<const N: usize>(scene: &Scene, asked: [f64; N], points: usize, noise: f64) -> [f64; N] {
    let points = random_points(scene, points, 7);
    let mut run = ReferenceRun::new(scene, points.into(), 7);
    let target = Target { noise, limit: None };
    let reference = compute(&mut run, None, target, &CancelToken::new(), |_, _| {}).reference;
    let mut meter = ErrorMeter::new(Arc::new(reference));
    asked.map(|asked| {
        let (mut missed, mut sum) = (Vec::new(), 0.0);
        for seed in SEEDS {
            let mut solved = solve(scene, SolverParams { seed, ..asking(asked) });
            let found = solved.stats().error.expect("a certificate");
            let local = meter.local_error(&solved.snapshot());
            let run = format!(
                "{}, seed {seed}: asked {:.1} %, certified {:.1} %, measured {:.1} ± {:.1} %; mesh {:.1} %",
                scene.name,
                100.0 * asked,
                100.0 * found.bound,
                100.0 * local.p90,
                100.0 * local.p90_noise,
                100.0 * found.mesh.p90
            );
            println!("{run}");
            assert!(found.bound <= asked, "not reached: {run}");
            let is_in_order = found.read.p50 <= found.read.p90 && found.read.p90 <= found.bound;
            assert!(is_in_order && found.points >= 64, "{found:?}");
            sum += local.p90;
            if local.p90 - 2.0 * local.p90_noise > found.bound {
                missed.push(run);
            }
        }
        assert!(missed.len() <= 1, "{missed:?}");
        sum / SEEDS.count() as f64
    })
}

#[test]
fn the_target_error_is_kept_in_the_cornell_box() {
    let scene = BuiltinScene::Cornell.build();
    let errors = target_error_is_kept(&scene, [0.1, 0.05, 0.02], 200, 0.007);
    assert!(errors[0] > errors[2], "{errors:?}");
}

#[test]
fn the_target_error_is_kept_in_a_furnished_room() {
    target_error_is_kept(&lamp_room(), [0.1], 500, 0.015);
}

#[test]
#[ignore = "slow: half a minute for the reference"]
fn the_target_error_is_kept_in_the_seminar_room_slow() {
    let scene = BuiltinScene::from_name("seminar").expect("one of our own").build();
    target_error_is_kept(&scene, [0.05], 1000, 0.015);
}

/// Most of the office's A·|B|² lies within two small shades, a few centimetres from their bulbs:
/// the target error is kept only if no face is in its own shadow, and if bulbs and shades light
/// each other as often as they do.
#[test]
fn the_target_error_is_kept_in_the_office() {
    let scene = BuiltinScene::from_name("office").expect("one of our own").build();
    target_error_is_kept(&scene, [0.1], 300, 0.03);
}

/// Truth: at the same ε the gathered picture is nearer to the truth than vertices' averages, and
/// those than one value for each leaf.
#[test]
fn each_reconstruction_wastes_less() {
    let scene = lamp_room();
    let error = |reconstruct| {
        let params = SolverParams { reconstruct, epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() };
        measured(&scene, &solve(&scene, params).snapshot(), 400, 0.02)[0].rms
    };
    let [constant, vertex, gather] = [Reconstruct::Constant, Reconstruct::Vertex, Reconstruct::Gather].map(error);
    println!("constant {constant:.3}, vertex {vertex:.3}, gather {gather:.3}");
    assert!(gather < 0.5 * vertex && vertex < 1.1 * constant, "{constant} {vertex} {gather}");
}

/// One value for each leaf is what is shown of it, at all its corners.
#[test]
fn constant_leaves_have_one_value() {
    let params = SolverParams { reconstruct: Reconstruct::Constant, ..SolverParams::default() };
    let snapshot = solve(&lamp_room(), params).snapshot();
    for (triangle, leaf) in snapshot.mesh.triangles.iter().zip(&snapshot.mesh.triangle_leaf) {
        for corner in triangle {
            assert_eq!(snapshot.vertex_radiosity[*corner as usize], snapshot.leaf_radiosity[*leaf as usize]);
        }
    }
}

/// A scene without light keeps the one self-link and casts no ray.
#[test]
fn without_light_nothing_is_done() {
    let mut scene = lamp_room();
    scene.materials.iter_mut().for_each(|material| material.emission = Vec3::ZERO);
    let stats = solve(&scene, asking(0.02)).stats();
    assert_eq!((stats.links, stats.rays, stats.patches), (1, 0, scene.polygons.len()));
}

/// In a sealed dark room beside a lit one no patch is subdivided, and nothing of the light leaks
/// into it.
#[test]
fn a_sealed_dark_room_stays_as_it_is() {
    let mut scene = Scene::new("rooms");
    let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::ONE);
    add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (wall, GroupId(0)));
    let at = |x: f32, z: f32| Vec3::new(x, 0.99, z);
    scene.add_quad([at(0.4, 0.4), at(0.6, 0.4), at(0.6, 0.6), at(0.4, 0.6)], lamp, GroupId(0));
    let dark = scene.polygons.len() as u32;
    add_box(&mut scene, (Vec3::new(1.02, 0.0, 0.0), Vec3::new(2.02, 1.0, 1.0)), true, (wall, GroupId(0)));
    let snapshot = solve(&scene, asking(0.05)).snapshot();
    let field = snapshot.field.as_ref().expect("a final gather");
    for leaf in field.leaves() {
        let Shape::Patch(patch) = field.hierarchy().element(leaf).shape else { continue };
        assert_eq!(field.area(leaf) > 0.0, patch.polygon < dark, "light reaches polygon {}", patch.polygon);
    }
    let mut found = 0;
    for (triangle, leaf) in snapshot.mesh.triangles.iter().zip(&snapshot.mesh.triangle_leaf) {
        let leaf = &snapshot.mesh.leaves[*leaf as usize];
        if leaf.polygon >= dark {
            found += 1;
            assert_eq!(leaf.level, 0, "polygon {}", leaf.polygon);
            assert!(triangle.iter().all(|corner| snapshot.vertex_radiosity[*corner as usize] == [0.0; 3]));
        }
    }
    assert!(found >= 12, "{found} triangles of the dark room");
}

/// Truth: E = B_e/(1−ρ) at all points between walls that glow, less the hundredth that others hide,
/// also on each of 50,000 slips of paper that hang there, far too small for a look of their own:
/// they share theirs, so that there are few rays for each.
#[test]
fn small_faces_share_their_looks() {
    const SLIPS: u32 = 50_000;
    let mut scene = empty_room(0.5, 1.0);
    let (paper, before) = (scene.add_material("paper", Vec3::splat(0.5), Vec3::ZERO), scene.polygons.len() as u32);
    let (lower, upper) = scene.bounds();
    for slip in 0..SLIPS {
        let [u, v] = r2_sequence(3, slip);
        let [w, angle] = r2_sequence(4, slip);
        let centre = lower + (0.1 + 0.8 * Vec3::new(u, v, w)) * (upper - lower);
        let (sine, cosine) = (angle * std::f32::consts::TAU).sin_cos();
        let side = 1e-3 * (upper - lower).max_element();
        let at = |a: f32, b: f32| centre + side * (a * Vec3::new(cosine, sine, 0.0) + b * Vec3::Z);
        scene.add_quad([at(0., 0.), at(1., 0.), at(1., 1.), at(0., 1.)], paper, GroupId(0));
    }
    let mut solved = solve(&scene, asking(0.1));
    let of_links = solved.link_solution().refinement().counts.rays;
    let of_gather = solved.stats().rays - of_links;
    assert!(of_gather < 8 * u64::from(SLIPS), "{of_gather} rays beside {of_links} of links");
    let snapshot = solved.snapshot();
    let field = snapshot.field.as_ref().expect("a final gather");
    let mut errors = Vec::new();
    for leaf in field.leaves() {
        let Shape::Patch(patch) = field.hierarchy().element(leaf).shape else { continue };
        if patch.polygon >= before {
            errors.push((0.5 * grey(field.irradiance()[leaf.index()]) - 1.0).abs());
        }
    }
    errors.sort_by(f32::total_cmp);
    assert!(errors[errors.len() * 9 / 10] < 0.1, "nine tenths are within {}", errors[errors.len() * 9 / 10]);
}

/// Truth: an evenly lit wall needs no more leaves than its shading asks: a lamp of the size of the
/// floor, one side of it away, lights the middle of the floor by 0.55 and its corner by 0.25 of its
/// radiosity, and 5 % of that by straight lines takes some 8 × 8 leaves at most.
#[test]
fn a_softly_lit_floor_is_hardly_split() {
    let mut scene = Scene::new("floor");
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::ONE);
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    scene.add_quad([at(0., 0., 0.), at(1., 0., 0.), at(1., 1., 0.), at(0., 1., 0.)], grey, GroupId(0));
    scene.add_quad([at(0., 0., 1.), at(0., 1., 1.), at(1., 1., 1.), at(1., 0., 1.)], lamp, GroupId(0));
    let solved = solve(&scene, asking(0.05));
    let patches = solved.stats().patches;
    assert!(patches <= 64, "{patches} patches");
}

/// Behind a slit, in a room lit only through a narrow gap, three hundred times darker than the
/// other: the median local error is under 15 % when 5 % is asked for, although an RMS has no part
/// for it.
#[test]
fn light_comes_through_a_slit() {
    let mut scene = Scene::new("slit");
    let wall = scene.add_material("wall", Vec3::splat(0.7), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(50.0));
    add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 2.0, 2.0)), true, (wall, GroupId(0)));
    // A wall of two sides across the middle, 2 cm thick, with a gap of 5 cm at its end.
    add_box(&mut scene, (Vec3::new(1.99, 0.0, 0.0), Vec3::new(2.01, 2.0, 1.95)), false, (wall, GroupId(0)));
    let at = |x: f32, z: f32| Vec3::new(x, 1.99, z);
    scene.add_quad([at(0.5, 0.5), at(1.0, 0.5), at(1.0, 1.0), at(0.5, 1.0)], lamp, GroupId(0));
    // As whoever opens it does: the floor is cut where the wall stands.
    let (scene, _) = orient::apply(scene, Sides::Front);
    let snapshot = solve(&scene, asking(0.05)).snapshot();
    let points = random_points(&scene, 240, 3);
    let behind: Vec<_> = points.into_iter().filter(|point| point.position.x > 2.05).collect();
    let mut run = ReferenceRun::new(&scene, behind.into(), 3);
    let target = Target { noise: 0.05, limit: None };
    let outcome = compute(&mut run, None, target, &CancelToken::new(), |_, _| {});
    let error = ErrorMeter::new(Arc::new(outcome.reference)).measure(&snapshot).displayed;
    println!("behind the slit: median local error {:.1} %, RMS {:.1} %", 100.0 * error.local_median, 100.0 * error.rms);
    assert!(error.local_median < 0.15, "median local error {:.3}", error.local_median);
}

/// Whatever the gather is at, its first part included, who cancels is heard at once, and what was
/// begun can be done again with the same result.
#[test]
fn every_part_of_the_gather_can_be_cancelled() {
    let scene = lamp_room();
    let plain = solve(&scene, asking(0.1)).snapshot().vertex_radiosity;
    let mut solving = solver(&scene, asking(0.1));
    let mut interrupted = 0;
    let mut look = 1;
    loop {
        match solving.step(&CancelToken::at_look(look)) {
            Step::Finished => break,
            // Each piece of work gets further until it is done.
            Step::Interrupted => {
                interrupted += 1;
                look *= 2;
            }
            Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => look = 1,
        }
    }
    assert!(interrupted > 10, "{interrupted}");
    assert_eq!(solving.snapshot().vertex_radiosity, plain);
}

/// A lamp that changes after leaves were split by the gather sends verdicts back to them.
#[test]
fn lamps_can_change_after_the_gather() {
    let scene = lamp_room();
    let lamp = scene.materials.iter().position(|material| material.emission != Vec3::ZERO).expect("a lamp");
    let mut solving = solve(&scene, asking(0.1));
    let before = solving.snapshot().leaf_radiosity;
    for emission in [Vec3::ZERO, Vec3::splat(30.0)] {
        solving.set_emission(MaterialId(lamp as u32), emission);
        assert!(solving.run(&CancelToken::new()));
    }
    assert!(solving.stats().error_estimate <= Some(0.1) && solving.snapshot().leaf_radiosity != before);
}

/// A change of what is asked for goes on from what is there; no step keeps anybody waiting who
/// cancels.
#[test]
fn steps_are_short_and_the_goal_can_change() {
    let mut solving = solver(&lamp_room(), asking(0.2));
    let never = CancelToken::new();
    let mut most_rays = 0;
    let mut run = |solving: &mut selflink::solve::Solver| loop {
        let before = solving.stats().rays;
        let step = solving.step(&never);
        most_rays = most_rays.max(solving.stats().rays - before);
        if step == Step::Finished {
            break;
        }
    };
    run(&mut solving);
    let coarse = solving.snapshot();
    assert!(!solving.set_params(asking(0.05)).expect("usable").is_rebuilt(), "the hierarchy stays");
    run(&mut solving);
    let fine = solving.snapshot();
    assert!(fine.mesh.positions.len() > coarse.mesh.positions.len());
    assert!(fine.stats.error_estimate <= Some(0.05), "{:?}", fine.stats.error_estimate);
    // Less than a second on one core, and heard within
    // (`every_part_of_the_gather_can_be_cancelled`); a gather that is not cut into steps casts
    // millions.
    assert!(most_rays < 250_000, "a step cast {most_rays} rays");
}

/// Truth: the independent reference, in the gap between a cupboard and a wall whose leaves reach
/// far beyond it. Light gets there by many reflections, which readings follow: without that, the
/// wall would be read as bright as outside.
#[test]
fn a_crevice_is_as_dark_as_it_is() {
    let mut scene = empty_room(0.7, 0.0);
    let lamp = scene.add_material("lamp", Vec3::splat(0.3), Vec3::splat(20.0));
    scene.add_quad(
        [[0.4, 0.6], [0.6, 0.6], [0.6, 0.8], [0.4, 0.8]].map(|[x, z]| Vec3::new(x, 0.98, z)),
        lamp,
        GroupId(0),
    );
    let furniture = scene.add_material("furniture", Vec3::splat(0.7), Vec3::ZERO);
    add_box(&mut scene, (Vec3::new(0.2, 0.0, 0.04), Vec3::new(0.8, 0.5, 0.4)), false, (furniture, GroupId(0)));
    let solved = solve(&scene, asking(0.05));
    let field = solved.field().expect("a gather");
    let behind: Vec<SurfacePoint> = (0..24)
        .map(|index| {
            let [u, v] = r2_sequence(3, index);
            let position = Vec3::new(0.25 + 0.5 * u, 0.05 + 0.35 * v, 0.0);
            let is_wall = |polygon: &u32| {
                let of = &scene.polygons[*polygon as usize];
                let (corners, count) = scene.corner_positions(of);
                scene.normal(of).z > 0.9 && corners[..count].iter().all(|corner| corner.z == 0.0)
            };
            let wall = (0..scene.polygons.len() as u32).find(is_wall);
            SurfacePoint::on(&scene, wall.expect("the back wall"), position)
        })
        .collect();
    let mut run = ReferenceRun::new(&scene, behind.clone().into(), 7);
    let target = Target { noise: 0.02, limit: None };
    let reference = compute(&mut run, None, target, &CancelToken::new(), |_, _| {}).reference;
    let read = |point: &SurfacePoint| f64::from(grey(field.read(point.polygon, point.position, 0.02).mean));
    let read: f64 = behind.iter().map(read).sum();
    let truth: f64 = reference.irradiance.iter().map(|light| light.element_sum() / 3.0).sum();
    let dim = 24.0 * f64::from(field.dim());
    // The target error.
    assert!((read - truth).abs() < 0.05 * (truth + dim), "{read} where {truth} is");
}
