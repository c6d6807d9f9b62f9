//! Faces turned towards the space that sees them: which side of a face is bright ([`Sides`]).
//!
//! Real files are often wound badly. Particles walk through the scene from the eye, or else from
//! the lamps, or else from points in its box; each face that a particle meets is seen from the side
//! it came from. A vote weighs as the square of the way that the particle came, so that the room
//! counts more than a lamp's housing or the gap above it. Votes are whole numbers summed in the
//! particles' order: the result depends on the seed alone, not on the threads.

use glam::Vec3;
use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::{Hit, Occluders, cuts, overlaps};
use crate::base::random::{GOLDEN, Stream};
use crate::scene::{Polygon, Scene, Sides};

/// Rays for each polygon; more would not be seen, fewer leave many faces without a vote.
const RAYS_PER_POLYGON: usize = 4;
/// Bounds of all rays together: 400 k take about 0.15 s on two cores.
const RAYS: std::ops::RangeInclusive<usize> = 16_384..=400_000;
/// Faces that one particle meets at most.
const BOUNCES: usize = 8;
/// Weight of a way as long as the diagonal of the scene's box.
const FULL_WEIGHT: f32 = 1_048_576.0;
/// A face is said to be seen from behind if that was over a way of a hundredth of the diagonal: a
/// particle that slipped into a solid, where two of its parts cross, sees the parts' insides from
/// nearby.
const LEAST_COUNTED: i64 = 105;
/// Seed of the walks; nothing else in the program shares it.
const SEED: u64 = 0x5e1f_1111;

/// A face whose material is two-sided is doubled if this share of what is seen of it, the lesser
/// side's, is no chance.
const LEAST_SHARE: i64 = 20;
/// A face is judged by its own sides where as much as eight long ways saw them, else by those of
/// its surface.
const ENOUGH_SEEN: i64 = 8 * LEAST_COUNTED;
/// Rays that tell whether a scene shows its backs.
const RAYS_FOR_BACKS: u64 = 4096;

/// Makes the scene's faces bright on the sides asked for, and the occluders that go with them.
///
/// `Front` leaves the faces and counts those seen from behind, `Auto` turns these, and `Both`
/// appends each face once more as an opposite patch ([`Polygon::is_back`]); opposite patches that
/// are there already go first. Faces of two-sided materials are turned to the side that is seen,
/// and doubled where both are. Faces that lie on others of the same side are counted once
/// ([`overlaps`]). A luminaire that was placed shines the way that it was placed, whoever sees its
/// back. Occluders stop light from either side in every case.
pub fn apply(mut scene: Scene, sides: Sides) -> (Scene, Occluders) {
    scene.sides = sides;
    scene.polygons.retain(|polygon| !polygon.is_back);
    let is_placed = placed(&scene);
    scene.polygons.iter_mut().for_each(|polygon| polygon.has_back = sides == Sides::Both && !is_placed(polygon));
    turn(&mut scene, sides);
    let covered = overlaps::remove(&mut scene);
    let cut = cuts::cut(&mut scene, sides == Sides::Both);
    (scene.skipped.covered_faces, scene.skipped.cut_faces) = (covered, cut);
    let fronts = scene.polygons.len();
    for index in 0..fronts {
        if scene.polygons[index].has_back {
            let mut back = scene.polygons[index].flipped();
            (back.is_back, back.has_back) = (true, false);
            scene.polygons.push(back);
        }
    }
    // Where the file has a face for either side, no other is needed.
    overlaps::remove_backs(&mut scene, fronts);
    let occluders = Occluders::new(&scene);
    (scene, occluders)
}

/// Whether a polygon belongs to a luminaire that was placed.
fn placed(scene: &Scene) -> impl Fn(&Polygon) -> bool + use<> {
    let materials: Vec<_> = scene.placed_luminaires.iter().map(|luminaire| luminaire.material).collect();
    move |polygon| materials.contains(&polygon.material)
}

