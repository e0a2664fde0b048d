//! Reads and writes fclib files with hdf5-pure.
//!
//! ```text
//! /fclib_local    spacedim, W, vectors (q, mu), and with V and R: vectors/s        u = W r + V l + q,  Vᵀ r + R l + s = 0
//! /fclib_global   spacedim, M, H, vectors (f, w, mu), and with G: vectors/b        M v = H r + G l + f,  Gᵀ v + b = 0,  u = Hᵀ v + w
//! ```
//!
//! A matrix is a group: `m` rows, `n` columns, and CSparse's arrays `p`, `i` and `x`. `nz` is -1 for compressed columns, -2 for
//! compressed rows, and otherwise the number of triplets, with the columns in `p` and the rows in `i` (the library's own comment
//! states the reverse, but CSparse, which it calls, and Siconos use this order). Other groups of a file, `solution` and
//! `guesses`, are ignored.

use crate::FormatError;
use crate::problem::{Bilateral, Global, Local, Matrix, Problem, is_there};
use hdf5_pure::{
    DType, Dataset, Error, File, FileBuilder, FormatError as HdfError, GroupBuilder, LibVer,
};

/// Assumed maximum compression: bytes of numbers per byte of file.
const COMPRESSION: u64 = 64;
/// Compressed columns.
const BY_COLUMNS: i64 = -1;
/// Compressed rows.
const BY_ROWS: i64 = -2;

/// Whether this build reads and writes such files.
///
/// # Errors
/// Never.
pub fn ready() -> Result<(), FormatError> {
    Ok(())
}

/// Reads such a file.
///
/// # Errors
/// The error; it has no line.
pub fn read(bytes: Vec<u8>) -> Result<Problem, FormatError> {
    let size = bytes.len() as u64;
    let file = File::from_bytes(bytes)
        .map_err(|why| FormatError::whole(format!("invalid HDF5 file: {why}")))?;
    let groups = file
        .root()
        .groups()
        .map_err(|why| FormatError::whole(format!("invalid HDF5 file: {why}")))?;
    let has = |name: &str| groups.iter().any(|group| group == name);
    if has("fclib_global_rolling") {
        return Err(FormatError::whole(
            "the problem has rolling friction (fclib_global_rolling), which is not supported; fclib_local and fclib_global are",
        ));
    }
    if !has("fclib_local") && !has("fclib_global") {
        return Err(FormatError::whole(
            "the file contains neither fclib_local nor fclib_global; HDF5 files are read as fclib problems",
        ));
    }
    let root = if has("fclib_local") {
        "fclib_local"
    } else {
        "fclib_global"
    };
    let mut part = Part {
        file: &file,
        root,
        size,
        dimension: 2,
    };
    part.dimension = match part.whole("spacedim")? {
        2 => 2,
        3 => 3,
        other => return Err(part.broken("spacedim", &format!("is {other}; it must be 2 or 3"))),
    };
    if has("fclib_local") {
        local(&part)
    } else {
        global(&part)
    }
}

fn local(part: &Part<'_>) -> Result<Problem, FormatError> {
    let w = part.matrix("W")?;
    let size = w.rows;
    part.pairs("W", &w, size)?;
    let local = Local {
        q: part.numbers("vectors/q", size)?,
        mu: part.coefficients(size / part.dimension)?,
        w,
    };
    if !part.has("V") {
        return Ok(Problem::Local(local));
    }
    let (v, r) = (part.matrix("V")?, part.matrix("R")?);
    part.sized("V", &v, size, r.rows)?;
    part.sized("R", &r, r.rows, r.rows)?;
    let s = part.numbers("vectors/s", r.rows)?;
    Ok(Problem::Mixed(local, Bilateral { v, r, s }))
}

/// Bilateral constraints add unknowns: `[M −G; Gᵀ 0] (v, l) = (H r + f, −b)`.
fn global(part: &Part<'_>) -> Result<Problem, FormatError> {
    let (mut m, mut h) = (part.matrix("M")?, part.matrix("H")?);
    part.sized("M", &m, m.rows, m.rows)?;
    part.sized("H", &h, m.rows, h.columns)?;
    part.pairs("H", &h, h.columns)?;
    let size = h.columns;
    let mut f = part.numbers("vectors/f", m.rows)?;
    if part.has("G") {
        let g = part.matrix("G")?;
        part.sized("G", &g, m.rows, g.columns)?;
        let own = m.rows;
        for (i, j, value) in g.entries {
            m.entries.push((i, own + j, -value));
            m.entries.push((own + j, i, value));
        }
        m.rows += g.columns;
        m.columns = m.rows;
        h.rows = m.rows;
        f.extend(part.numbers("vectors/b", g.columns)?.iter().map(|b| -b));
    }
    Ok(Problem::Global(Global {
        m,
        h,
        f,
        b: part.numbers("vectors/w", size)?,
        mu: part.coefficients(size / part.dimension)?,
    }))
}

