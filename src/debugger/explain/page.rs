//! The diagnosis page: what happened, where, why, what was tried, and what to do, most useful first.
//!
//! For a failed state it explains the failure; for other states it shows the consistent states of the frozen
//! problem that is solved next. Slow parts (trials of remedies, the load that smaller steps reach) come last,
//! so that the page grows while it is read.

use super::advice::{FORCE_THIRD_MODE, START_TOUCHING, advice, by_hand};
use super::attempt::Attempt;
use super::diagnosis::undecided;
use super::examination::{DONE, Examination, frozen, nothing};
use super::facts::{Fact, Part};
use super::failures;
use super::headline::{at, headline};
use super::indefinite::{self, indefinite};
use super::judged;
use super::jumped::leads_away;
use super::limit_load::{LoadEnd, finish_ladder, limit_load, of_strategy};
use super::load_limit_probe::reach;
use super::majors;
use super::names;
use super::remedies::{RemedyTrial, attempt};
use super::remedy::{RAMP, Remedy, RemedyInput, RemedyKind};
use super::report::sound;
use super::rigid_motion::loose;
use super::strain::MaterialCause;
use super::try_list::{self, TryLine, TryOutcome, helps};
use stickslip_core::interface::census::MOST;
use stickslip_core::model::FinishedRun;
use stickslip_core::{
    Body, BodyKind, Failure, Model, Norms, NotFound, Singular, State, Status, Stepper,
};
use stickslip_scene::gaps::turned;
use stickslip_scene::{Spec, sig2, sig4};

/// Shown if the first increment fails and nodes start inside their surface.
const OVERLAP: &str = "nodes start inside their surface; settings.initial_gaps=ramp moves them out over the first leg of the path, adjust moves them onto the surface";
/// Maximum number of consistent states that are tried.
const MOST_STATES: usize = 4;
/// Maximum number of remedies tried for the page; the list of remedies tries all.
const MOST_TRIED: usize = 6;

/// Makes the page of a state. A finer mesh is generated from `spec`, the scene as its author wrote it. `warnings` are
/// those of the run, which the page of a failed state repeats. `tell` is called with each version of the page. `None` if interrupted.
pub fn page(
    stepper: &mut Stepper,
    state: &State,
    spec: Option<&Spec>,
    warnings: Vec<String>,
    stop: &dyn Fn() -> bool,
    tell: &mut dyn FnMut(&DiagnosisPage),
) -> Option<DiagnosisPage> {
    let Status::Failed(failure) = &state.status else {
        let found = match state.status {
            Status::Finished => nothing(DONE),
            _ => frozen(stepper, state, stop),
        };
        let found = DiagnosisPage::new(stepper.model(), found);
        if stop() {
            tell(&found);
            return None;
        }
        return Some(found);
    };
    let mut page = PageBuilder::from_state(stepper, state, failure, stop);
    page.facts.extend(Fact::all(Part::Details, warnings));
    tell(&page.shown("trying remedies …"));
    page.pending = page.remedies(stepper.model(), state, (failure, spec));
    while !page.pending.is_empty() {
        let remedy = &page.pending[0].clone();
        tell(&page.shown(&format!("trying {} …", remedy.label)));
        match attempt(stepper, state, spec, remedy, stop) {
            Some(trial) => page.trials.push(trial),
            // The scene cannot be changed this way, so there is no trial.
            None if matches!(remedy.how, RemedyInput::Restart(_)) && !stop() => {}
            None => return None,
        }
        page.pending.remove(0);
    }
    tell(&page.shown("looking for a limit load …"));
    page.add_limit_load(stepper, state, failure, stop);
    if page.asks_how_far(failure) {
        tell(&page.shown("checking how far smaller steps reach …"));
        let reached = reach(stepper, state, stop)?;
        let far = reached.words(stepper.model(), failure);
        page.facts.push(Fact::new(Part::Details, far));
    }
    Some(page.shown(""))
}

