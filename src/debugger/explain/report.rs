//! Sentences about what happened, shared by the command line and the debugger.

use crate::explain::accuracy;
use crate::explain::failures;
use crate::explain::headline::first_part;
use crate::explain::judged;
use crate::explain::jumped;
use crate::explain::names::{self, mode, position_in, slave};
use crate::explain::strain;
use stickslip_core::step::event::SmallerStepReason;
use stickslip_core::{
    Control, Decision, Event, Failure, Intervention, Model, MotionEvent, Outcome, Position, Rule,
    Singular, State, TestedQuantity, counted,
};
use stickslip_scene::{few, first_of, joined, shortest, sig2, sig4, sig6};

/// Why Table 2 decided as it did; `friction` is whether there is any.
pub fn reason(decision: &Decision, friction: bool) -> String {
    let text = match decision.rule {
        Rule::Custom(reason) => reason.0,
        Rule::FixedStays => {
            "Stays fixed: the surface pushes, and F_t is within the friction limit."
        }
        Rule::FixedSlides => "Fixed → sliding: F_t exceeds the friction limit.",
        Rule::FixedDragged => "Fixed → sliding: its supports drag it along, so it cannot stick.",
        Rule::FixedOpens => "Fixed → free: the surface would have to pull.",
        Rule::SlidingSticks => {
            "Sliding → fixed: friction would drive the slip instead of opposing it."
        }
        Rule::SlidingStays if !friction => "Stays sliding: there is no friction.",
        Rule::SlidingStays => "Stays sliding: friction opposes the slip.",
        Rule::SlidingPasses if !friction => {
            "Stays sliding, past the end of its side: there is no friction."
        }
        Rule::SlidingPasses => {
            "Stays sliding, past the end of its side: friction opposes the slip."
        }
        Rule::CornerStays => {
            "Stays in the corner: both sides push, and F_t is within their friction limits."
        }
        Rule::CornerSlides => {
            "Corner → sliding along one side: F_t exceeds the friction limits of both sides."
        }
        Rule::CornerOpens => "Corner → free: the sides would have to pull.",
        Rule::CornerReleases => {
            "Corner → sliding back along the side it came from: F_t opposes that slip by less than friction requires."
        }
        Rule::SlidingOpens => "Sliding → free: the surface would have to pull.",
        Rule::FreeSticks => "Free → fixed: the node penetrates the surface.",
        Rule::FreeSlides => "Free → sliding: the node penetrates a smooth surface.",
        Rule::FreeStays => "Stays free: the gap is open.",
        Rule::FreeEnters => {
            "Free → sliding: the node penetrates the surface, and the strategy makes it slide against its motion."
        }
        Rule::Waits => {
            let (next, wanted) = (mode(decision.next), mode(decision.wanted));
            return format!(
                "Stays {next} for now: only one node changes at a time; {wanted} (◁) comes later."
            );
        }
        Rule::NewtonOpens => "Newton: free, since F_n does not exceed k·g.",
        Rule::NewtonSticks => "Newton: fixed, since force and slip are within the friction limit.",
        Rule::NewtonSlides if !friction => "Newton: sliding, since there is no friction.",
        Rule::NewtonSlides => "Newton: sliding, since force and slip exceed the friction limit.",
        Rule::Pivots => {
            let here = format!(
                "Lemke: {} in this basis of the problem relaxed by z.",
                mode(decision.next)
            );
            let first = match decision.tests[1].map(|test| test.tested) {
                Some(TestedQuantity::Gap) => " Its gap was the first to close.",
                Some(TestedQuantity::NormalForce) => " Its F_n was the first to vanish.",
                Some(TestedQuantity::ShearForce) => {
                    " It was the first to reach its friction limit."
                }
                Some(TestedQuantity::Slip) => " Its slip was the first to end.",
                _ => "",
            };
            return here + first;
        }
        Rule::Sweeps => {
            return format!(
                "Gauss-Seidel: {} by Coulomb's law at this node, with the forces of all others fixed.",
                mode(decision.next)
            );
        }
        Rule::Found => {
            return format!(
                "A consistent state with this node {} was found; it is checked next.",
                mode(decision.next)
            );
        }
        Rule::Settled => {
            return format!(
                "Gauss-Seidel: {}; the forces obey Coulomb's law within the tolerance and are accepted.",
                mode(decision.next)
            );
        }
        Rule::OffSurface => {
            "Free: the projection lies past an end of every surface, so there is no contact."
        }
        Rule::Tied => "Tied: held at its point of the surface, even in tension, without Table 2.",
        Rule::Held if decision.wanted == decision.next => {
            return format!(
                "You hold it {}; the solver decides the same.",
                mode(decision.next)
            );
        }
        Rule::Held => {
            let (next, wanted) = (mode(decision.next), mode(decision.wanted));
            return format!("You hold it {next}; Table 2 (◁) decides {wanted}. M releases it.");
        }
        Rule::Theirs if decision.wanted == decision.next => {
            "The solver decided by its own rules, not by Table 2."
        }
        Rule::Theirs => {
            let (next, wanted) = (mode(decision.next), mode(decision.wanted));
            return format!(
                "The solver chooses {next}; with the same numbers, its documented rules give {wanted} (◁)."
            );
        }
    };
    text.into()
}

