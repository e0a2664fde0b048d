//! A finished CalculiX run as a read-only solver: each iteration in its files is one minor iteration.
//!
//! - [`run`]: the iterations; `cycle`: detection of cycles; [`words`]: descriptions, and the whole run as text; [`rules`]: why it
//!   did not converge; [`switches`]: its mesh for ParaView.

mod cycle;
pub mod rules;
pub mod run;
pub mod switches;
pub mod words;

use super::log::Log;
use rules::shape::DeckShape;
use run::CalculixRun;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use stickslip_core::model::FinishedRun;
use stickslip_core::step::event::Words;
use stickslip_core::{
    Capabilities, ContactRecord, Event, Failure, Intervention, Mode, Model, Norms, Now, Outcome,
    Position, Refusal, RewindSupport, Solver, SolverLost, State, SurfacePoint,
};
use stickslip_exchange::attach::message::{self, Id, Level};
use stickslip_exchange::calculix::cel::Slave;
use stickslip_exchange::calculix::files::End;
use stickslip_exchange::inp::Deck;
use stickslip_scene::Scene;
use stickslip_scene::calculix;

/// A run that has been read.
pub struct OpenedRun {
    /// The contacts, without geometry.
    pub scene: Scene,
    /// The run.
    pub run: Arc<CalculixRun>,
    /// Remarks on the files, and the run as text.
    pub log: Log,
}

/// Opens a run, given the name of its .cel; `None` for other names.
pub fn file(name: &str) -> Option<Result<OpenedRun, String>> {
    calculix::is_cel(name).then(|| {
        let path = Path::new(name);
        let run = CalculixRun::new(name, calculix::read(path)?);
        match calculix::deck_of(path) {
            Ok(deck) => open(run, deck),
            Err(unread) => {
                let opened = open(run, None)?;
                opened.log.message(Level::Warning, &unread.to_string());
                Ok(opened)
            }
        }
    })
}

/// Opens a run; the rules explain it with its deck, if there is one.
///
/// # Errors
/// If it has no contacts, or too many.
pub fn open(run: CalculixRun, deck: Option<Deck>) -> Result<OpenedRun, String> {
    let run = explained(run, deck)?;
    let slaves = 0..run.files.slaves.len();
    let contact = |slave: usize| message::Contact {
        id: Id::Number(slave as i64),
        name: run.slave(slave),
        node: slave,
        ..message::Contact::default()
    };
    let node = |slave: usize| message::NodeMessage {
        name: run.slave(slave),
        at: Some(message::Components::Two([0.0, 0.0])),
    };
    let scene = message::Scene {
        title: Path::new(&run.name)
            .file_name()
            .map(|name| name.to_string_lossy().into_owned())
            .unwrap_or_default(),
        about: words::NO_MODES_IN_FULL.into(),
        dimension: 2,
        mesh: None,
        nodes: slaves.clone().map(node).collect(),
        lines: Vec::new(),
        faces: Vec::new(),
        surfaces: Vec::new(),
        contacts: slaves.map(contact).collect(),
        load: None,
        monitors: Vec::new(),
        arc: false,
        drag: false,
    };
    let mut scene = Scene::from_message(&run.name, &scene, None).map_err(|why| why.to_string())?;
    scene.model.finished = Some(FinishedRun {
        increments: run
            .increments()
            .into_iter()
            .map(|(step, k)| format!("{step}.{k}"))
            .collect(),
        cycles: run
            .cycles
            .iter()
            .flatten()
            .map(|cycle| cycle.iterations.clone())
            .collect(),
        correction_limit: run::CORRECTION_LIMIT / 100.0,
        converged: rules::ended_converged(&run),
        findings: run.findings.clone(),
        shape: run.shape.clone(),
    });
    let log = Log::default();
    // The status line already shows the first line.
    for line in words::text(&run).lines().skip(1) {
        log.printed(line);
    }
    for note in words::notes(&run) {
        log.message(Level::Warning, &note);
    }
    Ok(OpenedRun {
        scene,
        run: Arc::new(run),
        log,
    })
}

/// Applies the rules to a run. If nothing was ever in contact, the slave nodes of the deck are its contacts.
fn explained(mut run: CalculixRun, deck: Option<Deck>) -> Result<CalculixRun, String> {
    let mut shape = deck.as_ref().map(DeckShape::new);
    if let Some(shape) = shape.as_ref().filter(|_| run.files.slaves.is_empty()) {
        let label = |node: usize| shape.deck.nodes[node].label.try_into().ok();
        let labels: BTreeSet<u32> = shape
            .pairs
            .iter()
            .flat_map(|pair| &pair.nodes)
            .filter_map(|node| label(node.node))
            .collect();
        run.files.slaves = labels.into_iter().map(Slave::Node).collect();
        run = CalculixRun::new(run.name, run.files);
    }
    if run.files.slaves.is_empty() {
        return Err(format!(
            "{}: no contact element in this file, and no deck with contact pairs next to it, so there is nothing to show",
            run.name
        ));
    }
    if let (Some(shape), Some(last)) = (&mut shape, run.files.attempts.last()) {
        shape.failed = (last.step as usize).checked_sub(1);
    }
    run.findings = rules::examine(shape.as_ref(), Some(&run));
    if let Some(shape) = &shape {
        run.shape = shape.drawn(&run.files.slaves);
    }
    drop(shape);
    run.deck = deck;
    Ok(run)
}

