//! Irradiance of a work plane: each point looks around itself for what its surroundings send.
//!
//! Where there is a gathered field, the points ask its estimator, as probes do. Over a bare mesh,
//! the light of lamps is found by their exact form factors, times the share of rays to them that
//! come through, and what everything reflects by rays of density cosθ/π, whose mean radiosity is
//! the irradiance. Both are the same on every run.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::grid::{Grid, GridError, WorkPlane};
use super::lit_mesh::{LitMesh, Met};
use crate::base::photometry::{LUMENS_PER_WATT, lux};
use crate::base::random::{cosine_direction, hash64, r2_sequence};
use crate::geometry::point_to_polygon;
use crate::hierarchy::point_on_polygon;
use crate::read::daylight_factor::{NoDaylightFactor, open_ground};
use crate::scene::{Polygon, Scene};
use crate::solve::Snapshot;

/// Rays by which a point looks around itself over a bare mesh: reflected light of a room comes out
/// within a percent.
const RAYS: u32 = 512;
/// Rays that tell whether a point lies inside of something, where the field tells its light.
const INSIDE_RAYS: u32 = 64;
/// Rays from a point to all lamps together; the brighter a lamp, the more of them it gets.
const LAMP_RAYS: f32 = 256.0;
/// Rays from a point to the sky: through a small window one in a hundred finds it.
const SKY_RAYS: u32 = 2048;
/// Rays from a point to the sun's disc.
const SUN_RAYS: u32 = 64;
/// Each lamp gets so many at most.
const MOST_LAMP_RAYS: u32 = 128;
/// A ray to the floor is slanted by this, for one straight down may slip through along the
/// diagonals of quads.
const SLANT: [f32; 2] = [0.0113, 0.0171];
/// A point this share of the plane's height below a table's top (2 cm) is read on it.
const RESTS: f32 = 0.025;
/// Points that are measured at once.
const CHUNK: usize = 32;
/// Seed of all rays.
const SEED: u64 = 0x5e1f_11ae;

/// A work plane as it was measured.
#[derive(Clone, Debug)]
pub struct PlaneReading {
    /// The plane.
    pub plane: WorkPlane,
    /// Points of the plane.
    pub grid: Grid,
    /// Irradiance E of each point, W/m²; `None` inside of something and outside of the room.
    pub values: Vec<Option<Vec3>>,
    /// Standard error of each E, W/m², where it was gathered.
    pub standard_errors: Vec<Option<Vec3>>,
    /// Zero of the points' coordinates in those of the scene's file.
    pub origin: DVec3,
    /// The light that was measured.
    pub snapshot: Arc<Snapshot>,
    /// Irradiance of open horizontal ground, W/m², weighted as the eye does, or why it does not
    /// count.
    pub open_ground: Result<f32, NoDaylightFactor>,
}

/// Figures that planners ask of a work plane; illuminances in lx.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Points measured.
    pub points: usize,
    /// Points left out, inside of furniture or outside of the room.
    pub left_out: usize,
    /// Mean illuminance Ē, lx.
    pub average: f32,
    /// Smallest illuminance, lx.
    pub minimum: f32,
    /// Largest illuminance, lx.
    pub maximum: f32,
    /// U₀: the smallest over the mean (EN 12464-1); 0 where it is dark.
    pub uniformity: f32,
    /// Mean and smallest daylight factor: illuminance over that of open ground (EN 17037). Only
    /// where the sky alone shines, neither lamps nor the sun.
    pub daylight_factor: Option<[f32; 2]>,
}

impl PlaneReading {
    /// Average, minimum, maximum and uniformity.
    pub fn summary(&self) -> Summary {
        let measured: Vec<f32> = self.values.iter().flatten().map(|value| lux(value.to_array())).collect();
        let left_out = self.values.len() - measured.len();
        if measured.is_empty() {
            return Summary { left_out, ..Summary::default() };
        }
        let sum: f64 = measured.iter().map(|value| f64::from(*value)).sum();
        let average = (sum / measured.len() as f64) as f32;
        let minimum = measured.iter().copied().fold(f32::INFINITY, f32::min);
        let maximum = measured.iter().copied().fold(0.0, f32::max);
        let uniformity = if average > 0.0 { minimum / average } else { 0.0 };
        let daylight_factor =
            self.open_ground.ok().map(|open| [average, minimum].map(|lx| lx / (LUMENS_PER_WATT * open)));
        Summary { points: measured.len(), left_out, average, minimum, maximum, uniformity, daylight_factor }
    }
}

/// A work plane in the making.
pub struct Measuring<'a> {
    lit: &'a LitMesh,
    lamps: Vec<&'a Polygon>,
    plane: WorkPlane,
    grid: Grid,
    /// Unit vector to the floor.
    down: Vec3,
    error: f32,
    values: Vec<Option<Value>>,
}

