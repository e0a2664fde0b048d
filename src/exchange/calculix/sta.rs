//! `job.sta`: one row per finished attempt at an increment.
//!
//! Columns: step, increment, attempt (with a U if it did not converge), iterations, total time, step time, increment size. For an
//! attempt that did not converge, the times are those at its start.

use super::Table;
use super::lines::{Field, ResultLine, table};
use crate::FormatError;
use std::io::BufRead;

/// A finished attempt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinishedAttempt {
    /// Step, from 1.
    pub step: u32,
    /// Increment of the step, from 1.
    pub increment: u32,
    /// Attempt, from 1.
    pub attempt: u32,
    /// Whether it converged.
    pub converged: bool,
    /// Number of iterations.
    pub iterations: u32,
    /// Total time: at its end if it converged, else at its start.
    pub total_time: f64,
    /// The same for the step time.
    pub step_time: f64,
    /// Size of the increment.
    pub size: f64,
}

/// Reads a file: its attempts in order, and where it is truncated.
///
/// # Errors
/// If it is not such a file, or a row is invalid.
pub fn read(from: impl BufRead) -> Result<Table<FinishedAttempt>, FormatError> {
    let mut rows = Vec::new();
    let take = |line: ResultLine, fields: &[Field]| {
        let &[step, increment, attempt, iterations, total, of_step, size] = fields else {
            return Err(line.ends_early(format!(
                "a row must have 7 columns; this one has {}",
                fields.len()
            )));
        };
        rows.push(FinishedAttempt {
            step: step.whole_number("step")?,
            increment: increment.whole_number("increment")?,
            attempt: attempt.without(b"U").whole_number("attempt")?,
            converged: !attempt.bytes.ends_with(b"U"),
            iterations: iterations.whole_number("number of iterations")?,
            total_time: total.number("total time")?,
            step_time: of_step.number("step time")?,
            size: size.number("increment size")?,
        });
        Ok(())
    };
    let stop = table(from, "SUMMARY OF JOB INFORMATION", ".sta", take)?;
    Ok((rows, stop))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculix::Stop;

    const STA: &str = "SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1         10     1     2  0.100000E+01  0.100000E+01  0.100000E+00
     2          1     1U    7  0.100000E+01  0.000000E+00  0.100000E+00
";

    #[test]
    fn attempts_and_whether_they_converged() {
        let (rows, stop) = read(STA.as_bytes()).unwrap();
        assert_eq!(stop, None);
        let told: Vec<_> = rows
            .iter()
            .map(|r| (r.step, r.attempt, r.converged, r.iterations))
            .collect();
        assert_eq!(told, [(1, 1, true, 2), (2, 1, false, 7)]);
        assert_eq!(
            (rows[1].total_time, rows[1].step_time, rows[1].size),
            (1.0, 0.0, 0.1)
        );
    }

    #[test]
    fn errors_are_reported_and_truncated_files_are_read_up_to_their_end() {
        let (rows, stop) = read(&STA.as_bytes()[..STA.len() - 30]).unwrap();
        assert_eq!((rows.len(), stop), (1, Some(Stop::Cut(4))));
        let row = |text: &str| read(format!("{STA}{text}\n").as_bytes());
        let (rows, stop) = row("    2  ***  1  2 0. 0. 0.").unwrap();
        assert_eq!((rows.len(), stop), (2, Some(Stop::NoRoom(5))));
        for (text, at) in [
            ("  2 1 1 7 1.0 0.0", (5, 18)),
            ("  2 1 1X 7 1.0 0.0 0.1", (5, 7)),
            ("  2 1 1 7 1.0 0.0 none", (5, 19)),
            ("hello", (5, 6)),
        ] {
            assert_eq!(row(text).unwrap_err().at, Some(at), "{text}");
        }
        assert_eq!(read(&b"SUMMARY\n"[..]).unwrap_err().at, Some((1, 1)));
    }
}
