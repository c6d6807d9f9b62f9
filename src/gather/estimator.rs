//! Irradiance at a point, with its standard error: the one estimator that every reading asks.
//!
//! Light comes in two parts: what rays find that are aimed at emitters and secondary emitters, and
//! what cosine-distributed rays find, whose ends are read from the field. Each part is sampled by
//! looks of a few rays, and looks are repeated where they lower the variance most for each ray,
//! until their spread says that the sum is as exact as was asked for.

use glam::Vec3;

use super::field::{End, Field, Met, grey};
use super::glance::{Followed, GatherPoint, GlanceRays, Path};
use super::sources::Aim;
use crate::base::random::{cosine_direction, hash64};

/// Aimed rays of a look (about so many).
const AIMED: f32 = 8.0;
/// Cosine-distributed rays of a look.
const COSINE: u32 = 16;
/// Looks of each part, at least: fewer do not tell their spread. As many more, times the standard
/// error that is asked for: what so many looks do not meet may still be that share of the light.
const LEAST_LOOKS: u32 = 8;
const LOOKS_FOR_ERROR: f32 = 0.1;
const MOST_FIRST_LOOKS: u32 = 1 << 10;
/// Rays of a reading, about at most, times the square of the standard error that is asked for: as
/// many as would do if a look's rays differed by five times the local light. By day, far from a
/// window, a tenth of all points need so many.
pub const MOST_RAYS: f32 = 24.0;
/// Looks of a part are made more by this factor at least, and by so many times what should do.
const LEAST_GROWTH: f32 = 1.25;
const GROWTH: f32 = 1.1;
/// Samples of a low-discrepancy sequence.
const SEQUENCE: u32 = 1 << 16;
/// Ends of the rays of a look, at most as far as their numbers tell.
const MOST_ENDS: u32 = 64;
/// Rays of a look that are drawn by the radiance of an uneven sky.
const DRAWN: u32 = 8;
/// Rays of a look to the sun's disc: in a penumbra, the few looks of a reading must tell the part
/// of it that is seen.
const TO_SUN: u32 = 4;
/// Rays of the look from where a ray ended.
const FURTHER: GlanceRays = GlanceRays { aimed: 2, cosine: 2 };
/// A check need not know the light itself as exactly as a reading, which tells of itself how exact
/// it is: it is the scale of errors, and what others are compared with.
const NOISE_OF_CHECK: f32 = 2.0;
/// Looks from there, at most: as many as what the ray brings is more than others bring, for so much
/// noisier is what it tells of the change.
const MOST_FURTHER: f32 = 16.0;

/// An irradiance and how sure it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Irradiance {
    /// E, W/m².
    pub mean: Vec3,
    /// Standard error of `mean`, W/m².
    pub standard_error: Vec3,
    /// Rays cast.
    pub rays: u64,
}

/// A gather at a point beside a second one, and what a reading there would be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checked {
    /// The irradiance found.
    pub found: Irradiance,
    /// Standard error of it (mean of the colours), W/m².
    pub noise: f32,
    /// Standard error that a reading has here, W/m²: what is asked for, or more where its rays
    /// would not do.
    pub reading_noise: f32,
    /// Change of E (mean of the colours) where one reflection more is followed from the ends of its
    /// rays, W/m².
    pub change: f32,
    /// Standard error of that, W/m².
    pub change_noise: f32,
    /// Whether rays ended before both were as exact as was asked for.
    pub is_blunt: bool,
}

/// Whether light is followed by one reflection more from wherever the field was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Check {
    No,
    Yes,
}

/// A part of the light at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// By emitters and secondary emitters that the point aims at.
    Aimed,
    /// By all that others reflect.
    Cosine,
}

/// Light that one look finds.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Irradiance, W/m².
    light: Vec3,
    /// Change of E in a check, W/m².
    change: Vec3,
    /// Places where the field was read, and Σ of what these bring (mean of the colours), W/m².
    reads: u32,
    of_reads: f32,
    /// Rays cast, and of these those that a reading casts as well.
    rays: u32,
    of_reading: u32,
}

