//! Section 2.3: the threshold of partly visible links, what ε means when a scene grows, and whether a least area is missed.

use super::Part;
use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, percent, records, table};
use super::lab::{Lab, LeftOut, Room, Run, with_epsilon};
use super::report::Report;
use super::table1;
use crate::format::{count, number};
use crate::scene::builtin::BuiltinScene;
use crate::solver::{Epsilon, SolverParams};

/// ε_partial/ε, with what the tables call it.
const FACTORS: [(f64, &str); 5] =
    [(1.0, "1"), (1.0 / 3.0, "1/3"), (0.1, "1/10"), (1.0 / 30.0, "1/30"), (0.01, "1/100")];
const COLUMNS: [Column; 6] = [Column::Time, Column::Patches, Column::Links, Column::Rays, Column::Rms, Column::Median];
const SAYS: &str = "ε_partial = ε/10 produces good results";
const RULE: &str = "median error · √time, which a better choice lowers, is within 1.15× of the best of the five";

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let part = Part::Partial;
    let mut report = Report {
        part,
        title: "Section 2.3: ε_partial and what ε means".into(),
        introduction: format!(
            "Adaptive clusters; links whose ends see each other in part are judged by ε_partial. ε is that of Tables 1 and 2, so a smaller ε_partial also makes a finer solution: \
             what counts is what it gains for its time. Times are {}.",
            table1::timing(lab)
        ),
        tables: Vec::new(),
        remarks: Vec::new(),
        pictures: Vec::new(),
        records: Vec::new(),
        claims: Vec::new(),
    };
    for (builtin, epsilon) in
        [(lab.effort.seminar, lab.effort.seminar_epsilon), (lab.effort.office, lab.effort.office_epsilon)]
    {
        let mut room = lab.room(builtin);
        let of = |partial_factor| SolverParams { partial_factor, ..with_epsilon(epsilon) };
        let runs: Vec<_> = FACTORS
            .iter()
            .map(|(factor, name)| lab.run(&mut room, &format!("ε_partial = {name} ε"), of(*factor)))
            .collect();
        let caption = format!("{}, ε = {epsilon:e} Φ", room.title());
        report.tables.push(table(caption, &COLUMNS, &[], &runs));
        report.remarks.extend(left_out_remarks(&runs));
        report.claims.push(good_choice(&room, &runs));
        report.records.extend(records(room.name, &[], &runs));
    }
    scale_invariance(lab, &mut report);
    least_area(lab, &mut report);
    report
}

fn good_choice(room: &Room, runs: &[Result<Run, LeftOut>]) -> Claim {
    let merit = |run: &Run| run.local_median() * run.time().sqrt();
    let is_tenth = |run: &&Run| (run.params.partial_factor - 0.1).abs() < 1e-9;
    let Some(tenth) = runs.iter().flatten().find(is_tenth) else {
        return Claim::unanswered("2.3", SAYS, RULE, Part::Partial, "the run did not end");
    };
    let best = runs.iter().flatten().min_by(|a, b| merit(a).total_cmp(&merit(b))).unwrap_or(tenth);
    let ratio = merit(tenth) / merit(best);
    Claim {
        place: "2.3",
        says: SAYS.into(),
        found: format!("{}: {} of the best, which is {}", room.name, number(ratio), best.setting),
        rule: RULE,
        verdict: Verdict::so(ratio <= 1.15),
        part: Part::Partial,
    }
}

/// The same room at twice the size, with ε in watts and with ε as a share of Φ.
fn scale_invariance(lab: &mut Lab<'_>, report: &mut Report) {
    let epsilon = lab.effort.seminar_epsilon;
    let mut room = Room::new(lab.effort.seminar);
    let mut larger = larger(lab.effort.seminar);
    let says = "ε is not scale invariant: it must be scaled with the geometry";
    let rule = "better where ε as a share of Φ gives the same patches at twice the size, and ε in watts does not";
    let runs = (|| {
        let relative = lab.run(&mut room, "ε as a share of Φ", with_epsilon(epsilon))?;
        let watts = SolverParams { epsilon: Epsilon::Watts(relative.stats.epsilon_watts), ..with_epsilon(epsilon) };
        let in_watts = lab.run(&mut larger, "ε in watts, twice the size", watts)?;
        let in_share = lab.run(&mut larger, "ε as a share of Φ, twice the size", with_epsilon(epsilon))?;
        Ok::<_, LeftOut>([relative, in_watts, in_share])
    })();
    match runs {
        Ok(runs) => {
            let [patches, in_watts, in_share] = [0, 1, 2].map(|index| runs[index].stats.patches);
            let verdict = match (in_watts == patches, in_share == patches) {
                (false, true) => Verdict::Better,
                (false, false) => Verdict::Confirmed,
                (true, _) => Verdict::NotSoHere,
            };
            let [patches, in_watts, in_share] = [patches, in_watts, in_share].map(count);
            report.claims.push(Claim {
                place: "2.3",
                says: says.into(),
                found: format!(
                    "{patches} patches; at twice the size {in_watts} with the same watts, {in_share} with the same share of Φ"
                ),
                rule,
                verdict,
                part: Part::Partial,
            });
            let runs = runs.map(Ok);
            let columns = [Column::Time, Column::Patches, Column::Links, Column::Rays];
            report.tables.push(table("What ε means at twice the size".into(), &columns, &[], &runs));
            report.records.extend(records(room.name, &[], &runs));
        }
        Err(left_out) => report.claims.push(Claim::unanswered("2.3", says, rule, Part::Partial, &left_out.why)),
    }
}

/// The room with every length doubled.
fn larger(builtin: BuiltinScene) -> Room {
    let mut scene = builtin.build();
    for vertex in &mut scene.vertices {
        *vertex *= 2.0;
    }
    Room::of_scene(builtin.name(), scene)
}

/// The fine office: nothing bounds the area of patches but the guard against endless depth.
fn least_area(lab: &mut Lab<'_>, report: &mut Report) {
    let [_, fine] = lab.effort.coarse_and_fine;
    let mut room = lab.room(lab.effort.office);
    let says = "A least area of patches is usually not necessary: ε bounds the subdivision near edges and corners";
    let rule = "the guard against endless depth never struck";
    match lab.run(&mut room, "fine, no least area", with_epsilon(fine)) {
        Ok(run) => {
            let struck = run.stats.depth_guard_struck;
            report.claims.push(Claim {
                place: "2.3",
                says: says.into(),
                found: format!(
                    "{} at ε = {fine:e} Φ: {} patches, median error {}; the guard struck {} times",
                    room.name,
                    count(run.stats.patches),
                    percent(run.local_median()),
                    count(struck)
                ),
                rule,
                verdict: Verdict::so(struck == 0),
                part: Part::Partial,
            });
            report.records.extend(records(room.name, &[], &[Ok(run)]));
        }
        Err(left_out) => report.claims.push(Claim::unanswered("2.3", says, rule, Part::Partial, &left_out.why)),
    }
}
