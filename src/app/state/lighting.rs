//! Settings of each material and luminaire: reflectance, emission, and of lamps the switch and the
//! dimmer.
//!
//! The scene knows a lamp by its emission alone; that it is one although it is off, and what it
//! emits at 100 %, is known here.

use glam::Vec3;

use crate::scene::{Luminaire, LuminaireForm, MAX_EMISSION, Material, MaterialId, Scene};
use crate::worker::Command;

/// Exitance offered to what never emitted, W/m²: a bright office ceiling panel.
const FIRST_EXITANCE: f32 = 100.0;

/// A colour by its brightest channel and its tint, so that neither is lost while the other is
/// changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tinted {
    value: Vec3,
    tint: Vec3,
}

impl Tinted {
    fn new(value: Vec3) -> Self {
        let strength = value.max_element();
        Self { value, tint: if strength > 0.0 { value / strength } else { Vec3::ONE } }
    }

    /// The colour.
    pub fn value(&self) -> Vec3 {
        self.value
    }

    /// Emission of the brightest channel, W/m².
    pub fn strength(&self) -> f32 {
        self.value.max_element()
    }

    /// The colour whose brightest channel is 1.
    pub fn tint(&self) -> Vec3 {
        self.tint
    }

    /// Another colour; black keeps the tint.
    pub fn set(&mut self, value: Vec3) {
        self.set_tint(value);
        self.value = value;
    }

    /// Another strength of the same tint.
    pub fn set_strength(&mut self, strength: f32) {
        self.value = strength * self.tint;
    }

    /// Another tint of the same strength; black has none.
    pub fn set_tint(&mut self, tint: Vec3) {
        let strongest = tint.max_element();
        if strongest > 0.0 {
            self.tint = tint / strongest;
            self.value = self.strength() * self.tint;
        }
    }
}

/// One material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialLight {
    /// Reflectance ρ.
    pub reflectance: Tinted,
    /// Emission B_e at 100 %, W/m².
    pub emission: Tinted,
    /// Share of that.
    pub dimmer: f32,
    /// Whether it emits, or would if it were on.
    pub is_lamp: bool,
    /// Whether it emits.
    pub is_on: bool,
}

impl MaterialLight {
    fn of(material: &Material) -> Self {
        let is_lamp = material.emission.max_element() > 0.0;
        let emission = if is_lamp { material.emission } else { Vec3::splat(FIRST_EXITANCE) };
        Self {
            reflectance: Tinted::new(material.reflectance),
            emission: Tinted::new(emission),
            dimmer: 1.0,
            is_lamp,
            is_on: is_lamp,
        }
    }

    /// Emission B_e as it is now, W/m².
    pub fn emission(&self) -> Vec3 {
        if self.is_on { (self.dimmer * self.emission.value()).min(Vec3::splat(MAX_EMISSION)) } else { Vec3::ZERO }
    }
}

/// A luminaire that was added to the scene's file.
#[derive(Clone, Debug, PartialEq)]
pub struct LuminaireLight {
    /// Name of the material.
    pub name: String,
    /// Where it is and what it looks like.
    pub form: LuminaireForm,
    /// Light that the material sends.
    pub light: MaterialLight,
}

impl LuminaireLight {
    /// A luminaire that is on.
    pub fn new(name: String, form: LuminaireForm, exitance: Vec3) -> Self {
        let light = MaterialLight::of(&Material { emission: exitance, ..Material::default() });
        // One that was saved while it was off is a lamp all the same.
        Self { name, form, light: MaterialLight { is_lamp: true, ..light } }
    }

    /// The luminaire as the scene is to have it.
    pub fn wanted(&self) -> Luminaire {
        Luminaire { name: self.name.clone(), form: self.form, exitance: self.light.emission() }
    }
}

/// Every material of the scene's file, in its order, and every luminaire that was added.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lighting {
    materials: Vec<MaterialLight>,
    /// The luminaires.
    pub luminaires: Vec<LuminaireLight>,
}

impl Lighting {
    /// As a scene has it that was just opened.
    pub fn of_scene(scene: &Scene) -> Self {
        let of_file = scene.materials.len() - scene.placed_luminaires.len();
        let luminaire = |of: Luminaire| LuminaireLight::new(of.name, of.form, of.exitance);
        Self {
            materials: scene.materials[..of_file].iter().map(MaterialLight::of).collect(),
            luminaires: scene.luminaires().into_iter().map(luminaire).collect(),
        }
    }

