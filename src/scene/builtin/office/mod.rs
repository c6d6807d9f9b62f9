//! The paper's office: two desks under a wide window, shelves of books, plants, monitors and desk
//! lamps.

mod desk;
mod pieces;
mod shelf;

use glam::{Vec3, vec3};

use super::furniture::{self, WindowPaint};
use super::shapes::{Draft, Faces, srgb};
use crate::scene::{CameraPose, MaterialId, Scene};

/// Half the room's width and depth, and its height, m.
const ROOM: Vec3 = vec3(2.8, 2.7, 2.4);

/// Draws the office: 4,038 polygons.
pub(super) fn build() -> Scene {
    let mut draft = Draft::new("office");
    let paints = Paints::new(&mut draft);
    shell(&mut draft, &paints);
    window_side(&mut draft, &paints);
    lamps(&mut draft, &paints);
    desks(&mut draft, &paints);
    along_the_walls(&mut draft, &paints);
    let mut scene = draft.finish();
    scene.camera =
        Some(CameraPose { eye: vec3(-2.3, 1.6, 2.0), target: vec3(0.6, 0.78, -1.0), up: Vec3::Y, hfov_deg: 70.0 });
    scene
}

struct Paints {
    wall: MaterialId,
    accent: MaterialId,
    ceiling: MaterialId,
    floor: MaterialId,
    rug: MaterialId,
    oak: MaterialId,
    walnut: MaterialId,
    white: MaterialId,
    steel: MaterialId,
    dark: MaterialId,
    key: MaterialId,
    fabric: MaterialId,
    visitor: MaterialId,
    cushion: MaterialId,
    paper: MaterialId,
    pot: MaterialId,
    earth: MaterialId,
    leaf: MaterialId,
    fresh_leaf: MaterialId,
    enamel: MaterialId,
    covers: [MaterialId; 9],
    lamp: MaterialId,
    bulb: MaterialId,
    daylight: MaterialId,
    screen: MaterialId,
    screen_page: MaterialId,
    screen_code: MaterialId,
}

impl Paints {
    fn new(d: &mut Draft) -> Self {
        let covers = [0xa34a40, 0x41658c, 0x5a8060, 0xcfab5c, 0x6b5a80, 0xbd7448, 0x4a7a80, 0xd3c8b0, 0x4b4d55];
        let mut number = 0;
        let covers = covers.map(|hex| {
            number += 1;
            d.paint(&format!("cover_{number}"), srgb(hex))
        });
        Self {
            covers,
            wall: d.paint("wall", srgb(0xece5d6)),
            accent: d.paint("accent_wall", srgb(0xa9bdb4)),
            ceiling: d.paint("ceiling", srgb(0xf0f0ee)),
            floor: d.paint("parquet", srgb(0xa77d54)),
            rug: d.paint("rug", srgb(0x8f8a80)),
            oak: d.paint("oak", srgb(0xc99a63)),
            walnut: d.paint("walnut", srgb(0x7a5236)),
            white: d.paint("white_lacquer", srgb(0xe9e9e6)),
            steel: d.paint("steel", srgb(0x8a8f96)),
            dark: d.paint("dark_plastic", srgb(0x37383d)),
            key: d.paint("keys", srgb(0xd2d0c8)),
            fabric: d.paint("fabric", srgb(0x47637f)),
            visitor: d.paint("armchair", srgb(0xb98a4a)),
            cushion: d.paint("cushion", srgb(0xcdaa72)),
            paper: d.paint("paper", srgb(0xf1f0ea)),
            pot: d.paint("terracotta", srgb(0xb8623f)),
            earth: d.paint("earth", srgb(0x4a3728)),
            leaf: d.paint("leaf", srgb(0x3f7f3a)),
            fresh_leaf: d.paint("fresh_leaf", srgb(0x7fae4b)),
            enamel: d.paint("enamel", srgb(0xc23b30)),
            lamp: d.lamp("lamp", Vec3::splat(0.7), vec3(42.0, 36.0, 27.0)),
            bulb: d.lamp("bulb", Vec3::splat(0.7), vec3(900.0, 620.0, 300.0)),
            daylight: d.lamp("daylight", Vec3::splat(0.1), vec3(4.6, 5.5, 6.8)),
            screen: d.lamp("screen", Vec3::splat(0.04), vec3(0.35, 0.8, 1.6)),
            screen_page: d.lamp("screen_page", Vec3::splat(0.04), vec3(2.2, 2.3, 2.5)),
            screen_code: d.lamp("screen_code", Vec3::splat(0.04), vec3(0.12, 0.16, 0.22)),
        }
    }
}

fn shell(d: &mut Draft, p: &Paints) {
    let Vec3 { x, y, z } = ROOM;
    d.group("walls", |d| {
        d.quad([vec3(-x, 0., z), vec3(x, 0., z), vec3(x, 0., -z), vec3(-x, 0., -z)], p.floor);
        d.quad([vec3(-x, y, -z), vec3(x, y, -z), vec3(x, y, z), vec3(-x, y, z)], p.ceiling);
        d.quad([vec3(x, 0., z), vec3(-x, 0., z), vec3(-x, y, z), vec3(x, y, z)], p.wall);
        d.quad([vec3(x, 0., -z), vec3(x, 0., z), vec3(x, y, z), vec3(x, y, -z)], p.accent);
        d.quad([vec3(-x, 0., z), vec3(-x, 0., -z), vec3(-x, y, -z), vec3(-x, y, z)], p.wall);
    });
    const DOOR: f32 = 0.92;
    const DOOR_AT: f32 = 3.75;
    let thin = furniture::SKIRTING_DEPTH;
    d.group("skirting", |d| {
        d.at(vec3(-x, 0.0, -z), 0.0, |d| furniture::skirting(d, [0.0, 2.0 * x], p.white));
        d.at(vec3(x, 0.0, z), 180.0, |d| furniture::skirting(d, [0.0, 2.0 * x], p.white));
        d.at(vec3(-x, 0.0, z), 90.0, |d| furniture::skirting(d, [thin, 2.0 * z - thin], p.white));
        d.at(vec3(x, 0.0, -z), -90.0, |d| {
            furniture::skirting(d, [thin, DOOR_AT - 0.5 * DOOR - 0.08], p.white);
            furniture::skirting(d, [DOOR_AT + 0.5 * DOOR + 0.08, 2.0 * z - thin], p.white);
        });
    });
    d.piece("door", vec3(x, 0.0, DOOR_AT - z), -90.0, |d| {
        furniture::door(d, [DOOR, 2.05], p.walnut, p.white, p.steel);
    });
    d.piece("rug", vec3(0.75, 0.0, 0.65), 0.0, |d| d.block(Vec3::ZERO, vec3(2.5, 0.012, 1.6), Faces::BOTTOM, p.rug));
}

