//! Details of a face beside its material: how it differs from the material's mean, and texture
//! coordinates, normals and colours at its corners.
//!
//! Light transport takes one reflectance and one emission for each face ([`Scene::surface`]): its
//! material's mean times the face's own tint, so that a change of the material changes all of its
//! faces alike. Pictures read textures, colours and normals at points ([`Scene::surface_at`],
//! [`Scene::smooth_normal`]); parts that a face was cut into find their places on the whole face.

use std::collections::HashMap;
use std::ops::{Add, Mul};

use glam::{Vec2, Vec3, Vec4};

use super::sidecar::MAX_SIDECAR_REFLECTANCE;
use super::texture::TextureMap;
use super::{Material, Polygon, Scene};

/// Reflectance and emission of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Reflectance ρ per colour.
    pub reflectance: Vec3,
    /// Emission B_e per colour, W/m².
    pub emission: Vec3,
}

/// How a face differs from its material's mean, as factors per colour.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tint {
    reflectance: Vec3,
    emission: Vec3,
}

impl Tint {
    const NONE: Self = Self { reflectance: Vec3::ONE, emission: Vec3::ONE };

    fn key(self) -> [u32; 6] {
        let ([a, b, c], [d, e, f]) = (self.reflectance.to_array(), self.emission.to_array());
        [a, b, c, d, e, f].map(f32::to_bits)
    }
}

/// Marks what is absent.
const NONE: u32 = u32::MAX;

/// A face's places in the lists of [`FaceDetails`].
#[derive(Clone, Copy, Debug)]
struct Face {
    /// First of its corners.
    first: u32,
    /// Number of the face's tint, or [`NONE`].
    tint: u32,
    /// Number of corners, 0 where the file says nothing of them.
    corners: u8,
}

/// Details of all faces that have any. A list is empty where no face has such a detail, else it has
/// an entry for each corner.
#[derive(Clone, Debug, Default)]
pub struct FaceDetails {
    faces: Vec<Face>,
    tints: Vec<Tint>,
    vertices: Vec<u32>,
    uvs: Vec<Vec2>,
    normals: Vec<[i16; 2]>,
    colours: Vec<[u16; 4]>,
}

/// A corner of a face as a file has it; what is absent is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CornerDetail {
    pub uv: Option<Vec2>,
    pub normal: Option<[i16; 2]>,
    pub colour: Option<[u16; 4]>,
}

impl FaceDetails {
    /// Memory of all lists, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.faces[..])
            + size_of_val(&self.tints[..])
            + size_of_val(&self.vertices[..])
            + size_of_val(&self.uvs[..])
            + size_of_val(&self.normals[..])
            + size_of_val(&self.colours[..])
    }

    /// Adds a polygon's corners and gives its number; `vertices` are the polygon's.
    pub(super) fn add(&mut self, vertices: &[u32], details: &[CornerDetail]) -> u32 {
        let first = self.vertices.len() as u32;
        let has_any = details.iter().any(|detail| *detail != CornerDetail::default());
        if has_any {
            self.vertices.extend_from_slice(vertices);
            let before = first as usize;
            let absent = Vec2::NAN;
            extend(&mut self.uvs, before, absent, details.iter().map(|detail| detail.uv));
            extend(&mut self.normals, before, NO_NORMAL, details.iter().map(|detail| detail.normal));
            extend(&mut self.colours, before, WHITE, details.iter().map(|detail| detail.colour));
        }
        let corners = if has_any { vertices.len() as u8 } else { 0 };
        self.faces.push(Face { first, tint: NONE, corners });
        self.faces.len() as u32 - 1
    }

    /// Fills the lists up to the last corner.
    pub(super) fn finish(&mut self) {
        let count = self.vertices.len();
        fill(&mut self.uvs, count, Vec2::NAN);
        fill(&mut self.normals, count, NO_NORMAL);
        fill(&mut self.colours, count, WHITE);
    }
}

/// Collects tints, each once.
#[derive(Default)]
pub(super) struct TintList {
    known: HashMap<[u32; 6], u32>,
}

