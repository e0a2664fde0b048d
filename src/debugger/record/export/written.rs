//! Scenes as text (`.ron`), and frozen problems in other programs' formats: `.dat`, `.mtx`, `.h5`.

use super::export_state::{ExportState, problem};
use super::frozen::{self, Origin};
use crate::explain::names;
use crate::refusal::{Refusal, refusal};
use stickslip_core::Stepper;
use stickslip_exchange::problem::Local;
use stickslip_exchange::{fclib, siconos};
use stickslip_scene::format::notation;
use stickslip_scene::problems::market;
use stickslip_scene::shown as outside;
use stickslip_scene::{Scene, joined};

/// The scene with all overrides, or its frozen problem if requested.
pub(super) fn ron(shown: &ExportState, stepper: &mut Stepper) -> Result<Vec<u8>, Refusal> {
    if !shown.frozen {
        return Ok(scene(shown.scene)?.into_bytes());
    }
    let (problem, state) = problem(shown, stepper)?;
    let origin = Origin {
        at: if state.next == shown.state.next {
            shown.origin.at
        } else {
            state.next
        },
        ..shown.origin.clone()
    };
    Ok(frozen::whole(&shown.scene.model, &origin, &problem)?.into_bytes())
}

/// The frozen problem in Siconos format.
pub(super) fn dat(shown: &ExportState, stepper: &mut Stepper) -> Result<Vec<u8>, Refusal> {
    Ok(siconos::write(&condensed(shown, stepper)?).into_bytes())
}

/// The frozen problem as Matrix Market files.
pub(super) fn mtx(shown: &ExportState, stepper: &mut Stepper) -> Result<Vec<Vec<u8>>, Refusal> {
    let texts = market::texts(&condensed(shown, stepper)?, &from(shown));
    Ok(texts.map(String::into_bytes).into())
}

/// The frozen problem in fclib format.
pub(super) fn h5(shown: &ExportState, stepper: &mut Stepper) -> Result<Vec<u8>, Refusal> {
    fclib::write(&condensed(shown, stepper)?, &from(shown)).map_err(Refusal::new)
}

fn condensed(shown: &ExportState, stepper: &mut Stepper) -> Result<Local, Refusal> {
    let (problem, _) = problem(shown, stepper)?;
    frozen::siconos(&shown.scene.model, &problem)
}

/// Origin of the problem, in one line.
fn from(shown: &ExportState) -> String {
    let text = format!(
        "From {}, {}",
        shown.scene.name,
        names::position(shown.origin.at)
    );
    outside::line(&text).into_owned()
}

/// The file of a scene: the original text if there are no overrides and no external mesh, otherwise an
/// equivalent scene that includes both.
///
/// # Errors
/// If the text does not read back as the same scene.
pub fn scene(scene: &Scene) -> Result<String, Refusal> {
    if !scene.text.is_empty() && scene.overrides().next().is_none() && !scene.imports() {
        return Ok(scene.text.clone());
    }
    let layout = ron::ser::PrettyConfig::new().new_line("\n").depth_limit(3);
    let unwritable = |why| refusal!("the scene cannot be written as text: {why}");
    let text = notation::lines(&scene.spec, layout).map_err(|e| unwritable(e.to_string()))?;
    let set = joined(scene.overrides().map(|(p, v)| format!("{p}={v}")), ", ");
    let mut head = format!("// From {}", scene.name.replace('\n', " "));
    if !set.is_empty() {
        head += &format!(", with {}", set.replace('\n', " "));
    }
    let text = format!("{head}.\n{text}\n");
    let read = Scene::from_text(&scene.name, &text, &[]).map_err(|e| unwritable(e.to_string()))?;
    if read.spec == scene.spec {
        Ok(text)
    } else {
        Err(unwritable(
            "the text does not read back as the same scene".to_owned(),
        ))
    }
}
