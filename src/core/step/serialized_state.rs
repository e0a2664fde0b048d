//! A [`State`] as data: one flat record, whose field names and order the digests of journals rely on.

use super::arc_state::ArcState;
use super::event::Position;
use super::major_history::MajorHistory;
use super::pace::Pace;
use super::recovery::fallback::FallbackState;
use super::recovery::motion::Motion;
use super::recovery::proximal::SlipStiffness;
use super::state::{
    AttemptState, Controls, ExternalState, IncrementStart, MajorState, Progress, RecoveryState,
    RunRecord, SearchRecord, State, Status,
};
use super::sub_increment::SubIncrement;
use super::watch::StabilityWatch;
use crate::contact::state::ContactState;
use crate::interface::line_search::LineSearch;
use crate::interface::minor_history::MinorHistory;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

#[derive(Serialize, Deserialize)]
#[serde(rename = "State")]
pub(super) struct SerializedState {
    next: Position,
    load_factor: f64,
    u: Arc<Vec<f64>>,
    nodes: Vec<ContactState>,
    start: Arc<IncrementStart>,
    controls: Arc<Controls>,
    trail: Arc<MinorHistory>,
    rounds: Arc<MajorHistory>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    line: Option<Arc<LineSearch>>,
    aim: f64,
    reached: f64,
    search: Progress,
    piece: SubIncrement,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    cuts: BTreeMap<usize, u32>,
    minors: u32,
    unsettled: u32,
    #[serde(default)]
    net: bool,
    correction: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    factored: Option<Arc<Vec<f64>>>,
    #[serde(default)]
    pace: Pace,
    #[serde(default, skip_serializing_if = "StabilityWatch::is_new")]
    watch: StabilityWatch,
    #[serde(skip_serializing_if = "Option::is_none")]
    brake: Option<SlipStiffness>,
    #[serde(skip_serializing_if = "Option::is_none")]
    way: Option<Box<ArcState>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<Motion>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    detour: Option<FallbackState>,
    #[serde(default, skip_serializing_if = "SearchRecord::is_new")]
    searched: SearchRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    outside: Option<Box<ExternalState>>,
    status: Status,
}

impl From<State> for SerializedState {
    fn from(state: State) -> Self {
        let (major, attempt) = (state.major, state.attempt);
        let (recovery, record) = (state.recovery, state.record);
        SerializedState {
            next: state.next,
            load_factor: state.load_factor,
            u: state.u,
            nodes: state.nodes,
            start: state.start,
            controls: state.controls,
            trail: major.minor_history,
            rounds: attempt.major_history,
            line: major.line,
            aim: major.target,
            reached: major.last_target,
            search: attempt.search,
            piece: state.sub_increment,
            cuts: recovery.cuts,
            minors: attempt.minors,
            unsettled: attempt.unsettled,
            net: attempt.net,
            correction: major.correction,
            factored: major.factored,
            pace: record.pace,
            watch: record.watch,
            brake: recovery.brake,
            way: state.way,
            motion: recovery.motion,
            detour: recovery.fallback,
            searched: record.searched,
            outside: state.outside,
            status: state.status,
        }
    }
}

impl From<SerializedState> for State {
    fn from(state: SerializedState) -> Self {
        State {
            next: state.next,
            load_factor: state.load_factor,
            u: state.u,
            nodes: state.nodes,
            start: state.start,
            controls: state.controls,
            sub_increment: state.piece,
            major: MajorState {
                minor_history: state.trail,
                line: state.line,
                target: state.aim,
                last_target: state.reached,
                correction: state.correction,
                factored: state.factored,
            },
            attempt: AttemptState {
                major_history: state.rounds,
                search: state.search,
                minors: state.minors,
                unsettled: state.unsettled,
                net: state.net,
            },
            recovery: RecoveryState {
                cuts: state.cuts,
                brake: state.brake,
                motion: state.motion,
                fallback: state.detour,
            },
            record: RunRecord {
                pace: state.pace,
                watch: state.watch,
                searched: state.searched,
            },
            way: state.way,
            outside: state.outside,
            status: state.status,
        }
    }
}
