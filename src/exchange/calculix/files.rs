//! A finished CalculiX run, from its .cel and the files next to it: attempts at increments, and their iterations.
//!
//! The .cel alone has no iterations without contact elements, no residuals, and no result of the last attempt. None of the three
//! files contains stick and slip.

use super::cel::{ClosedContact, ContactElements, RunPosition, Slave};
use super::cvg::Norms;
use super::sta::FinishedAttempt;
use super::{Stop, Table};
use std::collections::BTreeMap;
use std::ops::Range;

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct CalculixFiles {
    /// Every slave node and face that was ever in contact.
    pub slaves: Vec<Slave>,
    /// Every master face that was ever touched: its corners.
    pub masters: Vec<[u32; 4]>,
    /// The attempts in order. Each has at least one iteration or a row of the .sta.
    pub attempts: Vec<Attempt>,
    /// The iterations of all attempts, in order.
    pub iterations: Vec<Iteration>,
    /// The closed contacts, iteration by iteration, each sorted by slave and master.
    pub closed: Vec<ClosedContact>,
    /// Where the .cel is truncated.
    pub cel: Option<Stop>,
    /// State of the .sta.
    pub sta: OptionalFile,
    /// State of the .cvg.
    pub cvg: OptionalFile,
    /// Iterations where .cel and .cvg disagree on the number of contact elements: the first one, and their number.
    pub differs: Option<(RunPosition, usize)>,
}

/// State of an optional file next to the .cel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionalFile {
    /// The file does not exist.
    Missing,
    /// It was read, to its end or up to the given position.
    Read(Option<Stop>),
}

/// An attempt at an increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// Step, from 1.
    pub step: u32,
    /// Increment of the step, from 1.
    pub increment: u32,
    /// Attempt, from 1.
    pub attempt: u32,
    /// Result.
    pub end: End,
    /// Its row in the .sta.
    pub row: Option<FinishedAttempt>,
    /// Its range of [`CalculixFiles::iterations`]; empty if only the .sta contains it.
    pub iterations: Range<usize>,
}

/// Result of an attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The increment converged.
    Converged,
    /// It did not converge; another attempt with a smaller increment may follow.
    NotConverged,
    /// Unknown: the run was stopped there, or is still running.
    Unknown,
}

/// An iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration {
    /// Number in the attempt, from 1.
    pub number: u32,
    /// Its range of [`CalculixFiles::closed`]; `None` if the .cvg counts contact elements that are missing in the .cel.
    pub closed: Option<Range<usize>>,
    /// Whether it kept the contact elements of the previous iteration. Node-to-surface contact freezes them after iteration 8 of
    /// an attempt, or after the first with SMALL SLIDING (CalculiX's nonlingeo.c), and does not write them to the .cel. The .cvg
    /// still counts them.
    pub kept: bool,
    /// Its row in the .cvg.
    pub norms: Option<Norms>,
}

impl CalculixFiles {
    /// Combines the files; `None` for a missing one.
    pub fn new(
        cel: ContactElements,
        sta: Option<Table<FinishedAttempt>>,
        cvg: Option<Table<(RunPosition, Norms)>>,
    ) -> CalculixFiles {
        let optional =
            |stop: Option<Option<Stop>>| stop.map_or(OptionalFile::Missing, OptionalFile::Read);
        let mut run = CalculixFiles {
            slaves: cel.slaves,
            masters: cel.masters,
            attempts: Vec::new(),
            iterations: Vec::new(),
            closed: cel.closed,
            cel: cel.stop,
            sta: optional(sta.as_ref().map(|table| table.1)),
            cvg: optional(cvg.as_ref().map(|table| table.1)),
            differs: None,
        };
        let mut all: BTreeMap<RunPosition, (Option<Range<usize>>, Option<Norms>)> = BTreeMap::new();
        for (at, closed) in cel.iterations {
            all.entry(at).or_default().0 = Some(closed);
        }
        for (at, norms) in cvg.into_iter().flat_map(|table| table.0) {
            all.entry(at).or_default().1 = Some(norms);
        }
        let mut rows: BTreeMap<(u32, u32, u32), FinishedAttempt> = sta
            .into_iter()
            .flat_map(|table| table.0)
            .map(|row| ((row.step, row.increment, row.attempt), row))
            .collect();
        for (at, (closed, norms)) in all {
            let key = (at.step, at.increment, at.attempt);
            run.add_rows_before(&mut rows, key);
            let last = run.attempts.last().map(Attempt::key);
            if last != Some(key) {
                let row = rows.remove(&key);
                run.begin(key, row);
            }
            run.differs = run.told_differently(at, closed.as_ref(), norms.as_ref());
            run.add(at.iteration, closed, norms);
            if let Some(attempt) = run.attempts.last_mut() {
                attempt.iterations.end = run.iterations.len();
            }
        }
        while let Some((key, row)) = rows.pop_first() {
            run.begin(key, Some(row));
        }
        run.end_attempts();
        run
    }