/// Turns faces the way that is asked for, each once.
fn turn(scene: &mut Scene, sides: Sides) {
    (scene.skipped.faces_seen_from_behind, scene.skipped.turned_faces) = (0, 0);
    if sides == Sides::Both {
        return;
    }
    let seen = votes(scene, &Occluders::for_few_rays(scene), sides == Sides::Auto);
    let two_sided: Vec<bool> = scene.materials.iter().map(|material| material.is_two_sided).collect();
    let is_two_sided = |polygon: &Polygon| two_sided.get(polygon.material.0 as usize) == Some(&true);
    let needs_surfaces = sides == Sides::Auto || scene.polygons.iter().any(is_two_sided);
    let surfaces = if needs_surfaces { surface_votes(scene, &seen.all) } else { Vec::new() };
    let is_placed = placed(scene);
    let mut turned = 0;
    for (index, polygon) in scene.polygons.iter_mut().enumerate() {
        if is_placed(polygon) {
            continue;
        }
        let net = seen.decisive[index];
        let is_turned = if is_two_sided(polygon) {
            let own = seen.all[index];
            let [front, back] = if own[0] + own[1] >= ENOUGH_SEEN { own } else { surfaces[index] };
            polygon.has_back = LEAST_SHARE * front.min(back) > front + back;
            back > front
        } else if sides == Sides::Auto {
            let [front, back] = surfaces[index];
            if net != 0 { net < 0 } else { back > front }
        } else {
            scene.skipped.faces_seen_from_behind += usize::from(net <= -LEAST_COUNTED);
            false
        };
        if is_turned {
            *polygon = polygon.flipped();
            // The file means both sides of a two-sided face: its winding says nothing.
            turned += usize::from(!is_two_sided(polygon));
        }
    }
    scene.skipped.turned_faces = turned;
}

/// Whether the inside of a scene shows backs, nearly everywhere: its faces are wound the other way
/// round.
pub fn shows_backs(scene: &Scene, occluders: &Occluders) -> bool {
    let (lower, upper) = scene.bounds();
    let look = |ray: u64| {
        let mut random = Random::new(SEED ^ (3 << 48) ^ ray);
        let (origin, direction) = (random.point(lower, upper), random.direction());
        // What is seen one way alone is no inside.
        occluders.first_hit(origin, -direction)?;
        Some(!occluders.first_hit(origin, direction)?.front)
    };
    let seen: Vec<bool> = (0..RAYS_FOR_BACKS).into_par_iter().filter_map(look).collect();
    let backs = seen.iter().filter(|is_back| **is_back).count();
    // Insides of furniture are backs too; a room has more of its own air.
    4 * backs > 3 * seen.len() && 8 * seen.len() > RAYS_FOR_BACKS as usize
}

/// How faces are seen, by the weights of the particles that met them.
struct Seen {
    /// For each polygon, how much more it is seen from its bright side than from behind; 0 where
    /// nothing tells.
    decisive: Vec<i64>,
    /// For each polygon, how much it is seen from its bright side and from behind, by all
    /// particles.
    all: Vec<[i64; 2]>,
}

