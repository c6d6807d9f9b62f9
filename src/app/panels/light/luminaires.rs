//! Luminaires that are added to the scene: the list, and the one at hand by numbers.

use egui::{DragValue, TextEdit, Ui};
use glam::Vec3;

use crate::app::panels::light::material::{show_strength, show_temperature, show_tint};
use crate::app::panels::light::{LampUnit, LightEditor};
use crate::app::state::lighting::LuminaireLight;
use crate::app::widgets::{rows, theme};
use crate::app::words;
use crate::base::photometry::{lux, tint_of_temperature};
use crate::prepare::ceiling::{CeilingPlace, place_beside};
use crate::scene::{LuminaireForm, LuminaireShape, Scene};
use crate::worker::SceneInfo;

/// Colour temperature of a new luminaire, K: neutral white.
const FIRST_KELVIN: f32 = 4000.0;
/// Sizes that a field offers, in the scene's length unit.
const SIZES: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// Directions to shine to.
const AXES: [(&str, Vec3); 6] = [
    ("along −y", Vec3::NEG_Y),
    ("along +y", Vec3::Y),
    ("along −x", Vec3::NEG_X),
    ("along +x", Vec3::X),
    ("along −z", Vec3::NEG_Z),
    ("along +z", Vec3::Z),
];
/// Width of the field of one coordinate, points.
const COORDINATE_WIDTH: f32 = 52.0;

/// Draws the part; `eye` is where a person looks from.
pub fn show(ui: &mut Ui, info: &SceneInfo, eye: Option<Vec3>, editor: &mut LightEditor) {
    ui.label(theme::weak("Luminaires"));
    ui.horizontal_wrapped(|ui| {
        let buttons = [
            (words::ADD_SQUARE_LIGHT, LuminaireShape::Square),
            (words::ADD_DISC_LIGHT, LuminaireShape::Disc),
            (words::ADD_LINE_LIGHT, LuminaireShape::Line),
        ];
        for (name, shape) in buttons {
            if ui
                .button(name)
                .on_hover_text("Under the ceiling of the room that is looked at; it can be moved")
                .clicked()
            {
                add(info, eye, shape, editor);
            }
        }
    });
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        for (index, luminaire) in editor.lighting.luminaires.iter().enumerate() {
            let is_at_hand = editor.selected == Some(index);
            let label = ui.selectable_label(is_at_hand, luminaire.name.as_str());
            let label = label.on_hover_text("Shows its numbers here and its handles in the view");
            if label.accessible_name(format!("Select {}", luminaire.name)).clicked() {
                chosen = Some((!is_at_hand).then_some(index));
            }
        }
    });
    if let Some(chosen) = chosen {
        editor.selected = chosen;
        editor.to_be_seen = editor.selected_mut().map(|luminaire| luminaire.form.centre);
    }
    let unit = &mut editor.unit;
    let Some(luminaire) = editor.selected.and_then(|index| editor.lighting.luminaires.get_mut(index)) else { return };
    // The rows of the material above have names of their own.
    if ui.push_id("luminaire", |ui| show_one(ui, &info.scene, luminaire, unit)).inner
        && let Some(index) = editor.selected.take()
    {
        editor.lighting.luminaires.remove(index);
    }
}

/// Adds a luminaire where there is room for it, and takes it in hand.
pub(super) fn add(info: &SceneInfo, eye: Option<Vec3>, shape: LuminaireShape, editor: &mut LightEditor) {
    let size = info.luminaire_size;
    let CeilingPlace { centre, up } = place_beside(&info.scene, &info.occluders, eye, size);
    let form = LuminaireForm { shape, centre, direction: -up, turn_deg: 0.0, size };
    let tint = Vec3::from(tint_of_temperature(FIRST_KELVIN));
    let exitance = info.luminaire_lumens / (form.area() * lux(tint.to_array()));
    let is_taken = |name: &str| editor.lighting.luminaires.iter().any(|luminaire| luminaire.name == name);
    let base = shape.usual_name();
    let mut names = std::iter::once(base.to_owned()).chain((2..).map(|number| format!("{base} {number}")));
    let is_free = |name: &String| !is_taken(name) && info.scene.material_named(name).is_none();
    let name = names.find(is_free).unwrap_or_default();
    editor.lighting.luminaires.push(LuminaireLight::new(name, form, exitance * tint));
    editor.selected = Some(editor.lighting.luminaires.len() - 1);
    editor.to_be_seen = Some(centre);
}

