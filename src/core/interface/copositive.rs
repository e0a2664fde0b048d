//! Complementary pivoting on Coulomb's law in the form of Stewart and Trinkle (Int. J. Numer. Meth. Engng 39, 1996), with the
//! friction force split into two opposite parts: for every node with friction
//!
//! ```text
//! 0 <= F_n                              complements   gap >= 0
//! 0 <= β+                                             λ − slip >= 0
//! 0 <= β−                                             λ + slip >= 0
//! 0 <= λ                                              tan φ F_n + c − β+ − β− >= 0,       F_t = β+ − β−
//! ```
//!
//! and without friction only the first line. With all nodes free at the start, the matrix M of this problem gives zᵀ
//! M z = Fᵀ W F + tan φ F_n λ, which is never negative for z >= 0 if the compliance W has no negative eigenvalue: M
//! is copositive. Lemke's path can then end on a ray only if forces within the friction cones that cause no motion (W
//! F = 0) extract energy from the free motion q (Fᵀ q < 0). In a structure W = H M⁻¹ Hᵀ without initial gaps, q is in
//! the range of H and no such forces exist: a solution exists, and the path ends there (Anitescu and Potra, Nonlinear
//! Dynamics 14, 1997). The path may be long, and depends on how much the covering variable relaxes each row;
//! therefore several starts are used. The form of [`crate::interface::lemke`] has half as many rows but is not
//! copositive.

use crate::interface::tableau::{Columns, PathEnd, PathStart, Tableau, positive};
use crate::{AssumedMode, InterfaceProblem, TestedQuantity};

/// A path that ends on a ray counts as solved if the covering variable is at most this (relative): the rows that should bound it
/// are tied, and round-off decides between them.
const NEARLY: f64 = 1e-9;
/// Ties are broken by shifting the rows by up to this (relative), and by less with every start: a basis may amplify the shifts,
/// and would then solve only the shifted rows.
const SHIFT: f64 = 1e-7;
const SHIFT_FALLS: f64 = 0.3;
/// Number of starts: the first relaxes all rows equally, the others relax each row by 0.2 to 1; each start has different shifts.
pub const STARTS: usize = 8;
/// Maximum number of pivots per row and start. Most paths take fewer than 3 per row; some structures with 120 to 200 contacts
/// take 90.
const PIVOTS: usize = 100;

/// Variables of a node with friction, in this order, each followed by its complement.
const FORCE: usize = 0;
const GAP: usize = 1;
/// β+ and β−.
const PLUS: usize = 2;
const MINUS: usize = 4;
/// λ − slip and λ + slip.
const PLUS_REST: usize = 3;
const MINUS_REST: usize = 5;
/// λ.
const SPEED: usize = 6;
/// Unused friction.
const ROOM: usize = 7;

/// The state of a path that starts with all nodes free.
#[derive(Debug, Clone)]
pub struct Copositive {
    /// In the problem's units of force and length.
    pub tableau: Tableau,
    nodes: Vec<HeldComponent>,
    /// Node and kind of every variable.
    owners: Vec<(usize, usize)>,
    force: f64,
    length: f64,
}

/// Start of a node's variables.
#[derive(Debug, Clone, Copy)]
enum HeldComponent {
    /// No contact force is possible, or there is no surface: its motions are unconstrained.
    No,
    /// It has F_n and the gap.
    Smooth(usize),
    /// It has all eight.
    Rough(usize),
}

