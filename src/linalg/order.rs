//! Elimination order of a symmetric matrix.

use super::check::SolveError;
use super::dissection;
use super::graph::{Graph, NONE, least_fill};
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
    let mut number = vec![0; pattern.n];
    for &i in last {
        number[i] = NONE;
    }
    let mut inner = Vec::with_capacity(pattern.n - last.len());
    for (i, number) in number.iter_mut().enumerate() {
        if *number != NONE {
            *number = inner.len();
            inner.push(i);
        }
    }
    let mut order = match positions.is_empty() || inner.len() < LARGE {
        true => {
            let (mut starts, mut rows) = (vec![0], Vec::new());
            for &column in &inner {
                let entries = pattern.row_idx[pattern.column(column)].iter();
                let entries = entries.map(|&row| number[row as usize]);
                rows.extend(entries.filter(|&row| row != NONE));
                starts.push(rows.len());
            }
            let order = least_fill(&starts, &rows)?;
            order.iter().map(|&k| inner[k]).collect()
        }
        false => dissected(pattern, &inner, positions)?,
    };
    order.extend_from_slice(last);
    Ok(order)
}

/// Some unknowns by nested dissection; consecutive ones at the same position are eliminated together.
fn dissected(
    pattern: &Pattern,
    unknowns: &[usize],
    positions: &[[f64; 2]],
) -> Result<Vec<usize>, SolveError> {
    let (mut groups, mut of_groups) = (vec![NONE; pattern.n], Vec::new());
    for &unknown in unknowns {
        if of_groups.last() != Some(&positions[unknown]) {
            of_groups.push(positions[unknown]);
        }
        groups[unknown] = of_groups.len() - 1;
    }
    let graph = Graph::new(pattern, &groups, pattern.n);
    let order = in_postorder(&graph, dissection::order(&graph, &of_groups)?);
    let members = order.iter().flat_map(|&group| graph.members(group));
    Ok(members.map(|&unknown| unknown as usize).collect())
}
