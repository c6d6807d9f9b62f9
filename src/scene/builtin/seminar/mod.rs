//! The paper's seminar room: rows of tables and chairs before a blackboard, windows on the left,
//! lamps above.
//!
//! The size asked for chooses how many rows and tables there are; what is left over goes onto the
//! tables.

mod pieces;
mod things;

use glam::{Vec3, vec3};

use super::furniture::{self, WindowPaint};
use super::shapes::{Dice, Draft, Faces, srgb};
use crate::scene::{CameraPose, MaterialId, Scene};
use things::Thing;

/// Each table seats two.
const SEATS_PER_TABLE: usize = 2;
/// Between the middles of neighbouring tables, m.
const TABLE_PITCH: f32 = 1.75;
/// Between the middles of neighbouring rows, m.
const ROW_PITCH: f32 = 1.25;
const TABLE_HEIGHT: f32 = 0.74;

/// Draws the room with exactly this many polygons.
pub(super) fn build(polygons: usize) -> Scene {
    // Seats grow a little slower than polygons do: a larger hall also shows more on its tables.
    let wanted = 24.0 * (polygons as f64 / 2008.0).powf(0.72) + 0.5;
    let sizes: Vec<Room> = Room::sizes().take_while(|room| room.seats() as f64 <= wanted).collect();
    let (room, rest) = (sizes.iter().rev())
        .map(|&room| (room, polygons.saturating_sub(Hall::draw(room, &[]).polygon_count())))
        .find(|(_, rest)| *rest >= things::SMALLEST_REST)
        .expect("the smallest room has fewer polygons than the range's start");
    let draft = Hall::draw(room, &things::plan(room.seats(), rest));
    let mut scene = draft.finish();
    scene.camera = Some(room.camera());
    scene
}

/// How many rows and tables, and the lengths that follow, in m.
#[derive(Clone, Copy, Debug)]
struct Room {
    rows: usize,
    tables: usize,
}

impl Room {
    /// From the smallest to the largest: wider and longer by turns.
    fn sizes() -> impl Iterator<Item = Self> {
        const MOST_TABLES: usize = 12;
        (2..=MOST_TABLES).flat_map(|tables| {
            let last = if tables == MOST_TABLES { 44 } else { (9 * tables / 5).max(4) };
            ((4 * tables).div_ceil(3).min(last)..=last).map(move |rows| Self { rows, tables })
        })
    }

    fn seats(self) -> usize {
        SEATS_PER_TABLE * self.rows * self.tables
    }

    fn width(self) -> f32 {
        TABLE_PITCH * self.tables as f32 + 1.6
    }

    fn length(self) -> f32 {
        ROW_PITCH * self.rows as f32 + 4.0
    }

    fn height(self) -> f32 {
        2.8 + 0.12 * self.tables as f32
    }

    /// Windows, each in a bay of about 3 m.
    fn bays(self) -> usize {
        (self.length() / 3.3).round() as usize
    }

    /// The middle of a table, on the floor.
    fn table(self, row: usize, table: usize) -> Vec3 {
        let x = TABLE_PITCH * (table as f32 - 0.5 * (self.tables - 1) as f32);
        vec3(x - 0.15, 0.0, -0.5 * self.length() + 3.3 + ROW_PITCH * row as f32)
    }

    /// From the corner behind the last row, across the room to the board and the windows.
    fn camera(self) -> CameraPose {
        let (x, z) = (0.5 * self.width(), 0.5 * self.length());
        CameraPose {
            eye: vec3(x - 0.75, 1.75, z - 0.35),
            target: vec3(-0.22 * x, 0.95, -z + 2.6),
            up: Vec3::Y,
            hfov_deg: 68.0,
        }
    }
}

struct Paints {
    wall: MaterialId,
    ceiling: MaterialId,
    floor: MaterialId,
    skirting: MaterialId,
    wood: MaterialId,
    seat: MaterialId,
    steel: MaterialId,
    white: MaterialId,
    door: MaterialId,
    board: MaterialId,
    dark: MaterialId,
    paper: MaterialId,
    water: MaterialId,
    covers: [MaterialId; 5],
    lamp: MaterialId,
    daylight: MaterialId,
    display: MaterialId,
}

