//! The tree of clusters: names from the scene, area, polygons, links and power of each; rows answer
//! to the view and the view to rows.

use std::sync::Arc;

use egui::{Color32, ScrollArea, Sense, Ui};
use rustc_hash::FxHashSet;

use crate::app::actions::{Action, Outbox};
use crate::app::state::names::NamesInView;
use crate::app::tools::clusters::content::{Powers, Row, has_rows_below, polygons, visible_rows, with_row};
use crate::app::tools::clusters::outline::{Fold, ROW_HEIGHT, RowLook, show_head, show_row};
use crate::app::view::highlight::{Highlight, Pointing};
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format};
use crate::hierarchy::{ElementId, Hierarchy};
use crate::render::cluster_colours;
use crate::solve::Snapshot;
use crate::transport::SolutionView;

/// Which power the last column has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum PowerShown {
    #[default]
    Received,
    Sent,
}

/// Meanings of the powers, as tooltips.
const RECEIVED: &str = "Power that arrives, E·A, sum of the channels, W";
const SENT: &str = "Power that leaves, B·A, sum of the channels, W";

/// A column of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Area,
    Polygons,
    Links,
    Power,
}

/// Columns with their widths, points.
const COLUMNS: [(Column, f32); 4] =
    [(Column::Area, 58.0), (Column::Polygons, 58.0), (Column::Links, 48.0), (Column::Power, 80.0)];
/// Columns that give way to the names where the tool is narrow, the first one first; the inspector
/// has what they tell.
const GIVE_WAY: [Column; 3] = [Column::Polygons, Column::Links, Column::Area];
/// Width that names are given before that, points.
const LEAST_NAME: f32 = 170.0;

/// The columns that have room.
fn columns_in(width: f32) -> Vec<(Column, f32)> {
    let mut columns = COLUMNS.to_vec();
    for column in GIVE_WAY {
        let needed: f32 = columns.iter().map(|(_, width)| width).sum();
        if LEAST_NAME + needed > width {
            columns.retain(|(other, _)| *other != column);
        }
    }
    columns
}

/// State of the tree.
#[derive(Default)]
pub struct ClusterTree {
    power: PowerShown,
    unfolded: FxHashSet<ElementId>,
    rows: Vec<Row>,
    /// State that rows and numbers were made of.
    of: Option<Arc<SolutionView>>,
    generation: u64,
    powers: Option<Powers>,
    /// Of each cluster, in the arena's order, and the places of clusters in it.
    colours: Vec<(ElementId, [u8; 3])>,
    /// The picked element that was last unfolded to.
    followed: Option<ElementId>,
    /// The row to be brought into sight.
    scroll_to: Option<usize>,
}

impl ClusterTree {
    /// Takes up a newer snapshot and another picked element.
    fn follow(&mut self, snapshot: &Snapshot, picked: Option<ElementId>) {
        let Some(solution_view) = &snapshot.solution_view else { return };
        let hierarchy = solution_view.hierarchy();
        let mut is_old = false;
        if self.generation != snapshot.generation || self.of.is_none() {
            // Other clusters, whose ids mean something else.
            self.generation = snapshot.generation;
            self.unfolded = [Hierarchy::ROOT].into_iter().collect();
            let clusters = hierarchy.ids().filter(|id| hierarchy.element(*id).is_cluster());
            self.colours = clusters.zip(cluster_colours(hierarchy)).collect();
            self.followed = None;
            is_old = true;
        }
        if self.of.as_ref().is_none_or(|of| !Arc::ptr_eq(of, solution_view)) {
            self.of = Some(solution_view.clone());
            self.powers = Some(Powers::new(solution_view));
        }
        let picked = picked.filter(|id| solution_view.holds(*id)).map(|id| with_row(hierarchy, id));
        if picked != self.followed {
            self.followed = picked;
            if let Some(picked) = picked {
                self.unfolded.extend(solution_view.path(picked).into_iter().filter(|above| *above != picked));
                is_old = true;
            }
        }
        if is_old {
            self.rows = visible_rows(hierarchy, &self.unfolded);
            self.scroll_to = picked.and_then(|picked| self.rows.iter().position(|row| row.element == picked));
        }
    }

    fn toggle(&mut self, hierarchy: &Hierarchy, id: ElementId) {
        if !self.unfolded.remove(&id) {
            self.unfolded.insert(id);
        }
        self.rows = visible_rows(hierarchy, &self.unfolded);
    }

    fn colour(&self, id: ElementId) -> Option<Color32> {
        let place = self.colours.binary_search_by_key(&id, |(cluster, _)| *cluster).ok()?;
        let [r, g, b] = self.colours[place].1;
        Some(Color32::from_rgb(r, g, b))
    }
}

/// A name below the row of what holds it: without the path that both have.
fn within<'a>(full_name: &'a str, holder: &str) -> &'a str {
    let path = holder.split_once(": ").map_or(holder, |(path, _)| path);
    let rest = if path.is_empty() { None } else { full_name.strip_prefix(path) };
    let material = |rest: &'a str| rest.strip_prefix(" (")?.strip_suffix(')');
    let shorter = rest.and_then(|rest| rest.strip_prefix('/').or(rest.strip_prefix(": ")).or(material(rest)));
    shorter.unwrap_or(full_name)
}

