//! Where the emitted power goes: a balance whose sides are measured each on its own.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Solver;
use crate::hierarchy::ElementId;
use crate::random::{cosine_direction, mix};

/// The power of a solution, W per colour: Φ should equal the sum of the other three.
#[derive(Clone, Copy, Debug)]
pub struct PowerBalance {
    /// Φ = Σ A·B_e.
    pub emitted: DVec3,
    /// Σ A·E·(1−ρ) over the leaves of the solution.
    pub absorbed: DVec3,
    /// Power that meets the dark back of a face, that of hidden parts of lamps included.
    pub stopped_by_backs: DVec3,
    /// Power that leaves the scene.
    pub escaped: DVec3,
}

impl PowerBalance {
    /// What is missing (positive) or created (negative), as a share of the emitted power of all colours.
    pub fn relative_gap(&self) -> f64 {
        let accounted = self.absorbed + self.stopped_by_backs + self.escaped;
        let emitted = self.emitted.element_sum();
        if emitted > 0.0 { (emitted - accounted.element_sum()) / emitted } else { 0.0 }
    }
}

/// Power absorbed by bright sides, W per colour.
pub(super) fn absorbed(solver: &Solver) -> DVec3 {
    let leaf = |(element, irradiance): (&crate::hierarchy::Element, &Vec3)| match element.shape {
        crate::hierarchy::Shape::Patch(patch) if element.is_leaf() => {
            let surface = &solver.surfaces[patch.polygon as usize];
            f64::from(element.area) * (*irradiance * (Vec3::ONE - surface.reflectance)).as_dvec3()
        }
        _ => DVec3::ZERO,
    };
    solver.hierarchy.elements().iter().zip(&solver.light.irradiance).map(leaf).sum()
}

/// Measures the balance of a solution: absorption from its irradiances, what backs stop and what escapes by `rays` random
/// rays that leave its leaves in proportion to their radiosity and that know nothing of its links.
pub fn power_balance(solver: &Solver, rays: u32, seed: u64) -> PowerBalance {
    let hierarchy = &solver.hierarchy;
    let leaves: Vec<ElementId> =
        hierarchy.ids().filter(|id| hierarchy.element(*id).is_leaf() && !hierarchy.element(*id).is_cluster()).collect();
    let emitted = solver.scene.emitted_power().as_dvec3();
    let mut balance =
        PowerBalance { emitted, absorbed: absorbed(solver), stopped_by_backs: DVec3::ZERO, escaped: DVec3::ZERO };
    // Points lie on hidden parts as well, whose rays meet the backs around them: these are known beforehand.
    let mut power_before = vec![0.0_f64];
    let (mut exposed_emission, mut hidden) = (DVec3::ZERO, DVec3::ZERO);
    for leaf in &leaves {
        let (element, radiosity) = (hierarchy.element(*leaf), solver.light.radiosity[leaf.index()]);
        let power = f64::from(element.sampled_area * radiosity.element_sum());
        power_before.push(power_before[power_before.len() - 1] + power);
        exposed_emission += f64::from(element.area) * solver.light.emitted[leaf.index()].as_dvec3();
        hidden += f64::from(element.sampled_area - element.area) * radiosity.as_dvec3();
    }
    let total = power_before[leaves.len()];
    if total <= 0.0 || rays == 0 {
        return balance;
    }
    let fates: Vec<(DVec3, DVec3)> = (0..rays)
        .into_par_iter()
        .map(|index| {
            let random = |axis: u64| (mix(mix(seed, u64::from(index)), axis) >> 40) as f32 / 16_777_216.0;
            let wanted = (f64::from(index) + f64::from(random(0))) / f64::from(rays) * total;
            let place = power_before[1..leaves.len()].partition_point(|&before| before <= wanted);
            let leaf = leaves[place];
            let point = hierarchy.point_on(leaf, random(1), random(2));
            let direction = cosine_direction(point.normal, random(3), random(4));
            let radiosity = solver.light.radiosity[leaf.index()];
            let carried = (radiosity / radiosity.element_sum()).as_dvec3() * (total / f64::from(rays));
            match solver.occluders.ray_from(point.position, point.normal, direction) {
                None => (DVec3::ZERO, carried),
                Some(hit) if !hit.front => (carried, DVec3::ZERO),
                Some(_) => (DVec3::ZERO, DVec3::ZERO),
            }
        })
        .collect();
    let (stopped, escaped) =
        fates.into_iter().fold((DVec3::ZERO, DVec3::ZERO), |sums, fate| (sums.0 + fate.0, sums.1 + fate.1));
    balance.stopped_by_backs = (emitted - exposed_emission).max(DVec3::ZERO) + (stopped - hidden).max(DVec3::ZERO);
    balance.escaped = escaped;
    balance
}
