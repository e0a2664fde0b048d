//! Why the minor iterations cycle and what escapes the cycle, found from its frozen interface problem, as data
//! and in words.

use crate::explain::core::{Core, changes, core, cycle, end};
use crate::explain::facts::{Fact, Part};
use crate::explain::influence::{Influence, influences};
use crate::explain::{names, proven, tested};
use stickslip_core::interface::census::{self, Census, MOST, MOST_SEARCHED, search};
use stickslip_core::interface::problem::{Answer, Condition};
use stickslip_core::strategy::method;
use stickslip_core::{
    AssumedMode, BoundUpdate, ContactRecord, ContactState, Cycle, InterfaceProblem, Mode, Model,
    NodeAnswer, TestedQuantity, Trials, words,
};
use stickslip_scene::{aligned, first_of, joined, sig4};

/// Maximum number of nodes of a diagnosed problem: each iteration of its cycle requires dense solves of twice
/// that size. A larger scene is reduced to the nodes that take part in the cycle ([`cycling`]).
pub const MOST_NODES: usize = 200;
/// Maximum number of branches searched to count the states of a cycle without a small core.
const BRANCHES: usize = census::BUDGET / 10;
/// Number of nodes up to which all these branches are searched; beyond it, the number falls with its square.
const AT_FULL: f64 = 20.0;
/// Maximum number of consistent states listed.
const MOST_TOLD: usize = 12;
/// Maximum number of nodes whose numbers are listed for a single consistent state.
const MOST_NUMBERS: usize = 8;
/// Maximum number of iterations of a period whose pushes are computed.
const MOST_PHASES: usize = 12;
/// Maximum number of pushes listed.
const MOST_PUSHES: usize = 24;
/// Maximum number of nodes named in a sentence.
const MOST_NAMES: usize = 6;

/// Diagnosis of a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// The cycle that starts from the nodes' states. Nodes are indices in the problem.
    pub cycle: Cycle,
    /// The iterations of one period.
    pub phases: Vec<Phase>,
    /// The smallest set of nodes that still cycles; `None` if unknown.
    pub core: Option<Core>,
    /// The problem of all nodes that take part; if those are too many for a census, of those whose modes
    /// change, or of the core, with all other nodes frozen. If it has no consistent state, the problem of all
    /// nodes that can touch, if they are few enough.
    pub problem: InterfaceProblem,
    /// Its consistent states; `None` if even the core is too large.
    pub census: Option<Census>,
    /// The cause of the cycle.
    pub cause: Cause,
    /// Whether T_max is lagged, and the minor iterations settle with a consistent one.
    pub lags: bool,
}

/// One iteration of a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// The record of each node.
    pub records: Vec<ContactRecord>,
    /// For each node whose mode changes (in the first `MOST_PHASES` iterations): the change since the previous
    /// iteration with the largest effect on the tested quantity.
    pub pushes: Vec<Push>,
}

/// The main cause of a node's mode change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Index of the node whose mode changes.
    pub node: usize,
    /// Modes of the pushing node in the previous iteration and in this one.
    pub from_modes: [Mode; 2],
    /// The effect, with the pushing node.
    pub influence: Influence,
    /// The tested quantity.
    pub tested: TestedQuantity,
}

/// Why Table 2 cycles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cause {
    /// No state of these nodes satisfies Coulomb's law.
    NoAnswer,
    /// In the consistent state these nodes slide, which never happens in the cycle: Table 2 sends a rough node
    /// in new contact to fixed, and from there it opens. Indices in the diagnosed problem.
    NoWayToSliding(Vec<usize>),
    /// The modes have settled, but the lagged T_max oscillates.
    Lag,
    /// Several states are consistent, but Table 2 never reaches any.
    Several,
    /// One state is consistent, but Table 2 never reaches it.
    Passed,
    /// Too many nodes for a census.
    Unknown,
}

