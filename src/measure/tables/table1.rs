//! Table 1 and section 3.1: hierarchical radiosity (HR) against isotropic clustering (IC), seminar
//! room, equal ε.

use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, records, table, times};
use super::effort::Effort;
use super::lab::{Lab, LeftOut, Room, Run};
use super::report::Report;
use super::{Part, paper};
use crate::base::format::{count, number, percent, quantity};
use crate::measure::records::Table;
use crate::solve::{ClusteringMode, SolverParams};
use crate::transport::ClusterModel;

const COLUMNS: [Column; 8] = [
    Column::Time,
    Column::InitialPatches,
    Column::Patches,
    Column::Pairs,
    Column::Links,
    Column::Memory,
    Column::Rms,
    Column::Median,
];

/// HR with this ε/Φ subdivides next to nothing (6 of 2,008 patches of the seminar room): its links
/// are those of initial linking.
const EPSILON_OF_INITIAL_LINKS: f64 = 0.3;
/// IC's ε is halved so often at most, until its error is HR's.
const MOST_HALVINGS: u32 = 8;

/// Every clustering of the table with these parameters.
fn settings(params: SolverParams) -> Vec<(String, SolverParams)> {
    let of = |clustering| SolverParams { clustering, ..params };
    vec![
        ("HR (none)".into(), of(ClusteringMode::None)),
        ("IC, adaptive".into(), of(ClusteringMode::Adaptive)),
        ("IC, groups".into(), of(ClusteringMode::Groups)),
        ("IC, octree 5".into(), SolverParams { octree_depth: 5, ..of(ClusteringMode::Octree) }),
        (
            "IC, adaptive, isotropic clusters".into(),
            SolverParams { cluster_model: ClusterModel::Isotropic, ..of(ClusteringMode::Adaptive) },
        ),
    ]
}

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let epsilon = lab.effort.seminar_epsilon;
    let mut room = lab.room(lab.effort.seminar);
    let settings = settings(SolverParams::with_epsilon(epsilon));
    let mut runs = lab.by_turns(&mut room, &settings, lab.effort.repeats);
    let plain =
        SolverParams { clustering: ClusteringMode::None, ..SolverParams::with_epsilon(EPSILON_OF_INITIAL_LINKS) };
    let initial = lab.run(&mut room, "HR, initial links alone", plain);
    if let Ok(hr) = runs[0].clone() {
        runs.extend(as_accurate(lab, &mut room, &hr, epsilon));
    }
    runs.push(initial);

    let caption = format!("{}, ε = {epsilon:e} Φ", room.title());
    let mut tables = vec![table(caption, &COLUMNS, &paper::TABLE_1, &runs)];
    let mut remarks = left_out_remarks(&runs);
    let mut claims = Vec::new();
    if let (Ok(hr), Ok(ic), Some(Ok(initial))) = (&runs[0], &runs[1], runs.last()) {
        tables.push(ratios(hr, &runs[1..5]));
        remarks.push(format!(
            "The paper's HR kept every pair as a link, 2,008² + 2,968. Ours judges {} pairs, some of them again as radiosities grow, and keeps the {} that see each \
             other: pairs that face away or see nothing of each other have no link.",
            count(hr.stats.pairs_judged),
            count(hr.stats.links)
        ));
        claims.extend(claims_of(hr, ic, initial, runs.iter().flatten().find(|run| is_as_accurate(run))));
    } else {
        let why = "a run of Table 1 did not end";
        claims.push(Claim::unanswered("3.1, Table 1", "HR takes 79× IC's time", "both runs end", why));
    }
    let introduction = format!(
        "Equal ε for all, chosen so that adaptive clusters come near the paper's 2,926 patches; patches are leaves of the subdivision. Times are {}. Error is that of B \
         as displayed, at {} random points against the path-traced reference, whose noise is subtracted: RMS over RMS of B, and the median of the local error, each ± its standard error over the points. Memory is the \
         solver's own count of links, elements and radiosities when the solve ends.",
        timing(lab),
        runs.iter().flatten().find_map(|run| run.error).map_or("–".into(), |error| count(error.points))
    );
    Report {
        tables,
        remarks,
        records: records(room.name, &paper::TABLE_1, &runs),
        claims,
        ..Report::new(Part::Table1, "Table 1: hierarchical radiosity against isotropic clustering", introduction)
    }
}

/// How times are taken, for introductions.
pub fn timing(lab: &Lab<'_>) -> String {
    format!(
        "of building clusters, refining and gathering on {} threads, the ray BVH built before; below {} s the median of {} runs",
        rayon::current_num_threads(),
        Effort::SHORT,
        lab.effort.repeats
    )
}

const AS_ACCURATE: &str = "IC, adaptive, as accurate as HR";

fn is_as_accurate(run: &Run) -> bool {
    run.setting.starts_with(AS_ACCURATE)
}

