//! Daylight as a person or a file tells it: `overcast:10000lx`, `az:200,el:40,60000lx`.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::DaylightError;
use super::cie::{CLEAR, LuminanceDistribution};
use super::perez::{SKY_EFFICACY, SUN_EFFICACY};
use super::solar::{Moment, position};
use crate::base::photometry::LUMENS_PER_WATT;

/// Daylight as it is asked for: a sky, a sun, both or neither.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Daylight {
    /// The sky.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sky: Option<SkySpec>,
    /// The sun.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sun: Option<SunSpec>,
}

impl Daylight {
    /// Whether nothing is given.
    pub fn is_empty(&self) -> bool {
        self.sky.is_none() && self.sun.is_none()
    }
}

/// A sky by its kind and what it brings to open ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SkySpec {
    /// Distribution of its light.
    pub kind: SkyKind,
    /// Horizontal unobstructed irradiance without the sun; `None` where a picture's pixels are
    /// radiances.
    pub amount: Option<Amount>,
}

/// Distribution of the light over a sky.
#[derive(Clone, Debug, PartialEq)]
pub enum SkyKind {
    /// By a formula.
    Formula(LuminanceDistribution),
    /// As a picture has it: equirectangular, north in its middle, west on its left.
    Picture(String),
}

/// Where the sun stands and what it brings to a face turned to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SunSpec {
    /// Where it stands.
    pub place: SunPlace,
    /// Irradiance of a face turned to it; `None` as a clear day brings at its elevation.
    pub amount: Option<Amount>,
    /// Colour of the sun; the eye's mean of it counts for nothing.
    pub colour: Vec3,
}

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SunPlace {
    /// Degrees from the scene's north towards east, and above the horizon.
    Direction {
        /// From north (−z, or y where z is up) towards east (x), degrees.
        azimuth: f32,
        /// Above the horizon, degrees.
        elevation: f32,
    },
    /// At a moment and place.
    Almanac {
        /// When.
        moment: Moment,
        /// Degrees north of the equator.
        latitude: f32,
        /// Degrees east of Greenwich.
        longitude: f32,
        /// Where the scene's north points to: degrees from true north towards east.
        north: f32,
    },
}

/// An irradiance in the unit that it was given in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// lx.
    Lux(f32),
    /// W/m².
    Watts(f32),
}

/// The largest amount, lx: a thousand suns.
const MOST_LUX: f32 = 1e8;

impl Amount {
    /// White irradiance, W/m².
    pub fn watts(self) -> f32 {
        match self {
            Self::Lux(lux) => lux / LUMENS_PER_WATT,
            Self::Watts(watts) => watts,
        }
    }

    /// lx of white light.
    pub fn lux(self) -> f32 {
        self.watts() * LUMENS_PER_WATT
    }

    fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        let number = |digits: &str| digits.trim().parse::<f32>().ok();
        let of = |unit: &str| text.strip_suffix(unit).and_then(number);
        let lux = of("klx").map(|value| 1000.0 * value).or_else(|| of("lx")).map(Self::Lux);
        let watts = || of("W/m2").or_else(|| of("W/m²")).or_else(|| of("W")).map(Self::Watts);
        let amount = lux.or_else(watts)?;
        (amount.lux() >= 0.0 && amount.lux() <= MOST_LUX).then_some(amount)
    }
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lux(lux) => write!(f, "{lux}lx"),
            Self::Watts(watts) => write!(f, "{watts}W"),
        }
    }
}

/// The largest irradiance that a weather may have, W/m²: more than the sun's outside of the air.
const MOST_RADIATION: f32 = 1500.0;
/// Illuminance by a formula's sky where none is given, lx.
const USUAL_SKY: f32 = 10_000.0;

impl SkySpec {
    /// A sky of a formula.
    pub fn of(distribution: LuminanceDistribution, amount: Amount) -> Self {
        Self { kind: SkyKind::Formula(distribution), amount: Some(amount) }
    }
}

impl FromStr for SkySpec {
    type Err = DaylightError;

