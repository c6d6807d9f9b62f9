//! Materials: factors and textures of base colour and emission, opacity, sides.

use std::collections::HashMap;
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;

use glam::{Affine2, Vec2, Vec3, Vec4};
use gltf::json::Root;
use gltf::json::material::{AlphaMode, Material};
use gltf::json::texture::{Info, WrappingMode};
use gltf::json::validation::Checked;

use super::buffers::GltfData;
use crate::scene::draft::{Draft, DraftMaterial, GREY};
use crate::scene::texture::decode::{Encoded, decode_all};
use crate::scene::texture::{Opacity, Texture, TextureMap, Wrap};

/// The diffuse part of a material: a factor and a texture.
struct Diffuse<'a> {
    factor: Vec4,
    texture: Option<&'a Info>,
}

fn diffuse(material: &Material) -> Diffuse<'_> {
    let old = material.extensions.as_ref().and_then(|it| it.pbr_specular_glossiness.as_ref());
    match old {
        Some(old) => Diffuse { factor: Vec4::from_array(old.diffuse_factor.0), texture: old.diffuse_texture.as_ref() },
        None => {
            let surface = &material.pbr_metallic_roughness;
            let factor = Vec4::from_array(surface.base_color_factor.0);
            Diffuse { factor, texture: surface.base_color_texture.as_ref() }
        }
    }
}

/// Sets of texture coordinates that a material uses.
#[derive(Clone, Copy, Default)]
pub(super) struct UvSets {
    /// That of its colour, or else of its emission.
    pub first: u32,
    /// That of its emission, where it is another one.
    pub of_emission: Option<u32>,
}

/// Adds materials in the order of the file, so that its material numbers are the draft's; gives the
/// sets of texture coordinates that each uses.
pub(super) fn add_materials(draft: &mut Draft, data: &GltfData) -> Vec<UvSets> {
    let root = data.root;
    let textures = textures(draft, data);
    let mut uv_sets = Vec::with_capacity(root.materials.len());
    for (index, material) in root.materials.iter().enumerate() {
        let name = material.name.clone().unwrap_or_else(|| format!("material_{index}"));
        let Diffuse { factor, texture } = diffuse(material);
        let reflectance_map = texture.and_then(|info| map_of(root, info, &textures));
        let unread = texture.is_some() && reflectance_map.is_none();
        let extensions = material.extensions.as_ref();
        let strength = extensions.and_then(|it| it.emissive_strength.as_ref()).map_or(1.0, |it| it.emissive_strength.0);
        let glow = Vec3::from_array(material.emissive_factor.0);
        let emission_map = material.emissive_texture.as_ref().and_then(|info| map_of(root, info, &textures));
        let is_dark = material.emissive_texture.is_some() && emission_map.is_none();
        let sets = [texture, material.emissive_texture.as_ref()].map(|info| info.map(set_of));
        let first = sets[0].or(sets[1]).unwrap_or(0);
        let of_emission = sets[1].filter(|set| *set != first && glow != Vec3::ZERO);
        uv_sets.push(UvSets { first, of_emission });
        let cutoff = material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
        let sound = |value: Vec3| if value.is_finite() { value } else { Vec3::ZERO };
        draft.materials.push(DraftMaterial {
            reflectance: sound(factor.truncate() * if unread { GREY } else { Vec3::ONE }),
            alpha: factor.w,
            emission: if is_dark { Vec3::ZERO } else { sound(PI * strength * glow) },
            reflectance_map,
            // A black factor leaves nothing of the texture.
            emission_map: emission_map.filter(|_| glow != Vec3::ZERO),
            opacity: match material.alpha_mode {
                Checked::Valid(AlphaMode::Blend) => Opacity::Blend,
                Checked::Valid(AlphaMode::Mask) if cutoff.is_finite() => Opacity::Mask(cutoff),
                _ => Opacity::Opaque,
            },
            transmits: extensions
                .and_then(|it| it.transmission.as_ref())
                .is_some_and(|it| it.transmission_factor.0 > 0.5),
            is_two_sided: material.double_sided,
            has_emission_uvs: of_emission.is_some(),
            ..DraftMaterial::new(&name)
        });
    }
    uv_sets
}