/// The group of a file that contains the problem.
struct Part<'f> {
    file: &'f File,
    root: &'static str,
    /// Size of the file in bytes.
    size: u64,
    /// Components per contact.
    dimension: usize,
}

impl Part<'_> {
    fn broken(&self, name: &str, what: &str) -> FormatError {
        FormatError::whole(format!("{}/{name} {what}", self.root))
    }

    fn has(&self, group: &str) -> bool {
        self.file.group(&format!("{}/{group}", self.root)).is_ok()
    }

    /// A dataset, no longer than the file can contain.
    fn dataset(&self, name: &str) -> Result<Dataset, FormatError> {
        let path = format!("{}/{name}", self.root);
        let unread =
            |why: &dyn std::fmt::Display| self.broken(name, &format!("cannot be read: {why}"));
        let dataset = self.file.dataset(&path).map_err(|why| match why {
            Error::Format(HdfError::PathNotFound(_)) => self.broken(name, "is missing"),
            why => unread(&why),
        })?;
        let shape = dataset.shape().map_err(|why| unread(&why))?;
        let width = dataset.element_size().map_err(|why| unread(&why))?.max(1) as u64;
        let bytes = shape
            .iter()
            .try_fold(width, |bytes, &n| bytes.checked_mul(n));
        match bytes {
            Some(bytes) if bytes <= self.size.saturating_mul(COMPRESSION) => Ok(dataset),
            _ => Err(self.broken(
                name,
                &format!("has {shape:?} numbers, more than a file of this size can contain"),
            )),
        }
    }

    fn wholes(&self, name: &str) -> Result<Vec<i64>, FormatError> {
        let dataset = self.dataset(name)?;
        // They would be truncated.
        if matches!(dataset.dtype(), Ok(DType::F32 | DType::F64)) {
            return Err(self.broken(name, "has decimals; it must have whole numbers"));
        }
        let read = dataset.read_i64();
        read.map_err(|why| self.broken(name, &format!("cannot be read: {why}")))
    }

    fn whole(&self, name: &str) -> Result<i64, FormatError> {
        let found = self.wholes(name)?;
        found
            .first()
            .copied()
            .ok_or_else(|| self.broken(name, "is empty; it must be a whole number"))
    }

    fn count(&self, name: &str) -> Result<usize, FormatError> {
        let found = self.whole(name)?;
        usize::try_from(found)
            .map_err(|_| self.broken(name, &format!("is {found}; it must not be negative")))
    }

    fn numbers(&self, name: &str, count: usize) -> Result<Vec<f64>, FormatError> {
        let read = self.dataset(name)?.read_f64();
        let found = read.map_err(|why| self.broken(name, &format!("cannot be read: {why}")))?;
        if found.len() != count {
            let what = format!("has {} numbers; it must have {count}", found.len());
            return Err(self.broken(name, &what));
        }
        match found.iter().position(|value| !value.is_finite()) {
            Some(k) => Err(self.broken(name, &format!("has {:?} at position {k}", found[k]))),
            None => Ok(found),
        }
    }

    fn coefficients(&self, count: usize) -> Result<Vec<f64>, FormatError> {
        let mu = self.numbers("vectors/mu", count)?;
        match mu.iter().find(|mu| **mu < 0.0) {
            Some(mu) => {
                let what = format!("has the friction coefficient {mu:?}; it must not be negative");
                Err(self.broken("vectors/mu", &what))
            }
            None => Ok(mu),
        }
    }

    fn sized(
        &self,
        name: &str,
        of: &Matrix,
        rows: usize,
        columns: usize,
    ) -> Result<(), FormatError> {
        if (of.rows, of.columns) == (rows, columns) {
            return Ok(());
        }
        let what = format!(
            "has {} rows and {} columns; it must have {rows} and {columns}",
            of.rows, of.columns
        );
        Err(self.broken(name, &what))
    }

    /// Rejects a size that is not two components per contact.
    fn pairs(&self, name: &str, of: &Matrix, size: usize) -> Result<(), FormatError> {
        let components = self.dimension;
        if size > 0 && size.is_multiple_of(components) {
            let rows = if name == "W" { size } else { of.rows };
            return self.sized(name, of, rows, size);
        }
        let what = format!(
            "has {size} columns; it must have {components} per contact, and at least one contact"
        );
        Err(self.broken(name, &what))
    }

    fn matrix(&self, name: &str) -> Result<Matrix, FormatError> {
        let of = |what: &str| format!("{name}/{what}");
        let (rows, columns) = (self.count(&of("m"))?, self.count(&of("n"))?);
        let storage = self.whole(&of("nz"))?;
        let (p, i) = (self.wholes(&of("p"))?, self.wholes(&of("i"))?);
        let x = self.dataset(&of("x"))?.read_f64();
        let x = x.map_err(|why| self.broken(&of("x"), &format!("cannot be read: {why}")))?;
        let places = match storage {
            BY_COLUMNS => self.lists(name, &p, columns, i.len())?,
            BY_ROWS => self.lists(name, &p, rows, i.len())?,
            _ => p,
        };
        let count = match storage {
            BY_COLUMNS | BY_ROWS => places.len(),
            other => usize::try_from(other).map_err(|_| {
                self.broken(
                    &of("nz"),
                    &format!("is {other}; it must be -1, -2, or not negative"),
                )
            })?,
        };
        if [places.len(), i.len(), x.len()]
            .into_iter()
            .any(|length| length < count)
        {
            return Err(self.broken(
                name,
                &format!("has fewer than {count} entries in p, i or x"),
            ));
        }
        let mut entries = Vec::with_capacity(count);
        for ((&list, &index), &value) in places.iter().zip(&i).zip(&x).take(count) {
            let (row, column) = match storage {
                BY_ROWS => (list, index),
                _ => (index, list),
            };
            let at = (usize::try_from(row), usize::try_from(column));
            let (Ok(row), Ok(column)) = at else {
                return Err(self.broken(name, "has an entry with a negative index"));
            };
            if row >= rows || column >= columns || !value.is_finite() {
                let what = match value.is_finite() {
                    true => format!(
                        "has an entry in row {row}, column {column}, but {rows} rows and {columns} columns (counted from 0)"
                    ),
                    false => format!("has {value:?} in row {row}, column {column}"),
                };
                return Err(self.broken(name, &what));
            }
            if is_there(value) {
                entries.push((row, column, value));
            }
        }
        Ok(Matrix {
            rows,
            columns,
            entries,
        })
    }

    /// The column (or row) of every entry, where `p` contains the first entry of each and the total count.
    fn lists(
        &self,
        name: &str,
        p: &[i64],
        lists: usize,
        entries: usize,
    ) -> Result<Vec<i64>, FormatError> {
        let wrong = || {
            self.broken(
                &format!("{name}/p"),
                "must begin with 0, be ascending, and end with the number of entries",
            )
        };
        if p.len() != lists.saturating_add(1) || p.first() != Some(&0) {
            return Err(wrong());
        }
        let mut found = Vec::new();
        for (list, ends) in (0..).zip(p.windows(2)) {
            let length = ends[1].checked_sub(ends[0]).ok_or_else(wrong)?;
            let length = usize::try_from(length).map_err(|_| wrong())?;
            if length > entries - found.len() {
                return Err(wrong());
            }
            found.resize(found.len() + length, list);
        }
        Ok(found)
    }
}

