//! What happened, in words: the sentences that the command line and the debugger share.

use crate::scene::{Mode, Model};
use crate::solve::event::{Cycle, Motion, Singular};
use crate::solve::{Event, Failure, Intervention, Outcome, Position};

/// Name of a slave node.
pub fn slave(model: &Model, slave: usize) -> &str {
    model
        .slaves
        .get(slave)
        .map_or("?", |s| model.nodes[s.node].name.as_str())
}

/// A mode's word.
pub fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Free => "free",
        Mode::Sliding => "sliding",
        Mode::Fixed => "fixed",
    }
}

/// Where a minor iteration was.
pub fn position(at: Position) -> String {
    let again = if at.attempt > 1 {
        format!(" (attempt {})", at.attempt)
    } else {
        String::new()
    };
    format!(
        "increment {}{again}, major {}, minor {}",
        at.increment, at.major, at.minor
    )
}

/// What a minor iteration led to.
pub fn outcome(model: &Model, event: &Event) -> String {
    let at = position(event.position);
    match &event.outcome {
        Outcome::Minor => match changes(model, event).as_str() {
            "" => format!("{at}: modes settled, T_max still moves"),
            changes => format!("{at}: {changes}"),
        },
        Outcome::Damped { cycle: c, aim } => format!(
            "{at}: {}; damped: aims at load {aim} first",
            cycle(model, c)
        ),
        Outcome::Major { after, settled } => {
            let how = if *settled {
                "minors settled"
            } else {
                "minors cut off unsettled"
            };
            format!(
                "{at}: {how}; residual {:.3e}, wanted {:.1e}",
                after.relative.max(after.interface),
                after.limit
            )
        }
        Outcome::Increment {
            unsettled, last, ..
        } => {
            let end = if *last { "; the history is done" } else { "" };
            format!(
                "{at}: load {} accepted{}{end}",
                event.load_factor,
                reservations(model, event, *unsettled)
            )
        }
        Outcome::Failed(failure) => format!("{at}: {}", describe_failure(model, failure)),
    }
}

/// What an accepted increment was accepted in spite of; empty where there is nothing.
pub fn reservations(model: &Model, event: &Event, unsettled: u32) -> String {
    let mut text = match unsettled {
        0 => String::new(),
        1 => ", although one loop was cut off unsettled".into(),
        n => format!(", although {n} loops were cut off unsettled"),
    };
    let defied: Vec<&str> = (0..event.nodes.len())
        .filter(|&s| event.nodes[s].decision.wanted != event.nodes[s].decision.next)
        .map(|s| slave(model, s))
        .collect();
    if !defied.is_empty() {
        text += &format!(
            ", although Table 2 rejects the mode held at {}",
            defied.join(", ")
        );
    }
    text
}

fn changes(model: &Model, event: &Event) -> String {
    let changed = |s: &usize| event.nodes[*s].decision.changes();
    let all: Vec<usize> = (0..event.nodes.len()).filter(changed).collect();
    let told = |&s: &usize| {
        let d = &event.nodes[s].decision;
        format!("{} {} > {}", slave(model, s), mode(d.before), mode(d.next))
    };
    match all.len() {
        0..=3 => all.iter().map(told).collect::<Vec<_>>().join(", "),
        n => format!(
            "{} and {} more",
            all[..2].iter().map(told).collect::<Vec<_>>().join(", "),
            n - 2
        ),
    }
}

/// What the user did.
pub fn intervention(model: &Model, intervention: &Intervention) -> String {
    match intervention {
        Intervention::Force {
            slave: s,
            mode: m,
            hold: false,
        } => {
            format!(
                "{} is {} in the next minor iteration",
                slave(model, *s),
                mode(*m)
            )
        }
        Intervention::Force {
            slave: s,
            mode: m,
            hold: true,
        } => {
            format!("{} is held {} until released", slave(model, *s), mode(*m))
        }
        Intervention::Release { slave: s } => format!("{} obeys Table 2 again", slave(model, *s)),
        Intervention::Increment(increment) => {
            format!("the increment starts again with size {increment}")
        }
        Intervention::Friction(f) => format!(
            "friction angle {} degrees, cohesion {}",
            f.angle, f.cohesion
        ),
        Intervention::Settings(_) => "settings changed".into(),
    }
}

/// Why an increment failed.
pub fn describe_failure(model: &Model, failure: &Failure) -> String {
    match failure {
        Failure::Cycle(c) => cycle(model, c),
        Failure::MinorLimit { limit, changing } => {
            let nodes: Vec<&str> = changing.iter().map(|&s| slave(model, s)).collect();
            format!("the minor iterations did not settle within {limit}; still changing: {}", nodes.join(", "))
        }
        Failure::MajorLimit { limit, relative } => {
            format!("no equilibrium within {limit} major iterations; relative residual {relative:.3e}")
        }
        Failure::Singular(Singular::Rigid { motions }) => {
            let motions: Vec<String> = motions
                .iter()
                .map(|m| match m.motion {
                    Motion::Translation([x, y]) => format!("body {} can move along ({x:.4}, {y:.4})", m.body),
                    Motion::Rotation([x, y]) => format!("body {} can turn about ({x:.4}, {y:.4})", m.body),
                })
                .collect();
            format!("nothing holds a rigid motion: {}", motions.join("; "))
        }
        Failure::Singular(Singular::Unexplained) => {
            "the equations are singular, though every body is held: a limit point, or constraints that repeat each other".into()
        }
        Failure::Diverged { relative } => format!("diverged: displacements beyond all bounds, relative residual {relative:.3e}"),
        Failure::Jammed { slave: s, gap } => {
            format!("{} penetrates by {:.3e}, and neither it nor its surface can move to close that", slave(model, *s), -gap)
        }
    }
}

/// A cycle of modes.
pub fn cycle(model: &Model, cycle: &Cycle) -> String {
    let members: Vec<String> = cycle
        .members
        .iter()
        .map(|(s, modes)| {
            let modes: Vec<&str> = modes.iter().map(|&m| mode(m)).collect();
            format!("{} {}", slave(model, *s), modes.join(" > "))
        })
        .collect();
    format!(
        "the modes {}-cycle since minor {}: {}",
        cycle.period,
        cycle.start,
        members.join("; ")
    )
}
