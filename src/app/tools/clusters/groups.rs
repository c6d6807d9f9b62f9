//! The editor of groups: a tree to drag, drop and select in, and buttons that do the same by
//! keyboard.

use std::path::Path;

use egui::{Align2, Color32, ComboBox, LayerId, Order, ScrollArea, Sense, TextStyle, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::state::messages::Topic;
use crate::app::tools::clusters::editor::GroupEditor;
use crate::app::tools::clusters::outline::{Fold, ROW_HEIGHT, RowLook, show_head, show_row};
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::scene::{GroupId, GroupTree, RegroupError, Regrouped, Sidecar};
use crate::solve::{ClusteringMode, SolverParams};
use crate::worker::Command;

/// Widths of the columns, points.
const WIDTHS: [f32; 2] = [70.0, 70.0];

/// Groups that are being dragged.
struct Dragged(Vec<GroupId>);

/// Draws the editor.
pub fn show(ui: &mut Ui, shown: &Shown, editor: &mut GroupEditor, params: &mut SolverParams, outbox: &mut Outbox) {
    let Some(info) = &shown.info else { return };
    editor.follow(&info.scene);
    show_use(params, ui, outbox);
    let Some(tree) = editor.tree() else { return };
    let mut command = show_buttons(editor, &tree, ui);
    // A button may have changed it.
    let tree = editor.tree().unwrap_or(tree);
    if let Some(problem) = &editor.problem {
        let problem = theme::notice(ui, problem);
        rows::sentence(ui, problem);
    }
    ui.separator();
    show_head(
        ui,
        "Group",
        &[("Area m²", WIDTHS[0], "Area of all its polygons, m²"), ("Polygons", WIDTHS[1], "Polygons in it")],
    );
    let foot = 2.0 * ui.spacing().interact_size.y + 10.0;
    let height = (ui.available_height() - foot).max(3.0 * ROW_HEIGHT);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if let Some(edited) = show_tree(editor, &tree, height, ui) {
            command = editor.edit(edited).or(command.take());
        }
    });
    ui.add_space(4.0);
    show_foot(editor, info.path.as_deref(), ui, outbox);
    outbox.extend(command);
}

/// Whether the solver clusters by these groups, and a way to have it do so.
fn show_use(params: &mut SolverParams, ui: &mut Ui, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        if params.clustering == ClusteringMode::Groups {
            ui.label(theme::weak("The solver takes these groups as its clusters."));
            return;
        }
        let button = ui.button("Cluster by groups");
        if button.on_hover_text("Sets clustering to groups: these groups become the clusters of the solver").clicked() {
            params.clustering = ClusteringMode::Groups;
            outbox.push(Command::SetParams(*params));
        }
        let mode = format!("{:?}", params.clustering).to_lowercase();
        ui.label(theme::weak(format!("Clustering is {mode} at present.")));
    });
}

fn show_buttons(editor: &mut GroupEditor, tree: &GroupTree, ui: &mut Ui) -> Option<Command> {
    let mut command = None;
    let selection = editor.selection();
    let is_any = selection.iter().any(|group| group.0 > 0);
    ui.horizontal_wrapped(|ui| {
        let button = |ui: &mut Ui, name: &str, is_on: bool, hint: &str| {
            let button = ui.add_enabled(is_on, egui::Button::new(name));
            button
                .on_hover_text(hint)
                .on_disabled_hover_text("Select a group first; Ctrl adds to the selection")
                .clicked()
        };
        if button(ui, "New group", is_any, "Puts what is selected into a new group") {
            let name = editor.free_name();
            command = editor.edit(tree.grouped(&selection, &name));
        }
        if button(ui, "Move out", is_any, "Moves what is selected out of the group that holds it") {
            command = editor.edit(tree.moved_out(&selection));
        }
        if button(
            ui,
            "Dissolve",
            is_any,
            "Dissolves the selected groups: what is in them goes into what holds them; Delete does so to a row",
        ) {
            command = editor.edit(tree.dissolved(&selection));
        }
        if let Some(into) = show_targets(tree, is_any, ui) {
            command = editor.edit(tree.moved(&selection, into));
        }
        let undo = ui.add_enabled(editor.can_undo(), egui::Button::new("Undo grouping"));
        if undo.on_hover_text("Takes the last edit of the groups back").clicked() {
            command = editor.undo();
        }
    });
    let named = selection.first().copied().filter(|group| selection.len() == 1 && group.0 > 0);
    ui.horizontal(|ui| {
        let label = ui.label(theme::weak("Name"));
        let field = egui::TextEdit::singleline(&mut editor.name).desired_width(ui.available_width() - 84.0);
        let field = ui.add_enabled(named.is_some(), field).labelled_by(label.id);
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let renamed = ui.add_enabled(named.is_some(), egui::Button::new("Rename")).clicked();
        if let Some(group) = named.filter(|_| entered || renamed) {
            let name = editor.name.clone();
            command = editor.edit(tree.renamed(group, &name));
        }
    });
    command
}

