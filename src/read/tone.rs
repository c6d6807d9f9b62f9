//! From radiosity in W/m² to a colour on the screen: exposure, filmic tone curve, gamma.
//!
//! Exposure: the log-average key of Reinhard et al., "Photographic Tone Reproduction for Digital
//! Images", SIGGRAPH 2002. Tone curve: the rational fit to the ACES filmic curve of K. Narkowicz,
//! "ACES Filmic Tone Mapping Curve", 2015, per channel.

use crate::base::photometry::weighted;
use crate::solve::snapshot::Snapshot;

/// Exposed log-average luminance of a well exposed picture, before the tone curve. Photography's
/// 0.18 is the key of a landscape; rooms are mostly pale walls.
const KEY: f32 = 0.16;
/// The brightest lit surfaces are exposed to this at most; the tone curve shows it as 0.95 of
/// white.
const HIGHLIGHT: f32 = 2.5;
/// Share of the lit area that may be brighter than `HIGHLIGHT`.
const HIGHLIGHT_AREA: f64 = 0.02;
/// What is brighter darkens the picture by no more than this: a patch of sun is blown out before
/// the room around it is black.
const MOST_DARKENED: f32 = 4.0;
/// Shares of the lit area, from the darkest, whose log-average is taken: a few very dark or very
/// bright leaves do not count.
const COUNTED_AREA: (f64, f64) = (0.1, 0.95);
/// Leaves darker than this share of the mean count as unlit: outsides of walls that a leak reaches.
const UNLIT_SHARE: f64 = 1e-4;
/// More leaves than this are sampled evenly, so that a large mesh costs a few milliseconds at most.
const MOST_LEAVES: usize = 1 << 14;

/// How bright the picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// [`auto_exposure`], corrected by a number of stops (powers of two).
    Auto {
        /// Correction, stops; positive is brighter.
        stops: f32,
    },
    /// By hand: 0 stops shows 1 W/m² as 1, before the tone curve.
    Manual {
        /// Base-2 logarithm of the factor on radiosities, stops.
        stops: f32,
    },
}

impl Default for Exposure {
    fn default() -> Self {
        Self::Auto { stops: 0.0 }
    }
}

impl Exposure {
    /// The factor on radiosities, m²/W, for a snapshot whose [`auto_exposure`] is `auto`.
    pub fn factor(self, auto: f32) -> f32 {
        match self {
            Self::Auto { stops } => auto * stops.exp2(),
            Self::Manual { stops } => stops.exp2(),
        }
    }
}

/// The factor on radiosities, m²/W, that exposes a snapshot well; 1 where nothing is lit.
///
/// Takes the log-average luminance over the lit area, lamps aside, so that it neither follows the
/// camera nor jumps when a lamp comes into view, and scales inversely with the light.
pub fn auto_exposure(snapshot: &Snapshot) -> f32 {
    let step = snapshot.leaf_radiosity.len().div_ceil(MOST_LEAVES).max(1);
    let leaves = || snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity).zip(&snapshot.leaf_irradiance);
    let collect = |with_lamps: bool| -> Vec<(f64, f64)> {
        leaves()
            .step_by(step)
            .map(|((leaf, &radiosity), &irradiance)| {
                (luminance(radiosity), luminance(irradiance), f64::from(leaf.area))
            })
            // What sends out more than it receives is a lamp.
            .filter(|&(sent, received, _)| with_lamps || sent <= received)
            .map(|(sent, _, area)| (sent, area))
            .filter(|&(sent, area)| sent > 0.0 && sent.is_finite() && area > 0.0 && area.is_finite())
            .collect()
    };
    let mut lit = collect(false);
    if lit.is_empty() {
        lit = collect(true);
    }
    let area: f64 = lit.iter().map(|&(_, area)| area).sum();
    let mean = lit.iter().map(|&(sent, area)| sent * area).sum::<f64>() / area;
    lit.retain(|&(sent, _)| sent >= UNLIT_SHARE * mean);
    lit.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(brightest, _)) = lit.last() else { return 1.0 };

    let area: f64 = lit.iter().map(|&(_, area)| area).sum();
    let (lowest, highest) = (COUNTED_AREA.0 * area, COUNTED_AREA.1 * area);
    let (mut below, mut counted, mut logs, mut highlight) = (0.0, 0.0, 0.0, brightest);
    for &(sent, area_here) in &lit {
        let upto = below + area_here;
        let share = (upto.min(highest) - below.max(lowest)).max(0.0);
        counted += share;
        logs += share * sent.ln();
        if below <= (1.0 - HIGHLIGHT_AREA) * area {
            highlight = sent;
        }
        below = upto;
    }
    exposed((logs / counted).exp(), highlight).unwrap_or(1.0)
}

