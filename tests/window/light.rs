//! The light section: what it says of lamps, of materials that are none, and of a new luminaire.
//!
//! Truth: closed forms: P = M·A in each channel, Φ_v = 179 lm/W of what the eye weighs; and the
//! lumen method, Φ_v = E·A/η.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::base::photometry::lux;

use crate::support::{choose, click, coarse, cornell, finish, until};

type Window = Harness<'static, App>;

fn opened() -> Window {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::LIGHT);
    window
}

fn is_there(window: &Window, label: &str) -> bool {
    window.query_all_by_label(label).next().is_some()
}

fn sliders(window: &Window, label: &str) -> usize {
    window.query_all_by_role_and_label(Role::Slider, label).count()
}

/// Name of the one lamp, and its luminous flux, lm.
fn lamp(window: &Window) -> (String, f32) {
    let scene = &window.state().scene_info().expect("a scene").scene;
    let emits = |polygon: &&selflink::scene::Polygon| scene.emits(polygon);
    let flux = scene
        .polygons
        .iter()
        .filter(emits)
        .map(|polygon| scene.area(polygon) * lux(scene.materials[polygon.material.0 as usize].emission.to_array()));
    let material = scene.polygons.iter().find(emits).expect("a lamp").material;
    (scene.materials[material.0 as usize].name.clone(), flux.sum())
}

fn dim(window: &mut Window, name: &str, percent: f64) {
    let dimmer = format!("Dimmer of {name}");
    window.get_by_role_and_label(Role::Slider, &dimmer).set_value_accesskit(percent);
    window.run_steps(3);
}

/// A flux in the words of the panel.
fn lumens(flux: f32) -> String {
    let flux = f64::from(flux);
    format!("{} lm", selflink::base::format::grouped(if flux < 100.0 { flux } else { flux.round() }))
}

#[test]
fn only_what_emits_has_a_flux_and_each_says_whose_it_is() {
    let mut window = opened();
    let (name, _) = lamp(&window);
    assert!(is_there(&window, &words::light_of(&name)) && sliders(&window, words::FLUX) == 1);
    click(&mut window, words::ADD_SQUARE_LIGHT);
    until(&mut window, "the luminaire", |window| is_there(window, &words::light_of("square light")));
    assert_eq!(sliders(&window, words::FLUX), 2);
    let wall = {
        let scene = &window.state().scene_info().expect("a scene").scene;
        scene.materials.iter().find(|material| material.emission.max_element() == 0.0).expect("a wall").name.clone()
    };
    choose(&mut window, "Material", &wall);
    assert!(!is_there(&window, &words::light_of(&wall)) && sliders(&window, words::FLUX) == 1);
    assert!(is_there(&window, words::MAKE_IT_A_LIGHT));
    click(&mut window, words::MAKE_IT_A_LIGHT);
    assert!(is_there(&window, &words::light_of(&wall)) && sliders(&window, words::FLUX) == 2);
}

/// 100 % of a dimmer is what is set, also after that was changed; and lamps that are off are not
/// counted.
#[test]
fn the_dimmer_and_the_flux_agree() {
    let mut window = opened();
    let (name, flux) = lamp(&window);
    assert!(is_there(&window, &format!("1 lamp, {}", lumens(flux))));
    window.get_by_role_and_label(Role::Slider, words::FLUX).set_value_accesskit(6000.0);
    window.run_steps(3);
    dim(&mut window, &name, 50.0);
    assert!(is_there(&window, "Dimmed to 50 %: 3,000 lm") && is_there(&window, "1 lamp, 3,000 lm"));
    until(&mut window, "half of it", |window| (lamp(window).1 - 3000.0).abs() < 1.0);
    dim(&mut window, &name, 100.0);
    assert!(is_there(&window, "1 lamp, 6,000 lm") && window.query_by_label_contains("Dimmed to").is_none());
    click(&mut window, words::SWITCH_OFF);
    assert!(is_there(&window, "0 of 1 lamp on, 0 lm") && is_there(&window, "Switched off"));
}

/// Which power is told is told, and nothing of it is cut off.
#[test]
fn watts_say_which_they_are() {
    let mut window = opened();
    let (name, _) = lamp(&window);
    let info = window.state().scene_info().expect("a scene").clone();
    let power = info.scene.emitted_power();
    let said = window.query_by_label_contains("Φ = ").expect("the power that ε goes by");
    assert!(said.rect().right() < window.state().view_rect().left(), "it is not cut off");
    let watts = |power: f32| format!("{} W", selflink::base::format::number(power.into()));
    assert!(
        is_there(&window, &format!("Φ = {} (strongest channel); ε was set in watts", watts(power.max_element())))
            || is_there(&window, &format!("Φ = {} (strongest channel), as when ε was set", watts(power.max_element())))
    );
    choose(&mut window, words::LAMP_UNIT, &format!("{}, W", words::POWER));
    let shown = window.get_by_role_and_label(Role::Slider, words::POWER).accesskit_node().numeric_value();
    let shown = shown.expect("a number of watts");
    assert!((shown - f64::from(power.element_sum())).abs() < 1e-3 * shown, "{name}: {shown} W, {power}");
}

/// The room is 5.5 by 5.6 m, or so; whatever it is, its flux is one digit and zeros, and the
/// luminaire lies beside the lamp.
#[test]
fn a_new_luminaire_has_a_round_flux_that_suits_the_floor_and_keeps_off_the_lamp() {
    let mut window = opened();
    click(&mut window, words::ADD_SQUARE_LIGHT);
    until(&mut window, "the luminaire", |window| {
        !window.state().scene_info().expect("a scene").scene.luminaires().is_empty()
    });
    let info = window.state().scene_info().expect("a scene").clone();
    let added = info.scene.luminaires().remove(0);
    let flux = f64::from(added.form.area() * lux(added.exitance.to_array()));
    let (lower, upper) = info.scene.bounds();
    let floor = f64::from((upper - lower).x * (upper - lower).z);
    assert!((300.0..=800.0).contains(&(flux / floor)), "{flux} lm over {floor} m²");
    let digit = flux / 10f64.powf(flux.log10().floor());
    assert!((digit - digit.round()).abs() < 1e-3, "{flux} lm");
    let of_file = info
        .scene
        .polygons
        .iter()
        .filter(|polygon| info.scene.emits(polygon) && info.scene.luminaire_of(polygon.material).is_none());
    for polygon in of_file {
        let (corners, count) = info.scene.corner_positions(polygon);
        let reach = 0.5 * added.form.size;
        let overlaps = |axis: usize| {
            let ends = corners[..count].iter().map(|corner| corner[axis]);
            let (least, most) = ends.fold((f32::MAX, f32::MIN), |(least, most), at| (least.min(at), most.max(at)));
            added.form.centre[axis] + reach > least && added.form.centre[axis] - reach < most
        };
        assert!(!(overlaps(0) && overlaps(2)), "{:?} lies over the lamp", added.form);
    }
}
