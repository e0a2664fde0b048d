//! Describes solids outside the range of their material law: the element, its deformation, and a suitable law
//! ([`stickslip_core::fem::deformation`]).

use stickslip_core::fem::deformation::{StretchRange, deformation};
use stickslip_core::{Deformation, Elastic, Failure, Law, Model, PointDeformation, State, Update};
use stickslip_scene::sig4;

/// Displacements beyond this multiple of the scene's length are meaningless as a shape.
const LOST: f64 = 10.0;

/// The material of an element: its number data and its name in the scene.
fn material<'a>(model: &'a Model, point: &PointDeformation) -> Option<(&'a Elastic, &'a str)> {
    let solid = model.bodies.get(point.body)?.solid()?;
    let number = solid.elements.get(point.element)?.material;
    let name = solid.material_names.get(number)?;
    Some((solid.materials.get(number)?, name))
}

/// Names an element by number and body.
pub fn element(model: &Model, point: &PointDeformation) -> String {
    let body = model.bodies.get(point.body).map_or("?", |body| &body.name);
    format!("element {} of {body}", point.element + 1)
}

/// Names an element and the location of its worst point.
pub(super) fn place(model: &Model, point: &PointDeformation) -> String {
    let [x, y] = point.at.map(sig4);
    format!("{} at ({x}, {y})", element(model, point))
}

/// Describes an inverted element, as part of a sentence.
pub fn inverted(model: &Model, point: &PointDeformation) -> String {
    format!(
        "{} is inverted: det F = {}, smallest principal stretch {}",
        place(model, point),
        sig4(point.determinant),
        sig4(point.stretch)
    )
}

/// Describes an element outside the range of its law, as part of a sentence.
pub fn outside(model: &Model, point: &PointDeformation) -> String {
    let stretch = sig4(point.stretch);
    format!(
        "{} is {}: {}",
        place(model, point),
        match range(model, point) {
            StretchRange::Volume(_) => format!("swollen to det F = {}", sig4(point.determinant)),
            _ => format!("compressed to a stretch of {stretch}"),
        },
        limit(model, point)
    )
}

fn range(model: &Model, point: &PointDeformation) -> StretchRange {
    material(model, point).map_or(StretchRange::Unlimited, |(elastic, _)| {
        StretchRange::from_elastic(elastic)
    })
}

/// Describes the range of an element's law and the behaviour outside.
pub fn limit(model: &Model, point: &PointDeformation) -> String {
    match (range(model, point), material(model, point)) {
        (StretchRange::Stretch(least), Some((elastic, _))) if elastic.update == Update::Small => {
            format!(
                "below {} linear elasticity (update: small) neglects more than 5 % of the strain",
                sig4(least)
            )
        }
        (StretchRange::Stretch(least), _) => format!(
            "St Venant-Kirchhoff (law: svk) softens below {} under compression",
            sig4(least)
        ),
        (StretchRange::Volume(most), _) => {
            format!("law: neohookean may soften beyond det F = {}", sig4(most))
        }
        (StretchRange::Unlimited, _) => "its stress update has no limit".into(),
    }
}

/// Path and value of the scene setting that selects a material law valid at this stretch. `None` if there is no such law.
pub fn other_law(model: &Model, point: &PointDeformation) -> Option<(String, String)> {
    let (elastic, name) = material(model, point)?;
    match (elastic.update, elastic.law) {
        (Update::Total, Law::Svk) => Some((format!("materials.{name}.law"), "neohookean".into())),
        (Update::Small, _) => Some((format!("materials.{name}.update"), "total".into())),
        _ => None,
    }
}

/// Describes an accepted increment that leaves the range, with a suitable law.
pub fn left(model: &Model, point: &PointDeformation) -> String {
    let suggested = other_law(model, point)
        .map(|(path, value)| format!(" (suggested, not tried: {path}={value})"))
        .unwrap_or_default();
    format!("{}{suggested}", outside(model, point))
}

/// Role of a solid's law in a failure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialCause {
    /// The worst point of the failed iterate if it is outside the range, otherwise of the last equilibrium.
    pub point: PointDeformation,
    /// The worst point of the last equilibrium, if it was already outside.
    pub before: Option<PointDeformation>,
}

impl MaterialCause {
    /// The element of a failed state that is outside the range of its law. `None` if all are inside, or if the failure
    /// certainly has another cause.
    pub fn find(model: &Model, state: &State, failure: &Failure) -> Option<MaterialCause> {
        use stickslip_core::linear::singular::Singular;
        if matches!(
            failure,
            Failure::Singular(Singular::Rigid { .. })
                | Failure::RoundOff { .. }
                | Failure::OverConstrained { .. }
                | Failure::Reported { .. }
        ) {
            return None;
        }
        let bounded = state.u.iter().all(|u| u.abs() < LOST * model.length);
        let failed = bounded.then(|| deformation(model, &state.u)).flatten();
        let worst = |found: Deformation| found.outside.or(found.inverted());
        let before = deformation(model, &state.start.u).and_then(worst);
        let point = match failure {
            Failure::Inverted(point) => Some(*point),
            _ => failed.and_then(worst).or(before),
        };
        Some(MaterialCause {
            point: point?,
            before,
        })
    }

    /// Whether the law is the cause: the accepted state is already outside its range, or an element is inverted. An iterate
    /// may be outside for other reasons.
    pub fn is_certain(&self) -> bool {
        let upright = self.point.determinant > 0.0;
        self.before.is_some() || !upright
    }

    /// Describes the cause.
    pub fn words(&self, model: &Model) -> String {
        let before = match &self.before {
            Some(before) if before.stretch != self.point.stretch => format!(
                "; in the last equilibrium, {} was compressed to {}",
                element(model, before),
                sig4(before.stretch)
            ),
            _ => String::new(),
        };
        let text = if self.point.determinant > 0.0 {
            outside(model, &self.point)
        } else {
            let (point, limit) = (inverted(model, &self.point), limit(model, &self.point));
            format!("{point}; {limit}")
        };
        format!("{text}{before}")
    }
}
