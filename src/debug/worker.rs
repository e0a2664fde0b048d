//! The thread on which a session's solver runs.

use crate::debug::command::Unit;
use crate::debug::session::ends;
use crate::scene::Model;
use crate::solve::{Event, Outcome, State, Stepper};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// Minor iterations to do: from a state, until so many of a unit are complete, or a failure, or the end.
pub struct Job {
    pub state: State,
    pub unit: Unit,
    pub count: u32,
}

/// What the worker tells.
pub enum Message {
    /// A minor iteration and the state after it; where it ended an increment, the values of the scene's monitors too.
    Frame(Box<State>, Arc<Event>, Option<Arc<Vec<f64>>>),
    /// The job is over.
    Done { interrupted: bool },
    /// The thread is gone.
    Died,
}

/// Handle of the thread; it ends when this is dropped, after the minor iteration at hand.
pub struct Worker {
    jobs: Sender<Job>,
    messages: Receiver<Message>,
    stop: Arc<AtomicBool>,
}

impl Worker {
    /// Starts an idle worker with a solver of its own.
    pub fn new(model: Arc<Model>) -> Self {
        let (jobs, orders) = channel::<Job>();
        let (news, messages) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let flag = stop.clone();
        thread::spawn(move || {
            let mut stepper = Stepper::new(model);
            while let Ok(job) = orders.recv() {
                if work(&mut stepper, &job, &news, &flag).is_none() {
                    return;
                }
            }
        });
        Worker {
            jobs,
            messages,
            stop,
        }
    }

    /// Starts a job. A dead worker answers [`Message::Died`].
    pub fn start(&self, job: Job) {
        self.stop.store(false, Ordering::Relaxed);
        // A failing send means that the thread is gone, which the next message says.
        let _ = self.jobs.send(job);
    }

    /// Asks the running job to stop after the present minor iteration.
    pub fn interrupt(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The next message; waits for it.
    pub fn next(&self) -> Message {
        self.messages.recv().unwrap_or(Message::Died)
    }

    /// The next message, if there is one.
    pub fn try_next(&self) -> Option<Message> {
        match self.messages.try_recv() {
            Ok(message) => Some(message),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Message::Died),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.interrupt();
    }
}

/// Does a job; none if nobody listens any more.
fn work(stepper: &mut Stepper, job: &Job, news: &Sender<Message>, stop: &AtomicBool) -> Option<()> {
    stepper.restore(&job.state);
    let mut left = job.count;
    let mut interrupted = false;
    while left > 0 {
        if stop.load(Ordering::Relaxed) {
            interrupted = true;
            break;
        }
        let Some(event) = stepper.step() else { break };
        let event = Arc::new(event.clone());
        left -= u32::from(ends(job.unit, &event.outcome));
        if matches!(event.outcome, Outcome::Failed(_)) {
            left = 0;
        }
        let state = Box::new(stepper.state().clone());
        let accepted = matches!(event.outcome, Outcome::Increment { .. });
        let monitors = accepted.then(|| {
            let mut values = Vec::new();
            stepper.monitors(&mut values);
            Arc::new(values)
        });
        news.send(Message::Frame(state, event, monitors)).ok()?;
    }
    news.send(Message::Done { interrupted }).ok()
}
