//! A section of a report: text, charts, tables, pictures.

use crate::chart::Chart;
use crate::table::Table;

/// A section of a report.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Its text in Markdown, which refers to charts and tables.
    pub text: String,
    /// Its charts, by file name.
    pub charts: Vec<(String, Chart)>,
    /// Its tables, by file name.
    pub tables: Vec<(String, Table)>,
    /// Its pictures as encoded files, by file name.
    pub pictures: Vec<(String, Vec<u8>)>,
}

impl Section {
    /// Adds a paragraph of text.
    pub fn paragraph(&mut self, text: impl AsRef<str>) {
        self.text.push_str(text.as_ref());
        self.text.push_str("\n\n");
    }

    /// Adds a chart at the current end of the text.
    pub fn chart(&mut self, name: &str, chart: Chart) {
        let line = format!("![{}]({name}.png)", chart.title);
        self.paragraph(line);
        self.charts.push((name.to_owned(), chart));
    }

    /// Adds a table at the current end of the text, and as CSV.
    pub fn table(&mut self, name: &str, table: Table) {
        self.text.push_str(&table.markdown());
        self.text.push('\n');
        self.numbers(name, table);
    }

    /// Adds a table as CSV only.
    pub fn numbers(&mut self, name: &str, table: Table) {
        self.tables.push((name.to_owned(), table));
    }
}
