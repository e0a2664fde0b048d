//! Friction problems in the plain-text form of Siconos (`FrictionContactProblem`), in the plane.
//!
//! ```text
//! u = W r + q,     0 <= u_n ⊥ r_n >= 0,     |r_t| <= mu r_n, against u_t     (n, t of each contact in turn)
//! ```
//!
//! Numbers apart by blanks, in this order: dimension (2), number of contacts m, storage of W, its rows and columns (2 m
//! each); then W, q (2 m numbers) and mu (m). W is stored as
//!
//! - `0`, dense: rows and columns once more, then all entries, column by column;
//! - `1`, sparse blocks: number of blocks, of block rows and of block columns; the row at which each block row ends, the
//!   column at which each block column ends; the lengths of two index lists, which follow: where the blocks of each block
//!   row begin (and, last, where they end), and the block column of each block; then each block, its number first, its
//!   entries column by column. Where the number of blocks is 0, nothing of this follows it;
//! - `2`, compressed columns as CSparse prints them: an origin, a title, sizes with `nnz: COUNT`, then `col J : locations
//!   A to B` before the `I : VALUE` of each column, six digits a value.
//!
//! The scene that comes of it has all contacts at gap 0 and free, and takes the unloaded motion q, and so u and r, in one
//! increment. A trailing rest of the file is not read.

use super::limits;
use crate::format::condensed::{Contact, Matrix, Problem, at_once};
use crate::format::locate::line_and_column;
use crate::model::{Friction, InitialState, Mode, Settings, Solver};

/// A friction problem in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction2d {
    /// W, row by row: 2 m rows and columns.
    pub w: Vec<Vec<f64>>,
    /// q: 2 m numbers.
    pub q: Vec<f64>,
    /// Friction coefficients of the m contacts.
    pub mu: Vec<f64>,
}

/// What is wrong with a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Broken {
    /// Line, from 1; that of the last word where the file ends too early.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// What is wrong, and what would be right.
    pub message: String,
}

/// How to write W.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// All entries, row by row.
    Dense,
    /// Blocks of 2 by 2, those that are zero left out.
    Blocks,
}

/// Whether a text could be such a file: it begins with a number, as no scene does.
pub fn is_one(text: &str) -> bool {
    text.trim_start().starts_with(|c: char| c.is_ascii_digit())
}

/// Reads such a file.
///
/// # Errors
/// What is wrong, and in which line.
pub fn read(text: &str) -> Result<Friction2d, Broken> {
    read_within(text, None)
}

/// Reads such a file, which may take so much memory (GB; none: what is free).
///
/// # Errors
/// As [`read`].
pub fn read_within(text: &str, memory: Option<f64>) -> Result<Friction2d, Broken> {
    let mut words = Words::new(text);
    match words.count("the dimension")? {
        2 => {}
        3 => {
            return Err(words.broken(
                "the problem is one in space (dimension 3); only those in the plane (2) can be read",
            ));
        }
        other => {
            return Err(words.broken(&format!(
                "the file begins with {other}; a friction problem of Siconos begins with its dimension, 2, and a scene \
                 with a bracket"
            )));
        }
    }
    let contacts = words.count("the number of contacts")?;
    if contacts == 0 {
        return Err(words.broken("the problem has 0 contacts; it must have 1 at least"));
    }
    let entries = 4.0 * (contacts as f64).powi(2);
    limits::memory(entries * limits::ENTRY_BYTES, memory).map_err(|why| {
        words.broken(&format!(
            "the problem has {contacts} contacts; its matrix takes {why}"
        ))
    })?;
    let size = 2 * contacts;
    let matrix = match words.count("the storage of W")? {
        0 => dense,
        1 => blocks,
        2 => columns,
        other => {
            return Err(words.broken(&format!(
                "W is in storage {other}; it must be 0 (dense), 1 (sparse blocks) or 2 (compressed columns)"
            )));
        }
    };
    words.exactly(size, "the number of rows of W")?;
    words.exactly(size, "the number of columns of W")?;
    let w = matrix(&mut words, size)?;
    let q = words.numbers(size, "q")?;
    let mut mu = Vec::with_capacity(contacts);
    for _ in 0..contacts {
        let value = words.number("a friction coefficient")?;
        if value < 0.0 {
            return Err(words.broken(&format!(
                "the friction coefficient is {value:?}; it must not be negative"
            )));
        }
        mu.push(value);
    }
    Ok(Friction2d { w, q, mu })
}

fn dense(words: &mut Words<'_>, size: usize) -> Result<Vec<Vec<f64>>, Broken> {
    words.exactly(size, "the number of rows of W")?;
    words.exactly(size, "the number of columns of W")?;
    let mut w = vec![vec![0.0; size]; size];
    for column in 0..size {
        for row in &mut w {
            row[column] = words.number("an entry of W")?;
        }
    }
    Ok(w)
}

