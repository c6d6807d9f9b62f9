//! What can be taken along: files that hold what the window shows, and the session that the next
//! start goes on with.

use std::collections::HashMap;
use std::path::Path;

use eframe::{App as _, Storage as _};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use selflink::app::{App, words};
use selflink::export::peers::Peer;
use selflink::export::settings::Settings;
use selflink::scene::load_file;
use selflink::solve::{Epsilon, ParameterId, SolverParams};

use crate::support::{click, coarse, cornell, finish, picture, share_of_different_pixels, until};

/// Types a name for all files and returns it without an ending.
fn name_files(window: &mut Harness<'static, App>, folder: &Path) -> String {
    click(window, words::EXPORT);
    let name = folder.join("lit").to_string_lossy().into_owned();
    let field = window.get_by_label("Name of the files");
    field.focus();
    window.run_steps(1);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_by_label("Name of the files").type_text(&name);
    window.run_steps(2);
    name
}

fn save(window: &mut Harness<'static, App>, button: &str, path: &str) {
    click(window, button);
    until(window, path, |window| window.query_by_label_contains(&format!("Saved {path}")).is_some());
}

/// Truth: the snapshot in view, by readers of other crates and our own loader.
#[test]
fn files_hold_what_the_window_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = cornell(coarse());
    finish(&mut window);
    let name = name_files(&mut window, folder.path());
    for (button, ending) in [
        ("Radiosities (EXR)", "exr"),
        ("Mesh (GLB)", "glb"),
        ("Mesh (PLY)", "ply"),
        ("Links (CSV)", "links.csv"),
        ("Settings (JSON)", "settings.json"),
        ("Statistics (JSON)", "statistics.json"),
    ] {
        save(&mut window, button, &format!("{name}.{ending}"));
    }
    // The scene for other programs: a folder each, asked for by the names that a screen reader
    // says.
    for (button, ending) in [("Scene (Mitsuba 3)", "mitsuba"), ("Scene (Radiance)", "radiance")] {
        window.get_by_role_and_label(Role::Button, button).scroll_to_me();
        window.run_steps(2);
        save(&mut window, button, &format!("{name}.{ending}"));
    }
    let written = |file: &str| std::fs::read_to_string(format!("{name}.{file}")).expect(file);
    // Both as the command line writes them, which tests/cli/export.rs reads face by face.
    for (peer, files) in [(Peer::Mitsuba, ["scene.xml", "check.py"]), (Peer::Radiance, ["scene.rad", "view.vf"])] {
        let other = folder.path().join("command-line");
        let scene = window.state().scene_info().expect("a scene").scene.clone();
        peer.write(&scene, &other).expect("a writable folder");
        for file in files {
            let truth = std::fs::read_to_string(other.join(file)).expect(file);
            assert!(written(&format!("{}/{file}", peer.name())) == truth && !truth.is_empty(), "{file}");
        }
    }
    // The sentence of the last file has made room for itself by now.
    let shown = picture(&mut window);
    save(&mut window, "Picture (PNG)", &format!("{name}.png"));
    let snapshot = window.state().snapshot().expect("a picture").clone();
    let png = image::open(format!("{name}.png")).expect("a picture").to_rgba8();
    // The view may end within a pixel.
    assert!(png.width().abs_diff(shown.width()) <= 1 && png.height().abs_diff(shown.height()) <= 1);
    let png = image::imageops::crop_imm(&png, 0, 0, shown.width(), shown.height()).to_image();
    // The window draws with one sample a pixel on software adapters: edges differ, surfaces do not.
    let apart =
        |(one, other): (&image::Rgba<u8>, &image::Rgba<u8>)| one.0.iter().zip(other.0).any(|(a, b)| a.abs_diff(b) > 3);
    let different = png.pixels().zip(shown.pixels()).filter(|pair| apart(*pair)).count() as f64;
    assert!(different / f64::from(png.width() * png.height()) < 0.03, "{different} pixels differ");

    let exr = exr::prelude::read_first_rgba_layer_from_file(
        format!("{name}.exr"),
        |size, _| (size.width(), vec![[0.0_f32; 4]; size.area()]),
        |(width, pixels): &mut (usize, Vec<[f32; 4]>), at, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b, a];
        },
    );
    let (width, pixels) = exr.expect("a valid file").layer_data.channel_data.pixels;
    assert_eq!(pixels.len() % width, 0);
    let brightest = snapshot.vertex_radiosity.iter().flatten().copied().fold(0.0, f32::max);
    let most = pixels.iter().flat_map(|pixel| &pixel[..3]).copied().fold(0.0, f32::max);
    assert!(most <= brightest * 1.0001 && most > 0.9 * brightest, "the lamp is in view: {most} of {brightest} W/m²");

    let scene = load_file(Path::new(&format!("{name}.glb"))).expect("our own loader opens it");
    assert_eq!(scene.polygons.len(), snapshot.mesh.triangles.len());
    let links = std::fs::read_to_string(format!("{name}.links.csv")).expect("links");
    assert_eq!(links.lines().count(), 1 + snapshot.stats.links);
    for ending in ["settings.json", "statistics.json"] {
        let settings = Settings::read(Path::new(&format!("{name}.{ending}"))).expect("settings");
        assert_eq!((settings.scene.as_deref(), settings.solver), (Some("cornell"), coarse()));
        assert!(settings.camera.is_some());
    }
}

