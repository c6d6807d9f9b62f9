//! What each face of a draft reflects, emits and hides by itself: textures averaged over its part of their plane, times the colours
//! of its corners, times its material's factors.

use std::sync::Arc;

use glam::{DVec2, Vec3, Vec4};
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
    let mut painted: Vec<Painted> =
        draft.faces.iter().map(|face| plain(&draft.materials[face.material as usize])).collect();
    let firsts = first_corners(draft);
    let mut waiting = sums_wanted(&draft.materials);
    while let Some((texture, weight, wrap)) = waiting.pop() {
        let sums = RowSums::new(&texture, weight, wrap);
        for part in [Use::Reflectance, Use::Emission] {
            let wanted = |material: &DraftMaterial| {
                let map =
                    map_of(material, part).filter(|map| key_of(material, map, part) == key(&texture, weight, wrap));
                map.cloned()
            };
            let maps: Vec<Option<TextureMap>> = draft.materials.iter().map(wanted).collect();
            if maps.iter().all(Option::is_none) {
                continue;
            }
            let of_all = sums.of_all();
            painted.par_iter_mut().enumerate().for_each(|(index, painted)| {
                let face = &draft.faces[index];
                let Some(map) = &maps[face.material as usize] else { return };
                let corners = firsts[index]..firsts[index] + face.count as usize;
                let mean = match draft.uvs.get(corners) {
                    Some(uvs) if uvs.iter().all(|uv| uv.is_finite()) => {
                        let transform = map.transform.as_daffine2();
                        let corner = move |uv: &glam::Vec2| -> DVec2 { transform.transform_point2(uv.as_dvec2()) };
                        sums.over(uvs.iter().map(corner))
                    }
                    _ => of_all,
                };
                painted.multiply(mean, part);
            });
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

type Key = (*const Texture, Weight, [Wrap; 2]);

fn key(texture: &Arc<Texture>, weight: Weight, wrap: [Wrap; 2]) -> Key {
    (Arc::as_ptr(texture), weight, wrap)
}

fn key_of(material: &DraftMaterial, map: &TextureMap, part: Use) -> Key {
    key(&map.texture, weight_of(material, part), map.wrap)
}

/// The sums that materials need, each once.
fn sums_wanted(materials: &[DraftMaterial]) -> Vec<(Arc<Texture>, Weight, [Wrap; 2])> {
    let mut known = Vec::new();
    let mut wanted = Vec::new();
    for (material, part) in materials.iter().flat_map(|it| [(it, Use::Reflectance), (it, Use::Emission)]) {
        let Some(map) = map_of(material, part) else { continue };
        let key = key_of(material, map, part);
        if !known.contains(&key) {
            known.push(key);
            wanted.push((map.texture.clone(), key.1, key.2));
        }
    }
    wanted
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
