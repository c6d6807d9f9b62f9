//! From what a reader found to a scene: sidecar, clamps, shared vertices, quads and triangles, faces left out.

use std::collections::{HashMap, HashSet};

use glam::{DVec3, Vec3};

use super::draft::{Draft, DraftFace};
use super::sidecar::{MAX_EMISSION, Sidecar, SidecarMaterial};
use super::triangulate::{Effort, ear_clip, is_good_quad, longest_edge_squared, newell};
use super::{Material, MaterialId, Polygon, Scene, Sides, Skipped, place, said};

/// The largest reflectance that a scene file may set; more makes light that hardly ever dies.
const MAX_FILE_REFLECTANCE: f32 = 0.95;

/// A face whose doubled area is below this share of its squared longest edge has no area but rounding noise.
const NO_AREA: f64 = 1e-7;

/// Twice the area of the smallest face, in the square of the length unit: f32 must still divide by its square.
const SMALLEST: f64 = 1e-18;

/// Makes the scene.
pub(super) fn assemble(name: &str, draft: Draft, sidecar: &Sidecar) -> Scene {
    let Draft { vertices, corners, faces, mut materials, unused_materials, groups, mut skipped, too_deep, .. } = draft;
    for material in &mut materials {
        material.name = said::name(&material.name);
    }
    let unused_materials: Vec<String> = unused_materials.iter().map(|name| said::name(name)).collect();
    let known: HashSet<&str> =
        materials.iter().map(|material| &material.name).chain(&unused_materials).map(String::as_str).collect();
    for unknown in sidecar.materials.keys().filter(|name| !known.contains(name.as_str())) {
        let unknown = said::quoted(unknown);
        skipped.note(format!("The sidecar names a material {unknown} that the scene does not have."));
    }
    if too_deep > 0 {
        skipped.note(format!("Groups nested too deeply belong to those that hold them ({too_deep})."));
    }

    let mut rules = Vec::with_capacity(materials.len());
    let mut final_materials = Vec::with_capacity(materials.len());
    let mut filed_materials = Vec::with_capacity(materials.len());
    for material in materials {
        let said = sidecar.materials.get(&material.name).cloned().unwrap_or_default();
        let reflectance = material.reflectance.clamp(Vec3::ZERO, Vec3::splat(MAX_FILE_REFLECTANCE));
        let emission = material.emission.clamp(Vec3::ZERO, Vec3::splat(MAX_EMISSION));
        let clamped = (said.reflectance.is_none() && reflectance != material.reflectance)
            || (said.emission.is_none() && emission != material.emission);
        let rule = FaceRule::new(&said, material.transparent, material.defined);
        skipped.clamped_materials += usize::from(clamped && matches!(rule, FaceRule::Keep));
        rules.push(rule);
        let filed = Material { name: material.name, reflectance, emission };
        final_materials.push(Material {
            reflectance: said.reflectance.unwrap_or(reflectance),
            emission: said.emission.unwrap_or(emission),
            ..filed.clone()
        });
        filed_materials.push(filed);
    }

    let (lower, upper) = vertices.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lower, upper), vertex| {
        (lower.min(*vertex), upper.max(*vertex))
    });
    let origin = place::origin(lower, upper);
    let mut builder = PolygonBuilder::new(&vertices, origin, skipped, faces.len());
    let mut rest = corners.as_slice();
    for face in &faces {
        let (face_corners, behind) = rest.split_at(face.count as usize);
        rest = behind;
        builder.add(face, face_corners, rules[face.material as usize]);
    }

    if builder.effort.is_spent() {
        builder.skipped.note("Its outlines take too long to be cut properly: the last ones may be filled wrongly.");
    }
    let mut scene = Scene::new(said::name(name));
    scene.origin = origin;
    scene.vertices = builder.vertices;
    scene.polygons = builder.polygons;
    scene.skipped = builder.skipped;
    scene.materials = final_materials;
    scene.filed_materials = filed_materials;
    scene.groups = groups;
    scene.camera = sidecar.camera.map(|camera| camera.in_scene(&scene));
    scene.sides = sidecar.sides.unwrap_or(Sides::Front);
    scene
}

/// What becomes of the faces of a material.
#[derive(Clone, Copy)]
enum FaceRule {
    /// They are used.
    Keep,
    /// They are used and counted as faces without a material.
    KeepGrey,
    /// A pane.
    Transparent,
    /// The sidecar says so.
    Ignored,
}

impl FaceRule {
    fn new(said: &SidecarMaterial, transparent: bool, defined: bool) -> Self {
        if said.ignore {
            Self::Ignored
        } else if transparent {
            Self::Transparent
        } else if defined || said.reflectance.is_some() {
            Self::Keep
        } else {
            Self::KeepGrey
        }
    }
}

