//! The laws of contact, friction and equilibrium, and their violations.
//!
//! All amounts are relative to the scene's length or force ([`Scales`]). Lengths and forces have separate tolerances, because
//! high stiffness reduces the accuracy of forces but not of positions.

use serde::{Deserialize, Serialize};

/// Units and tolerances of violations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Unit of lengths: the size of the scene.
    pub length: f64,
    /// Unit of forces: the magnitude of the acting forces.
    pub force: f64,
    /// Tolerance of lengths, relative to `length`.
    pub lengths: f64,
    /// Tolerance of forces, relative to `force`.
    pub forces: f64,
}

impl Scales {
    /// Length within which two positions are equal.
    pub fn near(&self) -> f64 {
        self.lengths * self.length
    }

    /// Tolerance of a law.
    pub fn allowed(&self, law: JudgedLaw) -> f64 {
        match law {
            JudgedLaw::Penetration | JudgedLaw::Gap | JudgedLaw::Penalty | JudgedLaw::Tied => {
                self.lengths
            }
            _ => self.forces,
        }
    }
}

crate::words! {
    /// A law.
    #[derive(Hash, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum JudgedLaw, name {
        /// g >= 0: no slave node is inside a master (length).
        Penetration "penetration",
        /// A force acts only where nodes touch: F = 0 or g = 0 (length).
        Gap "gap",
        /// F_n >= 0 (force).
        Tension "tension",
        /// |F_t| <= tan φ F_n + c (force).
        Cone "cone",
        /// Friction opposes a net slip at its limit. The amount is the force missing to that limit.
        Slip "slip",
        /// Friction opposes the slip of a node that was open before, wherever it touched (force).
        Touch "touch",
        /// The forces on every node sum to zero (force).
        Balance "balance",
        /// Forces and moments on the bodies as a whole, including reactions, sum to zero (force; moments are divided by the length).
        Moments "moments",
        /// Friction dissipates: mean tangential force of both states times slip <= 0 (force times length). Reported but not required,
        /// because a node that reverses within an increment may violate it.
        Work "work",
        /// The penetration of a bond is proportional to the normal force: g + c_n F_n = 0 if a force acts (length).
        Penalty "penalty",
        /// A tied node stays at its point of the surface (length).
        Tied "tied",
        /// Friction at its limit opposes slip beyond the elastic slip of the bond, c_t times the change of −F_t. The amount is the
        /// force missing to that limit.
        Stick "stick",
    }
}

impl JudgedLaw {
    /// The laws that apply to every accepted state.
    pub const ALL: [JudgedLaw; 8] = [
        JudgedLaw::Penetration,
        JudgedLaw::Gap,
        JudgedLaw::Tension,
        JudgedLaw::Cone,
        JudgedLaw::Slip,
        JudgedLaw::Touch,
        JudgedLaw::Balance,
        JudgedLaw::Moments,
    ];

    /// The laws of bonds other than hard contact.
    pub const OF_BONDS: [JudgedLaw; 3] = [JudgedLaw::Penalty, JudgedLaw::Tied, JudgedLaw::Stick];
}

/// Violation of one law at its worst place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The law.
    pub law: JudgedLaw,
    /// Slave number. `None` if the finding concerns the whole scene, or a node that is not a slave.
    pub slave: Option<usize>,
    /// Amount of the violation, relative to [`Scales::length`] or [`Scales::force`]; infinite if a force acts where no contact is
    /// possible.
    pub amount: f64,
    /// The tolerance of `amount`.
    pub allowed: f64,
    /// Gap, forces and slip of the node; zeros if there is no slave.
    pub numbers: JudgedNumbers,
}

/// Data of a node.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JudgedNumbers {
    /// Distance from the surface (length); negative is penetration.
    pub gap: f64,
    /// Force on the node along the normal; compression positive.
    pub f_n: f64,
    /// Force on the node along the tangent t.
    pub f_t: f64,
    /// Friction bound, tan φ F_n + c (eqn 20).
    pub limit: f64,
    /// Motion of the node's closest point along t since the last accepted state (length).
    pub slip: f64,
    /// Angle between friction and slip in space (radians); `None` in the plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation: Option<f64>,
}

/// Findings for a state; initially empty.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Verdict {
    /// The worst place for every law, in the order of [`JudgedLaw::ALL`]. `None` if the law did not apply.
    pub worst: [Option<Finding>; 8],
    /// The same for [`JudgedLaw::OF_BONDS`].
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub bonds: [Option<Finding>; 3],
    /// The node at which friction did the most positive work. `None` if there is no such node.
    pub work: Option<Finding>,
}

fn is_nothing(worst: &[Option<Finding>; 3]) -> bool {
    worst.iter().all(Option::is_none)
}

impl Verdict {
    /// Records `finding` if it is worse than the previous one for its law.
    pub fn add(&mut self, finding: Finding) {
        let worst = match finding.law {
            JudgedLaw::Work => &mut self.work,
            JudgedLaw::Penalty => &mut self.bonds[0],
            JudgedLaw::Tied => &mut self.bonds[1],
            JudgedLaw::Stick => &mut self.bonds[2],
            law => &mut self.worst[law as usize],
        };
        if worst.is_none_or(|w| finding.amount > w.amount || finding.amount.is_nan()) {
            *worst = Some(finding);
        }
    }

    /// The worst place for a law. `None` if it did not apply.
    pub fn of(&self, law: JudgedLaw) -> Option<Finding> {
        self.findings()
            .chain(&self.work)
            .find(|found| found.law == law)
            .copied()
    }

    /// The worst place for every law that applied, with the laws of bonds last.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.worst.iter().chain(&self.bonds).flatten()
    }

    /// The finding with the largest amount relative to its tolerance. `None` if no law applied.
    pub fn largest(&self) -> Option<Finding> {
        self.findings().copied().reduce(|worst, next| {
            if next.times() > worst.times() {
                next
            } else {
                worst
            }
        })
    }

    /// The findings whose amount exceeds its tolerance.
    pub fn broken(&self) -> impl Iterator<Item = &Finding> {
        self.findings().filter(|found| found.is_broken())
    }
}

impl Finding {
    /// Whether the amount exceeds its tolerance, or is not a number.
    pub fn is_broken(&self) -> bool {
        self.times().is_nan() || self.times() > 1.0
    }

    /// Amount divided by tolerance; a law is violated above 1.
    pub fn times(&self) -> f64 {
        self.amount / self.allowed
    }
}
