//! The square itself: picture, marks, and what mouse and keys do to it.

use egui::emath::GuiRounding;
use egui::{
    Color32, EventFilter, Key, Painter, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Tooltip, Ui, Vec2, pos2,
};

use crate::app::actions::{Action, Outbox};
use crate::app::tools::matrix::{LinkMatrix, Looked, edges, tip};
use crate::app::view::highlight::{Highlight, Pointing, RECEIVER, SOURCE};
use crate::app::widgets::theme;
use crate::hierarchy::ElementId;
use crate::read::matrix::{EMPTY, Pair, View, pair_at};

/// Change of the magnification's logarithm for each point of scrolling.
const ZOOM_PER_POINT: f64 = 0.004;
/// A key zooms by this, and moves by this share of what is in view.
const ZOOM_PER_KEY: f64 = 1.5;
const STEP_PER_KEY: f64 = 0.15;
/// Marks of rows and columns are no thinner than this, points.
const LEAST_BAND: f32 = 2.0;

/// Name of the square for assistive technology and tests.
const NAME: &str = "Matrix of links";

/// Where places of the matrix lie on the screen.
#[derive(Clone, Copy)]
pub struct Map {
    pub rect: Rect,
    pub view: View,
}

impl Map {
    /// Horizontal place of a source.
    pub fn x(&self, place: f64) -> f32 {
        self.rect.left() + ((place - self.view.left) / self.view.size * f64::from(self.rect.width())) as f32
    }

    /// Vertical place of a receiver.
    pub fn y(&self, place: f64) -> f32 {
        self.rect.top() + ((place - self.view.top) / self.view.size * f64::from(self.rect.height())) as f32
    }

    /// Column and row under a point.
    fn place(&self, at: Pos2) -> [f64; 2] {
        let share = (at - self.rect.min) / self.rect.size();
        let place = |from: f64, share: f32| from + f64::from(share) * self.view.size;
        [place(self.view.left, share.x), place(self.view.top, share.y)]
    }

    /// A block on the screen.
    fn block(&self, rows: [f64; 2], columns: [f64; 2]) -> Rect {
        Rect::from_min_max(pos2(self.x(columns[0]), self.y(rows[0])), pos2(self.x(columns[1]), self.y(rows[1])))
    }
}

/// Draws square and edges, so large; where the square lies.
pub fn show(
    matrix: &mut LinkMatrix,
    ui: &mut Ui,
    looked: Looked<'_>,
    side: f32,
    pointing: &mut Pointing,
    outbox: &mut Outbox,
) -> Rect {
    let (outer, _) = ui.allocate_exact_size(Vec2::splat(side) + edges::WIDTH, Sense::hover());
    let rect = Rect::from_min_size(outer.min + edges::WIDTH, Vec2::splat(side)).round_to_pixels(ui.pixels_per_point());
    let response = ui.interact(rect, ui.scope_id().with(NAME), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, NAME));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    // Arrows move the view, not the focus.
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    matrix.view = steered(ui, &response, Map { rect, view: matrix.view });
    let map = Map { rect, view: matrix.view };

    let painter = ui.painter_at(rect.expand(1.0));
    let [r, g, b] = EMPTY;
    painter.rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
    paint_pictures(matrix, &ui.painter_at(rect), map);
    painter.rect_stroke(rect, 0.0, Stroke::new(1.0, theme::TEXT_WEAK.gamma_multiply(0.5)), StrokeKind::Outside);

    let hovered = hovered(matrix, looked, &response, map);
    let (marked_rows, marked_columns) = marks(pointing, looked, hovered.as_ref());
    paint_marks(&ui.painter_at(rect), matrix, looked, map, hovered.as_ref(), (&marked_rows, &marked_columns));
    edges::paint(&ui.painter_at(outer), matrix, looked, map, (&marked_rows, &marked_columns));
    if let Some(pair) = hovered {
        let (receiver, source) = ends(&pair);
        pointing.at(Highlight::Link { receiver, source });
        if response.clicked() {
            let picks_source = ui.input(|input| input.modifiers.shift);
            outbox.act(Action::Pick(if picks_source { source } else { receiver }));
        }
        if !response.dragged() {
            // At once: one moves over many blocks.
            Tooltip::for_widget(&response).at_pointer().gap(14.0).show(|ui| tip::show(ui, looked, &pair));
        }
    }
    rect
}

/// The pair under the mouse.
fn hovered(matrix: &LinkMatrix, looked: Looked<'_>, response: &Response, map: Map) -> Option<Pair> {
    let at = response.hover_pos().filter(|at| map.rect.contains(*at))?;
    Some(pair_at(looked.solution_view, matrix.room, map.place(at)))
}

/// Receiver and source: those of the link, or the leaves where there is none.
fn ends(pair: &Pair) -> (ElementId, ElementId) {
    let leaf = |path: &[ElementId]| path.last().copied().unwrap_or(crate::hierarchy::Hierarchy::ROOT);
    match &pair.link {
        Some(link) => (link.receiver, link.source),
        None => (leaf(&pair.receivers), leaf(&pair.sources)),
    }
}

/// A marked row or column.
pub type Mark = (ElementId, Color32);

