//! Section 2.3: the threshold of partly visible links, what ε means when a scene grows, and whether
//! a least area is missed.

use super::Part;
use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, records, table, times};
use super::lab::{Lab, LeftOut, Room, Run};
use super::report::Report;
use super::table1;
use crate::base::format::{count, number, percent};
use crate::measure::records::Table;
use crate::scene::builtin::BuiltinScene;
use crate::solve::{Epsilon, SolverParams};

/// ε_partial/ε, with what the tables call it.
const FACTORS: [(f64, &str); 5] =
    [(1.0, "1"), (1.0 / 3.0, "1/3"), (0.1, "1/10"), (1.0 / 30.0, "1/30"), (0.01, "1/100")];
const COLUMNS: [Column; 6] = [Column::Time, Column::Patches, Column::Links, Column::Rays, Column::Rms, Column::Median];
const SAYS: &str = "ε_partial = ε/10 produces good results";
const RULE: &str = "no other factor has less than 0.9× the median error that 1/10 has with as many rays";
/// Multiples of ε at which 1/10 is run as well, so that every other factor meets it with as many
/// rays.
const MULTIPLES: [f64; 8] = [16.0, 8.0, 4.0, 2.0, 0.5, 0.25, 0.125, 0.0625];

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let mut report = Report::new(
        Part::Partial,
        "Section 2.3: ε_partial and what ε means",
        format!(
            "Adaptive clusters; links whose ends see each other in part are judged by ε_partial. ε is that of Tables 1 and 2, so a smaller ε_partial also makes a finer solution: \
             what counts is what it gains for its rays. Times are {}.",
            table1::timing(lab)
        ),
    );
    for (builtin, epsilon) in lab.effort.rooms() {
        let mut room = lab.room(builtin);
        let of = |partial_factor| SolverParams { partial_factor, ..SolverParams::with_epsilon(epsilon) };
        let settings: Vec<_> =
            FACTORS.iter().map(|(factor, name)| (format!("ε_partial = {name} ε"), of(*factor))).collect();
        let runs = lab.by_turns(&mut room, &settings, lab.effort.repeats);
        let curve = |multiple: &f64| (format!("1/10, {multiple} ε"), SolverParams::with_epsilon(multiple * epsilon));
        let curve = lab.by_turns(&mut room, &MULTIPLES.iter().map(curve).collect::<Vec<_>>(), 1);
        let caption = format!("{}, ε = {epsilon:e} Φ", room.title());
        report.tables.push(table(caption, &COLUMNS, &[], &runs));
        report.remarks.extend(left_out_remarks(&runs));
        let (equal_rays, claim) = good_choice(&room, &runs, &curve);
        report.tables.extend(equal_rays);
        report.claims.push(claim);
        report.records.extend(records(room.name, &[], &runs));
        report.records.extend(records(room.name, &[], &curve));
    }
    scale_invariance(lab, &mut report);
    least_area(lab, &mut report);
    report
}

/// Each factor beside 1/10 with another ε that casts as many rays. Rays stand for time: their
/// number is the same in every run.
fn good_choice(room: &Room, runs: &[Result<Run, LeftOut>], curve: &[Result<Run, LeftOut>]) -> (Option<Table>, Claim) {
    let is_tenth = |run: &&Run| (run.params.partial_factor - 0.1).abs() < 1e-9;
    let point = |run: &Run| (run.stats.rays as f64, run.local_median());
    let mut tenth: Vec<(f64, f64)> = runs.iter().chain(curve).flatten().filter(is_tenth).map(point).collect();
    tenth.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut rows = Vec::new();
    let mut best: Option<(f64, &str)> = None;
    for run in runs.iter().flatten().filter(|run| !is_tenth(run)) {
        let (rays, median) = point(run);
        let beside = between(&tenth, rays);
        let ratio = beside.map(|beside| median / beside);
        let cells = [percent(median), beside.map_or("–".into(), percent), ratio.map_or("–".into(), number)];
        rows.push([vec![run.setting.clone(), count(run.stats.rays)], cells.to_vec()].concat());
        if let Some(ratio) = ratio
            && best.is_none_or(|best| ratio < best.0)
        {
            best = Some((ratio, &run.setting));
        }
    }
    let caption = format!("{}: beside ε_partial = 1/10 ε with an ε that casts as many rays", room.name);
    let table = Table::new(caption, ["", "rays", "error, median", "of 1/10 with as many rays", "ratio"], rows);
    let Some((ratio, setting)) = best else {
        return (None, Claim::unanswered("2.3", SAYS, RULE, "no runs with as many rays"));
    };
    let claim = Claim {
        place: "2.3",
        says: SAYS,
        found: format!(
            "{}: the best other, {setting}, has {} the median error of 1/10 with as many rays",
            room.name,
            times(ratio)
        ),
        rule: RULE,
        verdict: Verdict::so(ratio >= 0.9),
    };
    (Some(table), claim)
}