impl Diagnosis {
    /// Diagnoses a problem whose states start a cycle; `None` if they do not, or if it has more than
    /// [`MOST_NODES`] nodes. The search for states stops early if `stop` returns true.
    pub fn find(problem: &InterfaceProblem, stop: &dyn Fn() -> bool) -> Option<Diagnosis> {
        if problem.nodes.len() > MOST_NODES {
            return None;
        }
        let cycle = cycle(problem)?;
        let phases = phases(problem, cycle.period)?;
        let core = core(problem);
        let members: Vec<usize> = cycle.members.iter().map(|member| member.0).collect();
        let changing = cycle.members.iter().filter(|member| changes(&member.1));
        let changing: Vec<usize> = changing.map(|member| member.0).collect();
        let mut studied = match members.len() > MOST && !changing.is_empty() {
            true => problem.reduced(&changing)?,
            false => problem.reduced(&members)?,
        };
        let counted = |problem: &InterfaceProblem| {
            let few = (AT_FULL / (problem.nodes.len() as f64).max(AT_FULL)).powi(2);
            search(problem, (BRANCHES as f64 * few) as usize, stop).ok()
        };
        let mut found = counted(&studied);
        // A search that ended early without a state proves nothing.
        let unknown = |found: &Census| found.answers.is_empty() && !found.exact;
        if found.as_ref().is_none_or(unknown)
            && let Some(core) = &core
            && core.problem.nodes.len() < studied.nodes.len()
        {
            studied = core.problem.clone();
            found = counted(&studied);
        }
        // A state may become consistent when the frozen nodes change, too.
        let all = undecided(problem);
        let none = found.as_ref().is_some_and(|found| found.answers.is_empty());
        if none
            && (studied.nodes.len() + 1..=MOST_SEARCHED).contains(&all.len())
            && let Some(wider) = problem.reduced(&all)
            && let Some(of_all) = counted(&wider)
            && (of_all.exact || !of_all.answers.is_empty())
        {
            found = Some(of_all);
            studied = wider;
        }
        let census = found;
        let cause = cause(problem, &phases, &studied, census.as_ref());
        let mut consistent = studied.clone();
        consistent.settings.t_max = BoundUpdate::Consistent;
        let lags = studied.settings.t_max == BoundUpdate::Lagged
            && matches!(end(&consistent), Some(Ok(_)));
        Some(Diagnosis {
            cycle,
            phases,
            core,
            problem: studied,
            census,
            cause,
            lags,
        })
    }
}

/// The problem of a cycle: the whole problem or, if it is large, that of the nodes that take part, with all
/// others frozen. `None` if it is singular or still too large. The states are at the start of the cycle.
pub fn cycling(problem: InterfaceProblem, cycle: &Cycle) -> Option<InterfaceProblem> {
    if problem.nodes.len() <= MOST_NODES {
        return Some(problem);
    }
    let takes_part = |place: &usize| {
        let slave = problem.nodes[*place].slave;
        cycle.members.iter().any(|(member, _)| *member == slave)
    };
    let members: Vec<usize> = (0..problem.nodes.len()).filter(takes_part).collect();
    if members.len() > MOST_NODES {
        return None;
    }
    problem.reduced(&members)
}

/// Indices of the nodes with more than one possible mode.
pub fn undecided(problem: &InterfaceProblem) -> Vec<usize> {
    let choices = |place: &usize| problem.nodes[*place].choices().len();
    let all = 0..problem.nodes.len();
    all.filter(|place| choices(place) > 1).collect()
}

/// Message that too many nodes take part in a cycle.
pub fn too_many(cycle: &Cycle) -> String {
    let count = cycle.members.len();
    format!(
        "{count} nodes take part in the cycle: too many, or singular with all other nodes frozen"
    )
}

