//! The limit load: where a body becomes loose, and why (friction is used up, or no contact presses against the motion any more),
//! or where the equilibrium path has its largest load.
//!
//! **End of a surface.** A node gets behind its surface around an end of it, or slides off it ([`super::surface_end`]).
//!
//! **Largest load.** From the last equilibrium, follows the path by arc length until the load falls, the path ends at a change of
//! contacts, or every further step inverts an element.
//!
//! **Lost equilibrium.** If the path shows no limit, a damped motion may leave the last equilibrium ([`super::moves_away`]).
//!
//! **Loose body.** Repeats the failed increment in smaller steps ([`super::load_limit_probe`]). In the last equilibrium, computes the remaining
//! resistance of each contact of the body against the free motion. With v the relative velocity, friction resists with at
//! most tan φ F_n + c per |v_t|, of which |F_t| is used; an opening contact yields F_n per v_n until its force is zero.
//!
//! A body that no load holds has too little friction if the loads alone show it.
//!
//! A deformable surface can hold a body for a while after all of its contacts slide. Accepted increments are therefore also
//! checked directly ([`body_without_friction`]).

use super::load_limit_probe::{LoadLimitProbe, reach};
use super::moves_away::moves_away;
use super::remedies::{self, BUDGET, RemedyTrial, attempt_within};
use super::remedy::{LADDER, Remedy, RemedyInput};
use super::restart::{FailedLoad, TrialEnd};
use super::rigid_motion::{BodyMotion, is_held_by_contacts_only};
use super::surface_end::passed_end;
use super::try_list::helps;
use super::{names, strain};
use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::model::Geometry;
use stickslip_core::plane::max_abs;
use stickslip_core::step::arc_state::Change;
use stickslip_core::{
    Body, ContactRecord, Failure, Intervention, Mode, Model, Outcome, PointDeformation,
    RigidMotion, RunEnd, SearchBudget, SearchMode, Settings, Singular, State, Stepper, Strategy,
    Until, counted, strategy,
};
use stickslip_scene::{first_of, sig4, sig6};

/// Fraction of the friction or of the contact forces below which nothing is left.
const LEFT: f64 = 1e-2;

/// First step along the path, as a fraction of the scene's length.
const FIRST_STEP: f64 = 1e-4;
/// Maximum number of increments along the path, and of minor iterations in all.
const MOST_STEPS: u32 = 40;
const MOST_MINORS: u64 = 2000;
/// Fall of the load, as a fraction of the largest of the history, above the errors of equilibrium.
const FALL: f64 = 1e-6;

/// An accepted state on a path.
struct PathPoint {
    /// Displacements.
    u: Arc<Vec<f64>>,
    /// Direction of the path there.
    direction: Arc<Vec<f64>>,
    /// Modes of the contacts.
    modes: Vec<Mode>,
}

impl PathPoint {
    /// Whether these displacements are farther along the path.
    fn is_before(&self, u: &[f64]) -> bool {
        let moved = u.iter().zip(self.u.iter()).map(|(u, from)| u - from);
        let along = self.direction.iter().zip(moved);
        along.map(|(c, moved)| c * moved).sum::<f64>() > 0.0
    }

    /// Whether a contact that slid sticks now. Behind a corner the path may turn by more than a right angle; on the way back, contacts
    /// that slid stick.
    fn sticks(&self, now: &State) -> bool {
        let mut both = self.modes.iter().zip(&now.nodes);
        both.any(|(before, now)| (*before, now.mode) == (Mode::Sliding, Mode::Fixed))
    }
}

/// Maximum number of minor iterations to the failure of the ladder.
const MOST_OF_LADDER: u32 = 8000;

/// How the load on a path stops rising.
enum PathEnd {
    /// It falls while the displacements go on.
    Falls,
    /// These contacts change, and no modes continue the path.
    Ends(Arc<Vec<Change>>),
    /// Every step inverts an element.
    Inverts(PointDeformation),
}

