//! Measures a work-precision chart on a separate thread.

use super::chart_file::Chart;
use super::chart_runs::{PlannedChart, PrecisionError, sweep};
use super::precision::{self, Cost, Measure, Precision};
use super::{Vary, Watch};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use stickslip_platform::task;
use stickslip_scene::Scene;

/// Why there is no chart.
#[derive(Debug, thiserror::Error)]
pub enum NotMeasured {
    /// The chart could not be measured.
    #[error(transparent)]
    Failed(#[from] PrecisionError),
    /// The thread ended without a result.
    #[error("the measurement ended unexpectedly")]
    BrokeDown,
}

/// A chart being measured; dropping it interrupts the measurement.
pub struct ChartMeasurement {
    stop: Arc<AtomicBool>,
    done: Arc<AtomicU64>,
    all: Arc<AtomicU64>,
    result: Receiver<Result<Precision, NotMeasured>>,
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
            let chart = Chart::open(&name, &over).map_err(PrecisionError::from);
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
            let _ = sender.send(measured.map_err(NotMeasured::from));
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
    pub fn result(&self) -> Option<Result<Precision, NotMeasured>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(NotMeasured::BrokeDown)),
        }
    }
}

impl Drop for ChartMeasurement {
    fn drop(&mut self) {
        self.interrupt();
    }
}
