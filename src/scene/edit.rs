//! Changes that a person makes to a loaded scene: a material that emits, a light under the ceiling.

use std::collections::HashSet;

use glam::Vec3;

use super::luminaire::{CEILING_LIGHT, Luminaire, LuminaireForm, LuminaireShape};
use super::sidecar::MAX_EMISSION;
use super::{Scene, sanitize};

/// A change that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// No material of that name.
    #[error("the scene has no material `{name}`; {hint}")]
    UnknownMaterial {
        /// The name asked for.
        name: String,
        /// Names that there are.
        hint: String,
    },
    /// Emission must be neither negative nor beyond all reason.
    #[error("an emission must be three numbers between 0 and 1e9, in W/m² (it is {0})")]
    Emission(Vec3),
    /// The size of a luminaire must be positive.
    #[error("the size of a luminaire must be greater than 0 (it is {0})")]
    Size(f32),
    /// A direction must have a length.
    #[error("the direction of a luminaire must have a length")]
    Direction,
    /// Coordinates must be finite.
    #[error("the place and the turn of a luminaire must be finite numbers")]
    Place,
}

impl Scene {
    /// Makes every face of a material emit; `emission` is the exitance B_e, W/m² per colour.
    ///
    /// # Errors
    /// An unknown material (with the nearest names) or an emission that is negative or not finite.
    pub fn set_emission(&mut self, material: &str, emission: Vec3) -> Result<(), EditError> {
        check_emission(emission)?;
        let mut found = false;
        for named in self.materials.iter_mut().filter(|named| named.name == material) {
            named.emission = emission;
            found = true;
        }
        if found {
            return Ok(());
        }
        Err(EditError::UnknownMaterial { name: material.to_owned(), hint: self.names_like(material) })
    }

    /// Adds a square luminaire that shines down (against `up`), its middle at `centre`, its side
    /// `size` in the scene's length unit; `exitance` is B_e, W/m² per colour.
    /// [`crate::prepare::ceiling::place`] finds the place for it. Each has a material of its own:
    /// "ceiling light", "ceiling light 2" and so on.
    ///
    /// # Errors
    /// A size, direction or exitance that cannot be used.
    pub fn add_ceiling_light(&mut self, centre: Vec3, up: Vec3, size: f32, exitance: Vec3) -> Result<(), EditError> {
        let form = LuminaireForm { shape: LuminaireShape::Square, centre, direction: -up, turn_deg: 0.0, size };
        self.add_luminaire(&Luminaire { name: CEILING_LIGHT.into(), form, exitance })
    }

    /// A name that no material has yet: this one, or with the first number that makes it new.
    pub fn free_name(&self, name: &str) -> String {
        let taken: HashSet<&str> = self.materials.iter().map(|material| material.name.as_str()).collect();
        let numbered = (2..).map(|number| format!("{name} {number}"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        names.find(|name| !taken.contains(name.as_str())).unwrap_or_default()
    }

    /// Whether any face emits, or anything outside.
    pub fn has_light(&self) -> bool {
        self.has_lamp() || self.outside().is_some()
    }

    /// Whether any face emits.
    pub fn has_lamp(&self) -> bool {
        self.polygons.iter().any(|polygon| self.emits(polygon))
    }

    /// Leaves out the faces of materials with these names.
    pub(super) fn leave_out(&mut self, names: &[String]) {
        for name in names {
            match self.material_named(name) {
                Some(material) => self.polygons.retain(|polygon| polygon.material != material),
                None => self.skipped.note(format!("There is no material {} to be left out.", sanitize::quoted(name))),
            }
        }
        self.reading.ignored.extend_from_slice(names);
    }

    /// One sentence for a scene that is black because nothing in it emits.
    pub fn no_light_sentence() -> &'static str {
        "Nothing in this scene emits light, so it is black: make a material emit (--emit MATERIAL=r,g,b), add a ceiling light (--ceiling-light) or let daylight in (--sky overcast)."
    }

    /// Up to eight material names, those most like `wanted` first.
    fn names_like(&self, wanted: &str) -> String {
        let mut names: Vec<&str> = self.materials.iter().map(|material| material.name.as_str()).collect();
        names.sort_by_cached_key(|name| (unlikeness(name, wanted), name.to_lowercase()));
        names.dedup();
        if names.is_empty() { "it has no materials".to_owned() } else { format!("it has {}", sanitize::list(names, 8)) }
    }
}

/// Axis-aligned directions of the panel's edges: `right × forward` points up.
pub(crate) fn panel_axes(up: Vec3) -> (Vec3, Vec3) {
    let across = if up.x.abs() < 0.9 { Vec3::X } else { Vec3::Y };
    let right = (across - up * across.dot(up)).normalize();
    (right, up.cross(right))
}

pub(super) fn check_emission(emission: Vec3) -> Result<(), EditError> {
    let in_range = emission.min_element() >= 0.0 && emission.max_element() <= MAX_EMISSION && emission.is_finite();
    if in_range { Ok(()) } else { Err(EditError::Emission(emission)) }
}

/// Edit distance of two names (case aside), 0 where one holds the other.
fn unlikeness(name: &str, wanted: &str) -> usize {
    let (name, wanted) = (name.to_lowercase(), wanted.to_lowercase());
    if !wanted.is_empty() && (name.contains(&wanted) || wanted.contains(&name)) {
        return 0;
    }
    strsim::levenshtein(&name, &wanted)
}

#[cfg(test)]
mod tests {
    use super::super::GroupId;
    use super::*;