    fn from_str(text: &str) -> Result<Self, DaylightError> {
        let (name, amount) = match text.rsplit_once(':') {
            Some((name, amount)) if Amount::read(amount).is_some() => (name, Amount::read(amount)),
            _ => (text, None),
        };
        if let Some(distribution) = read_distribution(name) {
            let usual = match distribution {
                LuminanceDistribution::Weather { diffuse, .. } => SKY_EFFICACY * diffuse,
                _ => USUAL_SKY,
            };
            return Ok(Self::of(distribution, amount.unwrap_or(Amount::Lux(usual))));
        }
        let is_picture = [".hdr", ".exr", ".png", ".jpg", ".jpeg"];
        if is_picture.iter().any(|ending| name.to_lowercase().ends_with(ending)) {
            return Ok(Self { kind: SkyKind::Picture(name.to_owned()), amount });
        }
        Err(DaylightError::Sky(text.to_owned()))
    }
}

fn read_distribution(name: &str) -> Option<LuminanceDistribution> {
    let numbers = |text: &str| text.split('/').map(|number| number.parse::<f64>().ok()).collect::<Option<Vec<_>>>();
    if let Some(text) = name.strip_prefix("cie=") {
        let coefficients: [f64; 5] = numbers(text)?.try_into().ok()?;
        // Larger ones are no sky, and overflow.
        return coefficients
            .iter()
            .all(|value| value.abs() <= 100.0)
            .then_some(LuminanceDistribution::General(coefficients));
    }
    if let Some(text) = name.strip_prefix("perez=") {
        let irradiances: [f64; 2] = numbers(text)?.try_into().ok()?;
        let [direct, diffuse] = irradiances.map(|value| value as f32);
        let is_sound = (0.0..=MOST_RADIATION).contains(&direct) && diffuse > 0.0 && diffuse <= MOST_RADIATION;
        return is_sound.then_some(LuminanceDistribution::Weather { direct, diffuse });
    }
    match name {
        "uniform" => Some(LuminanceDistribution::Uniform),
        "overcast" | "cie16" => Some(LuminanceDistribution::Overcast),
        "clear" => Some(LuminanceDistribution::Standard(CLEAR)),
        _ => {
            let number = name.strip_prefix("cie")?.parse().ok();
            number.filter(|number| (1..=15).contains(number)).map(LuminanceDistribution::Standard)
        }
    }
}

impl fmt::Display for SkySpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            SkyKind::Formula(LuminanceDistribution::Uniform) => f.write_str("uniform")?,
            SkyKind::Formula(LuminanceDistribution::Overcast) => f.write_str("overcast")?,
            SkyKind::Formula(LuminanceDistribution::Standard(CLEAR)) => f.write_str("clear")?,
            SkyKind::Formula(LuminanceDistribution::Standard(number)) => write!(f, "cie{number}")?,
            SkyKind::Formula(LuminanceDistribution::General([a, b, c, d, e])) => write!(f, "cie={a}/{b}/{c}/{d}/{e}")?,
            SkyKind::Formula(LuminanceDistribution::Weather { direct, diffuse }) => {
                write!(f, "perez={direct}/{diffuse}")?
            }
            SkyKind::Picture(name) => f.write_str(name)?,
        }
        self.amount.map_or(Ok(()), |amount| write!(f, ":{amount}"))
    }
}

impl SunSpec {
    /// A white sun at an azimuth and an elevation, degrees.
    pub fn at(azimuth: f32, elevation: f32, amount: Option<Amount>) -> Self {
        Self { place: SunPlace::Direction { azimuth, elevation }, amount, colour: Vec3::ONE }
    }

    /// Azimuth from the scene's north and elevation, degrees.
    pub fn angles(&self) -> [f64; 2] {
        match self.place {
            SunPlace::Direction { azimuth, elevation } => [azimuth.into(), elevation.into()],
            SunPlace::Almanac { moment, latitude, longitude, north } => {
                let [azimuth, elevation] = position(&moment, latitude.into(), longitude.into());
                [(azimuth - f64::from(north)).rem_euclid(360.0), elevation]
            }
        }
    }

    /// Irradiance of a face turned to it, W/m² per colour, on a clear day unless it is given.
    pub fn irradiance(&self) -> Vec3 {
        self.irradiance_under(None)
    }

    /// Irradiance of a face turned to it, W/m² per colour, as it is given, or as the weather of
    /// this sky has it.
    pub fn irradiance_under(&self, sky: Option<&SkySpec>) -> Vec3 {
        let usual = || match sky.map(|sky| &sky.kind) {
            Some(SkyKind::Formula(LuminanceDistribution::Weather { direct, .. })) => Amount::Lux(SUN_EFFICACY * direct),
            _ => clear_day(self.angles()[1]),
        };
        let grey = self.amount.unwrap_or_else(usual).watts();
        let eye = crate::base::photometry::weighted(self.colour.into());
        if eye > 0.0 { grey / eye * self.colour } else { Vec3::splat(grey) }
    }
}

