//! The diagnosis page: what happened, where, why, what was tried, and what to do, most useful first.
//!
//! For a failed state it explains the failure; for other states it shows the consistent states of the frozen
//! problem that is solved next. Slow parts (trials of remedies, the load that smaller steps reach) come last,
//! so that the page grows while it is read.

use super::advice::{Advice, FINER, advice};
use super::attempt::Attempt;
use super::diagnosis::undecided;
use super::examination::{DONE, Examination, NOT_CONDENSED, frozen};
use super::finer::{Finer, finer};
use super::indefinite::{self, indefinite};
use super::judged;
use super::jumped::leads_away;
use super::limit_load::limit_load;
use super::loose::loose;
use super::majors;
use super::names;
use super::reach::reach;
use super::remedies::{self, Trial, TrialEnd, attempt};
use super::remedy::{How, Remedy, RemedyKind};
use super::report::{describe_failure, sound};
use super::strain::MaterialCause;
use stickslip_core::linear::norms::Norms;
use stickslip_core::linear::singular::Singular;
use stickslip_core::model::{Body, BodyKind, InitialGaps, Model};
use stickslip_core::step::event::Failure;
use stickslip_core::step::state::{State, Status};
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::format::spec::Spec;
use stickslip_scene::number::{four, plain};

/// Shown if the first increment fails and nodes start inside their surface.
const OVERLAP: &str = "where: nodes start inside their surface; settings.initial_gaps=ramp moves them out over the first leg of the path, adjust moves them onto the surface";
/// Maximum number of remedies tried for the page; the list of remedies tries all.
const MOST_TRIED: usize = 6;

/// Makes the page of a state. `spec` is the scene as written by its author, from which a finer mesh is
/// generated; calls `tell` as the page grows. `None` if interrupted.
pub fn page(
    stepper: &mut Stepper,
    state: &State,
    spec: Option<&Spec>,
    stop: &dyn Fn() -> bool,
    tell: &mut dyn FnMut(&Examination),
) -> Option<Examination> {
    let Status::Failed(failure) = &state.status else {
        return Some(match state.status {
            Status::Finished => Examination {
                lines: vec![DONE.into()],
                ..Examination::default()
            },
            _ => {
                let found = frozen(stepper, state, stop);
                if stop() {
                    tell(&found);
                    return None;
                }
                found
            }
        });
    };
    let mut page = PageBuilder::of(stepper, state, failure, stop);
    tell(&page.shown("trying remedies …"));
    let remedies = page.remedies(stepper.model(), state, failure);
    for remedy in &remedies {
        tell(&page.shown(&format!("trying {} …", remedy.label)));
        match attempt(stepper, state, spec, remedy, stop) {
            Some(trial) => page.trials.push((remedy.clone(), trial)),
            // The scene cannot be changed this way, so there is no trial.
            None if matches!(remedy.how, How::Restart(_)) && !stop() => {}
            None => return None,
        }
    }
    if page.refines
        && let Some(spec) = spec
    {
        tell(&page.shown("trying a finer mesh …"));
        page.finer = finer(spec, state, stop);
        if stop() {
            return None;
        }
    }
    page.facts.extend(limit_load(stepper, state, failure, stop));
    if page.asks_how_far(failure) {
        tell(&page.shown("checking how far smaller steps reach …"));
        let reached = reach(stepper, state, stop)?;
        let far = format!("how far: {}", reached.words(stepper.model(), failure));
        page.facts.push(far);
    }
    Some(page.shown(""))
}

/// The part of a failure's page that needs no trials, as printed by `run`.
pub fn facts(
    stepper: &mut Stepper,
    state: &State,
    failure: &Failure,
    stop: &dyn Fn() -> bool,
) -> Vec<String> {
    let page = PageBuilder::of(stepper, state, failure, stop);
    let mut lines = page.facts;
    lines.extend(page.found.lines);
    lines.extend(limit_load(stepper, state, failure, stop));
    lines
}

