//! Luminaires that a person adds to a scene: squares, discs and lines that shine to one side.
//!
//! They are faces like all others, with a material and a group of their own, and come last among a
//! scene's faces, materials and groups, so that [`Scene::set_luminaires`] can put others in their
//! place.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::edit::{check_emission, panel_axes};
use super::{EditError, GroupId, MaterialId, Scene, sanitize};

/// Name of a ceiling light, which is a square luminaire; further ones are numbered.
pub const CEILING_LIGHT: &str = "ceiling light";
/// Width of a line, in its length.
pub const LINE_WIDTH: f32 = 0.05;
/// Quads of a disc; its rim has twice as many corners.
const DISC_QUADS: usize = 8;
/// Quads of a line.
const LINE_QUADS: usize = 5;
/// Reflectance of a luminaire: it mostly shines.
const REFLECTANCE: Vec3 = Vec3::splat(0.5);

/// Outline of a luminaire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LuminaireShape {
    /// A square.
    #[default]
    Square,
    /// A disc, as a regular polygon of its area.
    Disc,
    /// A strip, [`LINE_WIDTH`] of its length wide.
    Line,
}

impl LuminaireShape {
    /// All shapes.
    pub const ALL: [Self; 3] = [Self::Square, Self::Disc, Self::Line];

    /// Name of a luminaire of this shape before a person names it.
    pub fn usual_name(self) -> &'static str {
        match self {
            Self::Square => "square light",
            Self::Disc => "disc light",
            Self::Line => "line light",
        }
    }
}

/// Where a luminaire is and what it looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuminaireForm {
    /// Outline of the luminaire.
    pub shape: LuminaireShape,
    /// Middle of the luminaire, in the scene's coordinates.
    pub centre: Vec3,
    /// Where it shines to; need not be normalised.
    pub direction: Vec3,
    /// Turn about that direction, degrees; a line lies along the first level axis at 0.
    pub turn_deg: f32,
    /// Side of a square, diameter of a disc, length of a line, in the scene's length unit.
    pub size: f32,
}

/// A luminaire as a person wants it.
#[derive(Clone, Debug, PartialEq)]
pub struct Luminaire {
    /// Name of its material and of its group.
    pub name: String,
    /// Where it is and what it looks like.
    pub form: LuminaireForm,
    /// Exitance B_e per colour, W/m².
    pub exitance: Vec3,
}

/// A luminaire among a scene's faces; its name and exitance are its material's.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLuminaire {
    /// Where it is and what it looks like.
    pub form: LuminaireForm,
    /// Material of the luminaire alone.
    pub material: MaterialId,
    /// Group of the luminaire alone.
    group: GroupId,
    /// Remark on the place of the luminaire.
    remark: Option<String>,
}

/// A luminaire in a file's coordinates, as sidecars and settings give it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FiledLuminaire {
    /// Name of the luminaire.
    pub name: String,
    /// Outline of the luminaire.
    #[serde(default)]
    pub shape: LuminaireShape,
    /// Middle of the luminaire, in the file's coordinates.
    pub centre: DVec3,
    /// Where it shines to; need not be normalised.
    pub direction: Vec3,
    /// Turn about that direction, degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub turn_deg: f32,
    /// Side of a square, diameter of a disc, length of a line, in the scene's length unit.
    pub size: f32,
    /// Exitance B_e per colour, W/m².
    pub exitance: Vec3,
}

fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

impl FiledLuminaire {
    /// The luminaire in the coordinates of a scene.
    pub fn in_scene(&self, scene: &Scene) -> Luminaire {
        let Self { ref name, shape, centre, direction, turn_deg, size, exitance } = *self;
        let form = LuminaireForm { shape, centre: scene.from_file(centre), direction, turn_deg, size };
        Luminaire { name: name.clone(), form, exitance }
    }
}