/// The set of texture coordinates that a texture is laid on by.
fn set_of(info: &Info) -> u32 {
    let transform = info.extensions.as_ref().and_then(|it| it.texture_transform.as_ref());
    transform.and_then(|it| it.tex_coord).unwrap_or(info.tex_coord)
}

/// A texture as a material lays it on.
fn map_of(root: &Root, info: &Info, textures: &HashMap<usize, Arc<Texture>>) -> Option<TextureMap> {
    let said = root.textures.get(info.index.value())?;
    let texture = textures.get(&said.source.value())?.clone();
    let transform = info.extensions.as_ref().and_then(|it| it.texture_transform.as_ref());
    let transform = transform.map_or(Affine2::IDENTITY, |it| {
        let (offset, scale) = (Vec2::from_array(it.offset.0), Vec2::from_array(it.scale.0));
        // Anticlockwise where v runs downwards.
        Affine2::from_scale_angle_translation(scale, -it.rotation.0, offset)
    });
    let sampler = said.sampler.and_then(|sampler| root.samplers.get(sampler.value()));
    let wrap = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let wrap = sampler.map_or([Wrap::Repeat; 2], |sampler| [wrap(sampler.wrap_s), wrap(sampler.wrap_t)]);
    transform.is_finite().then_some(TextureMap { texture, transform, wrap })
}

/// Pictures by image number, of those that matter here.
fn textures(draft: &mut Draft, data: &GltfData) -> HashMap<usize, Arc<Texture>> {
    let root = data.root;
    let emits = |material: &&Material| material.emissive_factor.0 != [0.0; 3];
    let colours = root.materials.iter().filter_map(|material| diffuse(material).texture);
    let glows = root.materials.iter().filter(emits).filter_map(|material| material.emissive_texture.as_ref());
    let image = |info: &Info| root.textures.get(info.index.value()).map(|texture| texture.source.value());
    let mut numbers: Vec<usize> = colours.chain(glows).filter_map(image).collect();
    numbers.sort_unstable();
    numbers.dedup();
    // Many images can be one picture.
    let mut sources: Vec<usize> = Vec::new();
    let mut source_of: HashMap<_, usize> = HashMap::new();
    let place = |number: &usize| {
        let source = root.images.get(*number).map(|image| (image.buffer_view, &image.uri));
        *source_of.entry(source).or_insert_with(|| {
            sources.push(*number);
            sources.len() - 1
        })
    };
    let places: Vec<usize> = numbers.iter().map(place).collect();
    let decoded = decode_all(&sources, |number| {
        let image = root.images.get(*number).ok_or("there is no such image")?;
        let of_uri = image.uri.as_deref().map(|uri| Path::new(uri).extension().unwrap_or_default().to_string_lossy());
        let of_type = image.mime_type.as_ref().and_then(|mime| mime.0.rsplit('/').next());
        let extension = of_type.map(str::to_owned).or_else(|| of_uri.map(std::borrow::Cow::into_owned));
        Ok(Encoded { bytes: data.image(image)?, extension: extension.unwrap_or_default() })
    });
    let mut known = HashMap::new();
    for (number, place) in numbers.into_iter().zip(places) {
        match &decoded[place] {
            Ok(texture) => {
                known.insert(number, texture.clone());
            }
            Err(problem) => {
                let name = root.images.get(number).and_then(|image| image.name.as_deref().or(image.uri.as_deref()));
                let name = name.filter(|name| !name.is_empty() && !name.starts_with("data:"));
                let name = name.map_or_else(|| format!("of image {number}"), crate::scene::sanitize::quoted);
                draft.skipped.unread_texture(name, problem);
            }
        }
    }
    known
}
