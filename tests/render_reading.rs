//! False colours and lines of equal value in pictures of hand-made snapshots, drawn on whatever
//! adapter answers.
//!
//! Truth: the ramp's published colours, and where a value that grows evenly across a square has a
//! given height.
#![cfg(feature = "gui")]

#[path = "support/left_out.rs"]
mod left_out;

use std::sync::Arc;

use glam::Vec3;
use image::RgbaImage;
use selflink::base::photometry::{Quantity, ShownIn, Unit};
use selflink::hierarchy::ElementId;
use selflink::render::{
    Camera, ColourScale, Display, Isolines, Offscreen, Overlay, Ramp, Reading, RenderError, Spacing,
};
use selflink::scene::{CameraPose, MaterialId};
use selflink::solve::{Leaf, Mesh, Snapshot, Stats};

const SIZE: u32 = 201;

/// A square of side 2 that fills the picture: E grows evenly from 1 W/m² at the left to 3 at the
/// right, B is a tenth of it.
fn slope() -> Snapshot {
    let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let leaf =
        Leaf { element: ElementId(1), polygon: 0, material: MaterialId(0), area: 4.0, reachable_area: 4.0, level: 0 };
    let irradiance = [1.0, 3.0, 3.0, 1.0];
    Snapshot {
        generation: 1,
        serial: 1,
        mesh: Arc::new(Mesh {
            positions: corners.into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_leaf: vec![0; 2],
            outlines: Vec::new(),
            leaves: vec![leaf],
        }),
        vertex_radiosity: irradiance.map(|value| [0.1 * value; 3]).into(),
        vertex_irradiance: irradiance.map(|value| [value; 3]).into(),
        leaf_irradiance: vec![[2.0; 3]],
        leaf_radiosity: vec![[0.2; 3]],
        clusters: Arc::default(),
        former_step: None,
        field: None,
        solution_view: None,
        stats: Stats::default(),
    }
}

/// Draws it filling the picture; `None`, loudly, where there is no adapter.
fn draw(snapshot: &Snapshot, reading: Option<Reading>) -> Option<RgbaImage> {
    let mut offscreen = match Offscreen::new() {
        Ok(offscreen) => offscreen,
        Err(RenderError::NoAdapter) => {
            left_out::left_out("pictures; no graphics adapter draws them (install mesa-vulkan-drivers)");
            return None;
        }
        Err(error) => panic!("{error}"),
    };
    let pose = CameraPose { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 90.0 };
    let camera = Camera::from_pose(&pose, 1.0, (Vec3::splat(-1.0), Vec3::splat(1.0)));
    let display = Display { reading, ..Display::default() };
    Some(offscreen.picture(snapshot, &camera, &display, &Overlay::default(), [SIZE; 2]).expect("a small picture"))
}

const LUX: ShownIn = ShownIn::Unit(Unit::Lumens);

fn scale(low: f32, high: f32, spacing: Spacing, ramp: Ramp) -> ColourScale {
    ColourScale { low, high, spacing, ramp }
}

/// The value in the middle of a column of pixels.
fn value_at(x: u32) -> f32 {
    1.0 + 2.0 * (x as f32 + 0.5) / SIZE as f32
}

/// Whether each channel is within 1 of 255: the adapter rounds as it likes.
fn is_near(is: [u8; 4], should: [u8; 3]) -> bool {
    is.iter().zip(should).all(|(is, should)| is.abs_diff(should) <= 1)
}

#[test]
fn known_values_have_the_colours_of_the_ramp() {
    let cases = [
        (Quantity::Irradiance, 1.0, scale(0.0, 4.0, Spacing::Linear, Ramp::Viridis)),
        (Quantity::Radiosity, 0.1, scale(0.05, 0.5, Spacing::Logarithmic, Ramp::Viridis)),
        (Quantity::Irradiance, 1.0, scale(1.5, 2.5, Spacing::Linear, Ramp::Cividis)),
    ];
    for (quantity, share, scale) in cases {
        let reading = Reading { quantity, shown_in: LUX, scale, fills: true, isolines: Isolines::default() };
        let Some(picture) = draw(&slope(), Some(reading)) else { return };
        for (x, y) in [(3, 100), (60, 20), (100, 101), (140, 180), (197, 60)] {
            let (is, should) = (picture.get_pixel(x, y).0, scale.colour(share * value_at(x)));
            assert!(is_near(is, should), "{quantity:?} at {x}: {is:?} instead of {should:?}");
        }
    }
}

