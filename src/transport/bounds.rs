//! Bounds that no solution exceeds, whatever few rays made of its links.
//!
//! Nothing is brighter than the brightest lamp seen on all sides and reflected without end, max
//! B_e/(1−ρ_max), and all light together is no more than the lamps' power reflected as often,
//! Φ/(1−ρ_max). Rows of form factors that are too large by a hundredth make a furnace of ρ = 0.95
//! glow a fifth too brightly; brought back to these bounds it errs on the safe side. Light that is
//! missing is never made up for.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::nodes::{CHUNK, Kind};
use super::solution::LinkSolution;
use super::sweep::{Gatherer, Light};
use crate::hierarchy::{ElementId, Shape};

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
        let mut outside: Vec<ElementId> = self.hierarchy.outside().collect();
        while let Some(id) = outside.pop() {
            let element = self.hierarchy.element(id);
            outside.extend(element.children());
            if let Shape::Sky(number) = element.shape {
                let part = self.hierarchy.sky_part(number);
                if part.is_sun {
                    sun = part.solid_angle / std::f32::consts::PI * part.radiosity;
                } else {
                    sky = sky.max(self.light.emitted[id.index()]);
                }
            }
        }
        (brightest.max(sky) + sun) * self.largest_gain()
    }
}

impl Gatherer<'_> {
    /// Brings light that exceeds the bounds of a solution back to them, leaf by leaf and then all
    /// reflected light together; returns how many leaves exceeded theirs.
    pub fn keep_bounds(&self, solution: &LinkSolution, light: &mut Light) -> usize {
        let bound = solution.radiosity_bound();
        let Light { radiosity, irradiance, emitted, .. } = light;
        let leaves = |chunk: usize| self.nodes.all()[chunk * CHUNK..].iter();
        let keep = |(chunk, (irradiance, emitted)): (usize, (&mut [Vec3], &[Vec3]))| {
            let mut sums = Sums::default();
            for (node, (irradiance, emitted)) in leaves(chunk).zip(irradiance.iter_mut().zip(emitted)) {
                if node.kind == Kind::Leaf {
                    sums.exceeding += usize::from(irradiance.cmpgt((1.0 + COUNTED) * bound).any());
                    *irradiance = irradiance.min(bound);
                    let area = f64::from(node.area);
                    let surface = &solution.surfaces[node.polygon as usize];
                    sums.reflected += area * (surface.reflectance * *irradiance).as_dvec3();
                    sums.emitted += area * emitted.as_dvec3();
                }
            }
            sums
        };
        let chunks = irradiance.par_chunks_mut(CHUNK).zip(emitted.par_chunks(CHUNK)).enumerate();
        let chunks: Vec<Sums> = chunks.map(keep).collect();
        let sums = chunks.into_iter().fold(Sums::default(), |a, b| Sums {
            emitted: a.emitted + b.emitted,
            reflected: a.reflected + b.reflected,
            exceeding: a.exceeding + b.exceeding,
        });
        let most = sums.emitted * (solution.largest_gain().as_dvec3() - DVec3::ONE);
        // What comes in from outside is known by few rays, which bound nothing.
        let most = if solution.hierarchy.outside().len() > 0 { DVec3::INFINITY } else { most };
        let kept = DVec3::select(sums.reflected.cmpgt(most), most / sums.reflected, DVec3::ONE).as_vec3();
        let chunks = irradiance.par_chunks_mut(CHUNK).zip(radiosity.par_chunks_mut(CHUNK)).enumerate();
        chunks.for_each(|(chunk, (irradiance, radiosity))| {
            for (node, (irradiance, radiosity)) in leaves(chunk).zip(irradiance.iter_mut().zip(radiosity)) {
                if node.kind == Kind::Leaf {
                    *irradiance *= kept;
                    let surface = &solution.surfaces[node.polygon as usize];
                    *radiosity = surface.emission + surface.reflectance * *irradiance;
                }
            }
        });
        self.nodes.pull(radiosity);
        sums.exceeding
    }
}

/// Sums over leaves: of power, W, and how many exceed their bound.
#[derive(Default)]
struct Sums {
    emitted: DVec3,
    reflected: DVec3,
    exceeding: usize,
}
