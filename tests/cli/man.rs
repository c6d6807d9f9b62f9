//! Manual pages and completions.

use crate::support::*;

/// Truth: `--help`. Each command has a page, and each option of it stands there and in the
/// completions.
#[test]
fn pages_and_completions_have_every_command_and_option() {
    let folder = Folder::new();
    let written = folder.path("man");
    let (said, _) = succeed(&["man", name(&written)]);
    assert!(said.contains("files"), "{said}");
    let read =
        |file: &str| std::fs::read_to_string(written.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    let completions = ["selflink.bash", "_selflink", "selflink.fish"].map(|file| read(&format!("completions/{file}")));
    let (help, _) = succeed(&["--help"]);
    let commands = help.split_once("Commands:").expect("commands").1.split_once("\n\n").expect("their end").0;
    let commands: Vec<&str> = commands
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|command| *command != "help")
        .collect();
    assert!(commands.contains(&"solve") && commands.contains(&"selftest") && commands.len() > 8, "{commands:?}");
    let plain = |page: &str| page.replace("\\-", "-");
    for command in commands {
        let page = plain(&read(&format!("man/selflink-{command}.1")));
        let (help, _) = succeed(&[command, "--help"]);
        let options: Vec<&str> = help
            .lines()
            .filter_map(|line| line.trim_start().split(", ").last())
            .filter_map(|option| option.split([' ', '[']).next())
            .filter(|option| option.starts_with("--"))
            .collect();
        assert!(!options.is_empty(), "{command}");
        for option in options {
            assert!(page.contains(option), "selflink-{command}.1: {option}");
            assert!(completions.iter().all(|text| text.contains(option.trim_start_matches('-'))), "{command} {option}");
        }
    }
    assert!(plain(&read("man/selflink.1")).contains("selflink-solve(1)"));
    assert!(!written.join("man/selflink-help.1").exists(), "a page without an option");
    let taken = folder.write("taken", "");
    assert!(refused(&["man", name(&taken)]).contains("cannot be written"));
}