/// Truth: letters are white with a dark rim, where the window has them too.
#[test]
fn an_exported_picture_has_the_values_along_its_isolux_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = cornell(SolverParams { error: Some(0.1), ..SolverParams::usual() });
    finish(&mut window);
    click(&mut window, words::ISOLUX_LINES);
    let name = name_files(&mut window, folder.path());
    until(&mut window, "values", |window| {
        window.state().is_gathered() == (true, true) && window.query_all_by_label_contains("Line at ").next().is_some()
    });
    save(&mut window, "Picture (PNG)", &format!("{name}.png"));
    until(&mut window, "the whole picture", |window| window.state().is_gathered() == (true, true));
    window.run_steps(2);
    let png = image::open(format!("{name}.png")).expect("a picture").to_rgba8();
    // The sentence on the file may have taken room from the view meanwhile: its lower end stays.
    let view = window.state().view_rect();
    let origin = egui::pos2(view.left(), view.bottom() - png.height() as f32);
    let labels: Vec<egui::Rect> = window.query_all_by_label_contains("Line at ").map(|node| node.rect()).collect();
    let is_written = |rect: &&egui::Rect| {
        let at = rect.center() - origin;
        let around = |reach: f32, of: f32| (of - reach).max(0.0) as u32..(of + reach).max(0.0) as u32;
        let pixels = around(10.0, at.y).flat_map(|y| around(14.0, at.x).map(move |x| (x, y)));
        let inside = pixels.filter_map(|(x, y)| png.get_pixel_checked(x, y).map(|pixel| pixel.0));
        let (mut dark, mut white) = (0, 0);
        for [r, g, b, _] in inside {
            dark += usize::from(r.max(g).max(b) < 70);
            white += usize::from(r.min(g).min(b) > 225);
        }
        dark >= 8 && white >= 5
    };
    let written = labels.iter().filter(is_written).count();
    // The file is gathered anew: where its lines run a little differently, its values stand
    // elsewhere.
    assert!(4 * written >= labels.len(), "{written} of {} values are in the file", labels.len());
}

/// Truth: the file. What is there already is overwritten only if a person says so, and what cannot
/// be written is said.
#[test]
fn files_are_not_lost_by_accident() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = cornell(coarse());
    finish(&mut window);
    let name = name_files(&mut window, folder.path());
    let path = format!("{name}.settings.json");
    std::fs::write(&path, "mine").expect("a writable folder");
    click(&mut window, "Settings (JSON)");
    assert!(window.query_by_label("lit.settings.json already exists.").is_some());
    click(&mut window, "Keep it");
    assert_eq!(std::fs::read_to_string(&path).expect("the file"), "mine");
    save_over(&mut window, &path);
    assert!(Settings::read(Path::new(&path)).is_ok());
    drop(folder);
    click(&mut window, "Mesh (PLY)");
    until(&mut window, "the sentence", |window| window.query_by_label_contains("cannot be written").is_some());
}

fn save_over(window: &mut Harness<'static, App>, path: &str) {
    click(window, "Settings (JSON)");
    click(window, "Overwrite it");
    until(window, path, |window| window.query_by_label_contains(&format!("Saved {path}")).is_some());
}

/// A storage in place of a person's own.
#[derive(Default)]
struct MemoryStorage(HashMap<String, String>);

