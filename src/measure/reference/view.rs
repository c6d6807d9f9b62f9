//! A picture by paths: from the eye through places in each pixel, one path from what each of these
//! rays sees.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::path::Tracer;
use super::sequence::{Sequence, hash64};
use super::surfaces::Vertex;
use crate::base::cancel::CancelToken;
use crate::scene::Scene;

/// The pair of numbers that is the place in a pixel: no path uses it.
const PLACE: u32 = u32::MAX;
/// Holes of textures that a ray passes, at most.
const MOST_HOLES: u32 = 64;

/// Rays through the pixels of a picture.
pub struct View<F> {
    /// Where the eye is.
    pub eye: Vec3,
    /// Unit direction through a place of the picture, both coordinates 0..1 from its upper left
    /// corner.
    pub direction: F,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Width over which a texture is averaged, as a share of the distance from the eye.
    pub spacing: f32,
}

/// Means over the samples of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewPixel {
    /// Radiosity B of surfaces and π times the radiance of the sky, W/m²; multiplied by the
    /// coverage.
    pub radiosity: DVec3,
    /// Irradiance E where surfaces that are no lamps are seen, W/m².
    pub irradiance: DVec3,
    /// Share of the samples that see a surface or a bright sky.
    pub coverage: f64,
    /// Share of the samples that see a surface that is no lamp.
    pub receiving: f64,
}

/// Sums over the samples of a pixel.
#[derive(Clone, Copy, Default)]
struct Sums {
    radiosity: DVec3,
    irradiance: DVec3,
    covered: u32,
    receiving: u32,
}

/// A picture in the making.
pub struct ViewRun<'a, F> {
    scene: &'a Scene,
    tracer: Tracer,
    view: View<F>,
    seed: u64,
    passes: u32,
    samples: u32,
    sums: Vec<Sums>,
}

impl<'a, F: Fn([f32; 2]) -> Vec3 + Sync> ViewRun<'a, F> {
    /// A picture without samples, of a scene whose faces are turned and doubled as it is solved.
    pub fn new(scene: &'a Scene, view: View<F>, seed: u64) -> Self {
        let sums = vec![Sums::default(); view.size[0] as usize * view.size[1] as usize];
        Self { scene, tracer: Tracer::new(scene), view, seed, passes: 0, samples: 0, sums }
    }

    /// Adds so many samples to each pixel, a power of two, stratified among themselves; false if
    /// cancelled, which spoils the picture.
    ///
    /// The result is the same bit for bit for any number of threads.
    pub fn pass(&mut self, samples: u32, cancel: &CancelToken) -> bool {
        let seed = hash64(self.seed, u64::from(self.passes));
        let Self { scene, tracer, view, sums, .. } = &mut *self;
        let (scene, tracer, view) = (*scene, &*tracer, &*view);
        sums.par_iter_mut().enumerate().for_each(|(pixel, sums)| {
            if !cancel.is_cancelled() {
                let seed = hash64(seed, pixel as u64);
                for index in 0..samples {
                    sample(scene, tracer, view, pixel, &Sequence::new(seed, index, samples), sums);
                }
            }
        });
        self.passes += 1;
        self.samples += samples;
        !cancel.is_cancelled()
    }

    /// Samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The pixels, rows from above.
    pub fn pixels(&self) -> Vec<ViewPixel> {
        let all = f64::from(self.samples.max(1));
        let mean = |sums: &Sums| ViewPixel {
            radiosity: sums.radiosity / all,
            irradiance: sums.irradiance / f64::from(sums.receiving.max(1)),
            coverage: f64::from(sums.covered) / all,
            receiving: f64::from(sums.receiving) / all,
        };
        self.sums.iter().map(mean).collect()
    }
}

