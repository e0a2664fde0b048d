//! `job.cvg`: one row per iteration.
//!
//! Columns: step, increment, attempt, iteration, number of contact elements; then in percent the largest residual force relative
//! to the mean force, the largest displacement correction relative to the largest displacement increment, and the same two for
//! heat flux and temperature. CalculiX writes 0/0 as 1e-30 and x/0 as 1e30 (writecvg.f).

use super::Table;
use super::cel::RunPosition;
use super::lines::{Field, ResultLine, table};
use crate::FormatError;
use std::io::BufRead;

/// The numbers of an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Norms {
    /// Number of contact elements.
    pub elements: u32,
    /// Force residual (percent).
    pub residual: f64,
    /// Displacement correction (percent).
    pub correction: f64,
    /// Heat flux residual (percent).
    pub flux: f64,
    /// Temperature correction (percent).
    pub temperature: f64,
}

/// Reads a file: its iterations in order, and where it is truncated.
///
/// # Errors
/// If it is not such a file, or a row is invalid.
pub fn read(from: impl BufRead) -> Result<Table<(RunPosition, Norms)>, FormatError> {
    let mut rows = Vec::new();
    let take = |line: ResultLine, fields: &[Field]| {
        let &[
            step,
            increment,
            attempt,
            iteration,
            elements,
            ref percent @ ..,
        ] = fields
        else {
            return Err(line.ends_early(short(fields.len())));
        };
        let &[residual, correction, flux, temperature] = percent else {
            return Err(line.ends_early(short(fields.len())));
        };
        let at = RunPosition {
            step: step.whole_number("step")?,
            increment: increment.whole_number("increment")?,
            attempt: attempt.whole_number("attempt")?,
            iteration: iteration.whole_number("iteration")?,
        };
        let norms = Norms {
            elements: elements.whole_number("number of contact elements")?,
            residual: residual.number("force residual")?,
            correction: correction.number("displacement correction")?,
            flux: flux.number("flux residual")?,
            temperature: temperature.number("temperature correction")?,
        };
        rows.push((at, norms));
        Ok(())
    };
    // The zero in the title is CalculiX's.
    let stop = table(from, "SUMMARY OF C0NVERGENCE INFORMATION", ".cvg", take)?;
    Ok((rows, stop))
}

fn short(count: usize) -> String {
    format!("a row must have 9 columns; this one has {count}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculix::Stop;

    const CVG: &str = "SUMMARY OF C0NVERGENCE INFORMATION
  STEP   INC  ATT   ITER     CONT.   RESID.        CORR.      RESID.      CORR.
                              EL.    FORCE         DISP       FLUX        TEMP.
                              (#)     (%)           (%)        (%)         (%)
     1     1     1     1        1  0.2500E+03  0.1000E+03  0.0000E+00  0.0000E+00
     2     1     5     7       12  0.1140E+04  0.9987-101         NaN  0.0000E+00
";

    #[test]
    fn iterations_with_their_numbers() {
        let (rows, stop) = read(CVG.as_bytes()).unwrap();
        assert_eq!((rows.len(), stop), (2, None));
        let (at, norms) = rows[1];
        assert_eq!(
            (at.step, at.increment, at.attempt, at.iteration),
            (2, 1, 5, 7)
        );
        assert_eq!(
            (norms.elements, norms.residual, norms.correction),
            (12, 1140.0, 0.9987e-101)
        );
        assert!(norms.flux.is_nan());
    }

    #[test]
    fn errors_are_reported_and_truncated_files_are_read_up_to_their_end() {
        let (rows, stop) = read(&CVG.as_bytes()[..CVG.len() - 1]).unwrap();
        assert_eq!((rows.len(), stop), (1, Some(Stop::Cut(6))));
        let row = |text: &str| read(format!("{CVG}{text}\n").as_bytes()).unwrap_err().at;
        assert_eq!(row(" 1 1 1 1 1 0. 0. 0."), Some((7, 20)));
        assert_eq!(row(" 1 1 1 -1 1 0. 0. 0. 0."), Some((7, 8)));
        assert_eq!(row(" 1 1 1 1 1 0. x 0. 0."), Some((7, 15)));
    }
}
