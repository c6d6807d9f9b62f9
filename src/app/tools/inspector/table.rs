//! Every link of the element as a row: sorted by any column, drawn only where it is in sight.

use egui::accesskit::Role;
use egui::{Align, Button, Label, Layout, RichText, Sense, Ui, WidgetInfo};
use egui_extras::{Column as Width, TableBuilder, TableRow};

use crate::app::state::inspection::{Direction, Inspection};
use crate::app::tools::inspector::order::{Column, Order, over_epsilon, rays, value};
use crate::app::tools::inspector::{Subject, Walk, compact};
use crate::app::view::highlight::{Highlight, Pointing};
use crate::app::widgets::theme;
use crate::app::{format, panels, words};
use crate::transport::{LinkView, VisibilitySource};

const ROW_HEIGHT: f32 = 17.0;
const HEADER_HEIGHT: f32 = 20.0;
/// Least width of the names, points.
const LEAST_NAME: f32 = 84.0;
/// Size of the numbers, points.
const DIGITS: f32 = 11.0;

/// Columns of numbers with their width, points, what they are headed in either direction, their
/// name and what they mean.
const COLUMNS: [Heading; 8] = [
    (Column::Level, 34.0, ["Level"; 2], "level", "Level of the far end below the root"),
    (
        Column::Brought,
        42.0,
        ["E", "P"],
        "what it brings",
        "What the link brings to this element, W/m² in the strongest channel, or takes from it, W in all channels",
    ),
    (Column::FormFactor, 42.0, ["F"; 2], "form factor", "Form factor F without occlusion"),
    (Column::Visibility, 32.0, ["V"; 2], "visibility", "Visibility V, 0 to 1"),
    (Column::Rays, 66.0, ["Rays"; 2], "rays", "Rays that tested V; inherited: the pair that holds this one was clear"),
    (
        Column::Power,
        60.0,
        ["Power (W)"; 2],
        "power",
        "Power B·F·V·A that the link carries to its whole receiver, sum of the channels, W",
    ),
    (
        Column::OverEpsilon,
        50.0,
        ["Power/ε"; 2],
        "share of ε",
        "Power of the strongest channel over the threshold ε, which bounds it",
    ),
    (
        Column::Error,
        56.0,
        ["Error (W)"; 2],
        "error estimate",
        "Power of the strongest channel that the link is likely to misplace, W",
    ),
];

/// Columns that give way where the inspector is narrow, the first one first; the details of a row
/// have what they would tell.
const GIVE_WAY: [Column; 5] = [Column::Level, Column::FormFactor, Column::Error, Column::OverEpsilon, Column::Rays];
/// Between columns, points.
const GAP: f32 = 5.0;

type Heading = (Column, f32, [&'static str; 2], &'static str, &'static str);

/// The columns that have room.
fn columns_in(width: f32) -> Vec<&'static Heading> {
    let mut columns: Vec<&Heading> = COLUMNS.iter().collect();
    for column in GIVE_WAY {
        let needed: f32 = columns.iter().map(|(_, width, ..)| width + GAP).sum();
        if LEAST_NAME + needed > width {
            columns.retain(|(other, ..)| *other != column);
        }
    }
    columns
}

/// Draws it; where a person goes.
pub fn show(
    ui: &mut Ui,
    subject: &Subject<'_>,
    inspection: &mut Inspection,
    direction: Direction,
    order: &mut Order,
    pointing: &mut Pointing,
) -> Option<Walk> {
    if inspection.links.is_empty() {
        ui.label(match direction {
            Direction::In => "No link brings it light.",
            Direction::Out => "It sends no light along any link.",
        });
        return None;
    }
    let mut walk = None;
    let count = inspection.links.len();
    ui.spacing_mut().item_spacing = egui::vec2(GAP, 0.0);
    let columns = columns_in(ui.available_width());
    let mut builder = TableBuilder::new(ui)
        .id_salt("links")
        .striped(true)
        .sense(Sense::click())
        .auto_shrink([false, false])
        .min_scrolled_height(60.0)
        .cell_layout(Layout::right_to_left(Align::Center))
        .column(Width::remainder().at_least(LEAST_NAME).clip(true));
    for (_, width, ..) in &columns {
        builder = builder.column(Width::exact(*width));
    }
    let table = builder.header(HEADER_HEIGHT, |mut header| show_header(&mut header, &columns, direction, order));
    table.body(|body| {
        let rows = order.rows(subject, inspection, direction).to_vec();
        body.rows(ROW_HEIGHT, count, |mut row| {
            let Some(&link) = rows.get(row.index()).and_then(|&at| inspection.links.get(at as usize)) else { return };
            let highlight = Highlight::Link { receiver: link.receiver, source: link.source };
            row.set_hovered(pointing.shown() == highlight);
            show_link(&mut row, subject, inspection, &columns, direction, &link);
            let response = row.response();
            if response.hovered() {
                pointing.at(highlight);
            }
            if response.clicked() {
                walk = Some(Walk::To(direction.far_end(&link)));
            }
        });
    });
    walk
}

fn show_header(header: &mut TableRow<'_, '_>, columns: &[&Heading], direction: Direction, order: &mut Order) {
    let (name, hint) = match direction {
        Direction::In => ("Source", "What sends the light"),
        Direction::Out => ("Receiver", "What gets the light"),
    };
    header.col(|ui| {
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| title(ui, Column::Name, name, "name", hint, order));
    });
    for (column, _, titles, name, hint) in columns {
        let text = titles[usize::from(direction == Direction::Out)];
        header.col(|ui| title(ui, *column, text, name, hint, order));
    }
}

