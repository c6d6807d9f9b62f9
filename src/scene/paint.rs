//! Reflectance, emission and opacity of each face of a draft by itself: textures averaged over its part of their plane, times the colours
//! of its corners, times its material's factors.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3, Vec4};
use rayon::prelude::*;

use super::draft::{Draft, DraftFace, DraftMaterial};
use super::texture::mean::{RowSums, Weight};
use super::texture::{Opacity, Texture, TextureMap, Wrap};

/// A face's own values, before anything is clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Painted {
    pub reflectance: Vec3,
    /// Exitance, W/m².
    pub emission: Vec3,
    /// Share of what lies behind that it hides.
    pub opacity: f32,
}

/// Which of a material's two textures.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    Reflectance,
    Emission,
}

/// The faces of a draft, in their order.
pub(super) fn paint(draft: &Draft) -> Vec<Painted> {
    let of_material: Vec<Painted> = draft.materials.iter().map(plain).collect();
    let mut painted: Vec<Painted> = draft.faces.iter().map(|face| of_material[face.material as usize]).collect();
    let firsts = first_corners(draft);
    for Sheet { texture, weight, wrap, faces } in sheets(draft) {
        let sums = RowSums::new(&texture, weight, wrap);
        let of_all = sums.of_all();
        let mean = |&(index, part): &(u32, Use)| {
            let face = &draft.faces[index as usize];
            let first = firsts[index as usize];
            let uvs = draft.uvs.get(first..first + face.count as usize);
            match (uvs, map_of(&draft.materials[face.material as usize], part)) {
                (Some(uvs), Some(map)) if uvs.iter().all(|uv| uv.is_finite()) => {
                    let transform = map.transform.as_daffine2();
                    let corner = move |uv: &Vec2| -> DVec2 { transform.transform_point2(uv.as_dvec2()) };
                    sums.over(uvs.iter().map(corner))
                }
                _ => of_all,
            }
        };
        let means: Vec<Vec4> = faces.par_iter().map(mean).collect();
        for ((index, part), mean) in faces.into_iter().zip(means) {
            painted[index as usize].multiply(mean, part);
        }
    }
    if !draft.colours.is_empty() {
        painted.par_iter_mut().enumerate().for_each(|(index, painted)| {
            let corners = firsts[index]..firsts[index] + draft.faces[index].count as usize;
            let Some(colours) = draft.colours.get(corners) else { return };
            let colour = |colour: &Option<[u16; 4]>| {
                colour.map_or(Vec4::ONE, |colour| Vec4::from_array(colour.map(|value| f32::from(value) / 65535.0)))
            };
            let mean = colours.iter().map(colour).sum::<Vec4>() / colours.len() as f32;
            painted.multiply(mean, Use::Reflectance);
        });
    }
    painted
}

impl Painted {
    fn multiply(&mut self, mean: Vec4, part: Use) {
        match part {
            Use::Reflectance => {
                self.reflectance *= mean.truncate();
                self.opacity *= mean.w;
            }
            Use::Emission => self.emission *= mean.truncate(),
        }
    }
}

/// A face of a material without textures.
fn plain(material: &DraftMaterial) -> Painted {
    let opacity = match material.opacity {
        _ if material.transmits => 0.0,
        Opacity::Opaque => 1.0,
        Opacity::Blend => material.alpha,
        // With a texture its alpha decides, times the factor.
        Opacity::Mask(cutoff) => f32::from(material.reflectance_map.is_some() || material.alpha >= cutoff),
    };
    Painted { reflectance: material.reflectance, emission: material.emission, opacity }
}

fn map_of(material: &DraftMaterial, part: Use) -> Option<&TextureMap> {
    match part {
        Use::Reflectance => material.reflectance_map.as_ref(),
        Use::Emission => material.emission_map.as_ref(),
    }
}

/// How the texels of one of a material's textures count.
fn weight_of(material: &DraftMaterial, part: Use) -> Weight {
    match (part, material.opacity) {
        (Use::Emission, _) | (_, Opacity::Opaque) => Weight::Plain,
        (_, Opacity::Blend) => Weight::Alpha,
        (_, Opacity::Mask(cutoff)) => {
            let least = 255.0 * cutoff / material.alpha.max(f32::MIN_POSITIVE);
            // Alpha is a whole number of 255ths, and none is above 1.
            if least > 255.0 { Weight::Nothing } else { Weight::AtLeast(least.max(0.0).ceil() as u8) }
        }
    }
}

/// A texture in one use, and all faces that it is laid on.
struct Sheet {
    texture: Arc<Texture>,
    weight: Weight,
    wrap: [Wrap; 2],
    faces: Vec<(u32, Use)>,
}

/// All textures that materials lay on faces; each that is used in one way comes once.
fn sheets(draft: &Draft) -> Vec<Sheet> {
    let mut sheets: Vec<Sheet> = Vec::new();
    let mut known = HashMap::new();
    let mut sheet_of = |material: &DraftMaterial, part: Use| {
        let map = map_of(material, part)?;
        let (weight, wrap) = (weight_of(material, part), map.wrap);
        Some(*known.entry((Arc::as_ptr(&map.texture), weight, wrap)).or_insert_with(|| {
            sheets.push(Sheet { texture: map.texture.clone(), weight, wrap, faces: Vec::new() });
            sheets.len() - 1
        }))
    };
    let both = [Use::Reflectance, Use::Emission];
    let of_material: Vec<[Option<usize>; 2]> =
        draft.materials.iter().map(|material| both.map(|part| sheet_of(material, part))).collect();
    for (index, face) in draft.faces.iter().enumerate() {
        for (sheet, part) in of_material[face.material as usize].into_iter().zip(both) {
            if let Some(sheet) = sheet {
                sheets[sheet].faces.push((index as u32, part));
            }
        }
    }
    sheets
}

/// The first corner of each face.
fn first_corners(draft: &Draft) -> Vec<usize> {
    let mut next = 0;
    let first = |face: &DraftFace| {
        let first = next;
        next += face.count as usize;
        first
    };
    draft.faces.iter().map(first).collect()
}
