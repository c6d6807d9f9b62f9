//! Things on the tables: planned seat by seat, so that the scene gets exactly the polygons asked
//! for.

use glam::{Vec3, vec3};

use super::super::furniture;
use super::super::shapes::{Dice, Draft, Faces};
use super::Paints;

/// Something on a table before a seat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thing {
    Paper,
    Pencil,
    Bottle,
    Laptop,
    /// A name card: the one thing of four polygons.
    Card,
    /// A book; several at one seat make a pile.
    Book,
}

/// Books and name cards fill what is left: 5 and 4 polygons, which with at most four cards add up
/// to any number from 16.
pub(super) const SMALLEST_REST: usize = 16;

/// Widths of a laptop's keys, row by row, in keys.
const LAPTOP_KEYS: [&[f32]; 5] =
    [&[1.0; 14], &[1.0; 14], &[1.5, 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 2.5], &[1.0; 14], &[1.5, 1.5, 7., 2., 2.]];

impl Thing {
    fn polygons(self) -> usize {
        match self {
            Self::Paper | Self::Pencil | Self::Book => 5,
            Self::Bottle => 27,
            Self::Laptop => 14 + 5 * LAPTOP_KEYS.iter().map(|row| row.len()).sum::<usize>(),
            Self::Card => 4,
        }
    }
}

/// Things at each of the `seats`: `polygons` polygons together.
pub(super) fn plan(seats: usize, polygons: usize) -> Vec<Vec<Thing>> {
    let mut plan = vec![Vec::new(); seats];
    let mut rest = polygons;
    // Steps of the golden section scatter the first visits all over the room; a step without a
    // common factor with the number of seats visits each once.
    let golden = (0.618 * seats as f64) as usize;
    let stride = (golden..seats).find(|&stride| gcd(stride, seats) == 1).unwrap_or(1);
    let seat = |visit: usize| visit * stride % seats;

    let few = [Thing::Paper, Thing::Book, Thing::Pencil, Thing::Paper, Thing::Bottle];
    let first = (0..seats).map(|visit| (visit, few[visit % few.len()]));
    let more = [Thing::Pencil, Thing::Book, Thing::Paper, Thing::Bottle, Thing::Laptop];
    let further = more.into_iter().flat_map(|thing| (0..seats).map(move |visit| (visit, thing)));
    for (visit, thing) in first.chain(further) {
        let here = &mut plan[seat(visit)];
        let wanted = thing == Thing::Book || !here.contains(&thing);
        if wanted && thing.polygons() + SMALLEST_REST <= rest {
            here.push(thing);
            rest -= thing.polygons();
        }
    }
    // 4·4 = 1 (mod 5): so many cards leave a multiple of 5.
    let cards = 4 * rest % 5;
    let books = (rest - 4 * cards) / 5;
    for visit in 0..cards {
        plan[seat(visit)].push(Thing::Card);
    }
    for visit in 0..books {
        plan[seat(visit)].push(Thing::Book);
    }
    plan
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Draws things on the table top before a seat (y = 0; the seat is at +z), each kind in a place of
/// its own.
pub(super) fn draw(d: &mut Draft, things: &[Thing], p: &Paints, mut dice: Dice) {
    let (mut height, mut size, pile_turn) = (0.0, 1.0, dice.between(-9.0, 9.0));
    for thing in things {
        let turn = dice.between(-9.0, 9.0);
        match thing {
            Thing::Paper => d.at(vec3(-0.17, 0.0, 0.13), turn, |d| furniture::paper(d, 0.003, p.paper)),
            Thing::Pencil => d.at(vec3(-0.015, 0.0, 0.13), turn, |d| furniture::pencil(d, p.covers[3])),
            Thing::Bottle => d.at(vec3(0.22, 0.0, -0.2), turn, |d| furniture::bottle(d, p.water, p.dark)),
            Thing::Card => d.at(vec3(0.04, 0.0, -0.22), 0.5 * turn, |d| furniture::name_card(d, p.paper)),
            Thing::Laptop => d.group("laptop", |d| d.at(vec3(0.155, 0.0, 0.14), 0.3 * turn, |d| laptop(d, p))),
            Thing::Book => {
                let (thick, cover) = (0.005 * dice.between(3.0, 8.0).round(), dice.pick(&p.covers));
                d.at(vec3(-0.2, height, -0.17), pile_turn + dice.between(-1.5, 1.5), |d| {
                    furniture::lying_book(d, [0.17 * size, thick, 0.23 * size], cover, p.paper);
                });
                height += thick;
                size *= 0.9; // the next one rests wholly on this one
            }
        }
    }
}

/// An open laptop, 0.3 m wide.
fn laptop(d: &mut Draft, p: &Paints) {
    d.block(Vec3::ZERO, vec3(0.3, 0.014, 0.2), Faces::BOTTOM, p.steel);
    furniture::keys(d, vec3(-0.14, 0.014, -0.09), [0.02, 0.003], &LAPTOP_KEYS, p.dark);
    // The lid stands on the base and leans back; six faces of a sheared box, and the display before
    // it.
    let lid = |x: f32, up: f32, z: f32| vec3(x, 0.014 + 0.19 * up, z - 0.05 * up - 0.09);
    let (l, r, t) = (-0.15, 0.15, 0.008);
    let front = [lid(l, 0., 0.), lid(r, 0., 0.), lid(r, 1., 0.), lid(l, 1., 0.)];
    let back = front.map(|corner| corner - vec3(0.0, 0.0, t));
    let [a, b, c, e] = front;
    let [ba, bb, bc, be] = back;
    for corners in [[bb, ba, be, bc], [b, bb, bc, c], [ba, a, e, be], [e, c, bc, be]] {
        d.quad(corners, p.steel);
    }
    let inner = |across: f32, up: f32| lid(0.14 * across, up, 0.0);
    let [ia, ib, ic, ie] = [inner(-1., 0.06), inner(1., 0.06), inner(1., 0.95), inner(-1., 0.95)];
    d.quad([ia, ib, ic, ie], p.display);
    for corners in [[a, b, ib, ia], [c, e, ie, ic], [b, c, ic, ib], [e, a, ia, ie]] {
        d.quad(corners, p.dark);
    }
}
