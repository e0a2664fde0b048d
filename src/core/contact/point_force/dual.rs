//! Dual numbers (forward-mode differentiation), for geometry whose second derivatives are long in closed form.

use crate::fem::lagrange::MAX_NODES;
use std::ops::{Add, Div, Mul, Sub};

/// Maximum number of degrees of freedom of a slave node and the nodes of its master element.
pub const DOFS: usize = 2 * (MAX_NODES + 1);
/// Number of variables of a dual number: the degrees of freedom, the two force components, and the slope Σ ∂c_j/∂ξ F_j due to the
/// other forces on the element.
pub const VARIABLES: usize = DOFS + 3;

/// A value with its derivatives with respect to all variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    pub value: f64,
    pub by: [f64; VARIABLES],
}

impl Dual {
    /// A number with zero derivatives.
    pub fn constant(value: f64) -> Dual {
        Dual {
            value,
            by: [0.0; VARIABLES],
        }
    }

    /// Variable `number` with this value: its derivative with respect to itself is 1.
    pub fn variable(value: f64, number: usize) -> Dual {
        let mut variable = Dual::constant(value);
        variable.by[number] = 1.0;
        variable
    }

    /// Chain rule: a function of this number, given the function's value and derivative at it.
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

/// A vector in the plane.
pub type Vector = [Dual; 2];

/// a · b.
pub fn dot(a: Vector, b: Vector) -> Dual {
    a[0] * b[0] + a[1] * b[1]
}
