//! The faces that emit, as targets of next-event estimation: picked by power, uniform by area on each.

use glam::Vec3;

use crate::scene::{Polygon, Scene};

/// A point on a lamp.
pub struct LampPoint {
    pub position: Vec3,
    /// Unit normal of the bright side.
    pub normal: Vec3,
    /// Emission B_e, W/m².
    pub emission: Vec3,
}

/// The lamps of a scene; both sides of a doubled face are lamps of their own.
pub struct Lamps {
    lamps: Vec<Lamp>,
    /// Power up to and including each lamp, W (largest colour).
    cumulative: Vec<f64>,
}

struct Lamp {
    corners: [Vec3; 4],
    count: usize,
    normal: Vec3,
    emission: Vec3,
}

impl Lamps {
    /// The lamps; `None` where nothing emits.
    pub fn new(scene: &Scene) -> Option<Self> {
        let mut lamps = Self { lamps: Vec::new(), cumulative: Vec::new() };
        let mut sum = 0.0;
        for polygon in &scene.polygons {
            let emission = scene.materials[polygon.material.0 as usize].emission;
            let power = f64::from(scene.area(polygon)) * f64::from(emission.max_element());
            if power > 0.0 {
                sum += power;
                let (corners, count) = scene.corner_positions(polygon);
                lamps.lamps.push(Lamp { corners, count, normal: scene.normal(polygon), emission });
                lamps.cumulative.push(sum);
            }
        }
        (sum > 0.0).then_some(lamps)
    }

    /// The point that three numbers in 0..1 choose.
    #[inline]
    pub fn point(&self, pick: f32, u: f32, v: f32) -> LampPoint {
        let total = self.total();
        let index = self.cumulative.partition_point(|up_to| *up_to <= total * f64::from(pick));
        let lamp = &self.lamps[index.min(self.lamps.len() - 1)];
        let position = point_on(&lamp.corners[..lamp.count], u, v);
        LampPoint { position, normal: lamp.normal, emission: lamp.emission }
    }

    /// Probability density of a point on a lamp with this emission, per area.
    #[inline]
    pub fn density(&self, emission: Vec3) -> f32 {
        (f64::from(emission.max_element()) / self.total()) as f32
    }

    fn total(&self) -> f64 {
        self.cumulative[self.cumulative.len() - 1]
    }
}

/// A point on a polygon, uniform by area; a quad is the two triangles that rays meet.
pub fn point_on_polygon(scene: &Scene, polygon: &Polygon, u: f32, v: f32) -> Vec3 {
    let (corners, count) = scene.corner_positions(polygon);
    point_on(&corners[..count], u, v)
}

fn point_on(corners: &[Vec3], u: f32, v: f32) -> Vec3 {
    match *corners {
        [a, b, c, d] if is_parallelogram([a, b, c, d]) => a + u * (b - a) + v * (d - a),
        [a, b, c, d] => {
            let (first, second) = ((b - a).cross(c - a).length(), (c - a).cross(d - a).length());
            let share = if first + second > 0.0 { first / (first + second) } else { 1.0 };
            if u < share {
                point_on_triangle([a, b, c], u / share, v)
            } else {
                point_on_triangle([a, c, d], (u - share) / (1.0 - share), v)
            }
        }
        [a, b, c] => point_on_triangle([a, b, c], u, v),
        _ => unreachable!("a polygon has three or four corners"),
    }
}

/// Such a quad keeps the evenness of the unit square.
fn is_parallelogram([a, b, c, d]: [Vec3; 4]) -> bool {
    ((b - a) - (c - d)).length_squared() < 1e-10 * (c - a).length_squared()
}

fn point_on_triangle([a, b, c]: [Vec3; 3], u: f32, v: f32) -> Vec3 {
    let root = u.sqrt();
    a + root * ((1.0 - v) * (b - a) + v * (c - a))
}
