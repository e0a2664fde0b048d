//! Lemke's complementary pivoting on the frozen interface problem.
//!
//! Coulomb's law in the plane is a linear complementarity problem (Klarbring, Ing.-Arch. 56, 1986): for every rough node
//!
//! ```text
//! 0 <= F_n            complements   gap >= 0
//! 0 <= φ+ = tan φ F_n + c − F_t     λ+ >= 0
//! 0 <= φ− = tan φ F_n + c + F_t     λ− >= 0,       slip = λ+ − λ−
//! ```
//!
//! and for a smooth one only the first line. A covering variable relaxes all of them at once. In every pivot the complement
//! of the variable that left last enters the basis, until the covering variable leaves it: then the basis says what every
//! node does. If nothing bounds the entering variable, the path ends on a ray. Ties are broken lexicographically, so that no
//! basis comes twice. Here cohesion acts on open nodes too, which Coulomb's law does not say; therefore what is found is
//! checked afterwards.

use crate::contact::table2::Tested;
use crate::interface::problem::{Assumed, InterfaceProblem};
use crate::linalg::DenseFactors;

/// Entries of an entering column below this part of its largest are zero.
const TINY: f64 = 1e-11;
/// Ratios that differ by less than this are a tie.
const TIE: f64 = 1e-12;
/// Largest number of pivots of a path, per row. A usual path takes about one per row. If all forces are round-off, no basis
/// is better than another and the path would not end.
const PIVOTS: usize = 20;
/// Estimated norm of a basis' scaled inverse from which on it is singular.
const SINGULAR: f64 = 1e11;

/// A variable of the tableau.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum VariableKind {
    Force,
    Gap,
    /// φ+ and φ−: what friction could still give.
    Slack {
        plus: bool,
    },
    /// λ+ and λ−.
    Slip {
        plus: bool,
    },
    /// Of either sign: the motion of a node that nothing holds in that direction.
    Loose,
}

/// A tableau on its way.
#[derive(Debug, Clone)]
pub struct Lemke {
    rows: usize,
    /// Column by column: every variable's, then the covering variable's, then the values of the basic variables; in units
    /// of the problem's force and length.
    table: Vec<f64>,
    /// Node and kind of every variable.
    variables: Vec<(usize, VariableKind)>,
    /// The variable of every row.
    basis: Vec<usize>,
    /// The basis of the start, which breaks ties.
    first: Vec<usize>,
    /// The variable that enters next. `None` before the first pivot and after the last.
    entering: Option<usize>,
    /// Node and kind of the variable that left last.
    left: Option<(usize, VariableKind)>,
    ended: Option<PathEnd>,
    pivots: usize,
    /// Which nodes are rough, with the friction coefficient and the cohesion.
    friction: Vec<Option<(f64, f64)>>,
    force: f64,
    length: f64,
}

/// How the path ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathEnd {
    /// The basis solves the problem.
    Solved,
    /// Nothing bounds the variable that enters: no state is found from this start.
    Ray,
    /// It did not end within the pivots that it has.
    Astray,
}

/// Number of starts: all nodes free, as they come, all fixed, all sliding.
pub const STARTS: usize = 4;

/// What every node does in the basis of a start: 0 all free, 1 as they come, 2 all fixed, 3 all sliding.
fn start(problem: &InterfaceProblem, brought: &[Assumed], number: usize) -> Vec<Assumed> {
    let of = |(place, &brought): (usize, &Assumed)| match (number, problem.nodes[place].choices()) {
        (0, _) | (_, [Assumed::Free]) => Assumed::Free,
        (1, _) => brought,
        (2, choices) if choices.contains(&Assumed::Fixed) => Assumed::Fixed,
        _ => Assumed::Plus,
    };
    brought.iter().enumerate().map(of).collect()
}

