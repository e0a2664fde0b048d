//! Measures a work-precision chart on a separate thread.

use super::chart_file::Chart;
use super::chart_runs::{PlannedChart, sweep};
use super::precision::{self, Cost, Measure, Precision};
use super::run_error::RunError;
use super::{Vary, Watch};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use stickslip_platform::task;
use stickslip_scene::Scene;

/// A chart being measured; dropping it interrupts the measurement.
pub struct ChartMeasurement {
    stop: Arc<AtomicBool>,
    done: Arc<AtomicU64>,
    all: Arc<AtomicU64>,
    result: Receiver<Result<Precision, RunError>>,
}

impl ChartMeasurement {
    /// Starts to measure a scene, including its overrides: its own chart, or with `over` all combinations of
    /// those settings. Each case runs once. An invalid path or value is reported as the result.
    pub fn start(scene: &Scene, over: Vec<Vary>) -> ChartMeasurement {
        let name = scene.name.clone();
        let set: Vec<(String, String)> = scene
            .overrides()
            .map(|(p, v)| (p.to_owned(), v.to_owned()))
            .collect();
        let (stop, done, all) = (Arc::default(), Arc::default(), Arc::default());
        let (sender, result) = channel();
        let measuring = ChartMeasurement {
            stop: Arc::clone(&stop),
            done: Arc::clone(&done),
            all: Arc::clone(&all),
            result,
        };
        task::spawn(move || {
            let watch = Watch {
                stop: &|| stop.load(Ordering::Relaxed),
                done: &|increments| {
                    done.fetch_add(increments, Ordering::Relaxed);
                },
            };
            let measure = Measure {
                cost: Cost::default(),
                target: None,
                repeats: 1,
            };
            let chart = Chart::open(&name, &over).map_err(RunError::from);
            let planned = chart.and_then(|mut chart| {
                chart.set.extend(set);
                PlannedChart::new(chart)
            });
            let measured = planned.and_then(|planned| {
                let increments = sweep(std::slice::from_ref(&planned), 1).steps();
                all.store(increments, Ordering::Relaxed);
                precision::run(&planned, measure, &watch)
            });
            // The receiver may be gone.
            let _ = sender.send(measured);
        });
        measuring
    }

    /// Increments done, and planned in total; 0 until that is known.
    pub fn progress(&self) -> (u64, u64) {
        let [done, all] = [&self.done, &self.all].map(|count| count.load(Ordering::Relaxed));
        (done, all)
    }

    /// Interrupts the measurement; the completed runs are the result.
    pub fn interrupt(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The chart, or why there is none, once the measurement has ended.
    pub fn result(&self) -> Option<Result<Precision, RunError>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                let why = "the measurement ended unexpectedly";
                Some(Err(RunError::Incomparable(why.to_owned())))
            }
        }
    }
}

impl Drop for ChartMeasurement {
    fn drop(&mut self) {
        self.interrupt();
    }
}
