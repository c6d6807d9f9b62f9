//! A row of a tree: its fold, its name, its numbers in columns. Both trees of the tool are drawn
//! with it.

use egui::{
    Align2, Color32, FontId, Key, Rect, Response, Sense, TextStyle, Ui, WidgetInfo, accesskit::Role, pos2, vec2,
};

use crate::app::widgets::theme;

/// Height of a row, points.
pub const ROW_HEIGHT: f32 = 20.0;
/// Room that a level takes at the left, points, and the deepest level that is moved in further.
const INDENT: f32 = 9.0;
const DEEPEST_INDENT: u16 = 12;
/// Room for the mark that folds and unfolds.
const FOLD_WIDTH: f32 = 15.0;

/// Whether a row has others below it, and whether these are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fold {
    Leaf,
    Folded,
    Unfolded,
}

/// Content of a row.
pub struct RowLook<'a> {
    pub id: egui::Id,
    pub depth: u16,
    pub fold: Fold,
    pub name: &'a str,
    /// Name of the row for assistive technology.
    pub full_name: &'a str,
    /// A patch of colour before the name.
    pub colour: Option<Color32>,
    pub values: &'a [String],
    pub is_selected: bool,
    pub is_marked: bool,
    pub sense: Sense,
}

/// Actions on a row.
pub struct RowDone {
    pub response: Response,
    /// It is to be folded or unfolded.
    pub toggled: bool,
}

/// Widths of the columns behind the name, points.
pub fn columns_width(widths: &[f32]) -> f32 {
    widths.iter().sum()
}

/// Draws the head of a table with the columns of its rows.
pub fn show_head(ui: &mut Ui, name: &str, columns: &[(&str, f32, &str)]) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::hover());
    let font = TextStyle::Small.resolve(ui.style());
    let middle = rect.center().y;
    ui.painter().text(
        pos2(rect.left() + FOLD_WIDTH, middle),
        Align2::LEFT_CENTER,
        name,
        font.clone(),
        theme::palette(ui.visuals()).text_weak,
    );
    let mut right = rect.right() - END_ROOM;
    for (title, width, hint) in columns.iter().rev() {
        let cell = Rect::from_min_max(pos2(right - width, rect.top()), pos2(right, rect.bottom()));
        ui.painter().text(
            pos2(right, middle),
            Align2::RIGHT_CENTER,
            title,
            font.clone(),
            theme::palette(ui.visuals()).text_weak,
        );
        let response = ui.interact(cell, ui.scope_id().with(("head", title)), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, *title));
        response.on_hover_text(*hint);
        right -= width;
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), ui.visuals().widgets.noninteractive.bg_stroke);
}

/// Room at the right for the scroll bar, points.
const END_ROOM: f32 = 10.0;

/// Draws a row over the whole width.
pub fn show_row(ui: &mut Ui, look: &RowLook<'_>, widths: &[f32]) -> RowDone {
    let (_, rect) = ui.allocate_space(vec2(ui.available_width(), ROW_HEIGHT));
    let response = ui.interact(rect, look.id, look.sense);
    response.widget_info(|| WidgetInfo::selected(Role::TreeItem, true, look.is_selected, look.full_name));
    let visuals = ui.visuals();
    let fill = if look.is_selected {
        Some(visuals.selection.bg_fill)
    } else if look.is_marked || response.hovered() || response.has_focus() {
        Some(visuals.widgets.hovered.weak_bg_fill)
    } else {
        None
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(rect, 3.0, fill);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(rect, 3.0, (1.0, theme::palette(ui.visuals()).accent), egui::StrokeKind::Inside);
    }
    let left = rect.left() + INDENT * f32::from(look.depth.min(DEEPEST_INDENT));
    let mut toggled = show_fold(ui, rect, left, look);
    toggled |= response.has_focus() && fold_by_key(ui, &response, look.fold);
    let middle = rect.center().y;
    let mut name_left = left + FOLD_WIDTH;
    if let Some(colour) = look.colour {
        let patch = Rect::from_center_size(pos2(name_left + 5.0, middle), vec2(9.0, 9.0));
        ui.painter().rect_filled(patch, 2.0, colour);
        name_left += 15.0;
    }
    let numbers = columns_width(widths) + END_ROOM;
    let room = Rect::from_min_max(pos2(name_left, rect.top()), pos2(rect.right() - numbers - 6.0, rect.bottom()));
    let colour = if look.is_selected { theme::palette(ui.visuals()).text_strong } else { ui.visuals().text_color() };
    let galley = egui::WidgetText::from(egui::RichText::new(look.name).color(colour)).into_galley(
        ui,
        Some(egui::TextWrapMode::Truncate),
        room.width().max(20.0),
        TextStyle::Body,
    );
    let at = pos2(room.left(), middle - 0.5 * galley.size().y);
    ui.painter().galley(at, galley, colour);
    show_values(ui, rect, look, widths);
    RowDone { response, toggled }
}

fn show_values(ui: &Ui, rect: Rect, look: &RowLook<'_>, widths: &[f32]) {
    let font = FontId::new(11.5, egui::FontFamily::Monospace);
    let mut right = rect.right() - END_ROOM;
    for (value, width) in look.values.iter().zip(widths).rev() {
        let at = pos2(right, rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, value, font.clone(), theme::palette(ui.visuals()).text_strong);
        right -= width;
    }
}

/// The mark that folds and unfolds; whether it was clicked.
fn show_fold(ui: &Ui, rect: Rect, left: f32, look: &RowLook<'_>) -> bool {
    if look.fold == Fold::Leaf {
        return false;
    }
    let place = Rect::from_min_size(pos2(left, rect.top()), vec2(FOLD_WIDTH, ROW_HEIGHT));
    // Not a stop of the keyboard: the row itself takes the arrow keys.
    let response = ui.interact(place, look.id.with("fold"), Sense::CLICK);
    let is_open = look.fold == Fold::Unfolded;
    let verb = if is_open { "Fold" } else { "Unfold" };
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{verb} {}", look.full_name)));
    let (c, colour) = (
        place.center(),
        if response.hovered() { theme::palette(ui.visuals()).accent } else { theme::palette(ui.visuals()).text_weak },
    );
    let points = match is_open {
        true => vec![c + vec2(-4.0, -2.0), c + vec2(4.0, -2.0), c + vec2(0.0, 3.5)],
        false => vec![c + vec2(-2.0, -4.0), c + vec2(3.5, 0.0), c + vec2(-2.0, 4.0)],
    };
    ui.painter().add(egui::Shape::convex_polygon(points, colour, egui::Stroke::NONE));
    response.clicked()
}

/// Right unfolds, left folds.
fn fold_by_key(ui: &Ui, response: &Response, fold: Fold) -> bool {
    let filter = egui::EventFilter { horizontal_arrows: true, ..egui::EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let key = match fold {
        Fold::Leaf => return false,
        Fold::Folded => Key::ArrowRight,
        Fold::Unfolded => Key::ArrowLeft,
    };
    ui.input(|input| input.key_pressed(key))
}