/// IC with the first half, quarter … of ε whose errors, RMS and median, are no larger than HR's.
fn as_accurate(lab: &mut Lab<'_>, room: &mut Room, hr: &Run, epsilon: f64) -> Option<Result<Run, LeftOut>> {
    for halvings in 0..MOST_HALVINGS {
        let params = SolverParams::with_epsilon(epsilon / f64::from(1 << halvings));
        let setting =
            if halvings == 0 { AS_ACCURATE.to_owned() } else { format!("{AS_ACCURATE}, ε/{}", 1 << halvings) };
        let run = lab.run(room, &setting, params);
        match run {
            Ok(found) if found.rms() > hr.rms() || found.local_median() > hr.local_median() => {}
            other => return Some(other),
        }
    }
    None
}

fn ratios(hr: &Run, others: &[Result<Run, LeftOut>]) -> Table {
    let of_paper = vec![
        "paper: HR / IC".into(),
        times(paper::time_ratio()),
        "–".into(),
        times(paper::link_ratio()),
        "–".into(),
        "–".into(),
    ];
    let of_run = |run: &Run| {
        vec![
            format!("HR / {}", run.setting),
            times(hr.time() / run.time()),
            times(hr.stats.pairs_judged as f64 / run.stats.links as f64),
            times(hr.stats.links as f64 / run.stats.links as f64),
            times(hr.bytes() as f64 / run.bytes() as f64),
            times(run.rms() / hr.rms()),
        ]
    };
    let rows = std::iter::once(of_paper).chain(others.iter().flatten().map(of_run)).collect();
    let head = ["", "time", "pairs judged / links", "links", "memory", "error: IC's over HR's"];
    Table::new("Ratios; in the paper HR's pairs are its links", head, rows)
}

fn claims_of(hr: &Run, ic: &Run, initial: &Run, as_accurate: Option<&Run>) -> Vec<Claim> {
    let initial_patches = hr.stats.initial_patches as f64;
    let pairs = hr.stats.pairs_judged as f64;
    let (links, links_at_first) = (hr.stats.links as f64, initial.stats.links as f64);
    let growth = links / links_at_first - 1.0;
    let (by_pairs, by_links, by_time) =
        (pairs / ic.stats.links as f64, links / ic.stats.links as f64, hr.time() / ic.time());
    let error = ic.rms() / hr.rms();
    let mut claims = vec![
        Claim {
            place: "3.1",
            says: "HR has to consider all pairs of initial patches, k²: more than 4 million",
            found: format!(
                "{} pairs judged, {} k²",
                count(hr.stats.pairs_judged),
                number(pairs / initial_patches.powi(2))
            ),
            rule: "at least k (k − 1) pairs",
            verdict: Verdict::so(pairs >= initial_patches * (initial_patches - 1.0)),
        },
        Claim {
            place: "3.1",
            says: "Beside initial linking, the links that HR's refinement makes can be neglected",
            found: format!(
                "{} links of initial linking, refinement adds {}",
                count(initial.stats.links),
                percent(growth)
            ),
            rule: "refinement adds at most a tenth",
            verdict: Verdict::so(growth <= 0.1),
        },
        Claim {
            place: "3.1, Table 1",
            says: "IC keeps 102× fewer links than HR has pairs",
            found: format!("{}; of links that HR keeps, {}", times(by_pairs), times(by_links)),
            rule: "confirmed from half the paper's ratio, better from the whole",
            verdict: Verdict::at_least(by_pairs, paper::link_ratio() / 2.0, paper::link_ratio()),
        },
        Claim {
            place: "3.1, Table 1",
            says: "HR takes 79× IC's time",
            found: format!("{}: {} and {}", times(by_time), quantity(hr.time(), "s"), quantity(ic.time(), "s")),
            rule: "confirmed from half the paper's ratio, better from the whole",
            verdict: Verdict::at_least(by_time, paper::time_ratio() / 2.0, paper::time_ratio()),
        },
        Claim {
            place: "3.1",
            says: "At equal ε, IC's error is probably larger than HR's",
            found: format!("{} of HR's: {} and {}", times(error), ic.rms_text(), hr.rms_text()),
            rule: "confirmed where it is larger, better where it is not",
            verdict: Verdict::at_least(-error, f64::NEG_INFINITY, -1.0),
        },
    ];
    let says = "IC computes accurate solutions by orders of magnitude faster than HR";
    let rule = "HR's time over that of IC with no larger RMS and median error: confirmed from 10, better from 100";
    claims.push(match as_accurate {
        Some(run) => {
            let ratio = hr.time() / run.time();
            Claim {
                place: "4",
                says,
                found: format!(
                    "{}: HR {} (median {}) in {}, IC {} ({}) in {}",
                    times(ratio),
                    hr.rms_text(),
                    hr.local_median_text(),
                    quantity(hr.time(), "s"),
                    run.rms_text(),
                    run.local_median_text(),
                    quantity(run.time(), "s")
                ),
                rule,
                verdict: Verdict::at_least(ratio, 10.0, 100.0),
            }
        }
        None => Claim::unanswered("4", says, rule, "no ε tried made IC as accurate as HR"),
    });
    claims
}
