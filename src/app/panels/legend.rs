//! The legend over the view where its colours stand for errors.

use egui::{Align2, Color32, FontId, Mesh, Rect, Shape, Ui, pos2, vec2};

use super::super::comparison::{FULL_SCALE, Shading};
use super::super::theme;

/// Size of the bar, points.
const BAR: egui::Vec2 = vec2(220.0, 12.0);
/// Steps of the bar's colours.
const STEPS: usize = 44;
/// Room around it, points.
const MARGIN: f32 = 12.0;

/// Draws it into the view's lower left corner; nothing for light.
pub(in super::super) fn show(ui: &Ui, view: Rect, shading: Shading) {
    let (title, first, labels) = match shading {
        Shading::Lit => return,
        Shading::Error => ("relative error", 0.0, ["0 %", "25 %", "50 %"]),
        Shading::Difference => return show_difference(ui, view, "too dark – too bright"),
    };
    show_ramp(ui, view, shading, title, first, labels);
}

/// The same for signed differences; `title` says what the ends mean.
pub(in super::super) fn show_difference(ui: &Ui, view: Rect, title: &str) {
    show_ramp(ui, view, Shading::Difference, title, -FULL_SCALE, ["−50 %", "0 %", "+50 %"]);
}

fn show_ramp(ui: &Ui, view: Rect, shading: Shading, title: &str, first: f32, labels: [&str; 3]) {
    let card = Rect::from_min_size(
        pos2(view.left() + MARGIN, view.bottom() - MARGIN - 58.0),
        vec2(BAR.x + 2.0 * MARGIN + 12.0, 58.0),
    );
    let painter = ui.painter_at(view);
    painter.rect_filled(card, 6.0, theme::PANEL.gamma_multiply(0.92));
    let text = |at, align, text: &str, colour| {
        painter.text(at, align, text, FontId::proportional(12.0), colour);
    };
    text(card.left_top() + vec2(MARGIN + 6.0, 6.0), Align2::LEFT_TOP, title, theme::TEXT_STRONG);
    text(card.right_top() + vec2(-MARGIN - 6.0, 6.0), Align2::RIGHT_TOP, "grey: unknown", theme::TEXT_WEAK);
    let bar = Rect::from_min_size(card.left_top() + vec2(MARGIN + 6.0, 24.0), BAR);
    let mut mesh = Mesh::default();
    for step in 0..=STEPS {
        let along = step as f32 / STEPS as f32;
        let [r, g, b] = shading.colour(first + along * (FULL_SCALE - first));
        let (x, colour) = (bar.left() + along * bar.width(), Color32::from_rgb(r, g, b));
        mesh.colored_vertex(pos2(x, bar.top()), colour);
        mesh.colored_vertex(pos2(x, bar.bottom()), colour);
        if step > 0 {
            let last = 2 * step as u32;
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    painter.add(Shape::mesh(mesh));
    let below = bar.bottom() + 3.0;
    text(pos2(bar.left(), below), Align2::LEFT_TOP, labels[0], theme::TEXT);
    text(pos2(bar.center().x, below), Align2::CENTER_TOP, labels[1], theme::TEXT);
    text(pos2(bar.right(), below), Align2::RIGHT_TOP, labels[2], theme::TEXT);
}
