//! Where the sun stands: low-precision position [Meeus, *Astronomical Algorithms*, 2nd ed.,
//! chapters 7, 12, 13, 25], good to 0.01°.

use std::f64::consts::TAU;

/// A moment of the calendar, in a zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Year, month (1 to 12) and day (1 to 31).
    pub date: [i32; 3],
    /// Hours of the zone's clock.
    pub hours: f64,
    /// Hours by which the zone's clock is ahead of UTC.
    pub zone: f64,
}

impl Moment {
    /// Days of a month.
    pub fn days_of(year: i32, month: i32) -> i32 {
        let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        match month {
            2 if is_leap => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        }
    }

    /// The Julian day of the moment [Meeus, chapter 7; Gregorian calendar].
    pub fn julian_day(&self) -> f64 {
        let [mut year, mut month, day] = self.date;
        if month <= 2 {
            (year, month) = (year - 1, month + 12);
        }
        let century = year.div_euclid(100);
        let leap = 2 - century + century.div_euclid(4);
        let days = (365.25 * f64::from(year + 4716)).floor() + (30.6001 * f64::from(month + 1)).floor();
        days + f64::from(day + leap) - 1524.5 + (self.hours - self.zone) / 24.0
    }
}

/// Azimuth (from north towards east) and elevation of the sun, degrees, without refraction.
pub fn position(moment: &Moment, latitude: f64, longitude: f64) -> [f64; 2] {
    let day = moment.julian_day() - 2_451_545.0;
    let t = day / 36_525.0;
    let mean_longitude = 280.466_46 + t * (36_000.769_83 + t * 0.000_303_2);
    let anomaly = (357.529_11 + t * (35_999.050_29 - t * 0.000_153_7)).to_radians();
    let centre = (1.914_602 - t * (0.004_817 + t * 0.000_014)) * anomaly.sin()
        + (0.019_993 - t * 0.000_101) * (2.0 * anomaly).sin()
        + 0.000_289 * (3.0 * anomaly).sin();
    let node = (125.04 - 1_934.136 * t).to_radians();
    let longitude_of_sun = (mean_longitude + centre - 0.005_69 - 0.004_78 * node.sin()).to_radians();
    let obliquity = (23.439_291 - 0.013_004_2 * t + 0.002_56 * node.cos()).to_radians();
    let right_ascension = (obliquity.cos() * longitude_of_sun.sin()).atan2(longitude_of_sun.cos());
    let declination = (obliquity.sin() * longitude_of_sun.sin()).asin();
    let sidereal = (280.460_618_37 + 360.985_647_366_29 * day + t * t * 0.000_387_933).to_radians();
    let hour_angle = sidereal + longitude.to_radians() - right_ascension;
    let latitude = latitude.to_radians();
    let sine = latitude.sin() * declination.sin() + latitude.cos() * declination.cos() * hour_angle.cos();
    let south_azimuth = hour_angle.sin().atan2(hour_angle.cos() * latitude.sin() - declination.tan() * latitude.cos());
    let azimuth = (south_azimuth + 0.5 * TAU).rem_euclid(TAU);
    [azimuth.to_degrees(), sine.clamp(-1.0, 1.0).asin().to_degrees()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the calendar.
    #[test]
    fn februaries_have_a_day_more_in_leap_years() {
        let days = [(2026, 2), (2028, 2), (1900, 2), (2026, 4), (2026, 12)].map(|(y, m)| Moment::days_of(y, m));
        assert_eq!(days, [28, 29, 28, 30, 31]);
    }

    /// Truth: Meeus, example 7.a (launch of Sputnik, 1957 October 4.81: JD 2436116.31) and his
    /// table of chapter 7.
    #[test]
    fn julian_days() {
        let day = |date, hours| Moment { date, hours, zone: 0.0 }.julian_day();
        assert!((day([1957, 10, 4], 0.81 * 24.0) - 2_436_116.31).abs() < 1e-6);
        assert_eq!(day([2000, 1, 1], 12.0), 2_451_545.0);
        assert_eq!(day([1988, 1, 27], 0.0), 2_447_187.5);
        assert_eq!(Moment { date: [2000, 1, 1], hours: 14.0, zone: 2.0 }.julian_day(), 2_451_545.0);
    }

    /// Truth: the example of the solar position algorithm for Golden, Colorado, 2003-10-17 12:30:30
    /// (UTC−7) [Reda, Andreas, NREL/TP-560-34302]: topocentric azimuth 194.34°, zenith angle
    /// 50.11°, the latter 0.02° of refraction and parallax lower; and symmetry: at the equinox the
    /// sun at noon on the equator stands in the zenith, and at the solstice 23.4° off it.
    #[test]
    fn the_sun_stands_where_the_almanac_has_it() {
        let golden = Moment { date: [2003, 10, 17], hours: 12.0 + 30.0 / 60.0 + 30.0 / 3600.0, zone: -7.0 };
        let [azimuth, elevation] = position(&golden, 39.742_476, -105.178_6);
        assert!((azimuth - 194.340).abs() < 0.02, "{azimuth}");
        assert!((elevation - (90.0 - 50.1116)).abs() < 0.03, "{elevation}");
        let noon = |date, latitude| {
            // The equation of time moves noon by a quarter of an hour at most.
            let highest = (0..120).map(|minute| {
                position(&Moment { date, hours: 11.0 + f64::from(minute) / 60.0, zone: 0.0 }, latitude, 0.0)[1]
            });
            highest.fold(-90.0, f64::max)
        };
        assert!((noon([2026, 3, 20], 0.0) - 90.0).abs() < 0.3);
        assert!((noon([2026, 6, 21], 50.0) - (40.0 + 23.436)).abs() < 0.02);
        assert!((noon([2026, 12, 21], 50.0) - (40.0 - 23.436)).abs() < 0.02);
    }
}