/// The page in progress.
struct PageBuilder {
    what: Vec<String>,
    /// Where and why.
    facts: Vec<String>,
    /// Remedies in the scene's file or by hand.
    by_hand: Vec<&'static str>,
    /// Trials of remedies.
    trials: Vec<(Remedy, Trial)>,
    /// Whether a finer mesh can help.
    refines: bool,
    finer: Option<Finer>,
    /// The examination of the frozen problem.
    found: Examination,
}

impl PageBuilder {
    fn of(
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
    ) -> PageBuilder {
        let mut page = PageBuilder {
            what: Vec::new(),
            facts: Vec::new(),
            by_hand: Vec::new(),
            trials: Vec::new(),
            refines: false,
            finer: None,
            found: Examination::default(),
        };
        let cause = MaterialCause::find(stepper.model(), state, failure);
        let certain = cause.filter(MaterialCause::is_certain);
        let words = |cause: MaterialCause| cause.words(stepper.model());
        let overlap =
            Remedy::from_kind(RemedyKind::Gaps(InitialGaps::Ramp), stepper.model(), state);
        page.facts.extend(overlap.map(|_| OVERLAP.to_owned()));
        page.facts.extend(certain.map(words));
        let possible = cause.filter(|cause| !cause.is_certain()).map(words);
        page.explain(stepper, state, failure, stop);
        page.facts.extend(possible);
        let model = stepper.model();
        for piece in advice(model, state, failure) {
            match piece {
                Advice::ByHand(text) => page.by_hand.push(text),
                Advice::Finer => page.refines = true,
                Advice::Remedy(_) => {}
            }
        }
        page.what.push(format!(
            "what: increment {} to load {}: {}",
            state.next.increment,
            plain(state.load_factor),
            match failure {
                // The members are described one by one below.
                Failure::MajorCycle(round) => format!(
                    "major iterations cycle with period {} from major {}; {} nodes take part",
                    round.period,
                    round.start,
                    round.members.len()
                ),
                _ => describe_failure(model, failure),
            }
        ));
        page.what.push(format!("{}.", sound(state.next, state)));
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
                self.facts.extend(rigid.lines);
                self.found.arrows = rigid.arrows;
            }
            Failure::MajorCycle(round) => {
                self.found.nodes = round.members.iter().map(|member| member.0).collect();
                self.repeat(stepper, state, failure, stop, |model, attempt| {
                    majors::cycle_words(model, attempt, round)
                });
            }
            Failure::MajorLimit { .. } => {
                self.repeat(stepper, state, failure, stop, |_, attempt| {
                    majors::limit_words(&state.controls.settings, attempt)
                });
            }
            Failure::Diverged { .. } => {
                self.repeat(stepper, state, failure, stop, |model, attempt| {
                    majors::flight_words(model, state, attempt)
                });
            }
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
                self.facts.push(format!(
                    "where: {}",
                    judged::place(model, &model.places(&state.u), found)
                ));
                self.facts.push(format!(
                    "why: the iterations have converged, but the state violates a law: {} is {:.1e}, limit {:.1e}",
                    found.law.name(), found.amount, found.allowed
                ));
            }
            Failure::CutTooOften { slave, last, .. } => {
                self.found.nodes.push(*slave);
                self.explain(stepper, state, last, stop);
            }
            Failure::OverConstrained { slave, .. } => {
                self.found.nodes.push(*slave);
                self.facts.extend(over_constrained(stepper, state, *slave));
            }
            Failure::Singular(Singular::Unexplained) => {
                self.facts.push(unexplained(stepper.model()).into());
            }
            Failure::Leapt {
                unstable: Some(stability),
                ..
            } => self.facts.push(format!(
                "why: {}, even with the smallest increment: no stable equilibrium is near",
                leads_away(*stability)
            )),
            Failure::Leapt {
                motion, predicted, ..
            } => {
                self.facts.push(format!(
                    "why: the motion is {:.1} times what the tangent and the previous increments predict, even with the smallest increment: load control skips the part of the path between the two states",
                    motion / predicted.max(f64::MIN_POSITIVE)
                ));
            }
            Failure::DoubledBack => self.facts.push(
                "why: displacements and load turn back along the last increment: the path turns by more than a right angle here, or ends".into(),
            ),
            Failure::Unmoved => self.facts.push(
                "why: the tangent at the start of the increment does not change what history.arc measures".into(),
            ),
            Failure::Restless { .. } => self.facts.push(
                "why: beyond the last equilibrium load nothing stops the motion".into(),
            ),
            Failure::RoundOff { .. } => self.facts.extend(stiffest(stepper.model())),
            // The element comes first.
            Failure::Inverted(_) => {}
        }
    }

    /// Repeats the failed attempt, and adds facts about it.
    fn repeat<F: IntoIterator<Item = String>>(
        &mut self,
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
        facts: impl FnOnce(&Model, &Attempt) -> F,
    ) {
        match Attempt::again(stepper, state, failure, stop) {
            Some(attempt) => self.facts.extend(facts(stepper.model(), &attempt)),
            None => self.not_again(),
        }
    }

    fn not_again(&mut self) {
        self.facts.push("repeated from its start, the attempt ends differently: something was changed by hand during it".into());
    }

    /// The first strategy's failure in this major iteration, before the ladder continued.
    fn explain_first(&mut self, model: &Model, first: &Failure) {
        let members: &[(usize, Vec<stickslip_core::model::Mode>)] = match first {
            Failure::Cycle(cycle) => &cycle.members,
            _ => &[],
        };
        self.found
            .nodes
            .extend(members.iter().map(|member| member.0));
        self.facts.push(format!(
            "where: the first strategy failed: {}",
            describe_failure(model, first)
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
        if let Some(problem) = stepper.interface_problem()
            && let Some(problem) = problem.reduced(&undecided(&problem))
            && let Some(text) = indefinite(&problem, stop)
        {
            let name = |place: usize| names::slave(stepper.model(), problem.nodes[place].slave);
            self.facts.extend(indefinite::words(&text, &name));
        }
        if self.found.lines == [NOT_CONDENSED] {
            self.facts.append(&mut self.found.lines);
        }
    }

    /// The remedies tried for the page: the consistent states, and those for this kind of failure.
    fn remedies(&self, model: &Model, state: &State, failure: &Failure) -> Vec<Remedy> {
        let mut all = Remedy::answers(model, &self.found);
        all.truncate(2);
        if let Some((law, true)) = Remedy::law(model, state, failure) {
            all.insert(0, law);
        }
        all.extend(
            advice(model, state, failure)
                .into_iter()
                .filter_map(|piece| match piece {
                    Advice::Remedy(remedy) if remedy.kind != RemedyKind::Law => Some(remedy),
                    Advice::Remedy(_) | Advice::ByHand(_) | Advice::Finer => None,
                }),
        );
        all.truncate(MOST_TRIED);
        all
    }

    /// Whether to check how far smaller steps reach: not if a trial has reached the load.
    fn asks_how_far(&self, failure: &Failure) -> bool {
        let helped = self.trials.iter().any(|(_, trial)| helps(trial));
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
    fn shown(&self, going_on: &str) -> Examination {
        let mut lines = self.what.clone();
        let mut details = Vec::new();
        // Where and why come before what to do, everything else after it.
        for fact in &self.facts {
            match HEADS.iter().any(|head| fact.starts_with(head)) {
                true => lines.push(fact.clone()),
                false => details.push(fact.clone()),
            }
        }
        // The cause in the frozen problem also comes first.
        let all = &self.found.lines;
        let explains = |line: &&String| HEADS.iter().any(|head| line.starts_with(head));
        let first = match all.iter().any(|line| explains(&line)) {
            true => all.iter().filter(explains).collect(),
            false => all.iter().take(1).collect::<Vec<_>>(),
        };
        lines.extend(first.iter().map(|line| (*line).clone()));
        lines.extend(self.to_do());
        lines.extend(details);
        let rest = all.iter().filter(|line| !first.contains(line));
        lines.extend(rest.cloned());
        Examination {
            lines,
            fails: true,
            going_on: going_on.to_owned(),
            ..self.found.clone()
        }
    }

    /// Remedies, best first: those that helped, those that did not, and those not tried.
    fn to_do(&self) -> Vec<String> {
        let mut trials: Vec<&(Remedy, Trial)> = self
            .trials
            .iter()
            .filter(|(_, trial)| helps(trial))
            .collect();
        // A remedy that lasts over later increments is better than one for this increment only.
        trials.sort_by_key(|(remedy, trial)| {
            let lasts = matches!(
                remedy.how,
                How::Set(..) | How::Increment(_) | How::IncrementOn(..)
            );
            // A cause in the scene can be removed only by changing the scene.
            let scene = matches!(remedy.how, How::Restart(_));
            (!scene, !lasts, trial.factorizations, trial.minors)
        });
        let helped = trials.iter().map(|(remedy, trial)| {
            let minors = match trial.minors {
                1 => "1 minor iteration".to_owned(),
                n => format!("{n} minor iterations"),
            };
            let from = match remedy.how {
                How::Restart(_) => "tried from the start: passes this load",
                _ => "tried: converges",
            };
            format!(
                "{}: {} ({from}, {minors})",
                remedy.label,
                remedy.how.typed()
            )
        });
        let finer = self.finer.iter();
        let finer = finer.filter(|finer| finer.run.failure.is_none());
        let finer = finer.map(|finer| {
            format!(
                "a finer mesh: --set refine={} (tried from the start: passes this load, {} minor iterations)",
                finer.refine, finer.run.minors
            )
        });
        let mut lines: Vec<String> = helped
            .chain(finer)
            .enumerate()
            .map(|(k, text)| format!("do: {}. {text}", k + 1))
            .collect();
        let mut vain: Vec<String> = self
            .trials
            .iter()
            .filter(|(_, trial)| !helps(trial))
            .map(|(remedy, trial)| {
                format!("{} ({})", remedy.label, remedies::end_words(&trial.end))
            })
            .collect();
        vain.extend(self.finer.iter().filter_map(|finer| {
            let end = match finer.run.failure.as_ref()? {
                Some(failure) => remedies::end_words(&TrialEnd::Failed(failure.clone())),
                None => format!("{} minor", finer.run.minors),
            };
            Some(format!("a finer mesh, refine={} ({end})", finer.refine))
        }));
        if !vain.is_empty() {
            lines.push(format!("did not help: {}", vain.join(", ")));
        }
        let finer = (self.refines && self.finer.is_none()).then_some(FINER);
        let untried: Vec<&str> = finer
            .into_iter()
            .chain(self.by_hand.iter().copied())
            .collect();
        if !untried.is_empty() {
            lines.push(format!("not tried: {}", untried.join("; ")));
        }
        lines
    }
}

/// Why equations may be singular although no body has a free rigid motion.
fn unexplained(model: &Model) -> &'static str {
    let given = |body: &Body| matches!(body.kind, BodyKind::Linear(_));
    match model.bodies.iter().any(given) {
        true => {
            "why: in one direction the forces do not change: the matrix of a body is singular and no contact restrains it, or the load has reached its maximum on this branch (a limit point)"
        }
        false => {
            "why: in one direction the forces do not change, although every body is held: the load has reached its maximum on this branch (a limit point), or contacts and supports are redundant"
        }
    }
}

/// Where a penetrating node and its surface are both immovable.
fn over_constrained(stepper: &mut Stepper, state: &State, slave: usize) -> Option<String> {
    stepper.restore(state);
    let over = stepper.kinematics(slave)?;
    let model = stepper.model();
    let contact = model.contacts.get(slave)?;
    let [x, y] = model.place(&state.u, contact.node).map(four);
    let [n_x, n_y] = over.normal.map(four);
    Some(format!(
        "where: {} at ({x}, {y}), its gap {} along the normal ({n_x}, {n_y}); supports or prescribed motions fix it along that normal, and its surface is rigid",
        names::slave(model, slave),
        four(over.gap)
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
        "why: body {} is the stiffest, {word} = {}: its forces are large numbers that cancel, with a round-off above {:.0e} of the loads",
        body.name,
        four(value),
        Norms::LOUDEST
    ))
}

/// First words of the lines that come before what to do.
const HEADS: [&str; 5] = ["where:", "why:", "what would", "since when:", "how far:"];

/// Whether a trial reached the load without violations.
fn helps(trial: &Trial) -> bool {
    trial.end == TrialEnd::Converged && trial.left.is_none_or(|left| left.held == 0)
}
