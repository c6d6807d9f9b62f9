//! Mitsuba 3: a scene file in XML, a mesh in PLY for each material (and each of its colours), and a
//! script that asks Mitsuba about the points of a reference.
//!
//! `diffuse` is bright on one side and area emitters shine on one, as faces do here. They take the
//! radiance B_e/π. Mitsuba computes in single precision: coordinates are the scene's own, whose
//! zero may lie elsewhere in its file ([`Scene::origin`]).

use std::f32::consts::PI;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::outside::{SKY_SIZE, sky_pixels, sun_disc};
use super::{SIZE, Surface, camera, spaced, surfaces};
use crate::export::exr::{self, FloatPicture};
use crate::export::ply;
use crate::scene::outside::Outside;
use crate::scene::{CameraPose, Scene, WriteError, make_folder, weld, write_file};

const README: &str = "Written by Selflink for Mitsuba 3 (pip install mitsuba numpy).\n\
    A picture: mitsuba -m llvm_ad_rgb scene.xml\n\
    Irradiance at the points of a reference: selflink reference SCENE --out points.csv; python check.py points.csv\n";

/// Asks Mitsuba about the points of a reference, which are in the coordinates of the scene's file.
const CHECK: &str = include_str!("check.py");
/// The line of it that says where the scene's zero lies in these.
const ORIGIN: &str = "ORIGIN = (0.0, 0.0, 0.0)";

/// Writes the files; returns the XML.
pub fn write(scene: &Scene, folder: &Path) -> Result<PathBuf, WriteError> {
    make_folder(&folder.join("meshes"))?;
    let surfaces = surfaces(scene);
    for surface in &surfaces {
        write_file(folder, &mesh_name(surface), |writer| mesh(writer, surface))?;
    }
    if let Some(outside) = scene.outside().filter(|outside| outside.has_sky()) {
        write_file(folder, SKY, |writer| exr::write(writer, &sky(outside)))?;
    }
    write_file(folder, "README.txt", |writer| writer.write_all(README.as_bytes()))?;
    let [x, y, z] = scene.origin.to_array();
    let check = CHECK.replace(ORIGIN, &format!("ORIGIN = ({x:?}, {y:?}, {z:?})"));
    write_file(folder, "check.py", |writer| writer.write_all(check.as_bytes()))?;
    write_file(folder, "scene.xml", |writer| writer.write_all(xml(scene, &surfaces).as_bytes()))
}

/// The picture of the sky.
const SKY: &str = "sky.exr";

/// The sky as Mitsuba's `envmap` reads it.
fn sky(outside: &Outside) -> FloatPicture {
    let pixels = sky_pixels(outside).map(|radiance| radiance.extend(1.0).to_array()).collect();
    FloatPicture { size: SKY_SIZE.map(|side| side as u32), pixels }
}

/// Sky and sun as emitters.
fn outside_xml(scene: &Scene) -> String {
    let Some(outside) = scene.outside() else { return String::new() };
    let mut text = String::new();
    if outside.has_sky() {
        let _ = write!(
            text,
            "    <emitter type=\"envmap\">\n        <string name=\"filename\" value=\"{SKY}\"/>\n    </emitter>\n"
        );
    }
    if let Some((centre, radius, radiance)) = sun_disc(scene, outside) {
        let (lower, upper) = scene.bounds();
        let (target, up) = (0.5 * (lower + upper), centre.normalize_or(Vec3::Y).any_orthonormal_vector());
        let _ = write!(
            text,
            r#"    <shape type="disk">
        <transform name="to_world">
            <scale value="{radius}"/>
            <lookat origin="{}" target="{}" up="{}"/>
        </transform>
        <bsdf type="diffuse">
            <rgb name="reflectance" value="0 0 0"/>
        </bsdf>
        <emitter type="area">
            <rgb name="radiance" value="{}"/>
        </emitter>
    </shape>
"#,
            commas(centre),
            commas(target),
            commas(up),
            spaced(radiance),
        );
    }
    text
}

fn commas(vector: Vec3) -> String {
    format!("{}, {}, {}", vector.x, vector.y, vector.z)
}

fn mesh_name(surface: &Surface) -> String {
    format!("meshes/{}.ply", surface.name)
}

/// The scene file.
fn xml(scene: &Scene, surfaces: &[Surface]) -> String {
    let CameraPose { eye, target, up, hfov_deg } = camera(scene);
    let mut text = format!(
        r#"<scene version="3.0.0">
    <integrator type="path">
        <integer name="max_depth" value="-1"/>
    </integrator>
    <sensor type="perspective">
        <string name="fov_axis" value="x"/>
        <float name="fov" value="{hfov_deg}"/>
        <transform name="to_world">
            <lookat origin="{}" target="{}" up="{}"/>
        </transform>
        <sampler type="independent">
            <integer name="sample_count" value="256"/>
        </sampler>
        <film type="hdrfilm">
            <integer name="width" value="{}"/>
            <integer name="height" value="{}"/>
        </film>
    </sensor>
"#,
        commas(eye),
        commas(target),
        commas(up),
        SIZE[0],
        SIZE[1],
    );
    for surface in surfaces {
        let finish = surface.finish;
        let _ = write!(
            text,
            r#"    <shape type="ply">
        <string name="filename" value="{}"/>
        <boolean name="face_normals" value="true"/>
        <bsdf type="diffuse">
            <rgb name="reflectance" value="{}"/>
        </bsdf>
"#,
            mesh_name(surface),
            spaced(finish.reflectance),
        );
        if finish.emission != Vec3::ZERO {
            let _ = write!(
                text,
                r#"        <emitter type="area">
            <rgb name="radiance" value="{}"/>
        </emitter>
"#,
                spaced(finish.emission / PI),
            );
        }
        text += "    </shape>\n";
    }
    text + &outside_xml(scene) + "</scene>\n"
}

/// A mesh of triangles whose corners are shared.
fn mesh(writer: &mut impl Write, surface: &Surface) -> io::Result<()> {
    let (corners, welded) = weld(&surface.faces.concat());
    let (mut triangles, mut rest) = (Vec::new(), &welded[..]);
    for face in &surface.faces {
        let (face, behind) = rest.split_at(face.len());
        rest = behind;
        triangles.extend((1..face.len() - 1).map(|index| [face[0], face[index], face[index + 1]]));
    }
    write!(
        writer,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        corners.len(),
        triangles.len()
    )?;
    writer.write_all(bytemuck::cast_slice(&corners))?;
    ply::write_triangles(writer, &triangles)
}
