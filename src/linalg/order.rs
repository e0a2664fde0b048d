//! Elimination order of a symmetric matrix.

use super::check::SolveError;
use super::dissection;
use super::graph::{Graph, least_fill};
use super::pattern::Pattern;
use super::tree::in_postorder;

/// A matrix with at least this many unknowns is dissected if their positions are known.
const LARGE: usize = 10_000;

/// A fill-reducing order of the unknowns with `last` at the end; `positions` are those of the unknowns, or empty.
pub(super) fn order(
    pattern: &Pattern,
    last: &[usize],
    positions: &[[f64; 2]],
) -> Result<Vec<usize>, SolveError> {
    const LAST: usize = usize::MAX;
    let n = pattern.n;
    let mut number = vec![0; n];
    for &i in last {
        number[i] = LAST;
    }
    let mut inner = Vec::with_capacity(n - last.len());
    for (i, number) in number.iter_mut().enumerate() {
        if *number != LAST {
            *number = inner.len();
            inner.push(i);
        }
    }
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for &column in &inner {
        let range = pattern.col_ptr[column]..pattern.col_ptr[column + 1];
        let entries = pattern.row_idx[range].iter().map(|&row| number[row]);
        rows.extend(entries.filter(|&row| row != LAST));
        starts.push(rows.len());
    }
    let forward = match positions.is_empty() || inner.len() < LARGE {
        true => least_fill(&starts, &rows)?,
        false => {
            let inside = Pattern {
                n: inner.len(),
                col_ptr: starts,
                row_idx: rows,
            };
            let positions = inner.iter().map(|&unknown| positions[unknown]);
            dissected(&inside, &positions.collect::<Vec<_>>())?
        }
    };
    let reduced = forward.iter().map(|&k| inner[k]);
    Ok(reduced.chain(last.iter().copied()).collect())
}

/// The unknowns by nested dissection; consecutive ones at the same position are eliminated together.
fn dissected(pattern: &Pattern, positions: &[[f64; 2]]) -> Result<Vec<usize>, SolveError> {
    let (mut groups, mut of_groups) = (Vec::with_capacity(pattern.n), Vec::new());
    for &position in positions {
        if of_groups.last() != Some(&position) {
            of_groups.push(position);
        }
        groups.push(of_groups.len() - 1);
    }
    let graph = Graph::new(pattern, &groups, pattern.n);
    let order = in_postorder(&graph, dissection::order(&graph, &of_groups)?);
    let members = order.iter().flat_map(|&group| graph.members(group));
    Ok(members.copied().collect())
}
