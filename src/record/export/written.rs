//! Scenes and frozen problems as text: `.ron` and `.dat`.

use super::frozen::{self, Origin};
use super::shown::{NotMade, Shown, problem};
use crate::format::notation;
use crate::scene::Scene;
use crate::scene::siconos::Storage;
use crate::step::stepper::Stepper;

/// The scene, with what was set from outside; or its frozen problem, where that is wanted.
pub(super) fn ron(shown: &Shown, stepper: &mut Stepper) -> Result<Vec<u8>, NotMade> {
    if !shown.frozen {
        return Ok(scene(shown.scene)?.into_bytes());
    }
    let (problem, state) = problem(shown, stepper)?;
    let origin = Origin {
        at: match state.next == shown.state.next {
            true => shown.origin.at,
            false => state.next,
        },
        ..shown.origin.clone()
    };
    Ok(frozen::whole(&shown.scene.model, &origin, &problem)?.into_bytes())
}

/// The frozen problem in the form of Siconos.
pub(super) fn dat(shown: &Shown, stepper: &mut Stepper) -> Result<Vec<u8>, NotMade> {
    let (problem, _) = problem(shown, stepper)?;
    let friction = frozen::siconos(&shown.scene.model, &problem)?;
    Ok(friction.write(Storage::Dense).into_bytes())
}

/// The file of a scene: its author's where nothing was set from outside and no mesh stands in another file, else one that says
/// the same with all of that in it.
///
/// # Errors
/// If it does not read back as the scene that it was made of.
pub fn scene(scene: &Scene) -> Result<String, NotMade> {
    if !scene.text.is_empty() && scene.overrides().next().is_none() && !scene.imports() {
        return Ok(scene.text.clone());
    }
    let layout = ron::ser::PrettyConfig::new().new_line("\n").depth_limit(3);
    let unwritable = |why: String| NotMade::Unwritable(why);
    let text = notation::options()
        .to_string_pretty(&scene.spec, layout)
        .map_err(|e| unwritable(e.to_string()))?;
    let set: Vec<String> = scene.overrides().map(|(p, v)| format!("{p}={v}")).collect();
    let mut head = format!("// From {}", scene.name.replace('\n', " "));
    if !set.is_empty() {
        head += &format!(", with {}", set.join(", ").replace('\n', " "));
    }
    let text = format!("{head}.\n{text}\n");
    let read = Scene::from_text(&scene.name, &text, &[]).map_err(|e| unwritable(e.to_string()))?;
    match read.spec == scene.spec {
        true => Ok(text),
        false => Err(unwritable("it does not read back as it is".to_owned())),
    }
}
