//! A debugging session: the scene, everything done so far, and a cursor in it.
//!
//! The solver runs on a worker thread, one job at a time, so that whoever owns the session (the TUI, a test, a
//! script) stays free to answer keys. [`Session::submit`] takes a command, [`Session::poll`] gathers what the
//! worker has done since, [`Session::wait`] blocks until it is idle.

use crate::debug::command::Command;
use crate::scene::Model;
use crate::solve::{Event, State};
use std::sync::Arc;

/// A point of the history: the state after a minor iteration and the event that led there (none at the start).
#[derive(Debug, Clone)]
pub struct Frame {
    pub state: State,
    pub event: Option<Arc<Event>>,
}

/// A debugging session.
pub struct Session {
    model: Arc<Model>,
}

/// What a command led to, as a line for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply(pub String);

impl Session {
    /// Scene as checked.
    pub fn model(&self) -> &Model {
        todo!()
    }
    /// Path or built-in name that the scene came from.
    pub fn scene_name(&self) -> &str {
        todo!()
    }
    /// All frames so far, oldest first; never empty. Frame 0 is the start.
    pub fn frames(&self) -> &[Frame] {
        todo!()
    }
    /// Index of the frame that is shown.
    pub fn cursor(&self) -> usize {
        todo!()
    }
    /// The frame that is shown.
    pub fn frame(&self) -> &Frame {
        todo!()
    }
    /// Whether the worker is busy.
    pub fn is_running(&self) -> bool {
        todo!()
    }
    /// Carries out (or starts) a command. Err: a message that says what is wrong and what would be right.
    pub fn submit(&mut self, command: Command) -> Result<Reply, String> {
        let _ = command;
        todo!()
    }
    /// Gathers what the worker did since the last call; a message when a run came to its end. Never blocks.
    pub fn poll(&mut self) -> Option<Reply> {
        todo!()
    }
    /// Blocks until the worker is idle and returns its last message.
    pub fn wait(&mut self) -> Option<Reply> {
        todo!()
    }
    /// Asks a running job to stop after the present minor iteration.
    pub fn interrupt(&self) {
        todo!()
    }
    /// Norms of the major iterations of the shown increment attempt up to the cursor: `(major, norms)`.
    pub fn residual_history(&self) -> Vec<(u32, crate::solve::Norms)> {
        todo!()
    }
}
