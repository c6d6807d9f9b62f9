//! A light for scenes that have none: where under the ceiling a panel goes.
//!
//! [`Scene::add_ceiling_light`] takes a position; this module finds one by casting rays up and down
//! through the scene.

use glam::Vec3;

use crate::base::format::to_one_digit;
use crate::geometry::Occluders;
use crate::scene::Scene;

/// A free space below a ceiling is at least this share of the scene's height; less is a drawer or a
/// gap in a roof.
const LEAST_SPACE: f32 = 0.1;
/// The panel hangs this share of the scene's height below the ceiling.
const CLEARANCE: f32 = 0.005;
/// Walls are looked for this share of the way from the eye to the ceiling, where little furniture
/// is.
const ABOVE_FURNITURE: f32 = 0.8;
/// Width of a room without walls, in its height.
const USUAL_WIDTH: f32 = 1.5;
/// Where nothing is above, the panel hangs at this share of the scene's height.
const OPEN_HEIGHT: f32 = 0.95;
/// Distance of luminaires that are added beside each other, in their size.
const GAP: f32 = 1.5;
/// Places looked at on each side of the middle, for one that is free.
const NEIGHBOURS: i32 = 3;
/// Illuminance of the floor that a new luminaire is made for, lx: what EN 12464-1 asks of rooms
/// where nobody reads all day.
const FLOOR_LUX: f32 = 300.0;
/// Share of a luminaire's light that reaches the floor: of a panel under the ceiling of a light
/// room that is about twice as wide as high.
const UTILISATION: f32 = 0.6;
/// Faces that one vertical line may cross.
const MOST_CROSSINGS: usize = 256;

/// Where a ceiling light goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CeilingPlace {
    /// Middle of the panel.
    pub centre: Vec3,
    /// Up direction, along one axis; the panel shines against it.
    pub up: Vec3,
}

/// A side that suits the scene: a quarter of the smaller width of the room that the camera is in,
/// or of the whole scene.
pub fn suggested_size(scene: &Scene, occluders: &Occluders) -> f32 {
    let (lower, upper) = scene.bounds();
    let [width, depth] = floor(scene, occluders);
    0.25 * width.min(depth).max(1e-3 * (upper - lower).max_element())
}

/// A luminous flux that suits the scene, lm: by the lumen method what lights the floor of the room
/// that the camera is in, or of the whole scene, to 300 lx; a round number.
pub fn suggested_lumens(scene: &Scene, occluders: &Occluders) -> f32 {
    let [width, depth] = floor(scene, occluders);
    to_one_digit((FLOOR_LUX * width * depth / UTILISATION).max(1.0))
}

/// Sides of the floor of the room that the camera is in, or of the whole scene.
fn floor(scene: &Scene, occluders: &Occluders) -> [f32; 2] {
    let (lower, upper) = scene.bounds();
    let up = scene.up_axis();
    let whole = horizontal(up).map(|axis| (upper - lower).dot(axis.abs()));
    room(occluders, up, own_eye(scene)).map_or(whole, |room| room.sides)
}

/// Two unit vectors along axes across an axis.
fn horizontal(up: Vec3) -> [Vec3; 2] {
    let right = if up.x == 0.0 { Vec3::X } else { Vec3::Y };
    [right, up.cross(right)]
}

/// A free space between walls, under a ceiling.
struct Room {
    /// A point halfway between opposite walls, or where one stands where a wall is missing.
    middle: Vec3,
    /// Distances of opposite walls; without any, as wide as rooms of its height are.
    sides: [f32; 2],
}

/// Where the scene's own camera stands.
fn own_eye(scene: &Scene) -> Option<Vec3> {
    scene.camera.map(|camera| camera.eye)
}

/// The room that an eye is in, above its furniture; `None` where no ceiling is above it or no floor
/// below.
fn room(occluders: &Occluders, up: Vec3, eye: Option<Vec3>) -> Option<Room> {
    let eye = eye?;
    let reach = |from: Vec3, direction: Vec3| occluders.first_hit(from, direction).map(|hit| hit.distance);
    let (below, above) = (reach(eye, -up)?, reach(eye, up)?);
    let mut middle = eye + ABOVE_FURNITURE * above * up;
    let [right, forward] = horizontal(up);
    let mut widths = [f32::INFINITY; 2];
    // Across and along, and across once more from the middle of its length.
    for (axis, width) in [(right, 0), (forward, 1), (right, 0)] {
        if let (Some(ahead), Some(behind)) = (reach(middle, axis), reach(middle, -axis)) {
            middle += 0.5 * (ahead - behind) * axis;
            widths[width] = ahead + behind;
        }
    }
    let widest = widths.into_iter().filter(|width| width.is_finite()).fold(0.0, f32::max);
    let usual = if widest > 0.0 { widest } else { USUAL_WIDTH * (below + above) };
    Some(Room { middle, sides: widths.map(|width| if width.is_finite() { width } else { usual }) })
}

