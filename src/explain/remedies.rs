//! Remedies for an increment that does not converge: each is tried from the same state, and measured.
//!
//! A remedy is what is done before the first minor iteration (a consistent state of the census, a strategy or another
//! setting, a smaller increment), and perhaps hysteresis, which corrects the verdict after each. A trial ends where the
//! load that failed is accepted, where it fails, or after [`BUDGET`] minor iterations. What it did is kept as steps, so
//! that the chosen one can be done again in a branch.

use super::examination::examine;
use crate::contact::laws::Law;
use crate::contact::record::{ContactRecord, Forced};
use crate::explain::names;
use crate::interface::method::NotFound;
use crate::linear::norms::Norms;
use crate::model::Settings;
use crate::model::{AtCycle, BoundUpdate, ResidualMethod, Sticking, Strategy};
use crate::step::drive::{RunEnd, Until};
use crate::step::event::{Event, Failure, Outcome};
use crate::step::intervene::Intervention;
use crate::step::state::{State, Status};
use crate::step::stepper::Stepper;
use std::cmp::Ordering;
use std::ops::ControlFlow;
use std::time::Instant;

/// Most minor iterations of a trial.
pub const BUDGET: u32 = 400;
/// A node keeps its mode while the inequality is violated by less than this, relatively.
pub const HYSTERESIS: f64 = 1e-3;
/// Violations below this, relatively, are round-off.
pub const CLEAN: f64 = 1e-8;

/// Something to try.
#[derive(Debug, Clone, PartialEq)]
pub struct Remedy {
    /// In a few words; the name of its branch.
    pub label: String,
    first: Vec<Intervention>,
    /// Whether a node that misses its condition by less than [`HYSTERESIS`] is held.
    hysteresis: bool,
}

/// How a trial ended.
#[derive(Debug, Clone, PartialEq)]
pub enum TrialEnd {
    /// The load that failed was accepted.
    Converged,
    /// A state was accepted, as held modes or the settings want it, that the judge found against this law.
    Against(Law),
    /// It failed.
    Failed(Failure),
    /// The budget is used up.
    Budget,
}

/// Amounts below this are round-off, and none.
const ROUND_OFF: f64 = 1e-14;

/// What is left of violations in the accepted state, over the scale of forces and the length of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Left {
    /// Deepest penetration, or largest distance over which a force acts (length).
    pub penetration: f64,
    /// Largest tension of a touching node (force).
    pub tension: f64,
    /// Largest |F_t| beyond what friction can give (force).
    pub shear: f64,
    /// Nodes whose mode Table 2 would change, were they not held.
    pub held: usize,
    /// Relative residual.
    pub residual: f64,
    /// The largest of the first three, relatively.
    pub worst: f64,
}

/// What a remedy did.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// What was tried, as the list calls it.
    pub label: String,
    /// How it ended.
    pub end: TrialEnd,
    /// Minor iterations that it took.
    pub minors: u32,
    /// Major iterations that it took.
    pub majors: u32,
    /// Factorizations of the bodies: one a major iteration, or one a minor where the system is not condensed.
    pub factorizations: u32,
    /// Wall time of the solves.
    pub seconds: f64,
    /// Violations in the state that was accepted.
    pub left: Option<Left>,
    /// Minor iterations (none) and interventions, in order.
    pub steps: Vec<Option<Intervention>>,
}

impl Remedy {
    fn new(label: &str, first: Vec<Intervention>) -> Self {
        Remedy {
            label: label.to_owned(),
            first,
            hysteresis: false,
        }
    }
}

/// All that there is to try from a state.
pub fn all(stepper: &mut Stepper, state: &State) -> Vec<Remedy> {
    if state.status == Status::Finished {
        return Vec::new();
    }
    let mut all = answers(stepper, state);
    let mut set = |label: &str, change: &dyn Fn(&mut Settings)| {
        let mut settings = state.controls.settings;
        change(&mut settings);
        if settings != state.controls.settings {
            let first = vec![Intervention::Settings(settings)];
            all.push(Remedy::new(label, first));
        }
    };
    for (label, strategy) in [
        ("enter contact as sliding", Strategy::Sliding),
        ("one change at a time, least index", Strategy::Least),
        (
            "enter as sliding, one change at a time",
            Strategy::SlidingLeast,
        ),
        ("block changes, least-index fallback", Strategy::Block),
        ("semismooth Newton", Strategy::Newton),
        ("Lemke's pivoting", Strategy::Lemke),
        ("the ladder of strategies", Strategy::Ladder),
    ] {
        set(label, &|s| s.strategy = strategy);
    }
    set("t_max consistent", &|s| s.t_max = BoundUpdate::Consistent);
    let (residual, label) = match state.controls.settings.residual {
        ResidualMethod::Stress => (ResidualMethod::Accumulate, "residual accumulate"),
        ResidualMethod::Accumulate => (ResidualMethod::Stress, "residual stress"),
    };
    set(label, &|s| s.residual = residual);
    let (sticking, label) = match state.controls.settings.sticking {
        Sticking::Anchored => (Sticking::Increments, "sticking increments"),
        Sticking::Increments => (Sticking::Anchored, "sticking anchored"),
    };
    set(label, &|s| s.sticking = sticking);
    set("at_cycle damp", &|s| s.at_cycle = AtCycle::Damp);
    for (label, part) in [
        ("half the increment", 2.0),
        ("a tenth of the increment", 10.0),
    ] {
        let first = vec![Intervention::Increment(state.controls.increment / part)];
        all.push(Remedy::new(label, first));
    }
    all.push(Remedy {
        hysteresis: true,
        ..Remedy::new("hysteresis of 1e-3", Vec::new())
    });
    all
}

