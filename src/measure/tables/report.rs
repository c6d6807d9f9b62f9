//! Report on a part of the paper: tables for people, records for programs, claims, and the
//! files that hold them.

use std::fmt::Write as _;

use super::Part;
use super::claims::Claim;
use crate::measure::records::{self, Record, Table};

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
