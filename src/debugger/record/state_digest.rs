//! Digests of states, with which a replay compares every state that it reaches. The first characters give the version:
//!
//! - none: FNV-1a of the state's RON text, in which floats are exact;
//! - `2-`: [`bits::digest`] of the state;
//! - `3-`: [`bits::digest`] of the digests of the state's large shared parts and of the rest. Those of the parts are kept as long
//!   as the parts, so that moving between recorded states costs the same at any size.

use crate::memo::Memo;
use crate::record::bits;
use std::sync::Arc;
use stickslip_core::step::state::MajorState;
use stickslip_core::{IncrementStart, State};
use stickslip_exchange::seal::Digest;
use stickslip_scene::format::notation;

/// A digest that never matches. All known states have one.
const NONE: &str = "none";

/// Computes digests of the latest version.
#[derive(Debug, Default)]
pub struct StateDigests {
    fields: Memo<Vec<f64>, Option<u64>>,
    starts: Memo<IncrementStart, Option<u64>>,
}

impl StateDigests {
    /// The digest of a state.
    pub fn digest(&mut self, state: &State) -> String {
        let factored = state.major.factored.as_ref();
        let parts = (
            self.fields.find_or(&state.u, bits::digest),
            factored.map(|u| self.fields.find_or(u, bits::digest)),
            self.starts.find_or(&state.start, bits::digest),
        );
        let rest = State {
            u: Arc::default(),
            start: Arc::default(),
            major: MajorState {
                factored: None,
                ..state.major.clone()
            },
            ..state.digested()
        };
        labelled("3-", bits::digest(&(parts, rest)))
    }
}

/// The digest of a state, in the version of a recorded digest.
pub fn digest_like(recorded: &str, state: &State) -> String {
    if recorded.starts_with("3-") {
        return StateDigests::default().digest(state);
    }
    if recorded.starts_with("2-") {
        return labelled("2-", bits::digest(&state.digested()));
    }
    let mut text = Digest::default();
    match notation::line_to(&mut text, &state.digested()) {
        Ok(()) => text.to_string(),
        Err(error) => format!("{NONE}: {error}"),
    }
}

fn labelled(version: &str, digest: Option<u64>) -> String {
    digest.map_or(NONE.into(), |digest| format!("{version}{digest:016x}"))
}
