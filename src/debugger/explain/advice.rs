//! Possible remedies for a failure, ordered by its kind alone: the list that the diagnosis ([`super::page`]) and the
//! remedies ([`super::remedies`]) try.
//!
//! A remedy is shown as advice only after a trial in which it helped. Remedies that need a person are listed as not tried.

use super::remedy::{Kind, Remedy};
use stickslip_core::linear::singular::Singular;
use stickslip_core::model::{
    AtCycle, BoundUpdate, Geometry, InitialGaps, Jumps, Mode, Model, ResidualMethod, Strategy,
};
use stickslip_core::step::event::Failure;
use stickslip_core::step::state::State;

/// Something to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Advice {
    /// It can be tried from the state.
    Remedy(Remedy),
    /// It is done in the scene's file, or by hand.
    ByHand(&'static str),
    /// A finer mesh: what is tried from the start, where there is a scene to make one of.
    Finer,
}

/// What a finer mesh is called where it was not tried.
pub const FINER: &str = "a finer mesh, with smaller kinks (refine=2)";

/// What to do about a failure, best first.
pub fn advice(model: &Model, state: &State, failure: &Failure) -> Vec<Advice> {
    let remedies = kinds(state, failure)
        .into_iter()
        .filter_map(|kind| Remedy::of(kind, model, state))
        .map(Advice::Remedy);
    let by_hand = by_hand(model, state, failure).iter().copied();
    let by_hand = by_hand.map(Advice::ByHand);
    // Nothing that can be tried does what a support, or another load, does.
    let scene_first = matches!(
        failure,
        Failure::Singular(Singular::Rigid { .. })
            | Failure::NoAnswer { .. }
            | Failure::RoundOff { .. }
            | Failure::OverConstrained { .. }
            | Failure::Leapt { .. }
            | Failure::DoubledBack
            | Failure::Unmoved
    );
    let finer = refines(failure).then_some(Advice::Finer);
    let gaps = [InitialGaps::Ramp, InitialGaps::Adjust]
        .into_iter()
        .filter_map(|gaps| Remedy::of(Kind::Gaps(gaps), model, state))
        .map(Advice::Remedy);
    let rest: Vec<Advice> = match scene_first {
        true => by_hand.chain(remedies).collect(),
        false => remedies.chain(finer).chain(by_hand).collect(),
    };
    let law = Remedy::law(model, state, failure);
    let (first, last) = match law {
        Some((law, true)) => (Some(law), None),
        law => (None, law.map(|(law, _)| law)),
    };
    let (first, last) = (first.map(Advice::Remedy), last.map(Advice::Remedy));
    gaps.chain(first).chain(rest).chain(last).collect()
}

/// Whether a finer mesh can help against a failure.
fn refines(failure: &Failure) -> bool {
    matches!(failure, Failure::MajorCycle(_) | Failure::Refused(_))
}

