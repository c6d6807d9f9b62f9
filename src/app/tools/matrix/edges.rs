//! The edges of the matrix: brackets with the names of elements, sources above and receivers at the
//! left.

use egui::{Align2, Color32, FontId, Painter, Rect, Vec2, pos2, vec2};

use crate::app::tools::matrix::square::{Map, Mark, at_least};
use crate::app::tools::matrix::{LinkMatrix, Looked};
use crate::app::widgets::theme;
use crate::read::matrix::{Bracket, brackets, fitting_name};

/// Width of a tier of brackets, points, and the gap beside it.
const TIER: f32 = 15.0;
const GAP: f32 = 2.0;
const TIERS: usize = 2;
/// Room for the words that say which edge is which, points.
const WORDS: f32 = 15.0;
/// Width of both edges, points.
pub const WIDTH: Vec2 = Vec2::splat(WORDS + TIERS as f32 * (TIER + GAP) + 2.0);
/// Fill of brackets that lie side by side.
const FILLS: [Color32; 2] = [Color32::from_rgb(56, 60, 68), Color32::from_rgb(44, 47, 54)];
/// Free room at both ends of a name, points.
const MARGIN: f32 = 2.0;
/// Letters of a name.
const FONT: FontId = FontId::proportional(10.5);
/// Width of the line in place of a bracket without a name, points.
const LINE: f32 = 2.0;

/// Which edge of the square.
#[derive(Clone, Copy, PartialEq)]
enum Edge {
    Sources,
    Receivers,
}

/// Draws both.
pub fn paint(
    painter: &Painter,
    matrix: &LinkMatrix,
    looked: Looked<'_>,
    map: Map,
    (rows, columns): (&[Mark], &[Mark]),
) {
    let word = FontId::proportional(11.5);
    let outer = map.rect.min - WIDTH + Vec2::splat(0.5 * WORDS);
    painter.text(pos2(map.rect.center().x, outer.y), Align2::CENTER_CENTER, "Sources", word.clone(), theme::TEXT_WEAK);
    upright(painter, pos2(outer.x, map.rect.center().y), "Receivers", word, theme::TEXT_WEAK);
    for (edge, marks) in [(Edge::Sources, columns), (Edge::Receivers, rows)] {
        paint_edge(painter, matrix, looked, map, edge, marks);
    }
}

fn paint_edge(painter: &Painter, matrix: &LinkMatrix, looked: Looked<'_>, map: Map, edge: Edge, marks: &[Mark]) {
    let hierarchy = looked.solution_view.hierarchy();
    let order = looked.solution_view.order(matrix.room);
    let from = if edge == Edge::Sources { map.view.left } else { map.view.top };
    let side = map.rect.width();
    let all = brackets(hierarchy, order, [from, from + map.view.size], side, TIERS);
    for (place, bracket) in all.iter().enumerate() {
        let outer = place_of(edge, map, bracket.span, bracket.tier);
        let rect = outer.union(place_of(edge, map, bracket.span, bracket.last_tier));
        match fitting(painter, looked, edge, bracket, rect) {
            Some(name) => {
                painter.rect_filled(rect, 2.0, FILLS[place % FILLS.len()]);
                write(painter, edge, bracket, rect, &name);
            }
            // An empty label would look like one that failed: a line says where the element lies.
            None => {
                let line = match edge {
                    Edge::Sources => Rect::from_min_max(pos2(rect.left(), rect.bottom() - LINE), rect.max),
                    Edge::Receivers => Rect::from_min_max(pos2(rect.right() - LINE, rect.top()), rect.max),
                };
                painter.rect_filled(line, 0.0, FILLS[0]);
            }
        }
    }
    for &(id, colour) in marks {
        // Over both tiers, at the side of the square.
        let line = place_of(edge, map, order.span(id), TIERS - 1);
        let line = match edge {
            Edge::Sources => {
                Rect::from_min_max(pos2(line.left(), line.bottom() - 1.0), line.right_bottom() + vec2(0.0, 2.0))
            }
            Edge::Receivers => {
                Rect::from_min_max(pos2(line.right() - 1.0, line.top()), line.right_bottom() + vec2(2.0, 0.0))
            }
        };
        painter.rect_filled(line, 0.0, colour);
    }
}

/// Where a span lies in a tier of an edge, cut to what is in view.
fn place_of(edge: Edge, map: Map, span: [f64; 2], tier: usize) -> Rect {
    let across = WORDS + tier as f32 * (TIER + GAP);
    let outer = map.rect.min - WIDTH;
    let cut = |[start, end]: [f32; 2], range: egui::Rangef| {
        [start.clamp(range.min, range.max), (end - 1.0).clamp(range.min, range.max).max(start.min(range.max))]
    };
    match edge {
        Edge::Sources => {
            let [left, right] = cut(at_least(span.map(|place| map.x(place))), map.rect.x_range());
            Rect::from_min_max(pos2(left, outer.y + across), pos2(right, outer.y + across + TIER))
        }
        Edge::Receivers => {
            let [top, bottom] = cut(at_least(span.map(|place| map.y(place))), map.rect.y_range());
            Rect::from_min_max(pos2(outer.x + across, top), pos2(outer.x + across + TIER, bottom))
        }
    }
}

/// The longest name that fits a bracket.
fn fitting(painter: &Painter, looked: Looked<'_>, edge: Edge, bracket: &Bracket, rect: Rect) -> Option<String> {
    let room = if edge == Edge::Sources { rect.width() } else { rect.height() } - 2.0 * MARGIN;
    if room < 3.0 * MARGIN {
        return None;
    }
    let fits = |name: &str| painter.layout_no_wrap(name.into(), FONT, theme::TEXT).size().x <= room;
    fitting_name(looked.names, looked.solution_view, bracket, fits)
}

/// Writes a name into a bracket.
fn write(painter: &Painter, edge: Edge, bracket: &Bracket, rect: Rect, name: &str) {
    let colour = if bracket.tier == 0 { theme::TEXT_STRONG } else { theme::TEXT };
    match edge {
        Edge::Sources => {
            painter.text(rect.center(), Align2::CENTER_CENTER, name, FONT, colour);
        }
        Edge::Receivers => upright(painter, rect.center(), name, FONT, colour),
    }
}

/// Text that reads upwards, about its middle.
fn upright(painter: &Painter, middle: egui::Pos2, text: &str, font: FontId, colour: Color32) {
    let galley = painter.layout_no_wrap(text.into(), font, colour);
    let size = galley.size();
    let from = middle + 0.5 * vec2(-size.y, size.x);
    painter.add(egui::epaint::TextShape::new(from, galley, colour).with_angle(-std::f32::consts::FRAC_PI_2));
}
