//! Extensions of glTF: which are read, which change nothing here, and which a person is informed
//! of.

use gltf::json::Root;
use gltf::json::validation::Checked;

use super::buffers::Problem;
use crate::scene::UnreadExtension;
use crate::scene::sanitize;

/// Extensions that are read, as far as they tell of geometry, diffuse light and views.
const READ: [&str; 16] = [
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_lights_punctual",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    // Costs its texture alone, which is reported.
    "EXT_texture_avif",
    "KHR_texture_basisu",
    "MSFT_texture_dds",
    // Tells what animations move, and they are counted.
    "KHR_animation_pointer",
    // A file that has such numbers is refused.
    "KHR_accessor_float64",
];

/// Extensions that change nothing of diffuse light: gloss, and words about the file.
const NO_MATTER: [&str; 10] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_volume",
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// Extensions of which there is more to say than that they are not read.
const REMARKS: [(&str, &str); 4] = [
    (
        "EXT_lights_image_based",
        "Light from all around (EXT_lights_image_based) is not read; give the scene a sky, such as `--sky PICTURE`.",
    ),
    ("KHR_materials_variants", "Materials have variants (KHR_materials_variants); the default is shown."),
    ("KHR_materials_unlit", "Materials that no light is to change (KHR_materials_unlit) are lit as others are."),
    (
        "KHR_materials_diffuse_transmission",
        "Faces that light shines through in all directions (KHR_materials_diffuse_transmission) are opaque.",
    ),
];

/// Extensions that are not read, each once: those that the file needs, then those that it uses.
pub(super) fn unread(root: &Root) -> Vec<UnreadExtension> {
    let mut unread: Vec<UnreadExtension> = Vec::new();
    let all = root.extensions_required.iter().zip(std::iter::repeat(true));
    let all = all.chain(root.extensions_used.iter().zip(std::iter::repeat(false)));
    for (name, is_required) in all.filter(|(name, _)| !is_known(name)).take(MOST) {
        if unread.iter().all(|known| known.name != sanitize::name(name)) {
            let remark = REMARKS.iter().find(|(of, _)| of == name).map(|(_, remark)| (*remark).to_owned());
            unread.push(UnreadExtension { name: sanitize::name(name), is_required, remark });
        }
    }
    unread
}

/// So many names are looked at.
const MOST: usize = 200;

fn is_known(name: &str) -> bool {
    READ.contains(&name) || NO_MATTER.contains(&name)
}

/// Refuses numbers of 64 bits.
///
/// # Errors
/// One sentence if there are any.
pub(super) fn check_numbers(root: &Root) -> Result<(), Problem> {
    let name = "KHR_accessor_float64";
    let is_unknown = |accessor: &gltf::json::Accessor| matches!(accessor.component_type, Checked::Invalid);
    if root.extensions_used.iter().any(|used| used == name) && root.accessors.iter().any(is_unknown) {
        return Err(format!("its numbers have 64 bits ({name}), which are not read; export it with 32 bits"));
    }
    Ok(())
}
