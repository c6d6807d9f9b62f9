//! Key of a reference: a hash of all that its values depend on.

use glam::Vec3;
use sha2::{Digest, Sha256};

use super::points::SurfacePoint;
use super::sums::{BATCH, PILOT};
use crate::scene::Scene;

/// Goes up with every change of what a path computes or of the file's layout.
pub(super) const VERSION: u32 = 3;
/// The first bytes of a file.
pub(super) const MAGIC: &[u8; 8] = b"slnkref\n";
/// Bytes of a hash.
pub(super) const HASH: usize = 32;
/// A hash of all that a reference's values depend on: the polygons as they are turned and doubled,
/// reflectances, emissions, the outside, points, seed, and the version of the method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key(pub(super) [u8; HASH]);

impl Key {
    /// The key of a reference for these points.
    pub fn of(scene: &Scene, points: &[SurfacePoint], seed: u64) -> Self {
        let mut hash = Sha256::new();
        hash.update(MAGIC);
        hash.update(VERSION.to_le_bytes());
        hash.update(BATCH.to_le_bytes());
        hash.update(PILOT.to_le_bytes());
        hash.update(seed.to_le_bytes());
        hash.update((scene.polygons.len() as u64).to_le_bytes());
        for polygon in &scene.polygons {
            let (corners, count) = scene.corner_positions(polygon);
            let surface = scene.surface(polygon);
            hash.update([count as u8, u8::from(polygon.is_back)]);
            for vector in corners[..count].iter().chain([&surface.reflectance, &surface.emission]) {
                update(&mut hash, *vector);
            }
        }
        if let Some(outside) = scene.outside() {
            // A scene that has none keeps its key.
            hash.update(b"outside");
            for direction in probes() {
                update(&mut hash, outside.radiance(direction));
            }
            for vector in outside.sun().iter().flat_map(|sun| [sun.direction, sun.irradiance]) {
                update(&mut hash, vector);
            }
        }
        hash.update((points.len() as u64).to_le_bytes());
        for point in points {
            hash.update(point.polygon.to_le_bytes());
            hash.update(point.weight.to_le_bytes());
            for vector in [point.position, point.normal, point.reflectance] {
                update(&mut hash, vector);
            }
        }
        Self(hash.finalize().into())
    }

    pub(super) fn name(&self) -> String {
        self.0[..16].iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Directions all around, by whose radiances skies are distinguished.
fn probes() -> impl Iterator<Item = Vec3> {
    const COUNT: usize = 20_000;
    (0..COUNT).map(|index| {
        let height = 1.0 - (2 * index + 1) as f32 / COUNT as f32;
        let (sine, cosine) = (2.399_963_2 * index as f32).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        Vec3::new(radius * cosine, radius * sine, height)
    })
}

fn update(hash: &mut Sha256, vector: Vec3) {
    for value in vector.to_array() {
        hash.update(value.to_bits().to_le_bytes());
    }
}
