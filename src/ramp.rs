//! Ramps of colour for quantities, legible to the colour-blind; gamma-encoded.

/// The viridis ramp of matplotlib at ten even places (S. van der Walt, N. Smith 2015; public domain).
pub const VIRIDIS: [[u8; 3]; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 74, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [109, 205, 89],
    [180, 222, 44],
    [253, 231, 37],
];

/// From blue over white to red: one side of zero and the other.
pub const BLUE_WHITE_RED: [[u8; 3]; 7] =
    [[24, 78, 160], [84, 146, 206], [170, 206, 232], [245, 245, 245], [248, 190, 160], [226, 110, 84], [168, 24, 40]];

/// What nothing is known about.
const UNKNOWN: [u8; 3] = [96, 96, 100];

/// The colour at a place along a ramp, 0..=1; beyond its ends that of the end, grey where the place is not a number.
pub fn along_ramp<const N: usize>(ramp: &[[u8; 3]; N], along: f32) -> [u8; 3] {
    if along.is_nan() {
        return UNKNOWN;
    }
    let place = along.clamp(0.0, 1.0) * (N - 1) as f32;
    let lower = (place as usize).min(N - 2);
    let mix = place - lower as f32;
    std::array::from_fn(|channel| {
        let (from, to) = (f32::from(ramp[lower][channel]), f32::from(ramp[lower + 1][channel]));
        (from + mix * (to - from)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_end_where_they_end() {
        assert_eq!(along_ramp(&VIRIDIS, -1.0), VIRIDIS[0]);
        assert_eq!(along_ramp(&VIRIDIS, 7.0), VIRIDIS[9]);
        assert_eq!(along_ramp(&BLUE_WHITE_RED, 0.5), [245, 245, 245]);
        assert_eq!(along_ramp(&VIRIDIS, f32::NAN), UNKNOWN);
    }
}
