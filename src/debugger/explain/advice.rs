//! Possible remedies for a kind of failure, in order: the list that the diagnosis ([`super::page`]) and the
//! remedies ([`super::remedies`]) try.
//!
//! A remedy is shown as advice only if it helped in a trial. Remedies that need a person are listed as not
//! tried.

use super::remedy::{
    ADJUST, BLOCK, CONSISTENT_GEOMETRY, CONSISTENT_LIMIT, CUT_AT_JUMPS, DAMP, LADDER,
    MOVE_AT_JUMPS, NEWTON, RAMP, Remedy, RemedyKind, SEARCH, STRESS_RESIDUAL, TOUCH_AT_START,
};
use super::surface_end::ending;
use stickslip_core::model::{AtCycle, Geometry, ResidualMethod, SearchBudget, SearchMode};
use stickslip_core::{BoundUpdate, Failure, Mode, Model, Singular, State, Strategy};
use stickslip_scene::Spec;
use stickslip_scene::gaps::turned;

/// What to try against a failure, in order of preference; `spec` is the scene as written by its author, from which a finer mesh can
/// be generated.
pub fn advice(model: &Model, state: &State, failure: &Failure, spec: Option<&Spec>) -> Vec<Remedy> {
    let possible = |kinds: Vec<RemedyKind>| -> Vec<Remedy> {
        let kinds = kinds.into_iter();
        kinds
            .filter_map(|kind| Remedy::from_kind(kind, model, state))
            .collect()
    };
    let turned = turned(model).into_iter();
    let reverse = possible(
        turned
            .map(|found| RemedyKind::Reverse(found.surface))
            .collect(),
    );
    // Against a wrong side nothing else helps.
    if !reverse.is_empty() {
        return reverse;
    }
    let ends = ending(model, state).into_iter().map(RemedyKind::PastEnds);
    let mut kinked: Vec<usize> = state
        .nodes
        .iter()
        .filter(|node| node.mode != Mode::Free && refines(failure))
        .filter_map(|node| Some(node.spot?.surface))
        .collect();
    kinked.sort_unstable();
    kinked.dedup();
    let smooth = kinked.into_iter().map(RemedyKind::Smooth);
    let rest = ends.chain(kinds(state, failure)).chain(smooth).collect();
    let finer = spec.filter(|_| refines(failure)).map(Remedy::finer);
    let (first, last) = match Remedy::law(model, state, failure) {
        Some((law, true)) => (Some(law), None),
        law => (None, law.map(|(law, _)| law)),
    };
    possible(vec![RAMP, ADJUST])
        .into_iter()
        .chain(first)
        .chain(possible(rest))
        .chain(finer)
        .chain(last)
        .collect()
}

/// Whether a finer mesh can help against a failure.
fn refines(failure: &Failure) -> bool {
    match failure {
        Failure::CutTooOften { last, .. } => refines(last),
        failure => matches!(
            failure,
            Failure::MajorCycle(_)
                | Failure::MajorLimit { .. }
                | Failure::Diverged { .. }
                | Failure::Inverted(_)
                | Failure::Refused(_)
        ),
    }
}

