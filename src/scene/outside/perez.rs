//! The all-weather sky of Perez, Seals and Michalsky [*Solar Energy* 50(3), 1993]: how the light of
//! a sky is spread, by the irradiances that weather files hold.

use std::f64::consts::PI;

/// The solar constant, W/m².
const SOLAR_CONSTANT: f64 = 1361.0;
/// Upper bounds of the sky's clearness in the first seven rows of [`TABLE`].
const CLEARNESS: [f64; 7] = [1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200];
/// For each class of clearness four numbers for each coefficient a to e (table 1 of the paper, with
/// its erratum).
#[rustfmt::skip]
const TABLE: [[[f64; 4]; 5]; 8] = [
    [[1.3525, -0.2576, -0.2690, -1.4366], [-0.7670, 0.0007, 1.2734, -0.1233], [2.8000, 0.6004, 1.2375, 1.0000],
     [1.8734, 0.6297, 0.9738, 0.2809], [0.0356, -0.1246, -0.5718, 0.9938]],
    [[-1.2219, -0.7730, 1.4148, 1.1016], [-0.2054, 0.0367, -3.9128, 0.9156], [6.9750, 0.1774, 6.4477, -0.1239],
     [-1.5798, -0.5081, -1.7812, 0.1080], [0.2624, 0.0672, -0.2190, -0.4285]],
    [[-1.1000, -0.2515, 0.8952, 0.0156], [0.2782, -0.1812, -4.5000, 1.1766], [24.7219, -13.0812, -37.7000, 34.8438],
     [-5.0000, 1.5218, 3.9229, -2.6204], [-0.0156, 0.1597, 0.4199, -0.5562]],
    [[-0.5484, -0.6654, -0.2672, 0.7117], [0.7234, -0.6219, -5.6812, 2.6297], [33.3389, -18.3000, -62.2500, 52.0781],
     [-3.5000, 0.0016, 1.1477, 0.1062], [0.4659, -0.3296, -0.0876, -0.0329]],
    [[-0.6000, -0.3566, -2.5000, 2.3250], [0.2937, 0.0496, -5.6812, 1.8415], [21.0000, -4.7656, -21.5906, 7.2492],
     [-3.5000, -0.1554, 1.4062, 0.3988], [0.0032, 0.0766, -0.0656, -0.1294]],
    [[-1.0156, -0.3670, 1.0078, 1.4051], [0.2875, -0.5328, -3.8500, 3.3750], [14.0000, -0.9999, -7.1406, 7.5469],
     [-3.4000, -0.1078, -1.0750, 1.5702], [-0.0672, 0.4016, 0.3017, -0.4844]],
    [[-1.0000, 0.0211, 0.5025, -0.5119], [-0.3000, 0.1922, 0.7023, -1.6317], [19.0000, -5.0000, 1.2438, -1.9094],
     [-4.0000, 0.0250, 0.3844, 0.2656], [1.0468, -0.3788, -2.4517, 1.4656]],
    [[-1.0500, 0.0289, 0.4260, 0.3590], [-0.3250, 0.1156, 0.7781, 0.0025], [31.0625, -14.5000, -46.1148, 55.3750],
     [-7.2312, 0.4050, 13.3500, 0.6234], [1.5000, -0.6426, 1.8564, 0.5636]],
];
/// The mean luminous efficacies of a sky and of the sun, lm/W of all their radiation [Littlefair
/// 1985, rounded].
pub(super) const SKY_EFFICACY: f32 = 120.0;
/// See [`SKY_EFFICACY`].
pub(super) const SUN_EFFICACY: f32 = 105.0;

/// Coefficients a to e of the [general sky](super::cie) under a sun of this elevation (radians), by
/// the sun's irradiance of a face turned to it and the sky's of open ground, W/m² of all radiation.
///
/// Perez leaves out a term of the general sky's indicatrix; the same spread has other c and e
/// there.
pub(super) fn coefficients(direct: f64, diffuse: f64, sun_elevation: f64) -> [f64; 5] {
    let zenith = (0.5 * PI - sun_elevation).clamp(0.0, 0.5 * PI);
    let diffuse = diffuse.max(1e-3);
    let cubed = 1.041 * zenith.powi(3);
    let clearness = ((diffuse + direct) / diffuse + cubed) / (1.0 + cubed);
    let class = CLEARNESS.iter().position(|most| clearness < *most).unwrap_or(7);
    // Relative air mass [Kasten, Young 1989].
    let air_mass = 1.0 / (zenith.cos() + 0.505_72 * (96.079_95 - zenith.to_degrees()).powf(-1.636_4));
    let brightness = (air_mass * diffuse / SOLAR_CONSTANT).min(1.0);
    // Between overcast and clear skies the fit is not meant for darker ones.
    let brightness = if (1..5).contains(&class) { brightness.max(0.2) } else { brightness };
    let by_row = |[one, two, three, four]: [f64; 4]| one + two * zenith + brightness * (three + four * zenith);
    let [a, b, mut c, mut d, e] = TABLE[class].map(by_row);
    if class == 0 {
        let [_, _, [c1, c2, c3, c4], [d1, d2, d3, d4], _] = TABLE[0];
        c = (brightness * (c1 + c2 * zenith)).powf(c3).exp() - c4;
        d = -(brightness * (d1 + d2 * zenith)).exp() + d3 + brightness * d4;
    }
    let missing = 1.0 + c * (0.5 * PI * d).exp();
    [a, b, c / missing, d, e / missing]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the formula of the paper, 1 + c·e^(dγ) + e·cos²γ, up to a factor, for all weathers.
    #[test]
    fn the_general_sky_is_the_papers() {
        for (direct, diffuse) in [(0.0, 60.0), (50.0, 200.0), (300.0, 150.0), (800.0, 90.0)] {
            let [_, _, c, d, e] = coefficients(direct, diffuse, 0.7);
            let end = (0.5 * PI * d).exp();
            let general = |angle: f64| 1.0 + c * ((d * angle).exp() - end) + e * angle.cos().powi(2);
            let missing = 1.0 / (1.0 - c * end);
            let paper = |angle: f64| 1.0 + missing * (c * (d * angle).exp() + e * angle.cos().powi(2));
            for angle in [0.0, 0.5, 1.2, 2.5] {
                assert!(
                    (general(angle) * missing - paper(angle)).abs() < 1e-9 * paper(angle).abs(),
                    "{direct} {angle}"
                );
            }
        }
    }

    /// Truth: by hand from the table's first row, for Z = 0.771, air mass 1.39, Δ = 0.102: a =
    /// 1.015, b = −0.646, so that the zenith is 1 + a·e^b = 1.53 times as bright as the horizon. In
    /// clear weather the sky is brighter by the sun than anywhere else.
    #[test]
    fn weathers_look_as_they_should() {
        let [a, b, ..] = coefficients(0.0, 100.0, 0.8);
        let gradation = |elevation_sine: f64| 1.0 + a * (b / elevation_sine).exp();
        assert!((gradation(1.0) / gradation(0.01) - 1.53).abs() < 0.005, "{}", gradation(1.0) / gradation(0.01));
        let [_, _, c, d, e] = coefficients(850.0, 80.0, 0.8);
        let about = |angle: f64| 1.0 + c * ((d * angle).exp() - (0.5 * PI * d).exp()) + e * angle.cos().powi(2);
        assert!(about(0.0) > 3.0 * about(0.8) && about(0.3) > about(0.8) && c > 0.0, "{c} {d} {e}");
    }
}
