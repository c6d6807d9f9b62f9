//! Links over the view: whose, which and in what colours; and the legend that says in words what is
//! not drawn.

use egui::{Align2, FontId, Rect, Slider, Ui, pos2, vec2};

use crate::app::state::settings::{LinkOverlay, LinksOf};
use crate::app::view::{View, colour_bar};
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::render::{ChosenLinks, LinkColour, LinkFilter, Seen, level_colour, power_colour};

/// Numbers of links a slider offers.
const STRONGEST: std::ops::RangeInclusive<usize> = 1..=2000;
/// Shares of ε a slider offers; its first place is 0.
const LEAST_POWER: std::ops::RangeInclusive<f32> = 0.0..=10.0;
const LEAST_POWER_ABOVE_0: f64 = 1e-4;

/// Draws the rows of the display section.
pub fn show(ui: &mut Ui, shown: &Shown, links: &mut LinkOverlay) {
    choice(
        ui,
        words::SHOW_LINKS,
        &mut links.of,
        &[
            (LinksOf::Nothing, words::LINKS_NONE, "No links over the view"),
            (
                LinksOf::Picked,
                "of selection",
                "Links of the selected element, each of which says how much of the light of a surface or a cluster reaches another: click a surface to select it",
            ),
            (LinksOf::Level, words::LINKS_AT_LEVEL, "Links of all receivers at one level of the hierarchy"),
        ],
    );
    if links.of == LinksOf::Nothing {
        return;
    }
    if links.of == LinksOf::Level {
        show_level(ui, shown, links);
    }
    choice(
        ui,
        "Link colour",
        &mut links.style.colour,
        &[
            (LinkColour::Power, "power", "Power B·F·V·A, sum of the channels, over that of the strongest link"),
            (
                LinkColour::Visibility,
                "visibility",
                "Whether the ends see each other fully or partly, are hidden from each other, or were not tested",
            ),
            (LinkColour::Level, "level", "The level of the source below the root"),
        ],
    );
    let filter = &mut links.filter;
    let slider = Slider::new(&mut filter.strongest, STRONGEST).logarithmic(true);
    rows::widget(ui, words::STRONGEST_LINKS, slider, "The most that are drawn, the strongest first");
    let slider = Slider::new(&mut filter.least_power, LEAST_POWER)
        .logarithmic(true)
        .smallest_positive(LEAST_POWER_ABOVE_0)
        .custom_formatter(|share, _| format!("{} ε", format::number(share)));
    let hint = "Links whose strongest channel carries less are left out; as a share of the threshold ε";
    rows::widget(ui, "Minimum power", slider, hint);
    show_kinds(ui, filter);
    ui.checkbox(&mut links.style.ends, words::OUTLINES_OF_ENDS)
        .on_hover_text("Rims of patches and boxes of clusters at both ends of each link");
}

fn show_level(ui: &mut Ui, shown: &Shown, links: &mut LinkOverlay) {
    let Some(deepest) = shown.solution_view().map(|solution_view| solution_view.deepest()) else { return };
    rows::row(ui, words::RECEIVERS_AT_LEVEL, |ui| rows::level(ui, &mut links.level, deepest))
        .on_hover_text("Levels below the root; clusters and patches count alike");
}

fn show_kinds(ui: &mut Ui, filter: &mut LinkFilter) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        ui.checkbox(&mut filter.patch_patch, words::PATCH_PATCH).on_hover_text("Links between two patches");
        let hint = "Links between a cluster and a patch, either way";
        ui.checkbox(&mut filter.cluster_patch, "cluster–patch").on_hover_text(hint);
        let hint = "Links between two clusters, self-links among them";
        ui.checkbox(&mut filter.cluster_cluster, "cluster–cluster").on_hover_text(hint);
    });
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        ui.checkbox(&mut filter.full, words::FULLY_VISIBLE).on_hover_text("All rays of the link came through");
        ui.checkbox(&mut filter.partial, words::PARTLY_VISIBLE).on_hover_text("Some rays of the link came through");
        let hint = "No ray of the link came through, or none was cast yet";
        ui.checkbox(&mut filter.unseen, words::HIDDEN_OR_NOT_TESTED).on_hover_text(hint);
    });
}

/// A row of alternatives.
fn choice<T: Copy + PartialEq>(ui: &mut Ui, name: &str, chosen: &mut T, choices: &[(T, &str, &str)]) {
    ui.horizontal_wrapped(|ui| {
        rows::row_label(ui, name);
        ui.spacing_mut().item_spacing.x = 2.0;
        for (value, text, hint) in choices {
            let response = ui.selectable_value(chosen, *value, *text).on_hover_text(*hint);
            response.widget_info(|| {
                let (role, label) = (egui::accesskit::Role::RadioButton, format!("{name}: {text}"));
                egui::WidgetInfo::selected(role, true, *chosen == *value, label)
            });
        }
    });
}

