//! Tries remedies for an increment that does not converge, each from the same state, and measures them.
//!
//! [`super::remedy`] lists the remedies. A trial ends when the failed load is accepted, when it fails, or after
//! [`BUDGET`] minor iterations. Its steps are recorded, so that the chosen remedy can be repeated in a branch.

use super::advice::advice;
use super::examination::{Examination, frozen};
use super::remedy::{
    BLOCK, CONSISTENT_GEOMETRY, CONSISTENT_LIMIT, DAMP, LADDER, NEWTON, Remedy, RemedyInput,
    RemedyKind, STRESS_RESIDUAL, TOUCH_AT_START,
};
pub use super::restart::TrialEnd;
use super::restart::{self, FailedLoad};
use super::tested::Dimension;
use std::cmp::Ordering;
use std::ops::ControlFlow;
use stickslip_core::step::drive::drive;
use stickslip_core::{
    Capabilities, ContactRecord, Event, Failure, Forced, Intervention, JudgedLaw, Mode, Model,
    Norms, NotFound, Outcome, Solver, State, Status, Stepper, Until,
};
use stickslip_platform::clock::Instant;
use stickslip_scene::Spec;

/// Maximum number of minor iterations of a trial.
pub const BUDGET: u32 = 400;
/// Maximum number of degrees of freedom of a finer mesh that is tried.
const FINEST: usize = 50_000;
/// Maximum number of iterations of a trial on an attached solver, which may be slow.
const BUDGET_ATTACHED: u32 = 60;
/// A node keeps its mode if the inequality is violated by less than this, relatively.
pub const HYSTERESIS: f64 = 1e-3;
/// Relative violations below this are round-off.
pub const CLEAN: f64 = 1e-8;

/// Amounts below this are round-off and shown as zero.
const ROUND_OFF: f64 = 1e-14;

/// Remaining violations in the accepted state, relative to the scale of forces and the length of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RemainingViolations {
    /// Largest penetration, or largest gap with a force across it (length).
    pub penetration: f64,
    /// Largest tension of a node in contact (force).
    pub tension: f64,
    /// Largest |F_t| beyond the friction limit (force).
    pub shear: f64,
    /// Number of held nodes whose mode Table 2 would change.
    pub held: usize,
    /// Relative residual.
    pub residual: f64,
    /// The largest of the first three.
    pub worst: f64,
}

/// Result of a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct RemedyTrial {
    /// Name of the remedy in the list.
    pub label: String,
    /// What to type to apply it.
    pub how: RemedyInput,
    /// How it ended.
    pub end: TrialEnd,
    /// Number of minor iterations.
    pub minors: u32,
    /// Number of major iterations.
    pub majors: u32,
    /// Factorizations of the bodies: one per major iteration, or per minor iteration without condensation.
    pub factorizations: u32,
    /// Wall time of the solves.
    pub seconds: f64,
    /// Violations in the accepted state.
    pub left: Option<RemainingViolations>,
    /// Minor iterations (`None`) and interventions, in order.
    pub steps: Vec<Option<Intervention>>,
}

impl RemedyTrial {
    /// A trial that has not started.
    fn new(remedy: &Remedy) -> RemedyTrial {
        RemedyTrial {
            label: remedy.label.clone(),
            how: remedy.how.clone(),
            end: TrialEnd::Budget,
            minors: 0,
            majors: 0,
            factorizations: 0,
            seconds: 0.0,
            left: None,
            steps: Vec::new(),
        }
    }
}

/// All kinds of remedies, in the order in which they are tried.
const KINDS: [RemedyKind; 21] = [
    RemedyKind::Set("enter contact as sliding", "settings.strategy", "sliding"),
    RemedyKind::Set(
        "one change at a time, least index",
        "settings.strategy",
        "least",
    ),
    RemedyKind::Set(
        "enter as sliding, one change at a time",
        "settings.strategy",
        "sliding_least",
    ),
    BLOCK,
    NEWTON,
    RemedyKind::Set("Lemke's pivoting", "settings.strategy", "lemke"),
    LADDER,
    CONSISTENT_LIMIT,
    CONSISTENT_GEOMETRY,
    RemedyKind::Set("residual accumulate", "settings.residual", "accumulate"),
    STRESS_RESIDUAL,
    RemedyKind::Set("sticking increments", "settings.sticking", "increments"),
    RemedyKind::Set("sticking anchored", "settings.sticking", "anchored"),
    TOUCH_AT_START,
    DAMP,
    RemedyKind::Part(0.5),
    RemedyKind::Part(0.37),
    RemedyKind::Part(0.1),
    RemedyKind::Start(Mode::Fixed),
    RemedyKind::Start(Mode::Sliding),
    RemedyKind::Hysteresis,
];

