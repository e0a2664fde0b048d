//! The thread that runs the session's solver, our own or an attached one.

use crate::history::rounds;
use crate::{Breakpoints, Frame, Strip, Unit};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, TryRecvError, channel, sync_channel};
use std::time::Duration;
use stickslip_core::step::drive::drive;
use stickslip_core::{Event, Intervention, RunEnd, Solver, SolverLost, State, Until};
use stickslip_platform::clock::Instant;
use stickslip_platform::task::{self, Next, Task};
use stickslip_scene::joined;

/// Sleep between two polls while waiting for the worker. Waking the waiting thread with every message would
/// cost the solver time in each iteration.
const NAP: Duration = Duration::from_millis(1);
/// Maximum number of uncollected messages: a solver that is faster than its reader waits, and memory stays
/// bounded.
const AHEAD: usize = 1024;

/// A job of the worker.
pub enum Job {
    /// Take steps from a state.
    Steps(Box<State>, Steps),
    /// Continue the steps of the previous slice.
    Rest(Steps),
    /// Call a function on the solver, between two other jobs.
    Look(SolverTask),
    /// End the thread.
    End,
}

/// Steps of the solver. `before` is the strip of the frame that they start from; a given step is a minor
/// iteration (`None`) or an intervention.
pub enum Steps {
    /// Minor iterations until `count` units are complete, a breakpoint is hit, a step fails, or the history
    /// ends.
    Run {
        /// Strip of the frame that it starts from.
        before: Strip,
        /// Unit counted.
        unit: Unit,
        /// Number of units.
        count: u32,
        /// Breakpoints that stop it early.
        breakpoints: Breakpoints,
    },
    /// A given sequence of steps.
    Follow {
        /// Strip of the frame that it starts from.
        before: Strip,
        /// Steps in order.
        steps: Vec<Option<Intervention>>,
    },
    /// Steps repeated to recompute thinned frames.
    Again {
        /// The last minor iteration before them.
        event: Option<Arc<Event>>,
        /// Steps in order.
        steps: Vec<Option<Intervention>>,
    },
}

/// A function called on the solver; it reports its own result. It may leave the solver in another state, since
/// every job starts by restoring its own.
pub type SolverTask = Box<dyn FnOnce(&mut dyn Solver) + Send>;

/// Gives other threads access to the worker's solver while it is idle.
pub struct Lender {
    jobs: Sender<Job>,
    busy: Arc<AtomicBool>,
}

impl Lender {
    /// Calls a function on the solver and waits for the result; `None` if the solver is busy or gone.
    pub fn look<T: Send + 'static>(
        &self,
        look: impl FnOnce(&mut dyn Solver) -> T + Send + 'static,
    ) -> Option<T> {
        if self.busy.load(Ordering::Relaxed) {
            return None;
        }
        let (reply, answer) = channel();
        let look: SolverTask = Box::new(move |solver| {
            // The caller is waiting, so sending succeeds.
            let _ = reply.send(look(solver));
        });
        self.jobs.send(Job::Look(look)).ok()?;
        task::receive(&answer).ok()
    }
}

/// Message from the worker.
pub enum Message {
    /// A new minor iteration.
    Made(Box<Frame>, Box<Strip>),
    /// A new intervention.
    Changed(Box<State>, Intervention),
    /// A recomputed step.
    Again(Box<State>, Option<Arc<Event>>),
    /// The job is over.
    Done {
        /// Whether it was interrupted.
        interrupted: bool,
        /// Numbers of the breakpoints that it stopped at.
        hits: Vec<u32>,
        /// Additional message of the solver.
        remark: Option<String>,
    },
    /// The solver cannot continue. Earlier messages stay valid.
    Lost(SolverLost),
    /// The thread has ended.
    Died,
}

/// Handle of the thread. When dropped, the thread ends after the current minor iteration.
pub struct Worker {
    jobs: Sender<Job>,
    messages: Receiver<Message>,
    /// Number of interrupt requests for the running job.
    stop: Arc<AtomicUsize>,
    /// Whether it runs a job that may take long.
    busy: Arc<AtomicBool>,
    /// The thread, if its end is waited for.
    thread: Option<Task>,
}

