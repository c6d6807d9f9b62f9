//! Table 2 and sections 3.1 and 3.2: ways to cluster the office, and how soon there is a picture of
//! it.

use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, records, table, times};
use super::lab::{Lab, LeftOut, Room, Run};
use super::report::Report;
use super::{Part, paper, table1};
use crate::base::format::{bytes, count, number, quantity};
use crate::measure::records::Table;
use crate::solve::{ClusteringMode, SolverParams};

const COLUMNS: [Column; 10] = [
    Column::Time,
    Column::InitialPatches,
    Column::Patches,
    Column::Clusters,
    Column::Pairs,
    Column::Links,
    Column::Rays,
    Column::Memory,
    Column::Rms,
    Column::Median,
];

/// Octree depths of the table; the paper gave 2 up.
const DEPTHS: [u32; 5] = [2, 3, 4, 5, 6];

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let epsilon = lab.effort.office_epsilon;
    let params = SolverParams::with_epsilon(epsilon);
    let mut room = lab.room(lab.effort.office);
    let of = |clustering, octree_depth| SolverParams { clustering, octree_depth, ..params };
    let mut settings: Vec<(String, SolverParams)> =
        DEPTHS.iter().map(|&depth| (format!("octree {depth}"), of(ClusteringMode::Octree, depth))).collect();
    settings.push(("groups".into(), of(ClusteringMode::Groups, params.octree_depth)));
    settings.push(("adaptive".into(), params));
    settings.push(("HR (none)".into(), of(ClusteringMode::None, params.octree_depth)));
    let runs = lab.by_turns(&mut room, &settings, lab.effort.repeats);
    let soon = Soon::run(lab, &mut room);

    let caption = format!("{}, ε = {epsilon:e} Φ", room.title());
    let mut tables = vec![table(caption, &COLUMNS, &paper::TABLE_2, &runs)];
    let mut all = records(room.name, &paper::TABLE_2, &runs);
    let mut remarks = left_out_remarks(&runs);
    remarks.push(depth_2(&runs));
    let mut claims = claims_of(&runs);
    match &soon {
        Ok(soon) => {
            tables.push(soon.table());
            all.extend(records(room.name, &[], &[Ok(soon.coarse.clone()), Ok(soon.fine.clone())]));
            claims.push(soon.claim());
        }
        Err(left_out) => claims.push(Claim::unanswered("3.1", SOON, SOON_RULE, &left_out.why)),
    }
    let introduction = format!(
        "Equal ε for all, chosen so that the leaf patches come near the paper's 6,850. `groups` is the paper's USER: the scene's own hierarchy. The paper gave octree depth 2 up when its machine \
         swapped, and had no memory for HR. Times are {}. Memory is the solver's own count of links, elements and radiosities when the solve ends; pairs that wait for their verdict are not in it.",
        table1::timing(lab)
    );
    Report {
        tables,
        remarks,
        records: all,
        claims,
        ..Report::new(Part::Table2, "Table 2: clustering strategies", introduction)
    }
}

fn find<'a>(runs: &'a [Result<Run, LeftOut>], setting: &str) -> Option<&'a Run> {
    runs.iter().flatten().find(|run| run.setting == setting)
}

fn octrees(runs: &[Result<Run, LeftOut>], from_depth: u32) -> Vec<&Run> {
    let is_wanted = |run: &&Run| run.setting.starts_with("octree") && run.params.octree_depth >= from_depth;
    runs.iter().flatten().filter(is_wanted).collect()
}

fn least(runs: &[&Run], of: impl Fn(&Run) -> f64) -> f64 {
    runs.iter().map(|run| of(run)).fold(f64::INFINITY, f64::min)
}

fn most(runs: &[&Run], of: impl Fn(&Run) -> f64) -> f64 {
    runs.iter().map(|run| of(run)).fold(0.0, f64::max)
}

