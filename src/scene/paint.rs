//! Reflectance, emission and opacity of each face of a draft by itself: textures averaged over its
//! part of their plane, times the colours of its corners, times its material's factors. Alpha
//! counts as far as the material's [`Opacity`] says.

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

/// Which of a material's textures.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    Reflectance,
    Emission,
    Opacity,
}

impl Use {
    const ALL: [Self; 3] = [Self::Reflectance, Self::Emission, Self::Opacity];
}

/// The faces of a draft, in their order.
pub(super) fn paint(draft: &Draft) -> Vec<Painted> {
    let corner_colours = mean_corner_colours(draft);
    let colour_of = |face: usize| corner_colours.get(face).copied().unwrap_or(Vec4::ONE);
    let plain = |(index, face): (usize, &DraftFace)| plain(&draft.materials[face.material as usize], colour_of(index));
    let mut painted: Vec<Painted> = draft.faces.iter().enumerate().map(plain).collect();
    for Sheet { texture, weight, wrap, faces } in sheets(draft, colour_of) {
        let sums = RowSums::new(&texture, weight, wrap);
        let of_all = sums.of_all();
        let mean = |&(index, part): &(u32, Use)| {
            let face = &draft.faces[index as usize];
            let is_sound = |uvs: &&[Vec2]| uvs.iter().all(|uv| uv.is_finite());
            let of_emission = draft.emission_uvs.get(face.corners()).filter(|_| part == Use::Emission);
            let uvs = of_emission.filter(is_sound).or_else(|| draft.uvs.get(face.corners())).filter(is_sound);
            match (uvs, map_of(&draft.materials[face.material as usize], part)) {
                (Some(uvs), Some(map)) => {
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
            Use::Opacity => self.opacity *= mean.w,
        }
    }
}

/// A face of a material without textures, where its corners have a colour and an alpha.
fn plain(material: &DraftMaterial, corners: Vec4) -> Painted {
    let alpha = material.alpha * corners.w;
    let opacity = match material.opacity {
        _ if material.transmits => 0.0,
        Opacity::Opaque if material.opacity_map.is_some() => material.alpha,
        Opacity::Opaque => 1.0,
        Opacity::Blend => alpha,
        // With a texture its alpha decides, times the factors.
        Opacity::Mask(cutoff) => f32::from(material.reflectance_map.is_some() || alpha >= cutoff),
    };
    Painted { reflectance: material.reflectance * corners.truncate(), emission: material.emission, opacity }
}

/// The mean colour and alpha of each face's corners; none where the file has no colours.
fn mean_corner_colours(draft: &Draft) -> Vec<Vec4> {
    if draft.colours.is_empty() {
        return Vec::new();
    }
    let colour = |colour: &Option<[u16; 4]>| {
        colour.map_or(Vec4::ONE, |colour| Vec4::from_array(colour.map(|value| f32::from(value) / 65535.0)))
    };
    let mean = |face: &DraftFace| {
        let colours = draft.colours.get(face.corners());
        colours.map_or(Vec4::ONE, |colours| colours.iter().map(colour).sum::<Vec4>() / colours.len() as f32)
    };
    draft.faces.par_iter().map(mean).collect()
}

fn map_of(material: &DraftMaterial, part: Use) -> Option<&TextureMap> {
    match part {
        Use::Reflectance => material.reflectance_map.as_ref(),
        Use::Emission => material.emission_map.as_ref(),
        Use::Opacity => material.opacity_map.as_ref(),
    }
}

/// How the texels of one of a material's textures count on a face whose corners have this alpha.
fn weight_of(material: &DraftMaterial, part: Use, corner_alpha: f32) -> Weight {
    match (part, material.opacity) {
        (Use::Opacity, _) => Weight::Alpha,
        (Use::Emission, _) | (_, Opacity::Opaque) => Weight::Plain,
        (_, Opacity::Blend) => Weight::Alpha,
        (_, Opacity::Mask(cutoff)) => {
            let least = 255.0 * cutoff / (material.alpha * corner_alpha).max(f32::MIN_POSITIVE);
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
fn sheets(draft: &Draft, colour_of: impl Fn(usize) -> Vec4) -> Vec<Sheet> {
    let mut sheets: Vec<Sheet> = Vec::new();
    let mut known = HashMap::new();
    let has_maps = |material: &DraftMaterial| Use::ALL.iter().any(|part| map_of(material, *part).is_some());
    let has_maps: Vec<bool> = draft.materials.iter().map(has_maps).collect();
    let textured = draft.faces.iter().enumerate().filter(|(_, face)| has_maps[face.material as usize]);
    for (index, face) in textured {
        let material = &draft.materials[face.material as usize];
        let corner_alpha = colour_of(index).w;
        for part in Use::ALL {
            let Some(map) = map_of(material, part) else { continue };
            let (weight, wrap) = (weight_of(material, part, corner_alpha), map.wrap);
            let sheet = *known.entry((Arc::as_ptr(&map.texture), weight, wrap)).or_insert_with(|| {
                sheets.push(Sheet { texture: map.texture.clone(), weight, wrap, faces: Vec::new() });
                sheets.len() - 1
            });
            sheets[sheet].faces.push((index as u32, part));
        }
    }
    sheets
}
