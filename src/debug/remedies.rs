//! Remedies for an increment that does not converge: each is tried from the same state, and measured.
//!
//! A remedy is what is done before the first minor iteration (a consistent state of the census, a setting, a smaller
//! increment), and perhaps a rule that corrects Table 2 after each. The rules are of the kinds that linear
//! complementarity knows: one change at a time, the node of least index first (finite in theory for the problems of
//! smooth contact, slow), and all changes at once until they stop getting fewer, then one at a time (block pivoting
//! with a least-index fallback). A trial ends where the load that failed is accepted, where it fails, or after
//! [`BUDGET`] minor iterations. What it did is kept as steps, so that the chosen one can be done again in a branch.

use crate::debug::looks;
use crate::debug::report;
use crate::scene::spec::{AtCycle, FrictionLimit, ResidualMethod, Sticking};
use crate::scene::{Mode, Settings};
use crate::solve::system::condenses;
use crate::solve::{
    Event, Failure, Forced, Intervention, NodeRecord, Norms, Outcome, State, Status, Stepper,
};
use std::cmp::Ordering;
use std::time::Instant;

/// Most minor iterations of a trial.
pub const BUDGET: u32 = 400;
/// Rounds that all changes at once may go on without getting fewer.
const PATIENCE: u32 = 10;
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
    rule: Rule,
}

/// What corrects Table 2 after a minor iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    None,
    /// A rough node that touches is sent to sliding, not to fixed.
    EnterSliding,
    /// Of all nodes that would change, only the first does.
    LeastIndex,
    /// All change, until their number has not fallen for [`PATIENCE`] rounds; then only the first, until it has.
    Block,
    /// A node that misses its condition by less than [`HYSTERESIS`] is held.
    Hysteresis,
}

/// How a trial ended.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    /// The load that failed was accepted.
    Converged,
    Failed(Failure),
    /// The budget is used up.
    Budget,
}

/// What is left of violations in the accepted state, over the scale of forces and the length of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Left {
    /// Deepest penetration (length).
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
    pub label: String,
    pub end: End,
    pub minors: u32,
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

/// All that there is to try from a state.
pub fn all(stepper: &mut Stepper, state: &State) -> Vec<Remedy> {
    if state.status == Status::Finished {
        return Vec::new();
    }
    let remedy = |label: String, first: Vec<Intervention>, rule| Remedy { label, first, rule };
    let mut all = answers(stepper, state);
    for (label, rule) in [
        ("enter contact as sliding", Rule::EnterSliding),
        ("one change at a time, least index", Rule::LeastIndex),
        ("block changes, least-index fallback", Rule::Block),
        ("hysteresis of 1e-3", Rule::Hysteresis),
    ] {
        all.push(remedy(label.into(), Vec::new(), rule));
    }
    let mut set = |label: &str, change: &dyn Fn(&mut Settings)| {
        let mut settings = state.controls.settings;
        change(&mut settings);
        if settings != state.controls.settings {
            let first = vec![Intervention::Settings(settings)];
            all.push(remedy(label.into(), first, Rule::None));
        }
    };
    set("t_max consistent", &|s| s.t_max = FrictionLimit::Consistent);
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
        all.push(remedy(label.into(), first, Rule::None));
    }
    all
}

/// The consistent states of the frozen problem that is solved next.
fn answers(stepper: &mut Stepper, state: &State) -> Vec<Remedy> {
    let finding = looks::finding(stepper, state);
    let count = finding.census.as_ref().map_or(0, |c| c.answers.len());
    let model = stepper.model();
    let answer = |number: usize| {
        let starts = finding.starts(number)?;
        const SHOWN: usize = 2;
        let name = |s: &crate::solve::Start| {
            format!("{} {}", report::slave(model, s.slave), report::mode(s.mode))
        };
        let some: Vec<String> = starts.iter().take(SHOWN).map(name).collect();
        let more = if starts.len() > SHOWN { ", …" } else { "" };
        Some(Remedy {
            label: format!("answer {}: {}{more}", number + 1, some.join(", ")),
            first: vec![Intervention::Assume(starts)],
            rule: Rule::None,
        })
    };
    (0..count).filter_map(answer).collect()
}

/// Tries a remedy; none where it was stopped.
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
        end: End::Budget,
        minors: 0,
        majors: 0,
        factorizations: 0,
        seconds: 0.0,
        left: None,
        steps: Vec::new(),
    };
    let mut corrector = Corrector {
        rule: remedy.rule,
        fewest: usize::MAX,
        rounds: 0,
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
    while trial.minors < BUDGET {
        if stop() {
            return None;
        }
        let began = Instant::now();
        let Some(event) = stepper.step().cloned() else {
            trial.end = End::Converged;
            break;
        };
        trial.seconds += began.elapsed().as_secs_f64();
        trial.minors += 1;
        trial.steps.push(None);
        let uncondensed = !condenses(stepper.model(), &stepper.state().controls.settings);
        let ends = !matches!(event.outcome, Outcome::Minor | Outcome::Damped { .. });
        trial.majors += u32::from(ends);
        trial.factorizations += u32::from(ends || uncondensed);
        match &event.outcome {
            Outcome::Failed(failure) => {
                trial.end = End::Failed(failure.clone());
                break;
            }
            Outcome::Increment { after, .. } if is_there(stepper.state(), &event, target) => {
                trial.end = End::Converged;
                trial.left = Some(left(stepper, &event, after));
                break;
            }
            Outcome::Minor => {
                for what in corrector.corrections(stepper, &event) {
                    change(stepper, &mut trial, what);
                }
            }
            _ => {}
        }
    }
    // The last major iteration, where the trial ended within it.
    if trial.end == End::Budget {
        trial.factorizations += 1;
    }
    Some(trial)
}