fn blocks(words: &mut Words<'_>, size: usize) -> Result<Vec<Vec<f64>>, Broken> {
    let mut w = vec![vec![0.0; size]; size];
    let count = words.count("the number of blocks")?;
    if count == 0 {
        return Ok(w);
    }
    if count > size * size {
        return Err(words.broken(&format!("W has {count} blocks, more than entries")));
    }
    let down = words.count_up_to(size, "the number of block rows")?;
    let across = words.count_up_to(size, "the number of block columns")?;
    let row_ends = words.ends(down, size, "block row")?;
    let column_ends = words.ends(across, size, "block column")?;
    words.exactly(down + 1, "the length of the first index list")?;
    words.exactly(count, "the length of the second index list")?;
    let mut begins = Vec::with_capacity(down + 1);
    for k in 0..=down {
        let begin = words.count_up_to(count, "where the blocks of a block row begin")?;
        let least = begins.last().copied().unwrap_or(0);
        if begin < least || (k == 0 && begin != 0) || (k == down && begin != count) {
            return Err(words.broken(&format!(
                "{begin} stands where the blocks of a block row begin; they begin at 0, rise, and end at {count}"
            )));
        }
        begins.push(begin);
    }
    let mut column_of = Vec::with_capacity(count);
    for _ in 0..count {
        column_of.push(words.count_up_to(across - 1, "a block column")?);
    }
    for row in 0..down {
        let here = begins[row]..begins[row + 1];
        for (number, &block_column) in here.clone().zip(&column_of[here]) {
            words.exactly(number, "the number of a block")?;
            for column in range(&column_ends, block_column) {
                for line in range(&row_ends, row) {
                    w[line][column] = words.number("an entry of W")?;
                }
            }
        }
    }
    Ok(w)
}

/// The rows or columns of a block.
fn range(ends: &[usize], block: usize) -> std::ops::Range<usize> {
    let start = if block == 0 { 0 } else { ends[block - 1] };
    start..ends[block]
}

fn columns(words: &mut Words<'_>, size: usize) -> Result<Vec<Vec<f64>>, Broken> {
    while words.next("\"nnz:\", the number of entries,")? != "nnz:" {}
    let text = words.next("the number of entries")?;
    let count: usize = text
        .trim_end_matches(',')
        .parse()
        .map_err(|_| words.unlike(text, "the number of entries, a whole number"))?;
    words.rest_of_line();
    let mut w = vec![vec![0.0; size]; size];
    let mut column = None;
    let mut done = 0;
    while done < count {
        let text = words.next("an entry of W")?;
        if text == "col" {
            column = Some(words.count_up_to(size - 1, "a column")?);
            words.rest_of_line();
            continue;
        }
        let row: usize = text
            .parse()
            .ok()
            .filter(|&row| row < size)
            .ok_or_else(|| words.unlike(text, &format!("a row, 0 to {}", size - 1)))?;
        let Some(column) = column else {
            return Err(words.unlike(text, "\"col\", since no column was named yet"));
        };
        let colon = words.next("a colon")?;
        if colon != ":" {
            return Err(words.unlike(colon, "a colon"));
        }
        w[row][column] = words.number("an entry of W")?;
        done += 1;
    }
    Ok(w)
}

/// The words of a text, with their places.
struct Words<'t> {
    whole: &'t str,
    /// What is not read yet.
    text: &'t str,
    /// Where the last word stands.
    last: usize,
}

impl<'t> Words<'t> {
    fn new(text: &'t str) -> Self {
        Words {
            whole: text,
            text,
            last: 0,
        }
    }

    fn broken(&self, message: &str) -> Broken {
        let (line, column) = line_and_column(self.whole, self.last);
        Broken {
            line,
            column,
            message: message.to_owned(),
        }
    }

    fn unlike(&self, word: &str, wanted: &str) -> Broken {
        let shown = crate::format::error::quoted(word);
        self.broken(&format!("{shown} stands where {wanted} should"))
    }

