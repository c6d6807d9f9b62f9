//! The exposure meter of a view: what is seen is brought to the key, lamps aside.
//!
//! Rays through a coarse grid of the view tell which faces are seen; the median of what they send
//! out is what is metered.

use glam::Vec2;

use super::Camera;
use crate::base::photometry::weighted;
use crate::geometry::Occluders;
use crate::read::tone::{auto_exposure, exposure_of_seen};
use crate::scene::Scene;
use crate::solve::snapshot::Snapshot;

/// Rays in each direction of the view.
const GRID: [u32; 2] = [32, 20];

/// A surface that sends out less than this share of the light that the scene's surfaces get on the
/// average is dark: some few rays found a way to it, through a gap. A bright picture of it would
/// show these rays.
const FAINTEST: f64 = 1e-6;
/// A view is dark where no more than this share of it is brighter.
const LIT_SHARE: f64 = 0.1;

/// How a view is exposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metered {
    /// The factor on radiosities, m²/W.
    pub factor: f32,
    /// Whether next to no light reaches what is seen, where the scene has some.
    pub is_dark: bool,
}

/// A meter of the light in one snapshot.
pub struct LightMeter {
    /// Mean radiosity of each polygon that does not emit, weighted as the eye does, W/m².
    of_polygons: Vec<Option<f32>>,
    /// The least radiosity that counts, W/m².
    faintest: f32,
}

impl LightMeter {
    /// Prepares to meter views of a snapshot.
    pub fn new(snapshot: &Snapshot, scene: &Scene) -> Self {
        let mut sums = vec![(0.0_f64, 0.0_f64); scene.polygons.len()];
        for (leaf, radiosity) in snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity) {
            if let Some((sent, area)) = sums.get_mut(leaf.polygon as usize) {
                *sent += f64::from(leaf.area * weighted(*radiosity));
                *area += f64::from(leaf.area);
            }
        }
        let emits = |polygon: usize| {
            let material = scene.polygons[polygon].material.0 as usize;
            scene.materials.get(material).is_some_and(|material| material.emission.max_element() > 0.0)
        };
        let mean = |(polygon, (sent, area)): (usize, &(f64, f64))| {
            (*area > 0.0 && !emits(polygon)).then(|| (sent / area) as f32)
        };
        let area: f64 = sums.iter().map(|(_, area)| area).sum();
        let faintest = FAINTEST * snapshot.stats.power_watts / area.max(f64::MIN_POSITIVE);
        Self { of_polygons: sums.iter().enumerate().map(mean).collect(), faintest: faintest as f32 }
    }

    /// Exposure that suits a view of the snapshot; that of the whole scene where nothing lit is
    /// seen.
    pub fn exposure(&self, snapshot: &Snapshot, occluders: &Occluders, camera: &Camera, aspect: f32) -> Metered {
        let [columns, rows] = GRID;
        let place = |index: u32| {
            let share = |at: u32, of: u32| (at as f32 + 0.5) / of as f32;
            let at = Vec2::new(share(index % columns, columns), share(index / columns, rows));
            let (origin, direction) = camera.ray(2.0 * at - Vec2::ONE, aspect);
            let hit = occluders.first_front(origin, direction)?;
            self.of_polygons.get(hit.polygon as usize).copied().flatten()
        };
        let mut seen: Vec<f32> = (0..columns * rows).filter_map(place).collect();
        let lit = seen.iter().filter(|radiosity| **radiosity >= self.faintest).count();
        let is_lit = 2 * lit > seen.len();
        if let Some(factor) = is_lit.then(|| exposure_of_seen(&mut seen)).flatten() {
            return Metered { factor, is_dark: false };
        }
        let is_dark = self.faintest > 0.0 && !seen.is_empty() && lit as f64 <= LIT_SHARE * seen.len() as f64;
        Metered { factor: auto_exposure(snapshot), is_dark }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::measure::stability::scenes::add_box;
    use crate::scene::builtin::BuiltinScene;
    use crate::scene::{CameraPose, GroupId, MaterialId};
    use crate::solve::{Solver, SolverParams};

    /// Truth: a lamp in a closed box of its own lights that box and not the room, however bright
    /// the room would have to be made for its last ray to show. Seen from within, the box is well
    /// exposed.
    #[test]
    fn a_room_that_its_lamp_does_not_reach_is_dark() {
        let mut scene = BuiltinScene::Cornell.build();
        let ((_, upper), room) = (scene.bounds(), scene.polygons.len());
        for material in &mut scene.materials {
            material.emission = Vec3::ZERO;
        }
        let lamp = scene.add_material("lamp in a box", Vec3::splat(0.5), Vec3::splat(10.0));
        let case = MaterialId(0);
        let place = upper + Vec3::splat(1.0);
        let of = GroupId(0);
        add_box(&mut scene, (place, place + Vec3::ONE), true, (case, of));
        add_box(&mut scene, (place + Vec3::splat(0.4), place + Vec3::splat(0.6)), false, (lamp, of));
        let mut solver = Solver::solved(scene.clone(), SolverParams::default());
        let (occluders, mut snapshot) = (solver.link_solution().occluders().clone(), solver.snapshot());
        // Some ray gets out, as rounding lets one.
        let mesh = snapshot.mesh.clone();
        for (leaf, radiosity) in mesh.leaves.iter().zip(&mut snapshot.leaf_radiosity) {
            if (leaf.polygon as usize) < room {
                assert!(radiosity[1] < 1e-6, "{radiosity:?}");
                *radiosity = [1e-12; 3];
            }
        }
        let meter = LightMeter::new(&snapshot, &scene);
        let in_room = Camera::of_scene(&scene, 1.0);
        let metered = meter.exposure(&snapshot, &occluders, &in_room, 1.0);
        assert!(metered.is_dark && metered.factor < 1e6, "{metered:?}");
        let eye = place + Vec3::new(0.1, 0.1, 0.2);
        let pose = CameraPose { eye, target: place + Vec3::new(0.9, 0.1, 0.8), up: Vec3::Y, hfov_deg: 60.0 };
        let in_box = Camera::from_pose(&pose, 1.0, scene.bounds());
        let metered = meter.exposure(&snapshot, &occluders, &in_box, 1.0);
        assert!(!metered.is_dark && metered.factor < 1e3, "{metered:?}");
    }
}
