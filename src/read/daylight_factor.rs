//! The daylight factor: illuminance over that of open horizontal ground under the same sky (EN
//! 17037). It is known where the sky alone shines: by convention the sun does not count, and of the
//! light of lamps nothing tells it apart.

use crate::base::photometry::weighted;
use crate::scene::Scene;

/// Why a scene has no daylight factor, and what would give it one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoDaylightFactor {
    /// Nothing, or the sun alone, shines from outside.
    #[error(
        "no daylight factor: it compares with the light of a sky, and none shines (let one in, such as an overcast one)"
    )]
    NoSky,
    /// The sun shines beside the sky.
    #[error("no daylight factor: it is that of the sky alone, and the sun shines too (leave the sun out)")]
    Sun,
    /// Lamps shine beside the sky.
    #[error(
        "no daylight factor: it is that of the sky alone, and lamps shine too (switch them off, as --lamps-off does)"
    )]
    Lamps,
}

/// Irradiance of open horizontal ground, W/m², weighted as the eye does, where the sky alone
/// shines.
///
/// # Errors
/// No sky shines, or something else does.
pub fn open_ground(scene: &Scene) -> Result<f32, NoDaylightFactor> {
    let outside = scene.outside().ok_or(NoDaylightFactor::NoSky)?;
    let [sky, _] = outside.horizontal_irradiance();
    let open = weighted(sky.into());
    if open.is_nan() || open <= 0.0 {
        Err(NoDaylightFactor::NoSky)
    } else if outside.sun().is_some() {
        Err(NoDaylightFactor::Sun)
    } else if scene.has_lamp() {
        Err(NoDaylightFactor::Lamps)
    } else {
        Ok(open)
    }
}
