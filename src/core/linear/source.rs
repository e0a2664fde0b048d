//! The seam between the stepper and what deforms: bodies of our own, constant matrices, or another code.
//!
//! A major iteration freezes geometry and stiffness. What it needs from then on is how the interface answers (eqn 6):
//! the response of the forces to the motions, the gap and the frame of every contact, and what is prescribed. When its
//! minor iterations have settled, the source takes the forces back: it moves its bodies, follows the slave nodes over
//! their surfaces, and linearises anew. Whoever can do this can be stepped.

use crate::contact::laws::{Finding, Law, Numbers, Scales, Verdict};
use crate::contact::projection::SurfacePoint;
use crate::contact::state::{ContactState, in_mode, largest_drift};
use crate::fem::deformation::Deformation;
use crate::interface::kinematics::{NodeIncrement, NodeKinematics};
use crate::interface::minor_history::Input;
use crate::interface::problem::{InterfaceProblem, ProblemNode};
use crate::interface::rows;
use crate::linalg::SolveError;
use crate::linear::condensed::Condensed;
use crate::linear::norms::Norms;
use crate::linear::singular::Singular;
use crate::linear::stability::Stability;
use crate::model::{Axis, Friction, Mode, Model, Settings, Watched};
use std::sync::Arc;

/// Estimated norm of the scaled inverse from which on the equations are suspected to be singular.
const SUSPICIOUS: f64 = 1e12;
/// What a relative amount against a law may be at least.
const TOLERANCE: f64 = 1e-8;

/// The state about which a source linearises.
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// The source's own unknowns at the start of the present major iteration; of our bodies the values of all degrees
    /// of freedom ([`crate::model::Dofs`]).
    pub u: &'a [f64],
    /// The last accepted state.
    pub accepted: Accepted<'a>,
    /// Leg of the path on which the increment lies.
    pub leg: usize,
    /// Load factor of the last accepted state.
    pub start_load: f64,
    /// Load factor that the present major iteration aims at.
    pub target: f64,
    /// Load factor that the last major iteration aimed at: that of `u`.
    pub last_target: f64,
    /// One entry a contact.
    pub contacts: &'a [ContactState],
    /// Friction in force, by contact.
    pub friction: &'a [Friction],
    /// What went into the first minor iteration of the present major one, by contact; empty before that.
    pub entered: &'a [Input],
    /// Largest displacement change in the last major iteration over the scene's length.
    pub correction: f64,
    /// Stiffness that holds sliding back in this major iteration (force by length); 0 where nothing does
    /// ([`crate::step::recovery::proximal`]).
    pub brake: f64,
    /// The source's own unknowns about which the stiffness in use is taken; `None` for `u`.
    pub factored: Option<&'a [f64]>,
    /// Drag of a damped motion since the last accepted state (force by length), on every displacement.
    pub drag: Option<f64>,
    /// The settings as the user has them.
    pub chosen: &'a Settings,
    /// The settings in force: the strategy is the rung that the ladder has come to.
    pub settings: Settings,
    /// What the present major iteration is bound by where the load factor is an unknown; `target` is then the load factor
    /// that the solve adds to. `None` under load control.
    pub along: Option<Along<'a>>,
    /// Arc from the start of the history to the last accepted state; 0 under load control.
    pub arc: f64,
}

/// One equation more, for the load factor as an unknown.
#[derive(Debug, Clone, Copy)]
pub enum Along<'a> {
    /// The load factor changes by this much.
    Load {
        /// Change of the load factor.
        step: f64,
    },
    /// row · Δu = step, with an entry a degree of freedom.
    Displacements {
        /// Weights of the degrees of freedom.
        row: &'a [f64],
        /// What they add up to.
        step: f64,
    },
    /// One degree of freedom changes by this much.
    Dof {
        /// Its number.
        dof: usize,
        /// Its change.
        step: f64,
    },
    /// A contact's relative tangential motion is this much.
    Slip {
        /// Contact number.
        contact: usize,
        /// Motion of S* relative to S along t (length).
        step: f64,
    },
}

impl Along<'_> {
    /// Right-hand side of the equation.
    pub fn step(&self) -> f64 {
        match *self {
            Along::Load { step }
            | Along::Displacements { step, .. }
            | Along::Dof { step, .. }
            | Along::Slip { step, .. } => step,
        }
    }
}

/// The last accepted state, from which the present increment started.
#[derive(Debug, Clone, Copy)]
pub struct Accepted<'a> {
    /// The source's own unknowns there.
    pub u: &'a [f64],
    /// What the elements remember of it.
    pub history: &'a [f64],
    /// One entry a contact.
    pub contacts: &'a [ContactState],
}

