//! CSV files of records, whose values have names.

/// A row of a CSV file: names and values. Rows of one file need not have the same names.
pub type Record = Vec<(&'static str, String)>;

/// Columns that are called as the fields are which they hold.
macro_rules! columns {
    ($of:expr; $($field:ident),+) => {
        [$((stringify!($field), $of.$field.to_string())),+]
    };
}
pub(crate) use columns;

/// A column of what may be absent.
pub fn optional<T: ToString>(name: &'static str, value: Option<T>) -> (&'static str, String) {
    (name, value.map_or_else(String::new, |value| value.to_string()))
}

/// Records as CSV: a column for every name, in the order in which names first turn up.
pub fn csv(records: &[Record]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in records.iter().flatten() {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let row = |record: &Record| {
        let of = |name: &&str| {
            record.iter().find(|(known, _)| known == name).map_or(String::new(), |(_, value)| quoted(value))
        };
        names.iter().map(of).collect::<Vec<_>>().join(",") + "\n"
    };
    names.join(",") + "\n" + &records.iter().map(row).collect::<String>()
}

/// A value as a CSV file can have it.
fn quoted(value: &str) -> String {
    if value.contains([',', '"', '\n']) { format!("\"{}\"", value.replace('"', "\"\"")) } else { value.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written out by hand.
    #[test]
    fn records_need_not_have_the_same_names() {
        let records = [vec![("a", "1,5".into())], vec![("b", "x".into()), ("a", "2".into())]];
        assert_eq!(csv(&records), "a,b\n\"1,5\",\n2,x\n");
    }
}