/// The file of a local problem.
///
/// # Errors
/// If it has more entries than fclib can count.
pub fn write(problem: &Local, title: &str) -> Result<Vec<u8>, FormatError> {
    let failed = |why: &dyn std::fmt::Display| {
        FormatError::whole(format!("creating the HDF5 file failed: {why}"))
    };
    let mut file = FileBuilder::new();
    // Readable by every HDF5 library from version 1.8.
    file.with_libver_bounds(LibVer::Earliest, LibVer::V18);
    let mut local = file.create_group("fclib_local");
    let dimension = if problem.dimension() == 3 { 3 } else { 2 };
    local.create_dataset("spacedim").with_i32_data(&[dimension]);
    let mut w = local.create_group("W");
    write_matrix(&mut w, &problem.w)?;
    local.add_group(w.finish());
    let mut vectors = local.create_group("vectors");
    vectors.create_dataset("q").with_f64_data(&problem.q);
    vectors.create_dataset("mu").with_f64_data(&problem.mu);
    local.add_group(vectors.finish());
    let mut info = local.create_group("info");
    let ascii: String = title
        .chars()
        .map(|c| if c.is_ascii_graphic() { c } else { ' ' })
        .collect();
    info.create_dataset("title")
        .with_ascii_strings(&[&format!("{ascii}\0")])
        .map_err(|why| failed(&why))?
        .with_shape(&[]);
    local.add_group(info.finish());
    file.add_group(local.finish());
    file.finish().map_err(|why| failed(&why))
}

