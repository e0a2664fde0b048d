//! A node on stiffening springs over a straight floor: in each direction, with the displacement w, the load p at load factor 1
//! and the contact force F,
//!
//! ```text
//! k w + c w³ = λ p + F.
//! ```

use stickslip_core::contact::projection::SurfacePoint;
use stickslip_core::contact::state::ContactState;
use stickslip_core::interface::kinematics::NodeKinematics;
use stickslip_core::linalg::SolveError;
use stickslip_core::linear::condensed::CondensedSystem;
use stickslip_core::linear::norms::Norms;
use stickslip_core::linear::source::{LinearisationPoint, Source};
use stickslip_core::linear::violation::violation;
use stickslip_core::model::{Bond, Friction, Mode};

/// One slave node; its unknowns are w along the normal and along the tangent.
pub struct Stiffening {
    /// k (force by length).
    pub stiffness: f64,
    /// c (force by length³).
    pub cubic: f64,
    /// p (force), normal and tangential.
    pub load: [f64; 2],
    /// Gap at the start (length).
    pub gap: f64,
    condensed: CondensedSystem,
    w: [f64; 2],
    norms: Norms,
}

impl Stiffening {
    /// At rest.
    pub fn new(stiffness: f64, cubic: f64, load: [f64; 2], gap: f64) -> Self {
        Stiffening {
            stiffness,
            cubic,
            load,
            gap,
            condensed: CondensedSystem::new(1),
            w: [0.0; 2],
            norms: Norms::default(),
        }
    }
}

impl Source for Stiffening {
    fn start(&self) -> Vec<f64> {
        vec![0.0; 2]
    }

    fn follow(
        &mut self,
        w: &[f64],
        contacts: &mut [ContactState],
        _: &[Friction],
        anew: bool,
        _: f64,
    ) {
        let here = SurfacePoint {
            surface: 0,
            element: 0,
            xi: w[1],
        };
        for state in contacts {
            (state.spot, state.normal) = (Some(here), [0.0, 1.0]);
            if state.mode == Mode::Free {
                (state.f_n, state.f_t, state.drift, state.anchor) = (0.0, 0.0, 0.0, None);
                continue;
            }
            if anew && state.mode == Mode::Sliding {
                state.anchor = Some(here);
            }
            state.drift = state.anchor.get_or_insert(here).xi - here.xi;
        }
    }

    fn linearise(&mut self, at: &LinearisationPoint<'_>) -> Result<(), SolveError> {
        self.condensed.resize(1)?;
        self.w = [at.u[0], at.u[1]];
        let (state, relation) = (&at.contacts[0], &mut self.condensed.relation);
        relation.stiffness = f64::INFINITY;
        relation.response.fill(0.0);
        let forces = [state.f_n, state.f_t];
        for (k, w) in self.w.into_iter().enumerate() {
            relation.response[3 * k] = -(self.stiffness + 3.0 * self.cubic * w * w);
            let inner = self.stiffness * w + self.cubic * w * w * w;
            relation.start[k] = inner - at.target * self.load[k] - forces[k];
        }
        let force = relation
            .start
            .iter()
            .fold(0.0_f64, |most, f| most.max(f.abs()));
        let sizes = self
            .load
            .map(|p| (at.target * p).abs())
            .into_iter()
            .chain(forces);
        let scale = sizes.fold(0.0, |most: f64, size| most.max(size.abs()));
        self.condensed.fresh = true;
        self.norms = at.norms(force, scale);
        Ok(())
    }

    fn norms(&mut self, at: &LinearisationPoint<'_>) -> Norms {
        let over = |contact: usize| self.kinematics(contact);
        self.norms.interface = violation(at, self.length(), self.norms.scale, over);
        self.norms
    }

    fn kinematics(&self, _: usize) -> Option<NodeKinematics> {
        Some(NodeKinematics {
            gap: self.gap + self.w[0],
            normal: [0.0, 1.0],
            foot: [0.0; 2],
            room: [None; 2],
            moves: [true; 2],
            bond: Bond::Hard,
        })
    }

    fn condensed(&self) -> Option<&CondensedSystem> {
        Some(&self.condensed)
    }

    fn condensed_mut(&mut self) -> Option<&mut CondensedSystem> {
        Some(&mut self.condensed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use stickslip_core::model::{Contact, Model, Node, Settings, Touch};
    use stickslip_core::{Outcome, Stepper};

    /// The root of k w + c w³ = force by bisection.
    fn displacement(force: f64) -> f64 {
        let (mut low, mut high) = (-10.0, 10.0);
        for _ in 0..200 {
            let w = 0.5 * (low + high);
            match 100.0 * w + 50.0 * w * w * w < force {
                true => low = w,
                false => high = w,
            }
        }
        0.5 * (low + high)
    }

    #[test]
    fn a_node_that_is_pressed_and_pushed_slides_to_where_its_springs_hold_it() {
        let friction = Friction {
            angle: 20.0,
            cohesion: 0.0,
        };
        let node = Node {
            name: "node".into(),
            at: [0.0; 2],
        };
        let contact = Contact::new(0, Vec::new(), friction);
        let model = Model {
            increment: 0.25,
            settings: Settings {
                touch: Touch::Start,
                ..Settings::default()
            },
            ..Model::from_contacts("stiffening", vec![node], Vec::new(), vec![contact])
        };
        let source = Stiffening::new(100.0, 50.0, [-60.0, -90.0], 0.1);
        let mut stepper = Stepper::with_source(Arc::new(model), Box::new(source));
        while let Some(event) = stepper.step() {
            assert!(!matches!(event.outcome, Outcome::Failed(_)), "{event:?}");
        }
        let state = stepper.state();
        let f_n = 60.0 - (100.0 * 0.1 + 50.0 * 0.001);
        let f_t = 20_f64.to_radians().tan() * f_n;
        assert_eq!(state.nodes[0].mode, Mode::Sliding);
        assert!((state.nodes[0].f_n - f_n).abs() < 1e-8, "{state:?}");
        assert!((state.u[0] + 0.1).abs() < 1e-10);
        assert!(
            (state.u[1] - displacement(-90.0 + f_t)).abs() < 1e-8,
            "{state:?}"
        );
    }
}