impl Lemke {
    /// The tableau of a problem at start `number`, less than [`STARTS`]; `brought` is what the nodes come with, one entry a
    /// node. `None` if the basis of that start is singular.
    pub fn new(problem: &InterfaceProblem, brought: &[Assumed], number: usize) -> Option<Lemke> {
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
            rows,
            table: Vec::new(),
            variables: Vec::new(),
            basis: Vec::new(),
            first: Vec::new(),
            entering: None,
            left: None,
            ended: None,
            pivots: 0,
            friction,
            force: positive(problem.force),
            length: positive(problem.length),
        };
        let (force, length) = (lemke.force, lemke.length);
        // (I + R / k) ΔF − R v = start, a column at a time.
        let response = |j: usize| &relation.response[j * count..(j + 1) * count];
        let of_force = |j: usize, times: f64, column: &mut [f64]| {
            for (to, r) in column.iter_mut().zip(response(j)) {
                *to += times * r / relation.stiffness / force;
            }
            column[j] += times / force;
        };
        let of_motion = |j: usize, times: f64, column: &mut [f64]| {
            for (to, r) in column.iter_mut().zip(response(j)) {
                *to -= times * r / force;
            }
        };
        let mut rhs = vec![0.0; rows];
        for (to, start) in rhs.iter_mut().zip(&relation.start) {
            *to = start / force;
        }
        let mut extra = count;
        for (place, node) in problem.nodes.iter().enumerate() {
            let (n, t) = (2 * place, 2 * place + 1);
            of_force(n, node.state.f_n, &mut rhs);
            of_force(t, node.state.f_t, &mut rhs);
            if let Some(over) = node.kinematics.filter(|k| k.moves[0]) {
                of_motion(n, -(over.gap - node.prescribed[0]), &mut rhs);
                lemke.add(place, VariableKind::Force, |column| {
                    of_force(n, force, column)
                });
                lemke.add(place, VariableKind::Gap, |column| {
                    of_motion(n, -length, column)
                });
            } else {
                lemke.add(place, VariableKind::Loose, |column| {
                    of_motion(n, length, column)
                });
            }
            let Some((coefficient, cohesion)) = lemke.friction[place] else {
                lemke.add(place, VariableKind::Loose, |column| {
                    of_motion(t, length, column)
                });
                continue;
            };
            of_force(t, -cohesion, &mut rhs);
            let slipped = node.state.slipped(&problem.settings) + node.prescribed[1];
            of_motion(t, slipped, &mut rhs);
            // F_t = tan φ F_n + c − φ+ acts through the columns of F_n and φ+.
            let of_normal = (lemke.variables.len() - 2) * rows;
            of_force(
                t,
                coefficient * force,
                &mut lemke.table[of_normal..of_normal + rows],
            );
            lemke.table[of_normal + extra] = -2.0 * coefficient;
            lemke.add(place, VariableKind::Slack { plus: true }, |column| {
                of_force(t, -force, column);
                column[extra] = 1.0;
            });
            lemke.add(place, VariableKind::Slip { plus: true }, |column| {
                of_motion(t, length, column);
            });
            lemke.add(place, VariableKind::Slack { plus: false }, |column| {
                column[extra] = 1.0;
            });
            lemke.add(place, VariableKind::Slip { plus: false }, |column| {
                of_motion(t, -length, column);
            });
            rhs[extra] = 2.0 * cohesion / force;
            extra += 1;
        }
        lemke.basis = (0..lemke.variables.len())
            .filter(|&v| lemke.is_basic(lemke.variables[v], &start))
            .collect();
        lemke.first.clone_from(&lemke.basis);
        lemke.table.extend(vec![0.0; rows]);
        lemke.table.extend(rhs);
        lemke.reduce()?;
        let cover = lemke.variables.len() * rows;
        for row in 0..rows {
            let loose = lemke.variables[lemke.basis[row]].1 == VariableKind::Loose;
            lemke.table[cover + row] = if loose { 0.0 } else { -1.0 };
        }
        let all_hold = (0..rows).all(|row| lemke.is_loose(row) || lemke.value(row) >= 0.0);
        if all_hold {
            lemke.ended = Some(PathEnd::Solved);
        }
        Some(lemke)
    }

    fn add(&mut self, place: usize, kind: VariableKind, fill: impl FnOnce(&mut [f64])) {
        self.variables.push((place, kind));
        let from = self.table.len();
        self.table.resize(from + self.rows, 0.0);
        fill(&mut self.table[from..]);
    }

    /// Whether a variable is basic where its node does this.
    fn is_basic(&self, (place, kind): (usize, VariableKind), start: &[Assumed]) -> bool {
        let does = start[place];
        match kind {
            VariableKind::Loose => true,
            VariableKind::Force => does != Assumed::Free,
            VariableKind::Gap => does == Assumed::Free,
            // A free node has no friction, so that one side of it is as good as the other.
            VariableKind::Slip { plus: true } => matches!(does, Assumed::Plus | Assumed::Free),
            VariableKind::Slack { plus: true } => matches!(does, Assumed::Fixed | Assumed::Minus),
            VariableKind::Slip { plus: false } => does == Assumed::Minus,
            VariableKind::Slack { plus: false } => does != Assumed::Minus,
        }
    }

    /// Multiplies the tableau by the inverse of the basis.
    fn reduce(&mut self) -> Option<()> {
        let rows = self.rows;
        let matrix: Vec<f64> = self
            .basis
            .iter()
            .flat_map(|&v| self.table[v * rows..(v + 1) * rows].iter().copied())
            .collect();
        let columns = self.table.len() / rows.max(1);
        let mut dense = DenseFactors::new(rows, columns).ok()?;
        dense.factor(&matrix);
        if dense.inverse_norm() > SINGULAR {
            return None;
        }
        dense.solve(&mut self.table).ok()
    }

    fn is_loose(&self, row: usize) -> bool {
        self.variables
            .get(self.basis[row])
            .is_some_and(|v| v.1 == VariableKind::Loose)
    }

    fn value(&self, row: usize) -> f64 {
        self.table[(self.variables.len() + 1) * self.rows + row]
    }

    /// How the path ended. `None` while it goes on.
    pub fn ended(&self) -> Option<PathEnd> {
        self.ended
    }

    /// One pivot. `None` if the path has ended before.
    pub fn pivot(&mut self) -> Option<()> {
        if self.ended.is_some() {
            return None;
        }
        self.pivots += 1;
        if self.pivots > PIVOTS * self.rows {
            self.ended = Some(PathEnd::Astray);
            return Some(());
        }
        let cover = self.variables.len();
        let (entering, row) = match self.entering {
            None => (cover, self.most_broken()?),
            Some(entering) => match self.bounding(entering) {
                Some(row) => (entering, row),
                None => {
                    self.ended = Some(PathEnd::Ray);
                    return Some(());
                }
            },
        };
        let leaving = self.basis[row];
        self.left = self.variables.get(leaving).copied();
        self.exchange(entering, row);
        if leaving == cover {
            (self.ended, self.entering) = (Some(PathEnd::Solved), None);
        } else {
            self.entering = Some(self.complement(leaving));
        }
        Some(())
    }

    /// The row whose value is the most negative.
    fn most_broken(&self) -> Option<usize> {
        let rows = (0..self.rows).filter(|&row| !self.is_loose(row));
        rows.reduce(|best, row| {
            if self.comes_before(row, best, |lemke, row| lemke.value(row), |_| 1.0) {
                row
            } else {
                best
            }
        })
    }

    /// The row that bounds an entering variable: of the smallest ratio, the covering variable's first, then
    /// lexicographically.
    fn bounding(&self, entering: usize) -> Option<usize> {
        let column = &self.table[entering * self.rows..(entering + 1) * self.rows];
        let tiny = TINY * column.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let rows = (0..self.rows).filter(|&row| column[row] > tiny && !self.is_loose(row));
        rows.reduce(|best, row| {
            let ratio = |row: usize| self.value(row) / column[row];
            let tied = (ratio(row) - ratio(best)).abs() <= TIE;
            let cover = self.variables.len();
            if tied && self.basis[best] == cover {
                return best;
            }
            let first = tied && self.basis[row] == cover;
            if first
                || self.comes_before(row, best, |lemke, row| lemke.value(row), |row| column[row])
            {
                row
            } else {
                best
            }
        })
    }

    /// Whether a row is lexicographically less than another, both divided by their divisors.
    fn comes_before(
        &self,
        row: usize,
        other: usize,
        value: impl Fn(&Self, usize) -> f64,
        divisor: impl Fn(usize) -> f64,
    ) -> bool {
        let (mine, its) = (divisor(row), divisor(other));
        let gap = value(self, row) / mine - value(self, other) / its;
        if gap.abs() > TIE {
            return gap < 0.0;
        }
        for &v in &self.first {
            let of = |row: usize| self.table[v * self.rows + row];
            let gap = of(row) / mine - of(other) / its;
            if gap.abs() > TIE {
                return gap < 0.0;
            }
        }
        false
    }

    fn exchange(&mut self, entering: usize, row: usize) {
        let rows = self.rows;
        let column: Vec<f64> = self.table[entering * rows..(entering + 1) * rows].to_vec();
        let pivot = column[row];
        for other in self.table.chunks_exact_mut(rows) {
            let times = other[row] / pivot;
            if times != 0.0 {
                for (x, c) in other.iter_mut().zip(&column) {
                    *x -= times * c;
                }
            }
            other[row] = times;
        }
        self.basis[row] = entering;
    }

    fn complement(&self, variable: usize) -> usize {
        match self.variables[variable].1 {
            VariableKind::Force | VariableKind::Slack { .. } => variable + 1,
            VariableKind::Gap | VariableKind::Slip { .. } => variable - 1,
            VariableKind::Loose => variable,
        }
    }

    /// The node of the last pivot, and what reached its bound there. `None` if that was the covering variable.
    pub fn bound(&self) -> Option<(usize, Tested)> {
        let (place, kind) = self.left?;
        let tested = match kind {
            VariableKind::Force => Tested::NormalForce,
            VariableKind::Gap => Tested::Gap,
            VariableKind::Slack { .. } => Tested::ShearForce,
            VariableKind::Slip { .. } => Tested::Slip,
            VariableKind::Loose => return None,
        };
        Some((place, tested))
    }

    /// The covering variable: how far the problem is still relaxed, in units of its forces and lengths.
    pub fn cover(&self) -> f64 {
        let cover = self.variables.len();
        match self.basis.iter().position(|&v| v == cover) {
            Some(row) => self.value(row),
            None if self.ended == Some(PathEnd::Solved) => 0.0,
            None => (0..self.rows)
                .filter(|&row| !self.is_loose(row))
                .fold(0.0, |most, row| most.max(-self.value(row))),
        }
    }

    fn at(&self, place: usize, kind: VariableKind) -> Option<f64> {
        let row = self
            .basis
            .iter()
            .position(|&v| self.variables.get(v) == Some(&(place, kind)))?;
        Some(self.value(row))
    }

    /// What a node does in the present basis.
    pub fn assumed(&self, place: usize) -> Assumed {
        let basic = |kind| self.at(place, kind).is_some();
        if !basic(VariableKind::Force) {
            Assumed::Free
        } else if self.friction[place].is_none() || basic(VariableKind::Slip { plus: true }) {
            Assumed::Plus
        } else if basic(VariableKind::Slip { plus: false }) {
            Assumed::Minus
        } else {
            Assumed::Fixed
        }
    }

    /// F_n, F_t, gap and slip of a node in the present, relaxed solution; a gap is 0 where the node touches.
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

fn positive(scale: f64) -> f64 {
    if scale > 0.0 { scale } else { 1.0 }
}