/// Irradiance of a point, W/m², and its standard error where it was gathered.
type Value = (Vec3, Option<Vec3>);

impl<'a> Measuring<'a> {
    /// Begins with a plane, whose points are gathered to a standard error that is this share of the
    /// light there.
    ///
    /// # Errors
    /// A plane that cannot be measured in this scene.
    pub fn new(lit: &'a LitMesh, plane: WorkPlane, error: f32) -> Result<Self, GridError> {
        let grid = plane.grid(lit.scene())?;
        let values = Vec::with_capacity(grid.points.len());
        let (across, along) = grid.up.any_orthonormal_pair();
        let down = (SLANT[0] * across + SLANT[1] * along - grid.up).normalize();
        Ok(Self { lit, lamps: lamps(lit.scene()), plane, grid, down, error, values })
    }

    /// Measures a few more points, which takes some 20 ms; false when all are done.
    pub fn advance(&mut self) -> bool {
        let from = self.values.len();
        let chunk = &self.grid.points[from..self.grid.points.len().min(from + CHUNK)];
        let of_point = |(index, point): (usize, &Vec3)| self.value(*point, hash64(SEED, (from + index) as u64));
        let values: Vec<Option<Value>> = chunk.par_iter().enumerate().map(of_point).collect();
        self.values.extend(values);
        self.values.len() < self.grid.points.len()
    }

    /// The share of the points that is measured.
    pub fn share(&self) -> f32 {
        self.values.len() as f32 / self.grid.points.len().max(1) as f32
    }

    /// Irradiance of a small level area; `None` inside of something and where there is no floor.
    fn value(&self, point: Vec3, seed: u64) -> Option<Value> {
        let (lit, normal) = (self.lit, self.grid.up);
        let point = match self.rests_on(point) {
            Some(place) => place,
            None if matches!(lit.met((point, normal), self.down), Met::Front(_)) => point,
            None => return None,
        };
        if let Some(field) = lit.snapshot().field.as_ref() {
            if field.is_shut_in((point, normal), seed, INSIDE_RAYS) {
                return None;
            }
            let read = field.irradiance_at((point, normal), self.error, seed);
            return Some((read.mean, Some(read.standard_error)));
        }
        let (mut sent, mut backs) = (Vec3::ZERO, 0);
        for ray in 0..RAYS {
            let [u, v] = r2_sequence(seed, ray);
            match lit.met((point, normal), cosine_direction(normal, u, v)) {
                Met::Front(radiosity) => sent += radiosity,
                Met::Back => backs += 1,
                Met::Nothing => {}
            }
        }
        if 2 * backs >= RAYS {
            return None;
        }
        let others = from_lamps(lit, &self.lamps, point, normal, seed) + from_outside(lit, point, normal, seed);
        Some((sent / RAYS as f32 + others, None))
    }

    /// The place right above a point that lies on a level face or a little below it, such as a
    /// table's top: an instrument would stand there.
    fn rests_on(&self, point: Vec3) -> Option<Vec3> {
        let up = self.grid.up;
        let reach = (RESTS * self.plane.height).max(self.lit.tolerance());
        let from = point + reach * up;
        let place = self.lit.level_face_below(from, self.down, up)?;
        let height = (place - point).dot(up);
        (height >= -self.lit.tolerance().min(0.1 * reach)).then(|| point + height * up)
    }

    /// The reading of the measured points; the others count as left out.
    pub fn finish(mut self) -> PlaneReading {
        self.values.resize(self.grid.points.len(), None);
        PlaneReading {
            plane: self.plane,
            grid: self.grid,
            values: self.values.iter().map(|value| value.map(|(irradiance, _)| irradiance)).collect(),
            standard_errors: self.values.iter().map(|value| value.and_then(|(_, error)| error)).collect(),
            origin: self.lit.scene().origin,
            snapshot: self.lit.snapshot().clone(),
            open_ground: open_ground(self.lit.scene()),
        }
    }
}

/// Measures a plane; see [`Measuring::new`].
///
/// # Errors
/// A plane that cannot be measured in this scene.
pub fn measure(lit: &LitMesh, plane: WorkPlane, error: f32) -> Result<PlaneReading, GridError> {
    let mut measuring = Measuring::new(lit, plane, error)?;
    while measuring.advance() {}
    Ok(measuring.finish())
}

/// Polygons that emit.
fn lamps(scene: &Scene) -> Vec<&Polygon> {
    let emits = |polygon: &&Polygon| scene.emits(polygon);
    scene.polygons.iter().filter(emits).collect()
}