/// Whether the accepted increment has come to the load that failed.
fn is_there(state: &State, event: &Event, (leg, load): (usize, f64)) -> bool {
    let close = (event.load_factor - load).abs() <= 1e-9 * state.controls.increment;
    state.status == Status::Finished || state.start.leg > leg || close
}

struct Corrector {
    rule: Rule,
    /// Fewest nodes that changed so far, and rounds since then.
    fewest: usize,
    rounds: u32,
}

impl Corrector {
    /// What to change after a minor iteration that did not settle.
    fn corrections(&mut self, stepper: &Stepper, event: &Event) -> Vec<Intervention> {
        let changing: Vec<usize> = (0..event.nodes.len())
            .filter(|&s| event.nodes[s].decision.changes())
            .collect();
        let force = |slave: usize, mode, hold| Intervention::Force { slave, mode, hold };
        let keep = |&slave: &usize| force(slave, event.nodes[slave].decision.before, false);
        let first_only = || changing.iter().skip(1).map(keep).collect();
        match self.rule {
            Rule::None => Vec::new(),
            Rule::EnterSliding => changing
                .iter()
                .filter(|&&s| {
                    let decision = &event.nodes[s].decision;
                    (decision.before, decision.next) == (Mode::Free, Mode::Fixed)
                })
                .map(|&s| force(s, Mode::Sliding, false))
                .collect(),
            Rule::LeastIndex => first_only(),
            Rule::Block => {
                self.rounds += 1;
                if changing.len() < self.fewest {
                    (self.fewest, self.rounds) = (changing.len(), 0);
                }
                match self.rounds > PATIENCE {
                    true => first_only(),
                    false => Vec::new(),
                }
            }
            Rule::Hysteresis => {
                let near = |record: &NodeRecord| {
                    let margins = record.decision.tests.iter().flatten();
                    let size = |tested| scale_of(tested, stepper, event);
                    margins
                        .filter(|test| test.margin < 0.0)
                        .all(|test| -test.margin < HYSTERESIS * size(test.tested))
                };
                let hold = changing.iter().filter(|&&s| near(&event.nodes[s]));
                let hold = hold.map(|&s| force(s, event.nodes[s].decision.before, true));
                let held = event.nodes.iter().enumerate().filter(|(_, record)| {
                    matches!(record.forced, Forced::Held(_))
                        && record.decision.wanted != record.decision.next
                        && !near(record)
                });
                let release = held.map(|(slave, _)| Intervention::Release { slave });
                hold.chain(release).collect()
            }
        }
    }
}

/// The scale of what is tested: a force or a length.
fn scale_of(tested: crate::contact::decision::Tested, stepper: &Stepper, event: &Event) -> f64 {
    use crate::contact::decision::Tested;
    match tested {
        Tested::NormalForce | Tested::ShearForce => event.before.scale,
        Tested::Slip | Tested::Gap => stepper.model().length,
    }
}

/// Violations in the last minor iteration, which was accepted.
fn left(stepper: &Stepper, event: &Event, after: &Norms) -> Left {
    let friction = &stepper.state().controls.friction;
    let mut left = Left {
        residual: after.relative,
        ..Left::default()
    };
    for (record, friction) in event.nodes.iter().zip(friction) {
        let decision = &record.decision;
        if record.gap.is_finite() {
            left.penetration = left.penetration.max(-record.gap);
        }
        if decision.before != Mode::Free {
            let limit = record.f_n.abs() * friction.coefficient() + friction.cohesion;
            left.tension = left.tension.max(-record.f_n);
            left.shear = left.shear.max(record.f_t.abs() - limit);
        }
        left.held += usize::from(decision.wanted != decision.next);
    }
    let force = if after.scale > 0.0 { after.scale } else { 1.0 };
    left.worst = (left.penetration / stepper.model().length)
        .max(left.tension / force)
        .max(left.shear / force);
    left
}

/// Best first: those that converged and leave no violation, by cost; those that leave one, by its size; then the others.
pub fn sort(trials: &mut [Trial]) {
    let class = |trial: &Trial| match (&trial.end, &trial.left) {
        (End::Converged, Some(left)) if left.worst > CLEAN || left.held > 0 => 1,
        (End::Converged, _) => 0,
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
pub fn end_words(end: &End) -> String {
    match end {
        End::Converged => "converged".into(),
        End::Budget => format!("{BUDGET} minors"),
        End::Failed(Failure::Cycle(cycle)) => format!("{}-cycle", cycle.period),
        End::Failed(Failure::MinorLimit { .. }) => "minors' limit".into(),
        End::Failed(Failure::MajorLimit { .. }) => "majors' limit".into(),
        End::Failed(Failure::MajorCycle(_)) => "majors cycle".into(),
        End::Failed(Failure::Singular(_)) => "singular".into(),
        End::Failed(Failure::Diverged { .. }) => "diverged".into(),
        End::Failed(Failure::Jammed { .. }) => "jammed".into(),
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