/// The consistent states of the frozen problem that is solved next.
fn answers(stepper: &mut Stepper, state: &State) -> Vec<Remedy> {
    let finding = examine(stepper, state);
    let count = finding.census.as_ref().map_or(0, |c| c.answers.len());
    let model = stepper.model();
    let answer = |number: usize| {
        let starts = finding.starts(number)?;
        const SHOWN: usize = 2;
        let name = |s: &crate::step::intervene::Start| {
            format!("{} {}", names::slave(model, s.slave), names::mode(s.mode))
        };
        let some: Vec<String> = starts.iter().take(SHOWN).map(name).collect();
        let more = if starts.len() > SHOWN { ", …" } else { "" };
        let label = format!("answer {}: {}{more}", number + 1, some.join(", "));
        Some(Remedy::new(&label, vec![Intervention::Assume(starts)]))
    };
    (0..count).filter_map(answer).collect()
}

/// Tries a remedy; `None` if it was stopped.
pub fn attempt(
    stepper: &mut Stepper,
    state: &State,
    remedy: &Remedy,
    stop: &dyn Fn() -> bool,
) -> Option<Trial> {
    stepper.restore(state);
    let target = (state.start.leg, state.load_factor);
    let mut trial = Trial {
        label: remedy.label.clone(),
        end: TrialEnd::Budget,
        minors: 0,
        majors: 0,
        factorizations: 0,
        seconds: 0.0,
        left: None,
        steps: Vec::new(),
    };
    let change = |stepper: &mut Stepper, trial: &mut Trial, what: Intervention| {
        // What cannot be done is not a part of the trial: a node past its surface cannot touch.
        if stepper.intervene(&what).is_ok() {
            trial.steps.push(Some(what));
        }
    };
    for first in &remedy.first {
        change(stepper, &mut trial, first.clone());
    }
    let until = Until::end().minors(BUDGET.into()).interrupted_by(stop);
    let mut began = Instant::now();
    let end = stepper.drive(until, |stepper| {
        trial.seconds += began.elapsed().as_secs_f64();
        trial.minors += 1;
        trial.steps.push(None);
        let event = stepper.event();
        let ends = event.outcome.ends_major();
        trial.majors += u32::from(ends);
        trial.factorizations += u32::from(ends || !stepper.condenses());
        match &event.outcome {
            Outcome::Increment {
                after,
                marked: Some(found),
                ..
            } => {
                trial.left = Some(left(stepper, event, after));
                return ControlFlow::Break(TrialEnd::Against(found.law));
            }
            Outcome::Increment { after, .. } if is_there(stepper.state(), event, target) => {
                trial.left = Some(left(stepper, event, after));
                return ControlFlow::Break(TrialEnd::Converged);
            }
            Outcome::Minor if remedy.hysteresis => {
                for what in hysteresis(stepper, event) {
                    change(stepper, &mut trial, what);
                }
            }
            _ => {}
        }
        began = Instant::now();
        ControlFlow::Continue(())
    });
    trial.end = match end {
        RunEnd::Interrupted => return None,
        RunEnd::Stopped(end) => end,
        RunEnd::Failed(failure) => TrialEnd::Failed(failure),
        RunEnd::Finished => TrialEnd::Converged,
        RunEnd::Spent => TrialEnd::Budget,
    };
    // The last major iteration, where the trial ended within it.
    if trial.end == TrialEnd::Budget {
        trial.factorizations += 1;
    }
    Some(trial)
}

/// Whether the accepted increment has come to the load that failed.
fn is_there(state: &State, event: &Event, (leg, load): (usize, f64)) -> bool {
    let close = (event.load_factor - load).abs() <= 1e-9 * state.controls.increment;
    state.status == Status::Finished || state.start.leg > leg || close
}