/// Elements whose rows and whose columns are marked: what is pointed at, here or elsewhere, and
/// what is picked.
fn marks(pointing: &Pointing, looked: Looked<'_>, hovered: Option<&Pair>) -> (Vec<Mark>, Vec<Mark>) {
    let colour = |[r, g, b, _]: [u8; 4]| Color32::from_rgb(r, g, b);
    let (mut rows, mut columns) = (Vec::new(), Vec::new());
    if let Some(picked) = looked.picked {
        rows.push((picked, Color32::WHITE));
        columns.push((picked, Color32::WHITE));
    }
    let pointed = match (hovered, pointing.shown()) {
        (Some(pair), _) => Some(ends(pair)),
        (None, Highlight::Link { receiver, source }) => Some((receiver, source)),
        (None, Highlight::Element(id)) => Some((id, id)),
        (None, Highlight::None) => None,
    };
    if let Some((receiver, source)) = pointed {
        rows.push((receiver, colour(RECEIVER)));
        columns.push((source, colour(SOURCE)));
    }
    let is_there = |(id, _): &Mark| looked.solution_view.holds(*id);
    rows.retain(is_there);
    columns.retain(is_there);
    (rows, columns)
}

/// The last picture where it lies in the present view; before it a coarse one of the whole square.
fn paint_pictures(matrix: &LinkMatrix, painter: &Painter, map: Map) {
    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    let image = |id, view: View| {
        let [rows, columns] = [[view.top, view.top + view.size], [view.left, view.left + view.size]];
        painter.image(id, map.block(rows, columns), all, Color32::WHITE);
    };
    let Some(shown) = &matrix.shown else { return };
    if shown.request.view != matrix.view
        && let Some((_, whole)) = &matrix.whole
    {
        image(whole.id(), View::WHOLE);
    }
    image(shown.texture.id(), shown.request.view);
}

fn paint_marks(
    painter: &Painter,
    matrix: &LinkMatrix,
    looked: Looked<'_>,
    map: Map,
    hovered: Option<&Pair>,
    (rows, columns): (&[Mark], &[Mark]),
) {
    let order = looked.solution_view.order(matrix.room);
    let band = |painter: &Painter, rect: Rect, colour: Color32| {
        painter.rect_filled(rect, 0.0, colour.gamma_multiply(0.10));
        painter.rect_stroke(rect, 0.0, Stroke::new(1.0, colour.gamma_multiply(0.55)), StrokeKind::Middle);
    };
    for &(id, colour) in rows {
        let [top, bottom] = at_least(order.span(id).map(|place| map.y(place)));
        let rect = Rect::from_min_max(pos2(map.rect.left() - 2.0, top), pos2(map.rect.right() + 2.0, bottom));
        band(painter, rect, colour);
    }
    for &(id, colour) in columns {
        let [left, right] = at_least(order.span(id).map(|place| map.x(place)));
        let rect = Rect::from_min_max(pos2(left, map.rect.top() - 2.0), pos2(right, map.rect.bottom() + 2.0));
        band(painter, rect, colour);
    }
    if let Some(link) = hovered.and_then(|pair| pair.link.as_ref()) {
        let block = map.block(order.span(link.receiver), order.span(link.source));
        painter.rect_stroke(block.expand(1.0), 0.0, Stroke::new(1.5, Color32::WHITE), StrokeKind::Outside);
    }
}

/// A band's beginning and end, moved apart where it would be too thin to be seen.
pub fn at_least([start, end]: [f32; 2]) -> [f32; 2] {
    let missing = 0.5 * (LEAST_BAND - (end - start)).max(0.0);
    [start - missing, end + missing]
}

/// The view after what mouse and keys did in this frame.
fn steered(ui: &Ui, response: &Response, map: Map) -> View {
    let mut view = map.view;
    if response.double_clicked() {
        return View::WHOLE;
    }
    if response.dragged() {
        let share = response.drag_delta() / map.rect.size();
        let moved = |share: f32| f64::from(share) * view.size;
        view = View::new(view.left - moved(share.x), view.top - moved(share.y), view.size);
    }
    if let Some(at) = response.hover_pos() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (ZOOM_PER_POINT * f64::from(scroll)).exp() * f64::from(pinch);
        if factor != 1.0 {
            view = view.zoomed(factor, Map { view, ..map }.place(at));
        }
    }
    let is_free = ui.memory(|memory| memory.focused().is_none());
    if !(response.has_focus() || response.hovered() && is_free) || ui.ctx().text_edit_focused() {
        return view;
    }
    ui.input_mut(|input| {
        let mut pressed = |key| input.consume_key(egui::Modifiers::NONE, key);
        let mut axis = |plus, minus| f64::from(i8::from(pressed(plus)) - i8::from(pressed(minus)));
        let step = STEP_PER_KEY * view.size;
        let (right, down) = (axis(Key::ArrowRight, Key::ArrowLeft), axis(Key::ArrowDown, Key::ArrowUp));
        let zoom = axis(Key::Plus, Key::Minus) + axis(Key::Equals, Key::Minus);
        if zoom != 0.0 {
            let middle = [view.left + 0.5 * view.size, view.top + 0.5 * view.size];
            view = view.zoomed(ZOOM_PER_KEY.powf(zoom.clamp(-1.0, 1.0)), middle);
        }
        if right != 0.0 || down != 0.0 {
            view = View::new(view.left + right * step, view.top + down * step, view.size);
        }
        if input.consume_key(egui::Modifiers::NONE, Key::Home) { View::WHOLE } else { view }
    })
}
