//! Pictures of hand-made snapshots, drawn on whatever adapter answers (software Vulkan will do).
//!
//! Where there is no adapter the tests say so and check nothing.
#![cfg(feature = "gui")]

#[path = "support/left_out.rs"]
mod left_out;

use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;
use image::{Rgba, RgbaImage};
use selflink::hierarchy::ElementId;
use selflink::render::{
    Camera, Display, Frame, Line, Marks, Offscreen, Overlay, RenderError, auto_exposure, encode_gamma, pick,
    power_colour, tone_curve,
};
use selflink::scene::outside::{Daylight, Outside};
use selflink::scene::{CameraPose, MaterialId};
use selflink::solve::{ClusterBox, Leaf, Mesh, Snapshot, Stats};

/// One device for all tests: software ones take all cores anyway.
static DEVICE: Mutex<Option<Offscreen>> = Mutex::new(None);

/// Draws on the shared device; `None`, loudly, where there is no adapter.
fn draw(snapshot: &Snapshot, camera: &Camera, overlay: &Overlay, size: [u32; 2]) -> Option<RgbaImage> {
    draw_exposed(snapshot, camera, 1.0, overlay, size)
}

fn draw_exposed(
    snapshot: &Snapshot,
    camera: &Camera,
    exposure: f32,
    overlay: &Overlay,
    size: [u32; 2],
) -> Option<RgbaImage> {
    let picture = try_draw(snapshot, camera, exposure, overlay, size)?;
    Some(picture.expect("a small picture fits every adapter"))
}

fn try_draw(
    snapshot: &Snapshot,
    camera: &Camera,
    exposure: f32,
    overlay: &Overlay,
    size: [u32; 2],
) -> Option<Result<RgbaImage, RenderError>> {
    // A test that failed while drawing leaves the device usable.
    let mut device = DEVICE.lock().unwrap_or_else(PoisonError::into_inner);
    if device.is_none() {
        match Offscreen::new() {
            Ok(offscreen) => *device = Some(offscreen),
            Err(RenderError::NoAdapter) => {
                left_out::left_out("pictures; no graphics adapter draws them (install mesa-vulkan-drivers)");
                return None;
            }
            Err(error) => panic!("{error}"),
        }
    }
    let offscreen = device.as_mut().expect("made above");
    Some(offscreen.picture(snapshot, camera, &Display { exposure, ..Display::default() }, overlay, size))
}

/// Quads with one radiosity each, anticlockwise from their bright side, W/m².
fn snapshot(quads: &[([Vec3; 4], [f32; 3])]) -> Snapshot {
    let mut mesh = Mesh::default();
    let (mut vertex_radiosity, mut leaf_radiosity) = (Vec::new(), Vec::new());
    for (index, &(corners, radiosity)) in (0u32..).zip(quads) {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|corner| corner.to_array()));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        mesh.triangle_leaf.extend([index; 2]);
        mesh.outlines.extend((0..4).map(|corner| [first + corner, first + (corner + 1) % 4]));
        let [a, b, c, _] = corners;
        let area = (b - a).cross(c - b).length();
        let element = ElementId(index + 1);
        let material = MaterialId(0);
        mesh.leaves.push(Leaf { element, polygon: index, material, area, reachable_area: area, level: 0 });
        vertex_radiosity.extend([radiosity; 4]);
        leaf_radiosity.push(radiosity);
    }
    Snapshot {
        generation: 1,
        serial: 1,
        mesh: Arc::new(mesh),
        // Twice what is sent, as of a grey surface of ρ = ½.
        vertex_irradiance: vertex_radiosity
            .iter()
            .map(|radiosity: &[f32; 3]| radiosity.map(|channel| 2.0 * channel))
            .collect(),
        vertex_radiosity,
        leaf_irradiance: vec![[f32::INFINITY; 3]; leaf_radiosity.len()],
        leaf_radiosity,
        clusters: Arc::new(Vec::new()),
        former_step: None,
        field: None,
        solution_view: None,
        stats: Stats::default(),
    }
}

/// A square of side 2 in the plane z = 0 that faces +z.
const SQUARE: [Vec3; 4] =
    [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0), Vec3::new(-1.0, 1.0, 0.0)];

const BOUNDS: (Vec3, Vec3) = (Vec3::splat(-1.0), Vec3::splat(1.0));

/// Looks along −z (or +z from behind) at the origin from a distance of 2, 90° wide: the square
/// fills the middle half.
fn camera(eye_z: f32) -> Camera {
    let pose = CameraPose { eye: Vec3::new(0.0, 0.0, eye_z), target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 90.0 };
    Camera::from_pose(&pose, 1.0, BOUNDS)
}

