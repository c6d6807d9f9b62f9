//! The mean of a texture over a part of its plane, row by row from prefix sums.
//!
//! A face is cut by horizontal lines; along each, texels are summed up exactly, parts of them
//! included, whatever lies beyond the rim.

use glam::{DVec2, Vec3, Vec4};

use super::{LINEAR, Texture, Wrap};

/// Horizontal lines through a face at least and at most; else two for each row of texels.
const LINES: std::ops::RangeInclusive<f64> = 4.0..=512.0;

/// Points along a face that is a line in the texture.
const POINTS_OF_A_LINE: usize = 16;

/// Twice the area of a face, in texels, below which it is a line or a point.
const NO_AREA: f64 = 1e-9;

/// Texture coordinates beyond this many texels hold no fractions of a texel any more.
const FARTHEST: f64 = 1e9;

/// How much a texel counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in super::super) enum Weight {
    /// One.
    Plain,
    /// Alpha of the texture.
    Alpha,
    /// One where its alpha is at least this, of 255.
    AtLeast(u8),
    /// None of them.
    Nothing,
}

/// Sums of weighted colours and of weights, along the rows of a texture.
pub(in super::super) struct RowSums {
    width: u32,
    height: u32,
    wrap: [Wrap; 2],
    /// For each row the sums before its first, second, … and behind its last texel, in 65535ths.
    sums: Vec<[u32; 4]>,
}

impl RowSums {
    /// Sums up a texture.
    pub fn new(texture: &Texture, weight: Weight, wrap: [Wrap; 2]) -> Self {
        let [width, height] = texture.size();
        let linear: [u32; 256] = std::array::from_fn(|step| (65535.0 * LINEAR[step]).round() as u32);
        let mut sums = Vec::with_capacity((width as usize + 1) * height as usize);
        for row in texture.texels().chunks_exact(width as usize) {
            let mut sum = [0_u32; 4];
            sums.push(sum);
            for &[r, g, b, a] in row {
                let share = match weight {
                    Weight::Plain => 255,
                    Weight::Alpha => u32::from(a),
                    Weight::AtLeast(least) => 255 * u32::from(a >= least),
                    Weight::Nothing => 0,
                };
                for (sum, value) in sum.iter_mut().zip([r, g, b].map(|step| linear[usize::from(step)])) {
                    // No row is longer than 65,536 texels.
                    *sum += (value * share + 127) / 255;
                }
                sum[3] += 257 * share;
                sums.push(sum);
            }
        }
        Self { width, height, wrap, sums }
    }

    /// Mean colour of what counts, and the mean weight, over all of it.
    pub fn of_all(&self) -> Vec4 {
        let rows = 0..self.height;
        mean(rows.map(|row| self.before(row, f64::from(self.width))).fold([0.0; 4], add), {
            f64::from(self.width) * f64::from(self.height)
        })
    }

    /// Mean colour of what counts, and the mean weight, over a polygon in the plane of the texture,
    /// whose sides are 1 long.
    pub fn over(&self, corners: impl Iterator<Item = DVec2> + Clone) -> Vec4 {
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        let corners = corners.map(|corner| corner * size);
        if !corners.clone().all(|corner| corner.is_finite() && corner.abs().max_element() <= FARTHEST) {
            return self.of_all();
        }
        let Some(first) = corners.clone().next() else { return self.of_all() };
        let (mut sum, mut length) = ([0.0; 4], 0.0);
        for (b, c) in corners.clone().skip(1).zip(corners.clone().skip(2)) {
            let twice_area = (b - first).perp_dot(c - first).abs();
            if twice_area > NO_AREA {
                let (of_triangle, its_length) = self.over_triangle([first, b, c]);
                let weight = 0.5 * twice_area / its_length.max(f64::MIN_POSITIVE);
                sum = add(sum, of_triangle.map(|value| value * weight));
                length += weight * its_length;
            }
        }
        if length > 0.0 { mean(sum, length) } else { self.along(corners) }
    }