    #[test]
    fn an_unknown_material_is_answered_with_the_nearest_names() {
        let mut scene = Scene::new("room");
        for name in ["wall", "ceiling", "floor", "Lamp.001"] {
            scene.add_material(name, Vec3::ONE, Vec3::ZERO);
        }
        let error = scene.set_emission("lamp", Vec3::ONE).expect_err("no such material");
        assert_eq!(error.to_string(), "the scene has no material `lamp`; it has Lamp.001, wall, floor, ceiling");
        assert!(scene.set_emission("wall", Vec3::new(1.0, -1.0, 0.0)).is_err());
        assert!(scene.set_emission("wall", Vec3::splat(f32::NAN)).is_err());
        assert!(scene.set_emission("wall", Vec3::new(f32::NAN, 1.0, 1.0)).is_err());
        assert!(scene.set_emission("wall", Vec3::splat(1e10)).is_err());
        scene.set_emission("wall", Vec3::ONE).expect("a known material");
        assert!(!scene.has_light(), "no face has that material");
    }

    /// Truth: a unit box.
    #[test]
    fn a_light_that_does_not_fit_is_said() {
        let notes = |centre: Vec3, size: f32| {
            let mut scene = Scene::new("room");
            let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
            scene.add_triangle([Vec3::ZERO, Vec3::X, Vec3::ONE], grey, GroupId(0));
            scene.add_triangle([Vec3::ZERO, Vec3::ONE, Vec3::Z], grey, GroupId(0));
            scene.add_ceiling_light(centre, Vec3::Y, size, Vec3::ONE).expect("it is added all the same");
            scene.skipped.notes.join(" ")
        };
        assert_eq!(notes(Vec3::new(0.5, 0.9, 0.5), 1.0), "");
        assert!(notes(Vec3::new(0.5, 0.9, 0.5), 3.0).contains("larger than the scene"));
        assert!(notes(Vec3::new(0.9, 0.9, 0.5), 0.5).contains("outside of the scene"));
        assert!(notes(Vec3::new(0.5, 1.5, 0.5), 0.5).contains("outside of the scene"));
    }

    /// Truth: the panel's normal is −up and its area the square of its side, whatever up is.
    #[test]
    fn ceiling_lights_shine_down() {
        for up in [Vec3::Y, Vec3::Z, Vec3::X, -Vec3::Y, Vec3::new(0.0, 2.0, 0.0)] {
            let mut scene = Scene::new("room");
            scene.add_ceiling_light(Vec3::ONE, up, 0.5, Vec3::splat(10.0)).expect("a good light");
            let panel = scene.polygons[0];
            assert!(scene.normal(&panel).dot(-up.normalize()) > 0.9999, "{up}");
            assert!((scene.area(&panel) - 0.25).abs() < 1e-6);
            assert!(scene.has_light());
            scene.add_ceiling_light(Vec3::ZERO, up, 0.5, Vec3::splat(10.0)).expect("a second light");
            let names: Vec<_> = scene.materials.iter().map(|material| material.name.as_str()).collect();
            assert_eq!(names, ["ceiling light", "ceiling light 2"], "each can be named on its own");
        }
        let mut scene = Scene::new("room");
        assert_eq!(scene.add_ceiling_light(Vec3::ONE, Vec3::Y, 0.0, Vec3::ONE), Err(EditError::Size(0.0)));
        assert_eq!(scene.add_ceiling_light(Vec3::ONE, Vec3::ZERO, 1.0, Vec3::ONE), Err(EditError::Direction));
    }
}
