//! Table 2: the next mode of a slave node, and the reason.

use crate::Mode;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as NoName, StringDeserializer};
use serde::{Deserialize, Deserializer, Serialize};

/// The cell of Table 2 that fired (row: mode before; column: mode after).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// F_n > 0 and |F_t| < |T_max|.
    FixedStays,
    /// F_n > 0 and |F_t| > |T_max|.
    FixedSlides,
    /// Prescribed motions drag the node over a surface that does not move either: no force can hold it.
    FixedDragged,
    /// F_n <= 0.
    FixedOpens,
    /// F_n > 0 and T_max · slip < 0.
    SlidingSticks,
    /// F_n > 0 and T_max · slip > 0.
    SlidingStays,
    /// F_n <= 0.
    SlidingOpens,
    /// As [`Rule::SlidingStays`], but it passes the end of its side and continues on the next one.
    SlidingPasses,
    /// In a corner: F_n > 0 and |F_t| < |T_max|, with the T_max of both sides ([`crate::contact::corner`]).
    CornerStays,
    /// In a corner: F_n > 0 and |F_t| > |T_max|; the node slides out along one of the sides.
    CornerSlides,
    /// In a corner: F_n <= 0.
    CornerOpens,
    /// In a corner, at the end of a major iteration: the node slid there, and F_t against that slip is below the least friction
    /// ([`crate::contact::corner::least_friction`]). The node slides again on the side that it came from.
    CornerReleases,
    /// g < 0, rough interface.
    FreeSticks,
    /// g < 0, smooth interface: straight to sliding.
    FreeSlides,
    /// g < 0, rough interface, with a strategy in which friction opposes the motion from the start.
    FreeEnters,
    /// g > 0.
    FreeStays,
    /// The node's projection lies beyond an end of every surface: no contact is possible.
    OffSurface,
    /// The node is tied to its surface: it is always fixed.
    Tied,
    /// The user holds the mode; Table 2 is overridden.
    Held,
    /// One change at a time: another node changes first.
    Waits,
    /// Newton: F_n − k g <= 0.
    NewtonOpens,
    /// Newton: F_n − k g > 0, and |F_t + k slip| within the resulting limit.
    NewtonSticks,
    /// Newton: F_n − k g > 0, and |F_t + k slip| beyond the resulting limit.
    NewtonSlides,
    /// A step of Lemke's pivoting, on the problem relaxed by the covering variable.
    Pivots,
    /// Gauss-Seidel sweeps: Coulomb's law at this node with all other forces frozen.
    Sweeps,
    /// A state found to be consistent by pivoting, sweeps, or the census.
    Found,
    /// The forces of the Gauss-Seidel sweeps, which obey Coulomb's law within a tolerance, are accepted without a solve.
    Settled,
    /// An attached solver decided by its own rules.
    Theirs,
    /// A strategy outside this package decided; the text is its reason ([`crate::step::Stepper::with_strategy`]).
    #[serde(skip_deserializing)]
    Custom(Reason),
}

crate::words! {
    Rule, name:
    FixedStays "fixed-stays",
    FixedSlides "fixed-slides",
    FixedDragged "fixed-dragged",
    FixedOpens "fixed-opens",
    SlidingSticks "sliding-sticks",
    SlidingStays "sliding-stays",
    SlidingOpens "sliding-opens",
    SlidingPasses "sliding-passes",
    CornerStays "corner-stays",
    CornerSlides "corner-slides",
    CornerOpens "corner-opens",
    CornerReleases "corner-releases",
    FreeSticks "free-sticks",
    FreeSlides "free-slides",
    FreeStays "free-stays",
    OffSurface "off-surface",
    Tied "tied",
    Held "held",
    FreeEnters "free-enters",
    Waits "waits",
    NewtonOpens "newton-opens",
    NewtonSticks "newton-sticks",
    NewtonSlides "newton-slides",
    Pivots "pivots",
    Sweeps "sweeps",
    Found "found",
    Settled "settled",
    Theirs "theirs",
    Custom(..) "custom",
}

