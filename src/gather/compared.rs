//! Points that readings are compared at: where they lie, and what one look tells there.

use super::estimator::Checked;
use super::field::{Field, grey};
use crate::base::random::{hash64, r2_sequence};
use crate::hierarchy::{ElementId, SurfacePoint};

/// The mean reflectance counts as no more than this.
const MOST_REFLECTANCE: f64 = 0.9;
/// Points of a leaf hidden in part that are tried, and the rays that tell whether one is hidden.
const TRIES: u32 = 8;
const HIDDEN_RAYS: u32 = 16;

/// A point that was compared; all lights are means of the colours, W/m².
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    pub point: SurfacePoint,
    /// E as one looked for it anew.
    pub truth: f32,
    /// Change of E by the field's error after one reflection.
    pub change: f32,
    /// Standard error of `truth` but for the change, of a reading, and of the change.
    pub noise: f32,
    pub reading_noise: f32,
    pub change_noise: f32,
    pub reflectance: f32,
    pub emission: f32,
    /// Density of points by A·|B|² here, as a multiple of those by area.
    pub by_power: f64,
    /// Whether it is noisier than readings should be, because its rays were too few.
    pub is_blunt: bool,
    pub rays: u64,
}

impl Compared {
    /// E + E₀, W/m².
    pub fn scale(&self, dim: f32) -> f64 {
        f64::from(self.truth + dim).max(f64::MIN_POSITIVE)
    }
}

/// Density of the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Density {
    /// By area.
    Area,
    /// By A·|B|².
    Power,
}

/// Draws points on the leaves that do not emit.
#[derive(Clone, Debug, Default)]
pub struct LeafSampler {
    seed: u64,
    leaves: Vec<ElementId>,
    /// Σ of areas up to each leaf, m².
    areas: Vec<f64>,
    /// Σ of A·|B|² up to each leaf, W²/m².
    powers: Vec<f64>,
    /// Σ of A·ρ, m².
    reflecting: f64,
}

impl LeafSampler {
    /// Over the leaves of a field; one seed draws the same points whatever the light is.
    pub fn new(field: &Field, seed: u64) -> Self {
        let leaves: Vec<ElementId> = field.leaves().filter(|leaf| !field.emits(*leaf)).collect();
        let (mut sum, mut power, mut reflecting) = (0.0, 0.0, 0.0);
        let (mut areas, mut powers) = (Vec::with_capacity(leaves.len()), Vec::with_capacity(leaves.len()));
        for leaf in &leaves {
            let area = f64::from(field.area(*leaf));
            sum += area;
            reflecting += area * f64::from(grey(field.surface(field.patch(*leaf).polygon).reflectance));
            power += area * f64::from(grey(field.reflected[leaf.index()])).powi(2);
            areas.push(sum);
            powers.push(power);
        }
        Self { seed, leaves, areas, powers, reflecting }
    }

    /// Area of all leaves, m².
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// Σ of A·|B|², W²/m².
    pub fn power(&self) -> f64 {
        self.powers.last().copied().unwrap_or(0.0)
    }

    /// Mean reflectance ρ̄ over the area, [`MOST_REFLECTANCE`] at most.
    pub fn mean_reflectance(&self) -> f64 {
        if self.area() > 0.0 { f64::min(self.reflecting / self.area(), MOST_REFLECTANCE) } else { 0.0 }
    }

    /// Compares at the point of this density and number, to an error of readings as a share of the
    /// light, with at most so many times the rays that one should take.
    pub fn compare(&self, field: &Field, (density, index): (Density, usize), error: f32, most_rays: f32) -> Compared {
        // The salt tells the sequences of points apart.
        let (ends, salt) = match density {
            Density::Area => (&self.areas, 0),
            Density::Power => (&self.powers, 8),
        };
        let seed = hash64(self.seed, salt << 32 | index as u64);
        // A low-discrepancy sequence over the leaves, so that any number of points is spread
        // evenly.
        let [along, _] = r2_sequence(hash64(self.seed, salt + 1), index as u32);
        let wanted = f64::from(along) * ends[ends.len() - 1];
        let place = ends.partition_point(|end| *end <= wanted).min(ends.len() - 1);
        let [u, v] = r2_sequence(hash64(self.seed, salt + 2), index as u32);
        let point = self.reachable_point(field, self.leaves[place], [u, v], seed);
        let at = (point.position, point.normal);
        let checked = field.checked_at(at, error, hash64(seed, 3), most_rays);
        let Checked { found, noise, reading_noise, change, change_noise, is_blunt } = checked;
        let surface = field.surface(point.polygon);
        Compared {
            point,
            truth: (grey(found.mean) + change).max(0.0),
            is_blunt,
            change,
            noise,
            reading_noise,
            change_noise,
            reflectance: grey(surface.reflectance),
            emission: grey(surface.emission),
            by_power: self.by_power(place),
            rays: found.rays,
        }
    }

    /// Density of points by A·|B|² on a leaf, as a multiple of those by area.
    fn by_power(&self, place: usize) -> f64 {
        let share = |ends: &[f64]| {
            let before = if place > 0 { ends[place - 1] } else { 0.0 };
            (ends[place] - before) / ends[ends.len() - 1].max(f64::MIN_POSITIVE)
        };
        share(&self.powers) / share(&self.areas).max(f64::MIN_POSITIVE)
    }

    /// A point of a leaf that does not hide under something, unless all of it seems to.
    fn reachable_point(&self, field: &Field, leaf: ElementId, [u, v]: [f32; 2], seed: u64) -> SurfacePoint {
        let point = field.hierarchy.point_on(leaf, u, v);
        if !field.patch(leaf).is_hidden_in_part() {
            return point;
        }
        let other = |number: u32| {
            let [u, v] = r2_sequence(hash64(seed, 6), number);
            field.hierarchy.point_on(leaf, u, v)
        };
        let mut points = std::iter::once(point).chain((0..TRIES).map(other));
        points
            .find(|point| !field.is_enclosed(point.position, point.normal, hash64(seed, 7), HIDDEN_RAYS))
            .unwrap_or(point)
    }
}
