//! The Matrix Market exchange format (Boisvert, Pozo & Remington, NISTIR 5935): one matrix per file.
//!
//! ```text
//! %%MatrixMarket matrix coordinate real general       or array; real or integer; general, symmetric or skew-symmetric
//! % comments
//! ROWS COLUMNS ENTRIES                                 of an array: ROWS COLUMNS
//! I J VALUE                                            from 1; of an array: values, column by column
//! ```
//!
//! A symmetric matrix is stored by its lower half, a skew-symmetric one by the part below the diagonal. Case and additional words
//! in the first line do not matter. Patterns, which have no values, and complex matrices are rejected.

use crate::FormatError;
use crate::bail;
use crate::problem::{Matrix, is_there};
use crate::words::{Words, quoted};
use std::fmt::Write;

/// Start of such a file.
pub const MARK: &str = "%%MatrixMarket";

#[derive(Clone, Copy, PartialEq)]
enum Symmetry {
    General,
    Symmetric,
    Skew,
}

/// Reads such a file.
///
/// # Errors
/// The error with its position.
pub fn read(text: &str) -> Result<Matrix, FormatError> {
    let head = text.lines().next().unwrap_or_default();
    let (coordinate, symmetry) = header(head)?;
    let body = without_comments(text);
    let mut words = Words::new(&body);
    let rows = words.count("the number of rows")?;
    let columns = words.count("the number of columns")?;
    if symmetry != Symmetry::General && rows != columns {
        bail!(
            words.place(),
            "a matrix with {rows} rows and {columns} columns cannot be symmetric or skew-symmetric"
        );
    }
    let mut read = MatrixBuilder {
        matrix: Matrix {
            rows,
            columns,
            entries: Vec::new(),
        },
        symmetry,
    };
    if coordinate {
        read.coordinates(&mut words)?
    } else {
        read.array(&mut words)?
    }
    if let Some(more) = words.peek() {
        words.next(more)?;
        return Err(words.unlike(more, "the end of the file, after the last entry,"));
    }
    Ok(read.matrix)
}

/// Whether entries have coordinates, and which of them are stored.
fn header(line: &str) -> Result<(bool, Symmetry), FormatError> {
    let mut words = line.split_whitespace().map(str::to_lowercase);
    let mut next = || words.next().unwrap_or_default();
    let begins = [next(), next()];
    if begins != [MARK.to_lowercase(), "matrix".to_owned()] {
        return Err(FormatError::at(
            1,
            1,
            format!(
                "the file must begin with \"{MARK} matrix coordinate real general\" or similar"
            ),
        ));
    }
    let unlike = |word: &str, wanted: &str| {
        let column = line
            .to_lowercase()
            .find(word)
            .map_or(1, |byte| 1 + line[..byte.min(line.len())].chars().count());
        FormatError::at(
            1,
            column,
            format!("the matrix is {}; it must be {wanted}", quoted(word)),
        )
    };
    let format = next();
    let coordinate = match format.as_str() {
        "coordinate" => true,
        "array" => false,
        other => return Err(unlike(other, "\"coordinate\" or \"array\"")),
    };
    match next().as_str() {
        "real" | "integer" | "double" => {}
        "pattern" => {
            return Err(unlike(
                "pattern",
                "real or integer: a pattern has no values",
            ));
        }
        other => return Err(unlike(other, "real or integer")),
    }
    let symmetry = match next().as_str() {
        "general" => Symmetry::General,
        "symmetric" => Symmetry::Symmetric,
        "skew-symmetric" => Symmetry::Skew,
        other => return Err(unlike(other, "general, symmetric or skew-symmetric")),
    };
    Ok((coordinate, symmetry))
}

/// The text with spaces instead of comments, so that positions are unchanged.
fn without_comments(text: &str) -> String {
    let lines = text
        .split_inclusive('\n')
        .map(|line| match line.starts_with('%') {
            true if line.ends_with('\n') => "\n",
            true => "",
            false => line,
        });
    lines.collect()
}

struct MatrixBuilder {
    matrix: Matrix,
    symmetry: Symmetry,
}

impl MatrixBuilder {
    fn coordinates(&mut self, words: &mut Words<'_>) -> Result<(), FormatError> {
        for _ in 0..words.count("the number of entries")? {
            let mut index = |most: usize, what: &str| {
                let at = words.count(what)?;
                if (1..=most).contains(&at) {
                    Ok(at - 1)
                } else {
                    Err(words.broken(format!("{what} is {at}; it must be 1 to {most}")))
                }
            };
            let row = index(self.matrix.rows, "a row")?;
            let column = index(self.matrix.columns, "a column")?;
            if self.symmetry == Symmetry::Skew && row == column {
                bail!(
                    words.place(),
                    "a skew-symmetric matrix has no diagonal entries"
                );
            }
            self.add(row, column, words.number("an entry")?);
        }
        Ok(())
    }

    fn array(&mut self, words: &mut Words<'_>) -> Result<(), FormatError> {
        for column in 0..self.matrix.columns {
            let first = match self.symmetry {
                Symmetry::General => 0,
                Symmetry::Symmetric => column,
                Symmetry::Skew => column + 1,
            };
            for row in first..self.matrix.rows {
                let value = words.number("an entry")?;
                if is_there(value) {
                    self.add(row, column, value);
                }
            }
        }
        Ok(())
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        let entries = &mut self.matrix.entries;
        entries.push((row, column, value));
        match self.symmetry {
            Symmetry::General => {}
            _ if row == column => {}
            Symmetry::Symmetric => entries.push((column, row, value)),
            Symmetry::Skew => entries.push((column, row, -value)),
        }
    }
}

