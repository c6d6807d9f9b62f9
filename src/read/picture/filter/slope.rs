//! The way back from the mean place of what a sample's light was made of to the sample: along the
//! light's slope, by linear regression over the samples around.

use glam::{Vec2, Vec3, Vec4};

use super::{Grid, Mixed, Narrowness, PLANE, fall_off, likeness};

/// Mean places that lie closer to their samples than this, in deviations of the weights, are taken
/// for the samples': a slope adds noise.
const LEAST_SHIFT: f32 = 0.1;
/// A slope over this, in deviations of the weights, is taken for half of what it seems to be: over
/// little, noise looks like one.
const HALF_SLOPE: f32 = 0.1;
/// Distance between the samples that tell a slope, in deviations of the weights.
const SLOPE_STEP: f32 = 1.0;

/// Light of all parts at a sample, along its slope from the mean places of what it was made of;
/// `widest` is the distance between the samples of the last pass.
pub(super) fn at_own_place<const N: usize>(
    grid: &Grid,
    mixed: &[Mixed<N>],
    narrowness: &[Narrowness<N>],
    widest: i32,
    index: usize,
) -> Vec4 {
    let (here, own) = (&grid.places[index], &mixed[index]);
    let along = own.shift.map(|shift| shift.reject_from_normalized(here.normal));
    let mut light: Vec4 = own.light.iter().sum();
    for part in 0..N {
        let narrowness = narrowness[index][part];
        let square = along[part].length_squared();
        if square * narrowness > LEAST_SHIFT * LEAST_SHIFT {
            light -= square.sqrt() * slope(grid, mixed, part, narrowness, widest, index, along[part] / square.sqrt());
        }
    }
    light.truncate().max(Vec3::ZERO).extend(light.w)
}

/// Change of a part of the light with the way along a unit vector of a surface, by linear
/// regression over 5×5 samples around one, twice as far as the weights reach.
fn slope<const N: usize>(
    grid: &Grid,
    mixed: &[Mixed<N>],
    part: usize,
    narrowness: f32,
    widest: i32,
    index: usize,
    along: Vec3,
) -> Vec4 {
    let [width, height] = grid.size;
    let (x, y) = (index as i32 % width, index as i32 / width);
    let (here, own) = (&grid.places[index], &mixed[index]);
    let across = here.normal.cross(along);
    let per_plane = 1.0 / (PLANE * here.distance);
    let deviation = 1.0 / narrowness.sqrt();
    let step = ((SLOPE_STEP * deviation / (grid.spacing * here.distance)) as i32).clamp(1, widest);
    // Sums over the samples, (1, along, across) by (along, across) and by the light.
    let (mut sum, mut ways, mut squares, mut product) = (0.0, Vec2::ZERO, Vec2::ZERO, 0.0);
    let (mut light, mut rises) = (Vec4::ZERO, [Vec4::ZERO; 2]);
    for down in -2..=2 {
        for right in -2..=2 {
            let (x, y) = (x + right * step, y + down * step);
            if !(0..width).contains(&x) || !(0..height).contains(&y) {
                continue;
            }
            let there = (y * width + x) as usize;
            let (place, there) = (&grid.places[there], &mixed[there]);
            let away = place.position - here.position;
            let fall_off = fall_off(0.25 * narrowness * away.length_squared());
            if fall_off <= 0.0 || there.weight[part] <= 0.0 {
                continue;
            }
            let weight = fall_off * there.weight[part] * likeness(here, place, per_plane);
            let between = away + there.shift[part] - own.shift[part];
            let way = Vec2::new(between.dot(along), between.dot(across));
            // Differences from the sample's own light lose nothing to rounding.
            let rise = there.light[part] - own.light[part];
            sum += weight;
            ways += weight * way;
            squares += weight * way * way;
            product += weight * way.x * way.y;
            light += weight * rise;
            rises[0] += weight * way.x * rise;
            rises[1] += weight * way.y * rise;
        }
    }
    if sum <= 0.0 {
        return Vec4::ZERO;
    }
    let mean = ways / sum;
    let squares = squares - ways * mean + Vec2::splat(sum * (HALF_SLOPE * deviation).powi(2));
    let product = product - ways.x * mean.y;
    let rises = [rises[0] - mean.x * light, rises[1] - mean.y * light];
    (squares.y * rises[0] - product * rises[1]) / (squares.x * squares.y - product * product)
}