    /// Sum along the lines that cut a triangle, and their length.
    fn over_triangle(&self, corners: [DVec2; 3]) -> ([f64; 4], f64) {
        let mut sorted = corners;
        sorted.sort_by(|a, b| a.y.total_cmp(&b.y));
        let [top, middle, bottom] = sorted;
        let height = bottom.y - top.y;
        let count = (2.0 * height).ceil().clamp(*LINES.start(), *LINES.end());
        let (mut sum, mut length) = ([0.0; 4], 0.0);
        for line in 0..count as u32 {
            let y = top.y + height * (f64::from(line) + 0.5) / count;
            let on = |from: DVec2, to: DVec2| from.x + (to.x - from.x) * ((y - from.y) / (to.y - from.y));
            let long = on(top, bottom);
            let short = if y < middle.y { on(top, middle) } else { on(middle, bottom) };
            let (from, to) = (long.min(short), long.max(short));
            let row = self.wrap[1].texel(y.floor() as i64, self.height);
            let (before, behind) = (self.before(row, from), self.before(row, to));
            sum = add(sum, std::array::from_fn(|colour| behind[colour] - before[colour]));
            length += to - from;
        }
        (sum, length)
    }

    /// Mean along the two corners of a line that lie farthest apart, or at a point.
    fn along(&self, corners: impl Iterator<Item = DVec2> + Clone) -> Vec4 {
        let first = corners.clone().next().unwrap_or_default();
        let farthest = |from: DVec2| {
            let distance = |corner: &DVec2| corner.distance_squared(from);
            corners.clone().max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(from)
        };
        let from = farthest(first);
        let to = farthest(from);
        let mut sum = [0.0; 4];
        for step in 0..POINTS_OF_A_LINE {
            let at = from.lerp(to, (step as f64 + 0.5) / POINTS_OF_A_LINE as f64);
            let (column, row) = (at.x.floor(), self.wrap[1].texel(at.y.floor() as i64, self.height));
            let column = self.wrap[0].texel(column as i64, self.width);
            let [before, behind] = [column, column + 1].map(|column| self.before(row, f64::from(column)));
            sum = add(sum, std::array::from_fn(|colour| behind[colour] - before[colour]));
        }
        mean(sum, POINTS_OF_A_LINE as f64)
    }

    /// Sum along a row from 0 to `x` texels, which may lie anywhere.
    fn before(&self, row: u32, x: f64) -> [f64; 4] {
        let start = row as usize * (self.width as usize + 1);
        let row = &self.sums[start..=start + self.width as usize];
        let width = f64::from(self.width);
        let inside = |x: f64| -> [f64; 4] {
            let texel = (x.floor() as usize).min(self.width as usize - 1);
            let part = x - texel as f64;
            std::array::from_fn(|colour| {
                let (low, high) = (f64::from(row[texel][colour]), f64::from(row[texel + 1][colour]));
                (low + part * (high - low)) / 65535.0
            })
        };
        let whole = |times: f64, rest: [f64; 4]| -> [f64; 4] {
            let all = row[self.width as usize].map(|sum| f64::from(sum) / 65535.0);
            std::array::from_fn(|colour| times * all[colour] + rest[colour])
        };
        match self.wrap[0] {
            Wrap::Repeat => {
                let times = (x / width).floor();
                whole(times, inside((x - times * width).clamp(0.0, width)))
            }
            Wrap::Mirror => {
                let times = (x / (2.0 * width)).floor();
                let rest = (x - times * 2.0 * width).clamp(0.0, 2.0 * width);
                if rest <= width {
                    whole(2.0 * times, inside(rest))
                } else {
                    whole(2.0 * times + 2.0, inside(2.0 * width - rest).map(|value| -value))
                }
            }
            Wrap::Clamp => {
                let rim = |texel: f64, length: f64| -> [f64; 4] {
                    let (before, behind) = (inside(texel), inside(texel + 1.0));
                    std::array::from_fn(|colour| length * (behind[colour] - before[colour]))
                };
                match x {
                    x if x < 0.0 => rim(0.0, x),
                    x if x > width => whole(1.0, rim(width - 1.0, x - width)),
                    x => inside(x),
                }
            }
        }
    }
}

fn add(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|colour| a[colour] + b[colour])
}