/// The causes of a failure, without trials.
pub fn causes(
    stepper: &mut Stepper,
    state: &State,
    failure: &Failure,
    stop: &dyn Fn() -> bool,
) -> Vec<String> {
    let mut page = PageBuilder::from_state(stepper, state, failure, stop);
    page.add_limit_load(stepper, state, failure, stop);
    page.shown("").why
}

/// The first remedy that a trial shows to work, for `run`. Only remedies that a scene file or `--set` can contain are tried,
/// until the trials take as many minor iterations as `most`.
pub fn first_that_works(
    stepper: &mut Stepper,
    state: &State,
    failure: &Failure,
    (spec, most): (&Spec, u64),
    stop: &dyn Fn() -> bool,
) -> Option<TryLine> {
    let mut minors = 0;
    for remedy in advice(stepper.model(), state, failure, Some(spec)) {
        let typed = matches!(remedy.how, RemedyInput::Set(..) | RemedyInput::Restart(_));
        if !typed || minors >= most || stop() {
            continue;
        }
        let Some(trial) = attempt(stepper, state, Some(spec), &remedy, stop) else {
            continue;
        };
        minors += u64::from(trial.minors);
        if helps(&trial) {
            return Some(TryLine::tried(&trial));
        }
    }
    None
}

/// The diagnosis of a state, as the debugger shows it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DiagnosisPage {
    /// What happened, in one line.
    pub what: String,
    /// The causes, at most three.
    pub why: Vec<String>,
    /// What can be done, with the outcome of each trial, best first.
    pub tries: Vec<TryLine>,
    /// The other facts, by part.
    pub below: Vec<(Part, Vec<String>)>,
    /// The analysis in progress; empty when all are done.
    pub going_on: String,
    /// The examination of the frozen problem.
    pub found: Examination,
}

impl DiagnosisPage {
    /// The page of a state that has not failed; it offers to start from the consistent states.
    pub fn new(model: &Model, found: Examination) -> DiagnosisPage {
        let states = Remedy::answers(model, &found).into_iter();
        DiagnosisPage {
            tries: states.map(|state| TryLine::untried(&state, None)).collect(),
            ..DiagnosisPage::with_facts(found.head.clone(), found.facts.clone(), found)
        }
    }

    /// The page of an attached solver's state: what it reports, the examination of its interface problem, and what can be
    /// done by hand.
    pub fn attached(
        reported: Vec<String>,
        mut found: Examination,
        tries: Vec<TryLine>,
    ) -> DiagnosisPage {
        let mut reported = reported.into_iter();
        let head = std::mem::take(&mut found.head);
        let what = reported.next();
        let mut facts: Vec<Fact> = reported.map(Fact::why).collect();
        let what = match what {
            None => head,
            Some(what) => {
                facts.push(Fact::new(Part::Details, head));
                what
            }
        };
        facts.append(&mut found.facts);
        DiagnosisPage {
            tries,
            ..DiagnosisPage::with_facts(what, facts, found)
        }
    }

    /// The page of a finished run of another program: what its rules found.
    pub fn finished(run: &FinishedRun) -> DiagnosisPage {
        let what = match &run.findings[..] {
            [] if run.converged => "Run: the last attempt converged, and no rule applies".into(),
            [] => "Run: it failed, and no rule applies to it".into(),
            [only] => format!("Run: {}", only.rule),
            [first, others @ ..] => format!("Run: {} (and {} more)", first.rule, others.len()),
        };
        let facts = run.findings.iter().map(|found| Fact::why(&found.cause));
        let found = Examination {
            fails: true,
            ..Examination::default()
        };
        DiagnosisPage {
            tries: run
                .findings
                .iter()
                .filter(|f| !f.cure.is_empty())
                .map(TryLine::from_finding)
                .collect(),
            ..DiagnosisPage::with_facts(what, facts.collect(), found)
        }
    }

