//! The sentence for each way in which an increment fails.

use crate::explain::cycles::{cycle, major_cycle};
use crate::explain::judged;
use crate::explain::jumped;
use crate::explain::names::slave;
use crate::explain::round_off::reach;
use crate::explain::strain;
use stickslip_core::interface::census;
use stickslip_core::linear::singular::LooseMotion;
use stickslip_core::words::times;
use stickslip_core::{Contact, Failure, Model, Norms, NotFound, RigidMotion, Singular, counted};
use stickslip_scene::{first_of, joined, sig2, sig4};

/// Maximum number of nodes or motions named.
const MOST_NODES: usize = 6;

/// Why an increment failed.
pub fn describe(model: &Model, failure: &Failure) -> String {
    match failure {
        Failure::Cycle(c) => cycle(model, c),
        Failure::Reported { reason, .. } if reason.is_empty() => {
            "the solver failed without giving a reason".into()
        }
        Failure::Reported { reason, .. } => format!("the solver failed: {reason}"),
        Failure::MinorLimit { limit, changing } => {
            let nodes = changing.iter().map(|&s| slave(model, s).to_owned());
            format!(
                "the minor iterations did not settle within {limit}; still changing: {}",
                first_of(nodes, MOST_NODES, ", ")
            )
        }
        Failure::MajorLimit {
            limit,
            relative,
            interface,
        } => format!(
            "no convergence within {limit} major iterations; relative residual {}, interface {}",
            sig4(*relative),
            sig4(*interface)
        ),
        Failure::MajorCycle(round) => major_cycle(model, round),
        Failure::NoAnswer { first, tried } => {
            let none =
                format!("this increment has no consistent state (all {tried} assignments tried)");
            match first {
                None => none,
                Some(first) => format!("{none}; first failure: {}", describe(model, first)),
            }
        }
        Failure::LadderEnded {
            first,
            last,
            scales,
        } => format!(
            "no strategy of the ladder found a consistent state (first failure: {}; last: {}){}",
            describe(model, first),
            describe(model, last),
            if *scales { "; without gaps, the problem scales with the load, so a smaller increment would not help" } else { "" }
        ),
        Failure::NotFound(why) => not_found(model, *why),
        Failure::Singular(Singular::Rigid { motions }) => {
            let bodies = motions.chunk_by(|a, b| a.body == b.body).map(|motions| body_motions(model, motions));
            format!("unrestrained rigid motion: {}", first_of(bodies, MOST_NODES, "; "))
        }
        Failure::Singular(Singular::Unexplained) => {
            "the equations are singular although every body is held: a limit point, or redundant constraints".into()
        }
        Failure::Diverged { relative } => {
            format!("diverged, relative residual {}", sig4(*relative))
        }
        Failure::Refused(found) => {
            format!("refused: {}", judged::finding(model, found))
        }
        Failure::Inverted(point) => {
            format!("refused: {}", strain::inverted(model, point))
        }
        Failure::CutTooOften { slave: s, cuts, last } => format!(
            "the increment was cut {} because of {}: {}",
            times(*cuts),
            slave(model, *s),
            describe(model, last)
        ),
        Failure::NoRest { steps } => {
            format!("the damped motion still moves after {}", counted(*steps, "step"))
        }
        Failure::BranchJump {
            motion,
            predicted,
            unstable,
        } => jumped::jump(*motion, *predicted, *unstable),
        Failure::PathReversal => {
            "the path control would turn back along the previous increment".into()
        }
        Failure::ZeroMeasure => {
            "the path measure (history.arc) does not change with the load, so the increment has no size".into()
        }
        Failure::RoundOff { noise } => format!(
            "double precision is not sufficient for this scene: the round-off of its stiffest forces is {} of the loads; the limit is {:.0e}",
            sig2(*noise),
            Norms::LOUDEST
        ),
        Failure::OverConstrained { slave: s, gap } => format!(
            "{} penetrates by {}, but neither the node nor its surface can move",
            slave(model, *s),
            sig4(-gap)
        ),
    }
}

/// Why pivoting or the census found no state.
fn not_found(model: &Model, why: NotFound) -> String {
    match why {
        NotFound::Ray => {
            "pivoting ended on a ray from every start, without a consistent state".into()
        }
        NotFound::Astray { pivots } => {
            format!("pivoting stopped after {pivots} pivots; there may still be a consistent state")
        }
        NotFound::NoStart => {
            "pivoting cannot start: the equations of all known starts are singular".into()
        }
        NotFound::Unsettled { sweeps, error } => {
            let left = error.map(|error| format!("; the natural map of the forces is {}", sig2(error)));
            format!(
                "{} of Gauss-Seidel do not converge{}",
                counted(sweeps, "sweep"),
                left.unwrap_or_default()
            )
        }
        NotFound::TooMany { nodes } => format!(
            "{nodes} nodes can touch, too many for a census (limit {})",
            census::MOST
        ),
        NotFound::Loose => {
            "no census is possible: the equations of the nodes that cannot touch are singular".into()
        }
        NotFound::NotCondensed => {
            "the bodies cannot be condensed to the interface, so pivoting and census are not possible".into()
        }
        NotFound::Unconfirmed { states } => {
            let coheres = |contact: &Contact| contact.friction.cohesion != 0.0;
            let why = if model.contacts.iter().any(coheres) {
                ": pivoting lets cohesion act on open nodes, and Table 2 does not"
            } else {
                ""
            };
            let found = counted(states, "state");
            format!("{found} found, but not confirmed by a minor iteration{why}")
        }
    }
}

/// The motions of one body.
fn body_motions(model: &Model, motions: &[RigidMotion]) -> String {
    let mut before = "";
    let each = motions.iter().map(|rigid| {
        let (verb, pair) = match rigid.motion {
            LooseMotion::Translation(along) => ("move along", pair(along, 1.0)),
            LooseMotion::Rotation(about) => ("rotate about", pair(about, reach(model))),
        };
        let verb = if std::mem::replace(&mut before, verb) == verb {
            String::new()
        } else {
            format!("{verb} ")
        };
        format!("{verb}{pair}")
    });
    let each = joined(each, " and ");
    format!("body {} can {}", motions[0].body, each)
}

/// A direction, or a point of a scene of this size, as text; components that are round-off are 0.
pub(super) fn pair(components: [f64; 2], size: f64) -> String {
    /// Relative to the size: a center of rotation is a quotient of small rates.
    const ROUND_OFF: f64 = 1e-9;
    let [x, y] = components.map(|x| sig4(if x.abs() < ROUND_OFF * size { 0.0 } else { x }));
    format!("({x}, {y})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_off_is_relative_to_the_size() {
        assert_eq!(pair([2.0, -2.22e-16], 2.0), "(2, 0)");
        assert_eq!(pair([3e-6, 2e-15], 1e-5), "(3e-6, 0)");
    }
}