/// The outcome of a minor iteration.
pub fn outcome(model: &Model, event: &Event) -> String {
    outcome_with(model, event, failures::describe)
}

/// The outcome of a minor iteration on one line: the first part of a long failure.
pub fn note(model: &Model, event: &Event) -> String {
    outcome_with(model, event, first_part)
}

/// The outcome of a minor iteration, with failures described by `failed`.
fn outcome_with(model: &Model, event: &Event, failed: fn(&Model, &Failure) -> String) -> String {
    let at = position_in(model, event.position);
    if !event.words.iteration.is_empty() {
        return format!("{at}: {}", event.words.iteration);
    }
    match &event.outcome {
        Outcome::Minor if together(event, Rule::Found) => {
            format!("{at}: found a consistent state; it is checked next")
        }
        Outcome::Minor if together(event, Rule::Pivots) => format!("{at}: {}", pivot(model, event)),
        Outcome::Minor if together(event, Rule::Sweeps) => {
            format!("{at}: {}", accuracy::sweeps(event))
        }
        Outcome::Minor => match changes(model, event).as_str() {
            // For an attached solver, other changes are unknown.
            "" if event
                .nodes
                .iter()
                .all(|node| node.t_max_used == node.t_max || node.t_max.is_nan()) =>
            {
                format!("{at}: no mode changes")
            }
            "" => format!("{at}: modes settled, T_max changes"),
            changes => format!("{at}: {changes}"),
        },
        Outcome::Damped {
            cycle: c,
            target: aim,
        } => format!(
            "{at}: {}; damped: solves load {} first",
            failed(model, &Failure::Cycle(c.clone())),
            shortest(*aim)
        ),
        Outcome::StrategyChange { why, to, frozen } => format!(
            "{at}: {}; continues with strategy {}{}",
            failed(model, why),
            to.name(),
            if *frozen {
                " and frozen contact geometry"
            } else {
                ""
            }
        ),
        Outcome::Cut { why, size } => format!(
            "{at}: {}; the increment is cut to {}",
            failed(model, why),
            sig6(*size)
        ),
        Outcome::WholeIncrement { why, size } => format!(
            "{at}: {}; no equilibrium is near, so the whole increment {} is solved",
            failed(model, why),
            sig6(*size)
        ),
        Outcome::PathCorner { why, changes } => {
            let changes: Vec<String> = changes
                .iter()
                .map(|change| {
                    let (name, to) = (slave(model, change.contact), mode(change.to));
                    format!("{name} is {to}")
                })
                .collect();
            format!(
                "{at}: {}; the path has a corner, after which {}",
                failed(model, why),
                changes.join(", ")
            )
        }
        Outcome::HeldBack { why, stiffness } => {
            let why = why.as_ref().map_or_else(
                || "a node slides too far or against its force".to_owned(),
                |why| failed(model, why),
            );
            format!(
                "{at}: {why}; the major iteration restarts with slip stiffness {}",
                sig4(*stiffness)
            )
        }
        Outcome::Motion(moves) => format!("{at}: {}", self::moves(model, moves, failed)),
        Outcome::Fallback { why, by, size } => format!(
            "{at}: {}; tries {} (size {})",
            failed(model, why),
            by.words(),
            sig6(*size)
        ),
        Outcome::Major { after, settled } => {
            let how = match (
                settled,
                event
                    .nodes
                    .iter()
                    .any(|node| node.decision.rule == Rule::CornerReleases),
            ) {
                (true, false) => "minor iterations settled".to_owned(),
                (true, true) => format!("minor iterations settled, then {}", changes(model, event)),
                (false, _) => "minor iterations stopped before settling".to_owned(),
            };
            // An attached solver may report neither.
            let residual = after.relative.max(after.interface);
            let numbers = [
                (!residual.is_nan()).then(|| format!("residual {}", sig4(residual))),
                (!after.limit.is_nan()).then(|| format!("limit {}", sig2(after.limit))),
            ];
            let numbers = joined(numbers.into_iter().flatten(), ", ");
            if numbers.is_empty() {
                format!("{at}: {how}")
            } else {
                format!("{at}: {how}; {numbers}")
            }
        }
        Outcome::Refused { why, .. } => format!(
            "{at}: refused: {}; continues, counting net slip from here on",
            judged::finding(model, why)
        ),
        Outcome::Increment {
            after, found, last, ..
        } => {
            let found = found
                .map(|by| format!(", found with {}", by.words()))
                .unwrap_or_default();
            let end = if *last { jumped::end(model, event) } else { "" };
            let left = accuracy::left(after).or_else(|| accuracy::settled(event));
            let left = left.map(|left| format!("; {left}")).unwrap_or_default();
            format!(
                "{at}: load {} accepted{found}{}{left}{end}",
                shortest(event.load_factor),
                reservations(model, event)
            )
        }
        Outcome::Failed(failure) => format!("{at}: {}", failed(model, failure)),
    }
}

