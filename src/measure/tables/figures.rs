//! Figures 2 to 7: pairs of pictures side by side, and the difference of each pair.

use std::sync::Arc;

use image::{Rgb, RgbImage, RgbaImage, imageops};

use super::Part;
use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, records, table};
use super::lab::{Lab, LeftOut, Run};
use super::report::Report;
use crate::base::format::percent;
use crate::base::photometry::weighted;
use crate::render::{BLUE_WHITE_RED, Camera, Display, Offscreen, Overlay, RenderError, along_ramp, auto_exposure};
use crate::scene::{Scene, builtin::BuiltinScene};
use crate::solve::{ClusteringMode, Snapshot, SolverParams};
use crate::transport::Push;

const COLUMNS: [Column; 5] = [Column::Time, Column::Patches, Column::Links, Column::Rms, Column::Median];
/// Pixels between the two pictures of a pair.
const GAP: u32 = 8;
/// Difference of brightness, as a share of white, that has the full colour.
const FULL_COLOUR: f32 = 0.2;

/// A picture and its name.
pub struct Picture {
    /// File name.
    pub name: String,
    /// Pixels.
    pub pixels: RgbImage,
}

/// Two solutions of one scene that stand side by side.
struct Pair {
    /// Of the files.
    name: &'static str,
    /// Subjects of the paper's figures and of ours.
    caption: String,
    scene: BuiltinScene,
    sides: [(String, SolverParams); 2],
}

fn pairs(lab: &Lab<'_>) -> Vec<Pair> {
    let effort = &lab.effort;
    let (seminar, office) =
        (SolverParams::with_epsilon(effort.seminar_epsilon), SolverParams::with_epsilon(effort.office_epsilon));
    let [coarse, fine] = effort.coarse_and_fine;
    let of = |clustering, params| SolverParams { clustering, octree_depth: 5, ..params };
    let groups = of(ClusteringMode::Groups, office);
    vec![
        Pair {
            name: "figure-2",
            caption: "Figure 2: seminar room, hierarchical radiosity (left) and isotropic clustering (right), equal ε"
                .into(),
            scene: effort.seminar,
            sides: [("HR (none)".into(), of(ClusteringMode::None, seminar)), ("IC, adaptive".into(), seminar)],
        },
        Pair {
            name: "figure-3-4",
            caption: "Figures 3 and 4: office, fast and coarse (left) and fine (right)".into(),
            scene: effort.office,
            sides: [
                (format!("coarse, ε = {coarse:e} Φ"), SolverParams::with_epsilon(coarse)),
                (format!("fine, ε = {fine:e} Φ"), SolverParams::with_epsilon(fine)),
            ],
        },
        Pair {
            name: "figure-5-6",
            caption: "Figures 5 and 6: office, octree of depth 5 (left) and the scene's own clusters (right)".into(),
            scene: effort.office,
            sides: [("octree 5".into(), of(ClusteringMode::Octree, office)), ("groups".into(), groups)],
        },
        Pair {
            name: "figure-6-7",
            caption:
                "Figures 6 and 7: office, the scene's own clusters with immediate (left) and deferred push (right)"
                    .into(),
            scene: effort.office,
            sides: [
                ("groups, immediate".into(), groups),
                ("groups, deferred".into(), SolverParams { push: Push::Deferred, ..groups }),
            ],
        },
    ]
}

/// A pair with its solutions, ready to be drawn.
pub struct SolvedPair {
    pair: Pair,
    sides: Result<Sides, LeftOut>,
}

struct Sides {
    scene: Arc<Scene>,
    solutions: [(Run, Snapshot); 2],
}

/// Solves all pairs, on whatever threads; [`draw`] is for the main thread alone
/// ([`Offscreen::new`]).
pub fn solve(lab: &mut Lab<'_>) -> Vec<SolvedPair> {
    pairs(lab).into_iter().map(|pair| SolvedPair { sides: solve_pair(lab, &pair), pair }).collect()
}

fn solve_pair(lab: &mut Lab<'_>, pair: &Pair) -> Result<Sides, LeftOut> {
    let mut room = lab.room(pair.scene);
    let [left, right] = &pair.sides;
    let left = lab.solve(&mut room, &left.0, left.1)?;
    let right = lab.solve(&mut room, &right.0, right.1)?;
    Ok(Sides { scene: room.scene, solutions: [left, right] })
}

