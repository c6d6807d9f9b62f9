//! Daylight of a scene: a sky around it and a sun, both so far away that direction alone counts.
//!
//! Skies are those of the CIE (`cie`) or pictures (`picture`); the sun is a disc of half a degree
//! whose direction is given or follows from date and place (`solar`). People give both in words
//! (`spec`); [`Outside`] is what they come to in a scene's own axes.

mod axes;
mod cie;
mod perez;
mod picture;
mod solar;
mod spec;
mod sun;
mod table;

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::files::read_plain_file;
use super::{Scene, files};

pub use axes::Axes;
use cie::Formula;
pub use cie::{CLEAR, LuminanceDistribution};
pub use picture::SkyPicture;
pub use solar::{Moment, position};
pub use spec::{Amount, Daylight, SkyKind, SkySpec, SunPlace, SunSpec};
pub use sun::{SUN_RADIUS, Sun};
pub use table::{Drawn, SkyTable};

/// Rows and columns of the table by which directions of a sky are drawn.
const TABLE: [usize; 2] = [128, 256];
/// A sky whose brightest place is no more than so many times its mean is even: cosine-distributed
/// rays find its light as well as any.
const EVEN: f32 = 4.0;

/// Daylight that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DaylightError {
    /// No sky.
    #[error(
        "a sky is given as KIND:AMOUNT, such as overcast:10000lx; KIND is uniform, overcast, clear, cie1 to cie15, cie=A/B/C/D/E (the coefficients of CIE S 011), perez=DIRECT/DIFFUSE (W/m², as weather files have them) or a picture (.hdr, .exr, .png, .jpg), AMOUNT its horizontal illuminance in lx or irradiance in W (it is `{0}`)"
    )]
    Sky(String),
    /// No sun.
    #[error(
        "a sun is given as az:DEGREES,el:DEGREES,AMOUNT, such as az:200,el:40,60000lx, or by date and place, such as 2026-06-21T12:00+02:00,lat:48.1,lon:11.6,80000lx (it is `{0}`)"
    )]
    Sun(String),
    /// A day that its month does not have.
    #[error("the sun's date is in a month of {days} days: choose one of them (it is `{text}`)")]
    Day {
        /// Date as it was given.
        text: String,
        /// Days of the month.
        days: i32,
    },
    /// The sky's spread depends on a sun, and none is given.
    #[error("the sky `{0}` is brightest about the sun: tell where that is with --sun")]
    NeedsSun(String),
    /// A picture that is not read.
    #[error("the picture `{name}` of the sky cannot be used: {why}")]
    Picture {
        /// Name of the picture.
        name: String,
        /// Why.
        why: String,
    },
}

/// How the radiance of a sky is found.
#[derive(Clone, Debug)]
enum Source {
    /// A formula times this radiance, W/(m²·sr).
    Formula(Formula, f32),
    /// A picture times this.
    Picture(SkyPicture, f32),
}

#[derive(Clone, Debug)]
struct Sky {
    source: Source,
    /// Unit vector towards the sun, whether it is seen or not.
    sun: DVec3,
    table: SkyTable,
    is_even: bool,
    /// Irradiance of open horizontal ground, W/m².
    horizontal: Vec3,
}

/// Sky and sun around a scene, in its axes.
#[derive(Clone, Debug)]
pub struct Outside {
    spec: Daylight,
    axes: Axes,
    sky: Option<Sky>,
    sun: Option<Sun>,
}

impl Outside {
    /// Makes a specification ready for a scene with this up direction (a unit vector along an
    /// axis); `read` gives the content of a picture's file.
    ///
    /// # Errors
    /// A picture that cannot be used, or a sky that needs a sun.
    pub fn new(
        spec: &Daylight,
        up: Vec3,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<Self, DaylightError> {
        let axes = Axes::with_up(up);
        let place = spec.sun.as_ref().map(|sun| {
            let [azimuth, elevation] = sun.angles().map(f64::to_radians);
            DVec3::new(elevation.cos() * azimuth.sin(), elevation.cos() * azimuth.cos(), elevation.sin())
        });
        let sun = spec.sun.zip(place).map(|(sun, place)| Sun {
            direction: axes.of_scene(place.as_vec3()).normalize(),
            irradiance: if place.z > 0.0 { sun.irradiance_under(spec.sky.as_ref()) } else { Vec3::ZERO },
        });
        let sky = spec.sky.as_ref().map(|sky| Sky::new(sky, place, read)).transpose()?;
        let sun = sun.filter(|sun| sun.irradiance.max_element() > 0.0);
        Ok(Self { spec: spec.clone(), axes, sky: sky.flatten(), sun })
    }

    /// Daylight as it was asked for.
    pub fn spec(&self) -> &Daylight {
        &self.spec
    }

    /// Unit vector of the scene that points up.
    pub fn up(&self) -> Vec3 {
        self.axes.up
    }

    /// Whether anything shines.
    pub fn is_lit(&self) -> bool {
        self.sky.is_some() || self.sun.is_some()
    }

    /// The sun, where it shines.
    pub fn sun(&self) -> Option<&Sun> {
        self.sun.as_ref()
    }

    /// Radiance of the sky without the sun in a direction of the scene (a unit vector), W/(m²·sr).
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let Some(sky) = &self.sky else { return Vec3::ZERO };
        let direction = self.axes.of_sky(direction);
        sky.source.at(direction.as_dvec3(), sky.sun)
    }

