//! Radiance: a scene description and a view.
//!
//! `plastic` reflects on both sides, so each material is a `mixfunc` of itself in front and of
//! black behind. `light` shines in front, is black behind and reflects nothing; an emitter that
//! also reflects is an `illum`, which its alternate material makes reflect (and which a picture
//! shows without its own light). Sources take the radiance B_e/π. Triangles that emit are sampled
//! as rectangles of their area.

use std::f32::consts::PI;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use super::outside::{SKY_SIZE, sky_pixels};
use super::{SIZE, Surface, camera, spaced, surfaces};
use crate::scene::outside::{Outside, SUN_RADIUS};
use crate::scene::{CameraPose, Scene, WriteError, make_folder, write_file};

const README: &str = "Written by Selflink for Radiance.\n\
    oconv scene.rad > scene.oct\n\
    A picture: rpict -vf view.vf -x 640 -y 400 -ab 5 scene.oct > scene.hdr\n\
    Irradiance at the points of a reference (selflink reference SCENE --out points.csv):\n\
    tail -n +2 points.csv | cut -d, -f1-6 | tr , ' ' | rtrace -h -I+ -ab 8 -aa 0 -ad 4096 -as 0 -lr -12 -lw 1e-6 -dt 0 -dc 1 -dj 1 -ds .02 scene.oct > E.txt\n";

/// Writes the files; returns the scene description.
pub fn write(scene: &Scene, folder: &Path) -> Result<PathBuf, WriteError> {
    make_folder(folder)?;
    write_file(folder, "README.txt", |writer| writer.write_all(README.as_bytes()))?;
    if let Some(outside) = scene.outside().filter(|outside| outside.has_sky()) {
        write_file(folder, "sky.hdr", |writer| sky(writer, outside))?;
        write_file(folder, "sky.cal", |writer| writer.write_all(SKY_CAL.as_bytes()))?;
    }
    write_file(folder, "view.vf", |writer| writer.write_all(view(scene).as_bytes()))?;
    write_file(folder, "scene.rad", |writer| writer.write_all(rad(scene, &surfaces(scene)).as_bytes()))
}

fn view(scene: &Scene) -> String {
    let camera = camera(scene);
    let (CameraPose { eye, target, up, hfov_deg }, DVec3 { x, y, z }) = (camera, scene.to_file(camera.eye));
    let aspect = SIZE[1] as f32 / SIZE[0] as f32;
    let height = 2.0 * (aspect * (0.5 * hfov_deg.to_radians()).tan()).atan().to_degrees();
    let (direction, up) = (spaced((target - eye).normalize_or(Vec3::NEG_Z)), spaced(up));
    format!("rvu -vtv -vp {x} {y} {z} -vd {direction} -vu {up} -vh {hfov_deg} -vv {height}\n")
}

/// Where a direction lies in the sky's picture, whose height is 1 and width 2: y is up in it, −z at
/// its left and right rim.
const SKY_CAL: &str = "{ Written by Selflink }\n\
    skyu = if(Dx, atan2(Dx,-Dz), 2*PI + atan2(Dx,-Dz)) / PI;\n\
    skyv = 1 - acos(Dy)/PI;\n";

/// The sky as a picture of radiances.
fn sky(writer: &mut impl Write, outside: &Outside) -> io::Result<()> {
    let [width, height] = SKY_SIZE;
    let pixels: Vec<_> = sky_pixels(outside).map(|radiance| image::Rgb(radiance.to_array())).collect();
    image::codecs::hdr::HdrEncoder::new(writer).encode(&pixels, width, height).map_err(io::Error::other)
}

/// Sky and sun.
fn outside_rad(scene: &Scene) -> String {
    let Some(outside) = scene.outside() else { return String::new() };
    let mut text = String::new();
    if outside.has_sky() {
        text += "\nvoid colorpict sky-picture\n7 red green blue sky.hdr sky.cal skyu skyv\n0\n0\n\
            sky-picture glow sky-glow\n0\n0\n4 1 1 1 0\n\
            sky-glow source sky\n0\n0\n4 0 1 0 360\n";
    }
    if let Some(sun) = outside.sun() {
        let (radiance, angle) = (spaced(sun.radiance()), 2.0 * SUN_RADIUS.to_degrees());
        let direction = spaced(sun.direction);
        let _ = write!(
            text,
            "\nvoid light sun-light\n0\n0\n3 {radiance}\nsun-light source sun\n0\n0\n4 {direction} {angle}\n"
        );
    }
    text
}

/// The scene description.
fn rad(scene: &Scene, surfaces: &[Surface]) -> String {
    let mut text = "# Written by Selflink; lengths and axes as in the scene, RGB in W/m2 and W/(m2 sr)\n\
        void plastic black\n0\n0\n5 0 0 0 0 0\n"
        .to_owned();
    for surface in surfaces {
        let (name, finish) = (&surface.name, surface.finish);
        let reflects = finish.reflectance != Vec3::ZERO;
        let emits = finish.emission != Vec3::ZERO;
        if reflects || !emits {
            let _ = write!(
                text,
                "\nvoid plastic {name}-front\n0\n0\n5 {} 0 0\n\
                 void mixfunc {name}-sided\n4 {name}-front black if(Rdot,1,0) .\n0\n0\n",
                spaced(finish.reflectance)
            );
        }
        let modifier = match (emits, reflects) {
            (false, _) => format!("{name}-sided"),
            (true, true) => {
                let radiance = spaced(finish.emission / PI);
                let _ = write!(text, "void illum {name}-lamp\n1 {name}-sided\n0\n3 {radiance}\n");
                format!("{name}-lamp")
            }
            (true, false) => {
                let _ = write!(text, "\nvoid light {name}-lamp\n0\n0\n3 {}\n", spaced(finish.emission / PI));
                format!("{name}-lamp")
            }
        };
        for (index, face) in surface.faces.iter().enumerate() {
            let _ = write!(text, "{modifier} polygon {name}.{index}\n0\n0\n{}", 3 * face.len());
            for corner in face {
                let DVec3 { x, y, z } = scene.to_file(*corner);
                let _ = write!(text, " {x} {y} {z}");
            }
            text.push('\n');
        }
    }
    text + &outside_rad(scene)
}