impl Luminaire {
    /// The luminaire in the coordinates of a scene's file.
    pub fn in_file(&self, scene: &Scene) -> FiledLuminaire {
        let LuminaireForm { shape, centre, direction, turn_deg, size } = self.form;
        let (name, centre) = (self.name.clone(), scene.to_file(centre));
        FiledLuminaire { name, shape, centre, direction, turn_deg, size, exitance: self.exitance }
    }
}

impl LuminaireForm {
    /// Area that shines, in the square of the length unit.
    pub fn area(&self) -> f32 {
        match self.shape {
            LuminaireShape::Square => self.size * self.size,
            LuminaireShape::Disc => 0.25 * PI * self.size * self.size,
            LuminaireShape::Line => LINE_WIDTH * self.size * self.size,
        }
    }

    /// Two unit vectors across the direction, the first along a line.
    fn axes(&self) -> [Vec3; 2] {
        let up = -self.direction.normalize_or(Vec3::NEG_Y);
        let (right, forward) = panel_axes(up);
        if self.turn_deg == 0.0 {
            return [right, forward];
        }
        let (sine, cosine) = self.turn_deg.to_radians().sin_cos();
        [cosine * right + sine * forward, cosine * forward - sine * right]
    }

    /// Corners of its outline, clockwise as seen from the bright side.
    pub fn outline(&self) -> Vec<Vec3> {
        let [right, forward] = self.axes();
        let at = |along: f32, across: f32| self.centre + along * right + across * forward;
        let half = 0.5 * self.size;
        match self.shape {
            LuminaireShape::Square => vec![at(-half, -half), at(half, -half), at(half, half), at(-half, half)],
            LuminaireShape::Line => {
                let side = LINE_WIDTH * half;
                vec![at(-half, -side), at(half, -side), at(half, side), at(-half, side)]
            }
            LuminaireShape::Disc => {
                let corners = 2 * DISC_QUADS;
                let angle = TAU / corners as f32;
                // The polygon has the area of the disc.
                let radius = half * (angle / angle.sin()).sqrt();
                (0..corners)
                    .map(|corner| (corner as f32 * angle).sin_cos())
                    .map(|(s, c)| at(radius * c, radius * s))
                    .collect()
            }
        }
    }

    /// Faces of the luminaire, anticlockwise as seen from the bright side.
    fn quads(&self) -> Vec<[Vec3; 4]> {
        let rim = self.outline();
        match self.shape {
            LuminaireShape::Square => vec![[rim[0], rim[3], rim[2], rim[1]]],
            LuminaireShape::Disc => {
                let corner = |index: usize| rim[index % rim.len()];
                let quad = |first| [self.centre, corner(first + 2), corner(first + 1), corner(first)];
                (0..DISC_QUADS).map(|quad| 2 * quad).map(quad).collect()
            }
            LuminaireShape::Line => {
                let at = |step: usize| step as f32 / LINE_QUADS as f32;
                let near = |step| rim[0].lerp(rim[1], at(step));
                let far = |step| rim[3].lerp(rim[2], at(step));
                (0..LINE_QUADS).map(|step| [near(step), far(step), far(step + 1), near(step + 1)]).collect()
            }
        }
    }

    /// Why it cannot be used.
    fn problem(&self) -> Option<EditError> {
        if !(self.size > 0.0 && self.size.is_finite()) {
            return Some(EditError::Size(self.size));
        }
        if !(self.centre.is_finite() && self.turn_deg.is_finite()) {
            return Some(EditError::Place);
        }
        self.direction.try_normalize().is_none().then_some(EditError::Direction)
    }
}

impl Scene {
    /// The luminaires that were added to it, in their order.
    pub fn luminaires(&self) -> Vec<Luminaire> {
        let of = |placed: &PlacedLuminaire| {
            let material = &self.materials[placed.material.0 as usize];
            Luminaire { name: material.name.clone(), form: placed.form, exitance: material.emission }
        };
        self.placed_luminaires.iter().map(of).collect()
    }

    /// The luminaire that a material belongs to.
    pub fn luminaire_of(&self, material: MaterialId) -> Option<usize> {
        self.placed_luminaires.iter().position(|placed| placed.material == material)
    }

