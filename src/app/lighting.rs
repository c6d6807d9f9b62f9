//! What a person set of each material: reflectance, emission, and of lamps the switch and the dimmer.
//!
//! The scene knows a lamp by its emission alone; that it is one although it is off, and what it emits at 100 %, is known here.

use glam::Vec3;

use crate::scene::{MAX_EMISSION, Material, MaterialId};
use crate::worker::Command;

/// Exitance offered to what never emitted, W/m²: a bright office ceiling panel.
const FIRST_EXITANCE: f32 = 100.0;

/// A colour by its brightest channel and its tint, so that neither is lost while the other is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tinted {
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

    /// Its brightest channel.
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
pub(super) struct MaterialLight {
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

/// Every material, in the scene's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lighting(Vec<MaterialLight>);

impl Lighting {
    /// Takes up materials that were added; those that are known stay as they were set.
    pub fn extend_to(&mut self, materials: &[Material]) {
        self.0.extend(materials.iter().skip(self.0.len()).map(MaterialLight::of));
    }

    /// The lamps, whether on or off.
    pub fn lamps(&self) -> impl Iterator<Item = usize> + use<'_> {
        self.0.iter().enumerate().filter(|(_, light)| light.is_lamp).map(|(index, _)| index)
    }

    /// A material.
    pub fn of(&self, material: usize) -> Option<&MaterialLight> {
        self.0.get(material)
    }

    /// The same, to be changed.
    pub fn of_mut(&mut self, material: usize) -> Option<&mut MaterialLight> {
        self.0.get_mut(material)
    }

    /// Goes back to how materials were; those that came later stay.
    pub fn restore(&mut self, former: &Self) {
        for (light, former) in self.0.iter_mut().zip(&former.0) {
            *light = *former;
        }
    }

    /// What the worker must be told for this to be in force instead of `former`.
    pub fn commands_since(&self, former: &Self) -> Vec<Command> {
        let mut commands = Vec::new();
        for (index, (now, former)) in self.0.iter().zip(&former.0).enumerate() {
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
        let mut lighting = Lighting::default();
        lighting.extend_to(&[
            material(Vec3::new(0.7, 0.1, 0.3), Vec3::ZERO),
            material(Vec3::splat(0.3), Vec3::new(20.0, 18.0, 14.0)),
        ]);
        lighting
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

    /// Truth: a tint has no strength and a strength no tint; neither is lost where the colour is black.
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