/// Writes compressed columns. HDF5 datasets cannot be empty, so one zero of a zero matrix is written.
fn write_matrix(group: &mut GroupBuilder, matrix: &Matrix) -> Result<(), FormatError> {
    let mut entries = matrix.entries.clone();
    entries.sort_by_key(|&(row, column, _)| (column, row));
    if entries.is_empty() {
        entries.push((0, 0, 0.0));
    }
    let small = |n: usize| {
        i32::try_from(n).map_err(|_| {
            FormatError::whole(format!(
                "fclib uses 32-bit counts, and the matrix has {n} entries"
            ))
        })
    };
    let mut p = vec![0; matrix.columns + 1];
    let mut i = Vec::with_capacity(entries.len());
    for &(row, column, _) in &entries {
        p[column + 1] += 1;
        i.push(small(row)?);
    }
    for column in 0..matrix.columns {
        p[column + 1] += p[column];
    }
    let p = p.into_iter().map(small).collect::<Result<Vec<i32>, _>>()?;
    let x: Vec<f64> = entries.iter().map(|entry| entry.2).collect();
    let counts = [
        ("nzmax", entries.len()),
        ("m", matrix.rows),
        ("n", matrix.columns),
    ];
    for (name, count) in counts {
        group.create_dataset(name).with_i32_data(&[small(count)?]);
    }
    group
        .create_dataset("nz")
        .with_i32_data(&[BY_COLUMNS as i32]);
    group.create_dataset("p").with_i32_data(&p);
    group.create_dataset("i").with_i32_data(&i);
    group.create_dataset("x").with_f64_data(&x);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn problem(w: &[Vec<f64>], q: &[f64]) -> Local {
        Local {
            w: Matrix::from_rows(w),
            q: q.to_vec(),
            mu: vec![0.3; q.len() / 2],
        }
    }

    fn two() -> Local {
        problem(&[vec![2.0, -0.1], vec![0.0, 1.0 / 3.0]], &[-1.0, 0.25])
    }

    /// An fclib file whose problem group is filled by a function.
    fn file(root: &str, fill: impl FnOnce(&mut GroupBuilder)) -> Vec<u8> {
        let mut file = FileBuilder::new();
        let mut group = file.create_group(root);
        fill(&mut group);
        file.add_group(group.finish());
        file.finish().unwrap()
    }

    fn matrix(
        group: &mut GroupBuilder,
        name: &str,
        size: [i32; 3],
        p: &[i32],
        i: &[i32],
        x: &[f64],
    ) {
        let mut own = group.create_group(name);
        for (name, value) in ["m", "n", "nz"].into_iter().zip(size) {
            own.create_dataset(name).with_i32_data(&[value]);
        }
        own.create_dataset("p").with_i32_data(p);
        own.create_dataset("i").with_i32_data(i);
        own.create_dataset("x").with_f64_data(x);
        group.add_group(own.finish());
    }

    fn vectors(group: &mut GroupBuilder, lists: &[(&str, &[f64])]) {
        let mut own = group.create_group("vectors");
        for (name, list) in lists {
            own.create_dataset(name).with_f64_data(list);
        }
        group.add_group(own.finish());
    }

    #[test]
    fn bilateral_constraints_become_additional_unknowns() {
        let bytes = file("fclib_global", |group| {
            group.create_dataset("spacedim").with_i32_data(&[2]);
            // Rows, columns and triplets, in this order.
            matrix(group, "M", [2, 2, -2], &[0, 1, 2], &[0, 1], &[4.0, 5.0]);
            matrix(group, "H", [2, 2, -1], &[0, 1, 2], &[1, 0], &[1.0, -1.0]);
            matrix(group, "G", [2, 1, 1], &[0], &[1], &[7.0]);
            vectors(
                group,
                &[
                    ("f", &[1.0, 2.0]),
                    ("w", &[0.5, 0.0]),
                    ("mu", &[0.2]),
                    ("b", &[3.0]),
                ],
            );
        });
        let Problem::Global(read) = read(bytes).unwrap() else {
            panic!("not global")
        };
        assert_eq!(
            read.m.dense(),
            [[4.0, 0.0, 0.0], [0.0, 5.0, -7.0], [0.0, 7.0, 0.0]]
        );
        assert_eq!(read.h.dense(), [[0.0, -1.0], [1.0, 0.0], [0.0, 0.0]]);
        assert_eq!(
            (read.f, read.b, read.mu),
            (vec![1.0, 2.0, -3.0], vec![0.5, 0.0], vec![0.2])
        );
    }

    #[test]
    fn unsupported_content_is_rejected_by_name() {
        let with = |dimension: i32, n: i32, mu: f64| {
            file("fclib_local", |group| {
                group.create_dataset("spacedim").with_i32_data(&[dimension]);
                matrix(group, "W", [2, n, 1], &[0], &[1], &[1.0]);
                vectors(group, &[("q", &[1.0, 2.0]), ("mu", &[mu])]);
            })
        };
        assert!(read(with(2, 2, 0.1)).is_ok());
        let cases = [
            (with(4, 2, 0.1), "must be 2 or 3"),
            (with(3, 2, 0.1), "3 per contact"),
            (with(2, 3, 0.1), "2 rows and 3 columns"),
            (with(2, 2, -0.1), "negative"),
            (
                file("other", |group| {
                    group.create_dataset("a").with_i32_data(&[1]);
                }),
                "neither",
            ),
            (
                file("fclib_global_rolling", |group| {
                    group.create_dataset("a").with_i32_data(&[1]);
                }),
                "rolling",
            ),
            (
                file("fclib_local", |group| {
                    group.create_dataset("spacedim").with_i32_data(&[2]);
                }),
                "W/m",
            ),
            (b"\x89HDF\r\n\x1a\nrest".to_vec(), "invalid HDF5"),
        ];
        for (bytes, told) in cases {
            let broken = read(bytes).unwrap_err();
            assert!(broken.message.contains(told), "{broken}");
        }
    }

    #[test]
    fn missing_truncated_and_decimal_parts_are_named() {
        let with = |decimal: bool, row: i32| {
            file("fclib_local", |group| {
                group.create_dataset("spacedim").with_i32_data(&[2]);
                let mut own = group.create_group("W");
                for (name, value) in [("m", 2), ("n", 2), ("nz", 1)] {
                    own.create_dataset(name).with_i32_data(&[value]);
                }
                if decimal {
                    own.create_dataset("p").with_f64_data(&[0.5]);
                } else {
                    own.create_dataset("p").with_i32_data(&[0]);
                }
                own.create_dataset("i").with_i32_data(&[row]);
                own.create_dataset("x").with_f64_data(&[1.0]);
                group.add_group(own.finish());
                vectors(group, &[("q", &[1.0, 2.0])]);
            })
        };
        let told = |bytes| read(bytes).unwrap_err().message;
        assert_eq!(told(with(false, 1)), "fclib_local/vectors/mu is missing");
        let decimals = "fclib_local/W/p has decimals; it must have whole numbers";
        assert_eq!(told(with(true, 1)), decimals);
        let outside = "fclib_local/W has an entry in row 2, column 0, but 2 rows and 2 columns (counted from 0)";
        assert_eq!(told(with(false, 2)), outside);
        let mut cut = with(false, 1);
        cut.truncate(cut.len() / 4);
        assert!(
            told(cut.clone()).starts_with("invalid HDF5"),
            "{}",
            told(cut)
        );
    }

    #[test]
    fn a_matrix_of_zeros_is_written_too() {
        let zeros = problem(&[vec![0.0; 2], vec![0.0; 2]], &[1.0, 2.0]);
        assert_eq!(
            read(write(&zeros, "zeros").unwrap()).unwrap(),
            Problem::Local(zeros)
        );
    }

    proptest! {
        #[test]
        fn written_files_are_read_back_exactly(
            rows in prop::collection::vec(prop::collection::vec(-1e300..1e300_f64, 4), 4),
            q in prop::collection::vec(-1e300..1e300_f64, 4),
        ) {
            let problem = problem(&rows, &q);
            let Problem::Local(found) = read(write(&problem, "a \u{e4}").unwrap()).unwrap() else {
                panic!("not local")
            };
            prop_assert_eq!(found.w.dense(), rows);
            prop_assert_eq!((found.q, found.mu), (problem.q, problem.mu));
        }

        #[test]
        fn no_damage_makes_the_reader_panic(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
            cut in any::<prop::sample::Index>(),
        ) {
            let mut bytes = write(&two(), "two").unwrap();
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
            let _ = read(bytes.clone());
            bytes.truncate(cut.index(bytes.len()));
            let _ = read(bytes);
        }
    }
}
