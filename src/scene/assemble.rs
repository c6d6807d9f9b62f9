//! From what a reader found to a scene: sidecar, clamps, shared vertices, quads and triangles,
//! faces left out.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::draft::{Draft, DraftFace, DraftMaterial};
use super::face::{CornerDetail, FaceDetails, TintList, unpacked_normal};
use super::paint::{Painted, paint};
use super::punctual::{add_emitters, add_sun};
use super::reading::{Reading, settle};
use super::sidecar::{MAX_EMISSION, Sidecar, SidecarMaterial};
use super::texture::{MaterialTextures, Opacity};
use super::triangulate::{Effort, ear_clip, is_good_quad, longest_edge_squared, newell};
use super::{Material, MaterialId, NamedCamera, Polygon, Scene, Sides, Skipped, place, sanitize};

/// The largest reflectance that a scene file may set; more makes light that hardly ever dies.
pub(super) const MAX_FILE_REFLECTANCE: f32 = 0.95;

/// A face whose doubled area is below this share of its squared longest edge has no area but
/// rounding noise.
const NO_AREA: f64 = 1e-7;

/// Twice the area of the smallest face, in the square of the length unit: f32 must still divide by
/// its square.
const SMALLEST: f64 = 1e-18;

/// Makes the scene, in metres.
pub(super) fn assemble(name: &str, mut draft: Draft, sidecar: &Sidecar, reading: &Reading) -> Scene {
    let frame = settle(&mut draft, reading, sidecar);
    let mut lights = add_emitters(&mut draft);
    let names = sanitize::unique_names(draft.materials.iter().map(|material| material.name.as_str()));
    for (material, name) in draft.materials.iter_mut().zip(names) {
        material.name = name;
    }
    for light in &mut lights {
        light.name.clone_from(&draft.materials[light.material.0 as usize].name);
    }
    note_unknown(&mut draft, sidecar, reading);
    if draft.too_deep > 0 {
        let count = draft.too_deep;
        draft.skipped.note(format!("Groups nested too deeply belong to those that hold them ({count})."));
    }
    let said = |name: &str| sidecar.materials.get(name).cloned().unwrap_or_default();
    let rules: Vec<FaceRule> =
        draft.materials.iter().map(|material| FaceRule::new(&said(&material.name), reading, material)).collect();
    let painted = paint(&draft);
    let (lower, upper) = draft.bounds();
    let origin = place::origin(lower, upper);
    let mut builder = PolygonBuilder::new(&draft, origin, draft.skipped.clone());
    for (index, face) in draft.faces.iter().enumerate() {
        builder.add(index as u32, face, rules[face.material as usize], painted[index].opacity);
    }
    if builder.effort.is_spent() {
        builder.skipped.note("Its outlines take too long to be cut properly: the last ones may be filled wrongly.");
    }
    let PolygonBuilder { vertices, polygons, mut details, sources, left_out, mut skipped, .. } = builder;
    details.finish();
    let mut scene = Scene::new(sanitize::name(name));
    scene.origin = origin;
    scene.vertices = vertices;
    scene.polygons = polygons;
    let mut finishes = Finishes::new(&draft);
    finishes.sum_up(&scene, &painted, &sources);
    for (index, material) in draft.materials.iter().enumerate() {
        let (reflectance, emission) = finishes.mean(index);
        let said = said(&material.name);
        let [of_reflectance, of_emission] = finishes.clamped[index];
        let counts = (of_reflectance && said.reflectance.is_none()) || (of_emission && said.emission.is_none());
        let is_used = matches!(rules[index], FaceRule::Keep { .. }) && left_out[index] == 0;
        skipped.clamped_materials += usize::from(counts && is_used);
        let filed = Material {
            name: material.name.clone(),
            reflectance,
            emission,
            textures: textures_of(material, rules[index].is_opaque(), !draft.colours.is_empty()),
            is_two_sided: material.is_two_sided,
            left_out: left_out[index],
        };
        scene.materials.push(Material {
            reflectance: said.reflectance.unwrap_or(reflectance),
            emission: said.emission.unwrap_or(emission),
            ..filed.clone()
        });
        scene.filed_materials.push(filed);
        if left_out[index] > 0 {
            skipped.transparent_materials.push(material.name.clone());
        }
    }
    finishes.tint(&scene, &painted, &sources, &mut details);
    scene.details = Arc::new(details);
    scene.skipped = skipped;
    scene.groups = draft.groups;
    scene.cameras =
        draft.cameras.into_iter().map(|(name, camera)| NamedCamera { name, pose: camera.in_scene(&scene) }).collect();
    scene.camera = sidecar
        .camera
        .map(|camera| camera.in_scene(&scene))
        .or_else(|| scene.cameras.first().map(|camera| camera.pose));
    scene.lights = lights;
    scene.frame = frame;
    add_sun(&mut scene, draft.suns);
    scene.reading = reading.clone();
    scene.sides = sidecar.sides.unwrap_or(Sides::Front);
    scene
}