/// The iterations of one period, with the pushes.
fn phases(problem: &InterfaceProblem, period: u32) -> Option<Vec<Phase>> {
    let mut trials = Trials::new(problem)?;
    let mut nodes = problem.states();
    // The iteration before the first one is the last of the period.
    let mut states = vec![nodes.clone()];
    let mut all = Vec::new();
    for _ in 0..period {
        let (records, _) = trials.minor(&mut nodes, method(problem.settings.strategy))?;
        states.push(nodes.clone());
        all.push(records);
    }
    let before = |phase: usize| match phase {
        0 => &states[period as usize - 1],
        phase => &states[phase - 1],
    };
    let found = all.into_iter().enumerate().map(|(phase, records)| {
        let changed = |s: &usize| records[*s].decision.changes();
        let changed: Vec<usize> = (0..records.len()).filter(changed).collect();
        let explains = phase < MOST_PHASES && !changed.is_empty();
        let old = explains.then(|| trials.solve_states(before(phase)));
        let old = old.flatten();
        let all = old.and_then(|old| influences(problem, &old, &states[phase], &changed));
        let pushes = changed.iter().zip(all.iter().flatten());
        let pushes = pushes
            .filter_map(|(&node, all)| push(all, before(phase), &states[phase], &records, node))
            .collect();
        Phase { records, pushes }
    });
    Some(found.collect())
}

fn push(
    all: &[Influence],
    before: &[ContactState],
    now: &[ContactState],
    records: &[ContactRecord],
    node: usize,
) -> Option<Push> {
    let tested = tested::deciding(&records[node].decision);
    let of = |i: &Influence| tested::effect(tested, i).1;
    let most = all
        .iter()
        .max_by(|a, b| of(a).abs().total_cmp(&of(b).abs()))?;
    Some(Push {
        node,
        from_modes: [before[most.from].mode, now[most.from].mode],
        influence: *most,
        tested,
    })
}

fn cause(
    whole: &InterfaceProblem,
    phases: &[Phase],
    problem: &InterfaceProblem,
    census: Option<&Census>,
) -> Cause {
    let Some(census) = census else {
        return Cause::Unknown;
    };
    if census.answers.is_empty() && !census.exact {
        return Cause::Unknown;
    }
    if census.answers.is_empty() {
        return Cause::NoAnswer;
    }
    let settled = |phase: &Phase| phase.records.iter().all(|r| !r.decision.changes());
    if phases.iter().all(settled) {
        return Cause::Lag;
    }
    let [answer] = census.answers.as_slice() else {
        return Cause::Several;
    };
    let never_slides = |place: usize| {
        let slave = problem.nodes[place].slave;
        let slides = |phase: &Phase| {
            let mut records = whole.nodes.iter().zip(&phase.records);
            records.any(|(n, r)| n.slave == slave && r.decision.before == Mode::Sliding)
        };
        let assumed = answer.answer.nodes[place].assumed;
        assumed.mode() == Mode::Sliding && !phases.iter().any(slides)
    };
    let nodes: Vec<usize> = (0..problem.nodes.len())
        .filter(|&p| never_slides(p))
        .collect();
    match nodes.first() {
        Some(_) => Cause::NoWayToSliding(nodes),
        None => Cause::Passed,
    }
}

/// What cycles, in one line.
pub fn head(model: &Model, problem: &InterfaceProblem, diagnosis: &Diagnosis) -> String {
    let members = diagnosis.cycle.members.iter();
    let names: Vec<_> = members
        .map(|member| names::slave(model, problem.nodes[member.0].slave))
        .collect();
    format!(
        "The minor iterations cycle with period {} from here: {}.",
        diagnosis.cycle.period,
        list(&names)
    )
}

