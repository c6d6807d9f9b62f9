//! The camera menu above the view: views from outside, the field of view, walking, and bookmarks.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, Slider, Ui};
use glam::Vec3;

use crate::app::view::viewport::Viewport;
use crate::app::words;

/// Fields of view that the slider offers, degrees.
const FIELDS_OF_VIEW: std::ops::RangeInclusive<f32> = 10.0..=120.0;

/// A view of the whole scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whole {
    Top,
    Front,
    Side,
}

impl Whole {
    /// The direction of sight in a scene with this axis upwards.
    pub fn sight(self, up: Vec3) -> Vec3 {
        let front = if up.z.abs() > 0.5 { Vec3::Y } else { -Vec3::Z };
        match self {
            // Nearly: the heading is that of the front view, so that its far end is above.
            Self::Top => 1e-3 * front - up,
            Self::Front => front,
            Self::Side => up.cross(front),
        }
    }
}

/// Draws the menu.
pub fn show(ui: &mut Ui, viewport: &mut Viewport) {
    // A click that chooses a view closes the menu; after others, one sees what came of them there.
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new(words::CAMERA).config(stays).ui(ui, |ui| {
        if ui.button(words::RESET_CAMERA).on_hover_text("Home").clicked() {
            viewport.reset();
            ui.close();
        }
        for (whole, name) in [(Whole::Top, words::TOP), (Whole::Front, words::FRONT), (Whole::Side, words::SIDE)] {
            if ui.button(name).on_hover_text("All of the scene from there; nearer walls are looked through").clicked() {
                viewport.show_whole(whole);
                ui.close();
            }
        }
        ui.separator();
        if let Some(mut degrees) = viewport.field_of_view() {
            let slider = Slider::new(&mut degrees, FIELDS_OF_VIEW).suffix("°").fixed_decimals(0);
            let label = ui.label(words::FIELD_OF_VIEW);
            if ui.add(slider).labelled_by(label.id).on_hover_text("Horizontal field of view").changed() {
                viewport.set_field_of_view(degrees);
            }
        }
        let hint = "W A S D walk at eye height and not through walls, instead of flying";
        ui.checkbox(&mut viewport.walks, words::WALK).on_hover_text(hint);
        ui.separator();
        if ui.button(words::ADD_BOOKMARK).on_hover_text("Keep this view of the scene").clicked() {
            viewport.add_bookmark();
        }
        let mut removed = None;
        for (index, pose) in viewport.bookmarks().to_vec().iter().enumerate() {
            ui.horizontal(|ui| {
                if ui.button(format!("{} {}", words::BOOKMARK, index + 1)).clicked() {
                    viewport.go_to(pose);
                    ui.close();
                }
                let remove = ui.small_button("×").on_hover_text("Remove this bookmark");
                if remove.accessible_name(format!("Remove bookmark {}", index + 1)).clicked() {
                    removed = Some(index);
                }
            });
        }
        if let Some(index) = removed {
            viewport.remove_bookmark(index);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the axes, whichever points up.
    #[test]
    fn views_from_outside_look_along_the_axes() {
        for up in [Vec3::Y, Vec3::Z] {
            let along = |whole: Whole| whole.sight(up).normalize();
            assert!(along(Whole::Top).dot(up) < -0.999 && along(Whole::Front).dot(up) == 0.0);
            assert!(along(Whole::Side).dot(along(Whole::Front)) == 0.0 && along(Whole::Side).dot(up) == 0.0);
        }
    }
}