/// The place for a panel of side `size`: at the middle of the room that the camera is in, or else
/// of the scene, under the ceiling of the space that the camera (or, without one, most of the
/// faces) is in, below any roof.
pub fn place(scene: &Scene, occluders: &Occluders, size: f32) -> CeilingPlace {
    place_beside(scene, occluders, own_eye(scene), size)
}

/// As [`place`], in the room of this eye, and beside the lamps that are there where there is room
/// beside them.
pub fn place_beside(scene: &Scene, occluders: &Occluders, eye: Option<Vec3>, size: f32) -> CeilingPlace {
    let up = scene.up_axis();
    let (lower, upper) = scene.bounds();
    let eye = eye.filter(|eye| eye.cmpge(lower).all() && eye.cmple(upper).all()).or(own_eye(scene));
    let middle = room(occluders, up, eye).map_or(0.5 * (lower + upper), |room| room.middle);
    let level = reference_level(scene, up, eye);
    let at = |middle| CeilingPlace { centre: under_ceiling((scene, occluders), middle, up, level, size), up };
    let [right, forward] = horizontal(up);
    let reach = 0.5 * size * (right.abs() + forward.abs());
    let lamps = lamps(scene);
    let is_free = |centre: Vec3| {
        let around = reach + size * up.abs();
        let touches = |(least, most): &(Vec3, Vec3)| {
            (centre + around).cmpgt(*least).all() && (centre - around).cmplt(*most).all()
        };
        !lamps.iter().any(touches)
    };
    let is_inside = |at: Vec3| (at - reach).cmpge(lower).all() && (at + reach).cmple(upper).all();
    // Room to the nearest side of the scene: of two places as near to the middle, the one with more
    // of it is the better one.
    let room_around =
        |at: Vec3| (at - lower).min(upper - at).dot(right.abs()).min((at - lower).min(upper - at).dot(forward.abs()));
    let mut places: Vec<(i32, Vec3)> = (-NEIGHBOURS..=NEIGHBOURS)
        .flat_map(|across| (-NEIGHBOURS..=NEIGHBOURS).map(move |along| [across, along]))
        .map(|[across, along]| {
            let shift = across as f32 * right + along as f32 * forward;
            (across * across + along * along, middle + GAP * size * shift)
        })
        .collect();
    places.sort_by(|(far, one), (other_far, other)| {
        far.cmp(other_far).then(room_around(*other).total_cmp(&room_around(*one)))
    });
    let shifted = places.into_iter().map(|(_, place)| place);
    let beside = shifted.filter(|middle| is_inside(*middle)).find(|middle| is_free(at(*middle).centre));
    at(beside.unwrap_or(middle))
}

/// Boxes around all that emits: around each luminaire, and each emitting face of the file.
fn lamps(scene: &Scene) -> Vec<(Vec3, Vec3)> {
    let luminaires = scene.placed_luminaires.iter().map(|placed| {
        let reach = Vec3::splat(0.5 * placed.form.size);
        (placed.form.centre - reach, placed.form.centre + reach)
    });
    let faces = scene.polygons.iter().filter(|polygon| scene.emits(polygon)).map(|polygon| {
        let (corners, count) = scene.corner_positions(polygon);
        let fold = |least: fn(Vec3, Vec3) -> Vec3| corners[..count].iter().copied().reduce(least).unwrap_or_default();
        (fold(Vec3::min), fold(Vec3::max))
    });
    luminaires.chain(faces).collect()
}