/// Size of the legend's bar, points.
const BAR: egui::Vec2 = vec2(252.0, 10.0);
/// Room around and inside of the card, points.
const MARGIN: f32 = 12.0;
/// Decades of power that the colours span.
const DECADES: f32 = 3.0;

/// Draws what the colours say, and how much is not drawn, into the view's lower right corner;
/// nothing where no links are drawn.
pub fn show_legend(ui: &Ui, rect: Rect, shown: &Shown, view: &mut View, meaning: LinkColour) {
    let Some(chosen) = view.marks.chosen_links() else { return };
    let words = chosen.to_string();
    let has_colours = !chosen.links.is_empty();
    let font = FontId::proportional(12.0);
    let painter = ui.painter_at(rect);
    let galley = painter.layout(words.clone(), font.clone(), theme::TEXT_STRONG, BAR.x);
    let of_colours = match meaning {
        _ if !has_colours => 0.0,
        LinkColour::Visibility => 37.0,
        LinkColour::Power | LinkColour::Level => 50.0,
    };
    let height = galley.size().y + 2.0 * 8.0 + of_colours;
    let size = vec2(BAR.x + 2.0 * MARGIN, height);
    let corner = Rect::from_min_size(rect.right_bottom() - vec2(MARGIN, MARGIN) - size, size);
    let Some(card) = view.overlays.free(rect, corner) else { return };
    view.overlays.take("link legend", card);
    let response = ui.interact(card, egui::Id::unique("link legend"), egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, &words));
    painter.rect_filled(card, 6.0, theme::PANEL.gamma_multiply(0.92));
    let text_height = galley.size().y;
    painter.galley(card.left_top() + vec2(MARGIN, 8.0), galley, theme::TEXT_STRONG);
    if !has_colours {
        return;
    }
    let text = |at, align, text: &str| painter.text(at, align, text, font.clone(), theme::TEXT);
    let top = card.top() + text_height + 14.0;
    let bar = Rect::from_min_size(pos2(card.left() + MARGIN, top + 15.0), BAR);
    let (title, labels) = match meaning {
        LinkColour::Power => ("Colour: power of the link, sum of the channels", power_labels(chosen)),
        LinkColour::Visibility => ("Colour: visibility V of the link", [String::new(), String::new()]),
        LinkColour::Level => ("Colour: level of the source", level_labels(shown)),
    };
    painter.text(pos2(bar.left(), top - 3.0), Align2::LEFT_TOP, title, font.clone(), theme::TEXT_WEAK);
    if meaning == LinkColour::Visibility {
        let names = [
            (Seen::Full, words::FULLY_VISIBLE),
            (Seen::Partial, words::PARTLY_VISIBLE),
            (Seen::Not, words::HIDDEN_OR_NOT_TESTED),
        ];
        let mut x = bar.left();
        for (seen, name) in names {
            let swatch = Rect::from_min_size(pos2(x, bar.top() + 2.0), vec2(14.0, 10.0));
            painter.rect_filled(swatch, 2.0, theme::rgb(seen.colour()));
            x = text(pos2(x + 19.0, bar.top()), Align2::LEFT_TOP, name).right() + 12.0;
        }
        return;
    }
    let colour = |along: f32| match meaning {
        LinkColour::Level => level_colour((1000.0 * along) as u16, 1000),
        LinkColour::Power | LinkColour::Visibility => power_colour(10_f32.powf(DECADES * (along - 1.0))),
    };
    painter.add(colour_bar::shape(bar, colour));
    text(pos2(bar.left(), bar.bottom() + 2.0), Align2::LEFT_TOP, &labels[0]);
    text(pos2(bar.right(), bar.bottom() + 2.0), Align2::RIGHT_TOP, &labels[1]);
}

fn power_labels(chosen: &ChosenLinks) -> [String; 2] {
    let most = chosen.links.first().map_or(0.0, |link| f64::from(link.power.element_sum()));
    let least = most / 10_f64.powf(DECADES.into());
    [format!("≤ {}", format::quantity(least, "W")), format::quantity(most, "W")]
}

fn level_labels(shown: &Shown) -> [String; 2] {
    let deepest = shown.solution_view().map_or(0, |solution_view| solution_view.deepest());
    ["0, the root".into(), deepest.to_string()]
}
