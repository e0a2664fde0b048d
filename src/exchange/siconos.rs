//! Friction problems in Siconos' plain-text format: `FrictionContactProblem` and `GlobalFrictionContactProblem`
//! ([`crate::problem`] has the equations).
//!
//! Numbers separated by spaces, in this order: dimension d (2 or 3) and number of contacts m; the matrices, W, or M and H; then q (d m
//! numbers), or q (here f, as many as M has rows) and b (d m numbers); and mu (m). A matrix consists of its storage type, rows
//! and columns, followed by its data:
//!
//! - `0`, dense: rows and columns again, then all entries, column by column;
//! - `1`, sparse blocks: number of blocks, of block rows and of block columns; the row at which each block row ends, the column
//!   at which each block column ends; the lengths of two index lists, and the lists themselves: the first block of each block row
//!   (with a final end index), and the block column of each block; then each block: its number, and its entries column by column.
//!   If the number of blocks is 0, the rest is omitted;
//! - `2`, CSparse's print format: an origin (4 if only one half of a symmetric matrix is stored), a title, sizes with `nnz:
//!   COUNT`, then `col J : locations A to B` (or `row I : …`, after `csr:`) before the `I : VALUE` of each column (row), or,
//!   after `triplet:`, `I J : VALUE`. Siconos writes values with six digits.
//!
//! A global problem is recognised by the size of its first matrix; if M has the same size as W would, by the three whole numbers
//! at the start of H and by more words than a local problem would have left. Trailing text in the file is ignored.

use crate::FormatError;
use crate::bail;
use crate::problem::{Global, Local, Matrix, Problem, is_there};
use crate::words::Words;
use std::fmt::{Debug, Write};

/// Reads such a file.
///
/// # Errors
/// The error with its position.
pub fn read(text: &str) -> Result<Problem, FormatError> {
    let mut words = Words::new(text);
    let (dimension, contacts) = head(&mut words)?;
    let Some(size) = contacts.checked_mul(dimension) else {
        bail!(
            words.place(),
            "the problem has {contacts} contacts, which is far too many"
        );
    };
    body(&mut words, contacts, size)
}

/// The number of contacts in such a file, and its line and column.
///
/// # Errors
/// An error before that number, with its position.
pub fn contacts(text: &str) -> Result<(usize, (usize, usize)), FormatError> {
    let mut words = Words::new(text);
    let (_, contacts) = head(&mut words)?;
    Ok((contacts, words.place()))
}

/// Relative accuracy of the matrix of such a file: CSparse's print format has six digits.
pub fn accuracy(text: &str) -> f64 {
    match text.split_whitespace().nth(2) {
        Some("2") => 5e-6,
        _ => 0.0,
    }
}

fn head(words: &mut Words<'_>) -> Result<(usize, usize), FormatError> {
    let dimension = words.count("the dimension")?;
    if !(2..=3).contains(&dimension) {
        bail!(
            words.place(),
            "the file begins with {dimension}; a Siconos friction problem begins with its dimension, 2 or 3, and \
             a scene with a bracket"
        );
    }
    let contacts = words.count("the number of contacts")?;
    if contacts == 0 {
        bail!(
            words.place(),
            "the problem has 0 contacts; it must have at least 1"
        );
    }
    Ok((dimension, contacts))
}

fn body(words: &mut Words<'_>, contacts: usize, size: usize) -> Result<Problem, FormatError> {
    let first = matrix(words, "W", None, size)?;
    if first.rows == size && !begins_matrix(words, size, contacts) {
        return Ok(Problem::Local(Local {
            w: first,
            q: words.numbers(size, "q")?,
            mu: words.coefficients(contacts)?,
        }));
    }
    let h = matrix(words, "H", Some((first.rows, size)), size)?;
    Ok(Problem::Global(Global {
        f: words.numbers(first.rows, "q of a global problem")?,
        m: first,
        h,
        b: words.numbers(size, "b")?,
        mu: words.coefficients(contacts)?,
    }))
}

/// Whether the text after a first matrix with the rows of W is a second matrix.
fn begins_matrix(words: &Words<'_>, size: usize, contacts: usize) -> bool {
    let mut left = words.left();
    let mut whole = || left.next().and_then(|word| word.parse::<usize>().ok());
    let head = [whole(), whole(), whole()];
    let stored = head[0].is_some_and(|storage| storage <= 2);
    stored
        && head[1..] == [Some(size); 2]
        && words.left().nth(size.saturating_add(contacts)).is_some()
}

