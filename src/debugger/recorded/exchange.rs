//! Replays a stored exchange: everything an attached solver did, without the solver.
//!
//! The file is read once into a tree of states, like that of the original session. Steps can only follow this
//! tree.

use super::decode::{self, RecordedStep, WireFrame};
use super::fault::Fault;
use super::log::Log;
use super::orders;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use stickslip_core::{
    Capabilities, Event, Intervention, Model, Now, Refusal, RewindSupport, Solver, SolverLost,
    State, StoredStates,
};
use stickslip_exchange::FormatError;
use stickslip_exchange::attach::conversation::STARTED;
use stickslip_exchange::attach::message::{self, ContactResult, Hello, Id};
use stickslip_exchange::attach::{Answer, Request, Side, TranscriptLine};
use stickslip_platform::input::{self, Unreadable};
use stickslip_scene::format::read;
use stickslip_scene::{FileKind, Scene, SceneError};

/// Steps from the start: an iteration (`None`) or an intervention each.
pub type Line = Vec<Option<Intervention>>;

/// The solver of a stored exchange.
pub struct RecordedSolver {
    start: State,
    model: Arc<Model>,
    places: StoredStates<Option<RecordedStep>>,
    offers: Capabilities,
    /// The current state, and the iteration before it.
    now: RecordedStep,
}

/// A stored exchange that has been read.
pub struct OpenedExchange {
    /// The solver's scene.
    pub scene: Scene,
    /// The replayed solver.
    pub past: RecordedSolver,
    /// All paths through the tree, in the order in which their ends were reached.
    pub lines: Vec<Line>,
    /// Log of the solver.
    pub log: Log,
}

/// Kind of the recording.
pub const READ_ONLY: &str = "stored exchange (read-only)";
/// Maximum size of the file in bytes.
const MOST_BYTES: u64 = 1 << 30;

/// Reads a stored exchange; `None` if the file is something else.
pub fn file(name: &str) -> Option<Result<OpenedExchange, SceneError>> {
    let path = Path::new(name);
    (FileKind::from_file(path)? == FileKind::Exchange).then(|| {
        let not_read = |why: Unreadable| read::not_read(name, &why);
        let large = "too large for an exchange";
        let mut bytes = input::bytes(path, MOST_BYTES, large).map_err(not_read)?;
        // If the writer was killed, the last line may end inside a character; incomplete lines are dropped
        // anyway.
        bytes.truncate(
            bytes
                .iter()
                .rposition(|byte| *byte == b'\n')
                .map_or(0, |end| end + 1),
        );
        open(name, &input::utf8(bytes).map_err(not_read)?)
    })
}

/// Reads a stored exchange; `name` is that of the file.
///
/// # Errors
/// If it is damaged.
pub fn open(name: &str, text: &str) -> Result<OpenedExchange, SceneError> {
    let kept = TranscriptLine::read(text).map_err(|broken| read::of_file(name, broken))?;
    let log = Log::default();
    let mut reader = ExchangeReader::new();
    for (number, line) in kept.iter().enumerate() {
        let broken = |broken: FormatError| {
            let column = broken.at.map_or(1, |(_, column)| column + 2);
            read::of_file(name, FormatError::at(number + 2, column, broken.message))
        };
        match line.side {
            Side::Noted => {
                if line.text.starts_with(STARTED) {
                    reader.begin();
                }
                log.noted(&line.text);
            }
            Side::Logged => log.printed(&line.text),
            Side::Asked => reader.take_request(Request::read(&line.text).map_err(broken)?),
            // An invalid message ended the original session.
            Side::Answered => match Answer::read(&line.text) {
                Ok(Answer::Message { level, text }) => log.message(level, &text),
                Ok(Answer::Progress(_)) => {}
                Ok(answer) => reader
                    .answered(name, answer)
                    .map_err(|fault| SceneError::whole(name, fault.to_string()))?,
                Err(_) => log.noted(&format!("invalid message: {}", line.text)),
            },
        }
    }
    let ExchangeReader {
        met: Some(met),
        places,
        ..
    } = reader
    else {
        return Err(SceneError::whole(name, Fault::NoScene.to_string()));
    };
    let past = RecordedSolver {
        offers: Capabilities {
            name: met.hello.name,
            version: met.hello.version,
            past: Some(READ_ONLY),
            goes_back: RewindSupport::ToAny,
            ..Capabilities::default()
        },
        start: met.start.state.clone(),
        now: met.start,
        model: Arc::new(met.scene.model.clone()),
        places,
    };
    Ok(OpenedExchange {
        lines: past
            .places
            .ends()
            .map(|end| past.places.steps(end))
            .collect(),
        scene: met.scene,
        past,
        log,
    })
}

/// State of the reader.
struct ExchangeReader {
    hello: Option<Hello>,
    met: Option<Greeting>,
    places: StoredStates<Option<RecordedStep>>,
    /// Current state of the solver, and the interventions there.
    at: u64,
    changed: Vec<Intervention>,
    tokens: HashMap<String, u64>,
    /// Contacts of each state that the next one may leave out.
    contacts: HashMap<u64, Vec<ContactResult>>,
    /// A request without an answer yet.
    pending: Option<Request>,
}