/// Looks at all faces.
///
/// Faces that the eye's particles see are decided by these alone: a lamp may lie in a housing, the
/// eye lies in the space that the picture shows. `lamp_backs` says whether particles leave the dark
/// sides of lamps too, which matters where lamps may be turned the wrong way; where they are right,
/// it would show the inside of their housings.
fn votes(scene: &Scene, occluders: &Occluders, lamp_backs: bool) -> Seen {
    let rays = (RAYS_PER_POLYGON * scene.polygons.len()).clamp(*RAYS.start(), *RAYS.end());
    let walks = Walks::new(scene, occluders);
    let particles = rays / BOUNCES;
    let net = |seen: &[[i64; 2]]| seen.iter().map(|[front, back]| front - back).collect::<Vec<i64>>();
    let mut all = vec![[0; 2]; scene.polygons.len()];
    let mut add = |seen: Vec<[i64; 2]>| {
        let votes = net(&seen);
        all.iter_mut().zip(seen).for_each(|(all, [front, back])| *all = [all[0] + front, all[1] + back]);
        votes
    };
    let mut decisive = vec![0; scene.polygons.len()];
    let lamps = Lamps::new(scene);
    if scene.camera.is_some() {
        decisive = add(walks.run(particles, 0, |random| walks.start_at_eye(random)));
        if let Some(lamps) = &lamps {
            let from_lamps = add(walks.run(particles / 2, 1, |random| walks.start_at_lamp(lamps, lamp_backs, random)));
            for (vote, other) in decisive.iter_mut().zip(from_lamps) {
                *vote = if *vote == 0 { other } else { *vote };
            }
        }
    }
    if decisive.iter().all(|vote| *vote == 0) {
        decisive = add(match &lamps {
            Some(lamps) => walks.run(particles, 1, |random| walks.start_at_lamp(lamps, lamp_backs, random)),
            None => walks.run(particles, 2, |random| walks.start_in_box(random)),
        });
    }
    Seen { decisive, all }
}

/// Diffuse walks through a scene.
struct Walks<'a> {
    scene: &'a Scene,
    occluders: &'a Occluders,
    lower: Vec3,
    upper: Vec3,
    diagonal: f32,
}

impl<'a> Walks<'a> {
    fn new(scene: &'a Scene, occluders: &'a Occluders) -> Self {
        let (lower, upper) = scene.bounds();
        let diagonal = lower.distance(upper).max(f32::MIN_POSITIVE);
        Self { scene, occluders, lower, upper, diagonal }
    }

    /// Sends particles and sums their votes for fronts and for backs; `start` tells what each meets
    /// first, and `stream` tells apart the random numbers of several runs.
    fn run<S>(&self, particles: usize, stream: u64, start: S) -> Vec<[i64; 2]>
    where
        S: Fn(&mut Random) -> Option<Hit> + Sync,
    {
        let hits: Vec<(u32, i32)> = (0..particles as u64)
            .into_par_iter()
            .flat_map_iter(|particle| {
                let mut random = Random::new(SEED ^ (stream << 48) ^ particle);
                let first = start(&mut random);
                let mut hits = Vec::new();
                self.walk(first, &mut random, &mut hits);
                hits
            })
            .collect();
        let mut votes = vec![[0; 2]; self.scene.polygons.len()];
        for (polygon, vote) in hits {
            votes[polygon as usize][usize::from(vote < 0)] += i64::from(vote.abs());
        }
        votes
    }

    fn walk(&self, mut met: Option<Hit>, random: &mut Random, hits: &mut Vec<(u32, i32)>) {
        for _ in 0..BOUNCES {
            let Some(hit) = met else { return };
            let weight = (FULL_WEIGHT * (hit.distance / self.diagonal).min(1.0).powi(2)) as i32 + 1;
            hits.push((hit.polygon, if hit.front { weight } else { -weight }));
            let normal = self.scene.normal(&self.scene.polygons[hit.polygon as usize]);
            let facing = if hit.front { normal } else { -normal };
            if facing == Vec3::ZERO {
                return;
            }
            met = self.occluders.ray_from(hit.point, facing, random.around(facing));
        }
    }

    /// From the eye towards a point in the scene's box, so that an eye outside it meets something.
    fn start_at_eye(&self, random: &mut Random) -> Option<Hit> {
        let eye = self.scene.camera?.eye;
        let direction = (random.point(self.lower, self.upper) - eye).try_normalize()?;
        self.occluders.first_hit(eye, direction)
    }

    /// From a lamp, on its bright side or on either.
    fn start_at_lamp(&self, lamps: &Lamps, lamp_backs: bool, random: &mut Random) -> Option<Hit> {
        let polygon = &self.scene.polygons[lamps.pick(random.unit()) as usize];
        let ([a, b, c, d], count) = self.scene.corner_positions(polygon);
        let [b, c] = if count == 4 && random.unit() < 0.5 { [c, d] } else { [b, c] };
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let normal = self.scene.normal(polygon);
        let side = if random.unit() < 0.5 && lamp_backs { -normal } else { normal };
        let point = a + u * (b - a) + v * (c - a);
        if side == Vec3::ZERO { None } else { self.occluders.ray_from(point, side, random.around(side)) }
    }

