//! The census as a strategy: tries all combinations of modes ([`crate::interface::census`]). Consistent ones are proposed in
//! sequence, starting with the one that changes the fewest nodes.

use crate::interface::census;
use crate::interface::method::{NoProposal, Proposal, Search, SearchInput};
use crate::{AssumedMode, NodeAnswer, NotFound, Rule, SearchProgress, TestedQuantity};

/// All combinations of modes of the nodes that can touch.
pub struct CensusStrategy;

impl Search for CensusStrategy {
    /// Proposes solution number `asked.start`.
    fn propose(&self, asked: SearchInput<'_>) -> Result<Proposal, NoProposal> {
        let problem = (asked.problem)().ok_or(NotFound::NotCondensed)?;
        let undecided: Vec<usize> = (0..problem.nodes.len())
            .filter(|&place| problem.nodes[place].choices().len() > 1)
            .collect();
        let problem = problem.reduced(&undecided).ok_or(NotFound::Loose)?;
        let mut census = census::census(&problem)
            .map_err(|census::TooMany { nodes }| NotFound::TooMany { nodes })?;
        let differs = |(place, node): (&usize, &NodeAnswer)| asked.brought[*place] != node.assumed;
        census.answers.sort_by_key(|found| {
            undecided
                .iter()
                .zip(&found.answer.nodes)
                .filter(|&pair| differs(pair))
                .count()
        });
        let Some(found) = census.answers.get(asked.start) else {
            return Err(match census.answers.len() {
                0 => NoProposal::NoAnswer {
                    tried: census.tried,
                },
                states => NotFound::Unconfirmed { states }.into(),
            });
        };
        let free = (AssumedMode::Free, [0.0, 0.0, f64::INFINITY, 0.0]);
        let mut nodes = vec![free; asked.brought.len()];
        for (&place, node) in undecided.iter().zip(&found.answer.nodes) {
            let numbers = [node.f_n, node.f_t, node.gap, node.slip];
            nodes[place] = (node.assumed, numbers);
        }
        Ok(Proposal {
            nodes,
            rule: Rule::Found,
            cover: 0.0,
            covers: TestedQuantity::Cover,
            bound: None,
            next: SearchProgress::Found { start: asked.start },
        })
    }
}