/// Sums over the looks of a part.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    looks: u32,
    light: Vec3,
    squares: Vec3,
    grey_squares: f32,
    /// Σ of changes and of their squares (mean of the colours).
    change: f32,
    change_squares: f32,
    reads: u32,
    of_reads: f32,
    rays: u64,
    /// Rays that a reading casts as well.
    of_reading: u64,
}

/// A point that is looked from.
struct Place {
    point: Vec3,
    normal: Vec3,
    seed: u64,
    check: Check,
}

impl Field {
    /// Irradiance at a point of a face with this unit normal, until its standard error is this
    /// share of E + E₀ (mean of the colours). The seed alone tells the random numbers, so a reading
    /// does not depend on others.
    pub fn irradiance_at(&self, (point, normal): (Vec3, Vec3), error: f32, seed: u64) -> Irradiance {
        let (sums, _) = self.sums(&Place { point, normal, seed, check: Check::No }, error, MOST_RAYS);
        irradiance(&sums)
    }

    /// Gathers at a point for a check of readings of this standard error; it ends at the latest
    /// after `most_rays` over the square of `error`.
    pub fn checked_at(&self, (point, normal): (Vec3, Vec3), error: f32, seed: u64, most_rays: f32) -> Checked {
        let (sums, is_exact) = self.sums(&Place { point, normal, seed, check: Check::Yes }, error, most_rays);
        let [noise, change_noise] =
            [Sums::variance, Sums::change_variance].map(|variance| sums.iter().map(variance).sum::<f32>().sqrt());
        let change = sums.iter().map(Sums::mean_change).sum();
        let found = irradiance(&sums);
        let reading_noise =
            (error * (grey(found.mean) + self.dim())).max(least_noise(&sums, MOST_RAYS / (error * error)));
        Checked { found, noise, reading_noise, change, change_noise, is_blunt: !is_exact }
    }

    /// Looks for both parts until their sum is exact enough, or rays are too many; whether it is
    /// exact enough.
    fn sums(&self, place: &Place, error: f32, most_rays: f32) -> ([Sums; 2], bool) {
        let mut aims = Vec::new();
        self.find_aims(place.point, place.normal, &mut aims);
        let mut sums = [Sums::default(); 2];
        let mut wanted = [((LOOKS_FOR_ERROR / error) as u32).clamp(LEAST_LOOKS, MOST_FIRST_LOOKS); 2];
        loop {
            for part in [Part::Aimed, Part::Cosine] {
                while sums[part as usize].looks < wanted[part as usize] {
                    let usual = (sums[0].of_reads + sums[1].of_reads) / (sums[0].reads + sums[1].reads).max(1) as f32;
                    let sums = &mut sums[part as usize];
                    sums.add(&self.look(part, place, sums.looks, (usual, &mut aims)));
                }
            }
            let variance = sums.map(|sums| match place.check {
                Check::No => sums.variance(),
                Check::Yes => sums.change_variance().max(sums.variance() / (NOISE_OF_CHECK * NOISE_OF_CHECK)),
            });
            let allowed = error * (grey(sums[0].mean() + sums[1].mean()) + self.dim());
            let excess = (variance[0] + variance[1]) / (allowed * allowed).max(f32::MIN_POSITIVE);
            if excess <= 1.0 || (sums[0].rays + sums[1].rays) as f32 * error * error >= most_rays {
                return (sums, excess <= 1.0);
            }
            // More of the part whose variance falls the most for each ray: as many as should do, at
            // most twice as many as there are. Whoever asks after every look stops where little was
            // found by chance, and reads too low.
            let part = usize::from(variance[0] * sums[1].rays as f32 <= variance[1] * sums[0].rays as f32);
            let other = variance[1 - part] / (allowed * allowed).max(f32::MIN_POSITIVE);
            let growth = if other < 1.0 { (excess - other) / (1.0 - other) } else { f32::INFINITY };
            wanted[part] = (sums[part].looks as f32 * (GROWTH * growth).clamp(LEAST_GROWTH, 2.0)).ceil() as u32;
        }
    }

