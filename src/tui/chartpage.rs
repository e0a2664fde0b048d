//! The state of the work-precision page, and its keys.

use std::path::Path;
use stickslip_debugger::Refusal;
use stickslip_study::precision::{Cost, Point, Precision};
use stickslip_study::precision_table;

/// The work-precision page.
#[derive(Debug, Clone)]
pub struct ChartPage {
    /// Name of the table in messages.
    name: String,
    text: String,
    /// Never empty.
    pub(super) charts: Vec<Precision>,
    /// The shown chart and the selected run.
    pub(super) chart: usize,
    pub(super) run: usize,
    pub(super) cost: Cost,
    /// Whether the errors of the contact forces are shown.
    pub(super) is_force: bool,
}

impl ChartPage {
    /// Opens a table of runs.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn open(file: &str) -> Result<ChartPage, Refusal> {
        let text = precision_table::open(Path::new(file))?;
        ChartPage::from_table(file, text)
    }

    /// A page with a chart that was just measured.
    ///
    /// # Errors
    /// If the chart has no runs.
    pub fn from_chart(chart: Precision) -> Result<ChartPage, Refusal> {
        if chart.points.is_empty() {
            return Err(Refusal::new("stopped before any run was finished"));
        }
        ChartPage::from_table("chart", precision_table::csv(&[chart]))
    }

    fn from_table(name: &str, text: String) -> Result<ChartPage, Refusal> {
        let cost = Cost::default();
        Ok(ChartPage {
            charts: precision_table::read(name, &text, cost, None)?,
            name: name.to_owned(),
            text,
            chart: 0,
            run: 0,
            cost,
            is_force: false,
        })
    }

    /// Handles a key; returns false if the page does not use it.
    pub fn key(&mut self, name: &str) -> bool {
        let (charts, runs) = (self.charts.len(), self.shown().points.len());
        match name {
            "Right" | "Down" | "l" | "j" => self.run = (self.run + 1) % runs.max(1),
            "Left" | "Up" | "h" | "k" => {
                self.run = (self.run + runs.saturating_sub(1)) % runs.max(1)
            }
            "Tab" => (self.chart, self.run) = ((self.chart + 1) % charts, 0),
            "x" => self.turn_cost(),
            "f" => self.is_force = !self.is_force && self.has_forces(),
            _ => return false,
        }
        true
    }

    /// The shown chart.
    pub(super) fn shown(&self) -> &Precision {
        &self.charts[self.chart]
    }

    /// Whether any run of the shown chart has an error of the contact forces.
    pub(super) fn has_forces(&self) -> bool {
        self.shown()
            .points
            .iter()
            .any(|point| point.force_error.is_some())
    }

    /// The shown error of a run.
    pub(super) fn error(&self, point: &Point) -> Option<f64> {
        if self.is_force && self.has_forces() {
            point.force_error
        } else {
            point.error
        }
    }

    /// Switches to the next kind of cost, which changes the Pareto front.
    fn turn_cost(&mut self) {
        self.cost = match self.cost {
            Cost::Time => Cost::Factorizations,
            Cost::Factorizations => Cost::Minors,
            Cost::Minors => Cost::Time,
        };
        // The same table was parsed before.
        if let Ok(charts) = precision_table::read(&self.name, &self.text, self.cost, None) {
            self.charts = charts;
        }
    }
}