/// The file of a matrix from its entries; duplicate entries are added. Numbers are written with enough digits to be read back
/// exactly. Comments follow the first line.
pub fn write(matrix: &Matrix, comments: &[&str]) -> String {
    let mut entries = matrix.clone().merged().entries;
    entries.sort_by_key(|&(row, column, _)| (column, row));
    let mut text = head("coordinate", comments);
    let _ = writeln!(text, "{} {} {}", matrix.rows, matrix.columns, entries.len());
    for (row, column, value) in entries {
        let _ = writeln!(text, "{} {} {value:?}", row + 1, column + 1);
    }
    text
}

/// The file of a column of numbers.
pub fn write_column(numbers: &[f64], comments: &[&str]) -> String {
    let mut text = head("array", comments);
    let _ = writeln!(text, "{} 1", numbers.len());
    for value in numbers {
        let _ = writeln!(text, "{value:?}");
    }
    text
}

fn head(format: &str, comments: &[&str]) -> String {
    let mut text = format!("{MARK} matrix {format} real general\n");
    for line in comments.iter().flat_map(|comment| comment.lines()) {
        let _ = writeln!(text, "% {line}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn dense(text: &str) -> Vec<Vec<f64>> {
        read(text)
            .unwrap_or_else(|broken| panic!("{broken:?}"))
            .dense()
    }

    #[test]
    fn every_format_of_a_matrix_is_read() {
        let general = "%%MatrixMarket matrix coordinate real general\n% words\n\n2 3 3\n1 1 1.5\n2 3 -2\n2 3 -1e0\n";
        assert_eq!(dense(general), [[1.5, 0.0, 0.0], [0.0, 0.0, -3.0]]);
        let symmetric = "%%matrixmarket MATRIX Coordinate Integer Symmetric\n2 2 2\n1 1 4\n2 1 3\n";
        assert_eq!(dense(symmetric), [[4.0, 3.0], [3.0, 0.0]]);
        let skew = "%%MatrixMarket matrix array real skew-symmetric\n2 2\n5\n";
        assert_eq!(dense(skew), [[0.0, -5.0], [5.0, 0.0]]);
        let array = "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n";
        assert_eq!(dense(array), [[1.0, 3.0], [2.0, 4.0]]);
        let half = "%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n4\n";
        assert_eq!(dense(half), [[1.0, 2.0], [2.0, 4.0]]);
    }

    #[test]
    fn errors_have_a_position() {
        let with = |rest: &str| format!("%%MatrixMarket matrix coordinate real general\n{rest}");
        let cases = [
            ("hello".to_owned(), (1, 1), "must begin"),
            (
                "%%MatrixMarket matrix coordinate pattern general\n1 1 0\n".to_owned(),
                (1, 34),
                "no values",
            ),
            (
                "%%MatrixMarket matrix array complex general\n1 1\n".to_owned(),
                (1, 29),
                "complex",
            ),
            (
                "%%MatrixMarket matrix array real hermitian\n1 1\n".to_owned(),
                (1, 34),
                "symmetric",
            ),
            (
                "%%MatrixMarket matrix array real symmetric\n1 2\n".to_owned(),
                (2, 3),
                "cannot be symmetric",
            ),
            (with("2 2 1\n% c\n3 1 1.0\n"), (4, 1), "1 to 2"),
            (with("2 2 1\n1 0 1.0\n"), (3, 3), "1 to 2"),
            (with("2 2 1\n1 1 x\n"), (3, 5), "finite"),
            (with("2 2 2\n1 1 1.0\n"), (3, 5), "ends"),
            (with("2 2 1\n1 1 1.0\n7"), (4, 1), "end of the file"),
            (with("99999999999999999999 2 1\n"), (2, 1), "whole"),
        ];
        for (text, at, told) in cases {
            let broken = read(&text).unwrap_err();
            assert_eq!(broken.at, Some(at), "{text}: {broken}");
            assert!(broken.message.contains(told), "{text}: {broken}");
        }
    }

    proptest! {
        #[test]
        fn written_files_are_read_back_exactly(
            rows in prop::collection::vec(prop::collection::vec(-1e300..1e300_f64, 3), 1..5),
        ) {
            let matrix = Matrix::from_rows(&rows);
            let read_back = read(&write(&matrix, &["two\nlines"])).unwrap();
            prop_assert_eq!(read_back.dense(), rows.clone());
            let column: Vec<f64> = rows.concat();
            let read_back = read(&write_column(&column, &[])).unwrap().dense();
            prop_assert_eq!(read_back.concat(), column);
        }

        #[test]
        fn no_text_makes_the_reader_panic(
            rest in "[0-9. %\\-\ne+]{0,60}",
            format in "(array|coordinate) (real|integer|pattern) (general|symmetric|skew-symmetric)",
            any in any::<String>(),
        ) {
            let _ = read(&format!("{MARK} matrix {format}\n{rest}"));
            let _ = read(&format!("{MARK}{any}"));
            let _ = read(&any);
        }
    }
}