    /// A page with these facts; causes beyond the first few become details.
    fn with_facts(what: String, facts: Vec<Fact>, found: Examination) -> DiagnosisPage {
        let (mut why, mut rest): (Vec<Fact>, Vec<Fact>) =
            facts.into_iter().partition(|fact| fact.part == Part::Why);
        let more = why.split_off(why.len().min(MOST_WHY)).into_iter();
        let more = more.map(|fact| Fact::new(Part::Details, fact.text));
        rest.splice(0..0, more);
        // Several motions of a body have the same contacts.
        let mut seen: Vec<String> = why.iter().map(|fact| fact.text.clone()).collect();
        rest.retain(|fact| {
            let is_new = fact.part != Part::Details || !seen.contains(&fact.text);
            seen.push(fact.text.clone());
            is_new
        });
        let of = |part: Part| {
            let lines = rest.iter().filter(|fact| fact.part == part);
            let lines: Vec<String> = lines.map(|fact| fact.text.clone()).collect();
            (!lines.is_empty()).then_some((part, lines))
        };
        DiagnosisPage {
            what,
            why: why.into_iter().map(|fact| fact.text).collect(),
            below: Part::ALL[1..].iter().copied().filter_map(of).collect(),
            found,
            ..DiagnosisPage::default()
        }
    }

    /// Whether no trial is running any more.
    pub fn is_complete(&self) -> bool {
        !self.going_on.starts_with("trying")
    }

    /// The first line of Try that works.
    pub fn works(&self) -> Option<&TryLine> {
        let mut tries = self.tries.iter();
        tries.find(|line| line.outcome == TryOutcome::Works)
    }

    /// The page as text, one fact per line.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = if self.found.fails {
            vec![format!("What: {}", self.what)]
        } else {
            vec![self.what.clone()]
        };
        lines.extend(self.why.iter().map(|text| format!("Why: {text}")));
        let tries = self.tries.iter().enumerate();
        lines.extend(
            tries.map(|(k, line)| format!("Try {}: {} {}", k + 1, line.mark(), line.words())),
        );
        for (part, texts) in &self.below {
            lines.push(format!("{}:", part.heading()));
            lines.extend(texts.iter().map(|text| format!("  {text}")));
        }
        lines
    }
}

/// Maximum number of causes.
const MOST_WHY: usize = 3;

/// The page in progress.
#[derive(Default)]
struct PageBuilder {
    what: String,
    facts: Vec<Fact>,
    /// Remedies in the scene's file or by hand.
    by_hand: Vec<&'static str>,
    /// Remedies that are still to be tried, and the trials of the others.
    pending: Vec<Remedy>,
    trials: Vec<RemedyTrial>,
    /// The examination of the frozen problem.
    found: Examination,
}

impl PageBuilder {
    fn from_state(
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
    ) -> PageBuilder {
        let mut page = PageBuilder {
            what: headline(stepper.model(), state, failure),
            ..PageBuilder::default()
        };
        let cause = MaterialCause::find(stepper.model(), state, failure);
        let certain = cause.filter(MaterialCause::is_certain);
        let words = |cause: MaterialCause| Fact::why(cause.words(stepper.model()));
        let overlap = Remedy::from_kind(RAMP, stepper.model(), state);
        page.facts.extend(overlap.map(|_| Fact::why(OVERLAP)));
        let turned = turned(stepper.model());
        let is_turned = !turned.is_empty();
        let turned = turned.iter().map(|found| found.words(stepper.model()));
        page.facts.extend(turned.map(Fact::why));
        page.facts.extend(certain.map(words));
        let possible = cause.filter(|cause| !cause.is_certain()).map(words);
        page.explain(stepper, state, failure, stop);
        page.facts.extend(possible);
        if is_turned {
            // The wrong side explains the rest.
            let causes = page.facts.iter_mut().filter(|fact| fact.part == Part::Why);
            causes.skip(1).for_each(|fact| fact.part = Part::Details);
        } else {
            page.by_hand.extend(by_hand(state, failure));
        }
        page.facts
            .push(Fact::new(Part::Details, sound(state.next, state)));
        page
    }

