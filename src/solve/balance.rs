//! Where the emitted power goes: a balance whose sides are measured each on its own.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::Solver;
use crate::base::random::{cosine_direction, hash64, r2_sequence};
use crate::gather::Field;
use crate::geometry::EnclosureTest;
use crate::hierarchy::{ElementId, Hierarchy, Shape, SurfacePoint};
use crate::scene::Surface;
use crate::transport::entering_power;

/// The power of a solution, W per colour: what is emitted and what enters should equal the sum of
/// the other three.
#[derive(Clone, Copy, Debug)]
pub struct PowerBalance {
    /// Φ = Σ A·B_e.
    pub emitted: DVec3,
    /// Power from outside that meets bright sides, by rays of its own that come in.
    pub entered: DVec3,
    /// Σ A·E·(1−ρ) over the leaves of the solution.
    pub absorbed: DVec3,
    /// Power that meets the dark back of a face, that of hidden parts of lamps included.
    pub stopped_by_backs: DVec3,
    /// Power that leaves the scene.
    pub escaped: DVec3,
}

/// Elements of one sum, a fixed number so that it is the same for any number of threads.
const ELEMENTS_AT_ONCE: usize = 1 << 13;
/// Rays that come in from outside for each that leaves a leaf: few of them find an opening.
const RAYS_IN: u32 = 4;
/// Rays that tell whether a point is hidden.
const HIDDEN_RAYS: u32 = 16;
/// Points of a leaf hidden in part that are tried.
const TRIES: u64 = 8;

impl PowerBalance {
    /// Power that is missing (positive) or created (negative), as a share of the power of all
    /// colours that is emitted or enters.
    pub fn relative_gap(&self) -> f64 {
        let accounted = self.absorbed + self.stopped_by_backs + self.escaped;
        let given = (self.emitted + self.entered).element_sum();
        if given > 0.0 { (given - accounted.element_sum()) / given } else { 0.0 }
    }
}

/// A solution as it is measured: the leaves of the gather where there is one, else those of the
/// links.
struct Lit<'a> {
    hierarchy: &'a Hierarchy,
    surfaces: &'a [Surface],
    irradiance: &'a [Vec3],
    field: Option<&'a Field>,
}

impl<'a> Lit<'a> {
    fn new(solver: &'a Solver) -> Self {
        let surfaces = solver.links.surfaces();
        match solver.field() {
            Some(field) => {
                Self { hierarchy: field.hierarchy(), surfaces, irradiance: field.irradiance(), field: Some(field) }
            }
            None => Self { hierarchy: solver.hierarchy(), surfaces, irradiance: solver.irradiance(), field: None },
        }
    }

    /// Leaves with their surfaces.
    fn leaves(&self) -> impl Iterator<Item = (ElementId, &'a Surface)> {
        self.leaves_among(0..self.hierarchy.elements().len())
    }

    /// Those among a part of the elements.
    fn leaves_among(&self, elements: Range<usize>) -> impl Iterator<Item = (ElementId, &'a Surface)> {
        let (hierarchy, surfaces) = (self.hierarchy, self.surfaces);
        elements.map(|index| ElementId(index as u32)).filter_map(move |id| match hierarchy.element(id).shape {
            Shape::Patch(patch) if hierarchy.element(id).is_leaf() => Some((id, &surfaces[patch.polygon as usize])),
            _ => None,
        })
    }

    fn area(&self, leaf: ElementId) -> f64 {
        f64::from(self.field.map_or(self.hierarchy.element(leaf).area, |field| field.area(leaf)))
    }

    fn absorbed(&self) -> DVec3 {
        let of_leaf = |(leaf, surface): (ElementId, &Surface)| {
            self.area(leaf) * (self.irradiance[leaf.index()] * (Vec3::ONE - surface.reflectance)).as_dvec3()
        };
        let elements = self.hierarchy.elements().len();
        let of_chunk = |chunk: usize| -> DVec3 {
            let first = chunk * ELEMENTS_AT_ONCE;
            self.leaves_among(first..elements.min(first + ELEMENTS_AT_ONCE)).map(of_leaf).sum()
        };
        let chunks = (0..elements.div_ceil(ELEMENTS_AT_ONCE)).into_par_iter().map(of_chunk);
        chunks.collect::<Vec<_>>().into_iter().sum()
    }
}

