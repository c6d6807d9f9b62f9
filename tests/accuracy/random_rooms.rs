//! The reference in random closed rooms: sizes, reflectances up to 0.9, a box that stands on the
//! floor flush with it, walls of two faces, a neighbour that shares a wall.

use std::sync::Arc;

use glam::{DVec3, Vec3, vec3};
use selflink::base::cancel::CancelToken;
use selflink::base::random::Stream;
use selflink::geometry::{Occluders, orient};
use selflink::measure::accuracy::ErrorMeter;
use selflink::measure::reference::{Reference, ReferenceRun, SurfacePoint, random_points, random_points_on};
use selflink::measure::stability::matrix::{self, Fineness};
use selflink::measure::stability::scenes::add_box;
use selflink::scene::{GroupId, MaterialId, Scene, Sides};
use selflink::solve::{Solver, SolverParams};

const GROUP: GroupId = GroupId(0);

/// Random numbers, from a seed.
struct Random(Stream);

impl Random {
    fn number(&mut self) -> f32 {
        self.0.unit()
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.number()
    }

    fn is(&mut self) -> bool {
        self.number() < 0.5
    }
}

/// A closed room and what is in it.
struct Room {
    scene: Scene,
    lower: Vec3,
    upper: Vec3,
    /// A box on the floor: from, to.
    block: (Vec3, Vec3),
}

/// The first six polygons are the room's, the next six the box's.
const INSIDE: u32 = 12;

/// A random room; material 0 is that of the room, 1 that of the box, which keeps away from the
/// walls by this share of the room at least.
fn room(random: &mut Random, away: f32) -> Room {
    let size = vec3(random.within(1.0, 6.0), random.within(1.0, 4.0), random.within(1.0, 6.0));
    let lower = vec3(random.within(-3.0, 3.0), random.within(-3.0, 3.0), random.within(-3.0, 3.0));
    let mut scene = Scene::new("room");
    for name in ["wall", "box"] {
        scene.add_material(name, Vec3::ZERO, Vec3::ZERO);
    }
    add_box(&mut scene, (lower, lower + size), true, (MaterialId(0), GROUP));
    let from = lower + size * vec3(random.within(away, 0.4), 0.0, random.within(away, 0.4));
    let widest = 0.6 - away;
    let to = from + size * vec3(random.within(0.1, widest), random.within(0.1, 0.6), random.within(0.1, widest));
    add_box(&mut scene, (from, to), false, (MaterialId(1), GROUP));
    Room { scene, lower, upper: lower + size, block: (from, to) }
}

impl Room {
    /// Walls of two faces back to back, or a neighbour beyond a wall, or both. Nothing of it
    /// changes what is inside.
    fn with_others(&self, random: &mut Random) -> Scene {
        let mut scene = self.scene.clone();
        if random.is() {
            add_box(&mut scene, (self.lower, self.upper), false, (MaterialId(0), GROUP));
        }
        if random.is() {
            let beyond = vec3(self.upper.x, self.lower.y, self.lower.z);
            let size = (self.upper - self.lower) * vec3(1.0, random.within(0.5, 1.5), random.within(0.5, 1.5));
            let black = scene.add_material("neighbour", Vec3::splat(0.5), Vec3::ZERO);
            add_box(&mut scene, (beyond, beyond + size), true, (black, GROUP));
        }
        scene
    }

    /// Whether light can reach a point of the first polygons: the floor below the box and the box's
    /// own bottom lie in the dark.
    fn is_lit(&self, point: &SurfacePoint) -> bool {
        let (from, to) = self.block;
        let at = point.position;
        let below = at.x > from.x && at.x < to.x && at.z > from.z && at.z < to.z;
        !(below && (at.y - self.lower.y).abs() < 1e-5 * self.upper.distance(self.lower))
    }
}

fn trace(scene: &Scene, points: Vec<SurfacePoint>, passes: u32) -> Reference {
    let mut run = ReferenceRun::new(scene, points.into(), 3);
    for _ in 0..passes {
        assert!(run.pass(&CancelToken::new()), "nobody cancels");
    }
    run.reference()
}

