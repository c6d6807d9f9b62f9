//! Lights from far away as one polynomial of the normal of the face that they meet.

use glam::Vec3;

use crate::hierarchy::{Hierarchy, Shape};

/// The positive cosine max(0, x) as c₀ + c₁x + c₂x², its expansion in spherical harmonics up to the
/// second order: off by 6 % of the full cosine at most, and by nothing in the mean over all
/// directions [Ramamoorthi, Hanrahan 2001].
const COSINE: [f32; 3] = [3.0 / 32.0, 0.5, 15.0 / 32.0];

/// Products of the coordinates of a direction: xx, yy, zz, 2xy, 2yz, 2zx.
fn products(direction: Vec3) -> [f32; 6] {
    let Vec3 { x, y, z } = direction;
    [x * x, y * y, z * z, 2.0 * x * y, 2.0 * y * z, 2.0 * z * x]
}

/// Lights from far away, summed so that their irradiance on a face of any direction is one
/// polynomial of its normal.
#[derive(Clone, Copy, Default)]
pub struct IrradianceHarmonics {
    constant: Vec3,
    linear: [Vec3; 3],
    square: [Vec3; 6],
}

impl IrradianceHarmonics {
    /// Adds a light that brings `flux` (W/m²) to a face turned to it.
    pub fn add(&mut self, flux: Vec3, direction: Vec3) {
        self.constant += COSINE[0] * flux;
        for (sum, component) in self.linear.iter_mut().zip(direction.to_array()) {
            *sum += COSINE[1] * component * flux;
        }
        let [xx, yy, zz, xy, yz, zx] = products(direction);
        // Mixed products count twice in the square, once here and once in the face's own.
        for (sum, product) in self.square.iter_mut().zip([xx, yy, zz, 0.5 * xy, 0.5 * yz, 0.5 * zx]) {
            *sum += COSINE[2] * product * flux;
        }
    }

    /// Adds all lights of another sum.
    pub fn join(&mut self, other: &Self) {
        self.constant += other.constant;
        self.linear.iter_mut().zip(other.linear).for_each(|(sum, term)| *sum += term);
        self.square.iter_mut().zip(other.square).for_each(|(sum, term)| *sum += term);
    }

    /// Irradiance of a face with this normal, W/m²; may be a little less than none on one turned
    /// away from all light.
    pub fn on(&self, normal: Vec3) -> Vec3 {
        let linear = self.linear.iter().zip(normal.to_array()).map(|(term, component)| *term * component).sum::<Vec3>();
        let square = self.square.iter().zip(products(normal)).map(|(term, product)| *term * product).sum::<Vec3>();
        self.constant + linear + square
    }
}

/// Reflection of a cluster's faces, of light that reaches all of them alike and of lights from far
/// away: means over the cluster's area of their reflectances ρ, times the terms of such a
/// polynomial.
#[derive(Clone, Copy, Default)]
pub struct ReflectionMoments {
    constant: Vec3,
    linear: [Vec3; 3],
    square: [Vec3; 6],
}

impl ReflectionMoments {
    /// Adds a face with this normal; `reflectance` is its ρ times its share of the area.
    pub fn add(&mut self, reflectance: Vec3, normal: Vec3) {
        self.constant += reflectance;
        self.linear.iter_mut().zip(normal.to_array()).for_each(|(sum, component)| *sum += component * reflectance);
        self.square.iter_mut().zip(products(normal)).for_each(|(sum, product)| *sum += product * reflectance);
    }

    /// Mean reflectance.
    pub fn mean(&self) -> Vec3 {
        self.constant
    }

    /// Reflected radiosity in the mean over the area, W/m², of this irradiance on every face and of
    /// these lights.
    pub fn reflected(&self, even: Vec3, lights: Option<&IrradianceHarmonics>) -> Vec3 {
        let constant = self.constant * even;
        let Some(lights) = lights else { return constant };
        let linear = self.linear.iter().zip(&lights.linear).map(|(mean, term)| *mean * *term).sum::<Vec3>();
        let square = self.square.iter().zip(&lights.square).map(|(mean, term)| *mean * *term).sum::<Vec3>();
        constant + self.constant * lights.constant + linear + square
    }
}

/// How the patches of a cluster are turned: means over their area.
#[derive(Clone, Copy, Default)]
pub struct NormalMoments {
    normal: Vec3,
    products: [f32; 6],
}

impl NormalMoments {
    /// Mean positive cosine of the patches towards a direction, as `IrradianceHarmonics` give
    /// it.
    pub fn mean_cosine(&self, direction: Vec3) -> f32 {
        let [xx, yy, zz, xy, yz, zx] = products(direction);
        let halved = [xx, yy, zz, 0.5 * xy, 0.5 * yz, 0.5 * zx];
        let square = self.products.iter().zip(halved).map(|(mean, product)| mean * product).sum::<f32>();
        COSINE[0] + COSINE[1] * self.normal.dot(direction) + COSINE[2] * square
    }
}

/// The normal moments of all clusters, by their numbers.
pub fn normal_moments(hierarchy: &Hierarchy) -> Vec<NormalMoments> {
    let mut normal_moments = vec![NormalMoments::default(); hierarchy.cluster_count()];
    for element in hierarchy.elements().iter().rev() {
        let facing = match &element.shape {
            Shape::Patch(patch) => NormalMoments { normal: patch.normal, products: products(patch.normal) },
            Shape::Cluster(cluster) => normal_moments[cluster.number as usize],
            Shape::Sky(_) => continue,
        };
        let Some(parent) = element.parent().map(|parent| hierarchy.element(parent)) else { continue };
        let Shape::Cluster(cluster) = &parent.shape else { continue };
        if parent.area > 0.0 {
            let share = element.area / parent.area;
            let sum = &mut normal_moments[cluster.number as usize];
            sum.normal += share * facing.normal;
            sum.products.iter_mut().zip(facing.products).for_each(|(sum, product)| *sum += share * product);
        }
    }
    normal_moments
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the cosine itself, and its mean over all directions, ¼.
    #[test]
    fn a_sky_lights_faces_by_their_cosine() {
        let light = Vec3::new(0.36, 0.48, 0.8);
        let mut harmonics = IrradianceHarmonics::default();
        harmonics.add(Vec3::splat(2.0), light);
        let (mut mean, count) = (0.0, 4000);
        for index in 0..count {
            // Fibonacci's sphere.
            let height = 1.0 - (2 * index + 1) as f32 / count as f32;
            let (sine, cosine) = (2.399_963_2 * index as f32).sin_cos();
            let radius = (1.0 - height * height).sqrt();
            let normal = Vec3::new(radius * cosine, radius * sine, height);
            let found = harmonics.on(normal).x;
            assert!((found - 2.0 * normal.dot(light).max(0.0)).abs() < 2.0 * 0.1, "{normal}: {found}");
            mean += found / count as f32;
        }
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let facing = NormalMoments { normal: light, products: products(light) };
        assert!((2.0 * facing.mean_cosine(light) - harmonics.on(light).x).abs() < 1e-6);
    }
}
