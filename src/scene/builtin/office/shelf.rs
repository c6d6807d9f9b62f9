//! A bookshelf against the wall (z = 0), 1 m wide, filled by chance but always in the same way.

use glam::vec3;

use super::super::furniture;
use super::super::shapes::{Dice, Draft, Faces};
use super::Paints;

const WIDTH: f32 = 1.0;
const HEIGHT: f32 = 2.1;
const DEPTH: f32 = 0.3;
const PLANK: f32 = 0.022;
const BOARDS: usize = 5;
const PLINTH: f32 = 0.1;
/// Neighbours that make one group.
const BOOKS_TO_A_GROUP: usize = 7;

/// The shelf and its books, by board.
pub(super) fn shelf(d: &mut Draft, p: &Paints, seed: u32) {
    let mut dice = Dice::new(seed);
    let inner = 0.5 * WIDTH - PLANK;
    let back = 0.01;
    d.group("case", |d| {
        let side = Faces::BACK | Faces::BOTTOM;
        d.cuboid(vec3(-inner - PLANK, 0.0, 0.0), vec3(-inner, HEIGHT, DEPTH), side, p.walnut);
        d.cuboid(vec3(inner, 0.0, 0.0), vec3(inner + PLANK, HEIGHT, DEPTH), side, p.walnut);
        d.cuboid(vec3(-inner, PLINTH, 0.0), vec3(inner, HEIGHT - PLANK, back), !Faces::FRONT, p.walnut);
        let plinth = !Faces::FRONT;
        d.cuboid(vec3(-inner, 0.0, 0.0), vec3(inner, PLINTH, DEPTH - 0.03), plinth, p.walnut);
    });
    let clear = (HEIGHT - PLINTH - PLANK) / BOARDS as f32;
    for board in 0..=BOARDS {
        let y = PLINTH + clear * board as f32;
        d.group(&format!("board_{}", board + 1), |d| {
            // Boards touch the sides and the back; the top one covers the back and touches the
            // wall.
            let shut = Faces::LEFT | Faces::RIGHT | Faces::BACK;
            let rear = if board < BOARDS { back } else { 0.0 };
            d.cuboid(vec3(-inner, y, rear), vec3(inner, y + PLANK, DEPTH - 0.005), shut, p.walnut);
            if board < BOARDS {
                books(d, p, &mut dice, [y + PLANK, clear - PLANK]);
            }
        });
    }
}

/// A row of upright books, and beside it a pile or a gap.
fn books(d: &mut Draft, p: &Paints, dice: &mut Dice, [y, clear]: [f32; 2]) {
    let inner = 0.5 * WIDTH - PLANK;
    let (mut x, end) = (0.006 - inner, inner - dice.between(0.08, 0.3));
    let mut row = Vec::new();
    let mut set = (p.covers[0], 0.0, 0.0);
    let mut left_in_set = 0;
    loop {
        if left_in_set == 0 {
            // Books come in small sets of one colour and size.
            left_in_set = dice.between(1.0, 4.99) as usize;
            set = (dice.pick(&p.covers), dice.between(0.55, 0.9) * clear, dice.between(0.028, 0.058));
        }
        left_in_set -= 1;
        let (cover, high, thick) = (set.0, set.1, set.2 * dice.between(0.9, 1.1));
        if x + thick > end {
            break;
        }
        row.push((x + 0.5 * thick, [thick, high, dice.between(0.17, 0.22)], cover));
        x += thick + 0.001;
    }
    for (index, group) in row.chunks(BOOKS_TO_A_GROUP).enumerate() {
        d.group(&format!("books_{}", index + 1), |d| {
            for &(x, size, cover) in group {
                let front = DEPTH - 0.03 - dice.between(0.0, 0.015);
                d.at(vec3(x, y, front), 0.0, |d| furniture::upright_book(d, size, cover, p.paper));
            }
        });
    }
    let room = inner - x;
    if room > 0.2 {
        d.piece("pile", vec3(x + 0.5 * room, y, 0.16), 0.0, |d| {
            let mut height = 0.0;
            for size in [1.0, 0.9, 0.8] {
                let (thick, cover) = (dice.between(0.025, 0.04), dice.pick(&p.covers));
                d.at(vec3(0.0, height, 0.0), 90.0, |d| {
                    furniture::lying_book(d, [0.22 * size, thick, 0.16 * size], cover, p.paper);
                });
                height += thick;
            }
        });
    }
}
