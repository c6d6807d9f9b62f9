//! The surveyor's thread: the pointer, probes and a work plane, each in the newest light.
//!
//! Truth: the snapshot itself, whose values at a point the probe module interpolates by other
//! means.

#[path = "support/waiting.rs"]
mod waiting;

use std::sync::Arc;

use glam::Vec3;
use selflink::base::cancel::CancelToken;
use selflink::read::probe::Probe;
use selflink::read::survey::{LitMesh, Ray, Report, Surveyor, WorkPlane};
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Scene, Sides};
use selflink::solve::{Epsilon, Snapshot, Solver, SolverParams};
use waiting::wait_for;

fn cornell() -> (Arc<Scene>, Arc<Snapshot>) {
    let (scene, occluders) = selflink::geometry::orient::apply(BuiltinScene::Cornell.build(), Sides::Front);
    let scene = Arc::new(scene);
    let params = SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() };
    let mut solver = Solver::new(scene.clone(), Arc::new(occluders), params, 1).expect("good parameters");
    solver.run(&CancelToken::new());
    (scene, Arc::new(solver.snapshot()))
}

/// The Cornell box in gathered light.
fn gathered() -> (Arc<Scene>, Arc<Snapshot>) {
    let (scene, occluders) = selflink::geometry::orient::apply(BuiltinScene::Cornell.build(), Sides::Front);
    let scene = Arc::new(scene);
    let params = SolverParams { error: Some(0.2), ..SolverParams::default() };
    let mut solver = Solver::new(scene.clone(), Arc::new(occluders), params, 1).expect("good parameters");
    solver.run(&CancelToken::new());
    (scene, Arc::new(solver.snapshot()))
}

fn until(surveyor: &Surveyor, what: &str, holds: impl Fn(&Report) -> bool) -> Report {
    wait_for(what, || Some(surveyor.report()).filter(|report| holds(report)))
}

/// A ray from the middle of the box down to the floor in front of its boxes.
fn down(scene: &Scene) -> Ray {
    let (lower, upper) = scene.bounds();
    let middle = 0.5 * (lower + upper);
    let camera = scene.camera.expect("the box has a camera");
    let origin = middle + 0.4 * (camera.eye - middle).normalize() * (upper - lower).x;
    Ray { origin: Vec3::new(origin.x, middle.y, origin.z), direction: Vec3::new(0.01, -3.0, 0.02) }
}

#[test]
fn what_is_read_is_what_the_snapshot_holds() {
    let (scene, snapshot) = cornell();
    let lit = LitMesh::new(scene.clone(), snapshot.clone());
    let ray = down(&scene);
    let reading = lit.under(ray.origin, ray.direction).expect("the floor");
    let probe = Probe::new(&snapshot.mesh, &snapshot.vertex_irradiance, &snapshot.vertex_radiosity);
    let truth = probe.at(reading.point, reading.normal).expect("the same place");
    assert!((reading.irradiance - truth.irradiance).length() <= 1e-3 * truth.irradiance.length());
    assert!((reading.radiosity - truth.radiosity).length() <= 1e-3 * truth.radiosity.length());
    let again = lit.at(reading.point, reading.normal, 0.02).expect("found by its place");
    assert!((again.irradiance - reading.irradiance).length() <= 1e-3 * truth.irradiance.length());
    assert!(lit.at(reading.point + 0.1 * Vec3::Y, Vec3::Y, 0.02).is_none(), "in the air there is nothing to read");
    assert!(lit.under(ray.origin, Vec3::ZERO).is_none() && lit.under(Vec3::splat(f32::NAN), Vec3::X).is_none());
}

/// Radiosity is emission plus the reflected part of irradiance, at every vertex.
#[test]
fn irradiance_and_radiosity_of_vertices_belong_together() {
    let (scene, snapshot) = cornell();
    let mesh = &snapshot.mesh;
    assert_eq!(snapshot.vertex_irradiance.len(), mesh.positions.len());
    for (triangle, leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        let material = &scene.materials[mesh.leaves[*leaf as usize].material.0 as usize];
        for &vertex in triangle {
            let [e, b] =
                [&snapshot.vertex_irradiance, &snapshot.vertex_radiosity].map(|of| Vec3::from(of[vertex as usize]));
            let sum = material.emission + material.reflectance * e;
            assert!((b - sum).length() <= 1e-3 * sum.length() + 1e-6, "{b} {sum}");
        }
    }
}