/// Rejects a wrong number of rows if the number of columns, which follows, is that of a local problem.
fn squared(words: &Words<'_>, rows: usize, local: usize, of_rows: &str) -> Result<(), FormatError> {
    let columns = words.peek().and_then(|word| word.parse::<usize>().ok());
    if rows != local && columns == Some(local) {
        Err(words.broken(format!("{of_rows} is {rows}; it must be {local}")))
    } else {
        Ok(())
    }
}

/// A matrix; it must be square if its size is not given, as for a local problem.
fn matrix(
    words: &mut Words<'_>,
    name: &str,
    size: Option<(usize, usize)>,
    local: usize,
) -> Result<Matrix, FormatError> {
    let entries = match words.count(&format!("the storage of {name}"))? {
        0 => dense,
        1 => blocks,
        2 => sparse,
        other => {
            bail!(
                words.place(),
                "{name} is in storage {other}; it must be 0 (dense), 1 (sparse blocks) or 2 (CSparse)"
            );
        }
    };
    let (of_rows, of_columns) = (
        format!("the number of rows of {name}"),
        format!("the number of columns of {name}"),
    );
    let rows = match size {
        Some((rows, _)) => words.exactly(rows, &of_rows).map(|()| rows)?,
        None => words.count(&of_rows)?,
    };
    if rows == 0 {
        bail!(words.place(), "{name} has 0 rows; it must have at least 1");
    }
    if size.is_none() {
        squared(words, rows, local, &of_rows)?;
    }
    let columns = size.map_or(rows, |(_, columns)| columns);
    words.exactly(columns, &of_columns)?;
    Ok(Matrix {
        rows,
        columns,
        entries: entries(words, rows, columns, name)?,
    })
}

type Entries = Vec<(usize, usize, f64)>;

fn dense(
    words: &mut Words<'_>,
    rows: usize,
    columns: usize,
    name: &str,
) -> Result<Entries, FormatError> {
    words.exactly(rows, &format!("the number of rows of {name}"))?;
    words.exactly(columns, &format!("the number of columns of {name}"))?;
    let what = format!("an entry of {name}");
    let mut entries = Vec::new();
    for column in 0..columns {
        for row in 0..rows {
            let value = words.number(&what)?;
            if is_there(value) {
                entries.push((row, column, value));
            }
        }
    }
    Ok(entries)
}

fn blocks(
    words: &mut Words<'_>,
    rows: usize,
    columns: usize,
    name: &str,
) -> Result<Entries, FormatError> {
    let what = format!("an entry of {name}");
    let mut entries = Vec::new();
    let count = words.count("the number of blocks")?;
    if count == 0 {
        return Ok(entries);
    }
    if count > rows.saturating_mul(columns) {
        bail!(
            words.place(),
            "{name} has {count} blocks, more than it has entries"
        );
    }
    let down = words.count_up_to(rows, "the number of block rows")?;
    let across = words.count_up_to(columns, "the number of block columns")?;
    let row_ends = ends(words, down, rows, "block row", name)?;
    let column_ends = ends(words, across, columns, "block column", name)?;
    words.exactly(down + 1, "the length of the first index list")?;
    words.exactly(count, "the length of the second index list")?;
    let mut begins = Vec::new();
    for k in 0..=down {
        let begin = words.count_up_to(count, "the first block of a block row")?;
        let least = begins.last().copied().unwrap_or(0);
        if begin < least || (k == 0 && begin != 0) || (k == down && begin != count) {
            bail!(
                words.place(),
                "{begin} is not a valid first block of a block row; the list must start at 0, be ascending, and end at {count}"
            );
        }
        begins.push(begin);
    }
    let mut column_of = Vec::new();
    for _ in 0..count {
        column_of.push(words.count_up_to(across - 1, "a block column")?);
    }
    for (row, blocks) in begins.windows(2).enumerate() {
        for (number, &across) in column_of.iter().enumerate().take(blocks[1]).skip(blocks[0]) {
            words.exactly(number, "the number of a block")?;
            for column in range(&column_ends, across) {
                for line in range(&row_ends, row) {
                    entries.push((line, column, words.number(&what)?));
                }
            }
        }
    }
    Ok(entries)
}

/// Ends of blocks: ascending, up to `size`.
fn ends(
    words: &mut Words<'_>,
    count: usize,
    size: usize,
    what: &str,
    name: &str,
) -> Result<Vec<usize>, FormatError> {
    let mut ends: Vec<usize> = Vec::new();
    for k in 0..count {
        let end = words.count_up_to(size, &format!("the end of a {what}"))?;
        let least = ends.last().map_or(1, |last| last + 1);
        if end < least || (k + 1 == count && end != size) {
            bail!(
                words.place(),
                "a {what} ends at {end}; the ends must be ascending, up to {size}"
            );
        }
        ends.push(end);
    }
    if ends.is_empty() {
        bail!(words.place(), "{name} has no {what}");
    }
    Ok(ends)
}