/// All remedies that apply to a state: the consistent states, those for its failure, and all others. The search
/// for consistent states stops early if `stop` returns true.
pub fn all(
    stepper: &mut Stepper,
    state: &State,
    spec: Option<&Spec>,
    stop: &dyn Fn() -> bool,
) -> Vec<Remedy> {
    if state.status == Status::Finished {
        return Vec::new();
    }
    let found = frozen(stepper, state, stop);
    let model = stepper.model();
    let mut all = Remedy::answers(model, &found);
    let mut add = |remedy: Remedy| {
        if all.iter().all(|known: &Remedy| known.kind != remedy.kind) {
            all.push(remedy);
        }
    };
    for kind in KINDS {
        if let Some(remedy) = Remedy::from_kind(kind, model, state) {
            add(remedy);
        }
    }
    if let Status::Failed(failure) = &state.status {
        for remedy in advice(model, state, failure, spec) {
            if spec.is_some() || !matches!(remedy.how, RemedyInput::Restart(_)) {
                add(remedy);
            }
        }
    }
    all
}

/// Remedies that an attached solver supports: initial modes, parameters that tune it, and possibly another increment size.
pub fn offered(
    model: &Model,
    state: &State,
    offers: &Capabilities,
    found: &Examination,
) -> Vec<Remedy> {
    let parts = [RemedyKind::Part(0.5), RemedyKind::Part(0.1)];
    let parts = parts
        .into_iter()
        .filter_map(|kind| Remedy::from_kind(kind, model, state));
    let touching = [Mode::Fixed, Mode::Sliding]
        .into_iter()
        .filter_map(|mode| Remedy::touching(state, mode));
    let answers = Remedy::answers(model, found).into_iter();
    let tuned = offers.parameters.iter().flat_map(Remedy::tuned);
    answers
        .chain(touching)
        .chain(tuned)
        .chain(parts)
        .filter(|remedy| remedy.first.iter().all(|first| offers.check(first).is_ok()))
        .collect()
}

/// Tries a remedy that changes a scene, of this model, from its start; `None` if interrupted, if the scene cannot be built, or if
/// its mesh cannot be finer: it is not generated, becomes too large, or names single nodes.
fn attempt_restart(
    (model, spec): (&Model, &Spec),
    state: &State,
    (remedy, changes): (&Remedy, &[(String, String)]),
    stop: &dyn Fn() -> bool,
) -> Option<RemedyTrial> {
    let mut stepper = restart::changed(spec, state, changes)?;
    let dofs = stepper.model().dofs.len();
    let is_finer = dofs > state.u.len() && dofs <= FINEST;
    if remedy.kind == RemedyKind::Finer
        && !(is_finer && restart::is_refined(stepper.model(), model))
    {
        return None;
    }
    let target = FailedLoad::from_start(stepper.model(), state);
    let mut trial = run(&mut stepper, target, remedy, restart::BUDGET, stop)?;
    trial.factorizations = u32::try_from(stepper.work().factorizations).unwrap_or(u32::MAX);
    // A branch cannot repeat them.
    trial.steps.clear();
    Some(trial)
}

/// Tries a remedy; `None` if interrupted, or if an attached solver is lost. `spec` is the original scene, for
/// remedies that change it.
pub fn attempt(
    solver: &mut dyn Solver,
    state: &State,
    spec: Option<&Spec>,
    remedy: &Remedy,
    stop: &dyn Fn() -> bool,
) -> Option<RemedyTrial> {
    if let RemedyInput::Restart(changes) = &remedy.how {
        let model = solver.model().clone();
        return attempt_restart((&model, spec?), state, (remedy, changes), stop);
    }
    let is_own = solver.stepper().is_some();
    let budget = if is_own { BUDGET } else { BUDGET_ATTACHED };
    attempt_within(solver, state, remedy, budget, stop)
}

/// Tries a remedy from a state in at most this many minor iterations; `None` as in [`attempt`].
pub fn attempt_within(
    solver: &mut dyn Solver,
    state: &State,
    remedy: &Remedy,
    budget: u32,
    stop: &dyn Fn() -> bool,
) -> Option<RemedyTrial> {
    solver.restore(state).ok()?;
    run(solver, FailedLoad::new(state), remedy, budget, stop)
}