/// The wall at -z: a wide window over two radiators, plants on its sill.
fn window_side(d: &mut Draft, p: &Paints) {
    let paint = WindowPaint { reveal: p.wall, frame: p.white, pane: p.daylight, sill: p.white };
    let (from, to, low, high) = (0.95, 4.65, 1.0, 2.4);
    d.piece("window_side", vec3(-ROOM.x, 0.0, -ROOM.z), 0.0, |d| {
        let [across, up] = [[0.0, from, to, 2.0 * ROOM.x], [0.0, low, high, ROOM.y]];
        let centre = |column, row| column == 1 && row == 1;
        d.group("wall", |d| d.wall((Vec3::ZERO, Vec3::X, Vec3::Y), &across, &up, centre, p.wall));
        d.piece("window", vec3(from, low, 0.0), 0.0, |d| furniture::window(d, [to - from, high - low], [4, 1], paint));
        for (index, x) in [1.15, 3.15].into_iter().enumerate() {
            d.piece(&format!("radiator_{}", index + 1), vec3(x, 0.0, 0.0), 0.0, |d| {
                furniture::radiator(d, 1.3, [0.14, 0.72], 6, p.white);
            });
        }
        d.piece("sill_plant", vec3(from + 1.93, low, 0.03), 20.0, |d| pieces::small_plant(d, p, 11));
    });
}

fn lamps(d: &mut Draft, p: &Paints) {
    d.group("ceiling_lamps", |d| {
        for (index, x) in [-1.3, 1.3].into_iter().enumerate() {
            d.piece(&format!("lamp_{}", index + 1), vec3(x, ROOM.y, 0.2), 0.0, |d| {
                furniture::ceiling_lamp(d, [0.3, 1.5], p.white, p.lamp);
            });
        }
    });
}

fn desks(d: &mut Draft, p: &Paints) {
    d.piece("desk_1", vec3(-0.95, 0.0, -1.65), 0.0, |d| {
        desk::desk(d, p);
        desk::equipment(d, p, desk::Habits { seed: 1, lamp: -0.62, screen_turn: 6.0 });
        d.piece("telephone", vec3(-0.43, 0.0, -0.05), 12.0, |d| desk::telephone(d, p));
        d.piece("chair", vec3(-0.05, 0.0, 0.72), 30.0, |d| pieces::office_chair(d, p));
    });
    d.piece("desk_2", vec3(0.95, 0.0, -1.65), 0.0, |d| {
        desk::desk(d, p);
        desk::equipment(d, p, desk::Habits { seed: 2, lamp: 0.62, screen_turn: -8.0 });
        d.piece("calendar", vec3(0.42, 0.74, 0.0), -14.0, |d| furniture::name_card(d, p.paper));
        d.piece("chair", vec3(-0.1, 0.0, 0.85), -35.0, |d| pieces::office_chair(d, p));
    });
    d.piece("bin", vec3(0.0, 0.0, -1.3), 0.0, |d| pieces::bin(d, p));
}

/// Shelves and the tall plant on the right, the cabinet on the left, pictures and a clock.
fn along_the_walls(d: &mut Draft, p: &Paints) {
    d.group("shelves", |d| {
        for (index, z) in [-1.05, -0.03].into_iter().enumerate() {
            d.piece(&format!("shelf_{}", index + 1), vec3(ROOM.x, 0.0, z), -90.0, |d| {
                shelf::shelf(d, p, 5 + index as u32);
            });
        }
    });
    d.piece("tall_plant", vec3(2.4, 0.0, -1.95), 0.0, |d| pieces::tall_plant(d, p));
    d.piece("cabinet", vec3(-2.5, 0.0, -1.95), 0.0, |d| pieces::cabinet(d, p));
    d.piece("armchair", vec3(1.35, 0.012, 0.72), 118.0, |d| pieces::armchair(d, p));
    d.group("pictures", |d| {
        let picture = |d: &mut Draft, index: usize, at: Vec3, turn: f32, size: [f32; 2]| {
            d.piece(&format!("picture_{index}"), at, turn, |d| pieces::picture(d, p, size, index));
        };
        picture(d, 1, vec3(-2.34, 1.45, -ROOM.z), 0.0, [0.42, 0.56]);
        picture(d, 2, vec3(ROOM.x, 1.45, 0.82), -90.0, [0.36, 0.5]);
        picture(d, 3, vec3(-ROOM.x, 1.3, 0.2), 90.0, [1.1, 0.7]);
    });
    d.piece("clock", vec3(2.32, 2.1, -ROOM.z), 0.0, |d| furniture::clock(d, 0.15, p.dark, p.paper, p.dark));
}