/// Draws the numbers of a luminaire; true when it is to be removed.
fn show_one(ui: &mut Ui, scene: &Scene, luminaire: &mut LuminaireLight, unit: &mut LampUnit) -> bool {
    let mut name = luminaire.name.clone();
    let field = rows::row(ui, "Name", |ui| ui.add(TextEdit::singleline(&mut name).desired_width(140.0)));
    let is_free = name == luminaire.name || scene.material_named(&name).is_none();
    if field.changed() && is_free && !name.trim().is_empty() {
        luminaire.name = name;
    }
    let form = &mut luminaire.form;
    rows::choice(ui, words::SHAPE, &mut form.shape, LuminaireShape::ALL, |shape| match shape {
        LuminaireShape::Square => "square",
        LuminaireShape::Disc => "disc",
        LuminaireShape::Line => "line",
    });
    let label = match form.shape {
        LuminaireShape::Square => words::SIDE_LENGTH,
        LuminaireShape::Disc => "Diameter",
        LuminaireShape::Line => words::LENGTH,
    };
    let speed = (0.01 * f64::from(form.size)).max(1e-6);
    rows::row(ui, label, |ui| {
        ui.add(DragValue::new(&mut form.size).speed(speed).range(SIZES).max_decimals(3).suffix(" m"))
    })
    .on_hover_text("In the scene's length unit (metres)");
    let mut place = scene.to_file(form.centre);
    let before = place;
    ui.horizontal(|ui| {
        rows::row_label(ui, "Place x, y, z");
        ui.spacing_mut().interact_size.x = COORDINATE_WIDTH;
        let fields =
            [("Place along x", &mut place.x), (words::LUMINAIRE_Y, &mut place.y), ("Place along z", &mut place.z)];
        for (name, coordinate) in fields {
            let field = ui.add(DragValue::new(coordinate).speed(0.01).max_decimals(3));
            let _ = field.on_hover_text("Its middle, in the coordinates of the scene's file, m").accessible_name(name);
        }
    });
    if place != before && place.is_finite() {
        form.centre = scene.from_file(place);
    }
    show_direction(ui, scene.up_axis(), form);
    rows::row(ui, words::TURN, |ui| {
        ui.add(DragValue::new(&mut form.turn_deg).speed(1.0).range(-360.0..=360.0).max_decimals(1).suffix("°"))
    })
    .on_hover_text("About the direction that it shines to");
    show_strength(ui, &luminaire.name, &mut luminaire.light, luminaire.form.area(), unit);
    show_temperature(ui, &mut luminaire.light);
    show_tint(ui, "Colour of the luminaire", &mut luminaire.light);
    let remove = ui.button(words::REMOVE_LUMINAIRE).on_hover_text("Takes this luminaire away; it can be undone");
    remove.accessible_name(format!("{} {}", words::REMOVE_LUMINAIRE, luminaire.name)).clicked()
}

/// Offers the axes as directions to shine to.
fn show_direction(ui: &mut Ui, up: Vec3, form: &mut LuminaireForm) {
    let name = |axis: &Vec3| match axis {
        axis if axis.dot(up) < -0.9999 => "down",
        axis if axis.dot(up) > 0.9999 => "up",
        axis => AXES.iter().find(|(_, other)| axis.dot(*other) > 0.9999).map_or("aslant", |(name, _)| name),
    };
    rows::choice(ui, words::SHINES, &mut form.direction, AXES.map(|(_, axis)| axis), name)
        .on_hover_text("Where its light goes");
}
