//! Sessions on finished runs, which cannot be extended: all iterations are in the tree, and each path of an
//! attached solver is a branch.

use super::machine::Session;
use crate::history::branches;
use crate::recorded::calculix::RecordedRun;
use crate::recorded::exchange::Line;
use crate::recorded::story::in_common;
use crate::{PointKind, Recording, Strip};
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

    /// The session on a finished run: every path is a branch that leaves the nearest earlier one. It starts at the end of the first
    /// attempt of a CalculiX run that did not converge, otherwise at the start of the first path.
    pub fn recorded(recording: Recording) -> Session {
        let (mut session, lines) = match recording {
            Recording::Exchange(opened) => {
                let solver = Box::new(opened.past);
                let session = Session::attached(opened.scene, solver, opened.log);
                (session, opened.lines)
            }
            Recording::Calculix(opened) => {
                let solver = Box::new(RecordedRun::new(&opened));
                let iterations = opened.run.files.iterations.len();
                let session = Session::attached(opened.scene, solver, opened.log);
                (session, vec![vec![None; iterations]])
            }
        };
        let mut done: Vec<(usize, Line)> = Vec::new();
        for line in lines {
            session.add_path(&line, &done);
            done.push((session.timeline.place().0, line));
        }
        if done.len() > 1 {
            session.timeline.switch(0);
        }
        let mut strips = session.timeline.strips().iter();
        let is_end = |strip: &Strip| strip.kind.is_failure() || strip.kind == PointKind::Cut;
        let failed = strips.position(is_end);
        let failed = failed.filter(|_| session.model().finished.is_some());
        session.rest_at(failed.unwrap_or(0));
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