/// The value at a place of a curve of sorted points, by straight lines between logarithms; `None`
/// beyond its ends.
fn between(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let pair = points.windows(2).find(|pair| pair[0].0 <= x && x <= pair[1].0 && pair[0].0 < pair[1].0)?;
    let along = (x / pair[0].0).ln() / (pair[1].0 / pair[0].0).ln();
    Some(pair[0].1 * (pair[1].1 / pair[0].1).powf(along))
}

/// Solves a room also at twice the size, with ε in watts and with ε as a share of Φ.
fn scale_invariance(lab: &mut Lab<'_>, report: &mut Report) {
    let epsilon = lab.effort.seminar_epsilon;
    let mut room = Room::new(lab.effort.seminar);
    let mut larger = larger(lab.effort.seminar);
    let says = "ε is not scale invariant: it must be scaled with the geometry";
    let rule = "better where ε as a share of Φ gives the same patches at twice the size, and ε in watts does not";
    let runs = (|| {
        let relative = lab.run(&mut room, "ε as a share of Φ", SolverParams::with_epsilon(epsilon))?;
        let watts = SolverParams {
            epsilon: Epsilon::Watts(relative.stats.epsilon_watts),
            ..SolverParams::with_epsilon(epsilon)
        };
        let in_watts = lab.run(&mut larger, "ε in watts, twice the size", watts)?;
        let in_share =
            lab.run(&mut larger, "ε as a share of Φ, twice the size", SolverParams::with_epsilon(epsilon))?;
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
                says,
                found: format!(
                    "{patches} patches; at twice the size {in_watts} with the same watts, {in_share} with the same share of Φ"
                ),
                rule,
                verdict,
            });
            let runs = runs.map(Ok);
            let columns = [Column::Time, Column::Patches, Column::Links, Column::Rays];
            report.tables.push(table("What ε means at twice the size".into(), &columns, &[], &runs));
            report.records.extend(records(room.name, &[], &runs));
        }
        Err(left_out) => report.claims.push(Claim::unanswered("2.3", says, rule, &left_out.why)),
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
    match lab.run(&mut room, "fine, no least area", SolverParams::with_epsilon(fine)) {
        Ok(run) => {
            let struck = run.stats.depth_guard_struck;
            report.claims.push(Claim {
                place: "2.3",
                says,
                found: format!(
                    "{} at ε = {fine:e} Φ: {} patches, median error {}; the guard struck {} times",
                    room.name,
                    count(run.stats.patches),
                    run.local_median_text(),
                    count(struck)
                ),
                rule,
                verdict: Verdict::so(struck == 0),
            });
            report.records.extend(records(room.name, &[], &[Ok(run)]));
        }
        Err(left_out) => report.claims.push(Claim::unanswered("2.3", says, rule, &left_out.why)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: a power law is a straight line in logarithms.
    #[test]
    fn curves_are_read_between_their_points() {
        let curve = [1.0, 10.0, 100.0_f64].map(|x| (x, 3.0 * x.powf(-0.5)));
        assert!(between(&curve, 25.0).is_some_and(|y| (y - 0.6).abs() < 1e-12));
        assert_eq!(between(&curve, 0.5), None);
        assert_eq!(between(&curve, 101.0), None);
    }
}