#[test]
fn lines_lie_where_their_values_are_and_nowhere_else() {
    let scale = scale(0.0, 4.0, Spacing::Linear, Ramp::Viridis);
    let isolines = Isolines::default();
    let reading = Reading { quantity: Quantity::Irradiance, shown_in: LUX, scale, fills: true, isolines };
    let Some(plain) = draw(&slope(), Some(reading)) else { return };
    let lines = Isolines::at([1.5, 2.25, 7.0]);
    let lined = draw(&slope(), Some(Reading { isolines: lines, ..reading })).expect("there was a device before");
    for y in [30, 100, 170] {
        let differ: Vec<u32> = (0..SIZE).filter(|&x| lined.get_pixel(x, y) != plain.get_pixel(x, y)).collect();
        // E = 1 + x across the square: a quarter and five eighths of the way.
        let (first, second): (Vec<u32>, Vec<u32>) = differ.iter().partition(|x| **x < SIZE * 7 / 16);
        for (line, truth) in [(first, 0.25), (second, 0.625)] {
            let middle = line.iter().sum::<u32>() as f32 / line.len() as f32 + 0.5;
            assert!((1..=4).contains(&line.len()), "{line:?} is as wide as a line");
            assert!((middle - truth * SIZE as f32).abs() <= 0.75, "{middle}");
        }
    }
}

#[test]
fn lines_of_what_arrives_are_drawn_over_the_lit_picture() {
    let Some(lit) = draw(&slope(), None) else { return };
    let scale = scale(0.0, 4.0, Spacing::Linear, Ramp::Viridis);
    let isolines = Isolines::at([2.0]);
    let reading = Reading { quantity: Quantity::Irradiance, shown_in: LUX, scale, fills: false, isolines };
    let lined = draw(&slope(), Some(reading)).expect("there was a device before");
    let differ = |x: u32| lined.get_pixel(x, 50) != lit.get_pixel(x, 50);
    assert!(differ(100) && !differ(60) && !differ(140));
}

#[test]
fn a_plain_has_no_lines_at_its_own_height() {
    let mut even = slope();
    even.vertex_irradiance = vec![[2.0; 3]; 4];
    let scale = scale(0.0, 4.0, Spacing::Linear, Ramp::Viridis);
    let isolines = Isolines::at([2.0]);
    let reading = Reading { quantity: Quantity::Irradiance, shown_in: LUX, scale, fills: true, isolines };
    let Some(picture) = draw(&even, Some(reading)) else { return };
    let first = picture.get_pixel(10, 10);
    assert!(picture.get_pixel(100, 100) == first && is_near(first.0, scale.colour(2.0)), "{first:?}");
}

/// Truth: the definition of a range in round numbers around 97 % of the area, lamps aside.
#[test]
fn an_automatic_range_holds_most_of_the_area_in_round_numbers() {
    let mut snapshot = slope();
    let leaf = snapshot.mesh.leaves[0];
    let mut mesh = (*snapshot.mesh).clone();
    mesh.leaves = vec![leaf; 101];
    snapshot.mesh = Arc::new(mesh);
    // 100 leaves of up to 730 lx, and a lamp.
    snapshot.leaf_irradiance = (1..=101).map(|step| [step as f32 * 7.3 / 179.0; 3]).collect();
    snapshot.leaf_radiosity = vec![[0.01; 3]; 100];
    snapshot.leaf_radiosity.push([1000.0; 3]);
    let range = |spacing| {
        let scale = ColourScale::automatic(&snapshot, Quantity::Irradiance, spacing, LUX, Ramp::Viridis);
        [scale.low, scale.high].map(|value| (179.0 * value * 10.0).round() / 10.0)
    };
    assert_eq!(range(Spacing::Linear), [0.0, 800.0]);
    assert_eq!(range(Spacing::Logarithmic), [10.0, 800.0]);
}