#[test]
fn pointer_probes_and_plane_are_answered() {
    let (scene, snapshot) = cornell();
    let surveyor = Surveyor::spawn(Box::new(|| {})).expect("a thread");
    let ray = down(&scene);
    surveyor.show(scene.clone(), snapshot.clone());
    surveyor.look(Some(ray));
    let report = until(&surveyor, "a look", |report| report.looked.is_some_and(|looked| looked.reading.is_some()));
    let floor = report.looked.and_then(|looked| looked.reading).expect("the floor");
    surveyor.probe(vec![(floor.point, floor.normal)]);
    let report = until(&surveyor, "a probe", |report| report.probes.iter().any(|probe| probe.reading.is_some()));
    let first = report.probes[0].reading.expect("on the floor").radiosity;

    // A probe follows the light.
    let mut brighter = (*snapshot).clone();
    brighter.vertex_radiosity.iter_mut().for_each(|light| *light = light.map(|channel| 2.0 * channel));
    brighter.serial += 1;
    surveyor.show(scene.clone(), Arc::new(brighter));
    until(&surveyor, "twice the light", |report| {
        let now = report.probes[0].reading.map_or(Vec3::ZERO, |reading| reading.radiosity);
        (now - 2.0 * first).length() < 1e-3 * first.length()
    });

    surveyor.measure(WorkPlane::for_scene(&scene));
    let report = until(&surveyor, "a plane", |report| report.plane.is_some());
    let summary = report.plane.expect("measured").summary();
    assert!(summary.points > 20 && summary.minimum > 0.0 && summary.uniformity <= 1.0, "{summary:?}");
    surveyor.measure(WorkPlane { spacing: 0.0, ..WorkPlane::default() });
    until(&surveyor, "a refusal", |report| report.failure.as_ref().is_some_and(|failure| failure.contains("spacing")));
}

/// Truth: the documented errors. A probe is read to 2 % at first, and settles at an eighth of that
/// while nobody asks for anything else.
#[test]
fn a_probe_settles_while_one_looks() {
    let (scene, snapshot) = gathered();
    let surveyor = Surveyor::spawn(Box::new(|| {})).expect("a thread");
    let ray = down(&scene);
    let floor = LitMesh::new(scene.clone(), snapshot.clone()).under(ray.origin, ray.direction).expect("the floor");
    surveyor.show(scene, snapshot);
    surveyor.probe(vec![(floor.point, floor.normal)]);
    let report = until(&surveyor, "a settled probe", |report| {
        let reading = report.probes.first().and_then(|probe| probe.reading);
        reading.is_some_and(|reading| {
            let error = reading.standard_error.expect("it is gathered");
            error.element_sum() < 0.0035 * reading.irradiance.element_sum()
        })
    });
    let settled = report.probes[0].reading.expect("on the floor").irradiance;
    assert!((settled - floor.irradiance).length() < 0.08 * settled.length(), "{settled} {}", floor.irradiance);
}

/// How soon it is given up is counted where a plane is measured: a few points at a time.
#[test]
fn a_large_plane_is_given_up_and_the_pointer_is_answered_meanwhile() {
    let (scene, snapshot) = cornell();
    let surveyor = Surveyor::spawn(Box::new(|| {})).expect("a thread");
    surveyor.show(scene.clone(), snapshot);
    let plane = WorkPlane { spacing: 0.004, margin: 0.0, ..WorkPlane::for_scene(&scene) };
    surveyor.measure(plane);
    until(&surveyor, "a beginning", |report| report.progress.is_some());
    surveyor.look(Some(down(&scene)));
    let report = until(&surveyor, "a look", |report| report.looked.is_some());
    assert!(report.progress.is_some() && report.plane.is_none(), "the plane is still being measured");
    surveyor.forget_plane();
    until(&surveyor, "the end", |report| report.progress.is_none());
    assert!(surveyor.report().plane.is_none());
}
