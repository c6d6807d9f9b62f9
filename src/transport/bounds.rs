//! Bounds that no solution exceeds, whatever few rays made of its links.
//!
//! Nothing is brighter than the brightest lamp seen on all sides and reflected without end, max
//! B_e/(1−ρ_max), and all light together is no more than the lamps' power reflected as often,
//! Φ/(1−ρ_max). Rows of form factors that are too large by a hundredth make a furnace of ρ = 0.95
//! glow a fifth too brightly; brought back to these bounds it errs on the safe side. Light that is
//! missing is never made up for.

use glam::{DVec3, Vec3};

use super::solution::LinkSolution;
use super::sweep::{Light, pull};
use crate::hierarchy::{Element, Shape};

/// Only leaves that exceed the bound by more than this share are counted: less is rounding.
const COUNTED: f32 = 1e-3;

impl LinkSolution {
    /// 1/(1−ρ_max) per colour over the materials in use: by how much reflections multiply light at
    /// most.
    pub fn largest_gain(&self) -> Vec3 {
        let largest = self.surfaces.iter().fold(Vec3::ZERO, |most, surface| most.max(surface.reflectance));
        (Vec3::ONE - largest).recip()
    }

    /// Bound that no radiosity exceeds, (max B_e + E_sun)/(1−ρ_max) per colour, W/m²; B_e is that
    /// of a lamp or of the brightest part of the sky.
    pub fn radiosity_bound(&self) -> Vec3 {
        let brightest = self.surfaces.iter().fold(Vec3::ZERO, |most, surface| most.max(surface.emission));
        let (mut sky, mut sun) = (Vec3::ZERO, Vec3::ZERO);
        for (element, radiosity) in self.hierarchy.elements().iter().zip(&self.light.emitted) {
            if let Shape::Sky(number) = element.shape {
                let part = self.hierarchy.sky_part(number);
                if part.is_sun {
                    sun = part.solid_angle / std::f32::consts::PI * part.radiosity;
                } else {
                    sky = sky.max(*radiosity);
                }
            }
        }
        (brightest.max(sky) + sun) * self.largest_gain()
    }

    /// Brings light that exceeds the bounds back to them, leaf by leaf and then all reflected light
    /// together; returns how many leaves exceeded theirs.
    pub fn keep_bounds(&self, light: &mut Light) -> usize {
        let hierarchy = &self.hierarchy;
        let bound = self.radiosity_bound();
        let polygon_of = |element: &Element| match element.shape {
            Shape::Patch(patch) if element.is_leaf() => Some(patch.polygon as usize),
            _ => None,
        };
        let (mut emitted, mut reflected) = (DVec3::ZERO, DVec3::ZERO);
        let mut exceeding = 0;
        for (index, element) in hierarchy.elements().iter().enumerate() {
            let Some(polygon) = polygon_of(element) else { continue };
            let irradiance = &mut light.irradiance[index];
            exceeding += usize::from(irradiance.cmpgt((1.0 + COUNTED) * bound).any());
            *irradiance = irradiance.min(bound);
            let area = f64::from(element.area);
            reflected += area * (self.surfaces[polygon].reflectance * *irradiance).as_dvec3();
            emitted += area * light.emitted[index].as_dvec3();
        }
        let most = emitted * (self.largest_gain().as_dvec3() - DVec3::ONE);
        // What comes in from outside is known by few rays, which bound nothing.
        let most = if hierarchy.outside().len() > 0 { DVec3::INFINITY } else { most };
        let kept = DVec3::select(reflected.cmpgt(most), most / reflected, DVec3::ONE).as_vec3();
        for (index, element) in hierarchy.elements().iter().enumerate() {
            let Some(polygon) = polygon_of(element) else { continue };
            light.irradiance[index] *= kept;
            let surface = &self.surfaces[polygon];
            light.radiosity[index] = surface.emission + surface.reflectance * light.irradiance[index];
        }
        pull(hierarchy, &mut light.radiosity);
        exceeding
    }
}
