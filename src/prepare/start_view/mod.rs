//! Where a person first stands in a scene that names no view: inside its largest room, eyes at 1.6 m, looking along a long free
//! diagonal, that which shows most.
//!
//! Inside is where nearly every ray meets a bright side; the largest room has the largest free floor. The space below a sky that goes
//! round a house is inside too, by that measure: where a far higher space goes all the way round rooms (`outdoors`), one stands in these.

use std::f32::consts::TAU;

use glam::Vec3;
use rayon::prelude::*;

use super::outdoors::{self, AROUND, heading};
use crate::geometry::Occluders;
use crate::scene::{CameraPose, Scene};

/// Places that are tried.
const PLACES: usize = 768;
/// Places looked at closely at a time, the best first.
const CLOSER: usize = 64;
/// Directions around a place at a glance; closely there are [`AROUND`].
const GLANCE: usize = 12;
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
/// A space that is so many times as high as rooms that it goes round is none itself.
const OUTDOORS: f32 = 3.0;
/// Least floor of such a room, m²: neither a wardrobe nor a lift.
const LEAST_FLOOR: f32 = 4.0;
/// Places looked at for such rooms, the best first.
const MOST_ROOMS: usize = 256;
/// Directions in which a room is free for at least this share of its longest are looked into as well.
const NEARLY_LONGEST: f32 = 0.75;
/// Rays by which views are compared, across and up.
const VIEWED: [usize; 2] = [15, 9];
/// Height of a view, as a share of its width.
const VIEW_HEIGHT: f32 = 0.7;
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
    let mut glances: Vec<(Stand, Vec3)> =
        places.par_iter().filter_map(|place| Some((rooms.stand(*place, GLANCE)?, *place))).collect();
    // Of equals the first.
    glances.sort_by(|a, b| b.0.score.total_cmp(&a.0.score));
    // Above the scene is the open.
    let open = 0.5 * (lower + upper) + lower.distance(upper) * up;
    let best = glances.chunks(CLOSER).find_map(|chunk| {
        let closely = |(_, place): &(Stand, Vec3)| {
            let stand = rooms.stand(*place, AROUND)?;
            Some(rooms.walled(stand, open).unwrap_or(stand))
        };
        let stands: Vec<Stand> = chunk.par_iter().filter_map(closely).collect();
        stands.into_iter().reduce(better)
    })?;
    let is_far_higher = |stand: &&Stand| stand.height >= OUTDOORS * best.height;
    let outside = glances.iter().map(|(stand, _)| stand).find(is_far_higher).unwrap_or(&best);
    Some(rooms.view(&rooms.within(outside, &glances).unwrap_or(best)))
}

fn better(best: Stand, other: Stand) -> Stand {
    if other.score > best.score { other } else { best }
}