/// Cost of octree depth 2.
fn depth_2(runs: &[Result<Run, LeftOut>]) -> String {
    match (find(runs, "octree 2"), find(runs, "octree 5")) {
        (Some(two), Some(five)) => format!(
            "Octree depth 2, which the paper's machine could not finish, takes {}, {} the time of depth 5, with {} its links and {} its pairs judged, in {}.",
            quantity(two.time(), "s"),
            times(two.time() / five.time()),
            times(two.stats.links as f64 / five.stats.links as f64),
            times(two.stats.pairs_judged as f64 / five.stats.pairs_judged as f64),
            bytes(two.bytes())
        ),
        _ => "Octree depth 2 or 5 did not end.".into(),
    }
}

fn claims_of(runs: &[Result<Run, LeftOut>]) -> Vec<Claim> {
    let (links, time) = (|run: &Run| run.stats.links as f64, Run::time);
    let deep = octrees(runs, 4);
    let all = octrees(runs, 3);
    let mut claims = Vec::new();
    if deep.len() == 3 {
        let (time_spread, link_spread) =
            (most(&deep, time) / least(&deep, time), most(&deep, links) / least(&deep, links));
        claims.push(Claim {
            place: "3.2, Table 2",
            says: "Octrees of depth 4 to 6 are about equal: times within 1.07×, links within 1.002×",
            found: format!("times within {}, links within {}", times(time_spread), times(link_spread)),
            rule: "times and links within 1.5×",
            verdict: Verdict::so(time_spread <= 1.5 && link_spread <= 1.5),
        });
    }
    if let (Some(three), Some(four)) = (find(runs, "octree 3"), find(runs, "octree 4")) {
        let ratios = (three.time() / four.time(), links(three) / links(four));
        claims.push(Claim {
            place: "3.2, Table 2",
            says: "Depth 3 takes 1.3× the time of depth 4 and 1.8× its links",
            found: format!("{} the time, {} the links", times(ratios.0), times(ratios.1)),
            rule: "both above 1.1",
            verdict: Verdict::so(ratios.0 > 1.1 && ratios.1 > 1.1),
        });
    }
    let two = find(runs, "octree 2");
    claims.push(Claim {
        place: "3.2",
        says: "Octree depth 2 cannot be computed: the machine swaps",
        found: two.map_or("it does not end here either".into(), |run| {
            format!("ends after {} with {}", quantity(run.time(), "s"), bytes(run.bytes()))
        }),
        rule: "better where it ends",
        verdict: if two.is_some() { Verdict::Better } else { Verdict::Confirmed },
    });
    if let (Some(user), false) = (find(runs, "groups"), all.is_empty()) {
        let (by_time, by_links) = (least(&all, time) / user.time(), least(&all, links) / links(user));
        claims.push(Claim {
            place: "3.2, Table 2",
            says: "USER is 1.6× as fast as the best octree",
            found: times(by_time),
            rule: "confirmed from 1.2, better from the paper's 1.59",
            verdict: Verdict::at_least(by_time, 1.2, paper::user_time_ratio()),
        });
        claims.push(Claim {
            place: "3.2, Table 2",
            says: "USER has 3.6× fewer links than the best octree",
            found: times(by_links),
            rule: "confirmed from 1.8, better from the paper's 3.56",
            verdict: Verdict::at_least(by_links, 1.8, paper::user_link_ratio()),
        });
        let five = find(runs, "octree 5");
        let medians = (five.map_or(f64::NAN, Run::local_median), user.local_median());
        claims.push(Claim {
            place: "3.2, Figures 5 and 6",
            says: "Octree solutions show artefacts that the scene's own clusters do not",
            found: format!(
                "median error: octree 5 {}, groups {}",
                five.map_or("–".into(), Run::local_median_text),
                user.local_median_text()
            ),
            rule: "the octree's median error is larger at equal ε",
            verdict: Verdict::so(medians.0 > medians.1),
        });
        if let Some(adaptive) = find(runs, "adaptive") {
            let (by_time, by_links) = (user.time() / adaptive.time(), links(user) / links(adaptive));
            claims.push(Claim {
                place: "3.2",
                says: "Adaptive and fast clustering strategies are worth finding: USER is the best there is",
                found: format!(
                    "adaptive has {} fewer links than groups and {} its speed, with {} of its median error",
                    times(by_links),
                    times(by_time),
                    times(adaptive.local_median() / user.local_median())
                ),
                rule: "better where adaptive has fewer links and no more time than groups",
                verdict: if by_links > 1.0 && by_time >= 1.0 { Verdict::Better } else { Verdict::Confirmed },
            });
        }
    }
    claims.extend(memory_claims(runs));
    claims
}