/// The diagnosis in words, with node names of the scene.
pub fn words(model: &Model, problem: &InterfaceProblem, diagnosis: &Diagnosis) -> Vec<Fact> {
    let name = |place: usize| names::slave(model, problem.nodes[place].slave);
    let studied = |place: usize| names::slave(model, diagnosis.problem.nodes[place].slave);
    // Nodes left out of the problem, and nodes of the problem left out of the census.
    let left_out = model.contacts.len() > problem.nodes.len()
        || undecided(problem).len() > diagnosis.problem.nodes.len();
    let mut facts = vec![Fact::why(cause_words(diagnosis, left_out, &studied))];
    facts.extend(Fact::all(Part::Loop, loop_table(diagnosis, &name)));
    if let Some(core) = &diagnosis.core
        && core.places.len() < diagnosis.cycle.members.len()
    {
        let names: Vec<_> = core.places.iter().map(|&place| name(place)).collect();
        let text = format!(
            "core: {} still cycle{} (period {}) with all other modes frozen",
            list(&names),
            if names.len() == 1 { "s" } else { "" },
            core.cycle.period
        );
        facts.push(Fact::new(Part::Loop, text));
    }
    if let Some(census) = &diagnosis.census {
        let mut lines: Vec<String> = of_which_words(problem, diagnosis).into_iter().collect();
        lines.extend(census_words(census, &studied));
        lines.extend(proven::family_words(&diagnosis.problem, census, &studied));
        facts.extend(Fact::all(Part::Census, lines));
    }
    let rates = proven::cycle_words(problem, &name);
    facts.extend(Fact::all(Part::Rates, rates));
    facts
}

/// The loop of pushes as a table, one change of mode per line.
fn loop_table<'a>(diagnosis: &Diagnosis, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let phases = diagnosis.phases.iter().enumerate();
    let pushes = phases.flat_map(|(k, phase)| {
        let rows = phase.pushes.iter();
        rows.map(move |push| (k + 1, phase, push))
    });
    let heads = ["minor", "cause", "effect", "Δ"].map(String::from);
    let rows = pushes
        .clone()
        .take(MOST_PUSHES)
        .map(|(minor, phase, push)| push_row(minor, push, phase, name));
    let rows: Vec<[String; 4]> = [heads].into_iter().chain(rows).collect();
    let mut lines = match rows.len() {
        1 => Vec::new(),
        _ => aligned(&rows, 3),
    };
    let changes = |phase: &Phase| {
        let records = phase.records.iter();
        records.filter(|record| record.decision.changes()).count()
    };
    let all: usize = diagnosis.phases.iter().map(changes).sum();
    let more = all.saturating_sub(pushes.count().min(MOST_PUSHES));
    if more > 0 {
        let changes = words::counted(more, "more mode change");
        lines.push(format!("and {changes}"));
    }
    lines
}

/// The nodes over which states are counted, if not all that take part.
fn of_which_words(problem: &InterfaceProblem, diagnosis: &Diagnosis) -> Option<String> {
    let (counted, part) = (&diagnosis.problem.nodes, diagnosis.cycle.members.len());
    if counted.len() >= part {
        return None;
    }
    let of = |place: usize| problem.nodes[place].slave;
    let in_core = |core: &Core| {
        core.places.len() == counted.len()
            && core
                .places
                .iter()
                .zip(counted)
                .all(|(&place, node)| of(place) == node.slave)
    };
    let which = match diagnosis.core.as_ref().is_some_and(in_core) {
        true => "nodes of the core",
        false => "whose modes change",
    };
    Some(format!(
        "of {part} nodes that take part, the states of the {} {which} are counted, with all others frozen",
        counted.len()
    ))
}

fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => one.to_string(),
        all if all.len() > MOST_NAMES => first_of(all, MOST_NAMES, ", "),
        [some @ .., last] => format!("{} and {last}", some.join(", ")),
    }
}

