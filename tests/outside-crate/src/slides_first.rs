//! Table 2 with one change: a fixed node slides before it opens.

use stickslip_core::contact::table2::{Numbers, Reason, Rule, decide};
use stickslip_core::interface::method::{Choice, Method, NodeContext};
use stickslip_core::model::Mode;

/// The strategy.
#[derive(Debug, Clone, Copy)]
pub struct SlidesFirst;

impl Method for SlidesFirst {
    fn choose(&self, numbers: &Numbers, known: &NodeContext<'_>) -> Choice {
        let mut decision = decide(numbers, known.ties);
        if (decision.before, decision.next) == (Mode::Fixed, Mode::Free) {
            (decision.next, decision.wanted) = (Mode::Sliding, Mode::Sliding);
            decision.rule =
                Rule::Custom(Reason("Fixed → sliding: a fixed node never opens at once."));
        }
        Choice {
            decision,
            sign: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use stickslip_core::model::{
        BodyKind, Component, Contact, Form, Friction, Linear, Model, Surface,
    };
    use stickslip_core::{Outcome, Stepper};

    /// A node on springs that is pressed onto a floor in the first half of the history and lifted off in the second.
    fn model() -> Model {
        let mut model = Model::builder("Pressed and lifted");
        let slave = model.node("slave", [0.0, 0.1]);
        let floor = [[1.0, 0.0], [-1.0, 0.0]].map(|at| model.node("floor", at));
        let springs = Linear {
            form: Form::Stiffness,
            entries: vec![(0, 0, 100.0), (1, 1, 100.0)],
            bars: Vec::new(),
        };
        model.body("springs", vec![slave], BodyKind::Linear(springs));
        let floor = model.surface(Surface::endless("floor", floor));
        let friction = Friction {
            angle: 20.0,
            cohesion: 0.0,
        };
        model.contact(Contact::new(slave, vec![floor], friction));
        model.load(slave, Component::Y, -30.0);
        model.history(vec![0.0, 1.0, 0.0], 0.5);
        model.build().unwrap()
    }

    #[test]
    fn the_stepper_uses_it_and_reports_its_reason() {
        let mut stepper = Stepper::new(Arc::new(model())).with_strategy(Arc::new(SlidesFirst));
        let mut reasons = Vec::new();
        while let Some(event) = stepper.step() {
            assert!(!matches!(event.outcome, Outcome::Failed(_)), "{event:?}");
            if let Rule::Custom(reason) = event.nodes[0].decision.rule {
                reasons.push(reason.0);
            }
        }
        assert_eq!(stepper.state().nodes[0].mode, Mode::Free);
        assert!(reasons[0].starts_with("Fixed → sliding"), "{reasons:?}");
    }
}
