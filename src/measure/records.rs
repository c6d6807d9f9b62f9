//! Records, whose values have names, as CSV files; tables as people read them.

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
pub fn csv(records: &[Vec<(&str, String)>]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in records.iter().flatten() {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let row = |record: &Vec<(&str, String)>| {
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

/// A table as people read it.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// A line above it.
    pub caption: String,
    /// Names of the columns; the first one names the row.
    pub head: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these columns.
    pub fn new<const N: usize>(caption: impl Into<String>, head: [&str; N], rows: Vec<Vec<String>>) -> Self {
        Self { caption: caption.into(), head: head.map(String::from).into(), rows }
    }

    /// As Markdown, numbers to the right of the first column.
    pub fn markdown(&self) -> String {
        self.markdown_with(1)
    }

    /// As Markdown, so many columns to the left and the others to the right.
    pub fn markdown_with(&self, left: usize) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let side = |column: usize| if column < left { "---" } else { "---:" }.to_owned();
        let rule: Vec<String> = (0..self.head.len()).map(side).collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        let caption = if self.caption.is_empty() { String::new() } else { format!("{}\n\n", self.caption) };
        caption + &line(&self.head) + &line(&rule) + &rows
    }

    /// As text for a terminal.
    pub fn text(&self) -> String {
        let lines = || std::iter::once(&self.head).chain(&self.rows);
        let width = |column: usize| lines().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
        let widths: Vec<usize> = (0..self.head.len()).map(|column| width(column).unwrap_or(0)).collect();
        let line = |row: &Vec<String>| {
            let cell = |(column, (cell, width)): (usize, (&String, &usize))| match column {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            };
            row.iter().zip(&widths).enumerate().map(cell).collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        format!("{}\n{}", self.caption, lines().map(line).collect::<String>())
    }
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

    /// Written out by hand.
    #[test]
    fn tables_are_written() {
        let table = Table {
            caption: "Some".into(),
            head: ["who", "n"].map(String::from).to_vec(),
            rows: vec![["paper".to_owned(), "1,000".to_owned()].to_vec(), ["we".to_owned(), "9".to_owned()].to_vec()],
        };
        assert_eq!(table.markdown(), "Some\n\n| who | n |\n| --- | ---: |\n| paper | 1,000 |\n| we | 9 |\n");
        assert_eq!(table.text(), "Some\nwho        n\npaper  1,000\nwe         9\n");
        let bare = Table { caption: String::new(), ..table };
        assert_eq!(bare.markdown_with(2), "| who | n |\n| --- | --- |\n| paper | 1,000 |\n| we | 9 |\n");
    }
}
