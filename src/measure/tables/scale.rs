//! Sections 1.1 and 1.2: growth with the number of polygons, O(k²) without clusters and O(n) with
//! them, as far as it is measured.

use super::Part;
use super::claims::{Claim, Verdict};
use super::columns::{Column, left_out_remarks, records, table};
use super::fit::PowerLaw;
use super::growth::Growth;
use super::lab::{Lab, LeftOut, Room, Run};
use super::report::Report;
use super::{scale_text, table1};
use crate::base::format::{count, number};
use crate::measure::records::Table;
use crate::scene::builtin::BuiltinScene;
use crate::solve::{ClusteringMode, SolverParams};

const COLUMNS: [Column; 7] =
    [Column::Polygons, Column::Time, Column::Patches, Column::Pairs, Column::Links, Column::Rays, Column::Memory];

/// Runs it.
pub fn run(lab: &mut Lab<'_>) -> Report {
    let params = SolverParams::with_epsilon(lab.effort.scale_epsilon);
    let of = |clustering| SolverParams { clustering, octree_depth: 5, ..params };
    let modes = [
        ("HR (none)", of(ClusteringMode::None), lab.effort.hr_sizes.clone()),
        ("octree 5", of(ClusteringMode::Octree), lab.effort.sizes.clone()),
        ("groups", of(ClusteringMode::Groups), lab.effort.sizes.clone()),
        ("adaptive", of(ClusteringMode::Adaptive), lab.effort.sizes.clone()),
    ];
    let mut sizes: Vec<usize> = modes.iter().flat_map(|mode| mode.2.iter().copied()).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let mut runs: Vec<Vec<Result<Run, LeftOut>>> = modes.iter().map(|_| Vec::new()).collect();
    // Room by room, so that each is built once.
    for polygons in sizes {
        let mut room = Room::new(BuiltinScene::Seminar { polygons });
        for ((name, params, wanted), runs) in modes.iter().zip(&mut runs) {
            if !wanted.contains(&polygons) {
                continue;
            }
            runs.push(match runs.last() {
                Some(Err(_)) => {
                    let why = "a smaller room did not end".to_owned();
                    Err(LeftOut { setting: (*name).to_owned(), polygons, why, longer_than: None })
                }
                _ => lab.run(&mut room, name, *params),
            });
        }
    }
    let growths: Vec<Growth> = modes.iter().zip(runs).map(|(mode, runs)| Growth::new(mode.0, runs)).collect();

    let mut tables = vec![laws(&growths)];
    let mut remarks = Vec::new();
    let mut all = Vec::new();
    for growth in &growths {
        tables.push(table(growth.name.to_owned(), &COLUMNS, &[], &growth.runs));
        remarks.extend(left_out_remarks(&growth.runs));
        all.extend(records("seminar", &[], &growth.runs));
    }
    tables.extend(scale_text::forecast(&growths));
    remarks.extend(scale_text::limits(&growths, lab.effort.scale_epsilon));
    let introduction = format!(
        "Seminar rooms drawn with more rows and more things on the tables, all at ε = {:e} Φ. A run may take {} s. Exponents are least squares in log–log over all runs of a mode. Times are {}; \
         no run has a reference.",
        lab.effort.scale_epsilon,
        lab.effort.cap.as_secs(),
        table1::timing(lab)
    );
    Report {
        tables,
        remarks,
        records: all,
        claims: claims_of(&growths),
        ..Report::new(Part::Scale, "Growth with the number of polygons, and what 10⁷ to 10⁹ would take", introduction)
    }
}

fn laws(growths: &[Growth]) -> Table {
    let cell = |law: Option<PowerLaw>| law.map_or("–".to_owned(), |law| format!("{:.2}", law.exponent));
    let row = |growth: &Growth| {
        let points = growth.runs.iter().flatten().count();
        let laws = [growth.time, growth.links, growth.pairs, growth.memory].map(cell);
        [vec![growth.name.to_owned(), points.to_string()], laws.to_vec()].concat()
    };
    let paper = |name: &str, time: &str| [name, "–", time, "–", "–", "–"].map(String::from).to_vec();
    let of_paper = vec![paper("paper: HR", "2"), paper("paper: IC", "1")];
    let caption = "Exponents p of nᵖ, n polygons; the paper's are its complexities O(k² + n) and O(n)";
    let rows = of_paper.into_iter().chain(growths.iter().map(row)).collect();
    Table::new(caption, ["", "rooms", "time", "links", "pairs judged", "memory"], rows)
}

fn claims_of(growths: &[Growth]) -> Vec<Claim> {
    let exponents = |growth: &Growth| {
        let of = |law: Option<PowerLaw>| law.map_or(f64::NAN, |law| law.exponent);
        [of(growth.time), of(growth.links), of(growth.pairs)]
    };
    let mut claims = Vec::new();
    for growth in growths {
        let [time, links, pairs] = exponents(growth);
        let beyond = growth.least_exponent();
        let numbers =
            format!("{}: time {}, links {}, pairs judged {}", growth.name, number(time), number(links), number(pairs));
        claims.push(if growth.name.starts_with("HR") {
            Claim {
                place: "1.1",
                says: "HR grows as O(k² + n): with many small polygons as k²",
                found: numbers,
                rule: "exponent of the pairs judged between 1.8 and 2.2",
                verdict: Verdict::so((1.8..=2.2).contains(&pairs)),
            }
        } else {
            Claim {
                place: "1.2",
                says: "There is hope that IC grows as O(n)",
                found: match beyond {
                    Some((polygons, exponent)) => format!(
                        "{numbers}; but {} polygons take too long, time there grows with at least {}",
                        count(polygons),
                        number(exponent)
                    ),
                    None => numbers,
                },
                rule: "exponents of time and links: confirmed up to 1.15, better up to 0.85",
                verdict: Verdict::at_most(time.max(links).max(beyond.map_or(0.0, |beyond| beyond.1)), 1.15, 0.85),
            }
        });
    }
    claims
}