/// Illuminance by the sun on a clear day of a face turned to it: 133.8 klx outside of the air, and
/// a share of e^−0.21 for each air mass [IES, *Recommended practice for the calculation of daylight
/// availability*, 1984].
fn clear_day(elevation: f64) -> Amount {
    let sine = elevation.to_radians().sin();
    Amount::Lux(if sine > 0.0 { (133_800.0 * (-0.21 / sine).exp()) as f32 } else { 0.0 })
}

impl FromStr for SunSpec {
    type Err = DaylightError;

    fn from_str(text: &str) -> Result<Self, DaylightError> {
        let wrong = || DaylightError::Sun(text.to_owned());
        let (mut numbers, mut moment, mut amount, mut colour) = ([None; 5], None, None, Vec3::ONE);
        let names = ["az", "el", "lat", "lon", "north"];
        for part in text.split(',').map(str::trim) {
            let known = part.split_once(':').and_then(|(name, value)| {
                let place = names.iter().position(|known| *known == name)?;
                Some((place, value.trim().parse::<f32>().ok().filter(|number| number.abs() <= 360.0)))
            });
            if let Some((place, value)) = known {
                numbers[place] = Some(value.ok_or_else(wrong)?);
            } else if let Some(rgb) = part.strip_prefix("rgb:") {
                let parsed: Option<Vec<f32>> = rgb.split('/').map(|value| value.parse().ok()).collect();
                let [r, g, b] = parsed.unwrap_or_default()[..] else { return Err(wrong()) };
                colour = Vec3::new(r, g, b);
                if !(colour.is_finite() && colour.min_element() >= 0.0 && colour.max_element() > 0.0) {
                    return Err(wrong());
                }
            } else if let Some(spec) = Amount::read(part) {
                amount = Some(spec);
            } else {
                let read = read_moment(part).ok_or_else(wrong)?;
                let [year, month, day] = read.date;
                if day > Moment::days_of(year, month) {
                    return Err(DaylightError::Day { text: text.to_owned(), days: Moment::days_of(year, month) });
                }
                moment = Some(read);
            }
        }
        let place = match (numbers, moment) {
            ([Some(azimuth), Some(elevation), None, None, None], None) if elevation.abs() <= 90.0 => {
                SunPlace::Direction { azimuth, elevation }
            }
            ([None, None, Some(latitude), Some(longitude), north], Some(moment)) if latitude.abs() <= 90.0 => {
                SunPlace::Almanac { moment, latitude, longitude, north: north.unwrap_or(0.0) }
            }
            _ => return Err(wrong()),
        };
        Ok(Self { place, amount, colour })
    }
}

/// A moment as ISO 8601 writes it: `2026-06-21T12:30+02:00`, or with `Z`; months are not looked at
/// for how many days they have.
fn read_moment(text: &str) -> Option<Moment> {
    let (date, time) = text.split_once('T')?;
    let date: Vec<i32> = date.split('-').map(|part| part.parse().ok()).collect::<Option<_>>()?;
    let [year, month, day] = date[..] else { return None };
    let (clock, zone) = match time.strip_suffix('Z') {
        Some(clock) => (clock, 0.0),
        None => {
            let at = time.find(['+', '-'])?;
            let sign = if time[at..].starts_with('-') { -1.0 } else { 1.0 };
            (&time[..at], sign * clock_hours(&time[at + 1..])?)
        }
    };
    let hours = clock_hours(clock)?;
    let is_sound =
        (1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day) && zone.abs() <= 14.0;
    is_sound.then_some(Moment { date: [year, month, day], hours, zone })
}

fn clock_hours(text: &str) -> Option<f64> {
    let (hours, minutes) = text.split_once(':').unwrap_or((text, "0"));
    let (hours, minutes): (u32, u32) = (hours.parse().ok()?, minutes.parse().ok()?);
    (hours < 24 && minutes < 60).then(|| f64::from(hours) + f64::from(minutes) / 60.0)
}

