//! The pictures next to the screens: a run of the session's scene with the settings of the sliders.

use serde::Serialize;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::Until;
use stickslip_debugger::record::export::Origin;
use stickslip_debugger::record::export::export_state::{ExportState, PicturePart, PictureRequest};
use stickslip_debugger::record::export::picture;
use stickslip_debugger::record::export::run_history::RunHistory;
use stickslip_scene::Scene;
use stickslip_scene::format::paths;
use stickslip_scene::solver::solver;

/// One picture each.
const PARTS: [PicturePart; 3] = [PicturePart::Shape, PicturePart::Chart, PicturePart::Cone];

/// Pictures of a run, and the values of its settings.
#[derive(Debug, Clone, Serialize)]
pub struct Pictures {
    /// Name of the scene.
    pub scene: String,
    /// Friction angle in degrees.
    pub angle: Option<f64>,
    /// Increment of the load factor.
    pub increment: f64,
    /// Load factor of the last minor iteration.
    pub load: f64,
    /// Shape, load over displacement and friction cone as SVG, or why there is none.
    pub drawn: Vec<Result<String, String>>,
}

/// Runs the scene with some settings over a part of its load path (1: all of it), and draws the state that it reaches.
///
/// # Errors
/// If a setting does not suit the scene.
pub fn pictures(
    scene: &Scene,
    settings: &[(String, String)],
    part: f64,
) -> Result<Pictures, String> {
    let overrides: Vec<_> = scene
        .overrides()
        .map(|(path, value)| (path.to_owned(), value.to_owned()))
        .chain(settings.iter().cloned())
        .collect();
    let scene = Scene::open(&scene.name, &overrides).map_err(|why| why.to_string())?;
    let path = &scene.spec.history.path;
    let whole: f64 = path.windows(2).map(|leg| (leg[1] - leg[0]).abs()).sum();
    let mut stepper = solver(Arc::new(scene.model.clone()));
    let mut history = RunHistory::at_start(&mut stepper, &PARTS);
    let (mut travelled, mut load) = (0.0, path.first().copied().unwrap_or_default());
    stepper.drive(Until::end(), |stepper| {
        history.add(stepper);
        let event = stepper.event();
        if event.outcome.is_accepted() {
            travelled += (event.load_factor - load).abs();
            load = event.load_factor;
        }
        if travelled < part * whole {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    let (state, event) = (stepper.state(), stepper.event());
    let origin = Origin::new(&scene, event.position, event.load_factor);
    let draw = |only| {
        let request = PictureRequest {
            only: Some(only),
            ..PictureRequest::default()
        };
        let shown = history.shown(&scene, &origin, (state, Some(event)), &request);
        let svg = picture::sheet(&shown).and_then(|sheet| sheet.svg());
        svg.map_err(|why| why.to_string())
    };
    let listed = paths::list(&scene.spec);
    let angle = listed.iter().find(|scalar| scalar.path == "friction.angle");
    Ok(Pictures {
        scene: scene.name.clone(),
        angle: angle.and_then(|scalar| scalar.value.parse().ok()),
        increment: scene.spec.history.increment,
        load: event.load_factor,
        drawn: PARTS.map(draw).into(),
    })
}