    /// The lamps among the file's materials, whether on or off.
    pub fn lamps(&self) -> impl Iterator<Item = usize> + use<'_> {
        self.materials.iter().enumerate().filter(|(_, light)| light.is_lamp).map(|(index, _)| index)
    }

    /// A material of the file.
    pub fn of(&self, material: usize) -> Option<&MaterialLight> {
        self.materials.get(material)
    }

    /// Light of a material, to be changed.
    pub fn of_mut(&mut self, material: usize) -> Option<&mut MaterialLight> {
        self.materials.get_mut(material)
    }

    /// The luminaires as the scene is to have them.
    pub fn wanted_luminaires(&self) -> Vec<Luminaire> {
        self.luminaires.iter().map(LuminaireLight::wanted).collect()
    }

    /// Commands by which the worker puts this in force instead of `former`.
    pub fn commands_since(&self, former: &Self) -> Vec<Command> {
        let mut commands = Vec::new();
        for (index, (now, former)) in self.materials.iter().zip(&former.materials).enumerate() {
            let material = MaterialId(index as u32);
            if now.emission() != former.emission() {
                commands.push(Command::SetEmission { material, emission: now.emission() });
            }
            if now.reflectance.value() != former.reflectance.value() {
                commands.push(Command::SetReflectance { material, reflectance: now.reflectance.value() });
            }
        }
        commands
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lighting() -> Lighting {
        let material =
            |reflectance, emission| Material { name: "m".into(), reflectance, emission, ..Material::default() };
        let mut scene = Scene::new("room");
        scene.materials = vec![
            material(Vec3::new(0.7, 0.1, 0.3), Vec3::ZERO),
            material(Vec3::splat(0.3), Vec3::new(20.0, 18.0, 14.0)),
        ];
        Lighting::of_scene(&scene)
    }

    fn emission(command: &Command) -> Vec3 {
        match command {
            Command::SetEmission { material: MaterialId(1), emission } => *emission,
            other => panic!("{other:?}"),
        }
    }

    /// Truth: what the file says, to the bit, after the lamp was off, dimmed and on again.
    #[test]
    fn a_lamp_remembers_what_it_was() {
        let mut lighting = lighting();
        assert_eq!(lighting.lamps().collect::<Vec<_>>(), [1]);
        let before = lighting.clone();
        lighting.of_mut(1).expect("the lamp").is_on = false;
        let off = lighting.commands_since(&before);
        assert_eq!(off.iter().map(emission).collect::<Vec<_>>(), [Vec3::ZERO]);
        assert_eq!(lighting.lamps().count(), 1, "it is still listed");
        let dark = lighting.clone();
        let lamp = lighting.of_mut(1).expect("the lamp");
        (lamp.is_on, lamp.dimmer) = (true, 0.5);
        assert_eq!(emission(&lighting.commands_since(&dark)[0]), Vec3::new(10.0, 9.0, 7.0));
        lighting.of_mut(1).expect("the lamp").dimmer = 1.0;
        assert!(lighting.commands_since(&before).is_empty());
        assert_eq!(lighting, before);
    }

    /// Truth: a tint has no strength and a strength no tint; neither is lost where the colour is
    /// black.
    #[test]
    fn colour_and_strength_are_kept_apart() {
        let mut lighting = lighting();
        let reflectance = &mut lighting.of_mut(0).expect("a wall").reflectance;
        reflectance.set_strength(0.0);
        assert_eq!(reflectance.value(), Vec3::ZERO);
        reflectance.set_strength(0.35);
        assert!((reflectance.value() - Vec3::new(0.35, 0.05, 0.15)).abs().max_element() < 1e-6);
        reflectance.set_tint(Vec3::new(0.5, 0.25, 0.5));
        assert_eq!(reflectance.value(), Vec3::new(0.35, 0.175, 0.35));
        reflectance.set_tint(Vec3::ZERO);
        assert_eq!(reflectance.strength(), 0.35);
        reflectance.set(Vec3::new(0.1, 0.2, 0.4));
        assert_eq!((reflectance.value(), reflectance.tint()), (Vec3::new(0.1, 0.2, 0.4), Vec3::new(0.25, 0.5, 1.0)));
    }
}
