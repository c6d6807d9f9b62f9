//! The gathered picture of the view: it comes when the camera stands still, goes when anything moves, and can be switched off.
//!
//! Truth: what the window says that it shows, and pictures that differ, or do not, where they must.

use egui::Key;
use selflink::solver::SolverParams;

use crate::support::{choose, cornell, finish, picture, share_of_different_pixels, until};

#[test]
fn a_picture_is_gathered_while_the_camera_stands_still() {
    let mut window = cornell(SolverParams { error: Some(0.1), ..SolverParams::default() });
    finish(&mut window);
    until(&mut window, "a settled picture", |window| window.state().is_gathered() == (true, true));
    let gathered = picture(&mut window);

    // Nothing that moves may show what was gathered for another view.
    let begun = window.state().camera_pose();
    window.remove_cursor();
    let middle = window.state().view_rect().center();
    window.hover_at(middle);
    window.step();
    window.key_press(Key::F);
    window.step();
    window.step();
    assert!(window.state().camera_pose() != begun, "the key moves the camera");
    until(&mut window, "another picture", |window| window.state().is_gathered() == (true, true));
    window.key_press(Key::Home);
    window.step();
    window.step();
    until(&mut window, "the first view again", |window| window.state().is_gathered() == (true, true));
    assert_eq!(share_of_different_pixels(&gathered, &picture(&mut window)), 0.0, "the same view has the same picture");

    choose(&mut window, "Picture", "mesh");
    assert_eq!(window.state().is_gathered(), (false, false));
    let mesh = picture(&mut window);
    assert!(share_of_different_pixels(&gathered, &mesh) > 0.1);
    let mean = |picture: &image::RgbaImage| {
        picture.as_raw().iter().map(|channel| f64::from(*channel)).sum::<f64>() / picture.as_raw().len() as f64
    };
    assert!((mean(&gathered) - mean(&mesh)).abs() < 3.0, "nothing jumps: {} {}", mean(&gathered), mean(&mesh));
    choose(&mut window, "Picture", "gathered");
    until(&mut window, "the gathered picture", |window| window.state().is_gathered() == (true, true));
    assert_eq!(share_of_different_pixels(&gathered, &picture(&mut window)), 0.0);
}