/// Power absorbed by bright sides, W per colour.
pub(super) fn absorbed(solver: &Solver) -> DVec3 {
    Lit::new(solver).absorbed()
}

/// Measures the balance of a solution: absorption from its irradiances, what backs stop and what
/// escapes by `rays` random rays that leave its leaves in proportion to their radiosity and that
/// know nothing of how light was found.
pub fn power_balance(solver: &Solver, rays: u32, seed: u64) -> PowerBalance {
    let lit = Lit::new(solver);
    let hierarchy = lit.hierarchy;
    let leaves: Vec<(ElementId, Vec3)> = lit
        .leaves()
        .map(|(leaf, surface)| (leaf, surface.emission + surface.reflectance * lit.irradiance[leaf.index()]))
        .collect();
    let mut power_before = vec![0.0_f64];
    for (leaf, radiosity) in &leaves {
        let power = lit.area(*leaf) * f64::from(radiosity.element_sum());
        power_before.push(power_before[power_before.len() - 1] + power);
    }
    let total = power_before[leaves.len()];
    let emitted = solver.scene().emitted_power().as_dvec3();
    let entered = match solver.hierarchy().outside().len() {
        0 => DVec3::ZERO,
        _ => entering_power(solver.scene(), solver.links.occluders(), RAYS_IN * rays, seed).as_dvec3(),
    };
    let mut balance = PowerBalance {
        emitted,
        entered,
        absorbed: lit.absorbed(),
        stopped_by_backs: DVec3::ZERO,
        escaped: DVec3::ZERO,
    };
    if total <= 0.0 || rays == 0 {
        return balance;
    }
    let test = EnclosureTest::new(solver.scene(), solver.links.occluders());
    let starts: Vec<Vec<SurfacePoint>> = leaves
        .par_iter()
        .map(
            |(leaf, radiosity)| {
                if *radiosity == Vec3::ZERO { Vec::new() } else { reachable_points(hierarchy, &test, *leaf, seed) }
            },
        )
        .collect();
    let fates: Vec<(DVec3, DVec3)> = (0..rays)
        .into_par_iter()
        .map(|index| {
            let random = |axis: u64| (hash64(hash64(seed, u64::from(index)), axis) >> 40) as f32 / 16_777_216.0;
            let wanted = (f64::from(index) + f64::from(random(0))) / f64::from(rays) * total;
            let place = power_before[1..leaves.len()].partition_point(|&before| before <= wanted);
            let (leaf, radiosity) = leaves[place];
            // Of a leaf that is hidden in part, one of the points that are not.
            let point = match starts[place].as_slice() {
                [] => hierarchy.point_on(leaf, random(1), random(2)),
                some => some[((random(1) * some.len() as f32) as usize).min(some.len() - 1)],
            };
            let direction = cosine_direction(point.normal, random(3), random(4));
            let carried = (radiosity / radiosity.element_sum()).as_dvec3() * (total / f64::from(rays));
            match solver.links.occluders().ray_from(point.position, point.normal, direction) {
                None => (DVec3::ZERO, carried),
                Some(hit) if !hit.front => (carried, DVec3::ZERO),
                Some(_) => (DVec3::ZERO, DVec3::ZERO),
            }
        })
        .collect();
    let reachable_emission = lit.leaves().map(|(leaf, surface)| lit.area(leaf) * surface.emission.as_dvec3());
    balance.stopped_by_backs = (emitted - reachable_emission.sum::<DVec3>()).max(DVec3::ZERO);
    for (stopped, escaped) in fates {
        balance.stopped_by_backs += stopped;
        balance.escaped += escaped;
    }
    balance
}

/// Some random points of a leaf that is hidden in part that are not hidden themselves; few are
/// tried, so that the work grows with the scene, not with the rays.
fn reachable_points(hierarchy: &Hierarchy, test: &EnclosureTest, leaf: ElementId, seed: u64) -> Vec<SurfacePoint> {
    if hierarchy.element(leaf).reachable_share() >= 1.0 {
        return Vec::new();
    }
    let point = |number: u64| {
        let seed = hash64(hash64(seed, u64::from(leaf.0)), number);
        let [u, v] = r2_sequence(seed, 0);
        let point = hierarchy.point_on(leaf, u, v);
        (!test.is_enclosed(point.position, point.normal, seed, HIDDEN_RAYS)).then_some(point)
    };
    (0..TRIES).filter_map(point).collect()
}