impl Worker {
    /// Starts an idle worker; `make` builds the solver on the new thread.
    pub fn new(make: impl FnOnce() -> Box<dyn Solver> + Send + 'static) -> Self {
        let (jobs, orders) = channel::<Job>();
        let (news, messages) = sync_channel(AHEAD);
        let stop = Arc::new(AtomicUsize::new(0));
        let flag = stop.clone();
        let busy = Arc::new(AtomicBool::new(false));
        let at_work = busy.clone();
        let thread = task::serve(orders, move || {
            let mut solver = make();
            solver.set_cancel(flag.clone());
            move |job| {
                let solver = &mut *solver;
                at_work.store(!matches!(job, Job::Look(_)), Ordering::Relaxed);
                let end = match job {
                    Job::Steps(state, steps) => match solver.restore(&state) {
                        Ok(()) => take(solver, steps, &news, &flag),
                        Err(lost) => send_last(&news, Message::Lost(lost)),
                    },
                    Job::Rest(steps) => take(solver, steps, &news, &flag),
                    Job::Look(look) => {
                        look(solver);
                        Some(None)
                    }
                    Job::End => None,
                };
                if let Some(Some(rest)) = end {
                    return Next::Rest(Job::Rest(rest));
                }
                at_work.store(false, Ordering::Relaxed);
                end.map_or(Next::End, |_| Next::Job)
            }
        });
        Worker {
            jobs,
            messages,
            stop,
            busy,
            thread: Some(thread),
        }
    }

    /// Does not wait for the thread when dropped: only external programs must be ended.
    pub fn unattended(mut self) -> Worker {
        self.thread = None;
        self
    }

    /// Access to the solver for other threads.
    pub fn lender(&self) -> Lender {
        Lender {
            jobs: self.jobs.clone(),
            busy: self.busy.clone(),
        }
    }

    /// Starts a job. A dead worker answers [`Message::Died`].
    pub fn start(&self, from: State, steps: Steps) {
        self.stop.store(0, Ordering::Relaxed);
        self.busy.store(true, Ordering::Relaxed);
        // If sending fails, the thread has ended; the next message reports that.
        let _ = self.jobs.send(Job::Steps(Box::new(from), steps));
    }

    /// Asks the running job to stop after the current minor iteration.
    pub fn interrupt(&self) {
        self.stop.fetch_add(1, Ordering::Relaxed);
    }