fn memory_claims(runs: &[Result<Run, LeftOut>]) -> Vec<Claim> {
    let hr = find(runs, "HR (none)");
    let mut claims = vec![Claim {
        place: "3.1",
        says: "HR of the office needs 256 MByte for its links: out of memory",
        found: hr.map_or("it does not end within its time".into(), |run| {
            format!(
                "{} for {} links, {}",
                bytes(run.stats.bytes.links),
                count(run.stats.links),
                quantity(run.time(), "s")
            )
        }),
        rule: "better where it ends with less",
        verdict: match hr {
            Some(run) if run.stats.bytes.links < paper::HR_LINK_BYTES => Verdict::Better,
            _ => Verdict::Confirmed,
        },
    }];
    if let Some(run) = find(runs, "adaptive") {
        let (links, trees) = (run.stats.bytes.links, run.stats.bytes.elements);
        claims.push(Claim {
            place: "3.1",
            says: "IC needs less than one MByte for its links and about as much for the trees",
            found: format!(
                "links {}, {} each; trees and radiosities {}",
                bytes(links),
                bytes(links / run.stats.links.max(1)),
                bytes(trees)
            ),
            rule: "confirmed where the links take less than 1 MiB, better where less than half",
            verdict: Verdict::at_most(links as f64, paper::IC_LINK_BYTES as f64, 0.5 * paper::IC_LINK_BYTES as f64),
        });
    }
    claims
}

const SOON: &str = "IC gives a first coarse result quickly: 13.3 s, the fine one 388 s";
const SOON_RULE: &str = "fine over coarse time: confirmed from 10, better from the paper's 29";

/// How soon there is something to be seen.
struct Soon {
    first: f64,
    coarse: Run,
    fine: Run,
}

impl Soon {
    fn run(lab: &mut Lab<'_>, room: &mut Room) -> Result<Self, LeftOut> {
        let [coarse, fine] = lab.effort.coarse_and_fine;
        Ok(Self {
            first: lab.first_picture(room, "first picture", SolverParams::with_epsilon(fine))?,
            coarse: lab.run(room, &format!("coarse, ε = {coarse:e} Φ"), SolverParams::with_epsilon(coarse))?,
            fine: lab.run(room, &format!("fine, ε = {fine:e} Φ"), SolverParams::with_epsilon(fine))?,
        })
    }

    fn table(&self) -> Table {
        let paper = |name: &str, seconds: f64| {
            vec![format!("paper: {name}"), format!("{} s", number(seconds)), "–".into(), "–".into(), "–".into()]
        };
        let of = |run: &Run| {
            vec![
                run.setting.clone(),
                quantity(run.time(), "s"),
                count(run.stats.patches),
                count(run.stats.links),
                run.local_median_text(),
            ]
        };
        let first = vec![
            "first picture".into(),
            quantity(self.first, "s"),
            count(self.coarse.stats.initial_patches),
            "1".into(),
            "–".into(),
        ];
        let coarse = paper("Figure 3, coarse", paper::COARSE_SECONDS);
        let fine = paper("Figure 4, fine", paper::FINE_SECONDS);
        let caption = "How soon there is a picture (Figures 3 and 4), adaptive";
        let head = ["", "time", "patches", "links", "error, median"];
        Table::new(caption, head, vec![coarse, fine, first, of(&self.coarse), of(&self.fine)])
    }

    fn claim(&self) -> Claim {
        let ratio = self.fine.time() / self.coarse.time();
        Claim {
            place: "3.1, Figures 3 and 4",
            says: SOON,
            found: format!(
                "first picture after {}, coarse {}, fine {}: {}",
                quantity(self.first, "s"),
                quantity(self.coarse.time(), "s"),
                quantity(self.fine.time(), "s"),
                times(ratio)
            ),
            rule: SOON_RULE,
            verdict: Verdict::at_least(ratio, 10.0, paper::FINE_SECONDS / paper::COARSE_SECONDS),
        }
    }
}