/// Where a panel of this side hangs above or below a point, under the ceiling.
fn under_ceiling((scene, occluders): (&Scene, &Occluders), middle: Vec3, up: Vec3, level: f32, size: f32) -> Vec3 {
    let (lower, upper) = scene.bounds();
    let height = (upper - lower).dot(up.abs());
    let floor = lower.dot(up).min(upper.dot(up));
    let level = level.clamp(floor, floor + height);
    let [right, forward] = horizontal(up);
    let reach = if size.is_finite() { 0.4 * size } else { 0.0 };
    // Off the diagonals, along which quads are cut and a ray may slip through.
    let lines = [(0.07, 0.03), (0.9, 0.7), (-0.8, 1.0), (-1.0, -0.75), (0.7, -0.95)];
    let mut ceilings: Vec<f32> = lines
        .iter()
        .map(|(x, z)| middle + reach * (x * right + z * forward))
        .map(|point| {
            ceiling_above((scene, occluders), point, up, floor..floor + height, level).unwrap_or(f32::INFINITY)
        })
        .collect();
    ceilings.sort_unstable_by(f32::total_cmp);
    // The median passes over a beam or a pipe and a single gap.
    let ceiling = ceilings[ceilings.len() / 2];
    let panel = if ceiling.is_finite() { ceiling - CLEARANCE * height } else { floor + OPEN_HEIGHT * height };
    middle + (panel - middle.dot(up)) * up
}

/// A height inside the room: the eye's where it lies in the scene's box; else the middle of the
/// box, or the median of the faces' heights where that is lower (a sky or a tall tree outside
/// stretches the box).
fn reference_level(scene: &Scene, up: Vec3, eye: Option<Vec3>) -> f32 {
    let (lower, upper) = scene.bounds();
    if let Some(eye) = eye.filter(|eye| eye.cmpge(lower).all() && eye.cmple(upper).all()) {
        return eye.dot(up);
    }
    let height = |polygon| {
        let (corners, count) = scene.corner_positions(polygon);
        corners[..count].iter().sum::<Vec3>().dot(up) / count as f32
    };
    let mut heights: Vec<f32> = scene.polygons.iter().map(height).collect();
    let middle = heights.len() / 2;
    if heights.is_empty() {
        return 0.0;
    }
    let median = *heights.select_nth_unstable_by(middle, f32::total_cmp).1;
    median.min(0.5 * (lower + upper).dot(up))
}

