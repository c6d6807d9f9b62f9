//! Rays into a lit mesh: what they meet, and what light is there.

use std::sync::Arc;

use glam::Vec3;

use crate::geometry::{Hit, Occluders};
use crate::scene::Scene;
use crate::solve::{Leaf, Snapshot, barycentric};

/// A point farther than this share of the scene's size from every surface lies on none.
const TOLERANCE: f32 = 1e-3;
/// Faces turned up more than this cosine are level.
pub(super) const LEVEL: f32 = 0.98;

/// Standard error of a reading, as a share of the light there, unless another is asked for: some
/// tenths of a millisecond.
pub const READING_ERROR: f32 = 0.02;

/// A snapshot and its mesh as rays meet it.
#[derive(Clone)]
pub struct LitMesh {
    scene: Arc<Scene>,
    snapshot: Arc<Snapshot>,
    faces: Arc<Occluders>,
    tolerance: f32,
}

/// Light and surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceReading {
    /// The point, in the scene's unit.
    pub point: Vec3,
    /// Unit normal of the bright side.
    pub normal: Vec3,
    /// The leaf that holds it, as the snapshot has it.
    pub leaf: Leaf,
    /// Irradiance E, W/m²: gathered at the point where there is a field, else interpolated as in
    /// the picture.
    pub irradiance: Vec3,
    /// Standard error of E, W/m², where it was gathered.
    pub standard_error: Option<Vec3>,
    /// Radiosity B, W/m², by that E.
    pub radiosity: Vec3,
}

/// The surface that a ray meets first.
pub(super) enum Met {
    /// Nothing: it leaves the scene.
    Nothing,
    /// The dark back of a face.
    Back,
    /// A bright side, which sends this without its own emission, W/m².
    Front(Vec3),
}

impl LitMesh {
    /// Makes the mesh of a snapshot ready for rays; takes some 2 µs for each triangle.
    pub fn new(scene: Arc<Scene>, snapshot: Arc<Snapshot>) -> Self {
        let mesh = &snapshot.mesh;
        let faces: Vec<_> =
            (0..).zip(&mesh.triangles).map(|(index, triangle)| (mesh.corners(*triangle), index)).collect();
        let faces = Arc::new(Occluders::of_triangles(&faces));
        let (lower, upper) = scene.bounds();
        Self { scene, snapshot, faces, tolerance: TOLERANCE * (upper - lower).length() }
    }

    /// The mesh in another light, at no cost; `None` where the mesh is another.
    pub fn relit(&self, scene: &Arc<Scene>, snapshot: &Arc<Snapshot>) -> Option<Self> {
        let is_same = Arc::ptr_eq(&self.snapshot.mesh, &snapshot.mesh);
        is_same.then(|| Self { scene: scene.clone(), snapshot: snapshot.clone(), ..self.clone() })
    }

    /// The light that is read.
    pub fn snapshot(&self) -> &Arc<Snapshot> {
        &self.snapshot
    }

    /// The scene that is lit.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The first bright side along a ray, as the picture shows it; `direction` of any length.
    pub fn under(&self, origin: Vec3, direction: Vec3) -> Option<SurfaceReading> {
        let hit = self.first_front(origin, direction)?;
        Some(self.reading(hit.polygon, hit.point, READING_ERROR))
    }

    /// Reading at a point of a surface that is bright towards `normal`, to a standard error that is
    /// this share of the light there; `None` where the mesh has no such surface.
    pub fn at(&self, point: Vec3, normal: Vec3, error: f32) -> Option<SurfaceReading> {
        let hit = self.first_front(point + self.tolerance * normal, -normal)?;
        (hit.point.distance(point) <= self.tolerance).then(|| self.reading(hit.polygon, hit.point, error))
    }

    fn first_front(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let direction = direction.try_normalize().filter(|_| origin.is_finite())?;
        self.faces.first_front(origin, direction)
    }

    fn reading(&self, triangle: u32, point: Vec3, error: f32) -> SurfaceReading {
        let mesh = &self.snapshot.mesh;
        let triangle = triangle as usize;
        let leaf = mesh.leaves[mesh.triangle_leaf[triangle] as usize];
        let normal = self.normal(triangle);
        let (irradiance, radiosity, standard_error) = match &self.snapshot.field {
            Some(field) => {
                let read = field.read(leaf.polygon, point, error);
                let surface = field.surface(leaf.polygon);
                (read.mean, surface.emission + surface.reflectance * read.mean, Some(read.standard_error))
            }
            None => (
                self.interpolated(triangle, point, &self.snapshot.vertex_irradiance),
                self.interpolated(triangle, point, &self.snapshot.vertex_radiosity),
                None,
            ),
        };
        SurfaceReading { point, normal, leaf, irradiance, standard_error, radiosity }
    }

    fn normal(&self, triangle: usize) -> Vec3 {
        let [a, b, c] = self.snapshot.mesh.corners(self.snapshot.mesh.triangles[triangle]);
        (b - a).cross(c - a).normalize_or_zero()
    }

    fn interpolated(&self, triangle: usize, point: Vec3, values: &[[f32; 3]]) -> Vec3 {
        let mesh = &self.snapshot.mesh;
        let weights = barycentric(mesh.corners(mesh.triangles[triangle]), point).clamp(Vec3::ZERO, Vec3::ONE);
        let [a, b, c] = mesh.triangles[triangle].map(|vertex| Vec3::from(values[vertex as usize]));
        let sum = weights.element_sum();
        if sum > 0.0 { (weights.x * a + weights.y * b + weights.z * c) / sum } else { a }
    }

    /// A point farther than this from every surface lies on none.
    pub(super) fn tolerance(&self) -> f32 {
        self.tolerance
    }

    /// Where a ray from the air meets the bright side of a level face first; both directions are
    /// unit vectors.
    pub(super) fn level_face_below(&self, point: Vec3, down: Vec3, up: Vec3) -> Option<Vec3> {
        let hit = self.faces.first_hit(point, down).filter(|hit| hit.front)?;
        (self.normal(hit.polygon as usize).dot(up) > LEVEL).then_some(hit.point)
    }

    /// The surface that light from a direction left last for a small area in the air or on a face;
    /// `direction` must be a unit vector.
    pub(super) fn met(&self, (point, normal): (Vec3, Vec3), direction: Vec3) -> Met {
        match self.faces.ray_from(point, normal, direction) {
            None => Met::Nothing,
            Some(hit) if !hit.front => Met::Back,
            Some(hit) => {
                let mesh = &self.snapshot.mesh;
                let leaf = &mesh.leaves[mesh.triangle_leaf[hit.polygon as usize] as usize];
                let sent = self.interpolated(hit.polygon as usize, hit.point, &self.snapshot.vertex_radiosity);
                Met::Front(
                    (sent - self.scene.surface(&self.scene.polygons[leaf.polygon as usize]).emission).max(Vec3::ZERO),
                )
            }
        }
    }

    /// Whether two points, each with its normal, see each other.
    pub(super) fn sees(&self, from: (Vec3, Vec3), to: (Vec3, Vec3)) -> bool {
        self.faces.sees(from, to)
    }
}
