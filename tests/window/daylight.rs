//! Daylight in the window: let in, changed by presets, slider, plan and date, undone; the daylight
//! factor in false colours.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::DVec3;
use selflink::app::{App, words};
use selflink::measure::accuracy::closed_forms::point_to_polygon;
use selflink::prepare::added_light::AddedLight;
use selflink::read::daylight_factor::NoDaylightFactor;
use selflink::scene::outside::{Daylight, SunPlace};
use selflink::scene::{Reading, Source};

use super::support::{choose, click, coarse, finish, picture, share_of_different_pixels, until, window_with};

/// A floor of 4 × 4 m below a roof at a height of 3 m, with nothing between.
const HALL: &str = "mtllib hall.mtl\nusemtl grey
v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nf 1 2 3 4
v -2 3 -2\nv 2 3 -2\nv 2 3 2\nv -2 3 2\nf 5 6 7 8\n";
const CAMERA: &str = r#"{"camera": {"eye": [0, 1.8, 3.9], "target": [0, 0, 0], "up": [0, 1, 0], "hfov_deg": 60}}"#;

type Window = Harness<'static, App>;

/// The hall with this reflectance, under this sky.
fn hall(reflectance: f32, sky: Option<&str>) -> (tempfile::TempDir, Window) {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a writable folder");
    write("hall.obj", HALL);
    write("hall.mtl", &format!("newmtl grey\nKd {reflectance} {reflectance} {reflectance}\n"));
    write("hall.selflink.json", CAMERA);
    let sky = sky.map(|sky| sky.parse().expect("a sky"));
    let light = AddedLight { daylight: Daylight { sky, sun: None }, ..AddedLight::default() };
    let source = Source::File(folder.path().join("hall.obj"));
    let mut window = window_with(Some((source, Reading::default(), light)), coarse());
    until(&mut window, "the hall", |window| window.state().scene_info().is_some());
    (folder, window)
}

fn daylight(window: &Window) -> Daylight {
    window.state().scene_info().map(|info| info.scene.daylight()).unwrap_or_default()
}

/// Truth: the scene that the worker tells of; and the picture, which is no longer black.
#[test]
fn daylight_is_let_in_changed_and_taken_back() {
    let (_folder, mut window) = hall(0.5, None);
    let dark = picture(&mut window);
    click(&mut window, words::LET_DAYLIGHT_IN);
    until(&mut window, "an overcast sky", |window| {
        daylight(window).sky.is_some_and(|sky| sky.to_string() == "overcast:10000lx")
    });
    finish(&mut window);
    assert!(share_of_different_pixels(&dark, &picture(&mut window)) > 0.3, "it is light");
    let overcast = daylight(&window);

    click(&mut window, words::CLEAR_SKY);
    until(&mut window, "a sun", |window| daylight(window).sun.is_some());
    let angles = |window: &Window| daylight(window).sun.map(|sun| sun.angles()).unwrap_or_default();
    window.get_by_label(words::SKY_PLAN).scroll_to_me();
    window.run_steps(6);
    let plan = window.get_by_label(words::SKY_PLAN).rect();
    // A quarter of the side from the middle to the east.
    let place = plan.center() + egui::vec2(0.25 * plan.width(), 0.0);
    window.drag_at(place);
    window.drop_at(place);
    until(&mut window, "the sun in the east", |window| angles(window)[0] == 90.0);
    assert!((20.0..70.0).contains(&angles(&window)[1]), "half way up: {}", angles(&window)[1]);

    choose(&mut window, words::SUN_PLACE, words::SUN_BY_DATE);
    until(&mut window, "a date", |window| {
        daylight(window).sun.is_some_and(|sun| matches!(sun.place, SunPlace::Almanac { .. }))
    });
    // Truth: at midsummer's noon by the clock the sun stands in the south-east of Munich, 60° high
    // or more.
    let [azimuth, elevation] = angles(&window);
    assert!((130.0..180.0).contains(&azimuth) && (58.0..65.5).contains(&elevation), "{azimuth} {elevation}");
    window.get_by_role_and_label(Role::Slider, words::TIME).set_value_accesskit(0.0);
    window.run_steps(3);
    until(&mut window, "midnight", |window| angles(window)[1] < 0.0);
    assert!(window.query_by_label(words::SUN_IS_DOWN).is_some());

    for step in 0..4 {
        let before = daylight(&window);
        click(&mut window, words::UNDO);
        until(&mut window, &format!("step {step} taken back"), |window| daylight(window) != before);
    }
    assert_eq!(daylight(&window), overcast);
    click(&mut window, words::NO_DAYLIGHT);
    until(&mut window, "night", |window| daylight(window).is_empty());
}

/// Truth: under a uniform sky a point of the black floor gets all of what open ground gets but the
/// roof's form factor. 5 %, as the gather's target error.
#[test]
fn the_daylight_factor_is_shown_where_the_sky_alone_shines() {
    let (_folder, mut window) = hall(0.0, Some("uniform:8000lx"));
    finish(&mut window);
    choose(&mut window, words::DISPLAY, words::DAYLIGHT_FACTOR);
    assert!(window.query_by_label("daylight factor D, %").is_some(), "a legend says what is shown");
    assert!(window.query_by_label(words::UNIT).is_none(), "a share has no unit to choose");
    let centre = window.state().view_rect().center();
    window.hover_at(centre);
    until(&mut window, "a reading", |window| window.query_by_label_contains(" lx, ").is_some());
    let said = window.get_by_label_contains(" lx, ").accesskit_node().value().unwrap_or_default();
    let factor = said.strip_prefix("D ").and_then(|text| text.split_once(" %")).map(|(number, _)| number.parse());
    let found: f64 = factor.expect("a daylight factor").expect("a number");
    let roof = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]].map(|[x, z]| DVec3::new(x, 3.0, z));
    let truth = 100.0 * (1.0 - point_to_polygon(DVec3::ZERO, DVec3::Y, &roof));
    assert!((found / truth - 1.0).abs() < 0.05, "{said}: {truth}");

    // A locked range is one in percent, and stays so when the sky gets brighter.
    click(&mut window, words::LOCK_RANGE);
    let high = |window: &Window| window.get_by_label("Range to").accesskit_node().value().unwrap_or_default();
    let locked = high(&window);
    assert!(locked.ends_with('%'), "{locked}");
    click(&mut window, words::LIGHT);
    window.run_steps(6);
    window.get_by_role_and_label(Role::Slider, words::SKY_ILLUMINANCE).set_value_accesskit(16_000.0);
    until(&mut window, "a brighter sky", |window| {
        daylight(window).sky.is_some_and(|sky| sky.to_string() == "uniform:16000lx")
    });
    finish(&mut window);
    assert_eq!(high(&window), locked);

    // Beside a sun there is none, and the panel says why.
    let why = NoDaylightFactor::Sun.to_string().replacen("no", "No", 1) + ".";
    assert!(window.query_by_label(&why).is_none());
    click(&mut window, words::CLEAR_SKY);
    until(&mut window, "a sun", |window| daylight(window).sun.is_some());
    finish(&mut window);
    assert!(window.query_by_label(&why).is_some());
    assert!(window.query_by_label("daylight factor D, %").is_none());
    choose(&mut window, words::DISPLAY, words::LIT);
    window.get_by_role_and_label(Role::ComboBox, words::DISPLAY).click();
    window.run_steps(2);
    let choice = window.get_by_role_and_label(Role::Button, words::DAYLIGHT_FACTOR);
    assert!(choice.accesskit_node().is_disabled(), "it is not offered");
}
