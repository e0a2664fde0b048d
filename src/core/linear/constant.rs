//! A constant interface response as a source, without bodies and geometry: contacts on straight, fixed lines.
//!
//! Let w be the displacements of the slave nodes, normal (away from the surface) and tangential for each contact in turn, λ the
//! load factor, p the load and F the contact forces on the slave nodes:
//!
//! ```text
//! K w = λ p + F,      g = g_0 + w_n,      v = −w  (motion of S* against S),      ΔF = (K w − λ p − F) − K v.
//! ```
//!
//! This is the simplest source that can be stepped, and an example of what another code must provide ([`crate::linear::source`]).

use crate::linalg::SolveError;
use crate::linear::violation::violation;
use crate::model::{Bond, Contact, Dofs, Node, Touch};
use crate::plane::max_abs;
use crate::words::counted;
use crate::{
    CondensedSystem, ContactState, Friction, LinearisationPoint, Mode, Model, NodeKinematics,
    Norms, Settings, Source, SurfacePoint,
};

/// A constant interface: its stiffness, loads and gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// K (force per length), column-major, two rows per contact: normal, tangential.
    stiffness: Vec<f64>,
    /// p (force) at load factor 1.
    load: Vec<f64>,
    /// g_0 (length) of each contact; negative is penetration.
    gaps: Vec<f64>,
    /// Friction of each contact.
    friction: Vec<Friction>,
    /// The length scale for tolerances.
    length: f64,
}

/// Lists with inconsistent lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{name} has {}, but {} must have {wanted}", counted(*found, "entry"), counted(*contacts, "contact"))]
pub struct WrongSize {
    /// Name of the list.
    pub name: &'static str,
    /// Its number of entries.
    pub found: usize,
    /// The required number.
    pub wanted: usize,
    /// The number of contacts.
    pub contacts: usize,
}

impl Constant {
    /// An interface with `gaps.len()` contacts and the (positive) length scale `length`.
    ///
    /// # Errors
    /// [`WrongSize`] if the lists have inconsistent lengths.
    pub fn try_new(
        stiffness: Vec<f64>,
        load: Vec<f64>,
        gaps: Vec<f64>,
        friction: Vec<Friction>,
        length: f64,
    ) -> Result<Self, WrongSize> {
        let contacts = gaps.len();
        let lengths = [
            ("the stiffness", stiffness.len(), 4 * contacts * contacts),
            ("the load", load.len(), 2 * contacts),
            ("the friction", friction.len(), contacts),
        ];
        for (name, found, wanted) in lengths {
            if found != wanted {
                return Err(WrongSize {
                    name,
                    found,
                    wanted,
                    contacts,
                });
            }
        }
        Ok(Constant {
            stiffness,
            load,
            gaps,
            friction,
            length,
        })
    }

    /// A model for stepping it: a history of the load factor, and settings.
    pub fn model(&self, path: Vec<f64>, increment: f64, settings: Settings) -> Model {
        let contact = |(node, &friction)| Contact::new(node, Vec::new(), friction);
        let node = |k: usize| Node {
            name: format!("contact.{}", k + 1),
            at: [0.0; 2],
        };
        // Interface problems use one step of Coulomb's law.
        let touch = match settings.touch {
            Touch::Auto => Touch::Start,
            touch => touch,
        };
        Model {
            path,
            increment,
            settings: Settings { touch, ..settings },
            dofs: Dofs::default(),
            length: self.length,
            ..Model::from_contacts(
                "A constant interface",
                (0..self.gaps.len()).map(node).collect(),
                Vec::new(),
                self.friction.iter().enumerate().map(contact).collect(),
            )
        }
    }

    /// The source for a stepper.
    pub fn source(self) -> ConstantSource {
        let contacts = self.gaps.len();
        ConstantSource {
            gaps: self.gaps.clone(),
            condensed: CondensedSystem::new(contacts),
            norms: Norms::default(),
            interface: self,
        }
    }

    /// K w − λ p − F: the out-of-balance forces.
    fn missing(&self, w: &[f64], target: f64, contacts: &[ContactState], out: &mut [f64]) {
        for (k, out) in out.iter_mut().enumerate() {
            let state = &contacts[k / 2];
            let force = if k % 2 == 0 { state.f_n } else { state.f_t };
            *out = -target * self.load[k] - force;
        }
        let columns = self.stiffness.chunks_exact(out.len().max(1));
        for (column, w) in columns.zip(w) {
            for (out, k) in out.iter_mut().zip(column) {
                *out += k * w;
            }
        }
    }
}

