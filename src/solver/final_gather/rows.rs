//! Rows: what each vertex sees of the lit mesh, as the places where rays into its half space end.
//!
//! A row is a Monte Carlo estimate of the form factors of a vertex to everything, visibility and all: cosine-weighted
//! directions make each place that a ray meets count alike. Rows are kept, so that light can be gathered over them as often as it takes
//! to converge, without another ray.

use glam::Vec3;
use rayon::prelude::*;

use super::super::display::Display;
use super::lamps::Sent;
use super::stance::Stance;
use crate::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::hierarchy::{ElementId, Hierarchy};
use crate::random::{cosine_direction, even_point, fraction, mix};

/// Memory that rows may take, bytes.
const MOST_BYTES: usize = 1 << 29;

/// Where a ray ended.
#[derive(Clone, Copy, Debug)]
struct Hit {
    /// Index into the mesh; [`NOWHERE`] where no light comes from.
    triangle: u32,
    /// Weights of its second and third corner.
    weights: [u16; 2],
}

const NOWHERE: u32 = u32::MAX;

/// One pass: some rays from each vertex.
struct Pass {
    /// Where the rays of each vertex start; one longer than the number of vertices.
    starts: Vec<u32>,
    hits: Vec<Hit>,
}

/// What all passes know.
#[derive(Default)]
pub struct Rows {
    passes: Vec<Pass>,
    /// Rays of each vertex so far.
    counts: Vec<u32>,
}

/// What rays are cast against.
pub struct Surroundings<'a> {
    pub display: &'a Display,
    pub hierarchy: &'a Hierarchy,
    pub occluders: &'a Occluders,
    /// Of each vertex.
    pub stances: &'a [Box<[Stance]>],
    /// The initial patch of each polygon.
    pub patches: &'a [ElementId],
    /// What shines; some of it comes by other rays.
    pub sent: &'a Sent,
    pub seed: u64,
}

/// The rays of some vertices in a row.
pub struct Chunk(Vec<Hit>);

impl Rows {
    /// Starts anew for so many vertices.
    pub fn new(vertices: usize) -> Self {
        Self { passes: Vec::new(), counts: vec![0; vertices] }
    }

    /// Opens a pass with so many rays from each vertex.
    pub fn open(&mut self, rays: &[u32]) {
        let mut starts = vec![0];
        let mut sum = 0;
        starts.extend(rays.iter().map(|rays| {
            sum += rays;
            sum
        }));
        self.passes.push(Pass { starts, hits: Vec::with_capacity(sum as usize) });
    }

    /// Casts the rays of a range of vertices of the open pass; `None` if there is none, or if cancelled.
    pub fn cast(&self, around: &Surroundings, vertices: std::ops::Range<usize>, cancel: &CancelToken) -> Option<Chunk> {
        let pass = self.passes.last()?;
        let looked: Vec<Vec<Hit>> = vertices
            .into_par_iter()
            .with_min_len(16)
            .map(|vertex| {
                let count = pass.starts[vertex + 1] - pass.starts[vertex];
                (!cancel.is_cancelled()).then(|| around.look(vertex, self.counts[vertex], count))
            })
            .collect::<Option<_>>()?;
        Some(Chunk(looked.into_iter().flatten().collect()))
    }

    /// Takes over what [`Self::cast`] found for a range of vertices.
    pub fn take(&mut self, vertices: std::ops::Range<usize>, chunk: Chunk) {
        let Some(pass) = self.passes.last_mut() else { return };
        pass.hits.extend(chunk.0);
        for vertex in vertices {
            self.counts[vertex] += pass.starts[vertex + 1] - pass.starts[vertex];
        }
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.counts.iter().map(|count| u64::from(*count)).sum()
    }

    /// Rays of a vertex.
    pub fn rays_of(&self, vertex: usize) -> u32 {
        self.counts[vertex]
    }

    /// The triangles that the rays of a vertex ended on.
    pub fn seen_by(&self, vertex: usize) -> impl Iterator<Item = u32> {
        let hits = self.passes.iter().flat_map(move |pass| pass.hits_of(vertex));
        hits.map(|hit| hit.triangle).filter(|triangle| *triangle != NOWHERE)
    }

    /// Variance of the light along one ray of a vertex, of all colours, (W/m²)².
    pub fn variance(&self, vertex: usize, display: &Display, reflected: &[Vec3]) -> f32 {
        let light = |hit: &Hit| hit.light(display, reflected).element_sum();
        let hits = self.passes.iter().flat_map(|pass| pass.hits_of(vertex)).map(light);
        let (sum, squares) = hits.fold((0.0, 0.0), |(sum, squares), light| (sum + light, squares + light * light));
        let mean = sum / self.counts[vertex] as f32;
        (squares / self.counts[vertex] as f32 - mean * mean).max(0.0)
    }

    /// A pass's share of all rays.
    pub fn share_of(&self, pass: usize) -> f64 {
        self.passes[pass].hits.len() as f64 / self.rays().max(1) as f64
    }

    /// Whether memory allows for as many rays again.
    pub fn has_room(&self) -> bool {
        self.bytes() <= MOST_BYTES / 2
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        let of_pass = |pass: &Pass| size_of_val(&pass.hits[..]) + size_of_val(&pass.starts[..]);
        self.passes.iter().map(of_pass).sum::<usize>() + size_of_val(&self.counts[..])
    }