    fn next(&mut self, what: &str) -> Result<&'t str, Broken> {
        let trimmed = self.text.trim_start();
        let end = trimmed.find(char::is_whitespace).unwrap_or(trimmed.len());
        if end == 0 {
            return Err(self.broken(&format!("the file ends where {what} should stand")));
        }
        self.last = self.whole.len() - trimmed.len();
        self.text = &trimmed[end..];
        Ok(&trimmed[..end])
    }

    fn rest_of_line(&mut self) {
        let end = self.text.find('\n').unwrap_or(self.text.len());
        self.text = &self.text[end..];
    }

    fn count(&mut self, what: &str) -> Result<usize, Broken> {
        let word = self.next(what)?;
        word.parse()
            .map_err(|_| self.unlike(word, &format!("{what}, a whole number,")))
    }

    fn count_up_to(&mut self, most: usize, what: &str) -> Result<usize, Broken> {
        match self.count(what)? {
            count if count <= most => Ok(count),
            count => Err(self.broken(&format!("{what} is {count}; it must be at most {most}"))),
        }
    }

    fn exactly(&mut self, wanted: usize, what: &str) -> Result<(), Broken> {
        match self.count(what)? {
            count if count == wanted => Ok(()),
            count => Err(self.broken(&format!("{what} is {count}; it must be {wanted}"))),
        }
    }

    /// Where blocks end: rising, up to `size`.
    fn ends(&mut self, count: usize, size: usize, what: &str) -> Result<Vec<usize>, Broken> {
        let mut ends: Vec<usize> = Vec::with_capacity(count);
        for k in 0..count {
            let end = self.count_up_to(size, &format!("the end of a {what}"))?;
            let least = ends.last().map_or(1, |last| last + 1);
            if end < least || (k + 1 == count && end != size) {
                return Err(self.broken(&format!(
                    "a {what} ends at {end}; the ends must rise, up to {size}"
                )));
            }
            ends.push(end);
        }
        if ends.is_empty() {
            return Err(self.broken(&format!("W has no {what}")));
        }
        Ok(ends)
    }

    fn number(&mut self, what: &str) -> Result<f64, Broken> {
        let word = self.next(what)?;
        word.parse()
            .ok()
            .filter(|x: &f64| x.abs() <= limits::MAGNITUDE)
            .ok_or_else(|| self.unlike(word, &format!("{what}, a number between -1e12 and 1e12,")))
    }

    fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, Broken> {
        (0..count).map(|_| self.number(what)).collect()
    }
}

impl Friction2d {
    /// The scene's form of it.
    pub fn problem(&self, title: &str) -> Problem {
        let contact = |(k, &mu): (usize, &f64)| Contact {
            id: format!("c{}", k + 1),
            gap: 0.0,
            friction: Friction {
                angle: mu.atan().to_degrees(),
                cohesion: 0.0,
            },
            load: [0.0; 2],
            start: Mode::Free,
            state: InitialState::default(),
        };
        Problem {
            title: title.to_owned(),
            about: "A friction problem in the form of Siconos: u = W r + q.".to_owned(),
            contacts: self.mu.iter().enumerate().map(contact).collect(),
            matrix: Matrix::Compliance(self.w.clone()),
            free: self.q.clone(),
            spacing: None,
            history: at_once(),
            // W is sparse as a rule, and condensing it has nothing to take out.
            settings: Settings {
                solver: Solver::Augmented,
                ..Settings::default()
            },
        }
    }

    /// The file.
    pub fn write(&self, storage: Storage) -> String {
        let size = self.q.len();
        let mut text = format!("2\n{}\n", self.mu.len());
        match storage {
            Storage::Dense => {
                text += &format!("0\n{size}\n{size}\n{size}\t{size}\n");
                for column in 0..size {
                    text += &line(self.w.iter().map(|row| row[column]));
                }
            }
            Storage::Blocks => {
                text += &format!("1\n{size}\n{size}\n");
                text += &self.write_blocks();
            }
        }
        text += &line(self.q.iter().copied());
        text += &line(self.mu.iter().copied());
        text
    }

    fn write_blocks(&self) -> String {
        let contacts = self.mu.len();
        let entries = |i: usize, j: usize| {
            let at = [(0, 0), (1, 0), (0, 1), (1, 1)];
            at.map(|(a, b)| self.w[2 * i + a][2 * j + b])
        };
        let (mut begins, mut columns, mut blocks) = (vec![0], Vec::new(), String::new());
        for i in 0..contacts {
            for j in 0..contacts {
                let block = entries(i, j);
                if block.iter().any(|v| *v != 0.0) {
                    blocks += &format!("{}\n{}", columns.len(), line(block.into_iter()));
                    columns.push(j);
                }
            }
            begins.push(columns.len());
        }
        if columns.is_empty() {
            return "0\n".to_owned();
        }
        let ends: Vec<usize> = (1..=contacts).map(|k| 2 * k).collect();
        format!(
            "{}\n{contacts}\n{contacts}\n{ends}{ends}{}\n{}\n{}{}{blocks}",
            columns.len(),
            begins.len(),
            columns.len(),
            line(begins.iter()),
            line(columns.iter()),
            ends = line(ends.iter()),
        )
    }
}

/// Words with blanks between them, on a line.
fn line(words: impl Iterator<Item = impl std::fmt::Debug>) -> String {
    words.map(|word| format!("{word:?} ")).collect::<String>() + "\n"
}
