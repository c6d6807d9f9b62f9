//! The Cornell box after the measurements of Cornell University's Program of Computer Graphics, in
//! metres.
//!
//! The measured walls lean by up to 6 mm, which would bend two of the quads; here they are plumb.
//! The lamp is a panel 2 mm thick on the ceiling. The front is open, as in the original: the camera
//! stands outside.

use glam::{Vec3, vec3};

use super::shapes::{Draft, Faces};
use crate::scene::{CameraPose, MaterialId, Scene};

/// The measurements are in millimetres.
const METRES: f32 = 1e-3;
const WIDTH: f32 = 556.0;
const HEIGHT: f32 = 548.8;
const DEPTH: f32 = 559.2;
const LAMP_THICKNESS: f32 = 2.0;

pub(super) fn build() -> Scene {
    let mut draft = Draft::new("cornell");
    let white = draft.paint("white", vec3(0.725, 0.71, 0.68));
    let red = draft.paint("red", vec3(0.63, 0.065, 0.05));
    let green = draft.paint("green", vec3(0.14, 0.45, 0.091));
    let light = draft.lamp("light", vec3(0.78, 0.78, 0.78), vec3(17.0, 12.0, 4.0));

    let corner = |x: f32, y: f32, z: f32| METRES * vec3(x * WIDTH, y * HEIGHT, z * DEPTH);
    draft.group("walls", |d| {
        // Seen from the camera, which looks along +z, +x is on the left.
        d.quad([corner(0., 0., 0.), corner(0., 0., 1.), corner(1., 0., 1.), corner(1., 0., 0.)], white);
        d.quad([corner(0., 1., 0.), corner(1., 1., 0.), corner(1., 1., 1.), corner(0., 1., 1.)], white);
        d.quad([corner(1., 0., 1.), corner(0., 0., 1.), corner(0., 1., 1.), corner(1., 1., 1.)], white);
        d.quad([corner(1., 0., 0.), corner(1., 0., 1.), corner(1., 1., 1.), corner(1., 1., 0.)], red);
        d.quad([corner(0., 0., 1.), corner(0., 0., 0.), corner(0., 1., 0.), corner(0., 1., 1.)], green);
    });
    draft.group("lamp", |d| {
        let lower = METRES * vec3(213.0, HEIGHT - LAMP_THICKNESS, 227.0);
        let upper = METRES * vec3(343.0, HEIGHT, 332.0);
        d.cuboid(lower, upper, Faces::ENDS, white);
        d.cuboid(lower, upper, !Faces::BOTTOM, light);
    });
    let short = [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]];
    let tall = [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]];
    draft.group("short_block", |d| block(d, short, 165.0, white));
    draft.group("tall_block", |d| block(d, tall, 330.0, white));

    let mut scene = draft.finish();
    scene.camera = Some(CameraPose {
        eye: METRES * vec3(278.0, 273.0, -800.0),
        target: METRES * vec3(278.0, 273.0, 0.0),
        up: Vec3::Y,
        hfov_deg: 59.5, // the original's 39.3° (25 mm of film behind a 35 mm lens) from top to bottom of a 16:10 view
    });
    scene
}

/// A block over its footprint (x, z; anticlockwise from above), which stands on the floor.
fn block(draft: &mut Draft, footprint: [[f32; 2]; 4], height: f32, material: MaterialId) {
    let bottom = footprint.map(|[x, z]| METRES * vec3(x, 0.0, z));
    let top = bottom.map(|corner| corner.with_y(METRES * height));
    draft.quad(top, material);
    for (here, next) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        draft.quad([bottom[here], bottom[next], top[next], top[here]], material);
    }
}
