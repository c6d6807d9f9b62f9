//! What documents say: links lead somewhere, commands and options exist, figures of the README are
//! those of the charts.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use selflink::base::format::{plus_minus, seconds};

/// Bytes of the README: short enough to be read whole.
const MOST_OF_README: usize = 7000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All pages: those at the top and the book.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("README.md"), root().join("CONTRIBUTING.md"), root().join("CHANGELOG.md")];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|ending| ending == "md") {
                pages.push(entry);
            }
        }
    }
    pages.sort();
    pages
}

/// Targets of a page's links and pictures, but for those of the web.
fn links(text: &str) -> Vec<String> {
    let ends = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    ends.map(|(link, _)| link.to_owned()).filter(|link| !link.contains("://")).collect()
}

/// Names of a page's headings in links: lower case, words joined by hyphens, no other signs.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let plain = |heading: &str| {
        let kept = heading.to_lowercase();
        kept.chars()
            .filter(|c| c.is_alphanumeric() || "-_ ".contains(*c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    headings.map(plain).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut seen = 0;
    for page in pages() {
        let text = read(&page);
        for link in links(&text) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { page.clone() } else { page.with_file_name("").join(file) };
            assert!(target.exists(), "{}: {link}", page.display());
            if !anchor.is_empty() {
                assert!(anchors(&read(&target)).contains(anchor), "{}: {link}", page.display());
            }
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen} links");
}

/// The book's table of contents has every page of it.
#[test]
fn the_book_is_whole() {
    let book = root().join("docs");
    let listed: BTreeSet<PathBuf> =
        links(&read(&book.join("SUMMARY.md"))).into_iter().map(|link| book.join(link)).collect();
    let there: BTreeSet<PathBuf> =
        pages().into_iter().filter(|page| page.starts_with(&book) && !page.ends_with("SUMMARY.md")).collect();
    assert_eq!(listed, there);
}

fn help(command: Option<&str>) -> Option<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_selflink")).args(command).arg("--help").output();
    let output = output.expect("the program runs");
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Truth: the program's own help. Each `selflink` line of a code block, and each in a sentence,
/// names a command that is there and options that it has.
#[test]
fn commands_and_options_are_there() {
    let top = help(None).expect("help");
    let commands = top.split_once("Commands:").expect("commands").1;
    let commands: BTreeSet<&str> = commands
        .lines()
        .filter_map(|line| line.strip_prefix("  "))
        .filter(|line| !line.starts_with(' '))
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    let mut helps: BTreeMap<Option<String>, String> = BTreeMap::new();
    let mut tried = 0;
    for page in pages() {
        // History names commands of its day.
        if page.ends_with("CHANGELOG.md") {
            continue;
        }
        let text = read(&page);
        let lines = text.lines().filter(|line| line.starts_with("selflink "));
        let quoted = text.split('`').skip(1).step_by(2).filter(|code| code.starts_with("selflink "));
        for line in lines.chain(quoted) {
            let line = line.split(" #").next().unwrap_or(line);
            let words: Vec<&str> = line.split_whitespace().skip(1).collect();
            let command = words.first().copied().filter(|word| commands.contains(word));
            // The name alone opens the window.
            if words.is_empty() {
                continue;
            }
            // Without a window there are no pictures.
            if words.first() == Some(&"render") && cfg!(not(feature = "gui")) {
                continue;
            }
            let is_scene = |word: &str| {
                word.starts_with('-') || word.contains('.') || ["SCENE", "seminar", "office", "cornell"].contains(&word)
            };
            assert!(
                command.is_some() || words.first().is_some_and(|word| is_scene(word)),
                "{}: {line}",
                page.display()
            );
            let known = helps.entry(command.map(str::to_owned)).or_insert_with(|| help(command).expect("help"));
            let known: BTreeSet<&str> = known.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-')).collect();
            for option in words.iter().filter(|word| word.starts_with("--")) {
                let option = option.trim_end_matches(|c: char| !c.is_ascii_alphanumeric());
                assert!(known.contains(option), "{}: {line}: {option}", page.display());
                tried += 1;
            }
        }
    }
    assert!(tried > 60, "{tried} options");
}

/// Truth: the tables of the charts, which `selflink chart` writes. After they are run again the
/// lines that this test asks for are to be put in.
#[test]
fn figures_of_the_readme_are_those_of_the_charts() {
    let readme = read(&root().join("README.md"));
    assert!(readme.len() <= MOST_OF_README, "{} bytes", readme.len());
    for scene in ["cornell", "seminar", "office"] {
        let text = read(&root().join(format!("docs/accuracy/{scene}.csv")));
        let mut lines = text.lines();
        let columns: Vec<&str> = lines.next().expect("a header").split(',').collect();
        // The name of the setting stands in quotes and may hold a comma.
        let rows: Vec<Vec<String>> = lines
            .map(|line| {
                let parts = line.split('"').enumerate();
                let joined: String = parts
                    .map(|(index, part)| if index % 2 == 1 { part.replace(',', ";") } else { part.into() })
                    .collect();
                joined.split(',').map(str::to_owned).collect()
            })
            .collect();
        let of = |row: &[String], name: &str| {
            let index = columns.iter().position(|column| *column == name)?;
            row.get(index).filter(|value| !value.is_empty()).map(|value| value.to_owned())
        };
        let number = |row: &[String], name: &str| of(row, name).and_then(|value| value.parse::<f64>().ok());
        let local =
            if columns.contains(&"local_e_p90") { ("local_e_p90", "local_e_p90_noise") } else { ("rms", "rms_noise") };
        let metric = if local.0 == "rms" { " (RMS)" } else { "" };
        let asked = rows.iter().find(|row| number(row, "error_asked") == Some(0.05)).expect("a run of 5 %");
        assert_eq!(of(asked, "converged").as_deref(), Some("true"));
        let tracer =
            rows.iter().rev().find(|row| of(row, "setting").as_deref() == Some("path tracer")).expect("a path tracer");
        let get = |row: &[String], name: &str| number(row, name).unwrap_or_else(|| panic!("{scene}: {name}"));
        let (error, noise, time) = (get(asked, local.0), get(asked, local.1), get(asked, "seconds"));
        // Its error falls with the root of its paths, which take time in proportion to the points.
        let theirs = get(tracer, "seconds") * (get(tracer, local.0) / error).powi(2) * get(asked, "vertices")
            / get(tracer, "vertices");
        let line = format!(
            "| {scene} | 5 % | {} %{metric} | {} | {} |",
            plus_minus(100.0 * error, 100.0 * noise),
            seconds(time),
            seconds(theirs)
        );
        assert!(readme.contains(&line), "README.md lacks {line}");
    }
}

/// Truth: the version that Cargo builds.
#[test]
fn versions_agree() {
    let version = env!("CARGO_PKG_VERSION");
    for (file, text) in [
        ("CITATION.cff", format!("version: {version}\n")),
        ("CHANGELOG.md", format!("## {version}")),
        ("assets/selflink.metainfo.xml", format!("<release version=\"{version}\"")),
    ] {
        assert!(read(&root().join(file)).contains(&text), "{file} lacks {text}");
    }
}

/// The rooms of `src/`, from below to above.
const ROOMS: [&str; 15] = [
    "base",
    "scene",
    "geometry",
    "prepare",
    "hierarchy",
    "transport",
    "gather",
    "solve",
    "read",
    "export",
    "render",
    "measure",
    "worker",
    "app",
    "cli",
];

/// Truth: the layout that the README tells. Code of a room imports rooms below it alone; what
/// documents and tests name is free.
#[test]
fn rooms_import_only_those_below_them() {
    let (mut folders, mut files, mut wrong) = (vec![root().join("src")], 0, Vec::new());
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let inside = path.strip_prefix(root().join("src")).expect("it lies there");
            let room = inside.iter().next().and_then(|room| ROOMS.iter().position(|known| room == *known));
            let (Some(room), false) = (room, inside.ends_with("tests.rs")) else { continue };
            files += 1;
            let text = read(&path);
            let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
            for line in code.lines().filter(|line| !line.trim_start().starts_with("//")) {
                let named = line.split("crate::").skip(1).filter_map(|rest| rest.split([':', ';', ' ']).next());
                let above = |name: &&str| ROOMS[room + 1..].contains(name);
                wrong.extend(named.filter(above).map(|name| format!("{} imports {name}", inside.display())));
            }
        }
    }
    assert!(files > 300, "{files} files");
    assert!(wrong.is_empty(), "{wrong:#?}");
}
