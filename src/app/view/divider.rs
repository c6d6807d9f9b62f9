//! The line between two solutions in the view, which can be dragged, and what stands at its sides.

use egui::{Align2, CursorIcon, FontId, Key, Painter, Rect, Sense, Stroke, Ui, pos2, vec2};

use crate::app::state::pinned::{Pinned, Sides};
use crate::app::widgets::theme;

/// So far beside the line it can be taken hold of, points.
const REACH: f32 = 5.0;
/// The line stays this share of the width away from the view's rims.
const RIM: f32 = 0.02;
/// Step of an arrow key, as a share of the width.
const STEP: f32 = 0.02;
/// Radius of the handle, points.
const HANDLE: f32 = 9.0;

/// Draws it; also lets it be dragged. Nothing where no solution is kept.
pub fn show(ui: &mut Ui, view: Rect, pinned: &mut Pinned) {
    if pinned.solution().is_none() {
        return;
    }
    let painter = ui.painter_at(view);
    match pinned.sides {
        Sides::Split => show_divider(ui, &painter, view, &mut pinned.divider),
        Sides::A => label(&painter, pos2(view.center().x, view.top() + 12.0), Align2::CENTER_TOP, "A, kept"),
        Sides::B => label(&painter, pos2(view.center().x, view.top() + 12.0), Align2::CENTER_TOP, "B, running"),
        // Its legend says what it is.
        Sides::Difference => {}
    }
}

fn show_divider(ui: &Ui, painter: &Painter, view: Rect, share: &mut f32) {
    let x = view.left() + *share * view.width();
    let grip = Rect::from_center_size(pos2(x, view.center().y), vec2(2.0 * REACH, view.height()));
    let response = ui.interact(grip, ui.scope_id().with("divider"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(*share), "Divider between A and B"));
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        *share = (pointer.x - view.left()) / view.width().max(1.0);
    }
    if response.has_focus() {
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        *share += STEP * f32::from(i8::from(pressed(Key::ArrowRight)) - i8::from(pressed(Key::ArrowLeft)));
    }
    *share = share.clamp(RIM, 1.0 - RIM);
    let is_held = response.hovered() || response.dragged() || response.has_focus();
    let colour = if is_held { theme::ACCENT } else { theme::TEXT_STRONG };
    painter.vline(x, view.y_range(), Stroke::new(3.0, egui::Color32::from_black_alpha(140)));
    painter.vline(x, view.y_range(), Stroke::new(1.5, colour));
    let middle = pos2(x, view.center().y);
    painter.circle(middle, HANDLE, theme::PANEL, Stroke::new(1.5, colour));
    for side in [-1.0, 1.0] {
        let tip = middle + vec2(side * 5.5, 0.0);
        painter.line_segment([tip, tip + vec2(-side * 3.0, -3.0)], Stroke::new(1.5, colour));
        painter.line_segment([tip, tip + vec2(-side * 3.0, 3.0)], Stroke::new(1.5, colour));
    }
    label(painter, pos2(x - 12.0, view.top() + 12.0), Align2::RIGHT_TOP, "A, kept");
    label(painter, pos2(x + 12.0, view.top() + 12.0), Align2::LEFT_TOP, "B, running");
    if is_held {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let _ = response.on_hover_text("Drag to show more of A or of B");
}

/// Words on a dark card, legible over any picture.
fn label(painter: &Painter, at: egui::Pos2, align: Align2, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.0), theme::TEXT_STRONG);
    let card = align.anchor_size(at, galley.size() + vec2(14.0, 8.0));
    painter.rect_filled(card, 5.0, theme::PANEL.gamma_multiply(0.92));
    painter.galley(card.min + vec2(7.0, 4.0), galley, theme::TEXT_STRONG);
}
