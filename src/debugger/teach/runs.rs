//! The runs of a lesson's chart, measured once: their cost and their error.

use crate::refusal::{Refusal, refusal};
use std::sync::OnceLock;
use stickslip_scene::joined;
use stickslip_study::chart_file::Chart;
use stickslip_study::chart_runs::PlannedChart;
use stickslip_study::precision::{self, Cost, Measure, Point, Precision};
use stickslip_study::{Vary, Watch};

/// The runs of a lesson's chart; measured on first use.
#[derive(Debug)]
pub struct Runs {
    scene: String,
    over: Vec<Vary>,
    set: Vec<(String, String)>,
    measured: OnceLock<Result<Precision, String>>,
}

impl Runs {
    /// All combinations of these settings, for a scene with other settings changed.
    pub fn new(scene: String, over: Vec<Vary>, set: Vec<(String, String)>) -> Runs {
        Runs {
            scene,
            over,
            set,
            measured: OnceLock::new(),
        }
    }

    /// Measures the runs, unless that has been done.
    ///
    /// # Errors
    /// If a scene is invalid or the chart cannot be measured.
    pub fn measure(&self) -> Result<&Precision, Refusal> {
        let measured = self.measured.get_or_init(|| {
            let mut chart = Chart::open(&self.scene, &self.over).map_err(|e| e.to_string())?;
            chart.set.extend(self.set.iter().cloned());
            let planned = PlannedChart::new(chart).map_err(|e| e.to_string())?;
            let measure = Measure {
                cost: Cost::Factorizations,
                target: None,
                repeats: 1,
            };
            let watch = Watch {
                stop: &|| false,
                done: &|_| {},
            };
            precision::run(&planned, measure, &watch).map_err(|e| e.to_string())
        });
        measured
            .as_ref()
            .map_err(|why| refusal!("the lesson's chart cannot be measured: {why}"))
    }

    /// The run with these settings.
    ///
    /// # Errors
    /// If none or several match.
    pub fn of(&self, settings: &[(String, String)]) -> Result<&Point, Refusal> {
        let mut found = self.measure()?.points.iter().filter(|point| {
            let has =
                |wanted: &(String, String)| point.settings.iter().any(|own| same(own, wanted));
            settings.iter().all(has)
        });
        match (found.next(), found.next()) {
            (Some(point), None) => Ok(point),
            _ => {
                let settings = settings
                    .iter()
                    .map(|(path, value)| format!("{path}={value}"));
                Err(refusal!(
                    "{} does not select exactly one run of the lesson's chart",
                    joined(settings, " ")
                ))
            }
        }
    }

    /// Whether this run has the fewest factorizations of all with at most this error.
    ///
    /// # Errors
    /// As [`Runs::of`].
    pub fn is_cheapest(&self, settings: &[(String, String)], error: f64) -> Result<bool, Refusal> {
        let own = self.of(settings)?;
        let near = |point: &&Point| point.error.is_some_and(|own| own <= error);
        let mut points = self.measure()?.points.iter().filter(near);
        Ok(near(&own) && !points.any(|other| other.factorizations < own.factorizations))
    }
}

/// Whether a setting equals the wanted one; numbers may be written differently.
fn same(own: &(String, String), wanted: &(String, String)) -> bool {
    let number = |text: &str| text.parse::<f64>().ok();
    let values = (number(&own.1), number(&wanted.1));
    let equal = match values {
        (Some(a), Some(b)) => a == b,
        _ => own.1 == wanted.1,
    };
    own.0 == wanted.0 && equal
}