/// The rows or columns of a block.
fn range(ends: &[usize], block: usize) -> std::ops::Range<usize> {
    let start = if block == 0 { 0 } else { ends[block - 1] };
    start..ends[block]
}

/// The origin with which Siconos marks one half of a symmetric matrix in triplets.
const HALF: &str = "4";

fn sparse(
    words: &mut Words<'_>,
    rows: usize,
    columns: usize,
    name: &str,
) -> Result<Entries, FormatError> {
    let origin = words.next("the origin of a sparse matrix")?;
    let (mut triplets, mut by_rows) = (false, false);
    loop {
        match words.next("\"nnz:\", the number of entries,")? {
            "triplet:" => triplets = true,
            "csr:" => by_rows = true,
            "nnz:" => break,
            _ => {}
        }
    }
    let text = words.next("the number of entries")?;
    let count: usize = text
        .trim_end_matches(',')
        .parse()
        .map_err(|_| words.unlike(text, "the number of entries, a whole number"))?;
    words.line();
    let (list, lists, others) = if by_rows {
        ("row", rows, columns)
    } else {
        ("col", columns, rows)
    };
    let what = format!("an entry of {name}");
    let mut entries = Vec::new();
    let mut current = None;
    while entries.len() < count {
        let text = words.next(&what)?;
        if !triplets && text == list {
            current = Some(words.count_up_to(lists - 1, &format!("the number of a {list}"))?);
            words.line();
            continue;
        }
        let most = if triplets { rows } else { others };
        let first: usize = text.parse().ok().filter(|&at| at < most).ok_or_else(|| {
            words.unlike(text, &format!("an index, 0 to {}", most.saturating_sub(1)))
        })?;
        let (row, column) = match (triplets, current) {
            (true, _) => (first, words.count_up_to(columns - 1, "a column")?),
            (false, Some(list)) if by_rows => (list, first),
            (false, Some(list)) => (first, list),
            (false, None) => {
                let wanted = format!("\"{list}\", since none has been named,");
                return Err(words.unlike(text, &wanted));
            }
        };
        let colon = words.next("a colon")?;
        if colon != ":" {
            return Err(words.unlike(colon, "a colon"));
        }
        entries.push((row, column, words.number(&what)?));
    }
    if !triplets {
        // Columns without entries may also be listed at the end.
        while words.peek() == Some(list) {
            words.next(list)?;
            words.line();
        }
    }
    if triplets && origin == HALF {
        let other: Entries = entries
            .iter()
            .filter(|(i, j, _)| i != j)
            .map(|&(i, j, v)| (j, i, v))
            .collect();
        entries.extend(other);
    }
    Ok(entries)
}

/// The file of a local problem. Numbers are written with enough digits to be read back exactly.
pub fn write(problem: &Local) -> String {
    let size = problem.q.len();
    let mut text = format!("{}\n{}\n", problem.dimension(), problem.mu.len());
    let rows = problem.w.dense();
    let _ = writeln!(text, "0\n{size}\n{size}\n{size}\t{size}");
    for column in 0..size {
        line(&mut text, rows.iter().map(|row| row[column]));
    }
    line(&mut text, problem.q.iter());
    line(&mut text, problem.mu.iter());
    text
}