/// A column's title: a click sorts by it, another one the other way.
fn title(ui: &mut Ui, column: Column, text: &str, name: &str, hint: &str, order: &mut Order) {
    let is_chosen = order.by == column;
    let visuals = ui.visuals();
    let colour = if is_chosen { theme::palette(visuals).accent } else { visuals.weak_text_color() };
    ui.spacing_mut().button_padding = egui::Vec2::ZERO;
    let response = ui.add(Button::new(RichText::new(text).size(DIGITS + 0.5).color(colour)).frame(false));
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_chosen, format!("Sort by {name}")));
    let turn = match (is_chosen, order.is_ascending) {
        (false, _) => "click to sort by it",
        (true, false) => "largest first; click to reverse",
        (true, true) => "smallest first; click to reverse",
    };
    if response.on_hover_text(format!("{hint}\n({turn})")).clicked() {
        order.choose(column);
    }
}

fn show_link(
    row: &mut TableRow<'_, '_>,
    subject: &Subject<'_>,
    inspection: &mut Inspection,
    columns: &[&Heading],
    direction: Direction,
    link: &LinkView,
) {
    let far = direction.far_end(link);
    let is_own = link.receiver == link.source;
    let name = match is_own {
        true => "itself, among its parts".to_owned(),
        false => inspection.names.full(far).to_owned(),
    };
    row.col(|ui| {
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(RichText::new(&name).size(12.0)).truncate().selectable(false));
        });
    });
    for &&(column, ..) in columns {
        row.col(|ui| {
            let text = RichText::new(cell(subject, link, direction, column)).monospace().size(DIGITS);
            let text = if is_strong(column) { text.strong() } else { text };
            ui.add(Label::new(text).selectable(false).extend());
        });
    }
    let response = row.response();
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Link {}: {name}", arrow(direction))));
    response.on_hover_ui_at_pointer(|ui| show_details(ui, subject, direction, link, &name));
}

fn arrow(direction: Direction) -> &'static str {
    match direction {
        Direction::In => "from",
        Direction::Out => "to",
    }
}

fn is_strong(column: Column) -> bool {
    matches!(column, Column::Brought | Column::Power)
}

fn cell(subject: &Subject<'_>, link: &LinkView, direction: Direction, column: Column) -> String {
    let number = |column| value(subject, link, direction, column);
    match column {
        Column::Name => String::new(),
        Column::Level => format!("{:.0}", number(column)),
        Column::Visibility => format!("{:.2}", link.visibility),
        Column::Rays => match (rays(link), link.visibility_source) {
            (Some(rays), _) => rays.to_string(),
            (None, VisibilitySource::Inherited) => "inherited".into(),
            (None, _) => words::NOT_TESTED.into(),
        },
        Column::Brought | Column::FormFactor | Column::Power | Column::OverEpsilon | Column::Error => {
            compact(number(column))
        }
    }
}

/// Shows the details that a row has no room for.
fn show_details(ui: &mut Ui, subject: &Subject<'_>, direction: Direction, link: &LinkView, name: &str) {
    let error = subject.solution_view.error(link);
    let watts = |power: f32| format::quantity(power.into(), "W");
    ui.label(RichText::new(name).strong());
    let whose = match direction {
        Direction::In => panels::picked::whose(link),
        Direction::Out => panels::picked::whose_light(link),
    };
    ui.label(whose);
    ui.label(format!(
        "carries {} to its receiver; its strongest channel is {} ε",
        watts(link.power.element_sum()),
        format::number(over_epsilon(subject, link).into())
    ));
    ui.label(format!(
        "error of the strongest channel by kernel {}, visibility {}, rays {}, source {}",
        watts(error.kernel),
        watts(error.visibility),
        watts(error.noise),
        watts(error.source)
    ));
    ui.label(theme::weak("Click to walk there"));
}
