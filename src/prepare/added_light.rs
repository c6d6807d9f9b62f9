//! Light that a person adds to a scene that is read: most downloads have none.

use glam::Vec3;

use serde::{Deserialize, Serialize};

use crate::geometry::Occluders;
use crate::prepare::ceiling;
use crate::scene::outside::{Daylight, DaylightError};
use crate::scene::{EditError, FiledLuminaire, Luminaire, Scene};

/// Light that is added; by default none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AddedLight {
    /// Whether the lamps of the scene's file are off.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub lamps_off: bool,
    /// Materials that emit: name and exitance B_e, W/m².
    pub emitting: Vec<(String, Vec3)>,
    /// Luminaires in place of those that the scene's sidecar adds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luminaires: Option<Vec<FiledLuminaire>>,
    /// A lamp under the ceiling.
    pub ceiling: Option<CeilingLight>,
    /// Sky and sun.
    #[serde(skip_serializing_if = "Daylight::is_empty")]
    pub daylight: Daylight,
}

/// A square lamp under the ceiling, as far as it was described.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CeilingLight {
    /// Side, in the scene's length unit; `None` as suits the room.
    pub size: Option<f32>,
    /// Exitance B_e, W/m².
    pub exitance: f32,
}

impl AddedLight {
    /// Whether nothing is added.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Switches the lamps of a scene off, if they are to be off, and makes materials emit.
    ///
    /// # Errors
    /// A material that the scene does not have.
    pub fn add_emission_to(&self, scene: &mut Scene) -> Result<(), EditError> {
        if self.lamps_off {
            scene.materials.iter_mut().for_each(|material| material.emission = Vec3::ZERO);
        }
        self.emitting.iter().try_for_each(|(material, emission)| scene.set_emission(material, *emission))
    }

    /// Puts luminaires in place of those of a scene whose faces have not been turned or doubled, if
    /// there are any to be put.
    ///
    /// # Errors
    /// One that cannot be used.
    pub fn set_luminaires_of(&self, scene: &mut Scene) -> Result<(), EditError> {
        let Some(luminaires) = &self.luminaires else { return Ok(()) };
        let luminaires: Vec<Luminaire> = luminaires.iter().map(|luminaire| luminaire.in_scene(scene)).collect();
        scene.set_luminaires(&luminaires)
    }

    /// Lets daylight into a scene; its own sky or sun stays where none is added.
    ///
    /// # Errors
    /// A picture that cannot be used, or a sky that needs a sun.
    pub fn add_daylight_to(&self, scene: &mut Scene) -> Result<(), DaylightError> {
        scene.add_daylight(&self.daylight)
    }

    /// Adds the lamp under the ceiling to a scene whose faces have not been turned or doubled;
    /// `occluders` are the scene's.
    ///
    /// # Errors
    /// A size or an exitance that cannot be used.
    pub fn add_ceiling_to(&self, scene: &mut Scene, occluders: &Occluders) -> Result<(), EditError> {
        let Some(CeilingLight { size, exitance }) = self.ceiling else { return Ok(()) };
        let size = size.unwrap_or_else(|| ceiling::suggested_size(scene, occluders));
        let ceiling::CeilingPlace { centre, up } = ceiling::place(scene, occluders, size);
        scene.add_ceiling_light(centre, up, size, Vec3::splat(exitance))
    }
}
