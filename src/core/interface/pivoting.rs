//! Lemke's complementary pivoting on the frozen interface problem; [`crate::interface::tableau`] pivots through the bases.
//!
//! Coulomb's law in the plane is a linear complementarity problem (Klarbring, Ing.-Arch. 56, 1986): for every node with friction
//!
//! ```text
//! 0 <= F_n            complements   gap >= 0
//! 0 <= φ+ = tan φ F_n + c − F_t     λ+ >= 0
//! 0 <= φ− = tan φ F_n + c + F_t     λ− >= 0,       slip = λ+ − λ−
//! ```
//!
//! and without friction only the first line ([`CoulombForm::Klarbring`]). In this form cohesion also acts on open nodes, which Coulomb's
//! law excludes; therefore the result is checked afterwards.
//!
//! In the form of Stewart and Trinkle (Int. J. Numer. Meth. Engng 39, 1996, [`CoulombForm::Copositive`]) the friction force is split into
//! two opposite parts:
//!
//! ```text
//! 0 <= F_n                              complements   gap >= 0
//! 0 <= β+                                             λ − slip >= 0
//! 0 <= β−                                             λ + slip >= 0
//! 0 <= λ                                              tan φ F_n + c − β+ − β− >= 0,       F_t = β+ − β−
//! ```
//!
//! With all nodes free at the start, the matrix M of this problem gives zᵀ
//! M z = Fᵀ W F + tan φ F_n λ, which is never negative for z >= 0 if the compliance W has no negative eigenvalue: M
//! is copositive. Lemke's path can then end on a ray only if forces within the friction cones that cause no motion (W
//! F = 0) extract energy from the free motion q (Fᵀ q < 0). In a structure W = H M⁻¹ Hᵀ without initial gaps, q is in
//! the range of H and no such forces exist: a solution exists, and the path ends there (Anitescu and Potra, Nonlinear
//! Dynamics 14, 1997). The path may be long, and depends on how much the covering variable relaxes each row;
//! therefore several starts are used. The other form has half as many rows but is not copositive.

pub use crate::interface::tableau::PathEnd;
use crate::interface::tableau::{Columns, PathStart, Tableau, positive};
use crate::{AssumedMode, InterfaceProblem, ProblemNode, TestedQuantity};

/// A path that ends on a ray counts as solved if the covering variable is at most this (relative): the rows that should bound it
/// are tied, and round-off decides between them.
const NEARLY: f64 = 1e-9;
/// Ties are broken by shifting the rows by up to this (relative), and by less with every start: a basis may amplify the shifts,
/// and would then solve only the shifted rows.
const SHIFT: f64 = 1e-7;
const SHIFT_FALLS: f64 = 0.3;
/// Maximum number of pivots per row and start of a copositive problem. Most paths take fewer than 3 per row; some structures with
/// 120 to 200 contacts take 90.
const PIVOTS: usize = 100;

/// How Coulomb's law is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CoulombForm {
    /// With the unused friction in both directions.
    Klarbring,
    /// With the friction force in two parts.
    Copositive,
}

impl CoulombForm {
    /// Number of starts. [`CoulombForm::Klarbring`]: all nodes free, their initial modes, all fixed, all sliding.
    /// [`CoulombForm::Copositive`]: the first relaxes all rows equally, the others relax each row by 0.2 to 1; each start has different
    /// shifts.
    pub fn starts(self) -> usize {
        match self {
            CoulombForm::Klarbring => 4,
            CoulombForm::Copositive => 8,
        }
    }

    /// Rows of a node with friction besides those of its two components.
    fn more_rows(self) -> usize {
        match self {
            CoulombForm::Klarbring => 1,
            CoulombForm::Copositive => 2,
        }
    }

    /// Mode of every node in the basis of a start.
    fn start(
        self,
        problem: &InterfaceProblem,
        brought: &[AssumedMode],
        number: usize,
    ) -> Vec<AssumedMode> {
        let of = |(node, &brought): (&ProblemNode, &AssumedMode)| match (number, node.choices()) {
            _ if self == CoulombForm::Copositive => AssumedMode::Free,
            (0, _) | (_, [AssumedMode::Free]) => AssumedMode::Free,
            (1, _) => brought,
            (2, choices) if choices.contains(&AssumedMode::Fixed) => AssumedMode::Fixed,
            _ => AssumedMode::Plus,
        };
        problem.nodes.iter().zip(brought).map(of).collect()
    }
}

