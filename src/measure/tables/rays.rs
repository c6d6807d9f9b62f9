//! Section 2.4: how many visibility rays, what they cost and what the bounds on them do.

use std::time::Instant;

use glam::Vec3;
use rayon::prelude::*;

use super::Part;
use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, records, table};
use super::lab::{Lab, LeftOut, Room, Run, median};
use super::report::Report;
use super::table1;
use crate::base::format::{number, percent};
use crate::measure::reference::random_points_on;
use crate::solve::{ClusteringMode, SolverParams};

const COLUMNS: [Column; 6] = [Column::Time, Column::Patches, Column::Links, Column::Rays, Column::Rms, Column::Median];
/// f_vis, least and most rays of the rows; the first is the usual setting.
const SETTINGS: [(f64, u32, u32); 11] = [
    (5.0, 4, 64),
    (1.0, 4, 64),
    (2.0, 4, 64),
    (10.0, 4, 64),
    (20.0, 4, 64),
    (5.0, 1, 64),
    (5.0, 2, 64),
    (5.0, 8, 64),
    (5.0, 16, 64),
    (5.0, 4, 16),
    (5.0, 4, 256),
];
/// Random points whose pairs tell what a ray costs.
const POINTS: usize = 1 << 12;
/// Rays of one measurement of that cost.
const RAYS: usize = 1 << 18;
/// They end at this share of their length before the faces that they join.
const BEFORE: f32 = 1e-4;
/// Measurements of it; the median counts.
const MEASUREMENTS: usize = 5;

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let mut report = Report::new(
        Part::Rays,
        "Section 2.4: visibility rays",
        format!(
            "A link gets f_vis · BFA/ε rays, within a lower and an upper bound; the first row is the usual setting. Adaptive clusters, ε of Tables 1 and 2. Times are {}.",
            table1::timing(lab)
        ),
    );
    for (builtin, epsilon) in lab.effort.rooms() {
        let mut room = lab.room(builtin);
        let setting = |&(visibility_factor, rays_min, rays_max): &(f64, u32, u32)| {
            let name = format!("f_vis {visibility_factor}, {rays_min} to {rays_max} rays");
            (name, SolverParams { visibility_factor, rays_min, rays_max, ..SolverParams::with_epsilon(epsilon) })
        };
        let settings: Vec<_> = SETTINGS.iter().map(setting).collect();
        let mut runs = lab.by_turns(&mut room, &settings, lab.effort.repeats);
        let caption = format!("{}, ε = {epsilon:e} Φ", room.title());
        report.tables.push(table(caption, &COLUMNS, &[], &runs));
        report.remarks.extend(left_out_remarks(&runs));
        report.claims.extend(lower_bound(&room, &runs));
        let plain = SolverParams { clustering: ClusteringMode::None, ..SolverParams::with_epsilon(epsilon) };
        let hr = lab.run(&mut room, "HR (none)", plain);
        report.claims.extend(share_of_visibility(&room, &runs, &hr));
        runs.push(hr);
        report.records.extend(records(room.name, &[], &runs));
    }
    report.remarks.push(
        "The lower bound binds patches. Of a pair with a cluster at least 12 pairs of points are looked at whatever the bound (`FEWEST_PAIRS` in `src/transport/pair_samples.rs`), for they also tell the \
         cluster's form factor, and those that face each other cast a ray; pairs that seem occluded cast up to 8 rays for each ε_partial before that is believed."
            .into(),
    );
    report
}

fn lower_bound(room: &Room, runs: &[Result<Run, LeftOut>]) -> Vec<Claim> {
    let with_least = |least: u32| {
        let is = |run: &&Run| {
            let params = run.params;
            (params.visibility_factor, params.rays_min, params.rays_max) == (SETTINGS[0].0, least, SETTINGS[0].2)
        };
        runs.iter().flatten().find(is)
    };
    let says = "The lower bound on rays has a significant impact on the time";
    let rule = "a bound of 1 in place of 4 saves at least a tenth of the time";
    let (Some(usual), Some(one)) = (with_least(SETTINGS[0].1), with_least(1)) else {
        return vec![Claim::unanswered("2.4", says, rule, "a run did not end")];
    };
    let saved = 1.0 - one.time() / usual.time();
    let due = 1.0 - one.stats.rays as f64 / usual.stats.rays as f64;
    let at_bound = usual.links_at_bound as f64 / usual.links_with_rays.max(1) as f64;
    vec![
        Claim {
            place: "2.4",
            says,
            found: format!(
                "{}: a bound of 1 saves {} of the time and {} of the rays",
                room.name,
                percent(saved),
                percent(due)
            ),
            rule,
            verdict: Verdict::so(saved >= 0.1),
        },
        Claim {
            place: "2.4",
            says: "The majority of visibility tests is made for low energy interactions",
            found: format!(
                "{}: {} of the links that cast rays need no more than the lower bound",
                room.name,
                percent(at_bound)
            ),
            rule: "more than half of these links",
            verdict: Verdict::so(at_bound > 0.5),
        },
    ]
}

/// How much of the time of IC and HR goes into rays: their number times what one costs.
fn share_of_visibility(room: &Room, runs: &[Result<Run, LeftOut>], hr: &Result<Run, LeftOut>) -> Vec<Claim> {
    let says = "In both IC and HR most of the time is used for visibility tests";
    let rule = "more than half of the threads' time, by rays between random points of the room";
    let cost = seconds_of_a_ray(room);
    let of = |(name, run): (&str, &Result<Run, LeftOut>)| match run {
        Ok(run) => {
            let share = cost * run.stats.rays as f64 / (run.time() * run.threads as f64);
            Claim {
                place: "4",
                says,
                found: format!("{}, {name}: {} ({} ns a ray)", room.name, percent(share), number(1e9 * cost)),
                rule,
                verdict: Verdict::so(share > 0.5),
            }
        }
        Err(left_out) => Claim::unanswered("4", says, rule, &left_out.why),
    };
    let ic = runs.first().map(|run| ("IC", run));
    ic.into_iter().chain([("HR", hr)]).map(of).collect()
}

/// Time of a ray between two random points on one thread while all are at work, s.
fn seconds_of_a_ray(room: &Room) -> f64 {
    let all: Vec<u32> = (0..room.scene.polygons.len() as u32).collect();
    let points: Vec<Vec3> = random_points_on(&room.scene, &all, POINTS, 1).iter().map(|point| point.position).collect();
    if points.is_empty() {
        return 0.0;
    }
    let once = || {
        let begun = Instant::now();
        // An odd stride meets every point, and every pair of them at another distance.
        let blocked = (0..RAYS).into_par_iter().filter(|ray| {
            let (from, to) = (ray % points.len(), (ray * 2_654_435_761 + ray / points.len()) % points.len());
            let (from, to) = (points[from], points[to]);
            // From just before one face to just before the other.
            room.occluders.occluded(from.lerp(to, BEFORE), to.lerp(from, BEFORE))
        });
        let counted = blocked.count();
        let seconds = begun.elapsed().as_secs_f64();
        // The count is used, so that the rays are cast.
        seconds * rayon::current_num_threads() as f64 / RAYS as f64 + if counted > RAYS { f64::NAN } else { 0.0 }
    };
    median(&(0..MEASUREMENTS).map(|_| once()).collect::<Vec<_>>())
}