fn cause_words<'a>(
    diagnosis: &Diagnosis,
    left_out: bool,
    name: &impl Fn(usize) -> &'a str,
) -> String {
    let members: Vec<&str> = (0..diagnosis.problem.nodes.len()).map(name).collect();
    let nodes = list(&members);
    match &diagnosis.cause {
        Cause::NoWayToSliding(_) | Cause::Several | Cause::Passed if diagnosis.lags => format!(
            "T_max lags by one iteration; with a consistent T_max, Table 2 finds a consistent combination of modes of {nodes}"
        ),
        Cause::NoAnswer if left_out => {
            format!("no modes of {nodes} are consistent with all other nodes frozen")
        }
        Cause::NoAnswer => format!(
            "no modes of {nodes} are consistent in the linearised problem of this major iteration, so no strategy can settle there"
        ),
        Cause::NoWayToSliding(sliding) => {
            let sliding: Vec<&str> = sliding.iter().map(|&place| name(place)).collect();
            format!(
                "in the only consistent state {} slide{}, which Table 2 cannot reach: it sends a \
                 rough node in new contact to fixed, and from there the node opens",
                list(&sliding),
                if sliding.len() == 1 { "s" } else { "" }
            )
        }
        Cause::Lag => format!(
            "the modes have settled, but T_max of {nodes}, lagged by one iteration, oscillates"
        ),
        Cause::Several => format!(
            "{} combinations of modes of {nodes} are consistent, but Table 2 never reaches any",
            diagnosis.census.as_ref().map_or(0, |c| c.answers.len())
        ),
        Cause::Passed => {
            format!(
                "one combination of modes of {nodes} is consistent, but Table 2 never reaches it"
            )
        }
        Cause::Unknown => {
            format!(
                "{} nodes take part, too many to try all combinations of modes",
                members.len()
            )
        }
    }
}

fn push_row<'a>(
    minor: usize,
    push: &Push,
    phase: &Phase,
    name: &impl Fn(usize) -> &'a str,
) -> [String; 4] {
    let (what, value) = tested::effect(push.tested, &push.influence);
    let source = name(push.influence.from);
    let cause = match push.from_modes {
        [a, b] if a == b => format!("new T_max of {source}"),
        [_, Mode::Free] => format!("{source} opens"),
        [Mode::Free, _] => format!("{source} closes"),
        [_, Mode::Sliding] => format!("{source} slides"),
        [_, Mode::Fixed] => format!("{source} sticks"),
    };
    let does = match phase.records[push.node].decision.next {
        Mode::Free => "opens",
        Mode::Sliding => "slides",
        Mode::Fixed => "sticks",
    };
    let effect = format!("{} {does}", name(push.node));
    [
        minor.to_string(),
        cause,
        effect,
        format!("{what} = {}", sig4(value)),
    ]
}

pub(super) fn census_words<'a>(census: &Census, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let all = match (census.tried, census.answers.first()) {
        (usize::MAX, Some(found)) => format!("up to 4^{}", found.answer.nodes.len()),
        (usize::MAX, None) => "more than 10^19".to_owned(),
        (tried, _) => tried.to_string(),
    };
    let count = census.answers.len();
    let nodes = census.answers.first().map(|found| &found.answer);
    let nodes = nodes.or(census.nearest.as_ref().map(|(answer, ..)| answer));
    let names: Vec<_> = (0..nodes.map_or(0, |answer| answer.nodes.len()))
        .map(name)
        .collect();
    let of = match names.is_empty() {
        true => String::new(),
        false => format!("of {}: ", list(&names)),
    };
    let mut lines = vec![match (count, census.exact) {
        (0, true) => format!("{of}none of {all} assignments is consistent"),
        (1, true) => format!("{of}1 of {all} assignments is consistent"),
        (n, true) => format!("{of}{n} of {all} assignments are consistent"),
        (0, false) => format!("{of}none of {all} assignments has been found consistent so far"),
        (n, false) => format!("{of}at least {n} of {all} assignments are consistent"),
    }];
    let branches = words::counted(census.visited, "branch");
    match (census.visited, census.exact) {
        (0, true) => {}
        (_, true) => lines.push(format!(
            "  branch and bound: all others are excluded by {branches}"
        )),
        _ => lines.push(format!(
            "  branch and bound: incomplete after {branches}; there may be more"
        )),
    }
    for (number, found) in census.answers.iter().enumerate().take(MOST_TOLD) {
        let nodes = modes_words(&found.answer, name);
        let margin = found
            .answer
            .worst()
            .map(|(place, margin)| {
                format!(
                    "; tightest condition: {} at {}, margin {}",
                    condition_words(margin.condition),
                    name(place),
                    sig4(margin.value)
                )
            })
            .unwrap_or_default();
        let ties = match found.ties.as_slice() {
            [] => String::new(),
            ties => format!(" (tie: same as {})", ties.join(", ")),
        };
        lines.push(format!("  {}: {}{ties}{margin}", number + 1, nodes));
    }
    if count > MOST_TOLD {
        lines.push(format!("  and {} more", count - MOST_TOLD));
    }
    lines.extend(numbers(census, name));
    if let Some((answer, place, margin)) = &census.nearest {
        lines.push(format!(
            "  nearest: {}, which violates \"{}\" at {} by {}",
            answer.letters(),
            condition_words(margin.condition),
            name(*place),
            sig4(-margin.value)
        ));
    }
    lines
}