/// The kind of an event that kept a run going after a failure, for counting; `None` for other events.
pub fn recovery(outcome: &Outcome) -> Option<&'static str> {
    Some(match outcome {
        Outcome::Damped { .. } => "increment damped",
        Outcome::StrategyChange { .. } => "strategy changed",
        Outcome::Cut { .. } => "increment cut",
        Outcome::WholeIncrement { .. } => "whole increment solved",
        Outcome::PathCorner { .. } => "corner of the path found",
        Outcome::Fallback { .. } => "fallback tried",
        Outcome::Refused { .. } => "state refused",
        Outcome::Motion(MotionEvent::DynamicStart { .. }) => "damped motion started",
        _ => return None,
    })
}

/// The bodies that failed to be held in an event that kept a run going.
pub fn loose_bodies(outcome: &Outcome) -> Vec<&str> {
    let (Outcome::StrategyChange { why, .. }
    | Outcome::Cut { why, .. }
    | Outcome::Fallback { why, .. }) = outcome
    else {
        return Vec::new();
    };
    let Failure::Singular(Singular::Rigid { motions }) = why else {
        return Vec::new();
    };
    motions.iter().map(|motion| motion.body.as_str()).collect()
}

/// Describes a damped motion.
fn moves(model: &Model, moves: &MotionEvent, failed: fn(&Model, &Failure) -> String) -> String {
    match moves {
        MotionEvent::DynamicStart { why, load } => format!(
            "{}; no equilibrium is near that of load {}: a damped motion starts there",
            failed(model, why),
            shortest(*load)
        ),
        MotionEvent::Step { motion, number } => {
            format!("step {number} of a damped motion, by {}", sig4(*motion))
        }
        MotionEvent::Slower(slow) => {
            let why = match slow {
                SmallerStepReason::Failed(why) => failed(model, why),
                SmallerStepReason::Far { motion } => {
                    format!("the step would move by {}", sig4(*motion))
                }
                SmallerStepReason::Unstable => "the step would end in an unstable state".to_owned(),
            };
            format!("{why}; the damped motion continues with a smaller step")
        }
    }
}

/// Whether all nodes were treated together, by this rule.
fn together(event: &Event, rule: Rule) -> bool {
    event.nodes.iter().any(|node| node.decision.rule == rule)
}

/// A pivot of Lemke's method: the bound reached, and the remaining relaxation.
fn pivot(model: &Model, event: &Event) -> String {
    let tests = |s: usize| event.nodes[s].decision.tests;
    let what = (0..event.nodes.len()).find_map(|s| {
        let what = match tests(s)[1]?.tested {
            TestedQuantity::Gap => "the gap closed",
            TestedQuantity::NormalForce => "F_n vanished",
            TestedQuantity::ShearForce => "the friction limit was reached",
            TestedQuantity::Slip | TestedQuantity::Room => "the slip ended",
            _ => return None,
        };
        Some(format!("at {} {what}", slave(model, s)))
    });
    let cover = (0..event.nodes.len()).find_map(|s| Some(tests(s)[0]?.value));
    let left = cover
        .map(|z| format!("relaxed by z = {}", sig4(z)))
        .unwrap_or_default();
    match what {
        Some(what) => format!("pivot: {what}; {left}"),
        None => format!("pivot; {left}"),
    }
}

