//! The error of a solution against a reference.
//!
//! B is compared at the reference's points, which count by the area that they stand for and do not
//! lie on lamps, both as it is read (gathered there, or interpolated between vertices) and as the
//! solver has it (one constant per leaf). The squares of the reference's own standard errors are
//! subtracted, so that its noise is not taken for an error of the solution. The points are a sample
//! of the surfaces, so every error has a standard error of its own.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use super::local_error::{Compared, LocalError};
use super::locate::{Place, locate};
use super::spread::{of_quantile, of_root, quantile, sorted};
use crate::gather::{Field, NOISE};
use crate::measure::reference::{Reference, SurfacePoint};
use crate::solve::{Mesh, Snapshot};

/// Points darker than this share of the RMS radiosity count as that bright in local errors:
/// relative to nothing, all is wrong.
const DARKEST: f64 = 1e-4;

/// Standard error of what is read at a point, as a share of the light there.
const READING_ERROR: f32 = 0.02;

/// The error of one way to read a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measure {
    /// RMS of the difference in B over the area, all colours together, over the RMS of B; the
    /// reference's noise is subtracted.
    pub rms: f64,
    /// Standard error of `rms`, in the same unit: what other random points, and another reference
    /// of the same noise, would change in it. By the jackknife over the points \[Efron, Stein
    /// 1981\]: where few points hold most of the squared error it is about as large as `rms`, and
    /// what no point has met it does not know. Where `below_noise`, the error that may hide there.
    /// Infinite where only one point was compared.
    pub rms_noise: f64,
    /// Whether the difference is within the reference's noise, so that `rms` is 0 for want of a
    /// better reference.
    pub below_noise: bool,
    /// Mean difference over the mean of B per colour; positive where the solution is too bright.
    pub bias_rgb: [f64; 3],
    /// Mean difference over the mean of B, over all colours.
    pub bias: f64,
    /// Local relative error |ΔB|/|B|, its median over the area.
    pub local_median: f64,
    /// Standard error of `local_median`, in the same unit: half the distance between the local
    /// errors of rank n/2 ± √n/2, for as many points as would say as much if all counted alike.
    /// Infinite where only one point was compared.
    pub local_median_noise: f64,
    /// The local error's 95th percentile.
    pub local_p95: f64,
    /// Median of the local error over the darker half of the area.
    pub dark_median: f64,
    /// 95th percentile of the local error over the darker half of the area.
    pub dark_p95: f64,
}

/// The error of a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SolutionError {
    /// Of what is read: gathered at the point, or interpolated between vertices where there is no
    /// gather.
    pub displayed: Measure,
    /// Of the leaves' constants.
    pub leaves: Measure,
    /// The local error of E as it is read.
    pub local: LocalError,
    /// Relative RMS noise of the reference itself.
    pub reference_noise: f64,
    /// Points compared.
    pub points: usize,
}

/// Measures snapshots against one reference; remembers where its points lie as long as the mesh
/// stays.
pub struct ErrorMeter {
    reference: Arc<Reference>,
    located: Option<(Arc<Mesh>, Vec<Option<Place>>)>,
}

impl ErrorMeter {
    /// A meter for this reference, whose points should be
    /// [`crate::measure::reference::random_points`].
    pub fn new(reference: Arc<Reference>) -> Self {
        Self { reference, located: None }
    }

    /// The reference.
    pub fn reference(&self) -> &Arc<Reference> {
        &self.reference
    }

    /// Takes a better reference.
    pub fn set_reference(&mut self, reference: Arc<Reference>) {
        if !Arc::ptr_eq(&self.reference.points, &reference.points) {
            self.located = None;
        }
        self.reference = reference;
    }

    /// The error of a snapshot of the same scene.
    pub fn measure(&mut self, snapshot: &Snapshot) -> SolutionError {
        let displayed = self.radiosities(snapshot);
        let leaves = self.leaf_radiosities(snapshot);
        let reference = &*self.reference;
        let samples = |values: &[Option<DVec3>]| {
            let of = |(index, value): (usize, &Option<DVec3>)| {
                let (truth, noise) = (reference.radiosity(index), reference.radiosity_error(index));
                let weight = f64::from(reference.points[index].weight);
                value.map(|value| Sample { truth, noise, difference: value - truth, weight })
            };
            values.iter().enumerate().filter_map(of).collect::<Vec<_>>()
        };
        let (displayed, leaves) = (samples(&displayed), samples(&leaves));
        SolutionError {
            reference_noise: reference.noise(),
            points: displayed.len(),
            local: self.local_error(snapshot),
            displayed: measure(&displayed),
            leaves: measure(&leaves),
        }
    }