fn clock(hours: f64) -> String {
    let minutes = (hours * 60.0).round() as i64;
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

impl fmt::Display for SunSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            SunPlace::Direction { azimuth, elevation } => write!(f, "az:{azimuth},el:{elevation}")?,
            SunPlace::Almanac {
                moment: Moment { date: [year, month, day], hours, zone },
                latitude,
                longitude,
                north,
            } => {
                let sign = if zone < 0.0 { '-' } else { '+' };
                let (time, zone) = (clock(hours), clock(zone.abs()));
                write!(f, "{year:04}-{month:02}-{day:02}T{time}{sign}{zone},lat:{latitude},lon:{longitude}")?;
                if north != 0.0 {
                    write!(f, ",north:{north}")?;
                }
            }
        }
        if let Some(amount) = self.amount {
            write!(f, ",{amount}")?;
        }
        let [r, g, b] = self.colour.to_array();
        if self.colour == Vec3::ONE { Ok(()) } else { write!(f, ",rgb:{r}/{g}/{b}") }
    }
}

macro_rules! as_text {
    ($spec:ty) => {
        impl TryFrom<String> for $spec {
            type Error = DaylightError;

            fn try_from(text: String) -> Result<Self, DaylightError> {
                text.parse()
            }
        }

        impl From<$spec> for String {
            fn from(spec: $spec) -> Self {
                spec.to_string()
            }
        }
    };
}

as_text!(SkySpec);
as_text!(SunSpec);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_comes_back_as_it_was() {
        for text in [
            "overcast:10000lx",
            "uniform:50W",
            "clear:8500lx",
            "cie7:100lx",
            "cie=-1/-0.32/10/-3/0.45:80lx",
            "perez=600/120:9000lx",
            "roof.hdr",
            "day:light.exr:2000lx",
        ] {
            let spec: SkySpec = text.parse().expect(text);
            assert_eq!(spec.to_string(), text);
        }
        for text in [
            "az:200,el:40,60000lx",
            "az:0.5,el:-3",
            "2026-06-21T12:30+02:00,lat:48.1,lon:11.6,north:10,80000lx",
            "2026-01-02T08:05-03:30,lat:-22.9,lon:-43.2",
            "az:10,el:20,500W,rgb:1/0.5/0.25",
        ] {
            let spec: SunSpec = text.parse().expect(text);
            assert_eq!(spec.to_string(), text);
        }
        assert_eq!("perez=600/120".parse::<SkySpec>().expect("usual").to_string(), "perez=600/120:14400lx");
        assert_eq!("overcast".parse::<SkySpec>().expect("usual").to_string(), "overcast:10000lx");
        assert_eq!("az:1,el:2,60klx".parse::<SunSpec>().expect("klx").amount, Some(Amount::Lux(60_000.0)));
    }

    #[test]
    fn what_cannot_be_used_is_refused() {
        for text in [
            "",
            "cloudy",
            "cie0",
            "cie17",
            "overcast:-5lx",
            "overcast:5",
            "overcast:1e12lx",
            "sky.tiff",
            "cie=1/2/3/4",
            "cie=1/2/3/4/1e9",
            "perez=600/0",
            "perez=9e9/1",
        ] {
            assert!(text.parse::<SkySpec>().is_err(), "{text}");
        }
        for text in [
            "",
            "az:1",
            "az:1,el:95",
            "el:30",
            "az:x,el:2",
            "az:1,el:2,5",
            "lat:1,lon:2",
            "2026-13-01T12:00Z,lat:1,lon:2",
            "2026-01-32T12:00Z,lat:1,lon:2",
            "az:1,el:2,rgb:1/1",
            "az:1,el:2,rgb:1/x/1/1",
        ] {
            assert!(text.parse::<SunSpec>().is_err(), "{text}");
        }
        for (text, days) in [("2026-02-31", 28), ("2028-02-30", 29), ("2026-04-31", 30)] {
            let text = format!("{text}T12:00Z,lat:1,lon:2");
            let said = text.parse::<SunSpec>().expect_err("no day of the calendar").to_string();
            assert_eq!(
                said,
                format!("the sun's date is in a month of {days} days: choose one of them (it is `{text}`)")
            );
        }
        assert!("2028-02-29T12:00Z,lat:1,lon:2".parse::<SunSpec>().is_ok());
    }

    /// Truth: 179 lm of white light are 1 W; a colour keeps the illuminance.
    #[test]
    fn lux_are_watts_of_white_light() {
        assert!((Amount::Lux(179.0).watts() - 1.0).abs() < 1e-6);
        let sun: SunSpec = "az:0,el:90,17900lx,rgb:1/0.5/0.25".parse().expect("a sun");
        assert!((crate::base::photometry::lux(sun.irradiance().into()) - 17_900.0).abs() < 1.0);
    }
}
