//! Surfaces that the samples of a picture see.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::Lens;
use crate::base::cancel::CancelToken;
use crate::gather::Field;

/// Marks a sample that sees nothing.
const NOTHING: u32 = u32::MAX;

/// Holes that a ray passes, at most.
const MOST_HOLES: u32 = 64;
/// A ray goes on behind a hole by this share of its length: rounding is far below it.
const BEYOND_HOLE: f32 = 1e-5;

/// Where the samples of a pixel lie, in pixels from its upper left corner: one in each quarter, no
/// two of which share a row or a column.
const PLACES: [[Vec2; 2]; 2] =
    [[Vec2::new(0.375, 0.125), Vec2::new(0.875, 0.375)], [Vec2::new(0.125, 0.625), Vec2::new(0.625, 0.875)]];

/// Surface that a sample sees.
#[derive(Clone, Copy, Debug)]
pub struct VisibleSurface {
    /// Place on the surface.
    pub position: Vec3,
    /// Distance from the eye.
    pub distance: f32,
    /// Unit normal for shading, as the file says; faces between its vertices are flat.
    pub normal: Vec3,
    /// Unit normal of the face.
    pub face: Vec3,
    /// Reflectance there, textures included.
    pub reflectance: Vec3,
    /// Emission there, W/m²; where nothing is seen π times the radiance of the sky.
    pub emission: Vec3,
    /// Index of the scene's polygon, or none.
    polygon: u32,
}

/// Place of a surface: what a filter asks of it, close together in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Place on the surface.
    pub position: Vec3,
    /// Distance from the eye.
    pub distance: f32,
    /// Unit normal for shading.
    pub normal: Vec3,
    /// Index of the scene's polygon, or none.
    polygon: u32,
}

impl Place {
    /// Whether a surface is seen.
    #[inline]
    pub fn is_seen(&self) -> bool {
        self.polygon != NOTHING
    }

    /// Whether two samples see the same polygon.
    #[inline]
    pub fn is_beside(&self, other: &Self) -> bool {
        self.polygon == other.polygon
    }
}

impl VisibleSurface {
    const NOTHING: Self = Self {
        position: Vec3::ZERO,
        distance: f32::INFINITY,
        normal: Vec3::ZERO,
        face: Vec3::ZERO,
        reflectance: Vec3::ZERO,
        emission: Vec3::ZERO,
        polygon: NOTHING,
    };

    /// Surface that is seen along a ray, holes of textures looked through; `spacing` is the
    /// distance between samples as a share of that from the eye.
    fn along(field: &Field, eye: Vec3, direction: Vec3, spacing: f32) -> Self {
        let scene = field.scene();
        let mut from = eye;
        for _ in 0..MOST_HOLES {
            let Some(hit) = field.look_along(from, direction) else { break };
            let polygon = &scene.polygons[hit.polygon as usize];
            let distance = hit.point.distance(eye);
            let mean = *field.surface(hit.polygon);
            if let Some(surface) = scene.surface_at(polygon, hit.point, mean, spacing * distance) {
                return Self {
                    position: hit.point,
                    distance,
                    normal: scene.smooth_normal(polygon, hit.point),
                    face: field.normal(hit.polygon),
                    reflectance: surface.reflectance,
                    emission: surface.emission,
                    polygon: hit.polygon,
                };
            }
            from = hit.point + direction * (distance * BEYOND_HOLE);
        }
        // A radiance as the radiosity of what would look so.
        Self { emission: PI * field.sky_seen(direction), ..Self::NOTHING }
    }

    /// A place on a polygon, seen from this far away.
    #[cfg(test)]
    pub(super) fn on(polygon: u32, position: Vec3, normal: Vec3, distance: f32) -> Self {
        Self { position, distance, normal, face: normal, polygon, ..Self::NOTHING }
    }

    /// The polygon seen.
    pub fn polygon(&self) -> Option<u32> {
        (self.polygon != NOTHING).then_some(self.polygon)
    }

    /// The place alone.
    pub(super) fn place(&self) -> Place {
        Place { position: self.position, distance: self.distance, normal: self.normal, polygon: self.polygon }
    }
}

/// The samples of a picture, two in each direction a pixel or one.
#[derive(Clone, Debug)]
pub struct VisibleSurfaces {
    /// Width and height, samples.
    pub size: [u32; 2],
    /// Samples a pixel in each direction: 1 or 2.
    pub per_side: u32,
    /// Distance between samples in the middle of the picture, as a share of the distance from the
    /// eye.
    pub spacing: f32,
    /// Rows from above.
    pub all: Vec<VisibleSurface>,
}

impl VisibleSurfaces {
    /// Looks through a lens at a picture of so many pixels; `None` if cancelled.
    pub fn look(field: &Field, lens: &Lens, pixels: [u32; 2], per_side: u32, cancel: &CancelToken) -> Option<Self> {
        let size = pixels.map(|side| side * per_side);
        let mut all = vec![VisibleSurface::NOTHING; size[0] as usize * size[1] as usize];
        let place = |sample: u32, other: u32, axis: usize| match per_side {
            1 => sample as f32 + 0.5,
            _ => {
                let [x, y] = if axis == 0 { [sample, other] } else { [other, sample] };
                let within: Vec2 = PLACES[(y % 2) as usize][(x % 2) as usize];
                (sample / 2) as f32 + within[axis]
            }
        };
        let spacing = 2.0 * lens.right.length() / size[0] as f32;
        let rows = all.par_chunks_exact_mut(size[0].max(1) as usize).enumerate();
        rows.for_each(|(row, visible)| {
            if cancel.is_cancelled() {
                return;
            }
            let row = row as u32;
            for (column, surface) in visible.iter_mut().enumerate() {
                let column = column as u32;
                let [x, y] = [place(column, row, 0) / pixels[0] as f32, place(row, column, 1) / pixels[1] as f32];
                let direction = lens.direction(Vec2::new(2.0 * x - 1.0, 1.0 - 2.0 * y));
                *surface = VisibleSurface::along(field, lens.eye, direction, spacing);
            }
        });
        (!cancel.is_cancelled()).then_some(Self { size, per_side, spacing, all })
    }

    /// The samples in the middle of squares of so many in each direction.
    pub fn thinned(&self, step: u32) -> Self {
        let [width, height] = self.size;
        let size = [width.div_ceil(step), height.div_ceil(step)];
        let place = |index: u32, limit: u32| (index * step + step / 2).min(limit - 1);
        let at = |row: u32, column: u32| self.all[(place(row, height) * width + place(column, width)) as usize];
        let all = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| at(row, column))).collect();
        Self { size, per_side: self.per_side, spacing: self.spacing * step as f32, all }
    }
}
