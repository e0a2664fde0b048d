//! The census: every assumption of what the nodes of a frozen interface problem do, tried.
//!
//! Coulomb's law may leave a frozen problem with no consistent state, with one, or with several. The minor iterations
//! cannot tell: they walk from assumption to assumption by Table 2. With k nodes there are up to 4^k assumptions (free,
//! fixed, sliding either way), few enough to try them all.

use crate::solve::frozen::{Answer, Assumed, Frozen, Margin, NodeAnswer, Trials};

/// Most nodes that a census is held over: 4^8 is 65,536 assumptions.
pub const MOST: usize = 8;
/// Conditions broken by less than this, relatively, count as kept; forces and gaps closer than this are the same.
const TOLERANCE: f64 = 1e-9;

/// What a census found.
#[derive(Debug, Clone, PartialEq)]
pub struct Census {
    /// Assumptions that were tried, and those of them that have no unique solution.
    pub tried: usize,
    pub singular: usize,
    /// The consistent states, each different in forces or gaps.
    pub answers: Vec<Consistent>,
    /// Where there is none: the assumption that fails by least, the node (its place in the problem), and the condition
    /// that it breaks.
    pub nearest: Option<(Answer, usize, Margin)>,
}

/// A consistent state.
#[derive(Debug, Clone, PartialEq)]
pub struct Consistent {
    pub answer: Answer,
    /// Other assumptions that lead to the same forces and gaps: ties.
    pub ties: Vec<String>,
}

/// Tries every assumption of a problem of at most [`MOST`] nodes.
///
/// # Errors
/// A message where it has more.
pub fn census(problem: &Frozen) -> Result<Census, String> {
    let count = problem.nodes.len();
    if count > MOST {
        return Err(format!(
            "a census is held over at most {MOST} nodes, and these are {count}; find the core of the cycle first"
        ));
    }
    let mut trials = Trials::new(problem).ok_or("no memory for a census")?;
    let mut found = Census {
        tried: 0,
        singular: 0,
        answers: Vec::new(),
        nearest: None,
    };
    let mut places = vec![0; count];
    let mut assumed = vec![Assumed::Free; count];
    loop {
        for (assumed, (node, &place)) in assumed.iter_mut().zip(problem.nodes.iter().zip(&places)) {
            *assumed = node.choices()[place];
        }
        found.tried += 1;
        match trials.answer(&assumed) {
            None => found.singular += 1,
            Some(answer) => found.take(problem, answer),
        }
        let more = (0..count).find(|&i| places[i] + 1 < problem.nodes[i].choices().len());
        let Some(next) = more else { break };
        places[..next].fill(0);
        places[next] += 1;
    }
    if !found.answers.is_empty() {
        found.nearest = None;
    }
    Ok(found)
}

impl Census {
    fn take(&mut self, problem: &Frozen, answer: Answer) {
        if !answer.obeys(TOLERANCE) {
            let Some((node, margin)) = answer.worst() else {
                return;
            };
            let best = self
                .nearest
                .as_ref()
                .map_or(f64::NEG_INFINITY, |n| n.2.relative);
            if margin.relative > best {
                self.nearest = Some((answer, node, margin));
            }
            return;
        }
        let same = |found: &&mut Consistent| is_same(problem, &found.answer, &answer);
        match self.answers.iter_mut().find(same) {
            Some(found) => found.ties.push(answer.letters()),
            None => self.answers.push(Consistent {
                answer,
                ties: Vec::new(),
            }),
        }
    }
}

/// Whether two states have the same forces, gaps and slips.
fn is_same(problem: &Frozen, a: &Answer, b: &Answer) -> bool {
    let force = TOLERANCE * problem.force;
    let length = TOLERANCE * problem.length;
    let close = |a: &NodeAnswer, b: &NodeAnswer| {
        let equal = |a: f64, b: f64, size: f64| a == b || (a - b).abs() <= size;
        equal(a.f_n, b.f_n, force)
            && equal(a.f_t, b.f_t, force)
            && equal(a.gap, b.gap, length)
            && equal(a.slip, b.slip, length)
    };
    a.nodes.iter().zip(&b.nodes).all(|(a, b)| close(a, b))
}