/// Notes what sidecar and person say of materials that there are not.
fn note_unknown(draft: &mut Draft, sidecar: &Sidecar, reading: &Reading) {
    let unused: Vec<String> = draft.unused_materials.iter().map(|name| sanitize::name(name)).collect();
    let known: HashSet<&str> =
        draft.materials.iter().map(|material| &material.name).chain(&unused).map(String::as_str).collect();
    let unknown = sidecar.materials.keys().filter(|name| !known.contains(name.as_str()));
    let mut notes: Vec<String> = unknown
        .map(|name| {
            format!("The settings file names a material {} that the scene does not have.", sanitize::quoted(name))
        })
        .collect();
    let unknown = reading.opaque.iter().filter(|name| !known.contains(name.as_str()));
    notes.extend(unknown.map(|name| format!("There is no material {} to be made opaque.", sanitize::quoted(name))));
    let unknown = reading.ignored.iter().filter(|name| !known.contains(name.as_str()));
    notes.extend(unknown.map(|name| format!("There is no material {} to be left out.", sanitize::quoted(name))));
    notes.into_iter().for_each(|note| draft.skipped.note(note));
}

/// Textures of a material, for pictures, and what makes holes in its faces; `None` where points of
/// a face look alike.
fn textures_of(material: &DraftMaterial, is_opaque: bool, has_colours: bool) -> Option<Arc<MaterialTextures>> {
    let opacity = if is_opaque { Opacity::Opaque } else { material.opacity };
    let opacity_map = material.opacity_map.clone().filter(|_| !is_opaque);
    let has_maps = [&material.reflectance_map, &material.emission_map, &opacity_map].into_iter().any(Option::is_some);
    // Alpha of corners makes holes as well.
    if !has_maps && (opacity == Opacity::Opaque || !has_colours) {
        return None;
    }
    Some(Arc::new(MaterialTextures {
        reflectance: material.reflectance_map.clone(),
        reflectance_factor: material.reflectance,
        // Faces keep one set of texture coordinates: what has its own shows its mean.
        emission: material.emission_map.clone().filter(|_| !material.has_emission_uvs),
        emission_factor: material.emission,
        alpha_factor: material.alpha,
        opacity,
        opacity_map,
    }))
}

/// Means by area of what a material's faces reflect and emit.
struct Finishes {
    /// Whether faces of a material may differ.
    varied: Vec<bool>,
    /// Whether reflectances and emissions were.
    clamped: Vec<[bool; 2]>,
    plain: Vec<(Vec3, Vec3)>,
    area: Vec<f64>,
    reflected: Vec<DVec3>,
    emitted: Vec<DVec3>,
}

impl Finishes {
    fn new(draft: &Draft) -> Self {
        let has_colours = !draft.colours.is_empty();
        let is_varied = |it: &DraftMaterial| has_colours || it.reflectance_map.is_some() || it.emission_map.is_some();
        let count = draft.materials.len();
        Self {
            varied: draft.materials.iter().map(is_varied).collect(),
            clamped: draft.materials.iter().map(|it| is_clamped(it.reflectance, it.emission)).collect(),
            plain: draft.materials.iter().map(|it| clamped(it.reflectance, it.emission)).collect(),
            area: vec![0.0; count],
            reflected: vec![DVec3::ZERO; count],
            emitted: vec![DVec3::ZERO; count],
        }
    }

    /// Sums up over all polygons; `sources` are the faces that they were made of.
    fn sum_up(&mut self, scene: &Scene, painted: &[Painted], sources: &[u32]) {
        let mut is_seen = vec![false; self.varied.len()];
        for (polygon, &face) in scene.polygons.iter().zip(sources) {
            let material = polygon.material.0 as usize;
            if !self.varied[material] {
                continue;
            }
            if !std::mem::replace(&mut is_seen[material], true) {
                // Its factors alone tell nothing.
                self.clamped[material] = [false; 2];
            }
            let Painted { reflectance, emission, .. } = painted[face as usize];
            let [of_reflectance, of_emission] = is_clamped(reflectance, emission);
            self.clamped[material][0] |= of_reflectance;
            self.clamped[material][1] |= of_emission;
            let (reflectance, emission) = clamped(reflectance, emission);
            let area = f64::from(scene.area(polygon));
            self.area[material] += area;
            self.reflected[material] += area * reflectance.as_dvec3();
            self.emitted[material] += area * emission.as_dvec3();
        }
    }