    /// Adds a luminaire, under its name or with the first number that makes it new.
    ///
    /// # Errors
    /// A size, a place, a direction or an exitance that cannot be used.
    pub fn add_luminaire(&mut self, luminaire: &Luminaire) -> Result<(), EditError> {
        let mut form = luminaire.form;
        check_emission(luminaire.exitance)?;
        if let Some(problem) = form.problem() {
            return Err(problem);
        }
        form.direction = form.direction.normalize();
        let name = self.free_name(&luminaire.name);
        let remark = self.misfit(&name, &form).map(|remark| sanitize::sentence(&remark));
        if let Some(remark) = &remark {
            self.skipped.note(remark);
        }
        let material = self.add_material(&name, REFLECTANCE, luminaire.exitance);
        let group = self.add_group(&name, GroupId(0));
        for corners in form.quads() {
            self.add_quad(corners, material, group);
        }
        self.placed_luminaires.push(PlacedLuminaire { form, material, group, remark });
        Ok(())
    }

    /// Puts these luminaires in the place of those that were added to a scene whose faces have not
    /// been turned, doubled or cut.
    ///
    /// # Errors
    /// One that cannot be used; the scene then lacks those from it on.
    pub fn set_luminaires(&mut self, luminaires: &[Luminaire]) -> Result<(), EditError> {
        self.remove_luminaires();
        luminaires.iter().try_for_each(|luminaire| self.add_luminaire(luminaire))
    }

    /// Takes all luminaires away, with their faces, materials, groups and remarks.
    fn remove_luminaires(&mut self) {
        let Some(first) = self.placed_luminaires.first() else { return };
        let (material, group) = (first.material, first.group);
        self.polygons.retain(|polygon| polygon.material < material);
        let used = self.polygons.iter().flat_map(|polygon| polygon.corners().iter().copied()).max();
        self.vertices.truncate(used.map_or(0, |last| last as usize + 1));
        self.materials.truncate(material.0 as usize);
        self.groups.truncate(group.0 as usize);
        for placed in std::mem::take(&mut self.placed_luminaires) {
            self.skipped.notes.retain(|note| Some(note) != placed.remark.as_ref());
        }
    }