impl Copositive {
    /// The problem with all nodes free, at start `number`, which is less than [`STARTS`]. `None` if the bodies are unsupported
    /// without contact, or memory is insufficient.
    pub fn new(problem: &InterfaceProblem, number: usize) -> Option<Self> {
        let (relation, count) = (&problem.relation, problem.relation.count());
        let rough = |k: usize| {
            let node = &problem.nodes[k];
            node.moves() == [true; 2] && !node.friction.is_smooth()
        };
        let rows = count + 2 * (0..problem.nodes.len()).filter(|&k| rough(k)).count();
        let (force, length) = (positive(problem.force), positive(problem.length));
        let mut path = Copositive {
            tableau: Tableau::new(rows),
            nodes: Vec::with_capacity(problem.nodes.len()),
            owners: Vec::new(),
            force,
            length,
        };
        // (I + R / k) F − R v = start + (I + R / k) F_0, column by column.
        let columns = Columns { relation, force };
        let mut rhs = columns.start(rows);
        let mut basis = Vec::with_capacity(rows);
        let mut extra = count;
        for (place, node) in problem.nodes.iter().enumerate() {
            let (n, t) = (2 * place, 2 * place + 1);
            columns.add_force(n, node.state.f_n, &mut rhs);
            columns.add_force(t, node.state.f_t, &mut rhs);
            let first = path.owners.len();
            let presses = node.kinematics.filter(|over| over.moves[0]);
            if let Some(over) = presses {
                columns.add_motion(n, -(over.gap - node.prescribed[0]), &mut rhs);
                path.add(place, FORCE, |column| columns.add_force(n, force, column));
                path.add(place, GAP, |column| columns.add_motion(n, -length, column));
                basis.push(first + GAP);
            } else {
                basis.push(path.loose(place, |column| columns.add_motion(n, length, column)));
            }
            if !rough(place) {
                basis.push(path.loose(place, |column| columns.add_motion(t, length, column)));
                path.nodes.push(match presses {
                    Some(_) => HeldComponent::Smooth(first),
                    None => HeldComponent::No,
                });
                continue;
            }
            let (coefficient, cohesion) = (node.friction.coefficient(), node.friction.cohesion);
            let slipped = node.state.slipped(&problem.settings) + node.prescribed[1];
            columns.add_motion(t, slipped, &mut rhs);
            // slip = λ − (λ − slip); the two additional rows state that the two remainders sum to 2 λ, and define `room`.
            let (sum, room) = (extra, extra + 1);
            extra += 2;
            path.tableau.column(first + FORCE)[room] = -coefficient;
            path.add(place, PLUS, |column| {
                columns.add_force(t, force, column);
                column[room] = 1.0;
            });
            path.add(place, PLUS_REST, |column| {
                columns.add_motion(t, -length, column);
                column[sum] = 1.0;
            });
            path.add(place, MINUS, |column| {
                columns.add_force(t, -force, column);
                column[room] = 1.0;
            });
            path.add(place, MINUS_REST, |column| column[sum] = 1.0);
            path.add(place, SPEED, |column| {
                columns.add_motion(t, length, column);
                column[sum] = -2.0;
            });
            path.add(place, ROOM, |column| column[room] = 1.0);
            rhs[room] = cohesion / force;
            basis.extend([first + PLUS_REST, first + MINUS_REST, first + ROOM]);
            path.nodes.push(HeldComponent::Rough(first));
        }
        let shift = SHIFT * SHIFT_FALLS.powi(number as i32);
        let begin = PathStart {
            cover: &|row| match number {
                0 => 1.0,
                _ => 0.2 + 0.8 * spread(row, number),
            },
            shift: Some(&|row| shift * (0.5 + 0.5 * spread(row, number))),
            pivots: PIVOTS,
        };
        path.tableau.start(basis, rhs, begin)?;
        Some(path)
    }

    /// Adds a variable that has a complement.
    fn add(&mut self, place: usize, kind: usize, fill: impl FnOnce(&mut [f64])) {
        let number = self.owners.len();
        self.owners.push((place, kind));
        // In each complementary pair, the first variable has an even number within its node.
        let partner = if kind.is_multiple_of(2) {
            number + 1
        } else {
            number - 1
        };
        self.tableau.add(partner, fill);
    }

    fn loose(&mut self, place: usize, fill: impl FnOnce(&mut [f64])) -> usize {
        let number = self.owners.len();
        self.owners.push((place, ROOM + 1));
        self.tableau.add(number, fill);
        number
    }

    /// Result of the path. `None` while it continues.
    pub fn ended(&self) -> Option<PathEnd> {
        match self.tableau.ended() {
            Some(PathEnd::Ray) if self.tableau.cover() <= NEARLY => Some(PathEnd::Solved),
            other => other,
        }
    }

    /// The node of the last pivot, and the quantity that reached its bound. `None` if that was the covering variable.
    pub fn bound(&self) -> Option<(usize, TestedQuantity)> {
        let (place, kind) = self.owners[self.tableau.left()?];
        let tested = match kind {
            FORCE => TestedQuantity::NormalForce,
            GAP => TestedQuantity::Gap,
            PLUS | MINUS | ROOM => TestedQuantity::ShearForce,
            _ => TestedQuantity::Slip,
        };
        Some((place, tested))
    }

    /// Mode of a node in the current basis. A node whose friction has not reached a bound sticks.
    pub fn assumed(&self, place: usize) -> AssumedMode {
        let first = match self.nodes[place] {
            HeldComponent::No => return AssumedMode::Free,
            HeldComponent::Smooth(first) if self.tableau.is_basic(first + FORCE) => {
                return AssumedMode::Plus;
            }
            HeldComponent::Smooth(_) => return AssumedMode::Free,
            HeldComponent::Rough(first) => first,
        };
        let basic = |kind| self.tableau.is_basic(first + kind);
        if !basic(FORCE) {
            AssumedMode::Free
        } else if basic(ROOM) || !basic(SPEED) {
            AssumedMode::Fixed
        } else if basic(MINUS) || (!basic(PLUS) && !basic(MINUS_REST)) {
            AssumedMode::Minus
        } else {
            AssumedMode::Plus
        }
    }

    /// F_n, F_t, gap and slip of a node in the current, relaxed solution; the gap of a touching node is 0.
    pub fn numbers(&self, place: usize) -> [f64; 4] {
        let of = |variable: usize| self.tableau.of(variable);
        match self.nodes[place] {
            HeldComponent::No => [0.0, 0.0, f64::INFINITY, 0.0],
            HeldComponent::Smooth(first) => [
                self.force * of(first + FORCE),
                0.0,
                self.length * of(first + GAP),
                0.0,
            ],
            HeldComponent::Rough(first) => [
                self.force * of(first + FORCE),
                self.force * (of(first + PLUS) - of(first + MINUS)),
                self.length * of(first + GAP),
                self.length * (of(first + SPEED) - of(first + PLUS_REST)),
            ],
        }
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