/// Height of the first face, from `level` upwards, that closes a free space on the vertical line
/// through `point`.
fn ceiling_above(
    (scene, occluders): (&Scene, &Occluders),
    point: Vec3,
    up: Vec3,
    heights: std::ops::Range<f32>,
    level: f32,
) -> Option<f32> {
    let at = |level: f32| point + (level - point.dot(up)) * up;
    let mut space_from = occluders.first_hit(at(level), -up).map_or(heights.start, |hit| level - hit.distance);
    let mut met = occluders.first_hit(at(level), up);
    for _ in 0..MOST_CROSSINGS {
        let hit = met?;
        let face = hit.point.dot(up);
        if face - space_from >= LEAST_SPACE * (heights.end - heights.start) {
            return Some(face);
        }
        space_from = face;
        let polygon = &scene.polygons[hit.polygon as usize];
        met = occluders.ray_from(hit.point, scene.normal(polygon), up);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::stability::scenes::add_box;
    use crate::scene::{CameraPose, GroupId, MaterialId};

    fn add_slab(scene: &mut Scene, material: MaterialId, level: f32, half: f32) {
        let corner = |x: f32, z: f32| Vec3::new(x, level, z);
        let corners = [corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, half)];
        scene.add_quad(corners, material, GroupId(0));
    }

    fn house(levels: &[(f32, f32)]) -> Scene {
        let mut scene = Scene::new("house");
        let material = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        for &(level, half) in levels {
            add_slab(&mut scene, material, level, half);
        }
        scene
    }

    fn panel_level(scene: &Scene) -> f32 {
        place(scene, &Occluders::new(scene), 0.5).centre.y
    }

    /// Truth: floor 0, table top 0.7 to 0.75, ceiling 2.8, roof 3.2 with its underside at 3.1.
    #[test]
    fn the_panel_hangs_inside_the_room_and_below_the_roof() {
        let levels = [(0.0, 3.0), (0.7, 1.0), (0.75, 1.0), (2.8, 3.0), (3.1, 4.0), (3.2, 4.0)];
        let mut scene = house(&levels);
        for eye_level in [None, Some(1.6), Some(0.72)] {
            let pose = |y| CameraPose { eye: Vec3::new(2.0, y, 2.0), target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 50.0 };
            scene.camera = eye_level.map(pose);
            let panel = panel_level(&scene);
            assert!(panel < 2.8 && panel > 2.7, "{eye_level:?}: {panel}");
        }
    }

    /// Truth: without anything above, 95 % of the height of the box; walls alone give the height.
    #[test]
    fn an_open_scene_gets_its_light_near_the_top() {
        let mut scene = house(&[(0.0, 3.0)]);
        let corners = [Vec3::new(3.0, 0.0, -3.0), Vec3::new(3.0, 4.0, -3.0), Vec3::new(3.0, 4.0, 3.0)];
        scene.add_triangle(corners, MaterialId(0), GroupId(0));
        assert!((panel_level(&scene) - 3.8).abs() < 1e-5);
        assert_eq!(place(&Scene::new(""), &Occluders::new(&Scene::new("")), 1.0).centre, Vec3::ZERO);
    }

    /// Truth: of two rooms the one that the camera is in, 2 by 3 m, has the light at its middle,
    /// with a quarter of its width.
    #[test]
    fn the_panel_hangs_in_the_room_of_the_camera() {
        let mut scene = Scene::new("house");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        let of = (MaterialId(0), GroupId(0));
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(6.0, 2.5, 5.0)), true, of);
        add_box(&mut scene, (Vec3::new(7.0, 0.0, 0.0), Vec3::new(9.0, 2.5, 3.0)), true, of);
        let eye = Vec3::new(8.5, 1.6, 0.5);
        scene.camera = Some(CameraPose { eye, target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 50.0 });
        let occluders = Occluders::new(&scene);
        let centre = place(&scene, &occluders, 0.5).centre;
        assert!(centre.distance(Vec3::new(8.0, 2.5, 1.5)) < 0.02, "{centre}");
        assert!((suggested_size(&scene, &occluders) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn the_light_shines_and_keeps_to_the_up_axis() {
        let mut scene = house(&[(0.0, 3.0), (2.8, 3.0)]);
        let size = suggested_size(&scene, &Occluders::new(&scene));
        let CeilingPlace { centre, up } = place(&scene, &Occluders::new(&scene), size);
        scene.add_ceiling_light(centre, up, size, Vec3::splat(20.0)).expect("a good light");
        assert!(scene.has_light());
        let panel = scene.polygons.last().expect("the panel");
        assert!(scene.normal(panel).y < -0.999);
        assert!((scene.area(panel) - 2.25).abs() < 1e-4);
        let power = scene.emitted_power().x;
        assert!((power - 45.0).abs() < 1e-3, "{power}");
    }

    /// Truth: a room of 4 × 3 × 4 m has room for nine panels of 1 m under its ceiling: none of them
    /// touches another, all hang there.
    #[test]
    fn further_lights_hang_beside_those_that_are_there() {
        let mut scene = Scene::new("room");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 3.0, 4.0)), true, (MaterialId(0), GroupId(0)));
        for count in 0..4 {
            let place = place_beside(&scene, &Occluders::new(&scene), Some(Vec3::new(1.0, 1.6, 1.0)), 1.0);
            for other in scene.luminaires() {
                let away = (other.form.centre - place.centre).abs();
                assert!(away.x.max(away.z) >= 1.0 && away.y < 1e-4, "{count}: {}", place.centre);
            }
            assert!((place.centre.y - 2.985).abs() < 1e-4);
            scene.add_ceiling_light(place.centre, place.up, 1.0, Vec3::ONE).expect("a good light");
        }
    }

    /// Truth: a room of 4 × 2.7 × 5 m with a lamp of 0.6 m at its middle has room for a panel of 1
    /// m along its length, off the walls; its floor of 20 m² wants 300 lx · 20 m² / 0.6 = 10,000
    /// lm.
    #[test]
    fn a_first_light_hangs_beside_the_lamp_of_the_file_and_suits_the_room() {
        let mut scene = Scene::new("room");
        let of = (scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO), GroupId(0));
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 2.7, 5.0)), true, of);
        let lamp = scene.add_material("lamp", Vec3::splat(0.5), Vec3::ONE);
        let corner = |x: f32, z: f32| Vec3::new(2.0 + 0.3 * x, 2.69, 2.5 + 0.3 * z);
        scene.add_quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], lamp, GroupId(0));
        scene.camera =
            Some(CameraPose { eye: Vec3::new(1.0, 1.6, 1.0), target: Vec3::ONE, up: Vec3::Y, hfov_deg: 50.0 });
        let occluders = Occluders::new(&scene);
        let away = (place(&scene, &occluders, 1.0).centre - Vec3::new(2.0, 2.69, 2.5)).abs();
        assert!(away.x < 0.1 && away.z >= 0.8 && away.z <= 1.6, "{away}");
        assert_eq!(suggested_lumens(&scene, &occluders), 10_000.0);
    }
}