/// A run as a solver that replays its iterations. A state is identified by the number of iterations before it.
pub struct RecordedRun {
    run: Arc<CalculixRun>,
    /// Increment number of each attempt, from 1.
    increments: Vec<u32>,
    model: Arc<Model>,
    state: State,
    event: Event,
}

impl RecordedRun {
    /// The solver at the start of the run.
    pub fn new(opened: &OpenedRun) -> RecordedRun {
        let run = opened.run.clone();
        let all = run.increments();
        let number = |a: &stickslip_exchange::calculix::files::Attempt| {
            all.partition_point(|increment| *increment <= (a.step, a.increment)) as u32
        };
        let model = Arc::new(opened.scene.model.clone());
        RecordedRun {
            increments: run.files.attempts.iter().map(number).collect(),
            state: State::outside_start(&model),
            event: Event::nothing_yet(&model),
            run,
            model,
        }
    }

    /// Whether a slave is closed in an iteration; unknown counts as open.
    fn mode(&self, iteration: usize, slave: usize) -> Mode {
        match self.run.contact(iteration, slave) {
            Some([_, ..]) => Mode::Fixed,
            _ => Mode::Free,
        }
    }

    fn record(&self, iteration: usize, slave: usize) -> ContactRecord {
        let attempt = &self.run.files.attempts[self.run.attempt(iteration)];
        let next = (iteration + 1).min(attempt.iterations.end - 1);
        let modes = [iteration, next].map(|k| self.mode(k, slave));
        let master = self.run.contact(iteration, slave).and_then(<[_]>::first);
        ContactRecord {
            f_n: f64::NAN,
            f_t: f64::NAN,
            t_max: f64::NAN,
            t_max_used: f64::NAN,
            slip: f64::NAN,
            drift: f64::NAN,
            spot: master.map(|closed| SurfacePoint {
                surface: 0,
                element: closed.master as usize,
                xi: 0.0,
            }),
            ..ContactRecord::from_modes(modes[0], modes[1], &self.state.nodes[slave])
        }
    }

    /// The event of an iteration.
    fn event_of(&self, iteration: usize) -> Event {
        let run = &*self.run;
        let index = run.attempt(iteration);
        let (this, attempt) = (&run.files.iterations[iteration], &run.files.attempts[index]);
        let percent = |value: Option<f64>| value.map_or(f64::NAN, |percent| percent / 100.0);
        let norms = Norms {
            force: f64::NAN,
            relative: percent(this.norms.map(|norms| norms.residual)),
            interface: f64::NAN,
            correction: percent(this.norms.map(|norms| norms.correction)),
            scale: f64::NAN,
            limit: run::residual_limit(this.number) / 100.0,
            noise: 0.0,
        };
        let why = || Failure::Reported {
            reason: words::attempt(run, index),
            relative: this.norms.map(|norms| norms.residual / 100.0),
        };
        let last_attempt = index + 1 == run.files.attempts.len();
        let outcome = match attempt.end {
            _ if iteration + 1 < attempt.iterations.end => Outcome::Minor,
            End::Converged => Outcome::accepted(norms, last_attempt),
            End::NotConverged if run.is_tried_again(index) => Outcome::Cut {
                why: why(),
                size: f64::NAN,
            },
            End::NotConverged => Outcome::Failed(why()),
            End::Unknown => Outcome::Minor,
        };
        let slaves = 0..run.files.slaves.len();
        let row = attempt.row;
        Event {
            position: Position {
                increment: self.increments[index],
                attempt: attempt.attempt,
                major: 1,
                minor: this.number,
            },
            load_factor: row.map_or(f64::NAN, |row| {
                if row.converged {
                    row.total_time
                } else {
                    row.total_time + row.size
                }
            }),
            arc: None,
            drag: 0.0,
            frames: Arc::default(),
            nodes: slaves
                .clone()
                .map(|slave| self.record(iteration, slave))
                .collect(),
            before: norms,
            words: Arc::new(Words {
                iteration: words::iteration(run, iteration),
                contacts: slaves
                    .clone()
                    .map(|slave| words::contact(run, iteration, slave))
                    .collect(),
                letters: slaves
                    .map(|slave| words::letter(run, iteration, slave))
                    .collect(),
            }),
            outcome,
        }
    }
}

impl Solver for RecordedRun {
    fn now(&self) -> Now<'_> {
        Now::new(&self.model, &self.state, &self.event)
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        let iteration = self.state.place().unwrap_or(0) as usize;
        if iteration >= self.run.files.iterations.len() {
            let text = format!("this is the last iteration of a {}", words::READ_ONLY);
            return Err(SolverLost::new(text));
        }
        self.event = self.event_of(iteration);
        self.state.follow(&self.event, iteration as u64 + 1);
        Ok(())
    }

    fn intervene(&mut self, intervention: &Intervention) -> Result<(), Refusal> {
        self.capabilities().check(intervention)
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities {
            name: "CalculiX".into(),
            past: Some(words::READ_ONLY),
            cures: true,
            goes_back: RewindSupport::ToAny,
            ..Capabilities::default()
        }
    }
}
