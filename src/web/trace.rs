//! The trace of a scene, to compare a browser's floating point with other systems.

use std::ops::ControlFlow;
use stickslip_core::Until;
use stickslip_debugger::record::table::{trace_header, trace_rows};
use stickslip_scene::Scene;
use stickslip_scene::solver::solver;

/// Solves a scene to its end or first failure; the same text as `stickslip run SCENE --trace`.
///
/// # Errors
/// If there is no such scene.
pub fn trace(scene: &str) -> Result<String, String> {
    let scene = Scene::open(scene, &[]).map_err(|why| why.to_string())?;
    let model = std::sync::Arc::new(scene.model);
    let mut text = trace_header(&model);
    solver(model.clone()).drive(Until::end(), |stepper| {
        let friction = &stepper.state().controls.friction;
        text += &trace_rows(&model, friction, stepper.event());
        ControlFlow::<()>::Continue(())
    });
    Ok(text)
}
