//! Values along the lines of equal value in a gathered picture.

use egui::epaint::TextShape;
use egui::{Align2, Color32, FontId, Rect, Sense, Ui, vec2};

use crate::app::format;
use crate::base::photometry::ShownIn;
use crate::read::picture::LABEL_RIM;
use crate::render::Pixels;

/// Writes them; white with a dark rim, so that they can be read over bright and dark.
pub fn show(ui: &Ui, view: Rect, pixels: &Pixels, shown_in: ShownIn) {
    let painter = ui.painter_at(view);
    let scale = view.size() / egui::Vec2::from(pixels.size.map(|side| side as f32));
    for (index, label) in pixels.labels.iter().enumerate() {
        let text = format::short((shown_in.per_watt() * label.value).into());
        let at = view.min + scale * vec2(label.at.x, label.at.y);
        let write = |at, colour| {
            let galley = painter.layout_no_wrap(text.clone(), FontId::proportional(12.0), colour);
            let place = at - 0.5 * galley.size();
            TextShape::new(place, galley, colour).with_angle_and_anchor(-label.angle, Align2::CENTER_CENTER)
        };
        for aside in LABEL_RIM.map(egui::Vec2::from) {
            painter.add(write(at + aside, Color32::from_black_alpha(200)));
        }
        painter.add(write(at, Color32::WHITE));
        let response = ui.interact(
            Rect::from_center_size(at, vec2(24.0, 14.0)),
            ui.scope_id().with(("line", index)),
            Sense::hover(),
        );
        response
            .widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, format!("Line at {text}")));
    }
}