    /// Why a luminaire will hardly light the room, if it is so: it is larger, or reaches out of it.
    fn misfit(&self, name: &str, form: &LuminaireForm) -> Option<String> {
        if self.polygons.is_empty() {
            return None;
        }
        let (lower, upper) = self.bounds();
        let extent = upper - lower;
        // Rounding must not matter: a light may fill the whole ceiling.
        let slack = 1e-3 * extent.max_element();
        let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for corner in form.outline() {
            (least, most) = (least.min(corner), most.max(corner));
        }
        let reach = most - least;
        if reach.cmpgt(extent + slack).any() {
            let [a, b] = form.axes().map(|axis| (1e3 * extent.dot(axis.abs())).round() / 1e3);
            let size = match form.shape {
                LuminaireShape::Square => "with sides",
                LuminaireShape::Disc => "with a diameter",
                LuminaireShape::Line => "with a length",
            };
            return Some(format!(
                "The {name}, {size} of {}, is larger than the scene, which measures {a} by {b}: choose a smaller one.",
                form.size
            ));
        }
        let is_inside = least.cmpge(lower - slack).all() && most.cmple(upper + slack).all();
        (!is_inside)
            .then(|| format!("The {name} lies outside of the scene, in part at least: it may light little of it."))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminaire(shape: LuminaireShape, direction: Vec3) -> Luminaire {
        let form = LuminaireForm { shape, centre: Vec3::new(1.0, 2.0, 3.0), direction, turn_deg: 0.0, size: 0.8 };
        Luminaire { name: shape.usual_name().into(), form, exitance: Vec3::new(10.0, 20.0, 5.0) }
    }

    /// Truth: Φ = A·B_e with the areas s², πs²/4 and s²/20; the faces' normals are the direction,
    /// whatever that is.
    #[test]
    fn every_shape_sends_its_flux_where_it_points() {
        let truths = [0.64, 0.16 * PI, 0.032];
        for (shape, area) in LuminaireShape::ALL.into_iter().zip(truths) {
            for direction in [-Vec3::Y, Vec3::X, Vec3::Z, Vec3::new(1.0, -3.0, 0.5)] {
                let mut wanted = luminaire(shape, direction);
                for turn_deg in [0.0, 35.0, 90.0] {
                    wanted.form.turn_deg = turn_deg;
                    let mut scene = Scene::new("room");
                    scene.add_luminaire(&wanted).expect("a good one");
                    let power = scene.emitted_power();
                    // Rounding of f32 coordinates near 3 against sides of 0.04.
                    assert!((power / (area * wanted.exitance) - 1.0).abs().max_element() < 2e-5, "{shape:?} {power}");
                    assert!((wanted.form.area() / area - 1.0).abs() < 1e-6);
                    let sees = |polygon| scene.normal(polygon).dot(direction.normalize()) > 0.9999;
                    assert!(scene.polygons.iter().all(sees), "{shape:?} {direction} {turn_deg}");
                    let (lower, upper) = scene.bounds();
                    assert!((0.5 * (lower + upper)).distance(wanted.form.centre) < 1e-5);
                }
            }
        }
    }

    /// Truth: the scene before anything was added, and one to which only the last list was added.
    #[test]
    fn others_take_the_place_of_those_that_were_there() {
        let room = || {
            let mut scene = Scene::new("room");
            let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
            scene.add_triangle([Vec3::ZERO, Vec3::X, Vec3::splat(4.0)], grey, GroupId(0));
            scene
        };
        let [square, mut disc, line] = LuminaireShape::ALL.map(|shape| luminaire(shape, -Vec3::Y));
        disc.form.centre.y = 9.0;
        let mut scene = room();
        scene.set_luminaires(&[square.clone(), disc.clone(), line.clone()]).expect("good ones");
        assert_eq!(scene.luminaires(), [square.clone(), disc, line.clone()]);
        assert_eq!(scene.skipped.notes.len(), 1, "{:?}", scene.skipped.notes);
        scene.set_luminaires(&[line.clone(), square.clone(), line.clone()]).expect("good ones");
        let names: Vec<String> = scene.luminaires().into_iter().map(|luminaire| luminaire.name).collect();
        assert_eq!(names, ["line light", "square light", "line light 2"]);
        let mut other = room();
        other.set_luminaires(&[line.clone(), square, line]).expect("good ones");
        assert_eq!((&scene.vertices, &scene.polygons), (&other.vertices, &other.polygons));
        assert_eq!((&scene.materials, &scene.skipped), (&other.materials, &other.skipped));
        scene.set_luminaires(&[]).expect("none");
        let bare = room();
        assert_eq!((scene.vertices, scene.polygons, scene.materials), (bare.vertices, bare.polygons, bare.materials));
        assert_eq!(scene.groups.len(), bare.groups.len());
    }

    #[test]
    fn what_cannot_be_used_is_refused() {
        let mut scene = Scene::new("room");
        let good = luminaire(LuminaireShape::Line, -Vec3::Y);
        let with = |change: fn(&mut LuminaireForm)| {
            let mut bad = good.clone();
            change(&mut bad.form);
            bad
        };
        assert_eq!(scene.add_luminaire(&with(|form| form.size = 0.0)), Err(EditError::Size(0.0)));
        assert_eq!(scene.add_luminaire(&with(|form| form.direction = Vec3::ZERO)), Err(EditError::Direction));
        assert_eq!(scene.add_luminaire(&with(|form| form.centre.x = f32::NAN)), Err(EditError::Place));
        assert_eq!(scene.add_luminaire(&with(|form| form.turn_deg = f32::INFINITY)), Err(EditError::Place));
        assert!(scene.add_luminaire(&Luminaire { exitance: Vec3::splat(-1.0), ..good }).is_err());
        assert!(scene.polygons.is_empty() && scene.materials.is_empty());
    }
}
