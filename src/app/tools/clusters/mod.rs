//! The clusters: how the view shows them, their tree with numbers, and manual groups.

mod content;
mod editor;
mod groups;
mod outline;
mod tree;

use egui::{Slider, Ui};
use glam::Vec3;

use crate::app::state::edits::Edits;
use crate::app::state::names::NamesInView;
use crate::app::state::settings::DisplaySettings;
use crate::app::view::View;
use crate::app::view::cluster_view::ClusterScene;
use crate::app::widgets::{rows, theme};
use crate::app::{Outbox, Shown, words};
use crate::render::{Line, Marks};
use editor::GroupEditor;
use tree::ClusterTree;

/// Page that the tool shows below its controls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Page {
    /// The solver's clusters.
    #[default]
    Tree,
    /// Groups, to be arranged by hand.
    Groups,
}

/// The pages with their names and hints.
const PAGES: [(Page, &str, &str); 2] = [
    (Page::Tree, "Tree of clusters", "The clusters that the solver links, from the whole scene down to polygons"),
    (
        Page::Groups,
        words::MANUAL_GROUPS,
        "Arrange the scene's objects in groups, which clustering by groups takes as its clusters",
    ),
];

/// The tool's own state; another scene starts it afresh.
#[derive(Default)]
pub struct Clusters {
    page: Page,
    tree: ClusterTree,
    editor: GroupEditor,
    marked: Option<Marked>,
}

/// Marks with a group's box, and what they were made of.
struct Marked {
    over: Marks,
    edges: [[Vec3; 2]; 12],
    all: Marks,
}

/// The box of a group, gamma-encoded, and its width, pixels.
const GROUP_BOX: ([u8; 4], f32) = ([255, 255, 255, 255], 2.5);

impl Clusters {
    /// Marks with the box of the group that the mouse is over added; the same ones as long as
    /// nothing changes.
    pub fn with_group(&mut self, marks: Marks) -> Marks {
        let Some(edges) = self.editor.take_pointed_box() else { return marks };
        match &self.marked {
            Some(marked) if (&marked.over, &marked.edges) == (&marks, &edges) => marked.all.clone(),
            _ => {
                let (colour, width) = GROUP_BOX;
                let mut lines = marks.0.as_ref().map_or_else(Vec::new, |lines| (**lines).clone());
                lines.extend(edges.map(|[from, to]| Line::new(from, to, width, colour)));
                let all = Marks::from(lines);
                self.marked = Some(Marked { over: marks, edges, all: all.clone() });
                all
            }
        }
    }
}

/// Draws the tool.
pub fn show(
    ui: &mut Ui,
    shown: &Shown,
    clusters: &mut Clusters,
    names: &mut NamesInView,
    view: &mut View,
    edits: &mut Edits,
    outbox: &mut Outbox,
) {
    show_view(ui, shown, &mut view.clusters, &mut edits.display);
    ui.separator();
    ui.horizontal(|ui| rows::alternatives(ui, &mut clusters.page, &PAGES));
    match clusters.page {
        Page::Tree => tree::show(ui, shown, &mut clusters.tree, names, &mut view.pointing, outbox),
        Page::Groups => groups::show(ui, shown, &mut clusters.editor, &mut edits.params, outbox),
    }
}

/// Colours, level, boxes and how far clusters are pulled apart.
fn show_view(ui: &mut Ui, shown: &Shown, view: &mut ClusterScene, display: &mut DisplaySettings) {
    let Some(snapshot) = &shown.snapshot else {
        ui.label(theme::weak("Open a scene to see its clusters."));
        return;
    };
    let deepest = snapshot.clusters.iter().map(|cluster| cluster.level).max().unwrap_or(0);
    ui.horizontal(|ui| {
        ui.checkbox(&mut view.coloured, words::COLOUR_BY_CLUSTER)
            .on_hover_text("Each surface shows the colour of its cluster instead of its light; grey hangs at the root");
        ui.checkbox(&mut display.show_clusters, "Boxes").on_hover_text("The boxes of the clusters of this level");
    });
    rows::row(ui, words::LEVEL, |ui| rows::level(ui, &mut display.cluster_level, deepest))
        .on_hover_text("Level of the hierarchy, the whole scene being 0");
    let can_explode = display.cluster_level.min(deepest) > 0;
    rows::row(ui, words::EXPLODE, |ui| {
        let mut percent = 100.0 * view.explode;
        let slider = Slider::new(&mut percent, 0.0..=100.0).fixed_decimals(0).suffix(" %");
        let response = ui.add_enabled(can_explode, slider);
        if response.changed() {
            view.explode = percent / 100.0;
        }
        let hint = "Pulls the clusters of the level apart; at 100 % they lie twice as far from the middle. Links are hidden meanwhile";
        response.on_hover_text(hint).on_disabled_hover_text("The root is one piece: choose a deeper level")
    });
}