/// A sentence for a decision, such as "Fixed → sliding: a fixed node never opens at once."
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
pub struct Reason(pub &'static str);

/// What an inequality of Table 2 compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TestedQuantity {
    /// F_n against 0 (force).
    NormalForce,
    /// |F_t| against |T_max| (force).
    ShearForce,
    /// sgn(T_max) · slip against 0 (length).
    Slip,
    /// F_t, positive against the slip into a corner, against the least friction there (force).
    LeastFriction,
    /// Motion along the surface against the distance to the end of the side (length).
    Room,
    /// g against 0 (length).
    Gap,
    /// F_n − k g against 0, for the interface's spring stiffness k (force).
    Pressure,
    /// |F_t + k slip| against tan φ (F_n − k g) + c (force).
    Drag,
    /// The covering variable of Lemke's pivoting against 0: the remaining relaxation of the problem (relative).
    Cover,
    /// The change of the forces in the last sweep of Gauss-Seidel against 0 (relative).
    Change,
    /// The natural map of the forces of Gauss-Seidel against 0 (relative; [`crate::interface::sweep`]).
    Error,
    /// A comparison by an attached solver's own rules (in its unit).
    Own,
}

/// One inequality of Table 2 with its numbers. Numbers that an attached solver does not report are infinite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// The compared quantities.
    #[serde(deserialize_with = "tested")]
    pub tested: TestedQuantity,
    /// Left-hand side.
    #[serde(default = "infinite", deserialize_with = "or_infinite")]
    pub value: f64,
    /// Right-hand side.
    #[serde(default = "infinite", deserialize_with = "or_infinite")]
    pub bound: f64,
    /// Signed distance from switching: positive keeps the mode, negative changes it; force or length.
    #[serde(default = "infinite", deserialize_with = "or_infinite")]
    pub margin: f64,
    /// Whether |margin| is within the tie tolerance.
    #[serde(default)]
    pub tie: bool,
}

/// Reads a name; an unknown one means a rule of the solver.
fn tested<'de, D: Deserializer<'de>>(from: D) -> Result<TestedQuantity, D::Error> {
    let name: StringDeserializer<NoName> = String::deserialize(from)?.into_deserializer();
    Ok(TestedQuantity::deserialize(name).unwrap_or(TestedQuantity::Own))
}

fn infinite() -> f64 {
    f64::INFINITY
}

/// Reads `null` as infinity, which JSON does not have.
fn or_infinite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

/// Table 2's decision for one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// Mode of the checked solve.
    pub before: Mode,
    /// Mode of the next solve.
    pub next: Mode,
    /// The cell that fired.
    pub rule: Rule,
    /// The tested inequalities in Table 2's order (F_n first); one or two.
    pub tests: [Option<Test>; 2],
    /// The mode that Table 2 requires; differs from `next` only if the user holds the mode.
    pub wanted: Mode,
}

/// The numbers of one node that Table 2 uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers {
    /// Mode of the checked solve.
    pub mode: Mode,
    /// Gap (length); negative is penetration.
    pub gap: f64,
    /// Total normal force; compression positive.
    pub f_n: f64,
    /// Total tangential force along t.
    pub f_t: f64,
    /// T_max of this solve, signed.
    pub t_max: f64,
    /// Accumulated slip u_tS* − u_tS (length).
    pub slip: f64,
    /// How the node enters contact.
    pub entry: Entry,
}

/// How a free node enters contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    /// With friction, by Table 2: sticks.
    Fixed,
    /// Without friction, by Table 2: slides.
    Smooth,
    /// With friction, by a strategy that lets it slide.
    Sliding,
}

/// Tolerances for ties in Table 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ties {
    /// Forces with a smaller difference are tied.
    pub force: f64,
    /// Lengths with a smaller difference are tied.
    pub length: f64,
    /// Whether ties keep the mode; otherwise the inequalities hold as printed, and the tolerances are not used.
    pub keep: bool,
}

