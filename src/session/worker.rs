//! The thread on which a session's solver runs.

use crate::history::breakpoints::{self, Breakpoint};
use crate::history::frame::Frame;
use crate::history::strip::Strip;
use crate::model::Model;
use crate::record::command::Unit;
use crate::scene::solver::solver;
use crate::step::drive::{RunEnd, Until};
use crate::step::event::Event;
use crate::step::intervene::Intervention;
use crate::step::state::State;
use crate::step::stepper::Stepper;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How long who waits for the worker sleeps between two looks: were it woken by every message, the solver would pay for
/// that at every iteration.
const NAP: Duration = Duration::from_millis(1);

/// What the worker is to do.
pub enum Job {
    /// Minor iterations from a state, until so many of a unit are complete, or a breakpoint holds, or a failure, or the
    /// end. `before` is the strip of the frame that it starts from.
    Run {
        /// Where it starts.
        state: Box<State>,
        /// Strip of the frame that it starts from.
        before: Box<Strip>,
        /// What is counted.
        unit: Unit,
        /// How many of it.
        count: u32,
        /// Where it stops before.
        breakpoints: Vec<Breakpoint>,
    },
    /// Steps that are given, from a state: each a minor iteration, or an intervention. `before` is the strip of the frame
    /// that it starts from.
    Follow {
        /// Where it starts.
        state: Box<State>,
        /// Strip of the frame that it starts from.
        before: Box<Strip>,
        /// The steps, in order; `None` is a minor iteration.
        steps: Vec<Option<Intervention>>,
    },
    /// A look at the solver, between two other jobs.
    Look(Look),
    /// The same steps as once before, from a state: each a minor iteration, or an intervention.
    Again {
        /// Where it starts.
        state: Box<State>,
        /// The last minor iteration before that state.
        event: Option<Arc<Event>>,
        /// The steps, in order; `None` is a minor iteration.
        steps: Vec<Option<Intervention>>,
    },
}

/// What is done with the solver, and told by whoever does it. It may leave the solver at another state, since every job goes to
/// its own first.
pub type Look = Box<dyn FnOnce(&mut Stepper) + Send>;

/// Where others may look at the worker's solver while it has nothing to do.
pub struct Lender {
    jobs: Sender<Job>,
    busy: Arc<AtomicBool>,
}

impl Lender {
    /// Has the solver looked at, and waits for what is seen; `None` where the solver is busy, or gone.
    pub fn look<T: Send + 'static>(
        &self,
        look: impl FnOnce(&mut Stepper) -> T + Send + 'static,
    ) -> Option<T> {
        if self.busy.load(Ordering::Relaxed) {
            return None;
        }
        let (reply, answer) = channel();
        let look: Look = Box::new(move |stepper| {
            // Who asked waits for it.
            let _ = reply.send(look(stepper));
        });
        self.jobs.send(Job::Look(look)).ok()?;
        answer.recv().ok()
    }
}

/// What the worker tells.
pub enum Message {
    /// A new minor iteration.
    Made(Box<Frame>, Box<Strip>),
    /// A new intervention.
    Changed(Box<State>, Intervention),
    /// A step done again.
    Again(Box<State>, Option<Arc<Event>>),
    /// The job is over; the breakpoints at which it stopped.
    Done {
        /// Whether it was stopped from outside.
        interrupted: bool,
        /// Numbers of the breakpoints at which it stopped.
        hits: Vec<u32>,
    },
    /// The thread is gone.
    Died,
}

/// Handle of the thread; it ends when this is dropped, after the minor iteration at hand.
pub struct Worker {
    jobs: Sender<Job>,
    messages: Receiver<Message>,
    stop: Arc<AtomicBool>,
    /// Whether it is at a job that takes its time.
    busy: Arc<AtomicBool>,
}

impl Worker {
    /// Starts an idle worker with a solver of its own.
    pub fn new(model: Arc<Model>) -> Self {
        let (jobs, orders) = channel::<Job>();
        let (news, messages) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let flag = stop.clone();
        let busy = Arc::new(AtomicBool::new(false));
        let at_work = busy.clone();
        thread::spawn(move || {
            let mut stepper = solver(model);
            while let Ok(job) = orders.recv() {
                at_work.store(!matches!(job, Job::Look(_)), Ordering::Relaxed);
                let done = match job {
                    Job::Run {
                        state,
                        before,
                        unit,
                        count,
                        breakpoints,
                    } => {
                        stepper.restore(&state);
                        run(
                            &mut stepper,
                            *before,
                            (unit, count),
                            &breakpoints,
                            &news,
                            &flag,
                        )
                    }
                    Job::Follow {
                        state,
                        before,
                        steps,
                    } => {
                        stepper.restore(&state);
                        follow(&mut stepper, *before, steps, &news, &flag)
                    }
                    Job::Look(look) => {
                        look(&mut stepper);
                        Some(())
                    }
                    Job::Again {
                        state,
                        event,
                        steps,
                    } => {
                        stepper.restore(&state);
                        again(&mut stepper, event, &steps, &news, &flag)
                    }
                };
                at_work.store(false, Ordering::Relaxed);
                if done.is_none() {
                    return;
                }
            }
        });
        Worker {
            jobs,
            messages,
            stop,
            busy,
        }
    }

