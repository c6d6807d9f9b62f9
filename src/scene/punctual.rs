//! Lights that are points in a file, as small emitters (KHR_lights_punctual).
//!
//! A point light becomes a sphere of [`RADIUS`] made of 180 triangles, whose projected area, and so
//! its luminous intensity, differs from the sphere's by less than 0.8 % in any direction. A spot
//! light is such a sphere in a black cup: seen from within the inner cone the cup's rim hides
//! nothing, outside of the outer cone everything, and between them a growing part. So its cone is
//! kept by geometry, by every estimator alike.

use glam::{DMat4, DVec3, Vec3};

use super::draft::{Draft, DraftMaterial};
use super::outside::{Amount, Axes, Daylight, SunSpec};
use super::place::is_usable;
use super::{FileLight, GroupId, MaterialId, Scene, sanitize};
use crate::base::photometry::LUMENS_PER_WATT;

/// Radius of a point light's sphere, m: at 1 m it is as good as a point.
const RADIUS: f64 = 0.01;

/// Radius of a spot light's sphere, m; its cup is up to some decimetres long.
const SPOT_RADIUS: f64 = 0.004;

/// Corners of a cup's rim.
const RIM: usize = 32;

/// The narrowest seam between a spot light's cones, radians; a narrower one would need a longer
/// cup.
const LEAST_SEAM: f64 = 0.04;

/// A spot light's outer half angle at most, radians: a cup is open on one side.
const WIDEST_CONE: f64 = std::f64::consts::FRAC_PI_2;

/// A point or spot light of a file.
pub(super) struct PunctualLight {
    pub name: String,
    pub group: GroupId,
    /// To the scene from where the light shines along −z.
    pub world: DMat4,
    /// Luminous intensity per colour, cd.
    pub candelas: Vec3,
    pub range: Option<f32>,
    /// Half angles of a spot light's cone, inner and outer, radians.
    pub cone: Option<[f32; 2]>,
}

/// A directional light of a file.
pub(super) struct DirectionalLight {
    pub name: String,
    /// Unit vector towards where it comes from.
    pub towards: DVec3,
    /// Illuminance of a face turned to it per colour, lx.
    pub lux: Vec3,
}

/// Makes the brightest directional light above the horizon the scene's sun; the others are left
/// out.
pub(super) fn add_sun(scene: &mut Scene, mut suns: Vec<DirectionalLight>) {
    let axes = Axes::with_up(scene.up_axis());
    let brightness = |sun: &DirectionalLight| {
        if axes.angles(sun.towards)[1] > 0.0 { crate::base::photometry::weighted(sun.lux.into()) } else { 0.0 }
    };
    suns.sort_by(|a, b| brightness(b).total_cmp(&brightness(a)));
    let shining = suns.first().is_some_and(|sun| brightness(sun) > 0.0);
    if shining {
        let sun = suns.remove(0);
        let [azimuth, elevation] = axes.angles(sun.towards);
        let amount = Some(Amount::Lux(brightness(&sun)));
        let colour = sun.lux / sun.lux.max_element();
        let spec = SunSpec { colour, ..SunSpec::at(azimuth, elevation, amount) };
        if let Err(error) = scene.add_daylight(&Daylight { sky: None, sun: Some(spec) }) {
            scene.skipped.note(error.to_string());
        }
    }
    if !suns.is_empty() {
        let names = sanitize::list(suns.iter().map(|sun| sanitize::name(&sun.name)), 5);
        scene.skipped.ignored_lights = suns.len();
        let why = if shining { "the brightest alone is the sun" } else { "they shine from below or not at all" };
        scene.skipped.note(format!("Directional lights are left out, for {why}: {names}."));
    }
}

/// Makes emitters of a draft's lights; each has a material of its own.
pub(super) fn add_emitters(draft: &mut Draft) -> Vec<FileLight> {
    let lights = std::mem::take(&mut draft.lights);
    let mut cup = None;
    let mut made = Vec::with_capacity(lights.len());
    for light in lights {
        let radius = if light.cone.is_some() { SPOT_RADIUS } else { RADIUS };
        let centre = light.world.transform_point3(DVec3::ZERO);
        if !is_usable(centre) {
            draft
                .skipped
                .note(format!("The light {} lies too far off and is left out.", sanitize::quoted(&light.name)));
            continue;
        }
        let material = draft.materials.len() as u32;
        // I = L·πr² and B_e = πL.
        let emission = light.candelas / LUMENS_PER_WATT / (radius * radius) as f32;
        draft.materials.push(DraftMaterial { emission, ..DraftMaterial::new(&light.name) });
        for corners in sphere() {
            add(draft, corners.map(|corner| centre + radius * corner), material, light.group);
        }
        if let Some(cone) = light.cone {
            let material = *cup.get_or_insert_with(|| {
                draft.materials.push(DraftMaterial::new("spot light's cup"));
                draft.materials.len() as u32 - 1
            });
            let axis = light.world.transform_vector3(-DVec3::Z).normalize_or(-DVec3::Y);
            add_cup(draft, centre, axis, cone.map(f64::from), material, light.group);
        }
        made.push(FileLight {
            name: light.name,
            material: MaterialId(material),
            candelas: light.candelas,
            range: light.range,
            cone: light.cone,
        });
    }
    made
}