    /// Irradiance at a place of a polygon, to a standard error that is this share of the local
    /// light. It depends on the place alone.
    pub fn read(&self, polygon: u32, position: Vec3, error: f32) -> Irradiance {
        // Off its plane by rounding, a place would lie behind its face; on its edge, rays would
        // pass the faces that meet there as they pass its own.
        let position = self.off_edges(polygon, position);
        let position = self.on_plane(self.leaf_at(polygon, position), position);
        let normal = self.normal(polygon);
        let seed = position.to_array().iter().fold(u64::from(polygon), |seed, x| hash64(seed, u64::from(x.to_bits())));
        self.irradiance_at((position, normal), error, seed)
    }

    /// A look; `usual` is what a read brings in the mean.
    fn look(&self, part: Part, place: &Place, number: u32, (usual, aims): (f32, &mut [Aim])) -> Seen {
        let mut seen = Seen::default();
        let of_ends = hash64(place.seed, 1 + part as u64);
        let read = |seen: &mut Seen, met: &Met, weight: f32, index: u32| {
            let number = number * MOST_ENDS + index;
            let path = Path::start(hash64(of_ends, number.into()), Vec3::splat(weight));
            let (mut change, mut rays, mut of_reading) = (Vec3::ZERO, 0, 0);
            let (mut reads, mut of_reads) = (0, 0.0);
            let sent = self.follow(met, place.point, path, &mut |followed| match followed {
                Followed::Cast(more) => of_reading += more,
                Followed::Read(met, path) if place.check == Check::Yes => {
                    let patch = self.patch(met.leaf);
                    let further = GatherPoint::on_face((met.position, patch.normal));
                    let seed = if path.length == 0 { (of_ends, number) } else { (path.seed, 0) };
                    let brought = grey(path.throughput * self.sent[met.leaf.index()]);
                    let looks = if usual > 0.0 { (brought / usual).clamp(1.0, MOST_FURTHER) as u32 } else { 1 };
                    let of_looks = GlanceRays { aimed: looks * FURTHER.aimed, cosine: looks * FURTHER.cosine };
                    let further = self.glance(&further, of_looks, seed).irradiance();
                    reads += 1;
                    of_reads += brought;
                    let reflected = self.surface(patch.polygon).reflectance * further;
                    change += path.throughput * (reflected - self.sent[met.leaf.index()]);
                    rays += of_looks.aimed + of_looks.cosine;
                }
                Followed::Read(..) => {}
            });
            seen.light += weight * sent;
            seen.change += change;
            seen.reads += reads;
            seen.of_reads += of_reads;
            seen.rays += rays + of_reading;
            seen.of_reading += of_reading;
        };
        match part {
            Part::Aimed => {
                let mut index = 0;
                let reflect = &mut |met: Met, weight: f32| {
                    read(&mut seen, &met, weight, index);
                    index += 1;
                };
                // The upper half of the seed keeps the samples of a source in one sequence over all
                // looks.
                let seed = (place.seed << 32) | (hash64(place.seed, 3 + u64::from(number)) & 0xffff_ffff);
                let (emitted, rays) = self.aim((place.point, place.normal), aims, AIMED, seed, reflect);
                seen.light += emitted;
                seen.rays += rays;
                seen.of_reading += rays;
                let here = GatherPoint::on_face((place.point, place.normal));
                for ray in number * TO_SUN..number * TO_SUN + TO_SUN * self.sun_rays() {
                    let [u, v, ..] = sequence(place.seed, 2, ray);
                    seen.light += self.sun_light(&here, [u, v]) / TO_SUN as f32;
                }
                seen.rays += TO_SUN * self.sun_rays();
                seen.of_reading += TO_SUN * self.sun_rays();
            }
            Part::Cosine => {
                let sky = self.sky_rays(COSINE, DRAWN);
                for index in 0..COSINE {
                    let [u, v, ..] = sequence(place.seed, 0, number * COSINE + index);
                    let direction = cosine_direction(place.normal, u, v);
                    match self.meet(place.point, place.normal, direction) {
                        End::Face(met) if !self.is_aimed_at(met.leaf, place.point, place.normal) => {
                            read(&mut seen, &met, 1.0 / COSINE as f32, index);
                        }
                        End::Outside => {
                            seen.light += self.sky_along(place.point, direction, place.normal.dot(direction), sky);
                        }
                        End::Face(_) | End::Back => {}
                    }
                }
                let here = GatherPoint::on_face((place.point, place.normal));
                for ray in number * DRAWN..number * DRAWN + sky.drawn {
                    let [u, v, ..] = sequence(place.seed, 1, ray);
                    seen.light += self.sky_drawn(&here, [u, v], sky);
                }
                seen.rays += COSINE + sky.drawn;
                seen.of_reading += COSINE + sky.drawn;
            }
        }
        seen
    }
}