/// Irradiance by the sky and the sun: one half of the rays to the sky has density cosθ/π, the other
/// is drawn by its radiance.
fn from_outside(lit: &LitMesh, point: Vec3, normal: Vec3, seed: u64) -> Vec3 {
    let Some(outside) = lit.scene().outside() else { return Vec3::ZERO };
    let mut light = Vec3::ZERO;
    for ray in 0..if outside.has_sky() { SKY_RAYS } else { 0 } {
        let numbers = r2_sequence(hash64(seed, 1 << 40), ray / 2);
        let direction = match ray % 2 {
            0 => Some(cosine_direction(normal, numbers[0], numbers[1])),
            _ => outside.draw(numbers).map(|drawn| drawn.direction),
        };
        let Some(direction) = direction else { continue };
        let cosine = normal.dot(direction);
        if cosine > 0.0 && matches!(lit.met((point, normal), direction), Met::Nothing) {
            let density = 0.5 * (cosine / PI + outside.density(direction));
            light += cosine / density / SKY_RAYS as f32 * outside.radiance(direction);
        }
    }
    if let Some(sun) = outside.sun() {
        for ray in 0..SUN_RAYS {
            let direction = sun.at(r2_sequence(hash64(seed, 2 << 40), ray));
            let cosine = normal.dot(direction);
            if cosine > 0.0 && matches!(lit.met((point, normal), direction), Met::Nothing) {
                light += cosine / SUN_RAYS as f32 * sun.irradiance;
            }
        }
    }
    light
}

/// Irradiance by what lamps emit themselves.
fn from_lamps(lit: &LitMesh, lamps: &[&Polygon], point: Vec3, normal: Vec3, seed: u64) -> Vec3 {
    let scene = lit.scene();
    let unoccluded = |lamp: &&Polygon| {
        let (corners, count) = scene.corner_positions(lamp);
        point_to_polygon(point, normal, &corners[..count]) * scene.surface(lamp).emission
    };
    let bare: Vec<Vec3> = lamps.iter().map(unoccluded).collect();
    let total: f32 = bare.iter().map(|light| light.max_element()).sum();
    let mut light = Vec3::ZERO;
    for (index, (lamp, bare)) in lamps.iter().zip(bare).enumerate().filter(|(_, (_, bare))| *bare != Vec3::ZERO) {
        let rays = (LAMP_RAYS * bare.max_element() / total).ceil().clamp(1.0, MOST_LAMP_RAYS as f32) as u32;
        light += visible_share(lit, lamp, (point, normal), rays, hash64(seed, index as u64 + 1)) * bare;
    }
    light
}