    /// Where and why, for each kind of failure.
    fn explain(
        &mut self,
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
    ) {
        match failure {
            Failure::Singular(Singular::Rigid { motions }) => {
                let rigid = loose(stepper, state, motions);
                self.facts.extend(rigid.facts);
                self.found.arrows = rigid.arrows;
            }
            Failure::MajorCycle(round) => {
                self.found.nodes = round.members.iter().map(|member| member.0).collect();
                self.repeat(stepper, state, failure, stop);
            }
            Failure::MajorLimit { .. } | Failure::Diverged { .. } => {
                self.repeat(stepper, state, failure, stop);
            }
            Failure::NotFound(NotFound::TooMany { nodes }) => self.facts.push(Fact::why(format!(
                "strategy census tries all modes of at most {MOST} nodes, and {nodes} can touch"
            ))),
            Failure::Cycle(_)
            | Failure::MinorLimit { .. }
            | Failure::NotFound(_)
            | Failure::Reported { .. } => {
                self.look_at_frozen(stepper, state, stop);
            }
            Failure::NoAnswer { first, .. } => {
                self.look_at_frozen(stepper, state, stop);
                if let Some(first) = first {
                    self.explain_first(stepper.model(), first);
                }
            }
            Failure::LadderEnded { first, .. } => {
                self.explain_first(stepper.model(), first);
                self.look_at_frozen(stepper, state, stop);
            }
            Failure::Refused(found) => {
                self.found.nodes.extend(found.slave);
                let model = stepper.model();
                let place = judged::place(model, &model.places(&state.u), found);
                self.facts.push(Fact::why(place));
                self.facts.push(Fact::why(format!(
                    "the iterations have converged, but the state violates a law: {} is {}, limit {}",
                    found.law.name(),
                    sig2(found.amount),
                    sig2(found.allowed)
                )));
            }
            Failure::CutTooOften { slave, last, .. } => {
                self.found.nodes.push(*slave);
                self.explain(stepper, state, last, stop);
            }
            Failure::OverConstrained { slave, .. } => {
                self.found.nodes.push(*slave);
                let over = over_constrained(stepper, state, *slave);
                self.facts.extend(over.map(Fact::why));
            }
            Failure::Singular(Singular::Unexplained) => {
                self.facts.push(Fact::why(unexplained(stepper.model())));
            }
            Failure::BranchJump {
                unstable: Some(stability),
                ..
            } => self.facts.push(Fact::why(format!(
                "{}, even with the smallest increment: no stable equilibrium is near",
                leads_away(*stability)
            ))),
            Failure::BranchJump {
                motion, predicted, ..
            } => {
                self.facts.push(Fact::why(format!(
                    "the motion is {:.1} times what the tangent and the previous increments predict, even with the smallest increment: load control skips the part of the path between the two states",
                    motion / predicted.max(f64::MIN_POSITIVE)
                )));
            }
            Failure::PathReversal => self.facts.push(Fact::why(
                "displacements and load turn back along the last increment: the path turns by more than a right angle here, or ends",
            )),
            Failure::ZeroMeasure => self.facts.push(Fact::why(
                "the tangent at the start of the increment does not change what history.arc measures",
            )),
            Failure::NoRest { .. } => self.facts.push(Fact::why(
                "beyond the last equilibrium load nothing stops the motion",
            )),
            Failure::RoundOff { .. } => self.facts.extend(stiffest(stepper.model()).map(Fact::why)),
            // The element comes first.
            Failure::Inverted(_) => {}
        }
    }

    /// Repeats an attempt whose major iterations failed, and adds facts about it.
    fn repeat(
        &mut self,
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
    ) {
        let Some(attempt) = Attempt::again(stepper, state, failure, stop) else {
            return self.facts.push(Fact::new(
                Part::Details,
                "repeated from its start, the attempt ends differently: something was changed by hand during it",
            ));
        };
        let model = stepper.model();
        self.facts.extend(match failure {
            Failure::MajorCycle(round) => majors::cycle_words(model, &attempt, round),
            Failure::MajorLimit { .. } => majors::limit_words(model, &state.settings(), &attempt),
            _ => majors::flight_words(model, state, &attempt),
        });
    }