/// A place where a person may stand.
#[derive(Clone, Copy)]
struct Stand {
    eye: Vec3,
    /// Height of the room there, m.
    height: f32,
    /// Floor that is seen from there, m².
    floor: f32,
    score: f32,
    /// In which directions walls part the place from the outdoors; all of them where nothing goes round it.
    walls: [bool; AROUND],
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
        let count = self.scene.polygons.len();
        let at_face = (0..PLACES / 2).filter_map(|index| {
            let [u, v, _] = shares(index).to_array();
            let polygon = &self.scene.polygons[((u * count as f32) as usize).min(count.checked_sub(1)?)];
            let ([a, b, c, _], _) = self.scene.corner_positions(polygon);
            let (middle, normal) = ((a + b + c) / 3.0, self.scene.normal(polygon));
            // Slivers have no normal.
            let hit = if normal == Vec3::ZERO { None } else { self.occluders.ray_from(middle, normal, normal) };
            Some(middle + (0.1 + 0.8 * v) * hit?.distance * normal)
        });
        places_in(lower, upper).chain(at_face).collect()
    }

    /// How far it is to the next face, and whether that is bright.
    fn look(&self, from: Vec3, direction: Vec3) -> Option<(f32, bool)> {
        let hit = self.occluders.first_hit(from, direction)?;
        Some((hit.distance, hit.front))
    }

    /// How far people walk that way, m: not into the open.
    fn reach(&self, from: Vec3, direction: Vec3) -> f32 {
        self.look(from, direction).map_or(0.0, |(distance, _)| distance.min(FARTHEST))
    }

    /// The best of the rooms that a far higher space goes round.
    fn within(&self, outside: &Stand, glances: &[(Stand, Vec3)]) -> Option<Stand> {
        let is_low =
            |(stand, _): &&(Stand, Vec3)| OUTDOORS * stand.height <= outside.height && stand.floor >= LEAST_FLOOR;
        let low: Vec<Vec3> = glances.iter().filter(is_low).take(MOST_ROOMS).map(|(_, place)| *place).collect();
        let room = |place: &Vec3| {
            let room = self.walled(self.stand(*place, AROUND)?, outside.eye)?;
            (room.floor >= LEAST_FLOOR).then_some(room)
        };
        let best_of = |places: Vec<Vec3>| {
            let rooms: Vec<Stand> = places.par_iter().filter_map(room).collect();
            rooms.into_iter().reduce(better)
        };
        let first = best_of(low)?;
        // Few of the places tried lie in the room: more of them, within its walls.
        let walls = (0..AROUND).filter(|step| first.walls[*step]);
        let ends = walls.map(|step| first.eye + self.reach(first.eye, self.around(step)) * self.around(step));
        let (lower, upper) = ends.fold((first.eye, first.eye), |(lower, upper), end| (lower.min(end), upper.max(end)));
        Some(best_of(places_in(lower, upper).collect()).map_or(first, |other| better(first, other)))
    }

    /// A place with the walls that part it from the space of another; `None` where that does not go round it.
    fn walled(&self, stand: Stand, outside: Vec3) -> Option<Stand> {
        let walls = outdoors::walls(self.scene, self.occluders, outside, stand.eye)?;
        // What is seen through a window is no floor of the room, and who stands in the window sees few walls.
        let reaches = (0..AROUND).filter(|step| walls[*step]).map(|step| self.reach(stand.eye, self.around(step)));
        let (count, floor) =
            reaches.fold((0.0, 0.0), |(count, floor), reach| (count + 1.0, floor + sector(reach, AROUND)));
        let share = count / AROUND as f32 * floor / stand.floor.max(f32::MIN_POSITIVE);
        Some(Stand { floor, score: share * stand.score, walls, ..stand })
    }

    fn around(&self, step: usize) -> Vec3 {
        heading(self.up, step, AROUND)
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
            let flat = heading(self.up, step, steps);
            let ahead = self.look(eye, flat);
            let distance = ahead.map_or(0.0, |(distance, _)| distance.min(FARTHEST));
            if ahead.is_some() && distance < clear {
                return None;
            }
            floor += sector(distance, steps);
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
        (inside >= INSIDE).then_some(Stand { eye, height, floor, score, walls: [true; AROUND] })
    }

    /// The view from a room's end that shows most of it, nearly along its longest free diagonal.
    fn view(&self, stand: &Stand) -> CameraPose {
        // The open is no room to look into or to step back into.
        let free: Vec<f32> = (0..AROUND)
            .map(|step| if stand.walls[step] { self.reach(stand.eye, self.around(step)) } else { 0.0 })
            .collect();
        let length = |step: usize| free[step] + free[(step + AROUND / 2) % AROUND];
        let by_length = |a: &usize, b: &usize| {
            let of_equals = || free[*a].total_cmp(&free[*b]).then(b.cmp(a));
            length(*a).total_cmp(&length(*b)).then_with(of_equals)
        };
        let longest = (0..AROUND).max_by(by_length).unwrap_or_default();
        let long_enough = (0..AROUND).filter(|step| length(*step) >= NEARLY_LONGEST * length(longest));
        // The longest first: of equals the first is taken.
        let others = long_enough.filter(|step| *step != longest);
        let steps: Vec<usize> = std::iter::once(longest).chain(others).collect();
        let views = steps.par_iter().map(|step| {
            let ahead = self.around(*step);
            let eye = self.stepped_back(stand, ahead, free[(step + AROUND / 2) % AROUND]);
            (*step, eye, length(*step) * self.shown(eye, ahead))
        });
        let views: Vec<(usize, Vec3, f32)> = views.collect();
        let better = |best: (usize, Vec3, f32), other: (usize, Vec3, f32)| if other.2 > best.2 { other } else { best };
        let (step, eye, _) = views.into_iter().reduce(better).unwrap_or((longest, stand.eye, 0.0));
        let ahead = self.around(step);
        let down = 0.12 * (EYE.min(HIGHEST_EYE * stand.height));
        let clear = CLEAR.min(CLEAR_SHARE * stand.height);
        let target = eye + (0.5 * length(step)).max(clear) * ahead - down * self.up;
        CameraPose { eye, target, up: self.up, hfov_deg: HFOV }
    }

    /// As far back from a place as there is room to stand, where it is this far to what is behind.
    fn stepped_back(&self, stand: &Stand, ahead: Vec3, back: f32) -> Vec3 {
        let clear = CLEAR.min(CLEAR_SHARE * stand.height);
        let is_clear = |eye: Vec3| {
            let directions = (0..12).map(|step| heading(self.up, step, 12));
            let slopes = directions.flat_map(|flat| [-0.5, 0.0, 0.5].map(|slope| (flat + slope * self.up).normalize()));
            slopes
                .chain([self.up, -self.up])
                .all(|direction| self.look(eye, direction).is_none_or(|(distance, bright)| bright && distance >= clear))
        };
        let mut steps =
            (0..=16).map(|step| stand.eye - (back - 2.0 * clear).max(0.0) * (1.0 - step as f32 / 16.0) * ahead);
        steps.find(|eye| is_clear(*eye)).unwrap_or(stand.eye)
    }

    /// How much a view shows: the mean distance of what is seen, m, times the root of how many things that are. A blank wall near by, over
    /// half of the picture, shows little.
    fn shown(&self, eye: Vec3, ahead: Vec3) -> f32 {
        let [columns, rows] = VIEWED;
        let right = ahead.cross(self.up);
        let half_width = (0.5 * HFOV.to_radians()).tan();
        let (mut distances, mut things) = (0.0, Vec::new());
        for index in 0..columns * rows {
            let place = |at: usize, of: usize| 2.0 * (at as f32 + 0.5) / of as f32 - 1.0;
            let (across, level) = (place(index % columns, columns), place(index / columns, rows));
            let direction = ahead + half_width * (across * right + VIEW_HEIGHT * level * self.up);
            let Some(hit) = self.occluders.first_hit(eye, direction.normalize()) else { continue };
            if hit.front {
                distances += hit.distance.min(FARTHEST);
                let thing = self.scene.polygons.get(hit.polygon as usize);
                things.extend(thing.map(|polygon| (polygon.group.0, polygon.material.0)));
            }
        }
        things.sort_unstable();
        things.dedup();
        distances / (columns * rows) as f32 * (things.len() as f32).sqrt()
    }
}

