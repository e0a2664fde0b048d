//! Stiffness matrices stored by CalculiX (`*FREQUENCY, SOLVER=MATRIXSTORAGE`): `JOB.sti` and `JOB.dof`.
//!
//! Each line of the .dof is an unknown, `NODE.DIRECTION`, with 1 for x and 2 for y; restrained components are omitted. Each line
//! of the .sti is an entry, `ROW COLUMN VALUE`, where rows and columns are line numbers of the .dof, from 1. The matrix is
//! symmetric, and each pair of entries is stored once.

use crate::FormatError;
use crate::problem::Matrix;
use crate::words::Words;

/// An unknown of a stiffness: a component of a node's displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MatrixUnknown {
    /// Node number in the deck.
    pub node: u64,
    /// 0 for x, 1 for y.
    pub direction: usize,
}

/// Reads a .dof.
///
/// # Errors
/// The error with its position, also for an unknown out of the plane.
pub fn unknowns(text: &str) -> Result<Vec<MatrixUnknown>, FormatError> {
    let mut words = Words::new(text);
    let mut unknowns = Vec::new();
    while words.peek().is_some() {
        let word = words.next("an unknown")?;
        let wanted = "an unknown, NODE.DIRECTION,";
        let (node, direction) = word
            .split_once('.')
            .and_then(|(node, direction)| Some((node.parse().ok()?, direction.parse().ok()?)))
            .ok_or_else(|| words.unlike(word, wanted))?;
        let direction = match direction {
            1 => 0,
            2 => 1,
            3_usize => {
                return Err(words.broken(format!(
                    "node {node} has a displacement along z; only plane problems are supported (elements CPS, CPE, CAX)"
                )));
            }
            _ => return Err(words.unlike(word, wanted)),
        };
        unknowns.push(MatrixUnknown { node, direction });
    }
    if unknowns.is_empty() {
        Err(FormatError::whole("the file contains no unknowns"))
    } else {
        Ok(unknowns)
    }
}

/// Reads a .sti with this number of unknowns; off-diagonal entries are returned on both sides.
///
/// # Errors
/// The error with its position.
pub fn matrix(text: &str, unknowns: usize) -> Result<Matrix, FormatError> {
    let mut words = Words::new(text);
    let mut entries = Vec::new();
    while words.peek().is_some() {
        let mut index = |what: &str| {
            let at = words.count(what)?;
            if (1..=unknowns).contains(&at) {
                Ok(at - 1)
            } else {
                Err(words.broken(format!("{what} is {at}; the .dof has {unknowns} unknowns")))
            }
        };
        let (row, column) = (index("a row")?, index("a column")?);
        let value = words.number("an entry of the stiffness")?;
        entries.push((row, column, value));
        if row != column {
            entries.push((column, row, value));
        }
    }
    if entries.is_empty() {
        Err(FormatError::whole("the file contains no entries"))
    } else {
        Ok(Matrix {
            rows: unknowns,
            columns: unknowns,
            entries,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn half_of_a_symmetric_matrix_is_completed() {
        let found = unknowns("7.1\n7.2\n 12.1\n").unwrap();
        let told: Vec<_> = found.iter().map(|u| (u.node, u.direction)).collect();
        assert_eq!(told, [(7, 0), (7, 1), (12, 0)]);
        let read = matrix("1 1  2.0\n1 3 -1.0\n3 3  4.D+00\n", 3).unwrap();
        assert_eq!(read.dense(), [[2.0, 0.0, -1.0], [0.0; 3], [-1.0, 0.0, 4.0]]);
    }

    #[test]
    fn errors_have_a_position() {
        let of_dof = [
            ("1.1\n1.3\n", (2, 1), "z"),
            ("1.1 x", (1, 5), "NODE"),
            ("1", (1, 1), "NODE"),
        ];
        for (text, at, told) in of_dof {
            let broken = unknowns(text).unwrap_err();
            assert_eq!(broken.at, Some(at));
            assert!(broken.message.contains(told), "{broken}");
        }
        for (text, at) in [
            ("1 1 1.0\n0 1 1.0", (2, 1)),
            ("1 4 1.0", (1, 3)),
            ("1 1 nan", (1, 5)),
            ("1 1", (1, 3)),
        ] {
            assert_eq!(matrix(text, 3).unwrap_err().at, Some(at), "{text}");
        }
        assert!(unknowns(" \n").is_err() && matrix("", 3).is_err());
    }

    proptest! {
        #[test]
        fn no_text_makes_the_readers_panic(text in "[0-9. \\-\ne+x]{0,60}", any in any::<String>()) {
            for text in [text, any] {
                let _ = unknowns(&text);
                let _ = matrix(&text, 5);
            }
        }
    }
}
