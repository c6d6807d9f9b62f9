//! `selflink tables` as a person runs it: every file, the paper's rows above ours, a verdict on
//! each claim.

use std::path::Path;
use std::process::Command;

use selflink::measure::tables::{Part, paper};

/// Rows of a CSV file with quotes, as cells by column name.
fn records(csv: &str) -> Vec<Vec<(String, String)>> {
    let cells = |line: &str| {
        let mut cells = vec![String::new()];
        let mut is_quoted = false;
        for c in line.chars() {
            match c {
                '"' => is_quoted = !is_quoted,
                ',' if !is_quoted => cells.push(String::new()),
                c => cells.last_mut().expect("one at least").push(c),
            }
        }
        cells
    };
    let mut lines = csv.lines().map(cells);
    let names = lines.next().expect("a first line");
    lines
        .map(|line| {
            assert_eq!(line.len(), names.len(), "{line:?}");
            names.iter().cloned().zip(line).collect()
        })
        .collect()
}

fn value<'a>(record: &'a [(String, String)], name: &str) -> &'a str {
    record.iter().find(|(known, _)| known == name).map_or("", |(_, value)| value)
}

/// Cells of the lines of Markdown tables.
fn cells(markdown: &str) -> Vec<Vec<&str>> {
    let rows = markdown.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| ---"));
    rows.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

/// Truth: the files promised, the paper's numbers as printed, and the three verdicts. Octree depth
/// 2 and HR come to their end.
#[test]
fn a_quick_run_writes_everything() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("made/paper");
    let output = Command::new(env!("CARGO_BIN_EXE_selflink"))
        .args(["tables", "--quick", "--points", "50", "--noise", "0.3", "--no-cache", "--out"])
        .arg(&out)
        .output()
        .expect("the program runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(stdout.contains("paper: OCTREE3") && stdout.contains("groups"), "{stdout}");
    assert!(stderr.contains("octree 6"), "progress is reported: {stderr}");

    let has_figures = !stderr.contains("the figures are left out");
    assert!(has_figures || cfg!(not(feature = "gui")) || stderr.contains("adapter"), "{stderr}");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    for part in Part::ALL.into_iter().filter(|part| has_figures || *part != Part::Figures) {
        let (page, csv) = (read(&format!("{}.md", part.name())), read(&format!("{}.csv", part.name())));
        assert!(page.contains(&format!("--only {}", part.name())) && page.contains("| --- |"), "{page}");
        let ours: Vec<_> = records(&csv).into_iter().filter(|record| value(record, "source") == "selflink").collect();
        assert!(!ours.is_empty(), "{csv}");
        for record in &ours {
            assert!(value(record, "seconds").parse::<f64>().is_ok_and(|seconds| seconds > 0.0), "{record:?}");
            let pinned = ["epsilon_relative", "clustering", "push", "rays_min", "rays_max", "seed", "threads"];
            assert!(pinned.iter().all(|name| !value(record, name).is_empty()), "{record:?}");
        }
    }
    if has_figures {
        for name in ["figure-2", "figure-3-4", "figure-5-6", "figure-6-7"] {
            picture(&out.join(format!("{name}.png")), 2 * 160 + 8);
            picture(&out.join(format!("{name}-difference.png")), 160);
        }
    }

    let table = read("table1.md");
    let rows = cells(&table);
    let place = |name: &str| rows.iter().position(|row| row[0] == name).unwrap_or_else(|| panic!("{name}: {table}"));
    assert_eq!(rows[place("paper: HR")][1..6], ["1,350 s", "2,008", "2,940", "–", "4,035,032"]);
    assert_eq!(rows[place("paper: IC")][1..6], ["17 s", "2,008", "2,926", "–", "39,593"]);
    assert!(place("paper: IC") < place("HR (none)") && place("HR (none)") < place("IC, adaptive"));
    assert!(rows.iter().any(|row| row[0] == "paper: HR / IC" && row[1] == "79.4×" && row[3] == "102×"), "{table}");

    let table = read("table2.md");
    let rows = cells(&table);
    let place = |name: &str| rows.iter().position(|row| row[0] == name).unwrap_or_else(|| panic!("{name}: {table}"));
    assert_eq!(rows[place("paper: OCTREE4")][1..5], ["90.9 s", "4,038", "6,855", "214"]);
    assert_eq!(rows[place("paper: USER")][1..7], ["57.2 s", "4,038", "6,828", "605", "–", "105,087"]);
    assert!(place("paper: USER") < place("octree 2"));
    let csv = records(&read("table2.csv"));
    let of_paper: Vec<_> = csv.iter().filter(|record| value(record, "source") == "paper").collect();
    assert_eq!(of_paper.len(), paper::TABLE_2.len());
    for (record, row) in of_paper.iter().zip(&paper::TABLE_2) {
        assert_eq!(value(record, "links"), row.links.to_string());
        assert_eq!(value(record, "seconds"), row.seconds.to_string());
    }
    for name in ["octree 2", "HR (none)"] {
        let record = csv.iter().find(|record| value(record, "setting") == name).expect("a record");
        assert!(value(record, "left_out").is_empty() && value(record, "links").parse::<usize>().is_ok(), "{record:?}");
    }

    let readme = read("README.md");
    let claims: Vec<_> = cells(&readme).into_iter().filter(|row| row.len() == 6 && row[0] != "where").collect();
    assert!(claims.len() >= 20, "{readme}");
    for claim in &claims {
        assert!(["*confirmed*", "*better*", "*not so here*"].contains(&claim[3]), "{claim:?}");
        assert!(claim[5].contains("selflink tables --only"), "{claim:?}");
    }
    assert!(read("scale.md").contains("10⁹") && read("scale.md").contains("u32"));
}

fn picture(path: &Path, width: u32) {
    let picture = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!((picture.width(), picture.height()), (width, 100));
}

#[test]
fn what_cannot_be_run_is_said_in_a_sentence() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (args, said) in [
        (["--only", "table3"], "the parts are table1, table2"),
        (["--seconds", "0"], "--seconds must be greater than 0"),
        (["--noise", "2"], "--noise must lie between"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_selflink"))
            .arg("tables")
            .args(args)
            .arg("--out")
            .arg(folder.path().join("never"))
            .output()
            .expect("the program runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(said) && stderr.trim_end().lines().count() == 1, "{stderr}");
        assert!(!folder.path().join("never").exists(), "nothing is made before the arguments are right");
    }
}
