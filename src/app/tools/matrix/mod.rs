//! The link matrix: all links as blocks, receivers by sources.
//!
//! The picture is drawn on a thread ([`artist`]); here are the switches, the square with
//! what is pointed at in it ([`square`]), the names along its edges ([`edges`]) and what its
//! colours mean ([`key`]).

mod artist;
mod edges;
mod key;
mod square;
mod tip;

use std::sync::Arc;

use egui::{ColorImage, Context, TextureHandle, TextureOptions, Ui, Vec2, vec2};

use crate::app::actions::{Action, Outbox};
use crate::app::state::messages::Topic;
use crate::app::state::names::NamesInView;
use crate::app::view::highlight::Pointing;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, Wake};
use crate::hierarchy::{ElementId, Room};
use crate::read::matrix::{Colouring, Facts, Legend, Palette, Raster, Request, View};
use crate::read::names::Names;
use crate::solve::Snapshot;
use crate::transport::SolutionView;
use artist::{Artist, Drawn, Order};

/// Colourings with their names and hints, in the order of their switches.
const COLOURINGS: [(Colouring, &str, &str); 4] = [
    (Colouring::Power, "power", "Power that a link carries for each area of both its ends"),
    (
        Colouring::Visibility,
        "visibility",
        "Whether the ends of a link are fully or partly visible to each other, or hidden",
    ),
    (Colouring::Level, "level", "How often the root's self-link was refined until it became this link"),
    (Colouring::Rays, "rays", "How many rays a link's visibility is known by"),
];
/// Measures by which elements get room, with label and hint.
const ROOMS: [(Room, &str, &str); 3] = [
    (Room::Area, "area", "Rows and columns as large as their elements: shows where power can go"),
    (Room::Polygons, "polygons", "Rows and columns of equal size for all polygons: shows small things"),
    (Room::Leaves, "leaves", "Rows and columns of equal size for all leaf patches: shows what was refined most"),
];

/// The square is no smaller than this, points.
const LEAST_SIDE: f32 = 140.0;
/// Room below the square for what its colours mean, points.
const ROOM_BELOW: f32 = 100.0;
/// Room beside it, where the dock is wide, points.
const ROOM_BESIDE: f32 = 214.0;

/// The tool's state.
pub struct LinkMatrix {
    room: Room,
    colouring: Colouring,
    view: View,
    artist: Artist,
    shown: Option<Drawing>,
    /// A coarse picture of the whole square.
    whole: Option<(Look, TextureHandle)>,
    generation: u64,
}

/// State that a picture was made of, but for the part of the square.
#[derive(Clone, Copy, PartialEq)]
struct Look {
    /// Generation, serial and former step of the snapshot.
    state: (u64, u64, Option<usize>),
    room: Room,
    colouring: Colouring,
}

/// The last picture.
struct Drawing {
    look: Look,
    request: Request,
    texture: TextureHandle,
    facts: Facts,
    palette: Arc<Palette>,
    legend: Legend,
}

/// State that the parts of the tool look at in a frame.
#[derive(Clone, Copy)]
struct Looked<'a> {
    solution_view: &'a Arc<SolutionView>,
    names: &'a Names,
    picked: Option<ElementId>,
}

impl Default for LinkMatrix {
    fn default() -> Self {
        Self {
            room: Room::default(),
            colouring: Colouring::default(),
            view: View::WHOLE,
            artist: Artist::default(),
            shown: None,
            whole: None,
            generation: 0,
        }
    }
}

/// Draws the tool.
pub fn show(
    ui: &mut Ui,
    shown: &Shown,
    matrix: &mut LinkMatrix,
    names: &NamesInView,
    pointing: &mut Pointing,
    wake: &Wake,
    outbox: &mut Outbox,
) {
    let Some(snapshot) = &shown.snapshot else {
        ui.label(theme::weak("Open a scene to see its links."));
        return;
    };
    matrix.show_switches(ui);
    let Some(solution_view) = &snapshot.solution_view else {
        ui.label(theme::weak("Asking for the links…"));
        return;
    };
    if let Some(names) = names.names() {
        let looked = Looked { solution_view, names, picked: shown.picked_element() };
        matrix.show(ui, snapshot, looked, pointing, wake, outbox);
    }
}