/// What can be tried, best first; what would change nothing is left out later.
fn kinds(state: &State, failure: &Failure) -> Vec<Kind> {
    let settings = &state.controls.settings;
    let climbs = settings.strategy == Strategy::Ladder;
    // The ladder has tried the halves itself.
    let parts: &[Kind] = match climbs {
        true => &[Kind::Part(0.37), Kind::Part(0.1)],
        false => &[
            Kind::Strategy(Strategy::Ladder),
            Kind::Part(0.5),
            Kind::Part(0.1),
        ],
    };
    let mut all = Vec::new();
    let mut add = |wanted: bool, kinds: &[Kind]| {
        if wanted {
            all.extend_from_slice(kinds);
        }
    };
    let lags = settings.t_max == BoundUpdate::Lagged;
    let frozen = settings.geometry == Geometry::Frozen;
    match failure {
        Failure::Cycle(_) => {
            add(!climbs, &[Kind::Strategy(Strategy::Ladder)]);
            add(lags, &[Kind::ConsistentLimit]);
            add(settings.at_cycle != AtCycle::Damp, &[Kind::Damp]);
            add(true, &[Kind::Part(0.5), Kind::Part(0.1)]);
        }
        Failure::MinorLimit { .. } => {
            add(lags, &[Kind::ConsistentLimit]);
            add(true, &[Kind::MoreMinors]);
            add(true, parts);
        }
        Failure::MajorCycle(_) => {
            add(frozen, &[Kind::ConsistentGeometry]);
            add(true, parts);
            add(true, &[Kind::TouchAtStart]);
        }
        Failure::MajorLimit { .. } => {
            add(frozen, &[Kind::ConsistentGeometry]);
            let accumulates = settings.residual == ResidualMethod::Accumulate;
            add(accumulates, &[Kind::OtherResidual]);
            add(true, &[Kind::MoreMajors]);
            add(true, parts);
        }
        Failure::Singular(Singular::Rigid { .. }) => {
            add(
                true,
                &[Kind::Start(Mode::Fixed), Kind::Start(Mode::Sliding)],
            );
            add(!climbs, &[Kind::Strategy(Strategy::Ladder)]);
        }
        Failure::Singular(Singular::Unexplained) | Failure::Diverged { .. } => {
            add(true, parts);
        }
        Failure::LadderEnded { .. } | Failure::NotFound(_) => {
            // Where all scales with the load, a part of it is the same problem.
            add(
                !matches!(failure, Failure::LadderEnded { scales: true, .. }),
                parts,
            );
            let others = [Strategy::Newton, Strategy::Block];
            add(climbs, &others.map(Kind::Strategy));
        }
        Failure::Refused(_) => {
            add(true, parts);
            add(true, &[Kind::TouchAtStart, Kind::ConsistentLimit]);
        }
        Failure::NoAnswer { .. }
        | Failure::Leapt { .. }
        | Failure::DoubledBack
        | Failure::Unmoved
        | Failure::Restless { .. }
        | Failure::RoundOff { .. }
        | Failure::Inverted(_)
        | Failure::CutTooOften { .. }
        | Failure::OverConstrained { .. } => {}
        // Its method is not ours, and what it takes it says itself.
        Failure::Reported { .. } => {}
    }
    all
}

/// What is done in the scene's file, or by hand.
fn by_hand(model: &Model, state: &State, failure: &Failure) -> &'static [&'static str] {
    match failure {
        Failure::Cycle(_) => &["one of the nodes forced to its third mode (m)"],
        Failure::MajorCycle(_) => &["an arc where the kink is a corner of the body"],
        Failure::NoAnswer { .. } => &[
            "other loads or friction",
            "a prescribed displacement instead of a load",
        ],
        Failure::LadderEnded { scales: false, .. } => &["a smaller history.least"],
        Failure::LadderEnded { scales: true, .. }
        | Failure::NotFound(_)
        | Failure::MinorLimit { .. }
        | Failure::MajorLimit { .. }
        | Failure::Diverged { .. } => &[],
        Failure::Singular(Singular::Rigid { .. }) => {
            match state.nodes.iter().any(|node| node.mode == Mode::Free) {
                true => &[
                    "a support against that motion",
                    "slave nodes that start sliding or fixed (slaves, start)",
                    "a prescribed displacement instead of the load, until there is a first touch",
                ],
                false => &[
                    "a support against that motion",
                    "slave nodes that start fixed (slaves, start)",
                ],
            }
        }
        Failure::Singular(Singular::Unexplained) => {
            &["past a limit point, a prescribed displacement instead of the load"]
        }
        Failure::Reported { .. } => &[
            "a node that still changes (t) forced to another mode (m)",
            "another increment, where the solver takes one",
        ],
        Failure::Refused(_) => &["a smaller history.least"],
        Failure::Inverted(_) => &["a load or prescribed motion that presses the element less"],
        Failure::Restless { .. } => &["a support, or a surface, that stops what moves"],
        Failure::CutTooOften { .. } => {
            &["the debugger, to see between which states it goes to and fro"]
        }
        Failure::Leapt { .. } => match model.jumps {
            Jumps::Stop => &[
                "history.jumps=cut, to go on on the other branch",
                "history.jumps=dynamic, for a damped motion to the next equilibrium",
                "a prescribed displacement instead of the load",
            ],
            _ => &["a prescribed displacement instead of the load"],
        },
        Failure::DoubledBack => &[
            "another measure of the path: history.arc.monitor, or history.arc.slip",
            "a smaller history.arc.least",
        ],
        Failure::Unmoved => {
            &["another measure of the path: history.arc.monitor, or history.arc.slip"]
        }
        Failure::RoundOff { .. } => &[
            "stiffnesses that lie closer together: a stiffness many times smaller is as good as rigid",
        ],
        Failure::OverConstrained { .. } => &[
            "the node moved out of the surface",
            "its support removed",
            "the surface reversed (reverse)",
        ],
    }
}
