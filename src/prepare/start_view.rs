//! Where a person first stands in a scene that names no view: inside its largest room, eyes at 1.6 m, looking along its longest
//! free diagonal.
//!
//! Inside is where nearly every ray meets a bright side; the largest room has the largest free floor.

use std::f32::consts::TAU;

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::Occluders;
use crate::scene::{CameraPose, Scene};

/// Places that are tried.
const PLACES: usize = 768;
/// Places looked at closely at a time, the best first.
const CLOSER: usize = 64;
/// Directions around a place, at a glance and closely.
const GLANCE: usize = 12;
const AROUND: usize = 48;
/// Eyes above the floor, m, and at most this share of a room's height.
const EYE: f32 = 1.6;
const HIGHEST_EYE: f32 = 2.0 / 3.0;
/// Room above the floor that people have, m, or this share of the scene's height where that is less: a table is no ceiling.
const STANDING: f32 = 1.9;
const STANDING_SHARE: f32 = 0.6;
/// A lower one is a room of a small scene, such as a box for tests, where its floor is this share of the scene's ground at least, and
/// not the inside of a sofa.
const LOW_ROOM_SHARE: f32 = 0.25;
/// Nobody stands where less than this share of it is.
const LEAST_HEADROOM: f32 = 0.75;
/// Faces lower than this share of the eye's height below one's feet are another floor.
const STEP: f32 = 0.2;
/// Nobody stands closer to a wall, m, or this share of the room's height where that is less.
const CLEAR: f32 = 0.3;
const CLEAR_SHARE: f32 = 0.12;
/// Farther walls make a room no larger, m.
const FARTHEST: f32 = 40.0;
/// Least share of rays that meet bright sides.
const INSIDE: f32 = 0.6;
/// Weight of a place without a ceiling beside one with.
const UNDER_THE_SKY: f32 = 0.3;
/// Horizontal field of view, degrees.
const HFOV: f32 = 75.0;

/// A view from inside; `None` for a scene that has no inside, such as a single chair.
pub fn find(scene: &Scene, occluders: &Occluders) -> Option<CameraPose> {
    let (up, (lower, upper)) = (scene.up_axis(), scene.bounds());
    let tall = (upper - lower).dot(up.abs());
    let flat = (upper - lower) * (Vec3::ONE - up.abs()) + up.abs();
    let ground = flat.element_product();
    let rooms = Rooms { scene, occluders, up, lowest: lower.dot(up).min(upper.dot(up)), tall, ground };
    let places = rooms.places();
    let mut glances: Vec<(f32, Vec3)> =
        places.par_iter().filter_map(|place| Some((rooms.stand(*place, GLANCE)?.score, *place))).collect();
    // Of equals the first.
    glances.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = glances.chunks(CLOSER).find_map(|chunk| {
        let stands: Vec<Stand> = chunk.par_iter().filter_map(|(_, place)| rooms.stand(*place, AROUND)).collect();
        stands.into_iter().reduce(|best, other| if other.score > best.score { other } else { best })
    })?;
    Some(rooms.view(&best))
}

/// A place where a person may stand.
#[derive(Clone, Copy)]
struct Stand {
    eye: Vec3,
    /// Height of the room there, m.
    height: f32,
    score: f32,
}

struct Rooms<'a> {
    scene: &'a Scene,
    occluders: &'a Occluders,
    up: Vec3,
    /// The scene's lowest level, m.
    lowest: f32,
    /// Height of the scene, m.
    tall: f32,
    /// Area of its box seen from above, m².
    ground: f32,
}