impl LinkMatrix {
    fn show_switches(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label(theme::weak("Colour by"));
            rows::alternatives(ui, &mut self.colouring, &COLOURINGS);
        });
        ui.horizontal(|ui| {
            ui.label(theme::weak("Row height by"));
            rows::alternatives(ui, &mut self.room, &ROOMS);
        });
    }

    fn show(
        &mut self,
        ui: &mut Ui,
        snapshot: &Snapshot,
        looked: Looked<'_>,
        pointing: &mut Pointing,
        wake: &Wake,
        outbox: &mut Outbox,
    ) {
        if self.generation != snapshot.generation {
            self.generation = snapshot.generation;
            self.view = View::WHOLE;
        }
        let room = ui.available_size();
        let side = |reserved: Vec2| (room - reserved - edges::WIDTH).min_elem();
        let (below, beside) = (side(vec2(0.0, ROOM_BELOW)), side(vec2(ROOM_BESIDE, 0.0)));
        let is_wide = beside > below;
        let side = below.max(beside).max(LEAST_SIDE);
        let state = (snapshot.generation, snapshot.serial, snapshot.former_step);
        let look = Look { state, room: self.room, colouring: self.colouring };
        let layout = if is_wide { egui::Layout::left_to_right(egui::Align::Min) } else { *ui.layout() };
        ui.with_layout(layout, |ui| {
            let square = square::show(self, ui, looked, side, pointing, outbox);
            let pixels = (square.width() * ui.ctx().pixels_per_point()).round().max(1.0) as usize;
            self.keep_up(ui.ctx(), look, looked.solution_view, pixels, wake, outbox);
            ui.vertical(|ui| self.show_key(ui));
        });
    }

    /// Takes up a picture that is there, and orders the next one where something changed.
    fn keep_up(
        &mut self,
        ctx: &Context,
        look: Look,
        solution_view: &Arc<SolutionView>,
        pixels: usize,
        wake: &Wake,
        outbox: &mut Outbox,
    ) {
        if let Some(drawn) = self.artist.take() {
            self.take_up(ctx, drawn);
        }
        let request = Request { room: self.room, view: self.view, pixels, has_gaps: true };
        if self.shown.as_ref().is_some_and(|shown| shown.look == look && shown.request == request) {
            return;
        }
        if !self.artist.is_free() {
            return;
        }
        let wants_whole = !self.view.is_whole() && self.whole.as_ref().is_none_or(|(whole, _)| *whole != look);
        let of_look = self.shown.as_ref().filter(|shown| shown.look == look);
        let known = of_look.map(|shown| (shown.facts, shown.palette.clone()));
        let order = Order { look, solution_view: solution_view.clone(), request, wants_whole, known };
        if let Err(error) = self.artist.order(order, wake.clone()) {
            let failed = format!("The link matrix cannot be drawn, no thread is left ({error}).");
            outbox.act(Action::Fail(Topic::Drawing, failed));
        }
    }

    fn take_up(&mut self, ctx: &Context, drawn: Drawn) {
        let Drawn { look, request, raster, whole, facts, palette } = drawn;
        let legend = palette.legend();
        let texture = texture(ctx, &raster);
        if request.view.is_whole() {
            self.whole = Some((look, texture.clone()));
        } else if let Some(whole) = whole {
            self.whole = Some((look, self::texture(ctx, &whole)));
        }
        self.shown = Some(Drawing { look, request, texture, facts, palette, legend });
    }
}

fn texture(ctx: &Context, raster: &Raster) -> TextureHandle {
    let image = ColorImage::from_rgb([raster.size; 2], raster.pixels.as_flattened());
    ctx.load_texture("link matrix", image, TextureOptions::LINEAR)
}
