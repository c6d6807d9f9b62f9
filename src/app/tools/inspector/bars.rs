//! Light that clusters bring to the element, or get from it, as bars: links summed up by what holds
//! their far ends at a level.

use egui::{Align2, FontId, Rect, RichText, Sense, Slider, Ui, pos2, vec2};
use glam::Vec3;

use crate::app::format;
use crate::app::state::inspection::{Direction, Inspection};
use crate::app::tools::inspector::{Subject, Walk, compact};
use crate::app::view::highlight::{Highlight, Pointing};
use crate::app::widgets::theme;
use crate::hierarchy::ElementId;
use crate::transport::LinkView;

/// So many have a bar of their own; the others share one.
const MOST: usize = 6;
const HEIGHT: f32 = 17.0;
/// Widths of the name at most and of the numbers, points, and the name's share of what these leave:
/// the bar has the rest.
const NAME: f32 = 178.0;
const NAME_SHARE: f32 = 0.5;
const NUMBERS: f32 = 136.0;
/// Level by which far ends are summed up at first.
const USUAL_LEVEL: u16 = 3;

/// The level of the bars, and what they were made of.
pub struct Bars {
    level: u16,
    made_of: Option<(u64, u16)>,
    sums: Vec<(ElementId, Vec3)>,
    total: Vec3,
}

impl Default for Bars {
    fn default() -> Self {
        Self { level: USUAL_LEVEL, made_of: None, sums: Vec::new(), total: Vec3::ZERO }
    }
}

impl Bars {
    fn bring_up_to_date(&mut self, subject: &Subject<'_>, inspection: &Inspection, direction: Direction) {
        let now = Some((inspection.stamp, self.level));
        if self.made_of == now {
            return;
        }
        let value = |link: &LinkView| brought(subject, link, direction);
        self.sums = subject.solution_view.folded(&inspection.links, self.level, |link| direction.far_end(link), value);
        self.sums.sort_by(|(_, a), (_, b)| in_one(*b, direction).total_cmp(&in_one(*a, direction)));
        self.total = self.sums.iter().map(|(_, sum)| *sum).sum();
        self.made_of = now;
    }
}

/// Irradiance that a link brings to the element, W/m², or power that it takes from it to its
/// receiver, W.
pub fn brought(subject: &Subject<'_>, link: &LinkView, direction: Direction) -> Vec3 {
    match direction {
        Direction::In => link.irradiance,
        Direction::Out => link.irradiance * subject.solution_view.hierarchy().element(link.receiver).area,
    }
}

/// One number for three channels: irradiance of the strongest, W/m², or power of all together, W.
pub fn in_one(brought: Vec3, direction: Direction) -> f32 {
    match direction {
        Direction::In => brought.max_element(),
        Direction::Out => brought.element_sum(),
    }
}

/// Draws them; where a person goes.
pub fn show(
    ui: &mut Ui,
    subject: &Subject<'_>,
    inspection: &mut Inspection,
    direction: Direction,
    bars: &mut Bars,
    pointing: &mut Pointing,
) -> Option<Walk> {
    bars.bring_up_to_date(subject, inspection, direction);
    show_heading(ui, subject, inspection, direction, bars);
    let (shown, rest) = bars.sums.split_at(MOST.min(bars.sums.len()));
    let of_rest = rest.iter().map(|(_, sum)| *sum).sum::<Vec3>();
    let of_rest = in_one(of_rest, direction);
    let most = shown.first().map_or(0.0, |(_, sum)| in_one(*sum, direction)).max(of_rest);
    let unit = unit(direction);
    let total = in_one(bars.total, direction);
    let mut walk = None;
    for &(id, sum) in shown {
        let name = inspection.names.full(id);
        let bar = Bar { name, value: in_one(sum, direction), most, total, unit };
        let response = bar.show(ui, true);
        if response.hovered() {
            pointing.at(Highlight::Element(id));
        }
        if response.clicked() {
            walk = Some(Walk::To(id));
        }
    }
    if !rest.is_empty() {
        let name = format!("the rest, {}", format::things(rest.len(), "element", "elements"));
        Bar { name: &name, value: of_rest, most, total, unit }.show(ui, false);
    }
    walk
}