/// The largest load on the path from the last equilibrium, and how it ends. `None` if it does not end within [`MOST_STEPS`]
/// increments, or if the path reaches the load of the failed increment. The stepper's final state is unspecified.
fn largest_load(
    stepper: &mut Stepper,
    state: &State,
    stop: &dyn Fn() -> bool,
) -> Option<(f64, PathEnd)> {
    let model = stepper.model().clone();
    let mut along = state.along_path(&model, FIRST_STEP * model.length)?;
    // The tangent does not change the states on the path.
    Arc::make_mut(&mut along.controls).settings.geometry = Geometry::Consistent;
    let ahead = along.way.as_ref()?.ahead;
    let largest = max_abs(&model.path);
    let (mut best, mut steps) = (state.start.load_factor, 0);
    let mut last: Option<PathPoint> = None;
    let mut behind_corner = false;
    stepper.restore(&along);
    let until = Until::end().minors(MOST_MINORS).interrupted_by(stop);
    let end = stepper.drive(until, |stepper| {
        let jumped = match stepper.event().outcome {
            Outcome::Increment { jumped, .. } => jumped,
            Outcome::PathCorner { .. } | Outcome::Cut { .. } => {
                behind_corner = matches!(stepper.event().outcome, Outcome::PathCorner { .. });
                return ControlFlow::Continue(());
            }
            _ => return ControlFlow::Continue(()),
        };
        let turned = std::mem::take(&mut behind_corner);
        let now = stepper.state();
        let (load, u) = (now.start.load_factor, now.start.u.clone());
        let onwards = last
            .take()
            .map(|last| last.is_before(&u) || turned && !last.sticks(now));
        last = now.way.as_ref().map(|way| PathPoint {
            u,
            direction: way.last.clone(),
            modes: now.nodes.iter().map(|node| node.mode).collect(),
        });
        steps += 1;
        let reaches = (load - state.load_factor) * ahead > 0.0;
        if jumped || reaches || steps > MOST_STEPS || onwards == Some(false) {
            return ControlFlow::Break(false);
        }
        if (best - load) * ahead > FALL * largest {
            // An increment along the tangent, along which the load rises, has passed the maximum if it ends below its start: in the
            // same modes, or in those behind the corner ahead. In others the path may lead back.
            let changes = now.way.as_ref().map(|way| way.next.clone());
            let mut both = now.nodes.iter().zip(&state.start.nodes).enumerate();
            let is_ahead = both.all(|(contact, (now, start))| {
                let ahead = |change: &Change| (change.contact, change.to) == (contact, now.mode);
                now.mode == start.mode || changes.iter().flat_map(|c| c.iter()).any(ahead)
            });
            let has_risen = best != state.start.load_factor;
            return ControlFlow::Break(has_risen || is_ahead);
        }
        if (load - best) * ahead > 0.0 {
            best = load;
        }
        ControlFlow::Continue(())
    });
    let way = stepper.state().way.as_ref()?;
    let how = match end {
        RunEnd::Stopped(true) => PathEnd::Falls,
        RunEnd::Failed(Failure::PathReversal) if way.turned => PathEnd::Ends(way.next.clone()),
        RunEnd::Failed(Failure::Inverted(point)) => PathEnd::Inverts(point),
        _ => return None,
    };
    Some((best, how))
}

/// Describes the largest load on a path.
fn words((load, how): &(f64, PathEnd), model: &Model) -> String {
    let load = sig6(*load);
    match how {
        PathEnd::Falls => format!(
            "limit load: equilibrium exists on this path up to load {load}; beyond it the load falls along the path"
        ),
        PathEnd::Ends(changes) => {
            let change = |change: &Change| {
                let [from, to] = [change.from, change.to].map(Mode::word);
                format!("{} {from} → {to}", names::slave(model, change.contact))
            };
            format!(
                "limit load: the equilibrium path ends at load {load}, where modes change ({}); no state was found beyond it",
                first_of(changes.iter().map(change), 3, ", ")
            )
        }
        PathEnd::Inverts(point) => format!(
            "limit load: equilibrium exists on this path up to load {load}; beyond it every step tried inverts {}",
            strain::place(model, point)
        ),
    }
}

