//! A horizontal bar of colours, as legends show it.

use egui::{Color32, Mesh, Rect, Shape, pos2};

/// Steps of the colours.
const STEPS: usize = 88;

/// The bar; `colour` is asked from 0 at the left to 1 at the right, gamma-encoded.
pub fn shape(bar: Rect, colour: impl Fn(f32) -> [u8; 3]) -> Shape {
    let mut mesh = Mesh::default();
    for step in 0..=STEPS {
        let along = step as f32 / STEPS as f32;
        let [r, g, b] = colour(along);
        let (x, colour) = (bar.left() + along * bar.width(), Color32::from_rgb(r, g, b));
        mesh.colored_vertex(pos2(x, bar.top()), colour);
        mesh.colored_vertex(pos2(x, bar.bottom()), colour);
        if step > 0 {
            let last = 2 * step as u32;
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    Shape::mesh(mesh)
}
