//! Where a person first stands in a scene that names no view: inside its largest room, eyes at 1.6
//! m, looking along a long free diagonal. Of good places and diagonals those count that show most.
//!
//! Inside is where nearly every ray meets a bright side; the largest room has the largest free
//! floor. The space below a sky that goes round a house is inside too, by that measure: where a far
//! higher space goes all the way round rooms (`outdoors`), one stands in these.

mod view;

use std::collections::HashSet;
use std::f32::consts::TAU;

use glam::Vec3;
use rayon::prelude::*;

use self::view::View;
use super::outdoors::{self, AROUND, heading};
use crate::geometry::Occluders;
use crate::scene::{CameraPose, Polygon, Scene};

/// Places that are tried.
const PLACES: usize = 768;
/// Places looked at closely at a time, the best first.
const CLOSER: usize = 64;
/// Directions around a place at a glance; closely there are [`AROUND`].
const GLANCE: usize = 12;
/// Eyes above the floor, m, and at most this share of a room's height.
const EYE: f32 = 1.6;
const HIGHEST_EYE: f32 = 2.0 / 3.0;
/// Room above the floor that people have, m, or this share of the scene's height where that is
/// less: a table is no ceiling.
const STANDING: f32 = 1.9;
const STANDING_SHARE: f32 = 0.6;
/// A lower one than people stand in is a room of a small scene, such as a box for tests, where its
/// floor is this share of the scene's ground at least, and not the inside of a sofa.
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
/// Who sees no more things than this, of so many that the scene has, is where nothing is to be
/// seen.
const BARE: usize = 2;
const MANY: usize = 10;
/// Weight of such a place.
const NOTHING_SEEN: f32 = 0.02;
/// A space of less floor than this share of its squared height is a shaft, or the hollow of a wall,
/// where it is no large part of the scene ([`LOW_ROOM_SHARE`]).
const SHAFT: f32 = 0.25;

/// A space of less width, m, or this share of its height where that is less, is a cupboard where it
/// is no large part of the scene.
const NARROW: f32 = 1.2;
const NARROW_SHARE: f32 = 0.36;
const LARGE_PART: f32 = 0.5;

/// Views are compared from so many places at most, and from those with this share of the best one's
/// score.
const MOST_VIEWED: usize = 32;
const GOOD: f32 = 0.2;

/// A view from inside; `None` for a scene that has no inside, such as a single chair.
pub fn find(scene: &Scene, occluders: &Occluders) -> Option<CameraPose> {
    let (up, (lower, upper)) = (scene.up_axis(), scene.bounds());
    let tall = (upper - lower).dot(up.abs());
    let flat = (upper - lower) * (Vec3::ONE - up.abs()) + up.abs();
    let ground = flat.element_product();
    let things = scene.polygons.iter().map(thing).collect::<HashSet<_>>().len();
    let rooms = Rooms { scene, occluders, up, lowest: lower.dot(up).min(upper.dot(up)), tall, ground, things };
    let places = rooms.places();
    let mut glances: Vec<(Stand, Vec3)> =
        places.par_iter().filter_map(|place| Some((rooms.stand(*place, GLANCE)?, *place))).collect();
    // Of equals the first.
    glances.sort_by(|a, b| b.0.score.total_cmp(&a.0.score));
    // Above the scene is the open.
    let open = 0.5 * (lower + upper) + lower.distance(upper) * up;
    let stands = glances.chunks(CLOSER).find_map(|chunk| {
        let closely = |(_, place): &(Stand, Vec3)| {
            let stand = rooms.stand(*place, AROUND)?;
            Some(rooms.walled(stand, open).unwrap_or(stand))
        };
        let stands: Vec<Stand> = chunk.par_iter().filter_map(closely).collect();
        (!stands.is_empty()).then_some(stands)
    })?;
    let best = stands.iter().copied().reduce(better)?;
    let is_far_higher = |stand: &&Stand| stand.height >= OUTDOORS * best.height;
    let outside = glances.iter().map(|(stand, _)| stand).find(is_far_higher).unwrap_or(&best);
    rooms.best_view(rooms.within(outside, &glances).unwrap_or(stands))
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
    /// Whether nothing is to be seen from there.
    is_bare: bool,
    /// In which directions walls part the place from the outdoors; all of them where nothing goes
    /// round it.
    walls: [bool; AROUND],
}