/// Resistance of the remaining contacts against a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Resistance {
    /// Available and used friction (power).
    friction: [f64; 2],
    /// Contact forces that the motion removes (power), and their magnitude over the same velocities.
    opening: [f64; 2],
}

/// Repeats an increment whose strategy does not cut it with the ladder, without its search: the state and failure in which the ladder
/// ends, or the minor iterations in which it reaches the load. `None` if it does neither within the limit.
fn with_ladder(
    stepper: &mut Stepper,
    state: &State,
    stop: &dyn Fn() -> bool,
) -> Option<Result<u64, (State, Failure)>> {
    let settings = Settings {
        strategy: Strategy::Ladder,
        search: SearchBudget::Mode(SearchMode::Off),
        ..state.controls.settings
    };
    let ladder = Remedy {
        kind: LADDER,
        label: String::new(),
        how: RemedyInput::Listed,
        first: vec![Intervention::Settings(settings)],
    };
    stepper.restore(&state.attempt_again());
    let target = FailedLoad::new(state);
    let run = remedies::run(stepper, target, &ladder, MOST_OF_LADDER, stop)?;
    match run.end {
        TrialEnd::Converged => Some(Ok(run.minors.into())),
        TrialEnd::Failed(failure) => Some(Err((stepper.state().clone(), failure))),
        _ => None,
    }
}

/// Why a load is not reached.
pub enum LoadEnd {
    /// Equilibrium ends before it.
    Limit(String),
    /// The strategy does not find the state that the ladder finds, in this many minor iterations.
    Strategy(u64),
}

/// The cause in [`LoadEnd::Strategy`]; `is_tried` if a trial shows it as well.
pub fn of_strategy(minors: u64, is_tried: bool) -> String {
    // Otherwise the trial of the ladder would contradict this.
    let beyond = match !is_tried && minors > u64::from(BUDGET) {
        true => format!("; a remedy's trial stops after {BUDGET}"),
        false => String::new(),
    };
    format!(
        "the failure is that of the strategy: a state exists at this load, and the ladder reaches it (settings.strategy=ladder, tried: {}{beyond})",
        counted(minors, "minor")
    )
}

/// Repeats a trial of the ladder that ran out of its budget, with a larger one. Returns its minor iterations if it reaches the load.
pub fn finish_ladder(
    trials: &mut [RemedyTrial],
    stepper: &mut Stepper,
    state: &State,
    stop: &dyn Fn() -> bool,
) -> Option<u64> {
    let remedy = Remedy::from_kind(LADDER, stepper.model(), state)?;
    let trial = trials.iter_mut().find(|trial| trial.how == remedy.how)?;
    let longer = attempt_within(stepper, state, &remedy, MOST_OF_LADDER, stop)?;
    if !helps(&longer) {
        return None;
    }
    *trial = longer;
    Some(trial.minors.into())
}

/// Describes the limit load. `None` if none is found, for bodies that were loose from the start, and if interrupted. A mesh whose
/// strategy does not cut increments is examined where the ladder fails, if it does. The stepper's final state is unspecified.
pub fn limit_load(
    stepper: &mut Stepper,
    state: &State,
    failure: &Failure,
    stop: &dyn Fn() -> bool,
) -> Option<LoadEnd> {
    let named = strategy::rungs(state.controls.settings.strategy).is_empty();
    if !named || state.way.is_some() || stepper.model().bodies.iter().all(Body::is_linear) {
        return of_cut_increment(stepper, state, failure, stop).map(LoadEnd::Limit);
    }
    match with_ladder(stepper, state, stop)? {
        Ok(minors) => Some(LoadEnd::Strategy(minors)),
        Err((state, failure)) => {
            of_cut_increment(stepper, &state, &failure, stop).map(LoadEnd::Limit)
        }
    }
}