/// Draws solved pairs in a size of pixels.
///
/// # Errors
/// The adapter cannot draw a picture.
pub fn draw(
    solved: Vec<SolvedPair>,
    offscreen: &mut Offscreen,
    size: [u32; 2],
) -> Result<(Report, Vec<Picture>), RenderError> {
    let mut report = Report::new(
        Part::Figures,
        "Figures 2 to 7",
        format!(
            "Each pair has one exposure, that of its right picture. Below each pair the difference of displayed brightness, right less left: white is equal, red is brighter at the right, blue is darker; \
             the full colour is a difference of {} of white. Pictures are drawn by {}.",
            percent(f64::from(FULL_COLOUR)),
            offscreen.adapter()
        ),
    );
    let mut pictures = Vec::new();
    for SolvedPair { pair, sides } in solved {
        match sides {
            Ok(sides) => {
                let [left, right] = draw_pair(&sides, offscreen, size)?;
                let (difference, mean, signed) = difference(&left, &right);
                report.claims.extend(claim(&pair, mean, signed));
                let runs = sides.solutions.map(|(run, _)| Ok(run));
                report.tables.push(table(pair.caption.clone(), &COLUMNS, &[], &runs));
                report.records.extend(records(pair.scene.name(), &[], &runs));
                let name = pair.name;
                report.tables.last_mut().into_iter().for_each(|table| {
                    let [mean, signed] = [mean, signed].map(|share| percent(f64::from(share)));
                    table.caption += &format!("; mean difference {mean} of white, signed {signed}");
                });
                report.pictures.push(format!(
                    "## {}\n\n![{}]({name}.png)\n\n![Difference]({name}-difference.png)",
                    pair.name.replace("figure-", "Figure ").replace('-', " beside "),
                    pair.caption
                ));
                pictures.push(Picture { name: format!("{name}.png"), pixels: side_by_side(&left, &right) });
                pictures.push(Picture { name: format!("{name}-difference.png"), pixels: difference });
            }
            Err(left_out) => report.remarks.extend(left_out_remarks(&[Err(left_out)])),
        }
    }
    Ok((report, pictures))
}

fn draw_pair(sides: &Sides, offscreen: &mut Offscreen, size: [u32; 2]) -> Result<[RgbaImage; 2], RenderError> {
    let [(_, left), (_, right)] = &sides.solutions;
    let camera = Camera::of_scene(&sides.scene, size[0] as f32 / size[1] as f32);
    let display = Display { exposure: auto_exposure(right), ..Display::default() };
    let mut draw = |snapshot| offscreen.picture(snapshot, &camera, &display, &Overlay::default(), size);
    Ok([draw(left)?, draw(right)?])
}

/// HR and IC look alike.
fn claim(pair: &Pair, mean: f32, signed: f32) -> Option<Claim> {
    (pair.name == "figure-2").then(|| Claim {
        place: "3.1, Figure 2",
        says: "The solutions of HR and IC are visually very similar",
        found: format!(
            "the pictures differ by {} of white in the mean, IC less HR with its sign by {}",
            percent(f64::from(mean)),
            percent(f64::from(signed))
        ),
        rule: "at most 2 % of white",
        verdict: Verdict::so(mean <= 0.02),
    })
}

fn side_by_side(left: &RgbaImage, right: &RgbaImage) -> RgbImage {
    let (width, height) = left.dimensions();
    let mut both = RgbImage::from_pixel(2 * width + GAP, height, Rgb([255; 3]));
    for (picture, x) in [(left, 0), (right, width + GAP)] {
        imageops::replace(&mut both, &opaque(picture), i64::from(x), 0);
    }
    both
}

fn opaque(picture: &RgbaImage) -> RgbImage {
    image::DynamicImage::ImageRgba8(picture.clone()).to_rgb8()
}

/// Right less left as colours, and the means of its absolute value and of itself as shares of
/// white.
fn difference(left: &RgbaImage, right: &RgbaImage) -> (RgbImage, f32, f32) {
    let (width, height) = left.dimensions();
    let (mut sum, mut signed) = (0.0, 0.0);
    let pixels = RgbImage::from_fn(width, height, |x, y| {
        let [from, to] = [left, right].map(|picture| brightness(picture.get_pixel(x, y).0));
        sum += (to - from).abs();
        signed += to - from;
        Rgb(along_ramp(&BLUE_WHITE_RED, 0.5 + 0.5 * (to - from) / FULL_COLOUR))
    });
    let count = (width * height).max(1) as f32;
    (pixels, sum / count, signed / count)
}

/// Displayed brightness of a pixel, 0..1 (Rec. 709 weights on encoded values).
fn brightness([r, g, b, _]: [u8; 4]) -> f32 {
    weighted([r, g, b].map(|channel| f32::from(channel) / 255.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked out by hand: equal pixels are white in the ramp, a brighter right one is its red end.
    #[test]
    fn differences_have_a_sign() {
        let picture = |values: [u8; 2]| {
            RgbaImage::from_fn(2, 1, |x, _| {
                image::Rgba([values[x as usize], values[x as usize], values[x as usize], 255])
            })
        };
        let (pixels, mean, signed) = difference(&picture([151, 100]), &picture([151, 202]));
        assert_eq!(pixels.get_pixel(0, 0).0, BLUE_WHITE_RED[3]);
        assert_eq!(pixels.get_pixel(1, 0).0, BLUE_WHITE_RED[6]);
        assert!((mean - 0.2).abs() < 1e-4 && mean == signed, "{mean} {signed}");
        assert_eq!(side_by_side(&picture([1, 2]), &picture([3, 4])).dimensions(), (4 + GAP, 1));
    }
}