    fn mean(&self, material: usize) -> (Vec3, Vec3) {
        let area = self.area[material];
        if area > 0.0 {
            ((self.reflected[material] / area).as_vec3(), (self.emitted[material] / area).as_vec3())
        } else {
            self.plain[material]
        }
    }

    /// Tells the faces that differ from their material's mean how they do.
    fn tint(&self, scene: &Scene, painted: &[Painted], sources: &[u32], details: &mut FaceDetails) {
        let mut tints = TintList::default();
        for (polygon, &face) in scene.polygons.iter().zip(sources) {
            let material = polygon.material.0 as usize;
            if self.varied[material] {
                let own = clamped(painted[face as usize].reflectance, painted[face as usize].emission);
                let mean = self.mean(material);
                tints.set(details, polygon.detail, factor(own.0, mean.0), factor(own.1, mean.1));
            }
        }
    }
}

/// Factor by which a mean becomes a face's own value.
fn factor(own: Vec3, mean: Vec3) -> Vec3 {
    let of_colour = |colour: usize| match own[colour] / mean[colour] {
        // Sums of many equal values differ in their last bits.
        factor if (factor - 1.0).abs() < 1e-6 => 1.0,
        factor if factor.is_finite() => factor,
        _ => 1.0,
    };
    Vec3::from_array(std::array::from_fn(of_colour))
}

fn clamped(reflectance: Vec3, emission: Vec3) -> (Vec3, Vec3) {
    let reflectance = reflectance.clamp(Vec3::ZERO, Vec3::splat(MAX_FILE_REFLECTANCE));
    (reflectance, emission.clamp(Vec3::ZERO, Vec3::splat(MAX_EMISSION)))
}

fn is_clamped(reflectance: Vec3, emission: Vec3) -> [bool; 2] {
    let inside = clamped(reflectance, emission);
    [inside.0 != reflectance, inside.1 != emission]
}

/// Rule for the faces of a material.
#[derive(Clone, Copy)]
enum FaceRule {
    /// They are used, clear ones if they are to be opaque.
    Keep { is_opaque: bool },
    /// They are used and counted as faces without a material.
    KeepGrey,
    /// The sidecar or a person leaves them out.
    Ignored,
}

impl FaceRule {
    fn new(said: &SidecarMaterial, reading: &Reading, material: &DraftMaterial) -> Self {
        if said.ignore || reading.ignored.contains(&material.name) {
            Self::Ignored
        } else if material.defined || said.reflectance.is_some() {
            Self::Keep { is_opaque: said.opaque || reading.opaque.contains(&material.name) }
        } else {
            Self::KeepGrey
        }
    }

    /// Whether a person says so.
    fn is_opaque(&self) -> bool {
        matches!(self, Self::Keep { is_opaque: true })
    }
}

/// A face is opaque from here on.
const OPAQUE: f32 = 0.5;

/// A corner's normal that is nearer to its face's than this cosine says nothing new.
const FLAT_COSINE: f32 = 0.9998;

/// Collects polygons over vertices that neighbouring faces share.
///
/// The maps hash with secret keys, as std's do: with a known hash a file can hold positions that
/// all fall into one slot, and each look-up would go through all of them.
struct PolygonBuilder<'a> {
    draft: &'a Draft,
    /// Whether faces may have details of their own.
    has_details: bool,
    /// Zero of the scene's coordinates in the file's.
    origin: DVec3,
    /// For each position of the file its vertex in the scene, or [`UNUSED`].
    vertex_of_position: Vec<u32>,
    vertex_at: HashMap<[u32; 3], u32>,
    vertices: Vec<Vec3>,
    polygons: Vec<Polygon>,
    details: FaceDetails,
    /// The face that each polygon was made of.
    sources: Vec<u32>,
    /// Transparent faces of each material.
    left_out: Vec<usize>,
    seen: HashSet<[u32; 4]>,
    seen_large: HashSet<Box<[u32]>>,
    effort: Effort,
    skipped: Skipped,
    /// The present face, kept to save an allocation for each.
    ring: Vec<u32>,
    ring_positions: Vec<Vec3>,
    /// The corners of the draft that the ring's are.
    ring_corners: Vec<usize>,
}

/// Marks a position that no face has used yet.
const UNUSED: u32 = u32::MAX;