fn displayed(radiosity: [f32; 3]) -> [u8; 3] {
    radiosity.map(|channel| (255.0 * encode_gamma(tone_curve(channel))).round() as u8)
}

/// Whether each channel is within 1 of 255: the adapter rounds as it likes.
fn near(pixel: &Rgba<u8>, colour: [u8; 3]) -> bool {
    pixel.0.iter().zip(colour).all(|(&is, should)| is.abs_diff(should) <= 1)
}

#[test]
fn a_known_radiosity_has_the_colour_of_the_tone_curve_and_the_rest_is_background() {
    // Truth: the same published formulas, evaluated here.
    let radiosity = [0.02, 0.4, 3.0];
    let Some(picture) = draw(&snapshot(&[(SQUARE, radiosity)]), &camera(2.0), &Overlay::default(), [101, 67]) else {
        return;
    };
    assert_eq!(picture.dimensions(), (101, 67));
    // hfov 90° was said for aspect 1, so the height spans 4 units at distance 2: the square is half
    // the height.
    for (x, y) in [(50, 33), (50, 18), (50, 48), (35, 33), (65, 33)] {
        assert!(near(picture.get_pixel(x, y), displayed(radiosity)), "({x}, {y}): {:?}", picture.get_pixel(x, y));
    }
    for (x, y) in [(50, 15), (50, 51), (32, 33), (68, 33)] {
        let Rgba([r, g, b, a]) = *picture.get_pixel(x, y);
        assert!((30..80).contains(&r) && (30..80).contains(&g) && (30..80).contains(&b) && a == 255);
    }
}

#[test]
fn a_face_seen_from_behind_lets_the_background_through() {
    let lit = snapshot(&[(SQUARE, [1.0; 3])]);
    let Some(behind) = draw(&lit, &camera(-2.0), &Overlay::default(), [64, 64]) else { return };
    let empty = draw(&snapshot(&[]), &camera(-2.0), &Overlay::default(), [64, 64]);
    assert_eq!(Some(behind), empty);
}

#[test]
fn the_nearer_face_hides_the_farther_one_at_any_distance() {
    // Truth: geometry. Two squares a thousandth of the scene's size apart, the farther one drawn
    // last.
    let farther = SQUARE.map(|corner| corner - Vec3::new(0.0, 0.0, 0.003));
    let two = snapshot(&[(SQUARE, [0.3, 0.0, 0.0]), (farther, [0.0, 0.3, 0.0])]);
    for (distance, hfov_deg) in [(0.05, 90.0), (2.0, 90.0), (200.0, 1.0)] {
        let pose = CameraPose { eye: Vec3::new(0.0, 0.0, distance), target: Vec3::ZERO, up: Vec3::Y, hfov_deg };
        let camera = Camera::from_pose(&pose, 1.0, BOUNDS);
        let Some(picture) = draw(&two, &camera, &Overlay::default(), [33, 33]) else { return };
        for (x, y) in [(16, 16), (14, 18), (20, 15)] {
            let pixel = picture.get_pixel(x, y);
            assert!(near(pixel, displayed([0.3, 0.0, 0.0])), "at {distance}: {pixel:?}");
        }
    }
}

#[test]
fn the_same_picture_twice_has_the_same_bytes() {
    let room = room(1.0);
    let camera = Camera::frame(BOUNDS, Vec3::Y, 1.5);
    let overlay = Overlay { elements: true, clusters: Some(0), marks: Marks::default() };
    let Some(first) = draw(&room, &camera, &overlay, [150, 100]) else { return };
    assert_eq!(draw(&room, &camera, &overlay, [150, 100]), Some(first));
}