impl Paints {
    fn new(d: &mut Draft) -> Self {
        let cover = |d: &mut Draft, index: usize, hex: u32| d.paint(&format!("cover_{index}"), srgb(hex));
        Self {
            wall: d.paint("wall", srgb(0xe9e2d0)),
            ceiling: d.paint("ceiling", srgb(0xefefec)),
            floor: d.paint("linoleum", srgb(0x8f8779)),
            skirting: d.paint("skirting", srgb(0x6b4a32)),
            wood: d.paint("beech", srgb(0xd3a671)),
            seat: d.paint("seat", srgb(0xb8603f)),
            steel: d.paint("steel", srgb(0x5a5f66)),
            white: d.paint("white_lacquer", srgb(0xe8e8e6)),
            door: d.paint("door", srgb(0x7f9aa8)),
            board: d.paint("blackboard", srgb(0x1f4436)),
            dark: d.paint("dark_plastic", srgb(0x3a3a3e)),
            paper: d.paint("paper", srgb(0xf0efe8)),
            water: d.paint("bottle", srgb(0x7fb0bd)),
            covers: [
                cover(d, 1, 0xa8352e),
                cover(d, 2, 0x2f5f94),
                cover(d, 3, 0x3f7d4a),
                cover(d, 4, 0xd9a53a),
                cover(d, 5, 0x6a4a80),
            ],
            lamp: d.lamp("lamp", Vec3::splat(0.7), vec3(34.0, 29.0, 21.0)),
            daylight: d.lamp("daylight", Vec3::splat(0.1), vec3(9.0, 11.5, 15.0)),
            display: d.lamp("display", Vec3::splat(0.05), vec3(0.6, 0.9, 1.4)),
        }
    }
}

/// The room being drawn.
struct Hall {
    draft: Draft,
    room: Room,
    paints: Paints,
}

impl Hall {
    /// The room with its furniture, and on the tables what `things` lists for each seat.
    fn draw(room: Room, things: &[Vec<Thing>]) -> Draft {
        let mut draft = Draft::new("seminar");
        let paints = Paints::new(&mut draft);
        let mut hall = Self { draft, room, paints };
        hall.shell();
        hall.window_side();
        hall.lamps();
        hall.front();
        hall.seats(things);
        hall.draft
    }

    fn shell(&mut self) {
        let (room, p) = (self.room, &self.paints);
        let (x, y, z) = (0.5 * room.width(), room.height(), 0.5 * room.length());
        self.draft.group("walls", |d| {
            d.quad([vec3(-x, 0., z), vec3(x, 0., z), vec3(x, 0., -z), vec3(-x, 0., -z)], p.floor);
            d.quad([vec3(-x, y, -z), vec3(x, y, -z), vec3(x, y, z), vec3(-x, y, z)], p.ceiling);
            d.quad([vec3(-x, 0., -z), vec3(x, 0., -z), vec3(x, y, -z), vec3(-x, y, -z)], p.wall);
            d.quad([vec3(x, 0., z), vec3(-x, 0., z), vec3(-x, y, z), vec3(x, y, z)], p.wall);
            d.quad([vec3(x, 0., -z), vec3(x, 0., z), vec3(x, y, z), vec3(x, y, -z)], p.wall);
        });
        const DOOR: f32 = 1.0;
        const DOOR_AT: f32 = 1.2;
        let thin = furniture::SKIRTING_DEPTH;
        self.draft.group("skirting", |d| {
            d.at(vec3(-x, 0.0, -z), 0.0, |d| furniture::skirting(d, [0.0, 2.0 * x], p.skirting));
            d.at(vec3(x, 0.0, z), 180.0, |d| furniture::skirting(d, [0.0, 2.0 * x], p.skirting));
            d.at(vec3(-x, 0.0, z), 90.0, |d| furniture::skirting(d, [thin, 2.0 * z - thin], p.skirting));
            d.at(vec3(x, 0.0, -z), -90.0, |d| {
                furniture::skirting(d, [thin, DOOR_AT - 0.5 * DOOR - 0.08], p.skirting);
                furniture::skirting(d, [DOOR_AT + 0.5 * DOOR + 0.08, 2.0 * z - thin], p.skirting);
            });
        });
        self.draft.piece("door", vec3(x, 0.0, DOOR_AT - z), -90.0, |d| {
            furniture::door(d, [DOOR, 2.1], p.door, p.white, p.steel);
        });
    }

    /// The wall at -x: one window and one radiator to each bay.
    fn window_side(&mut self) {
        let (room, p) = (self.room, &self.paints);
        let length = room.length() / room.bays() as f32;
        let (low, high) = (0.95, room.height() - 0.35);
        let paint = WindowPaint { reveal: p.wall, frame: p.white, pane: p.daylight, sill: p.white };
        self.draft.group("window_side", |d| {
            for bay in 0..room.bays() {
                let start = vec3(-0.5 * room.width(), 0.0, 0.5 * room.length() - length * bay as f32);
                d.piece(&format!("bay_{}", bay + 1), start, 90.0, |d| {
                    let (from, to) = (0.16 * length, 0.84 * length);
                    let [across, up] = [[0.0, from, to, length], [0.0, low, high, room.height()]];
                    let centre = |column, row| column == 1 && row == 1;
                    d.group("wall", |d| d.wall((Vec3::ZERO, Vec3::X, Vec3::Y), &across, &up, centre, p.wall));
                    d.piece("window", vec3(from, low, 0.0), 0.0, |d| {
                        furniture::window(d, [to - from, high - low], [2, 2], paint);
                    });
                    d.piece("radiator", vec3(0.25 * length, 0.0, 0.0), 0.0, |d| {
                        furniture::radiator(d, 0.5 * length, [0.14, 0.74], 4, p.white);
                    });
                });
            }
        });
    }