impl<'a> PolygonBuilder<'a> {
    fn new(draft: &'a Draft, origin: DVec3, skipped: Skipped) -> Self {
        let mut seen = HashSet::new();
        seen.reserve(draft.faces.len());
        Self {
            vertex_of_position: vec![UNUSED; draft.vertices.len()],
            vertex_at: HashMap::new(),
            vertices: Vec::with_capacity(draft.vertices.len()),
            polygons: Vec::with_capacity(draft.faces.len()),
            details: FaceDetails::default(),
            sources: Vec::with_capacity(draft.faces.len()),
            left_out: vec![0; draft.materials.len()],
            has_details: !(draft.uvs.is_empty() && draft.normals.is_empty() && draft.colours.is_empty()),
            draft,
            origin,
            seen,
            seen_large: HashSet::new(),
            effort: Effort::of_a_scene(),
            skipped,
            ring: Vec::new(),
            ring_positions: Vec::new(),
            ring_corners: Vec::new(),
        }
    }

    /// Adds a face as one or several polygons, or counts why not.
    fn add(&mut self, index: u32, face: &DraftFace, rule: FaceRule, opacity: f32) {
        match rule {
            FaceRule::Ignored => {
                self.skipped.ignored_faces += 1;
                return;
            }
            FaceRule::Keep { is_opaque: false } if opacity < OPAQUE => {
                self.skipped.transparent_faces += 1;
                self.left_out[face.material as usize] += 1;
                return;
            }
            FaceRule::Keep { .. } | FaceRule::KeepGrey => {}
        }
        self.take_ring(face.corners());
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
        self.push_polygons(index, face);
    }

    /// The face's corners as shared vertices, without a corner that repeats the one before it.
    fn take_ring(&mut self, corners: Range<usize>) {
        self.ring.clear();
        self.ring_corners.clear();
        for corner in corners {
            let vertex = self.vertex(self.draft.corners[corner]);
            if self.ring.last() != Some(&vertex) {
                self.ring.push(vertex);
                self.ring_corners.push(corner);
            }
        }
        while self.ring.len() > 1 && self.ring.first() == self.ring.last() {
            self.ring.pop();
            self.ring_corners.pop();
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
        let position = (self.draft.vertices[position_index as usize] - self.origin).as_vec3() + Vec3::ZERO;
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

    fn push_polygons(&mut self, index: u32, face: &DraftFace) {
        match (self.ring.as_slice(), self.ring_positions.as_slice()) {
            (&[_, _, _], _) => self.push(index, face, &[0, 1, 2]),
            (&[_, _, _, _], &[a, b, c, d]) if is_good_quad([a, b, c, d]) => self.push(index, face, &[0, 1, 2, 3]),
            _ => {
                self.skipped.triangulated_polygons += 1;
                for corners in ear_clip(&self.ring_positions, &mut self.effort) {
                    let [a, b, c] = corners.map(|corner| self.ring[corner]);
                    if a != b && b != c && c != a {
                        self.push(index, face, &corners);
                    }
                }
            }
        }
    }

    /// Adds a polygon over some places of the ring.
    fn push(&mut self, index: u32, face: &DraftFace, places: &[usize]) {
        let mut corners = [0; 4];
        for (corner, &place) in corners.iter_mut().zip(places) {
            *corner = self.ring[place];
        }
        let corners = &corners[..places.len()];
        let material = MaterialId(face.material);
        let mut polygon = match *corners {
            [a, b, c, d] => Polygon::quad([a, b, c, d], material, face.group),
            _ => Polygon::triangle([corners[0], corners[1], corners[2]], material, face.group),
        };
        let of_material = &self.draft.materials[face.material as usize];
        let maps = [&of_material.reflectance_map, &of_material.emission_map, &of_material.opacity_map];
        let has_map = maps.into_iter().any(Option::is_some);
        if self.has_details || has_map {
            let mut details = [CornerDetail::default(); 4];
            for (detail, &place) in details.iter_mut().zip(places) {
                *detail = self.draft.detail(self.ring_corners[place]);
                detail.uv = detail.uv.filter(|_| has_map);
            }
            let details = &mut details[..places.len()];
            let flat = newell(&self.ring_positions).as_vec3().normalize_or_zero();
            let says_nothing = |detail: &CornerDetail| {
                detail.normal.and_then(unpacked_normal).is_none_or(|normal| normal.dot(flat).abs() >= FLAT_COSINE)
            };
            if details.iter().all(says_nothing) {
                details.iter_mut().for_each(|detail| detail.normal = None);
            }
            let is_needed = has_map || details.iter().any(|detail| *detail != CornerDetail::default());
            // Faces of a draft with colours may differ from each other whether or not they have
            // any.
            if is_needed || !self.draft.colours.is_empty() {
                polygon.detail = self.details.add(corners, details);
            }
        }
        self.polygons.push(polygon);
        self.sources.push(index);
    }
}