/// Words on one line, separated by spaces.
fn line(text: &mut String, words: impl Iterator<Item = impl Debug>) {
    for word in words {
        let _ = write!(text, "{word:?} ");
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LOCAL: &str = "2\n1\n0\n2\n2\n2 2\n1.0 0.5\n0.25 2.0\n-1.0 0.1\n0.3\n";

    fn local(text: &str) -> Local {
        match read(text) {
            Ok(Problem::Local(local)) => local,
            other => panic!("{other:?}"),
        }
    }

    fn global(text: &str) -> Global {
        match read(text) {
            Ok(Problem::Global(global)) => global,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_local_problem_is_stored_by_columns() {
        let read = local(LOCAL);
        assert_eq!(read.w.dense(), [[1.0, 0.25], [0.5, 2.0]]);
        assert_eq!((read.q, read.mu), (vec![-1.0, 0.1], vec![0.3]));
    }

    #[test]
    fn a_global_problem_is_recognised_by_its_matrices() {
        let rest = "0\n3\n2\n3 2\n1 0 0\n0 1 0\n7.0 8.0 9.0\n-0.5 0.0\n0.3\n";
        let dense = format!("2\n1\n0\n3\n3\n3 3\n1 0 0 0 2 0 0 0 3\n{rest}");
        let sparse = "1\nCSparse Version 4.4\ntriplet: 3-by-3, nzmax: 3 nnz: 3\n 0 0 : 1\n 1 1 : 2\n 2 2 : 3\n";
        let sparse = format!("2\n1\n2\n3\n3\n{sparse}{rest}");
        let rows = "3\nCSparse\ncsr: 3-by-3, nzmax: 3 nnz: 3, 1-norm: 3\nrow 0 : locations 0 to 0\n0 : 1\n\
                    row 1 : locations 1 to 1\n1 : 2\nrow 2 : locations 2 to 2\n2 : 3\n";
        let rows = format!("2\n1\n2\n3\n3\n{rows}{rest}");
        for text in [dense, sparse, rows] {
            let read = global(&text);
            assert_eq!(
                read.m.dense(),
                [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]
            );
            assert_eq!(read.h.dense(), [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]);
            assert_eq!(
                (read.f, read.b, read.mu),
                (vec![7.0, 8.0, 9.0], vec![-0.5, 0.0], vec![0.3])
            );
        }
        // As many unknowns as contact components.
        let square = "2\n1\n0\n2\n2\n2 2\n1 0 0 2\n1\n2\n2\n0\n7.0 8.0\n-0.5 0.0\n0.3\n";
        assert_eq!(global(square).m.dense(), [[1.0, 0.0], [0.0, 2.0]]);
        // One half of a symmetric matrix.
        let half =
            "4\nCSparse\ntriplet: 3-by-3, nzmax: 4 nnz: 4\n0 0 : 1\n1 1 : 2\n2 2 : 3\n0 1 : 5\n";
        let read = global(&format!("2\n1\n2\n3\n3\n{half}{rest}"));
        assert_eq!(
            read.m.dense(),
            [[1.0, 5.0, 0.0], [5.0, 2.0, 0.0], [0.0, 0.0, 3.0]]
        );
    }

    #[test]
    fn errors_have_a_position() {
        let cases = [
            ("7\n", (1, 1), "begins with its dimension"),
            ("2\n0\n", (2, 1), "0 contacts"),
            ("2\n1\n9\n", (3, 1), "storage 9"),
            ("2\n1\n0\n2\n3\n", (5, 1), "must be 2"),
            ("2\n1\n0\n0\n0\n", (4, 1), "0 rows"),
            ("2\n1\n0\n2\n2\n2 2\n1 0 0 x\n", (7, 7), "finite"),
            (
                "2\n1\n0\n2\n2\n2 2\n1 0 0 1\n0.0 0.0 -1.0\n",
                (8, 9),
                "negative",
            ),
            ("2\n1\n1\n2\n2\n1\n1 1\n1\n", (8, 1), "ascending"),
            (
                "2\n1\n2\n2\n2\n1 t nnz: 1\n0 : 1.0",
                (7, 1),
                "none has been named",
            ),
            (
                "2\n1\n2\n2\n2\n1 t nnz: 1\ncol 0 : locations\n2 : 1.0",
                (8, 1),
                "0 to 1",
            ),
            ("2\n18446744073709551615\n", (2, 1), "far too many"),
            (
                "2\n1000000000000\n1\n2000000000000\n2000000000000\n0\n1.0\n",
                (7, 1),
                "ends",
            ),
        ];
        for (text, at, told) in cases {
            let broken = read(text).unwrap_err();
            assert_eq!(broken.at, Some(at), "{text:?}: {broken}");
            assert!(broken.message.contains(told), "{text:?}: {broken}");
        }
    }

    proptest! {
        #[test]
        fn written_files_are_read_back_exactly(
            rows in prop::collection::vec(prop::collection::vec(-1e300..1e300_f64, 4), 4),
            q in prop::collection::vec(-1e300..1e300_f64, 4),
            mu in prop::collection::vec(0.0..9.0_f64, 2),
        ) {
            let problem = Local { w: Matrix::from_rows(&rows), q, mu };
            let found = local(&write(&problem));
            prop_assert_eq!(found.w.dense(), rows);
            prop_assert_eq!((&found.q, &found.mu), (&problem.q, &problem.mu));
        }

        #[test]
        fn no_text_makes_the_reader_panic(
            rest in "[0-4. :\\-\ncolrow]{0,80}",
            size in 0_u8..4,
            storage in 0_u8..4,
            any in any::<String>(),
        ) {
            let _ = read(&format!("2\n1\n{storage}\n{size}\n{size}\n{rest}"));
            let _ = read(&format!("2\n1\n2\n2\n2\n1 triplet: nnz: 3\n{rest}"));
            let _ = read(&format!("2\n1\n2\n2\n2\n1 csr: nnz: 3\n{rest}"));
            let _ = read(&any);
        }
    }
}