/// A variable of the tableau.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// β+ and β−.
    Friction {
        plus: bool,
    },
    /// λ − slip and λ + slip.
    Rest {
        plus: bool,
    },
    /// λ.
    Speed,
    /// Unused friction.
    Room,
    /// A variable of either sign: the motion of a node without a constraint in that direction.
    Loose,
}

impl VariableKind {
    /// Whether it is basic if its node has this mode.
    fn is_basic(self, does: AssumedMode) -> bool {
        match self {
            VariableKind::Loose | VariableKind::Rest { .. } | VariableKind::Room => true,
            VariableKind::Friction { .. } | VariableKind::Speed => false,
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
}

/// The state of a path.
#[derive(Debug, Clone)]
pub struct Pivoting {
    /// In the problem's units of force and length.
    pub tableau: Tableau,
    /// How the law is written.
    pub form: CoulombForm,
    /// Node and kind of every variable, and the first variable of every node.
    variables: Vec<(usize, VariableKind)>,
    firsts: Vec<usize>,
    /// The nodes with friction, with friction coefficient and cohesion.
    friction: Vec<Option<(f64, f64)>>,
    force: f64,
    length: f64,
}

impl Pivoting {
    /// The tableau of a problem at start `number`, which is less than [`CoulombForm::starts`]; `brought` are the initial modes, one per
    /// node. `None` if the basis of that start is singular, or memory is insufficient.
    pub fn new(
        form: CoulombForm,
        problem: &InterfaceProblem,
        brought: &[AssumedMode],
        number: usize,
    ) -> Option<Pivoting> {
        let start = form.start(problem, brought, number);
        let (relation, count) = (&problem.relation, problem.relation.count());
        let friction: Vec<Option<(f64, f64)>> = problem
            .nodes
            .iter()
            .map(|node| {
                let rough = node.moves() == [true; 2] && !node.friction.is_smooth();
                rough.then(|| (node.friction.coefficient(), node.friction.cohesion))
            })
            .collect();
        let rows = count + form.more_rows() * friction.iter().flatten().count();
        let mut path = Pivoting {
            tableau: Tableau::new(rows),
            form,
            variables: Vec::new(),
            firsts: Vec::new(),
            friction,
            force: positive(problem.force),
            length: positive(problem.length),
        };
        let (force, length) = (path.force, path.length);
        // (I + R / k) F − R v = start + (I + R / k) F_0, column by column.
        let columns = Columns { relation, force };
        let mut rhs = columns.start(rows);
        let mut extra = count;
        for (place, node) in problem.nodes.iter().enumerate() {
            let (n, t) = (2 * place, 2 * place + 1);
            path.firsts.push(path.variables.len());
            columns.add_force(n, node.state.f_n, &mut rhs);
            columns.add_force(t, node.state.f_t, &mut rhs);
            if let Some(over) = node.kinematics.filter(|k| k.moves[0]) {
                columns.add_motion(n, -(over.gap - node.prescribed[0]), &mut rhs);
                path.add(place, VariableKind::Force, |column| {
                    columns.add_force(n, force, column)
                });
                path.add(place, VariableKind::Gap, |column| {
                    columns.add_motion(n, -length, column)
                });
            } else {
                path.add(place, VariableKind::Loose, |column| {
                    columns.add_motion(n, length, column)
                });
            }
            let Some((_, cohesion)) = path.friction[place] else {
                path.add(place, VariableKind::Loose, |column| {
                    columns.add_motion(t, length, column)
                });
                continue;
            };
            if form == CoulombForm::Klarbring {
                columns.add_force(t, -cohesion, &mut rhs);
            }
            let slipped = node.state.slipped(&problem.settings) + node.prescribed[1];
            columns.add_motion(t, slipped, &mut rhs);
            match form {
                CoulombForm::Klarbring => path.add_unused(place, &columns, extra, &mut rhs),
                CoulombForm::Copositive => path.add_parts(place, &columns, extra, &mut rhs),
            }
            extra += form.more_rows();
        }
        let basis = (0..path.variables.len())
            .filter(|&v| path.variables[v].1.is_basic(start[path.variables[v].0]))
            .collect();
        let shift = SHIFT * SHIFT_FALLS.powi(number as i32);
        let begin = match form {
            CoulombForm::Klarbring => PathStart::PLAIN,
            CoulombForm::Copositive => PathStart {
                cover: &|row| match number {
                    0 => 1.0,
                    _ => 0.2 + 0.8 * spread(row, number),
                },
                shift: Some(&|row| shift * (0.5 + 0.5 * spread(row, number))),
                pivots: PIVOTS,
            },
        };
        path.tableau.start(basis, rhs, begin)?;
        Some(path)
    }

    /// Adds the unused friction of a node in both directions, its slip, and their row.
    fn add_unused(&mut self, place: usize, columns: &Columns, extra: usize, rhs: &mut [f64]) {
        let (t, force, length) = (2 * place + 1, self.force, self.length);
        let (coefficient, cohesion) = self.friction[place].unwrap_or_default();
        // F_t = tan φ F_n + c − φ+ is expressed by the columns of F_n and φ+.
        let of_normal = self.tableau.column(self.firsts[place]);
        columns.add_force(t, coefficient * force, of_normal);
        of_normal[extra] = -2.0 * coefficient;
        self.add(place, VariableKind::Slack { plus: true }, |column| {
            columns.add_force(t, -force, column);
            column[extra] = 1.0;
        });
        self.add(place, VariableKind::Slip { plus: true }, |column| {
            columns.add_motion(t, length, column);
        });
        self.add(place, VariableKind::Slack { plus: false }, |column| {
            column[extra] = 1.0;
        });
        self.add(place, VariableKind::Slip { plus: false }, |column| {
            columns.add_motion(t, -length, column);
        });
        rhs[extra] = 2.0 * cohesion / force;
    }

    /// Adds the two parts of the friction force of a node, λ, their complements, and their rows.
    fn add_parts(&mut self, place: usize, columns: &Columns, extra: usize, rhs: &mut [f64]) {
        let (t, force, length) = (2 * place + 1, self.force, self.length);
        let (coefficient, cohesion) = self.friction[place].unwrap_or_default();
        // slip = λ − (λ − slip); the two additional rows state that the two remainders sum to 2 λ, and define `room`.
        let (sum, room) = (extra, extra + 1);
        self.tableau.column(self.firsts[place])[room] = -coefficient;
        self.add(place, VariableKind::Friction { plus: true }, |column| {
            columns.add_force(t, force, column);
            column[room] = 1.0;
        });
        self.add(place, VariableKind::Rest { plus: true }, |column| {
            columns.add_motion(t, -length, column);
            column[sum] = 1.0;
        });
        self.add(place, VariableKind::Friction { plus: false }, |column| {
            columns.add_force(t, -force, column);
            column[room] = 1.0;
        });
        self.add(place, VariableKind::Rest { plus: false }, |column| {
            column[sum] = 1.0;
        });
        self.add(place, VariableKind::Speed, |column| {
            columns.add_motion(t, length, column);
            column[sum] = -2.0;
        });
        self.add(place, VariableKind::Room, |column| column[room] = 1.0);
        rhs[room] = cohesion / force;
    }

    fn add(&mut self, place: usize, kind: VariableKind, fill: impl FnOnce(&mut [f64])) {
        let number = self.variables.len();
        let partner = match kind {
            VariableKind::Force
            | VariableKind::Slack { .. }
            | VariableKind::Friction { .. }
            | VariableKind::Speed => number + 1,
            VariableKind::Gap
            | VariableKind::Slip { .. }
            | VariableKind::Rest { .. }
            | VariableKind::Room => number - 1,
            VariableKind::Loose => number,
        };
        self.variables.push((place, kind));
        self.tableau.add(partner, fill);
    }

    /// Result of the path. `None` while it continues.
    pub fn ended(&self) -> Option<PathEnd> {
        match self.tableau.ended() {
            Some(PathEnd::Ray)
                if self.form == CoulombForm::Copositive && self.tableau.cover() <= NEARLY =>
            {
                Some(PathEnd::Solved)
            }
            other => other,
        }
    }

    /// The node of the last pivot, and the quantity that reached its bound. `None` if that was the covering variable.
    pub fn bound(&self) -> Option<(usize, TestedQuantity)> {
        let (place, kind) = self.variables[self.tableau.left()?];
        let tested = match kind {
            VariableKind::Force => TestedQuantity::NormalForce,
            VariableKind::Gap => TestedQuantity::Gap,
            VariableKind::Slack { .. } | VariableKind::Friction { .. } | VariableKind::Room => {
                TestedQuantity::ShearForce
            }
            VariableKind::Slip { .. } | VariableKind::Rest { .. } | VariableKind::Speed => {
                TestedQuantity::Slip
            }
            VariableKind::Loose => return None,
        };
        Some((place, tested))
    }

    fn find(&self, place: usize, kind: VariableKind) -> Option<usize> {
        let first = self.firsts[place];
        let mut own = self.variables[first..].iter().take_while(|v| v.0 == place);
        own.position(|v| v.1 == kind).map(|k| first + k)
    }

    fn is_basic(&self, place: usize, kind: VariableKind) -> bool {
        let variable = self.find(place, kind);
        variable.is_some_and(|variable| self.tableau.is_basic(variable))
    }

    /// Mode of a node in the current basis. In the copositive form, a node whose friction has not reached a bound sticks.
    pub fn assumed(&self, place: usize) -> AssumedMode {
        let basic = |kind| self.is_basic(place, kind);
        let sliding = |plus| match self.form {
            CoulombForm::Klarbring => basic(VariableKind::Slip { plus }),
            _ if basic(VariableKind::Room) || !basic(VariableKind::Speed) => false,
            _ => {
                let minus = basic(VariableKind::Friction { plus: false })
                    || (!basic(VariableKind::Friction { plus: true })
                        && !basic(VariableKind::Rest { plus: false }));
                minus != plus
            }
        };
        if !basic(VariableKind::Force) {
            AssumedMode::Free
        } else if self.friction[place].is_none() || sliding(true) {
            AssumedMode::Plus
        } else if sliding(false) {
            AssumedMode::Minus
        } else {
            AssumedMode::Fixed
        }
    }

    /// F_n, F_t, gap and slip of a node in the current, relaxed solution; the gap of a touching node is 0.
    pub fn numbers(&self, place: usize) -> [f64; 4] {
        let value = |kind| {
            self.find(place, kind)
                .map_or(0.0, |variable| self.tableau.of(variable))
        };
        let part = |plus| value(VariableKind::Friction { plus });
        let f_n = self.force * value(VariableKind::Force);
        let gap = self.length * value(VariableKind::Gap);
        let (f_t, gap, slip) = match self.form {
            CoulombForm::Klarbring => (
                self.friction[place].map_or(0.0, |(coefficient, cohesion)| {
                    let unused = value(VariableKind::Slack { plus: true });
                    coefficient * f_n + cohesion - self.force * unused
                }),
                gap,
                value(VariableKind::Slip { plus: true })
                    - value(VariableKind::Slip { plus: false }),
            ),
            CoulombForm::Copositive => (
                self.force * (part(true) - part(false)),
                // Without a contact force, or a surface.
                match self.find(place, VariableKind::Gap) {
                    Some(_) => gap,
                    None => f64::INFINITY,
                },
                value(VariableKind::Speed) - value(VariableKind::Rest { plus: true }),
            ),
        };
        [f_n, f_t, gap, self.length * slip]
    }
}

/// Reproducible numbers in 0 to 1 that differ between rows and starts: the top bits of a product with an odd number, mixed
/// (Steele, Lea and Flood's generator, 2014).
fn spread(row: usize, number: usize) -> f64 {
    let seed = (row as u64) << 8 | number as u64;
    let mut x = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