impl TintList {
    /// Makes a face differ from its material's mean by these factors.
    pub fn set(&mut self, details: &mut FaceDetails, face: u32, reflectance: Vec3, emission: Vec3) {
        let tint = Tint { reflectance, emission };
        if tint == Tint::NONE {
            return;
        }
        let number = *self.known.entry(tint.key()).or_insert_with(|| {
            details.tints.push(tint);
            details.tints.len() as u32 - 1
        });
        details.faces[face as usize].tint = number;
    }
}

/// A normal that is absent; no packed one has this value.
const NO_NORMAL: [i16; 2] = [i16::MIN; 2];

/// The colour of corners that have none.
const WHITE: [u16; 4] = [u16::MAX; 4];

/// Appends to a list that is there or has something to hold now; the lists that are there are as
/// long as `before`.
fn extend<T: Copy>(list: &mut Vec<T>, before: usize, absent: T, values: impl Iterator<Item = Option<T>> + Clone) {
    if list.is_empty() && values.clone().all(|value| value.is_none()) {
        return;
    }
    list.resize(before, absent);
    list.extend(values.map(|value| value.unwrap_or(absent)));
}

fn fill<T: Copy>(list: &mut Vec<T>, count: usize, absent: T) {
    if !list.is_empty() {
        list.resize(count, absent);
    }
}

/// A unit vector in two numbers: the sphere unfolded to a square by way of an octahedron (Meyer et
/// al. 2010).
pub(super) fn packed_normal(normal: Vec3) -> Option<[i16; 2]> {
    let normal = normal.try_normalize()?;
    let flat = normal / (normal.x.abs() + normal.y.abs() + normal.z.abs());
    let [x, y] = match flat.z >= 0.0 {
        true => [flat.x, flat.y],
        false => [(1.0 - flat.y.abs()).copysign(flat.x), (1.0 - flat.x.abs()).copysign(flat.y)],
    };
    Some([x, y].map(|value| (value * 32767.0).round() as i16))
}

pub(super) fn unpacked_normal(packed: [i16; 2]) -> Option<Vec3> {
    if packed == NO_NORMAL {
        return None;
    }
    let [x, y] = packed.map(|value| f32::from(value) / 32767.0);
    let z = 1.0 - x.abs() - y.abs();
    let inner = (-z).max(0.0);
    Vec3::new(x - inner.copysign(x), y - inner.copysign(y), z).try_normalize()
}

/// A colour and an alpha between 0 and 1, in 65535ths.
pub(super) fn packed_colour(colour: Vec4) -> [u16; 4] {
    colour.to_array().map(|value| (value.clamp(0.0, 1.0) * 65535.0).round() as u16)
}

impl Scene {
    /// Reflectance and emission of a face: its material's mean times its own tint.
    pub fn surface(&self, polygon: &Polygon) -> Surface {
        let material = &self.materials[polygon.material.0 as usize];
        let (reflectance, emission) = (material.reflectance, material.emission);
        let face = self.details.faces.get(polygon.detail as usize);
        match face.and_then(|face| self.details.tints.get(face.tint as usize)) {
            None => Surface { reflectance, emission },
            Some(tint) => Surface {
                reflectance: (reflectance * tint.reflectance).min(Vec3::splat(MAX_SIDECAR_REFLECTANCE)),
                emission: emission * tint.emission,
            },
        }
    }

