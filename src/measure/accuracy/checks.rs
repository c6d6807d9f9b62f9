//! Values of the reference and the solver for a [`Case`].

use std::sync::Arc;

use super::cases::{Case, Place};
use super::locate::locate;
use crate::base::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::measure::reference::{ReferenceRun, SurfacePoint, random_points_on};
use crate::solve::{Solver, SolverError, SolverParams};

/// A value and how far it may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// In the reading's unit.
    pub value: f64,
    /// Standard error, in the same unit.
    pub standard_error: f64,
}

/// Standard error of readings, as a share of the light there.
const READING_ERROR: f32 = 0.01;
/// A mean over an area is that of so many independent sets of points, whose spread tells its error.
const SETS: usize = 32;
/// Points of a set.
const POINTS_OF_SET: usize = 64;

/// Values of the reference for each reading: `passes` passes at points, and a share of them at the
/// many points that stand for an area.
pub fn by_reference(case: &Case, passes: u32, seed: u64) -> Vec<Measured> {
    let trace = |points: Vec<SurfacePoint>, passes: u32| {
        let mut run = ReferenceRun::new(&case.scene, points.into(), seed);
        (0..passes).for_each(|_| {
            run.pass(&CancelToken::new());
        });
        run.reference()
    };
    let measure = |reading: &super::cases::Reading| match &reading.place {
        Place::Point { polygon, position } => {
            let reference = trace(vec![SurfacePoint::on(&case.scene, *polygon, *position)], passes);
            (reference.irradiance[0].x, reference.standard_error[0].x)
        }
        Place::Mean(polygons) => {
            let set = |index: usize| random_points_on(&case.scene, polygons, POINTS_OF_SET, seed + index as u64);
            let reference = trace((0..SETS).flat_map(set).collect(), passes.div_ceil(SETS as u32));
            let of_sets = reference.irradiance.chunks(POINTS_OF_SET);
            let means: Vec<f64> =
                of_sets.map(|set| set.iter().map(|value| value.x).sum::<f64>() / set.len() as f64).collect();
            let mean = means.iter().sum::<f64>() / SETS as f64;
            let spread: f64 = means.iter().map(|value| (value - mean).powi(2)).sum();
            (mean, (spread / (SETS * (SETS - 1)) as f64).sqrt())
        }
    };
    let measured = |reading| {
        let (value, error) = measure(reading);
        Measured { value: reading.factor * value, standard_error: reading.factor * error }
    };
    case.readings.iter().map(measured).collect()
}

/// The solver's value of each reading: at points as displayed, over areas as its leaves have it.
///
/// # Errors
/// Parameters that cannot be used.
pub fn by_solver(case: &Case, params: SolverParams) -> Result<Vec<f64>, SolverError> {
    let scene = Arc::new(case.scene.clone());
    let mut solver = Solver::new(scene.clone(), Arc::new(Occluders::new(&scene)), params, 0)?;
    solver.run(&CancelToken::new());
    let snapshot = solver.snapshot();
    let vertices = &snapshot.vertex_irradiance;
    let mesh = &snapshot.mesh;
    let value = |place: &Place| match place {
        Place::Point { polygon, position } => {
            if let Some(field) = &snapshot.field {
                return f64::from(field.read(*polygon, *position, READING_ERROR).mean.x);
            }
            let found = locate(&[SurfacePoint::on(&scene, *polygon, *position)], mesh);
            let place = found[0].expect("every polygon of the scene has leaves");
            let corners = mesh.triangles[place.triangle as usize].map(|vertex| vertices[vertex as usize][0]);
            f64::from(place.weights.dot(corners.into()))
        }
        Place::Mean(polygons) => {
            let leaves = mesh.leaves.iter().zip(&snapshot.leaf_irradiance);
            let wanted = leaves.filter(|(leaf, _)| polygons.contains(&leaf.polygon));
            let (area, power) = wanted.fold((0.0, 0.0), |(area, power), (leaf, irradiance)| {
                let of_leaf = f64::from(leaf.reachable_area);
                (area + of_leaf, power + of_leaf * f64::from(irradiance[0]))
            });
            power / area
        }
    };
    Ok(case.readings.iter().map(|reading| reading.factor * value(&reading.place)).collect())
}
