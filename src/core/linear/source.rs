//! The interface between the stepper and the deformable part: the program's own bodies, or another code.
//!
//! A major iteration freezes geometry and stiffness. From then on it needs the interface response (eqn 6): the dependence of the
//! forces on the motions, the gap and frame of every contact, and prescribed motions. When its minor iterations have converged,
//! the source receives the forces, moves its bodies, projects the slave nodes on their surfaces, and linearises again. Anything
//! that implements this trait can be stepped.

use crate::contact::state::{in_mode, largest_drift};
use crate::interface::minor_history::Input;
use crate::interface::rows;
use crate::linalg::SolveError;
use crate::model::{Axis, Contact, MonitorQuantity};
use crate::plane::max_abs;
use crate::{
    CondensedSystem, ContactState, Deformation, Finding, Friction, InterfaceProblem, JudgedLaw,
    JudgedNumbers, Mode, Model, NodeIncrement, NodeKinematics, Norms, NotFound, ProblemNode,
    Scales, Settings, Singular, Stability, SurfacePoint, Sweep, Verdict,
};
use std::sync::Arc;

/// Estimated norm of the scaled inverse from which on the equations are suspected to be singular.
const SUSPICIOUS: f64 = 1e12;
/// Lower bound of the tolerance for relative violations of a law.
const TOLERANCE: f64 = 1e-8;

/// The state about which a source linearises.
#[derive(Debug, Clone, Copy)]
pub struct LinearisationPoint<'a> {
    /// The source's own unknowns at the start of the current major iteration; for the program's bodies, the values of all degrees
    /// of freedom ([`crate::model::Dofs`]).
    pub u: &'a [f64],
    /// The last accepted state.
    pub accepted: AcceptedState<'a>,
    /// Leg of the path on which the increment lies.
    pub leg: usize,
    /// Load factor of the last accepted state.
    pub start_load: f64,
    /// Target load factor of the current major iteration.
    pub target: f64,
    /// Target load factor of the last major iteration, to which `u` belongs.
    pub last_target: f64,
    /// One entry per contact.
    pub contacts: &'a [ContactState],
    /// Current friction, by contact.
    pub friction: &'a [Friction],
    /// Input of the first minor iteration of the current major iteration, by contact; empty before that.
    pub entered: &'a [Input],
    /// Largest displacement correction in the last major iteration divided by the scene's length.
    pub correction: f64,
    /// Stiffness that resists sliding in this major iteration (force per length); 0 for none
    /// ([`crate::step::recovery::proximal`]).
    pub brake: f64,
    /// Values of the source's unknowns at which the stiffness in use was computed; `None` for `u`.
    pub factored: Option<&'a [f64]>,
    /// Drag on every displacement in a damped motion since the last accepted state (force per length).
    pub drag: Option<f64>,
    /// The settings chosen by the user.
    pub chosen: &'a Settings,
    /// The effective settings: the strategy is the current rung of the ladder.
    pub settings: Settings,
    /// The constraint of the current major iteration if the load factor is an unknown; the solve then adds to `target`. `None`
    /// under load control.
    pub along: Option<LoadEquation<'a>>,
    /// Arc from the start of the history to the last accepted state; 0 under load control.
    pub arc: f64,
}

impl LinearisationPoint<'_> {
    /// The contacts of the interface problem, from the kinematics and the prescribed motion of each.
    pub(super) fn nodes(
        &self,
        of: impl Fn(usize) -> (Option<NodeKinematics>, [f64; 2]),
    ) -> Vec<ProblemNode> {
        let node = |(slave, state): (usize, &ContactState)| {
            let (kinematics, prescribed) = of(slave);
            ProblemNode {
                slave,
                kinematics,
                prescribed,
                friction: state.friction(&self.friction[slave]),
                state: *state,
            }
        };
        self.contacts.iter().enumerate().map(node).collect()
    }

    /// Norms of the largest out-of-balance force and its scale, before the interface conditions.
    pub fn norms(&self, force: f64, scale: f64) -> Norms {
        Norms {
            force,
            relative: if force > 0.0 { force / scale } else { 0.0 },
            correction: self.correction,
            scale,
            limit: self.chosen.tolerance,
            ..Norms::default()
        }
    }
}