    fn lamps(&mut self) {
        let (room, p) = (self.room, &self.paints);
        let columns = (room.width() / 3.2).round() as usize;
        let rows = (room.length() / 3.4).round() as usize;
        self.draft.group("lamps", |d| {
            for row in 0..rows {
                for column in 0..columns {
                    let x = room.width() * ((column as f32 + 0.5) / columns as f32 - 0.5);
                    let z = room.length() * ((row as f32 + 0.5) / rows as f32 - 0.5);
                    d.piece(&format!("lamp_{}_{}", row + 1, column + 1), vec3(x, room.height(), z), 0.0, |d| {
                        furniture::ceiling_lamp(d, [0.3, 1.5], p.white, p.lamp);
                    });
                }
            }
        });
    }

    /// The board, the lecturer's desk and lectern, the clock and the projector.
    fn front(&mut self) {
        let (room, p) = (self.room, &self.paints);
        let (x, z) = (0.5 * room.width(), 0.5 * room.length());
        let board = 0.62 * room.width();
        self.draft.group("front", |d| {
            d.piece("board", vec3(-0.03 * room.width(), 0.9, -z), 0.0, |d| {
                let (half, high) = (0.5 * board, 1.25);
                let shut = Faces::BACK | Faces::ENDS;
                d.cuboid(vec3(-half, 0.0, 0.0), vec3(half, high, 0.02), !Faces::FRONT, p.board);
                d.cuboid(vec3(-half - 0.04, 0.0, 0.0), vec3(-half, high, 0.035), shut, p.wood);
                d.cuboid(vec3(half, 0.0, 0.0), vec3(half + 0.04, high, 0.035), shut, p.wood);
                d.cuboid(vec3(-half - 0.04, high, 0.0), vec3(half + 0.04, high + 0.04, 0.035), Faces::BACK, p.wood);
                d.cuboid(vec3(-half - 0.04, -0.04, 0.0), vec3(half + 0.04, 0.0, 0.1), Faces::BACK, p.wood);
                d.block(vec3(0.5, 0.0, 0.07), vec3(0.14, 0.03, 0.05), Faces::BOTTOM, p.dark);
                for chalk in 0..2 {
                    let at = vec3(-0.4 + 0.15 * chalk as f32, 0.0, 0.07);
                    d.block(at, vec3(0.07, 0.01, 0.01), Faces::BOTTOM, p.paper);
                }
            });
            d.piece("clock", vec3(0.5 * board + 0.2, 2.35, -z), 0.0, |d| {
                furniture::clock(d, 0.16, p.dark, p.paper, p.dark);
            });
            d.piece("desk", vec3(-0.35 * x, 0.0, 1.55 - z), 180.0, |d| {
                d.group("table", |d| pieces::table(d, 1.6, p.wood, p.steel));
                d.piece("chair", vec3(0.2, 0.0, 0.45), 12.0, |d| pieces::chair(d, p));
                d.piece("things", vec3(-0.4, TABLE_HEIGHT, 0.05), 15.0, |d| {
                    furniture::lying_book(d, [0.19, 0.035, 0.26], p.covers[1], p.paper);
                    d.at(vec3(0.0, 0.035, 0.0), 4.0, |d| {
                        furniture::lying_book(d, [0.15, 0.025, 0.2], p.covers[0], p.paper);
                    });
                });
            });
            d.piece("lectern", vec3(0.42 * x, 0.0, 1.35 - z), 180.0, |d| pieces::lectern(d, p));
            d.piece("projector", vec3(0.0, room.height(), 3.4 - z), 0.0, |d| pieces::projector(d, p));
        });
    }

    fn seats(&mut self, things: &[Vec<Thing>]) {
        let (room, p) = (self.room, &self.paints);
        self.draft.group("seats", |d| {
            for row in 0..room.rows {
                d.group(&format!("row_{}", row + 1), |d| {
                    for index in 0..room.tables {
                        let number = row * room.tables + index;
                        d.piece(&format!("table_{}", index + 1), room.table(row, index), 0.0, |d| {
                            d.group("table", |d| pieces::table(d, 1.35, p.wood, p.steel));
                            let mut dice = Dice::new(number as u32);
                            for (side, x) in [(1, -0.34), (2, 0.34)] {
                                let seat = SEATS_PER_TABLE * number + side - 1;
                                let (away, turn) = (dice.between(0.42, 0.6), dice.between(-14.0, 14.0));
                                d.piece(&format!("chair_{side}"), vec3(x, 0.0, away), turn, |d| pieces::chair(d, p));
                                let things = things.get(seat).map_or(&[][..], Vec::as_slice);
                                if !things.is_empty() {
                                    d.piece(&format!("things_{side}"), vec3(x, TABLE_HEIGHT, 0.0), 0.0, |d| {
                                        things::draw(d, things, p, Dice::new(seat as u32 + 7));
                                    });
                                }
                            }
                        });
                    }
                });
            }
        });
    }
}