    /// Reflectance and emission of a face at a point, where its mean is `mean`: as its textures and
    /// the colours of its corners say, and changed as the mean was changed since the file was read.
    /// Texels are as large as `footprint`, in the scene's length unit. `None` in a hole.
    pub fn surface_at(&self, polygon: &Polygon, point: Vec3, mean: Surface, footprint: f32) -> Option<Surface> {
        let textures = self.materials[polygon.material.0 as usize].textures.as_deref();
        if textures.is_none() && self.details.colours.is_empty() {
            return Some(mean);
        }
        let corners = self.corner_colour(polygon, point);
        let colour = corners.truncate();
        let uv = textures.and_then(|_| self.texture_coordinates(polygon, point));
        let texel = |map: &TextureMap| Some(map.sample(uv?, footprint * self.texels_per_length(polygon, map)));
        let of_colour = textures.and_then(|it| texel(it.reflectance.as_ref()?));
        let of_opacity = textures.and_then(|it| texel(it.opacity_map.as_ref()?));
        let alpha = |texel: Option<Vec4>| texel.map_or(1.0, |texel| texel.w);
        if textures.is_some_and(|it| it.is_hole(corners.w, alpha(of_colour), alpha(of_opacity))) {
            return None;
        }
        let mut surface = mean;
        let filed = self.filed_surface(polygon);
        match (textures, of_colour) {
            (Some(textures), Some(texel)) => {
                let said = textures.reflectance_factor * texel.truncate() * colour;
                surface.reflectance = changed(mean.reflectance, said, filed.reflectance);
            }
            _ => {
                let of_corners = self.mean_corner_colour(polygon);
                surface.reflectance = changed(mean.reflectance, colour, of_corners);
            }
        }
        if let Some((textures, texel)) = textures.and_then(|it| Some((it, texel(it.emission.as_ref()?)?))) {
            let said = textures.emission_factor * texel.truncate();
            surface.emission = changed(mean.emission, said, filed.emission).max(Vec3::ZERO);
        }
        surface.reflectance = surface.reflectance.clamp(Vec3::ZERO, Vec3::splat(MAX_SIDECAR_REFLECTANCE));
        Some(surface)
    }

    /// Mean reflectance and emission of a face as its file alone says.
    fn filed_surface(&self, polygon: &Polygon) -> Surface {
        let material = polygon.material.0 as usize;
        let Material { reflectance, emission, .. } =
            *self.filed_materials.get(material).unwrap_or(&self.materials[material]);
        let face = self.details.faces.get(polygon.detail as usize);
        let tint = face.and_then(|face| self.details.tints.get(face.tint as usize)).unwrap_or(&Tint::NONE);
        Surface { reflectance: reflectance * tint.reflectance, emission: emission * tint.emission }
    }

    /// Mean of the colours of a face's corners; white where its file has none.
    fn mean_corner_colour(&self, polygon: &Polygon) -> Vec3 {
        let face = self.details.faces.get(polygon.detail as usize).filter(|face| face.corners > 0);
        let range = face.map(|face| face.first as usize..face.first as usize + usize::from(face.corners));
        let Some(colours) = range.and_then(|range| self.details.colours.get(range)) else { return Vec3::ONE };
        let colour = |[r, g, b, _]: &[u16; 4]| Vec3::from_array([*r, *g, *b].map(|value| f32::from(value) / 65535.0));
        colours.iter().map(colour).sum::<Vec3>() / colours.len() as f32
    }

