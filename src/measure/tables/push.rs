//! Section 3.3: what pushing irradiance at once costs and what it gains.

use super::claims::{Claim, Verdict};
use super::columns::{Column, records, table, times};
use super::lab::{Lab, Run};
use super::report::Report;
use super::{Part, paper};
use crate::base::format::percent;
use crate::measure::records::Table;
use crate::solve::{ClusteringMode, SolverParams};
use crate::transport::Push;

const COLUMNS: [Column; 5] = [Column::Time, Column::Patches, Column::Links, Column::Rms, Column::Median];
const RULE: &str = "cost: confirmed up to 7.5 %, better up to 2.5 %";

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let turns = lab.effort.push_repeats;
    let mut tables = Vec::new();
    let mut remarks = Vec::new();
    let mut all = vec![vec![("source", "paper".to_owned()), ("cost", paper::PUSH_COST.to_string())]];
    let mut claims = Vec::new();
    let mut summary = vec![vec!["paper: office".into(), "about 5 %".into(), "–".into(), "–".into()]];
    for (builtin, epsilon) in lab.effort.rooms() {
        let mut room = lab.room(builtin);
        for (clustering, name) in [(ClusteringMode::Adaptive, "adaptive"), (ClusteringMode::Groups, "groups")] {
            let of = |push| SolverParams { clustering, push, ..SolverParams::with_epsilon(epsilon) };
            let settings = [("immediate", of(Push::Immediate)), ("deferred", of(Push::Deferred))];
            let settings = settings.map(|(push, params)| (format!("{name}, {push}"), params));
            let label = format!("{}, {name}", room.name);
            let runs: Vec<Run> = match lab.by_turns(&mut room, &settings, turns).into_iter().collect() {
                Ok(runs) => runs,
                Err(left_out) => {
                    remarks.push(format!("Left out: {label}: {}.", left_out.why));
                    let says = "Immediate push costs about 5 % of the time";
                    claims.push(Claim::unanswered("3.3", says, RULE, &left_out.why));
                    continue;
                }
            };
            let cost = cost(&runs[0], &runs[1]);
            let gain = (runs[1].rms() / runs[0].rms(), runs[1].local_median() / runs[0].local_median());
            summary.push(vec![label.clone(), percent(cost), times(gain.0), times(gain.1)]);
            claims.push(Claim {
                place: "3.3",
                says: "Immediate push costs about 5 % of the time",
                found: format!("{label}: {}", percent(cost)),
                rule: RULE,
                verdict: Verdict::at_most(cost, 0.075, 0.025),
            });
            claims.push(Claim {
                place: "3.3, Figures 6 and 7",
                says: "Immediate push improves the quality significantly",
                found: format!(
                    "{label}: deferred has {} the RMS error and {} the median",
                    times(gain.0),
                    times(gain.1)
                ),
                rule: "deferred has at least 1.1× the median error",
                verdict: Verdict::so(gain.1 >= 1.1),
            });
            let runs: Vec<_> = runs.into_iter().map(Ok).collect();
            tables.push(table(format!("{}, ε = {epsilon:e} Φ", room.title()), &COLUMNS, &[], &runs));
            all.extend(records(room.name, &[], &runs));
        }
    }
    let caption = "Cost of immediate over deferred push, and errors of deferred over immediate";
    tables.insert(0, Table::new(caption, ["", "time", "RMS error", "median error"], summary));
    let introduction = format!(
        "Immediate push hands a cluster's irradiance down link by link with each patch's cosine (α-links), deferred evenly afterwards (β-links). {turns} runs of either by turns; \
         the cost is the median over the turns of their ratio, for times are noisy where other work runs beside. The two pushes see different radiosities, so they refine differently; patches and links tell by how much."
    );
    Report {
        tables,
        remarks,
        records: all,
        claims,
        ..Report::new(Part::Push, "Section 3.3: immediate against deferred push", introduction)
    }
}

/// The median over the turns of immediate over deferred, less 1.
fn cost(immediate: &Run, deferred: &Run) -> f64 {
    let ratios: Vec<f64> = immediate.seconds.iter().zip(&deferred.seconds).map(|(a, b)| a / b).collect();
    super::lab::median(&ratios) - 1.0
}