    /// Radiance as the eye sees it, the sun's disc included, W/(m²·sr).
    pub fn seen(&self, direction: Vec3) -> Vec3 {
        let sun = self.sun.filter(|sun| sun.holds(direction)).map_or(Vec3::ZERO, |sun| sun.radiance());
        self.radiance(direction) + sun
    }

    /// Whether a sky shines so evenly that cosine-distributed rays find its light as well as any.
    pub fn is_even(&self) -> bool {
        self.sky.as_ref().is_none_or(|sky| sky.is_even)
    }

    /// Whether there is a sky beside the sun.
    pub fn has_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// A direction of the scene drawn by the sky's radiance.
    pub fn draw(&self, numbers: [f32; 2]) -> Option<Drawn> {
        let drawn = self.sky.as_ref()?.table.draw(numbers);
        Some(Drawn { direction: self.axes.of_scene(drawn.direction), ..drawn })
    }

    /// A direction of the scene in the sky's own frame (east, north, up).
    pub fn in_sky(&self, direction: Vec3) -> Vec3 {
        self.axes.of_sky(direction)
    }

    /// Radiance (of the sky's brightest colour) times solid angle in each cell of a table of its
    /// own frame, row by row.
    pub fn weights(&self, size: [usize; 2]) -> Vec<f64> {
        let brightest = |direction: DVec3| {
            self.sky.as_ref().map_or(0.0, |sky| f64::from(sky.source.at(direction, sky.sun).max_element()))
        };
        SkyTable::weights(size, brightest)
    }

    /// A direction of the scene drawn by a table of the sky's own frame.
    pub fn draw_by(&self, table: &SkyTable, numbers: [f32; 2]) -> Drawn {
        let drawn = table.draw(numbers);
        Drawn { direction: self.axes.of_scene(drawn.direction), ..drawn }
    }

    /// Density with which [`Self::draw`] draws a direction, 1/sr.
    pub fn density(&self, direction: Vec3) -> f32 {
        self.sky.as_ref().map_or(0.0, |sky| sky.table.density(self.axes.of_sky(direction)))
    }

    /// Irradiance of open horizontal ground, W/m²: by the sky, and by the sun.
    pub fn horizontal_irradiance(&self) -> [Vec3; 2] {
        let sky = self.sky.as_ref().map_or(Vec3::ZERO, |sky| sky.horizontal);
        let sun = self.sun.map_or(Vec3::ZERO, |sun| sun.direction.dot(self.axes.up).max(0.0) * sun.irradiance);
        [sky, sun]
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        let of = |sky: &Sky| {
            sky.table.bytes() + if let Source::Picture(picture, _) = &sky.source { picture.bytes() } else { 0 }
        };
        self.sky.as_ref().map_or(0, of)
    }
}

impl Scene {
    /// Sky and sun, where the scene has them.
    pub fn outside(&self) -> Option<&Arc<Outside>> {
        self.outside.as_ref().filter(|outside| outside.is_lit())
    }

    /// Daylight as it was asked for.
    pub fn daylight(&self) -> Daylight {
        self.outside.as_ref().map(|outside| outside.spec().clone()).unwrap_or_default()
    }

    /// Lets daylight in: a sky or a sun that is given replaces the scene's own, what is not given
    /// stays. A picture comes from wherever its path leads.
    ///
    /// # Errors
    /// A picture that cannot be used, or a sky that needs a sun.
    pub fn add_daylight(&mut self, spec: &Daylight) -> Result<(), DaylightError> {
        self.add_daylight_from(spec, read_anywhere)
    }

