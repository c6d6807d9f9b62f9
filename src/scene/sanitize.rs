//! Sanitizing text out of a file, so that it can stand in a sentence or as a name: on one line,
//! without control characters, not too long.

use std::collections::{HashMap, HashSet};

/// The longest quotation from a file, characters.
const LONGEST_QUOTE: usize = 80;

/// The longest name of a group or material, characters.
const LONGEST_NAME: usize = 200;

/// Room for a number behind a name, characters.
const MOST_DIGITS: usize = 13;

/// The longest sentence, characters.
const LONGEST_SENTENCE: usize = 600;

/// A word or name of the file, in backquotes.
pub(super) fn quoted(text: &str) -> String {
    format!("`{}`", sanitized(text, LONGEST_QUOTE))
}

/// A name of a group or material as it is known from here on.
pub(super) fn name(text: &str) -> String {
    sanitized(text, LONGEST_NAME)
}

/// Names between commas, so many of them; the rest is counted.
pub(super) fn list<S: AsRef<str>>(names: impl IntoIterator<Item = S>, most: usize) -> String {
    let mut names = names.into_iter();
    let shown: Vec<S> = names.by_ref().take(most).collect();
    let shown = shown.iter().map(S::as_ref).collect::<Vec<_>>().join(", ");
    match names.count() {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Names as they are known from here on, each another one: `Light`, `Light (2)`, `Light (3)`.
/// Settings are kept by name.
pub(super) fn unique_names<'a>(texts: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
    let mut taken: HashSet<String> = texts.clone().map(name).collect();
    let mut counts: HashMap<String, u32> = HashMap::new();
    let unique = |text: &str| {
        let name = name(text);
        let count = counts.entry(name.clone()).or_insert(0);
        *count += 1;
        while *count > 1 {
            let numbered = format!("{} ({count})", sanitized(&name, LONGEST_NAME - MOST_DIGITS));
            if taken.insert(numbered.clone()) {
                return numbered;
            }
            *count += 1;
        }
        name
    };
    texts.map(unique).collect()
}

/// A sentence that may quote a file in ways that we do not know (a parser's own words).
pub(super) fn sentence(text: &str) -> String {
    sanitized(text, LONGEST_SENTENCE)
}

fn sanitized(text: &str, most: usize) -> String {
    let is_sound = |letter: char| !letter.is_control() && !matches!(letter, '\u{2028}' | '\u{2029}');
    let mut letters = text.chars().map(|letter| if is_sound(letter) { letter } else { char::REPLACEMENT_CHARACTER });
    let mut sound: String = letters.by_ref().take(most).collect();
    if letters.next().is_some() {
        sound.pop();
        sound.push('…');
    }
    sound
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: counted by hand; no name is given twice, also where a file has a name with a number
    /// itself.
    #[test]
    fn names_are_unique() {
        let names = unique_names(["a", "b", "a", "a (2)", "a", ""].into_iter());
        assert_eq!(names, ["a", "b", "a (3)", "a (2)", "a (4)", ""]);
        let long = "x".repeat(300);
        let names = unique_names([long.as_str(), &long].into_iter());
        assert!(names[0] != names[1] && names.iter().all(|name| name.chars().count() <= 200), "{names:?}");
    }

    #[test]
    fn text_of_a_file_is_short_and_on_one_line() {
        assert_eq!(quoted("oak\n\u{1b}[31m"), "`oak\u{fffd}\u{fffd}[31m`");
        assert_eq!(name("Wände \u{1f4a1}"), "Wände \u{1f4a1}");
        assert_eq!(name(&"x".repeat(200)), "x".repeat(200));
        assert_eq!(name(&"ö".repeat(1_000_000)), "ö".repeat(199) + "…");
    }
}