/// Applies a remedy, and runs to the load; `None` as in [`attempt`].
pub(super) fn run(
    solver: &mut dyn Solver,
    target: FailedLoad,
    remedy: &Remedy,
    budget: u32,
    stop: &dyn Fn() -> bool,
) -> Option<RemedyTrial> {
    let restarts = matches!(remedy.how, RemedyInput::Restart(_));
    let mut trial = RemedyTrial::new(remedy);
    let change = |solver: &mut dyn Solver, trial: &mut RemedyTrial, what: Intervention| {
        // Impossible interventions are skipped: a node past its surface cannot touch.
        if solver.intervene(&what).is_ok() {
            trial.steps.push(Some(what));
        }
    };
    for first in &remedy.first {
        change(solver, &mut trial, first.clone());
    }
    let is_own = solver.stepper().is_some();
    let until = Until::end().minors(budget.into()).interrupted_by(stop);
    let mut began = Instant::now();
    let end = drive(solver, until, |solver| {
        trial.seconds += began.elapsed().as_secs_f64();
        trial.minors += 1;
        trial.steps.push(None);
        let event = solver.event();
        let ends = event.outcome.ends_major();
        trial.majors += u32::from(ends);
        let is_accepted = event.outcome.is_accepted();
        let is_there = is_accepted && target.is_passed(solver.state());
        let mut changes = Vec::new();
        if let Some(stepper) = solver.stepper() {
            let event = stepper.event();
            trial.factorizations += u32::from(ends || !stepper.condenses());
            match &event.outcome {
                Outcome::Increment { after, marked, .. }
                    if is_there || marked.is_some() && !restarts =>
                {
                    trial.left = Some(left(stepper, event, after));
                    let against = marked.as_ref().map(|found| TrialEnd::Against(found.law));
                    return ControlFlow::Break(against.unwrap_or(TrialEnd::Converged));
                }
                Outcome::Minor if remedy.kind == RemedyKind::Hysteresis => {
                    changes = hysteresis(stepper, event);
                }
                _ => {}
            }
        } else if is_there {
            return ControlFlow::Break(TrialEnd::Converged);
        }
        for what in changes {
            change(solver, &mut trial, what);
        }
        began = Instant::now();
        ControlFlow::Continue(())
    });
    trial.end = TrialEnd::from_run(end.ok()?)?;
    // Count the last major iteration, even if the trial ended within it.
    if is_own && trial.end == TrialEnd::Budget {
        trial.factorizations += 1;
    }
    Some(trial)
}

/// The holds and releases of hysteresis after a minor iteration that did not settle.
fn hysteresis(stepper: &Stepper, event: &Event) -> Vec<Intervention> {
    let near = |record: &ContactRecord| {
        let margins = record.decision.tests.iter().flatten();
        let (force, length) = (event.before.scale, stepper.model().length);
        let size = |tested| Dimension::from(tested).scale(force, length);
        margins
            .filter(|test| test.margin < 0.0)
            .all(|test| -test.margin < HYSTERESIS * size(test.tested))
    };
    let records = || event.nodes.iter().enumerate();
    let hold = records()
        .filter(|(_, record)| record.decision.changes() && near(record))
        .map(|(slave, record)| Intervention::Force {
            slave,
            mode: record.decision.before,
            hold: true,
        });
    let release = records()
        .filter(|(_, record)| {
            matches!(record.forced, Forced::Held(_))
                && record.decision.wanted != record.decision.next
                && !near(record)
        })
        .map(|(slave, _)| Intervention::Release { slave });
    hold.chain(release).collect()
}

/// The judge's findings in the last accepted state.
fn left(stepper: &Stepper, event: &Event, after: &Norms) -> RemainingViolations {
    let verdict = stepper.state().start.verdict.as_ref();
    let amount = |law: JudgedLaw| {
        let found = verdict.and_then(|verdict| verdict.of(law));
        let amount = found.map_or(0.0, |found| found.amount);
        if amount < ROUND_OFF { 0.0 } else { amount }
    };
    let gap = amount(JudgedLaw::Gap)
        .max(amount(JudgedLaw::Penalty))
        .max(amount(JudgedLaw::Tied));
    let inside = amount(JudgedLaw::Penetration).max(gap);
    let (tension, shear) = (amount(JudgedLaw::Tension), amount(JudgedLaw::Cone));
    let decisions = event.nodes.iter().map(|record| &record.decision);
    RemainingViolations {
        penetration: inside * stepper.model().length,
        tension: tension * after.scale,
        shear: shear * after.scale,
        held: decisions.filter(|d| d.wanted != d.next).count(),
        residual: after.relative,
        worst: inside.max(tension).max(shear),
    }
}