    /// The first strategy's failure in this major iteration, before the ladder continued.
    fn explain_first(&mut self, model: &Model, first: &Failure) {
        let members: &[(usize, Vec<stickslip_core::Mode>)] = match first {
            Failure::Cycle(cycle) => &cycle.members,
            _ => &[],
        };
        self.found
            .nodes
            .extend(members.iter().map(|member| member.0));
        self.facts.push(Fact::new(
            Part::Details,
            format!(
                "the first strategy failed: {}",
                failures::describe(model, first)
            ),
        ));
    }

    /// The diagnosis of the frozen problem, or its census.
    fn look_at_frozen(&mut self, stepper: &mut Stepper, state: &State, stop: &dyn Fn() -> bool) {
        let arrows = std::mem::take(&mut self.found.arrows);
        let nodes = std::mem::take(&mut self.found.nodes);
        self.found = frozen(stepper, state, stop);
        self.found.arrows = arrows;
        self.found.nodes.extend(nodes);
        stepper.restore(state);
        // Only a matrix that was written down has been rounded; computed ones are exact to round-off.
        if stepper.model().bodies.iter().any(Body::is_linear)
            && let Some(problem) = stepper.interface_problem()
            && let Some(problem) = problem.reduced(&undecided(&problem))
            && let Some(text) = indefinite(&problem, stop)
        {
            let name = |place: usize| names::slave(stepper.model(), problem.nodes[place].slave);
            let mut lines = Fact::all(Part::Details, indefinite::words(&text, &name));
            if let Some(first) = lines.first_mut().filter(|_| text.is_by_rounding()) {
                first.part = Part::Why;
            }
            self.facts.extend(lines);
        }
        self.facts.append(&mut self.found.facts);
    }

    /// The load at which friction is used up or contact is lost, or the largest one, if that is the cause: then it comes first, except
    /// after a material that left its range.
    fn add_limit_load(
        &mut self,
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
    ) {
        let text = match limit_load(stepper, state, failure, stop) {
            Some(LoadEnd::Limit(text)) => text,
            // Try shows it already if it was tried there.
            Some(LoadEnd::Strategy(minors)) if !self.trials.iter().any(helps) => {
                let shown = finish_ladder(&mut self.trials, stepper, state, stop);
                let text = of_strategy(shown.unwrap_or(minors), shown.is_some());
                self.facts.insert(0, Fact::why(text));
                return;
            }
            _ => return,
        };
        self.by_hand.retain(|text| !START_TOUCHING.contains(text));
        // A body that is held up to a load is not simply loose.
        if matches!(failure, Failure::Singular(Singular::Rigid { .. })) {
            self.what = at(state, "equilibrium ends before this load");
        }
        let has_left_range = matches!(
            Remedy::law(stepper.model(), state, failure),
            Some((_, true))
        );
        let place = usize::from(has_left_range).min(self.facts.len());
        self.facts.insert(place, Fact::why(text));
    }

    /// The remedies tried for the page: the consistent states, and those for this kind of failure.
    fn remedies(
        &self,
        model: &Model,
        state: &State,
        (failure, spec): (&Failure, Option<&Spec>),
    ) -> Vec<Remedy> {
        let mut all = Remedy::answers(model, &self.found);
        all.truncate(if turned(model).is_empty() {
            MOST_STATES
        } else {
            0
        });
        let certain = matches!(Remedy::law(model, state, failure), Some((_, true)));
        let advised = advice(model, state, failure, spec);
        let (finer, advised): (Vec<Remedy>, Vec<Remedy>) = advised
            .into_iter()
            .partition(|remedy| remedy.kind == RemedyKind::Finer);
        let is_law = |remedy: &Remedy| remedy.kind == RemedyKind::Law;
        if certain {
            all.splice(0..0, advised.iter().filter(|r| is_law(r)).cloned());
        }
        all.extend(advised.into_iter().filter(|r| !is_law(r)));
        all.truncate(MOST_TRIED);
        all.extend(finer);
        all
    }