    /// B as it is read at each point, W/m²: gathered there, or interpolated where there is no field
    /// to gather over; `None` where the mesh does not have the point's polygon.
    pub fn radiosities(&mut self, snapshot: &Snapshot) -> Vec<Option<DVec3>> {
        if let Some(field) = &snapshot.field {
            let reflect = |(irradiance, point): (Vec3, &SurfacePoint)| {
                let surface = field.surface(point.polygon);
                Some((surface.emission + surface.reflectance * irradiance).as_dvec3())
            };
            return self.read(field, snapshot.stats.error_asked).zip(&self.reference.points[..]).map(reflect).collect();
        }
        self.interpolated(&snapshot.mesh, &snapshot.vertex_radiosity)
    }

    /// E as it is read at each point, W/m², likewise.
    pub fn irradiances(&mut self, snapshot: &Snapshot) -> Vec<Option<DVec3>> {
        if let Some(field) = &snapshot.field {
            let read = self.read(field, snapshot.stats.error_asked);
            return read.map(|irradiance| Some(irradiance.as_dvec3())).collect();
        }
        self.interpolated(&snapshot.mesh, &snapshot.vertex_irradiance)
    }

    /// The local error of E as it is read.
    pub fn local_error(&mut self, snapshot: &Snapshot) -> LocalError {
        let displayed = self.irradiances(snapshot);
        let compared =
            |(index, value): (usize, &Option<DVec3>)| value.map(|value| Compared::new(&self.reference, index, value));
        LocalError::of(&displayed.iter().enumerate().filter_map(compared).collect::<Vec<_>>())
    }

    /// Readings of a field at each point.
    fn read(&self, field: &Field, asked: Option<f64>) -> impl Iterator<Item = Vec3> + use<> {
        let error = asked.map_or(READING_ERROR, |asked| READING_ERROR.min((NOISE * asked) as f32));
        let read = |point: &SurfacePoint| field.read(point.polygon, point.position, error).mean;
        self.reference.points.par_iter().map(read).collect::<Vec<_>>().into_iter()
    }

    /// Values of the vertices at each point.
    fn interpolated(&mut self, mesh: &Arc<Mesh>, values: &[[f32; 3]]) -> Vec<Option<DVec3>> {
        let triangles = mesh.clone();
        if values.len() != mesh.positions.len() {
            // A snapshot without irradiances is no picture of any.
            return vec![None; self.reference.points.len()];
        }
        let at = |place: &Place| {
            let corners = triangles.triangles[place.triangle as usize].map(|vertex| vertex as usize);
            let [a, b, c] = corners.map(|vertex| Vec3::from(values[vertex]).as_dvec3());
            let weights = place.weights.as_dvec3();
            weights.x * a + weights.y * b + weights.z * c
        };
        self.places(mesh).iter().map(|place| place.as_ref().map(at)).collect()
    }

    /// Signed relative error of what is displayed at each point, colours together, (ΣB − ΣB*)/ΣB*;
    /// NaN where the mesh does not have the point's polygon.
    pub fn relative_differences(&mut self, snapshot: &Snapshot) -> Vec<f32> {
        let displayed = self.radiosities(snapshot);
        let truths: Vec<f64> =
            (0..displayed.len()).map(|index| self.reference.radiosity(index).element_sum()).collect();
        let square = |(point, truth): (&SurfacePoint, &f64)| f64::from(point.weight) * truth * truth;
        let squares: f64 = self.reference.points.iter().zip(&truths).map(square).sum();
        let darkest = DARKEST * (squares / truths.len().max(1) as f64).sqrt();
        let relative = |(value, truth): (Option<DVec3>, &f64)| {
            value.map_or(f32::NAN, |value| {
                ((value.element_sum() - truth) / truth.max(darkest.max(f64::MIN_POSITIVE))) as f32
            })
        };
        displayed.into_iter().zip(&truths).map(relative).collect()
    }

