//! A work-precision chart that is measured on a thread of its own, so that who wants it can go on.

use super::chart_file::Chart;
use super::precision::{self, Cost, Measure, Precision};
use super::{Vary, Watch};
use crate::scene::{Scene, SceneError};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

/// A chart on its way; dropping it ends it.
pub struct Measuring {
    stop: Arc<AtomicBool>,
    done: Arc<AtomicU64>,
    all: u64,
    result: Receiver<Result<Precision, String>>,
}

impl Measuring {
    /// Starts to measure a scene's file as it stands, with what was set from outside when it was opened: its own chart, or
    /// with `over` the product of that. Each run is done once.
    ///
    /// # Errors
    /// If a path or a value will not do.
    pub fn start(scene: &Scene, over: &[Vary]) -> Result<Measuring, SceneError> {
        let mut chart = Chart::open(&scene.name, over)?;
        let set = scene.overrides().map(|(p, v)| (p.to_owned(), v.to_owned()));
        chart.set.extend(set);
        let plans = precision::plans(&chart)?;
        let all = plans
            .iter()
            .flat_map(|plan| &plan.cases)
            .map(|case| case.increments)
            .sum();
        let (stop, done) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(AtomicU64::new(0)),
        );
        let (told, result) = channel();
        let (stops, counts) = (stop.clone(), done.clone());
        thread::spawn(move || {
            let watch = Watch {
                stop: &|| stops.load(Ordering::Relaxed),
                done: &|increments| {
                    counts.fetch_add(increments, Ordering::Relaxed);
                },
            };
            let measure = Measure {
                cost: Cost::default(),
                target: None,
                repeats: 1,
            };
            let measured = precision::run(&chart, &plans, measure, &watch);
            // Nobody may want it any more.
            let _ = told.send(measured.map_err(|error| error.to_string()));
        });
        Ok(Measuring {
            stop,
            done,
            all,
            result,
        })
    }

    /// Increments done, and all that are planned.
    pub fn progress(&self) -> (u64, u64) {
        (self.done.load(Ordering::Relaxed), self.all)
    }

    /// Asks it to end; what was measured until then is the result.
    pub fn interrupt(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The chart, or why there is none, once it is done.
    pub fn result(&self) -> Option<Result<Precision, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("measuring broke down".into())),
        }
    }
}

impl Drop for Measuring {
    fn drop(&mut self) {
        self.interrupt();
    }
}