/// Numbers of the sequence R3 of Roberts.
fn shares(index: usize) -> Vec3 {
    let at = index as f64 + 0.5;
    let steps = [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_960_1];
    Vec3::from_array(steps.map(|step| (at * step).fract() as f32))
}

/// Places spread evenly in a box.
fn places_in(lower: Vec3, upper: Vec3) -> impl Iterator<Item = Vec3> {
    (0..PLACES / 2).map(move |index| lower + (upper - lower) * shares(index))
}

/// Area of one of so many sectors of a circle, m².
fn sector(radius: f32, sectors: usize) -> f32 {
    0.5 * radius * radius * TAU / sectors as f32
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

    /// Truth: the picture. A long room whose longest diagonals look past a screen and at bare walls, with a dozen things in one of its
    /// corners: most of the things are ahead, and no wall within a metre fills the picture.
    #[test]
    fn the_first_view_shows_things_and_no_blank_wall() {
        let mut scene = Scene::new("studio");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(7.0, 2.7, 6.0)), true, (MaterialId(0), GroupId(0)));
        for index in 0..12 {
            let thing = scene.add_material(&format!("thing {index}"), Vec3::splat(0.3), Vec3::ZERO);
            let at = Vec3::new(0.3 + 0.7 * (index % 4) as f32, 0.0, 5.0 - 0.6 * (index / 4) as f32);
            add_box(&mut scene, (at, at + Vec3::new(0.4, 0.9, 0.4)), false, (thing, GroupId(0)));
        }
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        let view = find(&scene, &occluders).expect("a room");
        let ahead = (view.target - view.eye).normalize();
        let middle = Vec3::new(1.4, 0.5, 4.6);
        let aside = ahead.angle_between(middle - view.eye).to_degrees();
        assert!(aside < 0.5 * HFOV, "the things are {aside}° aside of {view:?}");
        let rays = (-7..=7).map(|across| ahead + across as f32 / 7.0 * 0.7 * ahead.cross(Vec3::Y));
        let near =
            rays.filter(|ray| occluders.first_hit(view.eye, ray.normalize()).is_some_and(|hit| hit.distance < 1.0));
        assert!(near.count() < 3, "{view:?}");
    }

    /// A house of two rooms, 3 × 3 m and 8 × 6 m, with walls of 20 cm; a wall of the larger one has a window of 2 m².
    fn house() -> Scene {
        let mut scene = Scene::new("house");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        let of = (MaterialId(0), GroupId(0));
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(3.0, 2.6, 3.0)), true, of);
        add_box(&mut scene, (Vec3::new(3.2, 0.0, 0.0), Vec3::new(11.2, 2.6, 6.0)), true, of);
        add_box(&mut scene, (Vec3::new(-0.2, -0.2, -0.2), Vec3::new(11.4, 2.8, 6.2)), false, of);
        let along = |x: f32, scene: &mut Scene| {
            scene
                .polygons
                .retain(|polygon| !polygon.corners().iter().all(|&corner| scene.vertices[corner as usize].x == x));
        };
        for (x, turned) in [(11.2, false), (11.4, true)] {
            along(x, &mut scene);
            for [[low_y, low_z], [high_y, high_z]] in [
                [[-0.2, -0.2], [1.0, 6.2]],
                [[2.0, -0.2], [2.8, 6.2]],
                [[1.0, -0.2], [2.0, 2.0]],
                [[1.0, 4.0], [2.0, 6.2]],
            ] {
                let mut corners = [[low_y, low_z], [low_y, high_z], [high_y, high_z], [high_y, low_z]];
                if turned {
                    corners.reverse();
                }
                scene.add_quad(corners.map(|[y, z]| Vec3::new(x, y, z)), of.0, of.1);
            }
        }
        scene
    }

    fn is_in_larger_room(view: &CameraPose) -> bool {
        let inside = |at: Vec3| at.x > 3.3 && at.x < 11.1 && at.z > 0.1 && at.z < 5.9;
        (view.eye.y - 1.6).abs() < 1e-3 && inside(view.eye) && inside(view.target)
    }

    /// Truth: below a sky, on a lawn before a hedge, and between three backdrops one stands in the house's larger room.
    #[test]
    fn one_stands_in_the_house_and_not_in_its_surroundings() {
        let of = (MaterialId(0), GroupId(0));
        let sky = |lower: Vec3, upper: Vec3| {
            let mut scene = house();
            add_box(&mut scene, (lower, upper), true, of);
            scene
        };
        let mut backdrops = sky(Vec3::new(-50.0, -0.2, -50.0), Vec3::new(60.0, 40.0, 60.0));
        let is_open = |scene: &Scene, corners: &[u32]| {
            let all = |is: &dyn Fn(Vec3) -> bool| corners.iter().all(|&corner| is(scene.vertices[corner as usize]));
            all(&|at| at.y == 40.0) || all(&|at| at.z == 60.0)
        };
        backdrops.polygons =
            backdrops.polygons.iter().filter(|it| !is_open(&backdrops, it.corners())).copied().collect();
        for (what, scene) in [
            ("a small sky", sky(Vec3::new(-10.0, -0.2, -10.0), Vec3::new(20.0, 12.0, 20.0))),
            ("a large sky", sky(Vec3::new(-100.0, -0.2, -100.0), Vec3::new(100.0, 100.0, 100.0))),
            ("a sky all round", sky(Vec3::splat(-200.0), Vec3::splat(200.0))),
            ("backdrops", backdrops),
        ] {
            for sides in [Sides::Front, Sides::Both] {
                let (scene, occluders) = orient::apply(scene.clone(), sides);
                let view = find(&scene, &occluders).expect("a room");
                assert!(is_in_larger_room(&view), "{what}, {sides:?}: {view:?}");
            }
        }
    }

    /// Truth: a hall stays one's place, with low rooms along its walls and a booth of 2 m² in its middle.
    #[test]
    fn one_stands_in_a_hall_and_not_in_its_side_rooms() {
        let mut scene = Scene::new("hall");
        scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        let of = (MaterialId(0), GroupId(0));
        add_box(&mut scene, (Vec3::ZERO, Vec3::new(30.0, 12.0, 20.0)), true, of);
        for (x, size) in [(30.2, 5.0), (-5.2, 5.0)] {
            add_box(&mut scene, (Vec3::new(x, 0.0, 2.0), Vec3::new(x + size, 3.0, 18.0)), true, of);
        }
        for (outwards, thick) in [(true, 0.0), (false, 0.1)] {
            let (lower, upper) = (Vec3::new(14.0, 0.0, 9.0) - thick, Vec3::new(15.4, 2.2, 10.4) + thick);
            add_box(&mut scene, (lower.with_y(0.0), upper), outwards, of);
        }
        let (scene, occluders) = orient::apply(scene, Sides::Front);
        let view = find(&scene, &occluders).expect("a hall");
        let above = occluders.first_hit(view.eye, Vec3::Y).expect("a ceiling").distance;
        assert!((above + 1.6 - 12.0).abs() < 1e-3, "{view:?}");
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