/// The limit load of an increment that was cut as far as the settings allow.
fn of_cut_increment(
    stepper: &mut Stepper,
    state: &State,
    failure: &Failure,
    stop: &dyn Fn() -> bool,
) -> Option<String> {
    if state.way.is_some() || state.recovery.motion.is_some() {
        return None;
    }
    let Some(motion) = rigid(failure).and_then(|motions| motions.first()) else {
        if state.sub_increment.cut == 0 {
            return None;
        }
        let model = stepper.model().clone();
        let path = passed_end(stepper, state, true, stop)
            .map(|(text, _)| text)
            .or_else(|| largest_load(stepper, state, stop).map(|found| words(&found, &model)));
        if path.is_some() {
            return path;
        }
        let (end, is_inside) = passed_end(stepper, state, false, stop).unzip();
        let certain = end.clone().filter(|_| is_inside == Some(true));
        let moves = || moves_away(&model, state, stop);
        return certain.or_else(moves).or(end);
    };
    let found = reach(stepper, state, stop)?;
    let LoadLimitProbe { load, from, .. } = found;
    found.ends.as_ref()?;
    let model = stepper.model().clone();
    if load == from && from == model.path[0] {
        let places = model.places(&state.u);
        return BodyMotion::new(&model, &places, state, motion)?.exceeds_friction(state);
    }
    let places = model.places(&found.at.start.u);
    let mut held = (*found.at).clone();
    held.nodes.clone_from(&found.at.start.nodes);
    let moving = BodyMotion::new(&model, &places, &held, motion)?;
    let resistance = resistance(&moving, &held);
    let why = match resistance {
        Resistance {
            friction: [most, used],
            opening: [left, _],
        } if most > 0.0 && most - used + left <= LEFT * most => "friction is used up",
        Resistance {
            friction: [0.0, _],
            opening: [left, all],
        } if left <= LEFT * all => "no contact presses against the motion any more",
        _ => "equilibrium ends",
    };
    let name = moving.name();
    Some(format!(
        "limit load: {why} at load {}: body {name} is held up to this load",
        sig4(load)
    ))
}

/// The body that has no friction left in an accepted increment: it is held by its slave nodes only, and all of them that touch
/// slide.
pub fn body_without_friction<'a>(model: &'a Model, contacts: &[ContactRecord]) -> Option<&'a str> {
    let touching = model.contacts.iter().zip(contacts);
    let touching: Vec<(usize, bool)> = touching
        .filter(|(_, found)| found.decision.before != Mode::Free)
        .map(|(contact, found)| {
            let slides = found.decision.before == Mode::Sliding && found.t_max != 0.0;
            (contact.node, slides)
        })
        .collect();
    if !touching.iter().any(|(_, slides)| *slides) {
        return None;
    }
    let slides = |&body: &usize| {
        let nodes: HashSet<usize> = model.bodies[body].nodes.iter().copied().collect();
        let mut own = touching
            .iter()
            .filter(|(node, _)| nodes.contains(node))
            .peekable();
        own.peek().is_some()
            && own.all(|(_, slides)| *slides)
            && is_held_by_contacts_only(model, body)
    };
    let body = (0..model.bodies.len()).find(slides)?;
    Some(&*model.bodies[body].name)
}

/// The rigid motions that a failure reports.
fn rigid(failure: &Failure) -> Option<&[RigidMotion]> {
    match failure {
        Failure::Singular(Singular::Rigid { motions }) => Some(motions),
        Failure::LadderEnded { first, last, .. } => rigid(first).or_else(|| rigid(last)),
        Failure::NoAnswer { first, .. } => first.as_deref().and_then(rigid),
        _ => None,
    }
}

fn resistance(moving: &BodyMotion<'_>, state: &State) -> Resistance {
    let mut all = Resistance::default();
    for (contact, [v_n, v_t]) in moving.rates(state) {
        let node = &state.nodes[contact];
        if node.mode == Mode::Free {
            continue;
        }
        let friction = node.friction(&state.controls.friction[contact]);
        let most = friction.limit(node.f_n.max(0.0));
        let size = v_n.hypot(v_t);
        if v_t.abs() > LEFT * size {
            all.friction[0] += most * v_t.abs();
            all.friction[1] += node.f_t.abs().min(most) * v_t.abs();
        }
        if v_n.abs() > LEFT * size {
            all.opening[0] += node.f_n.abs() * v_n.abs();
        }
        all.opening[1] += node.f_n.abs() * size;
    }
    all
}