/// Collects polygons over vertices that neighbouring faces share.
///
/// Its maps hash with secret keys, as std's do: with a known hash a file can hold positions that all fall into one slot, and each
/// look-up would go through all of them.
struct PolygonBuilder<'a> {
    /// In the file's coordinates.
    positions: &'a [DVec3],
    /// Zero of the scene's coordinates in the file's.
    origin: DVec3,
    /// For each position of the file its vertex in the scene, or [`UNUSED`].
    vertex_of_position: Vec<u32>,
    vertex_at: HashMap<[u32; 3], u32>,
    vertices: Vec<Vec3>,
    polygons: Vec<Polygon>,
    seen: HashSet<[u32; 4]>,
    seen_large: HashSet<Box<[u32]>>,
    effort: Effort,
    skipped: Skipped,
    /// The present face, kept to save an allocation for each.
    ring: Vec<u32>,
    ring_positions: Vec<Vec3>,
}

/// Marks a position that no face has used yet.
const UNUSED: u32 = u32::MAX;

impl<'a> PolygonBuilder<'a> {
    fn new(positions: &'a [DVec3], origin: DVec3, skipped: Skipped, faces: usize) -> Self {
        let mut seen = HashSet::new();
        seen.reserve(faces);
        Self {
            vertex_of_position: vec![UNUSED; positions.len()],
            vertex_at: HashMap::new(),
            vertices: Vec::with_capacity(positions.len()),
            polygons: Vec::with_capacity(faces),
            positions,
            origin,
            seen,
            seen_large: HashSet::new(),
            effort: Effort::of_a_scene(),
            skipped,
            ring: Vec::new(),
            ring_positions: Vec::new(),
        }
    }

    /// Adds a face as one or several polygons, or counts why not.
    fn add(&mut self, face: &DraftFace, corners: &[u32], rule: FaceRule) {
        match rule {
            FaceRule::Keep | FaceRule::KeepGrey => {}
            FaceRule::Transparent => {
                self.skipped.transparent_faces += 1;
                return;
            }
            FaceRule::Ignored => {
                self.skipped.ignored_faces += 1;
                return;
            }
        }
        self.take_ring(corners);
        if self.is_degenerate() {
            self.skipped.degenerate_faces += 1;
            return;
        }
        if !self.is_new() {
            self.skipped.duplicate_faces += 1;
            return;
        }
        if matches!(rule, FaceRule::KeepGrey) {
            self.skipped.faces_without_material += 1;
        }
        self.push_polygons(face);
    }

    /// The face's corners as shared vertices, without a corner that repeats the one before it.
    fn take_ring(&mut self, corners: &[u32]) {
        self.ring.clear();
        for &corner in corners {
            let vertex = self.vertex(corner);
            if self.ring.last() != Some(&vertex) {
                self.ring.push(vertex);
            }
        }
        while self.ring.len() > 1 && self.ring.first() == self.ring.last() {
            self.ring.pop();
        }
        self.ring_positions.clear();
        self.ring_positions.extend(self.ring.iter().map(|&vertex| self.vertices[vertex as usize]));
    }

    /// The vertex at a position of the file; equal positions share one.
    fn vertex(&mut self, position_index: u32) -> u32 {
        let known = self.vertex_of_position[position_index as usize];
        if known != UNUSED {
            return known;
        }
        // Adding zero makes −0 and 0 the same bits.
        let position = (self.positions[position_index as usize] - self.origin).as_vec3() + Vec3::ZERO;
        let key = position.to_array().map(f32::to_bits);
        let vertex = *self.vertex_at.entry(key).or_insert_with(|| {
            self.vertices.push(position);
            self.vertices.len() as u32 - 1
        });
        self.vertex_of_position[position_index as usize] = vertex;
        vertex
    }

    fn is_degenerate(&self) -> bool {
        let least = SMALLEST.max(NO_AREA * longest_edge_squared(&self.ring_positions));
        self.ring.len() < 3 || newell(&self.ring_positions).length() <= least
    }

    /// Whether no face had the same corners in the same cyclic order before.
    fn is_new(&mut self) -> bool {
        let smallest = self.ring.iter().enumerate().min_by_key(|(_, vertex)| **vertex).map_or(0, |(index, _)| index);
        if self.ring.len() <= 4 {
            let mut key = [UNUSED; 4];
            for (index, slot) in key.iter_mut().enumerate().take(self.ring.len()) {
                *slot = self.ring[(smallest + index) % self.ring.len()];
            }
            self.seen.insert(key)
        } else {
            let mut key = self.ring.clone();
            key.rotate_left(smallest);
            self.seen_large.insert(key.into_boxed_slice())
        }
    }

    fn push_polygons(&mut self, face: &DraftFace) {
        let material = MaterialId(face.material);
        match (self.ring.as_slice(), self.ring_positions.as_slice()) {
            (&[a, b, c], _) => self.polygons.push(Polygon::triangle([a, b, c], material, face.group)),
            (&[a, b, c, d], &[pa, pb, pc, pd]) if is_good_quad([pa, pb, pc, pd]) => {
                self.polygons.push(Polygon::quad([a, b, c, d], material, face.group));
            }
            (ring, positions) => {
                self.skipped.triangulated_polygons += 1;
                let triangles =
                    ear_clip(positions, &mut self.effort).into_iter().map(|corners| corners.map(|corner| ring[corner]));
                let sound = triangles.filter(|[a, b, c]| a != b && b != c && c != a);
                self.polygons.extend(sound.map(|corners| Polygon::triangle(corners, material, face.group)));
            }
        }
    }
}
