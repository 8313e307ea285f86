//! A part of a report: text, plots, tables, pictures.

use crate::chart::Chart;
use crate::table::Table;

/// A part of a report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Its text, in Markdown, plots and tables in their places.
    pub text: String,
    /// Its plots, by the names of their files.
    pub charts: Vec<(String, Chart)>,
    /// Its numbers, by the names of their files.
    pub tables: Vec<(String, Table)>,
    /// Its pictures: files ready to be written.
    pub pictures: Vec<(String, Vec<u8>)>,
}

impl Section {
    /// Adds a line of text, and an empty one.
    pub fn say(&mut self, text: impl AsRef<str>) {
        self.text.push_str(text.as_ref());
        self.text.push_str("\n\n");
    }

    /// Adds a plot where the text has come to.
    pub fn chart(&mut self, name: &str, chart: Chart) {
        let line = format!("![{}]({name}.png)", chart.title);
        self.say(line);
        self.charts.push((name.to_owned(), chart));
    }

    /// Adds a table for people where the text has come to, and for programs beside it.
    pub fn table(&mut self, name: &str, table: Table) {
        self.text.push_str(&table.markdown());
        self.text.push('\n');
        self.numbers(name, table);
    }

    /// Adds a table for programs alone.
    pub fn numbers(&mut self, name: &str, table: Table) {
        self.tables.push((name.to_owned(), table));
    }
}