/// What has been done since a source was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Assemblies of the bodies' stiffness.
    pub assemblies: u64,
    /// Factorizations: of the bodies, or of bodies and interface together.
    pub factorizations: u64,
}

/// How one solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solved {
    /// The solution satisfies the equations.
    Well,
    /// It does, but the matrix is singular to working precision.
    NearlySingular,
    /// There is no solution, or none that can be computed.
    Not,
}

/// What deforms under the interface.
///
/// Everything but the methods' arguments is workspace: it can be made again from a state, and is never saved.
///
/// A source that condenses its bodies to the interface keeps a [`Condensed`] and returns it from [`Source::condensed`]; it then
/// needs the six methods without a body here. [`crate::linear::constant`] is the smallest example.
pub trait Source: Send {
    /// Its own unknowns before the first increment.
    fn start(&self) -> Vec<f64>;

    /// What its elements remember before the first increment.
    fn history(&self) -> Vec<f64> {
        Vec::new()
    }

    /// A contact as it is held in a concave corner: in that at the end of its side, towards which it slides where S* moves along
    /// t relative to S as `motion` does; or, without a motion, in that where it sticks. `None` where there is no such corner.
    fn held_in_corner(
        &self,
        _contact: usize,
        _state: &ContactState,
        _motion: Option<f64>,
    ) -> Option<ContactState> {
        None
    }

    /// Finds where every contact stands in a state: the point on its surface, normal, stick point and drift. `anew` says
    /// that a sliding contact takes its stick point along. `friction` is that in force, by contact.
    fn follow(
        &mut self,
        u: &[f64],
        contacts: &mut [ContactState],
        friction: &[Friction],
        anew: bool,
    );

    /// Places the stick points of contacts that bring slip into the scene.
    fn place_stick_points(&mut self, _contacts: &mut [ContactState]) {}

    /// Goes back, or on, to a state. What keeps nothing but workspace has nothing to do. Returns whether the last linearisation
    /// still stands, where it was about such a state; where it does not, [`Source::linearise`] follows.
    fn restore(&mut self, _at: &At<'_>) -> bool {
        true
    }

    /// Goes over to a model that differs from its own in friction, loads, history and settings alone, with what it has laid
    /// out; what follows has the same bits as that of a new one. False, and nothing is changed, where it cannot.
    fn renew(&mut self, _model: &Arc<Model>) -> bool {
        false
    }