/// What can be tried, in order of preference; those without effect are removed later.
fn kinds(state: &State, failure: &Failure) -> Vec<RemedyKind> {
    let settings = &state.controls.settings;
    let climbs = settings.strategy == Strategy::Ladder;
    // The ladder has tried smaller increments itself.
    let parts: &[RemedyKind] = if climbs {
        &[RemedyKind::Part(0.37), RemedyKind::Part(0.1)]
    } else {
        &[LADDER, RemedyKind::Part(0.5), RemedyKind::Part(0.1)]
    };
    let mut all = Vec::new();
    let mut add = |wanted: bool, kinds: &[RemedyKind]| {
        if wanted {
            all.extend_from_slice(kinds);
        }
    };
    let lags = settings.t_max == BoundUpdate::Lagged;
    let frozen = state.settings().geometry == Geometry::Frozen;
    let searches = climbs && settings.search == SearchBudget::Mode(SearchMode::Off);
    match failure {
        Failure::Cycle(_) => {
            add(!climbs, &[LADDER]);
            add(lags, &[CONSISTENT_LIMIT]);
            add(settings.at_cycle != AtCycle::Damp, &[DAMP]);
            add(true, &[RemedyKind::Part(0.5), RemedyKind::Part(0.1)]);
        }
        Failure::MinorLimit { .. } => {
            add(lags, &[CONSISTENT_LIMIT]);
            add(true, &[RemedyKind::MoreMinors]);
            add(true, parts);
        }
        Failure::MajorCycle(_) => {
            add(searches, &[SEARCH]);
            add(frozen, &[CONSISTENT_GEOMETRY]);
            add(true, parts);
            add(true, &[TOUCH_AT_START]);
        }
        Failure::MajorLimit { .. } => {
            add(frozen, &[CONSISTENT_GEOMETRY]);
            let accumulates = settings.residual == ResidualMethod::Accumulate;
            add(accumulates, &[STRESS_RESIDUAL]);
            add(searches, &[SEARCH]);
            add(true, &[RemedyKind::MoreMajors]);
            add(true, parts);
        }
        Failure::Singular(Singular::Rigid { .. }) => {
            add(
                true,
                &[
                    RemedyKind::Start(Mode::Fixed),
                    RemedyKind::Start(Mode::Sliding),
                ],
            );
            add(!climbs, &[LADDER]);
        }
        Failure::Singular(Singular::Unexplained) | Failure::Diverged { .. } => {
            add(frozen, &[CONSISTENT_GEOMETRY]);
            add(searches, &[SEARCH]);
            add(true, parts);
        }
        Failure::LadderEnded { .. } | Failure::NotFound(_) => {
            // If the problem scales with the load, a smaller increment is the same problem.
            add(
                !matches!(failure, Failure::LadderEnded { scales: true, .. }),
                parts,
            );
            add(searches, &[SEARCH]);
            add(climbs, &[NEWTON, BLOCK]);
        }
        Failure::Refused(_) => {
            add(searches, &[SEARCH]);
            add(true, parts);
            add(true, &[TOUCH_AT_START, CONSISTENT_LIMIT]);
        }
        // Its attempts have cut the increment and searched.
        Failure::CutTooOften { last, .. } => {
            all = kinds(state, last);
            all.retain(|kind| *kind != SEARCH && !matches!(kind, RemedyKind::Part(_)));
        }
        Failure::BranchJump { .. } => add(true, &[CUT_AT_JUMPS, MOVE_AT_JUMPS]),
        Failure::NoAnswer { .. }
        | Failure::PathReversal
        | Failure::ZeroMeasure
        | Failure::NoRest { .. }
        | Failure::RoundOff { .. }
        | Failure::Inverted(_)
        | Failure::OverConstrained { .. } => {}
        // An attached solver has its own method and reports its own remedies.
        Failure::Reported { .. } => {}
    }
    all
}

/// Advice for a cycle of modes.
pub(super) const FORCE_THIRD_MODE: &str = "forcing a node into its third mode (m)";
/// Advice for loose bodies, useless where no modes hold them.
pub(super) const START_TOUCHING: [&str; 2] = [
    "slave nodes that start sliding or fixed (slaves, start)",
    "slave nodes that start fixed (slaves, start)",
];

/// What the user can do in the scene's file or in the debugger.
pub(super) fn by_hand(state: &State, failure: &Failure) -> &'static [&'static str] {
    match failure {
        Failure::Cycle(_) => &[FORCE_THIRD_MODE],
        Failure::NoAnswer { .. } => &[
            "other loads or friction",
            "a prescribed displacement instead of a load",
        ],
        Failure::LadderEnded { .. }
        | Failure::Refused(_)
        | Failure::NotFound(_)
        | Failure::MinorLimit { .. }
        | Failure::MajorCycle(_)
        | Failure::MajorLimit { .. }
        | Failure::Diverged { .. } => &[],
        Failure::Singular(Singular::Rigid { .. }) => {
            if state.nodes.iter().any(|node| node.mode == Mode::Free) {
                &[
                    "a support against that motion",
                    START_TOUCHING[0],
                    "a prescribed displacement instead of the load, until first contact",
                ]
            } else {
                &["a support against that motion", START_TOUCHING[1]]
            }
        }
        Failure::Singular(Singular::Unexplained) => {
            &["past a limit point, a prescribed displacement instead of the load"]
        }
        Failure::Reported { .. } => &[
            "forcing a node that still changes (t) into another mode (m)",
            "another increment size, if the solver supports it",
        ],
        Failure::Inverted(_) => &["a load or prescribed motion that compresses the element less"],
        Failure::NoRest { .. } => &["a support or surface that stops the motion"],
        Failure::CutTooOften { .. } => {
            &["stepping through its last attempts, to see the states it alternates between"]
        }
        Failure::BranchJump { .. } => &["a prescribed displacement instead of the load"],
        Failure::PathReversal => &[
            "another path measure: history.arc.monitor or history.arc.slip",
            "a smaller history.arc.least",
        ],
        Failure::ZeroMeasure => &["another path measure: history.arc.monitor or history.arc.slip"],
        Failure::RoundOff { .. } => {
            &["stiffnesses of similar size: a far smaller stiffness still acts as rigid"]
        }
        Failure::OverConstrained { .. } => &[
            "moving the node out of the surface",
            "removing its support",
            "reversing the surface (reverse)",
        ],
    }
}