    fn leaf_radiosities(&mut self, snapshot: &Snapshot) -> Vec<Option<DVec3>> {
        let mesh = snapshot.mesh.clone();
        let at = |place: &Place| {
            let leaf = mesh.triangle_leaf[place.triangle as usize] as usize;
            Vec3::from(snapshot.leaf_radiosity[leaf]).as_dvec3()
        };
        self.places(&snapshot.mesh).iter().map(|place| place.as_ref().map(at)).collect()
    }

    fn places(&mut self, mesh: &Arc<Mesh>) -> &[Option<Place>] {
        let stale = self.located.as_ref().is_none_or(|(known, _)| !Arc::ptr_eq(known, mesh));
        if stale {
            self.located = Some((mesh.clone(), locate(&self.reference.points, mesh)));
        }
        self.located.as_ref().map_or(&[], |(_, places)| places)
    }
}

/// One point compared, W/m².
struct Sample {
    truth: DVec3,
    noise: DVec3,
    difference: DVec3,
    /// Weight of the point.
    weight: f64,
}

/// The error of an estimate of which each point is off by its own standard error: the RMS error of
/// an unbiased one, such as a path tracer's.
pub fn of_standard_errors(estimate: &Reference) -> Measure {
    let sample = |index: usize| Sample {
        truth: estimate.radiosity(index),
        noise: DVec3::ZERO,
        difference: estimate.radiosity_error(index),
        weight: f64::from(estimate.points[index].weight),
    };
    measure(&(0..estimate.points.len()).map(sample).collect::<Vec<_>>())
}

fn measure(samples: &[Sample]) -> Measure {
    let sum = |of: &dyn Fn(&Sample) -> DVec3| samples.iter().map(|sample| sample.weight * of(sample)).sum::<DVec3>();
    let squares = sum(&|sample| sample.difference * sample.difference);
    let noise = sum(&|sample| sample.noise * sample.noise);
    let signal = sum(&|sample| sample.truth * sample.truth);
    let (difference, mean) = (sum(&|sample| sample.difference), sum(&|sample| sample.truth));
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    let weight: f64 = samples.iter().map(|sample| sample.weight).sum();
    let darkest = DARKEST * if weight > 0.0 { (signal.element_sum() / weight).sqrt() } else { 0.0 };
    let mut by_brightness: Vec<&Sample> = samples.iter().collect();
    by_brightness.sort_by(|a, b| a.truth.length().total_cmp(&b.truth.length()));
    let locals = |part: &[&Sample]| sorted(part.iter().map(|sample| (sample.local(darkest), sample.weight)));
    let (half, all) = (locals(darker_half(&by_brightness)), locals(&by_brightness));
    let excess = |sample: &Sample| sample.difference.length_squared() - sample.noise.length_squared();
    let of_point = |sample: &Sample| (sample.weight * excess(sample), sample.weight * sample.truth.length_squared());
    let points: Vec<(f64, f64)> = samples.iter().map(of_point).collect();
    let (squares, noise, signal) = (squares.element_sum(), noise.element_sum(), signal.element_sum());
    Measure {
        rms: if signal > 0.0 { ((squares - noise).max(0.0) / signal).sqrt() } else { 0.0 },
        rms_noise: of_root(&points),
        below_noise: squares <= noise,
        bias_rgb: [0, 1, 2].map(|colour| share(difference[colour], mean[colour])),
        bias: share(difference.element_sum(), mean.element_sum()),
        local_median: quantile(&all, 0.5),
        local_median_noise: of_quantile(&all, 0.5),
        local_p95: quantile(&all, 0.95),
        dark_median: quantile(&half, 0.5),
        dark_p95: quantile(&half, 0.95),
    }
}

impl Sample {
    /// The relative error beyond the noise.
    fn local(&self, darkest: f64) -> f64 {
        let beyond = (self.difference.length_squared() - self.noise.length_squared()).max(0.0).sqrt();
        if beyond > 0.0 { beyond / self.truth.length().max(darkest) } else { 0.0 }
    }
}

