//! What vertices are and hold: reflectance, area, light; and values for those that are hidden or new.

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::FinalGather;
use crate::hierarchy::ElementId;
use crate::scene::Scene;
use crate::solver::display::{Display, VertexKey};

/// What a vertex of the mesh stands for.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// ρ.
    pub reflectance: Vec3,
    /// B_e, W/m².
    pub emission: Vec3,
    /// A third of the triangles around it, m².
    pub area: f32,
}

/// Those of a mesh; a vertex belongs to one material.
pub fn of_mesh(display: &Display, scene: &Scene) -> Vec<Vertex> {
    let mesh = &display.mesh;
    let vertex = |vertex: usize| {
        let leaf = display.around(vertex).first().map(|&(leaf, _)| &mesh.leaves[leaf as usize]);
        let surface = leaf.map(|leaf| scene.surface(&scene.polygons[leaf.polygon as usize]));
        Vertex {
            reflectance: surface.map_or(Vec3::ZERO, |surface| surface.reflectance),
            emission: surface.map_or(Vec3::ZERO, |surface| surface.emission),
            area: 0.0,
        }
    };
    let mut vertices: Vec<Vertex> = (0..mesh.positions.len()).map(vertex).collect();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| Vec3::from(mesh.positions[corner as usize]));
        let third = (b - a).cross(c - a).length() / 6.0;
        corners.iter().for_each(|&corner| vertices[corner as usize].area += third);
    }
    vertices
}

impl FinalGather {
    /// Σ A·|ρE|² over what does not emit, W²/m²: what errors are relative to.
    pub(super) fn energy(&self) -> f64 {
        let of = |(vertex, of): (usize, &Vertex)| match of.emission == Vec3::ZERO {
            true => f64::from(of.area * (of.reflectance * self.irradiance(vertex)).length_squared()),
            false => 0.0,
        };
        self.vertices.iter().enumerate().map(of).sum()
    }

    /// Irradiance E of a vertex as far as it is known, W/m².
    pub(super) fn irradiance(&self, vertex: usize) -> Vec3 {
        let direct = self.direct[vertex];
        self.indirect[vertex] + if direct.is_nan() { Vec3::ZERO } else { direct }
    }

    /// What each vertex reflects, B − B_e, W/m².
    pub(super) fn reflected(&self) -> Vec<Vec3> {
        let of = |(vertex, of): (usize, &Vertex)| of.reflectance * self.irradiance(vertex);
        let mut reflected: Vec<Vec3> = self.vertices.iter().enumerate().map(of).collect();
        self.fill_hidden(&mut reflected);
        reflected
    }

    /// Radiosity B of each vertex that receives this irradiance, W/m². Hidden vertices come out as the mean of their neighbours, which
    /// are of one material.
    pub fn radiosity_of(&self, irradiance: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let of = |(&irradiance, of): (&[f32; 3], &Vertex)| of.reflectance * Vec3::from(irradiance) + of.emission;
        irradiance.iter().zip(&self.vertices).map(|vertex| of(vertex).to_array()).collect()
    }

    /// Irradiance E of each vertex as far as it is known, W/m².
    pub fn vertex_irradiance(&self) -> Vec<[f32; 3]> {
        let mut irradiance: Vec<Vec3> = (0..self.vertices.len()).map(|vertex| self.irradiance(vertex)).collect();
        self.fill_hidden(&mut irradiance);
        irradiance.iter().map(Vec3::to_array).collect()
    }

    /// Mean irradiance of each leaf of the mesh, W/m².
    pub fn of_leaves(&self) -> impl Iterator<Item = (ElementId, Vec3)> {
        let irradiance = self.vertex_irradiance();
        let mesh = self.display.mesh.clone();
        (0..mesh.leaves.len()).map(move |leaf| {
            let (mut sum, mut area) = (Vec3::ZERO, 0.0);
            for triangle in self.display.triangles_of(leaf as u32) {
                let corners = mesh.triangles[triangle as usize].map(|corner| corner as usize);
                let [a, b, c] = corners.map(|corner| Vec3::from(mesh.positions[corner]));
                let weight = (b - a).cross(c - a).length();
                sum += weight * corners.map(|corner| Vec3::from(irradiance[corner])).into_iter().sum::<Vec3>() / 3.0;
                area += weight;
            }
            (mesh.leaves[leaf].element, if area > 0.0 { sum / area } else { Vec3::ZERO })
        })
    }

    /// Whether no light can reach a vertex, because it lies inside of something.
    pub(super) fn is_hidden(&self, vertex: usize) -> bool {
        self.stances[vertex].is_empty() && !self.direct[vertex].is_nan()
    }

    /// Hidden vertices, and those that were not looked at yet, take the mean of what lies around them.
    fn fill_hidden(&self, values: &mut [Vec3]) {
        let is_known = |vertex: usize| !self.direct[vertex].is_nan() && !self.is_hidden(vertex);
        let known = (0..values.len()).map(is_known).collect();
        spread(&self.display, values, known);
    }

    /// A value at each vertex of the present mesh where some are known: the others take the mean of those around them.
    pub(super) fn interpolated(&self, known: &FxHashMap<VertexKey, Vec3>) -> Vec<Vec3> {
        let of = |key: &VertexKey| known.get(key).copied();
        let mut values: Vec<Vec3> = self.display.keys().iter().map(|key| of(key).unwrap_or_default()).collect();
        let is_known = self.display.keys().iter().map(|key| of(key).is_some()).collect();
        spread(&self.display, &mut values, is_known);
        values
    }
}

/// Gives vertices whose value is not known the mean of those around them, ring by ring.
fn spread(display: &Display, values: &mut [Vec3], mut known: Vec<bool>) {
    while known.contains(&false) {
        let mut sums: FxHashMap<u32, (Vec3, f32)> = FxHashMap::default();
        for corners in &display.mesh.triangles {
            for (one, other) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
                let (one, other) = (corners[one], corners[other] as usize);
                if !known[one as usize] && known[other] {
                    let sum = sums.entry(one).or_default();
                    *sum = (sum.0 + values[other], sum.1 + 1.0);
                }
            }
        }
        if sums.is_empty() {
            break;
        }
        for (vertex, (sum, count)) in sums {
            values[vertex as usize] = sum / count;
            known[vertex as usize] = true;
        }
    }
}
