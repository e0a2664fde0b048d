//! The laws of contact, friction and balance, and what is found against them.
//!
//! All amounts are relative to the scene's length or force ([`Scales`]). Lengths and forces have a tolerance each: where
//! stiffnesses leave forces less exact, places stay as exact as ever.

use serde::{Deserialize, Serialize};

/// What amounts are relative to, and how large they may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Unit of lengths: the size of the scene.
    pub length: f64,
    /// Unit of forces: the size of the forces at work.
    pub force: f64,
    /// Tolerance of lengths, relative to `length`.
    pub lengths: f64,
    /// Tolerance of forces, relative to `force`.
    pub forces: f64,
}

impl Scales {
    /// Length up to which two places are the same.
    pub fn near(&self) -> f64 {
        self.lengths * self.length
    }

    /// How large an amount against a law may be.
    pub fn allowed(&self, law: Law) -> f64 {
        match law {
            Law::Penetration | Law::Gap | Law::Penalty | Law::Tied => self.lengths,
            _ => self.forces,
        }
    }
}

/// A law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// g >= 0: no slave node is inside a master (length).
    Penetration,
    /// A force acts only where nodes touch: F = 0 or g = 0 (length).
    Gap,
    /// F_n >= 0 (force).
    Tension,
    /// |F_t| <= tan φ F_n + c (force).
    Cone,
    /// A net slip is opposed by friction at its limit. The amount is the force that friction lacks to that limit.
    Slip,
    /// Friction opposes the slip of a node that was open before, wherever it touched (force).
    Touch,
    /// The forces on every node add up to nothing (force).
    Balance,
    /// Forces and moments on the bodies as a whole, with the reactions, add up to nothing (force; a moment over the length).
    Moments,
    /// Friction dissipates: mean tangential force of both states times slip <= 0 (force times length). This is reported and
    /// not required, since a node that reverses within an increment may break it.
    Work,
    /// A bond gives way in proportion to the normal force: g + c_n F_n = 0 where a force acts (length).
    Penalty,
    /// A tied node stays at its point of the surface (length).
    Tied,
    /// What a node slips beyond the elastic slip of its bond, c_t times the change of −F_t, is opposed by friction at its limit. The
    /// amount is the force that friction lacks to that limit.
    Stick,
}

impl Law {
    /// The laws that every accepted state obeys.
    pub const ALL: [Law; 8] = [
        Law::Penetration,
        Law::Gap,
        Law::Tension,
        Law::Cone,
        Law::Slip,
        Law::Touch,
        Law::Balance,
        Law::Moments,
    ];

    /// The laws of bonds that are not hard, which only scenes with such bonds have.
    pub const OF_BONDS: [Law; 3] = [Law::Penalty, Law::Tied, Law::Stick];
}

crate::words! {
    Law, name:
    Penetration "penetration",
    Gap "gap",
    Tension "tension",
    Cone "cone",
    Slip "slip",
    Touch "touch",
    Balance "balance",
    Moments "moments",
    Work "work",
    Penalty "penalty",
    Tied "tied",
    Stick "stick",
}

/// How far a state is from one law, at its worst place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The law.
    pub law: Law,
    /// Slave number. `None` if the finding is about the scene as a whole, or about a node that is not a slave.
    pub slave: Option<usize>,
    /// How far the state is from the law, relative to [`Scales::length`] or [`Scales::force`]; infinite where a force has
    /// nothing to act on.
    pub amount: f64,
    /// The tolerance of `amount`.
    pub allowed: f64,
    /// Gap, forces and slip of the node; zeros if there is no slave.
    pub numbers: Numbers,
}

/// What was seen of a node.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Numbers {
    /// Distance from the surface (length), negative inside.
    pub gap: f64,
    /// Force on the node along the normal; compression positive.
    pub f_n: f64,
    /// Force on the node along the tangent t.
    pub f_t: f64,
    /// Friction bound, tan φ F_n + c (eqn 20).
    pub limit: f64,
    /// Way of the node's foot along t since the last accepted state (length).
    pub slip: f64,
}

/// What was found of a state; empty before anything is judged.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Verdict {
    /// The worst place for every law, in the order of [`Law::ALL`]. `None` if the law applied nowhere.
    pub worst: [Option<Finding>; 8],
    /// The same for [`Law::OF_BONDS`].
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub bonds: [Option<Finding>; 3],
    /// The node at which friction did the most positive work. `None` if there is no such node.
    pub work: Option<Finding>,
}

fn is_nothing(worst: &[Option<Finding>; 3]) -> bool {
    worst.iter().all(Option::is_none)
}

impl Verdict {
    /// Keeps `finding` if it is worse than what is known of its law.
    pub fn add(&mut self, finding: Finding) {
        let worst = match finding.law {
            Law::Work => &mut self.work,
            Law::Penalty => &mut self.bonds[0],
            Law::Tied => &mut self.bonds[1],
            Law::Stick => &mut self.bonds[2],
            law => &mut self.worst[law as usize],
        };
        if worst.is_none_or(|w| finding.amount > w.amount || finding.amount.is_nan()) {
            *worst = Some(finding);
        }
    }

    /// The worst place for a law. `None` if it applied nowhere.
    pub fn of(&self, law: Law) -> Option<Finding> {
        let mut all = self.findings().chain(&self.work);
        all.find(|found| found.law == law).copied()
    }

    /// The worst place for every law that applied, the laws of bonds last.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.worst.iter().chain(&self.bonds).flatten()
    }

    /// The finding with the largest amount relative to its tolerance. `None` if no law applied anywhere.
    pub fn largest(&self) -> Option<Finding> {
        let all = self.findings().copied();
        all.reduce(|worst, next| {
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

    /// Amount over tolerance; more than 1 is broken.
    pub fn times(&self) -> f64 {
        self.amount / self.allowed
    }
}