    /// Whether to check how far smaller steps reach: not if a trial has reached the load.
    fn asks_how_far(&self, failure: &Failure) -> bool {
        let helped = self.trials.iter().any(helps);
        let can = !matches!(
            failure,
            Failure::Singular(Singular::Rigid { .. })
                | Failure::RoundOff { .. }
                | Failure::Inverted(_)
                | Failure::OverConstrained { .. }
        );
        can && !helped
    }

    /// The page so far.
    fn shown(&self, going_on: &str) -> DiagnosisPage {
        let found = Examination {
            fails: true,
            ..self.found.clone()
        };
        let mut facts = self.facts.clone();
        if !self.found.fails && !found.head.is_empty() {
            // The head of the examination is all that is known where nothing else is.
            let explained = facts.iter().any(|fact| fact.part == Part::Why);
            let part = if explained { Part::Details } else { Part::Why };
            facts.insert(0, Fact::new(part, &found.head));
        }
        DiagnosisPage {
            tries: self.tries(),
            going_on: going_on.to_owned(),
            ..DiagnosisPage::with_facts(self.what.clone(), facts, found)
        }
    }

    /// The list Try, best first.
    fn tries(&self) -> Vec<TryLine> {
        let mut lines: Vec<TryLine> = self.trials.iter().map(TryLine::tried).collect();
        let seconds = self.trials.iter().map(|trial| trial.seconds);
        let seconds = seconds.fold(None, |most: Option<f64>, s| {
            Some(most.map_or(s, |m| m.max(s)))
        });
        let pending = self.pending.iter();
        lines.extend(pending.map(|remedy| TryLine::untried(remedy, seconds)));
        // Without consistent modes no forced mode helps.
        let census = self.found.census.as_ref();
        let has_none = census.is_some_and(|census| census.exact && census.answers.is_empty());
        let by_hand = self.by_hand.iter();
        let by_hand = by_hand.filter(|text| !has_none || **text != FORCE_THIRD_MODE);
        lines.extend(by_hand.map(|text| TryLine::by_hand(text)));
        try_list::sort(&mut lines);
        lines
    }
}

/// Why equations may be singular although no body has a free rigid motion.
fn unexplained(model: &Model) -> &'static str {
    if model.bodies.iter().any(Body::is_linear) {
        "in one direction the forces do not change: the matrix of a body is singular and no contact restrains it, or the load has reached its maximum on this branch (a limit point)"
    } else {
        "in one direction the forces do not change, although every body is held: the load has reached its maximum on this branch (a limit point), or contacts and supports are redundant"
    }
}

/// Where a penetrating node and its surface are both immovable.
fn over_constrained(stepper: &mut Stepper, state: &State, slave: usize) -> Option<String> {
    stepper.restore(state);
    let over = stepper.kinematics(slave)?;
    let model = stepper.model();
    let contact = model.contacts.get(slave)?;
    let [x, y] = model.place(&state.u, contact.node).map(sig4);
    let [n_x, n_y] = over.normal.map(sig4);
    Some(format!(
        "{} at ({x}, {y}), its gap {} along the normal ({n_x}, {n_y}); supports or prescribed motions fix it along that normal, and its surface is rigid",
        names::slave(model, slave),
        sig4(over.gap)
    ))
}

/// The body with the stiffest forces.
fn stiffest(model: &Model) -> Option<String> {
    let stiffness = |body: &Body| match &body.kind {
        BodyKind::Beam(beam) => Some(("EA", beam.ea)),
        BodyKind::Solid(solid) => {
            let largest = solid.materials.iter().map(|m| m.young).fold(0.0, f64::max);
            Some(("E", largest))
        }
        BodyKind::Truss(truss) => Some(("EA", truss.ea)),
        BodyKind::Linear(_) => None,
    };
    let all = model
        .bodies
        .iter()
        .filter_map(|body| Some((body, stiffness(body)?)));
    let (body, (word, value)) = all.max_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
    Some(format!(
        "body {} is the stiffest, {word} = {}: its forces are large numbers that cancel, with a round-off above {:.0e} of the loads",
        body.name,
        sig4(value),
        Norms::LOUDEST
    ))
}
