//! Report on a part of the paper: tables for people, records for programs, claims, and the
//! files that hold them.

use std::fmt::Write as _;

use super::Part;
use super::claims::Claim;
use crate::measure::records::{self, Record};

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
    /// As Markdown, numbers to the right.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rule: Vec<String> =
            (0..self.head.len()).map(|column| if column == 0 { "---" } else { "---:" }.to_owned()).collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!("{}\n\n{}{}{rows}", self.caption, line(&self.head), line(&rule))
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

/// One part of the paper, run.
#[derive(Clone, Debug)]
pub struct Report {
    /// Which one.
    pub part: Part,
    /// Title of the part.
    pub title: String,
    /// Description of the runs, in Markdown.
    pub introduction: String,
    /// The tables.
    pub tables: Vec<Table>,
    /// Remarks on them, a sentence or two each, in Markdown.
    pub remarks: Vec<String>,
    /// Pictures, in Markdown; nothing for a terminal.
    pub pictures: Vec<String>,
    /// The paper's rows and every run with all its parameters.
    pub records: Vec<Record>,
    /// The paper's claims that these runs answer.
    pub claims: Vec<Claim>,
}

impl Report {
    /// A report without anything in it yet.
    pub fn new(part: Part, title: &str, introduction: String) -> Self {
        Self {
            part,
            title: title.to_owned(),
            introduction,
            tables: Vec::new(),
            remarks: Vec::new(),
            pictures: Vec::new(),
            records: Vec::new(),
            claims: Vec::new(),
        }
    }

    /// The part's page.
    pub fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n{}\n", self.title, self.introduction);
        for table in &self.tables {
            text += &format!("\n{}", table.markdown());
        }
        for remark in self.remarks.iter().chain(&self.pictures) {
            text += &format!("\n{remark}\n");
        }
        // A String takes any text.
        let _ = write!(text, "\nWritten by `selflink tables --only {}`.", self.part.name());
        if !self.records.is_empty() {
            let _ = write!(text, " Every parameter and count: [{0}.csv]({0}.csv).", self.part.name());
        }
        text + "\n"
    }

    /// The part as text for a terminal.
    pub fn text(&self) -> String {
        let tables: String = self.tables.iter().map(|table| format!("{}\n", table.text())).collect();
        let remarks: String = self.remarks.iter().map(|remark| format!("{remark}\n\n")).collect();
        format!("{}\n\n{tables}{remarks}", self.title)
    }

    /// The records as CSV.
    pub fn csv(&self) -> String {
        records::csv(&self.records)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