/// What is held, and released, after a minor iteration that did not settle.
fn hysteresis(stepper: &Stepper, event: &Event) -> Vec<Intervention> {
    let near = |record: &ContactRecord| {
        let margins = record.decision.tests.iter().flatten();
        let size = |tested| scale_of(tested, stepper, event);
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
    let held = records().filter(|(_, record)| {
        matches!(record.forced, Forced::Held(_))
            && record.decision.wanted != record.decision.next
            && !near(record)
    });
    let release = held.map(|(slave, _)| Intervention::Release { slave });
    hold.chain(release).collect()
}

/// The scale of what is tested: a force or a length.
fn scale_of(tested: crate::contact::table2::Tested, stepper: &Stepper, event: &Event) -> f64 {
    use crate::contact::table2::Tested;
    match tested {
        Tested::NormalForce | Tested::ShearForce | Tested::Pressure | Tested::Drag => {
            event.before.scale
        }
        Tested::Slip | Tested::Gap => stepper.model().length,
        Tested::Cover => 1.0,
    }
}

/// What the judge found of the state that was accepted last.
fn left(stepper: &Stepper, event: &Event, after: &Norms) -> Left {
    let verdict = stepper.state().start.verdict.as_ref();
    let amount = |law: Law| {
        let found = verdict.and_then(|verdict| verdict.worst[law as usize]);
        let amount = found.map_or(0.0, |found| found.amount);
        if amount < ROUND_OFF { 0.0 } else { amount }
    };
    let inside = amount(Law::Penetration).max(amount(Law::Gap));
    let (tension, shear) = (amount(Law::Tension), amount(Law::Cone));
    let decisions = event.nodes.iter().map(|record| &record.decision);
    Left {
        penetration: inside * stepper.model().length,
        tension: tension * after.scale,
        shear: shear * after.scale,
        held: decisions.filter(|d| d.wanted != d.next).count(),
        residual: after.relative,
        worst: inside.max(tension).max(shear),
    }
}

/// Best first: those that converged and leave no violation, by cost; those that leave one, by its size; then the others.
pub fn sort(trials: &mut [Trial]) {
    let class = |trial: &Trial| match (&trial.end, &trial.left) {
        (TrialEnd::Converged, Some(left)) if left.worst > CLEAN || left.held > 0 => 1,
        (TrialEnd::Converged, _) => 0,
        (TrialEnd::Against(_), _) => 1,
        _ => 2,
    };
    let worst = |trial: &Trial| trial.left.map_or(0.0, |left| left.worst);
    trials.sort_by(|a, b| {
        let by_size = match class(a) {
            1 => worst(a).total_cmp(&worst(b)),
            _ => Ordering::Equal,
        };
        (class(a).cmp(&class(b)))
            .then(by_size)
            .then(a.factorizations.cmp(&b.factorizations))
            .then(a.minors.cmp(&b.minors))
    });
}

/// An end in a word or two.
pub fn end_words(end: &TrialEnd) -> String {
    match end {
        TrialEnd::Converged => "converged".into(),
        TrialEnd::Against(law) => format!("breaks {}", law.name()),
        TrialEnd::Budget => format!("{BUDGET} minors"),
        TrialEnd::Failed(Failure::Cycle(cycle)) => format!("{}-cycle", cycle.period),
        TrialEnd::Failed(Failure::MinorLimit { .. }) => "minors' limit".into(),
        TrialEnd::Failed(Failure::MajorLimit { .. }) => "majors' limit".into(),
        TrialEnd::Failed(Failure::MajorCycle(_)) => "majors cycle".into(),
        TrialEnd::Failed(Failure::Singular(_)) => "singular".into(),
        TrialEnd::Failed(Failure::Diverged { .. }) => "diverged".into(),
        TrialEnd::Failed(Failure::OverConstrained { .. }) => "jammed".into(),
        TrialEnd::Failed(Failure::Refused(_)) => "refused".into(),
        TrialEnd::Failed(Failure::Leapt { .. }) => "jumps".into(),
        TrialEnd::Failed(Failure::RoundOff { .. }) => "round-off".into(),
        TrialEnd::Failed(Failure::NoAnswer { .. }) => "no answer".into(),
        TrialEnd::Failed(Failure::NotFound(NotFound::Ray)) => "ray".into(),
        TrialEnd::Failed(Failure::LadderEnded { .. } | Failure::NotFound(_)) => "none found".into(),
    }
}

/// Headings of the table, and what each column of [`row`] is.
pub const COLUMNS: [&str; 10] = [
    "end", "minors", "majors", "factors", "ms", "penetr.", "tension", "shear", "residual", "held",
];

/// A trial as the cells of a table, in the order of [`COLUMNS`].
pub fn row(trial: &Trial) -> [String; 10] {
    let tiny = |value: f64| match value {
        value if value <= 0.0 => "0".into(),
        value => format!("{value:.0e}"),
    };
    let number = |of: fn(&Left) -> f64| {
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