/// A constant interface with the workspace of a major iteration.
pub struct ConstantSource {
    interface: Constant,
    /// Gaps in the last linearisation.
    gaps: Vec<f64>,
    condensed: CondensedSystem,
    norms: Norms,
}

impl ConstantSource {
    /// Position of a contact: its tangential displacement is the coordinate on its line.
    fn point(contact: usize, w: &[f64]) -> SurfacePoint {
        SurfacePoint {
            surface: contact,
            element: 0,
            xi: w[2 * contact + 1],
        }
    }

    /// Force scale: the loads and the current forces.
    fn scale(&self, at: &LinearisationPoint<'_>) -> f64 {
        let loads = self.interface.load.iter().map(|p| (at.target * p).abs());
        let forces = at.contacts.iter().map(|c| c.f_n.abs().max(c.f_t.abs()));
        loads.chain(forces).fold(0.0, f64::max)
    }
}

impl Source for ConstantSource {
    fn start(&self) -> Vec<f64> {
        vec![0.0; self.interface.load.len()]
    }

    fn follow(
        &mut self,
        w: &[f64],
        contacts: &mut [ContactState],
        _friction: &[Friction],
        anew: bool,
    ) {
        for (k, state) in contacts.iter_mut().enumerate() {
            let here = Self::point(k, w);
            (state.spot, state.normal) = (Some(here), [0.0, 1.0]);
            if state.mode == Mode::Free {
                (state.f_n, state.f_t, state.drift) = (0.0, 0.0, 0.0);
                state.anchor = state.anchor.filter(|_| state.kept);
                continue;
            }
            if anew && state.mode == Mode::Sliding {
                state.anchor = Some(here);
            }
            let anchor = *state.anchor.get_or_insert(here);
            state.drift = anchor.xi - here.xi;
        }
    }

    fn linearise(&mut self, at: &LinearisationPoint<'_>) -> Result<(), SolveError> {
        self.condensed.resize(self.interface.gaps.len())?;
        for (k, (gap, start)) in self.gaps.iter_mut().zip(&self.interface.gaps).enumerate() {
            *gap = start + at.u[2 * k];
        }
        let relation = &mut self.condensed.relation;
        relation.stiffness = f64::INFINITY;
        for (response, k) in relation.response.iter_mut().zip(&self.interface.stiffness) {
            *response = -k;
        }
        let missing = &mut relation.start;
        self.interface
            .missing(at.u, at.target, at.contacts, missing);
        let force = max_abs(missing.iter());
        self.condensed.fresh = true;
        let scale = self.scale(at);
        self.norms = at.norms(force, scale);
        Ok(())
    }

    fn norms(&mut self, at: &LinearisationPoint<'_>) -> Norms {
        let over = |contact: usize| self.kinematics(contact);
        self.norms.interface = violation(at, self.interface.length, self.norms.scale, over);
        self.norms
    }

    fn kinematics(&self, contact: usize) -> Option<NodeKinematics> {
        Some(NodeKinematics {
            gap: self.gaps[contact],
            normal: [0.0, 1.0],
            foot: [0.0; 2],
            room: [None; 2],
            moves: [true; 2],
            bond: Bond::Hard,
        })
    }

    fn stick_point(&self, contact: usize, state: &ContactState) -> Option<SurfacePoint> {
        let point = state.spot?;
        Some(SurfacePoint {
            xi: point.xi - self.gaps[contact] * state.ratio,
            ..point
        })
    }

    fn slid(&self, contact: usize, at: &LinearisationPoint<'_>) -> Option<f64> {
        let along = 2 * contact + 1;
        Some(at.accepted.u[along] - at.u[along])
    }

    fn length(&self) -> f64 {
        self.interface.length
    }

    fn condensed(&self) -> Option<&CondensedSystem> {
        Some(&self.condensed)
    }

    fn condensed_mut(&mut self) -> Option<&mut CondensedSystem> {
        Some(&mut self.condensed)
    }
}
