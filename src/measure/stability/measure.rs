//! Short ways to solve a scene and to read a solution.

use std::sync::Arc;

use glam::DVec3;

use crate::base::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::scene::Scene;
use crate::solve::{ClusteringMode, Solver, SolverError, SolverParams};

/// Every way to build clusters.
pub const MODES: [ClusteringMode; 4] =
    [ClusteringMode::None, ClusteringMode::Octree, ClusteringMode::Groups, ClusteringMode::Adaptive];

/// The ways that build any.
pub const CLUSTERED: [ClusteringMode; 3] = [ClusteringMode::Octree, ClusteringMode::Groups, ClusteringMode::Adaptive];

/// Every way to build clusters, with each of these thresholds.
pub fn at_each<const N: usize>(epsilons: [f64; N]) -> impl Iterator<Item = (ClusteringMode, f64)> {
    MODES.into_iter().flat_map(move |mode| epsilons.map(|epsilon| (mode, epsilon)))
}

/// The default parameters with these clusters and this relative ε.
pub fn params(clustering: ClusteringMode, epsilon: f64) -> SolverParams {
    SolverParams { clustering, ..SolverParams::with_epsilon(epsilon) }
}

/// A finished solve of a scene whose faces are bright as they are wound.
///
/// # Errors
/// Parameters that cannot be used.
pub fn solve(scene: &Scene, params: SolverParams) -> Result<Solver, SolverError> {
    let mut solver = Solver::new(Arc::new(scene.clone()), Arc::new(Occluders::new(scene)), params, 0)?;
    // Nobody cancels.
    solver.run(&CancelToken::new());
    Ok(solver)
}

/// The leaf patches with the index of their polygon.
pub fn leaves(hierarchy: &Hierarchy) -> Vec<(ElementId, u32)> {
    let polygon = |id: ElementId| match hierarchy.element(id).shape {
        Shape::Patch(patch) if hierarchy.element(id).is_leaf() => Some((id, patch.polygon)),
        _ => None,
    };
    hierarchy.ids().filter_map(polygon).collect()
}

/// Power Σ A·E that a polygon receives, W (red).
pub fn received(solver: &Solver, polygon: u32) -> f64 {
    let hierarchy = solver.hierarchy();
    let power = |id: ElementId| f64::from(hierarchy.element(id).area) * f64::from(solver.irradiance()[id.index()].x);
    leaves(hierarchy).iter().filter(|leaf| leaf.1 == polygon).map(|leaf| power(leaf.0)).sum()
}

/// Area-weighted mean of the red radiosity over the leaves, its relative RMS deviation from
/// `truth`, and the worst one.
pub fn deviation(solver: &Solver, truth: f64) -> (f64, f64, f64) {
    let hierarchy = solver.hierarchy();
    let (mut area_sum, mut sum, mut squares, mut worst) = (0.0, 0.0, 0.0, 0.0_f64);
    for (leaf, _) in leaves(hierarchy) {
        let area = f64::from(hierarchy.element(leaf).area);
        let radiosity = f64::from(solver.radiosity()[leaf.index()].x);
        let error = radiosity / truth - 1.0;
        area_sum += area;
        sum += area * radiosity;
        squares += area * error * error;
        worst = worst.max(error.abs());
    }
    (sum / area_sum, (squares / area_sum).sqrt(), worst)
}

/// Relative RMS difference of two solutions' radiosities over the polygons, weighted by area; the
/// scenes must have as many.
pub fn difference(one: &Solver, other: &Solver) -> f64 {
    difference_to(one, other, 1.0)
}

/// As [`difference`], from the radiosities of the other one times a factor.
pub fn difference_to(one: &Solver, other: &Solver, factor: f32) -> f64 {
    let (mut differences, mut squares) = (0.0, 0.0);
    for ((_, a), (area, b)) in of_polygons(one).into_iter().zip(of_polygons(other)) {
        let b = f64::from(factor) * b;
        differences += area * (a - b).length_squared();
        squares += area * b.length_squared();
    }
    (differences / squares).sqrt()
}

/// Area and mean radiosity of each polygon, m² and W/m².
pub fn of_polygons(solver: &Solver) -> Vec<(f64, DVec3)> {
    let hierarchy = solver.hierarchy();
    let mut polygons = vec![(0.0, DVec3::ZERO); hierarchy.initial_patches().len()];
    for &id in hierarchy.initial_patches() {
        let element = hierarchy.element(id);
        if let Shape::Patch(patch) = element.shape {
            polygons[patch.polygon as usize] = (f64::from(element.area), solver.radiosity()[id.index()].as_dvec3());
        }
    }
    polygons
}

/// Whether every radiosity is a number, none negative.
pub fn is_sound(solver: &Solver) -> bool {
    solver.radiosity().iter().all(|radiosity| radiosity.is_finite() && radiosity.min_element() >= 0.0)
}