/// The factor that brings the middle of a picture's radiosities (W/m²) to the key, unless what is
/// bright would be blown out.
fn exposed(middle: f64, highlight: f64) -> Option<f32> {
    let to_key = f64::from(KEY) / middle;
    // No `clamp`: it panics where the middle is no number.
    let exposure = (f64::from(HIGHLIGHT) / highlight).min(to_key).max(to_key / f64::from(MOST_DARKENED));
    (exposure.is_finite() && exposure > 0.0).then(|| exposure.clamp(1e-30, 1e30) as f32)
}

/// The factor on radiosities, m²/W, that exposes what is seen well: its median is brought to the
/// key, unless a share of it would then be blown out. `None` where nothing lit is seen. Radiosities
/// are weighted as the eye does, W/m², and those of equal parts of the view, lamps aside.
pub fn exposure_of_seen(radiosities: &mut [f32]) -> Option<f32> {
    radiosities.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| radiosities.get((share * radiosities.len() as f64) as usize).copied();
    let (median, highlight) = (at(0.5)?, at(1.0 - HIGHLIGHT_AREA)?);
    if median > 0.0 && highlight.is_finite() { exposed(median.into(), highlight.into()) } else { None }
}

/// Luminance of a linear RGB radiosity, W/m².
fn luminance(radiosity: [f32; 3]) -> f64 {
    weighted(radiosity).into()
}

/// Filmic tone curve of one linear, exposed channel: 0..∞ to 0..1 (Narkowicz 2015).
pub fn tone_curve(exposed: f32) -> f32 {
    // Far beyond white the curve is flat, and its square must stay finite.
    let x = exposed.clamp(0.0, 1e4);
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
}