impl eframe::Storage for MemoryStorage {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

fn resumed(storage: MemoryStorage) -> Harness<'static, App> {
    // A window of the tests lives as long as the program.
    let storage: &'static MemoryStorage = Box::leak(Box::new(storage));
    let fallback = Settings { scene: Some("cornell".into()), solver: coarse(), ..Settings::default() };
    Harness::builder().with_size([1280.0, 800.0]).wgpu().build_eframe(|cc| {
        cc.storage = Some(storage);
        App::resume(cc, &fallback).expect("a wgpu device and a thread are there")
    })
}

/// Truth: the picture before the end. Scene, parameters, view and tool are there again.
#[test]
fn the_next_start_goes_on_where_the_last_ended() {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::COMPARE);
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(5e-3);
    until(&mut window, "a finer ε", |window| window.state().status().params.epsilon == Epsilon::Relative(5e-3));
    // A solution that was refined on its way differs from one that starts with this ε.
    let generation = window.state().snapshot().expect("a picture").generation;
    click(&mut window, "Restart");
    until(&mut window, "a fresh solve", |window| {
        window.state().snapshot().is_some_and(|shown| shown.generation > generation)
    });
    finish(&mut window);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.step();
    window.hover_at(centre + egui::vec2(90.0, 30.0));
    window.step();
    window.drop_at(centre + egui::vec2(90.0, 30.0));
    window.step();
    let before = picture(&mut window);
    let mut storage = MemoryStorage::default();
    window.state_mut().save(&mut storage);

    let mut again = resumed(storage);
    let is_whole =
        |window: &Harness<'static, App>| window.state().snapshot().is_some_and(|snapshot| snapshot.stats.converged);
    until(&mut again, "the whole picture", is_whole);
    finish(&mut again);
    assert_eq!(again.state().status().params.epsilon, Epsilon::Relative(5e-3));
    assert!(again.query_by_label(words::KEEP_AS_A).is_some(), "the tool is open");
    assert!(again.query_by_label("Got it").is_none(), "it is not the first start");
    assert!(share_of_different_pixels(&before, &picture(&mut again)) < 1e-3);
}

#[test]
fn a_scene_that_is_gone_is_said_and_replaced() {
    let settings = Settings {
        scene: Some("/no/such/room.obj".into()),
        solver: SolverParams { rays_min: 0, ..coarse() },
        ..Settings::default()
    };
    // As the window writes it; what it lacks is as it is by default.
    #[derive(serde::Serialize)]
    struct Session {
        settings: Settings,
    }
    let mut storage = MemoryStorage::default();
    eframe::set_value(&mut storage, "session", &Session { settings });
    let mut window = resumed(storage);
    until(&mut window, "the default scene", |window| window.state().snapshot().is_some());
    assert_eq!(window.state().scene_info().expect("a scene").scene.name, "cornell");
    assert!(window.query_by_label_contains("/no/such/room.obj, is gone").is_some());
    assert_eq!(window.state().status().params, coarse(), "parameters that cannot be used are not kept");
}

/// Truth: a session as versions wrote it that could refine by link error; all else of it is kept.
#[test]
fn a_former_criterion_of_refinement_is_said() {
    let mut storage = MemoryStorage::default();
    let solver = "(error: None, epsilon: relative(5e-3), oracle: error)";
    storage.set_string("session", format!(r#"(settings: (scene: Some("cornell"), solver: {solver}))"#));
    let mut window = resumed(storage);
    until(&mut window, "the scene", |window| window.state().snapshot().is_some());
    assert!(window.query_by_label_contains("refinement by link error is gone").is_some());
    assert_eq!(window.state().status().params, SolverParams { epsilon: Epsilon::Relative(5e-3), ..coarse() });
}

#[test]
fn the_first_start_says_three_lines_once() {
    let mut window = resumed(MemoryStorage::default());
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    assert!(window.query_by_label_contains("Press ? for all keys").is_some());
    click(&mut window, "Got it");
    assert!(window.query_by_label("Got it").is_none());
    let mut storage = MemoryStorage::default();
    window.state_mut().save(&mut storage);
    let mut again = resumed(storage);
    until(&mut again, "the first picture", |window| window.state().snapshot().is_some());
    assert!(again.query_by_label("Got it").is_none());
}