/// Truth: the furnace, E = B_e/(1 − ρ) wherever light comes at all, and E = 0 where none does.
#[test]
fn random_furnaces_glow_evenly() {
    let mut random = Random(Stream(1));
    let (mut deviations, mut dark) = (Vec::new(), 0);
    for _ in 0..12 {
        let mut room = room(&mut random, 0.1);
        let rho = random.within(0.1, 0.9);
        for material in &mut room.scene.materials {
            (material.reflectance, material.emission) = (Vec3::splat(rho), Vec3::ONE);
        }
        let scene = room.with_others(&mut random);
        let points = random_points_on(&scene, &(0..INSIDE).collect::<Vec<_>>(), 40, 5);
        let found = trace(&scene, points, 16);
        for (index, point) in found.points.iter().enumerate() {
            let (value, error) = (found.irradiance[index].x, found.standard_error[index].x);
            if room.is_lit(point) {
                deviations.push((value - 1.0 / (1.0 - f64::from(rho))) / error);
            } else {
                assert_eq!(value, 0.0, "light where none can come: {point:?}");
                dark += 1;
            }
        }
    }
    // Of 16 batches: Student's distribution with 15 degrees of freedom has a variance of 15/13, and
    // 0.9 % lie beyond three.
    let count = deviations.len() as f64;
    let mean = deviations.iter().sum::<f64>() / count;
    let square = deviations.iter().map(|of| of * of).sum::<f64>() / count;
    let beyond = deviations.iter().filter(|of| of.abs() > 4.0).count();
    println!("{count} points, mean z {mean:.3}, z² {square:.3}, {beyond} beyond four, {dark} dark");
    assert!(dark > 10 && count > 300.0, "{dark} points in the dark of {count}");
    assert!(mean.abs() < 4.0 / count.sqrt() && square < 1.5 && beyond <= 2, "mean {mean}, square {square}, {beyond}");
}

/// Truth: conservation. In a closed room of one reflectance the mean of E is Φ/(S(1 − ρ)), with S
/// all that light can reach, wherever the lamp is; here one wall shines.
#[test]
fn random_rooms_keep_the_power() {
    let mut random = Random(Stream(2));
    for _ in 0..8 {
        let mut room = room(&mut random, 0.1);
        let rho = random.within(0.1, 0.9);
        for material in &mut room.scene.materials {
            material.reflectance = Vec3::splat(rho);
        }
        let mut scene = room.with_others(&mut random);
        let lamp = scene.add_material("lamp", Vec3::splat(rho), Vec3::splat(3.0));
        // Neither the floor, a part of which shines below the box, nor the first wall.
        let wall = 2 + (random.number() * 4.0) as usize;
        scene.polygons[wall].material = lamp;
        let emitted = 3.0 * f64::from(scene.area(&scene.polygons[wall]));
        let inside: f64 = scene.polygons[..INSIDE as usize].iter().map(|of| f64::from(scene.area(of))).sum();
        let (from, to) = room.block;
        let hidden = 2.0 * f64::from((to.x - from.x) * (to.z - from.z));
        let truth = emitted / ((inside - hidden) * (1.0 - f64::from(rho)));
        let points = random_points_on(&scene, &(0..INSIDE).collect::<Vec<_>>(), 256, 7);
        let found = trace(&scene, points, 4);
        // Points in the dark have nothing; the mean over all of them is that over S times the share
        // of S.
        let all: Vec<f64> = found.irradiance.iter().map(|value| value.x * inside / (inside - hidden)).collect();
        let count = all.len() as f64;
        let mean = all.iter().sum::<f64>() / count;
        // Points are spread more evenly than independent ones, whose error this is.
        let error = (all.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count / (count - 1.0)).sqrt();
        println!("ρ = {rho:.2}: {mean:.4} ± {error:.4} instead of {truth:.4}");
        assert!((mean - truth).abs() < 3.0 * error && error < 0.1 * truth, "{mean} ± {error} instead of {truth}");
    }
}