impl Rooms<'_> {
    /// Places in the scene's box, and in front of its faces: a large ground would leave few of the first in a house.
    fn places(&self) -> Vec<Vec3> {
        let (lower, upper) = self.scene.bounds();
        let shares = |index: usize| {
            // The sequence R3 of Roberts.
            let at = index as f64 + 0.5;
            [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_960_1]
                .map(|step| (at * step).fract() as f32)
        };
        let in_box = (0..PLACES / 2).map(|index| lower + (upper - lower) * Vec3::from_array(shares(index)));
        let count = self.scene.polygons.len();
        let at_face = (0..PLACES / 2).filter_map(|index| {
            let [u, v, _] = shares(index);
            let polygon = &self.scene.polygons[((u * count as f32) as usize).min(count.checked_sub(1)?)];
            let ([a, b, c, _], _) = self.scene.corner_positions(polygon);
            let (middle, normal) = ((a + b + c) / 3.0, self.scene.normal(polygon));
            // Slivers have no normal.
            let hit = if normal == Vec3::ZERO { None } else { self.occluders.ray_from(middle, normal, normal) };
            Some(middle + (0.1 + 0.8 * v) * hit?.distance * normal)
        });
        in_box.chain(at_face).collect()
    }

    /// How far it is to the next face, and whether that is bright.
    fn look(&self, from: Vec3, direction: Vec3) -> Option<(f32, bool)> {
        let hit = self.occluders.first_hit(from, direction)?;
        Some((hit.distance, hit.front))
    }

    fn around(&self, step: usize, steps: usize) -> Vec3 {
        let (right, forward) = self.up.any_orthonormal_pair();
        let angle = TAU * step as f32 / steps as f32;
        angle.cos() * right + angle.sin() * forward
    }

    /// The place above the floor below a point, if a person can stand there; looks into `steps` directions around it.
    fn stand(&self, place: Vec3, steps: usize) -> Option<Stand> {
        // Some rooms have no floor: one stands where they end.
        let open = || (place.dot(self.up) - self.lowest, false);
        let (below, is_floor) = self.look(place, -self.up).unwrap_or_else(open);
        let above = self.look(place, self.up);
        let height = above.map_or(self.tall, |(to_ceiling, _)| below + to_ceiling);
        let headroom = (height / STANDING.min(STANDING_SHARE * self.tall)).min(1.0);
        if headroom < LEAST_HEADROOM {
            return None;
        }
        let has_ceiling = above.is_some_and(|(_, bright)| bright);
        let level = EYE.min(HIGHEST_EYE * height);
        let eye = place + (level - below) * self.up;
        // A ray to another floor is one into the open: people do not stand on tables.
        let lowest = (1.0 + STEP) * level;
        let clear = CLEAR.min(CLEAR_SHARE * height);
        let (mut floor, mut bright, mut rays) = (0.0, 0.0, 0.0);
        for step in 0..steps {
            let flat = self.around(step, steps);
            let ahead = self.look(eye, flat);
            let distance = ahead.map_or(0.0, |(distance, _)| distance.min(FARTHEST));
            if ahead.is_some() && distance < clear {
                return None;
            }
            floor += 0.5 * distance * distance * TAU / steps as f32;
            for slope in [-0.6, 0.0, 0.6] {
                let direction = (flat + slope * self.up).normalize();
                let met = if slope == 0.0 { ahead } else { self.look(eye, direction) };
                let is_here = |distance: f32| -distance * direction.dot(self.up) <= lowest;
                bright += f32::from(met.is_some_and(|(distance, bright)| bright && is_here(distance)));
                rays += 1.0;
            }
        }
        if height < LEAST_HEADROOM * STANDING && floor < LOW_ROOM_SHARE * self.ground {
            return None;
        }
        let inside = bright / rays;
        let shelter = if has_ceiling && is_floor { 1.0 } else { UNDER_THE_SKY };
        let score = floor * inside.powi(4) * shelter * headroom.powi(2);
        (inside >= INSIDE).then_some(Stand { eye, height, score })
    }

    /// The view from a room's end along its longest free diagonal.
    fn view(&self, stand: &Stand) -> CameraPose {
        let clear = CLEAR.min(CLEAR_SHARE * stand.height);
        // The open is no room to look into or to step back into.
        let reach =
            |direction: Vec3| self.look(stand.eye, direction).map_or(0.0, |(distance, _)| distance.min(FARTHEST));
        let free: Vec<f32> = (0..AROUND).map(|step| reach(self.around(step, AROUND))).collect();
        let length = |step: usize| free[step] + free[(step + AROUND / 2) % AROUND];
        let by_length = |a: &usize, b: &usize| {
            let of_equals = || free[*a].total_cmp(&free[*b]).then(b.cmp(a));
            length(*a).total_cmp(&length(*b)).then_with(of_equals)
        };
        let longest = (0..AROUND).max_by(by_length).unwrap_or_default();
        let ahead = self.around(longest, AROUND);
        let back = free[(longest + AROUND / 2) % AROUND];
        let is_clear = |eye: Vec3| {
            let directions = (0..12).map(|step| self.around(step, 12));
            let slopes = directions.flat_map(|flat| [-0.5, 0.0, 0.5].map(|slope| (flat + slope * self.up).normalize()));
            slopes
                .chain([self.up, -self.up])
                .all(|direction| self.look(eye, direction).is_none_or(|(distance, bright)| bright && distance >= clear))
        };
        // As far back as there is room to stand.
        let mut steps =
            (0..=16).map(|step| stand.eye - (back - 2.0 * clear).max(0.0) * (1.0 - step as f32 / 16.0) * ahead);
        let eye = steps.find(|eye| is_clear(*eye)).unwrap_or(stand.eye);
        let down = 0.12 * (EYE.min(HIGHEST_EYE * stand.height));
        let target = eye + (0.5 * length(longest)).max(clear) * ahead - down * self.up;
        CameraPose { eye, target, up: self.up, hfov_deg: HFOV }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::orient;
    use crate::measure::stability::scenes::add_box;
    use crate::scene::{GroupId, MaterialId, Sides};

    /// Truth: of two rooms beside each other, on a ground of 200 m, the larger one; eyes at 1.6 m, and nearly its diagonal of 10 m ahead.
    #[test]
    fn one_stands_in_the_largest_room() {
        let mut scene = Scene::new("house");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(3.0, 2.5, 3.0)), true, (MaterialId(0), GroupId(0)));
        add_box(&mut scene, (Vec3::new(4.0, 0.2, 0.0), Vec3::new(12.0, 2.9, 6.0)), true, (MaterialId(0), GroupId(0)));
        let ground = [[-100.0, -100.0], [-100.0, 100.0], [100.0, 100.0], [100.0, -100.0]];
        scene.add_quad(ground.map(|[x, z]| Vec3::new(x, -0.3, z)), MaterialId(0), GroupId(0));
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        let view = find(&scene, &occluders).expect("a room");
        assert!((view.eye.y - 1.8).abs() < 1e-3, "{view:?}");
        assert!(view.eye.x > 4.2 && view.eye.x < 11.8 && view.eye.z > 0.2 && view.eye.z < 5.8, "{view:?}");
        let ahead = (view.target - view.eye).with_y(0.0).normalize();
        let free = occluders.first_hit(view.eye, ahead).expect("a wall").distance;
        assert!(free > 7.0, "{free} m ahead of {view:?}");
        assert_eq!(view.up, Vec3::Y);
    }

    /// Truth: in a room without a wall one stands inside and looks at the others, not from afar.
    #[test]
    fn a_room_may_be_open_to_a_side() {
        let mut scene = Scene::new("stage");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(5.0, 3.0, 4.0)), true, (MaterialId(0), GroupId(0)));
        let is_open = |corners: &[u32]| corners.iter().all(|&corner| scene.vertices[corner as usize].z == 0.0);
        scene.polygons = scene.polygons.iter().filter(|polygon| !is_open(polygon.corners())).copied().collect();
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        let view = find(&scene, &occluders).expect("a room");
        assert!(view.eye.x > 0.2 && view.eye.x < 4.8 && view.eye.z > 0.0 && view.eye.z < 3.8, "{view:?}");
        let ahead = (view.target - view.eye).with_y(0.0).normalize();
        assert!(occluders.first_hit(view.eye, ahead).is_some_and(|hit| hit.front), "{view:?}");
    }

    /// Truth: under a table, however much of the room one sees from there, nobody stands, also where the room has no ceiling.
    #[test]
    fn one_stands_beside_a_table_and_not_under_it() {
        let mut scene = Scene::new("stage");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        let of = (MaterialId(0), GroupId(0));
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(5.0, 3.0, 4.0)), true, of);
        let is_open = |corners: &[u32]| corners.iter().all(|&corner| scene.vertices[corner as usize].y == 3.0);
        scene.polygons = scene.polygons.iter().filter(|polygon| !is_open(polygon.corners())).copied().collect();
        add_box(&mut scene, (Vec3::new(1.0, 0.7, 0.8), Vec3::new(4.0, 0.75, 3.2)), false, of);
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        let view = find(&scene, &occluders).expect("a room");
        assert!((view.eye.y - 1.6).abs() < 1e-3, "{view:?}");
    }

    /// Truth: a room without a floor is stood in as if it had one where its walls end.
    #[test]
    fn a_room_may_have_no_floor() {
        let mut scene = Scene::new("walls");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 2.6, 4.0)), true, (MaterialId(0), GroupId(0)));
        let is_floor = |corners: &[u32]| corners.iter().all(|&corner| scene.vertices[corner as usize].y == 0.0);
        scene.polygons = scene.polygons.iter().filter(|polygon| !is_floor(polygon.corners())).copied().collect();
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        let view = find(&scene, &occluders).expect("a room");
        assert!((view.eye.y - 1.6).abs() < 1e-3 && view.eye.cmpgt(Vec3::ZERO).all(), "{view:?}");
    }

    /// Truth: nobody stands in a sofa, which is closed and bright inside where its faces have two sides; a box of that size alone is a room.
    #[test]
    fn a_sofa_is_no_room() {
        let of = (MaterialId(0), GroupId(0));
        let scene = |with_table: bool| {
            let mut scene = Scene::new("suite");
            scene.add_material("cloth", Vec3::splat(0.5), Vec3::ZERO);
            add_box(&mut scene, (Vec3::ZERO, Vec3::new(2.0, 0.8, 0.9)), true, of);
            if with_table {
                add_box(&mut scene, (Vec3::new(0.0, 0.0, 2.5), Vec3::new(3.0, 0.5, 3.5)), false, of);
            }
            orient::apply(scene, Sides::Front)
        };
        let (suite, occluders) = scene(true);
        assert_eq!(find(&suite, &occluders), None);
        let (alone, occluders) = scene(false);
        assert!(find(&alone, &occluders).is_some());
    }

    /// Truth: a table is seen from outside alone.
    #[test]
    fn a_single_thing_has_no_inside() {
        let mut scene = Scene::new("table");
        scene.add_material("wood", Vec3::splat(0.5), Vec3::ZERO);
        let top = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        scene.add_quad(top.map(|[x, z]| Vec3::new(x, 0.7, z)), MaterialId(0), GroupId(0));
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        assert_eq!(find(&scene, &occluders), None);
        assert_eq!(find(&Scene::new(""), &Occluders::new(&Scene::new(""))), None);
    }
}
