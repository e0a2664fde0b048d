//! Random interface problems: small, with all the difficulties of Coulomb's law, and reproducible.
//!
//! Each problem k of a seed has a separate stream of the PCG generator (XSL-RR 128/64), so that it depends only
//! on the seed, its number, and the possible numbers of nodes; floats are made from integers here. It has 1 to
//! 4 nodes (or as requested), and with M = A Aᵀ/n + 0.02 I, A of n = 2 k columns, each entry uniform in −1 to 1
//! (so that normal and tangential parts are coupled):
//!
//! - Half of them have the stiffness M and loads, half the compliance M and a displacement at zero force;
//!   entries are uniform in −1 to 1. Two fifths of the compliances are singular: A lacks one or two columns,
//!   and I is not added. Such a problem may have no solution;
//! - The friction μ is uniform in 0.2 to 1.2, the same for all nodes. In a sixth of the problems, each node
//!   also has a cohesion uniform in 0 to 1; such a problem may have no solution;
//! - Gaps: half of the nodes are in contact (0), the others are uniform in −0.25 to 0.75: some penetrate. All
//!   nodes start free.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use std::ops::RangeInclusive;
use stickslip_core::Friction;
use stickslip_scene::format::condensed::{Contact, Matrix, Problem};

/// The default range of the number of nodes.
pub const NODES: RangeInclusive<usize> = 1..=4;
/// Added to the diagonal of A Aᵀ/n.
const RIDGE: f64 = 0.02;

/// A set of random problems.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Population {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of problems.
    pub count: usize,
    /// Numbers of nodes, all equally likely.
    pub nodes: RangeInclusive<usize>,
}

/// A random problem, with its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomProblem {
    /// The problem.
    pub problem: Problem,
    /// Form of its body.
    pub form: Form,
    /// Whether it has cohesion.
    pub cohesive: bool,
}

stickslip_core::words! {
    /// Form of the body behind the contacts.
    pub enum Form, name {
        /// A stiffness.
        Stiffness "stiffness",
        /// A compliance.
        Compliance "compliance",
        /// A compliance with a force that causes no motion.
        Singular "singular",
    }
}

/// The random numbers of one stream.
struct RandomStream(Pcg64);

impl RandomStream {
    /// A number uniform in low to high, with 53 random bits.
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let part = (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * part
    }

    /// True with this probability.
    fn chance(&mut self, part: f64) -> bool {
        self.uniform(0.0, 1.0) < part
    }

    /// An integer in a range; the small bias is far below what any survey shows.
    fn whole(&mut self, range: &RangeInclusive<usize>) -> usize {
        let count = (range.end() - range.start() + 1) as u64;
        range.start() + (self.0.next_u64() % count) as usize
    }
}

impl Population {
    /// Problem k.
    pub fn draw(&self, k: usize) -> RandomProblem {
        let mut draw = RandomStream(Pcg64::new(u128::from(self.seed), k as u128));
        let nodes = draw.whole(&self.nodes);
        let size = 2 * nodes;
        let form = match (draw.chance(0.5), draw.chance(0.4)) {
            (true, _) => Form::Stiffness,
            (false, false) => Form::Compliance,
            (false, true) => Form::Singular,
        };
        let cohesive = draw.chance(1.0 / 6.0);
        let mu = draw.uniform(0.2, 1.2);
        let matrix = matrix(&mut draw, size, form);
        let acts: Vec<f64> = (0..size).map(|_| draw.uniform(-1.0, 1.0)).collect();
        let contact = |k: usize| Contact {
            id: format!("n{}", k + 1),
            gap: if draw.chance(0.5) {
                0.0
            } else {
                draw.uniform(-0.25, 0.75)
            },
            friction: Friction {
                angle: mu.atan().to_degrees(),
                cohesion: if cohesive {
                    draw.uniform(0.0, 1.0)
                } else {
                    0.0
                },
            },
            load: match form {
                Form::Stiffness => [acts[2 * k], acts[2 * k + 1]],
                _ => [0.0; 2],
            },
            ..Contact::default()
        };
        let contacts = (0..nodes).map(contact).collect();
        let (matrix, free) = match form {
            Form::Stiffness => (Matrix::Stiffness(matrix), Vec::new()),
            _ => (Matrix::Compliance(matrix), acts),
        };
        RandomProblem {
            problem: Problem::new(
                &format!("Random interface problem {k} of seed {}", self.seed),
                contacts,
                matrix,
                free,
            ),
            form,
            cohesive,
        }
    }

    /// Identifies this population except for its size: populations with the same name have the same problem k.
    pub fn name(&self) -> String {
        let (least, most) = (self.nodes.start(), self.nodes.end());
        format!("seed {}, {least} to {most} nodes", self.seed)
    }
}

/// A Aᵀ/n, row by row.
fn matrix(draw: &mut RandomStream, size: usize, form: Form) -> Vec<Vec<f64>> {
    let columns = match form {
        Form::Singular => size - draw.whole(&(1..=2.min(size - 1))),
        _ => size,
    };
    let mut a = vec![vec![0.0; columns]; size];
    for row in &mut a {
        row.fill_with(|| draw.uniform(-1.0, 1.0));
    }
    let ridge = match form {
        Form::Singular => 0.0,
        _ => RIDGE,
    };
    let entry = |i: usize, j: usize| {
        let product: f64 = a[i].iter().zip(&a[j]).map(|(x, y)| x * y).sum();
        product / columns as f64 + if i == j { ridge } else { 0.0 }
    };
    (0..size)
        .map(|i| (0..size).map(|j| entry(i, j)).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_scene::Scene;

    fn population() -> Population {
        Population {
            seed: 7,
            count: 100,
            nodes: NODES,
        }
    }

    #[test]
    fn a_problem_depends_only_on_seed_and_number() {
        let all = population();
        let fewer = Population {
            count: 3,
            ..population()
        };
        assert_eq!(all.draw(2), fewer.draw(2));
        assert_ne!(all.draw(2).problem.matrix, all.draw(3).problem.matrix);
        // Fixed values: a change of these numbers makes published counts invalid.
        let first = all.draw(0);
        assert_eq!((first.form, first.cohesive), (Form::Singular, false));
        assert_eq!(first.problem.contacts.len(), 2);
        let Matrix::Compliance(rows) = &first.problem.matrix else {
            panic!("{:?}", first.problem.matrix)
        };
        assert_eq!(rows[3][0], -0.19578314055071966);
        assert_eq!(first.problem.free[3], -0.823038607897369);
        let angle = first.problem.contacts[1].friction.angle;
        assert!((angle - 45.86293159508851).abs() < 1e-12, "{angle}");
    }

    #[test]
    fn every_kind_is_drawn_and_is_a_valid_scene() {
        let all = population();
        let mut seen = std::collections::HashSet::new();
        for k in 0..all.count {
            let drawn = all.draw(k);
            let nodes = drawn.problem.contacts.len();
            seen.insert((drawn.form.name(), drawn.cohesive));
            assert!(NODES.contains(&nodes));
            Scene::from_spec("random", drawn.problem.spec()).unwrap();
        }
        assert_eq!(seen.len(), 6, "{seen:?}");
    }

    #[test]
    fn a_written_problem_reads_back_to_the_same_bits() {
        for k in 0..20 {
            let problem = population().draw(k).problem;
            let text = problem.text(&["where it comes from".to_owned()]);
            let read = Scene::from_text("x.ron", &text, &[]).unwrap();
            assert_eq!(read.spec, problem.spec(), "{text}");
        }
    }
}