/// Truth: the matrix of all pairs of the room alone, which knows neither twins nor neighbours. 4 %:
/// what parts of 1/150 of the room and 32 looks at each of another miss.
#[test]
fn random_rooms_agree_with_the_matrix_of_all_pairs() {
    let mut random = Random(Stream(3));
    for _ in 0..2 {
        let mut room = room(&mut random, 0.3);
        // Off the floor as well: in a slit parts of this size are too coarse for the matrix.
        let lift = 0.2 * (room.upper.y - room.lower.y) * Vec3::Y;
        let block = &mut room.scene.vertices[24..48];
        block.iter_mut().for_each(|vertex| *vertex += lift);
        let reflectances = [random.within(0.3, 0.9), random.within(0.1, 0.9)];
        for (material, rho) in room.scene.materials.iter_mut().zip(reflectances) {
            material.reflectance = Vec3::splat(rho);
        }
        let lamp = room.scene.add_material("lamp", Vec3::splat(0.5), Vec3::ONE);
        room.scene.polygons[4].material = lamp;
        let area: f32 = room.scene.polygons[..6].iter().map(|of| room.scene.area(of)).sum();
        let fineness = Fineness { largest_part: f64::from(area) / 150.0, points: 32, looks: 1 };
        let truth = matrix::radiosities(&room.scene, &Occluders::new(&room.scene), fineness);
        let scene = room.with_others(&mut random);
        for polygon in 0..INSIDE {
            let material = &scene.materials[scene.polygons[polygon as usize].material.0 as usize];
            let found = trace(&scene, random_points_on(&scene, &[polygon], 128, 11), 1);
            let mean = found.irradiance.iter().sum::<DVec3>() / found.irradiance.len() as f64;
            let spread: f64 = found.irradiance.iter().map(|value| (value.x - mean.x).powi(2)).sum();
            let count = found.irradiance.len() as f64;
            let rho = f64::from(material.reflectance.x);
            let value = f64::from(material.emission.x) + rho * mean.x;
            let error = rho * (spread / count / (count - 1.0)).sqrt();
            let truth = truth[polygon as usize].x;
            println!("polygon {polygon}: {value:.4} ± {error:.4} instead of {truth:.4}");
            assert!(
                (value - truth).abs() < 3.0 * error + 0.04 * truth && error < 0.1 * truth,
                "polygon {polygon}: {value} ± {error} instead of {truth}"
            );
        }
    }
}

/// Truth: the path tracer, which shares the scene with the solver and nothing else. Nine tenths of
/// the area are read within the target error; what the walls are doubled with, and a dark
/// neighbour, count as well. Allowed beside it: two standard errors of the percentile by these
/// points, and the reference's own noise.
#[test]
fn random_rooms_keep_the_target_error() {
    const TARGET: f64 = 0.1;
    let mut random = Random(Stream(4));
    let mut in_the_dark = 0;
    for _ in 0..4 {
        let mut room = room(&mut random, 0.1);
        let reflectances = [random.within(0.2, 0.9), random.within(0.1, 0.9)];
        for (material, rho) in room.scene.materials.iter_mut().zip(reflectances) {
            material.reflectance = Vec3::splat(rho);
        }
        let lamp = room.scene.add_material("lamp", Vec3::splat(0.5), Vec3::ONE);
        room.scene.polygons[2 + (random.number() * 4.0) as usize].material = lamp;
        let (scene, occluders) = orient::apply(room.with_others(&mut random), Sides::Front);
        let found = trace(&scene, random_points(&scene, 200, 13), 24);
        let params = SolverParams { error: Some(TARGET), ..SolverParams::usual() };
        let mut solver = Solver::new(Arc::new(scene), Arc::new(occluders), params, 5).expect("usable parameters");
        assert!(solver.run(&CancelToken::new()), "nobody cancels");
        let snapshot = solver.snapshot();
        let mut meter = ErrorMeter::new(Arc::new(found));
        let local = meter.local_error(&snapshot);
        println!("{:.4} ± {:.4} by {:?}", local.p90, local.p90_noise, snapshot.stats.error_estimate);
        assert!(snapshot.stats.error_estimate.is_some_and(|bound| bound <= TARGET), "the certificate");
        let allowed = TARGET + 2.0 * local.p90_noise + local.reference_noise;
        assert!(local.p90 <= allowed && local.p90_noise < TARGET, "{local:?}");
        // No light gets through a wall.
        let reference = meter.reference().clone();
        for (truth, read) in reference.irradiance.iter().zip(meter.irradiances(&snapshot)) {
            if *truth == DVec3::ZERO {
                let read = read.expect("a point of the scene").max_element();
                assert!(read < 1e-4, "{read} W/m² where no light comes");
                in_the_dark += 1;
            }
        }
    }
    assert!(in_the_dark > 20, "{in_the_dark} points where no light comes");
}
