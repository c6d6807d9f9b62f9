//! ꟻLIP: how different two pictures look to a person who flips between them.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild. *ꟻLIP: A
//! Difference Evaluator for Alternating Images.* Proceedings of the ACM on Computer Graphics and
//! Interactive Techniques 3 (2), 2020. This is the variant for pictures of 8 bits a channel (LDR),
//! with the paper's numbers.

use std::f64::consts::{PI, SQRT_2};

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::read::tone::decode_gamma;

/// Pixels for each degree of the eye: a screen of 3,840 pixels on 0.7 m, from 0.7 m away.
const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;
/// The eye's contrast sensitivity as Gaussians: weights and widths of the achromatic, the red-green
/// and the blue-yellow channel, and of the last one's second Gaussian.
const WIDTHS: DVec3 = DVec3::new(0.0047, 0.0053, 0.04);
const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];
/// Exponent on colour differences, share of the largest that becomes the second number.
const COLOUR_EXPONENT: f64 = 0.7;
const KNEE: [f64; 2] = [0.4, 0.95];
/// Width of the feature detectors, degrees, and the exponent on their differences.
const FEATURE_WIDTH: f64 = 0.082;
const FEATURE_EXPONENT: f64 = 0.5;

/// Linear sRGB to XYZ, by columns, and the white that this makes of (1, 1, 1).
const XYZ_OF_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    DVec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    DVec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

fn white() -> DVec3 {
    XYZ_OF_RGB * DVec3::ONE
}

/// Mean ꟻLIP of two pictures of one size (width and height, pixels), gamma-encoded: 0 for the same,
/// up to 1.
pub fn mean_flip(one: &[[u8; 3]], other: &[[u8; 3]], size: [u32; 2]) -> f64 {
    let map = flip(one, other, size);
    map.iter().sum::<f64>() / map.len().max(1) as f64
}

fn flip(one: &[[u8; 3]], other: &[[u8; 3]], [width, height]: [u32; 2]) -> Vec<f64> {
    let width = width as usize;
    assert!(one.len() == other.len() && one.len() == width * height as usize, "both pictures have this size");
    let decoded: Vec<f64> = (0..=255).map(|value| f64::from(decode_gamma(value as f32 / 255.0))).collect();
    let opponents = [one, other].map(|pixels| {
        let linear = |pixel: &[u8; 3]| DVec3::from(pixel.map(|channel| decoded[usize::from(channel)]));
        pixels.par_iter().map(|pixel| opponent(linear(pixel))).collect::<Vec<_>>()
    });
    let [colours, features] = [seen_colours, features].map(|of| opponents.each_ref().map(|picture| of(picture, width)));
    let largest = apart(perceived(DVec3::Y), perceived(DVec3::Z)).powf(COLOUR_EXPONENT);
    let at = |index: usize| {
        let colour = apart(colours[0][index], colours[1][index]).powf(COLOUR_EXPONENT);
        let [share, level] = KNEE;
        let knee = share * largest;
        let colour = match colour < knee {
            true => level / knee * colour,
            false => level + (colour - knee) / (largest - knee) * (1.0 - level),
        };
        let feature = (features[0][index] - features[1][index]).abs().max_element() / SQRT_2;
        colour.powf(1.0 - feature.powf(FEATURE_EXPONENT))
    };
    (0..one.len()).into_par_iter().map(at).collect()
}