/// Adds a sample to a pixel.
fn sample<F: Fn([f32; 2]) -> Vec3>(
    scene: &Scene,
    tracer: &Tracer,
    view: &View<F>,
    pixel: usize,
    random: &Sequence,
    sums: &mut Sums,
) {
    let [width, height] = view.size;
    let (x, y) = (pixel as u32 % width, pixel as u32 / width);
    let [u, v] = random.even(PLACE);
    let direction = (view.direction)([(x as f32 + u) / width as f32, (y as f32 + v) / height as f32]);
    let (eye, along) = (view.eye.as_dvec3(), direction.as_dvec3().normalize());
    let mut from = Vertex::in_the_air(eye, along);
    for _ in 0..MOST_HOLES {
        let Some(met) = tracer.surfaces.look(&from, along) else { break };
        let (polygon, point) = (&scene.polygons[met.polygon as usize], met.position.as_vec3());
        let footprint = view.spacing * met.position.distance(eye) as f32;
        let Some(surface) = scene.surface_at(polygon, point, scene.surface(polygon), footprint) else {
            from = met.behind();
            continue;
        };
        let shading = scene.smooth_normal(polygon, point).as_dvec3().normalize_or(met.normal);
        let irradiance = tracer.path(met.shaded(shading), random);
        sums.radiosity += surface.emission.as_dvec3() + surface.reflectance.as_dvec3() * irradiance;
        sums.covered += 1;
        if surface.emission == Vec3::ZERO {
            sums.irradiance += irradiance;
            sums.receiving += 1;
        }
        return;
    }
    let sky = scene.outside().map_or(Vec3::ZERO, |outside| outside.seen(direction));
    if sky != Vec3::ZERO {
        sums.radiosity += PI * sky.as_dvec3();
        sums.covered += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::GroupId;

    /// Truth: E = B_e·F of a lamp of one square metre seen from the middle of the floor below it, F
    /// that of two unit squares face to face, known to four digits at their middle
    /// \[Siegel, Howell, *Thermal Radiation Heat Transfer*, configuration B-3, four quarters\]; a
    /// black surface looked at through a dark side reflects nothing and shows the lamp's own light.
    #[test]
    fn lamps_and_floors_are_seen_as_bright_as_they_are() {
        let mut scene = Scene::new("lamp over a floor");
        let floor = scene.add_material("floor", Vec3::splat(0.5), Vec3::ZERO);
        let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0));
        let [low, high] = [-0.5, 0.5];
        let square = |z: f32| [[low, low], [high, low], [high, high], [low, high]].map(|[x, y]| Vec3::new(x, y, z));
        scene.add_quad(square(0.0), floor, GroupId(0));
        let [a, b, c, d] = square(1.0);
        scene.add_quad([a, d, c, b], lamp, GroupId(0));
        // From above, through the dark side of the lamp, at the middle of the floor; and from below
        // the lamp at it.
        let look = |eye: Vec3, down: f32| {
            let direction = move |_: [f32; 2]| Vec3::new(0.0, 0.0, down);
            let view = View { eye, direction, size: [1, 1], spacing: 1e-3 };
            let mut run = ViewRun::new(&scene, view, 3);
            assert!(run.pass(1 << 14, &CancelToken::new()) && run.samples() == 1 << 14);
            run.pixels()[0]
        };
        let seen = look(Vec3::new(0.0, 0.0, 2.0), -1.0);
        // A quarter of a lamp of sides 1/2 at distance 1: x = y = 1/2.
        let root = 1.25_f64.sqrt();
        let factor = 4.0 / (2.0 * PI) * 2.0 * (0.5 / root * (0.5 / root).atan());
        // The noise of 16,384 stratified paths is far below 1 %.
        assert!((seen.irradiance.x / factor - 1.0).abs() < 0.01, "{seen:?} {factor}");
        assert!(
            (seen.radiosity - 0.5 * seen.irradiance).length() < 1e-9 && (seen.coverage, seen.receiving) == (1.0, 1.0)
        );
        let lamp = look(Vec3::new(0.0, 0.0, 0.5), 1.0);
        assert_eq!((lamp.radiosity, lamp.receiving, lamp.coverage), (DVec3::new(1.0, 2.0, 3.0), 0.0, 1.0));
        assert_eq!(look(Vec3::new(0.0, 0.0, 2.0), 1.0), ViewPixel::default());
    }
}