    fn start_in_box(&self, random: &mut Random) -> Option<Hit> {
        self.occluders.first_hit(random.point(self.lower, self.upper), random.direction())
    }
}

/// The faces that emit, picked in proportion to their power.
struct Lamps {
    polygons: Vec<u32>,
    /// Power up to and including each.
    cumulative: Vec<f64>,
}

impl Lamps {
    fn new(scene: &Scene) -> Option<Self> {
        let mut lamps = Self { polygons: Vec::new(), cumulative: Vec::new() };
        let mut sum = 0.0;
        for (index, polygon) in scene.polygons.iter().enumerate() {
            let emission = scene.surface(polygon).emission.max_element();
            if emission > 0.0 {
                sum += f64::from(scene.area(polygon)) * f64::from(emission);
                lamps.polygons.push(index as u32);
                lamps.cumulative.push(sum);
            }
        }
        (sum > 0.0).then_some(lamps)
    }

    fn pick(&self, unit: f32) -> u32 {
        let power = self.cumulative.last().copied().unwrap_or_default() * f64::from(unit);
        let index = self.cumulative.partition_point(|up_to| *up_to <= power);
        self.polygons[index.min(self.polygons.len() - 1)]
    }
}

/// For each polygon the votes of all polygons of its surface: those that meet in edges which they
/// run through in opposite directions, and so are wound alike. A face that no particle met follows
/// its surface.
fn surface_votes(scene: &Scene, votes: &[[i64; 2]]) -> Vec<[i64; 2]> {
    let mut surfaces = UnionFind::new(scene.polygons.len());
    let mut polygon_at_edge = FxHashMap::default();
    polygon_at_edge.reserve(4 * scene.polygons.len());
    for (index, polygon) in scene.polygons.iter().enumerate() {
        for edge in edges(polygon) {
            polygon_at_edge.insert(edge, index);
        }
    }
    for (index, polygon) in scene.polygons.iter().enumerate() {
        for (from, to) in edges(polygon) {
            if let Some(&neighbour) = polygon_at_edge.get(&(to, from)) {
                surfaces.union(index, neighbour);
            }
        }
    }
    let surface_of = surfaces.into_labeling();
    let mut sums = vec![[0_i64; 2]; votes.len()];
    for (surface, [front, back]) in surface_of.iter().zip(votes) {
        let sum = &mut sums[*surface];
        *sum = [sum[0] + front, sum[1] + back];
    }
    surface_of.iter().map(|surface| sums[*surface]).collect()
}

fn edges(polygon: &Polygon) -> impl Iterator<Item = (u32, u32)> + '_ {
    let corners = polygon.corners();
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// The random numbers of one particle.
struct Random(Stream);

impl Random {
    /// Seeds in a row start as far apart in the stream as others do.
    fn new(seed: u64) -> Self {
        let mut stream = Stream(seed.wrapping_mul(GOLDEN));
        stream.bits();
        Self(stream)
    }

    /// Uniform in 0..1.
    fn unit(&mut self) -> f32 {
        self.0.unit()
    }

    fn point(&mut self, lower: Vec3, upper: Vec3) -> Vec3 {
        lower + (upper - lower) * Vec3::new(self.unit(), self.unit(), self.unit())
    }

    /// Uniform over the sphere.
    fn direction(&mut self) -> Vec3 {
        let z = 1.0 - 2.0 * self.unit();
        let angle = std::f32::consts::TAU * self.unit();
        let radius = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(radius * angle.cos(), radius * angle.sin(), z)
    }

    /// Cosine-weighted around a unit normal.
    fn around(&mut self, normal: Vec3) -> Vec3 {
        (normal + self.direction()).try_normalize().unwrap_or(normal)
    }
}

#[cfg(test)]
mod tests;