/// A list of all groups; the one that was chosen to move into.
fn show_targets(tree: &GroupTree, is_on: bool, ui: &mut Ui) -> Option<GroupId> {
    let mut chosen = None;
    let response = ui.add_enabled_ui(is_on, |ui| {
        let targets = ComboBox::from_id_salt("move into").selected_text("Move into…").width(110.0);
        targets.show_ui(ui, |ui| {
            let addresses = tree.addresses();
            ui.set_min_width(260.0);
            let area = ScrollArea::vertical().auto_shrink([false, true]);
            area.show_rows(ui, ui.spacing().interact_size.y, addresses.len(), |ui, range| {
                for index in range {
                    let name = if index == 0 { "the scene itself" } else { addresses[index].as_str() };
                    if ui.selectable_label(false, name).clicked() {
                        chosen = Some(GroupId(index as u32));
                        ui.close();
                    }
                }
            });
        })
    });
    response.inner.response.on_hover_text("Moves what is selected into another group; dragging rows does the same");
    chosen
}

/// The rows; what dropping or a key asks for.
fn show_tree(
    editor: &mut GroupEditor,
    tree: &GroupTree,
    height: f32,
    ui: &mut Ui,
) -> Option<Result<Regrouped, RegroupError>> {
    let rows = editor.rows();
    let mut edited = None;
    let dragged = egui::DragAndDrop::payload::<Dragged>(ui.ctx());
    let area = ScrollArea::vertical().id_salt("groups").auto_shrink([false, false]).max_height(height);
    area.show_rows(ui, ROW_HEIGHT, rows.len(), |ui, range| {
        for row in &rows[range] {
            let group = row.group;
            let name = tree.groups()[group.0 as usize].name.as_str();
            let (polygons, square_metres) = editor.size(group);
            let values = [format::number(square_metres), format::count(polygons)];
            let full_name = if group.0 == 0 { format!("{name}, the scene itself") } else { tree.path(group) };
            let fold = match (editor.has_groups(group), editor.is_unfolded(group)) {
                (false, _) => Fold::Leaf,
                (true, false) => Fold::Folded,
                (true, true) => Fold::Unfolded,
            };
            let look = RowLook {
                id: egui::Id::unique(("group row", group.0)),
                depth: row.depth,
                fold,
                name,
                full_name: &full_name,
                colour: None,
                values: &values,
                is_selected: editor.selected.contains(&group),
                is_marked: false,
                sense: Sense::click_and_drag(),
            };
            let done = show_row(ui, &look, &WIDTHS);
            if done.toggled || done.response.double_clicked() {
                editor.toggle(group);
            }
            if done.response.clicked() {
                let keeps_others = ui.input(|input| input.modifiers.command || input.modifiers.shift);
                editor.select(group, keeps_others);
            }
            if done.response.contains_pointer() || done.response.has_focus() {
                editor.pointed = Some(group);
            }
            if group.0 > 0 {
                let moving = if editor.selected.contains(&group) { editor.selection() } else { vec![group] };
                done.response.dnd_set_drag_payload(Dragged(moving));
            }
            if done.response.dnd_hover_payload::<Dragged>().is_some() {
                ui.painter().rect_stroke(
                    done.response.rect,
                    3.0,
                    (1.5, theme::palette(ui.visuals()).accent),
                    egui::StrokeKind::Inside,
                );
            }
            if let Some(moving) = done.response.dnd_release_payload::<Dragged>() {
                edited = Some(tree.moved(&moving.0, group));
            }
            if dragged.is_none() && done.response.has_focus() && ui.input(|input| input.key_pressed(egui::Key::Delete))
            {
                edited = Some(tree.dissolved(&[group]));
            }
        }
    });
    if let Some(dragged) = dragged {
        show_dragged(&dragged, tree, ui);
    }
    edited
}

/// Shows the groups that are being dragged beside the mouse.
fn show_dragged(dragged: &Dragged, tree: &GroupTree, ui: &Ui) {
    let Some(pointer) = ui.ctx().pointer_interact_pos() else { return };
    let text = match dragged.0[..] {
        [only] => tree.groups()[only.0 as usize].name.clone(),
        _ => format::things(dragged.0.len(), "group", "groups"),
    };
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Tooltip, egui::Id::unique("dragged groups")));
    let at = pointer + egui::vec2(14.0, 4.0);
    let galley = painter.layout_no_wrap(text, TextStyle::Body.resolve(ui.style()), theme::TEXT_STRONG);
    let rect = Align2::LEFT_TOP.anchor_size(at, galley.size()).expand2(egui::vec2(7.0, 3.0));
    painter.rect_filled(rect, 4.0, Color32::from_black_alpha(210));
    painter.galley(at, galley, theme::TEXT_STRONG);
}

fn show_foot(editor: &mut GroupEditor, scene: Option<&Path>, ui: &mut Ui, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        let as_in_file = ui.add_enabled(editor.is_arranged(), egui::Button::new(words::REVERT_TO_FILE));
        if as_in_file.on_hover_text("Arranges all groups as the scene's file has them; can be undone").clicked() {
            outbox.extend(editor.as_in_file());
        }
        let save = ui.add_enabled(scene.is_some(), egui::Button::new("Save groups"));
        let save = save
            .on_hover_text("Writes the groups into NAME.selflink.json beside the scene, with whatever else was changed")
            .on_disabled_hover_text("A sample scene has no file: write it to one with selflink scene");
        if let Some(scene) = scene.filter(|_| save.clicked()) {
            outbox.act(Action::SaveSettings { overwrites: false });
            if Sidecar::path_for(scene).exists() {
                let sentence = "The section Scene at the left asks whether the settings file is overwritten.";
                outbox.act(Action::Note(Topic::Saving, sentence.into()));
            }
        }
        let count = editor.selected.len();
        if count > 1 {
            ui.label(theme::weak(format!("{count} selected")));
        }
    });
    ui.label(theme::weak("Drag groups onto others; Ctrl-click selects several."));
}