/// The mean colour of what counts, and the mean weight; black where nothing counts.
fn mean([r, g, b, weight]: [f64; 4], length: f64) -> Vec4 {
    let colour = if weight > 0.0 { [r, g, b].map(|sum| (sum / weight) as f32) } else { [0.0; 3] };
    let share = if length > 0.0 { (weight / length) as f32 } else { 0.0 };
    Vec3::from_array(colour).clamp(Vec3::ZERO, Vec3::ONE).extend(share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 4] = [255; 4];
    const BLACK: [u8; 4] = [0, 0, 0, 255];

    fn over(texels: Vec<[u8; 4]>, width: u32, wrap: Wrap, weight: Weight, corners: &[[f64; 2]]) -> Vec4 {
        let texture = Texture::new(width, texels.len() as u32 / width, texels);
        RowSums::new(&texture, weight, [wrap; 2]).over(corners.iter().map(|corner| DVec2::from_array(*corner)))
    }

    fn square(from: f64, to: f64) -> [[f64; 2]; 4] {
        [[from, 0.0], [to, 0.0], [to, 1.0], [from, 1.0]]
    }

    /// Truth: counted by hand; a white and a black texel, and parts of them.
    #[test]
    fn parts_of_texels_count_by_their_area() {
        let red = |wrap, from, to| over(vec![WHITE, BLACK], 2, wrap, Weight::Plain, &square(from, to)).x;
        let near = |value: f32, truth: f32| assert!((value - truth).abs() < 1e-4, "{value} is not {truth}");
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            near(red(wrap, 0.0, 1.0), 0.5);
            near(red(wrap, 0.0, 0.5), 1.0);
            near(red(wrap, 0.25, 1.0), 1.0 / 3.0);
        }
        near(red(Wrap::Repeat, 0.5, 1.5), 0.5);
        near(red(Wrap::Repeat, 3.0, 3.5), 1.0);
        near(red(Wrap::Mirror, 0.5, 1.5), 0.0);
        near(red(Wrap::Mirror, -0.5, 0.5), 1.0);
        near(red(Wrap::Mirror, 1.0, 2.0), 0.5);
        near(red(Wrap::Clamp, -1.0, 0.0), 1.0);
        near(red(Wrap::Clamp, -1.0, 1.0), 0.75);
        near(red(Wrap::Clamp, 1.0, 9.0), 0.0);
    }

    /// Truth: by hand; a triangle over the upper left half of four texels holds one of them whole
    /// and two half.
    #[test]
    fn triangles_lines_and_points() {
        let four = vec![WHITE, BLACK, BLACK, BLACK];
        let red = |corners: &[[f64; 2]]| over(four.clone(), 2, Wrap::Repeat, Weight::Plain, corners).x;
        assert!((red(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]) - 0.5).abs() < 0.01);
        assert_eq!(red(&[[0.25, 0.25]; 3]), 1.0);
        assert_eq!(red(&[[0.75, 0.25]; 3]), 0.0);
        assert!((red(&[[0.0, 0.25], [1.0, 0.25], [0.5, 0.25]]) - 0.5).abs() < 1e-6);
        assert_eq!(red(&[[f64::NAN, 0.0], [1.0, 0.0], [0.0, 1.0]]), 0.25, "all of it");
    }

    /// Truth: by hand; a clear texel has no colour, and two of three texels are there.
    #[test]
    fn clear_texels_count_by_their_alpha() {
        let three = || vec![WHITE, BLACK, [99, 1, 2, 0]];
        let alpha = over(three(), 3, Wrap::Repeat, Weight::Alpha, &square(0.0, 1.0));
        assert!((alpha - Vec4::new(0.5, 0.5, 0.5, 2.0 / 3.0)).abs().max_element() < 1e-4, "{alpha}");
        let masked = over(three(), 3, Wrap::Repeat, Weight::AtLeast(128), &square(0.0, 1.0));
        assert_eq!(masked, alpha);
        assert_eq!(over(three(), 3, Wrap::Repeat, Weight::Alpha, &square(2.0 / 3.0, 1.0)).w, 0.0);
    }
}