/// The additional equation if the load factor is an unknown.
#[derive(Debug, Clone, Copy)]
pub enum LoadEquation<'a> {
    /// The load factor changes by a given amount.
    Load {
        /// Change of the load factor.
        step: f64,
    },
    /// row · Δu = step, with one entry per degree of freedom.
    Displacements {
        /// Weights of the degrees of freedom.
        row: &'a [f64],
        /// Right-hand side.
        step: f64,
    },
    /// One degree of freedom changes by a given amount.
    Dof {
        /// Its number.
        dof: usize,
        /// Its change.
        step: f64,
    },
    /// A contact has a given relative tangential motion.
    Slip {
        /// Contact number.
        contact: usize,
        /// Motion of S* relative to S along t (length).
        step: f64,
    },
}

impl LoadEquation<'_> {
    /// Right-hand side of the equation.
    pub fn step(&self) -> f64 {
        match *self {
            LoadEquation::Load { step }
            | LoadEquation::Displacements { step, .. }
            | LoadEquation::Dof { step, .. }
            | LoadEquation::Slip { step, .. } => step,
        }
    }
}

/// The last accepted state, from which the current increment started.
#[derive(Debug, Clone, Copy)]
pub struct AcceptedState<'a> {
    /// The source's unknowns.
    pub u: &'a [f64],
    /// History variables of the elements.
    pub history: &'a [f64],
    /// One entry per contact.
    pub contacts: &'a [ContactState],
}

/// Work done since the source was created.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Assemblies of the bodies' stiffness.
    pub assemblies: u64,
    /// Factorizations: of the bodies, or of bodies and interface together.
    pub factorizations: u64,
}

/// Result of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolveResult {
    /// The solution satisfies the equations.
    Well,
    /// It does, but the matrix is singular to working precision.
    NearlySingular,
    /// There is no solution, or it cannot be computed.
    Not,
}

impl SolveResult {
    /// The result for an estimated norm of the scaled inverse.
    pub(super) fn from_norm(norm: f64) -> SolveResult {
        match norm > SUSPICIOUS {
            true => SolveResult::NearlySingular,
            false => SolveResult::Well,
        }
    }
}

/// The deformable part under the interface.
///
/// Everything except the methods' arguments is workspace: it can be rebuilt from a state and is never saved.
pub trait Source: Send {
    /// The source's unknowns before the first increment.
    fn start(&self) -> Vec<f64>;

