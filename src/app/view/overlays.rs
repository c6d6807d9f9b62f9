//! Cards, legends and notes over the view: each finds a place that those before it have left free.

use egui::{Align2, Context, Frame, Margin, Pos2, Rect, Ui, Vec2};

use crate::app::widgets::theme;

/// Room between what lies over the view and the view's rims, points.
pub const MARGIN: f32 = 10.0;
/// Room between two overlays, points.
const GAP: f32 = 6.0;

/// Cards and legends over the view in this frame, by name.
#[derive(Default)]
pub struct Overlays {
    taken: Vec<(&'static str, Rect)>,
}

/// An overlay's name, the part of the view that it keeps to, and its anchor there.
#[derive(Clone, Copy)]
pub struct Place {
    pub name: &'static str,
    pub view: Rect,
    pub align: Align2,
    pub at: Pos2,
    /// Whether the pointer meets it.
    pub is_interactable: bool,
    /// Whether it is shown where it has no room too.
    pub is_needed: bool,
}

impl Place {
    /// In a corner or at the middle of a rim of the view, as `align` says.
    pub fn at_rim(name: &'static str, view: Rect, align: Align2) -> Self {
        let inner = view.shrink(MARGIN);
        Self { name, view, align, at: align.pos_in_rect(&inner), is_interactable: true, is_needed: true }
    }
}

impl Overlays {
    /// Nothing lies over the view yet.
    pub fn clear(&mut self) {
        self.taken.clear();
    }

    /// Names and rectangles, in the order in which they found their places.
    pub fn taken(&self) -> &[(&'static str, Rect)] {
        &self.taken
    }

    /// Notes what lies somewhere already.
    pub fn take(&mut self, name: &'static str, rect: Rect) {
        self.taken.push((name, rect));
    }

    /// The wanted rectangle, or the next free one towards the middle of the view: down from its
    /// upper half, up from its lower one. `None` where there is none in the view.
    pub fn free(&self, view: Rect, wanted: Rect) -> Option<Rect> {
        let goes_down = wanted.center().y < view.center().y;
        let mut rect = wanted;
        for _ in 0..=self.taken.len() {
            let is_in_the_way = |other: &&(_, Rect)| other.1.expand(GAP - 1.0).intersects(rect);
            let Some((_, other)) = self.taken.iter().find(is_in_the_way) else {
                return (rect == wanted || view.contains_rect(rect)).then_some(rect);
            };
            let by = if goes_down { other.bottom() + GAP - rect.top() } else { other.top() - GAP - rect.bottom() };
            rect = rect.translate(Vec2::new(0.0, by));
        }
        None
    }

    /// Draws a card with widgets.
    pub fn card(&mut self, ui: &Ui, place: Place, margin: impl Into<Margin>, add: impl FnOnce(&mut Ui)) {
        let frame = |ui: &Ui| Frame::popup(ui.style()).fill(theme::PANEL.gamma_multiply(0.94)).inner_margin(margin);
        self.show(ui.ctx(), place, |ui| {
            frame(ui).show(ui, add);
        });
    }

    /// Draws a few words, so opaque.
    pub fn note(&mut self, ui: &Ui, place: Place, opacity: f32, margin: [i8; 2], add: impl FnOnce(&mut Ui)) {
        let [x, y] = margin;
        let frame = Frame::new().fill(theme::PANEL.gamma_multiply(opacity)).corner_radius(4);
        self.show(ui.ctx(), place, |ui| {
            frame.inner_margin(Margin::symmetric(x, y)).show(ui, add);
        });
    }

    /// Draws widgets at a free place, if there is one or they are needed.
    fn show(&mut self, ctx: &Context, place: Place, add: impl FnOnce(&mut Ui)) {
        let id = egui::Id::unique(place.name);
        let known = ctx.memory(|memory| memory.area_rect(id)).map_or(Vec2::ZERO, |rect| rect.size());
        let anchored = place.align.anchor_size(place.at, known);
        let wanted = within(place.view, anchored);
        let Some(free) = self.free(place.view, wanted).or(place.is_needed.then_some(wanted)) else { return };
        let at = place.at + (free.min - anchored.min);
        let area = egui::Area::new(id).pivot(place.align).fixed_pos(at).interactable(place.is_interactable);
        let shown = area.constrain_to(place.view).show(ctx, |ui| {
            theme::over_the_view(ui);
            add(ui);
        });
        let rect = shown.response.rect;
        if (rect.size() - known).abs().max_elem() > 0.5 {
            // Its place is found by its size, which is known only now.
            ctx.request_repaint();
        }
        self.take(place.name, rect);
    }
}

/// A rectangle moved into the view, its upper left corner first.
fn within(view: Rect, rect: Rect) -> Rect {
    let by = (view.max - rect.max).min(Vec2::ZERO);
    let rect = rect.translate(by);
    rect.translate((view.min - rect.min).max(Vec2::ZERO))
}

#[cfg(test)]
mod tests {
    use egui::{pos2, vec2};

    use super::*;

    /// Truth: rectangles by hand.
    #[test]
    fn overlays_give_way_towards_the_middle() {
        let view = Rect::from_min_size(Pos2::ZERO, vec2(500.0, 400.0));
        let mut overlays = Overlays::default();
        let card = |x: f32, y: f32| Rect::from_min_size(pos2(x, y), vec2(300.0, 40.0));
        assert_eq!(overlays.free(view, card(10.0, 10.0)), Some(card(10.0, 10.0)));
        overlays.take("one", card(10.0, 10.0));
        overlays.take("two", card(10.0, 350.0));
        assert_eq!(overlays.free(view, card(190.0, 10.0)), Some(card(190.0, 50.0 + GAP)));
        assert_eq!(overlays.free(view, card(190.0, 350.0)), Some(card(190.0, 350.0 - 40.0 - GAP)));
        assert_eq!(overlays.free(view, card(320.0, 10.0)), Some(card(320.0, 10.0)));
        overlays.take("three", Rect::from_min_size(pos2(0.0, 50.0), vec2(500.0, 290.0)));
        assert_eq!(overlays.free(view, card(190.0, 10.0)), None, "there is no room left");
    }
}