    /// Adds daylight whose pictures are read by this function.
    pub(super) fn add_daylight_from(
        &mut self,
        spec: &Daylight,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<(), DaylightError> {
        if spec.is_empty() {
            return Ok(());
        }
        let own = self.daylight();
        let whole = Daylight { sky: spec.sky.clone().or(own.sky), sun: spec.sun.or(own.sun) };
        self.set_daylight(&whole, read)
    }

    /// Makes this all that lies outside; pictures come from wherever their paths lead.
    ///
    /// # Errors
    /// A picture that cannot be used, or a sky that needs a sun.
    pub fn replace_daylight(&mut self, spec: &Daylight) -> Result<(), DaylightError> {
        self.set_daylight(spec, read_anywhere)
    }

    /// Sets daylight whose pictures are read by this function.
    fn set_daylight(
        &mut self,
        spec: &Daylight,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<(), DaylightError> {
        let outside = Outside::new(spec, self.up_axis(), read)?;
        if spec.sun.is_some() && outside.sun().is_none() {
            self.skipped.note("The sun is below the horizon or dark: it does not shine.");
        }
        self.outside = (!spec.is_empty()).then(|| Arc::new(outside));
        Ok(())
    }
}

fn read_anywhere(path: &Path) -> Result<Vec<u8>, String> {
    read_plain_file(path, files::MOST_BYTES).map_err(|error| error.to_string())
}

impl Source {
    #[inline]
    fn at(&self, direction: DVec3, sun: DVec3) -> Vec3 {
        match self {
            Self::Formula(formula, factor) => Vec3::splat(formula.at(direction.z, direction.dot(sun)) as f32 * factor),
            Self::Picture(picture, factor) => *factor * picture.at(direction),
        }
    }
}

impl Sky {
    /// A sky; `None` for a dark one.
    fn new(
        spec: &SkySpec,
        sun: Option<DVec3>,
        read: impl FnOnce(&Path) -> Result<Vec<u8>, String>,
    ) -> Result<Option<Self>, DaylightError> {
        let place = sun.unwrap_or(DVec3::Z);
        let (source, horizontal) = match &spec.kind {
            SkyKind::Formula(distribution) => {
                if distribution.needs_sun() && sun.is_none() {
                    return Err(DaylightError::NeedsSun(spec.to_string()));
                }
                let formula = distribution.under_sun(place.z.asin());
                let watts = spec.amount.map_or(0.0, Amount::watts);
                let factor = f64::from(watts) / horizontal_of(formula, place);
                (Source::Formula(formula, factor as f32), Vec3::splat(watts))
            }
            SkyKind::Picture(name) => {
                let unusable = |why: String| DaylightError::Picture { name: name.clone(), why };
                let bytes = read(Path::new(name)).map_err(unusable)?;
                let picture = SkyPicture::read(&bytes, name).map_err(unusable)?;
                let own = picture.horizontal_irradiance();
                let eye = crate::base::photometry::weighted(own.into());
                let factor = match spec.amount {
                    Some(amount) if eye > 0.0 => amount.watts() / eye,
                    _ => 1.0,
                };
                (Source::Picture(picture, factor), factor * own)
            }
        };
        let largest = |direction: DVec3| f64::from(source.at(direction, place).max_element());
        let Some(table) = SkyTable::new(TABLE, largest) else { return Ok(None) };
        let is_even = match &source {
            Source::Formula(..) => {
                let brightest = (0..4096).map(|index| largest(fibonacci(index, 4096))).fold(0.0, f64::max);
                let around = f64::from(horizontal.max_element()) / PI;
                brightest.max(largest(place)) <= f64::from(EVEN) * around
            }
            Source::Picture(..) => false,
        };
        Ok(Some(Self { source, sun: place, table, is_even, horizontal }))
    }
}

/// Horizontal irradiance of a formula as it is, by the midpoints of many small cells.
fn horizontal_of(formula: Formula, sun: DVec3) -> f64 {
    const ROWS: usize = 360;
    const COLUMNS: usize = 720;
    let mut sum = 0.0;
    for row in 0..ROWS {
        // Even in the squared sine of the elevation, over which the cosine is alike.
        let sine = ((row as f64 + 0.5) / ROWS as f64).sqrt();
        let radius = (1.0 - sine * sine).sqrt();
        for column in 0..COLUMNS {
            let azimuth = 2.0 * PI * (column as f64 + 0.5) / COLUMNS as f64;
            let direction = DVec3::new(radius * azimuth.sin(), radius * azimuth.cos(), sine);
            sum += formula.at(sine, direction.dot(sun));
        }
    }
    PI * sum / (ROWS * COLUMNS) as f64
}

/// One of so many directions that are spread evenly over the sphere.
fn fibonacci(index: usize, count: usize) -> DVec3 {
    let height = 1.0 - (2 * index + 1) as f64 / count as f64;
    let (sine, cosine) = (2.399_963_229_728_653 * index as f64).sin_cos();
    let radius = (1.0 - height * height).sqrt();
    DVec3::new(radius * cosine, radius * sine, height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{cosine_direction, r2_sequence};

    fn outside(sky: &str, sun: Option<&str>) -> Outside {
        let spec = Daylight { sky: Some(sky.parse().expect("a sky")), sun: sun.map(|sun| sun.parse().expect("a sun")) };
        Outside::new(&spec, Vec3::Y, |_| Err("no file".to_owned())).expect("daylight")
    }

    /// Irradiance of an open face by plain cosine-distributed directions.
    fn irradiance(outside: &Outside, normal: Vec3) -> f32 {
        let count = 200_000;
        let light = |index| {
            let [u, v] = r2_sequence(5, index);
            outside.radiance(cosine_direction(normal, u, v)).x
        };
        std::f32::consts::PI * (0..count).map(light).sum::<f32>() / count as f32
    }

    /// Truth: what was asked for arrives on open ground; a vertical face gets half of a uniform sky
    /// and 0.396 of an overcast one, (π/4 + 2/3) / (7π/6).
    #[test]
    fn open_faces_get_what_the_sky_is_told_to_bring() {
        let ratio = (0.25 * PI + 2.0 / 3.0) / (7.0 * PI / 6.0);
        for (sky, vertical) in [
            ("uniform:100W", Some(0.5)),
            ("overcast:100W", Some(ratio as f32)),
            ("clear:100W", None),
            ("cie1:100W", None),
        ] {
            let outside = outside(sky, Some("az:200,el:40,500W"));
            let level = irradiance(&outside, Vec3::Y);
            assert!((level - 100.0).abs() < 0.3, "{sky}: {level}");
            if let Some(vertical) = vertical {
                let found = irradiance(&outside, Vec3::X) / 100.0;
                assert!((found - vertical).abs() < 2e-3, "{sky}: {found} {vertical}");
            }
            assert_eq!(irradiance(&outside, Vec3::NEG_Y), 0.0);
        }
        assert!((ratio - 0.396).abs() < 1e-3);
    }

    /// Truth: north is −z and east x where y is up; with z up, north is y and east x. Azimuths run
    /// from north over east.
    #[test]
    fn the_sun_stands_in_the_axes_of_the_scene() {
        for (up, north) in [(Vec3::Y, -Vec3::Z), (Vec3::Z, Vec3::Y)] {
            for (azimuth, side) in [(0.0, north), (90.0, Vec3::X), (180.0, -north)] {
                let spec = Daylight { sky: None, sun: Some(SunSpec::at(azimuth, 30.0, Some(Amount::Watts(7.0)))) };
                let outside = Outside::new(&spec, up, |_| Err(String::new())).expect("a sun");
                let sun = outside.sun().expect("it shines");
                let wanted = 0.75_f32.sqrt() * side + 0.5 * up;
                assert!(sun.direction.distance(wanted) < 1e-5, "{azimuth}: {} {wanted}", sun.direction);
                assert!((outside.horizontal_irradiance()[1].x - 3.5).abs() < 1e-4);
            }
        }
        let below = Daylight { sky: None, sun: Some(SunSpec::at(0.0, -1.0, None)) };
        assert!(!Outside::new(&below, Vec3::Y, |_| Err(String::new())).expect("night").is_lit());
    }

    /// Truth: radiance times solid angle is the irradiance of a face turned to it, and picked
    /// directions lie on the disc.
    #[test]
    fn the_disc_of_the_sun_brings_its_irradiance() {
        let sun = Sun { direction: Vec3::new(0.36, 0.48, 0.8), irradiance: Vec3::splat(9.0) };
        let through = sun.radiance().x * Sun::solid_angle();
        assert!((through - 9.0).abs() < 1e-3, "{through}");
        let inside = (0..1000).filter(|index| sun.holds(sun.at(r2_sequence(1, *index)))).count();
        assert!(inside > 990, "{inside}");
        assert!(!sun.holds(Vec3::new(0.37, 0.47, 0.8).normalize()));
    }

    #[test]
    fn even_skies_are_told_from_uneven_ones() {
        assert!(outside("uniform", None).is_even() && outside("overcast", None).is_even());
        assert!(!outside("clear", Some("az:0,el:30")).is_even());
        let spec = Daylight { sky: Some("clear".parse().expect("a sky")), sun: None };
        assert!(matches!(Outside::new(&spec, Vec3::Y, |_| Err(String::new())), Err(DaylightError::NeedsSun(_))));
    }
}