#[test]
fn a_thousandfold_light_gives_the_same_picture_by_automatic_exposure() {
    // Truth: exposure is inversely proportional to the light; f32 rounding may move a channel by 1.
    let (dim, bright) = (room(1.0), room(1000.0));
    let ratio = auto_exposure(&dim) / auto_exposure(&bright);
    assert!((ratio / 1000.0 - 1.0).abs() < 1e-4, "{ratio}");
    let camera = Camera::frame(BOUNDS, Vec3::Y, 1.0);
    let draw = |room| draw_exposed(room, &camera, auto_exposure(room), &Overlay::default(), [80, 80]);
    let (Some(dim), Some(bright)) = (draw(&dim), draw(&bright)) else { return };
    let differ = dim.as_raw().iter().zip(bright.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(differ <= Some(1), "{differ:?}");
}

#[test]
fn sizes_that_cannot_be_drawn_are_refused_in_a_sentence() {
    for size in [[0, 100], [100, 0], [20_000, 10], [10, u32::MAX]] {
        let result = try_draw(&snapshot(&[]), &camera(2.0), 1.0, &Overlay::default(), size);
        let Some(result) = result else { return };
        let error = result.expect_err("no adapter draws this");
        assert!(matches!(error, RenderError::Size { .. }), "{error}");
        assert!(error.to_string().starts_with(&format!("a picture of {}×{} pixels", size[0], size[1])));
    }
}

#[test]
fn outlines_and_boxes_are_seen_where_they_lie() {
    let mut lit = snapshot(&[(SQUARE, [0.18; 3])]);
    let (lower, upper) = (Vec3::new(-1.5, -1.5, -0.5), Vec3::new(1.5, 1.5, 0.0));
    lit.clusters = Arc::new(vec![ClusterBox { lower, upper, level: 2, polygons: 1 }]);
    let camera = camera(2.0);
    let Some(plain) = draw(&lit, &camera, &Overlay::default(), [200, 200]) else { return };
    let changed = |overlay: &Overlay, x: u32, y: u32| {
        let picture = draw(&lit, &camera, overlay, [200, 200]).expect("there was a device before");
        // The line may fall on either side of a pixel's border.
        (y - 1..=y + 1).any(|y| picture.get_pixel(x, y) != plain.get_pixel(x, y))
    };
    // The square's lower edge is at 150 of 200 pixels, the box's (at z = 0) at 175.
    let elements = Overlay { elements: true, ..Overlay::default() };
    assert!(changed(&elements, 80, 150) && !changed(&elements, 80, 175) && !changed(&elements, 80, 120));
    let clusters = Overlay { clusters: Some(2), ..Overlay::default() };
    assert!(changed(&clusters, 80, 175) && !changed(&clusters, 80, 150));
    let other_level = Overlay { clusters: Some(1), ..Overlay::default() };
    assert!(!changed(&other_level, 80, 175));
}

#[test]
fn marks_show_their_colour_and_shimmer_through_what_hides_them() {
    let lit = snapshot(&[(SQUARE, [0.18; 3])]);
    let [r, g, b] = power_colour(1.0);
    let camera = camera(2.0);
    let middle = |z: f32| {
        let line = Line::new(Vec3::new(0.0, -0.8, z), Vec3::new(0.0, 0.8, z), 2.0, [r, g, b, 255]);
        let overlay = Overlay { marks: vec![line].into(), ..Overlay::default() };
        let picture = draw(&lit, &camera, &overlay, [201, 201])?;
        // The most yellow pixel near the middle, since a thin line may fall between two.
        (99..=101).map(|x| *picture.get_pixel(x, 100)).min_by_key(|pixel| pixel.0[2])
    };
    let Some(seen) = middle(0.1) else { return };
    let hidden = middle(-0.1).expect("there was a device before");
    let (strong, wall) = (power_colour(1.0), displayed([0.18; 3]));
    let closeness =
        |pixel: Rgba<u8>| (f32::from(wall[2]) - f32::from(pixel.0[2])) / (f32::from(wall[2]) - f32::from(strong[2]));
    assert!(closeness(seen) > 0.7, "{seen:?}");
    assert!((0.1..0.5).contains(&closeness(hidden)), "{hidden:?}");
}

#[test]
fn what_is_picked_is_what_is_seen() {
    // Truth: the picture itself. Each leaf has a colour of its own; the ray through a pixel must
    // meet the leaf of its colour.
    let colours = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
    let place = |x: f32, z: f32| SQUARE.map(|corner| 0.6 * corner + Vec3::new(x, 0.0, z));
    let three =
        snapshot(&[(place(-0.5, 0.0), colours[0]), (place(0.0, 0.4), colours[1]), (place(0.5, -0.4), colours[2])]);
    let pose = CameraPose { eye: Vec3::new(0.7, 0.9, 2.5), target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 70.0 };
    let aspect = 1.5;
    let camera = Camera::from_pose(&pose, aspect, BOUNDS);
    let Some(picture) = draw(&three, &camera, &Overlay::default(), [90, 60]) else { return };
    let mut seen = [0; 4];
    for (x, y, pixel) in picture.enumerate_pixels() {
        let ndc = glam::vec2((x as f32 + 0.5) / 45.0 - 1.0, 1.0 - (y as f32 + 0.5) / 30.0);
        let (origin, direction) = camera.ray(ndc, aspect);
        let picked = pick(&three.mesh, origin, direction).map(|picked| picked.leaf as usize);
        // Pixels on a rim mix two colours and tell nothing.
        if let Some(leaf) = colours.iter().position(|&colour| near(pixel, displayed(colour))) {
            assert_eq!(picked, Some(leaf), "at ({x}, {y})");
            seen[leaf] += 1;
        } else if picked.is_none() {
            seen[3] += 1;
        }
    }
    assert!(seen.iter().all(|&pixels| pixels > 100), "{seen:?}");
}

#[test]
fn rims_of_faces_are_not_extrapolated() {
    // Truth: no vertex is darker than 2 W/m². Slivers cross pixels whose middles they do not cover.
    let sliver =
        |x: f32| [(x, -1.0), (x + 0.01, -1.0), (x + 0.03, 1.0), (x + 0.02, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.1));
    let mut lit = snapshot(&[(SQUARE, [2.0; 3]), (sliver(-0.5), [2.0; 3]), (sliver(0.2), [2.0; 3])]);
    for vertex in [5, 6, 9, 10] {
        lit.vertex_radiosity[vertex] = [20.0; 3];
    }
    let pose = CameraPose { hfov_deg: 40.0, ..camera(2.0).pose(1.0) };
    let camera = Camera::from_pose(&pose, 1.0, BOUNDS);
    let Some(picture) = draw(&lit, &camera, &Overlay::default(), [99, 99]) else { return };
    let [darkest, ..] = displayed([2.0; 3]);
    assert!(picture.pixels().all(|pixel| pixel.0[0] + 1 >= darkest));
}

/// The inside of a box from −1 to 1 without its front: floor, ceiling, back and side walls of
/// different radiosities.
fn room(light: f32) -> Snapshot {
    let turned = |turn: fn(Vec3) -> Vec3| SQUARE.map(|corner| turn(corner - Vec3::Z));
    let quads = [
        (turned(|p| p), [0.5, 0.5, 0.5]),
        (turned(|p| Vec3::new(p.x, p.z, -p.y)), [0.3, 0.25, 0.2]),
        (turned(|p| Vec3::new(p.x, -p.z, p.y)), [0.6, 0.6, 0.6]),
        (turned(|p| Vec3::new(p.z, p.y, -p.x)), [0.5, 0.1, 0.05]),
        (turned(|p| Vec3::new(-p.z, p.y, p.x)), [0.1, 0.4, 0.1]),
    ];
    snapshot(&quads.map(|(corners, radiosity)| (corners, radiosity.map(|channel| light * channel))))
}

/// Truth: a uniform sky looks as bright as a surface that sends all that open ground gets; below
/// the horizon it is dark, and the ground of other pictures is seen. Behind the mesh nothing of it
/// is.
#[test]
fn the_sky_is_seen_behind_the_mesh() {
    let snapshot = snapshot(&[(SQUARE, [1.0, 0.0, 0.0])]);
    let Some(plain) = draw(&snapshot, &camera(2.0), &Overlay::default(), [64, 64]) else { return };
    let sky = Some("uniform:0.4W".parse().expect("a sky"));
    let outside = Outside::new(&Daylight { sky, sun: None }, Vec3::Y, |_| Err(String::new())).expect("a sky");
    let display = Display::default();
    let frame = Frame {
        snapshot: &snapshot,
        outside: Some(&Arc::new(outside)),
        camera: &camera(2.0),
        display: &display,
        gathered: None,
        overlay: &Overlay::default(),
        size: [64, 64],
    };
    let mut device = DEVICE.lock().unwrap_or_else(PoisonError::into_inner);
    let lit = device.as_mut().expect("it drew before").picture_over(&frame).expect("a small picture");
    let should = displayed([0.4; 3]);
    for (x, y) in [(3, 3), (32, 5), (60, 12)] {
        let is = lit.get_pixel(x, y).0;
        assert!((0..3).all(|channel| is[channel].abs_diff(should[channel]) <= 1), "{x} {y}: {is:?}, not {should:?}");
    }
    assert_eq!(lit.get_pixel(32, 32), plain.get_pixel(32, 32));
    let (below, usual) = (lit.get_pixel(5, 60).0, plain.get_pixel(5, 60).0);
    assert!((0..3).all(|channel| below[channel].abs_diff(usual[channel]) <= 2), "{below:?}, not {usual:?}");
}