/// The first of these that hold half of the weight.
fn darker_half<'a>(by_brightness: &'a [&'a Sample]) -> &'a [&'a Sample] {
    let half = 0.5 * by_brightness.iter().map(|sample| sample.weight).sum::<f64>();
    let mut sum = 0.0;
    let is_within = |sample: &&Sample| {
        let begins_below = sum < half;
        sum += sample.weight;
        begins_below
    };
    let count = by_brightness.iter().copied().take_while(is_within).count();
    &by_brightness[..count]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(truth: f64, difference: f64, noise: f64) -> Sample {
        let [truth, difference, noise] = [truth, difference, noise].map(|value| DVec3::new(value, 0.0, 0.0));
        Sample { truth, noise, difference, weight: 1.0 }
    }

    /// Truth: worked out by hand. Nine points of B = 1 that are right and one of B = 4 that is 2
    /// too bright, noise ½ there: RMS √((4 − ¼)/25), bias 2/13.
    #[test]
    fn the_noise_is_subtracted_and_the_bias_has_a_sign() {
        let mut samples: Vec<Sample> = (0..9).map(|_| sample(1.0, 0.0, 0.0)).collect();
        samples.push(sample(4.0, 2.0, 0.5));
        let found = measure(&samples);
        assert!((found.rms - (3.75_f64 / 25.0).sqrt()).abs() < 1e-12, "{found:?}");
        assert!((found.bias - 2.0 / 13.0).abs() < 1e-12 && found.bias_rgb[1] == 0.0, "{found:?}");
        assert_eq!((found.local_median, found.dark_p95), (0.0, 0.0));
        assert!((found.local_p95 - 3.75_f64.sqrt() / 4.0).abs() < 1e-12, "{found:?}");
        assert!(!found.below_noise);
        // One point holds the whole error: without it there is none, and without another it grows
        // by next to nothing.
        assert!((0.9..1.1).contains(&(found.rms_noise / found.rms)), "{found:?}");
        let found = measure(&[sample(1.0, 0.1, 0.2), sample(1.0, -0.1, 0.2)]);
        assert_eq!((found.rms, found.below_noise), (0.0, true));
        // Both squares are −0.03, alike without either, so that nothing hides there.
        assert!(found.rms_noise < 1e-6, "{found:?}");
        assert_eq!(measure(&[]), Measure { below_noise: true, ..Measure::default() });
        let found = measure(&[sample(1.0, 0.1, 0.0)]);
        assert_eq!((found.rms_noise, found.local_median_noise), (f64::INFINITY, f64::INFINITY), "{found:?}");
    }

    /// Truth: the definition. A point of weight 3 is three points, in means, medians and the darker
    /// half alike.
    #[test]
    fn a_weight_is_so_many_points() {
        let of = |weights: [usize; 3], counts: [usize; 3]| {
            let kinds = [(1.0, 0.1), (2.0, 0.4), (7.0, 0.7)];
            let samples =
                kinds.into_iter().zip(weights).zip(counts).flat_map(|(((truth, difference), weight), count)| {
                    (0..count).map(move |_| Sample { weight: weight as f64, ..sample(truth, difference, 0.0) })
                });
            let found = measure(&samples.collect::<Vec<_>>());
            [found.rms, found.bias, found.local_median, found.local_p95, found.dark_median, found.dark_p95]
        };
        let [weighted, counted] = [of([5, 3, 1], [2, 2, 2]), of([1, 1, 1], [10, 6, 2])];
        assert!(
            weighted.iter().zip(&counted).all(|(one, other)| (one - other).abs() < 1e-12),
            "{weighted:?} {counted:?}"
        );
    }

    /// Truth: the definition. A dark room behind a bright one that is wholly wrong hardly shows in
    /// the RMS.
    #[test]
    fn a_dark_room_that_is_wrong_shows_in_the_darker_half() {
        let bright = (0..60).map(|_| sample(1.0, 0.001, 0.0));
        let dark = (0..40).map(|_| sample(1e-3, 1e-3, 0.0));
        let found = measure(&bright.chain(dark).collect::<Vec<_>>());
        assert!(found.rms < 0.002 && found.dark_median == 1.0 && found.local_p95 == 1.0, "{found:?}");
        assert!((found.local_median - 0.001).abs() < 1e-9, "{found:?}");
    }
}