    /// Texels of a texture along a length of a face, in the mean of all directions.
    fn texels_per_length(&self, polygon: &Polygon, map: &TextureMap) -> f32 {
        let face = self.details.faces.get(polygon.detail as usize).filter(|face| face.corners > 0);
        let Some(first) = face.map(|face| face.first as usize) else { return 0.0 };
        let Some(&[a, b, c]) = self.details.uvs.get(first..first + 3).and_then(|uvs| uvs.first_chunk()) else {
            return 0.0;
        };
        let corner = |index: usize| self.vertices[self.details.vertices[first + index] as usize];
        let area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).length();
        let texels = (b - a).perp_dot(c - a).abs() * map.texels();
        let density = (texels / area).sqrt();
        if density.is_finite() { density } else { 0.0 }
    }

    /// Whether two faces have one material and do not differ from its mean, or differ alike.
    pub fn has_same_finish(&self, a: &Polygon, b: &Polygon) -> bool {
        let tint = |polygon: &Polygon| self.details.faces.get(polygon.detail as usize).map_or(NONE, |face| face.tint);
        a.material == b.material && tint(a) == tint(b)
    }

    /// Whether a face emits.
    pub fn emits(&self, polygon: &Polygon) -> bool {
        self.surface(polygon).emission.max_element() > 0.0
    }

    /// Texture coordinates at a point of a polygon, where its file has any; v runs downwards.
    pub fn texture_coordinates(&self, polygon: &Polygon, point: Vec3) -> Option<Vec2> {
        let uv = self.interpolated(polygon, point, &self.details.uvs, |uv| uv)?;
        Some(uv).filter(|uv| uv.is_finite())
    }

    /// Unit normal at a point of a polygon, turned to its bright side; the polygon's own where its
    /// file has none.
    pub fn smooth_normal(&self, polygon: &Polygon, point: Vec3) -> Vec3 {
        let flat = self.normal(polygon);
        let normals = &self.details.normals;
        let smooth = self.interpolated(polygon, point, normals, |packed| unpacked_normal(packed).unwrap_or(Vec3::NAN));
        match smooth.and_then(Vec3::try_normalize) {
            Some(smooth) => smooth * 1.0_f32.copysign(smooth.dot(flat)),
            None => flat,
        }
    }

    /// Colour and alpha at a point of a polygon that its material's are multiplied with; white
    /// where its file has none.
    fn corner_colour(&self, polygon: &Polygon, point: Vec3) -> Vec4 {
        let colour = |colour: [u16; 4]| Vec4::from_array(colour.map(|value| f32::from(value) / 65535.0));
        self.interpolated(polygon, point, &self.details.colours, colour).unwrap_or(Vec4::ONE)
    }

    /// A value of a face's corners at a point of it, or of a part that it was cut into.
    fn interpolated<T: Copy, V: Add<Output = V> + Mul<f32, Output = V>>(
        &self,
        polygon: &Polygon,
        point: Vec3,
        list: &[T],
        value: impl Fn(T) -> V,
    ) -> Option<V> {
        let face = self.details.faces.get(polygon.detail as usize).filter(|face| face.corners > 0)?;
        let range = face.first as usize..face.first as usize + usize::from(face.corners);
        let values = list.get(range.clone())?;
        let corner = |index: usize| self.vertices[self.details.vertices[range.start + index] as usize];
        let in_triangle = |[a, b, c]: [usize; 3]| {
            let weights = barycentric([corner(a), corner(b), corner(c)], point);
            let mixed = value(values[a]) * weights.x + value(values[b]) * weights.y + value(values[c]) * weights.z;
            (weights.min_element(), mixed)
        };
        let first = in_triangle([0, 1, 2]);
        if face.corners == 3 || first.0 >= 0.0 {
            return Some(first.1);
        }
        let second = in_triangle([0, 2, 3]);
        Some(if second.0 >= first.0 { second.1 } else { first.1 })
    }
}

/// Value at a point, changed as the mean of its face was changed from what had been said of that.
fn changed(mean: Vec3, said: Vec3, said_mean: Vec3) -> Vec3 {
    let of_channel = |channel: usize| match said_mean[channel] > 0.0 {
        true => said[channel] * (mean[channel] / said_mean[channel]),
        false => mean[channel],
    };
    Vec3::from_array(std::array::from_fn(of_channel))
}

/// Weights of a triangle's corners at a point in its plane.
fn barycentric([a, b, c]: [Vec3; 3], point: Vec3) -> Vec3 {
    let (u, v, w) = ((b - a).as_dvec3(), (c - a).as_dvec3(), (point - a).as_dvec3());
    let normal = u.cross(v);
    let scale = 1.0 / normal.length_squared().max(f64::MIN_POSITIVE);
    let (of_b, of_c) = (w.cross(v).dot(normal) * scale, u.cross(w).dot(normal) * scale);
    Vec3::new((1.0 - of_b - of_c) as f32, of_b as f32, of_c as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: 16 bits of an octahedron's side are less than 1e-4 of an angle.
    #[test]
    fn normals_come_back() {
        for normal in [Vec3::X, -Vec3::Z, Vec3::new(1.0, -2.0, -3.0), Vec3::new(-0.1, 0.2, 0.9), -Vec3::ONE] {
            let back = packed_normal(normal).and_then(unpacked_normal).expect("a direction");
            assert!(back.distance(normal.normalize()) < 1e-4, "{normal} became {back}");
        }
        assert_eq!(packed_normal(Vec3::ZERO), None);
        assert_eq!(unpacked_normal(NO_NORMAL), None);
    }

    /// Truth: the corners' own weights, and the middle.
    #[test]
    fn weights_of_corners() {
        let corners = [Vec3::ZERO, Vec3::new(2.0, 0.0, 1.0), Vec3::Y];
        assert!(barycentric(corners, corners[1]).distance(Vec3::Y) < 1e-6);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        assert!(barycentric(corners, middle).distance(Vec3::splat(1.0 / 3.0)) < 1e-6);
    }
}