/// Y, Cx, Cz of a linear sRGB colour.
fn opponent(rgb: DVec3) -> DVec3 {
    let [x, y, z] = (XYZ_OF_RGB * rgb / white()).to_array();
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

fn rgb_of_opponent(colour: DVec3) -> DVec3 {
    let y = (colour.x + 16.0) / 116.0;
    XYZ_OF_RGB.inverse() * (DVec3::new(y + colour.y / 500.0, y, y - colour.z / 200.0) * white())
}

/// CIELAB of a linear sRGB colour, dark colours less colourful (Hunt's effect).
fn perceived(rgb: DVec3) -> DVec3 {
    const JOINT: f64 = 6.0 / 29.0;
    let [x, y, z] = (XYZ_OF_RGB * rgb / white()).to_array().map(|share| match share > JOINT.powi(3) {
        true => share.cbrt(),
        false => share / (3.0 * JOINT * JOINT) + 4.0 / 29.0,
    });
    let light = 116.0 * y - 16.0;
    DVec3::new(light, 0.01 * light * 500.0 * (x - y), 0.01 * light * 200.0 * (y - z))
}

/// The HyAB distance of two colours.
fn apart(one: DVec3, other: DVec3) -> f64 {
    let by = one - other;
    by.x.abs() + by.y.hypot(by.z)
}

/// The colours that are left of a picture at that distance.
fn seen_colours(picture: &[DVec3], width: usize) -> Vec<DVec3> {
    let radius = (3.0 * (WIDTHS.max_element() / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let gaussian = |width: f64| {
        let at = |x: i32| (-(PI * f64::from(x) / PIXELS_PER_DEGREE).powi(2) / width).exp();
        let all: Vec<f64> = (-radius..=radius).map(at).collect();
        let sum: f64 = all.iter().sum();
        (all.into_iter().map(|value| value / sum).collect::<Vec<f64>>(), sum)
    };
    let [(a, _), (red_green, _)] = [WIDTHS.x, WIDTHS.y].map(gaussian);
    let [(wide, wide_sum), (narrow, narrow_sum)] = BLUE_YELLOW.map(|[_, width]| gaussian(width));
    let weight = |[weight, width]: [f64; 2], sum: f64| weight * (PI / width).sqrt() * sum * sum;
    let weights = [weight(BLUE_YELLOW[0], wide_sum), weight(BLUE_YELLOW[1], narrow_sum)];
    let share = weights[0] / (weights[0] + weights[1]);
    let main: Vec<DVec3> = (0..a.len()).map(|k| DVec3::new(a[k], red_green[k], wide[k])).collect();
    let second: Vec<DVec3> = narrow.into_iter().map(|value| DVec3::new(0.0, 0.0, value)).collect();
    let [main, second] = [main, second].map(|kernel| downwards(&across(picture, width, &kernel), width, &kernel));
    let colour = |(main, second): (&DVec3, &DVec3)| {
        let seen = DVec3::new(main.x, main.y, share * main.z + (1.0 - share) * second.z);
        perceived(rgb_of_opponent(seen).clamp(DVec3::ZERO, DVec3::ONE))
    };
    main.par_iter().zip(&second).map(colour).collect()
}

/// How much of an edge (x) and of a point (y) is at each pixel.
fn features(picture: &[DVec3], width: usize) -> Vec<DVec3> {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let bell = |x: f64| (-0.5 * (x / deviation).powi(2)).exp();
    // The Gaussian, its first and its second derivative; of each the positive weights sum to 1, and
    // the negative ones.
    let kernel: Vec<DVec3> = (-radius..=radius)
        .map(f64::from)
        .map(|x| bell(x) * DVec3::new(1.0, -x, (x / deviation).powi(2) - 1.0))
        .collect();
    let positive: DVec3 = kernel.iter().map(|value| value.max(DVec3::ZERO)).sum();
    let negative: DVec3 = kernel.iter().map(|value| (-*value).max(DVec3::ZERO)).sum();
    let scaled = |value: &DVec3| {
        DVec3::from(std::array::from_fn(|k| match value[k] {
            value if value > 0.0 => value / positive[k],
            0.0 => 0.0,
            value => value / negative[k],
        }))
    };
    let kernel: Vec<DVec3> = kernel.iter().map(scaled).collect();
    let grey: Vec<DVec3> = picture.iter().map(|colour| DVec3::splat((colour.x + 16.0) / 116.0)).collect();
    let rows = across(&grey, width, &kernel);
    let smooth: Vec<DVec3> = kernel.iter().map(|value| DVec3::splat(value.x)).collect();
    let along_x = downwards(&rows, width, &smooth);
    let of_rows: Vec<DVec3> = rows.iter().map(|row| DVec3::splat(row.x)).collect();
    let along_y = downwards(&of_rows, width, &kernel);
    let feature = |(x, y): (&DVec3, &DVec3)| DVec3::new(x.y.hypot(y.y), x.z.hypot(y.z), 0.0);
    along_x.iter().zip(&along_y).map(feature).collect()
}

/// A picture filtered along its rows; beyond its rim it goes on as there.
fn across(picture: &[DVec3], width: usize, kernel: &[DVec3]) -> Vec<DVec3> {
    filtered(picture, width, kernel, |x, y, by| (((x as i64 + by).clamp(0, width as i64 - 1)) as usize, y))
}

/// A picture filtered along its columns, likewise.
fn downwards(picture: &[DVec3], width: usize, kernel: &[DVec3]) -> Vec<DVec3> {
    let height = (picture.len() / width.max(1)) as i64;
    filtered(picture, width, kernel, |x, y, by| (x, ((y as i64 + by).clamp(0, height - 1)) as usize))
}

fn filtered(
    picture: &[DVec3],
    width: usize,
    kernel: &[DVec3],
    place: impl Fn(usize, usize, i64) -> (usize, usize) + Sync,
) -> Vec<DVec3> {
    let radius = (kernel.len() / 2) as i64;
    let at = |index: usize| {
        let (x, y) = (index % width, index / width);
        let value = |(by, weight): (i64, &DVec3)| {
            let (x, y) = place(x, y, by);
            *weight * picture[y * width + x]
        };
        (-radius..).zip(kernel).map(value).sum()
    };
    (0..picture.len()).into_par_iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::hash64;

    const SIZE: [u32; 2] = [24, 17];

    fn picture(of: impl Fn(u32, u32) -> [u8; 3]) -> Vec<[u8; 3]> {
        (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect()
    }

    /// Truth: the definition. Nothing differs from itself; even pictures have no features and no
    /// detail to be lost, so that only the colours' HyAB distance counts: from black to white 100,
    /// of the most possible.
    #[test]
    fn even_pictures_differ_by_their_colours() {
        let even = |colour: [u8; 3]| picture(move |_, _| colour);
        assert_eq!(mean_flip(&even([9, 90, 200]), &even([9, 90, 200]), SIZE), 0.0);
        let largest = apart(perceived(DVec3::Y), perceived(DVec3::Z));
        // CIELAB of green and blue as tables have it, (87.735, −86.183, 83.180) and (32.297,
        // 79.188, −107.860), times 0.01·L.
        let [green, blue] = [[87.735, -86.183, 83.180], [32.297, 79.188, -107.860]]
            .map(|[l, a, b]: [f64; 3]| DVec3::new(l, 0.01 * l * a, 0.01 * l * b));
        assert!((largest - apart(green, blue)).abs() < 0.05, "{largest}");
        let power = |distance: f64| distance.powf(0.7);
        let knee = 0.4 * power(largest);
        let expected = 0.95 + 0.05 * (power(100.0) - knee) / (power(largest) - knee);
        let found = mean_flip(&even([0; 3]), &even([255; 3]), SIZE);
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }

    /// Truth: the authors' own program, by `flip-evaluator` 1.7 (Python). Its filters are of single
    /// precision, hence 10⁻⁵.
    #[test]
    fn an_edge_that_moves_and_black_and_white_are_as_published() {
        let edge = |at: u32| picture(move |x, _| if x < at { [20, 30, 40] } else { [200, 180, 160] });
        let of_black_and_white = mean_flip(&picture(|_, _| [0; 3]), &picture(|_, _| [255; 3]), SIZE);
        for (found, expected) in [(mean_flip(&edge(12), &edge(13), SIZE), 0.124_083), (of_black_and_white, 0.967_386)] {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
    }

    /// Truth: the authors' own program, crate `nv-flip` 0.1.2. It computes with single precision
    /// and takes its filters from tables of such, hence 10⁻⁴.
    #[test]
    fn the_mean_is_that_of_the_authors_program() {
        let noise = |seed: u64, x: u32, y: u32| hash64(seed, u64::from(y) << 32 | u64::from(x));
        let random = |seed: u64| picture(move |x, y| noise(seed, x, y).to_le_bytes()[..3].try_into().expect("three"));
        let ramp = picture(|x, y| [(10 * x) as u8, (15 * y) as u8, 128]);
        let grain = picture(|x, y| [(10 * x + (noise(5, x, y) % 12) as u32) as u8, (15 * y) as u8, 120]);
        let edge = picture(|x, _| if x < 12 { [20, 30, 40] } else { [200, 180, 160] });
        let moved = picture(|x, _| if x < 13 { [20, 30, 40] } else { [200, 180, 160] });
        for (one, other) in [(random(1), random(2)), (ramp.clone(), grain), (edge.clone(), moved), (ramp, edge)] {
            let of = |pixels: &[[u8; 3]]| nv_flip::FlipImageRgb8::with_data(SIZE[0], SIZE[1], &pixels.concat());
            let map = nv_flip::flip(of(&one), of(&other), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
            let expected = f64::from(nv_flip::FlipPool::from_image(&map).mean());
            let found = mean_flip(&one, &other, SIZE);
            assert!(expected > 0.01 && (found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }
}
