//! A scene made ready to be lit: read, with what light a person adds, its faces turned, and a place
//! to look from.

pub mod added_light;
pub mod ceiling;
mod outdoors;
pub mod start_view;

use std::time::Instant;

use crate::geometry::{Occluders, orient};
use crate::prepare::added_light::AddedLight;
use crate::scene::outside::DaylightError;
use crate::scene::{self, EditError, LoadError, Reading, Scene, Sides, Source};

/// Why a scene cannot be made ready.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// It cannot be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The light cannot be added.
    #[error(transparent)]
    Light(#[from] EditError),
    /// The daylight cannot be used.
    #[error(transparent)]
    Daylight(#[from] DaylightError),
}

/// A scene that is ready to be lit.
pub struct Ready {
    /// As its file says, before faces were turned or doubled.
    pub raw: Scene,
    /// As it is lit.
    pub scene: Scene,
    /// Occluders of the scene as it is lit.
    pub occluders: Occluders,
}

/// Reads a scene and makes it ready; `sides` are those that a person asks for.
///
/// # Errors
/// It cannot be loaded, or the light not be added.
pub fn prepare(
    source: &Source,
    reading: &Reading,
    light: &AddedLight,
    sides: Option<Sides>,
) -> Result<Ready, PrepareError> {
    let begun = Instant::now();
    let mut raw = scene::load_with(source, reading)?;
    tracing::info!(?source, polygons = raw.polygons.len(), seconds = begun.elapsed().as_secs_f64(), "scene read");
    light.set_luminaires_of(&mut raw)?;
    light.add_emission_to(&mut raw)?;
    light.add_daylight_to(&mut raw)?;
    let (mut scene, mut occluders) = orient::apply(raw.clone(), sides.unwrap_or(raw.sides));
    let is_filed = matches!(source, Source::File(_));
    let is_free = sides.is_none() && !raw.frame.sides_are_told && scene.sides == Sides::Front;
    if is_filed && is_free && orient::shows_backs(&scene, &occluders) {
        raw.sides = Sides::Auto;
        raw.skipped
            .note("Its faces turn their backs to the inside; they were turned round (--sides front leaves them).");
        (scene, occluders) = orient::apply(raw.clone(), Sides::Auto);
    }
    if is_filed && raw.camera.is_none() {
        raw.camera = start_view::find(&scene, &occluders);
        scene.camera = raw.camera;
    }
    if light.ceiling.is_some() {
        // In the room that one stands in.
        let of_raw = Occluders::new(&raw);
        light.add_ceiling_to(&mut raw, &of_raw)?;
        (scene, occluders) = orient::apply(raw.clone(), sides.unwrap_or(raw.sides));
    }
    let (polygons, sides) = (scene.polygons.len(), scene.sides);
    tracing::info!(polygons, ?sides, seconds = begun.elapsed().as_secs_f64(), "scene prepared");
    Ok(Ready { raw, scene, occluders })
}
