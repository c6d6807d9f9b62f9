//! Sums of each point, in batches and passes of fixed size.

use glam::DVec3;

use super::points::SurfacePoint;

/// Paths of a batch, a power of two. They share one scrambled sequence: more paths in it lower the
/// noise faster, fewer leave more batches from which the error is known.
pub const BATCH: u32 = 64;
/// Passes of the pilot: enough to meet what is rare, such as the bright inside of a lamp shade, at
/// most points that it lights.
pub const PILOT: u32 = 32;

/// Sums over the batches at one point, per colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Batches.
    pub count: u32,
    /// Σ of their means, W/m².
    pub mean: DVec3,
    /// Σ of the squares of their means.
    pub square: DVec3,
}

/// All that a run has found out.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct State {
    pub passes: u32,
    /// One for each point.
    pub pilot: Vec<Sums>,
    /// The estimate that counts once it is worth more than the pilot.
    pub counted: Vec<Sums>,
}

impl Sums {
    /// Mean of the batches, W/m²; 0 without any.
    pub fn mean(&self) -> DVec3 {
        if self.count > 0 { self.mean / f64::from(self.count) } else { DVec3::ZERO }
    }

    /// Standard error of the mean, W/m².
    pub fn standard_error(&self) -> DVec3 {
        if self.count < 2 {
            return DVec3::INFINITY;
        }
        let (count, mean) = (f64::from(self.count), self.mean());
        let variance = (self.square / count - mean * mean).max(DVec3::ZERO);
        (variance / (count - 1.0)).map(f64::sqrt)
    }
}

/// Light that a point reflects of an irradiance; nothing, even of an infinite one, where it is
/// black.
pub(super) fn reflected(point: &SurfacePoint, irradiance: DVec3) -> DVec3 {
    let of = |rho: f32, irradiance: f64| if rho > 0.0 { f64::from(rho) * irradiance } else { 0.0 };
    let reflectance = point.reflectance;
    DVec3::new(of(reflectance.x, irradiance.x), of(reflectance.y, irradiance.y), of(reflectance.z, irradiance.z))
}