/// Table 2: the next mode for a node's numbers.
pub fn decide(numbers: &Numbers, ties: &Ties) -> Decision {
    let opens = ties.test(
        TestedQuantity::NormalForce,
        numbers.f_n,
        0.0,
        numbers.f_n,
        ties.force,
    );
    let (next, rule, tests) = match numbers.mode {
        Mode::Free => {
            let test = ties.test(
                TestedQuantity::Gap,
                numbers.gap,
                0.0,
                numbers.gap,
                ties.length,
            );
            let (next, rule) = match (ties.switches(&test, false), numbers.entry) {
                (false, _) => (Mode::Free, Rule::FreeStays),
                (true, Entry::Fixed) => (Mode::Fixed, Rule::FreeSticks),
                (true, Entry::Smooth) => (Mode::Sliding, Rule::FreeSlides),
                (true, Entry::Sliding) => (Mode::Sliding, Rule::FreeEnters),
            };
            (next, rule, [Some(test), None])
        }
        Mode::Fixed if ties.switches(&opens, true) => {
            (Mode::Free, Rule::FixedOpens, [Some(opens), None])
        }
        Mode::Sliding if ties.switches(&opens, true) => {
            (Mode::Free, Rule::SlidingOpens, [Some(opens), None])
        }
        Mode::Fixed => {
            let (shear, limit) = (numbers.f_t.abs(), numbers.t_max.abs());
            let test = ties.test(
                TestedQuantity::ShearForce,
                shear,
                limit,
                limit - shear,
                ties.force,
            );
            if ties.switches(&test, false) {
                (Mode::Sliding, Rule::FixedSlides, [Some(opens), Some(test)])
            } else {
                (Mode::Fixed, Rule::FixedStays, [Some(opens), Some(test)])
            }
        }
        Mode::Sliding => {
            let slip = if numbers.t_max == 0.0 {
                0.0
            } else {
                numbers.t_max.signum() * numbers.slip
            };
            let test = ties.test(TestedQuantity::Slip, slip, 0.0, slip, ties.length);
            if ties.switches(&test, false) {
                (Mode::Fixed, Rule::SlidingSticks, [Some(opens), Some(test)])
            } else {
                (Mode::Sliding, Rule::SlidingStays, [Some(opens), Some(test)])
            }
        }
    };
    Decision {
        before: numbers.mode,
        next,
        rule,
        tests,
        wanted: next,
    }
}

impl Ties {
    /// An inequality with its numbers; `margin` is its distance from switching, and `tolerance` the tie tolerance (force or
    /// length, as `tested`).
    pub fn test(
        &self,
        tested: TestedQuantity,
        value: f64,
        bound: f64,
        margin: f64,
        tolerance: f64,
    ) -> Test {
        let tie = if self.keep {
            margin.abs() <= tolerance
        } else {
            margin == 0.0
        };
        Test {
            tested,
            value,
            bound,
            margin,
            tie,
        }
    }

    /// Whether a test changes the mode; `at_zero` is the printed table's answer for an exact tie.
    fn switches(&self, test: &Test, at_zero: bool) -> bool {
        if test.tie {
            !self.keep && at_zero
        } else {
            test.margin < 0.0
        }
    }
}

impl Decision {
    /// The deciding inequality: the one that changed the mode, or else the last one tested.
    pub fn decisive(&self) -> Option<&Test> {
        self.tests[1].as_ref().or(self.tests[0].as_ref())
    }

    /// Signed distance of the deciding inequality from switching (force or length); positive if the mode was kept.
    pub fn margin(&self) -> f64 {
        self.decisive().map_or(f64::INFINITY, |t| t.margin)
    }

    /// Replaces the decision for a fixed node with the slip `slip` (length): its motion is prescribed and no unknown can stop it,
    /// so it slides.
    pub fn dragged(self, slip: f64) -> Self {
        let test = Test {
            tested: TestedQuantity::Slip,
            value: slip.abs(),
            bound: 0.0,
            margin: -slip.abs(),
            tie: false,
        };
        Decision {
            next: Mode::Sliding,
            wanted: Mode::Sliding,
            rule: Rule::FixedDragged,
            tests: [self.tests[0], Some(test)],
            ..self
        }
    }

    /// The decision for a tied node.
    pub fn tied() -> Self {
        Decision {
            before: Mode::Fixed,
            next: Mode::Fixed,
            rule: Rule::Tied,
            tests: [None; 2],
            wanted: Mode::Fixed,
        }
    }

    /// The decision for a fixed node that is held in a corner.
    pub fn in_corner(self) -> Self {
        let rule = match self.rule {
            Rule::FixedStays => Rule::CornerStays,
            Rule::FixedSlides => Rule::CornerSlides,
            Rule::FixedOpens => Rule::CornerOpens,
            other => other,
        };
        Decision { rule, ..self }
    }