/// sRGB gamma encoding of one linear channel, 0..1 (IEC 61966-2-1).
pub fn encode_gamma(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear value of one sRGB-encoded channel, 0..1 (IEC 61966-2-1).
pub fn decode_gamma(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Colour in a picture of a radiosity, W/m²: exposed by a factor in m²/W, bent and gamma-encoded to
/// 8 bits a channel.
pub fn shown_colour(radiosity: [f32; 3], exposure: f32) -> [u8; 3] {
    radiosity.map(|channel| (255.0 * encode_gamma(tone_curve(exposure * channel))).round() as u8)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::solve::snapshot::{Leaf, Mesh};

    /// Leaves by area, radiosity and irradiance, grey.
    fn snapshot(leaves: &[(f32, f32, f32)]) -> Snapshot {
        let leaf = |&(area, ..): &(f32, f32, f32)| Leaf { area, reachable_area: area, ..Leaf::square_metre(1, 0) };
        Snapshot {
            mesh: Arc::new(Mesh { leaves: leaves.iter().map(leaf).collect(), ..Mesh::default() }),
            leaf_irradiance: leaves.iter().map(|leaf| [leaf.2; 3]).collect(),
            leaf_radiosity: leaves.iter().map(|leaf| [leaf.1; 3]).collect(),
            ..Snapshot::default()
        }
    }

    #[test]
    fn an_even_room_is_exposed_to_the_key_whatever_its_light() {
        // Truth: the definition; f32 rounding only.
        for radiosity in [1e-6, 0.2, 3e5] {
            let exposed = radiosity * auto_exposure(&snapshot(&[(1.0, radiosity, 2.0 * radiosity); 20]));
            assert!((exposed / KEY - 1.0).abs() < 1e-5, "{exposed}");
        }
    }

    #[test]
    fn lamps_and_unlit_leaves_do_not_count() {
        let room = vec![(1.0, 0.5, 1.0); 50];
        let alone = auto_exposure(&snapshot(&room));
        let mut lit = room.clone();
        // A lamp of a fifth of the area, outsides that nothing or a leak reaches.
        lit.extend([(10.0, 500.0, 1.0), (40.0, 0.0, 0.0), (40.0, 1e-9, 1e-9)]);
        let with_lamp = auto_exposure(&snapshot(&lit));
        assert!((with_lamp / alone - 1.0).abs() < 1e-5, "{with_lamp} {alone}");
    }

    /// Truth: the definition. A bright tenth of a room is not blown out, but a patch of sun a
    /// thousand times as bright leaves the room around it to be seen.
    #[test]
    fn what_is_bright_darkens_a_room_by_two_stops_at_most() {
        let with_bright = |bright: f32| {
            let mut leaves = vec![(1.0, 0.1, 0.2); 90];
            leaves.extend([(1.0, bright, 2.0 * bright); 10]);
            (
                auto_exposure(&snapshot(&leaves)),
                exposure_of_seen(&mut leaves.iter().map(|leaf| leaf.1).collect::<Vec<_>>()),
            )
        };
        let (of_area, of_seen) = with_bright(3.0);
        assert!((3.0 * of_area - HIGHLIGHT).abs() < 1e-4, "{of_area}");
        assert_eq!(of_seen, Some(HIGHLIGHT / 3.0));
        let (of_area, of_seen) = with_bright(100.0);
        // The brightest twentieth of the area does not count, nor does the darkest tenth.
        let middle = 0.1 * 1000.0_f32.powf(5.0 / 85.0);
        assert!((of_area * middle / KEY * MOST_DARKENED - 1.0).abs() < 1e-4, "{of_area}");
        assert!(of_seen.is_some_and(|of_seen| (0.1 * of_seen - KEY / MOST_DARKENED).abs() < 1e-5), "{of_seen:?}");
    }

    #[test]
    fn nothing_lit_or_not_a_number_gives_a_usable_exposure() {
        assert_eq!(auto_exposure(&snapshot(&[])), 1.0);
        assert_eq!(auto_exposure(&snapshot(&[(1.0, 0.0, 0.0); 3])), 1.0);
        assert_eq!(auto_exposure(&snapshot(&[(1.0, f32::NAN, 1.0), (f32::NAN, 1.0, 1.0)])), 1.0);
        // Lamps alone: the picture is of them.
        assert!((auto_exposure(&snapshot(&[(1.0, 5.0, 0.0); 3])) - KEY / 5.0).abs() < 1e-5);
    }

    #[test]
    fn a_large_mesh_is_sampled_to_nearly_the_same_exposure() {
        // Truth: the same mixture in few leaves; sampling every n-th leaf of an aperiodic mixture
        // costs below 1 %.
        let leaf = |index: usize| (1.0, 0.1 + 0.9 * ((index * 7919) % 10_007) as f32 / 10_007.0, 5.0);
        let few: Vec<_> = (0..20_014).map(leaf).collect();
        let many: Vec<_> = (0..300_210).map(leaf).collect();
        let ratio = auto_exposure(&snapshot(&few)) / auto_exposure(&snapshot(&many));
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }

    /// Truth: the definition, by hand.
    #[test]
    fn the_median_of_what_is_seen_is_brought_to_the_key() {
        let mut even: Vec<f32> = (0..101).map(|index| 0.5 + 0.01 * index as f32).collect();
        assert!((exposure_of_seen(&mut even).expect("lit") - KEY).abs() < 1e-6);
        let mut window = vec![0.1; 90];
        window.extend([5.0; 10]);
        assert_eq!(exposure_of_seen(&mut window), Some(HIGHLIGHT / 5.0));
        assert_eq!(exposure_of_seen(&mut [0.0, 0.0, 1.0]), None);
        assert_eq!(exposure_of_seen(&mut []), None);
    }

    #[test]
    fn the_tone_curve_rises_from_black_to_white_and_rolls_off() {
        assert_eq!((tone_curve(0.0), tone_curve(-1.0), tone_curve(f32::MAX)), (0.0, 0.0, 1.0));
        let values: Vec<f32> = (0..=100).map(|step| tone_curve(0.05 * step as f32)).collect();
        assert!(values.is_sorted_by(|a, b| a < b), "strictly rising below white");
        assert!((0.9..1.0).contains(&tone_curve(HIGHLIGHT)));
        // Truth: IEC 61966-2-1 at its ends and its joint.
        assert!(encode_gamma(0.0) == 0.0 && (encode_gamma(1.0) - 1.0).abs() < 1e-6);
        assert!((encode_gamma(0.003_130_8) - encode_gamma(0.003_130_9)).abs() < 1e-5);
    }
}
