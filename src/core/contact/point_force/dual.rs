//! Numbers that carry their derivatives along, for a geometry whose second derivatives are long in closed form.

use crate::fem::lagrange::MAX_NODES;
use std::ops::{Add, Div, Mul, Sub};

/// Degrees of freedom of a slave node and of the nodes of its master element.
pub const DOFS: usize = 2 * (MAX_NODES + 1);
/// Variables of a dual number: those, the two components of the force, and what other forces on the element turn.
pub const VARIABLES: usize = DOFS + 3;

/// A number with its derivatives by all variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    pub value: f64,
    pub by: [f64; VARIABLES],
}

impl Dual {
    /// One that depends on no variable.
    pub fn constant(value: f64) -> Dual {
        Dual {
            value,
            by: [0.0; VARIABLES],
        }
    }

    /// A variable itself.
    pub fn variable(value: f64, number: usize) -> Dual {
        let mut variable = Dual::constant(value);
        variable.by[number] = 1.0;
        variable
    }

    /// A function of this number, from its value and its derivative there.
    pub fn then(&self, value: f64, slope: f64) -> Dual {
        Dual {
            value,
            by: self.by.map(|by| slope * by),
        }
    }

    pub fn sqrt(&self) -> Dual {
        let root = self.value.sqrt();
        self.then(root, 0.5 / root)
    }

    fn join(self, other: Dual, value: f64, [own, its]: [f64; 2]) -> Dual {
        let mut by = self.by;
        for (by, other) in by.iter_mut().zip(other.by) {
            *by = own * *by + its * other;
        }
        Dual { value, by }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, other: Dual) -> Dual {
        self.join(other, self.value + other.value, [1.0, 1.0])
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, other: Dual) -> Dual {
        self.join(other, self.value - other.value, [1.0, -1.0])
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        self.join(other, self.value * other.value, [other.value, self.value])
    }
}

impl Div for Dual {
    type Output = Dual;
    fn div(self, other: Dual) -> Dual {
        let value = self.value / other.value;
        self.join(other, value, [1.0 / other.value, -value / other.value])
    }
}

/// A vector of two.
pub type Vector = [Dual; 2];

/// a · b.
pub fn dot(a: Vector, b: Vector) -> Dual {
    a[0] * b[0] + a[1] * b[1]
}
