//! Tables of numbers: as CSV for programs, as Markdown for people.

use crate::chart::ChartError;
use std::fmt::Write;

/// Rows under headings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// One heading per column, with its unit.
    pub columns: Vec<String>,
    /// Rows; each has one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// A number: formatted for Markdown, and exact for CSV.
    Number(String, f64),
    /// An empty cell.
    Empty,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Number(grouped(count), count as f64)
    }
}

impl Cell {
    /// A number with this many decimals.
    pub fn decimals(number: f64, decimals: usize) -> Self {
        Self::Number(format!("{number:.decimals$}"), number)
    }

    /// A number with three significant digits.
    pub fn short(number: f64) -> Self {
        Self::Number(short(number), number)
    }
}

impl Table {
    /// A table without rows.
    pub fn new(columns: &[&str]) -> Self {
        Self {
            columns: columns.iter().map(|&column| column.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: Vec<Cell>) {
        debug_assert_eq!(cells.len(), self.columns.len());
        self.rows.push(cells);
    }

    /// Encodes it as CSV, with its headings.
    ///
    /// # Errors
    /// None in practice: it writes to memory.
    pub fn csv(&self) -> Result<Vec<u8>, ReportError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.columns)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(|cell| match cell {
                Cell::Text(text) => text.clone(),
                Cell::Number(_, number) => number.to_string(),
                Cell::Empty => String::new(),
            }))?;
        }
        writer
            .into_inner()
            .map_err(|error| ReportError::Csv(error.to_string()))
    }

    /// Formats it as Markdown, numbers aligned to the right.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        let line = |text: &mut String, cells: &[String]| {
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        };
        line(&mut text, &self.columns);
        let is_number = |column: usize| {
            let mut cells = self.rows.iter().map(|row| &row[column]);
            cells.all(|cell| !matches!(cell, Cell::Text(_)))
        };
        let rules: Vec<String> = (0..self.columns.len())
            .map(|column| if is_number(column) { "---:" } else { "---" }.to_owned())
            .collect();
        line(&mut text, &rules);
        for row in &self.rows {
            let cells: Vec<String> = row
                .iter()
                .map(|cell| match cell {
                    Cell::Text(text) | Cell::Number(text, _) => text.replace('|', "\\|"),
                    Cell::Empty => String::new(),
                })
                .collect();
            line(&mut text, &cells);
        }
        text
    }
}

/// Why a report cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// An error of drawing a chart.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// An error of writing CSV.
    #[error("a table cannot be written: {0}")]
    Csv(String),
    /// An error of encoding a picture.
    #[error(transparent)]
    Image(#[from] raycast_core::picture::ImageError),
    /// An invalid scene.
    #[error(transparent)]
    Scene(#[from] raycast_core::scene::SceneError),
    /// An invalid camera.
    #[error(transparent)]
    Plane(#[from] raycast_core::camera::PlaneError),
    /// Pictures that cannot be compared, such as ones of different sizes.
    #[error("two pictures cannot be compared: {0}")]
    Compare(String),
    /// The thread pool cannot be started.
    #[error("the workers could not be started: {0}")]
    Workers(#[from] rayon::ThreadPoolBuildError),
}

impl From<csv::Error> for ReportError {
    fn from(error: csv::Error) -> Self {
        Self::Csv(error.to_string())
    }
}

/// An integer with commas between thousands.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number with three significant digits, and at most three decimals unless it is small.
pub fn short(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1000.0..1e15).contains(&size) {
        let sign = if number < 0.0 { "-" } else { "" };
        format!("{sign}{}", grouped(size.round() as u64))
    } else if (0.0005..1000.0).contains(&size) {
        let decimals = (2.0 - size.log10().floor()).clamp(0.0, 4.0) as usize;
        format!("{number:.decimals$}")
    } else {
        format!("{number:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        for (count, text) in [
            (0, "0"),
            (999, "999"),
            (1000, "1,000"),
            (1_234_567, "1,234,567"),
        ] {
            assert_eq!(grouped(count), text);
        }
        for (number, text) in [
            (0.0, "0"),
            (123.4, "123"),
            (12.34, "12.3"),
            (1.234, "1.23"),
            (0.1234, "0.123"),
            (0.001234, "0.0012"),
            (5_000_000.0, "5,000,000"),
            (1e-7, "1.00e-7"),
        ] {
            assert_eq!(short(number), text);
        }
    }

    #[test]
    fn tables_for_people_and_programs() {
        let mut table = Table::new(&["caster, its name", "rays"]);
        table.row(vec!["a|b".into(), Cell::from(12_345)]);
        table.row(vec!["c".into(), Cell::Empty]);
        assert_eq!(
            table.markdown(),
            "| caster, its name | rays |\n| --- | ---: |\n| a\\|b | 12,345 |\n| c |  |\n"
        );
        let csv = String::from_utf8(table.csv().expect("CSV")).expect("text");
        assert_eq!(csv, "\"caster, its name\",rays\na|b,12345\nc,\n");
    }
}
