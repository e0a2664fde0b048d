//! Lemke's complementary pivoting on the frozen interface problem.
//!
//! Coulomb's law in the plane is a linear complementarity problem (Klarbring, Ing.-Arch. 56, 1986): for every node with friction
//!
//! ```text
//! 0 <= F_n            complements   gap >= 0
//! 0 <= φ+ = tan φ F_n + c − F_t     λ+ >= 0
//! 0 <= φ− = tan φ F_n + c + F_t     λ− >= 0,       slip = λ+ − λ−
//! ```
//!
//! and without friction only the first line; [`crate::interface::tableau`] pivots through its bases. In this form cohesion also
//! acts on open nodes, which Coulomb's law excludes; therefore the result is checked afterwards.

pub use crate::interface::tableau::PathEnd;
use crate::interface::tableau::{Columns, PathStart, Tableau, positive};
use crate::{AssumedMode, InterfaceProblem, TestedQuantity};

/// A variable of the tableau.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum VariableKind {
    Force,
    Gap,
    /// φ+ and φ−: the unused friction.
    Slack {
        plus: bool,
    },
    /// λ+ and λ−.
    Slip {
        plus: bool,
    },
    /// A variable of either sign: the motion of a node without a constraint in that direction.
    Loose,
}

/// The state of a path.
#[derive(Debug, Clone)]
pub struct Lemke {
    /// In the problem's units of force and length.
    pub tableau: Tableau,
    /// Node and kind of every variable.
    variables: Vec<(usize, VariableKind)>,
    /// The nodes with friction, with friction coefficient and cohesion.
    friction: Vec<Option<(f64, f64)>>,
    force: f64,
    length: f64,
}

/// Number of starts: all nodes free, their initial modes, all fixed, all sliding.
pub const STARTS: usize = 4;

/// Mode of every node in the basis of a start: 0 all free, 1 initial modes, 2 all fixed, 3 all sliding.
fn start(problem: &InterfaceProblem, brought: &[AssumedMode], number: usize) -> Vec<AssumedMode> {
    let of =
        |(place, &brought): (usize, &AssumedMode)| match (number, problem.nodes[place].choices()) {
            (0, _) | (_, [AssumedMode::Free]) => AssumedMode::Free,
            (1, _) => brought,
            (2, choices) if choices.contains(&AssumedMode::Fixed) => AssumedMode::Fixed,
            _ => AssumedMode::Plus,
        };
    brought.iter().enumerate().map(of).collect()
}

impl Lemke {
    /// The tableau of a problem at start `number`, which is less than [`STARTS`]; `brought` are the initial modes, one per node.
    /// `None` if the basis of that start is singular.
    pub fn new(
        problem: &InterfaceProblem,
        brought: &[AssumedMode],
        number: usize,
    ) -> Option<Lemke> {
        let start = start(problem, brought, number);
        let (relation, count) = (&problem.relation, problem.relation.count());
        let friction: Vec<Option<(f64, f64)>> = problem
            .nodes
            .iter()
            .map(|node| {
                let rough = node.moves() == [true; 2] && !node.friction.is_smooth();
                rough.then(|| (node.friction.coefficient(), node.friction.cohesion))
            })
            .collect();
        let rows = count + friction.iter().flatten().count();
        let mut lemke = Lemke {
            tableau: Tableau::new(rows),
            variables: Vec::new(),
            friction,
            force: positive(problem.force),
            length: positive(problem.length),
        };
        let (force, length) = (lemke.force, lemke.length);
        // (I + R / k) ΔF − R v = start, column by column.
        let columns = Columns { relation, force };
        let mut rhs = columns.start(rows);
        let mut extra = count;
        for (place, node) in problem.nodes.iter().enumerate() {
            let (n, t) = (2 * place, 2 * place + 1);
            columns.add_force(n, node.state.f_n, &mut rhs);
            columns.add_force(t, node.state.f_t, &mut rhs);
            if let Some(over) = node.kinematics.filter(|k| k.moves[0]) {
                columns.add_motion(n, -(over.gap - node.prescribed[0]), &mut rhs);
                lemke.add(place, VariableKind::Force, |column| {
                    columns.add_force(n, force, column)
                });
                lemke.add(place, VariableKind::Gap, |column| {
                    columns.add_motion(n, -length, column)
                });
            } else {
                lemke.add(place, VariableKind::Loose, |column| {
                    columns.add_motion(n, length, column)
                });
            }
            let Some((coefficient, cohesion)) = lemke.friction[place] else {
                lemke.add(place, VariableKind::Loose, |column| {
                    columns.add_motion(t, length, column)
                });
                continue;
            };
            columns.add_force(t, -cohesion, &mut rhs);
            let slipped = node.state.slipped(&problem.settings) + node.prescribed[1];
            columns.add_motion(t, slipped, &mut rhs);
            // F_t = tan φ F_n + c − φ+ is expressed by the columns of F_n and φ+.
            let of_normal = lemke.tableau.column(lemke.variables.len() - 2);
            columns.add_force(t, coefficient * force, of_normal);
            of_normal[extra] = -2.0 * coefficient;
            lemke.add(place, VariableKind::Slack { plus: true }, |column| {
                columns.add_force(t, -force, column);
                column[extra] = 1.0;
            });
            lemke.add(place, VariableKind::Slip { plus: true }, |column| {
                columns.add_motion(t, length, column);
            });
            lemke.add(place, VariableKind::Slack { plus: false }, |column| {
                column[extra] = 1.0;
            });
            lemke.add(place, VariableKind::Slip { plus: false }, |column| {
                columns.add_motion(t, -length, column);
            });
            rhs[extra] = 2.0 * cohesion / force;
            extra += 1;
        }
        let basis = (0..lemke.variables.len())
            .filter(|&v| lemke.is_basic(lemke.variables[v], &start))
            .collect();
        lemke.tableau.start(basis, rhs, PathStart::PLAIN)?;
        Some(lemke)
    }