    /// The closed contacts in an iteration; `None` if unknown.
    pub fn closed(&self, iteration: usize) -> Option<&[ClosedContact]> {
        let range = self.iterations.get(iteration)?.closed.clone()?;
        self.closed.get(range)
    }

    /// Adds an iteration to the last attempt. Iterations without contact elements, and those that kept the previous ones, are not
    /// in the .cel; the .cvg distinguishes them.
    fn add(&mut self, number: u32, listed: Option<Range<usize>>, norms: Option<Norms>) {
        let counted = norms
            .filter(|_| listed.is_none())
            .map(|norms| norms.elements);
        let none = counted.filter(|count| *count == 0).map(|_| 0..0);
        let before = self.before().filter(|before| {
            let count = self.elements(before);
            counted.is_some_and(|counted| u64::from(counted) == count)
        });
        let kept = listed.is_none() && none.is_none() && before.is_some();
        self.iterations.push(Iteration {
            number,
            closed: listed.or(none).or(before),
            kept,
            norms,
        });
    }

    /// The range of the previous iteration in the same attempt.
    fn before(&self) -> Option<Range<usize>> {
        let attempt = self
            .attempts
            .last()
            .filter(|last| !last.iterations.is_empty())?;
        self.iterations
            .get(attempt.iterations.end - 1)?
            .closed
            .clone()
    }

    /// Number of contact elements in a range.
    fn elements(&self, part: &Range<usize>) -> u64 {
        let closed = self.closed[part.clone()].iter();
        closed.map(|closed| u64::from(closed.elements)).sum()
    }

    /// Iterations on which the files disagree, including the next one.
    fn told_differently(
        &self,
        at: RunPosition,
        listed: Option<&Range<usize>>,
        norms: Option<&Norms>,
    ) -> Option<(RunPosition, usize)> {
        let counted = norms.map(|norms| u64::from(norms.elements));
        let listed = listed.map(|part| self.elements(part));
        let kept = self.before().map(|before| self.elements(&before));
        match (
            counted.is_none_or(|counted| match listed {
                Some(listed) => listed == counted,
                None => counted == 0 || kept == Some(counted),
            }),
            self.differs,
        ) {
            (true, before) => before,
            (false, None) => Some((at, 1)),
            (false, Some((first, count))) => Some((first, count + 1)),
        }
    }

    /// Adds attempts that only the .sta contains.
    fn add_rows_before(
        &mut self,
        rows: &mut BTreeMap<(u32, u32, u32), FinishedAttempt>,
        key: (u32, u32, u32),
    ) {
        while let Some(first) = rows.first_entry().filter(|first| *first.key() < key) {
            let (key, row) = first.remove_entry();
            self.begin(key, Some(row));
        }
    }

    fn begin(&mut self, (step, increment, attempt): (u32, u32, u32), row: Option<FinishedAttempt>) {
        let here = self.iterations.len();
        self.attempts.push(Attempt {
            step,
            increment,
            attempt,
            end: End::Unknown,
            row,
            iterations: here..here,
        });
    }

    /// Determines the result of each attempt from its row, or from what follows it.
    fn end_attempts(&mut self) {
        for k in 0..self.attempts.len() {
            let (step, increment, _) = self.attempts[k].key();
            let next = self.attempts.get(k + 1).map(Attempt::key);
            let followed = match next {
                Some((s, i, _)) if (s, i) == (step, increment) => End::NotConverged,
                Some(_) => End::Converged,
                None => End::Unknown,
            };
            let attempt = &mut self.attempts[k];
            attempt.end = match attempt.row.map(|row| row.converged) {
                Some(true) => End::Converged,
                Some(false) => End::NotConverged,
                None => followed,
            };
        }
    }
}