    /// Rays that so many bytes hold beside the least of each vertex, in a pass over so many vertices.
    pub fn room_in(bytes: usize, vertices: usize, least: usize) -> usize {
        let of_vertex = size_of::<u32>() + (least + 1) * size_of::<Hit>();
        bytes.saturating_sub(vertices * of_vertex) / size_of::<Hit>()
    }

    /// Number of passes.
    pub fn passes(&self) -> usize {
        self.passes.len()
    }

    /// Irradiance of each vertex from what the vertices reflect (W/m²), over all passes; `None` if cancelled.
    pub fn gather(&self, display: &Display, reflected: &[Vec3], cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let of_vertex = |vertex: usize| {
            let sum: Vec3 = self.passes.iter().map(|pass| pass.sum(vertex, display, reflected)).sum();
            (!cancel.is_cancelled()).then(|| sum / self.counts[vertex].max(1) as f32)
        };
        (0..self.counts.len()).into_par_iter().with_min_len(512).map(of_vertex).collect()
    }

    /// The same over one pass alone.
    pub fn gather_pass(
        &self,
        pass: usize,
        display: &Display,
        reflected: &[Vec3],
        cancel: &CancelToken,
    ) -> Option<Vec<Vec3>> {
        let pass = &self.passes[pass];
        let of_vertex = |vertex: usize| {
            let count = pass.starts[vertex + 1] - pass.starts[vertex];
            (!cancel.is_cancelled()).then(|| pass.sum(vertex, display, reflected) / count.max(1) as f32)
        };
        (0..self.counts.len()).into_par_iter().with_min_len(512).map(of_vertex).collect()
    }
}

impl Pass {
    fn hits_of(&self, vertex: usize) -> &[Hit] {
        &self.hits[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    fn sum(&self, vertex: usize, display: &Display, reflected: &[Vec3]) -> Vec3 {
        self.hits_of(vertex).iter().map(|hit| hit.light(display, reflected)).sum()
    }
}

impl Hit {
    /// What is reflected there, W/m².
    fn light(&self, display: &Display, reflected: &[Vec3]) -> Vec3 {
        if self.triangle == NOWHERE {
            return Vec3::ZERO;
        }
        let [a, b, c] = display.mesh.triangles[self.triangle as usize].map(|corner| reflected[corner as usize]);
        let [second, third] = self.weights.map(|weight| f32::from(weight) / f32::from(u16::MAX));
        a + second * (b - a) + third * (c - a)
    }
}

impl Surroundings<'_> {
    /// Rays number `done..done + count` of a vertex.
    fn look(&self, vertex: usize, done: u32, count: u32) -> Vec<Hit> {
        let seed = mix(mix(self.seed, 0x6761_7468_6572), position_hash(self.display, vertex));
        let start = [seed as u32, (seed >> 32) as u32];
        let stances = &self.stances[vertex];
        let hit = |index: u32| {
            let [u, v] = even_point(seed, index);
            // Every ray counts alike, so the stances take their turns by their weights.
            let pick = fraction((start[0] ^ start[1]).wrapping_add(2_654_435_769_u32.wrapping_mul(index)));
            let mut rest = pick;
            let stance = stances.iter().find(|stance| {
                rest -= stance.weight;
                rest < 0.0
            });
            let Some(stance) = stance.or(stances.last()) else { return Hit { triangle: NOWHERE, weights: [0; 2] } };
            let direction = cosine_direction(stance.normal, u, v);
            self.follow((stance.position, stance.normal), direction)
        };
        (done..done + count).map(hit).collect()
    }

    /// Irradiance at a point of what the vertices reflect (W/m²), by so many rays.
    pub fn light_at(&self, point: Vec3, normal: Vec3, seed: u64, rays: u32, reflected: &[Vec3]) -> Vec3 {
        let light = |index: u32| {
            let [u, v] = even_point(seed, index);
            self.follow((point, normal), cosine_direction(normal, u, v)).light(self.display, reflected)
        };
        (0..rays).map(light).sum::<Vec3>() / rays.max(1) as f32
    }

    fn follow(&self, (point, normal): (Vec3, Vec3), direction: Vec3) -> Hit {
        let nowhere = Hit { triangle: NOWHERE, weights: [0; 2] };
        let met = self.occluders.ray_from(point, normal, direction).filter(|hit| hit.front);
        let Some(met) = met.filter(|hit| !self.sent.is_reflected_to(hit.polygon, point)) else { return nowhere };
        let patch = self.patches[met.polygon as usize];
        let Some((triangle, weights)) = self.display.locate(self.hierarchy, patch, met.point) else {
            return nowhere;
        };
        let quantised = |weight: f32| (weight.clamp(0.0, 1.0) * f32::from(u16::MAX)) as u16;
        Hit { triangle, weights: [quantised(weights.y), quantised(weights.z)] }
    }
}

/// Tells vertices apart whatever their index.
pub fn position_hash(display: &Display, vertex: usize) -> u64 {
    let [x, y, z] = display.mesh.positions[vertex].map(|coordinate| u64::from(coordinate.to_bits()));
    let surface = u64::from(display.keys()[vertex].1);
    mix(mix(x, y), mix(z, surface))
}