fn add<const N: usize>(draft: &mut Draft, corners: [DVec3; N], material: u32, group: GroupId) {
    let first = draft.vertices.len() as u32;
    draft.vertices.extend(corners);
    draft.add_face(&std::array::from_fn::<u32, N, _>(|corner| first + corner as u32), material, group);
}

/// The cup around a spot light's sphere, open along `axis`.
fn add_cup(draft: &mut Draft, centre: DVec3, axis: DVec3, [inner, outer]: [f64; 2], material: u32, group: GroupId) {
    let outer = outer.clamp(LEAST_SEAM, WIDEST_CONE);
    let inner = inner.clamp(0.0, outer);
    // The rim is seen from the sphere's middle under the mean angle; it covers the sphere's disc
    // while the angle changes by twice `half`.
    let middle = 0.5 * (inner + outer);
    let half = (0.5 * (outer - inner)).clamp(0.5 * LEAST_SEAM, 0.9 * middle);
    let distance = SPOT_RADIUS / half.sin();
    let (along, width) = (distance * middle.cos(), distance * middle.sin());
    let (right, up) = axis.any_orthonormal_pair();
    let back = -1.5 * SPOT_RADIUS;
    let ring = |height: f64, radius: f64, step: usize| {
        let angle = std::f64::consts::TAU * (step % RIM) as f64 / RIM as f64;
        centre + height * axis + radius * (angle.cos() * right + angle.sin() * up)
    };
    // A polygon of the circle's area.
    let width = width * (std::f64::consts::TAU / RIM as f64 / (std::f64::consts::TAU / RIM as f64).sin()).sqrt();
    let rear = width.max(1.5 * SPOT_RADIUS);
    for step in 0..RIM {
        let [low, next_low] = [step, step + 1].map(|step| ring(back, rear, step));
        let [high, next_high] = [step, step + 1].map(|step| ring(along, width, step));
        // Black on both sides: light from the room comes in too.
        for is_inner in [false, true] {
            let mut wall = [low, next_low, next_high, high];
            let mut floor = [centre + back * axis, next_low, low];
            if is_inner {
                wall.reverse();
                floor.reverse();
            }
            add(draft, wall, material, group);
            add(draft, floor, material, group);
        }
    }
}

/// A unit sphere of 180 triangles: an icosahedron whose edges are cut in three, facing outwards.
fn sphere() -> impl Iterator<Item = [DVec3; 3]> {
    let ring = |height: f64, step: usize, turned: f64| {
        let angle = std::f64::consts::TAU * ((step % 5) as f64 + turned) / 5.0;
        DVec3::new(2.0 * angle.cos(), 2.0 * angle.sin(), height) / 5.0_f64.sqrt()
    };
    let icosahedron = (0..5).flat_map(move |step| {
        let [a, b] = [step, step + 1].map(|step| ring(1.0, step, 0.0));
        let [c, d] = [step, step + 1].map(|step| ring(-1.0, step, 0.5));
        [[DVec3::Z, a, b], [a, c, b], [b, c, d], [-DVec3::Z, d, c]]
    });
    icosahedron.flat_map(|[a, b, c]| {
        let point = move |i: i32, j: i32| (a * f64::from(3 - i - j) + b * f64::from(i) + c * f64::from(j)).normalize();
        let up = (0..3).flat_map(move |i| (0..3 - i).map(move |j| [point(i, j), point(i + 1, j), point(i, j + 1)]));
        let down =
            (0..2).flat_map(move |i| (0..2 - i).map(move |j| [point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]));
        up.chain(down).map(rounded)
    })
}

/// A triangle pushed out so that it belongs to a body of the unit sphere's mean projected area.
fn rounded(corners: [DVec3; 3]) -> [DVec3; 3] {
    // A convex body's mean projected area is a quarter of its surface (Cauchy): the root of 4π over
    // the sum of the 180 triangles.
    const SCALE: f64 = 1.016_963_4;
    corners.map(|corner| SCALE * corner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: Cauchy's theorem for the mean, and the sphere's disc in any direction (within 0.8 %).
    #[test]
    fn the_sphere_is_as_wide_from_everywhere() {
        let areas: Vec<DVec3> = sphere().map(|[a, b, c]| 0.5 * (b - a).cross(c - a)).collect();
        assert_eq!(areas.len(), 180);
        let whole: f64 = areas.iter().map(|area| area.length()).sum();
        assert!((whole / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4, "{}", whole / (4.0 * std::f64::consts::PI));
        assert!(sphere().all(|[a, b, c]| (b - a).cross(c - a).dot(a) > 0.0), "it faces outwards");
        for step in 0..500 {
            let z = 1.0 - (f64::from(step) + 0.5) / 250.0;
            let angle = 2.399_963 * f64::from(step);
            let radius = (1.0 - z * z).sqrt();
            let direction = DVec3::new(radius * angle.cos(), radius * angle.sin(), z);
            let seen: f64 = areas.iter().map(|area| area.dot(direction).max(0.0)).sum();
            assert!((seen / std::f64::consts::PI - 1.0).abs() < 0.008, "{direction}: {}", seen / std::f64::consts::PI);
        }
    }
}