/// The numbers of a consistent state at its first nodes; of several, at the nodes in which they differ. One line per node.
fn numbers<'a>(census: &Census, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let all = &census.answers;
    let Some(first) = all.first() else {
        return Vec::new();
    };
    let of = |number: usize, place: usize| &all[number].answer.nodes[place];
    let differs =
        |&place: &usize| (1..all.len()).any(|k| of(k, place).assumed != of(0, place).assumed);
    let (heading, most) = match all.len() {
        1 => ("its forces and motions:", MOST_NUMBERS),
        _ => ("how they differ:", usize::MAX),
    };
    let places = (0..first.answer.nodes.len()).filter(|place| all.len() == 1 || differs(place));
    let line = |place: usize| {
        let each = (0..all.len().min(MOST_TOLD)).map(|number| {
            let node = of(number, place);
            let does = assumed_words(node.assumed);
            let [gap, f_n, f_t, slip] = [node.gap, node.f_n, node.f_t, node.slip].map(sig4);
            let which = match all.len() {
                1 => String::new(),
                _ => format!(" in {}", number + 1),
            };
            match node.assumed {
                AssumedMode::Free => format!("{does}{which}, gap {gap}"),
                _ => format!("{does}{which}, F_n {f_n}, F_t {f_t}, slip {slip}"),
            }
        });
        format!("  {}: {}", name(place), joined(each, "; "))
    };
    let lines = places.take(most).map(line);
    std::iter::once(heading.to_owned()).chain(lines).collect()
}

/// The assumed mode of a node, in words.
pub fn assumed_words(assumed: AssumedMode) -> &'static str {
    match assumed {
        AssumedMode::Free => "free",
        AssumedMode::Fixed => "fixed",
        AssumedMode::Plus => "sliding with F_t > 0",
        AssumedMode::Minus => "sliding with F_t < 0",
    }
}

/// The mode of a node in a state, in words: without friction, sliding has no direction.
pub fn answer_words(node: &NodeAnswer) -> &'static str {
    match node.assumed.mode() {
        Mode::Sliding if node.limit == 0.0 && node.f_n != 0.0 => "sliding",
        _ => assumed_words(node.assumed),
    }
}

/// The modes of all nodes in a state, in words.
pub(super) fn modes_words<'a>(answer: &Answer, name: &impl Fn(usize) -> &'a str) -> String {
    let nodes = answer.nodes.iter().enumerate();
    let words = nodes.map(|(place, node)| format!("{} {}", name(place), answer_words(node)));
    joined(words, ", ")
}

/// A condition of contact or friction, in words.
pub fn condition_words(condition: Condition) -> &'static str {
    match condition {
        Condition::NoPenetration => "no penetration",
        Condition::NoTension => "no tension",
        Condition::WithinLimit => "friction within its limit",
        Condition::Dissipation => "friction against the slip",
    }
}