impl Attempt {
    fn key(&self) -> (u32, u32, u32) {
        (self.step, self.increment, self.attempt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculix::{cel, cvg, sta};
    use crate::format_error::FormatError;
    use proptest::prelude::*;

    fn element(increment: u32, attempt: u32, iteration: u32, slave: u32) -> String {
        format!(
            "*ELEMENT,TYPE=C3D4,ELSET=contactelements_st1_in{increment}_at{attempt}_it{iteration}\n 1 , 1 , 2 , 3 , {slave}\n"
        )
    }

    fn norms(increment: u32, attempt: u32, iteration: u32, elements: u32) -> String {
        format!(" 1 {increment} {attempt} {iteration} {elements} 0.1E+01 0.2E+01 0. 0.\n")
    }

    /// A run with an increment that is cut once, where no contact is closed in the second iteration, and with an increment in
    /// which the run was killed.
    fn files() -> [String; 3] {
        let cel = [(1, 1, 1), (1, 1, 3), (1, 2, 1), (2, 1, 1)];
        let cel = cel.map(|(i, a, k)| element(i, a, k, 9)).concat();
        let cvg = [(1, 1, 1, 1), (1, 1, 2, 0), (1, 1, 3, 1), (1, 2, 1, 1)];
        let cvg = cvg.map(|(i, a, k, n)| norms(i, a, k, n)).concat();
        let cvg = format!("SUMMARY OF C0NVERGENCE INFORMATION\n  STEP\n{cvg}");
        let sta =
            "SUMMARY OF JOB INFORMATION\n  STEP\n 1 1 1U 3 0. 0. 1.\n 1 1 2 1 0.25 0.25 0.25\n"
                .to_owned();
        [cel, sta, cvg]
    }

    fn read(
        cel: &[u8],
        sta: Option<&[u8]>,
        cvg: Option<&[u8]>,
    ) -> Result<CalculixFiles, FormatError> {
        let cel = cel::read(cel)?;
        let sta = sta.map(sta::read).transpose()?;
        let cvg = cvg.map(cvg::read).transpose()?;
        Ok(CalculixFiles::new(cel, sta, cvg))
    }

    #[test]
    fn three_files_are_combined_to_attempts_and_iterations() {
        let [cel, sta, cvg] = files();
        let run = read(cel.as_bytes(), Some(sta.as_bytes()), Some(cvg.as_bytes())).unwrap();
        let ends: Vec<_> = run
            .attempts
            .iter()
            .map(|a| (a.increment, a.attempt, a.end))
            .collect();
        assert_eq!(
            ends,
            [
                (1, 1, End::NotConverged),
                (1, 2, End::Converged),
                (2, 1, End::Unknown)
            ]
        );
        let closed: Vec<_> = (0..5)
            .map(|k| run.closed(k).map(<[ClosedContact]>::len))
            .collect();
        assert_eq!(closed, [Some(1), Some(0), Some(1), Some(1), Some(1)]);
        assert_eq!(run.iterations[4].norms, None);
        assert_eq!(run.attempts[0].iterations, 0..3);
        assert_eq!(run.differs, None);
    }

    #[test]
    fn the_cel_can_be_read_alone() {
        let [cel, ..] = files();
        let run = read(cel.as_bytes(), None, None).unwrap();
        assert_eq!(
            (run.sta, run.cvg),
            (OptionalFile::Missing, OptionalFile::Missing)
        );
        let ends: Vec<_> = run.attempts.iter().map(|attempt| attempt.end).collect();
        assert_eq!(ends, [End::NotConverged, End::Converged, End::Unknown]);
        let numbers: Vec<_> = run
            .iterations
            .iter()
            .map(|iteration| iteration.number)
            .collect();
        assert_eq!(numbers, [1, 3, 1, 1]);
    }

    #[test]
    fn mismatching_files_are_detected_and_no_data_is_invented() {
        let [cel, _, cvg] = files();
        let cvg = cvg.replace(" 1 1 1 2 0 ", " 1 1 1 2 4 ");
        let run = read(cel.as_bytes(), None, Some(cvg.as_bytes())).unwrap();
        let (first, count) = run.differs.unwrap();
        assert_eq!((first.iteration, count), (2, 1));
        assert_eq!(run.closed(1), None);
    }

    #[test]
    fn frozen_contact_elements_are_those_of_the_previous_iteration() {
        let cel = element(1, 1, 8, 9) + &element(1, 1, 8, 7) + &element(1, 2, 1, 9);
        let rows = [(1, 8, 2), (1, 9, 2), (1, 10, 3), (2, 1, 1)];
        let rows = rows
            .map(|(attempt, k, count)| norms(1, attempt, k, count))
            .concat();
        let cvg = format!("SUMMARY OF C0NVERGENCE INFORMATION\n{rows}");
        let run = read(cel.as_bytes(), None, Some(cvg.as_bytes())).unwrap();
        let told: Vec<_> = (0..4)
            .map(|k| {
                (
                    run.closed(k).map(<[ClosedContact]>::len),
                    run.iterations[k].kept,
                )
            })
            .collect();
        assert_eq!(
            told,
            [
                (Some(2), false),
                (Some(2), true),
                (None, false),
                (Some(1), false)
            ]
        );
        assert_eq!(run.differs.unwrap().0.iteration, 10);
    }

    #[test]
    fn attempts_found_only_in_the_sta_are_included() {
        let [cel, sta, _] = files();
        let sta = format!("{sta} 2 1 1U 9 0. 0. 1.\n");
        let run = read(cel.as_bytes(), Some(sta.as_bytes()), None).unwrap();
        let last = run.attempts.last().unwrap();
        assert_eq!(
            (last.step, last.end, last.iterations.len()),
            (2, End::NotConverged, 0)
        );
    }

    /// Invariants of every run, whatever the files contain.
    fn holds(run: &CalculixFiles) -> Result<(), TestCaseError> {
        let mut end = 0;
        for attempt in &run.attempts {
            prop_assert_eq!(attempt.iterations.start, end);
            end = attempt.iterations.end;
        }
        prop_assert_eq!(end, run.iterations.len());
        for k in 0..run.iterations.len() {
            for closed in run.closed(k).unwrap_or_default() {
                prop_assert!((closed.slave as usize) < run.slaves.len());
                prop_assert!((closed.master as usize) < run.masters.len());
                prop_assert!(closed.elements > 0);
            }
        }
        Ok(())
    }

    /// Errors have a line and a column in the file.
    fn told(broken: &FormatError, files: [&[u8]; 3]) -> Result<(), TestCaseError> {
        let (line, column) = broken.at.expect("a place");
        let lines = files.map(|file| file.split(|byte| *byte == b'\n').count());
        prop_assert!(line >= 1 && column >= 1 && lines.iter().any(|count| line <= *count));
        prop_assert!(!broken.message.is_empty());
        Ok(())
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(files in prop::array::uniform3(prop::collection::vec(any::<u8>(), 0..300))) {
            let [cel, sta, cvg] = files.each_ref().map(Vec::as_slice);
            match read(cel, Some(sta), Some(cvg)) {
                Ok(run) => holds(&run)?,
                Err(broken) => told(&broken, [cel, sta, cvg])?,
            }
        }

        #[test]
        fn no_change_of_a_valid_file_makes_it_panic(
            changes in prop::collection::vec((0..3_usize, any::<prop::sample::Index>(), 0..3_u8, any::<u8>()), 1..8),
            short in prop::option::of((0..3_usize, any::<prop::sample::Index>())),
        ) {
            let mut files = files().map(String::into_bytes);
            for (file, at, what, byte) in changes {
                let bytes = &mut files[file];
                let at = at.index(bytes.len());
                match what {
                    0 => bytes[at] = byte,
                    1 => bytes.insert(at, byte),
                    _ => drop(bytes.remove(at)),
                }
            }
            if let Some((file, at)) = short {
                let at = at.index(files[file].len());
                files[file].truncate(at);
            }
            let [cel, sta, cvg] = files.each_ref().map(Vec::as_slice);
            match read(cel, Some(sta), Some(cvg)) {
                Ok(run) => holds(&run)?,
                Err(broken) => told(&broken, [cel, sta, cvg])?,
            }
        }

        #[test]
        fn a_run_killed_at_any_point_is_read_up_to_there(at in prop::array::uniform3(any::<prop::sample::Index>())) {
            let files = files();
            let whole = read(files[0].as_bytes(), Some(files[1].as_bytes()), Some(files[2].as_bytes())).unwrap();
            let cut = |k: usize| &files[k].as_bytes()[..at[k].index(files[k].len() + 1)];
            let run = read(cut(0), Some(cut(1)), Some(cut(2))).unwrap();
            holds(&run)?;
            // No iteration is invented.
            prop_assert!(run.iterations.len() <= whole.iterations.len());
            prop_assert!(run.attempts.iter().all(|a| whole.attempts.iter().any(|b| a.key() == b.key())));
        }
    }
}