impl Sums {
    fn add(&mut self, seen: &Seen) {
        let change = grey(seen.change);
        self.looks += 1;
        self.light += seen.light;
        self.squares += seen.light * seen.light;
        self.grey_squares += grey(seen.light) * grey(seen.light);
        self.change += change;
        self.change_squares += change * change;
        self.reads += seen.reads;
        self.of_reads += seen.of_reads;
        self.rays += u64::from(seen.rays);
        self.of_reading += u64::from(seen.of_reading);
    }

    fn mean(&self) -> Vec3 {
        self.light / self.looks as f32
    }

    fn mean_change(&self) -> f32 {
        self.change / self.looks as f32
    }

    /// Variance of the mean's grey.
    fn variance(&self) -> f32 {
        self.of_mean(Vec3::splat(self.grey_squares), Vec3::splat(grey(self.light))).x
    }

    fn change_variance(&self) -> f32 {
        self.of_mean(Vec3::splat(self.change_squares), Vec3::splat(self.change)).x
    }

    /// Variance of a mean, from the sums of squares and of values.
    fn of_mean(&self, squares: Vec3, sum: Vec3) -> Vec3 {
        let count = self.looks as f32;
        let mean = sum / count;
        (squares / count - mean * mean).max(Vec3::ZERO) / (count - 1.0).max(1.0)
    }
}

/// The least standard error that so many rays of a reading come to, shared out to the parts by how
/// noisy they are.
fn least_noise(sums: &[Sums; 2], rays: f32) -> f32 {
    let of_part = |sums: &Sums| (sums.variance() * sums.of_reading as f32).sqrt();
    sums.iter().map(of_part).sum::<f32>() / rays.sqrt()
}

/// A sample of a low-discrepancy sequence, which begins anew where the table of the crate ends.
fn sequence(seed: u64, dimensions: u32, index: u32) -> [f32; 4] {
    let scramble = hash64(seed, (index / SEQUENCE).into());
    sobol_burley::sample_4d(index % SEQUENCE, dimensions, (scramble ^ (scramble >> 32)) as u32)
}

fn irradiance([aimed, cosine]: &[Sums; 2]) -> Irradiance {
    let variance = |sums: &Sums| sums.of_mean(sums.squares, sums.light);
    Irradiance {
        mean: aimed.mean() + cosine.mean(),
        standard_error: (variance(aimed) + variance(cosine)).map(f32::sqrt),
        rays: aimed.rays + cosine.rays,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand. Variances of 1 and 4 after 100 rays each fall to ⅓ and ⅔ with 300 and 600 of
    /// 900 rays, which is the proportion of their deviations and the least sum.
    #[test]
    fn rays_are_shared_out_by_deviation() {
        let part = |variance: f32| Sums { looks: 2, grey_squares: 2.0 * variance, of_reading: 100, ..Sums::default() };
        let found = least_noise(&[part(1.0), part(4.0)], 900.0);
        let wanted = (1.0_f32 * 100.0 / 300.0 + 4.0 * 100.0 / 600.0).sqrt();
        assert!((found - wanted).abs() < 1e-6, "{found}, not {wanted}");
    }
}