/// Objections to an accepted increment; empty if there are none.
pub fn reservations(model: &Model, event: &Event) -> String {
    let Outcome::Increment {
        unsettled,
        marked,
        jumped,
        unstable,
        motion,
        left_range,
        ..
    } = &event.outcome
    else {
        return String::new();
    };
    let mut text = match unsettled {
        0 => String::new(),
        n => format!(
            ", but {} of minor iterations did not settle",
            counted(*n, "loop")
        ),
    };
    let defied = |rule: fn(Rule) -> bool| -> Vec<&str> {
        (0..event.nodes.len())
            .filter(|&s| {
                let decision = &event.nodes[s].decision;
                decision.wanted != decision.next && rule(decision.rule)
            })
            .map(|s| slave(model, s))
            .collect()
    };
    let otherwise = defied(|rule| rule == Rule::Theirs);
    if !otherwise.is_empty() {
        text += &format!(
            ", but the solver's documented rules give another mode at {}",
            otherwise.join(", ")
        );
    }
    let defied = defied(|rule| rule != Rule::Theirs);
    if !defied.is_empty() {
        text += &format!(
            ", but Table 2 rejects the mode held at {}",
            defied.join(", ")
        );
    }
    if let Some(found) = marked {
        text += &format!(", but {}", judged::finding(model, found));
    }
    if let Some(point) = left_range {
        text += &format!(", but {}", strain::left(model, point));
    }
    text += &jumped::reservation(*jumped, unstable.as_ref());
    if let Some(motion) = motion {
        text += &format!(
            ", after a damped motion of {} from the equilibrium at load {} (energy {} dissipated)",
            counted(motion.steps, "step"),
            shortest(motion.from),
            sig6(motion.dissipated)
        );
    }
    text
}

fn changes(model: &Model, event: &Event) -> String {
    let all: Vec<usize> = (0..event.nodes.len())
        .filter(|s| event.nodes[*s].decision.changes())
        .collect();
    // Three changes fit in the space of two and a count.
    let most = if all.len() == 3 { 3 } else { 2 };
    first_of(
        all.iter().map(|&s| {
            let d = &event.nodes[s].decision;
            format!("{} {} → {}", slave(model, s), mode(d.before), mode(d.next))
        }),
        most,
        ", ",
    )
}

/// Describes an intervention.
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
        Intervention::Assume(starts) => {
            format!(
                "the next minor iteration starts with {}",
                names::starts(model, starts, usize::MAX)
            )
        }
        Intervention::Release { slave: s } => format!("{} follows Table 2 again", slave(model, *s)),
        Intervention::Increment(increment) if model.control == Control::Arc => format!(
            "increment {}; the next step along the arc changes in the same proportion",
            shortest(*increment)
        ),
        Intervention::Increment(increment) => {
            format!(
                "the increment from the last equilibrium has size {}",
                shortest(*increment)
            )
        }
        Intervention::Friction(f) => format!(
            "friction angle {} degrees, cohesion {}",
            sig6(f.angle),
            sig6(f.cohesion)
        ),
        Intervention::Frictions(all) => {
            let values = |of: fn(&stickslip_core::Friction) -> f64| {
                let mut values: Vec<String> = all.iter().map(|one| sig6(of(one))).collect();
                values.dedup();
                few(values, 3)
            };
            let (angle, cohesion) = (values(|one| one.angle), values(|one| one.cohesion));
            format!("friction angle {angle} degrees, cohesion {cohesion}")
        }
        Intervention::Settings(_) => "settings changed".into(),
        Intervention::Parameter { name, value } => format!("{name} set to {value}"),
    }
}

/// Where and why a run ended, and the last load with a valid state. `at` and `load` belong to the failed minor
/// iteration, and `state` is the state after it.
pub fn failure(model: &Model, state: &State, at: Position, load: f64, failure: &Failure) -> String {
    let again = match at.attempt {
        0 | 1 => String::new(),
        n => format!(" in attempt {n}"),
    };
    format!(
        "increment {} (load {}){again}, major {}, minor {}: {}; {}",
        at.increment,
        shortest(load),
        at.major,
        at.minor,
        failures::describe(model, failure),
        sound(at, state)
    )
}

/// The last equilibrium of a failed run.
pub fn sound(at: Position, state: &State) -> String {
    let accepted = shortest(state.start.load_factor);
    match at.increment {
        0 | 1 => format!("no state found after the start (load {accepted})"),
        n => format!(
            "the last equilibrium is increment {}, load {accepted}",
            n - 1
        ),
    }
}
