//! Analyses of an attached solver: from the interface problem that it reports, and by trials on the solver itself.

use super::Helper;
use crate::explain::attached;
use crate::explain::remedies;
use crate::explain::try_list::TryLine;
use crate::session::background_messages::{BackgroundReply, Reported};
use crate::session::trials::try_all;
use crate::{DiagnosisPage, Examination, ReportedIterations};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use stickslip_core::{ReportedProblem, SolverLost, State, Status};

impl Helper {
    /// The interface problem that an attached solver reports for a state.
    pub(super) fn interface_problem(&self, state: &State) -> Result<ReportedProblem, SolverLost> {
        if !self.offers.problem {
            return Err(SolverLost::new(self.offers.lacks("its interface problem")));
        }
        let wanted = state.clone();
        let asked = self
            .lender
            .look(move |solver| solver.interface_problem(&wanted));
        asked.unwrap_or_else(|| Err(SolverLost::new("the solver is busy; :census asks again")))
    }

    /// As [`Self::interface_problem`], and returns the solver to its previous state. `None` if the solver is busy.
    pub(super) fn posed_aside(
        &mut self,
        state: &State,
    ) -> Option<Result<ReportedProblem, SolverLost>> {
        if let Some((known, posed)) = &self.posed
            && known == state
        {
            return Some(Ok(posed.clone()));
        }
        let wanted = state.clone();
        let posed = self.lender.look(move |solver| {
            let stood = solver.state().clone();
            let posed = solver.interface_problem(&wanted);
            // If the solver cannot return to its state, its next step reports that.
            let _ = solver.restore(&stood);
            posed
        })?;
        if let Ok(posed) = &posed {
            self.posed = Some((state.clone(), posed.clone()));
        }
        Some(posed)
    }

    /// The examination of an attached solver's state: what it reported, then the analysis of its interface
    /// problem.
    pub(super) fn examine_attached(
        &self,
        state: &State,
        nodes: &[usize],
        reported: Reported,
        stop: &AtomicBool,
    ) -> DiagnosisPage {
        if let Some(run) = &self.model.finished {
            return DiagnosisPage::finished(run);
        }
        let mut found = self.examine_problem(state, nodes, &reported.iterations, stop);
        let known = reported.findings;
        found.fails |= matches!(state.status, Status::Failed(_));
        let count = found.census.as_ref().map_or(0, |c| c.answers.len());
        let mut tries: Vec<String> = (1..=count.min(2))
            .map(|n| {
                format!("start from the consistent state {n} (:start-from {n} forces its modes)")
            })
            .collect();
        if tries.is_empty() && reported.changing {
            tries.push("force one of the changing nodes into another mode (m)".into());
        }
        let tries = tries
            .iter()
            .filter(|_| self.offers.force)
            .map(|text| TryLine::by_hand(text))
            .collect();
        DiagnosisPage::attached(known, found, tries)
    }

    /// The examination of the interface problem that an attached solver reports.
    pub(super) fn examine_problem(
        &self,
        state: &State,
        nodes: &[usize],
        iterations: &ReportedIterations,
        stop: &AtomicBool,
    ) -> Examination {
        let stopped = || stop.load(Ordering::Relaxed);
        match self.interface_problem(state) {
            Ok(posed) => attached::examine(&self.model, state, &posed, iterations, nodes, &stopped),
            Err(lost) => Examination {
                head: format!("The frozen problem is not available: {lost}."),
                ..Examination::default()
            },
        }
    }

    /// Tries the remedies that an attached solver offers, on that solver.
    pub(super) fn try_attached(
        &self,
        state: &State,
        news: &Sender<BackgroundReply>,
        stop: &AtomicBool,
    ) -> Option<()> {
        let found = self.examine_problem(state, &[], &ReportedIterations::default(), stop);
        let all = remedies::offered(&self.model, state, &self.offers, &found);
        try_all(&all, news, |remedy| {
            let (remedy, state) = (remedy.clone(), state.clone());
            let stopping = self.stopping.clone();
            let tried = self.lender.look(move |solver| {
                let stopped = || stopping.load(Ordering::Relaxed);
                let tried = remedies::attempt(solver, &state, None, &remedy, &stopped);
                // Back to the session's state. If the solver cannot return to it, its next step reports that.
                let _ = solver.restore(&state);
                tried
            });
            tried.flatten().map(Some)
        })
    }
}