    /// The next message; blocks.
    pub fn next(&self) -> Message {
        loop {
            match self.try_next() {
                Some(message) => return message,
                None => task::nap(NAP),
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
        // The maximum, so that an external program is ended without further requests.
        self.stop.store(usize::MAX, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A `Lender` may hold another sender of this channel.
            let _ = self.jobs.send(Job::End);
            // The worker must not block on a full channel.
            drop(std::mem::replace(&mut self.messages, channel().1));
            thread.join();
        }
    }
}

/// Takes steps from the solver's state, and returns those that are left when the slice is over; `None` if the receiver is gone.
fn take(
    solver: &mut dyn Solver,
    steps: Steps,
    news: &SyncSender<Message>,
    stop: &AtomicUsize,
) -> Option<Option<Steps>> {
    match steps {
        Steps::Run {
            before,
            unit,
            count,
            breakpoints,
        } => run(solver, before, (unit, count), breakpoints, news, stop),
        Steps::Follow { mut before, steps } => {
            let rest = follow(solver, steps, news, stop, |solver, step, began| {
                made(solver, &mut before, step, began)
            });
            rest.map(|rest| rest.map(|steps| Steps::Follow { before, steps }))
        }
        Steps::Again { mut event, steps } => {
            let rest = follow(solver, steps, news, stop, |solver, step, _| {
                if step.is_none() {
                    event = Some(Arc::new(solver.event().clone()));
                }
                Message::Again(Box::new(solver.state().clone()), event.clone())
            });
            rest.map(|rest| rest.map(|steps| Steps::Again { event, steps }))
        }
    }
}

/// Solves; results as [`take`].
fn run(
    solver: &mut dyn Solver,
    mut before: Strip,
    (unit, count): (Unit, u32),
    breakpoints: Breakpoints,
    news: &SyncSender<Message>,
    stop: &AtomicUsize,
) -> Option<Option<Steps>> {
    let (mut left, mut hits) = (count, Vec::new());
    let interrupted = || stop.load(Ordering::Relaxed) > 0;
    let most = if count == 0 { 0 } else { u64::MAX };
    let until = Until::end()
        .minors(most)
        .past_failures()
        .interrupted_by(&interrupted);
    let mut began = Instant::now();
    // Our own solver detects cycles itself.
    let mut watch = solver.stepper().is_none().then(rounds::CycleWatch::default);
    let mut round = None;
    let end = drive(solver, until, |solver| {
        let (frame, strip) = frame_and_strip(solver, &before, began);
        left -= u32::from(unit.ends(strip.kind));
        if strip.kind.is_failure() {
            left = 0;
        }
        hits = breakpoints.hits(&before, &strip);
        before = strip.clone();
        round = watch.as_mut().and_then(|watch| watch.see(&strip));
        let heard = news.send(Message::Made(Box::new(frame), Box::new(strip)));
        if heard.is_err() || left == 0 || !hits.is_empty() || round.is_some() {
            return ControlFlow::Break(heard.ok().map(|()| false));
        }
        if task::is_slice_over() {
            return ControlFlow::Break(Some(true));
        }
        began = Instant::now();
        ControlFlow::Continue(())
    });
    let end = match end {
        Ok(RunEnd::Stopped(is_slice_over)) => {
            if is_slice_over? {
                return Some(Some(Steps::Run {
                    before,
                    unit,
                    count: left,
                    breakpoints,
                }));
            } else {
                RunEnd::Spent
            }
        }
        Ok(end) => end,
        Err(lost) => return send_last(news, Message::Lost(lost)),
    };
    let interrupted = matches!(end, RunEnd::Interrupted);
    let round = round.map(|round| rounds::words(solver.model(), &round, false));
    send_done(solver, news, interrupted, hits, round)
}

/// Sends what ends a command; `None` if the receiver is gone.
fn send_last<T>(news: &SyncSender<Message>, message: Message) -> Option<Option<T>> {
    news.send(message).ok().map(|()| None)
}

/// Sends the end of the steps with the solver's notice and `more`.
fn send_done<T>(
    solver: &mut dyn Solver,
    news: &SyncSender<Message>,
    interrupted: bool,
    hits: Vec<u32>,
    more: Option<String>,
) -> Option<Option<T>> {
    let parts = joined(solver.take_notice().into_iter().chain(more), "; ");
    let done = Message::Done {
        interrupted,
        hits,
        remark: (!parts.is_empty()).then_some(parts),
    };
    send_last(news, done)
}

/// The last minor iteration, started at `began`, as a frame and its strip.
fn frame_and_strip(solver: &mut dyn Solver, before: &Strip, began: Instant) -> (Frame, Strip) {
    let seconds = began.elapsed().as_secs_f32();
    let event = Arc::new(solver.event().clone());
    let strip = Strip::new(
        solver.model(),
        solver.state(),
        Some(&event),
        Some(before),
        seconds,
    );
    let frame = Frame {
        state: solver.state().clone(),
        event: Some(event),
        intervention: None,
        monitors: strip.kind.is_accepted().then(|| {
            let mut values = Vec::new();
            solver.monitors(&mut values);
            Arc::new(values)
        }),
    };
    (frame, strip)
}

/// Takes a given sequence of steps until one fails, and sends `message` of each; returns the steps that are left when the slice is
/// over, and `None` if the receiver is gone.
fn follow(
    solver: &mut dyn Solver,
    steps: Vec<Option<Intervention>>,
    news: &SyncSender<Message>,
    stop: &AtomicUsize,
    mut message: impl FnMut(&mut dyn Solver, Option<Intervention>, Instant) -> Message,
) -> Option<Option<Vec<Option<Intervention>>>> {
    let mut interrupted = false;
    let mut steps = steps.into_iter();
    while let Some(step) = steps.next() {
        if stop.load(Ordering::Relaxed) > 0 {
            interrupted = true;
            break;
        }
        let began = Instant::now();
        let taken = match &step {
            Some(intervention) => Ok(solver.intervene(intervention).is_ok()),
            None => solver.step(),
        };
        match taken {
            Ok(true) => news.send(message(solver, step, began)).ok()?,
            Ok(false) => break,
            Err(lost) => return send_last(news, Message::Lost(lost)),
        }
        if task::is_slice_over() && steps.len() > 0 {
            return Some(Some(steps.collect()));
        }
    }
    send_done(solver, news, interrupted, Vec::new(), None)
}

/// A step taken for the first time.
fn made(
    solver: &mut dyn Solver,
    before: &mut Strip,
    step: Option<Intervention>,
    began: Instant,
) -> Message {
    let Some(intervention) = step else {
        let (frame, strip) = frame_and_strip(solver, before, began);
        before.clone_from(&strip);
        return Message::Made(Box::new(frame), Box::new(strip));
    };
    let state = Box::new(solver.state().clone());
    *before = Strip::intervention(solver.model(), &state, before);
    Message::Changed(state, intervention)
}