fn unit(direction: Direction) -> &'static str {
    match direction {
        Direction::In => "W/m²",
        Direction::Out => "W",
    }
}

fn show_heading(ui: &mut Ui, subject: &Subject<'_>, inspection: &Inspection, direction: Direction, bars: &mut Bars) {
    let links = format::things(inspection.links.len(), "link", "links");
    let total = format::quantity(in_one(bars.total, direction).into(), unit(direction));
    ui.horizontal_wrapped(|ui| {
        let (text, hint) = match direction {
            Direction::In => (format!("{links} bring {total}"), "Over all links this is E by links; strongest channel"),
            Direction::Out => (format!("{links} carry {total}"), "Of the light that leaves it; sum of the channels"),
        };
        ui.label(RichText::new(text).strong()).on_hover_text(hint);
        let deepest = subject.solution_view.deepest();
        let mut level = bars.level.min(deepest);
        let hint = "Far ends are summed up by what holds them at this level below the root";
        let label = ui.label(theme::weak("by level")).on_hover_text(hint);
        ui.spacing_mut().slider_width = 60.0;
        ui.spacing_mut().interact_size.x = 40.0;
        let slider = ui.add(Slider::new(&mut level, 0..=deepest)).on_hover_text(hint);
        if slider.labelled_by(label.id).changed() {
            bars.level = level;
        }
    });
}

/// One bar with its name and numbers.
struct Bar<'a> {
    name: &'a str,
    value: f32,
    most: f32,
    total: f32,
    unit: &'a str,
}

impl Bar<'_> {
    fn show(&self, ui: &mut Ui, can_be_walked: bool) -> egui::Response {
        ui.spacing_mut().item_spacing.y = 1.0;
        let sense = if can_be_walked { Sense::click() } else { Sense::hover() };
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), sense);
        let share = if self.total > 0.0 { 100.0 * self.value / self.total } else { 0.0 };
        let numbers = format!("{} {} {share:>4.1} %", compact(self.value), self.unit);
        response.widget_info(|| {
            let role = if can_be_walked { egui::accesskit::Role::Button } else { egui::accesskit::Role::Label };
            egui::WidgetInfo::labeled(role, true, format!("{}: {numbers}", self.name))
        });
        let painter = ui.painter_at(rect);
        if response.hovered() && can_be_walked {
            painter.rect_filled(rect, 3.0, ui.visuals().widgets.hovered.weak_bg_fill);
        }
        let middle = rect.center().y;
        let (text, strong) = (ui.visuals().text_color(), ui.visuals().strong_text_color());
        let mut name = egui::text::LayoutJob::simple_singleline(self.name.into(), FontId::proportional(12.0), text);
        let name_width = NAME.min(NAME_SHARE * (rect.width() - NUMBERS));
        name.wrap = egui::text::TextWrapping::truncate_at_width(name_width);
        let name = painter.layout_job(name);
        painter.galley(pos2(rect.left() + 2.0, middle - 0.5 * name.size().y), name, text);
        let at = pos2(rect.right() - 2.0, middle);
        painter.text(at, Align2::RIGHT_CENTER, numbers, FontId::monospace(11.0), strong);
        let left = rect.left() + name_width + 8.0;
        let room = (rect.right() - NUMBERS - left).max(8.0);
        let width = if self.most > 0.0 { room * self.value / self.most } else { 0.0 };
        let bar = Rect::from_min_max(pos2(left, rect.top() + 3.0), pos2(left + width.max(1.0), rect.bottom() - 3.0));
        painter.rect_filled(bar, 2.0, theme::ACCENT.gamma_multiply(if can_be_walked { 0.85 } else { 0.4 }));
        if can_be_walked { response.on_hover_text(self.name) } else { response }
    }
}