/// Order of a trial: 0 if it converged without violations, 1 with some, 2 if it did not converge.
pub fn rank(trial: &RemedyTrial) -> u8 {
    match (&trial.end, &trial.left) {
        (TrialEnd::Converged, Some(left)) if left.worst > CLEAN || left.held > 0 => 1,
        (TrialEnd::Converged, _) => 0,
        (TrialEnd::Against(_), _) => 1,
        _ => 2,
    }
}

/// Order of two trials, best first: those that converged without violations, then those with violations, by size, then the
/// others. Of those that converged, a change of the scene comes first, because only it removes a cause in the scene; then
/// what lasts over later increments; then another mesh or curve, with which the load is passed, but later ones may fail as before; then
/// by cost.
pub fn compare(a: &RemedyTrial, b: &RemedyTrial) -> Ordering {
    let worst = |trial: &RemedyTrial| trial.left.map_or(0.0, |left| left.worst);
    let by_size = match (rank(a), rank(b)) {
        (1, 1) => worst(a).total_cmp(&worst(b)),
        _ => Ordering::Equal,
    };
    let lasts = |trial: &RemedyTrial| match (rank(trial), &trial.how) {
        (2, _) => 0,
        (_, RemedyInput::Restart(changes)) => {
            let is_other =
                |(path, _): &(String, String)| path == "refine" || path.ends_with(".smooth");
            if changes.iter().any(is_other) { 2 } else { 0 }
        }
        (
            _,
            RemedyInput::Set(..)
            | RemedyInput::Parameter(..)
            | RemedyInput::Increment(_)
            | RemedyInput::IncrementOn(..),
        ) => 1,
        (_, RemedyInput::StartFrom(_) | RemedyInput::Listed) => 3,
    };
    (rank(a).cmp(&rank(b)))
        .then(by_size)
        .then(lasts(a).cmp(&lasts(b)))
        .then(a.factorizations.cmp(&b.factorizations))
        .then(a.minors.cmp(&b.minors))
}

/// Sorts trials, best first.
pub fn sort(trials: &mut [RemedyTrial]) {
    trials.sort_by(compare);
}

/// The end of a trial, in a word or two.
pub fn end_words(end: &TrialEnd) -> String {
    let failure = match end {
        TrialEnd::Converged => return "converged".into(),
        TrialEnd::Against(law) => return format!("violates {}", law.name()),
        TrialEnd::Budget => return format!("{BUDGET} minor"),
        TrialEnd::Failed(failure) => failure,
    };
    let words = match failure {
        Failure::Cycle(cycle) => return format!("{}-cycle", cycle.period),
        Failure::MinorLimit { .. } => "minor limit",
        Failure::MajorLimit { .. } => "major limit",
        Failure::MajorCycle(_) => "majors cycle",
        Failure::Singular(_) => "singular",
        Failure::Diverged { .. } => "diverged",
        Failure::OverConstrained { .. } => "jammed",
        Failure::Refused(_) => "refused",
        Failure::Inverted(_) => "inverted",
        Failure::CutTooOften { .. } => "cut too often",
        Failure::NoRest { .. } => "no rest",
        Failure::BranchJump { .. } => "jumps",
        Failure::PathReversal => "doubles back",
        Failure::ZeroMeasure => "does not move",
        Failure::RoundOff { .. } => "round-off",
        Failure::Reported { .. } => "failed",
        Failure::NoAnswer { .. } => "no answer",
        Failure::NotFound(NotFound::Ray) => "ray",
        Failure::LadderEnded { .. } | Failure::NotFound(_) => "none found",
    };
    words.into()
}

/// Headings of the table; the columns of [`row`].
pub const COLUMNS: [&str; 10] = [
    "end", "minors", "majors", "factors", "ms", "penetr.", "tension", "shear", "residual", "held",
];

/// A trial as a row of the table, in the order of [`COLUMNS`].
pub fn row(trial: &RemedyTrial) -> [String; 10] {
    let tiny = |value: f64| match value {
        value if value <= 0.0 => "0".into(),
        value => format!("{value:.0e}"),
    };
    let number = |of: fn(&RemainingViolations) -> f64| {
        trial
            .left
            .as_ref()
            .map_or("-".into(), |left| tiny(of(left)))
    };
    [
        end_words(&trial.end),
        trial.minors.to_string(),
        trial.majors.to_string(),
        trial.factorizations.to_string(),
        format!("{:.1}", trial.seconds * 1e3),
        number(|left| left.penetration),
        number(|left| left.tension),
        number(|left| left.shear),
        number(|left| left.residual),
        trial.left.map_or("-".into(), |left| left.held.to_string()),
    ]
}
