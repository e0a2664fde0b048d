//! Trials of remedies on the background thread.

use super::background_messages::BackgroundReply;
use crate::RemedyTrial;
use crate::explain::remedies;
use crate::explain::remedy::Remedy;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use stickslip_core::{State, Stepper};
use stickslip_scene::Spec;

/// Tries every remedy from a state.
pub(super) fn try_remedies(
    stepper: &mut Stepper,
    spec: Option<&Spec>,
    state: &State,
    news: &Sender<BackgroundReply>,
    stop: &AtomicBool,
) -> Option<()> {
    let stopped = || stop.load(Ordering::Relaxed);
    let all = remedies::all(stepper, state, spec, &stopped);
    try_all(&all, news, |remedy| {
        let tried = remedies::attempt(stepper, state, spec, remedy, &stopped);
        (tried.is_some() || !stopped()).then_some(tried)
    })
}

/// Runs trials until `attempt` returns `None`; an inner `None` means that the remedy does not apply.
pub(super) fn try_all(
    all: &[Remedy],
    news: &Sender<BackgroundReply>,
    mut attempt: impl FnMut(&Remedy) -> Option<Option<RemedyTrial>>,
) -> Option<()> {
    let mut stopped = false;
    for remedy in all {
        let (all, now) = (all.len(), remedy.label.clone());
        news.send(BackgroundReply::Trying { all, now }).ok()?;
        match attempt(remedy) {
            Some(Some(trial)) => news.send(BackgroundReply::Trial(Box::new(trial))).ok()?,
            Some(None) => {}
            None => {
                stopped = true;
                break;
            }
        }
    }
    news.send(BackgroundReply::Done { stopped }).ok()
}