/// A group's faces of one material.
type Thing = (u32, u32);

fn thing(polygon: &Polygon) -> Thing {
    (polygon.group.0, polygon.material.0)
}

/// A face that is met.
#[derive(Clone, Copy)]
struct Look {
    /// How far it is, m.
    distance: f32,
    is_bright: bool,
    thing: Thing,
    polygon: usize,
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
    /// Things that the scene has.
    things: usize,
}

impl Rooms<'_> {
    /// Places in the scene's box, and in front of its faces: a large ground would leave few of the
    /// first in a house.
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

    /// The next face that way.
    fn look(&self, from: Vec3, direction: Vec3) -> Option<Look> {
        let hit = self.occluders.first_hit(from, direction)?;
        let polygon = hit.polygon as usize;
        let thing = self.scene.polygons.get(polygon).map(thing)?;
        Some(Look { distance: hit.distance, is_bright: hit.front, thing, polygon })
    }

    /// How far people walk that way, m: not into the open.
    fn reach(&self, from: Vec3, direction: Vec3) -> f32 {
        self.look(from, direction).map_or(0.0, |look| look.distance.min(FARTHEST))
    }

    /// Places in the best of the rooms that a far higher space goes round, and in others.
    fn within(&self, outside: &Stand, glances: &[(Stand, Vec3)]) -> Option<Vec<Stand>> {
        let is_low =
            |(stand, _): &&(Stand, Vec3)| OUTDOORS * stand.height <= outside.height && stand.floor >= LEAST_FLOOR;
        let low: Vec<Vec3> = glances.iter().filter(is_low).take(MOST_ROOMS).map(|(_, place)| *place).collect();
        let room = |place: &Vec3| {
            let room = self.walled(self.stand(*place, AROUND)?, outside.eye)?;
            (room.floor >= LEAST_FLOOR).then_some(room)
        };
        let mut stands: Vec<Stand> = low.par_iter().filter_map(room).collect();
        let first = stands.iter().copied().reduce(better)?;
        // Few of the places tried lie in the room: more of them, within its walls.
        let walls = (0..AROUND).filter(|step| first.walls[*step]);
        let ends = walls.map(|step| first.eye + self.reach(first.eye, self.around(step)) * self.around(step));
        let (lower, upper) = ends.fold((first.eye, first.eye), |(lower, upper), end| (lower.min(end), upper.max(end)));
        let places: Vec<Vec3> = places_in(lower, upper).collect();
        stands.par_extend(places.par_iter().filter_map(room));
        Some(stands)
    }

    /// The best of the views from good places; `None` where next to nothing is to be seen inside,
    /// and more from outside.
    fn best_view(&self, mut stands: Vec<Stand>) -> Option<CameraPose> {
        stands.sort_by(|a, b| b.score.total_cmp(&a.score));
        let best = stands.first()?.score;
        stands.retain(|stand| stand.score >= GOOD * best);
        let step = stands.len().div_ceil(MOST_VIEWED).max(1);
        let view = stands.iter().step_by(step).filter_map(|stand| self.view(stand)).reduce(View::better)?;
        let is_stage = view.is_poor && self.content_from_outside().content() > view.content.content();
        (!is_stage).then_some(view.pose)
    }

    /// A place with the walls that part it from the space of another; `None` where that does not go
    /// round it.
    fn walled(&self, stand: Stand, outside: Vec3) -> Option<Stand> {
        let walls = outdoors::walls(self.scene, self.occluders, outside, stand.eye)?;
        // What is seen through a window is no floor of the room, and who stands in the window sees
        // few walls.
        let reaches = (0..AROUND).filter(|step| walls[*step]).map(|step| self.reach(stand.eye, self.around(step)));
        let (count, floor) =
            reaches.fold((0.0, 0.0), |(count, floor), reach| (count + 1.0, floor + sector(reach, AROUND)));
        let share = count / AROUND as f32 * floor / stand.floor.max(f32::MIN_POSITIVE);
        Some(Stand { floor, score: share * stand.score, walls, ..stand })
    }

    fn around(&self, step: usize) -> Vec3 {
        heading(self.up, step, AROUND)
    }

    /// The place above the floor below a point, if a person can stand there; looks into `steps`
    /// directions around it.
    fn stand(&self, place: Vec3, steps: usize) -> Option<Stand> {
        // Some rooms have no floor: one stands where they end.
        let floor_there = self.look(place, -self.up);
        let below = floor_there.map_or_else(|| place.dot(self.up) - self.lowest, |floor| floor.distance);
        let is_floor = floor_there.is_some_and(|floor| floor.is_bright);
        let above = self.look(place, self.up);
        let height = above.map_or(self.tall, |ceiling| below + ceiling.distance);
        let headroom = (height / STANDING.min(STANDING_SHARE * self.tall)).min(1.0);
        if headroom < LEAST_HEADROOM {
            return None;
        }
        let has_ceiling = above.is_some_and(|ceiling| ceiling.is_bright);
        let level = EYE.min(HIGHEST_EYE * height);
        let eye = place + (level - below) * self.up;
        // A ray to another floor is one into the open: people do not stand on tables.
        let lowest = (1.0 + STEP) * level;
        let clear = CLEAR.min(CLEAR_SHARE * height);
        let (mut floor, mut bright, mut rays) = (0.0, 0.0, 0.0);
        let (mut things, mut reaches) = (Vec::new(), Vec::with_capacity(steps));
        for step in 0..steps {
            let flat = heading(self.up, step, steps);
            let ahead = self.look(eye, flat);
            let distance = ahead.map_or(0.0, |look| look.distance.min(FARTHEST));
            if ahead.is_some() && distance < clear {
                return None;
            }
            floor += sector(distance, steps);
            // The open is wide.
            reaches.push(if ahead.is_some() { distance } else { FARTHEST });
            for slope in [-0.6, 0.0, 0.6] {
                let direction = (flat + slope * self.up).normalize();
                let met = if slope == 0.0 { ahead } else { self.look(eye, direction) };
                let is_here = |look: &Look| -look.distance * direction.dot(self.up) <= lowest;
                bright += f32::from(met.is_some_and(|look| look.is_bright && is_here(&look)));
                things.extend(met.map(|look| look.thing));
                rays += 1.0;
            }
        }
        let is_no_room = height < STANDING || floor < SHAFT * height.min(FARTHEST).powi(2);
        if is_no_room && floor < LOW_ROOM_SHARE * self.ground {
            return None;
        }
        let (ahead, behind) = reaches.split_at(steps / 2);
        let width = ahead.iter().zip(behind).map(|(ahead, behind)| ahead + behind).fold(f32::INFINITY, f32::min);
        if width < NARROW.min(NARROW_SHARE * height) && floor < LARGE_PART * self.ground {
            return None;
        }
        things.sort_unstable();
        things.dedup();
        let is_bare = things.len() <= BARE && self.things >= MANY;
        let inside = bright / rays;
        let shelter = if has_ceiling && is_floor { 1.0 } else { UNDER_THE_SKY };
        let shown = if is_bare { NOTHING_SEEN } else { 1.0 };
        let score = floor * inside.powi(4) * shelter * shown * headroom.powi(2);
        (inside >= INSIDE).then_some(Stand { eye, height, floor, score, is_bare, walls: [true; AROUND] })
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
mod tests;