    fn add(&mut self, place: usize, kind: VariableKind, fill: impl FnOnce(&mut [f64])) {
        let number = self.variables.len();
        let partner = match kind {
            VariableKind::Force | VariableKind::Slack { .. } => number + 1,
            VariableKind::Gap | VariableKind::Slip { .. } => number - 1,
            VariableKind::Loose => number,
        };
        self.variables.push((place, kind));
        self.tableau.add(partner, fill);
    }

    /// Whether a variable is basic if its node has this mode.
    fn is_basic(&self, (place, kind): (usize, VariableKind), start: &[AssumedMode]) -> bool {
        let does = start[place];
        match kind {
            VariableKind::Loose => true,
            VariableKind::Force => does != AssumedMode::Free,
            VariableKind::Gap => does == AssumedMode::Free,
            // A free node has no friction, so either side may be used.
            VariableKind::Slip { plus: true } => {
                matches!(does, AssumedMode::Plus | AssumedMode::Free)
            }
            VariableKind::Slack { plus: true } => {
                matches!(does, AssumedMode::Fixed | AssumedMode::Minus)
            }
            VariableKind::Slip { plus: false } => does == AssumedMode::Minus,
            VariableKind::Slack { plus: false } => does != AssumedMode::Minus,
        }
    }

    /// The node of the last pivot, and the quantity that reached its bound. `None` if that was the covering variable.
    pub fn bound(&self) -> Option<(usize, TestedQuantity)> {
        let (place, kind) = self.variables[self.tableau.left()?];
        let tested = match kind {
            VariableKind::Force => TestedQuantity::NormalForce,
            VariableKind::Gap => TestedQuantity::Gap,
            VariableKind::Slack { .. } => TestedQuantity::ShearForce,
            VariableKind::Slip { .. } => TestedQuantity::Slip,
            VariableKind::Loose => return None,
        };
        Some((place, tested))
    }

    fn at(&self, place: usize, kind: VariableKind) -> Option<f64> {
        let variable = self.variables.iter().position(|&v| v == (place, kind))?;
        self.tableau
            .is_basic(variable)
            .then(|| self.tableau.of(variable))
    }

    /// Mode of a node in the current basis.
    pub fn assumed(&self, place: usize) -> AssumedMode {
        let basic = |kind| self.at(place, kind).is_some();
        if !basic(VariableKind::Force) {
            AssumedMode::Free
        } else if self.friction[place].is_none() || basic(VariableKind::Slip { plus: true }) {
            AssumedMode::Plus
        } else if basic(VariableKind::Slip { plus: false }) {
            AssumedMode::Minus
        } else {
            AssumedMode::Fixed
        }
    }

    /// F_n, F_t, gap and slip of a node in the current, relaxed solution; the gap of a touching node is 0.
    pub fn numbers(&self, place: usize) -> [f64; 4] {
        let value = |kind| self.at(place, kind).unwrap_or(0.0);
        let f_n = self.force * value(VariableKind::Force);
        let f_t = self.friction[place].map_or(0.0, |(coefficient, cohesion)| {
            coefficient * f_n + cohesion - self.force * value(VariableKind::Slack { plus: true })
        });
        let slip =
            value(VariableKind::Slip { plus: true }) - value(VariableKind::Slip { plus: false });
        [
            f_n,
            f_t,
            self.length * value(VariableKind::Gap),
            self.length * slip,
        ]
    }
}