    /// Replaces the decision for a node that slid into a corner and is released from it at the end of the major iteration, because
    /// the friction `opposing` the slip (force) is below the `least` friction.
    pub fn released(self, opposing: f64, least: f64) -> Self {
        let test = Test {
            tested: TestedQuantity::LeastFriction,
            value: opposing,
            bound: least,
            margin: opposing - least,
            tie: false,
        };
        Decision {
            next: Mode::Sliding,
            wanted: Mode::Sliding,
            rule: Rule::CornerReleases,
            tests: [self.tests[0], Some(test)],
            ..self
        }
    }

    /// Replaces the decision for a node that moves by `way` (length, not negative) along its side, where the distance `room`
    /// remains to its end.
    pub fn with_room(self, way: f64, room: f64, ties: &Ties) -> Self {
        if self.rule != Rule::SlidingStays || way <= room {
            return self;
        }
        let test = ties.test(TestedQuantity::Room, way, room, room - way, ties.length);
        Decision {
            rule: Rule::SlidingPasses,
            tests: [self.tests[0], Some(test)],
            ..self
        }
    }

    /// Whether the mode changes.
    pub fn changes(&self) -> bool {
        self.before != self.next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIES: Ties = Ties {
        force: 1e-10,
        length: 1e-10,
        keep: true,
    };
    const PRINTED: Ties = Ties {
        keep: false,
        ..TIES
    };

    fn numbers(mode: Mode) -> Numbers {
        Numbers {
            mode,
            gap: 0.1,
            f_n: 2.0,
            f_t: -0.5,
            t_max: -1.0,
            slip: -0.01,
            entry: Entry::Fixed,
        }
    }

    fn verdict(n: Numbers, ties: &Ties) -> (Mode, Rule) {
        let d = decide(&n, ties);
        (d.next, d.rule)
    }

    #[test]
    fn every_cell_of_table_2_fires_on_its_inequality() {
        use Mode::*;
        let (x, s, f) = (numbers(Fixed), numbers(Sliding), numbers(Free));
        let cases = [
            (x, Fixed, Rule::FixedStays),
            (Numbers { f_t: -1.5, ..x }, Sliding, Rule::FixedSlides),
            (Numbers { f_n: -0.1, ..x }, Free, Rule::FixedOpens),
            (Numbers { slip: 0.01, ..s }, Fixed, Rule::SlidingSticks),
            (s, Sliding, Rule::SlidingStays),
            (Numbers { f_n: -0.1, ..s }, Free, Rule::SlidingOpens),
            (Numbers { gap: -0.1, ..f }, Fixed, Rule::FreeSticks),
            (
                Numbers {
                    gap: -0.1,
                    entry: Entry::Smooth,
                    ..f
                },
                Sliding,
                Rule::FreeSlides,
            ),
            (f, Free, Rule::FreeStays),
        ];
        for (n, next, rule) in cases {
            assert_eq!(verdict(n, &TIES), (next, rule));
            assert_eq!(verdict(n, &PRINTED), (next, rule));
            let d = decide(&n, &TIES);
            assert_eq!(
                d.changes(),
                d.margin() < 0.0,
                "the margin's sign tells the change: {d:?}"
            );
        }
    }

    #[test]
    fn ties_keep_the_mode_and_the_printed_table_opens_without_force() {
        let stuck = Numbers {
            f_n: 1e-12,
            f_t: 0.0,
            t_max: 0.0,
            ..numbers(Mode::Fixed)
        };
        assert_eq!(verdict(stuck, &TIES).0, Mode::Fixed);
        let unloaded = Numbers { f_n: 0.0, ..stuck };
        assert_eq!(verdict(unloaded, &TIES).0, Mode::Fixed);
        assert_eq!(verdict(unloaded, &PRINTED).0, Mode::Free);
        let touching = Numbers {
            gap: 0.0,
            ..numbers(Mode::Free)
        };
        assert_eq!(verdict(touching, &TIES).0, Mode::Free);
        assert_eq!(verdict(touching, &PRINTED).0, Mode::Free);
    }
}
