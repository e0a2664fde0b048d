//! What the work-precision page shows, and what keys do to it.

use std::path::Path;
use stickslip_study::csv::TableError;
use stickslip_study::measuring::NotMeasured;
use stickslip_study::precision::{Cost, Precision};
use stickslip_study::precision_table;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum NoPage {
    /// The table is unsound.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The chart could not be measured.
    #[error(transparent)]
    NotMeasured(#[from] Box<NotMeasured>),
    /// There is nothing to draw.
    #[error("stopped before there was anything to compare")]
    Empty,
}

/// What the page shows.
#[derive(Debug, Clone)]
pub struct ChartPage {
    /// What messages call the table.
    name: String,
    text: String,
    /// At least one.
    pub(super) charts: Vec<Precision>,
    /// Which of the charts, and which of its runs.
    pub(super) chart: usize,
    pub(super) run: usize,
    pub(super) cost: Cost,
}

impl ChartPage {
    /// Opens a table.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn open(file: &str) -> Result<ChartPage, NoPage> {
        let text = precision_table::open(Path::new(file))?;
        ChartPage::of_table(file, text)
    }

    /// The page of a chart that was just measured.
    ///
    /// # Errors
    /// If there is nothing in it to be shown.
    pub fn of_chart(chart: Precision) -> Result<ChartPage, NoPage> {
        if chart.points.is_empty() {
            return Err(NoPage::Empty);
        }
        ChartPage::of_table("chart", precision_table::csv(&[chart]))
    }

    fn of_table(name: &str, text: String) -> Result<ChartPage, NoPage> {
        let cost = Cost::default();
        Ok(ChartPage {
            charts: precision_table::read(name, &text, cost, None)?,
            name: name.to_owned(),
            text,
            chart: 0,
            run: 0,
            cost,
        })
    }

    /// A key of its own; false where it is none.
    pub fn key(&mut self, name: &str) -> bool {
        let (charts, runs) = (self.charts.len(), self.shown().points.len());
        match name {
            "Right" | "Down" | "l" | "j" => self.run = (self.run + 1) % runs.max(1),
            "Left" | "Up" | "h" | "k" => {
                self.run = (self.run + runs.saturating_sub(1)) % runs.max(1)
            }
            "Tab" => (self.chart, self.run) = ((self.chart + 1) % charts, 0),
            "x" => self.turn_cost(),
            _ => return false,
        }
        true
    }

    /// The chart that is shown.
    pub(super) fn shown(&self) -> &Precision {
        &self.charts[self.chart]
    }

    /// Another kind of cost; the front is another then.
    fn turn_cost(&mut self) {
        self.cost = match self.cost {
            Cost::Time => Cost::Factorizations,
            Cost::Factorizations => Cost::Minors,
            Cost::Minors => Cost::Time,
        };
        // It could be read before.
        if let Ok(charts) = precision_table::read(&self.name, &self.text, self.cost, None) {
            self.charts = charts;
        }
    }
}
