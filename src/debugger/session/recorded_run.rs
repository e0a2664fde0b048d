//! Sessions on finished runs, which cannot be extended: all iterations are in the tree, and each path of an
//! attached solver is a branch.

use super::machine::Session;
use crate::history::branches;
use crate::recorded::calculix::{self, RecordedRun};
use crate::recorded::exchange::{Line, OpenedExchange};
use crate::recorded::story::in_common;
use crate::{PointKind, Recording};
use stickslip_scene::Scene;

impl Session {
    /// Opens a session at the start of a scene or on a finished run, given a file or the name of a built-in
    /// scene.
    ///
    /// # Errors
    /// A message with the file and the reason.
    pub fn open(name: &str) -> Result<Session, String> {
        match Recording::open(name)? {
            Some(recording) => Ok(Session::recorded(recording)),
            None => Scene::open(name, &[])
                .map(Session::new)
                .map_err(|why| why.to_string()),
        }
    }

    /// The session on a finished run.
    pub fn recorded(recording: Recording) -> Session {
        match recording {
            Recording::Exchange(opened) => Session::from_exchange(*opened),
            Recording::Calculix(opened) => Session::from_calculix(*opened),
        }
    }

    /// The session on a CalculiX run: at the end of the first attempt that did not converge, otherwise at the
    /// start.
    fn from_calculix(opened: calculix::OpenedRun) -> Session {
        let solver = RecordedRun::new(&opened);
        let iterations = opened.run.files.iterations.len();
        let mut session = Session::attached(opened.scene, Box::new(solver), opened.log);
        session.take_steps(vec![None; iterations]);
        session.wait();
        let first = session
            .timeline
            .strips()
            .iter()
            .position(|strip| strip.kind.is_failure() || strip.kind == PointKind::Cut);
        session.rest_at(first.unwrap_or(0));
        session
    }

    /// The session at the start of the first path; every other path is a branch that leaves the nearest earlier
    /// one.
    fn from_exchange(opened: OpenedExchange) -> Session {
        let mut session = Session::attached(opened.scene, Box::new(opened.past), opened.log);
        let mut done: Vec<(usize, Line)> = Vec::new();
        for line in opened.lines {
            session.add_path(&line, &done);
            done.push((session.timeline.place().0, line));
        }
        if done.len() > 1 {
            session.timeline.switch(0);
        }
        session.rest_at(0);
        session
    }

    /// Adds a path, from the point where it leaves the earlier ones.
    fn add_path(&mut self, line: &Line, done: &[(usize, Line)]) {
        let Some((along, branch)) = done
            .iter()
            .map(|(branch, before)| (in_common(line, before), *branch))
            .max_by_key(|&(along, _)| along)
        else {
            self.take_steps(line.clone());
            self.wait();
            return;
        };
        self.timeline.switch(branch);
        let along = along.min(self.timeline.tip());
        self.rest_at(along);
        let rest = line[along..].to_vec();
        let first = rest.iter().flatten().next();
        let label = match first {
            Some(first) => branches::label(self.model(), first, None),
            None => "otherwise".into(),
        };
        // Recorded steps never fail to run.
        if self.follow(&label, rest).is_ok() {
            self.wait();
        }
    }

    /// Moves the cursor to an existing step.
    fn rest_at(&mut self, step: usize) {
        if self.jump(step).is_ok() {
            self.wait();
        }
    }
}