    /// History variables of its elements before the first increment.
    fn history(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The state of a contact held in a concave corner: at the end of its side towards which it slides if S* moves along t
    /// relative to S by `motion`; without a motion, in the corner where it sticks. `None` if there is no such corner.
    fn held_in_corner(
        &self,
        _contact: usize,
        _state: &ContactState,
        _motion: Option<f64>,
    ) -> Option<ContactState> {
        None
    }

    /// Finds the position of every contact in a state: surface point, normal, stick point and drift. With `anew`, a sliding
    /// contact takes its stick point along. `friction` is the current one, by contact; `unclosed` is the fraction of the initial
    /// overlaps that is still open ([`crate::Model::unclosed`]).
    fn follow(
        &mut self,
        u: &[f64],
        contacts: &mut [ContactState],
        friction: &[Friction],
        anew: bool,
        unclosed: f64,
    );

    /// Sets the stick points of contacts whose initial state has slip.
    fn place_stick_points(&mut self, _contacts: &mut [ContactState]) {}

    /// Called when the stepper jumps to another state; sources that only have workspace need not do anything. Returns whether the
    /// last linearisation is valid for such a state; if not, [`Source::linearise`] follows.
    fn restore(&mut self, _at: &LinearisationPoint<'_>) -> bool {
        true
    }

    /// Switches to a model that differs only in friction, loads, history and settings, and keeps the layout; results have the
    /// same bits as with a new source. If that is not possible, returns false and changes nothing.
    fn renew(&mut self, _model: &Arc<Model>) -> bool {
        false
    }

    /// Freezes geometry, stiffness and out-of-balance forces at a state (eqn 5).
    ///
    /// # Errors
    /// [`SolveError`] if the equations cannot be set up.
    fn linearise(&mut self, at: &LinearisationPoint<'_>) -> Result<(), SolveError>;

    /// Adds the effect of rotating and moving interaction forces to the linearisation, once the state has its final forces.
    fn turn(&mut self, _at: &LinearisationPoint<'_>) {}

    /// Whether the last linearisation is valid for a state that differs only in the load factor; if so, updates its
    /// out-of-balance forces.
    fn aim(&mut self, _at: &LinearisationPoint<'_>) -> bool {
        false
    }

    /// Residual norms of the state of the last linearisation, including its interface conditions.
    fn norms(&mut self, at: &LinearisationPoint<'_>) -> Norms;

    /// Largest force that the next solve has to balance, including the contribution of prescribed motions, relative to the scale
    /// of [`Norms::relative`].
    fn required_force(&self) -> f64 {
        f64::INFINITY
    }

    /// The degree of freedom with the largest out-of-balance force in the last linearisation, and that force; `None` if the
    /// source does not know it.
    fn largest_residual(&self) -> Option<(usize, f64)> {
        None
    }

    /// Position of a contact relative to its surface in the last linearisation; `None` without a surface.
    fn kinematics(&self, contact: usize) -> Option<NodeKinematics>;

    /// The response of the interface in the last linearisation. `None` for a source that solves by itself.
    fn condensed(&self) -> Option<&CondensedSystem> {
        None
    }

    /// The same, to solve with.
    fn condensed_mut(&mut self) -> Option<&mut CondensedSystem> {
        None
    }

    /// One minor iteration: solves for the modes of the contacts.
    fn solve(&mut self, at: &LinearisationPoint<'_>) -> SolveResult {
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
            return SolveResult::Not;
        };
        let Ok(norm) = condensed.solve() else {
            return SolveResult::Not;
        };
        for k in 0..at.contacts.len() {
            condensed.read(k, [0.0; 2]);
        }
        SolveResult::from_norm(norm)
    }

    /// Change of the load factor in the last solve, if it is an unknown ([`LinearisationPoint::along`]).
    fn load_step(&self) -> f64 {
        0.0
    }

    /// Whether it can solve for the load factor; if not, arc-length histories fail at once.
    fn follows_paths(&self) -> bool {
        false
    }

    /// Result of the last solve at a contact.
    fn increment(&self, contact: usize) -> NodeIncrement {
        let of = |condensed: &CondensedSystem| NodeIncrement {
            force: condensed.forces[contact],
            motion: condensed.motions[contact],
        };
        self.condensed().map_or(NodeIncrement::default(), of)
    }

    /// The interface problem of the last linearisation.
    ///
    /// # Errors
    /// [`SolveError`] where the bodies cannot be condensed.
    fn problem(&mut self, at: &LinearisationPoint<'_>) -> Result<InterfaceProblem, SolveError> {
        let force = self.norms(at).scale;
        let condensed = self.condensed().ok_or(SolveError::Singular)?;
        Ok(InterfaceProblem {
            nodes: at.nodes(|k| (self.kinematics(k), [0.0; 2])),
            relation: condensed.relation.clone(),
            force,
            length: self.length(),
            spring: self.spring(),
            settings: at.settings,
        })
    }

    /// Starts Gauss-Seidel sweeps over the interface problem of the last linearisation.
    ///
    /// # Errors
    /// [`NotFound`] if the bodies cannot be condensed, or are unsupported without contact.
    fn sweep(&mut self, at: &LinearisationPoint<'_>) -> Result<Sweep, NotFound> {
        let problem = self.problem(at).map_err(|_| NotFound::NotCondensed)?;
        Sweep::new(&problem).ok_or(NotFound::NoStart)
    }

    /// Whether [`Source::press`] can take the forces of sweeps, so that they need no solve for their modes.
    fn takes_forces(&self) -> bool {
        false
    }

    /// Takes total contact forces (normal and tangential, by contact) as the result of a minor iteration.
    fn press(&mut self, _forces: &mut dyn Iterator<Item = [f64; 2]>) {}

    /// The unit of length for tolerances: the size of the scene.
    fn length(&self) -> f64 {
        1.0
    }

    /// A stiffness of the size of the interface's, by which lengths compare with forces (force by length).
    fn spring(&self) -> f64 {
        self.condensed().map_or(1.0, |condensed| {
            let diagonal = condensed.relation.response.iter();
            let diagonal = diagonal.step_by(2 * condensed.forces.len() + 1);
            max_abs(diagonal)
        })
    }

    /// Whether it supports [`LinearisationPoint::brake`].
    fn brakes(&self) -> bool {
        false
    }

    /// Whether minor iterations are solved on the condensed interface with these settings.
    fn condenses(&self, _settings: &Settings) -> bool {
        true
    }

    /// Computes the effect of the last solve on the bodies.
    fn recover(&mut self) -> SolveResult {
        SolveResult::Well
    }

    /// Moves the bodies according to the forces of the last minor iteration. Returns the largest displacement. By default the
    /// unknowns are w_n, w_t of each contact: those of S over its surface, which motions of the contacts reduce.
    fn advance(&mut self, u: &mut [f64]) -> f64 {
        let motions = self
            .condensed()
            .into_iter()
            .flat_map(|c| c.motions.iter().flatten());
        u.iter_mut().zip(motions).fold(0.0, |most: f64, (w, v)| {
            *w -= v;
            most.max(v.abs())
        })
    }

    /// The stick point of a contact that touched in this major iteration: where its path meets the surface.
    fn stick_point(&self, _contact: usize, _state: &ContactState) -> Option<SurfacePoint> {
        None
    }

    /// Sets the contact forces to those computed from the stresses (residual method 2), where possible. Returns whether any
    /// changed; [`Source::rebalance`] then updates the out-of-balance forces.
    fn take_forces_from_stresses(&mut self, _contacts: &mut [ContactState]) -> bool {
        false
    }

    /// Updates the out-of-balance forces after contact forces have changed.
    fn rebalance(&mut self, _at: &LinearisationPoint<'_>) {}

    /// Updates the history variables of the elements when the state is accepted.
    fn accept(&mut self, _u: &[f64], _before: &[f64], _history: &mut [f64]) {}

    /// Motions without resistance, for these modes.
    fn explain(&self, _contacts: &[ContactState]) -> Singular {
        Singular::Unexplained
    }

    /// Current position of the slave node of a contact.
    fn position(&self, contact: usize) -> [f64; 2] {
        let over = |k: NodeKinematics| [0, 1].map(|axis| k.foot[axis] + k.gap * k.normal[axis]);
        self.kinematics(contact).map_or([0.0; 2], over)
    }

    /// Largest displacement in a state; rotations are multiplied by the scene's length.
    fn largest_motion(&self, u: &[f64]) -> f64 {
        max_abs(u)
    }

    /// Largest displacement between two states (length).
    fn moved(&self, u: &[f64], before: &[f64]) -> f64 {
        max_abs(u.iter().zip(before).map(|(u, before)| u - before))
    }

    /// How far a contact slid since the last accepted state, along t (length). `None` if the source does not measure it; its slip
    /// direction is then not judged.
    fn slid(&self, _contact: usize, _at: &LinearisationPoint<'_>) -> Option<f64> {
        None
    }

    /// Uncertainty of lengths relative to the length scale. `None` if it is that of forces ([`Norms::limit`]).
    fn limit_of_lengths(&self) -> Option<f64> {
        None
    }

    /// Judges a converged state from positions and forces alone ([`crate::contact::judge`]).
    fn judge(&mut self, at: &LinearisationPoint<'_>, after: &Norms) -> Verdict {
        let allowed = |limit: f64| (10.0 * at.chosen.tolerance.max(limit)).max(TOLERANCE);
        let scales = Scales {
            length: self.length(),
            force: after.scale.max(f64::MIN_POSITIVE),
            lengths: allowed(self.limit_of_lengths().unwrap_or(after.limit)),
            forces: allowed(after.limit),
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
                    numbers: JudgedNumbers {
                        gap: over.gap,
                        slip: -slip.unwrap_or(0.0),
                        limit: at.friction[k].limit(state.f_n),
                        f_n: state.f_n,
                        f_t: state.f_t,
                        deviation: None,
                    },
                });
            }
        }
        verdict.add(Finding {
            law: JudgedLaw::Balance,
            slave: None,
            amount: after.relative,
            allowed: scales.allowed(JudgedLaw::Balance),
            numbers: JudgedNumbers::default(),
        });
        verdict
    }

    /// Extreme deformations of the solids in a state. `None` if there are no solids or the source does not compute them.
    fn deformation(&self, _u: &[f64]) -> Option<Deformation> {
        None
    }

    /// Restores the stick points of contacts that already touched in the last accepted state, so that their net slip counts.
    /// Called directly after the state was judged.
    fn count_net_slip(
        &mut self,
        _tolerance: f64,
        _accepted: &[ContactState],
        _contacts: &mut [ContactState],
    ) {
    }

    /// Whether it supports the drag of damped motions.
    fn damps(&self) -> bool {
        false
    }

    /// Stability of the state of the last linearisation, with its contacts' modes.
    fn stability(&mut self, _at: &LinearisationPoint<'_>) -> Stability {
        Stability::NotKnown
    }

    /// Cost of a stability check in major iterations; infinite if the source cannot check stability.
    fn stability_cost(&self) -> f64 {
        f64::INFINITY
    }

    /// Work done so far, if the source counts it.
    fn work(&self) -> Work {
        Work::default()
    }

    /// Value of a monitor in the state of the last linearisation.
    fn monitor(&self, watched: &MonitorQuantity, at: &LinearisationPoint<'_>) -> f64 {
        match watched {
            MonitorQuantity::Contact { slaves, axis } => {
                let of = |&s: &usize| match axis {
                    Axis::X => -at.contacts[s].f_t,
                    Axis::Y => at.contacts[s].f_n,
                };
                slaves.iter().map(of).sum()
            }
            MonitorQuantity::Pressure { .. } => f64::NAN,
            _ => value(watched, &[], at),
        }
    }
}

/// Value of a monitor that needs only displacements and contacts; not a number for the others.
pub(super) fn value(
    watched: &MonitorQuantity,
    contacts: &[Contact],
    at: &LinearisationPoint<'_>,
) -> f64 {
    match watched {
        MonitorQuantity::Displacement { dof } => at.u[*dof],
        MonitorQuantity::Contact { slaves, axis } => {
            let k = if *axis == Axis::X { 0 } else { 1 };
            slaves.iter().map(|&s| at.contacts[s].force()[k]).sum()
        }
        MonitorQuantity::Modes { slaves, mode } => in_mode(at.contacts, slaves, *mode),
        MonitorQuantity::Drift { slaves } => largest_drift(at.contacts, slaves),
        MonitorQuantity::Pressure { slaves, shear } => {
            pressure(contacts, at.contacts, slaves, *shear)
        }
        MonitorQuantity::Arc => at.arc,
        MonitorQuantity::Reported { .. } | MonitorQuantity::Reaction { .. } => f64::NAN,
    }
}

/// Pressure or shear of the contact where its magnitude is largest.
fn pressure(contacts: &[Contact], states: &[ContactState], slaves: &[usize], shear: bool) -> f64 {
    let of = |&s: &usize| {
        let both = contacts[s].pressure(states[s].f_n, states[s].f_t)?;
        Some(both[usize::from(shear)])
    };
    let all = slaves.iter().filter_map(of);
    all.fold(
        0.0,
        |most: f64, p| if p.abs() > most.abs() { p } else { most },
    )
}

/// By how much a contact is against each law, relative to the scales; `slip` is what it has slipped in the increment, if it
/// touched all the while.
fn against(
    state: &ContactState,
    friction: &Friction,
    gap: f64,
    slip: Option<f64>,
    scales: &Scales,
) -> Vec<(JudgedLaw, f64)> {
    let (length, force) = (scales.length, scales.force);
    let pressed = state.f_n.hypot(state.f_t) > scales.forces * force;
    if !pressed {
        return vec![(JudgedLaw::Penetration, (-gap / length).max(0.0))];
    }
    let bound = friction.limit(state.f_n);
    let mut laws = vec![
        (JudgedLaw::Gap, gap.abs() / length),
        (JudgedLaw::Tension, (-state.f_n / force).max(0.0)),
        (
            JudgedLaw::Cone,
            ((state.f_t.abs() - bound) / force).max(0.0),
        ),
    ];
    if let Some(slip) = slip.filter(|slip| slip.abs() > scales.near()) {
        let short = bound - slip.signum() * state.f_t;
        laws.push((JudgedLaw::Slip, (short / force).max(0.0)));
    }
    laws
}