    /// Where a look may be asked for.
    pub fn lender(&self) -> Lender {
        Lender {
            jobs: self.jobs.clone(),
            busy: self.busy.clone(),
        }
    }

    /// Starts a job. A dead worker answers [`Message::Died`].
    pub fn start(&self, job: Job) {
        self.stop.store(false, Ordering::Relaxed);
        self.busy.store(true, Ordering::Relaxed);
        // A failing send means that the thread is gone, which the next message says.
        let _ = self.jobs.send(job);
    }

    /// Asks the running job to stop after the present minor iteration.
    pub fn interrupt(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The next message; waits for it.
    pub fn next(&self) -> Message {
        loop {
            match self.try_next() {
                Some(message) => return message,
                None => thread::sleep(NAP),
            }
        }
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

/// Goes on; `None` if nobody listens any more.
fn run(
    stepper: &mut Stepper,
    mut before: Strip,
    (unit, count): (Unit, u32),
    breakpoints: &[Breakpoint],
    news: &Sender<Message>,
    stop: &AtomicBool,
) -> Option<()> {
    let (mut left, mut hits) = (count, Vec::new());
    let interrupted = || stop.load(Ordering::Relaxed);
    let most = if count == 0 { 0 } else { u64::MAX };
    let until = Until::end().minors(most).past_failures();
    let until = until.interrupted_by(&interrupted);
    let mut began = Instant::now();
    let end = stepper.drive(until, |stepper| {
        let (frame, strip) = seen(stepper, &before, began);
        left -= u32::from(unit.ends(strip.kind));
        if strip.kind.is_failure() {
            left = 0;
        }
        hits = breakpoints::hits(breakpoints, &before, &strip);
        before = strip.clone();
        let heard = news.send(Message::Made(Box::new(frame), Box::new(strip)));
        if heard.is_err() || left == 0 || !hits.is_empty() {
            return ControlFlow::Break(heard.ok());
        }
        began = Instant::now();
        ControlFlow::Continue(())
    });
    if let RunEnd::Stopped(heard) = end {
        heard?;
    }
    let interrupted = matches!(end, RunEnd::Interrupted);
    news.send(Message::Done { interrupted, hits }).ok()
}

/// The last minor iteration, which began then, as a frame and its strip.
fn seen(stepper: &mut Stepper, before: &Strip, began: Instant) -> (Frame, Strip) {
    let seconds = began.elapsed().as_secs_f32();
    let event = Arc::new(stepper.event().clone());
    let strip = Strip::of(
        stepper.model(),
        stepper.state(),
        Some(&event),
        Some(before),
        seconds,
    );
    let frame = Frame {
        state: stepper.state().clone(),
        event: Some(event),
        intervention: None,
        monitors: strip.kind.is_accepted().then(|| {
            let mut values = Vec::new();
            stepper.monitors(&mut values);
            Arc::new(values)
        }),
    };
    (frame, strip)
}

/// Takes given steps, as far as they can be taken; `None` if nobody listens any more.
fn follow(
    stepper: &mut Stepper,
    mut before: Strip,
    steps: Vec<Option<Intervention>>,
    news: &Sender<Message>,
    stop: &AtomicBool,
) -> Option<()> {
    let mut interrupted = false;
    for given in steps {
        if stop.load(Ordering::Relaxed) {
            interrupted = true;
            break;
        }
        match given {
            Some(intervention) => {
                if stepper.intervene(&intervention).is_err() {
                    break;
                }
                let state = Box::new(stepper.state().clone());
                before = Strip::intervention(stepper.model(), &state, &before);
                news.send(Message::Changed(state, intervention)).ok()?;
            }
            None => {
                let began = Instant::now();
                if stepper.step().is_none() {
                    break;
                }
                let (frame, strip) = seen(stepper, &before, began);
                before = strip.clone();
                news.send(Message::Made(Box::new(frame), Box::new(strip)))
                    .ok()?;
            }
        }
    }
    let hits = Vec::new();
    news.send(Message::Done { interrupted, hits }).ok()
}

/// Does what was done before; `None` if nobody listens any more.
fn again(
    stepper: &mut Stepper,
    mut event: Option<Arc<Event>>,
    steps: &[Option<Intervention>],
    news: &Sender<Message>,
    stop: &AtomicBool,
) -> Option<()> {
    let mut interrupted = false;
    for step in steps {
        if stop.load(Ordering::Relaxed) {
            interrupted = true;
            break;
        }
        match step {
            // It was sound the first time, from the same state.
            Some(intervention) if stepper.intervene(intervention).is_err() => break,
            Some(_) => {}
            None => event = stepper.step().map(|event| Arc::new(event.clone())),
        }
        let state = Box::new(stepper.state().clone());
        news.send(Message::Again(state, event.clone())).ok()?;
    }
    let hits = Vec::new();
    news.send(Message::Done { interrupted, hits }).ok()
}
