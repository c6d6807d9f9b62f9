//! The window under strain: sizes that no person would choose, and a graphics device that goes
//! away.
//!
//! Truth: the program goes on, and shows the same picture as before once it can.

use egui::Vec2;
use egui_kittest::Harness;
use selflink::app::App;
use selflink::prepare::added_light::AddedLight;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Reading, Source};

use crate::support::{coarse, cornell, finish, picture, share_of_different_pixels, until};

#[test]
fn a_window_of_any_size_goes_on() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let before = picture(&mut window);
    for size in [[0.0, 0.0], [1.0, 1.0], [1.0, 800.0], [1280.0, 1.0], [300.0, 40.0]] {
        window.set_size(Vec2::from(size));
        window.run_steps(2);
        if size[0] >= 1.0 && size[1] >= 1.0 {
            window.render().expect("a frame can be drawn");
        }
    }
    // Wider than a device may draw: nothing is drawn here, but asked for.
    window.set_size(Vec2::new(40_000.0, 800.0));
    window.run_steps(2);
    window.set_size(Vec2::new(1280.0, 800.0));
    window.run_steps(4);
    let after = picture(&mut window);
    let different = share_of_different_pixels(&before, &after);
    assert!(different < 0.02, "{different} of the picture differs");
}

#[test]
fn a_lost_device_is_noticed() {
    let mut device = None;
    let opening = Some((Source::Builtin(BuiltinScene::Cornell), Reading::default(), AddedLight::default()));
    let mut window: Harness<'static, App> = Harness::builder().with_size([1280.0, 800.0]).wgpu().build_eframe(|cc| {
        device = cc.wgpu_render_state.as_ref().map(|state| state.device.clone());
        App::new(cc, opening, coarse()).expect("a wgpu device and a thread are there")
    });
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    assert_eq!(window.state().lost_device(), None);
    let device = device.expect("the window draws with a device");
    device.destroy();
    // Whoever asks the device for anything is reported.
    let _ = device.poll(egui_wgpu::wgpu::PollType::Poll);
    until(&mut window, "the loss being noticed", |window| window.state().lost_device().is_some());
    let asked: Vec<_> =
        window.output().viewport_output.values().flat_map(|viewport| viewport.commands.clone()).collect();
    assert!(asked.contains(&egui::ViewportCommand::Close), "it makes room for another window: {asked:?}");
}