/// Draws the tree.
pub fn show(
    ui: &mut Ui,
    shown: &Shown,
    tree: &mut ClusterTree,
    names: &mut NamesInView,
    pointing: &mut Pointing,
    outbox: &mut Outbox,
) {
    let Some(snapshot) = &shown.snapshot else { return };
    tree.follow(snapshot, shown.picked_element());
    let Some(solution_view) = &snapshot.solution_view else {
        ui.label(theme::weak("Asking for the clusters…"));
        return;
    };
    let hierarchy = solution_view.hierarchy();
    ui.horizontal(|ui| {
        let clusters = format::things(hierarchy.cluster_count(), "cluster", "clusters");
        let polygons = format::things(hierarchy.initial_patches().len(), "polygon", "polygons");
        ui.label(theme::weak(format!("{clusters} over {polygons}")));
    });
    ui.horizontal(|ui| {
        ui.label(theme::weak("Power"));
        let all = [(PowerShown::Received, "Received", RECEIVED), (PowerShown::Sent, "Sent", SENT)];
        rows::alternatives(ui, &mut tree.power, &all);
    });
    let columns = columns_in(ui.available_width());
    let widths: Vec<f32> = columns.iter().map(|(_, width)| *width).collect();
    let heads: Vec<_> = columns
        .iter()
        .map(|&(column, width)| match (column, tree.power) {
            (Column::Area, _) => ("Area (m²)", width, "Area that light can reach, m²"),
            (Column::Polygons, _) => ("Polygons", width, "Polygons in it"),
            (Column::Links, _) => ("Links", width, "Links that end at it and at nothing smaller"),
            (Column::Power, PowerShown::Received) => ("Power in (W)", width, RECEIVED),
            (Column::Power, PowerShown::Sent) => ("Power out (W)", width, SENT),
        })
        .collect();
    show_head(ui, "Cluster", &heads);
    let mut area = ScrollArea::vertical().auto_shrink([false, false]);
    ui.spacing_mut().item_spacing.y = 0.0;
    if let Some(row) = tree.scroll_to.take() {
        area = area.vertical_scroll_offset((row as f32 * ROW_HEIGHT - 0.4 * ui.available_height()).max(0.0));
    }
    let (mut chosen, mut toggled) = (None, None);
    area.show_rows(ui, ROW_HEIGHT, tree.rows.len(), |ui, range| {
        for row in tree.rows.get(range).unwrap_or_default() {
            let id = row.element;
            let full_name = names.full(id).to_owned();
            let holder = hierarchy.element(id).parent().map(|parent| names.full(parent));
            let name = within(&full_name, holder.unwrap_or_default());
            let powers = tree.powers.as_ref();
            let power = powers.map_or(0.0, |powers| match tree.power {
                PowerShown::Received => powers.received(id),
                PowerShown::Sent => powers.sent(id),
            });
            let value = |&(column, _): &(Column, f32)| match column {
                Column::Area => format::number(hierarchy.element(id).area.into()),
                Column::Polygons => format::count(polygons(hierarchy, id) as u64),
                Column::Links => format::count(solution_view.links().of(id).len() as u64),
                Column::Power => format::number(power.into()),
            };
            let values: Vec<String> = columns.iter().map(value).collect();
            let fold = match (has_rows_below(hierarchy, id), tree.unfolded.contains(&id)) {
                (false, _) => Fold::Leaf,
                (true, false) => Fold::Folded,
                (true, true) => Fold::Unfolded,
            };
            let look = RowLook {
                id: egui::Id::unique(("cluster row", id.0)),
                depth: row.depth,
                fold,
                name,
                full_name: &full_name,
                colour: tree.colour(id),
                values: &values,
                is_selected: tree.followed == Some(id),
                is_marked: pointing.shown() == Highlight::Element(id),
                sense: Sense::click(),
            };
            let done = show_row(ui, &look, &widths);
            if done.toggled || done.response.double_clicked() {
                toggled = Some(id);
            }
            if done.response.clicked() {
                chosen = Some(id);
            }
            if done.response.hovered() || done.response.has_focus() {
                pointing.at(Highlight::Element(id));
            }
            done.response.on_hover_text(full_name);
        }
    });
    if let Some(id) = toggled.filter(|id| has_rows_below(hierarchy, *id)) {
        tree.toggle(hierarchy, id);
    }
    if let Some(id) = chosen {
        // Known already, so that the tree does not jump to it.
        tree.followed = Some(id);
        outbox.act(Action::Pick(id));
    }
}

#[cfg(test)]
mod tests {
    use super::{COLUMNS, Column, LEAST_NAME, columns_in, within};

    /// Truth: widths by hand. Names keep their room in the narrowest dock, whose power stays.
    #[test]
    fn columns_give_way_to_names() {
        for width in [300.0, 340.0, 420.0, 900.0] {
            let columns = columns_in(width);
            let taken: f32 = columns.iter().map(|(_, width)| width).sum();
            assert!(width - taken >= LEAST_NAME && columns.iter().any(|(column, _)| *column == Column::Power));
        }
        assert_eq!(columns_in(900.0), COLUMNS);
    }

    /// Written out by hand, in the forms that names have.
    #[test]
    fn names_leave_out_what_their_holder_says() {
        assert_eq!(within("desk/lamp", "desk"), "lamp");
        assert_eq!(within("desk/lamp (steel)", "desk/lamp: 9 polygons of it"), "steel");
        assert_eq!(within("desk/lamp (steel)", "desk: 9 polygons of it"), "lamp (steel)");
        assert_eq!(within("desk: 4 polygons of it", "desk: 9 polygons of it"), "4 polygons of it");
        assert_eq!(within("desktop", "desk"), "desktop");
        assert_eq!(within("cluster of 4 polygons", "cluster of 9 polygons"), "cluster of 4 polygons");
        assert_eq!(within("walls (wall)", ""), "walls (wall)");
    }
}