/// The solver and its scene.
struct Greeting {
    scene: Scene,
    hello: Hello,
    ids: Vec<Id>,
    start: RecordedStep,
}

impl ExchangeReader {
    fn new() -> ExchangeReader {
        ExchangeReader {
            hello: None,
            met: None,
            places: StoredStates::new(None),
            at: 0,
            changed: Vec::new(),
            tokens: HashMap::new(),
            contacts: HashMap::new(),
            pending: None,
        }
    }

    /// Handles the start of a solver.
    fn begin(&mut self) {
        self.at = 0;
        self.changed.clear();
        self.tokens.clear();
        self.pending = None;
    }

    fn take_request(&mut self, request: Request) {
        if !matches!(request, Request::Interrupt | Request::Bye) {
            self.pending = Some(request);
        }
    }

    fn answered(&mut self, name: &str, answer: Answer) -> Result<(), Fault> {
        let pending = self.pending.take();
        match (answer, pending) {
            (Answer::Hello(hello), _) => self.hello = Some(*hello),
            (Answer::Scene(sent), _) if self.met.is_none() => {
                let hello = self.hello.clone().ok_or(Fault::NoScene)?;
                let mut known = hello.parameters.iter();
                let increment = known.find(|known| known.name == orders::INCREMENT);
                let increment = increment.and_then(|known| known.value.as_f64());
                let (scene, ids, start) = decode::start(name, &sent, increment)?;
                self.met = Some(Greeting {
                    scene,
                    hello,
                    ids,
                    start,
                });
            }
            (Answer::State(sent), _) => self.recorded_step(*sent)?,
            (Answer::Saved { token }, _) => {
                self.tokens.insert(token.to_string(), self.at);
            }
            (Answer::Ok, Some(Request::Restore { token })) => {
                self.at = self.tokens.get(&token.to_string()).copied().unwrap_or(0);
                self.changed.clear();
            }
            (Answer::Ok, Some(request)) => {
                let met = self.met.as_ref().ok_or(Fault::NoScene)?;
                let now = self.state(met).controls.friction.clone();
                let contacts = &met.scene.model.contacts;
                orders::add(&mut self.changed, &request, &met.ids, &now, contacts);
            }
            _ => {}
        }
        Ok(())
    }

    /// The current state of the solver, without the interventions there.
    fn state<'a>(&'a self, met: &'a Greeting) -> &'a State {
        let led = self.places.get(self.at).and_then(Option::as_ref);
        &led.unwrap_or(&met.start).state
    }

    fn recorded_step(&mut self, mut sent: message::State) -> Result<(), Fault> {
        let met = self.met.as_ref().ok_or(Fault::NoScene)?;
        let asked = std::mem::take(&mut self.changed);
        if let Some(place) = self.places.follows(self.at, &asked) {
            self.at = place;
            return Ok(());
        }
        let mut from = self.state(met).clone();
        for intervention in &asked {
            // It was accepted in the original session.
            let _ = from.intervene(&met.scene.model, intervention);
        }
        let frame = WireFrame {
            model: &met.scene.model,
            ids: &met.ids,
            decides: met.hello.decides,
        };
        let mut contacts = Vec::new();
        if met.hello.abilities.partial {
            let before = self.contacts.get(&self.at).map_or(&[][..], Vec::as_slice);
            let all = sent.complete(&met.ids, before);
            contacts = all.map_err(|why| Fault::Unfit {
                message: "state",
                why,
            })?;
        }
        let led = frame.recorded_step(&from, &sent)?;
        self.at = self.places.add(self.at, asked, Some(led));
        self.contacts.insert(self.at, contacts);
        if let Some(Some(led)) = self.places.get_mut(self.at) {
            led.state_at(self.at);
        }
        Ok(())
    }
}

impl RecordedSolver {
    /// Returns to the start.
    pub fn rewind(&mut self) {
        self.now.state.clone_from(&self.start);
        self.now.event = Event::nothing_yet(&self.model);
    }

    /// The next recorded iteration from the current state.
    fn next(&self) -> Option<&RecordedStep> {
        let place = self
            .places
            .follows(self.now.state.place()?, self.now.state.changes())?;
        self.places.get(place)?.as_ref()
    }
}

impl Solver for RecordedSolver {
    fn now(&self) -> Now<'_> {
        Now::new(&self.model, &self.now.state, &self.now.event)
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.now.state
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        let Some(led) = self.next().cloned() else {
            return Err(SolverLost::new(Fault::Past.to_string()));
        };
        self.now = led;
        Ok(())
    }

    fn intervene(&mut self, intervention: &Intervention) -> Result<(), Refusal> {
        self.now.state.intervene(&self.model, intervention)
    }

    fn monitors(&mut self, out: &mut Vec<f64>) {
        out.extend_from_slice(&self.now.monitors);
    }

    fn capabilities(&self) -> Capabilities {
        self.offers.clone()
    }
}