    /// Freezes geometry, stiffness and out-of-balance forces about a state (eqn 5).
    ///
    /// # Errors
    /// [`SolveError`] if the equations cannot be laid out.
    fn linearise(&mut self, at: &At<'_>) -> Result<(), SolveError>;

    /// Adds to the linearisation what turning and travelling interaction forces do, once the state has its final forces.
    fn turn(&mut self, _at: &At<'_>) {}

    /// Whether the last linearisation holds for a state that differs in the load factor only; then its out-of-balance
    /// forces are renewed.
    fn aim(&mut self, _at: &At<'_>) -> bool {
        false
    }

    /// How far the state of the last linearisation is from equilibrium, with its interface conditions.
    fn norms(&mut self, at: &At<'_>) -> Norms;

    /// Largest force that the next solve has to balance, what prescribed motions add included, over the scale of
    /// [`Norms::relative`].
    fn asked(&self) -> f64 {
        f64::INFINITY
    }

    /// How a contact stands over its surface in the last linearisation; `None` where it has no surface.
    fn kinematics(&self, contact: usize) -> Option<NodeKinematics>;

    /// The response of the interface in the last linearisation. `None` for a source that solves by itself.
    fn condensed(&self) -> Option<&Condensed> {
        None
    }

    /// The same, to solve with.
    fn condensed_mut(&mut self) -> Option<&mut Condensed> {
        None
    }

    /// One minor iteration: solves for the modes of the contacts.
    fn solve(&mut self, at: &At<'_>) -> Solved {
        if let Some(condensed) = self.condensed_mut() {
            condensed.clear();
        }
        for (k, state) in at.contacts.iter().enumerate() {
            let over = self.kinematics(k);
            let friction = state.friction(&at.friction[k]);
            let rows = rows::rows(state, over.as_ref(), &friction, &at.settings, 0.0);
            if let Some(condensed) = self.condensed_mut() {
                for (component, row) in rows.iter().enumerate() {
                    condensed.place_row(k, component, row, [0.0; 2]);
                }
            }
        }
        let Some(condensed) = self.condensed_mut() else {
            return Solved::Not;
        };
        let Ok(norm) = condensed.solve() else {
            return Solved::Not;
        };
        for k in 0..at.contacts.len() {
            condensed.read(k, [0.0; 2]);
        }
        match norm > SUSPICIOUS {
            true => Solved::NearlySingular,
            false => Solved::Well,
        }
    }

    /// What the last solve adds to the load factor where that is an unknown ([`At::along`]).
    fn load_step(&self) -> f64 {
        0.0
    }

    /// Whether it can solve for the load factor; where not, a history along the path fails at once.
    fn follows_paths(&self) -> bool {
        false
    }

    /// What the last solve gave at a contact.
    fn increment(&self, contact: usize) -> NodeIncrement {
        let of = |condensed: &Condensed| NodeIncrement {
            force: condensed.forces[contact],
            motion: condensed.motions[contact],
        };
        self.condensed().map_or(NodeIncrement::default(), of)
    }

    /// The interface problem of the last linearisation.
    ///
    /// # Errors
    /// [`SolveError`] where the bodies cannot be condensed.
    fn problem(&mut self, at: &At<'_>) -> Result<InterfaceProblem, SolveError> {
        let force = self.norms(at).scale;
        let condensed = self.condensed().ok_or(SolveError::Singular)?;
        let nodes = at
            .contacts
            .iter()
            .enumerate()
            .map(|(k, state)| ProblemNode {
                slave: k,
                kinematics: self.kinematics(k),
                prescribed: [0.0; 2],
                friction: state.friction(&at.friction[k]),
                state: *state,
            });
        Ok(InterfaceProblem {
            nodes: nodes.collect(),
            relation: condensed.relation.clone(),
            force,
            length: self.length(),
            spring: self.spring(),
            settings: at.settings,
        })
    }

    /// The unit of length for tolerances: the size of the scene.
    fn length(&self) -> f64 {
        1.0
    }

    /// A stiffness of the size of the interface's, by which lengths compare with forces (force by length).
    fn spring(&self) -> f64 {
        self.condensed().map_or(1.0, |condensed| {
            let diagonal = condensed.relation.response.iter();
            let diagonal = diagonal.step_by(2 * condensed.forces.len() + 1);
            diagonal.fold(0.0, |most: f64, k| most.max(k.abs()))
        })
    }

    /// Whether [`At::brake`] holds sliding back.
    fn brakes(&self) -> bool {
        false
    }

    /// Whether the minor iterations are solved on the condensed interface with these settings.
    fn condenses(&self, _settings: &Settings) -> bool {
        true
    }

    /// Finds what the last solve does to the bodies.
    fn recover(&mut self) -> Solved {
        Solved::Well
    }

    /// Takes the forces of the last minor iteration back: moves the bodies on. Returns the largest displacement.
    fn advance(&mut self, u: &mut [f64]) -> f64;

    /// The stick point of a contact that touched in this major iteration: where its path pierced the surface.
    fn stick_point(&self, _contact: usize, _state: &ContactState) -> Option<SurfacePoint> {
        None
    }

    /// Gives contacts the forces that the stresses call for (residual method 2), where these tell them. Returns whether
    /// any changed; the out-of-balance forces are renewed by [`Source::rebalance`].
    fn take_forces_from_stresses(&mut self, _contacts: &mut [ContactState]) -> bool {
        false
    }

    /// Renews the out-of-balance forces after forces of contacts were changed.
    fn rebalance(&mut self, _at: &At<'_>) {}

    /// The state is accepted: renews what the elements remember.
    fn accept(&mut self, _u: &[f64], _before: &[f64], _history: &mut [f64]) {}

    /// Which motions nothing resists, for these modes.
    fn explain(&self, _contacts: &[ContactState]) -> Singular {
        Singular::Unexplained
    }

    /// Current position of the slave node of a contact.
    fn position(&self, contact: usize) -> [f64; 2] {
        let over = |k: NodeKinematics| [0, 1].map(|axis| k.foot[axis] + k.gap * k.normal[axis]);
        self.kinematics(contact).map_or([0.0; 2], over)
    }

    /// Largest displacement of a state; a rotation counts as the displacement that it makes over the scene's length.
    fn largest_motion(&self, u: &[f64]) -> f64 {
        u.iter().fold(0.0, |most: f64, u| most.max(u.abs()))
    }

    /// Largest displacement between two states (length).
    fn moved(&self, u: &[f64], before: &[f64]) -> f64 {
        let moved = u.iter().zip(before).map(|(u, before)| (u - before).abs());
        moved.fold(0.0, f64::max)
    }

    /// How far a contact slid since the last accepted state, along t (length). `None` if the source does not measure it; its slip
    /// direction is then not judged.
    fn slid(&self, _contact: usize, _at: &At<'_>) -> Option<f64> {
        None
    }

    /// Judges a converged state by positions and forces alone ([`crate::contact::judge`]).
    fn judge(&mut self, at: &At<'_>, after: &Norms) -> Verdict {
        let tolerance = (10.0 * at.chosen.tolerance).max(TOLERANCE);
        let scales = Scales {
            length: self.length(),
            force: after.scale.max(f64::MIN_POSITIVE),
            lengths: tolerance,
            forces: tolerance,
        };
        let mut verdict = Verdict::default();
        for (k, state) in at.contacts.iter().enumerate() {
            let Some(over) = self.kinematics(k) else {
                continue;
            };
            let touched = at.accepted.contacts[k].mode != Mode::Free;
            let slip = self.slid(k, at).filter(|_| touched);
            for (law, amount) in against(state, &at.friction[k], over.gap, slip, &scales) {
                verdict.add(Finding {
                    law,
                    slave: Some(k),
                    amount,
                    allowed: scales.allowed(law),
                    numbers: Numbers {
                        gap: over.gap,
                        slip: -slip.unwrap_or(0.0),
                        limit: at.friction[k].coefficient() * state.f_n + at.friction[k].cohesion,
                        f_n: state.f_n,
                        f_t: state.f_t,
                    },
                });
            }
        }
        verdict.add(Finding {
            law: Law::Balance,
            slave: None,
            amount: after.relative,
            allowed: scales.allowed(Law::Balance),
            numbers: Numbers::default(),
        });
        verdict
    }

    /// Extreme deformations of the solids in a state. `None` if there are no solids or the source does not compute them.
    fn deformation(&self, _u: &[f64]) -> Option<Deformation> {
        None
    }

    /// Gives contacts that touched in the last accepted state the stick points of there back, so that their net slip
    /// counts. The state has been judged just before.
    fn count_net_slip(
        &mut self,
        _tolerance: f64,
        _accepted: &[ContactState],
        _contacts: &mut [ContactState],
    ) {
    }

    /// Whether it takes the drag of a damped motion into account.
    fn damps(&self) -> bool {
        false
    }

    /// Stability of the state of the last linearisation, with the modes that its contacts have.
    fn stability(&mut self, _at: &At<'_>) -> Stability {
        Stability::NotKnown
    }

    /// Cost of a stability check in major iterations; infinite if the source cannot check stability.
    fn stability_cost(&self) -> f64 {
        f64::INFINITY
    }

    /// What it has done so far, as far as it counts.
    fn work(&self) -> Work {
        Work::default()
    }

    /// Value of a monitor in the state of the last linearisation.
    fn monitor(&self, watched: &Watched, at: &At<'_>) -> f64 {
        match watched {
            Watched::Displacement { dof } => at.u[*dof],
            Watched::Contact { slaves, axis } => {
                let of = |&s: &usize| match axis {
                    Axis::X => -at.contacts[s].f_t,
                    Axis::Y => at.contacts[s].f_n,
                };
                slaves.iter().map(of).sum()
            }
            Watched::Modes { slaves, mode } => in_mode(at.contacts, slaves, *mode),
            Watched::Drift { slaves } => largest_drift(at.contacts, slaves),
            Watched::Arc => at.arc,
            Watched::Pressure { .. } | Watched::Told { .. } | Watched::Reaction { .. } => f64::NAN,
        }
    }
}

/// By how much a contact is against each law, relative to the scales; `slip` is what it has slipped in the increment, if it
/// touched all the while.
fn against(
    state: &ContactState,
    friction: &Friction,
    gap: f64,
    slip: Option<f64>,
    scales: &Scales,
) -> Vec<(Law, f64)> {
    let (length, force) = (scales.length, scales.force);
    let pressed = state.f_n.hypot(state.f_t) > scales.forces * force;
    if !pressed {
        return vec![(Law::Penetration, (-gap / length).max(0.0))];
    }
    let bound = friction.coefficient() * state.f_n + friction.cohesion;
    let mut laws = vec![
        (Law::Gap, gap.abs() / length),
        (Law::Tension, (-state.f_n / force).max(0.0)),
        (Law::Cone, ((state.f_t.abs() - bound) / force).max(0.0)),
    ];
    if let Some(slip) = slip.filter(|slip| slip.abs() > scales.near()) {
        let short = bound - slip.signum() * state.f_t;
        laws.push((Law::Slip, (short / force).max(0.0)));
    }
    laws
}