/// How much of a lamp's light comes through, by so many rays.
fn visible_share(lit: &LitMesh, lamp: &Polygon, (point, normal): (Vec3, Vec3), rays: u32, seed: u64) -> f32 {
    let lamp_normal = lit.scene().normal(lamp);
    let (corners, count) = lit.scene().corner_positions(lamp);
    let (mut through, mut all) = (0.0, 0.0);
    for ray in 0..rays {
        let [u, v] = r2_sequence(seed, ray);
        let on_lamp = point_on_polygon(&corners[..count], u, v);
        let span = on_lamp - point;
        let distance_squared = span.length_squared();
        let weight = normal.dot(span).max(0.0) * (-lamp_normal.dot(span)).max(0.0) / distance_squared.powi(2);
        if weight > 0.0 && weight.is_finite() {
            all += weight;
            through += if lit.sees((point, normal), (on_lamp, lamp_normal)) { weight } else { 0.0 };
        }
    }
    if all > 0.0 { through / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::accuracy::closed_forms::{self, closed_room};
    use crate::measure::stability::scenes::add_box;
    use crate::scene::GroupId;
    use crate::solve::{Solver, SolverParams};

    fn lit(scene: Scene) -> LitMesh {
        let scene = Arc::new(scene);
        let snapshot = Solver::solved(scene.clone(), SolverParams::default()).snapshot();
        LitMesh::new(scene, Arc::new(snapshot))
    }

    /// A room of 4 × 3 × 4 with these walls, floor at y = 0; faces look inside.
    fn room(reflectance: f32, emission: f32) -> Scene {
        let mut scene = Scene::new("room");
        let wall = scene.add_material("wall", Vec3::splat(reflectance), Vec3::splat(emission));
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 3.0, 4.0)), true, (wall, GroupId(0)));
        scene
    }

    /// Truth: Lambert's formula. A small lamp below the ceiling of a black room gives points of a
    /// plane below it E = B_e·F; one of them lies in the shade of nothing.
    #[test]
    fn a_lamp_in_a_black_room_lights_the_plane_as_its_form_factor_says() {
        let mut scene = room(0.0, 0.0);
        let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(1000.0));
        let at = |x: f32, z: f32| Vec3::new(x, 2.9, z);
        let corners = [at(1.8, 1.8), at(2.2, 1.8), at(2.2, 2.2), at(1.8, 2.2)];
        scene.add_quad(corners, lamp, GroupId(0));
        let found = measure(&lit(scene), WorkPlane { height: 0.8, spacing: 0.5, margin: 0.5, area: None }, 0.01)
            .expect("a floor");
        assert_eq!((found.grid.counts, found.summary().left_out), ([6, 6], 0));
        for (point, value) in found.grid.points.iter().zip(&found.values) {
            let corners = corners.map(|corner| corner.as_dvec3());
            let truth = 1000.0 * closed_forms::point_to_polygon(point.as_dvec3(), DVec3::Y, &corners);
            let value = f64::from(value.expect("in the room").y);
            assert!((value / truth - 1.0).abs() < 2e-4, "{point}: {value} instead of {truth}");
        }
        let summary = found.summary();
        let [least, mean] = [summary.minimum, summary.average];
        assert!((summary.uniformity - least / mean).abs() < 1e-6 && summary.maximum > mean && least > 0.0);
    }

    /// Truth: the number of points in a part. So a plane is given up within so many points, however
    /// large it is.
    #[test]
    fn a_part_of_a_plane_is_a_few_points() {
        let lit = lit(room(0.5, 1.0));
        let plane = WorkPlane { height: 0.8, spacing: 0.05, margin: 0.5, area: None };
        let mut measuring = Measuring::new(&lit, plane, 0.02).expect("a usable plane");
        let points = measuring.grid.points.len();
        assert!(measuring.advance() && points > 50 * CHUNK, "{points}");
        assert_eq!(measuring.values.len(), CHUNK);
    }

    /// Truth: a table's top is no inside. The plane that it lies in, and one a little below that,
    /// are read on it; its light is that of a plane just above.
    #[test]
    fn a_plane_at_a_tables_top_is_read_on_it() {
        let mut scene = room(0.5, 0.0);
        let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(100.0));
        let at = |x: f32, z: f32| Vec3::new(x, 2.9, z);
        scene.add_quad([at(1.5, 1.5), at(2.5, 1.5), at(2.5, 2.5), at(1.5, 2.5)], lamp, GroupId(0));
        let wall = scene.material_named("wall").expect("there");
        let (lower, upper) = (Vec3::new(1.0, 0.71, 1.0), Vec3::new(3.0, 0.75, 2.0));
        add_box(&mut scene, (lower, upper), false, (wall, GroupId(0)));
        let lit = lit(scene);
        let at_height = |height: f32| {
            let plane = WorkPlane { height, spacing: 0.3, margin: 0.3, area: None };
            measure(&lit, plane, 0.01).expect("a floor")
        };
        let above = at_height(0.751);
        assert_eq!(above.summary().left_out, 0);
        for height in [0.75, 0.74] {
            let found = at_height(height);
            assert_eq!(found.summary().left_out, 0, "{height}");
            let [found, above] = [&found, &above].map(|reading| reading.summary().average);
            // Each point is known within a percent or two.
            assert!((found / above - 1.0).abs() < 0.01, "{height}: {found} {above}");
        }
        assert!(at_height(0.72).summary().left_out > 0, "deep inside");
    }

    /// Truth: a closed room that glows evenly has E = B_e/(1 − ρ) everywhere, in the air as on its
    /// walls. A box in it is left out where the plane runs through it, and takes no light from the
    /// rest: it glows like the walls.
    #[test]
    fn a_furnace_is_as_bright_in_the_air_and_the_inside_of_things_is_left_out() {
        let mut scene = room(0.5, 1.0);
        let wall = scene.material_named("wall").expect("there");
        let (lower, upper) = (Vec3::new(0.9, 0.0, 0.9), Vec3::new(2.1, 1.0, 2.1));
        add_box(&mut scene, (lower, upper), false, (wall, GroupId(0)));
        let truth = closed_room(1.0, 1.0, 0.5) as f32;
        let found = measure(&lit(scene), WorkPlane { height: 0.8, spacing: 0.4, margin: 0.0, area: None }, 0.01)
            .expect("a floor");
        let (mut inside, mut worst, mut sum) = (0, 0.0_f32, 0.0);
        for (point, value) in found.grid.points.iter().zip(&found.values) {
            let is_inside = point.cmpgt(lower).all() && point.cmplt(upper).all();
            assert_eq!(value.is_none(), is_inside, "{point}");
            inside += usize::from(is_inside);
            let difference = value.map_or(0.0, |value| value.y / truth - 1.0);
            (worst, sum) = (worst.max(difference.abs()), sum + difference);
        }
        assert_eq!((inside, found.summary().left_out), (9, 9));
        // Beside the box, lamps are hidden in part: the share that is seen is known by a few dozen
        // rays each.
        let mean = sum / (found.values.len() - inside) as f32;
        assert!(worst < 0.03 && mean.abs() < 0.005, "{worst} {mean}");
    }
}
